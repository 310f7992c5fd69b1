"""A closed loop around its rest: a linear part, uncertain gains, and where both are the loop.

    z' = A z + B w (each period, or as a rate),   |wₖ| ≤ |Cₖ z + Dₖ w|,   low ≤ g z + h w ≤ high

z is how far states and memory are from rest, w are the answers of the blocks. All matrices are
rational; what a matrix exponential leaves unknown is a radius beside A and B. That this is the
loop, within the bounds, is what a certificate stands on; the search reads the same numbers as
floats and is not trusted.

A plant whose equations are affine is sampled exactly. Of another one the slopes are bounded over
the box that it can be in: along the straight way from rest to any point of the box the motion over
a period has slopes within the enclosed ones, so it is linear with gains among them (mean value
theorem). Their spread becomes blocks.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property

import numpy as np

from fuzzyarm.closed_loop.affine import (
    ONE,
    ZERO,
    Affine,
    AffineAlgebra,
    Block,
    Bound,
    NotAffineError,
    number,
    variable,
)
from fuzzyarm.closed_loop.enclosure import Intervals, matrix_exponential, matrix_product
from fuzzyarm.closed_loop.problem import ControlPeriod, LoopProblem, LoopProofError
from fuzzyarm.expression.evaluation import bounds as bounds_of
from fuzzyarm.expression.evaluation import gradient
from fuzzyarm.expression.nodes import Node
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.plant.plant import Address
from fuzzyarm.proof.arithmetic import Stop
from fuzzyarm.proof.bounds import UnprovableError
from fuzzyarm.proof.prover import Prover
from fuzzyarm.proof.sector import NoSectorError, sector, slopes_at
from fuzzyarm.table import LookupTable

__all__ = ["Choice", "Form", "FormMaker", "Matrix"]

Matrix = tuple[tuple[Fraction, ...], ...]


@dataclass(frozen=True)
class Choice:
    """What a form may take for granted; the smaller, the nearer to linear it is.

    Attributes
    ----------
    share : Fraction
        Of the universes of rule bases: how far their inputs may go.
    grip : Fraction
        What limits leave of a signal's deviation; 1: they are not reached.
    box : dict of str to Fraction
        By state of the plant, how far it may be from rest; empty for a plant that is affine.
    along : bool
        Whether a rule base is a gain times the sum of its inputs that its linear law has, or a sum
        of slopes of its own along each input.
    """

    share: Fraction = ONE
    grip: Fraction = ONE
    box: Mapping[str, Fraction] = field(default_factory=dict)
    along: bool = True


@dataclass(frozen=True)
class Form:
    """A loop as matrices; see the head of this module.

    Attributes
    ----------
    names : tuple of str
        Of z: states of the plant, then what controller, sensors and actuators remember.
    rest : dict of str to Fraction
        Of each of them.
    a, b : matrix of Fraction, shapes (n, n) and (n, m)
        Of the next z, or of its rate.
    radius : matrix of Fraction, shape (n, n + m)
        How far the true ``[a b]`` may be from these numbers.
    blocks : tuple of (row of Fraction)
        ``[Cₖ Dₖ]`` of each block; Dₖ reads the answers of blocks before it only.
    words : tuple of str
        What each block is.
    bounds : tuple of Bound
        Where the form is the loop.
    outputs : dict of (str, str) to Affine
        Outputs and inputs of the plant, by axis and port.
    seeds : dict of str to Affine
        What memory that starts with what it sees is, by states of the plant.
    period : float
        s; 0 for a loop in continuous time.
    """

    names: tuple[str, ...]
    rest: Mapping[str, Fraction]
    a: Matrix
    b: Matrix
    radius: Matrix
    blocks: Matrix
    words: tuple[str, ...]
    bounds: tuple[Bound, ...]
    outputs: Mapping[Address, Affine]
    seeds: Mapping[str, Affine]
    period: float

    @property
    def size(self) -> int:
        """How many states."""
        return len(self.names)

    def row(self, signal: Affine) -> tuple[Fraction, ...]:
        """Return the weights of z and w in a signal."""
        return _row(signal, self.names, len(self.blocks))

    def rows_within(self) -> list[tuple[tuple[Fraction, ...], Fraction, str]]:
        """Return rows g over z alone with |g z| ≤ limit, which say that all bounds hold.

        An answer is linear in its gain δ, so the largest value is at δ = -1 or 1 of each block.
        """
        found = []
        for bound in self.bounds:
            limit = min(abs(end) for end in (bound.low, bound.high) if end is not None)
            for row in _without_answers(self.row(bound.signal), self.size, self.blocks):
                found.append((row, limit, bound.words))
        return list(dict.fromkeys(found))


def _row(signal: Affine, names: Sequence[str], answers: int) -> tuple[Fraction, ...]:
    every = [*names, *(f"w{k}" for k in range(answers))]
    if unknown := set(signal.parts) - set(every):
        raise LoopProofError(f"a signal depends on {', '.join(sorted(unknown))}")
    return tuple(signal.parts.get(name, ZERO) for name in every)


def _without_answers(
    row: tuple[Fraction, ...], size: int, blocks: Matrix
) -> list[tuple[Fraction, ...]]:
    last = next((k for k in range(len(row) - 1, size - 1, -1) if row[k]), None)
    if last is None:
        return [row[:size]]
    answered = blocks[last - size]
    rows = []
    for sign in (-1, 1):
        weight = sign * row[last]
        with_it = [r + weight * v for r, v in zip(row[:last], answered[:last], strict=True)] + [
            ZERO
        ] * (len(row) - last)
        rows += _without_answers(tuple(with_it), size, blocks)
    return rows


# ── how it is made ───────────────────────────────────────────────────────────────────


class FormMaker:
    """Makes forms of one loop; what has been proved of its rule bases is kept.

    Parameters
    ----------
    problem : LoopProblem
        The loop.
    stop : Stop, optional
        When to give up.

    Raises
    ------
    LoopProofError
        If the loop is not covered, or does not rest anywhere that is known.
    """

    def __init__(self, problem: LoopProblem, stop: Stop | None = None) -> None:
        self.problem = problem
        self.stop = stop or Stop()
        self._known: dict[object, object] = {}
        self.equations = problem.equations
        self.fixed = [name for name in self._memory_names() if " excess " in name]
        self.rest = self._rest()

    def _memory_names(self) -> list[str]:
        return list(ControlPeriod(self.problem, self._algebra(Choice())).memory)

    def _algebra(self, choice: Choice, *, is_search: bool = False) -> AffineAlgebra:
        rules = self._resting if is_search else self._concluding(choice)
        table = self._resting_table if is_search else self._tabled(choice)
        return AffineAlgebra(rules, table, grip=choice.grip, is_search=is_search)

    # --- the loop as it is, over affine forms ---

    def _one_period(
        self, algebra: AffineAlgebra, states: Mapping[str, Affine], *, first: bool = False
    ) -> tuple[
        dict[Address, Affine], dict[str, Affine], dict[Address, Affine], ControlPeriod[Affine]
    ]:
        """Return inputs of the plant, memory and outputs of a period."""
        period = ControlPeriod(self.problem, algebra)
        values = self._plant_values(states)
        outputs = {
            address: algebra.expression(root, values)
            for address, root in zip(
                self.problem.site.interface.outputs, self.equations.outputs, strict=True
            )
        }
        memory = {name: states[name] for name in period.memory if name in states}
        memory |= {name: number(period.memory[name]) for name in self.fixed}
        inputs, after = period.run(outputs, {} if first else memory, first=first)
        for name in self.fixed:
            left = after.pop(name)
            if not first and (not left.is_constant or left.constant != period.memory[name]):
                raise NotAffineError("an anti-windup counts while a limit holds")
        return inputs, after, outputs, period

    def _plant_values(self, states: Mapping[str, Affine]) -> dict[str, Affine]:
        equations, problem = self.equations, self.problem
        values = {"t": number(0.0)}
        values |= {
            key: states[name] for key, name in zip(equations.states, problem.states, strict=True)
        }
        for key, at in zip(equations.parameters, problem.parameters.values(), strict=True):
            values[key] = number(0.5 * at.low + 0.5 * at.high)
        return values

    @property
    def memory(self) -> list[str]:
        """What is remembered and moves."""
        return [name for name in self._memory_names() if name not in self.fixed]

    @property
    def begin(self) -> dict[str, float]:
        """What is remembered before the first period; NaN for what begins as it first sees."""
        return dict(ControlPeriod(self.problem, self._algebra(Choice())).memory)

    # --- rest ---

    def _rest(self) -> dict[str, Fraction]:
        """Return where the loop rests: states and memory, exactly."""
        names = [*self.problem.states, *self.memory]
        try:
            return self._rest_of_affine(names)
        except NotAffineError:
            return self._rest_at_set_point(names)

    def _rest_of_affine(self, names: Sequence[str]) -> dict[str, Fraction]:
        algebra = self._algebra(Choice(), is_search=True)
        states = {name: variable(name) for name in names}
        inputs, after, _, _ = self._one_period(algebra, states)
        rates = self._rates(algebra, states, inputs)
        left = [*rates, *(after[name].plus(states[name].scaled(-ONE)) for name in self.memory)]
        solution = _solved(left, names)
        if solution is None:
            raise LoopProofError("the loop does not rest at one point: its equations leave it open")
        return dict(zip(names, solution, strict=True))

    def _rates(
        self,
        algebra: AffineAlgebra,
        states: Mapping[str, Affine],
        inputs: Mapping[Address, Affine],
    ) -> list[Affine]:
        values = self._plant_values(states)
        values |= dict(zip(self.equations.inputs, inputs.values(), strict=True))
        return [algebra.expression(root, values) for root in self.equations.rates]

    def _rest_at_set_point(self, names: Sequence[str]) -> dict[str, Fraction]:
        """Return the rest of a plant that is not affine: its set point and 0, if it rests there."""
        problem, interface = self.problem, self.problem.site.interface
        rest = dict.fromkeys(names, ZERO)
        for address, root in zip(interface.outputs, self.equations.outputs, strict=True):
            for key, name in zip(self.equations.states, problem.states, strict=True):
                if root.__class__.__name__ == "Symbol" and getattr(root, "name", "") == key:
                    rest[name] = Fraction(problem.set_point[address])
        algebra = self._algebra(Choice(), is_search=True)
        states = {name: number(value) for name, value in rest.items()}
        inputs, after, _, _ = self._one_period(algebra, states)
        moves = self._rates(algebra, states, inputs)
        moves += [after[name].plus(states[name].scaled(-ONE)) for name in self.memory]
        if any(each.constant for each in moves):
            raise LoopProofError(
                "the loop does not rest at its set point with everything else at 0",
                hint="of a plant that is not affine that is the rest which is looked at",
            )
        return rest

    # --- rule bases and tables ---

    def _prover(self, sheet: RuleBase, output: str) -> Prover:
        key = "prover", id(sheet), output
        if key not in self._known:
            self._known[key] = Prover(sheet, output)
        prover = self._known[key]
        assert isinstance(prover, Prover)
        prover.stop = self.stop
        if prover.model is None:
            raise LoopProofError(
                f"'{sheet.name}' is not made of straight pieces: {prover.reason}",
                hint="compile it to a table, interpolated linearly",
            )
        return prover

    def _resting(
        self, algebra: AffineAlgebra, sheet: RuleBase, inputs: Mapping[str, Affine]
    ) -> list[Affine]:
        """Return the linear law of a rule base, which has the same rest: inputs are 0 there."""
        found = []
        for output in sheet.outputs:
            prover = self._prover(sheet, output.name)
            at = {n: each.constant if each.is_constant else ZERO for n, each in inputs.items()}
            total = number(self._value_at(prover, at))
            slopes = slopes_at(prover, {name: float(x) for name, x in at.items()})
            for name, each in inputs.items():
                if not each.is_constant:
                    low, high = slopes.around(name)
                    total = total.plus(each.scaled((low + high) / 2))
            found.append(Affine(total.constant, total.parts))
        return found

    def _value_at(self, prover: Prover, at: Mapping[str, Fraction]) -> Fraction:
        for variable_, low, high in self._universes(prover):
            if not low <= at[variable_] <= high:
                raise LoopProofError(f"at rest '{variable_}' is outside its universe")
        value = prover.exactly(at)
        if value is None:
            raise LoopProofError("no rule fires at rest")
        return Fraction(value)

    @staticmethod
    def _universes(prover: Prover) -> list[tuple[str, Fraction, Fraction]]:
        found = []
        for each in prover.inputs:
            if not (math.isfinite(each.low) and math.isfinite(each.high)):
                raise LoopProofError(f"the input '{each.name}' of a rule base has no end")
            found.append((each.name, Fraction(each.low), Fraction(each.high)))
        return found

    def _concluding(self, choice: Choice):  # type: ignore[no-untyped-def]
        def rules(
            algebra: AffineAlgebra, sheet: RuleBase, inputs: Mapping[str, Affine]
        ) -> list[Affine]:
            return [
                self._conclusion(choice, algebra, sheet, output.name, inputs)
                for output in sheet.outputs
            ]

        return rules

    def _conclusion(
        self,
        choice: Choice,
        algebra: AffineAlgebra,
        sheet: RuleBase,
        output: str,
        inputs: Mapping[str, Affine],
    ) -> Affine:
        """Return an output as a known gain and blocks, around its inputs at rest."""
        prover = self._prover(sheet, output)
        rest = {name: each.constant for name, each in inputs.items()}
        value = self._value_at(prover, rest)
        region: dict[str, tuple[float, float]] = {}
        for name, low, high in self._universes(prover):
            if inputs[name].is_constant:
                region[name] = (float(rest[name]), float(rest[name]))
                continue
            half = choice.share * min(high - rest[name], rest[name] - low)
            half = half if half <= 0 else Fraction(_ends(half, low=True))
            if half <= 0:
                raise LoopProofError(f"at rest '{name}' is at the end of its universe")
            region[name] = _around(rest[name], half)
            algebra.require(inputs[name], -half, half, f"'{name}' of {sheet.name}")
        if prover.without_value(region) is not None:
            raise LoopProofError(f"'{sheet.name}' has no rule for some of its inputs near rest")
        along = None
        if choice.along and not any(rest.values()) and value == 0:
            along = self._sector(prover, region, [n for n in inputs if not inputs[n].is_constant])
        if along is not None:
            weights, low, high = along
            sigma = Affine(ZERO)
            for name, weight in weights.items():
                sigma = sigma.plus(inputs[name].deviation.scaled(weight))
            parts = self._gain(algebra, sigma, low, high, f"{sheet.name}, a gain in")
        else:
            parts = Affine(ZERO)
            for name, each in inputs.items():
                if not each.is_constant:
                    low, high = self._slopes(prover, region, name)
                    words = f"{sheet.name}, its slope along {name} in"
                    parts = parts.plus(self._gain(algebra, each.deviation, low, high, words))
        ends = self._range(prover, region)
        return Affine(value, parts.parts, *ends)

    @staticmethod
    def _gain(
        algebra: AffineAlgebra, signal: Affine, low: Fraction, high: Fraction, words: str
    ) -> Affine:
        """Return a signal times a gain between two numbers."""
        middle, radius = (low + high) / 2, (high - low) / 2
        found = signal.scaled(middle)
        if radius:
            words = f"{words} {float(low):.6g} .. {float(high):.6g}"
            found = found.plus(algebra.block(signal.scaled(radius), words))
        return found

    def _sector(
        self, prover: Prover, region: Mapping[str, tuple[float, float]], names: Sequence[str]
    ) -> tuple[dict[str, Fraction], Fraction, Fraction] | None:
        """Return the sector along the linear law: weights, least and greatest gain; or None."""
        key = "sector", id(prover), tuple(region.items())
        if key not in self._known:
            self._known[key] = self._new_sector(prover, region, names)
        return self._known[key]  # type: ignore[return-value]

    def _new_sector(
        self, prover: Prover, region: Mapping[str, tuple[float, float]], names: Sequence[str]
    ) -> tuple[dict[str, Fraction], Fraction, Fraction] | None:
        try:
            slopes = slopes_at(prover, {})
            weights = {}
            for name in names:
                low, high = slopes.around(name)
                ahead = slopes.along({name: ONE})
                weights[name] = ahead if ahead is not None else (low + high) / 2
            if not all(weights.values()):
                return None
            found = sector(prover, weights, region)
        except (NoSectorError, UnprovableError):
            return None
        if found.slack or not found.complete:
            return None
        return weights, Fraction(found.low), Fraction(found.high)

    def _slopes(
        self, prover: Prover, region: Mapping[str, tuple[float, float]], name: str
    ) -> tuple[Fraction, Fraction]:
        key = "slope", id(prover), name, tuple(region.items())
        if key not in self._known:
            found = prover.slope(region, name)
            self._known[key] = Fraction(found.low), Fraction(found.high)
        return self._known[key]  # type: ignore[return-value]

    def _range(
        self, prover: Prover, region: Mapping[str, tuple[float, float]]
    ) -> tuple[Fraction, Fraction]:
        key = "range", id(prover), tuple(region.items())
        if key not in self._known:
            found = prover.value(region)
            self._known[key] = Fraction(found.low), Fraction(found.high)
        return self._known[key]  # type: ignore[return-value]

    def _resting_table(
        self, algebra: AffineAlgebra, sheet: LookupTable, inputs: Mapping[str, Affine]
    ) -> Affine:
        at = [float(each.constant) if each.is_constant else 0.0 for each in inputs.values()]
        return number(float(sheet.lookup(*at)))

    def _tabled(self, choice: Choice):  # type: ignore[no-untyped-def]
        def table(
            algebra: AffineAlgebra, sheet: LookupTable, inputs: Mapping[str, Affine]
        ) -> Affine:
            return _table_form(choice, algebra, sheet, inputs)

        return table

    # --- the form ---

    def form(self, choice: Choice, *, continuous: bool = False) -> Form:
        """Return the loop as matrices.

        Parameters
        ----------
        choice : Choice
            What may be taken for granted.
        continuous : bool
            As if the controller ran without a period: of one without memory.

        Raises
        ------
        NotAffineError
            If the loop is not covered.
        UnprovableError
            If a rule base is not.
        """
        algebra = self._algebra(choice)
        if continuous and self.memory:
            raise NotAffineError(f"in continuous time it has no {self.memory[0]}")
        names = [*self.problem.states, *self.memory]
        states = {name: variable(name, self.rest[name]) for name in names}
        inputs, after, outputs, period = self._one_period(algebra, states)
        for name in self.memory:
            if after[name].constant != self.rest[name]:
                raise NotAffineError(f"{name} does not rest")
        deviations = {name: variable(name) for name in names}
        drives = {f"u{k}": each.deviation for k, each in enumerate(inputs.values())}
        self._check_rest(algebra, states, inputs)
        rows, radius = self._plant_rows(choice, algebra, deviations, drives, inputs, continuous)
        rows += [after[name].deviation for name in self.memory]
        count = len(algebra.blocks)
        size = len(names)
        matrix = [_row(row, names, count) for row in rows]
        spread = [_row(row, names, count) for row in radius]
        spread += [(ZERO,) * (size + count)] * len(self.memory)
        return Form(
            tuple(names),
            dict(self.rest),
            tuple(row[:size] for row in matrix),
            tuple(row[size:] for row in matrix),
            tuple(spread),
            tuple(_row(each.v, names, count) for each in algebra.blocks),
            tuple(each.words for each in algebra.blocks),
            tuple(algebra.bounds),
            {**outputs, **inputs},
            self._seeds(choice),
            0.0 if continuous else self.problem.period,
        )

    def _check_rest(
        self,
        algebra: AffineAlgebra,
        states: Mapping[str, Affine],
        inputs: Mapping[Address, Affine],
    ) -> None:
        """Make sure that the plant rests, whatever its parameters are."""
        at = {name: number(each.constant) for name, each in states.items()}
        driven = {name: number(each.constant) for name, each in inputs.items()}
        if any(each.constant for each in self._rates(algebra, at, driven)):
            raise LoopProofError("the plant does not rest where the controller does")
        if any(each.low < each.high for each in self.problem.parameters.values()):
            ranges = self._point_ranges(at, driven)
            for root in self.equations.rates:
                low, high = _exact_bounds(root, ranges)
                if low or high:
                    raise LoopProofError("where the plant rests depends on its parameters")

    def _point_ranges(
        self, at: Mapping[str, Affine], driven: Mapping[Address, Affine]
    ) -> dict[str, tuple[Fraction, Fraction]]:
        equations, problem = self.equations, self.problem
        ranges = {"t": (ZERO, ZERO)}
        for key, name in zip(equations.states, problem.states, strict=True):
            ranges[key] = (at[name].constant, at[name].constant)
        for key, each in zip(equations.inputs, driven.values(), strict=True):
            ranges[key] = (each.constant, each.constant)
        for key, span in zip(equations.parameters, problem.parameters.values(), strict=True):
            ranges[key] = (Fraction(span.low), Fraction(span.high))
        return ranges

    def _seeds(self, choice: Choice) -> dict[str, Affine]:
        """Return memory that starts as what it first sees, by states of the plant."""
        algebra = self._algebra(choice, is_search=True)
        states = {name: variable(name, self.rest[name]) for name in self.problem.states}
        period = ControlPeriod(self.problem, algebra)
        begun = {name: value for name, value in period.memory.items() if math.isnan(value)}
        if not begun:
            return {}
        values = self._plant_values(states)
        outputs = {
            address: algebra.expression(root, values)
            for address, root in zip(
                self.problem.site.interface.outputs, self.equations.outputs, strict=True
            )
        }
        inputs, after = period.run(outputs, {}, first=True)
        # What starts so has remembered what it saw: its first period leaves it. That it is as if
        # it had remembered that before, too, is tried: both periods must be the same.
        seeds = {name: after[name] for name in begun}
        before = {n: number(x) for n, x in period.memory.items() if not math.isnan(x)}
        again = period.run(outputs, {**before, **seeds})
        if again != (inputs, after):
            raise NotAffineError(f"'{next(iter(begun))}' starts in a way of its own")
        return seeds

    # --- the plant ---

    def _jacobian(self) -> list[list[Node]]:
        if "jacobian" not in self._known:
            equations = self.equations
            every = (*equations.states, *equations.inputs)
            self._known["jacobian"] = [list(gradient(root, every)) for root in equations.rates]
        return self._known["jacobian"]  # type: ignore[return-value]

    @cached_property
    def is_affine(self) -> bool:
        """Whether the slopes of the plant are the same everywhere."""
        from fuzzyarm.expression.nodes import symbols

        moving = {*self.equations.states, *self.equations.inputs, "t"}
        return not any(moving & set(symbols(each)) for row in self._jacobian() for each in row)

    def _slopes_over(self, ranges: Mapping[str, tuple[float, float]]) -> Intervals:
        """Return bounds of the slopes of the rates by states and inputs."""
        found = [[bounds_of(each, ranges) for each in row] for row in self._jacobian()]
        low = [[each.low for each in row] for row in found]
        high = [[each.high for each in row] for row in found]
        return Intervals.between(low, high)

    def _ranges(
        self, choice: Choice, algebra: AffineAlgebra, inputs: Mapping[Address, Affine]
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
            ranges[key] = _around(self.rest[name], half)
        interface = problem.site.interface
        for key, (address, port) in zip(equations.inputs, interface.inputs.items(), strict=True):
            each = inputs[address]
            low = port.low if each.low is None else max(port.low, _down(each.low))
            high = port.high if each.high is None else min(port.high, _up(each.high))
            ranges[key] = (low, high)
        return ranges

    def _plant_rows(
        self,
        choice: Choice,
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
                if radius > abs(Fraction(middle)) * Fraction(1, 10**8) and radius > Fraction(
                    1, 10**12
                ):
                    of = self.problem.states[j] if j < count else self.equations.inputs[j - count]
                    words = f"the plant, {name} by {of} in {low:.6g} .. {high:.6g}"
                    row = row.plus(algebra.block(signal.scaled(radius), words))
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
            raise NotAffineError("a period is long beside the plant's motion")
        # Terms fall by more than half from here on: the tail is below twice the next one.
        tail = 2.0 * norm ** (last + 1) / math.factorial(last + 1) * (1.0 + 1e-12)
        total = total + Intervals.between(np.full(unit.shape, -tail), np.full(unit.shape, tail))
        return total[:count]

    def output_between_samples(
        self, output: str, reach: Mapping[str, float]
    ) -> tuple[float, float]:
        """Return where an output can be from one sample to the next, for states within a reach.

        Parameters
        ----------
        output : str
            A port of the plant.
        reach : mapping of str to float
            By state, how far it is from rest at the sample.
        """
        equations, problem = self.equations, self.problem
        interface = problem.site.interface
        ranges = {"t": (-math.inf, math.inf)}
        for key, span in zip(equations.parameters, problem.parameters.values(), strict=True):
            ranges[key] = (span.low, span.high)
        for key, name in zip(equations.states, problem.states, strict=True):
            ranges[key] = _around(self.rest[name], Fraction(reach[name]))
        for key, port in zip(equations.inputs, interface.inputs.values(), strict=True):
            ranges[key] = (port.low, port.high)
        moving = self._around_motion(ranges)
        at = list(interface.outputs).index(interface.port(output))
        low, high = bounds_of(equations.outputs[at], moving)
        return low, high

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
            moved = {}
            for key, root in zip(states, self.equations.rates, strict=True):
                pace = bounds_of(root, wide)
                low, high = ranges[key]
                moved[key] = (
                    _lower(low + min(0.0, _lower(h * pace.low))),
                    _higher(high + max(0.0, _higher(h * pace.high))),
                )
            if all(wide[k][0] <= moved[k][0] and moved[k][1] <= wide[k][1] for k in states):
                return wide  # Picard's operator takes this box into itself
            for k in states:
                low, high = moved[k]
                more = 0.05 * (high - low) * 0.1 + 1e-12
                wide[k] = (min(wide[k][0], low - more), max(wide[k][1], high + more))
        raise NotAffineError("the motion within a period was not enclosed")


def _magnitudes(signal: Affine, by: Fraction) -> Affine:
    return Affine(ZERO, {name: abs(weight) * by for name, weight in signal.parts.items()})


def _lower(x: float) -> float:
    return math.nextafter(math.nextafter(x, -math.inf), -math.inf)


def _higher(x: float) -> float:
    return math.nextafter(math.nextafter(x, math.inf), math.inf)


def _down(x: Fraction) -> float:
    return _lower(float(x))


def _up(x: Fraction) -> float:
    return _higher(float(x))


def _around(rest: Fraction, half: Fraction) -> tuple[float, float]:
    """Return an interval that holds rest ± half."""
    return _ends(rest - half, low=True), _ends(rest + half, low=False)


def _ends(x: Fraction, *, low: bool) -> float:
    near = float(x)
    if Fraction(near) == x:
        return near
    return _lower(near) if low else _higher(near)


def _exact_bounds(
    root: Node, ranges: Mapping[str, tuple[Fraction, Fraction]]
) -> tuple[Fraction, Fraction]:
    """Return bounds of an expression in rationals: exactly 0 where that is a factor."""
    from fuzzyarm.expression.nodes import Apply, Constant, Symbol, postorder

    found: dict[Node, tuple[Fraction, Fraction]] = {}
    for node in postorder(root):
        if isinstance(node, Constant):
            found[node] = (Fraction(node.value), Fraction(node.value))
        elif isinstance(node, Symbol):
            found[node] = ranges[node.name]
        else:
            assert isinstance(node, Apply)
            found[node] = _exact_operation(node.operation, [found[a] for a in node.arguments])
    return found[root]


def _exact_operation(
    operation: str, arguments: list[tuple[Fraction, Fraction]]
) -> tuple[Fraction, Fraction]:
    a = arguments[0]
    b = arguments[1] if len(arguments) > 1 else a
    if operation == "add":
        return a[0] + b[0], a[1] + b[1]
    if operation == "subtract":
        return a[0] - b[1], a[1] - b[0]
    if operation == "negative":
        return -a[1], -a[0]
    if operation in ("multiply", "divide"):
        if operation == "divide":
            if b[0] <= 0 <= b[1]:
                raise NotAffineError("a division by a parameter that may be 0")
            b = (1 / b[1], 1 / b[0])
        products = [x * y for x in a for y in b]
        return min(products), max(products)
    if operation in ("minimum", "maximum") and len(arguments) == 2:
        pick = min if operation == "minimum" else max
        return pick(a[0], b[0]), pick(a[1], b[1])
    zero = {"sin": 0, "cos": 1, "tan": 0, "sqrt": 0}
    if operation in zero and a == (ZERO, ZERO):
        return (Fraction(zero[operation]),) * 2
    raise NotAffineError(f"'{operation}' of a parameter at rest")


def _solved(rows: Sequence[Affine], names: Sequence[str]) -> list[Fraction] | None:
    """Solve rows = 0 in rationals; None where that is not one point."""
    matrix = [[*_row(each, names, 0), -each.constant] for each in rows]
    size = len(names)
    for column in range(size):
        pivot = next((k for k in range(column, size) if matrix[k][column]), None)
        if pivot is None:
            return None
        matrix[column], matrix[pivot] = matrix[pivot], matrix[column]
        head = matrix[column]
        for k in range(size):
            if k != column and matrix[k][column]:
                factor = matrix[k][column] / head[column]
                matrix[k] = [x - factor * y for x, y in zip(matrix[k], head, strict=True)]
    return [matrix[k][size] / matrix[k][k] for k in range(size)]


def _table_form(
    choice: Choice, algebra: AffineAlgebra, sheet: LookupTable, inputs: Mapping[str, Affine]
) -> Affine:
    """Return a table that is interpolated as slopes along each input, around rest."""
    if sheet.default_mode != "linear":
        raise LoopProofError(f"a table with steps ('{sheet.default_mode}') jumps at rest")
    rest = [float(each.constant) for each in inputs.values()]
    if any(Fraction(x) != each.constant for x, each in zip(rest, inputs.values(), strict=True)):
        raise LoopProofError("a table at rest between floats")
    values = np.asarray(sheet.values, float)
    total = Affine(ZERO)
    for number_, (axis, (name, each)) in enumerate(zip(sheet.axes, inputs.items(), strict=True)):
        if each.is_constant:
            continue
        levels = np.asarray(axis.levels, float)
        half = Fraction(
            float(
                choice.share
                * min(
                    Fraction(float(levels[-1])) - each.constant,
                    each.constant - Fraction(float(levels[0])),
                )
            )
        )
        if half <= 0:
            raise LoopProofError(f"at rest '{name}' is at the end of its table")
        algebra.require(each, -half, half, f"'{name}' of a table")
        steps = Intervals.at(np.moveaxis(values, number_, -1))
        slopes = (steps[..., 1:] - steps[..., :-1]) / (
            Intervals.at(levels[1:]) - Intervals.at(levels[:-1])
        )
        low, high = Fraction(float(slopes.low.min())), Fraction(float(slopes.high.max()))
        total = total.plus(
            FormMaker._gain(
                algebra, each.deviation, low, high, f"a table, its slope along {name} in"
            )
        )
    value = Fraction(float(sheet.lookup(*rest)))
    ends = Fraction(float(values.min())), Fraction(float(values.max()))
    return Affine(value, total.parts, *ends)
