"""What a request of fitting means: the samples, how the model is found."""

from __future__ import annotations

import math
from pathlib import Path

from fuzzyarm.api import load_sheet
from fuzzyarm.errors import UsageError
from fuzzyarm.learning.data import (
    Columns,
    Samples,
    read_samples,
    rulebase_samples,
    table_samples,
)
from fuzzyarm.learning.fit_options import Options
from fuzzyarm.learning.wang_mendel import FEWEST_WORDS, MOST_WORDS
from fuzzyarm.loop.reference import read_time
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.requests.learn import FitRequest
from fuzzyarm.text.folders import READABLE

OF_MODELS = (*READABLE, ".lut", ".json", ".npz")
"""Suffixes of what is sampled rather than read as samples."""

_MAYBE = {"yes": True, "no": False, "auto": None}


def options_asked(asked: FitRequest) -> Options:
    """Return how the model is found."""
    words = _words(asked.words) if asked.words else Options.words
    if asked.words and (asked.terms or asked.start != "grid"):
        raise UsageError("--words is for Wang and Mendel's rules, --terms and --start are not")
    return Options(
        method="wang-mendel" if asked.words else "sugeno",
        start=asked.start,
        rules=asked.rules,
        terms=_numbers(asked.terms, "--terms") if asked.terms else None,
        words=words,
        shrinkage=asked.shrink,
        move=_MAYBE[asked.move],
        merge=asked.merge,
        series=asked.series,
        parts=asked.folds,
        digits=asked.digits,
        outside=asked.outside or ("clamp" if is_model(asked.data) else "extend"),
        seed=asked.seed,
        nested=_MAYBE[asked.nested],
        seconds=read_time(asked.time, "--time") if asked.time else math.inf,
        name=asked.name or Options.name,
    )


def _words(text: str) -> tuple[int, int]:
    """Return the range in ``7`` or ``3..15``."""
    low, dots, high = text.partition("..")
    try:
        fewest, most = int(low), int(high if dots else low)
    except ValueError:
        raise UsageError(f"--words takes a number or a range such as 3..15, not '{text}'") from None
    if not FEWEST_WORDS <= fewest <= most <= MOST_WORDS:
        range_ = f"{FEWEST_WORDS} to {MOST_WORDS}, the smaller first"
        raise UsageError(f"--words takes numbers from {range_}, not '{text}'")
    return fewest, most


def _numbers(text: str, option: str) -> tuple[int, ...]:
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise UsageError(f"{option} takes numbers such as 2,2,1, not '{text}'") from None


# --- Samples ---


def samples_asked(asked: FitRequest) -> Samples:
    """Return what is learned from: samples of a file, or of a model that is to be stood for."""
    if is_model(asked.data):
        return _samples_of_model(asked)
    inputs = tuple(asked.inputs.split(",")) if asked.inputs else None
    return read_samples(asked.data, Columns(asked.target, inputs))


def is_model(path: str) -> bool:
    """Whether a file is sampled rather than read as samples."""
    return Path(path).suffix.lower() in OF_MODELS


def _samples_of_model(asked: FitRequest) -> Samples:
    if asked.inputs:
        raise UsageError("--inputs is for samples: a surrogate has those of what it stands for")
    model = load_sheet(asked.data)
    if isinstance(model, RuleBase):
        return rulebase_samples(model, asked.target, seed=asked.seed, source=asked.data)
    return table_samples(model, asked.data)


def test_asked(asked: FitRequest, samples: Samples) -> Samples | None:
    """Return the samples to be judged by, where they are given, in the columns of the others."""
    if not asked.test:
        return None
    test = read_samples(asked.test, Columns(samples.target, samples.names))
    return test.in_classes(samples.classes)
