"""Tuning, watched and stopped by a hand: the search of ``fuzzyarm tune`` on the text that is open.

The search runs in a process of its own, so that key strokes are answered meanwhile, and it gives
way to the server. A page says ``enough``, which keeps the best so far, and ``take``: the change
becomes an edit of the text.
"""

from __future__ import annotations

import contextlib
import math
import os
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from fuzzyarm.designer.grounds import (
    GroundsError,
    fitting_plants,
    plant_named,
    references_of,
    seconds_of,
    whole_of,
)
from fuzzyarm.designer.jobs import Job
from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.language import parse
from fuzzyarm.lsp.session import Session
from fuzzyarm.shipped_files import shipped_folder
from fuzzyarm.text.diagnostic import RuleBaseError
from fuzzyarm.text.files import confined

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

    from fuzzyarm.controller.text import ControllerText
    from fuzzyarm.model.rulebase import RuleBase
    from fuzzyarm.tuning.design import Design
    from fuzzyarm.tuning.search import Found

TELL_EVERY = 0.1
"""Seconds between two words of the search."""

DEFAULTS = {"evals": 500, "scenarios": 1, "unseen": 24, "seed": 1, "digits": 3}
MOST_EVALS = 100_000
MOST_SCENARIOS = 1_000
SAMPLES = (".csv", ".parquet")
POLITE = 5
"""By how much the search gives way to the server."""


class TextError(FuzzyarmError, ValueError):
    """A text that is not tuned, or a search that has failed."""


def subject_of(path: str, text: str) -> ControllerText | RuleBase:
    """Return what is tuned in a text.

    Raises
    ------
    TextError
        If it is a table.
    RuleBaseError
        If it has mistakes.
    """
    if not path.lower().endswith(".frb"):
        raise TextError("a table is not tuned; open a controller or a rule base")
    parsed = parse(text, path)
    if parsed.controller is not None:
        from fuzzyarm.controller.text import read_controller

        return read_controller(path, source=text)
    if parsed.rulebase is None:
        raise RuleBaseError(parsed.diagnostics)
    return parsed.rulebase


# --- What may be asked ---


def tunable(session: Session, asked: dict[str, Any], job: Job) -> None:
    """Tell whether the text can be tuned, what may move in it, and on what."""
    from fuzzyarm.controller.text import ControllerText
    from fuzzyarm.tuning import TuneError
    from fuzzyarm.tuning.design import Design, says_what_moves
    from fuzzyarm.tuning.optimisers import OPTIMISERS

    try:
        subject = subject_of(session.path, session.text)
    except RuleBaseError:
        raise TextError("the text has mistakes: first mend what stands below it") from None
    loop = isinstance(subject, ControllerText)
    try:
        parameters, why = [each.name for each in Design(subject).parameters], ""
    except TuneError as error:
        parameters, why = [], str(error)
    job.tell({
        "loop": loop,
        "says": says_what_moves(subject),
        "parameters": parameters,
        "why": why,
        "plants": fitting_plants(subject.model) if isinstance(subject, ControllerText) else [],
        "samples": [] if loop else job.folder.listed(*SAMPLES),
        "methods": list(OPTIMISERS),
        "defaults": {**DEFAULTS, "cost": "rms" if loop else "rmse"},
    })  # fmt: skip


class Order(NamedTuple):
    """What is to be tuned, and how; plain data for the process that searches."""

    path: str
    text: str
    plant: str
    reference: str
    seconds: float | None
    data: str
    given: dict[str, Any]
    """Arguments of `fuzzyarm.tuning.tune` as they are."""


def order_of(session: Session, asked: dict[str, Any], job: Job) -> Order:
    """Read what a page asked for.

    Raises
    ------
    GroundsError
        If something is out of range, or would run a file.
    """
    cost = str(asked.get("cost") or "").strip()
    if ".py" in cost:
        raise GroundsError("functions of files are a cost on the command line alone")
    counts = {name: whole_of(asked, name, DEFAULTS[name], MOST_EVALS) for name in DEFAULTS}
    scenarios = whole_of(asked, "scenarios", 0, MOST_SCENARIOS) or None
    if counts["unseen"] > MOST_SCENARIOS:
        raise GroundsError(f"{counts['unseen']} unseen scenarios are out of range")
    data = str(asked.get("data") or "")
    if data:
        if data not in job.folder.listed(*SAMPLES):
            raise GroundsError(f"'{data}' is not a file of samples in this folder")
        data = str(job.folder.beside(data, Path(data).suffix.lower()))
    lines = [line for line in str(asked.get("lines") or "").splitlines() if line.strip()]
    given: dict[str, Any] = {
        "cost": cost or None,
        "scenarios": scenarios,
        "tuning": lines or None,
        "method": str(asked.get("method") or "nelder-mead"),
        "evals": counts["evals"],
        "seconds": seconds_of(asked.get("time"), "a time") or math.inf,
        "seed": counts["seed"],
        "digits": counts["digits"],
        "unseen": counts["unseen"],
        "linear": bool(asked.get("linear", True)),
        "over": "worst" if asked.get("over") == "worst" else "mean",
    }
    seconds = seconds_of(asked.get("seconds"))
    plant, reference = str(asked.get("plant") or ""), str(asked.get("reference") or "")
    return Order(session.path, session.text, plant, reference, seconds, data, given)


# --- Here: what a page hears ---


def tune(session: Session, asked: dict[str, Any], job: Job) -> None:
    """Search, tell, report; goes on until the page wants no more."""
    order = order_of(session, asked, job)
    prepared(order)  # what does not fit is said at once
    report = _searched(order, job)
    files = report.pop("files")
    job.tell({"report": report})
    while True:
        word = job.word()
        if "take" in word:
            _take(files, session, job, replace=bool(word.get("replace")))


def _searched(order: Order, job: Job) -> dict[str, Any]:
    """Run the search in a process of its own, and pass on what it says."""
    from multiprocessing import get_context

    context = get_context("spawn")  # a fork would copy locks of threads that it does not copy
    here, there = context.Pipe()
    process = context.Process(target=search, args=(there, order), name="fuzzyarm-tune")
    process.start()
    there.close()
    try:
        while True:
            if any(word.get("enough") for word in job.heard()):
                here.send("enough")
            if not here.poll(TELL_EVERY):
                job.check()
                continue
            said: dict[str, Any] = here.recv()
            if "done" in said:
                return said["done"]  # type: ignore[no-any-return]
            if "failed" in said:
                raise TextError(said["failed"])
            job.tell(said)
    except (EOFError, OSError):
        raise TextError("the search has ended unexpectedly") from None
    finally:
        here.close()  # at which it ends itself, wherever it is
        process.join(2.0)
        if process.is_alive():
            process.kill()


def _take(files: list[dict[str, str]], session: Session, job: Job, *, replace: bool) -> None:
    """Write rule bases of other files beside the text, and tell the text that has the numbers."""
    from fuzzyarm.tuning.text import with_files

    own, *others = files
    stem = Path(session.path).stem
    names = {each["name"]: f"{stem}-{each['name']}.frb" for each in others if each["changed"]}
    try:
        there = [name for name in names.values() if job.folder.beside(name, ".frb").exists()]
        if there and not replace:
            job.tell({"exists": there})
            return
        from fuzzyarm.text.files import write_atomically

        for each in others:
            if each["name"] in names:
                write_atomically(job.folder.beside(names[each["name"]], ".frb"), each["new"])
    except (FuzzyarmError, OSError) as error:
        job.check()
        job.tell({"untaken": str(error)})
        return
    new = with_files(own["new"], names) if names else own["new"]
    job.tell({"taken": {"old": session.text, "new": new, "written": list(names.values())}})


# --- There: the process that searches ---


def search(pipe: Connection, order: Order) -> None:
    """Tune, and say through a pipe how it goes; ends with the pipe."""
    from fuzzyarm.loop.blocks import deaf

    deaf()
    if hasattr(os, "nice"):
        os.nice(POLITE)
    enough = threading.Event()
    threading.Thread(target=_listen, args=(pipe, enough), daemon=True).start()
    try:
        with confined(Path(order.path).parent, shipped_folder()):
            pipe.send({"done": _tuned(pipe, order, enough)})
    except (FuzzyarmError, OSError) as error:
        with contextlib.suppress(OSError):
            pipe.send({"failed": str(error)})
    except Exception as error:
        with contextlib.suppress(OSError):
            pipe.send({"failed": f"a fault of the program: {error!r}"})


def _listen(pipe: Connection, enough: threading.Event) -> None:
    """Hear the server; without it nobody waits for the rest."""
    try:
        while pipe.recv() == "enough":
            enough.set()
    except (EOFError, OSError):
        os._exit(0)


def prepared(order: Order) -> tuple[ControllerText | RuleBase, dict[str, Any]]:
    """Return what is tuned, and the arguments of `fuzzyarm.tuning.tune`.

    Raises
    ------
    TextError, GroundsError, TuneError, RuleBaseError
        If something does not fit.
    """
    from fuzzyarm.controller.text import ControllerText
    from fuzzyarm.loop.course import Options
    from fuzzyarm.tuning.tune import read_tuning, stage_of

    subject = subject_of(order.path, order.text)
    given = dict(order.given)
    if isinstance(subject, ControllerText):
        plant = plant_named(order.plant, subject.model)
        references = references_of(order.reference)
        options = Options(seed=given["seed"])
        given["stage"] = stage_of(subject, plant, options, references, order.seconds)
    else:
        given |= _samples(order, subject)
    lines = given["tuning"]
    given["tuning"] = None if lines is None else read_tuning(lines)
    return subject, given


def _tuned(pipe: Connection, order: Order, enough: threading.Event) -> dict[str, Any]:
    from fuzzyarm.tuning import tune as tune_it
    from fuzzyarm.tuning.design import Design

    subject, given = prepared(order)
    teller = Teller(pipe, Design(subject, given["tuning"]), enough)
    tuned = tune_it(
        subject, **given, watch=teller.search, watch_linear=teller.linear, text=order.text
    )
    teller.rest()
    files = [{"name": each.name, "new": each.new, "changed": each.changed} for each in tuned.files]
    return {**tuned.as_data(), "diff": tuned.diff(), "files": files}


def _samples(order: Order, rulebase: RuleBase) -> dict[str, Any]:
    """Return the samples for a rule base alone, its only output being what is to be met."""
    from fuzzyarm.learning.data import Columns, column_names, read_samples

    if not order.data:
        raise TextError(
            f"'{rulebase.name}' is a rule base alone: nothing says what is good",
            hint="put samples into the folder, or tune the controller that uses it",
        )
    outputs = [each.name for each in rulebase.outputs]
    known = len(outputs) == 1 and outputs[0] in column_names(order.data)
    inputs = tuple(each.name for each in rulebase.inputs)
    columns = Columns(outputs[0] if known else None, inputs)
    return {"data": read_samples(order.data, columns), "scenarios": None}


class Teller:
    """Says now and then what a search has found.

    Parameters
    ----------
    pipe : Connection
        To the server.
    design : Design
        What moves.
    enough : Event
        Set when the search is to end.
    """

    def __init__(self, pipe: Connection, design: Design, enough: threading.Event) -> None:
        self.pipe, self.design, self.enough = pipe, design, enough
        self.begin = time.monotonic()
        self.last = 0.0
        self.told = {"search": 0, "linear": 0}
        self.found: dict[str, tuple[Found, float]] = {}
        """By phase, and when it was heard of."""
        pipe.send({"moving": [
            {"name": each.name, "low": each.low, "high": each.high, "start": each.start,
             "share": float(share)}
            for each, share in zip(design.parameters, design.start, strict=True)
        ]})  # fmt: skip

    def search(self, found: Found) -> None:
        """Hear of the search."""
        self._hear("search", found)

    def linear(self, found: Found) -> None:
        """Hear of the search of the linear opponent."""
        self._hear("linear", found)

    def rest(self) -> None:
        """Say what has not been said."""
        for phase, (found, when) in self.found.items():
            if self.told[phase] < len(found.trials):
                self._say(phase, found, when - self.begin)

    def _hear(self, phase: str, found: Found) -> None:
        now = time.monotonic()
        self.found[phase] = found, now
        if now - self.last >= TELL_EVERY:
            self.last = now
            self.rest()
        if self.enough.is_set():
            raise KeyboardInterrupt

    def _say(self, phase: str, found: Found, seconds: float) -> None:
        trials, first = found.trials, self.told[phase]
        self.told[phase] = len(trials)
        news: dict[str, Any] = {
            "phase": phase,
            "from": first,
            "costs": [_finite(trial.score.cost) for trial in trials[first:]],
            "best": _finite(found.best.score.cost),
            "refused": found.refused,
            "seconds": round(seconds, 2),
        }
        if phase == "search":
            best = found.best.point
            news["best_shares"] = [float(share) for share in best]
            news["shares"] = [float(share) for share in trials[-1].point]
            pairs = zip(self.design.parameters, best, strict=True)
            news["values"] = [each.value(float(share)) for each, share in pairs]
        self.pipe.send(news)


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
