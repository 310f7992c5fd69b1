"""A controller as text on the arm, and what it learns there."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.controller.controller import CompiledController
from fuzzyarm.controller.kernel import SINGLE, step
from fuzzyarm.controller.law import SIGNALS, Arithmetic, Gain, Gains, Law, law_address, tell
from fuzzyarm.controller.program import (
    AXIS,
    Program,
    Sheet,
    SourceError,
    Wiring,
    inference_address,
    write_down,
)
from fuzzyarm.controller.text import ControllerText, ports_of
from fuzzyarm.kernels import kernel
from fuzzyarm.model.controller import ControllerModel, Drive, Learn, Zoom
from fuzzyarm.plant.arm import RATIOS, motor_torque
from fuzzyarm.plant.setting import Moment, Pair, stored
from fuzzyarm.table import Axis, LookupTable

# --- The law ---
#
# The first cells are the signals that every law is told, in the order of `tell`.

AXES = ("joint1", "joint2")

TOLD = SIGNALS - 2
"""Cells that say what a law is told; behind them it leaves its torque."""

TORQUES, VOLTAGES = SIGNALS, SIGNALS + 2
"""First cells of the drives."""

ARM = Wiring(
    references={
        (axis, port): 3 + 2 * order + joint
        for joint, axis in enumerate(AXES)
        for order, port in enumerate(("position", "velocity", "acceleration"))
    },
    measured={
        (axis, port): 9 + 2 * order + joint
        for joint, axis in enumerate(AXES)
        for order, port in enumerate(("position", "velocity"))
    },
    drives={
        (axis, port): first + joint
        for joint, axis in enumerate(AXES)
        for port, first in (("torque", TORQUES), ("voltage", VOLTAGES))
    },
    partners=(TOLD, TOLD + 1),
    size=2 * SIGNALS + 4,  # the last ones are room for `text_kernel`
)
"""The ports of the arm."""

FIRST_RATIO, SECOND_RATIO = RATIOS


@kernel
def text_torque(
    signals: list[float], numbers: list[float], memory: list[float], links: list[int]
) -> None:
    """Leave the torque of both joints under a controller as text among the signals.

    Constants: whether it drives the voltage of the motors. Memory: the cells; links: the code.
    """
    for i in range(TOLD):
        memory[i] = signals[i]
    step(links, memory)
    first, second = memory[TORQUES], memory[TORQUES + 1]
    if numbers[0] != 0.0:
        single = memory[SINGLE] != 0.0
        # The velocities of both joints stand behind their positions.
        first += stored(motor_torque(memory[VOLTAGES], signals[11], FIRST_RATIO), single)
        second += stored(motor_torque(memory[VOLTAGES + 1], signals[12], SECOND_RATIO), single)
    signals[TOLD] = first
    signals[TOLD + 1] = second


@kernel
def text_kernel(now: Moment, numbers: list[float], memory: list[float], links: list[int]) -> Pair:
    """Do the same from a moment."""
    signals = memory[SIGNALS + 4 : 2 * SIGNALS + 4]
    tell(now, signals)
    text_torque(signals, numbers, memory, links)
    return signals[TOLD], signals[TOLD + 1]


class FindLaw(Protocol):
    """From the name of a law of the catalogue to its controller."""

    def __call__(self, law: str, /) -> CompiledController:
        """Return it with its gains."""


@dataclass(frozen=True)
class TextLaw(Law):
    """The law of a controller as text.

    Attributes
    ----------
    text : ControllerText
        Which.
    program : callable
        From the arithmetic of a run to what the kernel reads.
    """

    text: ControllerText = field(kw_only=True)
    program: Any = field(kw_only=True)


def arm_law(text: ControllerText, find_law: FindLaw) -> TextLaw:
    """Make the law that runs a controller on the arm.

    Raises
    ------
    SourceError
        If it drives or measures what the arm does not have.
    """
    model = text.model
    _require_ports(model)
    gains = tuple(_gains(model))
    voltage = any(line.port == "voltage" for _, line in model.lines() if isinstance(line, Drive))
    partners = {}
    for each in model.partners:
        law = find_law(each.law)
        partners[each.name] = law.with_gains({name: [value] for name, value in each.gains})

    @cache
    def program(arithmetic: Arithmetic) -> Program:
        laws = {
            name: (law_address(each.law, arithmetic), each.block(arithmetic))
            for name, each in partners.items()
        }
        address = inference_address(compiled=arithmetic.compiled)
        return write_down(model, text.sheets, laws, ARM, arithmetic, address)

    def pack(_gains: Gains, _arithmetic: Arithmetic) -> list[float]:
        return [float(voltage)]

    def remember(chosen: Gains, arithmetic: Arithmetic) -> NDArray[np.float64]:
        # A gain of the text counts with the π of the run, one that is given as it is.
        given = {each.name: chosen[each.name].value for each in gains if chosen[each.name] != each}
        return program(arithmetic).cells_with(given, arithmetic)

    def links(arithmetic: Arithmetic) -> list[int]:
        return program(arithmetic).code

    return TextLaw(
        model.name,
        text_kernel,
        model.description,
        gains,
        pack,
        remember,
        links,
        remembers=any(True for _ in text.learners()),
        at_signals=text_torque,
        text=text,
        program=program,
    )


LARGEST_RATE = 10.0
"""Of a learner: with more, one judgement fills the table."""


def _gains(model: ControllerModel) -> Iterator[Gain]:
    """Yield the gains of a text, with the range that their use allows."""
    lines = [line for _, line in model.lines()]
    rates = {line.rate for line in lines if isinstance(line, Learn)}
    positive = {line.bound for line in lines if isinstance(line, Learn)}
    for line in lines:
        if isinstance(line, Zoom):
            positive |= {line.by, line.inside}
    for each in model.gains:
        yield Gain(
            each.name,
            tuple(value.value(np.pi) for value in each.values),
            each.unit or "1",
            "",
            positive=each.name in positive,
            bounds=(0.0, LARGEST_RATE) if each.name in rates else None,
        )


def _require_ports(model: ControllerModel) -> None:
    for axis in model.axis_names:
        if axis not in AXES:
            raise SourceError(f"the arm has no axis '{axis}'", hint=f"it has {', '.join(AXES)}")
    for kind, ports in (
        ("reference", ARM.references),
        ("measured", ARM.measured),
        ("drive", ARM.drives),
    ):
        for asked in ports_of(model, kind):
            if asked not in ports:
                names = ", ".join(dict.fromkeys(name for _, name in ports))
                what = "drive" if kind == "drive" else f"{kind} value"
                raise SourceError(f"the arm has no {what} '{asked[1]}'", hint=f"it has {names}")


# --- What it has learned ---


@dataclass(frozen=True)
class Learned:
    """Tables that a controller has learned.

    Attributes
    ----------
    axes : tuple of Axis
        The inputs of each table.
    values : ndarray, shape (axes of the controller, levels of each input …)
        One table for each axis.
    visits : ndarray of int64, same shape
        How often each cell was used.
    """

    axes: tuple[Axis, ...]
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
        return replace(self, values=np.round(self.values, decimals) + 0.0)  # + 0.0: no -0

    def tables(self, like: LookupTable) -> list[LookupTable]:
        """Return the table of each axis of the controller; the rest as `like` has it."""
        return [replace(like, axes=self.axes, values=each) for each in self.values]

    def table(self, like: LookupTable) -> LookupTable:
        """Return all tables as one, whose first input tells the axes of the controller apart."""
        levels = tuple(float(i + 1) for i in range(len(self.values)))
        axes = (Axis(AXIS, levels, description="axis of the controller"), *self.axes)
        return replace(like, axes=axes, values=self.values)


def learned(law: TextLaw, arithmetic: Arithmetic, memory: Any = None) -> Learned:
    """Read the first table that learns from the memory of a law.

    Parameters
    ----------
    law : TextLaw
        Of a controller that learns.
    arithmetic : Arithmetic
        Of the run.
    memory : array_like, optional
        As a run left it; as it is before the first one by default.
    """
    line = next(law.text.learners())
    program: Program = law.program(arithmetic)
    if memory is None:
        memory = program.cells
    axes = tuple(axis for axis in _table(law.text.sheets[line.table][0]).axes if axis.name != AXIS)
    shape = tuple(len(axis.levels) for axis in axes)
    places = [program.learned[axis, line.table] for axis in law.text.model.axis_names]
    values = [memory[each.values : each.values + each.count] for each in places]
    visits = [memory[each.visits : each.visits + each.count] for each in places]
    return Learned(
        axes,
        np.array(values).reshape(-1, *shape),
        np.array(visits).astype(np.int64).reshape(-1, *shape),
    )


def _table(sheet: Sheet) -> LookupTable:
    assert isinstance(sheet, LookupTable)
    return sheet
