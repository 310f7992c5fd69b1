"""Where a controller of a page runs: shipped plants, references, trajectories of the arm.

A page names plants that come with the package; a file of Python is named on the command line.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.plant.trajectory import TRAJECTORIES

if TYPE_CHECKING:
    from fuzzyarm.loop import Signal
    from fuzzyarm.model.controller import ControllerModel
    from fuzzyarm.plant import Plant
    from fuzzyarm.plant.trajectory import Trajectory

LONGEST = 24.0 * 3600.0
"""Of a run that a page asks for, s."""


class GroundsError(FuzzyarmError, ValueError):
    """A plant, a reference or a time that a page may not ask for."""


def fitting_plants(model: ControllerModel) -> list[dict[str, str]]:
    """Return the shipped plants that have the axes of a controller, the likeliest first.

    Each with the reference that a page offers to write in another's place; the arm follows
    trajectories and has none.
    """
    from fuzzyarm.controller.findings import site_by_axes
    from fuzzyarm.plant import Arm
    from fuzzyarm.plant.own import PLANTS
    from fuzzyarm.plant.plant import interface_of

    likeliest = site_by_axes(model)
    found = []
    for name, plant in PLANTS.items():
        interface = interface_of(plant())
        if set(model.axis_names) <= set(interface.axes):
            label = interface.label(next(iter(interface.outputs)))
            example = "" if plant is Arm else f"{label}=step:1"
            found.append({"name": name, "reference": example})
    found.sort(key=lambda each: likeliest is None or each["name"] != likeliest.name)
    return found


def plant_named(word: str, model: ControllerModel) -> Plant:
    """Return a shipped plant, by default the likeliest for a controller.

    Raises
    ------
    GroundsError
        If it is not a shipped one, or none has the axes.
    """
    from fuzzyarm.plant.own import PLANTS

    if not word:
        fitting = fitting_plants(model)
        if not fitting:
            axes = ", ".join(model.axis_names)
            raise GroundsError(f"no shipped plant has the axes of {model.name} ({axes})")
        word = fitting[0]["name"]
    if word not in PLANTS:
        hint = f"there are {', '.join(PLANTS)}; others run on the command line"
        raise GroundsError(f"'{word}' is not a shipped plant", hint=hint)
    return PLANTS[word]()


def references_of(words: str) -> dict[str, Signal] | None:
    """Read references with blanks between, as in ``position=sine:0.5,1``; None without any.

    Raises
    ------
    GroundsError
        If one is not a reference, or is to be read from a file.
    PlantError
        If there is no such signal.
    """
    from fuzzyarm.loop import read_signal

    found = {}
    for word in words.split():
        name, equals, text = word.partition("=")
        if not equals or not name or not text:
            hint = "as in position=step:1 or position=sine:0.5,1"
            raise GroundsError(f"'{word}' is not a reference", hint=hint)
        signal = read_signal(text)
        if signal.kind == "file":
            raise GroundsError(f"'{word}': references of files run on the command line")
        found[name] = signal
    return found or None


def seconds_of(value: Any, what: str = "the time") -> float | None:
    """Return a time of a page, s; None where it says nothing."""
    seconds = number_of(value, what)
    if seconds is None:
        return None
    if not 0.0 < seconds <= LONGEST or not math.isfinite(seconds):
        raise GroundsError(f"{what} of {value} s is out of range", hint=f"up to {LONGEST:g} s")
    return seconds


def whole_of(asked: Mapping[str, Any], name: str, default: int, most: int) -> int:
    """Return a whole number that a page asks for, from 0 on.

    Raises
    ------
    GroundsError
        If it is out of range.
    """
    value = asked.get(name)
    number = number_of(value, name)
    if number is None:
        return default
    if not number.is_integer() or not 0 <= number <= most:
        raise GroundsError(
            f"{name} of {value} is out of range", hint=f"a whole number up to {most}"
        )
    return int(number)


def number_of(value: Any, what: str) -> float | None:
    """Return a number of a page; None where it says nothing.

    Raises
    ------
    GroundsError
        If it says something else.
    """
    if value in (None, ""):
        return None
    try:
        return float(value)
    except (TypeError, ValueError):
        raise GroundsError(f"{what}: '{str(value)[:40]}' is not a number") from None


def trajectory_named(name: str) -> Trajectory:
    """Return a trajectory of the arm.

    Raises
    ------
    GroundsError
        If there is none of that name.
    """
    if name and name not in TRAJECTORIES:
        raise GroundsError(f"no trajectory '{name}'", hint=f"there are {', '.join(TRAJECTORIES)}")
    return TRAJECTORIES[name or next(iter(TRAJECTORIES))]()
