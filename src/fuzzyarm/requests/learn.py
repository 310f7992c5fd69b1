"""Learning: a table along a trajectory, a rule base from samples."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from fuzzyarm.language.controller_meaning import MAX_DELAY
from fuzzyarm.requests.bounds import LARGEST_RATE, MOST_FITTED_DIGITS, MOST_PASSES, MOST_RULES
from fuzzyarm.requests.experiment import BUILT, TABLES, ExperimentRequest
from fuzzyarm.requests.fields import Limits, Request, option

TRAINING, OUTPUT = "training", "output"
MODEL, SEARCH = "the model", "the search"


@dataclass(frozen=True, kw_only=True)
class LearnRequest(ExperimentRequest):
    """Train a table along a trajectory or references; see ``fuzzyarm learn``."""

    withheld: ClassVar[frozenset[str]] = frozenset(
        (*TABLES, *BUILT, "limits", "supply", "inductance")
    )

    controller: str | None = option(
        "controller CONTROLLER",
        "a name or FILE.frb with a table that learns; soc-zero by default",
        None,
    )
    begin: tuple[str, ...] = option(
        "--start WORD",
        "zero (default), table (the shipped one), FILE, or a FILE for each joint",
        ("zero",),
    )
    performance: str | None = option(
        "--performance WORD",
        "FILE, or the shipped yamazaki or procyk-mamdani; by default that of the text",
        None,
    )
    passes: int = option("--passes N", "repeat the trajectory", 1, (1, MOST_PASSES), group=TRAINING)
    rate: float | None = option(
        "--rate R", "learning rate, 0 to 10", None, (0.0, LARGEST_RATE), group=TRAINING
    )
    delay: int | None = option(
        "--delay N", "control steps from a cell's use to its judgement", None, (0, MAX_DELAY),
        unit="periods", group=TRAINING,
    )  # fmt: skip
    freeze: bool = option("--freeze", "run with the table as it is", False, group=TRAINING)
    joint: int | None = option(
        "--joint N", "write the table of one joint, or axis, alone", None, Limits(1), group=OUTPUT
    )


@dataclass(frozen=True, kw_only=True)
class FitRequest(Request):
    """Learn a rule base from samples; see ``fuzzyarm fit``."""

    data: str = option(
        "data DATA", "samples (.csv, .parquet), or a table or rule base to approximate"
    )
    target: str | None = option(
        "--target NAME", "the column to learn; the last one by default", None
    )
    inputs: str | None = option(
        "--inputs A,B,...", "the columns to learn from; all others by default", None
    )
    test: str | None = option(
        "--test FILE", "samples to be judged by, beside linear regression", None
    )
    series: bool = option(
        "--series", "the samples are in the order of time: cross-validate in blocks", False
    )
    name: str | None = option(
        "--name NAME", "name of the rule base; by default that of the file", None
    )

    rules: int = option("--rules N", "largest number of rules", 16, (1, MOST_RULES), group=MODEL)
    start: Literal["grid", "fcm", "subtractive"] = option(
        "--start", "where the partition starts from", "grid", group=MODEL
    )
    terms: str | None = option(
        "--terms N,N,...", "number of terms of each input, instead of a search", None, group=MODEL
    )
    shrink: float | None = option(
        "--shrink L", "shrinkage of conclusions, instead of a search; 0 is none", None, Limits(0.0),
        group=MODEL,
    )  # fmt: skip
    move: Literal["auto", "yes", "no"] = option(
        "--move", "move the terms (by variable projection); auto: where it pays", "auto",
        group=MODEL,
    )  # fmt: skip
    merge: float = option(
        "--merge S", "likeness of clusters' terms that become one, 0 to 1", 0.7, (0.0, 1.0),
        group=MODEL,
    )  # fmt: skip
    words: str | None = option(
        "--words N[..N]", "Wang and Mendel's rules over so many words", None, group=MODEL
    )
    digits: int = option(
        "--digits N", "significant digits of the numbers of terms", 4, (1, MOST_FITTED_DIGITS),
        group=MODEL,
    )  # fmt: skip
    outside: Literal["extend", "clamp", "error"] | None = option(
        "--outside", "treatment of values beyond the ranges: extend, for a surrogate clamp", None,
        group=MODEL,
    )  # fmt: skip

    folds: int = option("--folds N", "parts of the cross-validation", 5, (2, 100), group=SEARCH)
    nested: Literal["auto", "yes", "no"] = option(
        "--nested",
        "nested cross-validation: the whole fit without each part; auto: up to 1000 samples",
        "auto",
        group=SEARCH,
    )
    time: str | None = option(
        "--time TIME", "time limit on the clock, as in 90s or 10min; the best so far is written",
        None,
        group=SEARCH,
    )  # fmt: skip
    seed: int = option("--seed N", "seed of all random numbers", 0, Limits(0), group=SEARCH)
