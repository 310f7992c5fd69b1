"""The outline of a file."""

from __future__ import annotations

from dataclasses import dataclass

from fuzzyarm.rulebase.diagnostic import Span
from fuzzyarm.rulebase.queries.candidates import variable_detail
from fuzzyarm.rulebase.queries.reading import Reading
from fuzzyarm.rulebase.syntax.nodes import (
    BlockNode,
    ExpectNode,
    GridNode,
    Heading,
    LookupNode,
    RuleNode,
    VariableNode,
)


@dataclass(frozen=True, slots=True)
class Symbol:
    """A part of a file.

    Attributes
    ----------
    name, detail : str
        What an outline shows.
    kind : str
        ``rulebase``, ``input``, ``output``, ``term``, ``block``, ``grid``, ``rule``,
        ``lookup`` or ``expect``.
    span, selection : Span
        All of it, and its name; the second lies within the first.
    children : tuple of Symbol
        The terms of a variable.
    """

    name: str
    detail: str
    kind: str
    span: Span
    selection: Span
    children: tuple[Symbol, ...] = ()


def symbols(reading: Reading) -> list[Symbol]:
    """Return the parts of a file in its order; the terms of a variable below it."""
    found: list[Symbol] = []
    for node, first, last in reading.extents:
        whole = Span(first, node.span.column, last, len(reading.raw_line(last)) + 1)
        if isinstance(node, Heading):
            found.append(
                _named(node.name.text, node.description, "rulebase", whole, node.name.span)
            )
        elif isinstance(node, VariableNode):
            found.append(_variable(reading, node, whole))
        elif isinstance(node, BlockNode):
            found.append(_named(node.name.text, "", "block", whole, node.name.span))
        elif isinstance(node, GridNode):
            size = f"{len(node.rows)} × {len(node.columns)}"
            name = f"rules {node.output.text}"
            found.append(_named(name, size, "grid", whole, node.output.span))
        elif isinstance(node, RuleNode):
            text = " ".join(reading.raw_line(first).split())
            found.append(_named(text[:60] or "rule", "", "rule", whole, node.span))
        elif isinstance(node, LookupNode):
            found.append(_named("lookup", "", "lookup", whole, node.span))
        elif isinstance(node, ExpectNode):
            text = " ".join(reading.raw_line(first).split())
            found.append(_named(text[:60] or "expect", "", "expect", whole, node.span))
    return found


def _named(name: str, detail: str | None, kind: str, span: Span, selection: Span) -> Symbol:
    end = min((selection.end_line, selection.end_column), (span.end_line, span.end_column))
    return Symbol(
        name or "?", detail or "", kind, span, Span(selection.line, selection.column, *end)
    )


def _variable(reading: Reading, node: VariableNode, span: Span) -> Symbol:
    variable = reading.variable(node.name.text)
    if variable is None:
        return _named(node.name.text, "", node.role, span, node.name.span)
    # A child must lie within its parent, but terms are declared elsewhere: they point home.
    children = tuple(
        _named(term.name, term.shape.kind, "term", node.name.span, node.name.span)
        for term in variable.terms
    )
    return Symbol(
        node.name.text or "?", variable_detail(variable), node.role, span, node.name.span, children
    )
