"""The statements of the language: a row of parts each.

:data:`STATEMENTS` is the whole language at a glance. A row (:mod:`fuzzyarm.language.rows`) names a
node, a plain record of fields, and the parts of its line in order. From it follow the reader, the
canonical text, completion (the expectations of the reader at the end of the tokens), colours,
help, the table of the syntax, the grammar of the editor's extension (the words of the row), and
renaming and the outline (its mentions).

To add a statement: write its node below, add its row to :data:`STATEMENTS`, and define its meaning
in :func:`fuzzyarm.language.meaning.elaborate`. Two are written by hand, since they are not a line
of parts: grids (:mod:`fuzzyarm.language.rules`) and ``prove``. A field of the model that a
statement fills is written by ``_sections`` of :mod:`fuzzyarm.language.writer`, drawn in
``tests/strategies.py`` (``tests/language/test_round_trips.py`` names a field that is not, and finds
what is not written), built again in ``tests/python/test_builder.py``, and a loss in
``note_left_out`` of :mod:`fuzzyarm.exchange.formats.system_writer` and in
``docs/reference/formats.md`` (``test_format_roundtrips.py`` and ``test_format_page.py`` of
``tests/formats``). A setting of tables is a field of ``Lookup`` and of ``LookupTable``
(``tests/table/test_compiler.py``), a line of its files (:mod:`fuzzyarm.table.header`,
:mod:`fuzzyarm.table.files`, ``tests/table/test_table_files.py``), and an option of ``compile`` in
:mod:`fuzzyarm.requests.making`.

Further steps: a section with an example in ``docs/reference/language.md``, which the tests parse; a
line in ``docs/reference/checks.md`` for each new finding; ``tools/make_schemas.py``;
``pytest --update-golden tests/language tests/lsp`` for the tables and the editor's grammar.
``tests/language/test_new_statement.py`` adds one in a test.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, Protocol

from fuzzyarm.base.diagnostic import NOWHERE, Figure, Span, Word
from fuzzyarm.base.numbers import number_text
from fuzzyarm.language.model.lookup_modes import LOOKUP_MODES
from fuzzyarm.language.model.shapes import EVEN_SHAPES
from fuzzyarm.language.parts import (
    Break,
    Column,
    FixedText,
    Forgiving,
    Keyword,
    Maybe,
    Name,
    Number,
    OneOf,
    Part,
    Phrase,
    Printed,
    Several,
    Suggest,
    Text,
    Values,
    VariableName,
    declares,
)
from fuzzyarm.language.phrases import (
    NameKind,
    Occurrence,
    SettingNode,
    ShapeNode,
    declared,
    of_variable,
    read_expression,
)
from fuzzyarm.language.rows import ByHand, Lines, StatementKind, StatementRow
from fuzzyarm.language.rules import (
    WIDTH,
    GridNode,
    RuleNode,
    read_conclusion,
)
from fuzzyarm.language.tokens import STARTERS, Cursor, Fault, Trivia, name_text
from fuzzyarm.language.tune import TUNE_ROW, TuneNode


class StatementNode(Protocol):
    """The interface of every statement."""

    @property
    def span(self) -> Span:
        """From its first to its last token, without the lines below it."""


# --- Declarations ---


class Heading(NamedTuple):
    """``rulebase NAME "description"``."""

    name: Word
    description: str | None
    span: Span = NOWHERE


class ControllerHeading(NamedTuple):
    """``controller NAME "description"``."""

    name: Word
    description: str | None
    span: Span = NOWHERE


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


class EvenTermsNode(NamedTuple):
    """``terms A, B: triangles T1 T2 …``."""

    variables: tuple[Word, ...]
    family: Word
    names: tuple[Word, ...]
    span: Span = NOWHERE


class TermNode(NamedTuple):
    """``term VARIABLE NAME: SHAPE``; without a shape if unreadable."""

    variable: Word
    name: Word
    shape: ShapeNode | None
    span: Span = NOWHERE


# --- Evaluation ---


class InferenceNode(NamedTuple):
    """``inference [VARIABLE:] key value, …``."""

    target: Word | None
    settings: tuple[SettingNode, ...]
    span: Span = NOWHERE


class BlockNode(NamedTuple):
    """``block NAME[: key value, …]``: the rules that follow form a block of their own."""

    name: Word
    settings: tuple[SettingNode, ...]
    span: Span = NOWHERE


# --- Lookup tables and expectations ---

LOOKUP_ITEMS: dict[str, str] = {
    "levels": "the sample points of the lookup table",
    "bins": "thresholds between neighbouring levels",
    "round": "the step that the values of the lookup table are rounded to",
}
"""The first words of the lines of ``lookup``."""


class LookupItem(NamedTuple):
    """One line of a ``lookup`` block.

    `key` is one of LOOKUP_ITEMS. `figures` are the numbers as written; with `form` ``step`` or
    ``count`` they are low, high and the step or the count; with ``list`` the values themselves;
    ``mirrored`` marks bins whose negatives are included.
    """

    key: Word
    variable: Word | None = None
    form: str = "list"
    figures: tuple[Figure, ...] = ()
    trivia: Trivia = Trivia()
    span: Span = NOWHERE


class LookupNode(NamedTuple):
    """The ``lookup`` block; `unread` if a line of it is unreadable."""

    items: tuple[LookupItem, ...]
    unread: bool = False
    span: Span = NOWHERE


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
        """Read the part after the name of the output; `others` are alternatives for completion."""
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
        text = f"{name_text(self.variable)} {self.relation} {number_text(self.value)}"
        if self.other is None:
            return text
        return f"{text} {'..' if self.relation == 'in' else 'within'} {number_text(self.other)}"

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the output."""
        yield of_variable(self.variable)


class ExpectNode(NamedTuple):
    """``expect input = value, … -> outcome, …``."""

    inputs: tuple[tuple[Word, Figure], ...]
    outcomes: tuple[OutcomeNode, ...]
    span: Span = NOWHERE


VERBS = ("rises", "falls", "slope", "odd", "covered")
"""Of statements about an output; ``tests/proof/test_every_verb.py`` has a truth for each."""

TABLE_MODES = tuple(reversed(LOOKUP_MODES))
"""Lookup modes of a table with a proved error; the smoothest is offered first."""


class StretchNode(NamedTuple):
    """``input in low .. high``: a part of the box of a property."""

    variable: Word
    low: Figure
    high: Figure

    def __str__(self) -> str:
        low, high = number_text(self.low), number_text(self.high)
        return f"{name_text(self.variable)} in {low} .. {high}"


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
        # `u in 0 .. 1` is a claim about an output or a part of the region: only the following comma
        # or arrow decides. So it is read as a claim, and converted into a stretch.
        while True:
            claim = cls._table(cursor) if cursor.accept("table") else None
            if claim is None:
                role = "output" if arrow else ""
                what = "the name of an output" if arrow else "the name of an output or an input"
                name = cursor.variable(what, role)
                claim = cls._claim(name, cursor)
            may_be_input = (
                not arrow and claim.outcome is not None and claim.outcome.relation == "in"
            )
            if may_be_input and (
                cursor.accept(",") or (arrow := bool(cursor.accept("->", likely=True)))
            ):
                assert claim.outcome is not None
                low, high = claim.outcome.value, claim.outcome.other
                assert high is not None
                region.append(StretchNode(claim.outcome.variable, low, high))
                continue
            if region and not arrow:
                cursor.fail("'->' between the inputs and the claim")
            return claim._replace(region=tuple(region), span=cursor.whole)

    @classmethod
    def _claim(cls, name: Word, cursor: Cursor) -> ProveNode:
        for verb in VERBS:
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
        return cls((), "value", name, OutcomeNode.read_behind(name, cursor, VERBS))

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
        """The claim without its region."""
        name = "" if self.output is None else name_text(self.output)
        by = "" if self.input is None else name_text(self.input)
        high = "" if self.high is None else number_text(self.high)
        if self.verb == "table":
            return f"table {f'of {name} ' if name else ''}{self.mode} within {high}"
        if self.outcome is not None:
            text = str(self.outcome)
        elif self.verb in ("rises", "falls"):
            text = f"{name} {self.verb} with {by}"
        elif self.low is not None:
            text = f"{name} slope {by} in {number_text(self.low)} .. {high}"
        else:
            text = f"{name} {self.verb}"
        # An output of this name would be read as the word.
        return f"'table'{text.removeprefix('table')}" if text.startswith("table ") else text

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        yield from (of_variable(stretch.variable) for stretch in self.region)
        yield from (of_variable(word) for word in (self.output, self.input) if word is not None)


class Broken(NamedTuple):
    """An unreadable statement; `keyword` is its first word, if known."""

    keyword: str
    span: Span = NOWHERE


# --- Special parts ---


class _OwnerBeforeColon(Part):
    """``VARIABLE:``, where the next token but one is a colon."""

    def __init__(self, field: str, what: str, role: str = "") -> None:
        self.field, self.what, self.role = field, what, role

    def read(self, cursor: Cursor, values: Values) -> None:
        values[self.field] = None
        cursor.suggest("targets", self.role)
        second = cursor.peek(1)
        if second is not None and second.kind == "mark" and second.text == ":":
            values[self.field] = cursor.variable(self.what, self.role)
            cursor.take()

    def show(self, node: Any, line: Printed) -> None:
        if getattr(node, self.field) is not None:
            line.add(f"{name_text(getattr(node, self.field))}:")

    def sketch(self, line: Printed) -> None:
        line.add("[VARIABLE:]")

    def mentions(self, node: Any) -> Iterator[Occurrence]:
        if getattr(node, self.field) is not None:
            yield of_variable(getattr(node, self.field))


class _SampleNumbers(Part):
    """Numbers of ``lookup``: one; ``several``, ``mirrored``; ``even`` ones by step or count."""

    def __init__(self, *forms: str) -> None:
        self.forms = forms

    def read(self, cursor: Cursor, values: Values) -> None:
        form: str = "list"
        figures = [cursor.figure("a number")]
        if "even" in self.forms and cursor.accept(".."):
            figures.append(cursor.figure("the last level"))
            form = str(cursor.word("'step' or 'count'", EVENLY, "unexpected-token"))
            figures.append(cursor.figure(f"the {form}"))
        while form == "list" and "several" in self.forms and cursor.at_figure:
            figures.append(cursor.figure("a number"))
        if "mirrored" in self.forms and cursor.accept("mirrored"):
            form = "mirrored"
        values["form"], values["figures"] = form, tuple(figures)

    def show(self, node: LookupItem, line: Printed) -> None:
        figures = list(map(number_text, node.figures))
        if node.form in EVENLY:
            line.add(f"{figures[0]} .. {figures[1]} {node.form} {figures[2]}")
        else:
            line.add(" ".join(figures) + (" mirrored" if node.form == "mirrored" else ""))

    def words(self) -> Iterator[tuple[str, str]]:
        if "even" in self.forms:
            yield from EVENLY.items()
        if "mirrored" in self.forms:
            yield "mirrored", "the same numbers with a minus sign too"


EVENLY = {
    "step": "the distance between neighbouring levels",
    "count": "the number of levels",
}


def _read_family(cursor: Cursor) -> Word:
    token = cursor.peek()
    cursor.suggest("families")
    try:
        families = f"a family of terms ({', '.join(EVEN_SHAPES)})"
        return cursor.word(families, EVEN_SHAPES, "unknown-shape")
    except Fault as fault:
        if token is None or token.kind != "name":
            raise
        # The first term: the family is missing.
        finding = replace(fault.diagnostic, replacement=f"triangles {token.text}")
        cursor.forgiven.append(finding)
        return Word("triangles", token.span)


def _read_names(cursor: Cursor) -> tuple[Word, ...]:
    names = []
    cursor.suggest("term names")
    while not cursor.at_end:
        names.append(cursor.name("the name of a term"))
    if not names:
        cursor.fail("the names of the terms, from low to high")
    return tuple(names)


def _terms_of_all(word: Word, node: EvenTermsNode) -> Occurrence:
    return declared(NameKind.TERM, word, node.variables)


def _term_of_one(word: Word, node: TermNode) -> Occurrence:
    return declared(NameKind.TERM, word, (node.variable,))


class _Names(Name):
    """The names of terms up to the end of the line."""

    def read(self, cursor: Cursor, values: Values) -> None:
        values[self.field] = _read_names(cursor)

    def show(self, node: Any, line: Printed) -> None:
        line.add(" ".join(map(name_text, getattr(node, self.field))))

    def mentions(self, node: Any) -> Iterator[Occurrence]:
        return (_terms_of_all(word, node) for word in getattr(node, self.field))


def _read_settings(cursor: Cursor) -> tuple[SettingNode, ...]:
    return SettingNode.read_all(cursor)


def _settings_text(settings: tuple[SettingNode, ...]) -> str:
    return ", ".join(map(str, settings))


def _read_values(cursor: Cursor) -> tuple[tuple[Word, Figure], ...]:
    """Read ``input = value``, with commas between."""
    values = [_read_value(cursor)]
    cursor.suggest("comma")
    while cursor.accept(","):
        values.append(_read_value(cursor))
        cursor.suggest("comma")
    return tuple(values)


def _read_value(cursor: Cursor) -> tuple[Word, Figure]:
    name = cursor.variable("the name of an input", "input", " =")
    cursor.expect("=", f"after '{name}'")
    return name, cursor.figure("a number")


def _values_text(values: tuple[tuple[Word, Figure], ...]) -> str:
    return ", ".join(f"{name_text(name)} = {number_text(value)}" for name, value in values)


# --- The statements ---

_JOINS = {"is": "", "and": "", "or": ""}

_VARIABLE = StatementRow(
    VariableNode,
    Keyword("input", "role", width=6),
    Name("name", "the name of the {role}", declares(NameKind.VARIABLE)),
    Column(),
    Forgiving(
        Suggest("range"),
        Number("low", "the lower end of the range", "LOW", finite=False),
        FixedText("..", "between the ends of the range"),
        Number("high", "the upper end of the range", "HIGH", finite=False),
    ),
    Column(),
    Text("description"),
)

LOOKUP_ROW = StatementRow(
    LookupItem,
    OneOf(
        "key",
        "levels, bins or round",
        "unknown-setting",
        LOOKUP_ITEMS,
        {
            "levels": (
                _OwnerBeforeColon("variable", "the name of an input", "input"),
                Column(),
                _SampleNumbers("several", "even"),
            ),
            "bins": (
                _OwnerBeforeColon("variable", "the name of an input", "input"),
                Column(),
                _SampleNumbers("several", "mirrored"),
            ),
            "round": (
                Column(),
                _SampleNumbers(),
            ),
        },
    ),
)
"""A line below ``lookup``."""

STATEMENTS: dict[str, StatementKind] = {
    record.word: record
    for record in (
        StatementKind(
            "rulebase",
            "name and purpose of the rule base",
            StatementRow(
                Heading,
                Keyword("rulebase"),
                Name("name", "the name of the rule base", declares(NameKind.RULEBASE)),
                Text("description"),
            ),
            outline="rulebase",
        ),
        StatementKind("input", "an input variable and its range", _VARIABLE, outline="input"),
        StatementKind("output", "an output variable and its range", _VARIABLE, outline="output"),
        StatementKind(
            "terms",
            "evenly spaced terms of one or more variables",
            StatementRow(
                EvenTermsNode,
                Keyword("terms"),
                Several(
                    VariableName("variables", "the name of a variable"), label="VARIABLE, VARIABLE"
                ),
                FixedText(":", "after the variables"),
                Phrase("family", _read_family, "FAMILY"),
                _Names("names", "", label="NAME NAME …"),
            ),
        ),
        StatementKind(
            "term",
            "one term with its shape; of interval type 2 with an upper one over a lower one",
            StatementRow(
                TermNode,
                Keyword("term"),
                VariableName("variable", "the name of a variable"),
                Name("name", "the name of the term", _term_of_one),
                Forgiving(
                    FixedText(":", "after the name of the term"),
                    Column(),
                    Phrase(
                        "shape",
                        ShapeNode.read,
                        "SHAPE NUMBERS [height H] [over SHAPE NUMBERS [height H]]",
                        words={
                            "height": "a factor on the whole shape",
                            "over": "the lower membership function of an interval type-2 term"
                            " follows",
                        },
                    ),
                    finish=True,
                ),
            ),
        ),
        StatementKind(
            "inference",
            "how rules are evaluated",
            StatementRow(
                InferenceNode,
                Keyword("inference"),
                _OwnerBeforeColon("target", "the name of a variable"),
                Phrase(
                    "settings",
                    _read_settings,
                    "KEY VALUE, KEY VALUE …",
                    _settings_text,
                    words={"exact": "the integral itself, without samples"},
                ),
            ),
        ),
        StatementKind(
            "block",
            "start of a further block of rules",
            StatementRow(
                BlockNode,
                Keyword("block"),
                Name("name", "the name of the block", declares(NameKind.BLOCK)),
                Maybe(
                    FixedText(":"),
                    Phrase(
                        "settings",
                        lambda cursor: SettingNode.read_all(cursor, "rules"),
                        "KEY VALUE, KEY VALUE …",
                        _settings_text,
                        empty=(),
                    ),
                    likely=True,
                ),
            ),
            outline="block",
        ),
        StatementKind(
            "rules",
            "a grid of rules",
            ByHand(  # a table: each line is read by the header above it
                GridNode,
                "OUTPUT, … [when CONDITION]",
                _JOINS | {"when": "a condition that is added to every rule of the grid"},
            ),
            takes_lines=True,
            outline="grid",
        ),
        StatementKind(
            "rule",
            "one rule: if … then …",
            StatementRow(
                RuleNode,
                Keyword("rule"),
                FixedText("if", "after 'rule'"),
                Phrase("antecedent", read_expression, "CONDITION"),
                Break(WIDTH, "     "),
                FixedText("then", "after the antecedent"),
                Several(
                    Phrase("consequents", read_conclusion, "OUTPUT is TERM", words=_JOINS),
                    between=("and", ","),
                ),
                Maybe(
                    FixedText("with", "", "the weight of the rule"),
                    Number("weight", "the weight of the rule", "WEIGHT"),
                ),
            ),
            outline="rule",
        ),
        StatementKind(
            "lookup",
            "how the lookup table is sampled",
            StatementRow(LookupNode, Keyword("lookup"), Lines("items", LOOKUP_ROW, "unread")),
            takes_lines=True,
            outline="lookup",
        ),
        StatementKind(
            "expect",
            "expected outputs, checked by `fuzzyarm check`",
            StatementRow(
                ExpectNode,
                Keyword("expect"),
                Phrase(
                    "inputs",
                    _read_values,
                    "INPUT = VALUE, …",
                    _values_text,
                    lambda inputs: (of_variable(name) for name, _ in inputs),
                ),
                FixedText("->", "after the inputs"),
                Several(
                    Phrase(
                        "outcomes",
                        OutcomeNode.read,
                        "OUTPUT = VALUE [within TOLERANCE]",
                        words={
                            "in": "between two numbers",
                            "within": "the tolerance of an expectation",
                        },
                    )
                ),
            ),
            outline="expect",
        ),
        StatementKind(
            "prove",
            "property of every point, proved by `fuzzyarm prove`",
            ByHand(  # an input of the region and an output look alike up to the arrow
                ProveNode,
                "[INPUT in LOW .. HIGH, … ->] CLAIM",
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
            ),
            outline="prove",
        ),
        StatementKind(
            "tune",
            "movable numbers for `fuzzyarm tune`; ignored otherwise",
            StatementRow(TuneNode, Keyword("tune"), Lines("items", TUNE_ROW, "unread")),
            takes_lines=True,
            outline="tune",
        ),
    )
}
"""Every statement by the word that starts it."""

CONTROLLER = StatementKind(
    "controller",
    "name and purpose of the controller",
    StatementRow(
        ControllerHeading,
        Keyword("controller"),
        Name("name", "the name of the controller", declares(NameKind.CONTROLLER)),
        Text("description"),
    ),
    outline="controller",
)
"""The heading of the statements of :mod:`fuzzyarm.language.controllers`.

It is here so that a rule base is read without them.
"""

STARTERS.update({*STATEMENTS, CONTROLLER.word})

WORDS: dict[str, str] = {word: doc for r in STATEMENTS.values() for word, doc in r.words.items()}
"""The other words of the statements, with one line of help if needed."""
