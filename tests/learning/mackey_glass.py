"""The series of Mackey and Glass, with which methods of learning are compared."""

from __future__ import annotations

import numpy as np


def mackey_glass():
    """Return inputs and targets of training and test, 500 rows each.

    RK4 with a step of 0.1, τ = 17, x(0) = 1.2, 0 before; the delayed value between two steps
    is their mean. x(t−18), x(t−12), x(t−6), x(t) → x(t+6) for t = 118 … 1117.
    """
    step, delay = 0.1, 170
    x = np.zeros(11_501)
    x[0] = 1.2

    def slope(value, delayed):
        return 0.2 * delayed / (1.0 + delayed**10) - 0.1 * value

    for i in range(len(x) - 1):
        before = x[i - delay] if i >= delay else 0.0
        after = x[i + 1 - delay] if i + 1 >= delay else 0.0
        middle = 0.5 * (before + after)
        k1 = slope(x[i], before)
        k2 = slope(x[i] + 0.5 * step * k1, middle)
        k3 = slope(x[i] + 0.5 * step * k2, middle)
        k4 = slope(x[i] + step * k3, after)
        x[i + 1] = x[i] + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    series = x[::10]
    t = np.arange(118, 1118)
    inputs = np.column_stack([series[t - 18], series[t - 12], series[t - 6], series[t]])
    targets = series[t + 6]
    return inputs[:500], targets[:500], inputs[500:], targets[500:]
