"""The model of a rule base, independent of text: data, shapes, formulas.

The classes of a rule base and of a controller as immutable values, equal where they mean the
same.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

if TYPE_CHECKING:
    from fuzzyarm.language.model.controller import ControllerModel
    from fuzzyarm.language.model.rulebase import (
        And,
        AnyRuleBase,
        Consequent,
        Defuzzifier,
        Expectation,
        Hedge,
        Hedged,
        Input,
        Is,
        Lookup,
        LookupAxis,
        NotInModelError,
        Or,
        Outcome,
        Output,
        Property,
        Rule,
        RuleBase,
        RuleBlock,
        Shape,
        Term,
        Variable,
    )

__all__ = [
    "And",
    "AnyRuleBase",
    "Consequent",
    "ControllerModel",
    "Defuzzifier",
    "Expectation",
    "Hedge",
    "Hedged",
    "Input",
    "Is",
    "Lookup",
    "LookupAxis",
    "NotInModelError",
    "Or",
    "Outcome",
    "Output",
    "Property",
    "Rule",
    "RuleBase",
    "RuleBlock",
    "Shape",
    "Term",
    "Variable",
]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(
        __name__,
        {
            "controller": ("ControllerModel",),
            "rulebase": (
                "And",
                "AnyRuleBase",
                "Consequent",
                "Defuzzifier",
                "Expectation",
                "Hedge",
                "Hedged",
                "Input",
                "Is",
                "Lookup",
                "LookupAxis",
                "NotInModelError",
                "Or",
                "Outcome",
                "Output",
                "Property",
                "Rule",
                "RuleBase",
                "RuleBlock",
                "Shape",
                "Term",
                "Variable",
            ),
        },
    )
