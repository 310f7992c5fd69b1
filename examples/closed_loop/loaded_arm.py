"""The study's two-link arm with its load as one parameter, from none (0) to all of it (1).

The equations are those of the arm, (3.2.20): τ = (M + J) θ'' + V θ' + F θ' + G; the motors take a
voltage, and their back-EMF follows the joints.
"""

import math

from fuzzyarm.plant import Parameter, Plant, Port
from fuzzyarm.plant.arm import LOADED, RATIOS, RESISTANCE, TORQUE_CONSTANT, UNLOADED


def joint(name):
    """Return the ports of a joint."""
    return {
        f"{name}.position": Port("rad", -2 * math.pi, 2 * math.pi, bound=20 * math.pi),
        f"{name}.velocity": Port("rad/s", -10, 10, rate_of="position", bound=1e3),
    }


class LoadedArm(Plant):
    """Two links in a vertical plane, angles from the horizontal."""

    name = "loaded-arm"
    inputs = {"joint1.voltage": Port("V", -20, 20), "joint2.voltage": Port("V", -20, 20)}
    outputs = {**joint("joint1"), **joint("joint2")}
    states = {"q_1": "rad", "v_1": "rad/s", "q_2": "rad", "v_2": "rad/s"}
    parameters = {"load": Parameter(0.0, "1", "share of the load of the study")}
    longest_step = 0.0006

    def derivative(self, t, x, u, p):
        """Return the rates of the states."""

        def grown(name):
            light, heavy = getattr(UNLOADED, name), getattr(LOADED, name)
            return light if light == heavy else light + p[0] * (heavy - light)

        m_1, m_2, l_1, g = grown("m_1"), grown("m_2"), grown("l_1"), grown("g")
        x_1, x_2 = grown("x_1"), grown("x_2")
        second = m_2 * x_2
        p_2 = 2.0 * l_1 * second
        p_3 = second * x_2 + grown("I_2")
        p_1 = grown("I_1") + m_1 * x_1 * x_1 + m_2 * l_1 * l_1 + p_3
        p_6, p_7 = g * (m_1 * x_1 + m_2 * l_1), second * g
        sine, cosine = math.sin(x[2]), math.cos(x[2])
        torque = [
            (u[k] - TORQUE_CONSTANT * ratio * x[1 + 2 * k]) * (TORQUE_CONSTANT * ratio / RESISTANCE)
            for k, ratio in enumerate(RATIOS)
        ]
        half = 0.5 * p_2 * sine
        weight = p_7 * math.cos(x[0] + x[2])
        first = (
            torque[0] - (grown("F_1") - p_2 * sine * x[3]) * x[1] + half * x[3] * x[3]
            - p_6 * math.cos(x[0]) - weight
        )  # fmt: skip
        other = torque[1] - half * x[1] * x[1] - grown("F_2") * x[3] - weight
        m_11 = p_1 + p_2 * cosine + grown("J_1")
        m_12 = p_3 + 0.5 * p_2 * cosine
        m_22 = p_3 + grown("J_2")
        determinant = m_11 * m_22 - m_12 * m_12
        return [
            x[1],
            (first * m_22 - other * m_12) / determinant,
            x[3],
            (other * m_11 - first * m_12) / determinant,
        ]
