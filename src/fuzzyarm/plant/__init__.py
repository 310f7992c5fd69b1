"""The two-link arm of the study: dynamics, trajectories, payload, loop, error norms.

Angles are degrees where people write them (trajectories, errors) and radians inside;
everything else is SI. See ``docs/arm.md`` for the equations.
"""

from __future__ import annotations

from fuzzyarm.plant.arm import ESTIMATE, INEXACT, LOADED, UNLOADED, ArmParameters
from fuzzyarm.plant.setting import (
    PLAIN,
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
    pick_and_place,
    reach,
    reach_return,
    schedule,
    through,
)

__all__ = [
    "ESTIMATE",
    "INEXACT",
    "LOADED",
    "PLAIN",
    "STUDY_CONVENTIONAL",
    "STUDY_DIRECT",
    "STUDY_TABLES",
    "UNLOADED",
    "ArmError",
    "ArmParameters",
    "Clock",
    "Conventions",
    "Pair",
    "Reference",
    "Segment",
    "State",
    "Trajectory",
    "pick_and_place",
    "reach",
    "reach_return",
    "schedule",
    "through",
]
