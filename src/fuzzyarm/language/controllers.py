"""The statements of a controller: a record each, and a node that reads and writes itself.

They stand below a line ``controller NAME``, and are words of the language there only. Records and
nodes are as :mod:`fuzzyarm.language.statements` says; what a signal may come from is the table
:data:`fuzzyarm.model.controller.SOURCES`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from fuzzyarm.language.phrases import Kind, Occurrence, declared
from fuzzyarm.language.statements import StatementKind
from fuzzyarm.language.tokens import STARTERS, Cursor, Fault, Figure, Word
from fuzzyarm.model.controller import SOURCES, TIMES, OptionKind
from fuzzyarm.text.diagnostic import NOWHERE, Diagnostic, Span
from fuzzyarm.text.names import quote

__all__ = [
    "AmountNode",
    "AxisNode",
    "CallNode",
    "ControllerHeading",
    "DriveNode",
    "FactorNode",
    "GainNode",
    "LearnNode",
    "OptionNode",
    "PartnerNode",
    "PeriodNode",
    "ProductNode",
    "SetPointNode",
    "SignalNode",
    "SourceNode",
    "TimeNode",
    "UseNode",
    "ZoomNode",
]


def of_signal(word: Word) -> Occurrence:
    """Return the mention of a signal, a gain or a partner."""
    return Occurrence(Kind.SIGNAL, word.text, word.span)


def of_sheet(word: Word) -> Occurrence:
    """Return the mention of a rule base or a table that is used."""
    return Occurrence(Kind.USE, word.text, word.span)


# --- Heading, files, timing ---


class ControllerHeading(NamedTuple):
    """``controller NAME "description"``."""

    name: Word
    description: str | None
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> ControllerHeading:
        """Read it from the cursor."""
        cursor.take()
        return cls(cursor.name("the name of the controller"), cursor.string(), cursor.whole)

    def __str__(self) -> str:
        described = "" if self.description is None else f" {quote(self.description, chr(34))}"
        return f"controller {self.name}{described}"

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        yield declared(Kind.CONTROLLER, self.name)


class UseNode(NamedTuple):
    """``use NAME from "FILE"[, "FILE"]``."""

    name: Word
    files: tuple[Word, ...]
    span: Span = NOWHERE

    @property
    def gap(self) -> str:
        """What parts the columns."""
        return " "

    @classmethod
    def read(cls, cursor: Cursor) -> UseNode:
        """Read it from the cursor."""
        cursor.take()
        name = cursor.name("a name for the rule base or table")
        cursor.expect("from", "before the file")
        files = [cls._file(cursor)]
        while cursor.accept(","):
            files.append(cls._file(cursor))
        return cls(name, tuple(files), cursor.whole)

    @staticmethod
    def _file(cursor: Cursor) -> Word:
        span = cursor.span
        text = cursor.string()
        if text is None:
            cursor.fail("the file in double quotes")
        return Word(text, span)

    def in_columns(self) -> list[str]:
        """Return the parts that stand below those of neighbours."""
        files = ", ".join(quote(word.text, '"') for word in self.files)
        return [f"use {self.name}", f"from {files}"]

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        yield declared(Kind.USE, self.name)


class TimeNode(NamedTuple):
    """A time with its unit."""

    figure: Figure
    unit: str

    @classmethod
    def read(cls, cursor: Cursor, what: str) -> TimeNode:
        """Read a number and a unit."""
        figure = cursor.figure(what)
        cursor.suggest("times")
        token = cursor.peek()
        if token is None or token.kind != "name" or token.text not in TIMES:
            units = ", ".join(TIMES)
            found = "nothing" if token is None else f"'{token.text}'"
            raise Fault(
                Diagnostic(
                    "missing-unit",
                    f"expected a unit of time behind {figure}, found {found}",
                    cursor.span,
                    hint=f"one of {units}",
                )
            )
        return cls(figure, cursor.take().text)

    @property
    def seconds(self) -> float:
        """The time, s."""
        number, of_a_second = TIMES[self.unit]
        return self.figure.value * number / of_a_second

    def __str__(self) -> str:
        return f"{self.figure} {self.unit}"


class PeriodNode(NamedTuple):
    """``period 0.6 ms``."""

    time: TimeNode
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> PeriodNode:
        """Read it from the cursor."""
        cursor.take()
        return cls(TimeNode.read(cursor, "how often the controller runs"), cursor.whole)

    def __str__(self) -> str:
        return f"period {self.time}"

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        return iter(())


class SetPointNode(NamedTuple):
    """``set-point every 5``."""

    every: Figure
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> SetPointNode:
        """Read it from the cursor."""
        cursor.take()
        cursor.expect("every", "behind set-point")
        return cls(cursor.figure("the periods from one set point to the next"), cursor.whole)

    def __str__(self) -> str:
        return f"set-point every {self.every}"

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        return iter(())


# --- Numbers by name ---


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
        return cls(tuple(factors), start)

    @staticmethod
    def _factor(cursor: Cursor) -> Figure | None:
        return None if cursor.accept("pi") else cursor.figure("a number or pi")

    def __str__(self) -> str:
        text = ""
        for figure, divides in self.factors:
            text += ("/" if divides else "*") if text else ""
            text += "pi" if figure is None else str(figure)
        return text


class GainNode(NamedTuple):
    """``gain NAME = VALUE "unit", tune LOW .. HIGH [log]``."""

    name: Word
    values: tuple[AmountNode, ...]
    unit: str | None
    low: Figure | None
    high: Figure | None
    log: bool
    span: Span = NOWHERE

    @property
    def gap(self) -> str:
        """What parts the columns."""
        return " "

    @classmethod
    def read(cls, cursor: Cursor) -> GainNode:
        """Read it from the cursor."""
        cursor.take()
        name = cursor.name("the name of the gain")
        cursor.expect("=", f"after '{name.text}'")
        values = [AmountNode.read(cursor)]
        while cursor.next_is(",") and not cursor.next_is("tune", 1):
            cursor.take()
            values.append(AmountNode.read(cursor))
        unit = cursor.string()
        low: Figure | None = None
        high: Figure | None = None
        log = False
        if cursor.accept(","):
            cursor.expect("tune", "behind the comma")
            low = cursor.figure("the lowest value")
            cursor.expect("..", "between the ends of the range")
            high = cursor.figure("the highest value")
            log = cursor.accept("log") is not None
        return cls(name, tuple(values), unit, low, high, log, cursor.whole)

    def in_columns(self) -> list[str]:
        """Return the parts that stand below those of neighbours."""
        value = "= " + ", ".join(map(str, self.values))
        unit = "" if self.unit is None else " " + quote(self.unit, '"')
        tune = ""
        if self.low is not None:
            tune = f", tune {self.low} .. {self.high}" + (" log" if self.log else "")
        return [f"gain {self.name}", f"{value}{unit}{tune}"]

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        yield declared(Kind.SIGNAL, self.name)


class PartnerNode(NamedTuple):
    """``partner NAME = LAW[, GAIN = NUMBER …]``."""

    name: Word
    law: Word
    gains: tuple[tuple[Word, Figure], ...]
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> PartnerNode:
        """Read it from the cursor."""
        cursor.take()
        name = cursor.name("the name of the partner")
        cursor.expect("=", f"after '{name.text}'")
        law = cursor.name("a law of the catalogue")
        gains = []
        while cursor.accept(","):
            gain = cursor.name("the name of a gain of the law")
            while cursor.accept("."):
                more = cursor.name("the rest of the name")
                gain = Word(f"{gain.text}.{more.text}", gain.span.to(more.span))
            cursor.expect("=", f"after '{gain.text}'")
            gains.append((gain, cursor.figure("a number")))
        return cls(name, law, tuple(gains), cursor.whole)

    def __str__(self) -> str:
        gains = "".join(f", {gain.text} = {value}" for gain, value in self.gains)
        return f"partner {self.name} = {self.law}{gains}"

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        yield declared(Kind.SIGNAL, self.name)


# --- The lines of an axis ---


class AxisNode(NamedTuple):
    """``axis A, B``."""

    names: tuple[Word, ...]
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> AxisNode:
        """Read it from the cursor."""
        cursor.take()
        names = [cursor.name("the name of an axis")]
        while cursor.accept(","):
            names.append(cursor.name("the name of an axis"))
        return cls(tuple(names), cursor.whole)

    def __str__(self) -> str:
        return f"axis {', '.join(map(str, self.names))}"

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        return (declared(Kind.AXIS, word) for word in self.names)


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


def _sum_text(products: tuple[ProductNode, ...]) -> str:
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
            return cls(word, TimeNode.read(cursor, f"the time of {word.text}"))
        if kind.takes == "range":
            low = cursor.figure("the lower end", finite=False)
            cursor.expect("..", "between the ends of the range")
            return cls(word, low, cursor.figure("the upper end", finite=False))
        if kind.takes == "windup":
            if cursor.accept("hold"):
                return cls(word, rest=("hold",))
            cursor.expect("back", f"or 'hold' behind {word.text}")
            return cls(word, TimeNode.read(cursor, "the time to go back in"), rest=("back",))
        return cls(word, read_amount(cursor, f"the {word.text}"))

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
        if of == "error":
            cursor.expect("of", f"behind {kind.text}")
            cursor.expect("error", f"behind {kind.text} of")
        if of != "port" or kind.text == "error":
            cursor.expect("of", f"behind {kind.text}")
        cursor.suggest("signals" if of == "signal" else "ports")
        return cls(kind, cursor.name("a signal" if of == "signal" else "a port of the plant"))

    def __str__(self) -> str:
        kind = self.kind.text
        of = SOURCES[kind].of
        if of == "call":
            return f"{kind} {self.name}{self.call}"
        if of == "error":
            return f"{kind} of error of {self.name}"
        between = " of" if of == "signal" or kind == "error" else ""
        return f"{kind}{between} {self.name}"

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


class SignalNode(NamedTuple):
    """``NAME[, NAME] = SOURCE [* FACTOR …] [, OPTION …]``, or a sum of products."""

    names: tuple[Word, ...]
    source: SourceNode | None
    products: tuple[ProductNode, ...]
    options: tuple[OptionNode, ...] = ()
    span: Span = NOWHERE

    @property
    def gap(self) -> str:
        """What parts the columns."""
        return " "

    @property
    def indent(self) -> str:
        """What stands in front of the line."""
        return "  "

    @classmethod
    def read(cls, cursor: Cursor) -> SignalNode:
        """Read it from the cursor."""
        names = [cursor.name("the name of a signal")]
        while cursor.accept(","):
            names.append(cursor.name("the name of a signal"))
        try:
            return cls._definition(cursor, tuple(names))
        except Fault as fault:
            cursor.forgive(fault)
            return cls(tuple(names), None, (), (), cursor.whole)

    @classmethod
    def _definition(cls, cursor: Cursor, names: tuple[Word, ...]) -> SignalNode:
        cursor.expect("=", "after the name of the signal")
        source = SourceNode.read(cursor)
        if source is None:
            products = ProductNode.read_all(cursor)
            cursor.finish()
            return cls(names, None, products, (), cursor.whole)
        factors = ProductNode.read_factors(cursor)
        options = []
        known = SOURCES[source.kind.text].options
        while cursor.accept(","):
            if not known:
                cursor.fail("the end of the line", (), "trailing-text")
            options.append(OptionNode.read(cursor, known, source.kind.text))
        cursor.finish()
        return cls(names, source, (ProductNode(factors),), tuple(options), cursor.whole)

    def in_columns(self) -> list[str]:
        """Return the parts that stand below those of neighbours."""
        if self.source is None:
            body = _sum_text(self.products)
        else:
            (product,) = self.products
            body = str(self.source) + "".join(
                f" {'/' if each.divides else '*'} {each}" for each in product.factors
            )
        options = "".join(f", {option}" for option in self.options)
        return [", ".join(map(str, self.names)), f"= {body}{options}"]

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        yield from (declared(Kind.SIGNAL, word) for word in self.names)
        if self.source is not None:
            yield from self.source.mentions()
        for product in self.products:
            for factor in product.factors:
                yield from factor.mentions()
        for option in self.options:
            yield from option.mentions()


class ZoomNode(NamedTuple):
    """``zoom e, ce by 2 inside 3 [, edge wait]``."""

    signals: tuple[Word, ...]
    by: Figure | Word
    inside: Figure | Word
    wait: bool
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> ZoomNode:
        """Read it from the cursor."""
        cursor.take()
        signals = read_signals(cursor)
        cursor.expect("by", "behind the signals")
        by = read_amount(cursor, "how much they are magnified")
        cursor.expect("inside", "behind that")
        inside = read_amount(cursor, "the window")
        wait = cursor.accept(",") is not None
        if wait:
            cursor.expect("edge", "behind the comma")
            cursor.expect("wait", "behind edge")
        return cls(signals, by, inside, wait, cursor.whole)

    def __str__(self) -> str:
        signals = ", ".join(map(str, self.signals))
        edge = ", edge wait" if self.wait else ""
        return f"  zoom {signals} by {self.by} inside {self.inside}{edge}"

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        yield from map(of_signal, self.signals)
        yield from (of_signal(each) for each in (self.by, self.inside) if isinstance(each, Word))


LEARN_OPTIONS = {
    "delay": OptionKind("number", "how many periods ago the responsible cell was in use"),
    "rate": OptionKind("number", "share of the performance value that corrects"),
    "bound": OptionKind("number", "largest magnitude of a cell"),
}
"""What stands behind the commas of ``learn``."""


class LearnNode(NamedTuple):
    """``learn F by P(e, ce), delay 1, rate 1, bound 6``."""

    table: Word
    judge: Word
    call: CallNode
    options: tuple[OptionNode, ...]
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> LearnNode:
        """Read it from the cursor."""
        cursor.take()
        table = read_sheet(cursor, "the table that learns")
        cursor.expect("by", "before the performance table")
        judge = read_sheet(cursor, "the performance table")
        call = CallNode.read(cursor)
        options = []
        while cursor.accept(","):
            options.append(OptionNode.read(cursor, LEARN_OPTIONS, "learn"))
        return cls(table, judge, call, tuple(options), cursor.whole)

    def __str__(self) -> str:
        options = "".join(f", {option}" for option in self.options)
        return f"  learn {self.table} by {self.judge}{self.call}{options}"

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        yield of_sheet(self.table)
        yield of_sheet(self.judge)
        yield from map(of_signal, self.call.inputs)
        for option in self.options:
            yield from option.mentions()


class DriveNode(NamedTuple):
    """``drive PORT = SUM [, within A .. B] [, slew N]``."""

    port: Word
    products: tuple[ProductNode, ...]
    low: Figure | None
    high: Figure | None
    slew: Figure | None
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> DriveNode:
        """Read it from the cursor."""
        cursor.take()
        cursor.suggest("ports")
        port = cursor.name("a port of the plant")
        cursor.expect("=", f"after '{port.text}'")
        products = ProductNode.read_all(cursor)
        low: Figure | None = None
        high: Figure | None = None
        slew: Figure | None = None
        while cursor.accept(","):
            if cursor.accept("within"):
                low = cursor.figure("the lower limit")
                cursor.expect("..", "between the limits")
                high = cursor.figure("the upper limit")
            else:
                cursor.expect("slew", "or 'within' behind the comma")
                slew = cursor.figure("the largest change per second")
        return cls(port, products, low, high, slew, cursor.whole)

    def __str__(self) -> str:
        within = f", within {self.low} .. {self.high}" if self.low is not None else ""
        slew = f", slew {self.slew}" if self.slew is not None else ""
        return f"  drive {self.port} = {_sum_text(self.products)}{within}{slew}"

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        yield Occurrence(Kind.PORT, self.port.text, self.port.span)
        for product in self.products:
            for factor in product.factors:
                yield from factor.mentions()


# --- The records ---

SIGNAL = "signal"
"""What stands for the word of a line that begins with a name: ``NAME = …``."""

_OPTIONS = {
    word: kind.doc for source in SOURCES.values() for word, kind in source.options.items()
} | {word: kind.doc for word, kind in LEARN_OPTIONS.items()}

CONTROLLER_STATEMENTS: dict[str, StatementKind] = {
    record.word: record
    for record in (
        StatementKind(
            "controller",
            ControllerHeading,
            'NAME "description"',
            "the name of the controller and what it is for",
            outline="controller",
        ),
        StatementKind(
            "use",
            UseNode,
            'NAME from "FILE"[, "FILE"]',
            "a rule base or a table, for all axes or one for each",
            {"from": ""},
            outline="use",
        ),
        StatementKind(
            "period",
            PeriodNode,
            "TIME UNIT",
            "how often the controller runs",
            dict.fromkeys(TIMES, ""),
        ),
        StatementKind(
            "set-point",
            SetPointNode,
            "every N",
            "how many periods a set point lasts",
            {"every": ""},
        ),
        StatementKind(
            "gain",
            GainNode,
            'NAME = VALUE "UNIT"[, tune LOW .. HIGH [log]]',
            "a number by name, one for all axes or one for each",
            {"tune": "between what it may move when it is tuned", "log": "", "pi": "π"},
            outline="gain",
        ),
        StatementKind(
            "partner",
            PartnerNode,
            "NAME = LAW[, GAIN = NUMBER]",
            "a law of the catalogue, its torque an addend",
            outline="partner",
        ),
        StatementKind(
            "axis", AxisNode, "NAME, NAME", "what follows is done for each axis", outline="axis"
        ),
        StatementKind(
            SIGNAL,
            SignalNode,
            "NAME = SOURCE * FACTOR, OPTION",
            "one signal, from a source or as a sum of products",
            {word: kind.doc for word, kind in SOURCES.items()} | _OPTIONS | {"of": ""},
        ),
        StatementKind(
            "zoom",
            ZoomNode,
            "SIGNAL, SIGNAL by FACTOR inside WINDOW[, edge wait]",
            "signals magnified while all of them are small",
            {"by": "", "inside": "", "edge": "", "wait": "stay at the edge of the window"},
        ),
        StatementKind(
            "learn",
            LearnNode,
            "TABLE by TABLE(SIGNAL, SIGNAL), delay N, rate N, bound N",
            "a table that a performance table corrects",
            {"by": ""},
        ),
        StatementKind(
            "drive",
            DriveNode,
            "PORT = SUM[, within LOW .. HIGH][, slew N]",
            "what goes to the plant; drives of one port add up",
            {"within": "limits", "slew": "the largest change per second"},
        ),
    )
}
"""Every statement of a controller by the word that starts it."""

STARTERS.add("controller")

CONTROLLER_WORDS: dict[str, str] = {
    word: doc for record in CONTROLLER_STATEMENTS.values() for word, doc in record.words.items()
}
"""The other words of a controller, with one line of help where it is needed."""
