"""The parts that the lines of a controller are made of: times, numbers, sources, sums, options.

Nodes as in :mod:`fuzzyarm.language.phrases`. What a signal may come from, and the options of each
source, is the table :data:`fuzzyarm.model.controller.SOURCES`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from fuzzyarm.language.phrases import Kind, Occurrence
from fuzzyarm.language.tokens import Cursor, Fault, Figure, Word
from fuzzyarm.model.controller import SOURCES, TIMES, OptionKind
from fuzzyarm.text.diagnostic import NOWHERE, Diagnostic, Span
from fuzzyarm.text.numbers import number_text

__all__ = [
    "AmountNode",
    "CallNode",
    "FactorNode",
    "OptionNode",
    "ProductNode",
    "SourceNode",
    "TimeNode",
    "of_sheet",
    "of_signal",
    "read_amount",
    "read_sheet",
    "read_signals",
    "sum_text",
]


def of_signal(word: Word) -> Occurrence:
    """Return the mention of a signal, a gain or a partner."""
    return Occurrence(Kind.SIGNAL, word.text, word.span)


def of_sheet(word: Word) -> Occurrence:
    """Return the mention of a rule base or a table that is used."""
    return Occurrence(Kind.USE, word.text, word.span)


# --- Times and numbers ---


class TimeNode(NamedTuple):
    """A time with its unit."""

    figure: Figure
    unit: str

    @classmethod
    def read(cls, cursor: Cursor, what: str, turns: float | None = None) -> TimeNode:
        """Read a number and a unit.

        `turns` is what a frequency times this time would be: 1 for a period, 1/(2 pi) for the
        time constant of a cut-off, None where neither is meant.
        """
        figure = cursor.figure(what)
        cursor.suggest("times")
        token = cursor.peek()
        if token is None or token.kind != "name" or token.text not in TIMES:
            raise Fault(_without_unit(figure, cursor, turns))
        return cls(figure, cursor.take().text)

    @property
    def seconds(self) -> float:
        """The time, s."""
        number, of_a_second = TIMES[self.unit]
        return self.figure.value * number / of_a_second

    def __str__(self) -> str:
        return f"{self.figure} {self.unit}"


UNITS_ELSEWHERE = {
    **dict.fromkeys(("sec", "secs", "second", "seconds"), "s"),
    **dict.fromkeys(("msec", "msecs", "millis", "millisecond", "milliseconds"), "ms"),
    **dict.fromkeys(("µs", "μs", "usec", "usecs", "microsecond", "microseconds"), "us"),
    **dict.fromkeys(("mins", "minute", "minutes"), "min"),
    **dict.fromkeys(("hr", "hrs", "hour", "hours"), "h"),
}
"""What units of time are called elsewhere, in small letters."""

HERTZ = {"hz": 1.0, "khz": 1e3}


def _without_unit(figure: Figure, cursor: Cursor, turns: float | None) -> Diagnostic:
    """Describe a number that is to be a time and has no unit of it."""
    token = cursor.peek()
    found = "nothing" if token is None or token.kind == "mark" else f"'{token.text}'"
    message = f"expected a unit of time behind {figure}, found {found}"
    small = token.text.lower() if token is not None else ""
    unit = UNITS_ELSEWHERE.get(small) or (small if small in TIMES else None)
    if unit is not None:
        hint = f"write  {figure} {unit}"
        return Diagnostic("missing-unit", message, cursor.span, hint=hint, replacement=unit)
    if small in HERTZ and figure.value > 0.0:
        span = figure.span.to(cursor.span)
        message = f"a time is wanted, not a frequency: {figure} {token.text if token else ''}"
        if turns is None:
            return Diagnostic("missing-unit", message, span, hint=f"one of {', '.join(TIMES)}")
        milliseconds = float(f"{1e3 * turns / (HERTZ[small] * figure.value):.6g}")
        time = f"{number_text(milliseconds)} ms"
        if turns != 1.0:
            message += "; the time constant of a cut-off is 1 / (2 pi f)"
        return Diagnostic("missing-unit", message, span, hint=f"write  {time}", replacement=time)
    hint = f"one of {', '.join(TIMES)}, as in  {figure} s"
    return Diagnostic("missing-unit", message, cursor.span, hint=hint)


def _with_unit(word: Word, figure: Figure, unit: str, span: Span) -> Diagnostic:
    """Describe a unit behind a number that has the unit of a signal."""
    message = f"the {word} is a number in the unit of its signal, found '{unit}' behind it"
    hint = f'leave it out, or write  gain NAME = {figure} "{unit}"  above and  {word} NAME'
    return Diagnostic("trailing-text", message, span, hint=hint)


class AmountNode(NamedTuple):
    """Numbers and ``pi`` between ``*`` and ``/``; None stands for pi, true for what divides."""

    factors: tuple[tuple[Figure | None, bool], ...]
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> AmountNode:
        """Read factors up to something else."""
        start = cursor.span
        factors = [(cls._factor(cursor), False)]
        while cursor.next_is("*") or cursor.next_is("/"):
            divides = cursor.take().text == "/"
            factors.append((cls._factor(cursor), divides))
        return cls(tuple(factors), start.to(cursor.tokens[cursor.position - 1].span))

    @staticmethod
    def _factor(cursor: Cursor) -> Figure | None:
        return None if cursor.accept("pi") else cursor.figure("a number or pi")

    def __str__(self) -> str:
        text = ""
        for figure, divides in self.factors:
            text += ("/" if divides else "*") if text else ""
            text += "pi" if figure is None else str(figure)
        return text


# --- Sums, options, sources ---


class FactorNode(NamedTuple):
    """A number, or the name of a signal, a gain or a partner; whether it divides."""

    value: Figure | Word
    divides: bool = False
    partner: bool = False

    @classmethod
    def read(cls, cursor: Cursor, divides: bool = False) -> FactorNode:
        """Read it from the cursor."""
        cursor.suggest("signals")
        if cursor.at_figure and not cursor.next_is("-") and not cursor.next_is("+"):
            return cls(cursor.figure("a number"), divides)
        if cursor.next_is("partner") and not cursor.next_is("*", 1):
            cursor.take()
            return cls(cursor.name("the name of a partner"), divides, partner=True)
        return cls(cursor.name("a signal, a gain or a number"), divides)

    def __str__(self) -> str:
        return f"partner {self.value}" if self.partner else str(self.value)

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        if isinstance(self.value, Word):
            yield of_signal(self.value)


class ProductNode(NamedTuple):
    """Factors from left to right."""

    factors: tuple[FactorNode, ...]
    negative: bool = False

    @classmethod
    def read_all(cls, cursor: Cursor) -> tuple[ProductNode, ...]:
        """Read a sum of products."""
        negative = cursor.accept("-") is not None
        products = [cls(cls.read_factors(cursor, FactorNode.read(cursor)), negative)]
        while cursor.next_is("+") or cursor.next_is("-"):
            negative = cursor.take().text == "-"
            products.append(cls(cls.read_factors(cursor, FactorNode.read(cursor)), negative))
        return tuple(products)

    @staticmethod
    def read_factors(cursor: Cursor, *first: FactorNode) -> tuple[FactorNode, ...]:
        """Read what stands behind ``*`` and ``/``."""
        factors = list(first)
        while cursor.next_is("*") or cursor.next_is("/"):
            divides = cursor.take().text == "/"
            factors.append(FactorNode.read(cursor, divides))
        return tuple(factors)

    def __str__(self) -> str:
        first, *others = self.factors
        return str(first) + "".join(f" {'/' if each.divides else '*'} {each}" for each in others)


def sum_text(products: tuple[ProductNode, ...]) -> str:
    """Return a sum of products as it is written."""
    text = ""
    for product in products:
        if text:
            text += " - " if product.negative else " + "
        elif product.negative:
            text = "-"
        text += str(product)
    return text


class CallNode(NamedTuple):
    """``(S, …)`` behind the name of a rule base or a table."""

    inputs: tuple[Word, ...]

    @classmethod
    def read(cls, cursor: Cursor) -> CallNode:
        """Read it from the cursor."""
        cursor.expect("(", "before the inputs")
        inputs = read_signals(cursor)
        cursor.expect(")", "after the inputs")
        return cls(inputs)

    def __str__(self) -> str:
        return f"({', '.join(map(str, self.inputs))})"


class OptionNode(NamedTuple):
    """What stands behind a comma: a word of the source and what it takes."""

    word: Word
    value: Figure | Word | TimeNode | None = None
    high: Figure | None = None
    rest: tuple[str, ...] = ()

    @classmethod
    def read(cls, cursor: Cursor, known: dict[str, OptionKind], what: str) -> OptionNode:
        """Read an option of a source."""
        word = cursor.word(f"one of {', '.join(known)}", known, "unknown-option")
        kind = known[word.text]
        if kind.takes == "words":
            for each in kind.rest:
                cursor.expect(each, f"behind {word.text}")
            return cls(word, rest=kind.rest)
        if kind.takes == "time":
            return cls(word, TimeNode.read(cursor, f"the time of {word.text}", 0.5 / math.pi))
        if kind.takes == "range":
            low = cursor.figure("the lower end", finite=False)
            cursor.expect("..", "between the ends of the range")
            return cls(word, low, cursor.figure("the upper end", finite=False))
        if kind.takes == "windup":
            if cursor.accept("hold"):
                return cls(word, rest=("hold",))
            cursor.expect("back", f"or 'hold' behind {word.text}")
            return cls(word, TimeNode.read(cursor, "the time to go back in"), rest=("back",))
        if kind.takes == "figure":
            amount: Figure | Word = cursor.figure(f"a number behind {word.text}")
        else:
            amount = read_amount(cursor, f"the {word.text}")
        token = cursor.peek()
        if kind.alike and isinstance(amount, Figure) and token and token.kind != "mark":
            raise Fault(_with_unit(word, amount, token.text, cursor.span))
        return cls(word, amount)

    def __str__(self) -> str:
        parts = [self.word.text, *self.rest]
        if self.high is not None:
            parts.append(f"{self.value} .. {self.high}")
        elif self.value is not None:
            parts.append(str(self.value))
        return " ".join(parts)

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the gain in it."""
        if isinstance(self.value, Word):
            yield of_signal(self.value)


def read_signals(cursor: Cursor) -> tuple[Word, ...]:
    """Read signals with commas between them."""
    signals: list[Word] = []
    while not signals or cursor.accept(","):
        cursor.suggest("signals")
        signals.append(cursor.name("a signal"))
    return tuple(signals)


def read_sheet(cursor: Cursor, what: str) -> Word:
    """Read the name of a rule base or a table."""
    cursor.suggest("sheets")
    return cursor.name(what)


def read_amount(cursor: Cursor, what: str) -> Figure | Word:
    """Read a number, or the name of a gain."""
    cursor.suggest("signals")
    return cursor.figure(what) if cursor.at_figure else cursor.name(f"{what}, or a gain")


class SourceNode(NamedTuple):
    """Where a signal comes from."""

    kind: Word
    name: Word
    call: CallNode | None = None

    @classmethod
    def read(cls, cursor: Cursor) -> SourceNode | None:
        """Read a source; None where the next word is none."""
        cursor.suggest("sources")
        token = cursor.peek()
        if token is None or token.kind != "name" or token.text not in SOURCES:
            return None
        following = cursor.peek(1)
        if following is not None and following.kind not in ("name", "quoted"):
            return None  # a signal that is called like a source
        kind = cursor.word("a source", SOURCES, "unknown-source")
        of = SOURCES[kind.text].of
        if of == "call":
            return cls(
                kind, read_sheet(cursor, f"the name of the {kind.text}"), CallNode.read(cursor)
            )
        read = kind.text
        for word in SOURCES[kind.text].joined.split():
            cursor.expect(word, f"behind {read}")
            read += f" {word}" if word == "of" else ""
        cursor.suggest("signals" if of == "signal" else "ports")
        return cls(kind, cursor.name("a signal" if of == "signal" else "a port of the plant"))

    def __str__(self) -> str:
        kind = self.kind.text
        of = SOURCES[kind].of
        if of == "call":
            return f"{kind} {self.name}{self.call}"
        return f"{kind}{SOURCES[kind].joined} {self.name}"

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        of = SOURCES[self.kind.text].of
        if of == "call":
            yield of_sheet(self.name)
        elif of == "signal":
            yield of_signal(self.name)
        else:
            yield Occurrence(Kind.PORT, self.name.text, self.name.span)
        if self.call is not None:
            yield from map(of_signal, self.call.inputs)
