"""The closed loop: one run, or many at once, of a controller on a plant."""

from __future__ import annotations

from fuzzyarm.loop.analysis import (
    AnalysisError,
    Portrait,
    describing_function,
    nonlinearity,
    phase_portrait,
)
from fuzzyarm.loop.batch import Batch, simulate_batch
from fuzzyarm.loop.course import Motion, Options, Sensor
from fuzzyarm.loop.metrics import Metrics
from fuzzyarm.loop.reference import Signal, read_signal
from fuzzyarm.loop.run import Run, simulate

__all__ = [
    "AnalysisError",
    "Batch",
    "Metrics",
    "Motion",
    "Options",
    "Portrait",
    "Run",
    "Sensor",
    "Signal",
    "describing_function",
    "nonlinearity",
    "phase_portrait",
    "read_signal",
    "simulate",
    "simulate_batch",
]
