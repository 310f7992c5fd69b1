"""One period of a controller, over any kind of number.

Every reading of a controller's lines is this walk with an algebra of its own: floats
(:mod:`fuzzyarm.control.controllers.floats`, the reference to which the machine code is compared),
ranges (:mod:`fuzzyarm.control.controllers.reach`), affine forms and zonotopes
(:mod:`fuzzyarm.proof.loop`), laws with slopes (:mod:`fuzzyarm.proof.map.walk`), and the steps of
an exported program (:mod:`fuzzyarm.exchange.export.walk_of_steps`). The compiled loop
(:mod:`fuzzyarm.control.controllers.program`) and the checker of certificates are written
independently of it.

An :class:`Algebra` defines the numbers; everything else has a default. An algebra beyond plain
numbers overrides the treatment of sources (:meth:`Algebra.source`), look-ups
(:meth:`Algebra.called`), stored signals, memory, learners. So a new source is one record
(:mod:`fuzzyarm.symbolic.sources`) for all of them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Generic, NamedTuple, TypeVar

import numpy as np

from fuzzyarm.control.controllers.code import AXIS, Sheet, SourceError
from fuzzyarm.control.controllers.program import of_axis, skipped_drives
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.language.model.controller import (
    Axes,
    AxisSignal,
    Drive,
    Factor,
    GainModel,
    Learn,
    Line,
    Product,
    SignalLine,
    Source,
    Zoom,
)
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.evaluation import specialise
from fuzzyarm.symbolic.nodes import Node, constant, substituted, symbol
from fuzzyarm.symbolic.sources import VALUE, SourceKind, argument_of, unseen
from fuzzyarm.table import LookupTable

T = TypeVar("T")


class PortValue(NamedTuple):
    """An input of a controller: ``reference`` or ``measured``, by axis and port."""

    kind: str
    axis: str
    port: str


class Remembered(NamedTuple):
    """A state: a number carried from one period to the next.

    Attributes
    ----------
    axis, of : str
        Its axis, and its signal or the port of its drive.
    what : str
        The state of the source; ``slew``, ``excess``, ``last`` value of a drive; ``held`` of a
        rule base; ``seen`` of a signal that other axes read.
    start : float
        Initial value; NaN if there is none yet.
    line : int
        Line of a drive, since a port may have several; else 0.
    """

    axis: str
    of: str
    what: str
    start: float
    line: int = 0

    @property
    def name(self) -> str:
        """Its name in a memory."""
        return f"{self.axis}.{self.of} {self.what}{f' {self.line}' if self.line else ''}"


class AxisGuard(NamedTuple):
    """An axis, and the condition of a skipped period.

    Attributes
    ----------
    axis : str
        Its name.
    reads : tuple of PortValue
        If one is NaN, the period is skipped.
    idle : dict of str to float
        Value of each drive before the first period.
    sent : dict of str to float or None
        Value of each drive in a skipped period; None: the last one.
    """

    axis: str
    reads: tuple[PortValue, ...]
    idle: Mapping[str, float]
    sent: Mapping[str, float | None]


@dataclass(frozen=True, eq=False)
class AxisResults(Generic[T]):
    """The results of an axis in one period.

    The period is skipped, like one with NaN inputs, if a signal or a drive is NaN or a memory not
    finite.

    Attributes
    ----------
    signals, drives : dict
        By name, and by port.
    memory : dict
        For the next period, by the name of the memory.
    """

    signals: Mapping[str, T]
    drives: Mapping[str, T]
    memory: Mapping[str, T]


@dataclass(frozen=True, eq=False)
class Update(Generic[T]):
    """A source in one period; its arguments are evaluated on demand."""

    period: ControlPeriod[T]
    line: SignalLine
    source: Source

    @cached_property
    def kind(self) -> SourceKind:
        """Its record."""
        return self.source.sized(self.period.every)

    @cached_property
    def x(self) -> T:
        """The value of its operand."""
        return self.period.operand_of(self.source)

    @cached_property
    def settings(self) -> dict[str, T]:
        """Its options, by the arguments of the update."""
        words = self.kind.settings(dict(self.source.options))
        if self.kind.windup and self.drive is None:
            words[argument_of(self.kind.windup)] = 0.0
        return {word: self.period.operand(value) for word, value in words.items()}

    @cached_property
    def drive(self) -> Drive | None:
        """The drive whose limits an anti-windup uses; None without."""
        return _wound(self.period.axes, self.line, self.source)

    @property
    def states(self) -> dict[str, Remembered]:
        """Its memory, by the names of its states."""
        starts = self.kind.starts(dict(self.source.options))
        return {
            state.name: Remembered(self.period.axis, self.line.names[0], state.name, start)
            for state, start in zip(self.kind.states, starts, strict=True)
        }

    def arguments(self) -> dict[str, T]:
        """Return all arguments of the update by their names, states included."""
        period, number = self.period, self.period.algebra.number
        values = dict(self.settings)
        values |= {"x": self.x, "period": number(period.every)}
        if "last" in self.kind.symbols:
            values["last"] = period.algebra.last(period.model.every)
        if self.kind.windup:
            values |= {"excess": number(0.0), "gain": number(0.0)}
            if self.drive is not None:
                excess = _of_drive(period.axis, self.drive, "excess")
                values["excess"] = period.state(excess)
                values["gain"] = period.gain_of_drive(self.line, self.drive)
        values |= {name: period.state(cell) for name, cell in self.states.items()}
        return values


@dataclass(frozen=True, eq=False)
class Call(Generic[T]):
    """A look-up in a rule base or a table.

    Attributes
    ----------
    name : str
        In the text.
    sheet : RuleBase, LookupTable or None
        None if unreadable.
    signals, arguments : sequence
        Names and values.
    learner : Learn or None
        The line that corrects the table.
    """

    period: ControlPeriod[T]
    line: SignalLine | Learn
    name: str
    sheet: Sheet | None
    signals: Sequence[str]
    learner: Learn | None = None

    @property
    def arguments(self) -> list[T]:
        """The values of its signals."""
        return [self.period.operand(name) for name in self.signals]

    def inputs(self, names: Sequence[str]) -> dict[str, T]:
        """Return the inputs by the names of the sheet; one called `AXIS` is the axis' number."""
        waiting = iter(self.arguments)
        return {
            name: self.period.algebra.number(self.period.index + 1.0)
            if name == AXIS and AXIS not in self.signals
            else next(waiting)
            for name in names
        }

    def lattice(self) -> LookupTable:
        """Return the table, or its part for this axis; SourceError without one."""
        if not isinstance(self.sheet, LookupTable):
            raise SourceError(f"'{self.name}' is a rule base: write rules {self.name}(…)")
        axes, values = of_axis(self.sheet, self.period.index)
        return replace(self.sheet, axes=tuple(axes), values=np.asarray(values))


@dataclass(frozen=True, eq=False)
class Lesson(Generic[T]):
    """A line that teaches: its look-ups in the learning and in the performance table."""

    line: Learn
    table: Call[T]
    judge: Call[T]

    @property
    def rate(self) -> T:
        """The share of the performance value in a correction."""
        return self.table.period.operand(self.line.rate)

    @property
    def bound(self) -> T:
        """The largest magnitude of a cell."""
        return self.table.period.operand(self.line.bound)


class Algebra(Generic[T]):
    """A kind of number.

    Mandatory are :meth:`number` to :meth:`table`. The other methods have defaults in terms of
    these; without a default, a controller that needs the method is refused by name.
    """

    # --- numbers ---

    def number(self, value: float) -> T:
        """Return a number of the text, exactly its double."""
        raise NotImplementedError

    def add(self, a: T, b: T) -> T:
        """Return a sum."""
        raise NotImplementedError

    def subtract(self, a: T, b: T) -> T:
        """Return a difference."""
        raise NotImplementedError

    def multiply(self, a: T, b: T) -> T:
        """Return a product."""
        raise NotImplementedError

    def divide(self, a: T, b: T) -> T:
        """Return a quotient."""
        raise NotImplementedError

    def limit(self, x: T, low: float, high: float) -> T:
        """Return ``min(max(x, low), high)``."""
        raise NotImplementedError

    def excess(self, value: T, x: T, low: float, high: float) -> T:
        """Return the change of x by a limit, to a value."""
        return self.subtract(value, x)

    def rate_limited(self, x: T, before: T, most: float) -> T:
        """Return ``min(max(x, before - most), before + most)``."""
        raise NotImplementedError

    def expression(self, root: Node, values: Mapping[str, T]) -> T:
        """Return the value of an expression for values of its symbols."""
        raise NotImplementedError

    def rules(self, rulebase: RuleBase, inputs: Mapping[str, T]) -> list[T]:
        """Return the outputs of a rule base."""
        raise NotImplementedError

    def table(self, table: LookupTable, inputs: Mapping[str, T]) -> T:
        """Return the value of a lookup table."""
        raise NotImplementedError

    # --- parts of sums ---

    def negated(self, x: T) -> T:
        """Return ``0 - x``, the beginning of a sum with a minus."""
        return self.subtract(self.number(0.0), x)

    def gain(self, gain: GainModel, index: int) -> T:
        """Return a gain of an axis; `index` is 0 if all axes share it."""
        return self.number(gain.values[index].value(math.pi))

    def unknown(self, name: str) -> T:
        """Return the value of a name that is neither a signal nor a gain: a partner."""
        raise SourceError(f"'{name}' is a law of its own")

    # --- sources ---

    def port_error(self, reference: T, measured: T, weight: T | None) -> T:
        """Return the error of a port."""
        if weight is not None:
            reference = self.multiply(reference, weight)
        return self.subtract(reference, measured)

    def last(self, every: int) -> T:
        """Return whether a set point ends with this period."""
        return self.number(float(every == 1))

    def rounded(self, value: T) -> T:
        """Return a value rounded for storage."""
        return value

    def hold(self, value: float) -> float:
        """Round a number of the text for storage."""
        return value

    def source(self, update: Update[T]) -> T:
        """Return the value of a source, and remember its states."""
        kind = update.kind
        if kind.function is None:
            return update.x
        first = update.period.first
        values = update.arguments()
        value = self.expression(of_period(kind.expression, kind, first), values)
        if kind.rounded:
            value = self.rounded(value)
        values[VALUE] = value
        for cell, root in zip(update.states.values(), kind.nexts, strict=True):
            after = self.expression(of_period(root, kind, first), values)
            update.period.remember(cell, self.rounded(after) if kind.rounded else after)
        return value

    # --- rule bases and tables ---

    def called(self, call: Call[T]) -> list[T]:
        """Return the values of a rule base or a table."""
        if isinstance(call.sheet, RuleBase):
            names = [variable.name for variable in call.sheet.inputs]
            values = self.rules(call.sheet, call.inputs(names))
            return [
                _last_held(self, call, index, value) if output.no_rule == "hold" else value
                for index, (output, value) in enumerate(
                    zip(call.sheet.outputs, values, strict=True)
                )
            ]
        if call.sheet is None:
            raise SourceError(f"'{call.name}' could not be read")
        table = call.lattice()
        inputs = call.inputs(table.names)
        if call.learner is not None:
            return [self.learned(call, table, inputs)]
        return [self.table(table, inputs)]

    def held(self, value: T, before: T) -> T:
        """Return an output, or its last value where no rule fires."""
        raise SourceError("an output holds its value where no rule fires")

    def learned(self, call: Call[T], table: LookupTable, inputs: Mapping[str, T]) -> T:
        """Return the value of a table that learns."""
        raise SourceError(f"the table '{call.name}' learns")

    def learn(self, lesson: Lesson[T]) -> None:
        """Correct a table."""
        raise SourceError(f"the table '{lesson.line.table}' learns")

    def zoom(self, line: Zoom, signals: Mapping[str, T], by: T, inside: T) -> dict[str, T]:
        """Return magnified signals."""
        names = tuple(signals)
        values = {**{f"signal {k}": signals[n] for k, n in enumerate(names)},
                  "by": by, "inside": inside}  # fmt: skip
        times = tuple(line.signals.count(name) for name in names)
        roots = zoomed(times, wait=line.wait)
        return dict(zip(names, (self.expression(root, values) for root in roots), strict=True))

    # --- state ---

    def begins(self, cell: Remembered) -> T:
        """Return a memory before the first period."""
        return self.number(0.0 if math.isnan(cell.start) else cell.start)

    def remember(self, cell: Remembered, value: T) -> T:
        """Return a value as stored for the next period."""
        return value

    def signal(self, axis: str, name: str, value: T, *, rounded: bool = True) -> T:
        """Return a signal rounded for storage, as read by later lines."""
        return value

    def demand(self, line: Drive, value: T) -> T:
        """Return the value of a drive's line before its limits."""
        return value

    def drive(self, axis: str, line: Drive, value: T) -> T:
        """Return the value of a drive's line, limits included."""
        return value

    # --- the axis ---

    def skipped(self, guard: AxisGuard, given: Mapping[PortValue, T]) -> dict[str, T] | None:
        """Return the drives of a skipped axis; None if it runs."""
        return None

    def ran(self, guard: AxisGuard, results: AxisResults[T]) -> dict[str, T] | None:
        """Return the drives of an axis skipped after its run; None keeps its results."""
        return None


class ControlPeriod(Generic[T]):
    """The walk: one period of a controller over some kind of number.

    Parameters
    ----------
    text : ControllerText
        The controller.
    algebra : Algebra
        The kind of number.

    Attributes
    ----------
    cells : dict of str to Remembered
        Its memory.
    axes, axis, index, line
        During the walk: the block of axes, the axis, its number, and the line.
    signals : dict
        Signals of this axis.
    first : bool or None
        Whether sources have no value yet; None: decided by each state.
    """

    def __init__(self, text: ControllerText, algebra: Algebra[T]) -> None:
        self.text, self.model, self.algebra = text, text.model, algebra
        self.gains = {gain.name: gain for gain in self.model.gains}
        self.seen = {axis: self.model.seen_elsewhere(axis) for axis in self.model.axis_names}
        self.signals: dict[str, T] = {}
        self.first: bool | None = None
        self.cells = {cell.name: cell for cell in self._remembered()}

    @property
    def every(self) -> float:
        """Time between two runs of the current axis, s."""
        return self.axes.every * self.model.period

    def run(
        self,
        given: Mapping[PortValue, T],
        memory: Mapping[str, T],
        *,
        first: bool | None = None,
        only: Collection[str] | None = None,
        number: int = 0,
    ) -> tuple[dict[tuple[str, str], T], dict[str, T]]:
        """Walk one period.

        Parameters
        ----------
        given : mapping
            References and measured values.
        memory : mapping of str
            Memory of the last period; missing names start anew.
        first : bool, optional
            Whether it is the first period; None: decided by NaN in a memory.
        only : collection of str, optional
            Some of the axes.
        number : int, optional
            Number of the period, for axes with rates of their own; all run in period 0.

        Returns
        -------
        drives : dict
            By axis and port.
        memory : dict of str
            For the next period.
        """
        self.first, self._given, self._before = first, given, memory
        self._after: dict[str, T] = {}
        drives: dict[tuple[str, str], T] = {}
        for index, (axes, axis) in enumerate(self._every_axis()):
            if only is None or axis in only:
                self.axes, self.axis, self.index = axes, axis, index
                sent = self._resting() if number % axes.every else self._one_axis()
                drives |= {(axis, port): value for port, value in sent.items()}
        return drives, self._after

    def _resting(self) -> dict[str, T]:
        """Return the drives of an axis between two of its runs."""
        self._stay()
        return {port: self.state(self._last(port)) for port in self.axes.ports("drive")}

    def _last(self, port: str) -> Remembered:
        return self.cells[f"{self.axis}.{port} last"]

    def _stay(self) -> None:
        """Keep the memory of the current axis."""
        self._after |= {c.name: self.state(c) for c in self.cells.values() if c.axis == self.axis}

    def _leave(self, drives: Mapping[str, T]) -> None:
        """Store the sent drives."""
        for port in self.axes.remembered_drives():
            self.remember(self._last(port), drives[port])

    def _every_axis(self) -> Iterator[tuple[Axes, str]]:
        return ((axes, axis) for axes in self.model.axes for axis in axes.names)

    def _one_axis(self) -> dict[str, T]:
        guard = guard_of(self.axes, self.axis, self.algebra.hold)
        self.signals, self._drives = {}, dict[str, T]()
        memory = [cell for cell in self.cells.values() if cell.axis == self.axis]
        sent = self.algebra.skipped(guard, self._given)
        if sent is None:
            for line in self.axes.lines:
                self._line(line)
            for name in (name for name in self.seen[self.axis] if name in self.signals):
                self.remember(_seen(self.axis, name), self.signals[name])
            self._leave(self._drives)
            after = {c.name: self._after[c.name] for c in memory if c.name in self._after}
            sent = self.algebra.ran(guard, AxisResults(self.signals, self._drives, after))
        if sent is None:
            return self._drives
        self._stay()
        self._leave(sent)
        return sent

    # --- memory ---

    def _remembered(self) -> Iterator[Remembered]:
        """Yield the memory of all axes, in the order of the text."""
        for index, (axes, axis) in enumerate(self._every_axis()):
            for line in axes.lines:
                if isinstance(line, Drive) and line.slew is not None:
                    yield _of_drive(axis, line, "slew")
                elif isinstance(line, SignalLine) and line.source is not None:
                    yield from self._of_source(axes, axis, index, line, line.source)
            for name in self.seen[axis]:
                yield _seen(axis, name)
            if axes.every > 1:
                for port in axes.ports("drive"):
                    yield self._of_port(axis, axes, port)

    def _of_source(
        self, axes: Axes, axis: str, index: int, line: SignalLine, source: Source
    ) -> Iterator[Remembered]:
        if source.kind == "driven":
            yield self._of_port(axis, axes, source.name)
        kind, options = source.sized(axes.every * self.model.period), dict(source.options)
        sheet = self.sheet(source.name, index) if kind.of == "call" else None
        if isinstance(sheet, RuleBase):
            for number, output in enumerate(sheet.outputs):
                if output.no_rule == "hold":
                    yield _held_by(axis, line, number)
        for state, start in zip(kind.states, kind.starts(options), strict=True):
            yield Remembered(axis, line.names[0], state.name, start)
        drive = _wound(axes, line, source)
        if drive is not None:
            yield _of_drive(axis, drive, "excess")

    def _of_port(self, axis: str, axes: Axes, port: str) -> Remembered:
        idle, _ = skipped_drives(axes, self.algebra.hold).get(port, (0.0, None))
        return Remembered(axis, port, "last", idle)

    def state(self, cell: Remembered) -> T:
        """Return a state from the last period."""
        if cell.name in self._before:
            return self._before[cell.name]
        return self.algebra.begins(self.cells[cell.name])

    def remember(self, cell: Remembered, value: T) -> None:
        """Store a state for the next period."""
        self._after[cell.name] = self.algebra.remember(cell, value)

    # --- lines ---

    def _line(self, line: Line) -> None:
        self.line = line
        if isinstance(line, Drive):
            self._drive(line)
        elif isinstance(line, SignalLine):
            for name, value in zip(line.names, self._values(line), strict=False):
                self.signals[name] = self.algebra.signal(self.axis, name, value)
        elif isinstance(line, Zoom):
            before = {name: self.operand(name) for name in line.signals}
            by, inside = self.operand(line.by), self.operand(line.inside)
            after = self.algebra.zoom(line, before, by, inside)
            for name, value in after.items():
                stored = self.algebra.signal(self.axis, name, value, rounded=False)
                self.signals[name] = stored
        else:
            calls = [self._call(line, name, line.inputs) for name in (line.table, line.judge)]
            self.algebra.learn(Lesson(line, *calls))

    def _values(self, line: SignalLine) -> list[T]:
        source = line.source
        if source is None:
            return [self.sum(line.products)]
        if source.record.of == "call":
            values = self.algebra.called(self._call(line, source.name, source.inputs))
        else:
            values = [self.algebra.source(Update(self, line, source))]
        (product,) = line.products or (Product(()),)
        return [self._scaled(value, product.factors) for value in values]

    def _drive(self, line: Drive) -> None:
        algebra = self.algebra
        value = demand = algebra.demand(line, self.sum(line.products))
        if line.within is not None:
            value = algebra.limit(demand, *line.within)
            excess = _of_drive(self.axis, line, "excess")
            if excess.name in self.cells:
                self.remember(excess, algebra.excess(value, demand, *line.within))
        if line.slew is not None:
            before = _of_drive(self.axis, line, "slew")
            most = line.slew * self.axes.every * self.model.period
            value = algebra.rate_limited(value, self.state(before), most)
            self.remember(before, value)
        value = algebra.drive(self.axis, line, value)
        earlier = self._drives.get(line.port)
        self._drives[line.port] = value if earlier is None else algebra.add(earlier, value)

    def sum(self, products: Sequence[Product]) -> T:
        """Return a sum of products, added in the order of the program."""
        total: T | None = None
        for product in products:
            first, *others = product.factors
            value = self._scaled(self.operand(first.value), others)
            if total is None:
                total = self.algebra.negated(value) if product.negative else value
            else:
                apply = self.algebra.subtract if product.negative else self.algebra.add
                total = apply(total, value)
        return self.algebra.number(0.0) if total is None else total

    def _scaled(self, value: T, factors: Iterable[Factor]) -> T:
        """Return a value times (or divided by) factors, from left to right."""
        for factor in factors:
            apply = self.algebra.divide if factor.divides else self.algebra.multiply
            value = apply(value, self.operand(factor.value))
        return value

    def operand(self, value: str | float) -> T:
        """Return a number, a signal or a gain."""
        if not isinstance(value, str):
            return self.algebra.number(float(value))
        if isinstance(value, AxisSignal):
            name = _seen(value.axis, value.signal).name
            return self._after[name] if name in self._after else self.algebra.unknown(value)
        if value in self.signals:
            return self.signals[value]
        gain = self.gains.get(value)
        if gain is None:
            return self.algebra.unknown(value)
        return self.algebra.gain(gain, self.index if len(gain.values) > 1 else 0)

    # --- sources, rule bases, tables ---

    def operand_of(self, source: Source) -> T:
        """Return the operand of a source: a signal or the value of a port."""
        kinds = source.record.ports
        if not kinds:
            return self.operand(source.name)
        if source.kind == "driven":
            return self.algebra.rounded(self.state(self._last(source.name)))
        values = [self._given[PortValue(kind, self.axis, source.name)] for kind in kinds]
        if len(values) == 1:
            return values[0]
        weight = source.option("weight")
        share = self.operand(weight) if isinstance(weight, str | float) else None
        by_kind = dict(zip(kinds, values, strict=True))
        return self.algebra.port_error(by_kind["reference"], by_kind["measured"], share)

    def gain_of_drive(self, line: SignalLine, drive: Drive) -> T:
        """Return the sensitivity of a drive to a source; 1 if it is not constant."""
        products = self.axes.gain_of(line.names[0], drive, self.gains)
        if not products:
            return self.algebra.number(1.0 if products is None else 0.0)
        return self.sum(products)

    def sheet(self, name: str, index: int) -> Sheet | None:
        """Return the rule base or table of an axis; None if unreadable."""
        sheets = self.text.sheets.get(name)
        return sheets[index if len(sheets) > 1 else 0] if sheets else None

    def _call(self, line: SignalLine | Learn, name: str, signals: Sequence[str]) -> Call[T]:
        learners = (x for x in self.axes.lines if isinstance(x, Learn) and x.table == name)
        sheet = self.sheet(name, self.index)
        return Call(self, line, name, sheet, signals, next(learners, None))


def guard_of(axes: Axes, axis: str, hold: Callable[[float], float]) -> AxisGuard:
    """Return the condition under which an axis is skipped, and its drives then."""
    reads = tuple(
        PortValue(kind, axis, port)
        for kind in ("reference", "measured")
        for port in axes.ports(kind)
    )
    drives = skipped_drives(axes, hold)
    idle = {port: value for port, (value, _) in drives.items()}
    return AxisGuard(axis, reads, idle, {port: value for port, (_, value) in drives.items()})


def _last_held(algebra: Algebra[T], call: Call[T], index: int, value: T) -> T:
    """Return an output that holds its value if no rule fires, and remember it."""
    cell = _held_by(call.period.axis, call.line, index)
    value = algebra.held(value, call.period.state(cell))
    call.period.remember(cell, value)
    return value


def _of_drive(axis: str, line: Drive, what: str) -> Remembered:
    return Remembered(axis, line.port, what, 0.0, line.span.line)


def _seen(axis: str, name: str) -> Remembered:
    return Remembered(axis, name, "seen", 0.0)


def _held_by(axis: str, line: SignalLine | Learn, index: int) -> Remembered:
    assert isinstance(line, SignalLine)
    return Remembered(axis, line.names[index], "held", math.nan)


def _wound(axes: Axes, line: SignalLine, source: Source) -> Drive | None:
    """Return the drive whose limits an anti-windup uses; None without."""
    kind = source.record
    if not kind.windup or not kind.settings(dict(source.options))[argument_of(kind.windup)]:
        return None
    return axes.driven_by(line.names[0])


@cache
def of_period(root: Node, kind: SourceKind, first: bool | None) -> Node:
    """Return an update specialised to the first or a later period, for states starting as NaN."""
    if first is None:
        return root
    for state in kind.states:
        # An update tests s == s, false for NaN.
        begun = isinstance(state.start, float) and math.isnan(state.start) and first
        root = substituted(root, unseen(symbol(state.name)), constant(float(begun)))
    return specialise(root, {})


@cache
def zoomed(times: tuple[int, ...], *, wait: bool) -> tuple[Node, ...]:
    """Return the magnified ``signal 0`` …, valid while all are ``inside`` the window.

    A signal named several times in the line is magnified as often.
    """
    signals = [symbol(f"signal {k}") for k in range(len(times))]
    by, inside = symbol("by"), symbol("inside")
    size: Node = constant(0.0)
    for signal in signals:
        size = op.maximum(size, abs(signal))
    factor: Node = by
    if wait:
        factor = op.where(inside < size * by, inside / size, by)
    large: list[Node] = list(signals)
    for k, count in enumerate(times):
        for _ in range(count):
            large[k] = factor * large[k]
    return tuple(
        op.where(size <= inside, value, signal)
        for value, signal in zip(large, signals, strict=True)
    )
