"""Self-organizing control: a lookup table that a performance table corrects (section 6.3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.controller.law import Arithmetic, Gain, Gains, Law
from fuzzyarm.controller.sources import (
    WIRED,
    WIRES,
    JointTables,
    SourceError,
    joint_tables,
    motor_torques,
    pack_values,
    pack_wires,
    scaled_errors,
)
from fuzzyarm.kernels import kernel
from fuzzyarm.plant.setting import Moment, Pair, stored
from fuzzyarm.table import LookupTable
from fuzzyarm.table.lookup import cell_of, grid_length

LEARNING = Gain(
    "learning_rate",
    (1.0,),
    "1",
    "share of the performance value that corrects; 0: no learning",
    bounds=(0.0, 10.0),
)
DELAY = Gain("delay", (1.0,), "control periods", "how long ago the responsible cell was in use")
BOUND = Gain("bound", (6.0,), "1", "largest magnitude of a cell", positive=True)

LONGEST_DELAY = 1000


@kernel
def self_organizing_torque(
    now: Moment, numbers: list[float], memory: list[float], links: list[int]
) -> Pair:
    """Correct the responsible cell of each joint, then look the control up.

    Constants: wires, learning rate, delay, bound, whether both grids are alike, grid of the
    tables, grid and values of the performance table. Memory: index in the rings, the last
    `delay` cells of joint 1 and of joint 2 (each a ring), the tables of both joints, and how
    often each of their cells was used.
    """
    # Both joints first, then the ring moves on: they share its index.
    _, state, _, clock = now
    control = (
        corrected_control(0, now, numbers, memory),
        corrected_control(1, now, numbers, memory),
    )
    delay = int(numbers[WIRED + 1])
    if delay > 0:
        memory[0] = (memory[0] + 1.0) % delay
    return motor_torques(control, state, numbers, clock.single)


@kernel
def corrected_control(joint: int, now: Moment, numbers: list[float], memory: list[float]) -> float:
    """Correct the cell that is responsible for e and ė of one joint, return the one for now."""
    reference, state, _, clock = now
    rate = numbers[WIRED]
    delay = int(numbers[WIRED + 1])
    bound = numbers[WIRED + 2]
    alike = numbers[WIRED + 3] != 0.0
    grid = WIRED + 4
    judge = grid + grid_length(numbers, grid)
    judged = judge + grid_length(numbers, judge)
    cells = int(numbers[grid]) * int(numbers[grid + 1])
    latest = 1 + joint * delay + int(memory[0])  # in the ring of this joint
    table = 1 + 2 * delay + joint * cells
    visits = table + 2 * cells

    # The study's order: the cell in use `delay` periods ago is corrected by how the state is now,
    # and only then the control is looked up; with delay 0 that is the corrected value itself.
    e, ce = scaled_errors(joint, reference, state, numbers, clock.single)
    cell = cell_of(numbers, grid, e, ce)
    judgement = numbers[judged + (cell if alike else cell_of(numbers, judge, e, ce))]
    responsible = cell if delay == 0 else int(memory[latest])
    if responsible >= 0 and rate != 0.0:  # none is, before the first delay is over
        value = stored(memory[table + responsible] + rate * judgement, clock.single)
        memory[table + responsible] = min(max(value, -bound), bound)
    memory[visits + cell] += 1.0
    # What `delay` periods from now is responsible takes the place of what has been judged.
    if delay > 0:
        memory[latest] = cell
    return memory[table + cell]


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
        self_organizing_torque,
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
            f"a delay of {delay:g} control periods is out of range",
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
