"""A project for a PLC, and the same as PLCopen XML (TC6, version 2.01), for import by IDEs.

Formats that import Structured Text keep its declarations apart from its statements. They all begin
with the `Project` of a ``.st`` and its test program. In XML declarations become elements;
statements stay as they are.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from xml.etree import ElementTree as Xml

import numpy as np

from fuzzyarm.exchange.export.c_files import TestSequence
from fuzzyarm.exchange.export.controllers import ControllerProgram
from fuzzyarm.exchange.export.document import xml_document
from fuzzyarm.exchange.export.numbers import ST_TYPES, Kind, st_literal, st_number
from fuzzyarm.exchange.export.routine import Routine
from fuzzyarm.exchange.export.structured_text import Declaration, Project, Unit, elements_text
from fuzzyarm.symbolic.identifiers import Names
from fuzzyarm.version import __version__

ELEMENTARY = frozenset({*ST_TYPES.values(), "BOOL"})
"""Types of the language; any other type is a function block of the project."""

TIME = "1980-01-01T00:00:00"
"""The time in the head of a file: the same source gives the same bytes."""


@dataclass(frozen=True)
class _BlockTest:
    """A block, with its expected results call by call."""

    block: str
    vectors: TestSequence
    kind: Kind
    may_skip: bool = False  # whether it has an output for a period that an axis skips


def with_test(project: Project, given: Sequence[Routine] | ControllerProgram) -> Project:
    """Return a project with its test program, the last unit."""
    if isinstance(given, ControllerProgram):
        vectors, kind = given.tried.vectors, given.steps.precision.outside
        trials = [_BlockTest(project.blocks[0], vectors, kind, may_skip=True)]
    else:
        pairs = zip(given, project.blocks, strict=True)
        trials = [_BlockTest(block, _sequence(routine), routine.kind) for routine, block in pairs]
    test = _test_program({unit.name: unit for unit in project.units}, project.name, trials)
    return replace(project, units=(*project.units, test))


def _sequence(routine: Routine) -> TestSequence:
    """Return the points of a routine's self-test that a PLC reads as they are."""
    vectors = routine.vectors()
    points = zip(*(column.tolist() for column in vectors.inputs), strict=True)
    rows = [
        (point, [value])
        for point, value in zip(points, vectors.expected.tolist(), strict=True)
        if not _has_subnormal(point, routine.kind)
    ]
    return TestSequence([row[0] for row in rows], [row[1] for row in rows], vectors.tolerance)


def _has_subnormal(point: Sequence[float], kind: Kind) -> bool:
    """Whether a number is below a PLC's smallest literal; most PLCs read it as zero."""
    if np.issubdtype(kind, np.integer):
        return False
    smallest = float(np.finfo(kind).tiny)
    return any(0.0 < abs(x) < smallest for x in point)


def _test_program(units: dict[str, Unit], prefix: str, trials: Sequence[_BlockTest]) -> Unit:
    """Return a program whose variable `passed` is TRUE after one cycle if all is well."""
    names = Names("st", set(units))
    declarations = [Declaration("passed", "BOOL"), Declaration("k", "DINT")]
    lines = ["passed := TRUE;"]
    for number, trial in enumerate(trials):
        given, expected = trial.vectors.inputs, trial.vectors.expected
        if not expected:
            continue
        unit = units[trial.block]
        inputs = unit.ports("VAR_INPUT")[: len(given[0])]
        drives = unit.ports("VAR_OUTPUT")[: len(expected[0])]
        # One flat array: row k has the inputs of call k, then the outputs expected of it.
        block, points = f"tested_{number}", f"points_{number}"
        width = len(inputs) + len(drives)
        rows = [x for pair in zip(given, expected, strict=True) for x in (*pair[0], *pair[1])]
        lost = [i for i, x in enumerate(rows) if math.isnan(x)]
        literals = [st_number(0.0 if math.isnan(x) else x, trial.kind) for x in rows]
        kind, start = ST_TYPES[trial.kind], elements_text(literals, width)
        declarations += [
            Declaration(block, trial.block), Declaration(points, kind, len(literals) - 1, start),
        ]  # fmt: skip
        arguments = ", ".join(
            f"{name} := {points}[k * {width} + {i}]" for i, name in enumerate(inputs)
        )
        if lost:  # no literal is NaN: the difference of two infinities is
            # Nor is a literal beyond a REAL one of every compiler (matiec): 1e30 is squared.
            infinite = f"infinite_{number}"
            large = st_number(1e30, trial.kind)
            declarations.append(Declaration(infinite, kind, start=large))
            lines += ["FOR k := 0 TO 3 DO", f"    {infinite} := {infinite} * {infinite};"]
            lines.append("END_FOR;")
            lines += [f"{points}[{i}] := {infinite} - {infinite};" for i in lost]
        lines.append(f"FOR k := 0 TO {len(expected) - 1} DO")
        lines.append(f"    {block}({arguments});")
        for i, name in enumerate(drives):
            place = f"{points}[k * {width} + {len(inputs) + i}]"
            condition = f"{block}.{name} <> {place}"
            # Fixed-point blocks have to agree exactly.
            if not np.issubdtype(trial.kind, np.integer):
                tolerance = st_literal(trial.vectors.tolerance, trial.kind)
                # Written as a positive condition: a comparison with NaN is false.
                condition = f"NOT (ABS({block}.{name} - {place}) <= {tolerance})"
            lines += [f"    IF {condition} THEN", "        passed := FALSE;", "    END_IF;"]
        read = [f"{points}[k * {width} + {i}]" for i in range(len(inputs))]
        numbers = " AND ".join(f"{place} = {place}" for place in read)
        for flag in unit.ports("VAR_OUTPUT")[len(drives) :]:
            # Of a rule base: whether one fires; of a controller: whether it skips the period.
            wrong = f"{block}.{flag} = ({numbers})" if trial.may_skip else f"NOT {block}.{flag}"
            lines += [f"    IF {wrong} THEN", "        passed := FALSE;", "    END_IF;"]
        lines.append("END_FOR;")
    name = names.new(f"{prefix}_test")
    head = "passed is TRUE after one cycle if the blocks agree with the model"
    statements = "".join(f"{line}\n" for line in lines)
    return Unit(head, "PROGRAM", name, "", {"VAR": declarations}, statements)


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
    """Return the text of a file."""
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
    for title, declarations in unit.sections.items():
        name, words = _LISTS[title]
        listed = Xml.SubElement(interface, _of(name), words)
        for declaration in declarations:
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
