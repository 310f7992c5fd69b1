"""One output of a rule base as straight-line arithmetic."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from fuzzyarm.export.expression import (
    ZERO,
    Assign,
    Expression,
    Local,
    Number,
    Select,
    add,
    divide,
    subtract,
    times,
    without_unused,
)
from fuzzyarm.export.names import Names
from fuzzyarm.export.numbers import ExportError
from fuzzyarm.export.routine import plain
from fuzzyarm.export.sets import (
    CONJUNCTIONS,
    DISJUNCTIONS,
    clipped_union,
    degree_of,
    hedged,
    layered,
    scaled,
    scaled_union,
)
from fuzzyarm.inference.plan import WEIGHTED, OutputPlan, Plan, PlannedRule, plan
from fuzzyarm.model.rulebase import And, Hedge, Hedged, Input, Is, Output, RuleBase, propositions
from fuzzyarm.model.rulebase import Expression as Antecedent

FOLDS = ("max", "sum", "probor")
"""Aggregations that are exported."""

_LONGEST = 16
"""Operands of one expression before it goes into a variable: nesting stays shallow."""

_TABLE_HINT = "leave out --direct to export a table"


@dataclass(frozen=True, eq=False)
class Program:
    """The straight-line arithmetic of one output.

    Attributes
    ----------
    given : tuple of str
        The variables that hold the arguments at the start.
    statements : tuple of Assign
        In order.
    result : Expression
        The output.
    holds : bool
        Whether the last argument is the value to hold where no rule fires.
    """

    given: tuple[str, ...]
    statements: tuple[Assign, ...]
    result: Expression
    holds: bool


def make_program(rulebase: RuleBase, output: str, parameters: Sequence[str]) -> Program:
    """Write down one output of a rule base.

    Parameters
    ----------
    rulebase : RuleBase
        The model.
    output : str
        Which output.
    parameters : sequence of str
        Names of the inputs in the target language, which no variable may have.

    Raises
    ------
    ExportError
        If something of it cannot be exported; the message names it.
    """
    return _Builder(rulebase, output, parameters).build()


def refuse(what: str, hint: str = _TABLE_HINT) -> ExportError:
    """Return the error that names what cannot be exported."""
    return ExportError(f"the direct inference cannot be exported: {what}", hint=hint)


def rule_words(index: int, antecedent: Antecedent) -> str:
    """Return a rule in words, for a comment."""
    words = f"rule {index + 1}: if {_words(antecedent)}"
    return plain(words if len(words) <= 72 else f"{words[:70]} …")


def _words(expression: Antecedent) -> str:
    if isinstance(expression, Is):
        hedges = "".join(f"{hedge.name} " for hedge in expression.hedges)
        return f"{expression.variable} is {hedges}{expression.term}"
    if isinstance(expression, Hedged):
        hedges = "".join(f"{hedge.name} " for hedge in expression.hedges)
        return f"{hedges}({_words(expression.operand)})"
    joined = " and " if isinstance(expression, And) else " or "
    inner = (_words(each) for each in expression.operands)
    return joined.join(
        text if isinstance(each, Is | Hedged) else f"({text})"
        for each, text in zip(expression.operands, inner, strict=True)
    )


class _Builder:
    def __init__(self, rulebase: RuleBase, target: str, parameters: Sequence[str]) -> None:
        self.plan: Plan = plan(rulebase)
        self.target = target
        self.names = Names(taken=set(parameters))
        self.statements: list[Assign] = []
        self.values: dict[str, Expression] = {}
        self.degrees: dict[tuple[str, str, tuple[Hedge, ...]], Expression] = {}
        self.heights: dict[str, dict[int, str]] = {}
        self.sums: dict[str, tuple[str, str]] = {}
        self.guards: list[Expression] = []
        self.parameters = parameters
        self.holds = rulebase.output(target).no_rule == "hold"

    def build(self) -> Program:
        rulebase = self.plan.rulebase
        given = tuple(self.names.new(f"given_{name}") for name in self.parameters)
        for variable, name in zip(rulebase.inputs, given, strict=False):
            self.values[variable.name] = self.fresh(
                _into_range(variable, Local(name), guard_nan=True), variable.name
            )
        held = Local(given[-1]) if self.holds else None
        outputs, rules = self._needed()
        for name in outputs:
            self.heights[name] = {}
            self._check_output(self.plan.outputs[name])
        result: Expression = ZERO
        for step in self.plan.steps:
            if isinstance(step, int) and step in rules:
                self._fire(step, self.plan.rules[step], outputs)
            elif isinstance(step, str) and step in outputs:
                result = self._conclude(self.plan.outputs[step], held)
        for guard in self.guards:
            result = Select(">", guard, ZERO, result, Number(math.nan))
        statements = without_unused(self.statements, result)
        return Program(given, statements, result, self.holds)

    def fresh(self, value: Expression, wanted: str, remark: str = "") -> Expression:
        """Put a value into a new variable, unless it is one already."""
        if isinstance(value, Local | Number):
            return value
        name = self.names.new(wanted)
        self.statements.append(Assign(name, value, remark))
        return Local(name)

    def _needed(self) -> tuple[set[str], set[int]]:
        """Return the outputs and rules that the target depends on."""
        outputs, rules = {self.target}, set[int]()
        while True:
            more = {
                rule
                for name in outputs
                for _, rule in self.plan.outputs[name].contributions
                if self.plan.rules[rule].rule.weight != 0.0
            }
            read = {
                part.variable
                for rule in more
                for part in propositions(self.plan.rules[rule].rule.antecedent)
                if part.variable in self.plan.outputs
            }
            if more == rules and read <= outputs:
                return outputs, rules
            outputs, rules = outputs | read, more

    def _check_output(self, output: OutputPlan) -> None:
        name, way = output.output.name, output.output.defuzzifier
        if output.output.aggregation not in FOLDS:
            raise refuse(f"aggregation {output.output.aggregation} of '{name}'")
        if way.method not in {"centroid", "weighted-average", "weighted-sum"}:
            raise refuse(f"defuzzifier {way.method} of '{name}'")
        if output.discrete:
            return
        if way.resolution is not None:
            raise refuse(
                f"the centroid of '{name}' over {way.resolution} samples",
                "take the exact centroid, or leave out --direct to export a table",
            )
        if output.output.aggregation == "probor":
            raise refuse(f"the exact centroid under aggregation probor of '{name}'")
        kinds = {member.implication for member in output.members}
        if len(kinds) > 1 or not kinds <= {"min", "product"}:
            raise refuse(f"implication {' and '.join(sorted(kinds))} of '{name}'")
        for member in output.members:
            if any(not piece.straight for piece in member.pieces):
                raise refuse(f"term '{member.term.name}' of '{name}' is not straight")
        if kinds == {"min"} and output.closed is None:
            raise refuse(f"too many sets of '{name}' overlap")

    # ── rules ────────────────────────────────────────────────────────────────────────

    def _fire(self, index: int, planned: PlannedRule, outputs: set[str]) -> None:
        if planned.degrees:
            listed = ", ".join(sorted(planned.degrees))
            raise refuse(f"a rule reads '{listed}' as a set of its own block")
        strength = self._truth(planned.rule.antecedent, planned)
        strength = times(strength, Number(planned.rule.weight))
        if planned.threshold > 0.0:
            strength = self.fresh(strength, "s")
            strength = Select(">", strength, Number(planned.threshold), strength, ZERO)
        remark = rule_words(index, planned.rule.antecedent)
        for name in sorted(outputs):
            for member, rule in self.plan.outputs[name].contributions:
                if rule == index:
                    self._add(self.plan.outputs[name], member, strength, remark)

    def _add(self, output: OutputPlan, member: int, strength: Expression, remark: str) -> None:
        name, aggregation = output.output.name, output.output.aggregation
        if aggregation == "sum" and not output.discrete:
            strength = self.fresh(strength, "s", remark)
            part = (
                layered(output.closed.own[member], strength)
                if output.closed is not None
                else scaled(output, member, strength)
            )
            if name not in self.sums:
                self.sums[name] = (self.names.new("area"), self.names.new("moment"))
                for total in self.sums[name]:
                    self.statements.append(Assign(total, ZERO))
            for total, value in zip(self.sums[name], part, strict=True):
                self.statements.append(Assign(total, add(Local(total), value)))
            return
        heights = self.heights[name]
        if member not in heights:
            term = output.members[member].term.name
            heights[member] = self.names.new(f"{name}_{term}")
            value = strength
        else:
            if aggregation == "probor":
                strength = self.fresh(strength, "s")
            value = DISJUNCTIONS[aggregation](Local(heights[member]), strength)
        self.statements.append(Assign(heights[member], value, remark))

    def _truth(self, expression: Antecedent, planned: PlannedRule) -> Expression:
        if isinstance(expression, Is):
            return self._degree(expression)
        if isinstance(expression, Hedged):
            inner = self.fresh(self._truth(expression.operand, planned), "d")
            return hedged(expression.hedges, inner)
        conjunction = isinstance(expression, And)
        norm = (
            CONJUNCTIONS[planned.conjunction] if conjunction else DISJUNCTIONS[planned.disjunction]
        )
        simple = conjunction and planned.conjunction in {"min", "product"}
        simple = simple or (not conjunction and planned.disjunction == "max")
        truth: Expression | None = None
        for number, operand in enumerate(expression.operands, start=1):
            degree = self._truth(operand, planned)
            if not simple:  # the norm names its operands more than once
                degree = self.fresh(degree, "d")
            truth = degree if truth is None else norm(truth, degree)
            if not simple or number % _LONGEST == 0:
                truth = self.fresh(truth, "d")
        assert truth is not None
        return truth

    def _degree(self, part: Is) -> Expression:
        key = (part.variable, part.term, part.hedges)
        if key not in self.degrees:
            plain = (part.variable, part.term, ())
            if plain not in self.degrees:
                term = self.plan.rulebase.variable(part.variable).term(part.term)
                value = degree_of(term, part.variable, self.values[part.variable])
                self.degrees[plain] = self.fresh(value, f"{part.variable}_{part.term}")
            value = self.degrees[plain]
            for hedge in reversed(part.hedges):
                value = self.fresh(hedged((hedge,), value), f"{hedge.name}_{part.term}")
            self.degrees[key] = value
        return self.degrees[key]

    # ── conclusions ──────────────────────────────────────────────────────────────────

    def _conclude(self, output: OutputPlan, held: Expression | None) -> Expression:
        model = output.output
        total, value = self._total_and_value(output)
        value = _into_range(model, self.fresh(value, "value"), guard_nan=False)
        if isinstance(model.no_rule, float | int):
            silent: Expression = Number(float(model.no_rule))
        elif model.no_rule == "hold" and model.name == self.target and held is not None:
            silent = held
        elif model.no_rule == "hold":
            raise refuse(f"'{model.name}' holds its value, and other rules read it")
        else:
            silent = Number(math.nan)
        if model.name != self.target and isinstance(silent, Number) and math.isnan(silent.value):
            self.guards.append(total)
            silent = Number(model.low if math.isfinite(model.low) else 0.0)
        result = Select(">", total, ZERO, value, silent)
        if model.name == self.target:
            return result
        self.values[model.name] = self.fresh(result, model.name)
        return ZERO

    def _total_and_value(self, output: OutputPlan) -> tuple[Expression, Expression]:
        name, method = output.output.name, output.output.defuzzifier.method
        if output.discrete:
            total, weighted = self._weighted(output)
            total, weighted = self.fresh(total, "total"), self.fresh(weighted, "weighted")
            if method == "weighted-sum":
                return total, weighted
            return total, self._quotient(weighted, total)
        if name in self.sums:
            area, moment = self._locals(name)
        else:
            area, moment = self._union(output)
        centre = Number(0.5 * (output.output.low + output.output.high))
        return area, add(centre, self._quotient(moment, area))

    def _locals(self, name: str) -> tuple[Expression, Expression]:
        return Local(self.sums[name][0]), Local(self.sums[name][1])

    @staticmethod
    def _quotient(top: Expression, bottom: Expression) -> Expression:
        """Divide where there is something to divide by; the result is not used elsewhere."""
        return Select(">", bottom, ZERO, divide(top, bottom), ZERO)

    def _union(self, output: OutputPlan) -> tuple[Expression, Expression]:
        heights: dict[int, Expression] = {
            member: Local(name) for member, name in self.heights[output.output.name].items()
        }
        if output.closed is not None:
            parts = clipped_union(output, heights)
        else:
            parts = scaled_union(output, heights, self.fresh)
        names = self.names.new("area"), self.names.new("moment")
        collected = list(parts)
        if not collected:
            return ZERO, ZERO
        for name in names:
            self.statements.append(Assign(name, ZERO))
        for sign, part in collected:
            for name, value in zip(names, part, strict=True):
                combine = add if sign > 0 else subtract
                self.statements.append(Assign(name, combine(Local(name), value)))
        return Local(names[0]), Local(names[1])

    def _weighted(self, output: OutputPlan) -> tuple[Expression, Expression]:
        total: Expression = ZERO
        weighted: Expression = ZERO
        for number, (member, name) in enumerate(self.heights[output.output.name].items(), start=1):
            height = Local(name)
            total = add(total, height)
            weighted = add(weighted, times(height, self._value(output, member)))
            if number % _LONGEST == 0:
                total, weighted = self.fresh(total, "total"), self.fresh(weighted, "weighted")
        return total, weighted

    def _value(self, output: OutputPlan, member: int) -> Expression:
        found = output.members[member]
        if found.value is not None:
            return Number(found.value)
        if found.term.shape.kind != "linear" or output.output.defuzzifier.method not in WEIGHTED:
            raise refuse(f"consequent '{found.term.name}' of '{output.output.name}' is a formula")
        *coefficients, constant = found.term.shape.parameters
        value: Expression = Number(constant)
        for coefficient, variable in zip(coefficients, self.plan.rulebase.inputs, strict=True):
            value = add(value, times(Number(coefficient), self.values[variable.name]))
        return self.fresh(value, found.term.name)


def _into_range(variable: Input | Output, x: Expression, *, guard_nan: bool) -> Expression:
    """Return `x` as the variable says; an input that is NaN counts as the lower end."""
    low, high = variable.low, variable.high
    stand_in = low if math.isfinite(low) else high if math.isfinite(high) else 0.0
    if variable.outside == "extend" or not (math.isfinite(low) and math.isfinite(high)):
        if variable.outside != "extend":
            x = Select("<", x, Number(low), Number(low), x) if math.isfinite(low) else x
            x = Select(">", x, Number(high), Number(high), x) if math.isfinite(high) else x
        return Select("==", x, x, x, Number(stand_in)) if guard_nan else x
    below = Select("<", x, Number(high), x, Number(high))
    return Select(">", x, Number(low), below, Number(low))
