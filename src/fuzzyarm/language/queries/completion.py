"""What could stand at a position, told by the words before it: a broken line does not matter."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import permutations

from fuzzyarm.expression.kinds import SHAPES
from fuzzyarm.expression.kinds import Shape as ShapeKind
from fuzzyarm.language.parser import CHOICES
from fuzzyarm.language.printer import name_text
from fuzzyarm.language.queries.reading import Reading
from fuzzyarm.language.tokens import (
    HEDGE_WORDS,
    LOOKUP_ITEMS,
    SETTINGS,
    STATEMENTS,
    Token,
    tokenize_line,
)
from fuzzyarm.model.rulebase import DEFUZZIFIERS, SAMPLINGS, RuleBase, Variable
from fuzzyarm.model.shapes import EVEN_SHAPES
from fuzzyarm.text.diagnostic import Diagnostic, Span
from fuzzyarm.text.names import nearest
from fuzzyarm.text.numbers import number_text

# --- Candidates: words of the language, names, shapes with their numbers ---

HEDGE_EFFECTS: dict[str, str] = {
    "not": "1 − d",
    "very": "d²",
    "somewhat": "√d",
    "extremely": "d³",
    "intensify": "2d² up to one half, then 1 − 2(1 − d)²",
    "seldom": "√(d/2) up to one half, then 1 − √((1 − d)/2)",
    "any": "1",
    "power": "dᵖ",
}
"""What each hedge makes of a degree d."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """One thing that could stand at a place.

    Attributes
    ----------
    label : str
        What a list shows.
    kind : str
        ``keyword``, ``variable``, ``term``, ``shape``, ``hedge``, ``value`` or ``row``.
    insert : str
        The text to put there.
    detail : str
        A few words beside the label.
    snippet : str
        The same text with places to fill in, as ``${1:left}``; empty where there are none.
    span : Span or None
        The text that has been typed already and is replaced; set by `complete`.
    """

    label: str
    kind: str
    insert: str
    detail: str = ""
    snippet: str = ""
    span: Span | None = None


def keywords(words: Iterable[str], details: dict[str, str] | None = None) -> list[Candidate]:
    """Return words of the language."""
    return [Candidate(word, "keyword", word, (details or {}).get(word, "")) for word in words]


def values(words: Iterable[str]) -> list[Candidate]:
    """Return the values of a setting."""
    return [Candidate(word, "value", word) for word in words]


def variables(them: Iterable[Variable], follow: str = "") -> list[Candidate]:
    """Return names of variables with `follow` behind each."""
    return [
        Candidate(v.name, "variable", name_text(v.name) + follow, variable_detail(v)) for v in them
    ]


def variable_detail(variable: Variable) -> str:
    """Return range and description in a few words."""
    text = f"{number_text(variable.low)} .. {number_text(variable.high)}"
    return f"{text}  {variable.description}".rstrip()


def terms(variable: Variable | None, without: Iterable[str] = ()) -> list[Candidate]:
    """Return the terms of a variable in their order."""
    if variable is None:
        return []
    left_out = set(without)
    return [
        Candidate(term.name, "term", name_text(term.name), term_detail(variable, term.name))
        for term in variable.terms
        if term.name not in left_out
    ]


def term_detail(variable: Variable, name: str) -> str:
    """Return the shape of a term as it would stand in a file."""
    shape = variable.term(name).shape
    if shape.kind in ("formula", "linear"):
        return shape.kind
    return " ".join([shape.kind, *(f"{x:.6g}" for x in shape.parameters)])


def hedges() -> list[Candidate]:
    """Return the hedges."""
    return [
        Candidate(
            word,
            "hedge",
            "power(2)" if word == "power" else word,
            HEDGE_EFFECTS[meaning],
            "power(${1:2})" if word == "power" else "",
        )
        for word, meaning in HEDGE_WORDS.items()
    ]


def shapes() -> list[Candidate]:
    """Return every shape with its numbers as places to fill in."""
    return [_shape(kind) for kind in SHAPES.values()]


def _shape(kind: ShapeKind) -> Candidate:
    special = {
        "points": "points (${1:0}, ${2:0}) (${3:1}, ${4:1})",
        "linear": "linear ${1:0}",
        "formula": 'formula "${1:0}"',
    }
    numbers = " ".join(f"${{{i}:{name}}}" for i, name in enumerate(kind.parameters, start=1))
    snippet = special.get(kind.name) or f"{kind.name} {numbers}"
    parameters = " ".join(kind.parameters)
    detail = f"{parameters} — {kind.doc}" if kind.fuzzy else kind.doc
    return Candidate(kind.name, "shape", kind.name, detail.lstrip(" —"), snippet)


# --- In a line below `rules`: header, row labels and cells ---

_MOST_HEADERS = 12


def complete_grid_line(
    reading: Reading, line: int, first_line: int, tokens: tuple[Token, ...]
) -> list[Candidate]:
    """Return what could follow `tokens` in line `line` of the grid that starts at `first_line`."""
    header_line = next(
        (n for n in range(first_line + 1, line) if reading.tokens_of(n)), None
    )  # fmt: skip
    if header_line is None:
        return _header(reading, tokens)
    row, column, columns = _read_header(reading, reading.tokens_of(header_line))
    output = _output(reading, first_line)
    if not tokens:
        return _labels(reading, row, output, header_line, line)
    if len(tokens) - 1 >= len(columns) or column is None:
        return []
    if tokens[-1].text == "*":
        return []
    return [*terms(output), Candidate(".", "value", ".", "no rule for this cell")]


def _output(reading: Reading, first_line: int) -> Variable | None:
    tokens = reading.tokens_of(first_line)
    return reading.variable(tokens[1].text) if len(tokens) > 1 else None


def _read_header(
    reading: Reading, tokens: tuple[Token, ...]
) -> tuple[Variable | None, Variable | None, list[str]]:
    names = [token.text for token in tokens if token.kind in ("name", "quoted")]
    if len(tokens) > 2 and tokens[1].text == "\\":
        return reading.variable(names[0]), reading.variable(tokens[2].text), names[2:]
    return None, reading.variable(names[0]) if names else None, names[1:]


def _header(reading: Reading, tokens: tuple[Token, ...]) -> list[Candidate]:
    inputs = reading.model.inputs
    if not tokens:
        return [*_whole_headers(reading), *variables(inputs)]
    if tokens[-1].text == "\\":
        return variables([v for v in inputs if v.name != tokens[0].text])
    names = [token.text for token in tokens if token.kind in ("name", "quoted")]
    with_rows = len(tokens) > 1 and tokens[1].text == "\\"
    across = reading.variable(names[1] if with_rows and len(names) > 1 else names[0])
    used = names[2:] if with_rows else names[1:]
    offered = terms(across, without=used)
    if len(offered) > 1:
        rest = "  ".join(candidate.insert for candidate in offered)
        offered.insert(0, Candidate(rest, "row", rest, "the header row"))
    if len(tokens) == 1:
        offered.insert(0, Candidate("\\", "keyword", "\\ ", "then the variable across"))
    return offered


def _whole_headers(reading: Reading) -> list[Candidate]:
    inputs = [v for v in reading.model.inputs if v.terms]
    pairs = list(permutations(inputs, 2))[:_MOST_HEADERS]
    rows = [
        (f"{name_text(down.name)} \\ {name_text(across.name)}  {_names(across)}",
         f"{down.name} down, {across.name} across")
        for down, across in pairs
    ]  # fmt: skip
    if len(inputs) == 1:
        rows = [(f"{name_text(inputs[0].name)}  {_names(inputs[0])}", "one input")]
    return [Candidate(text, "row", text, detail) for text, detail in rows]


def _names(variable: Variable) -> str:
    return "  ".join(name_text(term.name) for term in variable.terms)


def _labels(
    reading: Reading, row: Variable | None, output: Variable | None, header_line: int, line: int
) -> list[Candidate]:
    if row is None:
        return variables([output]) if output is not None else []
    extent = reading.statement_at(header_line)
    last = extent[2] if extent else line
    used = {
        reading.tokens_of(n)[0].text
        for n in range(header_line + 1, last + 1)
        if n != line and reading.tokens_of(n)
    }
    return terms(row, without=used)


# --- In a statement ---

Tokens = tuple[Token, ...]


def complete_statement(model: RuleBase, keyword: str, tokens: Tokens) -> list[Candidate]:
    """Return what could stand behind `keyword` and `tokens`."""
    return _COMPLETERS[keyword](model, tokens) if keyword in _COMPLETERS else []


def _all(model: RuleBase) -> tuple[Variable, ...]:
    return (*model.inputs, *model.outputs)


def _find(model: RuleBase, name: str) -> Variable | None:
    return next((v for v in _all(model) if v.name == name), None)


def _range(model: RuleBase, tokens: Tokens) -> list[Candidate]:
    if len(tokens) != 1:
        return []
    snippet = '${1:-1} .. ${2:1}  "${3:description}"'
    return [Candidate("range", "value", "-1 .. 1", "low .. high", snippet)]


def _even_terms(model: RuleBase, tokens: Tokens) -> list[Candidate]:
    texts = [token.text for token in tokens]
    if ":" not in texts:
        if not texts or texts[-1] == ",":
            return variables(v for v in _all(model) if v.name not in texts)
        return keywords((":",))
    after = texts[texts.index(":") + 1 :]
    if not after:
        return [Candidate(name, "shape", name, what) for name, what in EVEN_SHAPES.items()]
    if len(after) == 1:
        sets = ("NB NM NS ZE PS PM PB", "NB NS ZE PS PB", "N ZE P", "LOW MIDDLE HIGH")
        return [Candidate(names, "row", names) for names in sets]
    return []


def _term(model: RuleBase, tokens: Tokens) -> list[Candidate]:
    texts = [token.text for token in tokens]
    if not texts:
        return variables(_all(model))
    if ":" not in texts:
        return keywords((":",)) if len(texts) == 2 else []
    after = texts[texts.index(":") + 1 :]
    if not after:
        return shapes()
    if after[0] == "linear" and after[-1] in ("linear", "*", "+", "-"):
        return variables(model.inputs)
    if tokens[-1].kind in ("number", "string") or after[-1] in (")", "inf"):
        return keywords(("height",)) if "height" not in after else []
    return []


def _inference(model: RuleBase, tokens: Tokens) -> list[Candidate]:
    if not tokens:
        return [*keywords(SETTINGS), *variables(_all(model), ":")]
    return _settings(tokens, SETTINGS)


def _block(model: RuleBase, tokens: Tokens) -> list[Candidate]:
    texts = [token.text for token in tokens]
    if ":" not in texts:
        return keywords((":",)) if texts else []
    return _settings(tokens, ("and", "or", "implication"))


def _settings(tokens: Tokens, keys: tuple[str, ...]) -> list[Candidate]:
    last = tokens[-1].text
    texts = [token.text for token in tokens]
    if last == "," and _inside_parenthesis(texts):
        return values(SAMPLINGS)
    if last in (":", ","):
        return keywords(key for key in keys if key not in texts)
    if last in DEFUZZIFIERS:
        samples = Candidate("(101, endpoints)", "value", "(101, endpoints)", "a number of samples")
        return [*keywords(("exact",)), samples]
    return values(_VALUES.get(last, ()))


_VALUES = {**CHOICES, "defuzzifier": DEFUZZIFIERS, "no-rule": ("error", "hold", "0")}


def _inside_parenthesis(texts: list[str]) -> bool:
    return texts.count("(") > texts.count(")")


def _rules(model: RuleBase, tokens: Tokens) -> list[Candidate]:
    texts = [token.text for token in tokens]
    if not texts:
        return variables(model.outputs)
    if "when" not in texts:
        return keywords(("when",)) if len(texts) == 1 else []
    return _expression(model, tokens[texts.index("when") + 1 :], ("and", "or"))


def _rule(model: RuleBase, tokens: Tokens) -> list[Candidate]:
    texts = [token.text for token in tokens]
    if not texts:
        return keywords(("if",))
    if "then" not in texts:
        return _expression(model, tokens[1:], ("and", "or", "then"))
    after = tokens[texts.index("then") + 1 :]
    if not after or after[-1].text in ("and", ","):
        return variables(model.outputs, " is")
    if any(token.text == "with" for token in after):
        return []
    return _proposition(model, after, ("and", "with"))


def _expression(model: RuleBase, tokens: Tokens, follow: tuple[str, ...]) -> list[Candidate]:
    if not tokens or tokens[-1].text in ("and", "or", "("):
        return [*variables(_all(model), " is"), *hedges()]
    if _asked(tokens) is None and tokens[-1].text in HEDGE_WORDS:
        return [*keywords(("(",)), *hedges()]
    return _proposition(model, tokens, follow)


def _proposition(model: RuleBase, tokens: Tokens, follow: tuple[str, ...]) -> list[Candidate]:
    asked = _asked(tokens)
    if asked is not None:
        return [*terms(_find(model, asked)), *hedges()]
    starts = tokens[-1].text == ")" or _asked(tokens[:-1]) is not None
    return keywords(follow) if starts else keywords(("is",))


def _asked(tokens: Tokens) -> str | None:
    """Return the variable whose term comes next; None where no term does."""
    index = len(tokens) - 1
    while index >= 0:
        text = tokens[index].text
        if text == ")" and index >= 3 and tokens[index - 3].text == "power":
            index -= 4
        elif text in HEDGE_WORDS and tokens[index].kind == "name":
            index -= 1
        else:
            break
    if index < 1 or tokens[index].text != "is":
        return None
    return tokens[index - 1].text


def _expect(model: RuleBase, tokens: Tokens) -> list[Candidate]:
    texts = [token.text for token in tokens]
    if "->" in texts:
        return _outcome(model, tokens[texts.index("->") + 1 :])
    if not texts or texts[-1] == ",":
        return variables((v for v in model.inputs if v.name not in texts), " =")
    if tokens[-1].kind == "number":
        named = all(v.name in texts for v in model.inputs)
        return keywords(("->",) if named else (",",))
    return keywords(("=",)) if texts[-1] not in ("=", "-") else []


def _outcome(model: RuleBase, tokens: Tokens) -> list[Candidate]:
    if not tokens or tokens[-1].text == ",":
        return variables(model.outputs)
    last = tokens[-1]
    if last.kind == "number":
        texts = [token.text for token in tokens]
        words = {"=": "within", "in": ".."}
        return keywords(word for relation, word in words.items() if relation in texts)
    if last.kind in ("name", "quoted") and last.text not in ("in", "within"):
        return keywords(("=", "<", "<=", ">", ">=", "in"))
    return []


_COMPLETERS: dict[str, Callable[[RuleBase, Tokens], list[Candidate]]] = {
    "input": _range,
    "output": _range,
    "terms": _even_terms,
    "term": _term,
    "inference": _inference,
    "block": _block,
    "rules": _rules,
    "rule": _rule,
    "expect": _expect,
}


# --- What could stand at a position ---

_PARTIAL = re.compile(r"(?:'[^']*|[^\W\d][\w-]*)\Z")
_ALLOW = re.compile(r"#\s*allow\s+(?:[\w-]+\s*,\s*)*([\w-]*)\Z")


@dataclass(frozen=True, slots=True)
class Before:
    """What stands before a place.

    Attributes
    ----------
    keyword : str
        The word that starts the statement, empty where none has been started.
    tokens : tuple of Token
        Of the statement's line, or of the line below ``rules`` and ``lookup``.
    first_line : int
        Where the statement starts.
    """

    keyword: str
    tokens: tuple[Token, ...]
    first_line: int


def complete(reading: Reading, line: int, column: int) -> list[Candidate]:
    """Return what could stand at a place, the likeliest first.

    Parameters
    ----------
    reading : Reading
        The text, however broken.
    line, column : int
        The place of the cursor, from 1.
    """
    text = reading.raw_line(line)[: column - 1]
    column = len(text) + 1
    comment = _in_comment(text, line, column)
    if comment is not None:
        return comment
    found: list[Diagnostic] = []
    tokenize_line(line, text, found)
    if any(d.name == "unterminated-string" and text[d.column - 1] == '"' for d in found):
        return []
    match = _PARTIAL.search(text)
    # A letter behind a digit belongs to no name: `1e` is on its way to a number.
    start = match.start() + 1 if match else column
    if match and text[: start - 1][-1:].isdigit():
        return []
    partial = text[start - 1 :]
    span = Span(line, start, line, column)
    tokens = tokenize_line(line, text[: start - 1], []).tokens
    before = _before(reading, line, tokens, indented=text[:1].isspace())
    offered = _offered(reading, line, before, indented=text[:1].isspace())
    wanted = partial.strip("'").casefold()
    ranked = sorted(offered, key=lambda c: not c.label.casefold().startswith(wanted))
    return [replace(candidate, span=span) for candidate in ranked]


def _in_comment(text: str, line: int, column: int) -> list[Candidate] | None:
    if not tokenize_line(line, text, []).comment and not text.endswith("#"):
        return None
    match = _ALLOW.search(text)
    if match is None:
        return []
    from fuzzyarm.language.check import CHECKS

    span = Span(line, match.start(1) + 1, line, column)
    return [Candidate(n, "value", n, c.summary, span=span) for n, c in CHECKS.items()]


def _before(
    reading: Reading, line: int, tokens: tuple[Token, ...], *, indented: bool
) -> Before | None:
    if tokens and _starts_statement(tokens):
        return Before(tokens[0].text, tokens[1:], line)
    if not indented:
        # The line starts a statement, though its word may be misspelt.
        meant = nearest(tokens[0].text, STATEMENTS) if tokens else None
        if meant is not None:
            return Before(meant, tokens[1:], line)
        if not tokens:
            return None
    above: list[tuple[Token, ...]] = []
    for number in range(line - 1, 0, -1):
        earlier = reading.tokens_of(number)
        if not earlier:
            continue
        above.append(earlier)
        if _starts_statement(earlier):
            keyword = earlier[0].text
            if keyword in ("rules", "lookup"):
                return Before(keyword, tokens, number)
            joined = [token for part in reversed(above) for token in part]
            return Before(keyword, (*joined[1:], *tokens), number)
    return None


def _starts_statement(tokens: Sequence[Token]) -> bool:
    return tokens[0].kind == "name" and tokens[0].text in STATEMENTS


def _offered(
    reading: Reading, line: int, before: Before | None, *, indented: bool
) -> list[Candidate]:
    if before is None:
        return [] if indented else keywords(STATEMENTS, STATEMENTS)
    if before.first_line < line and before.keyword == "rules":
        return complete_grid_line(reading, line, before.first_line, before.tokens)
    if before.first_line < line and before.keyword == "lookup":
        return _lookup_item(reading, before.tokens)
    return complete_statement(reading.model, before.keyword, before.tokens)


def _lookup_item(reading: Reading, tokens: tuple[Token, ...]) -> list[Candidate]:
    if not tokens:
        return keywords(LOOKUP_ITEMS)
    item, last = tokens[0].text, tokens[-1]
    if item in ("levels", "bins") and len(tokens) == 1:
        return variables(reading.model.inputs, ":")
    if last.kind != "number":
        return []
    if item == "levels" and any(token.text == ".." for token in tokens):
        return [] if {"step", "count"} & {t.text for t in tokens} else keywords(("step", "count"))
    return keywords(("mirrored",)) if item == "bins" else []
