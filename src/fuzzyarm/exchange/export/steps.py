"""A controller as steps with named variables, the order of its exported program.

Operations beyond arithmetic (a rule base, a look-up, learning) are separate steps.
:mod:`fuzzyarm.exchange.export.walk_of_steps` makes the steps of a text,
:mod:`fuzzyarm.exchange.export.controller_lowering` a program of the steps.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, reduce
from typing import NamedTuple

import numpy as np

from fuzzyarm.exchange.export.numbers import Precision
from fuzzyarm.exchange.export.routine import Routine
from fuzzyarm.language.model.controller import ControllerModel
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.nodes import Node, symbol, symbols
from fuzzyarm.table import LookupTable

LAST = "last"
"""Symbol of a condition: the last period of a set point."""


def first_of(axis: str) -> str:
    """Return the symbol of a condition: the first period that an axis does not skip."""
    return f"first:{axis}"


def turn_of(axis: str) -> str:
    """Return the symbol of a counter: the periods since the last run of a slow axis."""
    return f"turn:{axis}"


def last_of(drive: str) -> str:
    """Return the symbol of the last value of a drive."""
    return f"held {drive}"


def limited_value() -> Node:
    """Return the value of a learning cell, clipped to ± bound as in the kernel."""
    limited: Node = op.minimum(op.maximum(symbol("value"), -symbol("bound")), symbol("bound"))
    return limited


# --- Variables ---


class StepVariable(NamedTuple):
    """A number of the controller that persists from step to step, or a port."""

    sort: str  # ``reference``, ``measured``, ``drive``, ``signal``, ``state`` or ``gain``
    axis: str  # empty of a gain for all axes
    name: str  # name in the text; of a state, the name of its origin
    start: float = 0.0  # before the first step
    wide: bool = False  # whether it is stored as computed, not rounded to the type of signals
    number: int = -1  # of a gain with a value for each axis, the number of the axis; else -1

    @property
    def symbol(self) -> str:
        """Its symbol in expressions."""
        number = f"[{self.number}]" if self.number >= 0 else ""
        return f"{self.sort}:{self.axis}:{self.name}{number}"


@dataclass(frozen=True)
class LearningTable:
    """A learning table, with the visits of its cells beside it in memory."""

    # Of the text.
    axis: str
    name: str
    values: tuple[float, ...]  # before the first step
    delay: int  # cells remembered in its ring


Grid = tuple[tuple[str, tuple[float, ...]], ...]
"""Of each input of a table its name and the thresholds between its cells."""

# --- Steps ---


class Set(NamedTuple):
    """Set a variable, or a local one (``local:NAME:NUMBER``), to a value."""

    target: str
    value: Node
    rounded: bool = False


class Ask(NamedTuple):
    """Assign a local variable the result of a routine for some symbols."""

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


def _reads(step: Step) -> Iterator[str]:
    """Yield the symbols read by a step."""
    if isinstance(step, Set):
        yield from symbols(step.value)
    elif isinstance(step, Ask | Find):
        yield from step.inputs
    elif isinstance(step, Pick):
        yield step.cell
    else:
        yield from (step.cell, step.judged, *symbols(step.rate), *symbols(step.bound))


class Guard(NamedTuple):
    """The frame of the steps of an axis."""

    axis: str  # whose steps they are
    reads: tuple[str, ...]  # symbols of its ports; NaN in one of them skips the steps
    # By the symbol of each drive, its value in a skipped period; None: its last value.
    drives: Mapping[str, float | None]
    # Symbols that must not be NaN, or must be finite, at the end of the steps: else the steps are
    # undone.
    numbers: tuple[str, ...]
    finite: tuple[str, ...]
    every: int = 1  # the periods from one run of the steps to the next

    @property
    def condition(self) -> Node | None:
        """Whether all its inputs are numbers."""
        return _all([_is_number(name) for name in self.reads])

    @property
    def settled(self) -> Node | None:
        """Whether the period counts: results are numbers, new states finite."""
        finite: list[Node] = [op.equal(symbol(x) - symbol(x), 0.0) for x in self.finite]
        return _all([*map(_is_number, self.numbers), *finite])

    @property
    def sent(self) -> dict[str, float]:
        """By the symbol of a drive, its value in a skipped period, if not the last one."""
        return {name: value for name, value in self.drives.items() if value is not None}


def _is_number(name: str) -> Node:
    found: Node = op.equal(symbol(name), symbol(name))
    return found


def _all(conditions: Sequence[Node]) -> Node | None:
    return reduce(lambda a, b: a & b, conditions) if conditions else None


class Block(NamedTuple):
    """The steps of an axis in order, with its state updates in a period that counts."""

    guard: Guard
    steps: tuple[Step, ...]
    lasting: tuple[Set, ...]


@dataclass
class Steps:
    """A controller as an exported program."""

    model: ControllerModel  # the model of the text
    # Types of signals, of gains and of the arithmetic; `wide` is that of the arithmetic.
    precision: Precision
    # By symbol, in the order of the cells.
    variables: dict[str, StepVariable] = field(default_factory=dict)
    steps: list[Step] = field(default_factory=list)  # of one period
    # Rule bases and tables that stay as they are, by the name of their function.
    routines: dict[str, Routine] = field(default_factory=dict)
    # By the same names, a rule base and its output, or a table.
    sheets: dict[str, tuple[RuleBase, str] | LookupTable] = field(default_factory=dict)
    # By the name of the function that finds a cell of a table in memory.
    grids: dict[str, Grid] = field(default_factory=dict)
    # By the same names, a table on that grid.
    grid_tables: dict[str, LookupTable] = field(default_factory=dict)
    learned: dict[str, LearningTable] = field(default_factory=dict)  # tables that learn
    judges: dict[str, LookupTable] = field(default_factory=dict)  # performance tables
    needs_last: bool = False  # whether it matters when a set point ends
    # Axes for which it matters which period is the first one.
    needs_first: dict[str, None] = field(default_factory=dict)
    # Symbols of drives with a stored value: read later, or held between two runs.
    remembered: dict[str, None] = field(default_factory=dict)
    blocks: list[Block] = field(default_factory=list)  # one for each axis

    def uses(self) -> Counter[str]:
        """Count the reads of each symbol."""
        lasting = (step for block in self.blocks for step in block.lasting)
        return Counter(
            [
                *(name for step in (*self.steps, *lasting) for name in _reads(step)),
                *(x for block in self.blocks for x in block.guard.numbers + block.guard.finite),
            ]
        )

    def of_sort(self, sort: str) -> list[StepVariable]:
        """Return the variables of a sort, in order."""
        return [variable for variable in self.variables.values() if variable.sort == sort]

    @property
    def port_sorts(self) -> list[str]:
        """The sorts of its ports, in the order of a step's arguments."""
        return [sort for sort in ("reference", "measured", "drive") if self.of_sort(sort)]

    def port_name(self, port: StepVariable) -> str:
        """Return the name of a port: ``port`` of one axis, ``axis.port`` of several."""
        return port.name if self.model.has_one_axis else f"{port.axis}.{port.name}"

    def port_names(self, sort: str) -> list[str]:
        """Return the names of the ports of a sort."""
        return list(map(self.port_name, self.of_sort(sort)))

    @property
    def single(self) -> bool:
        """Whether signals are stored in single precision."""
        return self.precision.outside is np.float32

    @cached_property
    def calls_functions(self) -> bool:
        """Whether a routine calls functions whose last bits may differ between libraries."""
        return any(getattr(routine, "calls_functions", False) for routine in self.routines.values())
