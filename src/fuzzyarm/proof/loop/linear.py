"""The search for a quadratic Lyapunov function of a loop's form: in floats, not trusted.

With V(z) = zᵀ P z and |wₖ| ≤ |vₖ|, vₖ = Cₖ z + Dₖ w, V falls along the loop where

    V(A z + B w) − V(z) + Σ τₖ (vₖ² − wₖ²) < 0   for all (z, w) other than 0, τₖ ≥ 0,

which is one linear matrix inequality in P and τ (S-procedure; for one block the circle criterion in
discrete time). With Y = [[P, 0], [0, τ]] and G = [[A, B], [C, D]] it is Y - Gᵀ Y G > 0: G is a
contraction in the norm of Y. So is Gᵀ in that of Y⁻¹, which makes it linear in Q = P⁻¹ and 1/τ.
The proof holds on {V ≤ 1}, which lies within the bounds of the form if gᵀ Q g ≤ b² for each row
|g z| ≤ b. The search seeks the Q of the largest level set, with the largest log det Q: a concave
function.

Sources: H. K. Khalil, *Nonlinear Systems*, 3rd edition, Prentice Hall 2002, section 7.1; S. Boyd,
L. El Ghaoui, E. Feron and V. Balakrishnan, *Linear Matrix Inequalities in System and Control
Theory*, SIAM 1994, sections 2.6.3, 5.1 and 8.1.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from fuzzyarm.proof.check.certificate import Cone
from fuzzyarm.proof.check.loop import System
from fuzzyarm.proof.loop.enclosure import Vector
from fuzzyarm.proof.loop.form import Form, Matrix
from fuzzyarm.proof.loop.lmi import Inequality, feasible_point, minimise
from fuzzyarm.proof.stop import Stop


@dataclass(frozen=True)
class Candidate:
    """A candidate for the proof of a form, to be checked; all but `size` as in a certificate."""

    # p, multipliers, cones, growth: see :class:`~fuzzyarm.proof.check.certificate.RegionProof`
    p: Matrix
    multipliers: tuple[Fraction, ...]
    size: float  # the logarithm of the volume of the region, except for a constant
    cones: tuple[Cone, ...] = ()
    growth: Fraction = Fraction(1)


def candidate(
    form: Form,
    *,
    include: Sequence[Sequence[Fraction]] = (),
    within: Sequence[tuple[Sequence[Fraction], Fraction]] = (),
    rate: float = 0.0,
    enlarge: bool = True,
    stop: Stop | None = None,
) -> Candidate | None:
    """Return a Lyapunov function with a large level set; None if none was found.

    The region has to contain the points `include`, and to keep |g z| below the limit of each row of
    `within`; V has to fall by the share `rate` in each period. Without `enlarge` any level set will
    do.
    """
    stop = stop or Stop()
    n, m = form.size, len(form.blocks)
    a, b = floats(form.a), floats(form.b).reshape(n, m)
    c = floats(form.blocks).reshape(m, n + m)
    limited = [*((row, limit) for row, limit, _ in form.rows_within()), *within]
    rows = [np.array([float(x) for x in row]) / float(limit) for row, limit in limited if any(row)]
    step = a if form.period else np.eye(n) + a / np.linalg.norm(a)
    rows = [*rows, *box_rows(step, rows)] or list(np.eye(n))  # everywhere: any size will do
    try:
        with warnings.catch_warnings():
            # Ill-conditioning reported by SciPy does not matter: the checker judges the result.
            warnings.simplefilter("ignore")
            first = whitening(a, rows, continuous=form.period == 0.0)
    except np.linalg.LinAlgError:
        return None
    if first is None:
        return None
    back = np.linalg.inv(first)  # z = back ẑ, with V ≈ |ẑ|² for the linear loop
    a, b = first @ a @ back, first @ b
    b, c, units = in_units(b, np.hstack([c[:, :n] @ back, c[:, n:]]), n)
    points = np.array([first @ np.array([float(x) for x in z]) for z in include]).reshape(-1, n)
    basis = symmetric_basis(n)
    count = len(basis)
    falls = _falling_dual(a, b, c, basis, rate, continuous=form.period == 0.0)
    begin = np.concatenate([coordinates(np.eye(n) * 1.1), np.ones(m)])
    y = feasible_point([falls, *_of_some_size(basis, m)], begin, stop)
    if y is None:
        return None
    inside = _inside(np.array(rows) @ back, basis, m)
    y *= 0.9 / float((1.0 - inside.at(y)).max())
    inequalities = [falls, inside, *_multipliers(count, m)]
    if len(points):
        inequalities.append(_holding(points, basis, m))
        y = feasible_point(inequalities, y, stop)
        if y is None:
            return None
    if enlarge:
        q = Inequality(np.zeros((1, n, n)), _padded(basis, m)[:, None])
        y = minimise(inequalities, np.zeros(len(y)), y, stop, volume=q)
    p = first.T @ np.linalg.inv(np.tensordot(y[:count], basis, 1)) @ first
    taus = 1.0 / (y[count:] * units**2)
    size = -0.5 * float(np.linalg.slogdet(p)[1])
    return Candidate(rationals(p), tuple(short(x) for x in taus), size)


def declining(
    loop: System, growth: float, stop: Stop
) -> tuple[Matrix, tuple[Fraction, ...]] | None:
    """Return V, possibly indefinite, and τ with V(z⁺) < growth² V(z); None if none was found."""
    from scipy.linalg import solve_discrete_lyapunov

    n, m = loop.size, len(loop.blocks)
    move = floats(loop.move)
    a, b = move[:, :n], move[:, n:]
    c = floats(loop.blocks).reshape(m, n + m)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            p = solve_discrete_lyapunov(a.T / growth, np.eye(n))
        values, vectors = np.linalg.eigh(0.5 * (p + p.T))
        first = np.sqrt(np.abs(values))[:, None] * vectors.T  # V is a sum of ± squares there
        back = np.linalg.inv(first)
    except (np.linalg.LinAlgError, ValueError):
        return None
    if not np.isfinite(back).all():
        return None
    a, b = first @ a @ back, first @ b
    b, c, units = in_units(b, np.hstack([c[:, :n] @ back, c[:, n:]]), n)
    basis = symmetric_basis(n)
    inequalities = [_falling(a, b, c, basis, 1.0 - growth**2)]
    if m:
        inequalities.append(multipliers_within(len(basis), m))
    begin = np.concatenate([coordinates(np.diag(np.sign(values))), np.full(m, 1e-2)])
    y = feasible_point(inequalities, begin, stop)
    if y is None:
        return None
    p = first.T @ np.tensordot(y[: len(basis)], basis, 1) @ first
    exact = tuple(tuple(Fraction(float(x)) for x in row) for row in 0.5 * (p + p.T))
    return exact, tuple(short(x) for x in y[len(basis) :] / units**2)


def in_units(b: Vector, c: Vector, n: int) -> tuple[Vector, Vector, Vector]:
    """Return inputs and answers of blocks in equal units, so that multipliers have one size."""
    gains_in = np.maximum(np.linalg.norm(c[:, :n], axis=1), 1e-12)
    units = np.sqrt(gains_in / np.maximum(np.linalg.norm(b, axis=0), 1e-12 * gains_in))
    c = c / units[:, None]
    c[:, n:] = c[:, n:] * units
    return b * units, c, units


def floats(matrix: Sequence[Sequence[Any]]) -> Vector:
    """Return a matrix of rationals or balls as floats."""
    return np.array([[float(x) for x in row] for row in matrix], float)


FAR = 10.0
"""Factor on the form's bounds, for a bound of each state alone."""


def box_rows(a: Vector, rows: Sequence[Vector]) -> list[Vector]:
    """Return rows that bound every state: some are in no bound, or only one period later."""
    n = len(a)
    reach = np.zeros(n)
    for row in rows:
        later = row
        for _ in range(n):
            reach = np.maximum(reach, np.abs(later))
            later = later @ a
    # A state that nothing reads, such as the last value of an unfiltered rate, has a wide bound.
    wide = np.sqrt(UNSEEN * sum(float(row @ row) for row in rows) / n)
    return [np.eye(n)[i] * (reach[i] / FAR or wide) for i in range(n) if rows]


UNSEEN = 1e-6
"""Weight of an unobserved state, as a share of the mean weight."""


def whitening(a: Vector, rows: Sequence[Vector], *, continuous: bool) -> Vector | None:
    """Return coordinates with V ≈ |ẑ|² for the loop without its blocks."""
    eigenvalues = np.linalg.eigvals(a)
    stable = np.all(eigenvalues.real < 0) if continuous else np.all(np.abs(eigenvalues) < 1)
    if not stable:
        return None
    n = len(a)
    sides = np.array(rows) if rows else np.eye(n)
    p = _lyapunov(a, sides.T @ sides, continuous=continuous)
    # Scaled to fit between the rows.
    inverse = np.linalg.inv(p)
    reach = max((float(row @ inverse @ row) for row in rows), default=1.0)
    try:
        return np.asarray(np.linalg.cholesky(p * reach).T)
    except np.linalg.LinAlgError:
        return None


def _lyapunov(a: Vector, weight: Vector, *, continuous: bool) -> Vector:
    """Return P with AᵀPA − P = −W, or AᵀP + PA = −W: Σ (Aᵀ)ᵏ W Aᵏ by doubling.

    In continuous time by the Cayley transform of A, which has the same P.
    """
    if continuous:
        pace = float(np.linalg.norm(a, 2))
        near = np.linalg.inv(a - pace * np.eye(len(a)))
        a, weight = near @ (a + pace * np.eye(len(a))), 2.0 * pace * near.T @ weight @ near
    total = weight
    for _ in range(60):
        more = a.T @ total @ a
        total, a = total + more, a @ a
        if not np.linalg.norm(more) > 1e-17 * np.linalg.norm(total):
            break
    return 0.5 * (total + total.T)


def symmetric_basis(n: int) -> Vector:
    """Return the basis of symmetric matrices with one or two entries 1, stacked."""
    basis = []
    for i in range(n):
        for j in range(i, n):
            element = np.zeros((n, n))
            element[i, j] = element[j, i] = 1.0
            basis.append(element)
    return np.array(basis)


def coordinates(p: Vector) -> Vector:
    """Return the coordinates of a symmetric matrix in that basis."""
    return np.array([p[i, j] for i in range(len(p)) for j in range(i, len(p))])


def _falling(a: Vector, b: Vector, c: Vector, basis: Vector, rate: float) -> Inequality:
    """Return the inequality for the decrease of V, in P and τ."""
    n, m = len(a), b.shape[1]
    move = np.hstack([a, b])
    stay = np.hstack([np.eye(n), np.zeros((n, m))])
    falls = (1.0 - rate) * stay.T @ basis @ stay - move.T @ basis @ move
    return _of_steps([*falls, *_gaps(np.eye(n + m)[n:], c)], move - stay)


def _falling_dual(
    a: Vector, b: Vector, c: Vector, basis: Vector, rate: float, *, continuous: bool
) -> Inequality:
    """Return the dual inequality in Q and 1/τ, see the head of this module."""
    n, m = len(a), b.shape[1]
    move, stay = np.hstack([a, b]), np.eye(n + m)[:n]
    after = np.vstack([move, c])
    if not continuous:
        after[:, :n] /= np.sqrt(1.0 - rate)
    states, answers = after[:, :n], after[:, n:]
    if continuous:
        half = states @ basis @ stay
        falls = -(half + half.swapaxes(1, 2))
    else:
        falls = stay.T @ basis @ stay - states @ basis @ states.T
    every = [*falls, *_gaps(np.eye(n + m)[n:], answers.T)]
    return _of_steps(every, move - (0.0 if continuous else stay))


def _gaps(more: Vector, less: Vector) -> list[Vector]:
    return [np.outer(x, x) - np.outer(y, y) for x, y in zip(more, less, strict=True)]


def _of_steps(parts: Sequence[Vector], step: Vector) -> Inequality:
    """Return an inequality without constant, scaled by the step: short steps change V little."""
    scaled = np.array(parts) / max(float(np.linalg.norm(step)), 1e-9)
    return Inequality(np.zeros((1, *scaled.shape[1:])), scaled[:, None])


def _padded(parts: Vector, m: int) -> Vector:
    """Return the parts of an inequality, padded with zeros for the multipliers."""
    return np.concatenate([parts, np.zeros((m, *parts.shape[1:]))])


def _of_some_size(basis: Vector, m: int) -> list[Inequality]:
    """Return 1 < Q < LARGEST and bounds of 1/τ: the decrease of V does not depend on scale."""
    unit = np.eye(basis.shape[1])[None]
    parts = _padded(basis, m)[:, None]
    bounds = [Inequality(-unit, parts), Inequality(LARGEST * unit, -parts)]
    return [*bounds, *_multipliers(len(basis), m)]


def _multipliers(count: int, m: int) -> list[Inequality]:
    return [multipliers_within(count, m)] if m else []


def _inside(rows: Vector, basis: Vector, m: int) -> Inequality:
    """Return 1 - gᵀQg > 0 for each row g: V ≤ 1 keeps |g z| below 1."""
    parts = -np.einsum("ri,kij,rj->kr", rows, basis, rows)
    return Inequality(np.ones((len(rows), 1, 1)), _padded(parts[..., None, None], m))


def _holding(points: Vector, basis: Vector, m: int) -> Inequality:
    """Return ``[[Q, z], [zᵀ, 1]] > 0`` for each point: V ≤ 1 contains it, with a margin."""
    count, n = points.shape
    constant = np.zeros((count, n + 1, n + 1))
    constant[:, n, :n] = constant[:, :n, n] = points
    constant[:, n, n] = 1.0 - 1e-7
    parts = np.zeros((len(basis), *constant.shape))
    parts[:, :, :n, :n] = basis[:, None]
    return Inequality(constant, _padded(parts, m))


LARGEST = 1e4
"""Bound of P and τ, where V of the linear loop is about 1: it keeps the search bounded."""


def multipliers_within(count: int, m: int) -> Inequality:
    """Return 0 < τ < LARGEST for the unknowns after the first `count`."""
    parts = np.zeros((count + m, 2 * m, 1, 1))
    parts[count:, :m, 0, 0] = np.eye(m)
    parts[count:, m:, 0, 0] = -np.eye(m)
    constant = np.repeat([0.0, LARGEST], m)[:, None, None]
    return Inequality(constant, parts)


def rationals(p: Vector) -> Matrix:
    """Return a matrix as rationals, slightly enlarged for its rounding."""
    p = 0.5 * (p + p.T) * (1.0 + 1e-9)
    scale = 1.0 / np.sqrt(np.diag(p))
    return tuple(
        tuple(short(p[min(i, j), max(i, j)], scale[i] * scale[j]) for j in range(len(p)))
        for i in range(len(p))
    )


def short(x: float, scale: float = 0.0) -> Fraction:
    """Return a number to some 13 digits of the relevant scale."""
    size = scale or 1.0 / max(abs(x), 1e-300)
    digits = 2 ** max(0, int(np.ceil(np.log2(max(size, 1e-300)))) + 44)
    return Fraction(round(Fraction(x) * digits), digits)
