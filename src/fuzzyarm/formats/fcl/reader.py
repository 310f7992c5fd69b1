"""Read FCL: function blocks, declarations, FUZZIFY and DEFUZZIFY."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from fuzzyarm.formats.fcl.dialect import detect, finish_output, settle_edges
from fuzzyarm.formats.fcl.rules import BlockText, blocks_in_model, fcl_shape, read_block
from fuzzyarm.formats.fcl.tokens import SECTIONS, Cursor, SyntaxFaultError, fcl_words
from fuzzyarm.formats.findings import (
    MAX_VARIABLES,
    Draft,
    Findings,
    Imported,
    Word,
    add_term,
    number,
    too_long,
)
from fuzzyarm.formats.shapes import FCL_DISJUNCTIONS, estimated_range
from fuzzyarm.model.rulebase import RuleBase

# --- Declarations, FUZZIFY and DEFUZZIFY of FCL ---


@dataclass(slots=True)
class FunctionBlock:
    """A function block while it is read."""

    word: Word
    variables: dict[str, Draft] = field(default_factory=dict)
    methods: dict[str, Word] = field(default_factory=dict)
    accumulations: dict[str, str] = field(default_factory=dict)
    blocks: list[BlockText] = field(default_factory=list)


class VariableReader:
    """Reads what a function block says of its variables.

    Parameters
    ----------
    cursor : Cursor
        Behind the word that begins a section.
    block : FunctionBlock
        Where the variables go.
    dialect : str
        ``jfuzzylogic`` or ``fuzzylite``.
    findings : Findings
        Where faults go.
    """

    def __init__(
        self, cursor: Cursor, block: FunctionBlock, dialect: str, findings: Findings
    ) -> None:
        self.cursor = cursor
        self.block = block
        self.dialect = dialect
        self.findings = findings

    def declarations(self, *, is_output: bool) -> None:
        """Read from behind VAR_INPUT or VAR_OUTPUT to behind END_VAR."""
        cursor = self.cursor
        last: Draft | None = None
        while not cursor.skip("END_VAR"):
            if cursor.key() == "RANGE" and last is not None:
                self._range(last)
                continue
            word = cursor.name("a variable")
            if word.text in self.block.variables:
                message = f"there are two variables called '{word.text}'"
                self.findings.error("duplicate-variable", message, word)
            last = Draft(word, is_output)
            if self.findings.room(len(self.block.variables), MAX_VARIABLES, "variables", word):
                last = self.block.variables.setdefault(word.text, last)
            cursor.expect(":")
            while not cursor.ended and cursor.word.text != ";" and cursor.key() != "END_VAR":
                if cursor.word.span.line != word.span.line:
                    break
                cursor.take()
            cursor.skip(";")

    def fuzzify(self, *, is_output: bool) -> None:
        """Read from behind FUZZIFY or DEFUZZIFY to behind its end."""
        cursor = self.cursor
        end = "END_DEFUZZIFY" if is_output else "END_FUZZIFY"
        draft = self._variable(is_output=is_output)
        while not cursor.skip(end):
            if cursor.ended or cursor.key() in SECTIONS:
                raise SyntaxFaultError(f"'{end}' is missing", cursor.word)
            try:
                self._statement(draft)
            except SyntaxFaultError as fault:
                self.findings.error(fault.name, str(fault), fault.word)
                cursor.at += cursor.key() not in (end, *SECTIONS)
                cursor.to_next_statement()

    def _variable(self, *, is_output: bool) -> Draft:
        word = self.cursor.name("a variable")
        draft = self.block.variables.get(word.text)
        if draft is None:
            kind = "VAR_OUTPUT" if is_output else "VAR_INPUT"
            message = f"'{word.text}' is not declared in {kind}"
            self.findings.warn("undeclared-variable", message, word)
            draft = Draft(word, is_output)
            if self.findings.room(len(self.block.variables), MAX_VARIABLES, "variables", word):
                self.block.variables[word.text] = draft
        if draft.is_output != is_output:
            kind = "output" if draft.is_output else "input"
            message = f"'{word.text}' is declared as an {kind}"
            self.findings.error("wrong-section", message, word)
        return draft

    def _statement(self, draft: Draft) -> None:
        cursor = self.cursor
        inputs = sum(not d.is_output for d in self.block.variables.values())
        match cursor.key():
            case "TERM":
                cursor.take()
                word = cursor.name("a term")
                cursor.skip(":=", "=", ":")
                shape = fcl_shape(cursor, self.dialect, inputs, self.findings)
                if shape is not None:
                    keep = "last" if self.dialect == "jfuzzylogic" else "first"
                    add_term(draft, word, shape, self.findings, keep=keep)
            case "RANGE":
                self._range(draft)
            case "ENABLED":
                cursor.take()
                cursor.skip(":", ":=", "=")
                draft.enabled = cursor.take().text.upper() != "FALSE"
            case "METHOD" if draft.is_output:
                cursor.take()
                cursor.skip(":", ":=", "=")
                self.block.methods[draft.name] = cursor.name("a method")
            case "ACCU" if draft.is_output:
                self._accumulation(draft)
            case "DEFAULT" if draft.is_output:
                self._default(draft)
            case "LOCK" if draft.is_output:
                self._lock(draft)
            case _:
                found = cursor.word.text[:40]
                message = f"TERM, RANGE and the like are expected here, not '{found}'"
                raise SyntaxFaultError(message, cursor.word)
        if not cursor.skip(";") and cursor.word.text not in ("", ";"):
            self._after_statement()

    def _after_statement(self) -> None:
        """Complain where a statement goes on after its end."""
        cursor = self.cursor
        if cursor.at and cursor.word.span.line == cursor.words[cursor.at - 1].span.line:
            word = cursor.word
            if not cursor.key().startswith(("END_", "TERM", "RANGE", "METHOD")):
                raise SyntaxFaultError(f"';' is expected before '{word.text[:40]}'", word)

    def _range(self, draft: Draft) -> None:
        cursor = self.cursor
        cursor.take()
        cursor.skip(":=", "=", ":")
        cursor.expect("(")
        draft.low = cursor.number()
        cursor.expect("..", ",")
        draft.high = cursor.number()
        cursor.expect(")")
        cursor.skip(";")

    def _accumulation(self, draft: Draft) -> None:
        cursor = self.cursor
        cursor.take()
        cursor.skip(":", ":=", "=")
        word = cursor.name("a norm")
        if word.text.upper() == "NONE":
            return
        if word.text.upper() not in FCL_DISJUNCTIONS:
            self.findings.unknown("unknown-norm", "the accumulation", word, FCL_DISJUNCTIONS)
            return
        self.block.accumulations[draft.name] = FCL_DISJUNCTIONS[word.text.upper()]

    def _default(self, draft: Draft) -> None:
        cursor = self.cursor
        cursor.take()
        cursor.skip(":=", "=", ":")
        if cursor.skip("NC"):
            draft.no_rule = "hold"
            return
        if cursor.key() in ("NAN", "INF"):
            draft.no_rule = number(cursor.take().text) or math.nan
        else:
            draft.no_rule = cursor.number()
        if cursor.skip("|") and cursor.skip("NC"):
            message = "the value is held; the default counts only before the first value"
            self.findings.info("default-with-hold", message, draft.word)
            draft.no_rule = "hold"

    def _lock(self, draft: Draft) -> None:
        cursor = self.cursor
        cursor.take()
        cursor.skip(":", ":=", "=")
        while cursor.key() in ("PREVIOUS", "RANGE", "NONE", "|"):
            word = cursor.take().text.upper()
            if word == "PREVIOUS":
                draft.no_rule = "hold"
            elif word == "RANGE":
                draft.outside = "clamp"


# --- Read FCL ---

_OPTIONS = {"OPTIONS": "END_OPTIONS", "OPTION": "END_OPTION"}


def parse_fcl(
    text: str,
    path: str = "<text>",
    *,
    dialect: str | None = None,
    block: str | None = None,
    lossy: bool = False,
) -> Imported:
    """Read a function block of IEC 61131-7; never raises.

    Parameters
    ----------
    text : str
        Any text at all.
    path : str
        Name of the file, for the diagnostics.
    dialect : {"jfuzzylogic", "fuzzylite"}, optional
        Whose defaults to take. By default what the text looks like, else jFuzzyLogic.
    block : str, optional
        The function block to take where there are several; the first by default.
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
    plain = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
    return _Reader(plain, path, dialect or detect(plain), lossy).read(block)


class _Reader:
    def __init__(self, text: str, path: str, dialect: str, lossy: bool) -> None:
        self.findings = Findings(path, lossy=lossy)
        self.dialect = dialect
        self.cursor = Cursor(fcl_words(text, self.findings))
        self.blocks: list[FunctionBlock] = []

    def read(self, wanted: str | None) -> Imported:
        while not self.cursor.ended:
            try:
                self._section()
            except SyntaxFaultError as fault:
                self.findings.error(fault.name, str(fault), fault.word)
                self._to_next_section()
        block = self._chosen(wanted)
        rulebase = self._rulebase(block) if block is not None else None
        if self.findings.failed:
            rulebase = None
        self._say_dialect()
        return Imported(rulebase, self.findings.all(), self.dialect)

    def _say_dialect(self) -> None:
        message = {
            "jfuzzylogic": "read as jFuzzyLogic does: 1000 left samples, ACCU is SUM unless given",
            "fuzzylite": "read as fuzzylite does: 1000 midpoints, nan where no rule fires",
        }[self.dialect]
        self.findings.info("assumed-producer", message)

    def _chosen(self, wanted: str | None) -> FunctionBlock | None:
        if not self.blocks:
            if not self.findings.failed:
                self.findings.error("no-engine", "there is no FUNCTION_BLOCK in this file")
            return None
        names = [block.word.text for block in self.blocks]
        if wanted is not None and wanted not in names:
            self.findings.unknown("unknown-block", "the function block", Word(wanted), names)
            return None
        chosen = self.blocks[names.index(wanted) if wanted is not None else 0]
        for other in self.blocks:
            if other is not chosen:
                message = f"the function block '{other.word.text}' is left out"
                self.findings.warn("several-blocks", message, other.word)
        return chosen

    def _section(self) -> None:
        cursor = self.cursor
        key = cursor.key()
        if key == "FUNCTION_BLOCK":
            cursor.take()
            is_name = not cursor.ended and cursor.key() not in SECTIONS
            word = cursor.take() if is_name else Word("", cursor.word.span)
            self.blocks.append(FunctionBlock(word))
        elif key == "END_FUNCTION_BLOCK":
            cursor.take()
            cursor.skip(";")
        elif key in SECTIONS:
            self._inner(key)
        elif key in _OPTIONS:
            word = cursor.take()
            while not cursor.ended and not cursor.skip(_OPTIONS[key]):
                cursor.take()
            self.findings.info("dropped-options", "the options are left out", word)
        else:
            found = cursor.word.text[:40]
            message = f"a section such as FUZZIFY or RULEBLOCK is expected here, not '{found}'"
            raise SyntaxFaultError(message, cursor.word)

    def _inner(self, key: str) -> None:
        if not self.blocks:
            self.blocks.append(FunctionBlock(Word("", self.cursor.word.span)))
        block = self.blocks[-1]
        reader = VariableReader(self.cursor, block, self.dialect, self.findings)
        self.cursor.take()
        if key in ("VAR_INPUT", "VAR_OUTPUT"):
            reader.declarations(is_output=key == "VAR_OUTPUT")
        elif key in ("FUZZIFY", "DEFUZZIFY"):
            reader.fuzzify(is_output=key == "DEFUZZIFY")
        else:
            text = read_block(self.cursor, self.findings)
            if self.findings.room(len(block.blocks), MAX_VARIABLES, "rule blocks", text.word):
                block.blocks.append(text)

    def _to_next_section(self) -> None:
        cursor = self.cursor
        cursor.at += not cursor.ended
        while not cursor.ended:
            if cursor.key() in SECTIONS or cursor.key() == "END_FUNCTION_BLOCK":
                return
            cursor.take()

    def _rulebase(self, block: FunctionBlock) -> RuleBase:
        for draft in block.variables.values():
            self._settle(block, draft)
        blocks = blocks_in_model(
            block.blocks, block.variables, block.accumulations, self.dialect, self.findings
        )
        if not any(b.rules for b in blocks):
            self.findings.warn("no-rules", "the function block has no rules", block.word)
        drafts = block.variables.values()
        return RuleBase(
            block.word.text,
            tuple(d.input() for d in drafts if not d.is_output),
            tuple(d.output() for d in drafts if d.is_output),
            blocks,
        )

    def _settle(self, block: FunctionBlock, draft: Draft) -> None:
        if draft.is_output:
            draft.aggregation = block.accumulations.get(draft.name, "sum")
            finish_output(draft, block.methods.get(draft.name), self.dialect, self.findings)
        if math.isinf(draft.low) and math.isinf(draft.high):
            self._estimate(draft)
        draft.settle_range(self.findings)
        if draft.is_output and self.dialect == "jfuzzylogic":
            settle_edges(draft, self.findings)

    def _estimate(self, draft: Draft) -> None:
        integrated = draft.is_output and draft.defuzzifier.resolution is not None
        estimate = estimated_range([term.shape for term in draft.terms])
        if estimate is not None and all(map(math.isfinite, estimate)):
            draft.low, draft.high = estimate
            if integrated:
                message = (
                    f"'{draft.name}' has no RANGE; its terms reach from {estimate[0]} to "
                    f"{estimate[1]}"
                )
                self.findings.info("estimated-range", message, draft.word)
        elif integrated and draft.terms:
            message = f"the output '{draft.name}' needs a RANGE to be integrated over"
            self.findings.error("bad-range", message, draft.word)
        elif integrated:
            draft.low, draft.high = -0.5, 0.5
