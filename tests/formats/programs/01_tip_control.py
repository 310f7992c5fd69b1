import matplotlib.pyplot as plt
import numpy as np
import skfuzzy as fuzz
from skfuzzy import control as ctrl

taste = ctrl.Antecedent(np.arange(0, 11, 1), "taste")
speed = ctrl.Antecedent(np.arange(0, 11, 1), "speed")
tip = ctrl.Consequent(np.arange(0, 21, 1), "tip")
taste.automf(3)
speed.automf(3)
tip["none"] = fuzz.trimf(tip.universe, [0, 0, 10])
tip["usual"] = fuzz.trimf(tip.universe, [0, 10, 20])
tip["lots"] = fuzz.trimf(tip.universe, [10, 20, 20])
taste.view()
rules = [
    ctrl.Rule(taste["poor"] | speed["poor"], tip["none"]),
    ctrl.Rule(speed["average"], tip["usual"]),
    ctrl.Rule(taste["good"] & speed["good"], tip["lots"]),
]
tipping = ctrl.ControlSystemSimulation(ctrl.ControlSystem(rules))
tipping.input["taste"] = 6.5
tipping.input["speed"] = 9.8
tipping.compute()
print("tip:", tipping.output["tip"])
tip.view(sim=tipping)
plt.show()
