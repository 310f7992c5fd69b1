"""Tuning: numbers that move until a cost is small, and a text that says what became of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.lazy import lazily
from fuzzyarm.tuning.movement import TuneError
from fuzzyarm.tuning.result import Tuned
from fuzzyarm.tuning.scenarios import Scenario, Stage
from fuzzyarm.tuning.search import Journal
from fuzzyarm.tuning.tune import tune

__all__ = ["Journal", "Scenario", "Stage", "TuneError", "Tuned", "tune"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
