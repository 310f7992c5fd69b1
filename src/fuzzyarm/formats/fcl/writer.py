"""Write FCL for fuzzylite or jFuzzyLogic."""

from __future__ import annotations

import math
from dataclasses import replace

from fuzzyarm.formats.fcl.dialect import INTEGRAL, SAMPLINGS
from fuzzyarm.formats.fcl.tokens import KEYWORDS
from fuzzyarm.formats.findings import VALUES, Exported, Findings, all_written, written
from fuzzyarm.formats.fll.reader import term_text
from fuzzyarm.formats.formula import JFUZZYLOGIC_NAMES, Node, read_formula, write_formula
from fuzzyarm.formats.rules import MACHINE_EPSILON, NOT
from fuzzyarm.formats.shapes import (
    FCL_CONJUNCTIONS,
    FCL_DISJUNCTIONS,
    JFUZZYLOGIC_PAIRS,
    fuzzylite_shape,
    reverse,
)
from fuzzyarm.formats.writing import (
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
    rule_text,
    said_rules,
)
from fuzzyarm.model.rulebase import (
    And,
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
    Shape,
    Term,
)

# --- Terms and rules in the words of jFuzzyLogic ---

# Kind of shape → word and the order of the numbers in the text.
_WORDS: dict[str, tuple[str, tuple[int, ...]]] = {
    "triangle": ("TRIAN", (0, 1, 2)),
    "trapezoid": ("TRAPE", (0, 1, 2, 3)),
    "gaussian": ("GAUSS", (0, 1)),
    "two-sided-gaussian": ("GAUSS2", (0, 1, 2, 3)),
    "bell": ("GBELL", (1, 2, 0)),
    "sigmoid": ("SIGM", (1, 0)),
    "sigmoid-difference": ("DSIGM", (1, 0, 3, 2)),
}


def plain_term(
    variable: Input | Output, term: Term, rulebase: RuleBase, names: Names, findings: Findings
) -> str:
    """Return the function of a term; report what jFuzzyLogic has nothing for."""
    shape, p = term.shape, term.shape.parameters
    if shape.height != 1.0:
        message = f"the height of '{term.name}' of '{variable.name}' has no place in FCL"
        findings.loss("unsupported-height", message, term.span)
    text = _value(shape, rulebase, names, findings) or _straight(shape) or _curve(shape)
    if text is None:
        message = f"jFuzzyLogic has nothing like '{term.name}' of '{variable.name}' ({shape.kind})"
        findings.loss("unsupported-shape", message, term.span)
        return "0"
    if shape.kind == "sigmoid-difference" and (p[1] <= 0.0 or p[1] != p[3] or p[0] > p[2]):
        message = f"'{term.name}' is a difference that jFuzzyLogic cuts at 0"
        findings.loss("negative-difference", message, term.span)
    return text


def _value(shape: Shape, rulebase: RuleBase, names: Names, findings: Findings) -> str | None:
    p = shape.parameters
    if shape.kind == "singleton":
        return written(p[0])
    if shape.kind == "linear":
        inputs = [names.variable(variable.name) for variable in rulebase.inputs]
        factors = [f"{written(a)} * {name}" for a, name in zip(p, inputs, strict=False)]
        return "FUNCTION " + " + ".join([*factors, written(p[-1])])
    if shape.kind == "formula":
        return f"FUNCTION {_formula(shape.formula, names, findings)}"
    return None


def _straight(shape: Shape) -> str | None:
    p = shape.parameters
    if shape.kind == "points":
        return _pairs(_first_wins(p))
    if not all(map(math.isfinite, p)):
        return None
    if shape.kind == "rectangle":
        return f"TRAPE {all_written((p[0], p[0], p[1], p[1]))}"
    if shape.kind == "ramp" and p[0] != p[1]:
        return _pairs((p[0], 0.0, p[1], 1.0) if p[0] < p[1] else (p[1], 1.0, p[0], 0.0))
    return None


def _curve(shape: Shape) -> str | None:
    p = shape.parameters
    if shape.kind == "cosine":
        return f"COSINE {written(0.5 * p[1])} {written(p[0])}"
    if shape.kind not in _WORDS or not all(map(math.isfinite, p)):
        return None
    word, order = _WORDS[shape.kind]
    return f"{word} {all_written(tuple(p[index] for index in order))}"


def _pairs(values: tuple[float, ...]) -> str:
    pairs = zip(values[0::2], values[1::2], strict=True)
    return " ".join(f"({written(x)}, {written(y)})" for x, y in pairs)


def _first_wins(parameters: tuple[float, ...]) -> tuple[float, ...]:
    """Move points so that the first of two at one x is the larger, as the model takes it."""
    values = list(parameters)
    for i in range(2, len(values), 2):
        if values[i] == values[i - 2] and values[i - 1] < values[i + 1]:
            values[i - 2] = math.nextafter(values[i - 2], -math.inf)
    return tuple(values)


def _formula(text: str, names: Names, findings: Findings) -> str:
    tree = read_formula(text, "fuzzyarm")
    for function in _calls(tree):
        if function not in JFUZZYLOGIC_NAMES:
            message = f"jFuzzyLogic has no function '{function}'"
            findings.loss("unsupported-function", message)
    return write_formula(_without_signs(tree), names.variables, JFUZZYLOGIC_NAMES)


def _without_signs(node: Node) -> Node:
    """Write -(a) as 0 - (a): jFuzzyLogic knows signs of numbers only."""
    arguments = tuple(map(_without_signs, node.arguments))
    if len(arguments) == 1 and not node.is_call:
        arguments = (Node("0"), *arguments)
    return replace(node, arguments=arguments)


def _calls(node: Node) -> list[str]:
    inner = [name for argument in node.arguments for name in _calls(argument)]
    return [node.symbol, *inner] if node.is_call else inner


def plain_rule(rule: Rule, names: Names, findings: Findings) -> str:
    """Return ``IF … THEN …``; jFuzzyLogic has no hedge but NOT."""
    condition = _condition(rule.antecedent, names, findings, rule)
    conclusions = []
    for consequent in rule.consequents:
        if consequent.hedges:
            message = "jFuzzyLogic has no hedges in conclusions"
            findings.loss("set-hedge", message, rule.span)
        term = names.term(consequent.variable, consequent.term)
        conclusions.append(f"{names.variable(consequent.variable)} IS {term}")
    ending = "" if rule.weight == 1.0 else f" WITH {written(rule.weight)}"
    return f"IF {condition} THEN {', '.join(conclusions)}{ending}"


def _condition(expression: Expression, names: Names, findings: Findings, rule: Rule) -> str:
    if isinstance(expression, Is):
        words = _nots(expression.hedges, findings, rule)
        term = names.term(expression.variable, expression.term)
        return " ".join([*words, names.variable(expression.variable), "IS", term])
    if isinstance(expression, Hedged):
        inner = _condition(expression.operand, names, findings, rule)
        return " ".join([*_nots(expression.hedges, findings, rule), f"({inner})"])
    word = " AND " if isinstance(expression, And) else " OR "
    return word.join(
        f"({_condition(operand, names, findings, rule)})"
        if isinstance(operand, And | Or)
        else _condition(operand, names, findings, rule)
        for operand in expression.operands
    )


def _nots(hedges: tuple[Hedge, ...], findings: Findings, rule: Rule) -> list[str]:
    for hedge in hedges:
        if hedge != NOT:
            message = f"jFuzzyLogic has no hedge '{hedge.name}'"
            findings.loss("unsupported-hedge", message, rule.span)
    return ["NOT"] * (sum(hedge == NOT for hedge in hedges) % 2)


# --- Write FCL for fuzzylite or jFuzzyLogic ---

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
