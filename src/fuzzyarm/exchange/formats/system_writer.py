"""From a rule base to the lines of a file, in the dialect of a program.

:class:`SystemWriter` walks the rule base once and calls the writer of a format for each piece. It
refuses features that the program lacks, by name.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace

from fuzzyarm.base.diagnostic import Severity
from fuzzyarm.base.numbers import counted
from fuzzyarm.exchange.formats.dialects import MACHINE_EPSILON, Dialect, word_of
from fuzzyarm.exchange.formats.drafts import VALUES, all_invertible, maximum_of_nothing, same_number
from fuzzyarm.exchange.formats.findings import Exported, Findings
from fuzzyarm.exchange.formats.meaning import hedges_of_conclusion
from fuzzyarm.exchange.formats.shapes import class_and_numbers, fuzzylite_shape
from fuzzyarm.exchange.formats.writing import WrittenNames
from fuzzyarm.language.model.rulebase import (
    Input,
    Output,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
    propositions,
)
from fuzzyarm.symbolic.formulas import FormulaError
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, SNORMS, TNORMS
from fuzzyarm.symbolic.records import Norm

HEADER = "Written by fuzzyarm"


class SystemWriter:
    """Writes a rule base for a program.

    Walks once through names, variables and blocks; the methods of the format return the lines of
    each. The format gets its words here, with a refusal by name of all that its dialect lacks.

    Attributes
    ----------
    file : str
        The file in messages.
    descriptions : bool
        Whether the format has descriptions.
    """

    file = "the file"
    descriptions = False

    def __init__(self, rulebase: RuleBase, dialect: Dialect, *, lossy: bool, strict: bool) -> None:
        self.rulebase = rulebase
        self.dialect = dialect
        self.program = dialect.program
        self.findings = Findings(lossy=lossy, strict=strict)
        self.names = WrittenNames()

    def lines(self) -> list[str]:
        """Return the lines of the file; report omissions."""
        rulebase = self.rulebase
        self.settle_names()
        lines = self.head()
        for index, variable in enumerate(rulebase.inputs, 1):
            lines += self.variable(variable, index)
        for index, output in enumerate(rulebase.outputs, 1):
            lines += self.variable(output, index)
        lines += self.between()
        for index, block in enumerate(rulebase.blocks, 1):
            lines += self.block(block, index)
        return [*lines, *self.foot()]

    # --- Pieces, by format ---

    def settle_names(self) -> None:
        """Choose the names of variables and terms in the file."""

    def head(self) -> list[str]:
        """Return the lines before the variables."""
        raise NotImplementedError

    def variable(self, variable: Input | Output, index: int) -> list[str]:
        """Return the lines of an input or output, numbered from 1."""
        raise NotImplementedError

    def between(self) -> list[str]:
        """Return the lines between variables and rules."""
        return []

    def block(self, block: RuleBlock, index: int) -> list[str]:
        """Return the lines of a rule block, numbered from 1."""
        raise NotImplementedError

    def foot(self) -> list[str]:
        """Return the lines after the rules."""
        return []

    # --- The frame ---

    def export(self) -> Exported:
        """Return the text, if nothing prevents it, and the findings."""
        rulebase, dialect, findings = self.rulebase, self.dialect, self.findings
        if refuse_type_2(rulebase, findings, self.program):
            return Exported(None, findings.all())
        if not rulebase.outputs:
            findings.error("no-engine", "the rule base has no output")
        note_left_out(rulebase, findings, descriptions=self.descriptions, outside=dialect.outside)
        note_chaining(rulebase, findings, self.program, only_across_blocks=dialect.chains)
        if not dialect.thresholds:
            settled = _with_usual_thresholds(rulebase, dialect)
            note_threshold(settled, findings, self.program, dialect.threshold)
        if "inputs" not in dialect.clamps:
            self._note_outside(rulebase.inputs)
        if "outputs" not in dialect.clamps:
            self._note_outside(rulebase.outputs)
        lines = self.lines()
        return findings.exported("\n".join(lines) + "\n")

    def _note_outside(self, variables: tuple[Input | Output, ...]) -> None:
        for variable in variables:
            if variable.outside == "clamp":
                message = (
                    f"'{variable.name}' is clamped to its range, which {self.program} does not do"
                )
                self.findings.loss("outside-range", message, slight=True)
            elif isinstance(variable, Input) and self.dialect.outside not in (
                "extend",
                variable.outside,
            ):
                message = f"{self.program} refuses values of '{variable.name}' outside its range"
                self.findings.loss("outside-range", message, slight=True)

    # --- Where no rule fires ---

    def no_rule(self, output: Output) -> float | str | None:
        """Return the file's statement for an output without a fired rule: a number or ``hold``.

        None for the program's default; values that the file cannot express are reported.
        """
        value = output.no_rule
        if self.dialect.no_rule == "nothing" and self._takes_maximum_of_nothing(output):
            return None
        self._warn_of_error(output)
        if value == "error":
            return None
        if value == "hold" and self.dialect.holds:
            return "hold"
        usual = self._usual(output)
        if same_number(value, usual):
            return None
        if value == "hold" or not self.dialect.defaults:
            state = "holds its value" if value == "hold" else f"is {value}"
            message = f"'{output.name}' {state} where no rule fires, to {self.program} {usual}"
            self.findings.loss("no-rule", message)
            return None
        return value

    def _usual(self, output: Output) -> float:
        """Return the program's default for an output without a fired rule."""
        match self.dialect.no_rule:
            case "middle":
                return 0.5 * (output.low + output.high)
            case "maximum" | "nothing":
                return maximum_of_nothing(output)
        return math.nan

    def _takes_maximum_of_nothing(self, output: Output) -> bool:
        """Whether fuzzylite (C++) has its own value for this output without a fired rule."""
        if output.defuzzifier.record.of != "top":
            return False
        self._warn_of_error(output)
        value = maximum_of_nothing(output)
        if output.no_rule != "error" and not same_number(output.no_rule, value):
            message = (
                f"'{output.name}' is {output.no_rule} where no rule fires, to fuzzylite 7 {value:g}"
            )
            self.findings.loss("no-rule", message)
        return True

    def one_line(self, text: str, forbidden: str) -> str:
        """Return `text` on one line without `forbidden` characters; report a change."""
        cleaned = "".join(" " if c in forbidden or not c.isprintable() else c for c in text)
        cleaned = cleaned.strip()
        if cleaned != text:
            message = f"'{text[:40]}' is written without special characters"
            self.findings.info("changed-text", message)
        return cleaned

    # --- Words of norms, hedges and shapes, or a refusal by name ---

    def tnorm(self, name: str, other: str = "") -> str:
        """Return the word for a T-norm; `other` is a key to try before min."""
        return self._norm(TNORMS, name, "min", other)

    def snorm(self, name: str, other: str = "") -> str:
        """Return the word for an S-norm; `other` is a key to try before max."""
        return self._norm(SNORMS, name, "max", other)

    def _norm(self, kinds: Mapping[str, Norm], name: str, usual: str, other: str) -> str:
        word = word_of(kinds, name, self.dialect.kinds)
        if word is not None:
            return word
        word = word_of(kinds, name, other)
        message = f"{self.program} has no norm '{word or name}'"
        self.findings.loss("unsupported-norm", message)
        return word or word_of(kinds, usual, self.dialect.kinds) or usual

    def nothing_like(self, variable: Input | Output, term: Term, *, lossy: bool = False) -> None:
        """Report a shape that the program lacks."""
        kind = term.shape.kind
        message = f"{self.program} has nothing like '{term.name}' of '{variable.name}' ({kind})"
        report = self.findings.loss if lossy else self.findings.error
        report("unsupported-shape", message, term.span)

    def bad_formula(self, shape: Shape, fault: FormulaError) -> None:
        """Report an unreadable formula of the model."""
        self.findings.error("bad-formula", f"in '{shape.formula[:60]}': {fault}")

    def without_height(self, variable: Input | Output, term: Term) -> Shape:
        """Return the shape of a term with height 1; report its height."""
        if term.shape.height == 1.0:
            return term.shape
        height = f"the height of '{term.name}' of '{variable.name}'"
        message = f"{self.file} cannot hold {height}"
        self.findings.loss("unsupported-height", message, term.span)
        return replace(term.shape, height=1.0)

    def fuzzylite_term(self, variable: Input | Output, term: Term) -> str:
        """Return the class and numbers of a term for FLL and FCL of fuzzylite."""
        shape = term.shape
        if shape.kind in VALUES:
            shape = self.without_height(variable, term)
        try:
            shape = fuzzylite_shape(shape)
            text = class_and_numbers(shape, self.dialect.kinds, self.names.variables)
        except FormulaError as fault:
            self.bad_formula(shape, fault)
            return ""
        if text is None:
            self.nothing_like(variable, term)
        return text or ""

    # --- Defuzzifiers ---

    def defuzzifier(self, output: Output) -> str:
        """Return the word for the defuzzifier of an output; report a difference in meaning."""
        record = output.defuzzifier.record
        if record.inverts:
            self._need_inverses(output)
        elif record.weighs:
            self.need_values(output, refused=not self.dialect.activates)
        else:
            self.need_sets(output)
            self.note_sampling(output)
        return self.method(output)

    def _need_inverses(self, output: Output) -> None:
        """Report terms without inverse: fuzzylite chooses Tsukamoto's method by the terms."""
        if not self.dialect.says_inference and not all_invertible(
            {term.shape.kind for term in output.terms}
        ):
            message = (
                f"to fuzzylite '{output.name}' is Tsukamoto's if all of its terms have an inverse, "
                "which some have not"
            )
            self.findings.loss("unsupported-defuzzifier", message)

    def note_sampling(self, output: Output) -> None:
        """Report an output with samples other than the program's."""
        defuzzifier, (count, sampling) = output.defuzzifier, self.dialect.samples
        resolution = defuzzifier.resolution
        if count == 0:  # an exact integral
            same, way = resolution is None, "exactly"
        elif self.dialect.resolutions:
            same = resolution is not None and defuzzifier.sampling == sampling
            way = f"at {sampling}"
        else:
            same = (resolution, defuzzifier.sampling) == (count, sampling)
            way = f"over {count} samples ({sampling})"
        if not same:
            message = f"'{output.name}' is not defuzzified {way}, as {self.program} does"
            self.findings.loss("sampling", message, slight=True)

    def method(self, output: Output) -> str:
        """Return the word for a defuzzifier or its closest relative, or refuse it by name."""
        return word_of_method(output, self.dialect.methods, self.program, self.findings)

    def need_values(self, output: Output, *, refused: bool = False) -> None:
        """Report sets under a weighted defuzzifier; some programs refuse them."""
        if not {term.shape.kind for term in output.terms} <= VALUES:
            method = output.defuzzifier.method
            message = f"'{output.name}' has sets where {self.program} needs values ({method})"
            report = self.findings.error if refused else self.findings.loss
            report("set-as-value", message)

    def need_sets(self, output: Output) -> None:
        """Report values under an integrating defuzzifier."""
        if {term.shape.kind for term in output.terms} & VALUES:
            to_fuzzylite = "which fuzzylite takes for sets"
            why = to_fuzzylite if self.dialect.activates else "which cannot be integrated"
            message = f"'{output.name}' has values among its terms, {why}"
            self.findings.loss("value-as-set", message)

    def _warn_of_error(self, output: Output) -> None:
        """Report an output with an error for no rule."""
        if output.no_rule == "error":
            instead = self.dialect.instead_of_error or "the file cannot say so"
            message = f"'{output.name}' is an error where no rule fires; {instead}"
            self.findings.warn("no-rule", message)


def word_of_method(output: Output, key: str, program: str, findings: Findings) -> str:
    """Return the word for a defuzzifier, or, as a loss, that of its closest relative.

    A program with neither refuses it by name.
    """
    record = output.defuzzifier.record
    names = (record.name, *_same_over(output))
    word = next(filter(None, (word_of(DEFUZZIFIERS, name, key) for name in names)), None)
    like = word_of(DEFUZZIFIERS, record.like, key)
    if word is None:
        message = f"{program} has no {record.name} for '{output.name}'"
        if like is None:
            findings.error("unsupported-defuzzifier", message)
        else:
            message += f"; {like}, which it has, is {record.like}"
            findings.loss("unsupported-defuzzifier", message)
    return word or like or ""


def _same_over(output: Output) -> Iterator[str]:
    """Yield the defuzzifiers with the same result in a range on one side of 0."""
    record, values = output.defuzzifier.record, {term.shape.kind for term in output.terms} & VALUES
    if record.of != "top" or output.low < 0.0 < output.high or values:
        return
    ends = ((1.0, 3.0), (2.0, 7.0)) if output.low >= 0.0 else ((-3.0, -1.0), (-7.0, -2.0))
    tried = [
        {"first": a, "last": b, "mean": a + 0.3 * (b - a), "nearest": min(a, b, key=abs)}
        for a, b in ends
    ]
    for other in DEFUZZIFIERS.values():
        if other.of == "top" and all(other.value(each) == record.value(each) for each in tried):
            yield other.name


def best(attempts: list[Exported]) -> Exported:
    """Return the first attempt with the fewest errors, then warnings, then remarks."""

    def cost(attempt: Exported) -> tuple[int, int, int]:
        return (*_lost(attempt, ("threshold",)), len(attempt.diagnostics))

    return min(attempts, key=cost)


def likeliest(attempts: list[Exported]) -> Exported:
    """Return the first attempt, or the best one if it changes fewer numbers inside ranges.

    The first program is the reader's assumption for a file without other evidence.
    """
    edges = ("threshold", "outside-range", "no-rule")
    first, other = attempts[0], best(attempts)
    return first if _lost(first, edges) <= _lost(other, edges) else other


def _lost(attempt: Exported, slight: tuple[str, ...]) -> tuple[int, int]:
    """Return the number of errors, and of warnings other than the slight ones."""
    # fuzzylite's threshold changes less than the coarser samples of another program.
    warned = [d for d in attempt.diagnostics if d.severity is Severity.WARNING]
    return len(attempt.errors), sum(d.name not in slight for d in warned)


# --- Omissions ---


def refuse_type_2(rulebase: RuleBase, findings: Findings, program: str) -> bool:
    """Refuse interval type 2, by name: without the lower terms it is a different system."""
    if not rulebase.is_type2:
        return False
    variables = (*rulebase.inputs, *rulebase.outputs)
    used = [f"'{v.name} is {t.name}'" for v in variables for t in v.terms if t.lower is not None]
    ways = [o for o in rulebase.outputs if o.defuzzifier.record.type2]
    used += [f"{way.defuzzifier.method} of '{way.name}'" for way in ways]
    message = f"{used[0]} is of interval type 2, which is not written for {program}"
    findings.error("unsupported-type", message)
    return True


def note_left_out(
    rulebase: RuleBase, findings: Findings, *, descriptions: bool, outside: str = "extend"
) -> None:
    """Report the parts that no format has; `outside` is the program's treatment of them."""
    if rulebase.lookup is not None:
        findings.info("dropped-lookup", "the lookup settings are left out")
    if rulebase.expectations:
        count = len(rulebase.expectations)
        findings.info("dropped-expectations", f"{counted(count, 'expectation')} left out")
    if rulebase.properties:
        count = len(rulebase.properties)
        findings.info("dropped-properties", f"{counted(count, '`prove` line')} left out")
    if rulebase.tuning is not None:
        findings.info("dropped-tuning", "the `tune` lines are left out")
    variables = (*rulebase.inputs, *rulebase.outputs)
    described = any(v.description for v in variables) or bool(rulebase.description)
    if described and not descriptions:
        findings.info("dropped-description", "descriptions are left out")
    for variable in variables:
        if variable.outside == "error" and outside != "error":
            message = f"'{variable.name}' refuses values outside its range; the file cannot"
            findings.warn("outside-range", message)


def note_chaining(
    rulebase: RuleBase, findings: Findings, program: str, *, only_across_blocks: bool
) -> None:
    """Report outputs in antecedents; with `only_across_blocks` those of another block alone.

    fuzzylite takes their current activation; that is the same only if all rules that conclude the
    output are in the block, before those that use it.
    """
    outputs = {output.name for output in rulebase.outputs}
    last: dict[str, tuple[int, int]] = {}
    for number, block in enumerate(rulebase.blocks):
        for index, rule in enumerate(block.rules):
            last |= {consequent.variable: (number, index) for consequent in rule.consequents}
    for number, block in enumerate(rulebase.blocks):
        for index, rule in enumerate(block.rules):
            names = {part.variable for part in propositions(rule.antecedent)}
            for name in sorted(names & outputs):
                writer = last.get(name, (number, -1))
                if only_across_blocks and writer[0] == number and writer[1] < index:
                    continue
                message = f"a rule uses the output '{name}' in a way that {program} does not"
                findings.loss("chained-output", message, rule.span)


def note_threshold(rulebase: RuleBase, findings: Findings, program: str, usual: float) -> None:
    """Report blocks with a threshold other than the program's."""
    for block in rulebase.blocks:
        if block.threshold == usual:
            continue
        rules = f"rules of the block '{block.name}'" if block.name else "the rules"
        message = f"{rules} fire above {block.threshold}, in {program} above {usual}"
        slight = max(block.threshold, usual) <= MACHINE_EPSILON
        findings.loss("threshold", message, slight=slight)


def _with_usual_thresholds(rulebase: RuleBase, dialect: Dialect) -> RuleBase:
    """Set the program's threshold in blocks where hedged conclusions yield it."""
    if not dialect.activates:
        return rulebase
    blocks = tuple(
        replace(block, threshold=dialect.threshold)
        if block.rules and all(hedges_of_conclusion(r, block, dialect) for r in block.rules)
        else block
        for block in rulebase.blocks
    )
    return replace(rulebase, blocks=blocks)
