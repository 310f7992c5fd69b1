"""Canonical formatting of a text, comments kept."""

from __future__ import annotations

from fuzzyarm.rulebase.diagnostic import RuleBaseError
from fuzzyarm.rulebase.parsing import parse
from fuzzyarm.rulebase.printing.printer import print_document


def format_text(text: str, path: str = "<text>") -> str:
    """Return `text` in canonical form; formatting the result again changes nothing.

    Parameters
    ----------
    text : str
        A rule base without errors.
    path : str
        Name of the file, for the diagnostics.

    Raises
    ------
    RuleBaseError
        If `text` has mistakes: what is not understood is not rewritten.
    """
    parsed = parse(text, path)
    if parsed.rulebase is None:
        raise RuleBaseError(parsed.diagnostics)
    return print_document(parsed.document)
