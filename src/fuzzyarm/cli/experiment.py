"""What commands say of experiments in the same words: trajectory, load, controller, conventions."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.command import (
    SET,
    UsageError,
    WordError,
    argument,
    group,
    load_rulebase,
    load_table,
)
from fuzzyarm.cli.plants import connections, follows, motion_of, split_settings

if TYPE_CHECKING:
    from fuzzyarm.controller import Controller, Sources
    from fuzzyarm.loop import Motion
    from fuzzyarm.plant import Conventions, Plant, Trajectory
    from fuzzyarm.table import LookupTable


TRAJECTORY = (
    *group(
        "trajectory",
        argument(
            "--trajectory NAME",
            "what the plant follows, by default its first; the arm has reach-return, "
            "pick-and-place and reach",
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


def set_points(
    arguments: argparse.Namespace,
    controller: Controller,
    plant: Plant,
    conventions: Conventions,
) -> Motion:
    """Return what a plant follows: a trajectory of its own with its load, or references.

    Parameters of the plant that were set are its parameters with its load, too.
    """
    from fuzzyarm.loop.along import trajectory_motion

    if not follows(arguments, plant):
        return motion_of(arguments, controller, plant)
    return trajectory_motion(
        plant,
        trajectory_of_words(arguments, plant),
        controller,
        conventions,
        payload=arguments.payload,
        segments=arguments.loaded,
        connect=connections(arguments),
    )


def trajectory_of_words(arguments: argparse.Namespace, plant: Plant) -> Trajectory:
    """Return the trajectory that the arguments name; they name the default one from then on.

    Raises
    ------
    UsageError
        If the plant has none of this name.
    """
    from fuzzyarm.plant.following import UnknownTrajectoryError, trajectory_of, way_points

    given: dict[str, Any] = {}
    if arguments.segment is not None:
        given["segment"] = arguments.segment
    if arguments.hold is not None:
        given["hold"] = arguments.hold
    if arguments.way_points:
        return way_points(plant, [*map(_point, arguments.way_points)], **given)
    if arguments.angles is not None:
        given["angles"] = tuple(arguments.angles)
    arguments.trajectory = arguments.trajectory or next(iter(plant.trajectories))
    try:
        return trajectory_of(plant, arguments.trajectory, **given)
    except UnknownTrajectoryError as error:
        raise UsageError(error.message, hint=error.hint) from error


def _point(text: str) -> tuple[float, ...]:
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        raise WordError(f"way point '{text}' is not numbers", hint="as in 45,-30") from None


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
