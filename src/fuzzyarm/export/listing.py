"""A program as the statements of a C function, and what they cost.

Each part that has a name becomes a variable. Straight terms stay conditional expressions;
what needs a part of its own twice is written with more variables and ``if``, so that
nothing is computed twice or in vain.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from fuzzyarm.export.numbers import C_TYPES, c_number
from fuzzyarm.export.program import Call, Program
from fuzzyarm.export.routine import CWriter
from fuzzyarm.expression.nodes import (
    Apply,
    Constant,
    Node,
    Symbol,
    apply,
    children,
    postorder,
    symbol,
    symbols,
)
from fuzzyarm.expression.operations import OPERATIONS, Operation
from fuzzyarm.expression.printing import (
    Assign,
    Language,
    Statement,
    c_language,
    setting,
    statements,
    variables,
)

_DEEPEST = 110
"""Nesting of one expression before parts of it go into variables (compilers take 127)."""

_HELPERS = {"minimum": ("least", "<"), "maximum": ("greatest", ">")}

_ONE_OF_TWO = """TYPE NAME(TYPE a, TYPE b)
{
    return b SIGN a ? b : a; /* the first of equal ones */
}
"""


def uses_functions(root: Node) -> bool:
    """Return whether an expression needs functions of the mathematical library."""
    return any(
        isinstance(node, Apply) and OPERATIONS[node.operation].sort == "functions"
        for node in postorder(root)
    )


def needs_math_header(root: Node) -> bool:
    """Return whether an expression needs ``math.h``: for functions, NaN or infinity."""
    return uses_functions(root) or any(
        isinstance(node, Constant) and not math.isfinite(node.value) for node in postorder(root)
    )


class Listing:
    """The statements of a program.

    Attributes
    ----------
    body : list of Statement
        In order; a name that comes again is a variable that is set again.
    result : Node
        What the function returns, of these variables.
    reads : set of str
        All symbols that are read.
    """

    def __init__(self, program: Program) -> None:
        self._calls: dict[str, tuple[Call, Node]] = {}
        written, result = self._in_variables(program)
        taken = {*program.given, *(each.name for each in program.variables)}
        self.reads = self._symbols(result)
        needed = []
        for each in reversed(written):
            if each.name in self.reads:
                self.reads |= self._symbols(each.value)
                needed.append(each)
        self.body: list[Statement] = []
        for each in reversed(needed):
            body, value = _spread(each.name, each.value, taken)
            taken |= set(variables(body))
            self.body += setting(each.name, body, value, each.remark)
        body, self.result = _spread("result", result, taken)
        self.body += body

    # ── parts to variables ───────────────────────────────────────────────────────────

    def _in_variables(self, program: Program) -> tuple[list[Assign], Node]:
        """Return the variables and the result, each of the variables before it.

        A variable that is set more than once stands for its last part only: before that,
        another use of a part is written out.
        """
        last = {each.name: index for index, each in enumerate(program.variables)}
        known: dict[Node, Node] = {}
        growing: dict[str, Node] = {}
        written = []
        for index, each in enumerate(program.variables):
            before = growing.get(each.name)
            if each.value is not before:  # else nothing was added: it is closed here
                own = {} if before is None else {before: symbol(each.name)}
                value = self._written(each.value, program.calls, known, own)
                written.append(replace(each, value=value))
            growing[each.name] = each.value
            if index == last[each.name]:
                known[each.value] = symbol(each.name)
        return written, self._written(program.result, program.calls, known, {})

    def _written(
        self,
        root: Node,
        calls: Mapping[Node, Call],
        known: Mapping[Node, Node],
        own: Mapping[Node, Node],
    ) -> Node:
        made: dict[Node, Node] = {}
        waiting = [(root, False)]
        while waiting:
            node, ready = waiting.pop()
            if node in own or node in known:
                made[node] = own[node] if node in own else known[node]
                continue
            call = calls.get(node)
            parts = children(node) if call is None else (call.argument,)
            if not ready:
                waiting += [(node, True), *((part, False) for part in parts if part not in made)]
            elif call is not None:
                made[node] = self._called(call, made[call.argument])
            elif isinstance(node, Apply):
                made[node] = apply(node.operation, *(made[part] for part in parts))
            else:
                made[node] = node
        return made[root]

    def _called(self, call: Call, argument: Node) -> Node:
        """Return a symbol that is printed as the call of a function."""
        name = f"call {len(self._calls)}"
        self._calls[name] = (call, argument)
        return symbol(name)

    def _symbols(self, value: Node) -> set[str]:
        found = set(symbols(value))
        inner = [self._symbols(self._calls[name][1]) for name in found & set(self._calls)]
        return found.union(*inner)

    # ── cost ─────────────────────────────────────────────────────────────────────────

    def operations(self) -> Counter[str]:
        """Return how many operations of each sort are done at most, never both branches."""
        return self._count([*self.body, Assign("result", self.result)])

    def _count(self, body: Iterable[Statement]) -> Counter[str]:
        total: Counter[str] = Counter()
        for statement in body:
            if isinstance(statement, Assign):
                total += self._count_node(statement.value)
            else:
                total += self._count_node(statement.condition)
                total += self._count(statement.then) | self._count(statement.otherwise)
        return total

    def _count_node(self, node: Node) -> Counter[str]:
        if not isinstance(node, Apply):
            called = self._calls.get(node.name) if isinstance(node, Symbol) else None
            if called is None:
                return Counter()
            function, argument = called
            return self._count(_function_body(function)) + self._count_node(argument)
        first, *rest = (self._count_node(child) for child in node.arguments)
        if node.operation == "where":
            return first + (rest[0] | rest[1])
        sort = OPERATIONS[node.operation].sort.removesuffix(" of two")
        own = Counter() if sort == "logic" else Counter({sort: 1})
        return sum(rest, first) + own

    # ── text ─────────────────────────────────────────────────────────────────────────

    def lines(self, writer: CWriter, real: type[np.floating]) -> tuple[list[str], str]:
        """Return the lines of C in a type of number, and the text of the result."""
        language = _language(writer, real)
        for name, (call, argument) in self._calls.items():
            if name in self.reads:
                function = writer.helper(call.wanted, _function(call, language, C_TYPES[real]))
                language.rename[name] = f"{function}({language.expression(argument)})"
        times_set = Counter(each.name for each in self.body)
        set_before: set[str] = set()
        lines = []
        for each in self.body:
            again = isinstance(each, Assign) and times_set[each.name] > 1
            text = language.lines([each], made={each.name} if again else set_before)
            if again and each.name not in set_before:
                text[0] = f"{C_TYPES[real]} {text[0]}"  # not const: it is set again
            set_before.add(each.name)
            lines += text
        return lines, language.expression(self.result)


def _spread(name: str, root: Node, taken: Iterable[str]) -> tuple[tuple[Statement, ...], Node]:
    """Return statements that set the shared parts of an expression, and what it then is."""
    if not _needs_variables(root):
        return (), root
    return statements(root, prefix=f"{name}_", taken=taken)


def _needs_variables(root: Node) -> bool:
    """Return whether an operation in `root` is needed twice, or it nests too deep."""
    seen: set[Node] = set()
    depth: dict[Node, int] = {}
    for node in postorder(root):
        operands = [child for child in children(node) if isinstance(child, Apply)]
        if not seen.isdisjoint(operands) or len(set(operands)) < len(operands):
            return True
        seen |= set(operands)
        depth[node] = 1 + max((depth[child] for child in operands), default=0)
    return depth[root] > _DEEPEST


def _function_body(call: Call) -> list[Statement]:
    body, result = statements(call.body, prefix="x", taken=("h",))
    return [*body, Assign("", result)]


def _function(call: Call, language: Language, real: str) -> str:
    """Return the text of a function of ``h``, with NAME for its name."""
    *body, last = _function_body(call)
    assert isinstance(last, Assign)
    lines = [f"    {line}" for line in language.lines(body)]
    result = language.expression(last.value)
    return "\n".join([f"{real} NAME({real} h)", "{", *lines, f"    return {result};", "}", ""])


def _language(writer: CWriter, real: type[np.floating]) -> Language:
    """Return C with the helpers of a file and the literals of its tables."""
    kind = C_TYPES[real]
    basis = c_language(kind)

    def text(operation: Operation) -> str:
        if operation.name not in _HELPERS:
            return basis.text(operation)
        wanted, sign = _HELPERS[operation.name]
        return f"{writer.helper(wanted, _ONE_OF_TWO, TYPE=kind, SIGN=sign)}({{0}}, {{1}})"

    def number(value: float) -> str:
        if math.isfinite(value):
            return c_number(value, real)
        name = "NAN" if math.isnan(value) else "INFINITY"
        sign = "-" if value < 0.0 else ""
        return f"{sign}{name}" if kind == "float" else f"{sign}({kind}){name}"

    return replace(basis, text=text, number=number, rename={})
