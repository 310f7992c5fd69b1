"""What commands say of experiments in the same words: trajectory, load, controller, conventions."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.command import SET, WordError, argument, group, load_rulebase, load_table
from fuzzyarm.cli.plants import option_given, split_settings

if TYPE_CHECKING:
    from fuzzyarm.controller import Controller, Sources
    from fuzzyarm.plant import Arm, Conventions, Plant, Trajectory
    from fuzzyarm.plant.trajectory import Schedule
    from fuzzyarm.table import LookupTable


TRAJECTORY = (
    *group(
        "trajectory",
        argument(
            "--trajectory",
            "what the arm follows; reach-return by default",
            choices=["reach", "reach-return", "pick-and-place"],
            default="reach-return",
        ),
        argument("--angles A1 A2", "where to turn to, degrees", type=float, either="where"),
        argument("--segment SECONDS", "duration of each segment but the hold", type=float),
        argument("--hold SECONDS", "duration of the hold, 5 by default", type=float),
        argument(
            "--way-points A1,A2", "move through these, degrees, instead", nargs="+", either="where"
        ),
    ),
    *group(
        "load",
        argument(
            "--payload", "carry the load", action=argparse.BooleanOptionalAction, default=False
        ),
        argument("--loaded N", "carry the load in these segments", nargs="+", type=int),
    ),
)
CONVENTIONS = (
    argument(
        "--conventions",
        "how to count: plain, or in single precision with 3.142857 for π, as the study's programs",
        choices=["plain", "study"],
        default="plain",
    ),
    argument("--precision", "of states and signals", choices=["float32", "float64"]),
    argument("--pi VALUE", "the constant for π", type=float),
    argument(
        "--load-in-hold",
        "whether a load stays on in a hold; it does",
        action=argparse.BooleanOptionalAction,
        default=True,
    ),
)


SOURCES = group(
    "files of fuzzy controllers, in place of the shipped ones",
    argument("--rulebase FILE", "rules of the control"),
    argument("--alpha FILE", "rules of the factor on the control"),
    argument("--table FILE", "table of the control, or one for each joint", nargs="+"),
    argument("--performance FILE", "table by which SOC judges"),
)
RUN = group(
    "run",
    *CONVENTIONS,
    argument("--start", "adaptive ones", choices=["warm", "cold"], default="warm"),
    argument(
        "--variant",
        "by the study's figures or by its text, where they disagree",
        choices=["as-printed", "as-described"],
        default="as-printed",
    ),
    SET,
    argument("--runge-kutta N", "N fine steps in a control period", type=int, default=0),
)


def conventions_of(arguments: argparse.Namespace) -> Conventions:
    """Return how to count: the same for every controller."""
    from fuzzyarm.plant import PLAIN, STUDY

    conventions = STUDY if arguments.conventions == "study" else PLAIN
    changed: dict[str, Any] = {"load_in_hold": arguments.load_in_hold}
    if arguments.precision:
        changed["precision"] = arguments.precision
    if arguments.pi is not None:
        changed["pi"] = arguments.pi
    return replace(conventions, **changed)


def experiment_of(
    arguments: argparse.Namespace, plant: Plant | None = None
) -> tuple[Trajectory, Conventions, Schedule]:
    """Return what the arguments name: the way, the conventions and the loads.

    Parameters of the arm that differ from the study's are its parameters with a load, too, but
    for those that the load changes.
    """
    from fuzzyarm.plant import Arm, schedule

    trajectory = _trajectory(arguments)
    conventions = conventions_of(arguments)
    option = option_given(arguments, ("step", "reference", "duration"))
    if option is not None:
        raise WordError(f"{option} is for other plants; the arm follows --trajectory")
    arms = schedule(
        trajectory, payload=arguments.payload, segments=arguments.loaded, conventions=conventions
    )
    if isinstance(plant, Arm):
        arms = tuple(replace(arm, **arm_changes(plant)) for arm in arms)
    return trajectory, conventions, arms


def arm_changes(plant: Arm) -> dict[str, float]:
    """Return the parameters of an arm that are not those of the study."""
    from fuzzyarm.plant import UNLOADED, ArmParameters

    own = plant.arm
    found = {each.name: float(getattr(own, each.name)) for each in fields(ArmParameters)}
    return {name: value for name, value in found.items() if value != getattr(UNLOADED, name)}


def _trajectory(arguments: argparse.Namespace) -> Trajectory:
    from fuzzyarm.plant import ArmError, through
    from fuzzyarm.plant.trajectory import TRAJECTORIES

    given: dict[str, Any] = {}
    if arguments.segment is not None:
        given["segment"] = arguments.segment
    if arguments.hold is not None:
        given["hold"] = arguments.hold
    if arguments.way_points:
        return through([_pair(text) for text in arguments.way_points], **given)
    if arguments.angles is not None:
        given["angles"] = tuple(arguments.angles)
    if arguments.trajectory == "pick-and-place" and "hold" in given:
        raise ArmError("pick-and-place has no hold", name="hold", value=arguments.hold)
    return TRAJECTORIES[arguments.trajectory](**given)


def _pair(text: str) -> tuple[float, float]:
    from fuzzyarm.plant import ArmError

    try:
        first, second = (float(part) for part in text.split(","))
    except ValueError:
        message = f"way point '{text}' is not two angles"
        raise ArmError(message, name="way_points", value=text, hint="as in 45,-30") from None
    return first, second


def read_control_table(paths: list[str], option: str) -> tuple[LookupTable, ...]:
    """Return the table in one file, or the tables of both joints in two.

    A rule base is compiled at the levels of its file.
    """
    if len(paths) > 2:
        raise WordError(f"{option} takes one file, or one for each of the two joints")
    return tuple(load_table(path) for path in paths)


def read_performance(word: str) -> LookupTable:
    """Return a performance table: of a file, or a shipped one by its author."""
    from fuzzyarm.shipped_files import shipped, shipped_names

    name = f"performance-{word}.lut"
    known = not Path(word).exists() and name in shipped_names()
    return load_table(str(shipped(name)) if known else word)


def named_controllers(arguments: argparse.Namespace, names: Sequence[str]) -> list[Controller]:
    """Return the controllers of some names, told apart where two have the same."""
    from fuzzyarm.controller.own import find_controllers

    return find_controllers(
        names, start=arguments.start, variant=arguments.variant, sources=sources_of(arguments)
    )


def with_settings(
    arguments: argparse.Namespace, controller: Controller, plant: Plant
) -> tuple[Controller, Plant]:
    """Return a controller with its gains set, and the plant with its parameters."""
    from fuzzyarm.plant.plant import with_parameters

    gains, parameters = split_settings(overrides(arguments.set), controller, plant)
    changed = controller.with_gains(gains)
    changed.name = controller.name
    return changed, with_parameters(plant, parameters) if parameters else plant


def sources_of(arguments: argparse.Namespace) -> Sources:
    """Return the rule bases and tables that the arguments name."""
    from fuzzyarm.controller import Sources

    rulebase, alpha, performance = arguments.rulebase, arguments.alpha, arguments.performance
    return Sources(
        load_rulebase(rulebase, "--rulebase") if rulebase else None,
        load_rulebase(alpha, "--alpha") if alpha else None,
        read_control_table(arguments.table, "--table") if arguments.table else None,
        read_performance(performance) if performance else None,
    )


def overrides(words: list[str]) -> dict[str, list[float]]:
    """Return the gains that words like ``K_P=120,80`` set."""
    from fuzzyarm.controller import GainError

    values = {}
    for word in words:
        name, equals, text = word.partition("=")
        try:
            values[name.strip()] = [float(part) for part in text.split(",")]
        except ValueError:
            hint = "as in K_P=120 or K_P=120,80"
            message = f"'{word}' does not set a gain"
            raise GainError(message, name=name, value=text, hint=hint) from None
        if not equals:
            raise GainError(f"'{word}' does not set a gain", name=name, hint="as in K_P=120")
    return values


DIVERGED = 3
"""Exit status where a run diverged: the figures are those until then."""
