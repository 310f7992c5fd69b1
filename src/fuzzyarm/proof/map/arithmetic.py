"""The two arithmetics of a proof: floats with a margin, and rationals.

Every array of a proof is made by one of them, and the code over arrays is the same: rationals are
objects in a NumPy array, those of ``python-flint``, about five times as fast as Python's
``Fraction``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
"""An array of float64, or of rationals as objects."""


class Arithmetic(NamedTuple):
    """The arithmetic of a proof."""

    exact: bool  # whether there is no rounding
    # Converts a Fraction to a number of this arithmetic, the nearest one
    number: Callable[[Fraction], Any]
    name: str  # ``floats``, or the library of the rationals

    def array(self, values: Any) -> Array:
        """Return an array of numbers from (nested lists of) Fractions or whole numbers."""
        plain = np.array(values, dtype=object)
        numbers = [self.number(value) for value in plain.ravel()]
        numbers_array: Array = np.empty(plain.size, dtype=object if self.exact else np.float64)
        numbers_array[:] = numbers
        return numbers_array.reshape(plain.shape)

    def zeros(self, *shape: int) -> Array:
        """Return an array of zeros."""
        if not self.exact:
            return np.zeros(shape)
        values: Array = np.full(shape, self.number(Fraction(0)), dtype=object)
        return values

    def ones(self, *shape: int) -> Array:
        """Return an array of ones."""
        return np.asarray(self.zeros(*shape) + self.number(Fraction(1)))


FLOATS = Arithmetic(exact=False, number=float, name="floats")


@cache
def rationals() -> Arithmetic:
    """Return exact arithmetic, by ``python-flint`` if installed."""
    try:
        from flint import fmpq
    except ImportError:
        return Arithmetic(exact=True, number=Fraction, name="fractions")

    def number(value: Fraction) -> Any:
        return fmpq(value.numerator, value.denominator)

    return Arithmetic(exact=True, number=number, name="flint")


def as_fraction(number: Any) -> Fraction:
    """Return a number of either arithmetic as a Fraction."""
    if hasattr(number, "p") and hasattr(number, "q"):
        return Fraction(int(number.p), int(number.q))
    return Fraction(number)


def nearest_float(number: Any) -> float:
    """Return the nearest float; infinity where there is none as large."""
    try:
        return float(number)
    except OverflowError:  # of rationals
        return math.inf if number > 0 else -math.inf


# ── short rows ───────────────────────────────────────────────────────────────────────
#
# NumPy reduces rows of a few numbers one row at a time; column by column is many times as fast.


def _folded(rows: Array, operation: Callable[[Array, Array], Array]) -> Array:
    values = rows[:, 0]
    for column in range(1, rows.shape[1]):
        values = operation(values, rows[:, column])
    return values


def greatest_of_rows(rows: Array) -> Array:
    """Return the greatest number of each row."""
    return _folded(rows, np.maximum)


def least_of_rows(rows: Array) -> Array:
    """Return the least number of each row."""
    return _folded(rows, np.minimum)


def sums_of_rows(rows: Array) -> Array:
    """Return the sum of each row."""
    return _folded(rows, np.add)


def any_of_rows(rows: Array) -> Array:
    """Return whether each row has a true element."""
    return _folded(rows, np.logical_or)
