import numpy as np
import skfuzzy as fuzz
import skfuzzy.control as ctrl


class Pendulum:
    def __init__(self):
        angle = ctrl.Antecedent(np.linspace(-30, 30, 61), "angle")
        rate = ctrl.Antecedent(np.linspace(-5, 5, 51), "rate")
        force = ctrl.Consequent(np.linspace(-20, 20, 81), "force")
        names = ["N", "Z", "P"]
        for each in (angle, rate, force):
            each.automf(names=names)
        rules = []
        for i, a in enumerate(names):
            for j, r in enumerate(names):
                rules.append(ctrl.Rule(angle[a] & rate[r], force[names[min(2, max(0, i + j - 1))]]))
        self.controllers = {"force": ctrl.ControlSystemSimulation(ctrl.ControlSystem(rules))}

    def step(self, angle, rate):
        sim = self.controllers["force"]
        sim.input["angle"], sim.input["rate"] = angle, rate
        sim.compute()
        return sim.output["force"]


def main():
    pendulum = Pendulum()
    angle, rate = 10.0, 0.0
    for _ in range(20):
        force = pendulum.step(angle, rate)
        rate += 0.05 * (9.81 * np.sin(np.radians(angle)) * 5 - force)
        angle += 0.05 * rate
        angle = float(np.clip(angle, -30, 30))
    print(angle)


if __name__ == "__main__":
    main()
