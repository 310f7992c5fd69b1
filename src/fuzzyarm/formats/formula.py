"""Arithmetic in terms: read in a dialect, write with every doubt removed.

A formula is kept as text in the model. The dialects differ in the precedence and the
direction of ``^``, in ``%`` and in what ``log`` means; so an importer parses its dialect
and writes the same tree with parentheses wherever a reader could hesitate.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace

_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[^\W\d]\w*)"
    r"|(?P<operator>\*\*|\.-|\.\+|[-+*/^%(),~!]))"
)
MAX_DEPTH = 50
MAX_TOKENS = 2_000

FUNCTIONS = {
    "abs": 1, "exp": 1, "log": 1, "log10": 1, "sqrt": 1, "floor": 1, "ceil": 1, "round": 1,
    "sin": 1, "cos": 1, "tan": 1, "asin": 1, "acos": 1, "atan": 1,
    "sinh": 1, "cosh": 1, "tanh": 1, "min": 2, "max": 2, "pow": 2, "atan2": 2,
}  # fmt: skip
"""Functions of a formula in the model and how many arguments they take."""

_FUZZYLITE = {name: name for name in FUNCTIONS} | {"fabs": "abs"}
_JFUZZYLOGIC = {
    "exp": "exp", "ln": "log", "log": "log10", "sin": "sin", "cos": "cos", "tan": "tan",
    "abs": "abs",
}  # fmt: skip


JFUZZYLOGIC_NAMES = {ours: theirs.upper() for theirs, ours in _JFUZZYLOGIC.items()}
"""Function of the model → jFuzzyLogic's name of it."""


class FormulaError(ValueError):
    """What is wrong with a formula, in words."""


@dataclass(frozen=True, slots=True)
class Node:
    """A number, a name, a function or an operator with its arguments."""

    symbol: str
    arguments: tuple[Node, ...] = ()
    is_call: bool = False


def read_formula(text: str, dialect: str) -> Node:
    """Parse `text` in the dialect ``fuzzylite``, ``jfuzzylogic`` or ``fuzzyarm``.

    Raises
    ------
    FormulaError
        Saying what is wrong.
    """
    parser = _Parser(_tokens(text), dialect)
    node = parser.sum(0)
    if parser.peek():
        raise FormulaError(f"'{parser.peek()}' is not expected there")
    return node


def without_constants(node: Node, variables: set[str]) -> Node:
    """Put the number in place of ``pi``, unless that is the name of a variable."""
    if node.symbol == "pi" and not node.arguments and "pi" not in variables:
        return Node(repr(math.pi))
    return replace(node, arguments=tuple(without_constants(a, variables) for a in node.arguments))


def names_in(node: Node) -> set[str]:
    """Return the variables of a formula."""
    if not node.arguments and not node.is_call:
        return {node.symbol} if not _is_number(node.symbol) and node.symbol != "pi" else set()
    return {name for argument in node.arguments for name in names_in(argument)}


def write_formula(
    node: Node, rename: dict[str, str] | None = None, functions: dict[str, str] | None = None
) -> str:
    """Return the text of a tree, with parentheses wherever a reader could hesitate.

    Parameters
    ----------
    node : Node
        The tree.
    rename : dict, optional
        Variables that are called otherwise in the text.
    functions : dict, optional
        Functions that are.
    """
    return _Text(rename or {}, functions or {}).of(node)


@dataclass(frozen=True, slots=True)
class _Text:
    rename: dict[str, str]
    functions: dict[str, str]

    def of(self, node: Node) -> str:
        if node.is_call:
            inner = ", ".join(map(self.of, node.arguments))
            return f"{self.functions.get(node.symbol, node.symbol)}({inner})"
        if not node.arguments:
            return self.rename.get(node.symbol, node.symbol)
        if len(node.arguments) == 1:
            return f"-{self._operand(node.arguments[0], '-', at_right=True)}"
        left, right = node.arguments
        first = self._operand(left, node.symbol, at_right=False)
        second = self._operand(right, node.symbol, at_right=True)
        return f"{first} {node.symbol} {second}"

    def _operand(self, node: Node, parent: str, *, at_right: bool) -> str:
        text = self.of(node)
        if node.is_call or not node.arguments:
            return text
        own = _BINDS.get(node.symbol, 0) if len(node.arguments) == 2 else 0
        above = _BINDS.get(parent, 9)
        clear = own > above or (own == above and not at_right and own < 3)
        return text if clear else f"({text})"


_BINDS = {"+": 1, "-": 1, "*": 2, "/": 2, "^": 3}
"""How tightly operators bind in every dialect; ``%`` is among none, as they differ."""


def _is_number(symbol: str) -> bool:
    return symbol[0].isdigit() or symbol[0] == "."


def _tokens(text: str) -> list[str]:
    tokens: list[str] = []
    position = 0
    stripped = text.rstrip()
    while position < len(stripped):
        match = _TOKEN.match(stripped, position)
        if match is None:
            raise FormulaError(f"'{stripped[position]}' is not part of a formula")
        tokens.append(match.group().strip())
        position = match.end()
        if len(tokens) > MAX_TOKENS:
            raise FormulaError(f"a formula may have {MAX_TOKENS} parts at most")
    if not tokens:
        raise FormulaError("the formula is empty")
    return tokens


class _Parser:
    def __init__(self, tokens: list[str], dialect: str) -> None:
        self.tokens = tokens
        self.dialect = dialect
        self.at = 0

    def peek(self) -> str:
        return self.tokens[self.at] if self.at < len(self.tokens) else ""

    def take(self) -> str:
        token = self.peek()
        self.at += 1
        return token

    def sum(self, depth: int) -> Node:
        if depth > MAX_DEPTH:
            raise FormulaError(f"a formula may nest {MAX_DEPTH} deep at most")
        node = self.product(depth)
        while self.peek() in ("+", "-"):
            node = Node(self.take(), (node, self.product(depth)))
        return node

    def product(self, depth: int) -> Node:
        node = self.signed(depth)
        operators = ("*", "/") if self.dialect == "jfuzzylogic" else ("*", "/", "%")
        while self.peek() in operators:
            node = Node(self.take(), (node, self.signed(depth)))
        return node

    def signed(self, depth: int) -> Node:
        if depth > MAX_DEPTH:
            raise FormulaError(f"a formula may nest {MAX_DEPTH} deep at most")
        token = self.peek()
        if token in ("-", "~", ".-"):
            self.take()
            return Node("-", (self.signed(depth + 1),))
        if token in ("+", ".+"):
            self.take()
            return self.signed(depth + 1)
        return self.power(depth)

    def power(self, depth: int) -> Node:
        node = self.atom(depth)
        if self.dialect == "jfuzzylogic":  # ^ and % alike, from the left
            while self.peek() in ("^", "%"):
                node = Node(self.take(), (node, self.atom(depth)))
        elif self.peek() in ("^", "**"):
            self.take()
            node = Node("^", (node, self.signed(depth + 1)))
        return node

    def atom(self, depth: int) -> Node:
        token = self.take()
        if token == "(":
            node = self.sum(depth + 1)
            self.expect(")")
            return node
        if not token:
            raise FormulaError("the formula ends too early")
        if _is_number(token) or (self.peek() != "(" and token[0].isidentifier()):
            return Node(token)
        if token[0].isidentifier():
            return self.call(token, depth)
        raise FormulaError(f"'{token}' is not expected there")

    def call(self, name: str, depth: int) -> Node:
        table = _JFUZZYLOGIC if self.dialect == "jfuzzylogic" else _FUZZYLITE
        function = table.get(name.lower())
        if function is None:
            raise FormulaError(f"the function '{name}' cannot be carried")
        self.expect("(")
        arguments = [self.sum(depth + 1)]
        while self.peek() == ",":
            self.take()
            arguments.append(self.sum(depth + 1))
        self.expect(")")
        if len(arguments) != FUNCTIONS[function]:
            raise FormulaError(f"'{name}' takes {FUNCTIONS[function]} argument(s)")
        return Node(function, tuple(arguments), is_call=True)

    def expect(self, token: str) -> None:
        if self.take() != token:
            raise FormulaError(f"a '{token}' is missing")
