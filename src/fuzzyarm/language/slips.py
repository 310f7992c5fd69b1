"""Lines in the notation of other programs: how they are written here, proved by reading them.

A line with a fault is rewritten as a person would put it right (a comma for a space, a small
letter for a capital, ``if`` for ``rule if``). Where it can then be read, one finding says so
and has the line as it should be; the file is read on as it was meant.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import lru_cache

from fuzzyarm.base.diagnostic import MAX_DIAGNOSTICS, Diagnostic, Span, split_lines
from fuzzyarm.language import controller_slips, rulebase_slips
from fuzzyarm.language.controller_slips import ENDINGS
from fuzzyarm.language.controllers import CONTROLLER_STATEMENTS, SIGNAL
from fuzzyarm.language.document import Document, parse_document
from fuzzyarm.language.notations import ANY_CASE, Slip
from fuzzyarm.language.rulebase_slips import ANYWHERE, LAST, ORDERS
from fuzzyarm.language.statements import STATEMENTS

_PIECES = re.compile(r"\"(?:[^\"\\]|\\.)*\"|'(?:[^'\\]|\\.)*'|#.*|[^\"'#]+|.")
_FIRST = re.compile(r"\s*([^\W\d]\w*)?")
_MOST, _ROUNDS = 100, 3
"""Lines that are tried at a time, and how often."""

_LONGEST, _FARTHEST = 500, 400
"""Characters of a line, and how far above it its statement starts: beyond that it is not tried."""


def as_meant(text: str, document: Document) -> tuple[Document, frozenset[int]]:
    """Return `document` with one finding for each line that can be corrected, and those lines.

    The statements of the result are those that were meant.
    """
    lines = split_lines(text)
    repaired, best = list(lines), document
    if len(document.diagnostics) > MAX_DIAGNOSTICS:
        return document, frozenset()
    diagnostics: dict[int, Diagnostic] = {}
    # A corrected header may show that its rows need correction too.
    for _ in range(_ROUNDS):
        first: dict[int, Diagnostic] = {}
        for diagnostic in best.diagnostics:
            first.setdefault(diagnostic.line, diagnostic)
        more = {}
        for number in sorted(first)[:_MOST]:
            put_right = None if number > len(lines) else _put_right(repaired, number, first[number])
            if put_right is not None:
                repaired[number - 1], message = put_right
                more[number] = _finding(
                    first[number], lines[number - 1], repaired[number - 1], message
                )
        if not more:
            break
        again = parse_document("\n".join(repaired))
        if any(d.line in diagnostics or d.line in more for d in again.diagnostics):
            break  # what reads well alone does not read in its file
        best, diagnostics = again, diagnostics | more
    advised = [_advised(finding, lines) for finding in best.diagnostics]
    ordered = sorted([*advised, *diagnostics.values()], key=lambda diagnostic: diagnostic.span)
    return best._replace(diagnostics=tuple(ordered)), frozenset(diagnostics)


# --- Files of other programs ---

_FOREIGN = {
    "FCL": (
        ".fcl",
        r"^\s*(?:(?:END_)?FUNCTION_BLOCK|VAR_(?:INPUT|OUTPUT)|(?:DE)?FUZZIFY|RULEBLOCK)\b",
    ),
    "a FIS of MATLAB": (".fis", r"^\[(?:System|Input\d+|Output\d+|Rules)\]"),
    "FLL": (".fll", r"^\s*(?:Engine|InputVariable|OutputVariable|RuleBlock):"),
    "FML": (".fml", r"<(?:\?xml|fuzzySystem|FuzzyController|knowledgeBase|KnowledgeBase)\b"),
    "Structured Text": ("", r"^\s*(?:PROGRAM|VAR|END_VAR|END_IF|END_PROGRAM)\b"),
    "a program in Python": (".py", r"^(?:import|from)\s+\w+(?:\.\w+)*\s*(?:as|import|$)"),
}
"""Texts of other languages: their suffix, and how their lines begin."""


def foreign_text(text: str) -> Diagnostic | None:
    """Return the message about a text of another program; None for any other text."""
    for what, (suffix, pattern) in _FOREIGN.items():
        match = re.search(pattern, text[:100_000], re.MULTILINE)
        if match is None:
            continue
        line = text.count("\n", 0, match.start() + len(match[0]) - len(match[0].lstrip())) + 1
        hint = "a .frb file begins with  rulebase NAME  or  controller NAME"
        if suffix:
            hint = f"call it FILE{suffix}, and  fuzzyarm convert FILE{suffix} FILE.frb"
        message = f"this is {what}, not the language of .frb files"
        return Diagnostic("foreign-text", message, Span(line, 1, line, 2), hint=hint)
    return None


def _finding(first: Diagnostic, before: str, after: str, words: str) -> Diagnostic:
    """Return the finding about a line; its span and replacement cover only what differs."""
    start = 0
    while start < min(len(before), len(after)) and before[start] == after[start]:
        start += 1
    end = 0
    while end < min(len(before), len(after)) - start and before[-1 - end] == after[-1 - end]:
        end += 1
    span = Span(first.line, start + 1, first.line, len(before) - end + 1)
    hint = f"write  {' '.join(after.split())}" if after.strip() else "leave the line out"
    return Diagnostic(
        first.name, words, span, hint=hint, replacement=after[start : len(after) - end]
    )


def _put_right(lines: Sequence[str], number: int, first: Diagnostic) -> tuple[str, str] | None:
    """Return a line as it can be read, and what was wrong with it.

    None where it cannot, or where the finding itself has all that is to be changed.
    """
    line = lines[number - 1]
    if len(line) > _LONGEST:
        return None
    controller = _controller_above(lines, number)
    if controller and ENDINGS.match(line):
        return "", "nothing ends a part of a file"
    before, word, after = (_of_controller if controller else _surroundings)(lines, number)

    def reads(better: str) -> bool:
        document = parse_document("\n".join([*before, better, *after]))
        return all(d.line != len(before) + 1 for d in document.diagnostics)

    if first.replacement is not None and first.span.end_line == number:
        start, end = first.span.column - 1, first.span.end_column - 1
        if reads(line[:start] + first.replacement + line[end:]):
            return None
    for order in ORDERS:
        better, text = _rewritten(line, word, order, controller)
        if text and better.strip() and reads(better):
            return better, text
    return None


def _surroundings(lines: Sequence[str], number: int) -> tuple[list[str], str, list[str]]:
    """Return the lines before that a line is read with, what it is itself, and those after."""
    start = number
    while start > max(1, number - _FARTHEST) and _keyword(lines[start - 1]) is None:
        start -= 1
    word = _keyword(lines[start - 1])
    if word is None:
        return [], "", []
    end = number
    if start < number and STATEMENTS[word].takes_lines:
        between = [line for line in lines[start : number - 1] if _code(line)]
        if word in ("lookup", "tune"):
            return [lines[start - 1]], word, []
        return [lines[start - 1], *between[:1]], "row" if between else "header", []
    if start < number and not lines[number - 1][:1].isspace():
        return [], "", []
    while (
        end < min(len(lines), number + _FARTHEST)
        and _keyword(lines[end]) is None
        and lines[end][:1].isspace()
    ):
        end += 1
    return list(lines[start - 1 : number - 1]), word, list(lines[number:end])


# --- Controllers ---

_HEADINGS = re.compile(r"^(controller|rulebase)\b", ANY_CASE)
_AXIS = re.compile(r"^ax[ei]s\b", ANY_CASE)
_SIGNAL = re.compile(r"^\s*(?:'[^']*'|[\w-]+)\s*(?:[,=]|:=|<-)")


def _controller_above(lines: Sequence[str], number: int) -> bool:
    """Whether a line is the heading of a controller, or stands below one."""
    for line in reversed(lines[:number]):
        heading = _HEADINGS.match(line)
        if heading is not None:
            return heading[1].lower() == "controller"
    return False


def _of_controller(lines: Sequence[str], number: int) -> tuple[list[str], str, list[str]]:
    """Return the lines before that a line of a controller is read with, and what it is."""
    line = lines[number - 1]
    if _HEADINGS.match(line):
        return [], "controller", []
    below_axis = False
    for other in reversed(lines[: number - 1]):
        if _HEADINGS.match(other):
            break
        below_axis |= _AXIS.match(other) is not None
    word = _first_word(line)
    if not word or (below_axis and _SIGNAL.match(line)):
        word = SIGNAL if below_axis else ""
    return ["controller c", *(["axis a"] if below_axis else [])], word, []


_SYNTAX = {
    "unexpected-token", "trailing-text", "incomplete-statement", "unexpected-character",
    "reserved-word", "unknown-hedge", "unknown-setting", "unknown-option", "unknown-statement",
    "bad-number",
}  # fmt: skip
"""Findings of which the words of an advice say more."""


def _first_word(line: str) -> str:
    """Return the statement of a controller that a line starts, also in capitals."""
    first = re.match(r"\s*([\w-]+)", line)
    word = first[1].lower() if first is not None else ""
    return word if word in CONTROLLER_STATEMENTS else ""


def _advised(finding: Diagnostic, lines: Sequence[str]) -> Diagnostic:
    """Return a finding with a hint, for a line that cannot be corrected automatically."""
    number = finding.line
    if not 1 <= number <= len(lines):
        return finding
    line = lines[number - 1].partition("#")[0].rstrip()
    mended = finding.replacement is not None and finding.name != "reserved-word"
    if len(line) > _LONGEST or mended or finding.name not in _SYNTAX:
        return finding
    controller = _controller_above(lines, number)
    _, word, _ = (_of_controller if controller else _surroundings)(lines, number)
    for advice in (controller_slips if controller else rulebase_slips).ADVICE:
        reading = advice.on(line, number) if not advice.words or word in advice.words else None
        if reading is not None:
            message, hint, span = reading
            return Diagnostic(finding.name, message, span, hint=hint)
    return finding


def _keyword(line: str) -> str | None:
    """Return the statement that a line starts, also in capitals."""
    word = (_FIRST.match(line) or [""])[1]
    small = (word or "").casefold()
    return small if small in STATEMENTS and not line[:1].isspace() else None


def _code(line: str) -> str:
    return line.partition("#")[0].strip()


@lru_cache(maxsize=2048)
def _rewritten(line: str, word: str, order: tuple[Slip, ...], controller: bool) -> tuple[str, str]:
    # Remembered: a text is read again at every key stroke, and most of its lines are as before.
    messages: dict[str, None] = {}
    slips = (*controller_slips.SLIPS, *order)
    if not controller:
        slips = (*rulebase_slips.SLIPS, *order, LAST)
    for slip in (*ANYWHERE, *slips):
        if slip.words and word not in slip.words:
            continue
        if slip.whole:
            line = _apply(slip, line, messages)
        else:
            pieces = list(_pieces(line))
            line = "".join(
                _apply(slip, piece, messages) if code else piece for piece, code in pieces
            )
        # A line that began with a word of elsewhere may be a statement now.
        if not word and messages:
            word = (_first_word(line) if controller else _keyword(line)) or ""
    return line.rstrip(), "; ".join(messages)


def _pieces(line: str) -> Iterator[tuple[str, bool]]:
    for match in _PIECES.finditer(line):
        yield match.group(), match.group()[0] not in "\"'#"


def _apply(slip: Slip, text: str, corrections: dict[str, None]) -> str:
    changed = slip.pattern.sub(slip.written, text)
    if changed != text:
        corrections[slip.message] = None
    return changed
