"""How many random cases a test takes: a counted part of them, or all with ``pytest --thorough``."""

from __future__ import annotations

_thorough = [False]


def take_all(wanted: bool) -> None:
    """Have tests take all of their cases; said before they are collected."""
    _thorough[0] = wanted


def cases(few: int, all_of_them: int) -> int:
    """Return how many cases a test takes: the first ones of the same row in either run."""
    return all_of_them if _thorough[0] else few
