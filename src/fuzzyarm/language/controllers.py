"""The statements of a controller: a row of parts each.

They follow a line ``controller NAME``, and are words of the language only there. Rows are as in
:mod:`fuzzyarm.language.rows`; their nodes are the records of
:mod:`fuzzyarm.language.model.controller`, and the sources of signals are its table ``SOURCES``.

To add a statement of a controller: its record in the model, which is its own node; its row here,
from which its names are judged (:mod:`fuzzyarm.language.controller_names`); what else it means in
:mod:`fuzzyarm.language.controller_meaning`; its line in
``docs/reference/controllers.md``. A source of signals needs its record alone
(:mod:`fuzzyarm.symbolic.sources`).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from fuzzyarm.base.diagnostic import NOWHERE, Figure, Span, Word
from fuzzyarm.base.names import quote
from fuzzyarm.base.numbers import TIMES, number_text
from fuzzyarm.language.loop_claims import LOOP_CLAIM_ROW
from fuzzyarm.language.model.controller import (
    EVENTS,
    HOLD,
    Axes,
    Drive,
    GainModel,
    Learn,
    Partner,
    SignalLine,
    Time,
    Tune,
    Use,
    Zoom,
)
from fuzzyarm.language.parts import (
    Column,
    FixedText,
    Flag,
    Forgiving,
    IntervalPart,
    Keyword,
    Maybe,
    Name,
    Number,
    OptionParts,
    Part,
    Phrase,
    Several,
    Text,
    Values,
    declares,
    refers,
)
from fuzzyarm.language.phrases import NameKind, Occurrence
from fuzzyarm.language.rows import Inside, StatementKind, StatementRow
from fuzzyarm.language.signals import (
    amount_text,
    inputs_text,
    names_in_options,
    names_in_source,
    names_in_sum,
    number_or_name,
    of_gain,
    of_signals,
    options_text,
    read_amount,
    read_body,
    read_inputs,
    read_number,
    read_options,
    read_signals,
    read_sum,
    read_time,
    source_text,
    sum_text,
    time_text,
)
from fuzzyarm.language.statements import CONTROLLER
from fuzzyarm.language.tokens import Cursor, name_text
from fuzzyarm.symbolic.sources import CHOICE, SOURCES, OptionKind

# --- Lines that become fields of the model, not records ---


class PeriodNode(NamedTuple):
    """``period 0.6 ms``."""

    time: Time
    span: Span = NOWHERE


class SetPointNode(NamedTuple):
    """``set-point every 5``."""

    every: Figure
    span: Span = NOWHERE


# --- Special parts ---


class _Body(Part):
    """The definition of a signal: a source with factors and options, or a sum of products."""

    def read(self, cursor: Cursor, values: Values) -> None:
        values["source"], values["products"] = read_body(cursor)

    def show(self, node: SignalLine, line: Any) -> None:
        line.add(source_text((node.source, node.products)))

    def sketch(self, line: Any) -> None:
        line.add("SOURCE * FACTOR, OPTION")

    def mentions(self, node: SignalLine) -> Iterator[Occurrence]:
        return names_in_source((node.source, node.products))

    def fields(self) -> Iterator[tuple[str, Any]]:
        yield from {"source": None, "products": ()}.items()

    def words(self) -> Iterator[tuple[str, str]]:
        yield from ((word, kind.doc) for word, kind in SOURCES.items())
        for source in SOURCES.values():
            yield from ((word, option.doc) for word, option in source.options.items())
        yield from ((word, option.doc) for word, option in LEARN_OPTIONS.items())
        yield from {"of": "", "where": CHOICE.doc, "else": ""}.items()


def _amount(field: str, what: str, label: str) -> Phrase:
    """Return a number or the name of a gain."""
    return Phrase(
        field,
        lambda cursor: read_number(cursor, what),
        label,
        number_or_name,
        lambda value: iter([of_gain(value)] if isinstance(value, str) else ()),
    )


def _read_gain_of_law(cursor: Cursor) -> tuple[Word, Figure]:
    """Read ``GAIN = NUMBER``, the name maybe in parts between dots."""
    gain = cursor.name("the name of a gain of the law")
    while cursor.accept("."):
        more = cursor.name("the rest of the name")
        gain = Word(f"{gain}.{more}", gain.span.to(more.span))
    cursor.expect("=", f"after '{gain}'")
    return gain, cursor.figure("a number")


def _gains_of_law(gains: tuple[tuple[str, float], ...]) -> str:
    return "".join(f", {_dotted(name)} = {number_text(value)}" for name, value in gains)


def _dotted(name: str) -> str:
    """Return a name of parts between dots as a file has it."""
    parts = [name_text(part) for part in name.split(".")]
    return name if ".".join(parts) == name else quote(name, "'")


def _read_gains_of_law(cursor: Cursor) -> tuple[tuple[Word, Figure], ...]:
    gains = []
    while cursor.accept(","):
        gains.append(_read_gain_of_law(cursor))
    return tuple(gains)


def _read_every(cursor: Cursor) -> float:
    """Read ``every N``, or 1."""
    return cursor.figure("a number of control periods") if cursor.accept("every") else 1


def _read_unit(cursor: Cursor) -> Word:
    """Read a string in double quotes; without one, an empty word without position."""
    return cursor.string() or Word("")


def _unit_text(unit: str) -> str:
    # An explicit empty unit is printed again; an absent one is not.
    has_unit = unit or (isinstance(unit, Word) and unit.span is not NOWHERE)
    return quote(unit, '"') if has_unit else ""


LEARN_OPTIONS = {
    "delay": OptionKind("number", "how many periods ago the responsible cell was in use"),
    "rate": OptionKind("number", "share of the performance value that corrects"),
    "bound": OptionKind("number", "largest magnitude of a cell"),
}
"""Options of ``learn``."""

# --- The statements ---

SIGNAL = "signal"
"""Key of lines that begin with a name: ``NAME = …``."""

_TUNE = StatementRow(
    Tune,
    FixedText("tune", "after the comma", "its range in tuning"),
    Number("low", "the lowest value", "LOW"),
    FixedText("..", "between the ends of the range"),
    Number("high", "the highest value", "HIGH"),
    Flag("log", "log"),
)

CONTROLLER_STATEMENTS: dict[str, StatementKind] = {
    record.word: record
    for record in (
        CONTROLLER,
        StatementKind(
            "use",
            "a rule base or a table, for all axes or one for each",
            StatementRow(
                Use,
                Keyword("use"),
                Name("name", "a name for the rule base or table", declares(NameKind.USE)),
                Forgiving(
                    Column(),
                    FixedText("from", "before the file"),
                    Several(
                        Text("files", "the file in double quotes", '"FILE"'),
                        label='"FILE"[, "FILE"]',
                    ),
                    finish=True,
                ),
                gap=" ",
            ),
            outline="use",
        ),
        StatementKind(
            "period",
            "how often the controller runs",
            StatementRow(
                PeriodNode,
                Keyword("period"),
                Phrase(
                    "time",
                    lambda cursor: read_time(cursor, "how often the controller runs", 1.0),
                    "TIME UNIT",
                    time_text,
                    words=dict.fromkeys(TIMES, ""),
                ),
            ),
        ),
        StatementKind(
            "set-point",
            "how many periods a set point lasts",
            StatementRow(
                SetPointNode,
                Keyword("set-point"),
                FixedText("every", "after set-point"),
                Number("every", "the periods from one set point to the next"),
            ),
        ),
        StatementKind(
            "gain",
            "a number by name, one for all axes or one for each",
            StatementRow(
                GainModel,
                Keyword("gain"),
                Name("name", "the name of the gain", declares(NameKind.SIGNAL)),
                Forgiving(
                    Column(),
                    FixedText("=", "after '{name}'"),
                    Several(
                        Phrase("values", read_amount, "VALUE", amount_text, words={"pi": "π"}),
                        # The comma before `tune` does not announce another value.
                        stop="tune",
                    ),
                    Phrase("unit", _read_unit, '"UNIT"', _unit_text, empty=""),
                    # A mistake in the range of tuning leaves the gain intact.
                    Forgiving(Maybe(FixedText(","), Inside("tune", _TUNE)), finish=True),
                ),
                gap=" ",
            ),
            outline="gain",
        ),
        StatementKind(
            "partner",
            "a law of the catalogue, its torque an addend",
            StatementRow(
                Partner,
                Keyword("partner"),
                Name("name", "the name of the partner", declares(NameKind.SIGNAL)),
                Forgiving(
                    FixedText("=", "after '{name}'"),
                    Name("law", "a law of the catalogue", label="LAW", empty=Word("")),
                    Phrase(
                        "gains",
                        _read_gains_of_law,
                        "[, GAIN = NUMBER]",
                        _gains_of_law,
                        empty=(),
                        no_space="before",
                    ),
                    finish=True,
                ),
            ),
            outline="partner",
        ),
        StatementKind(
            "axis",
            "the following lines apply to each axis",
            StatementRow(
                Axes,
                Keyword("axis"),
                Several(
                    Name("names", "the name of an axis", declares(NameKind.AXIS)),
                    label="NAME, NAME",
                ),
                Phrase(
                    "every",
                    _read_every,
                    "[every N]",
                    lambda every: f"every {number_text(every)}" if every != 1 else "",
                    empty=1,
                    words={"every": "the control periods from one run of an axis to the next"},
                ),
            ),
            outline="axis",
        ),
        StatementKind(
            SIGNAL,
            "one signal, from a source or as a sum of products",
            StatementRow(
                SignalLine,
                Several(Name("names", "the name of a signal", declares(NameKind.SIGNAL))),
                Forgiving(
                    Column(),
                    FixedText("=", "after the name of the signal"),
                    _Body(),
                    finish=True,
                ),
                indent="  ",
                gap=" ",
            ),
        ),
        StatementKind(
            "zoom",
            "signals magnified while all of them are small",
            StatementRow(
                Zoom,
                Keyword("zoom"),
                Phrase(
                    "signals",
                    read_signals,
                    "SIGNAL, SIGNAL",
                    lambda signals: ", ".join(map(name_text, signals)),
                    of_signals,
                ),
                FixedText("by", "after the signals"),
                _amount("by", "how much they are magnified", "FACTOR"),
                FixedText("inside", "after that"),
                _amount("inside", "the window", "WINDOW"),
                Maybe(
                    FixedText(","),
                    FixedText("edge", "after the comma"),
                    FixedText("wait", "after edge", "stay at the edge of the window"),
                    flag="wait",
                ),
                indent="  ",
            ),
        ),
        StatementKind(
            "learn",
            "a table that a performance table corrects",
            StatementRow(
                Learn,
                Keyword("learn"),
                Name("table", "the table that learns", refers(NameKind.USE), "TABLE", "sheets"),
                FixedText("by", "before the performance table"),
                Name("judge", "the performance table", refers(NameKind.USE), "TABLE", "sheets"),
                Phrase(
                    "inputs",
                    read_inputs,
                    "(SIGNAL, SIGNAL)",
                    inputs_text,
                    of_signals,
                    no_space="before",
                ),
                Phrase(
                    "options",
                    lambda cursor: read_options(cursor, LEARN_OPTIONS),
                    ", delay N, rate N, bound N",
                    lambda options: options_text(options, LEARN_OPTIONS),
                    lambda options: names_in_options(options, LEARN_OPTIONS),
                    empty=(),
                    no_space="before",
                ),
                indent="  ",
            ),
        ),
        StatementKind(
            "drive",
            "output to the plant; drives of one port add up",
            StatementRow(
                Drive,
                Keyword("drive"),
                Name("port", "a port of the plant", refers(NameKind.PORT), "PORT", "ports"),
                FixedText("=", "after '{port}'"),
                Phrase("products", read_sum, "SUM", sum_text, names_in_sum),
                OptionParts(
                    Maybe(
                        FixedText("within", "", "limits"),
                        IntervalPart(
                            "within", "the lower limit", "the upper limit", "between the limits"
                        ),
                    ),
                    Maybe(
                        FixedText(
                            "slew",
                            "",
                            "the largest change per second",
                        ),
                        Number("slew", "the largest change per second"),
                    ),
                    *(
                        Maybe(
                            FixedText("on", "", "value of the drive in an event"),
                            FixedText(event, "after 'on'", doc),
                            Number(f"on_{event}", f"the value sent on {event}", or_word=HOLD),
                        )
                        for event, doc in EVENTS.items()
                    ),
                ),
                indent="  ",
            ),
        ),
        StatementKind(
            "prove", "claim about the closed loop, proved by `fuzzyarm prove`", LOOP_CLAIM_ROW
        ),
    )
}
"""Every statement of a controller by the word that starts it."""

CONTROLLER_WORDS: dict[str, str] = {
    word: doc for record in CONTROLLER_STATEMENTS.values() for word, doc in record.words.items()
}
"""The other words of a controller, with one line of help if needed."""
