from __future__ import annotations

import numpy as np
import pytest

from fuzzyarm.apps.show.figures import (
    FigureFileError,
    inference_figure,
    memberships_figure,
    rulebase_figure,
    save_figure,
    surface_figure,
    table_figure,
)
from fuzzyarm.apps.show.figures.style import new_figure, tidy
from fuzzyarm.apps.show.figures.surface import without_noise
from fuzzyarm.inference import explain, infer
from fuzzyarm.language import parse
from fuzzyarm.table import Axis, LookupTable, compile_table

ASYMMETRIC = LookupTable(
    (Axis("e", (-1, 0, 2), description="error, V"), Axis("ce", (0, 10, 20, 40))),
    "u",
    [[1, 2, 3, 4], [5, 6, 7, 8], [9, 10, 11, 12]],
)


def labels(axes) -> list[str]:
    return [text.get_text() for text in axes.texts]


def test_the_cells_of_a_table_stand_where_they_stand_in_the_file():
    figure = table_figure(ASYMMETRIC)
    axes = figure.axes[0]
    np.testing.assert_array_equal(axes.images[0].get_array(), ASYMMETRIC.values)
    assert (axes.get_ylabel(), axes.get_xlabel()) == ("e: error, V", "ce")
    assert [t.get_text() for t in axes.get_yticklabels()] == ["-1", "0", "2"]
    assert [t.get_text() for t in axes.get_xticklabels()] == ["0", "10", "20", "40"]
    place = {text.get_text(): text.get_position() for text in axes.texts}
    assert place["12"] == (3, 2)  # column, row
    assert place["4"] == (3, 0)


def test_the_map_of_a_surface_has_the_second_input_to_the_right(lopsided):
    figure = surface_figure(lopsided)
    flat = next(axes for axes in figure.axes if axes.get_ylabel().startswith("a"))
    assert flat.get_xlabel() == "b: second input, mm"
    mesh = flat.collections[0]
    values = np.asarray(mesh.get_array()).reshape(121, 121)
    places = mesh.get_coordinates()
    for i, j in [(0, 120), (120, 0), (30, 90)]:
        b, a = places[i, j]
        assert values[i, j] == pytest.approx(infer(lopsided, a=a, b=b)["y"])


def test_more_inputs_are_held_at_the_middle_or_where_one_says():
    from fuzzyarm.language import parse

    text = (
        "rulebase r\ninput a 0 .. 1\ninput b 0 .. 4\ninput c 0 .. 1\noutput y 0 .. 1\n"
        "terms a, b, c, y: triangles LO HI\n"
        "rule if a is LO and b is LO then y is LO\nrule if a is HI or b is HI then y is HI\n"
        "rule if c is HI then y is HI\nrule if c is LO then y is LO\n"
    )
    rulebase = parse(text).rulebase
    middle = surface_figure(rulebase)
    assert any(axes.get_title() == "c = 0.5" for axes in middle.axes)
    named = surface_figure(rulebase, at={"b": 3})
    assert any(axes.get_title() == "b = 3" for axes in named.axes)
    assert any(axes.get_xlabel() == "c" for axes in named.axes)


def test_one_input_gives_a_line_and_steps():
    from fuzzyarm.language import parse

    text = "rulebase r\ninput a 0 .. 1\noutput y 0 .. 1\nterms a, y: triangles LO HI\n"
    rulebase = parse(text + "rule if a is LO then y is HI\nrule if a is HI then y is LO\n").rulebase
    line = surface_figure(rulebase).axes[0].lines[0]
    assert line.get_ydata()[0] == pytest.approx(infer(rulebase, a=0.0)["y"])
    assert line.get_ydata()[-1] == pytest.approx(infer(rulebase, a=1.0)["y"])
    table = compile_table(rulebase, levels=5)
    steps = table_figure(table, at={"a": 0.3}).axes[0].lines[0]
    assert set(steps.get_ydata()) == set(table.values)


def test_every_term_is_named_in_its_panel(lopsided):
    figure = memberships_figure(lopsided)
    assert [labels(axes) for axes in figure.axes] == [
        ["LO", "HI"],
        ["N", "Z", "P"],
        ["S", "M", "L"],
    ]
    assert figure.axes[0].get_xlabel() == "a: first input, V"


def test_the_picture_of_an_inference_shows_its_value(lopsided):
    trace = explain(lopsided, a=3.5, b=0.25)
    figure = inference_figure(lopsided, trace)
    output = next(axes for axes in figure.axes if axes.get_xlabel().startswith("y"))
    value = trace.outputs[0].value
    assert output.get_title().startswith(f"y = {value:.6g}")
    assert any(np.allclose(line.get_xdata(), value) for line in output.lines)
    named = [text.get_text().split()[0] for text in output.get_legend().get_texts()]
    assert named == [each.term for each in trace.outputs[0].consequents]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("suffix", "start"), [(".png", b"\x89PNG"), (".svg", b"<?xml"), (".pdf", b"%PDF")]
)
def test_the_same_figure_gives_the_same_bytes(tmp_path, lopsided, suffix, start):
    paths = [tmp_path / f"{k}{suffix}" for k in "ab"]
    for path in paths:
        save_figure(memberships_figure(lopsided), path, dpi=60)
    first, second = (path.read_bytes() for path in paths)
    assert first == second
    assert first.startswith(start)


def test_unknown_figure_formats_are_refused(tmp_path, lopsided):
    with pytest.raises(FigureFileError, match=r"'x.gif' .*known: \.png, \.svg, \.pdf"):
        save_figure(memberships_figure(lopsided), tmp_path / "x.gif")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_names_with_dollars_are_no_mathematics(tmp_path, lopsided_text):
    from fuzzyarm.language import parse

    text = lopsided_text.replace("first input, V", "price, $ and $x_$")
    save_figure(rulebase_figure(parse(text).rulebase), tmp_path / "x.svg")
    assert "price, $ and $x_$" in (tmp_path / "x.svg").read_text("utf-8")


def test_a_surface_is_blank_where_no_rule_fires(tmp_path):
    from fuzzyarm.language import parse

    text = (
        "rulebase r\ninput a 0 .. 1\ninput b 0 .. 1\noutput y 0 .. 1\nterms y: triangles LO HI\n"
        "term a LO: triangle 0 0 0.5\nterm b LO: triangle 0 0 1\n"
        "rule if a is LO and b is LO then y is HI\n"
    )
    rulebase = parse(text).rulebase
    figure = surface_figure(rulebase)
    flat = next(axes for axes in figure.axes if axes.get_ylabel() == "a")
    assert flat.get_title() == "blank: no rule fires"
    values = flat.collections[0].get_array().reshape(121, 121)
    assert np.ma.getmaskarray(values)[60:].all()
    assert not np.ma.getmaskarray(values)[:60, :120].any()
    save_figure(figure, tmp_path / "gaps.png")


PLATEAU = """rulebase p
input a 0 .. 1
input b 0 .. 1
output {name} 0 .. 1
term a low: trapezoid 0 0 0.4 0.5
term a high: trapezoid 0.4 0.5 1 1
term b all: trapezoid 0 0 1 1
term {name} little: triangle 0 0.1 0.2
term {name} much: triangle 0.8 0.9 1
inference defuzzifier centroid exact
rule if a is low and b is all then {name} is little
rule if a is high and b is all then {name} is much
"""


@pytest.mark.slow
@pytest.mark.parametrize("name", ["u", "out", "duty", "power", "heating"])
def test_the_vertical_label_of_a_surface_is_within_the_figure(tmp_path, name):
    figure = surface_figure(parse(PLATEAU.format(name=name)).rulebase)
    save_figure(figure, str(tmp_path / "f.png"))
    box = figure.axes[0].zaxis.label.get_window_extent()
    assert figure.axes[0].get_zlabel() == name
    assert box.x0 >= 0
    assert box.x1 <= figure.bbox.x1


FORMULAS = """rulebase p
input a 0 .. 1
input 'valve opening %' 0 .. 1
input c 0 .. 1
output 'out put (bar)' -4 .. 4
term a low: trapezoid 0 0 1 1
term 'out put (bar)' R: linear -2*a - 0.2472*'valve opening %' - 3
inference defuzzifier weighted-average
rule if a is low then 'out put (bar)' is R
"""


@pytest.mark.slow
def test_a_page_of_four_variables_has_its_labels_and_formulas(tmp_path):
    figure = rulebase_figure(parse(FORMULAS).rulebase)
    save_figure(figure, str(tmp_path / "f.png"))
    (space,) = (axes for axes in figure.axes if hasattr(axes, "zaxis"))
    assert space.zaxis.label.get_window_extent().x0 >= 0
    texts = " ".join(" ".join(text.split()) for axes in figure.axes for text in labels(axes))
    assert "linear -2*a - 0.2472*'valve opening %' - 3" in texts


def test_noise_of_rounding_draws_no_contour_line():
    level = 0.1
    values = np.where(np.arange(21)[:, None] < 10, level, 0.9) + np.zeros((21, 21))
    noisy = values + 1e-15 * np.random.default_rng(1).standard_normal(values.shape)
    assert set(np.unique(without_noise(noisy))) == {0.1, 0.9}
    # Of a constant nothing but noise is left.
    assert np.unique(without_noise(2.5 + (noisy - values))).size == 1
    assert not without_noise(np.zeros((3, 3))).any()
    # What a picture resolves stays.
    slope = np.linspace(-3.0, 7.0, 1001)
    assert np.abs(without_noise(slope) - slope).max() <= 1e-5


def test_no_label_stands_on_a_cliff_where_contour_lines_meet():
    def written(width):
        text = PLATEAU.format(name="u").replace("0.5", str(0.4 + width))
        return labels(surface_figure(parse(text).rulebase).axes[1])

    assert written(0.001) == []
    assert written(0.5)


def test_milliseconds_are_written_as_they_are():
    axes = new_figure(4, 3).subplots()
    axes.plot([0.0, 0.0005], [0, 1])
    tidy(axes)
    axes.figure.canvas.draw()
    assert axes.xaxis.get_offset_text().get_text() == ""
    assert "0.0002" in [label.get_text() for label in axes.get_xticklabels()]


def test_a_narrow_logarithmic_axis_has_plain_numbers_that_do_not_meet():
    from matplotlib.figure import Figure

    from fuzzyarm.base.figure_files import plain_powers

    figure = Figure(figsize=(3.0, 2.0))
    axes = figure.subplots()
    axes.plot([25.0, 250.0], [0.0, 1.0])
    axes.set_xscale("log")
    plain_powers(axes, "x", *axes.get_xlim())
    figure.draw_without_rendering()
    labels = [*axes.get_xticklabels(which="both")]
    shown = [each for each in labels if each.get_text() and 20 < each.get_position()[0] < 280]
    assert {each.get_text() for each in shown} == {"50", "100", "200"}
