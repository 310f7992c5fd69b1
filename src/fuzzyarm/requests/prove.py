"""Proofs: of lines of files, of a number of an output, or of a controller in its loop."""

from __future__ import annotations

from dataclasses import dataclass

from fuzzyarm.requests.bounds import MOST_WORKERS
from fuzzyarm.requests.fields import Limits, Request, option


@dataclass(frozen=True, kw_only=True)
class ProveRequest(Request):
    """The statement to be proved or refuted; see ``fuzzyarm prove``."""

    files: tuple[str, ...] = option(
        "files FILE", "rule bases (.frb, .fll, .fcl, .fis) or controllers", ()
    )
    tolerance: float | None = option(
        "--tolerance T", "tightness of bounds, in units of the bounded quantity", None,
        Limits(0.0, is_open=True),
    )  # fmt: skip
    budget: float | None = option(
        "--budget SECONDS",
        "processor seconds that each statement may take (those printed are by the clock); else a"
        " minute for a tube or a certificate, two for a claim over a time, five for other claims"
        " about a loop and for a map, no limit for a rule base",
        None,
        Limits(0.0, is_open=True),
        unit="seconds",
    )  # fmt: skip
    exact: bool = option("--exact", "compute in rationals throughout", False)
    range: bool = option("--range", "bound the output", False, either="what")
    slope: bool = option("--slope", "bound the slope along each input", False, either="what")
    table: str | None = option(
        "--table WHAT", "bound the error of a table: linear, nearest, bins or a file", None,
        either="what",
    )  # fmt: skip
    sector: bool = option(
        "--sector", "bound the output by multiples of its inputs", False, either="what"
    )
    stable: bool = option(
        "--stable", "of a controller on --plant: prove its loop stable", False, either="what"
    )
    claim: str | None = option(
        "--claim CLAIM", "of a controller: prove this claim, as in a `prove` line", None,
        either="what",
    )  # fmt: skip
    map: bool = option(
        "--map", "of a controller on --plant: which starts are proved to come to rest", False,
        either="what",
    )  # fmt: skip
    check: str | None = option("--check CERTIFICATE", "check a certificate", None, either="what")
    from_: str | None = option(
        "--from START", "with --stable or --for: STATE in LOW .. HIGH, ...", None
    )
    with_: str | None = option(
        "--with VALUES", "with --stable, --map or --for: PARAMETER in LOW .. HIGH, ...", None
    )
    at: str | None = option(
        "--at PORT=X,...", "with --stable, --map or --for: constant set points", None
    )
    over: str | None = option(
        "--over WINDOW", "with --map: STATE in LOW .. HIGH, ...; else the ranges of the outputs",
        None,
    )  # fmt: skip
    workers: int | None = option(
        "--workers N", "with --map: processes at a time; each has the whole --budget", None,
        (1, MOST_WORKERS), idle=True,
    )  # fmt: skip
    resume: str | None = option(
        "--resume JOURNAL", "with --map: a file of the boxes that are done; goes on with it", None,
        idle=True,
    )  # fmt: skip
    duration: str | None = option(
        "--for TIME", "of a loop: bound all ports so long; with --claim: its end", None
    )
    connect: tuple[str, ...] = option(
        "--connect NAME=PORT", "join a name of the controller to a port of the plant", (),
        repeated=True,
    )  # fmt: skip
    quantise: tuple[str, ...] = option(
        "--quantise PORT=STEP", "resolution of a sensor, as in 0.001 or 12bit", (), repeated=True
    )
    sensor_delay: tuple[str, ...] = option(
        "--sensor-delay PORT=TIME", "delay of a sensor, as in 3ms", (), repeated=True
    )
    actuator_delay: tuple[str, ...] = option(
        "--actuator-delay INPUT=TIME", "dead time of an actuator, as in 30ms", (), repeated=True
    )
    continuous: bool = option(
        "--continuous", "of a loop: as if the controller ran without a period", False
    )
    along: str | None = option(
        "--along NAME=W,...", "with --sector: along this sum of the inputs only", None
    )
    plant: str | None = option(
        "--plant PLANT", "of a controller: on this one instead of that of its axes", None
    )
    trust: bool = option(
        "--trust", "run the Python files of plants that lines or a certificate name", False
    )
    output: str | None = option("--output NAME", "which output, if there are several", None)
