"""A loop around its rest as the checker derives it: its own route from the files to matrices.

    z' = A z + B w (each period, or as a rate),   |wₖ| ≤ |Cₖ z + Dₖ w|,   |g z + h w| ≤ limit

The controller is walked as the program that runs (:mod:`fuzzyarm.proof.loop.program_walk`), the
plant's equations are differentiated in intervals of rationals (:mod:`fuzzyarm.proof.loop.slopes`),
its motion over a period is a series with a bounded tail, and what is said of rule bases is checked
on their pieces (:mod:`fuzzyarm.proof.loop.rule_pieces`). A certificate says which gains to check;
nothing in it is trusted, and no code of the search is used.

A loop may rest where numbers are not rational. Then z is how far it is from a true rest of which
only an interval is known: that there is one in it, and no other, is proved by Krawczyk's operator
K = m − Y F(m) + (1 − Y F'(R)) (R − m), which has to lie within R.

Sources: R. Krawczyk, "Newton-Algorithmen zur Bestimmung von Nullstellen mit Fehlerschranken",
*Computing* 4, 1969; R. E. Moore, R. B. Kearfott and M. J. Cloud, *Introduction to Interval
Analysis*, SIAM 2009, section 8.2.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from fuzzyarm.plant.plant import Address
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.loop.checked_lines import (
    LinearSignal,
    LinearSignals,
    PiecesOfRules,
    Unchecked,
    combined,
    number_line,
)
from fuzzyarm.proof.loop.checked_motion import around_motion, dot, flow_over
from fuzzyarm.proof.loop.evidence import Evidence
from fuzzyarm.proof.loop.program_walk import ProgramWalk
from fuzzyarm.proof.loop.slopes import Slope, SlopeNumbers, slopes_of
from fuzzyarm.proof.loop.spans import RationalInterval, exactly, hull
from fuzzyarm.symbolic.nodes import Apply, postorder, symbols

__all__ = ["CheckedLoop", "checked_loop"]

Row = tuple[Fraction, ...]
Matrix = tuple[Row, ...]

NOTHING, UNIT = Fraction(0), Fraction(1)

FAR = Fraction(10**308)
"""As far as numbers go: what is affine as far as that is affine."""

JUMPS = ("floor", "ceil", "round", "remainder", "sign", "where")
"""Operations that may jump, which the equations of a plant must not have."""


# ── what is derived ──────────────────────────────────────────────────────────────────


@dataclass(frozen=True)
class CheckedLoop:
    """A loop as matrices; see the head of this module.

    Attributes
    ----------
    names : tuple of str
        Of z.
    rest : dict of str to Fraction
        The middle of what is known of it.
    doubt : dict of str to Fraction
        How far the true rest may be from there.
    a, b, radius : matrix of Fraction
        Of the next z, or of its rate, and how far the true ``[a b]`` may be from these numbers.
    blocks : matrix of Fraction
        ``[Cₖ Dₖ]``.
    words : tuple of str
        What each block is.
    rows : tuple of (row of Fraction, Fraction, str)
        ``[g h]``, limit, and what it is.
    seeds : dict of str to (Fraction, dict of str to Fraction)
        What memory that begins as what it first sees is: a number and weights of how far states
        of the plant are from rest.
    begin : dict of str to Fraction
        What other memory is before the first period.
    period : float
        s; 0 for a loop in continuous time.
    drives : dict of (str, str) to LinearSignal
        Inputs of the plant within its limits, by axis and port: held from one sample to the next.
    """

    names: tuple[str, ...]
    rest: Mapping[str, Fraction]
    doubt: Mapping[str, Fraction]
    a: Matrix
    b: Matrix
    radius: Matrix
    blocks: Matrix
    words: tuple[str, ...]
    rows: tuple[tuple[Row, Fraction, str], ...]
    seeds: Mapping[str, tuple[Fraction, Mapping[str, Fraction]]]
    begin: Mapping[str, Fraction]
    period: float
    drives: Mapping[Address, LinearSignal]

    def within(self, reach: Mapping[str, float]) -> dict[str, RationalInterval]:
        """Return where states are that are no further from rest than a reach."""
        halves = {name: Fraction(reach[name]) + self.doubt[name] for name in self.names}
        return {
            name: RationalInterval(self.rest[name] - half, self.rest[name] + half)
            for name, half in halves.items()
        }

    @property
    def size(self) -> int:
        """How many states."""
        return len(self.names)

    def rows_within(self) -> list[tuple[Row, Fraction, str]]:
        """Return rows g over z alone with |g z| ≤ limit, which say that all bounds hold."""
        rows: dict[tuple[Row, Fraction, str], None] = {}
        for whole, limit, words in self.rows:
            rows.update({(row, limit, words): None for row in self._without_answers(whole)})
        return list(rows)

    def rows_of_drive(self, address: Address) -> list[Row]:
        """Return rows g over z alone: a drive is as far from its rest as the largest |g z|."""
        width = [*self.names, *(f"w{k}" for k in range(len(self.blocks)))]
        parts = self.drives[address].parts
        return self._without_answers([parts.get(name, NOTHING) for name in width])

    def _without_answers(self, whole: Sequence[Fraction]) -> list[Row]:
        """Return rows over z alone, the extremes of one over z and the answers.

        An answer w is its v times some δ in [-1, 1]: a linear function is largest at an end.
        """
        rows = [list(whole)]
        # The last answer first: the v of each has only answers before it, so one pass removes all.
        for k in range(len(self.blocks) - 1, -1, -1):
            at = self.size + k
            rows = [
                [x + sign * row[at] * v for x, v in zip(row[:at], self.blocks[k], strict=False)]
                for row in rows
                for sign in ((-1, 1) if row[at] else (0,))
            ]
        return list(map(tuple, rows))


# ── the derivation ───────────────────────────────────────────────────────────────────


def checked_loop(
    problem: LoopProblem,
    names: Sequence[str],
    evidence: Evidence,
    *,
    continuous: bool = False,
    pieces: PiecesOfRules | None = None,
) -> CheckedLoop:
    """Derive a loop from its files, and check the statements of a certificate on the way.

    Parameters
    ----------
    problem : LoopProblem
        The loop.
    names : sequence of str
        Of z: states of the plant first, then memory.
    evidence : Evidence
        The statements of the certificate.
    continuous : bool
        As if the controller ran without a period.
    pieces : PiecesOfRules, optional
        Of its rule bases, where they have been cut already.

    Raises
    ------
    LoopProofError
        With what is wrong, or not read.
    """
    rule_pieces = pieces or PiecesOfRules()
    return _Derivation(problem, tuple(names), evidence, rule_pieces, continuous=continuous).loop()


class _Derivation:
    def __init__(
        self, problem: LoopProblem, names: tuple[str, ...], evidence: Evidence,
        pieces: PiecesOfRules, *, continuous: bool,
    ) -> None:  # fmt: skip
        self.problem, self.names, self.evidence = problem, names, evidence
        self.continuous = continuous
        self.equations = problem.equations
        count = len(problem.states)
        if names[:count] != problem.states or set(names[count:]) != set(evidence.memory):
            raise LoopProofError("it is of other states")
        self.walk = ProgramWalk(problem)
        self.memory = [evidence.memory[name] for name in names[count:]]
        if len(set(self.memory)) < len(self.memory) or not set(self.memory) <= set(
            self.walk.states
        ):
            raise LoopProofError("its memory is not that of the program")
        if continuous and self.memory:
            raise LoopProofError("in continuous time there is no memory")
        self.pieces = pieces
        _demand_still(problem)
        self.rest = self._rest()

    # --- rest ---

    def _rest(self) -> dict[str, RationalInterval]:
        """Return an interval for each of z that holds a rest of the loop, which is proved."""
        if set(self.evidence.rest) != set(self.names):
            raise LoopProofError("its rest is of other states")
        middle = {name: exactly(self.evidence.rest[name][0]) for name in self.names}
        doubt = {name: self.evidence.rest[name][1] for name in self.names}
        if not any(doubt.values()):
            if any(value != exactly(NOTHING) for value in self._motion(middle)):
                raise LoopProofError("the loop does not rest at the stated point")
            return middle
        if not all(radius > 0 for radius in doubt.values()):
            raise LoopProofError("its rest has no room")
        box = {
            name: RationalInterval(middle[name].low - doubt[name], middle[name].low + doubt[name])
            for name in self.names
        }
        self._demand_krawczyk(middle, box)
        return box

    def _motion(self, at: Mapping[str, RationalInterval]) -> list[RationalInterval]:
        return [slope.value for slope in self._steered(at, ())]

    def _steered(self, at: Mapping[str, RationalInterval], variables: Sequence[str]) -> list[Slope]:
        """Return the rates of the plant and the steps of the memory, which are 0 at rest."""
        values = {
            name: Slope(span, {name: exactly(UNIT)} if name in variables else {})
            for name, span in at.items()
        }
        plant = self._plant_values(values)
        problem, interface = self.problem, self.problem.site.interface
        outputs = dict(
            zip(interface.outputs, slopes_of(self.equations.outputs, plant), strict=True)
        )
        states = dict(
            zip(self.memory, (values[n] for n in self.names[len(problem.states) :]), strict=True)
        )
        numbers = SlopeNumbers(self.pieces)
        inputs, after = self.walk.period(numbers, outputs, states)
        drives = {
            key: inputs[address]
            for key, address in zip(self.equations.inputs, interface.inputs, strict=True)
        }
        moves = slopes_of(self.equations.rates, {**plant, **drives})
        for key in self.memory:
            step = numbers.apply("subtract", [after[key], states[key]])
            moves.append(step)
        return moves

    def _plant_values(self, values: Mapping[str, Slope]) -> dict[str, Slope]:
        equations, problem = self.equations, self.problem
        seeds = {
            key: values[name] for key, name in zip(equations.states, problem.states, strict=True)
        }
        for key, span in zip(equations.parameters, problem.parameters.values(), strict=True):
            seeds[key] = Slope(RationalInterval(Fraction(span.low), Fraction(span.high)), {})
        return seeds

    def _demand_krawczyk(
        self, middle: Mapping[str, RationalInterval], box: Mapping[str, RationalInterval]
    ) -> None:
        """Refuse a box unless there is a rest in it, and one only."""
        names, size = self.names, len(self.names)
        f = self._motion(middle)
        slopes = self._steered(box, names)
        zero = exactly(NOTHING)
        jacobian = [[slope.along.get(name, zero) for name in names] for slope in slopes]
        try:
            near = np.linalg.inv([[float(x.middle) for x in row] for row in jacobian])
        except np.linalg.LinAlgError:
            raise LoopProofError("where it rests is not one point") from None
        # Any matrix will do, as long as what follows is exact.
        y = [[exactly(float(x)) for x in row] for row in near]
        for i, name in enumerate(names):
            # Row i of K − m; strictly less than the radius, so that K lies inside R.
            total = zero.minus(dot(y[i], f))
            for j, other in enumerate(names):
                slope = dot(y[i], [jacobian[k][j] for k in range(size)])
                gap = exactly(Fraction(int(i == j))).minus(slope)
                half = box[other].radius
                total = total.plus(gap.times(RationalInterval(-half, half)))
            if not (total.size < box[name].radius):
                raise LoopProofError("that there is a rest in its interval is not proved")

    # --- one period ---

    def loop(self) -> CheckedLoop:
        """Return the matrices."""
        problem, names = self.problem, self.names
        lines = LinearSignals(self.evidence, self.pieces)
        z = {name: LinearSignal(self.rest[name], {name: UNIT}) for name in names}
        inputs, after = self._period(lines, z)
        if next(lines.gains, None) is not None:
            raise LoopProofError("it claims something of a rule base that is not there")
        rows = self._plant_rows(lines, z, inputs)
        for key in self.memory:
            rows.append((dict(after[key].parts), {}))
        lines.bounds += self._bounds_of_outputs(z)
        self._demand_other_memory_is_still(after)
        count = len(lines.blocks)
        width = [*names, *(f"w{k}" for k in range(count))]

        def row(parts: Mapping[str, Fraction]) -> Row:
            return tuple(parts.get(name, NOTHING) for name in width)

        matrix = [row(parts) for parts, _ in rows]
        size = len(names)
        seeds, begin = self._beginning(z)
        return CheckedLoop(
            names,
            {name: self.rest[name].middle for name in names},
            {name: self.rest[name].radius for name in names},
            tuple(line[:size] for line in matrix),
            tuple(line[size:] for line in matrix),
            tuple(row(spread) for _, spread in rows),
            tuple(row(v) for v, _ in lines.blocks),
            tuple(words for _, words in lines.blocks),
            tuple((row(parts), limit, words) for parts, limit, words in lines.bounds),
            seeds,
            begin,
            0.0 if self.continuous else problem.period,
            inputs,
        )

    def _period(
        self, lines: LinearSignals, z: Mapping[str, LinearSignal], *, first: bool = False,
        states: Mapping[str, LinearSignal] | None = None,
    ) -> tuple[dict[Address, LinearSignal], dict[str, LinearSignal]]:  # fmt: skip
        problem = self.problem
        outputs = {
            address: self._output(k, z) for k, address in enumerate(problem.site.interface.outputs)
        }
        if states is None:
            slopes = z.values()
            states = dict(zip(self.memory, list(slopes)[len(problem.states) :], strict=True))
        return self.walk.period(lines, outputs, states, first=first)

    def _output(self, index: int, z: Mapping[str, LinearSignal]) -> LinearSignal:
        """Return an output of the plant, which has to be affine, by its slopes."""
        names = self.problem.states
        root = self.equations.outputs[index]
        values = {n: Slope(self.rest[n], {n: exactly(UNIT)}) for n in names}
        slope = slopes_of([root], self._plant_values(values))[0]
        for k, key in enumerate(self.equations.states):
            # A measured state is itself, exactly, even where its rest is known by an interval.
            if getattr(root, "name", "") == key:
                return z[names[k]]
        wide = {n: Slope(RationalInterval(-FAR, FAR), {n: exactly(UNIT)})
                for n in names}  # fmt: skip
        again = slopes_of([root], self._plant_values(wide))[0]
        if again.along != slope.along or not all(x.is_point for x in slope.along.values()):
            raise LoopProofError("an output of the plant is not affine")
        parts = {name: x.low for name, x in slope.along.items() if x.low}
        return LinearSignal(slope.value, parts)

    def _bounds_of_outputs(
        self, z: Mapping[str, LinearSignal]
    ) -> list[tuple[Mapping[str, Fraction], Fraction, str]]:
        """Return rows that keep outputs within their bounds: beyond them a run has diverged."""
        bounds = []
        for k, (address, port) in enumerate(self.problem.site.interface.outputs.items()):
            line, label = self._output(k, z), ".".join(address)
            if math.isinf(port.bound):
                continue
            room = Fraction(port.bound) - line.rest.size
            if room <= 0:
                raise LoopProofError(f"at rest '{label}' is beyond its bound")
            bounds.append((line.parts, room, f"the bound of '{label}'"))
        return bounds

    def _demand_other_memory_is_still(self, after: Mapping[str, LinearSignal]) -> None:
        """Refuse memory that is not a row of P, is read, and does not stay as it begins."""
        for key in self.walk.states_read - set(self.memory):
            line, start = after[key], exactly(self.walk.states[key])
            if line.parts or line.rest != start:
                raise LoopProofError(f"'{key}' is remembered, and moves")

    # --- the plant ---

    def _plant_rows(
        self,
        lines: LinearSignals,
        z: Mapping[str, LinearSignal],
        inputs: Mapping[Address, LinearSignal],
    ) -> list[tuple[dict[str, Fraction], dict[str, Fraction]]]:
        """Return the weights of the plant's next states, or rates, and how far they may be off."""
        problem, equations = self.problem, self.equations
        matrix = self._matrix(lines, inputs)
        signals = [z[name].parts for name in problem.states]
        signals += [line.parts for line in inputs.values()]
        spread = {(k, j): RationalInterval(low, high) for k, j, low, high in self.evidence.spread}
        rows = []
        for k, name in enumerate(problem.states):
            terms, off = [], []
            for j, parts in enumerate(signals):
                entry = spread.get((k, j), matrix[k][j])
                if not entry.holds(matrix[k][j]):
                    raise LoopProofError("the plant's motion is not as it is claimed")
                terms.append((parts, entry.middle))
                # An entry with a spread in the certificate becomes a gain with an answer of its
                # own; the doubt of any other (of the matrix exponential) goes into `radius`.
                if (k, j) in spread:
                    by = [*problem.states, *equations.inputs][j]
                    words = f"the plant, {name} by {by} in {float(entry.low):.6g} .. "
                    words += f"{float(entry.high):.6g}"
                    v = {n: weight * entry.radius for n, weight in parts.items()}
                    terms.append(({lines.block(v, words): UNIT}, UNIT))
                else:
                    sizes = {n: abs(weight) for n, weight in parts.items()}
                    off.append((sizes, entry.radius))
            rows.append((combined(terms), combined(off)))
        return rows

    def _matrix(
        self, lines: LinearSignals, inputs: Mapping[Address, LinearSignal]
    ) -> list[list[RationalInterval]]:
        """Return the slopes of the plant's motion over a period, or of its rates."""
        ranges = self._ranges(lines, inputs)
        flat = not self.evidence.box
        jacobian = self._jacobian(ranges)
        if flat:
            # Affine equations have the same slopes everywhere: as far as numbers go here.
            far = {key: span if key in self.equations.parameters else hull(
                span, RationalInterval(-FAR, FAR)) for key, span in ranges.items()}  # fmt: skip
            if self._jacobian(far) != jacobian:
                raise LoopProofError("the plant is not affine, and there is no box")
        if self.continuous:
            if not flat:
                raise LoopProofError("the plant is not affine")
            return jacobian
        if not flat:
            jacobian = self._jacobian(self._around_motion(ranges))
        return flow_over(jacobian, exactly(self.problem.period))

    def _jacobian(self, ranges: Mapping[str, RationalInterval]) -> list[list[RationalInterval]]:
        variables = (*self.equations.states, *self.equations.inputs)
        values = {
            key: Slope(span, {key: exactly(UNIT)} if key in variables else {})
            for key, span in ranges.items()
        }
        slopes = slopes_of(self.equations.rates, values)
        zero = exactly(NOTHING)
        return [[slope.along.get(key, zero) for key in variables] for slope in slopes]

    def _ranges(
        self, lines: LinearSignals, inputs: Mapping[Address, LinearSignal]
    ) -> dict[str, RationalInterval]:
        """Return where states, inputs and parameters are at a sample."""
        problem, equations = self.problem, self.equations
        ranges = {
            key: RationalInterval(Fraction(span.low), Fraction(span.high))
            for key, span in zip(equations.parameters, problem.parameters.values(), strict=True)
        }
        for key, name in zip(equations.states, problem.states, strict=True):
            half, rest = self.evidence.box.get(name, NOTHING), self.rest[name]
            if half:
                lines.bounds.append(({name: UNIT}, half, f"the box of '{name}'"))
            elif self.evidence.box:
                raise LoopProofError(f"'{name}' has no box")
            ranges[key] = RationalInterval(rest.low - half, rest.high + half)
        for key, (address, line) in zip(equations.inputs, inputs.items(), strict=True):
            port = problem.site.interface.inputs[address]
            ends = [
                [
                    x
                    for x in (None if math.isinf(limit) else Fraction(limit), bound)
                    if x is not None
                ]
                for limit, bound in ((port.low, line.low), (port.high, line.high))
            ]
            if all(ends):
                ranges[key] = RationalInterval(max(ends[0]), min(ends[1]))
            elif self.evidence.box:
                raise LoopProofError("an input of the plant has no bound")
            else:
                ranges[key] = line.rest
        return ranges

    def _around_motion(self, ranges: Mapping[str, RationalInterval]) -> dict[str, RationalInterval]:
        return around_motion(self.problem, ranges)

    # --- how it begins ---

    def _beginning(
        self, z: Mapping[str, LinearSignal]
    ) -> tuple[dict[str, tuple[Fraction, Mapping[str, Fraction]]], dict[str, Fraction]]:
        """Return what memory is as the loop begins, by states of the plant."""
        names = dict(zip(self.memory, self.names[len(self.problem.states) :], strict=True))
        begin = {
            name: Fraction(self.walk.states[key])
            for key, name in names.items()
            if key not in self.walk.begun
        }
        begun = [key for key in self.memory if key in self.walk.begun]
        if not begun:
            return {}, begin
        # What begins as it first sees is as if it had been so before: both periods are the same.
        try:
            results = []
            states: dict[str, LinearSignal] = {
                key: number_line(exactly(self.walk.states[key])) for key in self.memory
            }
            for first in (True, False):
                lines = Unchecked(self.evidence, self.pieces)
                inputs, after = self._period(lines, z, first=first, states=states)
                ends = list(inputs.values()), [after[key] for key in self.memory]
                results.append((ends, lines.record, lines.bounds))
                states |= {key: after[key] for key in begun}
            if results[0] != results[1]:
                return {}, {}
        except LoopProofError:
            return {}, {}
        seeds: dict[str, tuple[Fraction, Mapping[str, Fraction]]] = {}
        for key in begun:
            line = states[key]
            if not line.rest.is_point:
                return {}, {}
            seeds[names[key]] = line.rest.low, dict(line.parts)
        return seeds, begin


def _demand_still(problem: LoopProblem) -> None:
    """Refuse equations that depend on the time, jump, or let an input through at once."""
    equations = problem.equations
    for root in (*equations.rates, *equations.outputs):
        if "t" in symbols(root):
            raise LoopProofError("the plant's equations depend on the time")
        for node in postorder(root):
            if isinstance(node, Apply) and node.operation in JUMPS:
                raise LoopProofError(f"the plant's equations may jump: '{node.operation}'")
    for root in equations.outputs:
        if set(symbols(root)) & {*equations.inputs, *equations.parameters}:
            spans = dict(zip(equations.parameters, problem.parameters.values(), strict=True))
            free = {key for key, span in spans.items() if span.low < span.high}
            if set(symbols(root)) & {*equations.inputs, *free}:
                raise LoopProofError("an output depends on an input or an open parameter at once")
