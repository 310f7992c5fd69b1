"""The syntax tree: a file as it is written, with places and comments, before any meaning.

The formatter prints it, the language server walks it, and
:mod:`fuzzyarm.language.meaning` turns it into a RuleBase.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from fuzzyarm.text.diagnostic import NOWHERE, Diagnostic, Span


class Word(NamedTuple):
    """A name or keyword at its place."""

    text: str
    span: Span = NOWHERE


class Figure(NamedTuple):
    """A number at its place."""

    value: float
    span: Span = NOWHERE


class HedgeNode(NamedTuple):
    """A hedge word; `exponent` belongs to ``power(…)`` alone."""

    word: Word
    exponent: Figure | None = None


class PropositionNode(NamedTuple):
    """``variable is [hedges] term``, in antecedents and consequents."""

    variable: Word
    hedges: tuple[HedgeNode, ...]
    term: Word

    @property
    def span(self) -> Span:
        """From the variable to the term."""
        return self.variable.span.to(self.term.span)


class JunctionNode(NamedTuple):
    """Two or more operands between ``and`` or between ``or``."""

    word: str
    operands: tuple[ExpressionNode, ...]


class HedgedNode(NamedTuple):
    """Hedges before a parenthesis."""

    hedges: tuple[HedgeNode, ...]
    operand: ExpressionNode


ExpressionNode = PropositionNode | JunctionNode | HedgedNode


class Trivia(NamedTuple):
    """What surrounds a line: the comments and blank lines before it, the comment behind it.

    `before` holds comment lines with their ``#``; an empty string is a blank line.
    """

    before: tuple[str, ...] = ()
    behind: str = ""


class Heading(NamedTuple):
    """``rulebase NAME "description"``."""

    name: Word
    description: str | None
    span: Span = NOWHERE


class VariableNode(NamedTuple):
    """``input NAME LOW .. HIGH "description"`` and the same with ``output``.

    The ends are None where the range could not be read.
    """

    role: str
    name: Word
    low: Figure | None
    high: Figure | None
    description: str | None
    span: Span = NOWHERE


class EvenTermsNode(NamedTuple):
    """``terms A, B: triangles T1 T2 …``."""

    variables: tuple[Word, ...]
    family: Word
    names: tuple[Word, ...]
    span: Span = NOWHERE


class LinearPart(NamedTuple):
    """One summand of a ``linear`` consequent: a factor and an input, or a bare number."""

    factor: float
    variable: Word | None
    span: Span = NOWHERE


class ShapeNode(NamedTuple):
    """A shape with its numbers.

    `figures` are the numbers in order (for ``points`` the pairs laid flat), `parts` the
    summands of ``linear``, `formula` the text of ``formula``.
    """

    kind: Word
    figures: tuple[Figure, ...] = ()
    parts: tuple[LinearPart, ...] = ()
    formula: str = ""
    formula_span: Span = NOWHERE
    height: Figure | None = None


class TermNode(NamedTuple):
    """``term VARIABLE NAME: SHAPE``; no shape where it could not be read."""

    variable: Word
    name: Word
    shape: ShapeNode | None
    span: Span = NOWHERE


class SettingNode(NamedTuple):
    """One ``key value`` of ``inference`` or ``block``.

    `value` is the word of the value, `figure` its number (``no-rule 0``), `resolution` and
    `sampling` what stands in the parentheses of a defuzzifier, `exact` the word itself.
    """

    key: Word
    value: Word | None = None
    figure: Figure | None = None
    resolution: Figure | None = None
    sampling: Word | None = None
    exact: bool = False


class InferenceNode(NamedTuple):
    """``inference [VARIABLE:] key value, …``."""

    target: Word | None
    settings: tuple[SettingNode, ...]
    span: Span = NOWHERE


class BlockNode(NamedTuple):
    """``block NAME[: key value, …]``: the rules that follow form a block of their own."""

    name: Word
    settings: tuple[SettingNode, ...]
    span: Span = NOWHERE


class CellNode(NamedTuple):
    """A grid cell: a term, maybe with a weight; no term where the file has a dot."""

    term: Word | None
    weight: Figure | None
    span: Span = NOWHERE


class RowNode(NamedTuple):
    """A row of a grid."""

    label: Word
    cells: tuple[CellNode, ...]
    trivia: Trivia = Trivia()


class GridNode(NamedTuple):
    """``rules OUTPUT [when …]`` and the grid below it.

    A grid over one input has no `row` variable; the label of its one row is the output.
    """

    output: Word
    condition: ExpressionNode | None
    row: Word | None
    column: Word
    columns: tuple[Word, ...]
    rows: tuple[RowNode, ...]
    header_trivia: Trivia = Trivia()
    header_span: Span = NOWHERE
    span: Span = NOWHERE


class RuleNode(NamedTuple):
    """``rule if … then … [with WEIGHT]``."""

    antecedent: ExpressionNode
    consequents: tuple[PropositionNode, ...]
    weight: Figure | None
    span: Span = NOWHERE


class LookupItem(NamedTuple):
    """One line of a ``lookup`` block.

    `key` is ``levels``, ``bins`` or ``round``. `figures` are the numbers as written; with
    `form` ``step`` or ``count`` they are low, high and the step or the count; with ``list``
    the values themselves; ``mirrored`` marks bins that are also meant with a minus sign.
    """

    key: Word
    variable: Word | None
    form: str
    figures: tuple[Figure, ...]
    trivia: Trivia = Trivia()
    span: Span = NOWHERE


class LookupNode(NamedTuple):
    """The ``lookup`` block."""

    items: tuple[LookupItem, ...]
    span: Span = NOWHERE


class OutcomeNode(NamedTuple):
    """``output relation value [within tolerance]`` or ``output in low .. high``."""

    variable: Word
    relation: str
    value: Figure
    other: Figure | None


class ExpectNode(NamedTuple):
    """``expect input = value, … -> outcome, …``."""

    inputs: tuple[tuple[Word, Figure], ...]
    outcomes: tuple[OutcomeNode, ...]
    span: Span = NOWHERE


class Broken(NamedTuple):
    """A statement that could not be read; `keyword` is its first word, if that was one."""

    keyword: str
    span: Span = NOWHERE


StatementNode = (
    Heading
    | VariableNode
    | EvenTermsNode
    | TermNode
    | InferenceNode
    | BlockNode
    | GridNode
    | RuleNode
    | LookupNode
    | ExpectNode
    | Broken
)


class Statement(NamedTuple):
    """A statement and the comments around it."""

    node: StatementNode
    trivia: Trivia = Trivia()


@dataclass(frozen=True, slots=True)
class Document:
    """A whole file.

    Attributes
    ----------
    statements : tuple of Statement
        In order.
    ending : tuple of str
        Comments and blank lines after the last statement.
    allowed : dict of int to frozenset of str
        Names that ``# allow`` silences, by line.
    diagnostics : tuple of Diagnostic
        What the lexer and the parser found.
    """

    statements: tuple[Statement, ...]
    ending: tuple[str, ...] = ()
    allowed: dict[int, frozenset[str]] = field(default_factory=dict)
    diagnostics: tuple[Diagnostic, ...] = ()


def proposition_nodes(expression: ExpressionNode) -> Iterator[PropositionNode]:
    """Yield every proposition in `expression`, from left to right."""
    if isinstance(expression, PropositionNode):
        yield expression
    elif isinstance(expression, HedgedNode):
        yield from proposition_nodes(expression.operand)
    else:
        for operand in expression.operands:
            yield from proposition_nodes(operand)
