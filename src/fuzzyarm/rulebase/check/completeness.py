"""Rules that are missing: combinations of terms for which an output has no rule."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, islice, product
from math import prod

from fuzzyarm.rulebase.check.subject import Subject
from fuzzyarm.rulebase.diagnostic import Diagnostic
from fuzzyarm.rulebase.model import And, Is, Output, Rule
from fuzzyarm.rulebase.printing.expressions import expression_text
from fuzzyarm.rulebase.syntax.nodes import GridNode

_MOST_COMBINATIONS = 50_000
_MOST_NAMED = 5


def find(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``missing-rule``: empty cells, absent rows and columns, uncovered combinations."""
    for grid in subject.grids:
        yield from _grid(grid, subject)
    with_grid = {grid.output.text for grid in subject.grids}
    for output in subject.rulebase.outputs:
        if output.name not in with_grid:
            yield from _combinations(output, subject)


def _grid(grid: GridNode, subject: Subject) -> Iterator[Diagnostic]:
    labels = [("column", grid.column, grid.columns)]
    if grid.row is not None:
        labels.append(("row", grid.row, tuple(row.label for row in grid.rows)))
    covered = _covered_elsewhere(grid, subject)
    for what, variable, words in labels:
        present = {word.text for word in words}
        terms = subject.rulebase.variable(variable.text).terms
        absent = [term.name for term in terms if term.name not in present]
        if absent and not covered:
            many = "s" if len(absent) > 1 else ""
            yield Diagnostic(
                "missing-rule",
                f"the grid for '{grid.output.text}' has no {what}{many}"
                f" for {variable.text} is {', '.join(absent)}",
                grid.header_span,
            )
    for row in grid.rows:
        for cell, column in zip(row.cells, grid.columns, strict=False):
            if cell.term is None and not covered:
                where = f"{grid.column.text} is {column.text}"
                if grid.row is not None:
                    where = f"{grid.row.text} is {row.label.text} and {where}"
                yield Diagnostic("missing-rule", f"no rule for {where}", cell.span)


def _covered_elsewhere(grid: GridNode, subject: Subject) -> bool:
    """Whether another grid or rule for the same output may fill the empty cells."""
    others = [g for g in subject.grids if g is not grid and g.output.text == grid.output.text]
    condition = _condition(grid)
    if any(_condition(other) == condition for other in others):
        return True
    return any(
        not rule.in_grid and any(c.variable == grid.output.text for c in rule.consequents)
        for rule in subject.rulebase.rules
    )


def _condition(grid: GridNode) -> str:
    return expression_text(grid.condition) if grid.condition else ""


def _combinations(output: Output, subject: Subject) -> Iterator[Diagnostic]:
    """Report combinations of terms that no rule of plain propositions covers."""
    rules = [
        rule
        for rule in subject.rulebase.rules
        if any(c.variable == output.name for c in rule.consequents)
    ]
    if not rules or not all(map(_is_plain, rules)):
        return  # hedges and alternatives are judged by no-rule-fires, with numbers
    used = {p.variable for rule in rules for p in _propositions(rule)}
    variables = [v for v in subject.rulebase.inputs if v.name in used]
    count = prod(len(v.terms) for v in variables)
    if len(used) != len(variables) or not 0 < count <= _MOST_COMBINATIONS:
        return
    wanted = {frozenset((p.variable, p.term) for p in _propositions(rule)) for rule in rules}
    sizes = {len(key) for key in wanted}
    choices = [[(v.name, term.name) for term in v.terms] for v in variables]
    missing = (
        combination for combination in product(*choices) if not _matches(combination, wanted, sizes)
    )
    named = list(islice(missing, _MOST_NAMED + 1))
    if not named:
        return
    shown = "; ".join(
        " and ".join(f"{variable} is {term}" for variable, term in combination)
        for combination in named[:_MOST_NAMED]
    )
    more = " and more" if len(named) > _MOST_NAMED else ""
    yield Diagnostic(
        "missing-rule", f"no rule for '{output.name}' covers {shown}{more}", rules[0].span
    )


def _matches(
    combination: tuple[tuple[str, str], ...],
    wanted: set[frozenset[tuple[str, str]]],
    sizes: set[int],
) -> bool:
    return any(
        frozenset(part) in wanted for size in sizes for part in combinations(combination, size)
    )


def _is_plain(rule: Rule) -> bool:
    parts = _operands(rule)
    return all(isinstance(part, Is) and not part.hedges for part in parts)


def _operands(rule: Rule) -> tuple[object, ...]:
    return rule.antecedent.operands if isinstance(rule.antecedent, And) else (rule.antecedent,)


def _propositions(rule: Rule) -> list[Is]:
    return [part for part in _operands(rule) if isinstance(part, Is)]
