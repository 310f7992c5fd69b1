"""Values of the wrong kind: a rule base for a controller, a table for either.

A function uses an attribute that only the expected kind has. For a value of another kind it then
raises one sentence with the actual kind and a remedy, instead of Python's "has no attribute".
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, ClassVar

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.names import shortened

RULE_BASE, CONTROLLER, TABLE = "rule base", "controller", "lookup table"

MODEL, WHOLE = "rule base or a controller", "controller with its files"
"""The kinds with a `model`."""

HINTS = {
    (RULE_BASE, CONTROLLER): (
        "controller('fuzzy-direct', sources=Sources(rulebase)) of"
        " fuzzyarm.control.controllers runs it on the arm;"
        " for another plant a file with a line `controller` says what goes to which port"
    ),
    (TABLE, CONTROLLER): (
        "controller('fuzzy-lut', sources=Sources(table=(table,))) of"
        " fuzzyarm.control.controllers runs it on the arm;"
        " for another plant a file with a line `controller` looks it up"
    ),
    (CONTROLLER, RULE_BASE): "its rule bases and tables are in `sheets`, by name",
    (TABLE, RULE_BASE): "its method `lookup` gives its values",
    (TABLE, MODEL): "its method `lookup` gives its values",
    (CONTROLLER, WHOLE): "fuzzyarm.load reads it with its files",
}
"""Hints, by actual and expected kind."""

HAS = {
    **dict.fromkeys(
        (
            "inputs",
            "outputs",
            "output",
            "blocks",
            "rules",
            "is_type2",
            "properties",
            "expectations",
        ),
        RULE_BASE,
    ),
    **dict.fromkeys(
        ("sheets", "rulebases", "period", "axis_names", "partners", "uses", "gains", "law"),
        CONTROLLER,
    ),
    "model": MODEL,
}
"""Attributes that imply the expected kind."""


class MistakenKindError(FuzzyarmError, AttributeError, ValueError):
    """A value or a file of an unexpected kind.

    Attributes
    ----------
    kind, expected : str
        ``rule base``, ``controller`` or ``lookup table``.
    """

    def __init__(self, what: str, kind: str, expected: str, *, hint: str = "") -> None:
        article = "an" if kind[:1] in "aeiou" else "a"
        text = (
            f"{what} is {article} {kind}, not a {expected}"
            if kind
            else f"{what} is not a {expected}"
        )
        super().__init__(text, hint=hint)
        self.kind, self.expected = kind, expected


def wrong_kind(value: object, expected: str) -> MistakenKindError:
    """Return the error for a value of another kind than expected."""
    if isinstance(value, OfKind):
        kind = type(value).kind_of_value
        other = expected
        if kind == CONTROLLER and expected in (MODEL, kind):  # the value is a model
            other = f"rule base or a {WHOLE}" if expected == MODEL else WHOLE
        hint = HINTS.get((kind, WHOLE if other.endswith(WHOLE) else other), "")
        text = "controller without its files" if other == WHOLE else kind
        return MistakenKindError(f"'{value.called()}'", text, other, hint=hint)
    if isinstance(value, type):
        name = value.__name__
        return MistakenKindError(name, "class", expected, hint=f"{name}() makes one of its values")
    kind = "" if value is None else type(value).__name__  # "None is not a rule base" says it all
    hint = "fuzzyarm.load reads a file" if isinstance(value, str | os.PathLike) else ""
    return MistakenKindError(shortened(repr(value), 80), kind, expected, hint=hint)


class OfKind:
    """Base class of values that users mix up."""

    __slots__ = ()

    kind_of_value: ClassVar[str] = ""

    def called(self) -> str:
        """Return the name for messages."""
        return str(getattr(self, "name", ""))

    if not TYPE_CHECKING:  # no class has it: a type checker must not accept it

        def __getattr__(self, name: str) -> object:
            kind = type(self).kind_of_value
            kind_with_it = HAS.get(name)
            if kind_with_it in (None, kind) and name != "sheets":
                raise AttributeError(
                    f"'{type(self).__name__}' object has no attribute '{name}'",
                    name=name,
                    obj=self,
                )
            raise wrong_kind(self, kind_with_it)
