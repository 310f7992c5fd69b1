"""Arithmetic in the text of a ``formula``: read it, say where it is wrong, evaluate it.

A formula is numbers, names, ``+ - * / % ^`` (``**`` is the same as ``^``), unary minus and
plus, parentheses and the functions of :data:`FUNCTIONS`. It is parsed, never handed to
Python. ``^`` binds tightest and from the right (``2 ^ 3 ^ 2`` is 512, ``-2 ^ 2`` is −4).
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from fuzzyarm.errors import FuzzyarmError

MAX_DEPTH = 100
"""How deep parentheses and signs may nest."""

CONSTANTS: dict[str, float] = {"pi": math.pi}
"""Names with a value of their own, unless a variable has the same name."""


class FormulaError(FuzzyarmError, ValueError):
    """A formula that cannot be read or has no value.

    Attributes
    ----------
    text : str
        The formula.
    position : int
        Index of the character at fault, from 0; the length of the text at its end.
    """

    def __init__(self, message: str, text: str, position: int = 0) -> None:
        super().__init__(message)
        self.text = text
        self.position = position


@dataclass(frozen=True, slots=True)
class Number:
    """A number."""

    value: float


@dataclass(frozen=True, slots=True)
class Name:
    """A variable, looked up when the formula is evaluated."""

    name: str
    position: int = 0


@dataclass(frozen=True, slots=True)
class Call:
    """An operator or a function on its arguments; operators are called by their sign."""

    function: str
    arguments: tuple[Node, ...]


Node = Number | Name | Call

_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)"
    r"|(?P<name>[^\W\d]\w*(?:\.\w+)*)|'(?P<quoted>[^']*)'|(?P<sign>\*\*|[-+*/%^(),]))"
)


def _power(base: float, exponent: float) -> float:
    try:
        value = base**exponent
    except ZeroDivisionError:
        return math.copysign(math.inf, base) if exponent % 2.0 == 1.0 else math.inf
    except OverflowError:
        return math.copysign(math.inf, base) if exponent % 2.0 == 1.0 else math.inf
    return value if isinstance(value, float) else math.nan


def _divide(a: float, b: float) -> float:
    if b == 0.0:
        return math.nan if a == 0.0 or math.isnan(a) else math.copysign(math.inf, a) * _sign(b)
    return a / b


def _sign(b: float) -> float:
    return math.copysign(1.0, b)


def _quiet(function: Callable[..., float], at_fault: float = math.nan) -> Callable[..., float]:
    """Give NaN (or `at_fault`) where the mathematics has no value, as arrays do."""

    def quiet(*arguments: float) -> float:
        try:
            return float(function(*arguments))
        except OverflowError:
            return math.inf
        except ValueError:
            return at_fault

    return quiet


def _log(x: float) -> float:
    return -math.inf if x == 0.0 else math.log(x)


def _log10(x: float) -> float:
    return -math.inf if x == 0.0 else math.log10(x)


FUNCTIONS: dict[str, tuple[int, Callable[..., float]]] = {
    "+": (2, lambda a, b: a + b),
    "-": (2, lambda a, b: a - b),
    "*": (2, lambda a, b: a * b),
    "/": (2, _divide),
    "%": (2, _quiet(math.fmod)),
    "^": (2, _power),
    "neg": (1, lambda a: -a),
    "sin": (1, _quiet(math.sin)),
    "cos": (1, _quiet(math.cos)),
    "tan": (1, _quiet(math.tan)),
    "asin": (1, _quiet(math.asin)),
    "acos": (1, _quiet(math.acos)),
    "atan": (1, math.atan),
    "sinh": (1, lambda a: math.copysign(_quiet(math.sinh)(abs(a)), a)),
    "cosh": (1, _quiet(math.cosh)),
    "tanh": (1, math.tanh),
    "exp": (1, _quiet(math.exp)),
    "log": (1, _quiet(_log)),
    "log10": (1, _quiet(_log10)),
    "sqrt": (1, _quiet(math.sqrt)),
    "abs": (1, abs),
    "floor": (1, lambda a: float(math.floor(a)) if math.isfinite(a) else a),
    "ceil": (1, lambda a: float(math.ceil(a)) if math.isfinite(a) else a),
    "round": (1, lambda a: float(round(a)) if math.isfinite(a) else a),
    "min": (2, min),
    "max": (2, max),
    "pow": (2, _power),
    "atan2": (2, math.atan2),
    "fmod": (2, _quiet(math.fmod)),
}
"""Number of arguments and meaning of every operator and function, over floats."""


class _Parser:
    """Recursive descent over the tokens of one formula."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = list(_tokens(text))
        self.index = 0
        self.depth = 0

    def take(self, *signs: str) -> str | None:
        kind, value, _ = self.tokens[self.index]
        if kind == "sign" and value in signs:
            self.index += 1
            return value
        return None

    def fail(self, message: str) -> FormulaError:
        return FormulaError(message, self.text, self.tokens[self.index][2])

    def expect(self, sign: str) -> None:
        if not self.take(sign):
            raise self.fail(f"expected '{sign}' {self.found()}")

    def found(self) -> str:
        kind, value, _ = self.tokens[self.index]
        return "but the formula ends" if kind == "end" else f"but found '{value}'"

    def chain(self, signs: tuple[str, ...], operand: Callable[[], Node]) -> Node:
        left = operand()
        while sign := self.take(*signs):
            left = Call(sign, (left, operand()))
        return left

    def sum(self) -> Node:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise self.fail(f"nested deeper than {MAX_DEPTH} levels")
        node = self.chain(("+", "-"), lambda: self.chain(("*", "/", "%"), self.signed))
        self.depth -= 1
        return node

    def signed(self) -> Node:
        negative = False
        while sign := self.take("+", "-"):
            negative ^= sign == "-"
        node = self.power()
        return Call("neg", (node,)) if negative else node

    def power(self) -> Node:
        base = self.atom()
        if not self.take("^", "**"):
            return base
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise self.fail(f"nested deeper than {MAX_DEPTH} levels")
        node = Call("^", (base, self.signed()))
        self.depth -= 1
        return node

    def atom(self) -> Node:
        kind, value, position = self.tokens[self.index]
        if kind == "number":
            self.index += 1
            return Number(float(value))
        if kind in {"name", "quoted"}:
            self.index += 1
            if kind == "name" and self.take("("):
                return self.call(value, position)
            return Name(value, position)
        if self.take("("):
            node = self.sum()
            self.expect(")")
            return node
        raise self.fail(f"expected a number, a name or '(' {self.found()}")

    def call(self, function: str, position: int) -> Node:
        arity = FUNCTIONS[function][0] if function in FUNCTIONS else None
        if arity is None or function == "neg":
            raise FormulaError(f"there is no function '{function}'", self.text, position)
        arguments = [self.sum()]
        while self.take(","):
            arguments.append(self.sum())
        self.expect(")")
        variadic = function in {"min", "max"} and len(arguments) > arity
        if len(arguments) != arity and not variadic:
            counted = "one argument" if arity == 1 else f"{arity} arguments"
            raise FormulaError(f"'{function}' takes {counted}", self.text, position)
        node: Node = Call(function, tuple(arguments[:arity]))
        for argument in arguments[arity:]:
            node = Call(function, (node, argument))
        return node


def _tokens(text: str) -> Iterator[tuple[str, str, int]]:
    position, end = 0, len(text.rstrip())
    while position < end:
        match = _TOKEN.match(text, position)
        if match is None or match.lastgroup is None:
            start = position + len(text[position:]) - len(text[position:].lstrip())
            raise FormulaError(f"'{text[start]}' has no meaning here", text, start)
        yield match.lastgroup, match[match.lastgroup], match.start(match.lastgroup)
        position = match.end()
    yield "end", "", len(text)


def parse_formula(text: str) -> Node:
    """Read a formula.

    Parameters
    ----------
    text : str
        For instance ``2 * e - sin(ce) ^ 2``; a name that is no identifier stands in
        single quotes.

    Returns
    -------
    Number or Name or Call
        The tree; two texts that mean the same sum differ where their trees do.

    Raises
    ------
    FormulaError
        With the position of the first character at fault.
    """
    parser = _Parser(text)
    node = parser.sum()
    if parser.tokens[parser.index][0] != "end":
        raise parser.fail(f"expected an operator {parser.found()}")
    return node


def names(node: Node) -> tuple[str, ...]:
    """Return the variables of a formula, each once, in order of appearance.

    Constants (:data:`CONSTANTS`) are among them: a variable may have that name.
    """
    if isinstance(node, Name):
        return (node.name,)
    if isinstance(node, Call):
        return tuple(dict.fromkeys(name for part in node.arguments for name in names(part)))
    return ()


def evaluate(node: Node, values: Mapping[str, float]) -> float:
    """Return the value of a formula.

    Parameters
    ----------
    node : Number or Name or Call
        As from :func:`parse`.
    values : mapping of str to float
        A value for every name.

    Returns
    -------
    float
        NaN or infinite where arithmetic is (``1 / 0``, ``sqrt(-1)``).

    Raises
    ------
    FormulaError
        If a name has no value.
    """
    if isinstance(node, Number):
        return node.value
    if isinstance(node, Name):
        if node.name in values:
            return values[node.name]
        if node.name in CONSTANTS:
            return CONSTANTS[node.name]
        raise FormulaError(f"'{node.name}' is no variable", node.name, node.position)
    return FUNCTIONS[node.function][1](*(evaluate(part, values) for part in node.arguments))
