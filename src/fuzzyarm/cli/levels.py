"""Read the ``--levels`` of ``compile`` in the words of the language."""

from __future__ import annotations

import re

from fuzzyarm.cli.assignments import WordError
from fuzzyarm.lut.text_header import read_number_list
from fuzzyarm.rulebase.diagnostic import Diagnostic
from fuzzyarm.rulebase.syntax.cursor import Cursor, Fault
from fuzzyarm.rulebase.syntax.tokens import tokenize

Levels = int | tuple[float, ...]

_NAMED = re.compile(r"\s*(?P<name>[^=:]+?)\s*[=:]\s*(?P<rest>.+)", re.DOTALL)


def read_levels(text: str) -> Levels | dict[str, Levels]:
    """Return what ``--levels`` asks for.

    Parameters
    ----------
    text : str
        ``49`` (that many even levels for every input), ``-6 .. 6 step 1`` or ``0 1 5``
        (these levels), or either for named inputs: ``e = 49, ce = -6 .. 6 step 1``.

    Raises
    ------
    WordError
        If it cannot be read so.
    """
    parts = [part for part in re.split(r"[,;]", text) if part.strip()]
    if not parts:
        raise WordError("--levels says nothing")
    if len(parts) == 1 and not _NAMED.match(parts[0]):
        return _one(parts[0])
    levels: dict[str, Levels] = {}
    for part in parts:
        match = _NAMED.match(part)
        if match is None:
            raise WordError(f"--levels '{part.strip()}' does not say for which input")
        levels[match["name"].strip("'")] = _one(match["rest"])
    return levels


def _one(text: str) -> Levels:
    if re.fullmatch(r"\s*[0-9]+\s*", text):
        return int(text)
    diagnostics: list[Diagnostic] = []
    lines = tokenize(text, diagnostics)
    tokens = lines[0].tokens if lines else ()
    if diagnostics or not tokens:
        raise WordError(f"--levels '{text.strip()}' is no list of numbers")
    cursor = Cursor(tokens)
    try:
        values = read_number_list(cursor, "levels")
        cursor.finish()
    except Fault as fault:
        raise WordError(f"--levels '{text.strip()}': {fault.diagnostic.message}") from None
    if len(values) == 1:
        raise WordError(f"--levels '{text.strip()}' is no whole number of levels")
    return values
