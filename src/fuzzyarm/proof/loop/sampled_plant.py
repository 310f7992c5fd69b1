"""Enclosed matrices of a plant over one control period, with its inputs held.

Affine equations are sampled by the matrix exponential. For others the slopes are bounded over the
box of states and inputs: along the straight line from rest to any point of the box the motion over
a period has slopes within these bounds, so it is linear with gains among them (mean value theorem).
Their spread becomes blocks.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from functools import cached_property
from typing import Any

from fuzzyarm.plant.plant import Address
from fuzzyarm.proof.check.motion import around_motion, flow_over, jacobian_of
from fuzzyarm.proof.check.numbers import between, exact, float_above, float_below, precisely
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.loop.affine import ZERO, Affine, AffineAlgebra, NotAffineError, variable
from fuzzyarm.proof.loop.form import Assumptions
from fuzzyarm.proof.loop.outward import above, around, below
from fuzzyarm.proof.map.laws import JUMPS
from fuzzyarm.symbolic.evaluation import gradient
from fuzzyarm.symbolic.nodes import Apply, Node, postorder, symbols


def require_still(problem: LoopProblem) -> None:
    """Refuse moving references, explicit time, jumps, and outputs with open parameters."""
    equations, name = problem.equations, problem.plant.name
    if problem.moved:
        raise LoopProofError("a region is around rest, and a reference moves")
    for root in (*equations.rates, *equations.outputs):
        if "t" in symbols(root):
            raise LoopProofError(f"the equations of {name} depend on the time")
        for node in postorder(root):
            if isinstance(node, Apply) and node.operation in JUMPS:
                raise LoopProofError(f"the equations of {name} may jump: '{node.operation}'")
    spans = zip(equations.parameters, problem.parameters.values(), strict=True)
    free = {key for key, span in spans if span.low < span.high}
    for root in equations.outputs:
        if free & set(symbols(root)):
            raise LoopProofError(f"an output of {name} depends on a parameter that is open")


ROOM_FOR_CHECKER = Fraction(1_000_001, 1_000_000)
"""Margin for the rounding of the inputs' ranges: the checker's matrix is otherwise the same."""


class SampledPlant:
    """The plant of a loop.

    Parameters
    ----------
    problem : LoopProblem
        The loop.
    rest : mapping of str to Fraction
        Rest of its states.
    doubt : mapping of str to Fraction
        Largest distance of the true rest from there.
    """

    def __init__(
        self,
        problem: LoopProblem,
        rest: Mapping[str, Fraction],
        doubt: Mapping[str, Fraction],
    ) -> None:
        self.problem, self.rest, self.doubt = problem, rest, doubt
        self.equations = problem.equations

    @cached_property
    def _jacobian(self) -> list[list[Node]]:
        every = (*self.equations.states, *self.equations.inputs)
        return [list(gradient(root, every)) for root in self.equations.rates]

    @cached_property
    def is_affine(self) -> bool:
        """Whether the slopes of the plant are constant."""
        moving = {*self.equations.states, *self.equations.inputs, "t"}
        return not any(moving & set(symbols(node)) for row in self._jacobian for node in row)

    def _ranges(
        self, choice: Assumptions, algebra: AffineAlgebra, inputs: Mapping[Address, Affine]
    ) -> dict[str, tuple[float, float]]:
        """Return the ranges of states and inputs from one sample to the next."""
        equations, problem = self.equations, self.problem
        ranges = {"t": (-math.inf, math.inf)}
        for key, span in zip(equations.parameters, problem.parameters.values(), strict=True):
            ranges[key] = (span.low, span.high)
        for key, name in zip(equations.states, problem.states, strict=True):
            half = choice.box.get(name)
            if half is None:
                ranges[key] = (-math.inf, math.inf)
                continue
            algebra.require(variable(name), -half, half, f"the box of '{name}'")
            ranges[key] = around(self.rest[name], half + self.doubt[name])
        interface = problem.site.interface
        for key, (address, port) in zip(equations.inputs, interface.inputs.items(), strict=True):
            form = inputs[address]
            low = port.low if form.low is None else max(port.low, below(form.low))
            high = port.high if form.high is None else min(port.high, above(form.high))
            ranges[key] = (low, high)
        return ranges

    def rows(
        self,
        choice: Assumptions,
        algebra: AffineAlgebra,
        states: Mapping[str, Affine],
        drives: Mapping[str, Affine],
        inputs: Mapping[Address, Affine],
        continuous: bool,
    ) -> tuple[list[Affine], list[Affine]]:
        """Return the next states of the plant, or their rates; and the radius of the weights."""
        every = [*(states[name] for name in self.problem.states), *drives.values()]
        count = len(self.problem.states)
        if continuous and not self.is_affine:
            raise NotAffineError("the plant is not affine")
        matrix = self._matrix(self._ranges(choice, algebra, inputs), continuous=continuous)
        rows, radii = [], []
        for k, name in enumerate(self.problem.states):
            row, spread = Affine(ZERO), Affine(ZERO)
            for j, signal in enumerate(every):
                low, high = float_below(matrix[k][j]), float_above(matrix[k][j])
                middle = 0.5 * low + 0.5 * high
                radius = max(Fraction(high) - Fraction(middle), Fraction(middle) - Fraction(low))
                row = row.plus(signal.scaled(Fraction(middle)))
                # A spread from rounding alone needs no gain of its own: it goes into the radius.
                if radius > abs(Fraction(middle)) * Fraction(1, 10**8) and radius > Fraction(
                    1, 10**12
                ):
                    radius *= ROOM_FOR_CHECKER
                    of = self.problem.states[j] if j < count else self.equations.inputs[j - count]
                    words = f"the plant, {name} by {of} in {low:.6g} .. {high:.6g}"
                    row = row.plus(algebra.block(signal.scaled(radius), words))
                    bottom, top = Fraction(middle) - radius, Fraction(middle) + radius
                    algebra.spread.append((k, j, bottom, top))
                elif radius:
                    spread = spread.plus(_magnitudes(signal, radius))
            rows.append(row)
            radii.append(spread)
        return rows, radii

    @precisely
    def _matrix(
        self, ranges: Mapping[str, tuple[float, float]], *, continuous: bool
    ) -> list[list[Any]]:
        """Enclose the slopes of the motion over a period, or of the rates, as the checker does."""
        problem = self.problem
        spans = {
            key: between(exact(low), exact(high)) if math.isfinite(high - low) else exact(0.0)
            for key, (low, high) in ranges.items()
            if key != "t"
        }
        wide = [k for k in self.equations.states if not math.isfinite(ranges[k][1] - ranges[k][0])]
        if wide and not self.is_affine:
            raise NotAffineError("a plant that is not affine needs a box")
        if not self.is_affine:
            spans = around_motion(problem, spans)
        jacobian = jacobian_of(problem, spans)
        return jacobian if continuous else flow_over(jacobian, exact(problem.period))


def _magnitudes(signal: Affine, by: Fraction) -> Affine:
    return Affine(ZERO, {name: abs(weight) * by for name, weight in signal.parts.items()})
