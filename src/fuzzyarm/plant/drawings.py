"""Drawings of plants to scale: a sample of a run as lines, areas, marks and words.

A plant has a method ``draw(scene)`` that returns a :class:`fuzzyarm.base.picture.Drawing`; those
of the shipped plants are below. Animations, ``--watch`` and the designer draw the result.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.picture import Drawing, Line, Mark, Part, Words, frame, rectangle
from fuzzyarm.plant.plant import Plant, PlantError, parameter

if TYPE_CHECKING:
    from fuzzyarm.plant.setting import Pair

# --- A sample of a run ---


class DrawnRun(Protocol):
    """The data of a run for drawing: see :class:`fuzzyarm.control.loop.run.Run`."""

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
        """Return for each sample whether the load differs from that at the start."""


@dataclass(frozen=True)
class PlantScene:
    """One sample of a run.

    Attributes
    ----------
    run : DrawnRun
        The run, complete or so far.
    index : int
        Index of the sample.
    """

    run: DrawnRun
    index: int

    def output(self, name: str) -> float:
        """Return an output in the units of the plant."""
        return float(self.run.outputs[name][self.index])

    def wanted(self, name: str) -> float | None:
        """Return the reference of an output; None if it is not tracked."""
        values = self.run.wanted.get(name)
        return None if values is None else float(values[self.index])

    def drive(self, name: str) -> float:
        """Return an input in the units of the plant."""
        return float(self.run.drives[name][self.index])


# --- Any plant ---

HINT = (
    "draw(self, scene) returns a Drawing of fuzzyarm.base.picture; docs/reference/plants.md has one"
)


def is_drawn(plant: object) -> bool:
    """Whether a plant has a drawing; others have curves alone."""
    return getattr(plant, "draw", None) is not None


def drawing_of(plant: Plant, scene: PlantScene) -> Drawing | None:
    """Return the drawing of a plant at a sample; None without one."""
    if not is_drawn(plant):
        return None
    draw: Any = plant.draw
    try:
        drawing = draw(scene)
    except Exception as error:
        message = f"the drawing of {_name(plant)} failed: {error or type(error).__name__}"
        raise PlantError(message, hint=HINT) from error
    if not isinstance(drawing, Drawing):
        message = f"the drawing of {_name(plant)} is a {type(drawing).__name__}"
        raise PlantError(message, hint=HINT)
    return drawing


def picture_of(plant: Plant, scene: PlantScene) -> Any:
    """Return the camera picture of a plant at a sample; None without a camera or OpenGL."""
    take: Any = getattr(plant, "picture", None)
    try:
        return None if take is None else take(scene)
    except PlantError:
        return None


def _name(plant: object) -> str:
    return getattr(plant, "name", "") or type(plant).__name__


# --- The shipped plants ---

LONGEST_TRAIL = 300
"""Points of the trail of the arm's tip."""


def draw_arm(plant: Plant, scene: PlantScene) -> Drawing:
    """Draw both links, their reference in grey, and the trail of the tip."""
    first = parameter(plant, "l_1").value
    second = 2.0 * parameter(plant, "x_2").value  # centre of mass at the middle
    reach = 1.15 * (first + second)
    run, angles = scene.run, ("joint1.position", "joint2.position")

    def joints(source: Mapping[str, Any], index: Any) -> tuple[Any, Any, Any, Any]:
        one, two = (source[name][index] for name in angles)
        x, y = first * np.cos(one), first * np.sin(one)
        return x, y, x + second * np.cos(one + two), y + second * np.sin(one + two)

    few = np.unique(np.linspace(0, scene.index, min(LONGEST_TRAIL, scene.index + 1)).astype(int))
    parts: list[Part] = [Line(*joints(run.outputs, few)[2:], "wanted", 0.8)]
    poses = [(run.outputs, "first", "second", 5.0)]
    if all(name in run.wanted for name in angles):
        poses.insert(0, (run.wanted, "wanted", "wanted", 2.0))
    for source, tone, other, width in poses:
        x, y, tip_x, tip_y = map(float, joints(source, scene.index))
        parts += [Line((0.0, x), (0.0, y), tone, width), Line((x, tip_x), (y, tip_y), other, width)]
    parts += [Mark(0.0, 0.0, "o", 5), Mark(x, y, "o", 5)]
    if scene.index < len(run.loaded) and run.loaded[scene.index]:
        parts.append(Mark(tip_x, tip_y, "s", 10, "mark"))
    return Drawing((-reach, reach, -reach, reach), parts, (tip_x, tip_y))


def draw_motor(plant: Plant, scene: PlantScene) -> Drawing:
    """Draw the shaft as a dial, the set point as a mark."""
    around = [2.0 * math.pi * i / 90 for i in range(91)]
    parts: list[Part] = [Line([*map(math.cos, around)], [*map(math.sin, around)], "metal", 2.0)]
    set_point = scene.wanted("position")
    if set_point is not None:
        x, y = math.cos(set_point), math.sin(set_point)
        parts.append(Line((0.85 * x, 1.15 * x), (0.85 * y, 1.15 * y), "mark", 3.0))
    angle = scene.output("position")
    x, y = 0.9 * math.cos(angle), 0.9 * math.sin(angle)
    parts.append(Line((0.0, x), (0.0, y), "first", 4.0))
    return Drawing((-1.3, 1.3, -1.3, 1.3), parts, (x, y))


def draw_cartpole(plant: Plant, scene: PlantScene) -> Drawing:
    """Draw the cart on its track and the pole."""
    length = 2.0 * parameter(plant, "l").value
    place, angle = scene.output("x"), scene.output("theta")
    tip = place + length * math.sin(angle), 0.24 + length * math.cos(angle)
    parts: list[Part] = [
        Line((-2.4, 2.4), (0.0, 0.0)),
        rectangle(place - 0.25, 0.02, 0.5, 0.22, "first"),
        Line((place, tip[0]), (0.24, tip[1]), "second", 4.0),
    ]
    set_point = scene.wanted("x")
    if set_point is not None:
        parts.append(Line((set_point, set_point), (-0.25, -0.05), "mark", 3.0))
    return Drawing((-2.6, 2.6, -0.6, 1.6), parts, (place, 0.13))


def draw_tanks(plant: Plant, scene: PlantScene) -> Drawing:
    """Draw both tanks with their water, one below the other, reference levels as marks."""
    height, below = 0.35, -0.45
    parts: list[Part] = []
    levels = {name: max(0.0, scene.output(name)) for name in ("level1", "level2")}
    for name, bottom in (("level1", 0.0), ("level2", below)):
        parts.append(rectangle(0.0, bottom, 0.2, min(levels[name], height), "water"))
        top = bottom + height
        parts.append(Line((0.0, 0.0, 0.2, 0.2), (top, bottom, bottom, top), "metal", 1.5))
        set_point = scene.wanted(name)
        if set_point is not None:
            parts.append(Line((-0.05, 0.25), (bottom + set_point,) * 2, "mark", 1.5))
        parts.append(Words(0.24, bottom + 0.02, f"{name} {scene.output(name):.3f} m", 7))
    if levels["level1"] > 0:
        parts.append(Line((0.1, 0.1), (0.0, below + levels["level2"]), "water", 2.0))
    return Drawing((-0.3, 0.45, -0.55, 0.5), parts, (0.1, levels["level1"]))


def draw_beam(plant: Plant, scene: PlantScene) -> Drawing:
    """Draw the beam at its angle, positive positions downhill, and the ball on it."""
    place, angle = scene.output("position"), scene.output("angle")
    along, up = (math.cos(angle), -math.sin(angle)), (math.sin(angle), math.cos(angle))

    def at(far: float, high: float) -> Pair:
        return far * along[0] + high * up[0], far * along[1] + high * up[1]

    def between(start: Pair, end: Pair, tone: str) -> Line:
        return Line((start[0], end[0]), (start[1], end[1]), tone, 3.0)

    centre = at(place, 0.03)
    parts: list[Part] = [
        between(at(-0.5, 0.0), at(0.5, 0.0), "metal"),
        Mark(0.0, -0.04, "^", 12),
        Mark(*centre, "o", 13, "first"),
    ]
    set_point = scene.wanted("position")
    if set_point is not None:
        parts.append(between(at(set_point, -0.06), at(set_point, -0.01), "mark"))
    return Drawing((-0.65, 0.65, -0.5, 0.5), parts, centre)


SCALE = 5.0
"""Ends of a thermometer are multiples of this, degrees."""


def draw_room(plant: Plant, scene: PlantScene) -> Drawing:
    """Draw a thermometer and the heater's power."""
    set_point = scene.wanted("temperature")
    # From all samples: the scale of a completed run never changes.
    curves = (scene.run.outputs, scene.run.wanted)
    temperatures = np.concatenate(
        [curve["temperature"] for curve in curves if "temperature" in curve]
    )
    low = SCALE * math.floor(float(np.min(temperatures)) / SCALE - 0.4)
    high = SCALE * math.ceil(float(np.max(temperatures)) / SCALE + 0.4)
    temperature, power = scene.output("temperature"), scene.drive("power")

    def height(value: float) -> float:
        return (value - low) / (high - low)

    parts: list[Part] = [
        rectangle(0.0, 0.0, 0.2, height(temperature), "mark"),
        frame(0.0, 0.0, 0.2, 1.0),
        Words(0.0, 1.05, f"{temperature:.1f} °C", 9),
        Words(0.24, -0.02, f"{low:g}", 7),
        Words(0.24, 0.97, f"{high:g}", 7),
    ]
    if set_point is not None:
        parts.append(Line((-0.1, 0.3), (height(set_point),) * 2, "metal", 1.5))
    parts += [
        rectangle(0.8, 0.0, 0.4, power / 100.0, "second"),
        frame(0.8, 0.0, 0.4, 1.0),
        Words(0.8, 1.05, f"{power:.0f} %", 9),
    ]
    return Drawing((-0.3, 1.6, -0.2, 1.3), parts, (1.0, power / 100.0))
