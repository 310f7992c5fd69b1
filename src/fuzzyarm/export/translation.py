"""Kernels in JavaScript: translated from their own source, statement by statement.

A kernel is plain Python over scalars and arrays (:mod:`fuzzyarm.kernels`), so little is needed:
assignments, ``if``, ``while``, loops over ranges, slices, calls of each other. The order of the
arithmetic stays, and JavaScript computes in double precision without fusing or reordering, so
that the bits are those of Python. What is not known is refused by name when the text is made.

An array of floats is a ``Float64Array``. The block has its whole numbers beside it, in an
``Int32Array`` of the same length under ``whole``: JavaScript reads the same memory as whole
numbers of 64 bits only as ``BigInt``, which is slow.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from typing import Any, ClassVar, cast

from fuzzyarm.expression.printing import javascript_number
from fuzzyarm.inference import integrated
from fuzzyarm.kernels import call, is_kernel

__all__ = ["NotTranslatedError", "javascript_of"]


class NotTranslatedError(NotImplementedError):
    """A kernel has a statement that is not translated.

    Attributes
    ----------
    text : str
        The statement.
    """

    def __init__(self, node: ast.AST) -> None:
        self.text = ast.unparse(node)
        super().__init__(f"a kernel has '{self.text}', which is not translated to JavaScript")


OWN = {
    integrated.move_bits: """\
const ONE_FLOAT = new Float64Array(1);
const ITS_WORDS = new Uint32Array(ONE_FLOAT.buffer); // the lower half first

function move_bits(row, index, steps) {
  ONE_FLOAT[0] = row[index];
  const lower = ITS_WORDS[0] + steps;
  ITS_WORDS[0] = lower;
  if (lower < 0) ITS_WORDS[1] -= 1;
  else if (lower > 0xffffffff) ITS_WORDS[1] += 1;
  row[index] = ONE_FLOAT[0];
}
""",
}
"""Kernels that read floats as whole numbers, which are written by hand."""


def javascript_of(roots: Iterable[Callable[..., Any]]) -> str:
    """Return the text of kernels and of all that they call, each once.

    Parameters
    ----------
    roots : iterable of callable
        Kernels in plain Python.

    Returns
    -------
    str
        Functions at the top level of a module. They call what :data:`HELPERS` defines, and
        ``call(address, …)`` for functions by address.
    """
    waiting, done = list(roots), dict[Callable[..., Any], str]()
    while waiting:
        function = waiting.pop(0)
        if function not in done:
            done[function] = _translated(function)
            waiting += _called(function)
    return "\n".join(done.values())


def _called(function: Callable[..., Any]) -> Iterator[Callable[..., Any]]:
    plain = cast(Any, function)
    for name in plain.__code__.co_names:
        found = plain.__globals__.get(name)
        if is_kernel(found) and found is not call:
            yield found


@cache
def _translated(function: Callable[..., Any]) -> str:
    if function in OWN:
        return OWN[function]
    (found,) = ast.parse(textwrap.dedent(inspect.getsource(function))).body
    assert isinstance(found, ast.FunctionDef)
    return _Function(found, vars(inspect.getmodule(function))).text()


_BINARY = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Mod: "%"}
_COMPARED = {
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "===", ast.NotEq: "!==",
}  # fmt: skip
_CALLS = {"min": "min", "max": "max", "abs": "Math.abs", "int": "Math.trunc", "call": "call"}
_MATH = {"inf": "Infinity", "nan": "NaN", "isnan": "Number.isNaN"}


class _Function:
    """One kernel."""

    def __init__(self, source: ast.FunctionDef, names: dict[str, Any]) -> None:
        self.source, self.names = source, names
        self.parameters = [each.arg for each in source.args.args]
        self.locals: dict[str, None] = {}
        self.ends = 0

    def text(self) -> str:
        body = self.block(self.source.body, "  ")
        own = [name for name in self.locals if name not in self.parameters]
        made = [f"  let {', '.join(own)};"] if own else []
        head = f"function {self.source.name}({', '.join(self.parameters)}) {{"
        return "\n".join([head, *made, *body, "}", ""])

    # --- Statements ---

    def block(self, body: list[ast.stmt], indent: str) -> list[str]:
        return [indent + line for each in body for line in self.statement(each)]

    def statement(self, each: ast.stmt) -> list[str]:
        writer = self._STATEMENTS.get(type(each))
        if writer is None:
            raise NotTranslatedError(each)
        return writer(self, each)

    def plain(self, each: ast.Expr) -> list[str]:
        return [] if isinstance(each.value, ast.Constant) else [f"{self.value(each.value)};"]

    def returned(self, each: ast.Return) -> list[str]:
        return [f"return {self.value(each.value)};" if each.value else "return;"]

    def assigned(self, each: ast.Assign) -> list[str]:
        targets = [self.target(target) for target in each.targets]
        return [f"{' = '.join(targets)} = {self.value(each.value)};"]

    def typed(self, each: ast.AnnAssign) -> list[str]:
        assert each.value is not None
        return [f"{self.target(each.target)} = {self.value(each.value)};"]

    def left(self, _each: ast.Break) -> list[str]:
        return ["break;"]

    def changed(self, each: ast.AugAssign) -> list[str]:
        return [f"{self.target(each.target)} {_BINARY[type(each.op)]}= {self.value(each.value)};"]

    def chosen(self, each: ast.If) -> list[str]:
        lines = [f"if ({self.value(each.test)}) {{", *self.block(each.body, "  ")]
        if each.orelse:
            lines += ["} else {", *self.block(each.orelse, "  ")]
        return [*lines, "}"]

    def repeated(self, each: ast.While) -> list[str]:
        return [f"while ({self.value(each.test)}) {{", *self.block(each.body, "  "), "}"]

    def looped(self, each: ast.For) -> list[str]:
        called, target = each.iter, each.target
        if not (isinstance(called, ast.Call) and ast.unparse(called.func) == "range"):
            raise NotTranslatedError(each)
        assert isinstance(target, ast.Name)
        numbers = [self.value(argument) for argument in called.args]
        start, end = ("0", numbers[0]) if len(numbers) == 1 else numbers[:2]
        step = numbers[2] if len(numbers) == 3 else "1"
        # The end is found once, as `range` does it; the body may change what it is made of.
        self.ends += 1
        self.locals.update(dict.fromkeys((target.id, f"end_{self.ends}")))
        name, last = target.id, f"end_{self.ends}"
        sign = ">" if isinstance(called.args[-1], ast.UnaryOp) and len(numbers) == 3 else "<"
        head = f"for ({name} = {start}, {last} = {end}; {name} {sign} {last}; {name} += {step}) {{"
        return [head, *self.block(each.body, "  "), "}"]

    _STATEMENTS: ClassVar[dict[type, Callable[..., list[str]]]] = {
        ast.Expr: plain,
        ast.Return: returned,
        ast.Assign: assigned,
        ast.AnnAssign: typed,
        ast.AugAssign: changed,
        ast.Break: left,
        ast.If: chosen,
        ast.While: repeated,
        ast.For: looped,
    }

    def target(self, each: ast.expr) -> str:
        if isinstance(each, ast.Name):
            if each.id == "_":  # several in one pattern need no names
                return ""
            self.locals.setdefault(each.id)
        if isinstance(each, ast.Tuple):
            return f"[{', '.join(self.target(part) for part in each.elts)}]"
        return self.value(each)

    # --- Expressions ---

    def value(self, each: ast.expr) -> str:
        writer = self._VALUES.get(type(each))
        if writer is None:
            raise NotTranslatedError(each)
        return writer(self, each)

    def constant(self, each: ast.Constant) -> str:
        if isinstance(each.value, bool):
            return "true" if each.value else "false"
        if isinstance(each.value, int):
            return str(each.value)
        if isinstance(each.value, float):
            return javascript_number(each.value)
        raise NotTranslatedError(each)

    def name(self, each: ast.Name) -> str:
        known = each.id in self.locals or each.id in self.parameters
        found = None if known else self.names.get(each.id)
        if isinstance(found, int | float):  # a constant of the module
            return str(found) if isinstance(found, int) else javascript_number(found)
        return each.id

    def binary(self, each: ast.BinOp) -> str:
        a, b = self.value(each.left), self.value(each.right)
        if isinstance(each.op, ast.FloorDiv):
            return f"Math.floor({a} / {b})"
        if type(each.op) not in _BINARY:
            raise NotTranslatedError(each)
        return f"({a} {_BINARY[type(each.op)]} {b})"

    def unary(self, each: ast.UnaryOp) -> str:
        sign = "-" if isinstance(each.op, ast.USub) else "!"
        return f"({sign}{self.value(each.operand)})"

    def joined(self, each: ast.BoolOp) -> str:
        word = " && " if isinstance(each.op, ast.And) else " || "
        return f"({word.join(self.value(part) for part in each.values)})"

    def compared(self, each: ast.Compare) -> str:
        values = [self.value(part) for part in (each.left, *each.comparators)]
        parts = [
            f"{a} {_COMPARED[type(sign)]} {b}"
            for a, sign, b in zip(values[:-1], each.ops, values[1:], strict=True)
        ]
        return f"({' && '.join(parts)})"

    def choice(self, each: ast.IfExp) -> str:
        parts = (self.value(part) for part in (each.test, each.body, each.orelse))
        return "({} ? {} : {})".format(*parts)

    def several(self, each: ast.Tuple) -> str:
        return f"[{', '.join(self.value(part) for part in each.elts)}]"

    def subscript(self, each: ast.Subscript) -> str:
        if isinstance(each.value, ast.Attribute) and each.value.attr == "shape":
            return f"{self.value(each.value.value)}.length"
        array = self.value(each.value)
        if not isinstance(each.slice, ast.Slice):
            return f"{array}[{self.value(each.slice)}]"
        start = self.value(each.slice.lower) if each.slice.lower else "0"
        end = f", {self.value(each.slice.upper)}" if each.slice.upper else ""
        return f"{array}.subarray({start}{end})"

    def attribute(self, each: ast.Attribute) -> str:
        if ast.unparse(each.value) == "math" and each.attr in _MATH:
            return _MATH[each.attr]
        raise NotTranslatedError(each)

    def called(self, each: ast.Call) -> str:
        if isinstance(each.func, ast.Attribute) and each.func.attr == "view":
            if ast.unparse(each.func.value) != "block":
                raise NotTranslatedError(each)
            return "block.whole"
        if ast.unparse(each.func) == "float":
            return self.number(each.args[0])
        arguments = ", ".join(self.value(part) for part in each.args)
        if isinstance(each.func, ast.Name):
            if each.func.id == "len":
                return f"{arguments}.length"
            known = each.func.id in _CALLS or is_kernel(self.names.get(each.func.id))
            if not known:
                raise NotTranslatedError(each)
            return f"{_CALLS.get(each.func.id, each.func.id)}({arguments})"
        return f"{self.value(each.func)}({arguments})"

    def number(self, each: ast.expr) -> str:
        """Return the float that an expression is made into; a text is a name of one."""
        if isinstance(each, ast.Constant) and isinstance(each.value, str):
            return javascript_number(float(each.value))
        return self.value(each)

    _VALUES: ClassVar[dict[type, Callable[..., str]]] = {
        ast.Constant: constant,
        ast.Name: name,
        ast.BinOp: binary,
        ast.UnaryOp: unary,
        ast.BoolOp: joined,
        ast.Compare: compared,
        ast.IfExp: choice,
        ast.Tuple: several,
        ast.Subscript: subscript,
        ast.Attribute: attribute,
        ast.Call: called,
    }
