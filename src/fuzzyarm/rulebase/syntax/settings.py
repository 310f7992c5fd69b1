"""Read ``key value`` pairs of ``inference`` and ``block``."""

from __future__ import annotations

from fuzzyarm.rulebase.model import CONJUNCTIONS, DEFUZZIFIERS, DISJUNCTIONS, SAMPLINGS
from fuzzyarm.rulebase.syntax.cursor import Cursor
from fuzzyarm.rulebase.syntax.nodes import SettingNode, Word
from fuzzyarm.rulebase.syntax.words import SETTINGS

OUTSIDE = ("clamp", "extend", "error")
CHOICES: dict[str, tuple[str, ...]] = {
    "and": CONJUNCTIONS,
    "or": tuple(name for name in DISJUNCTIONS if name not in ("sum", "normalized")),
    "implication": CONJUNCTIONS,
    "aggregation": DISJUNCTIONS,
    "outside": OUTSIDE,
}
"""The words that each setting takes; ``defuzzifier`` and ``no-rule`` are read apart."""


def read_settings(cursor: Cursor) -> tuple[SettingNode, ...]:
    """Read one or more settings with commas between them."""
    settings = [_read_setting(cursor)]
    while cursor.accept(","):
        settings.append(_read_setting(cursor))
    return tuple(settings)


def _read_setting(cursor: Cursor) -> SettingNode:
    key = cursor.word(f"one of {', '.join(SETTINGS)}", SETTINGS, "unknown-setting")
    if key.text == "defuzzifier":
        return _read_defuzzifier(cursor, key)
    if key.text == "no-rule":
        token = cursor.peek()
        if token is not None and token.kind == "name" and token.text in ("error", "hold"):
            cursor.take()
            return SettingNode(key, value=Word(token.text, token.span))
        what = "error, hold or a number for the case that no rule fires"
        return SettingNode(key, figure=cursor.figure(what, finite=False))
    if key.text == "threshold":
        return SettingNode(key, figure=cursor.figure("the threshold of firing strengths"))
    choices = CHOICES[key.text]
    value = cursor.word(f"one of {', '.join(choices)}", choices, "unknown-choice")
    return SettingNode(key, value=value)


def _read_defuzzifier(cursor: Cursor, key: Word) -> SettingNode:
    method = cursor.word(
        f"a defuzzifier: {', '.join(DEFUZZIFIERS)}", DEFUZZIFIERS, "unknown-defuzzifier"
    )
    if cursor.accept("exact"):
        return SettingNode(key, value=method, exact=True)
    if not cursor.accept("("):
        return SettingNode(key, value=method)
    resolution = cursor.figure("the number of samples")
    sampling: Word | None = None
    if cursor.accept(","):
        sampling = cursor.word(f"one of {', '.join(SAMPLINGS)}", SAMPLINGS, "unknown-choice")
    cursor.expect(")", "after the sampling")
    return SettingNode(key, value=method, resolution=resolution, sampling=sampling)
