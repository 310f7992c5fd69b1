"""The statement ``prove`` of a controller: a claim about its loop."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from fuzzyarm.base.diagnostic import NOWHERE, Diagnostic, Figure, Span, Word
from fuzzyarm.base.numbers import number_text
from fuzzyarm.language.model.claims import FollowedReference, LoopClaim
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
from fuzzyarm.language.tokens import Cursor, Fault, name_text


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


def stretch_text(stretch: tuple[str, float, float]) -> str:
    """Return a name and an interval as in a claim."""
    name, low, high = stretch
    return f"{name_text(name)} in {number_text(low)} .. {number_text(high)}"


class FollowedNode(NamedTuple):
    """``PORT follows KIND …``: its numbers, in the order of :class:`FollowedReference`."""

    port: Word
    kind: str
    numbers: tuple[Figure | Time, ...]


class LoopClaimNode(NamedTuple):
    """``prove [stable] on PLANT [at …] [with …] [from …] [while …][: [error of] PORT in …]``."""

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
    follows: tuple[FollowedNode, ...] = ()
    error: bool = False

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
            tuple(
                FollowedReference(str(port), kind, tuple(map(float, numbers)))
                for port, kind, numbers in self.follows
            ),
            self.error,
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


# --- references that move ---


def _read_ends(cursor: Cursor) -> tuple[Figure, Figure]:
    start = cursor.figure("the value before")
    cursor.expect("..", "between both values")
    return start, cursor.figure("the value after")


def _read_step(cursor: Cursor) -> tuple[Figure | Time, ...]:
    start, to = _read_ends(cursor)
    return to, _read_moment(cursor, "step", "when it steps"), start


def _read_ramp(cursor: Cursor) -> tuple[Figure | Time, ...]:
    start = cursor.figure("the value before")
    cursor.expect("by", "before the rate of the ramp")
    rate = cursor.figure("the rate, in the unit of the port per second")
    return rate, _read_moment(cursor, "ramp", "when it begins"), start


def _read_moment(cursor: Cursor, kind: str, what: str) -> Time:
    cursor.expect("at", f"before the time of the {kind}")
    return read_time(cursor, what, 1.0)


def _read_sine(cursor: Cursor) -> tuple[Figure | Time, ...]:
    amplitude = cursor.figure("the amplitude")
    cursor.expect("at", "before the frequency")
    hertz = cursor.figure("the frequency")
    cursor.expect("Hz", f"after {number_text(hertz)}")
    middle = (cursor.figure("the middle"),) if cursor.accept("around") else ()
    return amplitude, hertz, *middle


def _read_quintic(cursor: Cursor) -> tuple[Figure | Time, ...]:
    """Read moves from rest to rest, each from where the one before it has ended."""
    start, to = _read_ends(cursor)
    cursor.expect("in", "before the time of the move")
    numbers: list[Figure | Time] = [to, _read_duration(cursor), start]
    while _is_move(cursor):
        cursor.take()
        begin, end = _read_ends(cursor)
        if begin != to:
            message = f"a move goes on from {number_text(to)}, where the one before it ends"
            raise Fault(Diagnostic("bad-range", message, begin.span, replacement=number_text(to)))
        cursor.expect("in", "before the time of the move")
        numbers += [end, _read_duration(cursor)]
        to = end
    return tuple(numbers)


def _read_duration(cursor: Cursor) -> Time:
    duration = read_time(cursor, "how long the move takes", 1.0)
    if not duration.figure > 0.0:
        raise Fault(Diagnostic("bad-range", "a move takes some time", duration.figure.span))
    return duration


def _is_move(cursor: Cursor) -> bool:
    """Return whether another move follows, rather than another port."""
    token = cursor.peek(1)
    return cursor.next_is(",") and token is not None and (
        token.kind == "number" or token.text in ("-", "+")
    )  # fmt: skip


FOLLOWED = {
    "step": _read_step, "ramp": _read_ramp, "sine": _read_sine, "quintic": _read_quintic,
}  # fmt: skip
"""Kinds of reference, and how the words after each are read."""


def _read_follows(cursor: Cursor) -> tuple[FollowedNode, ...]:
    follows: list[FollowedNode] = []
    while not follows or cursor.accept(","):
        cursor.suggest("ports")
        port = cursor.name("an output of the plant")
        cursor.expect("follows", f"after '{port}'")
        kind = cursor.word(f"one of {', '.join(FOLLOWED)}", FOLLOWED, "unexpected-token")
        follows.append(FollowedNode(port, str(kind), FOLLOWED[kind](cursor)))
    return tuple(follows)


def _follows_text(follows: Iterable[FollowedNode]) -> str:
    return ", ".join(
        f"{name_text(each.port)} follows {each.kind} {_reference_text(each)}" for each in follows
    )


def _reference_text(node: FollowedNode) -> str:
    first, second, *rest = (
        time_text(x) if isinstance(x, Time) else number_text(x) for x in node.numbers
    )
    if node.kind == "sine":
        return f"{first} at {second} Hz{''.join(f' around {x}' for x in rest)}"
    if node.kind != "quintic":
        return f"{rest[0]} {'..' if node.kind == 'step' else 'by'} {first} at {second}"
    ends, times = [rest[0], first, *rest[1::2]], [second, *rest[2::2]]
    return ", ".join(f"{a} .. {b} in {t}" for a, b, t in zip(ends, ends[1:], times, strict=False))


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
        return ", ".join(map(stretch_text, stretches))

    return Phrase(field, read, label, show, mentions, empty=())


def _occurrence(kind: NameKind, word: Word) -> Occurrence:
    return Occurrence(kind, word, word.span)


class _Claim(Part):
    """``: [error of] OUTPUT in LOW .. HIGH [WHEN]``; a claim of stability may be without it."""

    def read(self, cursor: Cursor, values: Values) -> None:
        if not values["stable"]:
            cursor.expect(":", "before the claim")
        # A claim of stability needs no output.
        elif not cursor.accept(":"):
            return
        if cursor.next_is("of", 1) and cursor.accept("error"):
            cursor.take()
            values["error"] = True
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
        line.add("error of " * node.error + stretch_text(node.output))
        begin, end = node.begin, node.end
        if begin is not None and end is not None:
            line.add(f"during {number_text(begin)} .. {time_text(end)}")
        elif isinstance(begin, Time):
            line.add(f"after {time_text(begin)}")

    def sketch(self, line: Printed) -> None:
        line.add("[: [error of] PORT in A .. B [during A .. B s | after TIME | always]]", "before")

    def mentions(self, node: LoopClaimNode) -> Iterator[Occurrence]:
        if node.output is not None:
            yield _occurrence(NameKind.PORT, node.output.name)

    def words(self) -> Iterator[tuple[str, str]]:
        yield "error", "reference less output"
        yield "of", ""
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
    Maybe(
        FixedText("while", "", "references that move"),
        Phrase(
            "follows",
            _read_follows,
            "PORT follows step A .. B at TIME | ramp A by RATE at TIME | sine A at N Hz [around B]"
            " | quintic A .. B in TIME, ...",
            _follows_text,
            lambda follows: (_occurrence(NameKind.PORT, each.port) for each in follows),
            empty=(),
            words={
                "follows": "a reference that moves",
                "step": "from one value to another",
                "ramp": "at a rate",
                "sine": "with a frequency",
                "quintic": "moves from rest to rest, the smoothest of their times",
                "Hz": "",
                "around": "the middle of a sine",
            },
        ),
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
        tuple(
            FollowedNode(
                Word(port),
                kind,
                tuple(
                    seconds(x) if _is_time(kind, k) else figure(x) for k, x in enumerate(numbers)
                ),
            )
            for port, kind, numbers in claim.follows
        ),
        claim.error,
    )


def _is_time(kind: str, index: int) -> bool:
    """Return whether a number of a reference is a time: the second one, and later ones of moves."""
    return kind != "sine" and (index == 1 or (index > 3 and not index % 2))
