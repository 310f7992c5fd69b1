"""A source of a test's own, and texts with a line of every source."""

from __future__ import annotations

import math
from pathlib import Path

from fuzzyarm.control.controllers.text import with_files
from fuzzyarm.language import parse
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.sources import SOURCES, OptionKind, SourceState, source, unseen

WORD = "half-mean"


def register():
    """Register it: a share of now, and the quotient of what was by how much that is."""

    def update(x, before, older, share, period):
        past = (before + older) / (2.0 + period * before * before)
        return op.where(unseen(before), x, share * x + (1.0 - share) * past)

    return source(
        WORD,
        update,
        doc="a mean that forgets",
        options={
            "share": OptionKind("number", "what now counts", needed=True, positive=True),
            "from": OptionKind("figure", "what it remembers at first"),
        },
        states=(
            SourceState("before", start=math.nan),
            SourceState("older", lambda x: x, start="from"),
        ),
    )


def example(word):
    """Return a line of a source, with all that it needs."""
    kind = SOURCES[word]
    if kind.of == "call":
        return f"y = {word} R(e)"
    ends = {name: k for name, k in kind.options.items() if k.needed or k.accepts == "range"}
    needed = "".join(f", {name} {k.example}" for name, k in ends.items())
    port = "voltage" if word == "driven" else "position"
    return f"y = {word}{kind.joined} {'e' if kind.of == 'signal' else port}{needed}"


def controller(*lines, head=()):
    """Return the text of a controller of the motor's shaft."""
    body = "".join(f"  {line}\n" for line in ("e = error of position", *lines))
    return "\n".join(["controller c", "period 10 ms", *head, "axis shaft"]) + f"\n{body}"


def whole(word):
    """Return a controller with one source behind its error, limited at its drive."""
    lines = (example(word), "drive voltage = y + 0.001 * e, within -24 .. 24")
    return controller(*lines, head=['use R from "R.lut"'] if SOURCES[word].of == "call" else [])


def made(text):
    """Return the controller of a text without findings."""
    parsed = parse(text)
    assert not parsed.diagnostics, parsed.diagnostics
    text, faults = with_files(parsed.controller, Path())
    assert not faults
    return text
