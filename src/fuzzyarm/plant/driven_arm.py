"""The arm with its motors as a plant: torques or voltages in, positions and velocities out."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from copy import copy
from dataclasses import fields
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.plant.arm import (
    LOADED,
    PLANT_SIZE,
    RATIOS,
    RESISTANCE,
    TORQUE_CONSTANT,
    UNITS,
    UNLOADED,
    ArmParameters,
    constants,
    motor_torque,
    runge_kutta,
    semi_implicit,
)
from fuzzyarm.plant.drawings import draw_arm
from fuzzyarm.plant.plant import (
    ACTUATE,
    ADVANCE,
    IN_SINGLE,
    MEASURE,
    PARTS,
    STEP,
    TASK,
    Address,
    DriveOptions,
    Dynamics,
    Parameter,
    Particulars,
    Plant,
    Port,
    parameter,
)
from fuzzyarm.plant.setting import (
    STUDY_TIMING,
    Pair,
    Pose,
    RunArithmetic,
    State,
    pose_of,
    stored,
    stored_double,
    stored_single,
)
from fuzzyarm.plant.trajectory import TRAJECTORIES, Trajectory, through
from fuzzyarm.symbolic.kernels import kernel

JOINTS = ("joint1", "joint2")

ERROR_BOUND = 20.0 * math.pi
"""Largest tracking error without divergence: ten turns, rad."""

SPEED_BOUND = 1e5
"""Largest joint velocity without divergence, rad/s."""

FARTHEST = 60.0
"""Largest angle of a random way point, degrees."""

PACES = (15.0, 25.0)
"""Mean speeds of the longest part of a random move, degrees a second; the study's moves have 18 and
22.5. Faster ones need more voltage than the motors have, and show nothing of a controller."""

UNLIMITED = (math.inf, math.inf)
"""The study's joints have no torque limits."""

POSITION = Port("rad", -2 * math.pi, 2 * math.pi, bound=math.inf, error_bound=ERROR_BOUND)

ROOM = 10
"""Numbers of the states and the scratch after them, see the kernels."""

POSES = 4
"""Outputs after the ports: cos θ1, sin θ2, cos θ2, cos(θ1 + θ2), shared by the laws."""


class Arm(Plant):
    """The two-link arm of the study, driven by motor voltages or joint torques.

    Parameters
    ----------
    arm : ArmParameters, optional
        Masses, lengths, inertias, friction.
    torque_limits : pair of float, optional
        Joint torque limits, N m.
    inductance : float, optional
        Armature inductance of each motor, H; 0 for an immediate current.
    supply : float, optional
        Largest motor voltage, V. A commanded torque then passes through the motor, too: as the
        voltage that would produce it without inductance.
    """

    name = "arm"
    longest_step = STUDY_TIMING.period
    summary = "the study's two-link arm: torque or motor voltage to joint positions"
    trajectories = TRAJECTORIES
    compared_along = ("reach-return", "pick-and-place")
    draw = draw_arm

    def __init__(
        self,
        arm: ArmParameters = UNLOADED,
        *,
        torque_limits: Pair = UNLIMITED,
        inductance: float = 0.0,
        supply: float = math.inf,
    ) -> None:
        self._equip(torque_limits, inductance, supply)
        self.outputs = {
            f"{joint}.{port.rpartition(' ')[2]}": port_limits
            for port, port_limits in (
                ("position", POSITION),
                ("velocity", Port("rad/s", -10.0, 10.0, rate_of="position", bound=SPEED_BOUND)),
            )
            for joint in JOINTS
        }
        values = {field.name: getattr(arm, field.name) for field in fields(ArmParameters)}
        self.parameters = {name: Parameter(value, UNITS[name]) for name, value in values.items()}
        # Parameters set by the user hold for the loaded arm, too.
        self.loaded_parameters = {
            name: getattr(LOADED, name)
            for name, value in values.items()
            if value == getattr(UNLOADED, name)
        }

    def _equip(self, torque_limits: Pair, inductance: float, supply: float) -> None:
        """Set the limits of joints and motors."""
        self.torque_limits = torque_limits
        self.inductance = inductance
        self.supply = supply
        torques = zip(JOINTS, torque_limits, strict=True)
        self.inputs = {
            **{f"{joint}.torque": Port("N m", -limit, limit) for joint, limit in torques},
            **{f"{joint}.voltage": Port("V", -supply, supply) for joint in JOINTS},
        }
        self.states = {"q_1": "rad", "q_2": "rad", "v_1": "rad/s", "v_2": "rad/s"}
        if inductance > 0.0:
            self.states |= {"i_1": "A", "i_2": "A"}

    def with_options(self, options: DriveOptions) -> Self:
        """Return the arm with the joints and motors of the run options."""
        limits, inductance, supply = options.torque_limits, options.inductance, options.supply
        if (limits, inductance, supply) == (UNLIMITED, 0.0, math.inf):
            return self
        other = copy(self)
        other._equip(
            self.torque_limits if limits == UNLIMITED else limits,
            inductance or self.inductance,
            self.supply if supply == math.inf else supply,
        )
        return other

    @classmethod
    def variants(cls) -> Sequence[Plant]:
        """Return the arm of the study, and one whose motors have inductance."""
        return [cls(), cls(inductance=1e-3)]

    def random_trajectory(self, rng: np.random.Generator) -> Trajectory:
        """Draw two or three way points and a speed."""
        points = np.round(rng.uniform(-FARTHEST, FARTHEST, (int(rng.integers(2, 4)), 2)))
        longest = np.abs(np.diff(points, axis=0, prepend=np.zeros((1, 2)))).max()
        duration = round(max(float(longest / rng.uniform(*PACES)), 1.0), 2)
        return through([(float(a), float(b)) for a, b in points], duration, hold=0.5)

    @property
    def arm(self) -> ArmParameters:
        """The parameters of its equations."""
        return ArmParameters(**{name: parameter(self, name).value for name in self.parameters})

    def pack(self, driven: Collection[Address], arithmetic: RunArithmetic) -> NDArray[np.float64]:
        """Return the constants of the kernels.

        Parameters
        ----------
        driven : collection of (str, str)
            Axes and ports driven by the controller.
        arithmetic : RunArithmetic
            Arithmetic of the run.
        """
        powered = [float((joint, "voltage") in driven) for joint in JOINTS]
        limits = [float(limit) for limit in self.torque_limits]
        motor = [self.inductance, self.supply]
        return np.array([*constants(self.arm, single=arithmetic.single), *powered, *limits, *motor])

    def dynamics(
        self, arithmetic: RunArithmetic, address: Callable[..., int], *, finely: bool
    ) -> Dynamics:
        """Register the kernel; each precision has its own.

        With `finely` the arm is integrated by Runge-Kutta steps, which check the study's
        integrator.
        """
        bindings: dict[str, Callable[..., Any]] = {
            "stored": stored_single if arithmetic.single else stored_double
        }
        if finely:
            bindings["advance_arm"] = advance_arm_finely
        if self.inductance > 0.0 or self.supply < math.inf:
            bindings["drive_arm"] = drive_armatures
            bindings["torques_later"] = torques_of_armatures
        run = address(run_arm, **bindings)
        return Dynamics(run, actuates=True, extra=POSES, kernel=run_arm, bindings=bindings)

    particulars = Particulars(
        extra=POSES,
        room=ROOM,
        disturbed=tuple(f"{joint}.torque" for joint in JOINTS),
        options=("torque_limits", "inductance", "supply", "conventions", "precision", "pi"),
        opponent=("pd-motor.frb", "K_p", "K_d"),
    )


# --- Its kernels ---
#
# x: q_1, q_2, v_1, v_2, then the currents with inductance, then (from ASKED on) the commanded and
# the actual torques. y: the measured first four of x, then the pose. u: both torques, both
# voltages; ACTUATE leaves the joint torques in u[0], u[1]. p: see below. clock: time, control
# period, steps of the finer integrator, single precision, task.
#
# Angles are in rad from the horizontal, velocities in rad/s, torques in N m at the joints, voltages
# in V at the motors (before the gears), currents in A. A period is: MEASURE, the controller,
# ACTUATE (commands become torques), loads on u[0] and u[1], ADVANCE. No NaN arises here: the mass
# matrix is invertible in every pose. A NaN torque passes the limits into the state, and the loop
# ends the run.

POWERED, LIMITS, MOTOR = PLANT_SIZE, PLANT_SIZE + 2, PLANT_SIZE + 4
"""After the constants of the arm: driven motors, torque limits, motor inductance and supply."""

CURRENTS = 4
"""First state of the currents, with inductance."""

ASKED, MADE = 6, 8
"""Commanded torques beside the voltages; joint torques made of both."""

# A control period longer than the study's is divided; the motors' torques then follow the velocity
# from step to step, at constant voltage.
LONGEST_STEP = STUDY_TIMING.period

FIRST_RATIO, SECOND_RATIO = RATIOS


@kernel
def run_arm(
    x: list[float], y: list[float], u: list[float], p: list[float], clock: list[float]
) -> None:
    """Run the task in `clock[TASK]`."""
    # One address for all four tasks: a plant is one number in the program of the loop.
    if clock[TASK] == ADVANCE:
        advance_arm(x, y, u, p, clock)
    elif clock[TASK] == ACTUATE:
        drive_arm(x, y, u, p, clock)
    elif clock[TASK] == MEASURE:
        measure_arm(x, y, u, p, clock)
    else:
        derive_pose(x, y, u, p, clock)


@kernel
def measure_arm(
    x: list[float], y: list[float], u: list[float], p: list[float], clock: list[float]
) -> None:
    """Measure positions, velocities and the pose."""
    # The pose is a measurement: laws, model and equations of motion share its four trigonometric
    # values, the most expensive part of a period of the arm.
    for i in range(4):
        y[i] = x[i]
    y[4], y[5], y[6], y[7] = pose_of((x[0], x[1]))


@kernel
def derive_pose(
    x: list[float], y: list[float], u: list[float], p: list[float], clock: list[float]
) -> None:
    """Derive the pose from measured positions."""
    y[4], y[5], y[6], y[7] = pose_of((y[0], y[1]))


@kernel
def drive_arm(
    x: list[float], y: list[float], u: list[float], p: list[float], clock: list[float]
) -> None:
    """Turn torque commands and motor voltages into joint torques."""
    # The commands are stored: in a divided period the motors' part follows the velocity from step
    # to step, and loads, added after this, are the difference to MADE.
    x[ASKED], x[ASKED + 1] = u[0], u[1]
    u[0], u[1] = torques_of_motors(x, u, p, clock)
    x[MADE], x[MADE + 1] = u[0], u[1]


@kernel
def torques_of_motors(x: list[float], u: list[float], p: list[float], clock: list[float]) -> Pair:
    """Return the joint torques: commands plus those of driven motors."""
    # τ = k N (V - k ω N)/R for each motor driven by a voltage (equation 3.3.3 without L). Every sum
    # is rounded to the precision of the run: the study's programs stored floats.
    single = clock[IN_SINGLE] != 0.0
    first, second = x[ASKED], x[ASKED + 1]
    if p[POWERED] != 0.0:
        first += stored(motor_torque(u[2], x[2], FIRST_RATIO), single)
    if p[POWERED + 1] != 0.0:
        second += stored(motor_torque(u[3], x[3], SECOND_RATIO), single)
    return (
        clipped(stored(first, single), p[LIMITS]),
        clipped(stored(second, single), p[LIMITS + 1]),
    )


@kernel
def torques_later(x: list[float], u: list[float], p: list[float], clock: list[float]) -> Pair:
    """Return the torques of a later step of the same period."""
    return torques_of_motors(x, u, p, clock)


@kernel
def drive_armatures(
    x: list[float], y: list[float], u: list[float], p: list[float], clock: list[float]
) -> None:
    """As `drive_arm`, for motors with inductance or a limited supply."""
    # The supply limits the total voltage of a motor, so a torque command becomes the voltage that
    # would produce it; from here on both motors are driven by voltages.
    x[ASKED], x[ASKED + 1] = u[0], u[1]
    u[2] = armature_voltage(u[0], u[2], x[2], FIRST_RATIO, p[POWERED], p[MOTOR + 1])
    u[3] = armature_voltage(u[1], u[3], x[3], SECOND_RATIO, p[POWERED + 1], p[MOTOR + 1])
    u[0], u[1] = torques_at(x, u[2], u[3], p, clock)
    x[MADE], x[MADE + 1] = u[0], u[1]


@kernel
def torques_of_armatures(
    x: list[float], u: list[float], p: list[float], clock: list[float]
) -> Pair:
    """Return the torques of a later step of the same period, and advance the currents.

    A voltage is constant over the period; an amplifier with a torque command tracks the back-EMF.
    """
    first, second = u[2], u[3]
    if p[POWERED] == 0.0:
        first = armature_voltage(x[ASKED], 0.0, x[2], FIRST_RATIO, 0.0, p[MOTOR + 1])
    if p[POWERED + 1] == 0.0:
        second = armature_voltage(x[ASKED + 1], 0.0, x[3], SECOND_RATIO, 0.0, p[MOTOR + 1])
    return torques_at(x, first, second, p, clock)


@kernel
def torques_at(
    x: list[float], first: float, second: float, p: list[float], clock: list[float]
) -> Pair:
    """Return the torques of both motors at their voltages, and advance the currents."""
    single = clock[IN_SINGLE] != 0.0
    step = clock[STEP] / steps_of(clock[STEP])
    one = armature_torque(x, CURRENTS, first, x[2], FIRST_RATIO, p[MOTOR], step)
    two = armature_torque(x, CURRENTS + 1, second, x[3], SECOND_RATIO, p[MOTOR], step)
    return clipped(stored(one, single), p[LIMITS]), clipped(stored(two, single), p[LIMITS + 1])


@kernel
def steps_of(period: float) -> int:
    """Return the number of steps in a control period (`clock` has the finer integrator's)."""
    # In single precision 0.6 ms is slightly more: hence the margin.
    return max(1, math.ceil(period / LONGEST_STEP - 1e-3))


@kernel
def armature_voltage(
    torque: float, voltage: float, velocity: float, ratio: float, powered: float, supply: float
) -> float:
    """Return the motor voltage for a torque command beside a voltage command, within the supply.

    Without a voltage command the motor gets compensation of its back-EMF.
    """
    # The voltage of a torque is that across R: V = k ω N + R τ/(k N).
    wanted = voltage if powered != 0.0 else TORQUE_CONSTANT * (velocity * ratio)
    return clipped(wanted + torque * RESISTANCE / (TORQUE_CONSTANT * ratio), supply)


@kernel
def armature_torque(
    x: list[float],
    current: int,
    voltage: float,
    velocity: float,
    ratio: float,
    inductance: float,
    step: float,
) -> float:
    """Return the mean torque of a motor over a control period, and advance its current.

    Exact solution of ``L di/dt + R i = V - k ω N`` (equation 3.3.3) for constant voltage and
    velocity: stable for any step.
    """
    steady = (voltage - TORQUE_CONSTANT * (velocity * ratio)) / RESISTANCE
    mean = steady
    if inductance > 0.0:
        periods = RESISTANCE * step / inductance
        # i(t) = steady + away e^(-Rt/L); the joint sees its mean over the period.
        decay = math.exp(-periods)
        away = x[current] - steady
        mean = steady + away * (1.0 - decay) / periods
        x[current] = steady + away * decay
    return TORQUE_CONSTANT * ratio * mean


@kernel
def clipped(torque: float, limit: float) -> float:
    """Limit a torque or a voltage; NaN passes."""
    # NaN fails both comparisons; the NaN state that follows ends the run.
    if torque > limit:
        return limit
    if torque < -limit:
        return -limit
    return torque


@kernel
def advance_arm(
    x: list[float], y: list[float], u: list[float], p: list[float], clock: list[float]
) -> None:
    """Advance by a control period with the study's integrator; a longer one in several steps."""
    # The pose in y is current: x was measured after its last change.
    pose = Pose(y[4], y[5], y[6], y[7])
    state = State((x[0], x[1]), (x[2], x[3]))
    step = clock[STEP]
    if clock[PARTS] > 1.0:
        step /= clock[PARTS]
    now = semi_implicit(state, (u[0], u[1]), pose, p, 0, step, clock[IN_SINGLE] != 0.0)
    x[0], x[1] = now.position
    x[2], x[3] = now.velocity
    for _ in range(1, int(clock[PARTS])):
        torque = pushed_torques(x, u, p, clock)
        now = semi_implicit(now, torque, pose_of(now.position), p, 0, step, clock[IN_SINGLE] != 0.0)
        x[0], x[1] = now.position
        x[2], x[3] = now.velocity


@kernel
def advance_arm_finely(
    x: list[float], y: list[float], u: list[float], p: list[float], clock: list[float]
) -> None:
    """Advance by Runge-Kutta steps."""
    state = State((x[0], x[1]), (x[2], x[3]))
    torque = (u[0], u[1])
    steps = steps_of(clock[STEP])
    parts = math.ceil(clock[PARTS] / steps)
    for i in range(steps):
        if i > 0:
            # Motors at the state of this step, the same loads.
            torque = pushed_torques(x, u, p, clock)
        state = runge_kutta(
            state, torque, p, 0, clock[STEP] / steps, parts, clock[IN_SINGLE] != 0.0
        )
        x[0], x[1] = state.position
        x[2], x[3] = state.velocity


@kernel
def pushed_torques(x: list[float], u: list[float], p: list[float], clock: list[float]) -> Pair:
    """Return the torques of a later step, with the loads added after the motors."""
    first, second = torques_later(x, u, p, clock)
    return first + (u[0] - x[MADE]), second + (u[1] - x[MADE + 1])
