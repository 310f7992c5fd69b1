"""Interval type-2 rule bases as ones of type 1: every rule is read twice.

The degree of an interval type-2 term lies between its lower and its upper membership function,
so a rule fires between two strengths. Norms rise with their operands: the upper strength follows
from upper degrees, the lower one from lower degrees, and under a decreasing hedge (``not``) the
ends change places. So :func:`doubled` writes a rule base of type 1 in which each
term is there twice and each rule twice, and every evaluator of rules (point, arrays, kernel,
exported code) reads it as it reads any other. New is only the last step: a defuzzifier that
takes the sets of both readings (:mod:`fuzzyarm.inference.type_reduction_kernel`).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

from fuzzyarm.inference.errors import InferenceError
from fuzzyarm.language.model.rulebase import (
    POSITION,
    And,
    Consequent,
    Expression,
    Hedge,
    Hedged,
    Is,
    Or,
    Output,
    Rule,
    RuleBase,
    Shape,
    Term,
    Variable,
    propositions,
)
from fuzzyarm.language.model.shapes import apply_hedges
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS
from fuzzyarm.symbolic.records import emptied_with_kinds

UPPER, LOWER = 0, 1
"""The two readings of a rule, and the sides of the sets that they assert."""


class Doubled(NamedTuple):
    """A rule base with each interval as its two ends."""

    rulebase: RuleBase  # of type 1, but for the defuzzifiers
    lower_names: dict[tuple[str, str], str]  # for a variable and a term: the name of its lower end
    # For each rule of the model the indices of its upper and lower reading; only one where it
    # concludes outputs of type 1 alone.
    readings: tuple[tuple[int, ...], ...]

    def side(self, consequent: Consequent) -> int:
        """Return ``UPPER`` or ``LOWER``: the set of its output to which a consequent belongs."""
        is_lower = consequent.term in {
            lower for (name, _), lower in self.lower_names.items() if name == consequent.variable
        }
        return LOWER if is_lower != (direction(consequent.hedges) < 0) else UPPER


@lru_cache(maxsize=256)
def direction(hedges: tuple[Hedge, ...]) -> int:
    """Return 1 for hedges that rise with the degree, -1 for those that fall."""
    values = [apply_hedges(hedges, i / 256) for i in range(257)]
    steps = [b - a for a, b in pairwise(values)]
    if min(steps) >= 0.0:
        return 1
    if max(steps) <= 0.0:
        return -1
    words = " ".join(hedge.name for hedge in hedges)
    raise InferenceError(
        f"the hedge '{words}' neither rises nor falls with the degree, so it has no interval"
        " from the ends of one"
    )


emptied_with_kinds(direction.cache_clear)


def doubled(rulebase: RuleBase) -> Doubled:
    """Write a rule base with both ends of every interval; outputs of type 1 and their rules stay.

    InferenceError if an interval meets a defuzzifier of type 1, or a hedge that neither rises nor
    falls.
    """
    return _Doubling(rulebase).result()


class _Doubling:
    def __init__(self, rulebase: RuleBase) -> None:
        self.rulebase = rulebase
        self.outputs = {output.name: output for output in rulebase.outputs}
        self.two_sided = {n for n, o in self.outputs.items() if o.defuzzifier.record.type2}
        self.lower_names: dict[tuple[str, str], str] = {}
        self.intervals: set[tuple[str, str]] = set()
        for variable in (*rulebase.inputs, *rulebase.outputs):
            names = {term.name for term in variable.terms}
            for term in variable.terms:
                if term.lower is not None:
                    self.intervals.add((variable.name, term.name))
                if variable.name in self.two_sided or term.lower is not None:
                    # A quoted term of a file may have this name: then with primes.
                    name = f"{term.name} (lower)"
                    while name in names:
                        name += "'"
                    names.add(name)
                    self.lower_names[variable.name, term.name] = name

    def result(self) -> Doubled:
        for output in self.outputs.values():
            if output.name in self.two_sided and output.defuzzifier.joined:
                way = output.defuzzifier.method
                raise InferenceError(f"{way} of '{output.name}' takes no joined samples")
        readings: list[tuple[int, ...]] = []
        blocks = []
        count = 0
        for block in self.rulebase.blocks:
            concluded = {c.variable for rule in block.rules for c in rule.consequents}
            rules: list[Rule] = []
            for rule in block.rules:
                self._refuse(rule, concluded)
                readings_here = self._read_twice(rule)
                readings.append(tuple(range(count, count + len(readings_here))))
                count += len(readings_here)
                rules += readings_here
            blocks.append(replace(block, rules=tuple(rules)))
        rulebase = replace(
            self.rulebase,
            inputs=tuple(
                replace(variable, terms=self._terms(variable)) for variable in self.rulebase.inputs
            ),
            outputs=tuple(
                replace(output, terms=self._terms(output)) for output in self.rulebase.outputs
            ),
            blocks=tuple(blocks),
        )
        return Doubled(rulebase, self.lower_names, tuple(readings))

    def _terms(self, variable: Variable) -> tuple[Term, ...]:
        averaged = isinstance(variable, Output) and variable.defuzzifier.record.both
        terms: list[Term] = []
        for term in variable.terms:
            lower, upper = term.lower or term.shape, term.shape
            # Nie and Tan: the middle of an interval of values, once for both readings.
            if averaged and is_value(upper):
                lower = upper = middle_value(lower, upper)
            terms.append(replace(term, shape=upper, lower=None))
            name = self.lower_names.get((variable.name, term.name))
            if name is not None:
                terms.append(replace(term, name=name, shape=lower, lower=None))
        return tuple(terms)

    def _read_twice(self, rule: Rule) -> list[Rule]:
        # One rule becomes two: upper degrees to upper sets, lower degrees to lower ones.
        two_sided = [c for c in rule.consequents if c.variable in self.two_sided]
        if not two_sided:
            return [rule]
        upper = tuple(
            self._consequent(consequent, UPPER)
            if consequent.variable in self.two_sided
            else consequent
            for consequent in rule.consequents
        )
        lower = tuple(self._consequent(term, LOWER) for term in two_sided)
        return [
            replace(rule, antecedent=self._read(rule.antecedent, UPPER), consequents=upper),
            replace(rule, antecedent=self._read(rule.antecedent, LOWER), consequents=lower),
        ]

    def _consequent(self, consequent: Consequent, side: int) -> Consequent:
        key = (consequent.variable, consequent.term)
        if _turned(side, consequent.hedges) == UPPER:
            return consequent
        return replace(consequent, term=self.lower_names[key])

    def _read(self, expression: Expression, side: int) -> Expression:
        if isinstance(expression, Is):
            key = (expression.variable, expression.term)
            if key not in self.intervals or _turned(side, expression.hedges) == UPPER:
                return expression
            return replace(expression, term=self.lower_names[key])
        if isinstance(expression, Hedged):
            # Only over an interval must a hedge be monotone.
            if self._is_interval(expression.operand):
                side = _turned(side, expression.hedges)
            return replace(expression, operand=self._read(expression.operand, side))
        operands = tuple(self._read(operand, side) for operand in expression.operands)
        return And(operands) if isinstance(expression, And) else Or(operands)

    def _is_interval(self, expression: Expression) -> bool:
        return any((p.variable, p.term) in self.intervals for p in propositions(expression))

    def _refuse(self, rule: Rule, concluded: set[str]) -> None:
        """Refuse an interval under a defuzzifier of type 1, which has no meaning."""
        for part in propositions(rule.antecedent):
            if part.variable in concluded & self.two_sided:
                raise InferenceError(
                    f"a rule reads '{part.variable}' in the block that concludes it, where it is an"
                    " interval type-2 set; conclude it in a block in front"
                )
        for consequent in rule.consequents:
            output = self.outputs[consequent.variable]
            if consequent.variable in self.two_sided:
                continue
            parts = list(propositions(rule.antecedent))
            uses = [p for p in parts if (p.variable, p.term) in self.intervals]
            if (output.name, consequent.term) in self.intervals:
                uses.append(Is(output.name, consequent.term))
            if uses:
                raise InferenceError(
                    f"'{uses[0].variable} is {uses[0].term}' is of interval type 2, and"
                    f" {output.defuzzifier.method} of '{output.name}' takes sets of type 1",
                    hint="use karnik-mendel or nie-tan",
                )


def _turned(side: int, hedges: tuple[Hedge, ...]) -> int:
    """Return the side of a set below hedges such that the set under them is `side`."""
    return side if not hedges or direction(hedges) > 0 else 1 - side


# ── values between two ───────────────────────────────────────────────────────────────


def is_value(shape: Shape) -> bool:
    """Whether a shape is a number, maybe a function of the inputs, instead of a set."""
    if shape.kind == "formula":
        from fuzzyarm.inference.sets import formula_of

        return POSITION not in formula_of(shape).names
    return shape.kind in {"singleton", "linear"}


def middle_value(one: Shape, other: Shape) -> Shape:
    """Return the middle of two values of one kind."""
    if one == other:
        return one
    if one.kind == "formula":
        heights = one.height, other.height
        parts = f"{heights[0]!r} * ({one.formula}) + {heights[1]!r} * ({other.formula})"
        return Shape("formula", formula=f"0.5 * ({parts})")
    pairs = zip(one.parameters, other.parameters, strict=True)
    return replace(one, parameters=tuple(0.5 * (a + b) for a, b in pairs))


# ── the two ends of an output ────────────────────────────────────────────────────────


class Ends(NamedTuple):
    """A rule base whose outputs are the ends of those of another."""

    rulebase: RuleBase  # with two outputs for each one under Karnik and Mendel's defuzzifier
    # For each output of the other: its left end and its right end, as outputs.
    names: dict[str, tuple[str, str]]


def ends(rulebase: RuleBase) -> Ends:
    """Write a rule base whose outputs are the two ends of those of another.

    An output of type 1 is both of its ends. A middle stays where later rules read it.
    """
    if not any(map(_has_both_ends, rulebase.outputs)):
        return Ends(rulebase, {output.name: (output.name,) * 2 for output in rulebase.outputs})
    used_names = {variable.name for variable in (*rulebase.inputs, *rulebase.outputs)}
    names: dict[str, tuple[str, str]] = {}
    outputs: list[Output] = []
    for output in rulebase.outputs:
        if not _has_both_ends(output):
            names[output.name] = (output.name, output.name)
            outputs.append(output)
            continue
        own_names = [_free(f"{output.name} ({side})", used_names) for side in ("left", "right")]
        names[output.name] = own_names[0], own_names[1]
        if _is_read(rulebase, output.name):  # else its middle would be computed in vain
            outputs.append(output)
        outputs += [
            replace(
                output,
                name=name,
                defuzzifier=replace(output.defuzzifier, method=DEFUZZIFIERS.plain(side)),
            )
            for name, side in zip(own_names, ("left", "right"), strict=True)
        ]
    names_kept = {output.name for output in outputs}
    blocks = tuple(
        replace(
            block, rules=tuple(_concluding_ends(rule, names, names_kept) for rule in block.rules)
        )
        for block in rulebase.blocks
    )
    bounded = replace(
        rulebase, outputs=tuple(outputs), blocks=blocks, expectations=(), properties=()
    )
    return Ends(bounded, names)


def _has_both_ends(output: Output) -> bool:
    """Whether its value is made of both ends of a centroid."""
    record = output.defuzzifier.record
    return record.of == "ends" and not record.figure


def _free(name: str, names: set[str]) -> str:
    while name in names:
        name += "'"
    names.add(name)
    return name


def _is_read(rulebase: RuleBase, name: str) -> bool:
    """Whether a rule or a consequent's formula reads an output."""
    from fuzzyarm.inference.sets import formula_of

    if any(p.variable == name for rule in rulebase.rules for p in propositions(rule.antecedent)):
        return True
    shapes = [
        shape
        for output in rulebase.outputs
        for term in output.terms
        for shape in (term.shape, term.lower)
        if shape is not None and shape.kind == "formula"
    ]
    return any(name in formula_of(shape).names for shape in shapes)


def _concluding_ends(
    rule: Rule, names: dict[str, tuple[str, str]], unchanged: Iterable[str]
) -> Rule:
    consequents = [
        replace(consequent, variable=name)
        for consequent in rule.consequents
        for name in dict.fromkeys((consequent.variable, *names[consequent.variable]))
        if name in unchanged
    ]
    return replace(rule, consequents=tuple(consequents))
