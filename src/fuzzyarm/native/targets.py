"""Languages that kernels are printed in: how each spells what was read."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from fuzzyarm.expression.printing import javascript_number
from fuzzyarm.inference import integrated
from fuzzyarm.native.translation import Value
from fuzzyarm.native.types import Array, Nothing, Record, Scalar, Type, widest

__all__ = ["C99", "JavaScript", "Target"]

REAL, WHOLE, SHORT, TRUTH = Scalar.REAL, Scalar.WHOLE, Scalar.SHORT, Scalar.TRUTH

_FUNCTIONS_OF_MATH = tuple(
    getattr(math, name)
    for name in ["sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp", "expm1", "log", "log1p", "sqrt"]
)
"""Functions of reals that have their names in every language."""


class Target:
    """A language with the statements of C.

    Attributes
    ----------
    name : str
        In messages.
    operators : dict
        Of an operator and the type of its value, the text with ``{0}`` and ``{1}``.
    comparisons : dict
        Signs.
    counted : str
        Head of a loop over a range.
    """

    name: ClassVar[str]
    operators: ClassVar[Mapping[tuple[type, Scalar], str]]
    comparisons: ClassVar[Mapping[type, str]]
    counted: ClassVar[str]

    def own(self, function: Callable[..., Any]) -> str | None:
        """Return the text of a kernel that is written by hand in this language."""
        return None

    def function(
        self,
        name: str,
        parameters: Mapping[str, Type],
        local: Mapping[str, Type],
        returned: Type,
        body: Sequence[str],
    ) -> str:
        """Return the definition of a function."""
        raise NotImplementedError

    def variable(self, name: str) -> str:
        """Return a name of a kernel as a variable."""
        return name

    def constant(self, name: str, value: Value) -> str:
        """Return the statement that gives a value a name, once."""
        raise NotImplementedError

    def together(self, lines: Sequence[str]) -> list[str]:
        """Return statements whose names nobody else sees."""
        return ["{", *(f"  {line}" for line in lines), "}"]

    def truth(self, value: bool) -> str:
        """Return a truth value."""
        raise NotImplementedError

    def real(self, value: float) -> str:
        """Return a number with all its bits."""
        raise NotImplementedError

    def converted(self, value: Value, type_: Type) -> str:
        """Return a value as one of a wider type."""
        raise NotImplementedError

    def record(self, type_: Record, parts: Sequence[str]) -> str:
        """Return a tuple of values."""
        raise NotImplementedError

    def field(self, text: str, type_: Record, index: int) -> str:
        """Return a part of a tuple."""
        raise NotImplementedError

    def uniform_field(self, text: str, index: str) -> str:
        """Return a part of a tuple of which all parts are alike, by an index that is computed."""
        raise NotImplementedError

    def part(self, whole: Value, start: str, end: str | None) -> str:
        """Return a stretch of an array; its end may lie behind that of the array."""
        raise NotImplementedError

    def element(self, text: str, index: str) -> str:
        """Return an element of an array."""
        return f"{text}[{index}]"

    def length(self, text: str) -> str:
        """Return the length of an array."""
        raise NotImplementedError

    def wholes(self, text: str) -> str:
        """Return the whole numbers in the memory of an array of reals."""
        raise NotImplementedError

    def call(self, arguments: Sequence[Value]) -> str:
        """Return a call of what stands at an address, with arrays."""
        raise NotImplementedError

    def function_of_python(self, function: Any, arguments: Sequence[Value]) -> Value | None:
        """Return a call of a function of Python or NumPy; None where the language has none."""
        raise NotImplementedError


_COMPARISONS = {
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=",
}  # fmt: skip

_ARITHMETIC: dict[tuple[type, Scalar], str] = {
    (operator, type_): f"({{0}} {sign} {{1}})"
    for operator, sign in ((ast.Add, "+"), (ast.Sub, "-"), (ast.Mult, "*"))
    for type_ in (SHORT, WHOLE, REAL)
} | {(ast.Div, REAL): "({0} / {1})"}


class C99(Target):
    """C99 over double and 64-bit whole numbers; an array is a pointer with its length.

    Attributes
    ----------
    structures : list of str
        Definitions of the tuples that were met.
    """

    name = "C"
    comparisons = _COMPARISONS
    operators: ClassVar[dict[tuple[type, Scalar], str]] = {
        **_ARITHMETIC,
        (ast.FloorDiv, WHOLE): "quotient_of({0}, {1})",
        (ast.Mod, WHOLE): "remainder_of({0}, {1})",
        (ast.RShift, WHOLE): "({0} >> {1})",
    }
    counted = (
        "for (int64_t {index} = {start}, {index}_end = {end};"
        " {index} {sign} {index}_end; {index} += {step})"
    )

    HEAD = """\
#include <math.h>
#include <stdint.h>

/* A stretch of memory. Kernels of Python see an array. */
typedef struct { double *at; int64_t length; } reals;
typedef struct { int64_t *at; int64_t length; } wholes;
typedef struct { int32_t *at; int64_t length; } shorts;

/* Of two equal numbers the first, also where one is not a number: as in Python. */
static inline double real_min(double a, double b) { return b < a ? b : a; }
static inline double real_max(double a, double b) { return b > a ? b : a; }
static inline int64_t whole_min(int64_t a, int64_t b) { return b < a ? b : a; }
static inline int64_t whole_max(int64_t a, int64_t b) { return b > a ? b : a; }
static inline int64_t quotient_of(int64_t a, int64_t b) {
  return a / b - (a % b != 0 && (a % b < 0) != (b < 0));
}
static inline int64_t remainder_of(int64_t a, int64_t b) {
  const int64_t rest = a % b;
  return rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
}
static inline reals part_of_reals(reals a, int64_t start, int64_t end) {
  return (reals){a.at + start, (end < a.length ? end : a.length) - start};
}
static inline wholes part_of_wholes(wholes a, int64_t start, int64_t end) {
  return (wholes){a.at + start, (end < a.length ? end : a.length) - start};
}
"""

    _NUMBERS: ClassVar[dict[Type, str]] = {
        TRUTH: "int64_t",
        SHORT: "int32_t",
        WHOLE: "int64_t",
        REAL: "double",
        Array.REALS: "reals",
        Array.WHOLES: "wholes",
        Array.SHORTS: "shorts",
        Nothing.NOTHING: "void",
    }

    _POINTERS: ClassVar[dict[Type, str]] = {
        Array.REALS: "double", Array.WHOLES: "int64_t", Array.SHORTS: "int32_t"
    }  # fmt: skip

    def __init__(self) -> None:
        self.structures: list[str] = []
        self._tuples: dict[tuple[Type, ...], str] = {}

    def type_name(self, type_: Type) -> str:
        """Return the name of a type; that of a tuple is defined when it is met first."""
        if not isinstance(type_, Record):
            return self._NUMBERS[type_]
        if type_.parts not in self._tuples:
            parts = [self.type_name(part) for part in type_.parts]
            name = self._tuples[type_.parts] = f"tuple_{len(self._tuples) + 1}"
            fields = [f"{part} part_{index};" for index, part in enumerate(parts)]
            if type_.uniform:  # an index may be computed
                fields = [f"{parts[0]} part[{len(parts)}];"]
            self.structures.append(f"typedef struct {{ {' '.join(fields)} }} {name};")
        return self._tuples[type_.parts]

    def function(
        self,
        name: str,
        parameters: Mapping[str, Type],
        local: Mapping[str, Type],
        returned: Type,
        body: Sequence[str],
    ) -> str:
        listed = ", ".join(
            f"{self.type_name(type_)} {self.variable(own)}" for own, type_ in parameters.items()
        )
        head = f"static inline {self.type_name(returned)} {name}({listed or 'void'}) {{"
        declared = [
            f"  {self.type_name(type_)} {self.variable(own)};" for own, type_ in local.items()
        ]
        return "\n".join([head, *declared, *body, "}", ""])

    def variable(self, name: str) -> str:
        return f"{name}_"  # no word of C, and no function of its libraries

    def constant(self, name: str, value: Value) -> str:
        return f"const {self.type_name(value.type)} {name} = {value.text};"

    def truth(self, value: bool) -> str:
        return str(int(value))

    def real(self, value: float) -> str:
        if math.isnan(value):
            return "NAN"
        if math.isinf(value):
            return "INFINITY" if value > 0.0 else "(-INFINITY)"
        return repr(float(value))  # the shortest text that reads as the same number

    def converted(self, value: Value, type_: Type) -> str:
        if not isinstance(type_, Record):
            return f"({self.type_name(type_)}){value.text}"
        if self.type_name(value.type) == self.type_name(type_):
            return value.text
        assert isinstance(value.type, Record)
        parts = []
        for index, (narrow, wide) in enumerate(zip(value.type.parts, type_.parts, strict=True)):
            part = Value(self.field(value.text, value.type, index), narrow)
            parts.append(part.text if narrow == wide else self.converted(part, wide))
        return self.record(type_, parts)

    def record(self, type_: Record, parts: Sequence[str]) -> str:
        listed = ", ".join(parts)
        return f"({self.type_name(type_)}){{{f'{{{listed}}}' if type_.uniform else listed}}}"

    def field(self, text: str, type_: Record, index: int) -> str:
        return f"{text}.part[{index}]" if type_.uniform else f"{text}.part_{index}"

    def uniform_field(self, text: str, index: str) -> str:
        return f"{text}.part[{index}]"

    def part(self, whole: Value, start: str, end: str | None) -> str:
        return f"part_of_{whole.type.value}({whole.text}, {start}, {end or f'{whole.text}.length'})"

    def element(self, text: str, index: str) -> str:
        return f"{text}.at[{index}]"

    def length(self, text: str) -> str:
        return f"{text}.length"

    def wholes(self, text: str) -> str:
        return f"(wholes){{(int64_t *){text}.at, {text}.length}}"

    def call(self, arguments: Sequence[Value]) -> str:
        address, *arrays = arguments
        kinds = ", ".join(f"{self._POINTERS[array.type]} *, int64_t" for array in arrays)
        passed = ", ".join(f"{array.text}.at, {array.text}.length" for array in arrays)
        called = f"((void (*)({kinds})){address.text})({passed})"
        if len(arrays) == 1 or {array.type for array in arrays} != {Array.REALS}:
            return called
        # An odd address is that of a program of operations: code begins at even ones only there.
        listed = ", ".join(array.text for array in arrays)
        walked = f"run_program({address.text}, (const reals[]){{{listed}}}, {len(arrays)})"
        return f"{address.text} & 1 ? {walked} : {called}"

    def entry(self, name: str, function: str, types: Sequence[Type]) -> str:
        """Return a function that others call: a pointer and a length for each array."""
        listed = ", ".join(
            f"{self._POINTERS[type_]} *at_{index}, int64_t length_{index}"
            for index, type_ in enumerate(types)
        )
        passed = ", ".join(
            f"({self.type_name(type_)}){{at_{index}, length_{index}}}"
            for index, type_ in enumerate(types)
        )
        return f"static void {name}({listed}) {{ {function}({passed}); }}\n"

    def function_of_python(self, function: Any, arguments: Sequence[Value]) -> Value | None:
        texts = [argument.text for argument in arguments]
        if function in {min, max}:
            type_ = widest([argument.type for argument in arguments])
            prefix = "real" if type_ is REAL else "whole"
            values = [
                argument.text if argument.type == type_ else self.converted(argument, type_)
                for argument in arguments
            ]
            text = values[0]
            for value in values[1:]:
                text = f"{prefix}_{function.__name__}({text}, {value})"
            return Value(text, type_)
        if function is abs:
            real = arguments[0].type is REAL
            return Value(f"{'fabs' if real else 'llabs'}({texts[0]})", arguments[0].type)
        if function is int:
            return Value(f"(int64_t){texts[0]}", WHOLE)
        if function in {float, np.float64}:
            return Value(f"(double){texts[0]}", REAL)
        if function is np.int32:
            return Value(f"(int32_t){texts[0]}", SHORT)
        if function is np.float32:
            return Value(f"(double)(float){texts[0]}", REAL)
        if function is math.isnan:
            return Value(f"isnan({texts[0]})", TRUTH)
        if function in {math.floor, np.floor, np.ceil, np.rint, np.trunc}:
            return Value(f"{function.__name__}({texts[0]})", REAL)
        if function is math.pow or function is math.fmod:
            return Value(f"{function.__name__}({', '.join(texts)})", REAL)
        if function in _FUNCTIONS_OF_MATH:
            return Value(f"{function.__name__}({', '.join(texts)})", REAL)
        return None


class JavaScript(Target):
    """JavaScript: it computes in double precision too, without fusing or reordering.

    An array of reals is a ``Float64Array``. The block has its whole numbers beside it, in an
    ``Int32Array`` of the same length under ``whole``: JavaScript reads the same memory as whole
    numbers of 64 bits only as ``BigInt``, which is slow.
    """

    name = "JavaScript"
    comparisons: ClassVar[dict[type, str]] = {**_COMPARISONS, ast.Eq: "===", ast.NotEq: "!=="}
    operators: ClassVar[dict[tuple[type, Scalar], str]] = {
        **_ARITHMETIC,
        (ast.FloorDiv, WHOLE): "Math.floor({0} / {1})",
        (ast.Mod, WHOLE): "({0} % {1})",
    }
    counted = (
        "for (let {index} = {start}, {index}_end = {end};"
        " {index} {sign} {index}_end; {index} += {step})"
    )

    _OWN: ClassVar[dict[Callable[..., Any], str]] = {
        # It reads floats as whole numbers.
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

    def own(self, function: Callable[..., Any]) -> str | None:
        return self._OWN.get(function)

    def function(
        self,
        name: str,
        parameters: Mapping[str, Type],
        local: Mapping[str, Type],
        returned: Type,
        body: Sequence[str],
    ) -> str:
        head = f"function {name}({', '.join(parameters)}) {{"
        declared = [f"  let {', '.join(local)};"] if local else []
        return "\n".join([head, *declared, *body, "}", ""])

    def constant(self, name: str, value: Value) -> str:
        return f"const {name} = {value.text};"

    def truth(self, value: bool) -> str:
        return "true" if value else "false"

    def real(self, value: float) -> str:
        return javascript_number(value)

    def converted(self, value: Value, type_: Type) -> str:
        return value.text  # there is one type of numbers

    def record(self, type_: Record, parts: Sequence[str]) -> str:
        return f"[{', '.join(parts)}]"

    def field(self, text: str, type_: Record, index: int) -> str:
        return f"{text}[{index}]"

    def uniform_field(self, text: str, index: str) -> str:
        return f"{text}[{index}]"

    def part(self, whole: Value, start: str, end: str | None) -> str:
        return f"{whole.text}.subarray({start}{f', {end}' if end else ''})"

    def length(self, text: str) -> str:
        return f"{text}.length"

    def wholes(self, text: str) -> str:
        return f"{text}.whole"

    def call(self, arguments: Sequence[Value]) -> str:
        return f"call({', '.join(argument.text for argument in arguments)})"

    def function_of_python(self, function: Any, arguments: Sequence[Value]) -> Value | None:
        texts = [argument.text for argument in arguments]
        listed = ", ".join(texts)
        if function in {min, max}:
            type_ = widest([argument.type for argument in arguments])
            return Value(f"{function.__name__}({listed})", type_)
        if function is abs:
            return Value(f"Math.abs({listed})", arguments[0].type)
        if function is int:
            return Value(f"Math.trunc({listed})", WHOLE)
        if function is float:
            return Value(texts[0], REAL)
        if function is math.isnan:
            return Value(f"Number.isNaN({listed})", TRUTH)
        if function is math.floor or function in _FUNCTIONS_OF_MATH:
            return Value(f"Math.{function.__name__}({listed})", REAL)
        return None
