"""FCL text: words without comments, a cursor, membership functions."""

from __future__ import annotations

import re
from itertools import pairwise

from fuzzyarm.base.diagnostic import NOWHERE, Span
from fuzzyarm.exchange.formats.dialects import FCL, Dialect, Spelling, all_spellings
from fuzzyarm.exchange.formats.fcl_scikit_terms import own_shape, refusal
from fuzzyarm.exchange.formats.findings import (
    FaultError,
    Findings,
    TextPiece,
    is_too_large,
    not_a_number,
    number,
)
from fuzzyarm.exchange.formats.shapes import formula_shape, make_shape, spelled_shape
from fuzzyarm.language.model.rulebase import Shape
from fuzzyarm.symbolic.kinds import SHAPES

_TOKEN = re.compile(
    r"(?P<space>[^\S\n]+)|(?P<newline>\n)"
    r"|(?P<line>(?://|#)[^\n]*)|(?P<block>/\*.*?\*/|\(\*.*?\*\))"
    r"|(?P<open>/\*|\(\*)"
    r"|(?P<number>(?:\d+(?:\.(?!\.)\d*)?|\.\d+)(?:[eE][+-]?\d+)?(?!\w|\.\d))"
    r"|(?P<bad>\d*\.\d[\w.]*)"
    r"|(?P<word>\w+)|(?P<sign>:=|\.\.|\*\*|\S)",
    re.DOTALL,
)
_PERCENT_LINE = re.compile(r"^[^\S\n]*%[^\n]*", re.MULTILINE)

SECTION_ENDS = ("END_VAR", "END_FUZZIFY", "END_DEFUZZIFY", "END_RULEBLOCK", "END_FUNCTION_BLOCK")
SECTIONS = ("FUNCTION_BLOCK", "VAR_INPUT", "VAR_OUTPUT", "FUZZIFY", "DEFUZZIFY", "RULEBLOCK")

KEYWORDS = frozenset(
    f"VAR OPTIONS OPTION {' '.join((*SECTIONS, *SECTION_ENDS))} END_OPTIONS END_OPTION TERM RANGE "
    "METHOD DEFAULT ACCU ACT AND OR RULE ENABLED LOCK".split()
)
"""Words that begin a statement or end a section, in upper case."""


def fcl_words(text: str, findings: Findings) -> list[TextPiece]:
    """Return the words of a text, without its three kinds of comment."""
    text = _PERCENT_LINE.sub(lambda m: " " * len(m.group()), text)
    words: list[TextPiece] = []
    line, line_start, position = 1, 0, 0
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:  # impossible: the last alternative matches any character
            break
        kind, piece = match.lastgroup, match.group()
        column = position - line_start + 1
        position = match.end()
        if kind == "newline":
            line, line_start = line + 1, position
        elif kind == "block":
            line += piece.count("\n")
            if "\n" in piece:
                line_start = match.start() + piece.rfind("\n") + 1
        elif kind == "open":
            word = TextPiece(piece, Span(line, column, line, column + 2))
            findings.error("open-comment", "the comment that begins here never ends", word)
            break
        elif kind in ("number", "bad", "word", "sign"):
            words.append(TextPiece(piece, Span(line, column, line, column + len(piece))))
    return words


MEAN_OF_MAXIMUM = (
    "releases of jFuzzyLogic divide the last of the maximal samples by their number; here it is "
    "their mean"
)


class WordCursor:
    """A cursor over words."""

    def __init__(self, words: list[TextPiece]) -> None:
        self.words = words
        self.at = 0

    @property
    def ended(self) -> bool:
        """Whether no word is left."""
        return self.at >= len(self.words)

    @property
    def word(self) -> TextPiece:
        """The next word; an empty one at the end."""
        if self.at < len(self.words):
            return self.words[self.at]
        last = self.words[-1].span if self.words else NOWHERE
        return TextPiece("", last)

    def key(self, ahead: int = 0) -> str:
        """Return a coming word in upper case."""
        index = self.at + ahead
        return self.words[index].text.upper() if index < len(self.words) else ""

    def take(self) -> TextPiece:
        """Return the next word and advance."""
        word = self.word
        self.at += 1
        return word

    def skip(self, *keys: str) -> bool:
        """Advance past the next word if it is one of `keys`."""
        if self.key() in keys and not self.ended:
            self.at += 1
            return True
        return False

    def expect(self, *keys: str) -> TextPiece:
        """Consume the next word, which must be one of `keys`."""
        if self.ended or self.key() not in keys:
            text = f"'{self.word.text[:40]}'" if not self.ended else "the end of the file"
            raise FaultError(f"'{keys[0]}' is expected here, not {text}", self.word)
        return self.take()

    def name(self, owner: str) -> TextPiece:
        """Consume the next word, which must be a name."""
        if self.ended or not (self.word.text[0].isalpha() or self.word.text[0] in "_0123456789"):
            raise FaultError(f"the name of {owner} is expected here", self.word)
        return self.take()

    def title(self, keys: frozenset[str], *, setting: bool = False) -> TextPiece:
        """Return the rest of the line up to one of `keys`, as the name of a block.

        With `setting` a key ends it only if a colon follows at once or after one more word.
        """
        start, line = self.at, self.word.span.line
        while not self.ended and self.word.span.line == line and self.key() != ";":
            follows = not setting or ":" in (self.key(1), self.key(2))
            if self.key() in keys and follows:
                break
            self.at += 1
        words = self.words[start : self.at]
        if not words:
            return TextPiece("", self.word.span)
        text = words[0].text
        for before, word in pairwise(words):
            apart = before.span.end_column < word.span.column
            text += f" {word.text}" if apart else word.text
        return TextPiece(text, words[0].span.to(words[-1].span))

    def number(self) -> float:
        """Consume a number with its signs."""
        first = self.word
        sign = 1.0
        while self.key() in ("+", "-"):
            if self.take().text == "-":
                sign = -sign
        value = number(self.word.text) if not self.ended else None
        if value is None:
            text = "" if self.ended else f": {not_a_number(self.word.text)}"
            raise FaultError(f"a number is expected here{text}", first, "not-a-number")
        self.at += 1
        return sign * value

    def at_number(self) -> bool:
        """Whether a number follows."""
        ahead = 0
        while self.key(ahead) in ("+", "-"):
            ahead += 1
        text = self.key(ahead)
        return bool(text) and (number(text) is not None or is_too_large(text))

    def end_key(self) -> None:
        """Advance past the next keyword and the optional signs before its value."""
        self.take()
        self.skip(":", ":=", "=")

    def to_next_statement(self) -> None:
        """Advance past the next semicolon, or to the next statement."""
        while not self.ended:
            if self.key() in KEYWORDS and self.key() not in ("AND", "OR"):
                return
            if self.take().text == ";":
                return


# --- Membership functions, by the names of both dialects ---

_ALIASES = {"TRIANGULAR": "TRIANGLE", "TRAPEZOIDAL": "TRAPEZOID", "GENERALIZEDBELL": "GBELL"}


_OF_THE_STANDARD = {
    "RIGHTLINEAR": "RAMP", "S": "SSHAPE", "Z": "ZSHAPE", "PI": "PISHAPE",
    "RECTANGULAR": "RECTANGLE",
}  # fmt: skip
"""Words of IEEE 1855 that only fcl-for-scikit-fuzzy has."""


def _spellings(dialect: Dialect) -> dict[str, Spelling]:
    """Return the words for shapes in upper case: either dialect knows those of both programs."""
    all_known = all_spellings(SHAPES, "jfl", "fcl")
    spellings = {word.upper(): spelling for word, spelling in all_known.items()}
    if not is_scikits(dialect):
        return spellings
    spellings |= {word: spellings[same] for word, same in _OF_THE_STANDARD.items()}
    spellings["LEFTLINEAR"] = Spelling("ramp", "leftlinear", (1, 0))
    for word in ("SIGMOIDDIFFERENCE", "SIGMOIDPRODUCT"):  # the numbers of both, one after the other
        spellings[word] = spellings[word]._replace(order=(0, 1, 2, 3))
    spellings["SINGLETON"] = Spelling("singleton", "singleton", (0,))
    for word in ("LEFTGAUSSIAN", "RIGHTGAUSSIAN"):
        spellings[word] = Spelling("gaussian", word.lower(), (0, 1))
    return {word: entry for word, entry in spellings.items() if word not in _NOT_OF_SCIKIT}


_NOT_OF_SCIKIT = frozenset({"LINEAR", "FUNCTION", "CONSTANT", "DISCRETE", "BINARY", "ARC", "DSIGM"})


def is_scikits(dialect: Dialect) -> bool:
    """Whether a text has the semantics of fcl-for-scikit-fuzzy."""
    return dialect.producer == "scikit-fuzzy"


def read_shape(
    cursor: WordCursor, dialect: Dialect, inputs: int, findings: Findings
) -> Shape | None:
    """Read the function of a term, up to its end."""
    word = cursor.word
    key = cursor.key()
    if key == "(":
        return _points(cursor, dialect, findings)
    spellings = _spellings(dialect)
    if cursor.at_number() and key not in spellings:  # PI may be a shape or a number
        return make_shape("singleton", [cursor.number()], word, findings)
    if not cursor.ended and word.text[0] in ".0123456789":
        cursor.number()
    if cursor.ended or key in (";", *KEYWORDS):
        raise FaultError("the term has no membership function after ':='", word)
    if not word.text[0].isalpha():
        raise FaultError(f"a membership function is expected here, not '{word.text[:40]}'", word)
    cursor.take()
    if key == "FUNCTION" and not is_scikits(dialect):
        return _function(cursor, dialect, findings)
    if key == "SINGLETONS" and not is_scikits(dialect):
        return _singletons(cursor, word, findings)
    spelling = spellings.get(_ALIASES.get(key, key))
    if spelling is None:
        names = (*spellings, "SINGLETONS")
        findings.unknown("unknown-shape", "the membership function", word, names)
        cursor.to_next_statement()
        return None
    values = _numbers(cursor, findings)
    return None if values is None else _shape(word, spelling, values, dialect, inputs, findings)


def _shape(
    word: TextPiece,
    spelling: Spelling,
    values: list[float],
    dialect: Dialect,
    inputs: int,
    findings: Findings,
) -> Shape | None:
    key = word.text.upper()
    if is_scikits(dialect):
        reason = refusal(key, values)
        if reason:
            findings.error("unordered-corners", reason, word)
            return None
        user_shape = own_shape(key, values)
        if user_shape is not None:
            return user_shape
    if key == "COSINE" and dialect.producer == "jfuzzylogic":  # half width, then centre
        values = [values[1], 2.0 * values[0]] if len(values) == 2 else values
        return make_shape("cosine", values, word, findings)
    if key == "GENERALIZEDBELL":
        message = f"'{word.text}' is taken for a bell with width, slope and centre"
        findings.warn("guessed-shape", message, word)
    is_fuzzylites = spelling in all_spellings(SHAPES, "fcl").values() and not is_scikits(dialect)
    program = FCL["fuzzylite"] if is_fuzzylites else dialect
    shape = spelled_shape(spelling, values, inputs, word, findings, program)
    if key == "DSIGM" and shape is not None and is_cut(shape):
        message = (
            "jFuzzyLogic uses 0 where the difference of the sigmoids is negative, the model "
            "its magnitude"
        )
        findings.loss("negative-difference", message, word, slight=True)
    return shape


def _numbers(cursor: WordCursor, findings: Findings) -> list[float] | None:
    values: list[float] = []
    while not cursor.ended and cursor.word.text != ";" and cursor.key() not in KEYWORDS:
        if cursor.at_number():
            values.append(cursor.number())
        elif cursor.word.text in (",", "(", ")"):
            cursor.take()
        else:
            _moving(cursor.word, findings)
            cursor.to_next_statement()
            return None
    return values


def _moving(word: TextPiece, findings: Findings) -> None:
    if not word.text[0].isalpha():
        raise FaultError(f"'{word.text[:40]}' is not a number", word, "not-a-number")
    ending = " is a variable; a term whose shape moves cannot be carried"
    findings.unknown("moving-corner", "the corner", word, (), ending=ending)


def _points(cursor: WordCursor, dialect: Dialect, findings: Findings) -> Shape | None:
    first = cursor.word
    values: list[float] = []
    while cursor.skip("("):
        for closing in (",", ")"):
            if not cursor.at_number() and cursor.word.text[:1].isalpha():
                _moving(cursor.word, findings)
                cursor.to_next_statement()
                return None
            values.append(cursor.number())
            cursor.expect(closing)
        cursor.skip(",")
    if is_scikits(dialect):  # it sorts them
        pairs = sorted(zip(values[0::2], values[1::2], strict=True), key=lambda pair: pair[0])
        values = [value for pair in pairs for value in pair]
    return make_shape("points", values, first, findings, ties=dialect.ties)


def _singletons(cursor: WordCursor, word: TextPiece, findings: Findings) -> Shape | None:
    pairs: list[float] = []
    while cursor.skip("("):
        pairs.append(cursor.number())
        cursor.expect(",")
        pairs.append(cursor.number())
        cursor.expect(")")
    if len(pairs) == 2 and pairs[1] == 1.0:
        return make_shape("singleton", pairs[:1], word, findings)
    message = "a term of several singletons, or of one lower than 1, cannot be carried"
    findings.error("several-singletons", message, word)
    return None


def _function(cursor: WordCursor, dialect: Dialect, findings: Findings) -> Shape | None:
    first = cursor.word
    parts: list[str] = []
    last = first
    while not cursor.ended and cursor.word.text != ";":
        if cursor.key() in KEYWORDS and cursor.key() not in ("AND", "OR"):
            break
        last = cursor.take()
        parts.append(last.text)
    formula = TextPiece(" ".join(parts), first.span.to(last.span))
    return formula_shape(formula, dialect.formula, findings)


def is_cut(difference: Shape) -> bool:
    """Whether a difference of sigmoids is negative somewhere, which jFuzzyLogic cuts to 0."""
    first, slope, second, other = difference.parameters
    return slope != other or slope * (second - first) < 0.0
