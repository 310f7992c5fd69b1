import numpy as np
import skfuzzy as fuzz
from numpy import trapz
from skfuzzy import control as ctrl

universe = np.arange(0, 10.5, 0.5).astype(np.float)
speed = ctrl.Antecedent(universe, "speed")
torque = ctrl.Consequent(universe, "torque", defuzzify_method="mom")
speed["slow"] = fuzz.gbellmf(universe, 2, 3, 0)
speed["fast"] = fuzz.gbellmf(universe, 2, 3, 10)
torque["low"] = fuzz.trimf(universe, [0, 2, 4])
torque["high"] = fuzz.trimf(universe, [6, 8, 10])
print("area", trapz(torque["low"].mf, universe), np.int(3))
motor = ctrl.ControlSystem([
    ctrl.Rule(speed["slow"], torque["high"]),
    ctrl.Rule(speed["fast"], torque["low"]),
])
