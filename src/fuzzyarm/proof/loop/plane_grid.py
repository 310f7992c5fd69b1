r"""Planes through a rule base, stored by cell: a band for many sets of inputs at once.

The declared ranges are cut into cells once. Each cell stores a plane and the proved band around it,
``u - p·(x - c) in l .. h``, and so do cells that are twice, four times, … as long along each axis
by itself. A set of inputs then meets a few cells, whatever its size. For any slopes k

    u - k·x  in  -k·c + [l, h] + (p - k)·(x - c),    x in the part of the cell that meets the set,

so the band around a plane of the whole set is the hull over these cells. Any plane is sound; least
squares, weighted towards the largest distances (Lawson), make the band narrow.

Beyond the range of a clamped input the surface is constant along that axis: an unbounded outer cell
with slope 0. So a set that reaches the clamp only in part loses nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.proof.loop.enclosure import Vector
from fuzzyarm.proof.map.bernstein import Quotients

Index = NDArray[np.int64]

HALVINGS = {1: 9, 2: 6, 3: 4}
"""Halvings of a range for the smallest cells, by the number of inputs."""

AT_MOST = {1: 32, 2: 8, 3: 4}
"""Most cells that a set may meet along each axis, by the number of inputs."""

ROUNDS = 3
"""Iterations of Lawson's weights."""

OFF = 2.0**-42
"""Error relative to the sum of magnitudes: 2,000 roundings, more than a band takes."""


class Bands(NamedTuple):
    """For each set: ``k·x + low`` ≤ u ≤ ``k·x + high``; shapes (sets, inputs), (sets,)."""

    slopes: Vector
    low: Vector
    high: Vector


class _Met(NamedTuple):
    """The cells that sets may meet, those of one set side by side.

    The number of cells of each set; for each cell its index, centre and half-widths of the part
    that the set may meet, and the origin of its plane.
    """

    counts: Index
    cell: Index
    middle: Vector
    half: Vector
    home: Vector

    def part(self, which: NDArray[np.bool_]) -> _Met:
        """Return selected cells."""
        sets = np.repeat(np.arange(len(self.counts)), self.counts)[which]
        index = np.flatnonzero(which)
        return _Met(
            np.bincount(sets, minlength=len(self.counts)), self.cell[index],
            self.middle.take(index, axis=1), self.half.take(index, axis=1),
            self.home.take(index, axis=1),
        )  # fmt: skip

    def spread(self, x: Vector) -> Vector:
        """Repeat the value of each set for its cells."""
        return np.repeat(x, self.counts, axis=-1)


@dataclass(frozen=True)
class _Cells:
    """Cells of one length per axis, in the order of a grid, each with a plane and its band."""

    slopes: Vector  # (*shape, n)
    low: Vector  # (*shape)
    high: Vector

    def joined(self, axis: int, edges: Sequence[Vector]) -> _Cells:
        """Return cells twice as long along an axis; `edges` are those of the present cells."""
        pick = [slice(None)] * self.low.ndim
        first, second = (_taken(self, pick, axis, start) for start in (0, 1))
        middles = 0.5 * edges[axis][1:] + 0.5 * edges[axis][:-1]
        halves = 0.5 * np.diff(edges[axis])
        shape = [1] * self.low.ndim
        shape[axis] = -1
        here, there = middles[::2].reshape(shape), middles[1::2].reshape(shape)
        middle = 0.5 * here + 0.5 * there
        slopes = 0.5 * first.slopes + 0.5 * second.slopes
        steep = (second.low + second.high - first.low - first.high) / (2.0 * (there - here))
        slopes[..., axis] = steep
        lows, highs = [], []
        for part, centre, half in ((first, here, halves[::2]), (second, there, halves[1::2])):
            away = np.abs(part.slopes - slopes)
            reach = away[..., axis] * half.reshape(shape)
            for other in range(self.low.ndim):
                if other != axis:
                    sides = [1] * self.low.ndim
                    sides[other] = -1
                    reach = reach + away[..., other] * (0.5 * np.diff(edges[other])).reshape(sides)
            shift = slopes[..., axis] * (middle - centre)
            size = np.abs(shift) + reach + np.abs(part.low) + np.abs(part.high)
            lows.append(part.low + shift - reach - OFF * size)
            highs.append(part.high + shift + reach + OFF * size)
        return _Cells(slopes, np.minimum(*lows), np.maximum(*highs))


def _taken(cells: _Cells, pick: list[slice], axis: int, start: int) -> _Cells:
    chosen = list(pick)
    chosen[axis] = slice(start, None, 2)
    index = tuple(chosen)
    return _Cells(cells.slopes[index], cells.low[index], cells.high[index])


class PlaneGrid:
    """The cells of one output, for the bands of many sets.

    Parameters
    ----------
    low, high : ndarray, shape (inputs,)
        Of the cells.
    is_clamped : sequence of bool
        By input: whether values outside are clamped, so that the surface continues level.
    cells : callable
        From edges to slopes, least and largest distance of the smallest cells.
    """

    def __init__(
        self,
        low: Vector,
        high: Vector,
        is_clamped: Sequence[bool],
        cells: Callable[[Sequence[Vector]], tuple[Vector, Vector, Vector]],
    ) -> None:
        self.low, self.high = low, high
        self.is_clamped = np.array(is_clamped)
        self.size = len(low)
        self.depth = HALVINGS[self.size]
        self.most = AT_MOST[self.size]
        finest = [np.linspace(a, b, (1 << self.depth) + 1) for a, b in zip(low, high, strict=True)]
        self.edges = [[axis[:: 1 << level] for level in range(self.depth + 1)] for axis in finest]
        self._stored: list[_Cells] = []
        self._number = np.zeros((self.depth + 1,) * self.size, dtype=np.int64)
        self._fill(_Cells(*cells(finest)))
        counts = [part.low.size for part in self._stored]
        self._offset = np.concatenate([[0], np.cumsum(counts)[:-1]])
        self._slopes = np.concatenate(
            [part.slopes.reshape(-1, self.size).T for part in self._stored], axis=1
        )
        self._lows = np.concatenate([part.low.ravel() for part in self._stored])
        self._highs = np.concatenate([part.high.ravel() for part in self._stored])
        # Edges of all levels concatenated, the outer ones at infinity.
        self._ends, self._begin = [], []
        for axis in range(self.size):
            rows = [np.concatenate([[-np.inf], e, [np.inf]]) for e in self.edges[axis]]
            self._begin.append(np.concatenate([[0], np.cumsum([len(row) for row in rows])[:-1]]))
            self._ends.append(np.concatenate(rows))

    def _fill(self, smallest: _Cells) -> None:
        """Store the cells of all lengths, with outer ones around them."""
        kept: dict[tuple[int, ...], _Cells] = {}
        for levels in product(range(self.depth + 1), repeat=self.size):
            axis = next((k for k, level in enumerate(levels) if level), None)
            if axis is None:
                kept[levels] = smallest
            else:
                finer = tuple(level - (k == axis) for k, level in enumerate(levels))
                edges = [self.edges[k][level] for k, level in enumerate(finer)]
                kept[levels] = kept[finer].joined(axis, edges)
            self._number[levels] = len(self._stored)
            self._stored.append(self._padded(kept[levels], levels))

    def _padded(self, cells: _Cells, levels: Sequence[int]) -> _Cells:
        """Return cells with outer ones added: level along their axis beyond the range."""
        slopes, low, high = cells.slopes, cells.low, cells.high
        for axis, level in enumerate(levels):
            edges = self.edges[axis][level]
            parts = [(slopes, low, high)]
            for index, side in ((0, -0.5), (-1, 0.5)):
                pick = [slice(None)] * self.size
                pick[axis] = slice(index, index + 1 or None)
                at = tuple(pick)
                # The slope becomes 0, and its share up to the end of the range moves into the band.
                shift = slopes[at][..., axis] * (side * (edges[1] - edges[0]))
                level_slopes = slopes[at].copy()
                level_slopes[..., axis] = 0.0
                more = OFF * (np.abs(shift) + np.abs(low[at]) + np.abs(high[at]))
                wall = np.where(self.is_clamped[axis], 0.0, np.inf)
                edge = (level_slopes, low[at] + shift - more - wall, high[at] + shift + more + wall)
                parts = [edge, *parts] if side < 0 else [*parts, edge]
            slopes, low, high = (
                np.concatenate([part[k] for part in parts], axis=axis) for k in range(3)
            )
        return _Cells(slopes, low, high)

    # ── questions ────────────────────────────────────────────────────────────────────

    def bands(self, centre: Vector, generators: Vector) -> Bands | None:
        """Return a plane and its band for each set; None if one is unknown.

        Sets have centres, shape (inputs, sets), and generators, shape (symbols, inputs, sets).
        """
        with np.errstate(all="ignore"):
            return self._bands(centre, generators)

    def _bands(self, centre: Vector, generators: Vector) -> Bands | None:
        radius = np.abs(generators).sum(axis=0) * (1.0 + 1e-12) + 1e-300
        # Wider by more than the rounding of an index or an edge.
        width = (self.high - self.low)[:, None]
        radius = radius + 1e-12 * (np.abs(centre) + width)
        met = self._met(centre - radius, centre + radius)
        met = met.part(self._near(met, centre, generators))
        middle, half, counts = met.middle, met.half, met.counts
        slopes = self._slopes.take(met.cell, axis=1)
        least, most = self._lows[met.cell], self._highs[met.cell]
        if not (counts.all() and np.isfinite(least + most).all()):
            return None
        begins = np.cumsum(counts) - counts
        base = (slopes * (middle - met.home)).sum(axis=0)
        size = np.abs(base) + np.abs(least) + np.abs(most) + (np.abs(slopes) * half).sum(axis=0)
        least, most = base + least, base + most
        value, unit = 0.5 * least + 0.5 * most, met.spread(radius)
        centres, thick, steep = (middle - met.spread(centre)) / unit, half / unit, slopes * unit
        weight = np.ones_like(value)
        for _ in range(ROUNDS):
            k, at = _fitted(begins, weight, centres, thick, value, steep)
            slope = met.spread(k)
            gap = value - met.spread(at) - (centres * slope).sum(axis=0)
            gap = np.abs(gap) + (np.abs(steep - slope) * thick).sum(axis=0) + 0.5 * (most - least)
            weight = weight * (gap + 0.05 * met.spread(np.maximum.reduceat(gap, begins)))
            weight = weight / met.spread(np.maximum(np.maximum.reduceat(weight, begins), 1e-300))
        k = np.where(np.isfinite(k), k, 0.0) / radius
        # u - k·x over each part of a cell, in absolute coordinates.
        slope = met.spread(k)
        line = (slope * middle).sum(axis=0)
        reach = (np.abs(slopes - slope) * half).sum(axis=0)
        size = size + np.abs(line) + reach + (np.abs(slope) * half).sum(axis=0)
        low = np.minimum.reduceat(least - line - reach - OFF * size, begins)
        high = np.maximum.reduceat(most - line + reach + OFF * size, begins)
        return Bands(k.T, low, high) if np.isfinite(high - low).all() else None

    def _met(self, first: Vector, last: Vector) -> _Met:
        """Return the cells that boxes may meet, and the part of each box in each."""
        number, levels, begins, counts = 1 << self.depth, [], [], []
        for axis in range(self.size):
            begin, whole = self.low[axis], self.high[axis] - self.low[axis]
            smallest = whole / number
            a = (first[axis] - begin) / smallest
            b = (last[axis] - begin) / smallest
            a = np.clip(np.floor(np.nan_to_num(a, nan=-1.0)), -1, number).astype(np.int64)
            b = np.clip(np.floor(np.nan_to_num(b, nan=number)), -1, number).astype(np.int64)
            level = np.zeros(first.shape[1], dtype=np.int64)
            for _ in range(self.depth):
                i, j = _coarser(a, level, number), _coarser(b, level, number)
                level = level + (j - i + 1 > self.most)
            i, j = _coarser(a, level, number), _coarser(b, level, number)
            levels.append(level)
            begins.append(i)
            counts.append(j - i + 1)
        many = np.prod(counts, axis=0)

        def spread(x: NDArray[Any]) -> NDArray[Any]:
            return np.repeat(x, many)

        points = np.arange(many.sum()) - spread(np.cumsum(many) - many)
        flat, length = spread(self._offset[self._number[tuple(levels)]]), np.array(1)
        low, high, home = np.empty((3, self.size, len(points)))
        for axis in reversed(range(self.size)):
            points, step = np.divmod(points, spread(counts[axis]))
            cell = spread(begins[axis]) + step + 1  # 0 is the outer cell
            flat = flat + length * cell
            length = length * spread((number >> levels[axis]) + 2)
            at = spread(self._begin[axis][levels[axis]]) + cell
            left, right = self._ends[axis][at], self._ends[axis][at + 1]
            low[axis] = np.maximum(left, spread(first[axis]))
            high[axis] = np.minimum(right, spread(last[axis]))
            home[axis] = np.where(
                np.isinf(left), right, np.where(np.isinf(right), left, 0.5 * (left + right))
            )
        met = _Met(many, flat, 0.5 * low + 0.5 * high, 0.5 * (high - low), home)
        return met.part(np.asarray((met.half >= 0.0).all(axis=0)))

    def _near(self, met: _Met, centre: Vector, generators: Vector) -> NDArray[np.bool_]:
        """Return which parts of cells a set may meet: separation along its principal axes."""
        keep = np.ones(len(met.cell), dtype=bool)
        if self.size == 1:
            return keep
        sides = np.moveaxis(generators, 2, 0)  # (sets, symbols, n)
        scale = np.abs(sides).sum(axis=1) + 1e-300  # (sets, n)
        scaled = sides / scale[:, None, :]
        ways = np.linalg.eigh(np.swapaxes(scaled, 1, 2) @ scaled)[1]  # any direction separates
        away = met.middle - met.spread(centre)
        for k in range(self.size):
            way = (ways[:, :, k] / scale).T  # (n, sets)
            reach = (
                np.abs((sides * way.T[:, None, :]).sum(axis=2)).sum(axis=1) * (1.0 + 1e-9) + 1e-9
            )
            reach = reach + 1e-11 * (np.abs(way) * (np.abs(centre) + 1.0)).sum(axis=0)
            way = met.spread(way)
            thick = (met.half * np.abs(way)).sum(axis=0)
            keep &= np.abs((away * way).sum(axis=0)) - thick <= met.spread(reach)
        return keep


def _coarser(index: Index, level: Index, number: int) -> Index:
    """Return the coarser cell that contains a smallest one; outer ones stay outer."""
    inner = np.clip(index, 0, number - 1) >> level
    return np.where(index < 0, -1, np.where(index >= number, number >> level, inner))


def _fitted(
    begins: Index, weight: Vector, centres: Vector, half: Vector, value: Vector, steep: Vector
) -> tuple[Vector, Vector]:
    """Return slopes and value at 0 of planes near cells, by least squares over their area.

    Cells of one set are side by side; `begins` has the index of the first.
    """
    n, count = len(centres), len(begins)

    def total(x: Vector) -> Vector:
        return np.asarray(np.add.reduceat(weight * x, begins))

    rows = np.zeros((count, n + 1, n + 1))
    right = np.zeros((count, n + 1))
    whole = np.add.reduceat(weight, begins)
    rows[:, n, n] = whole + 1e-12
    right[:, n] = total(value)
    for i in range(n):
        rows[:, i, n] = rows[:, n, i] = total(centres[i])
        # Over a box of half-width h the mean of x² is c² + h²/3, that of x u is c u + s h²/3.
        thick = half[i] * half[i] / 3.0
        right[:, i] = total(value * centres[i] + steep[i] * thick)
        for j in range(i + 1):
            square = centres[i] * centres[j] + (thick if i == j else 0.0)
            rows[:, i, j] = rows[:, j, i] = total(square)
        rows[:, i, i] += 1e-9 * whole + 1e-30
    solved = np.linalg.solve(rows, right[:, :, None])[:, :, 0]
    return np.asarray(solved[:, :n].T, float), np.asarray(solved[:, n], float)


# ── the smallest cells ───────────────────────────────────────────────────────────────


def cells_of(
    pieces: Quotients,
    edges: Sequence[Vector],
    cut_at: Callable[[Quotients, Vector], Quotients],
    values: Callable[[Quotients], Vector],
    bands: Callable[[Quotients, Vector, Vector, Vector], tuple[Vector, Vector]],
) -> tuple[Vector, Vector, Vector]:
    """Return slopes, least and largest distance of cells, from the pieces of a rule base.

    The pieces have vertices in input coordinates. The functions are from
    :mod:`fuzzyarm.proof.loop.planes`: the parts on one side of a plane, the values at the vertices,
    and the band around a plane by its slopes, its centre and its value there.
    """
    size = len(edges)
    shape = tuple(len(row) - 1 for row in edges)
    part = _spread_out(pieces, edges, shape)
    for axis in range(size):
        row = edges[axis]
        wide = row[-1] - row[0]
        more = 1e-9 * wide / shape[axis] + 1e-13 * float(np.abs(row).max())
        for sign, ends in ((1.0, row[1:]), (-1.0, row[:-1])):
            limit = ends[np.unravel_index(part.owner, shape)[axis]]
            heights = sign * (part.corners[:, :, axis] - limit[:, None]) - more
            part = cut_at(part, heights)
    cell = np.unravel_index(part.owner, shape)
    centre = np.stack(
        [0.5 * edges[axis][cell[axis]] + 0.5 * edges[axis][cell[axis] + 1] for axis in range(size)],
        axis=1,
    )
    half = np.array([0.5 * (row[1] - row[0]) for row in edges])
    number = math.prod(shape)
    height = values(part)
    known = np.isfinite(height)
    height = np.where(known, height, 0.0)
    points = (part.corners - centre[:, None, :]) / half
    slopes: Vector = np.zeros((number, size))
    at: Vector = np.zeros(number)
    weight = known.astype(float)
    columns = np.concatenate([points, np.ones((*points.shape[:2], 1))], axis=2)
    for _ in range(ROUNDS):
        rows, right = np.zeros((number, size + 1, size + 1)), np.zeros((number, size + 1))
        weighted = columns * weight[:, :, None]
        np.add.at(rows, part.owner, np.einsum("pvi,pvj->pij", weighted, columns))
        np.add.at(right, part.owner, np.einsum("pvi,pv->pi", weighted, height))
        rows += 1e-9 * np.eye(size + 1)
        solved = np.linalg.solve(rows, right[:, :, None])[:, :, 0]
        slopes, at = np.asarray(solved[:, :size], float), np.asarray(solved[:, size], float)
        line = (points * slopes[part.owner, None, :]).sum(axis=2) + at[part.owner, None]
        gap = np.where(known, np.abs(height - line), 0.0)
        top = np.zeros(number)
        np.maximum.at(top, part.owner, gap.max(axis=1))
        weight = weight * (gap + 0.05 * top[part.owner, None] + 1e-30)
        largest = np.full(number, 1e-300)
        np.maximum.at(largest, part.owner, weight.max(axis=1))
        weight = weight / largest[part.owner, None]
    slopes = slopes / half
    lows, highs = bands(part, slopes[part.owner], centre, at[part.owner])
    least, most = np.full(number, np.inf), np.full(number, -np.inf)
    np.minimum.at(least, part.owner, lows)
    np.maximum.at(most, part.owner, highs)
    empty = least > most  # no piece: unknown
    least, most = np.where(empty, -np.inf, least + at), np.where(empty, np.inf, most + at)
    more = OFF * (np.abs(at) + np.abs(least))
    return (
        slopes.reshape(*shape, size), (least - more).reshape(shape), (most + more).reshape(shape)
    )  # fmt: skip


def _spread_out(pieces: Quotients, edges: Sequence[Vector], shape: tuple[int, ...]) -> Quotients:
    """Return each piece once for each cell that it may meet, with the cell as owner."""
    firsts, counts = [], []
    for axis, row in enumerate(edges):
        wide = (row[-1] - row[0]) / shape[axis]
        low, high = pieces.corners[:, :, axis].min(axis=1), pieces.corners[:, :, axis].max(axis=1)
        first = np.clip(np.floor((low - row[0]) / wide - 1e-6), 0, shape[axis] - 1).astype(np.int64)
        last = np.clip(np.floor((high - row[0]) / wide + 1e-6), 0, shape[axis] - 1).astype(np.int64)
        firsts.append(first)
        counts.append(last - first + 1)
    many = np.prod(counts, axis=0)
    which = np.repeat(np.arange(pieces.count), many)
    step = np.arange(len(which)) - np.repeat(np.cumsum(many) - many, many)
    cell = np.zeros(len(which), dtype=np.int64)
    for axis in range(len(shape)):
        later = np.prod([np.ones_like(many), *counts[axis + 1 :]], axis=0)
        along = step // later[which] % counts[axis][which]
        cell = cell * shape[axis] + firsts[axis][which] + along
    part = pieces.select(which)
    part.owner = cell
    return part
