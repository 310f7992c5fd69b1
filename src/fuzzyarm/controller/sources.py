"""What fuzzy laws share: the files of their rules and tables, tables as numbers, the wiring."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.controller.law import Arithmetic, Gain, Gains
from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.kernels import kernel
from fuzzyarm.plant.arm import RATIOS, motor_torque
from fuzzyarm.plant.setting import Pair, Reference, State, stored
from fuzzyarm.shipped_files import shipped
from fuzzyarm.table import Axis, LookupTable
from fuzzyarm.table.lookup import pack_grid

if TYPE_CHECKING:
    from fuzzyarm.model.rulebase import RuleBase


# --- What all fuzzy controllers share: scaled errors in, a voltage at the motors out ---

ERROR = Gain("G_e", (108.0, 108.0), "per π rad", "position error on the scale -6 to 6")
RATE = Gain("G_ce", (10.8, 10.8), "per π rad/s", "velocity error on the scale -6 to 6")
SUPPLY = Gain("supply", (20.0,), "V", "voltage at full scale of the converter", positive=True)
FULL_SCALE = Gain(
    "full_scale", (6.0,), "1", "control at which the converter gives the supply", positive=True
)

WIRES = (ERROR, RATE, SUPPLY, FULL_SCALE)
"""In the order in which they are packed."""

WIRED = 6
"""Numbers that they take."""

STEPS = 255.0
"""Of the converter; they cancel but for rounding."""

FIRST_RATIO, SECOND_RATIO = RATIOS


@kernel
def scaled_errors(
    joint: int, reference: Reference, state: State, numbers: list[float], single: bool
) -> Pair:
    """Return position and velocity error of a joint on the scale of the rules."""
    # G_e and G_ce are per π rad, for whichever π the run has; they come divided by it.
    return (
        stored((reference.position[joint] - state.position[joint]) * numbers[joint], single),
        stored((reference.velocity[joint] - state.velocity[joint]) * numbers[2 + joint], single),
    )


@kernel
def motor_torques(control: Pair, state: State, numbers: list[float], single: bool) -> Pair:
    """Return the torque of both motors when the control drives their voltages.

    Constants: G_e (2), G_ce (2), supply, converter steps per unit of control.
    """
    # Through a converter of 8 bits that is not simulated as one: its 255 steps multiply and
    # divide again, and leave their rounding behind, which the published figures have.
    supply = numbers[4]
    first = stored(control[0] * numbers[5], single)
    second = stored(control[1] * numbers[5], single)
    return (
        stored(motor_torque(supply * first / STEPS, state.velocity[0], FIRST_RATIO), single),
        stored(motor_torque(supply * second / STEPS, state.velocity[1], SECOND_RATIO), single),
    )


def pack_wires(gains: Gains, arithmetic: Arithmetic) -> list[float]:
    """Write down the constants of :func:`motor_torques`."""
    half_turn = arithmetic.pi
    return [
        *(arithmetic.hold(value / half_turn) for value in gains["G_e"].value),
        *(arithmetic.hold(value / half_turn) for value in gains["G_ce"].value),
        gains["supply"].value[0],
        arithmetic.hold(STEPS / gains["full_scale"].value[0]),
    ]


# --- The files that fuzzy controllers take their rules and tables from ---


class SourceError(FuzzyarmError, ValueError):
    """A rule base or a table does not serve a controller."""

    def __init__(self, message: str, *, hint: str = "") -> None:
        super().__init__(message, hint=hint)


@dataclass(frozen=True)
class Sources:
    """Rule bases and tables to use in place of the shipped ones.

    Parameters
    ----------
    rulebase : RuleBase, optional
        Of the control, over e and ce.
    alpha : RuleBase, optional
        Of the factor on the control, over e and ce.
    table : LookupTable, optional
        Of the control, over e and ce; with a third input ``joint`` one for each joint.
        SOC starts from it.
    performance : LookupTable, optional
        By which SOC judges.
    """

    rulebase: RuleBase | None = None
    alpha: RuleBase | None = None
    table: LookupTable | None = None
    performance: LookupTable | None = None

    def given(self) -> tuple[str, ...]:
        """Return the names of those that are given."""
        return tuple(each.name for each in fields(self) if getattr(self, each.name) is not None)


NONE_GIVEN = Sources()
"""Everything as shipped."""


def shipped_rulebase(name: str) -> RuleBase:
    """Return a shipped rule base."""
    path = shipped(name)
    return _rulebase(path, path.stat().st_mtime_ns)


def shipped_table(name: str) -> LookupTable:
    """Return a shipped table."""
    path = shipped(name)
    return _table(path, path.stat().st_mtime_ns)


# Keyed by the time of the last change, so that an edited file counts in a long process.
@lru_cache(maxsize=16)
def _rulebase(path: Path, _changed: int) -> RuleBase:
    from fuzzyarm.language import load_rulebase

    return load_rulebase(path)


@lru_cache(maxsize=16)
def _table(path: Path, _changed: int) -> LookupTable:
    from fuzzyarm.table import read_table

    return read_table(path)


# --- Lookup tables over e and ce, one for each joint ---

JOINT = "joint"
"""Name of the input that tells the tables of the joints apart, with levels 1 and 2."""

ROW, COLUMN = "e", "ce"


@dataclass(frozen=True)
class JointTables:
    """One table for each joint, rows e, columns ce.

    Attributes
    ----------
    rows, columns : Axis
        Of e and of ce.
    values : ndarray, shape (2, rows, columns)
        Of joint 1 and joint 2.
    mode : str
        How they are looked up.
    """

    rows: Axis
    columns: Axis
    values: NDArray[np.float64]
    mode: str

    @property
    def cells(self) -> int:
        """Cells of one table."""
        return len(self.rows.levels) * len(self.columns.levels)

    def edges(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return the thresholds between rows and between columns."""
        mode = "nearest" if self.mode == "linear" else self.mode
        return self.rows.thresholds(mode), self.columns.thresholds(mode)

    def grid(self) -> list[float]:
        """Return size, thresholds and levels as the kernels of a closed loop read them."""
        return pack_grid(self.rows, self.columns, self.mode)


def joint_tables(table: LookupTable) -> JointTables:
    """Arrange a table as rows e, columns ce; one table serves both joints.

    Raises
    ------
    SourceError
        If its inputs are others than e and ce and, perhaps, joint with levels 1 and 2.
    """
    names = table.names
    if sorted(names) not in ([COLUMN, ROW], [COLUMN, ROW, JOINT]):
        raise SourceError(
            f"a controller needs a table over e and ce (and joint), not over {', '.join(names)}"
        )
    order = [names.index(name) for name in (JOINT, ROW, COLUMN) if name in names]
    values = np.transpose(table.values, order)
    if JOINT in names:
        levels = table.axis(JOINT).levels
        if levels != (1.0, 2.0):
            raise SourceError("the input joint of a table has to have the levels 1 and 2")
    else:
        values = np.stack([values, values])
    return JointTables(table.axis(ROW), table.axis(COLUMN), values, table.default_mode)


def over_joints(tables: JointTables, like: LookupTable) -> LookupTable:
    """Return both tables as one over joint, e and ce; with head and axes as `like` has them."""
    joint = Axis(JOINT, (1.0, 2.0), description="joint of the arm")
    return LookupTable(
        (joint, tables.rows, tables.columns),
        like.output,
        tables.values,
        low=like.low,
        high=like.high,
        description=like.description,
        mode=like.mode,
        provenance=like.provenance,
    )


def joined(first: LookupTable, second: LookupTable) -> LookupTable:
    """Return the tables of two joints as one.

    Raises
    ------
    SourceError
        If they do not serve, or differ in levels, bins or lookup.
    """
    one, other = joint_tables(first), joint_tables(second)
    if (one.rows.levels, one.columns.levels, one.edges(), one.mode) != (
        other.rows.levels,
        other.columns.levels,
        other.edges(),
        other.mode,
    ):
        raise SourceError("the tables of the joints differ in their levels or bins")
    values = np.stack([one.values[0], other.values[1]])
    return over_joints(JointTables(one.rows, one.columns, values, one.mode), first)


def pack_values(tables: JointTables, arithmetic: Arithmetic) -> list[float]:
    """Write down the values, joint 1 first, as they are stored."""
    return [arithmetic.hold(value) for value in tables.values.ravel().tolist()]
