"""The search for a point without a firing rule, among a few cells of each variable.

A rule needs literals of some variables to hold; a cell of a variable is a set of literals that hold
together. To find cells, one for each variable, that violate every rule is satisfiability: hard in
the worst case, but linear in the rules of a full table, and a few steps otherwise. So the search
counts its steps, and gives up after a budget in proportion to the rules.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

from fuzzyarm.language.model.rulebase import Hedge

Literal = tuple[str, tuple[Hedge, ...]]
"""A term with its hedges."""

BUDGET = 300_000
"""Steps of a search, besides some for each literal of its rules."""

_STEPS_PER_LITERAL = 10


class VariableStretch(NamedTuple):
    """A stretch of a variable, by one position in it.

    Attributes
    ----------
    x : float
        The position.
    degrees : dict
        The literals that hold there, each with its degree.
    """

    x: float
    degrees: dict[Literal, float]


Cells = dict[str, VariableStretch]
"""A cell for each decided variable."""


class Need(NamedTuple):
    """The conditions of a rule by variable, and its verdict when they hold.

    Attributes
    ----------
    literals : mapping of str to frozenset
        Conditions on each variable; empty if only `fires` can decide.
    fires : callable or None
        Whether the rule fires in the cells of its variables. None: it does.
    """

    literals: Mapping[str, frozenset[Literal]]
    fires: Callable[[Cells], bool] | None = None


class GaveUpError(Exception):
    """The budget is used up."""


class GapSearch:
    """All combinations of cells that violate every rule.

    Parameters
    ----------
    needs : sequence of Need
        One for each rule.
    cells : mapping of str to sequence of VariableStretch
        The cells of each variable that the rules name.
    on_step : callable
        Called repeatedly; an exception ends the search.

    Attributes
    ----------
    steps : int
        Number of steps so far.
    """

    def __init__(
        self,
        needs: Sequence[Need],
        cells: Mapping[str, Sequence[VariableStretch]],
        on_step: Callable[[], None] = lambda: None,
    ) -> None:
        self._needs = needs
        self._cells = cells
        self._on_step = on_step
        self.steps = 0
        self._budget = BUDGET + _STEPS_PER_LITERAL * sum(len(need.literals) for need in needs)

    def uncovered(self) -> Iterator[Cells]:
        """Yield cells in which no rule fires; free variables are omitted."""
        return self._search([(len(need.literals), need) for need in self._needs], {})

    def _search(self, rules: list[tuple[int, Need]], decided: Cells) -> Iterator[Cells]:
        """Go on with the rules that may still fire, each with the count of its open variables."""
        if not rules:
            yield dict(decided)
            return
        self._on_step()
        self._count(len(rules))
        _, shortest = min(rules, key=lambda rule: rule[0])
        variable = next(name for name in shortest.literals if name not in decided)
        # Few rules have several literals of a variable: index them by literal.
        by_literal: dict[Literal, list[tuple[int, Need]]] = {}
        by_several: list[tuple[frozenset[Literal], tuple[int, Need]]] = []
        elsewhere: list[tuple[int, Need]] = []
        for rule in rules:
            literals_here = rule[1].literals.get(variable)
            if literals_here is None:
                elsewhere.append(rule)
            elif len(literals_here) == 1:
                by_literal.setdefault(next(iter(literals_here)), []).append(rule)
            else:
                by_several.append((literals_here, rule))
        for cell in self._cells[variable]:
            holding = cell.degrees
            met = [rule for literal in holding for rule in by_literal.get(literal, ())]
            met += [rule for literals_here, rule in by_several if literals_here <= holding.keys()]
            self._count(1 + len(holding) + len(by_several) + len(met))
            decided[variable] = cell
            if not any(left == 1 and self._fires(need, decided) for left, need in met):
                self._count(len(elsewhere))
                open_rules = [(left - 1, need) for left, need in met if left > 1]
                yield from self._search(elsewhere + open_rules, decided)
            del decided[variable]

    def _fires(self, need: Need, decided: Cells) -> bool:
        if need.fires is None:
            return True
        self._count(10)
        return need.fires(decided)

    def _count(self, steps: int) -> None:
        self.steps += steps
        if self.steps > self._budget:
            raise GaveUpError


def distinct(cells: Sequence[VariableStretch]) -> list[VariableStretch]:
    """Return the first of the cells with the same degrees."""
    return list({frozenset(cell.degrees.items()): cell for cell in reversed(cells)}.values())[::-1]


def smallest(cells: Sequence[VariableStretch]) -> list[VariableStretch]:
    """Return the cells whose literals include those of no other cell."""
    first: dict[frozenset[Literal], VariableStretch] = {}
    for cell in cells:
        first.setdefault(frozenset(cell.degrees), cell)
    smallest_cells: list[VariableStretch] = []
    by_literal: dict[Literal, list[frozenset[Literal]]] = {}
    for literals in sorted(first, key=len):
        if not literals:
            return [first[literals]]
        if any(
            earlier <= literals for literal in literals for earlier in by_literal.get(literal, ())
        ):
            continue
        by_literal.setdefault(next(iter(literals)), []).append(literals)
        smallest_cells.append(first[literals])
    return sorted(smallest_cells, key=lambda cell: cell.x)
