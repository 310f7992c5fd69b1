"""FIS, written for MATLAB, Octave's toolkit or fuzzylite."""

from __future__ import annotations

from fuzzyarm.exchange.formats.dialects import FIS, Dialect
from fuzzyarm.exchange.formats.drafts import VALUES
from fuzzyarm.exchange.formats.findings import Exported, all_written, written
from fuzzyarm.exchange.formats.fis_text import fractions, hedges_of
from fuzzyarm.exchange.formats.meaning import POWERS, root
from fuzzyarm.exchange.formats.sentences import NOT, hedged
from fuzzyarm.exchange.formats.shapes import fuzzylite_formula, fuzzylite_shape, word_and_numbers
from fuzzyarm.exchange.formats.system_writer import HEADER, SystemWriter, likeliest
from fuzzyarm.exchange.formats.writing import Sentence, as_sentences, weight_before
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Expression,
    Hedge,
    Hedged,
    Input,
    Is,
    Or,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Term,
)
from fuzzyarm.symbolic.formulas import FormulaError, read_formula

_Group = dict[str, tuple[Consequent, tuple[Hedge, ...]]]
"""Output → its conclusion and the hedges before it."""


def write_fis(
    rulebase: RuleBase,
    *,
    producer: str | None = None,
    lossy: bool = False,
    strict: bool = False,
) -> Exported:
    """Write a ``.fis`` file: :func:`~fuzzyarm.exchange.formats.registry.write`.

    Parameters
    ----------
    rulebase, producer, lossy, strict
        As there.

    Returns
    -------
    Exported
        The text, if there is no error, and every finding.
    """
    producers = (producer,) if producer is not None else tuple(FIS)
    dialects = [FIS[program] for program in producers]
    return likeliest(
        [_Writer(rulebase, dialect, lossy=lossy, strict=strict).export() for dialect in dialects]
    )


class _Writer(SystemWriter):
    file = "a FIS"

    def settle_names(self) -> None:
        rulebase = self.rulebase
        self.is_own = self.dialect.producer == "fuzzylite"
        self.inputs = [variable.name for variable in rulebase.inputs]
        self.outputs = {output.name: output for output in rulebase.outputs}
        self.numbers = {
            (variable.name, term.name): index
            for variable in (*rulebase.inputs, *rulebase.outputs)
            for index, term in enumerate(variable.terms, 1)
        }
        if sum(bool(block.rules) for block in rulebase.blocks) > 1:
            self.findings.info("dropped-blocks", "the rules of all blocks are put in one list")
        # Before the head, which states their number.
        self.rules = [self._rules(block) for block in rulebase.blocks]

    def head(self) -> list[str]:
        rules = sum(map(len, self.rules))
        return [f"% {HEADER} for {self.program}.", *self._system(rules)]

    def between(self) -> list[str]:
        return ["", "[Rules]"]

    def block(self, block: RuleBlock, index: int) -> list[str]:
        return self.rules[index - 1]

    def _system(self, rules: int) -> list[str]:
        rulebase = self.rulebase
        blocks = [block for block in rulebase.blocks if block.rules]
        conjunction = self._one([b.conjunction for b in blocks], "conjunction", "min")
        disjunction = self._one([b.disjunction for b in blocks], "disjunction", "max")
        implication = self._one([b.implication for b in blocks], "implication", "min")
        aggregation = self._one([o.aggregation for o in rulebase.outputs], "aggregation", "max")
        return [
            "[System]",
            f"Name='{self.one_line(rulebase.name, chr(39))}'",
            f"Type='{self._type()}'",
            "Version=2.0",
            f"NumInputs={len(rulebase.inputs)}",
            f"NumOutputs={len(rulebase.outputs)}",
            f"NumRules={rules}",
            f"AndMethod='{self.tnorm(conjunction, 'fis')}'",
            f"OrMethod='{self.snorm(disjunction, 'fis')}'",
            f"ImpMethod='{self.tnorm(implication, 'fis')}'",
            f"AggMethod='{self.snorm(aggregation, 'fis')}'",
            f"DefuzzMethod='{self._method()}'",
        ]

    def _type(self) -> str:
        records = [output.defuzzifier.record for output in self.rulebase.outputs]
        if all(record.weighs and not record.inverts for record in records):
            return "sugeno"
        return "tsukamoto" if all(record.inverts for record in records) else "mamdani"

    def _one(self, values: list[str], setting: str, default: str) -> str:
        if len(set(values)) > 1:
            message = f"a FIS has one {setting} for all, not {', '.join(sorted(set(values)))}"
            self.findings.loss("one-for-all", message)
        return values[0] if values else default

    def _method(self) -> str:
        names = [self._defuzzifier(output) for output in self.rulebase.outputs]
        method = self._one(names, "defuzzifier", "centroid")
        if len(set(names)) > 1 and method in self.dialect.weighted:
            for output in self.rulebase.outputs:
                self.need_values(output, refused=not self.is_own)
        return method

    def _defuzzifier(self, output: Output) -> str:
        record = output.defuzzifier.record
        if record.inverts and not self.is_own:
            message = f"{self.program} has no Tsukamoto inference for '{output.name}'"
            self.findings.loss("unsupported-defuzzifier", message)
            return "wtaver"
        if record.weighs and not record.inverts:
            if self.dialect.sums_values and output.aggregation != "sum":
                message = f"MATLAB adds up the rules of '{output.name}' whatever the aggregation"
                self.findings.loss("unsupported-norm", message)
            self._check_equal_values(output)
        defuzzifier = output.defuzzifier
        triple = (defuzzifier.method, defuzzifier.resolution, defuzzifier.sampling)
        of_integral = ("centroid", self.dialect.samples[0], "trapezoid")
        if self.dialect.producer == "octave" and triple == of_integral:
            self.need_sets(output)
            return "centroid_integral"
        return self.defuzzifier(output)

    def _check_equal_values(self, output: Output) -> None:
        shapes = [term.shape for term in output.terms]
        merged = self.dialect.producer == "octave" and output.aggregation != "sum"
        if merged and len(set(shapes)) < len(shapes):
            message = f"Octave's toolkit makes one of equal terms of '{output.name}'"
            self.findings.loss("equal-values", message)

    def variable(self, variable: Input | Output, index: int) -> list[str]:
        lines = [
            "",
            f"[{'Output' if isinstance(variable, Output) else 'Input'}{index}]",
            f"Name='{self.one_line(variable.name, chr(39))}'",
            f"Range=[{written(variable.low)} {written(variable.high)}]",
        ]
        if isinstance(variable, Output):
            lines += self._no_rule(variable)
        lines.append(f"NumMFs={len(variable.terms)}")
        for number, term in enumerate(variable.terms, 1):
            name = self.one_line(term.name, "'")
            lines.append(f"MF{number}='{name}':{self._term(variable, term)}")
        return lines

    def _term(self, variable: Input | Output, term: Term) -> str:
        shape = fuzzylite_shape(term.shape) if self.is_own else term.shape
        if shape.kind in VALUES or not self.dialect.heights:
            shape = self.without_height(variable, term)
        in_dialect = word_and_numbers(shape, self.dialect.kinds)
        word_numbers = in_dialect or word_and_numbers(shape, "fis")
        if word_numbers is None:
            self.nothing_like(variable, term)
            return ""
        word, values = word_numbers
        if not self.is_own and in_dialect is None:
            message = f"{self.program} has nothing like '{term.name}' of '{variable.name}' ({word})"
            self.findings.loss("unsupported-shape", message)
        if shape.kind != "formula":
            return f"'{word}',[{all_written(values)}]"
        try:
            odd = [name for name in read_formula(shape.formula).names if not name.isidentifier()]
            text = fuzzylite_formula(shape.formula)
        except FormulaError as fault:
            self.bad_formula(shape, fault)
            return ""
        if odd:  # any text is a name, but not in a formula
            message = f"a formula of fuzzylite cannot have the name '{odd[0]}'"
            self.findings.loss("bad-formula", message, term.span)
        return f"'{word}',[{text}]"

    def _no_rule(self, output: Output) -> list[str]:
        lines = ["LockRange=1"] if self.is_own and output.outside == "clamp" else []
        no_rule = self.no_rule(output)
        if no_rule == "hold":
            lines.append("LockPrevious=1")
        elif no_rule is not None:
            lines.append(f"Default={written(float(no_rule))}")
        return lines

    # --- Rules: a term index for each variable, weight, and connective ---

    def _rules(self, block: RuleBlock) -> list[str]:
        if self.is_own:
            order = {name: index for index, name in enumerate(self.outputs)}
            sentences = as_sentences(block, self.dialect, self.findings, order)
        else:
            sentences = [self._sentence(rule) for rule in block.rules]
        return [line for sentence in sentences for line in self._rule_lines(sentence)]

    def _sentence(self, rule: Rule) -> Sentence:
        """Move the hedges of an antecedent to its values, of which Octave takes the root."""
        conclusions = tuple((c, c.hedges) for c in rule.consequents)
        plain = Sentence(rule.antecedent, conclusions, rule.weight, rule)
        antecedent = rule.antecedent
        values = all(self._takes_value(c) and not c.hedges for c in rule.consequents)
        if self.dialect.producer != "octave" or not isinstance(antecedent, Hedged) or not values:
            return plain
        roots = tuple(map(root, antecedent.hedges))
        weight = weight_before(rule.weight, antecedent.hedges)
        if weight is None:
            return plain
        rooted = tuple((c, roots) for c in rule.consequents)
        return Sentence(antecedent.operand, rooted, weight, rule)

    def _takes_value(self, consequent: Consequent) -> bool:
        record = self.outputs[consequent.variable].defuzzifier.record
        return record.weighs and not record.inverts

    def _rule_lines(self, sentence: Sentence) -> list[str]:
        """Return the line of a rule; several if it concludes an output twice."""
        rule, antecedent = sentence.rule, sentence.antecedent
        conditions = self._conditions(antecedent)
        if conditions is None:
            message = "a rule of a FIS is one list of conditions on inputs, joined by and or by or"
            self.findings.loss("rule-too-rich", message, rule.span)
            return []
        by_name = {part.variable: part for part in conditions}
        codes = [self._code(by_name.get(name), rule) for name in self.inputs]
        connective = 2 if isinstance(antecedent, Or) else 1
        lines = []
        for group in self._groups(sentence):
            left, right = " ".join(codes), " ".join(self._conclusions(group, rule))
            lines.append(f"{left}, {right} ({written(sentence.weight)}) : {connective}")
        return lines

    def _conditions(self, antecedent: Expression) -> list[Is] | None:
        """Return the propositions about different inputs; None for any other antecedent."""
        if isinstance(antecedent, Hedged) and isinstance(antecedent.operand, Is):
            antecedent = hedged(antecedent.hedges, antecedent.operand)
        parts = antecedent.operands if isinstance(antecedent, And | Or) else (antecedent,)
        propositions = [
            part for part in parts if isinstance(part, Is) and part.variable in self.inputs
        ]
        order = [self.inputs.index(part.variable) for part in propositions]
        if len(propositions) != len(parts) or len(set(order)) != len(order):
            return None
        # Two operands give the same bits in either order; products of three may not.
        if order != sorted(order) and len(order) > 2:
            message = "the conditions of a rule are put in the order of the inputs"
            self.findings.info("reordered-conditions", message)
        return propositions

    def _code(self, part: Is | None, rule: Rule) -> str:
        return "0" if part is None else self._number(part.variable, part.term, part.hedges, rule)

    def _number(self, variable: str, term: str, hedges: tuple[Hedge, ...], rule: Rule) -> str:
        negated = hedges[:1] == (NOT,)
        rest = hedges[1:] if negated else hedges
        fraction = 0.0 if not rest else _fraction_of(rest, self.dialect)
        if fraction is None or (rest and self.dialect.producer == "matlab"):
            names = " ".join(hedge.name for hedge in rest)
            message = f"the hedge '{names}' has no number in this FIS"
            self.findings.loss("unsupported-hedge", message, rule.span)
            fraction = 0.0
        code = self.numbers[variable, term] + fraction
        return f"-{written(round(code, 6))}" if negated else written(round(code, 6))

    def _groups(self, sentence: Sentence) -> list[_Group]:
        """Split conclusions so that each line concludes an output at most once."""
        groups: list[_Group] = []
        for consequent, hedges in sentence.conclusions:
            for group in groups:
                if consequent.variable not in group:
                    group[consequent.variable] = (consequent, hedges)
                    break
            else:
                groups.append({consequent.variable: (consequent, hedges)})
        order = [
            list(self.outputs).index(consequent.variable) for consequent, _ in sentence.conclusions
        ]
        in_order = len(groups) == 1 and order == sorted(order)
        if self.is_own and sentence.hedges and not in_order:
            message = "the order of the conclusions of a hedged rule cannot be kept"
            self.findings.loss("rule-too-rich", message, sentence.rule.span)
        return groups

    def _conclusions(self, group: _Group, rule: Rule) -> list[str]:
        codes = []
        for name in self.outputs:
            if name not in group:
                codes.append("0")
                continue
            consequent, hedges = group[name]
            if consequent.hedges and self.is_own:
                message = "hedges on the set of a conclusion have another meaning to fuzzylite"
                self.findings.loss("set-hedge", message, rule.span)
            codes.append(self._number(name, consequent.term, hedges, rule))
        return codes


def _fraction_of(hedges: tuple[Hedge, ...], dialect: Dialect) -> float | None:
    """Return the fraction for `hedges`, or None."""
    if not hedges:
        return 0.0
    for fraction, hedges_there in fractions(dialect).items():
        if hedges_there == hedges:
            return fraction
    if dialect.producer == "fuzzylite" or len(hedges) != 1 or hedges[0].name not in POWERS:
        return None
    fraction = round(_exponent(hedges[0]) / 10.0, 6)
    if not 0.0 < fraction < 1.0:
        return None
    # The fraction has few digits: only if it reads back as the same exponent.
    reading = hedges_of(fraction, dialect) or ()
    return fraction if len(reading) == 1 and _exponent(reading[0]) == _exponent(hedges[0]) else None


def _exponent(hedge: Hedge) -> float:
    return hedge.exponent or POWERS.get(hedge.name, 1.0)
