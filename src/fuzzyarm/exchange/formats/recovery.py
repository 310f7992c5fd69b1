"""Shapes from samples: find the triangle, gaussian or bell behind a list of degrees.

Other programs keep a term as degrees at points of its universe. On a flank of each shape here some
function of the degree is linear in x (the degree itself for a triangle, the square root of −2 ln y
for a gaussian), so a line through the flank yields the parameters. They are rounded to few digits
if the rounded shape fits as well. A shape is accepted only if it reproduces every degree within
:data:`TOLERANCE`, and a small degree within the share :data:`_SHARE`: where one rule fires alone,
its degree decides, even at 1e-87.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import chain, pairwise, product
from typing import NamedTuple

from fuzzyarm.language.declarations import even_shapes
from fuzzyarm.language.model.rulebase import Shape
from fuzzyarm.language.model.shapes import bends, membership_function, polyline
from fuzzyarm.symbolic.kinds import SHAPES

TOLERANCE = 1e-12
"""Greatest error of a degree."""

NEAR_LINES = 0.01
"""Greatest difference for which a shape replaces straight lines between samples."""

_STRAIGHT = 1e-13
"""Greatest distance of a sample from its replacement line."""

_SHARE = 1e-9
"""Greatest relative error of a degree."""

_DIGITS = 10
"""Most digits of a hand-written number; longer ones stay as found."""


# --- Interface ---


def recovered(xs: Sequence[float], ys: Sequence[float]) -> Shape | None:
    """Return the shape with the degrees `ys` (0 to 1) at ascending `xs`, or None if there is none.

    It has a height where the highest sample is below 1. The samples say nothing about it beyond the
    first and the last point.
    """
    top = max(ys, default=0.0)
    if len(xs) < 2 or not 0.0 < top <= 1.0 + TOLERANCE:
        return None
    # The peak may lie between two samples, or the term may have a height.
    heights = [1.0] if top >= 1.0 - TOLERANCE else [1.0, top]
    for height in heights:
        samples = _Samples(xs, [min(1.0, max(0.0, y / height)) for y in ys])
        for kind, numbers in _candidates(samples):
            shape = _settled(kind, numbers, height, xs, ys)
            if shape is not None:
                return shape
    return None


def joined(xs: Sequence[float], ys: Sequence[float]) -> Shape:
    """Return piecewise-linear ``points`` through all samples, without the redundant ones."""
    corners = [0]
    # Slopes within tolerance of all samples since the last kept one.
    low, high = -math.inf, math.inf
    for i in range(1, len(xs)):
        width = xs[i] - xs[corners[-1]]
        slope = (ys[i] - ys[corners[-1]]) / width
        if not low <= slope <= high:
            corners.append(i - 1)
            low, high, width = -math.inf, math.inf, xs[i] - xs[i - 1]
            slope = (ys[i] - ys[i - 1]) / width
        near = min(_STRAIGHT, _SHARE * ys[i]) / width
        low, high = max(low, slope - near), min(high, slope + near)
    corners.append(len(xs) - 1)
    return Shape(
        "points", tuple(chain.from_iterable((xs[i], ys[i]) for i in dict.fromkeys(corners)))
    )


def straight_shape(points: Shape) -> Shape:
    """Return the triangle, trapezoid or ramp equal to ``points`` everywhere, or the points."""
    xs, ys = points.parameters[0::2], points.parameters[1::2]
    if any(a >= b for a, b in pairwise(xs)) or not all(0.0 <= y <= 1.0 for y in ys):
        return points
    shape = recovered(xs, ys)
    if shape is None or not is_joined(shape, xs):
        return points
    width, degree = xs[-1] - xs[0], membership_function(points)
    positions = [xs[0] - width, xs[0] - 1e-9 * width, *xs, xs[-1] + 1e-9 * width, xs[-1] + width]
    degrees = [degree(x) for x in positions]
    scaled = [
        replace(candidate, height=candidate.height * points.height)
        for candidate in (shape, _open_ended(shape, xs))
    ]
    return next((candidate for candidate in scaled if _has(candidate, positions, degrees)), points)


def is_joined(shape: Shape, xs: Sequence[float]) -> bool:
    """Whether a shape is linear between the points `xs`."""
    if not SHAPES[shape.kind].straight:
        return False
    near = 1e-12 * (xs[-1] - xs[0])
    inside = (x for x, _ in polyline(shape) if xs[0] + near < x < xs[-1] - near)
    return all(abs(_nearest(xs, x) - x) <= near for x in inside)


def beside_lines(shape: Shape, xs: Sequence[float]) -> float:
    """Return the greatest distance of a shape from lines through its degrees at ascending `xs`."""
    degree = membership_function(shape)
    ys = [degree(x) for x in xs]
    worst = 0.0
    bent = [x for x in bends(shape) if xs[0] < x < xs[-1]]
    within: dict[int, list[float]] = {}
    for x in bent:
        within.setdefault(bisect_right(xs, x) - 1, []).append(x)
    for i, ((a, y), (b, z)) in enumerate(pairwise(zip(xs, ys, strict=True))):
        positions = [*within.get(i, ()), *(a + share * (b - a) for share in (0.25, 0.5, 0.75))]
        gaps = (abs(degree(x) - (y + (z - y) * (x - a) / (b - a))) for x in positions)
        worst = max(worst, *gaps)
    return worst


def shape_of(function: Callable[[float], float], low: float, high: float) -> Shape | None:
    """Return the shape of a function, also beyond its range, or None.

    The function is evaluated up to half a range beyond it, and between the points of the fit.
    """
    width = high - low
    xs = [low + width * (i - _BEYOND) / _ASKED for i in range(_ASKED + 2 * _BEYOND + 1)]
    ys = [float(function(x)) for x in xs]
    tries = [_open_ended(shape, xs) for shape in (recovered(xs, ys),) if shape is not None]
    tries += _boxes(function, xs, ys)
    # Irregular shares: a kink half-way or at a third must not slip through.
    between = [a + 0.381966 * (b - a) for a, b in pairwise(xs)]
    values = [*ys, *(float(function(x)) for x in between)]
    return next((shape for shape in tries if _has(shape, [*xs, *between], values)), None)


_ASKED, _BEYOND = 240, 120
"""Parts of a range for the check of a fit, and those beyond it on either side."""


def _open_ended(shape: Shape, xs: Sequence[float]) -> Shape:
    """Return a shape that ends at the samples, extended beyond them."""
    start, end, p = xs[0], xs[-1], shape.parameters
    if shape.kind == "rectangle":
        return Shape("trapezoid", (-math.inf, -math.inf, math.inf, math.inf), shape.height)
    if shape.kind not in ("triangle", "trapezoid"):
        return shape
    if p[-2:] == (end, end):
        return Shape("ramp", p[:2], shape.height)
    if p[:2] == (start, start):
        return Shape("ramp", (p[-1], p[-2]), shape.height)
    return shape


def _boxes(
    function: Callable[[float], float], xs: Sequence[float], ys: Sequence[float]
) -> list[Shape]:
    """Return the rectangle, step or singleton of two-valued samples."""
    top = max(ys)
    if set(ys) != {0.0, top}:
        return []
    edges = [
        _edge(function, a, b)
        for (a, y), (b, z) in pairwise(zip(xs, ys, strict=True))
        if y != z
    ]  # fmt: skip
    if len(edges) == 1:
        return [Shape("binary", (edges[0], math.inf if ys[-1] else -math.inf), top)]
    if len(edges) == 2 and not ys[0]:
        kind, numbers = ("rectangle", (edges[0], edges[1]))
        if edges[0] == edges[1]:
            kind, numbers = "singleton", (edges[0],)  # type: ignore[assignment]
        return [Shape(kind, numbers, top)]
    return []


def _edge(function: Callable[[float], float], a: float, b: float) -> float:
    """Return the position of a jump between `a` and `b`, on its higher side."""
    rises = function(a) < function(b)
    plain = _rounded(0.5 * (a + b), 0.5 * (b - a))
    if a <= plain <= b:
        beside = math.nextafter(plain, -math.inf if rises else math.inf)
        if function(plain) and not function(beside):
            return plain
    while True:
        middle = 0.5 * (a + b)
        if not a < middle < b:
            return b if rises else a
        a, b = (a, middle) if bool(function(middle)) == rises else (middle, b)


def constant_beyond(shape: Shape, low: float, high: float) -> bool:
    """Whether a set stays at its end values beyond a range."""
    if shape.kind == "formula":
        return False
    degree, width = membership_function(shape), high - low
    return all(
        degree(low) == degree(low - far * width) and degree(high) == degree(high + far * width)
        for far in (1e-9, 1e-3, 0.1, 0.5, 2.0, 1e3)
    )


def even_family(
    shapes: Sequence[Shape], low: float, high: float, xs: Sequence[float]
) -> list[Shape] | None:
    """Return the evenly spread family with the degrees of `shapes` at `xs`, or None."""
    if len(shapes) < 2:
        return None
    for family in ("triangles", "gaussians"):
        evenly = even_shapes(family, len(shapes), low, high)
        if all(_agree(a, b, xs) for a, b in zip(evenly, shapes, strict=True)):
            return evenly
    return None


def _agree(one: Shape, other: Shape, xs: Sequence[float]) -> bool:
    degree = membership_function(other)
    return _has(one, xs, [degree(x) for x in xs])


# --- Lines through a flank ---


class _Samples(NamedTuple):
    xs: Sequence[float]
    ys: Sequence[float]

    @property
    def core(self) -> tuple[int, int]:
        """The first and the last index of the highest degree."""
        top = max(self.ys) - TOLERANCE
        return (
            next(i for i, y in enumerate(self.ys) if y >= top),
            next(i for i in reversed(range(len(self.ys))) if self.ys[i] >= top),
        )

    @property
    def reaches_one(self) -> bool:
        return max(self.ys) >= 1.0 - TOLERANCE

    def flank(self, side: int) -> list[int]:
        """Return the indices of a flank from its foot to the core (`side` −1 for the left one)."""
        first, last = self.core
        beside = range(first + 1) if side < 0 else range(len(self.ys) - 1, last - 1, -1)
        return [i for i in beside if 0.0 < self.ys[i] < 1.0 - TOLERANCE]

    def steep(self, side: int) -> list[int]:
        """Return a flank without its ends, where rounding dominates; all of a short one."""
        inside = self.flank(side)
        steep = [i for i in inside if 0.01 < self.ys[i] < 0.99]
        return steep if len(steep) > 1 else inside


class _FlankLine(NamedTuple):
    """The line t = slope (x − zero) of a straightened flank."""

    zero: float
    slope: float

    def at(self, t: float) -> float:
        """Return x for a value t."""
        return self.zero + t / self.slope


Straightened = Callable[[float], float]


def _lines(samples: _Samples, side: int, straightened: Straightened) -> list[_FlankLine]:
    """Return candidate lines of a flank: through all of it, and through its ends."""
    xs, ys = samples
    inside = samples.flank(side)
    best = samples.steep(side)
    lines = [_fitted([(xs[i], straightened(ys[i])) for i in best[: len(best) - drop]])
             for drop in (0, 1) if len(best) - drop > 1]  # fmt: skip
    edge = samples.core[0 if side < 0 else 1]
    ends: list[tuple[float, float]] = [(xs[i], ys[i]) for i in (inside[:1] + inside[-1:])]
    foot = (inside[0] if inside else edge) + side
    if 0 <= foot < len(xs) and ys[foot] == 0.0:
        ends.insert(0, (xs[foot], 0.0))
    if samples.reaches_one:
        ends.append((xs[edge], 1.0))
    for (x0, y0), (x1, y1) in pairwise(ends):
        if x0 != x1 and y0 != y1:
            lines.append(_fitted([(x0, straightened(y0)), (x1, straightened(y1))]))
    return [line for line in lines if line is not None]


def _fitted(points: list[tuple[float, float]]) -> _FlankLine | None:
    """Return the least-squares line."""
    if not all(math.isfinite(t) for _, t in points):
        return None
    middle = math.fsum(x for x, _ in points) / len(points)
    level = math.fsum(t for _, t in points) / len(points)
    spread = math.fsum((x - middle) ** 2 for x, _ in points)
    slope = math.fsum((x - middle) * (t - level) for x, t in points) / spread
    return _FlankLine(middle - level / slope, slope) if slope and math.isfinite(slope) else None


# --- Shapes, the common ones first ---

Candidate = tuple[str, tuple[float, ...]]


def _candidates(samples: _Samples) -> Iterator[Candidate]:
    """Yield candidate kinds and parameters, most of them wrong."""
    if not samples.flank(-1) and not samples.flank(1) and min(samples.ys) == 1.0:
        yield "rectangle", (samples.xs[0], samples.xs[-1])
        return
    yield from _two_flanks(samples, lambda y: y, _straight)
    yield from _two_flanks(samples, _gauss, _gaussians)
    yield from _two_flanks(samples, _parabola, _parabolas)
    yield from _sigmoids(samples)
    yield from _bells(samples)
    yield from _two_flanks(samples, _wave, _cosines)


def _two_flanks(
    samples: _Samples,
    straightened: Straightened,
    shapes: Callable[[_Samples, _FlankLine | None, _FlankLine | None], Iterator[Candidate]],
) -> Iterator[Candidate]:
    left: list[_FlankLine | None] = [*_lines(samples, -1, straightened)] or [None]
    right: list[_FlankLine | None] = [*_lines(samples, 1, straightened)] or [None]
    for pair in product(left, right):
        if pair != (None, None):
            yield from shapes(samples, *pair)


def _straight(
    samples: _Samples, left: _FlankLine | None, right: _FlankLine | None
) -> Iterator[Candidate]:
    xs = samples.xs
    start = (left.zero, left.at(1.0)) if left else (xs[0], xs[0])
    end = (right.at(1.0), right.zero) if right else (xs[-1], xs[-1])
    peak = 0.5 * (start[1] + end[0])
    yield "triangle", (start[0], peak, end[1])
    yield "trapezoid", (*start, *end)


def _gauss(y: float) -> float:
    return math.sqrt(-2.0 * math.log(y)) if y > 0.0 else math.inf


def _gaussians(
    samples: _Samples, left: _FlankLine | None, right: _FlankLine | None
) -> Iterator[Candidate]:
    lines = [(line.zero, abs(1.0 / line.slope)) for line in (left, right) if line]
    yield "gaussian", tuple(sum(numbers) / len(lines) for numbers in zip(*lines, strict=True))
    first = lines[0] if left else (samples.xs[0], lines[0][1])
    last = lines[-1] if right else (samples.xs[-1], lines[0][1])
    yield "two-sided-gaussian", (*first, *last)


def _parabola(y: float) -> float:
    return math.sqrt(0.5 * y) if y <= 0.5 else 1.0 - math.sqrt(0.5 * (1.0 - y))


def _parabolas(
    samples: _Samples, left: _FlankLine | None, right: _FlankLine | None
) -> Iterator[Candidate]:
    if left and right:
        yield "pi", (left.zero, left.at(1.0), right.at(1.0), right.zero)
    elif left:
        yield "s", (left.zero, left.at(1.0))
    elif right:
        yield "z", (right.at(1.0), right.zero)


def _wave(y: float) -> float:
    return math.acos(2.0 * y - 1.0)


def _cosines(_: _Samples, left: _FlankLine | None, right: _FlankLine | None) -> Iterator[Candidate]:
    lines = [line for line in (left, right) if line]
    centre = sum(line.zero for line in lines) / len(lines)
    yield "cosine", (centre, sum(2.0 * math.pi / abs(line.slope) for line in lines) / len(lines))


def _sigmoids(samples: _Samples) -> Iterator[Candidate]:
    for side in (-1, 1):
        for line in _lines(samples, side, _logit):
            yield "sigmoid", (line.zero, line.slope)


def _logit(y: float) -> float:
    return math.log(y / (1.0 - y)) if 0.0 < y < 1.0 else math.inf


def _bells(samples: _Samples) -> Iterator[Candidate]:
    for slope in filter(None, (_bell_slope(samples, side) for side in (-1, 1))):
        lines = [
            _fitted([(samples.xs[i], _bell(samples.ys[i], power)) for i in inside])
            for power in dict.fromkeys((_rounded(slope), slope))
            for inside in map(samples.steep, (-1, 1))
            if len(inside) > 2
        ]
        for line in filter(None, lines):
            yield "bell", (line.zero, abs(1.0 / line.slope), slope)


def _bell(y: float, slope: float) -> float:
    """Return a bell's distance from the centre, in widths, for a degree."""
    return math.pow(1.0 / y - 1.0, 0.5 / slope)


def _bell_slope(samples: _Samples, side: int) -> float | None:
    """Return the bell slope by bisection: three samples of a flank lie on a line."""
    inside = samples.steep(side)
    if len(inside) < 3:
        return None
    indices = (inside[0], inside[len(inside) // 2], inside[-1])
    (x0, x1, x2), ys = ([samples.xs[i] for i in indices], [samples.ys[i] for i in indices])
    if ys[0] == ys[2]:  # a level stretch: a bell has none
        return None

    # For the right slope the three straightened points are collinear: a sign change here.
    def bent(slope: float) -> float:
        a, b, c = (_bell(y, slope) for y in ys)
        return (b - a) / (c - a) - (x1 - x0) / (x2 - x0)

    grid = [0.25 * math.pow(2.0, k / 4.0) for k in range(29)]  # 1/4 to 32
    values = next(((a, b) for a, b in pairwise(grid) if bent(a) * bent(b) <= 0.0), None)
    if values is None:
        return None
    low, high = values
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if bent(low) * bent(middle) <= 0.0 else (middle, high)
    return 0.5 * (low + high)


# --- Rounding of parameters, and acceptance ---


def _settled(
    kind: str, numbers: tuple[float, ...], height: float, xs: Sequence[float], ys: Sequence[float]
) -> Shape | None:
    """Return the shape with rounded parameters, or as found, if it fits the samples."""
    scale = 1e-11 * (xs[-1] - xs[0])
    plain = tuple(_rounded(number, scale) for number in numbers)
    at_points = tuple(
        nearest if not _is_plain(number) and abs(nearest - number) <= scale else number
        for number, nearest in zip(plain, (_nearest(xs, number) for number in plain), strict=True)
    )
    for parameters in dict.fromkeys((at_points, plain, numbers)):
        if SHAPES[kind].fault(parameters) is not None or not all(map(math.isfinite, parameters)):
            continue
        shape = Shape(kind, parameters, _rounded(height))
        if _has(shape, xs, ys):
            return shape
    return None


def _rounded(number: float, near: float = 0.0) -> float:
    """Return the number with few digits that `number` approximates, or itself."""
    if abs(number) <= near:
        return 0.0
    near = max(near, 1e-11 * abs(number))
    for digits in range(1, _DIGITS + 1):
        plain = float(f"{number:.{digits}g}")
        if abs(plain - number) <= near:
            return plain
    return number


def _is_plain(number: float) -> bool:
    return float(f"{number:.{_DIGITS}g}") == number


def _nearest(xs: Sequence[float], x: float) -> float:
    i = bisect_left(xs, x)
    return min(xs[max(0, i - 1) : i + 1] or xs[-1:], key=lambda candidate: abs(candidate - x))


def _has(shape: Shape, xs: Sequence[float], ys: Sequence[float]) -> bool:
    degree = membership_function(shape)
    # At the foot of a flank a degree is mostly rounding: a neighbouring position may have it. The
    # foot of a cosine is so flat that it needs a wider neighbourhood.
    size = max(abs(xs[0]), abs(xs[-1]), xs[-1] - xs[0])
    beside = (1e-7 if shape.kind == "cosine" else 1e-12) * size
    return all(
        abs(degree(x) - y) <= min(TOLERANCE, _SHARE * y)
        or (abs(degree(x) - y) <= TOLERANCE and _between(degree, x - beside, x + beside, y))
        for x, y in zip(xs, ys, strict=True)
    )


def _between(degree: Callable[[float], float], a: float, b: float, y: float) -> bool:
    low, high = sorted((degree(a), degree(b)))
    return low <= y <= high
