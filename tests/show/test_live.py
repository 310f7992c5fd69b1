"""A run in the terminal: what an animation shows, to scale, in characters."""

from __future__ import annotations

import io
import math

import numpy as np
import pytest

from fuzzyarm import load, shipped
from fuzzyarm.cli import main
from fuzzyarm.loop import Signal, simulate
from fuzzyarm.plant import find_plant
from fuzzyarm.show.drawing import make_console, plain_text
from fuzzyarm.show.figures import live
from fuzzyarm.show.figures.live import Canvas, LiveView, frames_of, play
from fuzzyarm.show.figures.plants import DRAWN, Scene, Words

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
    return simulate(load(shipped(file)), plant, references=references, duration=seconds), plant


@pytest.fixture(scope="module")
def cartpole():
    return run_on("cartpole")


def test_there_is_a_run_for_each_plant_that_is_drawn():
    assert set(STEPS) | {"arm"} == set(DRAWN)


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
    view = LiveView(run, plant)
    index = int(np.argmax(np.abs(run.outputs["theta"])))
    view._axes.clear()
    view._picture.draw(view._axes, live.Scene(run, plant, index))
    canvas = Canvas(60, 24, *view._axes.get_xlim(), *view._axes.get_ylim())
    live.read_axes(view._axes, canvas)
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
        def draw(self, axes, x):
            axes.set_xlim(-1, 1)
            axes.set_ylim(-1, 1)
            axes.plot([-1, 1], [x[0], x[0]])
            axes.text(0, 0.5, "here")

    from dataclasses import replace

    own = replace(run, plant="own")
    assert "here" in plain_text(LiveView(own, Own()).at(3, 60, 12), 60)
    curves = plain_text(LiveView(own, object()).at(run.samples - 1, 60, 12), 60)
    assert curves.splitlines()[1].startswith("error of x")


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
    assert main(["simulate", "pd", "--watch", *words]) == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert "--watch" in err
    assert "terminal" in err


def test_the_scale_of_a_thermometer_stays_while_a_run_that_is_over_is_shown():
    run, plant = run_on("room")
    ends = [DRAWN["room"](Scene(run, plant, index)).parts for index in (0, run.samples - 1)]
    scales = [[each.text for each in parts if isinstance(each, Words)][1:3] for parts in ends]
    assert scales[0] == scales[1]
    values = [*run.outputs["temperature"], *run.wanted["temperature"]]
    assert float(scales[0][0]) < min(values) <= max(values) < float(scales[0][1])
