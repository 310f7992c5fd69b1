"""The block ``tune`` of a rule base: what may move when it is tuned, and what stays as it is.

Inference does not read it. Nodes as :mod:`fuzzyarm.language.statements` says.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from fuzzyarm.language.phrases import Occurrence, aligned, of_term, of_variable
from fuzzyarm.language.tokens import Cursor, Fault, Figure, Trivia, Word, name_text
from fuzzyarm.text.diagnostic import NOWHERE, Span

__all__ = ["TUNE_ITEMS", "TUNE_WORDS", "TuneItem", "TuneNode"]

TUNE_ITEMS: dict[str, str] = {
    "peaks": "the peaks of the terms of these variables move",
    "gain": "gains of the controller that uses the rule base move",
    "keep": "terms, or all terms of a variable, stay where they are",
}
"""What a line of ``tune`` starts with."""

PEAK_WORDS: dict[str, str] = {
    "mirrored": "opposite terms stay opposite about the middle of the range",
    "keep order": "no peak crosses its neighbour's",
    "partition": "feet stand under the neighbours' peaks, so that memberships add up to 1",
    "gap": "how near neighbouring peaks may come, in percent of the range",
}
"""What stands behind the variables of ``peaks``."""

TUNE_WORDS: dict[str, str] = {
    **{word: doc for word, doc in PEAK_WORDS.items() if " " not in word},
    "order": PEAK_WORDS["keep order"],
    "times": "the ends are multiples of the value in the file",
    "log": "tuned in steps of its logarithm",
    "per": "one value for each axis, as in `per axis`",
    "axis": "",
}
"""The words of the block but those that start a line, each with one line of help."""

_CHOICES = ("mirrored", "keep", "partition", "gap")
_LISTED = "mirrored, keep order, partition or gap"


class TuneItem(NamedTuple):
    """One line of a ``tune`` block.

    `key` is one of TUNE_ITEMS. `names` are variables, gains, or of ``keep`` one variable;
    `terms` what is kept of it; `words` the options in the order of the text; `gap` that in
    percent; `low` and `high` the range of a gain.
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

    @classmethod
    def read(cls, cursor: Cursor, trivia: Trivia) -> TuneItem:
        """Read it from the cursor."""
        key = cursor.word("peaks, gain or keep", TUNE_ITEMS, "unknown-setting")
        read = {"peaks": cls._peaks, "gain": cls._gain, "keep": cls._keep}[key.text]
        found = read(key, cursor)
        cursor.finish()
        return found._replace(trivia=trivia, span=cursor.whole)

    @classmethod
    def _peaks(cls, key: Word, cursor: Cursor) -> TuneItem:
        names = [cursor.variable("the name of a variable")]
        while cursor.accept(","):
            names.append(cursor.variable("the name of a variable"))
        words: list[str] = []
        gap: Figure | None = None
        more = cls._peak_word(cursor)
        while more is not None:
            if more == "gap":
                gap = cursor.figure("the smallest gap, in percent of the range")
                cursor.expect("%", "behind the gap")
            else:
                words.append("keep order" if more == "keep" else more)
                if more == "keep":
                    cursor.expect("order", "behind keep")
            if cursor.accept(",", likely=True) is None:
                break
            more = cls._peak_word(cursor)
            if more is None:
                cursor.fail(f"one of {_LISTED}", _CHOICES)
        return cls(key, tuple(names), tuple(words), gap=gap)

    @staticmethod
    def _peak_word(cursor: Cursor) -> str | None:
        """Take the first word of an option, if the line goes on."""
        for word in _CHOICES:
            if cursor.accept(word):
                return word
        if not cursor.at_end:
            cursor.fail(f"one of {_LISTED}", _CHOICES, "unknown-setting")
        return None

    @classmethod
    def _gain(cls, key: Word, cursor: Cursor) -> TuneItem:
        names = [cursor.name("the name of a gain")]
        while cursor.accept(","):
            names.append(cursor.name("the name of a gain"))
        low = cursor.figure("the lowest value")
        cursor.expect("..", "between the ends of the range")
        high = cursor.figure("the highest value")
        words = [word for word in ("times", "log") if cursor.accept(word)]
        if cursor.accept(","):
            cursor.expect("per", "behind the comma")
            cursor.expect("axis", "behind per")
            words.append("per axis")
        return cls(key, tuple(names), tuple(words), low=low, high=high)

    @classmethod
    def _keep(cls, key: Word, cursor: Cursor) -> TuneItem:
        variable = cursor.variable("the name of a variable")
        terms: list[Word] = []
        cursor.suggest("terms", variable, terms)
        while not cursor.at_end:
            terms.append(cursor.term(f"a term of '{variable.text}'", variable))
            cursor.suggest("terms", variable, terms)
        return cls(key, (variable,), terms=tuple(terms))

    def in_columns(self) -> list[str]:
        """Return what it is about, and how."""
        names = ", ".join(map(str, self.names))
        if self.key.text == "keep":
            return [" ".join([f"keep {names}", *map(str, self.terms)])]
        if self.key.text == "gain":
            scale = " ".join(word for word in self.words if word != "per axis")
            axis = ", per axis" if "per axis" in self.words else ""
            body = f"{self.low} .. {self.high}{' ' if scale else ''}{scale}{axis}"
            return [f"gain {', '.join(name_text(word.text) for word in self.names)}", body]
        gap = [] if self.gap is None else [f"gap {self.gap} %"]
        body = ", ".join([*self.words, *gap])
        return [f"peaks {names}", *([body] if body else [])]

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the variables and terms in it; gains stand in another file."""
        if self.key.text == "gain":
            return
        yield from map(of_variable, self.names)
        yield from (of_term(self.names[0], word) for word in self.terms)


class TuneNode(NamedTuple):
    """The ``tune`` block."""

    items: tuple[TuneItem, ...]
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> TuneNode:
        """Read it from the cursor."""
        cursor.take()
        cursor.finish()
        items = []
        for line in cursor.lines:
            try:
                items.append(TuneItem.read(Cursor(line.tokens), line.trivia))
            except Fault as fault:
                cursor.forgiven.append(fault.diagnostic)
        return cls(tuple(items), cursor.whole)

    def __str__(self) -> str:
        return "tune"

    def below(self) -> list[tuple[str, Trivia]]:
        """Return the lines; ``peaks`` and ``gain`` are aligned."""
        lines = aligned([item.in_columns() for item in self.items])
        return list(zip(lines, (item.trivia for item in self.items), strict=True))

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        for item in self.items:
            yield from item.mentions()
