r"""Instability of a loop near rest, by Lyapunov's (Chetaev's) theorem.

A quadratic V = zᵀ P z with V < 0 for some z, and for some r > 1

    V(A z + B w) − r² V(z) + Σ τₖ (vₖ² − wₖ²) < 0   for all (z, w) other than 0, τₖ ≥ 0:

from V(z) < 0 a deviation grows by r in each period, in V, so that it leaves every neighbourhood of
the rest in which the form is valid. Gains may vary in every period, so that corners at rest do not
matter. P and τ are found in floats; the inequality is checked in rationals, for the loop derived by
the checker.

Source: H. K. Khalil, *Nonlinear Systems*, 3rd edition, Prentice Hall 2002, section 4.1 (Chetaev's
theorem).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from fuzzyarm.proof.check.loop import System
from fuzzyarm.proof.check.numbers import exact
from fuzzyarm.proof.check.region import falls, quadratic_at
from fuzzyarm.proof.loop.linear import declining
from fuzzyarm.proof.stop import Stop

SHARES = (1.0 - 2.0**-20, 0.9, 0.7, 0.5, 0.3, 0.1, 0.03)
"""Growths to try, as shares of the largest eigenvalue's excess over 1 in floats."""


def growth(loop: System, stop: Stop | None = None) -> float:
    """Return a growth per period of some deviation from rest; 0: no proof of growth."""
    stop = stop or Stop()
    if not all(limit > 0 for _, limit, _ in loop.rows):  # not valid in any neighbourhood of rest
        return 0.0
    a = np.array([[float(x) for x in row[: loop.size]] for row in loop.move])
    beyond = float(np.abs(np.linalg.eigvals(a)).max()) - 1.0
    for share in SHARES:
        rate = 1.0 + share * beyond
        if not rate > 1.0 or stop.now:
            return 0.0
        found = declining(loop, rate, stop)
        if found is not None and _grows(loop, *found, Fraction(rate)):
            return rate
    return 0.0


def _grows(
    loop: System,
    p: Sequence[Sequence[Fraction]],
    multipliers: Sequence[Fraction],
    rate: Fraction,
) -> bool:
    """Return whether V shows the growth of a deviation by a rate: in rationals."""
    if any(multiplier < 0 for multiplier in multipliers) or not _is_negative_somewhere(p):
        return False
    return falls(loop, p, multipliers, 1 - rate * rate)


def _is_negative_somewhere(p: Sequence[Sequence[Fraction]]) -> bool:
    vectors = np.linalg.eigh(np.array([[float(x) for x in row] for row in p]))[1]
    return bool(quadratic_at(p, [exact(float(x)) for x in vectors[:, 0]]) < 0)  # of the least one
