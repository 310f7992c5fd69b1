"""Translation of kernels from their Python source, statement by statement.

A kernel uses little of Python: assignments, ``if``, ``while``, loops over ranges, slices, tuples,
calls of kernels. Its source is walked until the type of every name is known (a name has one type
in a function; an integer that is later assigned a float is a float from the start), then once
more for the text. The order of arithmetic is kept. Anything else is refused by name.

A function is translated once for each set of argument types and for each set of bindings.
"""

from __future__ import annotations

import ast
import inspect
import math
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar

from fuzzyarm.symbolic.kernels import call, is_kernel, whole_numbers
from fuzzyarm.symbolic.translation.types import (
    Array,
    Nothing,
    Scalar,
    TupleType,
    Type,
    TypedText,
    wider,
    widest,
)

if TYPE_CHECKING:
    from fuzzyarm.symbolic.translation.targets import Target

REAL, WHOLE, TRUTH = Scalar.REAL, Scalar.WHOLE, Scalar.TRUTH

Bindings = tuple[tuple[str, Callable[..., Any]], ...]


class NotTranslatedError(NotImplementedError):
    """A kernel has a statement without translation.

    Attributes
    ----------
    text : str
        The statement.
    """

    def __init__(self, node: ast.AST, language: str) -> None:
        self.text = ast.unparse(node)
        super().__init__(f"a kernel has '{self.text}', which is not translated to {language}")


class Translation:
    """Functions in one language, in the order callee before caller.

    Parameters
    ----------
    target : Target
        The language.

    Attributes
    ----------
    structures : list of str
        Definitions of tuple types in use, for a language with type declarations.
    """

    def __init__(self, target: Target) -> None:
        self.target = target
        self.structures: list[str] = []
        self._tuples: dict[tuple[Type, ...], str] = {}
        self._functions: dict[tuple[Any, ...], _Function] = {}
        self._finished: list[_Function] = []
        self._names: dict[str, int] = {}

    def function(
        self,
        function: Callable[..., Any],
        types: Sequence[Type],
        bindings: Mapping[str, Callable[..., Any]] | Bindings = (),
    ) -> _Function:
        """Translate a function for given argument types, with its callees.

        Parameters
        ----------
        function : callable
            A kernel, or a function printed from an expression, with its text in ``__source__``.
        types : sequence of Type
            Types of its arguments.
        bindings : mapping of str to callable, optional
            Functions bound to these names in the kernels.
        """
        bound = _used_by(function, dict(bindings))
        key = (function, tuple(types), bound)
        if key not in self._functions:
            name = self.name(function.__name__)
            translation = _Function(self, function, types, bound, name)
            self._functions[key] = translation
            translation.translate()
            self._finished.append(translation)
        return self._functions[key]

    def name(self, name: str) -> str:
        """Return an unused name for a function."""
        count = self._names[name] = self._names.get(name, 0) + 1
        return name if count == 1 else f"{name}__{count}"

    def type_name(self, type_: Type) -> str:
        """Return the name of a type; tuple types are defined on first use."""
        if not self.target.types:
            return ""
        if not isinstance(type_, TupleType):
            return self.target.types[type_]
        if type_.parts not in self._tuples:
            parts = [self.type_name(part) for part in type_.parts]
            name = self._tuples[type_.parts] = f"tuple_{len(self._tuples) + 1}"
            fields = [f"{part} part_{index};" for index, part in enumerate(parts)]
            if type_.uniform:  # allows a computed index
                fields = [f"{parts[0]} part[{len(parts)}];"]
            self.structures.append(self.target.structure.format(fields=" ".join(fields), name=name))
        return self._tuples[type_.parts]

    def text(self) -> str:
        """Return the text of all functions, callees first."""
        return "\n".join(function.text for function in self._finished)


def part_name(parameter: str, part: str) -> str:
    """Return the name of an array that is a field of a parameter."""
    return f"{parameter}.{part}"


@cache
def _source_of(function: Callable[..., Any]) -> ast.FunctionDef:
    text = getattr(function, "__source__", None) or textwrap.dedent(inspect.getsource(function))
    (definition,) = ast.parse(text).body
    assert isinstance(definition, ast.FunctionDef)
    return definition


class _Function:
    """One kernel, for given argument types.

    Attributes
    ----------
    name : str
        Name in the target language.
    parameters : list of str
        In order.
    types : dict of str to Type
        Types of all names, parameters first.
    returned : Type
        Type of its result.
    text : str
        The definition.
    writes : set of str
        Arguments, or fields of them (:func:`part_name`), that it writes to.
    address_calls : set of tuple of (Array, frozenset of str)
        For each call by address, the arrays passed: their type, and the arguments whose memory they
        may share.
    """

    def __init__(
        self,
        whole: Translation,
        function: Callable[..., Any],
        types: Sequence[Type],
        bindings: Bindings,
        name: str,
    ) -> None:
        self.whole, self.target = whole, whole.target
        self.function, self.bindings, self.name = function, bindings, name
        self.source = _source_of(function)
        self.globals = {**function.__globals__, **dict(bindings)}
        self.parameters = [argument.arg for argument in self.source.args.args]
        self.types: dict[str, Type] = dict(zip(self.parameters, types, strict=True))
        self.returned: Type = Nothing.NOTHING
        self.text = ""
        self.writes: set[str] = set()
        self.address_calls: set[tuple[tuple[Array, frozenset[str]], ...]] = set()
        self._memory = {name: frozenset((name,)) for name in self.parameters}
        self._returns: Type | None = None
        self._temporaries = 0
        names = [node for node in ast.walk(self.source) if isinstance(node, ast.Name | ast.arg)]
        self._taken = {
            self.variable(node.id if isinstance(node, ast.Name) else node.arg) for node in names
        }

    def translate(self) -> None:
        """Write the text, again until no name widens its type."""
        before: Any = None
        while before != (self.types, self._returns, self._memory):
            before = dict(self.types), self._returns, dict(self._memory)
            self._temporaries = 0
            body = self.block(self.source.body)
        parameters = [self.declared(self.target.parameter, name) for name in self.parameters]
        local = [name for name in self.types if name not in self.parameters]
        passed = [self.returned, *(self.types[name] for name in self.parameters)]
        has_tuple = any(isinstance(type_, TupleType) for type_ in passed)
        head = self.target.tuple_prefix * has_tuple + self.target.definition.format(
            returned=self.whole.type_name(self.returned),
            name=self.name,
            parameters=", ".join(parameters),
        )
        declarations = [f"  {self.declared(self.target.local, name)}" for name in local]
        self.text = "\n".join([head, *declarations, *body, "}", ""])

    def declared(self, template: str, name: str) -> str:
        """Return the declaration of a name."""
        type_ = self.whole.type_name(self.types[name])
        return template.format(type=type_, name=self.variable(name))

    # --- Statements: lists of lines ---

    def block(self, body: Iterable[ast.stmt]) -> list[str]:
        return ["  " + line for statement in body for line in self.statement(statement)]

    def statement(self, node: ast.stmt) -> list[str]:
        writer = self._STATEMENTS.get(type(node))
        if writer is None:
            raise NotTranslatedError(node, self.target.name)
        return writer(self, node)

    def plain(self, node: ast.Expr) -> list[str]:
        docstring = isinstance(node.value, ast.Constant)
        return [] if docstring else [f"{self.value(node.value).text};"]

    def return_(self, node: ast.Return) -> list[str]:
        if node.value is None or (
            isinstance(node.value, ast.Constant) and node.value.value is None
        ):
            return ["return;"]
        value = self.value(node.value)
        self.returned = self._returns = wider(self._returns, value.type)
        return [f"return {self.as_type(value, self.returned)};"]

    def assignment(self, node: ast.Assign) -> list[str]:
        if len(node.targets) == 1:
            return self.assigned(node.targets[0], node.value)
        value = self.value(node.value)
        name = self.temporary()
        lines = [self.named(name, value)]
        for target in node.targets:
            lines += self.stored(target, value._replace(text=name))
        return _in_scope(lines)

    def typed_assignment(self, node: ast.AnnAssign) -> list[str]:
        assert node.value is not None
        return self.assigned(node.target, node.value)

    def assigned(self, target: ast.expr, source: ast.expr) -> list[str]:
        if not (isinstance(target, ast.Tuple) and isinstance(source, ast.Tuple)):
            return self.stored(target, self.value(source))
        # All values first: they may depend on the targets (a, b = b, a).
        values = [self.value(part) for part in source.elts]
        names = [self.temporary() for _ in values]
        lines = [self.named(*pair) for pair in zip(names, values, strict=True)]
        for part, name, value in zip(target.elts, names, values, strict=True):
            lines += self.stored(part, value._replace(text=name))
        return _in_scope(lines)

    def stored(self, target: ast.expr, value: TypedText) -> list[str]:
        """Return the lines that store a value in a name, an element, or a tuple of these."""
        if isinstance(target, ast.Name) and target.id == "_":
            return []
        if isinstance(target, ast.Name):
            self.widen(target.id, value.type)
            self._memory[target.id] = self._memory.get(target.id, frozenset()) | value.memory
            name = self.variable(target.id)
            return [f"{name} = {self.as_type(value, self.types[target.id])};"]
        if isinstance(target, ast.Tuple):
            assert isinstance(value.type, TupleType)
            name = self.temporary()
            lines = [self.named(name, value)]
            for index, part in enumerate(target.elts):
                lines += self.stored(part, self.part_of(value._replace(text=name), index))
            return _in_scope(lines)
        element = self.value(target)
        assert isinstance(target, ast.Subscript)
        self.writes |= self.value(target.value).memory
        return [f"{element.text} = {self.as_type(value, element.type)};"]

    def changed(self, node: ast.AugAssign) -> list[str]:
        before = self.value(_loaded(node.target))
        return self.stored(node.target, self.arithmetic(node, before, self.value(node.value)))

    def break_(self, _node: ast.Break) -> list[str]:
        return ["break;"]

    def if_(self, node: ast.If) -> list[str]:
        lines = [f"if ({self.condition(node.test)}) {{", *self.block(node.body)]
        if node.orelse:
            lines += ["} else {", *self.block(node.orelse)]
        return [*lines, "}"]

    def while_(self, node: ast.While) -> list[str]:
        return [f"while ({self.condition(node.test)}) {{", *self.block(node.body), "}"]

    def for_(self, node: ast.For) -> list[str]:
        ranged, target = node.iter, node.target
        if not (isinstance(ranged, ast.Call) and ast.unparse(ranged.func) == "range"):
            raise NotTranslatedError(node, self.target.name)
        assert isinstance(target, ast.Name)
        numbers = [self.value(argument).text for argument in ranged.args]
        start, end = ("0", numbers[0]) if len(numbers) == 1 else numbers[:2]
        step = numbers[2] if len(numbers) == 3 else "1"
        sign = ">" if step.startswith(("-", "(-")) else "<"
        # The end is evaluated once, as in `range`: the body may change its operands. And the name
        # keeps its last value after the loop.
        index = self.temporary()
        head = self.target.counted.format(index=index, start=start, end=end, sign=sign, step=step)
        lines = self.stored(target, TypedText(index, WHOLE))
        return [head, *(f"  {line}" for line in lines), *self.block(node.body), "}"]

    _STATEMENTS: ClassVar[dict[type, Callable[..., list[str]]]] = {
        ast.Expr: plain,
        ast.Return: return_,
        ast.Assign: assignment,
        ast.AnnAssign: typed_assignment,
        ast.AugAssign: changed,
        ast.Break: break_,
        ast.If: if_,
        ast.While: while_,
        ast.For: for_,
    }

    def temporary(self) -> str:
        """Return an unused name for a variable."""
        while True:
            self._temporaries += 1
            if f"t{self._temporaries}" not in self._taken:
                return f"t{self._temporaries}"

    def widen(self, name: str, type_: Type) -> None:
        """Widen the type of a name to include another one."""
        try:
            self.types[name] = wider(self.types.get(name), type_)
        except TypeError as error:
            message = f"'{name}' of the kernel {self.function.__name__}: {error}"
            raise TypeError(message) from None

    def variable(self, name: str) -> str:
        return self.target.variable.format(name)

    def named(self, name: str, value: TypedText) -> str:
        """Return the statement that binds a value to a name."""
        type_ = self.whole.type_name(value.type)
        return self.target.constant.format(type=type_, name=name, value=value.text)

    def as_type(self, value: TypedText, type_: Type) -> str:
        """Return the text of a value converted to another type."""
        if value.type == type_:
            return value.text
        if not isinstance(type_, TupleType):
            return self.target.cast.format(type=self.whole.type_name(type_), value=value.text)
        parts = [
            self.as_type(self.part_of(value, index), part) for index, part in enumerate(type_.parts)
        ]
        return self.tuple_of(parts, type_)

    # --- Expressions ---

    def value(self, node: ast.expr) -> TypedText:
        writer = self._VALUES.get(type(node))
        if writer is None:
            raise NotTranslatedError(node, self.target.name)
        return writer(self, node)

    def condition(self, node: ast.expr) -> str:
        return self.value(node).text

    def number(self, value: object, node: ast.expr) -> TypedText:
        if isinstance(value, bool):
            return TypedText(self.target.truths[value], TRUTH)
        if isinstance(value, int):
            return TypedText(str(value), WHOLE)
        if isinstance(value, float):
            return TypedText(self.target.real(value), REAL)
        raise NotTranslatedError(node, self.target.name)

    def constant(self, node: ast.Constant) -> TypedText:
        return self.number(node.value, node)

    def name_(self, node: ast.Name) -> TypedText:
        if node.id in self.types:
            type_ = self.types[node.id]
            memory = frozenset() if isinstance(type_, Scalar) else self._memory[node.id]
            return TypedText(self.variable(node.id), type_, memory)
        return self.number(self.globals.get(node.id), node)  # a module constant

    def binary(self, node: ast.BinOp) -> TypedText:
        return self.arithmetic(node, self.value(node.left), self.value(node.right))

    def arithmetic(self, node: ast.BinOp | ast.AugAssign, a: TypedText, b: TypedText) -> TypedText:
        operator = type(node.op)
        type_ = REAL if operator is ast.Div else _counted(widest([a.type, b.type]))
        if not isinstance(type_, Scalar) or (operator, type_) not in self.target.operators:
            raise NotTranslatedError(node, self.target.name)
        spelled = self.target.operators[operator, type_]
        return TypedText(spelled.format(self.as_type(a, type_), self.as_type(b, type_)), type_)

    def unary(self, node: ast.UnaryOp) -> TypedText:
        value = self.value(node.operand)
        if isinstance(node.op, ast.USub):
            return TypedText(f"(-{value.text})", value.type)
        return TypedText(f"(!{value.text})", TRUTH)

    def joined(self, node: ast.BoolOp) -> TypedText:
        word = " && " if isinstance(node.op, ast.And) else " || "
        return TypedText(f"({word.join(self.condition(part) for part in node.values)})", TRUTH)

    def compared(self, node: ast.Compare) -> TypedText:
        values = [self.value(part).text for part in (node.left, *node.comparators)]
        parts = [
            f"{a} {self.target.comparisons[type(sign)]} {b}"
            for a, sign, b in zip(values[:-1], node.ops, values[1:], strict=True)
        ]
        if len(parts) > 1:
            parts = [f"({part})" for part in parts]
        return TypedText(f"({' && '.join(parts)})", TRUTH)

    def choice(self, node: ast.IfExp) -> TypedText:
        then, otherwise = self.value(node.body), self.value(node.orelse)
        type_ = wider(then.type, otherwise.type)
        texts = self.as_type(then, type_), self.as_type(otherwise, type_)
        return TypedText("({} ? {} : {})".format(self.condition(node.test), *texts), type_)

    def tuple_(self, node: ast.Tuple) -> TypedText:
        return self.record([self.value(part) for part in node.elts])

    def record(self, values: Sequence[TypedText], names: tuple[str, ...] = ()) -> TypedText:
        type_ = TupleType(tuple(value.type for value in values), names)
        memory = frozenset().union(*(value.memory for value in values))
        return TypedText(self.tuple_of([value.text for value in values], type_), type_, memory)

    def tuple_of(self, parts: Sequence[str], type_: TupleType) -> str:
        template = self.target.uniform_record if type_.uniform else self.target.record
        return template.format(type=self.whole.type_name(type_), parts=", ".join(parts))

    def subscript(self, node: ast.Subscript) -> TypedText:
        if isinstance(node.value, ast.Attribute) and node.value.attr == "shape":
            return self.length(self.value(node.value.value))
        whole = self.value(node.value)
        if isinstance(node.slice, ast.Slice):
            ends = (node.slice.lower, node.slice.upper)
            start, end = (None if part is None else self.value(part).text for part in ends)
            text = self.target.stretch.format(
                kind=Array(whole.type).value,
                array=whole.text,
                start=start or "0",
                end=end or self.target.length.format(whole.text),
            )
            return TypedText(text, whole.type, whole.memory)
        if isinstance(whole.type, Array):
            index = self.value(node.slice).text
            return TypedText(self.target.element.format(whole.text, index), whole.type.element)
        assert isinstance(whole.type, TupleType)
        if isinstance(node.slice, ast.Constant):
            return self.part_of(whole, int(str(node.slice.value)))
        assert whole.type.uniform
        index = self.value(node.slice).text
        return TypedText(self.target.uniform_part.format(whole.text, index), whole.type.parts[0])

    def part_of(self, whole: TypedText, index: int) -> TypedText:
        assert isinstance(whole.type, TupleType)
        template = self.target.uniform_part if whole.type.uniform else self.target.part
        type_ = whole.type.parts[index]
        memory = frozenset() if isinstance(type_, Scalar) else whole.memory
        return TypedText(template.format(whole.text, index), type_, memory)

    def attribute(self, node: ast.Attribute) -> TypedText:
        if ast.unparse(node.value) == "math":
            return self.number(getattr(math, node.attr), node)
        whole = self.value(node.value)
        if node.attr == "size":
            return self.length(whole)
        if not isinstance(whole.type, TupleType) or node.attr not in whole.type.names:
            raise NotTranslatedError(node, self.target.name)
        part = self.part_of(whole, whole.type.names.index(node.attr))
        if isinstance(node.value, ast.Name) and node.value.id in self.parameters and part.memory:
            return part._replace(memory=frozenset((part_name(node.value.id, node.attr),)))
        return part

    def length(self, whole: TypedText) -> TypedText:
        if isinstance(whole.type, TupleType):
            return TypedText(str(len(whole.type.parts)), WHOLE)
        return TypedText(self.target.length.format(whole.text), WHOLE)

    # --- Calls ---

    def called(self, node: ast.Call) -> TypedText:
        if isinstance(node.func, ast.Attribute) and node.func.attr == "view":
            viewed = self.value(node.func.value)
            return TypedText(self.target.wholes.format(viewed.text), Array.WHOLES, viewed.memory)
        if isinstance(node.func, ast.Attribute) and ast.unparse(node.func.value) in {"math", "np"}:
            return self.function_called(node, getattr(_module(node), node.func.attr))
        if not isinstance(node.func, ast.Name):
            raise NotTranslatedError(node, self.target.name)
        name = node.func.id
        function = self.globals.get(name, _BUILTINS.get(name))
        if function is whole_numbers:
            viewed = self.value(node.args[0])
            return TypedText(self.target.wholes.format(viewed.text), Array.WHOLES, viewed.memory)
        if name == "float" and isinstance(node.args[0], ast.Constant):  # "inf", "nan"
            return self.number(float(node.args[0].value), node)  # type: ignore[arg-type]
        return self.function_called(node, function)

    def function_called(self, node: ast.Call, function: Any) -> TypedText:
        arguments = [self.value(argument) for argument in node.args]
        if function is call:
            self.address_calls.add(
                tuple((Array(array.type), array.memory) for array in arguments[1:])
            )
            return TypedText(self.target.call(arguments[0].text, arguments[1:]), Nothing.NOTHING)
        if isinstance(function, type) and issubclass(function, tuple):
            return self.record(arguments, function._fields)  # type: ignore[attr-defined]
        if is_kernel(function):
            types = [argument.type for argument in arguments]
            callee = self.whole.function(function, types, self.bindings)
            kinds = [callee.types[name] for name in callee.parameters]
            texts = [self.as_type(*pair) for pair in zip(arguments, kinds, strict=True)]
            memory = self.handed_over(callee, arguments)
            return TypedText(f"{callee.name}({', '.join(texts)})", callee.returned, memory)
        if function is len:
            return self.length(arguments[0])
        return self.spelled(node, function, arguments)

    def handed_over(self, helper: _Function, arguments: Sequence[TypedText]) -> frozenset[str]:
        """Note a callee's effects on its arguments; return the arguments its value may alias."""
        memory = {
            name: value.memory for name, value in zip(helper.parameters, arguments, strict=True)
        }
        for name in helper.writes:
            self.writes |= memory[name]
        for arrays in helper.address_calls:
            self.address_calls.add(
                tuple((type_, _memory_of(memory, names)) for type_, names in arrays)
            )
        returns_arrays = isinstance(helper.returned, Array | TupleType)
        return _memory_of(memory, memory) if returns_arrays else frozenset()

    def spelled(self, node: ast.Call, function: Any, arguments: Sequence[TypedText]) -> TypedText:
        """Return a call of a function of Python or NumPy in the spelling of the language."""
        type_ = widest([argument.type for argument in arguments])
        assert isinstance(type_, Scalar)
        if (function, type_) not in self.target.functions:
            raise NotTranslatedError(node, self.target.name)
        text, returned = self.target.functions[function, type_]
        texts = [self.as_type(argument, type_) for argument in arguments]
        if function not in {min, max}:
            return TypedText(text.format(", ".join(texts)), returned)
        value = texts[0]
        for other in texts[1:]:  # nested in pairs, in order
            value = text.format(f"{value}, {other}")
        return TypedText(value, returned)

    _VALUES: ClassVar[dict[type, Callable[..., TypedText]]] = {
        ast.Constant: constant,
        ast.Name: name_,
        ast.BinOp: binary,
        ast.UnaryOp: unary,
        ast.BoolOp: joined,
        ast.Compare: compared,
        ast.IfExp: choice,
        ast.Tuple: tuple_,
        ast.Subscript: subscript,
        ast.Attribute: attribute,
        ast.Call: called,
    }


_BUILTINS: dict[str, Any] = {
    function.__name__: function for function in (min, max, abs, int, float, len)
}


def _in_scope(lines: Sequence[str]) -> list[str]:
    """Return statements in a scope of their own."""
    return ["{", *(f"  {line}" for line in lines), "}"]


def _memory_of(memory: Mapping[str, frozenset[str]], names: Iterable[str]) -> frozenset[str]:
    """Return all memory behind some names."""
    return frozenset(part for name in names for part in memory[name])


def _counted(type_: Type) -> Type:
    """Return the type of a sum: truth values count as integers."""
    return WHOLE if type_ is TRUTH else type_


def _module(node: ast.Call) -> Any:
    import numpy as np

    assert isinstance(node.func, ast.Attribute)
    return math if ast.unparse(node.func.value) == "math" else np


def _loaded(target: ast.expr) -> ast.expr:
    """Return an assignment target as an expression to be read."""
    expression = ast.parse(ast.unparse(target), mode="eval").body
    assert isinstance(expression, ast.expr)
    return expression


def _used_by(
    function: Callable[..., Any], bindings: dict[str, Callable[..., Any]]
) -> tuple[tuple[str, Callable[..., Any]], ...]:
    """Return the bindings used by a function or its callees: others have no effect."""
    if not bindings or not is_kernel(function):
        return ()
    names = {
        name
        for function_used in reached(function, bindings)
        for name in function_used.__code__.co_names
    }
    return tuple((name, bindings[name]) for name in sorted(names & bindings.keys()))


def reached(
    function: Callable[..., Any], bindings: Mapping[str, Callable[..., Any]]
) -> Iterator[Callable[..., Any]]:
    """Iterate over a kernel and all its callees, each once."""
    waiting, visited = [function], {function}
    while waiting:
        current: Any = waiting.pop()
        yield current
        for name in current.__code__.co_names:
            other = bindings.get(name, current.__globals__.get(name))
            if is_kernel(other) and other is not call and other not in visited:
                visited.add(other)
                waiting.append(other)
