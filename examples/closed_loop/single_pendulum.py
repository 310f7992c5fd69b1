"""The single pendulum of ARCH-COMP (AINNCS): a rod with a torque at its joint, upright at 0."""

import math

from fuzzyarm.plant import Plant, Port


class SinglePendulum(Plant):
    """m l² θ'' = m g l sin θ + u, here θ'' = 2 sin θ + 8 u."""

    name = "single-pendulum"
    inputs = {"torque": Port("N m", -10, 10)}
    outputs = {
        "angle": Port("rad", -2, 2, bound=10),
        "rate": Port("rad/s", -4, 4, rate_of="angle", bound=100),
    }
    states = {"angle": "rad", "rate": "rad/s"}
    longest_step = 0.01

    def derivative(self, t, x, u, p):
        """Return the rates of the states."""
        return [x[1], 2.0 * math.sin(x[0]) + 8.0 * u[0]]
