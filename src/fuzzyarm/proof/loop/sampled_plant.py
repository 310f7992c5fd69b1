"""A plant over one control period, its inputs held: its matrices, enclosed.

Equations that are affine are sampled by the matrix exponential. Of others the slopes are bounded
over the box that states and inputs can be in: along the straight way from rest to any point of the
box the motion over a period has slopes within the enclosed ones, so it is linear with gains among
them (mean value theorem). Their spread becomes blocks.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from functools import cached_property

import numpy as np

from fuzzyarm.plant.plant import Address
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.loop.affine import ZERO, Affine, AffineAlgebra, NotAffineError, variable
from fuzzyarm.proof.loop.enclosure import Intervals, matrix_exponential, matrix_product
from fuzzyarm.proof.loop.form import Assumptions
from fuzzyarm.proof.loop.outward import above, around, below, higher, lower
from fuzzyarm.proof.map.laws import JUMPS
from fuzzyarm.symbolic.evaluation import bounds as bounds_of
from fuzzyarm.symbolic.evaluation import gradient
from fuzzyarm.symbolic.nodes import Apply, Node, postorder, symbols

__all__ = ["SampledPlant", "require_still"]


def require_still(problem: LoopProblem) -> None:
    """Refuse equations that change with time, jump, or let an input through at once."""
    equations, name = problem.equations, problem.plant.name
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


ROOM_FOR_CHECKER = Fraction(2)
"""The checker sums a series with intervals, up to 1.7 times as wide as what is found here."""


class SampledPlant:
    """The plant of a loop.

    Parameters
    ----------
    problem : LoopProblem
        The loop.
    rest : mapping of str to Fraction
        Where its states rest.
    """

    def __init__(self, problem: LoopProblem, rest: Mapping[str, Fraction]) -> None:
        self.problem, self.rest = problem, rest
        self.equations = problem.equations

    @cached_property
    def _jacobian(self) -> list[list[Node]]:
        every = (*self.equations.states, *self.equations.inputs)
        return [list(gradient(root, every)) for root in self.equations.rates]

    @cached_property
    def is_affine(self) -> bool:
        """Whether the slopes of the plant are the same everywhere."""
        moving = {*self.equations.states, *self.equations.inputs, "t"}
        return not any(moving & set(symbols(node)) for row in self._jacobian for node in row)

    def _slopes_over(self, ranges: Mapping[str, tuple[float, float]]) -> Intervals:
        """Return bounds of the slopes of the rates by states and inputs."""
        bounds = [[bounds_of(node, ranges) for node in row] for row in self._jacobian]
        low = [[interval.low for interval in row] for row in bounds]
        high = [[interval.high for interval in row] for row in bounds]
        return Intervals.between(low, high)

    def _ranges(
        self, choice: Assumptions, algebra: AffineAlgebra, inputs: Mapping[Address, Affine]
    ) -> dict[str, tuple[float, float]]:
        """Return where states and inputs can be from one sample to the next."""
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
            ranges[key] = around(self.rest[name], half)
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
        ranges = self._ranges(choice, algebra, inputs)
        count = len(self.problem.states)
        if self.is_affine:
            slopes = self._slopes_over(ranges)
            whole = np.zeros((2, len(every), len(every)))
            whole[0, :count], whole[1, :count] = slopes.low, slopes.high
            matrix = slopes
            if not continuous:
                matrix = matrix_exponential(Intervals(*whole), self.problem.period)[:count]
        else:
            if continuous:
                raise NotAffineError("the plant is not affine")
            matrix = self._flow(ranges)
        rows, radii = [], []
        for k, name in enumerate(self.problem.states):
            row, spread = Affine(ZERO), Affine(ZERO)
            for j, signal in enumerate(every):
                low, high = float(matrix.low[k, j]), float(matrix.high[k, j])
                middle = 0.5 * low + 0.5 * high
                radius = max(Fraction(high) - Fraction(middle), Fraction(middle) - Fraction(low))
                row = row.plus(signal.scaled(Fraction(middle)))
                # What rounding alone leaves open is not worth a gain of its own: it goes into the
                # radius.
                if radius > abs(Fraction(middle)) * Fraction(1, 10**8) and radius > Fraction(
                    1, 10**12
                ):
                    if self.is_affine and not continuous:  # parameters are intervals
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

    def _flow(self, ranges: Mapping[str, tuple[float, float]]) -> Intervals:
        """Enclose the slopes of the motion over a period, by states and inputs.

        Y' = J(t) Y with J(t) somewhere among the slopes J over where the motion can be:
        Y(h) = I + ∫J + ∬J J + …, and the k-th term lies in hᵏ/k! Jᵏ as intervals.
        """
        around = self._around_motion(ranges)
        slopes = self._slopes_over(around)
        count, size = slopes.shape
        low, high = np.zeros((size, size)), np.zeros((size, size))
        low[:count], high[:count] = slopes.low, slopes.high
        step = Intervals(low, high) * self.problem.period
        if not np.isfinite(step.size).all():
            raise NotAffineError("the slopes of the plant are not bounded in this box")
        unit = Intervals.at(np.eye(size))
        total, term = unit, unit
        last = 12
        for k in range(1, last + 1):
            term = matrix_product(term, step) / float(k)
            total = total + term
        norm = float(np.max(np.sum(step.size, axis=1))) * (1.0 + 1e-12)
        if norm > last / 2:
            raise NotAffineError("a period is long compared with the plant's motion")
        # Terms fall by more than half from here on: the tail is below twice the next one.
        tail = 2.0 * norm ** (last + 1) / math.factorial(last + 1) * (1.0 + 1e-12)
        total = total + Intervals.between(np.full(unit.shape, -tail), np.full(unit.shape, tail))
        return total[:count]

    def _around_motion(
        self, ranges: Mapping[str, tuple[float, float]]
    ) -> dict[str, tuple[float, float]]:
        """Return a box that no motion leaves within a period which begins in the given one."""
        states = self.equations.states
        h = self.problem.period
        wide = dict(ranges)
        if not all(math.isfinite(end) for key in states for end in ranges[key]):
            raise NotAffineError("a plant that is not affine needs a box")
        for _ in range(20):
            image = {}
            for key, root in zip(states, self.equations.rates, strict=True):
                pace = bounds_of(root, wide)
                low, high = ranges[key]
                image[key] = (
                    lower(low + min(0.0, lower(h * pace.low))),
                    higher(high + max(0.0, higher(h * pace.high))),
                )
            if all(wide[k][0] <= image[k][0] and image[k][1] <= wide[k][1] for k in states):
                return wide  # Picard's operator takes this box into itself
            for k in states:
                low, high = image[k]
                more = 0.05 * (high - low) * 0.1 + 1e-12
                wide[k] = (min(wide[k][0], low - more), max(wide[k][1], high + more))
        raise NotAffineError("the motion within a period was not enclosed")


def _magnitudes(signal: Affine, by: Fraction) -> Affine:
    return Affine(ZERO, {name: abs(weight) * by for name, weight in signal.parts.items()})
