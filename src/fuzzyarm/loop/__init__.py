"""The closed loop: one run, or many at once, of a controller on a plant."""

from __future__ import annotations

from fuzzyarm.loop.batch import Batch, simulate_batch
from fuzzyarm.loop.course import Motion, Options, Sensor
from fuzzyarm.loop.metrics import Metrics
from fuzzyarm.loop.reference import Signal, read_signal
from fuzzyarm.loop.run import Run, simulate

__all__ = [
    "Batch",
    "Metrics",
    "Motion",
    "Options",
    "Run",
    "Sensor",
    "Signal",
    "read_signal",
    "simulate",
    "simulate_batch",
]
