"""What has been made of a rule base: plan, point engine, layout …, each once, at its first use."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

from fuzzyarm.expression.records import emptied_with_kinds
from fuzzyarm.model.rulebase import RuleBase

_Part = TypeVar("_Part")
_Make = Callable[[RuleBase], _Part]

MOST = 32
"""Rule bases of which everything is remembered."""


class Prepared:
    """One rule base, and all that has been made of it.

    Parameters
    ----------
    rulebase : RuleBase
        The model; holding it keeps its identity unique.
    """

    def __init__(self, rulebase: RuleBase) -> None:
        self.rulebase = rulebase
        self._parts: dict[_Make[Any], Any] = {}

    def part(self, make: _Make[_Part]) -> _Part:
        """Return what a function makes of the rule base, made at the first time."""
        if make not in self._parts:
            self._parts[make] = make(self.rulebase)
        part: _Part = self._parts[make]
        return part


_prepared: dict[int, Prepared] = {}
"""The last few, by the identity of the rule base; the oldest first."""

emptied_with_kinds(_prepared.clear)


def prepared(rulebase: RuleBase) -> Prepared:
    """Return what has been made of a rule base; the last few are remembered."""
    earlier = _prepared.get(id(rulebase))
    if earlier is not None and earlier.rulebase is rulebase:
        return earlier
    new = Prepared(rulebase)
    _prepared[id(rulebase)] = new
    while len(_prepared) > MOST:
        _prepared.pop(next(iter(_prepared)), None)
    return new


def remembered(make: _Make[_Part]) -> _Make[_Part]:
    """Let what a function makes of a rule base belong to that; a decorator."""

    @wraps(make)
    def remembering(rulebase: RuleBase) -> _Part:
        return prepared(rulebase).part(make)

    return remembering
