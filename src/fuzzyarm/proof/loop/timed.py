"""Claims decided by tubes: for a bounded time, or until all runs are in a proved region.

A claim with an end needs a tube of that duration (:mod:`fuzzyarm.proof.loop.tube`). One without an
end needs a tube up to a proved region, an invariant ellipsoid V ≤ 1 in which V falls by a known
share in each period (:mod:`fuzzyarm.proof.check.region`): from there on bounds follow from V.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.numbers import decimal
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.control.loop.course import Sensor
from fuzzyarm.language.loop_claims import stretch_text
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.plant.plant import Plant
from fuzzyarm.proof.check.certificate import RegionProof
from fuzzyarm.proof.check.loop import CheckedLoop
from fuzzyarm.proof.check.numbers import exact, float_above, float_below, is_positive_definite
from fuzzyarm.proof.check.region import claimed_within, decay, region_refutation
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.claim.text import claimed_in, claimed_port, problem_of
from fuzzyarm.proof.loop.algebra import Number
from fuzzyarm.proof.loop.enclosure import EnclosureError, outward
from fuzzyarm.proof.loop.follower import Demand, Nearness
from fuzzyarm.proof.loop.form_maker import FormMaker
from fuzzyarm.proof.loop.tube import Tube, tube
from fuzzyarm.proof.loop.zonotope import ENLARGED, ROUNDING, Forms, stacked
from fuzzyarm.proof.stop import TUBE_BUDGET, default_budget

PATIENCE = 32
"""Control periods after which a stalled box may be halved."""

Tell = Callable[[float, int], None]


# ── for a bounded time ───────────────────────────────────────────────────────────────


def followed(
    problem: LoopProblem,
    claim: LoopClaim,
    *,
    budget: float = math.inf,
    tell: Tell | None = None,
    haven: Haven | None = None,
) -> tuple[Tube, str]:
    """Return the tube of a claim, and why it does not prove the claim; empty if it does.

    A claim without an end needs a haven, where the tube ends. `tell` is called with the finished
    share of the starts and the number of open boxes. LoopProofError, UnreadableError and
    UnprovableError: part of the loop has no enclosure.
    """
    horizon = _end(problem, claim) if haven is None else haven.horizon
    if not math.isfinite(horizon):
        raise LoopProofError("a tube has an end", hint="during 0 .. 10 s")
    demands = []
    if claim.output:
        port = claimed_port(problem, claim)
        demands = [Demand(port, claim.low, claim.high, claim.begin, horizon)]
    course = tube(
        problem,
        horizon,
        demands=demands,
        budget=default_budget(budget, TUBE_BUDGET),
        progress=tell,
        goal=None if haven is None else haven.sign,
    )
    proved = course.complete and not course.open
    if proved and haven is None and demands:
        proved = course.holds(demands[0])
    return course, "" if proved else _failure(problem, course, claim, haven)


def _end(problem: LoopProblem, claim: LoopClaim) -> float:
    """Return the end of a claim, s; for a drive that jumps there, with its new value."""
    if math.isinf(claim.end) or claim.error:  # both sides of a jump count at its sample
        return claim.end
    last = claimed_in(problem, claim).last or 0
    period = decimal(problem.period)
    return float((last + 1) * period) if decimal(claim.end) == last * period else claim.end


def loop_tube(
    text: ControllerText,
    claim: LoopClaim,
    duration: float,
    *,
    plant: Plant | None = None,
    connect: Mapping[str, str] | None = None,
    sensors: Mapping[str, Sensor] | None = None,
    budget: float = math.inf,
    tell: Tell | None = None,
) -> tuple[Tube, tuple[str, ...]]:
    """Return the tube of all runs of a loop for a time, and in words the starts left open.

    Parameters
    ----------
    text : ControllerText
        The controller.
    claim : LoopClaim
        The plant, its set points, parameters and starts; the claim itself may be empty.
    duration : float
        s.
    plant, connect, sensors
        As for :func:`fuzzyarm.proof.loop.prove_loop`.
    budget : float
        Processor seconds; infinite: a minute.
    tell : callable, optional
        Called with the finished share of the starts and the number of open boxes.

    Raises
    ------
    LoopProofError, UnreadableError, UnprovableError
        If part of the loop has no enclosure.
    """
    problem = problem_of(text, claim, plant=plant, connect=connect, sensors=sensors)
    problem.require_known_start()
    loop_claim = replace(claim, stable=False, output="", when="during", begin=0.0, end=duration)
    way, _ = followed(problem, loop_claim, budget=budget, tell=tell)
    why = (f"why: {way.reason}",) if way.reason else ()
    return way, (*first_open_box(way), *why)


def _failure(problem: LoopProblem, tube: Tube, claim: LoopClaim, haven: Haven | None) -> str:
    """Return in words how far a tube got, and which box failed."""
    what = "the region" if haven is not None and not claim.output else "the claim"
    if haven is not None and claim.output:
        what = "the claim and the region"
    reason = f"a tube of {tube.boxes} box{'es' * (tube.boxes != 1)} does not show {what}"
    if tube.complete and claim.output and haven is None:
        port = claimed_port(problem, claim)
        low, high = tube.bounds(port, claim.begin, min(claim.end, tube.duration))
        reason += f": {claim.subject} in {low:.6g} .. {high:.6g}"
        later = ", a later time" if claim.when == "after" else ""
        reason += f" (a wider range{later}, narrower starts or a larger --budget may be proved)"
    if not tube.complete:
        why = f": {tube.reason}" if tube.reason else ""
        reason += f"; some of the starts could not be followed to the end{why}"
        reason += " (narrower starts or a larger --budget may help)"
    return reason


def first_open_box(tube: Tube) -> tuple[str, ...]:
    """Return in words the first box of starts without a proof."""
    if not tube.open:
        return ()
    if not tube.open[0]:  # a point start: nothing to halve
        never = f"the bounds grow too wide before {tube.duration:g} s, and the start is one point"
        return () if tube.complete else (f"{never}; a shorter time may be bounded",)
    box = ", ".join(stretch_text((name, *interval)) for name, interval in tube.open[0].items())
    more = len(tube.open) - 1
    return (f"in the way: {box}" + (f", and {more} other box{'es' * (more > 1)}" if more else ""),)


def horizon(problem: LoopProblem, claim: LoopClaim) -> float:
    """Return the longest time until runs are in a region, s."""
    rest = (problem.rests_from or 0) * problem.period
    return rest + max(problem.plant.duration or 0.0, 1000 * problem.period, claim.begin)


# ── an invariant region ──────────────────────────────────────────────────────────────


def claim_of_stability(claim: LoopClaim) -> LoopClaim:
    """Return the claim that a loop is stable, from the starts that its proof gives."""
    return replace(
        claim, stable=True, start=(), output="", error=False, low=0.0, high=0.0, when="always",
        begin=0.0, end=math.inf,
    )  # fmt: skip


class Haven:
    """An invariant region as the destination of a tube's boxes.

    Parameters
    ----------
    maker : FormMaker
        Of the loop.
    certificate : RegionProof
        Of stability of the sampled loop; checked here once more.
    loop : CheckedLoop
        The loop derived by the checker.
    claim : LoopClaim
        The claim to hold from there on.
    rests_from : int, optional
        The control period from which on the references are those of `maker`.

    Raises
    ------
    LoopProofError
        If the certificate proves nothing, or even the rest of the loop violates the claim.
    """

    def __init__(
        self, maker: FormMaker, certificate: RegionProof, loop: CheckedLoop, claim: LoopClaim,
        rests_from: int = 0,
    ) -> None:  # fmt: skip
        self.maker, self.claim = maker, claim
        self.p, self.rate, self.growth = certificate.p, certificate.rate, certificate.growth
        against = "it is of other states" if certificate.states != loop.names else ""
        if certificate.continuous:
            against = "it is of the loop in continuous time"
        against = against or region_refutation(maker.problem, loop, certificate)
        if against:
            raise LoopProofError(f"the region is not proved: {against}")
        self.loop = loop
        self.first = claimed_in(maker.problem, claim).first
        self.rests_from = rests_from
        self.horizon = rests_from * maker.problem.period + horizon(maker.problem, claim)
        self.level = self._level()
        self.factor, self.slack = _factored(self.p)
        self.rests = [
            outward(
                np.array(float_below(loop.rest[name])),
                np.array(float_above(loop.rest[name])),
            )
            for name in loop.names
        ]
        self._fading: dict[int, float] = {}
        self._before: NDArray[np.float64] | None = None

    def _level(self) -> float:
        """Return the largest V, among powers of 2, from which on the claim holds."""
        if not self.claim.output:
            return 1.0
        for halvings in range(40):
            level = exact(Fraction(1, 2**halvings))
            try:
                low, high = claimed_within(
                    self.maker.problem, self.loop, self.p, level * exact(self.growth), self.claim
                )
            except (FuzzyarmError, EnclosureError):
                continue
            if exact(self.claim.low) <= low and high <= exact(self.claim.high):
                return float(level)
        raise LoopProofError(
            "at rest, and next to it, the claim is not proved",
            hint="the range of a claim for all time must hold where the loop rests, with some room;"
            " a bounded time, as in 'during 0 .. 10 s', needs no rest",
        )

    def sign(self, period: int, states: Forms, memory: Mapping[str, Number]) -> NDArray[np.int64]:
        """Return the goal of tubes: to be in the region, deep enough for the claim in its time."""
        values = self.values(states, memory)
        later = values * self._decay(self.first - period)
        # Two more roundings at most: of a factor and a product.
        inside = (values <= 1.0) & (later * (1.0 + 1e-12) <= self.level)
        inside &= self.fixed(memory, states.shape[1])
        if period < self.rests_from:  # distances from the final rest do not count yet
            return np.zeros(len(values), dtype=np.int64)
        return np.where(inside, 1, -self._is_stalled(period, values).astype(np.int64))

    def fixed(self, memory: Mapping[str, Number], batch: int) -> NDArray[np.bool_]:
        """Return the boxes in which constants of the form have their assumed values."""
        fixed = np.ones(batch, dtype=bool)
        for name in self.maker.fixed:
            value, begun = memory[name], self.maker.begin[name]
            if isinstance(value, Forms):
                fixed &= (value.bounds.low == begun) & (value.bounds.high == begun)
            else:
                fixed &= value == begun
        return fixed

    def _is_stalled(self, period: int, values: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return the boxes no nearer than at half as many periods; only a hint to halve them."""
        stalled = np.zeros(len(values), dtype=bool)
        # Tested in periods 32, 64, 128 … only, each time against half as many.
        if period & (period - 1) or period < PATIENCE:
            return stalled
        before, self._before = self._before, values
        if before is not None and period > PATIENCE and before.shape == values.shape:
            return values >= before
        return stalled

    def _decay(self, periods: int) -> float:
        """Return an upper bound of the factor on V over some periods."""
        if periods <= 0:
            return 1.0
        if periods not in self._fading:
            self._fading[periods] = float_above(decay(self.rate, periods))
        return self._fading[periods]

    def values(self, states: Forms, memory: Mapping[str, Number]) -> NDArray[np.float64]:
        """Return an upper bound of V in each box.

        V ≤ (1 + slack) |Lᵀ z|², and each entry of Lᵀ z is an affine form, in which contributions of
        the same symbol cancel.
        """
        return self.nearness(states, memory, 0).value

    def nearness(self, states: Forms, memory: Mapping[str, Number], count: int) -> Nearness:
        """Return an upper bound of V in each box, and the contributions to its width.

        The first `count` symbols of the states, shape (states, boxes), are the starts.
        """
        batch = states.shape[1]
        names = self.maker.problem.states
        # z is the deviation from the true rest, known by an interval.
        rows: list[Forms] = []
        for name, rest in zip(self.loop.names, self.rests, strict=True):
            value = states[names.index(name)] if name in names else memory[name]
            forms = value if isinstance(value, Forms) else Forms.at(np.full(batch, value))
            low, high = np.full(batch, rest.low), np.full(batch, rest.high)
            rows.append(forms - Forms.between(low, high))
        z = stacked(rows)
        turn, size = self.factor.T, np.abs(self.factor.T)
        centre = turn @ z.centre
        parts = np.abs(np.matmul(turn, z.parts))
        spread, more = parts.sum(axis=0), size @ z.rest
        # Each entry is a sum of products: all of their roundings, relative to sums of magnitudes.
        doubt = (len(turn) + len(parts) + 4) * ROUNDING * (size @ (np.abs(z.centre) + z.spread))
        most = (np.abs(centre) + spread + more + doubt) * ENLARGED
        value = ((most * most).sum(axis=0) * (1.0 + self.slack)) * ENLARGED
        far = np.sqrt((parts[:count] ** 2).sum(axis=1))
        other = np.sqrt(((parts[count:].sum(axis=0) + more) ** 2).sum(axis=0))
        return Nearness(value, far, other)


def _factored(p: tuple[tuple[Fraction, ...], ...]) -> tuple[NDArray[np.float64], float]:
    """Return L and a slack with P < (1 + slack) L Lᵀ, checked in rationals."""
    plain = np.array([[float(x) for x in row] for row in p])
    # Scaled to ones on the diagonal first: units of states differ by orders of magnitude.
    scale = 1.0 / np.sqrt(np.diag(plain))
    balanced = plain * scale[:, None] * scale[None, :]
    factor = np.linalg.cholesky(balanced) / scale[:, None]
    rational = [[Fraction(float(x)) for x in row] for row in factor]
    size = range(len(p))
    square = [[sum((rational[i][k] * rational[j][k] for k in size), Fraction(0)) for j in size]
              for i in size]  # fmt: skip
    for slack in (2.0**-30, 2.0**-20, 2.0**-10):
        larger = [[(1 + Fraction(slack)) * square[i][j] - p[i][j] for j in size] for i in size]
        if is_positive_definite([[exact(x) for x in row] for row in larger]):
            return factor, slack
    raise LoopProofError("the region is too flat for its factors as floats")
