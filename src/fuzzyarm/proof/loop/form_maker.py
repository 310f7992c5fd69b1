"""The construction of a loop's form: its rest, then one period around it in affine forms."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from itertools import product

from flint import fmpq_mat

from fuzzyarm.plant.plant import Address, Port
from fuzzyarm.proof.check.certificate import Evidence
from fuzzyarm.proof.check.loop import rest_within
from fuzzyarm.proof.check.numbers import ends, exact
from fuzzyarm.proof.check.rules import RuleSurfaces
from fuzzyarm.proof.check.walk import ProgramWalk
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.loop.affine import (
    ONE,
    ZERO,
    Affine,
    AffineAlgebra,
    MovingError,
    NotAffineError,
    number,
    variable,
)
from fuzzyarm.proof.loop.conclusions import Conclusions
from fuzzyarm.proof.loop.form import Assumptions, Form, row_of
from fuzzyarm.proof.loop.outward import exact_bounds
from fuzzyarm.proof.loop.period import LoopPeriod
from fuzzyarm.proof.loop.resting import rest_in_floats, unread_state
from fuzzyarm.proof.loop.sampled_plant import SampledPlant, require_still
from fuzzyarm.proof.map.bounds import UnprovableError
from fuzzyarm.proof.stop import Stop, check_time
from fuzzyarm.symbolic.nodes import Symbol
from fuzzyarm.symbolic.operations import Interval

DOUBT = 1e-9
"""Largest assumed error of a rest found in floats."""

MOST_OPEN = 6
"""Most parameters with all corners evaluated."""

WIDENINGS, WIDER = 16, 1.02
"""Widenings of the interval of a rest, and the factor of each."""

FARTHEST = 1e100
"""Radius of an interval of a rest beyond which it is not widened any more."""


class FormMaker:
    """Builds forms of one loop, with a cache of proved bounds of its rule bases.

    Parameters
    ----------
    problem : LoopProblem
        The loop.
    stop : Stop, optional
        The time budget.

    Attributes
    ----------
    rest : dict of str to Fraction
        The rest of states and memory.
    doubt : dict of str to Fraction
        Largest distance of a true rest from there, over all parameters of the plant.
    begin : dict of str to float
        The memory before the first period; NaN if it starts as its first reading.
    memory : list of str
        The moving memory.
    is_exact : bool
        Whether the rest is exact; else it is irrational, or depends on parameters.

    Raises
    ------
    LoopProofError
        If the loop is not covered, or no rest is found.
    """

    def __init__(self, problem: LoopProblem, stop: Stop | None = None) -> None:
        self.problem = problem
        require_still(problem)
        self.equations = problem.equations
        self._conclusions = Conclusions(stop or Stop())
        self.begin = dict(LoopPeriod(problem, self._algebra(Assumptions())).memory)
        # The excess over a limit is 0 while no limit is active: not a state of the form.
        self.fixed = [name for name in self.begin if " excess " in name]
        self.memory = [name for name in self.begin if name not in self.fixed]
        self.is_exact = True
        self.rest = self._rest()
        self.doubt = dict.fromkeys(self.rest, ZERO)
        if not self.is_exact or self._moves_with_parameters():
            self._find_doubt()
        self.plant = SampledPlant(problem, self.rest, self.doubt)

    def _algebra(self, choice: Assumptions, *, is_search: bool = False) -> AffineAlgebra:
        of = self._conclusions
        rules = of.resting if is_search else of.concluding(choice)
        table = of.resting_table if is_search else of.tabled(choice)
        return AffineAlgebra(rules, table, grip=choice.grip, is_search=is_search)

    # --- the loop over affine forms ---

    def _one_period(
        self, algebra: AffineAlgebra, states: Mapping[str, Affine]
    ) -> tuple[dict[Address, Affine], dict[str, Affine], dict[Address, Affine]]:
        """Return inputs of the plant, memory and outputs of a period."""
        period = LoopPeriod(self.problem, algebra)
        outputs = self._outputs(algebra, states)
        memory = {name: states[name] for name in period.memory if name in states}
        memory |= {name: number(period.memory[name]) for name in self.fixed}
        inputs, after = period.run(outputs, memory)
        for name in self.fixed:
            successor = after.pop(name)
            if not successor.is_constant or successor.constant != period.memory[name]:
                raise NotAffineError("an anti-windup counts while a limit holds")
        return inputs, after, outputs

    def _outputs(
        self, algebra: AffineAlgebra, states: Mapping[str, Affine]
    ) -> dict[Address, Affine]:
        """Return the outputs of the plant."""
        values = self._plant_values(states)
        roots = zip(self.problem.site.interface.outputs, self.equations.outputs, strict=True)
        return {address: algebra.expression(root, values) for address, root in roots}

    def _plant_values(self, states: Mapping[str, Affine]) -> dict[str, Affine]:
        equations, problem = self.equations, self.problem
        values = {key: number(value) for key, value in problem.constants.items()}
        values |= {
            key: states[name] for key, name in zip(equations.states, problem.states, strict=True)
        }
        return values

    # --- rest ---

    def _rest(self) -> dict[str, Fraction]:
        """Return the exact rest of states and memory."""
        names = [*self.problem.states, *self.memory]
        if not SampledPlant(self.problem, {}, {}).is_affine:
            return self._rest_at_set_point(names) or self._rest_in_floats()
        rest: dict[str, Fraction] | None = None
        why = LoopProofError("the loop does not rest anywhere that is known")
        try:
            rest = self._rest_of_affine(names, dict.fromkeys(names, ZERO))
            if self._rests_at(rest):
                return rest
        except LoopProofError as error:
            why = error
        # The inputs of the rules are not 0 at rest, as if they read a measured value.
        try:
            near = self._rest_in_floats()
            return self._rest_on_pieces(names, near) or near
        except LoopProofError:
            if rest is None:
                raise why from None
            # The form itself will report any obstacle there.
            self.is_exact = self._conclusions.is_exact = self._conclusions.at_zero = True
            return rest

    def _rests_at(self, rest: Mapping[str, Fraction]) -> bool:
        """Return whether rates of the plant and changes of memory are exactly 0 at a point."""
        algebra = self._algebra(Assumptions(), is_search=True)
        states = {name: number(value) for name, value in rest.items()}
        inputs, after, _ = self._one_period(algebra, states)
        moves = self._rates(algebra, states, inputs)
        moves += [after[name].plus(states[name].scaled(-ONE)) for name in self.memory]
        return not any(move.constant for move in moves)

    def _rest_on_pieces(
        self, names: Sequence[str], near: Mapping[str, Fraction]
    ) -> dict[str, Fraction] | None:
        """Return the exact rest near one in floats, if rules are linear there; else None."""
        size = max(map(abs, near.values()), default=ZERO)
        rest = {name: ZERO if abs(x) <= size * Fraction(1e-12) else x for name, x in near.items()}
        with suppress(LoopProofError, UnprovableError):
            rest = self._rest_of_affine(names, rest)
            if self._rests_at(rest):
                self.is_exact = self._conclusions.is_exact = True
                return rest
        return None

    def _rest_in_floats(self) -> dict[str, Fraction]:
        of = self._conclusions
        self.is_exact = of.is_exact = of.at_zero = False
        near = rest_in_floats(self.problem, self.memory, self._conclusions.near)
        return {name: Fraction(value) for name, value in near.items()}

    # --- a rest known by an interval ---

    def _moves_with_parameters(self) -> bool:
        """Return whether the rest of the plant depends on its parameters."""
        problem = self.problem
        if not any(span.low < span.high for span in problem.parameters.values()):
            return False
        algebra = self._algebra(Assumptions(), is_search=True)
        states = {name: number(value) for name, value in self.rest.items()}
        inputs, _, _ = self._one_period(algebra, states)
        ranges = self._point_ranges(states, inputs)
        return any(any(exact_bounds(root, ranges)) for root in self.equations.rates)

    def _find_doubt(self) -> None:
        """Fill in an interval that contains the rests of all parameters: midpoint and radius."""
        of = self._conclusions
        self.is_exact = of.is_exact = of.at_zero = False
        rests = [self.rest, *map(self._new_rest, self._corners())]
        ends = {n: (min(r[n] for r in rests), max(r[n] for r in rests)) for n in self.rest}
        self.rest = {name: (low + high) / 2 for name, (low, high) in ends.items()}
        least = {n: Fraction(DOUBT) * max(abs(x), ONE) for n, x in self.rest.items()}
        self.doubt = {name: (b - a) / 2 + least[name] for name, (a, b) in ends.items()}
        names = self._program_names
        surfaces = RuleSurfaces()
        # Krawczyk's operator lets gains vary in their intervals, and returns a wider one. Memory
        # that follows a state moves as far as that does.
        for _ in range(WIDENINGS):
            box = {name: (x, self.doubt[name]) for name, x in self.rest.items()}
            found = rest_within(self.problem, Evidence(names, box, (), (), ONE, {}), surfaces)
            if max(found.values()) > FARTHEST:
                break
            wide = {n: max(least[n], Fraction(x * WIDER)) for n, x in found.items()}
            if all(x < self.doubt[name] for name, x in found.items()):
                return
            self.doubt = {name: max(x, wide[name]) for name, x in self.doubt.items()}
        if len(rests) == 1:
            return  # the checker will say so
        raise LoopProofError(
            "where the plant rests depends on its parameters",
            hint="narrower intervals of them, as in 'with R in 5 .. 5.1', or a claim about a"
            " bounded time for all of them, as in 'during 0 .. 10 ms'",
        )

    def _corners(self) -> list[dict[str, float]]:
        """Return the corners of open parameters; of many, the ends of each alone."""
        spans = self.problem.parameters
        free = {name: span for name, span in spans.items() if span.low < span.high}
        if len(free) > MOST_OPEN:
            return [{name: x} for name, span in free.items() for x in (span.low, span.high)]
        corners = product(*((span.low, span.high) for span in free.values())) if free else ()
        return [dict(zip(free, corner, strict=True)) for corner in corners]

    def _new_rest(self, values: Mapping[str, float]) -> dict[str, Fraction]:
        points = {name: Interval(x, x) for name, x in values.items()}
        problem = replace(self.problem, parameters={**self.problem.parameters, **points})
        near = rest_in_floats(problem, self.memory, self._conclusions.near)
        return {name: Fraction(value) for name, value in near.items()}

    def rest_with(self, values: Mapping[str, float]) -> Mapping[str, Fraction]:
        """Return the rest for given values of parameters."""
        return self.rest if self.is_exact else self._new_rest(values)

    def _rest_of_affine(
        self, names: Sequence[str], near: Mapping[str, Fraction]
    ) -> dict[str, Fraction]:
        """Return the rest of the loop with the rules' linear law around a point."""
        algebra = self._algebra(Assumptions(), is_search=True)
        states = {name: variable(name, near[name]) for name in names}
        inputs, after, _ = self._one_period(algebra, states)
        rates = self._rates(algebra, states, inputs)
        residuals = [*rates, *(after[name].plus(states[name].scaled(-ONE)) for name in self.memory)]
        solution = solved(residuals, names)
        if solution is None:
            read = {name for residual in residuals for name in residual.parts}
            raise unread_state([name for name in self.problem.states if name not in read]) or (
                LoopProofError("the loop does not rest at one point: its equations leave it open")
            )
        return {name: near[name] + x for name, x in zip(names, solution, strict=True)}

    def _rates(
        self,
        algebra: AffineAlgebra,
        states: Mapping[str, Affine],
        inputs: Mapping[Address, Affine],
    ) -> list[Affine]:
        values = self._plant_values(states)
        values |= dict(zip(self.equations.inputs, inputs.values(), strict=True))
        return [algebra.expression(root, values) for root in self.equations.rates]

    def _rest_at_set_point(self, names: Sequence[str]) -> dict[str, Fraction] | None:
        """Return the set point of a nonlinear plant, and 0, if it rests there."""
        problem, interface = self.problem, self.problem.site.interface
        rest = dict.fromkeys(names, ZERO)
        for address, root in zip(interface.outputs, self.equations.outputs, strict=True):
            for key, name in zip(self.equations.states, problem.states, strict=True):
                if isinstance(root, Symbol) and root.name == key:
                    rest[name] = Fraction(problem.set_point[address])
        try:
            return rest if self._rests_at(rest) else None
        except NotAffineError:
            return None

    # --- the form ---

    def form(self, choice: Assumptions, *, continuous: bool = False) -> Form:
        """Return the loop as matrices; NotAffineError, UnprovableError: not covered."""
        algebra = self._algebra(choice)
        if continuous and self.memory:
            raise NotAffineError(
                f"a loop that remembers '{self.memory[0]}' runs in periods, not in continuous time",
                hint="leave out --continuous",
            )
        names = [*self.problem.states, *self.memory]
        states = {name: variable(name, self.rest[name], self.doubt[name]) for name in names}
        try:
            inputs, after, outputs = self._one_period(algebra, states)
            for name in self.memory:
                if self.is_exact and after[name].constant != self.rest[name]:
                    raise MovingError(f"'{name}' moves")
        except MovingError as error:
            raise self._no_equilibrium(error.message) from None
        self._require_bounded(algebra, outputs)
        deviations = {name: variable(name) for name in names}
        drives = {f"u{k}": form.deviation for k, form in enumerate(inputs.values())}
        if self.is_exact:
            self._check_rest(algebra, states, inputs)
        rows, radius = self.plant.rows(choice, algebra, deviations, drives, inputs, continuous)
        rows += [after[name].deviation for name in self.memory]
        count = len(algebra.blocks)
        size = len(names)
        matrix = [row_of(row, names, count) for row in rows]
        spread = [row_of(row, names, count) for row in radius]
        spread += [(ZERO,) * (size + count)] * len(self.memory)  # rows of memory are exact
        return Form(
            tuple(names),
            dict(self.rest),
            tuple(row[:size] for row in matrix),
            tuple(row[size:] for row in matrix),
            tuple(spread),
            tuple(row_of(block.v, names, count) for block in algebra.blocks),
            tuple(block.words for block in algebra.blocks),
            tuple(algebra.bounds),
            {**outputs, **inputs},
            self._seeds,
            0.0 if continuous else self.problem.period,
            self._evidence(choice, algebra),
            tuple(row_of(x, names, count) for x, _ in algebra.inputs),
            tuple(edge for _, edge in algebra.inputs),
            choice.signs,
        )

    def _require_bounded(self, algebra: AffineAlgebra, outputs: Mapping[Address, Affine]) -> None:
        """Record that outputs stay within their bounds, beyond which a run counts as diverged.

        A bound that a plant leaves open is far away, and left to the checker.
        """
        for address, port in self.problem.site.interface.outputs.items():
            if port.bound >= Port.bound:
                continue
            room = Fraction(port.bound) - abs(outputs[address].constant) - outputs[address].doubt
            if room > 0:
                label = self.problem.site.interface.label(address)
                algebra.require(outputs[address], -room, room, f"the bound of '{label}'")

    def _evidence(self, choice: Assumptions, algebra: AffineAlgebra) -> Evidence:
        """Return the certificate's description of this form."""
        return Evidence(
            self._program_names,
            {name: (x, self.doubt[name]) for name, x in self.rest.items()},
            tuple(algebra.gains),
            tuple(algebra.spread),
            choice.grip,
            {} if self.plant.is_affine else dict(choice.box),
        )

    def _no_equilibrium(self, why: str) -> NotAffineError:
        """Return the error of a loop without equilibrium at its set points."""
        label, points = self.problem.site.interface.label, self.problem.set_point
        at = ", ".join(f"{label(port)} = {value:g}" for port, value in points.items())
        return NotAffineError(
            f"there is no equilibrium{f' at {at}' if at else ''}: {why}",
            hint="`at PORT = X` gives set points that the loop can hold" if at else "",
        )

    def _check_rest(
        self,
        algebra: AffineAlgebra,
        states: Mapping[str, Affine],
        inputs: Mapping[Address, Affine],
    ) -> None:
        """Raise unless the plant rests."""
        at = {name: number(state.constant) for name, state in states.items()}
        forms = {name: number(form.constant) for name, form in inputs.items()}
        if any(rate.constant for rate in self._rates(algebra, at, forms)):
            raise LoopProofError(
                "the plant does not rest where the controller does",
                hint="a bias must balance it to the last digit; an integral finds the rest",
            )

    def _point_ranges(
        self, at: Mapping[str, Affine], driven: Mapping[Address, Affine]
    ) -> dict[str, tuple[Fraction, Fraction]]:
        equations, problem = self.equations, self.problem
        ranges = {"t": (ZERO, ZERO)}
        for key, name in zip(equations.states, problem.states, strict=True):
            ranges[key] = (at[name].constant, at[name].constant)
        for key, form in zip(equations.inputs, driven.values(), strict=True):
            ranges[key] = (form.constant, form.constant)
        for key, span in zip(equations.parameters, problem.parameters.values(), strict=True):
            ranges[key] = (Fraction(span.low), Fraction(span.high))
        return ranges

    @cached_property
    def _program_names(self) -> dict[str, str]:
        return _program_names(self.problem, self.memory)

    @cached_property
    def _seeds(self) -> dict[str, Affine]:
        """Memory that starts as its first reading, as a function of the plant's states."""
        algebra = self._algebra(Assumptions(), is_search=True)
        states = {name: variable(name, self.rest[name]) for name in self.problem.states}
        period = LoopPeriod(self.problem, algebra)
        begun = {name: value for name, value in period.memory.items() if math.isnan(value)}
        if not begun:
            return {}
        outputs = self._outputs(algebra, states)
        inputs, after = period.run(outputs, {}, first=True)
        # The first period leaves such memory unchanged. Whether it may have had that value before,
        # too, is tested: both periods must be the same.
        seeds = {name: after[name] for name in begun}
        before = {n: number(x) for n, x in period.memory.items() if not math.isnan(x)}
        again = period.run(outputs, {**before, **seeds})
        if again != (inputs, after):
            raise NotAffineError(f"'{next(iter(begun))}' has a start of its own")
        return seeds


def _program_names(problem: LoopProblem, memory: Sequence[str]) -> dict[str, str]:
    """Return the program's names of memory: a guess, which the checker proves."""
    states = [
        name
        for name in ProgramWalk(problem).states
        if name.startswith("state:") and not name.endswith("_excess")
    ]
    # Both list sources in the order of the lines.
    program = iter(states)
    names = {}
    for name in memory:
        label, _, kind = name.partition(" ")
        if kind.startswith(("late ", "pending ")):
            queue, number = kind.split()
            names[name] = f"{queue}:{label}:{number}"
        elif kind in ("sensed before", "sensed slope"):
            names[name] = f"{kind.removeprefix('sensed ')}:{label}"
        elif kind == "driven":
            names[name] = f"driven:{label}"
        else:
            names[name] = next(program, "")
    return names


def solved(rows: Sequence[Affine], names: Sequence[str]) -> list[Fraction] | None:
    """Solve rows = 0 in rationals; None unless there is exactly one solution."""
    check_time()
    size = len(names)
    weights = [exact(x) for row in rows for x in row_of(row, names, 0)]
    constants = [exact(-row.constant) for row in rows]
    try:
        found = fmpq_mat(size, size, weights).solve(fmpq_mat(size, 1, constants))
    except ZeroDivisionError:
        return None
    return [ends(x)[0] for x in found.entries()]
