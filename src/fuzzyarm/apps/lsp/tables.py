"""Editing functions of ``.lut`` files; the words of a table are keywords and names."""

from __future__ import annotations

import re
from collections.abc import Sequence

from fuzzyarm.base.diagnostic import Span, split_lines
from fuzzyarm.language.edit import (
    Coloured,
    Completion,
    Edit,
    Fold,
    Hover,
    OutlineSymbol,
    RenameError,
)
from fuzzyarm.language.edit.hover import plain
from fuzzyarm.language.tokens import Token, name_text
from fuzzyarm.table.axis import MODES
from fuzzyarm.table.header import KEYWORDS
from fuzzyarm.table.text import line_tokens, parse_lut, write_lut

_CHOICES: dict[str, tuple[str, ...]] = {
    "mode": MODES,
    "index": ("row", "column", "page"),
}
_WORDS = {"row", "column", "page", "when", "step", "count", "mirrored", *_CHOICES["mode"]}


class TableText:
    """A table text in words.

    Parameters
    ----------
    text : str
        Anything.
    path : str
        Named in the diagnostics.
    """

    def __init__(self, text: str, path: str = "<text>") -> None:
        self.lines = split_lines(text)
        self.parsed = parse_lut(text, path)
        self.tokens = [line_tokens(n, line, []) for n, line in enumerate(self.lines, start=1)]
        self.grids = [n for n, line in enumerate(self.tokens, start=1) if _first(line) == "grid"]

    @property
    def declared(self) -> list[Token]:
        """The names of the inputs and the output at their declarations."""
        return [
            line[1]
            for line in self.tokens
            if len(line) > 1 and _first(line) in ("input", "output") and _is_name(line[1])
        ]

    @property
    def names(self) -> list[str]:
        """The inputs and the output, if the header is readable."""
        return list(dict.fromkeys(token.text for token in self.declared))

    def formatted(self) -> str | None:
        """Return the text in canonical form; None if it has mistakes, or comments to lose."""
        if self.parsed.table is None or any("#" in line for line in self.lines):
            return None
        return write_lut(self.parsed.table)

    def name_at(self, line: int, column: int) -> tuple[str, Span] | None:
        """Return the input or output at a cursor."""
        for token in self._line(line):
            if token.column <= column <= token.end and token.text in self.names:
                return token.text, token.span
        return None

    def occurrences(self, line: int, column: int) -> list[tuple[Span, bool]]:
        """Return all occurrences of the name at a position, and whether each is a declaration."""
        name_and_span = self.name_at(line, column)
        return [] if name_and_span is None else self._occurrences(name_and_span[0])

    def _occurrences(self, name: str) -> list[tuple[Span, bool]]:
        return [
            (token.span, token in self.declared)
            for line in self.tokens
            for index, token in enumerate(line)
            # At the start of a line a keyword is a keyword, whatever the inputs' names.
            if token.text == name and _is_name(token) and (index or token.text not in KEYWORDS)
        ]

    def rename(self, line: int, column: int, new_name: str) -> list[Edit]:
        """Return the edits of a new name at a position, or raise RenameError."""
        name_and_span = self.name_at(line, column)
        if name_and_span is None:
            raise RenameError("no input or output at this position")
        name = new_name.strip().strip("'")
        if not name:
            raise RenameError("the new name is empty")
        if name != name_and_span[0] and name in self.names:
            raise RenameError(f"'{name}' is taken already")
        return [Edit(span, name_text(name)) for span, _ in self._occurrences(name_and_span[0])]

    def complete(self, line: int, column: int) -> list[Completion]:
        """Return the possible words at a position of the header."""
        before = (self.lines[line - 1] if line <= len(self.lines) else "")[: column - 1]
        column = len(before) + 1
        match = re.search(r"[^\W\d][\w-]*\Z", before)
        start = match.start() + 1 if match else column
        # In a comment, or in an open string.
        if "#" in before or before.count('"') % 2:
            return []
        span = Span(line, start, line, column)
        tokens = line_tokens(line, before[: start - 1], [])
        first = _first(tokens)
        if not tokens:
            if self.grids and line > self.grids[0]:
                return [Completion("grid", "keyword", "grid", KEYWORDS["grid"], span=span)]
            return [
                Completion(w, "keyword", w, meaning, span=span) for w, meaning in KEYWORDS.items()
            ]
        words = _CHOICES.get(first, ())
        if first == "index" and tokens[-1].text in words:
            words = tuple(n for n in self.names if n not in {t.text for t in tokens})
        elif first in ("levels", "bins") and len(tokens) == 1:
            words = tuple(f"{name_text(name)}:" for name in self.names[:-1])
        return [Completion(word, "value", word, span=span) for word in words]

    def hover(self, line: int, column: int) -> Hover | None:
        """Return a cell in words, an input with its levels, or the help of a keyword."""
        cell = self._cell(line, column)
        if cell is not None:
            return cell
        name = self.name_at(line, column)
        if name is not None:
            return Hover(self._name_words(name[0]), name[1])
        for token in self._line(line)[:1]:
            if token.column <= column <= token.end and token.text in KEYWORDS:
                return Hover(f"**{token.text}**: {KEYWORDS[token.text]}", token.span)
        return None

    def _name_words(self, name: str) -> str:
        header = self.parsed.header
        if header is None:
            return f"**{plain(name)}**"
        for axis in header.axes:
            if axis.name == name:
                levels = f"{len(axis.levels)} levels, {axis.levels[0]:g} to {axis.levels[-1]:g}"
                bins = "looked up by bins" if axis.bins else "no bins"
                return f"input **{plain(name)}** {plain(axis.description)}\n\n{levels}, {bins}"
        return f"output **{plain(name)}** {plain(header.description)}"

    def _cell(self, line: int, column: int) -> Hover | None:
        start = max((n for n in self.grids if n < line), default=None)
        if start is None or self.parsed.header is None:
            return None
        header = next((n for n in range(start + 1, line) if self._words(n)), None)
        words = self._words(line)
        at = next((i for i, w in enumerate(words) if w.start() < column <= w.end() + 1), None)
        if header is None or not at:
            return None
        head = [word.group() for word in self._words(header)]
        if "\\" in head and len(head) > at + 2:
            cell = f"{head[0]} = {words[0].group()}, {head[2]} = {head[at + 2]}"
        elif "\\" not in head and len(head) > at:
            cell = f"{head[0]} = {head[at]}"
        else:
            return None
        page = self.lines[start - 1].strip().removeprefix("grid").strip()
        more = f" {page}" if page else ""
        value = f"{self.parsed.header.output} = {words[at].group()}"
        return Hover(f"**{plain(value)}** at {plain(cell + more)}", _span(line, words[at]))

    def cell_span(self, cell: Sequence[int]) -> Span | None:
        """Return the position of a cell's number, by its index."""
        header = self.parsed.header
        if header is None:
            return None
        page = 0
        for index, size in zip(cell[:-2], header.shape[:-2], strict=True):
            page = page * size + index
        if page >= len(self.grids):
            return None
        row = cell[-2] if len(cell) > 1 else 0
        below = [n for n in range(self.grids[page] + 1, len(self.lines) + 1) if self._words(n)]
        # The first line below is that of the columns; the others begin with a level.
        words = self._words(below[row + 1]) if len(below) > row + 1 else []
        return _span(below[row + 1], words[cell[-1] + 1]) if len(words) > cell[-1] + 1 else None

    def _words(self, line: int) -> list[re.Match[str]]:
        text = self.lines[line - 1].partition("#")[0] if line <= len(self.lines) else ""
        return list(re.finditer(r"\S+", text))

    def symbols(self) -> list[OutlineSymbol]:
        """Return the axes, the output and the grids."""
        outline = []
        for number, tokens in enumerate(self.tokens, start=1):
            first = _first(tokens)
            if first in ("input", "output") and len(tokens) > 1:
                whole = tokens[0].span.to(tokens[-1].span)
                outline.append(
                    OutlineSymbol(tokens[1].text or "?", "", first, whole, tokens[1].span)
                )
            elif first == "grid":
                end = self._end_of_grid(number)
                whole = Span(number, 1, end, len(self.lines[end - 1]) + 1)
                name = " ".join(self.lines[number - 1].split())
                outline.append(OutlineSymbol(name, "", "grid", whole, tokens[0].span))
        return outline

    def folds(self) -> list[Fold]:
        """Return the grids."""
        ends = ((n, self._end_of_grid(n)) for n in self.grids)
        return [Fold(first, last) for first, last in ends if last > first]

    def _end_of_grid(self, start: int) -> int:
        end = start
        for number in range(start + 1, len(self.lines) + 1):
            if _first(self.tokens[number - 1]) in KEYWORDS:
                break
            if self.lines[number - 1].strip():
                end = number
        return end

    def coloured(self) -> list[Coloured]:
        """Return the coloured words."""
        names = set(self.names)
        colours: list[Coloured] = []
        for number, tokens in enumerate(self.tokens, start=1):
            for index, token in enumerate(tokens):
                colour = _colour(token, names, first=index == 0)
                if colour:
                    colours.append(Coloured(token.line, token.column, token.end, colour))
            start = self.lines[number - 1].find("#", tokens[-1].end - 1 if tokens else 0)
            if start >= 0:
                end = len(self.lines[number - 1].rstrip())
                colours.append(Coloured(number, start + 1, end + 1, "comment"))
        return colours

    def _line(self, line: int) -> tuple[Token, ...]:
        return self.tokens[line - 1] if 1 <= line <= len(self.tokens) else ()


def _first(tokens: tuple[Token, ...]) -> str:
    return tokens[0].text if tokens and tokens[0].kind == "name" else ""


def _is_name(token: Token) -> bool:
    return token.kind in ("name", "quoted")


def _colour(token: Token, names: set[str], *, first: bool) -> str | None:
    if token.kind in ("number", "string"):
        return token.kind
    if _is_name(token):
        if (first and token.text in KEYWORDS) or token.text in _WORDS:
            return "keyword"
        return "variable" if token.text in names else None
    return "operator" if token.text in ("..", "=", "\\") else None


def _span(line: int, word: re.Match[str]) -> Span:
    return Span(line, word.start() + 1, line, word.end() + 1)
