"""Whether a loop is unstable next to rest: an eigenvalue that is proved to be beyond 1.

Every matrix that the loop may have there is enclosed by balls (Arb, in python-flint), the gains of
its blocks included, and so is its characteristic polynomial. The recursion of Schur and Cohn then
shows that not all roots lie within a radius. Gains of a wide range are halved.

Sources: E. I. Jury, *Theory and Application of the z-Transform Method*, Wiley 1964; F. Johansson,
"Arb: efficient arbitrary-precision midpoint-radius interval arithmetic", *IEEE Transactions on
Computers* 66, 2017.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from flint import arb, arb_mat, ctx

from fuzzyarm.closed_loop.form import Form, Matrix
from fuzzyarm.closed_loop.spans import RationalInterval, ball
from fuzzyarm.proof.arithmetic import Stop

__all__ = ["growth"]

BITS = 256
"""Precision of the balls."""

MOST_BOXES = 1024
"""Boxes of gains that are looked at."""

SHARES = (1.0 - 2.0**-20, 0.5, 0.1)
"""Of how far the largest eigenvalue is beyond 1, as floats have it: radii that are tried."""


def growth(form: Form, stop: Stop | None = None) -> float:
    """Return by what some deviation from rest grows in each period at least; 0: not proved to grow.

    Parameters
    ----------
    form : Form
        Of the loop next to rest, as sampled.
    stop : Stop, optional
        When to give up.
    """
    waiting = [(RationalInterval(Fraction(-1), Fraction(1)),) * len(form.blocks)]
    least, count = float("inf"), 1
    while waiting:
        gains = waiting.pop()
        radius = _largest(form, gains)
        if radius > 1.0:
            least = min(least, radius)
            continue
        if count >= MOST_BOXES or not gains or (stop is not None and stop.now):
            return 0.0
        count += 2
        k = max(range(len(gains)), key=lambda j: gains[j].radius)
        low, high = gains[k]
        ends = ((low, gains[k].middle), (gains[k].middle, high))
        waiting += [(*gains[:k], RationalInterval(*end), *gains[k + 1 :]) for end in ends]
    return least


def _largest(form: Form, gains: tuple[RationalInterval, ...]) -> float:
    """Return a lower bound of the spectral radius of all matrices of a form; 0: none is known."""
    n, m = form.size, len(form.blocks)
    with ctx.workprec(BITS):
        whole = _balls(form.a, form.b, form.radius, n)
        matrix = arb_mat([row[:n] for row in whole])
        if m:
            # w = Δ (C z + D w): with the answers w taken out, z⁺ = (A + B (1 − Δ D)⁻¹ Δ C) z.
            delta = [_ball(gain.middle, gain.radius) for gain in gains]
            reads = [[d * _ball(x) for x in row] for d, row in zip(delta, form.blocks, strict=True)]
            unit = arb_mat([[arb(int(i == j)) for j in range(m)] for i in range(m)])
            try:
                answers = (unit - arb_mat([row[n:] for row in reads])).solve(
                    arb_mat([row[:n] for row in reads])
                )
            except (ZeroDivisionError, ValueError):
                return 0.0
            matrix += arb_mat([row[n:] for row in whole]) * answers
        near = np.linalg.eigvals([[float(x.mid()) for x in row] for row in matrix.tolist()])
        beyond = float(np.abs(near).max()) - 1.0
        coefficients = list(matrix.charpoly())
        for share in SHARES:
            radius = 1.0 + share * beyond
            if radius > 1.0 and _goes_beyond(coefficients, radius):
                return radius
        return 0.0


def _goes_beyond(coefficients: list[arb], radius: float) -> bool:
    """Tell whether a polynomial, lowest power first, has a root of at least a magnitude."""
    rest = [c * arb(radius) ** k for k, c in enumerate(coefficients)]
    while len(rest) > 1:
        # All roots are within 1 only if the product of them is, and those of the next one are.
        first, last = abs(rest[0]), abs(rest[-1])
        if first > last:
            return True
        if not first < last:
            return False
        rest = [rest[-1] * x - rest[0] * y for x, y in zip(rest, reversed(rest), strict=True)][1:]
    return False


def _balls(a: Matrix, b: Matrix, radius: Matrix, n: int) -> list[list[arb]]:
    return [[_ball(x, r) for x, r in zip((*a[i], *b[i]), radius[i], strict=True)] for i in range(n)]


def _ball(middle: Fraction, radius: Fraction = Fraction(0)) -> arb:
    return ball(middle) + ball(radius) * arb(0, 1)
