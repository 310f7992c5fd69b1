"""Lines in the style of MATLAB, FCL, FLL, Structured Text or Python, as typed by a newcomer.

:data:`CORRECTIONS` rewrite a faulty line. If the result is readable, one finding shows it, and
reading continues with it. :data:`EXAMPLES` are wrong lines without a correction: a line on which
the parser stops in the state of an example gets its sentence.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import cache, lru_cache
from typing import NamedTuple

from fuzzyarm.base.diagnostic import MAX_DIAGNOSTICS, Diagnostic, Span, split_lines
from fuzzyarm.base.names import near_hint
from fuzzyarm.language.controllers import CONTROLLER_STATEMENTS, SIGNAL
from fuzzyarm.language.document import HEADINGS, Document, parse_document
from fuzzyarm.language.statements import STATEMENTS
from fuzzyarm.language.tokens import Token, tokenize_line
from fuzzyarm.symbolic.kinds import SHAPES
from fuzzyarm.symbolic.sources import SOURCES

# --- Corrections ---

_N = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?"
_NAME = r"(?:'[^']*'|[^\W\d]\w*(?:-[^\W\d]\w*)*)"
_SOURCE_OF = {word: word for word, kind in SOURCES.items() if kind.of in ("port", "signal")} | {
    word: kind.name for kind in SOURCES.values() for word in kind.elsewhere.split()
}
_TAKEN = "|".join(sorted(_SOURCE_OF, key=len, reverse=True))
_SOURCE = "|".join(rf"{k.name}\s*{k.joined}\s+{_NAME}(?:\([^()]*\))?" for k in SOURCES.values())
_OPTIONS = "|".join({word for kind in SOURCES.values() for word in kind.options} | {"slew"})
_FUNCTIONS = "abs|atan2?|cl[ai]m?p|cos|exp|floor|limit|log|max|min|pow|round|sat|saturate|sin|sqrt"


class Correction(NamedTuple):
    """A mistake in a line of `statements`, or of any statement, and its correction.

    ``row`` and ``header`` are the lines of a grid, ``-`` is a line that starts like no statement.
    Strings and comments are left out of the match unless it is of the `whole` line.
    """

    sentence: str
    statements: str
    pattern: str
    written: str | Callable[[re.Match[str]], str]
    whole: bool = False


def _listed(text: str) -> str:
    return ", ".join(re.split(r"[\s,;]+", text.strip()))


def _source(match: re.Match[str]) -> str:
    word = _SOURCE_OF[match[1].lower()]
    return f"{word}{SOURCES[word].joined} {match[2] or match[3]}"


_SHAPE_OF = {1: "singleton", 3: "triangle", 4: "trapezoid"}


def _with_shape(match: re.Match[str]) -> str:
    """Return a term with the shape that takes as many numbers as it has."""
    shape = _SHAPE_OF.get(len(re.findall(_N, match[2])))
    return match[0] if shape is None else f"{match[1]}: {shape} {match[2]}"


_STARTERS = {*STATEMENTS, *CONTROLLER_STATEMENTS}
_SMALL = "words of the language are written in small letters"
_DOTS = "a range is written with two points"

CORRECTIONS = tuple(Correction(*row) for row in (
    ("quotes are straight", "", "[“”„«»]", '"', True),
    ("write a description in double quotes", "rulebase controller input output",
     r"['‘’‚‹›]([^'‘’‚‹›]*)['‘’‚‹›]\s*$", r'"\1"', True),
    ("a comment starts with #", "",
     r"(?:^|(?<=\s))(?://|%|/\*|\(\*|--(?=\s|$))\s*(.*?)\s*(?:\*\)|\*/)?\s*$", r"# \1"),
    (_SMALL, "", r"^\s*[A-Z][A-Za-z]*(?=\s+[\w'\"])",
     lambda m: m[0].lower() if m[0].strip().lower() in _STARTERS else m[0]),
    ("a minus is a hyphen", "", "[−–—]", "-"),
    (_DOTS, "", r"\.{3,}|…", ".."),
    ("a statement ends with its line, without a mark", "", r"\s*[;,]\s*$", ""),
    ("write the range after the name", "input output",
     rf"^(\s*\w+\s+{_NAME})\s*(?::=|[:=]|\b(?:in|range)\b)[\s:=]*", r"\1 "),
    ("write the shape of a term before its numbers", "term",
     rf"^(\s*term\s+{_NAME}\s+{_NAME})\s*[:=]\s*((?:{_N}[\s,]+){{0,3}}{_N})\s*$", _with_shape),
    ("a shape has its name of here", "term", rf"({_NAME})(?=\s*[-+.\d\[(])",
     lambda m: (m[1] not in SHAPES and near_hint(m[1], SHAPES)[1]) or m[1]),
    ("write a colon after the name of a term", "term",
     rf"^(\s*term\s+{_NAME}\s+{_NAME})\s*(?::?=\s*|\s)(?={_NAME}\s*[-+.\d\[(])", r"\1: "),
    ("write numbers without brackets", "input output term", r"[\[\](){}]", " "),
    ("write a weight after with", "rule",
     rf"\s*(?:\(\s*({_N})\s*\)|\bweight\s*=?\s*({_N}))\s*$", lambda m: f" with {m[1] or m[2]}"),
    ("write 'not' after 'is'", "rule", rf"\bnot\s+({_NAME})\s+is\s+", r"\1 is not "),
    ("a cell without a rule is a dot", "row", r"(?<=\s)-+(?=\s|$)", "."),
    ("write the output of a grid by itself", "rules", r"\bfor\b|\s*[:=]\s*$", ""),
    ("a setting is a word and its value", "inference block", r"\s*[=:]\s*", " "),
    (_SMALL, "inference block", r"\b[A-Z]+\b", lambda m: m[0].lower()),
    ("write '->' after the inputs", "expect", r"\s*(?:=>|→|\bthen\b)\s*", " -> "),
    ("a rule starts with 'rule if'", "rule row header -",
     r"(?i)^(\s*)(?:(?:rule\b\s*)?\w*\s*[:.)]?\s*)??if\b", r"\1rule if"),
    (_SMALL, "rules rule row header", r"\b(?i:if|then|is|and|or|not|with)\b",
     lambda m: m[0].lower()),
    ("a proposition has 'is'", "rules rule row header", r"\s*(?<![<>=])==?(?![>=])\s*", " is "),
    ("propositions are joined by 'and'", "rule signal", r"\s*&&?\s*", " and "),
    ("propositions are joined by 'or'", "rule signal", r"\s*\|\|?\s*", " or "),
    ("the consequent starts with 'then'", "rule row", r"\s*[-=]>\s*", " then "),
    ("how often it runs is its period", "period -",
     rf"(?i)^\s*(?:period\s*[:=]|(?:dt|Ts|sampl(?:e|ing)[ _]?time)\s*[:=]?)\s*({_N})\s*(\w*)\s*$",
     lambda m: f"period {m[1]} {m[2] or 's'}"),
    ("a file is used under a name", "use -",
     r'^\s*(?:use|import)\s+"((?:[^"/\\]*[/\\])*([^\W\d]\w*)[^"/\\]*)"(?:\s+as\s+(\w+))?\s*$',
     lambda m: f'use {m[3] or m[2]} from "{m[1]}"', True),
    ("a definition has '='", "gain signal drive", r"\s*(?::=|==|<-)\s*", " = "),
    ("write '=' between a name and its value", "gain",
     rf"^(\s*gain\s+{_NAME})\s*[:\s]\s*(?=[-+.\d\[])", r"\1 = "),
    ("one value for each axis, with commas between them", "gain",
     r"\[\s*([^\]]*?)\s*\]", lambda m: _listed(m[1])),
    ("write a comma before the range of tuning", "gain", r"(?<!,)\s+(?=tune\s+[-+.\d])", ", "),
    ("a choice is written  A where CONDITION else B", "signal",
     rf"(=\s*)({_NAME}|{_N})\s+if\s+(.+?)\s+else\b", r"\1\2 where \3 else"),
    ("a choice is written  A where CONDITION else B", "signal",
     rf"(=\s*)([^=?,][^?,]*?)\s*\?\s*({_NAME}|{_N})\s*:\s*(?={_NAME}|{_N})",
     r"\1\3 where \2 else "),
    ("limits are called within", "signal drive",
     r"(,?)\s*\b(?:limits?|saturat\w*|clamp\w*)\b(?=\s*[\[(+\d.-])", r"\1 within"),
    ("write a comma before an option", "signal drive",
     rf"(?<=[\w')])\s+(?=(?:{_OPTIONS})\b)", ", "),
    (_DOTS, "signal drive", rf"(\bwithin)\s*[\[(]?\s*({_N})\s*(?:\.\.|to\b|[,:]|\s)\s*({_N})[\])]?",
     r"\1 \2 .. \3"),
    ("an error is named by its port", "signal",
     rf"\breference\s+({_NAME})\s*-\s*measured\s+\1(?![\w-])", r"error of \1"),
    ("the change per second is a rate", "signal",
     rf"\bd\s*/\s*dt\s*(?:\(\s*({_NAME})\s*\)|({_NAME}))", lambda m: f"rate of {m[1] or m[2]}"),
    ("evaluate a rule base by  rules", "signal",
     rf"\bevalfis\s*\(\s*(?:({_NAME})\s*,\s*\[([^\])]*)\]|\[([^\])]*)\]\s*,\s*({_NAME}))\s*\)",
     lambda m: f"rules {m[1] or m[4]}({_listed(m[2] or m[3])})"),
    ("evaluate a rule base by  rules, a table by  table", "signal",
     rf"(?i)(=\s*)(?!(?:rules|table|evalfis|{_FUNCTIONS}|{_TAKEN})\b)({_NAME})\s*\((?=[^()]*\))",
     r"\1rules \2("),
    ("a source is written  WORD of NAME", "signal",
     rf"(?i)\b({_TAKEN})\b(?:\s+(?:of|in)\b)?\s*(?:\(\s*({_NAME})\s*\)|\s({_NAME}))(?!\s*[(\w])",
     _source),
    ("write the source first, then its factors", "signal",
     rf"(=\s*)([^=,]*?)\s*\*\s*({_SOURCE})((?:\s*[*/][^,+-]*)?)(?=,|$)", r"\1\3\4 * \2"),
    ("a power is written as a product", "signal", rf"(/\s*)?({_NAME})\s*(?:\^|\*\*)\s*([23])\b",
     lambda m: (m[1] or "") + (" / " if m[1] else " * ").join([m[2]] * int(m[3]))),
    ("write the port of a drive first", "drive",
     rf"^(\s*)drive\s+([^=]+?)\s+to\s+({_NAME})\s*(?=,|$)", r"\1drive \3 = \2"),
    ("signals to the plant are drives", "signal",
     rf"(?i)^(\s*)(?:drive|output)\s+(?={_NAME}\s*=)", r"\1drive "),
))  # fmt: skip
"""In the order in which they are applied to a line."""

_LAST = Correction(
    _DOTS, "input output", rf"({_N})\s*(?:-(?=\s)|to\b|[,:]|\s)\s*({_N})", r"\1 .. \2"
)
_POINT = Correction("the decimal mark is a point", "", r"(?<=\d),(?=\d)", ".")
_SPACE = Correction(
    "separate numbers and cells by spaces only",
    "row header input output term",
    r"\s*[,;|]\s*",
    "  ",
)
_COMMAS = ((), (_POINT,), (_SPACE,), (_POINT, _SPACE))
"""Meanings of a comma, in the order of trial."""

# --- Lines that need more ---

EXAMPLES = {
    "a rule has no else: write a second rule, as in  rule if x is not A then y is C": (
        "rule if x is A then y is B else y is C",),
    "a rule tests terms, not numbers, as in  term x BEYOND: ramp 30 40": (
        "rule if x > 3 then y is B", "rule if x < 3 then y is B", "rule if x >= 3 then y is B"),
    "a term belongs to a variable, as in  term x LOW: triangle 0 2 5": (
        "term LOW: triangle 0 2 5", "term LOW = triangle 0 2 5"),
    "a term is a shape and its numbers, as in  term x LOW: triangle 0 2 5": (
        "term x LOW: 0 2", "term x LOW: 0 2 5 6 7"),
    "a controller has neither rules nor 'if': write  u = a where e > 3 else b , or a rule base, and"
    "  u = rules NAME(e, ce)": (
        "  if e > 3 then u = 0", "  if e is A then u is B", "  rule if e is A then u is B"),
    "a line has one source, first, of a signal: write  x = error of position  above, and x here": (
        "  x = rate of error of p", "  x = lag of measured p, time 1 s", "  x = error of p * 2 + e",
        "  x = integral of (e * 2)"),
    "a drive is a sum of signals: write  u = rules NAME(e, ce)  above, and u here": (
        "  drive p = rules f(e)",),
    "a sum has no parentheses: write  x = e + ce  above, and x here": (
        "  x = (e + 2) * 2", "  x = 2 * (e + 2)"),
    "the inputs of a rule base are signals in its order, as in  u = rules NAME(e, ce)": (
        "  x = rules f(e=e)", "  x = rules f(e * 2)", "  x = rules f * 2", "  x = evalfis(f, e)"),
    "a controller has a name: write  controller NAME": ('controller "x"',),
    "a controller has no functions: write limits after a drive, as in  drive PORT = u, within "
    "-1 .. 1 , and a curve of one signal as a rule base,  y = rules NAME(x)": (
        "  x = abs(e)", "  x = max(-2, u)", "  x = rules clip(u, -1, 1)"),
    "a gain is made of numbers and pi: compute it on a line of an axis": (
        "gain k = 2 * g", "gain k = g * 2", "gain k = g", "gain k = 2 * (3)"),
    'a unit is written in double quotes, as in  gain k = 4.5 "V"': (
        "gain k = 4.5 V", "gain k = 16 1/s"),
}  # fmt: skip
"""By sentence, up to a colon or a comma, and hint; a name or a number matches any."""

State = tuple[str, ...]


def _state(lines: Sequence[str], finding: Diagnostic) -> State:
    """Return where the parser stopped: statement, finding, expectation, three tokens around it."""
    tokens = tokenize_line(finding.line, lines[finding.line - 1], []).tokens
    at = next((k for k, token in enumerate(tokens) if token.end > finding.column), len(tokens))
    around = (_kind(tokens[k]) if 0 <= k < len(tokens) else "" for k in (at - 1, at, at + 1))
    expected = re.sub(r"'[^']*'", "", finding.message.partition(", found")[0])
    return _surroundings(lines, finding.line)[1], finding.name, expected, *around


def _kind(token: Token) -> str:
    if token.kind == "name" and token.text in SOURCES:
        return "call" if SOURCES[token.text].of == "call" else "source"
    return token.text if token.kind == "mark" or token.text in _KEPT else token.kind


_KEPT = {"of", "if", "rule", "else", "evalfis"}


@cache
def _sentences() -> dict[State, tuple[str, str]]:
    """Return sentence and hint of each state in which the parser stops on an example."""
    sentences: dict[State, tuple[str, str]] = {}
    for text, examples in EXAMPLES.items():
        sentence, hint = re.split(r"[:,] +(?=as in|write|compute)", text, maxsplit=1)
        for line in examples:
            below = line[0] == " " or line.startswith("gain")
            lines = ["controller c", "axis a", line] if below else [line]
            findings = parse_document("\n".join(lines)).diagnostics
            sentences.setdefault(_state(lines, findings[0]), (sentence, hint))
    return sentences


# --- Corrected reading ---

_MOST, _ROUNDS, _LONGEST, _FARTHEST = 100, 3, 500, 400
"""Limits: lines tried at a time, rounds, characters, and lines above them."""


def corrected_document(text: str, document: Document) -> tuple[Document, frozenset[int]]:
    """Return `document` with one finding for each line that can be corrected, and those lines.

    The statements of the result are the corrected ones.
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
        for number in [number for number in sorted(first) if number <= len(lines)][:_MOST]:
            put_right = _readable_line(repaired, number, first[number])
            if put_right is not None:
                more[number] = _finding(first[number], lines[number - 1], *put_right)
                repaired[number - 1] = put_right[0]
        again = parse_document("\n".join(repaired))
        if not more or any(d.line in diagnostics or d.line in more for d in again.diagnostics):
            break  # a line that reads alone may not read in its file
        best, diagnostics = again, diagnostics | more
    said = [_explained(finding, lines) for finding in best.diagnostics]
    ordered = sorted([*said, *diagnostics.values()], key=lambda diagnostic: diagnostic.span)
    # A line like an example means something else: the parser misread its names.
    misread = {new.line for new, old in zip(said, best.diagnostics, strict=True) if new is not old}
    statements = tuple(
        statement._replace(names=()) if statement.node.span.line in misread else statement
        for statement in best.statements
    )
    best = best._replace(statements=statements, diagnostics=tuple(ordered))
    return best, frozenset(diagnostics)


def _explained(finding: Diagnostic, lines: Sequence[str]) -> Diagnostic:
    """Return a finding with the sentence of the matching example."""
    mended = finding.replacement is not None and finding.name != "reserved-word"
    if mended or not 1 <= finding.line <= len(lines) or len(lines[finding.line - 1]) > _LONGEST:
        return finding
    sentence, hint = _sentences().get(_state(lines, finding), ("", ""))
    return finding if not sentence else Diagnostic(finding.name, sentence, finding.span, hint=hint)


def _finding(first: Diagnostic, before: str, after: str, words: str) -> Diagnostic:
    """Return the finding about a line; span and replacement cover only the difference."""
    start = _common(before, after)
    end = _common(before[start:][::-1], after[start:][::-1])
    span = Span(first.line, start + 1, first.line, len(before) - end + 1)
    hint = f"write  {' '.join(after.split())}" if after.strip() else "leave the line out"
    replacement = after[start : len(after) - end]
    return Diagnostic(first.name, words, span, hint=hint, replacement=replacement)


def _common(one: str, other: str) -> int:
    """Return the length of the common start of two texts."""
    pairs = enumerate(zip(one, other, strict=False))
    return next((k for k, (a, b) in pairs if a != b), min(len(one), len(other)))


_ENDING = re.compile(r"(?i)^\s*(?:end\w*|[{}]+)\s*[;.]?\s*$")


def _readable_line(lines: Sequence[str], number: int, first: Diagnostic) -> tuple[str, str] | None:
    """Return a readable form of a line, and its mistake; None if there is no fault to fix."""
    line = lines[number - 1]
    if len(line) > _LONGEST:
        return None
    if _ENDING.match(line):
        return "", "parts of a file need no end"
    before, word, after = _surroundings(lines, number)

    def reads(better: str) -> bool:
        document = parse_document("\n".join([*before, better, *after]))
        return all(d.line != len(before) + 1 for d in document.diagnostics)

    if first.replacement is not None and first.span.end_line == number:
        start, end = first.span.column - 1, first.span.end_column - 1
        if reads(line[:start] + first.replacement + line[end:]):
            return None
    for commas in _COMMAS:
        better, sentence = _rewritten(line, word, commas)
        if sentence and better.strip() and reads(better):
            return better, sentence
    return None


def _surroundings(lines: Sequence[str], number: int) -> tuple[list[str], str, list[str]]:
    """Return the lines before a line, its statement, and the lines after."""
    line, above = lines[number - 1], lines[: number - 1][::-1]
    own = _word(line)
    heading = next((k for k, other in enumerate(above) if _word(other) in HEADINGS), None)
    if own == "controller" or (heading is not None and _word(above[heading]) == "controller"):
        below = own != "controller" and any(_word(other) == "axis" for other in above[:heading])
        if own not in CONTROLLER_STATEMENTS or own == SIGNAL:
            own = SIGNAL if below else "-"
        return [] if own in HEADINGS else ["controller c", *["axis a"] * below], own, []
    if own in STATEMENTS and not line[:1].isspace():
        start, word = 0, own
    else:
        near = enumerate(above[:_FARTHEST], start=1)
        start = next((k for k, other in near if _starts(other)), 0)
        word = _word(above[start - 1]) if start else "-"
    between = list(lines[number - 1 - start : number - 1])
    if start and STATEMENTS[word].takes_lines:
        rows = [other for other in between[1:] if other.partition("#")[0].strip()]
        kind = {True: "row", False: "header"}[bool(rows)] if word == "rules" else word
        return [between[0], *rows[:1] * (word == "rules")], kind, []
    if start and not line[:1].isspace():
        return [], "-", []
    end = number
    while end < min(len(lines), number + _FARTHEST) and lines[end][:1].isspace():
        end += 1
    return between, word, list(lines[number:end]) if word != "-" else []


@lru_cache(maxsize=8192)
def _word(line: str) -> str:
    """Return the first word of a line in small letters."""
    match = re.match(r"\s*([^\W\d][\w-]*)", line)
    return match[1].lower() if match is not None else ""


def _starts(line: str) -> bool:
    return not line[:1].isspace() and _word(line) in STATEMENTS


@lru_cache(maxsize=2048)
def _rewritten(line: str, word: str, commas: tuple[Correction, ...]) -> tuple[str, str]:
    # Kept: a text is read again at every key stroke, and most of its lines are as before.
    sentences: dict[str, None] = {}
    for correction in (*CORRECTIONS, *commas, _LAST):
        if correction.statements and word not in correction.statements.split():
            continue
        pieces = [line] if correction.whole else _PIECES.findall(line)
        better = "".join(
            piece
            if piece[:1] in ("'", '"', "#") and not correction.whole
            else re.sub(correction.pattern, correction.written, piece)
            for piece in pieces
        )
        if better != line:
            sentences[correction.sentence] = None
            line, word = better, (_word(better) if word == "-" else word) or "-"
    return line.rstrip(), "; ".join(sentences)


_PIECES = re.compile(r"\"(?:[^\"\\]|\\.)*\"|'(?:[^'\\]|\\.)*'|#.*|[^\"'#]+|.")

# --- Files of other programs ---

_FOREIGN = {
    "FCL": (".fcl", r"^\s*(?:FUNCTION_BLOCK|VAR_(?:INPUT|OUTPUT)|(?:DE)?FUZZIFY|RULEBLOCK)\b"),
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
        if match is not None:
            line = text.count("\n", 0, match.start() + len(match[0]) - len(match[0].lstrip())) + 1
            hint = "a .frb file begins with  rulebase NAME  or  controller NAME"
            if suffix:
                hint = f"call it FILE{suffix}, and  fuzzyarm convert FILE{suffix} FILE.frb"
            message = f"this is {what}, not the language of .frb files"
            return Diagnostic("foreign-text", message, Span(line, 1, line, 2), hint=hint)
    return None
