"""Plants: the protocol, the two-link arm of the study with its trajectories, shipped plants.

Reading order: :mod:`.plant` (ports, states, parameters, equations), :mod:`.library` (the shipped
ones, written as users write theirs), :mod:`.own` (plants by name and from files),
:mod:`.equations` and :mod:`.plain_python` (equations as machine code, or called as they are),
:mod:`.actuators`, then the arm: :mod:`.arm`, :mod:`.driven_arm`, :mod:`.trajectory`,
:mod:`.setting`. :mod:`.adapters` has plants of other packages.

Angles are degrees in the notation of people (trajectories, errors) and radians inside; everything
else is SI. The equations are in ``docs/explanation/arm.md`` and ``docs/reference/plants.md``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily
from fuzzyarm.plant.arm import ESTIMATE, INEXACT, LOADED, UNLOADED, ArmParameters
from fuzzyarm.plant.driven_arm import Arm
from fuzzyarm.plant.following import trajectory_of, with_load
from fuzzyarm.plant.library import BallAndBeam, CartPole, Motor, Room, Tanks
from fuzzyarm.plant.own import PLANTS, find_plant
from fuzzyarm.plant.plant import Parameter, Plant, PlantError, Port
from fuzzyarm.plant.setting import (
    PLAIN,
    STUDY,
    STUDY_CONVENTIONAL,
    STUDY_DIRECT,
    STUDY_TABLES,
    ArmError,
    Clock,
    Conventions,
    Pair,
    Reference,
    State,
)
from fuzzyarm.plant.trajectory import (
    Segment,
    Trajectory,
    carried,
    pick_and_place,
    reach,
    reach_return,
    through,
)

__all__ = [
    "ESTIMATE", "INEXACT", "LOADED", "PLAIN", "PLANTS", "STUDY", "STUDY_CONVENTIONAL",
    "STUDY_DIRECT", "STUDY_TABLES", "UNLOADED", "Arm", "ArmError", "ArmParameters", "BallAndBeam",
    "CartPole", "Clock", "Conventions", "Motor", "Pair", "Parameter", "Plant", "PlantError", "Port",
    "Reference", "Room", "Segment", "State", "Tanks", "Trajectory", "carried", "find_plant",
    "pick_and_place", "reach", "reach_return", "through", "trajectory_of", "with_load",
]  # fmt: skip

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
