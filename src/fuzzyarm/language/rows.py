"""A statement as a row of parts, which read it, print it, find its names and show its syntax.

A :class:`StatementRow` names a node, a plain record of fields, and the parts of its line in order
(:mod:`fuzzyarm.language.parts`). The functions for any node are at the end.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from fuzzyarm.language.parts import Column, Part, Printed, Values, read_parts
from fuzzyarm.language.phrases import Occurrence, aligned
from fuzzyarm.language.tokens import Cursor, Fault, Trivia

# --- Nodes in nodes ---


class Inside(Part):
    """A separate node, which has a row."""

    def __init__(self, field: str, row: StatementRow) -> None:
        self.field, self.row = field, row

    def read(self, cursor: Cursor, values: Values) -> None:
        """Take the node, by its row."""
        values[self.field] = self.row.read(cursor)

    def show(self, node: Any, line: Printed) -> None:
        """Print the node, by its row."""
        for part in self.row.parts:
            part.show(getattr(node, self.field), line)

    def sketch(self, line: Printed) -> None:
        """Add its notation."""
        for part in self.row.parts:
            part.sketch(line)

    def mentions(self, node: Any) -> Iterator[Occurrence]:
        """Yield the names in it."""
        return self.row.mentions(getattr(node, self.field))

    def fields(self) -> Iterator[tuple[str, Any]]:
        """Yield its fields."""
        yield self.field, None

    def words(self) -> Iterator[tuple[str, str]]:
        """Yield its words of the language."""
        for part in self.row.parts:
            yield from part.words()


class Lines(Part):
    """The lines below the statement, each a separate node.

    A faulty one is left out, and noted in the field `unread`.
    """

    def __init__(self, field: str, row: StatementRow, unread: str) -> None:
        self.field, self.row, self.unread = field, row, unread

    def read(self, cursor: Cursor, values: Values) -> None:
        """Take each line below as a node."""
        cursor.finish()
        items = []
        for line in cursor.lines:
            below = Cursor(line.tokens, recovers=cursor.recovers)
            try:
                item = self.row.read_line(below, line.trivia)
                items += [] if below.is_damaged else [item]
            except Fault as fault:
                below.damage(fault)
            cursor.forgiven += below.forgiven
            cursor.mentioned += below.mentioned
        values[self.field] = tuple(items)
        values[self.unread] = len(items) < len(cursor.lines)

    def below(self, node: Any) -> list[tuple[str, Trivia]]:
        """Return the lines, aligned."""
        items = getattr(node, self.field)
        lines = aligned([self.row.columns(item) for item in items])
        return list(zip(lines, (item.trivia for item in items), strict=True))

    def mentions(self, node: Any) -> Iterator[Occurrence]:
        """Yield the names in it."""
        for item in getattr(node, self.field):
            yield from self.row.mentions(item)

    def words(self) -> Iterator[tuple[str, str]]:
        """Yield its words of the language."""
        yield from self.row.words.items()


# --- Rows ---

ROWS: dict[type, StatementRow] = {}
"""The rows of nodes, by node."""


class StatementRow:
    """A node and the parts of its line.

    Parameters
    ----------
    node : type
        Class made of the fields that the parts read, and of ``span`` if it has that.
    parts : Part
        In order.
    indent : str, optional
        Indentation of the line.
    gap : str, optional
        Between columns, where neighbours of the kind are aligned.
    """

    def __init__(self, node: type[Any], *parts: Part, indent: str = "", gap: str = "  ") -> None:
        self.node, self.parts, self.indent, self.gap = node, parts, indent, gap
        self._spans = "span" in getattr(node, "__annotations__", ())
        ROWS[node] = self

    def read(self, cursor: Cursor) -> Any:
        """Read the node; a :class:`~fuzzyarm.language.tokens.Fault` if unreadable."""
        values: Values = {}
        read_parts(self.parts, cursor, values)
        if self._spans:
            values["span"] = cursor.whole
        return self.node(**values)

    def read_line(self, cursor: Cursor, trivia: Trivia) -> Any:
        """Read a node that is a line below another, with the comments around it."""
        node = self.read(cursor)
        if cursor.is_damaged or not cursor.at_end:
            cursor.mentioned += self.mentions(node)
        cursor.finish()
        return node._replace(trivia=trivia)

    def _printed(self, node: Any) -> Printed:
        line = Printed()
        for part in self.parts:
            part.show(node, line)
        return line

    def text(self, node: Any) -> str:
        """Return the text of a node."""
        return self.indent + self._printed(node).text

    def columns(self, node: Any) -> list[str]:
        """Return the cells to align with neighbouring lines."""
        columns = self._printed(node).columns
        while len(columns) > 1 and not columns[-1]:
            columns.pop()
        return columns

    @cached_property
    def in_columns(self) -> bool:
        """Whether neighbours are aligned."""
        return any(isinstance(part, Column) for part in _all_parts(self.parts))

    def below(self, node: Any) -> list[tuple[str, Trivia]] | None:
        """Return the lines below; None if the statement takes none."""
        lines_below = [part.below(node) for part in self.parts if isinstance(part, Lines)]
        return lines_below[0] if lines_below else None

    def mentions(self, node: Any) -> Iterator[Occurrence]:
        """Yield every name."""
        for part in self.parts:
            yield from part.mentions(node)

    @property
    def syntax(self) -> str:
        """The form after the first word, in a table of the language."""
        sketch = Printed()
        for part in self.parts:
            part.sketch(sketch)
        return sketch.text

    @property
    def words(self) -> dict[str, str]:
        """The other words of the language in it, each with its line of help."""
        return {word: doc for part in self.parts for word, doc in part.words()}


def _all_parts(parts: Sequence[Part]) -> Iterator[Part]:
    for part in parts:
        yield part
        yield from _all_parts(getattr(part, "parts", ()))


class ByHand(StatementRow):
    """A node with its own ``read``, ``__str__`` and ``mentions``, not a line of parts."""

    def __init__(self, node: type[Any], syntax: str, words: Mapping[str, str]) -> None:
        super().__init__(node)
        self._syntax, self._words = syntax, words

    def read(self, cursor: Cursor) -> Any:
        """Call the reader of the node."""
        return self.node.read(cursor)

    def text(self, node: Any) -> str:
        """Return its text."""
        return str(node)

    def below(self, node: Any) -> list[tuple[str, Trivia]] | None:
        """Return the lines below."""
        lines_below: list[tuple[str, Trivia]] | None = (
            node.below() if hasattr(node, "below") else None
        )
        return lines_below

    def mentions(self, node: Any) -> Iterator[Occurrence]:
        """Yield the names in it."""
        yield from node.mentions()

    @property
    def syntax(self) -> str:
        """The form after the first word."""
        return self._syntax

    @property
    def words(self) -> dict[str, str]:
        """The other words of the language in it, each with its line of help."""
        return dict(self._words)


@dataclass(frozen=True)
class StatementKind:
    """A record: the word that starts a statement, its row, and its help.

    Attributes
    ----------
    word : str
        At the start of the line.
    doc : str
        One line.
    row : StatementRow
        Its node and its parts.
    outline : str
        Its name in the outline of a file; empty if it is not in the outline.
    takes_lines : bool
        Whether lines below belong to it.
    """

    word: str
    doc: str
    row: StatementRow
    outline: str = ""
    takes_lines: bool = False

    @property
    def node(self) -> type[Any]:
        """The type of its nodes."""
        return self.row.node

    @property
    def syntax(self) -> str:
        """The form after the word."""
        return self.row.syntax

    @property
    def words(self) -> dict[str, str]:
        """Other words of the language in it, each with one line of help."""
        return self.row.words


# --- Any node ---


def text_of(node: Any) -> str:
    """Return the text of a node."""
    return ROWS[type(node)].text(node)


def sentence(node: Any) -> str:
    """Return the part after the first word of a node, on one line."""
    # A long rule is broken; a grid has its rows.
    lines = text_of(node).split("\n")
    return " ".join(line.strip() for line in lines).split(" ", 1)[1]


def columns_of(node: Any) -> list[str]:
    """Return the cells to align with neighbouring lines."""
    return ROWS[type(node)].columns(node)


def lines_below(node: Any) -> list[tuple[str, Trivia]] | None:
    """Return the lines of a statement that takes lines, aligned; None for others."""
    row = ROWS.get(type(node))
    return None if row is None else row.below(node)


def mentions(node: Any) -> Iterator[Occurrence]:
    """Yield every name in a statement; none of an unreadable one."""
    row = ROWS.get(type(node))
    return iter(()) if row is None else row.mentions(node)
