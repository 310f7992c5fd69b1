"""A whole rule base in the terminal: variables, terms, rules, settings."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING

from fuzzyarm.expression.kinds import SHAPES
from fuzzyarm.language.tokens import name_text
from fuzzyarm.model.rulebase import (
    And,
    Expression,
    Hedge,
    Hedged,
    Is,
    Or,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Variable,
)
from fuzzyarm.model.shapes import centre, corner_points, membership
from fuzzyarm.show.drawing import Cell, HeatGrid, Scale, block, scale_of
from fuzzyarm.text.numbers import number_text

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, Group, RenderableType
    from rich.text import Text


# --- Rules, shapes and numbers in the words of the language ---


def name_words(name: str) -> str:
    """Return `name` as it stands in a file."""
    return name_text(name)


def number_words(x: float, digits: int = 6) -> str:
    """Return `x` to at most `digits` significant digits, for reading."""
    rounded = float(f"{x:.{digits}g}") + 0.0
    return number_text(rounded)


def expression_words(expression: Expression) -> str:
    """Return an antecedent as it would be written."""
    if isinstance(expression, Is):
        hedges = hedge_words(expression.hedges)
        return f"{name_text(expression.variable)} is {hedges}{name_text(expression.term)}"
    if isinstance(expression, Hedged):
        return f"{hedge_words(expression.hedges)}({expression_words(expression.operand)})"
    word = " or " if isinstance(expression, Or) else " and "
    return word.join(_operand(operand, expression) for operand in expression.operands)


def _operand(operand: Expression, parent: Expression) -> str:
    text = expression_words(operand)
    if isinstance(operand, (Is, Hedged)) or (
        isinstance(parent, Or) and not isinstance(operand, Or)
    ):
        return text
    return f"({text})"


def hedge_words(hedges: tuple[Hedge, ...]) -> str:
    """Return hedges, each with a space behind it."""
    return "".join(
        f"{h.name}({number_text(h.exponent)}) " if h.exponent is not None else f"{h.name} "
        for h in hedges
    )


def rule_words(rule: Rule) -> str:
    """Return a rule as one ``if … then …`` sentence."""
    results = " and ".join(
        f"{name_text(c.variable)} is {hedge_words(c.hedges)}{name_text(c.term)}"
        for c in rule.consequents
    )
    weight = "" if rule.weight == 1.0 else f" with {number_text(rule.weight)}"
    return f"if {expression_words(rule.antecedent)} then {results}{weight}"


def consequent_words(rule: Rule, term: str) -> str:
    """Return the content of a grid cell: the term and the weight, if it is not 1."""
    return term if rule.weight == 1.0 else f"{term}*{number_text(rule.weight)}"


def shape_words(
    shape: Shape, rulebase: RuleBase | None = None, *, digits: int | None = None
) -> str:
    """Return a shape with its numbers, in full or to a few `digits` for reading."""
    if shape.kind == "formula":
        return f"formula {shape.formula}"
    if shape.kind == "linear":
        return _linear_words(shape, rulebase)
    spell = number_text if digits is None else partial(number_words, digits=digits)
    numbers = " ".join(spell(x) for x in shape.parameters)
    height = "" if shape.height == 1.0 else f" height {number_text(shape.height)}"
    return f"{shape.kind} {numbers}{height}"


def _linear_words(shape: Shape, rulebase: RuleBase | None) -> str:
    *factors, constant = shape.parameters
    names = (
        [v.name for v in rulebase.inputs] if rulebase else [f"x{k}" for k in range(len(factors))]
    )
    parts = [
        f"{number_text(factor)}*{name_text(name)}"
        for factor, name in zip(factors, names, strict=False)
        if factor
    ]
    if constant or not parts:
        parts.append(number_text(constant))
    return "linear " + " + ".join(parts)


# --- The terms of a variable as small plots of blocks: one line for each term ---

_WIDEST = 61


@dataclass(frozen=True)
class TermPlots:
    """The terms of one variable over its range.

    Attributes
    ----------
    variable : Variable
        Whose terms are drawn.
    rulebase : RuleBase or None
        Gives the names in ``linear`` consequents.
    at : float or None
        A crisp value to mark, with the membership of each term there.
    """

    variable: Variable
    rulebase: RuleBase | None = None
    at: float | None = None

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        from rich.text import Text

        yield Text(variable_words(self.variable), style="bold")
        names = [name_words(term.name) for term in self.variable.terms]
        words = [shape_words(term.shape, self.rulebase, digits=5) for term in self.variable.terms]
        if not names:
            return
        left = max(map(len, names))
        behind = max((len(text) for text in words if len(text) <= 30), default=0)
        room = options.max_width - left - 5 - behind - (7 if self.at is not None else 0)
        width = max(15, min(_WIDEST, room))
        width -= 1 - width % 2  # an odd number has a middle
        low, high = visible_range(self.variable)
        points = [low + (high - low) * i / (width - 1) for i in range(width)]
        drawn = False
        for name, term, shape in zip(names, self.variable.terms, words, strict=True):
            line = Text(f"  {name:<{left}} ", no_wrap=len(shape) <= 30, overflow="fold")
            if SHAPES[term.shape.kind].fuzzy:
                line.append(blocks(term.shape, points), "cyan")
                line.append(f" {shape}", "dim")
                drawn = True
            else:
                line.append(shape)
            if self.at is not None and SHAPES[term.shape.kind].fuzzy:
                line.append(f"  {membership(term.shape, self.at):.3f}", "bold")
            yield line
        if drawn:
            yield Text(f"  {'':<{left}} {ruler(low, high, width)}", "dim", no_wrap=True)


def variable_words(variable: Variable) -> str:
    """Return the name, the range and the description of a variable in one line."""
    span = f"{number_words(variable.low)} .. {number_words(variable.high)}"
    text = f"{name_words(variable.name)}  {span}"
    return f"{text}  {variable.description}" if variable.description else text


def visible_range(variable: Variable) -> tuple[float, float]:
    """Return the range to draw: that of the variable, or of its terms where it is unbounded."""
    corners = [x for term in variable.terms for x in corner_points(term.shape)]
    low = variable.low if math.isfinite(variable.low) else min(corners, default=-1.0)
    high = variable.high if math.isfinite(variable.high) else max(corners, default=1.0)
    return (low, high) if low < high else (low - 1.0, low + 1.0)


def blocks(shape: Shape, points: list[float]) -> str:
    """Return the membership at `points` in blocks of eight heights.

    A peak between two points shows on the nearer one.
    """
    degrees = [membership(shape, x) for x in points]
    if len(points) > 1:
        step = points[1] - points[0]
        for x in corner_points(shape):
            i = round((x - points[0]) / step)
            if 0 <= i < len(points) and points[0] <= x <= points[-1]:
                degrees[i] = max(degrees[i], membership(shape, x))
    return "".join(block(degree) for degree in degrees)


def ruler(low: float, high: float, width: int) -> str:
    """Return the ends and the middle of a range, spread over `width` characters."""
    left, middle, right = (number_words(x, 4) for x in (low, 0.5 * (low + high), high))
    line = [" "] * width
    line[: len(left)] = left
    line[width - len(right) :] = right
    start = width // 2 - len(middle) // 2
    if len(left) < start and start + len(middle) < width - len(right):
        line[start : start + len(middle)] = middle
    return "".join(line)


# --- The rules of a rule base as grids, whatever way they were written ---
#
# A rule that only joins propositions by `and` is a cell: its first two variables are row
# and column, the others say which grid it belongs to. Everything else is listed in words.


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
    for rule_block in rulebase.blocks:
        if len(rulebase.blocks) > 1:
            parts.append(Text(f"block {rule_block.name or '(unnamed)'}\n", style="bold"))
        grids, others = find_grids(rule_block)
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


# --- A whole rule base in the terminal: variables, terms, rules, settings ---


def rulebase_view(rulebase: RuleBase) -> Group:
    """Return everything about a rule base, top to bottom."""
    from rich.console import Group
    from rich.text import Text

    variables: tuple[Variable, ...] = (*rulebase.inputs, *rulebase.outputs)
    parts: list[RenderableType] = [heading(rulebase), Text()]
    for variable in variables:
        parts += [TermPlots(variable, rulebase), Text()]
    parts += [rules_view(rulebase), inference_text(rulebase)]
    return Group(*parts)


def heading(rulebase: RuleBase) -> Text:
    """Return the name, the description and the size of a rule base."""
    from rich.text import Text

    text = Text(rulebase.name, "bold")
    if rulebase.description:
        text.append(f"  {rulebase.description}", "not bold")
    counts = (len(rulebase.inputs), len(rulebase.outputs), len(rulebase.rules))
    words = zip(counts, ("input", "output", "rule"), strict=True)
    sizes = ", ".join(f"{count} {word}{'s' if count != 1 else ''}" for count, word in words)
    text.append(f"\n{sizes}", "dim")
    return text


def inference_text(rulebase: RuleBase) -> Text:
    """Return how the rules are evaluated, in words."""
    from rich.text import Text

    lines = []
    for rule_block in rulebase.blocks:
        name = f"block {name_words(rule_block.name)}: " if rule_block.name else ""
        lines.append(
            f"{name}and {rule_block.conjunction}, or {rule_block.disjunction}, "
            f"implication {rule_block.implication}"
        )
    lines += [f"{name_words(o.name)}: {output_words(o)}" for o in rulebase.outputs]
    return Text("\n".join(dict.fromkeys(lines)), "dim")


def output_words(output: Output) -> str:
    """Return the aggregation, the defuzzifier and the value without rules of an output."""
    way = output.defuzzifier
    samples = f"({way.resolution}, {way.sampling})" if way.resolution else ""
    exact = " exact" if way.resolution is None and way.method == "centroid" else ""
    default = output.no_rule if isinstance(output.no_rule, str) else number_words(output.no_rule)
    return f"aggregation {output.aggregation}, {way.method}{samples}{exact}, no-rule {default}"
