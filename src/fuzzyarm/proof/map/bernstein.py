r"""Polynomials on simplices in Bernstein form, and the extremes of their quotients.

On a simplex with vertices v₀ … v_d a polynomial of degree n is Σ b_α B_α with one coefficient
for each multi-index α with d + 1 entries and the sum n. The coefficients at the vertices are
values, and all values lie between the smallest and the largest coefficient. So

    N / D ≤ c   wherever   N − c D has no coefficient above 0   and   D > 0.

Halving an edge averages coefficients (de Casteljau), and the bounds converge quadratically.
Coefficients follow from values at the lattice α / n by one fixed matrix; nothing is symbolic.

Source: G. Farin, *Triangular Bernstein–Bézier patches*, 1986.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import combinations
from math import comb, factorial, isinf, prod
from typing import Any, NamedTuple

import numpy as np

from fuzzyarm.proof.map.arithmetic import (
    FLOATS,
    Arithmetic,
    Array,
    any_of_rows,
    as_fraction,
    greatest_of_rows,
    rationals,
)
from fuzzyarm.proof.stop import Stop, TimeOverError

Index = tuple[int, ...]

INVERTED_IN_FLOATS = 8
"""Highest degree at which the matrix to coefficients is exact enough if it is inverted in floats:
to a quarter of a margin for each value."""

MOST_AT_ONCE = 500
"""Largest matrix that is inverted in rationals without a look at the clock: half a second."""

MARGIN = 3e-14
"""Error of floats relative to the sum of magnitudes: 130 roundings."""


# ── the lattice and its matrices ─────────────────────────────────────────────────────


@cache
def lattice(dimension: int, degree: int) -> tuple[Index, ...]:
    """Return the multi-indices of a degree; those of the vertices have one nonzero entry."""

    def spread(total: int, entries: int) -> list[Index]:
        if entries == 1:
            return [(total,)]
        return [
            (first, *rest)
            for first in range(total, -1, -1)
            for rest in spread(total - first, entries - 1)
        ]

    return tuple(spread(degree, dimension + 1))


@cache
def vertices_of(dimension: int, degree: int) -> tuple[int, ...]:
    """Return the indices of the coefficients at the vertices."""
    indices = lattice(dimension, degree)
    return tuple(
        indices.index(tuple(degree if i == j else 0 for i in range(dimension + 1)))
        for j in range(dimension + 1)
    )


@cache
def _beside_vertices(dimension: int, degree: int) -> tuple[tuple[int, int, int], ...]:
    """Return (vertex, other vertex or itself, coefficient one step towards that)."""
    indices = lattice(dimension, degree)
    neighbours = []
    for near in range(dimension + 1):
        for far in range(dimension + 1):
            index = [0] * (dimension + 1)
            index[near] += degree - 1
            index[far] += 1
            neighbours.append((near, far, indices.index(tuple(index))))
    return tuple(neighbours)


@cache
def faces(dimension: int, degree: int) -> tuple[tuple[int, ...], ...]:
    """Return the coefficients on each face, vertices first and the simplex itself last."""
    indices = lattice(dimension, degree)
    vertices = range(dimension + 1)
    return tuple(
        tuple(
            number
            for number, index in enumerate(indices)
            if all(vertex in face or not index[vertex] for vertex in vertices)
        )
        for count in range(1, dimension + 2)
        for face in combinations(vertices, count)
    )


@cache
def barycentric(dimension: int, degree: int, *, exact: bool) -> Array:
    """Return the lattice points as weights of the vertices, shape (points, vertices)."""
    arithmetic = rationals() if exact else FLOATS
    return arithmetic.array(
        [[Fraction(a, degree) for a in index] for index in lattice(dimension, degree)]
    )


_from_values: dict[tuple[int, int, bool], Array] = {}


def from_values(dimension: int, degree: int, *, exact: bool, stop: Stop | None = None) -> Array:
    """Return the matrix from values at the lattice to coefficients; for high degrees slow."""
    key = dimension, degree, exact
    if key not in _from_values:
        _from_values[key] = _found_from_values(dimension, degree, stop or Stop(), exact=exact)
    return _from_values[key]


def _found_from_values(dimension: int, degree: int, stop: Stop, *, exact: bool) -> Array:
    indices = lattice(dimension, degree)

    def basis(at: Index, index: Index) -> Fraction:
        multinomial = factorial(degree) // prod(map(factorial, index))
        return multinomial * prod(
            (Fraction(a, degree) ** b for a, b in zip(at, index, strict=True)), start=Fraction(1)
        )

    matrix = []
    for at in indices:
        stop.check()
        matrix.append([basis(at, index) for index in indices])
    if exact:
        return _inverse(matrix, rationals(), stop)
    if degree <= INVERTED_IN_FLOATS:
        return np.linalg.inv(np.array(matrix, dtype=float))
    return from_values(dimension, degree, exact=True, stop=stop).astype(float)


def _inverse(matrix: list[list[Fraction]], arithmetic: Arithmetic, stop: Stop) -> Array:
    """Return the inverse by elimination; the pivots of a Bernstein matrix are not 0."""
    size = len(matrix)
    if arithmetic.name == "flint" and size <= MOST_AT_ONCE:
        from flint import fmpq_mat

        stop.check()
        whole = fmpq_mat(arithmetic.array(matrix).tolist()).inv()
        rows: Array = np.array(whole.tolist(), dtype=object)
        return rows
    unit = [[Fraction(int(i == j)) for j in range(size)] for i in range(size)]
    work = arithmetic.array([[*a, *b] for a, b in zip(matrix, unit, strict=True)])
    for i in range(size):
        stop.check()
        pivot = next(r for r in range(i, size) if work[r, i] != 0)
        work[[i, pivot]] = work[[pivot, i]]
        work[i] = work[i] / work[i, i]
        for r in range(size):
            if r != i and work[r, i] != 0:
                work[r] = work[r] - work[i] * work[r, i]
    return work[:, size:]


@cache
def halving(dimension: int, degree: int, first: int, second: int, *, exact: bool) -> Array:
    """Return the matrix to coefficients of the half with `second` moved to the midpoint."""
    indices = lattice(dimension, degree)
    number = {index: i for i, index in enumerate(indices)}
    rows = [[Fraction(0)] * len(indices) for _ in indices]
    for row, index in enumerate(indices):
        # de Casteljau at ½: b'_α = 2⁻ⁿ Σₖ C(n, k) b_β, n = α_second, where β has k moved from
        # `second` to `first`.
        order = index[second]
        for k in range(order + 1):
            source = list(index)
            source[second], source[first] = order - k, index[first] + k
            rows[row][number[tuple(source)]] += Fraction(comb(order, k), 2**order)
    return (rationals() if exact else FLOATS).array(rows)


# ── quotients on many simplices ──────────────────────────────────────────────────────


@dataclass
class Quotients:
    """N / D on many simplices; D is not negative."""

    upper: Array  # upper, lower: coefficients of N and of D; shape (simplices, coefficients)
    lower: Array
    # Error of the coefficients of D; those of N have `reach` times as much. None: exact.
    error: Array | None
    reach: float  # largest N / D where D is not 0
    corners: Array  # vertices in cell coordinates 0 … 1; shape (simplices, vertices, inputs)
    owner: Array  # the piece of each simplex
    degree: int  # of both polynomials

    @property
    def exact(self) -> bool:
        """Whether the numbers are exact."""
        return self.error is None

    @property
    def count(self) -> int:
        """Number of simplices."""
        return len(self.owner)

    def negated(self) -> Quotients:
        """Return −N / D."""
        return Quotients(
            -self.upper, self.lower, self.error, self.reach, self.corners, self.owner, self.degree
        )

    def select(self, which: Array) -> Quotients:
        """Return selected simplices."""
        error = None if self.error is None else self.error[which]
        return Quotients(
            self.upper[which],
            self.lower[which],
            error,
            self.reach,
            self.corners[which],
            self.owner[which],
            self.degree,
        )

    def joined(self, *others: Quotients) -> Quotients:
        """Return these simplices and others of the same kind."""
        all_ = (self, *others)
        errors = [quotients.error for quotients in all_ if quotients.error is not None]
        return Quotients(
            np.concatenate([quotients.upper for quotients in all_]),
            np.concatenate([quotients.lower for quotients in all_]),
            np.concatenate(errors) if errors else None,
            max(quotients.reach for quotients in all_),
            np.concatenate([quotients.corners for quotients in all_]),
            np.concatenate([quotients.owner for quotients in all_]),
            self.degree,
        )

    # ── bounds ───────────────────────────────────────────────────────────────────────

    def excess(self, bound: Any, stop: Stop) -> Array:
        """Return the largest coefficient of N − bound D for each simplex, plus errors."""
        if self.error is None:
            parts = [
                greatest_of_rows(self.upper[part] - bound * self.lower[part])
                for part in _in_parts(self.count, stop)
            ]
            return np.concatenate([np.zeros(0, dtype=object), *parts])
        differences = self.upper - bound * self.lower
        return greatest_of_rows(differences + (self.reach + abs(bound)) * self.error)

    def attained(self) -> tuple[Any, int, Array] | None:
        """Return the greatest value at a vertex, with the simplex and the position; or None.

        If D vanishes at a vertex, the limits along its edges count: quotients of the coefficients
        next to the vertex.
        """
        dimension = self.corners.shape[2]
        top: tuple[Any, int, Array] | None = None
        for near, far, position in _beside_vertices(dimension, self.degree):
            upper, lower = self.upper[:, position], self.lower[:, position]
            sure = lower > (0 if self.error is None else 1e3 * self.error[:, position])
            if near != far:
                vertex = vertices_of(dimension, self.degree)[near]
                sure &= (self.lower[:, vertex] == 0) & (self.upper[:, vertex] == 0)
            rows = np.flatnonzero(sure)
            if not rows.size:
                continue
            values = upper[rows] / lower[rows]
            best = int(values.argmax())
            if top is None or values[best] > top[0]:
                owner = int(rows[best])
                a, b = self.corners[owner, near], self.corners[owner, far]
                # A point next to the vertex, on the edge of the limit; the vertex itself if b is a.
                top = values[best], owner, a + (b - a) / 2**24
        return top

    def bound(self) -> float:
        """Return a crude upper bound of N / D; infinite if D may vanish."""
        if not self.count:
            return -np.inf
        upper, lower = self.upper.astype(float), self.lower.astype(float)
        error = np.zeros_like(lower) if self.error is None else self.error
        room = lower - error
        with np.errstate(all="ignore"):
            # A positive numerator is divided by the least denominator, a negative one by the
            # largest.
            ratio = (upper + self.reach * error) / np.where(upper >= 0, room, lower + error)
        empty = (upper == 0) & (lower == 0) & (error == 0)
        ratio = np.where(empty, -np.inf, np.where(room > 0, ratio, np.inf))
        value = float(ratio.max())
        # Two rationals and their quotient were rounded to floats: up to three half ulps.
        outward = value + abs(value) * 2.0**-51
        return float(np.nextafter(outward, np.inf)) if np.isfinite(outward) else value

    def without(self, pieces: Array) -> Quotients:
        """Return the simplices outside the given pieces."""
        return self.select(np.flatnonzero(~pieces[self.owner])) if pieces.any() else self

    def touches(self, bound: Any) -> tuple[int, Array] | None:
        """Return a simplex and the position of a vertex with N / D at least a bound; or None."""
        for vertex, index in enumerate(vertices_of(self.corners.shape[2], self.degree)):
            at = (self.lower[:, index] > 0) & (self.upper[:, index] >= bound * self.lower[:, index])
            if at.any():
                row = int(np.flatnonzero(at)[0])
                return row, self.corners[row, vertex]
        return None

    def may_touch(self, bound: Any, stop: Stop) -> Array:
        """Return the simplices on which N / D may equal a bound that it does not exceed.

        N − bound D has no coefficient above 0 there, and is 0 inside a face if all of the face's
        coefficients are. That is a value of N / D unless those of D are 0 as well.
        """
        parts = [np.zeros(0, dtype=bool)]
        every_face = [list(face) for face in faces(self.corners.shape[2], self.degree)]
        for part in _in_parts(self.count, stop):
            upper, lower = self.upper[part], self.lower[part]
            zero, nothing = upper == bound * lower, lower == 0
            touching = np.zeros(len(upper), dtype=bool)
            for face in every_face:
                touching |= zero[:, face].all(axis=1) & ~nothing[:, face].all(axis=1)
            parts.append(touching)
        return np.concatenate(parts)

    # ── refinement ───────────────────────────────────────────────────────────────────

    def halved(self, stop: Stop) -> Quotients:
        """Return both halves of each simplex, cut across the longest edge."""
        shape = self.corners.astype(float)
        vertices = shape.shape[1]
        pairs = list(combinations(range(vertices), 2))
        lengths = np.stack([((shape[:, i] - shape[:, j]) ** 2).sum(axis=1) for i, j in pairs])
        longest = lengths.argmax(axis=0)
        halves: list[Quotients] = []
        for number, (i, j) in enumerate(pairs):
            which = np.flatnonzero(longest == number)
            parts = _in_parts(which.size, stop) if self.exact else [slice(None)] * bool(which.size)
            for part in parts:
                halves += [self._half(which[part], i, j), self._half(which[part], j, i)]
        return halves[0].joined(*halves[1:])

    def _half(self, which: Array, stays: int, moves: int) -> Quotients:
        part = self.select(which)
        dimension = part.corners.shape[2]
        matrix = halving(dimension, self.degree, stays, moves, exact=self.exact).T
        part.upper, part.lower = part.upper @ matrix, part.lower @ matrix
        if part.error is not None:
            part.error = part.error @ matrix
        part.corners = part.corners.copy()
        part.corners[:, moves] = (part.corners[:, moves] + part.corners[:, stays]) / 2
        return part


AT_ONCE = 500
"""Simplices computed in rationals between two checks of the clock."""


def _in_parts(count: int, stop: Stop) -> Iterator[slice]:
    for start in range(0, count, AT_ONCE):
        stop.check()
        yield slice(start, start + AT_ONCE)


# ── branch and bound ─────────────────────────────────────────────────────────────────


class Extremum(NamedTuple):
    """A supremum between two bounds."""

    reached: Any  # an attained value, or a limit; None without one
    bound: Any  # upper bound of all values; None without a value
    corner: Array | None  # its position, in cell coordinates
    owner: int  # the piece
    pieces: int  # number of simplices examined
    left: Quotients  # the undecided pieces: none where `bound` is within the tolerance of `reached`


MOST = 400_000
"""Most open simplices at a time: the coefficients of more do not fit into memory."""

SMALLEST = 1e-7
"""Shortest edge, in cell coordinates: on smaller simplices floats decide nothing."""


@np.errstate(over="ignore", invalid="ignore")
def maximise(
    quotients: Quotients,
    tolerance: Any,
    stop: Stop,
    *,
    least: Any = None,
    decide: bool = False,
    strict: bool = False,
    smallest: float = SMALLEST,
) -> Extremum:
    """Return the supremum of N / D by branch and bound, `left` empty unless given up.

    The bound is at most the tolerance above an attained value; `least` is one attained elsewhere.
    With `decide` the search ends at the first value above it, with `strict`, in rationals and
    without a tolerance, at one equal to it, too. Simplices with edges below `smallest`, in cell
    coordinates, are given up.
    """
    best, corner, owner = least, None, -1
    count, waiting = quotients.count, quotients
    given_up: Quotients = quotients.select(np.zeros(0, dtype=int))
    try:
        while waiting.count:
            attained = waiting.attained()
            if attained is not None and (best is None or attained[0] > best):
                best, corner = attained[0], attained[2]
                owner = int(waiting.owner[attained[1]])
                if decide:
                    return Extremum(best, best, corner, owner, count, given_up)
            touching = waiting.touches(best) if strict else None
            if touching is not None:
                owner = int(waiting.owner[touching[0]])
                return Extremum(best, best, touching[1], owner, count, given_up)
            waiting, too_small = _worth_halving(
                waiting, best, tolerance, smallest, stop, strict=strict
            )
            given_up = given_up.joined(too_small)
            if stop.tell is not None and waiting.count and best is not None:
                stop.say(waiting.count, waiting.bound() - float(best))
            if stop.now or waiting.count > MOST:
                break
            if waiting.count:
                waiting = waiting.halved(stop)
                count += waiting.count
    except TimeOverError:
        pass
    given_up = given_up.joined(waiting)
    bound = None if best is None else best + tolerance
    if given_up.count:
        crude = given_up.bound()
        bound = crude if bound is None or _exceeds(crude, bound) else bound
    return Extremum(best, bound, corner, owner, count, given_up)


def _exceeds(value: float, bound: Any) -> bool:
    """Return whether a float, possibly infinite, is above a number of either arithmetic."""
    return value > 0.0 if isinf(value) else as_fraction(value) > as_fraction(bound)


def _worth_halving(
    waiting: Quotients, best: Any, tolerance: Any, smallest: float, stop: Stop, *, strict: bool
) -> tuple[Quotients, Quotients]:
    """Return the simplices that may exceed the attained value, and those too small to halve.

    `strict`: those that may reach it are kept as well.
    """
    # Before any value is attained, only simplices without a value can be discarded.
    keep = (
        any_of_rows(waiting.lower != 0)
        if best is None
        else ~(waiting.excess(best + tolerance, stop) <= 0)  # kept also if it overflows
    )
    if strict:
        keep |= waiting.may_touch(best, stop)
    waiting = waiting.select(np.flatnonzero(keep))
    shape = waiting.corners.astype(float)
    small = np.ptp(shape, axis=1).max(axis=1, initial=0.0) < smallest
    return waiting.select(np.flatnonzero(~small)), waiting.select(np.flatnonzero(small))
