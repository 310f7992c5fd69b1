"""Animated runs: the plant to scale, with outputs, errors and drives growing beside it."""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzyarm.apps.show.drawing import run_words, time_words
from fuzzyarm.apps.show.figures.labels import columns_that_fit
from fuzzyarm.apps.show.figures.panels import draw_part, draw_runs, draw_thing
from fuzzyarm.apps.show.figures.style import new_figure, safe
from fuzzyarm.apps.show.run import summary_panels
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.files import write_atomically
from fuzzyarm.base.picture import TONES
from fuzzyarm.plant.drawings import PlantScene, drawing_of, is_drawn, picture_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fuzzyarm.control.loop import Run
    from fuzzyarm.plant import Plant

SUFFIXES = (".gif", ".mp4", ".html")


class AnimationError(FuzzyarmError, ValueError):
    """An animation cannot be written to `path`."""

    def __init__(self, message: str, *, path: str, hint: str = "") -> None:
        super().__init__(message, hint=hint)
        self.path = path


def animate(
    run: Run,
    plant: Plant,
    path: str | os.PathLike[str],
    *,
    frames: int = 100,
    watch: Callable[[int], None] | None = None,
) -> None:
    """Write the animation of a run, whole or not at all.

    It lasts as long as the run, but 4 s at least and 8 s at most.
    """
    name = os.fspath(path)
    require_animation(name)
    if not run.samples:
        raise AnimationError("the run has no samples to show", path=name)
    frame_numbers = np.unique(
        np.linspace(0, run.samples - 1, min(frames, run.samples)).round().astype(int)
    )
    figure, draw = _scene(run, plant)
    seconds = min(8.0, max(4.0, float(run.time[-1])))
    write_film(figure, draw, frame_numbers, seconds, name, watch=watch)


def write_film(
    figure: Figure,
    draw: Callable[[int], list[Any]],
    frames: Any,
    seconds: float,
    path: str | os.PathLike[str],
    *,
    watch: Callable[[int], None] | None = None,
) -> None:
    """Write the frames of a figure as a film, whole or not at all."""
    name = os.fspath(path)
    suffix = require_animation(name)
    # Laid out once: axes stay, and layout is most of the work of a frame.
    draw(int(frames[-1]))
    engine = figure.get_layout_engine()
    if engine is not None:
        engine.execute(figure)
        figure.set_layout_engine("none")
    figure.set_dpi(_DPI)
    pictures = _pictures(figure, draw, frames, watch)
    rate = max(1, round(len(frames) / seconds))
    if suffix == ".gif":
        content = _gif(figure, pictures, rate)
    else:
        content = _film(figure, pictures, suffix, rate)
    write_atomically(Path(name), content)


_DPI = 90
_HELD = 1500
"""Milliseconds of the last frame of a GIF, before it repeats."""


def _pictures(
    figure: Figure,
    draw: Callable[[int], list[Any]],
    frames: Any,
    watch: Callable[[int], None] | None,
) -> Iterator[None]:
    """Draw one frame after the other into a figure."""
    for frame in frames:
        draw(int(frame))
        yield
        if watch is not None:
            watch(1)


def require_animation(path: str) -> str:
    """Return the suffix of an animation's path."""
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        message = f"an animation is not written as '{suffix or path}'"
        raise AnimationError(message, path=path, hint=f"one of {', '.join(SUFFIXES)}")
    if suffix == ".mp4":
        from matplotlib.animation import FFMpegWriter

        if not FFMpegWriter.isAvailable():
            hint = "install ffmpeg, or write .gif or .html"
            raise AnimationError(f"{path}: ffmpeg is not installed", path=path, hint=hint)
    return suffix


def _film(figure: Figure, pictures: Iterator[None], suffix: str, rate: int) -> bytes:
    """Return a film by matplotlib, written to a temporary file."""
    import tempfile

    from matplotlib.animation import FFMpegWriter, HTMLWriter

    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / f"film{suffix}"
        writer: Any = (
            FFMpegWriter(fps=rate) if suffix == ".mp4" else HTMLWriter(fps=rate, embed_frames=True)
        )
        with writer.saving(figure, place, _DPI):
            for _ in pictures:
                writer.grab_frame()
        return place.read_bytes()


def _gif(figure: Figure, pictures: Iterator[None], rate: int) -> bytes:
    """Return a GIF with one palette of 64 colours: a quarter of the size, and no flicker."""
    from PIL import Image

    canvas: Any = figure.canvas
    images = []
    for _ in pictures:
        canvas.draw()
        images.append(Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB"))
    # The last frame has all curves and thus all colours.
    palette = images[-1].quantize(64, method=Image.Quantize.MAXCOVERAGE)  # white stays white
    reduced = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in images]
    buffer = io.BytesIO()
    reduced[0].save(
        buffer,
        "GIF",
        save_all=True,
        append_images=reduced[1:],
        duration=[*[1000 // rate] * (len(reduced) - 1), _HELD],
        loop=0,
        optimize=True,
    )
    return buffer.getvalue()


# --- The scene: the plant on the left, curves on the right; or curves alone ---

_KEY, _CURVES = 7, 4.0
"""Font size of the curves in points, and their width in inches."""


def _scene(run: Run, plant: Plant) -> tuple[Figure, Callable[[int], list[Any]]]:
    """Return a figure, and a function that draws a sample of the run into it."""
    if not is_drawn(plant):
        curves = draw_runs([run])
        return curves, _cursors(curves, run)
    figure: Any = new_figure(8.0, 4.0)
    left, right = figure.subfigures(1, 2, width_ratios=[1, 1.35])
    axes = left.subplots()
    move = _redraw(run, right)
    name, end = run_words(run.controller, run.plant), float(run.time[-1])

    has_camera = picture_of(plant, PlantScene(run, 0)) is not None  # not tried for each frame

    def draw(index: int) -> list[Any]:
        axes.clear()
        axes.set_title(safe(f"{name}, {time_words(float(run.time[index]), end)} s"), fontsize=9)
        scene = PlantScene(run, index)
        picture = picture_of(plant, scene) if has_camera else None
        if picture is not None:
            axes.imshow(picture)
            axes.set_axis_off()
        elif (drawing := drawing_of(plant, scene)) is not None:
            draw_thing(axes, drawing)
        move(index)
        return []

    return figure, draw


def _redraw(run: Run, home: Any) -> Callable[[int], None]:
    """Draw errors and drives of a run into a part of a figure; return the cursor's setter."""
    pictures = summary_panels(run)
    panels = home.subplots(len(pictures), 1, sharex=True)
    for axes, panel in zip(panels, pictures, strict=True):
        for part in panel.parts:
            draw_part(axes, part)
        axes.set_ylabel(safe(panel.up.words), fontsize=8)
    panels[-1].set_xlabel("time, s", fontsize=8)
    cursors = []
    for panel in panels:
        panel.spines[["top", "right"]].set_visible(False)
        panel.tick_params(labelsize=7)
        _, labels = panel.get_legend_handles_labels()
        columns = columns_that_fit(labels, _KEY, _CURVES)
        panel.legend(
            fontsize=_KEY, frameon=False, loc="lower left", bbox_to_anchor=(0.0, 0.98),
            ncols=columns, borderaxespad=0.0, columnspacing=1.0, handlelength=1.4,
        )  # fmt: skip
        cursors.append(panel.axvline(run.time[0], color=TONES["metal"], linewidth=0.8))

    def move(index: int) -> None:
        for cursor in cursors:
            cursor.set_xdata([run.time[index]] * 2)

    return move


def _cursors(figure: Figure, run: Run) -> Callable[[int], list[Any]]:
    """Return a function that moves a cursor over the curves of a run."""
    lines = [axes.axvline(run.time[0], color=TONES["metal"], linewidth=0.8) for axes in figure.axes]

    def draw(index: int) -> list[Any]:
        for line in lines:
            line.set_xdata([run.time[index]] * 2)
        return list(lines)

    return draw
