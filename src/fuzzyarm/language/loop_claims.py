"""The statement ``prove`` of a controller: a claim about its loop."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from fuzzyarm.language.phrases import Occurrence
from fuzzyarm.language.signals import TimeNode
from fuzzyarm.language.tokens import Cursor, Figure, Word
from fuzzyarm.model.claims import LoopClaim
from fuzzyarm.text.diagnostic import NOWHERE, Span

__all__ = ["LOOP_CLAIM_WORDS", "LoopClaimNode", "StateStretch", "claim_node"]

LOOP_CLAIM_WORDS = {
    "stable": "the loop goes to rest from wherever it starts in a region that the proof says",
    "on": "",
    "at": "constant set points; 0 for other ports",
    "with": "parameters of the plant that may be anywhere in an interval",
    "from": "",
    "in": "",
    "during": "while a time lasts",
    "after": "from a time on",
    "always": "from the start on",
}
"""The other words of the statement, with one line of help where it is needed."""


class StateStretch(NamedTuple):
    """``NAME in LOW .. HIGH``: a state, a parameter or an output of a plant."""

    name: Word
    low: Figure
    high: Figure

    @classmethod
    def read(cls, cursor: Cursor, what: str) -> StateStretch:
        """Read it from the cursor."""
        name = cursor.name(what)
        cursor.expect("in", f"after '{name.text}'")
        low = cursor.figure("the lowest value")
        cursor.expect("..", "between the ends of the interval")
        return cls(name, low, cursor.figure("the highest value"))

    @classmethod
    def read_all(cls, cursor: Cursor, what: str) -> tuple[StateStretch, ...]:
        """Read some with commas between them."""
        found = [cls.read(cursor, what)]
        while cursor.accept(","):
            found.append(cls.read(cursor, what))
        return tuple(found)

    def __str__(self) -> str:
        return f"{self.name} in {self.low} .. {self.high}"


class LoopClaimNode(NamedTuple):
    """``prove [stable] on PLANT [at …] [with …] [from …][: OUTPUT in LOW .. HIGH [WHEN]]``."""

    stable: bool
    plant: Word
    at: tuple[tuple[Word, Figure], ...] = ()
    parameters: tuple[StateStretch, ...] = ()
    start: tuple[StateStretch, ...] = ()
    output: StateStretch | None = None
    when: str = "always"
    begin: TimeNode | Figure | None = None
    end: TimeNode | None = None
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> LoopClaimNode:
        """Read it from the cursor."""
        cursor.take()
        stable = cursor.accept("stable") is not None
        cursor.expect("on", "before the plant")
        plant = cursor.name("a plant")
        at: list[tuple[Word, Figure]] = []
        if cursor.accept("at"):
            while True:
                port = cursor.name("an output of the plant")
                cursor.expect("=", f"after '{port.text}'")
                at.append((port, cursor.figure("its set point")))
                if not cursor.accept(","):
                    break
        parameters: tuple[StateStretch, ...] = ()
        start: tuple[StateStretch, ...] = ()
        if cursor.accept("with"):
            parameters = StateStretch.read_all(cursor, "a parameter of the plant")
        if cursor.accept("from"):
            start = StateStretch.read_all(cursor, "a state of the plant")
        made = cls(stable, plant, tuple(at), parameters, start)
        if not stable:
            cursor.expect(":", "before what is claimed")
        elif not cursor.accept(":"):
            return made._replace(span=cursor.whole)
        return made._claimed(cursor)

    def _claimed(self, cursor: Cursor) -> LoopClaimNode:
        output = StateStretch.read(cursor, "an output of the plant")
        made = self._replace(output=output)
        if cursor.accept("during"):
            begin = cursor.figure("when it begins")
            cursor.expect("..", "between the times")
            end = TimeNode.read(cursor, "when it ends", 1.0)
            made = made._replace(when="during", begin=begin, end=end)
        elif cursor.accept("after"):
            made = made._replace(when="after", begin=TimeNode.read(cursor, "from when on", 1.0))
        else:
            cursor.accept("always")
        return made._replace(span=cursor.whole)

    def __str__(self) -> str:
        text = f"prove {'stable ' if self.stable else ''}on {self.plant}"
        if self.at:
            text += " at " + ", ".join(f"{port} = {value}" for port, value in self.at)
        if self.parameters:
            text += " with " + ", ".join(map(str, self.parameters))
        if self.start:
            text += " from " + ", ".join(map(str, self.start))
        if self.output is not None:
            text += f": {self.output}"
            if self.when == "during":
                text += f" during {self.begin} .. {self.end}"
            elif self.when == "after":
                text += f" after {self.begin}"
        return text

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it: all are the plant's, of which the language knows nothing."""
        return iter(())

    @property
    def stretches(self) -> tuple[StateStretch, ...]:
        """All of its intervals."""
        claimed = () if self.output is None else (self.output,)
        return (*self.parameters, *self.start, *claimed)

    @property
    def claim(self) -> LoopClaim:
        """What it means."""

        def stretches(nodes: tuple[StateStretch, ...]) -> tuple[tuple[str, float, float], ...]:
            return tuple((n.name.text, n.low.value, n.high.value) for n in nodes)

        begin, end = 0.0, math.inf
        if self.when == "during":
            assert self.end is not None
            assert isinstance(self.begin, Figure)
            end = self.end.seconds
            # In the unit of the end: 0.5 .. 1 s.
            begin = self.begin.value * (end / self.end.figure.value if self.end.figure.value else 1)
        elif isinstance(self.begin, TimeNode):
            begin = self.begin.seconds
        output = self.output
        return LoopClaim(
            self.plant.text,
            self.stable,
            tuple((port.text, value.value) for port, value in self.at),
            stretches(self.parameters),
            stretches(self.start),
            "" if output is None else output.name.text,
            0.0 if output is None else output.low.value,
            0.0 if output is None else output.high.value,
            "after" if self.when == "after" else "during" if self.when == "during" else "always",
            begin,
            end,
            self.span,
        )


def claim_node(claim: LoopClaim) -> LoopClaimNode:
    """Return a claim as it would be written."""

    def figure(value: float) -> Figure:
        return Figure(value)

    def stretch(name: str, low: float, high: float) -> StateStretch:
        return StateStretch(Word(name), figure(low), figure(high))

    def seconds(value: float) -> TimeNode:
        return TimeNode(figure(value), "s")

    begin: TimeNode | Figure | None = None
    if claim.when == "during":
        begin = figure(claim.begin)
    elif claim.when == "after":
        begin = seconds(claim.begin)
    return LoopClaimNode(
        claim.stable,
        Word(claim.plant),
        tuple((Word(name), figure(value)) for name, value in claim.at),
        tuple(stretch(*each) for each in claim.parameters),
        tuple(stretch(*each) for each in claim.start),
        stretch(claim.output, claim.low, claim.high) if claim.output else None,
        claim.when,
        begin,
        seconds(claim.end) if claim.when == "during" else None,
        claim.span,
    )
