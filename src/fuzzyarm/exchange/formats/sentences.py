"""Rule sentences, ``if … then … with …``, as FLL and FCL write them.

A sentence, or a line of numbers in a FIS, becomes a :class:`RuleText`;
:mod:`fuzzyarm.exchange.formats.meaning` knows its meaning in each program.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from fuzzyarm.base.diagnostic import Span
from fuzzyarm.exchange.formats.dialects import Dialect, words
from fuzzyarm.exchange.formats.drafts import VariableDraft
from fuzzyarm.exchange.formats.findings import FaultError, Findings, TextPiece, number
from fuzzyarm.language.model.rulebase import And, Consequent, Expression, Hedge, Hedged, Is, Or
from fuzzyarm.symbolic.kinds import HEDGES

NOT = Hedge("not")

MAX_NESTING = 50
MAX_CONCLUSIONS = 200


_ENDS = frozenset({"and", "or", "then", "with", ")", ","})
"""Words that may follow a proposition."""


@dataclass(frozen=True, slots=True)
class RuleText:
    """A rule as written; the meaning of its hedges depends on the format."""

    antecedent: Expression
    conclusions: tuple[Consequent, ...]
    weight: float
    span: Span


def hedged(hedges: tuple[Hedge, ...], inner: Expression) -> Expression:
    """Put hedges around an expression, or into a single proposition."""
    if not hedges:
        return inner
    if isinstance(inner, Is):
        return Is(inner.variable, inner.term, (*hedges, *inner.hedges), inner.span)
    if isinstance(inner, Hedged):
        return Hedged((*hedges, *inner.hedges), inner.operand)
    return Hedged(hedges, inner)


def read_sentences(
    rules: Iterable[list[TextPiece]],
    variables: dict[str, VariableDraft],
    findings: Findings,
    dialect: Dialect,
    more_hedges: Mapping[str, Hedge] | None = None,
) -> list[RuleText]:
    """Read rules, given as words with separate parentheses and commas; report the faulty ones.

    `more_hedges` are the program's own hedges beside those of the records.
    """
    parser = _Parser(variables, findings, dialect)
    parser.hedges |= more_hedges or {}
    texts = []
    for sentence in rules:
        try:
            texts.append(parser.rule(sentence))
        except FaultError as fault:
            findings.fault(fault)
    return texts


class _Parser:
    """Recursive descent over the words of a rule; unknown names are reported and skipped."""

    def __init__(
        self, variables: dict[str, VariableDraft], findings: Findings, dialect: Dialect
    ) -> None:
        self.variables = variables
        self.findings = findings
        self.dialect = dialect
        hedge_words = words(HEDGES, dialect.hedges or dialect.kinds)
        self.hedges = {word: Hedge(name) for word, name in hedge_words.items()}
        self.words: list[TextPiece] = []
        self.at = 0

    def rule(self, sentence: list[TextPiece]) -> RuleText:
        self.words, self.at = sentence, 0
        self.expect("if")
        antecedent = self.condition(0)
        self.expect("then")
        conclusions = self.conclusions(0)
        weight = self.weight() if self.key() == "with" else 1.0
        if self.at < len(self.words):
            word = self.words[self.at]
            raise FaultError(f"'{word.text[:40]}' is not expected here", word)
        span = self.words[0].span.to(self.words[-1].span)
        return RuleText(antecedent, tuple(conclusions), weight, span)

    def key(self) -> str:
        if self.at >= len(self.words):
            return ""
        text = self.words[self.at].text
        return text.lower() if self.dialect.any_case else text

    def take(self) -> TextPiece:
        if self.at >= len(self.words):
            raise FaultError("the rule ends too early", self.words[-1])
        self.at += 1
        return self.words[self.at - 1]

    def expect(self, key: str) -> None:
        if self.key() != key:
            word = self.take()
            message = f"'{key}' is expected here, not '{word.text[:40]}'"
            raise FaultError(message, word)
        self.at += 1

    def condition(self, depth: int) -> Expression:
        if depth > MAX_NESTING:
            message = f"parentheses may nest at most {MAX_NESTING} deep"
            at = self.words[min(self.at, len(self.words) - 1)]
            raise FaultError(message, at, "too-deep")
        # In some programs `and` and `or` have equal precedence, from left to right.
        if self.dialect.equal_precedence:
            return self._chain(("and", "or"), lambda: self._factor(depth))
        both = ("and", ",") if self.dialect.commas else ("and",)
        return self._chain(("or",), lambda: self._chain(both, lambda: self._factor(depth)))

    def _chain(self, keys: tuple[str, ...], operand: Callable[[], Expression]) -> Expression:
        left = operand()
        chained = False  # a parenthesis stays a node of its own
        while self.key() in keys:
            kind = Or if self.key() == "or" else And
            self.at += 1
            earlier = left.operands if chained and isinstance(left, kind) else (left,)
            left = kind((*earlier, operand()))
            chained = True
        return left

    def _factor(self, depth: int) -> Expression:
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
        return hedged((NOT,) * negations, inner)

    def proposition(self) -> Is:
        """Read *variable is [hedges] term*."""
        self._demand_variable("condition")
        variable, draft = self._variable(outputs_only=False)
        self.expect("is")
        hedges, term = self._hedges_and_term(draft, variable)
        self._note_other_hedges(hedges, variable)
        return Is(variable.text, term, hedges, variable.span)

    def conclusions(self, depth: int) -> list[Consequent]:
        """Read conclusions, with the parentheses that people add and no program writes."""
        consequents: list[Consequent] = []
        while True:
            if self.key() == "(" and self.dialect.any_case and depth < MAX_NESTING:
                self.at += 1
                consequents += self.conclusions(depth + 1)
                self.expect(")")
            else:
                consequents.append(self.conclusion())
            if len(consequents) > MAX_CONCLUSIONS:
                message = f"a rule may have at most {MAX_CONCLUSIONS} conclusions"
                raise FaultError(message, self.words[self.at - 1], "too-many")
            if self.key() not in self.dialect.separators:
                return consequents
            self.at += 1

    def conclusion(self) -> Consequent:
        """Read *output is [hedges] term*."""
        self._demand_variable("conclusion")
        variable, draft = self._variable(outputs_only=True)
        self.expect("is")
        hedges, term = self._hedges_and_term(draft, variable)
        if self.dialect.producer == "scikit-fuzzy":
            if hedges == (NOT,):  # other combinations make a term of their own
                message = f"{self.dialect.program} fails at a conclusion with NOT alone"
                hint = "name the term that is meant"
                self.findings.error("hedged-conclusion", message, variable, hint)
        elif NOT in hedges and not self.dialect.negates:
            message = (
                f"{self.dialect.program} drops the NOT of a conclusion: to it this rule says "
                f"{variable.text} IS {term}"
            )
            hint = "name the term that is meant"
            self.findings.error("hedged-conclusion", message, variable, hint)
        else:
            self._note_other_hedges(hedges, variable)
        return Consequent(variable.text, term, hedges, variable.span)

    def _demand_variable(self, role: str) -> None:
        """Raise at a lone word, as in *if hot then on*, which names no variable."""
        following = self.words[self.at + 1].text.lower() if self.at + 1 < len(self.words) else ""
        if self.at >= len(self.words) or following not in ("", *_ENDS):
            return
        word = self.words[self.at]
        owners = [name for name, d in self.variables.items() if d.term(word.text) is not None]
        message = f"'{word.text[:40]}' alone is not a {role}, which is 'variable IS term'"
        if word.text in self.variables:
            message = f"{message}: it is a variable, and no term is named"
        elif owners:
            message = f"{message}: it is a term of {' and '.join(owners[:3])}"
        raise FaultError(message, word, "lone-word")

    def _note_other_hedges(self, hedges: tuple[Hedge, ...], variable: TextPiece) -> None:
        """Report hedges unknown to the program, but read here."""
        if self.dialect.kinds != "jfl" or set(hedges) <= {NOT}:
            return
        message = (
            f"{self.dialect.program} has no hedge '{next(h for h in hedges if h != NOT).name}' and "
            "fails at it; it is read as fuzzylite has it"
        )
        self.findings.warn("guessed-hedge", message, variable)

    def _variable(self, *, outputs_only: bool) -> tuple[TextPiece, VariableDraft | None]:
        word = self.take()
        draft = self.variables.get(word.text)
        if draft is None and (near := self._same_but_case(word)) is not None:
            word, draft = TextPiece(near.name, word.span), near
        if draft is None:
            names = [n for n, d in self.variables.items() if d.is_output or not outputs_only]
            self.findings.unknown("undefined-variable", "the variable", word, names)
        elif outputs_only and not draft.is_output:
            message = f"'{word.text}' is an input; a rule cannot conclude on it"
            self.findings.error("not-an-output", message, word)
        return word, draft

    def _same_but_case(self, word: TextPiece) -> VariableDraft | None:
        if not self.dialect.any_case:
            return None
        lowered = word.text.lower()
        same = [d for d in self.variables.values() if d.name.lower() == lowered]
        if len(same) != 1:
            return None
        message = f"'{word.text}' is taken for '{same[0].name}': they differ in case"
        self.findings.warn("case-differs", message, word)
        return same[0]

    def _hedges_and_term(
        self, draft: VariableDraft | None, variable: TextPiece
    ) -> tuple[tuple[Hedge, ...], str]:
        hedges: list[Hedge] = []
        while True:
            hedge = self.hedges.get(self.key())
            is_term = draft is not None and self._next_is_term(draft)
            # A term may have the name of a hedge: the last word of a proposition is the term.
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

    def _next_is_term(self, draft: VariableDraft) -> bool:
        return self.at < len(self.words) and draft.term(self.words[self.at].text) is not None

    def _more_follows(self) -> bool:
        following = self.words[self.at + 1].text.lower() if self.at + 1 < len(self.words) else ""
        return bool(following) and following not in _ENDS

    def _any_term(self, draft: VariableDraft | None, variable: TextPiece) -> str:
        if draft is None:
            return ""
        if not draft.terms:
            message = f"'{variable.text}' has no term that 'any' could stand for"
            raise FaultError(message, variable, "undefined-term")
        return draft.terms[0].name

    def _term(self, draft: VariableDraft, word: TextPiece) -> str:
        if draft.term(word.text) is not None or word.text in draft.refused:
            return word.text
        same = [t.name for t in draft.terms if t.name.lower() == word.text.lower()]
        if self.dialect.any_case and len(same) == 1:
            message = f"'{word.text}' is taken for '{same[0]}': they differ in case"
            self.findings.warn("case-differs", message, word)
            return same[0]
        following = self.words[self.at] if self.at < len(self.words) else None
        if following is not None and draft.term(following.text) is not None:
            self.findings.unknown("unknown-hedge", "the hedge", word, self.hedges)
            self.at += 1
            return following.text
        names = [t.name for t in draft.terms]
        self.findings.no_term(draft.name, word, names)
        return word.text

    def weight(self) -> float:
        self.at += 1
        word = self.take()
        value = number(word.text)
        if value is None or math.isnan(value):
            raise FaultError(f"'{word.text[:40]}' is not a weight", word, "not-a-number")
        return value
