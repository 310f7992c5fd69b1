"""The target languages of kernels: one record of spellings each."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fuzzyarm.symbolic.kernels import short
from fuzzyarm.symbolic.printing import javascript_number
from fuzzyarm.symbolic.translation.types import Array, Nothing, Scalar, Type, TypedText

REAL, WHOLE, SHORT, TRUTH = Scalar.REAL, Scalar.WHOLE, Scalar.SHORT, Scalar.TRUTH

Functions = Mapping[tuple[Any, Scalar], tuple[str, Scalar]]
"""From a function of Python and the type of its argument to the text and the type of its value."""


@dataclass(frozen=True)
class Target:
    """A language with the statements of C.

    Texts are templates; their holes are named by fields.

    Attributes
    ----------
    name : str
        Name in messages.
    types : mapping of Type to str
        Names of types; empty for a language without type declarations.
    definition, parameter, local : str
        Head of a function, a parameter in it, and the declaration of a local name.
    tuple_prefix : str
        Prefix of the head of a function with tuples as arguments or result.
    variable : str
        A name in a kernel as a variable.
    constant : str
        The statement that binds a value to a name, once.
    counted : str
        Head of a loop over a range.
    cast : str
        A number converted to a wider type.
    operators : mapping
        By operator and type of its value.
    comparisons : mapping
        Signs.
    functions : mapping
        See :data:`Functions`; with two arguments for ``min`` and ``max``.
    truths : (str, str)
        False and true.
    real : callable
        From a float to an exact text.
    structure, record, uniform_record : str
        Definition of a tuple type, if the language has them; a tuple, and one whose parts are all
        numbers of one type.
    part, uniform_part : str
        A part of a tuple by index; for a uniform one the index may be computed.
    element, length, stretch, wholes : str
        For arrays: an element, the length, a slice (whose end may exceed the array's), and the
        integers in the same memory.
    call : callable
        From an address and arrays to the call of the function there.
    """

    name: str
    types: Mapping[Type, str]
    definition: str
    tuple_prefix: str
    parameter: str
    local: str
    variable: str
    constant: str
    counted: str
    cast: str
    operators: Mapping[tuple[type, Scalar], str]
    comparisons: Mapping[type, str]
    functions: Functions
    truths: tuple[str, str]
    real: Callable[[float], str]
    structure: str
    record: str
    uniform_record: str
    part: str
    uniform_part: str
    element: str
    length: str
    stretch: str
    wholes: str
    call: Callable[[str, Sequence[TypedText]], str]


# ── common to the languages ──────────────────────────────────────────────────────────

_COMPARISONS: dict[type, str] = {
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=",
}  # fmt: skip

_ARITHMETIC: dict[tuple[type, Scalar], str] = {
    (operator, type_): f"({{0}} {sign} {{1}})"
    for operator, sign in ((ast.Add, "+"), (ast.Sub, "-"), (ast.Mult, "*"))
    for type_ in (SHORT, WHOLE, REAL)
} | {(ast.Div, REAL): "({0} / {1})"}

_SAME_EVERYWHERE = tuple(
    getattr(math, name)
    for name in (
        "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh",
        "exp", "expm1", "log", "log1p", "log10", "sqrt",
    )
)  # fmt: skip
"""Functions of reals with the same name in every language."""


def _functions(
    prefix: str, others: Mapping[Any, tuple[str, Scalar]], extremes: Mapping[Scalar, str]
) -> dict[tuple[Any, Scalar], tuple[str, Scalar]]:
    """Return a table of functions; `extremes` are templates of ``min`` and ``max`` by type."""
    table: dict[tuple[Any, Scalar], tuple[str, Scalar]] = {
        (function, type_): text for function, text in others.items() for type_ in Scalar
    }
    for function in _SAME_EVERYWHERE:
        table[function, REAL] = f"{prefix}{function.__name__}({{}})", REAL
    for type_, template in extremes.items():
        for extreme in (min, max):
            table[extreme, type_] = template.replace("?", extreme.__name__), type_
    return table


# ── C ────────────────────────────────────────────────────────────────────────────────


def _c_real(value: float) -> str:
    if math.isnan(value):
        return "NAN"
    if math.isinf(value):
        return "INFINITY" if value > 0.0 else "(-INFINITY)"
    return repr(float(value))  # the shortest exact text


POINTERS = {Array.REALS: "double", Array.WHOLES: "int64_t", Array.SHORTS: "int32_t"}
"""Types of C for the elements of arrays."""


def _c_call(address: str, arrays: Sequence[TypedText]) -> str:
    kinds = ", ".join(f"{POINTERS[Array(array.type)]} *, int64_t" for array in arrays)
    passed = ", ".join(f"{array.text}.at, {array.text}.length" for array in arrays)
    call = f"((void (*)({kinds}))code_at({address}))({passed})"
    if len(arrays) == 1 or {array.type for array in arrays} != {Array.REALS}:
        return call
    # An odd address is a program of operations; machine code is aligned.
    listed = ", ".join(array.text for array in arrays)
    walked = f"run_program({address}, (const reals[]){{{listed}}}, {len(arrays)})"
    return f"{address} & 1 ? {walked} : {call}"


C99 = Target(
    name="C",
    types={
        TRUTH: "int64_t",
        SHORT: "int32_t",
        WHOLE: "int64_t",
        REAL: "double",
        Array.REALS: "reals",
        Array.WHOLES: "wholes",
        Array.SHORTS: "shorts",
        Nothing.NOTHING: "void",
    },
    definition="static inline {returned} {name}({parameters}) {{",
    # Inlined, tuples stay in registers; in memory, parts written singly and read as a whole would
    # stall.
    tuple_prefix="ALWAYS_INLINE ",
    parameter="{type} {name}",
    local="{type} {name};",
    variable="{}_",  # neither a keyword of C nor a library function
    constant="const {type} {name} = {value};",
    counted=(
        "for (int64_t {index} = {start}, {index}_end = {end};"
        " {index} {sign} {index}_end; {index} += {step}) {{"
    ),
    cast="({type}){value}",
    operators={
        **_ARITHMETIC,
        (ast.FloorDiv, WHOLE): "quotient_of({0}, {1})",
        (ast.Mod, WHOLE): "remainder_of({0}, {1})",
        (ast.RShift, WHOLE): "({0} >> {1})",
    },
    comparisons=_COMPARISONS,
    functions=_functions(
        "",
        {
            int: ("(int64_t){}", WHOLE),
            float: ("(double){}", REAL),
            np.float64: ("(double){}", REAL),
            np.float32: ("(double)(float){}", REAL),
            np.int32: ("(int32_t){}", SHORT),
            short: ("(int32_t){}", SHORT),
            math.isnan: ("isnan({})", TRUTH),
            math.pow: ("pow({})", REAL),
            math.fmod: ("fmod({})", REAL),
            math.floor: ("floor({})", REAL),
            math.ceil: ("(int64_t)ceil({})", WHOLE),
            np.floor: ("floor({})", REAL),
            np.ceil: ("ceil({})", REAL),
            np.rint: ("rint({})", REAL),
            np.trunc: ("trunc({})", REAL),
        },
        {REAL: "real_?({})", WHOLE: "whole_?({})"},
    )
    | {(abs, REAL): ("fabs({})", REAL), (abs, WHOLE): ("llabs({})", WHOLE)},
    truths=("0", "1"),
    real=_c_real,
    structure="typedef struct {{ {fields} }} {name};",
    record="({type}){{{parts}}}",
    uniform_record="({type}){{{{{parts}}}}}",
    part="{}.part_{}",
    uniform_part="{}.part[{}]",
    element="{}.at[{}]",
    length="{}.length",
    stretch="part_of_{kind}({array}, {start}, {end})",
    wholes="(wholes){{(int64_t *){0}.at, {0}.length}}",
    call=_c_call,
)
"""C99 over double and 64-bit integers; an array is a pointer with its length."""

HEAD_OF_C = """\
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#define ALWAYS_INLINE __attribute__((always_inline))
#define NEVER_INLINE __attribute__((noinline))
/* Whatever it calls by name is compiled into it. */
#define FLATTEN __attribute__((flatten))

/* A stretch of memory. Kernels of Python see an array. */
typedef struct { double *at; int64_t length; } reals;
typedef struct { int64_t *at; int64_t length; } wholes;
typedef struct { int32_t *at; int64_t length; } shorts;

/* The code at an address. In WebAssembly that is an index into a table of functions, odd
   or even: twice the place is the address. */
static inline intptr_t code_at(int64_t address) {
#ifdef __wasm__
  return (intptr_t)(address / 2);
#else
  return (intptr_t)address;
#endif
}

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
"""Preamble of kernels in C."""


# ── JavaScript ───────────────────────────────────────────────────────────────────────


def _javascript_call(address: str, arrays: Sequence[TypedText]) -> str:
    return f"call({', '.join([address, *(array.text for array in arrays)])})"


JAVASCRIPT = Target(
    name="JavaScript",
    types={},
    definition="function {name}({parameters}) {{",
    tuple_prefix="",
    parameter="{name}",
    local="let {name};",
    variable="{}",
    constant="const {name} = {value};",
    counted=(
        "for (let {index} = {start}, {index}_end = {end};"
        " {index} {sign} {index}_end; {index} += {step}) {{"
    ),
    cast="{value}",  # only one type of numbers
    operators={
        **_ARITHMETIC,
        (ast.FloorDiv, WHOLE): "Math.floor({0} / {1})",
        (ast.Mod, WHOLE): "({0} % {1})",
    },
    comparisons={**_COMPARISONS, ast.Eq: "===", ast.NotEq: "!=="},
    functions=_functions(
        "Math.",
        {
            int: ("Math.trunc({})", WHOLE),
            np.int32: ("Math.trunc({})", SHORT),
            short: ("Math.trunc({})", SHORT),
            float: ("{}", REAL),
            math.isnan: ("Number.isNaN({})", TRUTH),
            math.floor: ("Math.floor({})", REAL),
        },
        {REAL: "?({})", WHOLE: "?({})"},
    )
    | {(abs, type_): ("Math.abs({})", type_) for type_ in (REAL, WHOLE)},
    truths=("false", "true"),
    real=javascript_number,
    structure="",
    record="[{parts}]",
    uniform_record="[{parts}]",
    part="{}[{}]",
    uniform_part="{}[{}]",
    element="{}[{}]",
    length="{}.length",
    stretch="{array}.subarray({start}, {end})",
    wholes="{}.whole",
    call=_javascript_call,
)
"""JavaScript: it computes in double precision, too, without fusing or reordering.

An array of reals is a ``Float64Array``. The integers of a block are beside it, in an
``Int32Array`` of the same length under ``whole``: JavaScript reads the same memory as 64-bit
integers only as ``BigInt``, which is slow.
"""
