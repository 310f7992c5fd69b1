"""Residuals and sweeps as records: the same picture in the terminal, on paper and in a page."""

from __future__ import annotations

import json
import math
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from fuzzyarm.apps.show.drawing import plain_text, scale_of
from fuzzyarm.apps.show.figures.panels import chart_figure
from fuzzyarm.apps.show.panels import HATCH, LinePlot, SurfaceMap, panel_view
from fuzzyarm.apps.show.search import cost_panel
from fuzzyarm.apps.show.start_map import map_panel
from fuzzyarm.apps.show.sweep import edges_of, sweep_chart
from fuzzyarm.apps.show.validation import MOST_RULES, validation_chart
from fuzzyarm.base.picture import (
    Area,
    Axis,
    Band,
    Cells,
    Chart,
    Dots,
    Level,
    Line,
    Panel,
    chart_data,
)
from fuzzyarm.control.loop.sweep import Range
from tests.show.test_panels import dots_of

PAYLOAD, GAIN = Range("payload", 0.0, 2.0, 3), Range("K", 1.0, 100.0, 5, log=True)


class Many(SimpleNamespace):
    """Runs whose error is the gain; those of the largest payload diverge from gain 10 on."""

    def __getitem__(self, metric):
        return self.values[:, None]


@pytest.fixture
def many():
    payload, gain = np.repeat(PAYLOAD.values(), 5), np.tile(GAIN.values(), 3)
    diverged = np.where((payload == 2.0) & (gain >= 9.9), 0.5, np.nan)
    return Many(
        controller="pid", where="reach", outputs=["joint"], units=["degrees"],
        changes={"payload": payload, "K": gain}, change_units={"K": "V"}, diverged=diverged,
        values=np.where(np.isnan(diverged), gain, np.nan),
    )  # fmt: skip


def test_a_map_hatches_what_diverged_and_parts_it_from_the_rest(many):
    (panel,) = sweep_chart([many], [PAYLOAD, GAIN]).panels
    (cells,), (border,) = panel.of(Cells), panel.of(Line)
    assert cells.size == (3, 5)
    assert cells.has_edges
    np.testing.assert_array_equal(np.isnan(cells.values), [[0, 0, k >= 2] for k in range(5)])
    assert cells.value.logarithmic
    assert (cells.value.words, cells.missing) == ("rms, degrees", "diverged")
    assert (panel.across.words, panel.up.words) == ("payload", "K, V")
    # Around a corner of 1 x 3 cells: three edges upright, one level.
    assert sum(map(math.isnan, border.x)) == 4
    assert {x for x in border.x if not math.isnan(x)} <= set(edges_of(PAYLOAD))
    text = plain_text(SurfaceMap(panel, 21, 5), 60)
    rows = text.splitlines()
    assert [row.count(HATCH) for row in rows[:3]] == [7, 7, 7]
    assert float(rows[0].split()[0]) == 100.0  # the middle of the uppermost cells
    assert text.rstrip().endswith("diverged")
    figure = chart_figure(sweep_chart([many], [PAYLOAD, GAIN]))
    assert (figure.axes[0].get_xscale(), figure.axes[0].get_yscale()) == ("linear", "log")
    assert figure.axes[1].get_ylabel() == "rms, degrees"


def test_a_curve_over_one_name_shades_what_diverged(many):
    (panel,) = sweep_chart([many], [GAIN]).panels  # the worst over payload
    (line,), (dots,), bands = panel.of(Line), panel.of(Dots), panel.of(Band)
    np.testing.assert_array_equal(np.isnan(line.y), [False, False, True, True, True])
    assert len(dots.x) == 5
    assert [band.label for band in bands] == ["diverged", "", ""]
    assert [(band.x[0], band.x[1]) for band in bands] == [
        tuple(edges_of(GAIN)[k : k + 2]) for k in (2, 3, 4)
    ]
    rows = plain_text(panel_view(panel, 60, 8), 70).splitlines()
    assert rows[-1].split()[0] == f"{edges_of(GAIN)[0]:.4g}"
    (data,) = chart_data(sweep_chart([many], [GAIN]))
    assert json.loads(json.dumps(data, allow_nan=False)) == data
    assert data["across"]["logarithmic"]


def test_dots_stand_where_a_logarithmic_axis_has_them():
    parts = [Dots([1.0, 10.0, 100.0], [0.0, 1.0, 0.0], "o")]
    panel = Panel(parts, Axis("a", logarithmic=True), Axis("b"))
    columns = sorted({column for column, _ in dots_of(plain_text(LinePlot(panel, 20, 4), 60))})
    assert [column - columns[0] for column in columns] == [0, 20, 39]


@pytest.mark.parametrize("value", [1.0, 3.0, 10.0, 99.0])
def test_a_logarithmic_scale_leads_there_and_back(value):
    from dataclasses import replace

    scale = replace(scale_of([1.0, 100.0]), logarithmic=True)
    assert scale.value(scale.share(value)) == pytest.approx(value)
    assert scale.share(10.0) == pytest.approx(0.5)
    assert (scale.share(0.0), scale.share(1e9)) == (0.0, 1.0)


# --- Residuals ---


def validated(count=40, rules=3):
    """Return a validation with a residual of 0.5 throughout."""
    predicted = np.linspace(-1.0, 1.0, count)
    uses = [
        SimpleNamespace(number=k, mean=0.1 * k, strongest=0.2 * k, never_fires=k == 2)
        for k in range(1, rules + 1)
    ]
    bins = (
        SimpleNamespace(predicted=-0.5, observed=0.0),
        SimpleNamespace(predicted=0.5, observed=1.0),
    )
    return SimpleNamespace(
        predicted=predicted, observed=predicted + 0.5, error=0.5, slope=1.0, intercept=0.5,
        calibration=bins, rules=uses,
    )  # fmt: skip


def test_residuals_calibration_and_rules_are_three_panels():
    chart = validation_chart(validated(), "y", "title")
    residuals, calibration, rules = chart.panels
    (dots,) = residuals.of(Dots)
    np.testing.assert_allclose(dots.y, 0.5)
    assert sorted(level.at for level in residuals.of(Level)) == [-0.5, 0.0, 0.5]
    perfect, line = calibration.of(Line)
    np.testing.assert_allclose(np.subtract(line.y, perfect.y), 0.5)
    strongest, mean = rules.of(Area)
    assert (max(strongest.y), max(mean.y)) == (pytest.approx(0.6), pytest.approx(0.3))
    assert [(dots.x, dots.label) for dots in rules.of(Dots)] == [([2], "never fires")]
    assert [data["title"] for data in chart_data(chart)] == [panel.title for panel in chart.panels]


def test_bars_of_rules_have_the_whole_width_of_the_paper():
    axes = chart_figure(validation_chart(validated(), "y", "title")).axes
    shown = [place for place in axes if place.get_visible()]
    assert len(shown) == 3
    assert shown[2].get_position().width > 1.8 * shown[0].get_position().width
    labels = shown[2].get_legend_handles_labels()[1]
    assert labels == ["strongest", "mean", "never fires"]


def test_dots_without_a_line_are_drawn_in_the_terminal():
    residuals, _, rules = validation_chart(validated(), "y", "title").panels
    rows = {row for _, row in dots_of(plain_text(panel_view(residuals, 60, 9), 70))}
    assert len(rows) == 1  # all residuals are alike
    heights = dots_of(plain_text(panel_view(rules, 60, 9), 70))
    assert min(row for _, row in heights) > 0  # there is room above the bars


def test_without_a_target_only_rules_are_drawn_and_no_more_than_can_be_told_apart():
    validation = validated(rules=MOST_RULES + 5)
    validation.calibration = ()
    (panel,) = validation_chart(validation, "y", "title").panels
    assert "the first" in panel.title
    assert panel.across.high == MOST_RULES + 0.5


@pytest.mark.parametrize(
    ("low", "high", "texts"),
    [
        (0.004, 0.036, ["0.005", "0.01", "0.02"]),
        (0.0045, 0.0098, ["0.005", "0.006", "0.007", "0.008", "0.009"]),
        (0.5, 4000.0, ["1", "10", "100", "1000"]),
    ],
)
def test_numbers_along_a_logarithmic_axis_have_room(low, high, texts):
    across = Axis("K", "V", low, high, logarithmic=True)
    panel = Panel([Line((low, high), (0.0, 1.0), "ink", 1.0)], across)
    figure = chart_figure(Chart([[panel]], (4.6, 4.0), "a title"))
    axis = figure.axes[0].xaxis
    figure.canvas.draw()
    labels = [*axis.get_majorticklabels(), *axis.get_minorticklabels()]
    shown = [text for text in labels if text.get_text() and low <= text.get_position()[0] <= high]
    assert sorted((text.get_text() for text in shown), key=float) == texts
    boxes = sorted((text.get_window_extent() for text in shown), key=lambda box: box.x0)
    assert all(first.x1 < second.x0 for first, second in pairwise(boxes))


def test_the_dots_of_few_trials_are_seen_and_those_of_many_are_small_and_pale():
    def dots(count):
        trials = [SimpleNamespace(score=SimpleNamespace(cost=1.0))] * count
        panel = cost_panel({"search": SimpleNamespace(trials=trials, curve=[1.0] * count)})
        (found,) = panel.of(Dots)
        assert len(found.x) == count
        return found.size, found.opacity

    assert dots(8)[0] >= 4.0
    assert dots(8)[1] >= 0.6
    assert dots(100) == dots(8)
    assert dots(5000) == (1.5, 0.25)


def test_the_scale_of_a_map_of_starts_names_its_three_states():
    box = SimpleNamespace(verdict="proved", low=(0.0, 0.0), high=(1.0, 1.0))
    window = {name: SimpleNamespace(low=-1.0, high=1.0) for name in ("x", "v")}
    found = SimpleNamespace(window=window, units={}, boxes=[box])
    (cells,) = map_panel(found, 4, 4).of(Cells)
    assert cells.value.words == "proved (−1), open (0), lost (1)"
    assert cells.value.whole
    figure = chart_figure(Chart([[map_panel(found, 4, 4)]], (5.0, 4.0)))
    assert [tick for tick in figure.axes[1].get_yticks() if -1 <= tick <= 1] == [-1, 0, 1]
