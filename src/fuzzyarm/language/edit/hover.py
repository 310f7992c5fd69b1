"""The meaning of a word in Markdown, with a small drawing for a term."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

from fuzzyarm.base.diagnostic import Span
from fuzzyarm.base.names import printable
from fuzzyarm.base.numbers import counted, number_text
from fuzzyarm.language.check.coverage import gaps_of
from fuzzyarm.language.controllers import CONTROLLER_STATEMENTS, CONTROLLER_WORDS
from fuzzyarm.language.edit.completion import term_detail
from fuzzyarm.language.edit.reading import NOTHING, Facts, Reading, contains
from fuzzyarm.language.edit.references import occurrence_at, references
from fuzzyarm.language.model.rulebase import Input, Rule, Shape, Variable
from fuzzyarm.language.model.shapes import EVEN_SHAPES, corner_points, membership
from fuzzyarm.language.phrases import SETTINGS, NameKind, Occurrence, parameter_names
from fuzzyarm.language.rows import sentence
from fuzzyarm.language.rules import CellNode, GridNode
from fuzzyarm.language.statements import STATEMENTS, WORDS
from fuzzyarm.language.tokens import name_text
from fuzzyarm.language.writer import rule_node
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, HEDGES, SHAPES, SNORMS, TNORMS, Registry
from fuzzyarm.symbolic.sources import SOURCES

# --- A membership function as a small drawing in text, three lines high ---

_EIGHTHS = " ▁▂▃▄▅▆▇█"
WIDTH = 41
ROWS = 3


def picture(shape: Shape, variable: Variable) -> str:
    """Return `shape` over the range of `variable`, with the ends of the range below.

    Empty for the values of Takagi and Sugeno, which have no membership.
    """
    if not SHAPES[shape.kind].fuzzy:
        return ""
    low, high = _shown_range(variable)
    step = (high - low) / (WIDTH - 1)
    degrees = [_highest(shape, low + i * step, step) for i in range(WIDTH)]
    lines = []
    for row in range(ROWS - 1, -1, -1):
        levels = [min(8, max(0, round(8 * (ROWS * d - row)))) for d in degrees]
        lines.append("".join(_EIGHTHS[level] for level in levels).rstrip())
    left, right = f"{low:g}", f"{high:g}"
    middle = f"{0.5 * (low + high):g}"
    axis = left + middle.center(WIDTH - len(left) - len(right)) + right
    return "\n".join([*lines, "─" * WIDTH, axis])


def _highest(shape: Shape, x: float, step: float) -> float:
    # A peak between two columns must not be lost, and a singleton has no width at all.
    inside = [c for c in corner_points(shape) if abs(c - x) <= 0.5 * step]
    return max(membership(shape, position) for position in (x, *inside))


def _shown_range(variable: Variable) -> tuple[float, float]:
    """Return the range of `variable`; of an unbounded one the stretch of its terms."""
    xs = [x for term in variable.terms for x in corner_points(term.shape)]
    ends = [x for x in (variable.low, variable.high) if math.isfinite(x)]
    positions = [*xs, *ends] or [0.0]
    low = variable.low if math.isfinite(variable.low) else min(positions) - 1.0
    high = variable.high if math.isfinite(variable.high) else max(positions) + 1.0
    return (low, high) if low < high else (low, low + 1.0)


# --- Rules in words ---


def rule_sentence(rule: Rule) -> str:
    """Return a rule as one ``if … then …`` sentence, also from a grid."""
    return sentence(rule_node(rule))


# --- The meaning of a word, in Markdown ---

# The last two: GitHub's Markdown makes a link of a bare address, so it is broken up too.
_MARKDOWN = re.compile(r"[\\`*_\[\]<>&#|~!$]|:(?=//)|(?<=www)\.")


def plain(text: str) -> str:
    """Return a text of the file escaped for Markdown: no image, link or HTML."""
    return _MARKDOWN.sub(r"\\\g<0>", printable(text))


def code(text: str) -> str:
    """Return a text of the file as code in Markdown."""
    text = printable(text)
    fence = "`" * (1 + max(map(len, re.findall("`+", text)), default=0))
    space = " " if "`" in text else ""
    return f"{fence}{space}{text}{space}{fence}"


@dataclass(frozen=True, slots=True)
class Hover:
    """An explanation.

    Attributes
    ----------
    markdown : str
        Hover text.
    span : Span
        The text it is about.
    """

    markdown: str
    span: Span


def hover(reading: Reading, line: int, column: int, facts: Facts = NOTHING) -> Hover | None:
    """Return the hover text at a position; None without any."""
    cell = _cell_at(reading, line, column)
    if cell is not None:
        return _of_cell(reading, *cell)
    occurrence = occurrence_at(reading, line, column)
    if occurrence is not None:
        fact = facts.get((occurrence.kind, occurrence.name), "")
        text = "\n\n".join(filter(None, (_of_occurrence(reading, occurrence), plain(fact))))
        return Hover(text, occurrence.span) if text else None
    return _of_word(reading, line, column)


def _cell_at(reading: Reading, line: int, column: int) -> tuple[GridNode, int, CellNode] | None:
    for statement in reading.document.statements:
        for grid in statement.node.parts if isinstance(statement.node, GridNode) else ():
            for row in grid.rows:
                if row.label.span.line != line:
                    continue
                for index, cell in enumerate(row.cells):
                    if contains(cell.span, line, column):
                        return grid, index, cell
    return None


def _of_cell(reading: Reading, grid: GridNode, index: int, cell: CellNode) -> Hover:
    rule = next((r for r in reading.model.rules if r.span == cell.span), None)
    if rule is None:
        row = next(r for r in grid.rows if r.label.span.line == cell.span.line)
        where = f"{grid.column} is {grid.columns[index]}"
        if grid.row is not None:
            where = f"{grid.row} is {row.label} and {where}"
        what = "no rule for" if cell.term is None else "this cell cannot be read:"
        return Hover(f"{what} {plain(where)}", cell.span)
    return Hover(_rule_markdown(reading, rule), cell.span)


def _rule_markdown(reading: Reading, rule: Rule) -> str:
    parts = [f"**{plain(rule_sentence(rule))}**"]
    for consequent in rule.consequents:
        variable = reading.variable(consequent.variable)
        if variable is not None:
            parts.append(_term_markdown(variable, consequent.term))
    return "\n\n".join(parts)


def _of_occurrence(reading: Reading, occurrence: Occurrence) -> str:
    if occurrence.kind is NameKind.VARIABLE:
        variable = reading.variable(occurrence.name)
        return "" if variable is None else _variable_markdown(variable)
    if occurrence.kind is NameKind.TERM:
        parts = []
        for owner in occurrence.owners:
            variable = reading.variable(owner)
            if variable is not None and any(t.name == occurrence.name for t in variable.terms):
                parts.append(_term_markdown(variable, occurrence.name))
        uses = sum(not o.is_definition for o in references(reading, occurrence))
        if parts:
            parts.append(f"used {counted(uses, 'time')}")
        return "\n\n".join(parts)
    name = plain(occurrence.name)
    if occurrence.kind is NameKind.BLOCK:
        block = next((b for b in reading.model.blocks if b.name == occurrence.name), None)
        if block is None:
            return f"block **{name}**"
        return (
            f"block **{name}**: {len(block.rules)} rules, and {block.conjunction}, "
            f"or {block.disjunction}, implication {block.implication}"
        )
    if occurrence.kind is not NameKind.RULEBASE:
        return _of_line(reading, occurrence)
    model = reading.model
    sizes = f"{len(model.inputs)} inputs, {len(model.outputs)} outputs, {len(model.rules)} rules"
    return f"**{name}** {plain(model.description)}\n\n{sizes}".strip()


def _of_line(reading: Reading, occurrence: Occurrence) -> str:
    """Return the lines of a controller that define a name, and how often it is used."""
    occurrences = references(reading, occurrence)
    lines = [
        " ".join(reading.raw_line(use.span.line).split())
        for use in occurrences
        if use.is_definition
    ]
    if occurrence.kind is NameKind.PLANT:
        return f"the plant {code(occurrence.name)}"
    if occurrence.kind in (NameKind.PORT, NameKind.STATE, NameKind.PARAMETER):
        return f"{occurrence.kind} {code(occurrence.name)} of the plant"
    uses = sum(not use.is_definition for use in occurrences)
    return "\n\n".join([*map(code, lines), f"used {counted(uses, 'time')}"])


def _term_markdown(variable: Variable, name: str) -> str:
    term = variable.term(name)
    shape = term.shape
    numbers = term_detail(variable, name)
    if shape.kind == "formula":
        numbers = f'formula "{shape.formula}"'
    height = f" height {number_text(shape.height)}"
    if shape.height == 1.0 or term.lower is not None:  # with two shapes it is among the numbers
        height = ""
    text = f"{code(name_text(name))} of {code(name_text(variable.name))}: {code(numbers + height)}"
    names = parameter_names(shape.kind)
    if names and len(names) == len(shape.parameters):
        pairs = zip(names, shape.parameters, strict=True)
        text += "  \n" + ", ".join(f"{key.replace('_', ' ')} {x:.6g}" for key, x in pairs)
    drawing = picture(shape, variable)
    if drawing and term.lower is not None:
        drawing += f"\nover\n{picture(term.lower, variable)}"
    return f"{text}\n\n```text\n{drawing}\n```" if drawing else text


def _variable_markdown(variable: Variable) -> str:
    role = "input" if isinstance(variable, Input) else "output"
    low, high = number_text(variable.low), number_text(variable.high)
    lines = [f"{role} **{plain(variable.name)}** `{low} .. {high}`"]
    if variable.description:
        lines[0] += f" {plain(variable.description)}"
    names = ", ".join(plain(term.name) for term in variable.terms)
    lines.append(f"terms: {names}" if names else "no terms yet")
    if isinstance(variable, Input) and variable.terms:
        gaps = [finding.message for finding in gaps_of(variable)]
        lines.append("; ".join(map(plain, gaps)) if gaps else "every value is covered by a term")
    lines.append(f"outside the range: {variable.outside}")
    return "\n\n".join(lines)


def _of_word(reading: Reading, line: int, column: int) -> Hover | None:
    token = reading.token_at(line, column)
    if token is None or token.kind != "name":
        return None
    text = token.text
    words = _help(text, first=reading.tokens_of(line)[0] is token)
    return Hover(f"**{text}**: {words}", token.span) if words else None


def _help(text: str, *, first: bool) -> str:
    """Return the help of a word of the language; empty if it is obvious."""
    if first and text in STATEMENTS:
        return STATEMENTS[text].doc
    if first and text in CONTROLLER_STATEMENTS:
        return CONTROLLER_STATEMENTS[text].doc
    if text in SHAPES.words:
        numbers = " ".join(parameter_names(text))
        return f"`{text} {numbers}`  \n{SHAPES[text].doc}" if numbers else SHAPES[text].doc
    if text in HEDGES.words:
        return f"hedge: {HEDGES[HEDGES.words[text]].doc}"
    if text in EVEN_SHAPES:
        return f"evenly spread terms: {EVEN_SHAPES[text]}"
    kinds = [f"{sort}: {kinds[text].doc}" for sort, kinds in _SORTS if text in kinds.words]
    setting = SETTINGS[text].doc if text in SETTINGS else ""
    setting = setting or (SOURCES[text].doc if text in SOURCES else "")
    return setting or WORDS.get(text, "") or CONTROLLER_WORDS.get(text, "") or "; ".join(kinds)


_SORTS: tuple[tuple[str, Registry[Any]], ...] = (
    ("T-norm", TNORMS), ("S-norm", SNORMS), ("defuzzifier", DEFUZZIFIERS),
)  # fmt: skip
