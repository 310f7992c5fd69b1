"""Balancing: a pole on a cart whose acceleration is driven (ARCH-COMP 2024, AINNCS)."""

import math

from fuzzyarm.plant import Plant, Port


class Balancing(Plant):
    """x1'' = 2 f; 0.0105 x3'' = 0.08 · 0.41 (9.8 sin x3 - 2 f cos x3) - 0.0021 x3'."""

    name = "balancing"
    axis = "cart"
    inputs = {"f": Port("N", -10, 10)}
    outputs = {
        "x1": Port("m", -1, 1, bound=10),
        "x2": Port("m/s", -2, 2, rate_of="x1", bound=100),
        "x3": Port("rad", -0.5, 0.5, bound=3),
        "x4": Port("rad/s", -3, 3, rate_of="x3", bound=100),
    }
    states = {"x1": "m", "x2": "m/s", "x3": "rad", "x4": "rad/s"}
    longest_step = 0.005

    def derivative(self, t, x, u, p):
        """Return the rates of the states."""
        push = 9.8 * math.sin(x[2]) - 2.0 * u[0] * math.cos(x[2])
        return [x[1], 2.0 * u[0], x[3], (0.08 * 0.41 * push - 0.0021 * x[3]) / 0.0105]
