"""A Takagi–Sugeno model over arrays: its memberships, its consequents, and their estimation.

The output is the average of the consequents, weighted by the firing strengths::

    y(x) = Σ_r w_r(x) (a_r · x + b_r) / Σ_r w_r(x),    w_r(x) = Π_j μ_rj(x_j)

For given terms the consequents are a linear least-squares problem. Each is the linear model of all
samples plus its own deviation, and the deviations are shrunk: without shrinkage a rule with few
samples follows their noise, with very much of it the model becomes linear regression.

The numbers of the terms are found by variable projection (G. H. Golub, V. Pereyra, 1973): least
squares over them alone, with the optimal consequents eliminated at each step, and the Jacobian of
L. Kaufman (1975): that of the model at fixed consequents, projected onto the complement of the
consequents' column space. Memberships and their derivatives are readings of the expressions of the
shapes.

Matrices here are tall and narrow. On them several threads of a BLAS wait for each other
longer than they work (measured: 0.4 s become 4 to 110 s), so that everything runs with one,
see :func:`~fuzzyarm.inference.threads.one_thread`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.symbolic.evaluation import Schedule, evaluate_arrays, gradient, schedule
from fuzzyarm.symbolic.kinds import SHAPES, ShapeKind
from fuzzyarm.symbolic.nodes import Node

Array = NDArray[np.float64]

LEAST_SHRINKAGE = 1e-12
"""Makes the consequents unique: a constant could move from the linear part to all rules."""

TINY = 1e-300
"""Degrees below count as this one: their logarithm stays finite."""


# --- Terms and rules, their numbers in one vector ---


class TermOf(NamedTuple):
    """A term: its input, its kind, the index of its parameters.

    `numbers` has (index in the vector of numbers, sign) for each parameter of the kind:
    neighbours share the number at which they cross, with opposite slopes.
    """

    input: int
    kind: str
    numbers: tuple[tuple[int, float], ...]


class _Readings(NamedTuple):
    """A kind of shape: its symbols, its expression, and the derivative by each parameter."""

    symbols: tuple[str, ...]
    value: tuple[Node, Schedule]
    slopes: tuple[tuple[Node, Schedule], ...]


@lru_cache(maxsize=32)
def _readings(shape: ShapeKind) -> _Readings:
    partials = gradient(shape.expression, shape.symbols[1:])
    return _Readings(
        shape.symbols,
        (shape.expression, schedule(shape.expression)),
        tuple((partial, schedule(partial)) for partial in partials),
    )


class _TermGroup(NamedTuple):
    """The terms of one kind: their columns, inputs, and parameters (parameters × terms)."""

    columns: NDArray[np.intp]
    inputs: NDArray[np.intp]
    indices: NDArray[np.intp]
    signs: Array
    readings: _Readings


@dataclass(frozen=True, eq=False)
class Premises:
    """Terms and the rules over them.

    Attributes
    ----------
    terms : tuple of TermOf
        Those of an input in order.
    rules : tuple of tuple of int
        The terms of each antecedent, at most one of each input.
    numbers : ndarray
        Numbers of all terms, in the units of the inputs.
    lower, upper : ndarray
        Their bounds.
    scale : ndarray
        Expected scale of the change of each.
    """

    terms: tuple[TermOf, ...]
    rules: tuple[tuple[int, ...], ...]
    numbers: Array
    lower: Array
    upper: Array
    scale: Array

    @cached_property
    def members(self) -> Array:
        """1 for each term of a rule, shape (rules, terms)."""
        values = np.zeros((len(self.rules), len(self.terms)))
        for row, rule in zip(values, self.rules, strict=True):
            row[list(rule)] = 1.0
        return values

    @cached_property
    def _groups(self) -> tuple[_TermGroup, ...]:
        kinds = dict.fromkeys(term.kind for term in self.terms)
        return tuple(self._group(kind) for kind in kinds)

    def _group(self, kind: str) -> _TermGroup:
        columns = [k for k, term in enumerate(self.terms) if term.kind == kind]
        terms = [self.terms[k] for k in columns]
        return _TermGroup(
            np.array(columns),
            np.array([term.input for term in terms]),
            np.array([[index for index, _ in term.numbers] for term in terms]).T,
            np.array([[sign for _, sign in term.numbers] for term in terms]).T,
            _readings(SHAPES[kind]),
        )

    def parameters(self, term: TermOf) -> tuple[float, ...]:
        """Return the parameters of a term."""
        return tuple(sign * float(self.numbers[index]) for index, sign in term.numbers)

    def _read(self, group: _TermGroup, inputs: Array, reading: tuple[Node, Schedule]) -> Array:
        columns = group.signs * self.numbers[group.indices]
        symbols = group.readings.symbols
        values = dict(zip(symbols, (inputs[:, group.inputs], *columns), strict=True))
        weights = evaluate_arrays(reading[0], values, order=reading[1])
        return np.broadcast_to(weights, (len(inputs), len(group.inputs)))

    def degrees(self, inputs: Array) -> Array:
        """Return the memberships, shape (samples, terms)."""
        values = np.empty((len(inputs), len(self.terms)))
        for group in self._groups:
            values[:, group.columns] = self._read(group, inputs, group.readings.value)
        return values

    def strengths(self, inputs: Array) -> Array:
        """Return the firing strengths, normalised: shape (samples, rules), sum 1."""
        if not self.terms:
            return np.ones((len(inputs), 1))
        return self._shares(self.degrees(inputs))

    def _shares(self, degrees: Array) -> Array:
        # Products of degrees as sums of logarithms: ten small ones do not vanish. Shares do not
        # change with a common factor, so the largest weight of a sample is set to exp(0) = 1.
        logarithm = np.log(np.maximum(degrees, TINY)) @ self.members.T
        weights = np.exp(logarithm - logarithm.max(axis=1, keepdims=True))
        shares: Array = weights / weights.sum(axis=1, keepdims=True)
        return shares

    def jacobian(self, inputs: Array, consequents: Array) -> Array:
        """Return the derivative of the output by the numbers of the terms.

        Parameters
        ----------
        inputs : ndarray, shape (samples, inputs)
            Where.
        consequents : ndarray, shape (samples, rules)
            The value of each consequent there.

        Returns
        -------
        ndarray, shape (samples, numbers)
            With μ of a term, ∂y/∂p = Σ w_r (c_r − y) (∂μ/∂p) / μ over the rules with it.
        """
        degrees = self.degrees(inputs)
        shares = self._shares(degrees)
        mean = np.sum(shares * consequents, axis=1, keepdims=True)
        # y = Σ w_r c_r / Σ w_r with w_r = Π μ: a term scales the weights of its rules, by dμ / μ.
        by_term = (shares * (consequents - mean)) @ self.members
        by_term /= np.maximum(degrees, TINY)
        values = np.zeros((len(inputs), len(self.numbers)))
        for group in self._groups:
            slopes = group.readings.slopes
            for index, sign, reading in zip(group.indices, group.signs, slopes, strict=True):
                slope = self._read(group, inputs, reading) * sign * by_term[:, group.columns]
                for k, column in zip(index.tolist(), slope.T, strict=True):
                    values[:, k] += column  # neighbours share a number
        return values

    def with_numbers(self, numbers: Array) -> Premises:
        """Return the same terms and rules with other numbers."""
        return replace(self, numbers=np.asarray(numbers, dtype=float))


# --- Consequents ---


@dataclass(frozen=True, eq=False)
class Scaling:
    """Inputs and outputs with mean 0 and deviation 1, where least squares is well posed."""

    centre: Array
    spread: Array
    middle: Array
    range: Array

    @classmethod
    def of(cls, inputs: Array, outputs: Array) -> Scaling:
        """Return the scaling of samples; constant quantities get a spread of 1."""
        spreads = inputs.std(axis=0), outputs.std(axis=0)
        tiny = [1e-12 * np.abs(columns).max(axis=0) for columns in (inputs, outputs)]
        spread, extent = (np.where(s > t, s, 1.0) for s, t in zip(spreads, tiny, strict=True))
        return cls(inputs.mean(axis=0), spread, outputs.mean(axis=0), extent)

    def regressors(self, inputs: Array) -> Array:
        """Return the scaled inputs and a column of ones, shape (samples, inputs + 1)."""
        return np.column_stack([(inputs - self.centre) / self.spread, np.ones(len(inputs))])

    def scaled(self, outputs: Array) -> Array:
        """Return scaled outputs."""
        scaled: Array = (outputs - self.middle) / self.range
        return scaled

    def in_units(self, weights: Array) -> Array:
        """Return consequents in the units of the samples, shape (rules, outputs, inputs + 1).

        Parameters
        ----------
        weights : ndarray, shape (rules, inputs + 1, outputs)
            Weights of the scaled regressors.
        """
        # y = middle + range (Σ aⱼ (xⱼ - centreⱼ)/spreadⱼ + b), multiplied out.
        turned = np.swapaxes(weights, 1, 2) * self.range[:, None]
        slopes = turned[..., :-1] / self.spread
        constants = turned[..., -1] + self.middle - slopes @ self.centre
        return np.concatenate([slopes, constants[..., None]], axis=-1)


def designed(shares: Array, regressors: Array) -> Array:
    """Return each regressor weighed by each rule, shape (samples, rules × regressors)."""
    values: Array = (shares[:, :, None] * regressors[:, None, :]).reshape(len(shares), -1)
    return values


def basis(regressors: Array) -> Array:
    """Return orthonormal columns that span the regressors, linearly dependent ones left out."""
    left, values, _ = np.linalg.svd(regressors, full_matrices=False)
    return left[:, values > 1e-10 * values[0]]


def consequents(
    premises: Premises, inputs: Array, outputs: Array, shrinkage: float
) -> tuple[Array, Scaling]:
    """Return the best consequents of given terms.

    Parameters
    ----------
    premises : Premises
        Terms and rules.
    inputs : ndarray, shape (samples, inputs)
        Inputs of the samples.
    outputs : ndarray, shape (samples, outputs)
        Outputs of the samples.
    shrinkage : float
        λ: the mean square error, in variances of the output, plus λ times the squared
        deviations of the consequents from the common linear part is least.

    Returns
    -------
    weights : ndarray, shape (rules, inputs + 1, outputs)
        Weights of the scaled regressors.
    scaling : Scaling
        Scaling of inputs and outputs.
    """
    scaling = Scaling.of(inputs, outputs)
    regressors, scaled = scaling.regressors(inputs), scaling.scaled(outputs)
    shape = len(premises.rules), regressors.shape[1], outputs.shape[1]
    # Outputs = linear model + Σ strength × deviation. The linear part is projected out by an
    # orthonormal basis, so that the penalty acts on the deviations alone.
    span = basis(regressors)
    bridge = np.linalg.lstsq(regressors, span, rcond=1e-10)[0]  # regressors @ bridge = span
    projection = span.T @ scaled
    if len(premises.rules) < 2:
        return np.broadcast_to(bridge @ projection, shape).copy(), scaling
    strengths = premises.strengths(inputs)
    size = shape[0] * shape[1]
    crossed = np.zeros((span.shape[1], size))
    for rows in _turns(len(inputs)):
        # Project the linear part out of the design D: D - span (spanᵀ D).
        crossed += span[rows].T @ designed(strengths[rows], regressors[rows])
    triangle = np.sqrt(max(shrinkage, LEAST_SHRINKAGE) * len(inputs)) * np.eye(size)
    # Sequential QR: each block of rows is stacked under the triangle of those before, which starts
    # as the penalty √(λ n) I. Memory is that of one block.
    right = np.zeros((size, shape[2]))
    rest = scaled - span @ projection
    for rows in _turns(len(inputs)):
        design = designed(strengths[rows], regressors[rows]) - span[rows] @ crossed
        factor, triangle = np.linalg.qr(np.vstack([triangle, design]))
        right = factor.T @ np.vstack([right, rest[rows]])
    deviations = np.linalg.solve(triangle, right)
    # Back from the orthonormal basis to the regressors, less the linear part of the deviations.
    linear = bridge @ (projection - crossed @ deviations)
    return deviations.reshape(shape) + linear, scaling


_ROWS = 8192


def _turns(count: int) -> Iterator[slice]:
    return (slice(start, start + _ROWS) for start in range(0, count, _ROWS))


def predicted(premises: Premises, weights: Array, regressors: Array, inputs: Array) -> Array:
    """Return the scaled outputs of a model, shape (samples, outputs)."""
    values: Array = np.einsum(
        "nr,nq,rqk->nk", premises.strengths(inputs), regressors, weights, optimize=True
    )
    return values


# --- The numbers of the terms ---


class Projection:
    """Least squares over the numbers of the terms, with the best consequents at each of them.

    Parameters
    ----------
    premises : Premises
        Terms and rules to start from.
    inputs, outputs : ndarray
        Samples; their outputs as :class:`Scaling` scales them.
    shrinkage : float
        As for :func:`consequents`.
    """

    def __init__(self, premises: Premises, inputs: Array, outputs: Array, shrinkage: float) -> None:
        scaling = Scaling.of(inputs, outputs)
        self.premises, self.inputs = premises, inputs
        self.regressors = scaling.regressors(inputs)
        self.span = basis(self.regressors)
        scaled = scaling.scaled(outputs)
        self.rest = scaled - self.span @ (self.span.T @ scaled)
        self.size = len(premises.rules) * self.regressors.shape[1]
        # The mean square error times n: λ of a mean is λ n of a sum.
        self.penalty = np.sqrt(max(shrinkage, LEAST_SHRINKAGE) * len(inputs)) * np.eye(self.size)
        self.best = (np.inf, premises.numbers)
        self._last_fit: tuple[bytes, Array, Array, Array] | None = None

    def _solve(self, numbers: Array) -> tuple[Array, Array, Array]:
        """Return the orthogonal factor, the deviations and the residual; the last is kept."""
        key = numbers.tobytes()
        if self._last_fit is None or self._last_fit[0] != key:
            strengths = self.premises.with_numbers(numbers).strengths(self.inputs)
            design = designed(strengths, self.regressors)
            # Least squares of [D; √(λ n) I] δ = [rest; 0], D without the linear part.
            design -= self.span @ (self.span.T @ design)
            factor, triangle = np.linalg.qr(np.vstack([design, self.penalty]))
            right = np.vstack([self.rest, np.zeros((self.size, self.rest.shape[1]))])
            projection = factor.T @ right
            residual = right - factor @ projection
            self._last_fit = key, factor, np.linalg.solve(triangle, projection), residual
            cost = float(np.sum(residual**2))
            if cost < self.best[0]:
                self.best = cost, numbers.copy()
        return self._last_fit[1:]

    def residual(self, numbers: Array) -> Array:
        """Return the residual of the best model, and the penalty of its deviations."""
        return self._solve(numbers)[2].T.ravel()

    def jacobian(self, numbers: Array) -> Array:
        """Return Kaufman's Jacobian of :meth:`residual`."""
        factor, deviations, _ = self._solve(numbers)
        premises = self.premises.with_numbers(numbers)
        count = len(self.inputs)
        weights = deviations.reshape(len(premises.rules), -1, deviations.shape[1])
        parts = []
        for k in range(deviations.shape[1]):
            slope = premises.jacobian(self.inputs, self.regressors @ weights[:, :, k].T)
            slope -= self.span @ (self.span.T @ slope)
            full = np.vstack([slope, np.zeros((self.size, slope.shape[1]))])
            # -(I - Q Qᵀ) (∂D/∂p) δ: Q spans the column space of the consequents, penalty rows
            # included. Kaufman's simplification of variable projection (BIT 15, 1975) drops the
            # term with the residual, which is small near a good fit.
            parts.append(factor @ (factor[:count].T @ slope) - full)
        return np.concatenate(parts)


def optimised(
    premises: Premises,
    inputs: Array,
    outputs: Array,
    shrinkage: float,
    evaluations: int = 60,
    on_step: Callable[[float], None] = lambda _cost: None,
) -> tuple[Premises, bool]:
    """Return the premises with the numbers that leave least of the outputs."""
    if not len(premises.numbers):
        return premises, True
    from scipy.optimize import least_squares

    projection = Projection(premises, inputs, outputs, shrinkage)

    def residual(numbers: Array) -> Array:
        values = projection.residual(numbers)
        on_step(float(np.sqrt(np.sum(values**2) / outputs.size)))
        return values

    finished = True
    try:
        least_squares(
            residual,
            np.clip(premises.numbers, premises.lower, premises.upper),
            projection.jacobian,
            bounds=(premises.lower, premises.upper),
            x_scale=premises.scale,
            max_nfev=evaluations,
            xtol=1e-6,
            ftol=1e-6,
        )
    except KeyboardInterrupt:
        finished = False
    return premises.with_numbers(projection.best[1]), finished
