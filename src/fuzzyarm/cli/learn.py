"""Train self-organizing control (SOC) on the arm or on any plant, see its tables grow, save them.

The table begins at zero, at the shipped table (--start table) or at a file of yours. At
every control step the performance table judges the error and its rate and corrects the
cell that was responsible. Printed are, for each joint, the learned table with the cells
that changed since the start in brackets, and how often each cell was used.

-o FILE writes one table with an input 'joint' over those of both joints; with --joint N
that of one joint alone. fuzzy-lut-x10, whose error gain is that of SOC, runs either. A table
that is to be frozen is learned at a small rate: at rate 1 it keeps jumping to the end. Exit
status 3 if the last pass diverged.

Examples
--------
  fuzzyarm learn --trajectory pick-and-place --payload --rate 0.01 --passes 5 -o learned.lut
  fuzzyarm diff before.lut learned.lut
  fuzzyarm simulate fuzzy-lut-x10 --table learned.lut --trajectory pick-and-place --payload
  fuzzyarm learn --start learned.lut --freeze --payload
  fuzzyarm learn servo-soc.frb --plant motor --passes 6 -o learned.lut
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.command import (
    EXIT_INTERRUPTED,
    JSON,
    SET,
    WordError,
    argument,
    attempted,
    command,
    demand_places,
    flag,
    group,
    out,
    print_error,
    print_json,
    progress_bar,
    require_suffix,
    saved,
)
from fuzzyarm.cli.experiment import (
    CONVENTIONS,
    DIVERGED,
    TRAJECTORY,
    conventions_of,
    overrides,
    read_control_table,
    read_performance,
    set_points,
)
from fuzzyarm.cli.plants import (
    PLANT,
    connections,
    equipped_by,
    follows,
    plant_of,
    split_settings,
)
from fuzzyarm.errors import FuzzyarmError, sentence_of
from fuzzyarm.language.controller_meaning import MAX_DELAY

if TYPE_CHECKING:
    from rich.console import Console

    from fuzzyarm.controller import Sources
    from fuzzyarm.controller.on_plant import Learned
    from fuzzyarm.learning.self_organizing import Snapshot

LOOKS = 20
"""In how many parts a pass is run."""


def _run(arguments: argparse.Namespace) -> int:
    _check(arguments)
    training = _Training(arguments)
    training.run()
    start, last = training.trainee.start, training.last
    faults = list(training.faults)
    if arguments.out:
        written = saved(arguments.out, lambda path: training.write(last, path))
        arguments.out = written.path
        faults += [written.fault] if written.fault else []
    if arguments.json:
        report = {
            "passes": [training.data(snapshot) for snapshot in training.finished],
            "levels": {axis.name: list(axis.levels) for axis in start.axes},
            "tables": last.learned.values.tolist(),
            "visits": last.learned.visits.tolist(),
            "file": arguments.out,
        }
        shown = [training.data(snapshot) for snapshot in training.shown]
        print_json({**report, "snapshots": shown} if arguments.every else report, 1)
    else:
        training.print(last)
    faults += attempted(training.draw)
    for fault in faults:
        print_error(fault)
    if training.interrupted:
        words = f"interrupted in pass {len(training.finished) + 1}: what was learned is kept"
        print_error(words)
        return EXIT_INTERRUPTED
    if faults:
        return 1
    return 0 if last.diverged is None else DIVERGED


def _check(arguments: argparse.Namespace) -> None:
    from fuzzyarm.controller.on_plant import LARGEST_RATE
    from fuzzyarm.learning.self_organizing import MOST_PASSES

    if not 1 <= arguments.passes <= MOST_PASSES:
        raise WordError(f"--passes takes 1 to {MOST_PASSES}, not {arguments.passes}")
    if arguments.rate is not None and not 0.0 <= arguments.rate <= LARGEST_RATE:
        raise WordError(f"--rate takes 0 to {LARGEST_RATE:g}, not {arguments.rate:g}")
    if arguments.delay is not None and not 0 <= arguments.delay <= MAX_DELAY:
        raise WordError(f"--delay takes 0 to {MAX_DELAY} periods, not {arguments.delay}")
    if arguments.every is not None and arguments.every < 1:
        raise WordError(f"--every takes at least 1 set point, not {arguments.every}")
    if arguments.freeze and arguments.out:
        raise WordError("--freeze learns nothing, so there is nothing to write with -o")
    if arguments.joint and not arguments.out:
        raise WordError("--joint says which table to write, so it needs -o FILE")
    _check_files(arguments)


def _check_files(arguments: argparse.Namespace) -> None:
    """Tell a mistake in the name of a file before the training."""
    if arguments.out:
        from fuzzyarm.table import SUFFIXES

        require_suffix(arguments.out, SUFFIXES)
    if arguments.plot:
        from fuzzyarm.show.figures.style import require_figure_suffix

        require_figure_suffix(arguments.plot)
    if arguments.animate:
        from fuzzyarm.show.figures.animation import require_animation

        require_animation(arguments.animate)
    demand_places(arguments.out, arguments.plot, arguments.animate)


def _sources(arguments: argparse.Namespace) -> Sources:
    from fuzzyarm.controller import Sources

    table = None
    if arguments.start not in (["zero"], ["table"]):
        table = read_control_table(arguments.start, "--start")
    judge = arguments.performance
    return Sources(table=table, performance=read_performance(judge) if judge else None)


class _Training:
    """A training as the arguments ask for it, and what is printed and written of it."""

    def __init__(self, arguments: argparse.Namespace) -> None:
        from fuzzyarm.controller.catalogue import CATALOGUE, Choice, TextEntry, text_controller
        from fuzzyarm.controller.text import teaching
        from fuzzyarm.learning.self_organizing import Trainee
        from fuzzyarm.plant.plant import with_parameters

        self.arguments = arguments
        self.name = arguments.controller or (
            "soc-table" if arguments.start == ["table"] else "soc-zero"
        )
        entry = CATALOGUE.get(self.name)
        path = entry.file() if isinstance(entry, TextEntry) else self.name
        change = teaching(0.0 if arguments.freeze else arguments.rate, arguments.delay)
        controller = text_controller(path, Choice(sources=_sources(arguments)), change=change)
        plant = plant_of(arguments, [controller])
        gains, parameters = split_settings(overrides(arguments.set), controller, plant)
        plant = with_parameters(plant, parameters) if parameters else plant
        self.along = follows(arguments, plant)
        plant, self.options = equipped_by(arguments, plant)
        connect = connections(arguments)
        self.trainee = Trainee(controller.with_gains(gains), plant, connect, self.name)
        self.count = len(self.trainee.axes)
        self.finished: list[Snapshot] = []
        self.film: list[Snapshot] = []
        self.shown: list[Snapshot] = []
        self.faults: list[str] = []
        self.interrupted = False
        self._latest: Snapshot | None = None
        if arguments.joint is not None and not 1 <= arguments.joint <= self.count:
            raise WordError(f"--joint takes 1 to {self.count}, not {arguments.joint}")

    def run(self) -> None:
        """Train. Ctrl-C, or a plant that fails, ends it: what was learned until then stays."""
        arguments = self.arguments
        try:
            for snapshot in self._snapshots():
                self._latest = snapshot
                if snapshot.complete:
                    self.finished.append(snapshot)
                if arguments.animate:
                    self.film.append(snapshot)
                if arguments.every:
                    self.shown.append(snapshot)
                    if not arguments.json:
                        self.show(snapshot)
        except KeyboardInterrupt:
            if self._latest is None:
                raise
            self.interrupted = True
        except (FuzzyarmError, MemoryError) as error:
            if self._latest is None:
                raise
            self.faults.append(sentence_of(error))

    @property
    def last(self) -> Snapshot:
        """The last pass that came to its end, or what there is of the first."""
        assert self._latest is not None
        return self.finished[-1] if self.finished else self._latest

    def _snapshots(self) -> Iterator[Snapshot]:
        """Train, with a progress bar where a terminal shows it."""
        from fuzzyarm.loop.course import delay_notes

        arguments, options = self.arguments, self.options
        conventions, trainee = conventions_of(arguments), self.trainee
        motion = set_points(arguments, trainee.controller, trainee.plant, conventions)
        for note in delay_notes(options, motion.period):
            print_error(f"note: {note}")
        points = len(motion.time)
        done = 0
        # A bar and grids on one screen would be in each other's way.
        shown = not arguments.every or arguments.json
        with progress_bar("learning", points * arguments.passes, shown=shown) as advance:
            for snapshot in self.trainee.snapshots(
                motion, arguments.passes, self._every(points), conventions, options
            ):
                advance(snapshot.points - done)
                done = snapshot.points
                yield snapshot

    def _every(self, points: int) -> int:
        """Return after how many set points it is looked at a table.

        For a film often enough, and else so that Ctrl-C is heard and it is seen how far it is.
        """
        arguments = self.arguments
        if arguments.every:
            return int(arguments.every)
        if not arguments.animate:
            return max(1, -(-points // LOOKS))
        from fuzzyarm.show.figures.learning import MOST_FRAMES

        return max(1, -(-points * int(arguments.passes) // MOST_FRAMES))

    def draw(self) -> None:
        """Write the figure and the film that were asked for."""
        arguments = self.arguments
        if not (arguments.plot or arguments.animate):
            return
        from fuzzyarm.show.figures import learning
        from fuzzyarm.show.figures.style import save_figure

        names, like = self.trainee.axes, self.trainee.like
        if arguments.plot:
            whole = learning.Training(self.name, self.finished or [self.last], names, like)
            save_figure(learning.learning_figure(whole), arguments.plot)
        if arguments.animate:
            whole = learning.Training(self.name, self.film, names, like)
            frames = min(learning.MOST_FRAMES, len(self.film))
            with progress_bar("drawing", frames) as advance:
                learning.animate_learning(whole, arguments.animate, watch=advance)

    def _print_tables(self, console: Console, learned: Learned, *, with_visits: bool) -> None:
        from fuzzyarm.show.table import learned_view

        start, like = self.trainee.start, self.trainee.like
        pairs = zip(start.tables(like), learned.tables(like), strict=True)
        for joint, (before, after) in enumerate(pairs):
            name, visits = self.trainee.axes[joint], learned.visits[joint]
            console.print(learned_view(before, after, visits, name, with_visits=with_visits))

    def show(self, snapshot: Snapshot) -> None:
        """Print the tables while they grow."""
        from fuzzyarm.learning.self_organizing import error_words
        from fuzzyarm.show.drawing import make_console

        console = make_console()
        console.print(
            f"pass {snapshot.passage} of {self.arguments.passes}, {snapshot.time:.3f} s: "
            f"RMS error {error_words(snapshot)} so far"
        )
        self._print_tables(console, snapshot.learned, with_visits=False)

    def print(self, last: Snapshot) -> None:
        """Print the errors of each pass and the tables at the end."""
        from fuzzyarm.controller.program import AXIS
        from fuzzyarm.learning.self_organizing import error_words
        from fuzzyarm.show.drawing import make_console

        console = make_console()
        out = self.arguments.out
        for snapshot in self.finished:
            console.print(
                f"pass {snapshot.passage}: RMS error {error_words(snapshot)}"
                + (", learning off" if self.arguments.freeze else "")
            )
        if last.diverged is not None:
            console.print(
                f"diverged: the training was stopped at {last.diverged:.3f} s of that pass"
            )
        console.print()
        self._print_tables(console, last.learned, with_visits=True)
        if out:
            inputs = ", ".join((AXIS, *(axis.name for axis in last.learned.axes)))
            single = self.arguments.joint or self.count == 1
            both = "" if single else f", all axes in one table over {inputs}"
            console.print(f"{out}: written{both}", soft_wrap=True)

    def write(self, last: Snapshot, path: str) -> None:
        """Write the table of one joint, or one over both."""
        from fuzzyarm.table import write_table

        table = self.trainee.table(last.learned, self._provenance(last), self.arguments.joint)
        write_table(table, path)

    def _provenance(self, last: Snapshot) -> dict[str, str]:
        arguments = self.arguments
        start = " ".join(Path(word).name for word in arguments.start)
        pairs = self.trainee.provenance(
            self._words(),
            last.passage if last.complete else f"a part of 1, {last.time:.4g} s",
            "" if arguments.controller and start == "zero" else start,
            Path(arguments.performance).name if arguments.performance else "",
            arguments.conventions,
        )
        if arguments.controller:
            pairs["controller"] = Path(arguments.controller).name
        if arguments.set:
            pairs["gains"] = " ".join(arguments.set)
        if arguments.joint:
            pairs["joint"] = str(arguments.joint)
        if arguments.date:
            pairs["date"] = datetime.now(UTC).date().isoformat()
        return pairs

    def _words(self) -> str:
        """Say along what it was trained."""
        arguments = self.arguments
        if self.along:
            return _trajectory_words(arguments)
        from fuzzyarm.learning.self_organizing import reference_words

        plant = Path(arguments.plant).name
        return reference_words(plant, arguments.reference, arguments.step or 1.0)

    def data(self, snapshot: Snapshot) -> dict[str, Any]:
        """Return the state of a training as JSON data."""
        from fuzzyarm.learning.self_organizing import state_of

        return {
            "pass": snapshot.passage,
            "time": snapshot.time,
            "rms": [float(each) for each in snapshot.rms],
            "complete": snapshot.complete,
            "diverged": snapshot.diverged,
            "joints": state_of(snapshot, self.trainee.start),
        }


def _trajectory_words(arguments: argparse.Namespace) -> str:
    from fuzzyarm.learning.self_organizing import trajectory_words

    name, details = arguments.trajectory, []
    if arguments.way_points:
        name, details = "way points", arguments.way_points
    elif arguments.angles is not None:
        details.append("to {:g}° and {:g}°".format(*arguments.angles))
    if arguments.segment is not None:
        details = [*details, f"in {arguments.segment:g} s"]
    loaded = arguments.loaded or ()
    return trajectory_words(name, payload=arguments.payload, loaded=loaded, details=details)


COMMANDS = (
    command(
        "learn",
        __doc__,
        _run,
        argument(
            "controller CONTROLLER",
            "a name or FILE.frb with a table that learns; soc-zero by default",
            nargs="?",
        ),
        argument(
            "--start WORD",
            "zero (default), table (the shipped one), FILE, or a FILE for each joint",
            nargs="+",
            default=["zero"],
        ),
        argument(
            "--performance WORD",
            "FILE, or yamazaki or procyk-mamdani, which are shipped; by default as the text says",
        ),
        *TRAJECTORY,
        *PLANT,
        *group(
            "training",
            argument("--passes N", "repeat the trajectory", type=int, default=1),
            argument("--rate R", "learning rate, 0 to 10", type=float),
            argument("--delay N", "control steps from a cell's use to its judgement", type=int),
            flag("--freeze", "run with the table as it is"),
            SET,
            *CONVENTIONS,
        ),
        *group(
            "output",
            out("FILE", ".lut, .csv, .json or .npz", required=False),
            argument("--joint N", "write the table of one joint, or axis, alone", type=int),
            flag("--date", "write the date into the file"),
            argument("--every N", "show the tables after every N set points", type=int),
            argument("--plot FIG", "draw tables, visits and the error of each pass"),
            argument("--animate FILE", "write the tables while they grow: .gif, .html or .mp4"),
            JSON,
        ),
    ),
)
