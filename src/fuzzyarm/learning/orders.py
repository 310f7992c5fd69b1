"""A request of fitting resolved: the samples, the options."""

from __future__ import annotations

import math
from pathlib import Path

from fuzzyarm.base import above
from fuzzyarm.base.errors import UsageError
from fuzzyarm.base.folders import READABLE
from fuzzyarm.base.numbers import read_time
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.learning.data import Columns, Samples, read_samples, rulebase_samples, table_samples
from fuzzyarm.learning.fit_options import Options
from fuzzyarm.learning.wang_mendel import FEWEST_WORDS, MOST_WORDS
from fuzzyarm.requests.learn import FitRequest

OF_MODELS = (*READABLE, ".lut", ".json", ".npz")
"""Suffixes of files to sample, not samples."""

_MAYBE = {"yes": True, "no": False, "auto": None}


def fit_options_of(request: FitRequest) -> Options:
    """Return the options of the search for a model."""
    words = _words(request.words) if request.words else Options.words
    if request.words and (request.terms or request.start != "grid"):
        raise UsageError("--words is for Wang and Mendel's rules, --terms and --start are not")
    return Options(
        method="wang-mendel" if request.words else "sugeno",
        start=request.start,
        rules=request.rules,
        terms=_numbers(request.terms, "--terms") if request.terms else None,
        words=words,
        shrinkage=request.shrink,
        move=_MAYBE[request.move],
        merge=request.merge,
        series=request.series,
        parts=request.folds,
        digits=request.digits,
        outside=request.outside or ("clamp" if is_model(request.data) else "extend"),
        seed=request.seed,
        nested=_MAYBE[request.nested],
        seconds=read_time(request.time, "--time") if request.time else math.inf,
        name=request.name or Options.name,
    )


def _words(text: str) -> tuple[int, int]:
    """Return the range in ``7`` or ``3..15``."""
    low, dots, high = text.partition("..")
    try:
        fewest, most = int(low), int(high if dots else low)
    except ValueError:
        raise UsageError(f"--words takes a number or a range such as 3..15, not '{text}'") from None
    if not FEWEST_WORDS <= fewest <= most <= MOST_WORDS:
        limits = f"{FEWEST_WORDS} to {MOST_WORDS}, the smaller first"
        raise UsageError(f"--words takes numbers from {limits}, not '{text}'")
    return fewest, most


def _numbers(text: str, option: str) -> tuple[int, ...]:
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise UsageError(f"{option} takes numbers such as 2,2,1, not '{text}'") from None


# --- Samples ---


def samples_of(request: FitRequest) -> Samples:
    """Return the training samples: those of a file, or samples of a model to approximate."""
    if is_model(request.data):
        return _samples_of_model(request)
    inputs = tuple(request.inputs.split(",")) if request.inputs else None
    return read_samples(request.data, Columns(request.target, inputs))


def is_model(path: str) -> bool:
    """Whether a file is a model to sample, not samples."""
    return Path(path).suffix.lower() in OF_MODELS


def _samples_of_model(request: FitRequest) -> Samples:
    if request.inputs:
        raise UsageError("--inputs is for samples: a surrogate has those of its original")
    model = above.function("load_sheet")(request.data)
    if isinstance(model, RuleBase):
        return rulebase_samples(model, request.target, seed=request.seed, source=request.data)
    return table_samples(model, request.data)


def test_samples_of(request: FitRequest, samples: Samples) -> Samples | None:
    """Return the test samples, in the columns of the training samples; None without `test`."""
    if not request.test:
        return None
    test = read_samples(request.test, Columns(samples.target, samples.names))
    return test.in_classes(samples.classes)
