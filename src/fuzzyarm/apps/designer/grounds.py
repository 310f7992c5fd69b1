"""The surroundings of a page's controller: plants, their trajectories, references, sensors.

A page may name shipped plants and those of the command line, whose Python files are executed. A run
is described in the words of the command line.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from fuzzyarm.apps.designer.names import is_inside
from fuzzyarm.base.errors import FuzzyarmError, WordError
from fuzzyarm.requests.experiment import ExperimentRequest
from fuzzyarm.requests.fields import AnyRequest, RequestError

if TYPE_CHECKING:
    from fuzzyarm.apps.designer.stage import Plants
    from fuzzyarm.control.controllers import Controller
    from fuzzyarm.control.loop import Motion
    from fuzzyarm.language.model.controller import ControllerModel
    from fuzzyarm.plant import Plant

Experiment = TypeVar("Experiment", bound=ExperimentRequest)


class GroundsError(FuzzyarmError, ValueError):
    """A plant, a reference or a time that is not permitted to a page."""


class FieldError(GroundsError):
    """A mistake in a field of the page.

    Attributes
    ----------
    field : str
        Its name in the question.
    """

    def __init__(self, message: str, *, field: str, hint: str = "") -> None:
        super().__init__(message, hint=hint)
        self.field = field


@contextlib.contextmanager
def at_field(name: str) -> Iterator[None]:
    """Attribute an error to a field, unless it names its field."""
    try:
        yield
    except RequestError as error:
        raise FieldError(error.message, field=error.field, hint=error.hint) from error
    except FuzzyarmError as error:
        raise FieldError(error.message, field=name, hint=error.hint) from error


# --- Plants ---


def plants_for(model: ControllerModel, plants: Plants) -> list[dict[str, Any]]:
    """Return the plants of a designer, those with the axes of a controller first.

    Each with a flag of these axes, and with its trajectories or references, see `followable`; the
    likeliest first.
    """
    from fuzzyarm.apps.designer.stage import followable
    from fuzzyarm.control.controllers.findings import site_by_axes
    from fuzzyarm.plant.plant import interface_of

    likeliest = site_by_axes(model)
    plants_of_model = []
    for name, plant in plants.by_name.items():
        interface = interface_of(plant)
        label = interface.label(next(iter(interface.outputs)))
        fits = set(model.axis_names) <= set(interface.axes)
        plants_of_model.append({"name": name, "fits": fits, **followable(name, plant, label)})
    is_likeliest = likeliest.name if likeliest is not None else ""
    plants_of_model.sort(key=lambda entry: (not entry["fits"], entry["name"] != is_likeliest))
    return plants_of_model


def plant_named(word: str, model: ControllerModel, plants: Plants) -> Plant:
    """Return a plant of a designer, made anew; by default the likeliest for a controller."""
    if not word:
        likeliest = plants_for(model, plants)[0]
        if not likeliest["fits"]:
            axes = ", ".join(model.axis_names)
            raise GroundsError(f"no plant here has the axes of {model.name} ({axes})")
        word = likeliest["name"]
    return plants.new(word)


# --- The words of an experiment ---

MANY = (
    "reference",
    "connect",
    "noise",
    "quantise",
    "sensor_delay",
    "difference",
    "actuator",
    "actuator_delay",
    "disturb",
)
"""Fields of several words."""

RANGES = ("sweep", "vary")
"""Fields of ranges, in the requests with ranges."""


def form_of(kind: type[AnyRequest], **values: Any) -> AnyRequest:
    """Return a request from the values of a form; FieldError for an invalid value."""
    with at_field(""):
        return kind.of(values)


def signal_of(folder: Path, word: str) -> str:
    """Return ``PORT=SIGNAL``; a file of times and values must be one of the folder."""
    port, equals, signal = word.partition("=")
    if not signal.strip().endswith(".csv"):
        return word
    path = folder / signal.strip()
    if not is_inside(path, folder):
        raise WordError(f"'{signal.strip()}' is not a file of this folder")
    return f"{port}{equals}{path}"


def check_words(request: ExperimentRequest, plant: Plant) -> None:
    """Read each word separately, to show a mistake at its field."""
    from fuzzyarm.control.loop.sweep import read_range
    from fuzzyarm.control.loop.words import connections, driven, options_of, signals
    from fuzzyarm.plant.plant import interface_of

    interface = interface_of(plant)
    for name in MANY:
        alone = ExperimentRequest(**{name: getattr(request, name)})
        with at_field(name):
            driven(alone, plant)
            connections(alone)
            signals(alone)
            options = options_of(alone, plant)
            for port in (*options.sensors, *options.loads):
                interface.every_port(port)
    for name in RANGES:
        with at_field(name):
            for word in getattr(request, name, ()):
                read_range(word)
    with at_field("duration"):
        if request.duration is not None:
            seconds_of(request.duration)


def request_on(plant: Plant, request: Experiment) -> Experiment:
    """Return a request for a plant, its words read one by one."""
    check_words(request, plant)
    if plant.trajectories:
        return request
    # A page may hold choices for another plant: they are dropped.
    return request.replaced(trajectory=None, payload=type(request).payload)


# --- Times, trajectories ---


def seconds_of(word: str) -> float:
    """Return the duration of a run, s; WordError unless it is a time above zero."""
    from fuzzyarm.base.numbers import read_time

    seconds = read_time(word, "the duration")
    if not seconds > 0.0:
        raise WordError(f"a run lasts longer than {word}", hint="as in 2s")
    return seconds


def trajectory_motion_of(
    name: str,
    controller: Controller,
    plant: Plant,
    connect: Mapping[str, str] | None = None,
    *,
    payload: bool,
) -> Motion:
    """Return the set points of the trajectory named by a page; by default the plant's first."""
    from fuzzyarm.control.loop.along import trajectory_motion
    from fuzzyarm.plant.following import carries, trajectory_of

    way = trajectory_of(plant, name)
    loaded = payload and carries(plant)
    return trajectory_motion(plant, way, controller, payload=loaded, connect=connect)
