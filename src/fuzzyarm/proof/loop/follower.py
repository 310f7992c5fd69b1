r"""Reachable sets of boxes of starts, period by period.

All starts of a box, all parameters in their intervals and all errors of sensors are one zonotope
(:mod:`fuzzyarm.proof.loop.zonotope`), which passes the loop in its order: sensors, controller,
limits, then the plant with its inputs held (:mod:`fuzzyarm.proof.loop.flow`). The controller's
memory is part of the zonotope.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.numbers import decimal
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.plant.plant import Address
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError, LostRunError
from fuzzyarm.proof.claim.text import error_label
from fuzzyarm.proof.loop.algebra import Number, Zonotopes
from fuzzyarm.proof.loop.enclosure import EnclosureError, Intervals, Vector, outward
from fuzzyarm.proof.loop.flow import Flow, Step
from fuzzyarm.proof.loop.linear_flow import linear_flow
from fuzzyarm.proof.loop.moving import reference_between, sampled_references
from fuzzyarm.proof.loop.period import LoopPeriod
from fuzzyarm.proof.loop.planes import RulePlanes
from fuzzyarm.proof.loop.readings import may_jump, read, readable, takes_condition
from fuzzyarm.proof.loop.zonotope import Forms, stacked
from fuzzyarm.proof.stop import Stop
from fuzzyarm.symbolic.evaluation import gradient, specialise
from fuzzyarm.symbolic.nodes import Constant, Node, replace, symbols
from fuzzyarm.symbolic.operations import Interval

ORDER, LEAST_ORDER = 6, 2
"""Highest and lowest order of the Taylor polynomials in time."""

MOST_SYMBOLS = 40
"""Symbols per state, besides those of the first box and of the parameters."""

MOST_PARTS, CORNER_PARTS = 16, 8
"""Most steps of one control period; of one with a corner, in steps of first order."""

LARGE, SMALL = 1e-3, 1e-5
"""Remainder of a series relative to the radius: the largest, and one at which effort is reduced."""

FLOOR = 1e-5
"""Least radius in that ratio, relative to the largest magnitude of a state so far."""

SAME_TIME = 1e-9
"""Tolerance of equal times, in control periods: multiples of a period are rounded."""


class Demand(NamedTuple):
    """Bounds of an output (or a drive) from one time to another, s."""

    port: str
    low: float
    high: float
    begin: float
    end: float


Goal = Callable[[int, Forms, Mapping[str, Number]], NDArray[np.int64]]
"""From periods so far, states and memory: boxes that have arrived (1), are on their way (0), or are
stalled (-1) and better halved."""


class Box(NamedTuple):
    """A part of the first box: its wide dimensions, and the halvings of each."""

    low: tuple[float, ...]
    high: tuple[float, ...]
    halvings: tuple[int, ...]

    def share(self) -> float:
        """Return its share of the first box."""
        return float(0.5 ** sum(self.halvings))

    def halves(self, dimension: int) -> tuple[Box, Box]:
        """Return both halves along a dimension."""
        middle = 0.5 * self.low[dimension] + 0.5 * self.high[dimension]
        cut = list(self.halvings)
        cut[dimension] += 1
        high, low = list(self.high), list(self.low)
        high[dimension] = low[dimension] = middle
        return (
            Box(self.low, tuple(high), tuple(cut)),
            Box(tuple(low), self.high, tuple(cut)),
        )


class Nearness(NamedTuple):
    """Distances of boxes from the goal."""

    # A proved upper bound of V: at most 1 is at the goal; NaN if arrival is impossible; shape
    # (boxes,)
    value: Vector
    # Contribution of each dimension of the box to the width, in units of the goal; a hint; shape
    # (dimensions, boxes)
    starts: Vector
    rest: Vector  # contribution of everything else; shape (boxes,)


class FollowedBoxes(NamedTuple):
    """Results of boxes followed side by side; times in control periods."""

    begins: Vector  # begins, ends: of the steps; shape (steps,)
    ends: Vector
    between: Intervals  # ranges of the ports during each step; shape (steps, ports, boxes)
    # The ports at the beginning and at the end of each step; shape (steps + 1, ports, boxes)
    at: Intervals
    # Largest contribution of each dimension of the first box to the width; shape (dimensions,
    # boxes)
    weight: Vector
    # Boxes with an unproved demand, or not arrived at a goal; shape (boxes,)
    undone: NDArray[np.bool_]

    def part(self, which: NDArray[np.bool_]) -> FollowedBoxes:
        """Return the results of selected boxes."""
        return self._replace(
            between=self.between[:, :, which],
            at=self.at[:, :, which],
            weight=self.weight[:, which],
            undone=self.undone[which],
        )

    def by_period(self, periods: int, most: int) -> tuple[Vector, Vector, Vector, Vector]:
        """Return the hull of all boxes: low and high in each period, low and high at its ends.

        `periods`: their number, of which the first `most` are returned.
        """
        period_of_step = np.minimum(self.begins.astype(int), periods - 1)
        first = np.searchsorted(period_of_step, np.arange(periods))
        last = np.concatenate(
            [[0], np.searchsorted(period_of_step, np.arange(periods), side="right")]
        )
        return (
            np.minimum.reduceat(self.between.low.min(axis=2), first, axis=0)[:most],
            np.maximum.reduceat(self.between.high.max(axis=2), first, axis=0)[:most],
            self.at.low.min(axis=2)[last][: most + 1],
            self.at.high.max(axis=2)[last][: most + 1],
        )


class Follower:
    """Reachable sets of the boxes of one problem.

    Parameters
    ----------
    problem : LoopProblem
        The loop and its starts.
    duration : float
        s; rounded up to whole control periods.
    demands : sequence of Demand, optional
        Bounds to prove.
    stop : Stop, optional
        The time budget.
    goal : callable, optional
        The destination of boxes. Demands apply to a box until arrival; boxes are followed until all
        have arrived.

    Attributes
    ----------
    periods : int
        Number of control periods.
    first : Box
        All starts and parameters.
    names : list of str
        Names of its dimensions.
    labels : list of str
        Names of the ports: outputs, then inputs.
    reached : int
        The last control period followed.
    last_weight : ndarray, shape (dimensions, boxes)
        The weight as in :class:`FollowedBoxes`, including boxes not followed to the end.
    """

    def __init__(
        self,
        problem: LoopProblem,
        duration: float,
        demands: Sequence[Demand] = (),
        stop: Stop | None = None,
        goal: Goal | None = None,
    ) -> None:
        self.problem = problem
        self.stop = stop or Stop()
        self.goal = goal
        equations = problem.equations
        self.period = problem.period
        self.periods = max(1, math.ceil(decimal(duration) / decimal(self.period)))
        points: dict[str, tuple[str, Interval]] = {}
        moving: dict[str, tuple[str, Interval]] = {}
        for symbol, (name, value) in zip(
            equations.parameters, problem.parameters.items(), strict=True
        ):
            (points if value.low == value.high else moving)[symbol] = (name, value)
        numbers = {symbol: value.low for symbol, (_, value) in points.items()}
        self.parameters = list(moving)
        rates = [replace(root, numbers) for root in equations.rates]
        if any(map(takes_condition, (*rates, *equations.outputs))):
            raise LoopProofError(
                f"the equations of {problem.plant.name} take a condition for a number",
                hint="op.where(condition, 1, 0) is one",
            )
        self.flow = linear_flow(rates, equations.inputs) or Flow(rates)
        self.outputs = [readable(replace(root, numbers)) for root in equations.outputs]
        self.weights = [_affine_weights(root, self.flow.states) for root in self.outputs]
        self.inputs = equations.inputs
        starts = [problem.start[name] for name in problem.states]
        self.start = starts
        # The dimensions of the first box: states and parameters with a width.
        self.wide = [i for i, start in enumerate(starts) if start.low < start.high]
        intervals = [starts[i] for i in self.wide] + [value for _, value in moving.values()]
        self.names = [problem.states[i] for i in self.wide] + [name for name, _ in moving.values()]
        self.first = Box(
            tuple(interval.low for interval in intervals),
            tuple(interval.high for interval in intervals),
            (0,) * len(intervals),
        )
        interface = problem.site.interface
        self.ports = [*interface.outputs, *interface.inputs]
        self.labels = [interface.label(port) for port in interface.outputs]
        for label in map(interface.label, interface.inputs):  # an input may have an output's name
            self.labels.append(f"driven {label}" if label in self.labels else label)
        self.labels += [error_label(interface.label(port)) for port in problem.errors]
        self.limits = np.array([port.bound for port in interface.outputs.values()])
        self.lost_beyond = np.array([*map(problem.lost_beyond, interface.outputs)])
        self.demands = [
            (each, self.labels.index(each.port), self._edge(each.begin), self._edge(each.end))
            for each in demands
        ]
        self.reached = 0
        self._planes: dict[tuple[int, str], RulePlanes] = {}

    def planes(self, rulebase: RuleBase, output: str) -> RulePlanes:
        """Return the planes of a rule base, cut once."""
        key = id(rulebase), output
        if key not in self._planes:
            self._planes[key] = RulePlanes(rulebase, output)
        return self._planes[key]

    # --- one batch ---

    def follow(self, boxes: Sequence[Box], *, whole: bool = True) -> FollowedBoxes:
        """Follow boxes side by side; EnclosureError if one of them has no enclosure.

        Without `whole`, it ends as soon as every box violates a demand.
        """
        with np.errstate(all="ignore"):  # non-finite boxes are rejected in each period
            return self._follow(boxes, whole=whole)

    def _follow(self, boxes: Sequence[Box], *, whole: bool) -> FollowedBoxes:
        batch, count = len(boxes), len(self.first.low)
        algebra = Zonotopes(batch, self.planes)
        control = LoopPeriod[Number](self.problem, algebra)
        states, constants = self.start_forms(boxes)
        memory: dict[str, Number] = dict.fromkeys(control.memory, 0.0)
        for name, value in control.memory.items():
            memory[name] = 0.0 if math.isnan(value) else value
        parts = 1
        begins: list[float] = []
        ends: list[float] = []
        between: list[Intervals] = []
        at: list[Intervals] = []
        weight = self.last_weight = np.zeros((count, batch))
        undone = np.zeros(batch, dtype=bool)
        arrived = np.zeros(batch, dtype=bool)
        self.sizes, self.order = states.bounds.size.max(axis=1), ORDER
        first = self.outputs_at(states, constants, 0.0)
        for period in range(self.periods):
            self.reached = period
            states, drives, memory = self.controlled(control, states, constants, memory, period)
            time = period * self.period
            states, steps, parts = self.moved(states, {**constants, **drives}, time, parts)
            intervals = self._driven(drives)
            if not at:
                at.append(self._with_errors(_joined(first, intervals), 0, 0))
            for index, outputs in enumerate(steps):
                begins.append(period + index / len(steps))
                ends.append(period + (index + 1) / len(steps))
                last = period + 1 if index + 1 == len(steps) else period
                for ranges, values, begin in zip(
                    (between, at), outputs, (period, last), strict=True
                ):
                    joined = _joined(values, intervals)
                    ranges.append(self._with_errors(joined, begin, period + 1))
                undone |= self._violated(begins[-1], ends[-1], between[-1], at[-2:]) & ~arrived
            if self.goal is not None:
                signs = self.goal(period + 1, states, memory)
                arrived |= signs > 0
                undone |= (signs < 0) & ~arrived
            weight = self.last_weight = np.maximum(weight, self._weight(states, count))
            if undone.all() and not whole:
                break
            if arrived.all():
                break
            self._demand_bounded(at[-1])
            if self.stop.now:
                raise EnclosureError("time is over")
            states, memory = self._fewer(states, memory, count, algebra)
        return FollowedBoxes(
            np.array(begins),
            np.array(ends),
            Intervals(np.stack([x.low for x in between]), np.stack([x.high for x in between])),
            Intervals(np.stack([x.low for x in at]), np.stack([x.high for x in at])),
            weight,
            undone if self.goal is None else undone | ~arrived,
        )

    def controlled(
        self,
        control: LoopPeriod[Number],
        states: Forms,
        constants: Mapping[str, Forms],
        memory: Mapping[str, Number],
        period: int,
    ) -> tuple[Forms, dict[str, Forms], dict[str, Number]]:
        """Return states, inputs of the plant over the same symbols, and memory."""
        algebra = cast(Zonotopes, control.algebra)
        algebra.count = len(states.parts)
        measurements = self._readings(states, constants, period * self.period)
        moved = self._moved_references(period, states.shape[1])
        inputs, after = control.run(measurements, memory, first=period == 0, moved=moved)
        drives = {
            name: algebra.forms(inputs[port])
            for name, port in zip(self.inputs, self.problem.site.interface.inputs, strict=True)
        }
        # The period may add symbols, as for the band around a plane.
        return states.with_symbols(max(algebra.count, len(states.parts))), drives, after

    def _moved_references(self, period: int, batch: int) -> dict[Address, Number]:
        """Return the moving references in a period."""
        return {
            address: Forms.between(np.full(batch, x.low), np.full(batch, x.high))
            for address, x in sampled_references(self.problem, period).items()
        }

    def _with_errors(self, values: Intervals, begin: int, end: int) -> Intervals:
        """Return ports with errors appended, with the references between two samples.

        A reference that is held since before counts as well: `simulate` has the errors from it.
        """
        problem = self.problem
        held = sampled_references(problem, begin) if problem.held_since(begin) < begin else {}
        for address in problem.errors:
            times = problem.time_of(begin), problem.time_of(end)
            reference = reference_between(problem, address, *times)
            reference = reference.hull(held.get(address, reference))
            row = self.ports.index(address)
            values = _joined(values, reference - values[row : row + 1])
        return values

    def _driven(self, inputs: Mapping[str, Forms]) -> Intervals:
        """Return the ranges of the inputs, within the limits of their actuators."""
        bounds = stacked([inputs[name] for name in self.inputs]).bounds
        ports = self.problem.site.interface.inputs.values()
        low = np.array([port.low for port in ports])[:, None]
        high = np.array([port.high for port in ports])[:, None]
        return Intervals(np.clip(bounds.low, low, high), np.clip(bounds.high, low, high))

    def _edge(self, time: float) -> tuple[float, float]:
        """Return an end of a demand in control periods, and the overlap that makes a step count.

        At a sample the inputs jump, and a step that only touches it does not count; at any other
        time it does.
        """
        periods = decimal(time) / decimal(self.period)
        return float(periods), SAME_TIME if periods.denominator == 1 else -SAME_TIME

    def _violated(
        self, begin: float, end: float, between: Intervals, ends: Sequence[Intervals]
    ) -> NDArray[np.bool_]:
        """Return the boxes that violate a demand in a step; times in control periods."""
        undone = np.zeros(between.shape[1], dtype=bool)
        for demand, port, (first, opens), (last, closes) in self.demands:
            ranges = []
            if end > first + opens and begin < last - closes:
                ranges.append(between[port])
            for time, at in zip((begin, end), ends, strict=True):
                if min(abs(time - first), abs(time - last)) <= SAME_TIME:
                    ranges.append(at[port])
            for intervals in ranges:
                undone |= ~(
                    (intervals.low >= demand.low) & (intervals.high <= demand.high)
                )  # NaN, too
        return undone

    def is_lost(self, at: Intervals) -> NDArray[np.bool_]:
        """Return whether all runs of a box have diverged by the plant's criterion, by output."""
        count, limits = len(self.limits), self.lost_beyond[:, None]
        return np.asarray((at.low[:count] > limits) | (at.high[:count] < -limits))

    def _demand_bounded(self, at: Intervals) -> None:
        """Raise if a run may have diverged by the plant's own criterion."""
        count, limits = len(self.limits), self.limits[:, None]
        lost = self.is_lost(at).any(axis=1)
        if lost.any():
            name = self.labels[int(lost.argmax())]
            where = f"beyond the bound of '{name}', {self.lost_beyond[lost.argmax()]:g}"
            raise LostRunError(where)
        over = ~(at.size[:count] <= limits).all(axis=1)
        if over.any():
            name = self.labels[int(over.argmax())]
            raise EnclosureError(f"'{name}' may leave its bound")

    def start_forms(self, boxes: Sequence[Box]) -> tuple[Forms, dict[str, Forms]]:
        """Return states and parameters, with a symbol for each width."""
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
    def _dimension(boxes: Sequence[Box], index: int, count: int) -> Forms:
        low, high = [box.low[index] for box in boxes], [box.high[index] for box in boxes]
        return Forms.between(low, high).with_symbols(count, [index])

    def _readings(
        self, states: Forms, constants: Mapping[str, Forms], time: float
    ) -> dict[Address, Number]:
        batch = states.shape[1]
        values = {**constants, **{f"x{i}": states[i] for i in range(states.shape[0])}}
        values["t"] = Forms.at(np.full(batch, time))
        readings = read(self.outputs, values)
        return dict(zip(self.problem.site.interface.outputs, readings, strict=True))

    def outputs_at(self, states: Forms, constants: Mapping[str, Forms], time: float) -> Intervals:
        """Return the ranges of the outputs."""
        outputs = self._readings(states, constants, time)
        return stacked([forms for forms in outputs.values() if isinstance(forms, Forms)]).bounds

    def _outputs_between(
        self, ends: tuple[Intervals, Intervals], step: Step, constants: Mapping[str, Forms],
        begin: float, end: float,
    ) -> Intervals:  # fmt: skip
        """Return the ranges of the outputs during a step."""
        box, batch = step.between, step.between.shape[1]
        values = {**constants, **{f"x{i}": Forms.of(box[i]) for i in range(box.shape[0])}}
        values["t"] = Forms.between(np.full(batch, begin), np.full(batch, end))
        over = stacked(read(self.outputs, values)).bounds
        if step.bend is None:
            return over
        # A linear output is as close to its chord as the states to theirs.
        line = ends[0].hull(ends[1])
        low, high = over.low.copy(), over.high.copy()
        for row, weights in enumerate(self.weights):
            if weights is not None:
                value = line[row]
                for i, weight in enumerate(weights):
                    if weight:
                        value = value + step.bend[i] * outward(weight, weight)
                low[row], high[row] = (
                    np.maximum(low[row], value.low),
                    np.minimum(high[row], value.high),
                )
        return Intervals(low, high)

    def moved(
        self, states: Forms, constants: Mapping[str, Forms], time: float, parts: int
    ) -> tuple[Forms, list[tuple[Intervals, Intervals]], int]:
        """Return states one period later, outputs in its steps, and the next number of steps."""
        parameters = {name: constants[name] for name in self.parameters}
        while True:
            try:
                state, steps, remainder = states, [], 0.0
                before = self.outputs_at(states, parameters, time)
                length = self.period / parts  # a power of two: exact
                for index in range(parts):
                    begin = time + index * length
                    step = self._step(state, constants, begin, length)
                    after = self.outputs_at(step.end, parameters, begin + length)
                    over = self._outputs_between(
                        (before, after), step, parameters, begin, begin + length
                    )
                    steps.append((over, after))
                    before = after
                    sizes = np.maximum(self.sizes, step.between.size.max(axis=1))
                    radius = np.maximum(step.end.radius, FLOOR * sizes[:, None])
                    remainder = max(remainder, float((step.remainder / radius).max()))
                    if remainder > LARGE and parts < self._most(step):
                        break
                    state = _with_own_symbols(step.end)
                # A too large remainder raises the order first, then shortens the steps; a far
                # smaller one takes both back, one at a time.
                if remainder > LARGE and self.order < ORDER:
                    self.order = ORDER
                    continue
                if remainder > LARGE and parts < self._most(step):
                    parts *= 2
                    continue
                self.sizes = np.maximum(self.sizes, sizes)
                if remainder < SMALL and parts > 1:
                    parts //= 2
                elif remainder < SMALL and self.order > LEAST_ORDER:
                    self.order -= 1
                return state, steps, parts
            except EnclosureError:
                if parts >= MOST_PARTS:
                    raise
                parts *= 2

    def _step(
        self, state: Forms, constants: Mapping[str, Forms], begin: float, length: float
    ) -> Step:
        """Return one step of the flow; a period may have many, so that each checks the time."""
        if self.stop.now:
            raise EnclosureError("time is over")
        return self.flow.step(state, constants, begin, length, self.order)

    @staticmethod
    def _most(step: Step) -> int:
        """Return the number of steps of a period for a small remainder."""
        return MOST_PARTS if step.bend is not None else CORNER_PARTS

    @staticmethod
    def _weight(states: Forms, count: int) -> Vector:
        radius = np.maximum(states.radius, 1e-300)
        return np.asarray((np.abs(states.parts[:count]) / radius).max(axis=1))

    @staticmethod
    def _fewer(
        states: Forms,
        memory: Mapping[str, Number],
        columns: int,
        algebra: Zonotopes,
        most: int = MOST_SYMBOLS,
    ) -> tuple[Forms, dict[str, Number]]:
        """Return states and memory over fewer symbols."""
        names = [name for name, value in memory.items() if isinstance(value, Forms)]
        joint = stacked([states[i] for i in range(states.shape[0])] + [
            algebra.forms(memory[name]) for name in names
        ])  # fmt: skip
        count = len(joint.parts)
        # Remainders become symbols, so that their effects on several states in the next period stay
        # together.
        if joint.rest.any():
            joint = joint.with_symbols(count + joint.shape[0], range(count, count + joint.shape[0]))
        joint = joint.reduced(columns, columns + most * joint.shape[0])
        size = states.shape[0]
        remembered: dict[str, Number] = dict(memory)
        remembered |= {name: joint[size + i] for i, name in enumerate(names)}
        if not np.isfinite(joint.radius).all():
            raise EnclosureError("the tube has no bound")
        return joint[:size], remembered


def _with_own_symbols(forms: Forms) -> Forms:
    """Return forms with remainders as symbols, one for each along the first axis."""
    if not forms.rest.any():
        return forms
    count, rows = len(forms.parts), forms.shape[0]
    return forms.with_symbols(count + rows, range(count, count + rows))


def _affine_weights(root: Node, states: Sequence[str]) -> list[float] | None:
    """Return the slopes of an expression by the states; None unless constant."""
    slopes = [specialise(node, {}) for node in gradient(root, tuple(states))]
    if may_jump(root):
        return None
    if not all(isinstance(slope, Constant) for slope in slopes) or "t" in symbols(root):
        return None
    return [slope.value for slope in slopes if isinstance(slope, Constant)]


def _joined(outputs: Intervals, driven: Intervals) -> Intervals:
    return Intervals(
        np.concatenate([outputs.low, driven.low]), np.concatenate([outputs.high, driven.high])
    )
