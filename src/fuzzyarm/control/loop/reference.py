"""References over time: step, ramp, sine, quintic move, file; with their derivatives.

Python accepts the words of the command line, ``"step:1"``, and times such as ``"300ms"``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import UsageError
from fuzzyarm.base.names import near_hint, shortened
from fuzzyarm.base.numbers import counted, read_time
from fuzzyarm.base.protected import note_source
from fuzzyarm.plant.plant import PlantError

Vector = NDArray[np.float64]

Derivatives = tuple[Vector, Vector, Vector]
"""A signal at some times, its rate and its acceleration."""


class SignalError(PlantError, UsageError):
    """Invalid words for a reference or a time, or a number in them out of range."""


@dataclass(frozen=True)
class Signal:
    """A reference over time.

    Parameters
    ----------
    kind : str
        ``step``, ``ramp``, ``sine``, ``quintic`` or ``file``.
    numbers : tuple of float
        Parameters of the kind, see :data:`KINDS`.
    path : str, optional
        File of times and values.

    Raises
    ------
    PlantError
        If the kind is unknown or a number out of range.
    """

    kind: str
    numbers: tuple[float, ...] = ()
    path: str = ""

    def __post_init__(self) -> None:
        kind = KINDS.get(self.kind)
        if kind is None:
            hint = near_hint(self.kind, KINDS)[0] or f"one of {', '.join(KINDS)}"
            raise SignalError(f"no reference is called '{self.kind}'", name=self.kind, hint=hint)
        if self.kind != "file" and not kind.least <= len(self.numbers) <= len(kind.words):
            hint = f"{self.kind}:{','.join(kind.words)}"
            message = f"a {self.kind} does not take {counted(len(self.numbers), 'number')}"
            raise SignalError(message, name=self.kind, hint=hint)
        for number in self.numbers:
            if not math.isfinite(number) or abs(number) > 1e12:
                raise SignalError(f"{number} in a reference is out of range", name=self.kind)
        if self.kind == "quintic" and not self.numbers[1] > 0:
            message = f"a move of {self.numbers[1]:g} s is out of range"
            raise SignalError(message, name=self.kind)

    def __str__(self) -> str:
        return f"{self.kind}:{self.path or ','.join(f'{number:g}' for number in self.numbers)}"

    def at(self, time: Vector) -> Derivatives:
        """Return value, rate and acceleration at some times, s."""
        if self.kind == "file":
            return _from_file(self.path, time)
        return KINDS[self.kind].form(time, *self.numbers)


def read_signal(text: str) -> Signal:
    """Read a reference in the notation of users: ``step:1``, ``sine:0.5,2`` or ``FILE.csv``.

    Parameters
    ----------
    text : str
        A kind and its numbers behind a colon, in the unit of the reference and s; or a file of
        times and values.

    Returns
    -------
    Signal
        A function of time.

    Raises
    ------
    PlantError
        If it is not a reference.
    """
    if text.endswith(".csv"):
        return Signal("file", path=text)
    kind, _, rest = text.partition(":")
    try:
        numbers = tuple(_numbers(kind, rest.split(","))) if rest else ()
        if kind and not rest:  # a number alone is a step
            return Signal("step", (float(kind),))
    except ValueError:
        hint = "as in step:1, step:1,5ms, ramp:0.5, sine:1,0.5, quintic:1,2 or a FILE.csv"
        raise SignalError(f"'{text}' is not a signal", name=text, hint=hint) from None
    return Signal(kind, numbers)


def _numbers(kind: str, words: Sequence[str]) -> Iterator[float]:
    """Yield the numbers of a signal; a time may have its unit."""
    names = KINDS[kind].words if kind in KINDS else ()
    for name, word in zip_longest(names, words):
        if word is None:
            return
        is_time = name in ("AT", "SECONDS") and word.strip()[-1:].isalpha()
        yield read_time(word, name) if is_time else float(word)


AnySignal = Signal | str | float
"""A signal, its words on the command line, or the height of a step."""

AnyTime = float | str
"""A time in s, or with its unit: ``"300ms"``."""


def as_signals(references: Mapping[str, AnySignal] | None) -> dict[str, Signal] | None:
    """Convert references to signals, by port; errors as :func:`read_signal`."""
    if references is None:
        return None
    return {name: as_signal(signal, name) for name, signal in references.items()}


def as_signal(signal: AnySignal, name: str = "a reference") -> Signal:
    """Convert to a signal; errors as :func:`read_signal`."""
    if isinstance(signal, Signal):
        return signal
    if isinstance(signal, str):
        return read_signal(signal)
    return Signal("step", (as_number(signal, name, "a signal or a number"),))


def as_seconds(time: AnyTime, what: str) -> float:
    """Convert a time to s; errors as :func:`read_time`, in the name of `what`."""
    if isinstance(time, str):
        return read_time(time, what)
    return as_number(time, what, "a time in s, or text with its unit")


def as_number(value: float, what: str, expected: str = "a number") -> float:
    """Convert to float; PlantError in the name of `what` for anything else."""
    try:
        return float(value)
    except (TypeError, ValueError):
        message = f"{what} takes {expected}, not {shortened(repr(value))}"
        raise SignalError(message, name=what) from None


# --- The kinds ---


def _step(t: Vector, to: float, at: float = 0.0, start: float = 0.0) -> Derivatives:
    zero = np.zeros_like(t)
    return np.where(t >= at, to, start), zero, zero


def _ramp(t: Vector, rate: float, at: float = 0.0, start: float = 0.0) -> Derivatives:
    moves = t >= at
    zero = np.zeros_like(t)
    return start + rate * np.maximum(t - at, 0.0), np.where(moves, rate, 0.0), zero


def _sine(t: Vector, amplitude: float, frequency: float, offset: float = 0.0) -> Derivatives:
    w = 2.0 * math.pi * frequency
    value = amplitude * np.sin(w * t)
    return offset + value, w * amplitude * np.cos(w * t), -w * w * value


def _quintic(t: Vector, to: float, duration: float, start: float = 0.0) -> Derivatives:
    # Minimum-jerk polynomial, from rest to rest: 10 s³ - 15 s⁴ + 6 s⁵ of the way.
    s = np.clip(t / duration, 0.0, 1.0)
    way = to - start
    value = start + way * s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
    rate = way / duration * s * s * (30.0 - 60.0 * s + 30.0 * s * s)
    acceleration = way / duration**2 * s * (60.0 - 180.0 * s + 120.0 * s * s)
    return value, rate, acceleration


@dataclass(frozen=True)
class ReferenceKind:
    """A kind of reference: its parameters, how many are mandatory, its formula."""

    words: tuple[str, ...]
    least: int
    form: Callable[..., Derivatives]


KINDS = {
    "step": ReferenceKind(("TO", "AT", "FROM"), 1, _step),
    "ramp": ReferenceKind(("RATE", "AT", "FROM"), 1, _ramp),
    "sine": ReferenceKind(("AMPLITUDE", "HERTZ", "OFFSET"), 2, _sine),
    "quintic": ReferenceKind(("TO", "SECONDS", "FROM"), 2, _quintic),
    "file": ReferenceKind((), 0, _step),
}
"""Every kind by its name; times in s, the rest in the unit of the port."""


def _from_file(path: str, time: Vector) -> Derivatives:
    """Read ``time,value`` lines, with linear interpolation."""
    rows: list[tuple[float, float]] = []
    note_source(path)
    text = Path(path).read_text(encoding="utf-8", errors="replace")
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or (number == 1 and any(c.isalpha() for c in line)):
            continue
        try:
            first, second = (float(word) for word in line.split(","))
        except ValueError:
            hint = "a line is TIME,VALUE"
            raise PlantError(f"{path}:{number}: '{line}' is not two numbers", hint=hint) from None
        if rows and not first > rows[-1][0]:
            raise PlantError(f"{path}:{number}: the times must increase", name=path)
        if not (math.isfinite(first) and math.isfinite(second)):
            raise PlantError(f"{path}:{number}: '{line}' is not finite", name=path)
        rows.append((first, second))
    if len(rows) < 2:
        raise PlantError(f"{path} has fewer than two times", name=path, hint="TIME,VALUE lines")
    times, values = np.array(rows).T
    slopes = np.append(np.diff(values) / np.diff(times), 0.0)
    place = np.clip(np.searchsorted(times, time, "right") - 1, 0, len(times) - 1)
    inside = (time >= times[0]) & (time < times[-1])
    rate = np.where(inside, slopes[place], 0.0)
    return np.interp(time, times, values), rate, np.zeros_like(time)
