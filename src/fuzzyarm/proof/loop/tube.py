r"""Reachable tubes of a closed loop for a bounded time, between the samples too.

All starts of a box, all parameters of their intervals and all errors of sensors are followed
together as a zonotope (:mod:`fuzzyarm.proof.loop.zonotope`), period by period in the order of the
loop: sensors, controller, limits, then the plant with its inputs held
(:mod:`fuzzyarm.proof.loop.flow`). Rule bases and tables enter as planes with a proved band
(:mod:`fuzzyarm.proof.loop.planes`). The controller's memory is part of the zonotope. A box that is
too large for this is halved; boxes are followed side by side.

The claim is about the equations in real arithmetic, not about an integrator's steps.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import reduce
from typing import NamedTuple

import numpy as np

from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.numbers import decimal, number_text, outward_text
from fuzzyarm.proof.claim.problem import LoopProblem
from fuzzyarm.proof.loop.enclosure import EnclosureError, Vector
from fuzzyarm.proof.loop.follower import Box, Demand, FollowedBoxes, Follower, Goal
from fuzzyarm.proof.stop import Stop
from fuzzyarm.symbolic.operations import Interval

AT_ONCE = 64
"""Boxes followed side by side."""

PARAMETERS_FIRST = 3
"""Halvings of parameters before those of starts, for boxes without an enclosure."""

Progress = Callable[[float, int], None]
"""Called with the finished share of the first box, and the number of open boxes."""


# ── tubes ────────────────────────────────────────────────────────────────────────────


@json_properties("*")
class PortBounds(NamedTuple):
    """Bounds of a port.

    Attributes
    ----------
    low, high : ndarray, shape (steps,)
        Bounds in each time interval.
    """

    low: Vector
    high: Vector


@json_properties("duration boxes arrival ends ports=by_port")
@dataclass(frozen=True, eq=False, kw_only=True)
class Tube:
    """Bounds of all runs.

    Attributes
    ----------
    problem : LoopProblem
        The loop.
    duration : float
        Duration of the tube, s: whole control periods.
    ports : tuple of str
        Outputs and inputs of the plant.
    begins, ends : ndarray, shape (steps,)
        Begins and ends of the time intervals, s.
    low, high : ndarray, shape (steps, ports)
        Bounds of each port during an interval.
    low_at, high_at : ndarray, shape (steps + 1, ports)
        Bounds at the ends of the intervals; of inputs before they change.
    boxes : int
        Number of boxes of the starts.
    open : tuple of dict of str to Interval
        Parts of the starts with an unproved demand, or without an enclosure.
    complete : bool
        Whether all parts of the starts were followed to the end: else there are no bounds.
    seconds : float
        Time taken.
    arrival : float
        Time until all boxes have arrived at the goal, s; 0 without a goal.
    reason : str
        Why a box could not be followed; empty if all could.
    """

    problem: LoopProblem = field(repr=False)
    duration: float
    ports: tuple[str, ...]
    begins: Vector = field(repr=False)
    ends: Vector = field(repr=False)
    low: Vector = field(repr=False)
    high: Vector = field(repr=False)
    low_at: Vector = field(repr=False)
    high_at: Vector = field(repr=False)
    boxes: int
    open: tuple[dict[str, Interval], ...]
    complete: bool
    seconds: float
    arrival: float = 0.0
    reason: str = ""

    def bounds(self, output: str, begin: float, end: float) -> Interval:
        """Return bounds of an output (or a drive) from one time to another.

        Parameters
        ----------
        output : str
            A port of the plant.
        begin, end : float
            s, both included, as printed decimals.

        Raises
        ------
        EnclosureError
            If parts of the starts were not followed that long.
        """
        if not self.complete:
            raise EnclosureError("the tube does not contain all starts")
        column = self.ports.index(output)
        return _between(self, column, begin, end)

    def by_port(self) -> dict[str, PortBounds]:
        """Return the bounds of each port in all time intervals."""
        columns = zip(self.ports, self.low.T, self.high.T, strict=True)
        return {port: PortBounds(low, high) for port, low, high in columns}

    def lines(self) -> list[str]:
        """Return in words the bounds of each port: over all time, and at its end."""
        report = []
        for port in self.ports:
            whole = self.bounds(port, 0.0, self.duration)
            last = self.bounds(port, self.duration, self.duration)
            report.append(
                f"{port} in {_ends(whole)}, at {number_text(self.duration)} s in {_ends(last)}"
            )
        return report

    def holds(self, demand: Demand) -> bool:
        """Return whether a demand is proved."""
        interval = self.bounds(demand.port, demand.begin, demand.end)
        return demand.low <= interval.low and interval.high <= demand.high


def _ends(interval: Interval) -> str:
    """Return an interval in words, rounded outward to six digits."""
    low, high = interval
    return f"{outward_text(low, up=False, digits=6)} .. {outward_text(high, up=True, digits=6)}"


def _between(course: Tube, column: int, begin: float, end: float) -> Interval:
    """Return the hull of the control periods that a time interval meets.

    A period touched at its end only does not count, since inputs jump there: bounds at that instant
    are in `low_at` and `high_at`.
    """
    period = decimal(course.problem.period)
    first, last = decimal(begin) / period, decimal(end) / period
    if not 0 <= first <= last <= len(course.begins):
        raise EnclosureError(f"the tube is from 0 to {course.duration:g} s")
    inside = slice(math.floor(first), math.ceil(last))
    at = [int(time) for time in (first, last) if time.denominator == 1]
    low = np.concatenate([course.low[inside, column], course.low_at[at, column]])
    high = np.concatenate([course.high[inside, column], course.high_at[at, column]])
    return Interval(float(low.min()), float(high.max()))


def tube(
    problem: LoopProblem,
    duration: float,
    *,
    demands: Sequence[Demand] = (),
    boxes: Sequence[int] = (),
    budget: float = 60.0,
    most: int = 4096,
    progress: Progress | None = None,
    goal: Goal | None = None,
) -> Tube:
    """Compute the tube of all runs of a closed loop for a bounded time.

    Parameters
    ----------
    problem : LoopProblem
        Controller, plant, starts, parameters, set point, sensors.
    duration : float
        s; rounded up to whole control periods.
    demands : sequence of Demand, optional
        Boxes with an unproved demand are halved; without demands only those without an enclosure.
    boxes : sequence of int, optional
        Initial parts of the starts for each state and parameter with a width, in their order;
        powers of two.
    budget : float
        s; after that no box is halved, or followed to its end.
    most : int
        Most boxes.
    progress : callable, optional
        Called with the progress.
    goal : callable, optional
        Destination of boxes; demands apply to each until arrival. The tube ends where all of them
        have been followed.

    Returns
    -------
    Tube
        With the parts of the starts left open.

    Raises
    ------
    LoopProofError
        If part of the plant or of the controller has no enclosure.
    UnreadableError
        If an operation in the equations has none.
    UnprovableError
        If a rule base has none.
    """
    return _Bisection(problem, duration, tuple(demands), budget, most, progress, goal).tube(boxes)


class _Bisection:
    """Halves boxes until all demands are proved, or time is over."""

    def __init__(
        self, problem: LoopProblem, duration: float, demands: tuple[Demand, ...], budget: float,
        most: int, progress: Progress | None, goal: Goal | None,
    ) -> None:  # fmt: skip
        self.begun = clock.monotonic()
        self.stop = Stop(budget)
        self.follower = Follower(problem, duration, demands, self.stop, goal)
        self.most = most
        self.progress = progress
        self.done = 0.0
        self.reason = ""

    def tube(self, boxes: Sequence[int]) -> Tube:
        """Return the tube."""
        waiting = self._cut(boxes)
        finished: list[FollowedBoxes] = []
        failed: list[Box] = []
        unfollowed: list[Box] = []
        count = len(waiting)
        while waiting:
            batch, waiting = waiting[:AT_ONCE], waiting[AT_ONCE:]
            halves = bool(self.follower.names) and count < self.most
            halves &= not self.stop.now
            for group, course, weights in self._followed(batch, whole=not halves):
                halved = list(group)
                if course is not None:
                    # Boxes with an open demand are halved as long as possible; at the end they are
                    # reported.
                    complete = ~course.undone if halves else np.ones(len(group), dtype=bool)
                    if complete.any():
                        finished.append(course.part(complete))
                    failed += [
                        box for box, bad in zip(group, complete & course.undone, strict=True) if bad
                    ]
                    self.done += sum(
                        box.share() for box, good in zip(group, complete, strict=True) if good
                    )
                    halved = [box for box, good in zip(group, complete, strict=True) if not good]
                elif not halves:
                    unfollowed += group
                    halved = []
                for box in halved:
                    weight = weights[:, group.index(box)]
                    waiting += box.halves(self._dimension(box, weight, lost=course is None))
                    count += 1
            if self.progress is not None:
                self.progress(self.done, len(waiting))
        return self._answer(finished, failed, unfollowed, count)

    def _cut(self, boxes: Sequence[int]) -> list[Box]:
        halves_of_box = [self.follower.first]
        for dimension, parts in enumerate(boxes):
            # ⌈log₂ parts⌉ halvings.
            for _ in range(max(0, int(parts) - 1).bit_length()):
                halves_of_box = [half for box in halves_of_box for half in box.halves(dimension)]
        return halves_of_box

    def _followed(
        self, boxes: Sequence[Box], *, whole: bool
    ) -> list[tuple[list[Box], FollowedBoxes | None, Vector]]:
        """Return boxes with their results (None: no enclosure) and their widening."""
        try:
            course = self.follower.follow(boxes, whole=whole)
            return [(list(boxes), course, course.weight)]
        except EnclosureError as error:
            # Once time is over no part of them can be followed either.
            if len(boxes) == 1 or self.stop.now:
                self.reason = str(error)
                return [(list(boxes), None, self.follower.last_weight)]
            middle = len(boxes) // 2
            first = self._followed(boxes[:middle], whole=whole)
            return first + self._followed(boxes[middle:], whole=whole)

    def _dimension(self, box: Box, weight: Vector, *, lost: bool) -> int:
        """Return the dimension to halve: the one that widens the tube most, for its halvings.

        For a `lost` box, without an enclosure, parameters first: the spread of starts fades, the
        spread of parameters acts in every period.
        """
        first = len(self.follower.wide)
        if lost and first < len(box.low):
            halvings = np.array(box.halvings[first:])
            if halvings.min() < PARAMETERS_FIRST:
                return first + int(halvings.argmin())
        # Each halving halves the contribution of a dimension; the small addend gives all their
        # turn.
        return int(np.argmax((weight + 0.05) * 0.5 ** np.array(box.halvings)))

    def _answer(
        self,
        finished: Sequence[FollowedBoxes],
        failed: Sequence[Box],
        lost: Sequence[Box],
        count: int,
    ) -> Tube:
        follower = self.follower
        period, names = decimal(follower.period), follower.names
        # Boxes may have different steps; all share the control periods.
        lengths = [round(float(course.ends[-1])) for course in finished] or [follower.periods]
        common = min(lengths)
        stretches = (
            [
                course.by_period(length, common)
                for course, length in zip(finished, lengths, strict=True)
            ]
            if finished
            else []
        )
        times = [float(k * period) for k in range((common if finished else 0) + 1)]
        begins, ends = times[:-1], times[1:]
        low, high, low_at, high_at = (
            reduce(choose, arrays)
            for choose, arrays in zip(
                (np.minimum, np.maximum, np.minimum, np.maximum),
                zip(*stretches, strict=True) if stretches else [[np.zeros((0, 0))]] * 4,
                strict=True,
            )
        )
        waiting = tuple(
            {name: Interval(a, b) for name, a, b in zip(names, box.low, box.high, strict=True)}
            for box in (*failed, *lost)
        )
        return Tube(
            problem=follower.problem,
            duration=float(common * period),
            ports=tuple(follower.labels),
            begins=np.asarray(begins, float),
            ends=np.asarray(ends, float),
            low=low,
            high=high,
            low_at=low_at,
            high_at=high_at,
            boxes=count,
            open=waiting,
            complete=not lost and bool(finished),
            seconds=clock.monotonic() - self.begun,
            arrival=0.0 if follower.goal is None else float(max(lengths) * period),
            reason=self.reason if lost else "",
        )
