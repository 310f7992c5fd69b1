"""Rules of foreign formats: read as their author wrote them, then given their meaning.

FLL and FCL share ``if … then … with …``; what fuzzylite does with hedges, weights and
outputs in antecedents is expressed in the model.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fuzzyarm.formats.findings import Draft, Findings, Word, number
from fuzzyarm.model.rulebase import (
    And,
    Consequent,
    Expression,
    Hedge,
    Hedged,
    Is,
    Or,
    Rule,
    RuleBlock,
    propositions,
)
from fuzzyarm.text.diagnostic import Span

# --- A rule as its author wrote it, before its meaning is settled ---

NOT = Hedge("not")

FUZZYLITE_HEDGES = {
    "any": Hedge("any"),
    "extremely": Hedge("intensify"),
    "not": NOT,
    "seldom": Hedge("seldom"),
    "somewhat": Hedge("somewhat"),
    "very": Hedge("very"),
}
"""fuzzylite's ``extremely`` is 2d² below one half: the model calls that ``intensify``."""


class RuleFaultError(ValueError):
    """A rule that cannot be read further."""

    def __init__(self, name: str, message: str, word: Word) -> None:
        super().__init__(message)
        self.name = name
        self.word = word


@dataclass(frozen=True, slots=True)
class Dialect:
    """How a program reads rules.

    Attributes
    ----------
    equal_precedence : bool
        Whether ``and`` and ``or`` bind alike, from the left (jFuzzyLogic).
    ignore_case : bool
        Whether key words may be written in capitals.
    separators : tuple of str
        What stands between two conclusions.
    """

    equal_precedence: bool = False
    ignore_case: bool = False
    separators: tuple[str, ...] = ("and",)


@dataclass(frozen=True, slots=True)
class RuleText:
    """A rule as it was written: what its hedges mean is up to the format."""

    antecedent: Expression
    conclusions: tuple[Consequent, ...]
    weight: float
    span: Span
    uses_and: bool
    uses_or: bool


def hedged(hedges: tuple[Hedge, ...], inner: Expression) -> Expression:
    """Put hedges around an expression, into the proposition where it is a single one."""
    if not hedges:
        return inner
    if isinstance(inner, Is):
        return Is(inner.variable, inner.term, (*hedges, *inner.hedges), inner.span)
    if isinstance(inner, Hedged):
        return Hedged((*hedges, *inner.hedges), inner.operand)
    return Hedged(hedges, inner)


def joined(
    kind: type[And] | type[Or], left: tuple[Expression, bool], right: tuple[Expression, bool]
) -> tuple[Expression, bool]:
    """Join from the left; a chain of one operator becomes one node unless parenthesised."""
    expression, closed = left
    if isinstance(expression, kind) and not closed:
        return kind((*expression.operands, right[0])), False
    return kind((expression, right[0])), False


# --- Read `if … then … with …` as FLL and FCL write it ---

MAX_NESTING = 50
MAX_CONCLUSIONS = 200


class RuleParser:
    """Recursive descent over the words of one rule.

    Parameters
    ----------
    words : list of Word
        With parentheses and commas as words of their own; ``if`` is the first.
    variables : dict
        Name to variable.
    findings : Findings
        Where unknown names are reported; the rule is read on.
    dialect : Dialect
        How the program reads.
    """

    def __init__(
        self, words: list[Word], variables: dict[str, Draft], findings: Findings, dialect: Dialect
    ) -> None:
        self.words = words
        self.variables = variables
        self.findings = findings
        self.dialect = dialect
        self.at = 0
        self.seen: set[str] = set()

    def rule(self) -> RuleText:
        """Read the whole rule.

        Raises
        ------
        RuleFaultError
            Where the text is no rule.
        """
        self.expect("if")
        antecedent = self.condition(0)
        self.expect("then")
        conclusions = [self.conclusion()]
        while self.key() in self.dialect.separators:
            word = self.take()
            if len(conclusions) == MAX_CONCLUSIONS:
                message = f"a rule may have {MAX_CONCLUSIONS} conclusions at most"
                raise RuleFaultError("too-many", message, word)
            conclusions.append(self.conclusion())
        weight = self.weight() if self.key() == "with" else 1.0
        if self.at < len(self.words):
            word = self.words[self.at]
            raise RuleFaultError("syntax", f"'{word.text[:40]}' is not expected here", word)
        span = self.words[0].span.to(self.words[-1].span)
        uses = self.seen
        return RuleText(antecedent, tuple(conclusions), weight, span, "and" in uses, "or" in uses)

    def key(self) -> str:
        """Return the next word, in small letters where case does not matter."""
        if self.at >= len(self.words):
            return ""
        text = self.words[self.at].text
        return text.lower() if self.dialect.ignore_case else text

    def take(self) -> Word:
        """Return the next word and go on."""
        if self.at >= len(self.words):
            raise RuleFaultError("syntax", "the rule ends too early", self.words[-1])
        self.at += 1
        return self.words[self.at - 1]

    def expect(self, key: str) -> None:
        """Go past the word `key`."""
        if self.key() != key:
            found = self.take()
            message = f"'{key}' is expected here, not '{found.text[:40]}'"
            raise RuleFaultError("syntax", message, found)
        self.at += 1

    def condition(self, depth: int) -> Expression:
        """Read operands joined by ``and`` and ``or``."""
        if depth > MAX_NESTING:
            message = f"parentheses may nest {MAX_NESTING} deep at most"
            raise RuleFaultError("too-deep", message, self.words[min(self.at, len(self.words) - 1)])
        if self.dialect.equal_precedence:
            return self._flat(depth)
        left = self._conjunction(depth)
        if self.key() != "or":
            return left[0]
        while self.key() == "or":
            self._connective()
            left = joined(Or, left, self._conjunction(depth))
        return left[0]

    def _conjunction(self, depth: int) -> tuple[Expression, bool]:
        left = self._factor(depth)
        while self.key() == "and":
            self._connective()
            left = joined(And, left, self._factor(depth))
        return left

    def _flat(self, depth: int) -> Expression:
        left = self._factor(depth)
        while self.key() in ("and", "or"):
            kind = And if self._connective() == "and" else Or
            left = joined(kind, left, self._factor(depth))
        return left[0]

    def _connective(self) -> str:
        key = self.key()
        self.seen.add(key)
        self.at += 1
        return key

    def _factor(self, depth: int) -> tuple[Expression, bool]:
        """Return an operand and whether it stood in parentheses."""
        negations = 0
        while self.key() == "not":
            negations += 1
            self.at += 1
        if self.key() == "(":
            self.at += 1
            inner = self.condition(depth + 1)
            self.expect(")")
        else:
            inner = self.proposition()
        return (hedged((NOT,) * negations, inner) if negations else inner), True

    def proposition(self) -> Is:
        """Read *variable is [hedges] term*."""
        variable, draft = self._variable(outputs_only=False)
        self.expect("is")
        hedges, term = self._hedges_and_term(draft, variable)
        return Is(variable.text, term, hedges, variable.span)

    def conclusion(self) -> Consequent:
        """Read *output is [hedges] term*."""
        variable, draft = self._variable(outputs_only=True)
        self.expect("is")
        hedges, term = self._hedges_and_term(draft, variable)
        return Consequent(variable.text, term, hedges, variable.span)

    def _variable(self, *, outputs_only: bool) -> tuple[Word, Draft | None]:
        word = self.take()
        draft = self.variables.get(word.text)
        if draft is None and (near := self._same_but_case(word)) is not None:
            word, draft = Word(near.name, word.span), near
        if draft is None:
            names = [n for n, d in self.variables.items() if d.is_output or not outputs_only]
            self.findings.unknown("undefined-variable", "the variable", word, names)
        elif outputs_only and not draft.is_output:
            message = f"'{word.text}' is an input; a rule cannot conclude on it"
            self.findings.error("not-an-output", message, word)
        return word, draft

    def _same_but_case(self, word: Word) -> Draft | None:
        if not self.dialect.ignore_case:
            return None
        lowered = word.text.lower()
        same = [d for d in self.variables.values() if d.name.lower() == lowered]
        if len(same) != 1:
            return None
        message = f"'{word.text}' is taken for '{same[0].name}': they differ in case"
        self.findings.warn("case-differs", message, word)
        return same[0]

    def _hedges_and_term(
        self, draft: Draft | None, variable: Word
    ) -> tuple[tuple[Hedge, ...], str]:
        hedges: list[Hedge] = []
        while True:
            hedge = FUZZYLITE_HEDGES.get(self.key())
            is_term = draft is not None and self._next_is_term(draft)
            if hedge is None or (is_term and not self._more_follows()):
                break
            hedges.append(hedge)
            self.at += 1
            if hedge.name == "any" and (self.key() in _ENDS or self.at >= len(self.words)):
                return tuple(hedges), self._any_term(draft, variable)
        word = self.take()
        if draft is None:
            return tuple(hedges), word.text
        return tuple(hedges), self._term(draft, word)

    def _next_is_term(self, draft: Draft) -> bool:
        return self.at < len(self.words) and draft.term(self.words[self.at].text) is not None

    def _more_follows(self) -> bool:
        following = self.words[self.at + 1].text.lower() if self.at + 1 < len(self.words) else ""
        return bool(following) and following not in _ENDS

    def _any_term(self, draft: Draft | None, variable: Word) -> str:
        if draft is None:
            return ""
        if not draft.terms:
            message = f"'{variable.text}' has no term that 'any' could stand for"
            raise RuleFaultError("undefined-term", message, variable)
        return draft.terms[0].name

    def _term(self, draft: Draft, word: Word) -> str:
        if draft.term(word.text) is not None:
            return word.text
        same = [t.name for t in draft.terms if t.name.lower() == word.text.lower()]
        if self.dialect.ignore_case and len(same) == 1:
            message = f"'{word.text}' is taken for '{same[0]}': they differ in case"
            self.findings.warn("case-differs", message, word)
            return same[0]
        following = self.words[self.at] if self.at < len(self.words) else None
        if following is not None and draft.term(following.text) is not None:
            self.findings.unknown("unknown-hedge", "the hedge", word, FUZZYLITE_HEDGES)
            self.at += 1
            return following.text
        names = [t.name for t in draft.terms]
        self.findings.unknown("undefined-term", f"the term of '{draft.name}'", word, names)
        return word.text

    def weight(self) -> float:
        """Read ``with`` and a number."""
        self.at += 1
        word = self.take()
        value = number(word.text)
        if value is None or math.isnan(value):
            raise RuleFaultError("not-a-number", f"'{word.text[:40]}' is no weight", word)
        return value


_ENDS = frozenset({"and", "or", "then", "with", ")", ","})


# --- What rules mean to fuzzylite, expressed in the model ---
#
# Three habits of that program need care. Hedges of a conclusion change the activation
# degree (weight times truth), not the set, and carry on to the conclusions after it. An
# output in an antecedent stands for the degree to which its term has been activated so
# far, not for a value. A switched-off variable gives truth 0, a switched-off output
# receives nothing.

MAX_NODES = 2_000
"""Most propositions that one antecedent may come to when outputs are put in."""

POWERS = {"very": 2.0, "somewhat": 0.5, "extremely": 3.0, "power": 1.0}
"""Exponents of the hedges that are powers; that of ``power`` is its own number."""

MACHINE_EPSILON = 1e-6
"""What the C++ program takes for zero: a rule that fires less does not fire."""

NEVER = (Hedge("not"), Hedge("any"))


@dataclass(frozen=True, slots=True)
class Norms:
    """The norms of a block; None where the file gives none.

    Attributes
    ----------
    conjunction, disjunction, implication : str or None
        Names in the model.
    threshold : float
        Firing strengths up to this count as none.
    """

    conjunction: str | None = None
    disjunction: str | None = None
    implication: str | None = None
    threshold: float = 0.0


class RuleBuilder:
    """Turns rule texts into rules, in the order in which they are evaluated.

    Parameters
    ----------
    variables : dict
        Name to variable, inputs and outputs.
    findings : Findings
        Where losses go.
    """

    def __init__(self, variables: dict[str, Draft], findings: Findings) -> None:
        self.variables = variables
        self.findings = findings
        self._fired: dict[tuple[str, str], list[tuple[Rule, Norms]]] = {}
        self._own: frozenset[str] = frozenset()
        self._sizes: dict[tuple[str, str], int] = {}

    def block(
        self,
        name: str,
        norms: Norms,
        texts: list[RuleText],
        later: frozenset[str] = frozenset(),
    ) -> RuleBlock:
        """Return the block of the rules `texts`; `later` blocks conclude other outputs.

        An output in an antecedent is replaced by the conditions that lead to it, where
        that is exact. Otherwise it stays where the model means the same: an output that
        rules of its own block conclude, all of them before the first that uses it.
        """
        rules: list[Rule] = []
        self._own = _finished_in(texts) - later
        for text in texts:
            self._need_norms(text, norms)
            for rule in self._rules(text, norms):
                rules.append(rule)
                for consequent in rule.consequents:
                    key = (consequent.variable, consequent.term)
                    self._fired.setdefault(key, []).append((rule, norms))
                    self._sizes[key] = self._sizes.get(key, 0) + _size(rule.antecedent)
        return RuleBlock(
            tuple(rules),
            name,
            norms.conjunction or "min",
            norms.disjunction or "max",
            norms.implication or "min",
            norms.threshold,
        )

    def _need_norms(self, text: RuleText, norms: Norms) -> None:
        for used, norm, key in (
            (text.uses_and, norms.conjunction, "and"),
            (text.uses_or, norms.disjunction, "or"),
        ):
            if used and norm is None:
                message = f"the rule says '{key}' but its block names no norm for it"
                self.findings.error("missing-norm", message, text.span)

    def _rules(self, text: RuleText, norms: Norms) -> list[Rule]:
        antecedent = self._expanded(text.antecedent, text.span, norms)
        rules: list[Rule] = []
        group: list[Consequent] = []
        hedges: tuple[Hedge, ...] = ()
        for conclusion in text.conclusions:
            draft = self.variables.get(conclusion.variable)
            if draft is not None and not draft.enabled:
                message = f"'{draft.name}' is switched off; the rule leaves it alone"
                self.findings.info("disabled-output", message, conclusion.span)
                continue
            if conclusion.hedges:
                if group:
                    rules.append(self._rule(antecedent, hedges, group, text))
                group, hedges = [], (*conclusion.hedges, *hedges)
            group.append(Consequent(conclusion.variable, conclusion.term, span=conclusion.span))
        if group:
            rules.append(self._rule(antecedent, hedges, group, text))
        return rules

    def _rule(
        self,
        antecedent: Expression,
        hedges: tuple[Hedge, ...],
        consequents: list[Consequent],
        text: RuleText,
    ) -> Rule:
        weight = hedged_weight(text.weight, hedges)
        if weight is None:
            message = (
                f"fuzzylite hedges weight times truth, which cannot be carried with the "
                f"weight {text.weight}"
            )
            self.findings.loss("hedged-weight", message, text.span)
            weight = text.weight
        return Rule(around(hedges, antecedent), tuple(consequents), weight, text.span)

    def _expanded(self, expression: Expression, span: Span, norms: Norms) -> Expression:
        expanded = self._put_in(expression, norms)
        if _size(expanded) > MAX_NODES:
            message = f"with its outputs put in, the rule has more than {MAX_NODES} propositions"
            self.findings.error("too-large", message, span)
            return expression
        return expanded

    def _put_in(self, expression: Expression, norms: Norms) -> Expression:
        if isinstance(expression, Is):
            return self._proposition(expression, norms)
        if isinstance(expression, Hedged):
            return hedged(expression.hedges, self._put_in(expression.operand, norms))
        operands = tuple(self._put_in(operand, norms) for operand in expression.operands)
        return type(expression)(operands)

    def _proposition(self, proposition: Is, norms: Norms) -> Expression:
        draft = self.variables.get(proposition.variable)
        if draft is None or (draft.enabled and not draft.is_output):
            return proposition
        if any(h.name == "any" for h in proposition.hedges):
            return self._constant(proposition, proposition.hedges)
        if not draft.enabled:
            message = f"'{draft.name}' is switched off; the proposition counts as false"
            self.findings.info("disabled-variable", message, proposition.span)
            return self._constant(proposition, NEVER)
        return hedged(proposition.hedges, self._activation(proposition, draft, norms))

    def _constant(self, proposition: Is, hedges: tuple[Hedge, ...]) -> Expression:
        """Return a proposition about an input whose hedges make it constant."""
        for draft in self.variables.values():
            if not draft.is_output and draft.terms:
                return Is(draft.name, draft.terms[0].name, hedges, proposition.span)
        message = "there is no input to carry a constant truth"
        self.findings.loss("chained-output", message, proposition.span)
        return proposition

    def _activation(self, proposition: Is, output: Draft, norms: Norms) -> Expression:
        fired = self._fired.get((proposition.variable, proposition.term), [])
        if not fired:
            message = f"no earlier rule concludes '{output.name} is {proposition.term}'"
            self.findings.warn("never-activated", message, proposition.span)
            return self._constant(proposition, NEVER)
        if self._sizes[proposition.variable, proposition.term] > MAX_NODES:
            what = "conditions to put in the place of an output"
            self.findings.room(MAX_NODES, MAX_NODES, what, proposition.span)
            return proposition
        reason = self._why_not(fired, output, norms)
        if reason and output.name in self._own:
            return proposition
        if reason:
            message = (
                f"fuzzylite takes the activation of '{output.name} is {proposition.term}' so "
                f"far, which cannot be carried here: {reason}"
            )
            self.findings.loss("chained-output", message, proposition.span)
        antecedents = tuple(rule.antecedent for rule, _ in fired)
        if not reason:
            message = (
                f"'{output.name} is {proposition.term}' means its activation to fuzzylite; "
                "the conditions that lead to it are put in its place"
            )
            self.findings.info("activation-put-in", message, proposition.span)
        return antecedents[0] if len(antecedents) == 1 else Or(antecedents)

    def _why_not(self, fired: list[tuple[Rule, Norms]], output: Draft, norms: Norms) -> str:
        if any(other.threshold > norms.threshold for _, other in fired):
            return "the block that leads to it has a threshold"
        if any(rule.weight != 1.0 for rule, _ in fired):
            return "a rule that leads to it has a weight"
        if len(fired) > 1 and output.aggregation != norms.disjunction:
            return f"the aggregation {output.aggregation} is not the disjunction of the block"
        for rule, other in fired:
            kinds = _connectives(rule.antecedent)
            if And in kinds and other.conjunction != norms.conjunction:
                return "the blocks differ in their conjunction"
            if Or in kinds and other.disjunction != norms.disjunction:
                return "the blocks differ in their disjunction"
        return ""


def around(hedges: tuple[Hedge, ...], antecedent: Expression) -> Expression:
    """Put hedges around a whole antecedent; not into it, so that they can be told apart."""
    if not hedges:
        return antecedent
    if isinstance(antecedent, Hedged):
        return Hedged((*hedges, *antecedent.hedges), antecedent.operand)
    return Hedged(hedges, antecedent)


def hedged_weight(weight: float, hedges: tuple[Hedge, ...]) -> float | None:
    """Return w' such that w' × hedges(d) is hedges(weight × d) for all d, or None.

    That holds for powers, as (w d)ᵖ = wᵖ dᵖ, for ``any`` and for the weight 1.
    """
    for hedge in reversed(hedges):
        if hedge.name == "any":
            weight = 1.0
        elif weight == 1.0:
            continue
        elif hedge.name in POWERS and weight > 0.0:
            weight = weight ** (hedge.exponent or POWERS[hedge.name])
        else:
            return None
    return weight


def concluded(texts: list[RuleText]) -> frozenset[str]:
    """Return the outputs that rules conclude."""
    return frozenset(c.variable for text in texts for c in text.conclusions)


def _finished_in(texts: list[RuleText]) -> frozenset[str]:
    """Return the outputs whose last conclusion stands before their first use."""
    last = {c.variable: i for i, text in enumerate(texts) for c in text.conclusions}
    first: dict[str, int] = {}
    for index, text in enumerate(texts):
        for part in propositions(text.antecedent):
            first.setdefault(part.variable, index)
    return frozenset(name for name, index in last.items() if index < first.get(name, len(texts)))


def _size(expression: Expression) -> int:
    if isinstance(expression, Is):
        return 1
    if isinstance(expression, Hedged):
        return 1 + _size(expression.operand)
    return 1 + sum(map(_size, expression.operands))


def _connectives(expression: Expression) -> set[type]:
    if isinstance(expression, Is):
        return set()
    if isinstance(expression, Hedged):
        return _connectives(expression.operand)
    return {type(expression)}.union(*map(_connectives, expression.operands))
