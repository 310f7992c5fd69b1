"""Conversion of a shape to another kind: the same middle, and one half at the same points.

A shape of any kind is measured: its maximum, the points where its flanks cross one half, and their
slopes there. Each kind gets its parameters from these. Features that a kind lacks are lost: a
triangle has no plateau, a gaussian has equal flanks, and a ramp keeps one flank only.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.language.model.rulebase import Shape
from fuzzyarm.language.model.shapes import corner_points, membership_function
from fuzzyarm.symbolic.kinds import SHAPES

SAMPLES = 2001
"""Points at which a shape is looked at, over three times its range."""

FLAT = 1e-9
"""Tolerance of a plateau below the maximum."""

LEAST_FLANK = 1e-3
"""Smallest width of a sloped half flank, as a share of the range."""

HALF_GAUSSIAN = math.sqrt(2.0 * math.log(2.0))
"""Standard deviations from the mean of a gaussian to one half."""


class UnlikeError(FuzzyarmError, ValueError):
    """A shape that cannot be converted to another kind."""


class _Profile(NamedTuple):
    """Measured features of a shape; an open side extends to infinity."""

    left: float
    """Where it rises through one half."""
    left_edge: float
    """Where its tangent-like flank, through one half and three quarters, reaches the top."""
    first: float
    """Where its plateau begins."""
    last: float
    right_edge: float
    right: float
    least: float
    """The narrowest flank that may be written."""

    @property
    def peak(self) -> float:
        """The middle of the plateau."""
        return 0.5 * (self.first + self.last)

    @property
    def half_width(self) -> float:
        """From the middle to one half, in the mean of both sides."""
        return max(0.5 * (self.right - self.left), self.least)


def alike(shape: Shape, kind: str, low: float, high: float, width: float) -> Shape:
    """Return a shape of another kind with the same position and width.

    Parameters
    ----------
    shape : Shape
        Fuzzy, or a singleton.
    kind : str
        One of :data:`KINDS`.
    low, high : float
        The range of its variable.
    width : float
        Distance of the points of one half, for a singleton.

    Raises
    ------
    UnlikeError
        If it has no position, or none of the required flanks.
    """
    if kind not in _MADE:
        hint = f"there are {', '.join(KINDS)}"
        raise UnlikeError(f"no term is made a '{kind}' by hand", hint=hint)
    if shape.kind == kind:
        return shape
    profile = _measured(shape, low, high, width)
    if kind in ("trapezoid", "ramp", "s", "z", "sigmoid"):
        values = _MADE[kind](profile)
    else:  # these end on both sides
        values = _MADE[kind](_closed(profile, low, high))
    digits = 4 - math.floor(math.log10(high - low))
    numbers = [round(x, digits) + 0.0 if math.isfinite(x) else x for x in values]
    if kind in _SLOPE:
        numbers[_SLOPE[kind]] = float(f"{values[_SLOPE[kind]]:.4g}")
    return Shape(kind, tuple(numbers), 1.0 if kind == "singleton" else shape.height)


# --- Measuring a shape ---


def _measured(shape: Shape, low: float, high: float, width: float) -> _Profile:
    least = LEAST_FLANK * (high - low)
    if shape.kind == "singleton":
        at, half = shape.parameters[0], max(0.5 * width, least)
        return _Profile(at - half, at, at, at, at, at + half, least)
    if not SHAPES[shape.kind].fuzzy:
        raise UnlikeError(f"a term that is '{shape.kind}' has neither a position nor a width")
    degree = membership_function(shape)
    span = high - low
    even = (low - span + 3.0 * span * i / (SAMPLES - 1) for i in range(SAMPLES))
    xs = sorted({*even, *corner_points(shape)})
    ys = [degree(x) for x in xs]
    top = max(ys)
    highest = [i for i, y in enumerate(ys) if y >= top * (1.0 - FLAT)]
    first, last = highest[0], highest[-1]
    left = _flank(degree, xs[: first + 1][::-1], top)
    right = _flank(degree, xs[last:], top)
    if left is None and right is None:
        raise UnlikeError("the term has the same height everywhere: it has no position")
    begin = -math.inf if left is None else xs[first]
    end = math.inf if right is None else xs[last]
    (a, edge_a), (b, edge_b) = left or (-math.inf, -math.inf), right or (math.inf, math.inf)
    return _Profile(a, edge_a, begin, end, edge_b, b, least)


def _flank(
    degree: Callable[[float], float], outward: list[float], top: float
) -> tuple[float, float] | None:
    """Return where a flank crosses one half and its tangent the top; None without a flank."""
    crossings = []
    for level in (0.75 * top, 0.5 * top):
        below = next((i for i, x in enumerate(outward) if degree(x) < level), None)
        if below is None:
            return None
        inner, outer = outward[max(0, below - 1)], outward[below]
        for _ in range(60):
            middle = 0.5 * (inner + outer)
            inner, outer = (middle, outer) if degree(middle) >= level else (inner, middle)
        crossings.append(0.5 * (inner + outer))
    upper, half = crossings
    return half, 2.0 * upper - half


def _closed(profile: _Profile, low: float, high: float) -> _Profile:
    """Return a shoulder as a shape with its top at the end of the range, and as wide beyond."""
    if math.isinf(profile.right):
        top = max(high, profile.left_edge)
        mirrored = 2.0 * top - profile.left
        return profile._replace(first=top, last=top, right_edge=top, right=mirrored)
    if math.isinf(profile.left):
        top = min(low, profile.right_edge)
        mirrored = 2.0 * top - profile.right
        return profile._replace(first=top, last=top, left_edge=top, left=mirrored)
    return profile


# --- The numbers of each kind ---


def _plateau(p: _Profile) -> tuple[float, ...]:
    left, right = p.left_edge, p.right_edge
    if left > right:
        left = right = p.peak
    return _foot(p.left, left), left, right, _foot(p.right, right)


def _foot(half: float, edge: float) -> float:
    return half if math.isinf(half) else 2.0 * half - edge


def _triangle(p: _Profile) -> tuple[float, ...]:
    left, right = 2.0 * p.left - p.peak, 2.0 * p.right - p.peak
    return min(left, p.peak), p.peak, max(right, p.peak)


def _two_sided(p: _Profile) -> tuple[float, ...]:
    left, right = max(p.first - p.left, p.least), max(p.right - p.last, p.least)
    return p.first, left / HALF_GAUSSIAN, p.last, right / HALF_GAUSSIAN


def _bell(p: _Profile) -> tuple[float, ...]:
    # At three quarters |x - centre| / width is 3 ** (-1 / (2 slope)).
    width = p.half_width
    upper = 0.5 * (0.5 * (p.right + p.right_edge) - 0.5 * (p.left + p.left_edge))
    share = min(max(upper / width, 0.05), 0.97)
    return p.peak, width, -math.log(3.0) / (2.0 * math.log(share))


def _rises(p: _Profile) -> bool:
    """Whether the left flank is kept: the only one, or the wider."""
    if math.isinf(p.left) or math.isinf(p.right):
        return math.isinf(p.right)
    return p.first - p.left >= p.right - p.last


def _rising(p: _Profile, kind: str) -> tuple[float, float]:
    """Return the foot and the top of the left flank."""
    if math.isinf(p.left):
        raise UnlikeError(f"the term does not rise: it cannot become '{kind}'")
    edge = max(p.left_edge, p.left + p.least)
    return 2.0 * p.left - edge, edge


def _falling(p: _Profile, kind: str) -> tuple[float, float]:
    """Return the top and the foot of the right flank."""
    if math.isinf(p.right):
        raise UnlikeError(f"the term does not fall: it cannot become '{kind}'")
    edge = min(p.right_edge, p.right - p.least)
    return edge, 2.0 * p.right - edge


def _ramp(p: _Profile) -> tuple[float, ...]:
    return _rising(p, "ramp") if _rises(p) else _falling(p, "ramp")[::-1]


def _sigmoid(p: _Profile) -> tuple[float, ...]:
    # Its slope at one half is a quarter of its number.
    if _rises(p):
        foot, edge = _rising(p, "sigmoid")
        return p.left, 4.0 / (edge - foot)
    edge, foot = _falling(p, "sigmoid")
    return p.right, -4.0 / (foot - edge)


_MADE: dict[str, Callable[[_Profile], tuple[float, ...]]] = {
    "triangle": _triangle,
    "trapezoid": _plateau,
    "rectangle": lambda p: (p.left, max(p.right, p.left + p.least)),
    "pi": _plateau,
    "gaussian": lambda p: (p.peak, p.half_width / HALF_GAUSSIAN),
    "two-sided-gaussian": _two_sided,
    "bell": _bell,
    "cosine": lambda p: (p.peak, 4.0 * p.half_width),
    "ramp": _ramp,
    "s": lambda p: _rising(p, "s"),
    "z": lambda p: _falling(p, "z"),
    "sigmoid": _sigmoid,
    "singleton": lambda p: (p.peak,),
}

_SLOPE = {"bell": 2, "sigmoid": 1}
"""Parameters that are neither positions nor widths, by kind."""

KINDS = tuple(_MADE)
"""Kinds that a term can be made by hand."""
