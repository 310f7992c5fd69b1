"""Read FLL, line by line: variables, terms, defuzzifiers and rule blocks."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from fuzzyarm.expression.kinds import SHAPES
from fuzzyarm.formats.findings import (
    MAX_RULES,
    MAX_TERMS,
    MAX_VARIABLES,
    VALUES,
    Draft,
    Findings,
    Imported,
    Word,
    add_term,
    number,
    numbers,
    rounded,
    too_long,
    written,
)
from fuzzyarm.formats.formula import FormulaError, read_formula, without_constants, write_formula
from fuzzyarm.formats.rules import (
    Dialect,
    Norms,
    RuleBuilder,
    RuleFaultError,
    RuleParser,
    RuleText,
    concluded,
)
from fuzzyarm.formats.shapes import FLL_CONJUNCTIONS, FLL_DISJUNCTIONS, make_shape
from fuzzyarm.model.rulebase import Defuzzifier, RuleBase, RuleBlock, Shape
from fuzzyarm.text.diagnostic import NOWHERE, Span

# --- FLL text, line by line: `key: value` with `#` comments ---

_WORD = re.compile(r"[(),]|[^\s(),]+")
_PLAIN_WORD = re.compile(r"\S+")


@dataclass(frozen=True, slots=True)
class Line:
    """One setting.

    Attributes
    ----------
    key : Word
        Left of the colon.
    value : Word
        Right of it, without space around; empty text where there is nothing.
    """

    key: Word
    value: Word

    def words(self, *, rule: bool = False) -> list[Word]:
        """Return the words of the value; in a rule parentheses are words of their own."""
        start = self.value.span.column
        number = self.value.span.line
        pattern = _WORD if rule else _PLAIN_WORD
        return [
            Word(m.group(), Span(number, start + m.start(), number, start + m.end()))
            for m in pattern.finditer(self.value.text)
        ]


def fll_lines(text: str, findings: Findings) -> Iterator[Line]:
    """Yield the settings of a text; report lines that are none."""
    for row, raw in enumerate(text.split("\n"), 1):
        content = raw.split("#", 1)[0].rstrip()
        if not content.strip():
            continue
        start = len(content) - len(content.lstrip())
        key, colon, value = content.partition(":")
        if not colon:
            word = Word(content.strip(), Span(row, start + 1, row, len(content) + 1))
            findings.error("syntax", f"'{word.text[:40]}' is no 'key: value'", word)
            continue
        gap = len(value) - len(value.lstrip())
        at = len(key) + 1 + gap
        name = key.strip()
        yield Line(
            Word(name, Span(row, start + 1, row, start + 1 + len(name))),
            Word(value.strip(), Span(row, at + 1, row, len(content) + 1)),
        )


# --- The lines of a rule block in FLL ---

_FLAGS = {"true": True, "false": False}
_ACTIVATIONS = ("General", "First", "Last", "Highest", "Lowest", "Proportional", "Threshold")
_KEYS = (
    "description", "enabled", "conjunction", "disjunction", "implication", "activation", "rule",
)  # fmt: skip


@dataclass(slots=True)
class Block:
    """A rule block while its lines are read; None where it names no norm."""

    name: str
    enabled: bool = True
    conjunction: str | None = None
    disjunction: str | None = None
    implication: str | None = None
    threshold: float = 0.0
    rules: list[Line] = field(default_factory=list)
    span: Span = NOWHERE


def flag(line: Line, findings: Findings, *, default: bool = False) -> bool:
    """Return whether a line says true or false."""
    value = _FLAGS.get(line.value.text.lower())
    if value is None:
        message = f"'{line.value.text[:40]}' is neither true nor false"
        findings.error("not-a-flag", message, line.value)
        return default
    return value


def norm(word: Word, table: dict[str, str], what: str, findings: Findings) -> str | None:
    """Return the norm that a word names, None for ``none``."""
    if word.text in ("", "none"):
        return None
    if word.text not in table:
        findings.unknown("unknown-norm", f"the {what}", word, table)
        return None
    return table[word.text]


def block_setting(block: Block, line: Line, count: int, findings: Findings) -> None:
    """Apply one line to a block; `count` rules have been read so far."""
    match line.key.text:
        case "description":
            if line.value.text:
                message = "the description of a rule block has no place in the model"
                findings.info("dropped-description", message, line.key)
        case "enabled":
            block.enabled = flag(line, findings, default=True)
        case "conjunction":
            block.conjunction = norm(line.value, FLL_CONJUNCTIONS, "T-norm", findings)
        case "disjunction":
            block.disjunction = norm(line.value, FLL_DISJUNCTIONS, "S-norm", findings)
        case "implication":
            block.implication = norm(line.value, FLL_CONJUNCTIONS, "T-norm", findings)
        case "activation":
            _activation(block, line, findings)
        case "rule":
            if findings.room(count, MAX_RULES, "rules", line.key):
                block.rules.append(line)
        case _:
            findings.unknown("unknown-key", "the key", line.key, _KEYS)


def _activation(block: Block, line: Line, findings: Findings) -> None:
    words = line.words()
    method = words[0].text if words else "none"
    if method in FLL_CONJUNCTIONS:  # fuzzylite 5 said activation for implication
        block.implication = FLL_CONJUNCTIONS[method]
    elif method in _ACTIVATIONS:
        threshold = _threshold(words)
        if threshold is None:
            message = f"the activation method '{line.value.text[:60]}' cannot be carried"
            findings.loss("unsupported-activation", message, line.value)
        else:
            block.threshold = threshold
    elif method != "none":
        findings.unknown("unknown-activation", "the method", words[0], _ACTIVATIONS)


def _threshold(words: list[Word]) -> float | None:
    """Return the firing strength below which a rule is left out; None for other methods.

    ``Threshold >= t`` is the next number below t: strengths are numbers of the machine.
    """
    if words[0].text == "General":
        return 0.0
    values = [word.text for word in words[1:]]
    if words[0].text != "Threshold" or len(values) not in (0, 2):
        return None
    if not values:
        return 0.0  # greater than 0
    limit = number(values[1])
    if limit is None or not math.isfinite(limit) or values[0] not in (">", ">="):
        return None
    below = limit if values[0] == ">" else math.nextafter(limit, -math.inf)
    return max(below, 0.0)


# --- The defuzzifiers of fuzzylite ---

INTEGRAL = {
    "Bisector": "bisector",
    "Centroid": "centroid",
    "LargestOfMaximum": "largest-of-maximum",
    "MeanOfMaximum": "mean-of-maximum",
    "SmallestOfMaximum": "smallest-of-maximum",
}
WEIGHTED = {"WeightedAverage": "weighted-average", "WeightedSum": "weighted-sum"}
TYPES = ("Automatic", "TakagiSugeno", "Tsukamoto")
DEFAULT_RESOLUTION = 1000
"""Of fuzzylite 7 and 8; version 6 took 100 and always wrote it."""

MAX_RESOLUTION = 10_000_000
MONOTONIC = frozenset({"arc", "concave", "ramp", "sigmoid", "s", "z"})


def settle_defuzzifier(draft: Draft, line: Line | None, findings: Findings) -> None:
    """Set the defuzzifier of an output from its line."""
    words = line.words() if line is not None else []
    if line is None or not words or words[0].text == "none":
        message = f"the output '{draft.name}' has no defuzzifier"
        at = line.key if line is not None else draft.word
        findings.error("no-defuzzifier", message, at)
        return
    method = words[0].text
    if method in INTEGRAL:
        resolution = _resolution(words, findings)
        draft.defuzzifier = Defuzzifier(INTEGRAL[method], resolution, "midpoints")
        _check_sets(draft, line.value, findings)
    elif method in WEIGHTED:
        kind = words[1].text if len(words) > 1 else "Automatic"
        if kind not in TYPES:
            findings.unknown("unknown-defuzzifier", "the type", words[1], TYPES)
            return
        settle_weighted(draft, WEIGHTED[method], kind, line.value, findings)
    else:
        findings.unknown("unknown-defuzzifier", "the method", words[0], (*INTEGRAL, *WEIGHTED))


def _resolution(words: list[Word], findings: Findings) -> int:
    if len(words) < 2:
        return DEFAULT_RESOLUTION
    value = number(words[1].text)
    if value is None or not value.is_integer() or not 1 <= value <= MAX_RESOLUTION:
        message = f"'{words[1].text[:40]}' is no resolution (1 to {MAX_RESOLUTION})"
        findings.error("bad-resolution", message, words[1])
        return DEFAULT_RESOLUTION
    return int(value)


def _check_sets(draft: Draft, at: Word, findings: Findings) -> None:
    if any(term.shape.kind in VALUES for term in draft.terms):
        message = (
            f"'{draft.name}' has terms that are values, which fuzzylite integrates as if "
            "they were sets; that cannot be carried"
        )
        findings.loss("value-as-set", message, at)


def settle_weighted(draft: Draft, method: str, kind: str, at: Word, findings: Findings) -> None:
    """Set a weighted defuzzifier, Takagi-Sugeno or Tsukamoto by `kind` or by the terms."""
    kinds = {term.shape.kind for term in draft.terms}
    if kind == "Automatic":
        kind = "Tsukamoto" if kinds and kinds <= MONOTONIC else "TakagiSugeno"
    if kind == "Tsukamoto":
        if not kinds <= MONOTONIC:
            message = f"'{draft.name}' has terms without an inverse, which Tsukamoto needs"
            findings.error("not-monotonic", message, at)
        if method == "weighted-sum":
            message = "a weighted sum of Tsukamoto terms cannot be carried"
            findings.loss("weighted-sum-of-tsukamoto", message, at)
        draft.defuzzifier = Defuzzifier("tsukamoto")
        return
    if not kinds <= VALUES:
        message = (
            f"'{draft.name}' has sets where values are needed; fuzzylite takes the membership "
            "of the firing strength, which cannot be carried"
        )
        findings.loss("set-as-value", message, at)
    draft.defuzzifier = Defuzzifier(method)


# --- The terms of fuzzylite: class names and the order of their numbers ---

FLL_SHAPES = {
    "Arc": "arc",
    "Bell": "bell",
    "Binary": "binary",
    "Concave": "concave",
    "Cosine": "cosine",
    "Gaussian": "gaussian",
    "GaussianProduct": "two-sided-gaussian",
    "PiShape": "pi",
    "Ramp": "ramp",
    "Rectangle": "rectangle",
    "SemiEllipse": "semi-ellipse",
    "Sigmoid": "sigmoid",
    "SigmoidDifference": "sigmoid-difference",
    "SigmoidProduct": "sigmoid-product",
    "Spike": "spike",
    "SShape": "s",
    "Trapezoid": "trapezoid",
    "Triangle": "triangle",
    "ZShape": "z",
}
"""Class name → kind of shape. The numbers stand in the same order but for two sigmoids."""

FLL_NAMES = {kind: name for name, kind in FLL_SHAPES.items()}
_TWO_SIGMOIDS = frozenset({"sigmoid-difference", "sigmoid-product"})
CLASSES = (*FLL_SHAPES, "Constant", "Discrete", "Function", "Linear")


def shape_of(
    name: Word, parameters: list[Word], formula: Word, inputs: int, findings: Findings
) -> Shape | None:
    """Return the shape of a term.

    Parameters
    ----------
    name : Word
        The class, ``Triangle`` and so on.
    parameters : list of Word
        What follows it.
    formula : Word
        The same as one text, for ``Function``.
    inputs : int
        Number of inputs, which a ``Linear`` must match.
    findings : Findings
        Where faults go.
    """
    if name.text == "Function":
        return formula_shape(formula, "fuzzylite", findings)
    if name.text not in CLASSES:
        findings.unknown("unknown-shape", "the term class", name, CLASSES)
        return None
    values = numbers(parameters, findings)
    if values is None:
        return None
    if name.text == "Constant":
        return make_shape("singleton", values, name, findings)
    if name.text == "Linear":
        return linear_shape(values, inputs, name, findings)
    return _fuzzy(name, values, findings)


def _fuzzy(name: Word, values: list[float], findings: Findings) -> Shape | None:
    height = 1.0
    if name.text == "Discrete":
        if len(values) % 2:
            height = values.pop()
        return make_shape("points", values, name, findings, height=height, ties="last")
    kind = FLL_SHAPES[name.text]
    if len(values) == len(SHAPES[kind].parameters) + 1:
        height = values.pop()
    if kind in _TWO_SIGMOIDS and len(values) == 4:
        values[2], values[3] = values[3], values[2]
    if kind == "ramp" and len(values) == 2 and values[0] == values[1]:
        findings.error("unordered-corners", "a Ramp from a number to itself is nowhere", name)
        return None
    return make_shape(kind, values, name, findings, height=height)


def linear_shape(values: list[float], inputs: int, at: Word, findings: Findings) -> Shape | None:
    """Return a linear consequent; a missing constant is 0."""
    if len(values) == inputs:
        values = [*values, 0.0]
    if len(values) != inputs + 1:
        message = (
            f"a linear term needs a factor for each of the {inputs} inputs and a constant, "
            f"not {len(values)} numbers"
        )
        findings.error("parameter-count", message, at)
        return None
    return make_shape("linear", values, at, findings)


def formula_shape(formula: Word, dialect: str, findings: Findings) -> Shape | None:
    """Return a formula, rewritten so that every reader takes it alike."""
    try:
        tree = read_formula(formula.text, dialect)
    except FormulaError as fault:
        findings.error("bad-formula", f"in '{formula.text[:60]}': {fault}", formula)
        return None
    return Shape("formula", (), 1.0, write_formula(without_constants(tree, set())))


def term_text(shape: Shape, rename: dict[str, str]) -> str | None:
    """Return class and numbers of a shape, or None where fuzzylite has no such class."""
    if shape.kind == "formula":
        tree = read_formula(shape.formula, "fuzzyarm")
        return f"Function {fuzzylite_formula(write_formula(tree, rename))}"
    values = list(shape.parameters)
    if shape.kind in _TWO_SIGMOIDS:
        values[2], values[3] = values[3], values[2]
    if shape.kind in ("singleton", "linear"):
        if shape.height != 1.0:
            return None
        name = "Constant" if shape.kind == "singleton" else "Linear"
    else:
        name = "Discrete" if shape.kind == "points" else FLL_NAMES[shape.kind]
        if shape.height != 1.0:
            values.append(shape.height)
    return " ".join([name, *map(written, values)])


def fuzzylite_formula(text: str) -> str:
    """Return a canonical formula with the unary minus that fuzzylite knows."""
    out: list[str] = []
    for index, letter in enumerate(text):
        before = text[:index].rstrip()[-1:]
        following = text[index + 1 : index + 2]
        unary = letter == "-" and before in ("", "(", ",", *"+-*/^%") and following != " "
        out.append("~" if unary else letter)
    return "".join(out)


# --- Read FLL ---

_SECTIONS = ("Engine", "InputVariable", "OutputVariable", "RuleBlock")


def parse_fll(text: str, path: str = "<text>", *, lossy: bool = False) -> Imported:
    """Read an engine of fuzzylite; never raises.

    Parameters
    ----------
    text : str
        Any text at all.
    path : str
        Name of the file, for the diagnostics.
    lossy : bool
        Whether a loss that changes numbers is a warning rather than an error.

    Returns
    -------
    Imported
        The rule base where there is no error, and every finding.
    """
    refused = too_long(text, path)
    if refused is not None:
        return refused
    return _Reader(text.replace("\r\n", "\n").replace("\r", "\n"), path, lossy).read()


class _Reader:
    def __init__(self, text: str, path: str, lossy: bool) -> None:
        self.text = text
        self.findings = Findings(path, lossy=lossy)
        self.name = ""
        self.description = ""
        self.variables: dict[str, Draft] = {}
        self.terms: list[tuple[Draft, Line]] = []
        self.defuzzifiers: dict[str, Line] = {}
        self.blocks: list[Block] = []
        self.draft: Draft | None = None
        self.section = ""

    def read(self) -> Imported:
        for line in fll_lines(self.text, self.findings):
            if line.key.text in _SECTIONS:
                self._open(line)
            else:
                self._setting(line)
        if not self.variables and not self.findings.failed:
            self.findings.error("no-engine", "there is no variable in this file")
        self._finish_variables()
        blocks = self._finish_blocks()
        self._note_rounding()
        rulebase = None if self.findings.failed else self._rulebase(blocks)
        return Imported(rulebase, self.findings.all(), "fuzzylite")

    def _rulebase(self, blocks: tuple[RuleBlock, ...]) -> RuleBase:
        drafts = self.variables.values()
        return RuleBase(
            self.name,
            tuple(d.input() for d in drafts if not d.is_output),
            tuple(d.output() for d in drafts if d.is_output),
            blocks,
            self.description,
        )

    def _open(self, line: Line) -> None:
        self.section = line.key.text
        self.draft = None
        if self.section == "Engine":
            self.name = line.value.text
        elif self.section == "RuleBlock":
            self.blocks.append(Block(line.value.text, span=line.key.span))
        else:
            self._open_variable(line)

    def _open_variable(self, line: Line) -> None:
        word = line.value if line.value.text else line.key
        name = identifier(line.value.text)
        if name != line.value.text:
            message = f"fuzzylite calls the variable '{line.value.text[:60]}' {name}"
            self.findings.info("renamed", message, word)
        self.draft = Draft(Word(name, word.span), self.section == "OutputVariable")
        earlier = self.variables.get(name)
        if earlier is not None:
            message = f"there are two variables called '{name}'"
            self.findings.error("duplicate-variable", message, word)
            return
        if self.findings.room(len(self.variables), MAX_VARIABLES, "variables", word):
            self.variables[name] = self.draft

    def _setting(self, line: Line) -> None:
        key = line.key.text
        if not self.section:
            self.findings.error("syntax", f"'{key[:40]}' stands before any section", line.key)
        elif self.section == "Engine":
            if key == "description":
                self.description = line.value.text
            else:
                self.findings.unknown("unknown-key", "the key", line.key, ("description",))
        elif self.draft is not None:
            self._variable_setting(self.draft, line)
        else:
            count = sum(len(each.rules) for each in self.blocks)
            block_setting(self.blocks[-1], line, count, self.findings)

    def _variable_setting(self, draft: Draft, line: Line) -> None:
        match line.key.text:
            case "description":
                draft.description = line.value.text
            case "enabled":
                draft.enabled = flag(line, self.findings, default=True)
            case "range":
                self._range(draft, line)
            case "lock-range":
                draft.outside = "clamp" if flag(line, self.findings) else "extend"
            case "term":
                if self.findings.room(len(self.terms), 5 * MAX_TERMS, "terms", line.key):
                    self.terms.append((draft, line))
            case _ if draft.is_output:
                self._output_setting(draft, line)
            case _:
                keys = ("description", "enabled", "range", "lock-range", "term")
                self.findings.unknown("unknown-key", "the key", line.key, keys)

    def _output_setting(self, draft: Draft, line: Line) -> None:
        match line.key.text:
            case "aggregation" | "accumulation":
                found = norm(line.value, FLL_DISJUNCTIONS, "S-norm", self.findings)
                draft.aggregation = found or "sum"
            case "defuzzifier":
                self.defuzzifiers[draft.name] = line
            case "default":
                value = number(line.value.text)
                if value is None:
                    message = f"'{line.value.text[:40]}' is not a number"
                    self.findings.error("not-a-number", message, line.value)
                elif draft.no_rule != "hold":
                    draft.no_rule = value
                elif not math.isnan(value):
                    self._held_default(line.key)
            case "lock-previous" | "lock-valid" | "lock-defuzz":
                if flag(line, self.findings):
                    if isinstance(draft.no_rule, float) and not math.isnan(draft.no_rule):
                        self._held_default(line.key)
                    draft.no_rule = "hold"
            case _:
                keys = (
                    "description", "enabled", "range", "lock-range", "term", "aggregation",
                    "defuzzifier", "default", "lock-previous",
                )  # fmt: skip
                self.findings.unknown("unknown-key", "the key", line.key, keys)

    def _held_default(self, at: Word) -> None:
        message = "the value is held; the default counts only before the first value"
        self.findings.info("default-with-hold", message, at, "pass it as the held value")

    def _range(self, draft: Draft, line: Line) -> None:
        values = [number(word.text) for word in line.words()]
        if len(values) != 2 or values[0] is None or values[1] is None:
            message = f"a range is two numbers, not '{line.value.text[:40]}'"
            self.findings.error("bad-range", message, line.value)
            return
        draft.low, draft.high = values[0], values[1]

    def _finish_variables(self) -> None:
        inputs = sum(not d.is_output for d in self.variables.values())
        for draft, line in self.terms:
            self._term(draft, line, inputs)
        for draft in self.variables.values():
            draft.settle_range(self.findings)
            if draft.is_output:
                settle_defuzzifier(draft, self.defuzzifiers.get(draft.name), self.findings)

    def _term(self, draft: Draft, line: Line, inputs: int) -> None:
        words = line.words()
        if len(words) < 2:
            message = "a term is 'name Class numbers'"
            self.findings.error("syntax", message, line.value if words else line.key)
            return
        name, kind, parameters = words[0], words[1], words[2:]
        offset = kind.span.end_column - line.value.span.column
        rest = line.value.text[offset:].strip()
        formula = Word(rest, parameters[0].span.to(line.value.span) if parameters else kind.span)
        cleaned = identifier(name.text)
        if cleaned != name.text:
            message = f"fuzzylite calls the term '{name.text[:60]}' {cleaned}"
            self.findings.info("renamed", message, name)
        shape = shape_of(kind, parameters, formula, inputs, self.findings)
        if shape is not None:
            add_term(draft, Word(cleaned, name.span), shape, self.findings, keep="last")

    def _finish_blocks(self) -> tuple[RuleBlock, ...]:
        builder = RuleBuilder(self.variables, self.findings)
        texts = [(block, self._rules(block)) for block in self.blocks if self._is_on(block)]
        blocks = []
        for index, (block, rules) in enumerate(texts):
            norms = Norms(block.conjunction, block.disjunction, block.implication, block.threshold)
            later = frozenset[str]().union(*(concluded(each) for _, each in texts[index + 1 :]))
            blocks.append(builder.block(block.name, norms, rules, later))
        return tuple(blocks)

    def _is_on(self, block: Block) -> bool:
        if not block.enabled:
            message = f"the block '{block.name}' is switched off; its rules are left out"
            self.findings.warn("disabled-block", message, block.span)
        return block.enabled

    def _rules(self, block: Block) -> list[RuleText]:
        rules = []
        for line in block.rules:
            words = line.words(rule=True)
            if not words:
                self.findings.error("syntax", "the rule is empty", line.key)
                continue
            try:
                rules.append(RuleParser(words, self.variables, self.findings, Dialect()).rule())
            except RuleFaultError as fault:
                self.findings.error(fault.name, str(fault), fault.word)
        return rules

    def _note_rounding(self) -> None:
        match = rounded(self.text)
        if match is None:
            return
        before = self.text[: match.start()]
        line = before.count("\n") + 1
        column = match.start() - before.rfind("\n")
        span = Span(line, column, line, column + len(match.group()))
        message = "every number of this file has three decimals, so some may have been rounded"
        self.findings.info("rounded-number", message, span)


def identifier(name: str) -> str:
    """Return `name` as fuzzylite spells it: letters, digits and underscores only."""
    cleaned = re.sub(r"\W", "", name) or "_"
    return f"_{cleaned}" if cleaned[0].isnumeric() else cleaned
