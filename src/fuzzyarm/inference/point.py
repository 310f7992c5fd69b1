"""The engine for one point, in plain Python: no array library, only the rules that fire.

Used for scalars, for ``expect`` lines and for traces. One array operation costs more than
a whole inference takes here.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import product
from typing import Any, NamedTuple

from fuzzyarm.inference.defuzzify import defuzzify_at_point
from fuzzyarm.inference.errors import (
    MissingInputError,
    NoRuleFiredError,
    NotANumberError,
    NothingHeldError,
    OutsideRangeError,
    UnknownNameError,
)
from fuzzyarm.inference.partition import cut_at_corners
from fuzzyarm.inference.plan import Plan, PlannedRule, plan
from fuzzyarm.inference.prepared import remembered
from fuzzyarm.inference.sets import term_function
from fuzzyarm.language.model.rulebase import (
    And,
    Expression,
    Hedge,
    Hedged,
    Is,
    Output,
    RuleBase,
    Variable,
    propositions,
)
from fuzzyarm.language.model.shapes import apply_hedges, straight_lines
from fuzzyarm.symbolic.kinds import SNORMS, TNORMS
from fuzzyarm.symbolic.lines import StraightShape

# --- The terms of one variable that hold at a position, found by bisection ---
#
# At a position only a few terms of a variable are not zero. Straight terms are therefore cut
# at all their corners once; a value then finds its cell and evaluates that cell's lines.

Degree = tuple[int, float]


class NumberedProposition(NamedTuple):
    """A term with its hedges, under its number in the rules."""

    number: int
    lines: StraightShape | None
    function: Callable[[float], float]


class Propositions:
    """The propositions about one variable.

    Parameters
    ----------
    propositions : sequence of NumberedProposition
        In any order.
    """

    def __init__(self, propositions: Sequence[NumberedProposition]) -> None:
        curved = [proposition for proposition in propositions if proposition.lines is None]
        self._curved = tuple((curve.number, curve.function) for curve in curved)
        cut = cut_at_corners(
            [
                (proposition.number, proposition.lines)
                for proposition in propositions
                if proposition.lines
            ]
        )
        self._edges = cut.edges
        self._at = [list(degrees.items()) for degrees in cut.at]
        self._cells = [
            tuple((number, *line) for number, line in cell.items()) for cell in cut.cells
        ]

    def at(self, x: float) -> list[Degree]:
        """Return (number, degree) of every proposition that is not zero at `x`."""
        edges = self._edges
        i = bisect_right(edges, x)
        if i and edges[i - 1] == x:
            degrees = self._at[i - 1]
        else:
            degrees = [
                (n, degree)
                for n, height, x_0, slope in self._cells[i]
                if (degree := height + (x - x_0) * slope) > 0.0
            ]
        if self._curved:
            degrees = degrees + [(n, degree) for n, f in self._curved if (degree := f(x)) > 0.0]
        return degrees


# --- Evaluation ---

Key = tuple[str, str, tuple[Hedge, ...]]


class Point:
    """The state of the evaluation of one point.

    Attributes
    ----------
    values : dict of str to float
        Inputs (brought into their ranges) and the outputs so far.
    degrees : list of float
        Of every proposition, by number.
    active : dict of str to list of (int, float)
        For each variable, the propositions about it that are not zero.
    fired : dict of str to list of (int, float)
        For each output, (member, strength) of the rules that fired.
    silent : set of str
        Outputs for which no rule fired.
    """

    __slots__ = ("active", "degrees", "fired", "silent", "values")

    def __init__(self, propositions: int, outputs: Iterable[str]) -> None:
        self.values: dict[str, float] = {}
        self.degrees = [0.0] * propositions
        self.active: dict[str, list[tuple[int, float]]] = {}
        self.fired: dict[str, list[tuple[int, float]]] = {name: [] for name in outputs}
        self.silent: set[str] = set()


class _Conjunction(NamedTuple):
    """A rule that is a plain conjunction: its propositions, weight and consequents."""

    rule: int
    numbers: tuple[int, ...]
    weight: float
    norm: Callable[[float, float], float]
    threshold: float


_Action = Callable[[Point], None]


class PointEngine:
    """A rule base compiled to closures; call :meth:`evaluate`.

    Parameters
    ----------
    rulebase : RuleBase
        Anything that :func:`fuzzyarm.inference.plan.plan` accepts.
    """

    def __init__(self, rulebase: RuleBase) -> None:
        self.plan: Plan = plan(rulebase)
        self._inputs = rulebase.inputs
        self._names = tuple(variable.name for variable in rulebase.inputs)
        self._numbers: dict[Key, int] = {}
        self._consequents = self._rule_members()
        self._steps = self._compile_steps()
        self._fuzzifiers = self._make_fuzzifiers()
        self._input_steps = tuple(
            (v.name, v.low, v.high, v.outside, self._fuzzifiers.get(v.name)) for v in self._inputs
        )

    # ── preparation ──────────────────────────────────────────────────────────────────

    def _rule_members(self) -> list[list[tuple[str, int]]]:
        members: list[list[tuple[str, int]]] = [[] for _ in self.plan.rules]
        for name, output in self.plan.outputs.items():
            for index, (member, rule) in enumerate(output.contributions):
                members[rule].append((name, index if output.in_order else member))
        return members

    def _number(self, part: Is) -> int:
        key = (part.variable, part.term, part.hedges)
        return self._numbers.setdefault(key, len(self._numbers))

    def _make_fuzzifiers(self) -> dict[str, Propositions]:
        by_variable: dict[str, list[NumberedProposition]] = {}
        for (variable, term, hedges), number in self._numbers.items():
            shape = self.plan.rulebase.variable(variable).term(term).shape
            lines, function = straight_lines(shape, hedges), term_function(shape, hedges)
            by_variable.setdefault(variable, []).append(
                NumberedProposition(number, lines, function)
            )
        return {name: Propositions(group) for name, group in by_variable.items()}

    def _compile_steps(self) -> list[_Action]:
        actions: list[_Action] = []
        waiting: list[int] = []
        for step in self.plan.steps:
            if isinstance(step, int) and _is_conjunction(self.plan.rules[step]):
                waiting.append(step)
                continue
            if waiting:
                actions += self._compile_conjunctions(waiting)
                waiting = []
            if isinstance(step, str):
                actions.append(self._compile_output(step))
            else:
                actions.append(self._compile_rule(step))
        return actions + self._compile_conjunctions(waiting)

    def _compile_conjunctions(self, rules: list[int]) -> list[_Action]:
        """Index conjunctions by their propositions: only those that fire are visited."""
        families: dict[tuple[str, ...], dict[tuple[int, ...], list[_Conjunction]]] = {}
        for index in rules:
            planned = self.plan.rules[index]
            parts = list(propositions(planned.rule.antecedent))
            numbers = tuple(self._number(part) for part in parts)
            weight, norm = planned.rule.weight, TNORMS[planned.conjunction].scalar
            entry = _Conjunction(index, numbers, weight, norm, planned.threshold)
            order = sorted(range(len(parts)), key=lambda i: (parts[i].variable, i))
            variables = tuple(parts[i].variable for i in order)
            key = tuple(numbers[i] for i in order)
            families.setdefault(variables, {}).setdefault(key, []).append(entry)
        return [self._visit(variables, table) for variables, table in families.items()]

    def _visit(
        self, variables: tuple[str, ...], table: dict[tuple[int, ...], list[_Conjunction]]
    ) -> _Action:
        fire = self._fire

        def visit(point: Point) -> None:
            lists = [[n for n, _ in point.active[variable]] for variable in variables]
            if math.prod(map(len, lists)) > len(table):
                for entries in table.values():
                    fire(point, entries)
                return
            for key in product(*lists):
                if key in table:
                    fire(point, table[key])

        return visit

    def _fire(self, point: Point, entries: list[_Conjunction]) -> None:
        degrees, fired = point.degrees, point.fired
        for rule, numbers, weight, norm, threshold in entries:
            strength = degrees[numbers[0]]
            for number in numbers[1:]:
                strength = norm(strength, degrees[number])
            strength *= weight
            if strength > threshold:
                for output, member in self._consequents[rule]:
                    fired[output].append((member, strength))

    def _compile_rule(self, index: int) -> _Action:
        planned = self.plan.rules[index]
        truth = self._compile_expression(planned.rule.antecedent, planned)
        weight, consequents = planned.rule.weight, self._consequents[index]
        threshold = planned.threshold

        def visit(point: Point) -> None:
            strength = truth(point) * weight
            if strength > threshold:
                for output, member in consequents:
                    point.fired[output].append((member, strength))

        return visit

    def _compile_expression(
        self, expression: Expression, planned: PlannedRule
    ) -> Callable[[Point], float]:
        if isinstance(expression, Is):
            if expression.variable in planned.degrees:
                return self._compile_degree(expression)
            number = self._number(expression)
            return lambda point: point.degrees[number]
        if isinstance(expression, Hedged):
            inner, hedges = self._compile_expression(expression.operand, planned), expression.hedges
            return lambda point: apply_hedges(hedges, inner(point))
        norm = (
            TNORMS[planned.conjunction].scalar
            if isinstance(expression, And)
            else SNORMS[planned.disjunction].scalar
        )
        first, *rest = [
            self._compile_expression(operand, planned) for operand in expression.operands
        ]

        def combine(point: Point) -> float:
            degree = first(point)
            for compiled in rest:
                degree = norm(degree, compiled(point))
            return degree

        return combine

    def _compile_degree(self, part: Is) -> Callable[[Point], float]:
        """How far the rules so far assert a term of an output of the same block."""
        output = self.plan.outputs[part.variable]
        members = {i for i, member in enumerate(output.members) if member.term.name == part.term}
        if output.in_order:
            members = {i for i, (m, _) in enumerate(output.contributions) if m in members}
        norm = SNORMS[output.output.aggregation].scalar

        def degree(point: Point) -> float:
            total = 0.0
            for member, strength in sorted(point.fired[part.variable]):
                if member in members:
                    total = norm(total, strength)
            return apply_hedges(part.hedges, min(1.0, total))  # a sum may exceed a degree

        return degree

    def _compile_output(self, name: str) -> _Action:
        output_plan = self.plan.outputs[name]
        output = output_plan.output

        def conclude(point: Point) -> None:
            fired = point.fired[name]
            if output_plan.in_order:  # so far with the index of their contributions
                contributions = output_plan.contributions
                fired = [(contributions[i][0], strength) for i, strength in sorted(fired)]
                point.fired[name] = fired
            value = (
                defuzzify_at_point(output_plan, fired, point.values, self._names) if fired else None
            )
            if value is not None and math.isnan(value):
                if not stands_in_for_nan(output):
                    where = _written(point.values, self._names)
                    raise NotANumberError(name, f"has none at {where}")
                value = None
            if value is None:
                point.silent.add(name)
                point.values[name] = self._no_rule(output, point)
            else:
                point.values[name] = bring_into_range(output, value)
            fuzzifier = self._fuzzifiers.get(name)
            if fuzzifier is not None:
                self._fuzzify(point, name, fuzzifier)

        return conclude

    # ── evaluation ───────────────────────────────────────────────────────────────────

    def _no_rule(self, output: Output, point: Point) -> float:
        if isinstance(output.no_rule, float | int):
            return float(output.no_rule)
        if output.no_rule == "hold":
            last_value = point.values.get(_held_name(output.name))
            if last_value is None:
                raise NothingHeldError(output.name)
            return last_value
        inputs = {name: point.values[name] for name in self._names}
        raise NoRuleFiredError(output.name, inputs)

    @staticmethod
    def _fuzzify(point: Point, name: str, fuzzifier: Propositions) -> None:
        degrees = fuzzifier.at(point.values[name])
        point.active[name] = degrees
        for number, degree in degrees:
            point.degrees[number] = degree

    def _take(self, point: Point, inputs: Mapping[str, float]) -> None:
        """Bring the inputs into their ranges and fuzzify them."""
        values, degrees = point.values, point.degrees
        for name, low, high, outside, fuzzifier in self._input_steps:
            try:
                value = inputs[name]
            except KeyError:
                check_names(inputs, self._names)
                raise MissingInputError(n for n in self._names if n not in inputs) from None
            if type(value) is not float:
                value = number_of(name, value)
            if not low <= value <= high:
                value = _outside(name, value, low, high, outside)
            values[name] = value
            if fuzzifier is not None:
                point.active[name] = active = fuzzifier.at(value)
                for number, degree in active:
                    degrees[number] = degree
        if len(inputs) > len(values):
            check_names(inputs, self._names)

    def strength(self, rule: int, point: Point) -> float:
        """Return how far a rule fired at a point that :meth:`run` returned.

        Parameters
        ----------
        rule : int
            Index among all rules.
        point : Point
            From :meth:`run`.
        """
        planned = self.plan.rules[rule]
        truth = self._compile_expression(planned.rule.antecedent, planned)
        strength = truth(point) * planned.rule.weight
        return strength if strength > planned.threshold else 0.0

    @property
    def chained(self) -> tuple[str, ...]:
        """Outputs whose values later rules use."""
        return tuple(name for name in self.plan.outputs if name in self._fuzzifiers)

    def run(self, inputs: Mapping[str, float], held: Mapping[str, float] | None = None) -> Point:
        """Evaluate one point and return all intermediate values."""
        point = Point(len(self._numbers), self.plan.outputs)
        self._take(point, inputs)
        if held:
            check_names(held, self.plan.outputs, what="output")
            for name, value in held.items():
                point.values[_held_name(name)] = float(value)
        for step in self._steps:
            step(point)
        return point

    def evaluate(
        self, inputs: Mapping[str, float], held: Mapping[str, float] | None = None
    ) -> dict[str, float]:
        """Return every output by name at one point.

        Parameters
        ----------
        inputs : mapping of str to float
            A value for every input, by name.
        held : mapping of str to float, optional
            Last values of outputs that hold where no rule fires.

        Returns
        -------
        dict of str to float
            In the order of the model.

        Raises
        ------
        InferenceError
            For names that are unknown or missing and values that are not numbers.
        NoRuleFiredError
            If no rule fires for an output that has no value for that case.
        """
        values = self.run(inputs, held).values
        return {name: values[name] for name in self.plan.outputs}


def _held_name(name: str) -> str:
    return f"\0held {name}"


def _is_conjunction(planned: PlannedRule) -> bool:
    """Whether a rule is ``a and b and …`` of different variables, so that 0 of one is 0."""
    antecedent = planned.rule.antecedent
    if planned.degrees:
        return False
    if isinstance(antecedent, Is):
        return True
    if not isinstance(antecedent, And):
        return False
    if not all(isinstance(operand, Is) for operand in antecedent.operands):
        return False
    variables = [part.variable for part in propositions(antecedent)]
    return len(set(variables)) == len(variables)


def check_names(requested: Iterable[str], valid: Iterable[str], *, what: str = "input") -> None:
    """Raise UnknownNameError for the first name of `requested` that is not among `valid`."""
    names = tuple(valid)
    for name in requested:
        if name not in names:
            raise UnknownNameError(name, names, what=what)


def _outside(name: str, value: float, low: float, high: float, outside: str) -> float:
    if math.isnan(value):
        raise NotANumberError(name)
    if outside == "clamp":
        return low if value < low else high
    if outside == "error":
        raise OutsideRangeError(name, value, low, high)
    if math.isinf(value):
        raise NotANumberError(name, f"is infinite ({value})")
    return value


def stands_in_for_nan(output: Output) -> bool:
    """Whether the value for no rule also stands in where a formula has none.

    That is so where it is held, or NaN itself: such an output may be without a value.
    """
    no_rule = output.no_rule
    return no_rule == "hold" or (isinstance(no_rule, float) and math.isnan(no_rule))


def bring_into_range(variable: Variable, value: float) -> float:
    """Return `value` as `variable.outside` says: clamped, as it is, or an error."""
    if variable.low <= value <= variable.high:
        return value
    return _outside(variable.name, value, variable.low, variable.high, variable.outside)


def _written(values: Mapping[str, float], names: tuple[str, ...]) -> str:
    return ", ".join(f"{name} = {values[name]:.6g}" for name in names)


@remembered
def prepare(rulebase: RuleBase) -> PointEngine:
    """Compile a rule base for evaluation point by point; the last few are remembered.

    Parameters
    ----------
    rulebase : RuleBase
        The model.

    Returns
    -------
    PointEngine
        Stateless: evaluating it leaves no trace in it.
    """
    return PointEngine(rulebase)


# ── inputs as a caller gives them ────────────────────────────────────────────────────


def holds_arrays(inputs: Mapping[str, Any]) -> bool:
    """Whether any input is an array."""
    return any(not isinstance(value, float | int) and _is_array(value) for value in inputs.values())


def number_of(name: str, value: Any) -> float:
    """Return the value of an input; raise NotANumberError where it is not a number.

    Text is not a number, even if it is digits: input from a file or a form must be parsed first.
    """
    kind = getattr(getattr(value, "dtype", None), "kind", "")
    if not isinstance(value, str | bytes | bytearray) and kind not in ("U", "S"):
        try:
            return float(value)
        except (TypeError, ValueError, OverflowError):
            pass
    raise NotANumberError(name, f"is not a number: {value!r}")


def _is_array(value: object) -> bool:
    """Whether an input is many values."""
    return isinstance(value, list | tuple) or getattr(value, "ndim", 0) > 0
