"""Tune the gains of a controller and the terms of its rule bases, or a rule base on samples.

What may move is said in the file: a tune block in a rule base, tune LOW .. HIGH behind a gain,
or lines of --tune instead. Where nothing is said, all peaks move and what is even stays even.
expect and prove lines are kept by every candidate.

--cost is a formula of metrics, such as "rms + 0.002*variation" (rms, max, overshoot, settling,
iae, effort, variation, chatter, …), or FILE.py:FUNCTION. A plant with trajectories, as the arm,
follows those by which it has controllers compared, with its load, unless one is named or
references are given; --scenarios N adds drawn moves, loads and seeds. A rule base alone is
fitted to samples: --data set.csv.

The table shows the cost on what was tuned on, on unseen scenarios, and on these with noise of
the sensors, beside a linear controller tuned on the same. -o writes the file with new numbers,
comments kept; rule bases of their own files go beside it. Ctrl-C keeps the best so far (exit
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
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.command import (
    EXIT_INTERRUPTED,
    TOLD_EVERY,
    Argument,
    Pace,
    WordError,
    announced,
    argument,
    attempted,
    command,
    counted,
    demand_places,
    duration_words,
    flag,
    group,
    json_of,
    print_error,
    print_json,
    require_suffix,
    saved,
    say,
)
from fuzzyarm.cli.experiment import (
    CONVENTIONS,
    DIVERGED,
    TRAJECTORY,
    conventions_of,
    trajectory_of_words,
)
from fuzzyarm.cli.plants import (
    ALONG,
    MOTORS,
    PLANT,
    connections,
    equipped_by,
    follows,
    motion_of,
    option_given,
    plant_of,
)
from fuzzyarm.cli.sweep import cluster
from fuzzyarm.errors import sentence_of
from fuzzyarm.text.files import stamp_of

if TYPE_CHECKING:
    from fuzzyarm.controller.text import ControllerText
    from fuzzyarm.learning.data import Samples
    from fuzzyarm.model.rulebase import RuleBase
    from fuzzyarm.plant import Trajectory
    from fuzzyarm.tuning.scenarios import Stage
    from fuzzyarm.tuning.search import Found
    from fuzzyarm.tuning.tuned import Tuned


def _run(arguments: argparse.Namespace) -> int:
    _require_sensible(arguments)
    from fuzzyarm.controller.text import ControllerText
    from fuzzyarm.tuning.tune import tune

    path, subject = _subject(arguments.file)
    given: dict[str, Any] = {
        "cost": arguments.cost,
        "tuning": arguments.tune or None,
        "method": arguments.method,
        "evals": arguments.evals,
        "seconds": _seconds(arguments),
        "seed": arguments.seed,
        "digits": arguments.digits,
        "unseen": arguments.unseen,
        "linear": not arguments.no_linear,
        "over": arguments.over,
    }
    if isinstance(subject, ControllerText):
        if arguments.data:
            raise WordError("--data is for a rule base alone; a controller runs in its loop")
        given |= {"stage": _stage(arguments, subject), "scenarios": arguments.scenarios}
        given["conventions"] = conventions_of(arguments)
    else:
        given |= _samples(arguments, subject)
    given["journal"] = _journal(arguments, path)
    result = _Result(arguments.out)
    with (
        announced(f"tuning {path}, {_most(arguments)}"),
        cluster(arguments) as (executor, workers),
        _shown(arguments.evals, _own_seconds(arguments)) as progress,
    ):
        given |= {"watch": progress.search, "watch_linear": progress.linear}
        given |= {"take": result.take, "tell": progress.tell}
        tuned = tune(path, **given, workers=workers, executor=executor)
    result.take(tuned)
    if arguments.json:
        files = [os.fspath(file) for file in result.files]
        print_json({**tuned.as_data(), "files": files})
    else:
        say(*_lines(tuned, path, result.files))
    faults = [*result.faults, *tuned.faults]
    if arguments.plot:
        faults += attempted(lambda: _draw(tuned, path, arguments.plot))
    for fault in faults:
        print_error(fault)
    if tuned.found.unwritten:
        print_error(f"{tuned.found.unwritten}; the last trials are not in the journal")
    if tuned.found.interrupted:
        kept = f"; {arguments.journal} has all, --resume goes on" if arguments.journal else ""
        print_error(f"interrupted: the best so far is kept{kept}")
        return EXIT_INTERRUPTED
    if faults or tuned.found.unwritten:
        return 1
    if tuned.found.best.score.diverged:
        print_error(
            "runs with the best numbers diverge: there is nothing to go by (try `simulate`)"
        )
        return DIVERGED
    return 0


class _Result:
    """The tuned file on the disk: written when it is found, and again with what it is worth.

    Parameters
    ----------
    out : str or None
        Where to; nothing is written without.
    """

    def __init__(self, out: str | None) -> None:
        self.out = out
        self.stamp = stamp_of(out) if out else None
        self.files: list[Path] = []
        self.faults: list[str] = []

    def take(self, tuned: Tuned) -> None:
        """Write it; where that fails, somewhere else."""
        if not self.out:
            return
        if self.files:
            self._again(tuned)
        elif stamp_of(self.out) != self.stamp:  # somebody has worked on it meanwhile
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
            self.faults.append(f"{self.files[0]} has changed since it was written; it is left so")
            return
        try:
            self.files = tuned.write(self.files[0])
        except OSError as error:
            words = "the numbers are in it, not what they are worth"
            self.faults.append(f"{sentence_of(error)}; {words}")


def _draw(tuned: Tuned, path: str, plot: str) -> None:
    from fuzzyarm.show.figures import save_figure
    from fuzzyarm.show.figures.tuning import tuning_figure

    save_figure(tuning_figure(tuned, f"{Path(path).name}: {tuned.cost}"), plot)


def _require_sensible(arguments: argparse.Namespace) -> None:
    """Tell mistakes before anything runs."""
    if arguments.out:
        require_suffix(arguments.out, (".frb",))
    if arguments.plot:
        from fuzzyarm.show.figures.style import require_figure_suffix

        require_figure_suffix(arguments.plot)
    demand_places(arguments.out, arguments.plot)
    if arguments.resume and not arguments.journal:
        raise WordError("--resume goes on with the file of --journal, and none is given")
    if arguments.workers is not None and not 1 <= arguments.workers <= 10_000:
        raise WordError(f"--workers {arguments.workers} is out of range: 1 to 10000")
    if arguments.test and not arguments.data:
        raise WordError("--test judges what was fitted to --data, and none is given")


def _seconds(arguments: argparse.Namespace) -> float:
    from fuzzyarm.cli.plants import time_of

    return time_of(arguments.time, "--time") if arguments.time else math.inf


def _subject(word: str) -> tuple[str, ControllerText | RuleBase]:
    """Return a file and what it holds; a name of the catalogue is a shipped file."""
    from fuzzyarm.api import load
    from fuzzyarm.controller.text import ControllerText
    from fuzzyarm.model.rulebase import RuleBase
    from fuzzyarm.shipped_files import shipped, shipped_names

    path = word
    if not Path(word).exists() and f"{word}.frb" in shipped_names():
        path = str(shipped(f"{word}.frb"))
    model = load(path)
    if not isinstance(model, ControllerText | RuleBase):
        raise WordError(f"{word} is a table; a controller or a rule base is tuned")
    return path, model


# --- What it is tuned on ---


def _stage(arguments: argparse.Namespace, text: ControllerText) -> Stage:
    from fuzzyarm.controller.catalogue import controller_of
    from fuzzyarm.loop.sweep import read_range
    from fuzzyarm.plant.plant import interface_of
    from fuzzyarm.tuning.scenarios import Scenario, Stage, plant_scenarios, scenario_along

    plant = plant_of(arguments, [controller_of(text)])
    along = follows(arguments, plant, None)
    plant, options = equipped_by(arguments, plant)
    connect = connections(arguments)
    vary = tuple(map(read_range, arguments.vary))
    if along:
        payload = 0.0 if arguments.payload is False else 1.0
        first = plant_scenarios(plant, payload)
        if option_given(arguments, (*ALONG, "loaded")):
            way = _loaded(trajectory_of_words(arguments, plant), arguments.loaded)
            first = (scenario_along(plant, way, payload),)
        return Stage(plant, first, options, vary, connect=connect)
    motion = motion_of(arguments, controller_of(text), plant)
    label = interface_of(plant).label(motion.tracked[0])
    references, duration = _references(arguments, label), _duration(arguments)
    first = (Scenario(motion.name, motion),)
    return Stage(plant, first, options, vary, references, duration, connect)


def _loaded(way: Trajectory, segments: Sequence[int] | None) -> Trajectory:
    """Return a trajectory that has the load in some of its segments, where they are named."""
    from fuzzyarm.plant.trajectory import carried

    return way if segments is None else replace(way, loaded=carried(way, segments=segments))


def _references(arguments: argparse.Namespace, label: str) -> dict[str, Any] | None:
    """Return the references that were given, by port, for scenarios to scale."""
    from fuzzyarm.loop import Signal
    from fuzzyarm.loop.words import PlantWords

    if arguments.step is not None:
        return {label: Signal("step", (arguments.step,))}
    return PlantWords.of(arguments).signals() or None


def _duration(arguments: argparse.Namespace) -> float | None:
    from fuzzyarm.cli.plants import time_of

    return time_of(arguments.duration, "--for") if arguments.duration is not None else None


def _samples(arguments: argparse.Namespace, rulebase: RuleBase) -> dict[str, Any]:
    from fuzzyarm.learning.data import Columns, read_samples

    if not arguments.data:
        if arguments.cost is not None and ".py:" in arguments.cost:
            return {}
        message = f"'{rulebase.name}' is a rule base alone: nothing says what is good"
        hint = "--data set.csv, or tune the controller that uses it"
        raise WordError(message, hint=hint)
    inputs = tuple(variable.name for variable in rulebase.inputs)
    outputs = [output.name for output in rulebase.outputs]
    target = arguments.target
    if target is None and len(outputs) == 1 and outputs[0] in _columns(arguments.data):
        target = outputs[0]
    columns = Columns(target, inputs)
    found: dict[str, Samples] = {"data": read_samples(arguments.data, columns)}
    if arguments.test:
        found["test"] = read_samples(arguments.test, columns)
    return found


def _columns(path: str) -> tuple[str, ...]:
    from fuzzyarm.learning.data import column_names

    return column_names(path)


# --- The journal ---

NOT_ASKED = (
    "out", "resume", "journal", "workers", "dask", "plot", "json", "evals", "time", "digits",
    "unseen", "no_linear", "test",
)  # fmt: skip
"""Arguments on which no trial depends."""


def _journal(arguments: argparse.Namespace, path: str) -> Any:
    if not arguments.journal:
        return None
    from fuzzyarm.tuning.search import Journal
    from fuzzyarm.version import __version__

    words = {
        name: value
        for name, value in vars(arguments).items()
        if name not in NOT_ASKED and not callable(value) and value not in (None, [], False, "")
    }
    question = {"fuzzyarm": __version__, "arguments": words, "files": _digests(arguments, path)}
    return Journal(arguments.journal, question, resume=arguments.resume)


def _digests(arguments: argparse.Namespace, path: str) -> dict[str, str]:
    """Return digests of the files that trials depend on, by name."""
    from fuzzyarm.controller.text import sheet_path
    from fuzzyarm.language.reading import parse, read_text

    paths = {Path(path).name: Path(path)}
    controller = parse(read_text(path), path).controller
    for use in controller.uses if controller is not None else ():
        paths |= {file: sheet_path(file, Path(path).parent) for file in use.files}
    words = [
        arguments.data,
        arguments.plant,
        *(word.partition("=")[2] for word in arguments.reference),
    ]
    words += [(arguments.cost or "").rpartition(":")[0], (arguments.plant or "").rpartition(":")[0]]
    paths |= {word: Path(word) for word in words if word}
    return {
        name: sha256(each.read_bytes()).hexdigest()[:16]
        for name, each in sorted(paths.items())
        if each.is_file()
    }


# --- While it runs ---

REDRAWN_EVERY = 0.2
"""Where it is one, s."""


def _own_seconds(arguments: argparse.Namespace) -> float:
    """Return the seconds of the first search: its share where others follow."""
    from fuzzyarm.tuning.search import Budget
    from fuzzyarm.tuning.tuned import Plan

    plan = Plan(budget=Budget(seconds=_seconds(arguments)))
    on_samples = bool(arguments.data)  # which are judged by others, and beside a regression
    judged, linear = on_samples or arguments.unseen > 0, not (on_samples or arguments.no_linear)
    return plan.shared(judged=judged, linear=linear).seconds


def _most(arguments: argparse.Namespace) -> str:
    """Return in words when the searches end at the latest."""
    words = f"up to {counted(arguments.evals, 'trial')}"
    seconds = _seconds(arguments)
    return f"{words} and {duration_words(seconds)}" if seconds < math.inf else words


class _Progress:
    """What is said of the searches while they go on: of the controller's, then of the opponent's.

    Parameters
    ----------
    evals : int
        Of the search.
    say : callable
        Takes a search, or none, and a line that says how far it is.
    every : float
        Seconds between two words.
    seconds : float
        After which the search ends in any case.
    """

    def __init__(
        self,
        evals: int,
        say: Callable[[Found | None, str], None],
        every: float,
        seconds: float = math.inf,
    ) -> None:
        self.evals, self.say, self.every = evals, say, every
        self.pace = Pace(evals, seconds)
        self.told = time.monotonic()

    def search(self, found: Found) -> None:
        """Hear of the search."""
        known = self.pace.rate(len(found.trials)) is not None
        if self._is_time():
            left = [f"{duration_words(self.pace.left(len(found.trials)))} left"] if known else []
            self.say(found, ", ".join([*self._state(found), *left]))

    def linear(self, found: Found) -> None:
        """Hear of the search of the linear opponent."""
        if self._is_time():
            state = f"{counted(len(found.trials), 'trial')}, best {found.best.score.cost:.5g}"
            self.say(found, f"the linear controller, tuned on the same: {state}")

    def tell(self, words: str) -> None:
        """Hear what follows the searches."""
        if self._is_time():
            self.say(None, words)

    def _is_time(self) -> bool:
        now = time.monotonic()
        if now - self.told < self.every:
            return False
        self.told = now
        return True

    def _state(self, found: Found) -> Iterator[str]:
        yield f"{len(found.trials)} of {self.evals} trials"
        if found.refused:
            yield f"{found.refused} refused"
        if found.failed:
            yield f"{found.failed} failed"
        yield f"best {found.best.score.cost:.5g}"


@contextmanager
def _shown(evals: int, seconds: float) -> Iterator[_Progress]:
    """Show trials, the best cost and its curve on stderr; give what is told of the searches."""
    if not sys.stderr.isatty():
        yield _Progress(evals, lambda _found, state: print_error(state), TOLD_EVERY, seconds)
        return
    from rich.console import Console
    from rich.live import Live
    from rich.text import Text

    from fuzzyarm.show.tuning import search_view

    console = Console(stderr=True)
    with Live(console=console, transient=True, auto_refresh=False) as live:

        def draw(found: Found | None, state: str) -> None:
            view = Text(state) if found is None else search_view(found, state, console.width)
            live.update(view, refresh=True)

        draw(None, "the file as it is")
        yield _Progress(evals, draw, REDRAWN_EVERY, seconds)


# --- What came of it ---


def _lines(tuned: Tuned, path: str, written: list[Path]) -> Iterator[str]:
    from fuzzyarm.show import plain_text
    from fuzzyarm.show.tuning import (
        change_lines,
        curve_view,
        front_lines,
        table_lines,
        width_for,
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
        yield from plain_text(curve_view(search.curve, width_for(columns))).splitlines()
    front = list(front_lines(tuned))
    if front:
        yield from ("front of error and chatter:", *(f"  {line}" for line in front))
    yield from tuned.remarks()
    yield from change_lines(tuned)
    if written:
        yield f"wrote {', '.join(map(os.fspath, written))}"


def _unset(each: Argument) -> Argument:
    """Return an argument of which is known whether it was given."""
    if each.names[0] not in ("--payload", "--plant"):
        return each
    options = {**each.options, "default": None}
    if each.names[0] == "--plant":
        options["help"] = "where it runs; by default the shipped plant that has its axes"
    return each._replace(options=options)


COMMANDS = (
    command(
        "tune",
        __doc__,
        _run,
        argument("file FILE", "a controller, its name in the catalogue, or a rule base"),
        argument("-o --out FILE.frb", "where to write it; over the file itself, if it is the same"),
        *group(
            "what is good",
            argument("--cost COST", "formula of metrics, or FILE.py:FUNCTION; rms by default"),
            argument("--data FILE", "samples, .csv or .parquet, for a rule base alone"),
            argument("--test FILE", "samples to judge by; a fifth of the data by default"),
            argument("--target NAME", "the column that the output is to give"),
        ),
        *group(
            "scenarios",
            argument("--scenarios N", "tune on N: the named ones, then drawn ones", type=int),
            argument(
                "--vary NAME=A..B",
                "what differs from drawn scenario to scenario, as with sweep --random",
                action="append",
                default=[],
            ),
            argument("--over", "mean or worst cost", choices=("mean", "worst"), default="mean"),
            argument("--unseen N", "judge by N others, 24 by default", type=int, default=24),
        ),
        *group(
            "the search",
            argument(
                "--tune LINE",
                "what may move, as a line of a tune block, in place of the file's",
                action="append",
                default=[],
            ),
            argument(
                "--method",
                choices=("nelder-mead", "cma-es", "evolution"),
                default="nelder-mead",
            ),
            argument("--evals N", "candidates, 500 by default", type=int, default=500),
            argument("--time TIME", "at most so long, as in 90s or 10min"),
            argument("--digits N", "of the numbers that are written", type=int, default=3),
            flag("--no-linear", "tune no linear controller to compare with"),
            argument("--journal FILE", "write every trial down"),
            flag("--resume", "go on with the journal"),
            argument("--workers N", "one for each processor by default", type=int),
            argument("--dask ADDRESS", "run on a Dask cluster, as in tcp://scheduler:8786"),
        ),
        *map(_unset, (*TRAJECTORY, *PLANT)),
        *group("run", *CONVENTIONS),
        *MOTORS,
        *group(
            "output",
            argument("--plot FIG", "draw cost, front and table: .png, .svg or .pdf"),
            json_of("the report"),
        ),
    ),
)
