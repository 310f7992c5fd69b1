"""Checks of rules and grids: contradictory, repeated, folded into one; nearly symmetric, cliffs.

Each check is a function from a subject to its findings; :mod:`.registry` runs them all.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterator, Mapping
from math import isfinite
from typing import NamedTuple

from fuzzyarm.base.diagnostic import Diagnostic, Related
from fuzzyarm.language.check.subject import Subject, plain_propositions
from fuzzyarm.language.model.rulebase import (
    Consequent,
    Expression,
    Hedged,
    Is,
    Or,
    Rule,
)
from fuzzyarm.language.phrases import JunctionNode, PropositionNode
from fuzzyarm.language.rules import CellNode, GridNode

# --- Rules with the same antecedent: contradictory, or repeated ---


def conflicting_rules(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``contradictory-rules`` and ``duplicate-rule``."""
    for block in subject.rulebase.blocks:
        first: dict[Hashable, dict[str, tuple[Rule, Consequent]]] = {}
        for rule in block.rules:
            earlier = first.setdefault(_key(rule.antecedent), {})
            for consequent in rule.consequents:
                if consequent.variable not in earlier:
                    earlier[consequent.variable] = (rule, consequent)
                    continue
                yield _conflict(rule, consequent, *earlier[consequent.variable])


def _conflict(rule: Rule, consequent: Consequent, other: Rule, earlier: Consequent) -> Diagnostic:
    text, before = (
        f"{conclusion.variable} is {conclusion.term}" for conclusion in (consequent, earlier)
    )
    same = (consequent.term, consequent.hedges) == (earlier.term, earlier.hedges)
    span, line = rule.span, other.span.line
    related = Related(f"the other rule, on line {line}", other.span)
    if rule is other:
        message = f"says {text} twice" if same else f"says both {before} and {text}"
        span, related = consequent.span, Related("first stated here", earlier.span)
    elif same:
        message = f"is already on line {line}"
    else:
        message = f"says {text}, but line {line} says {earlier.term}"
    name = "duplicate-rule" if same else "contradictory-rules"
    return Diagnostic(name, f"the rule {_words(rule)} {message}", span, related=(related,))


def _words(rule: Rule) -> str:
    pairs = [f"{p.variable} is {p.term}" for p in plain_propositions(rule)]
    return f"'{' and '.join(pairs)}'" if pairs else "with this antecedent"


def _key(expression: Expression) -> Hashable:
    """Return a key, equal for antecedents with the same operands in any order."""
    if isinstance(expression, Is):
        return (expression.variable, expression.term, expression.hedges)
    if isinstance(expression, Hedged):
        return ("hedged", expression.hedges, _key(expression.operand))
    word = "or" if isinstance(expression, Or) else "and"
    return (word, frozenset(map(_key, expression.operands)))


# --- Grids that are antisymmetric (or symmetric) except for a few cells ---

ALMOST = 0.75
"""So large a part of the pairs must mirror for the others to look like slips."""

_FEWEST_PAIRS = 4

OFF_CENTRE = 0.1
"""How far from 0 the two ends of an input may meet, as a share of its range."""

_Position = tuple[tuple[str, int], ...]
"""Variables and the ranks of their terms: of the row, of the column, of the condition."""

_Pair = tuple[CellNode, CellNode]


class _Family(NamedTuple):
    """The filled cells of the grids of one output over the same variables.

    A grid under ``when p is N`` may mirror its twin under ``when p is P``, or itself.
    """

    output: str
    cells: dict[_Position, CellNode]
    conditions: frozenset[str]


class _Break(NamedTuple):
    """A mirror symmetry of most pairs of a family, and its violations."""

    share: float
    name: str
    pairs: list[_Pair]


def broken_symmetries(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``broken-antisymmetry`` or ``broken-symmetry`` for each violating pair.

    Any monotone grid is nearly antisymmetric. Antisymmetry is intended if its inputs
    have terms of opposite sign; a fan that speeds up with temperature and humidity has no such
    symmetry.
    """
    for family in _families(subject):
        opposites = _opposites(subject.middles(family.output) or {})
        around = {name for name, _ in next(iter(family.cells))}
        # A grid may mirror itself, or its twin under the opposite condition: both are tried.
        mirrors = [
            _pairs(family, subject, fixed)
            for fixed in dict.fromkeys((frozenset[str](), family.conditions))
            if all(_has_opposites(name, subject) for name in around - fixed)
        ]
        breaks = [
            flaw
            for pairs in mirrors
            if opposites and len(pairs) >= _FEWEST_PAIRS
            for flaw in _breaks(pairs, opposites)
        ]
        best = min(breaks, key=lambda flaw: flaw.share, default=None)
        if best is not None and best.share <= 1.0 - ALMOST:
            for pair in best.pairs:
                first = _term(pair[0])
                expected = opposites[first][0] if best.name == "antisymmetric" else first
                yield _asymmetry(best.name, pair, expected)


def _has_opposites(name: str, subject: Subject) -> bool:
    """Whether an input lies about 0: its range, or without one its outermost terms."""
    variable = subject.rulebase.variable(name)
    low, high = variable.low, variable.high
    if not isfinite(high - low):
        middles = list((subject.middles(name) or {}).values())
        low, high = (middles[0], middles[-1]) if middles else (0.0, 0.0)
    return abs(low + high) <= OFF_CENTRE * (high - low)


def _opposites(middles: Mapping[str, float]) -> dict[str, tuple[str, ...]]:
    """Return the mirror images of each term: by distance from the middle, and by rank.

    The two differ where the terms lie unevenly, or one of them has no partner.
    """
    terms = list(middles)
    if len(terms) < 2:
        return {}
    low, high = middles[terms[0]], middles[terms[-1]]
    shares = {term: (x - low) / ((high - low) or 1.0) for term, x in middles.items()}
    by_share = {round(share, 9): term for term, share in shares.items()}
    return {
        term: (by_share.get(round(1.0 - shares[term], 9), partner), partner)
        for term, partner in zip(terms, reversed(terms), strict=True)
    }


def _breaks(pairs: list[_Pair], opposites: Mapping[str, tuple[str, ...]]) -> Iterator[_Break]:
    odd = [p for p in pairs if _term(p[1]) not in opposites[_term(p[0])]]
    even = [p for p in pairs if _term(p[0]) != _term(p[1])]
    yield _Break(len(odd) / len(pairs), "antisymmetric", odd)
    yield _Break(len(even) / len(pairs), "symmetric", even)


def _families(subject: Subject) -> Iterator[_Family]:
    """Yield the grids over two inputs, those with different conditions on the same variables."""
    families: dict[tuple[object, ...], _Family] = {}
    for grid in subject.grids:
        cells = _cells_by_rank(grid, subject)
        condition = _ranks_of_condition(grid, subject)
        if not cells or grid.row is None:
            continue
        variables = [(grid.row, grid.column)]
        if condition is None:  # hedges or alternatives: a family of its own
            key: tuple[object, ...] = (grid.output, *variables, str(grid.condition))
            condition = ()
        else:
            key = (grid.output, *variables, frozenset(name for name, _ in condition))
        names = frozenset(name for name, _ in condition)
        family = families.setdefault(key, _Family(grid.output, {}, names))
        for (row, column), cell in cells.items():
            position = ((grid.row, row), (grid.column, column), *condition)
            family.cells.setdefault(position, cell)
    yield from families.values()


def _ranks_of_condition(grid: GridNode, subject: Subject) -> _Position | None:
    """Return the propositions of ``when`` by rank, in the order of names; None if not plain."""
    condition = grid.condition
    if condition is None:
        return ()
    parts = condition.operands if isinstance(condition, JunctionNode) else (condition,)
    if isinstance(condition, JunctionNode) and condition.word != "and":
        return None
    ranks = []
    for part in parts:
        if not isinstance(part, PropositionNode) or part.hedges:
            return None
        order = subject.ranks(part.variable)
        if order is None:
            return None
        ranks.append((part.variable, order[part.term]))
    return tuple(sorted(ranks))


def _pairs(family: _Family, subject: Subject, fixed: frozenset[str]) -> list[_Pair]:
    """Return each cell with the one opposite; the `fixed` variables stay as they are.

    Pairs of the most frequent term are left out: they are symmetric in any grid.
    """
    last = {
        name: len(subject.rulebase.variable(name).terms) - 1
        for name, _ in next(iter(family.cells))
        if name not in fixed
    }
    counts = Counter(str(cell.term) for cell in family.cells.values() if cell.term is not None)
    common = max(counts, key=counts.__getitem__)
    if 2 * counts[common] <= len(family.cells):
        common = ""
    pairs = []
    for position, cell in family.cells.items():
        mirror = tuple(
            (name, last[name] - rank if name in last else rank) for name, rank in position
        )
        other = family.cells.get(mirror)
        # Each pair once; the middle cell is its own mirror and makes a pair with itself.
        if other is None or mirror < position:
            continue
        if not all(node.term and node.term == common for node in (cell, other)):
            pairs.append((cell, other))
    return pairs


def _term(cell: CellNode) -> str:
    return "." if cell.term is None else cell.term


def _asymmetry(what: str, pair: _Pair, expected: str) -> Diagnostic:
    name = f"broken-{what.replace('symmetric', 'symmetry')}"
    earlier, later = sorted(pair, key=lambda cell: cell.span)
    first, second = map(_term, pair)
    if earlier is later:
        return Diagnostic(
            name,
            f"the grid is otherwise {what}, but the middle cell '{first}' is not its own mirror",
            later.span,
        )
    return Diagnostic(
        name,
        f"the grid is otherwise {what}, but '{second}' does not mirror '{first}'",
        pair[1].span,
        hint=f"the mirror of '{first}' is '{expected}'; one of the two cells is a slip",
        related=(Related("the cell it mirrors", pair[0].span),),
    )


def _cells_by_rank(grid: GridNode, subject: Subject) -> dict[tuple[int, int], CellNode] | None:
    """Return the filled cells of a two-input grid by the ranks of row and column terms."""
    if grid.row is None:
        return None
    rows, columns = subject.ranks(grid.row), subject.ranks(grid.column)
    if rows is None or columns is None:
        return None
    return {
        (rows[row.label], columns[column]): cell
        for row in grid.rows
        for cell, column in zip(row.cells, grid.columns, strict=False)
        if cell.term is not None
    }


# --- Neighbouring grid cells whose terms lie far apart ---

MOST = 2
"""Terms by which a control surface may step from one cell to the next."""


def jumps(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``jump`` where a cell and its left or upper neighbour are too far apart."""
    for grid in subject.grids:
        cells = _cells_by_rank(grid, subject)
        order = subject.ranks(grid.output)
        if cells is None or order is None:
            continue
        for (row, column), cell in cells.items():
            for neighbour in ((row, column - 1), (row - 1, column)):
                if neighbour in cells:
                    yield from _pair(cell, cells[neighbour], order)


def _pair(cell: CellNode, other: CellNode, order: dict[str, int]) -> Iterator[Diagnostic]:
    if cell.term is None or other.term is None:
        return
    distance = abs(order[cell.term] - order[other.term])
    if distance > MOST:
        # The finding is at the later of the two cells.
        later, earlier = sorted((cell, other), key=lambda c: c.span, reverse=True)
        assert later.term is not None
        assert earlier.term is not None
        yield Diagnostic(
            "jump",
            f"'{later.term}' lies {distance} terms from its neighbour '{earlier.term}'",
            later.span,
            related=(Related("the neighbour", earlier.span),),
        )
