"""What a command reads is never written over by its results."""

import shutil
from pathlib import Path

import pytest

from fuzzyarm.apps.cli.main import main
from fuzzyarm.base.files import write_atomically
from fuzzyarm.base.protected import SourceFileError, note_source, sources_kept

ROOT = Path(__file__).parents[2]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "rulebases/pd7.frb", "rules.frb")
    shutil.copy(ROOT / "rulebases/servo.frb", "servo.frb")
    return tmp_path


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        ["simulate", "servo.frb", "--plant", "motor", "--for", "20ms", "--csv", "servo.frb"],
        ["sweep", "servo.frb", "--plant", "motor", "--random", "2", "-o", "servo.frb"],
        ["prove", "servo.frb", "--plant", "motor", "--stable", "--certificate", "servo.frb"],
        ["fit", "rules.frb", "-o", "rules.frb", "--terms", "3,3"],
    ],
    ids=lambda words: words[0],
)  # fmt: skip
def test_a_result_is_not_written_over_its_source(folder, capsys, words):
    name = words[-1] if words[-1].endswith(".frb") else "rules.frb"
    before = Path(name).read_bytes()
    assert main(words) == 1  # for two reasons, of which one is left with --force
    capsys.readouterr()
    assert main([*words, "--force"]) == 1
    assert f"{name} is not written: this command reads it" in capsys.readouterr().err
    assert Path(name).read_bytes() == before


def test_a_tuned_controller_is_not_written_over_rules_that_it_uses(folder, capsys):
    for name in ("fuzzy-direct.frb", "pd7-study.frb"):  # the rules stay as they are
        shutil.copy(ROOT / "rulebases" / name, name)
    before = Path("pd7-study.frb").read_bytes()
    words = ["tune", "fuzzy-direct.frb", "--evals", "3", "--journal", "trials", "--force", "-o"]
    assert main([*words, "pd7-study.frb"]) == 1
    assert "pd7-study.frb is not written" in capsys.readouterr().err
    assert Path("pd7-study.frb").read_bytes() == before
    assert not Path("trials").exists()  # it was refused before the search


def test_a_learned_table_is_not_written_over_the_performance_table(folder, capsys):
    for name in ("soc-zero.frb", "performance-yamazaki.lut"):
        shutil.copy(ROOT / "rulebases" / name, name)
    before = Path("performance-yamazaki.lut").read_bytes()
    assert main(["learn", "soc-zero.frb", "--force", "-o", "performance-yamazaki.lut"]) == 1
    message = capsys.readouterr().err
    assert message.startswith("fuzzyarm: performance-yamazaki.lut is not written: this command")
    assert "cannot read" not in message
    assert Path("performance-yamazaki.lut").read_bytes() == before


def test_links_to_a_source_are_that_source(tmp_path):
    source, link = tmp_path / "a.csv", tmp_path / "b.csv"
    source.write_text("1\n")
    link.symlink_to(source)
    with sources_kept():
        note_source(source)
        with pytest.raises(SourceFileError, match=r"b\.csv"):
            write_atomically(link, "2\n")
        write_atomically(tmp_path / "c.csv", "3\n")
    write_atomically(link, "4\n")
    assert source.read_text() == "4\n"


def copies(folder, *names):
    for name in names:
        shutil.copy(ROOT / "rulebases" / name, folder / name)


def hard(source, link):
    Path(link).hardlink_to(source)


def soft(source, link):
    Path(link).symlink_to(source)


@pytest.mark.parametrize("made", [hard, soft])
@pytest.mark.parametrize(
    ("words", "option", "suffix", "kept"),
    [
        ("compile rules.frb", "-o", ".h", "rules.frb"),
        ("compile servo.frb", "-o", ".c", "servo.frb"),
        ("plot rules.frb", "-o", ".svg", "rules.frb"),
        ("convert rules.frb", "", ".fis", "rules.frb"),
        ("watch rules.frb --once", "--table", ".lut", "rules.frb"),
        ("watch rules.frb --once", "--figure", ".png", "rules.frb"),
        ("learn soc-zero.frb --passes 1 --segment 0.05 --hold 0.02", "-o", ".lut",
         "performance-yamazaki.lut"),
        ("tune fuzzy-direct.frb --evals 3", "-o", ".frb", "pd7-study.frb"),
    ],
)  # fmt: skip
def test_another_name_of_a_source_is_that_source(folder, made, words, option, suffix, kept):
    copies(folder, "soc-zero.frb", "performance-yamazaki.lut", "fuzzy-direct.frb", "pd7-study.frb")
    before = Path(kept).read_bytes()
    made(kept, f"other{suffix}")
    assert main([*words.split(), *filter(None, [option]), f"other{suffix}"]) == 1
    assert Path(kept).read_bytes() == before


def test_a_table_by_which_a_controller_learns_is_not_what_it_learned(folder, capsys):
    copies(folder, "soc-zero.frb", "performance-yamazaki.lut")
    before = Path("performance-yamazaki.lut").read_bytes()
    words = "learn soc-zero.frb --passes 1 --segment 0.05 --hold 0.02 -o performance-yamazaki.lut"
    assert main(words.split()) == 1
    assert "performance-yamazaki.lut is not written" in capsys.readouterr().err
    assert Path("performance-yamazaki.lut").read_bytes() == before


@pytest.mark.slow
def test_a_file_that_is_tuned_in_place_is_written(folder):
    before = Path("servo.frb").read_bytes()
    shutil.copy(ROOT / "rulebases/pd7.frb", "pd7.frb")
    words = "tune servo.frb --plant motor --for 50ms --evals 5 --seed 2 -o servo.frb"
    assert main(words.split()) == 0
    assert Path("servo.frb").read_bytes() != before


def test_watch_once_tells_by_its_status_that_a_table_is_not_written(folder, capsys):
    Path("x.lut").mkdir()
    assert main(["watch", "rules.frb", "--once", "--table", "x.lut"]) == 1
    assert "x.lut: not written" in capsys.readouterr().out
