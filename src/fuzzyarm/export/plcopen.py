"""Structured Text as PLCopen XML (TC6, version 2.01), which IDEs for PLCs import.

The text is that of a ``.st``: its declarations become elements, its statements stay as they are. A
program beside the blocks runs the self-test.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from xml.etree import ElementTree as Xml

import numpy as np

from fuzzyarm.export.controller_st import controller_st
from fuzzyarm.export.controllers import ControllerProgram
from fuzzyarm.export.names import Names
from fuzzyarm.export.numbers import ST_TYPES, Kind, st_number
from fuzzyarm.export.routine import Routine, number_lines
from fuzzyarm.export.structured_text import structured_text
from fuzzyarm.version import __version__

__all__ = ["controller_xml", "routines_xml"]

_SPACE = "http://www.plcopen.org/xml/tc6_0201"
_TEXT = "http://www.w3.org/1999/xhtml"

_TIME = "1980-01-01T00:00:00"
"""The time in the head of a file: the same source gives the same bytes."""

_UNIT = re.compile(
    r"(?:\(\*(?P<head>(?:(?!\*\)).)*)\*\)\n)?"
    r"(?P<sort>FUNCTION_BLOCK|FUNCTION|PROGRAM) (?P<name>\w+)(?: : (?P<type>\w+))?\n"
    r"(?P<body>.*?)^END_(?P=sort)$",
    re.DOTALL | re.MULTILINE,
)
_SECTION = re.compile(
    r"^VAR(?P<title>_INPUT|_OUTPUT|_IN_OUT| CONSTANT| RETAIN|)\n(?P<lines>.*?)^END_VAR$\n?",
    re.DOTALL | re.MULTILINE,
)
_DECLARATION = re.compile(
    r"(?P<name>\w+) : (?:ARRAY \[0\.\.(?P<last>\d+)\] OF )?(?P<type>\w+)"
    r"(?: := (?P<start>\[.*?\]|[^;]*))?;",
    re.DOTALL,
)

_SORTS = {"FUNCTION": "function", "FUNCTION_BLOCK": "functionBlock", "PROGRAM": "program"}
_LISTS: dict[str, tuple[str, dict[str, str]]] = {
    "_INPUT": ("inputVars", {}),
    "_OUTPUT": ("outputVars", {}),
    "_IN_OUT": ("inOutVars", {}),
    " CONSTANT": ("localVars", {"constant": "true"}),
    " RETAIN": ("localVars", {"retain": "true"}),
    "": ("localVars", {}),
}
_ELEMENTARY = {*ST_TYPES.values(), "BOOL"}


@dataclass(frozen=True)
class _Trial:
    """A block, and what it has to give, call by call."""

    block: str
    given: Sequence[Sequence[float]]
    expected: Sequence[Sequence[float]]
    tolerance: float
    kind: Kind


def routines_xml(routines: Sequence[Routine], prefix: str) -> tuple[str, list[str]]:
    """Return a project with a function block for every routine, and the names of the blocks.

    Raises
    ------
    ExportError
        As for Structured Text.
    """
    text, blocks = structured_text(routines, prefix)
    trials = []
    for routine, block in zip(routines, blocks, strict=True):
        vectors = routine.vectors()
        given = list(zip(*(column.tolist() for column in vectors.inputs), strict=True))
        expected = [[x] for x in vectors.expected.tolist()]
        trials.append(_Trial(block, given, expected, vectors.tolerance, routine.kind))
    return _project(text, prefix, trials), blocks


def controller_xml(program: ControllerProgram, prefix: str) -> tuple[str, str]:
    """Return a project with a controller as a function block, and the name of the block.

    Raises
    ------
    ExportError
        As for Structured Text.
    """
    text, block = controller_st(program, prefix)
    vectors, kind = program.tried.vectors, program.steps.precision.outside
    trial = _Trial(block, vectors.given, vectors.expected, vectors.tolerance, kind)
    return _project(text, prefix, [trial]), block


# --- The program that tests ---


def _test_program(text: str, prefix: str, trials: Sequence[_Trial]) -> str:
    """Return a program whose variable `passed` is TRUE after one cycle if all is well."""
    units = {unit["name"]: unit for unit in _UNIT.finditer(text)}
    names = Names("st", set(units))
    declared, lines = ["    passed : BOOL;", "    k : DINT;"], ["passed := TRUE;"]
    for number, trial in enumerate(trials):
        if not trial.expected:
            continue
        ports = {"_INPUT": [], "_OUTPUT": []}  # type: dict[str, list[str]]
        for section in _SECTION.finditer(units[trial.block]["body"]):
            if section["title"] in ports:
                ports[section["title"]] += [
                    each["name"] for each in _DECLARATION.finditer(section["lines"])
                ]
        given = ports["_INPUT"][: len(trial.given[0])]
        drives = ports["_OUTPUT"][: len(trial.expected[0])]
        block, points = f"tested_{number}", f"points_{number}"
        width = len(given) + len(drives)
        rows = [
            x
            for pair in zip(trial.given, trial.expected, strict=True)
            for x in (*pair[0], *pair[1])
        ]
        literals = [st_number(x, trial.kind) for x in rows]
        body = "\n".join(number_lines(literals, width, indent="        "))
        of = f"ARRAY [0..{len(literals) - 1}] OF {ST_TYPES[trial.kind]}"
        declared += [f"    {block} : {trial.block};", f"    {points} : {of} := [\n{body}\n    ];"]
        passed = ", ".join(f"{name} := {points}[k * {width} + {i}]" for i, name in enumerate(given))
        lines.append(f"FOR k := 0 TO {len(trial.expected) - 1} DO")
        lines.append(f"    {block}({passed});")
        for i, name in enumerate(drives):
            place = f"{points}[k * {width} + {len(given) + i}]"
            condition = f"{block}.{name} <> {place}"
            if not np.issubdtype(trial.kind, np.integer):
                tolerance = st_number(trial.tolerance, trial.kind)
                condition = f"ABS({block}.{name} - {place}) > {tolerance}"
            lines += [f"    IF {condition} THEN", "        passed := FALSE;", "    END_IF;"]
        lines.append("END_FOR;")
    name = names.new(f"{prefix}_test")
    head = "(* passed is TRUE after one cycle if the blocks give what the model gives *)"
    return "\n".join(
        [head, f"PROGRAM {name}", "VAR", *declared, "END_VAR", "", *lines, "END_PROGRAM", ""]
    )


# --- The project ---


def _project(text: str, prefix: str, trials: Sequence[_Trial]) -> str:
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
            "creationDateTime": _TIME,
        },
    )
    content = Xml.SubElement(root, _of("contentHeader"), {"name": prefix})
    coordinates = Xml.SubElement(content, _of("coordinateInfo"))
    for language in ("fbd", "ld", "sfc"):
        kind = Xml.SubElement(coordinates, _of(language))
        Xml.SubElement(kind, _of("scaling"), {"x": "1", "y": "1"})
    types = Xml.SubElement(root, _of("types"))
    Xml.SubElement(types, _of("dataTypes"))
    pous = Xml.SubElement(types, _of("pous"))
    for unit in _units(f"{text}\n{_test_program(text, prefix, trials)}"):
        pous.append(_pou(unit))
    instances = Xml.SubElement(root, _of("instances"))
    Xml.SubElement(instances, _of("configurations"))
    _indent(root)
    return f'<?xml version="1.0" encoding="utf-8"?>\n{Xml.tostring(root, "unicode")}\n'


def _units(text: str) -> Iterator[re.Match[str]]:
    """Yield the units of a text, and be sure that nothing lies between them."""
    end = 0
    for unit in _UNIT.finditer(text):
        assert not text[end : unit.start()].strip(), text[end : unit.start()]
        end = unit.end()
        yield unit
    assert not text[end:].strip(), text[end:]


def _pou(unit: re.Match[str]) -> Xml.Element:
    words = {"name": unit["name"], "pouType": _SORTS[unit["sort"]]}
    pou = Xml.Element(_of("pou"), words)
    interface = Xml.SubElement(pou, _of("interface"))
    if unit["type"]:
        returned = Xml.SubElement(interface, _of("returnType"))
        returned.append(_type(unit["type"]))
    last = 0
    for section in _SECTION.finditer(unit["body"]):
        last = section.end()
        name, words = _LISTS[section["title"]]
        listed = Xml.SubElement(interface, _of(name), words)
        for each in _DECLARATION.finditer(section["lines"]):
            listed.append(_variable(each))
    body = Xml.SubElement(Xml.SubElement(pou, _of("body")), _of("ST"))
    Xml.SubElement(body, f"{{{_TEXT}}}p").text = unit["body"][last:].strip("\n") + "\n"
    if unit["head"]:
        lines = [re.sub(r"^ \* ?", "", line) for line in unit["head"].strip("\n").split("\n")]
        remark = Xml.SubElement(pou, _of("documentation"))
        Xml.SubElement(remark, f"{{{_TEXT}}}p").text = "\n".join(lines).strip()
    return pou


def _variable(each: re.Match[str]) -> Xml.Element:
    variable = Xml.Element(_of("variable"), {"name": each["name"]})
    kind = Xml.SubElement(variable, _of("type"))
    if each["last"] is None:
        kind.append(_type(each["type"]))
    else:
        array = Xml.SubElement(kind, _of("array"))
        Xml.SubElement(array, _of("dimension"), {"lower": "0", "upper": each["last"]})
        Xml.SubElement(array, _of("baseType")).append(_type(each["type"]))
    if each["start"]:
        start = Xml.SubElement(variable, _of("initialValue"))
        if each["last"] is None:
            Xml.SubElement(start, _of("simpleValue"), {"value": each["start"].strip()})
        else:
            values = Xml.SubElement(start, _of("arrayValue"))
            for value in each["start"].strip("[]").split(","):
                cell = Xml.SubElement(values, _of("value"))
                Xml.SubElement(cell, _of("simpleValue"), {"value": value.strip()})
    return variable


def _type(name: str) -> Xml.Element:
    """Return an elementary type, or the block of an instance."""
    if name in _ELEMENTARY:
        return Xml.Element(_of(name))
    return Xml.Element(_of("derived"), {"name": name})


def _of(name: str) -> str:
    return f"{{{_SPACE}}}{name}"


def _indent(root: Xml.Element) -> None:
    """Put elements on lines of their own, but for texts, which stay as they are."""
    texts = {each: each.text for each in root.iter(f"{{{_TEXT}}}p")}
    Xml.indent(root)
    for each, text in texts.items():
        each.text = text
