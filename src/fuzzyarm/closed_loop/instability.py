"""Whether a loop is unstable next to rest: an eigenvalue that is proved to be beyond 1.

Every matrix that the loop may have there is enclosed by balls (Arb, in python-flint), the gains of
its blocks included; their eigenvalues are enclosed as well. Gains of a wide range are halved.

Source: F. Johansson, "Arb: efficient arbitrary-precision midpoint-radius interval arithmetic",
*IEEE Transactions on Computers* 66, 2017.
"""

from __future__ import annotations

from fractions import Fraction

from flint import acb_mat, arb, arb_mat, ctx

from fuzzyarm.closed_loop.form import Form, Matrix
from fuzzyarm.closed_loop.outward import below
from fuzzyarm.closed_loop.spans import RationalInterval, ball, end_of_ball

__all__ = ["growth"]

BITS = 128
"""Precision of the balls."""

MOST_BOXES = 256
"""Boxes of gains that are looked at."""


def growth(form: Form) -> float:
    """Return by what some deviation from rest grows in each period at least; 0: not proved to grow.

    Parameters
    ----------
    form : Form
        Of the loop next to rest, as sampled.
    """
    waiting = [(RationalInterval(Fraction(-1), Fraction(1)),) * len(form.blocks)]
    least, count = float("inf"), 1
    while waiting:
        gains = waiting.pop()
        radius = _largest(form, gains)
        if radius > 1.0:
            least = min(least, radius)
            continue
        if count >= MOST_BOXES or not gains:
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
        try:
            values = acb_mat(matrix).eig(multiple=True)
        except ValueError:  # not enclosed
            return 0.0
        return max((below(end_of_ball(abs(value).lower())) for value in values), default=0.0)


def _balls(a: Matrix, b: Matrix, radius: Matrix, n: int) -> list[list[arb]]:
    return [[_ball(x, r) for x, r in zip((*a[i], *b[i]), radius[i], strict=True)] for i in range(n)]


def _ball(middle: Fraction, radius: Fraction = Fraction(0)) -> arb:
    return ball(middle) + ball(radius) * arb(0, 1)
