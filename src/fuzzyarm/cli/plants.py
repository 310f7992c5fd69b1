"""What commands say of plants in the same words: which, references, sensors, disturbances."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.command import WordError, argument, flag, group

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from fuzzyarm.controller import Controller
    from fuzzyarm.loop import Motion, Options, Sensor
    from fuzzyarm.loop.words import PlantWords
    from fuzzyarm.plant import Plant


def _many(words: str, text: str) -> Any:
    return argument(words, text, action="append", default=[])


CONNECT = _many("--connect NAME=PORT", "join a name of the controller to a port of the plant")
SENSORS = (
    _many("--quantise PORT=STEP", "resolution of a sensor, as in 0.001 or 12bit"),
    _many("--sensor-delay PORT=TIME", "delay of a sensor, as in 3ms"),
)
"""Errors of sensors that have a bound."""

INTERPOLATE = flag("--interpolate", "move the reference between set points, instead of holding it")

MOTORS = group(
    "joints and motors of a plant that has some, as the arm",
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
        *SENSORS,
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

    names = {controller.name: site_for(controller, connect).name for controller in controllers}
    if len(set(names.values())) > 1:
        words = ", ".join(f"{name} on {plant}" for name, plant in names.items())
        raise WordError(
            f"the controllers run on different plants: {words}", hint="--plant names one"
        )
    return next(iter(names.values()))


def options_of(arguments: argparse.Namespace, plant: Plant) -> Options:
    """Return sensors, disturbances and the rest of how to run."""
    return _words(arguments).options(plant)


def sensors_of(arguments: argparse.Namespace, plant: Plant) -> Mapping[str, Sensor]:
    """Return the sensors that the arguments name."""
    return _words(arguments).options(plant).sensors


def connections(arguments: argparse.Namespace) -> dict[str, str]:
    """Return which names of the controller mean which ports of the plant."""
    return _words(arguments).connections()


def motion_of(arguments: argparse.Namespace, controller: Controller, plant: Plant) -> Motion:
    """Return the set points of a plant that follows references."""
    return _words(arguments).motion(controller, plant)


# --- Which options a plant understands ---

ALONG = ("trajectory", "angles", "way_points", "segment", "hold")
"""Options for plants that follow trajectories."""

CARRIED = ("payload", "loaded", "load_in_hold")
"""Options for plants that carry a load, along a trajectory."""

REFERRED = ("reference", "step", "duration")
"""Options of runs along references, which any plant follows."""

DRIVES = {"limits": "torque_limits", "supply": "supply", "inductance": "inductance"}
COUNTING = ("conventions", "precision", "pi")
"""Options that a plant has to name: of its drives, by the fields of ``Options``; of counting."""

USUAL: dict[str, Any] = {"payload": False, "load_in_hold": True, "conventions": "plain"}
"""Options that say nothing where they are this."""


def option_given(
    arguments: argparse.Namespace, names: Iterable[str], payload: bool | None = False
) -> str:
    """Return the first option among some that is given, as it is written; empty for none.

    `payload` is what a command has by itself.
    """
    for name in names:
        value, usual = getattr(arguments, name, None), USUAL.get(name)
        if name == "payload":
            usual = payload
        if value not in (None, [], usual):
            word = "for" if name == "duration" else name.replace("_", "-")
            return f"--{'no-' if value is False else ''}{word}"
    return ""


def follows(arguments: argparse.Namespace, plant: Plant, payload: bool | None = False) -> bool:
    """Whether a plant is to follow a trajectory, and not references.

    Raises
    ------
    WordError
        If an option is given that the plant does not understand, with what it has instead.
    """
    _require_known(arguments, plant, payload)
    if not plant.trajectories:
        return False
    reference = option_given(arguments, REFERRED)
    other = option_given(arguments, (*ALONG, *CARRIED), payload)
    if reference and other:
        raise WordError(f"{reference} is for references, and {other} for a trajectory: give one")
    if reference == "--for":
        hint = "--segment and --hold say how long a trajectory is"
        raise WordError("--for says how long --reference or --step is followed", hint=hint)
    return not reference


def _require_known(arguments: argparse.Namespace, plant: Plant, payload: bool | None) -> None:
    """Raise WordError for an option that a plant does not understand."""
    from fuzzyarm.plant.following import carries

    name, known = plant.name, plant.particulars.options
    option = option_given(arguments, ALONG)
    if option and not plant.trajectories:
        message = f"{option} is for plants that follow trajectories"
        raise WordError(f"{message}; {name} takes --reference")
    option = option_given(arguments, CARRIED, payload)
    if option and not carries(plant):
        has = ", ".join(plant.parameters)
        instead = f"--set changes its parameters: {has}" if has else "it has no parameters"
        raise WordError(f"{option} is for plants that carry a load; {name} does not, {instead}")
    option = option_given(arguments, (key for key, field in DRIVES.items() if field not in known))
    if option:
        bounded = "--actuator INPUT=LOW..HIGH bounds a drive"
        raise WordError(f"{name} has no {option}; {bounded}: {', '.join(plant.inputs)}")
    option = option_given(arguments, (key for key in COUNTING if key not in known))
    if option:
        counts = "it counts in double precision with the true π"
        raise WordError(f"{name} has no {option}; {counts}")


def equipped_by(arguments: argparse.Namespace, plant: Plant) -> tuple[Plant, Options]:
    """Return a plant with the drives that the arguments ask for, and the options of a run."""
    from fuzzyarm.loop.along import equipped

    options = options_of(arguments, plant)
    return equipped(plant, options), options


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
