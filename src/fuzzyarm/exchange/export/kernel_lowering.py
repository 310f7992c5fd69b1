"""The kernel's defuzzifiers as functions of a program, read from their own source.

A walk over tables (:mod:`.walk`) is the kernel's function for one point. Its source becomes
functions of the typed program here, statement by statement and in the same order of arithmetic, so
that every language prints them as it prints all else.

No language needs pointers or tuples for that. An array of the kernel is a *stretch* of one of three
memories: its begin and its length. The whole numbers and the floats of the layout are constants of
the program; scratch is an array passed from function to function. A function that returns several
numbers leaves them in the last elements of scratch.

The tables are constants, so an element of them at a known index is a number, and a branch that
depends on such numbers alone is decided here: an exported program has no choice that its rule base
has made.
"""

from __future__ import annotations

import ast
import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from typing import Any, ClassVar

import numpy as np

from fuzzyarm.exchange.export.kernel_values import (
    KINDS,
    SCRATCH,
    Expressions,
    Stretch,
    Value,
    as_type,
)
from fuzzyarm.exchange.export.liveness import declared_first, read_in, set_in, without_unread
from fuzzyarm.exchange.export.numbers import ExportError, stand_ins
from fuzzyarm.exchange.export.sets import TABLE_HINT
from fuzzyarm.exchange.export.typed_program import (
    INDEX,
    NOTHING,
    OFFSET,
    REAL,
    ArrayArgument,
    Called,
    Count,
    Element,
    Function,
    Leave,
    Line,
    Program,
    Run,
    Scratch,
    Stop,
    Store,
    Truth,
    Variable,
    When,
    While,
    Whole,
    every_node,
)  # fmt: skip
from fuzzyarm.exchange.export.walk import DefuzzifierWalk
from fuzzyarm.symbolic.kernels import call
from fuzzyarm.symbolic.nodes import Constant, Node, Symbol, apply, symbol
from fuzzyarm.symbolic.printing import Assign
from fuzzyarm.symbolic.translation.functions import NotTranslatedError, _source_of
from fuzzyarm.symbolic.translation.types import Array, Nothing, Scalar, TupleType, Type, wider

MOST_PARTS = 4
"""Numbers that a function may return."""


def walk_lines(walk: DefuzzifierWalk, parts: Sequence[Node], program: Program) -> list[Line]:
    """Return the statements that set total and value of a walk from its parts."""
    scratch = f"{SCRATCH} of {walk.output}"
    lines: list[Line] = [Scratch(scratch, walk.scratch + MOST_PARTS)]
    lines += [Store(scratch, Whole(i, INDEX), part) for i, part in enumerate(parts)]
    try:
        made = _Walk(walk, program).entry()
    except NotTranslatedError as error:
        raise ExportError(str(error), hint=TABLE_HINT) from None
    lines.append(Run(made.key, (ArrayArgument(scratch),)))
    found = (Element(scratch, Whole(walk.scratch + i, INDEX)) for i in range(2))
    return [*lines, *map(Assign, (walk.total, walk.value), found)]


class _Walk:
    """The functions of one walk."""

    def __init__(self, walk: DefuzzifierWalk, program: Program) -> None:
        self.walk, self.program = walk, program
        layout = walk.layout
        limit, self.least = (math.inf, 0.0) if program.endless else stand_ins(layout.floats)
        self.whole = tuple(int(number) for number in layout.whole)
        # No value compared with an infinite number exceeds the largest finite one.
        self.floats = tuple(
            0.0 if math.isnan(x) and not program.endless else min(max(x, -limit), limit)
            for x in layout.floats
        )
        self.limit = limit
        self.kind = np.int16 if max(map(abs, self.whole)) < 1 << 15 else np.int32
        self.functions: dict[tuple[Any, ...], _Lowered] = {}

    def memory(self, kind: Array) -> str:
        """Return the key of the array in which stretches of a kind lie."""
        if kind is Array.REALS:
            return SCRATCH
        if kind is Array.WHOLES:
            return self.program.array(f"{self.walk.output}_table", self.kind, self.whole)
        return self.program.array(f"{self.walk.output}_numbers", REAL, self.floats)

    def entry(self) -> _Lowered:
        """Lower the function for one point."""
        walk = self.walk
        sizes = len(self.whole), len(self.floats), walk.scratch
        kinds = Array.WHOLES, Array.CONSTANTS, Array.REALS
        given = [
            Value(Stretch(Whole(0), Whole(size)), kind, name)
            for kind, size, name in zip(kinds, sizes, ("k", "f", SCRATCH), strict=True)
        ]
        heap = Stretch(Whole(walk.heap), Whole(walk.scratch - walk.heap))
        given += [Value(heap, Array.REALS, "heap"), Value(Whole(0), Scalar.WHOLE, "point")]
        return self.function(walk.function, given)

    def function(self, function: Callable[..., Any], arguments: Sequence[Value]) -> _Lowered:
        """Lower a function for arguments of some types, with all functions that it calls."""
        key = (function, *(value.given or value.type for value in arguments))
        if key not in self.functions:
            lowered = _Lowered(self, function, arguments)
            lowered.lower()
            self.functions[key] = lowered
        return self.functions[key]

    def dispatch(self, number: Node, arguments: Sequence[Value]) -> list[Line]:
        """Return the call of the function behind an address, by a dispatcher."""
        listed = self.walk.functions.norms if len(arguments) == 4 else self.walk.functions.curves
        if isinstance(number, Whole):
            return self.function(listed[number.value], arguments).run(arguments)
        key = (call, *(value.type for value in arguments))
        if key not in self.functions:
            plain = [value._replace(given="") for value in arguments]
            callees = {each: self.function(made, plain) for each, made in listed.items()}
            self.functions[key] = _Dispatcher(self, plain, callees)
        return self.functions[key].run([Value(number, Scalar.WHOLE), *arguments])


class _Lowered(Expressions):
    """One kernel as a function of the program."""

    whole: _Walk

    def __init__(
        self, whole: _Walk, function: Callable[..., Any], arguments: Sequence[Value]
    ) -> None:
        self.whole, self.program, self.function = whole, whole.program, function
        self.source = _source_of(function)
        self.globals = function.__globals__
        self.key = f"kernel {function.__name__} {len(whole.functions)} {id(whole)}"
        self.parameters = [argument.arg for argument in self.source.args.args]
        self.types: dict[str, Type] = {
            name: value.type for name, value in zip(self.parameters, arguments, strict=True)
        }
        self.bound = {
            name: value
            for name, value in zip(self.parameters, arguments, strict=True)
            if value.given
        }
        self.returned: Type = Nothing.NOTHING
        self.result: Node | None = None  # the number that it always returns
        # Its arguments: the number of a parameter, and of an array which part.
        self.signature: list[tuple[int, str]] = []
        self.uses_scratch = False
        # Number of assignments of each name: one assigned once, to a constant, is that constant.
        names = [node for node in ast.walk(self.source) if isinstance(node, ast.Name)]
        self.times_set = Counter(node.id for node in names if isinstance(node.ctx, ast.Store))
        self.times_set.update(
            node.target.id
            for node in ast.walk(self.source)
            if isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name)
        )
        self.before: list[Line] = []
        self.count = 0

    # ── a whole function ─────────────────────────────────────────────────────────────

    def lower(self) -> None:
        """Lower the source: again, until no name has become wider meanwhile."""
        earlier: Any = None
        while earlier != (self.types, self.returned):
            earlier = dict(self.types), self.returned
            self.count, self.kinds = 0, dict[str, Any]()
            self.local = dict(self.bound)
            body = self.block(self.source.body)
        self.add(self.source.name, self.parameters, without_unread(body))

    def add(self, stem: str, names: Sequence[str], body: list[Line]) -> None:
        """Add the function to the program; its parameters are those that it reads."""
        if body and isinstance(body[-1], Leave) and body[-1].value is None:
            body = body[:-1]
        if len(body) == 1 and isinstance(body[0], Leave):
            value = body[0].value
            self.result = value if isinstance(value, Whole | Constant) else None
        self.is_empty = not body
        if self.is_empty or self.result is not None:
            return  # never called
        keys = {
            key: (number, part)
            for number, name in enumerate(names)
            for key, part in self._keys_of(name)
        }
        read = read_in(body)
        parameters = {}
        for key, place in keys.items():
            if key in read:
                kind = OFFSET if place[1] else KINDS[Scalar(self.types[names[place[0]]])]
                parameters[key] = Variable(key.replace(" ", "_"), kind)
                self.signature.append(place)
        # A parameter is used directly; an assigned one is a copy.
        changed = [key for key in parameters if key in set_in(body)]
        for key in changed:
            parameters = {
                f"{key} given" if name == key else name: each for name, each in parameters.items()
            }
        body = [*(Assign(key, symbol(f"{key} given")) for key in changed), *body]
        variables = {
            name: Variable(name.replace(" ", "_"), kind) for name, kind in self.kinds.items()
        }
        body = [*declared_first(body, {*parameters, SCRATCH}, variables), *body]
        scratch = Variable(SCRATCH, REAL, of_array=True, size=self.whole.walk.scratch + MOST_PARTS)
        self.uses_scratch = SCRATCH in read
        returned = KINDS[self.returned] if isinstance(self.returned, Scalar) else NOTHING
        self.program.function(self.key, Function(
            stem, parameters | ({SCRATCH: scratch} if self.uses_scratch else {}), returned, body,
            {key: each for key, each in variables.items() if key not in parameters},
            of_kernel=True,
        ))  # fmt: skip

    def _keys_of(self, name: str) -> list[tuple[str, str]]:
        if name in self.bound:
            return []
        if isinstance(self.types[name], Array):
            return [(f"{name} at", "at"), (f"{name} n", "length")]
        return [(name, "")]

    def arguments(self, values: Sequence[Value]) -> tuple[Node, ...]:
        """Return the arguments of some values."""
        passed = []
        for number, part in self.signature:
            value = values[number]
            passed.append(
                getattr(value.content, part) if part
                else as_type(value, self.types[self.parameters[number]])
            )  # fmt: skip
        return (*passed, ArrayArgument(SCRATCH)) if self.uses_scratch else tuple(passed)

    def run(self, values: Sequence[Value]) -> list[Line]:
        """Return the statement that calls it."""
        return [] if self.is_empty else [Run(self.key, self.arguments(values))]

    # ── statements ───────────────────────────────────────────────────────────────────

    def block(self, body: Iterable[ast.stmt]) -> list[Line]:
        """Lower some statements, each after the calls that its values need."""
        lines: list[Line] = []
        for node in body:
            outer, self.before = self.before, []
            writer = self._STATEMENTS.get(type(node))
            if writer is None:
                raise NotTranslatedError(node, "a program")
            made = writer(self, node)
            lines += [*self.before, *made]
            self.before = outer
            if made and isinstance(made[-1], Leave | Stop):
                break
        return lines

    def _plain(self, node: ast.Expr) -> list[Line]:
        if not isinstance(node.value, ast.Constant):
            value = self.value(node.value)
            if isinstance(value.content, Called):
                return [Run(value.content.function, value.content.arguments)]
        return []

    def _return(self, node: ast.Return) -> list[Line]:
        if node.value is None:
            return [Leave()]
        value = self.value(node.value)
        self.returned = wider(
            None if self.returned is Nothing.NOTHING else self.returned, value.type
        )
        if not isinstance(value.type, TupleType):
            return [Leave(as_type(value, self.returned))]
        assert isinstance(self.returned, TupleType)
        places = [self._result(i) for i in range(len(self.returned.parts))]
        if all(
            _reads(part.content, place) for part, place in zip(value.content, places, strict=True)
        ):
            return [Leave()]
        found = [as_type(part, Scalar.REAL) for part in value.content]
        if any(_reads(part, place) for part in found for place in places):
            found = [self.named(Value(part, Scalar.REAL)).content for part in found]
        pairs = zip(places, found, strict=True)
        return [*(Store(SCRATCH, place.index, part) for place, part in pairs), Leave()]

    def _result(self, number: int) -> Element:
        return Element(SCRATCH, Whole(self.whole.walk.scratch + number, INDEX))

    def _assign(self, node: ast.Assign) -> list[Line]:
        if len(node.targets) == 1:
            return self._assigned(node.targets[0], node.value)
        value = self.value(node.value)
        if not isinstance(value.content, Constant | Whole | Symbol):
            value = self.named(value)
        return [line for target in node.targets for line in self._stored(target, value)]

    def _typed(self, node: ast.AnnAssign) -> list[Line]:
        assert node.value is not None
        return self._assigned(node.target, node.value)

    def _assigned(self, target: ast.expr, source: ast.expr) -> list[Line]:
        value = self.value(source)
        if isinstance(source, ast.Tuple) and isinstance(target, ast.Tuple):
            # Evaluate all values first: one may depend on a variable assigned before it.
            written = {ast.unparse(part) for part in target.elts[:-1]}
            stores = any(isinstance(part, ast.Subscript) for part in target.elts[:-1])
            later = [
                self.named(part)
                if isinstance(part.type, Scalar) and (
                    {n.id for n in ast.walk(each) if isinstance(n, ast.Name)} & written
                    or (stores and any(isinstance(n, Element) and n.array == SCRATCH
                                       for n in every_node([part.content])))
                )
                else part
                for part, each in zip(value.content, source.elts, strict=True)
            ]  # fmt: skip
            value = value._replace(content=tuple(later))
        return self._stored(target, value)

    def _stored(self, target: ast.expr, value: Value) -> list[Line]:
        if isinstance(target, ast.Tuple):
            pairs = zip(target.elts, value.content, strict=True)
            return [line for part, each in pairs for line in self._stored(part, each)]
        if isinstance(target, ast.Subscript):
            place = self.value(target).content
            return [Store(place.array, place.index, as_type(value, Scalar.REAL))]
        assert isinstance(target, ast.Name)
        return [] if target.id == "_" else self._set(target.id, value)

    def _set(self, name: str, value: Value) -> list[Line]:
        """Return the statements that set a variable; one set once may be its value."""
        self.types[name] = wider(self.types.get(name), value.type)
        once = self.times_set[name] == 1 and name not in self.parameters
        if isinstance(value.content, Stretch):
            ends = value.content
            if once and all(isinstance(end, Whole) for end in ends):
                self.local[name] = value
                return []
            self.local.pop(name, None)
            keys = f"{name} at", f"{name} n"
            self.kinds |= dict.fromkeys(keys, OFFSET)
            if any(isinstance(n, Symbol) and n.name == keys[0] for n in every_node([ends.length])):
                ends = Stretch(ends.at, self.named(Value(ends.length, Scalar.WHOLE)).content)
            return list(map(Assign, keys, ends))
        content = as_type(value, self.types[name])
        if once and isinstance(content, Whole | Constant | Truth):
            self.local[name] = Value(content, self.types[name])
            return []
        self.kinds[name] = KINDS[Scalar(self.types[name])]
        return [Assign(name, content)]

    def _changed(self, node: ast.AugAssign) -> list[Line]:
        loaded = ast.parse(ast.unparse(node.target), mode="eval").body
        return self._stored(
            node.target, self.calculated(node, self.value(loaded), self.value(node.value))
        )

    def _if(self, node: ast.If) -> list[Line]:
        condition = self.value(node.test).content
        if isinstance(condition, Truth):
            return self.block(node.body if condition.value else node.orelse)
        then, otherwise = tuple(self.block(node.body)), tuple(self.block(node.orelse))
        return [When(condition, then, otherwise)] if then or otherwise else []

    def _while(self, node: ast.While) -> list[Line]:
        condition = self.value(node.test).content
        if self.before:
            raise NotTranslatedError(node, "a program")
        return [While(condition, tuple(self.block(node.body)))]

    def _for(self, node: ast.For) -> list[Line]:
        assert isinstance(node.iter, ast.Call)
        assert isinstance(node.target, ast.Name)
        numbers = [self.value(argument).content for argument in node.iter.args]
        start, end = (Whole(0), numbers[0]) if len(numbers) == 1 else numbers[:2]
        step = numbers[2] if len(numbers) == 3 else Whole(1)
        assert isinstance(step, Whole)
        if (
            isinstance(start, Whole)
            and isinstance(end, Whole)
            and not (range(start.value, end.value, step.value))
        ):
            return []
        # The end is evaluated once: the body may change its operands.
        name = node.target.id
        inside = {n.id for each in node.body for n in ast.walk(each)
                  if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}  # fmt: skip
        stays = isinstance(end, Symbol) and end.name.partition(" ")[0] not in inside
        if not isinstance(end, Whole) and not stays:
            end = self.named(Value(end, Scalar.WHOLE)).content
        index = self.new_name("i")
        if name != "_":
            self.types[name] = wider(self.types.get(name), Scalar.WHOLE)
            if name in inside or self._read_elsewhere(name, node):
                self.kinds[name] = OFFSET
                body = (Assign(name, symbol(index)), *self.block(node.body))
                return [Count(index, start, end, step.value, body)]
            self.local[name] = Value(symbol(index), Scalar.WHOLE)
        return [Count(index, start, end, step.value, tuple(self.block(node.body)))]

    def _read_elsewhere(self, name: str, loop: ast.For) -> bool:
        """Whether a name is read outside of all loops over it."""
        loops = [each for each in ast.walk(self.source) if isinstance(each, ast.For)
                 and isinstance(each.target, ast.Name) and each.target.id == name]  # fmt: skip
        inside = {id(n) for each in loops for n in ast.walk(each)}
        return any(
            isinstance(n, ast.Name) and n.id == name and id(n) not in inside
            for n in ast.walk(self.source)
        )

    def _break(self, _node: ast.Break) -> list[Line]:
        return [Stop()]

    _STATEMENTS: ClassVar[dict[type, Callable[..., list[Line]]]] = {
        ast.Expr: _plain, ast.Return: _return, ast.Assign: _assign, ast.AnnAssign: _typed,
        ast.AugAssign: _changed, ast.If: _if, ast.While: _while, ast.For: _for, ast.Break: _break,
    }  # fmt: skip


class _Dispatcher(_Lowered):
    """A function that calls another one by its number."""

    def __init__(
        self, whole: _Walk, arguments: Sequence[Value], callees: dict[int, _Lowered]
    ) -> None:
        self.whole, self.program = whole, whole.program
        self.key = f"kernel call {len(whole.functions)} {id(whole)}"
        self.parameters = ["number", *(f"a{i}" for i in range(len(arguments)))]
        self.types = dict(
            zip(self.parameters, (Scalar.WHOLE, *(each.type for each in arguments)), strict=True)
        )
        self.bound, self.kinds = {}, {}
        self.returned, self.result, self.signature = Nothing.NOTHING, None, []
        passed = [
            Value(Stretch(symbol(f"{name} at"), symbol(f"{name} n")), Array.REALS)
            for name in self.parameters[1:]
        ]
        self.add("call", self.parameters, [
            When(apply("equal", symbol("number"), Whole(number)), tuple(callee.run(passed)))
            for number, callee in callees.items()
        ])  # fmt: skip


def _reads(node: Any, place: Element) -> bool:
    """Whether an expression reads an element at a known index."""
    assert isinstance(place.index, Whole)
    return any(
        isinstance(each, Element) and each.array == place.array
        and isinstance(each.index, Whole) and each.index.value == place.index.value
        for each in every_node([node])
    )  # fmt: skip
