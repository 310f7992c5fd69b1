"""Read FIS."""

from __future__ import annotations

import math
import re

from fuzzyarm.formats.draft import Draft, unique_name
from fuzzyarm.formats.fis.lines import (
    Section,
    bracketed,
    fis_sections,
    key_and_value,
    membership_parts,
    unquoted,
)
from fuzzyarm.formats.fis.meaning import System, detect, finish_output, rules_in_model
from fuzzyarm.formats.fis.rules import RuleReader
from fuzzyarm.formats.fis.terms import fis_shape
from fuzzyarm.formats.imported import (
    MAX_RULES,
    MAX_TERMS,
    MAX_VARIABLES,
    Findings,
    Imported,
    Word,
    too_long,
)
from fuzzyarm.formats.numerals import number, rounded
from fuzzyarm.rulebase.diagnostic import NOWHERE, Span
from fuzzyarm.rulebase.model import RuleBase, RuleBlock, Term

_MEMBERSHIP_KEY = re.compile(r"MF(\d{1,6})\Z", re.IGNORECASE)


def parse_fis(
    text: str, path: str = "<text>", *, producer: str | None = None, lossy: bool = False
) -> Imported:
    """Read a fuzzy inference system of MATLAB, Octave or fuzzylite; never raises.

    Parameters
    ----------
    text : str
        Any text at all.
    path : str
        Name of the file, for the diagnostics.
    producer : {"matlab", "octave", "fuzzylite"}, optional
        Whose meaning to take where they differ (sampling, hedges, what no rule gives).
        By default what the text looks like, else MATLAB.
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
    plain = text.replace("\r\n", "\n").replace("\r", "\n")
    return _Reader(plain, path, producer or detect(plain), lossy).read()


class _Reader:
    def __init__(self, text: str, path: str, producer: str, lossy: bool) -> None:
        self.text = text
        self.producer = producer
        self.findings = Findings(path, lossy=lossy)
        self.system = System()
        self.inputs: list[Draft] = []
        self.outputs: list[Draft] = []
        self.terms: dict[str, dict[int, str]] = {}
        self.rules: list[Word] = []
        self.seen: dict[tuple[str, int], Span] = {}

    def read(self) -> Imported:
        sections = fis_sections(self.text, self.findings)
        if not sections and not self.findings.failed:
            self.findings.error("no-engine", "there is no section like [System] in this file")
        inputs = sum(section.kind == "input" for section in sections)
        # [Input2] may stand before [Input1]; the rules go by number.
        for section in sorted(sections, key=lambda section: section.number):
            self._section(section, inputs)
        for draft in (*self.inputs, *self.outputs):
            draft.settle_range(self.findings)
        for draft in self.outputs:
            finish_output(draft, self.system, self.producer, self.findings)
        block = self._block()
        self._check_counts()
        self._notes()
        rulebase = None if self.findings.failed else self._rulebase(block)
        return Imported(rulebase, self.findings.all(), self.producer)

    def _rulebase(self, block: RuleBlock) -> RuleBase:
        return RuleBase(
            self.system.text("name"),
            tuple(draft.input() for draft in self.inputs),
            tuple(draft.output() for draft in self.outputs),
            (block,),
        )

    def _section(self, section: Section, inputs: int) -> None:
        key = (section.kind, section.number)
        if key in self.seen:
            message = (
                f"the section [{section.kind.capitalize()}{section.number or ''}] stands twice"
            )
            self.findings.error("duplicate-section", message, section.span)
            return
        self.seen[key] = section.span
        if section.kind == "system":
            self.system.read(section, self.findings)
        elif section.kind == "rules":
            self.rules = section.lines
        else:
            self._variable(section, inputs)

    def _variable(self, section: Section, inputs: int) -> None:
        count = len(self.inputs) + len(self.outputs)
        if not self.findings.room(count, MAX_VARIABLES, "variables", section.span):
            return
        is_output = section.kind == "output"
        draft = Draft(Word("", section.span), is_output)
        if is_output:
            draft.no_rule = math.nan
        taken: dict[int, str] = {}
        memberships: list[tuple[int, Word]] = []
        for line in section.lines:
            parts = key_and_value(line)
            if parts is None:
                message = f"'{line.text[:40]}' is no 'key=value'"
                self.findings.error("syntax", message, line)
                continue
            self._variable_setting(draft, *parts, memberships)
        self._name(draft, section)
        for index, value in memberships:
            self._term(draft, index, value, taken, inputs)
        self.terms[draft.name] = taken
        (self.outputs if is_output else self.inputs).append(draft)

    def _name(self, draft: Draft, section: Section) -> None:
        name = draft.name or f"{section.kind}{section.number or ''}"
        used = {d.name for d in (*self.inputs, *self.outputs)}
        unique = unique_name(name, used)
        if unique != draft.name:
            what = "has no name" if not draft.name else f"shares the name '{name}'"
            message = f"the {section.kind} {what}; it is called '{unique}'"
            name_ = "duplicate-variable" if draft.name else "missing-name"
            self.findings.warn(name_, message, draft.word)
        draft.word = Word(unique, draft.word.span)

    def _variable_setting(
        self, draft: Draft, key: Word, value: Word, memberships: list[tuple[int, Word]]
    ) -> None:
        membership = _MEMBERSHIP_KEY.match(key.text)
        match key.text.lower():
            case "name":
                draft.word = Word(unquoted(value).text, value.span)
            case "range":
                self._range(draft, value)
            case "nummfs":
                pass
            case "enabled":
                draft.enabled = number(value.text) == 1.0
            case "default" if draft.is_output:
                self._default(draft, value)
            case "lockprevious" if draft.is_output:
                if number(value.text) == 1.0:
                    draft.no_rule = "hold"
            case "lockrange":
                draft.outside = "clamp" if number(value.text) == 1.0 else "extend"
            case _ if membership:
                memberships.append((int(membership.group(1)), value))
            case _:
                self.findings.unknown("unknown-key", "the key", key, ("Name", "Range", "NumMFs"))

    def _default(self, draft: Draft, value: Word) -> None:
        default = number(value.text)
        if default is None:
            self.findings.error("not-a-number", f"'{value.text[:40]}' is not a number", value)
        elif draft.no_rule != "hold":
            draft.no_rule = default

    def _range(self, draft: Draft, value: Word) -> None:
        values = [number(word.text) for word in bracketed(value)]
        if len(values) != 2 or values[0] is None or values[1] is None:
            message = f"a range is two numbers in brackets, not '{value.text[:40]}'"
            self.findings.error("bad-range", message, value)
            return
        draft.low, draft.high = values[0], values[1]

    def _term(
        self, draft: Draft, index: int, value: Word, taken: dict[int, str], inputs: int
    ) -> None:
        parts = membership_parts(value)
        if parts is None:
            message = "a membership function is 'name':'kind',[numbers]"
            self.findings.error("syntax", message, value)
            return
        name, kind, rest = parts
        if index in taken:
            message = f"'{draft.name}' has two functions with the number {index}"
            self.findings.error("duplicate-index", message, value)
            return
        if not self.findings.room(len(taken), MAX_TERMS, "terms of a variable", value):
            return
        unique = unique_name(name.text or f"mf{index}", set(taken.values()))
        taken[index] = unique
        if name.text and unique != name.text:
            message = (
                f"'{draft.name}' has two terms called '{name.text}'; the rules tell them apart "
                f"by number, so this one is called '{unique}'"
            )
            self.findings.warn("duplicate-term-name", message, name)
        shape = fis_shape(kind, rest, inputs, self.findings)
        if shape is not None:
            draft.add(Term(unique, shape, name.span))

    def _block(self) -> RuleBlock:
        reader = RuleReader(
            tuple(self.inputs), tuple(self.outputs), self.terms, self.producer, self.findings
        )
        if len(self.rules) > MAX_RULES:
            self.findings.room(len(self.rules), MAX_RULES, "rules", self.rules[MAX_RULES])
        rules = self.rules[:MAX_RULES]
        texts = [text for line in rules if (text := reader.read(line)) is not None]
        drafts = {draft.name: draft for draft in (*self.inputs, *self.outputs)}
        return rules_in_model(texts, drafts, self.system, self.producer, self.findings)

    def _check_counts(self) -> None:
        for key, counted in (
            ("numinputs", len(self.inputs)),
            ("numoutputs", len(self.outputs)),
            ("numrules", len(self.rules)),
        ):
            word = self.system.values.get(key)
            if word is not None and number(word.text) != counted:
                message = f"the file says {word.text[:20]}, but there are {counted}"
                self.findings.warn("wrong-count", message, word)

    def _notes(self) -> None:
        if ("rules", 0) not in self.seen:
            self.findings.warn("no-rules", "the file has no [Rules]")
        match = rounded(self.text) if self.producer == "fuzzylite" else None
        if match is not None:
            line = self.text.count("\n", 0, match.start()) + 1
            column = match.start() - self.text.rfind("\n", 0, match.start())
            span = Span(line, column, line, column + len(match.group()))
            message = "every number of this file has three decimals, so some may be rounded"
            self.findings.info("rounded-number", message, span)
        message = {
            "fuzzylite": "read with the defaults of fuzzylite: 1000 midpoints, nan where no rule "
            "fires",
            "octave": "read with the defaults of Octave's toolkit: sums over 101 points, nan "
            "where no rule fires",
            "matlab": "read with the defaults of MATLAB: sums over 101 points, the middle of the "
            "range where no rule fires",
        }[self.producer]
        self.findings.info("assumed-producer", message, NOWHERE)
