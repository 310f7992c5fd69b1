"""A project for a PLC, and the same as PLCopen XML (TC6, version 2.01), for import by IDEs.

Formats that import Structured Text keep its declarations apart from its statements. They all begin
with a `Project`, the text of a ``.st`` read back with its test program, so that none needs a
printer. In XML declarations become elements; statements stay as they are.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from xml.etree import ElementTree as Xml

import numpy as np

from fuzzyarm.exchange.export.controllers import ControllerProgram
from fuzzyarm.exchange.export.document import xml_document
from fuzzyarm.exchange.export.numbers import ST_TYPES, Kind, st_literal, st_number
from fuzzyarm.exchange.export.routine import Routine, number_lines
from fuzzyarm.exchange.export.structured_text import controller_st, structured_text
from fuzzyarm.symbolic.identifiers import Names
from fuzzyarm.version import __version__

ELEMENTARY = frozenset({*ST_TYPES.values(), "BOOL"})
"""Types of the language; any other type is a function block of the project."""

TIME = "1980-01-01T00:00:00"
"""The time in the head of a file: the same source gives the same bytes."""

# These read the text of our own printer only; `_units` asserts that nothing is left over.
_UNIT = re.compile(
    r"(?:\(\*(?P<head>(?:(?!\*\)).)*)\*\)\n)?"
    r"(?P<sort>FUNCTION_BLOCK|FUNCTION|PROGRAM) (?P<name>\w+)(?: : (?P<type>\w+))?\n"
    r"(?P<body>.*?)^END_(?P=sort)$",
    re.DOTALL | re.MULTILINE,
)
_TYPE = re.compile(
    r"^TYPE\n    (?P<name>\w+) : ARRAY \[0\.\.(?P<last>\d+)\] OF (?P<type>\w+);\nEND_TYPE\n",
    re.MULTILINE,
)
_SECTION = re.compile(
    r"^(?P<title>VAR(?:_INPUT|_OUTPUT|_IN_OUT| CONSTANT| RETAIN|))\n(?P<lines>.*?)^END_VAR$\n?",
    re.DOTALL | re.MULTILINE,
)
_DECLARATION = re.compile(
    r"(?P<name>\w+) : (?:ARRAY \[0\.\.(?P<last>\d+)\] OF )?(?P<type>\w+)"
    r"(?: := (?P<start>\[.*?\]|[^;]*))?;(?: \(\* (?P<remark>.*?) \*\))?",
    re.DOTALL,
)


@dataclass(frozen=True)
class Declaration:
    """A variable: its type or that of its elements, the last index of an array, its initial value.

    `start` is the text of the number, or of all elements; `remark` mostly is a unit; `named` is the
    name of the type of an array that has one.
    """

    name: str
    type: str
    last: int | None
    start: str
    remark: str
    named: str = ""

    @property
    def elements(self) -> list[str]:
        """The numbers that an array starts with."""
        return [text.strip() for text in self.start.strip("[]").split(",")]


@dataclass(frozen=True)
class DeclarationSection:
    """Declarations under one title, as in ``VAR_INPUT``."""

    title: str
    declarations: tuple[Declaration, ...]


@dataclass(frozen=True)
class Unit:
    """A function, a function block or a program; `returned` is the type of a function."""

    head: str
    sort: str
    name: str
    returned: str
    sections: tuple[DeclarationSection, ...]
    statements: str

    def ports(self, title: str) -> list[str]:
        """Return the variables under a title."""
        return [
            declaration.name
            for section in self.sections
            if section.title == title
            for declaration in section.declarations
        ]


@dataclass(frozen=True)
class Project:
    """All units, callees first; the test program is the last one.

    `blocks` are the names of the blocks that a program calls, `types` the arrays whose types have
    names.
    """

    name: str
    units: tuple[Unit, ...]
    blocks: tuple[str, ...]
    types: tuple[Declaration, ...] = ()


@dataclass(frozen=True)
class _BlockTest:
    """A block, with its expected results call by call."""

    block: str
    inputs: Sequence[Sequence[float]]
    expected: Sequence[Sequence[float]]
    tolerance: float
    kind: Kind
    may_skip: bool = False  # whether it has an output for a period that an axis skips


def routines_project(routines: Sequence[Routine], prefix: str) -> Project:
    """Return a project with a function block for every routine."""
    text, blocks = structured_text(routines, prefix)
    trials = []
    for routine, block in zip(routines, blocks, strict=True):
        vectors = routine.vectors()
        points = zip(*(column.tolist() for column in vectors.inputs), strict=True)
        rows = [
            (point, [value])
            for point, value in zip(points, vectors.expected.tolist(), strict=True)
            if not _has_subnormal(point, routine.kind)
        ]
        inputs, expected = [row[0] for row in rows], [row[1] for row in rows]
        trials.append(_BlockTest(block, inputs, expected, vectors.tolerance, routine.kind))
    return _project(text, prefix, trials)


def controller_project(program: ControllerProgram, prefix: str) -> Project:
    """Return a project with a controller as a function block."""
    text, block = controller_st(program, prefix)
    vectors, kind = program.tried.vectors, program.steps.precision.outside
    trial = _BlockTest(
        block, vectors.inputs, vectors.expected, vectors.tolerance, kind, may_skip=True
    )
    return _project(text, prefix, [trial])


def _has_subnormal(point: Sequence[float], kind: Kind) -> bool:
    """Whether a number is below a PLC's smallest literal; most PLCs read it as zero."""
    if np.issubdtype(kind, np.integer):
        return False
    smallest = float(np.finfo(kind).tiny)
    return any(0.0 < abs(x) < smallest for x in point)


def _project(text: str, prefix: str, trials: Sequence[_BlockTest]) -> Project:
    types = {
        match["name"]: Declaration("", match["type"], int(match["last"]), "", "", match["name"])
        for match in _TYPE.finditer(text)
    }
    units = list(_units(_TYPE.sub("", text), types))
    test = _test_program({unit.name: unit for unit in units}, prefix, trials)
    blocks = tuple(trial.block for trial in trials)
    return Project(prefix, (*units, *_units(test, types)), blocks, tuple(types.values()))


def _units(text: str, types: Mapping[str, Declaration]) -> Iterator[Unit]:
    """Yield the units of a text, and be sure that nothing lies between them."""
    end = 0
    for match in _UNIT.finditer(text):
        assert not text[end : match.start()].strip(), text[end : match.start()]
        end = match.end()
        yield _unit(match, types)
    assert not text[end:].strip(), text[end:]


def _unit(match: re.Match[str], types: Mapping[str, Declaration]) -> Unit:
    sections, last = [], 0
    for section in _SECTION.finditer(match["body"]):
        last = section.end()
        declarations = tuple(
            _declaration(declaration, types)
            for declaration in _DECLARATION.finditer(section["lines"])
        )
        sections.append(DeclarationSection(section["title"], declarations))
    lines = (match["head"] or "").strip("\n").split("\n")
    head = "\n".join(re.sub(r"^ \* ?", "", line) for line in lines).strip()
    statements = match["body"][last:].strip("\n") + "\n"
    return Unit(
        head, match["sort"], match["name"], match["type"] or "", tuple(sections), statements
    )


def _declaration(match: re.Match[str], types: Mapping[str, Declaration]) -> Declaration:
    last = None if match["last"] is None else int(match["last"])
    plain = Declaration(match["name"], match["type"], last, "", match["remark"] or "")
    array = types.get(plain.type, plain)
    start = (match["start"] or "").strip()
    return replace(plain, type=array.type, last=array.last, start=start, named=array.named)


def _test_program(units: dict[str, Unit], prefix: str, trials: Sequence[_BlockTest]) -> str:
    """Return a program whose variable `passed` is TRUE after one cycle if all is well."""
    names = Names("st", set(units))
    declarations, lines = ["    passed : BOOL;", "    k : DINT;"], ["passed := TRUE;"]
    for number, trial in enumerate(trials):
        if not trial.expected:
            continue
        unit = units[trial.block]
        inputs = unit.ports("VAR_INPUT")[: len(trial.inputs[0])]
        drives = unit.ports("VAR_OUTPUT")[: len(trial.expected[0])]
        # One flat array: row k has the inputs of call k, then the outputs expected of it.
        block, points = f"tested_{number}", f"points_{number}"
        width = len(inputs) + len(drives)
        rows = [
            x
            for pair in zip(trial.inputs, trial.expected, strict=True)
            for x in (*pair[0], *pair[1])
        ]
        lost = [i for i, x in enumerate(rows) if math.isnan(x)]
        literals = [st_number(0.0 if math.isnan(x) else x, trial.kind) for x in rows]
        body = "\n".join(number_lines(literals, width, indent="        "))
        of = f"ARRAY [0..{len(literals) - 1}] OF {ST_TYPES[trial.kind]}"
        declarations += [
            f"    {block} : {trial.block};",
            f"    {points} : {of} := [\n{body}\n    ];",
        ]
        arguments = ", ".join(
            f"{name} := {points}[k * {width} + {i}]" for i, name in enumerate(inputs)
        )
        if lost:  # no literal is NaN: the difference of two infinities is
            # Nor is a literal beyond a REAL one of every compiler (matiec): 1e30 is squared.
            infinite = f"infinite_{number}"
            large = st_number(1e30, trial.kind)
            declarations.append(f"    {infinite} : {ST_TYPES[trial.kind]} := {large};")
            lines += ["FOR k := 0 TO 3 DO", f"    {infinite} := {infinite} * {infinite};"]
            lines.append("END_FOR;")
            lines += [f"{points}[{i}] := {infinite} - {infinite};" for i in lost]
        lines.append(f"FOR k := 0 TO {len(trial.expected) - 1} DO")
        lines.append(f"    {block}({arguments});")
        for i, name in enumerate(drives):
            place = f"{points}[k * {width} + {len(inputs) + i}]"
            condition = f"{block}.{name} <> {place}"
            # Fixed-point blocks have to agree exactly.
            if not np.issubdtype(trial.kind, np.integer):
                tolerance = st_literal(trial.tolerance, trial.kind)
                # Written as a positive condition: a comparison with NaN is false.
                condition = f"NOT (ABS({block}.{name} - {place}) <= {tolerance})"
            lines += [f"    IF {condition} THEN", "        passed := FALSE;", "    END_IF;"]
        given = [f"{points}[k * {width} + {i}]" for i in range(len(inputs))]
        numbers = " AND ".join(f"{place} = {place}" for place in given)
        for flag in unit.ports("VAR_OUTPUT")[len(drives) :]:
            # Of a rule base: whether one fires; of a controller: whether it skips the period.
            wrong = f"{block}.{flag} = ({numbers})" if trial.may_skip else f"NOT {block}.{flag}"
            lines += [f"    IF {wrong} THEN", "        passed := FALSE;", "    END_IF;"]
        lines.append("END_FOR;")
    name = names.new(f"{prefix}_test")
    head = "(* passed is TRUE after one cycle if the blocks agree with the model *)"
    return "\n".join(
        [head, f"PROGRAM {name}", "VAR", *declarations, "END_VAR", "", *lines, "END_PROGRAM", ""]
    )


_SPACE = "http://www.plcopen.org/xml/tc6_0201"
_TEXT = "http://www.w3.org/1999/xhtml"

_SORTS = {"FUNCTION": "function", "FUNCTION_BLOCK": "functionBlock", "PROGRAM": "program"}
_LISTS: dict[str, tuple[str, dict[str, str]]] = {
    "VAR_INPUT": ("inputVars", {}),
    "VAR_OUTPUT": ("outputVars", {}),
    "VAR_IN_OUT": ("inOutVars", {}),
    "VAR CONSTANT": ("localVars", {"constant": "true"}),
    "VAR RETAIN": ("localVars", {"retain": "true"}),
    "VAR": ("localVars", {}),
}


def plcopen_xml(project: Project) -> str:
    """Return the text of a file.

    Parameters
    ----------
    project : Project
        Units of Structured Text.
    """
    Xml.register_namespace("", _SPACE)
    Xml.register_namespace("xhtml", _TEXT)
    root = Xml.Element(_of("project"))
    Xml.SubElement(
        root,
        _of("fileHeader"),
        {
            "companyName": "",
            "productName": "fuzzyarm",
            "productVersion": __version__,
            "creationDateTime": TIME,
        },
    )
    content = Xml.SubElement(root, _of("contentHeader"), {"name": project.name})
    coordinates = Xml.SubElement(content, _of("coordinateInfo"))
    for language in ("fbd", "ld", "sfc"):
        kind = Xml.SubElement(coordinates, _of(language))
        Xml.SubElement(kind, _of("scaling"), {"x": "1", "y": "1"})
    types = Xml.SubElement(root, _of("types"))
    listed = Xml.SubElement(types, _of("dataTypes"))
    for array in project.types:
        defined = Xml.SubElement(listed, _of("dataType"), {"name": array.named})
        _array(Xml.SubElement(defined, _of("baseType")), array)
    pous = Xml.SubElement(types, _of("pous"))
    for unit in project.units:
        pous.append(_pou(unit))
    instances = Xml.SubElement(root, _of("instances"))
    Xml.SubElement(instances, _of("configurations"))
    _indent(root)
    return xml_document(root)


def _pou(unit: Unit) -> Xml.Element:
    words = {"name": unit.name, "pouType": _SORTS[unit.sort]}
    pou = Xml.Element(_of("pou"), words)
    interface = Xml.SubElement(pou, _of("interface"))
    if unit.returned:
        returned = Xml.SubElement(interface, _of("returnType"))
        returned.append(_type(unit.returned))
    for section in unit.sections:
        name, words = _LISTS[section.title]
        listed = Xml.SubElement(interface, _of(name), words)
        for declaration in section.declarations:
            listed.append(_variable(declaration))
    body = Xml.SubElement(Xml.SubElement(pou, _of("body")), _of("ST"))
    Xml.SubElement(body, f"{{{_TEXT}}}p").text = unit.statements
    if unit.head:
        remark = Xml.SubElement(pou, _of("documentation"))
        Xml.SubElement(remark, f"{{{_TEXT}}}p").text = unit.head
    return pou


def _variable(declaration: Declaration) -> Xml.Element:
    variable = Xml.Element(_of("variable"), {"name": declaration.name})
    kind = Xml.SubElement(variable, _of("type"))
    if declaration.named or declaration.last is None:
        kind.append(_type(declaration.named or declaration.type))
    else:
        _array(kind, declaration)
    if declaration.start:
        start = Xml.SubElement(variable, _of("initialValue"))
        if declaration.last is None:
            Xml.SubElement(start, _of("simpleValue"), {"value": declaration.start})
        else:
            values = Xml.SubElement(start, _of("arrayValue"))
            for value in declaration.elements:
                cell = Xml.SubElement(values, _of("value"))
                Xml.SubElement(cell, _of("simpleValue"), {"value": value})
    return variable


def _array(parent: Xml.Element, declaration: Declaration) -> None:
    array = Xml.SubElement(parent, _of("array"))
    Xml.SubElement(array, _of("dimension"), {"lower": "0", "upper": str(declaration.last)})
    Xml.SubElement(array, _of("baseType")).append(_type(declaration.type))


def _type(name: str) -> Xml.Element:
    """Return an elementary type, or the block of an instance."""
    if name in ELEMENTARY:
        return Xml.Element(_of(name))
    return Xml.Element(_of("derived"), {"name": name})


def _of(name: str) -> str:
    return f"{{{_SPACE}}}{name}"


def _indent(root: Xml.Element) -> None:
    """Put elements on their own lines, except for texts, which stay as they are."""
    texts = {element: element.text for element in root.iter(f"{{{_TEXT}}}p")}
    Xml.indent(root)
    for element, text in texts.items():
        element.text = text
