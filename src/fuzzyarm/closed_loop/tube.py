r"""Tubes: where all runs of a closed loop are, for a bounded time, between the samples too.

All starts of a box, all parameters of their intervals and all errors of sensors are followed
together as a zonotope (:mod:`fuzzyarm.closed_loop.zonotope`), period by period in the order of the
loop: sensors, controller, limits, then the plant with its inputs held
(:mod:`fuzzyarm.closed_loop.flow`). Rule bases and tables enter as planes with a proved band
(:mod:`fuzzyarm.closed_loop.planes`). What the controller remembers is part of the zonotope. A box
that is too large for this is halved; boxes are followed side by side.

The claim is of the equations as they are written, in real arithmetic, not of an integrator's steps.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, reduce
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.closed_loop.enclosure import EnclosureError, Intervals, outward
from fuzzyarm.closed_loop.flow import Flow, Step, read, readable, stacked
from fuzzyarm.closed_loop.planes import Band, RulePlanes, TablePlanes, Zonotope
from fuzzyarm.closed_loop.problem import ControlPeriod, LoopProblem
from fuzzyarm.closed_loop.zonotope import Forms, clip, larger, smaller
from fuzzyarm.expression.evaluation import gradient, specialise
from fuzzyarm.expression.nodes import Constant, Node, replace, symbols
from fuzzyarm.expression.operations import Interval
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.plant.plant import Address
from fuzzyarm.table import LookupTable

__all__ = ["Demand", "Progress", "Tube", "tube"]

Vector = NDArray[np.float64]
Number = Forms | float

ORDER = 6
"""Of the Taylor polynomials in time."""

MOST_SYMBOLS = 12
"""Symbols for each state, beside those of the first box and of the parameters."""

MOST_PARTS = 256
"""Steps of one control period."""

LARGE, SMALL = 1e-3, 1e-7
"""Shares of the radius that the last term of a series may be, and below which steps grow again."""

FLOOR = 1e-5
"""Share of the size that a state has had so far which counts as a radius, where it has less."""

CORNER_PARTS = 8
"""The same where a corner lies within the period, and a step is of first order."""

AT_ONCE = 64
"""Boxes that are followed side by side."""


# ── controllers over forms ───────────────────────────────────────────────────────────


class _Zonotopes:
    """Numbers of a control period: forms of shape (batch,), and floats of the file."""

    def __init__(self, batch: int, planes: Callable[[Any, str], Any]) -> None:
        self.batch = batch
        self.planes = planes
        self.count = 0

    def forms(self, x: Number) -> Forms:
        """Return a number as forms."""
        return x if isinstance(x, Forms) else Forms.at(np.full(self.batch, x))

    def fresh(self, x: Forms) -> Forms:
        """Return forms whose rest is a symbol of its own."""
        if not x.rest.any():
            return x
        self.count += 1
        return x.with_symbols(self.count, [self.count - 1])

    def number(self, value: float) -> Number:
        """Return a number of the file."""
        return float(value)

    def _both(self, a: Number, b: Number) -> tuple[Forms, Number]:
        if isinstance(a, Forms):
            return a, b
        return self.forms(a), b if isinstance(b, Forms) else self.forms(b)

    def add(self, a: Number, b: Number) -> Number:
        """Return a sum."""
        if not isinstance(a, Forms) and isinstance(b, Forms):
            a, b = b, a
        first, second = self._both(a, b)
        return first + second

    def subtract(self, a: Number, b: Number) -> Number:
        """Return a difference."""
        return self.add(a, -b)

    def multiply(self, a: Number, b: Number) -> Number:
        """Return a product."""
        if not isinstance(a, Forms) and isinstance(b, Forms):
            a, b = b, a
        first, second = self._both(a, b)
        return first * second

    def divide(self, a: Number, b: Number) -> Number:
        """Return a quotient."""
        first, second = self._both(a, b)
        return first / second

    def limit(self, x: Number, low: float, high: float) -> Number:
        """Return ``min(max(x, low), high)``."""
        return self.fresh(clip(self.forms(x), low, high))

    def near(self, x: Number, before: Number, most: float) -> Number:
        """Return ``min(max(x, before - most), before + most)``."""
        own, last = self.forms(x), self.forms(before)
        # `most` is a product of floats that the loop rounds: a neighbour each way.
        size = Forms.between(
            np.full(self.batch, math.nextafter(most, 0.0)),
            np.full(self.batch, math.nextafter(most, math.inf)),
        )
        return self.fresh(smaller(larger(own, last - size), last + size))

    def expression(self, root: Node, values: Mapping[str, Number]) -> Number:
        """Return what an expression is for some values of its symbols."""
        made = {name: self.forms(value) for name, value in values.items()}
        return self.fresh(read([_readable(root)], made)[0])

    def error(self, x: Number, size: float) -> Number:
        """Return ``x`` and an unknown error of at most a size."""
        return self.fresh(self.forms(x).within(size))

    def rules(self, sheet: RuleBase, inputs: Mapping[str, Number]) -> list[Number]:
        """Return what a rule base concludes, output by output."""
        found: list[Number] = []
        for output in sheet.outputs:
            planes: RulePlanes = self.planes(sheet, output.name)
            given = [self._inside(inputs[each.name], each) for each in sheet.inputs]
            value = self._asked(planes.band, given)
            if planes.clamps:
                value = self.fresh(clip(value, output.low, output.high))
            found.append(value)
        return found

    def table(self, sheet: LookupTable, inputs: Mapping[str, Number]) -> Number:
        """Return what a lookup table says."""
        planes: TablePlanes = self.planes(sheet, "")
        return self._asked(planes.band, [self.forms(inputs[name]) for name in sheet.names])

    def _inside(self, x: Number, variable: Any) -> Forms:
        own = self.forms(x)
        if variable.outside == "extend":
            return own
        return self.fresh(clip(own, variable.low, variable.high))

    def _asked(self, band: Callable[[Zonotope], Band], given: Sequence[Forms]) -> Forms:
        """Return a value from the plane and the band of each box."""
        inputs = stacked(given)
        rows = range(inputs.shape[0])
        bands = [
            band(
                Zonotope(
                    inputs.centre[:, box],
                    np.column_stack([inputs.parts[:, :, box].T, np.diag(inputs.rest[:, box])]),
                )
            )
            for box in range(self.batch)
        ]
        slopes = np.array([each.slopes for each in bands])
        value = Forms.between([each.low for each in bands], [each.high for each in bands])
        for row in rows:
            value = value + inputs[row].scaled(slopes[:, row])
        return self.fresh(value)


@cache
def _readable(root: Node) -> Node:
    return readable(root)


# ── what is followed ─────────────────────────────────────────────────────────────────


class Demand(NamedTuple):
    """What is asked of an output (or a drive): to be within bounds from one time to another, s."""

    port: str
    low: float
    high: float
    begin: float
    end: float


Progress = Callable[[float, int], None]
"""Told of the share of the first box that is done, and of how many boxes are open."""


class _Box(NamedTuple):
    """A part of the first box: intervals of the dimensions that have a width, and their halvings."""

    low: tuple[float, ...]
    high: tuple[float, ...]
    halvings: tuple[int, ...]

    def share(self) -> float:
        return float(0.5 ** sum(self.halvings))

    def halves(self, dimension: int) -> tuple[_Box, _Box]:
        middle = 0.5 * self.low[dimension] + 0.5 * self.high[dimension]
        cut = list(self.halvings)
        cut[dimension] += 1
        high, low = list(self.high), list(self.low)
        high[dimension] = low[dimension] = middle
        return (
            _Box(self.low, tuple(high), tuple(cut)),
            _Box(tuple(low), self.high, tuple(cut)),
        )


class _Course(NamedTuple):
    """What came of boxes that were followed side by side; times in control periods.

    `between` has the ports at all times of each step, shape (steps, ports, boxes), and `at` those
    at its ends, the first one included; `weight` is by how much each dimension of the first box widens them.
    """

    begins: Vector
    ends: Vector
    between: Intervals
    at: Intervals
    weight: Vector


class _Follower:
    """Follows boxes of one problem."""

    def __init__(self, problem: LoopProblem, duration: float) -> None:
        self.problem = problem
        equations = problem.equations
        self.period = problem.period
        self.periods = max(1, math.ceil(duration / self.period - 1e-9))
        points, moving = {}, {}
        for symbol, (name, value) in zip(
            equations.parameters, problem.parameters.items(), strict=True
        ):
            (points if value.low == value.high else moving)[symbol] = (name, value)
        numbers = {symbol: value.low for symbol, (_, value) in points.items()}
        self.parameters = list(moving)
        self.flow = Flow([replace(root, numbers) for root in equations.rates])
        self.outputs = [readable(replace(root, numbers)) for root in equations.outputs]
        self.weights = [_affine_weights(root, self.flow.states) for root in self.outputs]
        self.inputs = equations.inputs
        starts = [problem.start[name] for name in problem.states]
        self.start = starts
        # The dimensions of the first box: states and parameters that have a width.
        self.wide = [i for i, each in enumerate(starts) if each.low < each.high]
        intervals = [starts[i] for i in self.wide] + [value for _, value in moving.values()]
        self.names = [problem.states[i] for i in self.wide] + [name for name, _ in moving.values()]
        self.first = _Box(
            tuple(each.low for each in intervals),
            tuple(each.high for each in intervals),
            (0,) * len(intervals),
        )
        interface = problem.site.interface
        self.ports = [*interface.outputs, *interface.inputs]
        self.labels = [interface.label(port) for port in self.ports]
        self._planes: dict[tuple[int, str], Any] = {}

    def planes(self, sheet: Any, output: str) -> Any:
        """Return the planes of a rule base or a table, cut once."""
        key = id(sheet), output
        if key not in self._planes:
            made = RulePlanes(sheet, output) if isinstance(sheet, RuleBase) else TablePlanes(sheet)
            self._planes[key] = sheet, made
        return self._planes[key][1]

    # --- one batch ---

    def follow(self, boxes: Sequence[_Box]) -> _Course:
        """Follow boxes side by side; EnclosureError where one of them cannot be."""
        batch, kept = len(boxes), len(self.first.low)
        algebra = _Zonotopes(batch, self.planes)
        control = ControlPeriod[Number](self.problem, algebra)
        states, constants = self._begun(boxes)
        memory: dict[str, Number] = dict.fromkeys(control.memory, 0.0)
        for name, value in control.memory.items():
            memory[name] = 0.0 if math.isnan(value) else value
        parts = 1
        begins, ends, between, at = [], [], [], []
        weight = np.zeros((kept, batch))
        self.sizes = states.bounds.size.max(axis=1)
        first = self._outputs_at(states, constants, 0.0)
        for period in range(self.periods):
            algebra.count = len(states.parts)
            told = self._told(states, constants, period * self.period)
            inputs, memory = control.run(told, memory, first=period == 0)
            held = {
                name: algebra.forms(inputs[port])
                for name, port in zip(self.inputs, self.problem.site.interface.inputs, strict=True)
            }
            driven = stacked([held[name] for name in self.inputs]).bounds
            states = states.with_symbols(max(algebra.count, len(states.parts)))
            states, steps, parts = self._moved(
                states, {**constants, **held}, period * self.period, parts
            )
            if not at:
                at.append(_joined(first, driven))
            for index, outputs in enumerate(steps):
                begins.append(period + index / len(steps))
                ends.append(period + (index + 1) / len(steps))
                between.append(_joined(outputs[0], driven))
                at.append(_joined(outputs[1], driven))
            weight = np.maximum(weight, self._weight(states, kept))
            states, memory = self._fewer(states, memory, kept, algebra)
        return _Course(
            np.array(begins),
            np.array(ends),
            Intervals(np.stack([x.low for x in between]), np.stack([x.high for x in between])),
            Intervals(np.stack([x.low for x in at]), np.stack([x.high for x in at])),
            weight,
        )

    def _begun(self, boxes: Sequence[_Box]) -> tuple[Forms, dict[str, Forms]]:
        """Return states and parameters, each width a symbol."""
        batch, count = len(boxes), len(self.first.low)
        rows = []
        for i, interval in enumerate(self.start):
            if i in self.wide:
                rows.append(self._dimension(boxes, self.wide.index(i), count))
            else:
                rows.append(Forms.at(np.full(batch, interval.low)).with_symbols(count))
        first = len(self.wide)
        constants = {
            name: self._dimension(boxes, first + i, count) for i, name in enumerate(self.parameters)
        }
        return stacked(rows), constants

    @staticmethod
    def _dimension(boxes: Sequence[_Box], index: int, count: int) -> Forms:
        low, high = [box.low[index] for box in boxes], [box.high[index] for box in boxes]
        return Forms.between(low, high).with_symbols(count, [index])

    def _told(
        self, states: Forms, constants: Mapping[str, Forms], time: float
    ) -> dict[Address, Number]:
        batch = states.shape[1]
        values = {**constants, **{f"x{i}": states[i] for i in range(states.shape[0])}}
        values["t"] = Forms.at(np.full(batch, time))
        found = read(self.outputs, values)
        return dict(zip(self.problem.site.interface.outputs, found, strict=True))

    def _outputs_at(self, states: Forms, constants: Mapping[str, Forms], time: float) -> Intervals:
        found = self._told(states, constants, time)
        return stacked([each for each in found.values() if isinstance(each, Forms)]).bounds

    def _outputs_between(
        self, ends: tuple[Intervals, Intervals], step: Step, constants: Mapping[str, Forms],
        begin: float, end: float,
    ) -> Intervals:  # fmt: skip
        """Return the outputs during a step."""
        box, batch = step.between, step.between.shape[1]
        values = {**constants, **{f"x{i}": Forms.of(box[i]) for i in range(box.shape[0])}}
        values["t"] = Forms.between(np.full(batch, begin), np.full(batch, end))
        over = stacked(read(self.outputs, values)).bounds
        if step.bend is None:
            return over
        # Where an output is a sum of states it bends as they do.
        line = ends[0].hull(ends[1])
        low, high = over.low.copy(), over.high.copy()
        for row, weights in enumerate(self.weights):
            if weights is not None:
                own = line[row]
                for i, weight in enumerate(weights):
                    if weight:
                        own = own + step.bend[i] * outward(weight, weight)
                low[row], high[row] = np.maximum(low[row], own.low), np.minimum(high[row], own.high)
        return Intervals(low, high)

    def _moved(
        self, states: Forms, constants: Mapping[str, Forms], time: float, parts: int
    ) -> tuple[Forms, list[tuple[Intervals, Intervals]], int]:
        """Return the states a period on, outputs in each step and at its end, and the next steps."""
        own = {name: constants[name] for name in self.parameters}
        while True:
            try:
                moved, steps, remainder = states, [], 0.0
                before = self._outputs_at(states, own, time)
                length = self.period / parts  # of a power of two: exact
                for index in range(parts):
                    begin = time + index * length
                    step = self.flow.step(moved, constants, begin, length, ORDER)
                    after = self._outputs_at(step.end, own, begin + length)
                    over = self._outputs_between((before, after), step, own, begin, begin + length)
                    steps.append((over, after))
                    before = after
                    sizes = np.maximum(self.sizes, step.between.size.max(axis=1))
                    radius = np.maximum(step.end.radius, FLOOR * sizes[:, None])
                    remainder = max(remainder, float((step.remainder / radius).max()))
                    if remainder > LARGE and parts < self._most(step):
                        break
                    moved = _with_own_symbols(step.end)
                if remainder > LARGE and parts < self._most(step):
                    parts *= 2
                    continue
                self.sizes = np.maximum(self.sizes, sizes)
                return moved, steps, parts // 2 if remainder < SMALL and parts > 1 else parts
            except EnclosureError:
                if parts >= MOST_PARTS:
                    raise
                parts *= 2

    @staticmethod
    def _most(step: Step) -> int:
        """Return into how many steps a period is cut for the sake of the remainder."""
        return MOST_PARTS if step.bend is not None else CORNER_PARTS

    @staticmethod
    def _weight(states: Forms, kept: int) -> Vector:
        radius = np.maximum(states.radius, 1e-300)
        return np.asarray((np.abs(states.parts[:kept]) / radius).max(axis=1))

    @staticmethod
    def _fewer(
        states: Forms, memory: Mapping[str, Number], kept: int, algebra: _Zonotopes
    ) -> tuple[Forms, dict[str, Number]]:
        """Return states and memory over fewer symbols."""
        names = [name for name, value in memory.items() if isinstance(value, Forms)]
        joint = stacked([states[i] for i in range(states.shape[0])] + [
            algebra.forms(memory[name]) for name in names
        ])  # fmt: skip
        count = len(joint.parts)
        if joint.rest.any():
            joint = joint.with_symbols(count + joint.shape[0], range(count, count + joint.shape[0]))
        joint = joint.reduced(kept, kept + MOST_SYMBOLS * joint.shape[0])
        size = states.shape[0]
        remembered: dict[str, Number] = dict(memory)
        remembered |= {name: joint[size + i] for i, name in enumerate(names)}
        if not np.isfinite(joint.radius).all():
            raise EnclosureError("the tube has no bound")
        return joint[:size], remembered


def _with_own_symbols(forms: Forms) -> Forms:
    """Return forms whose rests are symbols, one for each along the first axis."""
    if not forms.rest.any():
        return forms
    count, rows = len(forms.parts), forms.shape[0]
    return forms.with_symbols(count + rows, range(count, count + rows))


def _affine_weights(root: Node, states: Sequence[str]) -> list[float] | None:
    """Return how an expression grows with the states; None where that is not constant."""
    slopes = [specialise(each, {}) for each in gradient(root, tuple(states))]
    if not all(isinstance(each, Constant) for each in slopes) or "t" in symbols(root):
        return None
    return [each.value for each in slopes if isinstance(each, Constant)]


def _joined(outputs: Intervals, driven: Intervals) -> Intervals:
    return Intervals(
        np.concatenate([outputs.low, driven.low]), np.concatenate([outputs.high, driven.high])
    )


# ── tubes ────────────────────────────────────────────────────────────────────────────


@dataclass(frozen=True)
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

    def bounds(self, output: str, begin: float, end: float) -> Interval:
        """Return between what an output (or a drive) is from one time to another.

        Parameters
        ----------
        output : str
            A port of the plant.
        begin, end : float
            s, both included. A time that is a whole number of control periods but for its rounding
            counts as that.

        Raises
        ------
        EnclosureError
            If parts of the starts were not followed so far.
        """
        if not self.complete:
            raise EnclosureError("the tube does not hold all starts")
        column = self.ports.index(output)
        return _between(self, column, begin, end)

    def holds(self, demand: Demand) -> bool:
        """Tell whether a demand is proved."""
        found = self.bounds(demand.port, demand.begin, demand.end)
        return demand.low <= found.low and found.high <= demand.high


def _between(course: Any, column: int, begin: float, end: float) -> Interval:
    """Return the hull of the stretches that a stretch of time meets."""
    slack = 1e-9 * course.problem.period
    if not 0.0 <= begin <= end <= course.duration + slack:
        raise EnclosureError(f"the tube is from 0 to {course.duration:g} s")
    some = (course.ends > begin + slack) & (course.begins < end - slack)
    times = np.concatenate([course.begins[:1], course.ends])
    at = (np.abs(times - begin) <= slack) | (np.abs(times - end) <= slack)
    if not (some.any() or at.any()):  # within one stretch
        some = (course.ends >= begin) & (course.begins <= end)
    low = np.concatenate([course.low[some, column], course.low_at[at, column]])
    high = np.concatenate([course.high[some, column], course.high_at[at, column]])
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
        s, after which no box is halved any more.
    most : int
        Boxes at most.
    progress : callable, optional
        Told of how far it is.

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
    return _Search(problem, duration, tuple(demands), budget, most, progress).tube(boxes)


class _Search:
    """Halves boxes until all demands are proved, or time is over."""

    def __init__(
        self, problem: LoopProblem, duration: float, demands: tuple[Demand, ...], budget: float,
        most: int, progress: Progress | None,
    ) -> None:  # fmt: skip
        self.begun = clock.monotonic()
        self.until = self.begun + budget
        self.follower = _Follower(problem, duration)
        self.demands = demands
        self.most = most
        self.progress = progress
        self.done = 0.0

    def tube(self, boxes: Sequence[int]) -> Tube:
        """Return the tube."""
        open_ = self._cut(boxes)
        finished: list[_Course] = []
        failed: list[_Box] = []
        lost: list[_Box] = []
        count = len(open_)
        while open_:
            batch, open_ = open_[:AT_ONCE], open_[AT_ONCE:]
            for group, course in self._followed(batch):
                undone = self._undone(course) if course is not None else np.ones(1, dtype=bool)
                may_halve = clock.monotonic() < self.until and count < self.most
                if course is not None:
                    kept = ~undone if may_halve and self.follower.names else np.ones_like(undone)
                    if kept.any():
                        finished.append(_part(course, kept))
                    failed += [box for box, bad in zip(group, undone & kept, strict=True) if bad]
                    self.done += sum(
                        box.share() for box, good in zip(group, kept, strict=True) if good
                    )
                else:
                    kept = np.zeros(1, dtype=bool)
                    if not (may_halve and self.follower.names):
                        lost += group
                        continue
                for index in np.flatnonzero(~kept):
                    weight = None if course is None else course.weight[:, index]
                    open_ += group[index].halves(self._dimension(group[index], weight))
                    count += 1
            if self.progress is not None:
                self.progress(self.done, len(open_))
        return self._answer(finished, failed, lost, count)

    def _cut(self, boxes: Sequence[int]) -> list[_Box]:
        found = [self.follower.first]
        for dimension, parts in enumerate(boxes):
            for _ in range(max(0, int(parts) - 1).bit_length()):
                found = [half for box in found for half in box.halves(dimension)]
        return found

    def _followed(self, boxes: Sequence[_Box]) -> list[tuple[list[_Box], _Course | None]]:
        """Return boxes with what came of them; None for a single one that cannot be followed."""
        try:
            return [(list(boxes), self.follower.follow(boxes))]
        except EnclosureError:
            if len(boxes) == 1:
                return [(list(boxes), None)]
            middle = len(boxes) // 2
            return self._followed(boxes[:middle]) + self._followed(boxes[middle:])

    def _undone(self, course: _Course) -> NDArray[np.bool_]:
        """Tell the boxes of which a demand is not proved."""
        undone = np.zeros(course.between.shape[2], dtype=bool)
        for demand in self.demands:
            column = self.follower.labels.index(demand.port)
            for index in range(len(undone)):
                found = _between(self._plain(course, index), column, demand.begin, demand.end)
                undone[index] |= not (demand.low <= found.low and found.high <= demand.high)
        return undone

    def _plain(self, course: _Course, index: int) -> Any:
        period = self.follower.period
        return _Stretches(
            self.follower.problem,
            self.follower.periods * period,
            course.begins * period,
            course.ends * period,
            course.between.low[:, :, index],
            course.between.high[:, :, index],
            course.at.low[:, :, index],
            course.at.high[:, :, index],
        )

    def _dimension(self, box: _Box, weight: Vector | None) -> int:
        """Return the dimension to halve: the one that widens the tube most, for its halvings."""
        own = np.ones(len(box.low)) if weight is None else weight + 0.05
        return int(np.argmax(own * 0.5 ** np.array(box.halvings)))

    def _answer(
        self, finished: Sequence[_Course], failed: Sequence[_Box], lost: Sequence[_Box], count: int
    ) -> Tube:
        follower = self.follower
        period, names = follower.period, follower.names
        # Boxes may have taken steps of other lengths: what is common to all are the periods.
        stretches = [_by_period(course, follower.periods) for course in finished]
        times = np.arange(follower.periods + 1) * period
        begins, ends = times[:-1], times[1:]
        low, high, low_at, high_at = (
            reduce(choose, arrays)
            for choose, arrays in zip(
                (np.minimum, np.maximum, np.minimum, np.maximum),
                zip(*stretches, strict=True) if stretches else [[np.zeros((0, 0))]] * 4,
                strict=True,
            )
        )
        open_ = tuple(
            {name: Interval(a, b) for name, a, b in zip(names, box.low, box.high, strict=True)}
            for box in (*failed, *lost)
        )
        return Tube(
            follower.problem, follower.periods * period, tuple(follower.labels),
            begins, ends, low, high, low_at, high_at,
            count, open_, not lost and bool(finished), clock.monotonic() - self.begun,
        )  # fmt: skip


class _Stretches(NamedTuple):
    """What :func:`_between` reads, of one box."""

    problem: LoopProblem
    duration: float
    begins: Vector
    ends: Vector
    low: Vector
    high: Vector
    low_at: Vector
    high_at: Vector


def _by_period(course: _Course, periods: int) -> tuple[Vector, Vector, Vector, Vector]:
    """Return the hull of all boxes: low and high in each period, and at its ends."""
    own = np.minimum(course.begins.astype(int), periods - 1)
    first = np.searchsorted(own, np.arange(periods))
    last = np.concatenate([[0], np.searchsorted(own, np.arange(periods), side="right")])
    return (
        np.minimum.reduceat(course.between.low.min(axis=2), first, axis=0),
        np.maximum.reduceat(course.between.high.max(axis=2), first, axis=0),
        course.at.low.min(axis=2)[last],
        course.at.high.max(axis=2)[last],
    )


def _part(course: _Course, which: NDArray[np.bool_]) -> _Course:
    return course._replace(
        between=course.between[:, :, which],
        at=course.at[:, :, which],
        weight=course.weight[:, which],
    )
