"""Tune a controller or a rule base: search, round, judge by what was not seen, write it down."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.controller.catalogue import controller_of
from fuzzyarm.controller.findings import site_by_axes
from fuzzyarm.controller.text import ControllerText
from fuzzyarm.language.tokens import Cursor, Trivia, tokenize_line
from fuzzyarm.learning.data import Samples
from fuzzyarm.learning.fit import linear_outputs
from fuzzyarm.loop.along import Way, equipped, way_of
from fuzzyarm.loop.course import Options
from fuzzyarm.loop.reference import AnySignal, AnyTime, as_seconds, as_signals
from fuzzyarm.loop.run import plant_motion
from fuzzyarm.loop.sweep import Range
from fuzzyarm.model.rulebase import AnyRuleBase, RuleBase, Tuning
from fuzzyarm.plant.plant import Plant
from fuzzyarm.plant.setting import PLAIN, Conventions
from fuzzyarm.plant.trajectory import Trajectory
from fuzzyarm.text.mistaken import MODEL, wrong_kind
from fuzzyarm.tuning.cost import (
    ERRORS,
    OwnCost,
    errors_between,
    read_cost,
)
from fuzzyarm.tuning.examiner import Over, Problem, panel
from fuzzyarm.tuning.judging import Job, Means, rounded, with_judgement
from fuzzyarm.tuning.linear import opponent
from fuzzyarm.tuning.movement import TuneError
from fuzzyarm.tuning.promises import Promises
from fuzzyarm.tuning.scenarios import (
    Scenario,
    Stage,
    plant_scenarios,
    scenario_along,
    train_scenarios,
    unseen_scenarios,
)
from fuzzyarm.tuning.search import Budget, Journal, Search, Watch
from fuzzyarm.tuning.text import Originals, changes_of, originals_of, rewritten
from fuzzyarm.tuning.tuned import UNSEEN, Method, Plan, Row, Tuned, notes_of

Vector = NDArray[np.float64]

DEFAULT_COST = "rms"
DEFAULT_DATA_COST = "rmse"

# --- The whole way ---


def tune(
    subject: ControllerText | AnyRuleBase | str | os.PathLike[str],
    on: Plant | Trajectory | str | os.PathLike[str] | None = None,
    *,
    along: Trajectory | str | None = None,
    cost: str | OwnCost | None = None,
    data: Samples | None = None,
    test: Samples | None = None,
    scenarios: int | Sequence[Scenario] | None = None,
    over: Over = "mean",
    stage: Stage | None = None,
    references: Mapping[str, AnySignal] | None = None,
    duration: AnyTime | None = None,
    connect: Mapping[str, str] | None = None,
    tuning: Tuning | Sequence[str] | None = None,
    method: Method = "nelder-mead",
    evals: int = 500,
    seconds: AnyTime = math.inf,
    seed: int = 1,
    digits: int = 3,
    unseen: int = UNSEEN,
    linear: bool = True,
    options: Options | None = None,
    conventions: Conventions = PLAIN,
    workers: int | None = None,
    executor: Executor | None = None,
    journal: Journal | None = None,
    watch: Watch = lambda _found: None,
    watch_linear: Watch = lambda _found: None,
    take: Callable[[Tuned], None] = lambda _tuned: None,
    tell: Callable[[str], None] = lambda _words: None,
    text: str = "",
) -> Tuned:
    """Tune the gains of a controller and the terms of its rule bases, or of a rule base alone.

    Parameters
    ----------
    subject : ControllerText, RuleBase or path-like
        What is tuned. A controller runs in its loop, a rule base alone is fitted to samples.
    on : Plant, Trajectory, str or path-like, optional
        Where it runs; by default the shipped plant that has its axes. One that has trajectories
        follows those by which it has controllers compared, unless one or references are given.
    along : Trajectory or str, optional
        The only trajectory of the plant to tune on.
    cost : str or callable, optional
        What is to become small: a formula of metrics, as in ``"rms + 0.002*variation"`` (of
        samples of ``rmse``, ``mae`` and ``worst``), or a function of all runs (of a rule base
        alone: of the rule base). The RMS error by default.
    data, test : Samples, optional
        What a rule base alone is fitted to, and is judged by. Without `test` a fifth of the data
        is kept back.
    scenarios : int or sequence of Scenario, optional
        How many are tuned on: what is asked for first, then drawn ones. By default those that are
        asked for alone.
    over : {"mean", "worst"}, optional
        How their costs become one.
    stage : Stage, optional
        Plant, references, sensors, and what differs from scenario to scenario; instead of `on`
        and what stands behind it here.
    references, duration, connect
        See :func:`fuzzyarm.loop.simulate`.
    tuning : Tuning or sequence of str, optional
        What may move, in place of what the file says: lines of a ``tune`` block.
    method : {"nelder-mead", "cma-es", "evolution"}, optional
        See :data:`fuzzyarm.tuning.optimisers.OPTIMISERS`.
    evals : int, optional
        Candidates of the search, and of the opponent's.
    seconds : float or str, optional
        Wall time of the whole: s, or with its unit, as in ``"2min"``.
    seed : int, optional
        Of everything that is drawn.
    digits : int, optional
        Significant ones of the numbers that are written.
    unseen : int, optional
        Scenarios of the judgement.
    linear : bool, optional
        Whether a linear opponent is tuned on the same.
    options, conventions
        See :func:`fuzzyarm.loop.simulate`.
    workers, executor : optional
        See :func:`fuzzyarm.loop.simulate_many`; no result depends on them.
    journal : Journal, optional
        Where every trial is written down.
    watch, watch_linear : callable, optional
        Told of the search after each examination, and of that of the linear opponent.
    take : callable, optional
        Given what the search has found, with its texts, before anything is judged: whatever
        fails afterwards, it can be written.
    tell : callable, optional
        Told in words what follows the search.
    text : str, optional
        Of the file, where it is not what stands on disk.

    Returns
    -------
    Tuned
        Ctrl-C ends the search, not the way: the best so far is rounded and judged. A linear
        opponent whose search was ended is left out. What fails once a candidate besides the file
        was examined is not raised, but stands in `faults`.

    Raises
    ------
    TuneError
        If nothing may move, or what is asked for does not fit.

    Examples
    --------
    >>> import fuzzyarm
    >>> tuned = fuzzyarm.tune(
    ...     fuzzyarm.shipped("heater.frb"), evals=8, unseen=2, linear=False, workers=1
    ... )
    >>> tuned.found.best.score.cost <= tuned.found.trials[0].score.cost
    True
    """
    plan = Plan(method, Budget(evals, as_seconds(seconds, "seconds")), seed, digits, unseen, linear)
    path, model = _loaded(subject)
    moving = tuning if isinstance(tuning, Tuning) or tuning is None else read_tuning(tuning)
    if isinstance(model, RuleBase):
        if data is None and not callable(cost):
            message = f"'{model.name}' is a rule base alone: nothing says what is good"
            hint = "give samples, or tune the controller that uses it"
            raise TuneError(message, hint=hint)
        job = _on_samples(model, moving, cost, data, test, seed)
    else:
        options = options or Options(seed=seed)
        stage = stage or stage_of(model, on, options, references, duration, connect, along=along)
        job = _in_loop(model, moving, cost, stage, scenarios, plan, over, conventions)
    means = Means(workers, executor, journal, watch, watch_linear, take, tell)
    return _done(job, plan, means, originals_of(model, path, text))


def _loaded(
    subject: ControllerText | AnyRuleBase | str | os.PathLike[str],
) -> tuple[str, ControllerText | RuleBase]:
    if isinstance(subject, ControllerText):
        return subject.path, subject
    if isinstance(subject, AnyRuleBase):
        return "", subject.model
    from fuzzyarm.api import load

    if not isinstance(subject, str | os.PathLike):
        raise wrong_kind(subject, MODEL)
    model = load(subject)
    if not isinstance(model, ControllerText | RuleBase):
        raise TuneError(f"{subject} is a table; a controller or a rule base is tuned")
    return os.fspath(subject), model


def read_tuning(lines: Sequence[str]) -> Tuning:
    """Read lines of a ``tune`` block that stand in no file.

    Raises
    ------
    TuneError
        If one is not such a line.
    """
    from fuzzyarm.language.tokens import Fault
    from fuzzyarm.language.tune import TUNE_ROW
    from fuzzyarm.model.rulebase import GainTuning, PeakTuning

    peaks, gains, kept = list[PeakTuning](), list[GainTuning](), list[tuple[str, str]]()
    for line in lines:
        found: list[Any] = []
        tokens = tokenize_line(1, line, found).tokens
        if not tokens or found:
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
            kept += [(names[0], term) for term in item.terms] or [(names[0], "")]
    return Tuning(tuple(peaks), tuple(gains), tuple(kept))


TUNE_HINT = "as in  peaks e, ce mirrored, partition  or  gain G_e 0.1 .. 10 times"


def stage_of(
    text: ControllerText,
    on: Plant | Trajectory | str | os.PathLike[str] | None,
    options: Options,
    references: Mapping[str, AnySignal] | None = None,
    duration: AnyTime | None = None,
    connect: Mapping[str, str] | None = None,
    vary: Sequence[Range] = (),
    payload: float = 1.0,
    along: Trajectory | str | None = None,
) -> Stage:
    """Return where a controller runs, if nothing else is said.

    Parameters
    ----------
    text : ControllerText
        The controller.
    on : Plant, Trajectory or str, optional
        The plant; by default the shipped one that has its axes. A trajectory alone is of the arm.
    options : Options
        Sensors, seed and the rest of how to run.
    references, duration, connect
        See :func:`fuzzyarm.loop.simulate`; in place of the trajectories of a plant.
    vary : sequence of Range, optional
        What differs from drawn scenario to drawn scenario.
    payload : float, optional
        What the plant carries, as a share of its load.
    along : Trajectory or str, optional
        The only trajectory of the plant to tune on.

    Raises
    ------
    TuneError
        If no shipped plant has its axes.
    """
    if on is None:
        site = site_by_axes(text.model)
        if site is None:
            raise TuneError(f"no shipped plant has the axes of {text.model.name}", hint="name one")
        on = site.name
    way = way_of(on, along, referred=bool(references) or duration is not None)
    assert isinstance(way, Way)
    plant = equipped(way.plant, options)
    if way.trajectory is not None:
        only = isinstance(on, Trajectory) or along is not None
        first = (
            (scenario_along(plant, way.trajectory, payload),)
            if only
            else plant_scenarios(plant, payload)
        )
        return Stage(plant, first, options, tuple(vary), connect=connect)
    signals = as_signals(references)
    seconds = None if duration is None else as_seconds(duration, "duration")
    motion = plant_motion(controller_of(text), plant, signals, seconds, connect)
    first = (Scenario(motion.name, motion),)
    return Stage(plant, first, options, tuple(vary), signals, seconds, connect)


def _in_loop(
    text: ControllerText,
    tuning: Tuning | None,
    cost: str | OwnCost | None,
    stage: Stage,
    scenarios: int | Sequence[Scenario] | None,
    plan: Plan,
    over: Over,
    conventions: Conventions,
) -> Job:
    said = cost if cost is not None else DEFAULT_COST
    asked = read_cost(said) if isinstance(said, str) else said
    controller = controller_of(text)
    if scenarios is None or isinstance(scenarios, int):
        count = len(stage.first) if scenarios is None else scenarios
        if not 1 <= count <= 10_000:
            raise TuneError(f"{count} scenarios are out of range", hint="1 to 10000")
        train = train_scenarios(stage, count, controller)
    else:
        train = tuple(scenarios)
    problem = Problem(
        text,
        tuning,
        asked,
        train,
        over=over,
        conventions=conventions,
        options=stage.options,
        connect=stage.connect,
    )
    judged = {}
    if plan.unseen:
        unseen = unseen_scenarios(stage, plan.unseen, controller)
        judged["unseen"] = replace(problem, scenarios=unseen)
        if not stage.has_noise:
            noisy = stage.noisy()
            judged["noisy"] = replace(problem, scenarios=unseen, options=noisy.options)
    linear, alone = {}, ""
    if plan.linear:
        try:
            other, moving = opponent(text, stage.plant, tuning)
        except TuneError as error:
            alone = error.message
        else:
            sets = {"train": problem, **judged}
            linear = {key: replace(p, subject=other, tuning=moving) for key, p in sets.items()}
    unseen_names = tuple(scenario.name for scenario in judged["unseen"].scenarios) if judged else ()
    names = {"train": tuple(each.name for each in train), "unseen": unseen_names}
    return Job(problem, judged, linear, _cost_name(said), names, {}, alone)


def _cost_name(cost: str | OwnCost) -> str:
    return cost if isinstance(cost, str) else getattr(cost, "__name__", type(cost).__name__)


KEPT_BACK = 5
"""Every how manyth sample is kept back, where no others are given to judge by."""

NOISE_SHARE = 0.01
"""Of the inputs' ranges: standard deviation of the noise by which is judged."""


def _on_samples(
    rulebase: RuleBase,
    tuning: Tuning | None,
    cost: str | OwnCost | None,
    data: Samples | None,
    test: Samples | None,
    seed: int,
) -> Job:
    text = cost if cost is not None else DEFAULT_DATA_COST
    asked = read_cost(text, tuple(ERRORS)) if isinstance(text, str) else text
    name = _cost_name(text)
    if data is None:
        nothing: dict[str, tuple[str, ...]] = {"train": (), "unseen": ()}
        return Job(Problem(rulebase, tuning, asked), {}, {}, name, nothing, {})
    data = _fitting(data, rulebase)
    if test is None:
        order = np.random.default_rng(seed).permutation(len(data))
        data, test = (
            data.part(np.sort(order[len(data) // KEPT_BACK :])),
            data.part(np.sort(order[: len(data) // KEPT_BACK])),
        )
    else:
        test = _fitting(test, rulebase)
    if not len(data) or not len(test):
        raise TuneError("too few samples to keep some back", hint="give others to judge by")
    noisy = _with_noise(test, seed)
    problem = Problem(rulebase, tuning, asked, samples=data)
    sets = {"train": data, "unseen": test, "noisy": noisy}
    judged = {key: replace(problem, samples=sets[key]) for key in ("unseen", "noisy")}
    regression = {
        key: errors_between(linear_outputs(data, samples)[:, 0], samples.values)
        for key, samples in sets.items()
    }
    shown: dict[str, tuple[str, ...]] = {
        key: (f"{len(samples)} samples",) for key, samples in sets.items()
    }
    return Job(problem, judged, {}, name, shown, regression)


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
    drawn = generator.standard_normal(samples.inputs.shape) * spread
    return replace(samples, inputs=samples.inputs + drawn)


# --- Search, and what follows ---


def _done(job: Job, plan: Plan, means: Means, originals: Originals) -> Tuned:
    """Search, round and tell; then judge: what fails then takes nothing back."""
    with panel(job.problem, means.workers, means.executor) as examining:
        design = examining.design
        promises = Promises(design.as_it_is().rulebases)
        budget = plan.shared(judged=bool(job.judged), linear=bool(job.linear))
        search = Search(examining, promises, budget, means.journal, means.watch)
        found = search.run(plan.method, plan.seed)
        candidate, digits, score = rounded(examining, promises, found, plan.digits)
    rows = [
        Row("as in the file", {"train": found.trials[0].score}),
        Row("tuned", {"train": score}),
    ]
    tuning = Tuned(
        job.problem.subject,
        candidate,
        design.parameters,
        found,
        digits,
        tuple(rows),
        tuple(design.on_a_bound(found.best.point)),
        tuple(changes_of(job.problem.subject, design.sheets, candidate)),
        (),
        job.cost,
        job.names["train"],
        (),
        None,
        plan,
        job.problem.over,
        (),
        (found.fault,) if found.fault else (),
    )
    tuning = _written(tuning, originals)
    means.take(tuning)
    after = with_judgement(job, plan, means, tuning, (design.as_it_is(), candidate))
    return _written(after, originals)


def _written(made: Tuned, originals: Originals) -> Tuned:
    """Return it with its texts and what stands in them."""
    notes = tuple(notes_of(made))
    files = rewritten(made.subject, made.candidate, originals, notes)
    return replace(made, files=tuple(files), notes=notes)
