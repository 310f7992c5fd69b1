"""Write a rule base in Python, statement by statement: :class:`fuzzyarm.RuleBase`."""

from typing import TYPE_CHECKING

from fuzzyarm.builder.lines import ArgumentError
from fuzzyarm.builder.rulebase import RuleBase, Variable
from fuzzyarm.lazy import lazily

__all__ = ["ArgumentError", "RuleBase", "Variable"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
