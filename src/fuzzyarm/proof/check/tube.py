"""Reachable tubes of boxes of starts, sample by sample: sets that contain all runs.

A set is a zonotope: affine forms of the plant's states and of the controller's memory, over the
same symbols (:mod:`.forms`); thousands are followed side by side. The controller's program is
walked with such forms. The motion of an affine plant over a period is its matrix exponential;
that of others is a second-order series with a bounded remainder from the centre of the set, and
slopes over an a-priori enclosure (mean value theorem). If symbols become many, the smallest are
turned into the sides of a box.

Sources: R. E. Moore, R. B. Kearfott and M. J. Cloud, *Introduction to Interval Analysis*, SIAM
2009; A. Girard, "Reachability of uncertain linear systems using zonotopes", *Hybrid Systems:
Computation and Control*, 2005.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.proof.check.certificate import Pair, RegionProof
from fuzzyarm.proof.check.forms import ENLARGED, Form, FormNumbers, combined
from fuzzyarm.proof.check.loop import CheckedLoop
from fuzzyarm.proof.check.motion import (
    around_motion,
    end_of_motion,
    flow_over,
    is_affine,
    jacobian_of,
    parameters_of,
)
from fuzzyarm.proof.check.numbers import (
    ONE,
    ZERO,
    Matrix,
    Number,
    exact,
    is_positive_definite,
    precisely,
    product,
)
from fuzzyarm.proof.check.references import reference_between, sampled_references
from fuzzyarm.proof.check.rules import RuleSurfaces
from fuzzyarm.proof.check.slopes import Slope, slopes_of
from fuzzyarm.proof.check.spans import Spans, Vector
from fuzzyarm.proof.check.walk import ProgramWalk
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.claim.text import claimed_in, claimed_port, error_label
from fuzzyarm.proof.stop import check_time
from fuzzyarm.symbolic.nodes import symbols

MOST_SYMBOLS = 14
"""Most symbols per state before a set is reduced."""

AT_ONCE = 4096
"""Sets followed side by side."""

Flags = NDArray[np.bool_]
Index = NDArray[np.int64]
Box = Sequence[Pair]


class Haven(NamedTuple):
    """A proved region as destination."""

    loop: CheckedLoop
    proof: RegionProof


class Task(NamedTuple):
    """Conditions on the runs from boxes."""

    claim: LoopClaim | None = None  # bounds of an output on the way
    # Numbers of the destination regions; none: runs are followed to their last period
    into: tuple[int, ...] = ()
    # Lower and upper ends of boxes that count as arrival, shape (boxes, states); a set may use
    # those before its own. Only for a loop without memory.
    boxes: tuple[Vector, Vector] | None = None
    # Whether a number of periods and a bound of V are enough for the claim
    arrived: Callable[[int, float], bool] | None = None
    # Whether arrival in the boxes may be after any period; else in the last one only
    any_period: bool = False


class Followed(NamedTuple):
    """Result of a box: the periods until arrival, or the reason of failure."""

    periods: int
    against: str = ""


class _Group(NamedTuple):
    """Sets on their way: their indices, their states and memory, the periods so far."""

    which: Index
    now: list[Form]
    period: int


class Follower:
    """The tubes of a loop.

    Parameters
    ----------
    problem : LoopProblem
        The loop.
    havens : sequence of Haven
        Destination regions.
    surfaces : RuleSurfaces, optional
        Of its rule bases, to share cuts.

    Attributes
    ----------
    memory : list of str
        Symbols of the memory.
    """

    @precisely
    def __init__(
        self, problem: LoopProblem, havens: Sequence[Haven] = (),
        surfaces: RuleSurfaces | None = None,
    ) -> None:  # fmt: skip
        self.problem, self.havens = problem, havens
        self.walk = ProgramWalk(problem)
        self.numbers = FormNumbers(surfaces or RuleSurfaces())
        equations = problem.equations
        if any("t" in symbols(root) for root in (*equations.rates, *equations.outputs)):
            raise LoopProofError("the plant's equations depend on the time")
        self.parameters = parameters_of(problem)
        self._fixed = {key: Slope(x, {}) for key, x in self.parameters.items()}
        self.memory = list(self.walk.states)
        self._goals = list(map(self._goal, havens))

    @cached_property
    def _flow(self) -> tuple[Matrix, Matrix] | None:
        """For an affine plant: its matrix over a period, and Σ hᵏ⁺¹ Jᵏ/(k+1)!; else None."""
        equations = self.problem.equations
        rest = dict.fromkeys((*equations.states, *equations.inputs), ZERO)
        try:
            jacobian = jacobian_of(self.problem, self.parameters | rest)
        except LoopProofError:  # no slopes there
            return None
        if not is_affine(self.problem, jacobian):
            return None
        count, h = len(equations.states), exact(self.problem.period)
        flow = flow_over(jacobian, h)
        # The same with the rates as held inputs: x' = J x + r.
        units = [[*row[:count], *(fmpq(int(i == j)) for j in range(count))]
                 for i, row in enumerate(jacobian)]  # fmt: skip
        return flow, [row[count:] for row in flow_over(units, h)]

    # --- one period ---

    def _controlled(
        self, states: Sequence[Form], memory: Sequence[Form], period: int = 0
    ) -> tuple[list[Form], list[Form]]:
        """Return the inputs of the plant, and the new memory."""
        interface = self.problem.site.interface
        outputs = self._outputs(states)
        self.numbers.lost = np.zeros(self.numbers.sets, dtype=bool)
        inputs, after = self.walk.period(
            self.numbers,
            dict(zip(interface.outputs, outputs, strict=True)),
            dict(zip(self.memory, memory, strict=True)),
            first=period == 0,
            moved={
                address: self.numbers.of(x)
                for address, x in sampled_references(self.problem, period).items()
            },
        )
        drives = [self.numbers.with_rest_symbol(inputs[address]) for address in interface.inputs]
        return drives, [after[name] for name in self.memory]

    def _bounded(self, states: Sequence[Form]) -> Flags:
        """Return which sets are finite and within the bounds of all ports."""
        ports = self.problem.site.interface.outputs.values()
        bounded = np.ones(self.numbers.sets, dtype=bool)
        for output, port in zip(self._outputs(states), ports, strict=True):
            bounded &= output.size <= port.bound
            bounded &= np.isfinite(output.size)
        return bounded

    def _outputs(self, states: Sequence[Form]) -> list[Form]:
        """Return the outputs of the plant, by their slopes over a set of states."""
        equations = self.problem.equations
        by_name = dict(zip(equations.states, states, strict=True))
        outputs = []
        for root in equations.outputs:
            if getattr(root, "name", "") in by_name:
                outputs.append(by_name[getattr(root, "name", "")])
                continue
            over, at = (
                slopes_of([root], self._fixed | {
                    key: Slope(x.span if wide else _point(x), {key: ONE} if wide else {})
                    for key, x in by_name.items()
                })[0]
                for wide in (True, False)
            )  # fmt: skip
            row = [over.along.get(key, ZERO) for key in equations.states]
            outputs.append(self.numbers.with_rest_symbol(self._moved([row], states, [at.value])[0]))
        return outputs

    def _moved(self, matrix: Matrix, forms: Sequence[Form], ends: Sequence[Number]) -> list[Form]:
        """Return ends plus slopes times deviations."""
        away = [Form(np.zeros_like(form.centre), form.weights, form.rest) for form in forms]
        return [
            combined(*zip(away, map(Spans.of, row), strict=True), (self.numbers.of(end), 1.0))
            for row, end in zip(matrix, ends, strict=True)
        ]

    def _period(
        self, now: Sequence[Form], period: int, port: str = ""
    ) -> tuple[list[Form], Spans | None]:
        """Return sets one period later, and the range of a port within it."""
        problem, count = self.problem, len(self.problem.states)
        states = list(now[:count])
        drives, after = self._controlled(states, now[count:], period)
        span = self._within(states, drives, port, period) if port else None
        x, u = [_point(s) for s in states], [_point(s) for s in drives]
        if self._flow is not None:
            flow, ends = self._flow[0], self._affine_end(x, u)
        else:
            moving = self._around([s.span for s in states], [s.span for s in drives])
            flow = flow_over(jacobian_of(problem, moving), exact(problem.period))
            ends = end_of_motion(problem, self._symbols(x, u))
        return [*self._moved(flow, [*states, *drives], ends), *after], span

    def _symbols(self, states: Sequence[Number], inputs: Sequence[Number]) -> dict[str, Number]:
        equations = self.problem.equations
        return {
            **self.parameters,
            **dict(zip(equations.states, states, strict=True)),
            **dict(zip(equations.inputs, inputs, strict=True)),
        }

    def _around(self, states: Sequence[Number], inputs: Sequence[Number]) -> dict[str, Number]:
        return around_motion(self.problem, self._symbols(states, inputs))

    def _affine_end(self, x: Sequence[Number], u: Sequence[Number]) -> list[Number]:
        """Return the state of an affine plant one period later, from one point."""
        assert self._flow is not None
        values = {k: Slope(value, {}) for k, value in self._symbols(x, u).items()}
        rates = [[rate.value] for rate in slopes_of(self.problem.equations.rates, values)]
        return [a + b[0] for a, b in zip(x, product(self._flow[1], rates), strict=True)]

    def _within(
        self, states: Sequence[Form], drives: Sequence[Form], port: str, period: int
    ) -> Spans:
        """Return the range of an output, its error or a drive between this sample and the next."""
        equations, interface = self.problem.equations, self.problem.site.interface
        for address, drive in zip(interface.inputs, drives, strict=True):
            if interface.label(address) == port:
                return drive.span.max(drive.ends[0]).min(drive.ends[1])
        for address in self.problem.errors:
            label = interface.label(address)
            if error_label(label) == port:
                reference = reference_between(self.problem, address, period)
                return Spans.of(reference) - self._within(states, drives, label, period)
        moving = self._around([s.span for s in states], [s.span for s in drives])
        index = [interface.label(address) for address in interface.outputs].index(port)
        values = {key: Slope(span, {}) for key, span in moving.items()}
        return Spans.of(slopes_of([equations.outputs[index]], values)[0].value)

    # --- boxes ---

    @precisely
    def follow(
        self, boxes: Sequence[Box], periods: Sequence[int], task: Task, numbers: Index | None = None
    ) -> list[Followed]:
        """Follow boxes of starts until all runs have arrived, each for at most its `periods`.

        Memory has its initial values. `numbers`: how many boxes of the task come before each box;
        all by default.
        """
        results = [Followed(0, "it was not followed")] * len(boxes)
        last = np.asarray(periods, dtype=np.int64)
        for begin in range(0, len(boxes), AT_ONCE):
            which = np.arange(begin, min(begin + AT_ONCE, len(boxes)))
            waiting = [_Group(which, self.start_forms(boxes[begin : begin + AT_ONCE]), 0)]
            while waiting:
                check_time()
                group = waiting.pop()
                self.numbers.sets = len(group.which)
                self.numbers.symbols = max(len(form.weights) for form in group.now)
                self.walk.at = ""
                try:
                    later = self._after_period(group, last, task, numbers, results)
                except (LoopProofError, ZeroDivisionError) as error:
                    if len(group.which) == 1:
                        of = f"'{self.walk.at}': " * bool(self.walk.at)
                        why = self.numbers.why if self.numbers.lost.any() else f"{of}{error}"
                        results[int(group.which[0])] = Followed(group.period, why)
                    else:  # one of them fails, or they take different branches
                        waiting += _halves(group)
                    continue
                if later is not None:
                    waiting.append(later)
        return results

    def _after_period(
        self, group: _Group, last: Index, task: Task, numbers: Index | None,
        results: list[Followed],
    ) -> _Group | None:  # fmt: skip
        """Return the sets of a group still on their way one period later; conclude the others."""
        which, now, k = group
        claim, port, counts = task.claim, "", False
        if claim is not None and claim.output:
            port = claimed_port(self.problem, claim)
            first, end = claimed_in(self.problem, claim)
            counts = k >= first and (end is None or k <= end)
        arrived = self._arrived(group, last, task, numbers)
        late = ~arrived & (last[which] <= k)
        for i in which[arrived]:
            results[int(i)] = Followed(k)
        for i in which[late]:
            results[int(i)] = Followed(k, f"it has not arrived after {k} periods")
        lost = ~(arrived | late | self._bounded(now[: len(self.problem.states)]))
        for i in which[lost]:
            results[int(i)] = Followed(k, "an output may be beyond its bound")
        which, now = _selected(which, now, ~(arrived | late | lost))
        if not len(which):
            return None
        self.numbers.sets = len(which)
        which, now, span = self._advanced(which, now, k, port if counts else "", results)
        if span is not None and claim is not None:
            holds = np.broadcast_to(
                (span.low >= claim.low) & (span.high <= claim.high), which.shape
            )
            for i in which[~holds]:
                results[int(i)] = Followed(k, f"in period {k + 1} the claim is not shown")
            which, now = _selected(which, now, holds)
            if k == end and not task.into:
                for i in which:
                    results[int(i)] = Followed(k + 1)
                return None
        return _Group(which, now, k + 1) if len(which) else None

    def _advanced(
        self, which: Index, now: Sequence[Form], k: int, port: str, results: list[Followed]
    ) -> tuple[Index, list[Form], Spans | None]:
        """Return bounded sets one period later with the range of a port; conclude the others."""
        after, span = self._period(now, k, port)
        lost = np.broadcast_to(self.numbers.lost, which.shape) | ~_finite(after)
        for i in which[lost]:
            results[int(i)] = Followed(k, self.numbers.why or "its sets have no bound")
        which, now = _selected(which, self.numbers.fewer(after, MOST_SYMBOLS), ~lost)
        return which, now, None if span is None else span[~lost]

    def _arrived(self, group: _Group, last: Index, task: Task, numbers: Index | None) -> Flags:
        """Return which sets have arrived: in a region, or in earlier boxes."""
        which, now, k = group
        arrived = np.zeros(len(which), dtype=bool)
        rests = self.problem.rests_from
        is_at_rest = rests is not None and rests <= k
        for number in task.into if is_at_rest and (k or not self.walk.begun) else ():
            level = self._level(number, now)
            inside = level <= 1.0
            if task.arrived is not None and inside.any():
                # `arrived` falls with the level: seek the largest level that is enough.
                levels = np.unique(level[inside])[::-1]
                enough = next((x for x in levels if task.arrived(k, float(x))), -1.0)
                inside &= level <= enough
            arrived |= inside
        # Only without memory is a run inside a box one that begins there.
        remembers = self.memory or self.problem.text.model.every > 1 or self.problem.moved
        if task.boxes is not None and k and not remembers:
            spans = [form.span for form in now]
            low, high = (np.stack(ends, axis=1) for ends in (
                [x.low for x in spans], [x.high for x in spans]))  # fmt: skip
            due = ~arrived & ((last[which] == k) | task.any_period)
            for i in np.flatnonzero(due):  # cheap test first: are its corners in some box?
                due[i] = all(_is_in(corner, *task.boxes) for corner in (low[i], high[i]))
            for i in np.flatnonzero(due & np.isfinite(low + high).all(axis=1)):
                count = None if numbers is None else int(numbers[which[i]])
                box = list(zip(low[i].tolist(), high[i].tolist(), strict=True))
                arrived[i] = covered(box, *(ends[:count] for ends in task.boxes))
        return arrived

    def start_forms(self, boxes: Sequence[Box]) -> list[Form]:
        """Return boxes of starts as forms, with the initial memory."""
        size = len(self.problem.states)
        if any(len(box) != size or any(low > high for low, high in box) for box in boxes):
            raise LoopProofError("it is not a box of the plant's states")
        self.numbers.sets, self.numbers.symbols = len(boxes), 0
        forms = []
        for k in range(size):
            ends = [Spans.of(exact(low)).union(exact(high))
                    for low, high in (box[k] for box in boxes)]  # fmt: skip
            side = Spans([x.low for x in ends], [x.high for x in ends])
            forms.append(self.numbers.with_rest_symbol(self.numbers.of(side)))
        return [*forms, *(self.numbers.number(self.walk.states[name]) for name in self.memory)]

    # --- regions ---

    def _goal(self, haven: Haven) -> tuple[list[int], list[int], Any, float]:
        """Return the coordinates of z, of memory that must not move, F and s: P < (1 + s) FᵀF."""
        order_of = {name: k for k, name in enumerate((*self.problem.states, *self.memory))}
        memory = haven.proof.evidence.memory
        order = [order_of[memory.get(name, name)] for name in haven.proof.states]
        plain = np.array([[float(x) for x in row] for row in haven.proof.p])
        scale = np.sqrt(np.diag(plain))  # units of states differ by orders of magnitude
        factor = np.linalg.cholesky(plain / scale[:, None] / scale[None, :]).T * scale[None, :]
        rows = [[exact(float(x)) for x in row] for row in factor]
        size = range(len(rows))
        square = [[sum((row[i] * row[j] for row in rows), ZERO) for j in size] for i in size]
        for slack in (2.0**-30, 2.0**-20, 2.0**-10):
            larger = [[square[i][j] * exact(1.0 + slack) - exact(haven.proof.p[i][j])
                       for j in size] for i in size]  # fmt: skip
            if is_positive_definite(larger):
                return order, [order_of[name] for name in haven.loop.still], factor, slack
        raise LoopProofError("the region is too flat for its factors as floats")

    def _level(self, number: int, now: Sequence[Form]) -> Vector:
        """Return an upper bound of V on each set; infinite if unknown."""
        (loop, proof), (order, still, factor, slack) = self.havens[number], self._goals[number]
        z = [
            combined((now[k], 1.0), (self.numbers.of(loop.rest[name]), -1.0))
            for k, name in zip(order, proof.states, strict=True)
        ]
        # V ≤ (1 + s) |F z|²: contributions of the same symbol cancel inside F z.
        entries = [combined(*zip(z, row, strict=True)).size for row in factor]
        level = sum(x * x for x in entries) * ENLARGED * (1.0 + slack) * ENLARGED
        for k in still:
            begun = self.walk.states[self.memory[k - len(self.problem.states)]]
            form = now[k]
            same = (form.centre == begun) & (form.reach == 0.0)
            level = np.where(same, level, np.inf)
        return np.where(np.isfinite(level), level, np.inf)


def _point(form: Form) -> Spans:
    return Spans(form.centre, form.centre)


def _is_in(point: Vector, lows: Vector, highs: Vector) -> bool:
    """Return whether a point is in one of some boxes."""
    return bool(((lows <= point) & (point <= highs)).all(axis=1).any())


def _finite(forms: Sequence[Form]) -> Flags:
    """Return which sets are finite."""
    return np.asarray(np.all([np.isfinite(form.size) for form in forms], axis=0))


def _selected(which: Index, now: Sequence[Form], stays: Flags) -> tuple[Index, list[Form]]:
    if stays.all():
        return which, list(now)
    return which[stays], [form.of(stays) for form in now]


def _halves(group: _Group) -> list[_Group]:
    middle = len(group.which) // 2
    return [
        _Group(group.which[part], [form.of(part) for form in group.now], group.period)
        for part in (slice(None, middle), slice(middle, None))
    ]


def covered(box: Sequence[tuple[Any, Any]], lows: Any, highs: Any) -> bool:
    """Return whether a box is inside a union of boxes: cut at their sides until each part is.

    Ends are floats or fractions.
    """
    waiting = [(box, lows, highs)]
    while waiting:  # no recursion: of thousands of boxes it may be deep
        check_time()
        part, lows, highs = waiting.pop()
        low, high = (np.array(ends) for ends in zip(*part, strict=True))
        near = ((lows <= high) & (highs >= low)).all(axis=1)
        if not near.any():
            return False
        lows, highs = lows[near], highs[near]
        # The box with the largest common part first.
        shares = np.minimum(highs, high) - np.maximum(lows, low)
        first = int(np.argmax((shares / np.maximum(high - low, 1e-300)).min(axis=1)))
        others = np.arange(len(lows)) != first
        ends = list(zip(lows[first].tolist(), highs[first].tolist(), strict=True))
        waiting += [(x, lows[others], highs[others]) for x in _parts_outside(part, ends)]
    return True


def _parts_outside(
    box: Sequence[tuple[Any, Any]], other: Sequence[tuple[Any, Any]]
) -> Iterator[list[tuple[Any, Any]]]:
    """Yield boxes that cover the part of a box outside another one."""
    rest = list(box)
    for k, (low, high) in enumerate(other):
        if not rest[k][0] >= low:
            yield [*rest[:k], (rest[k][0], low), *rest[k + 1 :]]
            rest[k] = (low, rest[k][1])
        if not rest[k][1] <= high:
            yield [*rest[:k], (high, rest[k][1]), *rest[k + 1 :]]
            rest[k] = (rest[k][0], high)
