"""PLCopen XML: structured as the standard says, and the tests' interpreter runs what is in it."""

from __future__ import annotations

import os
from pathlib import Path
from xml.etree import ElementTree as Xml

import pytest
from st_programs import Program, demand_own_test

from fuzzyarm import shipped
from fuzzyarm.apps.cli import main

SPACE = "{http://www.plcopen.org/xml/tc6_0201}"
TEXT = "{http://www.w3.org/1999/xhtml}p"

ROWS = {
    "project": ["fileHeader", "contentHeader", "types", "instances"],
    "contentHeader": ["coordinateInfo"],
    "coordinateInfo": ["fbd", "ld", "sfc"],
    "types": ["dataTypes", "pous"],
    "instances": ["configurations"],
}
"""Elements whose children are just these, in this order: by TC6's documentation of the format."""

LISTS = {
    ("inputVars", None): "VAR_INPUT", ("outputVars", None): "VAR_OUTPUT",
    ("inOutVars", None): "VAR_IN_OUT", ("localVars", None): "VAR",
    ("localVars", "constant"): "VAR CONSTANT", ("localVars", "retain"): "VAR RETAIN",
}  # fmt: skip
ELEMENTARY = {"BOOL", "SINT", "INT", "DINT", "REAL", "LREAL"}

CASES = {
    "rules": [str(shipped("pd7.frb")), "--direct"],
    "bins": [str(shipped("pd7.frb"))],
    "q15": [str(shipped("pd7.frb")), "--q", "15", "--mode", "linear"],
    "q7": [str(shipped("pd7.frb")), "--q", "7"],
    "curved": [str(shipped("tipper.frb")), "--direct"],
    "walked": [str(shipped("tipper2.frb")), "--precision", "mixed"],
    "servo": [str(shipped("servo.frb"))],
    "learning": [str(shipped("soc-zero.frb"))],
}


def local(element):
    return element.tag.removeprefix(SPACE)


def type_of(element):
    """Return a type as Structured Text has it; anything that TC6 does not have fails."""
    (inner,) = element
    if local(inner) == "derived":
        assert not list(inner)
        return inner.attrib["name"]
    if local(inner) == "array":
        dimension, base = inner
        assert (local(dimension), local(base)) == ("dimension", "baseType")
        assert dimension.attrib["lower"] == "0"
        return f"ARRAY [0..{dimension.attrib['upper']}] OF {type_of(base)}"
    assert local(inner) in ELEMENTARY
    return local(inner)


def variable_text(variable):
    kind, *starts = variable
    assert local(kind) == "type"
    text = f"{variable.attrib['name']} : {type_of(kind)}"
    for start in starts:
        assert local(start) == "initialValue"
        (value,) = start
        if local(value) == "simpleValue":
            text += f" := {value.attrib['value']}"
        else:
            assert local(value) == "arrayValue"
            cells = [cell[0].attrib["value"] for cell in value]
            assert all(local(cell) == "value" for cell in value)
            text += f" := [{', '.join(cells)}]"
    return f"    {text};"


def text_of(path):
    """Return the Structured Text of a file, its structure checked on the way.

    A program is returned as a block, which an interpreter of blocks runs.
    """
    root = Xml.parse(path).getroot()
    for name, children in ROWS.items():
        (element,) = [root] if name == "project" else root.iter(f"{SPACE}{name}")
        assert [local(child) for child in element] == children
    header = root.find(f"{SPACE}fileHeader")
    assert {"companyName", "productName", "productVersion", "creationDateTime"} <= set(
        header.attrib
    )
    text, names, sorts = [], set(), []
    for data in root.iter(f"{SPACE}dataType"):
        (base,) = data
        assert local(base) == "baseType"
        text.append(f"TYPE\n    {data.attrib['name']} : {type_of(base)};\nEND_TYPE\n")
    for pou in root.iter(f"{SPACE}pou"):
        assert pou.attrib["name"] not in names
        names.add(pou.attrib["name"])
        sorts.append(pou.attrib["pouType"])
        children = [local(child) for child in pou]
        assert children in (["interface", "body"], ["interface", "body", "documentation"])
        word = {
            "function": "FUNCTION",
            "functionBlock": "FUNCTION_BLOCK",
            "program": "FUNCTION_BLOCK",
        }[pou.attrib["pouType"]]
        sections, returned = [], ""
        for part in pou[0]:
            if local(part) == "returnType":
                assert pou.attrib["pouType"] == "function"
                returned = f" : {type_of(part)}"
                continue
            (own,) = list(part.attrib) or [None]
            sections += [LISTS[local(part), own], *map(variable_text, part), "END_VAR"]
        (st,) = pou[1]
        assert local(st) == "ST"
        assert [child.tag for child in st] == [TEXT]
        text.append("\n".join([f"{word} {pou.attrib['name']}{returned}", *sections, st[0].text]))
        text[-1] += f"END_{word}\n"
    assert sorts[-1] == "program"
    return "\n".join(text)


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_the_program_inside_passes_in_the_interpreter(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    words = ["--precision", "float64"] if name in ("servo", "learning", "curved") else []
    assert main(["compile", *CASES[name], *words, "-o", "made.xml"]) == 0
    demand_own_test(Program(text_of(Path("made.xml"))))


@pytest.mark.parametrize("name", ["rules", "q15", "learning"])
def test_the_blocks_are_those_of_the_text(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    assert main(["compile", *CASES[name], "-o", "made.st"]) == 0
    assert main(["compile", *CASES[name], "-o", "made.xml"]) == 0
    plain, inside = Program(Path("made.st").read_text("utf-8")), Program(text_of("made.xml"))
    assert set(plain.units) == set(inside.units) - {"made_test"}
    for key, unit in plain.units.items():
        other = inside.units[key]
        assert list(unit.declared) == list(other.declared)
        assert unit.code.co_consts == other.code.co_consts
        assert unit.inputs == other.inputs
        assert unit.constant == other.constant


@pytest.mark.skipif("PLCOPEN_SCHEMA" not in os.environ, reason="PLCOPEN_SCHEMA names no schema")
@pytest.mark.parametrize("name", CASES)
def test_the_schema_of_the_standard_accepts_it(tmp_path, monkeypatch, name):
    """The schema (tc6_xml_v201.xsd) is PLCopen's, and is not among our files."""
    etree = pytest.importorskip("lxml.etree")
    monkeypatch.chdir(tmp_path)
    schema = etree.XMLSchema(etree.parse(os.environ["PLCOPEN_SCHEMA"]))
    assert main(["compile", *CASES[name], "-o", "made.xml"]) == 0
    made = etree.parse("made.xml")
    schema.assertValid(made)
    made.getroot().find(f".//{SPACE}inputVars").tag = f"{SPACE}inputs"
    assert not schema.validate(made)


def test_the_same_source_gives_the_same_bytes(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("a", "b"):
        assert main(["compile", CASES["bins"][0], "--name", "same", "-o", f"{name}.xml"]) == 0
    assert Path("a.xml").read_bytes() == Path("b.xml").read_bytes()


def test_what_the_language_lacks_is_said(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("steep.frb").write_text(
        "rulebase steep\ninput x -1 .. 1\noutput y 0 .. 1\nterm x A: triangle -1 0 1\n"
        'term y B: formula "tanh(x)"\ninference defuzzifier weighted-average, no-rule 0\n'
        "rule if x is A then y is B\n"
    )
    assert main(["compile", "steep.frb", "-o", "steep.xml"]) == 1
    assert "Structured Text has no function for 'tanh'" in capsys.readouterr().err
    assert not Path("steep.xml").exists()
