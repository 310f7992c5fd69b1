"""Arguments that name an experiment on the arm: trajectory, load, conventions, files."""

from __future__ import annotations

import argparse
import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.assignments import WordError

if TYPE_CHECKING:
    from fuzzyarm.arm import Conventions, Trajectory
    from fuzzyarm.control import Sources
    from fuzzyarm.lut import LookupTable
    from fuzzyarm.rulebase import RuleBase


def add_trajectory(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of trajectory and load."""
    # A way point with a negative first angle is no option.
    parser._negative_number_matcher = re.compile(r"-\d[-+\d.,eE]*$|-\.\d[-+\d.,eE]*$")
    path = parser.add_argument_group("trajectory")
    path.add_argument(
        "--trajectory", choices=["reach", "reach-return", "pick-and-place"], default="reach-return"
    )
    where = path.add_mutually_exclusive_group()
    where.add_argument(
        "--angles", nargs=2, type=float, metavar=("A1", "A2"), help="where to turn to, degrees"
    )
    path.add_argument("--segment", type=float, metavar="SECONDS", help="duration of each segment")
    path.add_argument("--hold", type=float, metavar="SECONDS", help="duration of the hold")
    where.add_argument(
        "--way-points", nargs="+", metavar="A1,A2", help="move through these, degrees, instead"
    )
    load = parser.add_argument_group("load")
    load.add_argument("--payload", action=argparse.BooleanOptionalAction, default=False)
    load.add_argument(
        "--loaded", nargs="+", type=int, metavar="N", help="carry the load in these segments"
    )


def add_conventions(group: Any) -> None:
    """Add the arguments of conventions."""
    group.add_argument("--conventions", choices=["plain", "study"], default="plain")
    group.add_argument("--precision", choices=["float32", "float64"])


def trajectory_of(arguments: argparse.Namespace) -> Trajectory:
    """Return the trajectory that the arguments name."""
    from fuzzyarm.arm import ArmError, pick_and_place, reach, reach_return, through

    given: dict[str, Any] = {}
    if arguments.segment is not None:
        given["segment"] = arguments.segment
    if arguments.hold is not None:
        given["hold"] = arguments.hold
    if arguments.way_points:
        return through([_pair(text) for text in arguments.way_points], **given)
    if arguments.angles is not None:
        given["angles"] = tuple(arguments.angles)
    if arguments.trajectory == "pick-and-place":
        if "hold" in given:
            raise ArmError("pick-and-place has no hold", name="hold", value=arguments.hold)
        return pick_and_place(**given)
    return (reach if arguments.trajectory == "reach" else reach_return)(**given)


def _pair(text: str) -> tuple[float, float]:
    from fuzzyarm.arm import ArmError

    try:
        first, second = (float(part) for part in text.split(","))
    except ValueError:
        message = f"way point '{text}' is not two angles"
        raise ArmError(message, name="way_points", value=text, hint="as in 45,-30") from None
    return first, second


def conventions_of(arguments: argparse.Namespace, controller: str) -> Conventions:
    """Return the conventions that the arguments name, for a controller."""
    from fuzzyarm.arm import PLAIN
    from fuzzyarm.control.catalogue import study_conventions

    chosen = PLAIN
    if arguments.conventions == "study":
        chosen = study_conventions(controller)
    return replace(chosen, precision=arguments.precision) if arguments.precision else chosen


def read_rulebase(path: str, option: str) -> RuleBase:
    """Return the rule base in a file that was given for `option`."""
    from fuzzyarm.api import load
    from fuzzyarm.rulebase import RuleBase

    model = load(path)
    if not isinstance(model, RuleBase):
        raise WordError(f"{option} takes a rule base, and {path} is a table")
    return model


def read_control_table(paths: list[str], option: str) -> LookupTable:
    """Return the table in one file, or the tables of both joints in two.

    A rule base is compiled at the levels of its file.
    """
    from fuzzyarm.control.table_numbers import joined

    if len(paths) > 2:
        raise WordError(f"{option} takes one file, or one for each of the two joints")
    tables = [_table(path) for path in paths]
    return tables[0] if len(tables) == 1 else joined(tables[0], tables[1])


def _table(path: str) -> LookupTable:
    from fuzzyarm.api import load
    from fuzzyarm.lut import compile_table
    from fuzzyarm.rulebase import RuleBase

    model = load(path)
    return compile_table(model, source=path) if isinstance(model, RuleBase) else model


def read_performance(word: str) -> LookupTable:
    """Return a performance table: of a file, or a shipped one by its author."""
    from fuzzyarm.control.sources import shipped_table
    from fuzzyarm.shipped_files import shipped_names

    name = f"performance-{word}.lut"
    if not Path(word).exists() and name in shipped_names():
        return shipped_table(name)
    return _table(word)


def sources_of(arguments: argparse.Namespace) -> Sources:
    """Return the rule bases and tables that the arguments name."""
    from fuzzyarm.control import Sources

    rulebase, alpha, performance = arguments.rulebase, arguments.alpha, arguments.performance
    return Sources(
        read_rulebase(rulebase, "--rulebase") if rulebase else None,
        read_rulebase(alpha, "--alpha") if alpha else None,
        read_control_table(arguments.table, "--table") if arguments.table else None,
        read_performance(performance) if performance else None,
    )
