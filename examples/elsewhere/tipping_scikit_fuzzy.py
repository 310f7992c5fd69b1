"""How much to tip, with scikit-fuzzy: the example that everybody starts with."""

import numpy as np
import skfuzzy as fuzz
from skfuzzy import control as ctrl

quality = ctrl.Antecedent(np.arange(0, 11, 1), "quality")
service = ctrl.Antecedent(np.arange(0, 11, 1), "service")
tip = ctrl.Consequent(np.arange(0, 26, 1), "tip")

quality.automf(3)
service.automf(3)
tip["low"] = fuzz.trimf(tip.universe, [0, 0, 13])
tip["medium"] = fuzz.trimf(tip.universe, [0, 13, 25])
tip["high"] = fuzz.trimf(tip.universe, [13, 25, 25])

tipping = ctrl.ControlSystem(
    [
        ctrl.Rule(quality["poor"] | service["poor"], tip["low"]),
        ctrl.Rule(service["average"], tip["medium"]),
        ctrl.Rule(service["good"] | quality["good"], tip["high"]),
    ]
)

simulation = ctrl.ControlSystemSimulation(tipping)
simulation.input["quality"] = 6.5
simulation.input["service"] = 9.8
simulation.compute()
print(simulation.output["tip"])
