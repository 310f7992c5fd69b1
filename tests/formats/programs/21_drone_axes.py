import numpy as np
import skfuzzy as fuzz
from skfuzzy import control as ctrl


def axis(name, reach, thrust):
    error = ctrl.Antecedent(np.linspace(-reach, reach, 21), f"{name}_error")
    rate = ctrl.Antecedent(np.linspace(-2, 2, 21), f"{name}_rate")
    out = ctrl.Consequent(np.linspace(-thrust, thrust, 21), f"{name}_out")
    for each in (error, rate, out):
        each.automf(3, names=["neg", "zero", "pos"])
    rules = [
        ctrl.Rule(error["neg"] | rate["neg"], out["pos"]),
        ctrl.Rule(error["zero"] & rate["zero"], out["zero"]),
        ctrl.Rule(error["pos"] | rate["pos"], out["neg"]),
    ]
    return ctrl.ControlSystem(rules)


axes = {name: axis(name, 5.0, power) for name, power in (("roll", 1.0), ("pitch", 1.0), ("yaw", 0.4))}
simulations = [ctrl.ControlSystemSimulation(system) for system in axes.values()]
for simulation, name in zip(simulations, axes):
    simulation.input[f"{name}_error"] = 1.2
    simulation.input[f"{name}_rate"] = -0.1
    simulation.compute()
