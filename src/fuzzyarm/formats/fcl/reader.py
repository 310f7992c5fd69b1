"""Read FCL."""

from __future__ import annotations

import math

from fuzzyarm.formats.draft import Draft
from fuzzyarm.formats.fcl.cursor import Cursor, SyntaxFaultError
from fuzzyarm.formats.fcl.dialect import detect, finish_output
from fuzzyarm.formats.fcl.lexer import SECTIONS, fcl_words
from fuzzyarm.formats.fcl.rules import blocks_in_model, read_block
from fuzzyarm.formats.fcl.variables import FunctionBlock, VariableReader
from fuzzyarm.formats.fcl.walk import settle_edges
from fuzzyarm.formats.imported import (
    MAX_VARIABLES,
    Findings,
    Imported,
    Word,
    too_long,
)
from fuzzyarm.formats.shaping import estimated_range
from fuzzyarm.rulebase.model import RuleBase

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
