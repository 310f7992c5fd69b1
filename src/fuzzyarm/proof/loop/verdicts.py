"""Verdicts on claims about a loop: proved with a certificate, refuted by a run, or undecided.

A search (floats, :mod:`fuzzyarm.proof.loop.search`) proposes certificates; *proved* is said only
of one that :func:`verified` accepts, which derives the loop independently.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

from fuzzyarm.base.diagnostic import NOWHERE
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.numbers import number_text, outward_text
from fuzzyarm.base.shown import Shown, one_line
from fuzzyarm.control.loop.run import Run
from fuzzyarm.inference.threads import one_thread
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.plant.plant import PlantError
from fuzzyarm.proof.check.certificate import (
    Certificate,
    RegionProof,
    new_certificate,
)
from fuzzyarm.proof.check.checking import region_lines
from fuzzyarm.proof.check.loop import CheckedLoop, System, checked_loop
from fuzzyarm.proof.check.numbers import exact
from fuzzyarm.proof.check.region import (
    fall_in_cones,
    parts_of,
    verified,
    where_states_are,
)
from fuzzyarm.proof.check.rules import RuleSurfaces
from fuzzyarm.proof.claim.problem import ClaimError, LoopProblem
from fuzzyarm.proof.claim.text import GivenLoop
from fuzzyarm.proof.loop.enclosure import EnclosureError
from fuzzyarm.proof.loop.form_maker import FormMaker
from fuzzyarm.proof.loop.instability import growth
from fuzzyarm.proof.loop.runs import refuting_run
from fuzzyarm.proof.loop.search import (
    Proposal,
    form_at_rest,
    greatest_rate,
    proposals,
    rate_of,
)
from fuzzyarm.proof.loop.timed import Haven, claim_of_stability, followed, in_the_way
from fuzzyarm.proof.loop.tube import Tube
from fuzzyarm.proof.loop.witnesses import contradiction
from fuzzyarm.proof.stop import Stop

MOST_CHECKED = 8
"""Proposals that are shown to the checker, the one of the largest region first."""

EIGENVALUES = 5.0
"""Seconds that the search for a growing deviation may take."""

PROVED, REFUTED, UNDECIDED = "proved", "refuted", "undecided"

Tell = Callable[[str, int, float], None]


@json_properties(
    "property=statement verdict region start_region rest rests fall continuous uncertain"
    " certificate=certificate.seal tube=whole_tube evidence pieces seconds reason line"
)
@dataclass(frozen=True, repr=False, kw_only=True)
class LoopVerdict(Shown):
    """The verdict on a claim about a loop.

    Attributes
    ----------
    statement : str
        The claim, as it stands after ``prove``.
    verdict : str
        ``proved``, ``refuted`` or ``undecided``.
    region : dict of str to (float, float)
        Where each state and each memory can be in the proved region, an ellipsoid; empty where
        nothing is proved.
    start_region : dict of str to float
        By state of the plant, how far from rest the loop may start along it alone, everything
        else at rest and the controller as it starts.
    certificate : Certificate or None
        What proves it.
    rest : dict of str to float
        Where the loop rests.
    rests : dict of str to (float, float)
        Between what, of states that rest elsewhere with other parameters.
    fall : float
        By what share V falls in each period at least; 0 for a loop in continuous time.
    continuous : bool
        Whether the proof is one of the loop in continuous time only.
    evidence : tuple of str
        Of what is refuted, the start and what the run from it did; of what a tube proves without
        starts in the claim, which starts it had.
    run : Run or None
        That run.
    tube : Tube or None
        Where all runs are, of a claim that a tube proves, or was to prove.
    uncertain : tuple of str
        The blocks of the form: what was taken as an unknown gain.
    pieces : int
        Attempts of the search.
    seconds : float
        How long it took.
    work : float
        What of its budget it took, s.
    reason : str
        Why it is undecided, or what limits the region.
    line : int
        Of the file; 0 for a claim from elsewhere.
    claim : LoopClaim or None
        The claim.
    haven : RegionProof or None
        The region into which a tube leads.
    parts : tuple of LoopVerdict
        On parts of the parameters, where it is made of these.
    """

    statement: str
    verdict: str
    region: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    start_region: Mapping[str, float] = field(default_factory=dict)
    certificate: Certificate | None = None
    rest: Mapping[str, float] = field(default_factory=dict)
    rests: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    fall: float = 0.0
    continuous: bool = False
    evidence: tuple[str, ...] = ()
    run: Run | None = field(default=None, compare=False)
    tube: Tube | None = field(default=None, compare=False)
    uncertain: tuple[str, ...] = ()
    pieces: int = 0
    seconds: float = 0.0
    work: float = field(default=0.0, compare=False, repr=False)
    reason: str = ""
    line: int = 0
    claim: LoopClaim | None = field(default=None, compare=False)
    haven: RegionProof | None = field(default=None, compare=False, repr=False)
    parts: tuple[LoopVerdict, ...] = field(default=(), compare=False, repr=False)

    @property
    def proved(self) -> bool:
        """Whether it holds."""
        return self.verdict == PROVED

    @property
    def whole_tube(self) -> Tube | None:
        """The tube, if it contains all starts."""
        return self.tube if self.tube is not None and self.tube.complete else None

    def __repr__(self) -> str:
        return one_line(self, f"{self.verdict}: {self.statement}")

    def __str__(self) -> str:
        lines = [f"{self.verdict}: {self.statement}"]
        if self.tube is not None and self.proved:
            boxes = f"{self.tube.boxes} box{'es' * (self.tube.boxes != 1)}"
            arrival = self.tube.arrival
            until = f"{outward_text(arrival or self.tube.duration, up=True)} s"
            lines.append(f"  as sampled, by a tube of {boxes} for {until}")
            if arrival:
                lines.append("  from there on in an ellipsoid around rest that is never left, in")
        if self.region:
            lines += region_lines(
                self.region, self.start_region, rests=self.rests, continuous=self.continuous,
                arrival=self.tube is not None, parts=len(self.parts),
            )  # fmt: skip
        if self.reason:
            lines.append(f"  {self.reason}")
        return "\n".join([*lines, *(f"  {line}" for line in self.evidence)])


# ── the case ─────────────────────────────────────────────────────────────────────────


def judged(
    given: GivenLoop, claim: LoopClaim, *, budget: float, continuous: bool = False,
    tell: Tell | None = None,
) -> LoopVerdict:  # fmt: skip
    """Return the verdict on a claim about a loop, of all of its parameters at once."""
    return _Case(given, claim, budget, tell, continuous=continuous).verdict()


SEARCHED = 0.75
"""Of the time for a region, what the search may take."""


class _Case:
    """One claim on trial."""

    def __init__(
        self, given: GivenLoop, claim: LoopClaim, budget: float, tell: Tell | None, *,
        continuous: bool,
    ) -> None:  # fmt: skip
        self.given, self.claim, self.continuous = given, claim, continuous
        self.statement = given.sentence(claim, continuous=continuous)
        self.started = time.monotonic()
        watch = None if tell is None else (lambda count, gap: tell(self.statement, count, gap))
        self.stop = Stop(budget, watch)
        self.attempts = 0
        self.maker: FormMaker | None = None
        self.surfaces = RuleSurfaces()
        self.loop: CheckedLoop | None = None  # of the last certificate that was accepted

    def verdict(self) -> LoopVerdict:
        """Judge the claim, within the time that there is."""
        self.stop.say(0)
        with self.stop, one_thread():
            return self._judgement()

    def _judgement(self) -> LoopVerdict:
        try:
            problem = self.given.problem(self.claim)
        except (ClaimError, PlantError):
            raise  # the claim is at fault, not its proof
        except FuzzyarmError as error:
            return self._said(UNDECIDED, reason=_sentence(error))
        if self.claim.output or self.claim.start:
            refuted = self._attacked(problem)
            if refuted is not None:
                return refuted
        bounded = math.isfinite(self.claim.end) and not self.claim.stable
        loop_verdict = self._by_tube(problem) if bounded else self._by_region(problem)
        if loop_verdict.verdict == UNDECIDED and not self.claim.output:
            return self._unstable(problem) or loop_verdict
        return loop_verdict

    def _by_region(self, problem: LoopProblem) -> LoopVerdict:
        """Judge a claim for all time: by a region that holds the start, or a tube as far as one."""
        try:
            maker = FormMaker(problem.at_rest, self.stop)
            self.maker = maker
            if problem.moved:
                found = self._by_tube_and_region(problem, maker)
                return found or self._said(UNDECIDED, reason="no region was found where it rests")
            starts = bool(self.claim.output or self.claim.start) and not self.continuous
            verdict = self._searched(maker, self.claim, self.stop.half() if starts else self.stop)
            if verdict.verdict == UNDECIDED and starts:
                return self._by_tube_and_region(problem, maker) or verdict
        except (FuzzyarmError, EnclosureError) as error:
            verdict = self._said(UNDECIDED, reason=_sentence(error))
        return verdict

    def _by_tube_and_region(self, problem: LoopProblem, maker: FormMaker) -> LoopVerdict | None:
        """Return the verdict of a tube as far as a proved region; None without such a region."""
        stable = self._searched(maker, claim_of_stability(self.claim), self.stop.half())
        if stable.certificate is None:
            return None
        assert self.loop is not None
        haven = Haven(maker, stable.certificate.region, self.loop, self.claim,
                      problem.rests_from or 0)  # fmt: skip
        way, reason = followed(
            problem, self.claim, budget=self.stop.left, tell=self._told_of_boxes, haven=haven
        )
        if reason:
            return self._said(UNDECIDED, reason=reason, evidence=in_the_way(way), rest=stable.rest)
        region = stable.certificate.region
        never_left = where_states_are(problem, self.loop, region, exact(region.growth))
        return self._said(
            PROVED, tube=way, region=never_left, rest=stable.rest, fall=stable.fall,
            uncertain=stable.uncertain, evidence=_own_start(problem),
            haven=region,
        )  # fmt: skip

    def _by_tube(self, problem: LoopProblem) -> LoopVerdict:
        """Judge a claim for a bounded time: by a tube; where that fails, by a region."""
        if self.continuous:
            reason = "a claim for a time is proved of the sampled loop (leave out --continuous)"
            return self._said(UNDECIDED, reason=reason)
        try:
            way, reason = followed(
                problem, self.claim, budget=self.stop.half().left, tell=self._told_of_boxes
            )
        except (FuzzyarmError, EnclosureError) as error:
            return self._said(UNDECIDED, reason=_sentence(error))
        if not reason:
            return self._said(PROVED, tube=way, evidence=_own_start(problem))
        try:  # nothing of a reference that moves
            verdict = self._searched(FormMaker(problem, self.stop), self.claim, self.stop)
        except (FuzzyarmError, EnclosureError):
            verdict = None
        if verdict is not None and verdict.proved:
            return verdict
        whole = way if way.complete else None
        return self._said(UNDECIDED, reason=reason, tube=whole, evidence=in_the_way(way))

    def _told_of_boxes(self, share: float, boxes: int) -> None:
        """Show how far a tube is."""
        self.stop.say(boxes, 1.0 - share)

    def _said(self, verdict: str, **facts: Any) -> LoopVerdict:
        return LoopVerdict(
            statement=self.statement,
            verdict=verdict,
            pieces=self.attempts,
            seconds=time.monotonic() - self.started,
            work=self.stop.spent,
            line=0 if self.claim.span == NOWHERE else self.claim.span.line,
            claim=self.claim,
            **facts,
        )

    def _searched(self, maker: FormMaker, claim: LoopClaim, stop: Stop) -> LoopVerdict:
        bounds = _bounds_at_rest(maker.problem, claim)
        reason = "no quadratic function was found that falls"
        good: list[Proposal] = []
        verdict: LoopVerdict | None = None
        # What is found has to be judged within the time, too.
        search = stop if claim.output else Stop(SEARCHED * stop.left, stop.tell)
        for proposal in proposals(maker, claim, search, continuous=self.continuous, target=bounds):
            self.attempts += 1
            self.stop.say(self.attempts)
            if isinstance(proposal, str):
                reason = proposal
                continue
            against = proposal.refutation()
            if against:
                reason = against
                continue
            good.append(proposal)
            if claim.output:  # the first one will do
                verdict, against = self._judged(maker, claim, proposal)
                reason = against or reason
                if verdict is not None:
                    return verdict
        if not claim.output:
            # The search has seen its own form of the loop; the largest that the checker accepts.
            for proposal in sorted(good, key=lambda candidate: -candidate.size)[:MOST_CHECKED]:
                if self.stop.now:
                    break
                verdict, against = self._judged(maker, claim, proposal)
                reason = against or reason
                if verdict is not None:
                    return verdict
        over = "time ran out" if search.now else reason
        return self._said(UNDECIDED, reason=over, rest=_plain(maker.rest))

    def _judged(
        self, maker: FormMaker, claim: LoopClaim, proposal: Proposal
    ) -> tuple[LoopVerdict | None, str]:
        """Return the verdict of the checker, and of runs as witnesses, on a proposal."""
        region = proposal.region(continuous=self.continuous)
        against, facts, loop = verified(maker.problem, claim, region, self.surfaces)
        if against or loop is None:
            return None, against
        if not (region.rate or region.continuous):  # by how much V falls in each period
            rate = _rate(maker.problem, loop, region, self.surfaces)
            region = replace(region, rate=rate)
            facts["fall"] = _float_down(rate)
        against = contradiction(
            maker.problem, loop, region, stop=self.stop, rest_with=maker.rest_with
        )
        if against:
            return None, f"a certificate is contradicted: {against}"
        self.loop = loop
        certificate = new_certificate(maker.problem, claim, [region])
        return self._said(PROVED, certificate=certificate, **facts), ""

    def _attacked(self, problem: LoopProblem) -> LoopVerdict | None:
        """Return a refutation by a run from the starts of the claim, if one of some runs is one."""
        if self.continuous:  # runs are those of the sampled loop
            return None
        breach = refuting_run(problem, self.claim, self.stop)
        return breach and self._said(REFUTED, evidence=breach.words, run=breach.run)

    def _unstable(self, problem: LoopProblem) -> LoopVerdict | None:
        """Return a refutation of stability by the loop next to rest."""
        if self.continuous or self.maker is None:
            return None
        try:
            form = form_at_rest(self.maker)
            assert form.evidence is not None
            loop = checked_loop(problem, form.names, form.evidence, surfaces=self.surfaces)
            if _keeps_memory(loop, len(problem.states)):  # runs may come to another rest
                return None
            least = growth(loop, Stop(min(EIGENVALUES, self.stop.left)))
        except (FuzzyarmError, EnclosureError):
            return None
        times = outward_text(least, up=False, digits=6)
        grows = f"next to rest a deviation grows at least {times} times per period"
        return self._said(REFUTED, evidence=(grows,)) if least else None


def _bounds_at_rest(problem: LoopProblem, claim: LoopClaim) -> tuple[float, float] | None:
    """Return between what a port is to be, of which the claim is or whose error it bounds."""
    if not claim.error:
        return (claim.low, claim.high) if claim.output else None
    at = problem.set_point[problem.site.interface.port(claim.output)]
    return at - claim.high, at - claim.low


def _rate(
    problem: LoopProblem, loop: CheckedLoop, region: RegionProof, surfaces: RuleSurfaces
) -> Fraction:
    """Return by what share V falls in each period."""
    if not region.cones:
        return rate_of(loop, region.p, region.multipliers)
    parts = parts_of(problem, region, surfaces)
    return greatest_rate(lambda rate: fall_in_cones(parts, rate))


def _keeps_memory(loop: System, states: int) -> bool:
    """Tell whether a memory stays next to rest at any value, as a relay does."""
    return any(
        all(x == (i == k) for k, x in enumerate(loop.move[i])) for i in range(states, loop.size)
    )


def _own_start(problem: LoopProblem) -> tuple[str, ...]:
    """Say where the plant starts by itself, of states of which a claim does not say it."""
    values = ", ".join(
        f"{name} = {number_text(problem.start[name].low)}" for name in problem.begins_alone
    )
    return (f"of runs that start as the plant does: {values}",) if values else ()


def _float_down(x: Fraction) -> float:
    near = float(x)
    return near if Fraction(near) <= x else math.nextafter(near, 0.0)


def _sentence(error: Exception) -> str:
    hint, text = getattr(error, "hint", ""), str(error)
    return f"{text} ({hint})" if hint and hint not in text else text


def _plain(values: Mapping[str, Fraction]) -> dict[str, float]:
    return {name: float(value) for name, value in values.items()}
