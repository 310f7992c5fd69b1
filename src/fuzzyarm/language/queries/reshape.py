"""What a hand changes in a picture, as edits of the text: numbers, cells, what may be tuned."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.language.controllers import ControllerHeading, GainNode
from fuzzyarm.language.phrases import ShapeNode
from fuzzyarm.language.queries.fixes import Edit
from fuzzyarm.language.queries.reading import Reading
from fuzzyarm.language.rules import CellNode, GridNode
from fuzzyarm.language.statements import EvenTermsNode, Heading, TermNode
from fuzzyarm.language.tokens import Figure, Word, name_text
from fuzzyarm.language.tune import TuneItem, TuneNode
from fuzzyarm.language.writer import tuning_node
from fuzzyarm.model.rulebase import PeakTuning, Shape, Tuning
from fuzzyarm.text.diagnostic import Span


class ReshapeError(FuzzyarmError, ValueError):
    """A change that has no single place in the text."""


def set_shapes(reading: Reading, shapes: Sequence[tuple[str, str, Shape]]) -> list[Edit]:
    """Return the edits that give terms other shapes; comments stay.

    A term that is declared by itself gets other numbers in its line. One of an evenly spaced
    family gets a line of its own below that of the family, which it then overrides.

    Parameters
    ----------
    reading : Reading
        The text.
    shapes : sequence of (str, str, Shape)
        Variable, term and its shape, of numbers only.

    Raises
    ------
    ReshapeError
        If the text declares no such term.
    """
    edits: list[Edit] = []
    behind: dict[int, list[str]] = {}
    for variable, term, shape in shapes:
        height = None if shape.height == 1.0 else Figure(shape.height)
        node = ShapeNode(Word(shape.kind), tuple(map(Figure, shape.parameters)), height=height)
        own = _own_line(reading, variable, term)
        if own is not None:
            edits.append(Edit(own, str(node)))
            continue
        line = _line_behind_family(reading, variable, term)
        words = f"term {name_text(variable)} {name_text(term)}: {node}"
        behind.setdefault(line, []).append(words)
    for line, added in behind.items():
        end = len(reading.raw_line(line)) + 1
        edits.append(Edit(Span(line, end, line, end), "".join(f"\n{words}" for words in added)))
    return edits


def _terms(reading: Reading, variable: str) -> Iterator[TermNode]:
    for statement in reading.document.statements:
        if isinstance(statement.node, TermNode) and statement.node.variable.text == variable:
            yield statement.node


def _own_line(reading: Reading, variable: str, term: str) -> Span | None:
    """Return the span of the shape in the line of a term; None where it has no line."""
    for node in _terms(reading, variable):
        if node.name.text == term and node.shape is not None:
            return node.shape.kind.span.to(node.span)
    return None


def _line_behind_family(reading: Reading, variable: str, term: str) -> int:
    """Return the line behind which a term of a family is overridden: others may be already."""
    last = {node.span.line: end for node, _, end in reading.extents}
    for statement in reading.document.statements:
        node = statement.node
        if not isinstance(node, EvenTermsNode) or term not in {word.text for word in node.names}:
            continue
        if variable in {word.text for word in node.variables}:
            lines = {each.span.line for each in _terms(reading, variable)}
            line = last[node.span.line]
            while line + 1 in lines:
                line = last[line + 1]
            return line
    raise ReshapeError(f"the text declares no term '{term}' of '{variable}'")


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
        If no cell begins there, or the cell of a grid of several outputs has to be written anew.
    """
    for grid, cell in _cells(reading):
        if (cell.span.line, cell.span.column) != (line, column):
            continue
        if grid.joined and (cell.term is None or term is None):
            raise ReshapeError("a cell of several outputs is filled or emptied in the text")
        weight = f"*{cell.weight}" if cell.weight is not None and term is not None else ""
        new = "." if term is None else f"{name_text(term)}{weight}"
        return [_aligned(reading.raw_line(line), cell.span, new)]
    raise ReshapeError("no cell of a grid begins here")


def _cells(reading: Reading) -> Iterator[tuple[GridNode, CellNode]]:
    for statement in reading.document.statements:
        if isinstance(statement.node, GridNode):
            for part in statement.node.parts:
                for row in part.rows:
                    yield from ((statement.node, cell) for cell in row.cells)


def _aligned(text: str, span: Span, new: str) -> Edit:
    """Put a word in the place of another; blanks behind it give way, or are added."""
    end = span.end_column
    longer = len(new) - (end - span.column)
    rest = text[end - 1 :]
    blanks = len(rest) - len(rest.lstrip(" "))
    if not rest.strip() or rest[:1] != " ":
        return Edit(span, new)
    if longer > 0:
        end += min(longer, blanks - 1)
    return Edit(Span(span.line, span.column, span.line, end), new + " " * max(0, -longer))


def add_tuning(reading: Reading, tuning: Tuning) -> list[Edit]:
    """Return the edit that writes a ``tune`` block behind what a rule base has.

    Parameters
    ----------
    reading : Reading
        The text.
    tuning : Tuning
        What may move.

    Raises
    ------
    ReshapeError
        If the text has no rule base, or such a block already.
    """
    last = _end_of_rulebase(reading)
    if last is None:
        raise ReshapeError("the text has no rule base")
    if any(isinstance(each.node, TuneNode) for each in reading.document.statements):
        raise ReshapeError("the text has a tune block already")
    node = tuning_node(tuning)
    usual = 100.0 * PeakTuning(()).gap
    short = [each._replace(gap=None) if _gap(each) == usual else each for each in node.items]
    node = node._replace(items=tuple(short))
    lines = [str(node), *(line for line, _ in node.below())]
    end = len(reading.raw_line(last)) + 1
    return [Edit(Span(last, end, last, end), "\n\n" + "\n".join(lines))]


def _gap(item: TuneItem) -> float | None:
    return None if item.gap is None else item.gap.value


def _end_of_rulebase(reading: Reading) -> int | None:
    """Return the last line of what belongs to the rule base in a text."""
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
        if isinstance(node, GainNode) and node.low is None and node.name.text in ranges:
            low, high = map(Figure, ranges[node.name.text])
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
        Of the gain.
    values : sequence of float
        One number for all axes, or one for each, as the text has them.

    Raises
    ------
    ReshapeError
        If the text declares no such gain, or another count of numbers.
    """
    for statement in reading.document.statements:
        node = statement.node
        if not isinstance(node, GainNode) or node.name.text != name:
            continue
        if len(values) != len(node.values):
            count = len(node.values)
            raise ReshapeError(f"gain '{name}' has {count} numbers in the text, not {len(values)}")
        return [
            Edit(amount.span, str(Figure(value)))
            for amount, value in zip(node.values, values, strict=True)
        ]
    raise ReshapeError(f"the text declares no gain '{name}'")
