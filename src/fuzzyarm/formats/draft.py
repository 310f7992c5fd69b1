"""A variable while its file is being read, and how it ends up in the model."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from fuzzyarm.formats.imported import MAX_TERMS, Findings, Word
from fuzzyarm.rulebase.limits import MAX_MAGNITUDE
from fuzzyarm.rulebase.model import Consequent, Defuzzifier, Input, Output, Shape, Term


@dataclass(slots=True)
class Draft:
    """A variable in the making.

    Attributes
    ----------
    word : Word
        Its name and where that stands.
    is_output : bool
        Whether it is an output.
    low, high : float
        The range; infinite until the file says more.
    terms : list of Term
        In order; changed by :meth:`add` and :meth:`put`.
    enabled : bool
        False where the file switches the variable off.
    """

    word: Word
    is_output: bool
    low: float = -math.inf
    high: float = math.inf
    terms: list[Term] = field(default_factory=list)
    description: str = ""
    outside: str = "extend"
    enabled: bool = True
    aggregation: str = "sum"
    defuzzifier: Defuzzifier = field(default_factory=Defuzzifier)
    no_rule: float | str = math.nan
    _index: dict[str, Term] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """The name."""
        return self.word.text

    def term(self, name: str) -> Term | None:
        """Return the term called `name`, or None."""
        return self._index.get(name)

    def add(self, term: Term) -> None:
        """Add a term."""
        self.terms.append(term)
        self._index.setdefault(term.name, term)

    def put(self, index: int, term: Term) -> None:
        """Put a term in the place of one with the same name."""
        self.terms[index] = term
        self._index[term.name] = term

    def input(self) -> Input:
        """Return the finished input."""
        return Input(
            self.name, self.low, self.high, tuple(self.terms), self.description, self.outside,
            span=self.word.span,
        )  # fmt: skip

    def output(self) -> Output:
        """Return the finished output."""
        return Output(
            self.name, self.low, self.high, tuple(self.terms), self.description, self.outside,
            span=self.word.span, aggregation=self.aggregation, defuzzifier=self.defuzzifier,
            no_rule=self.no_rule,
        )  # fmt: skip

    def settle_range(self, findings: Findings) -> None:
        """Widen a range without width, turn one that is the wrong way round."""
        if math.isnan(self.low) or math.isnan(self.high):
            findings.error("bad-range", f"the range of '{self.name}' has a nan", self.word)
            self.low, self.high = -math.inf, math.inf
        if self.low > self.high:
            message = f"the range of '{self.name}' runs from {self.low} down to {self.high}"
            findings.error("bad-range", message, self.word)
            self.low, self.high = self.high, self.low
        if self.low == self.high:
            message = f"the range of '{self.name}' has no width; half a unit is added either side"
            findings.warn("empty-range", message, self.word)
            self.low, self.high = self.low - 0.5, self.high + 0.5
        if any(MAX_MAGNITUDE < abs(end) < math.inf for end in (self.low, self.high)):
            message = f"the range of '{self.name}' goes beyond {MAX_MAGNITUDE:g}"
            findings.error("bad-range", message, self.word)
        if self.low == self.high:  # beyond 2**53 half a unit is nothing
            self.high = math.nextafter(self.low, math.inf)


def add_term(draft: Draft, word: Word, shape: Shape, findings: Findings, *, keep: str) -> None:
    """Add a term; of two with one name keep the ``first`` or the ``last``, and say so."""
    term = Term(word.text, shape, word.span)
    earlier = draft.term(word.text)
    if earlier is None:
        if findings.room(len(draft.terms), MAX_TERMS, "terms of a variable", word):
            draft.add(term)
        return
    kept = "first" if keep == "first" else "last"
    message = f"'{draft.name}' has two terms called '{word.text}'; the {kept} counts"
    findings.duplicate("duplicate-term-name", message, word, earlier.span)
    if keep == "last":
        draft.put(draft.terms.index(earlier), term)


def unique_name(name: str, taken: set[str]) -> str:
    """Return `name`, or `name` with the first number that makes it unique."""
    if name not in taken:
        return name
    number = 2
    while f"{name}_{number}" in taken:
        number += 1
    return f"{name}_{number}"


VALUES = frozenset({"singleton", "linear", "formula"})
"""Kinds of shape that are a number rather than a set."""


def same_value(consequent: Consequent, variables: dict[str, Draft]) -> Consequent:
    """Name the first term with the same value, for programs that aggregate by value."""
    draft = variables.get(consequent.variable)
    term = draft.term(consequent.term) if draft is not None else None
    if draft is None or term is None or term.shape.kind not in VALUES:
        return consequent
    first = next(t for t in draft.terms if t.shape == term.shape)
    return replace(consequent, term=first.name)
