"""The plants, to scale: one sample of a run, drawn into axes.

The drawings are lines, patches and words of matplotlib; :mod:`fuzzyarm.show.figures.live` reads
them from the axes and draws the same in a terminal.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzyarm.show.figures.style import COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from fuzzyarm.loop import Run
    from fuzzyarm.plant import Plant

LINK, SECOND, WANTED, LOAD, METAL = COLOURS[0], COLOURS[1], "#999999", COLOURS[3], "#444444"


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


def picture_of(run: Run, plant: Plant) -> Picture | None:
    """Return how the plant of a run is drawn: as it is shipped, or as it draws itself; or None."""
    if run.plant in DRAWN:
        return DRAWN[run.plant]
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
