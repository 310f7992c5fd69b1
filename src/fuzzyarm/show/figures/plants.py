"""The plants, to scale: one sample of a run as lines, areas, marks and words.

A drawing is plain data. :func:`draw_on` puts it into axes of matplotlib, from which
:mod:`fuzzyarm.show.figures.live` draws in a terminal; the page of the designer draws it itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.plant.plant import parameter
from fuzzyarm.show.figures.style import COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from fuzzyarm.plant import Plant

METAL = "#444444"

PALETTE = {
    "first": COLOURS[0],
    "second": COLOURS[1],
    "wanted": "#999999",
    "mark": COLOURS[3],
    "metal": METAL,
    "water": COLOURS[5],
}
"""The colours of a drawing by what they stand for; a page has its own, for light and dark."""

Points = Sequence[tuple[float, float]]

# --- What a drawing consists of ---


@dataclass(frozen=True)
class Line:
    """Straight lines through points; the width in points of print."""

    points: Points
    colour: str
    width: float = 1.0


@dataclass(frozen=True)
class Area:
    """A filled polygon."""

    points: Points
    colour: str


@dataclass(frozen=True)
class Mark:
    """A sign of a size in points of print: ``o`` round, ``s`` square, ``^`` triangle."""

    x: float
    y: float
    sign: str
    size: float
    colour: str


@dataclass(frozen=True)
class Words:
    """A line of text that begins at a point; the size in points of print."""

    x: float
    y: float
    text: str
    size: float


@dataclass(frozen=True)
class Drawing:
    """A plant at a moment.

    Attributes
    ----------
    stage : tuple of float
        Left, right, bottom and top of what is shown; a length is the same across and up.
    parts : tuple
        From the back to the front.
    grip : tuple of float
        Where a hand takes hold of it.
    """

    stage: tuple[float, float, float, float]
    parts: tuple[Line | Area | Mark | Words, ...]
    grip: tuple[float, float]


def draw_on(axes: Axes, drawing: Drawing) -> None:
    """Draw into axes."""
    from matplotlib.patches import Polygon

    left, right, bottom, top = drawing.stage
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
    axes.set_aspect("equal")
    axes.axis("off")
    for part in drawing.parts:
        if isinstance(part, Words):
            axes.text(part.x, part.y, part.text, fontsize=part.size)
            continue
        colour = PALETTE[part.colour]
        if isinstance(part, Line):
            x, y = zip(*part.points, strict=True)
            axes.plot(x, y, color=colour, linewidth=part.width, solid_capstyle="round")
        elif isinstance(part, Area):
            axes.add_patch(Polygon(list(part.points), color=colour, linewidth=0))
        else:
            axes.plot(part.x, part.y, part.sign, color=colour, markersize=part.size)


def _box(left: float, bottom: float, width: float, height: float) -> Points:
    right, top = left + width, bottom + height
    return [(left, bottom), (right, bottom), (right, top), (left, top)]


def _frame(left: float, bottom: float, width: float, height: float) -> Line:
    corners = _box(left, bottom, width, height)
    return Line([*corners, corners[0]], "metal")


# --- A sample of a run ---


class Samples(Protocol):
    """What is drawn of a run, whole or so far: see :class:`fuzzyarm.loop.run.Run`."""

    @property
    def plant(self) -> str:
        """Return the name of the plant."""

    @property
    def outputs(self) -> Mapping[str, NDArray[np.float64]]:
        """Return the outputs, by port."""

    @property
    def wanted(self) -> Mapping[str, NDArray[np.float64]]:
        """Return the references of tracked outputs, by port."""

    @property
    def drives(self) -> Mapping[str, NDArray[np.float64]]:
        """Return the drives, by port."""

    @property
    def loaded(self) -> Sequence[bool]:
        """Return of each sample whether the arm carries another load than at first."""


@dataclass(frozen=True)
class Scene:
    """A sample of a run, to be drawn.

    Attributes
    ----------
    run : Samples
        The run.
    plant : Plant
        The plant.
    index : int
        Of the sample.
    """

    run: Samples
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


def picture_of(run: Samples, plant: Plant) -> Picture | None:
    """Return how the plant of a run is drawn: as it is shipped, or as it draws itself; or None."""
    drawn = DRAWN.get(run.plant)
    if drawn is not None:
        return Picture(lambda axes, scene: draw_on(axes, drawn(scene)))
    own: Any = getattr(plant, "draw", None)
    if own is None:
        return None

    def draw(axes: Axes, scene: Scene) -> None:
        own(axes, [float(values[scene.index]) for values in scene.run.outputs.values()])

    return Picture(draw)


# --- The shipped plants ---

LONGEST_TRAIL = 300
"""Points of the way of the arm's tip."""


def _arm(scene: Scene) -> Drawing:
    """Draw both links, what is wanted in grey, and the way of the tip so far."""
    first = parameter(scene.plant, "l_1").value
    second = 2.0 * parameter(scene.plant, "x_2").value  # the centre of mass is in the middle
    reach = 1.15 * (first + second)
    run, angles = scene.run, ("joint1.position", "joint2.position")

    def joints(source: Mapping[str, Any], index: Any) -> tuple[Any, Any, Any, Any]:
        one, two = (source[name][index] for name in angles)
        x, y = first * np.cos(one), first * np.sin(one)
        return x, y, x + second * np.cos(one + two), y + second * np.sin(one + two)

    parts: list[Line | Area | Mark | Words] = []
    few = np.unique(np.linspace(0, scene.index, min(LONGEST_TRAIL, scene.index + 1)).astype(int))
    trail = joints(run.outputs, few)
    parts.append(Line(list(zip(trail[2].tolist(), trail[3].tolist(), strict=True)), "wanted", 0.8))
    ways = [(run.outputs, "first", "second", 5.0)]
    if all(name in run.wanted for name in angles):
        ways.insert(0, (run.wanted, "wanted", "wanted", 2.0))
    for source, colour, other, width in ways:
        x, y, tip_x, tip_y = map(float, joints(source, scene.index))
        parts.append(Line([(0.0, 0.0), (x, y)], colour, width))
        parts.append(Line([(x, y), (tip_x, tip_y)], other, width))
    parts += [Mark(0.0, 0.0, "o", 5, "metal"), Mark(x, y, "o", 5, "metal")]
    if scene.index < len(run.loaded) and run.loaded[scene.index]:
        parts.append(Mark(tip_x, tip_y, "s", 10, "mark"))
    return Drawing((-reach, reach, -reach, reach), tuple(parts), (tip_x, tip_y))


def _motor(scene: Scene) -> Drawing:
    """Draw the shaft as a dial, the set point as a mark."""
    around = [2.0 * math.pi * i / 90 for i in range(91)]
    parts = [Line([(math.cos(a), math.sin(a)) for a in around], "metal", 2.0)]
    wanted = scene.wanted("position")
    if wanted is not None:
        way = math.cos(wanted), math.sin(wanted)
        parts.append(Line([(r * way[0], r * way[1]) for r in (0.85, 1.15)], "mark", 3.0))
    angle = scene.output("position")
    end = 0.9 * math.cos(angle), 0.9 * math.sin(angle)
    parts.append(Line([(0.0, 0.0), end], "first", 4.0))
    return Drawing((-1.3, 1.3, -1.3, 1.3), tuple(parts), end)


def _cartpole(scene: Scene) -> Drawing:
    """Draw the cart on its track and the pole."""
    length = 2.0 * parameter(scene.plant, "l").value
    place, angle = scene.output("x"), scene.output("theta")
    tip = (place + length * math.sin(angle), 0.24 + length * math.cos(angle))
    parts: list[Line | Area] = [
        Line([(-2.4, 0.0), (2.4, 0.0)], "metal"),
        Area(_box(place - 0.25, 0.02, 0.5, 0.22), "first"),
        Line([(place, 0.24), tip], "second", 4.0),
    ]
    wanted = scene.wanted("x")
    if wanted is not None:
        parts.append(Line([(wanted, -0.25), (wanted, -0.05)], "mark", 3.0))
    return Drawing((-2.6, 2.6, -0.6, 1.6), tuple(parts), (place, 0.13))


def _tanks(scene: Scene) -> Drawing:
    """Draw both tanks with their water, one below the other, levels wanted as marks."""
    height, below = 0.35, -0.45
    parts: list[Line | Area | Words] = []
    levels = {name: max(0.0, scene.output(name)) for name in ("level1", "level2")}
    for name, bottom in (("level1", 0.0), ("level2", below)):
        parts.append(Area(_box(0.0, bottom, 0.2, min(levels[name], height)), "water"))
        top = bottom + height
        parts.append(Line([(0.0, top), (0.0, bottom), (0.2, bottom), (0.2, top)], "metal", 1.5))
        wanted = scene.wanted(name)
        if wanted is not None:
            parts.append(Line([(-0.05, bottom + wanted), (0.25, bottom + wanted)], "mark", 1.5))
        parts.append(Words(0.24, bottom + 0.02, f"{name} {scene.output(name):.3f} m", 7))
    if levels["level1"] > 0:
        parts.append(Line([(0.1, 0.0), (0.1, below + levels["level2"])], "water", 2.0))
    return Drawing((-0.3, 0.45, -0.55, 0.5), tuple(parts), (0.1, levels["level1"]))


def _beam(scene: Scene) -> Drawing:
    """Draw the beam at its angle, downhill to positive positions, and the ball on it."""
    place, angle = scene.output("position"), scene.output("angle")
    along, up = (math.cos(angle), -math.sin(angle)), (math.sin(angle), math.cos(angle))

    def at(far: float, high: float) -> tuple[float, float]:
        return far * along[0] + high * up[0], far * along[1] + high * up[1]

    centre = at(place, 0.03)
    parts: list[Line | Mark] = [
        Line([at(-0.5, 0.0), at(0.5, 0.0)], "metal", 3.0),
        Mark(0.0, -0.04, "^", 12, "metal"),
        Mark(*centre, "o", 13, "first"),
    ]
    wanted = scene.wanted("position")
    if wanted is not None:
        parts.append(Line([at(wanted, -0.06), at(wanted, -0.01)], "mark", 3.0))
    return Drawing((-0.65, 0.65, -0.5, 0.5), tuple(parts), centre)


SCALE = 5.0
"""A thermometer begins and ends at multiples of so many degrees."""


def _room(scene: Scene) -> Drawing:
    """Draw a thermometer and the heater's power."""
    wanted = scene.wanted("temperature")
    # Of all samples that there are: the scale of a run that is over never changes.
    curves = (scene.run.outputs, scene.run.wanted)
    seen = np.concatenate([curve["temperature"] for curve in curves if "temperature" in curve])
    low = SCALE * math.floor(float(np.min(seen)) / SCALE - 0.4)
    high = SCALE * math.ceil(float(np.max(seen)) / SCALE + 0.4)
    temperature, power = scene.output("temperature"), float(scene.run.drives["power"][scene.index])

    def height(value: float) -> float:
        return (value - low) / (high - low)

    parts: list[Line | Area | Words] = [
        Area(_box(0.0, 0.0, 0.2, height(temperature)), "mark"),
        _frame(0.0, 0.0, 0.2, 1.0),
        Words(0.0, 1.05, f"{temperature:.1f} °C", 9),
        Words(0.24, -0.02, f"{low:g}", 7),
        Words(0.24, 0.97, f"{high:g}", 7),
    ]
    if wanted is not None:
        parts.append(Line([(-0.1, height(wanted)), (0.3, height(wanted))], "metal", 1.5))
    parts += [
        Area(_box(0.8, 0.0, 0.4, power / 100.0), "second"),
        _frame(0.8, 0.0, 0.4, 1.0),
        Words(0.8, 1.05, f"{power:.0f} %", 9),
    ]
    return Drawing((-0.3, 1.6, -0.2, 1.3), tuple(parts), (1.0, power / 100.0))


DRAWN: Mapping[str, Callable[[Scene], Drawing]] = {
    "arm": _arm,
    "motor": _motor,
    "cartpole": _cartpole,
    "tanks": _tanks,
    "ball-and-beam": _beam,
    "room": _room,
}
"""How each shipped plant is drawn."""
