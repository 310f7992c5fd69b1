"""A compiled control law: its number, its gains and how they go into arrays."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields
from typing import NamedTuple

import numpy as np

from fuzzyarm.arm.parameters import UNITS, ArmParameters, constants
from fuzzyarm.control.gains import Gain, Gains, Origin


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
        See :mod:`fuzzyarm.control.kinds`.
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
