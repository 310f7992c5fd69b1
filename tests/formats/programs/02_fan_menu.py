import numpy as np
import skfuzzy as fuzz
from skfuzzy import control as ctrl


def ask(prompt, low, high):
    while True:
        value = float(input(f"{prompt} ({low}-{high}): "))
        if low <= value <= high:
            return value
        print("out of range")


print("1) evaluate  2) quit")
choice = int(input("choice: "))
temperature = ctrl.Antecedent(np.linspace(0, 40, 81), "temperature")
fan = ctrl.Consequent(np.linspace(0, 100, 101), "fan")
temperature["cold"] = fuzz.trapmf(temperature.universe, [0, 0, 10, 20])
temperature["warm"] = fuzz.trimf(temperature.universe, [15, 22, 30])
temperature["hot"] = fuzz.trapmf(temperature.universe, [25, 35, 40, 40])
fan["slow"] = fuzz.trimf(fan.universe, [0, 0, 50])
fan["medium"] = fuzz.trimf(fan.universe, [20, 50, 80])
fan["fast"] = fuzz.trimf(fan.universe, [50, 100, 100])
system = ctrl.ControlSystem([
    ctrl.Rule(temperature["cold"], fan["slow"]),
    ctrl.Rule(temperature["warm"], fan["medium"]),
    ctrl.Rule(temperature["hot"], fan["fast"]),
])
sim = ctrl.ControlSystemSimulation(system)
while choice == 1:
    sim.input["temperature"] = ask("temperature", 0, 40)
    sim.compute()
    print(sim.output["fan"])
    choice = int(input("choice: "))
