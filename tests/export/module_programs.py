"""Rule bases as modules of JavaScript, made for tests."""

from __future__ import annotations

from fuzzyarm.exchange.export import routines_of
from fuzzyarm.exchange.export.languages import MODULES
from fuzzyarm.exchange.export.write import routines_module
from fuzzyarm.language.model.rulebase import RuleBase


def javascript_of(rulebase: RuleBase) -> str:
    """Return the rules of all outputs as a module."""
    routines = routines_of(rulebase, precision="float64")
    return routines_module(routines, MODULES[".mjs"], "rules")[0]
