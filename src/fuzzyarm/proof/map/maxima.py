"""Positions of the maximum of an aggregate between two bounds, as humps.

Under the aggregation max they are the maxima of the sets with the highest cut. A piecewise linear
set has humps whose ends follow from the level of its cut; for a curved one every panel of the range
is a hump. Under other aggregations the maximum is between the first and the last position at which
the upper bound reaches the maximum of the lower one.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from fuzzyarm.inference.maxima import nearest_to_zero
from fuzzyarm.inference.plan import Member, OutputPlan
from fuzzyarm.inference.quadrature import CLIPPING
from fuzzyarm.inference.sets import Piece, peak
from fuzzyarm.proof.map.aggregates import (
    LEVEL_PANELS,
    AggregateSamples,
    Panels,
    Strengths,
    folded_where_max,
    panel_edges,
    set_bounds,
)
from fuzzyarm.proof.map.arithmetic import Array
from fuzzyarm.proof.map.memberships import Interval, joined
from fuzzyarm.proof.map.position_bounds import TIE, Humps
from fuzzyarm.proof.stop import Stop
from fuzzyarm.symbolic.kinds import TNORMS

Placed = tuple[Humps, Array]
"""The humps, and a lower bound of the greatest height."""


class Maxima:
    """The maxima of one output's aggregate."""

    width: int

    def humps(self, strengths: Strengths) -> Placed:
        """Return the humps over boxes, and a lower bound of the greatest height."""
        raise NotImplementedError


def maxima(output: OutputPlan, stop: Stop) -> Maxima:
    """Return the object that locates the maxima of an output of sets."""
    sampled = output.output.defuzzifier.resolution is not None
    if output.output.aggregation == "max":
        samples = AggregateSamples(output) if sampled else None
        return _OfHighest(output, samples, stop)
    return _OfAll(
        AggregateSamples(output) if sampled else Panels(output, stop, level=True, peaks=True)
    )


def humps_of_numbers(least: Array, greatest: Array, lower: Array, upper: Array) -> Humps:
    """Return the humps of numbers between bounds: those with the largest weight."""
    leading = lower.max(axis=1, keepdims=True) * (1.0 - TIE)
    can_be = (upper > 0.0) & (upper >= leading)
    alone = can_be.sum(axis=1, keepdims=True) == 1
    one = np.ones_like(upper)
    return Humps(least, greatest, greatest, least, can_be, can_be & alone, one, one, least)


class _OfAll(Maxima):
    """Any aggregation: from the first to the last position that may be the highest."""

    def __init__(self, aggregate: AggregateSamples | Panels) -> None:
        self.aggregate, self.width = aggregate, aggregate.width
        if isinstance(aggregate, AggregateSamples):
            self.starts = self.ends = aggregate.positions
        else:
            self.starts, self.ends = aggregate.edges[:-1], aggregate.edges[1:]

    def humps(self, strengths: Strengths) -> Placed:
        lower, upper = (
            bound if bound.ndim == 2 else bound[:, :, 0]
            for bound in self.aggregate.bounds(strengths)
        )
        lead = lower.max(axis=1)
        there = (upper > 0.0) & (upper >= lead[:, None] * (1.0 - TIE))
        left = np.where(there, self.starts, np.inf).min(axis=1, keepdims=True)
        right = np.where(there, self.ends, -np.inf).max(axis=1, keepdims=True)
        can_be = there.any(axis=1, keepdims=True)
        none = np.zeros_like(left)
        never = np.zeros_like(can_be)
        return Humps(left, right, right, left, can_be, never, none, none + 1, left), lead


# ── the sets with the highest cut ────────────────────────────────────────────────────


class _Level(NamedTuple):
    """Bounds of the level at which a highest set is cut; `top`: its largest possible height."""

    low: Array
    high: Array


class _Set:
    """The humps of one set, and its height."""

    top: Interval
    count: int

    def humps(self, level: _Level, strength: Interval) -> Humps:
        """Return its humps; `certain` are those that exist whenever the set is the highest."""
        raise NotImplementedError


class _OfHighest(Maxima):
    """Aggregation max: the maxima of the sets that may have the highest cut."""

    def __init__(self, output: OutputPlan, samples: AggregateSamples | None, stop: Stop) -> None:
        self.output = output
        self.sets: list[_Set] = []
        for number, member in enumerate(output.members):
            if samples is not None:
                set_of_member: _Set = _Sampled(member, samples.positions, samples.sets[number])
            elif all(piece.straight for piece in member.pieces):
                set_of_member = _Straight(member.pieces)
            else:
                set_of_member = _Curved(member, panel_edges(output, LEVEL_PANELS), stop)
            self.sets.append(set_of_member)
        self.width = sum(one.count for one in self.sets)
        if samples is not None:
            self.width = samples.width * len(self.sets)

    def humps(self, strengths: Strengths) -> Placed:
        entries = folded_where_max(self.output, strengths)
        heights = [
            joined(TNORMS[self.output.members[index].implication], strength, self.sets[index].top)
            for index, strength in entries
        ]
        lead = np.max([low for low, _ in heights], axis=0)
        highest = [(high > 0.0) & (high >= lead * (1.0 - TIE)) for _, high in heights]
        alone = np.sum(highest, axis=0) == 1
        humps_of_sets = []
        for (index, strength), can_be in zip(entries, highest, strict=True):
            member, member_set = self.output.members[index], self.sets[index]
            humps = member_set.humps(_level(member, strength, member_set.top), strength)
            there = humps.can_be & can_be[:, None]
            humps_of_sets.append(
                humps._replace(can_be=there, certain=humps.certain & there & alone[:, None])
            )
        return Humps(
            *(np.concatenate(part, axis=1) for part in zip(*humps_of_sets, strict=True))
        ), lead


def _level(member: Member, strength: Interval, top: Interval) -> _Level:
    """Return the levels between which a set is cut: its strength if clipped, else its peak."""
    clips = CLIPPING.get(member.implication, ()) if member.implication != "bounded" else ()
    if not clips:
        return _Level(*(np.broadcast_to(end, strength[0].shape) for end in top))
    ends = [[offset + factor * end for end in strength] for offset, factor in clips]
    low = np.max([np.minimum(*pair) for pair in ends], axis=0)
    high = np.max([np.maximum(*pair) for pair in ends], axis=0)
    return _Level(np.minimum(low, top[0]), np.minimum(high, top[1]))


class _Straight(_Set):
    """A piecewise linear set."""

    def __init__(self, pieces: Sequence[Piece]) -> None:
        self.parts = [
            np.array([piece[:4] for piece in part]).T for part in _rising_and_falling(pieces)
        ]
        highest = np.array(peak(pieces))
        self.top, self.count = (highest, highest), len(self.parts)

    def humps(self, level: _Level, strength: Interval) -> Humps:
        low, high = level.low * (1.0 - TIE), np.minimum(level.high * (1.0 + TIE), self.top[0])
        return _side_by_side(self._hump(part, low, high) for part in self.parts)

    @staticmethod
    def _hump(part: Array, low: Array, high: Array) -> Sequence[Array]:
        summit = max(part[1].max(), part[3].max())
        left, right = _reach(part, low)
        latest_left, earliest_right = _reach(part, np.minimum(high, summit))
        slack = 1e-13 * (abs(part[0]).max() + abs(part[2]).max())
        can_be = (summit >= low) & (summit > 0.0)
        certain = can_be & (summit >= high)
        return (
            left - slack, right + slack, latest_left + slack, earliest_right - slack,
            can_be, certain, earliest_right - latest_left - 2.0 * slack, right - left + 2.0 * slack,
            np.zeros_like(left),
        )  # fmt: skip


def _reach(part: Array, level: Array) -> Interval:
    """Return bounds of the positions at which a hump reaches a level; 0: its begin."""
    x0, y0, x1, y1 = (row[None, :] for row in part)
    level = level[:, None]
    with np.errstate(all="ignore"):
        share = np.clip((level - y0) / (y1 - y0), 0.0, 1.0)
    crossing = x0 + share * (x1 - x0)
    there = (np.maximum(y0, y1) >= level) & (np.maximum(y0, y1) > 0.0)
    left = np.where(there, np.where(y0 >= level, x0, crossing), np.inf).min(axis=1)
    right = np.where(there, np.where(y1 >= level, x1, crossing), -np.inf).max(axis=1)
    none = ~there.any(axis=1)
    return np.where(none, x0[0, 0], left), np.where(none, x1[0, -1], right)


def _rising_and_falling(pieces: Sequence[Piece]) -> list[list[Piece]]:
    """Cut monotone pieces into humps: a rise after a fall begins the next one."""
    humps: list[list[Piece]] = [[pieces[0]]]
    falls = pieces[0].y1 < pieces[0].y0
    for before, piece in pairwise(pieces):
        falls |= piece.y0 < before.y1
        if falls and (piece.y0 > before.y1 or piece.y1 > piece.y0):
            humps.append([])
            falls = False
        humps[-1].append(piece)
        falls |= piece.y1 < piece.y0
    return humps


class _Curved(_Set):
    """Any set: each panel of the range is a hump."""

    def __init__(self, member: Member, edges: Sequence[float], stop: Stop) -> None:
        self.least, self.most = set_bounds(member, list(pairwise(edges)), stop)
        self.starts, self.ends = np.array(edges[:-1]), np.array(edges[1:])
        self.lengths = self.ends - self.starts
        self.top = self.least.max(), self.most.max()
        self.count = len(self.least)

    def humps(self, level: _Level, strength: Interval) -> Humps:
        can_be = (self.most >= level.low[:, None] * (1.0 - TIE)) & (self.most > 0.0)
        certain = can_be & (self.least >= level.high[:, None] * (1.0 + TIE))
        shape = can_be.shape
        starts, ends, length = (
            np.broadcast_to(array, shape) for array in (self.starts, self.ends, self.lengths)
        )
        latest, earliest = np.where(certain, starts, ends), np.where(certain, ends, starts)
        inmost = np.zeros(shape)
        return Humps(starts, ends, latest, earliest, can_be, certain, length, length, inmost)


class _Sampled(_Set):
    """A set at samples."""

    def __init__(self, member: Member, positions: Array, degrees: Array) -> None:
        self.norm = TNORMS[member.implication]
        self.positions, self.degrees = positions, degrees
        pairs = [
            Piece(i, degrees[i], i + 1, degrees[i + 1], straight=True)
            for i in range(len(degrees) - 1)
        ] or [Piece(0, degrees[0], 0, degrees[0], straight=True)]
        # A sample between two humps belongs to both; here to one of them.
        starts = [int(part[0].x0) for part in _rising_and_falling(pairs)]
        self.parts = [slice(a, b) for a, b in pairwise([*starts, len(degrees)])]
        self.top = degrees.max(), degrees.max()
        self.count = len(self.parts)

    def humps(self, level: _Level, strength: Interval) -> Humps:
        # A height may equal the greatest although its degree does not: hamacher of a small strength
        # is nearly that strength. So heights are compared, not degrees.
        ones = np.ones((len(level.low), 1))
        tops = (self.top[0] * ones, self.top[1] * ones)
        cuts = (strength[0][:, None], strength[1][:, None])
        lowest, _ = joined(self.norm, cuts, tops)
        _, reached = joined(self.norm, cuts, (self.degrees[None, :],) * 2)
        can_be = (reached > 0.0) & (reached >= lowest * (1.0 - TIE))
        enough = np.minimum(level.high * (1.0 + TIE), self.top[0])
        return _side_by_side(self._hump(part, can_be[:, part], enough) for part in self.parts)

    def _hump(self, part: slice, can_be: Array, enough: Array) -> Sequence[Any]:
        degrees, positions = self.degrees[part], self.positions[part]
        summit = degrees.max()
        certain = degrees >= np.minimum(enough, summit)[:, None]
        last = len(degrees) - 1
        first_can, last_can = can_be.argmax(axis=1), last - can_be[:, ::-1].argmax(axis=1)
        first, behind = certain.argmax(axis=1), last - certain[:, ::-1].argmax(axis=1)
        there = can_be.any(axis=1)
        return (
            positions[first_can], positions[last_can], positions[first], positions[behind],
            there, there & (summit >= enough), behind - first + 1.0, last_can - first_can + 1.0,
            np.full(len(can_be), nearest_to_zero(positions.tolist())),
        )  # fmt: skip


def _side_by_side(humps: Iterable[Sequence[Array]]) -> Humps:
    """Return humps, each a sequence of fields over boxes, as arrays (boxes, humps)."""
    return Humps(*(np.stack(part, axis=1) for part in zip(*humps, strict=True)))
