"""Print a syntax tree in canonical form, comments kept.

From words and numbers over expressions and grids to whole documents.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from fuzzyarm.language.nodes import (
    BlockNode,
    CellNode,
    Document,
    EvenTermsNode,
    ExpectNode,
    ExpressionNode,
    Figure,
    GridNode,
    Heading,
    HedgedNode,
    HedgeNode,
    InferenceNode,
    JunctionNode,
    LinearPart,
    LookupItem,
    LookupNode,
    OutcomeNode,
    PropositionNode,
    RuleNode,
    SettingNode,
    ShapeNode,
    Statement,
    StatementNode,
    TermNode,
    Trivia,
    VariableNode,
    Word,
)
from fuzzyarm.language.tokens import QUOTED
from fuzzyarm.text.diagnostic import display_width
from fuzzyarm.text.names import is_plain_name, quote
from fuzzyarm.text.numbers import number_text

# --- Names, numbers and strings ---


def name_text(name: str) -> str:
    """Return a name as it stands in a file, in single quotes where it must."""
    return name if is_plain_name(name) and name not in QUOTED else quote(name, "'")


def word_text(word: Word) -> str:
    """Return the name of `word` as it stands in a file."""
    return name_text(word.text)


def figure_text(figure: Figure) -> str:
    """Return a number as it stands in a file."""
    return number_text(figure.value)


def string_text(text: str) -> str:
    """Return a description in double quotes."""
    return quote(text, '"')


def hedges_text(hedges: tuple[HedgeNode, ...]) -> str:
    """Return hedges with a space behind each."""
    out = ""
    for hedge in hedges:
        exponent = f"({figure_text(hedge.exponent)})" if hedge.exponent else ""
        out += f"{hedge.word.text}{exponent} "
    return out


# --- Antecedents and consequents, with parentheses only where the tree needs them ---


def proposition_text(node: PropositionNode) -> str:
    """Return ``variable is [hedges] term``."""
    return f"{word_text(node.variable)} is {hedges_text(node.hedges)}{word_text(node.term)}"


def expression_text(node: ExpressionNode) -> str:
    """Return the text of an antecedent that reads back to the same tree."""
    if isinstance(node, PropositionNode):
        return proposition_text(node)
    if isinstance(node, HedgedNode):
        return f"{hedges_text(node.hedges)}({expression_text(node.operand)})"
    return f" {node.word} ".join(_operand(operand, node) for operand in node.operands)


def _operand(operand: ExpressionNode, parent: JunctionNode) -> str:
    text = expression_text(operand)
    if isinstance(operand, JunctionNode) and not (parent.word == "or" and operand.word == "and"):
        return f"({text})"
    return text


# --- Grids, their columns aligned in characters as a terminal shows them ---


def grid_lines(node: GridNode) -> tuple[str, list[str]]:
    """Return the first line of a grid and the aligned lines below it, header included."""
    first = f"rules {word_text(node.output)}"
    if node.condition is not None:
        first += f" when {expression_text(node.condition)}"
    corner = word_text(node.column)
    if node.row is not None:
        corner = f"{word_text(node.row)} \\ {corner}"
    cells = [[corner, *map(word_text, node.columns)]]
    cells += [[word_text(row.label), *map(_cell, row.cells)] for row in node.rows]
    return first, aligned(cells)


def _cell(cell: CellNode) -> str:
    if cell.term is None:
        return "."
    weight = f"*{figure_text(cell.weight)}" if cell.weight else ""
    return word_text(cell.term) + weight


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Return `rows` as lines indented by two, columns two spaces apart and left-aligned."""
    widths = [0] * max(map(len, rows), default=0)
    for row in rows:
        for i, text in enumerate(row):
            widths[i] = max(widths[i], display_width(text))
    return [
        "  " + "  ".join(pad(text, widths[i]) for i, text in enumerate(row)).rstrip()
        for row in rows
    ]


def pad(text: str, width: int) -> str:
    """Return `text` with spaces behind it up to `width` terminal columns."""
    return text + " " * (width - display_width(text))


# --- Statements and documents ---

WIDTH = 100
"""A rule longer than this is broken before its connectives."""


def print_document(document: Document) -> str:
    """Return the canonical text of `document`, which must be free of broken statements.

    Neighbouring variables and neighbouring terms are aligned; a grid has blank lines
    around it; never more than one blank line stands in a row.
    """
    lines: list[str] = []
    previous: StatementNode | None = None
    runs = _aligned_runs(document)
    for index, statement in enumerate(document.statements):
        node = statement.node
        before = list(statement.trivia.before)
        if previous is not None and _wants_distance(previous, node) and "" not in before:
            before.insert(0, "")
        lines += before
        first, below = (runs[index], []) if index in runs else _statement_lines(node)
        lines.append(with_comment(first, statement.trivia.behind))
        lines += below
        previous = node
    lines += document.ending
    return "\n".join(_without_double_blanks(lines)) + "\n" if lines else ""


def _wants_distance(previous: StatementNode, node: StatementNode) -> bool:
    blocks = (GridNode, LookupNode)
    return isinstance(previous, blocks) or isinstance(node, (*blocks, BlockNode))


def _without_double_blanks(lines: list[str]) -> list[str]:
    out: list[str] = []
    for line in lines:
        if line or (out and out[-1]):
            out.append(line)
    while out and not out[-1]:
        out.pop()
    return out


def with_comment(line: str, comment: str) -> str:
    """Return `line` with its comment behind it."""
    return f"{line}  {comment}" if comment else line


def _aligned_runs(document: Document) -> dict[int, str]:
    """Return the lines of variables and terms by statement; neighbours of a kind are aligned."""
    lines: dict[int, str] = {}
    run: list[int] = []
    statements = document.statements
    for index, statement in enumerate(statements):
        kind = type(statement.node)
        if run and (kind is not type(statements[run[-1]].node) or "" in statement.trivia.before):
            _align_run(run, statements, lines)
            run = []
        if kind in _PARTS:
            run.append(index)
    _align_run(run, statements, lines)
    return lines


def _align_run(run: list[int], statements: tuple[Statement, ...], lines: dict[int, str]) -> None:
    parts = [_PARTS[type(statements[index].node)](statements[index].node) for index in run]
    for index, line in zip(run, aligned(parts), strict=True):
        lines[index] = line.strip()


def _statement_lines(node: StatementNode) -> tuple[str, list[str]]:
    if isinstance(node, GridNode):
        return _grid(node)
    if isinstance(node, LookupNode):
        return _lookup(node)
    if isinstance(node, RuleNode):
        first, *rest = _rule(node)
        return first, rest
    return _PRINTERS[type(node)](node), []


def _variable_parts(node: VariableNode) -> list[str]:
    role = f"{node.role:<6}"
    assert node.low is not None, "a document with mistakes is never printed"
    assert node.high is not None
    range_text = f"{figure_text(node.low)} .. {figure_text(node.high)}"
    description = [] if node.description is None else [string_text(node.description)]
    return [f"{role} {word_text(node.name)}", range_text, *description]


def _term_parts(node: TermNode) -> list[str]:
    assert node.shape is not None, "a document with mistakes is never printed"
    return [
        f"term {word_text(node.variable)} {word_text(node.name)}:",
        shape_text(node.shape),
    ]


def shape_text(node: ShapeNode) -> str:
    """Return a shape as it stands in a file."""
    kind = node.kind.text
    if kind == "points":
        values = [figure_text(figure) for figure in node.figures]
        pairs = zip(values[0::2], values[1::2], strict=True)
        body = " ".join(f"({x}, {y})" for x, y in pairs)
    elif kind == "linear":
        body = _sum(node.parts)
    elif kind == "formula":
        body = string_text(node.formula)
    else:
        body = " ".join(map(figure_text, node.figures))
    height = f" height {figure_text(node.height)}" if node.height else ""
    return f"{kind} {body}{height}"


def _sum(parts: tuple[LinearPart, ...]) -> str:
    out = ""
    for i, part in enumerate(parts):
        text = number_text(part.factor if i == 0 else abs(part.factor))
        if part.variable is not None:
            text += f"*{word_text(part.variable)}"
        negative = number_text(part.factor).startswith("-")
        out += text if i == 0 else f" {'-' if negative else '+'} {text.removeprefix('-')}"
    return out


def _grid(node: GridNode) -> tuple[str, list[str]]:
    first, rows = grid_lines(node)
    trivia = [node.header_trivia, *(row.trivia for row in node.rows)]
    return first, _block_lines(rows, trivia)


def _block_lines(lines: list[str], trivia: list[Trivia]) -> list[str]:
    out: list[str] = []
    for line, around in zip(lines, trivia, strict=True):
        out += [f"  {comment}" for comment in around.before if comment]
        out.append(with_comment(line, around.behind))
    return out


def _lookup(node: LookupNode) -> tuple[str, list[str]]:
    rows = [_lookup_parts(item) for item in node.items]
    return "lookup", _block_lines(aligned(rows) if rows else [], [i.trivia for i in node.items])


def _lookup_parts(item: LookupItem) -> list[str]:
    values = [figure_text(figure) for figure in item.figures]
    if item.form in ("step", "count"):
        body = f"{values[0]} .. {values[1]} {item.form} {values[2]}"
    else:
        body = " ".join(values) + (" mirrored" if item.form == "mirrored" else "")
    key = item.key.text + (f" {word_text(item.variable)}:" if item.variable else "")
    return [key, body]


def _rule(node: RuleNode) -> list[str]:
    antecedent = expression_text(node.antecedent)
    consequents = " and ".join(map(proposition_text, node.consequents))
    weight = f" with {figure_text(node.weight)}" if node.weight else ""
    line = f"rule if {antecedent} then {consequents}{weight}"
    if len(line) <= WIDTH:
        return [line]
    return [f"rule if {antecedent}", f"     then {consequents}{weight}"]


def settings_text(settings: tuple[SettingNode, ...]) -> str:
    """Return ``key value`` pairs with commas between them."""
    return ", ".join(map(_setting, settings))


def _setting(node: SettingNode) -> str:
    value = node.value.text if node.value else ""
    if node.figure is not None:
        value = figure_text(node.figure)
    if node.resolution is not None:
        sampling = f", {node.sampling.text}" if node.sampling else ""
        value += f"({figure_text(node.resolution)}{sampling})"
    elif node.exact:
        value += " exact"
    return f"{node.key.text} {value}"


def _heading(node: Heading) -> str:
    description = "" if node.description is None else f" {string_text(node.description)}"
    return f"rulebase {word_text(node.name)}{description}"


def _even_terms(node: EvenTermsNode) -> str:
    variables = ", ".join(map(word_text, node.variables))
    return f"terms {variables}: {node.family.text} {' '.join(map(word_text, node.names))}"


def _inference(node: InferenceNode) -> str:
    target = f"{word_text(node.target)}: " if node.target else ""
    return f"inference {target}{settings_text(node.settings)}"


def _block(node: BlockNode) -> str:
    settings = f": {settings_text(node.settings)}" if node.settings else ""
    return f"block {word_text(node.name)}{settings}"


def _expect(node: ExpectNode) -> str:
    inputs = ", ".join(f"{word_text(name)} = {figure_text(x)}" for name, x in node.inputs)
    return f"expect {inputs} -> {', '.join(map(_outcome, node.outcomes))}"


def _outcome(node: OutcomeNode) -> str:
    text = f"{word_text(node.variable)} {node.relation} {figure_text(node.value)}"
    if node.other is None:
        return text
    return text + (" .. " if node.relation == "in" else " within ") + figure_text(node.other)


_PRINTERS: dict[type, Callable[[Any], str]] = {
    Heading: _heading,
    EvenTermsNode: _even_terms,
    InferenceNode: _inference,
    BlockNode: _block,
    ExpectNode: _expect,
}
_PARTS: dict[type, Callable[[Any], list[str]]] = {
    VariableNode: _variable_parts,
    TermNode: _term_parts,
}
