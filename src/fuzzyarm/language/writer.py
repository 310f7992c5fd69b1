"""Write a RuleBase as canonical text: the way back from meaning to syntax, grids found again."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from math import isfinite

from fuzzyarm.base.diagnostic import Figure, Word
from fuzzyarm.base.numbers import evenly, mirror
from fuzzyarm.language.declarations import even_shapes
from fuzzyarm.language.document import Document, Statement, print_document
from fuzzyarm.language.meaning import UNNAMED
from fuzzyarm.language.model.rulebase import (
    And,
    AnyRuleBase,
    Defuzzifier,
    Expectation,
    Expression,
    Hedge,
    Hedged,
    Is,
    Lookup,
    LookupAxis,
    Or,
    Outcome,
    Output,
    Property,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
    Tuning,
    Variable,
    model_of,
)
from fuzzyarm.language.phrases import (
    ExpressionNode,
    HedgedNode,
    HedgeNode,
    JunctionNode,
    LinearPart,
    PropositionNode,
    SettingNode,
    ShapeNode,
)
from fuzzyarm.language.rules import CellNode, GridNode, RowNode, RuleNode
from fuzzyarm.language.statements import (
    BlockNode,
    EvenTermsNode,
    ExpectNode,
    Heading,
    InferenceNode,
    LookupItem,
    LookupNode,
    OutcomeNode,
    ProveNode,
    StatementNode,
    StretchNode,
    TermNode,
    VariableNode,
)
from fuzzyarm.language.tokens import Trivia
from fuzzyarm.language.tune import TuneItem, TuneNode

# --- Finding the grids in a flat list of rules, without changing their order ---

_FEWEST = 4
"""Least number of rules for a grid."""


class _TermOrder(dict[tuple[str, str], int]):
    """The position of each term in its variable, by their names."""

    def __init__(self, rulebase: RuleBase) -> None:
        super().__init__(
            ((variable.name, term.name), i)
            for variable in (*rulebase.inputs, *rulebase.outputs)
            for i, term in enumerate(variable.terms)
        )
        self._rulebase = rulebase

    def __missing__(self, names: tuple[str, str]) -> int:
        """Raise an error for a name missing from a model built in Python."""
        variable, term = names
        self._rulebase.variable(variable).term(term)
        raise AssertionError(names)


class _GridRun:
    """Consecutive rules that fill a grid row by row.

    `order` has the position of each term in its variable; `rest` are the conditions common to all
    antecedents beyond row and column (``when …``).
    """

    def __init__(self, rule: Rule, cell: _Cell, order: _TermOrder) -> None:
        row, column, self.rest = cell
        self.output = rule.consequents[0].variable
        self.row, self.column = row.variable, column.variable
        self.order = order
        self.cells: dict[tuple[str, str], Rule] = {}  # by the terms of row and column, in order
        self.last = (-1, -1)
        self.add(rule, cell)

    def add(self, rule: Rule, cell: _Cell) -> bool:
        """Add `rule` if it fills a later cell of this grid; return whether it does."""
        row, column, rest = cell
        grid = self.output, self.row, self.column, self.rest
        position = self.order[row.variable, row.term], self.order[column.variable, column.term]
        is_of_grid = (rule.consequents[0].variable, row.variable, column.variable, rest) == grid
        if not is_of_grid or position <= self.last:
            return False
        self.cells[row.term, column.term] = rule
        self.last = position
        return True

    def pieces(self) -> list[Rule | GridNode]:
        """Return the grid, or the rules as they are where too few cells are filled."""
        rules = list(self.cells.values())
        rows = list(dict.fromkeys(row for row, _ in self.cells))
        columns = list(dict.fromkeys(column for _, column in self.cells))
        if len(rules) < _FEWEST or 2 * len(rules) < len(rows) * len(columns):
            return list(rules)
        columns.sort(key=lambda term: self.order[self.column, term])
        condition = None
        if self.rest:
            condition = _expression(self.rest[0] if len(self.rest) == 1 else And(self.rest))
        grid = GridNode(
            Word(self.output),
            condition,
            Word(self.row),
            Word(self.column),
            tuple(map(Word, columns)),
            tuple(
                RowNode(Word(row), tuple(_cell(self.cells.get((row, c))) for c in columns))
                for row in rows
            ),
        )
        return [grid]


_Cell = tuple[Is, Is, tuple[Expression, ...]]


def _split_into_grids(rules: Sequence[Rule], rulebase: RuleBase) -> list[Rule | GridNode]:
    """Return `rules` in order, with each run that reads back from a grid as a grid."""
    order = _TermOrder(rulebase)
    pieces: list[Rule | GridNode] = []
    run: _GridRun | None = None
    for rule in rules:
        cell = _as_cell(rule)
        if run is not None and cell is not None and run.add(rule, cell):
            continue
        if run is not None:
            pieces += run.pieces()
        run = None if cell is None else _GridRun(rule, cell, order)
        if run is None:
            pieces.append(rule)
    return pieces + (run.pieces() if run is not None else [])


def _as_cell(rule: Rule) -> _Cell | None:
    """Return row, column and the other conditions of a rule that fits in a grid."""
    antecedent = rule.antecedent
    if not isinstance(antecedent, And) or len(rule.consequents) != 1:
        return None
    if rule.consequents[0].hedges or len(antecedent.operands) < 2:
        return None
    row, column, *rest = antecedent.operands
    if not isinstance(row, Is) or not isinstance(column, Is) or row.hedges or column.hedges:
        return None
    # One And as the only condition would be flattened on the way back.
    if row.variable == column.variable or (len(rest) == 1 and isinstance(rest[0], And)):
        return None
    return row, column, tuple(rest)


def _cell(rule: Rule | None) -> CellNode:
    if rule is None:
        return CellNode(None, None)
    weight = None if rule.weight == 1.0 else Figure(rule.weight)
    return CellNode(Word(rule.consequents[0].term), weight)


# --- From the model to the syntax tree ---


def write(rulebase: AnyRuleBase) -> str:
    """Return canonical text that parses to `rulebase` again.

    Rules that fill a grid in order are written as a grid, all others as ``rule`` lines.
    Every setting is written out, so that the text depends on no default.

    Parameters
    ----------
    rulebase : RuleBase
        The value, or one under construction.

    Returns
    -------
    str
        In the form of ``fuzzyarm fmt``.
    """
    rulebase = model_of(rulebase)
    statements: list[Statement] = []
    for section in _sections(rulebase):
        for i, node in enumerate(section):
            blank = ("",) if i == 0 and statements else ()
            statements.append(Statement(node, Trivia(blank)))
    return print_document(Document(tuple(statements)))


def _sections(rulebase: RuleBase) -> Iterator[Sequence[StatementNode]]:
    yield [Heading(Word(rulebase.name or UNNAMED), rulebase.description or None)]
    yield [_variable("input", variable) for variable in rulebase.inputs] + [
        _variable("output", variable) for variable in rulebase.outputs
    ]
    yield from _terms(rulebase)
    yield list(_inference(rulebase))
    for block in rulebase.blocks:
        yield list(_block(block, rulebase))
    if rulebase.lookup is not None:
        yield [lookup_node(rulebase.lookup)]
    yield [_expectation(expectation) for expectation in rulebase.expectations]
    yield [property_node(statement, rulebase) for statement in rulebase.properties]
    if rulebase.tuning is not None:
        yield [tuning_node(rulebase.tuning)]


def _variable(role: str, variable: Variable) -> VariableNode:
    return VariableNode(
        role,
        Word(variable.name),
        Figure(variable.low),
        Figure(variable.high),
        variable.description or None,
    )


def _terms(rulebase: RuleBase) -> Iterator[Sequence[StatementNode]]:
    """Yield the terms; an evenly spaced family is one line for all its variables."""
    shared: dict[tuple[str, tuple[str, ...]], list[Variable]] = {}
    others: list[Variable] = []
    for variable in (*rulebase.inputs, *rulebase.outputs):
        family = _even_family(variable)
        if family is None:
            others.append(variable)
        else:
            names = tuple(term.name for term in variable.terms)
            shared.setdefault((family, names), []).append(variable)
    yield [
        EvenTermsNode(
            tuple(Word(variable.name) for variable in variables),
            Word(family),
            tuple(map(Word, names)),
        )
        for (family, names), variables in shared.items()
    ]
    inputs = [variable.name for variable in rulebase.inputs]
    for variable in others:
        yield [
            TermNode(Word(variable.name), Word(term.name), _shapes(term, inputs))
            for term in variable.terms
        ]


def _even_family(variable: Variable) -> str | None:
    count = len(variable.terms)
    if count < 2 or not (isfinite(variable.low) and isfinite(variable.high)):
        return None
    shapes = [term.shape for term in variable.terms]
    if any(term.lower is not None for term in variable.terms):
        return None
    families = ["triangles", "gaussians"]
    if isinstance(variable, Output):
        families.append("singletons")
    for family in families:
        if shapes == even_shapes(family, count, variable.low, variable.high):
            return family
    return None


def _shapes(term: Term, names: Sequence[str]) -> ShapeNode:
    lower = None if term.lower is None else shape_node(term.lower, names)
    return shape_node(term.shape, names)._replace(lower=lower)


def shape_node(shape: Shape, names: Sequence[str]) -> ShapeNode:
    """Return a shape as it would be written; `names` are those of the inputs, for ``linear``."""
    kind = Word(shape.kind)
    height = None if shape.height == 1.0 else Figure(shape.height)
    if shape.kind == "linear":
        *factors, constant = shape.parameters
        parts = [
            LinearPart(factor, Word(name))
            for factor, name in zip(factors, names, strict=True)
            if factor != 0.0
        ]
        if constant != 0.0 or not parts:
            parts.append(LinearPart(constant, None))
        return ShapeNode(kind, parts=tuple(parts), height=height)
    if shape.kind == "formula":
        return ShapeNode(kind, formula=shape.formula, height=height)
    return ShapeNode(kind, tuple(map(Figure, shape.parameters)), height=height)


_OF_VARIABLES = ("aggregation", "defuzzifier", "no-rule", "outside")


def _inference(rulebase: RuleBase) -> Iterator[InferenceNode]:
    first = rulebase.blocks[0] if rulebase.blocks else RuleBlock()
    yield InferenceNode(None, _norms(first, first))
    settings = {output.name: _output_settings(output) for output in rulebase.outputs}
    settings |= {
        variable.name: (_choice("outside", variable.outside),) for variable in rulebase.inputs
    }
    # The most common setting is written once, others for their variables.
    every = [node for own in settings.values() for node in own]
    nodes = {str(node): node for node in every}
    counts = Counter(map(str, every))
    shared: list[SettingNode] = []
    for key in _OF_VARIABLES:
        texts = [text for text, node in nodes.items() if node.key == key]
        shared += [nodes[max(texts, key=counts.__getitem__)]] if texts else []
    if shared:
        yield InferenceNode(None, tuple(shared))
    shared_texts = set(map(str, shared))
    for variable in (*rulebase.inputs, *rulebase.outputs):
        own = tuple(node for node in settings[variable.name] if str(node) not in shared_texts)
        if own:
            yield InferenceNode(Word(variable.name), own)


def _norms(block: RuleBlock, first: RuleBlock) -> tuple[SettingNode, ...]:
    norms = (
        _choice("and", block.conjunction),
        _choice("or", block.disjunction),
        _choice("implication", block.implication),
    )
    if block.threshold == 0.0 and first.threshold == 0.0:
        return norms  # the default; others are printed, since a block inherits the file's
    return (*norms, SettingNode(Word("threshold"), figure=Figure(block.threshold)))


def _choice(key: str, value: str) -> SettingNode:
    return SettingNode(Word(key), Word(value))


def _output_settings(output: Output) -> tuple[SettingNode, ...]:
    if isinstance(output.no_rule, str):
        no_rule = _choice("no-rule", output.no_rule)
    else:
        no_rule = SettingNode(Word("no-rule"), figure=Figure(output.no_rule))
    return (
        _choice("aggregation", output.aggregation),
        _defuzzifier(output.defuzzifier),
        no_rule,
        _choice("outside", output.outside),
    )


def _defuzzifier(defuzzifier: Defuzzifier) -> SettingNode:
    key, method = Word("defuzzifier"), Word(defuzzifier.method)
    if defuzzifier.resolution is None:
        return SettingNode(key, method, exact=not defuzzifier.record.weighs)
    return SettingNode(
        key,
        method,
        resolution=Figure(float(defuzzifier.resolution)),
        sampling=Word(defuzzifier.sampling),
    )


def _block(block: RuleBlock, rulebase: RuleBase) -> Iterator[StatementNode]:
    first = rulebase.blocks[0]
    if block.name or block is not first:
        same = _norms(block, first) == _norms(first, first)
        yield BlockNode(Word(block.name), () if same else _norms(block, first))
    for piece in _split_into_grids(block.rules, rulebase):
        yield rule_node(piece) if isinstance(piece, Rule) else piece


def rule_node(rule: Rule) -> RuleNode:
    """Return a rule as it would be written."""
    consequents = tuple(
        PropositionNode(Word(c.variable), _hedges(c.hedges), Word(c.term)) for c in rule.consequents
    )
    weight = None if rule.weight == 1.0 else Figure(rule.weight)
    return RuleNode(_expression(rule.antecedent), consequents, weight)


def _expression(expression: Expression) -> ExpressionNode:
    if isinstance(expression, Is):
        return PropositionNode(
            Word(expression.variable), _hedges(expression.hedges), Word(expression.term)
        )
    if isinstance(expression, Hedged):
        return HedgedNode(_hedges(expression.hedges), _expression(expression.operand))
    word = "or" if isinstance(expression, Or) else "and"
    return JunctionNode(word, tuple(map(_expression, expression.operands)))


def _hedges(hedges: tuple[Hedge, ...]) -> tuple[HedgeNode, ...]:
    return tuple(
        HedgeNode(Word(h.name), None if h.exponent is None else Figure(h.exponent)) for h in hedges
    )


def lookup_node(lookup: Lookup) -> LookupNode:
    """Return a ``lookup`` block as the writer has it."""
    items = []
    for axis in lookup.axes:
        items.append(_levels(axis))
        if axis.bins is not None:
            form, bins = _bins(axis.bins)
            items.append(LookupItem(Word("bins"), Word(axis.variable), form, bins))
    if lookup.round is not None:
        items.append(LookupItem(Word("round"), None, "list", (Figure(lookup.round),)))
    return LookupNode(tuple(items))


def _levels(axis: LookupAxis) -> LookupItem:
    levels = axis.levels
    key, word = Word("levels"), Word(axis.variable)
    if len(levels) > 2 and evenly(levels[0], levels[-1], len(levels)) == levels:
        figures = (levels[0], levels[-1], float(len(levels)))
        return LookupItem(key, word, "count", tuple(map(Figure, figures)))
    return LookupItem(key, word, "list", tuple(map(Figure, levels)))


def _bins(bins: tuple[float, ...]) -> tuple[str, tuple[Figure, ...]]:
    upper = bins[len(bins) // 2 :]
    if bins and len(bins) % 2 == 0 and mirror(upper) == bins:
        return "mirrored", tuple(map(Figure, upper))
    return "list", tuple(map(Figure, bins))


def tuning_node(tuning: Tuning) -> TuneNode:
    """Return a ``tune`` block as the writer has it."""
    items = []
    for peaks in tuning.peaks:
        options = {
            "mirrored": peaks.mirrored,
            "keep order": peaks.ordered,
            "partition": peaks.partition,
        }
        words = tuple(word for word, holds in options.items() if holds)
        # 100 times a share may have a digit that the share lacks.
        gap = Figure(float(f"{100.0 * peaks.gap:.12g}"))
        items.append(TuneItem(Word("peaks"), tuple(map(Word, peaks.variables)), words, gap=gap))
    for gain in tuning.gains:
        flags = {"times": gain.times, "log": gain.log, "per axis": gain.per_axis}
        words = tuple(word for word, holds in flags.items() if holds)
        low, high = Figure(gain.low), Figure(gain.high)
        items.append(
            TuneItem(Word("gain"), tuple(map(Word, gain.names)), words, low=low, high=high)
        )
    for variable in dict.fromkeys(variable for variable, _ in tuning.kept):
        terms = tuple(Word(term) for owner, term in tuning.kept if owner == variable and term)
        items.append(TuneItem(Word("keep"), (Word(variable),), terms=terms))
    return TuneNode(tuple(items))


def _expectation(expectation: Expectation) -> ExpectNode:
    inputs = tuple((Word(name), Figure(value)) for name, value in expectation.inputs)
    return ExpectNode(inputs, tuple(map(_outcome, expectation.outcomes)))


def _outcome(outcome: Outcome) -> OutcomeNode:
    other = None if outcome.other is None else Figure(outcome.other)
    return OutcomeNode(Word(outcome.variable), outcome.relation, Figure(outcome.value), other)


def property_node(claim: Property, rulebase: RuleBase) -> ProveNode:
    """Return a property as it would be written in the file of a rule base."""
    is_obvious = claim.kind == "table" and len(rulebase.outputs) == 1
    return ProveNode(
        tuple(
            StretchNode(Word(name), Figure(low), Figure(high)) for name, low, high in claim.region
        ),
        claim.kind,
        None if is_obvious else Word(claim.output),
        None if claim.outcome is None else _outcome(claim.outcome),
        Word(claim.input) if claim.input else None,
        Figure(claim.low) if claim.kind == "slope" else None,
        Figure(claim.high) if claim.kind in ("slope", "table") else None,
        Word(claim.mode) if claim.mode else None,
    )
