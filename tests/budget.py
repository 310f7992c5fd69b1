"""How many cases a test takes: a counted part of them, or all with ``pytest --thorough``."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product
from typing import TypeVar

T = TypeVar("T")

_thorough = [False]


def take_all(wanted: bool) -> None:
    """Have tests take all of their cases; said before they are collected."""
    _thorough[0] = wanted


def cases(few: int, all_of_them: int) -> int:
    """Return how many random cases a test takes: the first ones of the same row in either run."""
    return all_of_them if _thorough[0] else few


def part(things: Sequence[T], step: int) -> Sequence[T]:
    """Return one of every `step` things of a row, the first included; all with ``--thorough``.

    For rows that go through something dear and are held by something cheap as a whole.
    """
    return things if _thorough[0] else things[::step]


def crossed(*sides: Iterable) -> list[tuple]:
    """Return the cells of a matrix: all with ``--thorough``, otherwise those of its diagonals.

    A diagonal begins at the first cell and goes one row down and one column on at a time, to the
    first again behind the last, until the longest side is through: every row is there and every
    column. With three sides or more it is the same. Sides of equal lengths give their one
    diagonal; what belongs together by position is therefore not a matrix for this.
    """
    sides = tuple(map(tuple, sides))
    if _thorough[0]:
        return list(product(*sides))
    return [
        tuple(side[i % len(side)] for side in sides) for i in range(max(map(len, sides), default=0))
    ]
