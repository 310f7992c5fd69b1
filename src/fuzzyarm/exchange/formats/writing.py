"""Names permitted by a format, and rules as sentences of FLL and FCL.

:func:`written_sentences` writes the rules of a block; :func:`as_sentences` is the inverse of
:mod:`fuzzyarm.exchange.formats.meaning` for hedges.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field, replace

from fuzzyarm.exchange.formats.dialects import MACHINE_EPSILON, Dialect, word_of, words
from fuzzyarm.exchange.formats.findings import Findings, unique_name, written
from fuzzyarm.exchange.formats.meaning import (
    POWERS,
    hedged_weight,
    hedges_of_conclusion,
    threshold_under,
    without_hedges,
)
from fuzzyarm.exchange.formats.sentences import NOT, hedged
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Expression,
    Hedge,
    Hedged,
    Is,
    Or,
    Rule,
    RuleBase,
    RuleBlock,
)
from fuzzyarm.symbolic import formulas
from fuzzyarm.symbolic.kinds import HEDGES, TNORMS

FUZZYLITE_WORDS = frozenset(
    {"if", "is", "then", "and", "or", "with", "pi"}
    | set(words(HEDGES, "fll"))
    | set(formulas.FUZZYLITE.functions)
    | {"gt", "ge", "eq", "neq", "le", "lt", "log1p", "acosh", "asinh", "atanh"}
)
"""Reserved words of fuzzylite's rule parser."""

# --- Names permitted by a format ---


@dataclass(slots=True)
class WrittenNames:
    """Names of variables, and of terms by (variable, term), in the written file."""

    variables: dict[str, str] = field(default_factory=dict)
    terms: dict[tuple[str, str], str] = field(default_factory=dict)

    def variable(self, name: str) -> str:
        """Return the name of a variable in the file."""
        return self.variables.get(name, name)

    def term(self, variable: str, name: str) -> str:
        """Return the name of a term in the file."""
        return self.terms.get((variable, name), name)


def identifier(name: str, reserved: frozenset[str], *, ignore_case: bool) -> str:
    """Return a name as an identifier that is not reserved."""
    # \w includes fractions and superscripts, which no reader accepts as letters.
    plain = "".join(c if f"_{c}".isidentifier() else " " for c in name)
    word = re.sub(r"\W+", "_", plain).strip("_") or "_"
    if name.isidentifier() and re.fullmatch(r"\w+", name):
        word = name
    elif word[0].isnumeric():
        word = f"_{word}"
    if (word.lower() if ignore_case else word) in reserved:
        word = f"{word}_"
    return word


def identifiers(
    rulebase: RuleBase,
    findings: Findings,
    reserved: frozenset[str],
    *,
    ignore_case: bool = False,
) -> WrittenNames:
    """Return names as identifiers that are not reserved; report every change."""

    def fitted(name: str, names: set[str], kind: str) -> str:
        word = unique_name(identifier(name, reserved, ignore_case=ignore_case), names)
        names.add(word)
        if word != name:
            findings.warn("renamed", f"the {kind} '{name}' is written as {word}")
        return word

    names = WrittenNames()
    variables: set[str] = set()
    for variable in (*rulebase.inputs, *rulebase.outputs):
        names.variables[variable.name] = fitted(variable.name, variables, "variable")
        terms: set[str] = set()
        for term in variable.terms:
            names.terms[variable.name, term.name] = fitted(term.name, terms, "term")
    return names


# --- Rules ---


@dataclass(frozen=True, slots=True)
class Sentence:
    """A rule in fuzzylite's form: conclusions, each with its hedges."""

    antecedent: Expression
    conclusions: tuple[tuple[Consequent, tuple[Hedge, ...]], ...]
    weight: float
    rule: Rule
    hedges: tuple[Hedge, ...] = ()


def plain_sentence(rule: Rule) -> Sentence:
    """Return a rule unchanged, for programs without hedges before conclusions."""
    conclusions = tuple((consequent, ()) for consequent in rule.consequents)
    return Sentence(rule.antecedent, conclusions, rule.weight, rule)


def as_sentences(
    block: RuleBlock,
    dialect: Dialect,
    findings: Findings,
    order: dict[str, int] | None = None,
) -> list[Sentence]:
    """Return the rules of a block; rules that differ in outer hedges alone are merged.

    Hedges of a conclusion carry on to the next ones, so rules with one antecedent and growing
    hedges fit into one sentence. With `order`, the index of each output, only if the conclusions
    then keep that order.
    """
    sentences: list[Sentence] = []
    for rule in block.rules:
        sentence = _as_sentence(rule, block, dialect, findings)
        last = sentences[-1] if sentences else None
        if last is not None and _carries_on(last, sentence, order):
            (first, _), *others = sentence.conclusions
            new = sentence.hedges[: len(sentence.hedges) - len(last.hedges)]
            conclusions = (*last.conclusions, (first, new), *others)
            sentences[-1] = replace(sentence, conclusions=conclusions, rule=last.rule)
        else:
            sentences.append(sentence)
    return sentences


def _as_sentence(rule: Rule, block: RuleBlock, dialect: Dialect, findings: Findings) -> Sentence:
    """Move the hedges of a whole antecedent before the first conclusion, if possible.

    A hedge has no place around a parenthesis; before the conclusion it makes its own threshold.
    """
    antecedent, weight = rule.antecedent, rule.weight
    hedges = hedges_of_conclusion(rule, block, dialect)
    if not hedges and isinstance(antecedent, Hedged) and isinstance(antecedent.operand, And | Or):
        above = block.threshold if dialect.thresholds else dialect.threshold
        under = threshold_under(antecedent.hedges, above)
        if under is not None:
            hedges = antecedent.hedges
            message = f"the rule fires above {block.threshold:g}, to {dialect.program} {under:g}"
            slight = max(under, block.threshold) <= MACHINE_EPSILON
            findings.loss("threshold", message, rule.span, slight=slight)
    before = weight_before(weight, hedges) if hedges else None
    if before is None:
        hedges = ()
    else:
        weight, antecedent = before, without_hedges(antecedent, hedges)
    conclusions = tuple((c, () if i else hedges) for i, c in enumerate(rule.consequents))
    return Sentence(antecedent, conclusions, weight, rule, hedges)


def _carries_on(last: Sentence, sentence: Sentence, order: dict[str, int] | None) -> bool:
    """Whether a rule can be appended to the conclusions of the last one."""
    more = len(sentence.hedges) - len(last.hedges)
    if more <= 0 or sentence.hedges[more:] != last.hedges:
        return False
    if order is not None:
        before = order[last.conclusions[-1][0].variable]
        if order[sentence.conclusions[0][0].variable] <= before:
            return False
    return last.antecedent == sentence.antecedent and last.weight == sentence.weight


def weight_before(weight: float, hedges: tuple[Hedge, ...]) -> float | None:
    """Return w with ``hedged_weight(w, hedges) == weight`` to the last bit, or None."""
    if weight == 1.0:
        return 1.0
    guess = weight
    for hedge in hedges:
        if hedge.name not in POWERS or guess <= 0.0:
            return None
        guess = guess ** (1.0 / (hedge.exponent or POWERS[hedge.name]))
    # The root is rounded; its neighbour may be the one that leads back to the weight.
    for candidate in (guess, math.nextafter(guess, math.inf), math.nextafter(guess, 0.0)):
        if hedged_weight(candidate, hedges) == weight:
            return candidate
    return None


def written_sentences(
    block: RuleBlock, dialect: Dialect, names: WrittenNames, findings: Findings
) -> list[str]:
    """Return the rules of a block as ``if … then …``; report those without such a form."""
    as_they_stand = map(plain_sentence, block.rules)
    sentences = as_sentences(block, dialect, findings) if dialect.activates else as_they_stand
    writer = _SentenceWriter(block, dialect, names, findings)
    return [writer.text(sentence) for sentence in sentences]


@dataclass(frozen=True, slots=True)
class _SentenceWriter:
    """Writes the rules of a block.

    fuzzylite has hedges after *is* only; jFuzzyLogic has *not* alone, before a proposition or a
    parenthesis, and keywords in upper case.
    """

    block: RuleBlock
    dialect: Dialect
    names: WrittenNames
    findings: Findings

    def key(self, word: str) -> str:
        return word if self.dialect.activates else word.upper()

    def closed(self, text: str) -> str:
        return f"( {text} )" if self.dialect.activates else f"({text})"

    def text(self, sentence: Sentence) -> str:
        condition = self.condition(sentence.antecedent, sentence.rule)
        conclusions = [
            self.conclusion(*conclusion, sentence.rule) for conclusion in sentence.conclusions
        ]
        joint = " and " if self.dialect.activates else ", "
        ending = "" if sentence.weight == 1.0 else f" {self.key('with')} {written(sentence.weight)}"
        head, then = self.key("if"), self.key("then")
        return f"{head} {condition} {then} {joint.join(conclusions)}{ending}"

    def conclusion(self, consequent: Consequent, hedges: tuple[Hedge, ...], rule: Rule) -> str:
        if consequent.hedges:
            message = (
                "hedges on the set of a conclusion have another meaning to fuzzylite"
                if self.dialect.activates
                else "jFuzzyLogic has no hedges in conclusions"
            )
            self.findings.loss("set-hedge", message, rule.span)
        variable = self.names.variable(consequent.variable)
        term = self.names.term(consequent.variable, consequent.term)
        return " ".join([variable, self.key("is"), *self.hedge_words(hedges), term])

    def condition(self, expression: Expression, rule: Rule) -> str:
        if isinstance(expression, Is):
            return self.proposition(expression, rule)
        if isinstance(expression, Hedged):
            if self.dialect.activates:
                return self.condition(self.pushed_in(expression), rule)
            inner = self.closed(self.condition(expression.operand, rule))
            return " ".join([*self.negations(expression.hedges, rule), inner])
        parts = []
        for part in expression.operands:
            operand = part
            if isinstance(part, Hedged) and self.dialect.activates:
                operand = self.pushed_in(part)
            text = self.condition(operand, rule)
            # fuzzylite: `and` binds tighter than `or`; jFuzzyLogic: equal precedence.
            apart = isinstance(operand, Or) or type(operand) is type(expression)
            if not self.dialect.activates:
                apart = isinstance(operand, And | Or)
            parts.append(self.closed(text) if apart else text)
        return f" {self.key('and' if isinstance(expression, And) else 'or')} ".join(parts)

    def proposition(self, proposition: Is, rule: Rule) -> str:
        variable = self.names.variable(proposition.variable)
        term = self.names.term(proposition.variable, proposition.term)
        if not self.dialect.activates:
            return " ".join([*self.negations(proposition.hedges, rule), variable, "IS", term])
        names = [hedge.name for hedge in proposition.hedges]
        if "any" in names:  # the hedges inside have no effect, and there is no term
            hedges = proposition.hedges[: names.index("any") + 1]
            return " ".join([variable, "is", *self.hedge_words(hedges)])
        return " ".join([variable, "is", *self.hedge_words(proposition.hedges), term])

    def hedge_words(self, hedges: tuple[Hedge, ...]) -> list[str]:
        words = []
        for hedge in hedges:
            word = word_of(HEDGES, hedge.name, self.dialect.kinds)
            if word is None:
                name = hedge.name if hedge.exponent is None else f"power({hedge.exponent})"
                message = f"{self.dialect.program} has no hedge '{name}'"
                self.findings.loss("unsupported-hedge", message)
            else:
                words.append(word)
        return words

    def negations(self, hedges: tuple[Hedge, ...], rule: Rule) -> list[str]:
        for hedge in hedges:
            if hedge != NOT:
                message = f"jFuzzyLogic has no hedge '{hedge.name}'"
                self.findings.loss("unsupported-hedge", message, rule.span)
        # Two negations cancel.
        return ["NOT"] * (sum(hedge == NOT for hedge in hedges) % 2)

    def pushed_in(self, expression: Hedged) -> Expression:
        """Return an equivalent without hedges on an ``and`` or ``or``, if there is one."""
        operand = expression.operand
        if isinstance(operand, Is | Hedged):
            return hedged(expression.hedges, operand)
        block = self.block
        if all(hedge == NOT for hedge in expression.hedges):
            if len(expression.hedges) % 2 == 0:
                return operand
            if block.conjunction in TNORMS and TNORMS[block.conjunction].dual == block.disjunction:
                kind = Or if isinstance(operand, And) else And
                return kind(tuple(hedged((NOT,), inner) for inner in operand.operands))
        message = "fuzzylite has no hedges on expressions in parentheses"
        self.findings.loss("hedged-expression", message)
        return operand
