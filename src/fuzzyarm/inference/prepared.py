"""What has been made of a rule base: plan, point engine, layout …, each once, at its first use."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.symbolic.records import emptied_with_kinds

_Part = TypeVar("_Part")
_Make = Callable[[RuleBase], _Part]

MOST = 32
"""Rule bases of which everything is remembered."""


def _not_yet(_inputs: Any) -> dict[str, float] | None:
    """Stand for a kernel that was not asked for so far."""
    return None


class Prepared:
    """One rule base, and all that has been made of it.

    Parameters
    ----------
    rulebase : RuleBase
        The model; holding it keeps its identity unique.

    Attributes
    ----------
    named : callable
        From inputs by name to outputs by name: its kernel at a point; None for what that leaves
        to others.
    """

    def __init__(self, rulebase: RuleBase) -> None:
        self.rulebase = rulebase
        self.named: Callable[[Any], dict[str, float] | None] = _not_yet
        self._parts: dict[_Make[Any], Any] = {}

    def part(self, make: _Make[_Part]) -> _Part:
        """Return what a function makes of the rule base, made at the first time."""
        if make not in self._parts:
            self._parts[make] = make(self.rulebase)
        part: _Part = self._parts[make]
        return part


known: dict[int, Prepared] = {}
"""The last few, by the identity of the rule base; the oldest first."""

emptied_with_kinds(known.clear)


def prepared(rulebase: RuleBase) -> Prepared:
    """Return what has been made of a rule base; the last few are remembered."""
    earlier = known.get(id(rulebase))
    if earlier is not None and earlier.rulebase is rulebase:
        return earlier
    new = Prepared(rulebase)
    known[id(rulebase)] = new
    while len(known) > MOST:
        known.pop(next(iter(known)), None)
    return new


def remembered(make: _Make[_Part]) -> _Make[_Part]:
    """Let what a function makes of a rule base belong to that; a decorator."""

    @wraps(make)
    def remembering(rulebase: RuleBase) -> _Part:
        return prepared(rulebase).part(make)

    return remembering
