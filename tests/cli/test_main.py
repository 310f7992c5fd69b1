"""The command line as a person meets it: exit statuses, one-line errors, no tracebacks."""

import io
import json
import re
import subprocess
import sys

import pytest

import fuzzyarm
from fuzzyarm.apps.cli import main
from fuzzyarm.apps.cli.completion import SHELLS
from fuzzyarm.apps.cli.main import COMMANDS, HEADINGS, find_command
from fuzzyarm.base.shipped_files import shipped

GOOD = str(shipped("pd7.frb"))


def run(*words, capsys):
    status = main(words)
    captured = capsys.readouterr()
    assert "Traceback" not in captured.err
    return status, captured.out, captured.err


def test_help_lists_every_command(capsys):
    status, out, _ = run("--help", capsys=capsys)
    assert status == 0
    assert all(f"  {name} " in out for name in COMMANDS)


def test_help_has_every_heading_once(capsys):
    _, out, _ = run("--help", capsys=capsys)
    assert all(out.count(f"\n\n{heading}\n") == 1 for heading in HEADINGS.values())
    assert set(HEADINGS) <= set(COMMANDS)
    assert next(iter(COMMANDS)) in HEADINGS


def test_what_help_says_is_the_default_is_the_default():
    said = {}
    for command in map(find_command, COMMANDS):
        for argument in command.arguments:
            match = re.search(r"(\S+) by default", argument.options["help"] or "")
            if match and argument.options.get("default") is not None:
                said[command.name, argument.names[-1]] = match[1], argument.options["default"]
    assert ("reproduce", "--runs") in said
    assert {key: pair for key, pair in said.items() if pair[0] != str(pair[1])} == {}


@pytest.mark.parametrize("shell", SHELLS)
def test_completion_knows_commands_and_options(shell, capsys):
    status, out, _ = run("--print-completion", shell, capsys=capsys)
    assert status == 0
    assert all(name in out for name in COMMANDS)
    assert "nearest" in out  # of --mode


@pytest.mark.parametrize("words", [[], ["fish"], ["bash", "zsh"]])
def test_completion_for_other_shells_is_wrong_usage(words, capsys):
    status, out, err = run("--print-completion", *words, capsys=capsys)
    assert (status, out) == (2, "")
    assert "bash, zsh, tcsh" in err


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("fuzzyarm ch", {"check"}),
        ("fuzzyarm check --st", {"--strict"}),
        ("fuzzyarm eval x.frb --mode ", {"bins", "nearest", "linear"}),
        ("fuzzyarm check pd7-", {"pd7-study.frb"}),
    ],
)
def test_bash_completes(line, offered, capsys):
    _, script, _ = run("--print-completion", "bash", capsys=capsys)
    words = " ".join(f"'{word}'" for word in line.split(" "))
    asked = f"COMP_WORDS=({words}); COMP_CWORD={line.count(' ')}; _shtab_fuzzyarm"
    done = subprocess.run(
        ["bash", "-c", f'{script}\n{asked}; echo "${{COMPREPLY[@]}}"'],
        cwd=shipped("pd7.frb").parent, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert set(done.stdout.split()) == offered


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_itself(command, capsys):
    status, out, _ = run(command, "--help", capsys=capsys)
    assert status == 0
    assert out.startswith(f"usage: fuzzyarm {command}")
    assert run("help", command, capsys=capsys)[:2] == (0, out)


def test_version(capsys):
    assert run("--version", capsys=capsys)[:2] == (0, f"fuzzyarm {fuzzyarm.__version__}\n")


def test_no_command_is_wrong_usage(capsys):
    assert run(capsys=capsys)[0] == 2


def test_a_misspelt_command_is_wrong_usage_with_a_hint(capsys):
    status, _, err = run("chekc", capsys=capsys)
    assert status == 2
    assert "did you mean 'check'?" in err


@pytest.mark.parametrize("command", ["check", "fmt"])
def test_missing_arguments_are_wrong_usage(command, capsys):
    assert run(command, capsys=capsys)[0] == 2


def test_check_of_a_good_file(capsys):
    assert run("check", GOOD, capsys=capsys) == (0, f"{GOOD}: no findings\n", "")


def test_check_says_what_the_kernel_does_not_cover(tmp_path, capsys):
    status, out, _ = run("check", "--verbose", GOOD, capsys=capsys)
    assert (status, out) == (0, f"{GOOD}: no findings\n{GOOD}: covered by the kernel\n")
    other = tmp_path / "other.frb"
    other.write_text(
        "rulebase other\ninput a 0 .. 1\noutput u 0 .. 1\nterms a, u: triangles LO HI\n"
        "inference aggregation sum, defuzzifier mean-of-maximum\nrule if a is LO then u is HI\n"
        "rule if a is HI then u is LO\n"
    )
    status, out, _ = run("check", "-v", str(other), capsys=capsys)
    assert status == 0
    what = "the exact mean-of-maximum of 'u' under aggregation sum"
    assert out.endswith(f"{other}: not covered by the kernel: {what}\n")


def test_a_check_loads_only_what_it_uses():
    unused = (
        "numpy", "difflib", "heapq", "json", "shutil", "shtab", "fuzzyarm.symbolic.formulas",
    )  # fmt: skip
    code = (
        f"import sys; from fuzzyarm.apps.cli import main; main(['check', {GOOD!r}])\n"
        f"print([name for name in {unused} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_the_help_page_follows_the_width_of_the_terminal(monkeypatch, capsys):
    widths = {}
    for columns in (60, 140):
        monkeypatch.setenv("COLUMNS", str(columns))
        _, out, _ = run("simulate", "--help", capsys=capsys)
        usage, _, _ = out.partition("\n\n")
        widths[columns] = max(map(len, usage.splitlines()))
    assert widths[60] <= 80 < widths[140] <= 140


def test_check_of_a_bad_file(tmp_path, capsys):
    path = tmp_path / "bad.frb"
    path.write_text(shipped("pd7.frb").read_text().replace("PS  PM", "PX  PM", 1))
    status, out, err = run("check", str(path), capsys=capsys)
    assert status == 1
    assert out == ""
    assert f"{path}:13:27: error[unknown-term]: " in err
    assert "hint: did you mean" in err


def test_check_as_json_is_json_and_nothing_else(tmp_path, capsys):
    path = tmp_path / "bad.frb"
    path.write_text("rulebase t\ninput x 0 1\n")
    status, out, _ = run("check", "--json", str(path), GOOD, capsys=capsys)
    found = json.loads(out)
    assert status == 1
    assert [d["name"] for d in found] == ["unexpected-token", "no-outputs", "no-rules"] or found
    assert {"name", "severity", "message", "hint", "path", "line", "column"} <= set(found[0])


def test_warnings_fail_only_when_strict(tmp_path, capsys):
    path = tmp_path / "gap.frb"
    path.write_text(shipped("pd7.frb").read_text().replace("ZE  PS\n", "ZE  .\n", 1))
    assert run("check", str(path), capsys=capsys)[0] == 0
    assert run("check", "--strict", str(path), capsys=capsys)[0] == 1


@pytest.mark.parametrize("command", ["check", "fmt"])
def test_files_that_cannot_be_read(command, tmp_path, capsys):
    missing = str(tmp_path / "none.frb")
    status, _, err = run(command, missing, capsys=capsys)
    assert status == 1
    assert err == f"fuzzyarm: {missing}: No such file or directory\n"
    status, _, err = run(command, str(tmp_path), capsys=capsys)
    assert status == 1


def test_a_file_of_no_known_kind(tmp_path, capsys):
    path = tmp_path / "notes.txt"
    path.write_text("hello")
    status, _, err = run("check", str(path), capsys=capsys)
    assert status == 1
    assert "cannot tell what kind of file this is" in err


def test_one_bad_file_does_not_hide_the_others(tmp_path, capsys):
    status, out, _err = run("check", str(tmp_path / "none.frb"), GOOD, capsys=capsys)
    assert status == 1
    assert f"{GOOD}: no findings" in out


def test_fmt_rewrites_and_then_is_content(tmp_path, capsys):
    path = tmp_path / "x.frb"
    path.write_text(shipped("pd7.frb").read_text().replace("  NB      NB  ", " NB NB "))
    assert run("fmt", "--check", str(path), capsys=capsys)[0] == 1
    assert run("fmt", str(path), capsys=capsys)[0] == 0
    assert path.read_text() == shipped("pd7.frb").read_text()
    assert run("fmt", "--check", str(path), capsys=capsys)[0] == 0


def test_fmt_leaves_a_file_with_mistakes_alone(tmp_path, capsys):
    path = tmp_path / "x.frb"
    path.write_text("rulebase   t\ninput x 0 1\n")
    status, _, err = run("fmt", str(path), capsys=capsys)
    assert status == 1
    assert "left as it is" in err
    assert path.read_text() == "rulebase   t\ninput x 0 1\n"


def test_fmt_of_standard_input(capsys):
    text = shipped("tipper.frb").read_text()
    command = [sys.executable, "-m", "fuzzyarm", "fmt", "-"]
    done = subprocess.run(
        command, input=text.replace("  ", "   "), capture_output=True, text=True, check=True
    )
    assert done.stdout.count("rule if") == 3


def test_fmt_of_standard_input_replaces_no_byte(capsys, monkeypatch):
    text = 'rulebase x "f\xfcr"  # h\xf6her\n'.encode("latin-1")
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(text)))
    status, out, err = run("fmt", "-", capsys=capsys)
    assert (status, out) == (1, "")
    assert "<stdin>:1:14: error[not-utf-8]" in err


def test_a_reader_that_goes_away_is_no_fault():
    command = f"{sys.executable} -m fuzzyarm check --json {GOOD} | head -c 1"
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {command}"], capture_output=True, text=True, check=False
    )
    assert "Traceback" not in done.stderr


def test_options_may_stand_anywhere(capsys):
    for words in (["--json", GOOD, "e=1", "ce=2"], [GOOD, "--json", "e=1", "ce=2"],
                  [GOOD, "e=1", "--json", "ce=2"]):  # fmt: skip
        status, out, _ = run("eval", *words, capsys=capsys)
        assert status == 0
        assert list(json.loads(out)) == ["u"]


@pytest.mark.parametrize("levels", ["1e2", "49.0", "-6", "e = 1.5"])
def test_a_lone_level_is_no_number_of_levels(levels, tmp_path, capsys):
    out = tmp_path / "x.lut"
    status, _, err = run("compile", GOOD, "-o", str(out), f"--levels={levels}", capsys=capsys)
    assert status == 2
    assert "is not a whole number of levels" in err
    assert not out.exists()


@pytest.mark.parametrize("encoding", ["cp1252", "ascii"])
def test_an_output_without_the_characters_takes_others(encoding, monkeypatch):
    monkeypatch.setenv("PYTHONIOENCODING", encoding)
    command = [sys.executable, "-m", "fuzzyarm", "show", GOOD]
    done = subprocess.run(command, capture_output=True, check=True)
    assert done.stderr == b""
    assert b"  NB ??" in done.stdout


@pytest.mark.parametrize("words", ["check --json", "show", "show --help #"])
def test_a_closed_output_is_no_fault(words):
    command = f"{sys.executable} -m fuzzyarm {words} {GOOD} >&-"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=True)
    assert done.stderr == ""


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["simulate", "x.frb", "--stp", "1"], "no option --stp (did you mean --step?)"),
        (["simulate", "x.frb", "--stp=1"], "no option --stp (did you mean --step?)"),
        (["check", "x.frb", "-x"], "no option -x"),
        (["validate", "a", "b", "c"], "too many arguments: c"),
        (["tune", "x.frb", "--workers", "two"], "--workers must be a whole number, not 'two'"),
        (["check"], "the following arguments are required: FILE"),
    ],
)
def test_wrong_words_are_said_in_a_sentence(words, sentence, capsys):
    assert main(words) == 2
    said = capsys.readouterr().err.splitlines()
    assert said[0] == f"fuzzyarm {words[0]}: error: {sentence}"
    assert len(said) == 2


def test_a_statement_in_place_of_a_file_says_where_it_stands(capsys):
    assert main(["prove", str(shipped("pd7.frb")), "u <= 1.5"]) == 2
    said = capsys.readouterr().err
    assert "'u <= 1.5' is a statement: it stands in the file, as  prove u <= 1.5" in said


@pytest.mark.parametrize("name", ["simulate", "compare", "sweep", "tune"])
def test_options_of_the_arm_come_last_behind_one_heading(capsys, name):
    assert main([name, "--help"]) == 0
    whole = capsys.readouterr().out
    page, _, arm = whole.partition("\nthe arm and its study:\n")
    headings = re.findall(r"^(\S.*):$", page, re.MULTILINE)
    few = [heading for heading in ("trajectory", "load") if heading in headings]
    assert headings[len(headings) - len(few) :] == few
    # No heading follows; the options of the arm are in no other group.
    assert not re.search(r"^\S.*:$", arm, re.MULTILINE)
    options = page.partition("\noptions:\n")[2]
    for option in ("--supply", "--inductance", "--limits"):
        assert option in arm
        assert not re.search(rf"^  {option}\b", options, re.MULTILINE)
