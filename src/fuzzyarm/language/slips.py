"""Lines in the notation of other programs: how they are written here, proved by reading them.

A line with a fault is rewritten as a person would put it right (a comma for a space, a small
letter for a capital, ``if`` for ``rule if``). Where it can then be read, one finding says so
and has the line as it should be; the file is read on as it was meant.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import lru_cache

from fuzzyarm.language import controller_slips
from fuzzyarm.language.controller_slips import ADVICE, ENDINGS, Slip
from fuzzyarm.language.controllers import CONTROLLER_STATEMENTS, SIGNAL
from fuzzyarm.language.document import Document, parse_document
from fuzzyarm.language.statements import STATEMENTS
from fuzzyarm.text.diagnostic import MAX_DIAGNOSTICS, Diagnostic, Span, split_lines

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"


def _small(match: re.Match[str]) -> str:
    return match.group().lower()


_ANY_CASE = re.IGNORECASE
_CAPITALS = "words of the language are written in small letters"
_STARTERS = re.compile(rf"^(?:{'|'.join(STATEMENTS)})\b", _ANY_CASE)
_JOINS = re.compile(r"\b(?:IF|THEN|IS|AND|OR|NOT|WITH|If|Then|Is|And|Or|Not|With)\b")
_IF = re.compile(r"^(\s*)(?:(?:rule\b\s*)?\w*\s*[:.)]?\s*)??if\b", _ANY_CASE)
_RANGE = re.compile(rf"({_NUMBER})\s*(?:-(?=\s)|\bto\b|[,:]|\s)\s*({_NUMBER})")

_RULE = ("rule", "row", "header", "")
_LISTS = ("row", "header", "input", "output", "term", "lookup", "tune")
_NAMED = ("rulebase", "input", "output")
_NUMBERS = ("input", "output", "term")

_ANYWHERE = (
    Slip("quotes are straight", re.compile("[“”„«»]"), '"', whole=True),
    Slip("quotes are straight", re.compile("[‘’‚‹›]"), "'", whole=True),
    Slip(
        "a description stands in double quotes",
        re.compile(r"'([^']*)'\s*$"),
        r'"\1"',
        (*_NAMED, "controller"),
        whole=True,
    ),
    Slip("a comment starts with #", re.compile(r"(?:^|(?<=\s))(?://|%|--(?=\s|$))"), "#"),
    Slip("a minus is a hyphen", re.compile("[−–—]"), "-"),
    Slip("a range is written with two points", re.compile(r"\.{3,}|…"), ".."),
    Slip("a statement ends with its line, without a mark", re.compile(r"\s*[;,]\s*$"), ""),
)
"""In rule bases and controllers alike."""

SLIPS = (
    Slip("a rule starts with 'rule if'", _IF, r"\1rule if", _RULE),
    Slip(_CAPITALS, _STARTERS, _small),
    Slip(_CAPITALS, _JOINS, _small, ("rules", *_RULE)),
    Slip("a proposition has 'is'", re.compile(r"\s*(?<![<>=])==?(?![>=])\s*"), " is ", _RULE),
    Slip("propositions are joined by 'and'", re.compile(r"\s*&&?\s*"), " and ", ("rule",)),
    Slip("propositions are joined by 'or'", re.compile(r"\s*\|\|?\s*"), " or ", ("rule",)),
    Slip("the consequent starts with 'then'", re.compile(r"\s*[-=]>\s*"), " then ", _RULE),
    Slip("the corner of a grid has a backslash", re.compile(r"\s*/\s*"), r" \\ ", ("header",)),
    Slip("the output of a grid stands alone", re.compile(r"\bfor\b|\s*:\s*$"), "", ("rules",)),
    Slip("numbers stand without brackets", re.compile(r"[\[\](){}]"), " ", _NUMBERS),
    Slip("a colon stands behind the names", re.compile(r"\s*=\s*"), ": ", ("term", "terms")),
)
"""Every other notation, in the order in which a line of a rule base is put right."""

_LAST = Slip("a range is written with two points", _RANGE, r"\1 .. \2", ("input", "output"))
"""Looked for when commas have been put right."""

_POINT = Slip("the decimal mark is a point", re.compile(r"(?<=\d),(?=\d)"), ".")
_SPACE = Slip(
    "only spaces stand between numbers and cells", re.compile(r"\s*[,;|]\s*"), "  ", _LISTS
)
_ORDERS = ((), (_POINT,), (_SPACE,), (_POINT, _SPACE))
"""What a comma may have been meant for, as it is tried."""

_PIECES = re.compile(r"\"(?:[^\"\\]|\\.)*\"|'(?:[^'\\]|\\.)*'|#.*|[^\"'#]+|.")
_FIRST = re.compile(r"\s*([^\W\d]\w*)?")
_MOST, _ROUNDS = 100, 3
"""Lines that are tried at a time, and how often."""

_LONGEST, _FARTHEST = 500, 400
"""Characters of a line, and how far above it its statement starts: beyond that it is not tried."""


def as_meant(text: str, document: Document) -> tuple[Document, frozenset[int]]:
    """Return `document` with one finding for each line that can be put right, and those lines.

    The statements of the result are those that were meant.
    """
    lines = split_lines(text)
    meant, best = list(lines), document
    if len(document.diagnostics) > MAX_DIAGNOSTICS:
        return document, frozenset()
    found: dict[int, Diagnostic] = {}
    # A header that is put right may show that its rows are to be put right too.
    for _ in range(_ROUNDS):
        first: dict[int, Diagnostic] = {}
        for diagnostic in best.diagnostics:
            first.setdefault(diagnostic.line, diagnostic)
        more = {}
        for number in sorted(first)[:_MOST]:
            put_right = None if number > len(lines) else _put_right(meant, number, first[number])
            if put_right is not None:
                meant[number - 1], said = put_right
                more[number] = _finding(first[number], lines[number - 1], meant[number - 1], said)
        if not more:
            break
        again = parse_document("\n".join(meant))
        if any(d.line in found or d.line in more for d in again.diagnostics):
            break  # what reads well alone does not read in its file
        best, found = again, found | more
    advised = [_advised(each, lines) for each in best.diagnostics]
    ordered = sorted([*advised, *found.values()], key=lambda diagnostic: diagnostic.span)
    return best._replace(diagnostics=tuple(ordered)), frozenset(found)


def _finding(first: Diagnostic, before: str, after: str, said: str) -> Diagnostic:
    """Return what is said of a line: its span and replacement are what differs."""
    start = 0
    while start < min(len(before), len(after)) and before[start] == after[start]:
        start += 1
    end = 0
    while end < min(len(before), len(after)) - start and before[-1 - end] == after[-1 - end]:
        end += 1
    span = Span(first.line, start + 1, first.line, len(before) - end + 1)
    hint = f"write  {' '.join(after.split())}" if after.strip() else "leave the line out"
    return Diagnostic(
        first.name, said, span, hint=hint, replacement=after[start : len(after) - end]
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
    for order in _ORDERS:
        better, said = _rewritten(line, word, order, controller)
        if said and better.strip() and reads(better):
            return better, said
    return None


def _surroundings(lines: Sequence[str], number: int) -> tuple[list[str], str, list[str]]:
    """Return the lines before that a line is read with, what it is itself, and those behind."""
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

_HEADINGS = re.compile(r"^(controller|rulebase)\b", _ANY_CASE)
_AXIS = re.compile(r"^ax[ei]s\b", _ANY_CASE)
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
    first = re.match(r"\s*([\w-]+)", line)
    word = first[1].lower() if first is not None else ""
    if word not in CONTROLLER_STATEMENTS or (below_axis and _SIGNAL.match(line)):
        word = SIGNAL if below_axis else ""
    return ["controller c", *(["axis a"] if below_axis else [])], word, []


_SYNTAX = {
    "unexpected-token", "trailing-text", "incomplete-statement", "unexpected-character",
    "reserved-word", "unknown-option", "unknown-statement", "bad-number",
}  # fmt: skip
"""Findings of which the words of an advice say more."""


def _advised(found: Diagnostic, lines: Sequence[str]) -> Diagnostic:
    """Return a finding with what to do, where the line alone cannot be put right."""
    number = found.line
    if not 1 <= number <= len(lines) or not _controller_above(lines, number):
        return found
    line = lines[number - 1].partition("#")[0].rstrip()
    mended = found.replacement is not None and found.name != "reserved-word"
    if len(line) > _LONGEST or mended or found.name not in _SYNTAX:
        return found
    _, word, _ = _of_controller(lines, number)
    for advice in ADVICE:
        told = advice.on(line, number) if not advice.words or word in advice.words else None
        if told is not None:
            said, hint, span = told
            return Diagnostic(found.name, said, span, hint=hint)
    return found


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
    said: dict[str, None] = {}
    own = (*controller_slips.SLIPS, *order) if controller else (*SLIPS, *order, _LAST)
    for slip in (*_ANYWHERE, *own):
        if slip.words and word not in slip.words:
            continue
        if slip.whole:
            line = _apply(slip, line, said)
            continue
        pieces = list(_pieces(line))
        line = "".join(_apply(slip, piece, said) if code else piece for piece, code in pieces)
    return line.rstrip(), "; ".join(said)


def _pieces(line: str) -> Iterator[tuple[str, bool]]:
    for match in _PIECES.finditer(line):
        yield match.group(), match.group()[0] not in "\"'#"


def _apply(slip: Slip, text: str, said: dict[str, None]) -> str:
    changed = slip.pattern.sub(slip.written, text)
    if changed != text:
        said[slip.said] = None
    return changed
