"""A rule as its author wrote it, before its meaning is settled."""

from __future__ import annotations

from dataclasses import dataclass

from fuzzyarm.formats.imported import Word
from fuzzyarm.rulebase.diagnostic import Span
from fuzzyarm.rulebase.model import And, Consequent, Expression, Hedge, Hedged, Is, Or

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
