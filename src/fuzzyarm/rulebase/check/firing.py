"""Inputs for which no rule fires, with one such input as evidence."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from math import prod

from fuzzyarm.rulebase.check.coverage import FAINT
from fuzzyarm.rulebase.check.subject import Subject
from fuzzyarm.rulebase.diagnostic import Diagnostic, Severity
from fuzzyarm.rulebase.geometry import probe_points
from fuzzyarm.rulebase.membership import membership
from fuzzyarm.rulebase.model import And, Input, Is, Output, Rule, RuleBase, RuleBlock, propositions
from fuzzyarm.rulebase.truth import truth

_MOST_POINTS = 40_000
_POSITIVE_NORMS = ("min", "product", "hamacher", "einstein")
"""Conjunctions that are positive wherever all their operands are."""


def find(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``no-rule-fires`` for each output with a point of the inputs that fires nothing."""
    rulebase = subject.rulebase
    for output in rulebase.outputs:
        evidence = silent_point(rulebase, output)
        if evidence is None:
            continue
        point = ", ".join(f"{name} = {value:g}" for name, value in evidence.items())
        stated = output.no_rule != "error"
        yield Diagnostic(
            "no-rule-fires",
            f"no rule for '{output.name}' fires at {point}",
            output.span,
            # Where the file says what happens then, the author has thought of it.
            severity=Severity.INFO if stated else Severity.WARNING,
            hint="" if stated else "add a rule, or say what happens then: inference no-rule …",
        )


def silent_point(rulebase: RuleBase, output: Output) -> dict[str, float] | None:
    """Return a point of the inputs at which no rule for `output` fires; None if none is found.

    Every combination of stretches between corners of the terms is tried, up to a limit; beyond
    that the stretches are thinned evenly.
    """
    rules = [
        (block, rule)
        for block in rulebase.blocks
        for rule in block.rules
        if rule.weight > 0.0 and any(c.variable == output.name for c in rule.consequents)
    ]
    names = {v.name for v in rulebase.inputs}
    used = {p.variable for _, rule in rules for p in propositions(rule.antecedent)}
    if not rules or not used <= names:
        return None  # unused, or a chained output decides: its range is not known here
    variables = [v for v in rulebase.inputs if v.name in used and v.terms]
    grids = _thinned([_active_terms(variable) for variable in variables])
    index = _plain_index([(b, r) for b, r in rules if _is_plain(b, r)])
    others = [(b, r) for b, r in rules if not _is_plain(b, r)]
    if not others and _fires_everywhere(index, [v.name for v in variables], grids):
        return None
    for cell in product(*grids):
        active = {v.name: terms for v, (_, terms) in zip(variables, cell, strict=True)}
        if _plain_fires(index, active) or _other_fires(others, active):
            continue
        point = {v.name: x for v, (x, _) in zip(variables, cell, strict=True)}
        rest = {v.name: 0.5 * (v.low + v.high) for v in rulebase.inputs if v.name not in point}
        return {v.name: {**point, **rest}[v.name] for v in rulebase.inputs}
    return None


_Active = tuple[float, dict[str, float]]


def _active_terms(variable: Input) -> list[_Active]:
    """Return each probe point with the degrees of the terms that hold there."""
    found = []
    for x in probe_points(variable):
        degrees = {term.name: membership(term.shape, x) for term in variable.terms}
        found.append((x, {name: d for name, d in degrees.items() if d >= FAINT}))
    return found


def _thinned(grids: list[list[_Active]]) -> list[list[_Active]]:
    """Return the grids with every other point of the longest left out until few enough remain."""
    while prod(map(len, grids)) > _MOST_POINTS:
        longest = max(range(len(grids)), key=lambda i: len(grids[i]))
        if len(grids[longest]) == 1:
            break
        grids[longest] = grids[longest][1::2]
    return grids


def _is_plain(block: RuleBlock, rule: Rule) -> bool:
    operands = rule.antecedent.operands if isinstance(rule.antecedent, And) else (rule.antecedent,)
    positive = len(operands) == 1 or block.conjunction in _POSITIVE_NORMS
    return positive and all(isinstance(o, Is) and not o.hedges for o in operands)


_Index = dict[tuple[str, ...], set[tuple[str, ...]]]


def _plain_index(rules: list[tuple[RuleBlock, Rule]]) -> _Index:
    """Return the term combinations of plain rules by the variables they ask for."""
    index: _Index = {}
    for _, rule in rules:
        pairs = [(p.variable, p.term) for p in propositions(rule.antecedent)]
        key = tuple(variable for variable, _ in pairs)
        index.setdefault(key, set()).add(tuple(term for _, term in pairs))
    return index


def _plain_fires(index: _Index, active: dict[str, dict[str, float]]) -> bool:
    return any(
        any(terms in wanted for terms in product(*(active[name] for name in names)))
        for names, wanted in index.items()
    )


def _fires_everywhere(index: _Index, names: list[str], grids: list[list[_Active]]) -> bool:
    """Whether plain rules fire at every point: to ask where the fewest terms hold is enough."""
    fewest = [[(0.0, dict.fromkeys(terms, 1.0)) for terms in _smallest(grid)] for grid in grids]
    return all(
        _plain_fires(index, {n: terms for n, (_, terms) in zip(names, cell, strict=True)})
        for cell in product(*fewest)
    )


def _smallest(grid: list[_Active]) -> list[frozenset[str]]:
    """Return the sets of terms in `grid` of which no other one is a part."""
    smallest: list[frozenset[str]] = []
    for terms in sorted({frozenset(terms) for _, terms in grid}, key=len):
        if not any(known <= terms for known in smallest):
            smallest.append(terms)
    return smallest


def _other_fires(rules: list[tuple[RuleBlock, Rule]], active: dict[str, dict[str, float]]) -> bool:
    def degree(variable: str, term: str) -> float:
        return active[variable].get(term, 0.0)

    return any(truth(rule.antecedent, degree, block) >= FAINT for block, rule in rules)
