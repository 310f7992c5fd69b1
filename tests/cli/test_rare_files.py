"""Files within the limits that few would write: no command answers one with a traceback."""

import shutil
from pathlib import Path

import pytest

from fuzzyarm.apps.cli.main import main
from fuzzyarm.base import diagnostic
from fuzzyarm.base.diagnostic import split_lines

ROOT = Path(__file__).parents[2]

WRONG_FLL = """\
Engine: wrong
InputVariable: speed
  enabled: true
  range: 0 10
  term: LOW Triangle 0 2 4
OutputVariable: fan
  enabled: true
  range: 0 10
  aggregation: Maximum
  defuzzifier: Centroid 100
  default: nan
  term: ON Triangle 0 2 4
RuleBlock: all
  enabled: true
  conjunction: Minimum
  disjunction: Maximum
  implication: Minimum
  activation: General
"""

METHODS = """\
inference and min, or max, implication min, aggregation max, defuzzifier centroid exact, \
outside clamp, no-rule 0
"""

ONE_ULP = f"""\
rulebase t
input x 1 .. 1.0000000000000002
output y 0 .. 1
terms x, y: triangles A B
{METHODS}rule if x is A then y is B
"""

MANY_PARTS = f"""\
rulebase d
input x -1 .. 1
input z -1 .. 1
output y -1 .. 1
terms x, z, y: triangles N Z P
{METHODS}rule if {" and ".join(f"{'xz'[k % 2]} is {'NZP'[k % 3]}" for k in range(1500))} then y is P
"""

READERS = (
    "check {}", "show {}", "show --rules {}", "eval {} --explain", "plot {} -o p.png",
    "compile {} -o a.lut", "compile {} -o a.h", "compile {} --direct -o b.h", "compile {} -o a.py",
    "compile {} -o a.mjs", "compile {} --direct -o a.st", "convert {} a.fis", "convert {} a.fll",
    "convert {} a.fcl", "convert {} a.fml", "diff {} {}", "prove {} --range", "watch --once {}",
    "cite {}", "fmt --check {}",
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("text", [ONE_ULP, MANY_PARTS], ids=["one ulp", "1,500 parts"])
def test_every_command_answers_a_rare_rule_base(tmp_path, monkeypatch, capsys, text):
    monkeypatch.chdir(tmp_path)
    Path("r.frb").write_text(text)
    for words in READERS:
        assert main(words.replace("{}", "r.frb").split()) in {0, 1, 2, 4}, words
    assert "1 input" in text or capsys.readouterr().out


def test_terms_over_one_step_of_floats_are_drawn(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("r.frb").write_text(ONE_ULP)
    assert main(["show", "r.frb"]) == 0
    first, second = capsys.readouterr().out.splitlines()[4:6]
    assert first.split("█")[0].strip() == "A"
    assert second.index("█") > first.index("█") + 20


def test_a_range_too_narrow_to_be_divided_is_refused_in_any_format(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("z.fll").write_text(
        "Engine: a\nInputVariable: x\n  range: 0 1\n  term: A Triangle 0 0.5 1\n"
        "OutputVariable: y\n  range: 0 5e-324\n  defuzzifier: Centroid 100\n"
        "  term: B Function x^2\nRuleBlock: b\n  activation: General\n"
        "  rule: if x is A then y is B\n"
    )
    assert main(["check", "z.fll"]) == 1
    assert "the range of 'y' is narrower than 1e-100" in capsys.readouterr().err


@pytest.mark.parametrize(("field", "value"), [("axis", "3"), ("name", "['a']")])
def test_a_plant_whose_names_are_not_texts_is_refused(tmp_path, monkeypatch, capsys, field, value):
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "rulebases/servo.frb", "servo.frb")
    Path("p.py").write_text(
        "from fuzzyarm.plant import Plant, Port\n\n\nclass M(Plant):\n"
        f"    {field} = {value}\n"
        "    inputs = {'voltage': Port('V', -24, 24)}\n"
        "    outputs = {'position': Port('rad'),"
        " 'velocity': Port('rad/s', rate_of='position')}\n"
        "    states = {'position': 'rad', 'velocity': 'rad/s'}\n\n"
        "    def derivative(self, t, x, u, p):\n        return [x[1], u[0] - x[1]]\n"
    )
    assert main(["simulate", "servo.frb", "--plant", "p.py", "--for", "20ms"]) == 1
    assert f"the {field} of plant" in capsys.readouterr().err


def test_what_convert_writes_of_values_with_type_2_passes_check(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["convert", str(ROOT / "tests/formats/data/observer.t2fis"), "o.frb"]) == 0
    assert main(["check", "o.frb"]) == 0
    capsys.readouterr()
    assert main(["eval", "o.frb", "x1=-0.3", "x2=0.6"]) == 0
    after = capsys.readouterr().out
    assert main(["eval", str(ROOT / "tests/formats/data/observer.t2fis"), "x1=-0.3", "x2=0.6"]) == 0
    assert capsys.readouterr().out == after


def test_the_lines_of_a_file_are_found_once_for_all_its_findings(tmp_path, monkeypatch, capsys):
    """A file of 90,000 wrong rules was divided into its lines for each of them."""
    counts = []

    def counted(text):
        counts.append(text.count("rule: if"))
        return split_lines(text)

    rules = "".join(f"  rule: if speed is Z{k} then fan is ON\n" for k in range(200))
    (tmp_path / "wrong.fll").write_text(WRONG_FLL + rules)
    monkeypatch.setattr(diagnostic, "split_lines", counted)
    assert main(["convert", str(tmp_path / "wrong.fll"), str(tmp_path / "o.frb")]) == 1
    assert capsys.readouterr().err.count("error[") >= 200
    assert sum(count == 200 for count in counts) <= 4
