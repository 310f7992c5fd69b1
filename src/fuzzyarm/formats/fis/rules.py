"""Rules of FIS, as lines of term numbers and as rules of the model."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from fuzzyarm.formats.findings import Draft, Findings, Word, number, written
from fuzzyarm.formats.fis.meaning import root
from fuzzyarm.formats.rules import NOT, POWERS, RuleText, hedged
from fuzzyarm.formats.writing import Said, said_rules, weight_before
from fuzzyarm.model.rulebase import (
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
from fuzzyarm.text.diagnostic import Span

# --- Rules of FIS: a term index for each variable, weight, and 1 for and or 2 for or ---

_RULE = re.compile(
    r"(?P<inputs>[^,:()]*),(?P<outputs>[^,:()]*)(?:\((?P<weight>[^()]*)\))?\s*"
    r"(?::\s*(?P<connective>\S*))?\s*\Z"
)
_NUMBER = re.compile(r"\S+")

_FUZZYLITE = {
    0.01: (Hedge("seldom"),),
    0.05: (Hedge("somewhat"),),
    0.2: (Hedge("very"),),
    0.3: (Hedge("intensify"),),
    0.4: (Hedge("very"), Hedge("very")),
    0.99: (Hedge("any"),),
}
_OCTAVE = {
    0.05: (Hedge("somewhat"),),
    0.2: (Hedge("very"),),
    0.3: (Hedge("extremely"),),
    0.4: (Hedge("very"), Hedge("very")),
}


def hedges_of(fraction: float, producer: str) -> tuple[Hedge, ...] | None:
    """Return the hedges that the fraction of an index stands for, or None.

    To Octave's toolkit a fraction f is the power 10 f; fuzzylite knows six of them, and
    MATLAB none (what it does with one is not documented, so it is read as Octave does).
    """
    if fraction == 0.0:
        return ()
    table = _FUZZYLITE if producer == "fuzzylite" else _OCTAVE
    if fraction in table:
        return table[fraction]
    return None if producer == "fuzzylite" else (Hedge("power", round(10.0 * fraction, 6)),)


def fraction_of(hedges: tuple[Hedge, ...], producer: str) -> float | None:
    """Return the fraction that says `hedges`, or None."""
    if not hedges:
        return 0.0
    table = _FUZZYLITE if producer == "fuzzylite" else _OCTAVE
    for fraction, said in table.items():
        if said == hedges:
            return fraction
    if producer == "fuzzylite" or len(hedges) != 1 or hedges[0].name not in POWERS:
        return None
    fraction = round((hedges[0].exponent or POWERS[hedges[0].name]) / 10.0, 6)
    if not 0.0 < fraction < 1.0:
        return None
    read = hedges_of(fraction, producer) or ()
    return fraction if len(read) == 1 and exponent(read[0]) == exponent(hedges[0]) else None


def exponent(hedge: Hedge) -> float:
    """Return the power that a hedge is; 1 for one that is none."""
    return hedge.exponent or POWERS.get(hedge.name, 1.0)


@dataclass(frozen=True, slots=True)
class RuleReader:
    """Reads the lines of ``[Rules]``.

    Attributes
    ----------
    inputs, outputs : tuple of Draft
        By index.
    terms : dict
        Variable name → index in the file → term name.
    producer : str
        Whose hedges the fractions are.
    findings : Findings
        Where faults go.
    """

    inputs: tuple[Draft, ...]
    outputs: tuple[Draft, ...]
    terms: dict[str, dict[int, str]]
    producer: str
    findings: Findings

    def read(self, line: Word) -> RuleText | None:
        """Return the rule of a line, or None with a finding."""
        match = _RULE.match(line.text)
        if match is None:
            message = "a rule is 'inputs, outputs (weight) : connective'"
            self.findings.error("syntax", message, line)
            return None
        inputs = self._words(match, "inputs", line)
        outputs = self._words(match, "outputs", line)
        if len(inputs) != len(self.inputs) or len(outputs) != len(self.outputs):
            message = (
                f"the rule has {len(inputs)} inputs and {len(outputs)} outputs, the file "
                f"{len(self.inputs)} and {len(self.outputs)}"
            )
            self.findings.error("wrong-count", message, line)
            return None
        weight = self._weight(match, line)
        is_or = self._is_or(match, line)
        conditions = [
            Is(draft.name, said[0], said[1], word.span)
            for draft, word in zip(self.inputs, inputs, strict=True)
            if (said := self._said(draft, word)) is not None
        ]
        conclusions = tuple(
            Consequent(draft.name, said[0], said[1], word.span)
            for draft, word in zip(self.outputs, outputs, strict=True)
            if (said := self._said(draft, word)) is not None
        )
        return self._rule(line.span, conditions, conclusions, weight, is_or=is_or)

    def _rule(
        self,
        span: Span,
        conditions: list[Is],
        conclusions: tuple[Consequent, ...],
        weight: float,
        *,
        is_or: bool,
    ) -> RuleText | None:
        if not conditions or not conclusions:
            side = "condition" if not conditions else "conclusion"
            message = f"the rule has no {side} and never does anything; it is left out"
            self.findings.warn("empty-rule", message, span)
            return None
        antecedent: Expression = conditions[0]
        if len(conditions) > 1:
            antecedent = Or(tuple(conditions)) if is_or else And(tuple(conditions))
        joined = len(conditions) > 1
        return RuleText(
            antecedent, conclusions, weight, span, joined and not is_or, joined and is_or
        )

    def _said(self, draft: Draft, word: Word) -> tuple[str, tuple[Hedge, ...]] | None:
        """Return term and hedges of an index; None for 0 or where it is at fault."""
        value = number(word.text)
        if value is None or math.isnan(value) or abs(value) > 1e6:
            self.findings.error("not-a-number", f"'{word.text[:40]}' is no term index", word)
            return None
        index = int(abs(value))
        fraction = round(abs(value) - index, 6)
        if value == 0.0:
            return None
        hedges = hedges_of(fraction, self.producer)
        if hedges is None:
            message = f"no hedge is known for the fraction {fraction}"
            self.findings.error("unknown-hedge", message, word)
            return None
        table = self.terms.get(draft.name, {})
        if hedges and hedges[0].name == "any" and index == 0 and table:
            index = min(table)
        if index not in table:
            count = len(table)
            message = f"'{draft.name}' has {count} term(s), so none has the number {index}"
            self.findings.error("undefined-term", message, word)
            return None
        return table[index], ((NOT, *hedges) if value < 0.0 else hedges)

    def _weight(self, match: re.Match[str], line: Word) -> float:
        text = match.group("weight")
        value = number(text.strip()) if text is not None else 1.0
        if text is None:
            message = "the rule has no weight in parentheses; 1 is taken"
            self.findings.warn("missing-weight", message, line)
        elif value is None or math.isnan(value):
            message = f"'{text[:40]}' is no weight"
            self.findings.error("not-a-number", message, line)
        return 1.0 if value is None or math.isnan(value) else value

    def _is_or(self, match: re.Match[str], line: Word) -> bool:
        text = match.group("connective")
        value = number(text) if text else None
        if value not in (1.0, 2.0):
            if text:
                message = f"the connective must be 1 (and) or 2 (or), not '{text[:40]}'"
                self.findings.error("bad-connective", message, line)
            else:
                message = "the rule has no connective; 1 (and) is taken"
                self.findings.warn("bad-connective", message, line)
        return value == 2.0

    @staticmethod
    def _words(match: re.Match[str], group: str, line: Word) -> list[Word]:
        base = line.span.column + match.start(group)
        number_ = line.span.line
        return [
            Word(m.group(), Span(number_, base + m.start(), number_, base + m.end()))
            for m in _NUMBER.finditer(match.group(group))
        ]


# --- Rules as lines of term numbers ---

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
