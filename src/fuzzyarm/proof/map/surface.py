"""An output over the pieces as quotients of polynomials: its value, slopes, errors of a table.

Area A and moment M (about the centre of the output's range) are evaluated at the lattice of
each simplex, then converted to Bernstein coefficients. A statement is about a quotient with a
denominator that is nowhere negative:

    value      M / A                        slope    (M′A − MA′) / A²
    table      (M − B·A) / A                odd      (M₁A₂ + M₂A₁) / (A₁A₂)
    apart      (M₁A₂ − M₂A₁) / (A₁A₂), of two rule bases
    gradient   Σ (M′A − MA′)² / A⁴
    sector     (M + cA) / (σA), the centre c and a sum σ of the inputs
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import cached_property
from itertools import combinations, product
from typing import Any, NamedTuple

import numpy as np

from fuzzyarm.base.numbers import counted
from fuzzyarm.inference.overlap import Layers
from fuzzyarm.proof.map.arithmetic import (
    Arithmetic,
    Array,
    greatest_of_rows,
    sums_of_rows,
)
from fuzzyarm.proof.map.bernstein import (
    MARGIN,
    Quotients,
    barycentric,
    from_values,
    vertices_of,
)
from fuzzyarm.proof.map.bounds import UnprovableError
from fuzzyarm.proof.map.pieces import MOST_NUMBERS, Pieces
from fuzzyarm.proof.map.straight import Straight, StraightAntecedent
from fuzzyarm.proof.stop import Stop
from fuzzyarm.table.axis import TableHeader

MOST_COEFFICIENTS = 3_000
"""Most coefficients of one polynomial; the matrix from values to coefficients has their square."""

TINY = 1e-200
"""Least error of a coefficient; where it is less, products of floats may have been rounded to 0."""

_CHUNK, _CHUNK_OF_RATIONALS = 4_000_000, 40_000
"""Numbers per array while the lattice is evaluated; rationals take a thousand times as long."""


class _Sums(NamedTuple):
    """Area and moment at the lattice of some pieces, with slopes by cell coordinates.

    `size` is the sum of the magnitudes of all terms of the area, 0 in rationals.
    """

    area: Array
    moment: Array
    size: Array
    area_slopes: Array | None
    moment_slopes: Array | None


class Surface:
    """One output of a rule base over pieces.

    Attributes
    ----------
    model : Straight
        The rule base.
    pieces : Pieces
        The pieces.
    exact_centre : Fraction
        The centre of the moments: the value is centre + M / A.
    centre : number
        The same in the arithmetic of the pieces, maybe rounded.
    reach : float
        Largest distance of the value from the centre.
    degree : int
        Common degree of M and A.
    """

    def __init__(self, model: Straight, pieces: Pieces) -> None:
        self.model = model
        self.pieces = pieces
        self.arithmetic: Arithmetic = pieces.arithmetic
        self.dimension = pieces.corners.shape[2]
        self.exact_centre, self.reach = self._middle()
        self.centre = self.arithmetic.number(self.exact_centre)
        self.degree = self._degree()

    def _middle(self) -> tuple[Fraction, float]:
        if self.model.form is not None:
            centre = Fraction(self.model.form.centre)
            return centre, float(Fraction(self.model.high) - centre)
        far = [abs(float(value.constant)) for value in self.model.values]
        for value in self.model.values:
            for i, coefficient in enumerate(value.coefficients):
                cells = self.pieces.grid.cells[i]
                ends = max(abs(float(cells[0].left)), abs(float(cells[-1].right)))
                far.append(far[0] + abs(float(coefficient)) * ends * len(self.model.values))
        total = sum(far) if self.model.is_sum else max(far) * (1 + self.dimension)
        return Fraction(0), max(total, 1e-300)

    def _degree(self) -> int:
        if self.model.form is not None:
            return 3
        inputs = 1
        if self.model.multiplies:
            inputs = max(_factors(rule.antecedent) for rule in self.model.rules)
        return inputs + any(any(value.coefficients) for value in self.model.values)

    @property
    def area_degree(self) -> int:
        """The degree of A alone."""
        if self.model.form is not None:
            return 2
        return self.degree - any(any(value.coefficients) for value in self.model.values)

    # ── statements ───────────────────────────────────────────────────────────────────────

    def value(self) -> Quotients:
        """Return the value above the centre."""

        def make(which: Array, points: Array) -> _Parts:
            sums = self._sums(which, points, slopes=False)
            size = MARGIN * sums.size
            return _Parts(sums.moment, sums.area, size * self.reach, size)

        return self._quotients(self.degree, make)

    def slope(self, axis: int) -> Quotients:
        """Return the slope along an input, output by input; in rationals only."""
        width = self.pieces.widths(axis)

        def make(which: Array, points: Array) -> _Parts:
            sums = self._sums(which, points, slopes=True)
            lower = sums.area * sums.area * width[which][:, None]
            return _Parts(self._slope(sums, axis), lower)

        some = np.flatnonzero(width > 0)
        # For sets M′ and A have degree 2: M′A and MA′ have 4, not 6.
        return self._quotients(2 * self.degree - (self.model.form is not None) * 2, make, some)

    def gradient_squared(self) -> Quotients:
        """Return the squared norm of the gradient; in rationals only."""
        widths = [self.pieces.widths(axis) for axis in range(self.dimension)]

        def make(which: Array, points: Array) -> _Parts:
            sums = self._sums(which, points, slopes=True)
            upper = None
            for axis, width in enumerate(widths):
                part = self._slope(sums, axis) / width[which][:, None]
                upper = part * part if upper is None else upper + part * part
            square = sums.area * sums.area
            return _Parts(upper, square * square)

        some = np.flatnonzero(np.logical_and.reduce([width > 0 for width in widths]))
        degree = 2 * (2 * self.degree - (self.model.form is not None) * 2)
        return self._quotients(degree, make, some)

    def odd(self) -> Quotients:
        """Return the sum of the values at a point and at the opposite one."""
        shift = self.arithmetic.number(2 * self.exact_centre)

        def make(which: Array, points: Array) -> _Parts:
            one = self._sums(which, points, slopes=False)
            two = self._sums(which, points, slopes=False, system=1)
            lower = one.area * two.area
            upper = one.moment * two.area + two.moment * one.area + shift * lower
            size = 4.0 * MARGIN * one.size * two.size
            return _Parts(upper, lower, size * (self.reach + abs(float(shift))), size)

        return self._quotients(self.degree + self.area_degree, make)

    def apart(self, other: Straight) -> Quotients:
        """Return the value minus that of another rule base, the second system of the pieces."""
        second = Surface(other, self.pieces)
        shift = self.arithmetic.number(self.exact_centre - second.exact_centre)

        def make(which: Array, points: Array) -> _Parts:
            one = self._sums(which, points, slopes=False)
            two = second._sums(which, points, slopes=False, system=1)
            lower = one.area * two.area
            upper = one.moment * two.area - two.moment * one.area + shift * lower
            size = 4.0 * MARGIN * one.size * two.size
            far = self.reach + second.reach + abs(float(shift))
            return _Parts(upper, lower, size * far, size)

        degrees = self.degree + second.area_degree, second.degree + self.area_degree
        return self._quotients(max(degrees), make)

    def difference(self, table: TableValues) -> Quotients:
        """Return the value minus that of a table."""

        def make(which: Array, points: Array) -> _Parts:
            sums = self._sums(which, points, slopes=False)
            shares = np.matmul(points, self.pieces.corners[which])
            there = table.at(self.pieces.cell[which], shares) - self.centre
            size = MARGIN * sums.size
            far = self.reach + float(np.abs(table.values).max())
            return _Parts(sums.moment - there * sums.area, sums.area, 4.0 * size * far, size)

        return self._quotients(max(self.degree, self.area_degree + table.degree), make)

    def over_form(self, weights: Sequence[Fraction], more: Fraction = Fraction(0)) -> Quotients:
        """Return the value over σ = Σ wᵢ xᵢ, both with the sign of σ; in rationals only.

        The pieces are cut at σ = 0. If the value is not 0 there, the quotient is unbounded. `more`
        is added to the value with the sign of σ.
        """
        shift = self.arithmetic.number(more)
        one = self.arithmetic.number(Fraction(1))

        def make(which: Array, points: Array) -> _Parts:
            sums = self._sums(which, points, slopes=False)
            shares = np.matmul(points, self.pieces.corners[which])
            form = self.pieces.form_at(weights, which, shares)
            sign = np.where(form.sum(axis=1) < 0, -one, one)[:, None]
            value = sums.moment + self.centre * sums.area
            return _Parts(sign * value + shift * sums.area, sign * form * sums.area)

        # For sets σA has the degree of M, one more than that of A.
        return self._quotients(self.degree + (self.model.form is None), make)

    def point_without_rule(self, *, valued: bool) -> tuple[int, Array] | None:
        """Return a piece and one of its points at which no rule fires; None if there is none.

        `valued`: a point without a value, which includes firing rules without area in the range.
        """
        zero = self._fired(valued=valued) == 0
        rows = np.flatnonzero(zero.any(axis=1))
        vertices = np.arange(self.dimension + 1)
        # The middle rather than an edge: a piece with such points has a face with such a middle,
        # which belongs to no neighbour.
        for count in range(len(vertices), 0, -1) if rows.size else ():
            for face in combinations(vertices, count):
                point = self._middle_without_rule(
                    rows, zero, np.isin(vertices, face), valued=valued
                )
                if point is not None:
                    return point
        return None

    def _middle_without_rule(
        self, rows: Array, zero: Array, face: Array, *, valued: bool
    ) -> tuple[int, Array] | None:
        """Return the largest piece with a face without a rule in its middle, and that middle."""
        products = self.model.multiplies
        fits = zero[rows][:, face].all(axis=1) if products else (zero[rows] == face).all(axis=1)
        some, count = rows[fits], int(face.sum())
        if not some.size:
            return None
        shares = self.pieces.corners[some][:, face].sum(axis=1) / count
        without_rule = self.pieces.holds(some, shares)
        if products:  # not affine: 0 at all vertices, but not between them
            middle = self.arithmetic.array([[Fraction(int(on), count) for on in face]])
            without_rule &= self._products_at(some, middle, valued=valued)[:, 0] == 0
        some, shares = some[without_rule], shares[without_rule]
        if not some.size:
            return None
        shapes = self.pieces.corners[some].astype(float)
        largest = int(np.ptp(shapes, axis=1).prod(axis=1).argmax())
        return int(some[largest]), shares[largest]

    def nearly_without_rule(self, *, valued: bool) -> Array:
        """Return the pieces on which floats cannot decide whether a rule fires everywhere."""
        return np.flatnonzero((self._fired(valued=valued) <= 1e-12).any(axis=1))

    def unsure(self, quotients: Quotients) -> Array:
        """Return the pieces whose quotients floats may not represent.

        At a vertex a denominator is 0 by rounding, maybe; or numbers are beyond those of floats,
        or so small that their rounding is not relative.
        """
        unsure = np.zeros(self.pieces.count, dtype=bool)
        if quotients.error is None:
            return unsure
        some = (quotients.upper != 0) | (quotients.lower != 0)
        tiny = some.any(axis=1) & (quotients.error.max(axis=1) < TINY)
        finite = np.isfinite(quotients.upper) & np.isfinite(quotients.lower)
        finite &= np.isfinite(quotients.error)
        unsure[quotients.owner[tiny | ~finite.all(axis=1)]] = True
        ends = list(vertices_of(self.dimension, quotients.degree))
        unsure[quotients.owner[(quotients.lower[:, ends] == 0).any(axis=1)]] = True
        return unsure

    def _fired(self, *, valued: bool) -> Array:
        if not self.model.multiplies:
            counts = self._counts(valued=valued)
            own = [system.first for system in self.pieces.systems if system.model is self.model]
            some = np.concatenate([first + np.flatnonzero(counts) for first in own])
            return np.asarray(self.pieces.heights[:, :, some].sum(axis=2))
        points = barycentric(self.dimension, 1, exact=self.arithmetic.exact)
        return self._products_at(np.arange(self.pieces.count), points, valued=valued)

    def _products_at(self, which: Array, points: Array, *, valued: bool) -> Array:
        counts = self._counts(valued=valued)
        total = self.arithmetic.zeros(len(which), len(points))
        for column, rows, strength, *_ in self._products(which, points):
            if counts[column]:
                total[rows] += strength
        return total

    def _counts(self, *, valued: bool) -> Sequence[bool]:
        return self.model.counts if valued else (True,) * self.model.columns

    # ── polynomials from values at the lattice ───────────────────────────────────────

    @np.errstate(over="ignore", invalid="ignore")  # what overflows is unsure
    def _quotients(
        self,
        degree: int,
        make: Callable[[Array, Array], _Parts],
        some: Array | None = None,
    ) -> Quotients:
        exact = self.arithmetic.exact
        which = np.arange(self.pieces.count) if some is None else some
        coefficients = math.comb(self.dimension + degree, degree)
        if coefficients > MOST_COEFFICIENTS or 3 * coefficients * which.size > MOST_NUMBERS:
            raise UnprovableError(
                f"{which.size:,} pieces of {coefficients:,} coefficients each (degree {degree} in"
                f" {counted(self.dimension, 'input')}) are too many"
            )
        points = barycentric(self.dimension, degree, exact=exact)
        matrix = from_values(self.dimension, degree, exact=exact, stop=self.pieces.stop)
        most = _CHUNK_OF_RATIONALS if exact else _CHUNK
        step = max(1, most // (len(points) * max(self.pieces.heights.shape[2], 4)))
        parts = [make(ids, points) for ids in _chunks(which, step, self.pieces.stop)]
        if not parts:
            parts = [make(which, points)]
        upper = np.concatenate([part.upper @ matrix.T for part in parts])
        lower = np.concatenate([part.lower @ matrix.T for part in parts])
        corners = self.pieces.corners[which]
        if exact:
            return Quotients(upper, lower, None, 0.0, corners, which, degree)
        # A quarter for the matrix, and a rounding for each product and sum.
        norm = float(np.abs(matrix).sum(axis=1).max())
        norm *= 1.25 + len(points) * 2.0**-53 / MARGIN
        off_upper = norm * np.concatenate([part.upper_error for part in parts])
        off_lower = norm * np.concatenate([part.lower_error for part in parts])
        ratio = np.divide(off_upper, off_lower, out=np.zeros_like(off_upper), where=off_lower > 0)
        # One ratio of both errors serves all pieces; too small an error of D is raised.
        some = np.sort(ratio[ratio > 0])  # the median; `np.median` would load numpy.ma
        reach = (
            float(0.5 * (some[(some.size - 1) // 2] + some[some.size // 2])) if some.size else 1.0
        )
        error = np.maximum(off_lower, off_upper / reach)
        errors = np.repeat(error[:, None], lower.shape[1], axis=1)
        return Quotients(upper, lower, errors, reach, corners, which, degree)

    @staticmethod
    def _slope(sums: _Sums, axis: int) -> Array:
        assert sums.area_slopes is not None
        assert sums.moment_slopes is not None
        return np.asarray(
            sums.moment_slopes[:, :, axis] * sums.area - sums.moment * sums.area_slopes[:, :, axis]
        )

    def _sums(self, which: Array, points: Array, *, slopes: bool, system: int = 0) -> _Sums:
        sums = _Sum(self.arithmetic, len(which), len(points), self.dimension, slopes=slopes)
        if self.model.form is not None:
            self._add_sets(sums, which, points, system)
        else:
            self._add_numbers(sums, which, points, system)
        return sums.result()

    def _heights(self, which: Array, points: Array, column: int) -> tuple[Array, Array]:
        heights = self.pieces.heights[which, :, column]
        return heights @ points.T, self.pieces.slopes[which, :, column]

    def _add_sets(self, sums: _Sum, which: Array, points: Array, system: int) -> None:
        form = self.model.form
        assert form is not None
        first = self.pieces.systems[system].first
        chunk = self.pieces.heights[which]
        slopes = self.pieces.slopes[which]
        columns = {
            column: np.ascontiguousarray(chunk[:, :, first + column])
            for column in range(self.model.columns)
        }
        positive = {column: self.pieces.rises(first + column, which) for column in columns}
        lattice = {  # once per column: overlaps need the same again
            column: heights @ points.T
            for column, heights in columns.items()
            if positive[column].any()
        }

        def at(column: int, rows: Array) -> tuple[Array, Array]:
            values = lattice.get(column)
            if values is None:
                return self.arithmetic.zeros(len(rows), len(points)), slopes[
                    rows, :, first + column
                ]
            return values[rows], slopes[rows, :, first + column]

        for column, layers in enumerate(form.set_layers):
            rows = np.flatnonzero(positive[column])
            if rows.size:
                height, slope = at(column, rows)
                sums.add_layers(rows, self._as_numbers(layers), height, slope, 1)
        for overlap in form.overlaps:
            others = np.logical_or.reduce([positive[other] for other in overlap.others])
            rows = np.flatnonzero(positive[overlap.member] & others)
            if not rows.size:
                continue
            above, above_slope = at(overlap.others[0], rows)
            for other in overlap.others[1:]:
                height, slope = at(other, rows)
                above, above_slope = _pick(above, above_slope, height, slope, larger=True)
            degree, own_slope = at(overlap.member, rows)
            lower, lower_slope = _pick(degree, own_slope, above, above_slope, larger=False)
            sums.add_layers(rows, self._as_numbers(overlap.layers), lower, lower_slope, -1)

    @cached_property
    def _known_layers(self) -> dict[int, _Layered]:
        return {}

    def _as_numbers(self, layers: Layers) -> _Layered:
        """Return layers in the arithmetic, cached."""
        key = id(layers)
        if key not in self._known_layers:
            self._known_layers[key] = _layered(layers, self.arithmetic)
        return self._known_layers[key]

    def _add_numbers(self, sums: _Sum, which: Array, points: Array, system: int) -> None:
        number = self.arithmetic.number
        for column, rows, height, slope in self._strengths(which, points, system):
            area = number(self.model.areas[column])
            value, value_slopes = self._value(column, which[rows], points)
            sums.add(
                rows, height * area, height * area * value,
                None if slope is None else slope * area,
                None if slope is None else area * (slope * value[:, :, None]
                + height[:, :, None] * value_slopes[:, None, :]),
                float(area),
            )  # fmt: skip
        if self.model.is_sum:
            sums.set_area_to_one()

    def _value(self, column: int, which: Array, points: Array) -> tuple[Array, Array]:
        """Return a consequent's number at the lattice, and its slopes."""
        number = self.arithmetic.number
        value = self.model.values[column]
        values = self.arithmetic.zeros(len(which), len(points)) + number(value.constant)
        slopes = self.arithmetic.zeros(len(which), self.dimension)
        shares: Array | None = None
        for axis, coefficient in enumerate(value.coefficients):
            if not coefficient:
                continue
            if shares is None:
                shares = np.matmul(points, self.pieces.corners[which])
            cells = self.pieces.grid.cells[axis]
            left = self.arithmetic.array([c.left for c in cells])[self.pieces.cell[which, axis]]
            width = self.pieces.widths(axis)[which]
            factor = number(coefficient)
            values = values + factor * (left[:, None] + width[:, None] * shares[:, :, axis])
            slopes[:, axis] = slopes[:, axis] + factor * width
        return values, slopes

    def _strengths(
        self, which: Array, points: Array, system: int
    ) -> Iterator[tuple[int, Array, Array, Array]]:
        """Yield (column, rows, heights at the lattice, slopes there)."""
        if self.model.multiplies:
            yield from self._products(which, points, system)
            return
        first = self.pieces.systems[system].first
        for column in range(self.model.columns):
            rows = np.flatnonzero(self.pieces.rises(first + column, which))
            if rows.size:
                height, slope = self._heights(which[rows], points, first + column)
                yield column, rows, height, slope[:, None, :]

    def _products(
        self, which: Array, points: Array, system: int = 0
    ) -> Iterator[tuple[int, Array, Array, Array]]:
        """Yield the same for products of memberships, rule by rule."""
        shift = self.pieces.systems[system].shift
        for rule in self.model.rules:
            active = self.pieces.may_fire(rule.antecedent, shift)[which]
            rows = np.flatnonzero(active)
            if not rows.size:
                continue
            shares = np.matmul(points, self.pieces.corners[which[rows]])
            height, slope = self._product(rule.antecedent, which[rows], shares, shift)
            weight = self.arithmetic.number(rule.weight)
            for column in rule.columns:
                yield column, rows, height * weight, slope * weight

    def _product(
        self, node: StraightAntecedent, which: Array, shares: Array, shift: int
    ) -> tuple[Array, Array]:
        if node.kind == "is":
            number = node.proposition + shift
            axis = self.pieces.grid.inputs[number]
            cells = self.pieces.cell[which, axis]
            left, right = (end[cells] for end in self.pieces.grid.ends[number])
            slope = self.arithmetic.zeros(*shares.shape)
            slope[:, :, axis] = self.pieces.grid.rises[number][cells][:, None]
            return left[:, None] + (right - left)[:, None] * shares[:, :, axis], slope
        if node.kind == "one":
            return self.arithmetic.ones(*shares.shape[:2]), self.arithmetic.zeros(*shares.shape)
        parts = [self._product(operand, which, shares, shift) for operand in node.operands]
        if node.kind == "not":
            return self.arithmetic.number(Fraction(1)) - parts[0][0], -parts[0][1]
        a, a_slope = parts[0]
        for b, b_slope in parts[1:]:
            a, a_slope = a * b, a_slope * b[:, :, None] + b_slope * a[:, :, None]
        return a, a_slope


class _Parts(NamedTuple):
    """Numerator and denominator at the lattice, and the errors of floats in each piece."""

    upper: Any
    lower: Array
    upper_error: Any = None
    lower_error: Any = None


class _Sum:
    """Sums of area and moment, their slopes, and the magnitudes of the terms of the area."""

    def __init__(
        self, arithmetic: Arithmetic, pieces: int, points: int, dimension: int, *, slopes: bool
    ) -> None:
        self.area = arithmetic.zeros(pieces, points)
        self.moment = arithmetic.zeros(pieces, points)
        self.size = np.zeros(pieces)
        self.exact = arithmetic.exact
        shape = (pieces, points, dimension)
        self.area_slopes = arithmetic.zeros(*shape) if slopes else None
        self.moment_slopes = arithmetic.zeros(*shape) if slopes else None
        self.arithmetic = arithmetic

    def add(
        self,
        rows: Array,
        area: Array,
        moment: Array,
        area_slopes: Any,
        moment_slopes: Any,
        whole: float,
    ) -> None:
        """Add to some rows; `whole` is the area at height 1."""
        self.area[rows] += area
        self.moment[rows] += moment
        if not self.exact:  # the error of heights is relative to 1, however small they are
            self.size[rows] += greatest_of_rows(np.abs(area)) + 0.1 * abs(whole)
        if self.area_slopes is None or self.moment_slopes is None:
            return
        self.area_slopes[rows] += area_slopes
        self.moment_slopes[rows] += moment_slopes

    def add_layers(
        self, rows: Array, layers: _Layered, height: Array, slope: Array, sign: int
    ) -> None:
        """Add (or subtract) the polynomials of one clipped set."""
        # No height crosses a layer within a piece, so the mean over the lattice identifies the
        # layer.
        middle = sums_of_rows(height) / height.shape[1]
        layer = np.zeros(len(rows), dtype=int)
        for start in layers.starts[1:]:
            layer += middle >= start
        numbers = [column[layer][:, None] for column in layers.columns]
        start, area_before, moment_before, a1, a2, b1, b2, b3 = numbers
        x = height - start
        area = sign * (area_before + x * (a1 + a2 * x))
        moment = sign * (moment_before + x * (b1 + x * (b2 + b3 * x)))
        if self.area_slopes is None:
            self.add(rows, area, moment, None, None, layers.whole)
            return
        self.add(
            rows,
            area,
            moment,
            sign * (a1 + 2 * a2 * x)[:, :, None] * slope[:, None, :],
            sign * (b1 + x * (2 * b2 + 3 * b3 * x))[:, :, None] * slope[:, None, :],
            layers.whole,
        )

    def set_area_to_one(self) -> None:
        """Set the denominator to 1: the quotient is a sum."""
        self.area = self.arithmetic.ones(*self.area.shape)
        self.size = np.maximum(self.size, 1.0)
        if self.area_slopes is not None:
            self.area_slopes = self.area_slopes * 0

    def result(self) -> _Sums:
        return _Sums(self.area, self.moment, self.size, self.area_slopes, self.moment_slopes)


class _Layered(NamedTuple):
    """The layers of one set, each with area and moment below it; plateaus are layers too.

    `columns` has for each its start, area and moment below, a1, a2, b1, b2 and b3; `whole` is the
    area at height 1.
    """

    starts: list[Any]
    columns: list[Array]
    whole: float


def _layered(layers: Layers, arithmetic: Arithmetic) -> _Layered:
    zero = Fraction(0)
    rows: list[tuple[Fraction, ...]] = []
    end = area = moment = zero
    for layer in layers:
        start, depth, a1, a2, b1, b2, b3 = map(Fraction, layer)
        if start > end or (not rows and start > 0):
            rows.append((end, area, moment, zero, zero, zero, zero, zero))
        rows.append((start, area, moment, a1, a2, b1, b2, b3))
        end = start + depth
        area += depth * (a1 + a2 * depth)
        moment += depth * (b1 + depth * (b2 + b3 * depth))
    rows.append((end, area, moment, zero, zero, zero, zero, zero))
    columns = [arithmetic.array(list(column)) for column in zip(*rows, strict=True)]
    return _Layered(list(columns[0]), columns, float(area))


def _pick(
    first: Array, first_slope: Array, second: Array, second_slope: Array, *, larger: bool
) -> tuple[Array, Array]:
    """Return the larger or smaller of two heights that do not cross, with its slopes."""
    takes_first = (sums_of_rows(first - second) >= 0) == larger
    slope = np.where(takes_first[:, None], first_slope, second_slope)
    return (np.maximum if larger else np.minimum)(first, second), slope


def _chunks(which: Array, step: int, stop: Stop) -> Iterator[Array]:
    for start in range(0, len(which), step):
        stop.check(len(which))
        yield which[start : start + step]


def _factors(node: StraightAntecedent) -> int:
    """Return the number of memberships multiplied in an antecedent."""
    if node.kind == "product":
        return sum(map(_factors, node.operands))
    if node.kind == "not":
        return _factors(node.operands[0])
    return int(node.kind == "is")


# ── a table over the cells of a grid ─────────────────────────────────────────────────


class TableValues:
    """A lookup table over cells cut at its levels or thresholds.

    Parameters
    ----------
    table : TableHeader
        With its values as a plain sequence or an array, the last axis fastest.
    mode : str
        Mode of look-up.
    pieces : Pieces
        Cut at :meth:`positions`, inputs in the order of `names`.
    names : sequence of str
        The inputs of the rule base.
    """

    def __init__(self, table: Any, mode: str, pieces: Pieces, names: Sequence[str]) -> None:
        self.mode = mode
        self.arithmetic = pieces.arithmetic
        order = [names.index(axis.name) for axis in table.axes]
        self.order = order
        flat = [Fraction(float(x)) for x in np.asarray(table.values).ravel()]
        self.values = self.arithmetic.array(flat).reshape(table.shape)
        self.first: list[Array] = []
        self.shares: list[tuple[Array, Array]] = []
        for axis, axis_index in zip(table.axes, order, strict=True):
            cells = pieces.grid.cells[axis_index]
            middles = [(cell.left + cell.right) / 2 for cell in cells]
            if mode != "linear":
                self.first.append(np.array([axis.cell(float(x), mode) for x in middles]))
                continue
            levels = [Fraction(level) for level in axis.levels]
            last = max(len(levels) - 2, 0)
            indices = [min(max(sum(x > y for y in levels) - 1, 0), last) for x in middles]
            self.first.append(np.array(indices))
            self.shares.append(
                (
                    self.arithmetic.array(
                        [_share(levels, i, c.left) for i, c in zip(indices, cells, strict=True)]
                    ),
                    self.arithmetic.array(
                        [_share(levels, i, c.right) for i, c in zip(indices, cells, strict=True)]
                    ),
                )
            )

    @property
    def degree(self) -> int:
        """The table's degree as a polynomial on a simplex."""
        return len(self.order) if self.mode == "linear" else 0

    @staticmethod
    def positions(
        table: TableHeader, mode: str, names: Sequence[str]
    ) -> tuple[list[Fraction], ...]:
        """Return the cuts of each input."""
        levels: dict[str, list[Fraction]] = {}
        for axis in table.axes:
            ends = axis.levels if mode == "linear" else axis.thresholds(mode)
            levels[axis.name] = [Fraction(x) for x in ends]
        return tuple(levels[name] for name in names)

    def at(self, cell: Array, shares: Array) -> Array:
        """Return the values of the table at the lattice of pieces."""
        index = [
            first[cell[:, axis_index]]
            for first, axis_index in zip(self.first, self.order, strict=True)
        ]
        if self.mode != "linear":
            constant = self.values[tuple(index)]
            return np.asarray(constant[:, None] + 0 * shares[:, :, 0])
        values = []
        for corner in product((0, 1), repeat=len(self.order)):
            where = tuple(
                np.minimum(i + step, size - 1)
                for i, step, size in zip(index, corner, self.values.shape, strict=True)
            )
            values.append(self.values[where][:, None])
        # The last input varies fastest: neighbours in the list are its two levels.
        pairs = list(zip(self.order, self.shares, strict=True))
        for axis_index, (left, right) in reversed(pairs):
            a, b = left[cell[:, axis_index]], right[cell[:, axis_index]]
            share = a[:, None] + (b - a)[:, None] * shares[:, :, axis_index]
            values = [
                low + (high - low) * share
                for low, high in zip(values[::2], values[1::2], strict=True)
            ]
        return np.asarray(values[0])


def _share(levels: list[Fraction], index: int, x: Fraction) -> Fraction:
    """Return the relative position of x between two levels; 0 or 1 beyond the ends."""
    if len(levels) == 1:
        return Fraction(0)
    low, high = levels[index], levels[index + 1]
    return min(max((x - low) / (high - low), Fraction(0)), Fraction(1))
