"""Reorder the rules of a table so that the language writes them as a grid.

Other programs write one line for each rule, often with several outputs, and conditions in any
order. :func:`in_tables` keeps the meaning.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from itertools import chain, groupby
from math import prod

from fuzzyarm.language.model.rulebase import And, Is, Rule, RuleBase, RuleBlock, propositions

_FEWEST = 4
"""Fewest rules worth a grid."""

_ANY_ORDER = frozenset({"min", "product"})
"""Conjunctions of three and more degrees that commute but for rounding."""

_Order = dict[tuple[str, str], int]  # (variable, term) → index of the term
_Key = tuple[frozenset[str], tuple[str, ...]]  # inputs and outputs of a rule


def in_tables(rulebase: RuleBase) -> RuleBase:
    """Return the rule base with the rules of each table in a row, row by row.

    Rules with several conclusions become a table for each output. Conditions are ordered as row,
    column, then the fixed ones of a table of more than two inputs (``when …``).
    """
    outputs = {output.name for output in rulebase.outputs}
    order = {
        (variable.name, term.name): index
        for variable in rulebase.inputs
        for index, term in enumerate(variable.terms)
    }
    blocks = tuple(_ordered(block, order, outputs) for block in rulebase.blocks)
    return replace(rulebase, blocks=blocks)


def _ordered(block: RuleBlock, order: _Order, outputs: set[str]) -> RuleBlock:
    names = {part.variable for rule in block.rules for part in propositions(rule.antecedent)}
    if names & outputs:
        return block  # the order of its rules may matter
    tables: dict[_Key, dict[frozenset[tuple[str, str]], Rule]] = {}
    pieces: list[_Key | Rule] = []  # in text order, a table at its first rule
    for rule in block.rules:
        key = _key(rule, block)
        table = tables.setdefault(key, {}) if key is not None else {}
        cell = frozenset((part.variable, part.term) for part in propositions(rule.antecedent))
        if key is None or cell in table:
            pieces.append(rule)
            continue
        if not table:
            pieces.append(key)
        table[cell] = rule
    rules: list[Rule] = []
    for piece in pieces:
        if isinstance(piece, Rule):
            rules.append(piece)
        else:
            rules += _table(list(tables[piece].values()), order)
    return replace(block, rules=tuple(rules))


def _key(rule: Rule, block: RuleBlock) -> _Key | None:
    """Return the key of a rule's table: a plain *and* of two and more inputs, else None."""
    antecedent = rule.antecedent
    if not isinstance(antecedent, And) or not rule.consequents:
        return None
    if any(consequent.hedges for consequent in rule.consequents):
        return None
    parts = antecedent.operands
    inputs = frozenset(part.variable for part in parts if isinstance(part, Is) and not part.hedges)
    if len(inputs) < len(parts) or (len(parts) > 2 and block.conjunction not in _ANY_ORDER):
        return None
    concluded = tuple(consequent.variable for consequent in rule.consequents)
    return (inputs, concluded) if len(set(concluded)) == len(concluded) else None


def _table(rules: list[Rule], order: _Order) -> list[Rule]:
    """Return rules over the same inputs in the order of their grids, the rest last."""
    terms = {(p.variable, p.term) for rule in rules for p in propositions(rule.antecedent)}
    counts = Counter(variable for variable, _ in terms)
    inputs = [part.variable for part in propositions(rules[0].antecedent)]

    def cell(rule: Rule, names: list[str]) -> list[int]:
        at = {p.variable: order[p.variable, p.term] for p in propositions(rule.antecedent)}
        return [at[name] for name in names]

    def cost(way: list[str]) -> tuple[int, bool]:
        cells = [cell(rule, way) for rule in rules]
        return prod(counts[name] for name in way[:-2]), cells != sorted(cells)

    # Orders from the slowest index to the fastest: the language's, the text's, its reverse, and the
    # longest rows and columns. The fewest grids win, then an order that needs no sorting.
    longest = sorted(inputs, key=lambda name: counts[name])
    way = min([[*inputs[2:], *inputs[:2]], inputs, inputs[::-1], longest], key=cost)
    arranged = sorted(rules, key=lambda rule: cell(rule, way))
    parts = [list(part) for _, part in groupby(arranged, lambda rule: cell(rule, way[:-2]))]
    full = [part for part in parts if _is_full([cell(rule, way[-2:]) for rule in part])]
    in_full = list(chain.from_iterable(full))
    names = [*way[-2:], *way[:-2]]
    grid_rules = [
        replace(_with_conditions(rule, names), consequents=(rule.consequents[index],))
        for index in range(len(rules[0].consequents))
        for rule in in_full
    ]
    remaining = set(map(id, rules)) - set(map(id, in_full))
    return grid_rules + [rule for rule in rules if id(rule) in remaining]


def _is_full(cells: list[list[int]]) -> bool:
    rows, columns = map(set, zip(*cells, strict=True))
    return len(cells) >= max(_FEWEST, 0.5 * len(rows) * len(columns))


def _with_conditions(rule: Rule, names: list[str]) -> Rule:
    parts = {part.variable: part for part in propositions(rule.antecedent)}
    return replace(rule, antecedent=And(tuple(parts[name] for name in names)))
