"""What commands say of plants in the same words: which, references, sensors, disturbances."""

from __future__ import annotations

import argparse
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.command import WordError, argument, flag, group

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from fuzzyarm.controller import Controller
    from fuzzyarm.loop import Motion, Options
    from fuzzyarm.loop.words import PlantWords
    from fuzzyarm.plant import Plant


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
            "arm, motor, cartpole, tanks, ball-and-beam, room, FILE.py or FILE.py:CLASS; "
            "by default the shipped one that has the axes of the controller",
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
    """Read a time with its unit, s; see :func:`fuzzyarm.loop.reference.read_time`."""
    from fuzzyarm.loop.reference import read_time

    return read_time(text, option)


def _words(arguments: argparse.Namespace) -> PlantWords:
    from fuzzyarm.loop.words import PlantWords

    return PlantWords.of(arguments)


def plant_of(arguments: argparse.Namespace, controllers: Sequence[Controller]) -> Plant:
    """Return the plant that the arguments name, with its actuators.

    Where they name none it is the shipped one that has the axes of the controllers, and the
    arguments name that from then on.
    """
    if arguments.plant is None:
        arguments.plant = _plant_by_axes(controllers, connections(arguments))
    return _words(arguments).find_plant()


def _plant_by_axes(controllers: Sequence[Controller], connect: Mapping[str, str]) -> str:
    from fuzzyarm.controller.findings import site_for

    names = {each.name: site_for(each, connect).name for each in controllers}
    if len(set(names.values())) > 1:
        words = ", ".join(f"{name} on {plant}" for name, plant in names.items())
        raise WordError(
            f"the controllers run on different plants: {words}", hint="--plant names one"
        )
    return next(iter(names.values()))


def options_of(arguments: argparse.Namespace, plant: Plant) -> Options:
    """Return sensors, disturbances and the rest of how to run."""
    return _words(arguments).options(plant)


def motors_of(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return what is said of the arm's joints and motors, by the names of the options of a run."""
    return _words(arguments).motors()


def connections(arguments: argparse.Namespace) -> dict[str, str]:
    """Return which names of the controller mean which ports of the plant."""
    return _words(arguments).connections()


def motion_of(arguments: argparse.Namespace, controller: Controller, plant: Plant) -> Motion:
    """Return the set points of a plant other than the arm."""
    return _words(arguments).motion(controller, plant)


OF_THE_ARM: dict[str, Any] = {
    "payload": False, "loaded": None, "angles": None, "way_points": None, "segment": None,
    "hold": None, "limits": None, "supply": None, "inductance": None, "conventions": "plain",
    "precision": None, "pi": None, "load_in_hold": True,
}  # fmt: skip
"""Options that only the arm understands, and what they are where nobody gives them."""

OF_OTHERS = (
    "connect", "duration", "step", "reference", "noise", "quantise", "sensor_delay", "difference",
    "actuator", "disturb",
)  # fmt: skip
"""Options that are for other plants."""


def option_given(arguments: argparse.Namespace, names: Iterable[str]) -> str | None:
    """Return the first option for other plants among `names` that is given, as it is written."""
    for name in names:
        if getattr(arguments, name, None) not in (None, []):
            return "--for" if name == "duration" else f"--{name.replace('_', '-')}"
    return None


OF_COMPARED: dict[str, Any] = {"cost": False, "operations": False, "errors": None}
"""Options of ``compare`` that are for the arm, too."""


def require_plain(
    arguments: argparse.Namespace,
    *,
    payload: bool | None = False,
    others: Mapping[str, Any] = MappingProxyType({}),
) -> None:
    """Refuse what only the arm understands; `payload` is what a command has by itself."""
    for name, usual in (OF_THE_ARM | {"payload": payload} | dict(others)).items():
        value = getattr(arguments, name, usual)
        if value is not None and value != usual:
            option = f"--{'no-' if value is False else ''}{name.replace('_', '-')}"
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
