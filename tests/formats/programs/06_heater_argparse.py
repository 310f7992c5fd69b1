"""python heater.py --error 3"""
import argparse

import numpy as np
import skfuzzy as fuzz
from skfuzzy import control as ctrl


def make_controller(span=10.0):
    error = ctrl.Antecedent(np.linspace(-span, span, 41), "error")
    power = ctrl.Consequent(np.linspace(0, 1, 41), "power")
    error["neg"] = fuzz.trimf(error.universe, [-span, -span, 0])
    error["zero"] = fuzz.trimf(error.universe, [-span / 2, 0, span / 2])
    error["pos"] = fuzz.trimf(error.universe, [0, span, span])
    power["off"] = fuzz.trimf(power.universe, [0, 0, 0.5])
    power["half"] = fuzz.trimf(power.universe, [0.25, 0.5, 0.75])
    power["full"] = fuzz.trimf(power.universe, [0.5, 1, 1])
    return ctrl.ControlSystem([
        ctrl.Rule(error["neg"], power["off"]),
        ctrl.Rule(error["zero"], power["half"]),
        ctrl.Rule(error["pos"], power["full"]),
    ])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--error", type=float, required=True)
    arguments = parser.parse_args()
    sim = ctrl.ControlSystemSimulation(make_controller())
    sim.input["error"] = arguments.error
    sim.compute()
    print(sim.output["power"])


if __name__ == "__main__":
    main()
