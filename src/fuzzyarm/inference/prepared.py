"""Products of a rule base, each made once, at its first use: plan, layout, kernel at a point."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.symbolic.kernels import lock
from fuzzyarm.symbolic.records import emptied_with_kinds

_Part = TypeVar("_Part")
_Make = Callable[[RuleBase], _Part]

MOST = 32
"""Rule bases whose products are remembered."""


class Prepared:
    """One rule base and its products.

    Parameters
    ----------
    rulebase : RuleBase
        The model; holding it keeps its identity unique.
    """

    def __init__(self, rulebase: RuleBase) -> None:
        self.rulebase = rulebase
        self._parts: dict[_Make[Any], Any] = {}

    def part(self, make: _Make[_Part]) -> _Part:
        """Return the result of a function of the rule base, computed at its first use."""
        if make not in self._parts:
            self._parts[make] = make(self.rulebase)
        part: _Part = self._parts[make]
        return part


known: dict[int, Prepared] = {}
"""The last few, by the identity of the rule base; the oldest first."""

at_point: dict[int, Callable[[Any], dict[str, float] | None]] = {}
"""Point kernels of those in `known` that have one: from inputs by name to outputs
by name; None for extraordinary points."""

_turn = lock()


def _empty() -> None:
    with _turn:
        at_point.clear()
        known.clear()


emptied_with_kinds(_empty)


def prepared(rulebase: RuleBase) -> Prepared:
    """Return the products of a rule base; those of the last few are cached."""
    earlier = known.get(id(rulebase))
    if earlier is not None and earlier.rulebase is rulebase:
        return earlier
    new = Prepared(rulebase)
    with _turn:
        known[id(rulebase)] = new
        while len(known) > MOST:
            oldest = next(iter(known))
            at_point.pop(oldest, None)  # before another rule base can get this identity
            known.pop(oldest)
    return new


def remember_point(rulebase: RuleBase, named: Callable[[Any], dict[str, float] | None]) -> None:
    """Let later calls for a rule base find its kernel at a point."""
    with _turn:
        if id(rulebase) in known and known[id(rulebase)].rulebase is rulebase:
            at_point[id(rulebase)] = named


def remembered(make: _Make[_Part]) -> _Make[_Part]:
    """Cache the result of a function with its rule base; a decorator."""

    @wraps(make)
    def remembering(rulebase: RuleBase) -> _Part:
        return prepared(rulebase).part(make)

    return remembering
