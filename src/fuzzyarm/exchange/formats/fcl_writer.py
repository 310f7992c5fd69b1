"""FCL, the language of IEC 61131-7, written for jFuzzyLogic or fuzzylite."""

from __future__ import annotations

import math
import re
from dataclasses import replace

from fuzzyarm.exchange.formats.dialects import (
    FCL,
    JFUZZYLOGIC_ACCUMULATIONS,
    JFUZZYLOGIC_PAIRS,
    PRODUCERS,
    Dialect,
    word_of,
)
from fuzzyarm.exchange.formats.drafts import VALUES
from fuzzyarm.exchange.formats.fcl_text import KEYWORDS, MEAN_OF_MAXIMUM, is_cut
from fuzzyarm.exchange.formats.findings import Exported, all_written, demand_program, written
from fuzzyarm.exchange.formats.shapes import larger_wins, word_and_numbers
from fuzzyarm.exchange.formats.system_writer import HEADER, SystemWriter, best
from fuzzyarm.exchange.formats.writing import (
    FUZZYLITE_WORDS,
    identifier,
    identifiers,
    written_sentences,
)
from fuzzyarm.language.model.rulebase import Input, Output, RuleBase, RuleBlock, Shape, Term
from fuzzyarm.symbolic.formulas import CONSTANTS, FRB, FormulaError, read_formula, write_formula
from fuzzyarm.symbolic.kinds import SNORMS, TNORMS
from fuzzyarm.symbolic.nodes import Apply, Node, apply, postorder
from fuzzyarm.symbolic.nodes import replace as put_in

_RESERVED = FUZZYLITE_WORDS | frozenset(word.lower() for word in KEYWORDS) | {
    "real", "nan", "nc", "constant", "function", "linear", "discrete", "points",
}  # fmt: skip


def write_fcl(
    rulebase: RuleBase,
    *,
    dialect: str | None = None,
    lossy: bool = False,
    strict: bool = False,
) -> Exported:
    """Write a function block: :func:`~fuzzyarm.exchange.formats.registry.write` of ``.fcl``.

    The `dialect` is the producer there, ``jfuzzylogic`` or ``fuzzylite``.

    Parameters
    ----------
    rulebase, dialect, lossy, strict
        As there.

    Returns
    -------
    Exported
        The text, if there is no error, and every finding.
    """
    if dialect is not None:
        demand_program(dialect, ".fcl", "written for", PRODUCERS)
    producers = (dialect,) if dialect is not None else ("fuzzylite", "jfuzzylogic")
    writers = [_Writer(rulebase, FCL[name], lossy=lossy, strict=strict) for name in producers]
    return best([writer.export() for writer in writers])


class _Writer(SystemWriter):
    file = "FCL"

    def settle_names(self) -> None:
        self.names = identifiers(self.rulebase, self.findings, _RESERVED, ignore_case=True)

    def head(self) -> list[str]:
        name = self._title(self.rulebase.name)
        lines = [f"// {HEADER} for {self.program}.", "", f"FUNCTION_BLOCK {name}".rstrip()]
        lines += self._declared("VAR_INPUT", self.rulebase.inputs)
        return [*lines, *self._declared("VAR_OUTPUT", self.rulebase.outputs)]

    def variable(self, variable: Input | Output, index: int) -> list[str]:
        if isinstance(variable, Output):
            return ["", *self._defuzzify(variable)]
        return ["", *self._fuzzify(variable)]

    def foot(self) -> list[str]:
        return ["", "END_FUNCTION_BLOCK"]

    @property
    def own(self) -> bool:
        """Whether the target is fuzzylite, not jFuzzyLogic."""
        return self.dialect.producer == "fuzzylite"

    def _title(self, name: str) -> str:
        """Return the title of a block, an identifier for jFuzzyLogic."""
        if not self.own:
            title = identifier(name, _RESERVED, ignore_case=True) if name else ""
        else:
            # Characters that end a title or begin a comment.
            plain = re.sub(r"[;:#]|/[/*]|\(\*", " ", name)
            words = "".join(c if c.isprintable() else " " for c in plain).split()
            title = " ".join(f"{w}_" if w.upper() in KEYWORDS else w for w in words)
        if title != name:
            message = f"the block '{name[:40]}' is written as '{title[:40]}'"
            self.findings.info("changed-text", message)
        return title

    def _declared(self, key: str, variables: tuple[Input | Output, ...]) -> list[str]:
        lines = ["", key]
        for variable in variables:
            lines.append(f"  {self.names.variable(variable.name)} : REAL;")
            bounded = math.isfinite(variable.low) and math.isfinite(variable.high)
            # jFuzzyLogic refuses a RANGE inside FUZZIFY.
            if not self.own and bounded and isinstance(variable, Input):
                lines[-1] += f" {_range(variable)}"
        return [*lines, "END_VAR"]

    def _fuzzify(self, variable: Input) -> list[str]:
        lines = [f"FUZZIFY {self.names.variable(variable.name)}"]
        if self.own:
            lines.append(f"  {_range(variable)}")
        return [*lines, *self._terms(variable), "END_FUZZIFY"]

    def _terms(self, variable: Input | Output) -> list[str]:
        return [
            f"  TERM {self.names.term(variable.name, term.name)} := {self._term(variable, term)};"
            for term in variable.terms
        ]

    def _term(self, variable: Input | Output, term: Term) -> str:
        if self.own:
            # A singleton of FCL is a bare number.
            return self.fuzzylite_term(variable, term).removeprefix("Constant ")
        return self._plain_term(variable, term)

    def _defuzzify(self, output: Output) -> list[str]:
        lines = [f"DEFUZZIFY {self.names.variable(output.name)}", *self._terms(output)]
        if self.own or math.isfinite(output.low + output.high):
            lines.insert(1, f"  {_range(output)}")
        lines.append(f"  METHOD : {self._method(output)};")
        weighted = output.defuzzifier.record.weighs
        # Without ACCU fuzzylite adds up.
        if self.own and not (weighted and output.aggregation == "sum"):
            lines.append(f"  ACCU : {self.snorm(output.aggregation)};")
        lines += self._default(output)
        if self.own and output.outside != "extend":
            lines.append("  LOCK : RANGE;")
        return [*lines, "END_DEFUZZIFY"]

    def _default(self, output: Output) -> list[str]:
        no_rule = self.no_rule(output)
        if no_rule == "hold":
            return ["  LOCK : PREVIOUS;"] if self.own else ["  DEFAULT := NC;"]
        value = no_rule if isinstance(no_rule, float | int) else math.nan
        return [f"  DEFAULT := {written(value)};"] if self.own or math.isfinite(value) else []

    def _method(self, output: Output) -> str:
        if output.defuzzifier.record.weighs and not self.own:
            return self._plain_weighted(output)
        word = self.defuzzifier(output)
        if word == "MM" and not self.own:
            self.findings.loss("mean-of-maximum", MEAN_OF_MAXIMUM, slight=True)
        return word

    def _plain_weighted(self, output: Output) -> str:
        """Return jFuzzyLogic's method for the terms without integration."""
        kinds = {term.shape.kind for term in output.terms}
        record = output.defuzzifier.record
        if record.figure != "average" or record.inverts:
            message = f"jFuzzyLogic has no {record.name} for '{output.name}'"
            self.findings.loss("unsupported-defuzzifier", message)
        if kinds <= VALUES:
            return "COGS" if kinds <= {"singleton"} else "COGF"
        self.need_values(output, refused=bool(kinds & VALUES))
        return "COG"

    def block(self, block: RuleBlock, index: int) -> list[str]:
        lines = ["", f"RULEBLOCK {self._title(block.name)}".rstrip()]
        if self.own:
            lines += [
                f"  AND : {self.tnorm(block.conjunction)};",
                f"  OR : {self.snorm(block.disjunction)};",
                f"  ACT : {self.tnorm(block.implication)};",
            ]
        else:
            lines += self._plain_norms(block)
        rules = written_sentences(block, self.dialect, self.names, self.findings)
        lines += [f"  RULE {number} : {rule};" for number, rule in enumerate(rules, 1)]
        return [*lines, "END_RULEBLOCK"]

    def _plain_norms(self, block: RuleBlock) -> list[str]:
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
        aggregations = [o.aggregation for o in self.rulebase.outputs if o.name in concluded]
        if len(set(aggregations)) > 1:
            message = "jFuzzyLogic has one accumulation for all outputs of a block"
            self.findings.loss("one-for-all", message)
        aggregation = aggregations[0] if aggregations else "max"
        if aggregation not in JFUZZYLOGIC_ACCUMULATIONS:
            message = f"jFuzzyLogic has no accumulation {aggregation}"
            self.findings.loss("unsupported-norm", message)
            aggregation = "max"
        return [
            # No OR: jFuzzyLogic derives it from AND, see JFUZZYLOGIC_PAIRS.
            f"  AND : {word_of(TNORMS, block.conjunction, 'jfl') or 'MIN'};",
            f"  ACT : {'PROD' if block.implication == 'product' else 'MIN'};",
            f"  ACCU : {word_of(SNORMS, aggregation, 'jfl')};",
        ]

    # --- Terms of jFuzzyLogic ---

    def _plain_term(self, variable: Input | Output, term: Term) -> str:
        shape = self.without_height(variable, term)
        try:
            text = self._plain_shape(shape)
        except FormulaError as fault:
            self.bad_formula(shape, fault)
            return ""
        if text is None:
            self.nothing_like(variable, term, lossy=True)
            return "0"
        if shape.kind == "sigmoid-difference" and is_cut(shape):
            message = f"'{term.name}' is a difference that jFuzzyLogic cuts at 0"
            self.findings.loss("negative-difference", message, term.span)
        return text

    def _plain_shape(self, shape: Shape) -> str | None:
        p = shape.parameters
        match shape.kind:
            case "formula":
                text = f"FUNCTION {self._formula(shape.formula)}"
            case "linear":
                inputs = [self.names.variable(variable.name) for variable in self.rulebase.inputs]
                factors = [f"{written(a)} * {name}" for a, name in zip(p, inputs, strict=False)]
                text = "FUNCTION " + " + ".join([*factors, written(p[-1])])
            case "singleton":
                text = written(p[0])
            case "points":
                text = _pairs(larger_wins(p, self.dialect.ties))
            case _:
                return self._plain_numbers(shape) if all(map(math.isfinite, p)) else None
        return text

    def _plain_numbers(self, shape: Shape) -> str | None:
        p = shape.parameters
        if shape.kind == "ramp" and p[0] != p[1]:
            return _pairs((p[0], 0.0, p[1], 1.0) if p[0] < p[1] else (p[1], 1.0, p[0], 0.0))
        if shape.kind == "rectangle":
            shape = replace(shape, kind="trapezoid", parameters=(p[0], p[0], p[1], p[1]))
        if shape.kind == "cosine":  # half the width, then the centre
            return f"COSINE {written(0.5 * p[1])} {written(p[0])}"
        word_numbers = word_and_numbers(shape, self.dialect.kinds)
        return (
            f"{word_numbers[0]} {all_written(word_numbers[1])}"
            if word_numbers is not None
            else None
        )

    def _formula(self, text: str) -> str:
        formula = read_formula(text)
        free = CONSTANTS.keys() - {variable.name for variable in self.rulebase.inputs}
        root = put_in(_without_signs(formula.root), {name: CONSTANTS[name] for name in free})
        missing = _missing_functions(root, self.dialect)
        for function in missing:
            message = f"jFuzzyLogic has no function '{function}'"
            self.findings.error("unsupported-function", message)
        if missing:
            return ""
        return write_formula(root, self.dialect.formula, self.names.variables, upper=True)


_OPERATORS = {"add", "subtract", "multiply", "divide", "power", "remainder", "where"}
_COMPARISONS = {"less": "lt", "less_equal": "le", "equal": "eq"}


def _missing_functions(root: Node, dialect: Dialect) -> list[str]:
    """Return the functions of a formula that the program lacks, by their names in the model."""
    operations = dict.fromkeys(
        node.operation for node in postorder(root) if isinstance(node, Apply)
    )
    missing = [
        function
        for function in operations
        if function not in _OPERATORS | dialect.formula.words.keys()
    ]
    return [(FRB.words | _COMPARISONS)[operation] for operation in missing]


def _without_signs(root: Node) -> Node:
    """Write -a as 0 - a: jFuzzyLogic knows signs of numbers only."""
    nodes: dict[Node, Node] = {}
    for node in postorder(root):
        if isinstance(node, Apply):
            arguments = [nodes[argument] for argument in node.arguments]
            is_sign = node.operation == "negative"
            nodes[node] = (
                apply("subtract", 0.0, *arguments) if is_sign else apply(node.operation, *arguments)
            )
        else:
            nodes[node] = node
    return nodes[root]


def _pairs(values: tuple[float, ...]) -> str:
    pairs = zip(values[0::2], values[1::2], strict=True)
    return " ".join(f"({written(x)}, {written(y)})" for x, y in pairs)


def _range(variable: Input | Output) -> str:
    return f"RANGE := ({written(variable.low)} .. {written(variable.high)});"
