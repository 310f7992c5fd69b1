"""Tune the gains of a controller and the terms of its rule bases, or a rule base on samples.

The file chooses the free numbers: a tune block in a rule base, tune LOW .. HIGH after a gain,
or --tune lines instead. By default all peaks move, and even spacing stays even. Every candidate
keeps the expect and prove lines, except claims about the loop: prove those of the result.

--cost is a formula of metrics, such as "rms + 0.002*variation" (rms, max, overshoot, settling,
iae, effort, variation, chatter, …), or FILE.py:FUNCTION. A plant with trajectories, such as the
arm, follows the ones for comparing controllers, with its load, unless another or a reference is
given; --scenarios N adds random moves, loads and seeds. A rule base alone is fitted to samples:
--data set.csv.

The table shows the cost in the tuning scenarios, in unseen ones, and in these with sensor
noise, beside a linear controller tuned on the same. -o writes the file with new numbers and its
comments; its rule bases in other files go beside it. Ctrl-C keeps the best so far (exit
status 130); with --journal, --resume goes on.

Examples
--------
  fuzzyarm tune rulebases/heater.frb --reference temperature=20 --cost "rms + overshoot" -o h.frb
  fuzzyarm tune fuzzy-direct --cost "rms + 0.002*chatter" --scenarios 8 --evals 2000 -o mine.frb
  fuzzyarm tune stfc.frb --method cma-es --time 10min --plot tuned.png -o stfc.frb
  fuzzyarm tune model.frb --data set.csv --test later.csv -o model.frb
  fuzzyarm tune servo.frb --plant motor --vary J=0.005..0.03 --scenarios 12 --over worst
"""

from __future__ import annotations

import argparse
import math
import os
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from fuzzyarm.apps.cli.arguments import request_command, with_choice
from fuzzyarm.apps.cli.command import (
    DIVERGED,
    EXIT_INTERRUPTED,
    FORCE,
    TOLD_EVERY,
    Pace,
    announced,
    attempted,
    demand_figure,
    demand_places,
    duration_words,
    group,
    print_error,
    print_json,
    require_suffix,
    saved,
    say,
)
from fuzzyarm.base.errors import sentence_of
from fuzzyarm.base.files import same_file, stamp_of
from fuzzyarm.base.numbers import counted
from fuzzyarm.requests.fields import Request, option
from fuzzyarm.requests.tune import TuneRequest

if TYPE_CHECKING:
    from fuzzyarm.learning.tuning.result import Tuned
    from fuzzyarm.learning.tuning.search import Found


@dataclass(frozen=True, kw_only=True)
class _Output(Request):
    """Output of tuning."""

    plot: str | None = option(
        "--plot FIG", "draw cost, front and table: .png, .svg or .pdf", None, idle=True,
        group="output",
    )  # fmt: skip
    json: bool = option("--json", "print the report as JSON", False, idle=True, group="output")


@dataclass(frozen=True, kw_only=True)
class TuneWords(TuneRequest, _Output):
    """All arguments of ``fuzzyarm tune``."""


def _run(request: TuneWords) -> int:
    _require_sensible(request)
    from fuzzyarm.control.loop.sweeps import cluster
    from fuzzyarm.learning.tuning.orders import order_of
    from fuzzyarm.learning.tuning.tune import keywords_of, tune

    order = order_of(request)
    path = order.path
    result = _Result(request.out)
    with (
        announced(f"tuning {path}, {_most(request)}"),
        cluster(request) as (executor, workers),
        _shown(request.evals, _own_seconds(request)) as progress,
    ):
        keywords = keywords_of(request, order)
        keywords.update({"workers": workers, "executor": executor, "take": result.take})
        keywords.update({"watch": progress.search, "watch_linear": progress.linear})
        keywords["tell"] = progress.tell
        tuned = tune(path, **keywords)
    result.take(tuned)
    if request.json:
        files = [os.fspath(file) for file in result.files]
        print_json({**tuned.to_dict(), "files": files})
    else:
        say(*_lines(tuned, path, result.files))
    if request.out is None:
        print_error("note: no file was written; -o FILE keeps the tuned numbers")
    faults = [*result.faults, *tuned.faults]
    plot = request.plot
    if plot:
        faults += attempted(lambda: _draw(tuned, path, plot))
    for fault in faults:
        print_error(fault)
    if tuned.found.unwritten:
        print_error(f"{tuned.found.unwritten}; the last trials are not in the journal")
    if tuned.found.interrupted:
        resumption = f"; {request.journal} has all, --resume goes on" if request.journal else ""
        print_error(f"interrupted: the best so far is kept{resumption}")
        return EXIT_INTERRUPTED
    if faults or tuned.found.unwritten:
        return 1
    if tuned.found.best.score.diverged:
        print_error(
            "runs with the best numbers diverge: there is no cost to compare (try `simulate`)"
        )
        return DIVERGED
    return 0


class _Result:
    """The tuned file on disk: written after the search, then again with its evaluation."""

    def __init__(self, out: str | None) -> None:
        self.out = out
        self.stamp = stamp_of(out) if out else None
        self.files: list[Path] = []
        self.faults: list[str] = []

    def take(self, tuned: Tuned) -> None:
        """Write it; on failure, elsewhere."""
        if not self.out:
            return
        if self.files:
            self._again(tuned)
        elif stamp_of(self.out) != self.stamp:  # edited in the meantime
            other = str(Path(self.out).with_name(f"{Path(self.out).stem}-tuned.frb"))
            self.faults.append(f"{self.out} has changed since; it is left, and {other} written")
            self._first(tuned, other)
        else:
            self._first(tuned, self.out)
        self.stamp = stamp_of(self.files[0]) if self.files else self.stamp

    def _first(self, tuned: Tuned, path: str) -> None:
        def write(place: str) -> None:
            self.files = tuned.write(place)

        fault = saved(path, write).fault
        self.faults += [fault] if fault else []

    def _again(self, tuned: Tuned) -> None:
        if stamp_of(self.files[0]) != self.stamp:
            self.faults.append(
                f"{self.files[0]} has changed since it was written; it is left unchanged"
            )
            return
        try:
            self.files = tuned.write(self.files[0])
        except OSError as error:
            words = "it has the numbers, without their evaluation"
            self.faults.append(f"{sentence_of(error)}; {words}")


def _draw(tuned: Tuned, path: str, plot: str) -> None:
    from fuzzyarm.apps.show.figures import save_figure
    from fuzzyarm.apps.show.figures.tuning import tuning_figure

    save_figure(tuning_figure(tuned, f"{Path(path).name}: {tuned.cost}"), plot)


def _require_sensible(request: TuneWords) -> None:
    """Report mistakes before anything runs."""
    from fuzzyarm.learning.tuning.orders import require_sensible

    if request.out:
        require_suffix(request.out, (".frb",))
    demand_figure(request.plot)
    demand_places(request.out)
    require_sensible(request)


# --- Progress ---

REDRAWN_EVERY = 0.2
"""Seconds between drawings of the curve."""


def _own_seconds(request: TuneWords) -> float:
    """Return the time limit of the first search: its share if others follow."""
    from fuzzyarm.learning.tuning.orders import longest
    from fuzzyarm.learning.tuning.result import TuningPlan
    from fuzzyarm.learning.tuning.search import Budget

    plan = TuningPlan(budget=Budget(seconds=longest(request)))
    on_samples = bool(request.data)  # judged on other samples, and against a regression
    judged, linear = on_samples or request.unseen > 0, not on_samples and request.linear
    return plan.shared(judged=judged, linear=linear).seconds


def _most(request: TuneWords) -> str:
    """Return the limits of the searches in words."""
    from fuzzyarm.learning.tuning.orders import longest

    words = f"up to {counted(request.evals, 'trial')}"
    seconds = longest(request)
    return f"{words} and {duration_words(seconds)}" if seconds < math.inf else words


class _Progress:
    """Progress lines at intervals: of a search within its limits, then of the opponent's."""

    def __init__(
        self,
        evals: int,
        say: Callable[[Found | None, str], None],
        every: float,
        seconds: float = math.inf,
    ) -> None:
        self.evals, self.say, self.every = evals, say, every
        self.pace = Pace(evals, seconds)
        self.last_report = time.monotonic()

    def search(self, result: Found) -> None:
        """Report progress of the search."""
        has_rate = self.pace.rate(len(result.trials)) is not None
        if self._is_time():
            left = (
                [f"{duration_words(self.pace.left(len(result.trials)))} left"] if has_rate else []
            )
            self.say(result, ", ".join([*self._state(result), *left]))

    def linear(self, result: Found) -> None:
        """Report progress of the search for the linear opponent."""
        if self._is_time():
            state = f"{counted(len(result.trials), 'trial')}, best {result.best.score.cost:.5g}"
            self.say(result, f"the linear controller, tuned on the same: {state}")

    def tell(self, words: str) -> None:
        """Report progress after the searches."""
        if self._is_time():
            self.say(None, words)

    def _is_time(self) -> bool:
        now = time.monotonic()
        if now - self.last_report < self.every:
            return False
        self.last_report = now
        return True

    def _state(self, result: Found) -> Iterator[str]:
        yield f"{len(result.trials)} of {self.evals} trials"
        if result.refused:
            yield f"{result.refused} refused"
        if result.failed:
            yield f"{result.failed} failed"
        yield f"best {result.best.score.cost:.5g}"


@contextmanager
def _shown(evals: int, seconds: float) -> Iterator[_Progress]:
    """Show trials, the best cost and its curve on stderr; yield the progress reporter."""
    if not sys.stderr.isatty():
        yield _Progress(evals, lambda _result, state: print_error(state), TOLD_EVERY, seconds)
        return
    from rich.console import Console
    from rich.live import Live
    from rich.text import Text

    from fuzzyarm.apps.show.tuning import search_view

    console = Console(stderr=True)
    with Live(console=console, transient=True, auto_refresh=False) as live:

        def draw(result: Found | None, state: str) -> None:
            view = Text(state) if result is None else search_view(result, state, console.width)
            live.update(view, refresh=True)

        draw(None, "the file as it is")
        yield _Progress(evals, draw, REDRAWN_EVERY, seconds)


# --- Results ---


def _lines(tuned: Tuned, path: str, written: list[Path]) -> Iterator[str]:
    from fuzzyarm.apps.show import plain_text
    from fuzzyarm.apps.show.tuning import (
        change_lines,
        curve_view,
        front_lines,
        table_lines,
    )

    search = tuned.found
    on = counted(len(tuned.scenarios), "scenario")
    yield (
        f"{Path(path).name}: {tuned.cost}, {tuned.over} of {on};"
        f" {counted(len(tuned.parameters), 'number')} moved, {counted(len(search.trials), 'trial')}"
        f" in {duration_words(search.seconds)}"
    )
    yield from (f"  {line}" for line in table_lines(tuned))
    yield from tuned.claim().split("; ")
    if len(search.trials) > 1:
        columns = shutil.get_terminal_size().columns if sys.stdout.isatty() else 80
        yield from plain_text(curve_view(search, columns)).splitlines()
    front = list(front_lines(tuned))
    if front:
        yield from ("front of error and chatter:", *(f"  {line}" for line in front))
    yield from tuned.remarks()
    yield from change_lines(tuned)
    if written:
        yield f"wrote {', '.join(map(os.fspath, written))}"


def _is_in_place(arguments: argparse.Namespace) -> bool:
    return arguments.out is not None and same_file(arguments.file, arguments.out)


COMMANDS = (
    request_command(
        "tune", with_choice(__doc__), _run, TuneWords, *group("output", FORCE)
    )._replace(rewrites=_is_in_place),
)
