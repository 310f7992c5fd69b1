import numpy as np
import skfuzzy as fuzz
from skfuzzy import control as ctrl


class BrakeController:
    """Used by another file."""

    def __init__(self, top_speed):
        self.speed = ctrl.Antecedent(np.linspace(0, 200, 101), "speed")
        self.gap = ctrl.Antecedent(np.linspace(0, 100, 101), "gap")
        self.brake = ctrl.Consequent(np.linspace(0, 100, 101), "brake")
        self._terms()
        self.sim = ctrl.ControlSystemSimulation(ctrl.ControlSystem(self._rules()))

    def _terms(self):
        for variable in (self.speed, self.gap, self.brake):
            variable.automf(3, names=["low", "mid", "high"])

    def _rules(self):
        return [
            ctrl.Rule(self.gap["low"] & self.speed["high"], self.brake["high"]),
            ctrl.Rule(self.gap["mid"] | self.speed["mid"], self.brake["mid"]),
            ctrl.Rule(self.gap["high"] & ~self.speed["high"], self.brake["low"]),
        ]

    def decide(self, speed, gap):
        self.sim.input["speed"] = speed
        self.sim.input["gap"] = gap
        self.sim.compute()
        return self.sim.output["brake"]
