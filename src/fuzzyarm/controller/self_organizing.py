"""Self-organizing control: a lookup table that a performance table corrects (section 6.3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.controller.law import SELF_ORGANIZING, Arithmetic, Gain, Gains, Law
from fuzzyarm.controller.sources import (
    WIRED,
    WIRES,
    JointTables,
    SourceError,
    driven,
    joint_tables,
    pack_values,
    pack_wires,
    scaled,
)
from fuzzyarm.kernels import kernel
from fuzzyarm.plant.setting import Clock, Pair, Reference, State, stored
from fuzzyarm.table import LookupTable
from fuzzyarm.table.lookup import cell_of, grid_length

LEARNING = Gain(
    "learning_rate", (1.0,), "1", "share of the performance value that corrects; 0: no learning"
)
DELAY = Gain("delay", (1.0,), "control periods", "how long ago the responsible cell was in use")
BOUND = Gain("bound", (6.0,), "1", "largest magnitude of a cell", positive=True)

LONGEST_DELAY = 1000


@kernel
def self_organizing_torque(
    reference: Reference,
    state: State,
    clock: Clock,
    numbers: list[float],
    at: int,
    memory: list[float],
    cell: int,
) -> Pair:
    """Correct the responsible cell of each joint, then look the control up.

    Constants: wires, learning rate, delay, bound, whether both grids are alike, grid of the
    tables, grid and values of the performance table. Memory: place in the ring, the last
    `delay` cells of both joints, the tables of joints 1 and 2, and how often each of their
    cells was used.
    """
    delay = int(numbers[at + WIRED + 1])
    alike = numbers[at + WIRED + 3] != 0.0
    grid = at + WIRED + 4
    judge = grid + grid_length(numbers, grid)
    judged = judge + grid_length(numbers, judge)
    cells = int(numbers[grid]) * int(numbers[grid + 1])
    ring = cell + 1
    table = ring + 2 * delay
    place = int(memory[cell])

    e = scaled(reference.position[0], state.position[0], numbers[at], clock.single)
    ce = scaled(reference.velocity[0], state.velocity[0], numbers[at + 2], clock.single)
    now = cell_of(numbers, grid, e, ce)
    judgement = numbers[judged + (now if alike else cell_of(numbers, judge, e, ce))]
    responsible = now if delay == 0 else int(memory[ring + place])
    correct(memory, table, responsible, judgement, numbers, at, clock.single)
    first = memory[table + now]
    memory[table + 2 * cells + now] += 1.0
    if delay > 0:
        memory[ring + place] = now

    e = scaled(reference.position[1], state.position[1], numbers[at + 1], clock.single)
    ce = scaled(reference.velocity[1], state.velocity[1], numbers[at + 3], clock.single)
    now = cell_of(numbers, grid, e, ce)
    judgement = numbers[judged + (now if alike else cell_of(numbers, judge, e, ce))]
    responsible = now if delay == 0 else int(memory[ring + delay + place])
    correct(memory, table + cells, responsible, judgement, numbers, at, clock.single)
    second = memory[table + cells + now]
    memory[table + 3 * cells + now] += 1.0
    if delay > 0:
        memory[ring + delay + place] = now
        memory[cell] = place + 1 if place + 1 < delay else 0
    return driven((first, second), state, numbers, at, clock.single)


@kernel
def correct(
    memory: list[float],
    table: int,
    responsible: int,
    judgement: float,
    numbers: list[float],
    at: int,
    single: bool,
) -> None:
    """Add the judgement to the responsible cell, if there is one yet, within the bound."""
    rate = numbers[at + WIRED]
    if responsible >= 0 and rate != 0.0:
        bound = numbers[at + WIRED + 2]
        value = stored(memory[table + responsible] + rate * judgement, single)
        memory[table + responsible] = min(max(value, -bound), bound)


def self_organizing_law(start: LookupTable | None, performance: LookupTable) -> Law:
    """Make the law.

    Parameters
    ----------
    start : LookupTable or None
        Where the tables begin; None: zero, on the grid of the performance table.
    performance : LookupTable
        The judgement of e and ce.

    Raises
    ------
    SourceError
        If a table does not serve.
    """
    judge = joint_tables(performance)
    if not np.array_equal(judge.values[0], judge.values[1]):
        raise SourceError("one performance table judges both joints")
    begin = starting_tables(start, judge)

    def pack(gains: Gains, arithmetic: Arithmetic) -> list[float]:
        own = [gains[name].value[0] for name in ("learning_rate", "delay", "bound")]
        _check(own[1])
        alike = begin.edges() == judge.edges()
        front = [*pack_wires(gains, arithmetic), *own, float(alike)]
        values = pack_values(judge, arithmetic)[: judge.cells]
        return [*front, *begin.grid(), *judge.grid(), *values]

    def remember(gains: Gains, arithmetic: Arithmetic) -> list[float]:
        delay = int(gains["delay"].value[0])
        visits = [0.0] * (2 * begin.cells)
        return [0.0, *[-1.0] * (2 * delay), *pack_values(begin, arithmetic), *visits]

    return Law(
        "soc",
        SELF_ORGANIZING,
        "self-organizing control: a lookup table that learns from a performance table",
        (*WIRES, LEARNING, DELAY, BOUND),
        pack=pack,
        remember=remember,
    )


def starting_tables(start: LookupTable | None, judge: JointTables) -> JointTables:
    """Return the tables to begin with."""
    if start is not None:
        tables = joint_tables(start)
        if tables.mode == "linear":
            raise SourceError("a table that is interpolated has no responsible cell to correct")
        return tables
    return JointTables(judge.rows, judge.columns, np.zeros_like(judge.values), judge.mode)


def _check(delay: float) -> None:
    if delay != int(delay) or not 0 <= delay <= LONGEST_DELAY:
        raise SourceError(
            f"a delay of {delay:g} control periods is out of sense",
            hint=f"a whole number from 0 to {LONGEST_DELAY}",
        )


@dataclass(frozen=True)
class Learned:
    """What a self-organizing controller remembers.

    Attributes
    ----------
    values : ndarray, shape (2, rows, columns)
        The tables of both joints.
    visits : ndarray of int64, same shape
        How often each cell was used.
    """

    values: NDArray[np.float64]
    visits: NDArray[np.int64]

    def readable(self, *, single: bool) -> Learned:
        """Return the tables without the last digits that only rounding made.

        Parameters
        ----------
        single : bool
            Whether they were kept in single precision; 6 decimals are kept then, otherwise 12.
        """
        decimals = 6 if single else 12
        return Learned(np.round(self.values, decimals) + 0.0, self.visits)  # + 0.0: no -0


def learned(memory: list[float], delay: int, shape: tuple[int, int]) -> Learned:
    """Read the memory of the law.

    Parameters
    ----------
    memory : list of float
        See :func:`self_organizing_torque`.
    delay : int
        As run.
    shape : tuple of int
        Rows and columns of a table.
    """
    numbers = np.array(memory[1 + 2 * delay :]).reshape(2, 2, *shape)
    return Learned(numbers[0], numbers[1].astype(np.int64))
