"""Bounds of an output's aggregate, from bounds of the firing strengths.

Each sample has a lower and an upper height; each panel of the output's range a lower and an upper
line.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from fuzzyarm.inference.aggregate import sample_positions, sampled_set, weights
from fuzzyarm.inference.plan import Member, OutputPlan
from fuzzyarm.inference.sets import BELOW_ONE, plateaus
from fuzzyarm.proof.map.arithmetic import Array
from fuzzyarm.proof.map.bounds import UnprovableError
from fuzzyarm.proof.map.memberships import SLACK, Interval, hedged, joined, membership_bounder
from fuzzyarm.proof.stop import Stop
from fuzzyarm.symbolic.kinds import SNORMS, TNORMS

PANELS = 160
"""Panels of an output, each with a lower and an upper line of the aggregate."""

LEVEL_PANELS = 800
"""The same for level lines, which follow a slope to first order only."""

Strengths = Sequence[tuple[int, Interval]]
"""(member, bounds of its firing strength), rule by rule."""

NARROWEST = 1e-150
"""Least width of a panel whose area floats do not round to 0."""


# ── strengths ────────────────────────────────────────────────────────────────────────


def folded(output: OutputPlan, strengths: Strengths) -> dict[int, Interval]:
    """Return bounds of the strength of each member, folded by the aggregation."""
    norm = SNORMS[output.output.aggregation]
    bounds: dict[int, Interval] = {}
    for member, (least, most) in strengths:
        if member not in bounds:
            bounds[member] = least, most
            continue
        bounds[member] = joined(norm, bounds[member], (least, most))
    return bounds


def folded_where_max(output: OutputPlan, strengths: Strengths) -> Strengths:
    """Return one strength per member under max: a T-norm rises with the strength."""
    if output.output.aggregation != "max":
        return strengths
    bounds: dict[int, Interval] = {}
    for member, (least, most) in strengths:
        earlier = bounds.get(member)
        bounds[member] = (
            (least, most)
            if earlier is None
            else (np.maximum(earlier[0], least), np.maximum(earlier[1], most))
        )
    return list(bounds.items())


def _aggregate(
    output: OutputPlan,
    strengths: Strengths,
    least: Sequence[Array],
    most: Sequence[Array],
) -> Interval:
    """Return bounds of the aggregate from bounds of every set."""
    norm = SNORMS[output.output.aggregation]
    count, columns = len(strengths[0][1][0]), len(least[0])
    lower, upper = np.zeros((count, columns)), np.zeros((count, columns))
    for member, (a, b) in folded_where_max(output, strengths):
        cut = TNORMS[output.members[member].implication]
        active = np.flatnonzero(b > 0.0)
        some = np.flatnonzero(most[member] > 0.0)
        # Elsewhere the cut set is 0, which leaves an aggregate unchanged.
        where = np.ix_(active, some)
        cuts = (a[active, None], b[active, None])
        part = joined(cut, cuts, (least[member][None, some], most[member][None, some]))
        lower[where], upper[where] = joined(norm, (lower[where], upper[where]), part)
    return lower, upper


# ── samples ──────────────────────────────────────────────────────────────────────────


class AggregateSamples:
    """The aggregate at the samples of an output.

    Parameters
    ----------
    output : OutputPlan
        With a number of samples.

    Attributes
    ----------
    positions : ndarray
        The samples.
    weights : ndarray
        Weight of each in a sum.
    sets : list of ndarray
        Degrees of each member at the samples.
    """

    def __init__(self, output: OutputPlan) -> None:
        model, way = output.output, output.output.defuzzifier
        assert way.resolution is not None
        self.output = output
        self.positions = np.array(sample_positions(model.low, model.high, way))
        self.width = len(self.positions)
        self.weights = np.array(weights(way.resolution, way.sampling))
        self.sets = [
            np.array(
                sampled_set(m.term.shape, m.hedges, model.low, model.high, way).over(self.width)
            )
            for m in output.members
        ]

    def bounds(self, strengths: Strengths) -> Interval:
        """Return bounds of the heights, shape (boxes, samples)."""
        return _aggregate(self.output, strengths, self.sets, self.sets)


# ── panels ───────────────────────────────────────────────────────────────────────────


class Panels:
    """The aggregate over panels of the range of an output.

    For piecewise linear sets under max, a member lies above its chord and below the lower of its
    lines (a cut set is a minimum of lines); the maximum of several lies above the member that is
    largest in the middle, and below the chord of the largest ends. Otherwise the lines are level.

    Parameters
    ----------
    output : OutputPlan
        With sets as consequents.
    stop : Stop
        When to give up.
    level : bool
        Force level lines.
    peaks : bool
        Whether single points, without area, count.

    Attributes
    ----------
    edges : ndarray
        Of the panels.
    """

    def __init__(
        self, output: OutputPlan, stop: Stop, *, level: bool = False, peaks: bool = False
    ) -> None:
        self.output, self.peaks = output, peaks
        self.lined = self._has_lines() and not level
        self.edges = np.array(self._edges())
        self.width = 2 * len(self.edges)
        pairs = list(pairwise(self.edges.tolist()))
        if self.lined:
            self.lines = [self._lines(member, pairs) for member in output.members]
            return
        levels = [self._levels(member, pairs, stop) for member in output.members]
        self.least = [low for low, _ in levels]
        self.most = [high for _, high in levels]

    def _has_lines(self) -> bool:
        return self.output.output.aggregation == "max" and all(
            all(piece.straight for piece in member.pieces)
            and TNORMS[member.implication].lines is not None
            and member.implication in {"min", "product"}
            for member in self.output.members
        )

    def _edges(self) -> list[float]:
        """Return the ends of the panels: evenly spaced, and where sets begin, bend and end."""
        panels = PANELS if self.lined else LEVEL_PANELS
        return panel_edges(self.output, panels)

    def _lines(self, member: Member, pairs: list[tuple[float, float]]) -> Array:
        """Return a straight set's heights at both ends of every panel, as one-sided limits."""
        values = np.zeros((len(pairs), 2))
        for i, (a, b) in enumerate(pairs):
            # Panels end where pieces end, so the middle identifies the piece.
            middle = 0.5 * (a + b)
            piece = next(p for p in member.pieces if p.x0 <= middle <= p.x1)
            slope = (piece.y1 - piece.y0) / (piece.x1 - piece.x0)
            values[i] = piece.y0 + slope * (a - piece.x0), piece.y0 + slope * (b - piece.x0)
        return np.clip(values, 0.0, 1.0)

    def _levels(self, member: Member, pairs: list[tuple[float, float]], stop: Stop) -> Interval:
        """Return bounds of a set over every panel."""
        least, most = set_bounds(member, pairs, stop)
        # Drastic: T(s, 1) = s and T(s, y < 1) = 0 for s < 1. A single point of degree 1 has no
        # area.
        if TNORMS[member.implication].leaves_ones and not self.peaks:
            flat = plateaus(member.pieces)
            inside = [any(a <= x and y <= b for a, b in flat) for x, y in pairs]
            most = np.where(inside, most, np.minimum(most, BELOW_ONE))
        return least, most

    def bounds(self, strengths: Strengths) -> Interval:
        """Return the lower and the upper line, shape (boxes, panels, 2)."""
        if not self.lined:
            level = _aggregate(self.output, strengths, self.least, self.most)
            lower, upper = (np.stack([array, array], -1) for array in level)
            return lower, upper
        count, panels = len(strengths[0][1][0]), len(self.edges) - 1
        lower = np.zeros((count, panels, 2))
        upper = np.zeros((count, panels, 2))
        for member, (a, b) in folded_where_max(self.output, strengths):
            some = np.flatnonzero(self.lines[member].max(axis=1) > 0.0)
            line = self.lines[member][None, some]
            if self.output.members[member].implication == "product":
                under, over = a[:, None, None] * line, b[:, None, None] * line
            else:
                # A minimum of lines is concave: its chord is a lower bound, either line an upper
                # one; the line lower in the middle is the tighter one.
                under = np.minimum(a[:, None, None], line)
                middle = 0.5 * line.sum(axis=2, keepdims=True)
                over = np.where(middle < b[:, None, None], line, b[:, None, None])
            sums_under, sums_now = under.sum(axis=2), lower[:, some].sum(axis=2)
            lower[:, some] = np.where((sums_under > sums_now)[:, :, None], under, lower[:, some])
            upper[:, some] = np.maximum(upper[:, some], over)
        return lower * (1.0 - SLACK), upper * (1.0 + SLACK)


class JoinedPanels(Panels):
    """The union of sets interpolated linearly between samples.

    Between two samples the union is interpolated over its vertices, which keeps it between two
    lines. A set cut inside a cell has one more vertex at the cut; without such cuts the union is
    one line from sample to sample.
    """

    def __init__(self, output: OutputPlan, stop: Stop) -> None:
        self.samples = AggregateSamples(output)
        super().__init__(output, stop)

    def _has_lines(self) -> bool:
        return self.output.output.aggregation == "max" and all(
            member.implication in {"min", "product"} for member in self.output.members
        )

    def _edges(self) -> list[float]:
        return self.samples.positions.tolist()  # type: ignore[no-any-return]

    def _lines(self, member: Member, pairs: list[tuple[float, float]]) -> Array:
        degrees = self.samples.sets[self.output.members.index(member)]
        return np.stack([degrees[:-1], degrees[1:]], axis=1)

    def _levels(self, member: Member, pairs: list[tuple[float, float]], stop: Stop) -> Interval:
        lines = self._lines(member, pairs)
        return lines.min(axis=1), lines.max(axis=1)

    def bounds(self, strengths: Strengths) -> Interval:
        """Return the lower and the upper line, shape (boxes, cells, 2)."""
        bends = np.zeros((len(strengths[0][1][0]), len(self.edges) - 1), dtype=bool)
        for index, (a, b) in folded_where_max(self.output, strengths):
            member = self.output.members[index]
            if member.implication == "min":
                ends = self._lines(member, [])
                bends |= (b[:, None] >= ends.min(axis=1)) & (a[:, None] <= ends.max(axis=1))
        lower, upper = (
            np.stack([side[:, :-1], side[:, 1:]], axis=-1)
            for side in self.samples.bounds(strengths)
        )
        within = super().bounds(strengths)
        where = bends[:, :, None]
        return np.where(where, within[0], lower), np.where(where, within[1], upper)


def panel_edges(output: OutputPlan, panels: int) -> list[float]:
    """Return the ends of even panels, cut also where sets begin, bend and end."""
    low, high = output.output.low, output.output.high
    ends = {x for member in output.members for piece in member.pieces for x in piece[:3:2]}
    even = {low + (high - low) * i / panels for i in range(panels + 1)}
    edges = sorted({low, high, *ends, *even})
    if min(b - a for a, b in pairwise(edges)) < NARROWEST:
        raise UnprovableError(f"two corners of sets of '{output.output.name}' are next to 0")
    return edges


def set_bounds(member: Member, panels: Sequence[tuple[float, float]], stop: Stop) -> Interval:
    """Return bounds of a set, hedges included, over each panel."""
    of_stretch = membership_bounder(member.term.shape)
    bounds = []
    for low, high in panels:
        stop.check()
        least, most = of_stretch(low, high)
        degree_bounds = hedged(member.hedges, (np.array([least]), np.array([most])))
        bounds.append((float(degree_bounds[0][0]), float(degree_bounds[1][0])))
    ends = np.array(bounds)
    return ends[:, 0], ends[:, 1]
