"""Colours for rule bases and tables: those that an editor asks the language server for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, ClassVar

from pygments.lexer import Lexer
from pygments.token import Comment, Keyword, Name, Number, Operator, String, Text, _TokenType

from fuzzyarm.apps.lsp.tables import TableText
from fuzzyarm.language.edit import coloured, read

COLOURS = {
    "keyword": Keyword,
    "namespace": Name.Namespace,
    "variable": Name.Variable,
    "enumMember": Name.Constant,
    "modifier": Name.Decorator,
    "type": Keyword.Type,
    "property": Name.Attribute,
    "function": Name.Function,
    "number": Number,
    "string": String,
    "comment": Comment,
    "operator": Operator,
}
"""Token types of an editor → those of Pygments."""


class _Coloured(Lexer):
    """Words with a colour, and what stands between them."""

    of: ClassVar[Callable[[str], Any]]

    def get_tokens_unprocessed(self, text: str) -> Iterator[tuple[int, _TokenType, str]]:
        starts = [0]
        for line in text.splitlines(keepends=True):
            starts.append(starts[-1] + len(line))
        position = 0
        for word in type(self).of(text):
            begin, end = (starts[word.line - 1] + column - 1 for column in (word.column, word.end))
            if begin > position:
                yield position, Text, text[position:begin]
            yield begin, COLOURS[word.colour], text[begin:end]
            position = end
        yield position, Text, text[position:]


class RuleBaseLexer(_Coloured):
    """A ``.frb`` text, or a piece of one."""

    name, aliases, filenames = "fuzzyarm rule base", ["frb"], ["*.frb"]
    of = staticmethod(lambda text: coloured(read(text)))


class LutLexer(_Coloured):
    """A ``.lut`` text."""

    name, aliases, filenames = "fuzzyarm table", ["lut"], ["*.lut"]
    of = staticmethod(lambda text: TableText(text).coloured())
