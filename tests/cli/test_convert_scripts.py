"""`fuzzyarm convert project.py`: scripts that make systems, and scripts that do anything else.

The scripts import a stand-in for pyfuzzylite, which loads at once.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from fuzzyarm.apps.cli.main import main
from fuzzyarm.exchange.live import ScriptError, read_script
from fuzzyarm.language import load_rulebase

pytestmark = pytest.mark.slow  # a process for each script

STAND_IN = Path(__file__).parents[1] / "formats/stand_in/fuzzylite"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the stand-in, in which a script finds it."""
    shutil.copytree(STAND_IN, tmp_path / "fuzzylite")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def script(folder: Path, text: str, name: str = "project.py") -> str:
    (folder / name).write_text(text, encoding="utf-8")
    return name


MANY = """
import os, sys
from fuzzylite import Engine
import matplotlib.pyplot as plt

class Plant:
    def __init__(self):
        self.inner = Engine("in an object", slope=3)

def build():
    hidden = Engine("in a function", slope=4)
    return hidden.slope

größe = Engine("", slope=2)
Größe = Engine("two", slope=5)
again = größe
listed = [Engine("a"), Engine("b", term="al")]
plants = {"left side": Engine("'quoted'", slope=7, error=0.01)}
plant = Plant()
build()
for _ in range(300):
    print("x" * 10_000)
    print("y" * 10_000, file=sys.stderr)
figure = plt.figure()
plt.plot([0, 1])
plt.show()
os.chdir("/")
if __name__ == "__main__":
    sys.exit(3)
"""


def test_every_system_becomes_a_file(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Names of variables, also of functions and objects; output, windows and folders aside."""
    name = script(folder, MANY)
    assert main(["convert", name, "-o", "out"]) == 1
    printed = capsys.readouterr()
    assert len(printed.out) < 3000
    assert "xxx" not in printed.out + printed.err
    written = {path.name for path in (folder / "out").iterdir()}
    assert written == {
        "größe.frb", "Größe_2.frb", "listed_1.frb", "plants_left_side.frb", "plant_inner.frb",
        "hidden.frb",
    }  # fmt: skip
    assert "out/listed_2.frb: not written" in printed.err
    assert "error[undefined-term]" in printed.err
    assert "did you mean 'all'" in printed.err
    assert "plants_left_side: warning[numbers-differ]: 'y' differs by up to 0.0014" in printed.out
    assert load_rulebase(folder / "out/größe.frb").name == "größe"
    assert load_rulebase(folder / "out/hidden.frb").outputs[0].high == 4.0


@pytest.mark.parametrize(
    ("text", "finding", "line"),
    [
        ("x = 1\ndef f(:\n", "the script ends with SyntaxError", "2 | def f(:"),
        (
            "def f(x):\n    return 1 / x\n\nf(0)\n",
            "the script ends with ZeroDivisionError: division by zero",
            "2 |     return 1 / x",
        ),
        ("x = input('x? ')\n", "the script ends with EOFError", "write the value into the script"),
        (
            "import no_such_module\n",
            "No module named 'no_such_module'",
            "pip install no_such_module",
        ),
        ("import msvcrt\n", "No module named 'msvcrt'", "a part of Python on Windows"),
        ("from RPi import GPIO\n", "No module named 'RPi'", "pip install RPi.GPIO"),
        (
            "import argparse\np = argparse.ArgumentParser()\np.add_argument('a')\np.parse_args()\n",
            "the script ends with SystemExit: 2",
            "the script gets no arguments",
        ),
        (
            "import numpy as np\nfrom skfuzzy import control\n"
            "a = control.Antecedent(np.arange(3), 'a')\nb = control.Consequent(np.arange(3), 'b')\n"
            "a.automf(3)\nb.automf(3)\ncontrol.Rule(a['poor'], b['good']).view()\n",
            "the script ends with AttributeError",
            "leave the line out",
        ),
        ("while True:\n    pass\n", "the script has not ended within 1 s", "--seconds"),
        ("import time\ntime.sleep(60)\n", "the script has not ended within 1 s", "--seconds"),
        ("print('nothing')\n", "no fuzzy system found", "a ControlSystem of scikit-fuzzy"),
        ("import os\nos._exit(7)\n", "its process ended with status 7", ""),
    ],
)
def test_scripts_that_make_nothing(
    text: str, finding: str, line: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    seconds = "1" if "while True" in text or "sleep" in text else "60"
    assert main(["convert", script(folder, text), "--seconds", seconds]) == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    assert finding in printed.err
    assert line in printed.err
    assert not list(folder.glob("*.frb"))


def test_lines_for_a_notebook_are_left_out(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = "pip install fuzzylite\n!ls\n%matplotlib inline\nif True:\n    !pip install it\n"
    rest = "from fuzzylite import Engine\nengine = Engine('one')\nengine.process()\nprint(1 / 0)\n"
    assert main(["convert", script(folder, lines + rest)]) == 0
    assert "9 | print(1 / 0)" in capsys.readouterr().out
    assert load_rulebase(folder / "engine.frb").name == "one"


@pytest.mark.slow
def test_what_a_script_has_made_by_the_end_of_its_time(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = "from fuzzylite import Engine\nengine = Engine('one')\nwhile True: pass\n"
    words = ["convert", script(folder, text), "--seconds", "1"]
    assert main([*words, "--strict"]) == 1
    assert "error[endless-script]" in capsys.readouterr().err
    assert main(words) == 0
    assert "within 1 s; the systems made by then are taken" in capsys.readouterr().out
    assert load_rulebase(folder / "engine.frb").name == "one"


def test_what_had_computed_before_a_script_failed(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = "from fuzzylite import Engine\nused, unused = Engine('one'), Engine('two')\n"
    text += "used.process()\nprint(1 / 0)\n"
    words = ["convert", script(folder, text)]
    assert main(words) == 0
    said = capsys.readouterr().out
    assert "ends with ZeroDivisionError: division by zero; the systems made by then" in said
    assert "unused had not computed anything before that and may lack rules; left out" in said
    assert [path.name for path in folder.glob("*.frb")] == ["used.frb"]
    assert main([*words, "--lossy", "--force"]) == 0
    assert {path.name for path in folder.glob("*.frb")} == {"used.frb", "unused.frb"}


ONE = "from fuzzylite import Engine\nengine = Engine('one', slope=2)\n"


def test_files_that_are_there_are_left_alone(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = script(folder, ONE)
    (folder / "engine.frb").write_text("mine")
    assert main(["convert", name]) == 1
    assert "engine.frb is not replaced: fuzzyarm did not write it" in capsys.readouterr().err
    assert (folder / "engine.frb").read_text() == "mine"
    assert main(["convert", name, "--force", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    (system,) = told["systems"]
    assert (system["name"], system["producer"], system["written"]) == (
        "engine", "pyfuzzylite", True,
    )  # fmt: skip
    assert [d["name"] for d in system["diagnostics"]][-1] == "same-numbers"
    # The file that was named is meant.
    (folder / "named.frb").write_text("old")
    assert main(["convert", name, "named.frb", "--force"]) == 0
    assert load_rulebase(folder / "named.frb").name == "one"


def test_a_slight_difference_is_refused_when_strict(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = script(folder, ONE.replace("slope=2", "slope=2, error=1e-3"))
    assert main(["convert", name, "--strict"]) == 1
    assert "error[numbers-differ]: 'y' differs by up to 0.0005" in capsys.readouterr().err
    assert not (folder / "engine.frb").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["none.py"], "none.py: No such file"),
        (["project.py", "x.fll"], "written as .frb only"),
        (["project.py", "x.frb"], "makes 2: a, b"),
        (["project.py", "--python", "none/python"], "no such folder: 'none'"),
    ],
)
def test_calls_that_are_refused(
    words: list[str], message: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    script(folder, "from fuzzylite import Engine\na, b = Engine('a'), Engine('b')\n")
    assert main(["convert", *words]) == 1
    assert message in capsys.readouterr().err
    assert not list(folder.glob("*.frb"))


def test_in_python(folder: Path) -> None:
    script(folder, ONE)
    (system,), diagnostics = read_script("project.py")
    assert system.rulebase is not None
    assert (system.name, system.library, diagnostics) == ("engine", "pyfuzzylite", ())
    script(folder, "1 / 0", "bad.py")
    with pytest.raises(ScriptError, match=r"bad\.py: the script ends early") as caught:
        read_script("bad.py")
    assert [(d.name, d.line) for d in caught.value.diagnostics] == [("failed-script", 1)]
