"""An experiment on a plant as a user writes it: references, sensors, actuators, disturbances.

The command line and the designer take the same words, ``position=step:1`` or ``voltage=-5..5``,
and say the same of those that mean nothing.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

from fuzzyarm.controller.controller import Controller
from fuzzyarm.errors import WordError
from fuzzyarm.loop.course import Motion, Options, Sensor
from fuzzyarm.loop.reference import Signal, read_signal, read_time
from fuzzyarm.loop.run import plant_motion
from fuzzyarm.plant.own import find_plant
from fuzzyarm.plant.plant import Plant, Port, interface_of, with_actuators

_Value = TypeVar("_Value")


@dataclass(frozen=True)
class PlantWords:
    """What is said of an experiment, by the names of the options of ``fuzzyarm simulate``.

    Parameters
    ----------
    plant : str, optional
        A shipped plant, or a file.
    connect, reference, noise, quantise, sensor_delay, difference, actuator, disturb : sequence
        of str, optional
        ``NAME=VALUE`` each.
    duration : str or None, optional
        With its unit.
    step : float or None, optional
        Of the first reference.
    interpolate : bool, optional
        Whether the reference moves between set points.
    seed, runge_kutta : int, optional
        Of noise and disturbance; steps of the integrator in a control period.
    limits : sequence of float or None, optional
        Largest torques of the joints, N m.
    supply, inductance : float or None, optional
        Of the motors, V and H.
    """

    plant: str = ""
    connect: Sequence[str] = ()
    duration: str | None = None
    step: float | None = None
    reference: Sequence[str] = ()
    noise: Sequence[str] = ()
    quantise: Sequence[str] = ()
    sensor_delay: Sequence[str] = ()
    difference: Sequence[str] = ()
    actuator: Sequence[str] = ()
    disturb: Sequence[str] = ()
    interpolate: bool = False
    seed: int = 1
    runge_kutta: int = 0
    limits: Sequence[float] | None = None
    supply: float | None = None
    inductance: float | None = None

    @classmethod
    def of(cls, said: object) -> PlantWords:
        """Return the words among the attributes of something, as a parsed command line."""
        known = vars(said)
        return cls(
            **{field.name: known[field.name] for field in fields(cls) if field.name in known}
        )

    def driven(self, plant: Plant) -> Plant:
        """Return a plant with the actuators that are said.

        Raises
        ------
        WordError
            If a word is not understood.
        PlantError
            If there is no such input.
        """
        actuators = read_pairs(self.actuator, "--actuator", _actuator)
        return with_actuators(plant, actuators) if actuators else plant

    def find_plant(self) -> Plant:
        """Return the plant that is said, with its actuators; a Python file is executed."""
        return self.driven(find_plant(self.plant))

    def connections(self) -> dict[str, str]:
        """Return which names of the controller mean which ports of the plant."""
        return read_pairs(self.connect, "--connect", str)

    def signals(self) -> dict[str, Signal]:
        """Return the references that are said, by port.

        Raises
        ------
        WordError
            If a word is not understood.
        PlantError
            If there is no such signal.
        """
        return read_pairs(self.reference, "--reference", read_signal)

    def options(self, plant: Plant) -> Options:
        """Return sensors, disturbances and the rest of how to run.

        Raises
        ------
        WordError
            If a word is not understood.
        """
        given: dict[str, Any] = {
            "seed": self.seed,
            "interpolate": self.interpolate,
            "sensors": self._sensors(plant),
            "loads": read_pairs(self.disturb, "--disturb", read_signal),
            "runge_kutta": self.runge_kutta,
        }
        return Options(**given, **self.motors())

    def motors(self) -> dict[str, Any]:
        """Return what is said of joints and motors, by the names of options of a run."""
        given: dict[str, Any] = {}
        if self.limits is not None:
            given["torque_limits"] = tuple(self.limits)
        for name in ("supply", "inductance"):
            if getattr(self, name) is not None:
                given[name] = getattr(self, name)
        return given

    def motion(self, controller: Controller, plant: Plant) -> Motion:
        """Return the set points of a plant that follows references.

        Raises
        ------
        WordError
            If a word is not understood, or two say the same thing.
        PlantError
            If there is no such port, signal or duration.
        """
        duration = read_time(self.duration, "--for") if self.duration is not None else None
        references = self.signals()
        connect = self.connections()
        if self.step is not None:
            if references:
                raise WordError("--step and --reference say the same thing; give one of them")
            return plant_motion(
                controller, plant, None, duration, connect, step=Signal("step", (self.step,))
            )
        return plant_motion(controller, plant, references or None, duration, connect)

    def _sensors(self, plant: Plant) -> dict[str, Sensor]:
        sensors: dict[str, Sensor] = {}

        def change(values: Mapping[str, float], field: str) -> None:
            for name, value in values.items():
                sensors[name] = replace(sensors.get(name, Sensor()), **{field: value})

        def time(option: str) -> Callable[[str], float]:
            return lambda text: read_time(text, option)

        steps = {
            name: _resolution(text, name, plant)
            for name, text in read_pairs(self.quantise, "--quantise", str).items()
        }
        change(read_pairs(self.noise, "--noise", read_number("--noise")), "noise")
        change(steps, "resolution")
        change(read_pairs(self.sensor_delay, "--sensor-delay", time("--sensor-delay")), "delay")
        change(read_pairs(self.difference, "--difference", time("--difference")), "difference")
        return sensors


def read_pairs(
    words: Sequence[str], option: str, read: Callable[[str], _Value]
) -> dict[str, _Value]:
    """Read words like ``position=0.001``."""
    found = {}
    for word in words:
        name, equals, text = word.partition("=")
        if not equals or not name.strip() or not text.strip():
            raise WordError(f"{option} takes NAME=VALUE, not '{word}'")
        found[name.strip()] = read(text.strip())
    return found


def read_number(option: str) -> Callable[[str], float]:
    """Return what reads a number for an option."""

    def read(text: str) -> float:
        try:
            return float(text)
        except ValueError:
            raise WordError(f"{option} takes a number, not '{text}'") from None

    return read


def _actuator(text: str) -> Port:
    limits, _, slew = text.partition(",")
    low, dots, high = limits.partition("..")
    read = read_number("--actuator")
    if not dots:
        raise WordError(f"--actuator takes INPUT=LOW..HIGH or INPUT=LOW..HIGH,SLEW, not '{text}'")
    return Port(low=read(low), high=read(high), slew=read(slew) if slew else math.inf)


def _resolution(text: str, name: str, plant: Plant) -> float:
    """Return a step; so many bits are spread over the range of the sensor."""
    match = re.fullmatch(r"(\d{1,2})\s*bits?", text)
    if match is None:
        return float(read_number("--quantise")(text))
    interface = interface_of(plant)
    port = interface.outputs.get(interface.every_port(name)[0])
    if port is None or not math.isfinite(port.high - port.low) or not int(match[1]):
        hint = f"write the step, as in {name}=0.001"
        raise WordError(f"--quantise: the sensor of '{name}' has no range for {text}; {hint}")
    return float(port.high - port.low) / 2.0 ** int(match[1])
