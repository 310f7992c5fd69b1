"""Figures of error profiles: the tracking error of both links over time."""

from __future__ import annotations

import errno
import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fuzzyarm.control.run import Run
from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.files import write_atomically

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLOURS = ("#1b6ca8", "#d1495b")
"""Of link 1 and link 2; told apart in grey, too, by the dashes of the second."""


def draw_profiles(runs: Sequence[Run], title: str) -> Figure:
    """Draw the error profiles of some runs side by side.

    Parameters
    ----------
    runs : sequence of Run
        One panel for each.
    title : str
        Above all panels.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.2 * len(runs), 3.4), layout="constrained")
    panels = figure.subplots(1, len(runs), squeeze=False)[0]
    for panel, run in zip(panels, runs, strict=True):
        for link, style in ((0, "-"), (1, "--")):
            panel.plot(
                run.time,
                run.errors[:, link],
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


class FigureFormatError(FuzzyarmError, ValueError):
    """Figures are not drawn in the format of this `suffix`."""

    def __init__(self, suffix: str) -> None:
        super().__init__(f"no figure format '{suffix}'", hint=f"one of {', '.join(FORMATS)}")
        self.suffix = suffix


FORMATS = ("png", "svg", "pdf", "jpg", "webp")
"""In which figures are written."""


def figure_format(path: str | Path) -> str:
    """Return the format that the suffix of `path` asks for.

    Raises
    ------
    FigureFormatError
        If it is none of :data:`FORMATS`.
    FileNotFoundError
        If the folder is not there.
    """
    suffix = Path(path).suffix.lstrip(".").lower()
    if suffix not in FORMATS:
        raise FigureFormatError(suffix)
    folder = Path(path).parent
    if not folder.is_dir():
        raise FileNotFoundError(errno.ENOENT, "no such folder", str(folder))
    return suffix


def save_figure(figure: Figure, path: str | Path) -> None:
    """Write a figure in the format of its suffix, whole or not at all.

    Raises
    ------
    FigureFormatError, FileNotFoundError
        See :func:`figure_format`.
    """
    buffer = io.BytesIO()
    figure.savefig(buffer, format=figure_format(path), dpi=130)
    write_atomically(path, buffer.getvalue())
