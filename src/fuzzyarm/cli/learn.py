"""Train self-organizing control (SOC), see its tables grow, save what it has learned.

The table begins at zero, at the shipped table (--start table) or at a file of yours. At
every control step the performance table judges the error and its rate and corrects the
cell that was responsible. Printed are, for each joint, the learned table with the cells
that changed since the start in brackets, and how often each cell was used.

-o FILE writes one table with an input 'joint' over those of both joints; with --joint N
that of one joint alone. fuzzy-lut-x10, whose error gain is that of SOC, runs either. A table
that is to be frozen is learned at a small rate: at rate 1 it keeps jumping to the end.

Examples
--------
  fuzzyarm learn --trajectory pick-and-place --payload --rate 0.01 --passes 5 -o learned.lut
  fuzzyarm diff before.lut learned.lut
  fuzzyarm simulate fuzzy-lut-x10 --table learned.lut --trajectory pick-and-place --payload
  fuzzyarm learn --start learned.lut --freeze --payload
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.arguments import (
    WordError,
    add_conventions,
    add_trajectory,
    conventions_of,
    read_control_table,
    read_performance,
    trajectory_of,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from fuzzyarm.controller import Sources
    from fuzzyarm.controller.controller import CompiledController
    from fuzzyarm.controller.self_organizing import Learned
    from fuzzyarm.controller.sources import JointTables
    from fuzzyarm.learning.self_organizing import Snapshot
    from fuzzyarm.table import LookupTable


MOST_PASSES = 10_000


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm learn``."""
    parser.add_argument(
        "--start",
        nargs="+",
        default=["zero"],
        metavar="WORD",
        help="zero (default), table (the shipped one), FILE, or a FILE for each joint",
    )
    parser.add_argument(
        "--performance",
        default="yamazaki",
        metavar="WORD",
        help="FILE, or yamazaki (default) or procyk-mamdani, which are shipped",
    )
    add_trajectory(parser)
    run = parser.add_argument_group("training")
    run.add_argument("--passes", type=int, default=1, metavar="N", help="repeat the trajectory")
    run.add_argument("--rate", type=float, default=1.0, metavar="R", help="learning rate")
    run.add_argument(
        "--delay",
        type=int,
        default=1,
        metavar="N",
        help="control steps from a cell's use to its judgement",
    )
    run.add_argument("--freeze", action="store_true", help="run with the table as it is")
    run.add_argument(
        "--set", action="append", default=[], metavar="GAIN=V[,V]", help="override a gain"
    )
    add_conventions(run)
    out = parser.add_argument_group("output")
    out.add_argument("-o", "--out", metavar="FILE", help=".lut, .csv, .json or .npz")
    out.add_argument("--joint", type=int, choices=[1, 2], help="write the table of one joint")
    out.add_argument("--date", action="store_true", help="write the date into the file")
    out.add_argument(
        "--every", type=int, metavar="N", help="show the tables after every N set points"
    )
    out.add_argument("--json", action="store_true")


def run(arguments: argparse.Namespace) -> int:
    """Run ``fuzzyarm learn``."""
    _check(arguments)
    sources = _sources(arguments)
    controller, start = _controller(arguments, sources)
    shown: list[dict[str, Any]] = []
    finished: list[Snapshot] = []
    for snapshot in _watched(arguments, controller, start):
        if snapshot.complete:
            finished.append(snapshot)
        if arguments.every and not arguments.json:
            _show_growth(arguments, snapshot, start, sources)
        elif arguments.every:
            shown.append(_as_json(snapshot, start))
    last = finished[-1]
    if arguments.out:
        _write(arguments, last.learned, start, sources)
    if arguments.json:
        print(json.dumps(_report(arguments, finished, start, shown), indent=1))
    else:
        _print(arguments, finished, start, sources)
    return 0


def _check(arguments: argparse.Namespace) -> None:
    if not 1 <= arguments.passes <= MOST_PASSES:
        raise WordError(f"--passes takes 1 to {MOST_PASSES}, not {arguments.passes}")
    if arguments.every is not None and arguments.every < 1:
        raise WordError(f"--every takes at least 1 set point, not {arguments.every}")
    if arguments.freeze and arguments.out:
        raise WordError("--freeze learns nothing, so there is nothing to write with -o")
    if arguments.joint and not arguments.out:
        raise WordError("--joint says which table to write, so it needs -o FILE")
    if arguments.out:
        from fuzzyarm.table.files import SUFFIXES

        out = Path(arguments.out)
        if out.suffix.lower() not in SUFFIXES:
            known = ", ".join(SUFFIXES)
            raise WordError(f"'{out.name}' does not tell a format", hint=f"known: {known}")
        if not out.parent.is_dir():
            raise WordError(f"there is no folder '{out.parent}'")


def _sources(arguments: argparse.Namespace) -> Sources:
    from fuzzyarm.controller import Sources
    from fuzzyarm.controller.catalogue import TABLE
    from fuzzyarm.controller.sources import shipped_table

    table = None
    if arguments.start == ["table"]:
        table = shipped_table(TABLE)
    elif arguments.start != ["zero"]:
        table = read_control_table(arguments.start, "--start")
    return Sources(table=table, performance=read_performance(arguments.performance))


def _controller(
    arguments: argparse.Namespace, sources: Sources
) -> tuple[CompiledController, JointTables]:
    from fuzzyarm.cli.simulate import overrides
    from fuzzyarm.controller import controller
    from fuzzyarm.controller.controller import CompiledController
    from fuzzyarm.controller.self_organizing import starting_tables
    from fuzzyarm.controller.sources import joint_tables

    made = controller("soc-zero", sources=sources).with_gains(
        {
            "learning_rate": [0.0 if arguments.freeze else arguments.rate],
            "delay": [float(arguments.delay)],
            **overrides(arguments.set),
        }
    )
    assert isinstance(made, CompiledController)
    assert sources.performance is not None
    return made, starting_tables(sources.table, joint_tables(sources.performance))


def _watched(
    arguments: argparse.Namespace, controller: CompiledController, start: JointTables
) -> Iterator[Snapshot]:
    """Train, with a progress bar where a terminal shows it."""
    from fuzzyarm.learning.self_organizing import train
    from fuzzyarm.plant import schedule
    from fuzzyarm.plant.trajectory import sample

    trajectory = trajectory_of(arguments)
    conventions = conventions_of(arguments, "soc-zero")
    arms = schedule(
        trajectory, payload=arguments.payload, segments=arguments.loaded, conventions=conventions
    )
    points = len(sample(trajectory, conventions).time)
    shape = len(start.rows.levels), len(start.columns.levels)
    done = 0
    with _bar(points * arguments.passes, arguments) as watch:
        for snapshot in train(
            controller,
            trajectory,
            shape,
            passes=arguments.passes,
            every=arguments.every,
            arms=arms,
            conventions=conventions,
        ):
            watch(snapshot.points - done)
            done = snapshot.points
            # A cell that was never used has to stay what its file says, and 1.8 - 1 + 1 is 1.8.
            kept = snapshot.learned.readable(single=conventions.single)
            yield replace(snapshot, learned=kept)


@contextmanager
def _bar(total: int, arguments: argparse.Namespace) -> Iterator[Callable[[int], None]]:
    # A bar and grids on one screen would be in each other's way.
    if not sys.stderr.isatty() or (arguments.every and not arguments.json):
        yield lambda _count: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("learning", total=total)
        yield lambda count: progress.advance(task, count)


def _tables(values: Any, start: JointTables, sources: Sources) -> list[LookupTable]:
    """Return the table of each joint over e and ce."""
    from fuzzyarm.table import LookupTable

    like = sources.table or sources.performance
    assert like is not None
    return [
        LookupTable(
            (start.rows, start.columns),
            "u",
            values[joint],
            low=like.low,
            high=like.high,
            description="control, normalised",
            mode=start.mode if start.mode != "bins" else None,
        )
        for joint in (0, 1)
    ]


def _show_growth(
    arguments: argparse.Namespace, snapshot: Snapshot, start: JointTables, sources: Sources
) -> None:
    from fuzzyarm.show.drawing import make_console
    from fuzzyarm.show.table import learned_view

    console = make_console()
    rms = snapshot.rms
    console.print(
        f"pass {snapshot.passage} of {arguments.passes}, {snapshot.time:.3f} s: "
        f"RMS error {rms[0]:.4f}° and {rms[1]:.4f}° so far"
    )
    before = _tables(start.values, start, sources)
    after = _tables(snapshot.learned.values, start, sources)
    for joint in (0, 1):
        visits = snapshot.learned.visits[joint]
        name = f"joint {joint + 1}"
        console.print(learned_view(before[joint], after[joint], visits, name, with_visits=False))


def _print(
    arguments: argparse.Namespace,
    finished: list[Snapshot],
    start: JointTables,
    sources: Sources,
) -> None:
    from fuzzyarm.show.drawing import make_console
    from fuzzyarm.show.table import learned_view

    console = make_console()
    last = finished[-1]
    before = _tables(start.values, start, sources)
    after = _tables(last.learned.values, start, sources)
    for joint in (0, 1):
        visits = last.learned.visits[joint]
        console.print(learned_view(before[joint], after[joint], visits, f"joint {joint + 1}"))
    for snapshot in finished:
        rms = snapshot.rms
        console.print(
            f"pass {snapshot.passage}: RMS error {rms[0]:.4f}° and {rms[1]:.4f}°"
            + (", learning off" if arguments.freeze else "")
        )
    if last.diverged is not None:
        console.print(f"diverged: the training was stopped at {last.diverged:.3f} s of that pass")
    if arguments.out:
        both = "" if arguments.joint else ", both joints in one table over joint, e and ce"
        console.print(f"{arguments.out}: written{both}", soft_wrap=True)


def _write(
    arguments: argparse.Namespace, learned: Learned, start: JointTables, sources: Sources
) -> None:
    from fuzzyarm.controller.sources import over_joints
    from fuzzyarm.table import write_table

    tables = _tables(learned.values, start, sources)
    origin = tuple(_provenance(arguments).items())
    if arguments.joint:
        table = replace(tables[arguments.joint - 1], provenance=origin)
    else:
        values = replace(start, values=learned.values)
        table = replace(over_joints(values, tables[0]), provenance=origin)
    write_table(table, arguments.out)


def _provenance(arguments: argparse.Namespace) -> dict[str, str]:
    from fuzzyarm import __version__

    pairs = {
        "made": "learned by self-organizing control",
        "start": " ".join(Path(word).name for word in arguments.start),
        "performance": Path(arguments.performance).name,
        "trajectory": _trajectory_words(arguments),
        "passes": str(arguments.passes),
        "learning": f"rate {arguments.rate:g}, delay {arguments.delay}",
        "conventions": arguments.conventions,
        "engine": f"fuzzyarm {__version__}",
    }
    if arguments.set:
        pairs["gains"] = " ".join(arguments.set)
    if arguments.joint:
        pairs["joint"] = str(arguments.joint)
    if arguments.date:
        pairs["date"] = datetime.now(UTC).date().isoformat()
    return pairs


def _trajectory_words(arguments: argparse.Namespace) -> str:
    words = [arguments.trajectory]
    if arguments.way_points:
        words = ["way points", *arguments.way_points]
    elif arguments.angles is not None:
        words.append("to {:g}° and {:g}°".format(*arguments.angles))
    if arguments.segment is not None:
        words.append(f"in {arguments.segment:g} s")
    if arguments.payload:
        words.append("with payload")
    if arguments.loaded:
        words.append("loaded in segments " + " ".join(map(str, arguments.loaded)))
    return " ".join(words)


def _as_json(snapshot: Snapshot, start: JointTables) -> dict[str, Any]:
    learned = snapshot.learned
    changed = learned.values != start.values
    return {
        "pass": snapshot.passage,
        "time": snapshot.time,
        "rms": [float(each) for each in snapshot.rms],
        "complete": snapshot.complete,
        "diverged": snapshot.diverged,
        "joints": [
            {
                "visited": int((learned.visits[joint] > 0).sum()),
                "changed": int(changed[joint].sum()),
                "never_visited": int((learned.visits[joint] == 0).sum()),
            }
            for joint in (0, 1)
        ],
    }


def _report(
    arguments: argparse.Namespace,
    finished: list[Snapshot],
    start: JointTables,
    shown: list[dict[str, Any]],
) -> dict[str, Any]:
    last = finished[-1].learned
    report = {
        "passes": [_as_json(snapshot, start) for snapshot in finished],
        "levels": {"e": list(start.rows.levels), "ce": list(start.columns.levels)},
        "tables": last.values.tolist(),
        "visits": last.visits.tolist(),
        "file": arguments.out,
    }
    return {**report, "snapshots": shown} if arguments.every else report
