"""FLL, the files of fuzzylite: read, and written for fuzzylite 7 and 8."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

from fuzzyarm.base.diagnostic import MAX_TERMS
from fuzzyarm.exchange.formats.dialects import FLL, Dialect, all_spellings, words
from fuzzyarm.exchange.formats.drafts import VariableDraft, imported, lines_of, note_rounding
from fuzzyarm.exchange.formats.findings import (
    MAX_RULES,
    Exported,
    Findings,
    Imported,
    TextPiece,
    number,
    numbers,
    written,
)
from fuzzyarm.exchange.formats.meaning import BlockDraft
from fuzzyarm.exchange.formats.recovery import straight_shape
from fuzzyarm.exchange.formats.sentences import read_sentences
from fuzzyarm.exchange.formats.shapes import formula_shape, spelled_shape
from fuzzyarm.exchange.formats.system_reader import SystemReader
from fuzzyarm.exchange.formats.system_writer import HEADER, SystemWriter
from fuzzyarm.exchange.formats.writing import FUZZYLITE_WORDS, identifiers, written_sentences
from fuzzyarm.language.model.rulebase import Input, Output, RuleBase, RuleBlock, Shape
from fuzzyarm.symbolic.kinds import SHAPES, TNORMS

# --- FLL text, line by line: `key: value` with `#` comments ---

_PLAIN_WORD = re.compile(r"\S+")
_WORD = re.compile(r"[(),]|[^\s(),]+")
"""Words of a rule: parentheses and commas are their own words."""


@dataclass(frozen=True, slots=True)
class _SettingLine:
    """A setting: the texts left and right of its colon, stripped."""

    key: TextPiece
    value: TextPiece

    def words(self) -> list[TextPiece]:
        return self.value.parts(_PLAIN_WORD)


def _lines(text: str, findings: Findings) -> Iterator[_SettingLine]:
    for line in lines_of(text, lambda raw: raw.partition("#")[0]):
        parts = line.around(":")
        if parts is None:
            findings.error("syntax", f"'{line.text[:40]}' is not of the form 'key: value'", line)
        else:
            yield _SettingLine(*parts)


# --- The parts of a file ---

_ACTIVATIONS = ("General", "First", "Last", "Highest", "Lowest", "Proportional", "Threshold")
_BLOCK_KEYS = (
    "description", "enabled", "conjunction", "disjunction", "implication", "activation", "rule",
)  # fmt: skip
_INPUT_KEYS = ("description", "enabled", "range", "lock-range", "term")
_OUTPUT_KEYS = (*_INPUT_KEYS, "aggregation", "defuzzifier", "default", "lock-previous")
MAX_RESOLUTION = 10_000_000


def _flag(line: _SettingLine, findings: Findings, *, default: bool = False) -> bool:
    value = {"true": True, "false": False}.get(line.value.text.lower())
    if value is None:
        message = f"'{line.value.text[:40]}' is neither true nor false"
        findings.error("not-a-flag", message, line.value)
        return default
    return value


def _threshold(words: list[TextPiece]) -> float | None:
    """Return the least firing strength of a rule's effect; None for other methods.

    ``Threshold >= t`` becomes the next double below t, since rules fire above the threshold.
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


def _resolution(words: list[TextPiece], findings: Findings) -> int:
    usual, _ = FLL.samples
    if len(words) < 2:
        return usual
    value = number(words[1].text)
    if value is None or not value.is_integer() or not 1 <= value <= MAX_RESOLUTION:
        message = f"'{words[1].text[:40]}' is not a resolution (1 to {MAX_RESOLUTION})"
        findings.error("bad-resolution", message, words[1])
        return usual
    return int(value)


def _shape(
    name: TextPiece,
    parameters: list[TextPiece],
    formula: TextPiece,
    inputs: int,
    findings: Findings,
) -> Shape | None:
    """Return the shape of a class and its numbers; `formula` is the one of ``Function``."""
    if name.text == "Function":
        return formula_shape(formula, FLL.formula, findings)
    classes = all_spellings(SHAPES, FLL.kinds)
    if name.text not in classes:
        findings.unknown("unknown-shape", "the term class", name, classes)
        return None
    values = numbers(parameters, findings)
    if values is None:
        return None
    spelling = classes[name.text]
    if spelling.kind == "ramp" and len(values) in (2, 3) and values[0] == values[1]:
        findings.error("unordered-corners", "the start and the end of a Ramp must differ", name)
        return None
    shape = spelled_shape(spelling, values, inputs, name, findings, FLL)
    return straight_shape(shape) if shape is not None and shape.kind == "points" else shape


# --- Read FLL ---

_SECTIONS = ("Engine", "InputVariable", "OutputVariable", "RuleBlock")


def parse_fll(
    text: str, path: str = "<text>", *, lossy: bool = False, strict: bool = False
) -> Imported:
    """Read an engine of fuzzylite: :func:`~fuzzyarm.exchange.formats.registry.parse` of ``.fll``.

    Parameters
    ----------
    text, path, lossy, strict
        As there.

    Returns
    -------
    Imported
        The rule base, if there is no error, and every finding.
    """

    def read(plain: str, findings: Findings) -> tuple[RuleBase, Dialect]:
        return _Reader(plain, findings).read(), FLL

    return imported(text, path, read, lossy=lossy, strict=strict)


class _Reader(SystemReader):
    """Reads line by line; terms wait for all inputs, rules for all terms."""

    def __init__(self, text: str, findings: Findings) -> None:
        super().__init__(FLL, findings)
        self.text = text
        self.name = ""
        self.description = ""
        self.terms: list[tuple[VariableDraft, _SettingLine]] = []
        self.rules: list[list[_SettingLine]] = []  # of each block
        self.draft: VariableDraft | None = None
        self.section = ""

    def read(self) -> RuleBase:
        for line in _lines(self.text, self.findings):
            if line.key.text in _SECTIONS:
                self._open(line)
            else:
                self._setting(line)
        if not self.outputs and not self.findings.failed:
            self.findings.error("no-engine", "this file has no output")
        for draft, line in self.terms:
            self._term(draft, line)
        self.settle()
        blocks = self.in_model(self._blocks())
        note_rounding(self.text, self.findings)
        return self.rulebase(self.name, blocks, self.description)

    def _open(self, line: _SettingLine) -> None:
        self.section = line.key.text
        self.draft = None
        if self.section == "Engine":
            self.name = line.value.text
        elif self.section == "RuleBlock":
            self.blocks.append(BlockDraft(line.value.text, line.key.span, always_concludes=True))
            self.rules.append([])
        else:
            word = self._identifier(
                "variable", line.value, line.value if line.value.text else line.key
            )
            self.draft = self.variable(word, is_output=self.section == "OutputVariable")
            self.draft.aggregates = False  # until a line says so

    def _identifier(self, kind: str, word: TextPiece, at: TextPiece) -> TextPiece:
        """Return a name in fuzzylite's spelling; report a change."""
        name = _identifier(word.text)
        if name != word.text:
            message = f"fuzzylite calls the {kind} '{word.text[:60]}' {name}"
            self.findings.info("renamed", message, at)
        return TextPiece(name, at.span)

    def _setting(self, line: _SettingLine) -> None:
        key = line.key.text
        if not self.section:
            self.findings.error("syntax", f"'{key[:40]}' is before any section", line.key)
        elif self.section == "Engine":
            if key == "description":
                self.description = line.value.text
            else:
                self.findings.unknown("unknown-key", "the key", line.key, ("description",))
        elif self.draft is not None:
            self._variable_setting(self.draft, line)
        else:
            self._block_setting(self.blocks[-1], line)

    def _variable_setting(self, draft: VariableDraft, line: _SettingLine) -> None:
        match line.key.text:
            case "description":
                draft.description = line.value.text
            case "enabled":
                draft.enabled = _flag(line, self.findings, default=True)
            case "range":
                draft.set_range(line.words(), line.value, self.findings, "two numbers")
            case "lock-range":
                draft.outside = "clamp" if _flag(line, self.findings) else "extend"
            case "term":
                if self.findings.room(len(self.terms), 5 * MAX_TERMS, "terms", line.key):
                    self.terms.append((draft, line))
            case _ if draft.is_output:
                self._output_setting(draft, line)
            case _:
                self.findings.unknown("unknown-key", "the key", line.key, _INPUT_KEYS)

    def _output_setting(self, draft: VariableDraft, line: _SettingLine) -> None:
        match line.key.text:
            case "aggregation" | "accumulation":
                norm = self.snorm(line.value)
                draft.aggregation, draft.aggregates = norm or "sum", norm is not None
            case "defuzzifier":
                self._defuzzifier(draft, line)
            case "default":
                value = number(line.value.text)
                if draft.no_rule == "hold" and value is not None and not math.isnan(value):
                    self._held_default(line.key)
                self.default(draft, line.value)
            case "lock-previous" | "lock-valid" | "lock-defuzz":
                if _flag(line, self.findings):
                    if isinstance(draft.no_rule, float) and not math.isnan(draft.no_rule):
                        self._held_default(line.key)
                    draft.no_rule = "hold"
            case _:
                self.findings.unknown("unknown-key", "the key", line.key, _OUTPUT_KEYS)

    def _held_default(self, at: TextPiece) -> None:
        message = "the value is held; the default counts only before the first value"
        hint = "pass it as the held value"
        self.findings.loss("default-with-hold", message, at, hint, slight=True)

    def _defuzzifier(self, draft: VariableDraft, line: _SettingLine) -> None:
        """Read method and resolution, or method and inference of values."""
        words = line.words()
        if not words or words[0].text == "none":
            draft.method = TextPiece("", line.key.span)
            return
        # Findings point at the whole value, those of a misspelt method at its word.
        is_known = words[0].text in (*FLL.integral, *FLL.weighted)
        draft.method = TextPiece(words[0].text, line.value.span if is_known else words[0].span)
        if words[0].text in FLL.integral:
            draft.resolution = _resolution(words, self.findings)
        draft.inference = words[1] if len(words) > 1 else None

    def _term(self, draft: VariableDraft, line: _SettingLine) -> None:
        words = line.words()
        if len(words) < 2:
            message = "a term is 'name Class numbers'"
            self.findings.error("syntax", message, line.value if words else line.key)
            return
        name, kind, parameters = words[0], words[1], words[2:]
        offset = kind.span.end_column - line.value.span.column
        rest = line.value.text[offset:].strip()
        formula = TextPiece(
            rest, parameters[0].span.to(line.value.span) if parameters else kind.span
        )
        word = self._identifier("term", name, name)
        self.term(draft, word, _shape(kind, parameters, formula, len(self.inputs), self.findings))

    # --- Rule blocks ---

    def _block_setting(self, block: BlockDraft, line: _SettingLine) -> None:
        match line.key.text:
            case "description":
                if line.value.text:
                    message = "the model cannot hold the description of a rule block"
                    self.findings.info("dropped-description", message, line.key)
            case "enabled":
                block.enabled = _flag(line, self.findings, default=True)
            case "conjunction":
                block.conjunction = self.tnorm(line.value)
            case "disjunction":
                block.disjunction = self.snorm(line.value)
            case "implication":
                block.implication = self.tnorm(line.value)
            case "activation":
                self._activation(block, line)
            case "rule":
                count = sum(map(len, self.rules))
                if self.findings.room(count, MAX_RULES, "rules", line.key):
                    self.rules[-1].append(line)
            case _:
                self.findings.unknown("unknown-key", "the key", line.key, _BLOCK_KEYS)

    def _activation(self, block: BlockDraft, line: _SettingLine) -> None:
        parts = line.words()
        method = parts[0].text if parts else "none"
        tnorms = words(TNORMS, FLL.kinds)
        if method in tnorms:  # fuzzylite 5 wrote activation for implication
            block.implication = tnorms[method]
        elif method in _ACTIVATIONS:
            threshold = _threshold(parts)
            if threshold is None:
                message = f"the activation method '{line.value.text[:60]}' cannot be carried"
                self.findings.loss("unsupported-activation", message, line.value)
            else:
                block.threshold = threshold
                block.always_concludes = method == "General"
        elif method != "none":
            self.findings.unknown("unknown-activation", "the method", parts[0], _ACTIVATIONS)

    def _blocks(self) -> Iterator[BlockDraft]:
        """Yield the enabled blocks, with their rules."""
        for block, lines in zip(self.blocks, self.rules, strict=True):
            if not self.is_on(block):
                continue
            rules = [line.value.parts(_WORD) for line in lines]
            for line, rule in zip(lines, rules, strict=True):
                if not rule:
                    self.findings.error("syntax", "the rule is empty", line.key)
            block.rules = read_sentences(filter(None, rules), self.variables, self.findings, FLL)
            yield block


def _identifier(name: str) -> str:
    """Return `name` in fuzzylite's spelling: letters, digits and underscores only."""
    cleaned = re.sub(r"\W", "", name) or "_"
    return f"_{cleaned}" if cleaned[0].isnumeric() else cleaned


# --- Write FLL ---


def write_fll(rulebase: RuleBase, *, lossy: bool = False, strict: bool = False) -> Exported:
    """Write an engine of fuzzylite: :func:`~fuzzyarm.exchange.formats.registry.write` of ``.fll``.

    Parameters
    ----------
    rulebase, lossy, strict
        As there.

    Returns
    -------
    Exported
        The text, if there is no error, and every finding.
    """
    return _Writer(rulebase, FLL, lossy=lossy, strict=strict).export()


class _Writer(SystemWriter):
    file = "fuzzylite"
    descriptions = True

    def settle_names(self) -> None:
        self.names = identifiers(self.rulebase, self.findings, FUZZYLITE_WORDS)

    def head(self) -> list[str]:
        rulebase = self.rulebase
        lines = [f"# {HEADER}.", f"Engine: {self.one_line(rulebase.name, '#')}"]
        if rulebase.description:
            lines.append(f"description: {self.one_line(rulebase.description, '#')}")
        return lines

    def variable(self, variable: Input | Output, index: int) -> list[str]:
        kind = "OutputVariable" if isinstance(variable, Output) else "InputVariable"
        lines = [f"{kind}: {self.names.variable(variable.name)}"]
        if variable.description:
            lines.append(f"  description: {self.one_line(variable.description, '#')}")
        lines += [
            "  enabled: true",
            f"  range: {written(variable.low)} {written(variable.high)}",
            f"  lock-range: {'false' if variable.outside == 'extend' else 'true'}",
        ]
        if isinstance(variable, Output):
            lines += self._output(variable)
        for term in variable.terms:
            name = self.names.term(variable.name, term.name)
            lines.append(f"  term: {name} {self.fuzzylite_term(variable, term)}")
        return lines

    def _output(self, output: Output) -> list[str]:
        plain = output.defuzzifier.record.weighs and output.aggregation == "sum"
        aggregation = "none" if plain else self.snorm(output.aggregation)
        no_rule = self.no_rule(output)
        default = no_rule if isinstance(no_rule, float | int) else math.nan
        return [
            f"  aggregation: {aggregation}",
            f"  defuzzifier: {self.defuzzifier(output)} {self._kind(output)}",
            f"  default: {written(default)}",
            f"  lock-previous: {'true' if no_rule == 'hold' else 'false'}",
        ]

    def _kind(self, output: Output) -> str:
        """Return the argument of the method: inference of values, or the samples of sets."""
        record = output.defuzzifier.record
        if record.weighs:
            return "Tsukamoto" if record.inverts else "TakagiSugeno"
        return str(output.defuzzifier.resolution or FLL.samples[0])

    def block(self, block: RuleBlock, index: int) -> list[str]:
        above = block.threshold
        activation = "General" if above == 0.0 else f"Threshold > {written(above)}"
        rules = written_sentences(block, FLL, self.names, self.findings)
        return [
            f"RuleBlock: {self.one_line(block.name, '#')}",
            "  enabled: true",
            f"  conjunction: {self.tnorm(block.conjunction)}",
            f"  disjunction: {self.snorm(block.disjunction)}",
            f"  implication: {self.tnorm(block.implication)}",
            f"  activation: {activation}",
            *(f"  rule: {rule}" for rule in rules),
        ]
