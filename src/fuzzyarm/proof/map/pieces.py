"""The inputs of a rule base cut into simplices on which every height is affine.

1. Each input is cut at the corners of its terms, at the levels at which the aggregate of the
   output changes form, and at the caller's cuts (levels of a table). A cell is one interval
   of each input; within it every membership is linear in one input. Positions are in cell
   coordinates, 0 to 1, so that no slope is steep.
2. A cell falls into d! simplices (Kuhn); cells whose memberships run the other way are
   mirrored, so that the cuts of the next step mostly fall on existing edges.
3. A simplex with an undecided minimum or maximum of two heights, or layer of the aggregate, is
   cut there: a new vertex on one edge, two simplices for one, until no simplex has both signs
   among its vertices.

Then heights are affine, the area has at most degree 2 and the moment degree 3. All simplices are
processed at once, rule by rule, in floats or in rationals. Floats may take the wrong one of two
heights that differ by rounding: the value is off by as little, the slope by any amount, so that
slopes need rationals.

Source of the triangulation: H. W. Kuhn, *Some combinatorial lemmas in topology*, 1960.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import pairwise, permutations
from typing import Any, NamedTuple

import numpy as np

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.inference.overlap import ClosedForm, Layers
from fuzzyarm.proof.map.arithmetic import (
    Arithmetic,
    Array,
    any_of_rows,
    greatest_of_rows,
    least_of_rows,
    sums_of_rows,
)
from fuzzyarm.proof.map.straight import (
    Corners,
    Straight,
    StraightAntecedent,
    StraightRule,
    height_at,
)
from fuzzyarm.proof.stop import Stop

MOST_PIECES = 2_000_000
"""Most simplices of one cut."""

MOST_NUMBERS = 200_000_000
"""Most numbers in all simplices, corners, heights and slopes: 1.6 GB in floats."""

FEW_LEVELS = 3
"""Most levels of the aggregate at which inputs are cut; with more it is cheaper to cut single
simplices where a height passes a level."""

SAME = 4e-15
"""Largest difference of two heights (0 to 1) that floats take for equal."""


class TooManyPiecesError(FuzzyarmError, ValueError):
    """A rule base has too many pieces."""

    def __init__(self, count: int, most: int) -> None:
        counted = f" ({count:,} and counting)" if count < 10**9 else ""
        super().__init__(f"more than {most:,} pieces{counted}")


class Cell(NamedTuple):
    """An interval of one input; a point where a term has a separate value."""

    left: Fraction
    right: Fraction


class Cut(NamedTuple):
    """The box of the inputs, and further cuts."""

    box: tuple[tuple[Fraction, Fraction], ...]  # the interval of each input
    positions: tuple[Sequence[Fraction], ...] = ()  # further cuts of each input
    # Whether to add the heights at the opposite point (inputs negated), in columns after the others
    mirrored: bool = False
    form: tuple[Fraction, ...] = ()  # weights of a sum of the inputs; pieces are cut at its zeros
    # Another rule base over the same inputs, with its heights in columns after the others
    other: Straight | None = None
    # Whether the function compared with the rules jumps just above each of `positions`
    steps: bool = False


class System(NamedTuple):
    """Heights over the pieces: of the rule base, at the opposite point, or of another rule base."""

    model: Straight  # the rule base
    shift: int  # index of its first proposition
    first: int  # index of its first column


def _systems_of(model: Straight, region: Cut) -> tuple[System, ...]:
    own = System(model, 0, 0)
    second = model if region.mirrored else region.other
    if second is None:
        return (own,)
    return own, System(second, len(model.propositions), model.columns)


# ── one input ────────────────────────────────────────────────────────────────────────


class PieceGrid:
    """The cells of each input, and every membership at both ends of each.

    Attributes
    ----------
    cells : list of list of Cell
        For each input.
    ends : list of (Array, Array)
        For each proposition: one-sided limits of its membership at the left and right ends of the
        cells of its input. Those of the second system come after the others.
    inputs : list of int
        The input of each proposition.
    jumps : list of bool
        For each input, whether a membership jumps within the box.
    opened : list of ndarray of bool, shape (cells, 2)
        For each input, whether its cells exclude their left and right ends: a membership has
        another value there.
    rises : list of Array
        For each proposition: by how much its membership rises within each cell of its input.
    """

    def __init__(self, model: Straight, region: Cut, arithmetic: Arithmetic, stop: Stop) -> None:
        self.arithmetic = arithmetic
        self.stop = stop
        lines = [(proposition.input, proposition.corners) for proposition in model.propositions]
        if region.mirrored:
            lines += [(i, _mirrored(corners)) for i, corners in lines]
        if region.other is not None:
            lines += [(each.input, each.corners) for each in region.other.propositions]
        self.inputs = [i for i, _ in lines]
        levels = _levels_of(model)
        if region.other is not None:
            levels += _levels_of(region.other)
        self.cells: list[list[Cell]] = []
        self.jumps: list[bool] = []
        self.opened: list[Array] = []
        exact: list[tuple[list[Fraction], list[Fraction]]] = [([], []) for _ in lines]
        for i, (low, high) in enumerate(region.box):
            own_lines = [(n, corners) for n, (owner, corners) in enumerate(lines) if owner == i]
            extra = list(region.positions[i]) if region.positions else []
            cuts = _cuts([corners for _, corners in own_lines], low, high, extra, levels)
            cells, opened = self._cells_of(
                cuts, own_lines, exact, set(extra) if region.steps else set()
            )
            self.cells.append(cells)
            self.jumps.append(bool(opened.any()))
            self.opened.append(opened)
        self.ends = [(arithmetic.array(a), arithmetic.array(b)) for a, b in exact]
        # Of a thin cell the difference of both rounded ends would be nothing but rounding.
        self.rises = [
            arithmetic.array([right - left for left, right in zip(*ends, strict=True)])
            for ends in exact
        ]

    def _cells_of(
        self,
        cuts: list[Fraction],
        own_lines: list[tuple[int, Corners]],
        exact: list[tuple[list[Fraction], list[Fraction]]],
        steps: set[Fraction],
    ) -> tuple[list[Cell], Array]:
        cells: list[Cell] = []
        opened: list[list[bool]] = []
        stretches = list(pairwise(cuts))
        lines = []
        for a, b in stretches:
            self.stop.check()  # a thousand terms have a million ends
            lines.append([_line_between(corners, a, b) for _, corners in own_lines])
        for index, x in enumerate(cuts):
            self.stop.check()
            at = [height_at(corners, x) for _, corners in own_lines]
            before = [b for _, b in lines[index - 1]] if index else None
            after = [a for a, _ in lines[index]] if index < len(lines) else None
            if before is not None:
                opened[-1][1] = at != before
            sides = (before,) if x in steps else (before, after)
            if at not in sides:  # a value unlike both sides, or with a table this point only
                cells.append(Cell(x, x))
                opened.append([False, False])
                for (number, _), value in zip(own_lines, at, strict=True):
                    exact[number][0].append(value)
                    exact[number][1].append(value)
            if after is not None:
                cells.append(Cell(*stretches[index]))
                opened.append([at != after, False])
                for (number, _), (a, b) in zip(own_lines, lines[index], strict=True):
                    exact[number][0].append(a)
                    exact[number][1].append(b)
        return cells, np.array(opened)


def _mirrored(corners: Corners) -> Corners:
    return tuple((-x, y) for x, y in reversed(corners))


def _levels_of(model: Straight) -> tuple[Fraction, ...]:
    """Return the heights at which the aggregate changes form, if few."""
    if model.form is None:
        return ()
    layers = [layer for layers in model.form.set_layers for layer in layers]
    layers += [layer for overlap in model.form.overlaps for layer in overlap.layers]
    ends = {Fraction(layer.start) for layer in layers}
    ends |= {Fraction(layer.start + layer.depth) for layer in layers}
    levels = sorted(level for level in ends if 0 < level < 1)
    return tuple(levels) if len(levels) <= FEW_LEVELS else ()


def _cuts(
    lines: Sequence[Corners],
    low: Fraction,
    high: Fraction,
    extra: Sequence[Fraction],
    levels: Sequence[Fraction],
) -> list[Fraction]:
    positions = {x for corners in lines for x, _ in corners} | set(extra)
    for corners in lines:
        for (x0, y0), (x1, y1) in pairwise(corners):
            for level in levels:
                if (y0 - level) * (y1 - level) < 0 and x0 < x1:
                    positions.add(x0 + (level - y0) / (y1 - y0) * (x1 - x0))
    inner = sorted(x for x in positions if low < x < high)
    return [low, *inner, high] if low < high else [low]


def _line_between(corners: Corners, a: Fraction, b: Fraction) -> tuple[Fraction, Fraction]:
    """Return the one-sided limits of a line at both ends of an interval without corners."""
    if a < corners[0][0] or b <= corners[0][0]:
        return corners[0][1], corners[0][1]
    if a >= corners[-1][0]:
        return corners[-1][1], corners[-1][1]
    for (x0, y0), (x1, y1) in pairwise(corners):
        if x0 <= a and b <= x1 and x0 < x1:
            slope = (y1 - y0) / (x1 - x0)
            return y0 + slope * (a - x0), y0 + slope * (b - x0)
    raise AssertionError("a stretch with a corner inside")


# ── all inputs ───────────────────────────────────────────────────────────────────────


class _Affine(NamedTuple):
    """A height on some simplices: values at the vertices, slopes along the inputs."""

    values: Array
    slopes: Array


class Pieces:
    """Simplices on which every height is affine.

    Attributes
    ----------
    grid : PieceGrid
        The cells.
    corners : ndarray, shape (pieces, vertices, inputs)
        The vertices, in cell coordinates.
    cell : ndarray of int, shape (pieces, inputs)
        The cell of each input.
    heights : ndarray, shape (pieces, vertices, columns)
        The heights of every column.
    slopes : ndarray, shape (pieces, inputs, columns)
        Of the heights, by cell coordinates.
    count : int
        Number of pieces.
    """

    def __init__(
        self,
        model: Straight,
        region: Cut,
        arithmetic: Arithmetic,
        only: Array | None = None,
        stop: Stop | None = None,
    ) -> None:
        self.model = model
        self.stop = stop or Stop()
        self.arithmetic = arithmetic
        self.grid = PieceGrid(model, region, arithmetic, self.stop)
        self.systems = _systems_of(model, region)
        dimension = len(region.box)
        numbers = [len(cells) for cells in self.grid.cells]
        columns = sum(system.model.columns for system in self.systems)
        numbers_of_each = (dimension + 1) * (dimension + columns) + dimension * columns
        self.most = min(MOST_PIECES, MOST_NUMBERS // numbers_of_each)
        count = math.prod(numbers) if only is None else len(only)
        self._demand_few(count * math.factorial(dimension))
        orders = np.array(list(permutations(range(dimension))))
        flat = np.arange(count) if only is None else np.asarray(only)
        cells = np.stack(np.unravel_index(flat, numbers), axis=1)
        self.count = count * len(orders)
        # Allocated with reserve, so that cutting a few pieces does not copy all of them.
        self._cell = np.repeat(cells, len(orders), axis=0)
        self._corners = self._simplices(cells, orders)
        self._heights = arithmetic.zeros(self.count, dimension + 1, columns)
        self._slopes = arithmetic.zeros(self.count, dimension, columns)

    @property
    def cell(self) -> Array:
        """The cell of each input, for each piece."""
        return self._cell[: self.count]

    @property
    def corners(self) -> Array:
        """The vertices, in cell coordinates."""
        return self._corners[: self.count]

    @property
    def heights(self) -> Array:
        """The heights at the vertices."""
        return self._heights[: self.count]

    @property
    def slopes(self) -> Array:
        """The slopes of the heights, by cell coordinates."""
        return self._slopes[: self.count]

    def _demand_few(self, count: int) -> None:
        if count > self.most:
            raise TooManyPiecesError(count, self.most)

    def _reserve(self, count: int) -> None:
        self._demand_few(count)
        capacity = len(self._cell)
        if count <= capacity:
            return
        more = min(max(count, 2 * capacity), self.most) - capacity
        for name in ("_cell", "_corners", "_heights", "_slopes"):
            array = getattr(self, name)
            grown = np.empty((capacity + more, *array.shape[1:]), dtype=array.dtype)
            grown[:capacity] = array
            setattr(self, name, grown)

    @property
    def flat_cells(self) -> Array:
        """The flat index of each piece's cell, as in `only`."""
        numbers = [len(cells) for cells in self.grid.cells]
        return np.asarray(np.ravel_multi_index(tuple(self.cell.T), numbers))

    def widths(self, which: int) -> Array:
        """Return the width of each piece's cell along an input."""
        cells = self.grid.cells[which]
        return self.arithmetic.array([c.right - c.left for c in cells])[self.cell[:, which]]

    def position(self, owner: int, corner: Array) -> list[Fraction]:
        """Return the inputs at a point in cell coordinates of a piece."""
        from fuzzyarm.proof.map.arithmetic import as_fraction

        positions = []
        for i, share in enumerate(corner):
            left, right = self.grid.cells[i][self.cell[owner, i]]
            positions.append(left + (right - left) * as_fraction(share))
        return positions

    def holds(self, which: Array, shares: Array) -> Array:
        """Return at which points (cell coordinates) memberships are their limits from inside."""
        held = np.ones(len(which), dtype=bool)
        for i, opened in enumerate(self.grid.opened):
            ends = opened[self.cell[which, i]]
            held &= ~(ends[:, 0] & (shares[:, i] == 0)) & ~(ends[:, 1] & (shares[:, i] == 1))
        return held

    def _simplices(self, cells: Array, orders: Array) -> Array:
        count, dimension = cells.shape
        # Kuhn: each simplex is a walk between opposite corners of the cell, axis by axis in one of
        # d! orders; its vertices are the d + 1 corners on the walk.
        turn = orders.argsort(axis=1)  # the step at which each axis is walked
        unit = np.arange(dimension + 1)[None, :, None] > turn[:, None, :]
        shape = np.tile(unit, (count, 1, 1))
        for axis in range(dimension):
            mirrored = self._runs_backwards(axis)[cells[:, axis]]
            which = np.repeat(mirrored, len(orders))
            shape[which, :, axis] = ~shape[which, :, axis]
        values: Array = self.arithmetic.zeros(*shape.shape)
        values[shape] = self.arithmetic.number(Fraction(1))
        return values

    def _runs_backwards(self, axis: int) -> Array:
        """Return the cells with reversed memberships, so that diagonals of neighbours meet."""
        ends = [e for i, e in zip(self.grid.inputs, self.grid.ends, strict=True) if i == axis]
        marks = []
        for cell in range(len(self.grid.cells[axis])):
            pairs = [(float(a[cell]), float(b[cell])) for a, b in ends]
            there = sorted(pair for pair in pairs if any(pair))
            back = sorted((b, a) for a, b in there)
            marks.append(back < there)
        return np.array(marks, dtype=bool)

    # ── the rules, one after the other ───────────────────────────────────────────────

    def fire(self) -> None:
        """Fill in the heights rule by rule, cutting at every kink of a height.

        Products of memberships have no columns: they are formed on demand.
        """
        for system in self.systems:
            for rule in () if system.model.multiplies else system.model.rules:
                self._fire_rule(rule, system)
        for system in self.systems:
            if not system.model.multiplies and system.model.form is not None:
                self._cut_at_layers(system.model.form, system.first)

    def _fire_rule(self, rule: StraightRule, system: System) -> None:
        weight = self.arithmetic.number(rule.weight)
        shift, first, adds = system.shift, system.first, system.model.adds

        def strength(which: Array, undecided: list[Array]) -> _Affine:
            truth = self._truth(rule.antecedent, which, shift, undecided)
            if rule.weight == 1:
                return truth
            return _Affine(truth.values * weight, truth.slopes * weight)

        def undecided_on(which: Array) -> list[Array]:
            undecided: list[Array] = []
            truth = strength(which, undecided)
            for column in () if adds else rule.columns:
                so_far = self._height(first + column, which)
                undecided.append(truth.values - so_far.values)
            return undecided

        which = np.flatnonzero(self.may_fire(rule.antecedent, shift))
        which = self._refine(which, undecided_on)
        truth = strength(which, [])
        for column in rule.columns:
            if adds:
                self.heights[which, :, first + column] += truth.values
                self.slopes[which, :, first + column] += truth.slopes
                continue
            so_far = self._height(first + column, which)
            highest = _chosen(so_far, truth, largest=True)
            self.heights[which, :, first + column] = highest.values
            self.slopes[which, :, first + column] = highest.slopes

    def _height(self, column: int, which: Array) -> _Affine:
        return _Affine(self.heights[which, :, column], self.slopes[which, :, column])

    def may_fire(self, node: StraightAntecedent, shift: int) -> Array:
        """Return the pieces in whose cells an antecedent may be above 0."""
        if node.kind == "is":
            number = node.proposition + shift
            left, right = self.grid.ends[number]
            cells: Array = (left > 0) | (right > 0)
            return cells[self.cell[:, self.grid.inputs[number]]]
        if node.kind in {"not", "one"}:
            return np.ones(self.count, dtype=bool)
        parts = [self.may_fire(operand, shift) for operand in node.operands]
        together = np.logical_or if node.kind in {"max", "bounded or"} else np.logical_and
        return np.asarray(together.reduce(parts))

    def _truth(
        self, node: StraightAntecedent, which: Array, shift: int, undecided: list[Array]
    ) -> _Affine:
        """Return an antecedent on some pieces; collect undecided comparisons, innermost first."""
        dimension = self.corners.shape[2]
        if node.kind == "is":
            number = node.proposition + shift
            axis = self.grid.inputs[number]
            cells = self.cell[which, axis]
            left, right = (end[cells] for end in self.grid.ends[number])
            slopes = self.arithmetic.zeros(len(which), dimension)
            slopes[:, axis] = self.grid.rises[number][cells]
            share = self.corners[which, :, axis]
            return _Affine(left[:, None] + (right - left)[:, None] * share, slopes)
        if node.kind == "one":
            ones = self.arithmetic.ones(len(which), dimension + 1)
            return _Affine(ones, self.arithmetic.zeros(len(which), dimension))
        one = self.arithmetic.number(Fraction(1))
        first = self._truth(node.operands[0], which, shift, undecided)
        if node.kind == "not":
            return _Affine(one - first.values, -first.slopes)
        for operand in node.operands[1:]:
            self.stop.check()
            second = self._truth(operand, which, shift, undecided)
            first = self._joined(node, first, second, which, undecided)
        return first

    def _joined(
        self,
        node: StraightAntecedent,
        first: _Affine,
        second: _Affine,
        which: Array,
        undecided: list[Array],
    ) -> _Affine:
        """Return two operands under their norm; collect the comparison that decides."""
        if node.kind in {"bounded and", "bounded or"}:  # max(0, a + b − 1) and min(1, a + b)
            one = self.arithmetic.number(Fraction(1))
            limit = one if node.kind == "bounded or" else one - one
            shift_by = one - limit
            total = _Affine(first.values + second.values - shift_by, first.slopes + second.slopes)
            flat = _Affine(0 * total.values + limit, 0 * total.slopes)
            first, second = total, flat
        undecided.append(first.values - second.values)
        return _chosen(first, second, largest=node.kind in {"max", "bounded and"})

    def _cut_at_layers(self, form: ClosedForm, first: int) -> None:
        """Cut where a height passes a level at which the aggregate changes form."""
        for index, layers in enumerate(form.set_layers):
            levels = _inner_levels(layers)

            def own_levels(ids: Array, index: int = index, levels: Any = levels) -> Any:
                height = self._height(first + index, ids)
                return [height.values - self._level(level) for level in levels]

            self._refine(np.flatnonzero(self.rises(first + index)), own_levels)
        for overlap in form.overlaps:
            levels = _inner_levels(overlap.layers)
            some = [self.rises(first + m) for m in (overlap.member, *overlap.others)]
            which = np.flatnonzero(some[0] & np.logical_or.reduce(some[1:]))

            def undecided_on(ids: Array, overlap: Any = overlap, levels: Any = levels) -> Any:
                undecided = []
                above = self._height(first + overlap.others[0], ids)
                for other in overlap.others[1:]:
                    height = self._height(first + other, ids)
                    undecided.append(above.values - height.values)
                    above = _chosen(above, height, largest=True)
                own = self._height(first + overlap.member, ids)
                undecided.append(own.values - above.values)
                lower = _chosen(own, above, largest=False)
                return [*undecided, *(lower.values - self._level(level) for level in levels)]

            self._refine(which, undecided_on)

    def rises(self, column: int, which: Any = slice(None)) -> Array:
        """Return on which pieces a height is not 0 throughout, if only by its slope."""
        some = any_of_rows(self.heights[which, :, column] > 0)
        if self.arithmetic.exact:
            return some
        # Floats round 1 − x to 0 where x is next to 1.
        return np.asarray(some | any_of_rows(self.slopes[which, :, column] != 0))

    def _level(self, level: Fraction) -> Any:
        """Return a level; of one that is no float the next one, so that no height is just there."""
        number = self.arithmetic.number(level)
        if self.arithmetic.exact or Fraction(number) == level:
            return number
        return math.nextafter(number, 0.0)

    # ── cutting ──────────────────────────────────────────────────────────────────────

    def form_at(self, weights: Sequence[Fraction], which: Array, shares: Array) -> Array:
        """Return Σ wᵢ xᵢ at points of pieces; `shares` has the shape (pieces, points, inputs)."""
        number = self.arithmetic.number
        total = self.arithmetic.zeros(*shares.shape[:2])
        for axis, weight in enumerate(weights):
            if weight:
                cells = self.grid.cells[axis]
                left = self.arithmetic.array([c.left for c in cells])[self.cell[which, axis]]
                width = self.widths(axis)[which]
                total = total + number(weight) * (
                    left[:, None] + width[:, None] * shares[:, :, axis]
                )
        return np.asarray(total)

    def cut_at_form(self, weights: Sequence[Fraction]) -> None:
        """Cut where a sum of the inputs is 0; in rationals only."""
        self._refine(
            np.arange(self.count), lambda ids: [self.form_at(weights, ids, self.corners[ids])]
        )

    def _refine(self, which: Array, undecided_on: Callable[[Array], list[Array]]) -> Array:
        """Cut pieces until no difference has both signs on one; return all pieces."""
        parts: list[Array] = []
        while which.size:
            self.stop.check(self.count)
            # The first mixed difference is cut first: later ones are affine only once it is
            # decided.
            gaps = undecided_on(which)
            cuts = np.full(len(which), -1)
            for number, gap in enumerate(gaps):
                cuts = np.where((cuts < 0) & self._is_mixed(gap), number, cuts)
            parts.append(which[cuts < 0])
            following = [
                self._split(which[selection], gap[selection])
                for number, gap in enumerate(gaps)
                if (selection := np.flatnonzero(cuts == number)).size
            ]
            which = np.concatenate(following) if following else np.zeros(0, dtype=int)
        return np.concatenate(parts) if parts else np.zeros(0, dtype=int)

    def _is_mixed(self, gap: Array) -> Array:
        low, high = least_of_rows(gap), greatest_of_rows(gap)
        if self.arithmetic.exact:
            return np.asarray((low < 0) & (high > 0))
        return np.asarray((low < -SAME) & (high > SAME))

    def _split(self, which: Array, gap: Array) -> Array:
        """Cut each piece in two where a difference is 0 on one of its edges."""
        rows = np.arange(len(which))
        above, below = gap.argmax(axis=1), gap.argmin(axis=1)
        share = gap[rows, above] / (gap[rows, above] - gap[rows, below])
        start, end = self.count, self.count + len(which)
        self._reserve(end)
        self.count = end
        for values in (self._corners, self._heights):
            a, b = values[which, above], values[which, below]
            # The new vertex replaces `below` in the new piece, `above` in the old one.
            middle = a + share[:, None] * (b - a)
            values[start:end] = values[which]
            values[start + rows, below] = values[which, above] = middle
        for inherited in (self._cell, self._slopes):
            inherited[start:end] = inherited[which]
        return np.concatenate([which, np.arange(start, end)])


def _chosen(first: _Affine, second: _Affine, *, largest: bool) -> _Affine:
    """Return the larger or smaller of two heights that do not cross inside a piece."""
    values = (np.maximum if largest else np.minimum)(first.values, second.values)
    takes_first = (sums_of_rows(first.values - second.values) >= 0) == largest
    return _Affine(values, np.where(takes_first[:, None], first.slopes, second.slopes))


def _inner_levels(layers: Layers) -> list[Fraction]:
    """Return the heights between 0 and the top at which layers begin or end."""
    ends = {Fraction(layer.start) for layer in layers}
    ends |= {Fraction(layer.start) + Fraction(layer.depth) for layer in layers}
    return sorted(level for level in ends if level > 0)


def cut(
    model: Straight,
    region: Cut,
    arithmetic: Arithmetic,
    only: Array | None = None,
    stop: Stop | None = None,
) -> Pieces:
    """Cut a rule base without products in antecedents into pieces with affine heights.

    `only`: indices of cells (:attr:`Pieces.flat_cells`), all by default. Raises TooManyPiecesError
    beyond :data:`MOST_PIECES` or the memory, and TimeOverError.
    """
    pieces = Pieces(model, region, arithmetic, only, stop)
    pieces.fire()
    if region.form:
        pieces.cut_at_form(region.form)
    return pieces
