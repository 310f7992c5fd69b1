"""A walk over tables in C: the kernel's function for one point, self-contained.

Arrays of the kernel are pointers with a length. Constants in flash stay ``const``; the room is
on the stack of the caller.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from fuzzyarm.export.numbers import ExportError, c_number
from fuzzyarm.export.routine import ONE_OF_TWO, CWriter
from fuzzyarm.export.sets import TABLE_HINT
from fuzzyarm.export.walk import DefuzzifierWalk, WrittenFunction
from fuzzyarm.translation.functions import NotTranslatedError, Translation
from fuzzyarm.translation.targets import C99
from fuzzyarm.translation.types import Array, Nothing, Scalar, TupleType, Type, TypedText

__all__ = ["walk_in_c"]

REAL, WHOLE, TRUTH = Scalar.REAL, Scalar.WHOLE, Scalar.TRUTH

_ELEMENTS = {Array.REALS: "double", Array.CONSTANTS: "const double", Array.WHOLES: "const int32_t"}

_ARRAY = """typedef struct {
    ELEMENT *at;
    int32_t length;
} NAME;
"""

_PART = """TYPE NAME(TYPE a, int32_t start, int32_t end)
{
    TYPE part;
    part.at = &a.at[start];
    part.length = ((end < a.length) ? end : a.length) - start;
    return part;
}
"""

_SIGNS = {min: ("least", "<"), max: ("greatest", ">")}

_ENTRY = """double NAME(double *room, double *total)
{
    const WHOLES whole = {TABLE, TABLE_LENGTH};
    const CONSTANTS floats = {NUMBERS, NUMBERS_LENGTH};
    const REALS all = {room, ROOM};
    const REALS heap = {&room[HEAP], ROOM - HEAP};
    PAIR pair;
    pair = FUNCTION(whole, floats, all, heap, 0);
    *total = pair.part[0];
    return pair.part[1];
}
"""


def walk_in_c(walk: DefuzzifierWalk, writer: CWriter, name: str) -> str:
    """Write a walk into a file; return the name of the function that takes the room.

    It is ``double name(double *room, double *total)``: the room holds the parts and is worked in.
    """
    translation = _InC(walk, writer, name)
    arrays = [Array.WHOLES, Array.CONSTANTS, Array.REALS, Array.REALS]
    try:
        function = translation.function(walk.function, [*arrays, WHOLE])
    except NotTranslatedError as error:
        raise ExportError(str(error), hint=TABLE_HINT) from None
    words = {
        "WHOLES": translation.type_name(Array.WHOLES),
        "CONSTANTS": translation.type_name(Array.CONSTANTS),
        "REALS": translation.type_name(Array.REALS),
        "PAIR": translation.type_name(function.returned),
        "FUNCTION": function.name,
    }
    translation.finish()
    layout = walk.layout
    whole = [str(number) for number in layout.whole]
    floats = [_real(number) for number in layout.floats]
    words |= {
        "TABLE_LENGTH": str(len(whole)),
        "NUMBERS_LENGTH": str(len(floats)),
        "TABLE": writer.constant(np.int32, whole, f"{name}_table"),
        "NUMBERS": writer.constant(np.float64, floats, f"{name}_numbers"),
        "ROOM": str(walk.room),
        "HEAP": str(walk.heap),
    }
    return writer.helper(name, _ENTRY, **words)


def _real(value: float) -> str:
    if math.isfinite(value):
        text = c_number(value, np.float64)
        return f"({text})" if value < 0.0 else text
    name = "NAN" if math.isnan(value) else "INFINITY"
    return f"(-(double){name})" if value < 0.0 else f"(double){name}"


class _InC(Translation):
    """The functions of one walk; small helpers are shared by all of a file."""

    def __init__(self, walk: DefuzzifierWalk, writer: CWriter, name: str) -> None:
        self.walk, self.writer, self.stem = walk, writer, name
        # Between two @ stands a helper: `finish` writes those that are needed.
        extremes = {
            (extreme, type_): (f"@{extreme.__name__} {self._scalar(type_)}@({{}})", type_)
            for extreme in _SIGNS
            for type_ in (REAL, WHOLE)
        }
        self._keyword = keyword = "static inline" if writer.storage else "static"
        target = replace(
            C99,
            types={},
            tuple_prefix="",
            definition=f"{keyword} {{returned}} {{name}}({{parameters}})\n{{{{",
            variable="{}_x",
            counted=(
                "for (int32_t {index} = {start}, {index}_end = {end};"
                " {index} {sign} {index}_end; {index} += {step}) {{"
            ),
            # Whole numbers are not negative where they are divided.
            operators={**C99.operators, (ast.FloorDiv, WHOLE): "({0} / {1})"},
            functions={
                **C99.functions, **extremes, **{(int, t): ("(int32_t){}", WHOLE) for t in Scalar},
            },
            truths=("false", "true"),
            real=_real,
            record="@of {type}@({parts})",
            uniform_record="@of {type}@({parts})",
            stretch="@part {kind}@({array}, {start}, {end})",
            call=self._call,
        )  # fmt: skip
        super().__init__(target)
        self._dispatchers: dict[tuple[Type, ...], str] = {}

    @staticmethod
    def _scalar(type_: Scalar) -> str:
        return {REAL: "double", TRUTH: "bool"}.get(type_, "int32_t")

    def name(self, name: str) -> str:
        """Return a name that the file does not have yet."""
        return self.writer.names.new(f"{self.writer.prefix}_{self.stem}_{name.strip('_')}")

    def type_name(self, type_: Type) -> str:
        """Return the name of a type, which is defined where it is met first."""
        if isinstance(type_, Array):
            return self.writer.definition(type_.value, _ARRAY, ELEMENT=_ELEMENTS[type_])
        if type_ is Nothing.NOTHING:
            return "void"
        if not isinstance(type_, TupleType):
            assert isinstance(type_, Scalar)
            return self._scalar(type_)
        parts = [self.type_name(part) for part in type_.parts]
        fields = [f"    {part} part_{index};\n" for index, part in enumerate(parts)]
        if type_.uniform:
            fields = [f"    {parts[0]} part[{len(parts)}];\n"]
        text = "".join(["typedef struct {\n", *fields, "} NAME;\n"])
        name = self.writer.definition("parts", text)
        self._tuples[type_.parts] = name
        return name

    # ── functions by number ──────────────────────────────────────────────────────────

    def _call(self, address: str, arrays: Sequence[TypedText]) -> str:
        """Return the call of what a number stands for, by a function that knows them all."""
        types = tuple(array.type for array in arrays)
        if types not in self._dispatchers:
            self._dispatchers[types] = self.name("call")
            listed = self.walk.functions.norms if len(types) == 4 else self.walk.functions.curves
            parameters = [f"{self.type_name(type_)} a_{i}" for i, type_ in enumerate(types)]
            passed = ", ".join(f"a_{i}" for i in range(len(types)))
            signature = ", ".join(["int32_t number", *parameters])
            head = f"{self._keyword} void {self._dispatchers[types]}({signature})"
            lines: list[str] = []
            for number, function in listed.items():
                callee = self.function(function, types)
                word = "} else if" if lines else "    if"
                lines.append(f"{'    ' if lines else ''}{word} (number == {number}) {{")
                lines.append(f"        {callee.name}({passed});")
            lines += ["    } else {", "        (void)number; /* there is no other */", "    }"]
            if not listed:
                lines = [f"    (void){name};" for name in ("number", *passed.split(", "))]
            text = "\n".join([head, "{", *lines, "}", ""])
            self._finished.append(WrittenFunction(text))  # type: ignore[arg-type]
        return f"{self._dispatchers[types]}({address}, {', '.join(a.text for a in arrays)})"

    # ── small helpers, written where they are used ───────────────────────────────────

    def finish(self) -> None:
        """Write the functions into the file, after the helpers that they use."""
        text = "\n".join(
            _by_the_rules(_without_unused(definition)) for definition in self._finished
        )
        text = re.sub(r"@(\w+) (\w+)@", self._helper, text)
        returning = {
            function.name
            for function in self._finished
            if getattr(function, "returned", Nothing.NOTHING) is not Nothing.NOTHING
        }
        text = _CALL.sub(lambda m: f"{m[1]}(void){m[2]}" if m[3] in returning else m[0], text)
        self.writer.helpers.append(text)

    def _helper(self, match: re.Match[str]) -> str:
        sort, what = match.groups()
        if sort == "part":
            name = self.type_name(Array(what))
            return self.writer.helper(f"part_of_{what}", _PART, TYPE=name)
        if sort == "of":
            (parts,) = (parts for parts, name in self._tuples.items() if name == what)
            return self._constructor(TupleType(parts), what)
        extreme = min if sort == "min" else max
        helper, sign = _SIGNS[extreme]
        return self.writer.helper(helper, ONE_OF_TWO, TYPE=what, SIGN=sign)

    def _constructor(self, type_: TupleType, name: str) -> str:
        kinds = [self.type_name(part) for part in type_.parts]
        signature = ", ".join(f"{kind} p_{i}" for i, kind in enumerate(kinds))
        parts = [f"part[{i}]" if type_.uniform else f"part_{i}" for i in range(len(kinds))]
        sets = [f"    found.{part} = p_{i};\n" for i, part in enumerate(parts)]
        text = (
            f"TYPE NAME({signature})\n{{\n    TYPE found;\n{''.join(sets)}    return found;\n}}\n"
        )
        return self.writer.helper(
            f"{name.removeprefix(self.writer.prefix).strip('_')}_of", text, TYPE=name
        )


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
