"""Trajectories of a plant: set points, and the load of the plant in each segment.

A run follows a :class:`FollowedPlant`: a plant with one of its trajectories, or with references.
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
"""A trajectory, a plant, the name or file of one, or set points."""

Schedule = Sequence[Mapping[str, float]]
"""Plant parameters that differ, for each segment of a trajectory."""


class FollowedPlant(NamedTuple):
    """A plant and its trajectory; None with references."""

    plant: Plant
    trajectory: Trajectory | None


def way_of(
    on: AnyWay, along: Trajectory | str | None = None, *, referred: bool = False
) -> FollowedPlant | Motion:
    """Resolve the plant and the trajectory of a run.

    Parameters
    ----------
    on : Trajectory, Plant, Motion, str or path-like
        A trajectory alone is for the arm of the study.
    along : Trajectory or str, optional
        A trajectory of the plant; by default its first one, if any.
    referred : bool, optional
        Whether references, or a duration, replace a trajectory.

    Raises
    ------
    PlantError
        If the plant or the trajectory is unknown, or there are two of them.
    """
    twice = PlantError(
        "both a trajectory and references are given",
        hint="a trajectory, or set points, have their own references and their own time",
    )
    if isinstance(on, Trajectory | Motion):
        if referred or along is not None:
            raise twice
        return on if isinstance(on, Motion) else FollowedPlant(follower_of(on), on)
    plant = find_plant(on)
    if along is None and (referred or not plant.trajectories):
        return FollowedPlant(plant, None)
    if referred:
        raise twice
    return FollowedPlant(
        plant, along if isinstance(along, Trajectory) else trajectory_of(plant, along or "")
    )


def equipped(plant: Plant, options: Options) -> Plant:
    """Return the plant with the drives of the options."""
    usual = Options()
    for name in DRIVE_OPTIONS:
        is_given = getattr(options, name) != getattr(usual, name)
        if is_given and name not in plant.particulars.options:
            raise no_option(plant, name)
    return plant.with_options(options)


DRIVE_OPTIONS = ("torque_limits", "inductance", "supply")
"""Options of a run that only some plants have."""


def no_option(plant: Plant, name: str) -> PlantError:
    """Return the error for a drive option unknown to the plant."""
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
    """Return the set points of a trajectory, and the plant of each segment.

    Parameters
    ----------
    plant : Plant
        The plant, with its drives.
    trajectory : Trajectory
        The trajectory.
    controller : Controller, optional
        Supplies the timing; by default that of the study. A loop refuses set points of another
        timing.
    conventions : Conventions, optional
        Precision, π, whether a load stays on during a hold.
    payload : bool or float, optional
        The load where the trajectory has one, as a share of the plant's.
    segments : sequence of int, optional
        Segments with the load instead, counted from 1.
    schedule : sequence of mapping, optional
        Plant parameters of each segment, in place of its load.
    connect : mapping of str to str, optional
        From names of the controller to ports of the plant, if they differ.

    Raises
    ------
    SourceError
        If the plant lacks a port that the controller measures or drives.
    PlantError
        If the plant carries no load, has another number of outputs, or lacks a parameter.
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
        # In single precision both the set-point time and its divisor are stored numbers: round
        # twice.
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
    """The plants of a run, the index of one for each segment, and their loads."""

    plants: tuple[Plant, ...]
    block: tuple[int, ...]
    carrying: tuple[bool, ...] = ()


def _met_by_load(plant: Plant, where: Sequence[bool], share: float) -> _Met:
    if any(where) and not carries(plant):
        hint = "loaded_parameters of the plant defines its load"
        raise PlantError(f"the {plant.name} carries no load", name="payload", hint=hint)
    # At most one plant with the load and one without; segments share them.
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
