"""A walk over tables in Structured Text: the kernel's function for one point, as functions.

The language has neither pointers nor tuples. An array of the kernel is a stretch of one of three
arrays of the function block, which functions take by reference: whole numbers, floats, and the room
to work in. So an array is two numbers here, where it begins and how long it is; and what a function
returns beside a number it writes into variables that it is given.
"""

from __future__ import annotations

import ast
import math
import sys
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from fuzzyarm.exchange.export.numbers import ExportError, st_literal, st_number
from fuzzyarm.exchange.export.walk import DefuzzifierWalk, WrittenFunction
from fuzzyarm.symbolic.identifiers import Names
from fuzzyarm.symbolic.translation.functions import (
    Bindings,
    NotTranslatedError,
    Translation,
    _Function,
)
from fuzzyarm.symbolic.translation.targets import C99
from fuzzyarm.symbolic.translation.types import (
    Array,
    Nothing,
    Scalar,
    TupleType,
    Type,
    TypedText,
    wider,
)

__all__ = ["WalkText", "walk_in_st"]

REAL, WHOLE, TRUTH = Scalar.REAL, Scalar.WHOLE, Scalar.TRUTH

MEMORIES = {Array.WHOLES: "whole", Array.CONSTANTS: "floats", Array.REALS: "room"}
"""What the arrays of the function block are called inside the functions."""

_KINDS = {TRUTH: "BOOL", WHOLE: "DINT", REAL: "LREAL"}

_SPLIT = "; "
"""Between where an array begins and its length, in the text of a value."""


class WalkText:
    """A walk as text.

    Attributes
    ----------
    functions : list of str
        Lines of the functions, each after those that it calls.
    types : list of str
        Lines that define the types of the three arrays: a type that has no name is the same as no
        other, and what a function takes by reference has to have the same.
    type_names : dict of str to str
        Their names.
    tables : dict of str to list of str
        Literals of the arrays but for the room.
    call : str
        The statement that fills total and value, with their names and those of the arrays in
        braces: ``{whole}``, ``{floats}``, ``{room}``, ``{total}``, ``{value}``, ``{done}``.
    """

    def __init__(self, translation: _InST, walk: DefuzzifierWalk, name: str) -> None:
        layout = walk.layout
        self.functions = translation.text().split("\n")
        self.types, self.type_names = translation.types_text(), translation.type_names
        self.tables = {
            "whole": [str(number) for number in layout.whole],
            "floats": [st_number(_finite(number), np.float64) for number in layout.floats],
        }
        ends = f"0, {len(layout.whole)}, 0, {len(layout.floats)}, 0, {walk.room}"
        heap = f"{walk.heap}, {walk.room - walk.heap}"
        arguments = f"{{whole}}, {{floats}}, {{room}}, {{total}}, {{value}}, {ends}, {heap}, 0"
        self.call = f"{{done}} := {name}({arguments});"


def walk_in_st(walk: DefuzzifierWalk, names: Names, name: str) -> WalkText:
    """Return a walk as functions, whose names are new to a file."""
    translation = _InST(walk, names, name)
    arrays = [Array.WHOLES, Array.CONSTANTS, Array.REALS, Array.REALS]
    try:
        function = translation.function(walk.function, [*arrays, WHOLE])
    except NotTranslatedError as error:
        raise ExportError(str(error), hint="export C, or a table") from None
    return WalkText(translation, walk, function.name)


def _finite(value: float) -> float:
    # There is no number beyond all others: nothing that is compared with it is larger.
    largest = sys.float_info.max
    return 0.0 if math.isnan(value) else min(max(value, -largest), largest)


def _real(value: float) -> str:
    return st_literal(_finite(value), np.float64)


_TARGET = replace(
    C99,
    name="Structured Text",
    types={},
    variable="{}_x",
    constant="{name} := {value};",
    cast="DINT_TO_LREAL({value})",
    # Whole numbers are not negative where they are divided.
    operators={**C99.operators, (ast.FloorDiv, WHOLE): "({0} / {1})"},
    comparisons={**C99.comparisons, ast.Eq: "=", ast.NotEq: "<>"},
    functions={
        **{(function, type_): (f"{function.__name__.upper()}({{}})", type_)
           for function in (min, max, abs) for type_ in (REAL, WHOLE)},
        **{(getattr(math, name), REAL): (f"{word}({{}})", REAL) for name, word in {
            "sin": "SIN", "cos": "COS", "tan": "TAN", "asin": "ASIN", "acos": "ACOS",
            "atan": "ATAN", "exp": "EXP", "log": "LN", "log10": "LOG", "sqrt": "SQRT",
            "pow": "EXPT"}.items()},
        **{(int, type_): ("TRUNC({})", WHOLE) for type_ in (REAL, WHOLE)},
    },
    truths=("FALSE", "TRUE"),
    real=_real,
)  # fmt: skip


class _InST(Translation):
    """The functions of one walk."""

    def __init__(self, walk: DefuzzifierWalk, names: Names, name: str) -> None:
        super().__init__(_TARGET)
        self.walk, self.names, self.stem = walk, names, name
        self.dispatchers: dict[tuple[Type, ...], str] = {}
        layout = walk.layout
        self.sizes = {
            "whole": (len(layout.whole), "DINT"), "floats": (len(layout.floats), "LREAL"),
            "room": (walk.room, "LREAL"),
        }  # fmt: skip
        self.type_names = {array: names.new(f"{name}_{array}_array") for array in self.sizes}

    def new_function(self, function: Any, types: Sequence[Type], bindings: Bindings) -> _STFunction:
        """Return a function that is not translated yet."""
        return _STFunction(self, function, types, bindings, self.name(function.__name__))

    def name(self, name: str) -> str:
        """Return a name that the file does not have yet."""
        return self.names.new(f"{self.stem}_{name}")

    def type_name(self, type_: Type) -> str:
        """Return the name of a type of numbers."""
        return _KINDS[type_] if isinstance(type_, Scalar) else ""

    def memories(self) -> list[str]:
        """Return the declaration of what every function takes by reference."""
        return [
            "VAR_IN_OUT",
            *(f"    {name} : {type_name};" for name, type_name in self.type_names.items()),
        ]

    def types_text(self) -> list[str]:
        """Return the lines that define the types of the arrays."""
        return [
            line
            for name, (size, kind) in self.sizes.items()
            for line in (
                "TYPE",
                f"    {self.type_names[name]} : ARRAY [0..{size - 1}] OF {kind};",
                "END_TYPE",
                "",
            )
        ]

    def dispatcher(self, types: tuple[Type, ...]) -> str:
        """Return the name of the function that calls others by their number."""
        if types not in self.dispatchers:
            name = self.dispatchers[types] = self.name("call")
            listed = self.walk.functions.norms if len(types) == 4 else self.walk.functions.curves
            pairs = [f"a{i}_{part}" for i in range(len(types)) for part in ("at", "n")]
            lines = []
            for number, function in listed.items():
                callee = self.function(function, types)
                passed = ", ".join([*MEMORIES.values(), *pairs])
                lines += [f"IF number = {number} THEN", f"    done := {callee.name}({passed});",
                          "END_IF;"]  # fmt: skip
            text = [
                f"FUNCTION {name} : BOOL", *self.memories(), "END_VAR", "VAR_INPUT",
                "    number : DINT;", *(f"    {pair} : DINT;" for pair in pairs), "END_VAR",
                "VAR", "    done : BOOL;", "END_VAR", "", *lines, f"{name} := TRUE;",
                "END_FUNCTION", "",
            ]  # fmt: skip
            self._finished.append(WrittenFunction("\n".join(text)))  # type: ignore[arg-type]
        return self.dispatchers[types]


class _STFunction(_Function):
    """One kernel as a function of Structured Text."""

    whole: _InST

    def translate(self) -> None:
        """Write the text: again, until no name has become wider meanwhile."""
        before: Any = None
        while before != (self.types, self._returns):
            before = dict(self.types), self._returns
            self._temporaries = 0
            self.before: list[str] = []
            self.locals: dict[str, str] = {"done": "BOOL"}
            body = [line for statement in self.source.body for line in self.statement(statement)]
        parts = enumerate(self._parts())
        results = [f"    part_{i} : {self.whole.type_name(part)};" for i, part in parts]
        kind = "BOOL" if self._parts() or not isinstance(self.returned, Scalar) else (
            _KINDS[self.returned])  # fmt: skip
        inputs = [line for name in self.parameters for line in self._declared(name)]
        local = {n: t for n, t in self.types.items() if n not in self.parameters}
        lines = [line for name in local for line in self._declared(name)]
        lines += [f"    {name} : {st_type};" for name, st_type in self.locals.items()]
        end = [f"{self.name} := TRUE;"] if kind == "BOOL" and self.returned is not TRUTH else []
        self.text = "\n".join([
            f"FUNCTION {self.name} : {kind}", *self.whole.memories(), *results, "END_VAR",
            "VAR_INPUT", *inputs, "END_VAR", "VAR", *lines, "END_VAR", "", *body, *end,
            "END_FUNCTION", "",
        ])  # fmt: skip

    def _parts(self) -> tuple[Type, ...]:
        return self.returned.parts if isinstance(self.returned, TupleType) else ()

    def _declared(self, name: str) -> list[str]:
        type_, identifier = self.types[name], self.variable(name)
        if isinstance(type_, Array):
            return [f"    {identifier}_at : DINT;", f"    {identifier}_n : DINT;"]
        assert isinstance(type_, Scalar), name
        return [f"    {identifier} : {_KINDS[type_]};"]

    # --- Statements ---

    def statement(self, node: ast.stmt) -> list[str]:
        """Return the lines of a statement, after the calls that its values need."""
        outer, self.before = self.before, []
        lines = super().statement(node)
        lines, self.before = [*self.before, *lines], outer
        return lines

    def block(self, body: Any) -> list[str]:
        """Return the lines of some statements, one step further in."""
        return ["    " + line for statement in body for line in self.statement(statement)]

    def plain(self, node: ast.Expr) -> list[str]:
        """Return a call for what it does."""
        if isinstance(node.value, ast.Constant):
            return []
        value = self.value(node.value)
        is_called = isinstance(value.type, TupleType)  # before this statement
        return [] if is_called else [f"done := {value.text};"]

    def return_(self, node: ast.Return) -> list[str]:
        """Return the lines that set the result and leave."""
        if node.value is None:
            return ["RETURN;"]
        if isinstance(node.value, ast.Tuple):
            values = [self.value(part) for part in node.value.elts]
            type_: Type = TupleType(tuple(value.type for value in values))
        else:
            value = self.value(node.value)
            type_ = value.type
            if isinstance(type_, TupleType):
                names = value.text.split(_SPLIT)
                values = [TypedText(*pair) for pair in zip(names, type_.parts, strict=True)]
        self.returned = self._returns = wider(self._returns, type_)
        if not isinstance(self.returned, TupleType):
            return [f"{self.name} := {self.as_type(value, self.returned)};", "RETURN;"]
        # All values first: a part that is set may be what another one is made of.
        pairs = list(zip(values, self.returned.parts, strict=True))
        return [
            *(f"part_{i} := {self.as_type(*pair)};" for i, pair in enumerate(pairs)),
            "RETURN;",
        ]

    def stored(self, target: ast.expr, value: TypedText) -> list[str]:
        """Return the lines that write a value into a name, an element, or several of these."""
        if isinstance(target, ast.Tuple):
            assert isinstance(value.type, TupleType)
            values = map(TypedText, value.text.split(_SPLIT), value.type.parts)
            pairs = zip(target.elts, values, strict=True)
            return [line for pair in pairs for line in self.stored(*pair)]
        if isinstance(target, ast.Name):
            if target.id == "_":
                return []
            self.widen(target.id, value.type)
            name = self.variable(target.id)
            if isinstance(value.type, Array):
                at, length = value.text.split(_SPLIT)
                return [f"{name}_at := {at};", f"{name}_n := {length};"]
            return [f"{name} := {self.as_type(value, self.types[target.id])};"]
        place = self.value(target)
        return [f"{place.text} := {self.as_type(value, place.type)};"]

    def named(self, name: str, value: TypedText) -> str:
        """Return the statement that gives a value a name."""
        if isinstance(value.type, Array):
            at, length = value.text.split(_SPLIT)
            self.locals |= {f"{name}_at": "DINT", f"{name}_n": "DINT"}
            return f"{name}_at := {at}; {name}_n := {length};"
        assert isinstance(value.type, Scalar)
        self.locals[name] = _KINDS[value.type]
        return f"{name} := {value.text};"

    def assigned(self, target: ast.expr, source: ast.expr) -> list[str]:
        """Return the lines that write all values of a tuple, or one value."""
        if not (isinstance(target, ast.Tuple) and isinstance(source, ast.Tuple)):
            return self.stored(target, self.value(source))
        lines, values = [], []
        for part in source.elts:
            value = self.value(part)
            if isinstance(value.type, Array):  # nothing that is assigned here moves it
                values.append(value)
                continue
            name = self.temporary()
            lines.append(self.named(name, value))
            values.append(TypedText(name, value.type))
        for part, value in zip(target.elts, values, strict=True):
            lines += self.stored(part, value)
        return lines

    def assignment(self, node: ast.Assign) -> list[str]:
        """Return the lines of an assignment, to several names from the same value."""
        value_of = node.value
        if len(node.targets) == 1:
            return self.assigned(node.targets[0], value_of)
        value = self.value(value_of)
        return [line for target in node.targets for line in self.stored(target, value)]

    def break_(self, _node: ast.Break) -> list[str]:
        """Leave a loop."""
        return ["EXIT;"]

    def if_(self, node: ast.If) -> list[str]:
        """Return a choice."""
        lines = [f"IF {self.condition(node.test)} THEN", *self.block(node.body)]
        if node.orelse:
            lines += ["ELSE", *self.block(node.orelse)]
        return [*lines, "END_IF;"]

    def while_(self, node: ast.While) -> list[str]:
        """Return a loop."""
        return [f"WHILE {self.condition(node.test)} DO", *self.block(node.body), "END_WHILE;"]

    def for_(self, node: ast.For) -> list[str]:
        """Return a loop over a range."""
        assert isinstance(node.iter, ast.Call)
        assert isinstance(node.target, ast.Name)
        numbers = [self.value(argument).text for argument in node.iter.args]
        start, end = ("0", numbers[0]) if len(numbers) == 1 else numbers[:2]
        step = numbers[2].strip("()") if len(numbers) == 3 else "1"
        # FOR includes its last number, range does not.
        last = f"{end} + 1" if step.startswith("-") else f"{end} - 1"
        index = self.temporary()
        self.locals[index] = "DINT"
        by = "" if step == "1" else f" BY {step}"
        body = [f"    {line}" for line in self.stored(node.target, TypedText(index, WHOLE))]
        head = f"FOR {index} := {start} TO {last}{by} DO"
        return [head, *body, *self.block(node.body), "END_FOR;"]

    _STATEMENTS: ClassVar[dict[type, Any]] = {
        ast.Expr: plain,
        ast.Return: return_,
        ast.Assign: assignment,
        ast.AnnAssign: _Function.typed_assignment,
        ast.AugAssign: _Function.changed,
        ast.Break: break_,
        ast.If: if_,
        ast.While: while_,
        ast.For: for_,
    }

    # --- Expressions ---

    def name_(self, node: ast.Name) -> TypedText:
        """Return a name; of an array where it begins and how long it is."""
        type_ = self.types.get(node.id)
        if isinstance(type_, Array):
            identifier = self.variable(node.id)
            return TypedText(f"{identifier}_at{_SPLIT}{identifier}_n", type_)
        return super().name_(node)

    def unary(self, node: ast.UnaryOp) -> TypedText:
        """Return a negative, or what is not so."""
        value = self.value(node.operand)
        if isinstance(node.op, ast.USub):
            return TypedText(f"(-{value.text})", value.type)
        return TypedText(f"(NOT {value.text})", TRUTH)

    def joined(self, node: ast.BoolOp) -> TypedText:
        """Return conditions that are joined; both are asked, whatever the first says."""
        word = " AND " if isinstance(node.op, ast.And) else " OR "
        return TypedText(f"({word.join(self.condition(part) for part in node.values)})", TRUTH)

    def compared(self, node: ast.Compare) -> TypedText:
        """Return a comparison, of two values at a time."""
        values = [self.value(part) for part in (node.left, *node.comparators)]
        parts = []
        for a, sign, b in zip(values[:-1], node.ops, values[1:], strict=True):
            type_ = wider(a.type, b.type)
            texts = (
                self.as_type(a, type_),
                self.target.comparisons[type(sign)],
                self.as_type(b, type_),
            )
            parts.append(f"({' '.join(texts)})")
        return TypedText(parts[0] if len(parts) == 1 else f"({' AND '.join(parts)})", TRUTH)

    def choice(self, node: ast.IfExp) -> TypedText:
        """Return a choice between two values, of which one is found before the statement."""
        condition, outer = self.condition(node.test), self.before
        branches = []
        for part in (node.body, node.orelse):
            self.before = []
            branches.append((self.value(part), self.before))
        self.before = outer
        type_ = wider(*(value.type for value, _ in branches))
        assert isinstance(type_, Scalar)
        name = self.temporary()
        self.locals[name] = _KINDS[type_]
        then, otherwise = (
            [f"    {line}" for line in (*before, f"{name} := {self.as_type(value, type_)};")]
            for value, before in branches
        )
        self.before += [f"IF {condition} THEN", *then, "ELSE", *otherwise, "END_IF;"]
        return TypedText(name, type_)

    def subscript(self, node: ast.Subscript) -> TypedText:
        """Return an element, a stretch, a length, or a part of what a function returns."""
        if isinstance(node.value, ast.Attribute) and node.value.attr == "shape":
            return self.length(self.value(node.value.value))
        whole = self.value(node.value)
        if isinstance(whole.type, TupleType):
            index = int(str(ast.literal_eval(node.slice)))
            return TypedText(whole.text.split(_SPLIT)[index], whole.type.parts[index])
        assert isinstance(whole.type, Array)
        at, length = whole.text.split(_SPLIT)
        if isinstance(node.slice, ast.Slice):
            ends = (node.slice.lower, node.slice.upper)
            start, end = (None if part is None else self.value(part).text for part in ends)
            size = length if end is None else f"MIN({end}, {length})"
            if start is None:
                return TypedText(f"{at}{_SPLIT}{size}", whole.type)
            return TypedText(f"{at} + {start}{_SPLIT}{size} - {start}", whole.type)
        index_text = self.value(node.slice).text
        memory = MEMORIES[whole.type]
        return TypedText(f"{memory}[{at} + {index_text}]", whole.type.element)

    def length(self, whole: TypedText) -> TypedText:
        """Return how long an array is."""
        return TypedText(f"({whole.text.split(_SPLIT)[1]})", WHOLE)

    def function_called(self, node: ast.Call, function: Any) -> TypedText:
        """Return a call; what returns several numbers is called before the statement."""
        from fuzzyarm.symbolic.kernels import call, is_kernel

        if function is not call and not is_kernel(function):
            return super().function_called(node, function)
        arguments = [self.value(argument) for argument in node.args]
        memories = list(MEMORIES.values())
        if function is call:
            types = tuple(argument.type for argument in arguments[1:])
            passed = [arguments[0].text, *(_passed(argument.text) for argument in arguments[1:])]
            name = self.whole.dispatcher(types)
            return TypedText(f"{name}({', '.join([*memories, *passed])})", Nothing.NOTHING)
        callee = self.whole.function(
            function, [argument.type for argument in arguments], self.bindings
        )
        kinds = [callee.types[name] for name in callee.parameters]
        passed = [_passed(self.as_type(*pair)) for pair in zip(arguments, kinds, strict=True)]
        if not isinstance(callee.returned, TupleType):
            return TypedText(f"{callee.name}({', '.join([*memories, *passed])})", callee.returned)
        parts = []
        for part in callee.returned.parts:
            assert isinstance(part, Scalar)
            parts.append(self.temporary())
            self.locals[parts[-1]] = _KINDS[part]
        self.before.append(f"done := {callee.name}({', '.join([*memories, *parts, *passed])});")
        return TypedText(_SPLIT.join(parts), callee.returned)

    def as_type(self, value: TypedText, type_: Type) -> str:
        """Return the text of a value as one of another type."""
        if value.type is TRUTH and type_ in {WHOLE, REAL}:
            return f"BOOL_TO_{_KINDS[type_]}({value.text})"
        return super().as_type(value, type_)

    _VALUES: ClassVar[dict[type, Any]] = {
        **_Function._VALUES,
        ast.Name: name_,
        ast.UnaryOp: unary,
        ast.BoolOp: joined,
        ast.Compare: compared,
        ast.IfExp: choice,
        ast.Subscript: subscript,
    }


def _passed(text: str) -> str:
    return text.replace(_SPLIT, ", ")
