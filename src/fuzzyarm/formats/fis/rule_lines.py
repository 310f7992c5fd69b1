"""Rules as lines of term numbers."""

from __future__ import annotations

from fuzzyarm.formats.fis.meaning import root
from fuzzyarm.formats.fis.rules import fraction_of
from fuzzyarm.formats.fuzzylite_text import Said, said_rules, weight_before
from fuzzyarm.formats.imported import Findings
from fuzzyarm.formats.numerals import written
from fuzzyarm.formats.rule_text import NOT, hedged
from fuzzyarm.rulebase.model import (
    And,
    Consequent,
    Expression,
    Hedge,
    Hedged,
    Is,
    Or,
    Rule,
    RuleBase,
    RuleBlock,
)

Group = dict[str, tuple[Consequent, tuple[Hedge, ...]]]
"""Output → its conclusion and the hedges before it."""


def rule_lines(rulebase: RuleBase, producer: str, findings: Findings) -> list[str]:
    """Return a line for each rule; report those that do not fit into one."""
    if sum(bool(block.rules) for block in rulebase.blocks) > 1:
        findings.info("dropped-blocks", "the rules of all blocks stand in one list")
    writer = _Lines(rulebase, producer, findings)
    return [
        line
        for block in rulebase.blocks
        for said in writer.said(block)
        for line in writer.lines(said)
    ]


class _Lines:
    def __init__(self, rulebase: RuleBase, producer: str, findings: Findings) -> None:
        self.inputs = [variable.name for variable in rulebase.inputs]
        self.outputs = {output.name: place for place, output in enumerate(rulebase.outputs)}
        self.weighted = {
            output.name
            for output in rulebase.outputs
            if output.defuzzifier.method in ("weighted-average", "weighted-sum")
        }
        self.numbers = {
            (variable.name, term.name): index
            for variable in (*rulebase.inputs, *rulebase.outputs)
            for index, term in enumerate(variable.terms, 1)
        }
        self.producer = producer
        self.findings = findings

    def said(self, block: RuleBlock) -> list[Said]:
        """Return the rules with their hedges where the program has them."""
        if self.producer == "fuzzylite":
            return said_rules(block, self.outputs)
        return [self._said(rule) for rule in block.rules]

    def _said(self, rule: Rule) -> Said:
        """Give the hedges around an antecedent to values, of which Octave takes the root."""
        plain = tuple((c, c.hedges) for c in rule.consequents)
        antecedent = rule.antecedent
        values = all(c.variable in self.weighted and not c.hedges for c in rule.consequents)
        if self.producer != "octave" or not isinstance(antecedent, Hedged) or not values:
            return Said(antecedent, plain, rule.weight, rule, ())
        roots = tuple(map(root, antecedent.hedges))
        weight = weight_before(rule.weight, antecedent.hedges)
        if weight is None:
            return Said(antecedent, plain, rule.weight, rule, ())
        rooted = tuple((c, roots) for c in rule.consequents)
        return Said(antecedent.operand, rooted, weight, rule, ())

    def lines(self, said: Said) -> list[str]:
        """Return the line of a rule, several where an output stands twice."""
        rule, antecedent = said.rule, said.antecedent
        conditions = self._conditions(antecedent)
        if conditions is None:
            message = "a rule of a FIS is one list of conditions on inputs, joined by and or by or"
            self.findings.loss("rule-too-rich", message, rule.span)
            return []
        codes = [self._code(self._condition(conditions, name), rule) for name in self.inputs]
        connective = 2 if isinstance(antecedent, Or) else 1
        lines = []
        for group in self._groups(said):
            left, right = " ".join(codes), " ".join(self._conclusions(group, rule))
            lines.append(f"{left}, {right} ({written(said.weight)}) : {connective}")
        return lines

    def _conditions(self, antecedent: Expression) -> list[Is] | None:
        """Return the propositions where each is about another input; None for anything else."""
        if isinstance(antecedent, Hedged) and isinstance(antecedent.operand, Is):
            antecedent = hedged(antecedent.hedges, antecedent.operand)
        parts = antecedent.operands if isinstance(antecedent, And | Or) else (antecedent,)
        found = [part for part in parts if isinstance(part, Is) and part.variable in self.inputs]
        names = [part.variable for part in found]
        if len(found) != len(parts) or len(set(names)) != len(names):
            return None
        if names != sorted(names, key=self.inputs.index) and len(names) > 2:
            message = "the conditions of a rule stand in the order of the inputs"
            self.findings.info("reordered-conditions", message)
        return found

    @staticmethod
    def _condition(conditions: list[Is], name: str) -> Is | None:
        return next((part for part in conditions if part.variable == name), None)

    def _code(self, part: Is | None, rule: Rule) -> str:
        return "0" if part is None else self._number(part.variable, part.term, part.hedges, rule)

    def _number(self, variable: str, term: str, hedges: tuple[Hedge, ...], rule: Rule) -> str:
        negated = hedges[:1] == (NOT,)
        rest = hedges[1:] if negated else hedges
        fraction = 0.0 if not rest else fraction_of(rest, self.producer)
        if fraction is None or (rest and self.producer == "matlab"):
            said = " ".join(hedge.name for hedge in rest)
            message = f"the hedge '{said}' has no number in this FIS"
            self.findings.loss("unsupported-hedge", message, rule.span)
            fraction = 0.0
        code = self.numbers[variable, term] + fraction
        return f"-{written(round(code, 6))}" if negated else written(round(code, 6))

    def _groups(self, said: Said) -> list[Group]:
        """Split conclusions so that no output stands twice in one line."""
        groups: list[Group] = []
        for consequent, hedges in said.conclusions:
            for group in groups:
                if consequent.variable not in group:
                    group[consequent.variable] = (consequent, hedges)
                    break
            else:
                groups.append({consequent.variable: (consequent, hedges)})
        if self.producer == "fuzzylite" and said.hedges and not self._in_order(said, groups):
            message = "the order of the conclusions of a hedged rule cannot be kept"
            self.findings.loss("rule-too-rich", message, said.rule.span)
        return groups

    def _in_order(self, said: Said, groups: list[Group]) -> bool:
        places = [self.outputs[consequent.variable] for consequent, _ in said.conclusions]
        return len(groups) == 1 and places == sorted(places)

    def _conclusions(self, group: Group, rule: Rule) -> list[str]:
        codes = []
        for name in self.outputs:
            if name not in group:
                codes.append("0")
                continue
            consequent, hedges = group[name]
            if consequent.hedges and self.producer == "fuzzylite":
                message = "hedges on the set of a conclusion have another meaning to fuzzylite"
                self.findings.loss("set-hedge", message, rule.span)
            codes.append(self._number(name, consequent.term, hedges, rule))
        return codes
