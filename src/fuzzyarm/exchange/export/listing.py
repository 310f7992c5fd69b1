"""A program as the statements of a C function, and their cost.

Each named part becomes a variable. Straight terms stay conditional expressions; a part used twice
gets more variables and ``if``, so that nothing is computed twice or in vain.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

from fuzzyarm.exchange.export.program import Call, OutputProgram
from fuzzyarm.exchange.export.samples import SampleSums
from fuzzyarm.exchange.export.walk import DefuzzifierWalk
from fuzzyarm.symbolic.nodes import Apply, Node, Symbol, apply, children, postorder, symbol, symbols
from fuzzyarm.symbolic.nodes import replace as substitute
from fuzzyarm.symbolic.operations import OPERATIONS
from fuzzyarm.symbolic.printing import Assign, Statement, setting, statements, variables

_DEEPEST = 110
"""Nesting of one expression before parts of it go into variables (compilers take 127)."""

WALKED = "defuzzified"
"""Ends the name of a function that walks over tables."""


def uses_functions(nodes: Iterable[Node]) -> bool:
    """Return whether there are functions of the mathematical library among some operations."""
    return any(
        isinstance(node, Apply) and OPERATIONS[node.operation].sort == "functions" for node in nodes
    )


def operations_of(
    node: Node, called: Callable[[str], Counter[str]] | None = None, *, least: bool = False
) -> Counter[str]:
    """Return the number of operations of each sort in an expression, never both branches.

    `called` has the cost of a symbol that replaces a call; `least` takes the branch of fewer
    operations instead of the most of each sort.
    """
    if not isinstance(node, Apply):
        return called(node.name) if called and isinstance(node, Symbol) else Counter()
    first, *rest = (operations_of(child, called, least=least) for child in node.arguments)
    if node.operation == "where":
        fewer = min(rest, key=lambda count: count.total())
        return first + (fewer if least else rest[0] | rest[1])
    sort = OPERATIONS[node.operation].sort.removesuffix(" of two")
    operations = Counter() if sort == "logic" else Counter({sort: 1})
    return sum(rest, first) + operations


@dataclass(frozen=True)
class Loop:
    """Statements run for each sample; the sums are set to 0 before."""

    sums: SampleSums  # of its program
    body: tuple[Statement, ...]  # in terms of the variables of the program


@dataclass(frozen=True)
class Walked:
    """A walk over tables, which sets two variables."""

    walk: DefuzzifierWalk  # of its program
    parts: tuple[Node, ...]  # in terms of the variables of the program


class Listing:
    """The statements of a program.

    Attributes
    ----------
    body : list of Statement
        In order; a repeated name is a variable set again.
    result : Node
        The value of the function, of these variables.
    reads : set of str
        All symbols read.
    names : set of str
        Of all variables.
    """

    def __init__(self, program: OutputProgram) -> None:
        # By its symbol, a call and its argument; inner ones first.
        self.calls: dict[str, tuple[Call, Node]] = {}
        assignments, result = self._in_variables(program)
        self.reads = self._symbols(result)
        steps = []
        for step in reversed(assignments):
            if self.reads.isdisjoint(_sets(step)):
                continue
            steps.append(step)
            if isinstance(step, Walked):
                self.reads = self.reads.union(*map(self._symbols, step.parts))
                continue
            inner = step.body if isinstance(step, Loop) else (step,)
            for statement in inner:
                assert isinstance(statement, Assign)
                self.reads |= self._symbols(statement.value)
        self.names: set[str] = {
            *program.symbols,
            *(name for variable in program.variables for name in _sets(variable)),
        }
        self.body: list[Statement | Loop | Walked] = []
        for step in reversed(steps):
            if isinstance(step, Walked):
                self.body.append(self._named_parts(step))
            elif isinstance(step, Loop):
                inner = tuple(s for assign in step.body for s in self._spread_out(assign))
                self.body.append(replace(step, body=inner))
            else:
                self.body += self._spread_out(step)
        body, self.result = spread("result", result, self.names)
        self.body += body

    # ── parts to variables ───────────────────────────────────────────────────────────

    def _in_variables(self, program: OutputProgram) -> tuple[list[Assign | Loop | Walked], Node]:
        """Return the variables and the result, each of the variables before it.

        A variable set more than once names its last part only: earlier uses of a part are written
        out.
        """
        last = {name: i for i, variable in enumerate(program.variables) for name in _sets(variable)}
        nodes: dict[Node, Node] = {}
        growing: dict[str, Node] = {}
        assignments: list[Assign | Loop | Walked] = []
        for index, variable in enumerate(program.variables):
            if isinstance(variable, DefuzzifierWalk):
                parts_of_walk = (self._written(p, program.calls, nodes, {}) for p in variable.parts)
                assignments.append(Walked(variable, tuple(parts_of_walk)))
                continue
            if isinstance(variable, SampleSums):
                parts = {
                    name: self._written(part, program.calls, nodes, {})
                    for name, part in variable.parts.items()
                }
                columns = {name: symbol(element(variable, name)) for name in variable.columns}
                body = (
                    step._replace(value=substitute(step.value, {**parts, **columns}))
                    for step in variable.body
                )
                assignments.append(Loop(variable, tuple(body)))
                continue
            before = growing.get(variable.name)
            if variable.value is not before:  # else nothing was added: it is closed here
                aliases = {} if before is None else {before: symbol(variable.name)}
                value = self._written(variable.value, program.calls, nodes, aliases)
                assignments.append(variable._replace(value=value))
            growing[variable.name] = variable.value
            if index == last[variable.name]:
                nodes[variable.value] = symbol(variable.name)
        return assignments, self._written(program.result, program.calls, nodes, {})

    def _written(
        self,
        root: Node,
        calls: Mapping[Node, Call],
        earlier: Mapping[Node, Node],
        local: Mapping[Node, Node],
    ) -> Node:
        nodes: dict[Node, Node] = {}
        waiting = [(root, False)]
        while waiting:
            node, ready = waiting.pop()
            if node in local or node in earlier:
                nodes[node] = local[node] if node in local else earlier[node]
                continue
            call = calls.get(node)
            parts = children(node) if call is None else (call.argument,)
            if not ready:
                waiting += [(node, True), *((part, False) for part in parts if part not in nodes)]
            elif call is not None:
                nodes[node] = self._called(call, nodes[call.argument])
            elif isinstance(node, Apply):
                nodes[node] = apply(node.operation, *(nodes[part] for part in parts))
            else:
                nodes[node] = node
        return nodes[root]

    def _called(self, call: Call, argument: Node) -> Node:
        """Return a symbol printed as the call of a function."""
        name = f"call {len(self.calls)}"
        self.calls[name] = (call, argument)
        return symbol(name)

    def _symbols(self, value: Node) -> set[str]:
        names = set(symbols(value))
        inner = [self._symbols(self.calls[name][1]) for name in names & set(self.calls)]
        return names.union(*inner)

    def _named_parts(self, statement: Walked) -> Walked:
        """Name the parts of a walk that take more than one statement."""
        parts = []
        for part in statement.parts:
            body, value = spread(statement.walk.total, part, self.names)
            self.names |= set(variables(body))
            self.body += body
            parts.append(value)
        return replace(statement, parts=tuple(parts))

    def _spread_out(self, statement: Statement) -> tuple[Statement, ...]:
        assert isinstance(statement, Assign)
        body, value = spread(statement.name, statement.value, self.names)
        self.names |= set(variables(body))
        return setting(statement.name, body, value, statement.remark)

    # ── cost ─────────────────────────────────────────────────────────────────────────

    @property
    def variables(self) -> set[str]:
        """The names of all variables."""
        names: set[str] = set()
        for loop in self.body:
            names |= {*_sets(loop)}
            if not isinstance(loop, Walked):
                names |= set(variables(loop.body if isinstance(loop, Loop) else (loop,)))
        return names

    def operations(self) -> Counter[str]:
        """Return the most operations of each sort, never both branches; of walks none."""
        return self._count([*self.body, Assign("result", self.result)])

    def _count(self, body: Iterable[Statement | Loop | Walked]) -> Counter[str]:
        total: Counter[str] = Counter()
        for statement in body:
            if isinstance(statement, Loop):
                once = self._count(statement.body)
                total += Counter({sort: n * statement.sums.count for sort, n in once.items()})
            elif isinstance(statement, Walked):
                for part in statement.parts:
                    total += self._count_node(part)
            elif isinstance(statement, Assign):
                total += self._count_node(statement.value)
            else:
                total += self._count_node(statement.condition)
                total += self._count(statement.then) | self._count(statement.otherwise)
        return total

    def _count_node(self, node: Node) -> Counter[str]:
        return operations_of(node, self._count_call)

    def _count_call(self, name: str) -> Counter[str]:
        callee = self.calls.get(name)
        if callee is None:
            return Counter()
        function, argument = callee
        return self._count(function_body(function)) + self._count_node(argument)


def _sets(statement: Statement | SampleSums | DefuzzifierWalk | Loop | Walked) -> tuple[str, ...]:
    """Return the variables that something sets and others may read."""
    if isinstance(statement, Walked):
        statement = statement.walk
    if isinstance(statement, DefuzzifierWalk):
        return statement.total, statement.value
    if isinstance(statement, Loop):
        statement = statement.sums
    if isinstance(statement, SampleSums):
        return statement.area, statement.moment
    return (statement.name,)


def element(sums: SampleSums, column: str) -> str:
    """Return the symbol of an element of a column; it is printed as one."""
    return f"{column} of {sums.area}"


def spread(name: str, root: Node, reserved: Iterable[str]) -> tuple[tuple[Statement, ...], Node]:
    """Return statements that set the shared parts of an expression, and the rest of it."""
    if not _needs_variables(root):
        return (), root
    return statements(root, prefix=f"{name}_", reserved=reserved)


def _needs_variables(root: Node) -> bool:
    """Return whether an operation in `root` is needed twice, or it nests too deep."""
    nodes: set[Node] = set()
    depth: dict[Node, int] = {}
    for node in postorder(root):
        operands = [child for child in children(node) if isinstance(child, Apply)]
        if not nodes.isdisjoint(operands) or len(set(operands)) < len(operands):
            return True
        nodes |= set(operands)
        depth[node] = 1 + max((depth[child] for child in operands), default=0)
    return depth[root] > _DEEPEST


def function_body(call: Call) -> list[Statement]:
    """Return the statements of a function; the last one sets no variable: it is the result."""
    body, result = statements(call.body, prefix="x", reserved=("h",))
    return [*body, Assign("", result)]
