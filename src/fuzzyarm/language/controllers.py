"""The statements of a controller: a record each, and a node that reads and writes itself.

They stand below a line ``controller NAME``, and are words of the language there only. Records and
nodes are as :mod:`fuzzyarm.language.statements` says; what a signal may come from is the table
:data:`fuzzyarm.model.controller.SOURCES`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from fuzzyarm.language.loop_claims import LOOP_CLAIM_WORDS, LoopClaimNode
from fuzzyarm.language.phrases import Kind, Occurrence, declared
from fuzzyarm.language.signals import (
    AmountNode,
    CallNode,
    OptionNode,
    ProductNode,
    SourceNode,
    TimeNode,
    of_sheet,
    of_signal,
    read_amount,
    read_sheet,
    read_signals,
    sum_text,
)
from fuzzyarm.language.statements import StatementKind
from fuzzyarm.language.tokens import STARTERS, Cursor, Fault, Figure, Word, name_text
from fuzzyarm.model.controller import SOURCES, TIMES, OptionKind
from fuzzyarm.text.diagnostic import NOWHERE, Span
from fuzzyarm.text.names import quote

__all__ = [
    "AxisNode",
    "ControllerHeading",
    "DriveNode",
    "GainNode",
    "LearnNode",
    "PartnerNode",
    "PeriodNode",
    "SetPointNode",
    "SignalNode",
    "UseNode",
    "ZoomNode",
]


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
        files = []
        try:
            cursor.expect("from", "before the file")
            files.append(cls._file(cursor))
            while cursor.accept(","):
                files.append(cls._file(cursor))
            cursor.finish()
        except Fault as fault:
            cursor.forgive(fault)
            files = []
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


class PeriodNode(NamedTuple):
    """``period 0.6 ms``."""

    time: TimeNode
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> PeriodNode:
        """Read it from the cursor."""
        cursor.take()
        return cls(TimeNode.read(cursor, "how often the controller runs", 1.0), cursor.whole)

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
        try:
            return cls._definition(cursor, name)
        except Fault as fault:
            cursor.forgive(fault)
            return cls(name, (), None, None, None, False, cursor.whole)

    @classmethod
    def _definition(cls, cursor: Cursor, name: Word) -> GainNode:
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
        cursor.finish()
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
        try:
            return cls._definition(cursor, name)
        except Fault as fault:
            cursor.forgive(fault)
            return cls(name, Word(""), (), cursor.whole)

    @classmethod
    def _definition(cls, cursor: Cursor, name: Word) -> PartnerNode:
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
        cursor.finish()
        return cls(name, law, tuple(gains), cursor.whole)

    def __str__(self) -> str:
        gains = "".join(f", {_dotted(gain.text)} = {value}" for gain, value in self.gains)
        return f"partner {self.name} = {self.law}{gains}"

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        yield declared(Kind.SIGNAL, self.name)


def _dotted(name: str) -> str:
    """Return a name of parts between dots as a file has it."""
    parts = [name_text(part) for part in name.split(".")]
    return name if ".".join(parts) == name else quote(name, "'")


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
            body = sum_text(self.products)
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
        return f"  drive {self.port} = {sum_text(self.products)}{within}{slew}"

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
        StatementKind(
            "prove",
            LoopClaimNode,
            "[stable] on PLANT [at PORT = X] [with PARAMETER in A .. B] [from STATE in A .. B]"
            "[: PORT in A .. B [during A .. B s | after TIME | always]]",
            "what is to be proved of the closed loop",
            LOOP_CLAIM_WORDS,
        ),
    )
}
"""Every statement of a controller by the word that starts it."""

STARTERS.add("controller")

CONTROLLER_WORDS: dict[str, str] = {
    word: doc for record in CONTROLLER_STATEMENTS.values() for word, doc in record.words.items()
}
"""The other words of a controller, with one line of help where it is needed."""
