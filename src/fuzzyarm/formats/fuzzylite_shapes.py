"""The same function in fuzzylite, where it treats the edge of a shape in its own way."""

from __future__ import annotations

import math
from dataclasses import replace

from fuzzyarm.rulebase.model import Shape

_STEPS = frozenset({"ramp", "s", "arc", "concave"})


def fuzzylite_shape(shape: Shape) -> Shape:
    """Return a shape with which fuzzylite gives the value of the model everywhere.

    A step (a ramp from a number to itself) is its ``Binary``; at a doubled x of points it
    takes the last value, the model the larger one.
    """
    p = shape.parameters
    if shape.kind in _STEPS and p[0] == p[1]:
        return replace(shape, kind="binary", parameters=(p[1], math.inf))
    if shape.kind == "z" and p[0] == p[1]:
        return replace(shape, kind="binary", parameters=(p[1], -math.inf))
    if shape.kind == "pi":
        left = math.nextafter(p[0], -math.inf) if p[0] == p[1] else p[0]
        right = math.nextafter(p[3], math.inf) if p[2] == p[3] else p[3]
        return replace(shape, parameters=(left, p[1], p[2], right))
    if shape.kind == "points":
        return replace(shape, parameters=_last_wins(p))
    return shape


def _last_wins(parameters: tuple[float, ...]) -> tuple[float, ...]:
    values = list(parameters)
    for i in range(2, len(values), 2):
        if values[i] == values[i - 2] and values[i - 1] > values[i + 1]:
            values[i] = math.nextafter(values[i], math.inf)
    return tuple(values)
