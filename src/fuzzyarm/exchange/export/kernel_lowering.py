"""The kernel's defuzzifiers as functions of a program, read from their own source.

A walk over tables (:mod:`.walk`) is the kernel's function for one point. Its source becomes
functions of the typed program here, statement by statement and in the same order of arithmetic, so
that every language prints them as it prints all else.

No language needs pointers or tuples for that. An array of the kernel is a *stretch* of one of three
memories: where it begins and how long it is. The whole numbers and the floats of the layout are
constants of the program; the room is an array that functions hand on. A function that returns
several numbers leaves them in the last elements of the room.

The tables are constants, so an element of them at a known index is a number, and a branch that
depends on such numbers alone is decided here: an exported program has no choice that its rule base
has made.
"""

from __future__ import annotations

import ast
import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from typing import Any, ClassVar, NamedTuple

import numpy as np

from fuzzyarm.exchange.export.folding import both, denied, plus, whole_number
from fuzzyarm.exchange.export.liveness import declared_first, read_in, set_in, without_unread
from fuzzyarm.exchange.export.numbers import ExportError, stand_ins
from fuzzyarm.exchange.export.sets import TABLE_HINT
from fuzzyarm.exchange.export.typed_program import (
    INDEX,
    NOTHING,
    PLACE,
    REAL,
    TRUTH,
    Called,
    Cast,
    Count,
    Element,
    Function,
    Handed,
    Leave,
    Line,
    Program,
    Room,
    Run,
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
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.kernels import call, is_kernel
from fuzzyarm.symbolic.nodes import Constant, Node, Symbol, apply, constant, symbol
from fuzzyarm.symbolic.operations import OPERATIONS
from fuzzyarm.symbolic.printing import Assign
from fuzzyarm.symbolic.translation.functions import NotTranslatedError, _source_of
from fuzzyarm.symbolic.translation.types import Array, Nothing, Scalar, TupleType, Type, wider

__all__ = ["walk_lines"]

MOST_PARTS = 4
"""Numbers that a function may return."""

ROOM = "room"

_KINDS = {Scalar.TRUTH: TRUTH, Scalar.WHOLE: PLACE, Scalar.REAL: REAL}
_OPERATIONS = {
    operation.python.partition("(")[0]: operation.name
    for operation in OPERATIONS.values()
    if operation.binds == 9
}
"""Names of operations by those of Python's functions."""

_COMPARED: dict[type, Callable[[Node, Node], Node]] = {
    ast.Lt: lambda a, b: a < b, ast.LtE: lambda a, b: a <= b, ast.Gt: lambda a, b: b < a,
    ast.GtE: lambda a, b: b <= a, ast.Eq: op.equal, ast.NotEq: lambda a, b: ~op.equal(a, b),
}  # fmt: skip
_DECIDED: dict[type, Callable[[Any, Any], bool]] = {
    ast.Lt: lambda a, b: a < b, ast.LtE: lambda a, b: a <= b, ast.Gt: lambda a, b: a > b,
    ast.GtE: lambda a, b: a >= b, ast.Eq: lambda a, b: a == b, ast.NotEq: lambda a, b: a != b,
}  # fmt: skip


class Stretch(NamedTuple):
    """A part of a memory: where it begins, and how long it is."""

    at: Node
    length: Node


class Value(NamedTuple):
    """An expression, a stretch, or several values; `given`: what the walk itself was given."""

    content: Any
    type: Type
    given: str = ""


def walk_lines(walk: DefuzzifierWalk, parts: Sequence[Node], program: Program) -> list[Line]:
    """Return the statements that set total and value of a walk from its parts."""
    room = f"{ROOM} of {walk.output}"
    lines: list[Line] = [Room(room, walk.room + MOST_PARTS)]
    lines += [Store(room, Whole(i, INDEX), part) for i, part in enumerate(parts)]
    try:
        made = _Walk(walk, program).entry()
    except NotTranslatedError as error:
        raise ExportError(str(error), hint=TABLE_HINT) from None
    lines.append(Run(made.key, (Handed(room),)))
    found = (Element(room, Whole(walk.room + i, INDEX)) for i in range(2))
    return [*lines, *map(Assign, (walk.total, walk.value), found)]


class _Walk:
    """The functions of one walk."""

    def __init__(self, walk: DefuzzifierWalk, program: Program) -> None:
        self.walk, self.program = walk, program
        layout = walk.layout
        limit, self.least = (math.inf, 0.0) if program.endless else stand_ins(layout.floats)
        self.whole = tuple(int(number) for number in layout.whole)
        # Nothing that is compared with an endless number is larger than the largest one.
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
            return ROOM
        if kind is Array.WHOLES:
            return self.program.array(f"{self.walk.output}_table", self.kind, self.whole)
        return self.program.array(f"{self.walk.output}_numbers", REAL, self.floats)

    def entry(self) -> _Lowered:
        """Lower the function for one point."""
        walk = self.walk
        sizes = len(self.whole), len(self.floats), walk.room
        kinds = Array.WHOLES, Array.CONSTANTS, Array.REALS
        given = [
            Value(Stretch(Whole(0), Whole(size)), kind, name)
            for kind, size, name in zip(kinds, sizes, ("k", "f", ROOM), strict=True)
        ]
        heap = Stretch(Whole(walk.heap), Whole(walk.room - walk.heap))
        given += [Value(heap, Array.REALS, "heap"), Value(Whole(0), Scalar.WHOLE, "point")]
        return self.function(walk.function, given)

    def function(self, function: Callable[..., Any], arguments: Sequence[Value]) -> _Lowered:
        """Lower a function for arguments of some types, with all that it calls."""
        key = (function, *(value.given or value.type for value in arguments))
        if key not in self.functions:
            lowered = _Lowered(self, function, arguments)
            lowered.lower()
            self.functions[key] = lowered
        return self.functions[key]

    def dispatch(self, number: Node, arguments: Sequence[Value]) -> list[Line]:
        """Return the call of what a number stands for, by a function that knows all."""
        listed = self.walk.functions.norms if len(arguments) == 4 else self.walk.functions.curves
        if isinstance(number, Whole):
            return self.function(listed[number.value], arguments).run(arguments)
        key = (call, *(value.type for value in arguments))
        if key not in self.functions:
            plain = [value._replace(given="") for value in arguments]
            callees = {each: self.function(made, plain) for each, made in listed.items()}
            self.functions[key] = _Dispatcher(self, plain, callees)
        return self.functions[key].run([Value(number, Scalar.WHOLE), *arguments])


class _Lowered:
    """One kernel as a function of the program.

    Attributes
    ----------
    key : str
        Of the function.
    signature : list of (int, str)
        What it is handed: the number of a parameter, and of an array which part.
    returned : Type
        What it returns.
    result : Node or None
        A number that it always returns.
    """

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
        self.result: Node | None = None
        self.signature: list[tuple[int, str]] = []
        self.uses_room = False
        # How often each name is set: one that is set once to a constant is that constant.
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
            return  # nobody calls it
        keys = {
            key: (number, part)
            for number, name in enumerate(names)
            for key, part in self._keys_of(name)
        }
        read = read_in(body)
        parameters = {}
        for key, place in keys.items():
            if key in read:
                kind = PLACE if place[1] else _KINDS[Scalar(self.types[names[place[0]]])]
                parameters[key] = Variable(key.replace(" ", "_"), kind)
                self.signature.append(place)
        # A parameter stays as it is; what is set is a copy.
        changed = [key for key in parameters if key in set_in(body)]
        for key in changed:
            parameters = {
                f"{key} given" if name == key else name: each for name, each in parameters.items()
            }
        body = [*(Assign(key, symbol(f"{key} given")) for key in changed), *body]
        variables = {
            name: Variable(name.replace(" ", "_"), kind) for name, kind in self.kinds.items()
        }
        body = [*declared_first(body, {*parameters, ROOM}, variables), *body]
        room = Variable(ROOM, REAL, of_array=True, size=self.whole.walk.room + MOST_PARTS)
        self.uses_room = ROOM in read
        returned = _KINDS[self.returned] if isinstance(self.returned, Scalar) else NOTHING
        self.program.function(self.key, Function(
            stem, parameters | ({ROOM: room} if self.uses_room else {}), returned, body,
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
        """Return what it is handed of some values."""
        passed = []
        for number, part in self.signature:
            value = values[number]
            passed.append(
                getattr(value.content, part) if part
                else _as(value, self.types[self.parameters[number]])
            )  # fmt: skip
        return (*passed, Handed(ROOM)) if self.uses_room else tuple(passed)

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
            return [Leave(_as(value, self.returned))]
        assert isinstance(self.returned, TupleType)
        places = [self._result(i) for i in range(len(self.returned.parts))]
        if all(
            _reads(part.content, place) for part, place in zip(value.content, places, strict=True)
        ):
            return [Leave()]
        found = [_as(part, Scalar.REAL) for part in value.content]
        if any(_reads(part, place) for part in found for place in places):
            found = [self._named(Value(part, Scalar.REAL)).content for part in found]
        pairs = zip(places, found, strict=True)
        return [*(Store(ROOM, place.index, part) for place, part in pairs), Leave()]

    def _result(self, number: int) -> Element:
        return Element(ROOM, Whole(self.whole.walk.room + number, INDEX))

    def _assign(self, node: ast.Assign) -> list[Line]:
        if len(node.targets) == 1:
            return self._assigned(node.targets[0], node.value)
        value = self.value(node.value)
        if not isinstance(value.content, Constant | Whole | Symbol):
            value = self._named(value)
        return [line for target in node.targets for line in self._stored(target, value)]

    def _typed(self, node: ast.AnnAssign) -> list[Line]:
        assert node.value is not None
        return self._assigned(node.target, node.value)

    def _assigned(self, target: ast.expr, source: ast.expr) -> list[Line]:
        value = self.value(source)
        if isinstance(source, ast.Tuple) and isinstance(target, ast.Tuple):
            # All values first, where one is made of what is assigned before it.
            written = {ast.unparse(part) for part in target.elts[:-1]}
            stores = any(isinstance(part, ast.Subscript) for part in target.elts[:-1])
            later = [
                self._named(part)
                if isinstance(part.type, Scalar) and (
                    {n.id for n in ast.walk(each) if isinstance(n, ast.Name)} & written
                    or (stores and any(isinstance(n, Element) and n.array == ROOM
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
            return [Store(place.array, place.index, _as(value, Scalar.REAL))]
        assert isinstance(target, ast.Name)
        return [] if target.id == "_" else self._set(target.id, value)

    def _set(self, name: str, value: Value) -> list[Line]:
        """Return the statements that set a variable; one that is set once may be its value."""
        self.types[name] = wider(self.types.get(name), value.type)
        once = self.times_set[name] == 1 and name not in self.parameters
        if isinstance(value.content, Stretch):
            ends = value.content
            if once and all(isinstance(end, Whole) for end in ends):
                self.local[name] = value
                return []
            self.local.pop(name, None)
            keys = f"{name} at", f"{name} n"
            self.kinds |= dict.fromkeys(keys, PLACE)
            if any(isinstance(n, Symbol) and n.name == keys[0] for n in every_node([ends.length])):
                ends = Stretch(ends.at, self._named(Value(ends.length, Scalar.WHOLE)).content)
            return list(map(Assign, keys, ends))
        content = _as(value, self.types[name])
        if once and isinstance(content, Whole | Constant | Truth):
            self.local[name] = Value(content, self.types[name])
            return []
        self.kinds[name] = _KINDS[Scalar(self.types[name])]
        return [Assign(name, content)]

    def _changed(self, node: ast.AugAssign) -> list[Line]:
        loaded = ast.parse(ast.unparse(node.target), mode="eval").body
        return self._stored(
            node.target, self._calculated(node, self.value(loaded), self.value(node.value))
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
        # The end is found once: the body may change what it is made of.
        name = node.target.id
        inside = {n.id for each in node.body for n in ast.walk(each)
                  if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}  # fmt: skip
        stays = isinstance(end, Symbol) and end.name.partition(" ")[0] not in inside
        if not isinstance(end, Whole) and not stays:
            end = self._named(Value(end, Scalar.WHOLE)).content
        index = self._new("i")
        if name != "_":
            self.types[name] = wider(self.types.get(name), Scalar.WHOLE)
            if name in inside or self._read_elsewhere(name, node):
                self.kinds[name] = PLACE
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

    # ── expressions ──────────────────────────────────────────────────────────────────

    def value(self, node: ast.expr) -> Value:
        """Lower an expression."""
        writer = self._VALUES.get(type(node))
        if writer is None:
            raise NotTranslatedError(node, "a program")
        return writer(self, node)

    def _new(self, stem: str) -> str:
        self.count += 1
        name = f"{stem} {self.count}"
        self.kinds[name] = PLACE
        return name

    def _named(self, value: Value) -> Value:
        """Return a variable that is set to a value before the statement."""
        if not isinstance(value.type, Scalar) or isinstance(value.content, Constant | Whole):
            return value
        name = self._new("t")
        self.kinds[name] = _KINDS[value.type]
        self.before.append(Assign(name, value.content))
        return value._replace(content=symbol(name))

    def _number(self, value: object, node: ast.AST) -> Value:
        if isinstance(value, bool):
            return Value(Truth(value), Scalar.TRUTH)
        if isinstance(value, int):
            return Value(Whole(value), Scalar.WHOLE)
        if isinstance(value, float):
            limit = self.whole.limit
            value = max(value, self.whole.least) if value > 0.0 else value
            return Value(constant(min(max(value, -limit), limit)), Scalar.REAL)
        raise NotTranslatedError(node, "a program")

    def _constant(self, node: ast.Constant) -> Value:
        return self._number(node.value, node)

    def _name(self, node: ast.Name) -> Value:
        name = node.id
        if name in self.local:
            return self.local[name]
        if name not in self.types:
            return self._number(self.globals.get(name), node)
        type_ = self.types[name]
        if isinstance(type_, Array):
            ends = symbol(f"{name} at"), symbol(f"{name} n")
            return Value(Stretch(*ends), type_)
        return Value(symbol(name), type_)

    def _binary(self, node: ast.BinOp) -> Value:
        return self._calculated(node, self.value(node.left), self.value(node.right))

    def _calculated(self, node: ast.BinOp | ast.AugAssign, a: Value, b: Value) -> Value:
        operator = type(node.op)
        both = wider(a.type, b.type)
        type_ = (
            Scalar.REAL if operator is ast.Div else Scalar.WHOLE if both is Scalar.TRUTH else both
        )
        one, other = _as(a, type_), _as(b, type_)
        if type_ is Scalar.WHOLE:
            return Value(whole_number(operator, one, other), type_)
        made = {ast.Add: "add", ast.Sub: "subtract", ast.Mult: "multiply", ast.Div: "divide"}
        return Value(apply(made[operator], one, other), type_)

    def _unary(self, node: ast.UnaryOp) -> Value:
        value = self.value(node.operand)
        if isinstance(node.op, ast.USub):
            if isinstance(value.content, Whole):
                return value._replace(content=Whole(-value.content.value))
            if isinstance(value.content, Constant):
                return value._replace(content=constant(-value.content.value))
            return value._replace(content=-value.content, given="")
        return Value(denied(value.content), Scalar.TRUTH)

    def _joined(self, node: ast.BoolOp) -> Value:
        is_and = isinstance(node.op, ast.And)
        joined: Node = Truth(is_and)
        for part in node.values:
            joined = both(joined, self.value(part).content, is_and=is_and)
        return Value(joined, Scalar.TRUTH)

    def _compared(self, node: ast.Compare) -> Value:
        values = [self.value(part) for part in (node.left, *node.comparators)]
        joined: Node = Truth(True)
        for a, sign, b in zip(values[:-1], node.ops, values[1:], strict=True):
            joined = both(joined, self._pair(a, type(sign), b), is_and=True)
        return Value(joined, Scalar.TRUTH)

    def _pair(self, a: Value, sign: type[ast.cmpop], b: Value) -> Node:
        if Scalar.TRUTH in {a.type, b.type}:  # whether two conditions are the same, or not
            assert sign in {ast.Eq, ast.NotEq}
            a, b = self._named(a), self._named(b)
            same: Node = (a.content & b.content) | (~a.content & ~b.content)
            return same if sign is ast.Eq else ~same
        type_ = wider(a.type, b.type)
        one, other = _as(a, type_), _as(b, type_)
        if isinstance(one, Whole | Constant) and isinstance(other, Whole | Constant):
            return Truth(_DECIDED[sign](one.value, other.value))
        return _COMPARED[sign](one, other)

    def _choice(self, node: ast.IfExp) -> Value:
        condition = self.value(node.test).content
        if isinstance(condition, Truth):
            return self.value(node.body if condition.value else node.orelse)
        branches = []
        for part in (node.body, node.orelse):
            outer, self.before = self.before, []
            branches.append((self.value(part), self.before))
            self.before = outer
        type_ = wider(branches[0][0].type, branches[1][0].type)
        name = self._new("t")
        self.kinds[name] = _KINDS[Scalar(type_)]
        then, otherwise = ((*before, Assign(name, _as(value, type_))) for value, before in branches)
        self.before.append(When(condition, then, otherwise))
        return Value(symbol(name), type_)

    def _tuple(self, node: ast.Tuple) -> Value:
        values = tuple(self.value(part) for part in node.elts)
        return Value(values, TupleType(tuple(value.type for value in values)))

    def _subscript(self, node: ast.Subscript) -> Value:
        if isinstance(node.value, ast.Attribute) and node.value.attr == "shape":
            return Value(self.value(node.value.value).content.length, Scalar.WHOLE)
        whole = self.value(node.value)
        if isinstance(whole.type, TupleType):
            part: Value = whole.content[int(str(ast.literal_eval(node.slice)))]
            return part
        assert isinstance(whole.type, Array)
        stretch = whole.content
        if isinstance(node.slice, ast.Slice):
            ends = (node.slice.lower, node.slice.upper)
            start, end = (None if part is None else self.value(part).content for part in ends)
            # An end that the kernel names lies inside.
            length = stretch.length if end is None else end
            at = stretch.at
            if start is not None:
                at = plus(at, start)
                length = whole_number(ast.Sub, length, start)
            return Value(Stretch(at, length), whole.type)
        index = plus(stretch.at, self.value(node.slice).content)
        tables = {Array.WHOLES: self.whole.whole, Array.CONSTANTS: self.whole.floats}
        if isinstance(index, Whole) and whole.type in tables:
            return self._number(tables[whole.type][index.value], node)
        element: Node = Element(self.whole.memory(whole.type), _index(index))
        if whole.type is Array.WHOLES:
            element = Cast(element, self.whole.kind, PLACE)
        return Value(element, whole.type.element)

    def _attribute(self, node: ast.Attribute) -> Value:
        if ast.unparse(node.value) == "math":
            return self._number(getattr(math, node.attr), node)
        if node.attr == "size":
            return Value(self.value(node.value).content.length, Scalar.WHOLE)
        raise NotTranslatedError(node, "a program")

    # ── calls ────────────────────────────────────────────────────────────────────────

    def _called(self, node: ast.Call) -> Value:
        word = node.func.attr if isinstance(node.func, ast.Attribute) else ast.unparse(node.func)
        function = None
        if isinstance(node.func, ast.Name):
            function = self.globals.get(word)
        if word == "float" and isinstance(node.args[0], ast.Constant):  # "inf", "nan"
            return self._number(float(str(node.args[0].value)), node)
        values = [self.value(argument) for argument in node.args]
        if function is call:
            self.before += self.whole.dispatch(values[0].content, values[1:])
            return Value((), TupleType(()))
        if function is not None and is_kernel(function):
            return self._of_kernel(function, values)
        if word == "len":
            return Value(values[0].content.length, Scalar.WHOLE)
        return self._of_mathematics(node, word, values)

    def _of_kernel(self, function: Callable[..., Any], values: list[Value]) -> Value:
        made = self.whole.function(function, values)
        if made.result is not None:
            return Value(made.result, made.returned)
        if isinstance(made.returned, Scalar):
            return Value(Called(made.key, made.arguments(values)), made.returned)
        self.before += made.run(values)
        if not isinstance(made.returned, TupleType):
            return Value((), TupleType(()))
        # At once: the next call leaves its own numbers there.
        parts = tuple(
            self._named(Value(_from_real(self._result(i), part), part))
            for i, part in enumerate(made.returned.parts)
        )
        return Value(parts, made.returned)

    def _of_mathematics(self, node: ast.Call, word: str, values: list[Value]) -> Value:
        type_ = values[0].type
        for value in values[1:]:
            type_ = wider(type_, value.type)
        if word == "int":
            return Value(_as(values[0], Scalar.WHOLE), Scalar.WHOLE)
        if word == "float":
            return Value(_as(values[0], Scalar.REAL), Scalar.REAL)
        if word == "isnan":
            return Value(~op.equal(values[0].content, values[0].content), Scalar.TRUTH)
        if word in {"min", "max"} and type_ is Scalar.WHOLE:
            return self._extreme(word, values)
        if word not in _OPERATIONS:
            raise NotTranslatedError(node, "a program")
        contents = [_as(value, Scalar.REAL) for value in values]
        if word in {"min", "max"}:  # two at a time, in their order
            found = contents[0]
            for other in contents[1:]:
                found = apply(_OPERATIONS[word], found, other)
            return Value(found, Scalar.REAL)
        return Value(apply(_OPERATIONS[word], *contents), Scalar.REAL)

    def _extreme(self, word: str, values: list[Value]) -> Value:
        """Return the least or the greatest whole number."""
        if all(isinstance(value.content, Whole) for value in values):
            found = (min if word == "min" else max)(value.content.value for value in values)
            return Value(Whole(found), Scalar.WHOLE)
        name = self._new("t")
        self.before.append(Assign(name, values[0].content))
        for other in map(self._named, values[1:]):
            ends = other.content, symbol(name)
            passed = apply("less", *(ends if word == "min" else ends[::-1]))
            self.before.append(When(passed, (Assign(name, other.content),)))
        return Value(symbol(name), Scalar.WHOLE)

    _VALUES: ClassVar[dict[type, Callable[..., Value]]] = {
        ast.Constant: _constant, ast.Name: _name, ast.BinOp: _binary, ast.UnaryOp: _unary,
        ast.BoolOp: _joined, ast.Compare: _compared, ast.IfExp: _choice, ast.Tuple: _tuple,
        ast.Subscript: _subscript, ast.Attribute: _attribute, ast.Call: _called,
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


# ── kinds ────────────────────────────────────────────────────────────────────────────


def _as(value: Value, type_: Type) -> Node:
    """Return a value as one of another type."""
    content: Node = value.content
    if value.type == type_:
        return content
    if isinstance(content, Whole) and type_ is Scalar.REAL:
        return constant(float(content.value))
    if isinstance(content, Constant) and type_ is Scalar.WHOLE:
        return Whole(int(content.value))
    if value.type is Scalar.TRUTH:
        if isinstance(content, Truth):
            return constant(float(content.value)) if type_ is Scalar.REAL else Whole(content.value)
        raise TypeError("a condition is not a number here")
    return Cast(content, _KINDS[Scalar(value.type)], _KINDS[Scalar(type_)])


def _from_real(element: Element, type_: Type) -> Node:
    return element if type_ is Scalar.REAL else Cast(element, REAL, _KINDS[Scalar(type_)])


def _index(index: Node) -> Node:
    if isinstance(index, Whole):
        return Whole(index.value, INDEX)
    return Cast(index, PLACE, INDEX)


def _reads(node: Any, place: Element) -> bool:
    """Whether an expression reads an element at a known index."""
    assert isinstance(place.index, Whole)
    return any(
        isinstance(each, Element) and each.array == place.array
        and isinstance(each.index, Whole) and each.index.value == place.index.value
        for each in every_node([node])
    )  # fmt: skip
