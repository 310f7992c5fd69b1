"""The block diagram of a rule base: from the record to the terminal and to paper."""

import pytest

from fuzzyarm.apps.cli.main import main
from fuzzyarm.apps.show.placement import Pen, place
from fuzzyarm.apps.show.system import system_diagram
from fuzzyarm.language import parse

TWO = """
rulebase two
input a 0 .. 1
input b 0 .. 1
input c 0 .. 1
output p 0 .. 1
output q 0 .. 1
terms a, b, c, p, q: triangles low high
rule if a is low and b is high then p is low
rule if a is high then p is high
rule if c is low then q is low
"""


def diagram_of(text):
    parsed = parse(text)
    return system_diagram(parsed.rulebase)


def wires_of(diagram):
    """Return the wires by the labels of their blocks."""
    labels = [block.label for block in diagram.blocks]
    return {(labels[wire.source], labels[wire.target]) for wire in diagram.wires}


def test_inputs_are_wired_to_the_rules_that_read_them():
    diagram = diagram_of(TWO)
    assert wires_of(diagram) == {
        ("a", "rules for p"), ("b", "rules for p"), ("c", "rules for q"),
        ("rules for p", "p"), ("rules for q", "q"),
    }  # fmt: skip
    details = {block.label: block.details for block in diagram.blocks}
    assert details["rules for p"] == ("2 rules", "and min, or max")
    assert details["a"] == ("0 .. 1", "2 terms")
    assert diagram.period == "3 rules"


def test_an_output_that_rules_read_is_wired_to_them():
    text = TWO.replace("rule if c is low", "block second\nrule if c is low and p is high")
    assert ("rules for p", "rules for q") in wires_of(diagram_of(text))


def test_a_linear_conclusion_reads_the_inputs_of_its_coefficients():
    text = """
rulebase s
input a 0 .. 1
input b 0 .. 1
output y 0 .. 9
terms a: triangles low high
term y plane: linear 2*b + 1
inference defuzzifier weighted-average
rule if a is low then y is plane
"""
    assert ("b", "s") in wires_of(diagram_of(text))


@pytest.mark.parametrize("length", [1, 64])
def test_no_block_lies_on_another_and_no_name_is_cut(length):
    names = [letter * length for letter in "abcdefgh"]
    lines = [f"input {name} 0 .. 1" for name in names]
    rules = " and ".join(f"{name} is low" for name in names)
    text = "\n".join(
        [
            "rulebase r",
            *lines,
            "output y 0 .. 1",
            f"terms {', '.join(names)}, y: triangles low high",
            f"rule if {rules} then y is low",
        ]
    )
    pen = Pen(lambda text, _: len(text), line=1.0, pad=1.0, room=12.0, track=1.0, arrow=2.0)
    picture = place(diagram_of(text), pen)
    boxes = [(b.x, b.y, b.x + b.width, b.y + b.height) for b in picture.blocks]
    for i, (left, top, right, bottom) in enumerate(boxes):
        for other in boxes[i + 1 :]:
            assert right <= other[0] or other[2] <= left or bottom <= other[1] or other[3] <= top
    shown = {line for block in picture.blocks for line, _ in block.lines}
    assert set(names) <= shown


def test_the_command_draws_it(capsys, tmp_path, monkeypatch):
    monkeypatch.setenv("COLUMNS", "120")
    assert main(["show", "rulebases/pd7.frb", "--diagram"]) == 0
    drawn = capsys.readouterr().out
    assert "49 rules" in drawn
    assert drawn.count("▶") == 3
    assert len({drawn.count(corner) for corner in "┌┐└┘"}) == 1
    figure = tmp_path / "d.svg"
    assert main(["plot", "rulebases/pd7.frb", "--what", "diagram", "-o", str(figure)]) == 0
    assert figure.stat().st_size > 1000
