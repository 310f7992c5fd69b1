"""Declarations, FUZZIFY and DEFUZZIFY of FCL."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from fuzzyarm.formats.draft import Draft, add_term
from fuzzyarm.formats.fcl.cursor import Cursor, SyntaxFaultError
from fuzzyarm.formats.fcl.lexer import SECTIONS
from fuzzyarm.formats.fcl.rules import BlockText
from fuzzyarm.formats.fcl.terms import fcl_shape
from fuzzyarm.formats.imported import MAX_VARIABLES, Findings, Word
from fuzzyarm.formats.norms import FCL_DISJUNCTIONS
from fuzzyarm.formats.numerals import number


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
