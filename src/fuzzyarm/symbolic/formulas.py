"""Formulas of users, in the dialects of several programs: reader and writer.

One parser and one writer serve all dialects; their differences are a table,
:class:`FormulaDialect`. A formula becomes the same expression as a built-in shape, so all readings
of expressions (arrays, machine code, C, derivatives, bounds) apply.

The grammar, from the loosest to the tightest::

    sum      product (('+' | '-') product)*
    product  signed (('*' | '/' | '%') signed)*
    signed   sign* power
    power    atom ('^' signed)?                from the right: 2 ^ 3 ^ 2 is 2 ^ 9
           | atom (('^' | '%') atom)*          from the left, in jFuzzyLogic
    atom     number | name | function '(' sum (',' sum)* ')' | '(' sum ')'
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.symbolic.evaluation import evaluate_arrays
from fuzzyarm.symbolic.nodes import Apply, Constant, Node, Symbol, apply, constant, replace, symbol
from fuzzyarm.symbolic.operations import OPERATIONS

MAX_DEPTH = 100
"""Deepest nesting of parentheses and signs."""

MAX_TOKENS = 20_000
"""Most tokens of a formula."""

CONSTANTS: dict[str, float] = {"pi": math.pi}
"""Names with fixed values, unless a variable has the same name."""


class FormulaError(FuzzyarmError, ValueError):
    """A formula that cannot be read or is undefined.

    Attributes
    ----------
    text : str
        The formula.
    position : int
        Index of the character at fault, from 0; the length of the text for its end.
    """

    def __init__(self, message: str, text: str, position: int = 0) -> None:
        super().__init__(message)
        self.text = text
        self.position = position


def _comparison(operation: str, *, swapped: bool = False) -> Callable[..., Node]:
    def compare(a: Node, b: Node) -> Node:
        condition = apply(operation, b, a) if swapped else apply(operation, a, b)
        return apply("where", condition, 1.0, 0.0)

    return compare


_COMPARISONS = {
    "lt": _comparison("less"),
    "le": _comparison("less_equal"),
    "gt": _comparison("less", swapped=True),
    "ge": _comparison("less_equal", swapped=True),
    "eq": _comparison("equal"),
}
"""Comparisons as functions: 1 if true, else 0."""

_FUNCTIONS = {
    "abs": "absolute", "exp": "exp", "log": "log", "log10": "log10", "sqrt": "sqrt",
    "floor": "floor", "ceil": "ceil", "round": "round",
    "sin": "sin", "cos": "cos", "tan": "tan", "asin": "asin", "acos": "acos", "atan": "atan",
    "sinh": "sinh", "cosh": "cosh", "tanh": "tanh",
    "min": "minimum", "max": "maximum", "pow": "power", "atan2": "atan2", "fmod": "remainder",
}  # fmt: skip


@dataclass(frozen=True)
class FormulaDialect:
    """The notation of formulas in one program.

    Attributes
    ----------
    name : str
        Name in messages.
    functions : mapping of str to str
        Its functions, by their operations here.
    comparisons : bool
        Whether it has ``lt``, ``le``, ``gt``, ``ge`` and ``eq`` as functions.
    signs : mapping of str to str
        Prefix signs: equivalent to ``-`` or ``+``.
    powers_from_left : bool
        Whether ``^`` and ``%`` bind alike, tighter than ``*``, left-associative.
    any_case : bool
        Whether function names are case-insensitive.
    quotes : bool
        Whether a name may be in single quotes, and may contain dots.
    """

    name: str
    functions: Mapping[str, str]
    comparisons: bool = False
    signs: Mapping[str, str] = field(default_factory=lambda: {"-": "-", "+": "+"})
    powers_from_left: bool = False
    any_case: bool = False
    quotes: bool = False

    @cached_property
    def words(self) -> dict[str, str]:
        """The word of the dialect for each operation."""
        words_of_operations: dict[str, str] = {}
        for word, operation in self.functions.items():
            words_of_operations.setdefault(operation, word)
        return words_of_operations

    @cached_property
    def token(self) -> re.Pattern[str]:
        """The pattern of a token."""
        name = r"[^\W\d]\w*(?:\.\w+)*" if self.quotes else r"[^\W\d]\w*"
        quoted = r"|'(?P<quoted>[^']*)'" if self.quotes else ""
        signs = "|".join(map(re.escape, sorted(self.signs, key=len, reverse=True)))
        return re.compile(
            r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)"
            rf"|(?P<name>{name}){quoted}|(?P<sign>\*\*|{signs}|[-+*/%^(),]))"
        )


FRB = FormulaDialect("fuzzyarm", _FUNCTIONS, comparisons=True, quotes=True)

FUZZYLITE = FormulaDialect(
    "fuzzylite",
    _FUNCTIONS | {"fabs": "absolute"},
    comparisons=True,
    signs={"-": "-", "+": "+", "~": "-", ".-": "-", ".+": "+"},
    any_case=True,
)

JFUZZYLOGIC = FormulaDialect(
    "jFuzzyLogic",
    {
        "exp": "exp", "ln": "log", "log": "log10", "sin": "sin", "cos": "cos", "tan": "tan",
        "abs": "absolute",
    },
    signs={"-": "-", "+": "+", "~": "-"},
    powers_from_left=True,
    any_case=True,
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Formula:
    """A parsed formula.

    Attributes
    ----------
    text : str
        The source text.
    root : Node
        Its expression. Symbols are the names of variables, and of :data:`CONSTANTS` until
        :meth:`with_constants` replaces them.
    mentions : tuple of (str, int)
        Every name and its position in the text, in order.
    """

    text: str
    root: Node
    mentions: tuple[tuple[str, int], ...]

    @cached_property
    def positions(self) -> dict[str, int]:
        """First position of each name in the text."""
        return dict(reversed(self.mentions))

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The variables in order of appearance, each once; constants included."""
        return tuple(dict(self.mentions))

    @cached_property
    def _compiled(self) -> dict[tuple[str, ...], Callable[..., float]]:
        return {}

    def with_constants(self, variables: Sequence[str]) -> Node:
        """Return the expression with constants replaced by their values.

        Parameters
        ----------
        variables : sequence of str
            Names of variables, which take precedence over constants.

        Raises
        ------
        FormulaError
            If a name is neither a variable nor a constant.
        """
        free = [name for name in self.names if name not in variables]
        for name in free:
            if name not in CONSTANTS:
                position = self.positions[name]
                raise FormulaError(f"unknown variable '{name}'", self.text, position)
        return replace(self.root, {name: CONSTANTS[name] for name in free})

    def function(self, variables: Sequence[str]) -> Callable[..., float]:
        """Return the formula as a function of floats, one for each variable.

        NaN or infinite as in IEEE arithmetic (``1 / 0``, ``sqrt(-1)``).
        """
        from fuzzyarm.symbolic.functions import python_function

        names = [f"v{i}" for i in range(len(variables))]  # a name may be any text
        renamed = dict(zip(variables, map(symbol, names), strict=True))
        return python_function(replace(self.with_constants(variables), renamed), names)

    def evaluate(self, values: Mapping[str, float]) -> float:
        """Return the value at one point, by the names of the variables.

        Compiled at the first call. `values` may have further names.
        """
        names = tuple(name for name in self.names if name in values)
        if names not in self._compiled:
            self._compiled[names] = self.function(names)
        return self._compiled[names](*(values[name] for name in names))

    def evaluate_arrays(self, values: Mapping[str, Any]) -> Any:
        """Return the values over arrays that broadcast, with the bits of :meth:`evaluate`."""
        import numpy as np

        root = self.with_constants(tuple(values))
        return np.asarray(evaluate_arrays(root, values, as_floats=True), dtype=float)


# ── reading ──────────────────────────────────────────────────────────────────────────


def read_formula(text: str, dialect: FormulaDialect = FRB) -> Formula:
    """Read a formula."""
    parser = _Parser(text, dialect)
    root = parser.sum()
    if parser.kind != "end":
        raise parser.fault(f"expected an operator {parser.found()}")
    return Formula(text, root, tuple(parser.mentions))


class _Parser:
    """Recursive descent over the tokens of one formula."""

    def __init__(self, text: str, dialect: FormulaDialect) -> None:
        self.text = text
        self.dialect = dialect
        self.tokens = list(_tokens(text, dialect.token))
        self.index = 0
        self.depth = 0
        self.mentions: list[tuple[str, int]] = []

    @property
    def kind(self) -> str:
        return self.tokens[self.index][0]

    def take(self, *signs: str) -> str | None:
        kind, value, _ = self.tokens[self.index]
        if kind == "sign" and value in signs:
            self.index += 1
            return value
        return None

    def fault(self, message: str) -> FormulaError:
        return FormulaError(message, self.text, self.tokens[self.index][2])

    def found(self) -> str:
        return (
            "but the formula ends"
            if self.kind == "end"
            else (f"but found '{self.tokens[self.index][1]}'")
        )

    def expect(self, sign: str) -> None:
        if not self.take(sign):
            raise self.fault(f"expected '{sign}' {self.found()}")

    def enter(self) -> None:
        """Count one level; the parser nests six calls for each, of Python's 1000."""
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise self.fault(f"nested deeper than {MAX_DEPTH} levels")

    def sum(self) -> Node:
        self.enter()
        node = self.product()
        while sign := self.take(*_SUM):
            node = apply(_SUM[sign], node, self.product())
        self.depth -= 1
        return node

    def product(self) -> Node:
        signs = _PRODUCT if self.dialect.powers_from_left else _PRODUCT | _REMAINDER
        node = self.signed()
        while sign := self.take(*signs):
            node = apply(signs[sign], node, self.signed())
        return node

    def signed(self) -> Node:
        negative = False
        while sign := self.take(*self.dialect.signs):
            negative ^= self.dialect.signs[sign] == "-"
        node = self.power()
        return apply("negative", node) if negative else node

    def power(self) -> Node:
        node = self.atom()
        if self.dialect.powers_from_left:
            signs = _POWER | _REMAINDER
            while sign := self.take(*signs):
                node = apply(signs[sign], node, self.atom())
        elif self.take(*_POWER):
            self.enter()
            node = apply("power", node, self.signed())
            self.depth -= 1
        return node

    def atom(self) -> Node:
        kind, value, position = self.tokens[self.index]
        if kind == "number":
            self.index += 1
            return constant(float(value))
        if kind in {"name", "quoted"}:
            self.index += 1
            if kind == "name" and self.take("("):
                return self.call(value, position)
            self.mentions.append((value, position))
            return symbol(value)
        if self.take("("):
            node = self.sum()
            self.expect(")")
            return node
        raise self.fault(f"expected a number, a name or '(' {self.found()}")

    def call(self, word: str, position: int) -> Node:
        arguments = [self.sum()]
        while self.take(","):
            arguments.append(self.sum())
        self.expect(")")
        key = word.lower() if self.dialect.any_case else word
        if self.dialect.comparisons and key in _COMPARISONS:
            arity, build = 2, _COMPARISONS[key]
        elif key in self.dialect.functions:
            operation = self.dialect.functions[key]
            arity = OPERATIONS[operation].arity

            def build(*parts: Node) -> Node:
                return apply(operation, *parts)

        else:
            raise FormulaError(f"unknown function '{word}'", self.text, position)
        several = key in {"min", "max"} and len(arguments) > arity
        if len(arguments) != arity and not several:
            counted = "one argument" if arity == 1 else f"{arity} arguments"
            raise FormulaError(f"'{word}' takes {counted}", self.text, position)
        node = build(*arguments[:arity])
        for argument in arguments[arity:]:
            node = build(node, argument)
        return node


_SUM = {"+": "add", "-": "subtract"}
_PRODUCT = {"*": "multiply", "/": "divide"}
_REMAINDER = {"%": "remainder"}
_POWER = {"^": "power", "**": "power"}


def _tokens(text: str, token: re.Pattern[str]) -> Iterator[tuple[str, str, int]]:
    position, end = 0, len(text.rstrip())
    for _ in range(MAX_TOKENS):
        if position >= end:
            yield "end", "", len(text)
            return
        match = token.match(text, position)
        if match is None or match.lastgroup is None:
            start = position + len(text[position:]) - len(text[position:].lstrip())
            raise FormulaError(f"'{text[start]}' has no meaning here", text, start)
        yield match.lastgroup, match[match.lastgroup], match.start(match.lastgroup)
        position = match.end()
    raise FormulaError(f"a formula may have at most {MAX_TOKENS} words", text, position)


# ── writing ──────────────────────────────────────────────────────────────────────────


def write_formula(
    root: Node,
    dialect: FormulaDialect = FRB,
    rename: Mapping[str, str] | None = None,
    *,
    upper: bool = False,
    minus: str = "-",
) -> str:
    """Return the text of an expression, with parentheses wherever the precedence is not obvious."""
    return _Writer(dialect, rename or {}, upper=upper, minus=minus).text(root)


_SIGNS = {"add": "+", "subtract": "-", "multiply": "*", "divide": "/"} | {
    "power": "^", "remainder": "%",
}  # fmt: skip
_BINDS = {"add": 1, "subtract": 1, "multiply": 2, "divide": 2, "power": 3}
"""Precedence of operators in every dialect; ``%`` is missing, as it differs."""


@dataclass(frozen=True)
class _Writer:
    dialect: FormulaDialect
    rename: Mapping[str, str]
    upper: bool
    minus: str

    def text(self, node: Node) -> str:
        if isinstance(node, Constant):
            return _number(node.value)
        if isinstance(node, Symbol):
            return self.rename.get(node.name, node.name)
        assert isinstance(node, Apply)
        if node.operation in _SIGNS:
            return self._operator(node)
        if node.operation == "negative":
            return f"{self.minus}{self._operand(node.arguments[0], 9, at_right=True)}"
        return self._call(node)

    def _operator(self, node: Apply) -> str:
        # Left operands in a loop, from the right end: a chain may be thousands long.
        text: list[str] = []
        parentheses = 0
        while True:
            left, right = node.arguments
            binds = _BINDS.get(node.operation, 9)
            text.append(f" {_SIGNS[node.operation]} {self._operand(right, binds, at_right=True)}")
            if not (isinstance(left, Apply) and left.operation in _SIGNS):
                text.append(self._operand(left, binds, at_right=False))
                return "(" * parentheses + "".join(reversed(text))
            if not _clear(left, binds, at_right=False):
                text.append(")")
                parentheses += 1
            node = left

    def _operand(self, node: Node, above: int, *, at_right: bool) -> str:
        text = self.text(node)
        if not isinstance(node, Apply):
            return f"({text})" if text.startswith("-") else text
        if node.operation not in _SIGNS and node.operation != "negative":
            return text
        return text if _clear(node, above, at_right=at_right) else f"({text})"

    def _call(self, node: Apply) -> str:
        word = self.dialect.words.get(node.operation)
        arguments = node.arguments
        if word is None and self.dialect.comparisons:
            word, arguments = _comparison_of(node)
        if word is None:
            message = f"{self.dialect.name} has no function for '{node.operation}'"
            raise FormulaError(message, self.dialect.name)
        inner = ", ".join(map(self.text, arguments))
        return f"{word.upper() if self.upper else word}({inner})"


def _clear(node: Apply, above: int, *, at_right: bool) -> bool:
    """Whether an operand needs no parentheses under an operator of this precedence."""
    binding = _BINDS.get(node.operation, 0)
    return binding > above or (binding == above and not at_right and binding < 3)


def _comparison_of(node: Apply) -> tuple[str | None, tuple[Node, ...]]:
    """Return the comparison behind a choice between 1 and 0."""
    if node.operation == "where" and node.arguments[1:] == (constant(1.0), constant(0.0)):
        condition = node.arguments[0]
        if isinstance(condition, Apply):
            for word in ("lt", "le", "eq"):
                if _COMPARISONS[word](*condition.arguments) is node:
                    return word, condition.arguments
    return None, ()


def _number(value: float) -> str:
    text = repr(value)
    return text.removesuffix(".0")
