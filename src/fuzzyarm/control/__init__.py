"""Controllers of the arm: the study's, and yours.

:func:`controller` makes one by name, :func:`simulate` closes the loop::

    from fuzzyarm.arm import reach_return
    from fuzzyarm.control import controller, simulate

    run = simulate(controller("cdid+ie"), reach_return(), payload=True)
    print(run.rms)
"""

from __future__ import annotations

from fuzzyarm.control.batch import Batch, simulate_batch
from fuzzyarm.control.catalogue import CATALOGUE, UnknownControllerError, controller
from fuzzyarm.control.controller import CompiledController, Controller, Sum
from fuzzyarm.control.gains import Gain, GainError
from fuzzyarm.control.own import OwnControllerError, find_controller
from fuzzyarm.control.run import Options, Run, simulate
from fuzzyarm.control.sources import SourceError, Sources

__all__ = [
    "CATALOGUE",
    "Batch",
    "CompiledController",
    "Controller",
    "Gain",
    "GainError",
    "Options",
    "OwnControllerError",
    "Run",
    "SourceError",
    "Sources",
    "Sum",
    "UnknownControllerError",
    "controller",
    "find_controller",
    "simulate",
    "simulate_batch",
]
