"""Arguments that several commands share: ``name=value``, levels, experiments on the arm."""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.language.tokens import Cursor, Fault, tokenize
from fuzzyarm.text.diagnostic import Diagnostic
from fuzzyarm.text.names import near_hint

if TYPE_CHECKING:
    from fuzzyarm.controller import Sources
    from fuzzyarm.model.rulebase import RuleBase
    from fuzzyarm.plant import Conventions, Trajectory
    from fuzzyarm.table import LookupTable


# --- `name=value` words ---


class WordError(FuzzyarmError, ValueError):
    """A word on the command line that says nothing sensible."""


def read_assignments(
    words: Iterable[str], names: Iterable[str], *, what: str = "input"
) -> dict[str, float]:
    """Return the values in words like ``e=1.3`` or ``e=1.3,ce=-2``.

    Parameters
    ----------
    words : iterable of str
        From the command line.
    names : iterable of str
        The names that may be given a value.
    what : str
        What the names are, for the message.

    Raises
    ------
    WordError
        For an unknown name, a name given twice, or a value that is no finite number.
    """
    known = tuple(names)
    values: dict[str, float] = {}
    for name, text in _pairs(words, known):
        if name not in known:
            hint, _ = near_hint(name, known)
            listed = ", ".join(known) or "none"
            raise WordError(f"there is no {what} '{name}'", hint=hint or f"there are: {listed}")
        if name in values:
            raise WordError(f"'{name}' is given twice")
        values[name] = read_number(text, name)
    return values


def _pairs(words: Iterable[str], known: tuple[str, ...]) -> Iterable[tuple[str, str]]:
    for word in words:
        # A name may itself have a comma or an equals sign: try the names there are first.
        rest = word
        while rest:
            name = next((n for n in known if rest.startswith(f"{n}=")), None)
            if name is None:
                name, equals, _ = rest.partition("=")
                if not equals or not name:
                    raise WordError(f"'{rest}' is no assignment", hint="write, for instance, e=1.3")
            value, _, rest = rest[len(name) + 1 :].partition(",")
            yield name.strip(), value.strip()


def read_number(text: str, name: str) -> float:
    """Return the finite number in `text`; `name` says whose it is."""
    try:
        value = float(text)
    except ValueError:
        raise WordError(f"the value of '{name}' is no number: '{text}'") from None
    if not math.isfinite(value):
        raise WordError(f"the value of '{name}' must be finite, not {text}")
    return value


def require_all(values: dict[str, float], names: Iterable[str]) -> None:
    """Raise WordError if any of `names` has no value."""
    missing = [name for name in names if name not in values]
    if missing:
        several = "s" if len(missing) > 1 else ""
        listed = ", ".join(missing)
        example = " ".join(f"{name}=0" for name in missing)
        raise WordError(
            f"no value for input{several} {listed}", hint=f"add, for instance, {example}"
        )


# --- The `--levels` of `compile`, in the words of the language ---

Levels = int | tuple[float, ...]

_NAMED = re.compile(r"\s*(?P<name>[^=:]+?)\s*[=:]\s*(?P<rest>.+)", re.DOTALL)


def read_levels(text: str) -> Levels | dict[str, Levels]:
    """Return what ``--levels`` asks for.

    Parameters
    ----------
    text : str
        ``49`` (that many even levels for every input), ``-6 .. 6 step 1`` or ``0 1 5``
        (these levels), or either for named inputs: ``e = 49, ce = -6 .. 6 step 1``.

    Raises
    ------
    WordError
        If it cannot be read so.
    """
    parts = [part for part in re.split(r"[,;]", text) if part.strip()]
    if not parts:
        raise WordError("--levels says nothing")
    if len(parts) == 1 and not _NAMED.match(parts[0]):
        return _levels_of_one(parts[0])
    levels: dict[str, Levels] = {}
    for part in parts:
        match = _NAMED.match(part)
        if match is None:
            raise WordError(f"--levels '{part.strip()}' does not say for which input")
        levels[match["name"].strip("'")] = _levels_of_one(match["rest"])
    return levels


def _levels_of_one(text: str) -> Levels:
    from fuzzyarm.table.header import read_number_list

    if re.fullmatch(r"\s*[0-9]+\s*", text):
        return int(text)
    diagnostics: list[Diagnostic] = []
    lines = tokenize(text, diagnostics)
    tokens = lines[0].tokens if lines else ()
    if diagnostics or not tokens:
        raise WordError(f"--levels '{text.strip()}' is no list of numbers")
    cursor = Cursor(tokens)
    try:
        values = read_number_list(cursor, "levels")
        cursor.finish()
    except Fault as fault:
        raise WordError(f"--levels '{text.strip()}': {fault.diagnostic.message}") from None
    if len(values) == 1:
        raise WordError(f"--levels '{text.strip()}' is no whole number of levels")
    return values


# --- Arguments that name an experiment on the arm: trajectory, load, conventions, files ---


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
    from fuzzyarm.plant import ArmError, pick_and_place, reach, reach_return, through

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
    from fuzzyarm.plant import ArmError

    try:
        first, second = (float(part) for part in text.split(","))
    except ValueError:
        message = f"way point '{text}' is not two angles"
        raise ArmError(message, name="way_points", value=text, hint="as in 45,-30") from None
    return first, second


def conventions_of(arguments: argparse.Namespace, controller: str) -> Conventions:
    """Return the conventions that the arguments name, for a controller."""
    from fuzzyarm.controller.catalogue import study_conventions
    from fuzzyarm.plant import PLAIN

    chosen = PLAIN
    if arguments.conventions == "study":
        chosen = study_conventions(controller)
    return replace(chosen, precision=arguments.precision) if arguments.precision else chosen


def read_rulebase(path: str, option: str) -> RuleBase:
    """Return the rule base in a file that was given for `option`."""
    from fuzzyarm.api import load
    from fuzzyarm.model.rulebase import RuleBase

    model = load(path)
    if not isinstance(model, RuleBase):
        raise WordError(f"{option} takes a rule base, and {path} is a table")
    return model


def read_control_table(paths: list[str], option: str) -> LookupTable:
    """Return the table in one file, or the tables of both joints in two.

    A rule base is compiled at the levels of its file.
    """
    from fuzzyarm.controller.sources import joined

    if len(paths) > 2:
        raise WordError(f"{option} takes one file, or one for each of the two joints")
    tables = [_table(path) for path in paths]
    return tables[0] if len(tables) == 1 else joined(tables[0], tables[1])


def _table(path: str) -> LookupTable:
    from fuzzyarm.api import load
    from fuzzyarm.model.rulebase import RuleBase
    from fuzzyarm.table import compile_table

    model = load(path)
    return compile_table(model, source=path) if isinstance(model, RuleBase) else model


def read_performance(word: str) -> LookupTable:
    """Return a performance table: of a file, or a shipped one by its author."""
    from pathlib import Path

    from fuzzyarm.controller.sources import shipped_table
    from fuzzyarm.shipped_files import shipped_names

    name = f"performance-{word}.lut"
    if not Path(word).exists() and name in shipped_names():
        return shipped_table(name)
    return _table(word)


def sources_of(arguments: argparse.Namespace) -> Sources:
    """Return the rule bases and tables that the arguments name."""
    from fuzzyarm.controller import Sources

    rulebase, alpha, performance = arguments.rulebase, arguments.alpha, arguments.performance
    return Sources(
        read_rulebase(rulebase, "--rulebase") if rulebase else None,
        read_rulebase(alpha, "--alpha") if alpha else None,
        read_control_table(arguments.table, "--table") if arguments.table else None,
        read_performance(performance) if performance else None,
    )
