"""FIS text: sections, terms, and fractional term numbers in rules."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from fuzzyarm.base.diagnostic import NOWHERE, Span
from fuzzyarm.base.names import near_hint
from fuzzyarm.exchange.formats.dialects import FIS, Dialect, Spelling, all_spellings, words
from fuzzyarm.exchange.formats.drafts import lines_of
from fuzzyarm.exchange.formats.findings import FaultError, Findings, TextPiece, numbers
from fuzzyarm.exchange.formats.shapes import formula_shape, spelled_shape
from fuzzyarm.language.model.rulebase import Hedge, Shape
from fuzzyarm.symbolic.kinds import HEDGES, SHAPES

ALL_NAMES = ("fis", "octave", "matlab")
"""Name keys: every reader knows the words of all programs."""

# --- FIS text: sections in brackets, `key=value` lines, rules of numbers ---

_HEADER = re.compile(r"\[\s*([a-z_]+)\s*(\d*)\s*\]\s*\Z", re.IGNORECASE)
_SECTIONS = ("System", "Input", "Output", "Rules")


@dataclass(slots=True)
class Section:
    """One section: the kind of its header, the 2 of ``[Input2]`` (else 0), and its lines."""

    kind: str
    number: int = 0
    span: Span = NOWHERE
    lines: list[TextPiece] = field(default_factory=list)


_GLUED = re.compile(r"\s*#\s*RuleBlock\s+(?=\d)")
_OF_A_RULE = re.compile(r"[-+\d.eE\s,():]+")


class _Comments:
    """Cuts comments line by line, but keeps a rule that is glued to one.

    jfuzzylite writes the first rule of a block right behind its comment: ``# RuleBlock 1`` and
    ``2 1, 3 (1.0) : 1`` as ``# RuleBlock 12 1, 3 (1.0) : 1``; the blocks are counted from 1.
    """

    def __init__(self) -> None:
        self.blocks = 0
        self.glued: list[str] = []

    def cut(self, raw: str) -> str:
        match = _GLUED.match(raw)
        if match is None:
            return _without_comment(raw)
        self.blocks += 1
        blanks, rest = str(self.blocks), raw[match.end() :]
        rule = rest[len(blanks) :]
        is_rule = _OF_A_RULE.fullmatch(rule) and "," in rule and ":" in rule
        if not rest.startswith(blanks) or not is_rule:
            return ""
        self.glued.append(rule.strip())
        return " " * (match.end() + len(blanks)) + rule


def sections(text: str, findings: Findings) -> list[Section]:
    """Split a file into sections; ``[FISTree]`` ends the reading."""
    fis_sections: list[Section] = []
    comments = _Comments()
    for line in lines_of(text, comments.cut):
        # Other text may precede the first header, such as the debris of a byte-order mark.
        find = _HEADER.match if fis_sections else _HEADER.search
        match = find(line.text) if len(line.text) < 100 else None
        if match:
            digits = match.group(2)[:6]
            fis_sections.append(Section(match.group(1).lower(), int(digits or 0), line.span))
            name = line.part(*match.span(1))
            if name.text.lower() == "fistree":
                message = (
                    "a tree of systems in one file is not supported; with a file for each of its "
                    "systems, convert --connect makes one rule base of them"
                )
                raise FaultError(message, line, "unsupported-type")
            if name.text.capitalize() not in _SECTIONS:
                findings.unknown("syntax", "the section", name, _SECTIONS)
        elif fis_sections:
            fis_sections[-1].lines.append(line)
        elif not findings.failed:  # of many such lines the first
            message = f"'{line.text[:40]}' is before any section"
            findings.error("syntax", message, line)
        if line.text in comments.glued:
            comments.glued.remove(line.text)
            message = "this rule is glued to the comment before it; fuzzylite leaves such rules out"
            findings.warn("glued-rule", f"{message}, here it is read", line)
    return fis_sections


def _without_comment(raw: str) -> str:
    """Cut a comment: ``%`` or ``#`` first on a line, or after a space outside quotes; ``//``."""
    if raw.lstrip()[:1] in ("%", "#"):
        return ""
    if "%" not in raw and "#" not in raw and "//" not in raw:
        return raw
    quote = ""
    for index, letter in enumerate(raw):
        if letter in ("'", '"') and quote in ("", letter):
            quote = "" if quote else letter
        elif not quote and (letter in "%#" or raw.startswith("//", index)):
            return raw[:index]
    return raw


def unquoted(word: TextPiece) -> TextPiece:
    """Return a word without the quotes around it."""
    text = word.text
    if len(text) >= 2 and text[0] == text[-1] and text[0] in "'\"":
        return TextPiece(text[1:-1], word.span)
    return word


_QUOTED = re.compile(r"""'[^']*'|"[^"]*["]""")


def is_open(value: str) -> bool:
    """Whether a value has an open quote at its start, or an open bracket outside quotes."""
    if value[:1] in ("'", '"') and value[1:].count(value[0]) == 0:
        return True
    bare = _QUOTED.sub("", value)
    return bare.count("[") > bare.count("]")


BRACKETED = re.compile(r"[^\s,;\[\]]+")
"""A word inside brackets, separated by space, commas or semicolons."""


_MEMBERSHIP = re.compile(
    r"""\s*(?:(?P<quote>['"])(?P<quoted>.*?)(?P=quote)|(?P<bare>(?:[^:'"\s]+(?:\s+[^:'"\s]+)*)?))"""
    r"""\s*:\s*['"]?(?P<kind>[\w.]*)['"]?\s*,\s*(?P<rest>.*)\Z""",
    re.DOTALL,
)


def membership_parts(value: TextPiece) -> tuple[TextPiece, TextPiece, TextPiece] | None:
    """Split ``'name':'kind',[numbers]``; None for any other text."""
    match = _MEMBERSHIP.match(value.text)
    if match is None:
        return None
    quoted = match.group("quoted") is not None
    name, kind, rest = (match.span(key) for key in ("quoted" if quoted else "bare", "kind", "rest"))
    end = len(value.text.rstrip())
    return value.part(*name), value.part(*kind), value.part(rest[0], max(rest[0], end))


# --- Detection of the program ---

_FUZZYLITE_KEYS = re.compile(
    r"^[^\S\n]*(lockprevious|lockrange|enabled)\s*=", re.IGNORECASE | re.MULTILINE
)
_ONLY_OCTAVE = re.compile(
    r"""['"](einstein|hamacher|drastic|bounded)_(sum|product|difference)['"]|centroid_integral""",
    re.IGNORECASE,
)
# A fractional index in a rule is a hedge of Octave's toolkit (`hedges_of`).
_FRACTION = re.compile(r"^[^\S\n]*(-?\d+(\.\d+)?[^\S\n]+)*-?\d+\.0*[1-9]\d*[\s,]", re.MULTILINE)


def detect(text: str) -> str:
    """Return the program that most likely wrote the text."""
    comments = "\n".join(
        line for line in text.split("\n")[:60] if line.lstrip()[:1] in ("#", "%", "/")
    ).lower()
    if "fuzzylite" in comments or _FUZZYLITE_KEYS.search(text):
        return "fuzzylite"
    if "for matlab" in comments:
        return "matlab"
    if "octave" in comments or "fuzzy-logic-toolkit" in comments:
        return "octave"
    rules = text.lower().partition("[rules]")[2]
    if _ONLY_OCTAVE.search(text) or _FRACTION.search(rules):
        return "octave"
    return "matlab"


# --- Membership functions ---


def read_shape(
    kind: TextPiece, rest: TextPiece, inputs: int, dialect: Dialect, findings: Findings
) -> Shape | None:
    """Return the shape of ``'kind',[numbers]``."""
    name = kind.text.lower()
    if name == "function":
        text = rest.text.strip().removeprefix("[").removesuffix("]")
        return formula_shape(TextPiece(text, rest.span), FIS["fuzzylite"].formula, findings)
    # For a shape without a FIS word fuzzylite writes the class of the term.
    spellings = all_spellings(SHAPES, *ALL_NAMES, "fll")
    spelling = spellings.get(name) or spellings.get(kind.text)
    if spelling is None:
        _unknown(kind, spellings, findings)
        return None
    values = numbers(rest.parts(BRACKETED), findings)
    if values is None:
        return None
    if name == "constant" and len(values) > 1 and not any(values[:-1]):
        values = values[-1:]  # old files: a linear term with factors of 0
    elif spelling.kind in ("s", "z") and not dialect.heights:
        values[:2] = _crossed(values[:2])
    return spelled_shape(spelling, values, inputs, kind, findings, dialect)


_LISTS = re.compile(r"\[[^\]]*\]")


def read_shapes(
    kind: TextPiece, rest: TextPiece, inputs: int, dialect: Dialect, findings: Findings
) -> tuple[Shape, Shape | None] | None:
    """Return a shape and the lower one of MATLAB's ``[upper],[scale],[lag]``.

    The lower function is the upper one times the scale; on either side it starts where the upper
    one has reached the lag.
    """
    lists = [rest.part(*match.span()) for match in _LISTS.finditer(rest.text)]
    upper = read_shape(kind, lists[0] if len(lists) > 1 else rest, inputs, dialect, findings)
    if upper is None or len(lists) < 2:
        return None if upper is None else (upper, None)
    lists_read = [numbers(word.parts(BRACKETED), findings) for word in lists[1:3]]
    if any(value is None for value in lists_read):
        return None
    scale, lag = (
        (lists_read[0] or [1.0])[0],
        (lists_read[1] if len(lists_read) > 1 else None) or [0.0],
    )
    if not 0.0 < scale <= 1.0 or not all(0.0 <= value < 1.0 for value in lag):
        message = "a lower function has a scale above 0 up to 1, and lags from 0 below 1"
        findings.error("bad-height", message, lists[1])
        return None
    lower = _lagging(upper, lag[0], lag[-1])
    if lower is None:
        message = f"how a {upper.kind} lags is not published; without a lag it can be read"
        findings.error("unsupported-shape", message, lists[-1])
        return None
    return upper, replace(lower, height=lower.height * scale)


def _lagging(shape: Shape, left: float, right: float) -> Shape | None:
    """Return a shape that starts where another has reached a lag; None where this is unknown."""
    if left == right == 0.0:
        return shape
    p = shape.parameters
    if shape.kind == "triangle":
        return replace(
            shape, parameters=(p[0] + left * (p[1] - p[0]), p[1], p[2] - right * (p[2] - p[1]))
        )
    if shape.kind == "trapezoid":
        feet = p[0] + left * (p[1] - p[0]), p[3] - right * (p[3] - p[2])
        return replace(shape, parameters=(feet[0], p[1], p[2], feet[1]))
    return None


def _unknown(kind: TextPiece, spellings: Mapping[str, Spelling], findings: Findings) -> None:
    if not kind.text:
        findings.error("syntax", "the kind of the membership function is missing", kind)
        return
    if kind.text.lower().endswith("mf"):
        message = f"'{kind.text[:40]}' is a custom function, which is not in the file"
        findings.error("unknown-shape", message, kind, near_hint(kind.text, spellings)[0])
        return
    findings.unknown("unknown-shape", "the membership function", kind, spellings)


def _crossed(values: list[float]) -> list[float]:
    """Put the numbers of an s or z in order: reversed, MATLAB makes a step half-way."""
    if len(values) == 2 and values[0] > values[1]:
        middle = 0.5 * (values[0] + values[1])
        return [middle, middle]
    return values


# --- Hedges by fractional term numbers ---

_VERY_VERY = (0.4, (Hedge("very"), Hedge("very")))


def fractions(dialect: Dialect) -> dict[float, tuple[Hedge, ...]]:
    """Return the hedges by the fraction of an index, except for powers."""
    key = "fis" if dialect.producer == "fuzzylite" else "octave"
    pairs = words(HEDGES, key).items()
    return {float(word): (Hedge(name),) for word, name in pairs} | dict([_VERY_VERY])


def hedges_of(fraction: float, dialect: Dialect) -> tuple[Hedge, ...] | None:
    """Return the hedges of a fractional index, or None.

    In Octave's toolkit a fraction f is the power 10 f. fuzzylite knows six of them. MATLAB's
    behaviour is undocumented; its files are read as Octave's.
    """
    if fraction == 0.0:
        return ()
    table = fractions(dialect)
    if fraction in table:
        return table[fraction]
    powers = dialect.producer != "fuzzylite"
    return (Hedge("power", round(10.0 * fraction, 6)),) if powers else None
