"""Write a rule base in Python, statement by statement: :class:`fuzzyarm.RuleBaseBuilder`."""

from typing import TYPE_CHECKING

from fuzzyarm.apps.builder.lines import BuilderArgumentError
from fuzzyarm.apps.builder.rulebase import RuleBaseBuilder, VariableBuilder
from fuzzyarm.base.lazy import lazily

__all__ = ["BuilderArgumentError", "RuleBaseBuilder", "VariableBuilder"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
