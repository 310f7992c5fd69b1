"""The closed loop: one run, or many at once, of a controller on a plant."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.lazy import lazily
from fuzzyarm.loop.analysis import (
    AnalysisError,
    Portrait,
    describing_function,
    nonlinearity,
    phase_portrait,
)
from fuzzyarm.loop.course import Motion, Options, Sensor
from fuzzyarm.loop.many import Many, SweepError
from fuzzyarm.loop.metrics import Metrics
from fuzzyarm.loop.reference import Signal, read_signal
from fuzzyarm.loop.run import Run
from fuzzyarm.loop.simulation import simulate, simulate_many

__all__ = [
    "AnalysisError",
    "Many",
    "Metrics",
    "Motion",
    "Options",
    "Portrait",
    "Run",
    "Sensor",
    "Signal",
    "SweepError",
    "describing_function",
    "nonlinearity",
    "phase_portrait",
    "read_signal",
    "simulate",
    "simulate_many",
]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
