"""From samples to a readable rule base: all steps, and its quality.

Two methods. *Sugeno*: a partition (:mod:`~fuzzyarm.learning.starts`) selected by cross-validation
(:mod:`~fuzzyarm.learning.structure`), consequents and terms by least squares
(:mod:`~fuzzyarm.learning.sugeno`), written with few digits (:mod:`~fuzzyarm.learning.model_text`).
*Wang–Mendel*: rules over words (:mod:`~fuzzyarm.learning.wang_mendel`). The text is the result:
errors are those of the rule base read back from it.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from fuzzyarm.base.diagnostic import MAX_OUTPUTS
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.keywords import demand_alone, wrong_argument
from fuzzyarm.base.names import printable
from fuzzyarm.base.numbers import counted
from fuzzyarm.base.shown import one_line
from fuzzyarm.inference.engine import compiled
from fuzzyarm.inference.threads import one_thread
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.learning.data import Samples, folds, read_samples
from fuzzyarm.learning.fit_options import MOST_COEFFICIENTS, Deadline, Options
from fuzzyarm.learning.model_text import (
    WritingStyle,
    commented,
    output_names,
    rule_comments,
    short_source,
    sugeno_rulebase,
)
from fuzzyarm.learning.orders import fit_options_of, samples_of
from fuzzyarm.learning.starts import grid_premises, merged, pruned
from fuzzyarm.learning.structure import (
    SHRINKAGES,
    CrossValidation,
    StructureCandidate,
    clearly_worse,
    clustered,
    grid_words,
    grown_grids,
    most_rules,
    smallest_good,
)
from fuzzyarm.learning.sugeno import (
    Array,
    Premises,
    Scaling,
    consequents,
    optimised,
    predicted,
)
from fuzzyarm.learning.wang_mendel import WordsError, wang_mendel
from fuzzyarm.requests.bounds import MOST_FITTED_DIGITS, MOST_RULES
from fuzzyarm.requests.learn import FitRequest
from fuzzyarm.version import __version__

STARTS = ("grid", "fcm", "subtractive")
METHODS = ("sugeno", "wang-mendel")

MOST_SEARCHED = 3000
"""Samples for the choice of the structure and the numbers of terms; consequents use all."""

WORSE_AS_TEXT = 0.01
"""Relative loss of accuracy allowed to rounding; beyond it the model gets more digits."""

MOST_NESTED = 1000
"""Samples up to which cross-validation is nested by default: with 300 of them the error of the
selected structure is some 2 % too small, with 40 up to a quarter."""

OUTER = 5
"""Parts of it at most: the whole way is gone once for each of them."""

Judged = Literal["nested", "fixed", "by the choice"]


class FitError(FuzzyarmError, ValueError):
    """Samples or options from which no model can be made."""


@json_properties("*")
class TrainingErrors(NamedTuple):
    """Errors on the samples of a fit.

    Attributes
    ----------
    error : float
        Root mean square, of the text as written.
    error_of_numbers : float
        The same before the numbers were rounded.
    linear : float
        Of a linear model.
    """

    error: float
    error_of_numbers: float
    linear: float


@json_properties("*")
class FitCandidate(NamedTuple):
    """A structure tried.

    Attributes
    ----------
    structure : str
        In words.
    rules : int
        How many.
    error : float
        Of cross-validation.
    """

    structure: str
    rules: int
    error: float


@dataclass(frozen=True, repr=False, kw_only=True)
class Fit:
    """A learned rule base and its quality.

    Attributes
    ----------
    rulebase : RuleBase
        As read back from `text`.
    text : str
        Canonical, with comments.
    error : float
        Root mean square error of the rule base on the samples; the share of wrong answers
        for classes.
    error_of_numbers : float
        The same before rounding.
    linear_error : float
        The same of linear regression.
    cross_validation : float
        Root mean square error on unseen samples; for classes that of the outputs, 0 or 1. If
        nested, the samples of each part influenced nothing: structure, shrinkage and terms were
        found without them.
    linear_cross_validation : float
        The same of linear regression.
    candidates : tuple of FitCandidate
        The structures tried.
    structure : str
        The chosen one, in words.
    shrinkage : float
        Shrinkage of the consequents; NaN for Wang and Mendel's rules.
    support : tuple of float
        Support of each rule, in samples.
    digits : int
        Digits of the numbers of terms.
    interrupted : bool
        Whether it is the best of an interrupted search.
    choice : float
        The error of cross-validation by which the structure was chosen.
    judged : str
        ``nested``, ``fixed`` if there was no choice, or ``by the choice``: on the parts used for
        selection, which underestimates the error for few samples.
    limits : tuple of str
        Parts ended early by Ctrl-C, ``search`` or ``judgement``, or by the ``time``.
    """

    rulebase: RuleBase
    text: str
    error: float
    error_of_numbers: float
    linear_error: float
    cross_validation: float
    linear_cross_validation: float
    candidates: tuple[FitCandidate, ...]
    structure: str
    shrinkage: float
    support: tuple[float, ...]
    digits: int
    interrupted: bool = False
    choice: float = math.nan
    judged: Judged = "fixed"
    limits: tuple[str, ...] = ()

    @property
    def training(self) -> TrainingErrors:
        """The errors on the samples of the fit."""
        return TrainingErrors(self.error, self.error_of_numbers, self.linear_error)

    def __repr__(self) -> str:
        words = f"error {self.error:.4g}, of linear regression {self.linear_error:.4g}"
        return one_line(self, f"{self.structure}: {words}, {len(self.rulebase.rules)} rules")


def fit(
    samples: Samples | FitRequest | str | os.PathLike[str],
    options: Options | None = None,
    on_step: Callable[[str], None] = lambda _words: None,
) -> Fit:
    """Return a rule base learned from samples.

    Parameters
    ----------
    samples : Samples, FitRequest, str or path-like
        From :mod:`fuzzyarm.learning.data`, or their file, whose last column is the target. A
        request alone holds all settings of ``fuzzyarm fit``.
    options : Options, optional
        How it is found.
    on_step : callable
        Called with the current step in words.

    Returns
    -------
    Fit
        A KeyboardInterrupt ends the search; the best so far is returned then.

    Raises
    ------
    FitError
        If there are too few samples, or an option is invalid.
    """
    if isinstance(samples, FitRequest):
        demand_alone("fit", options)
        options = fit_options_of(samples)
        samples = samples_of(samples)
    if not isinstance(options, Options | None):
        raise wrong_argument("fit", "options", "fuzzyarm.learning.Options", options)
    if isinstance(samples, str | os.PathLike):
        samples = read_samples(samples)
    if not isinstance(samples, Samples):
        raise wrong_argument("fit", "samples", "samples, their file or a FitRequest", samples)
    chosen = options or Options()
    _check(samples, chosen)
    clock = Deadline(chosen.seconds)
    with one_thread():
        if chosen.method == "wang-mendel":
            return _fit_words(samples, chosen, on_step, clock)
        return _fit_sugeno(samples, chosen, on_step, clock)


def _check(samples: Samples, options: Options) -> None:
    if len(samples) < 2:
        raise FitError("one sample is not enough to learn from")
    if options.method not in METHODS:
        raise FitError(f"unknown method '{options.method}'", hint=f"known: {', '.join(METHODS)}")
    if options.start not in STARTS:
        raise FitError(f"unknown start '{options.start}'", hint=f"known: {', '.join(STARTS)}")
    for name, value, least, most in (
        ("rules", options.rules, 1, MOST_RULES),
        ("parts of the cross-validation", options.parts, 2, 100),
        ("digits", options.digits, 1, MOST_FITTED_DIGITS),
        ("evaluations", options.evaluations, 1, 100_000),
    ):
        if not least <= value <= most:
            raise FitError(f"number of {name} must be {least} to {most}, not {value}")
    _check_numbers(options)
    _check_classes(samples)
    if options.terms is not None:
        _check_terms(samples, options, options.terms)


def _check_numbers(options: Options) -> None:
    if options.seed < 0:
        raise FitError(f"a seed of {options.seed} is out of range", hint="0 or more")
    if not 0.0 <= options.merge <= 1.0:
        raise FitError(f"a likeness of {options.merge:g} is out of range", hint="0 to 1")
    if options.shrinkage is not None and not 0.0 <= options.shrinkage < math.inf:
        raise FitError(f"shrinkage must be 0 or more, not {options.shrinkage:g}")
    if not options.seconds > 0.0:
        raise FitError(f"a time of {options.seconds:g} s is out of range")


def _check_classes(samples: Samples) -> None:
    count = len(samples.classes)
    if count == 1:
        raise FitError(f"'{samples.target}' has only one class: '{samples.classes[0]}'")
    if count > MAX_OUTPUTS:
        message = f"'{samples.target}' has {count:,} classes, and a model at most {MAX_OUTPUTS}"
        raise FitError(message, hint="numbers instead of words, or fewer classes")


def _check_terms(samples: Samples, options: Options, terms: tuple[int, ...]) -> None:
    if len(terms) != len(samples.names):
        count = len(samples.names)
        raise FitError(
            f"one number of terms is needed for each of {count} inputs, not {len(terms)}"
        )
    if any(not 1 <= term <= 50 for term in terms):
        raise FitError("an input has 1 to 50 terms")
    if math.prod(terms) > MOST_RULES:
        raise FitError(
            f"a grid of {math.prod(terms):,} rules is too large", hint=f"at most {MOST_RULES:,}"
        )
    if math.prod(terms) > most_rules(MOST_RULES, len(terms)):
        count = math.prod(terms) * (len(terms) + 1)
        message = f"a grid of {math.prod(terms)} rules on {len(terms)} inputs has {count:,} numbers"
        raise FitError(message, hint=f"at most {MOST_COEFFICIENTS:,}: fewer terms, fewer inputs")
    if options.start != "grid":
        raise FitError("terms of each input are for a grid, not for clusters")


# --- Takagi–Sugeno ---


def _searched(samples: Samples) -> Samples:
    """Return few enough samples for the search, evenly picked."""
    if len(samples) <= MOST_SEARCHED:
        return samples
    rows = np.linspace(0, len(samples) - 1, MOST_SEARCHED).round().astype(int)
    return samples.part(rows)


class _Way(NamedTuple):
    """A chosen structure, with its written terms, and the way to it."""

    best: StructureCandidate
    tried: list[StructureCandidate]
    judge: CrossValidation
    finished: bool


def _fit_sugeno(
    samples: Samples, options: Options, on_step: Callable[[str], None], clock: Deadline
) -> Fit:
    way = _found(samples, options, on_step, clock)
    error = Error(way.best.error, "fixed" if _nothing_to_choose(options) else "by the choice")
    if error.judged != "fixed" and way.finished:

        def learned(part: Samples) -> Callable[[Samples], Array]:
            return _of_part(_found(part, options, lambda _words: None, clock, judged=True), part)

        error = _nested(samples, options, learned, error, on_step, clock)
    try:
        return _written(samples, options, way, error, clock)
    except KeyboardInterrupt:  # one word is enough: the next one ends it
        return _written(samples, options, way._replace(finished=False), error, clock)


def _nothing_to_choose(options: Options) -> bool:
    fixed = options.terms is not None and options.shrinkage is not None
    return fixed and options.move is not None


def _found(
    samples: Samples,
    options: Options,
    on_step: Callable[[str], None],
    clock: Deadline,
    *,
    judged: bool = False,
) -> _Way:
    """Return a structure with moved terms for samples; with `judged` no partial result."""
    few = _searched(samples)
    parts = list(folds(len(few), options.parts, series=options.series, seed=options.seed))
    shrinkages = SHRINKAGES if options.shrinkage is None else (options.shrinkage,)

    def note(words: str) -> None:
        clock.begin_to_end(_share_of_search(samples, options))  # a candidate exists now
        on_step(words)

    judge = CrossValidation(few.inputs, few.outputs, parts, shrinkages, note, clock.check)
    tried, finished = _tried(judge, samples, options)
    chosen = smallest_good(tried) if options.terms is None else tried[-1]
    if finished and options.move is not False and chosen.premises.terms:
        chosen, moved, finished = _moved(judge, chosen, options)
        tried += moved
    premises = chosen.premises
    if chosen.optimised and finished:
        premises, finished = _optimised(chosen, few, options, on_step, clock)
    if judged and not finished:
        raise KeyboardInterrupt
    return _Way(replace(chosen, premises=premises), tried, judge, finished)


def _of_part(way: _Way, part: Samples) -> Callable[[Samples], Array]:
    """Return the predictions of a model of some samples for others."""
    premises = way.best.premises
    weights, scaling = consequents(premises, part.inputs, part.outputs, way.best.shrinkage)

    def outputs(points: Samples) -> Array:
        values = predicted(premises, weights, scaling.regressors(points.inputs), points.inputs)
        return scaling.middle + scaling.range * values

    return outputs


# --- Judgement on samples without influence ---

SEARCH, JUDGEMENT = 0.6, 0.8
"""Fractions of the time at which the search and its judgement are ended."""


def _is_nested(samples: Samples, options: Options) -> bool:
    return len(samples) <= MOST_NESTED if options.nested is None else options.nested


def _share_of_search(samples: Samples, options: Options) -> float:
    return SEARCH if _is_nested(samples, options) else JUDGEMENT


class Error(NamedTuple):
    """An error of cross-validation, and the other use of its parts."""

    value: float
    judged: Judged
    broken_off: bool = False


def _nested(
    samples: Samples,
    options: Options,
    learned: Callable[[Samples], Callable[[Samples], Array]],
    error: Error,
    on_step: Callable[[str], None],
    clock: Deadline,
) -> Error:
    """Return the error of the whole way, gone again without the samples of each part.

    Ctrl-C, or the end of the time, leaves the error by which was chosen.
    """
    if not _is_nested(samples, options):
        return error
    few = _searched(samples)
    count = min(options.parts, OUTER)
    parts = list(folds(len(few), count, series=options.series, seed=options.seed))
    if min(len(train) for train, _ in parts) < 2:
        return error
    off = []
    try:
        for number, (train, test) in enumerate(parts, 1):
            clock.run_until(JUDGEMENT)
            clock.check()
            on_step(f"nested cross-validation: without part {number} of {len(parts)}")
            held_out = few.part(test)
            off.append(held_out.outputs - learned(few.part(train))(held_out))
    except KeyboardInterrupt:
        return error._replace(broken_off=True)
    return Error(rms(np.concatenate(off)), "nested")


def _tried(
    judge: CrossValidation, samples: Samples, options: Options
) -> tuple[list[StructureCandidate], bool]:
    """Return the tried structures, and whether the search was completed."""
    candidates: list[StructureCandidate] = []
    counts = options.terms or (1,) * len(samples.names)
    if options.terms is not None:
        grid = grid_premises(judge.inputs, counts)
        return [judge.judged(grid_words(counts, samples.names), grid)], True
    if options.start == "grid":
        search = grown_grids(judge, options.rules, samples.names)
    else:
        search = clustered(judge, options.start, options.rules, options.seed)
    try:
        candidates.extend(search)  # keeps the candidates before an interrupt
    except KeyboardInterrupt:
        if not candidates:
            raise
        return candidates, False
    return candidates, True


def _moved(
    judge: CrossValidation, chosen: StructureCandidate, options: Options
) -> tuple[StructureCandidate, list[StructureCandidate], bool]:
    """Return the structure with its terms moved, if better or requested."""
    trials = [chosen]
    if options.shrinkage is None:  # moved terms may allow conclusions more freedom
        trials.append(replace(chosen, shrinkage=chosen.shrinkage / 30.0))
    candidates: list[StructureCandidate] = []
    try:
        candidates += [judge.moved(trial) for trial in trials]
    except KeyboardInterrupt:
        return chosen, [], False
    moved = smallest_good(candidates)
    better = clearly_worse(chosen.squares, moved.squares)
    return (moved if better or options.move else chosen), [moved], True


def _optimised(
    chosen: StructureCandidate,
    few: Samples,
    options: Options,
    on_step: Callable[[str], None],
    clock: Deadline,
) -> tuple[Premises, bool]:
    width = float(few.outputs.std(axis=0).mean())

    def tell(cost: float) -> None:
        clock.check()
        on_step(f"moving terms: training error {cost * width:.4g}")

    def move(premises: Premises, evaluations: int) -> tuple[Premises, bool]:
        return optimised(
            premises, few.inputs, few.outputs, chosen.shrinkage, evaluations, on_step=tell
        )

    premises, finished = move(chosen.premises, options.evaluations)
    if options.start == "grid" or not finished:
        return premises, finished
    fewer = pruned(merged(premises, options.merge), few.inputs)
    return move(fewer, options.evaluations // 2)


def _written(samples: Samples, options: Options, way: _Way, error: Error, clock: Deadline) -> Fit:
    """Round, write, read back and score; use more digits if rounding shows."""
    best, premises, shrinkage = way.best, way.best.premises, way.best.shrinkage
    weights, scaling = consequents(premises, samples.inputs, samples.outputs, shrinkage)
    regressors = scaling.regressors(samples.inputs)
    numbers = scaling.middle + scaling.range * predicted(
        premises, weights, regressors, samples.inputs
    )
    off = samples.outputs - numbers
    spread = np.sqrt(np.mean(off**2, axis=0))
    target = rms(off)
    digits = options.digits
    while True:
        layout = WritingStyle(options.name, options.description, options.outside, digits)
        rulebase = sugeno_rulebase(premises, samples, shrinkage, spread, layout)
        residual = samples.outputs - outputs_of(rulebase, samples)
        # A nearly exact fit would need ever more digits.
        floor = 1e-4 * float(scaling.range.max())
        limit = (1.0 + WORSE_AS_TEXT) * max(target, floor)
        if rms(residual) <= limit or digits >= MOST_FITTED_DIGITS:
            break
        digits += 1
    strengths = premises.strengths(samples.inputs)
    fit = Fit(
        rulebase=rulebase,
        text="",
        error=score(samples, samples.outputs - residual),
        error_of_numbers=score(samples, numbers),
        linear_error=score(samples, linear_outputs(samples)),
        cross_validation=error.value,
        linear_cross_validation=way.judge.linear_error(),
        candidates=tuple(FitCandidate(trial.words, trial.size, trial.error) for trial in way.tried),
        structure=best.words,
        shrinkage=shrinkage,
        support=tuple(strengths.sum(axis=0).tolist()),
        digits=digits,
        interrupted=not way.finished,
        choice=best.error,
        judged=error.judged,
        limits=tuple(_limits(way.finished, error, clock)),
    )
    comments = rule_comments(rulebase, samples, strengths, residual)
    return _with_text(fit, commented(rulebase, _head(samples, options, fit), comments))


def _limits(finished: bool, error: Error, clock: Deadline) -> Iterator[str]:
    if not finished:
        yield "search"
    if error.broken_off:
        yield "judgement"
    if clock.up:
        yield "time"


def _with_text(fit: Fit, text: str) -> Fit:
    parsed = parse(text)
    assert parsed.rulebase is not None, parsed.diagnostics
    return replace(fit, text=text, rulebase=parsed.rulebase)


def _head(samples: Samples, options: Options, fit: Fit) -> list[str]:
    """Return the comment lines above a learned rule base: origin and quality."""
    kind = "wrong answers" if samples.classes else "RMS error"
    source = printable(short_source(samples.source))
    parts = min(options.parts, OUTER) if fit.judged == "nested" else options.parts
    parts = min(parts, len(samples))
    how = f"{parts}-fold cross-validation{' in blocks' if options.series else ''}"
    how = f"nested {how}" if fit.judged == "nested" else how
    rules = len(fit.rulebase.rules)
    lines = [
        f"Learned by fuzzyarm {__version__} from {source}: {len(samples):,} samples,"
        f" target {printable(samples.target)}.",
        f"{counted(rules, 'rule')}: {printable(fit.structure)}.",
        f"Training {kind} {fit.error:.4g}; linear regression {fit.linear_error:.4g}.",
        f"RMS error in {how} {fit.cross_validation:.4g};"
        f" linear regression {fit.linear_cross_validation:.4g}.",
    ]
    if fit.judged == "by the choice":
        lines.append("Its structure was chosen on the same parts: on others it may be more.")
    if not math.isnan(fit.shrinkage):
        lines.append(f"Shrinkage {fit.shrinkage:.2g}, seed {options.seed}.")
    if fit.interrupted:
        ended = "ran out of time" if "time" in fit.limits else "was interrupted"
        lines.append(f"The search {ended}: the best so far.")
    return lines


# --- Wang and Mendel ---


def _fit_words(
    samples: Samples, options: Options, on_step: Callable[[str], None], clock: Deadline
) -> Fit:
    low, high = options.words
    if not low <= high:
        raise WordsError(f"words from {low} to {high}: the range is empty")
    layout = WritingStyle(options.name, options.description)
    parts = list(folds(len(samples), options.parts, series=options.series, seed=options.seed))
    judge = CrossValidation(samples.inputs, samples.outputs, parts)
    errors, finished = _errors_of_words(samples, options, on_step, clock)
    chosen = min(errors, key=errors.__getitem__)
    judgement = Error(errors[chosen], "fixed" if low == high else "by the choice")
    if judgement.judged != "fixed" and finished:

        def learned(part: Samples) -> Callable[[Samples], Array]:
            errors, complete = _errors_of_words(part, options, lambda _words: None, clock)
            if not complete:
                raise KeyboardInterrupt
            model, _ = wang_mendel(part, min(errors, key=errors.__getitem__), layout)
            return lambda points: outputs_of(model, points)

        judgement = _nested(samples, options, learned, judgement, on_step, clock)
    rulebase, support = wang_mendel(samples, chosen, layout)
    error = score(samples, outputs_of(rulebase, samples))
    fit = Fit(
        rulebase=rulebase,
        text="",
        error=error,
        error_of_numbers=error,
        linear_error=score(samples, linear_outputs(samples)),
        cross_validation=judgement.value,
        linear_cross_validation=judge.linear_error(),
        candidates=tuple(
            FitCandidate(f"{words} words", words, squares) for words, squares in errors.items()
        ),
        structure=f"{chosen} words of each variable, after Wang and Mendel",
        shrinkage=math.nan,
        support=tuple(map(float, support)),
        digits=0,
        interrupted=not finished,
        choice=errors[chosen],
        judged=judgement.judged,
        limits=tuple(_limits(finished, judgement, clock)),
    )
    head = _head(samples, options, fit)
    counts = np.asarray(support)
    head.append(
        f"Samples for each rule: {counts.min()} to {counts.max()}, median {np.median(counts):g};"
        f" {int(np.sum(counts == 1))} rules rest on one."
    )
    by_rule = ["1 sample" if count == 1 else f"{count} samples" for count in counts.tolist()]
    return _with_text(fit, commented(rulebase, head, {}, by_rule))


def _errors_of_words(
    samples: Samples, options: Options, on_step: Callable[[str], None], clock: Deadline
) -> tuple[dict[int, float], bool]:
    """Return the error of cross-validation by the number of words, and whether of all of them."""
    low, high = options.words
    layout = WritingStyle(options.name, options.description)
    parts = list(folds(len(samples), options.parts, series=options.series, seed=options.seed))
    errors: dict[int, float] = {}
    try:
        for words in range(low, high + 1):
            off = []
            for train, test in parts:
                if errors:
                    clock.check()
                rulebase, _ = wang_mendel(samples.part(train), words, layout)
                held_out = samples.part(test)
                off.append(held_out.outputs - outputs_of(rulebase, held_out))
            errors[words] = rms(np.concatenate(off))
            clock.begin_to_end(_share_of_search(samples, options))
            on_step(f"{words} words: {errors[words]:.4g}")
    except KeyboardInterrupt:
        if not errors:
            raise
        return errors, False
    return errors, True


# --- A rule base on samples ---


def outputs_of(rulebase: RuleBase, samples: Samples) -> Array:
    """Return the outputs of a rule base at samples, shape (samples, outputs)."""
    results = compiled(rulebase)(dict(zip(samples.names, samples.inputs.T, strict=True)))
    return np.stack([results[name] for name in output_names(samples)], axis=1)


def linear_outputs(samples: Samples, points: Samples | None = None) -> Array:
    """Return the outputs of linear regression on samples, at these or at others."""
    scaling = Scaling.of(samples.inputs, samples.outputs)
    regressors = scaling.regressors(samples.inputs)
    weights = np.linalg.lstsq(regressors, samples.outputs, rcond=1e-10)[0]
    at = regressors if points is None else scaling.regressors(points.inputs)
    values: Array = at @ weights
    return values


@json_properties("*")
class SurrogateFidelity(NamedTuple):
    """How far a surrogate is off.

    Attributes
    ----------
    worst, rms : float
        In the units of the output.
    worst_share, rms_share : float
        As a share of its range.
    """

    worst: float
    rms: float
    worst_share: float
    rms_share: float


def fidelity(rulebase: RuleBase, samples: Samples) -> SurrogateFidelity:
    """Return the error of a rule base on samples of its original."""
    off = samples.outputs - outputs_of(rulebase, samples)
    width = float(np.ptp(samples.outputs)) or 1.0
    worst, mean = float(np.abs(off).max()), rms(off)
    return SurrogateFidelity(worst, mean, worst / width, mean / width)


def rms(errors: Array) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(errors**2)))


def score(samples: Samples, outputs: Array) -> float:
    """Return the root mean square error of outputs; for classes the share of wrong ones."""
    if not samples.classes:
        return rms(samples.outputs - outputs)
    return float(np.mean(outputs.argmax(axis=1) != samples.values))
