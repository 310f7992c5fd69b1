"""Write a rule base in Python, statement by statement: :class:`fuzzyarm.RuleBase`."""

from fuzzyarm.builder.lines import ArgumentError
from fuzzyarm.builder.rulebase import RuleBase, Variable
from fuzzyarm.lazy import lazily

__all__ = ["ArgumentError", "RuleBase", "Variable"]

__getattr__, __dir__ = lazily(__name__, {}, __all__)
