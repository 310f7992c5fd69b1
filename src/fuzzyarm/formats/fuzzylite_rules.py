"""What rules mean to fuzzylite, expressed in the model.

Three habits of that program need care. Hedges of a conclusion change the activation
degree (weight times truth), not the set, and carry on to the conclusions after it. An
output in an antecedent stands for the degree to which its term has been activated so
far, not for a value. A switched-off variable gives truth 0, a switched-off output
receives nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

from fuzzyarm.formats.draft import Draft
from fuzzyarm.formats.imported import Findings
from fuzzyarm.formats.rule_text import RuleText, hedged
from fuzzyarm.rulebase.diagnostic import Span
from fuzzyarm.rulebase.model import (
    And,
    Consequent,
    Expression,
    Hedge,
    Hedged,
    Is,
    Or,
    Rule,
    RuleBlock,
    propositions,
)

MAX_NODES = 2_000
"""Most propositions that one antecedent may come to when outputs are put in."""

POWERS = {"very": 2.0, "somewhat": 0.5, "extremely": 3.0, "power": 1.0}
"""Exponents of the hedges that are powers; that of ``power`` is its own number."""

MACHINE_EPSILON = 1e-6
"""What the C++ program takes for zero: a rule that fires less does not fire."""

NEVER = (Hedge("not"), Hedge("any"))


@dataclass(frozen=True, slots=True)
class Norms:
    """The norms of a block; None where the file gives none.

    Attributes
    ----------
    conjunction, disjunction, implication : str or None
        Names in the model.
    threshold : float
        Firing strengths up to this count as none.
    """

    conjunction: str | None = None
    disjunction: str | None = None
    implication: str | None = None
    threshold: float = 0.0


class RuleBuilder:
    """Turns rule texts into rules, in the order in which they are evaluated.

    Parameters
    ----------
    variables : dict
        Name to variable, inputs and outputs.
    findings : Findings
        Where losses go.
    """

    def __init__(self, variables: dict[str, Draft], findings: Findings) -> None:
        self.variables = variables
        self.findings = findings
        self._fired: dict[tuple[str, str], list[tuple[Rule, Norms]]] = {}
        self._own: frozenset[str] = frozenset()
        self._sizes: dict[tuple[str, str], int] = {}

    def block(
        self,
        name: str,
        norms: Norms,
        texts: list[RuleText],
        later: frozenset[str] = frozenset(),
    ) -> RuleBlock:
        """Return the block of the rules `texts`; `later` blocks conclude other outputs.

        An output in an antecedent is replaced by the conditions that lead to it, where
        that is exact. Otherwise it stays where the model means the same: an output that
        rules of its own block conclude, all of them before the first that uses it.
        """
        rules: list[Rule] = []
        self._own = _finished_in(texts) - later
        for text in texts:
            self._need_norms(text, norms)
            for rule in self._rules(text, norms):
                rules.append(rule)
                for consequent in rule.consequents:
                    key = (consequent.variable, consequent.term)
                    self._fired.setdefault(key, []).append((rule, norms))
                    self._sizes[key] = self._sizes.get(key, 0) + _size(rule.antecedent)
        return RuleBlock(
            tuple(rules),
            name,
            norms.conjunction or "min",
            norms.disjunction or "max",
            norms.implication or "min",
            norms.threshold,
        )

    def _need_norms(self, text: RuleText, norms: Norms) -> None:
        for used, norm, key in (
            (text.uses_and, norms.conjunction, "and"),
            (text.uses_or, norms.disjunction, "or"),
        ):
            if used and norm is None:
                message = f"the rule says '{key}' but its block names no norm for it"
                self.findings.error("missing-norm", message, text.span)

    def _rules(self, text: RuleText, norms: Norms) -> list[Rule]:
        antecedent = self._expanded(text.antecedent, text.span, norms)
        rules: list[Rule] = []
        group: list[Consequent] = []
        hedges: tuple[Hedge, ...] = ()
        for conclusion in text.conclusions:
            draft = self.variables.get(conclusion.variable)
            if draft is not None and not draft.enabled:
                message = f"'{draft.name}' is switched off; the rule leaves it alone"
                self.findings.info("disabled-output", message, conclusion.span)
                continue
            if conclusion.hedges:
                if group:
                    rules.append(self._rule(antecedent, hedges, group, text))
                group, hedges = [], (*conclusion.hedges, *hedges)
            group.append(Consequent(conclusion.variable, conclusion.term, span=conclusion.span))
        if group:
            rules.append(self._rule(antecedent, hedges, group, text))
        return rules

    def _rule(
        self,
        antecedent: Expression,
        hedges: tuple[Hedge, ...],
        consequents: list[Consequent],
        text: RuleText,
    ) -> Rule:
        weight = hedged_weight(text.weight, hedges)
        if weight is None:
            message = (
                f"fuzzylite hedges weight times truth, which cannot be carried with the "
                f"weight {text.weight}"
            )
            self.findings.loss("hedged-weight", message, text.span)
            weight = text.weight
        return Rule(around(hedges, antecedent), tuple(consequents), weight, text.span)

    def _expanded(self, expression: Expression, span: Span, norms: Norms) -> Expression:
        expanded = self._put_in(expression, norms)
        if _size(expanded) > MAX_NODES:
            message = f"with its outputs put in, the rule has more than {MAX_NODES} propositions"
            self.findings.error("too-large", message, span)
            return expression
        return expanded

    def _put_in(self, expression: Expression, norms: Norms) -> Expression:
        if isinstance(expression, Is):
            return self._proposition(expression, norms)
        if isinstance(expression, Hedged):
            return hedged(expression.hedges, self._put_in(expression.operand, norms))
        operands = tuple(self._put_in(operand, norms) for operand in expression.operands)
        return type(expression)(operands)

    def _proposition(self, proposition: Is, norms: Norms) -> Expression:
        draft = self.variables.get(proposition.variable)
        if draft is None or (draft.enabled and not draft.is_output):
            return proposition
        if any(h.name == "any" for h in proposition.hedges):
            return self._constant(proposition, proposition.hedges)
        if not draft.enabled:
            message = f"'{draft.name}' is switched off; the proposition counts as false"
            self.findings.info("disabled-variable", message, proposition.span)
            return self._constant(proposition, NEVER)
        return hedged(proposition.hedges, self._activation(proposition, draft, norms))

    def _constant(self, proposition: Is, hedges: tuple[Hedge, ...]) -> Expression:
        """Return a proposition about an input whose hedges make it constant."""
        for draft in self.variables.values():
            if not draft.is_output and draft.terms:
                return Is(draft.name, draft.terms[0].name, hedges, proposition.span)
        message = "there is no input to carry a constant truth"
        self.findings.loss("chained-output", message, proposition.span)
        return proposition

    def _activation(self, proposition: Is, output: Draft, norms: Norms) -> Expression:
        fired = self._fired.get((proposition.variable, proposition.term), [])
        if not fired:
            message = f"no earlier rule concludes '{output.name} is {proposition.term}'"
            self.findings.warn("never-activated", message, proposition.span)
            return self._constant(proposition, NEVER)
        if self._sizes[proposition.variable, proposition.term] > MAX_NODES:
            what = "conditions to put in the place of an output"
            self.findings.room(MAX_NODES, MAX_NODES, what, proposition.span)
            return proposition
        reason = self._why_not(fired, output, norms)
        if reason and output.name in self._own:
            return proposition
        if reason:
            message = (
                f"fuzzylite takes the activation of '{output.name} is {proposition.term}' so "
                f"far, which cannot be carried here: {reason}"
            )
            self.findings.loss("chained-output", message, proposition.span)
        antecedents = tuple(rule.antecedent for rule, _ in fired)
        if not reason:
            message = (
                f"'{output.name} is {proposition.term}' means its activation to fuzzylite; "
                "the conditions that lead to it are put in its place"
            )
            self.findings.info("activation-put-in", message, proposition.span)
        return antecedents[0] if len(antecedents) == 1 else Or(antecedents)

    def _why_not(self, fired: list[tuple[Rule, Norms]], output: Draft, norms: Norms) -> str:
        if any(other.threshold > norms.threshold for _, other in fired):
            return "the block that leads to it has a threshold"
        if any(rule.weight != 1.0 for rule, _ in fired):
            return "a rule that leads to it has a weight"
        if len(fired) > 1 and output.aggregation != norms.disjunction:
            return f"the aggregation {output.aggregation} is not the disjunction of the block"
        for rule, other in fired:
            kinds = _connectives(rule.antecedent)
            if And in kinds and other.conjunction != norms.conjunction:
                return "the blocks differ in their conjunction"
            if Or in kinds and other.disjunction != norms.disjunction:
                return "the blocks differ in their disjunction"
        return ""


def around(hedges: tuple[Hedge, ...], antecedent: Expression) -> Expression:
    """Put hedges around a whole antecedent; not into it, so that they can be told apart."""
    if not hedges:
        return antecedent
    if isinstance(antecedent, Hedged):
        return Hedged((*hedges, *antecedent.hedges), antecedent.operand)
    return Hedged(hedges, antecedent)


def hedged_weight(weight: float, hedges: tuple[Hedge, ...]) -> float | None:
    """Return w' such that w' × hedges(d) is hedges(weight × d) for all d, or None.

    That holds for powers, as (w d)ᵖ = wᵖ dᵖ, for ``any`` and for the weight 1.
    """
    for hedge in reversed(hedges):
        if hedge.name == "any":
            weight = 1.0
        elif weight == 1.0:
            continue
        elif hedge.name in POWERS and weight > 0.0:
            weight = weight ** (hedge.exponent or POWERS[hedge.name])
        else:
            return None
    return weight


def concluded(texts: list[RuleText]) -> frozenset[str]:
    """Return the outputs that rules conclude."""
    return frozenset(c.variable for text in texts for c in text.conclusions)


def _finished_in(texts: list[RuleText]) -> frozenset[str]:
    """Return the outputs whose last conclusion stands before their first use."""
    last = {c.variable: i for i, text in enumerate(texts) for c in text.conclusions}
    first: dict[str, int] = {}
    for index, text in enumerate(texts):
        for part in propositions(text.antecedent):
            first.setdefault(part.variable, index)
    return frozenset(name for name, index in last.items() if index < first.get(name, len(texts)))


def _size(expression: Expression) -> int:
    if isinstance(expression, Is):
        return 1
    if isinstance(expression, Hedged):
        return 1 + _size(expression.operand)
    return 1 + sum(map(_size, expression.operands))


def _connectives(expression: Expression) -> set[type]:
    if isinstance(expression, Is):
        return set()
    if isinstance(expression, Hedged):
        return _connectives(expression.operand)
    return {type(expression)}.union(*map(_connectives, expression.operands))
