"""Read FLL."""

from __future__ import annotations

import math
import re

from fuzzyarm.formats.draft import Draft, add_term
from fuzzyarm.formats.fll.blocks import Block, block_setting, flag, norm
from fuzzyarm.formats.fll.lines import Line, fll_lines
from fuzzyarm.formats.fll.outputs import settle_defuzzifier
from fuzzyarm.formats.fll.terms import shape_of
from fuzzyarm.formats.fuzzylite_rules import Norms, RuleBuilder, concluded
from fuzzyarm.formats.imported import (
    MAX_TERMS,
    MAX_VARIABLES,
    Findings,
    Imported,
    Word,
    too_long,
)
from fuzzyarm.formats.norms import FLL_DISJUNCTIONS
from fuzzyarm.formats.numerals import number, rounded
from fuzzyarm.formats.propositions import RuleParser
from fuzzyarm.formats.rule_text import Dialect, RuleFaultError, RuleText
from fuzzyarm.rulebase.diagnostic import Span
from fuzzyarm.rulebase.model import RuleBase, RuleBlock

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
