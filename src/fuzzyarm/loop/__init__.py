"""The closed loop: one run, or many at once, of a controller on a plant."""

from __future__ import annotations

from fuzzyarm.loop.course import Motion, Options, Sensor
from fuzzyarm.loop.many import Many, SweepError, simulate_many
from fuzzyarm.loop.metrics import Metrics
from fuzzyarm.loop.reference import Signal, read_signal
from fuzzyarm.loop.run import Run, simulate

__all__ = [
    "Many",
    "Metrics",
    "Motion",
    "Options",
    "Run",
    "Sensor",
    "Signal",
    "SweepError",
    "read_signal",
    "simulate",
    "simulate_many",
]
