"""The search for Lyapunov functions by cone, for rule bases with an edge at rest.

Each input of a rule base is on one side of its rest or on the other; in each combination, a cone,
the rules have their own slopes. First one quadratic function for all cones is sought, which need
fall in each of them only; then one per cone, which have to fall from one to the next. The
conditions are in :mod:`fuzzyarm.proof.check.region`; the floats here are not trusted.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np

from fuzzyarm.proof.check.certificate import Cone, Fall
from fuzzyarm.proof.loop.enclosure import Vector
from fuzzyarm.proof.loop.form import Assumptions, Form
from fuzzyarm.proof.loop.form_maker import FormMaker
from fuzzyarm.proof.loop.linear import (
    LARGEST,
    Candidate,
    box_rows,
    coordinates,
    floats,
    in_units,
    multipliers_within,
    rationals,
    short,
    symmetric_basis,
    whitening,
)
from fuzzyarm.proof.loop.lmi import Inequality, feasible_point, minimise
from fuzzyarm.proof.stop import Stop

MOST_SIGNALS = 3
"""Most signals with two sides: 8 cones."""

ROUNDS = 2
"""Linearisations of the logarithm of the volume."""

MARGIN = 1e-6
"""Relative margin of the start's function over those of all cones."""


def cone_forms(maker: FormMaker, choice: Assumptions, base: Form) -> list[Form]:
    """Return the loop in each cone; none if no input of a rule base has two sides.

    Cuts are at inputs that rest at an edge and depend on states alone: others depend on gains,
    which differ by cone.
    """
    signals: dict[tuple[Fraction, ...], int] = {}
    signals_of: list[tuple[int, int] | None] = []
    for row, edge in zip(base.inputs, base.edges, strict=True):
        lead = next((x for x in row if x), None)
        if not edge or lead is None or any(row[base.size :]):
            signals_of.append(None)
            continue
        signal = tuple(x / lead for x in row)
        signals_of.append((signals.setdefault(signal, len(signals)), 1 if lead > 0 else -1))
    if not 0 < len(signals) <= MOST_SIGNALS:
        return []
    forms = []
    for sides in product((1, -1), repeat=len(signals)):
        signs = tuple(0 if place is None else sides[place[0]] * place[1] for place in signals_of)
        forms.append(maker.form(replace(choice, signs=signs)))
    return forms


def cone_candidates(base: Form, forms: Sequence[Form], stop: Stop) -> Iterator[Candidate]:
    """Yield one function for all cones, or else one for each.

    `base` is the loop in any cone, `forms` are those in each.
    """
    for own in (False, True):
        if stop.now:
            return
        with warnings.catch_warnings():
            # Ill-conditioning reported by SciPy does not matter: the checker judges the result.
            warnings.simplefilter("ignore")
            try:
                found = _Search(base, forms, own=own).found(stop)
            except np.linalg.LinAlgError:
                found = None
        if found is not None:
            yield found
            return


@dataclass(frozen=True)
class _Part:
    """A cone in coordinates with V ≈ |z|² for the linear loop."""

    a: Vector  # a, b: of the next z; shapes (n, n) and (n, m)
    b: Vector
    c: Vector  # of the blocks; shape (m, n + m)
    units: Vector  # of the blocks; shape (m,)
    sides: Vector  # unit rows of signals that are not negative; shape (s, n)
    lengths: Vector  # their norms before scaling; shape (s,)

    @property
    def move(self) -> Vector:
        """[a b]."""
        return np.hstack([self.a, self.b])

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return int(self.b.shape[1])


class _Search:
    """One matrix inequality over all cones, in the P of each and all multipliers."""

    def __init__(self, base: Form, forms: Sequence[Form], *, own: bool) -> None:
        self.own, self.n = own, base.size
        rows = []
        for form in (base, *forms):
            rows += [
                np.array([float(x) for x in row]) / float(limit)
                for row, limit, _ in form.rows_within()
                if any(row)
            ]
        rows = list({tuple(row): row for row in rows}.values())
        rows += box_rows(floats(forms[0].a), rows)
        self.first = _first_of([base, *forms], rows)
        back: Vector = np.asarray(np.linalg.inv(self.first), np.float64)
        self.rows = [row @ back for row in rows]
        self.parts = [self._part(form, back) for form in forms]
        self.gains = [form.evidence.gains if form.evidence else () for form in forms]
        self.basis = symmetric_basis(self.n)

    def _part(self, form: Form, back: Vector) -> _Part:
        n, m = form.size, len(form.blocks)
        a, b = floats(form.a), floats(form.b).reshape(n, m)
        c = floats(form.blocks).reshape(m, n + m)
        a, b = self.first @ a @ back, self.first @ b
        b, c, units = in_units(b, np.hstack([c[:, :n] @ back, c[:, n:]]), n)
        sides = floats([row[:n] for row in form.sides]).reshape(-1, n) @ back
        lengths = np.linalg.norm(sides, axis=1)
        return _Part(a, b, c, units, sides / lengths[:, None], lengths)

    # --- unknowns: P of the start and of the cones, then the multipliers of each fall ---

    @property
    def _functions(self) -> int:
        return 1 + len(self.parts) if self.own else 1

    def _function(self, cone: int) -> int:
        """Return the index of a cone's P; 0 is that of the start."""
        return 1 + cone if self.own else 0

    @property
    def _goals(self) -> list[int | None]:
        """Cones into which V falls; None: any."""
        return list(range(len(self.parts))) if self.own else [None]

    def _side_rows(self, cone: int, goal: int | None) -> Vector:
        """Return rows over z and w that are not negative, from a cone to another one."""
        part = self.parts[cone]
        own = np.hstack([part.sides, np.zeros((len(part.sides), part.blocks))])
        return own if goal is None else np.vstack([own, self.parts[goal].sides @ part.move])

    def _falls(self) -> tuple[list[Inequality], list[tuple[int, list[tuple[int, int]]]]]:
        """Return the inequalities; and for each fall its first multiplier's index, and pairs."""
        count, size = len(self.basis), self._functions * len(self.basis)
        signals_of: list[tuple[int, list[tuple[int, int]]]] = []
        width = size
        for cone, part in enumerate(self.parts):
            for goal in self._goals:
                sides = len(self._side_rows(cone, goal))
                pairs = [(i, j) for i in range(sides) for j in range(i)]
                signals_of.append((width, pairs))
                width += part.blocks + len(pairs)
        self.width = width
        inequalities = []
        ways = product(enumerate(self.parts), self._goals)
        for ((cone, part), goal), (begin, pairs) in zip(ways, signals_of, strict=True):
            n, m = self.n, part.blocks
            stay = np.hstack([np.eye(n), np.zeros((n, m))])
            parts = np.zeros((width, 1, n + m, n + m))
            now = self._function(cone) * count
            then = now if goal is None else self._function(goal) * count
            parts[now : now + count, 0] += stay.T @ self.basis @ stay
            parts[then : then + count, 0] -= part.move.T @ self.basis @ part.move
            for index, v in enumerate(part.c):
                answer = np.zeros(n + m)
                answer[n + index] = 1.0
                parts[begin + index, 0] = np.outer(answer, answer) - np.outer(v, v)
            rows = self._side_rows(cone, goal)
            for index, (i, j) in enumerate(pairs, begin + m):
                both = np.outer(rows[i], rows[j])
                parts[index, 0] = -(both + both.T)
            # Short steps change V little: the scale of the decrease is factored out.
            pace = max(float(np.linalg.norm(part.move - stay)), 1e-9)
            inequalities.append(Inequality(np.zeros((1, n + m, n + m)), parts / pace))
        return inequalities, signals_of

    def _bounds(self) -> list[Inequality]:
        """Return the inequalities that bound the functions, and keep multipliers at least 0."""
        count, n = len(self.basis), self.n
        functions = range(1, self._functions) if self.own else range(1)
        found = []
        for k in functions:
            parts = np.zeros((self.width, len(self.rows) or 1, n + 1, n + 1))
            constant = np.zeros(parts.shape[1:])
            parts[k * count : (k + 1) * count, :, :n, :n] = self.basis[:, None]
            if self.rows:
                sides = np.array(self.rows)
                constant[:, n, :n] = constant[:, :n, n] = sides
            else:  # everywhere: the scale of V is free
                constant[:, :n, :n] = -np.eye(n)
            constant[:, n, n] = 1.0
            found.append(Inequality(constant, parts))
        top = np.zeros((self.width, 1, n, n))
        top[:count, 0] = -self.basis
        found.append(Inequality(LARGEST * np.eye(n)[None], top))
        for k in range(1, self._functions):  # the start is above all functions
            above = np.zeros((self.width, 1, n, n))
            above[:count, 0], above[k * count : (k + 1) * count, 0] = self.basis, -self.basis
            found.append(Inequality(np.zeros((1, n, n)), above))
        functions_width = self._functions * count
        if self.width > functions_width:
            found.append(multipliers_within(functions_width, self.width - functions_width))
        return found

    def found(self, stop: Stop) -> Candidate | None:
        """Return the functions with a large start; None if none were found."""
        falls, signals_of = self._falls()
        inequalities = [*falls, *self._bounds()]
        count = len(self.basis)
        begin = np.concatenate([
            coordinates(np.eye(self.n) * (1.2 if self.own else 1.1)),
            *[coordinates(np.eye(self.n) * 1.1)] * (self._functions - 1),
            np.full(self.width - self._functions * count, 1e-2),
        ])  # fmt: skip
        y = feasible_point(inequalities, begin, stop)
        if y is None:
            return None
        for _ in range(ROUNDS):
            weight = np.linalg.inv(np.tensordot(y[:count], self.basis, 1))
            cost = np.zeros(self.width)
            cost[:count] = np.tensordot(self.basis, weight, 2)
            y = minimise(inequalities, cost, y, stop)
        return self._candidate(y, signals_of)

    def _candidate(
        self, y: Vector, signals_of: Sequence[tuple[int, list[tuple[int, int]]]]
    ) -> Candidate:
        count = len(self.basis)
        functions = [
            self.first.T @ np.tensordot(y[k * count : (k + 1) * count], self.basis, 1) @ self.first
            for k in range(self._functions)
        ]
        own = [rationals(p) for p in functions[1:]]
        start = rationals(functions[0] * (1.0 + MARGIN if self.own else 1.0))
        growth = 1.0
        for p in functions[1:]:
            half = np.linalg.inv(np.linalg.cholesky(p))
            growth = max(growth, float(np.linalg.eigvalsh(half @ functions[0] @ half.T).max()))
        cones, fall = [], 0
        for cone, part in enumerate(self.parts):
            falls = []
            for goal in self._goals:
                falls.append(self._fall(y, part, goal, *signals_of[fall]))
                fall += 1
            function = own[cone] if self.own else start
            cones.append(Cone(self.gains[cone], function, tuple(falls)))
        above = Fraction(1) if not self.own else Fraction(int(growth * 1024.0 * 1.001) + 1, 1024)
        volume = -0.5 * float(np.linalg.slogdet(functions[0])[1])
        return Candidate(start, (), volume, tuple(cones), above)

    def _fall(
        self, y: Vector, part: _Part, goal: int | None, begin: int, pairs: list[tuple[int, int]]
    ) -> Fall:
        taus = y[begin : begin + part.blocks] / part.units**2
        into = () if goal is None else self.parts[goal].lengths
        lengths = np.concatenate([part.lengths, into])
        weights: list[list[Any]] = [[Fraction(0)] * len(lengths) for _ in lengths]
        for (i, j), x in zip(pairs, y[begin + part.blocks :], strict=False):
            weights[i][j] = weights[j][i] = max(
                Fraction(0), short(float(x / lengths[i] / lengths[j]))
            )
        return Fall(tuple(short(float(x)) for x in taus), tuple(map(tuple, weights)))


def _first_of(forms: Sequence[Form], rows: Sequence[Vector]) -> Vector:
    """Return coordinates with V ≈ |z|² for one of the loops without its blocks."""
    for form in forms:
        first = whitening(floats(form.a), rows, continuous=False)
        if first is not None:
            return first
    raise np.linalg.LinAlgError("no cone of the loop is stable")
