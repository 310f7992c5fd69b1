"""Building blocks of statements: propositions and antecedents, shapes, settings.

Each is a node of the syntax tree that defines how it is read (``read``, from a cursor), written
(``str``, canonical), and which variables and terms it names (``mentions``).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from enum import StrEnum
from typing import NamedTuple

from fuzzyarm.base.diagnostic import (
    MAX_LINE,
    MAX_NESTING,
    NOWHERE,
    Diagnostic,
    Figure,
    Span,
    Word,
    display_width,
)
from fuzzyarm.base.names import near_hint, quote
from fuzzyarm.base.numbers import number_text
from fuzzyarm.language.model.rulebase import SAMPLINGS
from fuzzyarm.language.tokens import Cursor, Fault, name_text
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, HEDGES, SHAPES, SNORMS, TNORMS

# --- Names in a text ---


class NameKind(StrEnum):
    """The kind of object behind a name."""

    RULEBASE = "rulebase"
    VARIABLE = "variable"
    TERM = "term"
    BLOCK = "block"
    CONTROLLER = "controller"
    USE = "use"
    SIGNAL = "signal"
    AXIS = "axis"
    PORT = "port"
    PLANT = "plant"
    STATE = "state"
    PARAMETER = "parameter"


class Occurrence(NamedTuple):
    """A name in a text.

    Attributes
    ----------
    kind : NameKind
        The kind of object.
    name : str
        Without quotes.
    span : Span
        As written, quotes included.
    owners : tuple of str
        The variables of a term: one, or several where ``terms`` declares them together.
    is_definition : bool
        Whether the name is declared here.
    is_gain : bool
        Whether it must be one of a gain, not of a signal.
    """

    kind: NameKind
    name: str
    span: Span
    owners: tuple[str, ...] = ()
    is_definition: bool = False
    is_gain: bool = False


def of_variable(word: Word) -> Occurrence:
    """Return the mention of a variable."""
    return Occurrence(NameKind.VARIABLE, word, word.span)


def of_term(variable: Word, word: Word) -> Occurrence:
    """Return the mention of a term of `variable`."""
    return Occurrence(NameKind.TERM, word, word.span, (variable,))


def declared(kind: NameKind, word: Word, owners: tuple[str, ...] = ()) -> Occurrence:
    """Return the declaration of a name."""
    return Occurrence(kind, word, word.span, owners, is_definition=True)


# --- Lines in columns ---


def aligned(rows: Sequence[Sequence[str]], gap: str = "  ") -> list[str]:
    """Return `rows` as lines indented by two, columns a gap apart and left-aligned.

    Where that would make a line longer than a text may have, the columns are not aligned.
    """
    widths = [0] * max(map(len, rows), default=0)
    for row in rows:
        for i, text in enumerate(row):
            widths[i] = max(widths[i], display_width(text))
    if sum(widths) + len(gap) * len(widths) + 2 > MAX_LINE:
        return [f"  {' '.join(filter(None, row))}" for row in rows]
    lines = []
    for row in rows:
        # Widths in terminal columns: a wide character takes two.
        padded = (text + " " * (widths[i] - display_width(text)) for i, text in enumerate(row))
        lines.append("  " + gap.join(padded).rstrip())
    return lines


# --- Hedges and propositions ---


class HedgeNode(NamedTuple):
    """A hedge word; `number` is that of ``power(1.3)``."""

    word: Word
    number: Figure | None = None

    def __str__(self) -> str:
        if self.number is None:
            return self.word
        return f"{self.word}({number_text(self.number)})"

    @classmethod
    def read_all(cls, cursor: Cursor) -> tuple[HedgeNode, ...]:
        """Read hedges, none or several."""
        hedges: list[HedgeNode] = []
        cursor.suggest("hedges")
        while (token := cursor.peek()) is not None and token.text in HEDGES.words:
            name = HEDGES.words[token.text]
            parameters = HEDGES[name].parameters
            # A hedge with a number needs a parenthesis; otherwise the word is a name.
            if token.kind != "name" or (parameters and not cursor.next_is("(", 1)):
                break
            word, number = Word(name, cursor.take().span), None
            if parameters:
                cursor.take()
                number = cursor.figure(f"the {parameters[0]}")
                cursor.expect(")", f"after the {parameters[0]}")
            hedges.append(cls(word, number))
            cursor.suggest("hedges")
        return tuple(hedges)


def _hedged(hedges: tuple[HedgeNode, ...], text: str) -> str:
    return " ".join([*map(str, hedges), text])


class PropositionNode(NamedTuple):
    """``variable is [hedges] term``, in antecedents and consequents."""

    variable: Word
    hedges: tuple[HedgeNode, ...]
    term: Word

    @property
    def span(self) -> Span:
        """From the variable to the term."""
        return self.variable.span.to(self.term.span)

    @classmethod
    def read(cls, cursor: Cursor, what: str, role: str = "") -> PropositionNode:
        """Read a proposition that starts with `what`, the name of a variable of `role`."""
        variable = cursor.variable(what, role, " is")
        # `vary (x is hot)`: a misspelt hedge before a parenthesis was read as the variable.
        if cursor.next_is("("):
            raise _unknown_hedge(variable)
        cursor.expect("is", f"after the variable '{variable}'")
        hedges = HedgeNode.read_all(cursor)
        term = cursor.term(f"a term of '{variable}'", variable)
        following = cursor.peek()
        # `x is vary hot` and `x is powr(1.3) hot`: the hedge was read as the term.
        if following is not None and following.kind == "name" and following.text not in _FOLLOW:
            raise _unknown_hedge(term)
        if cursor.next_is("(") and (number := cursor.peek(1)) and number.kind == "number":
            raise _unknown_hedge(term)
        return cls(variable, hedges, term)

    def __str__(self) -> str:
        return f"{name_text(self.variable)} is {_hedged(self.hedges, name_text(self.term))}"

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the variable and the term."""
        yield of_variable(self.variable)
        yield of_term(self.variable, self.term)


_FOLLOW = ("and", "or", "then", "with")
"""Words that may follow a proposition."""


def _unknown_hedge(word: Word) -> Fault:
    """Return the fault of a word in the position of a hedge."""
    HEDGES.get(word)  # looks among other packages' kinds, then it is read again
    hint, replacement = near_hint(word, HEDGES.words)
    hint = hint or f"hedges are {', '.join(HEDGES.words)}"
    message = f"unknown hedge '{word}'"
    return Fault(
        Diagnostic("unknown-hedge", message, word.span, hint=hint, replacement=replacement)
    )


# --- Antecedents (`and` binds tighter than `or`) ---


class JunctionNode(NamedTuple):
    """Two or more operands between ``and`` or between ``or``."""

    word: str
    operands: tuple[ExpressionNode, ...]

    def __str__(self) -> str:
        return f" {self.word} ".join(map(self._operand, self.operands))

    def _operand(self, operand: ExpressionNode) -> str:
        """Return the text of an operand, in parentheses where the tree needs them."""
        binds = self.word == "or" and isinstance(operand, JunctionNode) and operand.word == "and"
        return f"({operand})" if isinstance(operand, JunctionNode) and not binds else str(operand)

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in all operands."""
        for operand in self.operands:
            yield from operand.mentions()


class HedgedNode(NamedTuple):
    """Hedges before a parenthesis."""

    hedges: tuple[HedgeNode, ...]
    operand: ExpressionNode

    def __str__(self) -> str:
        return _hedged(self.hedges, f"({self.operand})")

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in the operand."""
        return self.operand.mentions()


ExpressionNode = PropositionNode | JunctionNode | HedgedNode


def read_expression(cursor: Cursor, depth: int = 0) -> ExpressionNode:
    """Read a disjunction of conjunctions of propositions."""
    if depth > MAX_NESTING:
        message = f"parentheses nest deeper than {MAX_NESTING} levels"
        raise Fault(Diagnostic("too-deep", message, cursor.span))
    operands = [_conjunction(cursor, depth)]
    while cursor.accept("or"):
        operands.append(_conjunction(cursor, depth))
    return operands[0] if len(operands) == 1 else JunctionNode("or", tuple(operands))


def _conjunction(cursor: Cursor, depth: int) -> ExpressionNode:
    operands = [_operand(cursor, depth)]
    while cursor.accept("and"):
        operands.append(_operand(cursor, depth))
    return operands[0] if len(operands) == 1 else JunctionNode("and", tuple(operands))


def _operand(cursor: Cursor, depth: int) -> ExpressionNode:
    hedges = HedgeNode.read_all(cursor)
    if hedges:
        cursor.expect("(", "after the hedge (or write the hedge after 'is')")
    elif not cursor.accept("("):
        return PropositionNode.read(cursor, "the name of a variable")
    inner = read_expression(cursor, depth + 1)
    cursor.expect(")", "to close the parenthesis")
    return HedgedNode(hedges, inner) if hedges else inner


# --- Shapes: a word and its numbers, pairs, summands or a formula ---


class LinearPart(NamedTuple):
    """One summand of a ``linear`` consequent: a factor and an input, or a bare number."""

    factor: float
    variable: Word | None
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor, sign: float) -> LinearPart:
        """Read a summand after a plus or minus."""
        start = cursor.span
        # Only a name leaves its sign to be read here (`- - x`); a number includes its own.
        while not cursor.at_figure and cursor.accept("-"):
            sign = -sign
        if not cursor.at_figure:
            variable = cursor.variable("a number or an input", "input")
            return cls(sign, variable, variable.span)
        figure = cursor.figure("a number")
        if not cursor.accept("*"):
            return cls(sign * figure, None, start.to(figure.span))
        variable = cursor.variable("an input", "input")
        return cls(sign * figure, variable, start.to(variable.span))

    def text(self, factor: float, spell: Callable[[float], str] = number_text) -> str:
        """Return the summand with another factor."""
        number = spell(factor)
        return number if self.variable is None else f"{number}*{name_text(self.variable)}"


class ShapeNode(NamedTuple):
    """A shape with its numbers, maybe over another: the two of an interval type-2 term.

    `figures` are the numbers in order (for ``points`` the pairs flattened), `parts` the summands of
    ``linear``, `formula` the text of ``formula``, `lower` the shape after ``over``.
    """

    kind: Word
    figures: tuple[Figure, ...] = ()
    parts: tuple[LinearPart, ...] = ()
    formula: str = ""
    formula_span: Span = NOWHERE
    height: Figure | None = None
    lower: ShapeNode | None = None

    @classmethod
    def read(cls, cursor: Cursor) -> ShapeNode:
        """Read a shape, and its lower one after ``over``, up to the end of the line."""
        upper = cls._read_one(cursor)
        if cursor.accept("over"):
            return upper._replace(lower=cls._read_one(cursor))
        return upper

    @classmethod
    def _read_one(cls, cursor: Cursor) -> ShapeNode:
        cursor.suggest("shapes")
        kind = cursor.word("the shape of the term", SHAPES, "unknown-shape")
        figures: tuple[Figure, ...] = ()
        parts: tuple[LinearPart, ...] = ()
        formula, formula_span = "", cursor.span
        if kind == "points":
            figures = _read_pairs(cursor)
        elif kind == "linear":
            parts = _read_sum(cursor)
        elif kind == "formula":
            text = cursor.string()
            if text is None:
                cursor.fail("the formula in double quotes")
            formula = text
        else:
            figures = _read_parameters(cursor, kind)
        height = cursor.figure("the height") if cursor.accept("height") else None
        return cls(kind, figures, parts, formula, formula_span, height)

    def __str__(self) -> str:
        kind = self.kind
        if kind == "points":
            pairs = zip(self.figures[0::2], self.figures[1::2], strict=True)
            body = " ".join(f"({number_text(x)}, {number_text(y)})" for x, y in pairs)
        elif kind == "linear":
            body = sum_text(self.parts)
        elif kind == "formula":
            body = quote(self.formula, '"')
        else:
            body = " ".join(map(number_text, self.figures))
        height = "" if self.height is None else f" height {number_text(self.height)}"
        lower = f" over {self.lower}" if self.lower else ""
        return f"{kind} {body}{height}{lower}"

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the inputs in a sum or a formula."""
        for part in self.parts:
            if part.variable is not None:
                yield of_variable(part.variable)
        if self.formula:
            yield from _formula_mentions(self.formula, self.formula_span)
        if self.lower is not None:
            yield from self.lower.mentions()


def _read_parameters(cursor: Cursor, kind: str) -> tuple[Figure, ...]:
    names = parameter_names(kind)
    start = cursor.span
    figures = []
    while cursor.at_figure:
        figures.append(cursor.figure("a number", finite=False))
    if len(figures) == len(names):
        return tuple(figures)
    if not figures and not cursor.at_end:
        cursor.fail(f"the numbers of {kind}: {' '.join(names)}")
    if len(figures) > len(names):
        # Mark only the surplus.
        start = figures[len(names)].span
    message = f"{kind} takes {len(names)} numbers ({', '.join(names)}), found {len(figures)}"
    span = start.to(figures[-1].span) if figures else start
    raise Fault(Diagnostic("wrong-parameter-count", message, span))


def parameter_names(kind: str) -> tuple[str, ...]:
    """Return the names of a shape's numbers as identifiers."""
    return tuple(name.replace("-", "_") for name in SHAPES[kind].parameters)


def _read_pairs(cursor: Cursor) -> tuple[Figure, ...]:
    figures: list[Figure] = []
    while cursor.accept("("):
        figures.append(cursor.figure("the x of a point"))
        cursor.expect(",", "between x and y of a point")
        figures.append(cursor.figure("the y of a point"))
        cursor.expect(")", "after a point")
    if not figures:
        cursor.fail("points like (0, 0) (1, 1)")
    return tuple(figures)


def _read_sum(cursor: Cursor) -> tuple[LinearPart, ...]:
    parts = [LinearPart.read(cursor, 1.0)]
    while cursor.next_is("+") or cursor.next_is("-"):
        sign = -1.0 if cursor.take().text == "-" else 1.0
        parts.append(LinearPart.read(cursor, sign))
    return tuple(parts)


def sum_text(parts: tuple[LinearPart, ...], spell: Callable[[float], str] = number_text) -> str:
    """Return the sum of a ``linear`` consequent; `spell` writes its numbers."""
    first, *rest = parts
    text = first.text(first.factor, spell)
    for part in rest:
        # Decide by text, not `< 0.0`: a factor of -0.0 keeps its sign.
        negative = number_text(part.factor).startswith("-")
        text += f" {'-' if negative else '+'} {part.text(abs(part.factor), spell)}"
    return text


def _formula_mentions(text: str, span: Span) -> Iterator[Occurrence]:
    from fuzzyarm.symbolic.formulas import FormulaError, read_formula

    try:
        formula = read_formula(text)
    except FormulaError:
        return
    # In a text with escapes positions differ from those in the file.
    if span.end_column - span.column != len(text) + 2:
        return
    for name, position in formula.mentions:
        quoted = text[position - 1 : position] == "'"
        start = span.column + 1 + position - quoted
        end = start + len(name) + 2 * quoted
        yield Occurrence(NameKind.VARIABLE, name, Span(span.line, start, span.line, end))


# --- Settings: `key value` pairs of `inference` and `block` ---


class Setting(NamedTuple):
    """The definition of a setting.

    `of` is ``rules``, ``outputs`` or ``variables``; `number` describes a number in place of a word,
    empty if none is allowed; `infinite` is whether that may be infinite or NaN.
    """

    word: str
    doc: str
    of: str
    values: Collection[str] = ()
    number: str = ""
    infinite: bool = False
    unknown: str = "unknown-choice"
    expected: str = "one of"


# Evaluated at each use, not copied: other packages register norms later.
class _Disjunctions(Collection[str]):
    """The S-norms for ``or``: not those for aggregation only."""

    def __contains__(self, word: object) -> bool:
        return word in SNORMS and not SNORMS[str(word)].aggregates

    def __iter__(self) -> Iterator[str]:
        return (word for word, norm in SNORMS.items() if not norm.aggregates)

    def __len__(self) -> int:
        return sum(1 for _ in self)


SETTINGS: dict[str, Setting] = {
    setting.word: setting
    for setting in (
        Setting(
            "and",
            "how the parts of an antecedent that are joined by `and` become one degree",
            "rules",
            TNORMS,
        ),
        Setting(
            "or",
            "how the parts of an antecedent that are joined by `or` become one degree",
            "rules",
            _Disjunctions(),
        ),
        Setting(
            "implication",
            "how the strength of a rule cuts the set of its consequent",
            "rules",
            TNORMS,
        ),
        Setting("aggregation", "how the cut sets of several rules become one", "outputs", SNORMS),
        Setting(
            "defuzzifier",
            "how the aggregated set becomes a number",
            "outputs",
            DEFUZZIFIERS,
            unknown="unknown-defuzzifier",
            expected="a defuzzifier:",
        ),
        Setting(
            "outside",
            "treatment of a value outside the range: clamp, extend or error",
            "variables",
            ("clamp", "extend", "error"),
        ),
        Setting(
            "no-rule",
            "the value if no rule fires: error, hold or a number",
            "outputs",
            ("error", "hold"),
            number="error, hold or a number for the case that no rule fires",
            infinite=True,
        ),
        Setting(
            "threshold",
            "a rule fires only where its firing strength is greater",
            "rules",
            number="the threshold of firing strengths",
        ),
    )
}
"""The settings of ``inference`` and ``block``, by their words."""


class SettingNode(NamedTuple):
    """One ``key value`` of ``inference`` or ``block``.

    `value` is the word of the value, `figure` its number (``no-rule 0``), `resolution` and
    `sampling` the parentheses of a defuzzifier, `exact` the word itself.
    """

    key: Word
    value: Word | None = None
    figure: Figure | None = None
    resolution: Figure | None = None
    sampling: Word | None = None
    exact: bool = False

    @classmethod
    def read_all(cls, cursor: Cursor, of: str = "") -> tuple[SettingNode, ...]:
        """Read one or more settings, separated by commas; an editor offers those `of` this kind."""
        settings = []
        more = True
        while more:
            with cursor.up_to(","):
                settings.append(cls._read(cursor, of))
            more = cursor.accept(",") is not None
        return tuple(settings)

    @classmethod
    def _read(cls, cursor: Cursor, of: str) -> SettingNode:
        cursor.suggest("settings", of)
        key = cursor.word(f"one of {', '.join(SETTINGS)}", SETTINGS, "unknown-setting")
        setting = SETTINGS[key]
        if setting.number:
            cursor.suggest("values", setting)
            token = cursor.peek()
            if token is None or token.kind != "name" or token.text not in setting.values:
                return cls(key, figure=cursor.figure(setting.number, finite=not setting.infinite))
        what = f"{setting.expected} {', '.join(setting.values)}"
        value = cursor.word(what, setting.values, setting.unknown)
        if key == "defuzzifier":
            return cls._read_samples(cursor, key, value)
        return cls(key, value)

    @classmethod
    def _read_samples(cls, cursor: Cursor, key: Word, method: Word) -> SettingNode:
        if cursor.accept("exact"):
            return cls(key, method, exact=True)
        cursor.suggest("samples")
        if not cursor.accept("("):
            return cls(key, method)
        resolution = cursor.figure("the number of samples")
        sampling: Word | None = None
        if cursor.accept(","):
            sampling = cursor.word(f"one of {', '.join(SAMPLINGS)}", SAMPLINGS, "unknown-choice")
        cursor.expect(")", "after the sampling")
        return cls(key, method, resolution=resolution, sampling=sampling)

    def __str__(self) -> str:
        value = number_text(self.figure) if self.figure is not None else ""
        if self.value is not None:
            value = self.value
        if self.resolution is not None:
            sampling = "" if self.sampling is None else f", {self.sampling}"
            value += f"({number_text(self.resolution)}{sampling})"
        elif self.exact:
            value += " exact"
        return f"{self.key} {value}"
