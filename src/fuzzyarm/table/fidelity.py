"""The error of a table against its rule base; the smallest table within a tolerance."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import TypedDict, Unpack

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.keywords import demand_arguments
from fuzzyarm.base.numbers import outward_text
from fuzzyarm.base.shown import one_line
from fuzzyarm.inference.effort import points_within
from fuzzyarm.inference.plan import part_for, plan
from fuzzyarm.language.model.rulebase import AnyRuleBase, RuleBase, model_of
from fuzzyarm.table.axis import Axis, TableError
from fuzzyarm.table.compiler import (
    Levels,
    choose_output,
    compile_table,
    evaluate,
    even_levels,
    needed_inputs,
)
from fuzzyarm.table.table import LookupTable

# --- The error of a table against its rule base ---

_DENSE_POINTS = 160_000
_MOST_POINTS = 6_000_000
_SLAB = 262_144

_FEW_POINTS = 4_096
"""Even points if each takes some tenths of a millisecond."""

_SAMPLES = 320_000_000
"""Points times samples of a sampled centroid."""

_SECONDS = 2.0
"""Time for the even points of a dense grid, and for each of the four kinds of extra points, s."""

_CORNERS = 400_000_000
"""Points times corners of a cell between which the table interpolates."""


@json_properties("mode worst=limit proved=is_proved sampled=worst rms at=point points")
@dataclass(frozen=True, slots=True, kw_only=True)
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
        The inputs at the worst difference found.
    points : tuple of int
        Size of the dense grid along each input.
    proved : float or None
        Proved bound of the difference, between the points, too; None where only points are known.
    """

    mode: str
    worst: float
    rms: float
    at: tuple[tuple[str, float], ...]
    points: tuple[int, ...]
    proved: float | None = None

    @property
    def limit(self) -> float:
        """The largest difference: proved, or of the samples."""
        return self.worst if self.proved is None else self.proved

    @property
    def is_proved(self) -> bool:
        """Whether `limit` is a proved bound."""
        return self.proved is not None

    @property
    def point(self) -> dict[str, float]:
        """The inputs at the worst difference found, by name."""
        return dict(self.at)

    def __str__(self) -> str:
        size = " x ".join(map(str, self.points))
        worst = f"{self.worst:.4g} (sampled)"
        if self.proved is not None:
            worst = f"{outward_text(self.proved, up=True, digits=6)} (proved)"
        return f"worst {worst}, rms {self.rms:.4g} over {size} points"


Proof = Callable[[LookupTable, str], float | None]
"""From a table and a mode to a bound of the difference everywhere; None if unknown."""


def measure_fidelity(
    table: LookupTable, rulebase: AnyRuleBase, modes: Sequence[str] | None = None
) -> tuple[Fidelity, ...]:
    """Compare `table` with the direct inference of `rulebase`.

    The dense grid has about 160,000 even points over the ranges of the inputs, fewer if a point
    takes long (:func:`_even_points`). For the worst difference it also has every level, both sides
    of every threshold and the centre of every cell, because extremes lie there.

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
    rulebase = model_of(rulebase)
    mode_names = tuple(dict.fromkeys(modes or (table.default_mode, "linear")))
    tallies = {mode: _Tally() for mode in mode_names}
    part = part_for(rulebase, [table.output])
    sample = _drawn_points(table.axes, _even_points(part))
    if sample is not None:
        truth = evaluate(rulebase, table.output, table.names, sample)
        for mode in mode_names:
            difference = np.abs(table.lookup(*sample, mode=mode) - truth)
            tallies[mode].add_drawn(difference, sample)
        size = (sample[0].size,)
        return tuple(tallies[mode].result(mode, table.names, size) for mode in mode_names)
    most = points_within(part, 5 * _SECONDS, least=_FEW_POINTS, most=_MOST_POINTS)
    points, weights = _dense_grid(table.axes, _even_points(part), most)
    rows = max(1, _SLAB // math.prod(x.size for x in points[1:]))
    for start in range(0, points[0].size, rows):
        slab = [points[0][start : start + rows], *points[1:]]
        weight = np.ones(())
        for share in np.ix_(weights[0][start : start + rows], *weights[1:]):
            weight = weight * share
        mesh = np.ix_(*slab)
        truth = evaluate(rulebase, table.output, table.names, mesh)
        for mode in mode_names:
            difference = np.abs(table.lookup(*mesh, mode=mode) - truth)
            tallies[mode].add(difference, weight, slab)
    sizes = tuple(x.size for x in points)
    return tuple(tallies[mode].result(mode, table.names, sizes) for mode in mode_names)


def _even_points(rulebase: RuleBase) -> int:
    """Return the number of even points of a dense grid, for the slowest output."""
    count = _DENSE_POINTS
    for output in plan(rulebase).outputs.values():
        way = output.output.defuzzifier
        if output.discrete:
            continue
        # Sampled sets cost their resolution at each point; centroids without a closed form or an
        # envelope are integrated numerically.
        if way.resolution is not None:
            count = min(count, max(_FEW_POINTS // 16, _SAMPLES // way.resolution))
        elif output.record.type2 or (output.closed is None and not output.enveloped):
            count = min(count, _FEW_POINTS)
    return points_within(rulebase, _SECONDS, least=_FEW_POINTS // 16, most=count)


_Points = list[NDArray[np.float64]]


def _drawn_points(axes: Sequence[Axis], most: int) -> _Points | None:
    """Return random points if the corners of a grid alone would be too many.

    Each coordinate is uniform in its range or one of the grid's additional ones. None if a grid is
    feasible.
    """
    if 3 ** len(axes) <= _DENSE_POINTS:
        return None
    count = min(most, max(256, _CORNERS >> len(axes)))
    draw = np.random.default_rng(len(axes))
    points = []
    for axis in axes:
        values = draw.uniform(*axis.ends, count)
        besides = draw.choice(_besides(axis)[0], count)
        points.append(np.where(draw.random(count) < 0.5, values, besides))
    return points


def dense_points(axes: Sequence[Axis]) -> list[NDArray[np.float64]]:
    """Return the points of the dense grid along each axis, in order.

    Even points over the range, every level, middle and threshold with its neighbour; fewer
    where many axes would make millions of combinations.
    """
    return _dense_grid(axes)[0]


def _dense_grid(
    axes: Sequence[Axis], wanted: int = _DENSE_POINTS, most: int = _MOST_POINTS
) -> tuple[_Points, _Points]:
    """Return the points along each axis and their weights: 1 on the even ones, else 0.

    With many inputs or levels some of the points besides the even ones are dropped, to limit the
    size of the grid.
    """
    count = max(3, round(wanted ** (1.0 / len(axes))))
    most = most if wanted == _DENSE_POINTS else min(most, 5 * wanted)
    even = [np.linspace(*axis.ends, count) for axis in axes]
    for besides in zip(*map(_besides, axes), strict=True):
        points = [np.unique(np.concatenate(pair)) for pair in zip(even, besides, strict=True)]
        if math.prod(x.size for x in points) <= most:
            break
    weights = [np.isin(x, e).astype(np.float64) for x, e in zip(points, even, strict=True)]
    return points, weights


def _besides(axis: Axis) -> _Points:
    """Return the points besides even ones: all, a part, none."""
    levels, middles = np.array(axis.levels), np.array(axis.thresholds("nearest"))
    edges = np.array([*axis.thresholds("bins"), *middles])
    # A threshold belongs to the lower cell, the next float to the upper one.
    both_sides = [edges, np.nextafter(edges, np.inf)]
    choices = [[levels, *both_sides], [levels, middles], [levels], [np.empty(0)]]
    low, high = axis.ends
    return [x[(x >= low) & (x <= high)] for x in map(np.concatenate, choices)]


class _Tally:
    """The running worst and sum of squares."""

    worst = -1.0
    at: tuple[float, ...] = ()
    squares = 0.0
    weight = 0.0

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

    def add_drawn(self, difference: NDArray[np.float64], points: _Points) -> None:
        """Add scattered points, all of one weight."""
        self.squares += float(np.sum(difference * difference))
        self.weight += difference.size
        k = int(np.argmax(difference))
        self.worst = float(difference[k])
        self.at = tuple(float(x[k]) for x in points)

    def result(self, mode: str, names: Sequence[str], sizes: tuple[int, ...]) -> Fidelity:
        rms = math.sqrt(self.squares / self.weight) if self.weight else 0.0
        return Fidelity(
            mode=mode,
            worst=self.worst,
            rms=rms,
            at=tuple(zip(names, self.at, strict=True)),
            points=sizes,
        )


# --- Find the smallest even grid whose linear interpolation meets a tolerance ---
#
# Every number of levels is tried in turn, because the error does not fall monotonically: a grid
# whose levels meet the kinks of the surface beats larger ones. A trial is cheap: the interpolation
# is first computed at a few thousand probes only, refuters of earlier grids first. Two
# cases are excluded beforehand: the surface jumps, or it bends within a step of the finest grid by
# more than the tolerance.

LIMITS = {1: 20_001, 2: 1_001, 3: 101, 4: 33}
"""Largest number of levels tried for each input, by the number of inputs; 17 for more."""

_PROBES = 2_048

_FIRST_PROBES = 64
"""Number of first probes: they refute most grids."""

_WINDOWS = 96
"""Intervals along each input searched for bends; fewer if a point takes long."""

_LINES, _MARKS, _HALVINGS = 24, 33, 60
"""Lines along each input on which jumps are looked for, marks on each, halvings between two."""

_SEARCH_SECONDS = 60.0
"""Approximate time for trying grids, s; fewer are tried if a point takes long."""


def smallest_even_grid(
    rulebase: RuleBase,
    output: str | None,
    tolerance: float,
    *,
    progress: Callable[[str], None] | None = None,
    proof: Proof | None = None,
) -> int:
    """Return the fewest levels (the same number for every input) that meet `tolerance`.

    The result is measured with :func:`fuzzyarm.table.measure_fidelity`, and a bound by `proof`
    meets the tolerance, too.
    """
    if not (tolerance > 0 and math.isfinite(tolerance)):
        raise TableError(f"a tolerance is a positive number, not {tolerance:g}")
    target = choose_output(rulebase, output)
    inputs = len(needed_inputs(rulebase, target.name))
    limit = LIMITS.get(inputs, 17)
    if progress is not None:
        progress("looking for jumps and bends")
    probes = _Probes(rulebase, target.name)
    first = probes.fewest(limit, tolerance)
    part = part_for(rulebase, [target.name])
    trials = points_within(part, _SEARCH_SECONDS, least=1, most=1 << 40) >> inputs
    limit = min(limit, first + max(64, trials // _FIRST_PROBES))
    best = math.inf
    for count in range(first, limit + 1):
        if progress is not None:
            progress(f"trying {count} levels")
        worst = probes.worst(count, tolerance)
        if worst <= tolerance:
            table = compile_table(rulebase, target.name, levels=count, rounding=0.0)
            measured = measure_fidelity(table, rulebase, ("linear",))[0]
            worst = measured.worst
            if worst > tolerance:
                probes.remember([x for _, x in measured.at])
            else:
                bound = None if proof is None else proof(table, "linear")
                worst = worst if bound is None else bound
                if worst <= tolerance:
                    return count
        best = min(best, worst)
    raise TableError(
        f"no even grid of up to {limit} levels for each input meets {tolerance:g}; "
        f"the best differs by {best:.4g}",
        hint="a tolerance above that is met; --levels takes any number of levels",
    )


class _Probes:
    """Points at which a grid is tried before it is built."""

    def __init__(self, rulebase: RuleBase, output: str) -> None:
        self.rulebase = rulebase
        self.output = output
        inputs = needed_inputs(rulebase, output)
        self.names = [variable.name for variable in inputs]
        ends = [even_levels(variable, 2) for variable in inputs]
        self.low = np.array([low for low, _ in ends])
        self.high = np.array([high for _, high in ends])
        spread = np.random.default_rng(1).random((_PROBES, len(ends)))
        self.points = self.low + spread * (self.high - self.low)
        points = points_within(part_for(rulebase, [output]), 1.0, least=1, most=100_000)
        self.windows = min(_WINDOWS, max(8, points // (50 * len(ends))))
        self.lines = min(_LINES, max(4, points // ((_MARKS + _HALVINGS) * len(ends))))
        self.truth = self._infer(self.points.T)

    def remember(self, point: list[float]) -> None:
        """Move a point that refuted a grid to the front."""
        self.points = np.vstack([point, self.points])
        self.truth = np.append(self._infer(self.points[:1].T), self.truth)

    def worst(self, count: int, tolerance: float) -> float:
        """Return the worst difference of a grid of `count` levels; stop at the first part over."""
        worst = 0.0
        for part in (slice(0, _FIRST_PROBES), slice(_FIRST_PROBES, None)):
            value = self._interpolate(self.points[part], count)
            worst = max(worst, float(np.max(np.abs(value - self.truth[part]), initial=0.0)))
            if worst > tolerance:
                break
        return worst

    def fewest(self, limit: int, tolerance: float) -> int:
        """Return a number of levels that no grid within the tolerance has fewer of."""
        jump, where = self._jump()
        if 0.5 * jump > tolerance:
            at = ", ".join(f"{name} = {x:.6g}" for name, x in zip(self.names, where, strict=True))
            raise TableError(
                f"no table of even levels meets {tolerance:g}: the surface jumps by {jump:.4g}"
                f" at {at}",
                hint="no interpolation follows a jump; --mode bins looks up without one",
            )
        bend = self._bend(limit)
        if bend > tolerance:
            raise TableError(
                f"no even grid of up to {limit} levels for each input meets {tolerance:g}:"
                f" the surface bends by {bend:.4g} or more within a step of the finest",
                hint="a tolerance above that is met by more levels",
            )
        low, high = 1, limit
        while high - low > 1 + low // 16:
            middle = max(low + 1, math.isqrt(low * high) if low > 1 else (low + high) // 4 + 1)
            low, high = (middle, high) if self._bend(middle) > tolerance else (low, middle)
        return low + 1

    def _bend(self, count: int) -> float:
        """Return a lower bound of the error of all grids of up to `count` levels, along each input.

        An interval shorter than a step has at most one level. One of its halves has none, so the
        interpolation is linear there: it misses one of three points by a quarter of their second
        difference.
        """
        steps = 0.999 * (self.high - self.low) / (count - 1)
        bend = 0.0
        for axis, step in enumerate(steps):
            points = np.repeat(self.points[None, -self.windows :], 5, axis=0)
            start = np.minimum(points[0, :, axis], self.high[axis] - step)
            points[:, :, axis] = start + step * np.linspace(0.0, 1.0, 5)[:, None]
            y = self._infer(np.moveaxis(points, 2, 0))
            halves = np.abs(y[[0, 2]] - 2.0 * y[[1, 3]] + y[[2, 4]]) / 4.0
            bend = max(bend, float(halves.min(axis=0).max()))
        return bend

    def _jump(self) -> tuple[float, Sequence[float]]:
        """Return the highest jump found along the inputs, and its position."""
        highest, where = 0.0, self.low.tolist()
        for axis in range(len(self.names)):
            lines = np.repeat(self.points[None, -self.lines :], _MARKS, axis=0)
            marks = np.linspace(self.low[axis], self.high[axis], _MARKS)
            lines[:, :, axis] = marks[:, None]
            y = self._infer(np.moveaxis(lines, 2, 0))
            steepest = np.abs(np.diff(y, axis=0)).argmax(axis=0)
            columns = np.arange(self.lines)
            a, b = lines[steepest, columns].copy(), lines[steepest + 1, columns].copy()
            fa, fb = y[steepest, columns], y[steepest + 1, columns]
            for _ in range(_HALVINGS):
                middle = 0.5 * (a + b)
                f_middle = self._infer(middle.T)
                left = np.abs(f_middle - fa) > np.abs(fb - f_middle)
                a, b = np.where(left[:, None], a, middle), np.where(left[:, None], middle, b)
                fa, fb = np.where(left, fa, f_middle), np.where(left, f_middle, fb)
            # Largest rise of a line between levels from one float to the next.
            rise = LIMITS[1] * np.abs(b - a).max(axis=1) / (self.high[axis] - self.low[axis])
            jumps = np.abs(fb - fa) - rise * float(np.ptp(y))
            if float(jumps.max()) > highest:
                highest, where = float(jumps.max()), b[int(jumps.argmax())].tolist()
        return highest, where

    def _interpolate(self, points: NDArray[np.float64], count: int) -> NDArray[np.float64]:
        """Return the interpolation at `points` from the corners of their cells alone."""
        steps = (points - self.low) / (self.high - self.low) * (count - 1)
        lower = np.clip(np.floor(steps), 0, count - 2)
        share = steps - lower
        corners = np.array(list(product((0, 1), repeat=points.shape[1])))
        index = lower[None] + corners[:, None]
        levels = self.low + index * ((self.high - self.low) / (count - 1))
        weight = np.where(corners[:, None] == 1, share[None], 1.0 - share[None]).prod(axis=2)
        values = self._infer(np.moveaxis(levels, 2, 0))
        return np.asarray((weight * values).sum(axis=0))

    def _infer(self, columns: NDArray[np.float64]) -> NDArray[np.float64]:
        from fuzzyarm.inference import infer

        inputs: dict[str, float | NDArray[np.float64]] = dict(zip(self.names, columns, strict=True))
        return np.asarray(
            infer(self.rulebase, inputs, outputs=[self.output])[self.output], dtype=np.float64
        )


# --- Compile with a report on the error; or find the smallest table within a tolerance ---


@json_properties(
    "output=table.output index=table.names shape=table.shape cells=table.cells default_levels"
    " tolerance mode=table.default_mode errors=fidelities"
)
@dataclass(frozen=True, slots=True, repr=False, kw_only=True)
class CompileReport:
    """A compiled table and its error.

    Attributes
    ----------
    table : LookupTable
        With the differences in its provenance.
    fidelities : tuple of Fidelity
        The difference to direct inference, one for each tried lookup mode.
    default_levels : bool
        Whether an input got the default 13 even levels.
    tolerance : float or None
        The requested tolerance.
    few_points : bool
        Whether the dense grid is reduced, because a point takes long.
    """

    table: LookupTable
    fidelities: tuple[Fidelity, ...]
    default_levels: bool = False
    tolerance: float | None = None
    few_points: bool = False

    def __repr__(self) -> str:
        words = "; ".join(f"{fidelity.mode}: {fidelity}" for fidelity in self.fidelities)
        return one_line(self, f"{self.table!r}: {words}")


class ReportKeywords(TypedDict, total=False):
    """Keywords of `compile_with_report`.

    Attributes
    ----------
    tolerance : float
        Instead of `levels`: find the smallest even grid, equally many levels for every input, whose
        linear interpolation is within this tolerance on a dense grid, and everywhere if `proof` has
        a bound. Levels, bins and rounding of the file are then ignored.
    progress : callable
        Called with a word on the current step.
    proof : callable
        From a table and a mode to a bound of the difference everywhere, or None:
        :func:`fuzzyarm.proof.map.table_proof`.
    levels, rounding, mode, source, date
        As for :func:`fuzzyarm.table.compile_table`.
    """

    levels: Levels | Mapping[str, Levels] | None
    rounding: float | None
    mode: str | None
    tolerance: float | None
    source: str | Path | None
    date: str | None
    progress: Callable[[str], None] | None
    proof: Proof | None


def compile_with_report(
    rulebase: AnyRuleBase,
    output: str | None = None,
    **keywords: Unpack[ReportKeywords],
) -> CompileReport:
    """Compile a table and measure it against direct inference.

    Parameters
    ----------
    rulebase, output
        As for :func:`fuzzyarm.table.compile_table`.
    **keywords
        ``levels``, ``rounding``, ``mode``, ``tolerance``, ``source``, ``date``, ``progress``,
        ``proof``; see :class:`~fuzzyarm.table.fidelity.ReportKeywords`.

    Returns
    -------
    CompileReport
        The table and its differences.

    Raises
    ------
    TableError
        As `compile_table`; also if no grid within the limits meets the tolerance.
    """
    demand_arguments("compile_with_report", keywords, ReportKeywords)
    rulebase, tolerance = model_of(rulebase), keywords.get("tolerance")
    levels, rounding = keywords.get("levels"), keywords.get("rounding")
    mode, progress, proof = keywords.get("mode"), keywords.get("progress"), keywords.get("proof")
    if tolerance is not None:
        count = smallest_even_grid(rulebase, output, tolerance, progress=progress, proof=proof)
        levels, rounding, mode = count, 0.0, "linear"
    table = compile_table(
        rulebase,
        output,
        levels=levels,
        rounding=rounding,
        mode=mode,
        source=keywords.get("source"),
        date=keywords.get("date"),
    )
    fidelities = measure_fidelity(table, rulebase)
    if proof is not None:
        if progress is not None:
            progress("proving the worst difference")
        fidelities = tuple(
            replace(measure, proved=proof(table, measure.mode)) for measure in fidelities
        )
    provenance = dict(table.provenance)
    if tolerance is not None:
        provenance["sampled"] = f"at the fewest even levels within {tolerance:g} (linear)"
    for fidelity in fidelities:
        provenance[f"error-{fidelity.mode}"] = str(fidelity)
    axes_of_file = {axis.variable for axis in rulebase.lookup.axes} if rulebase.lookup else set()
    by_levels = levels if isinstance(levels, Mapping) else () if levels is None else table.names
    axes_by_levels = set(by_levels)
    return CompileReport(
        table=table.with_values(table.values, provenance),
        fidelities=fidelities,
        default_levels=bool(set(table.names) - axes_of_file - axes_by_levels),
        tolerance=tolerance,
        few_points=_even_points(part_for(rulebase, [table.output])) < _DENSE_POINTS,
    )
