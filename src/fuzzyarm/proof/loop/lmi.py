"""A small solver of linear matrix inequalities, in floats: it searches, and proves nothing.

    minimise c·y   so that   F₀ + Σ yᵢ Fᵢ > 0   for some symmetric matrices

by a barrier method: Newton's steps on t c·y − Σ log det F(y), t growing; and before that the same
for the least s with F(y) + s I > 0, until s is below 0.

Sources: S. Boyd, L. El Ghaoui, E. Feron and V. Balakrishnan, *Linear Matrix Inequalities in System
and Control Theory*, SIAM 1994, sections 2.4 and 2.5; S. Boyd and L. Vandenberghe, *Convex
Optimization*, Cambridge 2004, sections 11.3 (paths) and 11.6 (line searches).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.proof.loop.enclosure import Vector
from fuzzyarm.proof.stop import Stop


@dataclass(frozen=True, eq=False)
class Inequality:
    """F₀ + Σ yᵢ Fᵢ > 0, for r matrices of one size at once."""

    constant: Vector  # F₀; shape (r, n, n)
    parts: Vector  # Fᵢ; shape (k, r, n, n)

    @property
    def size(self) -> int:
        """Total number of rows of all matrices."""
        return int(self.constant.shape[0] * self.constant.shape[1])

    def at(self, y: Vector) -> Vector:
        """Return F(y), shape (r, n, n)."""
        values = y[self.unknowns] @ self.own_parts.reshape(len(self.unknowns), self.constant.size)
        return np.asarray(self.constant + values.reshape(self.constant.shape))

    @cached_property
    def unknowns(self) -> NDArray[np.int64]:
        """The indices of its unknowns."""
        return np.flatnonzero(self.parts.reshape(len(self.parts), -1).any(axis=1))

    @cached_property
    def own_parts(self) -> Vector:
        """The Fᵢ of its unknowns."""
        return np.ascontiguousarray(self.parts[self.unknowns])

    @property
    def widened(self) -> Inequality:
        """F₀ + Σ yᵢ Fᵢ + s I > 0, with one more unknown s."""
        unit = np.broadcast_to(np.eye(self.constant.shape[1]), (1, *self.constant.shape))
        return Inequality(self.constant, np.concatenate([self.parts, unit]))

    @cached_property
    def block(self) -> tuple[NDArray[np.int64], ...]:
        """Rows and columns of its unknowns in a Hessian."""
        return np.ix_(self.unknowns, self.unknowns)


def merged(inequalities: Sequence[Inequality]) -> list[Inequality]:
    """Return the same inequalities, with scalars, and those with equal unknowns, merged."""
    alike: dict[object, list[Inequality]] = {}
    for inequality in inequalities:
        size = inequality.constant.shape[1]
        key = (size, inequality.unknowns.tobytes()) if size > 1 else 1
        alike.setdefault(key, []).append(inequality)
    return [
        Inequality(
            np.concatenate([x.constant for x in same]), np.concatenate([x.parts for x in same], 1)
        )
        for same in alike.values()
    ]


def feasible_point(inequalities: Sequence[Inequality], start: Vector, stop: Stop) -> Vector | None:
    """Return a point at which all inequalities hold; None if none was found in time."""
    lowest = min(
        float(np.linalg.eigvalsh(inequality.at(start)).min()) for inequality in inequalities
    )
    if lowest > 0.0:
        return start
    inequalities = merged(inequalities)
    widened = [inequality.widened for inequality in inequalities]
    y = np.append(start, max(1.0, -1.5 * lowest))
    cost = np.zeros(len(y))
    cost[-1] = 1.0
    size = sum(inequality.size for inequality in inequalities)
    for weight in (10.0**power for power in range(8)):
        for _ in range(STEPS):
            if stop.now:
                return None
            y, decrement = _newton(widened, cost * weight, y)
            if y[-1] < 0.0 and _is_inside(inequalities, y[:-1]):
                return y[:-1]
            # Near the central path, s exceeds the least s by at most this.
            if decrement < 0.5 and y[-1] > (size + decrement * math.sqrt(size)) / weight:
                return None
            if decrement < 0.1 or not np.isfinite(y).all():
                break
    return None


ACCURACY = 1e-3
"""Tolerance of a minimum, relative to the cost; with a volume for each of its rows."""

STEPS = 30
"""Newton steps at one weight of the cost; with fewer the path leaves the centre."""


def minimise(
    inequalities: Sequence[Inequality],
    cost: Vector,
    start: Vector,
    stop: Stop,
    *,
    volume: Inequality | None = None,
) -> Vector:
    """Return an interior point with nearly the least cost, or the best one in time.

    The logarithm of the determinant of `volume` is subtracted from c·y.
    """
    size = sum(inequality.size for inequality in inequalities)
    inequalities, y = merged(inequalities), start
    scale = abs(float(cost @ start)) or 1.0
    weight = 0.1 * size / scale  # less would lead back to the centre
    while weight * scale <= 1e12:
        for _ in range(STEPS):
            if stop.now:
                return y
            y, decrement = _newton(inequalities, cost * weight, y, volume, weight)
            if decrement < 0.1:
                break
        if size / weight < ACCURACY * (volume.size if volume else abs(float(cost @ y))):
            break
        weight *= 4.0
    return y


def _newton(
    inequalities: Sequence[Inequality],
    cost: Vector,
    y: Vector,
    volume: Inequality | None = None,
    weight: float = 1.0,
) -> tuple[Vector, float]:
    """Return the next point of Newton's method on the barrier, and the decrement."""
    gradient, hessian = cost.copy(), np.zeros((len(y), len(y)))
    scaled = []
    weighted = [(inequality, 1.0) for inequality in inequalities]
    weighted += [(volume, weight)] if volume else []
    for inequality, times in weighted:
        half: Vector = np.linalg.inv(np.linalg.cholesky(inequality.at(y)))
        parts = half @ inequality.own_parts @ half.swapaxes(1, 2)  # (k, r, n, n)
        flat = parts.reshape(len(parts), -1)
        gradient[inequality.unknowns] -= times * np.einsum("krii->k", parts)
        hessian[inequality.block] += times * (flat @ flat.T)
        scaled.append(flat)
    # Multipliers differ by orders of magnitude: each coordinate is scaled by its curvature.
    unit = 1.0 / np.sqrt(np.maximum(np.diag(hessian), 1e-300))
    scaled_hessian = hessian * unit * unit[:, None] + 1e-13 * np.eye(len(y))
    way = -unit * np.linalg.solve(scaled_hessian, unit * gradient)
    decrement = math.sqrt(max(0.0, -float(gradient @ way)))
    # det F(y + α way) = det F(y) Π (1 + α λ).
    values = [
        np.linalg.eigvalsh((way[x.unknowns] @ flat).reshape(x.constant.shape)).ravel()
        for (x, _), flat in zip(weighted, scaled, strict=True)
    ]
    shares = [np.full(len(x), times) for x, (_, times) in zip(values, weighted, strict=True)]
    step = _step(float(cost @ way), np.concatenate(values), np.concatenate(shares))
    while step > 1e-12:
        near = y + step * way
        if _is_inside(inequalities, near):
            return near, decrement
        step *= 0.5
    return y, 0.0


SHARES_OF_REACH = np.concatenate([1.0 - 0.5 ** np.arange(1.0, 8.0), 0.5 ** np.arange(2.0, 24.0)])
"""Trial steps, as shares of the distance to the boundary."""


def _step(slope: float, values: Vector, weights: Vector) -> float:
    """Return the trial α with the least α · slope − Σ ω log(1 + α λ): the barrier along a line."""
    reach = 1.0 / max(-float(values.min()), 1e-6)
    steps = np.append(reach * SHARES_OF_REACH, 1.0 if reach > 1.0 else 0.5 * reach)
    costs = steps * slope - np.log1p(steps[:, None] * values) @ weights
    return float(steps[np.argmin(costs)])


def _is_inside(inequalities: Sequence[Inequality], y: Vector) -> bool:
    """Return whether all inequalities hold at a point."""
    try:
        for inequality in inequalities:
            np.linalg.cholesky(inequality.at(y))
    except np.linalg.LinAlgError:
        return False
    return bool(np.isfinite(y).all())
