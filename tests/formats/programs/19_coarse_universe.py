import numpy as np
import skfuzzy as fuzz
from skfuzzy import control as ctrl

smoker = ctrl.Antecedent(np.arange(0, 2, 1), "smoker")
age = ctrl.Antecedent(np.arange(0, 100, 10), "age")
risk = ctrl.Consequent(np.arange(0, 5, 1), "risk")
smoker["no"] = fuzz.trimf(smoker.universe, [0, 0, 1])
smoker["yes"] = fuzz.trimf(smoker.universe, [0, 1, 1])
age["young"] = fuzz.trapmf(age.universe, [0, 0, 28, 37])
age["middle"] = fuzz.gaussmf(age.universe, 45, 8)
age["old"] = fuzz.sigmf(age.universe, 58, 0.6)
risk["low"] = fuzz.trimf(risk.universe, [0, 0, 2])
risk["high"] = fuzz.trimf(risk.universe, [1, 4, 4])
heart = ctrl.ControlSystem([
    ctrl.Rule(smoker["no"] & age["young"], risk["low"]),
    ctrl.Rule(smoker["yes"] & age["middle"], risk["high"]),
    ctrl.Rule(age["old"], risk["high"]),
    ctrl.Rule(age["middle"], risk["low"]),
])
heart_sim = ctrl.ControlSystemSimulation(heart)
heart_sim.input["smoker"] = 1
heart_sim.input["age"] = 52
heart_sim.compute()
print(heart_sim.output["risk"])
heart_sim.print_state()
