"""A run in the terminal: the plant to scale in braille, errors and drives beside it."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from fuzzyarm.apps.show.canvas import drawing_lines
from fuzzyarm.apps.show.drawing import run_words, time_words
from fuzzyarm.apps.show.panels import panel_lines
from fuzzyarm.apps.show.run import drive_panel, drives_that_move, error_panel
from fuzzyarm.plant.drawings import PlantScene, drawing_of

if TYPE_CHECKING:
    from rich.console import Console, RenderableType
    from rich.text import Text

    from fuzzyarm.control.loop import Run
    from fuzzyarm.plant import Plant

RATE = 12
"""Pictures per second."""

LONGEST = 8.0
"""Longest duration in seconds; longer runs are shown faster."""


# --- Picture of a run ---


class LiveView:
    """Pictures of a run, sample by sample.

    Parameters
    ----------
    run : Run
        With samples.
    plant : Plant
        Its plant.
    unicode : bool, optional
        Whether the terminal has braille.
    """

    def __init__(self, run: Run, plant: Plant, *, unicode: bool = True) -> None:
        self.run, self.plant, self.unicode = run, plant, unicode

    def at(self, index: int, width: int, height: int) -> RenderableType:
        """Return the picture of a sample in the given size, in characters."""
        from rich.console import Group
        from rich.table import Table
        from rich.text import Text

        run = self.run
        title = Text(run_words(run.controller, run.plant), "bold", no_wrap=True)
        end = float(run.time[-1])
        now = time_words(float(run.time[index]), end)
        title.append(f"  {now} of {time_words(end, end)} s", "not bold")
        rows = max(4, height - 1)
        left = max(12, min(2 * rows, width // 2))
        plant = self._plant(index, left, rows)
        if not plant:
            return Group(title, *self._curves(index, width, rows))
        table = Table.grid(padding=(0, 2, 0, 0))
        table.add_column(width=left, no_wrap=True)
        table.add_column(width=max(10, width - left - 2), no_wrap=True)
        table.add_row(Group(*plant), Group(*self._curves(index, width - left - 2, rows)))
        return Group(title, table)

    def _plant(self, index: int, columns: int, rows: int) -> list[Text]:
        """Return the lines of the drawing of the plant, if it has one."""
        drawing = drawing_of(self.plant, PlantScene(self.run, index))
        if drawing is None:
            return []
        return drawing_lines(drawing, columns, rows, unicode=self.unicode)

    def _curves(self, index: int, width: int, rows: int) -> list[Text]:
        """Return errors and drives up to a sample, each below its name."""
        run = self.run
        panels = [error_panel([run], column) for column in range(len(run.labels))]
        panels += [drive_panel([run], name) for name in drives_that_move([run], list(run.drives))]
        panels = panels[: max(1, rows // 3)]
        height = max(1, rows // len(panels) - 1)
        lines: list[Text] = []
        for panel in panels:
            lines += panel_lines(panel, index, (width, height), unicode=self.unicode)
        return lines


def frames_of(run: Run) -> list[int]:
    """Return the samples to show: in real time, or faster in a long run."""
    seconds = min(LONGEST, max(1.0, float(run.time[-1])))
    count = min(run.samples, max(2, round(RATE * seconds)))
    return sorted({round(k * (run.samples - 1) / max(1, count - 1)) for k in range(count)})


def play(run: Run, plant: Plant, console: Console) -> bool:
    """Show a run in a terminal; the last picture stays."""
    from rich.live import Live

    has_braille = "utf" in (console.encoding or "").lower()
    view = LiveView(run, plant, unicode=has_braille)
    frames = frames_of(run)
    width, height = min(console.width, 110), max(8, min(console.height - 2, 26))
    pause = min(LONGEST, max(1.0, float(run.time[-1]))) / len(frames)
    try:
        with Live(console=console, auto_refresh=False) as live:
            due = time.monotonic()
            for index in frames:
                live.update(view.at(index, width, height), refresh=True)
                due = max(due + pause, time.monotonic() - 1.0)
                time.sleep(max(0.0, due - time.monotonic()))
    except KeyboardInterrupt:
        return False
    return True
