"""Find the grids in a flat list of rules, without changing their order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from fuzzyarm.rulebase.model import And, Expression, Is, Rule, RuleBase

_FEWEST = 4


@dataclass(slots=True)
class GridRun:
    """Consecutive rules that fill a grid row by row.

    `rest` is what the antecedents have in common beyond row and column (``when …``).
    """

    output: str
    row: str
    column: str
    rest: tuple[Expression, ...]
    rows: list[str] = field(default_factory=list)
    columns: list[str] = field(default_factory=list)
    cells: dict[tuple[str, str], Rule] = field(default_factory=dict)
    rules: list[Rule] = field(default_factory=list)
    last: tuple[int, int] = (-1, -1)


def split_into_grids(rules: Sequence[Rule], rulebase: RuleBase) -> list[Rule | GridRun]:
    """Return `rules` in order, with each run that reads back from a grid as a GridRun."""
    order = {
        (variable.name, term.name): i
        for variable in (*rulebase.inputs, *rulebase.outputs)
        for i, term in enumerate(variable.terms)
    }
    pieces: list[Rule | GridRun] = []
    run: GridRun | None = None
    for rule in rules:
        cell = _as_cell(rule)
        if run is not None and cell is not None and _fits(run, rule, cell, order):
            _add(run, rule, cell, order)
            continue
        if run is not None:
            pieces += _finished(run, order)
            run = None
        if cell is None:
            pieces.append(rule)
        else:
            row, column, rest = cell
            run = GridRun(rule.consequents[0].variable, row.variable, column.variable, rest)
            _add(run, rule, cell, order)
    if run is not None:
        pieces += _finished(run, order)
    return pieces


_Cell = tuple[Is, Is, tuple[Expression, ...]]


def _as_cell(rule: Rule) -> _Cell | None:
    antecedent = rule.antecedent
    if not isinstance(antecedent, And) or len(rule.consequents) != 1:
        return None
    if rule.consequents[0].hedges or len(antecedent.operands) < 2:
        return None
    row, column, *rest = antecedent.operands
    if not isinstance(row, Is) or not isinstance(column, Is) or row.hedges or column.hedges:
        return None
    # One And as the only condition would be flattened on the way back.
    if row.variable == column.variable or (len(rest) == 1 and isinstance(rest[0], And)):
        return None
    return row, column, tuple(rest)


def _position(cell: _Cell, order: dict[tuple[str, str], int]) -> tuple[int, int]:
    row, column, _ = cell
    return order[row.variable, row.term], order[column.variable, column.term]


def _fits(run: GridRun, rule: Rule, cell: _Cell, order: dict[tuple[str, str], int]) -> bool:
    row, column, rest = cell
    return (
        rule.consequents[0].variable == run.output
        and (row.variable, column.variable, rest) == (run.row, run.column, run.rest)
        and _position(cell, order) > run.last
    )


def _add(run: GridRun, rule: Rule, cell: _Cell, order: dict[tuple[str, str], int]) -> None:
    row, column, _ = cell
    if row.term not in run.rows:
        run.rows.append(row.term)
    if column.term not in run.columns:
        run.columns.append(column.term)
    run.cells[row.term, column.term] = rule
    run.rules.append(rule)
    run.last = _position(cell, order)


def _finished(run: GridRun, order: dict[tuple[str, str], int]) -> list[Rule | GridRun]:
    if len(run.rules) < _FEWEST or 2 * len(run.rules) < len(run.rows) * len(run.columns):
        return list(run.rules)
    run.columns.sort(key=lambda term: order[run.column, term])
    return [run]
