"""The plants of a page: their list, how they are drawn, and how the user pushes them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from fuzzyarm.control.controllers.code import SourceError
from fuzzyarm.control.controllers.controller import Controller
from fuzzyarm.control.controllers.on_plant import controller_on, site_of
from fuzzyarm.control.loop.run import first_error, text_of
from fuzzyarm.plant.drawings import PlantScene, drawing_of
from fuzzyarm.plant.following import carries, shortest_trajectory
from fuzzyarm.plant.own import PLANTS, find_plant
from fuzzyarm.plant.plant import Address, Interface, Plant, PlantError, parameter

Loads = dict[Address, float]

STEPS = {"tanks": 0.1, "room": 21.0, "ball-and-beam": 0.2}
"""Default step of plants that do not reach 1, in the unit of the reference."""


class Plants:
    """The plants that a page may run: the shipped ones, and those that the user named.

    Parameters
    ----------
    files : sequence of str
        Names and files as on the command line; a Python file is executed.

    Raises
    ------
    PlantError
        If there is no such plant, or it is not complete.

    Attributes
    ----------
    own : tuple of Plant
        The plants that the user named.
    """

    def __init__(self, files: tuple[str, ...] = ()) -> None:
        self.files = files
        self.by_name: dict[str, Plant] = {name: make() for name, make in PLANTS.items()}
        named = {name: find_plant(name) for name in files}
        self.own = tuple(named.values())
        self.by_name |= named

    def new(self, name: str) -> Plant:
        """Make a plant anew; PlantError if it was not named when the designer was started."""
        if name not in self.by_name:
            hint = "fuzzyarm designer FILE --plant PLANT adds one"
            raise PlantError(f"this designer runs no plant '{name}'", name=name, hint=hint)
        return find_plant(name)

    def described(self, controller: Controller) -> list[dict[str, Any]]:
        """Return for each plant its description on the page, and why a controller does not fit."""
        return [
            {
                "name": name,
                "summary": plant.summary,
                "duration": plant.duration,
                **_fit(controller, name, plant),
            }
            for name, plant in self.by_name.items()
        ]


def step_of(plant: str, port: str) -> str:
    """Return the default reference of a page for a port of a plant."""
    return f"{port}=step:{STEPS.get(plant, 1):g}"


def followable(name: str, plant: Plant, port: str) -> dict[str, Any]:
    """Return the trajectories of a plant, or a reference of a port."""
    trajectories = list(plant.trajectories)
    return {
        "trajectories": trajectories,
        "shown": shortest_trajectory(plant) if trajectories else "",
        "carries": carries(plant),
        "reference": "" if trajectories else step_of(name, port),
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


# --- Actions of the user ---
#
# A pull is an arrow of a length between -1 and 1 each way. It becomes loads of inputs, which the
# loop adds after the limits of the drives: the same as --disturb.

TIP_FORCE = 60.0
"""With which the tip of the arm is pulled at most, N: some times its weight."""


def loads_of(plant: Plant, scene: PlantScene, interface: Interface, x: float, y: float) -> Loads:
    """Return the loads of a pull on the inputs of a plant."""
    if not (math.isfinite(x) and math.isfinite(y)):
        return {}
    x, y = (min(1.0, max(-1.0, coordinate)) for coordinate in (x, y))
    if plant.name == "arm":
        return _pull_arm(plant, scene, x, y)
    pulled = PULLS.get(plant.name)
    if pulled is not None:
        return _first(interface, pulled(scene, x, y))
    # Of any other plant: sideways the first input, up the second.
    shares = zip(interface.inputs, (x, y), strict=False)
    return {port: share * _strength(interface, port) for port, share in shares}


def _strength(interface: Interface, port: Address) -> float:
    drive = interface.inputs[port]
    reach = 0.5 * (drive.high - drive.low)
    return reach if math.isfinite(reach) else 1.0


def _first(interface: Interface, share: float) -> Loads:
    port = next(iter(interface.inputs))
    return {port: share * _strength(interface, port)}


def _pull_arm(plant: Plant, scene: PlantScene, x: float, y: float) -> Loads:
    """Pull at the tip: the torques are those of a force there (the transposed Jacobian)."""
    drawing, elbow = drawing_of(plant, scene), scene.output("joint1.position")
    assert drawing is not None
    tip_x, tip_y = drawing.held_at
    first = parameter(plant, "l_1").value
    far_x, far_y = tip_x - first * math.cos(elbow), tip_y - first * math.sin(elbow)
    return {
        ("joint1", "torque"): TIP_FORCE * (tip_x * y - tip_y * x),
        ("joint2", "torque"): TIP_FORCE * (far_x * y - far_y * x),
    }


def _pull_motor(scene: PlantScene, x: float, y: float) -> float:
    angle = scene.output("position")
    return math.cos(angle) * y - math.sin(angle) * x


PULLS: Mapping[str, Callable[[PlantScene, float, float], float]] = {
    "motor": _pull_motor,
    "cartpole": lambda _scene, x, _y: x,
    "tanks": lambda _scene, _x, y: y,
    "ball-and-beam": lambda _scene, x, _y: x,
    "room": lambda _scene, _x, y: y,
}
"""How hard a pull pushes the first input of a shipped plant with one input."""
