"""Changes made in a picture, as edits of the text: terms, cells, rules, tuning."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from fuzzyarm.base.diagnostic import Span
from fuzzyarm.base.numbers import number_text
from fuzzyarm.language.edit.fixes import Edit, apply_edits
from fuzzyarm.language.edit.lines import (
    ReshapeError,
    declaration_of,
    demand_sound,
    last_line,
    last_lines,
    line_of_rules,
    lines_behind,
    names_term,
    nodes_of,
    realigned,
    without_lines,
    without_statement,
    without_word,
)
from fuzzyarm.language.edit.reading import Reading, read
from fuzzyarm.language.edit.references import rename
from fuzzyarm.language.model.alike import UnlikeError, alike
from fuzzyarm.language.model.controller import GainModel
from fuzzyarm.language.model.rulebase import PeakTuning, Shape, Tuning
from fuzzyarm.language.phrases import NameKind
from fuzzyarm.language.rows import lines_below, text_of
from fuzzyarm.language.rules import CellNode, GridNode, RuleNode
from fuzzyarm.language.statements import (
    ControllerHeading,
    EvenTermsNode,
    Heading,
    TermNode,
    VariableNode,
)
from fuzzyarm.language.tokens import name_text
from fuzzyarm.language.tune import TuneNode
from fuzzyarm.language.writer import shape_node, tuning_node

# --- Terms ---


class Reshaped(NamedTuple):
    """A term with its new shape; of interval type 2 the upper one and the lower one."""

    variable: str
    term: str
    shape: Shape
    lower: Shape | None = None


def set_shapes(reading: Reading, shapes: Sequence[Reshaped | tuple[str, str, Shape]]) -> list[Edit]:
    """Return the edits that give terms other shapes; comments stay.

    A term with its own declaration gets new numbers in its line. One of an evenly spaced family
    gets a line of its own below the family, which it overrides.

    Parameters
    ----------
    reading : Reading
        The text.
    shapes : sequence of Reshaped
        Variable, term and its shape, of numbers only; of an interval type-2 term both shapes.

    Raises
    ------
    ReshapeError
        If the text declares no such term.
    """
    edits: list[Edit] = []
    # All lines that go after one line are one edit: edits at one position have no order.
    behind: dict[int, list[str]] = {}
    for reshaped in shapes:
        variable, term, shape, lower = Reshaped(*reshaped)
        span = _own_line(reading, variable, term)
        if span is not None:
            edits.append(Edit(span, _shape_text(reading, shape, lower)))
            continue
        line = _line_behind_family(reading, variable, term)
        behind.setdefault(line, []).append(_term_text(reading, variable, term, shape, lower))
    edits += [lines_behind(reading, line, added) for line, added in behind.items()]
    return edits


def set_kind(reading: Reading, variable: str, term: str, kind: str) -> list[Edit]:
    """Return the edits that give a term the kind of another shape, at the same place.

    Parameters
    ----------
    reading : Reading
        The text.
    variable, term : str
        Which term; of an interval type-2 one both shapes change.
    kind : str
        See :func:`fuzzyarm.language.model.alike.alike`, also for the preserved features.

    Raises
    ------
    ReshapeError
        If the text declares no such term, the shape cannot be converted, or the text would become
        invalid.
    """
    declaration_of(reading, variable)
    model = reading.model.variable(variable)
    existing = model.term(term) if any(known.name == term for known in model.terms) else None
    if existing is None:
        raise ReshapeError(f"the text declares no term '{term}' of '{variable}'")
    low, high = model.low, model.high
    if not math.isfinite(high - low):
        raise ReshapeError(f"'{variable}' has no range to measure its terms by", hint="give it one")
    width = (high - low) / (len(model.terms) + 1)
    sides = [existing.shape] if existing.lower is None else [existing.shape, existing.lower]
    try:
        shapes = [alike(side, kind, low, high, width) for side in sides]
    except UnlikeError as error:
        raise ReshapeError(error.message, hint=error.hint) from error
    edits = set_shapes(
        reading, [Reshaped(variable, term, shapes[0], shapes[1] if shapes[1:] else None)]
    )
    return demand_sound(reading, edits, f"as '{kind}': ")


def _shape_text(reading: Reading, shape: Shape, lower: Shape | None = None) -> str:
    """Return a shape, or one over another, as a line of the text has it."""
    names = [variable.name for variable in reading.model.inputs]
    nodes = []
    for side in (shape, lower):
        if side is None:
            continue
        if side.kind == "linear" and len(side.parameters) != len(names) + 1:
            message = f"a sum of {len(names)} inputs has {len(names) + 1} numbers"
            raise ReshapeError(f"{message}, not {len(side.parameters)}")
        nodes.append(shape_node(side, names))
    upper, *under = nodes
    return str(upper._replace(lower=under[0] if under else None))


def _term_text(
    reading: Reading, variable: str, term: str, shape: Shape, lower: Shape | None = None
) -> str:
    words = _shape_text(reading, shape, lower)
    return f"term {name_text(variable)} {name_text(term)}: {words}"


def _terms(reading: Reading, variable: str) -> Iterator[TermNode]:
    for node in nodes_of(reading):
        if isinstance(node, TermNode) and node.variable == variable:
            yield node


def _own_line(reading: Reading, variable: str, term: str) -> Span | None:
    """Return the span of the shape in a term's own line; None without one."""
    for node in _terms(reading, variable):
        if node.name == term and node.shape is not None:
            return node.shape.kind.span.to(node.span)
    return None


def _family_of(reading: Reading, variable: str, term: str) -> EvenTermsNode | None:
    for node in nodes_of(reading):
        if not isinstance(node, EvenTermsNode) or term not in set(node.names):
            continue
        if variable in set(node.variables):
            return node
    return None


def _line_behind_family(reading: Reading, variable: str, term: str) -> int:
    """Return the line after which a term of a family is overridden: others may be already."""
    node = _family_of(reading, variable, term)
    if node is None:
        raise ReshapeError(f"the text declares no term '{term}' of '{variable}'")
    last = last_lines(reading)
    lines = {term_node.span.line for term_node in _terms(reading, variable)}
    line = last[node.span.line]
    while line + 1 in lines:
        line = last[line + 1]
    return line


def add_term(reading: Reading, variable: str, term: str, shape: Shape) -> list[Edit]:
    """Return the edit that declares another term: a line after the terms of its variable.

    Parameters
    ----------
    reading : Reading
        The text.
    variable, term : str
        The variable, and the name of its new term.
    shape : Shape
        Shape with numeric parameters.

    Raises
    ------
    ReshapeError
        If there is no such variable, or it has a term of that name.
    """
    declaration_of(reading, variable)
    if not term.strip():
        raise ReshapeError("a term needs a name")
    line_number = 0
    for node in nodes_of(reading):
        if isinstance(node, TermNode) and node.variable == variable:
            names = [node.name]
        elif isinstance(node, EvenTermsNode) and variable in set(node.variables):
            names = list(node.names)
        else:
            continue
        line_number = node.span.line
        if term in names:
            raise ReshapeError(f"'{variable}' has a term '{term}' already, on line {line_number}")
    words = [_term_text(reading, variable, term, shape)]
    if line_number:
        return [lines_behind(reading, last_lines(reading)[line_number], words)]
    # Its first term: after those of others, or below the variables.
    termed, declaration_line = (
        last_line(reading, TermNode, EvenTermsNode),
        last_line(reading, VariableNode),
    )
    if termed > declaration_line:
        return [lines_behind(reading, termed, words)]
    return [lines_behind(reading, declaration_line, ["", *words])]


def remove_term(reading: Reading, variable: str, term: str) -> list[Edit]:
    """Return the edits that remove a term, and the rules that name it.

    Sentences with the term are deleted, as are its rows and columns in grids; cells that conclude
    it become dots. The other terms of an evenly spaced family keep their positions: each gets a
    line of its own.

    Raises
    ------
    ReshapeError
        If the text declares no such term, or names it elsewhere: in an expectation, the
        condition of a grid, or a cell of several outputs.
    """
    edits: list[Edit] = []
    family = _family_of(reading, variable, term)
    nodes = [node for node in _terms(reading, variable) if node.name == term]
    if family is None and not nodes:
        raise ReshapeError(f"the text declares no term '{term}' of '{variable}'")
    if family is not None:
        edits += _without_family(reading, family, variable, term)
    line_numbers = {node.span.line for node in nodes}
    edits += [
        without_lines(reading, line, last_lines(reading)[line]) for line in sorted(line_numbers)
    ]
    for node in nodes_of(reading):
        if isinstance(node, RuleNode) and names_term(node, variable, term):
            line_numbers.add(node.span.line)
            edits.append(without_statement(reading, node))
        elif isinstance(node, GridNode):
            edits += _without_parts(reading, node, variable, term)
        elif not isinstance(node, TermNode | EvenTermsNode) and names_term(node, variable, term):
            raise ReshapeError(
                f"'{variable} is {term}' is used on line {node.span.line}: change that first"
            )
    return edits


def _without_family(reading: Reading, node: EvenTermsNode, variable: str, term: str) -> list[Edit]:
    """Take a variable out of a family; the other terms get their own lines."""
    names = {term_node.name for term_node in _terms(reading, variable)}
    lines = [
        _term_text(reading, variable, word, reading.model.variable(variable).term(word).shape)
        for word in node.names
        if word != term and word not in names
    ]
    others = tuple(word for word in node.variables if word != variable)
    if others:
        rest = Edit(node.span, text_of(node._replace(variables=others)))
        return [rest, lines_behind(reading, last_lines(reading)[node.span.line], lines)]
    return [Edit(node.span, "\n".join(lines))] if lines else [without_statement(reading, node)]


def _without_parts(reading: Reading, node: GridNode, variable: str, term: str) -> list[Edit]:
    """Remove a term from a grid: its row and column go, cells that use it become dots."""
    if node.condition is not None and any(
        mention.kind is NameKind.TERM and mention.name == term and variable in mention.owners
        for mention in node.condition.mentions()
    ):
        raise ReshapeError(f"a grid holds when '{variable} is {term}', on line {node.span.line}")
    heads = [i for i, word in enumerate(node.columns) if word == term]
    columns = heads if node.column == variable else []
    if columns and len(node.columns) == 1:
        return [without_statement(reading, node)]
    edits = [without_word(reading, node.columns[i].span) for i in columns]
    for row in node.rows:
        if node.row is not None and node.row == variable and row.label == term:
            if len(node.rows) == 1:
                return [without_statement(reading, node)]
            edits.append(without_lines(reading, row.label.span.line, row.label.span.line))
            continue
        for i, cell in enumerate(row.cells):
            concluded = node.output == variable and cell.term == term
            if i in columns and not node.joined:
                edits.append(without_word(reading, cell.span))
            elif (i in columns or concluded) and node.joined:
                raise ReshapeError(f"a cell of several outputs, on line {cell.span.line}, names it")
            elif concluded:
                wide = cell.span.end_column - cell.span.column if cell is not row.cells[-1] else 0
                edits.append(Edit(cell.span, ".".ljust(wide)))
    return edits


def rename_term(reading: Reading, variable: str, term: str, name: str) -> list[Edit]:
    """Return the edits that give a term another name wherever it is named; see :func:`rename`.

    Raises
    ------
    ReshapeError
        If the text declares no such term.
    RenameError
        If the name cannot be given.
    """
    for occurrence in reading.occurrences:
        if (
            occurrence.kind is NameKind.TERM
            and occurrence.name == term
            and variable in occurrence.owners
        ):
            return rename(reading, occurrence.span.line, occurrence.span.column, name)
    raise ReshapeError(f"the text declares no term '{term}' of '{variable}'")


def set_variable_range(reading: Reading, variable: str, low: float, high: float) -> list[Edit]:
    """Return the edit that gives a variable another range; evenly spaced terms follow it.

    Raises
    ------
    ReshapeError
        If there is no such variable, or the ends are reversed.
    """
    node = declaration_of(reading, variable)
    if not low < high:
        raise ReshapeError("the range must go from a lower to a higher number")
    if node.low is None or node.high is None:
        raise ReshapeError(f"the range of '{variable}' is not understood")
    return [Edit(node.low.span.to(node.high.span), f"{number_text(low)} .. {number_text(high)}")]


# --- Cells ---


def set_cell(reading: Reading, line: int, column: int, term: str | None) -> list[Edit]:
    """Return the edits that put a term into a cell of a grid, or a dot; the columns stay aligned.

    Parameters
    ----------
    reading : Reading
        The text.
    line, column : int
        Where the cell begins, from 1.
    term : str or None
        The term; None for no rule.

    Raises
    ------
    ReshapeError
        If no cell begins there, or a cell of a grid with several outputs would need a new form.
    """
    for grid, cell in _cells(reading):
        if (cell.span.line, cell.span.column) != (line, column):
            continue
        if grid.joined and (cell.term is None or term is None):
            raise ReshapeError("a cell of several outputs is filled or emptied in the text")
        weight = (
            f"*{number_text(cell.weight)}" if cell.weight is not None and term is not None else ""
        )
        new = "." if term is None else f"{name_text(term)}{weight}"
        return realigned(reading, [Edit(cell.span, new)])
    raise ReshapeError("no cell of a grid begins here")


def _cells(reading: Reading) -> Iterator[tuple[GridNode, CellNode]]:
    for node in nodes_of(reading):
        if isinstance(node, GridNode):
            for part in node.parts:
                for row in part.rows:
                    yield from ((node, cell) for cell in row.cells)


# --- Rules as sentences ---


def set_rule(reading: Reading, line: int | None, sentence: str) -> list[Edit]:
    """Return the edits that write a rule: another sentence, a new one, or none.

    Parameters
    ----------
    reading : Reading
        The text.
    line : int or None
        First line of the rule to be changed, from 1; None for a new one, which is added after the
        last rule.
    sentence : str
        ``if … then …``, maybe ``with`` a weight; empty to remove the rule.

    Raises
    ------
    ReshapeError
        If no sentence begins there, or the new one is invalid; with the fault.
    """
    words = " ".join(sentence.split()).removeprefix("rule ")
    with_quotes = _quoted(reading, words)
    try:
        return _with_rule(reading, line, words)
    except ReshapeError:
        if with_quotes == words:
            raise
        return _with_rule(reading, line, with_quotes)  # as a page prints a name of several words


def _quoted(reading: Reading, sentence: str) -> str:
    """Return a sentence with quotes around the names of the text that need them."""
    names = {mention.name for mention in reading.occurrences}
    bare = sorted((name for name in names if name_text(name) != name), key=len, reverse=True)
    if not bare:
        return sentence
    choices = "|".join(map(re.escape, bare))
    return re.sub(
        rf"'[^']*'|(?<!\w)(?:{choices})(?!\w)",
        lambda word: word[0] if word[0].startswith("'") else name_text(word[0]),
        sentence,
    )


def _with_rule(reading: Reading, line: int | None, words: str) -> list[Edit]:
    if line is None:
        if not words:
            raise ReshapeError("a rule reads: if … then …")
        behind = line_of_rules(reading)
        edits = [lines_behind(reading, behind, [f"rule {words}"])]
        return _understood(reading, edits, behind + 1)
    for node in nodes_of(reading):
        if isinstance(node, RuleNode) and node.span.line == line:
            if not words:
                return [without_statement(reading, node)]
            return _understood(reading, [Edit(node.span, f"rule {words}")], line)
    raise ReshapeError(f"no rule begins on line {line}")


def _understood(reading: Reading, edits: list[Edit], line: int) -> list[Edit]:
    """Return the edits where the line that they write has no mistake."""
    parsed = read(apply_edits(reading.text, edits), reading.path).parsed
    for diagnostic in parsed.diagnostics:
        if diagnostic.is_error and diagnostic.span.line == line:
            raise ReshapeError(diagnostic.message, hint=diagnostic.hint)
    return edits


# --- Tuning ---


def add_tuning(reading: Reading, tuning: Tuning) -> list[Edit]:
    """Return the edit that adds a ``tune`` block after the rule base.

    Parameters
    ----------
    reading : Reading
        The text.
    tuning : Tuning
        The movable numbers.

    Raises
    ------
    ReshapeError
        If the text has no rule base, or such a block already.
    """
    last = _end_of_rulebase(reading)
    if last is None:
        raise ReshapeError("the text has no rule base")
    if any(isinstance(statement.node, TuneNode) for statement in reading.document.statements):
        raise ReshapeError("the text has a tune block already")
    node = tuning_node(tuning)
    # The usual gap is left out, as a person would.
    usual = 100.0 * PeakTuning(()).gap
    short = [item._replace(gap=None) if item.gap == usual else item for item in node.items]
    node = node._replace(items=tuple(short))
    lines = [text_of(node), *(line for line, _ in lines_below(node) or ())]
    end = len(reading.raw_line(last)) + 1
    return [Edit(Span(last, end, last, end), "\n\n" + "\n".join(lines))]


def _end_of_rulebase(reading: Reading) -> int | None:
    """Return the last line of the rule base in a text."""
    last, inside = None, False
    for node, _, end in reading.extents:
        inside = not isinstance(node, ControllerHeading) and (inside or isinstance(node, Heading))
        if inside:
            last = end
    return last


def set_ranges(reading: Reading, ranges: Mapping[str, tuple[float, float]]) -> list[Edit]:
    """Return the edits that let gains of a controller move between two ends, by their logarithm.

    Parameters
    ----------
    reading : Reading
        The text.
    ranges : mapping of str to (float, float)
        By the names of the gains; one that has a range keeps it.
    """
    edits = []
    for statement in reading.document.statements:
        node = statement.node
        if isinstance(node, GainModel) and node.tune is None and node.name in ranges:
            low, high = map(number_text, ranges[node.name])
            line, column = node.span.end_line, node.span.end_column
            edits.append(Edit(Span(line, column, line, column), f", tune {low} .. {high} log"))
    return edits


def set_gain(reading: Reading, name: str, values: Sequence[float]) -> list[Edit]:
    """Return the edit that gives a gain of a controller other numbers; unit and comment stay.

    Parameters
    ----------
    reading : Reading
        The text.
    name : str
        Name of the gain.
    values : sequence of float
        One number for all axes, or one for each, as the text has them.

    Raises
    ------
    ReshapeError
        If the text declares no such gain, or another count of numbers.
    """
    for statement in reading.document.statements:
        node = statement.node
        if not isinstance(node, GainModel) or node.name != name:
            continue
        if len(values) != len(node.values):
            count = len(node.values)
            raise ReshapeError(f"gain '{name}' has {count} numbers in the text, not {len(values)}")
        return [
            Edit(amount.span, number_text(value))
            for amount, value in zip(node.values, values, strict=True)
        ]
    raise ReshapeError(f"the text declares no gain '{name}'")
