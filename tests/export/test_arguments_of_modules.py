"""An argument that is not a number is refused by name, in Python and JavaScript."""

import json
import subprocess
import sys

import pytest
from needs import requires

from fuzzyarm.apps.cli.main import main

RULES = """rulebase rules
input e -1 .. 1
input checked -1 .. 1
output u -1 .. 1
terms e, checked, u: triangles N Z P
rule if e is N and checked is N then u is N
rule if e is Z then u is Z
rule if e is P then u is P
"""
CONTROLLER = """controller loop
use rules from "rules.frb"
period 10 ms
gain number = 2
axis shaft
  e = error of position
  u = rules rules(e, e) * number
  drive voltage = u
"""
PYTHON = """import json, sys
sys.dont_write_bytecode = True
import rules, loop
found = []
for call in (rules.u, loop.Controller().step):
    for given in (None, "0.1", [0.1]):
        try:
            found.append(call(0.5, given))
        except TypeError as error:
            found.append(str(error))
    found.append(call(1, True) == call(1.0, 1.0))
print(json.dumps(found))
"""
JAVASCRIPT = """import { infer, u } from "./rules.mjs";
import { Controller } from "./loop.mjs";
const controller = new Controller(), found = [];
const calls = [u, (a, b) => controller.step(a, b), (e, checked) => infer({ e, checked }).u];
for (const call of calls) for (const given of [null, "0.1", [0.1], undefined]) {
  try { found.push(call(0.5, given)); } catch (error) { found.push(error.message); }
}
console.log(JSON.stringify(found));
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, text in (("rules.frb", RULES), ("loop.frb", CONTROLLER)):
        (tmp_path / name).write_text(text)
        for suffix in (".py", ".mjs"):
            assert main(["compile", name, "-o", name.replace(".frb", suffix)]) == 0
    return tmp_path


def answers(folder, *command):
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=folder)
    return json.loads(done.stdout)


def test_python_refuses_what_is_not_a_number(folder):
    (folder / "ask.py").write_text(PYTHON)
    given = ["None", "'0.1'", "[0.1]"]
    assert answers(folder, sys.executable, "ask.py") == [
        *(f"checked_2 is not a number: {each}" for each in given), True,
        *(f"measured_position is not a number: {each}" for each in given), True,
    ]  # fmt: skip


@requires("node")
def test_javascript_refuses_what_is_not_a_number(folder):
    (folder / "ask.mjs").write_text(JAVASCRIPT)
    names = ("checked_2", "measured_position", "checked_2")
    assert answers(folder, "node", "ask.mjs") == [
        f"{name} is not a number: {given}"
        for name in names
        for given in ("null", '"0.1"', "[0.1]", "undefined")
    ]
