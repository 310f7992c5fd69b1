"""What a compiled control law is: its number, its gains, and how they become arrays."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Literal, NamedTuple

import numpy as np

from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.plant.arm import UNITS, ArmParameters, constants

# --- The number of each compiled control law, by which the loop finds its kernel ---

PD = 1
INTEGRAL = 2
COMPUTED_TORQUE = 3
FEED_FORWARD_INVERSE = 4
CRITICALLY_DAMPED = 5
PURE_FEED_FORWARD = 6
ADAPTIVE_CRITICALLY_DAMPED = 7
MODEL_REFERENCE = 8
DECENTRALISED = 9
FUZZY_TABLE = 10
SELF_ORGANIZING = 11
FUZZY_RULES = 12


# --- Gains as data: name, value, unit, meaning, and where the value comes from ---

Origin = Literal["printed", "identified", "own", "given"]


class GainError(FuzzyarmError, ValueError):
    """A gain is unknown or its value is out of sense; `name` and `value` say which."""

    def __init__(self, message: str, *, name: str, value: object = None, hint: str = "") -> None:
        super().__init__(message, hint=hint)
        self.name = name
        self.value = value


@dataclass(frozen=True)
class Gain:
    """One gain of a control law.

    Parameters
    ----------
    name : str
        As ``--set`` takes it.
    value : tuple of float
        One number, or one for each joint, or one for each parameter.
    unit : str
        SI; "1" for none.
    meaning : str
        What it multiplies.
    origin : {"printed", "identified", "own", "given"}
        Printed in the study, identified from its figures, chosen here, or given by
        the user.
    positive : bool, optional
        Whether zero and below are out of sense.
    """

    name: str
    value: tuple[float, ...]
    unit: str
    meaning: str
    origin: Origin = "printed"
    positive: bool = False

    def with_value(self, value: Sequence[float], origin: Origin = "given") -> Gain:
        """Return the gain with another value; a single number goes for all places.

        Raises
        ------
        GainError
            If the count does not fit or a number is out of sense.
        """
        values = tuple(float(each) for each in value)
        if len(values) == 1:
            values *= len(self.value)
        if len(values) != len(self.value):
            raise GainError(
                f"gain {self.name} takes 1 or {len(self.value)} numbers, not {len(values)}",
                name=self.name,
                value=value,
            )
        for each in values:
            if not math.isfinite(each) or abs(each) > 1e12 or (self.positive and each <= 0):
                wanted = "a positive number" if self.positive else "a finite number"
                raise GainError(
                    f"gain {self.name} = {each} is out of sense",
                    name=self.name,
                    value=each,
                    hint=f"{wanted} below 1e12",
                )
        return replace(self, value=values, origin=origin)


Gains = Mapping[str, Gain]


def collect(gains: Iterable[Gain]) -> dict[str, Gain]:
    """Index gains by name, in order."""
    return {gain.name: gain for gain in gains}


# --- A compiled control law: its number, its gains and how they go into arrays ---


class Arithmetic(NamedTuple):
    """How the programs of a run count.

    Attributes
    ----------
    single : bool
        Whether stored values are rounded to single precision.
    pi : float
        The constant for π, of which some gains are fractions.
    """

    single: bool = False
    pi: float = math.pi

    def hold(self, value: float) -> float:
        """Round as a stored gain is rounded."""
        return float(np.float32(value)) if self.single else float(value)


Pack = Callable[[Gains, Arithmetic], list[float]]
"""From gains to numbers, in the arithmetic of a run."""


@dataclass(frozen=True)
class Block:
    """One law as the loop sees it: number, constants, initial memory."""

    kind: int
    numbers: list[float]
    memory: list[float]


def _no_memory(_gains: Gains, _arithmetic: Arithmetic) -> list[float]:
    return []


def pack_all(gains: Gains, arithmetic: Arithmetic) -> list[float]:
    """Write down every gain in the order of its declaration."""
    return [arithmetic.hold(value) for gain in gains.values() for value in gain.value]


@dataclass(frozen=True)
class Law:
    """A control law that exists as a kernel.

    Parameters
    ----------
    name : str
        Short name.
    kind : int
        One of the numbers above, by which the loop finds the kernel.
    summary : str
        One line.
    gains : tuple of Gain
        With their default values.
    pack : callable, optional
        Gains to the kernel's constants; by default all in order.
    remember : callable, optional
        Gains to the initial memory; none by default.
    """

    name: str
    kind: int
    summary: str
    gains: tuple[Gain, ...]
    pack: Pack = field(default=pack_all)
    remember: Pack = field(default=_no_memory)


def model_gains(model: ArmParameters, origin: Origin = "printed") -> tuple[Gain, ...]:
    """List the parameters of a controller's own model of the arm as gains."""
    return tuple(
        Gain(
            f"model.{each.name}",
            (getattr(model, each.name),),
            UNITS[each.name],
            "the controller's model of the arm",
            origin,
        )
        for each in fields(model)
    )


def model_of(gains: Gains) -> ArmParameters:
    """Put the model of :func:`model_gains` together again."""
    return ArmParameters(
        **{each.name: gains[f"model.{each.name}"].value[0] for each in fields(ArmParameters)}
    )


def pack_with_model(names: Sequence[str]) -> Pack:
    """Write down some gains and, behind them, the nine constants of the model."""

    def pack(gains: Gains, arithmetic: Arithmetic) -> list[float]:
        front = [arithmetic.hold(value) for name in names for value in gains[name].value]
        return [*front, *map(float, constants(model_of(gains), single=arithmetic.single))]

    return pack
