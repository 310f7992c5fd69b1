"""Margins of a loop: which controller and plant, where it rests, over which share of the ranges."""

from __future__ import annotations

from dataclasses import dataclass

from fuzzyarm.requests.fields import Limits, Request, option


@dataclass(frozen=True, kw_only=True)
class MarginsRequest(Request):
    """The loop whose margins are computed; see ``fuzzyarm margins``."""

    file: str = option("file FILE", "a controller")
    plant: str | None = option(
        "--plant PLANT", "motor, room, … or FILE.py; by default the shipped one with its axes", None
    )
    at: str | None = option("--at PORT=X,...", "constant set points; 0 by default", None)
    with_: str | None = option(
        "--with VALUES", "PARAMETER in VALUE .. VALUE, ... of the plant: one value of each", None
    )
    connect: tuple[str, ...] = option(
        "--connect NAME=PORT", "join a name of the controller to a port of the plant", (),
        repeated=True,
    )  # fmt: skip
    sensor_delay: tuple[str, ...] = option(
        "--sensor-delay PORT=TIME", "delay of a sensor, as in 3ms", (), repeated=True
    )
    actuator_delay: tuple[str, ...] = option(
        "--actuator-delay INPUT=TIME", "dead time of an actuator, as in 30ms", (), repeated=True
    )
    share: float = option(
        "--share S",
        "of the ranges of the rules' inputs around rest, over which their gains are bounded",
        1.0,
        Limits(0.0, 1.0, is_open=True),
    )
    budget: float = option(
        "--budget SECONDS", "processor seconds that bounds of the rules' gains may take;"
        " without bounds margins are at rest only", 60.0, Limits(0.0, is_open=True),
        unit="seconds",
    )  # fmt: skip
