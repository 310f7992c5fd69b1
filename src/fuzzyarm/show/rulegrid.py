r"""The rules of a rule base as grids, whatever way they were written.

A rule that only joins propositions by ``and`` is a cell: its first two variables are row
and column, the others say which grid it belongs to. Everything else is listed in words.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from fuzzyarm.rulebase.geometry import centre
from fuzzyarm.rulebase.model import And, Is, Output, Rule, RuleBase, RuleBlock, Variable
from fuzzyarm.show.heat import Cell, HeatGrid
from fuzzyarm.show.scale import Scale, scale_of
from fuzzyarm.show.words import consequent_words, expression_words, name_words, rule_words

if TYPE_CHECKING:
    from rich.console import Group, RenderableType


@dataclass(slots=True)
class RuleGrid:
    """The rules for one output that share the row and column variables and the conditions.

    Attributes
    ----------
    output : str
        The output variable.
    row, column : str
        The variables of the antecedents; `row` is empty for rules on one input.
    when : tuple of Is
        What the other propositions of the antecedents are.
    cells : dict
        (row term, column term) → the rules of that cell with the place of their consequent.
    """

    output: str
    row: str
    column: str
    when: tuple[Is, ...] = ()
    cells: dict[tuple[str, str], list[tuple[Rule, str]]] = field(default_factory=dict)


def find_grids(block: RuleBlock) -> tuple[list[RuleGrid], list[Rule]]:
    """Return the grids of a block in the order of their first rules, and the other rules."""
    grids: dict[tuple[object, ...], RuleGrid] = {}
    others: list[Rule] = []
    for rule in block.rules:
        place = _place(rule)
        if place is None:
            others.append(rule)
            continue
        row, column, when = place
        for consequent in rule.consequents:
            row_name = row.variable if row else ""
            key = (consequent.variable, row_name, column.variable, frozenset(when))
            grid = grids.setdefault(
                key, RuleGrid(consequent.variable, row_name, column.variable, when)
            )
            cell = grid.cells.setdefault((row.term if row else "", column.term), [])
            cell.append((rule, consequent.term))
    return _worth_drawing(list(grids.values()), others, block)


def _worth_drawing(
    grids: list[RuleGrid], others: list[Rule], block: RuleBlock
) -> tuple[list[RuleGrid], list[Rule]]:
    """Give up grids with very few cells; their rules go to the others."""
    kept = [grid for grid in grids if len(grid.cells) >= (4 if grid.row else 3)]
    given_up = [grid for grid in grids if grid not in kept]
    loose = {id(rule) for rule in others}
    loose |= {id(rule) for grid in given_up for cell in grid.cells.values() for rule, _ in cell}
    listed = [rule for rule in block.rules if id(rule) in loose]
    return kept, listed


def _place(rule: Rule) -> tuple[Is | None, Is, tuple[Is, ...]] | None:
    if any(consequent.hedges for consequent in rule.consequents):
        return None
    antecedent = rule.antecedent
    operands = antecedent.operands if isinstance(antecedent, And) else (antecedent,)
    parts: list[Is] = []
    for operand in operands:
        if not isinstance(operand, Is) or operand.hedges:
            return None
        parts.append(operand)
    if len({part.variable for part in parts}) < len(parts):
        return None
    if len(parts) == 1:
        return None, parts[0], ()
    return parts[0], parts[1], tuple(parts[2:])


def rules_view(rulebase: RuleBase) -> Group:
    """Return every rule of `rulebase`: grids first, then what fits no grid."""
    from rich.console import Group
    from rich.text import Text

    parts: list[RenderableType] = []
    for block in rulebase.blocks:
        if len(rulebase.blocks) > 1:
            parts.append(Text(f"block {block.name or '(unnamed)'}\n", style="bold"))
        grids, others = find_grids(block)
        for grid in grids:
            parts += [Text(grid_title(grid), style="bold"), rule_grid(grid, rulebase), Text()]
        parts += [Text(rule_words(rule)) for rule in others]
        if others:
            parts.append(Text())
    return Group(*parts)


def grid_title(grid: RuleGrid) -> str:
    """Return what the rules of `grid` are for and when they hold."""
    title = f"rules {name_words(grid.output)}"
    conditions = " and ".join(expression_words(part) for part in grid.when)
    return f"{title} when {conditions}" if conditions else title


def rule_grid(grid: RuleGrid, rulebase: RuleBase) -> HeatGrid:
    """Return `grid` as rows and columns of terms, coloured by the middle of each term.

    A dot is a missing rule, ``*0.5`` a weight, ``/`` stands between contradicting rules.
    """
    output = rulebase.output(grid.output)
    columns = _terms(rulebase, grid.column, [column for _, column in grid.cells])
    rows = _terms(rulebase, grid.row, [row for row, _ in grid.cells]) if grid.row else [""]
    scale, values = term_colours(output)
    cells = [[_cell(grid.cells.get((row, column), []), scale, values) for column in columns]
             for row in rows]  # fmt: skip
    corner = f"{grid.row} \\ {grid.column}" if grid.row else grid.column
    labels = rows if grid.row else [grid.output]
    return HeatGrid(corner, columns, labels, cells)


def term_colours(output: Output) -> tuple[Scale, dict[str, float]]:
    """Return a scale and the number that stands for each term of `output` on it.

    Terms without a middle (functions of the inputs) take no colour.
    """
    values: dict[str, float] = {}
    for term in output.terms:
        shape = term.shape
        if shape.kind == "linear":
            if not any(shape.parameters[:-1]):
                values[term.name] = shape.parameters[-1]
            continue
        middle = centre(shape, output.low, output.high)
        if middle is not None:
            values[term.name] = middle
    return scale_of(values.values()), values


def _terms(rulebase: RuleBase, name: str, used: Sequence[str]) -> list[str]:
    variable: Variable = rulebase.variable(name)
    return [term.name for term in variable.terms if term.name in used or len(variable.terms) < 30]


def _cell(rules: list[tuple[Rule, str]], scale: Scale, values: dict[str, float]) -> Cell:
    if not rules:
        return ".", "dim"
    text = "/".join(dict.fromkeys(consequent_words(rule, term) for rule, term in rules))
    value = values.get(rules[0][1])
    return text, "" if value is None else scale.style(value)
