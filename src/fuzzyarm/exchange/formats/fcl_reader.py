"""FCL, the language of IEC 61131-7, in the spellings of jFuzzyLogic, fuzzylite and others: read."""

from __future__ import annotations

import math
import re

from fuzzyarm.exchange.formats.dialects import FCL, Dialect
from fuzzyarm.exchange.formats.drafts import VariableDraft, imported
from fuzzyarm.exchange.formats.fcl_blocks import BlockText, FunctionBlock
from fuzzyarm.exchange.formats.fcl_scikit import ScikitBlock
from fuzzyarm.exchange.formats.fcl_text import (
    SECTION_ENDS,
    SECTIONS,
    WordCursor,
    fcl_words,
    read_shape,
)
from fuzzyarm.exchange.formats.findings import (
    MAX_RULES,
    MAX_VARIABLES,
    FaultError,
    Findings,
    Imported,
    TextPiece,
    number,
)
from fuzzyarm.language.model.rulebase import RuleBase

# --- Detection of the program ---

_ONLY_FUZZYLITE = re.compile(
    r"[:=]\s*(EPROD|DPROD|HPROD|ESUM|DSUM|HSUM|NMIN|NMAX|COGSS|Triangle|Trapezoid|Bell|Gaussian|"
    r"Sigmoid|Ramp|Rectangle|ZShape|SShape|PiShape|Linear|Concave|Spike|Discrete)\b"
    r"|^[^\S\n]*(ENABLED|LOCK)\s*:",
    re.MULTILINE,
)


_STEP = re.compile(r"\bRANGE\b[\s:=]*\([^()]*\)\s*WITH\b", re.IGNORECASE)
_COMMENT = re.compile(r"//[^\n]*|#[^\n]*|/\*.*?(?:\*/|\Z)|\(\*.*?(?:\*\)|\Z)", re.DOTALL)
_IN_INPUT = re.compile(r"\b(?:FUZZIFY|END_FUZZIFY|RANGE)\b", re.IGNORECASE)


def detect(text: str) -> str:
    """Return the program of a text: jFuzzyLogic unless a spelling is another's.

    jFuzzyLogic refuses a range inside FUZZIFY, and fuzzylite its step as well.
    """
    plain = _COMMENT.sub("", text)
    if _STEP.search(plain):
        return "scikit-fuzzy"
    head = text[:2000].lower()
    if "fuzzylite" in head or _ONLY_FUZZYLITE.search(plain) or _has_accu_in_defuzzify(plain):
        return "fuzzylite"
    if _has_range_in_fuzzify(plain):
        # fuzzylite knows the words of a rule in lower case only.
        return "fuzzylite" if re.search(r"\bif\b", plain) else "scikit-fuzzy"
    return "jfuzzylogic"


def _has_range_in_fuzzify(text: str) -> bool:
    has_range: bool | None = None  # outside of a section
    for match in _IN_INPUT.finditer(text):
        match match.group().upper():
            case "FUZZIFY":
                has_range = bool(has_range)
            case "RANGE":
                has_range = None if has_range is None else True
            case _:
                if has_range:
                    return True
                has_range = None
    return False


def _has_accu_in_defuzzify(text: str) -> bool:
    inside = False
    for match in re.finditer(r"\b(END_DEFUZZIFY|DEFUZZIFY|ACCU)\b", text, re.IGNORECASE):
        word = match.group().upper()
        if word == "ACCU" and inside:
            return True
        if word != "ACCU":
            inside = word == "DEFUZZIFY"
    return False


# --- From the text to its blocks ---


def _joined_numbers(words: list[TextPiece]) -> list[TextPiece]:
    """Join the sign and the number of a weight."""
    if len(words) > 2 and words[-2].text in ("-", "+"):
        sign, value = words[-2], words[-1]
        words[-2:] = [TextPiece(sign.text + value.text, sign.span.to(value.span))]
    return words


# --- Words ---

_END_OF_RULE = frozenset({";", "RULE", "END_RULEBLOCK", "END_FUNCTION_BLOCK", *SECTIONS})
_END_OF_TITLE = frozenset({*SECTIONS, *SECTION_ENDS, "OPTIONS", "OPTION"})
_STATEMENTS = frozenset({"TERM", "RANGE", "METHOD", "ACCU", "DEFAULT", "ENABLED", "LOCK"})
_BLOCK_SETTINGS = frozenset({"AND", "OR", "ACT", "ACCU", "RULE", "ENABLED"})
_OPTIONS = {"OPTIONS": "END_OPTIONS", "OPTION": "END_OPTION"}


class _Reader:
    """Reads function blocks in the dialect of one program."""

    def __init__(self, text: str, dialect: Dialect, findings: Findings) -> None:
        self.findings = findings
        self.dialect = dialect
        self.cursor = WordCursor(fcl_words(text, findings))
        self.blocks: list[FunctionBlock] = []
        self.block = self._new(TextPiece(""))  # the current one

    def _new(self, word: TextPiece) -> FunctionBlock:
        is_scikits = self.dialect.producer == "scikit-fuzzy"
        return (ScikitBlock if is_scikits else FunctionBlock)(word, self.dialect, self.findings)

    def read(self, name: str | None) -> RuleBase | None:
        """Return the rule base of the block `name`, of the first one without a name."""
        while not self.cursor.ended:
            try:
                self._section()
            except FaultError as fault:
                self.findings.fault(fault)
                self._to_next_section()
        block = self._chosen(name)
        return None if block is None else block.read()

    def _chosen(self, name: str | None) -> FunctionBlock | None:
        if not self.blocks:
            if not self.findings.failed:
                self.findings.error("no-engine", "this file has no FUNCTION_BLOCK")
            return None
        names = [block.word.text for block in self.blocks]
        if name is not None and name not in names:
            self.findings.unknown("unknown-block", "the function block", TextPiece(name), names)
            return None
        selection = self.blocks[names.index(name) if name is not None else 0]
        for other in self.blocks:
            if other is not selection:
                message = f"the function block '{other.word.text}' is left out"
                self.findings.warn("several-blocks", message, other.word)
        return selection

    def _section(self) -> None:
        cursor = self.cursor
        key = cursor.key()
        if key == "FUNCTION_BLOCK":
            cursor.take()
            self.blocks.append(self._new(cursor.title(_END_OF_TITLE)))
            cursor.skip(";")
        elif key == "END_FUNCTION_BLOCK":
            cursor.take()
            cursor.skip(";")
            self._between_blocks()
        elif key in SECTIONS:
            self._inner(key)
        elif key in _OPTIONS:
            word = cursor.take()
            while not cursor.ended and not cursor.skip(_OPTIONS[key]):
                cursor.take()
            self.findings.info("dropped-options", "the options are left out", word)
        elif key == "RULE" and not self.blocks:
            message = (
                "there are rules here but no variables: VAR_INPUT, VAR_OUTPUT, FUZZIFY and "
                "DEFUZZIFY, which define the words of the rules, are not in this file"
            )
            self.findings.error("no-variables", message, cursor.word)
            cursor.at = len(cursor.words)
        else:
            text = cursor.word.text[:40]
            message = f"a section such as FUZZIFY or RULEBLOCK is expected here, not '{text}'"
            raise FaultError(message, cursor.word)

    def _between_blocks(self) -> None:
        """Skip the text between two function blocks."""
        first = self.cursor.word
        if self.cursor.ended or self.cursor.key() == "FUNCTION_BLOCK":
            return
        while not self.cursor.ended and self.cursor.key() != "FUNCTION_BLOCK":
            self.cursor.take()
        message = "the text after END_FUNCTION_BLOCK is ignored"
        self.findings.warn("trailing-text", message, first)

    def _inner(self, key: str) -> None:
        if not self.blocks:
            self.blocks.append(self._new(TextPiece("", self.cursor.word.span)))
        self.block = self.blocks[-1]
        self.cursor.take()
        if key in ("VAR_INPUT", "VAR_OUTPUT"):
            self._declarations(is_output=key == "VAR_OUTPUT")
        elif key in ("FUZZIFY", "DEFUZZIFY"):
            self._fuzzify(is_output=key == "DEFUZZIFY")
        else:
            text = self._rule_block()
            count = len(self.block.texts)
            if self.findings.room(count, MAX_VARIABLES, "rule blocks", text.word):
                self.block.texts.append(text)

    def _to_next_section(self) -> None:
        cursor = self.cursor
        cursor.at += not cursor.ended
        while not cursor.ended:
            if cursor.key() in SECTIONS or cursor.key() == "END_FUNCTION_BLOCK":
                return
            cursor.take()

    def _is_over(self, end: str) -> bool:
        """Whether a section ends here; report a missing end before the next section."""
        cursor = self.cursor
        if cursor.skip(end):
            return True
        if cursor.ended:
            raise FaultError(f"'{end}' is missing: is the file cut off?", cursor.word)
        if cursor.key() not in (*SECTIONS, *SECTION_ENDS):
            return False
        word = cursor.word
        message = f"'{end}' is missing before '{word.text}'"
        if cursor.key() not in (*SECTIONS, "END_FUNCTION_BLOCK"):
            message = f"'{word.text}' is taken for '{end}', which is missing"
            cursor.take()
        self.findings.warn("missing-end", message, word)
        return True

    # --- Variables ---

    def _declarations(self, *, is_output: bool) -> None:
        """Read from after VAR_INPUT or VAR_OUTPUT to after END_VAR."""
        cursor = self.cursor
        last: VariableDraft | None = None
        while not self._is_over("END_VAR"):
            if cursor.key() == "RANGE" and last is not None:
                self._range(last)
                continue
            word = cursor.name("a variable")
            last = self.block.variable(word, is_output=is_output)
            cursor.expect(":")
            # Many files lack the semicolon after the type, so the end of the line ends it too.
            while not cursor.ended and cursor.word.text != ";" and cursor.key() != "END_VAR":
                if cursor.word.span.line != word.span.line:
                    break
                cursor.take()
            cursor.skip(";")

    def _fuzzify(self, *, is_output: bool) -> None:
        """Read from after FUZZIFY or DEFUZZIFY to after its end."""
        cursor = self.cursor
        end = "END_DEFUZZIFY" if is_output else "END_FUZZIFY"
        draft = self._variable(is_output=is_output)
        while not self._is_over(end):
            start = cursor.at
            try:
                self._statement(draft)
            except FaultError as fault:
                self.findings.fault(fault)
                ends = cursor.key() in (end, *SECTIONS, *_STATEMENTS)
                # Consume at least one word, or the loop would never end.
                cursor.at += not ends or cursor.at == start
                cursor.to_next_statement()

    def _variable(self, *, is_output: bool) -> VariableDraft:
        word = self.cursor.name("a variable")
        draft = self.block.variables.get(word.text)
        if draft is None:
            kind = "VAR_OUTPUT" if is_output else "VAR_INPUT"
            message = f"'{word.text}' is not declared in {kind}"
            self.findings.warn("undeclared-variable", message, word)
            draft = self.block.variable(word, is_output=is_output)
        if draft.is_output != is_output:
            kind = "output" if draft.is_output else "input"
            message = f"'{word.text}' is declared as an {kind}"
            self.findings.error("wrong-section", message, word)
        return draft

    def _statement(self, draft: VariableDraft) -> None:
        cursor = self.cursor
        match cursor.key():
            case "TERM":
                cursor.take()
                word = cursor.name("a term")
                cursor.skip(":=", "=", ":")
                draft.refused.add(word.text)  # unless a function follows
                inputs = len(self.block.inputs)
                shape = read_shape(cursor, self.dialect, inputs, self.findings)
                if shape is not None:
                    draft.refused.discard(word.text)
                    self.block.term(draft, word, shape)
            case "RANGE":
                self._note_range(draft)
                self._range(draft)
            case "ENABLED":
                cursor.end_key()
                draft.enabled = cursor.take().text.upper() != "FALSE"
            case "METHOD" if draft.is_output:
                cursor.end_key()
                draft.method = cursor.name("a method")
            case "ACCU" if draft.is_output:
                cursor.end_key()
                self.block.accumulation(draft, cursor.name("a norm"))
            case "DEFAULT" if draft.is_output:
                self._default(draft)
            case "LOCK" if draft.is_output:
                self._lock(draft)
            case _:
                text = cursor.word.text[:40]
                message = f"TERM, RANGE and the like are expected here, not '{text}'"
                raise FaultError(message, cursor.word)
        if not cursor.skip(";") and cursor.word.text not in ("", ";"):
            self._after_statement()

    def _after_statement(self) -> None:
        """Report a statement that continues after its end."""
        cursor = self.cursor
        if cursor.at and cursor.word.span.line == cursor.words[cursor.at - 1].span.line:
            word = cursor.word
            if not cursor.key().startswith(("END_", "TERM", "RANGE", "METHOD")):
                raise FaultError(f"';' is expected before '{word.text[:40]}'", word)

    def _note_range(self, draft: VariableDraft) -> None:
        """Report that jFuzzyLogic knows the range of an input after its declaration only."""
        if draft.is_output or self.dialect.producer != "jfuzzylogic":
            return
        message = f"{self.dialect.program} refuses a RANGE inside FUZZIFY; it is read all the same"
        hint = "--from fuzzylite or scikit-fuzzy, whose files have it there"
        self.findings.warn("misplaced-range", message, self.cursor.word, hint)

    def _range(self, draft: VariableDraft) -> None:
        cursor = self.cursor
        cursor.end_key()
        cursor.expect("(")
        draft.low = cursor.number()
        cursor.expect("..", ",")
        draft.high = cursor.number()
        cursor.expect(")")
        draft.step = None
        if cursor.key() == "WITH":
            self.block.step(draft, cursor.take(), cursor.number())
        cursor.skip(";")

    def _default(self, draft: VariableDraft) -> None:
        cursor, word = self.cursor, self.cursor.word
        cursor.end_key()
        if cursor.skip("NC"):
            draft.no_rule = "hold"
        elif cursor.key() in ("NAN", "INF"):
            draft.no_rule = number(cursor.take().text) or math.nan
        else:
            draft.no_rule = cursor.number()
        if cursor.skip("|") and cursor.skip("NC"):
            message = "the value is held; the default counts only before the first value"
            self.findings.loss("default-with-hold", message, draft.word, slight=True)
            draft.no_rule = "hold"
        self.block.note_default(draft, word)

    def _lock(self, draft: VariableDraft) -> None:
        cursor = self.cursor
        cursor.end_key()
        while cursor.key() in ("PREVIOUS", "RANGE", "NONE", "|"):
            word = cursor.take().text.upper()
            if word == "PREVIOUS":
                draft.no_rule = "hold"
            elif word == "RANGE":
                draft.outside = "clamp"

    # --- Rule blocks ---

    def _rule_block(self) -> BlockText:
        """Read from after RULEBLOCK to after END_RULEBLOCK."""
        cursor = self.cursor
        end_of_title = _END_OF_TITLE | _BLOCK_SETTINGS
        block = BlockText(cursor.title(end_of_title, setting=True))
        cursor.skip(";")
        while not self._is_over("END_RULEBLOCK"):
            try:
                self._block_statement(block)
            except FaultError as fault:
                self.findings.fault(fault)
                cursor.at += cursor.key() not in _END_OF_RULE
                cursor.to_next_statement()
        return block

    def _block_statement(self, block: BlockText) -> None:
        cursor = self.cursor
        key = cursor.key()
        if key in ("AND", "OR", "ACT", "ACCU"):
            cursor.end_key()
            block.norms.append((key, cursor.name("a norm")))
            cursor.skip(";")
        elif key == "ENABLED":
            cursor.end_key()
            block.enabled = cursor.take().text.upper() != "FALSE"
            cursor.skip(";")
        elif key == "RULE":
            start = cursor.take()
            words = self._rule_words(start)
            if self.findings.room(len(block.rules), MAX_RULES, "rules", start):
                block.rules.append(words)
        else:
            message = f"RULE, AND and the like are expected here, not '{cursor.word.text[:40]}'"
            raise FaultError(message, cursor.word)

    def _rule_words(self, start: TextPiece) -> list[TextPiece]:
        cursor = self.cursor
        while not cursor.ended and cursor.key() not in ("IF", *_END_OF_RULE):
            cursor.take()
        words: list[TextPiece] = []
        while not cursor.ended and cursor.key() not in _END_OF_RULE:
            words.append(cursor.take())
        cursor.skip(";")
        if not words:
            raise FaultError("the rule has no IF", start)
        return _joined_numbers(words)


# --- Read FCL ---


def parse_fcl(
    text: str,
    path: str = "<text>",
    *,
    dialect: str | None = None,
    block: str | None = None,
    lossy: bool = False,
    strict: bool = False,
) -> Imported:
    """Read a function block: :func:`~fuzzyarm.exchange.formats.registry.parse` of ``.fcl``.

    The `dialect` is the producer there, ``jfuzzylogic``, ``fuzzylite`` or ``scikit-fuzzy``.

    Parameters
    ----------
    text, path, dialect, block, lossy, strict
        As there.

    Returns
    -------
    Imported
        The rule base, if there is no error, and every finding.
    """

    def read(plain: str, findings: Findings) -> tuple[RuleBase | None, Dialect]:
        record = FCL[dialect or detect(plain)]
        return _Reader(plain, record, findings).read(block), record

    return imported(text, path, read, lossy=lossy, strict=strict)
