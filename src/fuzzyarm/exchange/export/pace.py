"""The period of a controller on a board: the clock that counts it, and whether a call fits."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from fuzzyarm.base.numbers import number_text
from fuzzyarm.exchange.export.avr import TOOLS, Measured
from fuzzyarm.exchange.export.boards import Board
from fuzzyarm.exchange.export.numbers import ExportError

__all__ = ["SHORTEST", "Clock", "Pace", "clock_of", "demand_pace", "unchecked"]

SHORTEST = 100
"""The shortest period of a board, in µs: half of one is 0.5 % of it."""

_MOST_COUNTS = 2**31
"""Half of what 32 bits count: a loop that is late by less than that is seen to be late."""

SHARE = 0.9
"""How much of a period a call may take."""

PIN_SECONDS = 112e-6
"""What ``analogRead`` takes on an AVR, as the Arduino core sets its converter up."""


@dataclass(frozen=True, slots=True)
class Clock:
    """A function of the Arduino core, and the period in its counts."""

    function: str
    count: int
    unit: str


def clock_of(period: float) -> Clock:
    """Return what counts a period, rounded to whole counts; ExportError if it is too short.

    The longest period of the language, an hour, is within the milliseconds.
    """
    micros = round(period * 1e6)
    if micros < SHORTEST:
        raise ExportError(
            f"a period of {number_text(period)} s is too short for a board, which counts"
            f" microseconds: at least {SHORTEST} µs",
            hint=f"period {SHORTEST} us",
        )
    if micros <= _MOST_COUNTS:
        return Clock("micros", micros, "µs")
    return Clock("millis", round(period * 1e3), "ms")


@dataclass(frozen=True, slots=True)
class Pace:
    """What a turn of the sketch takes, in s: the slowest call that was seen, and its pins."""

    call: float
    pins: float

    @property
    def whole(self) -> float:
        """Both."""
        return self.call + self.pins


def pace_of(measured: Measured | None, board: Board, inputs: int) -> Pace | None:
    """Return what a turn takes; None where no cycles were counted."""
    if measured is None or not measured.cycles:
        return None
    return Pace(max(measured.cycles) / board.clock, min(inputs, board.pins) * PIN_SECONDS)


def demand_pace(
    pace: Pace | None,
    period: float,
    name: str,
    board: Board,
    others: Mapping[str, Callable[[], Pace | None]],
) -> None:
    """Raise `ExportError` where a turn takes over 90 % of the period, with what fits.

    Parameters
    ----------
    pace : Pace or None
        What a turn takes; None passes.
    period : float
        In s.
    name : str
        Of the program.
    board : Board
        Where it runs.
    others : mapping of str to callable
        Options of the command, and what a turn takes with them.
    """
    if pace is None or pace.whole <= SHARE * period:
        return
    reading = f" and {_short(pace.pins)} to read its pins" if pace.pins else ""
    raise ExportError(
        f"'{name}' takes {_short(pace.call)} a call{reading} on {board.named},"
        f" {100.0 * pace.whole / period:.0f} % of its period of {_short(period)}, and"
        f" {100.0 * SHARE:.0f} % is the most",
        hint=_fitting(pace, period, others),
    )


def _fitting(pace: Pace, period: float, others: Mapping[str, Callable[[], Pace | None]]) -> str:
    """Return what fits: the first option that does, and a longer period."""
    words = [f"a period of {_short(_rounded_up(pace.whole / SHARE))} holds it"]
    for option, made in others.items():
        other = made()
        if other is not None and other.whole <= SHARE * period:
            return f"with {option} it takes {_short(other.whole)}; {words[0]} as it is"
        if other is not None and other.whole < 0.8 * pace.whole:
            longer = _short(_rounded_up(other.whole / SHARE))
            words.append(f"with {option} {longer} does")
    return ", ".join(words)


def unchecked(measured: Measured | None, board: Board, period: float) -> str:
    """Return a sentence on a period that could not be checked; empty where it was."""
    if measured is not None and measured.cycles:
        return ""
    why = f"that needs {TOOLS}" if board.avr else "cycles are counted for AVR boards"
    return f"Not checked: whether a call fits into the period of {_short(period)}; {why}."


def _rounded_up(seconds: float) -> float:
    """Return a time of two digits that is no shorter."""
    step = 10.0 ** (math.floor(math.log10(seconds)) - 1)
    return math.ceil(seconds / step) * step


def _short(seconds: float) -> str:
    """Return a time in three digits, in its unit."""
    for factor, unit in ((1.0, "s"), (1e-3, "ms")):
        if seconds >= factor:
            return f"{seconds / factor:.3g} {unit}"
    return f"{seconds * 1e6:.3g} µs"
