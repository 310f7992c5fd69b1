"""The languages of exported modules: for each a record of spellings and one of a file's frame.

MicroPython imports `math` and `array` alone, and its numbers are written so that no reader of
decimals can round them: arrays as bytes, single numbers as the quotient of two whole ones.
JavaScript is a module for browsers and node. Rust is one source file that needs `core` alone, or
the crate `libm` for mathematical functions without `std`.

To add a language
-----------------
A ``Target`` (its spellings) and a ``Module`` (the class of a controller and the frame of a file, as
templates) here, by its suffix in ``MODULES``; of Rust both take 80 lines. By hand beside them:

- its suffix in :mod:`fuzzyarm.base.folders`, its reserved words in
  :mod:`fuzzyarm.symbolic.identifiers`;
- a function that runs self-tests, in ``LANGUAGES`` of ``tests/export/own_tests.py``, and the
  program that it takes, in ``tests/needs.py``: all shipped files, all functions of formulas, odd
  names, foreign texts and samples that are not finite go through it then;
- its words: the docstring of :mod:`fuzzyarm.apps.cli.compile`, ``exportKinds`` of the page's
  ``strings.js`` (then ``make designer``), ``docs/reference/export.md``; then
  ``tools/make_reference.py``. ``tests/export/test_own_tests.py`` and
  ``tests/designer/test_designer_files.py`` name what is missing.

A language whose expressions only calculate takes `flattened` of :mod:`.structured_text` first;
:mod:`.c` shows what a language may add: structs by axis, pointers to parts of arrays, files with
headers.
"""

from __future__ import annotations

import ast
import inspect
import math
import re
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from fuzzyarm.base.jsonable import script_json
from fuzzyarm.exchange.export.modules import LETTERS, Module
from fuzzyarm.exchange.export.numbers import Kind
from fuzzyarm.exchange.export.printer import Printer, Target
from fuzzyarm.exchange.export.routine import number_lines
from fuzzyarm.exchange.export.typed_program import COUNT, INDEX, NOTHING, OFFSET, TRUTH
from fuzzyarm.symbolic import operations
from fuzzyarm.symbolic.operations import Operation
from fuzzyarm.symbolic.printing import JAVASCRIPT as JAVASCRIPT_EXPRESSIONS
from fuzzyarm.symbolic.printing import PYTHON as PYTHON_EXPRESSIONS


def _is_float(kind: Kind) -> bool:
    return kind in {np.float32, np.float64}


# ── MicroPython ──────────────────────────────────────────────────────────────────────

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


def _python_operation(printer: Printer, operation: Operation, _kind: Kind) -> str:
    name = operation.name
    if name not in _FUNCTIONS:
        return operation.python
    text = _FUNCTIONS[name]
    for helper_name in re.findall(r"_\w+", text):
        _python_own(printer, helper_name)
    function = text
    if "(" in text:
        function = f"_{name}_of" if f"_{name}" in text else f"_{name}"
        printer.helper(function, f"{function} = {text}\n")
    return f"{function}({', '.join(f'{{{i}}}' for i in range(operation.arity))})"


def _python_own(printer: Printer, name: str) -> None:
    """Write a function of fuzzyarm's own arithmetic, and its callees."""
    text = _ENDLESS if name == "_endless" else _python_source(getattr(operations, name))
    if name != "_endless":
        for helper_name in re.findall(r"\b_[a-z]+\b", text):
            if helper_name != name and hasattr(operations, helper_name):
                _python_own(printer, helper_name)
    printer.helper(name, text)


def _python_source(function: Callable[..., Any]) -> str:
    """Return the text of a function without types and wrappers, for MicroPython."""
    tree = ast.parse(inspect.getsource(function.__code__))  # not of the wrapped function
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            node.decorator_list, node.returns = [], None
            for argument in [*node.args.args, node.args.vararg]:
                if argument is not None:
                    argument.annotation = None
    text = f"{ast.unparse(tree)}\n"
    # Overflow is a ValueError in MicroPython, for a positive base as well.
    return text.replace(
        "if base != 0.0:", "if base > 0.0:\n            return math.inf\n        if base < 0.0:"
    )


def _python_number(printer: Printer, value: float, kind: Kind) -> str:
    """Return the text of a float: whole numbers are plain, others constants with a name."""
    if not math.isfinite(value):
        return f'float("{value}")'
    over, under = value.as_integer_ratio()
    if under == 1 and abs(over) < 2**53:
        return "-0.0" if math.copysign(1.0, value) < 0.0 and over == 0 else repr(value)
    if value < 0.0:
        return f"-{_python_number(printer, -value, kind)}"
    if value not in printer.known:
        name = printer.known[value] = f"K{len(printer.known)}"
        # Both must be floats before the division.
        exact = under < 2**1000 and over < 2**1000
        text = f"{over} / {under}" if exact else repr(value)
        printer.constants.append(f"{name} = {text}  # {value!r}")
    return printer.known[value]


def _python_array(
    _printer: Printer, name: str, kind: Kind, values: Sequence[float], _columns: int
) -> str:
    data = np.asarray(values).astype(np.dtype(kind).newbyteorder("<")).tobytes()
    parts = [data[i : i + 24] for i in range(0, len(data), 24)]
    lines = "".join('\n    b"' + "".join(f"\\x{byte:02x}" for byte in part) + '"' for part in parts)
    return f'{name} = array("{LETTERS[np.dtype(kind).name]}", ({lines}\n))'


def _python_cast(text: str, before: Kind, after: Kind) -> str:
    if _is_float(before) == _is_float(after):
        return text
    return f"{'float' if _is_float(after) else 'int'}({text})"


# A product is NaN for a text argument, and preserves the sign of zero.
_PYTHON_CHECK = """def _checked(value, name):
    number = None
    try:
        number = float(value * 1.0)
    except TypeError:
        pass
    if number is None:
        raise TypeError("%s is not a number: %r" % (name, value))
    return number
"""


PYTHON = Target(
    language=PYTHON_EXPRESSIONS, names="python", operation=_python_operation,
    number=_python_number, array=_python_array, cast=_python_cast, truths=("False", "True"),
    again="{name} = {value}", whole_tuple="{name} = {value}", several="{}", returned="return {}",
    member="self.{}", private="_{}", late="{name}=False", quotient="{} // {}",
    function=("def {name}({parameters}):", ""), when="if {}:", otherwise="else:", loop="while {}:",
    repeat="for {index} in range({count}):", end="", remark="# {}",
    scratch='{name} = array("d", bytes(8 * {count}))', left="return{}", stop="break", run="{}",
    count="for {index} in range({start}, {end}, {signed}):",
    flawed_floats=True, helpers=("checked",),
    checked=('{0} = _checked({0}, "{0}")', _PYTHON_CHECK),
)  # fmt: skip


PYTHON_MODULE = Module(
    PYTHON, "#", "on a board: import {0}, and {0}.self_test() is 0 where all is well",
    "controller = Controller()", '''
<more>
from array import array

<constants>

<helpers>
<parts>
def self_test():
    # Returns 0 if all agrees with the model.
    failed = False
    <test>
    return int(failed)
''', '''
class Controller:
    def __init__(self):
        """As before the first period."""
        <starts>

    def step(<parameters>):
        <step>

''', "self", "", "self.{name} = {start}",
    ('array("{letter}", bytes({bytes}))', "[{value}] * {count}", 'array("{letter}", {name})'),
    lambda printer: ["import math"] * any(
        "math." in text for text in [*printer.helpers, *printer.functions]
    ),
)  # fmt: skip


# ── JavaScript ───────────────────────────────────────────────────────────────────────

_JAVASCRIPT_HELPERS = {
    "minimum": ("least", "const least = (a, b) => b < a ? b : a;"),
    "maximum": ("greatest", "const greatest = (a, b) => b > a ? b : a;"),
    "power": (
        "power",
        "// 1 to the power of NaN is 1 in C, and -1 to that of infinity.\n"
        "const power = (a, b) => a === 1 || a === -1 && Math.abs(b) === Infinity ? 1 : a ** b;",
    ),
    "remainder": ("remainder", "const remainder = (a, b) => a % b;"),
    "round": (
        "rint",
        "const rint = (a) => { // of two equally near whole numbers the even one\n"
        "  const near = Math.round(a);\n"
        "  return near - a === 0.5 && near % 2 !== 0 ? near - 1 : near;\n};",
    ),
}


def _with_helpers(
    helpers: dict[str, tuple[str, str]], text: Callable[[Operation], str]
) -> Callable[[Printer, Operation, Kind], str]:
    """Return the text of operations, some of them helper functions in the file."""

    def operation_text(printer: Printer, operation: Operation, _kind: Kind) -> str:
        if operation.name not in helpers:
            return text(operation)
        name = printer.helper(*helpers[operation.name])
        return f"{name}({', '.join(f'{{{i}}}' for i in range(operation.arity))})"

    return operation_text


def _listed(
    head: str, number: Callable[[Printer, float, Kind], str], end: str = "];"
) -> Callable[..., str]:
    """Return the text of arrays of constants, between a head with holes and an end."""

    def array_text(
        printer: Printer, name: str, kind: Kind, values: Sequence[float], columns: int
    ) -> str:
        texts = [number(printer, x, kind) if _is_float(kind) else str(x) for x in values]
        kind_name = printer.target.types.get(kind, "")
        opening = head.format(name=name, type=kind_name, count=len(texts))
        return "\n".join([opening, *number_lines(texts, columns), end])

    return array_text


def _numbers(nan: str, infinity: str) -> Callable[[Printer, float, Kind], str]:
    """Return the text of floats of 64 bits; infinite ones have names."""

    def number_text(_printer: Printer, value: float, _kind: Kind) -> str:
        if math.isfinite(value):
            return repr(float(value))
        return nan if math.isnan(value) else f"{'-' * (value < 0.0)}{infinity}"

    return number_text


_javascript_number = _numbers("NaN", "Infinity")


def _javascript_cast(text: str, before: Kind, after: Kind) -> str:
    return f"Math.trunc({text})" if _is_float(before) and not _is_float(after) else text


JAVASCRIPT = Target(
    language=JAVASCRIPT_EXPRESSIONS, names="javascript",
    operation=_with_helpers(_JAVASCRIPT_HELPERS, JAVASCRIPT_EXPRESSIONS.text),
    number=_javascript_number, array=_listed("const {name} = [", _javascript_number),
    cast=_javascript_cast, again="let {name} = {value};",
    member="this.{}", public="export ", late="{name} = false", quotient="Math.trunc({} / {})",
    function=("{public}function {name}({parameters}) {{", "}\n"),
    repeat="for (let {index} = 0; {index} < {count}; {index}++) {{",
    scratch="const {name} = new Float64Array({count});",
    count="for (let {index} = {start}; {index} {sign} {end}; {index} {way}= {step}) {{",
    helpers=("checked", *(name for name, _ in _JAVASCRIPT_HELPERS.values())),
    checked=('checked({0}, "{0}");', """const checked = (value, name) => {
  if (typeof value === "number") return;
  throw new TypeError(`${name} is not a number: ${JSON.stringify(value)}`);
};"""),
)  # fmt: skip


def _by_name(printer: Printer) -> list[str]:
    """Return functions over inputs by their names in the rule base, and the two lists of names."""
    public = [(key, f) for key, f in printer.program.functions.items() if f.public]
    if not public:
        return []
    pairs = []
    for key, function in public:
        arguments = ", ".join(f"given[{script_json(v.stem)}]" for v in function.parameters.values())
        pairs.append(f"    {script_json(function.stem)}: {printer.called[key]}({arguments}),")
    return [
        f"export const inputs = {script_json(printer.program.inputs)};",
        f"export const outputs = {script_json(printer.program.outputs)};",
        "/** The outputs by name, from the inputs by name; NaN where there is no value. */",
        "export function infer(given) {", "  return {", *pairs, "  };", "}", "",
        "/** Rows of outputs by name, from columns of inputs by name (arrays of one length). */",
        "export function inferMany(given) {",
        "  const found = Object.fromEntries(outputs.map((each) => [each.name, []]));",
        "  for (let k = 0; k < given[inputs[0].name].length; k++) {",
        "    const at = Object.fromEntries(inputs.map(({ name }) => [name, given[name][k]]));",
        "    for (const [name, value] of Object.entries(infer(at))) found[name].push(value);",
        "  }", "  return found;", "}", "",
    ]  # fmt: skip


JAVASCRIPT_MODULE = Module(
    JAVASCRIPT, "//", "selfTest() is 0 where all is well",
    "const controller = new Controller();", """
<constants>

<helpers>

<parts>
<more>
/** Returns 0 if all agrees with the model. */
export function selfTest() {
    let failed = false;
    <test>
    return failed ? 1 : 0;
}
""", """
export class Controller {
  constructor() {
    <starts>
  }

  step(<parameters>) {
    <step>
  }
}

""", "", "", "this.{name} = {start};",
    ("Array({count}).fill({value})", "Array({count}).fill({value})", "{name}.slice()"), _by_name,
)  # fmt: skip


# ── Rust ─────────────────────────────────────────────────────────────────────────────

_RUST_TYPES: dict[Kind, str] = {
    np.float32: "f32", np.float64: "f64", np.int8: "i8", np.int16: "i16", np.int32: "i32",
    np.int64: "i64", INDEX: "usize", COUNT: "u32", TRUTH: "bool", OFFSET: "i32",
    NOTHING: "()",
}  # fmt: skip
_RUST_OPERATORS = {"where": "if {0} {{ {1} }} else {{ {2} }}", "remainder": "({0} % {1})"}
_RUST_METHODS = {"pow": "powf", "log": "ln", "rint": "round_ties_even"}
_RUST_BODIES = {
    "minimum": ("least", "if b < a { b } else { a }"),
    "maximum": ("greatest", "if b > a { b } else { a }"),
    "absolute": ("absolute", "f64::from_bits(a.to_bits() & (u64::MAX >> 1))"),
}
_RUST_EITHER = """#[cfg(feature = "libm")]
    return {};
    #[cfg(not(feature = "libm"))]
    return {};"""


def _rust_operation(printer: Printer, operation: Operation, _kind: Kind) -> str:
    """Return an operator or a function of the file; those of mathematics are not in `core`."""
    name = operation.name
    if name in _RUST_OPERATORS or (operation.binds < 9 and name not in _RUST_BODIES):
        return _RUST_OPERATORS.get(name, operation.c)
    word, letters = operation.c.removeprefix("@").partition("(")[0], "ab"[: operation.arity]
    method = f"a.{_RUST_METHODS.get(word, word)}({letters[1:]})"
    either = _RUST_EITHER.format(f"libm::{word}({', '.join(letters)})", method)
    function, body = _RUST_BODIES.get(name, (f"m_{word}", either))
    parameters = ", ".join(f"{letter}: f64" for letter in letters)
    printer.helper(function, f"fn {function}({parameters}) -> f64 {{\n    {body}\n}}\n")
    return f"{function}({', '.join(['{0}', '{1}'][: operation.arity])})"


_rust_number = _numbers("f64::NAN", "f64::INFINITY")

RUST = Target(
    language=JAVASCRIPT_EXPRESSIONS._replace(
        name="Rust", declare="let {name}: {type} = {value};",
        declare_only="let mut {name}: {type};",
    ),
    names="rust", operation=_rust_operation, number=_rust_number,
    array=_listed("static {name}: [{type}; {count}] = [", _rust_number), types=_RUST_TYPES,
    cast=lambda text, before, after: text if before is after else (
        f"({text} as {_RUST_TYPES[after]})"),
    again="let mut {name}: {type} = {value};", whole_tuple="let {name} = {value};",
    several="({})", several_type="({})", array_type="[{}; {}]", part="{}.{}", member="self.{}",
    public="pub ", returned="{}", parameter="{name}: {type}", array_argument="&[{}]",
    argument="&{}", cast_binds=8, function=("{public}fn {name}({parameters}) -> {type} {{", "}\n"),
    when="if {} {{", loop="while {} {{", repeat="for {index} in 0..{count} {{",
    scratch="let mut {name} = [0.0f64; {count}];", lent="&mut {}", written="&mut [{}]",
    helpers=("least", "greatest", "absolute"),
)  # fmt: skip

RUST_MODULE = Module(
    RUST, "//", "self-test: rustc --test {0}.rs && ./{0}; self_test() is 0 where all is well",
    "let mut controller = Controller::new();", """
#![allow(clippy::all, dead_code, non_snake_case, non_upper_case_globals, unused)]

<constants>

<helpers>
<parts>
/// Returns 0 if all agrees with the model.
pub fn self_test() -> i32 {
    let mut failed = false;
    <test>
    i32::from(failed)
}

#[cfg(test)]
#[test]
fn agrees_with_the_model() {
    assert_eq!(self_test(), 0);
}
""", """
pub struct Controller {
    <fields>
}

impl Controller {
    pub fn new() -> Self {
        Controller {
            <starts>
        }
    }

    pub fn step(<parameters>) -> <returned> {
        <step>
    }
}

""", "&mut self", "pub {name}: {type},", "{name}: {start},",
    ("[{value}; {count}]", "[{value}; {count}]", "{name}"),
)  # fmt: skip


MODULES: Mapping[str, Module] = MappingProxyType({
    ".py": PYTHON_MODULE, **dict.fromkeys((".mjs", ".js"), JAVASCRIPT_MODULE), ".rs": RUST_MODULE,
})  # fmt: skip
"""Languages whose export is one file, by its suffix."""
