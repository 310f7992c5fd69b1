"""The closed loop: one run, or many at once, of a controller on the arm."""

from __future__ import annotations

from fuzzyarm.loop.batch import Batch, simulate_batch
from fuzzyarm.loop.run import Options, Run, simulate

__all__ = [
    "Batch",
    "Options",
    "Run",
    "simulate",
    "simulate_batch",
]
