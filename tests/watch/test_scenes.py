"""What the drawings say, held against the inference itself; and the other commands."""

from __future__ import annotations

import os
import pty
import re
import select
import subprocess
import sys
import time
from pathlib import Path

import pytest

from fuzzyarm import load
from fuzzyarm.apps.cli import main
from fuzzyarm.apps.show.drawing import plain_text
from fuzzyarm.apps.watch import RulebaseScene, WatchedFile, WatchScene
from fuzzyarm.apps.watch.keys import apply_key
from fuzzyarm.inference import infer

RULEBASES = Path(__file__).parents[2] / "rulebases"


def _scene(name: str) -> RulebaseScene:
    scene = WatchedFile(RULEBASES / name).scene
    assert isinstance(scene, RulebaseScene)
    return scene


@pytest.mark.parametrize("point", [{"e": 1.2, "ce": -3.0}, {"e": -6.0, "ce": 6.0}])
def test_the_result_is_that_of_the_inference(point: dict[str, float]) -> None:
    scene = _scene("pd7.frb")
    scene.point = dict(point)
    value = infer(scene.rulebase, point)["u"]
    assert scene.result() == f"u = {value:.4g}".replace("u = -0", "u = 0") or value
    shown = float(scene.result().removeprefix("u = "))
    assert shown == pytest.approx(value, abs=1e-3)


def test_the_firing_view_lists_the_rules_and_strengths() -> None:
    scene = _scene("pd7.frb")
    scene.point = {"e": 0.6, "ce": 0.4}
    text = plain_text(scene.draw("firing", 60, 20), 60)
    assert "4 of 49 rules fire" in text
    # The strengths by hand: triangles two wide, joined by min.
    for strength, rule in (("0.700", "e is ZE and ce is ZE"), ("0.200", "e is PS and ce is PS")):
        assert re.search(rf"{strength} .*{rule}", text)


def test_the_surface_has_a_mark_where_the_inputs_are() -> None:
    scene = _scene("pd7.frb")
    scene.point = {"e": -6.0, "ce": 6.0}
    lines = plain_text(scene.draw("surface", 42, 14), 42).splitlines()
    (marked,) = [line for line in lines if "◆" in line]
    assert marked.strip().startswith("-6")  # it rises upward: the lowest row
    assert marked.endswith("◆")


def test_silent_places_of_a_surface_are_left_blank(tmp_path: Path) -> None:
    path = tmp_path / "gap.frb"
    path.write_text(
        "rulebase gap\ninput x 0 .. 10\noutput y 0 .. 1\nterm x LOW: triangle 0 0 4\n"
        "term x HIGH: triangle 6 10 10\nterms y: triangles A B\n"
        "rule if x is LOW then y is A\nrule if x is HIGH then y is B\n",
        "utf-8",
    )
    scene = WatchedFile(path).scene
    assert isinstance(scene, RulebaseScene)
    assert scene.result() == "no value"
    assert "no rule" in plain_text(scene.draw("firing", 42, 14), 42)
    plain_text(scene.draw("surface", 42, 14), 42)


def test_the_scene_survives_a_change_of_its_variables(tmp_path: Path) -> None:
    text = (RULEBASES / "thermostat.frb").read_text("utf-8")
    path = tmp_path / "t.frb"
    path.write_text(text, "utf-8")
    document = WatchedFile(path)
    assert document.scene is not None
    document.scene.point["presence"] = 1.0
    document.update(text.replace("presence", "people"))
    assert set(document.scene.point) == {"error", "rate", "people"}
    assert document.scene.point["people"] == 0.5
    document.update("rulebase x")
    assert set(document.scene.point) == {"error", "rate", "people"}
    assert not document.is_current


# ── watch ────────────────────────────────────────────────────────────────────────────────


def test_watch_once_writes_table_and_figure(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, figure = tmp_path / "out.lut", tmp_path / "out.svg"
    status = main([
        "watch", str(RULEBASES / "fan.frb"), "--once", "--table", str(table),
        "--figure", str(figure), "--at", "temperature=55",
    ])  # fmt: skip
    assert status == 0
    assert "speed = 900" in capsys.readouterr().out
    from fuzzyarm.table import read_table

    assert read_table(table).lookup(55.0) == 900.0
    assert "<svg" in figure.read_text("utf-8")[:600]


@pytest.mark.parametrize(
    ("words", "status"),
    [
        (["nowhere.frb", "--once"], 1),
        (["{pd7}", "--once", "--figure", "x.docx"], 2),
        (["{lut}", "--once", "--table", "x.lut"], 1),
        (["{pd7}", "--once", "--at", "zz=1"], 1),
        (["README.md", "--once"], 1),
        (["rules.fis", "--once"], 1),
    ],
)
def test_watch_refuses_what_makes_no_sense(
    words: list[str], status: int, capsys: pytest.CaptureFixture[str]
) -> None:
    places = {"pd7": str(RULEBASES / "pd7.frb"), "lut": str(RULEBASES / "thesis-6.1.lut")}
    assert main(["watch", *(word.format(**places) for word in words)]) == status
    assert capsys.readouterr().err.count("\n") == 1


def test_watch_needs_no_extra() -> None:
    hide = (
        "import sys; sys.modules.update(dict.fromkeys(('pygls', 'lsprotocol')));"
        "from fuzzyarm.apps.cli import main;"
        f"sys.exit(main(['watch', {str(RULEBASES / 'pd7.frb')!r}, '--once']))"
    )
    done = subprocess.run([sys.executable, "-c", hide], capture_output=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_watch_follows_saves_replacements_and_damage(tmp_path: Path) -> None:
    path = tmp_path / "fan.frb"
    text = (RULEBASES / "fan.frb").read_text("utf-8")
    path.write_text(text, "utf-8")
    process = subprocess.Popen(
        [sys.executable, "-m", "fuzzyarm", "watch", str(path), "--at", "temperature=55"],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    try:
        assert process.stdout is not None
        _read_until(process.stdout.fileno(), "speed = 900")
        # As many editors do: write beside it, take the old one away, move the new one there.
        other = tmp_path / "fan.frb~"
        other.write_text(text.replace("singleton 900", "singleton 950"), "utf-8")
        path.unlink()
        other.rename(path)
        _read_until(process.stdout.fileno(), "speed = 950")
        path.write_text(text.replace("singleton 900", "singletn 900"), "utf-8")
        wanted = "speed = 950", "did you mean 'singleton'?", "last sound text"
        _read_until(process.stdout.fileno(), *wanted)
    finally:
        process.send_signal(2)
        assert process.wait(120) == 0
        process.stdout.close()


def _read_until(descriptor: int, *wanted: str, seconds: float = 120.0) -> None:
    text, end = "", time.monotonic() + seconds
    while not all(each in text for each in wanted):
        assert time.monotonic() < end, f"never saw {wanted!r} in:\n{text[-3000:]}"
        if select.select([descriptor], [], [], 0.2)[0]:
            text += _ESCAPES.sub("", os.read(descriptor, 65536).decode("utf-8", "replace"))


_ESCAPES = re.compile(r"\x1b\[[0-9;?]*[ -/]*[@-~]")


# ── keys ─────────────────────────────────────────────────────────────────────────────────


def _pressed(scene: WatchScene, *keys: str) -> dict[str, float]:
    for key in keys:
        assert apply_key(scene, key)
    return dict(scene.point)


def test_arrows_move_the_inputs_rightward_and_upward() -> None:
    scene = _scene("pd7.frb")
    assert (scene.across, scene.down) == ("ce", "e")
    assert _pressed(scene, "right", "up", "up") == {"e": 0.4, "ce": 0.2}
    assert _pressed(scene, "shift-left") == {"e": 0.4, "ce": -1.0}  # a lattice of 12 steps
    assert _pressed(scene, "x", "right") == {"e": 0.6, "ce": -1.0}
    assert _pressed(scene, "c") == {"e": 0.0, "ce": 0.0}
    assert not apply_key(scene, "z")


def test_inputs_stay_in_their_ranges() -> None:
    scene = _scene("pd7.frb")
    assert _pressed(scene, *["shift-right"] * 20)["ce"] == 6.0
    assert _pressed(scene, *["down"] * 90)["e"] == -6.0


def test_arrows_walk_from_cell_to_cell_of_a_table() -> None:
    scene = WatchedFile(RULEBASES / "thesis-6.1.lut").scene
    assert scene is not None
    table = load(RULEBASES / "thesis-6.1.lut")
    before = table.cell(*scene.point.values())
    _pressed(scene, "right", "down")
    assert [b - a for a, b in zip(before, table.cell(*scene.point.values()), strict=True)] == [1, 1]


def test_o_shows_the_next_output(tmp_path: Path) -> None:
    path = tmp_path / "two.frb"
    path.write_text(
        "rulebase two\ninput x 0 .. 1\noutput y 0 .. 1\noutput z 0 .. 1\n"
        "terms x: triangles A B\nterms y: triangles A B\nterms z: triangles A B\n"
        "rule if x is A then y is A and z is B\nrule if x is B then y is B and z is A\n",
        "utf-8",
    )
    scene = WatchedFile(path).scene
    assert isinstance(scene, RulebaseScene)
    _pressed(scene, "o")
    assert scene.output == "z"
    _pressed(scene, "o")
    assert scene.output == "y"


@pytest.mark.slow
def test_keys_are_read_in_a_terminal() -> None:
    import fcntl
    import struct
    import termios

    master, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 80, 0, 0))
    before = termios.tcgetattr(slave)
    process = subprocess.Popen(
        [sys.executable, "-m", "fuzzyarm", "watch", str(RULEBASES / "pd7.frb")],
        stdin=slave, stdout=slave, stderr=slave,
        env={**os.environ, "TERM": "xterm-256color"}, start_new_session=True,
    )  # fmt: skip
    try:
        _read_until(master, "ce 0 ←→")
        os.write(master, b"\x1b[C")  # right
        _read_until(master, "ce 0.2 ←→")
        os.write(master, b"\x1b[1;2A")  # shift and up
        _read_until(master, "e 1 ↑↓")
        os.write(master, b"q")
        assert process.wait(120) == 0
        assert termios.tcgetattr(slave) == before  # letters are shown again
    finally:
        if process.poll() is None:
            process.kill()
        os.close(master)
        os.close(slave)


def test_commands_that_have_gone_say_what_to_type(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["studio", "pd7.frb"]) == 2
    assert "fuzzyarm watch" in capsys.readouterr().err


# ── new ──────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    "words",
    [
        [],
        ["--kind", "pi"],
        ["--kind", "single"],
        ["--input", "e -6..6 NB NM ZE PM PB", "--input", "ce -3..3 N Z P"],
        ["--input", "e -6..6 N P", "--output", "u 0 .. 1 a b c d e f g h"],
        ["--input", "'the error' -1e-3..1e3 'far left' is", "--output", "'out put' -1..1 not very"],
        ["--kind", "single", "--input", "x 0..1 A B C D", "--output", "y -5..5 P Q"],
    ],
)
def test_what_new_writes_passes_the_strict_check(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["new", "start", *words]) == 0
    assert main(["check", "--strict", "start.frb"]) == 0
    assert main(["fmt", "--check", "start.frb"]) == 0
    assert (tmp_path / "start.frb").read_text("utf-8").startswith("# ")


@pytest.mark.parametrize(
    ("words", "status"),
    [
        (["there"], 1),
        (["x", "--input", "e 6..-6 A B"], 1),
        (["x", "--input", "e 0..1 A"], 1),
        (["x", "--input", "e 0..1 A A"], 1),
        (["x", "--input", "e 0..1 A B", "--output", "e 0..1 A B"], 1),
        (["x", *["--input", "e 0..1 A B"] * 3], 1),
        (["x", "--kind", "single", "--input", "e 0..1 A B", "--input", "f 0..1 A B"], 1),
        (["x", "--input", "nonsense"], 2),
        (["no/such/folder/x"], 1),
    ],
)
def test_new_refuses_with_one_sentence(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: list[str],
    status: int,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there.frb").write_text("kept", "utf-8")
    assert main(["new", *words]) == status
    assert "Traceback" not in capsys.readouterr().err
    assert (tmp_path / "there.frb").read_text("utf-8") == "kept"
    assert [p.name for p in tmp_path.iterdir()] == ["there.frb"]
    if words == ["there"]:
        assert main(["new", "there", "--force"]) == 0
