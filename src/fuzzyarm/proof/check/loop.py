"""The linear loop around its rest, derived by the checker: its own route from files to matrices.

    z' = A z + B w (each period, or as a rate),   |wₖ| ≤ |Cₖ z + Dₖ w|,   |g z + h w| ≤ limit

The walk goes over the compiled program of the controller (:mod:`.walk`), the plant's equations are
differentiated in balls (:mod:`.slopes`), its motion over a period is a series with a bounded tail,
and claims about rule bases are checked on their pieces (:mod:`.rules`). A certificate names the
gains to check; nothing in it is trusted, and no code of the search is used.

An equilibrium may be irrational. Then z is the deviation from a true rest known by a ball only:
that the ball contains one is proved by Krawczyk's operator
K = m − Y F(m) + (1 − Y F'(R)) (R − m), which has to lie within R.

Sources: R. Krawczyk, "Newton-Algorithmen zur Bestimmung von Nullstellen mit Fehlerschranken",
*Computing* 4, 1969; R. E. Moore, R. B. Kearfott and M. J. Cloud, *Introduction to Interval
Analysis*, SIAM 2009, section 8.2.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from operator import lt
from typing import Any

import numpy as np
from flint import arb, fmpq

from fuzzyarm.plant.plant import Address
from fuzzyarm.proof.check.certificate import Evidence
from fuzzyarm.proof.check.lines import (
    LinearSignal,
    LinearSignals,
    Parts,
    Unchecked,
    combined,
    number_line,
)
from fuzzyarm.proof.check.motion import (
    FAR,
    around_motion,
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
    around,
    between,
    ends,
    exact,
    greatest,
    is_point,
    is_same,
    least,
    magnitude,
    middle,
    precisely,
    product,
)
from fuzzyarm.proof.check.rules import RuleSurfaces
from fuzzyarm.proof.check.slopes import Slope, SlopeNumbers, slopes_of
from fuzzyarm.proof.check.walk import ProgramWalk
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.symbolic.nodes import Apply, postorder, symbols

JUMPS = (
    "floor", "ceil", "round", "truncate", "remainder", "sign", "where",
    "less", "less_equal", "equal", "both", "either", "negation",
)  # fmt: skip
"""Operations that may jump, not allowed in the equations of a plant."""


@dataclass(frozen=True, kw_only=True)
class System:
    """Matrices of a loop; inexact numbers are balls."""

    size: int  # number of z
    move: Matrix  # ``[A B]``
    blocks: Matrix  # ``[Cₖ Dₖ]``
    rows: tuple[tuple[Sequence[Number], Number, str], ...]  # ``[g h]``, limit, name in words
    period: float  # s; 0 for a loop in continuous time
    # ``[g h]`` of the signals that are not negative in a cone
    sides: tuple[Sequence[Number], ...] = ()

    def rows_within(self) -> list[tuple[list[Number], Number, str]]:
        """Return rows g over z alone: |g z| ≤ limit keeps all bounds."""
        return [
            (row, limit, words)
            for whole, limit, words in self.rows
            for row in self.without_answers(whole)
        ]

    def without_answers(self, whole: Sequence[Number]) -> list[list[Number]]:
        """Return rows over z alone: the extremes of a row over z and the answers.

        An answer w is its v times some δ in [-1, 1], and a linear function is extreme at an end.
        """
        rows = [list(whole)]
        # The last answer first: the v of each has only answers before it, so one pass removes all.
        for k in range(len(self.blocks) - 1, -1, -1):
            at = self.size + k
            rows = [
                [x + v * row[at] * sign for x, v in zip(row[:at], self.blocks[k], strict=False)]
                for row in rows
                for sign in ((0,) if row[at] == 0 else (-1, 1))
            ]
        return rows


@dataclass(frozen=True, kw_only=True)
class CheckedLoop(System):
    """A derived loop; see the head of this module."""

    names: tuple[str, ...]  # of z
    rest: Mapping[str, Number]  # a ball that contains it
    words: tuple[str, ...]  # each block in words
    # Memory that begins as its first input: a number, and weights of the deviations of the
    # plant's states
    seeds: Mapping[str, tuple[Number, Parts]]
    begin: Mapping[str, Number]  # other memory before the first period
    # Inputs of the plant, limited, by axis and port: held between samples
    drives: Mapping[Address, LinearSignal]
    outputs: Mapping[Address, LinearSignal]  # outputs of the plant, by axis and port
    still: Set[str]  # memory and inputs of the program outside z: constant

    def rows_of_drive(self, address: Address) -> list[list[Number]]:
        """Return rows g over z alone: the largest |g z| is the largest deviation of a drive."""
        parts = self.drives[address].parts
        width = [*self.names, *(f"w{k}" for k in range(len(self.blocks)))]
        return self.without_answers([parts.get(name, ZERO) for name in width])


@precisely
def checked_loop(
    problem: LoopProblem,
    names: Sequence[str],
    evidence: Evidence,
    *,
    continuous: bool = False,
    surfaces: RuleSurfaces | None = None,
    in_cone: bool = False,
) -> CheckedLoop:
    """Derive a loop from its files and check the statements of a certificate on the way.

    `names` are those of z, states of the plant first, then memory. `in_cone`: claims about rule
    bases may cover one side of their rest only. LoopProofError names the failed statement.
    """
    of_rules = surfaces or RuleSurfaces()
    derivation = _Derivation(problem, tuple(names), evidence, of_rules, continuous=continuous)
    return derivation.loop(in_cone=in_cone)


@precisely
def rest_within(
    problem: LoopProblem, evidence: Evidence, surfaces: RuleSurfaces
) -> dict[str, Fraction]:
    """Return the radius of Krawczyk's operator around the midpoint of a rest, by row."""
    names = tuple(evidence.rest)
    derivation = _Derivation(problem, names, evidence, surfaces, continuous=False)
    return {name: ends(far)[1] for name, far in derivation.krawczyk().items()}


Directions = Mapping[str, Mapping[str, Number]]
"""By row of z, its slopes along the variables in use."""


def _radii_of_rest(f: Matrix, jacobian: Matrix, radii: Sequence[Number]) -> list[Number]:
    """Return the radii of Krawczyk's operator over a box, for F at its middle and slopes in it."""
    try:
        near = np.linalg.inv([[float(middle(x)) for x in row] for row in jacobian])
    except np.linalg.LinAlgError:
        raise LoopProofError("where it rests is not one point") from None
    # Any matrix Y is sound; this one is close to the inverse.
    y = [[exact(float(x)) for x in row] for row in near]
    shift, turned = product(y, f), product(y, jacobian)
    radii_of_k = []
    for i in range(len(f)):
        total = -shift[i][0]  # row i of K - m
        for j, far in enumerate(radii):
            if far > 0:  # else K is not within, by its row j
                total += (int(i == j) - turned[i][j]) * around(ZERO, far)
        radii_of_k.append(magnitude(total))
    return radii_of_k


class _Derivation:
    def __init__(
        self, problem: LoopProblem, names: tuple[str, ...], evidence: Evidence,
        surfaces: RuleSurfaces, *, continuous: bool,
    ) -> None:  # fmt: skip
        self.problem, self.names, self.evidence = problem, names, evidence
        self.continuous, self.surfaces = continuous, surfaces
        self.equations = problem.equations
        count = len(problem.states)
        if names[:count] != problem.states or set(names[count:]) != set(evidence.memory):
            raise LoopProofError("it is of other states")
        self.walk = ProgramWalk(problem)
        self.memory = [evidence.memory[name] for name in names[count:]]
        known = set(self.memory) <= set(self.walk.states)
        if len(set(self.memory)) < len(self.memory) or not known:
            raise LoopProofError("its memory is not that of the program")
        if continuous and self.memory:
            raise LoopProofError("in continuous time there is no memory")
        _demand_still(problem)

    # --- rest ---

    @cached_property
    def rest(self) -> dict[str, Number]:
        """A ball for each of z with a rest of the loop in it, proved."""
        if set(self.evidence.rest) != set(self.names):
            raise LoopProofError("its rest is of other states")
        centre = {name: exact(self.evidence.rest[name][0]) for name in self.names}
        doubt = {name: exact(self.evidence.rest[name][1]) for name in self.names}
        if not any(doubt.values()):
            if not all(rate.value == 0 for rate in self._residuals(centre, {})):
                raise LoopProofError("the loop does not rest at the stated point")
            return centre
        if not all(far > 0 for far in doubt.values()):
            raise LoopProofError("its rest has no room")
        # Strictly less than the radius, so that K lies inside R.
        if not all(far < doubt[name] for name, far in self.krawczyk().items()):
            raise LoopProofError("that there is a rest in its interval is not proved")
        return {name: around(centre[name], doubt[name]) for name in self.names}

    def _residuals(self, at: Mapping[str, Number], directions: Directions) -> list[Slope]:
        """Return the rates of the plant and the increments of the memory: 0 at rest."""
        values = {n: Slope(x, directions.get(n, {})) for n, x in at.items()}
        plant = self._plant_values(values)
        problem, interface = self.problem, self.problem.site.interface
        outputs = dict(
            zip(interface.outputs, slopes_of(self.equations.outputs, plant), strict=True)
        )
        states = dict(
            zip(self.memory, (values[n] for n in self.names[len(problem.states) :]), strict=True)
        )
        numbers = SlopeNumbers(self.surfaces)
        inputs, after = self.walk.period(numbers, outputs, states)
        drives = {
            key: inputs[address]
            for key, address in zip(self.equations.inputs, interface.inputs, strict=True)
        }
        steps = [numbers.apply("subtract", [after[key], states[key]]) for key in self.memory]
        return [*slopes_of(self.equations.rates, {**plant, **drives}), *steps]

    def _plant_values(self, values: Mapping[str, Slope]) -> dict[str, Slope]:
        pairs = zip(self.equations.states, self.problem.states, strict=True)
        fixed = {key: Slope(x, {}) for key, x in parameters_of(self.problem).items()}
        return {**fixed, **{key: values[name] for key, name in pairs}}

    def krawczyk(self) -> dict[str, Number]:
        """Return the radius of K around m: below that of R, a rest lies in R.

        For each choice of the parameters there is exactly one in the set over which F' was taken.
        """
        names, rest = self.names, self.evidence.rest
        centre = {name: exact(rest[name][0]) for name in names}
        doubt = {name: exact(rest[name][1]) for name in names}
        box = {name: around(centre[name], far) for name, far in doubt.items()}
        f = [[slope.value] for slope in self._residuals(centre, {})]
        plain: Directions = {name: {name: ONE} for name in names}
        jacobian = self._jacobian(box, plain)
        radii_of_k = _radii_of_rest(f, jacobian, list(doubt.values()))
        within = all(map(lt, radii_of_k, doubt.values()))
        follows = {} if within else self._followed(jacobian)
        if not follows:
            return dict(zip(names, radii_of_k, strict=True))
        # Next to an edge of a rule base its slope along a rate is uncertain. At rest the rate is 0
        # for certain; in the box it is not, where y and the y before differ. With memory that
        # follows the states, m = T x + m', it is nearly 0 along x. The set of |x| and |m'|
        # below their radii lies in the box if those of m are |T| times those of x larger.
        wider = [sum((abs(t) * doubt[n] for n, t in follows.get(name, {}).items()), ZERO)
                 for name in names]  # fmt: skip
        jacobian = self._jacobian(box, {n: {**plain[n], **follows.get(n, {})} for n in names})
        radii = [far - more for far, more in zip(doubt.values(), wider, strict=True)]
        radii_of_k = _radii_of_rest(f, jacobian, radii)
        return {name: far + more for name, far, more in zip(names, radii_of_k, wider, strict=True)}

    def _jacobian(self, box: Mapping[str, Number], directions: Directions) -> Matrix:
        slopes = self._residuals(box, directions)
        return [[slope.along.get(name, ZERO) for name in self.names] for slope in slopes]

    def _followed(self, jacobian: Matrix) -> Directions:
        """Return how memory at rest follows the states of the plant: T, in floats; any is sound."""
        count = len(self.problem.states)
        rows = np.array([[float(middle(x)) for x in row] for row in jacobian[count:]])
        if not len(rows):
            return {}
        try:
            follows = -np.linalg.solve(rows[:, count:], rows[:, :count])
        except np.linalg.LinAlgError:
            return {}
        if not np.isfinite(follows).all():
            return {}
        return {
            name: {n: exact(float(x)) for n, x in zip(self.names[:count], row, strict=True)}
            for name, row in zip(self.names[count:], follows, strict=True)
        }

    # --- one period ---

    def loop(self, *, in_cone: bool = False) -> CheckedLoop:
        """Return the matrices."""
        problem, names = self.problem, self.names
        lines = LinearSignals(self.evidence, self.surfaces, in_cone=in_cone)
        z = {name: LinearSignal(self.rest[name], {name: ONE}) for name in names}
        inputs, after = self._period(lines, z)
        if next(lines.gains, None) is not None:
            raise LoopProofError("it claims something of a rule base that is not there")
        rows = self._plant_rows(lines, z, inputs)
        rows += [after[key].parts for key in self.memory]
        lines.bounds += self._bounds_of_outputs(z)
        still = self._other_memory(after)
        width = [*names, *(f"w{k}" for k in range(len(lines.blocks)))]

        def row(parts: Parts) -> list[Number]:
            return [parts.get(name, ZERO) for name in width]

        seeds, begin = self._beginning(z)
        return CheckedLoop(
            size=len(names),
            move=[row(parts) for parts in rows],
            blocks=[row(v) for v, _ in lines.blocks],
            rows=tuple((row(parts), limit, words) for parts, limit, words in lines.bounds),
            period=0.0 if self.continuous else problem.period,
            sides=tuple(map(row, lines.sides)),
            names=names,
            rest=self.rest,
            words=tuple(words for _, words in lines.blocks),
            seeds=seeds,
            begin=begin,
            drives=inputs,
            outputs=self._outputs(z),
            still=still,
        )

    def _period(
        self, lines: LinearSignals, z: Mapping[str, LinearSignal], *, first: bool = False,
        states: Mapping[str, LinearSignal] | None = None,
    ) -> tuple[dict[Address, LinearSignal], dict[str, LinearSignal]]:  # fmt: skip
        if states is None:
            slopes = list(z.values())[len(self.problem.states) :]
            states = dict(zip(self.memory, slopes, strict=True))
        return self.walk.period(lines, self._outputs(z), states, first=first)

    def _outputs(self, z: Mapping[str, LinearSignal]) -> dict[Address, LinearSignal]:
        addresses = self.problem.site.interface.outputs
        return {address: self._output(k, z) for k, address in enumerate(addresses)}

    def _output(self, index: int, z: Mapping[str, LinearSignal]) -> LinearSignal:
        """Return an output of the plant, which must be affine, by its slopes."""
        names = self.problem.states
        root = self.equations.outputs[index]
        for k, key in enumerate(self.equations.states):
            # A measured state is exactly that state, even if its rest is a ball.
            if getattr(root, "name", "") == key:
                return z[names[k]]
        far = {name: between(-FAR, FAR) for name in names}
        slope, again = (
            slopes_of([root], self._plant_values({n: Slope(at[n], {n: ONE}) for n in names}))[0]
            for at in (self.rest, far)
        )
        same = {*slope.along} == {*again.along}
        if not same or not all(is_same(x, again.along[n]) for n, x in slope.along.items()):
            raise LoopProofError("an output of the plant is not affine")
        if not all(isinstance(x, fmpq) for x in slope.along.values()):
            raise LoopProofError("an output of the plant is not affine")
        return LinearSignal(slope.value, {n: x for n, x in slope.along.items() if x})

    def _bounds_of_outputs(self, z: Mapping[str, LinearSignal]) -> list[tuple[Parts, Number, str]]:
        """Return rows for the bounds of outputs, beyond which a run has diverged."""
        bounds = []
        for k, (address, port) in enumerate(self.problem.site.interface.outputs.items()):
            line, label = self._output(k, z), ".".join(address)
            if math.isinf(port.bound):
                continue
            room = least(exact(port.bound) - magnitude(line.rest))
            if not room > 0:
                raise LoopProofError(f"at rest '{label}' is beyond its bound")
            bounds.append((line.parts, room, f"'{label}'"))
        return bounds

    def _other_memory(self, after: Mapping[str, LinearSignal]) -> Set[str]:
        """Return memory that is read but not a row of P; refuse it unless constant."""
        others = self.walk.states_read - set(self.memory)
        for key in others:
            if after[key].parts or not after[key].rest == exact(self.walk.states[key]):
                raise LoopProofError(f"'{key}' is remembered, and moves")
        return others

    # --- the plant ---

    def _plant_rows(
        self,
        lines: LinearSignals,
        z: Mapping[str, LinearSignal],
        inputs: Mapping[Address, LinearSignal],
    ) -> list[Parts]:
        """Return the weights of the plant's next states, or of their rates."""
        problem, equations = self.problem, self.equations
        matrix = self._matrix(lines, inputs)
        signals = [z[name].parts for name in problem.states]
        signals += [line.parts for line in inputs.values()]
        spread = {(k, j): (exact(a), exact(b)) for k, j, a, b in self.evidence.spread}
        rows: list[Parts] = []
        for k, name in enumerate(problem.states):
            terms: list[tuple[Parts, Number]] = []
            for j, parts in enumerate(signals):
                if (k, j) not in spread:
                    terms.append((parts, matrix[k][j]))
                    continue
                # An entry with a spread in the certificate becomes a gain with its own answer; the
                # error of any other (of the matrix exponential) stays in its ball.
                low, high = spread[k, j]
                if not (low <= matrix[k][j] and matrix[k][j] <= high):
                    raise LoopProofError("the plant's motion is not as it is claimed")
                by = [*problem.states, *equations.inputs][j]
                words = f"the plant, {name} by {by} in {float(low):.6g} .. {float(high):.6g}"
                half = {n: weight * (high - low) / 2 for n, weight in parts.items()}
                terms += [(parts, (low + high) / 2), ({lines.block(half, words): ONE}, ONE)]
            rows.append(combined(terms))
        return rows

    def _matrix(self, lines: LinearSignals, inputs: Mapping[Address, LinearSignal]) -> Matrix:
        """Return the Jacobian of the plant's motion over a period, or of its rates."""
        ranges = self._ranges(lines, inputs)
        flat = not self.evidence.box
        jacobian = jacobian_of(self.problem, ranges)
        if flat and not is_affine(self.problem, jacobian):
            raise LoopProofError("the plant is not affine, and there is no box")
        if self.continuous:
            if not flat:
                raise LoopProofError("the plant is not affine")
            return jacobian
        if not flat:
            jacobian = jacobian_of(self.problem, around_motion(self.problem, ranges))
        return flow_over(jacobian, exact(self.problem.period))

    def _ranges(
        self, lines: LinearSignals, inputs: Mapping[Address, LinearSignal]
    ) -> dict[str, Number]:
        """Return the ranges of states, inputs and parameters at a sample."""
        problem, equations = self.problem, self.equations
        ranges = parameters_of(problem)
        for key, name in zip(equations.states, problem.states, strict=True):
            half, rest = exact(self.evidence.box.get(name, 0.0)), self.rest[name]
            if half > 0:
                lines.bounds.append(({name: ONE}, half, f"'{name}'"))
            elif self.evidence.box:
                raise LoopProofError(f"'{name}' has no box")
            ranges[key] = around(rest, half) if half else rest
        for key, (address, line) in zip(equations.inputs, inputs.items(), strict=True):
            port = problem.site.interface.inputs[address]
            lows = [arb(port.low), *([] if line.low is None else [arb(line.low)])]
            highs = [arb(port.high), *([] if line.high is None else [arb(line.high)])]
            low, high = lows[0].max(lows[-1]), highs[0].min(highs[-1])
            if low.is_finite() and high.is_finite():
                ranges[key] = between(least(low), greatest(high))
            elif self.evidence.box:
                raise LoopProofError("an input of the plant has no bound")
            else:
                ranges[key] = line.rest
        return ranges

    # --- how it begins ---

    def _beginning(
        self, z: Mapping[str, LinearSignal]
    ) -> tuple[dict[str, tuple[Number, Parts]], dict[str, Number]]:
        """Return the initial memory of the loop as a function of the plant's states."""
        names = dict(zip(self.memory, self.names[len(self.problem.states) :], strict=True))
        begin = {
            name: exact(self.walk.states[key])
            for key, name in names.items()
            if key not in self.walk.begun
        }
        begun = [key for key in self.memory if key in self.walk.begun]
        if not begun:
            return {}, begin
        # Memory that begins as its first input acts as if it had been so before: both walks agree.
        try:
            results: list[Any] = []
            states = {key: number_line(exact(self.walk.states[key])) for key in self.memory}
            for first in (True, False):
                lines = Unchecked(self.evidence, self.surfaces)
                inputs, after = self._period(lines, z, first=first, states=states)
                ends = list(inputs.values()), [after[key] for key in self.memory]
                results.append((ends, lines.record, lines.bounds))
                states |= {key: after[key] for key in begun}
        except LoopProofError:
            return {}, {}
        if not is_same(*results) or not all(is_point(states[key].rest) for key in begun):
            return {}, {}
        return {names[key]: (states[key].rest, dict(states[key].parts)) for key in begun}, begin


def _demand_still(problem: LoopProblem) -> None:
    """Refuse moving references, and equations with explicit time, jumps or feedthrough."""
    equations = problem.equations
    if problem.moved:
        raise LoopProofError("a region is around rest, and a reference moves")
    for root in (*equations.rates, *equations.outputs):
        if "t" in symbols(root):
            raise LoopProofError("the plant's equations depend on the time")
        for node in postorder(root):
            if isinstance(node, Apply) and node.operation in JUMPS:
                raise LoopProofError(f"the plant's equations may jump: '{node.operation}'")
    spans = zip(equations.parameters, problem.parameters.values(), strict=True)
    free = {key for key, span in spans if span.low < span.high}
    for root in equations.outputs:
        if set(symbols(root)) & {*equations.inputs, *free}:
            raise LoopProofError("an output depends on an input or an open parameter at once")
