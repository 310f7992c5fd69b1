"""Membership functions of FCL, under the names of both dialects."""

from __future__ import annotations

from fuzzyarm.formats.fcl.cursor import Cursor, SyntaxFaultError
from fuzzyarm.formats.fcl.lexer import KEYWORDS
from fuzzyarm.formats.fll.terms import FLL_SHAPES, formula_shape, linear_shape
from fuzzyarm.formats.imported import Findings, Word
from fuzzyarm.formats.shaping import make_shape
from fuzzyarm.rulebase.model import Shape
from fuzzyarm.rulebase.shapes import SHAPES

# jFuzzyLogic: kind of shape and where each number stands in the text.
_JFUZZYLOGIC: dict[str, tuple[str, tuple[int, ...]]] = {
    "TRIAN": ("triangle", (0, 1, 2)),
    "TRAPE": ("trapezoid", (0, 1, 2, 3)),
    "GAUSS": ("gaussian", (0, 1)),
    "GAUSS2": ("two-sided-gaussian", (0, 1, 2, 3)),
    "GBELL": ("bell", (2, 0, 1)),
    "SIGM": ("sigmoid", (1, 0)),
    "DSIGM": ("sigmoid-difference", (1, 0, 3, 2)),
}
_ALIASES = {"TRIANGULAR": "Triangle", "TRAPEZOIDAL": "Trapezoid"}
_GUESSED = {"GENERALIZEDBELL": ("bell", (2, 0, 1))}
_FUZZYLITE = {name.upper(): name for name in FLL_SHAPES}
_WORDS = (*_JFUZZYLOGIC, "COSINE", "SINGLETONS", "FUNCTION", *_FUZZYLITE, "LINEAR", "DISCRETE")


def fcl_shape(cursor: Cursor, dialect: str, inputs: int, findings: Findings) -> Shape | None:
    """Read the function of a term, up to its end.

    Raises
    ------
    SyntaxFaultError
        Where it is none.
    """
    word = cursor.word
    key = cursor.key()
    if key == "(":
        return _points(cursor, dialect, findings)
    if cursor.at_number():
        return make_shape("singleton", [cursor.number()], word, findings)
    if cursor.ended or not word.text[0].isalpha():
        raise SyntaxFaultError("a membership function is expected here", word)
    cursor.take()
    if key == "FUNCTION":
        return _function(cursor, dialect, findings)
    if key == "SINGLETONS":
        return _singletons(cursor, word, findings)
    if key not in _WORDS and key not in _ALIASES and key not in _GUESSED:
        findings.unknown("unknown-shape", "the membership function", word, _WORDS)
        cursor.to_next_statement()
        return None
    values = _numbers(cursor, findings)
    return None if values is None else _shape(word, values, dialect, inputs, findings)


def _shape(
    word: Word, values: list[float], dialect: str, inputs: int, findings: Findings
) -> Shape | None:
    key = word.text.upper()
    if key == "CONSTANT":
        return make_shape("singleton", values, word, findings)
    if key == "LINEAR":
        return linear_shape(values, inputs, word, findings)
    if key == "DISCRETE":
        height = values.pop() if len(values) % 2 else 1.0
        return make_shape("points", values, word, findings, height=height, ties="last")
    if key == "COSINE" and dialect == "jfuzzylogic":  # half width, then centre
        values = [values[1], 2.0 * values[0]] if len(values) == 2 else values
        return make_shape("cosine", values, word, findings)
    if key in _GUESSED:
        message = f"'{word.text}' is taken for a bell with width, slope and centre"
        findings.warn("guessed-shape", message, word)
    if key in _JFUZZYLOGIC or key in _GUESSED:
        kind, order = (_JFUZZYLOGIC | _GUESSED)[key]
    else:
        kind = FLL_SHAPES[_FUZZYLITE.get(key) or _ALIASES[key]]
        order = tuple(range(len(SHAPES[kind].parameters)))
        if kind in ("sigmoid-difference", "sigmoid-product"):
            order = (0, 1, 3, 2)
    height = values.pop() if len(values) == len(order) + 1 else 1.0
    if len(values) == len(order):
        values = [values[index] for index in order]
    if key == "DSIGM":
        _check_difference(values, word, findings)
    return make_shape(kind, values, word, findings, height=height)


def _check_difference(values: list[float], word: Word, findings: Findings) -> None:
    if len(values) != 4:
        return
    first, slope, second, other = values
    if slope <= 0.0 or slope != other or first > second:
        message = (
            "jFuzzyLogic takes 0 where the difference of the sigmoids is negative, the model "
            "its magnitude"
        )
        findings.warn("negative-difference", message, word)


def _numbers(cursor: Cursor, findings: Findings) -> list[float] | None:
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


def _moving(word: Word, findings: Findings) -> None:
    message = (
        f"the corner '{word.text[:40]}' is a variable; a term whose shape moves cannot be carried"
    )
    findings.error("moving-corner", message, word)


def _points(cursor: Cursor, dialect: str, findings: Findings) -> Shape | None:
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
    ties = "first" if dialect == "jfuzzylogic" else "last"
    return make_shape("points", values, first, findings, ties=ties)


def _singletons(cursor: Cursor, word: Word, findings: Findings) -> Shape | None:
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


def _function(cursor: Cursor, dialect: str, findings: Findings) -> Shape | None:
    first = cursor.word
    parts: list[str] = []
    last = first
    while not cursor.ended and cursor.word.text != ";":
        if cursor.key() in KEYWORDS and cursor.key() not in ("AND", "OR"):
            break
        last = cursor.take()
        parts.append(last.text)
    formula = Word(" ".join(parts), first.span.to(last.span))
    return formula_shape(formula, dialect, findings)
