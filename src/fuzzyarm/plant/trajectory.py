"""Trajectories: quintic segments from rest to rest, holds and way points (section 4.1).

A plant follows them with the outputs that it says; the load, where there is one, changes its
parameters at the boundaries of segments.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.shown import one_line
from fuzzyarm.plant.setting import (
    SET_POINT_PERIOD,
    STUDY_TIMING,
    ArmError,
    Conventions,
    Pair,
    Timing,
)

# --- Trajectories: quintic segments from rest to rest, holds, way points (section 4.1) ---

LARGEST_ANGLE = 3600.0
"""Ten turns; more is taken for a slip of the pen, degrees."""

LONGEST = 600.0
"""Longest segment whose time is added up as the study does, s."""

Point = tuple[float, ...]
"""A number for each output that follows: degrees of an angle, else in the unit of the port."""


@dataclass(frozen=True)
class Segment:
    """A quintic move from rest to rest, or a hold.

    Parameters
    ----------
    start, end : tuple of float
        Of each output that follows: nominal angles in degrees, else in the unit of the port;
        equal for a hold.
    duration : float
        s.
    hold : bool, optional
        Whether the set point stays where it is.

    Raises
    ------
    ArmError
        If a number is not finite, or there are not as many at the end as at the start.
    """

    start: Point
    end: Point
    duration: float
    hold: bool = False

    def __post_init__(self) -> None:
        for name in ("start", "end"):  # of lists, too
            object.__setattr__(self, name, tuple(map(float, getattr(self, name))))
        for value in (*self.start, *self.end):
            if not math.isfinite(value):
                raise ArmError(f"angle or value {value} is out of range", name="angle", value=value)
        if len(self.start) != len(self.end) or not self.start:
            counts = f"{len(self.start)} numbers at its start and {len(self.end)} at its end"
            raise ArmError(f"a segment has {counts}", name="end", value=self.end)
        if not 0.0 < self.duration < math.inf:
            raise duration_error(self.duration, "a positive number of s")


def duration_error(duration: float, hint: str) -> ArmError:
    """Return the error of a segment that is too short or too long."""
    message = f"a segment of {duration} s is out of range"
    return ArmError(message, name="duration", value=duration, hint=hint)


@dataclass(frozen=True, repr=False)
class Trajectory:
    """Segments, one after the other.

    Parameters
    ----------
    name : str
        Under which it is reported.
    segments : tuple of Segment
        At least one; all over the same number of outputs.
    loaded : tuple of bool, optional
        In which segments the plant carries its load when there is one; in none by default.
    outputs : tuple of str, optional
        The outputs that follow, by port; by default the first of each axis of the plant.

    Raises
    ------
    ArmError
        If the segments do not fit together.
    """

    name: str
    segments: tuple[Segment, ...]
    loaded: tuple[bool, ...] = ()
    outputs: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name in ("segments", "loaded", "outputs"):  # of lists, too
            object.__setattr__(self, name, tuple(getattr(self, name)))
        if not self.segments:
            raise ArmError(f"trajectory '{self.name}' has no segments", name="segments")
        widths = {len(segment.start) for segment in self.segments}
        if len(widths) > 1:
            message = f"trajectory '{self.name}' has segments of {min(widths)} and {max(widths)}"
            raise ArmError(f"{message} numbers", name="segments")
        if not self.loaded:
            object.__setattr__(self, "loaded", (False,) * len(self.segments))
        if len(self.loaded) != len(self.segments):
            counts = f"{len(self.loaded)} values for {len(self.segments)} segments"
            raise ArmError(f"loaded of trajectory '{self.name}' has {counts}", name="loaded")

    def __repr__(self) -> str:
        count = len(self.segments)
        return one_line(self, f"{self.name}: {self.duration:.4g} s in {count} segments")

    @property
    def duration(self) -> float:
        """Sum of the durations, s."""
        return sum(segment.duration for segment in self.segments)

    @property
    def words(self) -> str:
        """Where it goes, and how fast."""
        moves = [segment for segment in self.segments if not segment.hold]
        ends = ", ".join(f"({', '.join(f'{x:g}' for x in move.end)})" for move in moves)
        times = dict.fromkeys(f"{move.duration:g} s" for move in moves)
        suffix = " each" if len(times) == 1 < len(moves) else ""
        return f"{ends} in {' and '.join(times)}{suffix}"

    def scaled(self, scale: float) -> Trajectory:
        """Return it with ways of another size from where it begins."""
        begin = self.segments[0].start

        def moved(point: Point) -> Point:
            return tuple(a + (x - a) * scale for a, x in zip(begin, point, strict=True))

        segments = (replace(s, start=moved(s.start), end=moved(s.end)) for s in self.segments)
        return replace(self, segments=tuple(segments))


@dataclass(frozen=True)
class SetPoints:
    """A trajectory, sampled.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Since the start of the run, s.
    position, velocity, acceleration : ndarray, shape (n, k)
        Of each output that follows: in rad of an angle, else in its unit; by s and s².
    iterations : ndarray of int64, shape (n,)
        Control iterations of each set point.
    segment : ndarray of int64, shape (n,)
        Index of its segment.
    path : ndarray, shape (m, k)
        Where the trajectory itself is in each of the `m` control iterations.
    """

    time: NDArray[np.float64]
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    acceleration: NDArray[np.float64]
    iterations: NDArray[np.int64]
    segment: NDArray[np.int64]
    path: NDArray[np.float64]


def _moves(points: Sequence[Point], duration: float) -> list[Segment]:
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
    points: Sequence[Point],
    segment: float = 2.0,
    hold: float = 0.0,
    name: str = "way-points",
    start: Point = (),
) -> Trajectory:
    """Move through way points, from rest to rest; a load is picked up at the first.

    Parameters
    ----------
    points : sequence of tuple of float
        Of each output that follows: angles in degrees, else in the unit of the port.
    segment : float, optional
        Duration of each move, s.
    hold : float, optional
        Time to stay at the last point, s; none by default.
    name : str, optional
        Name of the trajectory.
    start : tuple of float, optional
        Where the plant rests at first; zeros by default.

    Raises
    ------
    ArmError
        If there are no points, or a number of them or a time is out of range.

    Examples
    --------
    >>> through([(20.0, -10.0), (30.0, 40.0)], 1.5, hold=1.0)
    <Trajectory way-points: 4 s in 3 segments>
    """
    if not points:
        raise ArmError("a trajectory needs at least one way point", name="points", value=points)
    every = [start or (0.0,) * len(points[0]), *points]
    segments = _moves(every, segment)
    if hold:
        segments.append(Segment(every[-1], every[-1], hold, hold=True))
    return Trajectory(name, tuple(segments), tuple(index > 0 for index in range(len(segments))))


@lru_cache(maxsize=64)
def sample(
    trajectory: Trajectory,
    conventions: Conventions,
    timing: Timing = STUDY_TIMING,
    angular: tuple[bool, ...] = (),
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
    angular : tuple of bool, optional
        Of each output that follows whether it is an angle, written in degrees; all by default.

    Returns
    -------
    SetPoints
        Angles in radians; the arrays are shared between calls and read-only.

    Raises
    ------
    ArmError
        If an angle or a time is out of range.

    Notes
    -----
    The study adds its 3 ms up, so that a last bit decides whether a set point falls on the end of
    a segment; other times are counted, and the end belongs to the segment.
    """
    angular = angular or (True,) * len(trajectory.segments[0].start)
    for segment in trajectory.segments:
        _require_in_range(segment, timing, angular)
    parts = [
        _sample_segment(segment, conventions, timing, np.array(angular))
        for segment in trajectory.segments
    ]
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


def _require_in_range(segment: Segment, timing: Timing, angular: Sequence[bool]) -> None:
    """Raise ArmError for an angle of many turns, or a segment without a set point."""
    for ends in (segment.start, segment.end):
        for angle, turns in zip(ends, angular, strict=True):
            if turns and abs(angle) > LARGEST_ANGLE:
                raise ArmError(
                    f"angle {angle} is out of range",
                    name="angle",
                    value=angle,
                    hint=f"a number of degrees between {-LARGEST_ANGLE:g} and {LARGEST_ANGLE:g}",
                )
    if timing.set_point == SET_POINT_PERIOD:
        if not SET_POINT_PERIOD < segment.duration <= LONGEST:
            hint = f"more than {SET_POINT_PERIOD:g} s and at most {LONGEST:g} s"
            raise duration_error(segment.duration, hint)
    elif segment.duration < timing.set_point:
        raise duration_error(segment.duration, f"at least a set point, {timing.set_point:g} s")


Sampled = tuple[
    NDArray[np.float64],
    NDArray[np.float64],
    NDArray[np.float64],
    NDArray[np.float64],
    NDArray[np.int64],
    NDArray[np.float64],
]


def _sample_segment(
    segment: Segment, conventions: Conventions, timing: Timing, angular: NDArray[np.bool_]
) -> Sampled:
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
        _stored(np.where(angular, values * conventions.pi / 180.0, values), number)
        for values in map(np.array, (segment.start, segment.end))
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


# --- What is carried where: the load changes the plant at segment boundaries ---


def carried(
    trajectory: Trajectory,
    *,
    payload: bool = False,
    segments: Sequence[int] | None = None,
    conventions: Conventions | None = None,
) -> tuple[bool, ...]:
    """Say for each segment whether the plant carries its load.

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
        return tuple(index + 1 in segments for index in range(count))
    stays = conventions is None or conventions.load_in_hold
    return tuple(
        payload and loaded and (stays or not segment.hold)
        for loaded, segment in zip(trajectory.loaded, trajectory.segments, strict=True)
    )
