"""The meaning of a controller as text: uses, gains, signals and drives. Plain frozen data.

A controller is a list of definitions, evaluated once in each control period for each of its
axes, in the order of the text. The possible sources of a signal are the table :data:`SOURCES`
(:mod:`fuzzyarm.symbolic.sources`); the reader, the checks, the kernel and the exported program
know no other.

The records are the nodes of the syntax tree as well: names and numbers of a text carry their
position (:mod:`fuzzyarm.base.diagnostic`), which equality ignores.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from fuzzyarm.base.diagnostic import NOWHERE, Figure, Span, Word
from fuzzyarm.base.numbers import TIMES
from fuzzyarm.base.shown import one_line
from fuzzyarm.base.value_kinds import CONTROLLER, OfKind
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.symbolic.sources import (
    CHOICE,
    SOURCES,
    Chosen,
    Setting,
    SourceKind,
)


class Time(float):
    """A time, s; from a text with its number and unit."""

    __slots__ = ("figure", "unit")

    figure: Figure
    unit: str

    def __new__(cls, figure: Figure, unit: str) -> Time:
        """Return the time of a number with a unit."""
        number, of_a_second = TIMES[unit]
        time = super().__new__(cls, float(figure) * number / of_a_second)
        time.figure, time.unit = figure, unit
        return time

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.figure, self.unit)


# --- Numbers by name ---


@dataclass(frozen=True, slots=True)
class Amount:
    """A number as written: numbers and π between ``*`` and ``/``.

    Parameters
    ----------
    factors : tuple of (float or None, bool)
        From left to right; None is π, true marks a divisor.
    """

    factors: tuple[tuple[float | None, bool], ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)

    @classmethod
    def of(cls, number: float) -> Amount:
        """Return a number without factors."""
        return cls(((float(number), False),))

    def value(self, pi: float) -> float:
        """Return the number, with the value of π in a run."""
        (first, _), *rest = self.factors
        value = pi if first is None else first
        for number, divides in rest:
            factor = pi if number is None else number
            value = value / factor if divides else value * factor
        return value


class Tune(NamedTuple):
    """The range of a gain in tuning, and whether its scale is logarithmic."""

    low: float
    high: float
    log: bool = False


@dataclass(frozen=True, slots=True)
class GainModel:
    """``gain NAME = VALUE "unit"``: one number for all axes, or one for each.

    Parameters
    ----------
    name : str
        Name of the gain.
    values : tuple of Amount
        One, or one for each axis.
    unit : str
        May be empty.
    tune : Tune or None
        Low, high, and whether in steps of the logarithm.
    """

    name: str
    values: tuple[Amount, ...]
    unit: str = ""
    tune: Tune | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Use:
    """``use NAME from "FILE"``: a rule base or a table, for all axes or one for each.

    Attributes
    ----------
    name : str
        In the lines of the controller.
    files : tuple of str
        One for all axes, or one for each.
    """

    name: str
    files: tuple[str, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Partner:
    """``partner NAME = LAW``: a law of the catalogue, with some of its gains set.

    Attributes
    ----------
    name : str
        Its name in the lines of the controller.
    law : str
        Its name in the catalogue.
    gains : tuple of (str, float)
        The gains with a value of their own.
    """

    name: str
    law: str
    gains: tuple[tuple[str, float], ...] = ()
    span: Span = field(default=NOWHERE, compare=False, repr=False)


# --- The lines of an axis ---


class AxisSignal(Word):
    """``AXIS.NAME``: a signal of an axis further up."""

    __slots__ = ("axis", "signal")

    axis: Word
    signal: Word

    @classmethod
    def of(cls, axis: Word, signal: Word) -> AxisSignal:
        """Return the name of a signal of an axis."""
        name = cls(f"{axis}.{signal}", axis.span.to(signal.span))
        name.axis, name.signal = axis, signal
        return name

    def __reduce__(self) -> tuple[Any, ...]:
        return AxisSignal.of, (self.axis, self.signal)


class Factor(NamedTuple):
    """A signal, a gain or a partner by name, or a number; and whether it divides.

    `partner` is true if that word precedes the name.
    """

    value: str | float
    divides: bool = False
    partner: bool = False


class Product(NamedTuple):
    """Factors from left to right; subtracted if `negative`."""

    factors: tuple[Factor, ...]
    negative: bool = False

    def value(self, gains: Mapping[str, float]) -> float:
        """Return the product of numbers and gains; NaN for a divisor of 0."""
        value = -1.0 if self.negative else 1.0
        for factor in self.factors:
            number = gains[factor.value] if isinstance(factor.value, str) else factor.value
            if not factor.divides:
                value *= number
            else:
                value = value / number if number else math.nan
        return value


@dataclass(frozen=True, slots=True)
class Source:
    """The source of a signal.

    Parameters
    ----------
    kind : str
        A key of :data:`SOURCES`.
    name : str
        The port, the signal, the rule base or the table.
    inputs : tuple of str
        Signals of a call, in the order of the text.
    options : dict
        By their words: a number or the name of a gain; s; a pair; true; ``"hold"`` or s.
    """

    kind: str
    name: str
    inputs: tuple[str, ...] = ()
    options: tuple[tuple[str, Setting], ...] = ()

    @property
    def record(self) -> SourceKind:
        """The record of its kind, with its condition; KindError if it is unknown."""
        kind = CHOICE if self.kind == CHOICE.name else SOURCES[self.kind]
        return kind.chosen(dict(self.options))

    def sized(self, period: float) -> SourceKind:
        """Return the record of its kind, with as many states as its options have periods."""
        return self.record.sized(dict(self.options), period)

    def option(self, word: str) -> Setting | None:
        """Return an option; None without it."""
        return dict(self.options).get(word)

    def gains(self) -> Iterator[str]:
        """Yield the gains that its options name."""
        kinds = self.record.options
        for word, value in self.options:
            if isinstance(value, str) and word in kinds and kinds[word].accepts == "number":
                yield value

    def chosen_names(self) -> Iterator[str]:
        """Yield the signals and gains of its conditional options, conditions included."""
        for _, value in self.options:
            if isinstance(value, Chosen):
                yield from value.names()


@dataclass(frozen=True, slots=True)
class SignalLine:
    """``NAME = SOURCE * FACTOR …``, or a sum of products.

    Each signal is stored once, in the precision of the run. `names` has several entries for a rule
    base with several outputs. With a source there is one product: its factors.
    """

    names: tuple[str, ...]
    source: Source | None
    products: tuple[Product, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)

    def reads(self) -> Iterator[str]:
        """Yield the signals, gains and partners in its definition."""
        yield from _names_in(self.products)
        if self.source is not None:
            yield from self.source.inputs
            yield from self.source.chosen_names()
            if self.source.record.of == "signal":
                yield self.source.name


@dataclass(frozen=True, slots=True)
class Zoom:
    """``zoom e, ce by 2 inside 3 [, edge wait]``: signals magnified while all are small."""

    signals: tuple[str, ...]
    by: str | float
    inside: str | float
    wait: bool = False
    span: Span = field(default=NOWHERE, compare=False, repr=False)

    def reads(self) -> Iterator[str]:
        """Yield its signals and gains."""
        yield from self.signals
        yield from (value for value in (self.by, self.inside) if isinstance(value, str))


@dataclass(frozen=True, slots=True)
class Learn:
    """``learn F by P(e, ce), delay 1, rate 1, bound 6``: a table that corrects itself.

    The cell of F used `delay` periods ago is changed by `rate` times the value of the performance
    table P now, and kept within ± `bound`.

    Parameters
    ----------
    table, judge : str
        The table that learns, the performance table.
    inputs : tuple of str
        Inputs of the performance table.
    options : tuple of (str, float or str)
        As written: ``delay``, periods; ``rate`` and ``bound``, numbers or names of gains.
    """

    table: str
    judge: str
    inputs: tuple[str, ...]
    options: tuple[tuple[str, Setting], ...] = ()
    span: Span = field(default=NOWHERE, compare=False, repr=False)

    def reads(self) -> Iterator[str]:
        """Yield the signals read by the performance table."""
        yield from self.inputs

    @property
    def delay(self) -> int:
        """Delay of the correction in periods."""
        return int(float(self._option("delay", 1.0)))

    @property
    def rate(self) -> str | float:
        """Factor of the performance value, or the gain with it."""
        return self._option("rate", 1.0)

    @property
    def bound(self) -> str | float:
        """The largest magnitude of a cell, or the gain with it."""
        return self._option("bound", 6.0)

    def _option(self, word: str, usual: float) -> str | float:
        value = dict(self.options).get(word, usual)
        return value if isinstance(value, str | float) else usual


EVENTS = {
    "nan": "a value that is not a number",
    "leaving": "a state outside the region of a guard",
}
"""Events in which a drive sends another value than its sum: ``on EVENT N|hold``."""

HOLD = "hold"
"""The value of a drive on an event: its last one."""


@dataclass(frozen=True, slots=True)
class Drive:
    """``drive PORT = SUM [, within A .. B] [, slew N] [, on EVENT N|hold]``.

    Drives of a port add up. First the limits apply, then the rate of change, per second. `on_nan`
    is the value of the port in a skipped period, `on_leaving` that after a guard of exported C has
    refused a state.
    """

    port: str
    products: tuple[Product, ...]
    within: tuple[float, float] | None = None
    slew: float | None = None
    on_nan: float | str | None = None
    on_leaving: float | str | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)

    @property
    def events(self) -> Iterator[tuple[str, float | str]]:
        """The events with a command, each with its number or `HOLD`."""
        sent = ((event, getattr(self, f"on_{event}")) for event in EVENTS)
        return ((event, value) for event, value in sent if value is not None)

    def reads(self) -> Iterator[str]:
        """Yield the signals, gains and partners in it."""
        yield from _names_in(self.products)

    @property
    def idle(self) -> float:
        """The value before the first period: 0, brought into the limits."""
        low, high = self.within or (-math.inf, math.inf)
        return min(max(0.0, low), high)


Line = SignalLine | Zoom | Learn | Drive


@dataclass(frozen=True, slots=True)
class Axes:
    """``axis A, B``: lines evaluated for each axis, in order.

    Parameters
    ----------
    names : tuple of str
        Names of the axes.
    lines : tuple of SignalLine, Zoom, Learn or Drive
        In the order of the text.
    every : int
        Control periods between two runs of the lines, from the first period on.
    """

    names: tuple[str, ...]
    lines: tuple[Line, ...] = ()
    every: int = 1
    span: Span = field(default=NOWHERE, compare=False, repr=False)

    def remembered_drives(self) -> tuple[str, ...]:
        """Return the drives with a stored value: read later, or held between two runs."""
        read = self.ports("drive" if self.every > 1 else "driven")
        return tuple(port for port in self.ports("drive") if port in read)

    def ports(self, kind: str) -> tuple[str, ...]:
        """Return the ports of a kind in the lines, in order.

        Parameters
        ----------
        kind : str
            ``reference``, ``measured``, ``driven`` or ``drive``.
        """
        ports: dict[str, None] = {}
        for line in self.lines:
            if isinstance(line, Drive):
                if kind == "drive":
                    ports[line.port] = None
            elif isinstance(line, SignalLine) and line.source is not None:
                ports |= dict.fromkeys(
                    [line.source.name] if kind in line.source.record.ports else []
                )
        return tuple(ports)

    def driven_by(self, name: str) -> Drive | None:
        """Return the first drive that depends on a signal."""
        names = {name}
        for line in self.lines:
            if isinstance(line, SignalLine) and names & set(line.reads()):
                names |= set(line.names)
            elif isinstance(line, Drive) and names & set(_names_in(line.products)):
                return line
        return None

    def gain_of(self, name: str, drive: Drive, constants: Collection[str]) -> Products | None:
        """Return the sensitivity of a drive to the source of a signal.

        Parameters
        ----------
        name : str
            Name of a signal with a source.
        drive : Drive
            A drive that depends on it, before its limits.
        constants : collection of str
            The gains, known in advance.

        Returns
        -------
        tuple of Product or None
            Their sum is the gain; None if it varies. The first factor of each multiplies.
        """
        definition = next(
            (x for x in self.lines if isinstance(x, SignalLine) and name in x.names), None
        )
        if definition is None or not any(line is drive for line in self.lines):
            return None
        gains = {name: _times((Product(()),), definition.products, constants)}
        for line in self.moved_by((name,)):
            if line is drive:
                break
            if isinstance(line, SignalLine):
                # A filter, a rule base or a table in between: no constant gain.
                through = None if line.source is not None else line.products
                gains |= dict.fromkeys(line.names, _gain_through(through, gains, constants))
            elif isinstance(line, Zoom):
                # A zoom scales its signals at run time: no constant gain.
                gains |= dict.fromkeys(line.signals)
        through = _gain_through(drive.products, gains, constants)
        return None if through is None else tuple(map(_with_leading_factor, through))

    def moved_by(self, names: Collection[str]) -> Iterator[Line]:
        """Yield the lines that depend in the same period on some signals, in order.

        Parameters
        ----------
        names : collection of str
            Signals of this axis, and of those further up as ``AXIS.NAME``.
        """
        moved, taught = set(names), set[str]()  # signals; learning tables with a corrected cell
        for line in self.lines:
            source = line.source if isinstance(line, SignalLine) else None
            looks_up = source is not None and source.kind == "table" and source.name in taught
            if not looks_up and not moved & set(line.reads()):
                continue
            if isinstance(line, SignalLine):
                moved |= set(line.names)
            elif isinstance(line, Zoom):
                moved |= set(line.signals)
            elif isinstance(line, Learn):
                taught |= {line.table}
            yield line


Products = tuple[Product, ...]
"""A sum of products."""


def _gain_through(
    products: Products | None, gains: Mapping[str, Products | None], constants: Collection[str]
) -> Products | None:
    """Return the gain of a sum of products, given those of some of its signals."""
    if products is None:
        return None
    gain: list[Product] = []
    for product in products:
        inside = [factor for factor in product.factors if factor.value in gains]
        if not inside:
            continue
        before = gains[str(inside[0].value)]
        others = tuple(factor for factor in product.factors if factor is not inside[0])
        # Products of two such signals, and quotients by one, are not linear.
        if before is None or len(inside) > 1 or inside[0].divides:
            return None
        gain_here = _times(before, (Product(others, product.negative),), constants)
        if gain_here is None:
            return None
        gain += gain_here
    return tuple(gain)


def _with_leading_factor(product: Product) -> Product:
    """Return a product whose first factor multiplies: in a program only later ones divide."""
    if product.factors and not product.factors[0].divides:
        return product
    return Product((Factor(1.0), *product.factors), product.negative)


def _times(first: Products, second: Products, constants: Collection[str]) -> Products | None:
    """Multiply two sums of products, no products for 1; None where a factor is not constant."""
    products = tuple(
        Product((*a.factors, *b.factors), a.negative != b.negative)
        for a in first
        for b in second or (Product(()),)
    )
    values = [factor.value for product in products for factor in product.factors]
    constant = all(not isinstance(value, str) or value in constants for value in values)
    return products if constant else None


def _names_in(products: tuple[Product, ...]) -> Iterator[str]:
    """Yield the names in a sum of products."""
    for product in products:
        for factor in product.factors:
            if isinstance(factor.value, str):
                yield factor.value


@dataclass(frozen=True, slots=True, repr=False)
class ControllerModel(OfKind):
    """A controller as text.

    Parameters
    ----------
    name, description : str
        From its first line.
    period : float
        How often it runs, s.
    every : int
        Periods between set points; 1 by default.
    uses, gains, partners, axes : tuple
        In the order of the text.
    rulebases : tuple of RuleBase
        In the same file; the controller refers to them by name.
    claim_lines : tuple of LoopClaim
        Its ``prove`` lines, with files of plants as written: from the folder of the text.
        :attr:`ControllerText.claims` has them from the working folder.
    """

    kind_of_value = CONTROLLER

    name: str
    period: float
    axes: tuple[Axes, ...]
    gains: tuple[GainModel, ...] = ()
    uses: tuple[Use, ...] = ()
    partners: tuple[Partner, ...] = ()
    every: int = 1
    description: str = ""
    rulebases: tuple[RuleBase, ...] = ()
    claim_lines: tuple[LoopClaim, ...] = ()
    _seen: dict[str, tuple[str, ...]] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )  # by axis, on demand; under "" those of all axes

    def __repr__(self) -> str:
        axes, gains = ", ".join(self.axis_names), ", ".join(gain.name for gain in self.gains)
        words = f"every {self.period:g} s, axes {axes}, gains {gains or 'none'}"
        return one_line(self, f"{self.name}: {words}")

    def seen_elsewhere(self, axis: str) -> tuple[str, ...]:
        """Return the signals of an axis that other axes read, as ``AXIS.NAME``."""
        if not self._seen:
            signals: dict[str, dict[str, None]] = {"": {}}
            for _, line in self.lines():
                for name in line.reads():
                    if isinstance(name, AxisSignal):
                        signals.setdefault(name.axis, {})[name.signal] = None
                        signals[""][name.signal] = None
            self._seen.update({axis: tuple(names) for axis, names in signals.items()})
        return self._seen.get(axis, ())

    def lines(self) -> Iterator[tuple[Axes, Line]]:
        """Iterate over the lines of all axes."""
        for axes in self.axes:
            for line in axes.lines:
                yield axes, line

    @property
    def axis_names(self) -> tuple[str, ...]:
        """The axes, in order."""
        return tuple(name for axes in self.axes for name in axes.names)

    @property
    def is_cascade(self) -> bool:
        """Whether an axis reads a signal of another one."""
        return bool(self.seen_elsewhere(""))

    @property
    def has_one_axis(self) -> bool:
        """Whether there is only one axis: its ports need no prefix."""
        return len(self.axes) == len(self.axes[0].names) == 1
