"""Programs as C99; :mod:`.c_files` makes files of them.

A rule base and a table are a function each. A controller is a struct with its memory, ``init`` and
``step``; with learning tables also ``save`` and ``load``. Constants may stay in a flash with a
separate address space (`flash_macro`).
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from fuzzyarm.exchange.export.controller_lowering import LEFT
from fuzzyarm.exchange.export.guard import (
    GUARDED_STEP,
    LEFT_REGION,
    SENT,
    step_name,
)
from fuzzyarm.exchange.export.numbers import C_TYPES, Kind, c_number
from fuzzyarm.exchange.export.printer import FunctionPrinter, Printer, Target, start_text
from fuzzyarm.exchange.export.routine import (
    number_lines,
    plain,
)
from fuzzyarm.exchange.export.steps import Steps, StepVariable
from fuzzyarm.exchange.export.typed_program import (
    COUNT,
    INDEX,
    NOTHING,
    OFFSET,
    TRUTH,
    Function,
    Member,
    Program,
    Return,
    Stepped,
)
from fuzzyarm.symbolic.identifiers import ARDUINO_MACROS, Names
from fuzzyarm.symbolic.operations import Operation
from fuzzyarm.symbolic.printing import c_language

LIBRARY = "library"
"""A form beside ``.h`` and ``.c``: three files, whose constants stay in flash."""

_TYPES = {
    **C_TYPES,
    COUNT: "unsigned long",
    INDEX: "unsigned",
    TRUTH: "bool",
    OFFSET: "int",
    NOTHING: "void",
}
_MARKS = {COUNT: "UL", INDEX: "u"}
_LONG = {**_TYPES, INDEX: "unsigned long"}, {**_MARKS, INDEX: "UL"}
"""Types and marks of a file with an array of more elements than 16 bits count."""

_EXTREMES = {"minimum": ("least", "<"), "maximum": ("greatest", ">")}

PORTS = {"reference": "reference", "measured": "measured", "drive": "drives"}
"""The types of the arguments of a step that hold ports, by their sort."""


# ── spellings ────────────────────────────────────────────────────────────────────────


def _operation(printer: Printer, operation: Operation, kind: Kind) -> str:
    if operation.name not in _EXTREMES:
        return c_language(C_TYPES[kind]).text(operation)
    (stem, sign), real = _EXTREMES[operation.name], C_TYPES[kind]
    name = printer.known[stem, kind]
    text = (
        f"{printer.target.hidden}{real} {name}({real} a, {real} b)\n{{\n"
        f"    return (b {sign} a) ? b : a; /* the first of equal ones */\n}}\n"
    )
    return f"{printer.helper(name, text)}({{0}}, {{1}})"


def _number(_printer: Printer, value: float, kind: Kind) -> str:
    if math.isfinite(value):
        return c_number(value, kind)
    name = "NAN" if math.isnan(value) else "INFINITY"
    sign = "-" if value < 0.0 else ""
    return f"{sign}{name}" if kind is np.float32 else f"{sign}({C_TYPES[kind]}){name}"


def _array(printer: Printer, name: str, kind: Kind, values: Sequence[float], columns: int) -> str:
    texts = [_number(printer, x, kind) for x in values]
    assert isinstance(printer, CPrinter)
    head = f"static const {printer.in_flash}{printer.target.types[kind]} {name}[{len(texts)}] = {{"
    return "\n".join([head, *number_lines(texts, columns), "};", ""])


def _cast(text: str, before: Kind, after: Kind) -> str:
    # An index may have any integer type, and a short one is promoted.
    plain = before is after or (before, after) in {(OFFSET, INDEX), (np.int16, OFFSET)}
    return text if plain else f"({_TYPES[after]}){text}"


_TARGET = Target(
    language=c_language()._replace(
        declare="const {type} {name} = {value};", declare_only="{type} {name};"
    ),
    names="c", operation=_operation, number=_number, array=_array, cast=_cast, cast_binds=9,
    types=_TYPES, marks=_MARKS, again="{type} {name} = {value};",
    member="s->{}", quotient="({} / {})", parameter="{type} {name}",
    array_argument="const {}*", view="const {type} *const {name} = &{array}[{position}];",
    hidden="static ", unused="(void){};",
    function=("{public}{type} {name}({parameters})\n{{", "}\n"), remark="/* {} */",
    repeat="for ({type} {index} = 0u; {index} < {count}; {index}++) {{",
    scratch="double {name}[{count}];", written="{}*",
    count="for ({type} {index} = {start}; {index} {sign} {end}; {index} {way}= {step}) {{",
    whole_tuple="const double *const {name} = {value};",
)  # fmt: skip


# ── a program in C ───────────────────────────────────────────────────────────────────


class CPrinter(Printer):
    """The parts of a C file.

    Attributes
    ----------
    places : dict of str to str
        Expressions of ports and the state in the step, by symbol.
    flash, largest : int
        Bytes of constants, and of the largest array of them.
    in_flash : str
        Qualifier of types in flash.
    fallback : mapping of str to float or None, or None
        Of a guarded controller, by symbol of a drive: its value after a refused state, None for the
        last one.
    """

    in_flash = ""
    fallback: Mapping[str, float | None] | None = None

    def __init__(
        self, program: Program, prefix: str, form: str, steps: Steps | None = None
    ) -> None:
        self.prefix, self.form, self.steps = prefix, form, steps
        self.flash = self.largest = 0
        alone = form == ".h"
        target = replace(_TARGET, hidden="static inline ", public="static inline ") if alone else (
            _TARGET)  # fmt: skip
        if form == LIBRARY:
            self.in_flash = f"{prefix.upper()}_IN_FLASH "
            argument, view = (
                text.replace("const ", f"const {self.in_flash}", 1)
                for text in (target.array_argument, target.view)
            )
            target = replace(target, refused=ARDUINO_MACROS, array_argument=argument, view=view)
        sizes = [len(array.values) for array in program.arrays.values()]
        if max(sizes, default=0) > 0xFFFF:
            target = replace(target, types=_LONG[0], marks=_LONG[1])
        super().__init__(program, target)

    def reserve(self) -> None:
        """Reserve the names of the frame and of helpers."""
        self.types: list[str] = []
        self.places: dict[str, str] = {}
        for word in _FRAME if self.steps is not None else ():
            self.free(word)
        for word in _GUARDED if self.program.guard is not None else ():
            self.free(word)
        self.self_test = self.free("self_test") if self.form == LIBRARY else ""
        functions = [*self.program.functions.values(), self.program.step]
        for kind in dict.fromkeys(each.real for each in functions if each is not None):
            for stem, _ in _EXTREMES.values():
                self.known[stem, kind] = self.free(stem)

    def free(self, stem: str) -> str:
        """Return a name that nothing in the file has yet."""
        return self.names.new(f"{self.prefix}_{stem}")

    def public(self, stem: str) -> str:
        """Return a name for others."""
        return self.free(stem)

    def constant(self, stem: str, kind: Kind, values: Sequence[float], columns: int = 0) -> str:
        """Define an array of constants; return its name."""
        size = np.dtype(kind).itemsize * len(values)
        self.flash, self.largest = self.flash + size, max(self.largest, size)
        return super().constant(stem, kind, values, columns)

    def scope(self) -> Names:
        """Return the names of the members of a type."""
        return Names("c", refused=self.target.refused)

    def name_state(self) -> None:
        """Define the types of a controller."""
        if self.steps is not None:
            _Types(self, self.steps).define()
            self.arrays |= {key: self.places[key] for key, member in self.program.state.items()
                            if isinstance(member.start, tuple)}  # fmt: skip
            self.members = {key: self.places[key] for key in self.program.state}

    def function_printer(self, function: Function, declared: Iterable[str] = ()) -> FunctionPrinter:
        """Return the printer of a function."""
        return _CFunction(self, function, declared=declared)

    # ── the functions of a controller ────────────────────────────────────────────────

    def prototypes(self) -> tuple[str, ...]:
        """Return the functions that others call."""
        if self.steps is None:
            return tuple(
                text.partition("\n")[0].removeprefix(self.target.public)
                for key, text in zip(self.program.functions, self.functions, strict=True)
                if self.program.functions[key].public
            )
        return tuple(self._prototypes(self.steps).values())

    def _prototypes(self, steps: Steps) -> dict[str, str]:
        p = self.prefix
        ports = [
            f"{'' if sort == 'drive' else 'const '}{p}_{PORTS[sort]} *{sort}"
            for sort in steps.port_sorts
        ]
        signatures = {
            "init": f"void {p}_init({p}_state *s)",
            "step": f"void {p}_step({', '.join([f'{p}_state *s', *ports])})",
        }
        if self.program.guard is not None:
            given = [f"{p}_state *s", *(x for x in ports if x.startswith("const"))]
            signatures |= {
                "left": f"bool {p}_left({', '.join(given)})",
                "guarded": f"void {p}_{GUARDED_STEP}({', '.join([f'{p}_state *s', *ports])})",
            }
        if steps.learned:
            kind = C_TYPES[steps.precision.outside]
            signatures |= {
                "save": f"void {p}_save(const {p}_state *s, {kind} *values, unsigned long *visits)",
                "load": f"void {p}_load({p}_state *s, const {kind} *values,"
                " const unsigned long *visits)",
            }
        return signatures

    def code(self) -> str:
        """Return constants, helpers and functions."""
        functions = []
        if self.steps is not None:
            step = self.program.step
            assert step is not None
            bodies = {
                "init": list(self._init()),
                "step": _CFunction(self, step).lines(step.body),
                "left": list(self._left()),
                "guarded": list(self._guarded(self.steps)),
                "save": list(self._copied(self.steps, saved=True)),
                "load": list(self._copied(self.steps, saved=False)),
            }
            for part, prototype in self._prototypes(self.steps).items():
                body = bodies[part]
                if not any(re.search(r"\bs\b", line) for line in body):  # a constant drive
                    body = ["(void)s;", *body]
                lines = [f"    {line}" for line in body]
                functions.append(
                    "\n".join([f"{self.target.public}{prototype}", "{", *lines, "}", ""])
                )
        return _assembled(self.constants, [*self.helpers, *self.functions, *functions])

    def _init(self) -> Iterator[str]:
        for key, member in self.program.state.items():
            place = self.places[key]
            if not isinstance(member.start, tuple):
                yield f"{place} = {start_text(self, member)};"
                continue
            start = start_text(self, replace(member, start=member.start[0]))
            if len(set(member.start)) > 1:
                start = f"{self.constant(f'{member.name}_start', member.kind, member.start)}[k]"
            yield from self._for_all(len(member.start), [f"{place}[k] = {start};"])

    def _left(self) -> Iterator[str]:
        """Yield the statements of the test of a guard."""
        guard = self.program.guard
        if guard is not None:
            yield from _CFunction(self, guard).lines(guard.body)
            yield f"return {self.places[LEFT_REGION]};"

    def _guarded(self, steps: Steps) -> Iterator[str]:
        """Yield the statements of a guarded step: the fallback, or the step."""
        if self.fallback is None:
            return
        p, sorts = self.prefix, steps.port_sorts
        tested = [sort for sort in sorts if sort != "drive"]
        yield f"if ({p}_left({', '.join(['s', *tested])})) {{"
        sent = {drive: self.places.get(f"{SENT} {drive}") for drive in self.fallback}
        for drive, value in self.fallback.items():
            text = sent[drive] or _number(self, value or 0.0, steps.precision.outside)
            yield f"    {self.places[drive]} = {text};"
        yield from ["} else {", f"    {p}_step({', '.join(['s', *sorts])});"]
        yield from (f"    {place} = {self.places[x]};" for x, place in sent.items() if place)
        yield "}"

    def _for_all(self, count: int, lines: Sequence[str]) -> list[str]:
        opening = self.target.repeat.format(
            type=self.target.types[INDEX], index="k", count=f"{count}{self.target.marks[INDEX]}"
        )
        return [opening, *(f"    {line}" for line in lines), "}"]

    def _copied(self, steps: Steps, *, saved: bool) -> Iterator[str]:
        """Yield the statements that copy tables and visits out, or in."""
        first, mark = 0, self.target.marks[INDEX]
        for key, table in steps.learned.items():
            outer = f"k + {first}{mark}" if first else "k"
            for name, place in (("values", key), ("visits", f"{key} visits")):
                inside, outside = f"{self.places[place]}[k]", f"{name}[{outer}]"
                pair = (outside, inside) if saved else (inside, outside)
                lines = self._for_all(len(table.values), [f"{pair[0]} = {pair[1]};"])
                if name == "visits":
                    lines = [f"if ({name} != NULL) {{", *(f"    {line}" for line in lines), "}"]
                yield from lines
            first += len(table.values)

    # ── the self-test ────────────────────────────────────────────────────────────────

    def test(self, prototype: str) -> list[str]:
        """Return the function that tests the file, with its constants."""
        before, flash = len(self.constants), (self.flash, self.largest)
        lines = []
        if self.steps is not None and self.program.tests:
            lines = [
                f"static {self.prefix}_state s;",
                *(f"{self.prefix}_{PORTS[sort]} {sort};" for sort in self.steps.port_sorts),
            ]
        for each in self.program.tests:
            lines += [f"{self.prefix}_init(&s);"] * (self.steps is not None)
            lines += self.test_lines(each, "test")
        tested = "steps" if self.steps is not None else "functions"
        constants = self.constants[before:]
        del self.constants[before:]
        self.flash, self.largest = flash
        return [
            f"/* Returns 0 if the {tested} agree with the model. */", prototype, "{",
            *(f"    {line}" for text in constants for line in text.rstrip("\n").split("\n")),
            "    bool failed = false;", *(f"    {line}" for line in lines),
            "    return failed ? 1 : 0;", "}", "",
        ]  # fmt: skip

    def ram(self) -> int:
        """Return the approximate size of the state in bytes."""
        return sum(map(_size, self.program.state.values()))


_GUARDED = ("left", GUARDED_STEP)

_FRAME = (
    "state", "gains", "reference", "measured", "drives", "init", "step", "save", "load",
)  # fmt: skip


def _size(member: Member) -> int:
    size = {INDEX: 4, TRUTH: 1}.get(member.kind, np.dtype(member.kind).itemsize)
    return size * (len(member.start) if isinstance(member.start, tuple) else 1)


_CONSTANT = re.compile(r"static const [^=]*?(\w+)\[")
"""How the text of a constant begins, with its name."""


def _assembled(constants: Sequence[str], functions: Sequence[str]) -> str:
    """Return constants and functions; constants of a single function are local to it."""
    texts, shared = list(functions), []
    for constant in constants:
        name = _CONSTANT.match(constant)[1]  # type: ignore[index]
        users = [i for i, text in enumerate(texts) if re.search(rf"\b{name}\b", text)]
        if len(users) != 1 or texts[users[0]].count("\n{\n") != 1:
            shared.append(constant)
            continue
        head, brace, body = texts[users[0]].partition("\n{\n")
        inside = "".join(f"    {line}\n" for line in constant.rstrip("\n").split("\n"))
        texts[users[0]] = f"{head}{brace}{inside}{body}"
    return "\n".join([*shared, *texts])


class _CFunction(FunctionPrinter):
    """A function of a C file; the ports and the state of a step are members."""

    printer: CPrinter

    def name_variables(self) -> None:
        """Name parameters and local variables."""
        program = self.printer.program
        if self.function in (program.step, program.guard):
            self.rename |= self.printer.places
            self.declared |= self.printer.places.keys()
            self.names.take(["s", *PORTS])
        super().name_variables()

    def parameter_texts(self) -> list[str]:
        """Return the parameters."""
        return [text.replace("* ", " *") for text in super().parameter_texts()]

    def _returned(self, line: Return) -> list[str]:
        """Return from a function; the drives of a step are members."""
        return [] if self.function is self.printer.program.step else super()._returned(line)

    def _stepped(self, line: Stepped) -> list[str]:
        """Run a period of the tested controller."""
        steps, prefix = self.printer.steps, self.printer.prefix
        assert steps is not None
        variables = [v for sort in ("reference", "measured") for v in steps.of_sort(sort)]
        given = zip(variables, map(self.language.expression, line.arguments), strict=True)
        passed = ", ".join(["&s", *(f"&{sort}" for sort in steps.port_sorts)])
        found = zip(line.targets, steps.of_sort("drive"), strict=True)
        return [
            *(f"{self._port(variable)} = {text};" for variable, text in given),
            f"{prefix}_{step_name(guarded=line.guarded)}({passed});",
            *(self._set(target, self._port(drive), "") for target, drive in found),
        ]

    def _port(self, variable: StepVariable) -> str:
        return of_struct(self.printer.places[variable.symbol])


def of_struct(place: str) -> str:
    """Return a member of a struct at hand, by how the step reads it."""
    return place.replace("s->", "state.", 1) if place.startswith("s->") else (
        place.replace("->", ".", 1))  # fmt: skip


# ── the types of a controller ────────────────────────────────────────────────────────


class _Entry(NamedTuple):
    """A member of a struct; `size` is empty of a number, or its brackets."""

    key: str
    axis: str
    stem: str
    kind: str
    size: str = ""
    remark: str = ""


class _Types:
    """The structs of a controller: ports, gains and states, axis by axis."""

    def __init__(self, printer: CPrinter, steps: Steps) -> None:
        self.printer, self.steps, self.prefix = printer, steps, printer.prefix
        self.outer = C_TYPES[steps.precision.outside]
        self.room = printer.scope()
        self.room.take(["gains", "until_set_point"])
        axes = steps.model.axis_names
        several = len(axes) > 1
        self.paths = {axis: f"{self.room.new(axis)}." if several else "" for axis in axes}

    def define(self) -> None:
        """Add all types and places to the printer."""
        axes = [axis for axis, path in self.paths.items() if path]
        for sort, word in PORTS.items():
            entries = [
                _Entry(v.symbol, v.axis, v.name, self.outer) for v in self.steps.of_sort(sort)
            ]
            if entries:
                names = {axis: self.printer.scope() for axis in self.paths}
                self._struct(word, entries, f"{sort}->", names)
        first = self._gains()
        names = {axis: self.printer.scope() if axes else self.room for axis in self.paths}
        entries = []
        for key, member in self.printer.program.state.items():
            if key == LEFT:
                self.printer.places[key] = "s->until_set_point"
                kind = self.printer.target.types[INDEX]
                remark = "periods to the next one, this included"
                first.append(f"    {kind} until_set_point; /* {remark} */")
            elif key == LEFT_REGION:
                name = self.room.new(member.name)
                self.printer.places[key] = f"s->{name}"
                kind = self.printer.target.types[TRUTH]
                first.append(f"    {kind} {name}; /* {member.remark} */")
            elif member.role != "gain":
                size = f"[{len(member.start)}]" if isinstance(member.start, tuple) else ""
                kind = self.printer.target.types[member.kind]
                entries.append(_Entry(key, member.axis, member.name, kind, size, member.remark))
        self._struct("state", entries, "s->", names, first)

    def _gains(self) -> list[str]:
        """Define the gains; return their member of the state."""
        names, entries, count = self.printer.scope(), [], len(self.paths)
        for gain in self.steps.of_sort("gain"):
            if gain.number <= 0:
                member = names.new(gain.name)
                size = f"[{count}]" if gain.number == 0 else ""
                remark = self.printer.program.state[gain.symbol].remark
                entries.append(_declared(_Entry("", "", "", self.outer, size, remark), member))
            index = f"[{gain.number}]" if gain.number >= 0 else ""
            self.printer.places[gain.symbol] = f"s->gains.{member}{index}"
        if not entries:
            return []
        self._typedef("gains", entries)
        remark = "init sets them; change them at will"
        return [f"    {self.prefix}_gains gains; /* {remark} */"]

    def _struct(
        self, word: str, entries: Sequence[_Entry], pointer: str, names: Mapping[str, Names],
        first: Sequence[str] = (),
    ) -> None:  # fmt: skip
        lines: dict[str, list[str]] = {axis: [] for axis in self.paths}
        for entry in entries:
            member = names[entry.axis].new(entry.stem)
            self.printer.places[entry.key] = f"{pointer}{self.paths[entry.axis]}{member}"
            lines[entry.axis].append(_declared(entry, member))
        members = list(first)
        for axis, of_axis in lines.items():
            path = self.paths[axis].removesuffix(".")
            if of_axis and path:
                tag = self.printer.free(f"{word}_{path}")
                members += [
                    f"    struct {tag} {{",
                    *(f"    {x}" for x in of_axis),
                    f"    }} {path};",
                ]
            else:
                members += of_axis
        self._typedef(word, members or ["    char nothing; /* C wants a member */"])

    def _typedef(self, word: str, members: Sequence[str]) -> None:
        name = f"{self.prefix}_{word}"
        lines = [f"typedef struct {{ /* {name} */", *members, f"}} {name};", ""]
        self.printer.types.append("\n".join(lines))


def _declared(entry: _Entry, name: str) -> str:
    remark = f" /* {plain(entry.remark)} */" if entry.remark else ""
    return f"    {entry.kind} {name}{entry.size};{remark}"
