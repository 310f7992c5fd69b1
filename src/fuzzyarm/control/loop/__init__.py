"""The closed loop: one run, or many at once, of a controller on a plant."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily
from fuzzyarm.control.loop.analysis import (
    AnalysisError,
    Portrait,
    describing_function,
    nonlinearity,
    phase_portrait,
)
from fuzzyarm.control.loop.course import Motion, Options, Sensor
from fuzzyarm.control.loop.many import Many, SweepError
from fuzzyarm.control.loop.metrics import Metrics
from fuzzyarm.control.loop.reference import Signal, read_signal
from fuzzyarm.control.loop.robustness import (
    PairedComparison,
    Robustness,
    paired_comparison,
    robustness,
)
from fuzzyarm.control.loop.run import Run
from fuzzyarm.control.loop.simulation import simulate, simulate_many

__all__ = [
    "AnalysisError",
    "Many",
    "Metrics",
    "Motion",
    "Options",
    "PairedComparison",
    "Portrait",
    "Robustness",
    "Run",
    "Sensor",
    "Signal",
    "SweepError",
    "describing_function",
    "nonlinearity",
    "paired_comparison",
    "phase_portrait",
    "read_signal",
    "robustness",
    "simulate",
    "simulate_many",
]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
