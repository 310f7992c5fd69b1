"""Figures of the study: error profiles of runs, chapters, all controllers side by side."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.study.comparison import OWN, Compared, ControlStepCost
from fuzzyarm.apps.study.cost import RESOLUTION
from fuzzyarm.apps.study.published import RMS_PLACES, PublishedRow
from fuzzyarm.apps.study.reproduce import Reproduced
from fuzzyarm.base import figure_files
from fuzzyarm.control.controllers.catalogue import CATALOGUE
from fuzzyarm.control.loop.run import Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


# --- Figures of error profiles: the tracking error of both links over time ---

COLOURS = ("#1b6ca8", "#d1495b")
"""Colours of link 1 and link 2; the second is dashed, too."""


def draw_profiles(runs: Sequence[Run], title: str) -> Figure:
    """Draw the error profiles of some runs side by side, one panel for each.

    Parameters
    ----------
    runs : sequence of Run
        At least one.
    title : str
        Above the figure.

    Returns
    -------
    Figure
        Errors in degrees over s.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.2 * len(runs), 3.4), layout="constrained")
    panels = figure.subplots(1, len(runs), squeeze=False)[0]
    for panel, run in zip(panels, runs, strict=True):
        for link, style in ((0, "-"), (1, "--")):
            panel.plot(
                run.time,
                run.error_matrix[:, link],
                style,
                color=COLOURS[link],
                linewidth=1.0,
                label=f"link {link + 1}, RMS {run.rms[link]:.4f}°",
            )
        panel.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
        stopped = f", diverged at {run.diverged:.2f} s" if run.diverged is not None else ""
        panel.set_title(f"{run.trajectory}{stopped}", fontsize=10)
        panel.set_xlabel("time, s")
        panel.set_ylabel("position error, degrees")
        panel.legend(fontsize=8, frameon=False)
        panel.spines[["top", "right"]].set_visible(False)
    figure.suptitle(title, fontsize=11)
    return figure


def save_figure(figure: Figure, path: str | Path) -> None:
    """Write a figure in the format of its suffix, whole or not at all.

    Parameters
    ----------
    figure : Figure
        Any of matplotlib.
    path : path-like
        Its suffix is the format.
    """
    figure_files.save_figure(figure, path, dpi=130)


# --- Figures of many rows: chapters, and all controllers beside each other ---

SUMMARY = "7"
"""The chapter that only repeats rows of others."""

FAMILIES = {
    "4": ("conventional", "#3b6ea5"),
    "5": ("adaptive", "#2f8f6b"),
    "6": ("fuzzy", "#c8553d"),
}
"""Chapter → name and colour of its controllers."""

MARKS = {"4": "o", "5": "s", "6": "^", "": "D"}
"""Chapter, or none → mark of its controllers, distinct without colours."""

OWN_COLOUR = "#6a3d9a"
"""Colour of controllers beyond the study."""

ACROSS = 3
"""Rows side by side in the figure of a chapter."""


def chapter_of(row: PublishedRow) -> str:
    """Return the chapter of a row; rows of the summary belong to their controller's."""
    first = row.table[0]
    return first if first != SUMMARY else chapter_of_controller(row.controller)


def chapter_of_controller(name: str) -> str:
    """Return the chapter of a controller, empty beyond the study."""
    if name in OWN or name not in CATALOGUE:
        return ""
    if CATALOGUE[name].accepts:
        return "6"
    return "5" if name.partition("+")[0] in {"acdid", "mrac", "dac"} else "4"


def draw_chapter(results: Sequence[Reproduced], title: str) -> Figure:
    """Draw small error profiles of rows, first and second trajectory side by side.

    Parameters
    ----------
    results : sequence of Reproduced
        Rows of one chapter.
    title : str
        Above the figure.

    Returns
    -------
    Figure
        A row for each of them.
    """
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.ticker import MaxNLocator

    lines = -(-len(results) // ACROSS)
    figure = Figure(figsize=(5.4 * ACROSS, 1.75 * lines + 0.9), layout="constrained")
    panels = figure.subplots(lines, 2 * ACROSS, squeeze=False)
    for panel in panels.flat:
        panel.set_visible(False)
    for index, result in enumerate(results):
        line, place = divmod(index, ACROSS)
        for side, run in enumerate(result.runs):
            panel = panels[line][2 * place + side]
            panel.set_visible(True)
            for link, style in ((0, "-"), (1, "--")):
                panel.plot(
                    run.time, run.error_matrix[:, link], style, color=COLOURS[link], linewidth=0.7
                )
            panel.axhline(0.0, color="0.6", linewidth=0.5, zorder=0)
            panel.spines[["top", "right"]].set_visible(False)
            panel.tick_params(labelsize=7)
            panel.margins(x=0.0)
            panel.xaxis.set_major_locator(MaxNLocator(5, integer=True))
            if side == 0:
                row = result.published
                variant = "" if result.variant == "as-printed" else f", {result.variant}"
                panel.set_title(f"{row.table} {row.row}{variant}", fontsize=8.5, loc="left")
                panel.set_ylabel("error, °", fontsize=7)
            else:
                panel.set_title(run.trajectory, fontsize=7, loc="right", color="0.4")
            if line == lines - 1:
                panel.set_xlabel("time, s", fontsize=7)
    figure.suptitle(title, fontsize=12)
    figure.legend(
        handles=[
            Line2D([], [], linestyle="-", color=COLOURS[0], label="link 1"),
            Line2D([], [], linestyle="--", color=COLOURS[1], label="link 2"),
        ],
        loc="outside upper right",
        ncols=2,
        fontsize=9,
        frameon=False,
    )
    return figure


HEADINGS = ("link 1, {first}", "link 2, {first}", "link 1, {second}", "link 2, {second}")


def draw_overview(results: Sequence[Reproduced]) -> Figure:
    """Draw the RMS errors of all rows: published rings, reproduced dots, bands of chance.

    The rows are on the same pair of trajectories, in the order of the table.

    Parameters
    ----------
    results : sequence of Reproduced
        Rows of all chapters.

    Returns
    -------
    Figure
        With RMS errors in degrees.
    """
    from matplotlib.figure import Figure

    rows = [result for result in results if result.variant == "as-printed"]
    height = 1.9 + 0.24 * len(rows)
    figure = Figure(figsize=(13.0, height), layout="constrained")
    panels: Any = figure.subplots(1, 4, sharey=True, squeeze=False)[0]
    first, second = rows[0].published.trajectories
    for column, (panel, place) in enumerate(zip(panels, RMS_PLACES, strict=True)):
        for height, result in enumerate(rows):
            _mark(panel, -height, result, place)
        panel.set_xscale("log")
        figure_files.plain_powers(panel, "x", *panel.get_xlim())
        panel.set_title(HEADINGS[column].format(first=first, second=second), fontsize=10)
        panel.set_xlabel("RMS error at the set points, degrees", fontsize=9)
        panel.grid(axis="x", color="0.9", linewidth=0.7)
        panel.set_axisbelow(True)
        panel.spines[["top", "right", "left"]].set_visible(False)
        panel.tick_params(axis="y", length=0)
    names = [result.published.row for result in rows]
    colours = [FAMILIES[chapter_of(result.published)][1] for result in rows]
    panels[0].set_yticks([-height for height in range(len(names))])
    panels[0].set_yticklabels(names, fontsize=9)
    panels[0].set_ylim(-len(names) + 0.4, 0.6)
    for label, colour in zip(panels[0].get_yticklabels(), colours, strict=True):
        label.set_color(colour)
    _key(figure, rows)
    return figure


def _mark(panel: Axes, height: float, result: Reproduced, place: int) -> None:
    colour = FAMILIES[chapter_of(result.published)][1]
    panel.axhline(height, color="0.94", linewidth=0.7, zorder=0)
    ensemble = result.ensemble
    if ensemble is not None:
        ends = [ensemble.lowest[place], ensemble.highest[place]]
        panel.plot(ends, [height, height], color=colour, alpha=0.35, linewidth=5.0, zorder=1)
    panel.plot(result.figures[place], height, "o", color=colour, markersize=4.0, zorder=3)
    published = result.published.figures[place]
    panel.plot(published, height, "o", color="black", markersize=8.5, fillstyle="none", zorder=2)


def _key(figure: Figure, chosen: Sequence[Reproduced]) -> None:
    from matplotlib.lines import Line2D

    ring: dict[str, Any] = {"marker": "o", "linestyle": "none"}
    chapters = {chapter_of(result.published) for result in chosen}
    entries = [
        Line2D([], [], color="black", fillstyle="none", markersize=8.5, label="published", **ring),
        Line2D([], [], color="0.3", markersize=4.0, label="reproduced", **ring),
    ]
    if any(result.ensemble is not None for result in chosen):
        label = "spread when the last bit is disturbed"
        entries.append(Line2D([], [], color="0.3", alpha=0.35, linewidth=5.0, label=label))
    for chapter, (name, colour) in FAMILIES.items():
        if chapter in chapters:
            entries.append(Line2D([], [], color=colour, markersize=4.0, label=name, **ring))
    figure.legend(
        handles=entries, loc="outside lower center", ncols=len(entries), fontsize=9, frameon=False
    )


# --- Error against cost ---


def draw_cost(
    compared: Sequence[Compared], costs: Sequence[ControlStepCost], title: str = ""
) -> Figure:
    """Draw mean errors of controllers against operations and time of a control step.

    A mark is the error from the path; a line leads to the error at the set points. The title states
    the conditions.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13.0, 7.0), layout="constrained")
    panels: Any = figure.subplots(1, 2, sharey=True)
    least = f"< {1e9 * RESOLUTION:.0f}"
    headings = {
        "floating-point operations of a control step, both joints": [
            cost.operations.total for cost in costs
        ],
        f"time of a control step in the loop, both joints, ns ({least} drawn there)": [
            1e9 * (cost.seconds or RESOLUTION) for cost in costs
        ],
    }
    for panel, (heading, values) in zip(panels, headings.items(), strict=True):
        _draw_points(panel, compared, values)
        panel.set_xlabel(heading, fontsize=9)
    panels[0].set_ylabel(
        "geometric mean of the RMS errors, degrees: from the path, line to that at the set points",
        fontsize=9,
    )
    if title:
        figure.suptitle(title, fontsize=9)
    _key_of_families(figure, [comparison.name for comparison in compared])
    return figure


def _draw_points(panel: Axes, compared: Sequence[Compared], values: Sequence[float]) -> None:
    for controller, value in zip(compared, values, strict=True):
        chapter = chapter_of_controller(controller.name)
        colour = _colour_of(chapter)
        ends = [controller.path_error, controller.error]
        panel.plot([value, value], ends, color=colour, linewidth=0.8, alpha=0.6)
        panel.plot(value, controller.path_error, MARKS[chapter], color=colour, markersize=5.0)
    panel.set_xscale("log")
    panel.set_yscale("log")
    panel.grid(color="0.92", linewidth=0.7)
    panel.set_axisbelow(True)
    panel.spines[["top", "right"]].set_visible(False)
    panel.margins(x=0.16, y=0.06)
    figure_files.plain_powers(panel, "x", *panel.get_xlim())
    figure_files.plain_powers(panel, "y", *panel.get_ylim())
    points = [
        (math.log10(x), math.log10(comparison.path_error))
        for x, comparison in zip(values, compared, strict=True)
    ]
    scale = [
        size / (math.log10(high) - math.log10(low))
        for size, (low, high) in zip(PANEL, (panel.get_xlim(), panel.get_ylim()), strict=True)
    ]
    spots = [(x * scale[0], y * scale[1]) for x, y in points]
    offsets = place_labels(spots, [comparison.name for comparison in compared])
    for controller, value, (right, up) in zip(compared, values, offsets, strict=True):
        to_the_left = right < -0.5 * _width(controller.name)
        panel.annotate(
            controller.name,
            (value, controller.path_error),
            # Widths are estimates: a label on the left is aligned at its end.
            xytext=(-BESIDE if to_the_left else right, up),
            textcoords="offset points",
            fontsize=LETTERS,
            ha="right" if to_the_left else "left",
            va="center",
            color=_colour_of(chapter_of_controller(controller.name)),
        )


PANEL = (420.0, 430.0)
"""Size of a panel of costs in points."""

LETTERS = 7.0
"""Font size in points; a character is about half as wide."""

BESIDE = 6.0
"""Distance of a mark and its label in points."""


def place_labels(
    spots: Sequence[tuple[float, float]], labels: Sequence[str]
) -> list[tuple[float, float]]:
    """Return the offset of each label from its mark, with the least overlap."""
    # Occupied rectangles: left, bottom, right, top. First the marks, then the labels in turn.
    boxes = [(x - 4.0, y - 4.0, x + 4.0, y + 4.0) for x, y in spots]
    positions = []
    for (x, y), label in zip(spots, labels, strict=True):
        width, height = _width(label), 1.15 * LETTERS
        sides = [
            (right, up)
            for up in (0.0, 7.0, -7.0, 13.0, -13.0, 19.0, -19.0)
            for right in (BESIDE, -BESIDE - width, -0.5 * width)
            if up or right != -0.5 * width
        ]

        def covered(
            side: tuple[float, float], at: tuple[float, ...] = (x, y, width, height)
        ) -> float:
            left, bottom = at[0] + side[0], at[1] + side[1] - 0.5 * at[3]
            return sum(
                max(0.0, min(left + at[2], other[2]) - max(left, other[0]))
                * max(0.0, min(bottom + at[3], other[3]) - max(bottom, other[1]))
                for other in boxes
            )

        best = min(sides, key=covered)
        left, bottom = x + best[0], y + best[1] - 0.5 * height
        boxes.append((left, bottom, left + width, bottom + height))
        positions.append(best)
    return positions


def _width(label: str) -> float:
    return 0.55 * LETTERS * len(label)


def _colour_of(chapter: str) -> str:
    return FAMILIES[chapter][1] if chapter else OWN_COLOUR


def _key_of_families(figure: Figure, names: Sequence[str]) -> None:
    from matplotlib.lines import Line2D

    chapters = {chapter_of_controller(name) for name in names}
    marks: dict[str, Any] = {"linestyle": "none", "markersize": 5.0}
    entries = [
        Line2D([], [], marker=MARKS[chapter], color=colour, label=name, **marks)
        for chapter, (name, colour) in FAMILIES.items()
        if chapter in chapters
    ]
    if "" in chapters:
        entries.append(
            Line2D([], [], marker=MARKS[""], color=OWN_COLOUR, label="beyond the study", **marks)
        )
    figure.legend(
        handles=entries, loc="outside lower center", ncols=len(entries), fontsize=9, frameon=False
    )
