"""Rule bases and tables as a module for MicroPython and CircuitPython, with its self-test.

It imports `math` and `array` alone. Numbers stand in it so that no reader of decimals can round
them: tables as the bytes of an array, single numbers as the quotient of two whole ones.
"""

from __future__ import annotations

import ast
import inspect
import keyword
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fuzzyarm.export.listing import Loop, Walked, element, function_body
from fuzzyarm.export.names import Names, identifier
from fuzzyarm.export.numbers import ExportError, Kind
from fuzzyarm.export.program import Call
from fuzzyarm.export.routine import Routine, plain, routine_words
from fuzzyarm.export.rulebase import DirectRoutine
from fuzzyarm.export.sets import TABLE_HINT
from fuzzyarm.export.table import Side, TableCode, TableRoutine
from fuzzyarm.expression import operations
from fuzzyarm.expression.operations import Operation
from fuzzyarm.expression.printing import PYTHON, Assign, Language, Statement
from fuzzyarm.version import __version__

__all__ = ["RESERVED", "PythonModule", "module_text", "python_module", "routine_function"]

_LETTERS = {"float64": "d", "float32": "f", "int8": "b", "int16": "h", "int32": "i"}

RESERVED = re.compile(
    "|".join([*keyword.kwlist, "math", "array", "self_test", "min", "max", "abs", "range", "float",
              "int", "print", r"K\d+"])
)  # fmt: skip

_QUIET = "_quiet(math.{})"
_FUNCTIONS = {
    "divide": "_divide", "power": "_power", "sinh": "_sinh",
    "log": "_logarithm(math.log)", "log10": "_logarithm(math.log10)",
    "floor": "_whole(math.floor)", "ceil": "_whole(math.ceil)", "round": "_whole(round)",
    "truncate": "_whole(math.trunc)", "remainder": _QUIET.format("fmod"),
    **{name: _QUIET.format(name) for name in ("sqrt", "sin", "cos", "tan", "asin", "acos")},
    **{name: f"_endless(math.{name})" for name in ("exp", "cosh")},
    **{name: f"math.{name}" for name in ("atan", "atan2", "tanh")},
}  # fmt: skip
"""How an operation that may fail is made here: of the functions that fuzzyarm itself has."""

_ENDLESS = """def _endless(function):
    # Too large a result is a ValueError in MicroPython, and an OverflowError elsewhere.
    def endless(x):
        try:
            return float(function(x))
        except (OverflowError, ValueError):
            return math.inf
    return endless
"""

_BISECTION = """def _count(points, first, count, x, reached):
    # How many points from `first` on x has passed; with `reached` those that it equals, too.
    low = 0
    high = count
    while low < high:
        middle = (low + high) // 2
        point = points[first + middle]
        if point < x or (reached and point == x):
            low = middle + 1
        else:
            high = middle
    return low
"""

_WHOLE_BLEND = """def _blend(near, far, share):
    # Rounded to the nearest, ties away from zero.
    product = (far - near) * share
    if product >= 0:
        return near + (product + 16384) // 32768
    return near - (16384 - product) // 32768
"""


@dataclass
class PythonModule:
    """What the functions of a module share."""

    names: Names = field(default_factory=lambda: Names("python", refused=RESERVED))
    constants: list[str] = field(default_factory=list)
    helpers: list[str] = field(default_factory=list)
    names_by_key: dict[object, str] = field(default_factory=dict)

    def number(self, value: float) -> str:
        """Return the text of a float: whole numbers are plain, others constants with a name."""
        if not math.isfinite(value):
            return f'float("{value}")'
        over, under = value.as_integer_ratio()
        if under == 1 and abs(over) < 2**53:
            return "-0.0" if math.copysign(1.0, value) < 0.0 and over == 0 else repr(value)
        if value < 0.0:
            return f"-{self.number(-value)}"
        key = ("number", value)
        if key not in self.names_by_key:
            self.names_by_key[key] = (
                f"K{sum(name.startswith('K') for name in self.names_by_key.values())}"
            )
            # Both have to be floats themselves before they are divided.
            exact = under < 2**1000 and over < 2**1000
            text = f"{over} / {under}" if exact else repr(value)
            self.constants.append(f"{self.names_by_key[key]} = {text}  # {value!r}")
        return self.names_by_key[key]

    def array(self, numbers: Any, kind: Kind, stem: str) -> str:
        """Return the name of an array, which no variable has; equal ones are shared."""
        data = np.asarray(numbers).astype(np.dtype(kind).newbyteorder("<")).tobytes()
        key = ("array", kind, data)
        if key not in self.names_by_key:
            name = self.names_by_key[key] = f"_{self.names.new(stem)}"
            letter = _LETTERS[np.dtype(kind).name]
            parts = [data[i : i + 24] for i in range(0, len(data), 24)]
            lines = "".join(f"\n    {_bytes(part)}" for part in parts)
            self.constants.append(f'{name} = array("{letter}", ({lines}\n))')
        return self.names_by_key[key]

    def helper(self, text: str) -> str:
        """Write a function into the module, once; return its name."""
        if text not in self.helpers:
            self.helpers.append(text)
        return text.partition("(")[0].removeprefix("def ")

    def operation(self, operation: Operation) -> str:
        """Return the template of an operation."""
        name = operation.name
        if name not in _FUNCTIONS:
            return operation.python
        text = _FUNCTIONS[name]
        for helper_name in re.findall(r"_\w+", text):
            self._own(helper_name)
        function = text
        if "(" in text:
            function = f"_{name}_of" if f"_{name}" in text else f"_{name}"
            self.helper(f"{function} = {text}\n")
        return f"{function}({', '.join(f'{{{i}}}' for i in range(operation.arity))})"

    def _own(self, name: str) -> None:
        """Write a function of fuzzyarm's own arithmetic, and those that it calls."""
        if name == "_endless":
            self.helper(_ENDLESS)
            return
        text = _source(getattr(operations, name))
        for helper_name in re.findall(r"\b_[a-z]+\b", text):
            if helper_name != name and hasattr(operations, helper_name):
                self._own(helper_name)
        self.helper(text)

    def language(self) -> Language:
        """Return Python with the numbers and functions of this module."""
        return PYTHON._replace(text=self._text, number=self.number, rename={})

    def _text(self, operation: Operation) -> str:
        return self.operation(operation)


def _bytes(data: bytes) -> str:
    """Return a literal that both kinds of Python read."""
    return 'b"' + "".join(f"\\x{byte:02x}" for byte in data) + '"'


def _source(function: Callable[..., Any]) -> str:
    """Return the text of a function without what MicroPython does not need: types, wrappers."""
    tree = ast.parse(inspect.getsource(function.__code__))  # not of what it wraps
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            node.decorator_list, node.returns = [], None
            for argument in [*node.args.args, node.args.vararg]:
                if argument is not None:
                    argument.annotation = None
    text = f"{ast.unparse(tree)}\n"
    # A result that is too large is a ValueError in MicroPython, of a positive base as well.
    return text.replace(
        "if base != 0.0:", "if base > 0.0:\n            return math.inf\n        if base < 0.0:"
    )


def python_module(routines: Sequence[Routine], name: str) -> tuple[str, list[str]]:
    """Return a module with a function for every routine, and how they are called."""
    module = PythonModule()
    functions: list[str] = []
    calls: list[str] = []
    tests: list[str] = []
    for routine in routines:
        function_name = module.names.new(routine.output.name)
        call, text = routine_function(routine, function_name, module)
        calls.append(call)
        functions.append(text)
        tests += _test(routine, function_name, module)
    words = [line for entry, call in zip(routines, calls, strict=True)
             for line in (call, *(f"  {word}" for word in routine_words(entry)), "")]  # fmt: skip
    head = [
        f"made by fuzzyarm {__version__}; do not edit: make it again from its source",
        "",
        *words,
        f"on a board: import {name}, and {name}.self_test() is 0 where all is well",
    ]
    remark = "Returns 0 if the functions agree with the model."
    return module_text(head, module, functions, [remark, *tests]), calls


def routine_function(routine: Routine, name: str, module: PythonModule) -> tuple[str, str]:
    """Return how the function of a routine is called, and its text."""
    inner = Names("python", refused=RESERVED)
    parameters = [inner.new(argument.name) for argument in routine.arguments]
    call = f"{name}({', '.join(parameters)})"
    if isinstance(routine, TableRoutine):
        body = TableInPython(routine, module, parameters, inner).body()
    else:
        assert isinstance(routine, DirectRoutine)
        body = _rules(routine, module, parameters, inner)
    return call, "\n".join([f"def {call}:", *(f"    {line}" for line in body), ""])


def module_text(
    words: Sequence[str], module: PythonModule, parts: Sequence[str], test: Sequence[str]
) -> str:
    """Return the text of a module: the words of its head, its parts, its test after a remark."""
    remark, *lines = test
    body = ["def self_test():", f"    # {remark}", *(f"    {line}" for line in lines),
            "    return 0", ""]  # fmt: skip
    needs_math = any("math." in text for text in [*module.helpers, *parts])
    head = [
        *(f"# {plain(line)}".rstrip() for line in words),
        "",
        *(["import math"] if needs_math else []),
        "from array import array",
        "",
    ]
    return "\n".join([*head, *module.constants, "", *module.helpers, *parts, "\n".join(body)])


# --- Rules ---


def _rules(
    routine: DirectRoutine, module: PythonModule, parameters: Sequence[str], names: Names
) -> list[str]:
    """Return the statements that infer an output; `names` are those of the function."""
    listing, language = routine.listing, module.language()
    sums = [loop.sums for loop in listing.body if isinstance(loop, Loop)]
    counters = {name for each in sums for name in (each.area, each.moment, each.height, each.index)}
    for name in sorted(listing.names | counters):
        language.rename[name] = names.new(name)
    lines = []
    for symbol, parameter in zip(routine.program.symbols, parameters, strict=True):
        language.rename[symbol] = f"{symbol}_"
        if symbol in listing.reads:
            lines.append(f"{symbol}_ = float({parameter})")
    for name, (call, argument) in listing.calls.items():
        if name in listing.reads:
            function = module.helper(_function(call, module))
            language.rename[name] = f"{function}({language.expression(argument)})"
    for loop in listing.body:
        if isinstance(loop, Walked):
            way = routine.rulebase.output(routine.name).defuzzifier
            raise ExportError(
                f"the {way} of '{routine.name}' is not exported to MicroPython", hint=TABLE_HINT
            )
        lines += _loop(loop, module, language) if isinstance(loop, Loop) else _one(loop, language)
    return [*lines, f"return {language.expression(listing.result)}"]


def _one(statement: Statement, language: Language) -> list[str]:
    return language.lines([_renamed(statement, language.rename)])


def _renamed(statement: Statement, names: Mapping[str, str]) -> Statement:
    """Return a statement that sets variables by their names in Python."""
    if isinstance(statement, Assign):
        return statement._replace(name=names[statement.name])
    then, otherwise = (
        tuple(_renamed(part, names) for part in branch)
        for branch in (statement.then, statement.otherwise)
    )
    return statement._replace(name=names[statement.name], then=then, otherwise=otherwise)


def _loop(loop: Loop, module: PythonModule, language: Language) -> list[str]:
    sums = loop.sums
    for name, column in sums.columns.items():
        array = module.array(column, np.float64, sums.stems[name])
        language.rename[element(sums, name)] = f"{array}[{language.rename[sums.index]}]"
    inner = [line for part in loop.body for line in _one(part, language)]
    return [
        *(f"{language.rename[name]} = 0.0" for name in (sums.area, sums.moment)),
        f"for {language.rename[sums.index]} in range({sums.count}):",
        *(f"    {line}" for line in inner),
    ]


def _function(call: Call, module: PythonModule) -> str:
    """Return the text of a function of ``h``."""
    language = module.language()
    *body, last = function_body(call)
    assert isinstance(last, Assign)
    lines = [*language.lines(body), f"return {language.expression(last.value)}"]
    text = "\n".join([*(f"    {line}" for line in lines), ""])
    key = ("function", text)
    if key not in module.names_by_key:
        module.names_by_key[key] = f"_{module.names.new(call.stem)}"
    return f"def {module.names_by_key[key]}(h):\n{text}"


# --- Tables ---


class TableInPython(TableCode):
    """The statements of a look-up; numbers are those of the port, or whole."""

    language = PYTHON
    types = dict.fromkeys((np.float32, np.float64, np.int8, np.int16, np.int32), "float")

    def __init__(
        self, routine: TableRoutine, module: PythonModule, parameters: Sequence[str], names: Names
    ) -> None:
        super().__init__(routine.core, parameters)
        self.module, self.names = module, names
        self.kind = routine.core.precision.inside

    def body(self) -> list[str]:
        """Return the statements of the function."""
        return self._interpolated() if self.core.linear else self._picked()

    def _points(self, side: Side, what: str) -> str:
        array_name = f"{identifier(self.core.table.axes[side.axis].name)}_{what}"
        return self.module.array(self.core.points[side.axis], self.kind, array_name)

    def _values(self) -> str:
        array_name = f"{identifier(self.core.table.output)}_values"
        return self.module.array(self.core.values, self.kind, array_name)

    def _picked(self) -> list[str]:
        return [f"return {self._values()}[{self.cell()}]"]

    def cell(self) -> str:
        """Return the text of the number of the cell that the inputs fall into."""
        index, what = "", "bins" if self.core.mode == "bins" else "middles"
        count = self.module.helper(_BISECTION) if self.sides else ""
        for side in self.sides:
            call = f"{count}({self._points(side, what)}, 0, {side.size - 1}, {side.name}, False)"
            index = f"({index}) * {side.size} + {call}" if index else call
        return index or "0"

    def _interpolated(self) -> list[str]:
        lines: list[str] = []
        shares, terms = [], []
        for side in self.sides:
            x, i, t = (self.names.new(f"{word}_{side.name}") for word in "xit")
            levels, ends = self._points(side, "levels"), self.core.points[side.axis]
            low, high = f"{levels}[0]", f"{levels}[{len(ends) - 1}]"
            count = self.module.helper(_BISECTION)
            near, far = f"{levels}[{i}]", f"{levels}[{i} + 1]"
            share = self.share(x, near, far)
            if self.fixed:
                share = f"({x} - {near}) * 32768 // ({far} - {near})"
            lines += [
                f"{x} = {side.name} if {side.name} > {low} else {low}",
                f"{x} = {x} if {x} < {high} else {high}",
                f"{i} = {count}({levels}, 1, {side.size - 2}, {x}, True)",
                f"{t} = {share}",
            ]
            shares.append(t)
            terms.append(i if side.stride == 1 else f"{i} * {side.stride}")
        values = self._values()
        if not shares:
            return [f"return {values}[0]"]
        cell = self.names.new("cell")
        lines.append(f"{cell} = {' + '.join(terms)}")

        def assign(side: int, pair: int, near: str, far: str) -> str:
            name = self.names.new(f"v_{pair}_{side}")
            lines.append(f"{name} = {self._blended(near, far, shares[side])}")
            return name

        corners = [f"{values}[{cell} + {k}]" if k else f"{values}[{cell}]" for k in self.offsets]
        value = self.blended(corners, shares, assign)
        return [*lines, f"return {value}"]

    def _blended(self, near: str, far: str, share: str) -> str:
        if self.fixed:
            return f"{self.module.helper(_WHOLE_BLEND)}({near}, {far}, {share})"
        return self.blend(near, far, share)


# --- The self-test ---


def _test(routine: Routine, name: str, module: PythonModule) -> list[str]:
    vectors = routine.vectors()
    count = len(vectors.expected)
    if not count:
        return []
    columns = [*vectors.inputs, vectors.expected]
    rows = np.stack([np.asarray(column) for column in columns], axis=1)
    array = module.array(rows.ravel(), routine.kind, f"test_of_{name}")
    width = len(columns)
    arguments = ", ".join(f"{array}[k + {i}]" if i else f"{array}[k]" for i in range(width - 1))
    # A port with floats of 32 bits is as good as these: the test lets that pass.
    largest = float(np.nanmax(np.abs(vectors.expected.astype(np.float64)), initial=1e-30))
    tolerance = 0 if np.issubdtype(routine.kind, np.integer) else 1e-4 * largest
    return [
        f"for k in range(0, {count * width}, {width}):",
        # `not … <=`, so that a NaN fails as well.
        f"    if not abs({name}({arguments}) - {array}[k + {width - 1}]) <= {tolerance!r}:",
        "        return 1",
    ]
