"""The time that a proof may take, and whom it tells of its progress."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from contextvars import ContextVar, Token
from typing import Self

from fuzzyarm.base.errors import FuzzyarmError


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
        self, seconds: float = math.inf, tell: Callable[[int, float], None] | None = None
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
        # No thread works longer than the clock runs, which is two hundred times cheaper to ask.
        over = time.monotonic() - self._begun > self._seconds and self.spent > self._seconds
        return over or (self._outer is not None and self._outer.now)

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
