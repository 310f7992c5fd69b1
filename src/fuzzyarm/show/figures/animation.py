"""A run that moves: the plant to scale, and beside it outputs, errors and drives as they grow."""

from __future__ import annotations

import io
import math
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.show.figures.run import draw_runs
from fuzzyarm.show.figures.style import COLOURS, new_figure, safe
from fuzzyarm.text.files import write_atomically

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fuzzyarm.loop import Run
    from fuzzyarm.plant import Plant

SUFFIXES = (".gif", ".mp4", ".html")
LINK, SECOND, WANTED, LOAD, METAL = COLOURS[0], COLOURS[1], "#999999", COLOURS[3], "#444444"


class AnimationError(FuzzyarmError, ValueError):
    """An animation cannot be written; `path` is where to."""

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
    """Write the animation of a run, whole or not at all; it plays as long as the run, up to 8 s.

    Parameters
    ----------
    run : Run
        With samples.
    plant : Plant
        On which it ran. One of a user's own is drawn by its ``draw(axes, x)``, where `x` are its
        outputs, and otherwise as curves alone.
    path : path-like
        ``.gif``, ``.html`` (one file, with buttons) or ``.mp4`` (with ffmpeg).
    frames : int, optional
        How many pictures.
    watch : callable, optional
        Called with 1 for each picture; for progress bars.

    Raises
    ------
    AnimationError
        If the suffix is another, there is nothing to show, or there is no ffmpeg.
    """
    name = os.fspath(path)
    require_animation(name)
    if not run.samples:
        raise AnimationError("the run has no samples to show", path=name)
    shown = np.unique(np.linspace(0, run.samples - 1, min(frames, run.samples)).round().astype(int))
    figure, draw = _scene(run, plant)
    seconds = min(8.0, max(1.0, float(run.time[-1])))
    write_film(figure, draw, shown, seconds, name, watch=watch)


def write_film(
    figure: Figure,
    draw: Callable[[int], list[Any]],
    frames: Any,
    seconds: float,
    path: str | os.PathLike[str],
    *,
    watch: Callable[[int], None] | None = None,
) -> None:
    """Write the pictures that a figure goes through, whole or not at all.

    Parameters
    ----------
    figure : Figure
        Where they are drawn.
    draw : callable
        Draws the frame of a number.
    frames : sequence of int
        The numbers.
    seconds : float
        How long the film is.
    path : path-like
        ``.gif``, ``.html`` or ``.mp4``.
    watch : callable, optional
        Called with 1 for each picture; for progress bars.

    Raises
    ------
    AnimationError
        If the suffix is another, or there is no ffmpeg.
    """
    name = os.fspath(path)
    suffix = require_animation(name)
    # Laid out once: the places of axes are most of the work of a picture, and stay.
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


_DPI = 72


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
    """Return the suffix of a path that an animation can have.

    Raises
    ------
    AnimationError
        If it is another, or what it needs is not installed.
    """
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
    """Return a film that matplotlib writes, to a file of its own."""
    import tempfile

    from matplotlib.animation import FFMpegWriter, HTMLWriter

    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / f"film{suffix}"
        writer: Any = (
            FFMpegWriter(fps=rate) if suffix == ".mp4" else HTMLWriter(fps=rate, embed_frames=True)  # type: ignore[no-untyped-call]
        )
        with writer.saving(figure, place, _DPI):
            for _ in pictures:
                writer.grab_frame()
        return place.read_bytes()


def _gif(figure: Figure, pictures: Iterator[None], rate: int) -> bytes:
    """Return a GIF with one palette of 64 colours: a quarter of its size, and no flicker."""
    from PIL import Image

    canvas: Any = figure.canvas
    drawn = []
    for _ in pictures:
        canvas.draw()
        drawn.append(Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB"))
    palette = drawn[-1].quantize(64)
    reduced = [each.quantize(palette=palette, dither=Image.Dither.NONE) for each in drawn]
    buffer = io.BytesIO()
    reduced[0].save(
        buffer,
        "GIF",
        save_all=True,
        append_images=reduced[1:],
        duration=1000 // rate,
        loop=0,
        optimize=True,
    )
    return buffer.getvalue()


# --- The scene: the plant on the left, curves on the right; or curves alone ---


def _scene(run: Run, plant: Plant) -> tuple[Figure, Callable[[int], list[Any]]]:
    """Return a figure, and what draws a sample of the run into it."""
    picture = DRAWN.get(run.plant) or _own_picture(plant)
    if picture is None:
        curves = draw_runs([run])
        return curves, _cursors(curves, run)
    figure: Any = new_figure(9.6, 4.8)
    left, right = figure.subfigures(1, 2, width_ratios=[1, 1.35])
    axes = left.subplots()
    move = _redraw(run, right)

    def draw(index: int) -> list[Any]:
        axes.clear()
        axes.set_title(
            safe(f"{run.controller} on {run.plant}, {run.time[index]:.2f} s"), fontsize=9
        )
        picture.draw(axes, Scene(run, plant, index))
        move(index)
        return []

    return figure, draw


def _redraw(run: Run, home: Any) -> Callable[[int], None]:
    """Draw errors and drives of a run into a part of a figure; return what moves the cursor."""
    drives = [name for name in run.drives if np.any(run.drives[name])] or list(run.drives)[:1]
    panels = home.subplots(2, 1, sharex=True)
    for column, label in enumerate(run.labels):
        colour = COLOURS[column % len(COLOURS)]
        panels[0].plot(
            run.time, run.errors[:, column], color=colour, linewidth=1.0, label=safe(label)
        )
    panels[0].set_ylabel(safe(f"error, {run.units[0]}"), fontsize=8)
    for column, name in enumerate(drives):
        colour = COLOURS[column % len(COLOURS)]
        panels[1].plot(run.time, run.drives[name], color=colour, linewidth=0.9, label=safe(name))
    units = dict.fromkeys(run.drive_units[name] for name in drives)  # those of the arm: two
    panels[1].set_ylabel(safe(", ".join(units)), fontsize=8)
    panels[1].set_xlabel("time, s", fontsize=8)
    cursors = []
    for panel in panels:
        panel.spines[["top", "right"]].set_visible(False)
        panel.tick_params(labelsize=7)
        panel.legend(fontsize=7, frameon=False, loc="upper right")
        cursors.append(panel.axvline(run.time[0], color=METAL, linewidth=0.8))

    def move(index: int) -> None:
        for cursor in cursors:
            cursor.set_xdata([run.time[index]] * 2)

    return move


def _cursors(figure: Figure, run: Run) -> Callable[[int], list[Any]]:
    """Return what moves a cursor over the curves of a run."""
    lines = [axes.axvline(run.time[0], color=METAL, linewidth=0.8) for axes in figure.axes]

    def draw(index: int) -> list[Any]:
        for line in lines:
            line.set_xdata([run.time[index]] * 2)
        return list(lines)

    return draw


# --- The plants, to scale ---


@dataclass(frozen=True)
class Scene:
    """A sample of a run, to be drawn.

    Attributes
    ----------
    run : Run
        The run.
    plant : Plant
        The plant.
    index : int
        Of the sample.
    """

    run: Run
    plant: Plant
    index: int

    def output(self, name: str) -> float:
        """Return an output in the units of the plant."""
        return float(self.run.outputs[name][self.index])

    def wanted(self, name: str) -> float | None:
        """Return the reference of an output; None where it is not tracked."""
        values = self.run.wanted.get(name)
        return None if values is None else float(values[self.index])


@dataclass(frozen=True)
class Picture:
    """How a plant is drawn: from axes and a scene."""

    draw: Callable[[Axes, Scene], None]


def _own_picture(plant: Plant) -> Picture | None:
    own: Any = getattr(plant, "draw", None)
    if own is None:
        return None

    def draw(axes: Axes, scene: Scene) -> None:
        own(axes, [float(values[scene.index]) for values in scene.run.outputs.values()])

    return Picture(draw)


def _stage(axes: Axes, left: float, right: float, bottom: float, top: float) -> None:
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
    axes.set_aspect("equal")
    axes.axis("off")


def _arm(axes: Axes, scene: Scene) -> None:
    """Draw both links, what is wanted in grey, and the way of the tip so far."""
    from fuzzyarm.plant.plant import parameter

    first = parameter(scene.plant, "l_1").value
    second = 2.0 * parameter(scene.plant, "x_2").value  # the centre of mass is in the middle
    reach = 1.15 * (first + second)
    _stage(axes, -reach, reach, -reach, reach)
    run, angles = scene.run, ("joint1.position", "joint2.position")

    def joints(source: Mapping[str, Any], index: Any) -> tuple[Any, Any, Any, Any]:
        one, two = (source[name][index] for name in angles)
        x, y = first * np.cos(one), first * np.sin(one)
        return x, y, x + second * np.cos(one + two), y + second * np.sin(one + two)

    trail = joints(run.outputs, slice(0, scene.index + 1))
    axes.plot(trail[2], trail[3], color=WANTED, linewidth=0.8)
    for source, colour, width in ((run.wanted, WANTED, 2.0), (run.outputs, LINK, 5.0)):
        x, y, tip_x, tip_y = joints(source, scene.index)
        axes.plot([0, x], [0, y], color=colour, linewidth=width, solid_capstyle="round")
        other = colour if source is run.wanted else SECOND
        axes.plot([x, tip_x], [y, tip_y], color=other, linewidth=width, solid_capstyle="round")
    axes.plot([0, x], [0, y], "o", color=METAL, markersize=5)
    if scene.index < len(run.loaded) and run.loaded[scene.index]:
        axes.plot(tip_x, tip_y, "s", color=LOAD, markersize=10)


def _motor(axes: Axes, scene: Scene) -> None:
    """Draw the shaft as a dial, the set point as a mark."""
    from matplotlib.patches import Circle

    _stage(axes, -1.3, 1.3, -1.3, 1.3)
    axes.add_patch(Circle((0, 0), 1.0, fill=False, color=METAL, linewidth=2))
    wanted = scene.wanted("position")
    if wanted is not None:
        axes.plot(
            [0.85 * math.cos(wanted), 1.15 * math.cos(wanted)],
            [0.85 * math.sin(wanted), 1.15 * math.sin(wanted)],
            color=LOAD,
            linewidth=3,
        )
    angle = scene.output("position")
    axes.plot([0, 0.9 * math.cos(angle)], [0, 0.9 * math.sin(angle)], color=LINK, linewidth=4)


def _cartpole(axes: Axes, scene: Scene) -> None:
    """Draw the cart on its track and the pole."""
    from matplotlib.patches import Rectangle

    from fuzzyarm.plant.plant import parameter

    length = 2.0 * parameter(scene.plant, "l").value
    place, angle = scene.output("x"), scene.output("theta")
    _stage(axes, -2.6, 2.6, -0.6, 1.6)
    axes.plot([-2.4, 2.4], [0, 0], color=METAL, linewidth=1)
    axes.add_patch(Rectangle((place - 0.25, 0.02), 0.5, 0.22, color=LINK))
    tip = (place + length * math.sin(angle), 0.24 + length * math.cos(angle))
    axes.plot([place, tip[0]], [0.24, tip[1]], color=SECOND, linewidth=4, solid_capstyle="round")
    wanted = scene.wanted("x")
    if wanted is not None:
        axes.plot([wanted, wanted], [-0.25, -0.05], color=LOAD, linewidth=3)


def _tanks(axes: Axes, scene: Scene) -> None:
    """Draw both tanks with their water, one below the other, levels wanted as marks."""
    from matplotlib.patches import Rectangle

    height, below = 0.35, -0.45
    _stage(axes, -0.3, 0.45, -0.55, 0.5)
    for name, bottom in (("level1", 0.0), ("level2", below)):
        level = max(0.0, scene.output(name))
        axes.add_patch(Rectangle((0, bottom), 0.2, min(level, height), color=COLOURS[5]))
        axes.plot([0, 0, 0.2, 0.2], [bottom + height, bottom, bottom, bottom + height], color=METAL)
        wanted = scene.wanted(name)
        if wanted is not None:
            axes.plot([-0.05, 0.25], [bottom + wanted] * 2, color=LOAD, linewidth=1.5)
        axes.text(0.24, bottom + 0.02, f"{name} {level:.3f} m", fontsize=7)
    if scene.output("level1") > 0:
        axes.plot([0.1, 0.1], [0.0, below + scene.output("level2")], color=COLOURS[5], linewidth=2)


def _beam(axes: Axes, scene: Scene) -> None:
    """Draw the beam at its angle, downhill to positive positions, and the ball on it."""
    place, angle = scene.output("position"), scene.output("angle")
    _stage(axes, -0.65, 0.65, -0.5, 0.5)
    along = np.array([math.cos(angle), -math.sin(angle)])
    ends = np.outer([-0.5, 0.5], along)
    axes.plot(ends[:, 0], ends[:, 1], color=METAL, linewidth=3)
    axes.plot([0], [-0.04], "^", color=METAL, markersize=12)
    up = np.array([math.sin(angle), math.cos(angle)])
    centre = place * along + 0.03 * up
    axes.plot(*centre, "o", color=LINK, markersize=13)
    wanted = scene.wanted("position")
    if wanted is not None:
        mark = np.array([wanted * along - 0.06 * up, wanted * along - 0.01 * up])
        axes.plot(mark[:, 0], mark[:, 1], color=LOAD, linewidth=3)


def _room(axes: Axes, scene: Scene) -> None:
    """Draw a thermometer and the heater's power."""
    from matplotlib.patches import Rectangle

    values = scene.run.outputs["temperature"]
    low, high = float(np.min(values)) - 2.0, float(np.max(values)) + 2.0
    temperature, power = scene.output("temperature"), float(scene.run.drives["power"][scene.index])
    _stage(axes, -0.3, 1.6, -0.2, 1.3)

    def height(value: float) -> float:
        return (value - low) / (high - low)

    axes.add_patch(Rectangle((0, 0), 0.2, 1.0, fill=False, color=METAL))
    axes.add_patch(Rectangle((0, 0), 0.2, height(temperature), color=LOAD))
    axes.text(0.0, 1.05, f"{temperature:.1f} °C", fontsize=9)
    wanted = scene.wanted("temperature")
    if wanted is not None:
        axes.plot([-0.1, 0.3], [height(wanted)] * 2, color=METAL, linewidth=1.5)
    axes.add_patch(Rectangle((0.8, 0), 0.4, 1.0, fill=False, color=METAL))
    axes.add_patch(Rectangle((0.8, 0), 0.4, power / 100.0, color=SECOND))
    axes.text(0.8, 1.05, f"{power:.0f} %", fontsize=9)


DRAWN = {
    "arm": Picture(_arm),
    "motor": Picture(_motor),
    "cartpole": Picture(_cartpole),
    "tanks": Picture(_tanks),
    "ball-and-beam": Picture(_beam),
    "room": Picture(_room),
}
"""How each shipped plant is drawn."""
