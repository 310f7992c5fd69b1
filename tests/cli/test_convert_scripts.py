"""`fuzzyarm convert project.py`: scripts that make systems, and scripts that do anything else.

The scripts import a stand-in for pyfuzzylite, which loads at once.
"""

from __future__ import annotations

import io
import json
import shutil
import sys
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
import matplotlib
matplotlib.use("TkAgg")
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
    assert main(["convert", name, "-o", "out", "--run"]) == 1
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
        ("x = input('x? ')\n", "no fuzzy system found", "input() was answered with 1, 1 time"),
        (
            "while True:\n    input()\n",
            "the script ends with EOFError: input() was answered often enough",
            "write the value into the script",
        ),
        ("import no_such_module\n", "no fuzzy system found", "took the place of no_such_module"),
        (
            "import skfuzzy.nothing\n",
            "ModuleNotFoundError: No module named 'skfuzzy.nothing'",
            "1 |",
        ),
        (
            "import argparse\np = argparse.ArgumentParser()\np.add_argument('a')\np.parse_args()\n",
            "the script ends with SystemExit: 2",
            "--call NAME",
        ),
        ("while True:\n    pass\n", "the script has not ended within 1 s", "--seconds"),
        ("print('nothing')\n", "no fuzzy system found", "a ControlSystem of scikit-fuzzy"),
        ("import os\nos._exit(7)\n", "its process ended with status 7", ""),
    ],
)
def test_scripts_that_make_nothing(
    text: str, finding: str, line: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    seconds = "1" if "while True" in text else "60"
    assert main(["convert", script(folder, text), "--run", "--seconds", seconds]) == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    assert finding in printed.err
    assert line in printed.err
    assert not list(folder.glob("*.frb"))


@pytest.mark.slow
def test_what_a_script_has_made_by_the_end_of_its_time(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = "from fuzzylite import Engine\nengine = Engine('one')\nwhile True: pass\n"
    words = ["convert", script(folder, text), "--run", "--seconds", "1"]
    assert main([*words, "--strict"]) == 1
    assert "error[endless-script]" in capsys.readouterr().err
    assert main(words) == 0
    assert "within 1 s; what it had made by then is taken" in capsys.readouterr().out
    assert load_rulebase(folder / "engine.frb").name == "one"


def test_a_script_that_catches_every_interrupt(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = "from fuzzylite import Engine\nengine = Engine('one')\nwhile True:\n"
    text += "    try:\n        [0] * 9\n    except BaseException:\n        pass\n"
    assert main(["convert", script(folder, text), "--run", "--seconds", "1"]) == 0
    assert "warning[endless-script]" in capsys.readouterr().out


def test_what_had_computed_before_a_script_failed(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = "from fuzzylite import Engine\nused, unused = Engine('one'), Engine('two')\n"
    text += "used.process()\nprint(1 / 0)\n"
    words = ["convert", script(folder, text), "--run"]
    assert main(words) == 0
    said = capsys.readouterr().out
    assert "ends with ZeroDivisionError: division by zero; what it had made by then" in said
    assert "unused had not computed anything before that and may lack rules; left out" in said
    assert [path.name for path in folder.glob("*.frb")] == ["used.frb"]
    assert main([*words, "--lossy", "--force"]) == 0
    assert {path.name for path in folder.glob("*.frb")} == {"used.frb", "unused.frb"}


ONE = "from fuzzylite import Engine\nengine = Engine('one', slope=2)\n"


def test_a_script_is_not_run_unasked(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    name = script(folder, "open('trace', 'w').close()\n" + ONE)
    assert main(["convert", name]) == 1
    assert "--run allows that" in capsys.readouterr().err
    assert not (folder / "trace").exists()

    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    monkeypatch.setattr(sys, "stderr", Terminal())
    monkeypatch.setenv("TERM", "dumb")
    for answer, done in (("n\n", False), ("", False), ("y\n", True)):
        monkeypatch.setattr(sys, "stdin", Terminal(answer))
        assert main(["convert", name]) == int(not done)
        assert (folder / "trace").exists() == done
    assert "with all your permissions" in sys.stderr.getvalue()  # type: ignore[attr-defined]


def test_files_that_are_there_are_left_alone(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = script(folder, ONE)
    (folder / "engine.frb").write_text("mine")
    assert main(["convert", name, "--run"]) == 1
    assert "engine.frb is not replaced: fuzzyarm did not write it" in capsys.readouterr().err
    assert (folder / "engine.frb").read_text() == "mine"
    assert main(["convert", name, "--run", "--force", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    (system,) = told["systems"]
    assert (system["name"], system["producer"], system["written"]) == (
        "engine", "pyfuzzylite", True,
    )  # fmt: skip
    assert [d["name"] for d in system["diagnostics"]][-1] == "same-numbers"
    # The file that was named is meant.
    (folder / "named.frb").write_text("old")
    assert main(["convert", name, "named.frb", "--run", "--force"]) == 0
    assert load_rulebase(folder / "named.frb").name == "one"


def test_a_slight_difference_is_refused_when_strict(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = script(folder, ONE.replace("slope=2", "slope=2, error=1e-3"))
    assert main(["convert", name, "--run", "--strict"]) == 1
    assert "error[numbers-differ]: 'y' differs by up to 0.0005" in capsys.readouterr().err
    assert not (folder / "engine.frb").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["none.py", "--run"], "none.py: No such file"),
        (["project.py", "x.fll", "--run"], "written as .frb only"),
        (["project.py", "x.frb", "--run"], "makes 2: a, b"),
        (["project.py", "--run", "--python", "none/python"], "no such folder: 'none'"),
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
    with pytest.raises(ScriptError, match=r"bad\.py: the script ends with an error") as caught:
        read_script("bad.py")
    assert [(d.name, d.line) for d in caught.value.diagnostics] == [("failed-script", 1)]


# ── what a script asks for ───────────────────────────────────────────────────────────

BUILDERS = """
from fuzzylite import Engine

def make(slope):
    return Engine("made", slope=slope)

class Fan:
    def __init__(self, name="fan"):
        self.engine = Engine(name, slope=3)

class Late:
    def build(self):
        self.found = {"one": [make(2)]}

def other():
    pass
"""


@pytest.mark.parametrize(
    ("call", "name", "slope"),
    [
        ("make", "make", 1.0),
        ("make(4)", "make", 4.0),
        ("Fan", "Fan_engine", 3.0),
        ("Late.build", "Late_object_found_one_1", 2.0),
    ],
)
def test_functions_and_classes_are_named_and_called(
    call: str, name: str, slope: float, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["convert", script(folder, BUILDERS), "--run"]
    assert main(words) == 1
    said = capsys.readouterr().err
    assert "--call NAME calls what would build one: make(slope), Fan(), Late.build()" in said
    assert "other" not in said
    assert main([*words, "--call", call]) == 0
    assert load_rulebase(folder / f"{name}.frb").outputs[0].high == slope


@pytest.mark.parametrize(
    ("call", "said"),
    [
        ("none", "'none' ends with NameError: the script has no 'none'"),
        ("make()", "'make()' ends with TypeError: make() missing 1 required positional argument"),
        ("make('x')", "make: error[unreadable-object]: the object cannot be read"),
    ],
)
def test_a_call_that_fails(
    call: str, said: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["convert", script(folder, BUILDERS), "--run", "--call", call]) == 1
    assert said in capsys.readouterr().err


WINDOW = """
from tkinter import *
import nobody_has_this.deep as nobody, numpy as np
from nobody_has_this import Thing, ThingError
from fuzzylite import Engine
engine = Engine("one")

class App(Frame):
    def __init__(self, root):
        super().__init__(root)
        self.button = Button(self, text="x", command=self.press)
        self.grid(row=0)
    def press(self):
        raise SystemExit(1)

@nobody.route("/x", methods=["GET"])
def answer():
    return 1

root = Tk()
App(root).pack(side=LEFT)
ok, picture = nobody.camera(0).read()
figure, (left, right) = nobody.subplots(1, 2)
while ok and nobody.is_open():
    pass
try:
    value = float(nobody.number) + len(nobody) + nobody[1] + sum(nobody.rows()) + nobody.x[3] * 2
except ThingError as error:
    value = 0
for each in Thing().events.get():
    pass
with nobody.opened("x") as file:
    file.write(f"{nobody.y:.2f}")
assert answer() == 1 and np.asarray(nobody.z).shape == ()
root.mainloop()
made = Engine("two")
"""


def test_stand_ins_for_windows_and_for_what_is_not_installed(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["convert", script(folder, WINDOW), "--run"]) == 0
    said = capsys.readouterr().out
    assert "warning[stand-in]: a stand-in that does nothing took the place of" in said
    assert "nobody_has_this, tkinter" in said
    assert {path.name for path in folder.glob("*.frb")} == {"engine.frb", "made.frb"}


def test_no_stand_in_where_a_library_asks(folder: Path) -> None:
    (folder / "site-packages").mkdir()
    (folder / "site-packages/lib.py").write_text(
        "try:\n    import nobody_has_this\nexcept ImportError:\n    nobody_has_this = None\n"
    )
    text = "import sys\nsys.path.insert(0, 'site-packages')\nimport lib\n"
    script(folder, text + "assert lib.nobody_has_this is None\n" + ONE)
    (system,), diagnostics = read_script("project.py")
    assert (system.name, diagnostics) == ("engine", ())


def test_answers_and_notebooks(folder: Path) -> None:
    text = "%matplotlib inline\n!pip install x\nslope = float(input('slope? '))\ndisplay(slope)\n"
    text += "get_ipython().run_line_magic('time', '')\nfrom fuzzylite import Engine\n"
    script(folder, text + "engine = Engine('one', slope=2 * slope)\n")
    (system,), diagnostics = read_script("project.py")
    assert system.rulebase is not None
    assert system.rulebase.outputs[0].high == 2.0
    assert [(d.name, str(d.severity)) for d in diagnostics] == [("answered-input", "warning")]


def test_a_script_that_computes_by_hand_is_told_so(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = "import skfuzzy as fuzz\nprint(fuzz.interp_membership([0, 1], [0, 1], 0.5))\n"
    assert main(["convert", script(folder, text), "--run"]) == 1
    assert "the script computes by itself, with interp_membership" in capsys.readouterr().err
