"""Train self-organizing control (SOC) on the arm or on any plant, see its tables grow, save them.

The table starts at zero, at the shipped table (--start table) or at your own file. At
every control step the performance table judges the error and its rate and corrects the
responsible cell. Prints for each joint the learned table, with changed cells
in brackets, and how often each cell was used.

-o FILE writes one table of both joints, with the input 'joint'; with --joint N that of one
joint. fuzzy-lut-x10, whose error gain is that of SOC, runs either. Learn a table for
freezing at a small rate: at rate 1 it jumps to the end. Exit status 3 if the last pass
diverged.

Examples
--------
  fuzzyarm learn --trajectory pick-and-place --payload --rate 0.01 --passes 5 -o learned.lut
  fuzzyarm diff before.lut learned.lut
  fuzzyarm simulate fuzzy-lut-x10 --table learned.lut --trajectory pick-and-place --payload
  fuzzyarm learn --start learned.lut --freeze --payload
  fuzzyarm learn servo-soc.frb --plant motor --passes 6 -o learned.lut
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.cli.arguments import request_command, with_choice
from fuzzyarm.apps.cli.command import (
    DIVERGED,
    EXIT_INTERRUPTED,
    FORCE,
    UsageError,
    attempted,
    demand_figure,
    demand_places,
    group,
    print_error,
    print_json,
    progress_bar,
    require_suffix,
    saved,
)
from fuzzyarm.base.errors import FuzzyarmError, sentence_of
from fuzzyarm.base.jsonable import entry, json_properties
from fuzzyarm.requests.fields import Limits, Request, option
from fuzzyarm.requests.learn import OUTPUT, LearnRequest

if TYPE_CHECKING:
    from rich.console import Console

    from fuzzyarm.control.controllers.on_plant import LearnedTables
    from fuzzyarm.learning.self_organizing import Snapshot, TableState


@dataclass(frozen=True, kw_only=True)
class _Output(Request):
    """Output of a training."""

    out: str | None = option("-o --out FILE", ".lut, .csv, .json or .npz", None, group=OUTPUT)
    date: bool = option("--date", "write the date into the file", False, group=OUTPUT)
    every: int | None = option(
        "--every N", "show the tables after every N set points", None, Limits(1), group=OUTPUT
    )
    plot: str | None = option(
        "--plot FIG", "draw tables, visits and the error of each pass", None, group=OUTPUT
    )
    animate: str | None = option(
        "--animate FILE", "write the tables while they grow: .gif, .html or .mp4", None,
        group=OUTPUT,
    )  # fmt: skip
    json: bool = option("--json", "print the result as JSON", False, group=OUTPUT)


@dataclass(frozen=True, kw_only=True)
class LearnWords(LearnRequest, _Output):
    """All arguments of ``fuzzyarm learn``."""


LOOKS = 20
"""Parts of a pass, for progress and Ctrl-C."""


def _run(request: LearnWords) -> int:
    _check(request)
    training = _Watched(request)
    training.run()
    start, last = training.trainee.start, training.last
    faults = list(training.faults)
    out = request.out
    if out:
        out, fault = saved(out, lambda path: training.write(last, path))
        faults += [fault] if fault else []
    if request.json:
        levels = {axis.name: axis.levels for axis in start.axes}
        report = Learned(
            [training.moment(snapshot) for snapshot in training.finished],
            levels,
            last.learned.values,
            last.learned.visits,
            out,
            [training.moment(snapshot) for snapshot in training.shown] if request.every else None,
        )
        print_json(report, 1)
    else:
        training.print(last, out)
    faults += attempted(training.draw)
    for fault in faults:
        print_error(fault)
    if training.interrupted:
        words = f"interrupted in pass {len(training.finished) + 1}: the learned tables are kept"
        print_error(words)
        return EXIT_INTERRUPTED
    if faults:
        return 1
    return 0 if last.diverged is None else DIVERGED


def _check(request: LearnWords) -> None:
    """Report mistakes before anything is loaded."""
    if request.freeze and request.out:
        raise UsageError("--freeze learns nothing, so there is nothing to write with -o")
    if request.joint and not request.out:
        raise UsageError("--joint selects the table to write, so it needs -o FILE")
    if request.out:
        from fuzzyarm.table import SUFFIXES

        require_suffix(request.out, SUFFIXES)
    demand_figure(request.plot)
    if request.animate:
        from fuzzyarm.apps.show.figures.animation import require_animation

        require_animation(request.animate)
    demand_places(request.out, request.animate)


@json_properties(
    "pass=snapshot.passage time=snapshot.time rms=snapshot.rms complete=snapshot.complete"
    " diverged=snapshot.diverged joints"
)
@dataclass(frozen=True)
class Moment:
    """A training at some moment."""

    snapshot: Snapshot
    joints: list[TableState] = entry("by axis")


@json_properties("* snapshots?")
@dataclass(frozen=True)
class Learned:
    """Report on a training."""

    passes: list[Moment] = entry("those that came to their end")
    levels: Mapping[str, Sequence[float]] = entry("levels of each input, in rising order")
    tables: Any = entry("values of each axis, a row for each level of the first input")
    visits: Any = entry("how often each cell was used, in the same order")
    file: str | None = entry("the written file; null without -o")
    snapshots: list[Moment] | None = entry(
        "with --every: the states shown on the way", default=None
    )


class _Watched:
    """A training on request, with its output."""

    def __init__(self, request: LearnWords) -> None:
        from fuzzyarm.learning.training import Training

        self.request = request
        self.training = Training.of(request)
        self.name, self.trainee = self.training.name, self.training.trainee
        self.finished: list[Snapshot] = []
        self.film: list[Snapshot] = []
        self.shown: list[Snapshot] = []
        self.faults: list[str] = []
        self.interrupted = False
        self._latest: Snapshot | None = None

    def run(self) -> None:
        """Train until the end, Ctrl-C or a failing plant; keep the tables learned until then."""
        request = self.request
        try:
            for snapshot in self._snapshots():
                self._latest = snapshot
                if snapshot.complete:
                    self.finished.append(snapshot)
                if request.animate:
                    self.film.append(snapshot)
                if request.every:
                    self.shown.append(snapshot)
                    if not request.json:
                        self.show(snapshot)
        except KeyboardInterrupt:
            # Nothing was learned yet.
            if self._latest is None:
                raise
            self.interrupted = True
        except (FuzzyarmError, MemoryError) as error:
            if self._latest is None:
                raise
            self.faults.append(sentence_of(error))

    @property
    def last(self) -> Snapshot:
        """The last finished pass, or the first one in progress."""
        assert self._latest is not None
        return self.finished[-1] if self.finished else self._latest

    def _snapshots(self) -> Iterator[Snapshot]:
        """Train, with a progress bar on a terminal."""
        from fuzzyarm.control.loop.course import delay_notes

        request, motion = self.request, self.training.motion
        for note in delay_notes(self.training.options, motion.period):
            print_error(f"note: {note}")
        points = len(motion.time)
        done = 0
        # A bar and grids would overwrite each other.
        shown = not request.every or request.json
        with progress_bar("learning", points * request.passes, shown=shown) as advance:
            for snapshot in self.training.snapshots(self._every(points)):
                advance(snapshot.points - done)
                done = snapshot.points
                yield snapshot

    def _every(self, points: int) -> int:
        """Return the number of set points between two looks at a table, for a film or Ctrl-C."""
        request = self.request
        if request.every:
            return request.every
        if not request.animate:
            return max(1, -(-points // LOOKS))
        from fuzzyarm.apps.show.figures.learning import MOST_FRAMES

        return max(1, -(-points * request.passes // MOST_FRAMES))

    def draw(self) -> None:
        """Write the requested figure and film."""
        request = self.request
        if not (request.plot or request.animate):
            return
        from fuzzyarm.apps.show.figures import learning
        from fuzzyarm.base.figure_files import save_figure

        names, like = self.trainee.axes, self.trainee.like
        if request.plot:
            whole = learning.LearningHistory(self.name, self.finished or [self.last], names, like)
            save_figure(learning.learning_figure(whole), request.plot)
        if request.animate:
            whole = learning.LearningHistory(self.name, self.film, names, like)
            frames = min(learning.MOST_FRAMES, len(self.film))
            with progress_bar("drawing", frames) as advance:
                learning.animate_learning(whole, request.animate, watch=advance)

    def _print_tables(self, console: Console, learned: LearnedTables, *, with_visits: bool) -> None:
        from fuzzyarm.apps.show.table import learned_view

        start, like = self.trainee.start, self.trainee.like
        pairs = zip(start.tables(like), learned.tables(like), strict=True)
        for joint, (before, after) in enumerate(pairs):
            name, visits = self.trainee.axes[joint], learned.visits[joint]
            console.print(learned_view(before, after, visits, name, with_visits=with_visits))

    def show(self, snapshot: Snapshot) -> None:
        """Print the growing tables."""
        from fuzzyarm.apps.show.drawing import make_console
        from fuzzyarm.learning.self_organizing import error_words

        console = make_console()
        console.print(
            f"pass {snapshot.passage} of {self.request.passes}, {snapshot.time:.3f} s: "
            f"RMS error {error_words(snapshot)} so far"
        )
        self._print_tables(console, snapshot.learned, with_visits=False)

    def print(self, last: Snapshot, out: str | None) -> None:
        """Print the errors of each pass and the final tables."""
        from fuzzyarm.apps.show.drawing import make_console
        from fuzzyarm.control.controllers.code import AXIS
        from fuzzyarm.learning.self_organizing import error_words

        console = make_console()
        for snapshot in self.finished:
            console.print(
                f"pass {snapshot.passage}: RMS error {error_words(snapshot)}"
                + (", learning off" if self.request.freeze else "")
            )
        if last.diverged is not None:
            console.print(
                f"diverged: the training was stopped at {last.diverged:.3f} s of that pass"
            )
        console.print()
        self._print_tables(console, last.learned, with_visits=True)
        if out:
            inputs = ", ".join((AXIS, *(axis.name for axis in last.learned.axes)))
            single = self.request.joint or len(self.trainee.axes) == 1
            both = "" if single else f", all axes in one table over {inputs}"
            console.print(f"{out}: written{both}", soft_wrap=True)

    def write(self, last: Snapshot, path: str) -> None:
        """Write the table of one joint, or of both."""
        from fuzzyarm.table import write_table

        provenance = self.training.provenance(last, dated=self.request.date)
        write_table(self.trainee.table(last.learned, provenance, self.request.joint), path)

    def moment(self, snapshot: Snapshot) -> Moment:
        """Return the state of a training for JSON."""
        from fuzzyarm.learning.self_organizing import state_of

        return Moment(snapshot, state_of(snapshot, self.trainee.start))


COMMANDS = (
    request_command("learn", with_choice(__doc__), _run, LearnWords, *group("output", FORCE)),
)
