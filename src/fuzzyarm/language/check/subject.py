"""The subject of a check: a rule base, its text, and results shared by several checks."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

from fuzzyarm.language.check.search import Literal, VariableStretch
from fuzzyarm.language.document import Document
from fuzzyarm.language.model.rulebase import (
    And,
    Input,
    Is,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    propositions,
)
from fuzzyarm.language.model.shapes import centre, membership_function, polyline, probe_points
from fuzzyarm.language.rules import GridNode
from fuzzyarm.symbolic.kinds import SHAPES

FAINT = 1e-6
"""Memberships up to this count as none in the extent of a term; rules fire with fainter ones."""


class Subject:
    """A rule base and, if it came from a text, its syntax tree.

    Parameters
    ----------
    rulebase : RuleBase
        Free of errors.
    document : Document
        Empty without a text of the language.
    on_step : callable
        Called from time to time in long work; an exception ends the check.
    """

    def __init__(
        self, rulebase: RuleBase, document: Document, on_step: Callable[[], None] = lambda: None
    ) -> None:
        self.rulebase = rulebase
        self.document = document
        self.on_step = on_step
        self._probes: dict[tuple[str, float], list[VariableStretch]] = {}
        self._supports: dict[tuple[str, str], tuple[float, float]] = {}
        self._middles: dict[str, dict[str, float] | None] = {}

    @cached_property
    def rules(self) -> tuple[Rule, ...]:
        """The rules of all blocks."""
        return self.rulebase.rules

    @cached_property
    def grids(self) -> list[GridNode]:
        """The rule grids of the file."""
        nodes = (statement.node for statement in self.document.statements)
        return [part for node in nodes if isinstance(node, GridNode) for part in node.parts]

    @cached_property
    def _by_output(self) -> dict[str, list[tuple[RuleBlock, Rule]]]:
        rules_by_output: dict[str, list[tuple[RuleBlock, Rule]]] = {}
        for block in self.rulebase.blocks:
            for rule in block.rules:
                for name in dict.fromkeys(consequent.variable for consequent in rule.consequents):
                    rules_by_output.setdefault(name, []).append((block, rule))
        return rules_by_output

    def rules_for(self, output: Output) -> list[tuple[RuleBlock, Rule]]:
        """Return the rules that set `output`, each with its block."""
        return self._by_output.get(output.name, [])

    @cached_property
    def read_terms(self) -> set[tuple[str, str]]:
        """The terms, each with its variable, that conditions name."""
        parts = (part for rule in self.rules for part in propositions(rule.antecedent))
        return {(part.variable, part.term) for part in parts}

    @cached_property
    def families(self) -> list[Input | Output]:
        """The variables, each with terms that belong together.

        An output read by later rules through other terms than those of its conclusions is listed
        twice: with the terms of each.
        """
        concluded = {(c.variable, c.term) for rule in self.rules for c in rule.consequents}
        groups: list[Input | Output] = list(self.rulebase.inputs)
        for output in self.rulebase.outputs:
            antecedent_terms = tuple(
                t for t in output.terms if (output.name, t.name) in self.read_terms
            )
            if not antecedent_terms or any(
                (output.name, term.name) in concluded for term in antecedent_terms
            ):
                groups.append(output)
            else:
                others = tuple(term for term in output.terms if term not in antecedent_terms)
                groups += [replace(output, terms=others), replace(output, terms=antecedent_terms)]
        return groups

    def probes(self, variable: Input, least: float = FAINT) -> list[VariableStretch]:
        """Return :func:`probe` of an input, worked out once."""
        key = variable.name, least
        if key not in self._probes:
            self._probes[key] = probe(variable, least)
        return self._probes[key]

    def middle(self, variable: Input) -> float:
        """Return a position in the middle of an input."""
        probes = self.probes(variable)
        return probes[len(probes) // 2].x

    def support(self, variable: Input, term: str) -> tuple[float, float]:
        """Return the ends of the stretch of `variable` where `term` holds, to a corner."""
        if (variable.name, term) not in self._supports:
            probes = self.probes(variable)
            holds = [i for i, cell in enumerate(probes) if (term, ()) in cell.degrees] or [0]
            left, right = max(holds[0] - 1, 0), min(holds[-1] + 1, len(probes) - 1)
            self._supports[variable.name, term] = probes[left].x, probes[right].x
        return self._supports[variable.name, term]

    def middles(self, name: str) -> dict[str, float] | None:
        """Return the middle of each term of a variable in increasing order; None for values."""
        if name not in self._middles:
            variable = self.rulebase.variable(name)
            values = {t.name: centre(t.shape, variable.low, variable.high) for t in variable.terms}
            pairs = [(middle, term) for term, middle in values.items() if middle is not None]
            pairs.sort(key=lambda pair: pair[0])
            complete = len(pairs) == len(values)
            self._middles[name] = {term: x for x, term in pairs} if complete else None
        return self._middles[name]

    def ranks(self, name: str) -> dict[str, int] | None:
        """Return the rank of each term of the variable `name` by its middle; None for values."""
        middles = self.middles(name)
        return None if middles is None else {term: i for i, term in enumerate(middles)}


def probe(variable: Input, least: float = FAINT) -> list[VariableStretch]:
    """Return the corners of the terms and the midpoints between, with the terms above `least`.

    Between two corners no bounded term starts or ends, so the midpoint represents the interval.
    """
    points = probe_points(variable)
    degrees: list[dict[Literal, float]] = [{} for _ in points]
    for term in variable.terms:
        function = membership_function(term.shape)
        start, stop = 0, len(points)
        if SHAPES[term.shape.kind].straight:
            # Of a thousand terms only a few hold at a point: skip where a line stays 0.
            corners = polyline(term.shape)
            start = bisect_left(points, corners[0][0]) if corners[0][1] == 0.0 else start
            stop = bisect_right(points, corners[-1][0]) if corners[-1][1] == 0.0 else stop
        for i in range(start, stop):
            degree = function(points[i])
            if degree > least:
                degrees[i][term.name, ()] = degree
    return [
        VariableStretch(x, literals_here) for x, literals_here in zip(points, degrees, strict=True)
    ]


def plain_propositions(rule: Rule) -> tuple[Is, ...]:
    """Return the propositions of a rule that is a conjunction without hedges; else none."""
    antecedent = rule.antecedent
    parts = antecedent.operands if isinstance(antecedent, And) else (antecedent,)
    propositions = tuple(part for part in parts if isinstance(part, Is) and not part.hedges)
    return propositions if len(propositions) == len(parts) else ()
