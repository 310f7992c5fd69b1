"""The subject of a claim about a closed loop: controller, plant, parameters, starts, set point.

The loop is that of :mod:`fuzzyarm.control.loop.loop`: in each control period sensors read the
outputs, then the controller runs, then the actuators limit its drives, then the plant moves on
with its inputs held. :mod:`fuzzyarm.proof.loop.period` evaluates one such period, up to the inputs
of the plant.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import NamedTuple

import numpy as np

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.names import near_hint
from fuzzyarm.base.numbers import decimal, fraction_of_periods, number_text, whole_periods
from fuzzyarm.control.controllers.on_plant import Site, connectable_names, site_of
from fuzzyarm.control.controllers.text import ControllerText, ports_of
from fuzzyarm.control.loop.course import Sensor
from fuzzyarm.control.loop.reference import AnySignal, Signal, as_signal
from fuzzyarm.language.model.controller import ControllerModel, SignalLine
from fuzzyarm.plant.equations import expressions_of, has_queue
from fuzzyarm.plant.plant import Address, Interface, Plant, parameter, with_parameters
from fuzzyarm.proof.claim.own_start import own_start, reads_of
from fuzzyarm.symbolic.nodes import Node, symbol, symbols
from fuzzyarm.symbolic.operations import Interval


class LoopProofError(FuzzyarmError, ValueError):
    """Nothing can be proved about a loop; the message has the reason."""

    def __init__(self, message: str, *, hint: str = "") -> None:
        super().__init__(message, hint=hint)


class LostRunError(LoopProofError):
    """All runs of a set certainly exceed the bound of a port at the end of a period."""

    def __init__(self, where: str) -> None:
        super().__init__(f"all runs from some starts are {where}")
        self.where = where


class ClaimError(LoopProofError):
    """A claim has an unknown name, or an interval with its ends exchanged."""


# ── the record ───────────────────────────────────────────────────────────────────────


@dataclass(frozen=True)
class PlantEquations:
    """The equations of a plant as expressions over ``t``, ``x0`` …, ``u0`` … and ``p0`` …."""

    rates: tuple[Node, ...]  # of the states, in their order
    outputs: tuple[Node, ...]  # in the order of the ports
    states: tuple[str, ...]  # symbols: states, inputs, parameters, in the order of the plant
    inputs: tuple[str, ...]
    parameters: tuple[str, ...]


class MovedReference(NamedTuple):
    """The value (0), rate (1) or acceleration (2) of a moving reference."""

    signal: Signal
    order: int


@dataclass(frozen=True)
class LoopProblem:
    """A closed loop and its starts.

    Attributes
    ----------
    text : ControllerText
        The controller, with its rule bases and tables.
    plant : Plant
        Shipped or a user's, with equations that can be traced.
    site : Site
        The wiring of the controller to the ports.
    start : dict of str to Interval
        Of each state of the plant, by name.
    parameters : dict of str to Interval
        Of each parameter of the plant, by name; most are points.
    signals : dict of (str, str) to Signal
        References, set points among them, by axis and port of an output; others are 0.
    sensors : dict of (str, str) to Sensor
        By axis and port; others are exact.
    errors : tuple of (str, str)
        Outputs whose error is bounded, too.
    begins_alone : tuple of str
        States that begin at the plant's own start, not at one of the claim.
    unknown_start : str
        Why the plant's own start is unknown; empty if it is known.
    given : Plant
        The plant before the parameters of the claim were set, as its certificate names it.
    """

    text: ControllerText
    plant: Plant
    site: Site
    start: Mapping[str, Interval]
    parameters: Mapping[str, Interval]
    signals: Mapping[Address, Signal]
    sensors: Mapping[Address, Sensor] = field(default_factory=dict)
    errors: tuple[Address, ...] = ()
    begins_alone: tuple[str, ...] = ()
    unknown_start: str = ""
    given: Plant | None = None

    def require_known_start(self) -> None:
        """Refuse a claim about runs whose start is not a single box.

        Raises
        ------
        LoopProofError
            If a state begins at the plant's own start, and that is not a single point.
        """
        if self.unknown_start:
            boxes = ", ".join(f"{name} in LOW .. HIGH" for name in self.begins_alone)
            raise LoopProofError(self.unknown_start, hint=f"say it: from {boxes}")

    def lost_beyond(self, output: Address) -> float:
        """Return the magnitude of an output beyond which a run has certainly diverged.

        The bound of the port may be smaller. For a bound b of the error, proofs keep the output
        within ``b − |r|``; a run is certainly lost beyond ``b + |r|`` only.
        """
        port = self.site.interface.outputs[output]
        far = _reach(self.signals, output)
        if port.bound < port.error_bound - far:
            return port.bound
        return port.error_bound + far

    @property
    def period(self) -> float:
        """The control period, s."""
        return float(self.text.model.period)

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the plant's states."""
        return tuple(self.plant.states)

    # --- references ---

    def with_error(self, port: Address) -> LoopProblem:
        """Return the loop with the error of another output bounded, too."""
        if port not in self.site.interface.outputs:
            name = self.site.interface.label(port)
            raise ClaimError(f"'{name}' is an input, which has no error")
        return replace(self, errors=tuple(dict.fromkeys((*self.errors, port))))

    @cached_property
    def set_point(self) -> dict[Address, float]:
        """The final value of each reference, by axis and port; 0 for rates.

        NaN if it never comes to rest.
        """
        return {
            address: self._last(address) if not reference.order else 0.0
            for address, reference in self.site.interface.references.items()
        }

    def _last(self, address: Address) -> float:
        if address not in self.signals:
            return 0.0
        return self.signals[address].stations[-1][1] if self.signals[address].stations else math.nan

    def signal_of(self, output: Address) -> Signal:
        """Return the reference of an output; 0 by default."""
        return self.signals.get(output, Signal("step", (0.0,)))

    @property
    def signals_by_name(self) -> dict[str, Signal]:
        """The references that were set, by name, as for ``simulate``."""
        interface = self.site.interface
        return {
            interface.label(address): self.signal_of(address)
            for address in interface.outputs
            if not interface.references[address].order
        }

    @cached_property
    def moved(self) -> dict[Address, MovedReference]:
        """The moving references in use, by axis and port."""
        model, references = self.text.model, self.site.interface.references
        used = {self.site.find(model, "reference", port) for port in ports_of(model, "reference")}
        signals = {a: self.signals.get(references[a].of) for a in (*used, *self.errors)}
        return {
            address: MovedReference(signal, references[address].order)
            for address, signal in signals.items()
            if signal is not None and signal.moves
        }

    def time_of(self, period: int) -> Fraction:
        """Return the start of a control period, s, as a decimal."""
        return period * decimal(self.period)

    def held_since(self, period: int) -> int:
        """Return the period in which the references held in `period` were sampled."""
        return period - period % self.text.model.every

    def simulated(self, reference: MovedReference, period: int) -> float:
        """Return a reference in a period with the bits of ``simulate``, rounding included."""
        every = self.text.model.every
        time = np.array([period // every], float) * (self.period * every)
        return float(reference.signal.at(time)[reference.order][0])

    @cached_property
    def rests_from(self) -> int | None:
        """The first control period with all references at `set_point`; None: never."""
        stations = [signal.stations for signal in self.signals.values()]
        if not all(stations):
            return None
        every = self.text.model.every
        last = max((Fraction(0), *(each[-1][0] for each in stations)))
        return math.ceil(last / (decimal(self.period) * every)) * every

    @cached_property
    def at_rest(self) -> LoopProblem:
        """The loop with all references at their final values."""
        if not self.moved:
            return self
        if self.rests_from is None:
            raise LoopProofError("its references never come to rest")
        last = {a: as_signal(self._last(a)) for a in self.signals}
        return replace(self, signals=last)

    @property
    def constants(self) -> dict[str, float]:
        """Values of time (0) and parameters (midpoints), by symbol."""
        spans = zip(self.equations.parameters, self.parameters.values(), strict=True)
        return {"t": 0.0} | {key: 0.5 * span.low + 0.5 * span.high for key, span in spans}

    @cached_property
    def equations(self) -> PlantEquations:
        """The equations of the plant; LoopProofError if they cannot be traced."""
        plant = self.plant
        roots = expressions_of(plant)
        if roots is None:
            hint = (
                "leave the queue out of the plant and delay its sensor, --sensor-delay PORT=TIME"
                if has_queue(plant)
                else "arithmetic and functions of math in `derivative`, without `if` on a state:"
                " write a switch with max, min or abs"
            )
            raise LoopProofError(f"the equations of {plant.name} cannot be traced", hint=hint)
        rates, outputs = roots
        states = tuple(f"x{k}" for k in range(len(plant.states)))
        measured = tuple(symbol(name) for name in states[: len(plant.outputs)])
        inputs = tuple(f"u{k}" for k in range(len(plant.inputs)))
        if any(set(symbols(root)) & set(inputs) for root in outputs or ()):
            raise LoopProofError(f"an output of {plant.name} depends on an input at once")
        return PlantEquations(
            tuple(rates),
            measured if outputs is None else tuple(outputs),
            states,
            inputs,
            tuple(f"p{k}" for k in range(len(plant.parameters))),
        )


def require_one_rate(model: ControllerModel) -> None:
    """Refuse a controller with an axis that skips periods."""
    slow = next((axes for axes in model.axes if axes.every > 1), None)
    if slow is not None:
        message = f"the axis '{slow.names[0]}' runs every {slow.every} control periods"
        raise LoopProofError(f"{message}: loops are proved with one rate")


LONGEST_DELAY = 1000
"""Longest delay in control periods: each is a state, and matrices grow with the square."""


def _demand_short_delays(delays: Mapping[str, float], period: float) -> None:
    """Refuse a delay of too many periods: the loop's matrices would not fit into memory."""
    for name, delay in delays.items():
        if not delay <= LONGEST_DELAY * period:
            raise LoopProofError(
                f"the delay of '{name}' is {delay / period:,.0f} control periods, each a state of"
                f" the loop: nothing is proved with more than {LONGEST_DELAY:,}"
            )


def _demand_whole_delays(delays: Mapping[str, float], period: float) -> None:
    """Refuse a fraction of a period: a sensor would round it, an actuator change inside."""
    for name, delay in delays.items():
        count = whole_periods(delay, period)
        if decimal(delay) != count * decimal(period):
            raise LoopProofError(
                f"the delay of '{name}' {fraction_of_periods(delay, period)}, and a loop is proved"
                " with whole ones",
                hint=f"{max(count, 1)} of them are {number_text(max(count, 1) * period)} s",
            )


def loop_problem(
    text: ControllerText,
    plant: Plant,
    *,
    start: Mapping[str, tuple[float, float]] | None = None,
    parameters: Mapping[str, tuple[float, float]] | None = None,
    set_point: Mapping[str, AnySignal] | None = None,
    sensors: Mapping[str, Sensor] | None = None,
    connect: Mapping[str, str] | None = None,
    inside: bool = False,
) -> LoopProblem:
    """Build the loop of a claim.

    Parameters
    ----------
    text : ControllerText
        The controller.
    plant : Plant
        The plant.
    start : mapping of str to (float, float), optional
        By state, or by output equal to a state; others begin at the plant's own start.
    parameters : mapping of str to (float, float), optional
        By name; others have their nominal value.
    set_point : mapping of str to float, str or Signal, optional
        By port: a number, or a moving reference; 0 for others.
    sensors : mapping of str to Sensor, optional
        By port.
    connect : mapping of str to str, optional
        Port of the plant for each name of the controller that differs.
    inside : bool, optional
        Whether the dead time of an actuator may end inside a period, as margins allow.

    Raises
    ------
    LoopProofError
        If a name is unknown, an interval is empty, or the plant has no equations to trace.
    PlantError
        If there is no such port.
    SourceError
        If the controller does not fit the plant.
    """
    given, values = plant, _chosen("parameter", parameters, plant.parameters)
    if values:
        # Equations, ports and start may read a parameter by name: they get its one value.
        plant = with_parameters(plant, {name: span.low for name, span in values.items()})
        _demand_arguments(plant, values)
    site = site_of(plant, connect)
    if text.model.partners:
        name = text.model.partners[0].name
        raise LoopProofError(
            f"the partner '{name}' is a law of the study, about which nothing is proved"
        )
    site.wiring(text.model)  # raises for a missing port
    for name in set(site.connect) - connectable_names(text.model):
        # A sentence about the loop would say that it is joined.
        raise LoopProofError(f"nothing in {text.model.name} is called '{name}', to be connected")
    _demand_driven_from_zero(text, site)
    delays = {name: sensor.delay for name, sensor in (sensors or {}).items()}
    dead_times = {name: port.dead_time for name, port in plant.inputs.items()}
    for times in (delays, dead_times):  # an actuator and a sensor may have one name
        _demand_short_delays(times, text.model.period)
        if times is delays or not inside:
            _demand_whole_delays(times, text.model.period)
    numbers = {name: parameter(plant, name).value for name in plant.parameters}
    values = {name: Interval(x, x) for name, x in numbers.items()} | values
    own, unknown = own_start(plant, values)
    starts = {name: Interval(x, x) for name, x in zip(plant.states, own, strict=True)}
    starts |= _chosen("state", start, plant.states)
    alone = tuple(name for name in plant.states if name not in (start or {}))
    interface = site.interface
    signals = _signals(interface, set_point or {})
    by_name = {name: interface.every_port(name) for name in sensors or {}}
    _demand_once(by_name)
    effective = {port: sensor for name, sensor in (sensors or {}).items() for port in by_name[name]}
    for port, port_sensor in effective.items():
        if port_sensor.noise:
            label = interface.label(port)
            raise LoopProofError(
                f"the noise of '{label}' has no bound", hint="a resolution or a delay has one"
            )
    site = replace(site, interface=_with_error_bounds(interface, signals))
    return LoopProblem(
        text, plant, site, starts, values, signals, effective,
        tuple(port for port, signal in signals.items() if signal.moves), alone,
        unknown if alone else "", given,
    )  # fmt: skip


def _signals(interface: Interface, references: Mapping[str, AnySignal]) -> dict[Address, Signal]:
    """Return the references by axis and port."""
    _demand_once({name: [interface.port(name)] for name in references})
    signals = {interface.port(name): as_signal(x, name) for name, x in references.items()}
    for port, signal in signals.items():
        if port not in interface.outputs or interface.references[port].order:
            kind = "reference of its own" if signal.moves else "constant set point"
            raise ClaimError(f"'{interface.label(port)}' has no {kind}")
    return signals


def _demand_driven_from_zero(text: ControllerText, site: Site) -> None:
    """Refuse `driven` for an actuator with another initial value than 0."""
    for axes, line in text.model.lines():
        source = line.source if isinstance(line, SignalLine) else None
        if source is None or source.kind != "driven":
            continue
        for axis in axes.names:
            address = site.find(text.model, "drive", (axis, source.name))
            if site.interface.inputs[address].start is not None:
                raise LoopProofError(
                    f"'driven {source.name}' begins at the start of its actuator,"
                    f" {site.interface.inputs[address].start:g}: nothing is proved about it"
                )


def _demand_once(by_name: Mapping[str, list[Address]]) -> None:
    """Refuse two values for one port, which may have two names."""
    seen: set[Address] = set()
    for name, ports in by_name.items():
        if seen & set(ports):
            raise ClaimError(f"'{name}' is said twice, by another name")
        seen |= set(ports)


def _reach(signals: Mapping[Address, Signal], output: Address) -> float:
    return signals[output].reach if output in signals else 0.0


def _with_error_bounds(interface: Interface, signals: Mapping[Address, Signal]) -> Interface:
    """Return ports with bounds that bound their errors, too: |y| ≤ b − |r| keeps |r − y| ≤ b."""
    outputs = dict(interface.outputs)
    for address, port in outputs.items():
        if math.isinf(port.error_bound):
            continue
        room = port.error_bound - _reach(signals, address)
        if room <= 0.0:
            raise LoopProofError(
                f"the set point of '{interface.label(address)}' is beyond its error bound from 0"
            )
        outputs[address] = replace(port, bound=min(port.bound, room))
    return replace(interface, outputs=outputs)


def _demand_arguments(plant: Plant, chosen: Mapping[str, Interval]) -> None:
    """Refuse a parameter that nothing reads, and an interval read otherwise than from `p`."""
    reads = reads_of(plant)
    for name in plant.parameters:
        if name in chosen and name in reads.unread:
            raise ClaimError(f"nothing of {plant.name} reads its parameter '{name}'")
    for name, span in chosen.items():
        if span.low < span.high and name in reads.by_name:
            raise LoopProofError(
                f"{plant.name} reads '{name}' by its name, which has one value there",
                hint="equations get an interval of it only by their argument p",
            )


def _chosen(
    kind: str, ranges: Mapping[str, tuple[float, float]] | None, names: Mapping[str, object]
) -> dict[str, Interval]:
    intervals = {}
    for name, (low, high) in (ranges or {}).items():
        if name not in names:
            hint = near_hint(name, list(names))[0] or f"there are {', '.join(names)}"
            raise ClaimError(f"the plant has no {kind} '{name}'", hint=hint)
        if not (math.isfinite(low) and math.isfinite(high) and low <= high):
            raise ClaimError(f"{name} in {low:g} .. {high:g} is not an interval")
        intervals[name] = Interval(float(low), float(high))
    return intervals
