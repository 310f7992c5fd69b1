"""Read antecedents and consequents. ``and`` binds tighter than ``or``."""

from __future__ import annotations

from fuzzyarm.rulebase.diagnostic import Diagnostic
from fuzzyarm.rulebase.limits import MAX_NESTING
from fuzzyarm.rulebase.syntax.cursor import Cursor, Fault
from fuzzyarm.rulebase.syntax.nodes import (
    ExpressionNode,
    HedgedNode,
    HedgeNode,
    JunctionNode,
    PropositionNode,
    Word,
)
from fuzzyarm.rulebase.syntax.tokens import Token
from fuzzyarm.rulebase.syntax.words import HEDGE_WORDS


def read_expression(cursor: Cursor, depth: int = 0) -> ExpressionNode:
    """Read a disjunction of conjunctions of propositions."""
    if depth > MAX_NESTING:
        raise Fault(
            Diagnostic(
                "too-deep", f"parentheses nest deeper than {MAX_NESTING} levels", cursor.span
            )
        )
    operands = [_conjunction(cursor, depth)]
    while cursor.accept("or"):
        operands.append(_conjunction(cursor, depth))
    return operands[0] if len(operands) == 1 else JunctionNode("or", tuple(operands))


def _conjunction(cursor: Cursor, depth: int) -> ExpressionNode:
    operands = [_operand(cursor, depth)]
    while cursor.accept("and"):
        operands.append(_operand(cursor, depth))
    return operands[0] if len(operands) == 1 else JunctionNode("and", tuple(operands))


def _operand(cursor: Cursor, depth: int) -> ExpressionNode:
    hedges = read_hedges(cursor)
    if cursor.accept("("):
        inner = read_expression(cursor, depth + 1)
        cursor.expect(")", "to close the parenthesis")
        return HedgedNode(hedges, inner) if hedges else inner
    if hedges:
        cursor.fail("'(' after the hedge (or write the hedge behind 'is')")
    return read_proposition(cursor, "the name of a variable")


def read_proposition(cursor: Cursor, what: str) -> PropositionNode:
    """Read ``variable is [hedges] term``."""
    variable = cursor.name(what)
    cursor.expect("is", f"after the variable '{variable.text}'")
    hedges = read_hedges(cursor)
    term = cursor.name(f"a term of '{variable.text}'")
    following = cursor.peek()
    if following is not None and following.kind == "name" and _is_misspelt_hedge(cursor):
        from fuzzyarm.rulebase.near import near_hint

        hint, replacement = near_hint(term.text, HEDGE_WORDS)
        raise Fault(
            Diagnostic(
                "unknown-hedge",
                f"'{term.text}' is no hedge",
                term.span,
                hint=hint or f"hedges are {', '.join(HEDGE_WORDS)}",
                replacement=replacement,
            )
        )
    return PropositionNode(variable, hedges, term)


def _is_misspelt_hedge(cursor: Cursor) -> bool:
    token = cursor.peek()
    return token is not None and token.text not in ("and", "or", "then", "with")


def read_hedges(cursor: Cursor) -> tuple[HedgeNode, ...]:
    """Read hedge words, none or several."""
    hedges: list[HedgeNode] = []
    while True:
        token = cursor.peek()
        if token is None or token.kind != "name" or token.text not in HEDGE_WORDS:
            return tuple(hedges)
        if token.text == "power" and not _opens(cursor.peek(1)):
            return tuple(hedges)
        cursor.take()
        exponent = None
        if token.text == "power":
            cursor.expect("(", "after power")
            exponent = cursor.figure("the exponent")
            cursor.expect(")", "after the exponent")
        hedges.append(HedgeNode(Word(HEDGE_WORDS[token.text], token.span), exponent))


def _opens(token: Token | None) -> bool:
    return token is not None and token.kind == "mark" and token.text == "("


def read_consequents(cursor: Cursor) -> tuple[PropositionNode, ...]:
    """Read one or more consequents, joined by ``and`` or commas."""
    consequents = [read_proposition(cursor, "the name of an output")]
    while cursor.accept("and") or cursor.accept(","):
        consequents.append(read_proposition(cursor, "the name of an output"))
    return tuple(consequents)
