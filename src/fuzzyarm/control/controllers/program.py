"""A controller as text in the form of its kernel: cells and instructions.

Their layout is described in :mod:`fuzzyarm.control.controllers.kernel`.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.control.controllers import kernel
from fuzzyarm.control.controllers.code import (
    AXIS,
    ControllerCode,
    Guard,
    Sheet,
    SourceError,
    TableCells,
    Wiring,
)
from fuzzyarm.control.controllers.law import LawBlock
from fuzzyarm.control.controllers.updates import update_address
from fuzzyarm.inference import kernel as inference_kernel
from fuzzyarm.inference.block import NotCoveredError, make_block
from fuzzyarm.inference.layout import lay_out
from fuzzyarm.inference.plan import plan
from fuzzyarm.inference.prepared import remembered
from fuzzyarm.language.model.controller import (
    Axes,
    AxisSignal,
    ControllerModel,
    Drive,
    Factor,
    Learn,
    Line,
    Product,
    SignalLine,
    Source,
    Zoom,
)
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.plant.setting import LAST, RunArithmetic, stored_double, stored_single
from fuzzyarm.symbolic.kernels import address_of
from fuzzyarm.symbolic.sources import SourceKind, argument_of
from fuzzyarm.table import Axis, LookupTable
from fuzzyarm.table.lookup import pack_grid


def write_down(
    model: ControllerModel,
    sheets: Mapping[str, Sequence[Sheet]],
    partners: Mapping[str, tuple[int, LawBlock]],
    wiring: Wiring,
    arithmetic: RunArithmetic,
) -> ControllerCode:
    """Assemble the cells and instructions of a controller.

    Parameters
    ----------
    model : ControllerModel
        Without mistakes.
    sheets : mapping
        Its rule bases and tables, one for all axes or one for each.
    partners : mapping
        Address and arrays of its partner laws.
    wiring : Wiring
        Cells of the plant's ports.
    arithmetic : RunArithmetic
        Arithmetic of the run.

    Raises
    ------
    SourceError
        If a rule base or a table is unsuitable.
    """
    return _Writer(model, sheets, partners, wiring, arithmetic).program()


_FUSED = {
    (kernel.SUBTRACT, kernel.MULTIPLY): kernel.SUBTRACT_MULTIPLY,
    (kernel.MULTIPLY, kernel.MULTIPLY): kernel.MULTIPLY_BOTH,
    (kernel.MULTIPLY, kernel.DIVIDE): kernel.MULTIPLY_DIVIDE,
}
"""Pairs of instructions that fuse if the second uses the result of the first."""


class _Writer:
    """Cells and code under construction; `axis` is the current one."""

    def __init__(
        self,
        model: ControllerModel,
        sheets: Mapping[str, Sequence[Sheet]],
        partners: Mapping[str, tuple[int, LawBlock]],
        wiring: Wiring,
        arithmetic: RunArithmetic,
    ) -> None:
        self.model = model
        self.sheets = sheets
        self.partners = partners
        self.wiring = wiring
        self.arithmetic = arithmetic
        self.code: list[int] = []
        self.lists: list[int] = []
        self.list_fields: list[int] = []  # positions in the code of the list addresses
        self.cells: list[float] = [0.0] * wiring.size
        self.parts: list[NDArray[np.float64]] = []  # blocks, after the cells
        self.parts_size = 0
        self.part_fields: list[int] = []  # positions in the lists of cells of parts
        self.numbers: dict[float, int] = {}
        self.signal_cells: dict[tuple[str, str], int] = {}  # signals of the axes
        self.gains: dict[str, tuple[int, ...]] = {}
        self.tables: dict[tuple[str, int], TableCells] = {}
        self.grids: dict[str, tuple[int, list[Axis]]] = {}
        self.learned: dict[tuple[str, str], TableCells] = {}
        self.inferences: dict[int, tuple[str, RuleBase]] = {}
        self.blocks: dict[int, KernelRuleBlock] = {}  # of the rule bases, by their identity
        self.looked_up: dict[int, tuple[str, LookupTable]] = {}
        self.updates: dict[int, SourceKind] = {}
        self.rings: list[tuple[int, int]] = []
        self.cell_signal: dict[tuple[str, int], tuple[tuple[int, ...], int]] = {}
        self.limits: dict[int, int] = {}  # state of the limit of a drive, by its identity
        self.guards: dict[str, Guard] = {}
        self.drives = self._drive_cells()
        self.last_drives: dict[int, int] = {}  # by the cell of a drive, that of its last value
        self.seen_cells: dict[tuple[str, str], int] = {}  # last values of signals read elsewhere
        self.scratch = self._cell(0.0)  # of unnamed values
        self.axis = ""
        self.index = 0
        self.every = 1

    def program(self) -> ControllerCode:
        """Assemble everything."""
        self._write_gains()
        self._write_partners()
        first: set[int] = set()
        for axes in self.model.axes:
            for name in axes.names:
                self.axis = name
                self.limits = {}
                begin = 1 + len(self.code)
                self.every = axes.every
                for port in axes.ports("drive"):
                    self.last_drives[self.drives[name, port]] = self._cell(0.0)
                for line in axes.lines:
                    self._write_line(axes, line, first)
                self._store_values(axes)
                self._guard(axes, begin)
                self.index += 1
        self._join_drives()
        return self._finished()

    # --- The guard of an axis ---

    def _drive_cells(self) -> dict[tuple[str, str], int]:
        """Return the cells of the drives; axes with a common input have their own."""
        wired = self.wiring.drives
        shared = Counter(wired.values())
        return {
            address: cell if shared[cell] == 1 else self._cell(0.0)
            for address, cell in wired.items()
        }

    def _join_drives(self) -> None:
        """Add up the drives of axes with a common input."""
        begun: set[int] = set()
        for address, cell in self.wiring.drives.items():
            own = self.drives[address]
            if own != cell:
                self._emit(kernel.ADD, cell, cell if cell in begun else self._number(0.0), own)
                begun.add(cell)

    def _store_values(self, axes: Axes) -> None:
        """Store the last value of a signal or drive read elsewhere or later; it must be finite."""
        for signal in self.model.seen_elsewhere(self.axis):
            state = self._cell(0.0, math.inf, 0.0)
            self._emit(kernel.SLEW, self._cell(0.0), self.signal_cells[self.axis, signal], state)
            self.seen_cells[self.axis, signal] = state + kernel.LAST_DRIVE
        for port in axes.remembered_drives():
            cell = self.drives[self.axis, port]
            self._emit(kernel.SUBTRACT, self._cell(0.0), cell, cell)  # NaN if infinite
            self.code[-1] = 1

    def _guard(self, axes: Axes, begin: int) -> None:
        """Add the guard of an axis around its instructions."""
        reads = tuple(
            cells[self.axis, port]
            for cells, kind in (
                (self.wiring.references, "reference"), (self.wiring.measured, "measured"),
            )
            for port in axes.ports(kind)
        )  # fmt: skip
        drives: dict[int, int] = {}
        for port, (idle, sent) in skipped_drives(axes, self.arithmetic.hold).items():
            cell = self.drives[self.axis, port]
            start = self.wiring.starts.get((self.axis, port))
            self.cells[cell] = idle if start is None else self.arithmetic.hold(start)
            self.cells[self.last_drives[cell]] = self.cells[cell]
            drives[cell] = self.last_drives[cell] if sent is None else self._number(sent)
        end, count = 1 + len(self.code), self._cell(0.0)
        turn = self._cell(0.0) if axes.every > 1 else count
        self.guards[self.axis] = Guard(begin, end, count, axes.every, turn, reads, drives)

    def _guard_list(self) -> list[int]:
        """Return the list of guards, the first of all lists."""
        cells = dict.fromkeys(cell for guard in self.guards.values() for cell in guard.reads)
        stored = stored_single if self.arithmetic.single else stored_double
        addresses = [
            address_of(function, "if", {"stored": stored}, compiled=self.arithmetic.compiled)
            for function in (kernel.step_guarded, kernel.settle)
        ]
        last = [cell for pair in self.last_drives.items() for cell in pair]
        slow = any(guard.every > 1 for guard in self.guards.values())
        items = [*addresses, int(slow or bool(self.seen_cells))]
        items += [len(cells), len(self.last_drives), *cells, *last]
        for guard in self.guards.values():
            items += [guard.begin, guard.end, guard.count, guard.every, guard.turn]
            items += [len(guard.reads), len(guard.drives)]
            items += [*guard.reads, *(cell for pair in guard.drives.items() for cell in pair)]
        return [*items, 0]

    def _finished(self) -> ControllerCode:
        guards = self._guard_list()
        # Lists and blocks were addressed from their own base, known only now: lists follow the
        # count, the instructions and the guards; blocks follow the cells.
        begin = 1 + len(self.code) + len(guards)
        for field in self.list_fields:
            self.code[field] += begin
        for field in self.part_fields:
            self.lists[field] += len(self.cells)
        code = [len(self.code) // kernel.INSTRUCTION, *self.code, *guards, *self.lists]
        cells = np.concatenate([np.array(self.cells), *self.parts])
        return ControllerCode(
            code,
            cells,
            dict(self.signal_cells),
            dict(self.learned),
            tuple(self.rings),
            self.gains,
            self.inferences,
            self.looked_up,
            self.updates,
            self.guards,
            self.last_drives,
        )

    # --- Cells, instructions, lists ---

    def _cell(self, *values: float) -> int:
        """Add cells; return the first."""
        at = len(self.cells)
        self.cells += values
        return at

    def _number(self, value: float) -> int:
        """Return the cell of a constant."""
        if value not in self.numbers:
            self.numbers[value] = self._cell(value)
        return self.numbers[value]

    def _emit(self, operation: int, into: int, a: int, b: int = 0, c: int = 0) -> int:
        """Add an instruction, or fuse it with the one before; return the target cell."""
        before = self.code[-kernel.INSTRUCTION :]
        # Two instructions through the scratch cell fuse into one, unless the first rounds its
        # result: fused, that rounding would be lost.
        fused = _FUSED.get((before[0], operation)) if before else None
        if fused is not None and into == before[1] == a == self.scratch and not before[5]:
            self.code[-kernel.INSTRUCTION :] = [fused, into, before[2], before[3], b, 0]
        else:
            self.code += [operation, into, a, b, c, 0]
        return into

    def _move(self, into: int, cell: int, *, rounded: bool) -> None:
        """Move a value to another cell; if possible the last instruction writes there directly."""
        # Of the last instruction code[-5] is the target and code[-1] the rounding flag.
        if cell != self.scratch or self.code[-5] != cell:
            self._emit(kernel.COPY, into, cell)
        self.code[-5] = into
        self.code[-1] = int(rounded)

    def _list(self, field: int, items: Sequence[int]) -> None:
        """Add a list; operand `field` of the last instruction is its begin."""
        position = len(self.code) - kernel.INSTRUCTION + field
        self.code[position] = len(self.lists)
        self.list_fields.append(position)
        self.lists += items

    # --- Names ---

    def _write_gains(self) -> None:
        count = len(self.model.axis_names)
        for gain in self.model.gains:
            values = [amount.value(self.arithmetic.pi) for amount in gain.values]
            stored = [self.arithmetic.hold(value) for value in values]
            stored = stored * count if len(stored) == 1 else stored
            self.gains[gain.name] = tuple(self._cell(value) for value in stored)

    def _write_partners(self) -> None:
        """Run each law once; both axes read its results."""
        for name, (address, block) in self.partners.items():
            numbers = self._cell(*map(float, block.numbers))
            memory = self._cell(*map(float, block.memory))
            self._emit(kernel.PARTNER, self.scratch, 0)
            ends = [numbers, numbers + len(block.numbers), memory, memory + len(block.memory)]
            self._list(2, [address, *ends, 0, 0])
            links = len(self.lists)
            self.lists += block.links
            self.lists[links - 2], self.lists[links - 1] = links, links + len(block.links)
            for axis, cell in zip(self.model.axis_names, self.wiring.partners, strict=False):
                self.signal_cells[axis, name] = self._emit(kernel.COPY, self._cell(0.0), cell)

    def _operand(self, value: str | float) -> int:
        """Return the cell of a number, a signal or a gain."""
        if not isinstance(value, str):
            return self._number(float(value))
        if value in self.gains:
            return self.gains[value][self.index]
        return self._signal(value)

    def _signal(self, name: str) -> int:
        """Return the cell of a signal."""
        if isinstance(name, AxisSignal):
            return self.seen_cells[name.axis, name.signal]
        return self.signal_cells[self.axis, name]

    # --- Lines ---

    def _write_line(self, axes: Axes, line: Line, first: set[int]) -> None:
        if isinstance(line, SignalLine):
            self._write_signal(axes, line)
        elif isinstance(line, Zoom):
            self._write_zoom(line)
        elif isinstance(line, Learn):
            self._write_learn(line)
        else:
            self._write_drive(line, first)

    def _write_signal(self, axes: Axes, line: SignalLine) -> None:
        source = line.source
        if source is None:
            self._store(line.names[0], self._sum(line.products))
        elif source.kind == "rules":
            self._write_rules(line, source)
        else:
            value = self._source(axes, line, source)
            (product,) = line.products or (Product(()),)
            self._store(line.names[0], self._factors(value, product.factors))

    def _store(self, name: str, cell: int) -> None:
        into = self.signal_cells.setdefault((self.axis, name), self._cell(0.0))
        self._move(into, cell, rounded=True)

    def _factors(self, cell: int, factors: Sequence[Factor]) -> int:
        for factor in factors:
            operation = kernel.DIVIDE if factor.divides else kernel.MULTIPLY
            cell = self._emit(operation, self.scratch, cell, self._operand(factor.value))
        return cell

    def _sum(self, products: Sequence[Product]) -> int:
        total = -1
        for product in products:
            first, *others = product.factors
            cell = self._factors(self._operand(first.value), others)
            if total < 0 and not product.negative:
                # A later product must not overwrite this one.
                total = cell if len(products) == 1 else self._copy(cell)
                continue
            before = self._number(0.0) if total < 0 else total
            operation = kernel.SUBTRACT if product.negative else kernel.ADD
            total = self._emit(operation, self._cell(0.0), before, cell)
        return total

    def _copy(self, cell: int) -> int:
        return self._emit(kernel.COPY, self._cell(0.0), cell)

    def _source(self, axes: Axes, line: SignalLine, source: Source) -> int:
        """Write the instructions of a source; return the cell of its value."""
        period = axes.every * self.model.period
        kind = source.sized(period)
        if kind.of == "call":
            return self._look_up(source)
        cell = self._operand_of(source)
        if kind.function is None:
            return cell
        options = dict(source.options)
        arguments = {"last": LAST}
        if axes.every > 1:
            arguments["period"] = self._number(period)
        settings = kind.settings(options)
        if kind.windup:
            settings |= {"excess": 0.0, "gain": 0.0}
            drive = axes.driven_by(line.names[0]) if settings[argument_of(kind.windup)] else None
            if drive is None:
                settings[argument_of(kind.windup)] = 0.0
            else:
                if cell == self.scratch:  # where the gain may be computed
                    cell = self._copy(cell)
                arguments["excess"] = self._limit_state(drive) + kernel.OVER
                arguments["gain"] = self._gain_of_drive(axes, line, drive)
        arguments |= {
            name: self._operand(value) for name, value in settings.items() if isinstance(value, str)
        }
        filled = 1 + len(kind.states)
        numbers = [settings.get(name, 0.0) for name in kind.inputs]
        constants = [float(x) if not isinstance(x, str) else 0.0 for x in numbers]
        states = kind.starts(options)
        frame = self._cell(0.0, *states, *constants, *states)
        self.updates[frame] = kind
        fetches = [
            (cell, arguments[name])
            for cell, name in enumerate(kind.inputs, frame + filled)
            if name in arguments
        ]
        self._emit(kernel.UPDATE, self.scratch, 0, frame, cell)
        address = update_address(kind, compiled=self.arithmetic.compiled)
        head = [address, filled, int(kind.rounded), frame + filled + len(constants), len(fetches)]
        self._list(2, [*head, *(cell for pair in fetches for cell in pair)])
        return self.scratch

    def _operand_of(self, source: Source) -> int:
        """Return the cell of a source's operand: a signal, or a value of a port."""
        of = (self.axis, source.name)
        ports = source.record.ports
        if not ports:
            return self._operand(source.name)
        values = {"reference": self.wiring.references, "measured": self.wiring.measured}
        if source.kind == "driven":
            last = self._copy(self.last_drives[self.drives[of]])
            self.code[-1] = 1
            return last
        if len(ports) == 1:
            return values[ports[0]][of]
        set_point = self.wiring.references[of]
        weight = source.option("weight")
        if isinstance(weight, str | float):
            set_point = self._emit(kernel.MULTIPLY, self.scratch, set_point, self._operand(weight))
        return self._emit(kernel.SUBTRACT, self.scratch, set_point, self.wiring.measured[of])

    def _gain_of_drive(self, axes: Axes, line: SignalLine, drive: Drive) -> int:
        """Return the cell of a drive's sensitivity to an integral; 1 if not constant."""
        products = axes.gain_of(line.names[0], drive, self.gains)
        if not products:
            return self._number(1.0 if products is None else 0.0)
        if len(products) == 1 and len(products[0].factors) == 1 and not products[0].negative:
            return self._operand(products[0].factors[0].value)
        into = self._cell(0.0)
        self._move(into, self._sum(products), rounded=False)
        return into

    def _write_zoom(self, line: Zoom) -> None:
        self._emit(kernel.ZOOM, self.scratch, 0, len(line.signals))
        numbers = [self._operand(line.by), self._operand(line.inside), int(line.wait)]
        self._list(2, [*numbers, *map(self._signal, line.signals)])

    def _write_drive(self, line: Drive, first: set[int]) -> None:
        cell = self._sum(line.products)
        if line.within is not None:
            remembers = int(id(line) in self.limits)
            cell = self._emit(kernel.LIMIT, self.scratch, cell, self._limit_state(line), remembers)
        if line.slew is not None:
            steepest = line.slew * self.every
            cell = self._emit(kernel.SLEW, self.scratch, cell, self._cell(0.0, steepest, 0.0))
        port = self.drives[self.axis, line.port]
        # The first drive of a port sets it, the others add to it, in the order of the text.
        if port in first:
            self._emit(kernel.ADD, port, port, cell)
        else:
            self._move(port, cell, rounded=False)
        first.add(port)

    def _limit_state(self, drive: Drive) -> int:
        low, high = drive.within or (-math.inf, math.inf)
        if id(drive) not in self.limits:
            self.limits[id(drive)] = self._cell(low, high, 0.0, 0.0)
        return self.limits[id(drive)]

    # --- Rule bases and tables ---

    def _sheet(self, name: str) -> Sheet:
        sheets = self.sheets[name]
        return sheets[self.index if len(sheets) > 1 else 0]

    def _write_rules(self, line: SignalLine, source: Source) -> None:
        rulebase = self._sheet(source.name)
        if not isinstance(rulebase, RuleBase):
            raise SourceError(f"'{source.name}' is a table: write table {source.name}(…)")
        # All axes may use one rule base: laid out once, copied for each.
        if id(rulebase) not in self.blocks:
            block = rule_block(rulebase, compiled=self.arithmetic.compiled)
            self.blocks[id(rulebase)] = block
        numbers, first_input, first_result, address = self.blocks[id(rulebase)]
        begin = self.parts_size
        self.parts.append(numbers)
        self.parts_size += len(numbers)
        holds = [output.no_rule == "hold" for output in rulebase.outputs]
        # Before a rule fires there is no value to hold.
        results = [
            self._cell(math.nan, math.nan) if holds_output else self._cell(0.0)
            for holds_output in holds
        ]
        self.inferences[results[0]] = (source.name, rulebase)
        inputs = self._inputs(rulebase, source.inputs)
        self._emit(kernel.INFER, self.scratch, 0, address)
        at = len(self.lists)
        self._list(
            2,
            [
                begin,
                self.parts_size,
                first_input,
                first_result,
                len(inputs),
                len(results),
                *inputs,
                *results,
                *map(int, holds),
            ],
        )
        self.part_fields += [at + kernel.BEGIN, at + kernel.END]
        (product,) = line.products or (Product(()),)
        for name, cell in zip(line.names, results, strict=True):
            self._store(name, self._factors(cell, product.factors))

    def _inputs(self, rulebase: RuleBase, names: Sequence[str]) -> list[int]:
        """Return the cells of a rule base's inputs; one called `AXIS` is the axis' number."""
        waiting = iter(names)
        cells = []
        for variable in rulebase.inputs:
            if variable.name == AXIS and AXIS not in names:
                cells.append(self._number(self.index + 1.0))
            else:
                cells.append(self._signal(next(waiting)))
        return cells

    def _look_up(self, source: Source) -> int:
        inputs = tuple(map(self._signal, source.inputs))
        cells = self._table_cells(source.name)
        grid, axes = self.grids[source.name]
        cell = self.cell_signal.get((source.name, self.index))
        if cell is not None and cell[0] == inputs:
            return self._emit(kernel.LOOK_UP_CELL, self.scratch, cell[1], cells.values)
        linear = self.cells[grid + 1] != 0.0
        size = len(axes) + 2 ** len(axes) if linear else len(axes)
        scratch = self._cell(*[0.0] * size)
        self._emit(kernel.LOOK_UP, self.scratch, 0, grid)
        self._list(2, [cells.values, scratch, *inputs])
        return self.scratch

    def _write_learn(self, line: Learn) -> None:
        cells = self._table_cells(line.table)
        grid, axes = self.grids[line.table]
        if self.cells[grid + 1] != 0.0:
            raise SourceError("a table that is interpolated has no responsible cell to correct")
        judge = self._table_cells(line.judge)
        judge_grid, judge_axes = self.grids[line.judge]
        alike = [(a.levels, a.thresholds("nearest")) for a in axes] == [
            (a.levels, a.thresholds("nearest")) for a in judge_axes
        ]
        ring = self._cell(0.0, *[-1.0] * line.delay)
        self.rings.append((ring, ring + 1 + line.delay))
        visits = self._cell(*[0.0] * cells.count)
        inputs = tuple(map(self._signal, line.inputs))
        cell = self._emit(kernel.LEARN, self._cell(0.0), 0)
        tables = [grid, judge_grid, judge.values, int(alike)]
        numbers = [self._operand(line.rate), self._operand(line.bound)]
        last_indices = [self._cell(*[0.0] * len(inputs)) for _ in range(2)]
        last_indices.append(self._cell(-1.0, 0.0, 0.0, 0.0))
        ring_and_rate = [ring, line.delay, *numbers]
        self._list(2, [cells.values, visits, *ring_and_rate, *tables, *last_indices, *inputs])
        self.cell_signal[line.table, self.index] = (inputs, cell)
        self.learned[self.axis, line.table] = TableCells(cells.values, visits, cells.count)

    def _table_cells(self, name: str) -> TableCells:
        """Write a table, once for each axis."""
        key = (name, self.index)
        if key not in self.tables:
            table = self._sheet(name)
            if isinstance(table, RuleBase):
                raise SourceError(f"'{name}' is a rule base: write rules {name}(…)")
            axes, values = of_axis(table, self.index)
            if name not in self.grids or len(self.sheets[name]) > 1:
                self.grids[name] = (self._cell(*pack_grid(axes, table.default_mode)), axes)
            stored = [self.arithmetic.hold(value) for value in values.ravel().tolist()]
            self.tables[key] = TableCells(self._cell(*stored), 0, len(stored))
            of_this_axis = replace(table, axes=tuple(axes), values=values)
            self.looked_up[self.tables[key].values] = (name, of_this_axis)
        return self.tables[key]


def skipped_drives(
    axes: Axes, hold: Callable[[float], float], event: str = "nan"
) -> dict[str, tuple[float, float | None]]:
    """Return for each port its value before the first period, and that in an event.

    Parameters
    ----------
    axes : Axes
        Lines of an axis; several drives of a port add up.
    hold : callable
        Rounds a value for storage.
    event : str
        One of `EVENTS`.

    Returns
    -------
    dict
        None as the second value means the last one.
    """
    drives: dict[str, tuple[float, float | None]] = {}
    for line in axes.lines:
        if isinstance(line, Drive):
            idle, sent = drives.get(line.port, (0.0, None))
            value = dict(line.events).get(event)
            if isinstance(value, float):
                sent = hold((sent or 0.0) + value)
            drives[line.port] = hold(idle + line.idle), sent
    return drives


class KernelRuleBlock(NamedTuple):
    """A rule base for the kernel at a point: numbers, indices of inputs and results, the kernel."""

    numbers: NDArray[np.float64]
    first_input: int
    first_result: int
    address: int


def rule_block(rulebase: RuleBase, *, compiled: bool) -> KernelRuleBlock:
    """Lay out a rule base for :func:`inference_address`; its numbers stay unchanged."""
    return _compiled_block(rulebase) if compiled else _interpreted_block(rulebase)


@remembered
def _compiled_block(rulebase: RuleBase) -> KernelRuleBlock:
    return _rule_block(rulebase, compiled=True)


@remembered
def _interpreted_block(rulebase: RuleBase) -> KernelRuleBlock:
    return _rule_block(rulebase, compiled=False)


def _rule_block(rulebase: RuleBase, *, compiled: bool) -> KernelRuleBlock:
    try:
        layout = lay_out(plan(rulebase), compiled=compiled, point_only=True)
    except NotCoveredError as error:
        raise SourceError(
            f"a controller cannot evaluate '{rulebase.name}' at every step: {error}",
            hint="compile it to a table and look it up in that",
        ) from None
    block = make_block(layout, 1)
    numbers = np.asarray(block.numbers)
    address = inference_address(numbers, compiled=compiled)
    return KernelRuleBlock(numbers, block.columns, block.results, address)


def evaluate_view(block: Any) -> None:
    """Evaluate a rule base as plain Python, over the memory view of an interpreted loop."""
    inference_kernel.evaluate(np.asanyarray(block))


def inference_address(numbers: NDArray[np.float64], *, compiled: bool) -> int:
    """Return the address of the inference kernel for a rule base."""
    if not compiled:
        return address_of(evaluate_view, 1, compiled=False)
    bindings = inference_kernel.bindings_for(numbers)
    return address_of(inference_kernel.evaluate, 1, bindings, compiled=True)


def of_axis(table: LookupTable, index: int) -> tuple[list[Axis], NDArray[np.float64]]:
    """Return axes and values of a table; of a table over all axes the part of one."""
    axes = [table.axis(name) for name in table.names]
    if AXIS not in table.names:
        return axes, np.asarray(table.values)
    at = table.names.index(AXIS)
    levels = axes[at].levels
    if index >= len(levels) or levels != tuple(float(i + 1) for i in range(len(levels))):
        raise SourceError(f"the input {AXIS} of a table has the levels 1, 2 … for the axes")
    return [*axes[:at], *axes[at + 1 :]], np.take(table.values, index, axis=at)
