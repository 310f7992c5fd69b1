"""Print antecedents and consequents, with parentheses only where the tree needs them."""

from __future__ import annotations

from fuzzyarm.rulebase.printing.words import hedges_text, word_text
from fuzzyarm.rulebase.syntax.nodes import (
    ExpressionNode,
    HedgedNode,
    JunctionNode,
    PropositionNode,
)


def proposition_text(node: PropositionNode) -> str:
    """Return ``variable is [hedges] term``."""
    return f"{word_text(node.variable)} is {hedges_text(node.hedges)}{word_text(node.term)}"


def expression_text(node: ExpressionNode) -> str:
    """Return the text of an antecedent that reads back to the same tree."""
    if isinstance(node, PropositionNode):
        return proposition_text(node)
    if isinstance(node, HedgedNode):
        return f"{hedges_text(node.hedges)}({expression_text(node.operand)})"
    return f" {node.word} ".join(_operand(operand, node) for operand in node.operands)


def _operand(operand: ExpressionNode, parent: JunctionNode) -> str:
    text = expression_text(operand)
    if isinstance(operand, JunctionNode) and not (parent.word == "or" and operand.word == "and"):
        return f"({text})"
    return text
