"""Tuning, watched and stopped by the user: the search of ``fuzzyarm tune`` on the open text.

The search runs in a separate process of low priority, so that key strokes are answered meanwhile.
Words of a page: ``enough``, which keeps the best so far, and ``take``: the change becomes an edit
of the text.
"""

from __future__ import annotations

import contextlib
import os
import threading
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from fuzzyarm.apps.designer.faults import TextRefusedError, internal_words
from fuzzyarm.apps.designer.forms import TUNE
from fuzzyarm.apps.designer.grounds import (
    FieldError,
    GroundsError,
    at_field,
    plant_named,
    plants_for,
    request_on,
)
from fuzzyarm.apps.designer.jobs import TELL_EVERY, WindowJob
from fuzzyarm.apps.designer.requests import BareMessage, FormWork, TuneWord
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.apps.show.search import cost_panel
from fuzzyarm.base.diagnostic import RuleBaseError
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.files import confined
from fuzzyarm.base.jsonable import jsonable
from fuzzyarm.base.picture import Dots, panel_data
from fuzzyarm.base.shipped_files import shipped_folder
from fuzzyarm.language import parse
from fuzzyarm.requests.tune import TuneRequest

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

    from fuzzyarm.control.controllers.text import ControllerText
    from fuzzyarm.language.model.rulebase import RuleBase
    from fuzzyarm.learning.data import Samples
    from fuzzyarm.learning.tuning.design import Design
    from fuzzyarm.learning.tuning.result import Tuned
    from fuzzyarm.learning.tuning.scenarios import Stage
    from fuzzyarm.learning.tuning.search import Found
    from fuzzyarm.learning.tuning.tune import TuneKeywords

MOST_EVALS = 100_000
MOST_SCENARIOS = 1_000
SAMPLES = (".csv", ".parquet")
MOST_DOTS = 2_000
"""Of trials in the picture of a long search."""

NAMES = {"search": "best so far", "linear": "linear PD"}
"""Phase → label of its line."""

POLITE = 5
"""Decrease of the search's priority, in favour of the server."""


def subject_of(path: str, text: str) -> ControllerText | RuleBase:
    """Return the subject of tuning in a text."""
    if not path.lower().endswith(".frb"):
        raise TextRefusedError("a table is not tuned; open a controller or a rule base")
    parsed = parse(text, path)
    if parsed.controller is not None:
        from fuzzyarm.control.controllers.text import read_controller

        return read_controller(path, source=text)
    if parsed.rulebase is None:
        raise RuleBaseError(parsed.diagnostics)
    return parsed.rulebase


# --- Facts for the form ---


def tunable(session: Session, request: BareMessage, job: WindowJob) -> None:
    """Send whether the text can be tuned, its parameters, and its plants or samples."""
    from fuzzyarm.control.controllers.text import ControllerText
    from fuzzyarm.learning.tuning import TuneError
    from fuzzyarm.learning.tuning.design import Design, has_movable_numbers

    try:
        subject = subject_of(session.path, session.text)
    except RuleBaseError:
        raise TextRefusedError("the text has mistakes: fix those listed below it first") from None
    loop = isinstance(subject, ControllerText)
    try:
        parameters, why = [parameter.name for parameter in Design(subject).parameters], ""
    except TuneError as error:
        parameters, why = [], str(error)
    plants = plants_for(subject.model, job.plants) if isinstance(subject, ControllerText) else []
    job.tell({
        "loop": loop,
        "says": has_movable_numbers(subject),
        "parameters": parameters,
        "why": why,
        "plants": plants,
        "samples": [] if loop else job.folder.listed(*SAMPLES),
        "cost": "rms" if loop else "rmse",
        "form": TUNE.fields(),
    })  # fmt: skip


class PageOrder(NamedTuple):
    """The order of a search, as plain data for its process."""

    path: str
    text: str
    request: TuneRequest
    plants: tuple[str, ...]
    """Plants named on the command line."""


def order_of(session: Session, work: FormWork, job: WindowJob) -> PageOrder:
    """Read the request; GroundsError if a value is out of range, or would run a file."""
    from fuzzyarm.learning.tuning.cost import read_cost
    from fuzzyarm.learning.tuning.orders import longest
    from fuzzyarm.learning.tuning.tune import read_tuning

    request = TUNE.request(work.form, Path(session.path).parent, file=session.path)
    request = request.replaced(**_samples_of(request, job))
    with at_field("cost"):
        if ".py" in (request.cost or ""):
            raise GroundsError("functions of files are a cost on the command line alone")
        if request.cost and request.data is None:
            read_cost(request.cost)
    with at_field("tune"):
        read_tuning(request.tune)
    if request.evals > MOST_EVALS:
        raise FieldError(
            f"evals must be at most {MOST_EVALS} here, not {request.evals}", field="evals"
        )
    most = max(request.unseen, request.scenarios or 0)
    if most > MOST_SCENARIOS:
        raise GroundsError(f"there must be at most {MOST_SCENARIOS} scenarios here, not {most}")
    with at_field("time"):
        longest(request)
    return PageOrder(session.path, session.text, request, job.plants.files)


def _samples_of(request: TuneRequest, job: WindowJob) -> dict[str, str]:
    """Return the files of samples in the folder."""
    files = {}
    for name, file in (("data", request.data), ("test", request.test)):
        if file is None:
            continue
        if file not in job.folder.listed(*SAMPLES):
            raise GroundsError(f"'{file}' is not a file of samples in this folder")
        files[name] = str(job.folder.beside(file, Path(file).suffix.lower()))
    return files


# --- Here: messages to the page ---


def tune(session: Session, request: FormWork, job: WindowJob) -> None:
    """Search and report until the page stops."""
    order = order_of(session, request, job)
    prepared(order)  # reports mistakes at once
    report = _searched(order, job)
    files = report.pop("files")
    job.tell({"report": report})
    while True:
        word = job.word(TuneWord)
        if word.take:
            _apply(files, session, job, replace=word.replace)


def _searched(order: PageOrder, job: WindowJob) -> dict[str, Any]:
    """Run the search in a separate process, and pass on its messages."""
    from multiprocessing import get_context

    context = get_context("spawn")  # a fork would copy the locks of threads, but not the threads
    here, there = context.Pipe()
    process = context.Process(target=search, args=(there, order), name="fuzzyarm-tune")
    process.start()
    there.close()
    searches: list[dict[str, Any]] = []
    try:
        return _heard(here, job, searches)
    except (EOFError, OSError):
        if searches:
            return _with_fault(searches[-1], "its process has ended unexpectedly")
        raise TextRefusedError("the search has ended unexpectedly") from None
    finally:
        here.close()  # at which it ends itself, wherever it is
        process.join(2.0)
        if process.is_alive():
            process.kill()


def _heard(here: Connection, job: WindowJob, searches: list[dict[str, Any]]) -> dict[str, Any]:
    """Pass on the messages of the search; return its report, and store interim ones."""
    while True:
        if any(word.enough for word in job.heard(TuneWord)):
            here.send("enough")
        if not here.poll(TELL_EVERY):
            job.check()
            continue
        message: dict[str, Any] = here.recv()
        if "done" in message:
            return message["done"]  # type: ignore[no-any-return]
        if "kept" in message:
            searches.append(message["kept"])
        elif "failed" in message and searches:
            return _with_fault(searches[-1], message["failed"])
        elif "failed" in message:
            raise _failure(message["failed"], message.get("field", ""))
        else:
            job.tell(message)


def _with_fault(report: dict[str, Any], words: str) -> dict[str, Any]:
    return {**report, "faults": [*report["faults"], words]}


def _failure(message: str, field: str) -> FuzzyarmError:
    return FieldError(message, field=field) if field else TextRefusedError(message)


def _apply(files: list[dict[str, str]], session: Session, job: WindowJob, *, replace: bool) -> None:
    """Write rule bases of other files beside the text, and send the text with the numbers."""
    from fuzzyarm.learning.tuning.text import with_files

    first_file, *others = files
    stem = Path(session.path).stem
    names = {sheet["name"]: f"{stem}-{sheet['name']}.frb" for sheet in others if sheet["changed"]}
    try:
        there = [name for name in names.values() if job.folder.beside(name, ".frb").exists()]
        if there and not replace:
            job.tell({"exists": there})
            return
        from fuzzyarm.base.files import write_atomically

        for sheet in others:
            if sheet["name"] in names:
                write_atomically(job.folder.beside(names[sheet["name"]], ".frb"), sheet["new"])
    except (FuzzyarmError, OSError) as error:
        job.check()
        job.tell({"untaken": str(error)})
        return
    new = with_files(first_file["new"], names) if names else first_file["new"]
    job.tell({"taken": {"old": session.text, "new": new, "written": list(names.values())}})


# --- There: the process that searches ---


def search(pipe: Connection, order: PageOrder) -> None:
    """Tune, and report through a pipe; ends with the pipe."""
    from fuzzyarm.control.loop.blocks import ignore_interrupt

    ignore_interrupt()
    if hasattr(os, "nice"):
        os.nice(POLITE)
    enough = threading.Event()
    threading.Thread(target=_listen, args=(pipe, enough), daemon=True).start()
    try:
        with confined(Path(order.path).parent, shipped_folder()):
            pipe.send({"done": _tuned(pipe, order, enough)})
    except (FuzzyarmError, OSError) as error:
        from fuzzyarm.control.loop.many import SweepError

        # Whether a name varies is known when the first runs are drawn.
        field = "vary" if isinstance(error, SweepError) else ""
        with contextlib.suppress(OSError):
            pipe.send({"failed": str(error), "field": field})
    except Exception as error:
        with contextlib.suppress(OSError):
            pipe.send({"failed": internal_words(error, "a search of tuning")})


def _listen(pipe: Connection, enough: threading.Event) -> None:
    """Receive from the server; without it there is no reader of the rest."""
    try:
        while pipe.recv() == "enough":
            enough.set()
    except (EOFError, OSError):
        os._exit(0)


def prepared(order: PageOrder) -> tuple[ControllerText | RuleBase, TuneKeywords]:
    """Return the subject, and the keywords of `fuzzyarm.learning.tuning.tune`."""
    from fuzzyarm.control.controllers.text import ControllerText
    from fuzzyarm.control.loop.words import conventions_of
    from fuzzyarm.learning.tuning.orders import Order
    from fuzzyarm.learning.tuning.tune import keywords_of

    subject = subject_of(order.path, order.text)
    request, stage = order.request, None
    samples: dict[str, Samples] = {}
    if isinstance(subject, ControllerText):
        stage = _stage(order, subject)
    else:
        samples = _samples(request, subject)
    conventions = conventions_of(request)
    return subject, keywords_of(
        request, Order(order.path, subject, stage, samples, conventions, None)
    )


def _stage(order: PageOrder, text: ControllerText) -> Stage:
    """Return the stage of a controller, in the words of the page."""
    from fuzzyarm.apps.designer.stage import Plants
    from fuzzyarm.control.loop.words import driven
    from fuzzyarm.learning.tuning.orders import stage_of_request

    request = order.request
    plant = plant_named(request.plant or "", text.model, Plants(order.plants))
    request = request_on(plant, request)
    return stage_of_request(request, text, driven(request, plant))


def _samples(request: TuneRequest, rulebase: RuleBase) -> dict[str, Samples]:
    """Return the samples for a rule base alone; its only output is the target."""
    from fuzzyarm.learning.tuning.orders import samples_of

    if request.data is None:
        raise TextRefusedError(
            f"'{rulebase.name}' is a rule base alone: nothing says what is good",
            hint="put samples into the folder, or tune the controller that uses it",
        )
    return samples_of(request, rulebase)


def _tuned(pipe: Connection, order: PageOrder, enough: threading.Event) -> dict[str, Any]:
    from fuzzyarm.learning.tuning import tune as tune_it
    from fuzzyarm.learning.tuning.design import Design
    from fuzzyarm.learning.tuning.tune import read_tuning

    subject, keywords = prepared(order)
    moving = order.request.tune
    teller = Teller(pipe, Design(subject, read_tuning(moving) if moving else None), enough)
    keywords.update({"watch": teller.search, "watch_linear": teller.linear, "text": order.text})
    keywords["take"] = lambda tuned: pipe.send({"kept": _reported(tuned)})
    tuned = tune_it(subject, **keywords)
    teller.end()
    return _reported(tuned)


def _reported(tuned: Tuned) -> dict[str, Any]:
    files = [{"name": file.name, "new": file.new, "changed": file.changed} for file in tuned.files]
    return {**tuned.to_dict(), "diff": tuned.diff(), "files": files}


def _thinned(dots: Dots) -> Dots:
    """Return some of the dots, evenly, if there are too many to distinguish."""
    every = 1 + len(dots.x) // MOST_DOTS
    return replace(dots, x=dots.x[::every], y=dots.y[::every])


class Teller:
    """Reports the progress of a search.

    Parameters
    ----------
    pipe : Connection
        To the server.
    design : Design
        The parameters.
    enough : Event
        Set when the search is to end.
    """

    def __init__(self, pipe: Connection, design: Design, enough: threading.Event) -> None:
        self.pipe, self.design, self.enough = pipe, design, enough
        self.begin = time.monotonic()
        self.last = 0.0
        # Time and duration of the last drawing of the costs, s.
        self.last_drawing = self.drawing = 0.0
        self.trials_shown = {"search": 0, "linear": 0}
        self.results: dict[str, tuple[Found, float]] = {}
        """By phase, and when it was heard of."""
        pipe.send({"moving": [
            {"name": parameter.name, "low": parameter.low, "high": parameter.high,
             "start": parameter.start, "share": float(share)}
            for parameter, share in zip(design.parameters, design.start, strict=True)
        ]})  # fmt: skip

    def search(self, result: Found) -> None:
        """Hear of the search."""
        self._hear("search", result)

    def linear(self, result: Found) -> None:
        """Hear of the search of the linear opponent."""
        self._hear("linear", result)

    def rest(self) -> None:
        """Report new results."""
        for phase, (result, when) in self.results.items():
            if self.trials_shown[phase] < len(result.trials):
                self._say(phase, result, when - self.begin)

    def end(self) -> None:
        """Report new results, and draw the costs of all trials."""
        self.rest()
        self.pipe.send(self._picture(is_last=True))

    def _picture(self, *, is_last: bool = False) -> dict[str, Any]:
        """Return the picture of the costs, if due: it needs all trials."""
        begin = time.monotonic()
        if not is_last and begin - self.last_drawing < 20.0 * self.drawing:
            return {}
        searches = {NAMES[phase]: result for phase, (result, _) in self.results.items()}
        panel = cost_panel(searches)
        parts = [_thinned(part) if isinstance(part, Dots) else part for part in panel.parts]
        data = panel_data(replace(panel, parts=parts, title=""))
        self.last_drawing, self.drawing = begin, time.monotonic() - begin
        return {"panel": data}

    def _hear(self, phase: str, result: Found) -> None:
        now = time.monotonic()
        self.results[phase] = result, now
        if now - self.last >= TELL_EVERY:
            self.last = now
            self.rest()
        if self.enough.is_set():
            raise KeyboardInterrupt

    def _say(self, phase: str, result: Found, seconds: float) -> None:
        trials = result.trials
        self.trials_shown[phase] = len(trials)
        news: dict[str, Any] = {
            "phase": phase,
            "count": len(trials),
            **self._picture(),
            "best": jsonable(result.best.score.cost),
            "refused": result.refused,
            "seconds": round(seconds, 2),
        }
        if phase == "search":
            best = result.best.point
            news["best_shares"] = [float(share) for share in best]
            news["shares"] = [float(share) for share in trials[-1].point]
            pairs = zip(self.design.parameters, best, strict=True)
            news["values"] = [parameter.value(float(share)) for parameter, share in pairs]
        self.pipe.send(news)
