"""A run in the terminal: what an animation shows, to scale, in characters."""

from __future__ import annotations

import io
import itertools
import math
import subprocess
import sys

import numpy as np
import pytest

from fuzzyarm import load, shipped
from fuzzyarm.apps.cli import main
from fuzzyarm.apps.show import live
from fuzzyarm.apps.show.canvas import Canvas
from fuzzyarm.apps.show.drawing import make_console, plain_text
from fuzzyarm.apps.show.live import LiveView, frames_of, play
from fuzzyarm.base.picture import Drawing, Line, Words
from fuzzyarm.control.loop import Signal, simulate
from fuzzyarm.plant import PLANTS, PlantError, find_plant
from fuzzyarm.plant.drawings import PlantScene, is_drawn

STEPS = {
    "motor": ("servo.frb", "position", 0.1),
    "cartpole": ("cartpole.frb", "x", 0.2),
    "tanks": ("tanks.frb", "level2", 4.0),
    "ball-and-beam": ("ball-and-beam.frb", "position", 0.2),
    "room": ("heater.frb", "temperature", 600.0),
}


def run_on(name):
    file, output, seconds = STEPS[name]
    plant = find_plant(name)
    references = {output: Signal("step", (0.1, 0.0))}
    return simulate(load(shipped(file)), plant, reference=references, duration=seconds), plant


@pytest.fixture(scope="module")
def cartpole():
    return run_on("cartpole")


def test_there_is_a_run_for_each_plant_that_is_drawn():
    assert set(STEPS) | {"arm"} == {name for name in PLANTS if is_drawn(find_plant(name))}


@pytest.mark.parametrize("name", list(STEPS))
def test_every_shipped_plant_is_drawn_with_its_errors_and_drives(name):
    run, plant = run_on(name)
    text = plain_text(LiveView(run, plant).at(run.samples - 1, 80, 16), 80)
    lines = text.splitlines()
    assert len(lines) <= 16
    assert max(map(len, lines)) <= 80
    said = name if run.controller == name else f"{run.controller} on {name}"
    assert lines[0].startswith(f"{said}  ")
    assert f"error of {run.labels[0]}" in text
    assert any(drive in text for drive in run.drives)
    drawn = "".join(line[:30] for line in lines[1:])
    assert sum(0x2800 < ord(letter) < 0x2900 for letter in drawn) > 12
    plain = plain_text(LiveView(run, plant, unicode=False).at(run.samples - 1, 80, 16), 80)
    assert all(ord(letter) < 0x2000 for letter in plain.replace("…", ""))


def test_lengths_are_the_same_across_and_up():
    canvas = Canvas(30, 8, -1.0, 2.0, -1.0, 1.0)
    x0, y0 = canvas.place(0.0, 0.0)
    x1, y1 = canvas.place(1.0, 1.0)
    assert x1 - x0 == pytest.approx(y0 - y1)
    corners = [canvas.place(x, y) for x in (-1.0, 2.0) for y in (-1.0, 1.0)]
    assert all(-1e-9 <= x <= 59 and -1e-9 <= y <= 31 for x, y in corners)


def test_the_pole_stands_where_it_is(cartpole):
    run, plant = cartpole
    index = int(np.argmax(np.abs(run.outputs["theta"])))
    drawing = plant.draw(PlantScene(run, index))
    canvas = Canvas(60, 24, *drawing.stage)
    canvas.draw(drawing.parts)
    from fuzzyarm.plant.plant import parameter

    length = 2.0 * parameter(plant, "l").value
    angle, x = run.outputs["theta"][index], run.outputs["x"][index]
    column, row = canvas.place(x + length * math.sin(angle), 0.24 + length * math.cos(angle))
    lines = canvas.lines()
    shown = lines[round(row) // 4].plain[round(column) // 2]
    assert ord(shown) > 0x2800
    empty = lines[round(row) // 4 - 1].plain[round(column) // 2]
    assert empty == " "


def test_a_plant_of_a_user_draws_itself_or_shows_its_curves(cartpole):
    run, _ = cartpole

    class Own:
        def draw(self, scene):
            x = scene.output("x")
            return Drawing((-1, 1, -1, 1), [Line((-1, 1), (x, x)), Words(0, 0.5, "here")])

    assert "here" in plain_text(LiveView(run, Own()).at(3, 60, 12), 60)
    curves = plain_text(LiveView(run, object()).at(run.samples - 1, 60, 12), 60)
    assert curves.splitlines()[1].startswith("error of x")


def test_a_drawing_that_fails_is_a_sentence(cartpole):
    run, _ = cartpole

    class OfBefore:
        name = "kiln"

        def draw(self, axes, x):
            axes.plot(x, x)

    class Nothing:
        name = "kiln"

        def draw(self, scene):
            return None

    for plant, words in ((OfBefore(), "drawing of kiln failed: "), (Nothing(), "is a NoneType")):
        with pytest.raises(PlantError, match=words) as caught:
            LiveView(run, plant).at(3, 60, 12)
        assert "draw(self, scene)" in caught.value.hint


def test_a_run_is_watched_where_matplotlib_is_not_installed():
    """Every shipped plant, in a process that cannot import it."""
    code = """
import io, sys
sys.modules["matplotlib"] = None  # an import of it fails
from fuzzyarm import shipped
from fuzzyarm.apps.cli import main
from fuzzyarm.apps.show import drawing, live

class Terminal(io.StringIO):
    encoding = "utf-8"
    def isatty(self):
        return True

live.time.sleep = lambda seconds: None
sys.stdout = terminal = Terminal()
status = [
    main(["simulate", str(shipped(name)), *words.split(), "--watch"])
    for name, words in (
        ("servo.frb", "--plant motor --step 1 --for 20ms"),
        ("stfc.frb", "--trajectory reach --angles 1 1 --segment 0.1 --hold 0.1"),
        ("cartpole.frb", "--plant cartpole --step 0.1 --for 100ms"),
        ("tanks.frb", "--plant tanks --step 0.1 --for 5s"),
        ("heater.frb", "--plant room --for 10min"),
        ("ball-and-beam.frb", "--plant ball-and-beam --step 0.1 --for 200ms"),
    )
]
sys.stdout = sys.__stdout__
print(status, sum("\u2800" < letter < "\u2900" for letter in terminal.getvalue()) > 1000)
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.stdout == "[0, 0, 0, 0, 0, 0] True\n", run.stderr


def test_it_plays_as_long_as_the_run_and_stops_when_asked(cartpole, monkeypatch):
    run, plant = cartpole
    slept = []
    monkeypatch.setattr(live.time, "sleep", slept.append)
    out = io.StringIO()
    console = make_console(out, force_terminal=True, width=80, height=18, color_system=None)
    assert play(run, plant, console)
    frames = frames_of(run)
    assert (frames[0], frames[-1]) == (0, run.samples - 1)
    assert len(slept) == len(frames)
    assert out.getvalue().count("cartpole  ") >= len(frames)

    def interrupted(_seconds):
        raise KeyboardInterrupt

    monkeypatch.setattr(live.time, "sleep", interrupted)
    assert not play(run, plant, console)


@pytest.mark.parametrize("words", [[], ["--json"]])
def test_watching_needs_a_terminal(capsys, words):
    assert main(["simulate", "pd", "--watch", *words]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert "--watch" in err
    assert "terminal" in err


def test_the_scale_of_a_thermometer_stays_while_a_run_that_is_over_is_shown():
    run, plant = run_on("room")
    ends = [plant.draw(PlantScene(run, index)).parts for index in (0, run.samples - 1)]
    scales = [[each.text for each in parts if isinstance(each, Words)][1:3] for parts in ends]
    assert scales[0] == scales[1]
    values = [*run.outputs["temperature"], *run.wanted["temperature"]]
    assert float(scales[0][0]) < min(values) <= max(values) < float(scales[0][1])


def test_an_area_has_the_dots_inside_it_and_no_others():
    canvas = Canvas(30, 12, 0.0, 10.0, 0.0, 8.0)
    corners = [(0.7, 0.4), (9.1, 2.3), (4.2, 7.6)]
    canvas.area(*zip(*corners, strict=True), "red")
    braille = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]]
    dots = {
        (2 * column + j, 4 * row + i)
        for row, line in enumerate(canvas.lines())
        for column, letter in enumerate(line.plain)
        for i, j in itertools.product(range(4), range(2))
        if letter != " " and (ord(letter) - 0x2800) & braille[i][j]
    }
    places = [canvas.place(x, y) for x, y in corners]

    def inside(column, row):
        sides = [
            (x1 - x0) * (row - y0) - (y1 - y0) * (column - x0)
            for (x0, y0), (x1, y1) in zip(places, [*places[1:], places[0]], strict=True)
        ]
        return all(side <= 0 for side in sides) or all(side >= 0 for side in sides)

    every = itertools.product(range(60), range(48))
    assert dots == {(column, row) for column, row in every if inside(column, row)}
    assert len(dots) > 300


@pytest.mark.parametrize("height", [12, 20, 60])
def test_a_picture_that_moves_leaves_room_for_the_cursor(cartpole, monkeypatch, height):
    run, plant = cartpole
    console = make_console(io.StringIO(), width=80)
    console.height = height
    asked = []
    monkeypatch.setattr(LiveView, "at", lambda _, *size: asked.append(size) or "")
    monkeypatch.setattr(live.time, "sleep", lambda _: None)
    assert play(run, plant, console)
    assert {tall for _, _, tall in asked} == {min(height - 2, 26)}
