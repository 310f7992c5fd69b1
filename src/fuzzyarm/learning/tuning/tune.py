"""Tune a controller or a rule base: search, round, judge on unseen scenarios."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from typing import Any, TypedDict, Unpack

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.keywords import demand_alone, demand_arguments
from fuzzyarm.base.value_kinds import MODEL, wrong_kind
from fuzzyarm.control.controllers.catalogue import controller_of
from fuzzyarm.control.controllers.findings import site_by_axes
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.control.loop.along import FollowedPlant, equipped, way_of
from fuzzyarm.control.loop.course import Options
from fuzzyarm.control.loop.reference import AnySignal, AnyTime, as_seconds, as_signals
from fuzzyarm.control.loop.run import plant_motion, stepped
from fuzzyarm.control.loop.sweeps import cluster
from fuzzyarm.language.model.rulebase import AnyRuleBase, RuleBase, Tuning
from fuzzyarm.language.tokens import Cursor, Trivia, tokenize_line
from fuzzyarm.learning.data import Samples, read_samples
from fuzzyarm.learning.fit import linear_outputs
from fuzzyarm.learning.tuning.cost import ERRORS, OwnCost, errors_between, read_cost
from fuzzyarm.learning.tuning.examiner import Over, TuningProblem, panel
from fuzzyarm.learning.tuning.judging import Means, TuningJob, rounded, with_judgement
from fuzzyarm.learning.tuning.linear import opponent
from fuzzyarm.learning.tuning.movement import TuneError
from fuzzyarm.learning.tuning.orders import Order, columns_for, longest, order_of
from fuzzyarm.learning.tuning.result import ComparedRow, Method, Tuned, TuningPlan, notes_of
from fuzzyarm.learning.tuning.scenarios import (
    NOISES,
    Scenario,
    Stage,
    plant_scenarios,
    scenario_along,
    train_scenarios,
    unseen_scenarios,
)
from fuzzyarm.learning.tuning.search import Budget, Journal, Promises, Search, Watch
from fuzzyarm.learning.tuning.text import Originals, changes_of, originals_of, rewritten
from fuzzyarm.plant.plant import Plant
from fuzzyarm.plant.setting import PLAIN, Conventions
from fuzzyarm.plant.trajectory import Trajectory
from fuzzyarm.requests.fields import read_fields
from fuzzyarm.requests.tune import TuneRequest

Vector = NDArray[np.float64]

DEFAULT_COST = "rms"
DEFAULT_DATA_COST = "rmse"

# --- The whole way ---


class TuneKeywords(TypedDict, total=False):
    """Keywords of `tune`.

    Attributes
    ----------
    trajectory : Trajectory or str
        The only trajectory of the plant to tune on.
    cost : str or callable
        Cost to minimise: a formula of metrics, as in ``"rms + 0.002*variation"`` (for samples
        of ``rmse``, ``mae`` and ``worst``), or a function of all runs (for a rule base alone: of
        the rule base). The RMS error by default.
    data, test : Samples, str or path-like
        Samples, or their file, for fitting and for judging a rule base alone. Without `test` a
        fifth of the data is held back.
    scenarios : int or sequence of Scenario
        Number of tuning scenarios: requested ones first, then random ones. By default the requested
        ones alone.
    over : {"mean", "worst"}
        How their costs become one.
    stage : Stage
        Plant, references, sensors, and random quantities of scenarios; instead of `plant` and the
        following keywords here.
    reference, step, duration, connect, options, conventions
        See :func:`fuzzyarm.control.loop.simulate`.
    tune : Tuning or sequence of str
        Movable numbers, in place of those of the file: lines of a ``tune`` block.
    method : {"nelder-mead", "cma-es", "evolution"}
        See :data:`fuzzyarm.learning.tuning.optimisers.OPTIMISERS`.
    evals : int
        Candidates of the search, and of the opponent's; 500 by default.
    time : float or str
        Wall time of the whole: s, or with its unit, as in ``"2min"``.
    seed : int
        Seed of all random numbers; 1 by default.
    digits : int
        Significant digits of the written numbers; 3 by default.
    unseen : int
        Scenarios of the judgement; 24 by default.
    linear : bool
        Whether a linear opponent is tuned on the same.
    workers, executor
        See :func:`fuzzyarm.control.loop.simulate_many`; no result depends on them.
    journal : Journal
        Where every trial is written down.
    watch, watch_linear : callable
        Called after each examination of the search, and of that for the linear opponent.
    take : callable
        Called with the result of the search and its texts before the judgement: so it can be
        written whatever fails afterwards.
    tell : callable
        Called with a description of each step after the search.
    text : str
        Text of the file, if it differs from that on disk.
    """

    trajectory: Trajectory | str | None
    cost: str | OwnCost | None
    data: Samples | str | os.PathLike[str] | None
    test: Samples | str | os.PathLike[str] | None
    scenarios: int | Sequence[Scenario] | None
    over: Over
    stage: Stage | None
    reference: Mapping[str, AnySignal] | None
    step: float | None
    duration: AnyTime | None
    connect: Mapping[str, str] | None
    tune: Tuning | Sequence[str] | None
    method: Method
    evals: int
    time: AnyTime
    seed: int
    digits: int
    unseen: int
    linear: bool
    options: Options | None
    conventions: Conventions
    workers: int | None
    executor: Executor | None
    journal: Journal | None
    watch: Watch
    watch_linear: Watch
    take: Callable[[Tuned], None]
    tell: Callable[[str], None]
    text: str


OF_THE_REQUEST = ("method", "evals", "seed", "digits", "unseen", "over", "workers")
"""Keywords checked as fields of a request."""


def tune(
    subject: ControllerText | AnyRuleBase | TuneRequest | str | os.PathLike[str],
    plant: Plant | Trajectory | str | os.PathLike[str] | None = None,
    **keywords: Unpack[TuneKeywords],
) -> Tuned:
    """Tune the gains of a controller and the terms of its rule bases, or of a rule base alone.

    Parameters
    ----------
    subject : ControllerText, RuleBase, path-like or TuneRequest
        The subject. A controller runs in its loop, a rule base alone is fitted to samples. A
        request holds all settings of ``fuzzyarm tune`` except the output file.
    plant : Plant, Trajectory, str or path-like, optional
        Its plant; by default the shipped plant with its axes. A plant with trajectories follows
        those for comparing controllers, unless a trajectory or references are given.
    **keywords
        Cost: ``cost``, ``data``, ``test``; scenarios: ``scenarios``, ``over``, ``trajectory``,
        ``reference``, ``step``, ``duration``, ``connect``, ``options``, ``conventions``, ``stage``;
        search: ``tune``, ``method``, ``evals``, ``time``, ``seed``, ``digits``, ``unseen``,
        ``linear``, ``workers``, ``executor``, ``journal``; callbacks: ``watch``, ``watch_linear``,
        ``take``, ``tell``. See :class:`~fuzzyarm.learning.tuning.tune.TuneKeywords`.

    Returns
    -------
    Tuned
        Ctrl-C ends the search only: the best so far is rounded and judged. A linear opponent whose
        search was interrupted is omitted. Failures after the first candidate are not raised; they
        are listed in `faults`.

    Raises
    ------
    TuneError
        If nothing may move, or the arguments do not fit.
    RequestError
        If a number is out of range.

    Examples
    --------
    >>> import fuzzyarm
    >>> tuned = fuzzyarm.tune(
    ...     fuzzyarm.shipped("heater.frb"), evals=8, unseen=2, linear=False, workers=1
    ... )
    >>> tuned.found.best.score.cost <= tuned.found.trials[0].score.cost
    True
    """
    demand_arguments("tune", keywords, TuneKeywords, ("subject", "plant"), OF_THE_REQUEST)
    if isinstance(subject, TuneRequest):
        return _tuned_by(subject, plant, keywords)
    fields = read_fields(TuneRequest, keywords, OF_THE_REQUEST)
    plan = TuningPlan(
        fields["method"],
        Budget(fields["evals"], as_seconds(keywords.get("time", math.inf), "time")),
        fields["seed"],
        fields["digits"],
        fields["unseen"],
        keywords.get("linear", True),
    )
    path, model = _loaded(subject)
    problem = keywords.get("tune")
    moving = problem if isinstance(problem, Tuning) or problem is None else read_tuning(problem)
    if isinstance(model, RuleBase):
        job = _on_samples(model, moving, keywords, plan.seed)
    else:
        job = _in_loop(model, moving, plant, plan, keywords)
    return _done(
        job,
        plan,
        _means(keywords, fields["workers"]),
        originals_of(model, path, keywords.get("text", "")),
    )


LISTENERS = ("watch", "watch_linear", "take", "tell")
"""The callbacks: the only keywords that may accompany a request."""


def _tuned_by(request: TuneRequest, plant: object, keywords: TuneKeywords) -> Tuned:
    """Tune according to a request."""
    demand_alone("tune", plant, {name for name in keywords if name not in LISTENERS} or None)
    order = order_of(request)
    with cluster(request) as (executor, workers):
        whole = keywords_of(request, order)
        whole.update(keywords)
        whole.update({"executor": executor, "workers": workers})
        return tune(order.path, **whole)


def keywords_of(request: TuneRequest, order: Order) -> TuneKeywords:
    """Return the settings of a request as keywords."""
    keywords: TuneKeywords = {
        "cost": request.cost,
        "tune": request.tune or None,
        "method": request.method,
        "evals": request.evals,
        "time": longest(request),
        "seed": request.seed,
        "digits": request.digits,
        "unseen": request.unseen,
        "linear": request.linear,
        "over": request.over,
        "scenarios": request.scenarios,
        "stage": order.stage,
        "conventions": order.conventions,
        "journal": order.journal,
    }
    return {**keywords, "data": order.samples.get("data"), "test": order.samples.get("test")}


def _means(keywords: TuneKeywords, workers: int | None) -> Means:
    return Means(
        workers,
        keywords.get("executor"),
        keywords.get("journal"),
        keywords.get("watch", _unheard),
        keywords.get("watch_linear", _unheard),
        keywords.get("take", _unheard),
        keywords.get("tell", _unheard),
    )


def _unheard(_news: object) -> None:
    """Do nothing: the default callback."""


def _loaded(
    subject: ControllerText | AnyRuleBase | str | os.PathLike[str],
) -> tuple[str, ControllerText | RuleBase]:
    if isinstance(subject, ControllerText):
        return subject.path, subject
    if isinstance(subject, AnyRuleBase):
        return "", subject.model
    from fuzzyarm.base import above

    if not isinstance(subject, str | os.PathLike):
        raise wrong_kind(subject, MODEL)
    model = above.function("load")(subject)
    if not isinstance(model, ControllerText | RuleBase):
        raise TuneError(f"{subject} is a table; a controller or a rule base is tuned")
    return os.fspath(subject), model


def read_tuning(lines: Sequence[str]) -> Tuning:
    """Read lines of a ``tune`` block from Python; TuneError if one cannot be read."""
    from fuzzyarm.language.model.rulebase import GainTuning, PeakTuning
    from fuzzyarm.language.tokens import Fault
    from fuzzyarm.language.tune import TUNE_ROW

    peaks, gains, kept_terms = list[PeakTuning](), list[GainTuning](), list[tuple[str, str]]()
    for line in lines:
        diagnostics: list[Any] = []
        tokens = tokenize_line(1, line, diagnostics).tokens
        if not tokens or diagnostics:
            raise TuneError(f"'{line}' is not a line of a tune block", hint=TUNE_HINT)
        try:
            item = TUNE_ROW.read_line(Cursor(tokens), Trivia())
        except Fault as fault:
            message = f"'{line}': {fault.diagnostic.message}"
            raise TuneError(message, hint=fault.diagnostic.hint or TUNE_HINT) from None
        names = tuple(word for word in item.names)
        words = item.words
        if item.key == "peaks":
            flags = ("mirrored" in words, "keep order" in words, "partition" in words)
            tuning = PeakTuning(names, *flags)
            peaks.append(tuning if item.gap is None else replace(tuning, gap=item.gap / 100.0))
        elif item.key == "gain":
            assert item.low is not None
            assert item.high is not None
            if not item.low < item.high:
                message = "the range of a gain must go from a lower to a higher number"
                raise TuneError(f"'{line}': {message}", hint=TUNE_HINT)
            if {"log", "times"} & set(words) and item.low <= 0.0:
                message = "a range of multiples, or of steps of the logarithm, begins above 0"
                raise TuneError(f"'{line}': {message}", hint=TUNE_HINT)
            flags = ("times" in words, "log" in words, "per axis" in words)
            gains.append(GainTuning(names, item.low, item.high, *flags))
        else:
            kept_terms += [(names[0], term) for term in item.terms] or [(names[0], "")]
    return Tuning(tuple(peaks), tuple(gains), tuple(kept_terms))


TUNE_HINT = "as in  peaks e, ce mirrored, partition  or  gain G_e 0.1 .. 10 times"


def stage_of(
    text: ControllerText,
    plant: Plant | Trajectory | str | os.PathLike[str] | None,
    keywords: TuneKeywords,
    seed: int = 1,
) -> Stage:
    """Return the stage of a controller, by the keywords of `tune`."""
    options = keywords.get("options") or Options(seed=seed)
    reference, step = keywords.get("reference"), keywords.get("step")
    duration, connect = keywords.get("duration"), keywords.get("connect")
    trajectory = keywords.get("trajectory")
    if plant is None:
        site = site_by_axes(text.model)
        if site is None:
            raise TuneError(f"no shipped plant has the axes of {text.model.name}", hint="name one")
        plant = site.name
    referred = bool(reference) or step is not None or duration is not None
    way = way_of(plant, trajectory, referred=referred)
    assert isinstance(way, FollowedPlant)
    home = equipped(way.plant, options)
    if way.trajectory is not None:
        only = isinstance(plant, Trajectory) or trajectory is not None
        first = (scenario_along(home, way.trajectory, 1.0),) if only else plant_scenarios(home, 1.0)
        return Stage(home, first, options, connect=connect)
    controller = controller_of(text)
    if step is not None:
        reference = stepped(controller, home, step, reference, connect)
    signals = as_signals(reference)
    seconds = None if duration is None else as_seconds(duration, "duration")
    motion = plant_motion(controller, home, signals, seconds, connect)
    first = (Scenario(motion.name, motion),)
    return Stage(home, first, options, (), signals, seconds, connect)


def _in_loop(
    text: ControllerText,
    tuning: Tuning | None,
    plant: Plant | Trajectory | str | os.PathLike[str] | None,
    plan: TuningPlan,
    keywords: TuneKeywords,
) -> TuningJob:
    stage = keywords.get("stage") or stage_of(text, plant, keywords, plan.seed)
    cost = keywords.get("cost")
    wish = DEFAULT_COST if cost is None else cost
    criterion = read_cost(wish) if isinstance(wish, str) else wish
    controller = controller_of(text)
    scenarios = keywords.get("scenarios")
    if scenarios is None or isinstance(scenarios, int):
        count = read_fields(TuneRequest, keywords, ("scenarios",))["scenarios"]
        train = train_scenarios(stage, count or len(stage.first), controller)
    else:
        train = tuple(scenarios)
    problem = TuningProblem(
        text,
        tuning,
        criterion,
        train,
        over=keywords.get("over", "mean"),
        conventions=keywords.get("conventions", PLAIN),
        options=stage.options,
        connect=stage.connect,
    )
    judged: dict[str, TuningProblem] = {}
    noises: tuple[tuple[float, Options], ...] = ()
    if plan.unseen:
        unseen = unseen_scenarios(stage, plan.unseen, controller)
        judged["unseen"] = replace(problem, scenarios=unseen)
        # A stage with its own noise was already judged with noise.
        if not stage.has_noise:
            noises = tuple((share, stage.noisy(share).options) for share in NOISES)
            judged["noisy"] = replace(problem, scenarios=unseen, options=noises[0][1])
    linear, alone = {}, ""
    if plan.linear:
        try:
            other, moving = opponent(text, stage.plant, tuning)
        except TuneError as error:
            # Tuning is worthwhile without an opponent; the report has the reason.
            alone = error.message
        else:
            sets = {"train": problem, **judged}
            linear = {key: replace(p, subject=other, tuning=moving) for key, p in sets.items()}
    unseen_names = tuple(scenario.name for scenario in judged["unseen"].scenarios) if judged else ()
    names = {"train": tuple(scenario.name for scenario in train), "unseen": unseen_names}
    return TuningJob(problem, judged, linear, _cost_name(wish), names, {}, alone, noises, NOISES[0])


def _cost_name(cost: str | OwnCost) -> str:
    return cost if isinstance(cost, str) else getattr(cost, "__name__", type(cost).__name__)


KEPT_BACK = 5
"""One in so many samples is held out for the judgement, without test samples."""

NOISE_SHARE = 0.01
"""Standard deviation of the noise in the judgement, as a share of the ranges of the inputs."""


def _on_samples(
    rulebase: RuleBase, tuning: Tuning | None, keywords: TuneKeywords, seed: int
) -> TuningJob:
    cost = keywords.get("cost")
    data = _samples(keywords.get("data"), rulebase)
    test = _samples(keywords.get("test"), rulebase)
    is_own = callable(cost) or (cost is not None and ".py:" in cost)
    if data is None and not is_own:
        message = f"'{rulebase.name}' is a rule base alone: nothing says what is good"
        hint = "give samples, or tune the controller that uses it"
        raise TuneError(message, hint=hint)
    text = cost if cost is not None else DEFAULT_DATA_COST
    criterion = read_cost(text, tuple(ERRORS)) if isinstance(text, str) else text
    name = _cost_name(text)
    if data is None:
        nothing: dict[str, tuple[str, ...]] = {"train": (), "unseen": ()}
        return TuningJob(TuningProblem(rulebase, tuning, criterion), {}, {}, name, nothing, {})
    data = _fitting(data, rulebase)
    if test is None:
        order = np.random.default_rng(seed).permutation(len(data))
        # Sorted: samples in the order of the file.
        data, test = (
            data.part(np.sort(order[len(data) // KEPT_BACK :])),
            data.part(np.sort(order[: len(data) // KEPT_BACK])),
        )
    else:
        test = _fitting(test, rulebase)
    if not len(data) or not len(test):
        raise TuneError("too few samples to keep some back", hint="give others to judge by")
    noisy = _with_noise(test, seed)
    problem = TuningProblem(rulebase, tuning, criterion, samples=data)
    sets = {"train": data, "unseen": test, "noisy": noisy}
    judged = {key: replace(problem, samples=sets[key]) for key in ("unseen", "noisy")}
    regression = {
        key: errors_between(linear_outputs(data, samples)[:, 0], samples.values)
        for key, samples in sets.items()
    }
    shown: dict[str, tuple[str, ...]] = {
        key: (f"{len(samples)} samples",) for key, samples in sets.items()
    }
    return TuningJob(problem, judged, {}, name, shown, regression, noise=NOISE_SHARE)


def _samples(
    samples: Samples | str | os.PathLike[str] | None, rulebase: RuleBase
) -> Samples | None:
    """Return the samples of a rule base, read from their file if given as one."""
    if isinstance(samples, str | os.PathLike):
        return read_samples(samples, columns_for(os.fspath(samples), rulebase))
    return samples


def _fitting(samples: Samples, rulebase: RuleBase) -> Samples:
    """Return samples in the words of a rule base."""
    if samples.classes:
        raise TuneError("a target of words is learned by fuzzyarm fit, not tuned")
    inputs = [variable.name for variable in rulebase.inputs]
    missing = [name for name in inputs if name not in samples.names]
    outputs = [output.name for output in rulebase.outputs]
    if missing:
        hint = f"there are {', '.join(samples.names)}"
        raise TuneError(f"the samples have no column '{missing[0]}'", name=missing[0], hint=hint)
    target = samples.target
    if target not in outputs:
        if len(outputs) > 1:
            hint = f"its outputs are {', '.join(outputs)}"
            raise TuneError(f"'{rulebase.name}' has no output '{target}'", name=target, hint=hint)
        target = outputs[0]
    columns = [samples.names.index(name) for name in inputs]
    return replace(samples, names=tuple(inputs), inputs=samples.inputs[:, columns], target=target)


def _with_noise(samples: Samples, seed: int) -> Samples:
    generator = np.random.default_rng([seed, 2])
    spread = NOISE_SHARE * np.ptp(samples.inputs, axis=0)
    noise = generator.standard_normal(samples.inputs.shape) * spread
    return replace(samples, inputs=samples.inputs + noise)


# --- Search, and the steps after it ---


def _done(job: TuningJob, plan: TuningPlan, means: Means, originals: Originals) -> Tuned:
    """Search, round and report; then judge, whose failures do not undo the result."""
    with panel(job.problem, means.workers, means.executor) as examining:
        design = examining.design
        promises = Promises(design.as_it_is().rulebases)
        budget = plan.shared(judged=bool(job.judged), linear=bool(job.linear))
        search = Search(examining, promises, budget, means.journal, means.watch)
        try:
            result = search.run(plan.method, plan.seed)
        finally:
            if means.journal is not None:
                means.journal.lines.close()
        candidate, digits, score = rounded(examining, promises, result, plan.digits)
    rows = [
        ComparedRow("as in the file", {"train": result.trials[0].score}),
        ComparedRow("tuned", {"train": score}),
    ]
    tuning = Tuned(
        subject=job.problem.subject,
        candidate=candidate,
        parameters=design.parameters,
        found=result,
        digits=digits,
        rows=tuple(rows),
        on_a_bound=tuple(design.on_a_bound(result.best.point)),
        changes=tuple(changes_of(job.problem.subject, design.sheets, candidate)),
        files=(),
        cost=job.cost,
        scenarios=job.names["train"],
        unseen=(),
        linear=None,
        plan=plan,
        over=job.problem.over,
        notes=(),
        faults=(result.fault,) if result.fault else (),
    )
    tuning = _written(tuning, originals)
    # Passed on before the judgement, which may take long, fail or be interrupted.
    means.take(tuning)
    after = with_judgement(job, plan, means, tuning, (design.as_it_is(), candidate))
    # The judgement adds to the comments in the files, so the texts are written again.
    return _written(after, originals)


def _written(tuned: Tuned, originals: Originals) -> Tuned:
    """Return it with its texts and their comments."""
    notes = tuple(notes_of(tuned))
    files = rewritten(tuned.subject, tuned.candidate, originals, notes)
    return replace(tuned, files=tuple(files), notes=notes)
