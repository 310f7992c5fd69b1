"""Plants of other packages: python-control, Gymnasium, FMUs; and python-control systems of ours.

Each package is imported when it is used; together they are the extra ``plants``.
"""

from __future__ import annotations

from fuzzyarm.plant.control_systems import ControlPlant, is_control_system, to_control
from fuzzyarm.plant.environments import EnvironmentPlant
from fuzzyarm.plant.fmu import UnitPlant

__all__ = [
    "ControlPlant",
    "EnvironmentPlant",
    "UnitPlant",
    "is_control_system",
    "to_control",
]
