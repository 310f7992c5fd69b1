"""The language of ``.frb`` files: model, reading, canonical printing, checks.

Only the standard library is used here, so importing it is instant.
"""

from fuzzyarm.rulebase.diagnostic import Diagnostic, Related, RuleBaseError, Severity, Span
from fuzzyarm.rulebase.formatting import format_text
from fuzzyarm.rulebase.model import (
    And,
    Consequent,
    Defuzzifier,
    Expectation,
    Expression,
    Hedge,
    Hedged,
    Input,
    Is,
    Lookup,
    LookupAxis,
    Or,
    Outcome,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
    Variable,
)
from fuzzyarm.rulebase.parsing import Parsed, load_rulebase, parse, read_text
from fuzzyarm.rulebase.printing.writer import write

__all__ = [
    "And",
    "Consequent",
    "Defuzzifier",
    "Diagnostic",
    "Expectation",
    "Expression",
    "Hedge",
    "Hedged",
    "Input",
    "Is",
    "Lookup",
    "LookupAxis",
    "Or",
    "Outcome",
    "Output",
    "Parsed",
    "Related",
    "Rule",
    "RuleBase",
    "RuleBaseError",
    "RuleBlock",
    "Severity",
    "Shape",
    "Span",
    "Term",
    "Variable",
    "format_text",
    "load_rulebase",
    "parse",
    "read_text",
    "write",
]
