"""fuzzylogic: from a ``Rule`` over the sets of domains to a rule base.

A rule is the sum of strength × centre over the sum of the strengths. The centre of a set is that of
its samples, counted in steps of the target's domain, then scaled by range over number of samples;
here these centres are values. Objects are recognised by their attributes; fuzzylogic itself is not
imported.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

from fuzzyarm.exchange.formats.findings import Findings, Imported, reading, unique_name
from fuzzyarm.exchange.formats.recovery import TOLERANCE
from fuzzyarm.exchange.formats.sentences import NOT
from fuzzyarm.exchange.live.functions import input_of, shape_or_points
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Defuzzifier,
    Hedge,
    Input,
    Is,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
)
from fuzzyarm.language.model.shapes import apply_hedges


def fuzzylogic_numbers(rule: Any) -> Callable[[Mapping[str, float]], dict[str, float]]:
    """Return a function that evaluates a rule in fuzzylogic."""
    domains = _domains(rule)
    target = str(next(iter(rule.conditions.values())).domain._name)

    def numbers(values: Mapping[str, float]) -> dict[str, float]:
        result = rule({domains[name]: value for name, value in values.items()})
        return {} if result is None else {target: float(result)}

    return numbers


def from_fuzzylogic(
    rule: Any, name: str = "rule", *, lossy: bool = False, strict: bool = False
) -> Imported:
    """Return the rule base of a rule of fuzzylogic."""
    findings = Findings(lossy=lossy, strict=strict)
    rulebase = _rulebase(rule, name, findings)
    return findings.imported(rulebase, "fuzzylogic")


def _domains(rule: Any) -> dict[str, Any]:
    """Return the domains of the conditions by name, in the order of their names."""
    domains = {id(s.domain): s.domain for sets in rule.conditions for s in sets}
    return {
        str(domain._name): domain for domain in sorted(domains.values(), key=lambda d: str(d._name))
    }


def _rulebase(rule: Any, name: str, findings: Findings) -> RuleBase | None:
    if not rule.conditions:
        findings.error("no-rules", "the rule has no conditions")
        return None
    asked_sets = [fuzzy_set for sets in rule.conditions for fuzzy_set in sets]
    concluded = list(rule.conditions.values())
    if any(fuzzy_set.domain is None for fuzzy_set in (*asked_sets, *concluded)):
        findings.error("undefined-variable", "a set of the rule belongs to no domain")
        return None
    targets = {id(fuzzy_set.domain): fuzzy_set.domain for fuzzy_set in concluded}
    labels = sorted(str(fuzzy_set._name) for fuzzy_set in targets.values())
    if len(targets) > 1:
        findings.error("rule-too-rich", f"the rule concludes several domains: {', '.join(labels)}")
        return None
    domains, (target,) = _domains(rule), targets.values()
    if (
        len(domains) < len({id(fuzzy_set.domain) for fuzzy_set in asked_sets})
        or labels[0] in domains
    ):
        findings.error("duplicate-variable", "two domains of the rule have one name")
        return None
    sets_by_domain = {
        id(domain): _named(domain, asked_sets, hedged=True) for domain in domains.values()
    }
    values = _named(target, concluded)
    inputs = tuple(
        _input(label, domain, sets_by_domain[id(domain)].values(), findings)
        for label, domain in domains.items()
    )
    rules = []
    for sets, fuzzy_set in rule.conditions.items():
        parts = tuple(
            Is(
                str(fuzzy_set.domain._name),
                *sets_by_domain[id(fuzzy_set.domain)][id(fuzzy_set)][:2],
            )
            for fuzzy_set in sorted(sets, key=lambda fuzzy_set: str(fuzzy_set.domain._name))
        )
        conclusion = Consequent(labels[0], values[id(fuzzy_set)].term)
        rules.append(Rule(And(parts) if len(parts) > 1 else parts[0], (conclusion,)))
    output = _output(labels[0], target, values.values())
    return RuleBase(name, inputs, (output,), (RuleBlock(tuple(rules)),))


class _NamedSet(NamedTuple):
    """A set under its name in the rules; `set` is None for another term under hedges."""

    term: str
    hedges: tuple[Hedge, ...]
    set: Any


def _named(domain: Any, used: Iterable[Any], *, hedged: bool = False) -> dict[int, _NamedSet]:
    """Return the sets of a domain by identity, and those derived from them on the way."""
    names_of_sets = {
        id(fuzzy_set): _NamedSet(str(name), (), fuzzy_set)
        for name, fuzzy_set in domain._sets.items()
    }
    own_sets = list(names_of_sets.values())
    names = {fuzzy_set.term for fuzzy_set in own_sets}
    for fuzzy_set in used:
        if fuzzy_set.domain is not domain or id(fuzzy_set) in names_of_sets:
            continue
        same = _under_hedges(fuzzy_set, own_sets, domain) if hedged else None
        if same is None:
            same = _NamedSet(unique_name(str(fuzzy_set.name or "derived"), names), (), fuzzy_set)
            names.add(same.term)
        names_of_sets[id(fuzzy_set)] = same
    return names_of_sets


def _under_hedges(fuzzy_set: Any, terms: list[_NamedSet], domain: Any) -> _NamedSet | None:
    """Return the term and hedges of a derived set, such as ``~hot`` or ``very(hot)``."""
    low, width = float(domain._low), float(domain._high) - float(domain._low)
    # The range extended by an eighth on either side, where a complement differs.
    xs = [low + width * (i - 20) / 160 for i in range(201)]
    degrees = [float(fuzzy_set(x)) for x in xs]
    for term in terms:
        before = [float(term.set(x)) for x in xs]
        for hedges in (*_powers(before, degrees), (NOT,)):
            values = [apply_hedges(hedges, min(1.0, max(0.0, y))) for y in before]
            if all(abs(a - b) <= TOLERANCE for a, b in zip(values, degrees, strict=True)):
                return _NamedSet(term.term, hedges, None)
    return None


def _powers(before: list[float], after: list[float]) -> list[tuple[Hedge, ...]]:
    """Return the power from one degree to the other, estimated from the middle ones."""
    # A power changes degrees near 0 and 1 little: rounding would swamp its exponent.
    pairs = [(a, b) for a, b in zip(before, after, strict=True) if 0.1 < a < 0.9 and 0.0 < b < 1.0]
    if not pairs:
        return []
    exponent = round(math.log(pairs[0][1]) / math.log(pairs[0][0]), 9)
    return [(_POWERS.get(exponent) or Hedge("power", exponent),)] if exponent > 0.0 else []


_POWERS = {2.0: Hedge("very"), 0.5: Hedge("somewhat"), 3.0: Hedge("extremely")}


def _input(label: str, domain: Any, sets: Iterable[_NamedSet], findings: Findings) -> Input:
    low, high = float(domain._low), float(domain._high)
    shapes = {}
    for name, _, fuzzy_set in sets:
        if fuzzy_set is not None:
            quoted = f"'{name}' of '{label}'"
            with reading(quoted):
                words = f"{quoted} is a user-defined function,"
                shapes[name] = shape_or_points(_degree_of(fuzzy_set), low, high, words, findings)
    return input_of(label, low, high, shapes)


def _degree_of(fuzzy_set: Any) -> Callable[[float], float]:
    return lambda x: float(fuzzy_set(x))


def _output(label: str, target: Any, sets: Iterable[_NamedSet]) -> Output:
    low, high = float(target._low), float(target._high)
    step = (high - low) / len(target.range)
    # `center_of_gravity` is an offset from the start of the domain, not a value.
    values = {name: low + step * float(fuzzy_set.center_of_gravity) for name, _, fuzzy_set in sets}
    return Output(
        label,
        low,
        high,
        tuple(Term(name, Shape("singleton", (value,))) for name, value in values.items()),
        outside="extend",
        aggregation="sum",
        defuzzifier=Defuzzifier("weighted-average"),
    )
