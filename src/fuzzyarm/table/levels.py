"""Levels of a table in words, as in ``--levels`` and the designer."""

from __future__ import annotations

import re

from fuzzyarm.base.diagnostic import Diagnostic
from fuzzyarm.language.tokens import Cursor, Fault, tokenize
from fuzzyarm.table.axis import TableError
from fuzzyarm.table.header import read_number_list

Levels = int | tuple[float, ...]

_NAMED = re.compile(r"\s*(?P<name>[^=:]+?)\s*[=:]\s*(?P<rest>.+)", re.DOTALL)


def read_levels(text: str) -> Levels | dict[str, Levels]:
    """Return the levels in a line.

    That many even levels for every input (``49``), these levels (``-6 .. 6 step 1``,
    ``0 1 5``), or either for named inputs (``e = 49, ce = -6 .. 6 step 1``).
    """
    parts = [part for part in re.split(r"[,;]", text) if part.strip()]
    if not parts:
        raise TableError("levels is empty")
    if len(parts) == 1 and not _NAMED.match(parts[0]):
        return _levels_of_one(parts[0])
    levels: dict[str, Levels] = {}
    for part in parts:
        match = _NAMED.match(part)
        if match is None:
            raise TableError(
                f"levels '{part.strip()}' does not name its input",
                hint="49 for all inputs, or for each  e = 49, ce = -6 .. 6 step 1",
            )
        levels[match["name"].strip("'")] = _levels_of_one(match["rest"])
    return levels


def _levels_of_one(text: str) -> Levels:
    if re.fullmatch(r"\s*[0-9]+\s*", text):
        return int(text)
    diagnostics: list[Diagnostic] = []
    lines = tokenize(text, diagnostics)
    tokens = lines[0].tokens if lines else ()
    if diagnostics or not tokens:
        raise TableError(f"levels '{text.strip()}' is not a list of numbers")
    cursor = Cursor(tokens)
    try:
        values = read_number_list(cursor, "levels")
        cursor.finish()
    except Fault as fault:
        raise TableError(f"levels '{text.strip()}': {fault.diagnostic.message}") from None
    if len(values) == 1:
        raise TableError(f"levels '{text.strip()}' is not a whole number of levels, from 2 on")
    return values
