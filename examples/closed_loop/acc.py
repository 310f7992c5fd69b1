"""Adaptive cruise control: a car behind another one that brakes (ARCH-COMP, AINNCS)."""

from fuzzyarm.plant import Plant, Port


class AdaptiveCruise(Plant):
    """v' = γ, γ' = 2 (a - γ) - µ v² of both cars; the one ahead brakes with a_lead."""

    name = "acc"
    axis = "car"
    inputs = {"acceleration": Port("m/s²", -5, 3)}
    outputs = {
        "speed": Port("m/s", 0, 50),
        "distance": Port("m", 0, 200),
        "closing": Port("m/s", -20, 20),
        "margin": Port("m", -50, 150),
    }
    states = {
        "x_lead": "m", "v_lead": "m/s", "g_lead": "m/s²",
        "x_ego": "m", "v_ego": "m/s", "g_ego": "m/s²",
    }  # fmt: skip
    parameters = {"a_lead": -2.0, "mu": 0.0001, "gap_time": 1.4, "gap": 10.0}
    longest_step = 0.02

    def start(self, rng):
        """Begin in the middle of the starts."""
        return [100.0, 32.1, 0.0, 10.5, 30.1, 0.0]

    def derivative(self, t, x, u, p):
        """Return the rates of the states."""
        lead = 2.0 * (p[0] - x[2]) - p[1] * x[1] * x[1]
        ego = 2.0 * (u[0] - x[5]) - p[1] * x[4] * x[4]
        return [x[1], x[2], lead, x[4], x[5], ego]

    def measure(self, t, x, u, p):
        """Return the outputs."""
        distance = x[0] - x[3]
        return [x[4], distance, x[1] - x[4], distance - p[3] - p[2] * x[4]]
