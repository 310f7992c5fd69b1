"""Read ``if … then … with …`` as FLL and FCL write it."""

from __future__ import annotations

import math

from fuzzyarm.formats.draft import Draft
from fuzzyarm.formats.imported import Findings, Word
from fuzzyarm.formats.numerals import number
from fuzzyarm.formats.rule_text import (
    FUZZYLITE_HEDGES,
    NOT,
    Dialect,
    RuleFaultError,
    RuleText,
    hedged,
    joined,
)
from fuzzyarm.rulebase.model import And, Consequent, Expression, Hedge, Is, Or

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
