"""After a search: round the numbers, judge them on unseen scenarios, and tune an opponent.

The search may have taken hours, so its result is delivered first, and a later failure becomes one
sentence beside it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from fuzzyarm.base.errors import FuzzyarmError, sentence_of
from fuzzyarm.control.loop.course import Options
from fuzzyarm.learning.tuning.cost import Cost
from fuzzyarm.learning.tuning.design import Candidate
from fuzzyarm.learning.tuning.examiner import ExaminerPool, Score, TuningProblem, panel
from fuzzyarm.learning.tuning.linear import NAME as LINEAR
from fuzzyarm.learning.tuning.result import ALL_DIGITS, JUDGEMENT, ComparedRow, Tuned, TuningPlan
from fuzzyarm.learning.tuning.search import Found, Journal, Promises, Search, Watch
from fuzzyarm.requests.bounds import MOST_TUNED_DIGITS

WORSE = 0.01
"""Relative growth of the cost by rounding that adds a digit."""


SHOWS, LISTENED = 0.01, 3
"""Relative change of the cost that shows noise, and the number of scenarios."""


class TuningJob(NamedTuple):
    """The problems of a tuning: search, judgement and opponent.

    Attributes
    ----------
    problem : TuningProblem
        The problem of the search.
    judged : dict of str to TuningProblem
        The same on ``unseen`` and ``noisy`` scenarios or samples.
    linear : dict of str to TuningProblem
        The same problems for the opponent; empty without one.
    cost : str
        The minimised cost, in words.
    names : dict of str to tuple of str
        Names of the scenarios: ``train`` of the search, ``unseen`` of the judgement.
    regression : dict
        Errors of linear regression on samples.
    alone : str
        Reason for a missing opponent, if one was requested.
    noises : tuple of (float, Options)
        Sizes of the noise with the options of the noisy problems, from the smallest: the first that
        shows is taken.
    noise : float
        The size of the noise of ``noisy``, as a share of each range; 0 without one.
    """

    problem: TuningProblem
    judged: dict[str, TuningProblem]
    linear: dict[str, TuningProblem]
    cost: str
    names: dict[str, tuple[str, ...]]
    regression: dict[str, dict[str, float]]
    alone: str = ""
    noises: tuple[tuple[float, Options], ...] = ()
    noise: float = 0.0


class Means(NamedTuple):
    """Means of a search, and the callbacks.

    `take` gets the result before its judgement; `tell` is called in each step after the search.
    """

    workers: int | None
    executor: Executor | None
    journal: Journal | None
    watch: Watch
    watch_linear: Watch
    take: Callable[[Tuned], None]
    tell: Callable[[str], None]


# --- Numbers as they are written ---


def rounded(
    examining: ExaminerPool, promises: Promises, result: Found, digits: int
) -> tuple[Candidate, int, Score]:
    """Return the best candidate with rounded numbers, scored again.

    A digit more is kept where rounding breaks a promise or costs more than one percent. Without a
    result the file is unchanged. If the rounding fails or is interrupted, the numbers stay
    unrounded.
    """
    best, design = result.best, examining.design
    if np.array_equal(best.point, design.start):
        return design.as_it_is(), digits, best.score
    try:
        for count in range(digits, MOST_TUNED_DIGITS + 1):
            candidate = design.at(best.point, count)
            if promises.expected(candidate) or promises.proof(candidate):
                continue
            score = _rescored(examining, candidate)  # in this process: the cluster may be gone
            worse = score.cost - best.score.cost > WORSE * abs(best.score.cost)
            worse |= score.cost > result.trials[0].score.cost  # keep the improvement
            if not score.fault and not worse:
                return candidate, count, score
    except KeyboardInterrupt:
        result.interrupted = True
    except Exception as error:
        result.fault = result.fault or f"rounding the numbers: {sentence_of(error)}"
    return design.at(best.point), ALL_DIGITS, best.score


def _rescored(examining: ExaminerPool, candidate: Candidate) -> Score:
    try:
        return examining.score_of(candidate)
    except FuzzyarmError as error:
        return Score(math.inf, fault=str(error))


# --- Judgement on unseen scenarios ---


def with_judgement(
    job: TuningJob, plan: TuningPlan, means: Means, tuned: Tuned, which: tuple[Candidate, Candidate]
) -> Tuned:
    """Return the result of a search with the rest of its table."""
    search, faults = tuned.found, list(tuned.faults)
    rows = [ComparedRow(row.name, dict(row.scores)) for row in tuned.rows]
    linear, line = None, None
    job = _in_time(job, plan, search)
    try:
        with _errors_noted(faults, "the size of the noise"):
            job = _audible(job, which[0])
        for row, candidate in zip(rows, which, strict=True):
            _judge(row, job.judged, candidate, means, faults)
        if job.linear and not search.interrupted and not search.fault:
            with _errors_noted(faults, "the linear controller"):
                linear, line, row = _linear(job.linear["train"], plan, means)
                rows.append(row)
            if line is not None:
                others = {name: job.linear[name] for name in job.judged}
                _judge(rows[-1], others, line, means, faults)
    except KeyboardInterrupt:  # keep the result even without its judgement
        search.interrupted = True
    if job.regression:
        assert isinstance(job.problem.cost, Cost)
        scores = {
            key: Score(job.problem.cost.of(regression))
            for key, regression in job.regression.items()
        }
        rows.append(ComparedRow("linear regression", scores))
    return replace(
        tuned,
        rows=tuple(rows),
        unseen=job.names["unseen"],
        linear=linear,
        alone=job.alone,
        line=line,
        faults=tuple(faults),
        noise=job.noise if "noisy" in job.judged else 0.0,
    )


def _audible(job: TuningJob, candidate: Candidate) -> TuningJob:
    """Return a job with the smallest noise that shows in the cost of a candidate."""
    if not job.noises or "noisy" not in job.judged:
        return job

    def cost(problem: TuningProblem) -> float:
        few = replace(problem, scenarios=problem.scenarios[:LISTENED])
        with panel(few, 1) as examining:
            return _rescored(examining, candidate).cost

    quiet, noisy = cost(job.judged["unseen"]), job.judged["noisy"]
    chosen = job.noise
    for chosen, options in job.noises:  # noqa: B007
        noisy = replace(noisy, options=options)
        if not abs(cost(noisy) - quiet) < SHOWS * abs(quiet):
            break
    linear = dict(job.linear)
    if "noisy" in linear:
        linear["noisy"] = replace(linear["noisy"], options=noisy.options)
    return job._replace(judged={**job.judged, "noisy": noisy}, linear=linear, noise=chosen)


def _in_time(job: TuningJob, plan: TuningPlan, result: Found) -> TuningJob:
    """Return a job with as many unseen scenarios as the time allows, and at least one."""
    count, seconds = len(job.names["unseen"]), plan.budget.seconds
    if not math.isfinite(seconds) or not job.judged or not job.problem.scenarios:
        return job
    runs = len(result.trials) * len(job.problem.scenarios)
    room = JUDGEMENT * seconds * runs / max(result.seconds, 1e-9)
    rows = 3 if job.linear else 2
    fitting = min(count, int(room / (rows * len(job.judged))))
    sets = job.judged if fitting else {"unseen": job.judged["unseen"]}
    fitting = max(fitting, 1)

    def cut(problem: TuningProblem) -> TuningProblem:
        return replace(problem, scenarios=problem.scenarios[:fitting])

    return job._replace(
        judged={name: cut(scenarios) for name, scenarios in sets.items()},
        linear={
            name: scenarios if name == "train" else cut(scenarios)
            for name, scenarios in job.linear.items()
        },
        names={**job.names, "unseen": job.names["unseen"][:fitting]},
    )


def _judge(
    row: ComparedRow,
    sets: Mapping[str, TuningProblem],
    candidate: Candidate,
    means: Means,
    faults: list[str],
) -> None:
    """Add to a row the costs of a candidate on unseen scenarios."""
    for name, problem in sets.items():
        means.tell(f"{row.name}: {_what(problem, name)}")
        with (
            _errors_noted(faults, f"{row.name}, {name}"),
            panel(problem, means.workers, means.executor) as examining,
        ):
            row.scores[name] = examining.score_of(candidate)


def _what(problem: TuningProblem, name: str) -> str:
    count = len(problem.scenarios)
    what = f"unseen scenarios, {count}" if count else "unseen samples"
    return f"{what}, with noise" if name == "noisy" else what


@contextmanager
def _errors_noted(faults: list[str], what: str) -> Iterator[None]:
    """Turn any exception into a sentence."""
    try:
        yield
    except Exception as error:
        faults.append(f"{what}: {sentence_of(error)}")


def _linear(
    problem: TuningProblem, plan: TuningPlan, means: Means
) -> tuple[Found, Candidate, ComparedRow]:
    """Tune the linear opponent on the same cost and scenarios, with the same effort."""
    with panel(problem, means.workers, means.executor) as examining:
        budget = plan.shared(judged=plan.unseen > 0, linear=True)
        search = Search(examining, None, budget, watch=means.watch_linear)
        result = search.run(plan.method, plan.seed)
        if result.interrupted:
            raise KeyboardInterrupt
        if result.fault:
            raise OpponentError(result.fault)
        candidate, _, score = rounded(examining, Promises({}), result, plan.digits)
    return result, candidate, ComparedRow(LINEAR, {"train": score})


class OpponentError(FuzzyarmError, RuntimeError):
    """The search of the linear opponent has ended before its time."""
