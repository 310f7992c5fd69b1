"""Plants of python-control, Gymnasium, FMUs and MuJoCo, and the export to python-control.

Each package is imported on first use; together they are the extra ``plants``.
"""

from __future__ import annotations

from fuzzyarm.plant.control_systems import ControlPlant, is_control_system, to_control
from fuzzyarm.plant.environments import EnvironmentPlant
from fuzzyarm.plant.fmu import UnitPlant
from fuzzyarm.plant.robots import RobotPlant, menagerie

__all__ = [
    "ControlPlant", "EnvironmentPlant", "RobotPlant", "UnitPlant", "is_control_system", "menagerie",
    "to_control",
]  # fmt: skip
