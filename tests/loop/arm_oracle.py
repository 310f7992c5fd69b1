"""The arm under a linear PD, written from the study's equations and tables alone.

Nothing of fuzzyarm is used. A set point is held for its control periods and a voltage for one; the
motors' torques follow the velocity in steps of at most 0.6 ms, as the study integrates.
"""

import math

import numpy as np

MOTOR_INERTIA, GRAVITY = 0.1498, 9.8
TORQUE_CONSTANT, RESISTANCE, RATIOS = 0.066, 2.32, (80.0, 70.0)
LONGEST_STEP = 0.0006


def constants(m1, m2, l1, x1, x2, i1, i2, f1, f2):
    return (
        i1 + i2 + m2 * (x2 * x2 + l1 * l1) + m1 * x1 * x1,
        2 * m2 * l1 * x2,
        m2 * x2 * x2 + i2,
        f1,
        f2,
        GRAVITY * (m1 * x1 + m2 * l1),
        GRAVITY * m2 * x2,
    )


EMPTY = constants(2.0, 2.0, 0.26, 0.13, 0.14, 0.09, 0.09, 2.5, 2.5)
LOADED = constants(3.0, 3.0, 0.26, 0.15, 0.16, 1.5, 0.09, 2.5, 2.5)


def acceleration(q, v, torque, p):
    sine, cosine = math.sin(q[1]), math.cos(q[1])
    a, b, d = (
        p[0] + p[1] * cosine + MOTOR_INERTIA,
        p[2] + p[1] * cosine / 2,
        p[2] + MOTOR_INERTIA,
    )
    outer = p[6] * math.cos(q[0] + q[1])
    first = torque[0] + p[1] * sine * (v[1] * v[0] + v[1] ** 2 / 2) - p[3] * v[0]
    first -= p[5] * math.cos(q[0]) + outer
    second = torque[1] - p[1] * sine * v[0] ** 2 / 2 - p[4] * v[1] - outer
    determinant = a * d - b * b
    return (d * first - b * second) / determinant, (a * second - b * first) / determinant


def motor(voltage, velocity, ratio):
    return (voltage - TORQUE_CONSTANT * velocity * ratio) * TORQUE_CONSTANT / RESISTANCE * ratio


def quintic(t, duration, start, end):
    s = min(max(t / duration, 0.0), 1.0)
    way = end - start
    rate = way / duration * s * s * (30 - 60 * s + 30 * s * s)
    return start + way * s**3 * (10 - 15 * s + 6 * s * s), rate


def rms_of(moves, law, period, every):
    """Return RMS errors, degrees: at the set points, in all periods, and from the path.

    Parameters
    ----------
    moves : list of (start, end, duration, constants)
        Angles of both joints, rad.
    law : callable
        From errors of position and velocity of a joint to its voltage.
    """
    q = v = (0.0, 0.0)
    found = [[], [], []]
    set_point = period * every
    steps = max(1, math.ceil(period / LONGEST_STEP - 1e-3))
    step = period / steps
    for start, end, duration, p in moves:
        for point in range(math.floor(duration / set_point + 1e-9) + 1):
            t = point * set_point
            wanted = [quintic(t, duration, a, b) for a, b in zip(start, end, strict=True)]
            for i in range(every):
                path = [
                    quintic(t + i * period, duration, a, b)[0]
                    for a, b in zip(start, end, strict=True)
                ]
                errors = [wanted[j][0] - q[j] for j in (0, 1)]
                found[1].append(errors)
                found[2].append([path[j] - q[j] for j in (0, 1)])
                if i == every - 1:
                    found[0].append(errors)
                volts = [law(errors[j], wanted[j][1] - v[j]) for j in (0, 1)]
                for _ in range(steps):
                    torque = [motor(volts[j], v[j], RATIOS[j]) for j in (0, 1)]
                    a = acceleration(q, v, torque, p)
                    v = tuple(v[j] + a[j] * step for j in (0, 1))
                    q = tuple(q[j] + v[j] * step + a[j] * step * step / 2 for j in (0, 1))
    return [np.degrees(np.sqrt(np.mean(np.square(each), axis=0))) for each in found]
