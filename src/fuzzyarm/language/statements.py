"""The statements of the language: a record each, and a node that reads and writes itself.

:data:`STATEMENTS` is the whole language at a glance. From a record and its node follow the
reader (``read``), the canonical text (``str``, ``in_columns``, ``below``), what an editor offers
(``read`` again, asked where the tokens end), colours, help and the grammar of the editor's
extension (the words of the record), and renaming and the outline (``mentions``).

To add a statement: write its node below (those of rules are in :mod:`fuzzyarm.language.rules`),
add its record to :data:`STATEMENTS`, and say what it means in
:func:`fuzzyarm.language.meaning.elaborate`. A node is a NamedTuple that ends with its span and has

- ``read(cursor)``, a class method: a :class:`~fuzzyarm.language.tokens.Fault` where it cannot be
  read; ``cursor.variable`` and ``cursor.term`` rather than ``cursor.name`` for what is declared
  elsewhere, so that completion knows;
- ``__str__``: one line; ``in_columns`` instead where neighbours of its kind are aligned, and
  ``below`` too where it takes lines;
- ``mentions()``: the names in it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any, NamedTuple, Protocol

from fuzzyarm.language.phrases import (
    Kind,
    Occurrence,
    SettingNode,
    ShapeNode,
    aligned,
    declared,
    of_variable,
)
from fuzzyarm.language.rules import CellNode, GridNode, RowNode, RuleNode
from fuzzyarm.language.tokens import STARTERS, Cursor, Fault, Figure, Trivia, Word
from fuzzyarm.language.tune import TUNE_ITEMS, TUNE_WORDS, TuneNode
from fuzzyarm.model.shapes import EVEN_SHAPES
from fuzzyarm.text.diagnostic import NOWHERE, Span
from fuzzyarm.text.names import quote

__all__ = [
    "STATEMENTS",
    "BlockNode",
    "Broken",
    "CellNode",
    "EvenTermsNode",
    "ExpectNode",
    "GridNode",
    "Heading",
    "InferenceNode",
    "LookupItem",
    "LookupNode",
    "OutcomeNode",
    "ProveNode",
    "RowNode",
    "RuleNode",
    "StatementKind",
    "StatementNode",
    "StretchNode",
    "TermNode",
    "TuneNode",
    "VariableNode",
]


class StatementNode(Protocol):
    """What every statement has."""

    @property
    def span(self) -> Span:
        """From its first to its last token, without the lines below it."""

    def mentions(self) -> Iterator[Occurrence]:
        """Yield every name in the statement."""


class StatementKind(NamedTuple):
    """A record: the word that starts a statement, its node, and what a person is told of it.

    Attributes
    ----------
    word : str
        At the start of the line.
    node : type
        Reads and writes the statement.
    syntax : str
        What follows the word.
    doc : str
        One line.
    words : mapping of str to str
        Other words of the language in it, each with one line of help, empty for the obvious.
    takes_lines : bool
        Whether lines below belong to it.
    outline : str
        What the outline of a file calls it; empty where it has no part in the outline.
    """

    word: str
    node: type[Any]
    syntax: str
    doc: str
    words: Mapping[str, str] = MappingProxyType({})
    takes_lines: bool = False
    outline: str = ""


# --- Declarations ---


class Heading(NamedTuple):
    """``rulebase NAME "description"``."""

    name: Word
    description: str | None
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> Heading:
        """Read it from the cursor."""
        cursor.take()
        return cls(cursor.name("the name of the rule base"), cursor.string(), cursor.whole)

    def __str__(self) -> str:
        return " ".join([f"rulebase {self.name}", *_described(self.description)])

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        yield declared(Kind.RULEBASE, self.name)


def _described(description: str | None) -> list[str]:
    return [] if description is None else [quote(description, '"')]


class VariableNode(NamedTuple):
    """``input NAME LOW .. HIGH "description"`` and the same with ``output``.

    The ends are None where the range could not be read.
    """

    role: str
    name: Word
    low: Figure | None
    high: Figure | None
    description: str | None
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> VariableNode:
        """Read it from the cursor."""
        role = cursor.take().text
        name = cursor.name(f"the name of the {role}")
        try:
            cursor.suggest("range")
            low = cursor.figure("the lower end of the range", finite=False)
            cursor.expect("..", "between the ends of the range")
            high = cursor.figure("the upper end of the range", finite=False)
        except Fault as fault:
            cursor.forgive(fault)
            return cls(role, name, None, None, None, cursor.whole)
        return cls(role, name, low, high, cursor.string(), cursor.whole)

    def in_columns(self) -> list[str]:
        """Return the parts that stand below those of neighbours."""
        declaration = f"{self.role:<6} {self.name}"
        return [declaration, f"{self.low} .. {self.high}", *_described(self.description)]

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        yield declared(Kind.VARIABLE, self.name)


class EvenTermsNode(NamedTuple):
    """``terms A, B: triangles T1 T2 …``."""

    variables: tuple[Word, ...]
    family: Word
    names: tuple[Word, ...]
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> EvenTermsNode:
        """Read it from the cursor."""
        cursor.take()
        variables = [cursor.variable("the name of a variable")]
        while cursor.accept(","):
            variables.append(cursor.variable("the name of a variable"))
        cursor.expect(":", "after the variables")
        family = cls._family(cursor)
        names = []
        cursor.suggest("term names")
        while not cursor.at_end:
            names.append(cursor.name("the name of a term"))
        if not names:
            cursor.fail("the names of the terms, from low to high")
        return cls(tuple(variables), family, tuple(names), cursor.whole)

    @staticmethod
    def _family(cursor: Cursor) -> Word:
        token = cursor.peek()
        cursor.suggest("families")
        try:
            families = f"a family of terms ({', '.join(EVEN_SHAPES)})"
            return cursor.word(families, EVEN_SHAPES, "unknown-shape")
        except Fault as fault:
            if token is None or token.kind != "name":
                raise
            finding = fault.diagnostic
            if finding.replacement is not None:  # a misspelt family
                cursor.take()
            else:  # the first term: the family is missing
                finding = replace(finding, replacement=f"triangles {token.text}")
            cursor.forgiven.append(finding)
            return Word("triangles", token.span)

    def __str__(self) -> str:
        variables = ", ".join(map(str, self.variables))
        return f"terms {variables}: {self.family.text} {' '.join(map(str, self.names))}"

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        yield from map(of_variable, self.variables)
        owners = tuple(word.text for word in self.variables)
        yield from (declared(Kind.TERM, word, owners) for word in self.names)


class TermNode(NamedTuple):
    """``term VARIABLE NAME: SHAPE``; no shape where it could not be read."""

    variable: Word
    name: Word
    shape: ShapeNode | None
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> TermNode:
        """Read it from the cursor."""
        cursor.take()
        variable = cursor.variable("the name of a variable")
        name = cursor.name("the name of the term")
        shape: ShapeNode | None = None
        try:
            cursor.expect(":", "after the name of the term")
            read = ShapeNode.read(cursor)
            cursor.finish()
            shape = read
        except Fault as fault:
            cursor.forgive(fault)
        return cls(variable, name, shape, cursor.whole)

    def in_columns(self) -> list[str]:
        """Return the parts that stand below those of neighbours."""
        return [f"term {self.variable} {self.name}:", str(self.shape)]

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        yield of_variable(self.variable)
        yield declared(Kind.TERM, self.name, (self.variable.text,))
        if self.shape is not None:
            yield from self.shape.mentions()


# --- Evaluation ---


class InferenceNode(NamedTuple):
    """``inference [VARIABLE:] key value, …``."""

    target: Word | None
    settings: tuple[SettingNode, ...]
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> InferenceNode:
        """Read it from the cursor."""
        cursor.take()
        target = _read_target(cursor, "the name of a variable")
        return cls(target, SettingNode.read_all(cursor), cursor.whole)

    def __str__(self) -> str:
        target = f"{self.target}: " if self.target else ""
        return f"inference {target}{', '.join(map(str, self.settings))}"

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        if self.target is not None:
            yield of_variable(self.target)


def _read_target(cursor: Cursor, what: str, role: str = "") -> Word | None:
    """Read ``VARIABLE:`` where the next token but one is a colon."""
    cursor.suggest("targets", role)
    second = cursor.peek(1)
    if second is None or second.kind != "mark" or second.text != ":":
        return None
    target = cursor.variable(what, role)
    cursor.take()
    return target


class BlockNode(NamedTuple):
    """``block NAME[: key value, …]``: the rules that follow form a block of their own."""

    name: Word
    settings: tuple[SettingNode, ...]
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> BlockNode:
        """Read it from the cursor."""
        cursor.take()
        name = cursor.name("the name of the block")
        more = cursor.accept(":", likely=True)
        settings = SettingNode.read_all(cursor, "rules") if more else ()
        return cls(name, settings, cursor.whole)

    def __str__(self) -> str:
        settings = f": {', '.join(map(str, self.settings))}" if self.settings else ""
        return f"block {self.name}{settings}"

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        yield declared(Kind.BLOCK, self.name)


# --- Lookup tables and expectations ---

LOOKUP_ITEMS: dict[str, str] = {
    "levels": "the sample points of the lookup table",
    "bins": "thresholds between neighbouring levels",
    "round": "the step that the values of the lookup table are rounded to",
}
"""What a line of ``lookup`` starts with."""


class LookupItem(NamedTuple):
    """One line of a ``lookup`` block.

    `key` is one of LOOKUP_ITEMS. `figures` are the numbers as written; with `form` ``step`` or
    ``count`` they are low, high and the step or the count; with ``list`` the values
    themselves; ``mirrored`` marks bins that are also meant with a minus sign.
    """

    key: Word
    variable: Word | None
    form: str
    figures: tuple[Figure, ...]
    trivia: Trivia = Trivia()
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor, trivia: Trivia) -> LookupItem:
        """Read it from the cursor."""
        key = cursor.word("levels, bins or round", LOOKUP_ITEMS, "unknown-setting")
        variable = None
        if key.text != "round" or cursor.next_is(":", 1):
            variable = _read_target(cursor, "the name of an input", "input")
        form = "list"
        figures = [cursor.figure("a number")]
        if key.text == "levels" and cursor.accept(".."):
            figures.append(cursor.figure("the last level"))
            form = cursor.word("'step' or 'count'", ("step", "count"), "unexpected-token").text
            figures.append(cursor.figure(f"the {form}"))
        while form == "list" and key.text != "round" and cursor.at_figure:
            figures.append(cursor.figure("a number"))
        if key.text == "bins" and cursor.accept("mirrored"):
            form = "mirrored"
        cursor.finish()
        return cls(key, variable, form, tuple(figures), trivia, cursor.whole)

    def in_columns(self) -> list[str]:
        """Return the key and the numbers."""
        values = list(map(str, self.figures))
        if self.form in ("step", "count"):
            body = f"{values[0]} .. {values[1]} {self.form} {values[2]}"
        else:
            body = " ".join(values) + (" mirrored" if self.form == "mirrored" else "")
        return [self.key.text + (f" {self.variable}:" if self.variable else ""), body]


class LookupNode(NamedTuple):
    """The ``lookup`` block."""

    items: tuple[LookupItem, ...]
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> LookupNode:
        """Read it from the cursor."""
        cursor.take()
        cursor.finish()
        items = []
        for line in cursor.lines:
            try:
                items.append(LookupItem.read(Cursor(line.tokens), line.trivia))
            except Fault as fault:
                cursor.forgiven.append(fault.diagnostic)
        return cls(tuple(items), cursor.whole)

    def __str__(self) -> str:
        return "lookup"

    def below(self) -> list[tuple[str, Trivia]]:
        """Return the settings, aligned."""
        lines = aligned([item.in_columns() for item in self.items])
        return list(zip(lines, (item.trivia for item in self.items), strict=True))

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        return (of_variable(item.variable) for item in self.items if item.variable is not None)


RELATIONS = ("=", "<", "<=", ">", ">=", "in")


class OutcomeNode(NamedTuple):
    """``output relation value [within tolerance]`` or ``output in low .. high``."""

    variable: Word
    relation: str
    value: Figure
    other: Figure | None

    @classmethod
    def read(cls, cursor: Cursor) -> OutcomeNode:
        """Read it from the cursor."""
        return cls.read_behind(cursor.variable("the name of an output", "output"), cursor)

    @classmethod
    def read_behind(cls, name: Word, cursor: Cursor, others: Sequence[str] = ()) -> OutcomeNode:
        """Read what stands behind the name of the output; `others` could stand there too."""
        for relation in RELATIONS:
            if cursor.accept(relation, likely=True):
                break
        else:
            cursor.fail("one of " + " ".join((*RELATIONS, *others)), others)
        value = cursor.figure("a number")
        other: Figure | None = None
        if relation == "in":
            cursor.expect("..", "between the ends of the interval")
            other = cursor.figure("a number")
        elif relation == "=" and cursor.accept("within"):
            other = cursor.figure("the tolerance")
        return cls(name, relation, value, other)

    def __str__(self) -> str:
        text = f"{self.variable} {self.relation} {self.value}"
        if self.other is None:
            return text
        return f"{text} {'..' if self.relation == 'in' else 'within'} {self.other}"


class ExpectNode(NamedTuple):
    """``expect input = value, … -> outcome, …``."""

    inputs: tuple[tuple[Word, Figure], ...]
    outcomes: tuple[OutcomeNode, ...]
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> ExpectNode:
        """Read it from the cursor."""
        cursor.take()
        inputs = [cls._assignment(cursor)]
        cursor.suggest("comma")
        while cursor.accept(","):
            inputs.append(cls._assignment(cursor))
            cursor.suggest("comma")
        cursor.expect("->", "after the inputs")
        outcomes = [OutcomeNode.read(cursor)]
        while cursor.accept(","):
            outcomes.append(OutcomeNode.read(cursor))
        return cls(tuple(inputs), tuple(outcomes), cursor.whole)

    @staticmethod
    def _assignment(cursor: Cursor) -> tuple[Word, Figure]:
        name = cursor.variable("the name of an input", "input", " =")
        cursor.expect("=", f"after '{name.text}'")
        return name, cursor.figure("a number")

    def __str__(self) -> str:
        inputs = ", ".join(f"{name} = {value}" for name, value in self.inputs)
        return f"expect {inputs} -> {', '.join(map(str, self.outcomes))}"

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        yield from (of_variable(word) for word, _ in self.inputs)
        yield from (of_variable(outcome.variable) for outcome in self.outcomes)


_VERBS = ("rises", "falls", "slope", "odd", "covered")

TABLE_MODES = ("linear", "nearest", "bins")
"""How a table whose error is proved is looked up."""


class StretchNode(NamedTuple):
    """``input in low .. high``: a part of the box of a property."""

    variable: Word
    low: Figure
    high: Figure

    def __str__(self) -> str:
        return f"{self.variable} in {self.low} .. {self.high}"


class ProveNode(NamedTuple):
    """``prove [input in low .. high, … ->] claim``.

    `verb` is ``value`` (with an outcome), one of the verbs, or ``table``; `low` and `high` are
    those of a slope, `high` alone is the error of a table. No output: that of the file.
    """

    region: tuple[StretchNode, ...]
    verb: str
    output: Word | None
    outcome: OutcomeNode | None = None
    input: Word | None = None
    low: Figure | None = None
    high: Figure | None = None
    mode: Word | None = None
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor) -> ProveNode:
        """Read it from the cursor."""
        cursor.take()
        region: list[StretchNode] = []
        arrow = False
        while True:
            claim = cls._table(cursor) if cursor.accept("table") else None
            if claim is None:
                role = "output" if arrow else ""
                what = "the name of an output" if arrow else "the name of an output or an input"
                name = cursor.variable(what, role)
                claim = cls._claim(name, cursor)
            joined = not arrow and claim.outcome is not None and claim.outcome.relation == "in"
            if joined and (cursor.accept(",") or (arrow := bool(cursor.accept("->", likely=True)))):
                assert claim.outcome is not None
                low, high = claim.outcome.value, claim.outcome.other
                assert high is not None
                region.append(StretchNode(claim.outcome.variable, low, high))
                continue
            if region and not arrow:
                cursor.fail("'->' between the inputs and what is claimed")
            return claim._replace(region=tuple(region), span=cursor.whole)

    @classmethod
    def _claim(cls, name: Word, cursor: Cursor) -> ProveNode:
        for verb in _VERBS:
            if not cursor.accept(verb):
                continue
            if verb in ("rises", "falls"):
                cursor.expect("with", f"after '{verb}'")
                return cls((), verb, name, input=cursor.variable("the name of an input", "input"))
            if verb != "slope":
                return cls((), verb, name)
            by = cursor.variable("the name of an input", "input", " in")
            cursor.expect("in", "after the input")
            low = cursor.figure("the lowest slope")
            cursor.expect("..", "between the ends of the interval")
            return cls((), verb, name, input=by, low=low, high=cursor.figure("the highest slope"))
        return cls((), "value", name, OutcomeNode.read_behind(name, cursor, _VERBS))

    @classmethod
    def _table(cls, cursor: Cursor) -> ProveNode:
        output = None
        if cursor.next_is("of"):
            cursor.take()
            output = cursor.variable("the name of an output", "output")
        mode = cursor.word("linear, nearest or bins", TABLE_MODES, "unexpected-token")
        cursor.expect("within", "before the worst error")
        return cls((), "table", output, high=cursor.figure("the worst error"), mode=mode)

    def __str__(self) -> str:
        region = ", ".join(map(str, self.region)) + " -> " if self.region else ""
        return f"prove {region}{self.claim}"

    @property
    def claim(self) -> str:
        """What is claimed, without the region."""
        if self.verb == "table":
            of = "" if self.output is None else f"of {self.output} "
            return f"table {of}{self.mode} within {self.high}"
        if self.outcome is not None:
            text = str(self.outcome)
        else:
            by = {"rises": f" with {self.input}", "falls": f" with {self.input}"}
            by["slope"] = f" {self.input} in {self.low} .. {self.high}"
            text = f"{self.output} {self.verb}{by.get(self.verb, '')}"
        # An output of this name would be read as the word.
        return f"'table'{text.removeprefix('table')}" if text.startswith("table ") else text

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        yield from (of_variable(stretch.variable) for stretch in self.region)
        yield from (of_variable(word) for word in (self.output, self.input) if word is not None)


class Broken(NamedTuple):
    """A statement that could not be read; `keyword` is its first word, if that was one."""

    keyword: str
    span: Span = NOWHERE

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        return iter(())


# --- The records ---

_JOINS = {"is": "", "and": "", "or": ""}

STATEMENTS: dict[str, StatementKind] = {
    record.word: record
    for record in (
        StatementKind(
            "rulebase",
            Heading,
            'NAME "description"',
            "the name of the rule base and what it is for",
            outline="rulebase",
        ),
        StatementKind(
            "input",
            VariableNode,
            'NAME LOW .. HIGH "description"',
            "an input variable and its range",
            outline="input",
        ),
        StatementKind(
            "output",
            VariableNode,
            'NAME LOW .. HIGH "description"',
            "an output variable and its range",
            outline="output",
        ),
        StatementKind(
            "terms",
            EvenTermsNode,
            "VARIABLE, VARIABLE: FAMILY NAME NAME …",
            "evenly spaced terms of one or more variables",
        ),
        StatementKind(
            "term",
            TermNode,
            "VARIABLE NAME: SHAPE NUMBERS [height H] [over SHAPE NUMBERS [height H]]",
            "one term with its shape; of interval type 2 with an upper one over a lower one",
            {
                "height": "a factor on the whole shape",
                "over": "the lower membership function of an interval type-2 term follows",
            },
        ),
        StatementKind(
            "inference",
            InferenceNode,
            "[VARIABLE:] KEY VALUE, KEY VALUE …",
            "how rules are evaluated",
            {"exact": "the integral itself, without samples"},
        ),
        StatementKind(
            "block",
            BlockNode,
            "NAME: KEY VALUE, KEY VALUE …",
            "start of a further block of rules",
            outline="block",
        ),
        StatementKind(
            "rules",
            GridNode,
            "OUTPUT, … [when CONDITION]",
            "a grid of rules",
            _JOINS | {"when": "a condition that is added to every rule of the grid"},
            takes_lines=True,
            outline="grid",
        ),
        StatementKind(
            "rule",
            RuleNode,
            "if CONDITION then OUTPUT is TERM [with WEIGHT]",
            "one rule: if … then …",
            {"if": "", "then": "", "with": "the weight of the rule"} | _JOINS,
            outline="rule",
        ),
        StatementKind(
            "lookup",
            LookupNode,
            "",
            "how the lookup table is sampled",
            LOOKUP_ITEMS
            | {
                "step": "the distance between neighbouring levels",
                "count": "the number of levels",
                "mirrored": "the same numbers with a minus sign too",
            },
            takes_lines=True,
            outline="lookup",
        ),
        StatementKind(
            "expect",
            ExpectNode,
            "INPUT = VALUE, … -> OUTPUT = VALUE [within TOLERANCE]",
            "what must come out, checked by `fuzzyarm check`",
            {"in": "between two numbers", "within": "the tolerance of an expectation"},
            outline="expect",
        ),
        StatementKind(
            "prove",
            ProveNode,
            "[INPUT in LOW .. HIGH, … ->] CLAIM",
            "what holds at every point, proved by `fuzzyarm prove`",
            {
                "rises": "the output never falls where the input rises",
                "falls": "the output never rises where the input rises",
                "slope": "how steep the output is along an input",
                "odd": "opposite inputs give opposite outputs",
                "covered": "some rule fires at every point",
                "table": "the lookup table that `compile` makes",
                "of": "",
                "linear": "looked up between the levels",
                "nearest": "looked up at the nearest level",
            },
            outline="prove",
        ),
        StatementKind(
            "tune",
            TuneNode,
            "",
            "what `fuzzyarm tune` may move; nothing else reads it",
            TUNE_ITEMS | TUNE_WORDS,
            takes_lines=True,
            outline="tune",
        ),
    )
}
"""Every statement by the word that starts it."""

STARTERS.update(STATEMENTS)

WORDS: dict[str, str] = {word: doc for r in STATEMENTS.values() for word, doc in r.words.items()}
"""The other words of the statements, with one line of help where it is needed."""
