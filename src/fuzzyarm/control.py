"""The old name of :mod:`fuzzyarm.controller` and :mod:`fuzzyarm.loop`.

Controllers of users' own derive from ``fuzzyarm.control.Controller``: their files go on
working. New ones take the two packages.
"""

from fuzzyarm.controller import (
    CATALOGUE,
    CompiledController,
    Controller,
    Gain,
    GainError,
    OwnControllerError,
    SourceError,
    Sources,
    Sum,
    UnknownControllerError,
    controller,
    find_controller,
)
from fuzzyarm.loop import Many, Options, Run, simulate, simulate_many

__all__ = [
    "CATALOGUE",
    "CompiledController",
    "Controller",
    "Gain",
    "GainError",
    "Many",
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
    "simulate_many",
]
