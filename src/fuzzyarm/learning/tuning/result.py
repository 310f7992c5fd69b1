"""The result of tuning: the plan, the table, the supported claims, and its files."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Literal, NamedTuple

from fuzzyarm.base.files import real_path, same_file, write_atomically
from fuzzyarm.base.jsonable import JsonRecord, json_properties
from fuzzyarm.base.numbers import counted, percent
from fuzzyarm.base.shown import one_line
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.learning.tuning.design import Candidate, MovingNumber, controller_at
from fuzzyarm.learning.tuning.examiner import Score
from fuzzyarm.learning.tuning.linear import NAME as LINEAR
from fuzzyarm.learning.tuning.movement import TuneError
from fuzzyarm.learning.tuning.search import Budget, Found
from fuzzyarm.learning.tuning.text import Rewritten, TextChange, demand_not_used, with_files
from fuzzyarm.requests.fields import read_fields
from fuzzyarm.requests.tune import TuneRequest

Method = Literal["nelder-mead", "cma-es", "evolution"]

UNSEEN = 24
"""Scenarios of the judgement."""

ALL_DIGITS = 17
"""Digits of unrounded numbers."""

JUDGEMENT = 0.2
"""Fraction of a time limit reserved for the judgement."""


@dataclass(frozen=True)
class TuningPlan:
    """How to tune.

    Attributes
    ----------
    method : str
        A key of :data:`fuzzyarm.learning.tuning.optimisers.OPTIMISERS`.
    budget : Budget
        When to end.
    seed : int
        Seed of the search.
    digits : int
        Digits of the written numbers.
    unseen : int
        Scenarios of the judgement; 0 for no judgement.
    linear : bool
        Whether a linear opponent is tuned, too.
    """

    method: str = "nelder-mead"
    budget: Budget = field(default_factory=Budget)
    seed: int = 1
    digits: int = 3
    unseen: int = UNSEEN
    linear: bool = True

    def shared(self, *, judged: bool, linear: bool) -> Budget:
        """Return the budget of one search; the opponent gets the same, and both are judged."""
        seconds = self.budget.seconds * (1.0 - JUDGEMENT if judged else 1.0)
        return replace(self.budget, seconds=0.5 * seconds if linear else seconds)

    def __post_init__(self) -> None:
        read_fields(TuneRequest, vars(self), ("method", "seed", "digits", "unseen"))


class ComparedRow(NamedTuple):
    """A row of the table: the costs of a controller on each set of scenarios.

    Attributes
    ----------
    name : str
        ``as in the file``, ``tuned``, ``linear PD`` or ``linear regression``.
    scores : dict of str to Score
        ``train``, ``unseen``, ``noisy``.
    """

    name: str
    scores: dict[str, Score]


@json_properties(
    "cost over method=plan.method seed=plan.seed trials=found.trials.__len__ noise"
    " linear_trials=linear.trials.__len__ refused=found.refused seconds=found.seconds"
    " interrupted=found.interrupted digits scenarios unseen rows=table claim comparisons"
    " remarks faults line=line.gains failed=found.failed parameters on_a_bound changes"
    " curve=found.curve front"
)
@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Tuned(JsonRecord):
    """The result of tuning.

    Attributes
    ----------
    subject : ControllerText or RuleBase
        As it was before.
    candidate : Candidate
        The written numbers.
    parameters : tuple of MovingNumber
        The numbers that moved.
    found : Found
        The search: all trials, the best, the rejected ones.
    digits : int
        Significant digits; more than requested if rounding broke a promise.
    rows : tuple of ComparedRow
        The table.
    on_a_bound : tuple of str
        Parameters that ended on a bound of their range.
    changes : tuple of TextChange
        The differences, in the words of the file.
    files : tuple of Rewritten
        The new texts.
    cost : str
        The minimised cost.
    scenarios, unseen : tuple of str
        Names of the scenarios of the search, and of the judgement.
    linear : Found or None
        The search of the linear opponent.
    plan : TuningPlan
        Method, budget and seed.
    over : str
        How the costs of scenarios became one.
    notes : tuple of str
        Comments for the files.
    faults : tuple of str
        Failures after the search, a sentence each; the numbers are valid anyway.
    alone : str
        Reason for a missing linear opponent, if one was requested.
    noise : float
        Standard deviation of the noise of ``noisy``, as a share of each range; 0 without one.
    line : Candidate or None
        The numbers of the linear opponent.
    """

    subject: ControllerText | RuleBase
    candidate: Candidate
    parameters: tuple[MovingNumber, ...]
    found: Found
    digits: int
    rows: tuple[ComparedRow, ...]
    on_a_bound: tuple[str, ...]
    changes: tuple[TextChange, ...]
    files: tuple[Rewritten, ...]
    cost: str
    scenarios: tuple[str, ...]
    unseen: tuple[str, ...]
    linear: Found | None
    plan: TuningPlan
    over: str
    notes: tuple[str, ...]
    faults: tuple[str, ...] = ()
    alone: str = ""
    line: Candidate | None = None
    noise: float = 0.0

    def __repr__(self) -> str:
        name = self.model.name if isinstance(self.model, RuleBase) else self.model.model.name
        table = self.table
        before, after = (table[row]["train"].cost for row in ("as in the file", "tuned"))
        words = f"{self.cost} {after:.4g}, as in the file {before:.4g}"
        return one_line(self, f"{name}: {words}; {len(self.found.trials)} evaluations")

    @property
    def model(self) -> ControllerText | RuleBase:
        """The tuned controller or rule base."""
        if isinstance(self.subject, ControllerText):
            return controller_at(self.subject, self.candidate)
        return self.candidate.rulebases.get(self.subject.name, self.subject)

    @property
    def text(self) -> str:
        """The text of the tuned file."""
        return self.files[0].new if self.files else ""

    def row(self, name: str) -> ComparedRow | None:
        """Return a row of the table by its name."""
        return next((row for row in self.rows if row.name == name), None)

    def wins(self, over: str) -> tuple[int, int]:
        """Return the number of unseen scenarios on which it beats another row, and their total."""
        own_row, other = self.row("tuned"), self.row(over)
        if own_row is None or other is None:
            return 0, 0
        pairs = list(zip(_parts(own_row, "unseen"), _parts(other, "unseen"), strict=False))
        return sum(mine < theirs for mine, theirs in pairs), len(pairs)

    @property
    def table(self) -> dict[str, dict[str, Score]]:
        """Scores on ``train``, ``unseen`` and ``noisy`` of each row."""
        return {row.name: row.scores for row in self.rows}

    @cached_property
    def front(self) -> list[FrontPoint]:
        """Error and chatter of the trials that no other beats in both, by rising error."""
        return front_of(self.found)

    @property
    def comparisons(self) -> list[Comparison]:
        """Comparisons with the file and with a linear opponent on unseen scenarios."""
        return comparisons_of(self)

    def diff(self) -> str:
        """Return the lines of all files that differ."""
        return "\n".join(file.diff() for file in self.files if file.changed)

    def claim(self) -> str:
        """Return the claim supported by the unseen scenarios."""
        return _claim(self)

    def remarks(self) -> Iterator[str]:
        """Yield further remarks, one line each."""
        yield from _remarks(self)

    def write(self, path: str | os.PathLike[str]) -> list[Path]:
        """Write the texts; rule bases of separate files go beside, as ``STEM-NAME.frb``.

        If the tuned file is overwritten, rule bases beside it keep their names. Shipped files are
        never overwritten.
        """
        return _write(self, Path(path))


def _parts(row: ComparedRow, which: str) -> tuple[float, ...]:
    return row.scores[which].parts if which in row.scores else ()


@json_properties("*")
class FrontPoint(NamedTuple):
    """A trial that no other beats in both.

    Attributes
    ----------
    rms, chatter : float
        Its error and its chatter.
    """

    rms: float
    chatter: float


def front_of(result: Found) -> list[FrontPoint]:
    """Return error and chatter of the trials that no other beats in both, by rising error."""
    pairs = sorted(
        (trial.score.error, trial.score.chatter)
        for trial in result.trials
        if not trial.score.diverged
        and math.isfinite(trial.score.error)
        and math.isfinite(trial.score.chatter)
    )
    front: list[FrontPoint] = []
    # By rising error: a pair is on the front if its chatter is below that of all before.
    for error, chatter in pairs:
        if not front or chatter < front[-1][1]:
            front.append(FrontPoint(error, chatter))
    return front


# --- Report ---


@json_properties("with=other better_on=better of dearer_by=share")
class Comparison(NamedTuple):
    """Comparison of the tuned file with another row on unseen scenarios.

    Attributes
    ----------
    other : str
        Name of the row.
    better, of : int
        Number of scenarios with lower cost, and their total; 0 of 0 if the cost is one number for
        all of them.
    own, theirs : float
        The costs.
    """

    other: str
    better: int
    of: int
    own: float
    theirs: float

    @property
    def share(self) -> float:
        """Relative difference to the other cost; negative if it costs less."""
        return (self.own - self.theirs) / abs(self.theirs) if self.theirs else math.nan

    def words(self, over: str) -> str:
        """Describe the comparison."""
        name = {"as in the file": "the file", LINEAR: f"the {LINEAR}"}.get(self.other, self.other)
        if not self.of:
            return f"{self._cost_words(name)} on what was not seen"
        mean = {"mean": "on average", "worst": "at worst"}[over]
        on = f"better than {name} on {self.better} of {self.of} unseen scenarios"
        return f"{on}, {self._cost_words()} {mean}"

    def _cost_words(self, name: str = "") -> str:
        than, of = (f" than {name}", f" of {name}") if name else ("", "")
        if self.own == self.theirs:
            return f"the cost{of}" if name else "the same cost"
        if not self.share < BEYOND_WORDS:
            return f"{self.own:.4g} against {self.theirs:.4g}{of}"
        if self.share > MANIFOLD - 1.0:
            return f"{self.own / self.theirs:.3g} times the cost{of}"
        word = "higher" if self.share > 0.0 else "lower"
        return f"{percent(abs(self.share))} {word} cost{than}"


MANIFOLD = 3.0
"""Ratio of costs from which it is stated as a factor instead of in percent."""

BEYOND_WORDS = 1000.0
"""Ratio of costs beyond which the costs themselves are stated."""


def comparisons_of(tuned: Tuned) -> list[Comparison]:
    """Return the comparisons of the tuned file with all other rows on unseen scenarios."""
    tuned_row = tuned.row("tuned")
    if tuned_row is None or "unseen" not in tuned_row.scores:
        return []
    return [
        Comparison(
            row.name,
            *tuned.wins(row.name),
            tuned_row.scores["unseen"].cost,
            row.scores["unseen"].cost,
        )
        for row in tuned.rows
        if row is not tuned_row and "unseen" in row.scores
    ]


def _claim(tuned: Tuned) -> str:
    # A comparison of the file with itself is useless.
    others = [x for x in tuned.comparisons if tuned.changes or x.other != "as in the file"]
    sentences = [comparison.words(tuned.over) for comparison in others]
    if not tuned.changes:
        is_finite = math.isfinite(tuned.found.best.score.cost)
        none = (
            "nothing better was found" if is_finite else "no candidate has a cost that is a number"
        )
        sentences = [f"{none}: the file stays as it is", *sentences]
    elif not sentences:
        return "no unseen scenarios: no claim beyond the tuning scenarios"
    tuned_row = tuned.row("tuned")
    diverged = (
        tuned_row.scores["unseen"].diverged
        if tuned_row is not None and "unseen" in tuned_row.scores
        else 0
    )
    if diverged:
        sentences.append(f"{diverged} of {len(tuned.unseen)} runs diverge")
    return "; ".join(sentences)


def _noise_words(tuned: Tuned) -> Iterator[str]:
    if tuned.noise and any("noisy" in row.scores for row in tuned.rows):
        yield f"noisy: with noise of {100.0 * tuned.noise:g} % of each range"


def _remarks(tuned: Tuned) -> Iterator[str]:
    search, plan = tuned.found, tuned.plan
    yield from _noise_words(tuned)
    if tuned.on_a_bound:
        yield f"on a bound of its range: {', '.join(tuned.on_a_bound)}"
    outside = [
        parameter.name
        for parameter in tuned.parameters
        if not parameter.low <= parameter.start <= parameter.high
    ]
    if outside:
        yield f"outside its range in the file: {', '.join(outside)}"
    if search.refused:
        yield f"{_trials(search.refused)} broke an expect or prove line"
    if search.failed:
        yield f"{_trials(search.failed)} failed, the first with: {search.failure}"
    if tuned.linear is not None and len(tuned.linear.trials) != len(search.trials):
        yield f"the linear opponent had {_trials(len(tuned.linear.trials))} in the same time"
    if tuned.alone:
        yield f"no linear opponent: {tuned.alone}"
    tuned_row = tuned.row("tuned")
    judged = len(_parts(tuned_row, "unseen")) if tuned_row is not None else 0
    if 0 < judged < plan.unseen:
        yield f"judged by {judged} of {plan.unseen} unseen scenarios: time ran out"
    if tuned.digits == ALL_DIGITS:
        yield "the numbers are as they were found, not rounded"
    elif tuned.digits != plan.digits:
        yield f"{tuned.digits} digits were needed, not {plan.digits}"


def _trials(count: int) -> str:
    return counted(count, "trial")


def notes_of(tuned: Tuned) -> list[str]:
    """Return the comments for the files: the costs, and how they were reached."""
    from fuzzyarm.version import __version__

    columns = []
    for row in tuned.rows:
        shown = ", ".join(f"{name} {score.cost:.4g}" for name, score in row.scores.items())
        columns.append(f"{row.name}: {shown}")
    ways = ", ".join(tuned.scenarios[:2])
    more = len(tuned.scenarios) - 2
    others = f" and {more} drawn" if more > 0 else ""
    on = f"{ways}{others}" if ways else "a function"
    count = len(tuned.found.trials)
    digits = "not rounded" if tuned.digits == ALL_DIGITS else f"{tuned.digits} digits"
    return [
        f"{tuned.cost}, {tuned.over} over {on}",
        *columns,
        f"{tuned.plan.method}, {count} evaluations, seed {tuned.plan.seed},"
        f" {digits}, fuzzyarm {__version__}",
    ]


# --- Writing ---


def _write(tuned: Tuned, out: Path) -> list[Path]:
    if not tuned.files:
        message = "the tuned subject has no file, so none can be written"
        raise TuneError(message, hint="its numbers are in `candidate`, and `model` runs")
    first, *others = tuned.files
    origin = Path(first.path) if first.path else None
    over = origin is not None and same_file(out, origin)
    demand_not_used(out, tuned.subject, first.path)
    paths, names = [], {}
    for file in others:
        beside = file.path and real_path(file.path).parent == real_path(out).parent
        name = Path(file.path).name if over and beside else f"{out.stem}-{file.name}.frb"
        names[file.name] = name
        write_atomically(out.parent / name, file.new)
        paths.append(out.parent / name)
    text = first.new
    if isinstance(tuned.subject, ControllerText):
        own_files = {} if over else _files_elsewhere(tuned.subject, origin, out)
        text = with_files(text, {**own_files, **names})
    # The file with the references comes last: until then it names the old ones.
    write_atomically(out, text)
    return [out, *paths]


def _files_elsewhere(text: ControllerText, origin: Path | None, out: Path) -> dict[str, str]:
    """Return used files that lie beside the old file but not beside the new one."""
    if origin is None or real_path(origin).parent == real_path(out).parent:
        return {}
    files = {}
    for use in text.model.uses:
        place = origin.parent / use.files[0]
        if len(use.files) == 1 and place.exists() and not _shipped(use.files[0]):
            files[use.name] = os.path.relpath(str(place), str(out.parent))
    return files


def _shipped(name: str) -> bool:
    from fuzzyarm.base.shipped_files import shipped_names

    return name in shipped_names()
