"""Meaning of rules in other programs, expressed in the model.

Three habits of fuzzylite need care. Hedges of a conclusion change the activation degree (weight
times truth) rather than the set, after the decision whether the rule fires, and carry on to the
next conclusions. An output in an antecedent is the degree to which its term has been activated so
far, not a value. A disabled variable gives truth 0, a disabled output receives nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from fuzzyarm.base.diagnostic import NOWHERE, Span
from fuzzyarm.exchange.formats.dialects import MACHINE_EPSILON, Dialect
from fuzzyarm.exchange.formats.drafts import VALUES, VariableDraft, same_value
from fuzzyarm.exchange.formats.findings import Findings
from fuzzyarm.exchange.formats.sentences import NOT, RuleText, hedged
from fuzzyarm.language.model.rulebase import (
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
from fuzzyarm.language.model.shapes import apply_hedges, membership_function
from fuzzyarm.symbolic.kinds import SHAPES

MAX_NODES = 2_000
"""Most propositions of an antecedent after the substitution of outputs."""

POWERS = {"very": 2.0, "somewhat": 0.5, "extremely": 3.0, "power": 1.0}
"""Exponents of the hedges that are powers; ``power`` has its own."""

# `any` is 1 for every degree, so its complement is 0 whatever the term.
NEVER = (NOT, Hedge("any"))

_SAMPLES = 10_000
_SLIGHT_SHARE = 0.01
"""Greatest difference, as a share of the range, that is only a warning."""


@dataclass(slots=True)
class BlockDraft:
    """A rule block while its file is read; a norm is None if the file names none.

    Rules fire where their strength is above `threshold`; with `always_concludes` they take effect
    even at strength 0, which shows under a negated conclusion.
    """

    name: str
    span: Span = NOWHERE
    enabled: bool = True
    conjunction: str | None = None
    disjunction: str | None = None
    implication: str | None = None
    threshold: float = 0.0
    always_concludes: bool = False
    rules: list[RuleText] = field(default_factory=list)

    def in_model(
        self, rules: Sequence[Rule], name: str | None = None, threshold: float | None = None
    ) -> RuleBlock:
        """Return the model's block with these rules, by default with its own name and threshold."""
        return RuleBlock(
            tuple(rules),
            self.name if name is None else name,
            self.conjunction or "min",
            self.disjunction or "max",
            self.implication or "min",
            self.threshold if threshold is None else threshold,
        )


def blocks_in_model(
    blocks: list[BlockDraft],
    variables: dict[str, VariableDraft],
    dialect: Dialect,
    findings: Findings,
) -> tuple[RuleBlock, ...]:
    """Return the blocks of the model, with the rules' meaning in the program."""
    for text in (text for block in blocks for text in block.rules):
        if not 0.0 <= text.weight <= 1.0:
            message = f"a weight must lie between 0 and 1, not {text.weight:g}"
            findings.error("bad-weight", message, text.span)
    if dialect.activates:
        builder = _Activations(variables, findings, dialect)
        return tuple(
            part
            for index, block in enumerate(blocks)
            for part in builder.block(block, _concluded(blocks[index + 1 :]))
        )
    rule_blocks = []
    for block in blocks:
        rules = []
        for text in block.rules:
            conclusions = text.conclusions
            if dialect.suffix == ".fcl":
                _note_outputs(text, variables, dialect, findings)
            if dialect.producer == "jfuzzylogic":
                conclusions = tuple(same_value(conclusion, variables) for conclusion in conclusions)
            rule = Rule(text.antecedent, conclusions, text.weight, text.span)
            if dialect.suffix == ".fis":
                rules += _rules_of_values(rule, variables, dialect, findings)
            else:
                rules.append(rule)
        rule_blocks.append(block.in_model(rules))
    return tuple(rule_blocks)


def _concluded(blocks: list[BlockDraft]) -> frozenset[str]:
    """Return the outputs concluded by the rules of the blocks."""
    texts = [text for block in blocks for text in block.rules]
    return frozenset(conclusion.variable for text in texts for conclusion in text.conclusions)


def _note_outputs(
    text: RuleText, variables: dict[str, VariableDraft], dialect: Dialect, findings: Findings
) -> None:
    is_scikits = dialect.producer == "scikit-fuzzy"
    taken = "the activation of its term" if is_scikits else "the value it had before the rules"
    for variable in sorted({part.variable for part in propositions(text.antecedent)}):
        if variable in variables and variables[variable].is_output:
            message = (
                f"'{variable}' is an output; {dialect.program} takes {taken}, which cannot be "
                "converted"
            )
            findings.loss("chained-output", message, text.span)


FIRES = Hedge("power", 1e-20)
"""1 for all degrees above 0: a rule that does not fire has no conclusion to negate."""


def _rules_of_values(
    rule: Rule, drafts: dict[str, VariableDraft], dialect: Dialect, findings: Findings
) -> list[Rule]:
    """Express two habits of Octave's toolkit.

    It aggregates equal values whatever their names, and a hedge on a value takes the root of the
    firing strength, ``not`` its complement where the rule fires.
    """
    plain: list[Consequent] = []
    hedged_ones: list[Consequent] = []
    for consequent in rule.consequents:
        is_value = drafts[consequent.variable].defuzzifier.record.weighs
        is_octave = dialect.producer == "octave"
        conclusion = same_value(consequent, drafts) if is_octave else consequent
        (hedged_ones if is_value and conclusion.hedges else plain).append(conclusion)
        if not is_octave and hedged_ones and hedged_ones[-1] is conclusion:
            message = (
                f"the hedge on the value '{conclusion.term}' is read as Octave and fuzzylite do "
                "(not: 1 minus the firing strength); some releases of MATLAB ignore it"
            )
            findings.warn("hedged-value", message, consequent.span)
    rules = [replace(rule, consequents=tuple(plain))] if plain else []
    for consequent in hedged_ones:
        hedges = tuple(map(root, consequent.hedges))
        weight = hedged_weight(rule.weight, hedges)
        if weight is None:
            message = "a negated value and a weight cannot be carried together"
            findings.loss("hedged-weight", message, consequent.span)
            weight = rule.weight
        antecedent = around(hedges, rule.antecedent)
        if NOT in hedges:
            antecedent = And((antecedent, around((FIRES,), rule.antecedent)))
        bare = (replace(consequent, hedges=()),)
        rules.append(Rule(antecedent, bare, weight, rule.span))
    return rules


def root(hedge: Hedge) -> Hedge:
    """Return the inverse of a power; ``not`` is its own."""
    swapped = {"very": "somewhat", "somewhat": "very"}.get(hedge.name)
    if swapped:
        return Hedge(swapped)
    if hedge.name in POWERS:
        return Hedge("power", 1.0 / (hedge.exponent or POWERS[hedge.name]))
    return hedge


_NORM_LINES = {
    ".fll": {
        "and": "conjunction: Minimum",
        "or": "disjunction: Maximum",
        "implication": "implication: Minimum",
        "aggregation": "aggregation: Maximum",
    },
    ".fcl": {
        "and": "AND : MIN;",
        "or": "OR : MAX;",
        "implication": "ACT : MIN;",
        "aggregation": "ACCU : MAX;",
    },
    ".fis": {
        "and": "AndMethod='min'",
        "or": "OrMethod='max'",
        "implication": "ImpMethod='min'",
        "aggregation": "AggMethod='max'",
    },
}
"""Line with the usual norm, by format."""


class _Activations:
    """Converts fuzzylite's rule texts into rules, in order of evaluation."""

    def __init__(
        self, variables: dict[str, VariableDraft], findings: Findings, dialect: Dialect
    ) -> None:
        self.variables = variables
        self.findings = findings
        self.dialect = dialect
        self._fired: dict[tuple[str, str], list[tuple[Rule, BlockDraft]]] = {}
        self._concluded_here: frozenset[str] = frozenset()
        self._sizes: dict[tuple[str, str], int] = {}
        self._shares: dict[tuple[str, str, tuple[Hedge, ...], float], float] = {}

    def block(self, block: BlockDraft, later: frozenset[str]) -> list[RuleBlock]:
        """Return the blocks of the model; `later` holds the outputs of later blocks.

        An output in an antecedent is replaced by the conditions of the rules that conclude it,
        where that is exact. Otherwise it stays if the model agrees: all rules that conclude it are
        in this block, before its first use.

        The threshold applies to the strength under the hedges, and a block has one: rules whose
        hedges change it go into blocks of their own, after the others.
        """
        by_threshold: dict[float, list[Rule]] = {block.threshold: []}
        self._concluded_here = _finished_in(block.rules) - later
        for text in block.rules:
            self._need_norms(text, block)
            for rule, threshold in self._rules(text, block):
                by_threshold.setdefault(threshold, []).append(rule)
                for consequent in rule.consequents:
                    key = (consequent.variable, consequent.term)
                    self._fired.setdefault(key, []).append((rule, block))
                    self._sizes[key] = self._sizes.get(key, 0) + _size(rule.antecedent)
        first, *others = by_threshold.items()
        if others and self._asks_outputs(by_threshold.values()):
            message = "a hedge before a conclusion beside rules that read outputs"
            self.findings.loss("hedged-conclusion", f"{message} cannot be carried", block.span)
        # A first block without its own rules is left out.
        parts = [first, *others] if first[1] or not others else others
        return [
            block.in_model(rules, _numbered(block.name, number), threshold)
            for number, (threshold, rules) in enumerate(parts, 1)
        ]

    def _asks_outputs(self, groups: Iterable[list[Rule]]) -> bool:
        names = {p.variable for rules in groups for r in rules for p in propositions(r.antecedent)}
        return any(self.variables[name].is_output for name in names & self.variables.keys())

    def _need_norms(self, text: RuleText, block: BlockDraft) -> None:
        connectives = set(map(type, _parts(text.antecedent)))
        for kind, norm, key in ((And, block.conjunction, "and"), (Or, block.disjunction, "or")):
            if kind in connectives and norm is None:
                message = f"the rule says '{key}' but its block names no norm for it"
                self.findings.error("missing-norm", message, text.span, self._norm_hint(key))
        if self.findings.failed:  # maybe a misspelt norm
            return
        for name in [conclusion.variable for conclusion in text.conclusions]:
            draft = self.variables.get(name)
            if draft is None or not draft.integrates:
                continue
            missing = "aggregation" if not draft.aggregates else "implication"
            if not draft.aggregates or block.implication is None:
                message = f"'{name}' is integrated, but there is no {missing}: fuzzylite fails here"
                self.findings.error("missing-norm", message, text.span, self._norm_hint(missing))

    def _norm_hint(self, key: str) -> str:
        """Return the line with the usual norm."""
        return f"write {_NORM_LINES[self.dialect.suffix][key]}"

    def _rules(self, text: RuleText, block: BlockDraft) -> list[tuple[Rule, float]]:
        """Return rules, each with its threshold."""
        antecedent = self._expanded(text.antecedent, text.span, block)
        rules: list[tuple[Rule, float]] = []
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
                    rules.append(self._rule(antecedent, hedges, group, text, block))
                # Earlier hedges already apply to the activation, so the new ones go outside.
                group, hedges = [], (*conclusion.hedges, *hedges)
            group.append(Consequent(conclusion.variable, conclusion.term, span=conclusion.span))
        if group:
            rules.append(self._rule(antecedent, hedges, group, text, block))
        return rules

    def _rule(
        self,
        antecedent: Expression,
        hedges: tuple[Hedge, ...],
        consequents: list[Consequent],
        text: RuleText,
        block: BlockDraft,
    ) -> tuple[Rule, float]:
        weight = hedged_weight(text.weight, hedges)
        if weight is None:
            message = (
                f"fuzzylite hedges weight times truth, which cannot be carried with the "
                f"weight {text.weight}"
            )
            self.findings.loss("hedged-weight", message, text.span)
            weight = text.weight
        strength, threshold = around(hedges, antecedent), block.threshold
        under = threshold_under(hedges, threshold)
        if under is not None:
            threshold = under
        elif block.always_concludes:
            self._note_always(text)
        else:
            self._note_faint(antecedent, block.threshold, text)
            strength, threshold = only_fired(strength, antecedent), 0.0
        return Rule(strength, tuple(consequents), weight, text.span), threshold

    def _note_always(self, text: RuleText) -> None:
        message = (
            "the Python program of fuzzylite takes this conclusion also where the rule does not "
            "fire, and so it is read; the C++ program only where it fires above "
            f"{MACHINE_EPSILON:g}"
        )
        self.findings.warn("hedged-conclusion", message, text.span)

    def _note_faint(self, antecedent: Expression, threshold: float, text: RuleText) -> None:
        """Report degrees between 0 and the threshold: the rule fires in the model only."""
        shares: dict[Is, float] = {}
        for part in propositions(antecedent):
            key = (part.variable, part.term, part.hedges, threshold)
            if key not in self._shares:
                self._shares[key] = self._faint(part, threshold)
            shares[part] = self._shares[key]
        worst = max(shares, key=lambda part: shares[part], default=None)
        if worst is None or shares[worst] == 0.0:
            return
        message = (
            f"where '{worst.variable} is {worst.term}' holds to {threshold:g} or less, but not to "
            "0, this concludes nothing to fuzzylite; here it does"
        )
        slight = shares[worst] <= _SLIGHT_SHARE
        self.findings.loss("hedged-conclusion", message, text.span, slight=slight)

    def _faint(self, part: Is, threshold: float) -> float:
        """Return the share of a range with degrees above 0 up to a threshold."""
        draft = self.variables.get(part.variable)
        term = draft.term(part.term) if draft is not None else None
        if draft is None or term is None or term.shape.kind in VALUES:
            return 0.0
        if SHAPES[term.shape.kind].straight and threshold <= MACHINE_EPSILON:
            return 0.0  # at the very foot of a flank only
        if not draft.bounded:
            return 1.0
        degree, width = membership_function(term.shape), draft.high - draft.low
        degrees = [
            apply_hedges(part.hedges, degree(draft.low + width * i / _SAMPLES))
            for i in range(_SAMPLES + 1)
        ]
        return sum(0.0 < membership <= threshold for membership in degrees) / _SAMPLES

    def _expanded(self, expression: Expression, span: Span, block: BlockDraft) -> Expression:
        expanded = self._put_in(expression, block)
        if _size(expanded) > MAX_NODES:
            message = f"with its outputs put in, the rule has more than {MAX_NODES} propositions"
            self.findings.error("too-large", message, span)
            return expression
        return expanded

    def _put_in(self, expression: Expression, block: BlockDraft) -> Expression:
        if isinstance(expression, Is):
            return self._proposition(expression, block)
        if isinstance(expression, Hedged):
            return hedged(expression.hedges, self._put_in(expression.operand, block))
        operands = tuple(self._put_in(operand, block) for operand in expression.operands)
        return type(expression)(operands)

    def _proposition(self, proposition: Is, block: BlockDraft) -> Expression:
        draft = self.variables.get(proposition.variable)
        if draft is None or (draft.enabled and not draft.is_output):
            return proposition
        if any(h.name == "any" for h in proposition.hedges):
            return self._constant(proposition, proposition.hedges)
        if not draft.enabled:
            message = f"'{draft.name}' is switched off; the proposition counts as false"
            self.findings.info("disabled-variable", message, proposition.span)
            return self._constant(proposition, NEVER)
        return hedged(proposition.hedges, self._activation(proposition, draft, block))

    def _constant(self, proposition: Is, hedges: tuple[Hedge, ...]) -> Expression:
        """Return a proposition about an input that its hedges make constant."""
        for draft in self.variables.values():
            if not draft.is_output and draft.terms:
                return Is(draft.name, draft.terms[0].name, hedges, proposition.span)
        message = "there is no input to carry a constant truth"
        self.findings.loss("chained-output", message, proposition.span)
        return proposition

    def _activation(self, proposition: Is, output: VariableDraft, block: BlockDraft) -> Expression:
        fired = self._fired.get((proposition.variable, proposition.term), [])
        if not fired:
            message = f"no earlier rule concludes '{output.name} is {proposition.term}'"
            self.findings.warn("never-activated", message, proposition.span)
            return self._constant(proposition, NEVER)
        if self._sizes[proposition.variable, proposition.term] > MAX_NODES:
            items = "conditions to put in the place of an output"
            self.findings.room(MAX_NODES, MAX_NODES, items, proposition.span)
            return proposition
        reason = self._why_not(fired, output, block)
        if reason and output.name in self._concluded_here:
            return proposition
        if reason:
            message = (
                f"fuzzylite takes the activation of '{output.name} is {proposition.term}' so "
                f"far, which cannot be converted here: {reason}"
            )
            self.findings.loss("chained-output", message, proposition.span)
        antecedents = tuple(rule.antecedent for rule, _ in fired)
        if not reason:
            message = (
                f"'{output.name} is {proposition.term}' means its activation to fuzzylite; "
                "the conditions that lead to it are substituted"
            )
            self.findings.info("activation-put-in", message, proposition.span)
        return antecedents[0] if len(antecedents) == 1 else Or(antecedents)

    def _why_not(
        self, fired: list[tuple[Rule, BlockDraft]], output: VariableDraft, block: BlockDraft
    ) -> str:
        if any(other.threshold > block.threshold for _, other in fired):
            return "the block that leads to it has a threshold"
        for rule, _ in fired:
            if rule.weight != 1.0:
                return f"the rule in line {rule.span.line} has the weight {rule.weight:g}"
        if len(fired) > 1 and output.aggregation != block.disjunction:
            return f"the aggregation {output.aggregation} is not the disjunction of the block"
        for rule, other in fired:
            kinds = set(map(type, _parts(rule.antecedent)))
            if And in kinds and other.conjunction != block.conjunction:
                return "the blocks differ in their conjunction"
            if Or in kinds and other.disjunction != block.disjunction:
                return "the blocks differ in their disjunction"
        return ""


def threshold_under(hedges: Sequence[Hedge], threshold: float) -> float | None:
    """Return a threshold of degrees as one of hedged degrees; None if the hedges move 0."""
    if any(hedge.name not in _RISING for hedge in hedges):
        return None
    return apply_hedges(hedges, threshold)


_RISING = frozenset({*POWERS, "intensify", "seldom"})
"""Hedges that rise from 0 to 1."""


def only_fired(strength: Expression, antecedent: Expression) -> Expression:
    """Return a strength where an antecedent holds at all, else 0."""
    return And((strength, around((FIRES,), antecedent)))


def hedges_of_conclusion(rule: Rule, block: RuleBlock, dialect: Dialect) -> tuple[Hedge, ...]:
    """Return hedges before conclusions with which fuzzylite reads this rule, if any.

    Inverse of :func:`blocks_in_model`: same strength, and the rule fires at the same points.
    """
    antecedent, above = rule.antecedent, block.threshold
    if isinstance(antecedent, Hedged):
        # FLL states its threshold; without one its rules conclude even at strength 0.
        usual = above if dialect.thresholds else dialect.threshold
        as_read = above == 0.0 if dialect.thresholds else False
        as_read = as_read or threshold_under(antecedent.hedges, usual) == above
        return antecedent.hedges if as_read else ()
    if dialect.thresholds or above != 0.0 or not isinstance(antecedent, And):
        return ()
    if len(antecedent.operands) != 2:
        return ()
    strength, fires = antecedent.operands
    if not isinstance(strength, Hedged) or not isinstance(fires, Hedged):
        return ()
    inner = fires.hedges[1:]
    hedges = strength.hedges[: len(strength.hedges) - len(inner)]
    same = strength.operand == fires.operand and strength.hedges == (*hedges, *inner)
    return hedges if same and fires.hedges[0] == FIRES else ()


def without_hedges(antecedent: Expression, hedges: tuple[Hedge, ...]) -> Expression:
    """Strip the hedges found by :func:`hedges_of_conclusion` from an antecedent."""
    if isinstance(antecedent, And):
        antecedent = antecedent.operands[0]
    assert isinstance(antecedent, Hedged)
    rest = antecedent.hedges[len(hedges) :]
    return Hedged(rest, antecedent.operand) if rest else antecedent.operand


def _numbered(name: str, number: int) -> str:
    return name if number == 1 else f"{name} {number}".strip()


def around(hedges: tuple[Hedge, ...], antecedent: Expression) -> Expression:
    """Put hedges around a whole antecedent, as a node of their own for the way back."""
    if not hedges:
        return antecedent
    if isinstance(antecedent, Hedged):
        return Hedged((*hedges, *antecedent.hedges), antecedent.operand)
    return Hedged(hedges, antecedent)


def hedged_weight(weight: float, hedges: tuple[Hedge, ...]) -> float | None:
    """Return w' such that w' × hedges(d) = hedges(w × d) for all d, or None.

    It exists for powers, as (w d)ᵖ = wᵖ dᵖ, for ``any``, and for the weight 1.
    """
    # The hedge next to the antecedent acts first.
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


def _finished_in(texts: list[RuleText]) -> frozenset[str]:
    """Return the outputs with all conclusions before their first use."""
    last = {c.variable: i for i, text in enumerate(texts) for c in text.conclusions}
    first: dict[str, int] = {}
    for index, text in enumerate(texts):
        for part in propositions(text.antecedent):
            first.setdefault(part.variable, index)
    return frozenset(name for name, index in last.items() if index < first.get(name, len(texts)))


def _parts(expression: Expression) -> Iterator[Expression]:
    """Yield an expression and all its parts."""
    yield expression
    inner: tuple[Expression, ...] = ()
    if isinstance(expression, Hedged):
        inner = (expression.operand,)
    elif not isinstance(expression, Is):
        inner = expression.operands
    for part in inner:
        yield from _parts(part)


def _size(expression: Expression) -> int:
    return sum(1 for _ in _parts(expression))
