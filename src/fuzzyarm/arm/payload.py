"""Which arm each set point meets: the load changes it at segment boundaries."""

from __future__ import annotations

from collections.abc import Sequence

from fuzzyarm.arm.conventions import Conventions
from fuzzyarm.arm.faults import ArmError
from fuzzyarm.arm.parameters import LOADED, UNLOADED, ArmParameters
from fuzzyarm.arm.trajectory import Trajectory

Schedule = tuple[ArmParameters, ...]
"""One arm per segment."""


def schedule(
    trajectory: Trajectory,
    *,
    payload: bool = False,
    segments: Sequence[int] | None = None,
    conventions: Conventions | None = None,
    unloaded: ArmParameters = UNLOADED,
    loaded: ArmParameters = LOADED,
) -> Schedule:
    """Say for each segment which arm moves in it.

    Parameters
    ----------
    trajectory : Trajectory
        Has its own idea of where a load is carried.
    payload : bool, optional
        Whether there is a load.
    segments : sequence of int, optional
        Carry the load in these segments, counted from 1, instead.
    conventions : Conventions, optional
        Whether the load stays on in a hold; it does by default.
    unloaded, loaded : ArmParameters, optional
        The arm without and with its load.

    Raises
    ------
    ArmError
        If `segments` names one that the trajectory does not have.
    """
    count = len(trajectory.segments)
    if segments is not None:
        for number in segments:
            if not 1 <= number <= count:
                raise ArmError(
                    f"the payload schedule names segment {number}, but '{trajectory.name}' "
                    f"has {count} segments",
                    name="segments",
                    value=number,
                )
        carried = [index + 1 in segments for index in range(count)]
    else:
        carried = [payload and each for each in trajectory.loaded]
        if conventions is not None and not conventions.load_in_hold:
            carried = [
                each and not segment.hold
                for each, segment in zip(carried, trajectory.segments, strict=True)
            ]
    return tuple(loaded if each else unloaded for each in carried)
