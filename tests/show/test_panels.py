"""Records of `fuzzyarm.base.picture`, drawn in the terminal and by matplotlib."""

from __future__ import annotations

import io
import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm.apps.show.cells import table_panel
from fuzzyarm.apps.show.drawing import make_console, plain_text
from fuzzyarm.apps.show.figures.panels import chart_figure
from fuzzyarm.apps.show.panels import LinePlot, SurfaceMap, panel_lines
from fuzzyarm.apps.show.response import Response
from fuzzyarm.apps.show.search import spreads
from fuzzyarm.apps.show.terms import TermPlots
from fuzzyarm.apps.show.trace import _memberships
from fuzzyarm.base.picture import (
    Area,
    Axis,
    Band,
    Cells,
    Chart,
    Dots,
    Drawing,
    Level,
    Line,
    Mark,
    Panel,
    Words,
    drawing_data,
    frame,
    rectangle,
)
from fuzzyarm.inference import infer
from fuzzyarm.inference.trace import FuzzyValue
from fuzzyarm.language.model.rulebase import Input, Shape, Term
from fuzzyarm.table import compile_table


def test_a_drawing_is_json_without_what_has_no_place():
    parts = [
        rectangle(0, 0, 1, 2, "mark"),
        frame(0, 0, 1, 2),
        Line((0, math.nan), (0, 1)),
        Mark(math.inf, 0),
        Words(0, 1, "level 3"),
    ]
    data = json.loads(json.dumps(drawing_data(Drawing((0, 2, 0, 4), parts)), allow_nan=False))
    assert [part["is"] for part in data["parts"]] == ["area", "line", "words"]
    assert data["parts"][0]["points"] == [[0, 0], [1, 0], [1, 2], [0, 2]]
    assert data["parts"][1]["points"][0] == data["parts"][1]["points"][-1]
    assert data["grip"] == [1, 2]  # the middle of the stage


def dots_of(text: str) -> list[tuple[int, int]]:
    """Return column and row of every dot of braille."""
    bits = {(0, 0): 0x01, (0, 1): 0x02, (0, 2): 0x04, (1, 0): 0x08, (1, 1): 0x10, (1, 2): 0x20,
            (0, 3): 0x40, (1, 3): 0x80}  # fmt: skip
    return [
        (2 * j + x, 4 * i + y)
        for i, line in enumerate(text.splitlines())
        for j, letter in enumerate(line)
        for (x, y), bit in bits.items()
        if 0x2800 < ord(letter) < 0x2900 and (ord(letter) - 0x2800) & bit
    ]


@given(st.lists(st.floats(-5, 5), min_size=2, max_size=40), st.integers(10, 40), st.integers(3, 9))
def test_a_line_reaches_from_the_top_to_the_bottom_in_every_column(values, width, height):
    panel = Panel([Line(range(len(values)), values)], Axis("x"), Axis("y"))
    text = plain_text(LinePlot(panel, width, height), 90)
    dots = dots_of(text)
    left = min(column for column, _ in dots)
    assert {column - left for column, _ in dots} == set(range(2 * width))
    rows = {row for _, row in dots}
    assert rows <= set(range(4 * height))
    seen = {values[k * len(values) // (2 * width)] for k in range(2 * width)}
    if max(seen) - min(seen) > 0.0 and {max(values), min(values)} <= seen:
        assert rows == set(range(4 * height))  # what it jumps over is drawn as well


def test_marks_and_failures_of_a_line_stand_in_their_columns():
    x = np.linspace(0.0, 10.0, 40)
    parts = [Line(x, x), Level(2.5, upright=True), Dots([10.0], [0.0], "X")]
    plot = LinePlot(Panel(parts, Axis("a", low=0.0, high=10.0), Axis("y")), 20, 5)
    lines = plain_text(plot, 60).splitlines()
    left = len(lines[0]) - len(lines[0].lstrip()) + len("10 ")
    assert [line.index("┊") - left for line in lines if "┊" in line][0] == 5  # noqa: RUF015
    assert lines[4].endswith("✗")


def test_a_logarithmic_axis_says_so_and_spreads_its_values():
    line = Line(range(3), [1.0, 10.0, 100.0])
    panel = Panel([line], Axis("trials"), Axis("cost", logarithmic=True))
    text = plain_text(LinePlot(panel, 15, 9), 60)
    assert "log cost" in text
    dots = dots_of(text)
    left = min(column for column, _ in dots)
    level = [min(row for column, row in dots if column == left + at) for at in (5, 15, 25)]
    assert level == [35, 18, 0]  # ten is half of the way from one to a hundred


def test_the_same_chart_in_the_terminal_and_on_paper():
    time = np.arange(50.0)
    parts = [Level(0.0), Line(time, np.sin(time / 8.0), "first", label="$x_1$")]
    parts += [Band(time, -np.ones(50), np.ones(50)), Area((0, 1, 1), (0, 0, 1), "mark", 0.2)]
    panel = Panel(parts, Axis("time", "s"), Axis("speed", "m/s"), name="speed")
    axes = chart_figure(Chart([[panel, None]], (6.0, 3.0), "a $", key=True)).axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time, s", "speed, m/s")
    np.testing.assert_array_equal(axes.lines[1].get_ydata(), parts[1].y)
    lines = panel_lines(panel, 12, (30, 4))
    assert lines[0].plain == "speed 0.997 m/s"
    columns = [column for column, _ in dots_of("\n".join(line.plain for line in lines[1:]))]
    curve = [column for column in columns if column % 4]  # the others are those of zero
    assert max(curve) <= round(12 / 49 * 59) + 1


def test_a_response_is_the_inference_in_any_number_of_points(lopsided):
    output = lopsided.outputs[0]
    response = Response(lopsided, output, {"a": 3.0, "b": 0.5})
    points = [np.linspace(v.low, v.high, n) for v, n in zip(response.free, (5, 7), strict=True)]
    panel = response.panel(points)
    (cells,) = panel.of(Cells)
    for i, a in enumerate(cells.y):
        for j, b in enumerate(cells.x):
            assert cells.values[i, j] == infer(lopsided, a=a, b=b)["y"]
    assert [(dots.x, dots.y) for dots in panel.of(Dots) if dots.sign == "o"] == [([0.5], [3.0])]
    turned = Response(lopsided, output, {"a": 3.0}, free=["b", "a"]).panel(points[::-1])
    np.testing.assert_array_equal(turned.of(Cells)[0].values, cells.values.T)
    line = Response(lopsided, output, {"a": 3.0}, free=["b"]).panel([points[1]])
    np.testing.assert_array_equal(line.of(Line)[0].y, infer(lopsided, a=3.0, b=points[1])["y"])


def test_rows_of_a_table_go_down_and_those_of_a_surface_up(lopsided):
    table = compile_table(lopsided, levels=7)
    first, last = (table.axes[0].levels[k] for k in (0, -1))
    at = {"a": first, "b": table.axes[1].levels[-1]}
    rows = plain_text(SurfaceMap(table_panel(table, at), 21, 5), 60).splitlines()
    assert rows[0][-3:-1].strip("▒█▓░·") == "◆"  # in the middle of its cell, three wide
    assert float(rows[0].split()[0]) == first
    points = [np.linspace(v.low, v.high, n) for v, n in zip(lopsided.inputs, (10, 21), strict=True)]
    upward = Response(lopsided, lopsided.outputs[0], at).panel(points)
    rows = plain_text(SurfaceMap(upward, 21, 5), 60).splitlines()
    assert rows[4].endswith("◆")
    assert float(rows[0].split()[0]) == last


def test_a_map_has_the_colours_of_its_scale():
    values = np.array([[0.0, 1.0], [2.0, math.nan]])
    panel = Panel(
        [Cells([0, 1], [0, 1], values, Axis("y", low=0.0, high=2.0))], Axis("a"), Axis("b")
    )
    out = io.StringIO()
    make_console(out, width=40, force_terminal=True, color_system="truecolor").print(
        SurfaceMap(panel, 8, 3)
    )
    first = out.getvalue().splitlines()[0]
    assert "253;231;37" in first  # 2, the upper row: yellow
    assert "128;128;128" in first  # no value: grey


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf", ".jpg", ".webp"])
def test_one_saver_writes_every_format(tmp_path, suffix):
    from fuzzyarm.base.figure_files import save_figure

    panel = Panel([Line((0, 1), (0, 1))], Axis("x"), Axis("y"))
    figure = chart_figure(Chart([[panel]], (2.0, 2.0)))
    save_figure(figure, tmp_path / f"a{suffix}", dpi=40)
    assert (tmp_path / f"a{suffix}").stat().st_size > 500


def test_values_that_are_far_apart_are_drawn_by_their_ratios():
    assert spreads([1.0, 2.0, 5.0])
    for values in ([], [1.0, 4.9], [0.0, 5.0], [-1.0, 5.0]):
        assert not spreads(values)


def test_a_bar_of_type_2_is_sure_up_to_the_lower_membership():
    value = FuzzyValue("x", 1.0, 1.0, (("A", 0.9), ("B", 0.25)), (("A", 0.4), ("B", 0.25)))
    first, second = _memberships(value).plain.splitlines()[1:]
    assert (first.count("█"), first.count("░")) == (8, 10)
    assert (second.count("█"), second.count("░")) == (5, 0)


def test_plots_of_terms_begin_below_one_another():
    names = ("A", "MIDDLE", "BIG")
    terms = tuple(Term(name, Shape("triangle", (-1.0, 5.0, 11.0))) for name in names)
    plots = TermPlots(Input("x", 0.0, 10.0, terms=terms), width=40)
    _, *lines = plain_text(plots, 40).splitlines()
    assert [line.split()[0] for line in lines[:3]] == list(names)
    assert len({line.split(maxsplit=1)[1].rstrip() for line in lines[:3]}) == 1
    assert len({len(line.rstrip()) for line in lines[:3]}) == 1
