"""What all fuzzy controllers share: scaled errors in, a voltage at the motors out."""

from __future__ import annotations

from fuzzyarm.arm.motor import RATIOS, motor_torque
from fuzzyarm.arm.signals import Pair, State, stored
from fuzzyarm.control.gains import Gain, Gains
from fuzzyarm.control.law import Arithmetic
from fuzzyarm.kernels import kernel

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
def scaled(wanted: float, actual: float, gain: float, single: bool) -> float:
    """Return an error on the scale of the rules."""
    return stored((wanted - actual) * gain, single)


@kernel
def driven(control: Pair, state: State, numbers: list[float], at: int, single: bool) -> Pair:
    """Return the torque of both motors when the control drives their voltages.

    Constants: G_e (2), G_ce (2), supply, converter steps per unit of control.
    """
    supply = numbers[at + 4]
    first = stored(control[0] * numbers[at + 5], single)
    second = stored(control[1] * numbers[at + 5], single)
    return (
        stored(motor_torque(supply * first / STEPS, state.velocity[0], FIRST_RATIO), single),
        stored(motor_torque(supply * second / STEPS, state.velocity[1], SECOND_RATIO), single),
    )


def pack_wires(gains: Gains, arithmetic: Arithmetic) -> list[float]:
    """Write down the constants of :func:`driven`."""
    half_turn = arithmetic.pi
    return [
        *(arithmetic.hold(value / half_turn) for value in gains["G_e"].value),
        *(arithmetic.hold(value / half_turn) for value in gains["G_ce"].value),
        gains["supply"].value[0],
        arithmetic.hold(STEPS / gains["full_scale"].value[0]),
    ]
