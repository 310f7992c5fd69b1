"""Evaluation of candidates on all scenarios or samples, here or on other machines.

An examination depends on the point and the problem alone: neither on the number of workers nor on
earlier examinations.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.control.controllers.catalogue import controller_of
from fuzzyarm.control.controllers.controller import Controller
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.control.loop.blocks import Workers, packed, unpacked, workers_watched
from fuzzyarm.control.loop.course import Course, Options
from fuzzyarm.control.loop.many import Bench, Experiment
from fuzzyarm.control.loop.program import LoopProgram
from fuzzyarm.control.loop.run import Judged, Run
from fuzzyarm.language.model.rulebase import RuleBase, Tuning
from fuzzyarm.learning.data import Samples
from fuzzyarm.learning.tuning.cost import (
    Cost,
    OwnCost,
    brief_values_of,
    errors_of,
    lost,
    value_of_user,
    values_of,
)
from fuzzyarm.learning.tuning.design import Candidate, Design, controller_at
from fuzzyarm.learning.tuning.scenarios import Scenario
from fuzzyarm.plant.setting import PLAIN, Conventions

Vector = NDArray[np.float64]

Over = Literal["mean", "worst"]
"""How the costs of several scenarios become one."""

REFUSED = 1e9
"""Cost of a candidate that breaks a promise of its file, or that fails."""


@json_properties("cost rms=error chatter diverged each=parts")
class Score(NamedTuple):
    """The cost of a candidate.

    Attributes
    ----------
    cost : float
        Over all scenarios.
    parts : tuple of float
        For each scenario; empty for a function of the user and for samples.
    error, chatter : float
        Means of RMS error and chatter, for their Pareto front; NaN for samples.
    diverged : int
        Number of runs that diverged.
    fault : str
        The failure, if the candidate has no cost.
    """

    cost: float
    parts: tuple[float, ...] = ()
    error: float = math.nan
    chatter: float = math.nan
    diverged: int = 0
    fault: str = ""


@dataclass(frozen=True)
class TuningProblem:
    """A subject, its cost and its scenarios; pickled as is for workers.

    Attributes
    ----------
    subject : ControllerText or RuleBase
        As in the file.
    tuning : Tuning or None
        Replaces the ``tune`` lines of the file.
    cost : Cost or callable
        The cost to minimise.
    scenarios : tuple of Scenario
        Scenarios of a controller.
    samples : Samples or None
        Samples of a rule base alone.
    over : str
        How the costs of scenarios become one.
    conventions, options, connect
        See :func:`fuzzyarm.control.loop.simulate`.
    """

    subject: ControllerText | RuleBase
    tuning: Tuning | None
    cost: Cost | OwnCost
    scenarios: tuple[Scenario, ...] = ()
    samples: Samples | None = None
    over: Over = "mean"
    conventions: Conventions = PLAIN
    options: Options = field(default_factory=Options)
    connect: Mapping[str, str] | None = None


class Examiner:
    """A prepared problem, in the process that examines candidates.

    Parameters
    ----------
    problem : TuningProblem
        The problem.
    """

    def __init__(self, problem: TuningProblem) -> None:
        self.problem = problem
        self.design = Design(problem.subject, problem.tuning)
        self.own_cost = None if isinstance(problem.cost, Cost) else problem.cost
        self.lock = threading.Lock()
        self.stands: list[_Stand] = []
        if isinstance(problem.subject, ControllerText):
            # A gain with a value for each axis needs room for all of them.
            gains = Candidate(self.design.as_it_is().gains)
            base = controller_of(controller_at(problem.subject, gains))
            self.stands = [_Stand(scenario, base, problem) for scenario in problem.scenarios]

    @property
    def compiled(self) -> bool:
        """Whether all runs are machine code, which threads share."""
        return all(stand.bench.loop.compiled for stand in self.stands)

    # --- One candidate ---

    def score(self, point: Vector, digits: int | None = None) -> Score:
        """Examine the candidate at a point."""
        return self.score_of(self.design.at(point, digits))

    def score_of(self, candidate: Candidate) -> Score:
        """Examine a candidate."""
        ready = self.ready(candidate)
        return self.folded([self.run(ready, at) for at in range(len(self.stands))], candidate)

    def tried(self, point: Vector, digits: int | None = None) -> Score:
        """Examine a point of a search, which continues if a candidate fails."""
        try:
            return self.score(point, digits)
        except FuzzyarmError as error:
            return failed(error)

    def ready(self, candidate: Candidate) -> LoopProgram | None:
        """Prepare the state shared by all scenarios of a candidate; None if nothing runs."""
        subject = self.problem.subject
        if not isinstance(subject, ControllerText) or not self.stands:
            return None
        loop = self.stands[0].bench.loop
        if not candidate.rulebases:
            gains = {name: list(values) for name, values in candidate.gains.items()}
            return loop.program_with(gains)
        controller = controller_of(controller_at(subject, candidate))
        from fuzzyarm.control.controllers.on_plant import controller_on

        return LoopProgram(controller_on(controller, loop.site), loop.arithmetic)

    def run(self, program: LoopProgram | None, at: int) -> ScenarioOutcome:
        """Run one scenario of a candidate."""
        assert program is not None
        stand = self.stands[at]
        try:
            if stand.bench.loop.compiled:
                return self._examined(program, stand)
            with self.lock:  # code of a user may have state
                return self._examined(program, stand)
        except FuzzyarmError as error:
            error.at(f"scenario {stand.scenario.name}")
            raise

    def _examined(self, program: LoopProgram, stand: _Stand) -> ScenarioOutcome:
        if isinstance(self.problem.cost, Cost) and self.problem.cost.is_brief:
            judged = stand.judged(program)
            return self._outcome(brief_values_of(judged), judged.diverged, stand)
        run = stand.run(program)
        return self._outcome(values_of(run), run.diverged, stand, run)

    def _outcome(
        self,
        values: Mapping[str, float],
        diverged: float | None,
        stand: _Stand,
        run: Run | None = None,
    ) -> ScenarioOutcome:
        error, chatter = values.get("rms", math.nan), values.get("chatter", math.nan)
        if diverged is not None:
            run_kept = run if self.own_cost is not None else None
            cost = lost(diverged, stand.duration)
            return ScenarioOutcome(cost, error, chatter, diverged=True, run=run_kept)
        if isinstance(self.problem.cost, Cost):
            return ScenarioOutcome(self.problem.cost.of(values), error, chatter)
        return ScenarioOutcome(0.0, error, chatter, run=run)

    def folded(self, outcomes: Sequence[ScenarioOutcome], candidate: Candidate) -> Score:
        """Make one score of the runs of a candidate, or of its errors on samples."""
        if not self.stands:
            return self._of_samples(candidate)
        parts = tuple(outcome.cost for outcome in outcomes)
        diverged = sum(outcome.diverged for outcome in outcomes)
        error = float(np.mean([outcome.error for outcome in outcomes]))
        chatter = float(np.mean([outcome.chatter for outcome in outcomes]))
        if self.own_cost is not None:
            runs = [outcome.run for outcome in outcomes]
            with self.lock:
                user_cost = value_of_user(self.own_cost, runs)
            return Score(user_cost + sum(parts), (), error, chatter, diverged)
        cost = max(parts) if self.problem.over == "worst" else float(np.mean(parts))
        return Score(cost, parts, error, chatter, diverged)

    def _of_samples(self, candidate: Candidate) -> Score:
        rulebase = self.design.rulebase_at(candidate)
        if self.own_cost is not None:
            with self.lock:
                return Score(value_of_user(self.own_cost, rulebase))
        assert isinstance(self.problem.cost, Cost)
        assert self.problem.samples is not None
        errors = errors_of(rulebase, self.problem.samples)
        return Score(self.problem.cost.of(errors), (), errors["rmse"])


def failed(error: FuzzyarmError) -> Score:
    """Return the score of a candidate that cannot be examined."""
    return Score(REFUSED, fault=str(error))


class ScenarioOutcome(NamedTuple):
    """The result of a scenario."""

    cost: float
    error: float = math.nan
    chatter: float = math.nan
    diverged: bool = False
    run: Run | None = None


class _Stand:
    """A prepared scenario: set points, plant, sensors."""

    def __init__(self, scenario: Scenario, controller: Controller, problem: TuningProblem) -> None:
        self.scenario = scenario
        changes = dict(scenario.changes)
        seed = changes.pop("seed", None)
        self.seed = None if seed is None else int(seed)
        experiment = Experiment(
            controller,
            scenario.way,
            None,
            changes,
            problem.conventions,
            problem.options,
            connect=problem.connect,
        )
        self.bench = Bench(experiment, [])
        course = self.bench.course(changes)
        if self.seed is not None and course.options.sensors:  # the noise is drawn once for all
            course = course.with_options(replace(course.options, seed=self.seed))
        self.course: Course = course
        motion = self.bench.motion
        self.duration = float(motion.iterations.sum()) * motion.period

    def run(self, program: LoopProgram) -> Run:
        return self.bench.loop.run(program, self.course, self.seed)

    def judged(self, program: LoopProgram) -> Judged:
        return self.bench.loop.judged(program, self.course, self.seed)


# --- Many candidates ---


class ExaminerPool:
    """Examines points in parallel, one for each worker.

    Parameters
    ----------
    problem : TuningProblem
        The problem.
    workers : int, optional
        Candidates examined at a time; by default one for each processor.
    executor : Executor, optional
        An executor of :mod:`concurrent.futures` in place of this process.

    Notes
    -----
    Machine code runs in threads of this process, plain Python in processes, if there are several
    points and several workers.
    """

    def __init__(
        self, problem: TuningProblem, workers: int | None = None, executor: Executor | None = None
    ) -> None:
        self.problem = problem
        self.examiner = Examiner(problem)
        self.design = self.examiner.design
        self.executor, self._elsewhere = executor, Workers(workers, executor)
        self.workers = self._elsewhere.count
        self._threads = Workers(self.workers, threads=True)
        self._question = b""

    def scores(self, points: Sequence[Vector], digits: int | None = None) -> list[Score]:
        """Examine points in order; a failing one gets a score with the reason, others continue."""
        # A single point would occupy one process: this one will do.
        alone = self.workers == 1 or (len(points) == 1 and not self._in_threads)
        if alone and self.executor is None:
            return [self.examiner.tried(point, digits) for point in points]
        if self.executor is not None or not self._in_threads:
            return self._examined(points, digits)
        # All scenarios of all points as they come: one point has work for several workers. Python
        # code runs in this thread, one candidate after the other, while the workers run machine
        # code without the GIL.
        begun: list[Callable[[], Score] | FuzzyarmError] = []
        for point in points:
            try:
                begun.append(self._begun(self.design.at(point, digits)))
            except FuzzyarmError as error:
                begun.append(error)
        return [_outcome_of(run) for run in begun]

    def score_of(self, candidate: Candidate) -> Score:
        """Examine a candidate, in threads of this process if possible; failures raise."""
        return self._begun(candidate)() if self._in_threads else self.examiner.score_of(candidate)

    @property
    def _in_threads(self) -> bool:
        return self.examiner.compiled or not self.examiner.stands

    def _begun(self, candidate: Candidate) -> Callable[[], Score]:
        """Submit a candidate to the workers; return a function that waits for its score."""
        examiner = self.examiner
        # The longest first, so that all workers finish together.
        stands = range(len(examiner.stands))
        ready = examiner.ready(candidate)
        running: dict[int, Future[ScenarioOutcome]] = {
            stand: self._threads.submit(examiner.run, ready, stand)
            for stand in sorted(stands, key=lambda stand: -examiner.stands[stand].duration)
        }
        return lambda: examiner.folded([running[stand].result() for stand in stands], candidate)

    def _examined(self, points: Sequence[Vector], digits: int | None) -> list[Score]:
        if not self._question:
            self._question = packed(self.problem)
        submit = self._elsewhere.submit
        futures = [submit(examine, self._question, np.array(point), digits) for point in points]
        try:
            with workers_watched():
                return [future.result() for future in futures]
        finally:
            for future in futures:
                future.cancel()

    def close(self) -> None:
        """End its own threads or processes."""
        self._threads.close()
        self._elsewhere.close()


@contextmanager
def panel(
    problem: TuningProblem, workers: int | None = None, executor: Executor | None = None
) -> Iterator[ExaminerPool]:
    """Give a :class:`ExaminerPool`, and close it."""
    pool = ExaminerPool(problem, workers, executor)
    try:
        yield pool
    finally:
        pool.close()


def _outcome_of(begun: Callable[[], Score] | FuzzyarmError) -> Score:
    """Wait for a score; a failure becomes a score with the reason."""
    try:
        return failed(begun) if isinstance(begun, FuzzyarmError) else begun()
    except FuzzyarmError as error:
        return failed(error)


def examine(question: bytes, point: Any, digits: int | None) -> Score:
    """Examine a point in any process; `question` is a problem as bytes."""
    return _examiner_of(question).tried(point, digits)


@lru_cache(maxsize=4)
def _examiner_of(question: bytes) -> Examiner:
    return Examiner(unpacked(question))
