"""Write a rule base in Python, statement by statement: :class:`fuzzyarm.RuleBaseBuilder`."""

from typing import TYPE_CHECKING

from fuzzyarm.builder.lines import BuilderArgumentError
from fuzzyarm.builder.rulebase import RuleBaseBuilder, VariableBuilder
from fuzzyarm.lazy import lazily

__all__ = ["BuilderArgumentError", "RuleBaseBuilder", "VariableBuilder"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
