"""Rules in words."""

from __future__ import annotations

from fuzzyarm.rulebase.model import Rule
from fuzzyarm.rulebase.printing.expressions import expression_text, proposition_text
from fuzzyarm.rulebase.printing.words import figure_text
from fuzzyarm.rulebase.printing.writer import rule_node


def rule_sentence(rule: Rule) -> str:
    """Return a rule as one ``if … then …`` sentence, wherever it stood."""
    node = rule_node(rule)
    consequents = " and ".join(map(proposition_text, node.consequents))
    weight = f" with {figure_text(node.weight)}" if node.weight else ""
    return f"if {expression_text(node.antecedent)} then {consequents}{weight}"
