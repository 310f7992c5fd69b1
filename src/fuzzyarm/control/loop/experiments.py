"""From an `ExperimentRequest` to controllers, files, plant and set points.

Shared by the commands that run a loop and by the Python calls.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar

from fuzzyarm.base import above
from fuzzyarm.base.errors import UsageError, WordError
from fuzzyarm.base.shipped_files import shipped, shipped_names
from fuzzyarm.control.controllers.catalogue import CATALOGUE, Sources, entries_if_any
from fuzzyarm.control.controllers.controller import Controller
from fuzzyarm.control.controllers.findings import site_for
from fuzzyarm.control.controllers.law import GainError
from fuzzyarm.control.controllers.on_plant import text_law_of
from fuzzyarm.control.controllers.own import find_controllers
from fuzzyarm.control.loop.along import equipped, trajectory_motion
from fuzzyarm.control.loop.course import Motion, Options
from fuzzyarm.control.loop.many import owner_of, unknown_setting
from fuzzyarm.control.loop.words import (
    connections,
    conventions_of,
    motion_of,
    named_plant,
    options_of,
    times_and_angles,
)
from fuzzyarm.plant.following import UnknownTrajectoryError, carries, trajectory_of, way_points
from fuzzyarm.plant.plant import Plant, with_parameters
from fuzzyarm.plant.trajectory import Trajectory
from fuzzyarm.requests.experiment import ExperimentRequest
from fuzzyarm.requests.fields import unknown_choice
from fuzzyarm.table import LookupTable

_Request = TypeVar("_Request", bound=ExperimentRequest)

# --- Controllers ---


def controllers_of(request: ExperimentRequest, names: Sequence[str]) -> list[Controller]:
    """Return the controllers by name, with distinct names."""
    controllers = find_controllers(
        names, start=request.start, variant=request.variant, sources=sources_of(request)
    )
    _require_choice(request, names, controllers)
    return controllers


def _require_choice(
    request: ExperimentRequest, names: Sequence[str], controllers: Sequence[Controller]
) -> None:
    """Raise UsageError for a start or a variant without effect."""
    entries = [entry for name in names for entry in entries_if_any(name)]
    laws = [text_law_of(part) for controller in controllers for part in controller.parts()]
    partners = {p.law for law in laws if law is not None for p in law.text.model.partners}
    adaptive = [entry.name for entry in CATALOGUE.values() if entry.adaptive]
    if request.start != "warm" and not partners.union(e.name for e in entries) & set(adaptive):
        hint = f"they are {', '.join(adaptive)}"
        raise UsageError(f"--start {request.start} is for adaptive controllers", hint=hint)
    if request.variant != "as-printed" and not any(entry.described for entry in entries):
        both = ", ".join(entry.name for entry in CATALOGUE.values() if entry.described)
        message = f"--variant {request.variant} is for controllers of which the study has two"
        raise UsageError(message, hint=f"they are {both}")


def sources_of(request: ExperimentRequest) -> Sources:
    """Return the replacements of a controller's rule bases and tables."""
    return Sources(
        above.function("load_rules")(request.rulebase, "--rulebase") if request.rulebase else None,
        above.function("load_rules")(request.alpha, "--alpha") if request.alpha else None,
        control_tables(request.table, "--table") if request.table else None,
        performance_table(request.performance) if request.performance else None,
    )


def control_tables(paths: Sequence[str], option: str) -> tuple[LookupTable, ...]:
    """Return the table of one file, or those of both joints from two.

    A rule base is compiled at the levels of its file.
    """
    if len(paths) > 2:
        raise WordError(f"{option} takes one file, or one for each of the two joints")
    return tuple(map(above.function("load_sampled"), paths))


def performance_table(word: str) -> LookupTable:
    """Return a performance table: from a file, or a shipped one by its author."""
    name = f"performance-{word}.lut"
    is_shipped = not Path(word).exists() and name in shipped_names()
    table: LookupTable = above.function("load_sampled")(str(shipped(name)) if is_shipped else word)
    return table


# --- Settings: gains of the controller, parameters of the plant ---


def with_settings(
    request: ExperimentRequest, controllers: Sequence[Controller], plant: Plant
) -> tuple[list[Controller], Plant]:
    """Return the controllers with new gains and the plant with new parameters.

    A gain is set in every controller with that name.
    """
    gains, parameters = split_settings(overrides(request.set), controllers, plant)
    changed = []
    for controller in controllers:
        own = {k: v for k, v in gains.items() if owner_of(k, [controller], plant) == "gain"}
        changed.append(controller.with_gains(own))
        changed[-1].name = controller.name
    return changed, with_parameters(plant, parameters) if parameters else plant


def overrides(words: Sequence[str]) -> dict[str, list[float]]:
    """Return the gains in words like ``K_P=120,80``."""
    values = {}
    for word in words:
        name, _, text = word.partition("=")
        if not name.strip() or not text.strip():
            raise UsageError(f"--set takes NAME=NUMBER, not '{word}'", hint="as in K_P=120")
        values[name.strip()] = [_number_of(part.strip(), word) for part in text.split(",")]
    return values


def _number_of(text: str, word: str) -> float:
    """Return a finite number of ``--set``."""
    with suppress(ValueError):
        value = float(text)
        if math.isfinite(value):
            return value
    hint = "as in K_P=120 or K_P=120,80"
    if ".." in text:
        hint = "fuzzyarm sweep takes ranges, as in --sweep NAME=LOW..HIGH:COUNT"
    raise UsageError(f"--set {word}: '{text}' is not a number", hint=hint)


def split_settings(
    values: Mapping[str, list[float]], controllers: Sequence[Controller], plant: Plant
) -> tuple[dict[str, list[float]], dict[str, float]]:
    """Divide the values of ``--set`` into gains of controllers and parameters of the plant.

    Raises
    ------
    GainError
        If a name is neither.
    """
    gains: dict[str, list[float]] = {}
    parameters: dict[str, float] = {}
    for name, value in values.items():
        bare = name.removeprefix("plant.")
        owner = owner_of(name, controllers, plant)
        if owner is None and bare == name:
            message, hint = unknown_setting(name, controllers, plant)
            raise GainError(message, name=name, hint=hint)
        if owner == "gain":
            gains[name] = value
        elif len(value) != 1:
            raise WordError(f"parameter {bare} of the plant takes one number, not {len(value)}")
        else:
            parameters[bare] = value[0]
    return gains, parameters


# --- The plant ---


def with_plant(request: _Request, controllers: Sequence[Controller]) -> tuple[_Request, Plant]:
    """Return the plant with its actuators, and the request with its name.

    The default is the shipped plant with the axes of the controllers.
    """
    if request.plant is None:
        request = request.replaced(plant=_plant_by_axes(controllers, connections(request)))
    return request, named_plant(request)


def _plant_by_axes(controllers: Sequence[Controller], connect: Mapping[str, str]) -> str:
    names = {controller.name: site_for(controller, connect).name for controller in controllers}
    if len(set(names.values())) > 1:
        words = ", ".join(f"{name} on {plant}" for name, plant in names.items())
        raise WordError(
            f"the controllers run on different plants: {words}", hint="--plant names one"
        )
    return next(iter(names.values()))


def with_drives(request: ExperimentRequest, plant: Plant) -> tuple[Plant, Options]:
    """Return the plant with the requested drives, and the options of a run."""
    options = options_of(request, plant)
    return equipped(plant, options), options


# --- Fields of a plant ---

ALONG = ("trajectory", "angles", "way_points", "segment", "hold")
"""Fields for plants with trajectories."""

CARRIED = ("payload", "loaded", "load_in_hold")
"""Fields for plants with a load, along a trajectory."""

REFERRED = ("reference", "step", "duration")
"""Fields of runs along references, for any plant."""

DRIVES = {"limits": "torque_limits", "supply": "supply", "inductance": "inductance"}
COUNTING = ("conventions", "precision", "pi")
"""Fields that a plant must declare: drives (by the fields of ``Options``) and arithmetic."""


def given_option(request: ExperimentRequest, names: Iterable[str]) -> str:
    """Return the spelling of the first field with a value, or ""."""
    option = request.given(names)
    if option is None:
        return ""
    value, spelling = getattr(request, option.name), option.spelling
    return f"--no-{spelling[2:]}" if value is False else spelling


def follows(request: ExperimentRequest, plant: Plant) -> bool:
    """Whether a plant follows a trajectory instead of references."""
    _require_known(request, plant)
    if not plant.trajectories:
        return False
    reference = given_option(request, REFERRED)
    other = given_option(request, (*ALONG, *CARRIED))
    if reference and other:
        raise UsageError(f"{reference} is for references, and {other} for a trajectory: give one")
    if reference == "--for":
        hint = "--segment and --hold set the duration of a trajectory"
        raise UsageError("--for sets the duration of --reference or --step", hint=hint)
    return not reference


def _require_known(request: ExperimentRequest, plant: Plant) -> None:
    """Raise WordError for a field without meaning for the plant."""
    name, options = plant.name, plant.particulars.options
    option = given_option(request, ALONG)
    if option and not plant.trajectories:
        message = f"{option} is for plants that follow trajectories"
        raise WordError(f"{message}; {name} takes --reference")
    option = given_option(request, CARRIED)
    if option and not carries(plant):
        has = ", ".join(plant.parameters)
        instead = f"--set changes its parameters: {has}" if has else "it has no parameters"
        raise WordError(f"{option} is for plants that carry a load; {name} does not, {instead}")
    option = given_option(request, (key for key, field in DRIVES.items() if field not in options))
    if option:
        bounded = "--actuator INPUT=LOW..HIGH bounds a drive"
        raise WordError(f"{name} has no {option}; {bounded}: {', '.join(plant.inputs)}")
    option = given_option(request, (key for key in COUNTING if key not in options))
    if option:
        counts = "it counts in double precision with the true π"
        raise WordError(f"{name} has no {option}; {counts}")


# --- Set points ---


def set_points(request: ExperimentRequest, controller: Controller, plant: Plant) -> Motion:
    """Return the set points: of a trajectory of the plant, with its load, or of references.

    Parameters set by the user hold for the loaded plant, too.
    """
    if not follows(request, plant):
        return motion_of(request, controller, plant)
    return trajectory_motion(
        plant,
        trajectory_of_request(request, plant),
        controller,
        conventions_of(request),
        payload=bool(request.payload),
        segments=request.loaded or None,
        connect=connections(request),
    )


def trajectory_of_request(request: ExperimentRequest, plant: Plant) -> Trajectory:
    """Return the named trajectory; by default the first of the plant."""
    arguments: dict[str, Any] = {}
    if request.segment is not None:
        arguments["segment"] = request.segment
    if request.hold is not None:
        arguments["hold"] = request.hold
    try:
        with times_and_angles():
            if request.way_points:
                return way_points(plant, [*map(_point, request.way_points)], **arguments)
            if request.angles is not None:
                arguments["angles"] = request.angles
            return trajectory_of(plant, request.trajectory or "", **arguments)
    except UnknownTrajectoryError:
        raise unknown_choice("trajectory", request.trajectory, plant.trajectories) from None


def _point(text: str) -> tuple[float, ...]:
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        raise UsageError(f"way point '{text}' is not numbers", hint="as in 45,-30") from None


# --- Files ---


def files_named(request: ExperimentRequest) -> dict[str, Path]:
    """Return the possible files among the words of an experiment, existing or not."""
    words = [request.rulebase, request.alpha, request.performance, *request.table]
    plant = request.plant or ""
    words += [plant.partition(".py")[0] + ".py", plant, plant.rpartition(":")[0]]
    words += [word.partition("=")[2] for word in (*request.reference, *request.disturb)]
    return {word: Path(word) for word in words if word}
