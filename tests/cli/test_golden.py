"""What a person sees, to the letter; `pytest --update-golden` writes it anew."""

from pathlib import Path

import pytest

from fuzzyarm.apps.cli import main
from fuzzyarm.base.shipped_files import shipped

GOLDEN = Path(__file__).parent / "golden"

SLIPS = (
    ("triangles NB", "triangels NB"),
    ("input  ce", "imput  ce"),
    ("NM      NB  NM  NM", "NM      NB  NX  NM"),
    ("  PB      ZE  PS  PS  PM  PB  PB  PB", "  PB      ZE  PS  PS  PM  PB  PB"),
    ("implication min", "implication mim"),
    ("expect e = 6, ce = 0", "expect e = 6"),
    ("bins    0.1 0.6", "bins    0.6 0.1"),
)
DOUBTS = (
    ("NM      NB  NM  NM  NM  NS  ZE  PS", "NM      NB  NM  NM  NM  NS  NS  ."),
    ("-> u > 3.5", "-> u > 5.5"),
)


@pytest.fixture
def workplace(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setenv("NO_COLOR", "1")
    return tmp_path


def injured(slips):
    text = shipped("pd7.frb").read_text()
    for right, wrong in slips:
        assert text.count(right) == 1, right
        text = text.replace(right, wrong)
    return text


def compare(name, shown, update_golden):
    path = GOLDEN / name
    if update_golden:
        path.write_text(shown)
    assert shown == path.read_text()


@pytest.mark.parametrize(("name", "slips"), [("mistakes", SLIPS), ("doubts", DOUBTS)])
def test_check_of_an_injured_file(name, slips, workplace, capsys, update_golden):
    (workplace / f"{name}.frb").write_text(injured(slips))
    assert main(["check", f"{name}.frb"]) == 1
    compare(f"check_{name}.txt", capsys.readouterr().err, update_golden)


def test_fmt_of_an_untidy_file(workplace, capsys, update_golden):
    untidy = """# first   comment
rulebase   'my rules'    "what \\"for\\""
input e -6..6
input   'second input'  0 .. 1e3 "größe"


output u -1.50 .. 1.5
terms e:triangles N  Z P   # even
term 'second input' LOW:trapezoid -inf -inf 1 10
term 'second input' HIGHER:  gaussian 500 1e2
term u A:points (0,0)(1,1)
term u B: linear 2*e - 'second input' +1 height .5
inference and   product,defuzzifier weighted-average
rules u when 'second input' is not very LOW
e\\'second input' LOW HIGHER   # header
# a row
N A B*.5
Z . A
rule if (e is N) and ((e is Z or e is P)) then u is A with .25
lookup
 levels e: -6 .. 6 step 3
 levels 'second input': 0 500 1000
expect e=1,'second input'=2->u in 0 .. 1
# the end
"""
    (workplace / "untidy.frb").write_text(untidy)
    assert main(["fmt", "untidy.frb"]) == 0
    compare("fmt_untidy.frb", (workplace / "untidy.frb").read_text(), update_golden)


@pytest.mark.slow
def test_the_demo(workplace, capsys, update_golden):
    assert main(["demo", "--keep", "the/story"]) == 0
    compare("demo.txt", capsys.readouterr().out, update_golden)
    files = {path.name for path in (workplace / "the" / "story").iterdir()}
    assert files == {"pd7.frb", "broken.frb", "pd7.lut", "servo.frb", "servo.h"}
