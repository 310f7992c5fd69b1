"""What commands say of plants in the same words: which, references, sensors, disturbances."""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

from fuzzyarm.cli.command import WordError, argument, flag, group
from fuzzyarm.model.controller import TIMES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fuzzyarm.controller import Controller
    from fuzzyarm.loop import Motion, Options, Sensor, Signal
    from fuzzyarm.plant import Plant, Port

_Value = TypeVar("_Value")


def _many(words: str, text: str) -> Any:
    return argument(words, text, action="append", default=[])


CONNECT = _many("--connect NAME=PORT", "join a name of the controller to a port of the plant")
INTERPOLATE = flag("--interpolate", "move the reference between set points, instead of holding it")

MOTORS = group(
    "joints and motors of the arm",
    argument("--limits T1 T2", "largest torques, N m", type=float),
    argument("--supply V", "largest voltage at a motor", type=float),
    argument("--inductance H", "inductance of each armature; 0 by default", type=float),
)

PLANT = (
    *group(
        "plant",
        argument(
            "--plant PLANT",
            "arm (default), motor, cartpole, tanks, ball-and-beam, room, FILE.py or FILE.py:CLASS",
            default="arm",
        ),
        CONNECT,
        argument("--for TIME", "how long, as in 2s, 500ms, 1h", dest="duration"),
        argument("--step VALUE", "step of the first reference, 1 by default", type=float),
        _many("--reference PORT=SIGNAL", "step:1, ramp:0.5, sine:1,0.5, quintic:1,2, FILE.csv"),
    ),
    *group(
        "sensors, actuators and disturbances",
        _many("--noise PORT=DEVIATION", "white noise of a sensor"),
        _many("--quantise PORT=STEP", "resolution of a sensor, as in 0.001 or 12bit"),
        _many("--sensor-delay PORT=TIME", "delay of a sensor, as in 3ms"),
        _many("--difference PORT=TIME", "form a rate by difference, with a filter of this time"),
        _many("--actuator INPUT=LOW..HIGH", "limits of a drive; a slew behind a comma: -5..5,100"),
        _many("--disturb INPUT=SIGNAL", "add this to a drive, as in voltage=step:-2,1"),
        INTERPOLATE,
        argument("--seed N", "seed of noise and disturbance", type=int, default=1),
    ),
)
"""Arguments of every command that runs a plant."""


def time_of(text: str, option: str) -> float:
    """Read a time with its unit, s.

    Raises
    ------
    WordError
        If it is not one.
    """
    match = re.fullmatch(r"([0-9.eE+-]+)\s*([a-z]+)", text.strip())
    try:
        if match is None or match[2] not in TIMES:
            raise ValueError
        times, divisor = TIMES[match[2]]
        value = float(match[1]) * times / divisor
        if not (math.isfinite(value) and value >= 0):
            raise ValueError
    except ValueError:
        units = ", ".join(TIMES)
        raise WordError(f"{option} takes a time with a unit ({units}), not '{text}'") from None
    return value


def _pairs(words: list[str], option: str, read: Callable[[str], _Value]) -> dict[str, _Value]:
    """Read words like ``position=0.001``."""
    found = {}
    for word in words:
        name, equals, text = word.partition("=")
        if not equals or not name.strip() or not text.strip():
            raise WordError(f"{option} takes NAME=VALUE, not '{word}'")
        found[name.strip()] = read(text.strip())
    return found


def _number(option: str) -> Callable[[str], float]:
    def read(text: str) -> float:
        try:
            return float(text)
        except ValueError:
            raise WordError(f"{option} takes a number, not '{text}'") from None

    return read


def plant_of(arguments: argparse.Namespace) -> Plant:
    """Return the plant that the arguments name, with its actuators."""
    from fuzzyarm.plant import find_plant
    from fuzzyarm.plant.plant import with_actuators

    plant = find_plant(arguments.plant)
    actuators = _pairs(arguments.actuator, "--actuator", _actuator)
    return with_actuators(plant, actuators) if actuators else plant


def _actuator(text: str) -> Port:
    from fuzzyarm.plant import Port

    limits, _, slew = text.partition(",")
    low, dots, high = limits.partition("..")
    read = _number("--actuator")
    if not dots:
        raise WordError(f"--actuator takes INPUT=LOW..HIGH or INPUT=LOW..HIGH,SLEW, not '{text}'")
    return Port(low=read(low), high=read(high), slew=read(slew) if slew else math.inf)


def options_of(arguments: argparse.Namespace, plant: Plant) -> Options:
    """Return sensors, disturbances and the rest of how to run."""
    from fuzzyarm.loop import Options, read_signal

    given: dict[str, Any] = {
        "seed": arguments.seed,
        "interpolate": arguments.interpolate,
        "sensors": _sensors(arguments, plant),
        "loads": _pairs(arguments.disturb, "--disturb", read_signal),
        "runge_kutta": getattr(arguments, "runge_kutta", 0),
    }
    return Options(**given, **motors_of(arguments))


def motors_of(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return what is said of the arm's joints and motors, by the names of the options of a run."""
    given: dict[str, Any] = {}
    if getattr(arguments, "limits", None) is not None:
        given["torque_limits"] = tuple(arguments.limits)
    for name in ("supply", "inductance"):
        if getattr(arguments, name, None) is not None:
            given[name] = getattr(arguments, name)
    return given


def _sensors(arguments: argparse.Namespace, plant: Plant) -> dict[str, Sensor]:
    from fuzzyarm.loop import Sensor

    found: dict[str, Sensor] = {}

    def change(values: Mapping[str, float], field: str) -> None:
        for name, value in values.items():
            found[name] = replace(found.get(name, Sensor()), **{field: value})

    def time(option: str) -> Callable[[str], float]:
        return lambda text: time_of(text, option)

    steps = {
        name: _resolution(text, name, plant)
        for name, text in _pairs(arguments.quantise, "--quantise", str).items()
    }
    change(_pairs(arguments.noise, "--noise", _number("--noise")), "noise")
    change(steps, "resolution")
    change(_pairs(arguments.sensor_delay, "--sensor-delay", time("--sensor-delay")), "delay")
    change(_pairs(arguments.difference, "--difference", time("--difference")), "difference")
    return found


def _resolution(text: str, name: str, plant: Plant) -> float:
    """Return a step; so many bits are spread over the range of the sensor."""
    from fuzzyarm.plant.plant import interface_of

    match = re.fullmatch(r"(\d{1,2})\s*bits?", text)
    if match is None:
        return float(_number("--quantise")(text))
    interface = interface_of(plant)
    port = interface.outputs.get(interface.every_port(name)[0])
    if port is None or not math.isfinite(port.high - port.low) or not int(match[1]):
        hint = f"write the step, as in {name}=0.001"
        raise WordError(f"--quantise: the sensor of '{name}' has no range for {text}; {hint}")
    return float(port.high - port.low) / 2.0 ** int(match[1])


def connections(arguments: argparse.Namespace) -> dict[str, str]:
    """Return which names of the controller mean which ports of the plant."""
    return _pairs(arguments.connect, "--connect", str)


def motion_of(
    arguments: argparse.Namespace, controller: Controller, plant: Plant, connect: Mapping[str, str]
) -> Motion:
    """Return the set points of a plant other than the arm."""
    from fuzzyarm.loop import Signal, read_signal
    from fuzzyarm.loop.run import plant_motion

    duration = time_of(arguments.duration, "--for") if arguments.duration is not None else None
    references: dict[str, Signal] = _pairs(arguments.reference, "--reference", read_signal)
    if arguments.step is not None:
        if references:
            raise WordError("--step and --reference say the same thing; give one of them")
        return plant_motion(
            controller, plant, None, duration, connect, step=Signal("step", (arguments.step,))
        )
    return plant_motion(controller, plant, references or None, duration, connect)


def require_plain(arguments: argparse.Namespace) -> None:
    """Refuse what only the arm understands."""
    given = {
        "--payload": arguments.payload,
        "--loaded": arguments.loaded,
        "--angles": arguments.angles,
        "--way-points": arguments.way_points,
        "--segment": arguments.segment is not None,
        "--hold": arguments.hold is not None,
        "--limits": getattr(arguments, "limits", None),
        "--supply": getattr(arguments, "supply", None),
        "--inductance": getattr(arguments, "inductance", None) is not None,
        "--conventions": arguments.conventions != "plain",
        "--precision": arguments.precision,
    }
    for option, value in given.items():
        if value:
            raise WordError(f"{option} is for the arm; {arguments.plant} takes --reference")


def split_settings(
    values: Mapping[str, list[float]], controller: Controller, plant: Plant
) -> tuple[dict[str, list[float]], dict[str, float]]:
    """Divide what ``--set`` gives between gains of the controller and parameters of the plant.

    A name that neither has goes to the controller, which says what it has.
    """
    from fuzzyarm.loop.many import owner_of

    gains: dict[str, list[float]] = {}
    parameters: dict[str, float] = {}
    for name, value in values.items():
        bare = name.removeprefix("plant.")
        if bare == name and owner_of(name, controller, plant) != "parameter":
            gains[name] = value
        elif len(value) != 1:
            raise WordError(f"parameter {bare} of the plant takes one number, not {len(value)}")
        else:
            parameters[bare] = value[0]
    return gains, parameters
