"""The plants of a page: which there are, how they are drawn, and how a hand pushes them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from fuzzyarm.controller.controller import Controller
from fuzzyarm.controller.on_plant import controller_on, site_of
from fuzzyarm.controller.program import SourceError
from fuzzyarm.loop.run import first_error, text_of
from fuzzyarm.plant.following import carries, shortest_trajectory
from fuzzyarm.plant.own import PLANTS, find_plant
from fuzzyarm.plant.plant import Address, Interface, Plant, PlantError, parameter
from fuzzyarm.show.figures.plants import DRAWN, Area, Drawing, Line, Mark, Scene, Words
from fuzzyarm.text.jsonable import jsonable

Loads = dict[Address, float]

STEPS = {"tanks": 0.1, "room": 21.0, "ball-and-beam": 0.2}
"""Where a page has a plant go that does not reach 1, in the unit of what it follows."""


class Plants:
    """The plants that a page may run: the shipped ones, and those that the user named.

    Parameters
    ----------
    own : sequence of str
        Names and files as on the command line; a Python file is executed.

    Raises
    ------
    PlantError
        If there is no such plant, or it is not complete.
    """

    def __init__(self, own: tuple[str, ...] = ()) -> None:
        self.own = own
        self.known: dict[str, Plant] = {name: made() for name, made in PLANTS.items()}
        self.known |= {name: find_plant(name) for name in own}

    def new(self, name: str) -> Plant:
        """Make a plant anew.

        Raises
        ------
        PlantError
            If it was not named when the designer was started.
        """
        if name not in self.known:
            hint = "fuzzyarm designer FILE --plant PLANT adds one"
            raise PlantError(f"this designer runs no plant '{name}'", name=name, hint=hint)
        return find_plant(name)

    def described(self, controller: Controller) -> list[dict[str, Any]]:
        """Return for each plant what a page says of it, and why a controller does not fit."""
        return [
            {
                "name": name,
                "summary": plant.summary,
                "duration": plant.duration,
                **_fit(controller, name, plant),
            }
            for name, plant in self.known.items()
        ]


def step_of(plant: str, port: str) -> str:
    """Return the reference that a page offers for a port of a plant."""
    return f"{port}=step:{STEPS.get(plant, 1):g}"


def followable(name: str, plant: Plant, port: str) -> dict[str, Any]:
    """Return what a page offers a plant to follow: its trajectories, or a reference of a port.

    Parameters
    ----------
    name : str
        Of the plant in the designer.
    plant : Plant
        Any.
    port : str
        What a reference would be of.

    Returns
    -------
    dict
        ``trajectories`` by name; ``shown``, the one that takes the least time to look at;
        ``carries``, whether there is a load; ``reference``, empty where there are trajectories.
    """
    known = list(plant.trajectories)
    return {
        "trajectories": known,
        "shown": shortest_trajectory(plant) if known else "",
        "carries": carries(plant),
        "reference": "" if known else step_of(name, port),
    }


def _fit(controller: Controller, name: str, plant: Plant) -> dict[str, Any]:
    site = site_of(plant)
    try:
        controller_on(controller, site)
        followed = first_error(text_of(controller, site), site)
    except SourceError as error:
        nothing = {"trajectories": [], "shown": "", "carries": False, "reference": ""}
        return {"why": str(error), **nothing, "ports": []}
    label = site.interface.label
    ports = [label(output) for output in (*site.interface.outputs, *site.interface.inputs)]
    return {"why": "", **followable(name, plant, label(followed)), "ports": ports}


# --- Drawings as data ---


def as_data(drawing: Drawing) -> dict[str, Any]:
    """Return a drawing fit for JSON."""
    return {
        "stage": drawing.stage,
        "parts": [part for part in map(_part, drawing.parts) if part is not None],
        "grip": list(map(short, drawing.grip)),
    }


def _part(part: Line | Area | Mark | Words) -> dict[str, Any] | None:
    if isinstance(part, Line | Area):
        points = [[short(x), short(y)] for x, y in part.points]
        if any(None in point for point in points):
            return None
        if isinstance(part, Area):
            return {"is": "area", "points": points, "colour": part.colour}
        return {"is": "line", "points": points, "colour": part.colour, "width": part.width}
    at = {"x": short(part.x), "y": short(part.y), "size": part.size}
    if None in at.values():
        return None
    if isinstance(part, Words):
        return {"is": "words", **at, "text": part.text}
    return {"is": "mark", **at, "sign": part.sign, "colour": part.colour}


def short(value: float, digits: int = 6) -> float | None:
    """Return a number as a page needs it; None where it is not finite."""
    shortened: float | None = jsonable(float(f"{value:.{digits}g}"))
    return shortened


class Painter:
    """What draws the plant of a run.

    Parameters
    ----------
    plant : Plant
        A shipped one; or one that has ``draw(axes, x)``, or is not drawn.
    """

    def __init__(self, plant: Plant) -> None:
        self._shipped = DRAWN.get(plant.name)
        self._own: Any = getattr(plant, "draw", None)
        self._axes: Any = None

    @property
    def draws(self) -> bool:
        """Whether there is a way to draw it."""
        return self._shipped is not None or self._own is not None

    def give_up(self) -> None:
        """Draw nothing any more: its drawing fails."""
        self._own = None

    @property
    def dear(self) -> bool:
        """Whether a drawing takes a while: it goes through axes of matplotlib."""
        return self._shipped is None and self._own is not None

    def __call__(self, scene: Scene) -> dict[str, Any] | None:
        """Return the drawing of a sample; None where there is no way to draw it.

        Raises
        ------
        PlantError
            If the drawing of a user's plant fails.
        """
        if self._shipped is not None:
            return as_data(self._shipped(scene))
        if self._own is None:
            return None
        return self._drawn_by_itself(scene)

    def _drawn_by_itself(self, scene: Scene) -> dict[str, Any]:
        from matplotlib.figure import Figure

        from fuzzyarm.show.figures.live import read_axes

        if self._axes is None:
            self._axes = Figure().subplots()
        self._axes.clear()
        try:
            self._own(self._axes, [float(x[scene.index]) for x in scene.run.outputs.values()])
            found = _Gathered()
            read_axes(self._axes, found)
        except Exception as error:
            raise PlantError(f"the drawing of {scene.plant.name} failed: {error}") from error
        (left, right), (bottom, top) = self._axes.get_xlim(), self._axes.get_ylim()
        middle = (0.5 * (left + right), 0.5 * (bottom + top))
        return as_data(Drawing((left, right, bottom, top), tuple(found.parts), middle))


class _Gathered:
    """Takes what stands in axes as parts of a drawing, as a canvas of the terminal does."""

    def __init__(self) -> None:
        self.parts: list[Line | Area | Mark | Words] = []

    def line(self, points: Any, colour: str, width: float = 1.0) -> None:
        self.parts.append(Line(points, colour, width))

    def area(self, points: Any, colour: str) -> None:
        self.parts.append(Area(points, colour))

    def blob(self, x: float, y: float, size: float, colour: str) -> None:
        self.parts.append(Mark(x, y, "o", size, colour))

    def words(self, x: float, y: float, text: str) -> None:
        self.parts.append(Words(x, y, text, 8))


# --- What a hand does ---
#
# A pull is an arrow of a length between -1 and 1 each way. It becomes loads of inputs, which the
# loop adds behind the limits of the drives: the same as --disturb.

TIP_FORCE = 60.0
"""With which the tip of the arm is pulled at most, N: some times its weight."""


def loads_of(scene: Scene, interface: Interface, x: float, y: float) -> Loads:
    """Return what a pull adds to the inputs of a plant.

    Parameters
    ----------
    scene : Scene
        What the hand sees.
    interface : Interface
        Of the plant.
    x, y : float
        The pull, to the right and up; 1 is as strong as it gets: half of the range of an input.
    """
    if not (math.isfinite(x) and math.isfinite(y)):
        return {}
    x, y = (min(1.0, max(-1.0, each)) for each in (x, y))
    pulled = PULLS.get(scene.run.plant)
    if pulled is not None:
        return pulled(scene, interface, x, y)
    # Of any other plant: sideways the first input, up the second.
    shares = zip(interface.inputs, (x, y), strict=False)
    return {port: share * _strength(interface, port) for port, share in shares}


def _strength(interface: Interface, port: Address) -> float:
    each = interface.inputs[port]
    reach = 0.5 * (each.high - each.low)
    return reach if math.isfinite(reach) else 1.0


def _first(interface: Interface, share: float) -> Loads:
    port = next(iter(interface.inputs))
    return {port: share * _strength(interface, port)}


def _pull_arm(scene: Scene, _interface: Interface, x: float, y: float) -> Loads:
    """Pull at the tip: the torques are those of a force there (the transposed Jacobian)."""
    (tip_x, tip_y), elbow = DRAWN["arm"](scene).grip, scene.output("joint1.position")
    first = parameter(scene.plant, "l_1").value
    far_x, far_y = tip_x - first * math.cos(elbow), tip_y - first * math.sin(elbow)
    return {
        ("joint1", "torque"): TIP_FORCE * (tip_x * y - tip_y * x),
        ("joint2", "torque"): TIP_FORCE * (far_x * y - far_y * x),
    }


def _pull_motor(scene: Scene, interface: Interface, x: float, y: float) -> Loads:
    angle = scene.output("position")
    return _first(interface, math.cos(angle) * y - math.sin(angle) * x)


PULLS: Mapping[str, Callable[[Scene, Interface, float, float], Loads]] = {
    "arm": _pull_arm,
    "motor": _pull_motor,
    "cartpole": lambda _scene, interface, x, _y: _first(interface, x),
    "tanks": lambda _scene, interface, _x, y: _first(interface, y),
    "ball-and-beam": lambda _scene, interface, x, _y: _first(interface, x),
    "room": lambda _scene, interface, _x, y: _first(interface, y),
}
"""What a pull does to each shipped plant."""
