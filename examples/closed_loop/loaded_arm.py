"""The study's two-link arm with its load as one parameter, from none (0) to all of it (1).

The equations are those of the arm, (3.2.20): τ = (M + J) θ'' + V θ' + F θ' + G; the motors take a
voltage, and their back-EMF follows the joints. ``LoadedArm`` moves both joints, ``HeldJoint`` the
first, while the second is held at an angle.
"""

import math
from typing import NamedTuple

from fuzzyarm.plant import Parameter, Plant, Port
from fuzzyarm.plant.arm import LOADED, RATIOS, RESISTANCE, TORQUE_CONSTANT, UNLOADED

LOAD = Parameter(0.0, "1", "share of the load of the study")


def joint(prefix=""):
    """Return the ports of a joint."""
    return {
        f"{prefix}position": Port("rad", -2 * math.pi, 2 * math.pi, bound=20 * math.pi),
        f"{prefix}velocity": Port("rad/s", -10, 10, rate_of="position", bound=1e3),
    }


class Body(NamedTuple):
    """Constants P1 … P3, P6, P7 of the arm, and friction and motor inertia of its joints."""

    p_1: object
    p_2: object
    p_3: object
    p_6: object
    p_7: object
    friction: tuple
    inertia: tuple


def body(load):
    """Return the constants of the arm with a share of its load."""

    def grown(name):
        light, heavy = getattr(UNLOADED, name), getattr(LOADED, name)
        return light if light == heavy else light + load * (heavy - light)

    m_1, m_2, l_1, g = grown("m_1"), grown("m_2"), grown("l_1"), grown("g")
    x_1, x_2 = grown("x_1"), grown("x_2")
    second = m_2 * x_2
    p_3 = second * x_2 + grown("I_2")
    return Body(
        grown("I_1") + m_1 * x_1 * x_1 + m_2 * l_1 * l_1 + p_3,
        2.0 * l_1 * second,
        p_3,
        g * (m_1 * x_1 + m_2 * l_1),
        second * g,
        (grown("F_1"), grown("F_2")),
        (grown("J_1"), grown("J_2")),
    )


def torque(voltage, velocity, ratio):
    """Return the torque of a motor on its joint."""
    constant = TORQUE_CONSTANT * ratio
    return (voltage - constant * velocity) * (constant / RESISTANCE)


class LoadedArm(Plant):
    """Two links in a vertical plane, angles from the horizontal."""

    name = "loaded-arm"
    inputs = {"joint1.voltage": Port("V", -20, 20), "joint2.voltage": Port("V", -20, 20)}
    outputs = {**joint("joint1."), **joint("joint2.")}
    states = {"q_1": "rad", "v_1": "rad/s", "q_2": "rad", "v_2": "rad/s"}
    parameters = {"load": LOAD}
    longest_step = 0.0006

    def derivative(self, t, x, u, p):
        """Return the rates of the states."""
        arm = body(p[0])
        sine, cosine = math.sin(x[2]), math.cos(x[2])
        half = 0.5 * arm.p_2 * sine
        weight = arm.p_7 * math.cos(x[0] + x[2])
        first = (
            torque(u[0], x[1], RATIOS[0])
            - (arm.friction[0] - arm.p_2 * sine * x[3]) * x[1]
            + half * x[3] * x[3]
            - arm.p_6 * math.cos(x[0])
            - weight
        )
        other = torque(u[1], x[3], RATIOS[1]) - half * x[1] * x[1] - arm.friction[1] * x[3] - weight
        m_11 = arm.p_1 + arm.p_2 * cosine + arm.inertia[0]
        m_12 = arm.p_3 + 0.5 * arm.p_2 * cosine
        m_22 = arm.p_3 + arm.inertia[1]
        determinant = m_11 * m_22 - m_12 * m_12
        return [
            x[1],
            (first * m_22 - other * m_12) / determinant,
            x[3],
            (other * m_11 - first * m_12) / determinant,
        ]


class HeldJoint(Plant):
    """The first joint, the second held at an angle: one inertia, and the weight of both links."""

    name = "held-joint"
    axis = "joint"
    inputs = {"voltage": Port("V", -20, 20)}
    outputs = joint()
    states = {"position": "rad", "velocity": "rad/s"}
    parameters = {"load": LOAD, "other": Parameter(0.0, "rad", "angle of the second joint")}
    longest_step = 0.0006

    def derivative(self, t, x, u, p):
        """Return the rates of the states."""
        arm = body(p[0])
        weight = arm.p_6 * math.cos(x[0]) + arm.p_7 * math.cos(x[0] + p[1])
        inertia = arm.p_1 + arm.p_2 * math.cos(p[1]) + arm.inertia[0]
        drive = torque(u[0], x[1], RATIOS[0]) - arm.friction[0] * x[1]
        return [x[1], (drive - weight) / inertia]
