"""The meaning of rules: sentences and grids as rules of the model."""

from __future__ import annotations

from fuzzyarm.base.diagnostic import (
    MAX_RULES,
    Figure,
    Related,
    Span,
    Word,
)
from fuzzyarm.language.declarations import (
    Draft,
    Scope,
)
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Expression,
    Hedge,
    Hedged,
    Is,
    Or,
    Rule,
)
from fuzzyarm.language.phrases import ExpressionNode, HedgedNode, HedgeNode, PropositionNode
from fuzzyarm.language.rules import GridNode, RowNode, RuleNode
from fuzzyarm.language.tokens import name_text
from fuzzyarm.symbolic.kinds import HEDGES, SHAPES


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
    if _lacks_header(node, scope):
        return []
    condition = None if node.condition is None else _expression(node.condition, scope)
    row = scope.variable(node.row) if node.row is not None else None
    column = scope.variable(node.column)
    columns = [_antecedent_term(column, word, scope) for word in node.columns]
    _report_repeated(node.columns, "column", scope)
    _report_repeated(tuple(r.label for r in node.rows), "row", scope)
    if node.row is not None and row is not None and row is column:
        scope.report("same-variable", f"rows and columns are both '{node.row}'", node.column.span)
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
    # Only now: cells are judged even where the output or the condition is at fault.
    sound = node.condition is None or condition is not None
    return rules if sound and output is not None else []


def _lacks_header(node: GridNode, scope: Scope) -> bool:
    """Report a grid whose first line is a row, with the missing header."""
    label = node.column
    if node.row is not None or label in scope.drafts:
        return False
    inputs = [draft for draft in scope.drafts.values() if draft.is_input]
    down = next((draft for draft in inputs if label in draft.terms), None)
    if down is None:
        return False
    count = len(node.columns)
    others = [draft for draft in inputs if draft is not down and len(draft.terms) == count]
    across = others[0] if others else None
    names = [down.name, across.name if across is not None else "…"]
    terms = "  ".join(map(name_text, across.terms)) if across is not None else "…"
    corner = " \\ ".join(map(name_text, names))
    scope.report(
        "missing-header",
        f"the grid for '{node.output}' begins with a row: the header is missing",
        node.header_span,
        hint=f"write  {corner}  {terms}  above",
    )
    return True


def _turned(node: GridNode, scope: Scope) -> GridNode:
    """Return the intended grid for a header with rows and columns exchanged."""
    if node.row is None or not node.rows:
        return node
    down, across = scope.drafts.get(node.row), scope.drafts.get(node.column)
    if down is None or across is None:
        return node
    columns = set(node.columns)
    labels = {row.label for row in node.rows}
    fits = columns <= across.terms.keys() and labels <= down.terms.keys()
    if fits or not (columns <= down.terms.keys() and labels <= across.terms.keys()):
        return node
    corner = f"{name_text(node.column)} \\ {name_text(node.row)}"
    scope.report(
        "transposed-header",
        f"the header has rows and columns the wrong way round: '{down.name}' goes across",
        node.row.span.to(node.column.span),
        hint=f"write  {corner}",
        replacement=corner,
    )
    return node._replace(row=node.column, column=node.row)


def _judge_single_row(node: GridNode, scope: Scope) -> None:
    output = name_text(node.output)
    for line in node.rows:
        if line.label == node.output:
            continue
        hint, replacement = "a grid over two inputs has a header like  e \\ ce  NB ZE PB", output
        if len(line.cells) == len(node.columns) - 1:  # the first cell was read as the label
            replacement = f"{output} {name_text(line.label)}"
            hint = f"begin the row with it: {replacement} …"
        scope.report(
            "bad-row-label",
            f"the row of a grid over one input is labelled with the output '{node.output}'",
            line.label.span,
            hint=hint,
            replacement=replacement if len(node.rows) == 1 else None,
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
    # One flat `and`, as in the same rule written as a sentence.
    extra = condition.operands if isinstance(condition, And) else (condition,)
    rest = tuple(operand for operand in extra if operand is not None)
    # Not strict: the parser has reported rows of another length.
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
    spans: dict[str, Span] = {}
    for word in words:
        if word in spans and not (what == "row" and not word):
            scope.report(
                f"repeated-{what}",
                f"the grid has two {what}s '{word}'",
                word.span,
                related=(Related("first here", spans[word]),),
            )
        spans.setdefault(word, word.span)


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
    proposition = _antecedent_term(scope.variable(node.variable), node.term, scope)
    if proposition is None:
        return None
    return Is(proposition.variable, proposition.term, _hedges(node.hedges, scope), node.span)


def _antecedent_term(draft: Draft | None, word: Word, scope: Scope) -> Is | None:
    term = scope.term(draft, word)
    if term is None or draft is None:
        return None
    if not SHAPES[term.shape.kind].fuzzy:
        scope.report(
            "not-a-fuzzy-set",
            f"'{word}' of '{draft.name}' is a value, not a set, so no rule can test it",
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
        if node.number is not None and not node.number > 0.0:
            what = HEDGES[node.word].parameters[0]
            if what == "exponent":
                scope.report("bad-exponent", "the exponent must be above 0", node.number.span)
        hedges.append(Hedge(str(node.word), None if node.number is None else float(node.number)))
    return tuple(hedges)


def _weight(figure: Figure | None, scope: Scope) -> float | None:
    if figure is None:
        return 1.0
    if not 0.0 <= figure <= 1.0:
        scope.report("bad-weight", "a weight must lie between 0 and 1", figure.span)
        return None
    return float(figure)


def report_too_many(span: Span, scope: Scope) -> None:
    """Report that the file has more rules than the limit."""
    scope.report("too-many-rules", f"more than {MAX_RULES:,} rules", span)
