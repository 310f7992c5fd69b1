"""One grid for several outputs that share their conditions: cells with a word for each."""

from __future__ import annotations

import pytest

from fuzzyarm import infer
from fuzzyarm.exchange.files import check_text
from fuzzyarm.language import format_text, parse, write
from fuzzyarm.language.edit import complete, hover, read, rename

HEAD = """\
rulebase two "two outputs"
input  e   -1 .. 1
input  ce  -1 .. 1
output u   -1 .. 1
output v   -1 .. 1
terms e, ce, u: triangles N Z P
terms v: triangles LOW MID HIGH
inference no-rule 0
"""
JOINT = """
rules u, v
  e \\ ce  N           Z      P
  N       N/LOW       N/MID  Z/HIGH*0.5
  Z       N*0.25/LOW  .      P/.
  P       ./MID       P/LOW  P/HIGH
"""
APART = """
rules u
  e \\ ce  N       Z  P
  N       N       N  Z
  Z       N*0.25  .  P
  P       .       P  P

rules v
  e \\ ce  N    Z    P
  N       LOW  MID  HIGH*0.5
  Z       LOW  .    .
  P       MID  LOW  HIGH
"""


def test_a_joint_grid_means_what_a_grid_for_each_output_means() -> None:
    joint, apart = parse(HEAD + JOINT).rulebase, parse(HEAD + APART).rulebase
    assert joint is not None
    assert apart is not None
    assert write(joint) == write(apart)
    for e in (-0.9, -0.2, 0.0, 0.4):
        assert infer(joint, e=e, ce=0.3) == infer(apart, e=e, ce=0.3)


def test_it_keeps_its_form() -> None:
    assert format_text(HEAD + JOINT) == HEAD + JOINT
    assert format_text(HEAD + JOINT.replace("./MID", "  .  /  MID")) == HEAD + JOINT


def test_it_takes_a_condition_and_one_input() -> None:
    text = HEAD + "\nrules u, v when ce is N\n  e  N      Z  P\n  u  N/LOW  .  P/HIGH\n"
    found = parse(text)
    assert found.diagnostics == ()
    assert format_text(text) == text
    assert len(found.partial.rules) == 4


@pytest.mark.parametrize(
    ("wrong", "name", "said"),
    [
        (JOINT.replace("N/LOW ", "N     "), "unexpected-token", "'/' and a term of 'v'"),
        (JOINT.replace("P/HIGH\n", "P/HIHG\n"), "unknown-term", "HIGH"),
        (JOINT.replace("P/HIGH\n", "P/HIGH/P\n"), "unexpected-token", "a term or a dot"),
        (JOINT.replace("  P/HIGH\n", "\n"), "wrong-cell-count", "2 cells"),
        (JOINT.replace("u, v", "u, w"), "unknown-variable", "'w'"),
        (JOINT.replace("u, v", "u, e"), "not-an-output", "'e'"),
    ],
)
def test_a_mistake_is_found_in_its_cell(wrong: str, name: str, said: str) -> None:
    found = [d for d in check_text(HEAD + wrong).diagnostics if d.is_error]
    assert name in [d.name for d in found]
    assert said in str(found)


def test_an_editor_knows_each_word_of_a_cell() -> None:
    text = HEAD + JOINT
    reading = read(text)
    lines = text.splitlines()
    row = next(i for i, line in enumerate(lines, start=1) if line.startswith("  N  "))
    column = lines[row - 1].index("N/LOW") + 1
    u, v = hover(reading, row, column), hover(reading, row, column + 3)
    assert u is not None
    assert v is not None
    assert "if e is N and ce is N then u is N" in u.markdown
    assert "if e is N and ce is N then v is LOW" in v.markdown
    cut = "\n".join([*lines[: row - 1], lines[row - 1][: column + 1]])
    offered = [c.label for c in complete(read(cut), row, column + 2)]
    assert offered[:3] == ["LOW", "MID", "HIGH"]
    edits = rename(reading, row, column + 3, "SMALL")
    assert len([edit for edit in edits if edit.text.strip()]) == 1 + text.count("/LOW")
