"""From bounds of firing strengths to bounds of the crisp value.

An aggregate consists of numbers, of samples, of sets, or of sets interpolated between samples; for
interval type 2 of an upper and a lower one. Its bounds are curves over panels, sums of weighted
numbers, or humps of maxima. These bound the figures of the aggregate that a defuzzifier uses
(:mod:`fuzzyarm.symbolic.defuzzifiers`), and the value is an expression of the figures.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from fuzzyarm.inference.errors import InferenceError
from fuzzyarm.inference.firing_intervals import LOWER, UPPER
from fuzzyarm.inference.plan import Member, OutputPlan
from fuzzyarm.inference.weighted import tsukamoto_position
from fuzzyarm.proof.map.aggregates import AggregateSamples, JoinedPanels, Panels, Strengths, folded
from fuzzyarm.proof.map.arithmetic import Array
from fuzzyarm.proof.map.bounds import UnprovableError
from fuzzyarm.proof.map.centroid_bounds import (
    average_bounds,
    centroid_bounds,
    ends_of_average_bounds,
    ends_of_centroid_bounds,
)
from fuzzyarm.proof.map.maxima import humps_of_numbers, maxima
from fuzzyarm.proof.map.memberships import SLACK, Interval
from fuzzyarm.proof.map.position_bounds import (
    Humps,
    bisector_bounds,
    halving_bounds,
    largest_bounds,
    mean_bounds,
    nearest_bounds,
    nearest_half_bounds,
    smallest_bounds,
)
from fuzzyarm.proof.stop import Stop
from fuzzyarm.symbolic.evaluation import bounds
from fuzzyarm.symbolic.kinds import SHAPES, DefuzzifierKind

Valued = tuple[Array, Array, Array]
"""Bounds of a value, NaN for boxes without one, and flags of boxes that may have points without."""


# ── aggregates by defuzzifier ────────────────────────────────────────────────────────

Figures = dict[str, Interval]
"""Bounds of an aggregate's figures, by name; NaN for none."""


class BoundingMethod(NamedTuple):
    """The routines that bound a defuzzifier's figures of an aggregate."""

    # From the edges of panels, and the lower and upper curve of each side of the set
    curves: Callable[..., Figures] | None = None
    # From bounds of the least and the greatest value of numbers, and bounds of their weights for
    # each side
    sums: Callable[..., Figures] | None = None
    # From samples and bounds of their heights, if the sampling ``midpoints`` has its own definition
    midpoints: Callable[..., Interval] | None = None
    # From the humps of maxima, for each figure
    humps: Mapping[str, Callable[[Humps], Interval]] = MappingProxyType({})


def _centroid(edges: Array, *sides: Interval) -> Figures:
    """Return the centroid of a set, or of the sum of both sides (Nie and Tan)."""
    lower, upper = (sum(parts[1:], start=parts[0]) for parts in zip(*sides, strict=True))
    return {"centroid": centroid_bounds(edges, lower, upper)}


def _centroid_of_numbers(least: Interval, greatest: Interval, *sides: Interval) -> Figures:
    lower, upper = (sum(parts[1:], start=parts[0]) for parts in zip(*sides, strict=True))
    return {"centroid": average_bounds(least[0], greatest[1], lower, upper)}


def _weighted(least: Interval, greatest: Interval, weights: Interval) -> Figures:
    (low, _), (_, high), (lower, upper) = least, greatest, weights
    tops = np.maximum(high * lower, high * upper).sum(axis=1)
    bottoms = np.minimum(low * lower, low * upper).sum(axis=1)
    slack = 1e-13 * np.maximum(np.abs(high), np.abs(low)).sum(axis=1)
    nothing = ~(upper > 0.0).any(axis=1)
    ends = bottoms - slack, tops + slack
    return {"weighted": (np.where(nothing, np.nan, ends[0]), np.where(nothing, np.nan, ends[1]))}


def _average(least: Interval, greatest: Interval, weights: Interval) -> Figures:
    """Return the average of numbers, possibly unbounded, such as the ends of a sigmoid."""
    low, high = least[0], greatest[1]
    finite = [np.where(np.isfinite(end), end, 0.0) for end in (low, high)]
    bottom, top = average_bounds(finite[0], finite[1], *weights)
    counts = weights[1] > 0.0
    bottom = np.where((counts & (low == -np.inf)).any(axis=1), -np.inf, bottom)
    top = np.where((counts & (high == np.inf)).any(axis=1), np.inf, top)
    return {"average": (bottom, top)}


def _half(edges: Array, curves: Interval) -> Figures:
    return {"half": bisector_bounds(edges, *curves)}


def _half_of_numbers(least: Interval, greatest: Interval, weights: Interval) -> Figures:
    return {"half": halving_bounds(least[0], greatest[1], *weights)}


def _ends(edges: Array, upper: Interval, lower: Interval) -> Figures:
    left, right = ends_of_centroid_bounds(edges, lower, upper)
    return {"left": left, "right": right}


def _ends_of_numbers(
    least: Interval, greatest: Interval, upper: Interval, lower: Interval
) -> Figures:
    left, right = ends_of_average_bounds(least, greatest, lower, upper)
    return {"left": left, "right": right}


WAYS: dict[str, BoundingMethod] = {
    "gravity": BoundingMethod(_centroid, _centroid_of_numbers),
    "area": BoundingMethod(_half, _half_of_numbers, midpoints=nearest_half_bounds),
    "top": BoundingMethod(
        humps={
            "first": smallest_bounds,
            "last": largest_bounds,
            "mean": mean_bounds,
            "nearest": nearest_bounds,
        }
    ),
    "ends": BoundingMethod(_ends, _ends_of_numbers),
    "average": BoundingMethod(sums=_average),
    "sum": BoundingMethod(sums=_weighted),
}
"""Routines by kind; for interval type 2 the first side is the upper set."""


def value_bounds(record: DefuzzifierKind, figures: Figures) -> Interval:
    """Return bounds of a defuzzifier's value from bounds of its figures."""
    if record.figure:
        return figures[record.figure]
    figure_bounds = [figures[name] for name in record.symbols]
    nothing = np.isnan(figure_bounds[0][0])
    if record.rises:  # inference's floats rise with it too: no rounding reverses the order
        low, high = (record.array(*(figure[side] for figure in figure_bounds)) for side in (0, 1))
        return np.where(nothing, np.nan, low), np.where(nothing, np.nan, high)
    values = np.full((2, len(nothing)), np.nan)
    for box in np.flatnonzero(~nothing).tolist():
        ranges = {
            name: (float(ends[0][box]), float(ends[1][box]))
            for name, ends in zip(record.symbols, figure_bounds, strict=True)
        }
        values[:, box] = bounds(record.expression, ranges)
    return values[0], values[1]


# ── an output ────────────────────────────────────────────────────────────────────────


class Crisp:
    """Bounds of the value of one output from bounds of its firing strengths.

    Attributes
    ----------
    width : int
        Numbers needed per box.
    jumps : bool
        Whether the value jumps.
    """

    width: int

    def __init__(self, output: OutputPlan, way: BoundingMethod) -> None:
        self.output, self.way, self.jumps = output, way, output.record.aspect.jumps

    def __call__(self, strengths: Strengths, low: Array, high: Array) -> Valued:
        """Return the bounds over boxes of the inputs, from `low` to `high`."""
        raise NotImplementedError

    def value(self, figures: Figures) -> Interval:
        """Return bounds of the value from bounds of the figures."""
        return value_bounds(self.output.record, figures)

    def from_humps(self, humps: Humps) -> Interval:
        """Return bounds of the value from the humps of maxima."""
        return self.value(
            {name: self.way.humps[name](humps) for name in self.output.record.symbols}
        )

    def sides(self, strengths: Strengths) -> list[Strengths]:
        """Return the strengths of the upper and the lower set; of type 1 all of them."""
        sides_of_members = self.output.sides
        if not sides_of_members:
            return [strengths]
        return [
            [strength for strength in strengths if sides_of_members[strength[0]] == side]
            for side in (UPPER, LOWER)
        ]


def crisp(output: OutputPlan, names: Sequence[str], stop: Stop) -> Crisp:
    """Return the bounding function of an output."""
    defuzzifier, way = output.output.defuzzifier, WAYS[output.record.of]
    if output.discrete:
        return _OfNumbers(output, way, names)
    if way.humps:
        return _OfMaxima(output, way, stop)
    if defuzzifier.joined:
        return _OfCurves(output, way, JoinedPanels(output, stop))
    if defuzzifier.resolution is not None:
        return _OfSamples(output, way)
    return _OfCurves(output, way, Panels(output, stop))


class _OfCurves(Crisp):
    """Sets, as curves over panels."""

    def __init__(self, output: OutputPlan, way: BoundingMethod, panels: Panels) -> None:
        super().__init__(output, way)
        self.panels, self.width = panels, panels.width

    def __call__(self, strengths: Strengths, low: Array, high: Array) -> Valued:
        curves = [self.panels.bounds(side) for side in self.sides(strengths)]
        assert self.way.curves is not None
        may_lack: Array = ~np.any(curves[UPPER][0] > 0.0, axis=(1, 2))
        return *self.value(self.way.curves(self.panels.edges, *curves)), may_lack


class _OfSamples(Crisp):
    """Sets at samples, as weights of their positions."""

    def __init__(self, output: OutputPlan, way: BoundingMethod) -> None:
        super().__init__(output, way)
        self.samples = AggregateSamples(output)
        self.width = self.samples.width
        self.nearest = output.output.defuzzifier.sampling == "midpoints" and way.midpoints

    def __call__(self, strengths: Strengths, low: Array, high: Array) -> Valued:
        weighted = [
            tuple(side * self.samples.weights for side in self.samples.bounds(strengths_of_side))
            for strengths_of_side in self.sides(strengths)
        ]
        may_lack = ~(weighted[UPPER][0] > 0.0).any(axis=1)
        positions = self.samples.positions
        # The sampled bisector with midpoints takes the nearest sample, which is not a sum.
        if self.nearest:
            half = self.nearest(positions, *weighted[UPPER])
            return *self.value({"half": half}), may_lack
        assert self.way.sums is not None
        same = (positions, positions)
        return *self.value(self.way.sums(same, same, *weighted)), may_lack


class _OfMaxima(Crisp):
    """Sets, by their maxima."""

    def __init__(self, output: OutputPlan, way: BoundingMethod, stop: Stop) -> None:
        super().__init__(output, way)
        self.maxima = maxima(output, stop)
        self.width = self.maxima.width

    def __call__(self, strengths: Strengths, low: Array, high: Array) -> Valued:
        humps, lead = self.maxima.humps(strengths)
        return *self.from_humps(humps), ~(lead > 0.0)


class _OfNumbers(Crisp):
    """Numbers: constants, linear forms, formulas, and inverted sets (Tsukamoto)."""

    def __init__(self, output: OutputPlan, way: BoundingMethod, names: Sequence[str]) -> None:
        super().__init__(output, way)
        self.names, self.width = names, len(output.members)
        if output.record.inverts:
            self._demand_inverses()

    def _demand_inverses(self) -> None:
        """Refuse a set that neither rises nor falls."""
        for member in self.output.members:
            if member.pieces:
                try:
                    tsukamoto_position(self.output, member, 0.5)
                except InferenceError as error:
                    raise UnprovableError(str(error)) from None

    def __call__(self, strengths: Strengths, low: Array, high: Array) -> Valued:
        weights = folded(self.output, strengths)
        numbers = {m: self._number(m, weights[m], low, high) for m in weights}
        if self.output.record.of == "ends":
            return self._reduced(weights, numbers)
        least, most = _columns(numbers.values())
        lower, upper = _columns(weights.values())
        may_lack: Array = ~np.any(lower > 0.0, axis=1)
        if self.way.humps:
            return *self.from_humps(humps_of_numbers(least, most, lower, upper)), may_lack
        assert self.way.sums is not None
        figures = self.way.sums((least, least), (most, most), (lower, upper))
        return *self.value(figures), may_lack

    def _reduced(self, weights: dict[int, Interval], numbers: dict[int, Interval]) -> Valued:
        """Return bounds of Karnik and Mendel's type reduction of both sets."""
        assert self.way.sums is not None
        pairs = self.output.pairs
        upper, lower = (
            _columns([weights[pair[side]] for pair in pairs]) for side in (UPPER, LOWER)
        )
        one, other = (_columns([numbers[pair[side]] for pair in pairs]) for side in (UPPER, LOWER))
        least, most = (
            tuple(choose(one[end], other[end]) for end in (0, 1))
            for choose in (np.minimum, np.maximum)
        )
        may_lack: Array = ~np.any(upper[0] > 0.0, axis=1)
        return *self.value(self.way.sums(least, most, upper, lower)), may_lack

    def _number(self, index: int, strength: Interval, low: Array, high: Array) -> Interval:
        """Return bounds of the number of a consequent over boxes."""
        member = self.output.members[index]
        if member.value is not None:
            constant = np.full(len(low), member.value)
            return constant, constant
        if member.pieces:
            return self._inverted(member, strength)
        if member.formula is not None:
            root = member.formula.with_constants(self.names)
            height = member.term.shape.height
            intervals = [
                bounds(root, dict(zip(self.names, zip(a, b, strict=True), strict=True)))
                for a, b in zip(low.tolist(), high.tolist(), strict=True)
            ]
            ends = height * np.array(intervals, dtype=float)
            return ends[:, 0], ends[:, 1]
        *coefficients, constant_ = member.term.shape.parameters
        least = np.full(len(low), float(constant_))
        most = least.copy()
        size = np.abs(least)
        for i, coefficient in enumerate(coefficients):
            a, b = coefficient * low[:, i], coefficient * high[:, i]
            least, most = least + np.minimum(a, b), most + np.maximum(a, b)
            size = size + np.maximum(np.abs(a), np.abs(b))
        # Each product and sum rounds by 2⁻⁵³ of its magnitude; 1e-14 covers dozens of them.
        return least - 1e-14 * size, most + 1e-14 * size

    def _inverted(self, member: Member, strength: Interval) -> Interval:
        """Return bounds of the position at which a monotone set reaches a strength.

        The position rises or falls with the strength. A set that only tends to 0 or to 1 has no
        first or last one.
        """
        degrees = strength[0] * (1.0 - SLACK), strength[1] * (1.0 + SLACK)
        # Boxes share ends: each degree is inverted once.
        distinct, back = np.unique(np.stack(degrees), return_inverse=True)
        at = np.array([self._positions(member, share) for share in distinct.tolist()])
        values = at[back.reshape(2, -1)]
        output = self.output.output
        sizes = [abs(x) for x in (*member.term.shape.parameters, output.low, output.high)]
        # Inverses are formulas in floats; infinite positions stay infinite.
        slack = 1e-13 * (max(sizes) + np.where(np.isfinite(values), np.abs(values), 0.0))
        return (values - slack).min(axis=(0, 2)), (values + slack).max(axis=(0, 2))

    def _positions(self, member: Member, degree: float) -> tuple[float, float]:
        """Return the exact position of a degree, and that of inference, which is finite."""
        position = tsukamoto_position(self.output, member, degree)
        shape = member.term.shape
        inverse = SHAPES[shape.kind].position_of
        if inverse is None or member.hedges:
            return position, position
        return inverse(min(1.0, degree / shape.height), *shape.parameters), position


def _columns(intervals: Any) -> Interval:
    """Return intervals over boxes, one per column, as arrays of shape (boxes, columns)."""
    least, most = zip(*intervals, strict=True)
    return np.stack(least, axis=1), np.stack(most, axis=1)
