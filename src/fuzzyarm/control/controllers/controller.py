"""The interface of controllers, and their sums.

A controller of your own is a class with a ``step``, called once in each period::

    class Bang(Controller):
        period = 10.0

        def step(self, measured, reference):
            return {"power": 100.0 if measured["temperature"] < reference["temperature"] else 0.0}

On the study's arm ``torque`` may replace it, which also gets the reference accelerations::

    class Mine(Controller):
        def torque(self, reference, state, clock):
            e1 = reference.position[0] - state.position[0]
            e2 = reference.position[1] - state.position[1]
            return 80.0 * e1 - 9.0 * state.velocity[0], 60.0 * e2 - 7.0 * state.velocity[1]

They can be added to every other controller with ``+``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from fuzzyarm.base.shown import one_line
from fuzzyarm.control.controllers.law import (
    Gain,
    Law,
    LawBlock,
    collect,
    lacks_number,
    unknown_gain,
    view,
)
from fuzzyarm.plant.setting import (
    Clock,
    Observation,
    Pair,
    Reference,
    RunArithmetic,
    State,
    pose_of,
)


class Controller:
    """Base of all controllers: override :meth:`step`, and :meth:`start` if there is state.

    Attributes
    ----------
    name : str
        Name in reports.
    period : float or None
        Time between two steps, s; on the arm by default that of the study.
    every : int
        Periods of a set point; 1 by default.
    gains : dict of str to Gain
        Gains for ``--set``; empty by default.
    """

    name = "own"
    period: float | None = None
    every: int = 1

    def __repr__(self) -> str:
        return one_line(self, f"{self.name}, gains {', '.join(self.gains) or 'none'}")

    def start(self, single: bool = False) -> None:
        """Reset the state; called once before each run."""

    def prepare(self, arithmetic: RunArithmetic) -> None:
        """Start in the arithmetic of a run."""
        self.start(arithmetic.single)

    def step(
        self, measured: Mapping[str, float], reference: Mapping[str, float]
    ) -> Mapping[str, float] | float:
        """Return the drives by port; a plain number if the plant has one input.

        Parameters
        ----------
        measured : mapping of str to float
            Measured values, by ``port`` for a plant with one axis, else ``axis.port``.
        reference : mapping of str to float
            The set points, likewise, with their rates where defined.
        """
        message = f"{type(self).__name__} has neither a step nor a torque"
        raise TypeError(message)

    @property
    def takes_ports(self) -> bool:
        """Whether it has a :meth:`step`, which runs on any plant."""
        return type(self).step is not Controller.step

    def torque(self, reference: Reference, state: State, clock: Clock) -> Pair:
        """Return the torque of both joints of the arm, N m.

        Called five times for each set point, every 0.6 ms.
        """
        message = f"{type(self).__name__} does not say what its torque is"
        raise TypeError(message)

    def parts(self) -> Iterator[Controller]:
        """Iterate over the addends; a plain controller is its only one."""
        yield self

    @property
    def gains(self) -> Mapping[str, Gain]:
        """Gains by name."""
        return {}

    def with_gains(self, values: Mapping[str, Sequence[float]]) -> Controller:
        """Return the controller with some gains replaced.

        Raises
        ------
        GainError
            If a name is unknown or a value out of range.
        """
        for name in values:
            raise unknown_gain(self.name, self.gains, name)
        return self

    def __add__(self, other: Controller) -> Sum:
        return Sum([*self.parts(), *other.parts()])


class CompiledController(Controller):
    """A law with its gains.

    Parameters
    ----------
    law : Law
        The algorithm.
    gains : mapping of str to Gain, optional
        Those of the law by default.
    """

    def __init__(self, law: Law, gains: Mapping[str, Gain] | None = None) -> None:
        self.law = law
        self.name = law.name
        self._gains = dict(gains) if gains is not None else collect(law.gains)
        self._lists: tuple[Any, ...] | None = None

    @property
    def gains(self) -> Mapping[str, Gain]:
        """Gains by name."""
        return self._gains

    def with_gains(self, values: Mapping[str, Sequence[float]]) -> CompiledController:
        """Return the controller with some gains replaced."""
        changed = dict(self._gains)
        for name, value in values.items():
            if name not in changed:
                raise unknown_gain(self.name, changed, name)
            changed[name] = changed[name].with_value(value)
        return CompiledController(self.law, changed)

    def with_origin(self, **values: Gain) -> CompiledController:
        """Return the controller with whole gains, origin included, replaced."""
        return CompiledController(self.law, {**self._gains, **values})

    def block(self, arithmetic: RunArithmetic) -> LawBlock:
        """Return constants and initial memory for the loop."""
        return LawBlock(
            np.array(self.law.pack(self._gains, arithmetic), float),
            np.array(self.law.remember(self._gains, arithmetic), float),
            self.law.links(arithmetic),
        )

    def start(self, single: bool = False) -> None:
        """Reset the state; called once before each run."""
        self.prepare(RunArithmetic(single))

    def prepare(self, arithmetic: RunArithmetic) -> None:
        """Reset the state and take over the arithmetic of a run; called once before each run."""
        block = self._block = self.block(arithmetic._replace(compiled=False))
        # Memory views give Python floats, whose arithmetic is faster than that of NumPy scalars.
        self._lists = view(block.numbers), view(block.memory), block.links
        self._torque: Pair = (0.0, 0.0)

    def torque(self, reference: Reference, state: State, clock: Clock) -> Pair:
        """Run the kernel as plain Python."""
        now = Observation(reference, state, pose_of(state.position), clock)
        # Called outside a run: prepare first.
        if self._lists is None:
            self.prepare(RunArithmetic())
        assert self._lists is not None
        # The kernel of a text has a guard for each axis.
        if self.law.at_signals is not None or not lacks_number(reference, state):
            first, second = self.law.kernel(now, *self._lists)
            self._torque = first, second
        return self._torque


class Sum(Controller):
    """A sum of controllers, that is of their drives.

    Parameters
    ----------
    addends : sequence of Controller
        In the order of their names.
    name : str, optional
        By default the names of the addends with plus signs between.
    """

    def __init__(self, addends: Sequence[Controller], name: str = "") -> None:
        self.addends = tuple(addends)
        self.name = name or "+".join(addend.name for addend in addends)

    def parts(self) -> Iterator[Controller]:
        """Iterate over the addends."""
        for addend in self.addends:
            yield from addend.parts()

    @property
    def gains(self) -> Mapping[str, Gain]:
        """Gains of all addends; ``addend:name`` for a name in two of them."""
        names = [name for addend in self.addends for name in addend.gains]
        return {
            name if names.count(name) == 1 else f"{addend.name}:{name}": gain
            for addend in self.addends
            for name, gain in addend.gains.items()
        }

    def with_gains(self, values: Mapping[str, Sequence[float]]) -> Sum:
        """Return the sum with some gains replaced.

        A bare name applies to every addend with this gain, ``addend:name`` to one.
        """
        for name in values:
            # A name unknown to all addends would be dropped silently below.
            owner, _, bare = name.rpartition(":")
            if not any(
                bare in addend.gains and owner in {"", addend.name} for addend in self.addends
            ):
                raise unknown_gain(self.name, self.gains, name)
        changed = []
        for addend in self.addends:
            addend_gains = {}
            for name, value in values.items():
                owner, _, bare = name.rpartition(":")
                if bare in addend.gains and owner in {"", addend.name}:
                    addend_gains[bare] = value
            changed.append(addend.with_gains(addend_gains))
        return Sum(changed, self.name)

    def start(self, single: bool = False) -> None:
        """Start every addend."""
        self.prepare(RunArithmetic(single))

    def prepare(self, arithmetic: RunArithmetic) -> None:
        """Start every addend in the arithmetic of a run."""
        for addend in self.addends:
            addend.prepare(arithmetic)

    def torque(self, reference: Reference, state: State, clock: Clock) -> Pair:
        """Add the torques."""
        # From 0.0 on and in the order of the names, as the compiled loop adds: the bits are the
        # same, and a lone torque of -0.0 becomes 0.0.
        first = second = 0.0
        for addend in self.addends:
            torque = addend.torque(reference, state, clock)
            first += torque[0]
            second += torque[1]
        return first, second
