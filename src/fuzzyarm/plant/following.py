"""Trajectories of a plant by name, their outputs, and the load.

The plant declares them: ``trajectories``, ``compared_along``, ``random_trajectory`` and
``loaded_parameters`` of :class:`fuzzyarm.plant.Plant`.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from fuzzyarm.base.names import near_hint
from fuzzyarm.base.numbers import counted
from fuzzyarm.plant.driven_arm import Arm
from fuzzyarm.plant.equations import USERS
from fuzzyarm.plant.own import failure_of, start_of
from fuzzyarm.plant.plant import (
    Address,
    Plant,
    PlantError,
    interface_of,
    parameter,
    with_parameters,
)
from fuzzyarm.plant.setting import ArmError
from fuzzyarm.plant.trajectory import Point, Trajectory, through

# --- Trajectories by name ---


class UnknownTrajectoryError(PlantError):
    """A plant has no trajectory of this name, or none at all."""


def follower_of(trajectory: Trajectory) -> Plant:
    """Return the default plant for a trajectory: the study's arm."""
    return Arm()


def trajectory_of(plant: Plant, name: str = "", **options: Any) -> Trajectory:
    """Return a trajectory of a plant.

    Parameters
    ----------
    plant : Plant
        Any.
    name : str, optional
        By default its first one.
    **options
        Arguments of its maker, as ``segment=1.5``.

    Raises
    ------
    UnknownTrajectoryError
        If the name is unknown.
    ArmError
        If an argument is unknown, or a number out of range.
    """
    names = plant.trajectories
    if not names:
        hint = f"it follows references, as in {_port_words(plant)}=step:1"
        raise UnknownTrajectoryError(f"the {plant.name} has no trajectories", name=name, hint=hint)
    if name and name not in names:
        hint = near_hint(name, names)[0] or f"there are {', '.join(names)}"
        raise UnknownTrajectoryError(
            f"the {plant.name} has no trajectory '{name}'", name=name, hint=hint
        )
    trajectory_name = name or next(iter(names))
    make = names[trajectory_name]
    accepted = set() if isinstance(make, Trajectory) else set(_arguments_of(make))
    for option, value in options.items():
        if option not in accepted:
            raise ArmError(f"{trajectory_name} has no {option}", name=option, value=value)
    return make if isinstance(make, Trajectory) else _made(plant, trajectory_name, make, options)


def _port_words(plant: Plant) -> str:
    interface = interface_of(plant)
    return interface.label(next(iter(interface.outputs)))


def _arguments_of(make: Callable[..., Trajectory]) -> Iterable[str]:
    """Return the parameter names of a function; none if they cannot be inspected."""
    try:
        return inspect.signature(make).parameters
    except (TypeError, ValueError):
        return ()


def _made(
    plant: Plant, name: str, make: Callable[..., Trajectory], options: Mapping[str, Any]
) -> Trajectory:
    """Call the maker of a trajectory, which may be a user's."""
    try:
        trajectory: Any = make(**options)
    except ArmError:
        raise
    except USERS as error:
        message = f"trajectory '{name}' of the {plant.name} failed: {failure_of(plant, error)}"
        raise PlantError(message, name=name) from error
    if not isinstance(trajectory, Trajectory):
        message = f"trajectory '{name}' of the {plant.name} is a {type(trajectory).__name__}"
        raise PlantError(message, name=name, hint="return fuzzyarm.plant.through([...])")
    return trajectory


def compared_trajectories(plant: Plant, **options: Any) -> tuple[Trajectory, ...]:
    """Return the trajectories for comparing and tuning; `options` as for their makers."""
    names = plant.compared_along or tuple(plant.trajectories)
    return tuple(trajectory_of(plant, name, **options) for name in names)


def shortest_trajectory(plant: Plant) -> str:
    """Return the name of the shortest trajectory."""
    return min(plant.trajectories, key=lambda name: trajectory_of(plant, name).duration)


def followed(plant: Plant, trajectory: Trajectory) -> tuple[Address, ...]:
    """Return the outputs of a plant that follow a trajectory."""
    interface = interface_of(plant)
    first: dict[str, Address] = {}
    for port in interface.outputs:
        first.setdefault(port[0], port)
    ports = tuple(map(interface.port, trajectory.outputs)) or tuple(first.values())
    count = len(trajectory.segments[0].start)
    if len(ports) != count:
        names = ", ".join(map(interface.label, ports))
        numbers = counted(count, "number")
        message = f"a point of '{trajectory.name}' has {numbers}, and the {plant.name} follows"
        hint = "outputs of a Trajectory names those that follow"
        raise PlantError(f"{message} with {len(ports)}: {names}", name="outputs", hint=hint)
    for port in ports:
        if port not in interface.outputs:
            message = f"'{interface.label(port)}' is an input, which cannot follow a trajectory"
            raise PlantError(message, name=interface.label(port))
    return ports


def at_rest(plant: Plant) -> dict[Address, float]:
    """Return the outputs of a plant at its start, as far as they are states of the same name."""
    states = dict(zip(plant.states, start_of(plant, np.random.default_rng(0)), strict=True))
    named = {port: (".".join(port), port[1]) for port in interface_of(plant).outputs}
    return {port: states[name] for port, names in named.items() for name in names if name in states}


def way_points(
    plant: Plant, points: Sequence[Point], segment: float = 2.0, hold: float = 0.0
) -> Trajectory:
    """Return a trajectory from the rest position through way points; see :func:`through`."""
    outputs, resting = interface_of(plant).outputs, at_rest(plant)
    ports = followed(plant, through(points, segment, hold))
    turns = {port: 180.0 / math.pi if outputs[port].unit == "rad" else 1.0 for port in ports}
    start = tuple(resting.get(port, 0.0) * turns[port] for port in ports)
    return through(points, segment, hold, start=start)


SMALLEST, LARGEST = 0.5, 1.5
"""Range of the scale factors of random moves and references."""


def drawn_trajectory(plant: Plant, rng: np.random.Generator) -> Trajectory:
    """Draw a trajectory for tuning: the plant's own, or a scaled one."""
    if plant.random_trajectory is not None:
        return plant.random_trajectory(rng)
    trajectories = compared_trajectories(plant)
    one = trajectories[int(rng.integers(len(trajectories)))]
    return one.scaled(float(np.round(rng.uniform(SMALLEST, LARGEST), 3)))


# --- The load ---


def carries(plant: Plant) -> bool:
    """Whether a plant declares parameters with a load."""
    return plant.loaded_parameters is not Plant.loaded_parameters


def with_load(plant: Plant, share: float) -> Plant:
    """Return a plant with a share of its load; its parameters are interpolated linearly.

    Parameters
    ----------
    plant : Plant
        With ``loaded_parameters``.
    share : float
        0 without a load, 1 with the full one.

    Raises
    ------
    ArmError
        If the share is negative or not finite.
    """
    if not 0.0 <= share < math.inf:
        hint = "0 (none), 1 (the whole) or more"
        message = f"a payload of {share:g} is out of range"
        raise ArmError(message, name="payload", value=share, hint=hint)
    values = {}
    for name, heavy in plant.loaded_parameters.items():
        light = parameter(plant, name).value
        # Exact at both ends; a difference would leave its rounding.
        values[name] = (1.0 - share) * light + share * heavy
    return with_parameters(plant, values)
