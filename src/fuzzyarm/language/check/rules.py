"""Checks of rules: contradictory, said twice, folded into one.

Each check is a function from a subject to its findings; :mod:`.registry` runs them all.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from itertools import combinations, islice

from fuzzyarm.language.check.subject import Subject, plain_propositions
from fuzzyarm.language.statements import InferenceNode
from fuzzyarm.model.rulebase import (
    TAKAGI_SUGENO,
    Consequent,
    Expression,
    Hedged,
    Is,
    Or,
    Output,
    Rule,
)
from fuzzyarm.text.diagnostic import Diagnostic, Related

# --- Rules with the same antecedent: contradictory, or said twice ---


def conflicting_rules(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``contradictory-rules`` and ``duplicate-rule``."""
    for block in subject.rulebase.blocks:
        first: dict[Hashable, dict[str, tuple[Rule, Consequent]]] = {}
        for rule in block.rules:
            known = first.setdefault(_key(rule.antecedent), {})
            for consequent in rule.consequents:
                if consequent.variable not in known:
                    known[consequent.variable] = (rule, consequent)
                    continue
                yield _conflict(rule, consequent, *known[consequent.variable])


def _conflict(rule: Rule, consequent: Consequent, other: Rule, earlier: Consequent) -> Diagnostic:
    said, before = (f"{each.variable} is {each.term}" for each in (consequent, earlier))
    same = (consequent.term, consequent.hedges) == (earlier.term, earlier.hedges)
    span, line = rule.span, other.span.line
    related = Related(f"the other rule, on line {line}", other.span)
    if rule is other:
        message = f"says {said} twice" if same else f"says both {before} and {said}"
        span, related = consequent.span, Related("said first here", earlier.span)
    elif same:
        message = f"already stands on line {line}"
    else:
        message = f"says {said}, but line {line} says {earlier.term}"
    name = "duplicate-rule" if same else "contradictory-rules"
    return Diagnostic(name, f"the rule {_words(rule)} {message}", span, related=(related,))


def _words(rule: Rule) -> str:
    pairs = [f"{p.variable} is {p.term}" for p in plain_propositions(rule)]
    return f"'{' and '.join(pairs)}'" if pairs else "with this antecedent"


def _key(expression: Expression) -> Hashable:
    """Return what is equal for antecedents that differ in the order of operands only."""
    if isinstance(expression, Is):
        return (expression.variable, expression.term, expression.hedges)
    if isinstance(expression, Hedged):
        return ("hedged", expression.hedges, _key(expression.operand))
    word = "or" if isinstance(expression, Or) else "and"
    return (word, frozenset(map(_key, expression.operands)))


# --- Rules that share a conclusion of a weighted output, and count once together ---

_MOST_PAIRS = 10_000


def shared_conclusions(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``shared-conclusion`` where the larger of two strengths is taken without a word."""
    stated = _with_aggregation(subject)
    for output in subject.rulebase.outputs:
        weighted = output.defuzzifier.method in TAKAGI_SUGENO and output.aggregation == "max"
        if not weighted or not subject.document.statements or stated & {None, output.name}:
            continue
        found = next(_pairs_that_fold(output, subject), None)
        if found is None:
            continue
        first, second, conclusion = found
        yield Diagnostic(
            "shared-conclusion",
            f"this rule and that on line {first.span.line} conclude '{conclusion}' at once, and"
            f" only the stronger one counts in the {output.defuzzifier.method}",
            second.span,
            hint=f"to add them up, as other programs do, write  inference {output.name}:"
            " aggregation sum  (or  aggregation max  where this is meant)",
            related=(Related("the other rule", first.span),),
        )


def _with_aggregation(subject: Subject) -> set[str | None]:
    """Return the outputs whose aggregation the text states; None stands for all of them."""
    nodes = (statement.node for statement in subject.document.statements)
    return {
        node.target.text if node.target else None
        for node in nodes
        if isinstance(node, InferenceNode)
        and any(setting.key.text == "aggregation" for setting in node.settings)
    }


def _pairs_that_fold(output: Output, subject: Subject) -> Iterator[tuple[Rule, Rule, str]]:
    """Yield pairs of plain rules with one conclusion that fire at once, beside another one."""
    by_conclusion: dict[tuple[str, Hashable], list[Rule]] = {}
    rules = [rule for _, rule in subject.rules_for(output) if rule.weight > 0.0]
    for rule in rules:
        for each in rule.consequents:
            if each.variable == output.name:
                by_conclusion.setdefault((each.term, each.hedges), []).append(rule)
    if len(by_conclusion) < 2 and output.defuzzifier.method == "weighted-average":
        return  # the average of one value is that value
    pairs = (
        (first, second, conclusion)
        for (conclusion, _), group in by_conclusion.items()
        for first, second in combinations(group, 2)
    )
    for first, second, conclusion in islice(pairs, _MOST_PAIRS):
        parts = (*plain_propositions(first), *plain_propositions(second))
        if plain_propositions(first) and plain_propositions(second) and _overlap(parts, subject):
            yield first, second, conclusion


def _overlap(parts: tuple[Is, ...], subject: Subject) -> bool:
    """Whether there is an input at which all these propositions hold."""
    wanted: dict[str, set[tuple[str, tuple[()]]]] = {}
    for part in parts:
        wanted.setdefault(part.variable, set()).add((part.term, ()))
    inputs = {variable.name: variable for variable in subject.rulebase.inputs}
    return wanted.keys() <= inputs.keys() and all(
        any(terms <= cell.degrees.keys() for cell in subject.probes(inputs[name]))
        for name, terms in wanted.items()
    )
