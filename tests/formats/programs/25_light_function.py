import numpy as np
import skfuzzy as fuzz
from skfuzzy import control as ctrl


def brightness(daylight_value, people_value):
    daylight = ctrl.Antecedent(np.arange(0, 1001, 10), "daylight")
    people = ctrl.Antecedent(np.arange(0, 31, 1), "people")
    lamp = ctrl.Consequent(np.arange(0, 101, 1), "lamp")
    daylight["dark"] = fuzz.trapmf(daylight.universe, [0, 0, 200, 500])
    daylight["bright"] = fuzz.trapmf(daylight.universe, [300, 600, 1000, 1000])
    people["few"] = fuzz.trimf(people.universe, [0, 0, 15])
    people["many"] = fuzz.trimf(people.universe, [5, 30, 30])
    lamp["low"] = fuzz.trimf(lamp.universe, [0, 0, 50])
    lamp["high"] = fuzz.trimf(lamp.universe, [50, 100, 100])
    rules = [
        ctrl.Rule(daylight["dark"] & people["many"], lamp["high"]),
        ctrl.Rule(daylight["bright"] | people["few"], lamp["low"]),
    ]
    lighting = ctrl.ControlSystem(rules)
    simulation = ctrl.ControlSystemSimulation(lighting)
    simulation.input["daylight"] = daylight_value
    simulation.input["people"] = people_value
    simulation.compute()
    return simulation.output["lamp"]
