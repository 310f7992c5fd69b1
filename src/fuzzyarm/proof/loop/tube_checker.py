r"""Certificates of tubes: sets, sample by sample, and whether each leads into the next one.

A set is ``{z: |W (z − c)| ≤ 1}``, z the states of the plant and what the controller remembers, W
and c rational. With T = W⁻¹ all of it is z = c + T e, |eᵢ| ≤ 1. Over one period the mean value
theorem gives

    z⁺ ∈ F(c) + G e,    G ⊇ F'(z) T for all z of the set,

and the set leads into the next one, W' and c', where row by row |W'(F(c) − c')| + Σ |W' G| ≤ 1.
F' is that of the program and of the plant's motion, in intervals of rationals
(:mod:`fuzzyarm.proof.loop.slopes`), F(c) steps of second order with a bounded remainder: nothing
of the zonotopes and bands by which tubes are found. Between samples the plant is in a box that no
motion leaves.

The starts are cut into boxes by halving: each has the path of its halvings, and all paths together
have to be all of them.

Source: R. E. Moore, R. B. Kearfott and M. J. Cloud, *Introduction to Interval Analysis*, SIAM 2009;
R. Lohner, "Enclosing the solutions of ordinary initial and boundary value problems",
*Computerarithmetic*, 1987 (sets that turn with the motion).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.claim.text import claimed_in
from fuzzyarm.proof.loop.checked_lines import PiecesOfRules
from fuzzyarm.proof.loop.checked_motion import around_motion, dot, flow_over
from fuzzyarm.proof.loop.program_walk import ProgramWalk
from fuzzyarm.proof.loop.slopes import Slope, SlopeNumbers, slopes_of
from fuzzyarm.proof.loop.spans import RationalInterval, exactly
from fuzzyarm.proof.stop import Stop, check_time
from fuzzyarm.symbolic.nodes import symbols

__all__ = [
    "BoxProof",
    "Period",
    "TubeLoop",
    "TubeSet",
    "leads_into",
    "start_of",
    "tube_refutation",
]

Row = tuple[Fraction, ...]
Matrix = tuple[Row, ...]

ZERO, ONE = exactly(Fraction(0)), exactly(Fraction(1))

POINT = Fraction(1, 1 << 48)
"""Half of the width that a state which begins at one number is given: sets have a volume."""

GRID = 1 << 44
"""Ends of boxes are rounded outward to parts of this: polynomials on them stay short."""

STEPS = 4
"""Steps of second order in a period, of what begins in the middle of a set."""


class TubeSet(NamedTuple):
    """``{z: |W (z − c)| ≤ 1}``: c, W."""

    centre: Row
    rows: Matrix


class BoxProof(NamedTuple):
    """A box of starts: its halvings (dimension, and whether the upper half), and its sets."""

    path: tuple[tuple[int, bool], ...]
    sets: tuple[TubeSet, ...]


class Period(NamedTuple):
    """What comes of a set in a period.

    Attributes
    ----------
    centre : list of RationalInterval
        F(c).
    spread : list of list of RationalInterval
        G.
    outputs : dict of str to RationalInterval
        Where outputs and drives are from this sample to the next.
    """

    centre: list[RationalInterval]
    spread: list[list[RationalInterval]]
    outputs: dict[str, RationalInterval]


class TubeLoop:
    """A loop, followed set by set.

    Parameters
    ----------
    problem : LoopProblem
        The loop and its starts.
    stop : Stop, optional
        When to give up: TimeOverError.

    Attributes
    ----------
    memory : list of str
        Symbols of what is remembered and read.
    """

    def __init__(self, problem: LoopProblem, stop: Stop | None = None) -> None:
        self.problem = problem
        self.walk = ProgramWalk(problem)
        self.numbers = SlopeNumbers(PiecesOfRules(stop))
        equations = problem.equations
        if any("t" in symbols(root) for root in (*equations.rates, *equations.outputs)):
            raise LoopProofError("the plant's equations depend on the time")
        self.parameters = {
            key: Slope(RationalInterval(Fraction(span.low), Fraction(span.high)), {})
            for key, span in zip(equations.parameters, problem.parameters.values(), strict=True)
        }
        start = {name: Slope(exactly(span.low), {}) for name, span in problem.start.items()}
        self.memory = list(self.walk.states)
        self._controlled(start, [self.numbers.number(x) for x in self.walk.states.values()])
        self.memory = [name for name in self.walk.states if name in self.walk.states_read]

    @property
    def size(self) -> int:
        """How many states and memories."""
        return len(self.problem.states) + len(self.memory)

    def period(self, tube: TubeSet, *, first: bool) -> Period:
        """Return what comes of a set in a period."""
        count = len(self.problem.states)
        # Points of the set are c + W⁻¹ e with |e| ≤ 1: e are the coordinates of all slopes below.
        turn = _inverse(tube.rows)
        names = [f"e{k}" for k in range(self.size)]
        whole = []
        for centre, row in zip(tube.centre, turn, strict=True):
            half = sum((abs(x) for x in row), Fraction(0))
            span = _rounded(RationalInterval(centre - half, centre + half))
            along = {name: exactly(x) for name, x in zip(names, row, strict=True) if x}
            whole.append(Slope(span, along))
        # The mean value theorem needs the period twice: F at the centre, its slopes over the set.
        at = [Slope(exactly(x), {}) for x in tube.centre]
        states = dict(zip(self.problem.states, whole[:count], strict=True))
        drives, after = self._controlled(states, whole[count:], first=first)
        # What a walk reads depends on the branches it takes, so both walks are asked.
        names_read = set(self.walk.states_read)
        middle = dict(zip(self.problem.states, at[:count], strict=True))
        centre_drives, memory_lines = self._controlled(middle, at[count:], first=first)
        if not (names_read | self.walk.states_read) <= set(self.memory):
            raise LoopProofError("the program reads a value that is not in the certificate")
        moving = self._around(states, drives)
        plant_spread = self._plant_spread(moving, [*whole[:count], *drives.values()], names)
        spread = [*plant_spread, *([line.along.get(n, ZERO) for n in names] for line in after)]
        ends = [*self._followed(middle, centre_drives), *(line.value for line in memory_lines)]
        return Period(ends, spread, self._outputs(moving, drives))

    def _controlled(
        self, states: Mapping[str, Slope], memory: Sequence[Slope], *, first: bool = True
    ) -> tuple[dict[str, Slope], list[Slope]]:
        """Return the inputs of the plant by symbol, and the memory afterwards."""
        equations, interface = self.problem.equations, self.problem.site.interface
        values = {k: states[n] for k, n in zip(equations.states, self.problem.states, strict=True)}
        outputs = slopes_of(equations.outputs, {**values, **self.parameters})
        inputs, after = self.walk.period(
            self.numbers,
            dict(zip(interface.outputs, outputs, strict=True)),
            dict(zip(self.memory, memory, strict=True)),
            first=first,
        )
        drives = {
            key: inputs[address]
            for key, address in zip(equations.inputs, interface.inputs, strict=True)
        }
        return drives, [after[name] for name in self.memory]

    def _around(
        self, states: Mapping[str, Slope], driven: Mapping[str, Slope]
    ) -> dict[str, RationalInterval]:
        """Return a box that the plant does not leave within the period, by symbol."""
        equations = self.problem.equations
        ranges = {key: value.value for key, value in self.parameters.items()}
        for key, name in zip(equations.states, self.problem.states, strict=True):
            ranges[key] = states[name].value
        ranges |= {key: line.value for key, line in driven.items()}
        return around_motion(self.problem, ranges)

    def _plant_spread(
        self, moving: Mapping[str, RationalInterval], drives: Sequence[Slope], names: Sequence[str]
    ) -> list[list[RationalInterval]]:
        """Return how the plant's next states go with the coordinates of the set."""
        equations = self.problem.equations
        variables = (*equations.states, *equations.inputs)
        values = {
            key: Slope(span, {key: ONE} if key in variables else {}) for key, span in moving.items()
        }
        rates = slopes_of(equations.rates, values)
        jacobian = [[rate.along.get(key, ZERO) for key in variables] for rate in rates]
        flow = flow_over(jacobian, exactly(self.problem.period))
        return [[dot(row, [x.along.get(name, ZERO) for x in drives]) for name in names]
                for row in flow]  # fmt: skip

    def _followed(
        self, states: Mapping[str, Slope], driven: Mapping[str, Slope]
    ) -> list[RationalInterval]:
        """Return where the plant is a period later, from one point: x + h f + ½ h² f' f."""
        equations, problem = self.problem.equations, self.problem
        h = Fraction(problem.period) / STEPS
        at = {k: states[n].value for k, n in zip(equations.states, problem.states, strict=True)}
        inputs = {key: line.value for key, line in driven.items()}
        fixed = {key: value.value for key, value in self.parameters.items()}
        for _ in range(STEPS):
            box = around_motion(problem, {**at, **inputs, **fixed}, h)
            values = {k: Slope(s, {k: ONE} if k in at else {}) for k, s in box.items()}
            over = slopes_of(equations.rates, values)
            begin = slopes_of(
                equations.rates, {k: Slope(s, {}) for k, s in {**at, **inputs, **fixed}.items()}
            )
            after = {}
            for key, rate, slope in zip(at, begin, over, strict=True):
                # x'' = f'(x) f(x), over the box: the remainder of second order in Lagrange's form.
                bend = dot([slope.along.get(k, ZERO) for k in at], [x.value for x in over])
                half = bend.times(exactly(h * h / 2))
                after[key] = at[key].plus(rate.value.times(exactly(h))).plus(half)
            at = after
        return list(at.values())

    def _outputs(
        self, moving: Mapping[str, RationalInterval], driven: Mapping[str, Slope]
    ) -> dict[str, RationalInterval]:
        equations, interface = self.problem.equations, self.problem.site.interface
        values = {key: Slope(span, {}) for key, span in moving.items()}
        outputs = slopes_of(equations.outputs, values)
        spans = {
            interface.label(address): line.value
            for address, line in zip(interface.outputs, outputs, strict=True)
        }
        for address, line in zip(interface.inputs, driven.values(), strict=True):
            spans[interface.label(address)] = line.value
        return spans


def _rounded(span: RationalInterval) -> RationalInterval:
    """Return an interval with short ends that holds one."""
    low = Fraction(span.low.numerator * GRID // span.low.denominator, GRID)
    high = Fraction(-(-span.high.numerator * GRID // span.high.denominator), GRID)
    return RationalInterval(low, high)


def _inverse(rows: Matrix) -> Matrix:
    size = len(rows)
    # Gauss and Jordan in rationals: the first pivot that is not 0 will do, nothing is rounded.
    work = [[*row, *(Fraction(int(i == j)) for j in range(size))] for i, row in enumerate(rows)]
    for column in range(size):
        check_time()
        pivot = next((k for k in range(column, size) if work[k][column]), None)
        if pivot is None:
            raise LoopProofError("a set without an end")
        work[column], work[pivot] = work[pivot], work[column]
        head = [x / work[column][column] for x in work[column]]
        work[column] = head
        for k in range(size):
            factor = work[k][column]
            if k != column and factor:
                work[k] = [x - factor * y for x, y in zip(work[k], head, strict=True)]
    return tuple(tuple(row[size:]) for row in work)


# ── a certificate ────────────────────────────────────────────────────────────────────


def start_of(loop: TubeLoop, path: Sequence[tuple[int, bool]]) -> list[RationalInterval]:
    """Return the starts of a box: those of the problem, halved, and the memory as it begins.

    Parameters
    ----------
    loop : TubeLoop
        The loop.
    path : sequence of (int, bool)
        Which state is halved, and whether the upper half is taken.
    """
    spans = [
        RationalInterval(Fraction(x.low), Fraction(x.high)) for x in loop.problem.start.values()
    ]
    for dimension, upper in path:
        low, high = spans[dimension]
        middle = (low + high) / 2
        spans[dimension] = (
            RationalInterval(middle, high) if upper else RationalInterval(low, middle)
        )
    return [*spans, *(exactly(loop.walk.states[name]) for name in loop.memory)]


def tube_refutation(loop: TubeLoop, claim: LoopClaim, port: str, boxes: Sequence[BoxProof]) -> str:
    """Return why a certificate does not prove a claim for a bounded time; empty where it does."""
    if not _is_all(tuple(box.path for box in boxes)):
        return "its boxes are not all of the starts"
    _, last = claimed_in(loop.problem, claim)
    for number, box in enumerate(boxes, 1):
        if last is None or len(box.sets) <= last:
            return f"box {number} ends before the claim does"
        against = _box_refutation(loop, claim, port, box)
        if against:
            return f"box {number}: {against}"
    return ""


def _is_all(paths: tuple[tuple[tuple[int, bool], ...], ...]) -> bool:
    """Tell whether paths of halvings lead to all parts of the whole."""
    # Each halving must be answered by both halves, along the same dimension.
    if () in paths:
        return paths == ((),)
    if not paths or len({path[0][0] for path in paths}) != 1:
        return False
    return all(
        _is_all(tuple(path[1:] for path in paths if path[0][1] == upper)) for upper in (False, True)
    )


def _box_refutation(loop: TubeLoop, claim: LoopClaim, port: str, box: BoxProof) -> str:
    spans = start_of(loop, box.path)
    if not _is_inside([x.middle for x in spans], [x.radius for x in spans], box.sets[0]):
        return "its first set does not contain the starts"
    begin, last = claimed_in(loop.problem, claim)
    assert last is not None
    for k, tube_set in enumerate(box.sets[: last + 1]):
        step = loop.period(tube_set, first=k == 0)
        if k >= begin:  # bounds are of the whole period
            where = step.outputs[port]
            if not (claim.low <= where.low and where.high <= claim.high):
                return f"in period {k + 1} the claim is not shown"
        if k < last and not leads_into(step, box.sets[k + 1]):
            return f"period {k + 1} does not lead from its set into the next one"
    return ""


def leads_into(step: Period, after: TubeSet) -> bool:
    """Tell whether all that comes of a set is in the next one."""
    away = [x.minus(exactly(c)) for x, c in zip(step.centre, after.centre, strict=True)]
    for row in after.rows:
        weights = [exactly(x) for x in row]
        size = dot(weights, away).size
        # |w (F(c) − c') + w G e| ≤ |w (F(c) − c')| + Σ |w Gₖ|, the largest over |e| ≤ 1.
        for column in zip(*step.spread, strict=True):
            size += dot(weights, list(column)).size
        if size > 1:
            return False
    return True


def _is_inside(centre: Sequence[Fraction], half: Sequence[Fraction], tube: TubeSet) -> bool:
    """Tell whether a box is in a set."""
    for row in tube.rows:
        away = [x * (a - b) for x, a, b in zip(row, centre, tube.centre, strict=True)]
        size = abs(sum(away, Fraction(0)))
        size += sum((abs(x) * r for x, r in zip(row, half, strict=True)), Fraction(0))
        if size > 1:
            return False
    return True
