import numpy as np
import skfuzzy as fuzz
from skfuzzy import control as ctrl

depth = ctrl.Antecedent(np.linspace(0, 10, 41), "depth")
rate = ctrl.Consequent(np.linspace(0, 1, 41), "rate")
depth.automf(3)
rate.automf(3)
filling = ctrl.ControlSystem([
    ctrl.Rule(depth["poor"], rate["good"]),
    ctrl.Rule(depth["average"], rate["average"]),
    ctrl.Rule(depth["good"], rate["poor"]),
])
tank = ctrl.ControlSystemSimulation(filling)
tank.input["deptth"] = 4
tank.compute()
print(tank.output["rate"])
