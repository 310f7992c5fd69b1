"""A controller as steps with named variables: a walk over the instructions of its kernel.

What an instruction computes is read from the kernel itself (:mod:`fuzzyarm.export.reading`);
here its cells get names, and what is more than arithmetic (asking a rule base, looking up,
learning) becomes its own step. C and Structured Text print the steps; run in Python
(:mod:`fuzzyarm.export.replica`) they are the model of the exported program, to the bit and in
its precision.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from dataclasses import replace as with_values
from functools import cached_property, reduce
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fuzzyarm.controller import kernel as at
from fuzzyarm.controller.program import ControllerCode, SourceError, Wiring, write_down
from fuzzyarm.controller.text import ControllerText, sheet_path, wiring_of
from fuzzyarm.export.names import Names, identifier
from fuzzyarm.export.numbers import ExportError, Precision, precision_named
from fuzzyarm.export.reading import read
from fuzzyarm.export.routine import Routine
from fuzzyarm.export.rulebase import direct_routine
from fuzzyarm.export.sets import TABLE_HINT
from fuzzyarm.export.table import MOST_CELLS, TableRoutine, fewer_levels
from fuzzyarm.export.table_numbers import (
    FixedTable,
    FloatTable,
    fixed_table,
    float_table,
)
from fuzzyarm.expression import op
from fuzzyarm.expression.evaluation import specialise
from fuzzyarm.expression.nodes import (
    Apply,
    Constant,
    Node,
    Symbol,
    apply,
    as_node,
    children,
    postorder,
    replace,
    substituted,
    symbol,
    symbols,
)
from fuzzyarm.expression.operations import OPERATIONS
from fuzzyarm.expression.sources import VALUE, unseen
from fuzzyarm.model.controller import ControllerModel
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.plant.setting import LAST as LAST_PERIOD
from fuzzyarm.plant.setting import PERIOD, RunArithmetic
from fuzzyarm.table import LookupTable
from fuzzyarm.table.lookup import GRID_HEAD, INPUTS, THRESHOLDS, VALUES, next_axis
from fuzzyarm.text.diagnostic import NOWHERE, Span

MOST_STEPS = 20_000
"""Instructions of a controller, which are written out one after the other."""

MOST_LEARNED = 0xFFFF
"""Cells of a table that learns: an `unsigned` holds their index on every machine."""

LAST = "last"
"""Symbol of a condition: the last period of a set point."""


def first_of(axis: str) -> str:
    """Return the symbol of a condition: the first period that an axis does not skip."""
    return f"first:{axis}"


def limited_value() -> Node:
    """Return what a cell that learns holds: a value within ± bound, as the kernel has it."""
    limited: Node = op.minimum(op.maximum(symbol("value"), -symbol("bound")), symbol("bound"))
    return limited


# --- Variables ---


class StepVariable(NamedTuple):
    """A number of the controller that lasts from step to step, or a port.

    Attributes
    ----------
    sort : str
        ``reference``, ``measured``, ``drive``, ``signal``, ``state`` or ``gain``.
    axis : str
        Empty of a gain for all axes.
    name : str
        In the text; of a state what it is made of.
    start : float
        Before the first step.
    wide : bool
        Whether it is kept as it was computed, not rounded to the type of signals.
    number : int
        Of a gain with a value for each axis, the number of the axis; else -1.
    """

    sort: str
    axis: str
    name: str
    start: float = 0.0
    wide: bool = False
    number: int = -1

    @property
    def symbol(self) -> str:
        """What stands for it in expressions."""
        number = f"[{self.number}]" if self.number >= 0 else ""
        return f"{self.sort}:{self.axis}:{self.name}{number}"


@dataclass(frozen=True)
class LearningTable:
    """A table that learns: it lies in memory, beside it how often its cells were in use.

    Attributes
    ----------
    axis, name : str
        Of the text.
    values : tuple of float
        Before the first step.
    delay : int
        Cells remembered in its ring.
    """

    axis: str
    name: str
    values: tuple[float, ...]
    delay: int


Grid = tuple[tuple[str, tuple[float, ...]], ...]
"""Of each input of a table its name and the thresholds between its cells."""

# --- Steps ---


class Set(NamedTuple):
    """Set a variable, or a local one (``local:NAME:NUMBER``), to a value."""

    target: str
    value: Node
    rounded: bool = False


class Ask(NamedTuple):
    """Set a local variable to what a routine gives for some symbols."""

    target: str
    routine: str  # a key of `Steps.routines`
    inputs: tuple[str, ...]


class Find(NamedTuple):
    """Find the cell of a table, by the thresholds of a grid."""

    target: str  # the local variable for its number
    grid: str  # a key of `Steps.grids`
    inputs: tuple[str, ...]


class Pick(NamedTuple):
    """Set a local variable to the value of a cell of a table that learns."""

    target: str
    table: str  # a key of `Steps.learned`
    cell: str


class Teach(NamedTuple):
    """Correct a table that learns."""

    table: str
    cell: str
    judge: str  # a key of `Steps.judges`: the performance table
    judged: str  # the cell of the performance table
    rate: Node
    bound: Node


Step = Set | Ask | Find | Pick | Teach


class Guard(NamedTuple):
    """What stands around the steps of an axis.

    Attributes
    ----------
    axis : str
        Whose steps they are.
    reads : tuple of str
        Symbols of its ports; where one is not a number, the steps are skipped.
    drives : dict of str to float or None
        By the symbol of each drive, what it is in a skipped period; None: its last value.
    """

    axis: str
    reads: tuple[str, ...]
    drives: Mapping[str, float | None]

    @property
    def condition(self) -> Node:
        """Whether all values that it reads are numbers."""
        numbers: list[Node] = [op.equal(symbol(name), symbol(name)) for name in self.reads]
        return reduce(lambda a, b: a & b, numbers)

    @property
    def sent(self) -> dict[str, float]:
        """By the symbol of a drive, what it is in a skipped period if not its last value."""
        return {name: value for name, value in self.drives.items() if value is not None}


class Block(NamedTuple):
    """Steps in order, all of one axis where they have a guard.

    `begun` are the axes of whose first period these are the last steps.
    """

    guard: Guard | None
    steps: tuple[Step, ...]
    begun: tuple[str, ...]


@dataclass
class Steps:
    """A controller as an exported program.

    Attributes
    ----------
    model : ControllerModel
        What the text says.
    precision : Precision
        Types of signals, of gains and of the arithmetic; `wide` is that of the arithmetic.
    variables : dict of str to StepVariable
        By symbol, in the order of the cells.
    steps : list of Step
        Of one period.
    routines : dict of str to Routine
        Rule bases and tables that stay as they are, by the name of their function.
    sheets : dict
        By the same names, a rule base and its output, or a table.
    scales : dict
        Of routines in whole numbers, those of their inputs and of the result.
    grids : dict of str to Grid
        By the name of the function that finds a cell of a table in memory.
    grid_tables : dict of str to LookupTable
        By the same names, a table on that grid.
    learned : dict of str to LearningTable
        Tables that learn.
    judges : dict of str to LookupTable
        Performance tables.
    needs_last : bool
        Whether it matters when a set point ends.
    needs_first : dict of str to None
        Axes for which it matters which period is the first one.
    guards : list of (Guard, int, int)
        Each with the range of its steps.
    """

    model: ControllerModel
    precision: Precision
    variables: dict[str, StepVariable] = field(default_factory=dict)
    steps: list[Step] = field(default_factory=list)
    routines: dict[str, Routine] = field(default_factory=dict)
    sheets: dict[str, tuple[RuleBase, str] | LookupTable] = field(default_factory=dict)
    grids: dict[str, Grid] = field(default_factory=dict)
    grid_tables: dict[str, LookupTable] = field(default_factory=dict)
    learned: dict[str, LearningTable] = field(default_factory=dict)
    judges: dict[str, LookupTable] = field(default_factory=dict)
    needs_last: bool = False
    needs_first: dict[str, None] = field(default_factory=dict)
    guards: list[tuple[Guard, int, int]] = field(default_factory=list)

    def blocks(self) -> Iterator[Block]:
        """Yield all steps, by their guards."""
        at, left = 0, dict(self.needs_first)
        for guard, begin, end in self.guards:
            if at < begin:
                yield Block(None, tuple(self.steps[at:begin]), ())
            begun = (guard.axis,) if guard.axis in left else ()
            left.pop(guard.axis, None)
            yield Block(guard, tuple(self.steps[begin:end]), begun)
            at = end
        if at < len(self.steps) or left:
            yield Block(None, tuple(self.steps[at:]), tuple(left))

    def of_sort(self, sort: str) -> list[StepVariable]:
        """Return the variables of a sort, in order."""
        return [variable for variable in self.variables.values() if variable.sort == sort]

    @property
    def single(self) -> bool:
        """Whether signals are stored in single precision."""
        return self.precision.outside is np.float32

    @cached_property
    def calls_functions(self) -> bool:
        """Whether a routine calls functions whose last bits may differ between libraries."""
        return any(getattr(routine, "calls_functions", False) for routine in self.routines.values())


class RoutineOptions(NamedTuple):
    """How rule bases and tables are exported.

    Attributes
    ----------
    q : int or None
        Tables in whole numbers of so many bits; else as the signals are.
    widened : bool
        Whether rule bases compute in double precision within what is found in that only.
    """

    q: int | None = None
    widened: bool = False


def steps_of(
    text: ControllerText, precision: str = "float64", options: RoutineOptions | None = None
) -> Steps:
    """Return a controller as steps.

    Parameters
    ----------
    text : ControllerText
        Without mistakes and partners.
    precision : str
        ``float64``; ``mixed``: signals and gains in single, arithmetic in double precision;
        ``float32``.
    options : RoutineOptions, optional
        Of its tables.

    Raises
    ------
    ExportError
        If it has a partner, or something in it cannot be exported.
    """
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
    types = precision_named(precision, arithmetic=True)
    wiring = wiring_of(model)
    arithmetic = RunArithmetic(types.outside is np.float32, math.pi, False)
    try:
        # No inference is called while the instructions are read: any address will do.
        program = write_down(model, text.sheets, {}, wiring, arithmetic)
    except SourceError as error:
        raise ExportError(error.message, hint=error.hint, path=text.path) from None
    if program.code[0] > MOST_STEPS:
        raise ExportError(
            f"{program.code[0]:,} instructions are more than {MOST_STEPS:,}",
            hint="export parts of it as separate controllers",
        )
    return _Walk(text, program, wiring, types, options or RoutineOptions()).steps()


class _Walk:
    """The walk over the instructions; it is also what kernels take for their cells."""

    def __init__(
        self,
        text: ControllerText,
        program: ControllerCode,
        wiring: Wiring,
        types: Precision,
        options: RoutineOptions,
    ) -> None:
        self.text, self.program, self.options = text, program, options
        self.result = Steps(text.model, types)
        self.code = program.code
        self.symbols: dict[int, str] = {PERIOD: "period"}
        self.unseen: set[str] = set()  # states that are NaN before the first period
        self.locals = 0
        self.stored: list[tuple[int, Node, bool]] = []
        self.scratch: dict[int, str] = {}  # of cells without a name, the local that has the value
        self.routine_names: dict[tuple[int, str], str] = {}
        self.names = Names()
        self.state_names = Names()
        for sort, cells in (
            ("reference", wiring.references),
            ("measured", wiring.measured),
            ("drive", wiring.drives),
        ):
            for (axis, port), cell in cells.items():
                self._variable(cell, StepVariable(sort, axis, port))
        self.drives = {self.symbols[cell]: cell for cell in wiring.drives.values()}
        self._gains()
        self.signals = {cell: key for key, cell in program.signals.items()}

    def steps(self) -> Steps:
        """Walk."""
        begin = 1
        for axis, guard in self.program.guards.items():
            self._run(begin, guard.begin)
            first_step = len(self.result.steps)
            self._run(guard.begin, guard.end)
            guarded = self._guard(axis)
            self._drive(guarded.drives)
            self.result.guards.append((guarded, first_step, len(self.result.steps)))
            begin = guard.end
        self._run(begin, 1 + at.INSTRUCTION * self.code[0])
        driven = {name for guard, *_ in self.result.guards for name in guard.drives}
        self._drive(name for name in self.drives if name not in driven)
        return self.result

    def _run(self, begin: int, end: int) -> None:
        for first in range(begin, end, at.INSTRUCTION):
            self._instruction(first, *self.code[first : first + at.INSTRUCTION])

    def _guard(self, axis: str) -> Guard:
        guard = self.program.guards[axis]
        drives = {self.symbols[cell]: value for cell, value in guard.drives.items()}
        for name in drives:
            variable = self.result.variables[name]
            start = float(self.program.cells[self.drives[name]])
            self.result.variables[name] = variable._replace(start=start)
        return Guard(axis, tuple(self.symbols[cell] for cell in guard.reads), drives)

    def _drive(self, names: Iterable[str]) -> None:
        """Drives of one port add up in the arithmetic of the run; the sum is rounded once."""
        for name in names:
            value = symbol(self.scratch[self.drives[name]])
            self.result.steps.append(Set(name, value, rounded=True))

    # --- Names ---

    def _variable(self, cell: int, variable: StepVariable) -> str:
        self.result.variables[variable.symbol] = variable
        self.symbols[cell] = variable.symbol
        return variable.symbol

    def _gains(self) -> None:
        for gain in self.text.model.gains:
            several = len(gain.values) > 1
            for number, cell in enumerate(self.program.gains[gain.name]):
                start = float(self.program.cells[cell])
                axis_number = number if several else -1
                self._variable(cell, StepVariable("gain", "", gain.name, start, number=axis_number))

    def _state(self, cell: int, suffix: str, begin: int) -> None:
        """Name a cell that an instruction changes, after the signal that it works for."""
        if cell in self.symbols:  # the excess of a limit that an integral reads
            return
        axis, base = self._works_for(begin)
        start = float(self.program.cells[cell])
        name = self.state_names.new(f"{axis}_{base}_{suffix}").removeprefix(f"{identifier(axis)}_")
        # No language has NaN for what has seen nothing yet: the first period is known.
        nothing = math.isnan(start)
        variable = StepVariable("state", axis, name, 0.0 if nothing else start, wide=True)
        symbol = self._variable(cell, variable)
        if nothing:
            self.unseen.add(symbol)

    def _works_for(self, begin: int) -> tuple[str, str]:
        """Return axis and name of the next signal or drive that is written."""
        for other in range(begin, 1 + at.INSTRUCTION * self.code[0], at.INSTRUCTION):
            into = self.code[other + 1]
            if into in self.signals:
                return self.signals[into]
            variable = self.result.variables.get(self.symbols.get(into, ""))
            if variable is not None:
                return variable.axis, variable.name
        raise AssertionError("the result of an instruction is not used")

    def _local(self, name: str = "") -> str:
        """Return the symbol of a new local variable."""
        self.locals += 1
        return f"local:{name or 't'}:{self.locals}"

    # --- What kernels ask for (`Cells`) ---

    def load(self, index: int) -> Any:
        """Return the symbol of a cell that changes, else its number."""
        if index in self.scratch:
            return symbol(self.scratch[index])
        if index == LAST_PERIOD:
            self.result.needs_last = True
            return symbol(LAST)
        if index == PERIOD:
            return self.text.model.period
        if index in self.symbols:
            return symbol(self.symbols[index])
        return float(self.program.cells[index])

    def is_nan(self, value: Node) -> Node:
        """Return the condition that a value is not a number, or nothing yet."""
        nan: Node = ~op.equal(value, value)
        if isinstance(value, Symbol) and value.name in self.unseen:
            return self._first(value.name) | nan
        return nan

    def _first(self, state: str) -> Node:
        """Return the condition that the axis of a state runs for the first time."""
        axis = self.result.variables[state].axis
        self.result.needs_first[axis] = None
        return symbol(first_of(axis))

    def is_not_zero(self, value: Node) -> Node:
        """Return the condition that a value is not 0; the clock has conditions, not numbers."""
        condition: Node = value if value is symbol(LAST) else ~op.equal(value, 0.0)
        return condition

    def store(self, index: int, value: Any) -> None:
        """Take down what an instruction writes, for `_flush`."""
        self.stored.append((index, as_node(value), False))

    def rounded(self, value: Any) -> Any:
        """Give a value that is rounded its own variable."""
        if not self.result.single or self.result.precision.wide is np.float32:
            return value
        name = self._local()
        self.result.steps.append(Set(name, as_node(value), rounded=True))
        return symbol(name)

    def _flush(self) -> None:
        """Add the steps that write what was taken down: every value is of the time before."""
        writes, self.stored = self.stored, []
        values = [value for _, value, _ in writes]
        while (node := _shared(values)) is not None:
            name = self._local()
            self.result.steps.append(Set(name, node))
            values = [substituted(value, node, symbol(name)) for value in values]
        set_before: set[str] = set()
        ready = []
        for (cell, _, rounded), value in zip(writes, values, strict=True):
            if not set_before.isdisjoint(symbols(value)):
                name = self._local()
                self.result.steps.append(Set(name, value))
                value = symbol(name)  # noqa: PLW2901
            ready.append((cell, value, rounded))
            set_before.add(self.symbols.get(cell, ""))
        for cell, value, rounded in ready:
            self._set(cell, value, rounded=rounded)

    def _set(self, cell: int, value: Node, *, rounded: bool) -> None:
        if cell in self.signals and cell not in self.symbols:
            axis, name = self.signals[cell]
            self._variable(cell, StepVariable("signal", axis, name))
        target = self.symbols.get(cell)
        if target is None and isinstance(value, Symbol) and value.name.startswith("local:"):
            self.scratch[cell] = value.name
            return
        if target is None or target in self.drives:
            variable = self.result.variables.get(target or "")
            hint = f"{variable.axis}_{variable.name}" if variable is not None else ""
            target = self.scratch[cell] = self._local(hint)
        elif not rounded and self.result.variables[target].sort == "signal":
            # What `zoom` writes is not rounded: it is kept as it is.
            self.result.variables[target] = self.result.variables[target]._replace(wide=True)
        self.result.steps.append(Set(target, value, rounded))

    # --- Instructions ---

    def _instruction(
        self, begin: int, what: int, into: int, a: int, b: int, c: int, rounded: int
    ) -> None:
        if what <= at.SUBTRACT_MULTIPLY:
            value = read(at.combined, self, what, *(self.load(cell) for cell in (a, b, c)))
        elif what in (at.LIMIT, at.SLEW):
            for offset, suffix in at.REMEMBERED[what]:
                self._state(b + offset, suffix, begin)
            function = at.limited if what == at.LIMIT else at.slewed
            value = read(function, self, self, self.load(a), b)
        elif what == at.UPDATE:
            value = self._updated(a, b, c, begin)
        elif what == at.ZOOM:
            read(at.zoom, self, self.code, self, a, b)
            self._flush()
            return
        elif what == at.INFER:
            self._ask(a)
            return
        elif what == at.LEARN:
            self._teach(a, into)
            return
        else:
            value = self._looked_up(what, a, b)
        # What it makes comes first, then what it remembers.
        self.stored.insert(0, (into, as_node(value), bool(rounded)))
        self._flush()

    def _updated(self, list_begin: int, frame: int, x: int, begin: int) -> Node:
        """Return what a source gives; what it remembers is taken down."""
        kind = self.program.updates[frame]
        begin_of_pairs = list_begin + at.FETCHES
        count = 2 * self.code[list_begin + at.FETCHED]
        pairs = self.code[begin_of_pairs : begin_of_pairs + count]
        first = frame + 1 + len(kind.states)
        fetched = {first: x, first + 1: PERIOD, **dict(zip(pairs[::2], pairs[1::2], strict=True))}
        arguments: dict[str, Any] = {}
        for cell, state in enumerate(kind.states, frame + 1):
            self._state(cell, state.name, begin)
            arguments[state.name] = self.load(cell)
        for input_cell, name in enumerate(kind.inputs, first):
            cell = fetched.get(input_cell, input_cell)
            if name == "excess":
                self._excess(cell, begin)
            arguments[name] = self.load(cell)
        node = self._argued(kind.expression, arguments)
        if kind.rounded:
            node = as_node(self.rounded(node))
        for cell, root in enumerate(kind.nexts, frame + 1):
            self.store(cell, replace(self._argued(root, arguments), {VALUE: node}))
        return node

    def _argued(self, root: Node, arguments: dict[str, Any]) -> Node:
        """Return an expression of an update with its arguments, and what follows from them."""
        numbers = {name: x for name, x in arguments.items() if not isinstance(x, Node)}
        root = replace(_without_endless_limits(specialise(root, numbers)), arguments)
        for state in self.unseen & set(symbols(root)):
            nan = unseen(symbol(state))
            if nan in postorder(root):
                root = substituted(root, nan, self._first(state) | nan)
        return root

    def _excess(self, cell: int, begin: int) -> None:
        """Name what a source reads of a limit that comes later."""
        for other in range(begin, 1 + at.INSTRUCTION * self.code[0], at.INSTRUCTION):
            if self.code[other] == at.LIMIT and self.code[other + 3] + at.OVER == cell:
                self._state(cell, at.REMEMBERED[at.LIMIT][0].suffix, other)

    def _input(self, cell: int) -> str:
        """Return the symbol of a cell; a number is put into a variable."""
        value = self.load(cell)
        if not isinstance(value, Node):
            name = self._local()
            self.result.steps.append(Set(name, as_node(value)))
            return name
        assert isinstance(value, Symbol)
        return value.name

    def _inner(self) -> str:
        """Return the precision of functions within the controller."""
        return "float32" if self.result.precision.wide is np.float32 else "float64"

    def _ask(self, begin: int) -> None:
        count, results = self.code[begin + at.COUNT_INPUTS], self.code[begin + at.COUNT_RESULTS]
        cells = self.code[begin + at.INFER_CELLS : begin + at.INFER_CELLS + count + results]
        name, rulebase = self.program.rulebases[cells[count]]
        inputs = tuple(self._input(cell) for cell in cells[:count])
        for output, cell in zip(rulebase.outputs, cells[count:], strict=True):
            key = (id(rulebase), output.name)
            if key not in self.routine_names:
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
            self.scratch[cell] = self._local()
            self.result.steps.append(Ask(self.scratch[cell], self.routine_names[key], inputs))

    def _routine(self, stem: str, routine: Routine) -> str:
        name = self.names.new(stem)
        self.result.routines[name] = routine
        return name

    def _looked_up(self, what: int, a: int, b: int) -> Node:
        """Return the symbol of what a table says."""
        target = self._local()
        if what == at.LOOK_UP_CELL:
            self.result.steps.append(Pick(target, self._learned(b), self.scratch[a]))
            return symbol(target)
        values = self.code[a + VALUES]
        name, table = self.program.tables[values]
        inputs = tuple(self._input(cell) for cell in self._inputs_of(a + INPUTS, b))
        if any(place.values == values for place in self.program.learned.values()):
            cell = self._found(b, table, name, inputs)
            self.result.steps.append(Pick(target, self._learned(values), cell))
        else:
            self.result.steps.append(Ask(target, self._table(values, inputs), inputs))
        return symbol(target)

    def _inputs_of(self, begin: int, grid: int) -> list[int]:
        count = int(self.program.cells[grid])
        assert grid + GRID_HEAD <= len(self.program.cells)
        return self.code[begin : begin + count]

    def _table(self, values: int, inputs: Sequence[str]) -> str:
        """Return the name of the routine of a table; axes with the same one share it."""
        name, table = self.program.tables[values]
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

    def _learned(self, values: int) -> str:
        for (axis, name), place in self.program.learned.items():
            if place.values == values:
                return f"{axis}:{name}"
        raise AssertionError("a table that does not learn is a routine")

    def _found(self, begin: int, table: LookupTable, name: str, inputs: tuple[str, ...]) -> str:
        """Add the step that finds a cell; return the local with its number."""
        grid = self._grid(begin, table)
        keys = {other: key for key, other in self.result.grids.items()}
        if grid not in keys:
            keys[grid] = self.names.new(f"{name}_cell")
            self.result.grids[keys[grid]] = grid
            self.result.grid_tables[keys[grid]] = table
        target = self._local()
        self.result.steps.append(Find(target, keys[grid], inputs))
        return target

    def _grid(self, begin: int, table: LookupTable) -> Grid:
        """Read a grid out of the cells."""
        axes, at_axis = [], begin + GRID_HEAD
        for axis in table.axes:
            count = int(self.program.cells[at_axis])
            # The infinities at either end are left out: an export counts only what lies between.
            first = at_axis + THRESHOLDS + 1
            thresholds = self.program.cells[first : first + count - 1]
            axes.append((axis.name, tuple(map(float, thresholds))))
            at_axis = next_axis(at_axis, count)
        return tuple(axes)

    def _teach(self, begin: int, into: int) -> None:
        if self.options.q is not None:
            raise ExportError(
                "a table that learns is exported in floating point",
                hint="leave out --q",
                span=next(self.text.learners()).span,
                path=self.text.path,
            )
        entries = self.code[begin : begin + at.LEARN_INPUTS]
        values = entries[VALUES]
        (key,) = (k for k, place in self.program.learned.items() if place.values == values)
        name = f"{key[0]}:{key[1]}"
        place = self.program.learned[key]
        if name in self.result.learned:
            raise ExportError(
                f"two lines teach the table '{key[1]}' of axis '{key[0]}'; one is exported",
                hint="leave one of them out, or give each its own table",
                span=self._learner_of(key[1]),
                path=self.text.path,
            )
        if place.count > MOST_LEARNED:
            raise ExportError(
                f"the table '{key[1]}' learns in {place.count:,} cells; at most {MOST_LEARNED:,}"
                " are exported",
                hint=fewer_levels(len(self.program.tables[values][1].axes), MOST_LEARNED),
                span=self._learner_of(key[1]),
                path=self.text.path,
            )
        start = self.program.cells[values : values + place.count]
        delay = entries[at.DELAY]
        self.result.learned[name] = LearningTable(*key, tuple(map(float, start)), delay)
        table, judge = self.program.tables[values][1], self.program.tables[entries[at.JUDGE]]
        cells = self._inputs_of(begin + at.LEARN_INPUTS, entries[at.GRID])
        inputs = tuple(self._input(cell) for cell in cells)
        cell = judged = self._found(entries[at.GRID], table, key[1], inputs)
        if entries[at.ALIKE] == 0:
            judged = self._found(entries[at.JUDGE_GRID], judge[1], judge[0], inputs)
        judge_name = self._judge(*judge)
        rate, bound = (as_node(self.load(entries[field])) for field in (at.GAIN, at.BOUND))
        self.result.steps.append(Teach(name, cell, judge_name, judged, rate, bound))
        self.scratch[into] = cell

    def _file_of(self, name: str, rulebase: RuleBase) -> str:
        """Return the file in which a rule base stands that the text calls by a name."""
        for use in self.text.model.uses:
            if use.name == name:
                at_axis = next(
                    (k for k, s in enumerate(self.text.sheets[name]) if s is rulebase), 0
                )
                file = use.files[min(at_axis, len(use.files) - 1)]
                return str(sheet_path(file, Path(self.text.path).parent))
        return self.text.path

    def _use_of(self, name: str) -> Span:
        return next((use.span for use in self.text.model.uses if use.name == name), NOWHERE)

    def _learner_of(self, table: str) -> Span:
        """Return the last line that teaches a table."""
        spans = [line.span for line in self.text.learners() if line.table == table]
        return spans[-1] if spans else NOWHERE

    def _judge(self, name: str, table: LookupTable) -> str:
        """Return what a performance table is called; axes share one."""
        for judge, other in self.result.judges.items():
            if np.array_equal(other.values, table.values):
                return judge
        judge_name = self.names.new(name)
        self.result.judges[judge_name] = table
        return judge_name


def _without_endless_limits(root: Node) -> Node:
    """Return an expression without limits at infinity, which change no number."""
    nodes: dict[Node, Node] = {}
    for node in postorder(root):
        nodes[node] = (
            apply(node.operation, *(nodes[child] for child in node.arguments))
            if isinstance(node, Apply)
            else node
        )
        if isinstance(node, Apply) and node.operation == "where":
            condition, value, limit = node.arguments
            endless = isinstance(limit, Constant) and math.isinf(limit.value)
            compared = condition.arguments if isinstance(condition, Apply) else ()
            if endless and set(compared) == {value, limit}:
                nodes[node] = nodes[value]
    return nodes[root]


def _same_table(a: FloatTable | FixedTable, b: FloatTable | FixedTable) -> bool:
    """Whether two tables are one function."""
    return (
        type(a) is type(b)
        and (a.mode, a.precision, a.scales) == (b.mode, b.precision, b.scales)
        and [axis.levels for axis in a.table.axes] == [axis.levels for axis in b.table.axes]
        and all(map(np.array_equal, (*a.points, a.values), (*b.points, b.values)))
    )


def _shared(roots: Sequence[Node]) -> Node | None:
    """Return an innermost part used more than once; a condition does not become a variable."""
    nodes = list(postorder(*roots))
    uses = Counter(child for node in nodes for child in children(node))
    uses.update(roots)
    for node in nodes:
        condition = isinstance(node, Apply) and OPERATIONS[node.operation].is_condition
        if isinstance(node, Apply) and uses[node] > 1 and not condition:
            return node
    return None
