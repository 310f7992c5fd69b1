"""How far a table is from the rule base that it stands for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.lut.axis import Axis
from fuzzyarm.lut.compiler import evaluate
from fuzzyarm.lut.numbers import number
from fuzzyarm.lut.table import LookupTable
from fuzzyarm.rulebase.model import RuleBase

_DENSE_POINTS = 160_000
_MOST_POINTS = 6_000_000
_SLAB = 262_144


@dataclass(frozen=True, slots=True)
class Fidelity:
    """The difference between a table and direct inference over a dense grid.

    Attributes
    ----------
    mode : str
        How the table was looked up.
    worst : float
        Largest absolute difference, in units of the output.
    rms : float
        Root mean square difference over the even part of the dense grid.
    at : tuple of (str, float)
        The inputs where the worst difference was found.
    points : tuple of int
        Size of the dense grid along each input.
    """

    mode: str
    worst: float
    rms: float
    at: tuple[tuple[str, float], ...]
    points: tuple[int, ...]

    def __str__(self) -> str:
        size = " x ".join(map(str, self.points))
        return f"worst {self.worst:.4g}, rms {self.rms:.4g} over {size} points"

    @property
    def place(self) -> str:
        """The inputs of the worst difference in words."""
        return ", ".join(f"{name} = {number(x)}" for name, x in self.at)


def measure_fidelity(
    table: LookupTable, rulebase: RuleBase, modes: Sequence[str] | None = None
) -> tuple[Fidelity, ...]:
    """Compare `table` with the direct inference of `rulebase`.

    The dense grid spreads about 160,000 points evenly over the ranges of the inputs. For
    the worst difference it also has every level, both sides of every threshold and the
    middle of every cell, because that is where the extremes lie.

    Parameters
    ----------
    table : LookupTable
        Compiled from `rulebase`.
    rulebase : RuleBase
        The truth.
    modes : sequence of str, optional
        Lookup modes to try; by default the table's own and ``linear``.

    Returns
    -------
    tuple of Fidelity
        One for each mode.
    """
    chosen = tuple(dict.fromkeys(modes or (table.default_mode, "linear")))
    points, weights = _dense_grid(table.axes)
    tallies = {mode: _Tally() for mode in chosen}
    rows = max(1, _SLAB // math.prod(x.size for x in points[1:]))
    for start in range(0, points[0].size, rows):
        part = [points[0][start : start + rows], *points[1:]]
        weight = np.ones(())
        for mesh in np.ix_(weights[0][start : start + rows], *weights[1:]):
            weight = weight * mesh
        truth = evaluate(rulebase, table.output, table.names, part)
        for mode in chosen:
            difference = np.abs(table.lookup(*np.ix_(*part), mode=mode) - truth)
            tallies[mode].add(difference, weight, part)
    sizes = tuple(x.size for x in points)
    return tuple(tallies[mode].result(mode, table.names, sizes) for mode in chosen)


_Points = list[NDArray[np.float64]]


def dense_points(axes: Sequence[Axis]) -> list[NDArray[np.float64]]:
    """Return the points of the dense grid along each axis, in order.

    Parameters
    ----------
    axes : sequence of Axis
        Of a table.

    Returns
    -------
    list of ndarray
        Even points over the range, every level, middle and threshold with its neighbour;
        fewer where many axes would make millions of combinations.
    """
    return _dense_grid(axes)[0]


def _dense_grid(axes: Sequence[Axis]) -> tuple[_Points, _Points]:
    """Return the points along each axis and their weights: 1 on the even ones, else 0.

    With many inputs or levels some of the points besides the even ones are given up, so
    that the grid does not explode.
    """
    count = max(3, round(_DENSE_POINTS ** (1.0 / len(axes))))
    even = [np.linspace(*_ends(axis), count) for axis in axes]
    for choose in (_levels_and_edges, _levels_and_middles, _levels, _nothing):
        points = [
            np.unique(np.concatenate([x, _inside(choose(axis), axis)]))
            for axis, x in zip(axes, even, strict=True)
        ]
        if math.prod(x.size for x in points) <= _MOST_POINTS:
            break
    weights = [np.isin(x, e).astype(np.float64) for x, e in zip(points, even, strict=True)]
    return points, weights


def _ends(axis: Axis) -> tuple[float, float]:
    low = axis.low if math.isfinite(axis.low) else axis.levels[0]
    high = axis.high if math.isfinite(axis.high) else axis.levels[-1]
    return low, high


def _inside(points: NDArray[np.float64], axis: Axis) -> NDArray[np.float64]:
    low, high = _ends(axis)
    return points[(points >= low) & (points <= high)]


def _levels_and_edges(axis: Axis) -> NDArray[np.float64]:
    """Return the levels and both sides of every threshold."""
    edges = np.array([*axis.thresholds("bins"), *axis.thresholds("nearest")])
    return np.concatenate([axis.levels, edges, np.nextafter(edges, np.inf)])


def _levels_and_middles(axis: Axis) -> NDArray[np.float64]:
    return np.array([*axis.levels, *axis.thresholds("nearest")])


def _levels(axis: Axis) -> NDArray[np.float64]:
    return np.array(axis.levels)


def _nothing(axis: Axis) -> NDArray[np.float64]:
    return np.empty(0)


class _Tally:
    """The running worst and sum of squares."""

    def __init__(self) -> None:
        self.worst = -1.0
        self.at: tuple[float, ...] = ()
        self.squares = 0.0
        self.weight = 0.0

    def add(
        self,
        difference: NDArray[np.float64],
        weight: NDArray[np.float64],
        points: Sequence[NDArray[np.float64]],
    ) -> None:
        self.squares += float(np.sum(weight * difference * difference))
        self.weight += float(np.sum(weight))
        k = int(np.argmax(difference))
        if float(difference.flat[k]) > self.worst:
            self.worst = float(difference.flat[k])
            where = np.unravel_index(k, difference.shape)
            self.at = tuple(float(x[i]) for x, i in zip(points, where, strict=True))

    def result(self, mode: str, names: Sequence[str], sizes: tuple[int, ...]) -> Fidelity:
        rms = math.sqrt(self.squares / self.weight) if self.weight else 0.0
        return Fidelity(mode, self.worst, rms, tuple(zip(names, self.at, strict=True)), sizes)
