"""Runs: one, many over ranges, several controllers under the same conditions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from fuzzyarm.requests.bounds import MOST_RUNS, MOST_WORKERS
from fuzzyarm.requests.experiment import BUILT, TABLES, ExperimentRequest
from fuzzyarm.requests.fields import Request, option

MANY = "many runs"


@dataclass(frozen=True, kw_only=True)
class SimulateRequest(ExperimentRequest):
    """Run controllers on a plant; see ``fuzzyarm simulate``."""

    controller: tuple[str, ...] = option(
        "controller CONTROLLER", "name, sum or file; or several", ()
    )


@dataclass(frozen=True, kw_only=True)
class Workers(Request):
    """Where runs are executed; no result depends on it."""

    workers: int | None = option(
        "--workers N", "runs at a time, one for each processor by default", None,
        (1, MOST_WORKERS), idle=True, group=MANY,
    )  # fmt: skip
    dask: str | None = option(
        "--dask ADDRESS", "run on a Dask cluster, as in tcp://scheduler:8786", None, idle=True,
        group=MANY,
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class ManyRuns(Request):
    """The changes from run to run, and the file of the runs."""

    sweep: tuple[str, ...] = option(
        "--sweep NAME=A..B:N", "N values from A to B; several span a grid", (), repeated=True,
        group=MANY,
    )  # fmt: skip
    random: int | None = option(
        "--random N", "N runs with values drawn from ranges NAME=A..B", None, (1, MOST_RUNS),
        group=MANY,
    )  # fmt: skip
    metric: str = option(
        "--metric NAME", "metric of summary and figure: rms, max, overshoot, …", "rms", idle=True,
        group=MANY,
    )  # fmt: skip
    map: str | None = option(
        "--map X,Y", "draw the metric over these two with --plot", None, idle=True, group=MANY
    )
    out: str | None = option(
        "-o --out FILE.csv", "write a line for each run", None, idle=True, group=MANY
    )
    resume: bool = option("--resume", "go on with the file of -o", False, idle=True, group=MANY)


@dataclass(frozen=True, kw_only=True)
class SweepRequest(ManyRuns, Workers, ExperimentRequest):
    """Run a controller many times, over ranges; see ``fuzzyarm sweep``."""

    controller: str = option("controller CONTROLLER", "name, sum or file")
    against: tuple[str, ...] = option("against OTHER", "others, in the same runs", ())


@dataclass(frozen=True, kw_only=True)
class CompareRequest(ExperimentRequest):
    """Run controllers under the same conditions; see ``fuzzyarm compare``."""

    withheld: ClassVar[frozenset[str]] = frozenset(
        (*TABLES, *BUILT, "performance", "trajectory", "hold", "way_points", "loaded")
    )

    controllers: tuple[str, ...] = option("controllers CONTROLLER", "name, sum or file", ())
    angles: tuple[float, float] | None = option(
        "--angles A1 A2", "where to turn to on both trajectories, degrees", None, unit="degrees"
    )
    segment: float | None = option("--segment SECONDS", "duration of each move", None, unit="s")
    payload: bool | None = option("--payload", "carry the load", True, negatable=True)
    errors: Literal["set-points", "periods", "path"] | None = option(
        "--errors", "in one of the three senses", None
    )
    cost: bool = option("--cost", "count operations and measure time", False)
    operations: bool = option("--operations", "count operations", False)
