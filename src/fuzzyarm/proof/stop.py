"""The time budget of a proof, and the reports of its progress."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from contextvars import ContextVar, Token
from typing import Self

from fuzzyarm.base.errors import FuzzyarmError


class TimeOverError(FuzzyarmError, TimeoutError):
    """The time budget of a proof is spent."""

    def __init__(self) -> None:
        super().__init__("time ran out")


TUBE_BUDGET = 60.0
"""Default budget of a tube or of a tube's certificate, processor seconds."""

LOOP_BUDGET = 300.0
"""Default budget of the search for a region of a loop, and of a map, processor seconds."""

PATIENCE = 10.0
"""Wall-clock seconds for each second of work, after which a proof gives up in any case."""


def default_budget(budget: float, default: float) -> float:
    """Return a budget, or the default of one that is not given (infinite)."""
    return default if math.isinf(budget) else budget


_worked = getattr(time, "thread_time", time.process_time)


_running: ContextVar[Stop | None] = ContextVar("running", default=None)
"""The stop within which everything is computed."""


def check_time() -> None:
    """Raise TimeOverError when the time of an enclosing stop is over."""
    stop = _running.get()
    if stop is not None:
        stop.check()


class Stop:
    """A time budget, and a listener for progress.

    ``with stop:`` limits all work inside, exact arithmetic and inner stops included.

    Time is processor time of the thread that makes the stop, so that a verdict does not depend on
    the load of the machine. The clock is an upper limit, see :data:`PATIENCE`.

    Parameters
    ----------
    seconds : float
        Processor time allowed.
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
        """Seconds of work so far."""
        on_the_clock = time.monotonic() - self._begun
        if threading.get_ident() != self._thread:  # another thread's work is unknown
            return on_the_clock
        return max(_worked() - self._work, on_the_clock / PATIENCE)

    @property
    def left(self) -> float:
        """Seconds left."""
        left = self._seconds - self.spent
        return left if self._outer is None else min(left, self._outer.left)

    @property
    def now(self) -> bool:
        """Whether time is over."""
        # No thread works longer than the clock runs, which is two hundred times cheaper to ask.
        over = time.monotonic() - self._begun > self._seconds and self.spent > self._seconds
        return over or (self._outer is not None and self._outer.now)

    def half(self) -> Stop:
        """Return a stop with half of the time left, for the first of two searches."""
        return Stop(0.5 * self.left, self.tell)

    def check(self, count: int = 0) -> None:
        """Raise TimeOverError when time is over; report the number of open pieces."""
        if self.now:
            raise TimeOverError
        if count:
            self.say(count)

    def say(self, count: int, gap: float = math.nan) -> None:
        """Report the number of open pieces and the gap between the bounds."""
        if self.tell is not None:
            self.tell(count, gap)
