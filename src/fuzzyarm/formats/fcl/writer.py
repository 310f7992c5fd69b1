"""Write FCL for fuzzylite or jFuzzyLogic."""

from __future__ import annotations

import math

from fuzzyarm.formats.draft import VALUES
from fuzzyarm.formats.export import (
    FUZZYLITE_WORDS,
    HEADER,
    Names,
    best,
    identifiers,
    note_chaining,
    note_left_out,
    note_outside,
    note_threshold,
    one_line,
)
from fuzzyarm.formats.fcl.dialect import INTEGRAL, SAMPLINGS
from fuzzyarm.formats.fcl.lexer import KEYWORDS
from fuzzyarm.formats.fcl.plain_text import plain_rule, plain_term
from fuzzyarm.formats.fll.terms import term_text
from fuzzyarm.formats.fuzzylite_rules import MACHINE_EPSILON
from fuzzyarm.formats.fuzzylite_shapes import fuzzylite_shape
from fuzzyarm.formats.fuzzylite_text import rule_text, said_rules
from fuzzyarm.formats.imported import Exported, Findings
from fuzzyarm.formats.norms import (
    FCL_CONJUNCTIONS,
    FCL_DISJUNCTIONS,
    JFUZZYLOGIC_PAIRS,
    reverse,
)
from fuzzyarm.formats.numerals import written
from fuzzyarm.rulebase.model import Input, Output, RuleBase, RuleBlock, Term

_INTEGRAL = reverse(INTEGRAL)
_PROGRAMS = {"fuzzylite": "fuzzylite", "jfuzzylogic": "jFuzzyLogic"}
_CONJUNCTIONS = {
    "fuzzylite": reverse(FCL_CONJUNCTIONS, ("NMIN",)),
    "jfuzzylogic": {
        "min": "MIN", "product": "PROD", "bounded": "BDIF", "drastic": "DMIN",
        "hamacher": "HAMACHER", "nilpotent": "NIPMIN",
    },
}  # fmt: skip
_ACCUMULATIONS = {
    "fuzzylite": reverse(FCL_DISJUNCTIONS, ("NMAX",)),
    "jfuzzylogic": {
        "max": "MAX", "bounded": "BSUM", "normalized": "NSUM", "probor": "PROBOR", "sum": "SUM",
    },
}  # fmt: skip
_RESERVED = frozenset(word.lower() for word in KEYWORDS) | {
    "if", "is", "then", "with", "not", "and", "or", "real", "nan", "nc", "constant", "function",
    "linear", "discrete", "points",
}  # fmt: skip


def write_fcl(rulebase: RuleBase, *, dialect: str | None = None, lossy: bool = False) -> Exported:
    """Write a rule base as a function block of IEC 61131-7.

    Parameters
    ----------
    rulebase : RuleBase
        Any.
    dialect : {"jfuzzylogic", "fuzzylite"}, optional
        The program to write for. By default the one to which less is lost.
    lossy : bool
        Whether to write even where that program would give other numbers.

    Returns
    -------
    Exported
        The text, unless something cannot be expressed and `lossy` is not set.
    """
    dialects = (dialect,) if dialect is not None else ("fuzzylite", "jfuzzylogic")
    return best([_Writer(rulebase, each, Findings(lossy=lossy)).write() for each in dialects])


class _Writer:
    def __init__(self, rulebase: RuleBase, dialect: str, findings: Findings) -> None:
        self.rulebase = rulebase
        self.dialect = dialect
        self.program = _PROGRAMS[dialect]
        self.findings = findings
        self.names = Names()

    def write(self) -> Exported:
        rulebase, findings = self.rulebase, self.findings
        own = self.dialect == "fuzzylite"
        note_left_out(rulebase, findings, descriptions=False)
        note_chaining(rulebase, findings, self.program, own=own)
        note_threshold(rulebase, findings, self.program, MACHINE_EPSILON if own else 0.0)
        note_outside(rulebase.inputs, findings, self.program)
        if not own:
            note_outside(rulebase.outputs, findings, self.program)
        reserved = _RESERVED | FUZZYLITE_WORDS
        self.names = identifiers(rulebase, findings, reserved, ignore_case=True)
        name = one_line(rulebase.name, ";:#/()", findings)
        lines = [f"// {HEADER} for {self.program}.", "", f"FUNCTION_BLOCK {name}".rstrip()]
        lines += self._declared("VAR_INPUT", rulebase.inputs)
        lines += self._declared("VAR_OUTPUT", rulebase.outputs)
        for variable in rulebase.inputs:
            lines += ["", *self._fuzzify(variable)]
        for output in rulebase.outputs:
            lines += ["", *self._defuzzify(output)]
        for block in rulebase.blocks:
            lines += ["", *self._block(block)]
        lines += ["", "END_FUNCTION_BLOCK"]
        text = None if findings.failed else "\n".join(lines) + "\n"
        return Exported(text, findings.all())

    def _declared(self, key: str, variables: tuple[Input | Output, ...]) -> list[str]:
        lines = ["", key]
        for variable in variables:
            lines.append(f"  {self.names.variable(variable.name)} : REAL;")
            bounded = math.isfinite(variable.low) and math.isfinite(variable.high)
            if self.dialect == "jfuzzylogic" and bounded and isinstance(variable, Input):
                lines[-1] += f" {_range(variable)}"
        return [*lines, "END_VAR"]

    def _fuzzify(self, variable: Input) -> list[str]:
        lines = [f"FUZZIFY {self.names.variable(variable.name)}"]
        if self.dialect == "fuzzylite":
            lines.append(f"  {_range(variable)}")
        return [*lines, *self._terms(variable), "END_FUZZIFY"]

    def _terms(self, variable: Input | Output) -> list[str]:
        return [
            f"  TERM {self.names.term(variable.name, term.name)} := {self._term(variable, term)};"
            for term in variable.terms
        ]

    def _term(self, variable: Input | Output, term: Term) -> str:
        if self.dialect == "jfuzzylogic":
            return plain_term(variable, term, self.rulebase, self.names, self.findings)
        shape = fuzzylite_shape(term.shape)
        text = term_text(shape, self.names.variables)
        if text is None:
            message = f"the height of '{term.name}' of '{variable.name}' has no place in FCL"
            self.findings.loss("unsupported-height", message, term.span)
            text = written(shape.parameters[-1])
        return text.removeprefix("Constant ")

    def _defuzzify(self, output: Output) -> list[str]:
        lines = [f"DEFUZZIFY {self.names.variable(output.name)}", *self._terms(output)]
        if self.dialect == "fuzzylite" or math.isfinite(output.low + output.high):
            lines.insert(1, f"  {_range(output)}")
        lines.append(f"  METHOD : {self._method(output)};")
        weighted = output.defuzzifier.method not in _INTEGRAL
        if self.dialect == "fuzzylite" and not (weighted and output.aggregation == "sum"):
            lines.append(f"  ACCU : {_ACCUMULATIONS['fuzzylite'][output.aggregation]};")
        lines += self._default(output)
        if self.dialect == "fuzzylite" and output.outside != "extend":
            lines.append("  LOCK : RANGE;")
        return [*lines, "END_DEFUZZIFY"]

    def _default(self, output: Output) -> list[str]:
        if output.no_rule == "hold":
            return ["  LOCK : PREVIOUS;"] if self.dialect == "fuzzylite" else ["  DEFAULT := NC;"]
        if output.no_rule == "error":
            message = f"'{output.name}' is an error where no rule fires; the file cannot say so"
            self.findings.warn("no-rule", message)
        value = output.no_rule if isinstance(output.no_rule, float | int) else math.nan
        if math.isfinite(value):
            return [f"  DEFAULT := {written(value)};"]
        return [f"  DEFAULT := {written(value)};"] if self.dialect == "fuzzylite" else []

    def _method(self, output: Output) -> str:
        method = output.defuzzifier.method
        kinds = {term.shape.kind for term in output.terms}
        if method == "tsukamoto" and self.dialect == "fuzzylite":
            return "COGS"
        if method in ("weighted-average", "weighted-sum"):
            if not kinds <= VALUES:
                message = f"'{output.name}' has sets where {self.program} needs values"
                self.findings.loss("set-as-value", message)
            if method == "weighted-average":
                return "COGS" if kinds <= {"singleton"} or self.dialect == "fuzzylite" else "COGF"
            if self.dialect == "fuzzylite":
                return "COGSS"
        if method not in _INTEGRAL:
            message = f"{self.program} has no {method} for '{output.name}'"
            self.findings.loss("unsupported-defuzzifier", message)
            return "COGS"
        if self.dialect == "jfuzzylogic" and kinds == {"singleton"}:
            message = f"'{output.name}' has singletons for terms but integrates sets"
            self.findings.warn("value-as-set", message)
        elif kinds & VALUES:
            message = f"'{output.name}' has values among its terms, which cannot be integrated"
            self.findings.loss("value-as-set", message)
        found = (output.defuzzifier.resolution, output.defuzzifier.sampling)
        resolution, sampling = SAMPLINGS[self.dialect]
        if found != (resolution, sampling):
            message = (
                f"'{output.name}' is not defuzzified over {resolution} {sampling} samples, as "
                f"{self.program} does"
            )
            self.findings.loss("sampling", message)
        return _INTEGRAL[method]

    def _block(self, block: RuleBlock) -> list[str]:
        lines = [f"RULEBLOCK {one_line(block.name, ';:#/() ', self.findings)}".rstrip()]
        if self.dialect == "fuzzylite":
            lines += [
                f"  AND : {_CONJUNCTIONS['fuzzylite'][block.conjunction]};",
                f"  OR : {_ACCUMULATIONS['fuzzylite'][block.disjunction]};",
                f"  ACT : {_CONJUNCTIONS['fuzzylite'][block.implication]};",
            ]
            rules = [
                rule_text(said, block, self.names, self.findings) for said in said_rules(block)
            ]
        else:
            lines += self._plain_norms(block)
            rules = [plain_rule(rule, self.names, self.findings) for rule in block.rules]
        lines += [f"  RULE {number} : {rule};" for number, rule in enumerate(rules, 1)]
        return [*lines, "END_RULEBLOCK"]

    def _plain_norms(self, block: RuleBlock) -> list[str]:
        conjunctions, accumulations = _CONJUNCTIONS["jfuzzylogic"], _ACCUMULATIONS["jfuzzylogic"]
        if JFUZZYLOGIC_PAIRS.get(block.conjunction) != block.disjunction:
            message = (
                f"jFuzzyLogic has no pair {block.conjunction} and {block.disjunction} for AND "
                "and OR"
            )
            self.findings.loss("unsupported-norm", message)
        if block.implication not in ("min", "product"):
            message = f"jFuzzyLogic has no implication {block.implication}"
            self.findings.loss("unsupported-norm", message)
        concluded = {c.variable for rule in block.rules for c in rule.consequents}
        used = [o.aggregation for o in self.rulebase.outputs if o.name in concluded]
        if len(set(used)) > 1:
            message = "jFuzzyLogic has one accumulation for all outputs of a block"
            self.findings.loss("one-for-all", message)
        aggregation = used[0] if used else "max"
        if aggregation not in accumulations:
            message = f"jFuzzyLogic has no accumulation {aggregation}"
            self.findings.loss("unsupported-norm", message)
        return [
            f"  AND : {conjunctions.get(block.conjunction, 'MIN')};",
            f"  ACT : {'PROD' if block.implication == 'product' else 'MIN'};",
            f"  ACCU : {accumulations.get(aggregation, 'MAX')};",
        ]


def _range(variable: Input | Output) -> str:
    return f"RANGE := ({written(variable.low)} .. {written(variable.high)});"
