"""No command replaces a file that fuzzyarm did not write, unless it is told to."""

import shutil
import zipfile
from pathlib import Path

import numpy as np
import pytest

from fuzzyarm.apps.cli.main import COMMANDS, find_command, main
from fuzzyarm.base.protected import is_made_file
from fuzzyarm.table import read_table

ROOT = Path(__file__).parents[2]
FILES = ("pd7.frb", "servo.frb", "tipper.frb", "soc-zero.frb", "thesis-6.1.lut")

FILE_LIKE = ("FILE", "OUT", "FIG", "DIR", "PAGE", "FILE.csv", "FILE.frb")
"""What the value of an option is called on the help page where it is a file."""

READ = frozenset({
    ("simulate", "--rulebase"), ("simulate", "--alpha"), ("simulate", "--table"),
    ("simulate", "--performance"), ("sweep", "--rulebase"), ("sweep", "--alpha"),
    ("sweep", "--table"), ("sweep", "--performance"), ("tune", "--data"), ("tune", "--test"),
    ("fit", "--test"), ("new", "--around"),
})  # fmt: skip
"""Options that name a file to read."""

FOLDERS = frozenset({
    ("demo", "--keep"), ("playground", "-o"), ("shipped", "-o"), ("compile", "--report"),
    ("convert", "-o"), ("reproduce", "--plot"),
})  # fmt: skip
"""Options that name a folder; each of its files is looked at, or it has a list of its own."""

OF_RULES = ("lut", "csv", "npz", "json", "tex", "h", "c", "st", "xml", "scl", "py", "mjs")
RUN = "--plant motor --for 20ms"
SAMPLES = "\n".join(f"{x / 10},{y / 10},{x * y / 100}" for x in range(10) for y in range(10))

WRITTEN = {
    ("compile", "-o"): [
        *(f"compile pd7.frb -o o.{x}" for x in OF_RULES),
        *(f"compile thesis-6.1.lut -o o.{x}" for x in OF_RULES[:6]),
        "compile servo.frb -o o.c", "compile servo.frb -o o.st", "compile servo.frb -o o.py",
        "compile servo.frb -o o.fmu",
    ],
    ("convert", "OUT"): [
        *(f"convert tipper.frb o.{x}" for x in ("fis", "fll", "fcl", "fml")),
        "convert tipper.fis o.frb",
    ],
    ("plot", "-o"): [f"plot pd7.frb -o o.{x}" for x in ("png", "svg", "pdf")],
    ("simulate", "-o"): [f"simulate servo.frb {RUN} --sweep J=0.01..0.02:2 -o o.csv"],
    ("simulate", "--csv"): [f"simulate servo.frb {RUN} --csv o.csv"],
    ("simulate", "--animate"): [
        f"simulate servo.frb {RUN} --animate o.{x}" for x in ("gif", "html")
    ],
    ("simulate", "--plot"): [f"simulate servo.frb {RUN} --plot o.png"],
    ("eval", "--plot"): ["eval pd7.frb e=1 ce=1 --plot o.png"],
    ("sweep", "--plot"): [f"sweep servo.frb {RUN} --sweep J=0.01..0.02:3 --plot o.png"],
    ("compare", "--plot"): [f"compare servo.frb other.frb {RUN} --plot o.png"],
    ("learn", "--plot"): [
        "learn soc-zero.frb --passes 1 --segment 0.05 --hold 0.02 --plot o.png"
    ],
    ("tune", "--plot"): [f"tune servo.frb {RUN} --evals 3 --plot o.png"],
    ("prove", "--plot"): ["prove servo.frb --plant motor --stable --plot o.png"],
    ("margins", "--plot"): ["margins servo.frb --plot o.png"],
    ("validate", "--plot"): ["validate model.frb samples.csv --plot o.png"],
    ("reproduce", "--overview"): ["reproduce 4.2.5.1/pd --runs 0 --overview o.png"],
    ("sweep", "-o"): [f"sweep servo.frb {RUN} --sweep J=0.01..0.02:3 -o o.csv"],
    ("learn", "-o"): ["learn soc-zero.frb --passes 1 --segment 0.05 --hold 0.02 -o o.lut"],
    ("learn", "--animate"): [
        "learn soc-zero.frb --passes 1 --segment 0.02 --hold 0.01 --animate o.gif"
    ],
    ("tune", "-o"): [f"tune servo.frb {RUN} --evals 3 -o o.frb"],
    ("tune", "--journal"): [f"tune servo.frb {RUN} --evals 3 --journal o.csv"],
    ("fit", "-o"): ["fit samples.csv --terms 2,2 -o o.frb"],
    ("prove", "--certificate"): [
        "prove servo.frb --plant motor --stable --certificate o.json"
    ],
    ("watch", "--table"): ["watch pd7.frb --once --table o.lut"],
    ("watch", "--figure"): ["watch pd7.frb --once --figure o.png"],
}  # fmt: skip
"""Calls that write o.SUFFIX, by command and option."""

ONCE = ("tune", "--journal")
"""A journal is never replaced: it is resumed, or removed by hand."""


def test_every_option_that_names_a_file_is_known_to_read_or_to_write():
    found = set()
    for name in COMMANDS:
        for argument in find_command(name).arguments:
            option = argument.names[0]
            if option.startswith("-") and argument.options.get("metavar") in FILE_LIKE:
                found.add((name, option))
    assert sorted(found - READ - FOLDERS - WRITTEN.keys()) == []


def test_what_writes_files_offers_force_on_its_help_page():
    written = {command for command, _ in WRITTEN.keys() | FOLDERS} - {"demo"}
    offered = {
        name
        for name in COMMANDS
        if any("--force" in argument.names for argument in find_command(name).arguments)
    }
    assert offered == written | {"new"}
    assert all("--force" in find_command(name).parser().format_help() for name in offered)


@pytest.fixture(scope="module")
def filled(tmp_path_factory):
    """A folder with a file of each kind."""
    folder = tmp_path_factory.mktemp("people")
    for name in FILES:
        shutil.copy(ROOT / "rulebases" / name, folder)
    shutil.copy(folder / "servo.frb", folder / "other.frb")
    (folder / "samples.csv").write_text(f"x,y,z\n{SAMPLES}\n")
    assert main(["convert", str(folder / "tipper.frb"), str(folder / "tipper.fis")]) == 0
    samples, model = folder / "samples.csv", folder / "model.frb"
    assert main(["fit", str(samples), "--terms", "2,2", "-o", str(model)]) == 0
    return folder


@pytest.fixture
def folder(filled, tmp_path, monkeypatch):
    shutil.copytree(filled, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.slow
@pytest.mark.parametrize("where", WRITTEN, ids=" ".join)
def test_a_file_of_a_person_is_replaced_with_force_only(folder, capsys, where):
    for words in WRITTEN[where]:
        if ".fmu" in words and shutil.which("cc") is None:
            continue
        out = next(word for word in words.split() if word.startswith("o."))
        theirs = b"what a person wrote\n"
        Path(out).write_bytes(theirs)
        assert main(words.split()) == 1, words
        said = "".join(capsys.readouterr())
        assert f"{out} is not replaced: fuzzyarm did not write it" in said or where == ONCE, words
        assert Path(out).read_bytes() == theirs, words
        if where == ONCE:
            Path(out).unlink()
        assert main([*words.split(), "--force"]) == 0, words
        assert Path(out).read_bytes() != theirs, words
        # What fuzzyarm wrote is replaced without a word about it: of tables it is done, too.
        assert where == ONCE or is_made_file(out), words
        assert where != ("learn", "-o") or main(words.split()) == 0
        Path(out).unlink()


@pytest.mark.slow
def test_marks_leave_formats_as_they_are(folder):
    for name in ("o.lut", "o.csv", "o.json", "o.npz"):
        assert main(["compile", "thesis-6.1.lut", "-o", name]) == 0
        table, same = read_table("thesis-6.1.lut"), read_table(name)
        assert np.array_equal(table.values, same.values)
    assert zipfile.ZipFile("o.npz").testzip() is None
    assert main(f"simulate servo.frb {RUN} --animate o.gif".split()) == 0
    from PIL import Image

    with Image.open("o.gif") as picture:
        assert picture.n_frames > 1
        picture.seek(picture.n_frames - 1)
        picture.load()


def test_what_is_tuned_in_place_stays_a_file_of_a_person(folder):
    words = f"tune servo.frb {RUN} --evals 3 -o servo.frb"
    assert main(words.split()) == 0
    assert "Written by fuzzyarm" not in Path("servo.frb").read_text()


def test_o_without_a_sweep_names_the_option_for_samples(folder, capsys):
    assert main(f"simulate servo.frb {RUN} -o o.csv".split()) == 2
    assert "--csv FILE writes the samples" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["check", "show", "compile -o x.lut", "prove", "designer"])
def test_a_mistyped_file_gets_the_nearest_one(folder, capsys, command):
    assert main([*command.split(), "pd6.frb"]) == 1
    assert "did you mean 'pd7.frb'?" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize("theirs", ["what a person wrote\n", "made by fuzzyarm, from b.frb"])
def test_of_a_pair_nothing_is_written_where_its_other_file_is_not_replaced(folder, capsys, theirs):
    Path("o.h").write_text(theirs)
    if "made" in theirs:
        shutil.copy("tipper.frb", "b.frb")
        assert main(["compile", "b.frb", "-o", "o.h", "--force"]) == 0
        theirs = Path("o.h").read_text()
    for model in ("pd7.frb", "servo.frb"):
        assert main(["compile", model, "-o", "o.c"]) == 1
        why = "it was made of b.frb" if "b.frb" in theirs else "fuzzyarm did not write it"
        assert f"o.h is not replaced: {why} (--force replaces it)" in capsys.readouterr().err
        assert Path("o.h").read_text() == theirs
        assert not Path("o.c").exists()
    assert main(["compile", "pd7.frb", "-o", "o.c", "--force"]) == 0
    assert main(["compile", "pd7.frb", "-o", "o.c"]) == 0


def test_a_demo_keeps_the_files_of_its_folder(tmp_path, capsys):
    theirs = tmp_path / "servo.frb"
    theirs.write_text("what a person wrote\n")
    assert main(["demo", "--keep", str(tmp_path)]) == 1
    assert "servo.frb already exists (--keep names a new folder)" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["servo.frb"]
    assert theirs.read_text() == "what a person wrote\n"
