"""Read the shape of a term: a word and its numbers, pairs, summands or formula."""

from __future__ import annotations

from fuzzyarm.rulebase.diagnostic import Diagnostic
from fuzzyarm.rulebase.shapes import SHAPES
from fuzzyarm.rulebase.syntax.cursor import Cursor, Fault
from fuzzyarm.rulebase.syntax.nodes import Figure, LinearPart, ShapeNode


def read_shape(cursor: Cursor) -> ShapeNode:
    """Read a shape up to the end of the line."""
    kind = cursor.word("the shape of the term", tuple(SHAPES), "unknown-shape")
    figures: tuple[Figure, ...] = ()
    parts: tuple[LinearPart, ...] = ()
    formula, formula_span = "", cursor.span
    if kind.text == "points":
        figures = _read_pairs(cursor)
    elif kind.text == "linear":
        parts = _read_sum(cursor)
    elif kind.text == "formula":
        text = cursor.string()
        if text is None:
            cursor.fail("the formula in double quotes")
        formula = text or ""
    else:
        figures = _read_parameters(cursor, kind.text)
    height = cursor.figure("the height") if cursor.accept("height") else None
    return ShapeNode(kind, figures, parts, formula, formula_span, height)


def _read_parameters(cursor: Cursor, kind: str) -> tuple[Figure, ...]:
    wanted = SHAPES[kind].parameters
    start = cursor.span
    figures = []
    while cursor.at_figure:
        figures.append(cursor.figure("a number", finite=False))
    if len(figures) == len(wanted):
        return tuple(figures)
    if not figures and not cursor.at_end:
        cursor.fail(f"the numbers of {kind}: {' '.join(wanted)}")
    if len(figures) > len(wanted):
        start = figures[len(wanted)].span
    raise Fault(
        Diagnostic(
            "wrong-parameter-count",
            f"{kind} takes {len(wanted)} numbers ({', '.join(wanted)}), found {len(figures)}",
            start.to(figures[-1].span) if figures else start,
        )
    )


def _read_pairs(cursor: Cursor) -> tuple[Figure, ...]:
    figures: list[Figure] = []
    while cursor.accept("("):
        figures.append(cursor.figure("the x of a point"))
        cursor.expect(",", "between x and y of a point")
        figures.append(cursor.figure("the y of a point"))
        cursor.expect(")", "after a point")
    if not figures:
        cursor.fail("points like (0, 0) (1, 1)")
    return tuple(figures)


def _read_sum(cursor: Cursor) -> tuple[LinearPart, ...]:
    parts = [_read_summand(cursor, 1.0)]
    while cursor.next_is("+") or cursor.next_is("-"):
        sign = -1.0 if cursor.take().text == "-" else 1.0
        parts.append(_read_summand(cursor, sign))
    return tuple(parts)


def _read_summand(cursor: Cursor, sign: float) -> LinearPart:
    start = cursor.span
    while not cursor.at_figure and cursor.accept("-"):
        sign = -sign
    if not cursor.at_figure:
        variable = cursor.name("a number or an input")
        return LinearPart(sign, variable, variable.span)
    figure = cursor.figure("a number")
    if not cursor.accept("*"):
        return LinearPart(sign * figure.value, None, start.to(figure.span))
    variable = cursor.name("an input")
    return LinearPart(sign * figure.value, variable, start.to(variable.span))
