"""Tuning: cost, scenarios, effort of the search."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from fuzzyarm.requests.bounds import MOST_EVALS, MOST_SCENARIOS, MOST_TUNED_DIGITS, MOST_WORKERS
from fuzzyarm.requests.experiment import BUILT, LOAD, PLANT, TABLES, ExperimentRequest
from fuzzyarm.requests.fields import Limits, option
from fuzzyarm.requests.runs import Workers

GOOD, SCENARIOS, SEARCH = "what is good", "scenarios", "the search"


@dataclass(frozen=True, kw_only=True)
class TuneRequest(Workers, ExperimentRequest):
    """Tune a controller in its loop, or a rule base on samples; see ``fuzzyarm tune``."""

    withheld: ClassVar[frozenset[str]] = frozenset((*TABLES, *BUILT, "performance", "set"))

    file: str = option("file FILE", "a controller, its name in the catalogue, or a rule base")
    out: str | None = option(
        "-o --out FILE.frb", "where to write it; over the file itself, if it is the same", None,
        idle=True,
    )  # fmt: skip

    cost: str | None = option(
        "--cost COST", "formula of metrics, or FILE.py:FUNCTION; rms by default", None, group=GOOD
    )
    data: str | None = option(
        "--data FILE", "samples, .csv or .parquet, for a rule base alone", None, group=GOOD
    )
    test: str | None = option(
        "--test FILE", "samples to judge by; a fifth of the data by default", None, idle=True,
        group=GOOD,
    )  # fmt: skip
    target: str | None = option(
        "--target NAME", "the column that the output is to give", None, group=GOOD
    )

    scenarios: int | None = option(
        "--scenarios N", "tune on N: the named ones, then drawn ones", None, (1, MOST_SCENARIOS),
        group=SCENARIOS,
    )  # fmt: skip
    vary: tuple[str, ...] = option(
        "--vary NAME=A..B",
        "random quantities of scenarios, as with sweep --random",
        (),
        repeated=True,
        group=SCENARIOS,
    )
    over: Literal["mean", "worst"] = option("--over", "mean or worst cost", "mean", group=SCENARIOS)
    unseen: int = option(
        "--unseen N", "judge by N others, 24 by default", 24, (0, MOST_SCENARIOS), idle=True,
        group=SCENARIOS,
    )  # fmt: skip

    tune: tuple[str, ...] = option(
        "--tune LINE", "movable numbers, as a line of a tune block, in place of the file's", (),
        repeated=True, group=SEARCH,
    )  # fmt: skip
    method: Literal["nelder-mead", "cma-es", "evolution"] = option(
        "--method", "how candidates are chosen", "nelder-mead", group=SEARCH
    )
    evals: int = option(
        "--evals N", "candidates, 500 by default", 500, (1, MOST_EVALS), idle=True, group=SEARCH
    )
    time: str | None = option(
        "--time TIME",
        "time limit on the clock, as in 90s or 10min; --evals limits the work",
        None,
        idle=True,
        group=SEARCH,
    )
    digits: int = option(
        "--digits N", "of the numbers that are written", 3, (1, MOST_TUNED_DIGITS), idle=True,
        group=SEARCH,
    )  # fmt: skip
    linear: bool = option(
        "--linear", "tune a linear controller to compare with (default: yes)", True, idle=True,
        group=SEARCH, negatable=True,
    )  # fmt: skip
    journal: str | None = option(
        "--journal FILE", "write every trial to this file", None, idle=True, group=SEARCH
    )
    resume: bool = option("--resume", "go on with the journal", False, idle=True, group=SEARCH)
    workers: int | None = option(
        "--workers N", "one for each processor by default", None, (1, MOST_WORKERS), idle=True,
        group=SEARCH,
    )  # fmt: skip
    dask: str | None = option(
        "--dask ADDRESS", "run on a Dask cluster, as in tcp://scheduler:8786", None, idle=True,
        group=SEARCH,
    )  # fmt: skip

    payload: bool | None = option("--payload", "carry the load", None, group=LOAD, negatable=True)
    plant: str | None = option(
        "--plant PLANT", "where it runs; by default the shipped plant that has its axes", None,
        group=PLANT,
    )  # fmt: skip
    seed: int = option("--seed N", "seed of all random numbers", 1, Limits(0), group=SEARCH)
