"""The region from which a loop is proved to come to rest, with runs in it and beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.picture import COLOURS
from fuzzyarm.show.figures.style import head, label_axes, new_figure, safe, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fuzzyarm.closed_loop.pictures import RegionPlane
    from fuzzyarm.closed_loop.verdicts import LoopVerdict
    from fuzzyarm.controller.text import ControllerText
    from fuzzyarm.plant.plant import Plant

__all__ = ["region_figure"]


def region_figure(text: ControllerText, verdict: LoopVerdict, plant: Plant | None = None) -> Figure:
    """Return the planes of a proved region.

    Parameters
    ----------
    text : ControllerText
        The controller.
    verdict : LoopVerdict
        One that is proved, of a plant with two states or more.
    plant : Plant, optional
        In place of the one that the claim names.
    """
    from fuzzyarm.closed_loop.pictures import region_planes

    planes = region_planes(text, verdict, plant)
    figure = new_figure(4.4 * max(1, len(planes)), 4.2)
    if planes:
        (row,) = figure.subplots(1, len(planes), squeeze=False)
        for axes, plane in zip(row, planes, strict=True):
            _draw(axes, plane)
        lines, words = max(
            (axes.get_legend_handles_labels() for axes in row), key=lambda x: len(x[0])
        )
        figure.legend(lines, words, loc="outside lower center", ncols=3, fontsize=8, frameon=False)
    head(figure, f"{text.model.name}: proved {verdict.statement}")
    return figure


def _draw(axes: Axes, plane: RegionPlane) -> None:
    axes.plot(*plane.settled.T, ".", color="#bbbbbb", markersize=3.0, label="a run came to rest")
    if len(plane.lost):
        axes.plot(
            *plane.lost.T, "x", color=COLOURS[3], markersize=3.5, markeredgewidth=0.8,
            label="a run did not",
        )  # fmt: skip
    axes.fill(*plane.shadow.T, color=COLOURS[0], alpha=0.12, lw=0)
    axes.plot(*plane.shadow.T, color=COLOURS[0], linewidth=0.9, label="never left, once inside")
    if len(plane.start):
        axes.fill(*plane.start.T, color=COLOURS[2], alpha=0.22, lw=0)
        axes.plot(
            *plane.start.T,
            color=COLOURS[2],
            linewidth=1.5,
            label="proved start, the others at rest",
        )
    for k, run in enumerate(plane.runs):
        axes.plot(
            *run.T, color="#333333", linewidth=0.7, alpha=0.8, label="runs" if not k else None
        )
    tidy(axes)
    across, up = (f"{name}, {unit}" for name, unit in zip(plane.names, plane.units, strict=True))
    covered = f"{100.0 * plane.covered:.0f} % of the settled starts shown are proved"
    label_axes(axes, safe(across), safe(up), covered)
