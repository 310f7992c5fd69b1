"""Several rule bases, chained to one: numbers, names, findings, and the command."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from budget import cases
from fis import system
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import fuzzyarm
from fuzzyarm.apps.cli.main import main
from fuzzyarm.exchange.formats import parse, tree
from fuzzyarm.exchange.formats.trees import Connection, read_connection
from fuzzyarm.inference import infer
from fuzzyarm.language import format_text, write
from fuzzyarm.language.model.rulebase import RuleBase
from tests import strategies

POINTS = np.linspace(0.0, 1.0, 101)

LIGHT = (
    system("light", inputs=2, rules=3)
    + """\
[Input1]
Name='sun'
Range=[0 1]
NumMFs=2
MF1='low':'trimf',[-1 0 0.8]
MF2='high':'gaussmf',[0.3 1]
[Input2]
Name='hour'
Range=[0 24]
NumMFs=1
MF1='day':'trapmf',[5 8 18 21]
[Output1]
Name='level'
Range=[0 1]
NumMFs=2
MF1='dark':'trimf',[-0.5 0 0.6]
MF2='bright':'trimf',[0.3 1 1.5]
[Rules]
1 0, 1 (1) : 1
2 1, 2 (1) : 1
0 -1, 1 (0.5) : 1
"""
)

MOVE = """[System]
Name='move'
Type='sugeno'
NumInputs=2
NumOutputs=1
NumRules=2
AndMethod='prod'
OrMethod='probor'
ImpMethod='prod'
AggMethod='sum'
DefuzzMethod='wtaver'
[Input1]
Name='brightness'
Range=[0 1]
NumMFs=2
MF1='low':'trimf',[-1 0 1]
MF2='high':'trimf',[0 1 2]
[Input2]
Name='wind'
Range=[0 10]
NumMFs=1
MF1='calm':'zmf',[2 8]
[Output1]
Name='level'
Range=[0 100]
NumMFs=2
MF1='up':'constant',[10]
MF2='down':'linear',[40 -2 50]
[Rules]
1 1, 1 (1) : 1
2 0, 2 (1) : 1
"""


def _rulebase(text: str) -> RuleBase:
    imported = parse(text, ".fis", producer="matlab")
    assert imported.rulebase is not None, imported.diagnostics
    return imported.rulebase


def _joined(*connections: str, lossy: bool = False) -> RuleBase:
    parts = {"light": _rulebase(LIGHT), "move": _rulebase(MOVE)}
    imported = tree(parts, connections, lossy=lossy)
    assert imported.rulebase is not None, imported.diagnostics
    return imported.rulebase


# --- Numbers ---


def _triangle(x: np.ndarray, a: float, b: float, c: float) -> np.ndarray:
    return np.maximum(np.minimum((x - a) / (b - a), (c - x) / (c - b)), 0.0)


def _level(sun: float, hour: float) -> float:
    """Return what MATLAB gives for LIGHT: sums over 101 points."""
    low = float(_triangle(np.array(sun), -1.0, 0.0, 0.8))
    high = math.exp(-0.5 * ((sun - 1.0) / 0.3) ** 2)
    day = float(np.clip(min((hour - 5.0) / 3.0, (21.0 - hour) / 3.0), 0.0, 1.0))
    dark, bright = _triangle(POINTS, -0.5, 0.0, 0.6), _triangle(POINTS, 0.3, 1.0, 1.5)
    sets = [
        np.minimum(dark, low),
        np.minimum(bright, min(high, day)),
        np.minimum(dark, 0.5 * (1.0 - day)),
    ]
    joint = np.max(sets, axis=0)
    return float((POINTS * joint).sum() / joint.sum())


def _move(brightness: float, wind: float) -> float:
    part = (wind - 2.0) / 6.0
    falling = 1.0 - 2.0 * part**2 if part < 0.5 else 2.0 * (1.0 - part) ** 2
    calm = 1.0 if wind <= 2.0 else 0.0 if wind >= 8.0 else falling
    low, high = (1.0 - brightness) * calm, brightness
    return (low * 10.0 + high * (40.0 * brightness - 2.0 * wind + 50.0)) / (low + high)


@pytest.mark.parametrize(
    ("sun", "hour", "wind"), [(0.2, 9, 1), (0.9, 12, 5), (0.5, 20, 3), (0.7, 6, 9)]
)
def test_a_tree_gives_what_its_systems_give_one_after_the_other(sun, hour, wind) -> None:
    joint = _joined("light/level -> move/brightness")
    values = infer(joint, sun=sun, hour=hour, wind=wind)
    level = _level(sun, hour)
    assert values["light_level"] == pytest.approx(level, rel=1e-12)
    assert values["move_level"] == pytest.approx(_move(level, wind), rel=1e-12)


def _open(rulebase: RuleBase) -> RuleBase:
    """Return a rule base that has a number everywhere, and reads inputs as they are."""
    inputs = tuple(replace(variable, outside="extend") for variable in rulebase.inputs)
    outputs = tuple(replace(o, no_rule=0.5 * (o.low + o.high)) for o in rulebase.outputs)
    return replace(rulebase, inputs=inputs, outputs=outputs)


@pytest.mark.slow
@settings(max_examples=cases(4, 60))
@given(strategies.rulebases(), strategies.rulebases(), st.randoms(use_true_random=False))
def test_any_two_rule_bases_give_the_same_joined_and_apart(one, other, random) -> None:
    parts = {"p": _open(one), "q": _open(other)}
    output, into = random.choice(one.outputs), random.choice(other.inputs)
    connection = Connection(("p", output.name), ("q", into.name))
    imported = tree(parts, [connection], lossy=True)
    assume(not any(d.name == "bad-formula" for d in imported.diagnostics))
    joint = imported.rulebase
    assert joint is not None, imported.diagnostics
    parsed = fuzzyarm.language.parse(write(joint)).rulebase
    assert parsed is not None
    renamed = {
        (key, variable.name): next(name for name in (variable.name, f"{key}_{variable.name}")
                                   if name in {v.name for v in (*joint.inputs, *joint.outputs)})
        for key, part in parts.items()
        for variable in (*part.inputs, *part.outputs)
        if (key, variable.name) != connection.target
    }  # fmt: skip
    x = {v.name: random.uniform(v.low, v.high) for v in joint.inputs}
    try:
        first = infer(parts["p"], {v.name: x[renamed["p", v.name]] for v in one.inputs})
        given = {
            v.name: first[output.name] if v.name == into.name else x[renamed["q", v.name]]
            for v in other.inputs
        }
        second = infer(parts["q"], given)
        values = infer(joint, x)
    except fuzzyarm.FuzzyarmError:
        assume(False)
    for key, found in (("p", first), ("q", second)):
        for name, value in found.items():
            joined = values[renamed[key, name]]
            assert joined == pytest.approx(value, rel=1e-9, abs=1e-9, nan_ok=True)


# --- Names and ranges ---


def test_names_that_stand_twice_get_that_of_their_rule_base() -> None:
    joint = _joined("light/level -> move/brightness")
    assert [v.name for v in joint.inputs] == ["sun", "hour", "wind"]
    assert [v.name for v in joint.outputs] == ["light_level", "move_level"]
    # `low` and `high` of the input are terms of the output that it reads.
    assert [t.name for t in joint.outputs[0].terms] == ["dark", "bright", "low", "high"]
    assert [block.name for block in joint.blocks] == ["light", "move"]
    text = write(joint)
    assert format_text(text, "tree.frb") == text


def test_joined_inputs_are_one_over_both_ranges() -> None:
    joint = _joined("light/hour -> move/wind", "light/sun -> move/brightness")
    assert [(v.name, v.low, v.high) for v in joint.inputs] == [("sun", 0, 1), ("hour", 0, 24)]
    assert [t.name for t in joint.inputs[0].terms] == ["low", "high", "move_low", "move_high"]
    apart = infer(_rulebase(MOVE), brightness=0.4, wind=3.0)["level"]
    assert infer(joint, sun=0.4, hour=3.0)["move_level"] == apart


def test_a_circle_is_said_with_its_way() -> None:
    a = _rulebase(LIGHT)
    imported = tree({"a": a, "b": a, "c": a}, ["a/level -> b/sun", "b/level -> c/sun",
                                               "c/level -> a/hour"])  # fmt: skip
    (circle,) = imported.errors
    assert circle.name == "circle"
    assert circle.message.startswith("the connections go in a circle: ")
    assert circle.message.count(" -> ") == 3


@pytest.mark.parametrize(
    ("connection", "name", "words"),
    [
        ("light/levle -> move/wind", "undefined-variable", "'light' has no variable 'levle'"),
        ("light/level -> move/wnd", "undefined-variable", "'move' has no input 'wnd'"),
        ("lihgt/level -> move/wind", "unknown-rulebase", "'lihgt' is not known"),
        ("light/level -> move/level", "not-an-input", "'move/level' is an output"),
        ("light/level, move/wind", "syntax", "is not a connection"),
        ("light/level -> light/sun", "circle", "go in a circle"),
        ("light/sun -> light/sun", "circle", "wait for each other"),
    ],
)
def test_what_cannot_be_connected_is_said_by_name(connection, name, words) -> None:
    parts = {"light": _rulebase(LIGHT), "move": _rulebase(MOVE)}
    imported = tree(parts, [connection])
    assert imported.rulebase is None
    assert [error.name for error in imported.errors] == [name]
    assert words in imported.errors[0].message
    if "levle" in connection or "wnd" in connection or "lihgt" in connection:
        assert imported.errors[0].hint.startswith("did you mean")


def test_two_ways_to_one_input_are_one_too_many() -> None:
    parts = {"light": _rulebase(LIGHT), "move": _rulebase(MOVE)}
    imported = tree(parts, ["light/level -> move/wind", "light/sun -> move/wind"])
    assert [error.name for error in imported.errors] == ["duplicate-connection"]


def test_an_output_beyond_the_range_of_an_input_is_said() -> None:
    parts = {"light": _rulebase(LIGHT), "move": _rulebase(MOVE)}
    (beyond,) = [d for d in tree(parts, ["move/level -> light/sun"]).diagnostics
                 if d.name == "beyond-input"]  # fmt: skip
    assert beyond.severity == "warning"
    assert "0 .. 100, beyond the range of 'light/sun', 0 .. 1" in beyond.message
    clamped = replace(
        parts["light"], inputs=tuple(replace(v, outside="clamp") for v in parts["light"].inputs)
    )
    imported = tree({**parts, "light": clamped}, ["move/level -> light/sun"])
    assert [error.name for error in imported.errors] == ["beyond-input"]


def test_a_connection_is_read_with_its_spaces() -> None:
    assert read_connection(" a b/out 1 ->c/in ") == Connection(("a b", "out 1"), ("c", "in"))
    for text in ("", "->", "a -> b", "a/b", "a/ -> b/c"):
        assert read_connection(text) is None


# --- The command ---


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "light.fis").write_text(LIGHT)
    (tmp_path / "move.fis").write_text(MOVE)
    monkeypatch.chdir(tmp_path)
    return tmp_path


CONNECTED = ["--connect", "light/level -> move/brightness"]


def test_files_are_chained_by_the_command(folder: Path, capsys) -> None:
    assert main(["convert", "light.fis", "move.fis", "tree.frb", *CONNECTED]) == 0
    assert "tree.frb: written, nothing lost" in capsys.readouterr().out
    assert main(["check", "tree.frb"]) == 0
    capsys.readouterr()
    assert main(["eval", "tree.frb", "sun=0.9", "hour=12", "wind=5", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["move_level"] == pytest.approx(_move(_level(0.9, 12), 5), rel=1e-12)


def test_what_was_found_stands_in_json(folder: Path, capsys) -> None:
    words = ["convert", "light.fis", "move.fis", "tree.frb", "--json"]
    assert main([*words, *CONNECTED]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["sources"] == ["light.fis", "move.fis"]
    assert found["written"] is True


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (["light.fis", "move.fis", "tree.frb"], 2, "--connect"),
        (["light.fis", "tree.frb", *CONNECTED], 2, "two files or more"),
        (["light.fis", "light.fis", "tree.frb", *CONNECTED], 2, "two files are called 'light'"),
        (["light.fis", "absent.fis", "tree.frb", *CONNECTED], 1, "absent.fis"),
        (["light.fis", "move.fis", "move.fis", *CONNECTED], 1, "are the same"),
        (["light.fis", "move.fis", "x.frb", "--connect", "light/x -> move/wind"], 1, "no variable"),
        (["light.fis", "move.fis", "tree.fis", *CONNECTED], 1, "chained-output"),
    ],
)  # fmt: skip
def test_nothing_is_written_of_what_is_wrong(folder: Path, capsys, words, code, said) -> None:
    before = (folder / "move.fis").read_text()
    try:
        status = main(["convert", *words])
    except SystemExit as error:
        status = int(error.code or 0)
    assert status == code
    assert said in capsys.readouterr().err
    assert not (folder / "tree.frb").exists()
    assert not (folder / "tree.fis").exists()
    assert (folder / "move.fis").read_text() == before
