"""The published experiments: figures as data, and what running them again gives."""

from __future__ import annotations

from fuzzyarm.study.published import PublishedRow, UnknownRowError, find_rows, published_rows
from fuzzyarm.study.reproduce import (
    Ensemble,
    Judgement,
    Reproduced,
    chaotic,
    judge,
    reproduce,
    reproduce_row,
    variants,
)

__all__ = [
    "Ensemble",
    "Judgement",
    "PublishedRow",
    "Reproduced",
    "UnknownRowError",
    "chaotic",
    "find_rows",
    "judge",
    "published_rows",
    "reproduce",
    "reproduce_row",
    "variants",
]
