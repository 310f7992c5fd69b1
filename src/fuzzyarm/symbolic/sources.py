"""Sources of a controller's signals: one record each, the single definition of a source.

``NAME = deadband of e, width 0.5`` is one record: its word and options, its states, its update as
one expression, its unit and its range. The reader, completion and help, the kernel, ranges,
proofs, describing functions, diagrams, C and Structured Text all read that record. Add
one only if a textbook structure uses it.

To add a source
---------------
1. Write its update as a function of the arguments below, with arithmetic, comparisons and
   :mod:`fuzzyarm.op`, no ``if``: the value of this period. Each state is a
   :class:`SourceState`: a name, its next value (a function of ``value`` and of the arguments), and
   its start.
2. Add one ``kind(…)`` to `_register`, or call :func:`source` from a program of your own.
3. Add its line to the table of ``docs/reference/controllers.md``, and the same in plain Python to
   ``ORACLES`` of ``tests/controller/test_texts.py``.
4. Run ``pytest --update-golden tests/lsp`` for the grammar of the editor, then ``pytest
   tests/controller/test_texts.py tests/controller/test_sources.py``: the second takes every record
   through the language, both kinds of loop, what it states of range, pace, linearity and unit,
   proofs, describing functions, diagrams and exports.

Without ``bounds`` the range follows from the update. A proof encloses the update, or refuses it
by the name of the operation that it cannot enclose.

The arguments of an update are found by their names:

================  ==============================================================================
``x``             the operand: a signal, or the error of a port
``period``        the control period, s
``last``          true in the last period of a set point
``excess``        change that the limits of its drive made in the last period
``gain``          sensitivity of that drive to the source's value
a state           its stored value; NaN before the first period if that is its start
an option         by its word: a number or a time (0 if absent), 1 or 0 for words;
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

from fuzzyarm.base.numbers import whole_periods
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.nodes import Node, argument_names, trace
from fuzzyarm.symbolic.operations import EVERYTHING, Interval
from fuzzyarm.symbolic.records import Kind, KindError, Registry

X = Any
"""An expression or a number."""


@dataclass(frozen=True)
class Condition:
    """A comparison of two operands, or a combination of conditions.

    Parameters
    ----------
    word : str
        ``<``, ``<=``, ``>``, ``>=``; ``and``, ``or``, ``not``.
    parts : tuple
        Of a comparison two operands: signals, gains or numbers; else conditions.
    """

    word: str
    parts: tuple[Condition | str | float, ...]

    def operands(self) -> Iterator[str | float]:
        """Yield the operands, in the order of the text."""
        for part in self.parts:
            if isinstance(part, Condition):
                yield from part.operands()
            else:
                yield part

    @property
    def form(self) -> Condition:
        """The condition without names of operands: its update is of this form."""
        parts = (part.form if isinstance(part, Condition) else "" for part in self.parts)
        return Condition(self.word, tuple(parts))

    def over(self, operands: Iterator[X]) -> X:
        """Return it as an expression over its operands."""
        parts = [
            part.over(operands) if isinstance(part, Condition) else next(operands)
            for part in self.parts
        ]
        return CONDITIONS[self.word](*parts)


CONDITIONS: dict[str, Callable[..., X]] = {
    "<": lambda a, b: a < b,
    "<=": lambda a, b: a <= b,
    ">": lambda a, b: a > b,
    ">=": lambda a, b: a >= b,
    "and": lambda a, b: a & b,
    "or": lambda a, b: a | b,
    "not": lambda a: ~a,
}
"""Words of conditions."""


@dataclass(frozen=True)
class Chosen:
    """A value that counts while a condition holds, or while it does not.

    Parameters
    ----------
    value : str or float
        A signal, a gain or a number.
    condition : Condition
        When.
    """

    value: str | float
    condition: Condition

    def names(self) -> Iterator[str]:
        """Yield the signals and gains in it."""
        every = (self.value, *self.condition.operands())
        return (value for value in every if isinstance(value, str))


Setting = str | float | tuple[float, float] | bool | Chosen
"""The value of an option: a number or the name of a gain; s; a pair; true; ``"hold"`` or s; a
signal with its condition."""

VALUE = "value"
"""Symbol of the update's value in the next-state functions."""

ALWAYS = ("x", "period")
"""Arguments of every update, used or not."""

SUPPLIED = (*ALWAYS, "last", "excess", "gain")
"""Arguments of updates that the control loop supplies."""


def argument_of(option: str) -> str:
    """Return the argument of an update that an option sets."""
    return option.replace("-", "_")


def unseen(state: X) -> X:
    """Return the condition that a state still has NaN, its start."""
    return ~op.equal(state, state)


class OptionKind(NamedTuple):
    """The definition of an option: a word after a comma, its value and its meaning.

    Attributes
    ----------
    accepts : str
        ``number`` (or the name of a gain), ``figure`` (a number), ``time`` (with a unit),
        ``range`` (``A .. B``), ``words`` (only the words in `rest`), ``windup``: ``hold``, or
        ``back TIME``; or ``chosen``: a signal, ``where``, and a condition.
    doc : str
        One line.
    rest : tuple of str
        Words that follow it.
    needed : bool
        Whether it is mandatory.
    positive : bool
        Whether its number must be above 0.
    alike : bool
        Whether it has the unit of the operand.
    periods : bool
        Whether its time must be a whole number of control periods, at most `MOST_PERIODS`.
    """

    accepts: Literal["number", "figure", "time", "range", "words", "windup", "chosen"]
    doc: str
    rest: tuple[str, ...] = ()
    needed: bool = False
    positive: bool = False
    alike: bool = False
    periods: bool = False

    @property
    def example(self) -> str:
        """An example of the text after the word."""
        texts = {"time": "10 ms", "range": "-1 .. 1", "windup": "hold", "chosen": "e where e < 0.5"}
        return " ".join(self.rest) or texts.get(self.accepts, "0.5")


class SourceState(NamedTuple):
    """A state of a source, kept from one period to the next.

    Attributes
    ----------
    name : str
        Argument of the update; in exported programs the suffix of the signal's name.
    next : callable
        Function of ``value`` (the update's) and of arguments of the update, by their names.
    start : float or str
        Before the first period: a number, or the option that sets it. NaN: no value yet.
    """

    name: str
    next: Callable[..., X] = lambda value: value
    start: float | str = 0.0


class Surroundings(NamedTuple):
    """The quantities on which the range of a source may depend.

    Attributes
    ----------
    at : Interval
        Range of the operand.
    pace : float
        Largest rate of the operand, per second.
    period : float
        Control period, s.
    every : int
        Control periods of a set point.
    options : mapping of str to Setting
        Options in the text.
    """

    at: Interval
    pace: float
    period: float
    every: int
    options: Mapping[str, Setting]

    @property
    def width(self) -> float:
        """The width of the operand's range."""
        return max(0.0, self.at.high - self.at.low)

    @property
    def largest(self) -> float:
        """The largest magnitude of the operand."""
        return max(abs(self.at.low), abs(self.at.high))


@dataclass(frozen=True, eq=False)
class SourceKind(Kind):
    """A source of signals.

    Attributes
    ----------
    of : str
        Kind of operand: a ``port`` of the plant, a ``signal``, the ``error`` of a port;
        ``call``: a rule base or a table with inputs in parentheses.
    options : dict of str to OptionKind
        Options by the word after the comma.
    ports : tuple of str
        Values of the port that it reads: ``reference``, ``measured`` or both; or ``driven``.
    states : tuple of SourceState
        Its states. Without an update its value is the operand's.
    rounded : bool
        Whether its states are rounded as signals are.
    seconds : int
        Exponent of s by which its unit differs from the operand's.
    difference : bool
        Whether its unit is that of a difference: K of °C.
    bounded_by : str
        What keeps it bounded: ``signal``, whatever bounds the operand, whose course it has;
        ``loop``, the feedback, which works against errors and rates; ``text``, limits in the text.
    bounds : callable or None
        From :class:`Surroundings` to the range. None: computed from the update, with the states
        widened to a fixed point.
    pace : callable or None
        From :class:`Surroundings` to the largest rate, per second. None: unknown.
    linear : bool
        With states: whether scaling the operand by k scales the source by k.
    inverse_of : str
        The source that it undoes: ``rate`` for the integral.
    elsewhere : str
        Synonyms in other programs, separated by blanks.
    dimensionless : bool
        Whether it has no unit, whatever the operand's.
    of_periods : callable or None
        With one state for each period of an option: from that number to update and states. The
        record itself has those of one period.
    plainly : callable or None
        Its update without options, which needs the first of its states alone.
    conditional : callable or None
        Its update with an option that has a condition, which is its argument ``chosen``.
    """

    of: Literal["port", "signal", "error", "call"] = "signal"
    options: dict[str, OptionKind] = field(default_factory=dict)
    ports: tuple[str, ...] = ()
    states: tuple[SourceState, ...] = ()
    rounded: bool = False
    seconds: int = 0
    difference: bool = False
    bounded_by: Literal["signal", "loop", "text"] = "text"
    bounds: Callable[[Surroundings], Interval] | None = None
    pace: Callable[[Surroundings], float] | None = None
    linear: bool = False
    inverse_of: str = ""
    elsewhere: str = ""
    dimensionless: bool = False
    of_periods: Callable[[int], tuple[Callable[..., X], tuple[SourceState, ...]]] | None = None
    plainly: Callable[..., X] | None = None
    conditional: Callable[..., X] | None = None

    @cached_property
    def symbols(self) -> tuple[str, ...]:
        """Arguments of the update: states, :data:`ALWAYS`, then the others."""
        functions = [update for update in (self.function, *(s.next for s in self.states)) if update]
        names = [*(state.name for state in self.states), *ALWAYS]
        names += (
            name for function in functions for name in argument_names(function) if name != VALUE
        )
        return tuple(dict.fromkeys(names))

    @cached_property
    def expression(self) -> Node:
        """The update, as an expression."""
        if self.function is None:
            raise TypeError(f"'{self.name}' has no update")
        return trace(self.function, argument_names(self.function))

    @cached_property
    def nexts(self) -> tuple[Node, ...]:
        """The next value of each state, over :data:`VALUE` and the arguments."""
        return tuple(trace(state.next, argument_names(state.next)) for state in self.states)

    @property
    def inputs(self) -> tuple[str, ...]:
        """Arguments of the update that are not states, in order."""
        return self.symbols[len(self.states) :]

    @property
    def windup(self) -> str:
        """The option for a drive at its limit (anti-windup); empty if there is none."""
        return next((word for word, kind in self.options.items() if kind.accepts == "windup"), "")

    @property
    def joined(self) -> str:
        """The words between its own and the operand's name."""
        if self.of == "port":
            return " of" if self.name == "error" else ""
        return {"signal": " of", "error": " of error of"}.get(self.of, "")

    def settings(self, options: Mapping[str, Setting]) -> dict[str, str | float]:
        """Return the arguments that options set: numbers, or names of gains."""
        numbers: dict[str, str | float] = {}
        for word, kind in self.options.items():
            name, value = argument_of(word), options.get(word)
            if kind.accepts == "range":
                # Without limits the update still needs both arguments: they are infinite.
                ends = value if isinstance(value, tuple) else EVERYTHING
                numbers[f"{name}_low"], numbers[f"{name}_high"] = ends
            elif kind.accepts == "windup":
                # An update computes with numbers alone: hold is -1, no valid time; 0 is no
                # anti-windup.
                numbers[name] = -1.0 if value == "hold" else _number(value)
            elif isinstance(value, Chosen):
                numbers[name] = value.value
                for number, operand in enumerate(value.condition.operands()):
                    numbers[_operand(number)] = operand
            # The name of a gain; the program replaces it by the value.
            elif isinstance(value, str):
                numbers[name] = value
            else:
                numbers[name] = _number(value)
        return numbers

    def chosen(self, options: Mapping[str, Setting]) -> SourceKind:
        """Return the record with the condition of an option, if it has one."""
        forms = [value.condition.form for value in options.values() if isinstance(value, Chosen)]
        return _conditional(self, forms[0]) if forms else self

    def sized(self, options: Mapping[str, Setting], period: float) -> SourceKind:
        """Return the record with the states that its options need.

        One for each period of an option that counts them; without options maybe fewer.
        """
        if self.plainly is not None and not any(word in self.options for word in options):
            return _plain(self)
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
"""Largest number of states of a source: each is a variable of an exported program."""


@cache
def _plain(kind: SourceKind) -> SourceKind:
    states = kind.states[:1]
    return replace(kind, function=kind.plainly, states=states, options={}, plainly=None)


@cache
def _sized(kind: SourceKind, count: int) -> SourceKind:
    if count > MOST_PERIODS:
        message = f"{kind.name} remembers {count:,} values; at most {MOST_PERIODS} are covered"
        raise KindError(message, kind.name)
    assert kind.of_periods is not None
    update, states = kind.of_periods(count)
    return replace(kind, function=update, states=states, of_periods=None)


def _operand(number: int) -> str:
    return f"operand{number + 1}"


@cache
def _conditional(kind: SourceKind, form: Condition) -> SourceKind:
    assert kind.conditional is not None
    update = kind.conditional
    own = argument_names(update)
    operands = [_operand(number) for number, _ in enumerate(form.operands())]
    names = [*(name for name in own if name != "chosen"), *operands]

    def with_condition(*arguments: X) -> X:
        values = dict(zip(names, arguments, strict=True))
        values["chosen"] = form.over(values[name] for name in operands)
        return update(*(values[name] for name in own))

    return replace(
        kind, function=_Named(names, with_condition), conditional=None, linear=False, pace=None,
        inverse_of="",
    )  # fmt: skip


class _Named:
    """A function with argument names made at run time."""

    def __init__(self, names: Sequence[str], function: Callable[..., X]) -> None:
        self.argument_names = tuple(names)
        self.function = function

    def __call__(self, *arguments: X) -> X:
        return self.function(*arguments)


def _number(value: Setting | None) -> float:
    return float(value) if isinstance(value, int | float) else 0.0


class SourceRegistry(Registry[SourceKind]):
    """All sources by their words; an unknown word raises `KindError`."""

    def __getitem__(self, name: str) -> SourceKind:
        if name not in self._kinds:
            raise KindError(f"no source of signals is called '{name}'", name)
        return self._kinds[name]

    def __contains__(self, name: object) -> bool:
        return name in self._kinds

    def of(self, *what: str) -> Iterator[SourceKind]:
        """Iterate over the sources with operands of these kinds."""
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
        Its value as a function of arguments found by their names, with arithmetic, comparisons
        and :mod:`fuzzyarm.op`. None: the operand, or the value of a rule base or a table.
    **facts
        Further fields of :class:`SourceKind`.

    Returns
    -------
    SourceKind
        The record.

    Raises
    ------
    KindError
        If the name is taken or not a word, an argument of the update is unknown, or `of` is
        ``call``, which only rule bases and tables are.
    """
    kind = SourceKind(name, (), update, **{"own": True, **facts})
    if kind.own and kind.of == "call":
        raise KindError(f"'{name}' is called with inputs, as only rules and table are", name)
    if kind.of in ("port", "error") and not kind.ports:
        raise KindError(f"'{name}' reads a port, but does not name its values", name)
    # Known arguments: those of the loop, the options and the states.
    names = {*SUPPLIED, *kind.settings({}), *(state.name for state in kind.states)}
    if unknown := [symbol for symbol in kind.symbols if symbol not in names]:
        raise KindError(f"nothing gives the update of '{name}' its argument '{unknown[0]}'", name)
    return SOURCES.add(kind)


# ── updates ──────────────────────────────────────────────────────────────────────────


def _slope(x: X, before: X, period: X) -> X:
    """Return the slope ``(x - before) / Δ``; 0 at first."""
    return op.where(unseen(before), 0.0, x - before) / period


def _rate(x: X, before: X, slope: X, filter: X, period: X) -> X:  # noqa: A002
    """Return ``y + (d - y) Δ / (T + Δ)`` with the slope ``d = (x - before) / Δ``; 0 at first."""
    steep = _slope(x, before, period)
    return slope + (steep - slope) * (period / (filter + period))


def _lag(x: X, lagged: X, time: X, period: X) -> X:
    """Return ``y + (x - y) Δ / (T + Δ)``, the implicit Euler step; x at first."""
    return op.where(unseen(lagged), x, lagged + (x - lagged) * period / (time + period))


def _integral(
    x: X, total: X, within_low: X, within_high: X, anti_windup: X, excess: X, gain: X, period: X
) -> X:
    """Return the integral of x, this period included.

    At a limit of its drive in the last period it holds where x drives further, or goes back by
    ``excess Δ / (T K)``: `gain` K turns the excess of the drive into one of the integral
    (back-calculation, Åström and Hägglund, *Advanced PID Control*, 3.5).
    """
    gained = op.where(~op.equal(gain, 0.0), excess / gain, 0.0)
    # A tracking time below one period would overshoot and oscillate.
    back = x * period + gained * period / op.maximum(anti_windup, period)
    increment = op.where((anti_windup < 0.0) & (gained * x < 0.0), 0.0, x * period)
    new = total + op.where(anti_windup > 0.0, back, increment)
    new = op.where(new > within_low, new, within_low)
    return op.where(new < within_high, new, within_high)


def _following(*arguments: X) -> X:
    """Return the followed signal, clamped, while chosen; else the integral."""
    *own, follows, chosen = arguments
    _, _, low, high, *_ = own
    followed = op.where(follows > low, follows, low)
    return op.where(chosen, op.where(followed < high, followed, high), _integral(*own))


def _deadband(x: X, width: X) -> X:
    """Return 0 inside the zone, the distance to it outside."""
    return op.maximum(x - 0.5 * width, 0.0) + op.minimum(x + 0.5 * width, 0.0)


def _hysteresis(x: X, held: X, width: X) -> X:
    """Return the held value, pushed along by x at the edges of the band (play operator)."""
    return op.minimum(op.maximum(held, x - 0.5 * width), x + 0.5 * width)


def _delayed(count: int) -> tuple[Callable[..., X], tuple[SourceState, ...]]:
    """Return a shift register of `count` periods; an empty stage gives x."""
    names = [f"late{k + 1}" for k in range(count)]
    after = [_Named(["x", *before], _seen_or_x) for before in ([], *([name] for name in names))]
    # Stage k takes the present value of stage k - 1, the first one x; the last is the output.
    *nexts, value = after
    states = tuple(
        SourceState(name, following, math.nan) for name, following in zip(names, nexts, strict=True)
    )
    return value, states


def _seen_or_x(x: X, *before: X) -> X:
    return op.where(unseen(before[0]), x, before[0]) if before else x


def _switched(x: X, on: X, width: X) -> X:
    """Return 1 above the band, 0 below it, the old value inside (Schmitt trigger)."""
    return op.where(x > 0.5 * width, 1.0, op.where(x < -0.5 * width, 0.0, on))


def _relay(x: X, on: X, width: X, levels_low: X, levels_high: X) -> X:
    """Return the level of the side on which x last left the band."""
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
    """Return the range of an integral: its bounds, and its start if outside."""
    within = near.options.get("within")
    ends = [*(within if isinstance(within, tuple) else EVERYTHING)]
    if "start" in near.options:
        ends.append(_number(near.options["start"]))
    return Interval(min(ends), max(ends))


def _of_sum(near: Surroundings) -> Interval:
    """Return the range of a sum: unbounded, or that of the periods of one set point."""
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
        bounded_by="loop",
        elsewhere="err deviation",
    )
    kind(
        "reference",
        of="port",
        ports=("reference",),
        doc="set point of a port",
        elsewhere="setpoint set-point target desired demand ref",
    )
    kind(
        "measured",
        of="port",
        ports=("measured",),
        doc="measured value of a port",
        elsewhere="measurement measure actual feedback meas sensor",
    )
    kind(
        "driven",
        of="port",
        ports=("driven",),
        doc="value last sent to a port by this axis",
        elsewhere="sent output_before last_output",
    )
    low_pass = OptionKind("time", "time constant of a first-order low-pass after it")
    kind(
        "rate",
        _rate,
        plainly=_slope,
        doc="change of a signal per second; 0 in the first period",
        options={"filter": low_pass},
        states=(SourceState("before", lambda x: x, math.nan), SourceState("slope")),
        seconds=-1,
        difference=True,
        bounded_by="loop",
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
        bounded_by="loop",
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
                "windup", "while its drive is at a limit: hold, or go back with a time constant"
            ),
            "start": OptionKind("figure", "its value before the first period"),
            "follows": OptionKind("chosen", "a signal that it is while a condition holds"),
        },
        conditional=_Named([*argument_names(_integral), "follows", "chosen"], _following),
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
        bounded_by="loop",
        bounds=_of_sum,
        linear=True,
    )
    kind(
        "lag",
        _lag,
        doc="first-order low-pass of a signal; begins at its first value",
        options={"time": OptionKind("time", "its time constant", needed=True)},
        states=(SourceState("lagged", start=math.nan),),
        bounded_by="signal",
        bounds=lambda near: near.at,
        pace=lambda near: near.pace,
        linear=True,
        elsewhere="lowpass low-pass filter pt1 lag1 smooth",
    )
    kind(
        "deadband",
        _deadband,
        doc="0 within ± half the width, outside that the signal's distance from it",
        options=WIDTH,
        bounded_by="signal",
        pace=lambda near: near.pace,
        elsewhere="deadzone dead-zone dead_zone dead-band dead_band",
    )
    kind(
        "hysteresis",
        _hysteresis,
        doc="play: stays while a signal is within ± half the width around it; begins at 0",
        options=WIDTH,
        states=(SourceState("held"),),
        bounded_by="signal",
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
        bounded_by="signal",
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
    kind("rules", of="call", doc="outputs of a rule base; one signal for each output")
    kind("table", of="call", doc="the value of a lookup table")


_register()

CHOICE = SourceKind(
    "where",
    (),
    None,
    doc="a signal while a condition holds, else another one",
    options={"otherwise": OptionKind("chosen", "the other one", needed=True, alike=True)},
    conditional=lambda x, otherwise, chosen: op.where(chosen, x, otherwise),
)
"""``A where CONDITION else B``: the one source that does not begin with its word."""
