"""Stretches of a text that can be folded away."""

from __future__ import annotations

from dataclasses import dataclass

from fuzzyarm.rulebase.queries.reading import Reading
from fuzzyarm.rulebase.syntax.nodes import BlockNode


@dataclass(frozen=True, slots=True)
class Fold:
    """Lines `first` to `last`, from 1; `is_comment` for runs of comment lines."""

    first: int
    last: int
    is_comment: bool = False


def folds(reading: Reading) -> list[Fold]:
    """Return grids, lookup settings, long rules, blocks and runs of comment lines."""
    found = [Fold(first, last) for _, first, last in reading.extents if last > first]
    found += _blocks(reading)
    found += _comments(reading)
    return sorted(found, key=lambda fold: (fold.first, -fold.last))


def _blocks(reading: Reading) -> list[Fold]:
    extents = reading.extents
    starts = [i for i, (node, _, _) in enumerate(extents) if isinstance(node, BlockNode)]
    ends = [*(i - 1 for i in starts[1:]), len(extents) - 1]
    return [
        Fold(extents[start][1], extents[end][2])
        for start, end in zip(starts, ends, strict=False)
        if end > start
    ]


def _comments(reading: Reading) -> list[Fold]:
    found: list[Fold] = []
    first = 0
    for number in range(1, len(reading.lines) + 2):
        inside = number <= len(reading.lines)
        line = reading.lines[number - 1] if inside else None
        if line is not None and line.comment and not line.tokens:
            first = first or number
            continue
        if first and number - 1 > first:
            found.append(Fold(first, number - 1, is_comment=True))
        first = 0
    return found
