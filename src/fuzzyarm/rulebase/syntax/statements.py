"""Read each kind of statement from its tokens."""

from __future__ import annotations

from collections.abc import Callable

from fuzzyarm.rulebase.diagnostic import Diagnostic
from fuzzyarm.rulebase.shapes import EVEN_SHAPES
from fuzzyarm.rulebase.syntax.cursor import Cursor, Fault
from fuzzyarm.rulebase.syntax.expressions import read_consequents, read_expression
from fuzzyarm.rulebase.syntax.grids import read_grid
from fuzzyarm.rulebase.syntax.lines import BlockLine, Group
from fuzzyarm.rulebase.syntax.nodes import (
    BlockNode,
    EvenTermsNode,
    ExpectNode,
    Figure,
    Heading,
    InferenceNode,
    LookupItem,
    LookupNode,
    OutcomeNode,
    RuleNode,
    StatementNode,
    TermNode,
    VariableNode,
    Word,
)
from fuzzyarm.rulebase.syntax.settings import read_settings
from fuzzyarm.rulebase.syntax.shapes import read_shape
from fuzzyarm.rulebase.syntax.words import LOOKUP_ITEMS


def read_statement(group: Group, diagnostics: list[Diagnostic]) -> StatementNode:
    """Read one statement; raise a Fault where it cannot be understood."""
    cursor = Cursor(group.tokens)
    if group.keyword == "rules":
        return read_grid(cursor, group.lines, diagnostics)
    if group.keyword == "lookup":
        return _lookup(cursor, group.lines, diagnostics)
    node = _READERS[group.keyword](cursor)
    diagnostics += cursor.forgiven
    cursor.finish()
    return node


def _heading(cursor: Cursor) -> Heading:
    cursor.take()
    return Heading(cursor.name("the name of the rule base"), cursor.string(), cursor.whole)


def _variable(cursor: Cursor) -> VariableNode:
    role = cursor.take().text
    name = cursor.name(f"the name of the {role}")
    try:
        low = cursor.figure("the lower end of the range", finite=False)
        cursor.expect("..", "between the ends of the range")
        high = cursor.figure("the upper end of the range", finite=False)
    except Fault as fault:
        cursor.forgive(fault)
        return VariableNode(role, name, None, None, None, cursor.whole)
    return VariableNode(role, name, low, high, cursor.string(), cursor.whole)


def _even_terms(cursor: Cursor) -> EvenTermsNode:
    cursor.take()
    variables = [cursor.name("the name of a variable")]
    while cursor.accept(","):
        variables.append(cursor.name("the name of a variable"))
    cursor.expect(":", "after the variables")
    family = _family(cursor)
    names = []
    while not cursor.at_end:
        names.append(cursor.name("the name of a term"))
    if not names:
        cursor.fail("the names of the terms, from low to high")
    return EvenTermsNode(tuple(variables), family, tuple(names), cursor.whole)


def _family(cursor: Cursor) -> Word:
    token = cursor.peek()
    try:
        return cursor.word("how the terms are shaped", tuple(EVEN_SHAPES), "unknown-shape")
    except Fault as fault:
        if token is None or token.kind != "name":
            raise
        cursor.forgiven.append(fault.diagnostic)
        cursor.take()
        return Word("triangles", token.span)


def _term(cursor: Cursor) -> TermNode:
    cursor.take()
    variable = cursor.name("the name of a variable")
    name = cursor.name("the name of the term")
    try:
        cursor.expect(":", "after the name of the term")
        shape = read_shape(cursor)
        cursor.finish()
    except Fault as fault:
        cursor.forgive(fault)
        shape = None
    return TermNode(variable, name, shape, cursor.whole)


def _inference(cursor: Cursor) -> InferenceNode:
    cursor.take()
    target: Word | None = None
    second = cursor.peek(1)
    if second is not None and second.kind == "mark" and second.text == ":":
        target = cursor.name("the name of a variable")
        cursor.take()
    return InferenceNode(target, read_settings(cursor), cursor.whole)


def _block(cursor: Cursor) -> BlockNode:
    cursor.take()
    name = cursor.name("the name of the block")
    settings = read_settings(cursor) if cursor.accept(":") else ()
    return BlockNode(name, settings, cursor.whole)


def _rule(cursor: Cursor) -> RuleNode:
    cursor.take()
    cursor.expect("if", "after 'rule'")
    antecedent = read_expression(cursor)
    cursor.expect("then", "after the antecedent")
    consequents = read_consequents(cursor)
    weight = cursor.figure("the weight of the rule") if cursor.accept("with") else None
    return RuleNode(antecedent, consequents, weight, cursor.whole)


def _expect(cursor: Cursor) -> ExpectNode:
    cursor.take()
    inputs = [_assignment(cursor)]
    while cursor.accept(","):
        inputs.append(_assignment(cursor))
    cursor.expect("->", "after the inputs")
    outcomes = [_outcome(cursor)]
    while cursor.accept(","):
        outcomes.append(_outcome(cursor))
    return ExpectNode(tuple(inputs), tuple(outcomes), cursor.whole)


def _assignment(cursor: Cursor) -> tuple[Word, Figure]:
    name = cursor.name("the name of an input")
    cursor.expect("=", f"after '{name.text}'")
    return name, cursor.figure("a number")


def _outcome(cursor: Cursor) -> OutcomeNode:
    name = cursor.name("the name of an output")
    other: Figure | None = None
    for relation in ("=", "<=", ">=", "<", ">", "in"):
        if cursor.accept(relation):
            break
    else:
        cursor.fail("one of = < <= > >= in")
    value = cursor.figure("a number")
    if relation == "in":
        cursor.expect("..", "between the ends of the interval")
        other = cursor.figure("a number")
    elif relation == "=" and cursor.accept("within"):
        other = cursor.figure("the tolerance")
    return OutcomeNode(name, relation, value, other)


def _lookup(cursor: Cursor, lines: list[BlockLine], diagnostics: list[Diagnostic]) -> LookupNode:
    cursor.take()
    cursor.finish()
    items = []
    for line in lines:
        try:
            items.append(_lookup_item(Cursor(line.tokens), line))
        except Fault as fault:
            diagnostics.append(fault.diagnostic)
    return LookupNode(tuple(items), cursor.whole)


def _lookup_item(cursor: Cursor, line: BlockLine) -> LookupItem:
    key = cursor.word("levels, bins or round", LOOKUP_ITEMS, "unknown-setting")
    variable: Word | None = None
    second = cursor.peek(1)
    if second is not None and second.kind == "mark" and second.text == ":":
        variable = cursor.name("the name of an input")
        cursor.take()
    form = "list"
    figures = [cursor.figure("a number")]
    if key.text == "levels" and cursor.accept(".."):
        figures.append(cursor.figure("the last level"))
        form = cursor.word("'step' or 'count'", ("step", "count"), "unexpected-token").text
        figures.append(cursor.figure(f"the {form}"))
    while form == "list" and key.text != "round" and cursor.at_figure:
        figures.append(cursor.figure("a number"))
    if key.text == "bins" and cursor.accept("mirrored"):
        form = "mirrored"
    cursor.finish()
    return LookupItem(key, variable, form, tuple(figures), line.trivia, cursor.whole)


_READERS: dict[str, Callable[[Cursor], StatementNode]] = {
    "rulebase": _heading,
    "input": _variable,
    "output": _variable,
    "terms": _even_terms,
    "term": _term,
    "inference": _inference,
    "block": _block,
    "rule": _rule,
    "expect": _expect,
}
