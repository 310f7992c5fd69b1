"""The words of an experiment: plant, references, sensors, actuators, disturbances.

Command line, designer and Python share the `ExperimentRequest`, with words such as
``position=step:1`` or ``voltage=-5..5``, and the same errors for invalid ones.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any, TypeVar

from fuzzyarm.base.errors import UsageError, WordError, of_the_command_line
from fuzzyarm.base.numbers import read_time
from fuzzyarm.control.controllers.controller import Controller
from fuzzyarm.control.loop.course import Motion, Options, Sensor
from fuzzyarm.control.loop.reference import Signal, read_signal
from fuzzyarm.control.loop.run import plant_motion, stepped
from fuzzyarm.plant.own import find_plant
from fuzzyarm.plant.plant import Plant, PlantError, Port, interface_of, with_actuators
from fuzzyarm.plant.setting import PLAIN, STUDY, ArmError, Conventions
from fuzzyarm.requests.experiment import AROUND, ExperimentRequest
from fuzzyarm.requests.fields import fields_of

_Value = TypeVar("_Value")


def driven(request: ExperimentRequest, plant: Plant) -> Plant:
    """Return the plant with the requested actuators."""
    actuators = read_pairs(request.actuator, "--actuator", _actuator)
    delays = read_pairs(request.actuator_delay, "--actuator-delay", _time_of("--actuator-delay"))
    return with_actuators(plant, actuators, delays) if actuators or delays else plant


def named_plant(request: ExperimentRequest) -> Plant:
    """Return the named plant with its actuators; a Python file is executed."""
    return driven(request, find_plant(request.plant or ""))


def connections(request: ExperimentRequest) -> dict[str, str]:
    """Return the mapping from names of the controller to ports of the plant."""
    return read_pairs(request.connect, "--connect", str)


def signals(request: ExperimentRequest) -> dict[str, Signal]:
    """Return the references, by port."""
    return read_pairs(request.reference, "--reference", read_signal)


def seconds(request: ExperimentRequest) -> float | None:
    """Return the duration along references, s; None if unset."""
    return read_time(request.duration, "--for") if request.duration is not None else None


def options_of(request: ExperimentRequest, plant: Plant) -> Options:
    """Return sensors, disturbances and the other run options."""
    arguments: dict[str, Any] = {}
    if request.limits is not None:
        arguments["torque_limits"] = request.limits
    for name in ("supply", "inductance"):
        if getattr(request, name) is not None:
            arguments[name] = getattr(request, name)
    return Options(
        seed=request.seed,
        interpolate=request.interpolate,
        sensors=sensors_of(request, plant),
        loads=read_pairs(request.disturb, "--disturb", read_signal),
        runge_kutta=request.runge_kutta,
        **arguments,
    )


def motion_of(request: ExperimentRequest, controller: Controller, plant: Plant) -> Motion:
    """Return the set points of a plant along references."""
    references, connect = references_of(request, controller, plant), connections(request)
    return plant_motion(controller, plant, references, seconds(request), connect)


def references_of(
    request: ExperimentRequest, controller: Controller, plant: Plant
) -> dict[str, Signal] | None:
    """Return the references by port; ``step`` is for the output followed by the controller."""
    references = signals(request) or None
    if request.step is None:
        return references
    if references:
        raise UsageError("--step and --reference exclude each other: give one of them")
    return stepped(controller, plant, request.step, connect=connections(request))


def conditions(request: ExperimentRequest) -> str:
    """Return the settings of a loop and its surroundings in words: noise, delays, disturbances."""
    words = []
    for field in fields_of(type(request)):
        value = getattr(request, field.name)
        # The seed matters only with noise; then even its default does.
        is_said = value != field.default or (field.name == "seed" and request.noise)
        if not is_said or (field.spec.group != AROUND and field.name != "set"):
            continue
        name = field.spelling.lstrip("-").replace("-", " ")
        words.append(name if value is True else f"{name} {_listed(value)}")
    return ", ".join(words)


def _listed(value: object) -> str:
    return " and ".join(map(str, value)) if isinstance(value, tuple) else str(value)


def conventions_of(request: ExperimentRequest) -> Conventions:
    """Return the numerical conventions: the same for every controller."""
    conventions = STUDY if request.conventions == "study" else PLAIN
    changed: dict[str, Any] = {"load_in_hold": request.load_in_hold}
    if request.precision:
        changed["precision"] = request.precision
    if request.pi is not None:
        changed["pi"] = request.pi
    with of_the_command_line(ArmError):
        return replace(conventions, **changed)


@contextmanager
def times_and_angles() -> Iterator[None]:
    """Turn a time or an angle out of range into `UsageError`.

    Errors that depend on the plant, as a missing hold, pass.
    """
    try:
        yield
    except ArmError as error:
        if error.name not in ("angle", "duration"):
            raise
        raise UsageError(error.message, hint=error.hint) from None


# --- Sensors and actuators ---


def sensors_of(request: ExperimentRequest, plant: Plant) -> dict[str, Sensor]:
    """Return the non-ideal sensors by port; WordError for an invalid word."""
    sensors: dict[str, Sensor] = {}

    def change(values: Mapping[str, float], field: str, option: str = "") -> None:
        for name, value in values.items():
            try:
                sensors[name] = replace(sensors.get(name, Sensor()), **{field: value})
            except PlantError as error:
                message = f"--{option or field} {name}={value:g} is out of range"
                raise UsageError(message, hint=error.hint) from None

    steps = {
        name: _resolution(text, name, plant)
        for name, text in read_pairs(request.quantise, "--quantise", str).items()
    }
    change(read_pairs(request.noise, "--noise", read_number("--noise")), "noise")
    change(steps, "resolution", "quantise")
    delays = read_pairs(request.sensor_delay, "--sensor-delay", _time_of("--sensor-delay"))
    change(delays, "delay", "sensor-delay")
    change(read_pairs(request.difference, "--difference", _time_of("--difference")), "difference")
    return sensors


def read_pairs(
    words: Sequence[str], option: str, read: Callable[[str], _Value]
) -> dict[str, _Value]:
    """Read words like ``position=0.001``."""
    pairs = {}
    for word in words:
        name, equals, text = word.partition("=")
        if not equals or not name.strip() or not text.strip():
            raise UsageError(f"{option} takes NAME=VALUE, not '{word}'")
        if name.strip() in pairs:
            raise UsageError(f"{option} names '{name.strip()}' twice")
        pairs[name.strip()] = read(text.strip())
    return pairs


def _time_of(option: str) -> Callable[[str], float]:
    return lambda text: read_time(text, option)


def read_number(option: str) -> Callable[[str], float]:
    """Return a reader of numbers for an option."""

    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if math.isnan(value):
            raise UsageError(f"{option} takes a number, not '{text}'")
        return value

    return read


def _actuator(text: str) -> Port:
    limits, *words = text.split(",")
    low, dots, high = limits.partition("..")
    reader = read_number("--actuator")
    behind: dict[str, float] = {}
    for word in words:
        name, _, number = (word if "=" in word else f"slew={word}").partition("=")
        name = name.strip()
        if name not in ("slew", "start") or name in behind:
            dots = ""
            break
        behind[name] = reader(number)
    if not dots:
        message = (
            f"--actuator takes INPUT=LOW..HIGH, with ,slew=VALUE and ,start=VALUE, not '{text}'"
        )
        raise UsageError(message)
    with of_the_command_line(PlantError):
        slew, start = behind.get("slew", math.inf), behind.get("start")
        return Port(low=reader(low), high=reader(high), slew=slew, start=start)


MOST_BITS = 32
"""Bits of a converter: no sensor has finer steps, and a double has 53."""


def _resolution(text: str, name: str, plant: Plant) -> float:
    """Return a resolution; a number of bits divides the range of the sensor."""
    match = re.fullmatch(r"(\d{1,2})\s*bits?", text)
    if match is None:
        return float(read_number("--quantise")(text))
    interface = interface_of(plant)
    port = interface.outputs.get(interface.every_port(name)[0])
    if not 1 <= int(match[1]) <= MOST_BITS:
        raise UsageError(f"--quantise takes 1 to {MOST_BITS} bits, not {text}")
    if port is None or not math.isfinite(port.high - port.low):
        hint = f"write the step, as in {name}=0.001"
        raise WordError(f"--quantise: the sensor of '{name}' has no range for {text}; {hint}")
    # A converter of n bits divides its range into 2ⁿ steps.
    return float(port.high - port.low) / 2.0 ** int(match[1])
