r"""Tubes: where all runs of a closed loop are, for a bounded time, between the samples too.

All starts of a box, all parameters of their intervals and all errors of sensors are followed
together as a zonotope (:mod:`fuzzyarm.proof.loop.zonotope`), period by period in the order of the
loop: sensors, controller, limits, then the plant with its inputs held
(:mod:`fuzzyarm.proof.loop.flow`). Rule bases and tables enter as planes with a proved band
(:mod:`fuzzyarm.proof.loop.planes`). What the controller remembers is part of the zonotope. A box
that is too large for this is halved; boxes are followed side by side.

The claim is of the equations as they are written, in real arithmetic, not of an integrator's steps.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from decimal import ROUND_CEILING, ROUND_FLOOR, Context
from functools import reduce
from typing import NamedTuple

import numpy as np

from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.numbers import decimal, number_text
from fuzzyarm.proof.claim.problem import LoopProblem
from fuzzyarm.proof.loop.enclosure import EnclosureError, Vector
from fuzzyarm.proof.loop.follower import Box, Demand, FollowedBoxes, Follower, Goal
from fuzzyarm.proof.stop import Stop
from fuzzyarm.symbolic.operations import Interval

AT_ONCE = 64
"""Boxes that are followed side by side."""


PARAMETERS_FIRST = 3
"""How often parameters are halved before starts, of boxes that could not be followed."""

Progress = Callable[[float, int], None]
"""Told of the share of the first box that is done, and of how many boxes are open."""


# ── tubes ────────────────────────────────────────────────────────────────────────────


@json_properties("*")
class PortBounds(NamedTuple):
    """Between what a port is.

    Attributes
    ----------
    low, high : ndarray, shape (steps,)
        In each stretch of time.
    """

    low: Vector
    high: Vector


@json_properties("duration boxes arrival ends ports=by_port")
@dataclass(frozen=True, kw_only=True)
class Tube:
    """Where all runs are.

    Attributes
    ----------
    problem : LoopProblem
        Of which loop.
    duration : float
        How far it goes, s: whole control periods.
    ports : tuple of str
        Outputs and inputs of the plant.
    begins, ends : ndarray, shape (steps,)
        Of the stretches of time, s.
    low, high : ndarray, shape (steps, ports)
        Between what each port is at all times of a stretch.
    low_at, high_at : ndarray, shape (steps + 1, ports)
        Between what it is at the start and at the end of each; inputs before they are changed.
    boxes : int
        Into how many boxes the starts were cut.
    open : tuple of dict of str to Interval
        Parts of the starts of which a demand is not proved, or which could not be followed.
    complete : bool
        Whether all parts of the starts were followed to the end: else nothing is bounded.
    seconds : float
        How long it took.
    arrival : float
        After which time all boxes have arrived at a goal, s; 0 where there was none.
    reason : str
        Why one of those that could not be followed ended; empty where there is none.
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
        """Return between what an output (or a drive) is from one time to another.

        Parameters
        ----------
        output : str
            A port of the plant.
        begin, end : float
            s, both included, as the decimals that they are printed as.

        Raises
        ------
        EnclosureError
            If parts of the starts were not followed so far.
        """
        if not self.complete:
            raise EnclosureError("the tube does not contain all starts")
        column = self.ports.index(output)
        return _between(self, column, begin, end)

    def by_port(self) -> dict[str, PortBounds]:
        """Return the bounds of each port in all stretches of time."""
        columns = zip(self.ports, self.low.T, self.high.T, strict=True)
        return {port: PortBounds(low, high) for port, low, high in columns}

    def lines(self) -> list[str]:
        """Return in words where each port is: in all the time, and at its end."""
        report = []
        for port in self.ports:
            whole = self.bounds(port, 0.0, self.duration)
            last = self.bounds(port, self.duration, self.duration)
            report.append(
                f"{port} in {_ends(whole)}, at {number_text(self.duration)} s in {_ends(last)}"
            )
        return report

    def holds(self, demand: Demand) -> bool:
        """Tell whether a demand is proved."""
        interval = self.bounds(demand.port, demand.begin, demand.end)
        return demand.low <= interval.low and interval.high <= demand.high


def _ends(interval: Interval) -> str:
    """Return an interval in words, rounded outward to six digits."""
    return " .. ".join(
        _outward_text(end, up=up) for end, up in ((interval.low, False), (interval.high, True))
    )


def _outward_text(x: float, *, up: bool) -> str:
    """Return a number with six digits, not below (`up`) or not above it."""
    if not math.isfinite(x) or float(f"{x:.6g}") == x:
        return f"{x:.6g}"
    rounding = ROUND_CEILING if up else ROUND_FLOOR
    return f"{Context(prec=6, rounding=rounding).create_decimal(x):.6g}"


def _between(course: Tube, column: int, begin: float, end: float) -> Interval:
    """Return the hull of the control periods that a stretch of time meets.

    A period that is only touched at its end does not count, for inputs jump there: what holds at
    that instant itself is in `low_at` and `high_at`.
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
    """Follow all runs of a closed loop for a bounded time.

    Parameters
    ----------
    problem : LoopProblem
        Controller, plant, starts, parameters, set point, sensors.
    duration : float
        s; rounded up to whole control periods.
    demands : sequence of Demand, optional
        Boxes of which one of these is not proved are halved. Without, only those that cannot be
        followed.
    boxes : sequence of int, optional
        Into how many parts the starts are cut at first, for each state and parameter that has a
        width, in their order; powers of two.
    budget : float
        s, after which no box is halved any more, and none is followed to its end.
    most : int
        Boxes at most.
    progress : callable, optional
        Told of how far it is.
    goal : callable, optional
        Where boxes are to arrive; demands hold for each until then. The tube goes as far as
        all of them were followed.

    Returns
    -------
    Tube
        With the parts of the starts of which nothing is known.

    Raises
    ------
    LoopProofError
        If the plant or the controller has something of which nothing is enclosed.
    UnreadableError
        The same, of an operation in the equations.
    UnprovableError
        The same, of a rule base.
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
                    # While boxes can be halved, those with an open demand are; at the end they are
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
                    way = self._dimension(box, weights[:, group.index(box)], lost=course is None)
                    waiting += box.halves(way)
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
        """Return boxes with their results (None: cannot be followed) and their widening."""
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

        Of a box that is `lost`, which could not be followed, parameters first: what starts are
        apart fades, what parameters are apart acts in every period.
        """
        first = len(self.follower.wide)
        if lost and first < len(box.low):
            halvings = np.array(box.halvings[first:])
            if halvings.min() < PARAMETERS_FIRST:
                return first + int(halvings.argmin())
        # Each halving halves what a dimension is due; the small addend gives all of them their
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
        # Boxes may have taken steps of other lengths: what is common to all are the periods.
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
