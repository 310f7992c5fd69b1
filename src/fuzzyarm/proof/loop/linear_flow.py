r"""Validated integration of a linear differential equation: one step, by its matrix exponential.

``x' = A x + B u + f`` with u constant, A, B and f the same everywhere. A step of
:class:`fuzzyarm.proof.loop.flow.Flow` expands the solutions into a series each time; here

    x(h) = Φ x₀ + Γ u + φ,   [Φ Γ φ] from the exponential of h [A B f; 0],

is enclosed once. Between both ends a solution is within ⅛ h² |x''| of the chord, with x'' = A x'
over an a-priori enclosure: first |x − x₀| ≤ (e^ρ − 1)/ρ h |x'₀|, with ρ = h ‖A‖ in the maximum
norm, then its images under Picard's operator.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import reduce
from operator import add

import numpy as np

from fuzzyarm.proof.loop.enclosure import EnclosureError, Intervals, matrix_exponential
from fuzzyarm.proof.loop.flow import Step
from fuzzyarm.proof.loop.readings import is_total
from fuzzyarm.proof.loop.zonotope import ENLARGED, Forms, stacked
from fuzzyarm.symbolic.evaluation import bounds as bounds_of
from fuzzyarm.symbolic.evaluation import gradient
from fuzzyarm.symbolic.nodes import Node, symbols

STIFF, MOST_STIFF = 1.0, 1024.0
"""Bounds of ρ: beyond the first, e^ρ is a poor bound and a step is halved; beyond the second, with
more than a thousand parts, it is given up."""


def linear_flow(rates: Sequence[Node], inputs: Sequence[str]) -> LinearFlow | None:
    """Return the flow of rates over ``x0`` … and constant inputs; None unless linear."""
    states = [f"x{i}" for i in range(len(rates))]
    variables = (*states, *inputs)
    if not all(map(is_total, rates)):  # slopes show neither a jump nor the end of a domain
        return None
    slopes = [list(gradient(root, variables)) for root in rates]
    if any(symbols(node) for row in slopes for node in row):
        return None
    at_zero = dict.fromkeys(variables, (0.0, 0.0))
    if any(set(symbols(root)) - set(variables) for root in rates):
        return None
    matrix = [
        [*(bounds_of(node, {}) for node in row), bounds_of(root, at_zero)]
        for row, root in zip(slopes, rates, strict=True)
    ]
    low = np.array([[span.low for span in row] for row in matrix])
    high = np.array([[span.high for span in row] for row in matrix])
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        return None
    return LinearFlow(Intervals.between(low, high), states, list(inputs))


class LinearFlow:
    """A linear differential equation.

    Parameters
    ----------
    rates : Intervals, shape (states, states + inputs + 1)
        ``[A B f]``.
    states, inputs : list of str
        Symbols.
    """

    def __init__(self, rates: Intervals, states: list[str], inputs: list[str]) -> None:
        self.rates, self.states, self.inputs = rates, states, inputs
        self._moves: dict[float, Intervals] = {}

    def _move(self, length: float) -> Intervals:
        """Return ``[Φ Γ φ]`` of a step length."""
        if length not in self._moves:
            count, size = self.rates.shape
            whole = np.zeros((2, size, size))
            whole[0, :count], whole[1, :count] = self.rates.low, self.rates.high
            self._moves[length] = matrix_exponential(Intervals(*whole), length)[:count]
        return self._moves[length]

    def step(
        self, start: Forms, constants: Mapping[str, Forms], time: float, length: float, order: int
    ) -> Step:
        """Take one step, as :meth:`fuzzyarm.proof.loop.flow.Flow.step`; `order` is unused."""
        batch = start.shape[1]
        columns = [*(start[i] for i in range(start.shape[0]))]
        columns += [constants[name] for name in self.inputs] + [Forms.at(np.ones(batch))]
        stiffness = self._stiffness(length)
        if stiffness > MOST_STIFF:
            raise EnclosureError(
                f"the plant is too fast for a control period, which times |A| is {stiffness:.3g}"
            )
        move = self._move(length)
        end = stacked([_row(move[i], columns) for i in range(start.shape[0])])
        if stiffness > STIFF:
            half = self.step(start, constants, time, 0.5 * length, order)
            other = self.step(half.end, constants, time + 0.5 * length, 0.5 * length, order)
            between = half.between.hull(other.between)
            bend = between - start.bounds.hull(end.bounds)
            return Step(end, between, bend, np.zeros(start.shape))
        bounds = [form.bounds for form in columns]
        box = self._box(bounds, length)
        rates = self._rates_over(box, bounds)
        second = _product(self.rates[:, : len(box.low)], rates)
        room = Intervals.between(0.0, np.nextafter(0.125 * length * length, np.inf))
        bend = -(second * room)
        between = (start.bounds.hull(end.bounds) + bend).meet(box)
        return Step(end, between, bend, np.zeros(start.shape))

    def _rates_over(self, box: Intervals, bounds: Sequence[Intervals]) -> Intervals:
        others = bounds[len(self.states) :]
        low = np.concatenate([box.low, *(x.low[None] for x in others)])
        high = np.concatenate([box.high, *(x.high[None] for x in others)])
        return _product(self.rates, Intervals(low, high))

    def _stiffness(self, length: float) -> float:
        """Return ρ = h ‖A‖, rounded up."""
        return float(self.rates[:, : len(self.states)].size.sum(axis=1).max()) * ENLARGED * length

    def _box(self, bounds: Sequence[Intervals], length: float) -> Intervals:
        """Return an a-priori enclosure of a step."""
        states = bounds[: len(self.states)]
        start = Intervals(np.stack([x.low for x in states]), np.stack([x.high for x in states]))
        rates = self._rates_over(start, bounds)
        norm = self._stiffness(length)
        most = length * (math.expm1(norm) / norm if norm else 1.0) * ENLARGED**2
        far = rates.size.max(axis=0) * most
        box = Intervals.between(start.low - far, start.high + far)
        box = Intervals(np.nextafter(box.low, -np.inf), np.nextafter(box.high, np.inf))
        span = Intervals.between(0.0, length)
        # It contains the solutions already; each pass of Picard's operator narrows it.
        for _ in range(3):
            box = (start + self._rates_over(box, bounds) * span).meet(box)
        return box


def _row(weights: Intervals, forms: Sequence[Forms]) -> Forms:
    """Return a sum of forms with interval weights."""
    middle, radius = weights.middle, weights.radius
    terms = [form.scaled(w) for form, w in zip(forms, middle, strict=True) if w]
    total = reduce(add, terms) if terms else Forms.at(np.zeros(forms[0].shape))
    off = np.zeros(forms[0].shape)
    for form, r in zip(forms, radius, strict=True):
        if r:
            off = off + r * form.bounds.size
    return total.within(off * ENLARGED)


def _product(matrix: Intervals, x: Intervals) -> Intervals:
    """Return a matrix times a batch of columns."""
    terms = matrix[:, :, None] * x[None]
    return reduce(add, (terms[:, j] for j in range(terms.shape[1])))
