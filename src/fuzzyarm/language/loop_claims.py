"""The statement ``prove`` of a controller: a claim about its loop."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from fuzzyarm.base.diagnostic import NOWHERE, Figure, Span, Word
from fuzzyarm.base.numbers import number_text
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.language.model.controller import Time
from fuzzyarm.language.parts import (
    FixedText,
    Flag,
    Keyword,
    Maybe,
    Name,
    Part,
    Phrase,
    Printed,
    Values,
    refers,
)
from fuzzyarm.language.phrases import NameKind, Occurrence
from fuzzyarm.language.rows import StatementRow
from fuzzyarm.language.signals import read_time, time_text
from fuzzyarm.language.tokens import Cursor, name_text


class StateStretch(NamedTuple):
    """``NAME in LOW .. HIGH``: a state, a parameter or an output of a plant."""

    name: Word
    low: Figure
    high: Figure


def _read_stretch(cursor: Cursor, what: str, offered: str) -> StateStretch:
    cursor.suggest(offered)
    name = cursor.name(what)
    cursor.expect("in", f"after '{name}' ({name_text(name)} in 1 .. 2)")
    low = cursor.figure("the lowest value")
    cursor.expect("..", "between the ends of the interval")
    return StateStretch(name, low, cursor.figure("the highest value"))


def _stretch_text(stretch: StateStretch) -> str:
    low, high = number_text(stretch.low), number_text(stretch.high)
    return f"{name_text(stretch.name)} in {low} .. {high}"


class LoopClaimNode(NamedTuple):
    """``prove [stable] on PLANT [at …] [with …] [from …][: OUTPUT in LOW .. HIGH [WHEN]]``."""

    stable: bool
    plant: Word
    at: tuple[tuple[Word, Figure], ...] = ()
    parameters: tuple[StateStretch, ...] = ()
    start: tuple[StateStretch, ...] = ()
    output: StateStretch | None = None
    when: str = "always"
    begin: Time | Figure | None = None
    end: Time | None = None
    span: Span = NOWHERE

    @property
    def stretches(self) -> tuple[StateStretch, ...]:
        """All of its intervals."""
        claimed = () if self.output is None else (self.output,)
        return (*self.parameters, *self.start, *claimed)

    @property
    def claim(self) -> LoopClaim:
        """The claim as a model."""

        def stretches(nodes: tuple[StateStretch, ...]) -> tuple[tuple[str, float, float], ...]:
            return tuple((str(n.name), float(n.low), float(n.high)) for n in nodes)

        begin, end = 0.0, math.inf
        if self.when == "during":
            assert self.end is not None
            assert isinstance(self.begin, Figure)
            end = float(self.end)
            # In the unit of the end: 0.5 .. 1 s.
            begin = float(Time(self.begin, self.end.unit))
        elif isinstance(self.begin, Time):
            begin = float(self.begin)
        output = self.output
        return LoopClaim(
            str(self.plant),
            self.stable,
            tuple((str(port), float(value)) for port, value in self.at),
            stretches(self.parameters),
            stretches(self.start),
            "" if output is None else str(output.name),
            0.0 if output is None else float(output.low),
            0.0 if output is None else float(output.high),
            # Spelt out for mypy: the model needs a literal, the node has any text.
            "after" if self.when == "after" else "during" if self.when == "during" else "always",
            begin,
            end,
            self.span,
        )


def _read_set_points(cursor: Cursor) -> tuple[tuple[Word, Figure], ...]:
    set_points: list[tuple[Word, Figure]] = []
    while not set_points or cursor.accept(","):
        cursor.suggest("ports")
        port = cursor.name("an output of the plant")
        cursor.expect("=", f"after '{port}'")
        set_points.append((port, cursor.figure("its set point")))
    return tuple(set_points)


def _set_points_text(set_points: Iterable[tuple[str, float]]) -> str:
    return ", ".join(f"{name_text(port)} = {number_text(value)}" for port, value in set_points)


def _stretches(field: str, kind: NameKind, what: str, label: str) -> Phrase:
    """Return intervals with commas between them; their names are the plant's."""
    offered = f"{kind}s"

    def read(cursor: Cursor) -> tuple[StateStretch, ...]:
        stretches = [_read_stretch(cursor, what, offered)]
        while cursor.accept(","):
            stretches.append(_read_stretch(cursor, what, offered))
        return tuple(stretches)

    def mentions(stretches: Iterable[StateStretch]) -> Iterator[Occurrence]:
        return (_occurrence(kind, stretch.name) for stretch in stretches)

    def show(stretches: Iterable[StateStretch]) -> str:
        return ", ".join(map(_stretch_text, stretches))

    return Phrase(field, read, label, show, mentions, empty=())


def _occurrence(kind: NameKind, word: Word) -> Occurrence:
    return Occurrence(kind, word, word.span)


class _Claim(Part):
    """``: OUTPUT in LOW .. HIGH [WHEN]``, which may be left out where the claim is ``stable``."""

    def read(self, cursor: Cursor, values: Values) -> None:
        if not values["stable"]:
            cursor.expect(":", "before the claim")
        # A claim of stability needs no output.
        elif not cursor.accept(":"):
            return
        values["output"] = _read_stretch(cursor, "an output of the plant", "ports")
        if cursor.accept("during"):
            values["when"], values["begin"] = "during", cursor.figure("when it begins")
            cursor.expect("..", "between the times")
            values["end"] = read_time(cursor, "when it ends", 1.0)
        elif cursor.accept("after"):
            values["when"], values["begin"] = "after", read_time(cursor, "from when on", 1.0)
        else:
            cursor.accept("always")

    def show(self, node: LoopClaimNode, line: Printed) -> None:
        if node.output is None:
            return
        line.add(":", "before")
        line.add(_stretch_text(node.output))
        begin, end = node.begin, node.end
        if begin is not None and end is not None:
            line.add(f"during {number_text(begin)} .. {time_text(end)}")
        elif isinstance(begin, Time):
            line.add(f"after {time_text(begin)}")

    def sketch(self, line: Printed) -> None:
        line.add("[: PORT in A .. B [during A .. B s | after TIME | always]]", "before")

    def mentions(self, node: LoopClaimNode) -> Iterator[Occurrence]:
        if node.output is not None:
            yield _occurrence(NameKind.PORT, node.output.name)

    def words(self) -> Iterator[tuple[str, str]]:
        yield "in", ""
        yield "during", "while a time lasts"
        yield "after", "from a time on"
        yield "always", "from the start on"


LOOP_CLAIM_ROW = StatementRow(
    LoopClaimNode,
    Keyword("prove"),
    Flag(
        "stable",
        "stable",
        "the loop comes to rest from every start in the region of the proof",
    ),
    FixedText("on", "before the plant"),
    Name("plant", "a plant", refers(NameKind.PLANT), "PLANT", "plants"),
    Maybe(
        FixedText("at", "", "constant set points; 0 for other ports"),
        Phrase(
            "at",
            _read_set_points,
            "PORT = X",
            _set_points_text,
            lambda conditions: (_occurrence(NameKind.PORT, port) for port, _ in conditions),
            empty=(),
        ),
    ),
    Maybe(
        FixedText("with", "", "parameters of the plant that may be anywhere in an interval"),
        _stretches(
            "parameters", NameKind.PARAMETER, "a parameter of the plant", "PARAMETER in A .. B"
        ),
    ),
    Maybe(
        FixedText("from"),
        _stretches("start", NameKind.STATE, "a state of the plant", "STATE in A .. B"),
    ),
    _Claim(),
)


def claim_node(claim: LoopClaim) -> LoopClaimNode:
    """Return a claim as it would be written."""

    def figure(value: float) -> Figure:
        return Figure(value)

    def stretch(name: str, low: float, high: float) -> StateStretch:
        return StateStretch(Word(name), figure(low), figure(high))

    def seconds(value: float) -> Time:
        return Time(figure(value), "s")

    begin: Time | Figure | None = None
    if claim.when == "during":
        begin = figure(claim.begin)
    elif claim.when == "after":
        begin = seconds(claim.begin)
    return LoopClaimNode(
        claim.stable,
        Word(claim.plant),
        tuple((Word(name), figure(value)) for name, value in claim.at),
        tuple(stretch(*parameter) for parameter in claim.parameters),
        tuple(stretch(*start) for start in claim.start),
        stretch(claim.output, claim.low, claim.high) if claim.output else None,
        claim.when,
        begin,
        seconds(claim.end) if claim.when == "during" else None,
        claim.span,
    )
