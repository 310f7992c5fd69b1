"""A whole rule base in the terminal: variables, terms, rules, settings."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from fuzzyarm.apps.show.drawing import Cell, HeatGrid, Scale, number_words, scale_of
from fuzzyarm.apps.show.terms import TermPlots
from fuzzyarm.base.diagnostic import Span
from fuzzyarm.base.numbers import counted, number_text
from fuzzyarm.language.edit.hover import rule_sentence
from fuzzyarm.language.model.rulebase import (
    And,
    AnyRuleBase,
    Expression,
    Is,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    model_of,
)
from fuzzyarm.language.model.shapes import centre
from fuzzyarm.language.tokens import name_text
from fuzzyarm.language.writer import rule_node

if TYPE_CHECKING:
    from rich.console import Group, RenderableType
    from rich.text import Text


def rulebase_view(rulebase: AnyRuleBase) -> Group:
    """Return a view of a whole rule base, top to bottom.

    Parameters
    ----------
    rulebase : RuleBase
        The rule base, perhaps an unfinished one.
    """
    rulebase = model_of(rulebase)
    from rich.console import Group
    from rich.text import Text

    parts: list[RenderableType] = [heading_view(rulebase), Text()]
    for variable in (*rulebase.inputs, *rulebase.outputs):
        parts += [TermPlots(variable, rulebase), Text()]
    return Group(*parts, rules_view(rulebase), inference_view(rulebase))


def heading_view(rulebase: RuleBase) -> Text:
    """Return name, description and size."""
    from rich.text import Text

    text = Text(rulebase.name, "bold")
    if rulebase.description:
        text.append(f"  {rulebase.description}", "not bold")
    counts = (len(rulebase.inputs), len(rulebase.outputs), len(rulebase.rules))
    words = zip(counts, ("input", "output", "rule"), strict=True)
    sizes = ", ".join(counted(count, word) for count, word in words)
    text.append(f"\n{sizes}", "dim")
    return text


def inference_view(rulebase: RuleBase) -> Text:
    """Return the inference methods."""
    from rich.text import Text

    lines = []
    for block in rulebase.blocks:
        name = f"block {name_text(block.name)}: " if block.name else ""
        lines.append(f"{name}{norm_words(block)}")
    for output in rulebase.outputs:
        absent = output.no_rule
        value = absent if isinstance(absent, str) else number_words(absent)
        way = f"aggregation {output.aggregation}, {output.defuzzifier}, no-rule {value}"
        lines.append(f"{name_text(output.name)}: {way}")
    return Text("\n".join(dict.fromkeys(lines)), "dim")


def norm_words(block: RuleBlock) -> str:
    """Return the norms of a block, and the strength from which a rule counts."""
    words = f"and {block.conjunction}, or {block.disjunction}, implication {block.implication}"
    return f"{words}, threshold {number_text(block.threshold)}" if block.threshold else words


def expression_words(expression: Expression) -> str:
    """Return an antecedent in language syntax."""
    return str(rule_node(Rule(expression, ())).antecedent)


# --- Rules as grids, in whatever form they were written ---
#
# A rule that joins propositions by `and` alone is a cell: its first two variables are row and
# column, the others select the grid. All other rules are listed in words.


@dataclass(slots=True)
class RuleGrid:
    """The rules for one output with the same row variable, column variable and conditions.

    Attributes
    ----------
    output : str
        The output variable.
    row, column : str
        The variables of the antecedents; `row` is empty for rules on one input.
    when : tuple of Is
        The other propositions of the antecedents.
    cells : dict
        (row term, column term) → the rules of that cell, each with its concluded term.
    """

    output: str
    row: str
    column: str
    when: tuple[Is, ...] = ()
    cells: dict[tuple[str, str], list[tuple[Rule, str]]] = field(default_factory=dict)

    @property
    def title(self) -> str:
        """Output and conditions of the rules."""
        conditions = " and ".join(expression_words(part) for part in self.when)
        return f"rules {name_text(self.output)}{f' when {conditions}' if conditions else ''}"


def find_grids(block: RuleBlock) -> tuple[list[RuleGrid], list[Rule]]:
    """Return the grids of a block in the order of their first rules, and the other rules.

    Parameters
    ----------
    block : RuleBlock
        Its rules may have any form.
    """
    grids: dict[tuple[object, ...], RuleGrid] = {}
    others: list[Rule] = []
    for rule in block.rules:
        parts = _conjunction(rule)
        if parts is None:
            others.append(rule)
            continue
        # A single proposition is a column; of several the first is the row, the second the column.
        row = (parts[0].variable, parts[0].term) if len(parts) > 1 else ("", "")
        column, when = parts[min(1, len(parts) - 1)], parts[2:]
        for consequent in rule.consequents:
            names = consequent.variable, row[0], column.variable
            grid = grids.setdefault((*names, frozenset(when)), RuleGrid(*names, when))
            grid.cells.setdefault((row[1], column.term), []).append((rule, consequent.term))
    # A grid with very few cells is dissolved into the other rules.
    rule_grids = [grid for grid in grids.values() if len(grid.cells) >= (4 if grid.row else 3)]
    loose = {id(rule) for rule in others}
    for grid in grids.values():
        if grid not in rule_grids:
            loose |= {id(rule) for cell in grid.cells.values() for rule, _ in cell}
    return rule_grids, [rule for rule in block.rules if id(rule) in loose]


def _conjunction(rule: Rule) -> tuple[Is, ...] | None:
    """Return the propositions of a rule, if it fits a grid."""
    antecedent = rule.antecedent
    operands = antecedent.operands if isinstance(antecedent, And) else (antecedent,)
    parts = tuple(part for part in operands if isinstance(part, Is) and not part.hedges)
    hedged = any(consequent.hedges for consequent in rule.consequents)
    different = len({part.variable for part in parts}) == len(operands)
    return parts if different and not hedged else None


def rules_view(
    rulebase: RuleBase,
    strengths: Mapping[Span, float] | None = None,
    chosen: Callable[[RuleGrid], tuple[str, str]] | None = None,
) -> Group:
    """Return every rule of `rulebase`: grids first, then the others.

    Parameters
    ----------
    rulebase : RuleBase
        The rule base to draw.
    strengths : mapping of Span to float, optional
        Firing strengths by position; these rules are marked.
    chosen : callable, optional
        From a grid to the row and column of its highlighted cell.
    """
    from rich.console import Group
    from rich.text import Text

    parts: list[RenderableType] = []
    for block in rulebase.blocks:
        if len(rulebase.blocks) > 1 and strengths is None:
            parts.append(Text(f"block {block.name or '(unnamed)'}\n", style="bold"))
        grids, others = find_grids(block)
        for grid in grids:
            cell = chosen(grid) if chosen is not None else None
            heat_grid = rule_grid(grid, rulebase, strengths or {}, cell)
            parts += [Text(grid.title, style="bold"), heat_grid, Text()]
        if strengths is None:
            parts += [Text(rule_sentence(rule)) for rule in others]
            parts += [Text()] if others else []
            continue
        for rule in others:
            strength = strengths.get(rule.span, 0.0)
            style = "bold" if strength else "dim"
            parts.append(Text(f"{strength:.2f}  {rule_sentence(rule)}", style))
    return Group(*parts)


def rule_grid(
    grid: RuleGrid,
    rulebase: RuleBase,
    strengths: Mapping[Span, float] | None = None,
    chosen: tuple[str, str] | None = None,
) -> HeatGrid:
    """Return `grid` as rows and columns of terms, coloured by the middle of each term.

    A dot is a missing rule, ``*0.5`` a weight; ``/`` separates contradicting rules.
    `strengths` and `chosen` as for :func:`rules_view`.

    Parameters
    ----------
    grid : RuleGrid
        Rules with the same row, column and conditions.
    rulebase : RuleBase
        Their rule base.
    strengths : mapping of Span to float, optional
        Firing strengths.
    chosen : tuple of (str, str), optional
        Row and column of the highlighted cell.
    """
    columns = _terms(rulebase, grid.column, [column for _, column in grid.cells])
    rows = _terms(rulebase, grid.row, [row for row, _ in grid.cells]) if grid.row else [""]
    scale, values = _term_colours(rulebase.output(grid.output))

    def cell(row: str, column: str) -> Cell:
        rules = grid.cells.get((row, column))
        if not rules:
            text, style = ".", "dim"
        else:
            text = "/".join(dict.fromkeys(_weighted(rule, term) for rule, term in rules))
            value = values.get(rules[0][1])
            style = "" if value is None else scale.style(value)
            if strengths and any(strengths.get(rule.span, 0.0) > 0 for rule, _ in rules):
                style = f"bold underline {style}"
        return text, "bold black on yellow" if (row, column) == chosen else style

    cells = [[cell(row, column) for column in columns] for row in rows]
    corner = f"{grid.row} \\ {grid.column}" if grid.row else grid.column
    return HeatGrid(corner, columns, rows if grid.row else [grid.output], cells)


def _weighted(rule: Rule, term: str) -> str:
    return term if rule.weight == 1.0 else f"{term}*{number_text(rule.weight)}"


def _term_colours(output: Output) -> tuple[Scale, dict[str, float]]:
    """Return a scale, and the position on it of each term of `output` with a middle."""
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
    terms = rulebase.variable(name).terms
    return [term.name for term in terms if term.name in used or len(terms) < 30]
