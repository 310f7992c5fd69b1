"""Trajectories, and which arm each set point meets (section 4.1).

Quintic segments from rest to rest, holds and way points; the load changes the arm at
segment boundaries.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.plant.arm import LOADED, UNLOADED, ArmParameters
from fuzzyarm.plant.setting import (
    SET_POINT_PERIOD,
    STUDY_TIMING,
    ArmError,
    Conventions,
    Pair,
    Timing,
)
from fuzzyarm.text.shown import one_line

# --- Trajectories: quintic segments from rest to rest, holds, way points (section 4.1) ---

LARGEST_ANGLE = 3600.0
"""Ten turns; more is taken for a slip of the pen, degrees."""

LONGEST = 600.0
"""Longest segment, s."""


@dataclass(frozen=True)
class Segment:
    """A quintic move from rest to rest, or a hold.

    Parameters
    ----------
    start, end : pair of float
        Nominal joint angles, degrees; equal for a hold.
    duration : float
        s.
    hold : bool, optional
        Whether the set point stays where it is.
    """

    start: Pair
    end: Pair
    duration: float
    hold: bool = False

    def __post_init__(self) -> None:
        for angle in (*self.start, *self.end):
            if not math.isfinite(angle) or abs(angle) > LARGEST_ANGLE:
                raise ArmError(
                    f"angle {angle} is out of range",
                    name="angle",
                    value=angle,
                    hint=f"a number of degrees between {-LARGEST_ANGLE:g} and {LARGEST_ANGLE:g}",
                )
        if not math.isfinite(self.duration) or not SET_POINT_PERIOD < self.duration <= LONGEST:
            raise ArmError(
                f"a segment of {self.duration} s is out of range",
                name="duration",
                value=self.duration,
                hint=f"more than {SET_POINT_PERIOD:g} s and at most {LONGEST:g} s",
            )


@dataclass(frozen=True, repr=False)
class Trajectory:
    """Segments, one after the other.

    Parameters
    ----------
    name : str
        Under which it is reported.
    segments : tuple of Segment
        At least one.
    loaded : tuple of bool
        In which segments the arm carries the load when there is one.
    """

    name: str
    segments: tuple[Segment, ...]
    loaded: tuple[bool, ...]

    def __repr__(self) -> str:
        count = len(self.segments)
        return one_line(self, f"{self.name}: {self.duration:.4g} s in {count} segments")

    @property
    def duration(self) -> float:
        """Sum of the durations, s."""
        return sum(segment.duration for segment in self.segments)


@dataclass(frozen=True)
class SetPoints:
    """A trajectory, sampled.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Since the start of the run, s.
    position, velocity, acceleration : ndarray, shape (n, 2)
        rad, rad/s, rad/s².
    iterations : ndarray of int64, shape (n,)
        Control iterations of each set point.
    segment : ndarray of int64, shape (n,)
        Index of its segment.
    path : ndarray, shape (m, 2)
        Where the trajectory itself is in each of the `m` control iterations, rad.
    """

    time: NDArray[np.float64]
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    acceleration: NDArray[np.float64]
    iterations: NDArray[np.int64]
    segment: NDArray[np.int64]
    path: NDArray[np.float64]


def _moves(points: Sequence[Pair], duration: float) -> list[Segment]:
    return [Segment(start, end, duration) for start, end in pairwise(points)]


def reach(angles: Pair = (90.0, -90.0), segment: float = 5.0, hold: float = 5.0) -> Trajectory:
    """Move there and stay; a load is picked up on arrival.

    Parameters
    ----------
    angles : pair of float
        Where to, degrees.
    segment : float
        How long the motion takes, s.
    hold : float
        How long it stays, s.

    Returns
    -------
    Trajectory
        Of a motion and a stay.
    """
    there = Segment((0.0, 0.0), angles, segment)
    rest = Segment(angles, angles, hold, hold=True)
    return Trajectory("reach", (there, rest), (False, True))


def reach_return(
    angles: Pair = (90.0, -90.0), segment: float = 5.0, hold: float = 5.0
) -> Trajectory:
    """Move there, pick up the load, come back, stay with it.

    Parameters
    ----------
    angles : pair of float
        Where to, degrees.
    segment : float
        How long each motion takes, s.
    hold : float
        How long it stays at the end, s.

    Returns
    -------
    Trajectory
        Of two motions and a stay.
    """
    home = (0.0, 0.0)
    segments = (
        Segment(home, angles, segment),
        Segment(angles, home, segment),
        Segment(home, home, hold, hold=True),
    )
    return Trajectory("reach-return", segments, (False, True, True))


def pick_and_place(angles: Pair = (45.0, -45.0), segment: float = 2.0) -> Trajectory:
    """Move there, come back with the load, put it down; twice.

    Parameters
    ----------
    angles : pair of float
        Where to, degrees.
    segment : float
        How long each motion takes, s.

    Returns
    -------
    Trajectory
        Of four motions.
    """
    points = [(0.0, 0.0), angles] * 2 + [(0.0, 0.0)]
    return Trajectory(
        "pick-and-place",
        tuple(_moves(points, segment)),
        (False, True, False, True),
    )


TRAJECTORIES: Mapping[str, Callable[..., Trajectory]] = {
    "reach-return": reach_return,
    "pick-and-place": pick_and_place,
    "reach": reach,
}
"""What the arm can follow by a name; the first is taken by default."""


def through(
    points: Sequence[Pair], segment: float = 2.0, hold: float = 0.0, name: str = "way-points"
) -> Trajectory:
    """Move through way points, from rest to rest.

    Parameters
    ----------
    points : sequence of pair of float
        Joint angles, degrees; the arm starts at rest at (0, 0) and moves to the first.
    segment : float, optional
        Duration of each move, s.
    hold : float, optional
        Time to stay at the last point, s; none by default.
    name : str, optional
        Name of the trajectory.

    Raises
    ------
    ArmError
        If there are no points, or an angle or a time is out of range.
    """
    if not points:
        raise ArmError("a trajectory needs at least one way point", name="points", value=points)
    every = [(0.0, 0.0), *points]
    segments = _moves(every, segment)
    if hold:
        segments.append(Segment(every[-1], every[-1], hold, hold=True))
    return Trajectory(name, tuple(segments), tuple(index > 0 for index in range(len(segments))))


@lru_cache(maxsize=64)
def sample(
    trajectory: Trajectory, conventions: Conventions, timing: Timing = STUDY_TIMING
) -> SetPoints:
    """Produce the set points of a trajectory.

    Time starts at zero in each segment and is advanced by the time of a set point (3 ms in the
    study), in the precision of the run, when a set point has been produced; set points are
    produced while it does not exceed the duration.

    Parameters
    ----------
    trajectory : Trajectory
        What to follow.
    conventions : Conventions
        Precision, π and the last set point of a segment.
    timing : Timing, optional
        The study's by default.

    Returns
    -------
    SetPoints
        In radians; the arrays are shared between calls and read-only.

    Notes
    -----
    The study adds its 3 ms up, so that a last bit decides whether a set point falls on the end of
    a segment; other times are counted, and the end belongs to the segment.
    """
    parts = [_sample_segment(segment, conventions, timing) for segment in trajectory.segments]
    begin = np.cumsum([0.0, *(segment.duration for segment in trajectory.segments)])
    points = SetPoints(
        time=np.concatenate([part[0] + start for part, start in zip(parts, begin, strict=False)]),
        position=np.concatenate([part[1] for part in parts]),
        velocity=np.concatenate([part[2] for part in parts]),
        acceleration=np.concatenate([part[3] for part in parts]),
        iterations=np.concatenate([part[4] for part in parts]),
        segment=np.repeat(np.arange(len(parts)), [len(part[0]) for part in parts]),
        path=np.concatenate([part[5] for part in parts]),
    )
    for array in vars(points).values():
        array.flags.writeable = False
    return points


Sampled = tuple[
    NDArray[np.float64],
    NDArray[np.float64],
    NDArray[np.float64],
    NDArray[np.float64],
    NDArray[np.int64],
    NDArray[np.float64],
]


def _sample_segment(segment: Segment, conventions: Conventions, timing: Timing) -> Sampled:
    number = np.float32 if conventions.single else np.float64
    duration = number(segment.duration)
    if timing.set_point == SET_POINT_PERIOD:
        # In single precision a step may lose up to 0.4 % at the end of a long segment.
        most = int(1.02 * segment.duration / SET_POINT_PERIOD) + 3
        ticks = np.full(most, SET_POINT_PERIOD, number)
        ticks[0] = 0.0
        # cumsum adds one by one in the type of its argument, as the programs did.
        clock = np.cumsum(ticks)
        time = clock[clock <= duration].astype(np.float64)
    else:  # counted, where the study's programs have nothing to say
        count = int(segment.duration / timing.set_point + 1e-9) + 1
        time = _stored(np.arange(count, dtype=np.float64) * timing.set_point, number)
    start, end = (
        _stored(np.array(angles) * conventions.pi / 180.0, number)
        for angles in (segment.start, segment.end)
    )
    iterations = np.full(len(time), timing.every)
    if not conventions.whole_set_points:
        iterations[-1] = 1
    position, velocity, acceleration = _quintic(start, end, float(duration), time[:, None], number)
    # A set point stands still for its iterations; the trajectory goes on, up to its end.
    begin = np.cumsum(iterations) - iterations
    since = np.arange(iterations.sum()) - np.repeat(begin, iterations)
    moments = np.minimum(np.repeat(time, iterations) + since * timing.period, segment.duration)
    path, _, _ = _quintic(start, end, float(duration), moments[:, None], np.float64)
    return time, position, velocity, acceleration, iterations, path


def _quintic(
    start: NDArray[np.float64],
    end: NDArray[np.float64],
    duration: float,
    t: NDArray[np.float64],
    number: type[np.floating],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Interpolate from rest to rest; coefficients and results are rounded when stored."""
    way = end - start
    cubed = duration * duration * duration
    third = _stored(10.0 * way / cubed, number)
    fourth = _stored(-15.0 * way / (cubed * duration), number)
    fifth = _stored(6.0 * way / (cubed * duration * duration), number)
    square = t * t
    position = start + third * t * square + fourth * square * square + fifth * t * square * square
    velocity = 3.0 * third * square + 4.0 * fourth * t * square + 5.0 * fifth * square * square
    acceleration = 6.0 * third * t + 12.0 * fourth * square + 20.0 * fifth * t * square
    return _stored(position, number), _stored(velocity, number), _stored(acceleration, number)


def _stored(values: NDArray[np.float64], number: type[np.floating]) -> NDArray[np.float64]:
    return values.astype(number).astype(np.float64)


# --- Which arm each set point meets: the load changes it at segment boundaries ---

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
