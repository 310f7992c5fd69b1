"""TORA: a cart on a spring, moved by a weight that turns on it (ARCH-COMP, AINNCS)."""

import math

from fuzzyarm.plant import Plant, Port


class Tora(Plant):
    """x1'' = -x1 + 0.1 sin x3, x3'' = u, all in normalised units."""

    name = "tora"
    axis = "cart"
    inputs = {"u": Port("1", -11, 11)}
    outputs = {
        "x1": Port("1", -2, 2, bound=100),
        "x2": Port("1", -2, 2, rate_of="x1", bound=100),
        "x3": Port("1", -2, 2, bound=100),
        "x4": Port("1", -2, 2, rate_of="x3", bound=100),
    }
    states = {"x1": "1", "x2": "1", "x3": "1", "x4": "1"}
    longest_step = 0.02

    def derivative(self, t, x, u, p):
        """Return the rates of the states."""
        return [x[1], -x[0] + 0.1 * math.sin(x[2]), x[3], u[0]]
