"""Compiled control laws: kernel, gains, and their arrays."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.names import near_hint
from fuzzyarm.inference.errors import NotANumberError
from fuzzyarm.inference.inputs import number_of
from fuzzyarm.plant.arm import UNITS, ArmParameters, constants
from fuzzyarm.plant.setting import (
    Clock,
    Observation,
    Pair,
    Pose,
    Reference,
    RunArithmetic,
    State,
    stored_double,
    stored_single,
)
from fuzzyarm.symbolic.kernels import address_of, call, kernel

# --- Gains as data: name, value, unit, meaning, origin ---

Origin = Literal["printed", "identified", "own", "given"]


class GainError(FuzzyarmError, ValueError):
    """An unknown gain or an invalid value; see `name` and `value`."""

    def __init__(self, message: str, *, name: str, value: object = None, hint: str = "") -> None:
        super().__init__(message, hint=hint)
        self.name = name
        self.value = value


def unknown_gain(owner: str, gains: Iterable[str], name: str) -> GainError:
    """Describe an unknown gain of a controller, with the nearest known one."""
    known = list(gains)
    names = ", ".join(dict.fromkeys(key.split(".")[0] for key in known)) or "none"
    hint = near_hint(name, known)[0] or f"its gains: {names}"
    return GainError(f"{owner} has no gain '{name}'", name=name, hint=hint)


@json_properties("value unit origin meaning")
@dataclass(frozen=True)
class Gain:
    """One gain of a control law.

    Parameters
    ----------
    name : str
        Name for ``--set``.
    value : tuple of float
        One number, or one for each joint, or one for each parameter.
    unit : str
        SI; "1" for none.
    meaning : str
        The signal that it multiplies.
    origin : {"printed", "identified", "own", "given"}
        Printed in the study, identified from its figures, chosen here, or given by
        the user.
    positive : bool, optional
        Whether zero and below are out of range.
    bounds : pair of float, optional
        Smallest and largest value; by default anything below 1e12 in magnitude.
    places : int, optional
        Number of values, if one for all is not enough; by default the present number.
    """

    name: str
    value: tuple[float, ...]
    unit: str
    meaning: str
    origin: Origin = "printed"
    positive: bool = False
    bounds: tuple[float, float] | None = None
    places: int = 0

    def with_value(self, value: Sequence[float], origin: Origin = "given") -> Gain:
        """Return the gain with another value; a single number applies to all places.

        Raises
        ------
        GainError
            If the count does not fit or a number is out of range.
        """
        values = tuple(self._number(number) for number in value)
        places = max(self.places, len(self.value))
        if len(values) == 1:
            values *= len(self.value)
        elif len(values) != places:
            takes = "1 number" if places == 1 else f"1 or {places} numbers"
            message = f"gain {self.name} takes {takes}, not {len(values)}"
            raise GainError(message, name=self.name, value=value)
        low, high = self.bounds or (-1e12, 1e12)
        range_words = f"a {'positive' if self.positive else 'finite'} number below 1e12"
        if self.bounds:
            range_words = f"a number from {low:g} to {high:g}"
        for number in values:
            if not low <= number <= high or (self.positive and number <= 0):
                message = f"gain {self.name} = {number} is out of range"
                raise GainError(message, name=self.name, value=number, hint=range_words)
        return replace(self, value=values, origin=origin)

    def _number(self, value: object) -> float:
        try:
            return number_of(self.name, value)
        except NotANumberError:
            message = f"gain {self.name} is not a number: {value!r}"
            raise GainError(message, name=self.name, value=value) from None


Gains = Mapping[str, Gain]


def collect(gains: Iterable[Gain]) -> dict[str, Gain]:
    """Index gains by name, in order."""
    return {gain.name: gain for gain in gains}


# --- A control law: its kernel, its gains and their arrays ---

Kernel = Callable[..., Any]
"""From observation, constants, memory and links to the torque, N m."""


Vector = NDArray[np.float64]
Pack = Callable[[Gains, RunArithmetic], "list[float] | Vector"]
"""From gains to numbers, in the arithmetic of a run."""


@dataclass(frozen=True)
class LawBlock:
    """A law as arrays of the loop: constants, initial memory, links."""

    numbers: Vector
    memory: Vector
    links: list[int]


def view(array: NDArray[Any]) -> Any:
    """Return an array as plain numbers, for kernels that run interpreted; slices share memory."""
    try:
        return memoryview(array)  # type: ignore[arg-type]
    except TypeError:  # an array without NumPy: its slices share memory, too
        return array


def zeros(count: int) -> Pack:
    """Return an initial memory of zeros."""
    return lambda _gains, _arithmetic: [0.0] * count


def pack_all(gains: Gains, arithmetic: RunArithmetic) -> list[float]:
    """Return every gain, in the order of declaration."""
    return [arithmetic.hold(value) for gain in gains.values() for value in gain.value]


def pack_gains(*names: str, model: bool = False) -> Pack:
    """Pack some gains and, optionally, the nine constants of the model after them."""

    def pack(gains: Gains, arithmetic: RunArithmetic) -> list[float]:
        front = [arithmetic.hold(value) for name in names for value in gains[name].value]
        return [*front, *model_constants(gains, arithmetic)] if model else front

    return pack


@dataclass(frozen=True)
class Law:
    """A control law as a kernel.

    Parameters
    ----------
    name : str
        Short name.
    kernel : callable
        From a :class:`~fuzzyarm.plant.setting.Observation`, its constants, its memory and its links
        (each flat and indexed from 0) to the torque of both joints, N m.
    summary : str
        One line.
    gains : tuple of Gain
        With their default values.
    pack : callable, optional
        Gains to the kernel's constants; by default all in order.
    remember : callable, optional
        Gains to the initial memory; none by default.
    links : callable, optional
        From the arithmetic to the addresses that the kernel calls, and other integers; none by
        default.
    remembers : bool, optional
        Whether the final memory is a result, or only scratch.
    at_signals : callable, optional
        A kernel over the array of :func:`write_observation`; `kernel` takes an observation.
    """

    name: str
    kernel: Kernel
    summary: str
    gains: tuple[Gain, ...]
    pack: Pack = field(default=pack_all)
    remember: Pack = field(default=zeros(0))
    links: Callable[[RunArithmetic], list[int]] = field(default=lambda _arithmetic: [])
    remembers: bool = True
    at_signals: Kernel | None = None


def model_gains(model: ArmParameters, origin: Origin = "printed") -> tuple[Gain, ...]:
    """List the parameters of a controller's own model of the arm as gains."""
    return tuple(
        Gain(
            f"model.{field.name}",
            (getattr(model, field.name),),
            UNITS[field.name],
            "the controller's model of the arm",
            origin,
        )
        for field in fields(model)
    )


def model_of(gains: Gains) -> ArmParameters:
    """Return the model from the gains of :func:`model_gains`."""
    return ArmParameters(
        **{field.name: gains[f"model.{field.name}"].value[0] for field in fields(ArmParameters)}
    )


def model_constants(gains: Gains, arithmetic: RunArithmetic) -> list[float]:
    """Return P1 … P7 of the model among the gains and its motor inertias."""
    return list(map(float, constants(model_of(gains), single=arithmetic.single)))


# --- The compiled control step: laws by address, their drives summed ---
#
# The loop calls laws by address, so only those in use are compiled, each on its own. The
# observation is one array: the clock, references and outputs (for any plant see the head of
# `fuzzyarm.control.loop.loop`), followed by scratch for the drives. For the laws of this package,
# on the arm, it is
#
#   0 … 2    time step, whether it is the last iteration, whether values are rounded
#   3 … 8    desired position, velocity and acceleration, joint 1 and joint 2 each
#   9 … 12   position and velocity
#   13 … 16  cos θ1, sin θ2, cos θ2, cos(θ1 + θ2)
#   17 … 20  results: the torque of both joints, and the voltage of both motors

OBSERVATION_END = 17
"""Numbers in the input of a law of the arm."""

SIGNALS = 21
"""Length of that array."""

# The loop reads the laws from an array of integers: their number, seven integers for each law, then
# the links of all of them.

ADDRESS, NUMBERS, NUMBERS_END, MEMORY, MEMORY_END, LINKS, LINKS_END = range(7)
LAW_HEAD = 7
"""Integers for each law; the links begin and end at an index of the whole array."""


@kernel
def write_observation(now: Observation, signals: list[float]) -> None:
    """Write an observation as an array."""
    reference, state, pose, clock = now
    signals[0] = clock.step
    signals[1] = 1.0 if clock.last else 0.0
    signals[2] = 1.0 if clock.single else 0.0
    signals[3], signals[4] = reference.position
    signals[5], signals[6] = reference.velocity
    signals[7], signals[8] = reference.acceleration
    signals[9], signals[10] = state.position
    signals[11], signals[12] = state.velocity
    signals[13], signals[14], signals[15], signals[16] = pose


@kernel
def drives_of_laws(
    board: list[float],
    laws: list[int],
    numbers: list[float],
    memory: list[float],
    drives: list[float],
) -> None:
    """As :func:`summed_drives`, for a loop in plain Python."""
    size = len(drives)
    summed_drives(board, len(board) - size, size, laws, numbers, memory, drives)


@kernel
def summed_drives(
    board: list[float],
    observation_end: int,
    size: int,
    laws: list[int],
    numbers: list[float],
    memory: list[float],
    drives: list[float],
) -> None:
    """Sum the drives of all laws, called one after the other.

    Parameters
    ----------
    board : float
        The observation, followed by scratch for the drives.
    observation_end, size : int
        Length of the observation, and number of drives.
    laws, numbers, memory
        The laws as packed by :func:`law_integers`, their constants, their states.
    drives : float
        Filled.
    """
    for i in range(size):
        drives[i] = 0.0
    # In the order of the written sum: the order of additions determines the bits.
    for law in range(1, 1 + laws[0] * LAW_HEAD, LAW_HEAD):
        for i in range(observation_end, observation_end + size):
            board[i] = 0.0
        call(
            laws[law + ADDRESS],
            board[0 : observation_end + size],
            numbers[laws[law + NUMBERS] : laws[law + NUMBERS_END]],
            memory[laws[law + MEMORY] : laws[law + MEMORY_END]],
            laws[laws[law + LINKS] : laws[law + LINKS_END]],
        )
        for i in range(size):
            drives[i] += board[observation_end + i]


def law_integers(
    laws: Sequence[Law], blocks: Sequence[LawBlock], arithmetic: RunArithmetic
) -> list[int]:
    """Pack the laws as integers for :func:`summed_drives`."""
    heads: list[int] = []
    links: list[int] = []
    first_link = 1 + LAW_HEAD * len(laws)
    number = cell = 0
    for law, block in zip(laws, blocks, strict=True):
        heads += [law_address(law, arithmetic)]
        heads += [number, number + len(block.numbers), cell, cell + len(block.memory)]
        heads += [first_link + len(links), first_link + len(links) + len(block.links)]
        number += len(block.numbers)
        cell += len(block.memory)
        links += block.links
    return [len(laws), *heads, *links]


@kernel
def law_kernel(
    now: Observation, numbers: list[float], memory: list[float], links: list[int]
) -> Pair:
    """Return no torque; the kernel of a law is bound to this name."""
    return 0.0, 0.0


def lacks_number(reference: Reference, state: State) -> bool:
    """Whether a reference or measured value is not a number.

    Never inside a loop: a run of the arm ends with the first one.
    """
    return any(math.isnan(x) for pair in (*reference, *state) for x in pair)


@kernel
def law_at_address(
    signals: list[float], numbers: list[float], memory: list[float], links: list[int]
) -> None:
    """Run an arm control law on one observation."""
    # Back into named tuples, at no cost: in machine code they are registers, and unused ones
    # vanish.
    reference = Reference(
        (signals[3], signals[4]), (signals[5], signals[6]), (signals[7], signals[8])
    )
    state = State((signals[9], signals[10]), (signals[11], signals[12]))
    pose = Pose(signals[13], signals[14], signals[15], signals[16])
    clock = Clock(signals[0], signals[1] != 0.0, signals[2] != 0.0)
    torque = law_kernel(Observation(reference, state, pose, clock), numbers, memory, links)
    signals[17], signals[18] = torque


LAW_ARRAYS = "fffi"
"""Signature: signals, numbers, memory, links; :func:`fuzzyarm.symbolic.kernels.address_of`."""


def law_address(law: Law, arithmetic: RunArithmetic) -> int:
    """Return the address of a law for the loop; each precision has its own.

    Bound for one precision: stored values need no test of rounding.
    """
    bindings: dict[str, Callable[..., object]] = {
        "stored": stored_single if arithmetic.single else stored_double
    }
    kernel = law.at_signals
    if kernel is None:
        kernel = law_at_address
        bindings["law_kernel"] = law.kernel
    compiled = arithmetic.compiled
    return address_of(kernel, LAW_ARRAYS, bindings, compiled=compiled)
