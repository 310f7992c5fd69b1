"""Which files of a folder are somebody's own; an oracle is git itself."""

import subprocess

from needs import requires

from fuzzyarm.apps.cli.main import main
from fuzzyarm.base.folders import own_files
from fuzzyarm.base.shipped_files import shipped

RULES = shipped("pd7.frb").read_text(encoding="utf-8")


def write(folder, *names, text=RULES):
    for name in names:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def found(folder):
    return [str(path)[len(str(folder)) + 1 :] for path in own_files(str(folder))]


def test_hidden_files_environments_and_packages_are_left_out(tmp_path):
    write(tmp_path, "a.frb", "sub/b.frb", ".hidden.frb", ".cache/c.frb", "node_modules/d.frb")
    write(tmp_path, ".venv/lib/e.frb", "env/lib/f.frb", "env/pyvenv.cfg", "x/__pycache__/g.frb")
    assert found(tmp_path) == ["a.frb", "sub/b.frb"]
    # Itself a folder is taken, whatever it is called.
    assert found(tmp_path / ".cache") == ["c.frb"]


def test_a_link_to_a_folder_above_does_not_go_on_for_ever(tmp_path):
    write(tmp_path, "a.frb", "sub/b.frb")
    (tmp_path / "sub" / "again").symlink_to(tmp_path, target_is_directory=True)
    assert found(tmp_path) == ["a.frb", "sub/b.frb"]


IGNORED = """\
# what is built
build/
*.tmp.frb
!kept.tmp.frb
/top.frb
deep/**/x.frb
some/where/
old?.frb
[abc].frb
two words.frb
\\#odd.frb
logs/*.frb
**/any/y.frb
end/**
"""

NAMES = [
    "build/a.frb", "sub/build/a.frb", "builds/a.frb", "one.tmp.frb", "kept.tmp.frb",
    "sub/two.tmp.frb", "top.frb", "sub/top.frb", "deep/x.frb", "deep/er/x.frb",
    "deep/er/and/x.frb", "deep/y.frb", "some/where/z.frb", "sub/some/where/z.frb", "old1.frb",
    "old12.frb", "a.frb", "d.frb", "two words.frb", "#odd.frb", "logs/l.frb", "logs/more/l.frb",
    "any/y.frb", "sub/any/y.frb", "sub/any/more/y.frb", "end/e.frb", "end/more/e.frb",
    "inner/left.frb", "inner/in.frb", "inner/deeper/left.frb",
]  # fmt: skip


@requires("git")
def test_what_git_leaves_out_is_left_out(tmp_path):
    write(tmp_path, *NAMES)
    (tmp_path / ".gitignore").write_text(IGNORED)
    (tmp_path / "inner" / ".gitignore").write_text("left.frb\n")
    subprocess.run(["git", "init", "-q", "."], cwd=tmp_path, check=True)
    said = subprocess.run(
        ["git", "-c", "core.quotePath=off", "ls-files", "--others", "--exclude-standard"],
        cwd=tmp_path, check=True, capture_output=True, text=True,
    )  # fmt: skip
    kept = sorted(name for name in said.stdout.splitlines() if name.endswith(".frb"))
    assert 8 < len(kept) < len(NAMES)
    assert sorted(found(tmp_path)) == kept
    # Of a folder inside, the patterns above it count as well.
    inside = sorted(n.removeprefix("sub/") for n in kept if n.startswith("sub/"))
    assert sorted(found(tmp_path / "sub")) == inside


def test_patterns_above_count_in_a_repository_only(tmp_path):
    write(tmp_path, "in/a.frb")
    (tmp_path / ".gitignore").write_text("a.frb\n")
    assert found(tmp_path / "in") == ["a.frb"]
    (tmp_path / ".git").mkdir()
    assert found(tmp_path / "in") == []


# --- check ---

FML = '<?xml version="1.0"?>\n<!-- <html> -->\n<fuzzySystem name="x"></fuzzySystem>\n'


def test_check_of_a_folder_leaves_alone_what_is_not_its_own(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write(tmp_path, "a.frb")
    write(tmp_path, ".venv/pyvenv.cfg", ".venv/x.frb", ".idea/misc.xml", text="nonsense")
    write(tmp_path, "pom.xml", text="<project><fuzzySystem/></project>")
    write(tmp_path, "page.xml", text="<!DOCTYPE html>\n<html></html>")
    write(tmp_path, "broken.xml", text="nonsense")
    assert main(["check", "."]) == 0
    assert capsys.readouterr().out.splitlines() == ["./a.frb: no findings"]
    write(tmp_path, "theirs.xml", text=FML)
    assert main(["check", "."]) == 1
    assert "theirs.xml" in capsys.readouterr().err
    # What is named is checked.
    assert main(["check", "pom.xml"]) == 1


def test_a_folder_with_foreign_files_alone_says_that_it_is_empty(tmp_path, capsys):
    write(tmp_path, "pom.xml", ".hidden/a.frb", text="<project/>")
    assert main(["check", str(tmp_path)]) == 1
    assert "no files to check in this folder" in capsys.readouterr().err
