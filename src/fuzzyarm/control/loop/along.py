"""Along a trajectory of a plant: its set points, and what the plant carries in each segment.

What a run follows is a :class:`FollowedPlant`: a plant, and one of its trajectories or else
references.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from fuzzyarm.control.controllers.controller import Controller
from fuzzyarm.control.controllers.on_plant import controller_on, site_of, timing_on
from fuzzyarm.control.loop.course import Motion, Options, require_points
from fuzzyarm.plant.following import carries, followed, follower_of, trajectory_of, with_load
from fuzzyarm.plant.own import find_plant
from fuzzyarm.plant.plain_python import require_sound
from fuzzyarm.plant.plant import Plant, PlantError, interface_of, with_parameters
from fuzzyarm.plant.setting import PLAIN, STUDY_TIMING, ArmError, Conventions
from fuzzyarm.plant.trajectory import Trajectory, carried, sample

AnyWay = Trajectory | Plant | Motion | str | os.PathLike[str]
"""What is followed: a trajectory, a plant, the name or the file of one, or set points."""

Schedule = Sequence[Mapping[str, float]]
"""For each segment of a trajectory the parameters of the plant that differ in it."""


class FollowedPlant(NamedTuple):
    """A plant, and the trajectory that it follows; references where there is none."""

    plant: Plant
    trajectory: Trajectory | None


def way_of(
    on: AnyWay, along: Trajectory | str | None = None, *, referred: bool = False
) -> FollowedPlant | Motion:
    """Return what is followed.

    Parameters
    ----------
    on : Trajectory, Plant, Motion, str or path-like
        A trajectory alone is followed by the study's arm.
    along : Trajectory or str, optional
        Of the plant; by default its first one, where it has some.
    referred : bool, optional
        Whether references, or the time of a run, are given in place of a trajectory.

    Raises
    ------
    PlantError
        If there is no such plant, no such trajectory, or two things are to be followed.
    """
    twice = PlantError(
        "both a trajectory and references are given",
        hint="a trajectory, or set points, have their own references and their own time",
    )
    if isinstance(on, Trajectory | Motion):
        if referred or along is not None:
            raise twice
        return on if isinstance(on, Motion) else FollowedPlant(follower_of(on), on)
    plant = on if isinstance(on, Plant) else find_plant(on)
    if along is None and (referred or not plant.trajectories):
        return FollowedPlant(plant, None)
    if referred:
        raise twice
    return FollowedPlant(
        plant, along if isinstance(along, Trajectory) else trajectory_of(plant, along or "")
    )


def equipped(plant: Plant, options: Options) -> Plant:
    """Return a plant with the drives that the options ask for."""
    usual = Options()
    for name in DRIVE_OPTIONS:
        is_given = getattr(options, name) != getattr(usual, name)
        if is_given and name not in plant.particulars.options:
            raise no_option(plant, name)
    return plant.with_options(options)


DRIVE_OPTIONS = ("torque_limits", "inductance", "supply")
"""Options of a run that some plants know."""


def no_option(plant: Plant, name: str) -> PlantError:
    """Return the error of an option of drives that a plant does not know."""
    interface = interface_of(plant)
    drive = interface.label(next(iter(interface.inputs)))
    hint = f"limits of an actuator bound it, as in {drive}=-5..5"
    return PlantError(f"the {plant.name} has no {name.replace('_', ' ')}", name=name, hint=hint)


# --- Set points ---


def trajectory_motion(
    plant: Plant,
    trajectory: Trajectory,
    controller: Controller | None = None,
    conventions: Conventions = PLAIN,
    *,
    payload: bool | float = False,
    segments: Sequence[int] | None = None,
    schedule: Schedule | None = None,
    connect: Mapping[str, str] | None = None,
) -> Motion:
    """Return the set points of a trajectory, and the plant that each of them meets.

    Parameters
    ----------
    plant : Plant
        That follows, with the drives that it is to have.
    trajectory : Trajectory
        What it follows.
    controller : Controller, optional
        Whose timing counts; by default that of the study. A loop refuses set points that were
        made for another.
    conventions : Conventions, optional
        Precision, π, whether a load stays on in a hold.
    payload : bool or float, optional
        The load where the trajectory says so, as a share of the plant's.
    segments : sequence of int, optional
        Carry the load in these, counted from 1, instead.
    schedule : sequence of mapping, optional
        What of the parameters of the plant differs in each segment, instead of its load.
    connect : mapping of str to str, optional
        From names of the controller to ports of the plant, where they differ.

    Raises
    ------
    SourceError
        If the plant does not have what the controller measures or drives.
    PlantError
        If the plant carries no load, does not follow with as many outputs, or lacks a parameter.
    ArmError
        If an angle, a time or a segment is out of range.
    """
    ports, interface = followed(plant, trajectory), interface_of(plant)
    timing = STUDY_TIMING
    if controller is not None:
        require_sound(plant)
        site = site_of(plant, connect)
        timing = timing_on(controller_on(controller, site), site)
    require_points(trajectory.duration, timing.set_point)
    if schedule is None:
        where = carried(
            trajectory, payload=bool(payload), segments=segments, conventions=conventions
        )
        met = _met_by_load(plant, where, float(payload) if payload else 1.0)
    else:
        met = _met_by_schedule(plant, trajectory, schedule)
    angular = tuple(interface.outputs[port].unit == "rad" for port in ports)
    points = sample(trajectory, conventions, timing, angular)
    orders = points.position, points.velocity, points.acceleration
    columns = np.zeros((len(points.time), len(interface.references)))
    for column, (address, reference) in enumerate(interface.references.items()):
        of, order = (address, 0) if address in ports else (reference.of, reference.order)
        if of in ports:
            columns[:, column] = orders[order][:, ports.index(of)]
    step = timing.period
    if conventions.single:
        # In single precision the set point's time is a stored number, and so is what it is divided
        # into.
        step = float(np.float32(np.float64(np.float32(timing.set_point)) / timing.every))
    return Motion(
        trajectory.name,
        points.time,
        columns,
        points.iterations,
        np.array(met.block)[points.segment],
        met.plants,
        ports,
        timing.period,
        step,
        timing.every,
        points.path,
        along=True,
        carrying=met.carrying,
    )


class _Met(NamedTuple):
    """The plants that are met, which of them in each segment, and which of them carry a load."""

    plants: tuple[Plant, ...]
    block: tuple[int, ...]
    carrying: tuple[bool, ...] = ()


def _met_by_load(plant: Plant, where: Sequence[bool], share: float) -> _Met:
    if any(where) and not carries(plant):
        hint = "loaded_parameters of the plant says what it is with its load"
        raise PlantError(f"the {plant.name} carries no load", name="payload", hint=hint)
    # A plant with its load and one without, as far as they are met; segments share them.
    kinds = tuple(dict.fromkeys(where))
    plants = tuple(with_load(plant, share) if loaded else plant for loaded in kinds)
    return _Met(plants, tuple(map(kinds.index, where)), kinds)


def _met_by_schedule(plant: Plant, trajectory: Trajectory, schedule: Schedule) -> _Met:
    if len(schedule) != len(trajectory.segments):
        raise ArmError(
            f"a schedule of {len(schedule)} sets of parameters does not fit the "
            f"{len(trajectory.segments)} segments of '{trajectory.name}'",
            name="schedule",
            value=len(schedule),
        )
    sets = [dict(values) for values in schedule]
    kinds = [values for at, values in enumerate(sets) if values not in sets[:at]]
    plants = tuple(with_parameters(plant, values) for values in kinds)
    return _Met(plants, tuple(map(kinds.index, sets)))
