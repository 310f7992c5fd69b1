"""XML of IEC 61131-10: its structure as the standard describes it, and what is in it runs.

The schema is sold with the standard and is not here: what is held against it is this file alone.
"""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as Xml

import pytest
from st_programs import Program
from test_plcopen import CASES

from fuzzyarm.apps.cli import main

SPACE = "{www.iec.ch/public/TC65SC65BWG7TF10}"
KIND = "{http://www.w3.org/2001/XMLSchema-instance}type"

CHILDREN = {
    "Function": ["Documentation", "ResultType", "Parameters", "Vars", "MainBody"],
    "FunctionBlock": ["Documentation", "Parameters", "Vars", "MainBody"],
    "Program": ["Documentation", "Parameters", "Vars", "MainBody"],
    "Variable": ["Documentation", "Type", "InitialValue"],
    "Parameters": ["InoutVars", "InputVars", "OutputVars"],
}
"""Children in the order of a sequence of the standard, each of which may be missing."""

TITLES = {"InputVars": "VAR_INPUT", "OutputVars": "VAR_OUTPUT", "InoutVars": "VAR_IN_OUT"}


def local(element):
    assert element.tag.startswith(SPACE)
    return element.tag.removeprefix(SPACE)


def type_of(element):
    (inner,) = element
    if local(inner) == "TypeName":
        assert inner.text.isidentifier(), "an array is not a name"
        return inner.text
    assert local(inner) == "InstantlyDefinedType"
    return array_of(inner)


def array_of(inner):
    assert inner.attrib[KIND] == "ArrayTypeSpec"
    base, dimension = inner
    assert (local(base), local(dimension)) == ("BaseType", "DimensionSpec")
    assert dimension.attrib == {"dimensionNumber": "1"}
    assert dimension[0].attrib["lower"] == "0"
    return f"ARRAY [0..{dimension[0].attrib['upper']}] OF {type_of(base)}"


def declared(variable):
    ordered(variable)
    parts = {local(child): child for child in variable}
    text = f"    {variable.attrib['name']} : {type_of(parts['Type'])}"
    if "InitialValue" in parts:
        (value,) = parts["InitialValue"]
        if local(value) == "SimpleValue":
            text += f" := {value.attrib['value']}"
        else:
            text += f" := [{', '.join(cell[0].attrib['value'] for cell in value)}]"
    return f"{text};"


def ordered(element):
    names = [local(child) for child in element]
    order = CHILDREN[local(element)]
    assert names == sorted(names, key=order.index)


def text_of(path):
    root = Xml.parse(path).getroot()
    assert local(root) == "Project"
    assert root.attrib == {"schemaVersion": "1"}
    assert [local(child) for child in root] == [
        "FileHeader", "ContentHeader", "Types", "Instances",
    ]  # fmt: skip
    (space,) = root.find(f"{SPACE}Types")
    assert local(space) == "GlobalNamespace"
    text, seen = [], set()
    for unit in space:
        if local(unit) == "DataTypeDecl":
            assert not any(word in "".join(text) for word in ("FUNCTION", "PROGRAM"))
            (array,) = unit
            assert local(array) == "UserDefinedTypeSpec"
            text.append(f"TYPE\n    {unit.attrib['name']} : {array_of(array)};\nEND_TYPE\n")
            continue
        ordered(unit)
        word = {"Function": "FUNCTION"}.get(local(unit), "FUNCTION_BLOCK")
        assert unit.attrib["name"] not in seen
        seen.add(unit.attrib["name"])
        returned = unit.find(f"{SPACE}ResultType")
        suffix = "" if returned is None else f" : {type_of(returned)}"
        lines = [f"{word} {unit.attrib['name']}{suffix}"]
        parameters = unit.find(f"{SPACE}Parameters")
        order = []
        for group in () if parameters is None else parameters:
            lines += [TITLES[local(group)], *map(declared, group), "END_VAR"]
            order += [int(variable.attrib["orderWithinParamSet"]) for variable in group]
        assert order == list(range(len(order)))
        for group in unit.iter(f"{SPACE}Vars"):
            assert group.attrib["accessSpecifier"] == "private"
            title = "VAR" + "".join(
                f" {word.upper()}" for word in ("constant", "retain") if group.attrib.get(word)
            )
            lines += [title, *map(declared, group), "END_VAR"]
        (content,) = unit.find(f"{SPACE}MainBody")
        assert (local(content), content.attrib[KIND]) == ("BodyContent", "ST")
        text.append("\n".join([*lines, "", content[0].text + f"END_{word}\n"]))
    return "\n".join(text)


@pytest.mark.parametrize("name", CASES)
def test_the_program_inside_passes_in_the_interpreter(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    double = ["--precision", "float64"] if name in {"servo", "learning", "curved"} else []
    words = [*CASES[name], *double, "--format", "iec61131-10"]
    assert main(["compile", *words, "-o", "made.xml"]) == 0
    program = Program(text_of(Path("made.xml")))
    test = program.instance("made_test")
    test.run()
    assert test.values["passed"]


def test_the_format_is_refused_for_other_files(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    words = ["compile", *CASES["bins"], "--format", "iec61131-10", "-o", "made.st"]
    assert main(words) == 2
    assert "--format does not apply: made.st is not an .xml" in capsys.readouterr().err
