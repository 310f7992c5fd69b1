"""Cost of a control step: floating-point operations and time.

Operations are counted, not estimated: the laws run as plain Python on numbers that count their own
operations. Time is measured in the closed loop, as machine code, less the time of the same loop
with an empty law.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.control.controllers.controller import CompiledController, Controller
from fuzzyarm.control.controllers.law import (
    OBSERVATION_END,
    SIGNALS,
    Law,
    law_kernel,
    write_observation,
)
from fuzzyarm.control.controllers.on_plant import TextLaw
from fuzzyarm.control.loop.along import equipped, trajectory_motion
from fuzzyarm.control.loop.course import Motion, Options
from fuzzyarm.control.loop.simulation import simulate
from fuzzyarm.plant.arm import RATIOS, motor_torque
from fuzzyarm.plant.driven_arm import Arm
from fuzzyarm.plant.setting import (
    PLAIN,
    Clock,
    Conventions,
    Observation,
    Pair,
    Reference,
    RunArithmetic,
    State,
    pose_of,
)
from fuzzyarm.plant.trajectory import Trajectory, through

# --- Numbers that count their operations ---


@dataclass
class Tally:
    """Counts of operations.

    Attributes
    ----------
    arithmetic : int
        Additions, subtractions, multiplications, divisions, negations and magnitudes.
    comparisons : int
        Including those of minima and maxima.
    functions : int
        Sines and cosines.
    """

    arithmetic: int = 0
    comparisons: int = 0
    functions: int = 0

    def clear(self) -> None:
        """Reset the counts."""
        self.arithmetic = self.comparisons = self.functions = 0


_tally = Tally()
"""The current count."""


class CountingFloat(float):
    """A number that counts its operations."""

    __slots__ = ()


def _arithmetic(name: str) -> Callable[..., Any]:
    original = getattr(float, name)

    def operation(*numbers: float) -> Any:
        value = original(*numbers)
        if value is NotImplemented:
            return value
        _tally.arithmetic += 1
        return CountingFloat(value)

    return operation


def _comparison(name: str) -> Callable[..., Any]:
    original = getattr(float, name)

    def operation(first: float, second: float) -> Any:
        _tally.comparisons += 1
        return original(first, second)

    return operation


for _word in ("add", "sub", "mul", "truediv"):
    setattr(CountingFloat, f"__{_word}__", _arithmetic(f"__{_word}__"))
    setattr(CountingFloat, f"__r{_word}__", _arithmetic(f"__r{_word}__"))
for _word in ("neg", "abs"):
    setattr(CountingFloat, f"__{_word}__", _arithmetic(f"__{_word}__"))
for _word in ("lt", "le", "gt", "ge", "eq", "ne"):
    setattr(CountingFloat, f"__{_word}__", _comparison(f"__{_word}__"))
CountingFloat.__hash__ = float.__hash__  # type: ignore[method-assign]


class CountedArray(np.ndarray):
    """An array with counting numbers; slices of it share its memory."""

    def __getitem__(self, index: Any) -> Any:
        """Return a number that counts, or a part."""
        value = super().__getitem__(index)
        if isinstance(value, np.float64):
            return CountingFloat(value)
        return int(value) if isinstance(value, np.integer) else value


def _counted(values: Any) -> Any:
    return np.array(values, np.float64).view(CountedArray)


class _CountedPose:
    """The sines and cosines of a position, each counted on its first use."""

    def __init__(self, position: Pair) -> None:
        self._values = pose_of(position)._asdict()
        self._names: set[str] = set()

    def __getattr__(self, name: str) -> CountingFloat:
        if name not in self._names:
            self._names.add(name)
            _tally.functions += 1
        return CountingFloat(self._values[name])


# --- Operations of a control step ---


class CostError(FuzzyarmError, ValueError):
    """A controller in plain Python has uncountable operations; `name` is its name."""

    def __init__(self, name: str) -> None:
        super().__init__(f"the operations of '{name}' are not counted: it is plain Python")
        self.name = name


@json_properties("* total")
@dataclass(frozen=True)
class Operations:
    """Mean operations of a control step, both joints.

    Attributes
    ----------
    arithmetic, comparisons, functions : float
        See :class:`Tally`.
    """

    arithmetic: float
    comparisons: float
    functions: float

    @property
    def total(self) -> float:
        """The sum of all kinds."""
        return self.arithmetic + self.comparisons + self.functions


def short_move() -> Trajectory:
    """Return the move for counting operations: 0.24 s, at the study's accelerations."""
    return through([(0.9, -0.9)], segment=0.24)


def count_operations(
    controller: Controller, trajectory: Trajectory | None = None, *, payload: bool = False
) -> Operations:
    """Count the floating-point operations of a control step along a trajectory.

    Conversion of control to torque by the motors belongs to the arm and does not count; nor do
    moves of numbers and integer operations for indices.
    """
    _tally.clear()
    counting = _Counting(controller)
    options = Options(compiled=False)
    move = timed_motion(controller, trajectory or short_move(), PLAIN, options, payload=payload)
    simulate(counting, move, options=options)
    steps = max(counting.steps, 1)
    return Operations(
        _tally.arithmetic / steps, _tally.comparisons / steps, _tally.functions / steps
    )


class _Counting(Controller):
    """Compiled laws, run as plain Python on counting numbers."""

    def __init__(self, controller: Controller) -> None:
        self.name = controller.name
        self.steps = 0
        self._parts = []
        arithmetic = RunArithmetic()
        for part in controller.parts():
            if not isinstance(part, CompiledController):
                raise CostError(part.name)
            block = part.block(arithmetic)
            arrays = _counted(block.numbers), _counted(block.memory), block.links
            self._parts.append((part.law, arrays))

    def torque(self, reference: Reference, state: State, clock: Clock) -> Pair:
        self.steps += 1
        first = second = 0.0
        for law, arrays in self._parts:
            torque = _torque_of_law(law, arrays, reference, state, clock)
            first += float(torque[0])
            second += float(torque[1])
        return first, second


def _torque_of_law(
    law: Law, arrays: tuple[Any, ...], reference: Reference, state: State, clock: Clock
) -> Sequence[float]:
    if isinstance(law, TextLaw):
        return _torque_of_text(law, arrays, reference, state, clock)
    course = Reference(*(_pair(axis_values) for axis_values in reference))
    now = State(*(_pair(axis_values) for axis_values in state))
    pose: Any = _CountedPose(state.position)
    torque: Sequence[float] = law.kernel(Observation(course, now, pose, clock), *arrays)
    return torque


def _torque_of_text(
    law: TextLaw, arrays: tuple[Any, ...], reference: Reference, state: State, clock: Clock
) -> Sequence[float]:
    signals = _counted(np.zeros(SIGNALS))
    write_observation(Observation(reference, state, pose_of(state.position), clock), signals)
    assert law.at_signals is not None
    law.at_signals(signals, *arrays)
    _tally.functions += _functions_of_partners(law)
    # For each joint: does the text drive the voltage, which the motor turns into a torque?
    powered = arrays[0][2:4]
    return [
        float(signals[OBSERVATION_END + joint])
        + (
            motor_torque(float(signals[OBSERVATION_END + 2 + joint]), state.velocity[joint], ratio)
            if float(powered[joint])
            else 0.0
        )
        for joint, ratio in enumerate(RATIOS)
    ]


def _functions_of_partners(law: TextLaw) -> int:
    """Return the number of sines and cosines of the arm's angles that a text's partners need."""
    functions = 0
    for partner in law.text.model.partners:
        controller = law.find_law(partner.law)
        block = controller.block(RunArithmetic())
        pose: Any = _CountedPose((0.1, 0.2))
        still = State((0.1, 0.2), (0.0, 0.0))
        now = Observation(Reference((0.1, 0.2), (0.0, 0.0), (0.0, 0.0)), still, pose, CLOCK_AT_REST)
        before = _tally.functions
        controller.law.kernel(now, list(block.numbers), list(block.memory), block.links)
        functions += _tally.functions - before
        _tally.functions = before
    return functions


def timed_motion(
    controller: Controller,
    trajectory: Trajectory,
    conventions: Conventions,
    options: Options,
    *,
    payload: bool = False,
) -> Motion:
    """Return a trajectory at the period of a controller, for equally frequent others."""
    plant = equipped(Arm(), options)
    return trajectory_motion(plant, trajectory, controller, conventions, payload=payload)


CLOCK_AT_REST = Clock(0.0006, last=False, single=False)


def _pair(numbers: Pair) -> Pair:
    return CountingFloat(numbers[0]), CountingFloat(numbers[1])


# --- Time of a control step ---

ROUNDS = 60
"""Runs, alternating with those of the empty law; the fastest counts."""

RESOLUTION = 10e-9
"""Time of a step in s below which the difference of two runs is lost in disturbances."""


def timed_move() -> Trajectory:
    """Return the move for timing: 1 s, short enough to be undisturbed."""
    return through([(10.0, -10.0)], segment=1.0)


def measure_time(
    controller: Controller,
    trajectory: Trajectory | None = None,
    *,
    conventions: Conventions = PLAIN,
    rounds: int = ROUNDS,
) -> float:
    """Measure the time of a control step in the loop, s; at least `RESOLUTION`."""
    move = timed_motion(controller, trajectory or timed_move(), conventions, Options())
    nothing = CompiledController(Law("nothing", law_kernel, "no torque", ()))
    steps = int(move.iterations.sum())

    def once(contender: Controller) -> float:
        return simulate(contender, move, conventions=conventions).seconds / steps

    once(controller), once(nothing)  # compiled, loaded, warm
    pairs = [(once(controller), once(nothing)) for _ in range(rounds)]
    return max(min(busy for busy, _ in pairs) - min(idle for _, idle in pairs), RESOLUTION)
