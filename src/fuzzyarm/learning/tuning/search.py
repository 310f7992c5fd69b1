"""A search: its trials, the best so far, budget, promises and journal."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import CancelledError
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError, sentence_of
from fuzzyarm.base.names import printable
from fuzzyarm.inference import check_expectations
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.learning.tuning.design import Candidate
from fuzzyarm.learning.tuning.examiner import REFUSED, ExaminerPool, Score
from fuzzyarm.learning.tuning.movement import TuneError
from fuzzyarm.learning.tuning.optimisers import OPTIMISERS
from fuzzyarm.requests.fields import read_fields
from fuzzyarm.requests.journal import JournalError
from fuzzyarm.requests.journal import WorkJournal as JournalFile
from fuzzyarm.requests.tune import TuneRequest

Vector = NDArray[np.float64]


class Trial(NamedTuple):
    """An examined point and its score."""

    point: Vector
    score: Score


@dataclass(frozen=True)
class Budget:
    """When a search ends.

    Attributes
    ----------
    evals : int
        Candidates examined, the file itself included.
    seconds : float
        Wall time.
    """

    evals: int = 500
    seconds: float = math.inf

    def __post_init__(self) -> None:
        read_fields(TuneRequest, vars(self), ("evals",))
        if not self.seconds > 0.0:
            raise TuneError(f"a time of {self.seconds:g} s is out of range")


BLOCK_SECONDS = 1.0
"""Seconds of examination between two looks at the clock."""


class Over(Exception):  # noqa: N818 - it ends a search, and never leaves it
    """The budget is spent."""


@dataclass(eq=False)
class Found:
    """The result of a search so far.

    Attributes
    ----------
    trials : list of Trial
        In order of evaluation; the first is the original file.
    best : Trial
        The cheapest that keeps all promises.
    refused : int
        Trials that broke one.
    failed : int
        Number of failed trials; the first of them has the reason.
    interrupted : bool
        Whether Ctrl-C ended it.
    seconds : float
        Wall time, all parts of a resumed search together.
    fault : str
        The exception that ended it early; empty if none did.
    unwritten : str
        Why the journal lacks trials; empty if it has all of them.
    """

    trials: list[Trial]
    best: Trial
    refused: int = 0
    failed: int = 0
    interrupted: bool = False
    seconds: float = 0.0
    fault: str = ""
    unwritten: str = ""

    @property
    def failure(self) -> str:
        """The message of the first failed trial; empty if none failed."""
        return next((trial.score.fault for trial in self.trials if trial.score.fault), "")

    @property
    def curve(self) -> list[float]:
        """The best cost after each trial."""
        costs = [trial.score.cost for trial in self.trials]
        return np.minimum.accumulate(costs).tolist() if costs else []


Watch = Callable[[Found], None]
"""Called after each examination; an exception from it ends the search."""


class Search:
    """One search on a panel.

    Parameters
    ----------
    panel : ExaminerPool
        Examines.
    promises : Promises or None
        Constraints on every candidate.
    budget : Budget
        When to end.
    journal : Journal, optional
        Where trials are recorded; may hold those of an earlier part.
    watch : callable, optional
        See :data:`Watch`.
    """

    def __init__(
        self,
        panel: ExaminerPool,
        promises: Promises | None,
        budget: Budget,
        journal: Journal | None = None,
        watch: Watch = lambda _result: None,
    ) -> None:
        self.panel = panel
        self.promises = promises
        self.budget = budget
        self.journal = journal
        self.watch = watch
        self.replay = list(journal.replay) if journal is not None else []
        self.before = journal.seconds if journal is not None else 0.0
        self.result = Found([], Trial(panel.design.start, Score(math.inf)))
        self.begin = time.monotonic()

    def run(self, method: str, seed: int) -> Found:
        """Search until the budget is spent or Ctrl-C is pressed; never raises for either.

        If the workers vanish, as those of a cluster may, it ends as with Ctrl-C. Any other
        exception ends it too, but its result stays, unless only the file itself was examined.
        """
        start, search = self.panel.design.start, self.result
        try:
            self.ask([start])
            if search.trials[0].score.fault:
                self.panel.examiner.score(start)  # re-raises
                raise TuneError(search.trials[0].score.fault)
            OPTIMISERS[method].run(self.ask, start, seed)
        except Over:
            pass
        except (KeyboardInterrupt, CancelledError):
            if not search.trials:
                raise
            search.interrupted = True
        except JournalError:
            raise
        except Exception as error:
            if len(search.trials) < 2:
                raise
            search.fault = sentence_of(error)
        search.seconds = self.seconds
        return search

    @property
    def seconds(self) -> float:
        """Wall time so far."""
        return self.before + time.monotonic() - self.begin

    def ask(self, points: Sequence[Vector]) -> list[float]:
        """Return the costs of points; a batch is cut at the budget."""
        remaining = self.budget.evals - len(self.result.trials)
        if remaining <= 0 or (self.result.trials and self._late()):  # the file is always examined
            raise Over
        costs: list[float] = []
        while len(costs) < min(len(points), remaining):
            # A few at a time, so that Ctrl-C and the clock are heeded and little is lost.
            block = points[len(costs) : min(len(costs) + self._block_size(), remaining)]
            costs += self._block(block)
            if self._late() and len(costs) < len(points):
                raise Over
        if len(costs) < len(points):
            raise Over
        return costs

    def _block_size(self) -> int:
        """Return the number of points to examine before the next look at the clock."""
        workers, fresh = self.panel.workers, len(self.result.trials) - len(self.replay)
        if fresh <= 0:
            return 4 * workers
        pace = (time.monotonic() - self.begin) / fresh
        return max(workers, min(4 * workers, int(BLOCK_SECONDS / max(pace, 1e-9))))

    def _late(self) -> bool:
        return self.seconds > self.budget.seconds and len(self.replay) <= len(self.result.trials)

    def _block(self, points: Sequence[Vector]) -> list[float]:
        count = len(self.result.trials)
        replayed = self.replay[count : count + len(points)]
        for trial, point in zip(replayed, points, strict=False):
            if not np.array_equal(trial.point, point):
                raise JournalError("the journal is of another search", hint="remove it")
        fresh = list(points[len(replayed) :])
        scores = [trial.score for trial in replayed] + self._examined(fresh)
        trials = [Trial(point, score) for point, score in zip(points, scores, strict=True)]
        for at, trial in enumerate(trials):
            self._count(trial, is_replayed=at < len(replayed))
        if self.journal is not None and fresh:
            try:
                self.journal.append(
                    self.result.trials[count + len(replayed) :], count + len(replayed)
                )
            except OSError as error:  # the search is worth more than its journal
                self.result.unwritten = f"{self.journal.path}: {error.strerror or error}"
                self.journal = None
        self.watch(self.result)
        return [trial.score.cost for trial in self.result.trials[count:]]

    def _examined(self, points: Sequence[Vector]) -> list[Score]:
        """Examine candidates that meet their expectations; others get the highest cost."""
        design, promises = self.panel.design, self.promises
        broken = [bool(promises and promises.expected(design.at(point))) for point in points]
        sound = [point for point, fails in zip(points, broken, strict=True) if not fails]
        scores = iter(self.panel.scores(sound))
        return [Score(REFUSED) if fails else next(scores) for fails in broken]

    def _count(self, trial: Trial, *, is_replayed: bool) -> None:
        """Count a trial; before it becomes the best prove its properties, or read the journal."""
        search = self.result
        if trial.score.fault:
            search.failed += 1
        elif trial.score.cost >= REFUSED:
            search.refused += 1
        elif trial.score.cost < search.best.score.cost:
            unproved = ""
            if self.promises and not is_replayed:
                unproved = self.promises.proof(self.panel.design.at(trial.point))
            if unproved:
                search.refused += 1
                trial = trial._replace(score=Score(REFUSED))
            else:
                search.best = trial
        search.trials.append(trial)


# --- The journal ---

TRIAL = (
    "trial", "seconds", "cost", "rms", "chatter", "diverged", "fault", "parts", "point",
)  # fmt: skip
"""Columns of a journal; lists of costs and of parameters are separated by blanks."""


class Journal:
    """A file with a line for each trial, from which a search can be resumed.

    Parameters
    ----------
    path : path-like
        Path of a text file.
    question : mapping
        Everything on which the search depends, as JSON data.
    resume : bool
        Whether to resume from the content of the file.

    Attributes
    ----------
    known : list of Trial
        From before.
    seconds : float
        That they took.

    Raises
    ------
    JournalError
        If the file is of another search, or has trials that would be lost.
    OSError
        If it cannot be read or written.
    """

    def __init__(self, path: str | Path, question: Mapping[str, Any], *, resume: bool) -> None:
        self.lines = JournalFile(path, "search", question, TRIAL, piece="trial", option="--journal")
        self.path = self.lines.path
        self.seconds = 0.0
        self.begin = time.monotonic()
        self.replay: list[Trial] = []
        if resume and self.path.exists():
            self.replay = self.lines.read(self._trial)
        else:
            self.lines.begin(may_replace=False)

    def _trial(self, number: int, cells: Sequence[str]) -> Trial:
        trial, seconds, cost, rms, chatter, diverged, fault, parts, point = cells
        if int(trial) != number:
            raise ValueError
        self.seconds = float(seconds)
        error, change = (float(cell) if cell else math.nan for cell in (rms, chatter))
        costs = tuple(map(float, parts.split()))
        score = Score(float(cost), costs, error, change, int(diverged), fault)
        return Trial(np.array(point.split(), dtype=float), score)

    def append(self, trials: Sequence[Trial], first: int) -> None:
        """Write trials down."""
        seconds = round(self.seconds + time.monotonic() - self.begin, 3)
        self.lines.append(_cells(at, seconds, trial) for at, trial in enumerate(trials, first))


def _cells(number: int, seconds: float, trial: Trial) -> list[str]:
    score = trial.score
    rms, chatter = (
        "" if math.isnan(value) else repr(float(value)) for value in (score.error, score.chatter)
    )
    parts, point = (
        " ".join(repr(float(value)) for value in values) for values in (score.parts, trial.point)
    )
    cost, fault = repr(float(score.cost)), printable(score.fault)
    return [
        str(number),
        repr(seconds),
        cost,
        rms,
        chatter,
        str(score.diverged),
        fault,
        parts,
        point,
    ]


# --- Promises of a tuned file: its `expect` and `prove` lines ---

PROOF_SECONDS = 2.0
"""Time limit of one ``prove`` line for one candidate, s."""


class Promises:
    """The ``expect`` and ``prove`` lines of some rule bases.

    Parameters
    ----------
    rulebases : mapping of str to RuleBase
        As in their files.

    Raises
    ------
    TuneError
        If a file breaks its own promises.
    """

    def __init__(self, rulebases: Mapping[str, RuleBase]) -> None:
        self.proved: dict[str, list[bool]] = {}
        for name, rulebase in rulebases.items():
            broken = self._expected(rulebase)
            if broken:
                hint = "fuzzyarm check shows it; tuning keeps what holds"
                raise TuneError(f"'{name}' breaks a promise of its own: {broken}", hint=hint)
            if rulebase.properties:
                self.proved[name] = self._proved(name, rulebase)

    def __bool__(self) -> bool:
        return True

    def _proved(self, name: str, rulebase: RuleBase) -> list[bool]:
        from fuzzyarm.proof.map import prove_all

        outcomes = []
        for verdict in prove_all(rulebase, budget=PROOF_SECONDS):
            if verdict.verdict == "refuted":
                raise TuneError(f"'{name}' breaks a promise of its own: {verdict.statement}")
            outcomes.append(bool(verdict.proved))
        return outcomes

    def expected(self, candidate: Candidate) -> str:
        """Return the ``expect`` line that a candidate breaks; empty without one."""
        for rulebase in candidate.rulebases.values():
            broken = self._expected(rulebase)
            if broken:
                return broken
        return ""

    @staticmethod
    def _expected(rulebase: RuleBase) -> str:
        if not rulebase.expectations:
            return ""
        try:
            diagnostics = check_expectations(rulebase)
        except FuzzyarmError as error:  # no rule fires there
            return error.message
        return diagnostics[0].message if diagnostics else ""

    def proof(self, candidate: Candidate) -> str:
        """Return the ``prove`` line that a candidate breaks; one that held must be proved again."""
        from fuzzyarm.proof.map import prove_all

        for name, rulebase in candidate.rulebases.items():
            outcomes = self.proved.get(name)
            if not outcomes:
                continue
            verdicts = prove_all(rulebase, budget=PROOF_SECONDS)
            for verdict, was_proved in zip(verdicts, outcomes, strict=True):
                if verdict.verdict == "refuted" or (was_proved and not verdict.proved):
                    return str(verdict.statement)
        return ""
