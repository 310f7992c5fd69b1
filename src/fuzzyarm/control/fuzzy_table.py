"""Fuzzy control by a lookup table (section 6.1)."""

from __future__ import annotations

from fuzzyarm.arm.signals import Clock, Pair, Reference, State
from fuzzyarm.control import kinds
from fuzzyarm.control.gains import Gains
from fuzzyarm.control.law import Arithmetic, Law
from fuzzyarm.control.table_numbers import (
    cell_of,
    grid_length,
    interpolated,
    joint_tables,
    pack_grid,
    pack_values,
)
from fuzzyarm.control.wiring import WIRED, WIRES, driven, pack_wires, scaled
from fuzzyarm.kernels import kernel
from fuzzyarm.lut import LookupTable


@kernel
def fuzzy_table_torque(
    reference: Reference, state: State, clock: Clock, numbers: list[float], at: int
) -> Pair:
    """Return the motors' torque at the voltage that the tables name for e and ė.

    Constants: wires, grid, values of joint 1, values of joint 2.
    """
    grid = at + WIRED
    values = grid + grid_length(numbers, grid)
    cells = int(numbers[grid]) * int(numbers[grid + 1])
    e_1 = scaled(reference.position[0], state.position[0], numbers[at], clock.single)
    e_2 = scaled(reference.position[1], state.position[1], numbers[at + 1], clock.single)
    ce_1 = scaled(reference.velocity[0], state.velocity[0], numbers[at + 2], clock.single)
    ce_2 = scaled(reference.velocity[1], state.velocity[1], numbers[at + 3], clock.single)
    if numbers[grid + 2] != 0.0:
        control = (
            interpolated(numbers, grid, values, e_1, ce_1),
            interpolated(numbers, grid, values + cells, e_2, ce_2),
        )
    else:
        control = (
            numbers[values + cell_of(numbers, grid, e_1, ce_1)],
            numbers[values + cells + cell_of(numbers, grid, e_2, ce_2)],
        )
    return driven(control, state, numbers, at, clock.single)


def fuzzy_table_law(table: LookupTable) -> Law:
    """Make the law of a table over e and ce, or of one for each joint."""
    tables = joint_tables(table)

    def pack(gains: Gains, arithmetic: Arithmetic) -> list[float]:
        wires = pack_wires(gains, arithmetic)
        return [*wires, *pack_grid(tables), *pack_values(tables, arithmetic)]

    summary = "fuzzy control by a lookup table, through motors with back-EMF"
    return Law("fuzzy-lut", kinds.FUZZY_TABLE, summary, WIRES, pack=pack)
