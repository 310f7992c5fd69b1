"""One output of a rule base as one expression, with the names of its parts in C.

The expression is the whole truth: its values over arrays are the model of the exported function,
and :mod:`fuzzyarm.exchange.export.listing` writes it in C. The names beside it mark the variables
there: the degrees, the firing strengths, the growing heights.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from fuzzyarm.exchange.export.numbers import stand_ins
from fuzzyarm.exchange.export.routine import plain
from fuzzyarm.exchange.export.samples import SampleSums, sample_sums
from fuzzyarm.exchange.export.sets import (
    ZERO,
    Part,
    clipped,
    clipped_union,
    degree_of,
    hedged,
    minus,
    most_overlapping,
    plus,
    refuse,
    scaled,
    scaled_union,
    times,
    where,
    with_ends,
)
from fuzzyarm.exchange.export.walk import DefuzzifierWalk, Listed
from fuzzyarm.inference import block as at
from fuzzyarm.inference.block import NotCoveredError
from fuzzyarm.inference.errors import InferenceError
from fuzzyarm.inference.firing_intervals import LOWER, UPPER
from fuzzyarm.inference.plan import OutputPlan, Plan, PlannedRule, needed, plan
from fuzzyarm.inference.sets import Piece, formula_of
from fuzzyarm.inference.single_output import lay_out_output
from fuzzyarm.inference.weighted import is_rising
from fuzzyarm.language.model.rulebase import And, Hedge, Hedged, Input, Is, Output, RuleBase
from fuzzyarm.language.model.rulebase import Expression as Antecedent
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.evaluation import Schedule, evaluate_arrays, schedule, specialise
from fuzzyarm.symbolic.formulas import CONSTANTS
from fuzzyarm.symbolic.identifiers import Names
from fuzzyarm.symbolic.kinds import SHAPES, SNORMS, TNORMS
from fuzzyarm.symbolic.nodes import (
    Apply,
    Constant,
    Node,
    Symbol,
    constant,
    postorder,
    replace,
    symbol,
)
from fuzzyarm.symbolic.printing import Assign

MOST_SAMPLES = 100_000
"""Constants of a centroid over samples."""


WALKED = frozenset({"top", "area", "ends"})
"""Views of numbers, as walks over tables."""

SAMPLED = "defuzzifier centroid(101)"
"""Views of any sets, by their samples."""

_LONGEST = 16
"""Operands of one expression before it goes into a variable: nesting stays shallow."""


@dataclass(frozen=True, eq=False)
class Call:
    """A part of a program that C computes by its own function."""

    stem: str  # the name of the function, if it is free
    body: Node  # its value as a function of the symbol ``h``
    argument: Node  # the argument for ``h``


@dataclass(frozen=True, eq=False)
class OutputProgram:
    """The arithmetic of one output."""

    symbols: tuple[str, ...]  # the symbols of the arguments
    result: Node  # the output, of these symbols and of the sums over samples
    # The parts of `result` that have variables, in order. A name that comes again belongs to
    # a part that grows out of the one before: a sum, a greatest value. It is read as a variable
    # after its last mention, which need not add anything.
    variables: tuple[Assign | SampleSums | DefuzzifierWalk, ...]
    calls: Mapping[Node, Call]  # parts printed as calls of functions
    holds: bool  # whether the last argument is the value to hold

    @property
    def walks(self) -> tuple[DefuzzifierWalk, ...]:
        """The walks over tables, in order."""
        return tuple(
            variable for variable in self.variables if isinstance(variable, DefuzzifierWalk)
        )

    @property
    def sums(self) -> tuple[SampleSums, ...]:
        """The sums over samples, in order."""
        return tuple(variable for variable in self.variables if isinstance(variable, SampleSums))

    @cached_property
    def nodes(self) -> tuple[Node, ...]:
        """All expressions, each once, those of samples included."""
        roots = [root for sums in self.sums for root in sums.parts.values()]
        roots += [part for walk in self.walks for part in walk.parts]
        steps = [step.value for sums in self.sums for step in sums.body]
        return tuple(postorder(*roots, *steps, self.result))

    def over_arrays(self, values: Mapping[str, Any], real: type) -> Any:
        """Return the output at arguments by :attr:`symbols`, every operation rounded to `real`."""
        columns = dict(values)
        for variable in self.variables:
            if isinstance(variable, SampleSums | DefuzzifierWalk):
                columns |= variable.over_arrays(columns, real)
        # C has the functions of its library, in double precision those of Python.
        in_doubles = np.dtype(real) == np.float64
        return evaluate_arrays(self.result, columns, real, self._order, as_floats=in_doubles)

    @cached_property
    def _order(self) -> Schedule:
        return schedule(self.result)


def make_program(rulebase: RuleBase, output: str, parameters: Sequence[str]) -> OutputProgram:
    """Return one output of a rule base as a program; an ExportError names an obstacle.

    No variable is named as one of `parameters`, the names of the inputs in the target language.
    """
    return _Builder(rulebase, output, parameters).build()


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
    connective = " and " if isinstance(expression, And) else " or "
    inner = (_words(operand) for operand in expression.operands)
    return connective.join(
        text if isinstance(operand, Is | Hedged) else f"({text})"
        for operand, text in zip(expression.operands, inner, strict=True)
    )


class _Builder:
    def __init__(self, rulebase: RuleBase, target: str, parameters: Sequence[str]) -> None:
        self.plan: Plan = plan(rulebase)
        # An interval type-2 rule is read twice, under one number.
        self.numbers = {
            i: rule for rule, rule_numbers in enumerate(self.plan.readings) for i in rule_numbers
        }
        self.target = target
        self.names = Names(reserved=set(parameters))
        self.variables: list[Assign | SampleSums | DefuzzifierWalk] = []
        # For each walked output: the strength of each of its contributions.
        self.walked: dict[str, dict[int, Node]] = {}
        self.named: set[Node] = set()
        self.calls: dict[Node, Call] = {}
        self.values: dict[str, Node] = {}
        self.degrees: dict[tuple[str, str, tuple[Hedge, ...]], Node] = {}
        # Of each output: the strength of each member so far, and the name of its variable.
        self.heights: dict[str, dict[int, tuple[str, Node]]] = {}
        # The sum over the rules, for each output with another aggregate than the maximum.
        self.sums: dict[str, _SetSums] = {}
        self.fired: dict[str, list[tuple[int, Node, str]]] = {}
        self.guards: list[Node] = []
        self.parameters = parameters
        self.holds = rulebase.output(target).no_rule == "hold"

    def build(self) -> OutputProgram:
        rulebase = self.plan.rulebase
        parameters = tuple(self.names.new(f"given_{name}") for name in self.parameters)
        for variable, name in zip(rulebase.inputs, parameters, strict=False):
            self.values[variable.name] = self.fresh(
                _into_range(variable, symbol(name), guard_nan=True), variable.name
            )
        outputs, rules = needed(self.plan, [self.target])
        for name in outputs:
            self.heights[name] = {}
            self.fired[name] = []
            self._check_output(self.plan.outputs[name])
        result: Node = ZERO
        for step in self.plan.steps:
            if isinstance(step, int) and step in rules:
                self._fire(step, self.plan.rules[step], outputs)
            elif isinstance(step, str) and step in outputs:
                result = self._conclude(self.plan.outputs[step], symbol(parameters[-1]))
        for guard in self.guards:
            result = where(guard > 0.0, result, math.nan)
        return OutputProgram(parameters, result, tuple(self.variables), self.calls, self.holds)

    def fresh(self, value: Node, name: str, remark: str = "") -> Node:
        """Give a part its own variable, unless it has one or needs none."""
        if not isinstance(value, Constant | Symbol) and value not in self.named:
            self.named.add(value)
            self.variables.append(Assign(self.names.new(name), value, remark))
        return value

    def call(self, name: str, body: Node, argument: Node) -> Node:
        """Apply a function of ``h`` to an argument."""
        value = replace(body, {"h": argument})
        if isinstance(body, Apply):
            self.calls[value] = Call(name, body, argument)
        return value

    def _check_output(self, output: OutputPlan) -> None:
        """Find out whether an output is one expression, or is walked over tables."""
        name, way, span = output.output.name, output.output.defuzzifier, output.output.span
        if output.discrete:
            if output.record.of in WALKED:
                self.walked[name] = {}
            return
        if way.resolution is not None:
            size = way.resolution * (1 + len(output.members))
            if size > MOST_SAMPLES:
                raise refuse(
                    f"the {way.method} of '{name}' over {way.resolution:,} samples takes {size:,}"
                    f" constants; the limit is {MOST_SAMPLES:,}",
                    span,
                    f"write  defuzzifier {way.method}(101)",
                )
        if _is_expression(output):
            return
        try:
            lay_out_output(self.plan, name, Listed())
        except NotCoveredError as error:
            instead = SAMPLED
            if not output.record.type2:
                instead = f"defuzzifier {way.method}(101)"
            raise refuse(str(error), span, f"write  {instead}") from None
        self.walked[name] = {}

    # ── rules ────────────────────────────────────────────────────────────────────────

    def _fire(self, index: int, planned: PlannedRule, outputs: set[str]) -> None:
        if planned.degrees:
            listed = ", ".join(sorted(planned.degrees))
            obstacle = f"a rule reads '{listed}' as a set of its own block"
            raise refuse(
                obstacle, planned.rule.span, "put the rules that read it into a separate block"
            )
        strength = times(self._truth(planned.rule.antecedent, planned), planned.rule.weight)
        if planned.threshold > 0.0:
            strength = self.fresh(strength, "s")
            strength = where(strength > planned.threshold, strength, 0.0)
        remark = rule_words(self.numbers[index], planned.rule.antecedent)
        for name in sorted(outputs):
            for number in self._contributions[name].get(index, ()):
                self._assert(self.plan.outputs[name], number, strength, remark)

    @cached_property
    def _contributions(self) -> dict[str, dict[int, list[int]]]:
        """Of each output: the contributions of each rule."""
        found: dict[str, dict[int, list[int]]] = {name: {} for name in self.plan.outputs}
        for name, output in self.plan.outputs.items():
            for number, (_, rule) in enumerate(output.contributions):
                found[name].setdefault(rule, []).append(number)
        return found

    def _assert(self, output: OutputPlan, number: int, strength: Node, remark: str) -> None:
        """Let a rule raise its member of an output."""
        name, aggregation = output.output.name, output.output.aggregation
        member = output.contributions[number][0]
        if name in self.walked and aggregation != "max" and not output.discrete:
            self.walked[name][number] = self.fresh(strength, "s", remark)
            return
        if aggregation != "max" and not output.discrete:
            strength = self.fresh(strength, "s", remark)
            if output.output.defuzzifier.resolution is not None:
                self.fired[name].append((member, strength, remark))
                return
            if output.closed is not None:
                parts = list(clipped(output.closed.set_layers[member], strength, self.call))
            else:
                parts = [scaled(output, member, strength)]
            if name not in self.sums:
                self.sums[name] = _SetSums(self)
            for part in parts:
                self.sums[name].add(part)
            return
        heights = self.heights[name]
        if member not in heights:
            variable = self.names.new(f"{name}_{output.members[member].term.name}")
        else:
            variable, height = heights[member]
            strength = replace(SNORMS[aggregation].expression, {"a": height, "b": strength})
        heights[member] = (variable, strength)
        self.variables.append(Assign(variable, strength, remark))

    def _truth(self, expression: Antecedent, planned: PlannedRule) -> Node:
        if isinstance(expression, Is):
            return self._degree(expression)
        if isinstance(expression, Hedged):
            inner = self.fresh(self._truth(expression.operand, planned), "d")
            return hedged(expression.hedges, inner)
        norm = (
            TNORMS[planned.conjunction]
            if isinstance(expression, And)
            else SNORMS[planned.disjunction]
        ).expression
        # One operation of two operands nests well; else each is named before it is used twice.
        simple = isinstance(norm, Apply) and norm.arguments == (symbol("a"), symbol("b"))
        truth: Node | None = None
        for number, operand in enumerate(expression.operands, start=1):
            degree = self._truth(operand, planned)
            if not simple:
                degree = self.fresh(degree, "d")
            truth = degree if truth is None else replace(norm, {"a": truth, "b": degree})
            if not simple or number % _LONGEST == 0:
                truth = self.fresh(truth, "d")
        assert truth is not None
        return truth

    def _degree(self, part: Is) -> Node:
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

    def _conclude(self, output: OutputPlan, last_value: Node) -> Node:
        """Return the value of the target; the value of another output is put by for rules."""
        model = output.output
        self.variables += [Assign(*height) for height in self.heights[model.name].values()]
        total, value = self._total_and_value(output)
        value = _into_range(model, self.fresh(value, "value"), guard_nan=False)
        no_rule = self._value_for_no_rule(model, last_value)
        is_nan = isinstance(no_rule, Constant) and math.isnan(no_rule.value)
        if model.name != self.target and is_nan:
            self.guards.append(total)
            no_rule = constant(model.low if math.isfinite(model.low) else 0.0)
        result = where(total > 0.0, value, no_rule)
        if model.name != self.target:
            self.values[model.name] = self.fresh(result, model.name)
        return result

    def _value_for_no_rule(self, model: Output, last_value: Node) -> Node:
        """Return the value of an output for which no rule fires."""
        if isinstance(model.no_rule, float | int):
            return constant(model.no_rule)
        if model.no_rule != "hold":
            return constant(math.nan)
        if model.name != self.target:
            obstacle = f"'{model.name}' holds its value, and other rules read it"
            raise refuse(obstacle, model.span, "write  no-rule 0")
        return last_value

    def _total_and_value(self, output: OutputPlan) -> tuple[Node, Node]:
        """Return a value above 0 if a rule fires, and the output's value."""
        name, record = output.output.name, output.record
        if name in self.walked:
            total, figure = self._walk(output)
            if len(record.aspect.figures) > 1:
                return total, figure
        else:
            total, figure = self._total_and_figure(output)
        if record.figure:
            return total, figure
        value = replace(record.expression, {record.symbols[0]: self.fresh(figure, "found")})
        return total, value

    def _total_and_figure(self, output: OutputPlan) -> Part:
        """Return the same for an output as one expression: the figure behind its value."""
        name = output.output.name
        if output.discrete:
            total, weighted = self._weighted(output)
            total, weighted = self.fresh(total, "total"), self.fresh(weighted, "weighted")
            if output.record.of == "sum":
                return total, weighted
            return total, _quotient(weighted, total)
        if output.output.defuzzifier.resolution is not None:
            area, moment = self._sampled(output)
            return area, _quotient(moment, area)
        area, moment = self.sums[name].part if name in self.sums else self._union(output)
        centre = constant(0.5 * (output.output.low + output.output.high))
        return area, plus(centre, _quotient(moment, area))

    def _walk(self, output: OutputPlan) -> Part:
        """Return the result of a defuzzifier of the kernel for the strengths."""
        name = output.output.name
        layout = lay_out_output(self.plan, name, Listed())
        strengths = {member: height for member, (_, height) in self.heights[name].items()}
        if output.in_order and not output.discrete:
            strengths = self.walked[name]
        nodes = [strengths.get(group, ZERO) for group in layout.groups]
        if output.discrete:
            values = [
                self._value(output, member, nodes[i]) for i, member in enumerate(layout.groups)
            ]
            by_turns = list(zip(nodes, values, strict=True))
            if output.record.of == "ends":  # of each pair both strengths, then both values
                pairs = list(zip(by_turns[::2], by_turns[1::2], strict=True))
                nodes = [
                    node
                    for pair in pairs
                    for node in (*(s for s, _ in pair), *(v for _, v in pair))
                ]
            else:
                nodes = [node for both in by_turns for node in both]
        total, value = self.names.new("total"), self.names.new("found")
        self.variables.append(DefuzzifierWalk(total, value, self.plan, name, tuple(nodes)))
        result: Node = symbol(value)
        if layout.program.centre:
            centre = constant(layout.floats[layout.whole[at.HEAD + at.FLOATS_AT] + 3])
            result = plus(centre, _quotient(result, symbol(total)))
        return symbol(total), result

    def _sampled(self, output: OutputPlan) -> Part:
        heights = self.heights[output.output.name]
        # The greatest of several cuts of a set is the cut at the greatest strength.
        greatest = [(member, height, "") for member, (_, height) in heights.items()]
        fired = self.fired[output.output.name] or greatest
        area: Node = ZERO
        moment: Node = ZERO
        for side in _sides(output):
            heights_of_side = [
                pair for pair in fired if side is None or output.sides[pair[0]] == side
            ]
            if heights_of_side:
                sums = sample_sums(output, heights_of_side, self.names)
                self.variables.append(sums)
                area, moment = plus(area, symbol(sums.area)), plus(moment, symbol(sums.moment))
        return area, moment

    def _union(self, output: OutputPlan) -> Part:
        # In the order of the sets, as the kernel adds them up.
        ordered = sorted(self.heights[output.output.name].items())
        heights = {member: node for member, (_, node) in ordered}
        if output.closed is not None:
            parts = list(clipped_union(output, heights, self.call))
        else:
            parts = []
            for side in _sides(output):
                heights_of_side = {
                    m: h for m, h in heights.items() if side is None or output.sides[m] == side
                }
                parts += scaled_union(output, heights_of_side, self.fresh)
        sums = _SetSums(self)
        for sign, part in parts:
            sums.add(part, sign)
        return sums.part

    def _weighted(self, output: OutputPlan) -> Part:
        """Return the sum of the strengths and the weighted sum of the values."""
        total: Node = ZERO
        weighted: Node = ZERO
        heights = sorted(self.heights[output.output.name].items())
        for number, (member, (_, height)) in enumerate(heights, start=1):
            total = plus(total, height)
            weighted = plus(weighted, self._weighed(output, member, height))
            if number % _LONGEST == 0:
                total, weighted = self.fresh(total, "total"), self.fresh(weighted, "weighted")
        return total, weighted

    def _weighed(self, output: OutputPlan, member: int, height: Node) -> Node:
        """Return the value of a consequent times its strength."""
        consequent = output.members[member]
        if consequent.value is not None:
            return times(height, consequent.value)
        value = self._value(output, member, height)
        if consequent.formula is not None or consequent.pieces:
            # Where its rule does not fire a formula may have no value, such as 1/0.
            return where(height > 0.0, height * value, 0.0)
        return times(height, value)

    def _value(self, output: OutputPlan, member: int, height: Node) -> Node:
        """Return the value of a consequent, which may depend on its strength."""
        consequent = output.members[member]
        shape = consequent.term.shape
        if consequent.value is not None:
            return constant(consequent.value)
        if output.record.inverts and consequent.pieces:
            return self.fresh(self._position(output, member, height), consequent.term.name)
        if shape.kind == "formula":
            value: Node = times(constant(shape.height), self._formula(output, member))
            return self.fresh(value, consequent.term.name)
        *coefficients, offset = shape.parameters
        value = constant(offset)
        for coefficient, variable in zip(coefficients, self.plan.rulebase.inputs, strict=True):
            value = plus(value, times(constant(coefficient), self.values[variable.name]))
        return self.fresh(value, consequent.term.name)

    def _position(self, output: OutputPlan, member: int, height: Node) -> Node:
        """Return the position where a monotone set reaches a strength."""
        consequent, model = output.members[member], output.output
        shape = consequent.term.shape
        kind = SHAPES[shape.kind]
        if kind.inverse_expression is not None and not consequent.hedges:
            share = height if shape.height == 1.0 else height / constant(shape.height)
            numbers = dict(zip(kind.inverse_symbols[1:], shape.parameters, strict=True))
            inverse = specialise(kind.inverse_expression, numbers)
            # Ends that it only approaches: those of the range.
            inverse = with_ends(inverse, model.low, model.high)
            value = self.fresh(
                replace(inverse, {"degree": op.minimum(1.0, share)}), f"{consequent.term.name}_at"
            )
            if kind.straight or shape.kind in {"s", "z", "arc"}:  # finite throughout
                return value
            limit, _ = stand_ins((model.low, model.high, *shape.parameters))
            if shape.kind == "concave":  # of a degree w it goes as 1/w, and is weighted by w
                limit = sys.float_info.max
            low, high = constant(-limit), constant(limit)
            return where(value > high, model.high, where(value < low, model.low, value))
        try:
            rising = is_rising(output, consequent)
        except InferenceError as error:
            raise refuse(
                str(error), consequent.term.span, "write  defuzzifier weighted-average"
            ) from None
        if not all(piece.straight for piece in consequent.pieces):
            term = f"{model.name} is {consequent.term.name}"
            obstacle = f"'{term}' is curved, and its position is searched for"
            raise refuse(obstacle, consequent.term.span, "write  defuzzifier weighted-average")
        return _on_pieces(
            consequent.pieces, height, model.high if rising else model.low, rising=rising
        )

    def _formula(self, output: OutputPlan, member: int) -> Node:
        term = output.members[member].term
        formula = formula_of(term.shape)
        names = {variable.name for variable in self.plan.rulebase.inputs}
        if not {name for name in formula.names if name not in CONSTANTS} <= names:
            obstacle = f"consequent '{term.name}' of '{output.output.name}' reads an output"
            raise refuse(obstacle, term.span, "give it the inputs that the output is made of")
        return replace(formula.with_constants(tuple(names)), self.values)


def _is_expression(output: OutputPlan) -> bool:
    """Whether the value of a set is an expression of reasonable length."""
    way = output.output.defuzzifier
    if output.record.of != "gravity" or way.joined:
        return False
    if way.resolution is not None:
        return True
    kinds = {member.implication for member in output.members}
    straight = all(piece.straight for member in output.members for piece in member.pieces)
    if output.output.aggregation not in {"max", "sum"} or len(kinds) > 1 or not straight:
        return False
    if kinds == {"product"}:
        return output.output.aggregation == "sum" or most_overlapping(output) <= 2
    return not kinds or (kinds == {"min"} and output.closed is not None)


def _sides(output: OutputPlan) -> tuple[int | None, ...]:
    """Return the sides of an interval type-2 set, each as one set; None is all of type 1."""
    return (UPPER, LOWER) if output.sides else (None,)


def _on_pieces(pieces: Sequence[Piece], level: Node, beyond: float, *, rising: bool) -> Node:
    """Return the position where straight monotone pieces reach a level."""
    value: Node = constant(beyond)
    for x0, y0, x1, y1, _ in pieces[::-1] if rising else pieces:
        start, first, end, last = (x0, y0, x1, y1) if rising else (x1, y1, x0, y0)
        if last > first:
            reach = constant(end - start) * minus(level, constant(first)) / constant(last - first)
            value = where(level <= last, constant(start) + reach, value)
        value = where(level <= first, start, value)
    return value


class _SetSums:
    """The area and the moment of an output, growing part by part."""

    def __init__(self, builder: _Builder) -> None:
        self.part: Part = (ZERO, ZERO)
        self._names = builder.names.new("area"), builder.names.new("moment")
        self._variables = builder.variables

    def add(self, part: Part, sign: int = 1) -> None:
        combine = plus if sign > 0 else minus
        area, moment = (combine(a, b) for a, b in zip(self.part, part, strict=True))
        self.part = (area, moment)
        for name, total in zip(self._names, self.part, strict=True):
            self._variables.append(Assign(name, total))


def _quotient(top: Node, bottom: Node) -> Node:
    """Divide, guarded against 0; the result is then unused."""
    return where(bottom > 0.0, top / bottom, 0.0)


def _into_range(variable: Input | Output, x: Node, *, guard_nan: bool) -> Node:
    """Return `x` clamped by its variable's rule; an input that is NaN counts as the lower end."""
    low, high = variable.low, variable.high
    stand_in = low if math.isfinite(low) else high if math.isfinite(high) else 0.0
    if variable.outside == "extend" or not (math.isfinite(low) and math.isfinite(high)):
        if variable.outside != "extend":
            x = where(x < low, low, x) if math.isfinite(low) else x
            x = where(x > high, high, x) if math.isfinite(high) else x
        return where(op.equal(x, x), x, stand_in) if guard_nan else x
    return where(x > low, where(x < high, x, high), low)
