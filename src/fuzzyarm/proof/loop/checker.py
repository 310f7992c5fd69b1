"""Whether a certificate proves a loop's form: rational arithmetic, nothing else, nothing trusted.

For a symmetric P, multipliers τₖ ≥ 0 and a rate ρ in [0, 1) it checks

1. P > 0;
2. (1 − ρ) V(z) − V(A z + B w) − Σ τₖ (vₖ² − wₖ²) > 0 for all (z, w) ≠ 0, with what the radius
   of A and B may change taken off the diagonal (a symmetric matrix with |Eᵢⱼ| ≤ Sᵢⱼ is at most the
   diagonal matrix of the sums of the rows of S); in continuous time 2 zᵀP(A z + B w) in place
   of the difference;
3. V ≤ 1 keeps |g z| ≤ limit for each row of the form's bounds: [[P, g], [gᵀ, limit²]] > 0.

Then V ≤ 1 is never left, and every motion that begins in it goes to rest, V falling by a factor
1 − ρ in each period: the loop is the form wherever the bounds hold, and in its blocks |wₖ| ≤ |vₖ|.

A matrix is positive definite where all its leading minors are above 0 (Sylvester's criterion);
these are whole numbers here, by elimination without fractions.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Protocol

from fuzzyarm.proof.stop import check_time

__all__ = ["Matrices", "falls", "is_inside", "is_positive_definite", "refutation"]

Rows = Sequence[Sequence[Fraction]]
Matrix = list[list[Fraction]]


class Matrices(Protocol):
    """A loop: ``z' = A z + B w, |wₖ| ≤ |Cₖ z + Dₖ w|``, within bounds."""

    @property
    def size(self) -> int:
        """How many z there are."""

    @property
    def a(self) -> Rows:
        """A."""

    @property
    def b(self) -> Rows:
        """B."""

    @property
    def radius(self) -> Rows:
        """How far the true ``[A B]`` may be from these numbers."""

    @property
    def blocks(self) -> Rows:
        """``[Cₖ Dₖ]``."""

    @property
    def period(self) -> float:
        """Of control, s; 0 in continuous time."""

    def rows_within(self) -> Sequence[tuple[Sequence[Fraction], Fraction, str]]:
        """Return rows g, limits and what they are: the loop is so where all |g z| ≤ limit."""


BITS = 200
"""Of the entries of a matrix whose minors are found; what is rounded off is off the diagonal."""


def refutation(
    loop: Matrices, p: Rows, multipliers: Sequence[Fraction], rate: Fraction = Fraction(0)
) -> str:
    """Return why a certificate does not prove a form; empty where it does.

    Parameters
    ----------
    loop : Matrices
        The loop.
    p : rows of Fraction, shape (n, n)
        Of V.
    multipliers : sequence of Fraction
        τ of each block.
    rate : Fraction
        ρ; of a loop in continuous time 0.
    """
    n, m = loop.size, len(loop.blocks)
    if len(p) != n or any(len(row) != n for row in p) or len(multipliers) != m:
        return "its matrices are not of the loop's size"
    if any(multiplier < 0 for multiplier in multipliers) or not 0 <= rate < 1:
        return "a multiplier or the rate is out of range"
    if any(p[i][j] != p[j][i] for i in range(n) for j in range(i)) or not is_positive_definite(p):
        return "its matrix is not symmetric and positive definite"
    if not falls(loop, p, multipliers, rate):
        return "its function does not fall"
    for row, limit, words in loop.rows_within():
        if not is_inside(p, row, limit):
            return f"its region leaves the bounds of {words}"
    return ""


def is_inside(
    p: Rows, row: Sequence[Fraction], limit: Fraction, level: Fraction = Fraction(1)
) -> bool:
    """Tell whether zᵀPz ≤ level keeps |g z| below a limit."""
    if not any(row):
        return limit > 0
    return is_positive_definite(
        [*([*line, g] for line, g in zip(p, row, strict=True)), [*row, limit * limit / level]]
    )


def falls(loop: Matrices, p: Rows, multipliers: Sequence[Fraction], rate: Fraction) -> bool:
    """Tell whether V falls along the form, see 2. above."""
    size = loop.size + len(loop.blocks)
    if loop.period:
        total, spread = _fall_in_period(loop, p, rate)
    elif rate:
        return False
    else:
        total, spread = _fall_of_rate(loop, p)
    # Less Σ τ (v² − w²): v is a row over z and w, w one coordinate.
    for k, tau in enumerate(multipliers):
        v = loop.blocks[k]
        for i in range(size):
            if v[i]:
                for j in range(size):
                    total[i][j] -= tau * v[i] * v[j]
        total[loop.size + k][loop.size + k] += tau
    for i in range(size):
        total[i][i] -= sum(spread[i], Fraction(0))
    return is_positive_definite(total)


def _fall_in_period(loop: Matrices, p: Rows, rate: Fraction) -> tuple[Matrix, Matrix]:
    """Return (1 − ρ) P − [A B]ᵀ P [A B], and how far the true one may be from it."""
    size = loop.size + len(loop.blocks)
    move = [[*a, *b] for a, b in zip(loop.a, loop.b, strict=True)]
    carried = _product(p, move)
    after = _product(_transposed(move), carried)
    # |(M + E)ᵀ P (M + E) − Mᵀ P M| ≤ |Eᵀ P M| + its transpose + |Eᵀ P E|, entry by entry.
    first = _product(_transposed(loop.radius), _sizes(carried))
    second = _product(_transposed(loop.radius), _product(_sizes(p), loop.radius))
    total = [[-after[i][j] for j in range(size)] for i in range(size)]
    spread = [[first[i][j] + first[j][i] + second[i][j] for j in range(size)] for i in range(size)]
    for i in range(loop.size):
        for j in range(loop.size):
            total[i][j] += (1 - rate) * p[i][j]
    return total, spread


def _fall_of_rate(loop: Matrices, p: Rows) -> tuple[Matrix, Matrix]:
    """Return −(P [A B] + its transpose), and how far the true one may be from it."""
    size = loop.size + len(loop.blocks)
    carried = _product(p, [[*a, *b] for a, b in zip(loop.a, loop.b, strict=True)])
    error = _product(_sizes(p), loop.radius)
    total = [[Fraction(0)] * size for _ in range(size)]
    spread = [[Fraction(0)] * size for _ in range(size)]
    for i in range(loop.size):
        for j in range(size):
            total[i][j] -= carried[i][j]
            total[j][i] -= carried[i][j]
            spread[i][j] += error[i][j]
            spread[j][i] += error[i][j]
    return total, spread


def is_positive_definite(matrix: Rows) -> bool:
    """Tell whether a symmetric rational matrix is certainly positive definite."""
    size = len(matrix)
    if any(matrix[i][i] <= 0 for i in range(size)):
        return False
    # Rows and columns times powers of 2, so that the diagonal is near 1: the signs stay.
    shift = [-(_exponent(matrix[i][i]) // 2) for i in range(size)]
    whole = [
        [_rounded(matrix[i][j], shift[i] + shift[j] + BITS) for j in range(size)]
        for i in range(size)
    ]
    for i in range(size):
        whole[i][i] -= size + 1  # each entry is rounded by less than 1
    before = 1
    for k in range(size):
        check_time()
        pivot = whole[k][k]
        if pivot <= 0:
            return False
        for i in range(k + 1, size):
            for j in range(k + 1, size):
                # Bareiss: the division leaves no rest, and each pivot is the next leading minor.
                whole[i][j] = (whole[i][j] * pivot - whole[i][k] * whole[k][j]) // before
        before = pivot
    return True


def _exponent(x: Fraction) -> int:
    return x.numerator.bit_length() - x.denominator.bit_length()


def _rounded(x: Fraction, shift: int) -> int:
    """Return x times a power of 2 as a whole number, off by less than 1."""
    if shift >= 0:
        return (x.numerator << shift) // x.denominator
    return x.numerator // (x.denominator << -shift)


def _product(a: Rows, b: Rows) -> list[list[Fraction]]:
    rows = []
    for row in a:
        check_time()
        terms = [(x, b[k]) for k, x in enumerate(row) if x]
        rows.append([sum((x * y[j] for x, y in terms), Fraction(0)) for j in range(len(b[0]))])
    return rows


def _sizes(a: Rows) -> Matrix:
    return [[abs(x) for x in row] for row in a]


def _transposed(a: Rows) -> list[list[Fraction]]:
    return [list(row) for row in zip(*a, strict=True)]
