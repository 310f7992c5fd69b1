"""The parts of a row: words, names, numbers, and composite parts.

Each part defines how it is read (through a cursor, from which completion follows), how it is
printed, the names it mentions, and its form in a table of the syntax.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from types import SimpleNamespace
from typing import Any

from fuzzyarm.base.diagnostic import Word
from fuzzyarm.base.names import quote
from fuzzyarm.base.numbers import number_text
from fuzzyarm.language.phrases import NameKind, Occurrence, declared, of_variable
from fuzzyarm.language.tokens import Cursor, Fault, name_text

Values = dict[str, Any]
"""Fields read so far, by name."""

_NO_SPACE = {",": "before", ":": "before", ")": "before", "(": "both", ".": "both"}
"""Marks without a blank on one side or both."""


class Printed:
    """A line under construction: its columns, and its possible breaks."""

    def __init__(self) -> None:
        self.columns = [""]
        self.breaks: tuple[str, Break] | None = None
        self._no_space = True

    def add(self, text: str, no_space: str = "") -> None:
        """Add a word, after a blank unless it is `no_space` ``before``, or ``both``."""
        if not text:
            return
        blank = not self._no_space and no_space not in ("before", "both")
        self.columns[-1] += f" {text}" if blank else text
        self._no_space = no_space in ("both", "after")

    def column(self) -> None:
        """Begin another column."""
        self.columns.append("")
        self._no_space = True

    def break_off(self, how: Break) -> None:
        """Note that the line continues below if it is too long."""
        self.breaks = self.columns[-1], how
        self.columns[-1] = ""
        self._no_space = True

    @property
    def text(self) -> str:
        """The line, or lines."""
        rest = " ".join(filter(None, self.columns))
        if self.breaks is None:
            return rest
        first, how = self.breaks
        whole = f"{first} {rest}"
        return whole if len(whole) <= how.width else f"{first}\n{how.margin}{rest}"


class Part:
    """One part of a row; the base class reads, prints and mentions nothing."""

    def read(self, cursor: Cursor, values: Values) -> None:
        """Take it from the cursor into `values`."""

    def show(self, node: Any, line: Printed) -> None:
        """Print it of a node."""

    def sketch(self, line: Printed) -> None:
        """Add its notation to a line of a table of the syntax."""

    def mentions(self, node: Any) -> Iterator[Occurrence]:
        """Yield the names in it."""
        return iter(())

    def fields(self) -> Iterator[tuple[str, Any]]:
        """Yield the fields that it reads, each with its value when absent."""
        return iter(())

    def words(self) -> Iterator[tuple[str, str]]:
        """Yield the words of the language in it, each with its line of help."""
        return iter(())


# --- Words of the language ---


class Keyword(Part):
    """The word that starts the line; kept where two statements share a node."""

    def __init__(self, word: str, field: str = "", width: int = 0) -> None:
        self.word, self.field, self.width = word, field, width

    def read(self, cursor: Cursor, values: Values) -> None:
        """Take the word, and note it where two statements share a node."""
        token = cursor.take()
        if self.field:
            values[self.field] = token.text

    def show(self, node: Any, line: Printed) -> None:
        """Print the word."""
        line.add(f"{getattr(node, self.field) if self.field else self.word:<{self.width}}")


class FixedText(Part):
    """A mandatory word or mark; `where` completes *expected 'x' …*."""

    def __init__(self, text: str, where: str = "", doc: str = "") -> None:
        self.text, self.where, self.doc = text, where, doc

    def read(self, cursor: Cursor, values: Values) -> None:
        """Demand the text."""
        where = self.where.format(**values) if "{" in self.where else self.where
        cursor.expect(self.text, where)

    def show(self, node: Any, line: Printed) -> None:
        """Print the text."""
        line.add(self.text, _NO_SPACE.get(self.text, ""))

    def sketch(self, line: Printed) -> None:
        """Add its notation."""
        line.add(self.text, _NO_SPACE.get(self.text, ""))

    def words(self) -> Iterator[tuple[str, str]]:
        """Yield its words of the language."""
        if self.text.isalpha():
            yield self.text, self.doc


class Flag(Part):
    """An optional word."""

    def __init__(self, field: str, text: str, doc: str = "") -> None:
        self.field, self.text, self.doc = field, text, doc

    def read(self, cursor: Cursor, values: Values) -> None:
        """Note whether the word follows."""
        values[self.field] = cursor.accept(self.text) is not None

    def show(self, node: Any, line: Printed) -> None:
        """Print the word, if it is set."""
        if getattr(node, self.field):
            line.add(self.text)

    def sketch(self, line: Printed) -> None:
        """Add its notation."""
        line.add(f"[{self.text}]")

    def fields(self) -> Iterator[tuple[str, Any]]:
        """Yield its fields."""
        yield self.field, False

    def words(self) -> Iterator[tuple[str, str]]:
        """Yield its words of the language."""
        yield self.text, self.doc


class Column(Part):
    """The start of a column aligned with neighbouring lines."""

    def show(self, node: Any, line: Printed) -> None:
        """Begin a column."""
        line.column()


class Break(Part):
    """Where a line longer than `width` continues on a line of its own."""

    def __init__(self, width: int, margin: str) -> None:
        self.width, self.margin = width, margin

    def show(self, node: Any, line: Printed) -> None:
        """Mark the break."""
        line.break_off(self)


class Suggest(Part):
    """Names a longer phrase possible here, for an editor to offer."""

    def __init__(self, what: str, about: tuple[str, ...] = ()) -> None:
        self.what, self.about = what, about

    def read(self, cursor: Cursor, values: Values) -> None:
        """Offer the phrase."""
        cursor.suggest(self.what, *self.about)


# --- Names, numbers, strings ---

Mention = Callable[[Word, Any], Occurrence]
"""Returns the occurrence of a name, from the name and its node."""


class Name(Part):
    """A name; `what` completes *expected …*."""

    def __init__(
        self,
        field: str,
        what: str,
        mention: Mention | None = None,
        label: str = "NAME",
        suggest: str = "",
        empty: Any = None,
    ) -> None:
        self.field, self.what, self.mention = field, what, mention
        self.label, self.suggest, self.empty = label, suggest, empty

    def read(self, cursor: Cursor, values: Values) -> None:
        """Take a name."""
        if self.suggest:
            cursor.suggest(self.suggest)
        values[self.field] = cursor.name(self.what.format(**values))

    def show(self, node: Any, line: Printed) -> None:
        """Print the name, in quotes if it needs them."""
        line.add(name_text(getattr(node, self.field)))

    def sketch(self, line: Printed) -> None:
        """Add its notation."""
        line.add(self.label)

    def mentions(self, node: Any) -> Iterator[Occurrence]:
        """Yield the names in it."""
        if self.mention is not None:
            yield self.mention(getattr(node, self.field), node)

    def fields(self) -> Iterator[tuple[str, Any]]:
        """Yield its fields."""
        yield self.field, self.empty


def _of_variable(word: Word, node: Any) -> Occurrence:
    return of_variable(word)


class VariableName(Name):
    """The name of a variable: of an ``input``, an ``output`` or either; see `Cursor.variable`."""

    def __init__(
        self,
        field: str,
        what: str,
        mention: Mention | None = _of_variable,
        label: str = "VARIABLE",
        *,
        role: str = "",
        follow: str = "",
        empty: Any = None,
    ) -> None:
        super().__init__(field, what, mention, label, empty=empty)
        self.role, self.follow = role, follow

    def read(self, cursor: Cursor, values: Values) -> None:
        """Take the name of a variable."""
        values[self.field] = cursor.variable(self.what, self.role, self.follow)


class Number(Part):
    """A number, or a word in its place."""

    def __init__(
        self, field: str, what: str, label: str = "N", *, finite: bool = True, or_word: str = ""
    ) -> None:
        self.field, self.finite, self.or_word = field, finite, or_word
        self.what = f"{what} or '{or_word}'" if or_word else what
        self.label = f"{label}|{or_word}" if or_word else label

    def read(self, cursor: Cursor, values: Values) -> None:
        """Take the number, or the word in its place."""
        word = cursor.accept(self.or_word, likely=True) if self.or_word else None
        values[self.field] = (
            cursor.figure(self.what, finite=self.finite)
            if word is None
            else Word(word.text, word.span)
        )

    def show(self, node: Any, line: Printed) -> None:
        """Print the number, or the word."""
        value = getattr(node, self.field)
        if value is not None:
            line.add(value if isinstance(value, str) else number_text(value))

    def sketch(self, line: Printed) -> None:
        """Add its notation."""
        line.add(self.label)

    def words(self) -> Iterator[tuple[str, str]]:
        """Yield its words of the language."""
        if self.or_word:
            yield self.or_word, "the last value"

    def fields(self) -> Iterator[tuple[str, Any]]:
        """Yield its fields."""
        yield self.field, None


class IntervalPart(Part):
    """``LOW .. HIGH``, two numbers in one field; `where` completes *expected '..' …*."""

    def __init__(
        self, field: str, low: str, high: str, where: str, label: str = "LOW .. HIGH"
    ) -> None:
        self.field, self.low, self.high, self.where, self.label = field, low, high, where, label

    def read(self, cursor: Cursor, values: Values) -> None:
        """Take both numbers."""
        low = cursor.figure(self.low)
        cursor.expect("..", self.where)
        values[self.field] = low, cursor.figure(self.high)

    def show(self, node: Any, line: Printed) -> None:
        """Print both numbers."""
        low, high = getattr(node, self.field)
        line.add(f"{number_text(low)} .. {number_text(high)}")

    def sketch(self, line: Printed) -> None:
        """Add its notation."""
        line.add(self.label)

    def fields(self) -> Iterator[tuple[str, Any]]:
        """Yield its fields."""
        yield self.field, None


class Text(Part):
    """A string in double quotes; optional unless `what` describes the expectation."""

    def __init__(self, field: str, what: str = "", label: str = '"description"') -> None:
        self.field, self.what, self.label = field, what, label

    def read(self, cursor: Cursor, values: Values) -> None:
        """Take the string; a mandatory one is demanded."""
        text = cursor.string()
        if text is None and self.what:
            cursor.fail(self.what)
        values[self.field] = text

    def show(self, node: Any, line: Printed) -> None:
        """Print the string."""
        text = getattr(node, self.field)
        if text is not None:
            line.add(quote(text, '"'))

    def sketch(self, line: Printed) -> None:
        """Add its notation."""
        line.add(self.label)

    def fields(self) -> Iterator[tuple[str, Any]]:
        """Yield its fields."""
        yield self.field, None


class Phrase(Part):
    """A phrase with its own reader and printer: a shape, a sum, an antecedent.

    Parameters
    ----------
    field : str
        Field of the node.
    read : callable
        From the cursor to the value.
    label : str
        In a table of the syntax.
    show : callable, optional
        From the value to its text; ``str`` by default. Empty values are not printed.
    mentions : callable, optional
        From the value to its names; by default the value's own `mentions`, if it has them.
    empty : object, optional
        Value of the field without the phrase.
    words : mapping, optional
        Its words of the language.
    no_space : str, optional
        ``before`` for no blank before it.
    """

    def __init__(
        self,
        field: str,
        read: Callable[[Cursor], Any],
        label: str,
        show: Callable[[Any], str] = str,
        mentions: Callable[[Any], Iterator[Occurrence]] | None = None,
        *,
        empty: Any = None,
        words: Mapping[str, str] | None = None,
        no_space: str = "",
    ) -> None:
        self.field, self.label, self.empty, self.no_space = field, label, empty, no_space
        self._read, self._show, self._mentions = read, show, mentions
        self._words = words or {}

    def read(self, cursor: Cursor, values: Values) -> None:
        """Call the reader of the phrase."""
        values[self.field] = self._read(cursor)

    def show(self, node: Any, line: Printed) -> None:
        """Call the printer of the phrase."""
        value = getattr(node, self.field)
        if value is not None:
            line.add(self._show(value), self.no_space)

    def sketch(self, line: Printed) -> None:
        """Add its notation."""
        line.add(self.label, self.no_space)

    def mentions(self, node: Any) -> Iterator[Occurrence]:
        """Yield the names in it."""
        value = getattr(node, self.field)
        if self._mentions is not None:
            yield from self._mentions(value)
        elif hasattr(value, "mentions"):
            yield from value.mentions()

    def fields(self) -> Iterator[tuple[str, Any]]:
        """Yield its fields."""
        yield self.field, self.empty

    def words(self) -> Iterator[tuple[str, str]]:
        """Yield its words of the language."""
        yield from self._words.items()


# --- Parts of parts ---


class Several(Part):
    """One or more of a part, separated by a mark; unless `stop` follows the mark."""

    def __init__(
        self, part: Any, between: tuple[str, ...] = (",",), stop: str = "", label: str = ""
    ) -> None:
        self.part, self.between, self.stop, self.label = part, between, stop, label

    def read(self, cursor: Cursor, values: Values) -> None:
        """Take items as long as a mark follows."""
        items = [self._one(cursor, values)]
        while self._more(cursor):
            items.append(self._one(cursor, values))
        values[self.part.field] = tuple(items)

    def _one(self, cursor: Cursor, values: Values) -> Any:
        # Each item is read into the same field: into a copy, so that none sees the one before.
        fields_read = dict(values)
        self.part.read(cursor, fields_read)
        return fields_read[self.part.field]

    def _more(self, cursor: Cursor) -> bool:
        if self.stop and cursor.next_is(self.stop, 1):
            return False
        return any(cursor.accept(mark) for mark in self.between)

    def show(self, node: Any, line: Printed) -> None:
        """Print the items with the first mark between them."""
        for index, item in enumerate(getattr(node, self.part.field)):
            if index:
                line.add(self.between[0], _NO_SPACE.get(self.between[0], ""))
            self.part.show(_Holder(node, self.part.field, item), line)

    def sketch(self, line: Printed) -> None:
        """Add its notation."""
        if self.label:
            line.add(self.label)
        else:
            self.part.sketch(line)

    def mentions(self, node: Any) -> Iterator[Occurrence]:
        """Yield the names in it."""
        for item in getattr(node, self.part.field):
            # A part reads its field from a node, so each item replaces the field.
            yield from self.part.mentions(_Holder(node, self.part.field, item))

    def fields(self) -> Iterator[tuple[str, Any]]:
        """Yield its fields."""
        yield self.part.field, ()

    def words(self) -> Iterator[tuple[str, str]]:
        """Yield its words of the language."""
        return self.part.words()  # type: ignore[no-any-return]


class _Holder:
    """A view of a node with another value in one of its fields."""

    __slots__ = ("_field", "_item", "_node")

    def __init__(self, node: Any, field: str, item: Any) -> None:
        self._node, self._field, self._item = node, field, item

    def __getattr__(self, name: str) -> Any:
        return self._item if name == self._field else getattr(self._node, name)


def read_parts(parts: Sequence[Part], cursor: Cursor, values: Values) -> None:
    """Read parts in order; after a fault the cursor has the names in those before it."""
    for index, part in enumerate(parts):
        try:
            part.read(cursor, values)
        except Fault:
            note_names(parts[:index], cursor, values)
            raise


def note_names(parts: Sequence[Part], cursor: Cursor, values: Values) -> None:
    """Note the names in parts of a damaged statement."""
    node = SimpleNamespace(**values)
    cursor.mentioned += [name for part in parts for name in part.mentions(node)]


class _Together(Part):
    """Parts read and printed one after the other."""

    parts: tuple[Part, ...]

    def read(self, cursor: Cursor, values: Values) -> None:
        read_parts(self.parts, cursor, values)

    def show(self, node: Any, line: Printed) -> None:
        for part in self.parts:
            part.show(node, line)

    def sketch(self, line: Printed) -> None:
        for part in self.parts:
            part.sketch(line)

    def mentions(self, node: Any) -> Iterator[Occurrence]:
        for part in self.parts:
            yield from part.mentions(node)

    def fields(self) -> Iterator[tuple[str, Any]]:
        for part in self.parts:
            yield from part.fields()

    def words(self) -> Iterator[tuple[str, str]]:
        for part in self.parts:
            yield from part.words()


class Maybe(_Together):
    """Optional parts that begin with a mark; `flag` records their presence."""

    def __init__(self, *parts: Part, flag: str = "", likely: bool = False) -> None:
        self.parts, self.flag, self.likely = parts, flag, likely
        assert isinstance(parts[0], FixedText)
        self.first, self.where = parts[0].text, parts[0].where

    def read(self, cursor: Cursor, values: Values) -> None:
        """Take the parts if their mark follows."""
        here = cursor.accept(self.first, likely=self.likely) is not None
        # Absent parts have values, too, since the node needs all its fields.
        for name, empty in self.fields():
            values.setdefault(name, empty)
        if here:
            self.read_rest(cursor, values)

    def read_rest(self, cursor: Cursor, values: Values) -> None:
        """Read the part after the first mark."""
        if self.flag:
            values[self.flag] = True
        for part in self.parts[1:]:
            part.read(cursor, values)

    def is_in(self, node: Any) -> bool:
        """Whether a node has it."""
        value = getattr(node, self.flag or next(name for name, _ in self.fields()))
        return value is not None and value is not False and value != ()

    def show(self, node: Any, line: Printed) -> None:
        """Print the parts of a node that has them."""
        if self.is_in(node):
            super().show(node, line)

    def sketch(self, line: Printed) -> None:
        """Add its notation."""
        inner = Printed()
        super().sketch(inner)
        no_space = _NO_SPACE.get(self.first, "")
        line.add(f"[{''.join(inner.columns)}]", no_space)

    def mentions(self, node: Any) -> Iterator[Occurrence]:
        """Yield the names in it."""
        if self.is_in(node):
            yield from super().mentions(node)

    def fields(self) -> Iterator[tuple[str, Any]]:
        """Yield its fields."""
        if self.flag:
            yield self.flag, False
        yield from super().fields()


class OptionParts(Part):
    """Options after commas, in any order; each begins with its word, or several with one."""

    def __init__(self, *options: Maybe) -> None:
        self.options = options

    def read(self, cursor: Cursor, values: Values) -> None:
        """Take options as long as commas follow."""
        values.update(self.fields())
        while cursor.accept(","):
            with cursor.up_to(","):
                _chosen(self.options, cursor, "after the comma").read_rest(cursor, values)

    def show(self, node: Any, line: Printed) -> None:
        """Print the options, in the order of the row."""
        for option in self.options:
            if option.is_in(node):
                line.add(",", "before")
                option.show(node, line)

    def sketch(self, line: Printed) -> None:
        """Add its notation."""
        for option in self.options:
            inner = Printed()
            _Together.sketch(option, inner)
            line.add(f"[, {''.join(inner.columns)}]", "before")

    def mentions(self, node: Any) -> Iterator[Occurrence]:
        """Yield the names in it."""
        for option in self.options:
            yield from option.mentions(node)

    def fields(self) -> Iterator[tuple[str, Any]]:
        """Yield its fields."""
        for option in self.options:
            yield from option.fields()

    def words(self) -> Iterator[tuple[str, str]]:
        """Yield its words of the language."""
        for option in self.options:
            yield from option.words()


def _chosen(options: Sequence[Maybe], cursor: Cursor, where: str) -> Maybe:
    """Take the word of an option; of several with that word, continue with the intended one."""
    by_word: dict[str, list[Maybe]] = {}
    for option in options:
        by_word.setdefault(option.first, []).append(option)
    what = " or ".join(f"'{word}'" for word in sorted(by_word)) + f" {where}"
    word = cursor.word(what, by_word, "unexpected-token")
    first, *others = by_word[word]
    rests = [Maybe(*option.parts[1:]) for option in (first, *others)] if others else []
    return _chosen(rests, cursor, f"after '{word}'") if rests else first


class Forgiving(_Together):
    """Parts after a declared name, which is declared even if they are faulty.

    Faulty parts count as missing; with `finish` the line ends with them.
    """

    def __init__(self, *parts: Part, finish: bool = False) -> None:
        self.parts, self.finish = parts, finish

    def read(self, cursor: Cursor, values: Values) -> None:
        """Take the parts; after a fault all their fields are empty."""
        damaged_before, cursor.is_damaged = cursor.is_damaged, False
        try:
            super().read(cursor, values)
            if cursor.is_damaged:
                note_names(self.parts, cursor, values)
            if self.finish:
                cursor.finish()
        except Fault as fault:
            cursor.forgive(fault)
        if cursor.is_damaged:
            # Also fields read before the fault: half a range is not a range.
            values.update(self.fields())
        cursor.is_damaged = damaged_before


class OneOf(Part):
    """A word, and the parts that follow it."""

    def __init__(
        self,
        field: str,
        what: str,
        finding: str,
        docs: Mapping[str, str],
        cases: Mapping[str, tuple[Part, ...]],
    ) -> None:
        self.field, self.what, self.finding = field, what, finding
        self.docs, self.cases = docs, cases

    def read(self, cursor: Cursor, values: Values) -> None:
        """Take the word, then its parts."""
        values[self.field] = word = cursor.word(self.what, self.cases, self.finding)
        read_parts(self.cases[word], cursor, values)

    def show(self, node: Any, line: Printed) -> None:
        """Print the word, then its parts."""
        line.add(getattr(node, self.field))
        for part in self.cases[getattr(node, self.field)]:
            part.show(node, line)

    def mentions(self, node: Any) -> Iterator[Occurrence]:
        """Yield the names in it."""
        for part in self.cases[getattr(node, self.field)]:
            yield from part.mentions(node)

    def words(self) -> Iterator[tuple[str, str]]:
        """Yield its words of the language."""
        yield from self.docs.items()
        for parts in self.cases.values():
            for part in parts:
                yield from part.words()


def declares(kind: NameKind) -> Mention:
    """Return a mention that declares the name."""
    return lambda word, node: declared(kind, word)


def refers(kind: NameKind) -> Mention:
    """Return a mention that refers to a name declared elsewhere."""
    return lambda word, node: Occurrence(kind, word, word.span)
