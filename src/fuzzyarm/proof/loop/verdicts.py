"""Verdicts on claims about a loop: proved with a certificate, refuted by a run, or undecided.

A search (floats, :mod:`fuzzyarm.proof.loop.search`) proposes certificates; *proved* requires that
:func:`verified` accepts one, with its own derivation of the loop.
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
from fuzzyarm.proof.loop.timed import Haven, claim_of_stability, first_open_box, followed
from fuzzyarm.proof.loop.tube import Tube
from fuzzyarm.proof.loop.witnesses import contradiction
from fuzzyarm.proof.stop import Stop

MOST_CHECKED = 8
"""Most proposals for the checker, the one with the largest region first."""

EIGENVALUES = 5.0
"""Time budget of the search for a growing deviation, seconds."""

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
        The claim, as written after ``prove``.
    verdict : str
        ``proved``, ``refuted`` or ``undecided``.
    region : dict of str to (float, float)
        Bounds of each state and memory in the proved region, an ellipsoid; empty without a
        proof. Of several parts of the parameters, the rests and the least reach around any.
    start_region : dict of str to float
        Largest deviation at the start along each state of the plant alone, everything else at rest
        and the controller at its initial values.
    certificate : Certificate or None
        The certificate.
    rest : dict of str to float
        The equilibrium.
    rests : dict of str to (float, float)
        Bounds of the equilibrium, for states whose rest depends on parameters.
    fall : float
        Least relative fall of V in each period; 0 for a loop in continuous time.
    continuous : bool
        Whether the proof is about the loop in continuous time only.
    evidence : tuple of str
        Of a refutation, the start and the run's violation; of a tube for a claim without starts,
        the plant's own start.
    run : Run or None
        The refuting run.
    tube : Tube or None
        The tube, for a claim decided or attempted by one.
    uncertain : tuple of str
        The blocks of the form: its uncertain gains.
    pieces : int
        Attempts of the search.
    seconds : float
        Time taken.
    work : float
        Time of the budget spent, s.
    reason : str
        Why it is undecided, or what limits the region.
    line : int
        Line in the file; 0 for a claim from elsewhere.
    claim : LoopClaim or None
        The claim.
    haven : RegionProof or None
        The region into which a tube leads.
    parts : tuple of LoopVerdict
        Verdicts on parts of the parameters, if it is composed of them.
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
        """Whether the claim is proved."""
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
"""Share of the time for a region that the search may take."""


class _Case:
    """The proof of one claim."""

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
        """Judge the claim within its budget."""
        self.stop.say(0)
        with self.stop, one_thread():
            return self._judgement()

    def _judgement(self) -> LoopVerdict:
        try:
            problem = self.given.problem(self.claim)
        except (ClaimError, PlantError):
            raise  # the claim is wrong, not its proof
        except FuzzyarmError as error:
            return self._said(UNDECIDED, reason=str(error))
        if self.claim.output or self.claim.start:
            refuted = self._refuted_by_run(problem)
            if refuted is not None:
                return refuted
        bounded = math.isfinite(self.claim.end) and not self.claim.stable
        loop_verdict = self._by_tube(problem) if bounded else self._by_region(problem)
        if loop_verdict.verdict == UNDECIDED and not self.claim.output:
            return self._unstable(problem) or loop_verdict
        return loop_verdict

    def _by_region(self, problem: LoopProblem) -> LoopVerdict:
        """Judge a claim for all time: by a region around the start, or a tube into one."""
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
        except FuzzyarmError as error:
            verdict = self._said(UNDECIDED, reason=str(error))
        return verdict

    def _by_tube_and_region(self, problem: LoopProblem, maker: FormMaker) -> LoopVerdict | None:
        """Return the verdict by a tube into a proved region; None without such a region."""
        stable = self._searched(maker, claim_of_stability(self.claim), self.stop.half())
        if stable.certificate is None:
            return None
        assert self.loop is not None
        haven = Haven(maker, stable.certificate.region, self.loop, self.claim,
                      problem.rests_from or 0)  # fmt: skip
        way, reason = followed(
            problem, self.claim, budget=self.stop.left, tell=self._report_boxes, haven=haven
        )
        if reason:
            return self._said(
                UNDECIDED, reason=reason, evidence=first_open_box(way), rest=stable.rest
            )
        region = stable.certificate.region
        never_left = where_states_are(problem, self.loop, region, exact(region.growth))
        return self._said(
            PROVED, tube=way, region=never_left, rest=stable.rest, fall=stable.fall,
            uncertain=stable.uncertain, evidence=_own_start(problem),
            haven=region,
        )  # fmt: skip

    def _by_tube(self, problem: LoopProblem) -> LoopVerdict:
        """Judge a claim for a bounded time: by a tube; if that fails, by a region."""
        if self.continuous:
            reason = "a claim for a time is proved of the sampled loop (leave out --continuous)"
            return self._said(UNDECIDED, reason=reason)
        try:
            way, reason = followed(
                problem, self.claim, budget=self.stop.half().left, tell=self._report_boxes
            )
        except FuzzyarmError as error:
            return self._said(UNDECIDED, reason=str(error))
        if not reason:
            return self._said(PROVED, tube=way, evidence=_own_start(problem))
        try:  # not for a moving reference
            verdict = self._searched(FormMaker(problem, self.stop), self.claim, self.stop)
        except (FuzzyarmError, EnclosureError):
            verdict = None
        if verdict is not None and verdict.proved:
            return verdict
        whole = way if way.complete else None
        return self._said(UNDECIDED, reason=reason, tube=whole, evidence=first_open_box(way))

    def _report_boxes(self, share: float, boxes: int) -> None:
        """Report the progress of a tube."""
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
        # The result has to be judged within the budget, too.
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
            # The search knows its own form only: the largest region accepted by the checker wins.
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
        """Return the verdict on a proposal by the checker, with runs as witnesses."""
        region = proposal.region(continuous=self.continuous)
        against, facts, loop = verified(maker.problem, claim, region, self.surfaces)
        if against or loop is None:
            return None, against
        if not (region.rate or region.continuous):  # the fall of V in each period
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

    def _refuted_by_run(self, problem: LoopProblem) -> LoopVerdict | None:
        """Return a refutation by a run from the claim's starts, if one of the tried runs is one."""
        if self.continuous:  # runs are of the sampled loop
            return None
        breach = refuting_run(problem, self.claim, self.stop)
        return breach and self._said(REFUTED, evidence=breach.words, run=breach.run)

    def _unstable(self, problem: LoopProblem) -> LoopVerdict | None:
        """Return a refutation of stability by the growth of a deviation near rest."""
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
    """Return the claimed bounds at rest of a port, or of the port of a claimed error."""
    if not claim.error:
        return (claim.low, claim.high) if claim.output else None
    at = problem.set_point[problem.site.interface.port(claim.output)]
    return at - claim.high, at - claim.low


def _rate(
    problem: LoopProblem, loop: CheckedLoop, region: RegionProof, surfaces: RuleSurfaces
) -> Fraction:
    """Return the proved relative fall of V in each period."""
    if not region.cones:
        return rate_of(loop, region.p, region.multipliers)
    parts = parts_of(problem, region, surfaces)
    return greatest_rate(lambda rate: fall_in_cones(parts, rate))


def _keeps_memory(loop: System, states: int) -> bool:
    """Return whether a memory stays near rest at any value, as of a relay."""
    return any(
        all(x == (i == k) for k, x in enumerate(loop.move[i])) for i in range(states, loop.size)
    )


def _own_start(problem: LoopProblem) -> tuple[str, ...]:
    """Return in words the plant's own start, for states without a start in the claim."""
    values = ", ".join(
        f"{name} = {number_text(problem.start[name].low)}" for name in problem.begins_alone
    )
    return (f"of runs that start as the plant does: {values}",) if values else ()


def _float_down(x: Fraction) -> float:
    near = float(x)
    return near if Fraction(near) <= x else math.nextafter(near, 0.0)


def _plain(values: Mapping[str, Fraction]) -> dict[str, float]:
    return {name: float(value) for name, value in values.items()}
