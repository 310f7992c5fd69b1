"""A small solver of linear matrix inequalities, in floats: it finds, and proves nothing.

    minimise c·y   so that   F₀ + Σ yᵢ Fᵢ > 0   for some symmetric matrices

by a barrier method: Newton's steps on t c·y − Σ log det F(y), t growing; and before that the same
for the least s with F(y) + s I > 0, until s is below 0.

Source: S. Boyd, L. El Ghaoui, E. Feron and V. Balakrishnan, *Linear Matrix Inequalities in System
and Control Theory*, SIAM 1994, sections 2.4 and 2.5.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.proof.stop import Stop

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Inequality:
    """F₀ + Σ yᵢ Fᵢ > 0, of some matrices of one size at once.

    Attributes
    ----------
    constant : ndarray, shape (r, n, n)
        F₀.
    parts : ndarray, shape (k, r, n, n)
        Fᵢ.
    """

    constant: Vector
    parts: Vector

    @property
    def size(self) -> int:
        """How many rows all matrices have together."""
        return int(self.constant.shape[0] * self.constant.shape[1])

    def at(self, y: Vector) -> Vector:
        """Return F(y), shape (r, n, n)."""
        values = y[self.places] @ self.counted.reshape(len(self.places), self.constant.size)
        return np.asarray(self.constant + values.reshape(self.constant.shape))

    @cached_property
    def places(self) -> NDArray[np.int64]:
        """The unknowns that it has."""
        return np.flatnonzero(self.parts.reshape(len(self.parts), -1).any(axis=1))

    @cached_property
    def counted(self) -> Vector:
        """Their Fᵢ."""
        return np.ascontiguousarray(self.parts[self.places])


def feasible_point(
    inequalities: Sequence[Inequality], start: Vector, stop: Stop, *, rounds: int = 8
) -> Vector | None:
    """Return a point at which all inequalities hold; None where none was found in time."""
    widened = [
        Inequality(
            inequality.constant,
            np.concatenate(
                [
                    inequality.parts,
                    np.broadcast_to(
                        np.eye(inequality.constant.shape[1]), (1, *inequality.constant.shape)
                    ),
                ]
            ),
        )
        for inequality in inequalities
    ]
    lowest = min(
        float(np.linalg.eigvalsh(inequality.at(start)).min()) for inequality in inequalities
    )
    y = np.append(start, max(1.0, 1.5 * -lowest) if lowest <= 0.0 else 0.0)
    if lowest > 0.0:
        return start
    cost = np.zeros(len(y))
    cost[-1] = 1.0
    size = sum(inequality.size for inequality in inequalities)
    for weight in (10.0**power for power in range(rounds)):
        for _ in range(STEPS):
            if stop.now:
                return None
            y, decrement = _newton(widened, cost * weight, y)
            if y[-1] < 0.0 and all(
                _is_positive(inequality.at(y[:-1])) for inequality in inequalities
            ):
                return y[:-1]
            if decrement < 1e-2 or not np.isfinite(y).all():
                break
        # Where the steps have come to rest the least s is within size / weight of this one.
        if decrement < 1e-2 and y[-1] > 2.0 * size / weight:
            return None
    return None


STEPS = 30
"""Newton's steps at one weight of the cost; fewer, and the path leaves the middle."""


def minimise(
    inequalities: Sequence[Inequality],
    cost: Vector,
    start: Vector,
    stop: Stop,
    *,
    accuracy: float = 1e-3,
) -> Vector:
    """Return a point at which the cost is nearly least, or the best one in time, inside them."""
    size = sum(inequality.size for inequality in inequalities)
    y = start
    scale = abs(float(cost @ start)) or 1.0
    weight = 0.1 * size / scale  # less would lead back to the middle
    while True:
        for _ in range(4):
            if stop.now:
                return y
            y, decrement = _newton(inequalities, cost * weight, y)
            if decrement < 1e-2:
                break
        if size / weight < accuracy * abs(float(cost @ y)):
            return y
        weight *= 4.0
        if weight * scale > 1e12:
            return y


def _newton(inequalities: Sequence[Inequality], cost: Vector, y: Vector) -> tuple[Vector, float]:
    """Return the next point of Newton's method on the barrier, and the decrement."""
    gradient, hessian = cost.copy(), np.zeros((len(y), len(y)))
    here = float(cost @ y)
    for inequality in inequalities:
        root = np.linalg.cholesky(inequality.at(y))
        here -= _logarithm(root)
        half: Vector = np.linalg.inv(root)
        places = inequality.places
        scaled = half @ inequality.counted @ half.swapaxes(1, 2)  # (k, r, n, n)
        flat = scaled.reshape(len(places), inequality.constant.size)
        gradient[places] -= np.trace(scaled, axis1=2, axis2=3).sum(axis=1)
        hessian[np.ix_(places, places)] += flat @ flat.T
    # Multipliers differ by many orders of magnitude: each coordinate in units of its curvature.
    unit = 1.0 / np.sqrt(np.maximum(np.diag(hessian), 1e-300))
    scaled_hessian = hessian * unit * unit[:, None] + 1e-13 * np.eye(len(y))
    way = -unit * np.linalg.solve(scaled_hessian, unit * gradient)
    decrement = float(math.sqrt(max(0.0, -float(gradient @ way))))
    step = 1.0 if decrement < 0.25 else 1.0 / (1.0 + decrement)
    # Damped steps stay inside by theory, longer ones are tried first.
    for factor in (1.0, 0.5, 0.25, step):
        near = y + factor * way
        if _barrier(inequalities, cost, near) <= here:
            return near, decrement
    shrunk = 0.5 * step
    while shrunk > 1e-12:
        near = y + shrunk * way
        if _barrier(inequalities, cost, near) < math.inf:
            return near, decrement
        shrunk *= 0.5
    return y, 0.0


def _barrier(inequalities: Sequence[Inequality], cost: Vector, y: Vector) -> float:
    """Return the cost less the logarithms of the determinants; infinite outside."""
    total = float(cost @ y)
    for inequality in inequalities:
        try:
            total -= _logarithm(np.linalg.cholesky(inequality.at(y)))
        except np.linalg.LinAlgError:
            return math.inf
    return total if math.isfinite(total) else math.inf


def _logarithm(factors: NDArray[np.floating[Any]]) -> float:
    """Return the logarithm of the determinants of matrices, by their triangular factors."""
    return 2.0 * float(np.log(np.diagonal(factors, axis1=1, axis2=2)).sum())


def _is_positive(matrix: Vector) -> bool:
    try:
        np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError:
        return False
    return True
