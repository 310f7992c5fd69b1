"""References over time: step, ramp, sine, quintic move, file; with their derivatives.

Python accepts the words of the command line, ``"step:1"``, and times such as ``"300ms"``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import accumulate, cycle, islice, zip_longest
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import UsageError
from fuzzyarm.base.names import near_hint, shortened
from fuzzyarm.base.numbers import counted, decimal, read_time
from fuzzyarm.base.protected import note_source
from fuzzyarm.plant.plant import PlantError
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.nodes import Node, as_node, symbol

Vector = NDArray[np.float64]

Derivatives = tuple[Vector, Vector, Vector]
"""A signal at some times, its rate and its acceleration."""


class TracedSignal(NamedTuple):
    """A signal as expressions, for proofs.

    Attributes
    ----------
    roots : tuple of Node
        Value, rate and acceleration over ``t``, s, and its numbers, ``n0`` …
    numbers : dict of str to Fraction
        Those numbers: times as printed decimals, others exactly.
    """

    roots: tuple[Node, Node, Node]
    numbers: Mapping[str, Fraction]


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
        if self.kind != "file" and not kind.takes(len(self.numbers)):
            hint = f"{self.kind}:{','.join((*kind.words, *kind.more))}"
            message = f"a {self.kind} does not take {counted(len(self.numbers), 'number')}"
            raise SignalError(message, name=self.kind, hint=hint)
        for number in self.numbers:
            if not math.isfinite(number) or abs(number) > 1e12:
                raise SignalError(f"{number} in a reference is out of range", name=self.kind)
        for word, number in self.named:
            if word == "SECONDS" and not number > 0:
                raise SignalError(f"a move of {number:g} s is out of range", name=self.kind)

    def __str__(self) -> str:
        return f"{self.kind}:{self.path or ','.join(f'{number:g}' for number in self.numbers)}"

    def at(self, time: Vector) -> Derivatives:
        """Return value, rate and acceleration at some times, s."""
        if self.kind == "file":
            return _from_file(self.path, time)
        found = KINDS[self.kind].form(time, *self.numbers)
        value, rate, acceleration = (np.broadcast_to(x, np.shape(time)) for x in found)
        return value, rate, acceleration

    @property
    def named(self) -> list[tuple[str, float]]:
        """Its numbers, each with its name in :data:`KINDS`."""
        return list(zip(KINDS[self.kind].names(len(self.numbers)), self.numbers, strict=False))

    @cached_property
    def traced(self) -> TracedSignal:
        """The same formulas as expressions; not of a file."""
        names = [f"n{k}" for k in range(len(self.numbers))]
        value, rate, acceleration = KINDS[self.kind].form(symbol("t"), *map(symbol, names))
        exact = (decimal(x) if word in _TIMES else Fraction(x) for word, x in self.named)
        roots = as_node(value), as_node(rate), as_node(acceleration)
        return TracedSignal(roots, dict(zip(names, exact, strict=True)))

    @cached_property
    def stations(self) -> list[tuple[Fraction, float]]:
        """Its resting values, each with the time from which on it holds, s.

        Empty for a ramp, a sine and a file, which never come to rest.
        """
        numbers = self.numbers
        start = numbers[2] if len(numbers) > 2 else 0.0
        if self.kind == "step":
            at = decimal(numbers[1]) if len(numbers) > 1 else Fraction(0)
            return [*([(Fraction(0), start)] if at > 0 else []), (at, numbers[0])]
        if self.kind == "quintic":
            ends = accumulate(map(decimal, (numbers[1], *numbers[4::2])))
            return [(Fraction(0), start), *zip(ends, (numbers[0], *numbers[3::2]), strict=True)]
        return []

    @property
    def jump(self) -> Fraction | None:
        """Time of a step, or of the jump of a ramp's rate, s, if constant before; else None."""
        at = dict(self.named).get("AT", 0.0)
        return decimal(at) if at > 0.0 else None

    @property
    def moves(self) -> bool:
        """Whether it is not constant from the start on."""
        return len(self.stations) != 1

    @property
    def reach(self) -> float:
        """An upper bound of its magnitude at any time."""
        if self.stations:
            return max(abs(value) for _, value in self.stations)
        if self.kind == "sine":
            return abs(self.numbers[0]) + abs(sum(self.numbers[2:]))
        return math.inf


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
        if kind and not rest:  # a bare number is a step
            return Signal("step", (float(kind),))
    except ValueError:
        hint = "as in step:1, step:1,5ms, ramp:0.5, sine:1,0.5, quintic:1,2 or a FILE.csv"
        raise SignalError(f"'{text}' is not a signal", name=text, hint=hint) from None
    return Signal(kind, numbers)


def _numbers(kind: str, words: Sequence[str]) -> Iterator[float]:
    """Yield the numbers of a signal; a time may have its unit."""
    names = KINDS[kind].names(len(words)) if kind in KINDS else ()
    for name, word in zip_longest(names, words):
        if word is None:
            return
        is_time = name in _TIMES and word.strip()[-1:].isalpha()
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


# --- The kinds: formulas over arrays of times, or over expressions (`Signal.traced`) ---

BESIDE = 1.0 - 2.0**-51
"""Rounding error of a multiple of the period: 3 · 9 ms is 27 ms."""

_TIMES = ("AT", "SECONDS")


def _step(t: Any, to: Any, at: Any = 0.0, start: Any = 0.0) -> tuple[Any, Any, Any]:
    return op.where(t >= at * BESIDE, to, start), 0.0, 0.0


def _ramp(t: Any, rate: Any, at: Any = 0.0, start: Any = 0.0) -> tuple[Any, Any, Any]:
    moves = t >= at * BESIDE
    return start + rate * op.maximum(t - at, 0.0), op.where(moves, rate, 0.0), 0.0


def _sine(t: Any, amplitude: Any, frequency: Any, offset: Any = 0.0) -> tuple[Any, Any, Any]:
    w = 2.0 * math.pi * frequency
    value = amplitude * op.sin(w * t)
    return offset + value, w * amplitude * op.cos(w * t), -w * w * value


def _quintic(t: Any, to: Any, duration: Any, start: Any = 0.0, *more: Any) -> tuple[Any, Any, Any]:
    # Minimum-jerk polynomials, each from rest to rest: 10 s³ - 15 s⁴ + 6 s⁵ of its way.
    value, rate, acceleration, begin, last = start, 0.0, 0.0, 0.0, start
    for end, seconds in ((to, duration), *zip(more[::2], more[1::2], strict=True)):
        s = op.minimum(op.maximum((t - begin) / seconds, 0.0), 1.0)
        way = end - last
        value = value + way * s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
        rate = rate + way / seconds * s * s * (30.0 - 60.0 * s + 30.0 * s * s)
        acceleration = acceleration + way / seconds**2 * s * (60.0 - 180.0 * s + 120.0 * s * s)
        begin, last = begin + seconds, end
    return value, rate, acceleration


@dataclass(frozen=True)
class ReferenceKind:
    """A kind of reference: parameters, number of mandatory ones, formula, further moves."""

    words: tuple[str, ...]
    least: int
    form: Callable[..., tuple[Any, Any, Any]]
    more: tuple[str, ...] = ()

    def takes(self, count: int) -> bool:
        """Return whether it accepts `count` numbers."""
        beyond = count - len(self.words)
        if beyond <= 0:
            return count >= self.least
        return bool(self.more) and beyond % len(self.more) == 0

    def names(self, count: int) -> list[str]:
        """Return the names of `count` numbers."""
        beyond = max(0, count - len(self.words)) if self.more else 0
        return [*self.words, *islice(cycle(self.more), beyond)]


KINDS = {
    "step": ReferenceKind(("TO", "AT", "FROM"), 1, _step),
    "ramp": ReferenceKind(("RATE", "AT", "FROM"), 1, _ramp),
    "sine": ReferenceKind(("AMPLITUDE", "HERTZ", "OFFSET"), 2, _sine),
    "quintic": ReferenceKind(("TO", "SECONDS", "FROM"), 2, _quintic, ("TO", "SECONDS")),
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
