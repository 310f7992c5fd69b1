"""The block ``tune`` of a rule base: movable and fixed numbers in tuning.

Inference ignores it. Nodes as described in :mod:`fuzzyarm.language.statements`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from fuzzyarm.base.diagnostic import NOWHERE, Figure, Span, Word
from fuzzyarm.base.numbers import number_text
from fuzzyarm.language.parts import (
    Column,
    FixedText,
    Name,
    Number,
    OneOf,
    Part,
    Printed,
    Several,
    Values,
    VariableName,
)
from fuzzyarm.language.phrases import Occurrence, of_term, of_variable
from fuzzyarm.language.rows import StatementRow
from fuzzyarm.language.tokens import Cursor, Trivia, name_text

TUNE_ITEMS: dict[str, str] = {
    "peaks": "the peaks of the terms of these variables move",
    "gain": "gains of the controller that uses the rule base move",
    "keep": "terms, or all terms of a variable, stay where they are",
}
"""First words of the lines of ``tune``."""

PEAK_WORDS: dict[str, str] = {
    "mirrored": "opposite terms stay opposite about the middle of the range",
    "keep order": "no peak crosses its neighbour's",
    "partition": "each foot is under the neighbour's peak, so that memberships add up to 1",
    "gap": "how near neighbouring peaks may come, in percent of the range",
}
"""Options after the variables of ``peaks``."""

_CHOICES = ("mirrored", "keep", "partition", "gap")
_LISTED = "mirrored, keep order, partition or gap"


class TuneItem(NamedTuple):
    """One line of a ``tune`` block.

    `key` is one of TUNE_ITEMS. `names` are variables, gains, or for ``keep`` one variable; `terms`
    its fixed terms; `words` the options in the order of the text; `gap` that in percent; `low` and
    `high` the range of a gain.
    """

    key: Word
    names: tuple[Word, ...]
    words: tuple[str, ...] = ()
    terms: tuple[Word, ...] = ()
    gap: Figure | None = None
    low: Figure | None = None
    high: Figure | None = None
    trivia: Trivia = Trivia()
    span: Span = NOWHERE


class _PeakOptions(Part):
    """Options after the variables of ``peaks``, in any order, with commas between."""

    def read(self, cursor: Cursor, values: Values) -> None:
        words: list[str] = []
        gap: Figure | None = None
        more = _peak_word(cursor)
        while more is not None:
            if more == "gap":
                gap = cursor.figure("the smallest gap, in percent of the range")
                cursor.expect("%", "after the gap")
            else:
                words.append("keep order" if more == "keep" else more)
                if more == "keep":
                    cursor.expect("order", "after keep")
            if cursor.accept(",", likely=True) is None:
                break
            more = _peak_word(cursor)
            if more is None:
                cursor.fail(f"one of {_LISTED}", _CHOICES)
        values["words"], values["gap"] = tuple(words), gap

    def show(self, node: TuneItem, line: Printed) -> None:
        gap = [] if node.gap is None else [f"gap {number_text(node.gap)} %"]
        line.add(", ".join([*node.words, *gap]))

    def words(self) -> Iterator[tuple[str, str]]:
        yield from ((word, doc) for word, doc in PEAK_WORDS.items() if " " not in word)
        yield "order", PEAK_WORDS["keep order"]


def _peak_word(cursor: Cursor) -> str | None:
    """Take the first word of an option, if the line continues."""
    for word in _CHOICES:
        if cursor.accept(word):
            return word
    if cursor.at_end:
        return None
    return str(cursor.word(f"one of {_LISTED}", _CHOICES, "unknown-setting"))


class _Scale(Part):
    """``times``, ``log`` and ``, per axis`` after the range of a gain."""

    def read(self, cursor: Cursor, values: Values) -> None:
        words = [word for word in ("times", "log") if cursor.accept(word)]
        if cursor.accept(","):
            cursor.expect("per", "after the comma")
            cursor.expect("axis", "after per")
            words.append("per axis")
        values["words"] = tuple(words)

    def show(self, node: TuneItem, line: Printed) -> None:
        line.add(" ".join(word for word in node.words if word != "per axis"))
        if "per axis" in node.words:
            line.add(", per axis", "before")

    def words(self) -> Iterator[tuple[str, str]]:
        yield "times", "the ends are multiples of the value in the file"
        yield "log", "tuned in steps of its logarithm"
        yield "per", "one value for each axis, as in `per axis`"
        yield "axis", ""


class _FixedTerms(Part):
    """A variable with fixed terms; none for all."""

    def read(self, cursor: Cursor, values: Values) -> None:
        variable = cursor.variable("the name of a variable")
        terms: list[Word] = []
        cursor.suggest("terms", variable, terms)
        while not cursor.at_end:
            terms.append(cursor.term(f"a term of '{variable}'", variable))
            cursor.suggest("terms", variable, terms)
        values["names"], values["terms"] = (variable,), tuple(terms)

    def show(self, node: TuneItem, line: Printed) -> None:
        line.add(" ".join(map(name_text, (*node.names, *node.terms))))

    def mentions(self, node: TuneItem) -> Iterator[Occurrence]:
        (variable,) = node.names
        yield of_variable(variable)
        yield from (of_term(variable, word) for word in node.terms)


TUNE_ROW = StatementRow(
    TuneItem,
    OneOf(
        "key",
        "peaks, gain or keep",
        "unknown-setting",
        TUNE_ITEMS,
        {
            "peaks": (
                Several(VariableName("names", "the name of a variable")),
                Column(),
                _PeakOptions(),
            ),
            "gain": (  # gains are in another file
                Several(Name("names", "the name of a gain")),
                Column(),
                Number("low", "the lowest value"),
                FixedText("..", "between the ends of the range"),
                Number("high", "the highest value"),
                _Scale(),
            ),
            "keep": (_FixedTerms(),),
        },
    ),
)
"""A line below ``tune``."""


class TuneNode(NamedTuple):
    """The ``tune`` block; `unread` if a line of it is unreadable."""

    items: tuple[TuneItem, ...]
    unread: bool = False
    span: Span = NOWHERE
