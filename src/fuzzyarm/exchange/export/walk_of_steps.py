"""The walk that makes steps of a controller: a control period over lines of a program."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace as with_values
from typing import NamedTuple

import numpy as np

from fuzzyarm.base.diagnostic import NOWHERE, Span
from fuzzyarm.control.controllers.code import SourceError
from fuzzyarm.control.controllers.period import (
    Algebra,
    AxisGuard,
    AxisResults,
    Call,
    ControlPeriod,
    Lesson,
    PortValue,
    Remembered,
)
from fuzzyarm.control.controllers.text import ControllerText, home_of, ports_of, sheet_path
from fuzzyarm.exchange.export.forms import (
    NOT_A_NUMBER,
    endless,
    folded,
    nan_sources,
    shared,
    without_endless_limits,
)
from fuzzyarm.exchange.export.numbers import ExportError, Precision, precision_named
from fuzzyarm.exchange.export.routine import Routine
from fuzzyarm.exchange.export.rulebase import direct_routine
from fuzzyarm.exchange.export.sets import TABLE_HINT
from fuzzyarm.exchange.export.steps import (
    LAST,
    Ask,
    Block,
    Find,
    Guard,
    LearningTable,
    Pick,
    Set,
    Steps,
    StepVariable,
    Teach,
    first_of,
    last_of,
)
from fuzzyarm.exchange.export.table import (
    MOST_CELLS,
    FixedTable,
    FloatTable,
    TableRoutine,
    fewer_levels,
    fixed_table,
    float_table,
)
from fuzzyarm.language.model.controller import Drive, GainModel, SignalLine, Zoom
from fuzzyarm.language.model.rulebase import Output, RuleBase
from fuzzyarm.plant.setting import RunArithmetic
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.evaluation import specialise
from fuzzyarm.symbolic.identifiers import Names, identifier
from fuzzyarm.symbolic.nodes import (
    Constant,
    Node,
    Symbol,
    constant,
    postorder,
    replace,
    substituted,
    symbol,
    symbols,
)
from fuzzyarm.symbolic.sources import unseen
from fuzzyarm.table import LookupTable

MOST_STEPS = 20_000
"""Steps of a controller, which are written out one after the other."""

MOST_LEARNED = 0xFFFF
"""Cells of a table that learns: an `unsigned` holds their index on every machine."""


class RoutineOptions(NamedTuple):
    """Options for the export of rule bases and tables."""

    q: int | None = None  # tables in whole numbers of so many bits; else in the type of the signals
    widened: bool = False  # whether rule bases that need double precision compute in it internally


def steps_of(
    text: ControllerText, precision: str = "float64", options: RoutineOptions | None = None
) -> Steps:
    """Return a controller as steps."""
    model = text.model
    if model.partners:
        partner = model.partners[0]
        raise ExportError(
            f"the partner '{partner.name}' is the law '{partner.law}', which is not text"
            " and cannot be exported",
            hint="leave it out, and write it in the target language",
            span=partner.span,
            path=text.path,
        )
    lines = Lines(text, precision_named(precision, arithmetic=True), options or RoutineOptions())
    try:
        return lines.steps()
    except SourceError as error:
        raise ExportError(error.message, hint=error.hint, path=text.path) from None


class Lines(Algebra[Node]):
    """Lines of a program as the numbers of a control period: expressions over its variables.

    A value is an expression until it is stored: then it becomes a step, together with its memory.
    """

    def __init__(self, text: ControllerText, types: Precision, options: RoutineOptions) -> None:
        self.text, self.options = text, options
        self.result = Steps(text.model, types)
        self.arithmetic = RunArithmetic(self.result.single)
        self.unseen: set[str] = set()  # states that are NaN before the first period
        self.locals = 0
        self.pending: list[tuple[str, Node, bool]] = []
        self.lasting: list[tuple[str, Node, bool]] = []  # of this axis, for its end
        self.numbers: dict[str, Node] = {}  # expressions that must be numbers, with their operands
        self.finite: list[Node] = []  # expressions that must be finite
        self.states: dict[str, str] = {}  # by the name of a memory
        self.routine_names: dict[tuple[int, str], str] = {}
        self.responsible: dict[str, tuple[tuple[str, ...], str]] = {}
        self.names = Names()
        self.state_names = Names()
        self.first_step = 0

    def steps(self) -> Steps:
        """Walk over the lines."""
        model = self.text.model
        ports = [
            (kind, axis, port)
            for kind in ("reference", "measured", "drive")
            for axis, port in ports_of(model, kind)
        ]
        for key in ports:
            self._variable(StepVariable(*key))
        for gain in model.gains:
            several = len(gain.values) > 1
            for number, amount in enumerate(gain.values):
                start = self.hold(amount.value(math.pi))
                axis_number = number if several else -1
                self._variable(StepVariable("gain", "", gain.name, start, number=axis_number))
        given = {PortValue(*key): symbol(StepVariable(*key).symbol) for key in ports}
        self.period = ControlPeriod(self.text, self)
        self.period.run(given, {})
        if len(self.result.steps) > MOST_STEPS:
            raise ExportError(
                f"{len(self.result.steps):,} steps are more than {MOST_STEPS:,}",
                hint="export parts of it as separate controllers",
            )
        return self.result

    # --- variables ---

    def _variable(self, variable: StepVariable) -> str:
        self.result.variables[variable.symbol] = variable
        return variable.symbol

    def _local(self, name: str = "") -> str:
        """Return the symbol of a new local variable."""
        self.locals += 1
        return f"local:{name or 't'}:{self.locals}"

    def _set(self, target: str, value: Node, *, rounded: bool = False) -> Node:
        self.result.steps.append(Set(target, value, rounded))
        return symbol(target)

    def begins(self, cell: Remembered) -> Node:
        """Return the variable of a memory."""
        if cell.what == "last":
            drive = StepVariable("drive", cell.axis, cell.of).symbol
            self.result.remembered[drive] = None
            self.states[cell.name] = last_of(drive)
        elif cell.name not in self.states:
            stem = f"{cell.axis}_{cell.of}_{_SUFFIXES.get(cell.what, cell.what)}"
            name = self.state_names.new(stem).removeprefix(f"{identifier(cell.axis)}_")
            # No language has NaN for an empty memory: the first period is a flag.
            nothing = math.isnan(cell.start)
            start = 0.0 if nothing else cell.start
            self.states[cell.name] = self._variable(
                StepVariable("state", cell.axis, name, start, wide=True)
            )
            if nothing:
                self.unseen.add(self.states[cell.name])
        return symbol(self.states[cell.name])

    def remember(self, cell: Remembered, value: Node) -> Node:
        """Schedule a memory for the store of its new value."""
        variable = self.begins(cell)
        assert isinstance(variable, Symbol)
        if cell.what != "last":  # set by its drive
            self.pending.append((variable.name, value, cell.what != "slew"))
        return variable if cell.what == "seen" else value

    def signal(self, axis: str, name: str, value: Node, *, rounded: bool = True) -> Node:
        """Set a signal."""
        variable = StepVariable("signal", axis, name, wide=not rounded)
        target = symbol(variable.symbol)
        if value is not target:
            self.result.variables.setdefault(variable.symbol, variable)
            self.numbers[variable.symbol] = value
            self._store([(variable.symbol, value, rounded)])
        return target

    def zoom(
        self, line: Zoom, signals: Mapping[str, Node], by: Node, inside: Node
    ) -> dict[str, Node]:
        """Set signals magnified together."""
        zoomed = super().zoom(line, signals, by, inside)
        writes = []
        for name, value in zoomed.items():
            key = StepVariable("signal", self.period.axis, name).symbol
            # Already rounded: stored unchanged.
            self.result.variables[key] = self.result.variables[key]._replace(wide=True)
            writes.append((key, value, False))
        # The memory of a signal is its value before.
        for index, (state, value, known) in enumerate(self.lasting):
            if any(value is symbol(key) for key, _, _ in writes):
                self.lasting[index] = state, self._set(self._local(), value), known
        self._store(writes)
        return dict(signals)

    def demand(self, line: Drive, value: Node) -> Node:
        """Return the demand of a drive: it must be a number, which limits may hide."""
        limited = line.within is not None or line.slew is not None
        return self._number(value) if limited else value

    def drive(self, axis: str, line: Drive, value: Node) -> Node:
        """Set a local variable to the value of a drive's line."""
        local = self._local(f"{axis}_{line.port}")
        if line.within is None and line.slew is None:
            self.numbers[local] = value
        self._store([(local, value, False)])
        return symbol(local)

    def _store(self, writes: list[tuple[str, Node, bool]]) -> None:
        """Add the steps that write values: each is of the time before; memory lasts later."""
        pending, self.pending = self.pending, []
        values = [value for _, value, _ in (*writes, *pending)]
        while (node := shared(values)) is not None:
            name = self._local()
            self._set(name, node)
            values = [substituted(value, node, symbol(name)) for value in values]
        for (state, whole, has_to_be), value in zip(pending, values[len(writes) :], strict=True):
            plain = isinstance(value, Symbol | Constant)
            kept = value if plain else self._set(self._local(), value)
            self.lasting.append((state, kept, has_to_be))
            if has_to_be and not self._is_finite(whole):
                self.finite.append(kept)
                self.numbers[f"{state} next"] = whole
        set_before: set[str] = set()
        ready = []
        for (target, _, rounded), value in zip(writes, values, strict=False):
            safe = set_before.isdisjoint(symbols(value))
            ready.append((target, value if safe else self._set(self._local(), value), rounded))
            set_before.add(target)
        for target, value, rounded in ready:
            self._set(target, value, rounded=rounded)

    # --- numbers ---

    def number(self, value: float) -> Node:
        """Return a constant."""
        return constant(value)

    def gain(self, gain: GainModel, index: int) -> Node:
        """Return the variable of a gain."""
        number = index if len(gain.values) > 1 else -1
        return symbol(StepVariable("gain", "", gain.name, number=number).symbol)

    def hold(self, value: float) -> float:
        """Return a number as stored."""
        return self.arithmetic.hold(value)

    def add(self, a: Node, b: Node) -> Node:
        """Return a sum."""
        return folded(a + b)

    def subtract(self, a: Node, b: Node) -> Node:
        """Return a difference."""
        return folded(a - b)

    def multiply(self, a: Node, b: Node) -> Node:
        """Return a product."""
        return folded(a * b)

    def divide(self, a: Node, b: Node) -> Node:
        """Return a quotient."""
        return folded(a / b)

    def limit(self, x: Node, low: float, high: float) -> Node:
        """Return ``min(max(x, low), high)``; a limit at infinity changes no number."""
        above: Node = x if low == -math.inf else op.maximum(x, low)
        return above if high == math.inf else op.minimum(above, high)

    def rate_limited(self, x: Node, before: Node, most: float) -> Node:
        """Return ``min(max(x, before - most), before + most)``."""
        nearest: Node = op.minimum(op.maximum(x, before - most), before + most)
        return nearest

    def expression(self, root: Node, values: Mapping[str, Node]) -> Node:
        """Return an expression with its arguments, and its consequences."""
        numbers = {name: x.value for name, x in values.items() if isinstance(x, Constant)}
        others = {name: x for name, x in values.items() if not isinstance(x, Constant)}
        root = replace(without_endless_limits(specialise(root, numbers)), others)
        for state in self.unseen & set(symbols(root)):
            nan = unseen(symbol(state))
            if nan in postorder(root):
                root = substituted(root, nan, self._first(state))
        self.result.needs_last |= LAST in symbols(root)
        return root

    def _first(self, state: str) -> Node:
        """Return the condition of a state's first period on its axis."""
        axis = self.result.variables[state].axis
        self.result.needs_first[axis] = None
        return symbol(first_of(axis))

    def last(self, every: int) -> Node:
        """Return the condition for the end of a set point."""
        return symbol(LAST)

    def rounded(self, value: Node) -> Node:
        """Assign a rounded value to its own variable."""
        if not self.result.single or self.result.precision.wide is np.float32:
            return value
        return self._set(self._local(), value, rounded=True)

    # --- axes ---

    def skipped(self, guard: AxisGuard, given: Mapping[PortValue, Node]) -> None:
        """Begin an axis."""
        self.first_step = len(self.result.steps)
        self.lasting, self.numbers, self.finite = [], {}, []

    def ran(self, guard: AxisGuard, results: AxisResults[Node]) -> None:
        """End an axis: set states if its period counts; round a sum once."""
        self._store([])
        sent: dict[str, float | None] = {}
        drives: list[Set] = []
        for port, value in results.drives.items():
            name = StepVariable("drive", guard.axis, port).symbol
            variable = self.result.variables[name]
            self.result.variables[name] = variable._replace(start=guard.idle[port])
            sent[name] = guard.sent[port]
            # A sum of several lines is one more value that must be a number.
            drives.append(Set(name, self._number(value), rounded=True))
            if name in self.result.remembered and not self._is_limited(port):
                self.finite.append(drives[-1].value)
        reads = tuple(StepVariable(*value).symbol for value in guard.reads)
        lasting = [*self._memory(), *drives]
        finite = dict.fromkeys(x.name for x in self.finite if isinstance(x, Symbol))
        numbers, every = self._not_implied(), self.period.axes.every
        guarded = Guard(guard.axis, reads, sent, numbers, tuple(finite), every)
        steps = tuple(self.result.steps[self.first_step :])
        self.result.blocks.append(Block(guarded, steps, tuple(lasting)))

    def _is_limited(self, port: str) -> bool:
        """Whether all drives of a port have finite limits."""
        lines = (line for line in self.period.axes.lines if isinstance(line, Drive))
        limits = [line.within or (-math.inf, math.inf) for line in lines if line.port == port]
        return all(math.isfinite(end) for pair in limits for end in pair)

    def _memory(self) -> Iterator[Set]:
        """Yield the steps that set states, in an order in which none reads a new one."""
        set_before: set[str] = set()
        # A delay line is set from its end.
        for state, value, _ in reversed(self.lasting):
            safe = set_before.isdisjoint(symbols(value))
            yield Set(state, value if safe else self._set(self._local(), value))
            set_before.add(state)

    def _number(self, x: Node) -> Node:
        """Return the variable of a value that must be a number."""
        if isinstance(x, Constant | Symbol):  # signals must be numbers anyway
            return x
        name = self._local("demand")
        self.numbers[name] = x
        return self._set(name, x)

    def _not_implied(self) -> tuple[str, ...]:
        """Return the expressions to check for NaN, beside those checked to be finite."""
        left: list[str] = []
        implied = {x.name for x in self.finite if isinstance(x, Symbol)}
        for name, value in reversed(self.numbers.items()):
            seen = name in implied or name.endswith(" next")
            if not seen and NOT_A_NUMBER not in endless(value, self._known()):
                continue  # a number if its sources are, which are not checked by it
            left += [name] * (not seen)
            implied |= nan_sources(value)
        return tuple(reversed(left))

    def _is_finite(self, value: Node) -> bool:
        """Whether a value is finite, by its form, where signals are numbers."""
        return not endless(value, self._known())

    def _known(self) -> set[str]:
        return set(self.states.values())

    # --- rule bases ---

    def _input(self, value: Node) -> str:
        """Return the symbol of a value; a number is put into a variable."""
        if isinstance(value, Symbol):
            return value.name
        name = self._local()
        self._set(name, value)
        return name

    def _inner(self) -> str:
        """Return the precision of functions within the controller."""
        return "float32" if self.result.precision.wide is np.float32 else "float64"

    def called(self, call: Call[Node]) -> list[Node]:
        """Ask a rule base, output by output, or a table."""
        rulebase, line = call.sheet, call.line
        asks = isinstance(line, SignalLine) and line.source and line.source.kind == "rules"
        if not asks:
            return super().called(call)
        if not isinstance(rulebase, RuleBase):
            raise SourceError(f"'{call.name}' is a table: write table {call.name}(…)")
        values = call.inputs([variable.name for variable in rulebase.inputs])
        inputs = tuple(self._input(value) for value in values.values())
        results: list[Node] = []
        for output in rulebase.outputs:
            local = self._local()
            routine = self._conclusion(call.name, rulebase, output)
            self.result.steps.append(Ask(local, routine, inputs))
            results.append(symbol(local))
        return results

    def _conclusion(self, name: str, rulebase: RuleBase, output: Output) -> str:
        """Return the routine of an output; axes with the same one share it."""
        key = (id(rulebase), output.name)
        if key in self.routine_names:
            return self.routine_names[key]
        try:
            routine = direct_routine(
                rulebase, output.name, self._inner(), widened=self.options.widened
            )
        except ExportError as error:
            hint = error.hint.replace(TABLE_HINT, "--table looks the rules up in a table")
            raise error.in_file(self._file_of(name, rulebase), hint) from None
        if routine.program.holds:
            raise ExportError(
                f"'{output.name}' of '{rulebase.name}' holds its value where no rule"
                " fires, which exported controllers do not",
                hint="say a number:  no-rule 0",
                span=output.span,
                path=self._file_of(name, rulebase),
            )
        self.routine_names[key] = self._routine(f"{name}_{output.name}", routine)
        self.result.sheets[self.routine_names[key]] = rulebase, output.name
        return self.routine_names[key]

    def _routine(self, stem: str, routine: Routine) -> str:
        name = self.names.new(stem)
        self.result.routines[name] = routine
        return name

    # --- tables ---

    def table(self, table: LookupTable, inputs: Mapping[str, Node]) -> Node:
        """Ask a table."""
        line = self.period.line
        assert isinstance(line, SignalLine)
        assert line.source is not None
        names = tuple(self._input(value) for value in inputs.values())
        local = self._local()
        self.result.steps.append(Ask(local, self._table(line.source.name, table, names), names))
        return symbol(local)

    def learned(self, call: Call[Node], table: LookupTable, inputs: Mapping[str, Node]) -> Node:
        """Pick a cell of a table that learns."""
        key = self._learner(call)
        names = tuple(self._input(value) for value in inputs.values())
        taught, cell = self.responsible.get(key, ((), ""))
        if taught != names:
            cell = self._found(table, call.name, names)
        local = self._local()
        self.result.steps.append(Pick(local, key, cell))
        return symbol(local)

    def _learner(self, call: Call[Node]) -> str:
        return f"{call.period.axis}:{call.name}"

    def _table(self, name: str, table: LookupTable, inputs: Sequence[str]) -> str:
        """Return the name of the routine of a table; axes with the same one share it."""
        if table.values.size > MOST_CELLS:
            raise ExportError(
                f"the table '{name}' has {table.values.size:,} cells; at most {MOST_CELLS:,} are"
                " exported",
                hint=fewer_levels(len(table.axes), MOST_CELLS),
                span=self._use_of(name),
                path=self.text.path,
            )
        # Signals in single precision find their cell among thresholds in single precision.
        signals = [self.result.variables.get(variable) for variable in inputs]
        narrow = all(signal is not None and not signal.wide for signal in signals)
        core = self._core(table, narrow=narrow)
        for routine_name, routine in self.result.routines.items():
            if isinstance(routine, TableRoutine) and _same_table(routine.core, core):
                return routine_name
        routine_key = self._routine(name, TableRoutine(core))
        self.result.sheets[routine_key] = table
        return routine_key

    def _core(self, table: LookupTable, *, narrow: bool) -> FloatTable | FixedTable:
        if self.options.q is not None:
            return fixed_table(table, self.options.q)
        if self.result.single and self.result.precision.wide is np.float64:
            # The kernel holds values in the precision of signals and computes in double.
            single = np.asarray(table.values, np.float32).astype(np.float64)
            table = with_values(table, values=single)
        precision = self._inner()
        if table.default_mode != "linear" and self.result.single and narrow:
            precision = "float32"
        return float_table(table, None, precision)

    def _found(self, table: LookupTable, name: str, inputs: tuple[str, ...]) -> str:
        """Add the step that finds a cell; return the local with its number."""
        grid = tuple((axis.name, axis.thresholds(table.default_mode)) for axis in table.axes)
        keys = {other: key for key, other in self.result.grids.items()}
        if grid not in keys:
            keys[grid] = self.names.new(f"{name}_cell")
            self.result.grids[keys[grid]] = grid
            self.result.grid_tables[keys[grid]] = table
        target = self._local()
        self.result.steps.append(Find(target, keys[grid], inputs))
        return target

    # --- tables that learn ---

    def learn(self, lesson: Lesson[Node]) -> None:
        """Teach a table."""
        table, judge = lesson.table.lattice(), lesson.judge.lattice()
        self._demand_teachable(lesson, table)
        key, (axis, name) = self._learner(lesson.table), (self.period.axis, lesson.line.table)
        start = tuple(self.hold(value) for value in table.values.ravel().tolist())
        self.result.learned[key] = LearningTable(axis, name, start, lesson.line.delay)
        inputs = tuple(self._input(value) for value in lesson.table.arguments)
        cell = judged = self._found(table, name, inputs)
        if not _alike(table, judge):
            judged = self._found(judge, lesson.line.judge, inputs)
        performance = self._judge(lesson.line.judge, judge)
        self.result.steps.append(Teach(key, cell, performance, judged, lesson.rate, lesson.bound))
        self.responsible[key] = inputs, cell

    def _demand_teachable(self, lesson: Lesson[Node], table: LookupTable) -> None:
        """Refuse a table that learns where an exported one cannot."""
        name, axis = lesson.line.table, self.period.axis
        if table.default_mode == "linear":
            raise SourceError("a table that is interpolated has no responsible cell to correct")
        if self.options.q is not None:
            raise ExportError(
                "a table that learns is exported in floating point",
                hint="leave out --q",
                span=next(self.text.learners()).span,
                path=self.text.path,
            )
        if self._learner(lesson.table) in self.result.learned:
            raise ExportError(
                f"two lines teach the table '{name}' of axis '{axis}'; one is exported",
                hint="leave one of them out, or give each its own table",
                span=self._learner_of(name),
                path=self.text.path,
            )
        if table.values.size > MOST_LEARNED:
            raise ExportError(
                f"the table '{name}' learns in {table.values.size:,} cells; at most"
                f" {MOST_LEARNED:,} are exported",
                hint=fewer_levels(len(table.axes), MOST_LEARNED),
                span=self._learner_of(name),
                path=self.text.path,
            )

    def _file_of(self, name: str, rulebase: RuleBase) -> str:
        """Return the file of a rule base by its name in the text."""
        for use in self.text.model.uses:
            if use.name == name:
                at_axis = next(
                    (k for k, s in enumerate(self.text.sheets[name]) if s is rulebase), 0
                )
                file = use.files[min(at_axis, len(use.files) - 1)]
                return str(sheet_path(file, home_of(self.text.path)))
        return self.text.path

    def _use_of(self, name: str) -> Span:
        return next((use.span for use in self.text.model.uses if use.name == name), NOWHERE)

    def _learner_of(self, table: str) -> Span:
        """Return the last line that teaches a table."""
        spans = [line.span for line in self.text.learners() if line.table == table]
        return spans[-1] if spans else NOWHERE

    def _judge(self, name: str, table: LookupTable) -> str:
        """Return the name of a performance table; axes share one."""
        for judge, other in self.result.judges.items():
            if np.array_equal(other.values, table.values):
                return judge
        judge_name = self.names.new(name)
        self.result.judges[judge_name] = table
        return judge_name


_SUFFIXES = {"slew": "before_slew"}
"""Names of the memory of a drive in exported programs."""


def _alike(a: LookupTable, b: LookupTable) -> bool:
    """Whether the cells of two tables are the same."""
    cells = ([(axis.levels, axis.thresholds("nearest")) for axis in t.axes] for t in (a, b))
    first, second = cells
    return first == second


def _same_table(a: FloatTable | FixedTable, b: FloatTable | FixedTable) -> bool:
    """Whether two tables are one function."""
    return (
        type(a) is type(b)
        and (a.mode, a.precision, a.scales) == (b.mode, b.precision, b.scales)
        and [axis.levels for axis in a.table.axes] == [axis.levels for axis in b.table.axes]
        and all(map(np.array_equal, (*a.points, a.values), (*b.points, b.values)))
    )
