"""Defuzzifiers that walk over tables: MicroPython, JavaScript, C, Rust.

The kernel's own functions for one point (`walk.py`), from their source. In MicroPython they are
that source; an array of the kernel is a `memoryview` there, whose stretches share memory. The other
languages print it (:mod:`fuzzyarm.symbolic.translation`).
"""

from __future__ import annotations

import ast
import inspect
import math
import re
import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from fuzzyarm.exchange.export.numbers import ExportError
from fuzzyarm.exchange.export.sets import TABLE_HINT
from fuzzyarm.exchange.export.walk import DefuzzifierWalk, WrittenFunction
from fuzzyarm.symbolic.kernels import call, is_kernel
from fuzzyarm.symbolic.operations import OPERATIONS
from fuzzyarm.symbolic.translation.functions import (
    Bindings,
    NotTranslatedError,
    Translation,
    _Function,
)
from fuzzyarm.symbolic.translation.targets import C99, JAVASCRIPT
from fuzzyarm.symbolic.translation.types import (
    Array,
    Nothing,
    Scalar,
    TupleType,
    Type,
    TypedText,
    wider,
)

if TYPE_CHECKING:
    from fuzzyarm.exchange.export.printer import Printer

__all__ = ["c_walk", "javascript_walk", "python_walk", "rust_walk"]


def _tables(printer: Printer, walk: DefuzzifierWalk) -> tuple[str, str]:
    """Return the names of the two arrays of a walk: whole numbers, and floats."""
    layout = walk.layout
    kind = np.int64 if np.int64 in printer.target.types else np.int32
    whole = printer.constant(f"{walk.output}_table", kind, layout.whole)
    return whole, printer.constant(f"{walk.output}_numbers", np.float64, layout.floats)


# ── MicroPython ──────────────────────────────────────────────────────────────────────


def python_walk(printer: Printer, walk: DefuzzifierWalk) -> str:
    """Add the functions of a walk; return the name of that which takes the room."""
    functions = _PythonFunctions(printer, walk)
    entry = functions.name_of(walk.function)
    whole, floats = _tables(printer, walk)
    name = printer.free(f"{walk.output}_defuzzified")
    text = (
        f"def {name}(room):\n    return {entry}({whole}, {floats}, room, room[{walk.heap}:], 0)\n"
    )
    return printer.helper(name, text)


class _PythonFunctions:
    """The functions of a walk, each after those that it calls."""

    def __init__(self, printer: Printer, walk: DefuzzifierWalk) -> None:
        self.printer, self.walk = printer, walk
        self.names: dict[object, str] = {}

    def name_of(self, function: Callable[..., Any]) -> str:
        """Return the name of a function, which is written where it is met first."""
        if function not in self.names:
            self.names[function] = name = self.printer.free(function.__name__)
            text = getattr(function, "__source__", None) or inspect.getsource(function)
            (definition,) = ast.parse(textwrap.dedent(text)).body
            assert isinstance(definition, ast.FunctionDef)
            changed = _AsPython(self, function, definition).visit(definition)
            changed.name = name
            self.printer.helper(name, f"{ast.unparse(ast.fix_missing_locations(changed))}\n")
        return self.names[function]

    def dispatcher(self, count: int) -> str:
        """Return the function that calls what a number stands for."""
        key = ("call", count)
        if key not in self.names:
            listed = self.walk.functions.norms if count == 4 else self.walk.functions.curves
            self.names[key] = name = self.printer.free("call")
            passed = ", ".join(f"a_{i}" for i in range(count))
            lines = [f"def {name}(number, {passed}):"]
            for number, function in listed.items():
                lines.append(f"    if number == {number}:")
                lines.append(f"        {self.name_of(function)}({passed})")
            self.printer.helper(name, "\n".join([*lines, "    return", ""]))
        return self.names[key]

    def operation(self, name: str) -> str:
        """Return the function of an operation, which never raises."""
        template = self.printer.target.operation(self.printer, OPERATIONS[name], np.float64)
        return template.partition("(")[0]


_BY_PYTHON = {
    operation.python.partition("(")[0]: name
    for name, operation in OPERATIONS.items() if operation.binds == 9
}  # fmt: skip
"""Names of operations by those of functions in :mod:`math`."""


class _AsPython(ast.NodeTransformer):
    """The syntax tree of a kernel as that of a plain function."""

    def __init__(
        self, functions: _PythonFunctions, function: Callable[..., Any], source: ast.FunctionDef
    ) -> None:
        self.functions, self.function = functions, function
        stored = {node.id for node in ast.walk(source)
                  if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}  # fmt: skip
        self.local = stored | {argument.arg for argument in source.args.args}

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        node.decorator_list, node.returns = [], None
        for argument in node.args.args:
            argument.annotation = None
        if isinstance(node.body[0], ast.Expr) and isinstance(node.body[0].value, ast.Constant):
            node.body = node.body[1:] or [ast.Pass()]
        return self.generic_visit(node)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AST:
        assert node.value is not None
        return ast.Assign([node.target], self.visit(node.value), lineno=0)

    def visit_Name(self, node: ast.Name) -> ast.AST:
        value = self.function.__globals__.get(node.id)
        if node.id in self.local or not isinstance(value, int | float):
            return node
        text = repr(value) if math.isfinite(value) else f'float("{value}")'
        return ast.parse(text, mode="eval").body

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        self.generic_visit(node)
        if not isinstance(node.op, ast.Div):
            return node
        return ast.Call(ast.Name(self.functions.operation("divide")), [node.left, node.right], [])

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        if ast.unparse(node.value) == "math":
            return node
        if node.attr == "size":
            return ast.Call(ast.Name("len"), [self.visit(node.value)], [])
        raise NotTranslatedError(node, "MicroPython")

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        if isinstance(node.value, ast.Attribute) and node.value.attr == "shape":
            return ast.Call(ast.Name("len"), [self.visit(node.value.value)], [])
        return self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        node.args = [self.visit(argument) for argument in node.args]
        if isinstance(node.func, ast.Attribute):
            if ast.unparse(node.func.value) != "math":
                raise NotTranslatedError(node, "MicroPython")
            return self._of_library(node, node.func.attr)
        assert isinstance(node.func, ast.Name)
        function = self.function.__globals__.get(node.func.id)
        if function is call:
            node.func = ast.Name(self.functions.dispatcher(len(node.args) - 1))
        elif function is not None and is_kernel(function):
            node.func = ast.Name(self.functions.name_of(function))
        elif function is not None:  # a function that an expression is printed with
            return self._of_library(node, function.__name__)
        return node

    def _of_library(self, node: ast.Call, word: str) -> ast.AST:
        """Return the call of a function of mathematics as one that never raises."""
        if word in _BY_PYTHON:
            node.func = ast.Name(self.functions.operation(_BY_PYTHON[word]))
        return node


# ── JavaScript ───────────────────────────────────────────────────────────────────────


def javascript_walk(printer: Printer, walk: DefuzzifierWalk) -> str:
    """Add the functions of a walk; return the name of that which takes the room."""
    return _written(_InJavaScript(printer, walk), printer, walk)


def _written(translation: _InModule, printer: Printer, walk: DefuzzifierWalk) -> str:
    arrays = [Array.WHOLES, Array.CONSTANTS, Array.REALS, Array.REALS]
    try:
        function = translation.function(walk.function, [*arrays, Scalar.WHOLE])
    except NotTranslatedError as error:
        raise ExportError(str(error), hint=TABLE_HINT) from None
    whole, floats = _tables(printer, walk)
    name = printer.free(f"{walk.output}_defuzzified")
    text = translation.text()
    for word, operation in translation.helpers.items():
        if f"{word}(" in text:
            printer.target.operation(printer, OPERATIONS[operation], np.float64)
    printer.helper(name, text)
    entry = translation.entry_text().format(
        name=name, function=function.name, whole=whole, floats=floats, heap=walk.heap
    )
    return printer.helper(name, entry)


class _InModule(Translation):
    """The functions of one walk."""

    entry = ""
    branch: str
    head: str
    helpers: Mapping[str, str] = MappingProxyType({})  # functions of operations, by name
    unused = ""

    def __init__(self, printer: Printer, walk: DefuzzifierWalk, target: Any) -> None:
        super().__init__(replace(target, call=self._call))
        self.printer, self.walk = printer, walk
        self._dispatchers: dict[tuple[Type, ...], str] = {}

    def name(self, name: str) -> str:
        """Return a name that the file does not have yet."""
        return self.printer.free(name)

    def entry_text(self) -> str:
        """Return the function that takes the room, with holes."""
        return self.entry

    def _call(self, address: str, arrays: Sequence[TypedText]) -> str:
        """Return the call of what a number stands for, by a function that knows them all."""
        types = tuple(array.type for array in arrays)
        if types not in self._dispatchers:
            self._dispatchers[types] = self.name("call")
            listed = self.walk.functions.norms if len(types) == 4 else self.walk.functions.curves
            passed = ", ".join(f"a_{i}" for i in range(len(types)))
            parameters = ", ".join(
                self.target.parameter.format(name=f"a_{i}", type=self.type_name(type_))
                for i, type_ in enumerate(types)
            )
            lines = [self.head.format(name=self._dispatchers[types], parameters=parameters)]
            for number, function in listed.items():
                callee = self.function(function, types)
                lines.append(self.branch.format(number=number, call=f"{callee.name}({passed})"))
            if not listed and self.unused:
                names = ("number", *passed.split(", "))
                lines += [f"    {self.unused.format(name)}" for name in names]
            text = "\n".join([*lines, "}", ""])
            self._finished.append(WrittenFunction(text))  # type: ignore[arg-type]
        return f"{self._dispatchers[types]}({address}, {', '.join(a.text for a in arrays)})"


class _InJavaScript(_InModule):
    entry = (
        "const {name}_floats = Float64Array.from({floats});\n\nfunction {name}(room) {{\n"
        "    return {function}({whole}, {name}_floats, room, room.subarray({heap}), 0);\n}}\n"
    )
    head = "function {name}(number, {parameters}) {{"
    branch = "    if (number === {number}) {call};"

    helpers = MappingProxyType({
        "least": "minimum", "greatest": "maximum", "power": "power", "remainder": "remainder",
        "rint": "round",
    })  # fmt: skip

    def __init__(self, printer: Printer, walk: DefuzzifierWalk) -> None:
        functions = dict(JAVASCRIPT.functions)
        for type_ in (Scalar.REAL, Scalar.WHOLE):
            functions |= {(min, type_): ("least({})", type_), (max, type_): ("greatest({})", type_)}
        functions |= {
            (function, Scalar.REAL): (f"{word}({{}})", Scalar.REAL)
            for function, word in (
                (math.pow, "power"), (math.fmod, "remainder"), (np.rint, "rint"),
                (np.floor, "Math.floor"), (np.ceil, "Math.ceil"), (np.trunc, "Math.trunc"),
            )
        }  # fmt: skip
        # No temporary variable of the translation is called as one of the kernel.
        target = replace(JAVASCRIPT, functions=functions, variable="{}_")
        super().__init__(printer, walk, target)


# ── C ────────────────────────────────────────────────────────────────────────────────

_ELEMENTS = {Array.REALS: "double", Array.CONSTANTS: "const double", Array.WHOLES: "const int32_t"}

_ARRAY = """typedef struct {{
    {element} *at;
    int32_t length;
}} {name};
"""

_PART = """{keyword}{type} {name}({type} a, int32_t start, int32_t end)
{{
    {type} part;
    part.at = &a.at[start];
    part.length = ((end < a.length) ? end : a.length) - start;
    return part;
}}
"""


def c_walk(printer: Printer, walk: DefuzzifierWalk) -> str:
    """Add the functions of a walk; return the name of that which takes the room.

    Arrays of the kernel are pointers with a length. Constants in flash stay ``const``; the room is
    on the stack of the caller, and its first two elements become what is returned.
    """
    return _written(_InC(printer, walk), printer, walk)


class _InC(_InModule):
    unused = "(void){};"
    branch = "    if (number == {number}) {{\n        {call};\n    }}"

    def __init__(self, printer: Printer, walk: DefuzzifierWalk) -> None:
        self._keyword = printer.target.hidden
        # Between two @ stands a helper: `text` writes those that are needed.
        extremes = {
            (extreme, type_): (f"@{extreme.__name__} {self._scalar(type_)}@({{}})", type_)
            for extreme in (min, max)
            for type_ in (Scalar.REAL, Scalar.WHOLE)
        }
        self.head = f"{self._keyword}void {{name}}(int32_t number, {{parameters}})\n{{{{"
        target = replace(
            C99,
            types={},
            tuple_prefix="",
            definition=f"{self._keyword}{{returned}} {{name}}({{parameters}})\n{{{{",
            variable="{}_x",
            counted=(
                "for (int32_t {index} = {start}, {index}_end = {end};"
                " {index} {sign} {index}_end; {index} += {step}) {{"
            ),
            # Whole numbers are not negative where they are divided.
            operators={**C99.operators, (ast.FloorDiv, Scalar.WHOLE): "({0} / {1})"},
            functions={
                **C99.functions, **extremes,
                **{(int, t): ("(int32_t){}", Scalar.WHOLE) for t in Scalar},
            },
            truths=("false", "true"),
            real=self._real,
            record="@of {type}@({parts})",
            uniform_record="@of {type}@({parts})",
            stretch="@part {kind}@({array}, {start}, {end})",
        )  # fmt: skip
        super().__init__(printer, walk, target)

    def _real(self, value: float) -> str:
        text = self.printer.target.number(self.printer, value, np.float64)
        return f"({text})" if text.startswith("-") else text

    @staticmethod
    def _scalar(type_: Scalar) -> str:
        return {Scalar.REAL: "double", Scalar.TRUTH: "bool"}.get(type_, "int32_t")

    def _defined(self, stem: str, template: str, **words: str) -> str:
        """Define a type or a small function, once a file; return its name."""
        key = (stem, template, tuple(words.items()))
        if key not in self.printer.known:
            name = self.printer.known[key] = self.name(stem)
            self.printer.helper(name, template.format(name=name, keyword=self._keyword, **words))
        return self.printer.known[key]

    def type_name(self, type_: Type) -> str:
        """Return the name of a type, which is defined where it is met first."""
        if isinstance(type_, Array):
            return self._defined(type_.value, _ARRAY, element=_ELEMENTS[type_])
        if type_ is Nothing.NOTHING:
            return "void"
        if not isinstance(type_, TupleType):
            assert isinstance(type_, Scalar)
            return self._scalar(type_)
        parts = [self.type_name(part) for part in type_.parts]
        fields = "".join(f"    {part} part_{index};\n" for index, part in enumerate(parts))
        if type_.uniform:
            fields = f"    {parts[0]} part[{len(parts)}];\n"
        name = self._defined("parts", "typedef struct {{\n{fields}}} {name};\n", fields=fields)
        self._tuples[type_.parts] = name
        return name

    def entry_text(self) -> str:
        """Return the function that takes the room, with holes."""
        whole, constants, reals = map(self.type_name, (Array.WHOLES, Array.CONSTANTS, Array.REALS))
        layout, room = self.walk.layout, self.walk.room
        pair = self.type_name(TupleType((Scalar.REAL, Scalar.REAL)))
        return "\n".join([
            f"{self._keyword}const double *{{name}}(double *room)", "{{",
            f"    const {whole} whole = {{{{{{whole}}, {len(layout.whole)}}}}};",
            f"    const {constants} floats = {{{{{{floats}}, {len(layout.floats)}}}}};",
            f"    const {reals} all = {{{{room, {room}}}}};",
            f"    const {reals} heap = {{{{&room[{{heap}}], {room - self.walk.heap}}}}};",
            f"    {pair} pair;", "    pair = {function}(whole, floats, all, heap, 0);",
            "    room[0] = pair.part[0];", "    room[1] = pair.part[1];", "    return room;",
            "}}", "",
        ])  # fmt: skip

    def text(self) -> str:
        """Return the functions; the helpers that they use are written before."""
        text = "\n".join(
            _by_the_rules(_without_unused(definition)) for definition in self._finished
        )
        text = re.sub(r"@(\w+) (\w+)@", self._helper, text)
        returning = {
            function.name
            for function in self._finished
            if getattr(function, "returned", Nothing.NOTHING) is not Nothing.NOTHING
        }
        return _CALL.sub(lambda m: f"{m[1]}(void){m[2]}" if m[3] in returning else m[0], text)

    def _helper(self, match: re.Match[str]) -> str:
        sort, what = match.groups()
        if sort == "part":
            return self._defined(f"part_of_{what}", _PART, type=self.type_name(Array(what)))
        if sort == "of":
            (parts,) = (parts for parts, name in self._tuples.items() if name == what)
            return self._constructor(TupleType(parts), what)
        stem, sign = ("least", "<") if sort == "min" else ("greatest", ">")
        if what == "double":
            operation = OPERATIONS["minimum" if sort == "min" else "maximum"]
            return self.printer.target.operation(self.printer, operation, np.float64).partition(
                "("
            )[0]
        template = (
            "{keyword}{type} {name}({type} a, {type} b)\n{{\n    return (b {sign} a) ? b : a;\n}}\n"
        )
        return self._defined(stem, template, type=what, sign=sign)

    def _constructor(self, type_: TupleType, name: str) -> str:
        kinds = [self.type_name(part) for part in type_.parts]
        signature = ", ".join(f"{kind} p_{i}" for i, kind in enumerate(kinds))
        parts = [f"part[{i}]" if type_.uniform else f"part_{i}" for i in range(len(kinds))]
        sets = "".join(f"    found.{part} = p_{i};\n" for i, part in enumerate(parts))
        template = (
            "{keyword}{type} {name}({signature})\n{{\n"
            "    {type} found;\n{sets}    return found;\n}}\n"
        )
        return self._defined("of_parts", template, type=name, signature=signature, sets=sets)


_CALL = re.compile(r"^( *)((\w+)\(.*\);)$", re.MULTILINE)
"""A call whose value, if it has one, is dropped: `(void)` says so (17.7)."""

_PARAMETER = re.compile(r"(\w+_x)(?=[,)])")
_NAMED_RECORD = re.compile(r"^( *)const (\w+) (\w+) = (\w+\(.*\));$", re.MULTILINE)
_COUNTED = re.compile(
    r"^( *)for \(int32_t (\w+) = (.*), (\w+_end) = (.*); (\w+ [<>] .*)$", re.MULTILINE
)


def _by_the_rules(text: str) -> str:
    """Return a function that leaves its parameters alone (MISRA C:2012, 17.8).

    What it writes to is a variable that begins with the parameter. A structure is declared before
    it is set: what a call returns looks like a list of members that is too short (9.3). Of two
    declarations each has its line (12.3). Nothing is added to an index in vain (2.2).
    """
    head, brace, body = text.partition("{\n")
    copies = ""
    for name in _PARAMETER.findall(head):
        if re.search(rf"^ *{name} = ", body, re.MULTILINE):
            kind = re.search(rf"(\w+) {name}\b", head)[1]  # type: ignore[index]
            head = re.sub(rf"\b{name}\b", f"{name}_0", head)
            copies += f"  {kind} {name} = {name}_0;\n"
    body = _NAMED_RECORD.sub(
        lambda m: m[0] if m[2] in {"double", "int32_t", "bool"}
        else f"{m[1]}{m[2]} {m[3]};\n{m[1]}{m[3]} = {m[4]};",
        body,
    )  # fmt: skip
    body = body.replace(" + 0)", ")")  # of indices: a real zero is 0.0
    body = _COUNTED.sub(r"\1const int32_t \4 = \5;\n\1for (int32_t \2 = \3; \6", body)
    return head + brace + copies + body


def _without_unused(function: Any) -> str:
    """Return the text of a function that names all of its parameters."""
    text: str = function.text
    unused = [p for p in function.parameters if len(re.findall(rf"\b{p}_x\b", text)) == 1]
    head, brace, body = text.partition("{\n")
    return head + brace + "".join(f"  (void){name}_x;\n" for name in unused) + body


# ── Rust ─────────────────────────────────────────────────────────────────────────────

_STRETCH = """/// A stretch of the room that a walk works in; stretches overlap.
#[derive(Clone, Copy)]
struct Reals {
    at: *mut f64,
    length: usize,
}

impl Default for Reals {
    fn default() -> Self {
        Reals { at: core::ptr::null_mut(), length: 0 }
    }
}

impl Reals {
    fn len(&self) -> usize {
        self.length
    }
}

impl core::ops::Index<usize> for Reals {
    type Output = f64;
    fn index(&self, i: usize) -> &f64 {
        assert!(i < self.length);
        unsafe { &*self.at.add(i) }
    }
}

impl core::ops::IndexMut<usize> for Reals {
    fn index_mut(&mut self, i: usize) -> &mut f64 {
        assert!(i < self.length);
        unsafe { &mut *self.at.add(i) }
    }
}

fn part_of_reals(a: Reals, start: i64, end: i64) -> Reals {
    let last = core::cmp::min(end as usize, a.length);
    Reals { at: unsafe { a.at.add(start as usize) }, length: last - start as usize }
}

fn part_of_constants(a: &'static [f64], start: i64, end: i64) -> &'static [f64] {
    &a[start as usize..core::cmp::min(end as usize, a.len())]
}

fn counted(start: i64, end: i64, step: i64) -> impl Iterator<Item = i64> {
    let mut next = start;
    core::iter::from_fn(move || {
        let at = next;
        next += step;
        if (step > 0 && at < end) || (step < 0 && at > end) { Some(at) } else { None }
    })
}
"""


def rust_walk(printer: Printer, walk: DefuzzifierWalk) -> str:
    """Add the functions of a walk; return the name of that which takes the room."""
    printer.helper("part_of_reals", _STRETCH)
    return _written(_InRust(printer, walk), printer, walk)


_RUST = replace(
    C99,
    name="Rust",
    types={
        Scalar.TRUTH: "bool", Scalar.SHORT: "i32", Scalar.WHOLE: "i64", Scalar.REAL: "f64",
        Array.REALS: "Reals", Array.CONSTANTS: "&'static [f64]", Array.WHOLES: "&'static [i64]",
        Nothing.NOTHING: "()",
    },
    tuple_prefix="",
    definition="fn {name}({parameters}) -> {returned} {{",
    parameter="mut {name}: {type}",
    local="let mut {name}: {type} = Default::default();",
    constant="let {name}: {type} = {value};",
    counted="for {index} in counted({start}, {end}, {step}) {{",
    cast="(({value}) as {type})",
    operators={**C99.operators, (ast.FloorDiv, Scalar.WHOLE): "({0} / {1})"},
    truths=("false", "true"),
    record="({parts})",
    uniform_record="[{parts}]",
    part="{}.{}",
    uniform_part="{}[({}) as usize]",
    element="{}[({}) as usize]",
    length="({}.len() as i64)",
)  # fmt: skip


class _InRust(_InModule):
    entry = (
        "fn {name}(room: &mut [f64]) -> (f64, f64) {{\n"
        "    let all = Reals {{ at: room.as_mut_ptr(), length: room.len() }};\n"
        "    let heap = part_of_reals(all, {heap}, room.len() as i64);\n"
        "    let pair = {function}(&{whole}, &{floats}, all, heap, 0);\n"
        "    (pair[0], pair[1])\n}}\n"
    )
    head = "fn {name}(number: i64, {parameters}) {{"
    branch = "    if number == {number} {{ {call}; }}"

    def __init__(self, printer: Printer, walk: DefuzzifierWalk) -> None:
        real, whole = Scalar.REAL, Scalar.WHOLE
        functions: dict[Any, tuple[str, Scalar]] = {
            (min, real): ("least({})", real), (max, real): ("greatest({})", real),
            (min, whole): ("core::cmp::min({})", whole), (abs, real): ("absolute({})", real),
            (max, whole): ("core::cmp::max({})", whole), (abs, whole): ("({}).abs()", whole),
            (math.isnan, real): ("({}).is_nan()", Scalar.TRUTH),
            **{(int, each): ("(({}) as i64)", whole) for each in (real, whole)},
            **{(float, each): ("(({}) as f64)", real) for each in (real, whole)},
        }  # fmt: skip
        self.of_word = {}
        for operation in OPERATIONS.values():
            word = operation.c.partition("(")[0].removeprefix("@")
            function = getattr(math, operation.python.partition("(")[0], None)
            if operation.binds == 9 and callable(function):
                functions[function, real] = f"m_{word}({{}})", real
                self.of_word[f"m_{word}"] = operation.name
        self.helpers = MappingProxyType(
            {"least": "minimum", "greatest": "maximum", "absolute": "absolute", **self.of_word}
        )

        def real_text(value: float) -> str:
            return f"({printer.target.number(printer, value, np.float64)})"

        super().__init__(printer, walk, replace(_RUST, functions=functions, real=real_text))

    def new_function(self, function: Any, types: Sequence[Type], bindings: Bindings) -> _Function:
        """Return a function that is not translated yet."""
        return _RustFunction(self, function, types, bindings, self.name(function.__name__))

    def type_name(self, type_: Type) -> str:
        """Return the name of a type."""
        if not isinstance(type_, TupleType):
            return self.target.types[type_]
        parts = [self.type_name(part) for part in type_.parts]
        return f"[{parts[0]}; {len(parts)}]" if type_.uniform else f"({', '.join(parts)})"


class _RustFunction(_Function):
    def choice(self, node: ast.IfExp) -> TypedText:
        """Return a choice between two values."""
        then, otherwise = self.value(node.body), self.value(node.orelse)
        type_ = wider(then.type, otherwise.type)
        texts = self.as_type(then, type_), self.as_type(otherwise, type_)
        condition = self.condition(node.test)
        return TypedText(f"(if {condition} {{ {texts[0]} }} else {{ {texts[1]} }})", type_)

    def as_type(self, value: TypedText, type_: Type) -> str:
        """Return the text of a value as one of another type."""
        if value.type is Scalar.TRUTH and type_ is Scalar.REAL:
            return f"(({value.text}) as i64 as f64)"
        return super().as_type(value, type_)

    _VALUES: ClassVar[dict[type, Any]] = {**_Function._VALUES, ast.IfExp: choice}
