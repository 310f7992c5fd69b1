"""The studio driven by its pilot: every key, broken text, saving, jumping, repairing."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from textual.widgets import OptionList, Static

from fuzzyarm.inference import infer
from fuzzyarm.language import format_text, parse
from fuzzyarm.show.drawing import plain_text
from fuzzyarm.studio.app import Studio
from fuzzyarm.studio.document import StudioDocument
from fuzzyarm.studio.panes import Editor, View
from fuzzyarm.studio.scene import RulebaseScene, TableScene
from fuzzyarm.studio.screens import KEYS, CompletionScreen, KeysScreen

RULEBASES = Path(__file__).parents[2] / "rulebases"


@pytest.fixture
def copy(tmp_path: Path) -> Iterator[Any]:
    def make(name: str) -> Path:
        return Path(shutil.copy(RULEBASES / name, tmp_path / name))

    return make


@asynccontextmanager
async def _studio(path: Path, size: tuple[int, int] = (80, 24)) -> Any:
    app = Studio(StudioDocument(path))
    async with app.run_test(size=size) as pilot:
        await pilot.pause()
        yield app, pilot


def _scene(app: Studio) -> RulebaseScene:
    assert isinstance(app.document.scene, RulebaseScene)
    return app.document.scene


def _shown(app: Studio, name: str) -> str:
    return str(app.query_one(name, Static).render())


async def test_arrow_keys_move_the_crisp_inputs(copy: Any) -> None:
    async with _studio(copy("pd7.frb")) as (app, pilot):
        await pilot.press("tab", "right", "right", "shift+up")
        assert app.query_one(View).has_focus
        assert _scene(app).point == {"e": 1.0, "ce": 0.4}
        value = infer(_scene(app).rulebase, e=1.0, ce=0.4)["u"]
        assert f"u = {value:.4g}" in _shown(app, "#point")
        await pilot.press("c")
        assert _scene(app).point == {"e": 0.0, "ce": 0.0}
        await pilot.press(*["shift+left"] * 14)
        assert _scene(app).point["ce"] == -6.0


async def test_the_keys_can_move_any_input(copy: Any) -> None:
    async with _studio(copy("thermostat.frb")) as (app, pilot):
        await pilot.press("tab")
        assert (_scene(app).across, _scene(app).down) == ("rate", "error")
        await pilot.press("x")
        assert (_scene(app).across, _scene(app).down) == ("presence", "error")
        before = dict(_scene(app).point)
        await pilot.press("right")
        assert _scene(app).point["presence"] > before["presence"]
        await pilot.press("y")
        assert (_scene(app).across, _scene(app).down) == ("presence", "rate")


@pytest.mark.parametrize("name", ["pd7.frb", "thermostat.frb", "tipper.frb", "fan.frb"])
async def test_every_view_draws(copy: Any, name: str) -> None:
    async with _studio(copy(name)) as (app, pilot):
        for key, view in (("f2", "surface"), ("f3", "rules"), ("f4", "terms"), ("f5", "firing")):
            await pilot.press(key)
            assert app.query_one(View).view == view
            assert app.query_one("#drawing", Static).size.height > 3
        await pilot.press("tab", "2")
        assert app.query_one(View).view == "rules"


async def test_a_cell_is_found_in_the_text(copy: Any) -> None:
    async with _studio(copy("pd7.frb")) as (app, pilot):
        await pilot.press("f3", "tab", "right", "down", "down", "enter")
        editor = app.query_one(Editor)
        assert editor.has_focus
        row, column = editor.cursor_location
        lines = app.document.text.splitlines()
        # Two terms down and one across from the middle: e is PM, ce is PS.
        assert lines[row].split()[0] == "PM"
        header = next(line for line in lines if "e \\ ce" in line)
        assert column == header.index("PS")


async def test_the_mouse_finds_a_cell_too(copy: Any) -> None:
    async with _studio(copy("thermostat.frb")) as (app, pilot):
        await pilot.press("f3")
        await pilot.pause()
        drawing = app.query_one("#drawing", Static)
        line = drawing.render_line(4).text
        await pilot.click("#drawing", offset=(line.index("LOW"), 4))
        await pilot.pause()
        row, column = app.query_one(Editor).cursor_location
        text = app.document.text.splitlines()[row]
        assert text.split()[0] == "GOOD"
        assert text[column:].startswith("LOW")


async def test_broken_text_keeps_the_last_good_drawing(copy: Any) -> None:
    path = copy("pd7.frb")
    async with _studio(path) as (app, pilot):
        await pilot.press("tab", "right", "shift+tab")
        scene, point = _scene(app), dict(_scene(app).point)
        await pilot.press("down", "down", "down", "delete")
        app.read_text()
        assert app.document.broken
        assert app.document.scene is scene
        assert "last sound text" in _shown(app, "#title")
        assert app.query_one(View).has_class("stale")
        findings = app.query_one("#findings", OptionList)
        assert findings.option_count == len(app.document.findings) == 1
        await pilot.press("f9")
        assert not app.document.broken
        assert app.document.is_current
        assert _scene(app).point == point
        assert app.query_one(Editor).text == path.read_text(encoding="utf-8")


async def test_findings_are_read_and_repaired_from_their_list(copy: Any) -> None:
    path = copy("pd7.frb")
    path.write_text(path.read_text("utf-8").replace("PM  PB  PB  PB", "PM  PX  PB  PB"), "utf-8")
    async with _studio(path) as (app, pilot):
        assert app.document.scene is None
        await pilot.press("tab", "tab", "enter")
        row, column = app.query_one(Editor).cursor_location
        assert app.document.text.splitlines()[row][column:].startswith("PX")
        await pilot.press("tab", "tab", "f")
        assert not app.document.broken
        assert isinstance(app.document.scene, RulebaseScene)
        await pilot.press("shift+tab", "shift+tab", "ctrl+z")
        app.read_text()
        assert app.document.broken


async def test_f8_goes_from_finding_to_finding(copy: Any) -> None:
    path = copy("pd7.frb")
    text = path.read_text("utf-8").replace(
        "NM  NS  ZE  PS  PM  PB\n  PS", "NX  NS  ZE  PX  PM  PB\n  PS"
    )
    path.write_text(text, "utf-8")
    async with _studio(path) as (app, pilot):
        places = []
        for _ in range(3):
            await pilot.press("f8")
            places.append(app.query_one(Editor).cursor_location)
        assert places[0] != places[1]
        assert places[2] == places[0]


async def test_saving_formats_the_file(copy: Any) -> None:
    path = copy("pd7.frb")
    untidy = path.read_text("utf-8").replace("  e \\ ce  NB", "  e \\ ce NB")
    path.write_text(untidy, "utf-8")
    async with _studio(path) as (app, pilot):
        await pilot.press("ctrl+s")
        await pilot.pause()
        assert path.read_text("utf-8") == format_text(untidy)
        assert app.query_one(Editor).text == format_text(untidy)
        assert not app.is_changed


async def test_a_file_with_mistakes_is_saved_as_it_is(copy: Any) -> None:
    path = copy("pd7.frb")
    async with _studio(path) as (app, pilot):
        await pilot.press("down", "x", "ctrl+s")
        await pilot.pause()
        assert path.read_text("utf-8") == app.query_one(Editor).text
        assert "xrulebase" in path.read_text("utf-8")


async def test_a_file_that_changed_on_disk_is_not_lost(copy: Any) -> None:
    path = copy("pd7.frb")
    async with _studio(path) as (_, pilot):
        path.write_text("rulebase other\n", "utf-8")
        await pilot.press("ctrl+s")
        assert path.read_text("utf-8") == "rulebase other\n"
        await pilot.press("ctrl+s")
        assert path.read_text("utf-8").startswith("# Joint controller")


async def test_unsaved_text_is_left_only_when_asked_twice(copy: Any) -> None:
    async with _studio(copy("pd7.frb")) as (app, pilot):
        await pilot.press("x", "ctrl+q")
        assert app.is_running
        assert app.return_value is None
        await pilot.press("ctrl+q")
        assert app.return_value == 0


async def test_typing_brings_a_new_drawing(copy: Any) -> None:
    async with _studio(copy("fan.frb")) as (app, pilot):
        before = _scene(app)
        editor = app.query_one(Editor)
        place = app.document.text.index("singleton 900")
        row = app.document.text[:place].count("\n")
        column = len("term speed SLOW:   singleton 900")
        editor.move_cursor((row, column))
        await pilot.press("backspace", "5")
        await pilot.pause(0.4)
        assert _scene(app) is not before
        assert _scene(app).rulebase.variable("speed").term("SLOW").shape.parameters == (905.0,)


async def test_a_table_is_walked_level_by_level(copy: Any) -> None:
    path = RULEBASES / "thesis-6.1.lut"
    async with _studio(copy(path.name)) as (app, pilot):
        await pilot.press("tab", "right", "down", "down")
        scene = app.document.scene
        assert isinstance(scene, TableScene)
        assert scene.cell == (8, 7)
        await pilot.press("enter")
        row, column = app.query_one(Editor).cursor_location
        line = app.document.text.splitlines()[row]
        shown = _shown(app, "#point")
        assert line.split()[0] == "2"
        assert f"u = {float(line[column:].split()[0]):g}" in shown
        await pilot.press("f3")
        assert app.query_one(View).view == "numbers"


@pytest.mark.parametrize("size", [(80, 24), (50, 15), (160, 50)])
async def test_any_size_will_do(copy: Any, size: tuple[int, int]) -> None:
    async with _studio(copy("thermostat.frb"), size) as (app, pilot):
        for key in ("f2", "f3", "f4", "f5", "tab", "right", "down"):
            await pilot.press(key)
        assert app.query_one(View).size.width > 10


async def test_keys_open_as_a_screen_that_any_key_closes(copy: Any) -> None:
    async with _studio(copy("pd7.frb")) as (app, pilot):
        await pilot.press("f1")
        assert isinstance(app.screen, KeysScreen)
        text = str(app.screen.query(Static).first().render())
        told = [key for _, keys in KEYS for key, _ in keys]
        assert all(key in text for key in told)
        assert max(map(len, text.splitlines())) <= 76
        await pilot.press("space")
        assert not isinstance(app.screen, KeysScreen)
        assert app.document.text == app.query_one(Editor).text


async def test_completion_offers_what_the_server_offers(copy: Any) -> None:
    async with _studio(copy("pd7.frb")) as (app, pilot):
        editor = app.query_one(Editor)
        editor.move_cursor(editor.document.end)
        editor.insert("rule if ce is very ")
        await pilot.press("f7")
        assert isinstance(app.screen, CompletionScreen)
        labels = [each.label for each in app.screen.candidates]
        assert labels[:7] == ["NB", "NM", "NS", "ZE", "PS", "PM", "PB"]
        await pilot.press("down", "enter")
        assert editor.text.endswith("rule if ce is very NM")
        editor.insert(" then u is P")
        await pilot.press("f7", "escape")
        assert editor.text.endswith("then u is P")
        await pilot.press("f7", "tab")
        assert editor.text.endswith(f"then u is {labels[4]}")


async def test_find_goes_round_and_says_where_nothing_is(copy: Any) -> None:
    async with _studio(copy("pd7.frb")) as (app, pilot):
        editor = app.query_one(Editor)
        lines = editor.text.split("\n")
        wanted = [
            (row, at)
            for row, line in enumerate(lines)
            for at in range(len(line))
            if line[at : at + 6].casefold() == "output"
        ]
        await pilot.press("ctrl+f", *"OUTput", "enter")
        assert editor.cursor_location == wanted[0]
        assert editor.scroll_x == 0
        for place in (*wanted[1:], wanted[0]):
            await pilot.press("ctrl+g")
            assert editor.cursor_location == place
        await pilot.press("ctrl+f", *"nothing", "enter")
        assert editor.cursor_location == wanted[0]


async def test_f6_runs_the_text_beside_it(copy: Any, monkeypatch: Any) -> None:
    monkeypatch.setenv("FUZZYARM_NATIVE", "0")
    path = copy("heater.frb")
    text = path.read_text("utf-8").replace("period 10 s", "period 200 s")
    path.write_text(text, "utf-8")
    async with _studio(path) as (app, pilot):
        assert "F6 runs" in _shown(app, "#drawing")
        await pilot.press("f6")
        await app.workers.wait_for_complete()
        await pilot.pause(0.3)
        assert "6 run" in _shown(app, "#views")
        assert "RMS error: temperature" in _shown(app, "#point")
        drawn = "".join(app.query_one("#drawing", Static).render_line(y).text for y in range(12))
        assert "heater on room" in drawn


async def test_what_cannot_be_run_is_told(copy: Any) -> None:
    async with _studio(copy("thermostat.frb")) as (app, pilot):
        await pilot.press("f6")
        await app.workers.wait_for_complete()
        await pilot.pause()
        told = [note.message for note in app._notifications]
        assert any(message.startswith("Not run: ") for message in told)


def test_the_surface_has_the_inputs_that_the_output_depends_on() -> None:
    model = parse(
        "rulebase own\ninput a 0 .. 1\ninput b 0 .. 4\ninput c 0 .. 1\n"
        "output u 0 .. 10\noutput v 0 .. 10\nterms a, b, c, u, v: triangles LO HI\n"
        "rule if a is LO then u is HI\nrule if a is HI then u is LO\n"
        "rule if b is LO and c is LO then v is LO\nrule if b is HI or c is HI then v is HI\n"
    ).rulebase
    assert model is not None
    scene = RulebaseScene(model)
    assert (scene.across, scene.down) == ("a", "")
    scene.next_output()
    assert {scene.across, scene.down} == {"b", "c"}
    drawn = plain_text(scene.draw("surface", 40, 14), 40).splitlines()
    assert drawn[1].split()[0] == "4"  # upward: the upper end is on top
    assert drawn[-1].split()[::2] == ["0", "10"]  # the scale below
    assert max(map(len, drawn)) <= 40


def test_what_a_rule_says_is_seen_in_a_narrow_pane() -> None:
    model = parse((RULEBASES / "pd7.frb").read_text("utf-8")).rulebase
    assert model is not None
    scene = RulebaseScene(model)
    scene.point = {"e": 1.3, "ce": -2.2}
    lines = plain_text(scene.draw("firing", 38, 20), 38).splitlines()
    trace = scene.trace()
    assert not isinstance(trace, str)
    for rule in trace.fired:
        consequent = rule.text.rpartition(" then ")[2]
        assert any(f"{rule.strength:.3f}" in line and consequent in line for line in lines)
