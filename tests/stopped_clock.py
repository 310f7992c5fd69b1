"""A clock that goes on only where a test says so: what is said in time is so on any machine."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest


class StoppedClock:
    """Stands in for `time` and `threading`: the clock of one, the timers of the other."""

    def __init__(self) -> None:
        self.now = 0.0
        self.timers: list[Timer] = []

    def put_into(self, module: Any, monkeypatch: pytest.MonkeyPatch) -> None:
        """Have a module look at this clock."""
        monkeypatch.setattr(module, "time", self)
        monkeypatch.setattr(module, "threading", self)

    def monotonic(self) -> float:
        """Return the seconds that have passed."""
        return self.now

    def sleep(self, seconds: float) -> None:
        """Let time pass; timers that are due by then act, the first at first."""
        end = self.now + seconds
        while due := [each for each in self.timers if each.at <= end]:
            first = min(due, key=lambda each: each.at)
            self.timers.remove(first)
            self.now = first.at
            first.act()
        self.now = end

    def Timer(self, seconds: float, act: Callable[[], object]) -> Timer:  # noqa: N802
        """Return a timer."""
        return Timer(self, self.now + seconds, act)


class Timer:
    """Acts at its time, if it has been started and not cancelled."""

    def __init__(self, clock: StoppedClock, at: float, act: Callable[[], object]) -> None:
        self.clock, self.at, self.act = clock, at, act

    def start(self) -> None:
        """Wait for the time."""
        self.clock.timers.append(self)

    def cancel(self) -> None:
        """Wait no more."""
        if self in self.clock.timers:
            self.clock.timers.remove(self)
