"""The two arithmetics of a proof: floats with a margin, and rationals.

Every array of a proof is made by one of them, and the code over the arrays is the same: an
array of rationals is a NumPy array of objects: of ``python-flint``, whose rationals are about five
times as fast as the ``Fraction`` of Python.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from contextvars import ContextVar, Token
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError

__all__ = [
    "FLOATS",
    "Arithmetic",
    "Array",
    "Stop",
    "TimeOverError",
    "any_of_rows",
    "as_fraction",
    "check_time",
    "greatest_of_rows",
    "least_of_rows",
    "rationals",
    "sums_of_rows",
]

Array = NDArray[Any]
"""Of float64, or of rationals as objects."""


class Arithmetic(NamedTuple):
    """How a proof computes.

    Attributes
    ----------
    exact : bool
        Whether nothing is ever rounded.
    number : callable
        From a Fraction to a number of its kind, the nearest where it rounds.
    name : str
        ``floats``, or the library of the rationals.
    """

    exact: bool
    number: Callable[[Fraction], Any]
    name: str

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
    """Return exact arithmetic, by ``python-flint`` where it is installed."""
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
    """Tell whether anything in each row is true."""
    return _folded(rows, np.logical_or)


class TimeOverError(FuzzyarmError, TimeoutError):
    """The time for a proof is over."""

    def __init__(self) -> None:
        super().__init__("time ran out")


PATIENCE = 10.0
"""Seconds on the clock for each second of work, after which a proof gives up whatever it did."""

_worked = getattr(time, "thread_time", time.process_time)


_running: ContextVar[Stop | None] = ContextVar("running", default=None)
"""The stop within which everything is computed."""


def check_time() -> None:
    """Raise TimeOverError when the time is over in which a stop lets everything be computed."""
    stop = _running.get()
    if stop is not None:
        stop.check()


class Stop:
    """When to give up, and whom to tell of the progress.

    ``with stop:`` limits all that is computed within, exact arithmetic and stops of its own too.

    Time is that of work: the processor's, in the thread that makes the stop. So a verdict is the
    same on a machine that does something else beside. The clock is an upper stop, see
    :data:`PATIENCE`.

    Parameters
    ----------
    seconds : float
        How long a proof may work.
    tell : callable, optional
        Called with the number of open pieces and the gap between the bounds; NaN before there are
        bounds, while pieces are still being cut.
    """

    def __init__(
        self, seconds: float = np.inf, tell: Callable[[int, float], None] | None = None
    ) -> None:
        self._seconds = seconds
        self._thread = threading.get_ident()
        self._begun = time.monotonic()
        self._work = _worked()
        self._outer = _running.get()
        self._tokens: list[Token[Stop | None]] = []
        self.tell = tell

    def __enter__(self) -> Self:
        self._tokens.append(_running.set(self))
        return self

    def __exit__(self, *_: object) -> None:
        _running.reset(self._tokens.pop())

    @property
    def spent(self) -> float:
        """How many seconds were worked."""
        on_the_clock = time.monotonic() - self._begun
        if threading.get_ident() != self._thread:  # whose work is not known
            return on_the_clock
        return max(_worked() - self._work, on_the_clock / PATIENCE)

    @property
    def left(self) -> float:
        """How many seconds are left."""
        left = self._seconds - self.spent
        return left if self._outer is None else min(left, self._outer.left)

    @property
    def now(self) -> bool:
        """Whether time is over."""
        return self.left < 0.0

    def half(self) -> Stop:
        """Return the first half of the time that is left, for the first of two searches."""
        return Stop(0.5 * self.left, self.tell)

    def check(self, count: int = 0) -> None:
        """Raise TimeOverError when time is over; tell how many pieces there are by now."""
        if self.now:
            raise TimeOverError
        if count:
            self.say(count)

    def say(self, count: int, gap: float = math.nan) -> None:
        """Tell how many pieces there are, and how far apart the bounds."""
        if self.tell is not None:
            self.tell(count, gap)
