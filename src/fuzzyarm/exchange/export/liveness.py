"""Liveness of variables in a function lowered from Python.

Python's names live as long as a function; those of other languages as long as a block.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from fuzzyarm.exchange.export.typed_program import (
    OFFSET,
    REAL,
    TRUTH,
    ArrayArgument,
    Called,
    Count,
    Element,
    Line,
    Run,
    Store,
    Truth,
    Variable,
    When,
    While,
    Whole,
    blocks_of,
    every_line,
    every_node,
)  # fmt: skip
from fuzzyarm.symbolic.nodes import Symbol, constant
from fuzzyarm.symbolic.printing import Assign


def _own(line: Line) -> list[Any]:
    """Return the symbols read by a statement itself, without its blocks."""
    if isinstance(line, When | While):
        return [line.condition]
    if isinstance(line, Count):
        return [line.start, line.end]
    return list(line[1:]) if isinstance(line, Assign) else list(line)


def _names(nodes: Sequence[Any]) -> set[str]:
    names = set()
    for node in every_node(nodes):
        if isinstance(node, Symbol):
            names.add(node.name)
        elif isinstance(node, Element | ArrayArgument):
            names.add(node.array)
    return names


def read_in(body: Sequence[Line]) -> set[str]:
    """Return the variables and arrays that statements read or write into."""
    found = set[str]()
    for line in every_line(body):
        found |= _names(_own(line))
        if isinstance(line, Store):
            found.add(line.array)
    return found


def set_in(body: Sequence[Line]) -> set[str]:
    """Return the variables that statements set."""
    return {line.name for line in every_line(body) if isinstance(line, Assign)}


def without_unread(body: list[Line]) -> list[Line]:
    """Return statements without variables that nothing reads."""
    kept = _only(body, read_in(body))
    if len(list(every_line(kept))) == len(list(every_line(body))):
        return kept
    return without_unread(kept)


def _only(body: Sequence[Line], read: set[str]) -> list[Line]:
    lines: list[Line] = []
    for line in body:
        if isinstance(line, When):
            then, otherwise = (tuple(_only(part, read)) for part in (line.then, line.otherwise))
            kept = When(line.condition, then, otherwise)
            lines += [kept] if kept.then or kept.otherwise else []
        elif isinstance(line, Count | While):
            lines.append(line._replace(body=tuple(_only(line.body, read))))
        elif not isinstance(line, Assign) or line.name in read:
            lines.append(line)
        elif isinstance(line.value, Called):  # for its side effects
            lines.append(Run(line.value.function, line.value.arguments))
    return lines


def declared_first(
    body: Sequence[Line], parameters: set[str], variables: Mapping[str, Variable]
) -> list[Line]:
    """Return assignments of zero to variables read outside the block that sets them."""
    outside: dict[str, None] = {}

    def visit(block: Sequence[Line], known: set[str]) -> None:
        known = set(known)
        for line in block:
            for name in _names(_own(line)):
                if name in variables and name not in known:
                    outside.setdefault(name)
            if isinstance(line, Assign):
                known.add(line.name)
            inner = known | ({line.variable} if isinstance(line, Count) else set())
            for part in blocks_of(line):
                visit(part, inner)

    visit(body, parameters)
    zero = {OFFSET: Whole(0), REAL: constant(0.0), TRUTH: Truth(False)}
    return [Assign(name, zero[variables[name].kind]) for name in outside]
