"""The request of a closed loop: plant, references, sensors, drives, arithmetic.

Commands, the designer and Python share these fields; `fuzzyarm.control.loop.words` interprets
their words.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from fuzzyarm.requests.fields import Limits, Request, option

TRAJECTORY, LOAD, PLANT = "trajectory", "load", "plant"
AROUND = "sensors, actuators and disturbances"
RUN = "run"
LAST = "the arm and its study"
AT_THE_END = (TRAJECTORY, LOAD, LAST)
"""Last groups of a help page, in this order: few plants have them."""


TABLES = ("rulebase", "alpha", "table")
"""Fields with files that replace those of a controller."""

BUILT = ("start", "variant", "runge_kutta")
"""Fields that determine how a controller and its loop are built."""


@dataclass(frozen=True, kw_only=True)
class ExperimentRequest(Request):
    """A closed loop: plant, trajectory or references, sensors, arithmetic."""

    trajectory: str | None = option(
        "--trajectory NAME",
        "trajectory of the plant, by default its first; the arm has reach-return, "
        "pick-and-place and reach",
        None,
        group=TRAJECTORY,
    )
    angles: tuple[float, float] | None = option(
        "--angles A1 A2", "where to turn to, degrees", None, unit="degrees", group=LAST,
        either="where",
    )  # fmt: skip
    segment: float | None = option(
        "--segment SECONDS", "duration of each segment but the hold", None, unit="s",
        group=LAST,
    )  # fmt: skip
    hold: float | None = option(
        "--hold SECONDS", "duration of the hold, 5 by default", None, unit="s", group=LAST
    )
    way_points: tuple[str, ...] = option(
        "--way-points A1,A2", "move through these, degrees, instead", (), group=LAST,
        either="where",
    )  # fmt: skip
    payload: bool | None = option("--payload", "carry the load", False, group=LOAD, negatable=True)
    loaded: tuple[int, ...] = option(
        "--loaded N", "carry the load in these segments", (), group=LOAD
    )

    plant: str | None = option(
        "--plant PLANT",
        "arm, motor, cartpole, tanks, ball-and-beam, room, FILE.py or FILE.py:CLASS; "
        "by default the shipped one that has the axes of the controller",
        None,
        group=PLANT,
    )
    connect: tuple[str, ...] = option(
        "--connect NAME=PORT", "join a name of the controller to a port of the plant", (),
        group=PLANT, repeated=True,
    )  # fmt: skip
    duration: str | None = option("--for TIME", "how long, as in 2s, 500ms, 1h", None, group=PLANT)
    step: float | None = option(
        "--step VALUE", "step of the first reference, 1 by default", None, group=PLANT
    )
    reference: tuple[str, ...] = option(
        "--reference PORT=SIGNAL", "step:1, ramp:0.5, sine:1,0.5, quintic:1,2, FILE.csv", (),
        group=PLANT, repeated=True,
    )  # fmt: skip

    noise: tuple[str, ...] = option(
        "--noise PORT=DEVIATION", "white noise of a sensor", (), group=AROUND, repeated=True
    )
    quantise: tuple[str, ...] = option(
        "--quantise PORT=STEP", "resolution of a sensor, as in 0.001 or 12bit", (), group=AROUND,
        repeated=True,
    )  # fmt: skip
    sensor_delay: tuple[str, ...] = option(
        "--sensor-delay PORT=TIME", "delay of a sensor, as in 3ms", (), group=AROUND, repeated=True
    )
    difference: tuple[str, ...] = option(
        "--difference PORT=TIME", "form a rate by difference, with a filter of this time", (),
        group=AROUND, repeated=True,
    )  # fmt: skip
    actuator: tuple[str, ...] = option(
        "--actuator INPUT=LOW..HIGH",
        "limits of a drive, then slew and start: 0..5,slew=2,start=1", (),
        group=AROUND, repeated=True,
    )  # fmt: skip
    actuator_delay: tuple[str, ...] = option(
        "--actuator-delay INPUT=TIME", "dead time of an actuator, as in 30ms", (), group=AROUND,
        repeated=True,
    )  # fmt: skip
    disturb: tuple[str, ...] = option(
        "--disturb INPUT=SIGNAL", "add this to a drive, as in voltage=step:-2,1", (),
        group=AROUND, repeated=True,
    )  # fmt: skip
    interpolate: bool = option(
        "--interpolate", "move the reference between set points, instead of holding it", False,
        group=AROUND,
    )  # fmt: skip
    seed: int = option("--seed N", "seed of noise and disturbance", 1, Limits(0), group=AROUND)

    rulebase: str | None = option(
        "--rulebase FILE", "rules of the control, for the shipped ones", None, group=LAST
    )
    alpha: str | None = option(
        "--alpha FILE", "rules of the factor on the control", None, group=LAST
    )
    table: tuple[str, ...] = option(
        "--table FILE", "table of the control, or one for each joint", (), group=LAST
    )
    performance: str | None = option(
        "--performance FILE", "table by which SOC judges", None, group=LAST
    )

    conventions: Literal["plain", "study"] = option(
        "--conventions",
        "how to count: plain, or in single precision with 3.142857 for π, as the study's programs",
        "plain",
        group=LAST,
    )
    precision: Literal["float32", "float64"] | None = option(
        "--precision", "of states and signals", None, group=RUN
    )
    pi: float | None = option("--pi VALUE", "the constant for π", None, group=LAST)
    load_in_hold: bool = option(
        "--load-in-hold", "whether a load stays on in a hold (default: yes)", True, group=LAST,
        negatable=True,
    )  # fmt: skip
    start: Literal["warm", "cold"] = option(
        "--start", "of adaptive controllers", "warm", group=LAST
    )
    variant: Literal["as-printed", "as-described"] = option(
        "--variant", "by the study's figures or by its text, where they disagree", "as-printed",
        group=LAST,
    )  # fmt: skip
    set: tuple[str, ...] = option(
        "--set NAME=V[,V]",
        "set a gain of the controller or a parameter of the plant",
        (),
        group=RUN,
        repeated=True,
    )
    runge_kutta: int = option(
        "--runge-kutta N", "N fine steps in a control period", 0, (0, 1000), group=RUN
    )

    limits: tuple[float, float] | None = option(
        "--limits T1 T2", "largest torques, N m", None, unit="N m", group=LAST
    )
    supply: float | None = option(
        "--supply V", "largest voltage at a motor", None, unit="V", group=LAST
    )
    inductance: float | None = option(
        "--inductance H", "inductance of each armature; 0 by default", None, unit="H", group=LAST
    )
