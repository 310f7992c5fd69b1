"""Every command writes to whatever output it is given, and no name reaches a terminal raw."""

import contextlib
import json
import os
import subprocess
import sys
import unicodedata

import pytest
from budget import crossed

from fuzzyarm.apps.cli import main
from fuzzyarm.apps.cli.main import COMMANDS
from fuzzyarm.base.shipped_files import shipped

PD7, TABLE = str(shipped("pd7.frb")), str(shipped("thesis-6.1.lut"))

# Every way to write a byte that a terminal might obey, and a mark that turns the direction.
HOSTILE = "\x1b[31m\x07\r\x00\x9b2J\u202e"
CR = "\r"  # ends a line
ESCAPED = "".join(f"\\u{ord(c):04x}" if not c.isprintable() else c for c in HOSTILE)
HOSTILE_FILE = f"""\
rulebase 'r{ESCAPED}' "d{ESCAPED}"
input 'x{ESCAPED}' 0 .. 10 "i{ESCAPED}"
output 'y{ESCAPED}' 0 .. 10 "o{ESCAPED}"
terms 'x{ESCAPED}', 'y{ESCAPED}': triangles 'L{ESCAPED}' 'H{ESCAPED}'
rule if 'x{ESCAPED}' is 'L{ESCAPED}' then 'y{ESCAPED}' is 'H{ESCAPED}'
block 'b{ESCAPED}'
rule if 'x{ESCAPED}' is 'H{ESCAPED}' then 'y{ESCAPED}' is 'L{ESCAPED}'  # {HOSTILE.replace(CR, "")}
"""


@pytest.fixture
def files(tmp_path, monkeypatch):
    """A folder with a sound, an untidy, a broken and a hostile rule base, and a broken table."""
    monkeypatch.chdir(tmp_path)
    text = shipped("pd7.frb").read_text()
    (tmp_path / "untidy.frb").write_text(text.replace("  NB", "      NB") + "# größer ≥\n" * 900)
    (tmp_path / "broken.frb").write_text(text.replace("PS  PM", "Größe  ≤ “PM”"))
    (tmp_path / "broken.lut").write_text(shipped("thesis-6.1.lut").read_text().replace("1", "é"))
    (tmp_path / "hostile.frb").write_text(HOSTILE_FILE, newline="")
    (tmp_path / "other.frb").write_text(HOSTILE_FILE.replace("0 .. 10", "0 .. 11"), newline="")
    return tmp_path


def of_every_command(name="x" + HOSTILE):
    """Return the words of some calls of every command that ends by itself."""
    hostile, point = "hostile.frb", f"{name}=3"
    return [
        *([command, file] for command in ("check", "show") for file in (
            PD7, TABLE, "broken.frb", "broken.lut", hostile, "none.frb", "."
        )),
        ["check", "--json", "broken.frb", hostile],
        *(["fmt", option, "untidy.frb", "broken.frb"] for option in ("--diff", "--check")),
        ["fmt", "untidy.frb"],
        ["eval", PD7, "e=1", "ce=2"],
        ["eval", PD7, "e=1", "ce=2", "--explain"],
        ["eval", "broken.frb", "x=1"],
        ["eval", hostile, point],
        ["eval", hostile, "y=1"],
        ["eval", hostile, point, "--explain"],
        ["eval", hostile, point, "--explain", "--json"],
        ["show", hostile, "--at", point],
        ["show", hostile, "--json"],
        ["plot", hostile, "-o", "x.svg"],
        ["plot", "broken.frb", "-o", "x.png"],
        ["compile", PD7, "-o", "x.lut", "--levels", "3"],
        ["compile", hostile, "-o", "x.csv", "--levels", "3"],
        ["compile", hostile, "-o", "x.h", "--direct"],
        ["compile", "broken.frb", "-o", "x.h"],
        ["compile", hostile, "-o", "x.mjs"],
        ["designer", "none.frb"],
        ["diff", hostile, "other.frb"],
        ["diff", hostile, PD7],
        ["diff", TABLE, str(shipped("performance-yamazaki.lut"))],
        ["diff", hostile, "other.frb", "--json"],
        *(["convert", file, f"x{suffix}", "--lossy"]
          for file in (PD7, hostile) for suffix in (".frb", ".fll", ".fcl", ".fis")),
        ["convert", hostile, "x.fis", "--json"],
        ["simulate", "--list"],
        ["simulate", "pd", "--duration", "0.1"],
        ["simulate", "nothing"],
        ["learn", PD7, "--passes", "0"],
        ["fit", PD7, "-o", "fitted.frb", "--rules", "1"],
        ["validate", PD7, "nothing.csv"],
        ["tune", PD7],
        ["tune", "heater", "--for", "200s", "--evals", "3", "--unseen", "1", "--no-linear"],
        ["tune", hostile, "--data", "nothing.csv"],
        ["compare", "pd"],
        ["sweep", "pd", "--segment", "0.1", "--hold", "0.1", "--sweep", "payload=0..1:2"],
        ["sweep", "pd", "--sweep", f"{name}=0..1:2"],
        ["sweep", "pd", "--sweep", "payload=0..1:2", "-o", hostile, "--resume"],
        ["cite", PD7],
        ["cite", hostile],
        ["grade", "nothing"],
        ["playground", "nothing.txt", "-o", "site"],
        ["prove", PD7, "--range"],
        ["prove", hostile],
        ["margins", hostile],
        ["reproduce", "--list"],
        ["identify", "nothing"],
        ["new", "n\x1b[31m"],
        ["watch", "--once", hostile],
        ["watch", "--once", "broken.frb"],
        ["lsp", "--tcp", "nothing"],
        ["demo"],
        ["shipped"],
        ["--help"],
        ["--version"],
    ]  # fmt: skip


def test_every_command_is_tried():
    assert {words[0] for words in of_every_command()} >= set(COMMANDS)


def run_all(monkeypatch, make_stdout, make_stderr=None, calls=None):
    """Run every call with outputs of its own; an exception of any kind is a failure."""
    statuses = {}
    for words in calls or of_every_command():
        with monkeypatch.context() as patch:
            streams = {"stdout": make_stdout(), "stderr": (make_stderr or make_stdout)()}
            for name, stream in streams.items():
                patch.setattr(sys, name, stream)
            try:
                status = main(words)
            finally:
                # Where there was no stream, the program has opened one for itself.
                for stream in (*streams.values(), sys.stdout, sys.stderr):
                    if stream is not None:
                        forget(stream)
            statuses[tuple(words)] = status
    assert set(statuses.values()) <= {0, 1, 2}
    return statuses


def forget(stream):
    with contextlib.suppress(OSError):
        stream.close()


def opened(path, encoding="utf-8", errors="strict"):
    return open(path, "w", encoding=encoding, errors=errors)


ENCODINGS = ("ascii", "cp1252", "utf-8", "utf-16")


@pytest.mark.slow
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_every_command_writes_in_any_encoding(encoding, files, monkeypatch):
    cells = crossed(map(tuple, of_every_command()), ENCODINGS)
    run_all(
        monkeypatch,
        lambda: opened(files / "out", encoding),
        lambda: opened(files / "err", encoding, "backslashreplace"),
        [list(words) for words, name in cells if name == encoding],
    )


def without_a_reader():
    reading, writing = os.pipe()
    os.close(reading)
    return opened(writing)


FAULTS = {"closed": lambda: None, "full": lambda: opened("/dev/full"), "gone": without_a_reader}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fault", "status"),
    [("closed", None), ("full", 1), ("gone", 0)],  # `fuzzyarm show | head` is not a fault
)
def test_every_command_bears_outputs_that_take_nothing(fault, status, files, monkeypatch):
    if fault == "full" and not os.path.exists("/dev/full"):
        pytest.skip("no device that is always full")
    cells = crossed(map(tuple, of_every_command()), FAULTS)
    calls = [list(words) for words, name in cells if name == fault]
    errors = None if fault == "closed" else lambda: opened(files / "err")
    statuses = run_all(monkeypatch, FAULTS[fault], errors, [["show", PD7], *calls])
    assert status in (None, statuses["show", PD7])


@pytest.mark.slow
def test_a_reader_that_has_gone_costs_no_file(files, monkeypatch):
    linear = files / "linear.frb"
    linear.write_text(
        "controller c\nperiod 1 ms\naxis shaft\n  e = error of position\n"
        "  drive voltage = e * 2, within -24 .. 24\n"
    )
    on_motor = ["prove", str(linear), "--plant", "motor"]
    claim = "on motor from position in 0.1 .. 0.11: position in 0 .. 0.2 during 0 .. 2 ms"
    calls = {
        "region.json": [*on_motor, "--stable", "--certificate", "region.json"],
        "tube.json": [*on_motor, "--claim", claim, "--certificate", "tube.json"],
        "tube.svg": [*on_motor, "--for", "2 ms", "--plot", "tube.svg"],
        "point.svg": ["eval", PD7, "e=1", "ce=2", "--plot", "point.svg"],
        "run.csv": ["simulate", str(linear), "--plant", "motor", "--csv", "run.csv"],
        "pd7.lut": ["compile", PD7, "-o", "pd7.lut"],
    }

    def unread():
        reading, writing = os.pipe()
        os.close(reading)
        return open(writing, "w", buffering=1)

    run_all(monkeypatch, unread, lambda: opened(files / "err"), list(calls.values()))
    assert {name for name in calls if not (files / name).exists()} == set()


@pytest.mark.slow
def test_no_command_lets_a_control_character_through(files, capsys, monkeypatch):
    monkeypatch.setenv("NO_COLOR", "1")
    for words in of_every_command():
        main(words)
        captured = capsys.readouterr()
        said = captured.out + captured.err
        if words[0] == "fmt":
            continue  # the text of the file itself
        bad = [c for c in said if c != "\n" and unicodedata.category(c)[0] == "C"]
        assert not bad, (words, said)
    for path in files.iterdir():
        if path.suffix == ".svg":
            assert "\ufffd" in path.read_text()


def test_the_difference_of_a_file_is_shown_clean_on_a_terminal_only(files, capsys, monkeypatch):
    main(["fmt", "--diff", "hostile.frb"])
    assert "\x1b[31m\x07" in capsys.readouterr().out
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    main(["fmt", "--diff", "hostile.frb"])
    shown = capsys.readouterr().out
    assert "\x1b" not in shown
    assert "\ufffd" in shown


def test_json_says_what_it_is_about_in_escapes(files, capsys):
    main(["show", "--json", "hostile.frb"])
    said = capsys.readouterr().out
    assert "\u202e" not in said
    assert json.loads(said)["name"] == "r" + HOSTILE


@pytest.mark.slow
def test_a_backend_that_matplotlib_does_not_know_is_no_matter(files, monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "nonsense")
    command = [sys.executable, "-m", "fuzzyarm", "plot", PD7, "-o", "x.png"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.startswith("x.png: drawn")


def test_a_full_disk_names_the_output(files, monkeypatch, capsys):
    with monkeypatch.context() as patch:
        full = opened("/dev/full")
        patch.setattr(sys, "stdout", full)
        assert main(["eval", PD7, "e=1", "ce=2"]) == 1
        forget(full)
    assert capsys.readouterr().err == "fuzzyarm: standard output: No space left on device\n"


INTERRUPTING = """\
import signal, sys


class Interrupting:
    # Ctrl-C while a module is looked for, of which the finder makes another error.
    def find_spec(self, name, path, target=None):
        if name != {module!r}:
            return None
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt as error:
            raise {error}("broken off") from error


sys.modules.pop("typing", None)
sys.meta_path.insert(0, Interrupting())
"""

SCRIPT = """\
import sys
from fuzzyarm.__main__ import main
sys.exit(main())
"""


@pytest.mark.slow
@pytest.mark.parametrize("error", ["KeyboardInterrupt", "ImportError", "RuntimeError"])
@pytest.mark.parametrize("start", ["script", "-m"])
@pytest.mark.parametrize(
    "module", ["typing", "fuzzyarm.base", "fuzzyarm.apps.cli.eval", "fuzzyarm.inference"]
)
def test_ctrl_c_is_one_line_from_the_first_module_on(tmp_path, module, start, error):
    (tmp_path / "sitecustomize.py").write_text(INTERRUPTING.format(module=module, error=error))
    (tmp_path / "fuzzyarm").write_text(SCRIPT)
    command = [str(tmp_path / "fuzzyarm")] if start == "script" else ["-m", "fuzzyarm"]
    ended = subprocess.run(
        [sys.executable, *command, "eval", PD7, "e=1", "ce=2"], check=False, capture_output=True,
        text=True, env={**os.environ, "PYTHONPATH": str(tmp_path)},
    )  # fmt: skip
    assert (ended.returncode, ended.stderr) == (130, "fuzzyarm: interrupted\n")


@pytest.mark.slow
def test_a_program_that_uses_fuzzyarm_keeps_its_ctrl_c():
    script = "import fuzzyarm, signal; raise SystemExit(signal.getsignal(signal.SIGINT).__name__)"
    command = [sys.executable, "-c", script]
    ended = subprocess.run(command, check=False, capture_output=True, text=True)
    assert ended.stderr == "default_int_handler\n"


@pytest.mark.slow
def test_a_locale_of_few_letters_ends_no_command(tmp_path):
    (tmp_path / "größe.frb").write_text(shipped("pd7.frb").read_text())
    servo = shipped("servo.frb").read_text()
    (tmp_path / "servo.frb").write_text(servo.replace("pd7.frb", "größe.frb"), encoding="utf-8")
    environment = {**os.environ, "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    for words in ("prove servo.frb --plant motor --stable", "show servo.frb", "check größe.frb"):
        ended = subprocess.run(
            [sys.executable, "-m", "fuzzyarm", *words.split()],
            check=False, capture_output=True, env=environment, cwd=tmp_path,
        )  # fmt: skip
        assert ended.returncode in {0, 1}, words
        assert b"Traceback" not in ended.stderr, words
