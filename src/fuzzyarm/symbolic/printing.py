"""Expressions as source text: Python, C99, Structured Text, JavaScript, Rust.

An expression is first lowered to statements (:func:`statements`): a part with two uses becomes a
variable, a choice becomes an ``if``. A variable is set only where every path needs it, since a
part inside one branch may divide by the quantity that the condition guards; a branch not taken is
not evaluated, for which Structured Text has no expression. A :class:`Language` then prints them,
with the text of each operation.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from itertools import count
from typing import NamedTuple

from fuzzyarm.symbolic.nodes import (
    Apply,
    Constant,
    Node,
    Symbol,
    apply,
    children,
    postorder,
    symbol,
)
from fuzzyarm.symbolic.operations import OPERATIONS, Operation

DEEPEST = 24
"""Largest nesting of a printed expression before a part moves into a variable."""


class NotPrintableError(Exception):
    """A language lacks an operation.

    Attributes
    ----------
    operation : str
        The operation.
    language : str
        The language.
    """

    def __init__(self, operation: str, language: str) -> None:
        super().__init__(f"{language} has no function for '{operation}'")
        self.operation = operation
        self.language = language


class Assign(NamedTuple):
    """Set a variable; the remark becomes a comment."""

    name: str
    value: Node
    remark: str = ""


class Choose(NamedTuple):
    """Run one of two lists of statements; both set the variable `name`."""

    name: str
    condition: Node
    then: tuple[Statement, ...]
    otherwise: tuple[Statement, ...]


Statement = Assign | Choose


# ── expressions to statements ────────────────────────────────────────────────────────


def statements(
    root: Node, *, prefix: str = "t", reserved: Iterable[str] = ()
) -> tuple[tuple[Statement, ...], Node]:
    """Lower an expression to statements and a result without choices.

    Parameters
    ----------
    root : Node
        The expression.
    prefix : str
        Variables are named `prefix` and a number.
    reserved : iterable of str
        Names not to be used.

    Returns
    -------
    statements : tuple of Assign or Choose
        In order.
    result : Node
        Expression over the variables of the statements.
    """
    return _Lowering(root, prefix, frozenset(reserved)).run()


class _Lowering:
    def __init__(self, root: Node, prefix: str, reserved: frozenset[str]) -> None:
        self.root = root
        self.uses = Counter(child for node in postorder(root) for child in children(node))
        self.names = (f"{prefix}{i}" for i in count() if f"{prefix}{i}" not in reserved)
        self.certain: dict[Node, frozenset[Node]] = {}
        self.depth: dict[Node, float] = {}
        for node in postorder(root):
            self.certain[node] = self._certain(node)

    def run(self) -> tuple[tuple[Statement, ...], Node]:
        body: list[Statement] = []
        result = self.write(self.root, {}, body)
        return tuple(body), result

    def _certain(self, node: Node) -> frozenset[Node]:
        """Return the shared parts evaluated whenever `node` is."""
        if not isinstance(node, Apply):
            return frozenset()
        parts = [self.certain[child] for child in node.arguments]
        if node.operation == "where":
            nodes = parts[0] | (parts[1] & parts[2])
        elif node.operation in {"both", "either"}:
            nodes = parts[0]  # the second condition may be unguarded alone
        else:
            nodes = frozenset[Node]().union(*parts)
        return nodes | {node} if self.uses[node] > 1 else nodes

    def write(self, node: Node, computed: dict[Node, Node], body: list[Statement]) -> Node:
        """Return `node` in terms of variables, appending the statements that set them to `body`.

        `computed` holds the parts whose variables are set on every path to this point of `body`.
        """
        waiting: list[tuple[Node, bool]] = [(node, False)]
        while waiting:
            current, ready = waiting.pop()
            if current in computed:
                continue
            if not isinstance(current, Apply):
                computed[current] = current
            elif current.operation == "where":
                self._choose(current, computed, body)
            elif current.operation in {"both", "either"} and not ready:
                waiting += [(current, True), (current.arguments[0], False)]
            elif not ready:
                waiting.append((current, True))
                waiting += [(child, False) for child in reversed(current.arguments)]
            else:
                computed[current] = self._applied(current, computed, body)
        return computed[node]

    def _applied(self, node: Apply, computed: dict[Node, Node], body: list[Statement]) -> Node:
        if node.operation in {"both", "either"}:
            # Parts of the second condition must not be set before the first holds.
            second = self.write(node.arguments[1], dict(computed), body)
            arguments: tuple[Node, ...] = (computed[node.arguments[0]], second)
        else:
            arguments = tuple(computed[child] for child in node.arguments)
        copy = apply(node.operation, *arguments)
        self.depth[copy] = 1 + max(self.depth.get(argument, 0) for argument in arguments)
        shared = self.uses[node] > 1 and not OPERATIONS[node.operation].is_condition
        # A chain such as a + b + c prints without nesting: its left side hardly counts as depth.
        if OPERATIONS[node.operation].binds < 9 and isinstance(arguments[0], Apply):
            rest = [self.depth.get(argument, 0) + 1 for argument in arguments[1:]]
            self.depth[copy] = max([self.depth.get(arguments[0], 0) + 1 / 8, *rest])
        if not shared and self.depth[copy] < DEEPEST:
            return copy
        name = next(self.names)
        body.append(Assign(name, copy))
        return symbol(name)

    def _choose(self, node: Apply, computed: dict[Node, Node], body: list[Statement]) -> None:
        condition = self.write(node.arguments[0], computed, body)
        for part in postorder(node):  # parts of both branches are set before them
            if part in self.certain[node] and part is not node:
                self.write(part, computed, body)
        name = next(self.names)
        branches = []
        for branch in node.arguments[1:]:
            inner: list[Statement] = []
            value = self.write(branch, dict(computed), inner)
            branches.append(setting(name, inner, value))
        body.append(Choose(name, condition, branches[0], branches[1]))
        computed[node] = symbol(name)


def setting(
    name: str, body: Sequence[Statement], value: Node, remark: str = ""
) -> tuple[Statement, ...]:
    """Return statements that set a variable to the value computed by `body`.

    If the last one sets a variable only for this, it sets `name` instead.
    """
    if body and value is symbol(body[-1].name):
        return (*body[:-1], _renamed(body[-1], name, remark))
    return (*body, Assign(name, value, remark))


def _renamed(statement: Statement, name: str, remark: str) -> Statement:
    if isinstance(statement, Assign):
        return Assign(name, statement.value, remark)
    then, otherwise = (
        (*branch[:-1], _renamed(branch[-1], name, remark))
        for branch in (statement.then, statement.otherwise)
    )
    return Choose(name, statement.condition, then, otherwise)


# ── statements to text ───────────────────────────────────────────────────────────────


class Language(NamedTuple):
    """The syntax of a language.

    Attributes
    ----------
    name : str
        Name in messages.
    text : callable
        From an operation to its text with holes, empty if missing.
    number : callable
        From a float to its text.
    assign, declare : str
        A statement that sets a variable, and one that declares it as well; holes ``name`` and
        ``value``.
    declare_only : str
        A declaration without a value; empty if there is none.
    choose : tuple of str
        Lines before, between and after the branches; the first has a hole ``condition``.
    remark : str
        Text after a statement with a remark.
    rename : dict of str to str
        Texts of symbols not written by their names.
    explicit : bool
        Whether operators of different precedence need parentheses, as MISRA C demands.
    leaf : callable, optional
        From a node of programs only, and the required precedence, to its text.
    """

    name: str
    text: Callable[[Operation], str]
    number: Callable[[float], str]
    assign: str
    declare: str
    declare_only: str
    choose: tuple[str, str, str]
    remark: str
    rename: dict[str, str]
    explicit: bool = False
    leaf: Callable[[Node, int], str] | None = None

    def expression(self, node: Node, binds: int = 0) -> str:
        """Return the text of an expression, in parentheses if it binds less than `binds`."""
        if isinstance(node, Constant):
            text = self.number(node.value)
            return f"({text})" if text.startswith("-") and binds > 5 else text
        if isinstance(node, Symbol):
            return self.rename.get(node.name, node.name)
        if self.leaf is not None and not isinstance(node, Apply):
            return self.leaf(node, binds)
        assert isinstance(node, Apply)
        return self._applied(node, binds)

    def _applied(self, node: Apply, binds: int) -> str:
        operation = OPERATIONS[node.operation]
        template = self.text(operation)
        if not template:
            raise NotPrintableError(node.operation, self.name)
        binding = operation.binds
        if binding == 9:
            parts = [self.expression(argument) for argument in node.arguments]
            return template.format(*parts)
        # Left-associative: only the left operand may have the precedence of the operator.
        inner = 3 if operation.sort == "logic" else binding + 1  # && within || in parentheses, too
        if node.operation == "negation":  # in C and Structured Text it binds more than any other
            inner = 8
        first = node.arguments[0]
        same = isinstance(first, Apply) and first.operation == node.operation
        chained = operation.arity == 2 and (same or operation.sort != "logic")
        least = [binding if chained else inner, *(inner for _ in node.arguments[1:])]
        if self.explicit and operation.arity > 1:
            pairs = zip(node.arguments, least, strict=True)
            least = [
                9 if _binds_unlike(argument, binding) else own_least
                for argument, own_least in pairs
            ]
        parts = [self.expression(*pair) for pair in zip(node.arguments, least, strict=True)]
        text = template.format(*parts)
        return f"({text})" if binding < binds else text

    def lines(self, body: Sequence[Statement], *, declared: Iterable[str] = ()) -> list[str]:
        """Return the lines of some statements; the variables in `declared` exist already."""
        declared = set(declared)
        lines: list[str] = []
        for statement in body:
            name = statement.name
            if isinstance(statement, Assign):
                template = self.assign if name in declared else self.declare
                declared.add(name)
                value = self.expression(statement.value)
                remark = self.remark.format(statement.remark) if statement.remark else ""
                lines.append(template.format(name=name, value=value) + remark)
                continue
            if name not in declared and self.declare_only:
                lines.append(self.declare_only.format(name=name))
            declared.add(name)
            before, between, behind = self.choose
            lines.append(before.format(condition=self.expression(statement.condition)))
            lines += [f"    {line}" for line in self.lines(statement.then, declared=declared)]
            lines.append(between)
            lines += [f"    {line}" for line in self.lines(statement.otherwise, declared=declared)]
            if behind:
                lines.append(behind)
        return lines


def _binds_unlike(node: Node, binds: int) -> bool:
    """Whether a node is an operation of several operands with another precedence than `binds`."""
    if not isinstance(node, Apply):
        return False
    operation = OPERATIONS[node.operation]
    return operation.arity > 1 and operation.binds != binds


def printed(
    root: Node, language: Language, *, reserved: Iterable[str] = ()
) -> tuple[list[str], str]:
    """Return the lines that compute an expression, and the text of its value."""
    body, result = statements(root, reserved=reserved)
    return language.lines(body), language.expression(result)


def _python_number(value: float) -> str:
    return repr(value) if math.isfinite(value) else f'float("{value}")'


PYTHON = Language(
    "Python",
    lambda operation: operation.python,
    _python_number,
    "{name} = {value}",
    "{name} = {value}",
    "",
    ("if {condition}:", "else:", ""),
    "  # {}",
    {},
)
"""Python over floats, for the interpreter."""


def c_language(real: str = "double") -> Language:
    """Return C99 in double or in single precision (`real` is ``double`` or ``float``)."""
    suffix = "f" if real == "float" else ""

    def text(operation: Operation) -> str:
        if operation.c.startswith("@"):
            return operation.c[1:].replace("(", f"{suffix}(", 1)
        return operation.c

    def number(value: float) -> str:
        if math.isnan(value):
            return "NAN"
        if math.isinf(value):
            return "INFINITY" if value > 0.0 else "-INFINITY"
        return repr(value) + suffix

    return Language(
        "C",
        text,
        number,
        "{name} = {value};",
        f"const {real} {{name}} = {{value}};",
        f"{real} {{name}};",
        ("if ({condition}) {{", "} else {", "}"),
        " /* {} */",
        {},
        explicit=True,
    )


def javascript_number(value: float) -> str:
    """Return a float in JavaScript."""
    if math.isfinite(value):
        return repr(float(value))
    return "NaN" if math.isnan(value) else "Infinity" if value > 0.0 else "-Infinity"


JAVASCRIPT = Language(
    "JavaScript",
    lambda operation: operation.js or operation.c,
    javascript_number,
    "{name} = {value};",
    "const {name} = {value};",
    "let {name};",
    ("if ({condition}) {{", "} else {", "}"),
    "  // {}",
    {},
)
"""JavaScript; `min`, `max`, `power`, `rint` and `remainder` are defined by the export."""


def _structured_number(value: float) -> str:
    if not math.isfinite(value):
        raise NotPrintableError("an infinite number", "Structured Text")
    return repr(value).replace("e", "E")


STRUCTURED_TEXT = Language(
    "Structured Text",
    lambda operation: operation.st,
    _structured_number,
    "{name} := {value};",
    "{name} := {value};",
    "",
    ("IF {condition} THEN", "ELSE", "END_IF;"),
    " (* {} *)",
    {},
)
"""IEC 61131-3 Structured Text; its variables are declared separately, see `variables`."""


def variables(body: Sequence[Statement]) -> tuple[str, ...]:
    """Return the variables that statements set, each once, in order."""
    names: dict[str, None] = {}
    for statement in body:
        names.setdefault(statement.name)
        if isinstance(statement, Choose):
            names.update(dict.fromkeys(variables(statement.then)))
            names.update(dict.fromkeys(variables(statement.otherwise)))
    return tuple(names)
