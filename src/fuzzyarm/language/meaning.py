"""Turn a syntax tree into a RuleBase, as far as its statements are sound.

:func:`elaborate` walks the statements; rules, ``lookup`` and ``expect`` are judged here,
declarations in :mod:`fuzzyarm.language.declarations`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Hashable
from typing import TypeVar

from fuzzyarm.expression.kinds import HEDGES, SHAPES
from fuzzyarm.language.declarations import (
    Draft,
    Norms,
    Scope,
    add_even_terms,
    add_term,
    apply_inference,
    block_norms,
    declare_variable,
    range_of,
)
from fuzzyarm.language.document import Document, ParseMemory
from fuzzyarm.language.phrases import ExpressionNode, HedgedNode, HedgeNode, Kind, PropositionNode
from fuzzyarm.language.statements import (
    BlockNode,
    Broken,
    EvenTermsNode,
    ExpectNode,
    GridNode,
    Heading,
    InferenceNode,
    LookupItem,
    LookupNode,
    OutcomeNode,
    ProveNode,
    RowNode,
    RuleNode,
    StatementNode,
    TermNode,
    TuneNode,
    VariableNode,
)
from fuzzyarm.language.tokens import Figure, Word, name_text
from fuzzyarm.language.tune import TuneItem
from fuzzyarm.model.rulebase import (
    And,
    Consequent,
    Expectation,
    Expression,
    GainTuning,
    Hedge,
    Hedged,
    Input,
    Is,
    Lookup,
    LookupAxis,
    Or,
    Outcome,
    Output,
    PeakTuning,
    Property,
    Rule,
    RuleBase,
    RuleBlock,
    Tuning,
    last_conclusions,
    propositions,
)
from fuzzyarm.text.diagnostic import (
    MAX_DIAGNOSTICS,
    MAX_LEVELS,
    MAX_RULES,
    NOWHERE,
    Diagnostic,
    Related,
    Severity,
    Span,
)
from fuzzyarm.text.numbers import even_levels

# --- Grids and rules ---


def elaborate_rule(node: RuleNode, scope: Scope) -> list[Rule]:
    """Return the rule of `node` in a list; an empty list after a report."""
    antecedent = _expression(node.antecedent, scope)
    consequents = [_consequent(consequent, scope) for consequent in node.consequents]
    weight = _weight(node.weight, scope)
    sound = [consequent for consequent in consequents if consequent is not None]
    if antecedent is None or weight is None or len(sound) < len(consequents):
        return []
    return [Rule(antecedent, tuple(sound), weight, node.span)]


def elaborate_grid(node: GridNode, scope: Scope, budget: int) -> list[Rule]:
    """Return the rules of a grid, row by row; cells at fault are reported and left out."""
    node = _turned(node, scope)
    output = scope.variable(node.output, "output")
    condition = None if node.condition is None else _expression(node.condition, scope)
    row = scope.variable(node.row) if node.row is not None else None
    column = scope.variable(node.column)
    columns = [_antecedent_term(column, word, scope) for word in node.columns]
    _report_repeated(node.columns, "column", scope)
    _report_repeated(tuple(r.label for r in node.rows), "row", scope)
    if node.row is not None and row is not None and row is column:
        scope.report(
            "same-variable", f"rows and columns are both '{node.row.text}'", node.column.span
        )
    if node.row is None:
        _judge_single_row(node, scope)
    rules: list[Rule] = []
    for line in node.rows:
        label = None
        if node.row is not None:
            label = _antecedent_term(row, line.label, scope)
        rules += _row_rules(node, line, label, columns, condition, output, scope)
        if len(rules) > budget or scope.overflows:
            break
    sound = node.condition is None or condition is not None
    return rules if sound and output is not None else []


def _turned(node: GridNode, scope: Scope) -> GridNode:
    """Return a grid whose header has rows and columns the wrong way round as it was meant."""
    if node.row is None or not node.rows:
        return node
    down, across = scope.drafts.get(node.row.text), scope.drafts.get(node.column.text)
    if down is None or across is None:
        return node
    columns = {word.text for word in node.columns}
    labels = {row.label.text for row in node.rows}
    fits = columns <= across.terms.keys() and labels <= down.terms.keys()
    if fits or not (columns <= down.terms.keys() and labels <= across.terms.keys()):
        return node
    corner = f"{node.column} \\ {node.row}"
    scope.report(
        "transposed-header",
        f"the header has rows and columns the wrong way round: '{down.name}' goes across",
        node.row.span.to(node.column.span),
        hint=f"write  {corner}",
        replacement=corner,
    )
    return node._replace(row=node.column, column=node.row)


def _judge_single_row(node: GridNode, scope: Scope) -> None:
    for line in node.rows:
        if line.label.text != node.output.text:
            scope.report(
                "bad-row-label",
                f"the row of a grid over one input is labelled with the output"
                f" '{node.output.text}'",
                line.label.span,
                hint="a grid over two inputs has a header like  e \\ ce  NB ZE PB",
                replacement=name_text(node.output.text) if len(node.rows) == 1 else None,
            )


def _row_rules(
    node: GridNode,
    line: RowNode,
    label: Is | None,
    columns: list[Is | None],
    condition: Expression | None,
    output: Draft | None,
    scope: Scope,
) -> list[Rule]:
    rules = []
    extra = condition.operands if isinstance(condition, And) else (condition,)
    rest = tuple(operand for operand in extra if operand is not None)
    for cell, column in zip(line.cells, columns, strict=False):
        if cell.term is None:
            continue
        term = scope.term(output, cell.term)
        weight = _weight(cell.weight, scope)
        if term is None or weight is None or column is None:
            continue
        if node.row is not None and label is None:
            continue
        assert output is not None
        operands = (*((label,) if label is not None else ()), column, *rest)
        antecedent = And(operands) if len(operands) > 1 else operands[0]
        consequent = Consequent(output.name, term.name, (), cell.term.span)
        rules.append(Rule(antecedent, (consequent,), weight, cell.span, in_grid=True))
    return rules


def _report_repeated(words: tuple[Word, ...], what: str, scope: Scope) -> None:
    seen: dict[str, Span] = {}
    for word in words:
        if word.text in seen and not (what == "row" and not word.text):
            scope.report(
                f"repeated-{what}",
                f"the grid has two {what}s '{word.text}'",
                word.span,
                related=(Related("first here", seen[word.text]),),
            )
        seen.setdefault(word.text, word.span)


def _expression(node: ExpressionNode, scope: Scope) -> Expression | None:
    if isinstance(node, PropositionNode):
        return _proposition(node, scope)
    if isinstance(node, HedgedNode):
        operand = _expression(node.operand, scope)
        return None if operand is None else Hedged(_hedges(node.hedges, scope), operand)
    operands = [_expression(operand, scope) for operand in node.operands]
    sound = tuple(operand for operand in operands if operand is not None)
    if len(sound) < len(operands):
        return None
    return And(sound) if node.word == "and" else Or(sound)


def _proposition(node: PropositionNode, scope: Scope) -> Is | None:
    found = _antecedent_term(scope.variable(node.variable), node.term, scope)
    if found is None:
        return None
    return Is(found.variable, found.term, _hedges(node.hedges, scope), node.span)


def _antecedent_term(draft: Draft | None, word: Word, scope: Scope) -> Is | None:
    term = scope.term(draft, word)
    if term is None or draft is None:
        return None
    if not SHAPES[term.shape.kind].fuzzy:
        scope.report(
            "not-a-fuzzy-set",
            f"'{word.text}' of '{draft.name}' is a value, not a set; no rule can ask for it",
            word.span,
        )
        return None
    return Is(draft.name, term.name, (), word.span)


def _consequent(node: PropositionNode, scope: Scope) -> Consequent | None:
    draft = scope.variable(node.variable, "output")
    term = scope.term(draft, node.term)
    if draft is None or term is None:
        return None
    hedges = _hedges(node.hedges, scope)
    if hedges and not SHAPES[term.shape.kind].fuzzy:
        scope.report(
            "not-a-fuzzy-set",
            f"'{term.name}' is a value, not a set; a hedge cannot modify it",
            node.term.span,
        )
        return None
    return Consequent(draft.name, term.name, hedges, node.span)


def _hedges(nodes: tuple[HedgeNode, ...], scope: Scope) -> tuple[Hedge, ...]:
    hedges = []
    for node in nodes:
        if node.number is not None and not node.number.value > 0.0:
            what = HEDGES[node.word.text].parameters[0]
            if what == "exponent":
                scope.report("bad-exponent", "the exponent must be above 0", node.number.span)
        hedges.append(Hedge(node.word.text, node.number.value if node.number else None))
    return tuple(hedges)


def _weight(figure: Figure | None, scope: Scope) -> float | None:
    if figure is None:
        return 1.0
    if not 0.0 <= figure.value <= 1.0:
        scope.report("bad-weight", "a weight must lie between 0 and 1", figure.span)
        return None
    return figure.value


def report_too_many(span: Span, scope: Scope) -> None:
    """Report that the file has more rules than the language takes."""
    scope.report("too-many-rules", f"more than {MAX_RULES:,} rules", span)


# --- `expect` lines ---


def elaborate_expectation(node: ExpectNode, scope: Scope) -> Expectation | None:
    """Return the expectation of `node`, or None after a report."""
    before = len(scope.diagnostics)
    given: dict[str, float] = {}
    for word, figure in node.inputs:
        if scope.variable(word, "input") is None:
            continue
        if word.text in given:
            scope.report("duplicate-setting", f"'{word.text}' is given twice", word.span)
        given[word.text] = figure.value
    missing = [name for name in scope.names("input") if name not in given]
    if missing and len(scope.diagnostics) == before and not scope.broken_variables:
        scope.report(
            "incomplete-expectation",
            f"an expectation must name every input; missing: {', '.join(missing)}",
            node.span,
        )
    outcomes = tuple(_outcome(outcome, scope) for outcome in node.outcomes)
    if len(scope.diagnostics) > before:
        return None
    order = {name: i for i, name in enumerate(scope.names("input"))}
    inputs = tuple(sorted(given.items(), key=lambda item: order[item[0]]))
    return Expectation(inputs, outcomes, node.span)


def _outcome(node: OutcomeNode, scope: Scope) -> Outcome:
    scope.variable(node.variable, "output")
    other = node.other
    if node.relation == "=" and other is not None and other.value < 0.0:
        scope.report("bad-tolerance", "a tolerance must not be negative", other.span)
    if node.relation == "in" and other is not None and other.value < node.value.value:
        scope.report(
            "bad-range", "the interval must go from a lower to a higher number", other.span
        )
    return Outcome(
        node.variable.text, node.relation, node.value.value, other.value if other else None
    )


# --- `prove` lines ---


def elaborate_property(node: ProveNode, scope: Scope) -> Property | None:
    """Return the property of `node`, or None after a report."""
    before = len(scope.diagnostics)
    region: dict[str, tuple[float, float]] = {}
    for stretch in node.region:
        word = stretch.variable
        draft = scope.variable(word, "input")
        if draft is None:
            continue
        if word.text in region:
            scope.report("duplicate-setting", f"'{word.text}' is given twice", word.span)
        low, high = stretch.low.value, stretch.high.value
        _demand_stretch(stretch.high.span, low, high, scope)
        first, last = range_of(draft.node)
        if not first <= low <= high <= last and low <= high:
            scope.report(
                "bad-range",
                f"{low:g} .. {high:g} leaves the range of '{word.text}', {first:g} .. {last:g}",
                stretch.low.span.to(stretch.high.span),
            )
        region[word.text] = low, high
    output = _claimed_output(node, scope)
    outcome = None if node.outcome is None else _outcome(node.outcome, scope)
    if node.input is not None:
        scope.variable(node.input, "input")
    if node.verb == "slope" and node.low is not None and node.high is not None:
        _demand_stretch(node.high.span, node.low.value, node.high.value, scope)
    if node.verb == "table" and node.high is not None and not node.high.value > 0.0:
        scope.report("bad-tolerance", "the worst error of a table must be above 0", node.high.span)
    if node.verb == "odd":
        _demand_symmetry(node, region, scope)
    if len(scope.diagnostics) > before or output is None:
        return None
    return Property(
        node.verb,
        output,
        tuple((name, *ends) for name, ends in region.items()),
        outcome,
        node.input.text if node.input else "",
        node.low.value if node.low else 0.0,
        node.high.value if node.high else 0.0,
        node.mode.text if node.mode else "",
        node.span,
    )


def _demand_stretch(span: Span, low: float, high: float, scope: Scope) -> None:
    if high < low:
        scope.report("bad-range", "the interval must go from a lower to a higher number", span)


def _claimed_output(node: ProveNode, scope: Scope) -> str | None:
    if node.output is not None:
        draft = scope.variable(node.output, "output")
        return None if draft is None else draft.name
    outputs = scope.names("output")
    if len(outputs) == 1:
        return outputs[0]
    if outputs:
        scope.report(
            "ambiguous-output",
            "the file has several outputs: say which one the table is of",
            node.span,
            hint=f"write  table of {name_text(outputs[0])} {node.mode} within {node.high}",
        )
    return None


def _demand_symmetry(node: ProveNode, region: dict[str, tuple[float, float]], scope: Scope) -> None:
    for name in scope.names("input"):
        low, high = region.get(name, range_of(scope.drafts[name].node))
        if low != -high and node.output is not None:
            scope.report(
                "not-symmetric",
                f"only over ranges that are symmetric about 0 an output can be odd;"
                f" '{name}' goes {low:g} .. {high:g}",
                node.output.span,
            )


# --- The `lookup` block ---


def elaborate_lookup(node: LookupNode, scope: Scope) -> Lookup:
    """Return the settings of the ``lookup`` block."""
    items: dict[tuple[str, str | None], LookupItem] = {}  # by key and input; None: every input
    for item in node.items:
        if item.variable is not None and scope.variable(item.variable, "input") is None:
            continue
        which = item.key.text, item.variable.text if item.variable else None
        if which in items:
            message = f"'{item.key.text}' is set twice"
            scope.report("duplicate-setting", message, item.key.span)
        items[which] = item
    axes = []
    for name in scope.names("input"):
        levels = items.get(("levels", name), items.get(("levels", None)))
        bins = items.get(("bins", name), items.get(("bins", None)))
        axis = _axis(scope.drafts[name], levels, bins, scope)
        if axis is not None:
            axes.append(axis)
    if not any(key == "levels" for key, _ in items):
        scope.report("missing-levels", "the lookup block names no levels", node.span)
    return Lookup(tuple(axes), _rounding(items.get(("round", None)), scope))


def _axis(
    draft: Draft, levels: LookupItem | None, bins: LookupItem | None, scope: Scope
) -> LookupAxis | None:
    if levels is None:
        return None
    values = _levels(levels, scope)
    if values is None:
        return None
    low, high = range_of(draft.node)
    if not low <= values[0] <= values[-1] <= high:
        scope.report(
            "levels-outside-range",
            f"levels of '{draft.name}' lie outside its range {low:g} .. {high:g}",
            levels.span,
            severity=Severity.WARNING,
        )
    return LookupAxis(draft.name, values, _bins(bins, values, scope) if bins else None)


def _levels(item: LookupItem, scope: Scope) -> tuple[float, ...] | None:
    figures = [figure.value for figure in item.figures]
    span = item.figures[0].span.to(item.figures[-1].span)
    if item.form == "list":
        if len(figures) < 2 or any(b <= a for a, b in itertools.pairwise(figures)):
            scope.report("bad-levels", "levels must be two or more increasing numbers", span)
            return None
        return tuple(figures)
    low, high, third = figures
    if not low < high:
        scope.report("bad-levels", "levels must go from a lower to a higher number", span)
        return None
    if item.form == "count":
        intervals = third - 1.0
        fits = math.isfinite(third) and third == int(third) and third >= 2
    else:
        intervals = (high - low) / third if third > 0.0 else 0.0
        finite = math.isfinite(intervals)
        fits = finite and intervals >= 1 and abs(intervals - round(intervals)) < 1e-6
    if not fits:
        scope.report(
            "bad-levels",
            f"the {item.form} {third:g} does not divide the levels {low:g} .. {high:g}",
            item.figures[2].span,
        )
        return None
    if intervals >= MAX_LEVELS:
        scope.report("too-many-levels", f"more than {MAX_LEVELS:,} levels", span)
        return None
    return even_levels(low, high, round(intervals))


def _bins(item: LookupItem, levels: tuple[float, ...], scope: Scope) -> tuple[float, ...] | None:
    values = [figure.value for figure in item.figures]
    span = item.figures[0].span.to(item.figures[-1].span)
    if item.form == "mirrored":
        values = [-value for value in reversed(values)] + values
    if any(b <= a for a, b in itertools.pairwise(values)):
        what = "positive and increasing" if item.form == "mirrored" else "increasing"
        scope.report("bad-bins", f"bins must be {what}", span)
        return None
    if len(values) != len(levels) - 1:
        scope.report(
            "bad-bins",
            f"{len(levels)} levels need {len(levels) - 1} thresholds, found {len(values)}",
            span,
        )
        return None
    return tuple(values)


def _rounding(item: LookupItem | None, scope: Scope) -> float | None:
    if item is None:
        return None
    figure = item.figures[0]
    if not figure.value > 0.0:
        scope.report("bad-round", "the rounding step must be above 0", figure.span)
        return None
    return figure.value


# --- The `tune` block ---

MOST_GAP = 50.0
"""Of neighbouring peaks, percent of the range."""


def elaborate_tuning(node: TuneNode, scope: Scope) -> Tuning:
    """Return what the ``tune`` block lets move, as far as it is sound."""
    peaks: list[PeakTuning] = []
    gains: list[GainTuning] = []
    kept: list[tuple[str, str]] = []
    moved: set[str] = set()
    for item in node.items:
        if item.key.text == "peaks":
            _report_twice(item, moved, scope)
            found = _peaks(item, scope)
            peaks += [found] if found.variables else []
        elif item.key.text == "gain":
            _report_twice(item, moved, scope)
            gains += [_tuned_gain(item)] if _sound_range(item, scope) else []
        else:
            draft = scope.variable(item.names[0])
            terms = [scope.term(draft, word) for word in item.terms]
            names = [term.name for term in terms if term is not None]
            if draft is not None and len(names) == len(item.terms):
                kept += [(draft.name, name) for name in names or [""]]
    return Tuning(tuple(peaks), tuple(gains), tuple(kept))


def _report_twice(item: TuneItem, moved: set[str], scope: Scope) -> None:
    for word in item.names:
        name = f"{item.key.text} {word.text}"
        if name in moved:
            scope.report("duplicate-setting", f"'{word.text}' is tuned twice", word.span)
        moved.add(name)


def _peaks(item: TuneItem, scope: Scope) -> PeakTuning:
    drafts = [scope.variable(word) for word in item.names]
    for draft, word in zip(drafts, item.names, strict=True):
        if draft is not None and not all(map(math.isfinite, range_of(draft.node))):
            message = f"'{draft.name}' has no finite range for its peaks to move in"
            scope.report("bad-range", message, word.span)
    gap = {}
    if item.gap is not None:
        if not 0.0 <= item.gap.value <= MOST_GAP:
            message = f"a gap is 0 to {MOST_GAP:g} percent of the range"
            scope.report("bad-range", message, item.gap.span)
        gap["gap"] = item.gap.value / 100.0
    return PeakTuning(
        tuple(draft.name for draft in drafts if draft is not None),
        "mirrored" in item.words,
        "keep order" in item.words,
        "partition" in item.words,
        **gap,
    )


def _sound_range(item: TuneItem, scope: Scope) -> bool:
    assert item.low is not None
    assert item.high is not None
    span, before = item.low.span.to(item.high.span), len(scope.diagnostics)
    if not item.low.value < item.high.value:
        message = "the range of a gain must go from a lower to a higher number"
        scope.report("bad-range", message, span)
    elif {"times", "log"} & set(item.words) and not item.low.value > 0.0:
        scope.report("bad-range", "multiples and logarithms of a gain begin above 0", span)
    return len(scope.diagnostics) == before


def _tuned_gain(item: TuneItem) -> GainTuning:
    assert item.low is not None
    assert item.high is not None
    flags = ("times" in item.words, "log" in item.words, "per axis" in item.words)
    names = tuple(word.text for word in item.names)
    return GainTuning(names, item.low.value, item.high.value, *flags, item.span)


# --- The whole file ---

UNNAMED = "unnamed"


def elaborate(
    document: Document, memory: ParseMemory | None = None
) -> tuple[RuleBase, list[Diagnostic]]:
    """Return the rule base that `document` means, and what is wrong with it.

    Statements may stand in any order; where one is at fault it is left out, so the result
    is complete only if no diagnostic is an error. With a `memory`, rules that stand as they
    stood are not judged again.
    """
    memory = memory or ParseMemory()
    scope = Scope()
    nodes = [statement.node for statement in document.statements]
    scope.broken_variables = any(
        isinstance(node, Broken) and node.keyword in ("input", "output") for node in nodes
    )
    for node in nodes:
        if isinstance(node, VariableNode):
            declare_variable(node, scope)
    for role in ("input", "output"):
        if not scope.names(role) and not scope.broken_variables:
            scope.presumed |= _presumed(nodes, role)
    for node in nodes:
        if scope.overflows:
            break
        if isinstance(node, TermNode):
            add_term(node, scope)
        elif isinstance(node, EvenTermsNode):
            add_even_terms(node, scope)
    norms = _settings(nodes, scope)
    memory.enter_scope(_identity(scope))
    blocks = _blocks(nodes, scope, norms, memory)
    heading = _single(nodes, Heading, "heading", scope)
    rulebase = RuleBase(
        name=heading.name.text if heading else UNNAMED,
        inputs=tuple(_input(d) for d in scope.drafts.values() if d.is_input),
        outputs=tuple(_output(d) for d in scope.drafts.values() if not d.is_input),
        blocks=blocks,
        description=(heading.description or "") if heading else "",
        lookup=_lookup(nodes, scope),
        expectations=_expectations(nodes, scope),
        properties=_properties(nodes, scope),
        tuning=_tuning(nodes, scope),
    )
    _judge_whole(rulebase, nodes, scope)
    return rulebase, scope.diagnostics


def judge_statement(node: StatementNode, scope: Scope) -> None:
    """Add one statement to `scope`, below those that it has, and report what is wrong with it.

    For a rule base that is written statement by statement: what :func:`elaborate` would say of
    it at this point, but for what only the whole can tell.
    """
    if isinstance(node, VariableNode):
        declare_variable(node, scope)
    elif isinstance(node, TermNode):
        add_term(node, scope)
    elif isinstance(node, EvenTermsNode):
        add_even_terms(node, scope)
    elif isinstance(node, InferenceNode):
        apply_inference(node, scope, {})
    elif isinstance(node, BlockNode):
        block_norms(node, scope, {})
    elif isinstance(node, RuleNode | GridNode):
        _rules_of(node, scope, MAX_RULES, ParseMemory())
    elif isinstance(node, LookupNode):
        elaborate_lookup(node, scope)
    elif isinstance(node, ExpectNode):
        elaborate_expectation(node, scope)
    elif isinstance(node, ProveNode):
        elaborate_property(node, scope)


def _presumed(nodes: list[StatementNode], role: str) -> frozenset[str]:
    """Return the names that rules use as the inputs or outputs of the file."""
    outputs: set[str] = set()
    every: set[str] = set()
    for node in nodes:
        if isinstance(node, GridNode):
            outputs.update(part.output.text for part in node.parts)
        elif isinstance(node, RuleNode):
            outputs.update(consequent.variable.text for consequent in node.consequents)
        else:
            continue
        every.update(each.name for each in node.mentions() if each.kind is Kind.VARIABLE)
    return frozenset(outputs if role == "output" else every - outputs)


def _settings(nodes: list[StatementNode], scope: Scope) -> Norms:
    norms: Norms = {}
    lines = [node for node in nodes if isinstance(node, InferenceNode)]
    for node in sorted(lines, key=lambda line: line.target is not None):
        apply_inference(node, scope, norms)
    return norms


def _blocks(
    nodes: list[StatementNode], scope: Scope, norms: Norms, memory: ParseMemory
) -> tuple[RuleBlock, ...]:
    blocks: list[RuleBlock] = []
    rules: list[Rule] = []
    name, own = "", norms
    first_spans: dict[str, Span] = {}
    budget = MAX_RULES
    for node in nodes:
        if isinstance(node, BlockNode):
            if rules or name:
                blocks.append(RuleBlock(tuple(rules), name, **own))
            if node.name.text in first_spans:
                scope.report(
                    "duplicate-block",
                    f"two blocks are called '{node.name.text}'",
                    node.name.span,
                    related=(Related("first here", first_spans[node.name.text]),),
                )
            first_spans[node.name.text] = node.name.span
            rules, name, own = [], node.name.text, block_norms(node, scope, norms)
        elif isinstance(node, RuleNode | GridNode):
            if budget < 0 or scope.overflows:
                continue
            found = _rules_of(node, scope, budget, memory)
            budget -= len(found)
            if budget < 0:
                report_too_many(node.span, scope)
            rules += found
    if rules or name:
        blocks.append(RuleBlock(tuple(rules), name, **own))
    return tuple(blocks)


def _identity(scope: Scope) -> Hashable:
    """Return everything that the meaning of a rule depends on besides its own words."""
    drafts = scope.drafts.values()
    variables = tuple((d.name, d.is_input, d.node.name.span, *d.terms.values()) for d in drafts)
    return scope.broken_variables, variables


def _rules_of(
    node: RuleNode | GridNode, scope: Scope, budget: int, memory: ParseMemory
) -> list[Rule]:
    known = memory.recall_rules(node)
    if known is not None and len(known[0]) <= budget:
        scope.diagnostics += known[1]
        return known[0]
    before = len(scope.diagnostics)
    if isinstance(node, RuleNode):
        found = elaborate_rule(node, scope)
    else:
        found = [rule for part in node.parts for rule in elaborate_grid(part, scope, budget)]
    if not scope.overflows:  # else it may have been given up half-way
        memory.keep_rules(node, found, scope.diagnostics[before:])
    return found


def _lookup(nodes: list[StatementNode], scope: Scope) -> Lookup | None:
    node = _single(nodes, LookupNode, "lookup block", scope)
    return elaborate_lookup(node, scope) if node else None


def _tuning(nodes: list[StatementNode], scope: Scope) -> Tuning | None:
    node = _single(nodes, TuneNode, "tune block", scope)
    return elaborate_tuning(node, scope) if node else None


def _expectations(nodes: list[StatementNode], scope: Scope) -> tuple[Expectation, ...]:
    found = [
        elaborate_expectation(n, scope)
        for n in nodes
        if isinstance(n, ExpectNode) and not scope.overflows
    ]
    return tuple(expectation for expectation in found if expectation is not None)


def _properties(nodes: list[StatementNode], scope: Scope) -> tuple[Property, ...]:
    found = [
        elaborate_property(n, scope)
        for n in nodes
        if isinstance(n, ProveNode) and not scope.overflows
    ]
    return tuple(each for each in found if each is not None)


_Node = TypeVar("_Node", bound=StatementNode)


def _single(nodes: list[StatementNode], kind: type[_Node], what: str, scope: Scope) -> _Node | None:
    found = [node for node in nodes if isinstance(node, kind)]
    for extra in found[1:MAX_DIAGNOSTICS]:
        scope.report(
            "duplicate-statement",
            f"a file has only one {what}",
            extra.span,
            related=(Related("first here", found[0].span),),
        )
    return found[0] if found else None


def _input(draft: Draft) -> Input:
    node = draft.node
    return Input(
        draft.name,
        *range_of(node),
        tuple(draft.terms.values()),
        node.description or "",
        draft.outside,
        node.name.span,
    )


def _output(draft: Draft) -> Output:
    node = draft.node
    return Output(
        draft.name,
        *range_of(node),
        tuple(draft.terms.values()),
        node.description or "",
        draft.outside,
        node.name.span,
        draft.aggregation,
        draft.defuzzifier,
        draft.no_rule,
    )


def _judge_whole(rulebase: RuleBase, nodes: list[StatementNode], scope: Scope) -> None:
    broken = {node.keyword for node in nodes if isinstance(node, Broken)}
    end = nodes[-1].span if nodes else NOWHERE
    if not any(isinstance(node, Heading) for node in nodes) and "rulebase" not in broken:
        scope.report(
            "missing-heading",
            "the file does not say what it is",
            nodes[0].span if nodes else NOWHERE,
            hint='start it with  rulebase NAME "what it is for"',
            severity=Severity.WARNING,
        )
    for what, count in (("input", len(rulebase.inputs)), ("output", len(rulebase.outputs))):
        if count == 0 and what not in broken:
            used = [
                mention
                for node in nodes
                for mention in node.mentions()
                if mention.kind is Kind.VARIABLE and mention.name in _presumed(nodes, what)
            ]
            first = min(used, key=lambda mention: mention.span, default=None)
            scope.report(
                f"no-{what}s",
                f"the file declares no {what}",
                end if first is None else first.span,
                hint=f"declare it with  {what} {name_text(first.name)} LOW .. HIGH"
                if first
                else "",
            )
    has_rules = any(isinstance(node, RuleNode | GridNode) for node in nodes)
    if not has_rules and not broken & {"rule", "rules"}:
        scope.report("no-rules", "the file has no rules", end)
    _judge_chain(rulebase, scope)


def _judge_chain(rulebase: RuleBase, scope: Scope) -> None:
    """Demand that an output used as an input is complete before the block that uses it."""
    outputs = {output.name for output in rulebase.outputs}
    last = last_conclusions(rulebase)
    for index, block in enumerate(rulebase.blocks):
        for rule in block.rules:
            for proposition in propositions(rule.antecedent):
                name = proposition.variable
                if name not in outputs:
                    continue
                if name not in last:
                    scope.report(
                        "unassigned-output",
                        f"the output '{name}' is asked for here, but no rule sets it",
                        proposition.span,
                    )
                elif last[name] >= index:
                    scope.report(
                        "cyclic-blocks",
                        f"the output '{name}' is asked for here, but rules set it in this block"
                        " or a later one",
                        proposition.span,
                        hint="put the rule into a block after those that set the output",
                    )
