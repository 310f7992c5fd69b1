"""Sources of the signals of a controller, a record each: what all of the program knows of one.

``NAME = deadband of e, width 0.5`` is one record: its word and its options, what it remembers from
period to period, its update as one expression, its unit and its range. The reader, completion and
help, the kernel, ranges, proofs, describing functions, diagrams, C and Structured Text read that
record, and nothing else says what a source is. The list is closed: each of them has a textbook
structure after it.

To add a source
---------------
1. Write its update as a function of the arguments below, with arithmetic, comparisons and
   :mod:`fuzzyarm.op`, no ``if``: the value of this period. What it remembers is a
   :class:`SourceState`: a name, its next value (a function of ``value`` and of the arguments), and
   its start.
2. Add one ``kind(…)`` to `_register`, or call :func:`source` from a program of your own.
3. Rebuild the machine code (``python -m fuzzyarm.apps.native.build``), add a line to the table in
   ``docs/reference/controllers.md``, and run ``pytest tests/controller/test_sources.py``: it takes
   every record through the language, both kinds of loop, ranges, proofs, describing functions,
   diagrams and exports.

Without ``bounds`` its range follows from its update. A proof takes its update as it is, or refuses
it by the name of the operation that it cannot enclose.

The arguments of an update are found by their names:

================  ==============================================================================
``x``             what the source is taken of: a signal, or the error of a port
``period``        the control period, s
``last``          the condition that a set point ends with this period
``excess``        by how much the limits of its drive changed that in the last period
``gain``          by how much that drive grows with what the source gives
a state           what it remembered; NaN where it starts so and has seen nothing yet
an option         by its word: a number or a time (0 where it is not given), 1 or 0 for words;
                  of ``within`` both ends, ``within_low`` and ``within_high``; of
                  ``anti-windup`` -1 for ``hold``, else a time
================  ==============================================================================
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import Any, Literal, NamedTuple

from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.nodes import Node, argument_names, trace
from fuzzyarm.symbolic.operations import EVERYTHING, Interval
from fuzzyarm.symbolic.records import Kind, KindError, Registry

__all__ = [
    "SOURCES",
    "OptionKind",
    "Setting",
    "SourceKind",
    "SourceState",
    "Surroundings",
    "source",
    "unseen",
]

X = Any
"""An expression or a number."""

Setting = str | float | tuple[float, float] | bool
"""What an option says: a number or the name of a gain; s; a pair; true; ``"hold"`` or s."""

VALUE = "value"
"""Symbol of what an update gives, in what is remembered of it."""

ALWAYS = ("x", "period")
"""Arguments that every update is given, whether it takes them or not."""

SUPPLIED = (*ALWAYS, "last", "excess", "gain")
"""Arguments of updates that the program supplies."""


def unseen(state: X) -> X:
    """Return the condition that a state, NaN at first, has seen nothing yet."""
    return ~op.equal(state, state)


class OptionKind(NamedTuple):
    """A record: a word after a comma, what follows it, and what it means.

    Attributes
    ----------
    takes : str
        ``number`` (or the name of a gain), ``figure`` (a number), ``time`` (with a unit),
        ``range`` (``A .. B``), ``words`` (nothing but the words in `rest`), or ``windup``:
        ``hold``, or ``back TIME``.
    doc : str
        One line.
    rest : tuple of str
        Words that stand after it.
    needed : bool
        Whether the source means nothing without it.
    positive : bool
        Whether its number must be above 0.
    alike : bool
        Whether it is in the unit of what the source is taken of.
    periods : bool
        Whether its time must be whole control periods, at most `MOST_PERIODS`.
    """

    takes: Literal["number", "figure", "time", "range", "words", "windup"]
    doc: str
    rest: tuple[str, ...] = ()
    needed: bool = False
    positive: bool = False
    alike: bool = False
    periods: bool = False

    @property
    def example(self) -> str:
        """What may follow the word."""
        texts = {"time": "10 ms", "range": "-1 .. 1", "windup": "hold"}
        return " ".join(self.rest) or texts.get(self.takes, "0.5")


class SourceState(NamedTuple):
    """What a source remembers from one period to the next.

    Attributes
    ----------
    name : str
        An argument of the update; in exported programs it stands after the name of the signal.
    next : callable
        Of ``value`` (what the update gives) and of arguments of the update, by their names.
    start : float or str
        Before the first period; a word is that of the option that says it. NaN: nothing yet.
    """

    name: str
    next: Callable[..., X] = lambda value: value
    start: float | str = 0.0


class Surroundings(NamedTuple):
    """What the range of a source may depend on.

    Attributes
    ----------
    at : Interval
        All values of what it is taken of.
    pace : float
        The largest change of that per second.
    period : float
        s.
    every : int
        Periods of a set point.
    options : mapping of str to Setting
        Those that are given.
    """

    at: Interval
    pace: float
    period: float
    every: int
    options: Mapping[str, Setting]

    @property
    def width(self) -> float:
        """How wide the interval is."""
        return max(0.0, self.at.high - self.at.low)

    @property
    def largest(self) -> float:
        """The largest magnitude in it."""
        return max(abs(self.at.low), abs(self.at.high))


@dataclass(frozen=True, eq=False)
class SourceKind(Kind):
    """A source of signals.

    Attributes
    ----------
    of : str
        What it is taken of: a ``port`` of the plant, a ``signal``, the ``error`` of a port;
        ``call``: a rule base or a table, with its inputs in parentheses.
    options : dict of str to OptionKind
        What may stand after a comma.
    ports : tuple of str
        Which values of its port it reads: ``reference``, ``measured`` or both.
    states : tuple of SourceState
        What it remembers. Without an update it gives what it is taken of.
    rounded : bool
        Whether what it remembers is rounded as signals are.
    seconds : int
        The power of s that its unit has more than that of what it is taken of.
    difference : bool
        Whether its unit is that of a difference: K of °C.
    kept : str
        What keeps it small: ``signal``, what keeps its signal small, whose course it has;
        ``loop``, which works against errors and rates; ``text`` alone.
    bounds : callable or None
        From :class:`Surroundings` to the interval of its values. None: from its update, whose
        states are widened until they stay.
    pace : callable or None
        From :class:`Surroundings` to its largest change per second. None: not known.
    linear : bool
        Of a source with states: whether k times its signal gives k times its values.
    inverse_of : str
        The source that it takes back, ``rate`` of the integral.
    elsewhere : str
        Words that others have for it, with blanks between.
    dimensionless : bool
        Whether its values have no unit, whatever it is taken of.
    of_periods : callable or None
        Of a source that remembers as many values as an option has periods: from that number to its
        update and its states. The record itself has those of one period.
    """

    of: Literal["port", "signal", "error", "call"] = "signal"
    options: dict[str, OptionKind] = field(default_factory=dict)
    ports: tuple[str, ...] = ()
    states: tuple[SourceState, ...] = ()
    rounded: bool = False
    seconds: int = 0
    difference: bool = False
    kept: Literal["signal", "loop", "text"] = "text"
    bounds: Callable[[Surroundings], Interval] | None = None
    pace: Callable[[Surroundings], float] | None = None
    linear: bool = False
    inverse_of: str = ""
    elsewhere: str = ""
    dimensionless: bool = False
    of_periods: Callable[[int], tuple[Callable[..., X], tuple[SourceState, ...]]] | None = None

    @cached_property
    def symbols(self) -> tuple[str, ...]:
        """Arguments of the update: what it remembers, :data:`ALWAYS`, then the others."""
        functions = [update for update in (self.function, *(s.next for s in self.states)) if update]
        names = [*(state.name for state in self.states), *ALWAYS]
        names += (
            name for function in functions for name in argument_names(function) if name != VALUE
        )
        return tuple(dict.fromkeys(names))

    @cached_property
    def expression(self) -> Node:
        """What the update gives."""
        if self.function is None:
            raise TypeError(f"'{self.name}' has no update")
        return trace(self.function, argument_names(self.function))

    @cached_property
    def nexts(self) -> tuple[Node, ...]:
        """What each state is next: expressions over :data:`VALUE` and the arguments."""
        return tuple(trace(state.next, argument_names(state.next)) for state in self.states)

    @property
    def inputs(self) -> tuple[str, ...]:
        """Arguments of the update that are not states, in order."""
        return self.symbols[len(self.states) :]

    @property
    def windup(self) -> str:
        """The option that says what it does while its drive is at a limit; empty without."""
        return next((word for word, kind in self.options.items() if kind.takes == "windup"), "")

    @property
    def joined(self) -> str:
        """The words between its own and the name of what it is taken of."""
        if self.of == "port":
            return " of" if self.name == "error" else ""
        return {"signal": " of", "error": " of error of"}.get(self.of, "")

    def settings(self, options: Mapping[str, Setting]) -> dict[str, str | float]:
        """Return the arguments of the update that options say: numbers, or names of gains."""
        numbers: dict[str, str | float] = {}
        for word, kind in self.options.items():
            name, value = word.replace("-", "_"), options.get(word)
            if kind.takes == "range":
                # Without limits the update still has its arguments: they are infinite.
                ends = value if isinstance(value, tuple) else EVERYTHING
                numbers[f"{name}_low"], numbers[f"{name}_high"] = ends
            elif kind.takes == "windup":
                # An update is an expression of numbers: hold is -1, which no time can be; 0 is
                # none.
                numbers[name] = -1.0 if value == "hold" else _number(value)
            # The name of a gain, whose value the program puts in.
            elif isinstance(value, str):
                numbers[name] = value
            else:
                numbers[name] = _number(value)
        return numbers

    def sized(self, options: Mapping[str, Setting], period: float) -> SourceKind:
        """Return its record with as many states as an option has periods."""
        word = next((word for word, kind in self.options.items() if kind.periods), "")
        if self.of_periods is None or not word:
            return self
        return _sized(self, whole_periods(_number(options.get(word)), period))

    def starts(self, options: Mapping[str, Setting]) -> list[float]:
        """Return its states before the first period."""
        return [
            _number(options.get(state.start)) if isinstance(state.start, str) else state.start
            for state in self.states
        ]


MOST_PERIODS = 250
"""Values that a source remembers at most: each is a variable of an exported program."""


def whole_periods(time: float, period: float) -> int:
    """Return a time in whole control periods; a half counts up."""
    return math.floor(time / period + 0.5 + 1e-9)


@cache
def _sized(kind: SourceKind, count: int) -> SourceKind:
    if count > MOST_PERIODS:
        message = f"{kind.name} remembers {count:,} values; at most {MOST_PERIODS} are covered"
        raise KindError(message, kind.name)
    assert kind.of_periods is not None
    update, states = kind.of_periods(count)
    return replace(kind, function=update, states=states, of_periods=None)


class _Named:
    """A function whose arguments have names that are made."""

    def __init__(self, names: Sequence[str], function: Callable[..., X]) -> None:
        self.argument_names = tuple(names)
        self.function = function

    def __call__(self, *arguments: X) -> X:
        return self.function(*arguments)


def _number(value: Setting | None) -> float:
    return float(value) if isinstance(value, int | float) else 0.0


class SourceRegistry(Registry[SourceKind]):
    """All sources by their words; what is not among them is an error by name."""

    def __getitem__(self, name: str) -> SourceKind:
        if name not in self._kinds:
            raise KindError(f"no source of signals is called '{name}'", name)
        return self._kinds[name]

    def __contains__(self, name: object) -> bool:
        return name in self._kinds

    def of(self, *what: str) -> Iterator[SourceKind]:
        """Iterate over those that are taken of something."""
        return (kind for kind in self.values() if kind.of in what)


SOURCES = SourceRegistry("source")
"""Every source by its word."""


def source(name: str, update: Callable[..., X] | None = None, **facts: Any) -> SourceKind:
    """Register a source of signals.

    Parameters
    ----------
    name : str
        The word in a file.
    update : callable or None
        What it gives: of arguments by their names, written with arithmetic, comparisons and
        :mod:`fuzzyarm.op`. None: what it is taken of, or what a rule base or a table says.
    **facts
        What else is known of it, see :class:`SourceKind`.

    Returns
    -------
    SourceKind
        The record.

    Raises
    ------
    KindError
        If the name is taken or not a word, the update takes an argument that nothing gives, or
        one of your own is a ``call``: rule bases and tables are all that can be asked.
    """
    kind = SourceKind(name, (), update, **{"own": True, **facts})
    if kind.own and kind.of == "call":
        raise KindError(f"'{name}' is called with inputs, as only rules and table are", name)
    if kind.of in ("port", "error") and not kind.ports:
        raise KindError(
            f"'{name}' is taken of a port, and does not say which values it reads", name
        )
    # An update may use what the loop supplies, its options and its states.
    names = {*SUPPLIED, *kind.settings({}), *(state.name for state in kind.states)}
    if unknown := [symbol for symbol in kind.symbols if symbol not in names]:
        raise KindError(f"nothing gives the update of '{name}' its argument '{unknown[0]}'", name)
    return SOURCES.add(kind)


# ── what updates compute ─────────────────────────────────────────────────────────────


def _rate(x: X, before: X, slope: X, filter: X, period: X) -> X:  # noqa: A002
    """Return ``y + (d - y) Δ / (T + Δ)`` with the slope ``d = (x - before) / Δ``; 0 at first."""
    steep = op.where(unseen(before), 0.0, x - before) / period
    return slope + (steep - slope) * (period / (filter + period))


def _lag(x: X, lagged: X, time: X, period: X) -> X:
    """Return ``y + (x - y) Δ / (T + Δ)``, the implicit Euler step; x at first."""
    return op.where(unseen(lagged), x, lagged + (x - lagged) * period / (time + period))


def _integral(
    x: X, total: X, within_low: X, within_high: X, anti_windup: X, excess: X, gain: X, period: X
) -> X:
    """Return the integral of x, this period included.

    Where its drive was at a limit in the last period it holds, if x would drive on, or goes
    back by ``excess Δ / (T K)``: K is by how much the drive grows with the integral, so that the
    excess counts as what it is of the integral (Åström and Hägglund, *Advanced PID Control*, 3.5).
    """
    gained = op.where(~op.equal(gain, 0.0), excess / gain, 0.0)
    # In less than a period nothing goes back: it would swing.
    back = x * period + gained * period / op.maximum(anti_windup, period)
    increment = op.where((anti_windup < 0.0) & (gained * x < 0.0), 0.0, x * period)
    new = total + op.where(anti_windup > 0.0, back, increment)
    new = op.where(new > within_low, new, within_low)
    return op.where(new < within_high, new, within_high)


def _deadband(x: X, width: X) -> X:
    """Return 0 in the zone, outside by how much x has left it."""
    return op.maximum(x - 0.5 * width, 0.0) + op.minimum(x + 0.5 * width, 0.0)


def _hysteresis(x: X, held: X, width: X) -> X:
    """Return what it held, moved by x where that leaves the band around it."""
    return op.minimum(op.maximum(held, x - 0.5 * width), x + 0.5 * width)


def _delayed(count: int) -> tuple[Callable[..., X], tuple[SourceState, ...]]:
    """Return a row of values, each handed on once in a period; x where it has seen nothing yet."""
    names = [f"late{k + 1}" for k in range(count)]
    after = [_Named(["x", *before], _seen_or_x) for before in ([], *([name] for name in names))]
    # Each is next what the one before it is now: the first x, the value the last.
    *nexts, value = after
    states = tuple(
        SourceState(name, following, math.nan) for name, following in zip(names, nexts, strict=True)
    )
    return value, states


def _seen_or_x(x: X, *before: X) -> X:
    return op.where(unseen(before[0]), x, before[0]) if before else x


def _switched(x: X, on: X, width: X) -> X:
    """Return 1 above the band, 0 below it, and within it what it was."""
    return op.where(x > 0.5 * width, 1.0, op.where(x < -0.5 * width, 0.0, on))


def _relay(x: X, on: X, width: X, levels_low: X, levels_high: X) -> X:
    """Return one of two levels, by the side on which x has last left the band."""
    return op.where(_switched(x, on, width) > 0.5, levels_high, levels_low)


# ── the sources ──────────────────────────────────────────────────────────────────────

BOTH = ("reference", "measured")
WIDTH = {
    "width": OptionKind(
        "number", "full width: half of it to each side", needed=True, positive=True, alike=True
    )
}


def _symmetric(size: float) -> Interval:
    return Interval(-size, size)


def _levels(options: Mapping[str, Setting]) -> Interval:
    levels = options.get("levels")
    return Interval(*levels) if isinstance(levels, tuple) else EVERYTHING


def _of_integral(near: Surroundings) -> Interval:
    """Return the range of an integral: its bounds, with its start where that is outside."""
    within = near.options.get("within")
    ends = [*(within if isinstance(within, tuple) else EVERYTHING)]
    if "start" in near.options:
        ends.append(_number(near.options["start"]))
    return Interval(min(ends), max(ends))


def _of_sum(near: Surroundings) -> Interval:
    """Return the range of a sum: without end, or that of the periods of one set point."""
    if "cleared" not in near.options:
        return EVERYTHING
    return Interval(min(0.0, near.at.low * near.every), max(0.0, near.at.high * near.every))


def _register() -> None:
    """Register the built-in sources, in the order in which they are listed."""

    def kind(name: str, update: Callable[..., X] | None = None, **facts: Any) -> None:
        source(name, update, own=False, **facts)

    weight = OptionKind("number", "share of the reference that counts (set-point weight)")
    kind(
        "error",
        of="port",
        ports=BOTH,
        doc="reference minus measured value of a port",
        options={"weight": weight},
        difference=True,
        kept="loop",
        elsewhere="err deviation",
    )
    kind(
        "reference",
        of="port",
        ports=("reference",),
        doc="what a port is to be",
        elsewhere="setpoint set-point target desired demand ref",
    )
    kind(
        "measured",
        of="port",
        ports=("measured",),
        doc="what a port is",
        elsewhere="measurement measure actual feedback meas sensor",
    )
    low_pass = OptionKind("time", "time constant of a first-order low-pass after it")
    kind(
        "rate",
        _rate,
        doc="change of a signal per second; 0 in the first period",
        options={"filter": low_pass},
        states=(SourceState("before", lambda x: x, math.nan), SourceState("slope")),
        seconds=-1,
        difference=True,
        kept="loop",
        bounds=lambda near: _symmetric(near.pace),
        linear=True,
        elsewhere="derivative deriv der diff differential differentiate ddt slope velocity_of",
    )
    kind(
        "change",
        lambda x, before: op.where(unseen(before), 0.0, x - before),
        doc="change of a signal since the last period; 0 at first",
        states=(SourceState("before", lambda x: x, math.nan),),
        difference=True,
        kept="loop",
        bounds=lambda near: _symmetric(min(near.width, near.pace * near.period)),
        linear=True,
        elsewhere="delta increment difference",
    )
    kind(
        "integral",
        _integral,
        doc="sum of a signal times the period, that of this period included",
        options={
            "within": OptionKind("range", "bounds of the integral"),
            "anti-windup": OptionKind(
                "windup", "what it does while its drive is at a limit: hold, or go back in a time"
            ),
            "start": OptionKind("figure", "its value before the first period"),
        },
        states=(SourceState("total", start="start"),),
        seconds=1,
        bounds=_of_integral,
        pace=lambda near: near.largest,
        linear=True,
        inverse_of="rate",
        elsewhere="integrate integration int integrator cumsum",
    )
    kind(
        "sum",
        lambda x, total: total + x,
        of="error",
        ports=BOTH,
        doc="sum of the errors of a port, without the period",
        options={
            "cleared": OptionKind("words", "begin again at each set point", ("each", "set-point"))
        },
        states=(
            SourceState(
                "total", lambda value, cleared, last: op.where((cleared > 0.0) & last, 0.0, value)
            ),
        ),
        rounded=True,
        kept="loop",
        bounds=_of_sum,
        linear=True,
    )
    kind(
        "lag",
        _lag,
        doc="first-order low-pass of a signal; begins at its first value",
        options={"time": OptionKind("time", "its time constant", needed=True)},
        states=(SourceState("lagged", start=math.nan),),
        kept="signal",
        bounds=lambda near: near.at,
        pace=lambda near: near.pace,
        linear=True,
        elsewhere="lowpass low-pass filter pt1 lag1 smooth",
    )
    kind(
        "deadband",
        _deadband,
        doc="0 while a signal is within ± half the width, outside by how much it has left that",
        options=WIDTH,
        kept="signal",
        pace=lambda near: near.pace,
        elsewhere="deadzone dead-zone dead_zone dead-band dead_band",
    )
    kind(
        "hysteresis",
        _hysteresis,
        doc="play: stays while a signal is within ± half the width around it; begins at 0",
        options=WIDTH,
        states=(SourceState("held"),),
        kept="signal",
        pace=lambda near: near.pace,
        elsewhere="backlash play",
    )
    handed_on, late = _delayed(1)
    kind(
        "delayed",
        handed_on,
        doc="a signal some control periods ago; begins at its first value",
        options={"time": OptionKind("time", "how long ago", needed=True, periods=True)},
        states=late,
        of_periods=_delayed,
        kept="signal",
        bounds=lambda near: near.at,
        pace=lambda near: near.pace,
        linear=True,
        elsewhere="delay dead-time deadtime transport-delay z-1 previous",
    )
    kind(
        "relay",
        _relay,
        doc="switch with hysteresis: its high level once a signal is above half the width, its low"
        " one once it is below minus that; begins low",
        options={
            **WIDTH,
            "levels": OptionKind("range", "its values: low and high", needed=True),
        },
        states=(SourceState("on", _switched),),
        dimensionless=True,
        bounds=lambda near: _levels(near.options),
        elsewhere="switch bang-bang on-off two-point thermostat",
    )
    kind("rules", of="call", doc="what a rule base concludes; one signal for each output")
    kind("table", of="call", doc="the value of a lookup table")


_register()
