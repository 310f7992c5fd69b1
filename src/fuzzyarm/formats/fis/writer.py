"""Write FIS for MATLAB, Octave's toolkit or fuzzylite."""

from __future__ import annotations

import math

from fuzzyarm.formats.findings import VALUES, Exported, Findings, written
from fuzzyarm.formats.fis.meaning import INTEGRAL, PRODUCERS, SAMPLINGS, maximum_of_nothing
from fuzzyarm.formats.fis.reader import MATLAB_SHAPES, fis_term
from fuzzyarm.formats.fis.rules import rule_lines
from fuzzyarm.formats.fll.reader import MONOTONIC
from fuzzyarm.formats.rules import MACHINE_EPSILON
from fuzzyarm.formats.shapes import FIS_CONJUNCTIONS, FIS_DISJUNCTIONS, fuzzylite_shape, reverse
from fuzzyarm.formats.writing import (
    HEADER,
    best,
    note_chaining,
    note_left_out,
    note_outside,
    note_threshold,
    one_line,
)
from fuzzyarm.model.rulebase import Input, Output, RuleBase, Shape

_CONJUNCTIONS = reverse(FIS_CONJUNCTIONS)
_DISJUNCTIONS = reverse(FIS_DISJUNCTIONS)
_INTEGRAL = reverse(INTEGRAL)
_NORMS = {
    "matlab": frozenset({"min", "prod", "max", "probor", "sum"}),
    "octave": frozenset((*FIS_CONJUNCTIONS, *FIS_DISJUNCTIONS))
    - {"nilpotent_minimum", "nilpotent_maximum", "normalized_sum"},
    "fuzzylite": frozenset((*FIS_CONJUNCTIONS, *FIS_DISJUNCTIONS)),
}
_PROGRAMS = {"matlab": "MATLAB", "octave": "Octave's toolkit", "fuzzylite": "fuzzylite"}


def write_fis(rulebase: RuleBase, *, producer: str | None = None, lossy: bool = False) -> Exported:
    """Write a rule base as a fuzzy inference system.

    Parameters
    ----------
    rulebase : RuleBase
        Any.
    producer : {"matlab", "octave", "fuzzylite"}, optional
        The program to write for. By default the first of them to which nothing is lost,
        else the one to which least is.
    lossy : bool
        Whether to write even where that program would give other numbers.

    Returns
    -------
    Exported
        The text, unless something cannot be expressed and `lossy` is not set.
    """
    producers = (producer,) if producer is not None else PRODUCERS
    return best([_Writer(rulebase, each, Findings(lossy=lossy)).write() for each in producers])


class _Writer:
    def __init__(self, rulebase: RuleBase, producer: str, findings: Findings) -> None:
        self.rulebase = rulebase
        self.producer = producer
        self.program = _PROGRAMS[producer]
        self.findings = findings

    def write(self) -> Exported:
        rulebase, findings = self.rulebase, self.findings
        note_left_out(rulebase, findings, descriptions=False)
        note_chaining(rulebase, findings, self.program, own=False)
        usual = MACHINE_EPSILON if self.producer == "fuzzylite" else 0.0
        note_threshold(rulebase, findings, self.program, usual)
        note_outside(rulebase.inputs, findings, self.program)
        if self.producer != "fuzzylite":
            note_outside(rulebase.outputs, findings, self.program)
        rules = rule_lines(rulebase, self.producer, findings)
        lines = [f"% {HEADER} for {self.program}.", *self._system(len(rules))]
        for index, variable in enumerate(rulebase.inputs, 1):
            lines += ["", f"[Input{index}]", *self._variable(variable)]
        for index, output in enumerate(rulebase.outputs, 1):
            lines += ["", f"[Output{index}]", *self._variable(output)]
        lines += ["", "[Rules]", *rules]
        text = None if findings.failed else "\n".join(lines) + "\n"
        return Exported(text, findings.all())

    def _system(self, rules: int) -> list[str]:
        rulebase = self.rulebase
        blocks = [block for block in rulebase.blocks if block.rules]
        aggregation = self._one([o.aggregation for o in rulebase.outputs], "aggregation", "max")
        return [
            "[System]",
            f"Name='{one_line(rulebase.name, chr(39), self.findings)}'",
            f"Type='{self._type()}'",
            "Version=2.0",
            f"NumInputs={len(rulebase.inputs)}",
            f"NumOutputs={len(rulebase.outputs)}",
            f"NumRules={rules}",
            f"AndMethod='{self._norm([b.conjunction for b in blocks], 'conjunction')}'",
            f"OrMethod='{self._norm([b.disjunction for b in blocks], 'disjunction')}'",
            f"ImpMethod='{self._norm([b.implication for b in blocks], 'implication')}'",
            f"AggMethod='{self._known(_DISJUNCTIONS[aggregation])}'",
            f"DefuzzMethod='{self._method()}'",
        ]

    def _type(self) -> str:
        methods = {output.defuzzifier.method for output in self.rulebase.outputs}
        if methods <= {"weighted-average", "weighted-sum"}:
            return "sugeno"
        return "tsukamoto" if methods == {"tsukamoto"} else "mamdani"

    def _one(self, values: list[str], what: str, default: str) -> str:
        if len(set(values)) > 1:
            message = f"a FIS has one {what} for all, not {', '.join(sorted(set(values)))}"
            self.findings.loss("one-for-all", message)
        return values[0] if values else default

    def _norm(self, values: list[str], what: str) -> str:
        table = _DISJUNCTIONS if what == "disjunction" else _CONJUNCTIONS
        default = "max" if what == "disjunction" else "min"
        return self._known(table[self._one(values, what, default)])

    def _known(self, name: str) -> str:
        if name not in _NORMS[self.producer]:
            self.findings.loss("unsupported-norm", f"{self.program} has no norm '{name}'")
        return name

    def _method(self) -> str:
        names = [self._defuzzifier(output) for output in self.rulebase.outputs]
        return self._one(names, "defuzzifier", "centroid")

    def _defuzzifier(self, output: Output) -> str:
        method = output.defuzzifier.method
        kinds = {term.shape.kind for term in output.terms}
        if method == "tsukamoto":
            if self.producer != "fuzzylite" or not kinds <= MONOTONIC:
                message = f"{self.program} has no Tsukamoto inference for '{output.name}'"
                self.findings.loss("unsupported-defuzzifier", message)
            return "wtaver"
        if method in ("weighted-average", "weighted-sum"):
            if not kinds <= VALUES:
                message = f"'{output.name}' has sets where {self.program} needs values"
                self.findings.loss("set-as-value", message)
            if self.producer == "matlab" and output.aggregation != "sum":
                message = f"MATLAB adds up the rules of '{output.name}' whatever the aggregation"
                self.findings.loss("unsupported-norm", message)
            self._check_equal_values(output)
            return "wtaver" if method == "weighted-average" else "wtsum"
        if kinds & VALUES:
            message = f"'{output.name}' has values among its terms, which cannot be integrated"
            self.findings.loss("value-as-set", message)
        return self._sampled(output)

    def _check_equal_values(self, output: Output) -> None:
        shapes = [term.shape for term in output.terms]
        merged = self.producer == "octave" and output.aggregation != "sum"
        if merged and len(set(shapes)) < len(shapes):
            message = f"Octave's toolkit makes one of equal terms of '{output.name}'"
            self.findings.loss("equal-values", message)

    def _sampled(self, output: Output) -> str:
        defuzzifier = output.defuzzifier
        resolution, sampling = SAMPLINGS[self.producer]
        found = (defuzzifier.resolution, defuzzifier.sampling)
        if self.producer == "octave" and found == (resolution, "trapezoid"):
            if defuzzifier.method == "centroid":
                return "centroid_integral"
        elif found == (resolution, sampling):
            return _INTEGRAL[defuzzifier.method]
        message = (
            f"'{output.name}' is not defuzzified over {resolution} {sampling}, as "
            f"{self.program} does"
        )
        self.findings.loss("sampling", message)
        return _INTEGRAL[defuzzifier.method]

    def _variable(self, variable: Input | Output) -> list[str]:
        lines = [
            f"Name='{one_line(variable.name, chr(39), self.findings)}'",
            f"Range=[{written(variable.low)} {written(variable.high)}]",
        ]
        if isinstance(variable, Output):
            lines += self._no_rule(variable)
        lines.append(f"NumMFs={len(variable.terms)}")
        for index, term in enumerate(variable.terms, 1):
            name = one_line(term.name, "'", self.findings)
            lines.append(f"MF{index}='{name}':{self._term(variable, term.name, term.shape)}")
        return lines

    def _term(self, variable: Input | Output, name: str, shape: Shape) -> str:
        if self.producer == "fuzzylite":
            shape = fuzzylite_shape(shape)
        kind, numbers = fis_term(shape, self.producer)
        foreign = kind not in MATLAB_SHAPES or shape.height != 1.0
        if self.producer != "fuzzylite" and foreign:
            message = f"{self.program} has nothing like '{name}' of '{variable.name}' ({kind})"
            self.findings.loss("unsupported-shape", message)
        if shape.kind in VALUES and shape.height != 1.0:
            message = f"the height of '{name}' of '{variable.name}' has no place in a FIS"
            self.findings.loss("unsupported-height", message)
        return f"'{kind}',{numbers}"

    def _no_rule(self, output: Output) -> list[str]:
        if output.no_rule == "error":
            message = f"'{output.name}' is an error where no rule fires; the file cannot say so"
            self.findings.warn("no-rule", message)
            return []
        usual = self._usual(output)
        if self.producer == "fuzzylite":
            lines = ["LockRange=1"] if output.outside == "clamp" else []
            if output.no_rule == "hold":
                return [*lines, "LockPrevious=1"]
            if not _same(output.no_rule, usual):
                lines.append(f"Default={written(float(output.no_rule))}")
            return lines
        if not _same(output.no_rule, usual):
            message = (
                f"'{output.name}' is {output.no_rule} where no rule fires, to {self.program} "
                f"{usual}"
            )
            self.findings.loss("no-rule", message)
        return []

    def _usual(self, output: Output) -> float:
        if self.producer == "matlab":
            return 0.5 * (output.low + output.high)
        return maximum_of_nothing(output) if self.producer == "fuzzylite" else math.nan


def _same(value: float | str, other: float) -> bool:
    if isinstance(value, str):
        return False
    return value == other or (math.isnan(value) and math.isnan(other))
