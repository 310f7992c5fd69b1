"""Trajectories: quintic segments from rest to rest, holds and way points (section 4.1).

A plant follows them with the outputs it declares; a load changes its parameters at the
boundaries of segments.
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
    Timing,
)

# --- Trajectories: quintic segments from rest to rest, holds, way points (section 4.1) ---

LARGEST_ANGLE = 3600.0
"""Ten turns; a larger angle is taken as a typing error, degrees."""

LONGEST = 600.0
"""Longest segment with time accumulated as in the study, s."""

Point = tuple[float, ...]
"""A number for each following output: degrees for an angle, else the unit of the port."""


@dataclass(frozen=True)
class Segment:
    """A quintic move from rest to rest, or a hold.

    Parameters
    ----------
    start, end : tuple of float
        Of each following output: nominal angles in degrees, else in the unit of the port; equal
        for a hold.
    duration : float
        s.
    hold : bool, optional
        Whether the set point is constant.

    Raises
    ------
    ArmError
        If a number is not finite, or start and end differ in length.
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
    """Return the error for a segment that is too short or too long."""
    message = f"a segment of {duration} s is out of range"
    return ArmError(message, name="duration", value=duration, hint=hint)


@dataclass(frozen=True, repr=False)
class Trajectory:
    """A sequence of segments.

    Parameters
    ----------
    name : str
        Name in reports.
    segments : tuple of Segment
        At least one; all over the same number of outputs.
    loaded : tuple of bool, optional
        Segments in which the plant carries its load, if any; none by default.
    outputs : tuple of str, optional
        The following outputs, by port; by default the first of each axis of the plant.

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
        """Targets and speed in words."""
        moves = [segment for segment in self.segments if not segment.hold]
        ends = ", ".join(f"({', '.join(f'{x:g}' for x in move.end)})" for move in moves)
        times = dict.fromkeys(f"{move.duration:g} s" for move in moves)
        suffix = " each" if len(times) == 1 < len(moves) else ""
        return f"{ends} in {' and '.join(times)}{suffix}"

    def scaled(self, scale: float) -> Trajectory:
        """Return the trajectory with moves scaled about its start."""
        begin = self.segments[0].start

        def moved(point: Point) -> Point:
            return tuple(a + (x - a) * scale for a, x in zip(begin, point, strict=True))

        segments = (replace(s, start=moved(s.start), end=moved(s.end)) for s in self.segments)
        return replace(self, segments=tuple(segments))


@dataclass(frozen=True, eq=False)
class SetPoints:
    """A sampled trajectory.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Since the start of the run, s.
    position, velocity, acceleration : ndarray, shape (n, k)
        Of each following output: rad for an angle, else its unit; per s and s².
    iterations : ndarray of int64, shape (n,)
        Control periods of each set point.
    segment : ndarray of int64, shape (n,)
        Index of its segment.
    path : ndarray, shape (m, k)
        The trajectory itself in each of the `m` control periods.
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


def _home(angles: Point, start: Point) -> Point:
    return start or (0.0,) * len(angles)


def reach(
    angles: Point = (90.0, -90.0), segment: float = 5.0, hold: float = 5.0, start: Point = ()
) -> Trajectory:
    """Return a move to a position and a hold; a load is picked up on arrival.

    Parameters
    ----------
    angles : tuple of float
        Target of each joint, degrees.
    segment : float
        Duration of the motion, s.
    hold : float
        Duration of the hold, s.
    start : tuple of float, optional
        Initial position, degrees; zeros by default.

    Returns
    -------
    Trajectory
        Of a move and a hold.
    """
    there = Segment(_home(angles, start), angles, segment)
    rest = Segment(angles, angles, hold, hold=True)
    return Trajectory("reach", (there, rest), (False, True))


def reach_return(
    angles: Point = (90.0, -90.0), segment: float = 5.0, hold: float = 5.0, start: Point = ()
) -> Trajectory:
    """Return a move, the move back with the load, and a hold.

    Parameters
    ----------
    angles : tuple of float
        Target of each joint, degrees.
    segment : float
        Duration of each motion, s.
    hold : float
        Duration of the final hold, s.
    start : tuple of float, optional
        Initial position, degrees; zeros by default.

    Returns
    -------
    Trajectory
        Of two moves and a hold.
    """
    home = _home(angles, start)
    segments = (
        Segment(home, angles, segment),
        Segment(angles, home, segment),
        Segment(home, home, hold, hold=True),
    )
    return Trajectory("reach-return", segments, (False, True, True))


def pick_and_place(
    angles: Point = (45.0, -45.0), segment: float = 2.0, start: Point = ()
) -> Trajectory:
    """Return a move and the move back with the load, twice.

    Parameters
    ----------
    angles : tuple of float
        Target of each joint, degrees.
    segment : float
        Duration of each motion, s.
    start : tuple of float, optional
        Initial position, degrees; zeros by default.

    Returns
    -------
    Trajectory
        Of four moves.
    """
    home = _home(angles, start)
    points = [home, angles] * 2 + [home]
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
"""Trajectories of the arm by name; the first is the default."""


def through(
    points: Sequence[Point],
    segment: float = 2.0,
    hold: float = 0.0,
    name: str = "way-points",
    start: Point = (),
) -> Trajectory:
    """Return moves through way points, from rest to rest; a load is picked up at the first.

    Parameters
    ----------
    points : sequence of tuple of float
        Of each following output: angles in degrees, else in the unit of the port.
    segment : float, optional
        Duration of each move, s.
    hold : float, optional
        Duration of a hold at the last point, s; none by default.
    name : str, optional
        Name of the trajectory.
    start : tuple of float, optional
        Initial rest position; zeros by default.

    Raises
    ------
    ArmError
        If there are no points, or a number or a time is out of range.

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
    """Sample a trajectory into set points.

    Time starts at zero in each segment. After each set point it advances by the set-point time (3
    ms in the study), in the precision of the run; a segment ends when it exceeds the duration.

    Parameters
    ----------
    trajectory : Trajectory
        The trajectory.
    conventions : Conventions
        Precision, π and the last set point of a segment.
    timing : Timing, optional
        The study's by default.
    angular : tuple of bool, optional
        Whether each following output is an angle in degrees; all by default.

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
    The study accumulates its 3 ms, so a last bit decides whether a set point falls on the end of a
    segment; other times are counted, and the end belongs to the segment.
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
        # In single precision the accumulated steps may lose up to 0.4 % over a long segment.
        most = int(1.02 * segment.duration / SET_POINT_PERIOD) + 3
        ticks = np.full(most, SET_POINT_PERIOD, number)
        ticks[0] = 0.0
        # cumsum adds one by one in the type of its argument, as the programs did.
        clock = np.cumsum(ticks)
        time = clock[clock <= duration].astype(np.float64)
    else:  # counted: outside the range of the study's programs
        count = int(segment.duration / timing.set_point + 1e-9) + 1
        time = _stored(np.arange(count, dtype=np.float64) * timing.set_point, number)
    start, end = (
        _stored(np.where(angular, values * conventions.pi / 180.0, values), number)
        for values in map(np.array, (segment.start, segment.end))
    )
    # The study's clock ends a segment with its last set point, which then gets one iteration only.
    iterations = np.full(len(time), timing.every)
    if not conventions.whole_set_points:
        iterations[-1] = 1
    position, velocity, acceleration = _quintic(start, end, float(duration), time[:, None], number)
    # A set point is constant over its periods; the trajectory moves on, up to its end.
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
    # 10, -15 and 6 (see `_quintic` of references); each power multiplied out as in the study's
    # programs, since the order of products determines the bits.
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


# --- The load: parameters change at segment boundaries ---


def carried(
    trajectory: Trajectory,
    *,
    payload: bool = False,
    segments: Sequence[int] | None = None,
    conventions: Conventions | None = None,
) -> tuple[bool, ...]:
    """Return for each segment whether the plant carries its load.

    Parameters
    ----------
    trajectory : Trajectory
        Has its own default of loaded segments.
    payload : bool, optional
        Whether there is a load at all.
    segments : sequence of int, optional
        Loaded segments instead, counted from 1.
    conventions : Conventions, optional
        Whether the load stays on during a hold; it does by default.

    Raises
    ------
    ArmError
        If `segments` has an invalid number.
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
