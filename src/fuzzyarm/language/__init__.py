"""The language of ``.frb`` files: model, reading, canonical printing, checks.

Reading order: :mod:`.model` (the meaning of a file), :mod:`.tokens`, :mod:`.parts` and :mod:`.rows`
(a statement as a row of parts), :mod:`.statements` and :mod:`.controllers` (all rows),
:mod:`.document` (a file as a tree), :mod:`.meaning` (from tree to model), :mod:`.writer` (back
to text), :mod:`.check` (checks of a sound file), :mod:`.edit` (the questions of an editor).

Only the standard library is used here, so importing it is instant.
"""

from typing import TYPE_CHECKING

from fuzzyarm.base.diagnostic import Diagnostic, Related, RuleBaseError, Severity, Span
from fuzzyarm.base.lazy import lazily
from fuzzyarm.language.model.rulebase import (
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
from fuzzyarm.language.reading import Parsed, format_text, load_rulebase, parse, read_text

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

if TYPE_CHECKING:
    from fuzzyarm.language.writer import write

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {"writer": ("write",)}, __all__)
