"""A signal as a function of its sources: range, slopes, multiples of a sum.

A :class:`SignalLaw` propagates through sums, products and tables; ranges and multiples are rounded
outward, slopes to nearest.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from fuzzyarm.base.numbers import number_text
from fuzzyarm.symbolic.evaluation import derivative, evaluate
from fuzzyarm.symbolic.intervals import combine, largest, overlap, symmetric
from fuzzyarm.symbolic.nodes import Apply, Node, fold, postorder
from fuzzyarm.symbolic.operations import OPERATIONS, Interval
from fuzzyarm.table import LookupTable

NOTHING = Interval(0.0, 0.0)
ONE = Interval(1.0, 1.0)

Gains = dict[str, Interval]
"""Slopes by source."""


# ── bounds of a signal ───────────────────────────────────────────────────────────────


@dataclass(frozen=True)
class SignalLaw:
    """A signal as a function of the sources."""

    at: Interval  # at, rest: its range; its value with every source at 0
    rest: Interval
    # gains, around: slopes at the origin along each source alone, and over all pieces there; or why
    # there are none
    gains: Gains | str
    around: Gains | str
    # Its weights, if it is a weighted sum of sources
    linear: dict[str, float] | None
    along: Interval | str  # its sector over σ; or why it has none
    slack: float = 0.0  # allowed excess over the sector
    # Where it is not a number, or why that is open; empty if it is one everywhere
    hole: str = ""

    @property
    def constant(self) -> float | None:
        """Its value, if constant."""
        fixed = self.gains == {} and self.at.low == self.at.high == self.rest.low
        return self.at.low if fixed else None


def outward(at: Interval) -> Interval:
    """Widen by one rounding; 0 is exact, as a product with 0 or a difference of equals."""
    return Interval(
        at.low and math.nextafter(at.low, -math.inf), at.high and math.nextafter(at.high, math.inf)
    )


def combined(operation: str, a: Interval, b: Interval) -> Interval:
    """Return the bounds of an operation, rounded outward."""
    for one, other in ((a, b), (b, a)):  # exact sums are not widened
        if (operation, other) in (("multiply", ONE), ("add", NOTHING)):
            return one
    return outward(combine(operation, a, b))


def constant(value: float) -> SignalLaw:
    """Return the law of a number."""
    at = Interval(value, value)
    along: Interval | str = "a constant adds to it" if value else NOTHING
    return SignalLaw(at, at, {}, {}, {} if value == 0.0 else None, along)


def scaled(law: SignalLaw, factor: float) -> SignalLaw:
    """Return a law times a number."""
    by = Interval(factor, factor)
    return SignalLaw(
        combined("multiply", law.at, by),
        combine("multiply", law.rest, by),
        _each(law.gains, by),
        _each(law.around, by),
        None if law.linear is None else {name: w * factor for name, w in law.linear.items()},
        law.along if isinstance(law.along, str) else combined("multiply", law.along, by),
        law.slack * abs(factor),
        law.hole,
    )


def _each(gains: Gains | str, by: Interval) -> Gains | str:
    if isinstance(gains, str):
        return gains
    return {name: combine("multiply", gain, by) for name, gain in gains.items()}


def _added(*parts: Gains | str) -> Gains | str:
    total: Gains = {}
    for part in parts:
        if isinstance(part, str):
            return part
        for name, gain in part.items():
            total[name] = combine("add", total.get(name, NOTHING), gain)
    return total


def plus(a: SignalLaw, b: SignalLaw) -> SignalLaw:
    """Return the sum of two laws."""
    along: Interval | str
    if isinstance(a.along, Interval) and isinstance(b.along, Interval):
        along = combined("add", a.along, b.along)
    else:
        along = a.along if isinstance(a.along, str) else b.along
    linear = None
    if a.linear is not None and b.linear is not None:
        names = {**a.linear, **b.linear}
        linear = {name: a.linear.get(name, 0.0) + b.linear.get(name, 0.0) for name in names}
    return SignalLaw(
        combined("add", a.at, b.at),
        combine("add", a.rest, b.rest),
        _added(a.gains, b.gains),
        _added(a.around, b.around),
        linear,
        along,
        a.slack + b.slack,
        a.hole or b.hole,
    )


def times(a: SignalLaw, b: SignalLaw) -> SignalLaw:
    """Return the product of two laws; if both are multiples of σ, the narrower sector counts."""
    for one, other in ((a, b), (b, a)):
        if one.constant is not None:
            return scaled(other, one.constant)
    ways = [
        (combined("multiply", one.along, other.at), one.slack * largest(other.at))
        for one, other in ((a, b), (b, a))
        if isinstance(one.along, Interval)
    ]
    along: Interval | str = a.along if isinstance(a.along, str) else b.along
    slack = 0.0
    if ways:
        along, slack = min(ways, key=lambda way: way[0].high - way[0].low)
    return SignalLaw(
        combined("multiply", a.at, b.at),
        combine("multiply", a.rest, b.rest),
        # (a b)' = a' b + a b', at rest.
        _added(_each(a.gains, b.rest), _each(b.gains, a.rest)),
        _added(_each(a.around, b.rest), _each(b.around, a.rest)),
        None,
        along,
        slack,
        a.hole or b.hole,
    )


def over(a: SignalLaw, b: SignalLaw) -> SignalLaw:
    """Return the quotient of two laws."""
    if b.constant:
        return scaled(a, 1.0 / b.constant)
    why = "it is divided by a signal"
    along = combined("divide", a.along, b.at) if isinstance(a.along, Interval) else a.along
    slack = combine("divide", symmetric(a.slack), b.at).high if a.slack else 0.0
    at, rest = combined("divide", a.at, b.at), combine("divide", a.rest, b.rest)
    return SignalLaw(at, rest, why, why, None, along, slack, a.hole or b.hole)


def unknown(at: Interval, why: str) -> SignalLaw:
    """Return a law with a known range only."""
    return SignalLaw(at, at, why, why, None, why)


# ── curves ────────────────────────────────────────────────────────────────────────────

PARTS = 256
"""Parts of a range, on each of which the ratio of a curve to its input is bounded."""


def curved(root: Node, law: SignalLaw, *, exact: bool) -> SignalLaw:
    """Return a law after a curve, an expression over ``x``."""
    at, rest = outward(_values(root, law.at)), _values(root, law.rest)
    operations = [node.operation for node in postorder(root) if isinstance(node, Apply)]
    jump = next((operation for operation in operations if operation in JUMPS), None)
    if jump is not None:
        return replace(unknown(at, f"a source may jump ({jump})"), rest=rest, hole=law.hole)
    slope = derivative(root, "x")
    near = _slopes(root, law.rest)
    gains, around = _each(law.gains, near), _each(law.around, near)
    along, slack = law.along, 0.0
    if exact and isinstance(along, Interval) and law.at.low < law.at.high:
        if not law.rest == rest == NOTHING:
            along = "it is not 0 at rest"
        else:
            ratio = _ratio(root, slope, law.at)
            along, slack = combined("multiply", along, ratio), law.slack * largest(ratio)
    return SignalLaw(at, rest, gains, around, None, along, slack, law.hole)


JUMPS = frozenset(
    {
        *("where", "remainder", "atan2"),
        *(name for name, operation in OPERATIONS.items() if operation.partials is None),
    }
)
"""Operations that may jump: choices, conditions and steps; not all show it in their slopes."""


def _slopes(root: Node, rest: Interval) -> Interval:
    """Return the slopes of a curve on both sides of a point, or on an interval."""
    slope = derivative(root, "x")
    if rest.low < rest.high:
        return _bounds(slope, {"x": rest})
    sides = [evaluate(slope, {"x": x}) for x in _sides(rest)]
    return Interval(min(sides), max(sides))


def _values(root: Node, at: Interval) -> Interval:
    """Return the values of a curve on an interval; at a point the nearest float."""
    if at.low < at.high:
        return _bounds(root, {"x": at})
    value = evaluate(root, {"x": at.low})
    return Interval(value, value)


def _bounds(root: Node, ranges: Mapping[str, Interval]) -> Interval:
    """Return the values of an expression, rounded outward as in :func:`combined`."""

    def applied(node: Apply, arguments: list[Interval]) -> Interval:
        operation = OPERATIONS[node.operation]
        at = operation.bounds(*arguments)
        return at if operation.exact else outward(at)

    return fold([root], ranges, lambda x: Interval(x, x), applied)[0]


def _sides(at: Interval) -> Interval:
    """Widen by one rounding, 0 too: it then contains both sides of a corner."""
    return Interval(math.nextafter(at.low, -math.inf), math.nextafter(at.high, math.inf))


def _ratio(root: Node, slope: Node, at: Interval) -> Interval:
    """Return the sector over x of a curve through 0.

    Slopes bound it everywhere; away from 0 values do, part by part.
    """
    whole = _bounds(slope, {"x": Interval(min(at.low, 0.0), max(at.high, 0.0))})
    if not math.isfinite(largest(at)):
        return whole
    low, high = math.inf, -math.inf
    for end in (e for e in at if e):
        for part in range(PARTS):
            ends = sorted((end * part / PARTS, end * (part + 1) / PARTS))
            here = Interval(*map(float, ends))
            if not overlap(here, at).low <= overlap(here, at).high:
                continue
            interval = _bounds(slope, {"x": Interval(min(here.low, 0.0), max(here.high, 0.0))})
            # Mean value theorem: y(x)/x is a slope between 0 and x. Quotients of values are
            # tighter, except in the part at 0.
            if part:
                interval = overlap(interval, combined("divide", _bounds(root, {"x": here}), here))
            low, high = min(low, interval.low), max(high, interval.high)
    return overlap(whole, Interval(low, high)) if low <= high else whole


# ── tables ────────────────────────────────────────────────────────────────────────────


def table_law(
    table: LookupTable, laws: Mapping[str, SignalLaw], at: Interval, *, exact: bool
) -> SignalLaw:
    """Return a table as a function of its inputs, exact along each of them."""
    rest = [only_value(law.rest) for law in laws.values()]
    value = float(table.lookup(*rest))
    mode = table.default_mode
    gains: Gains | str = {}
    for number, (axis, law) in enumerate(zip(table.axes, laws.values(), strict=True)):
        slope = _table_slope(table, rest, number, mode)
        if slope is None:
            gains = f"the table has a step at {axis.name} = {number_text(rest[number])}"
            break
        gains = _added(gains, _each(law.gains, slope))
    moving = [name for name, law in laws.items() if law.at.low < law.at.high]
    along: Interval | str = "" if not exact else NOTHING if value == 0.0 else "it is not 0 at rest"
    if exact and len(moving) > 1:
        along = "sectors of tables are proved along one input"
    elif exact and moving:
        law = laws[moving[0]]
        along = law.along
        if isinstance(along, Interval):
            sector = _table_sector(table, rest, list(laws).index(moving[0]), law.at)
            along = (
                sector if isinstance(sector, str) else combined("multiply", outward(sector), along)
            )
    hole = next((law.hole for law in laws.values() if law.hole), "")
    return SignalLaw(at, Interval(value, value), gains, gains, None, along, hole=hole)


def _table_slope(
    table: LookupTable, rest: Sequence[float], number: int, mode: str
) -> Interval | None:
    """Return the slopes to both sides along one input; None at a step."""
    axis, x = table.axes[number], rest[number]
    if mode != "linear":
        return None if x in axis.thresholds(mode) else NOTHING
    here = float(table.lookup(*rest))
    # Beyond its ends a table is constant.
    values = [0.0] if not axis.levels[0] < x < axis.levels[-1] else []
    for level in _beside(axis.levels, x):
        point = [*rest]
        point[number] = level
        values.append((float(table.lookup(*point)) - here) / (level - x))
    return Interval(min(values), max(values))


def _beside(levels: Sequence[float], x: float) -> list[float]:
    """Return the neighbouring level on either side."""
    below, above = [y for y in levels if y < x], [y for y in levels if y > x]
    return [*below[-1:], *above[:1]]


def _table_sector(
    table: LookupTable, rest: Sequence[float], number: int, at: Interval
) -> Interval | str:
    """Return the least and the greatest ratio of value to input along one input; 0 for 0."""
    axis, mode = table.axes[number], table.default_mode
    slope = _table_slope(table, rest, number, mode)
    if slope is None or float(table.lookup(*rest)) != 0.0:
        return f"the table is not 0 around {axis.name} = 0"
    turns = axis.levels if mode == "linear" else axis.thresholds(mode)
    ends = [x for x in (at.low, at.high, *turns) if at.low <= x <= at.high and x]
    # Between two levels value / x is monotone: y = a + b x gives a/x + b. Far away it tends to 0.
    finite = [x for x in ends if math.isfinite(x)]
    ratios = [slope.low, slope.high]
    for x in finite:
        for side in (x, math.nextafter(x, math.inf)) if mode != "linear" else (x,):
            point = [*rest]
            point[number] = side
            ratios.append(float(table.lookup(*point)) / x)
    if len(finite) < len(ends):
        ratios.append(0.0)
    return Interval(min(ratios), max(ratios))


# ── intervals ─────────────────────────────────────────────────────────────────────────


def only_value(at: Interval) -> float:
    """Return the value of a point interval; NaN of others."""
    return at.low if at.low == at.high else math.nan


def clipped(at: Interval, limits: Interval) -> Interval:
    """Return an interval after limits."""
    low = min(max(at.low, limits.low), limits.high)
    return Interval(low, max(low, min(at.high, limits.high)))


def snapped(at: Interval, universe: Interval) -> Interval:
    """Return the reachable part of a universe; an almost reached end is included."""
    slack = 1e-9 * (universe.high - universe.low)
    low, high = clipped(at, universe)
    if at.low < at.high:
        low = universe.low if low <= universe.low + slack else low
        high = universe.high if high >= universe.high - slack else high
    return Interval(low, high)


def inside(at: Interval, universe: Interval) -> bool:
    """Return whether an interval is in another, except for rounding."""
    slack = 1e-9 * (universe.high - universe.low)
    return universe.low - slack <= at.low and at.high <= universe.high + slack
