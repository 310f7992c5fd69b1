"""Tuning: numbers that minimise a cost, and a text with the result."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily
from fuzzyarm.learning.tuning.movement import TuneError
from fuzzyarm.learning.tuning.result import Tuned
from fuzzyarm.learning.tuning.scenarios import Scenario, Stage
from fuzzyarm.learning.tuning.search import Journal
from fuzzyarm.learning.tuning.tune import tune

__all__ = ["Journal", "Scenario", "Stage", "TuneError", "Tuned", "tune"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
