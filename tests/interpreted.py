"""The kernel without machine code: its source, line by line."""

from __future__ import annotations

from fuzzyarm.inference import Compiled
from fuzzyarm.language.model.rulebase import RuleBase


def interpreted(rulebase: RuleBase) -> Compiled:
    """Return a rule base whose kernel is interpreted."""
    return Compiled(rulebase, interpreted=True)
