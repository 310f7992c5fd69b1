"""The attempts to prove a claim about a loop: forms under ever weaker assumptions, and their P.

Nothing here is trusted: each proposal goes to the checker.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product

import numpy as np

from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.proof.check.certificate import RegionProof
from fuzzyarm.proof.check.loop import System
from fuzzyarm.proof.check.region import falls, refutation, refutation_of_cones
from fuzzyarm.proof.claim.problem import LoopProofError
from fuzzyarm.proof.loop.affine import NotAffineError
from fuzzyarm.proof.loop.cones import cone_candidates, cone_forms
from fuzzyarm.proof.loop.form import Assumptions, Form, Matrix
from fuzzyarm.proof.loop.form_maker import FormMaker
from fuzzyarm.proof.loop.linear import Candidate, candidate
from fuzzyarm.proof.map.bounds import UnprovableError
from fuzzyarm.proof.stop import Stop

WHOLE = 1 - Fraction(1, 2**20)
"""The share of a signal that passes limits which hardly touch it."""

SHARES = (
    *(Fraction(x) for x in (1, 0.75, 0.5, 0.35, 0.25)),
    *(Fraction(1, 2**k) for k in range(3, 9)),
)
GRIPS = tuple(Fraction(x) for x in (0.7, 0.5, 0.3))


@dataclass(frozen=True)
class Proposal:
    """A candidate for the proof of a claim."""

    choice: Assumptions  # the assumptions
    form: Form  # the loop under them
    candidate: Candidate  # P and multipliers
    rate: Fraction = Fraction(0)  # relative fall of V per period
    parts: tuple[Form, ...] = ()  # the loop in each cone

    @property
    def size(self) -> float:
        """Size of its region."""
        return self.candidate.size

    def region(self, *, continuous: bool) -> RegionProof:
        """Return the region for a certificate."""
        form, chosen = self.form, self.candidate
        assert form.evidence is not None
        return RegionProof(
            form.evidence, continuous, chosen.p, chosen.multipliers, self.rate, form.names,
            chosen.cones, chosen.growth,
        )  # fmt: skip

    def refutation(self) -> str:
        """Return why the forms of the search do not prove it; empty if they do."""
        system, chosen = self.form.system, self.candidate
        if not chosen.cones:
            return refutation(system, chosen.p, chosen.multipliers, self.rate)
        systems = [part.system for part in self.parts]
        pairs = list(zip(systems, chosen.cones, strict=True))
        return refutation_of_cones(system, pairs, self.region(continuous=False))


def proposals(
    maker: FormMaker,
    claim: LoopClaim,
    stop: Stop,
    *,
    continuous: bool,
    target: tuple[float, float] | None,
) -> Iterator[Proposal | str]:
    """Yield proposals, and in words why an attempt failed."""
    search = _Search(maker, claim, stop, continuous, target)
    yield from search.affine() if maker.plant.is_affine else search.boxes()


class _Search:
    def __init__(
        self,
        maker: FormMaker,
        claim: LoopClaim,
        stop: Stop,
        continuous: bool,
        target: tuple[float, float] | None,
    ) -> None:
        self.maker, self.claim, self.stop = maker, claim, stop
        self.continuous, self.target = continuous, target
        self.grips = (Fraction(1),) if maker.fixed else (WHOLE,)

    @property
    def _starts(self) -> bool:
        """Whether the region has to contain a start."""
        return bool(self.claim.start or self.target)

    def _form(self, choice: Assumptions) -> Form | str:
        try:
            return self.maker.form(choice, continuous=self.continuous)
        except (NotAffineError, UnprovableError, LoopProofError) as error:
            return str(error)

    def _tried(self, choice: Assumptions) -> Iterator[Proposal | str]:
        form = self._form(choice)
        if isinstance(form, str):
            yield form
            return
        include = _start_vertices(self.maker, form) if self._starts else []
        beyond = _beyond(form, include)
        if beyond:
            yield beyond
            return
        if self.target is None:
            solution = candidate(form, include=include, stop=self.stop)
            yield self._proposal(choice, form, solution)
            return
        within = self._output_rows(form)
        if isinstance(within, str):
            yield within
            return
        if not self.claim.begin:
            for share in (Fraction(1), Fraction(9, 10), Fraction(3, 4)):
                rows = [(row, limit * share) for row, limit in within]
                solution = candidate(form, include=include, within=rows, stop=self.stop)
                yield self._proposal(choice, form, solution)
            return
        solution = candidate(form, include=include, stop=self.stop)
        yield self._proposal(choice, form, solution)
        periods = max(1.0, self.claim.begin / self.maker.problem.period)
        # V has to fall by e^-factor until the claim begins; a faster fall costs size.
        for factor in (2.0, 4.0, 8.0, 16.0, 32.0):
            rate = -math.expm1(-factor / periods)
            solution = candidate(form, include=include, rate=rate, stop=self.stop)
            yield self._proposal(choice, form, solution)

    def _output_rows(self, form: Form) -> list[tuple[tuple[Fraction, ...], Fraction]] | str:
        assert self.target is not None
        port = self.maker.problem.site.interface.port(self.claim.output)
        signal = form.outputs[port]
        low, high = (Fraction(x) - signal.constant for x in self.target)
        if not low < 0 < high:
            return f"{self.claim.output} rests at {float(signal.constant):.6g}, outside"
        limit = min(-low, high)
        return [(row, limit) for row in form.rows_of(signal)]

    def _proposal(
        self, choice: Assumptions, form: Form, candidate: Candidate | None
    ) -> Proposal | str:
        if candidate is None:
            condition = f" with {form.words[0]}" if form.words else ""
            return f"no quadratic function was found that falls{condition}"
        rate = Fraction(0)
        if self.claim.begin and not self.continuous:
            rate = rate_of(form.system, candidate.p, candidate.multipliers)
        return Proposal(choice, form, candidate, rate)

    # --- affine plants ---

    def affine(self) -> Iterator[Proposal | str]:
        """Yield proposals for an affine plant: rule bases over smaller and smaller ranges."""
        best = -math.inf
        for share in SHARES:
            # If the whole universes fail, is there any hope?
            if share == SHARES[1] and best == -math.inf:
                hopeless = self._hopeless({})
                if hopeless:
                    yield hopeless
                    yield from self._in_cones()
                    return
            here = -math.inf
            for along in (True, False):
                if self.stop.now:
                    return
                for proposal in self._tried(Assumptions(share, self.grips[0], {}, along)):
                    here = max(here, getattr(proposal, "size", -math.inf))
                    yield proposal
                    if _is_outside(proposal):  # all the more for a smaller share
                        return
                if here > -math.inf:
                    yield from self._looser(share, along)
                    break
            # A smaller share helps only if the whole universes failed.
            if here < best or (here > -math.inf and share == 1):
                return
            best = max(best, here)

    def _hopeless(self, box: dict[str, Fraction]) -> str:
        """Return why nothing will be found: a failure next to rest, under least assumptions."""
        reason = ""
        for along in (True, False):
            form = self._form(Assumptions(SHARES[-1], self.grips[0], box, along))
            if isinstance(form, str):
                reason = reason or form
            elif candidate(form, enlarge=False, stop=self.stop) is not None:
                return ""
            else:
                reason = "no quadratic function was found that falls, not even next to rest"
        return reason

    def _in_cones(self) -> Iterator[Proposal | str]:
        """Yield proposals with functions of cones, from rest outward as long as they hold."""
        if self._starts or self.continuous:
            return
        low, high, at = len(SHARES), -1, len(SHARES) - 1  # from rest outward as far as it holds
        while high < at < low and not self.stop.now:
            proposal = None
            choice = Assumptions(SHARES[at], self.grips[0], {}, along=False)
            for proposal in self._tried_in_cones(choice):
                yield proposal
            if isinstance(proposal, Proposal):
                low = at
            elif low == len(SHARES):
                return
            else:
                high = at
            at = (low + high) // 2

    def _tried_in_cones(self, choice: Assumptions) -> Iterator[Proposal | str]:
        form = self._form(choice)
        if isinstance(form, str):
            yield form
            return
        try:
            parts = cone_forms(self.maker, choice, form)
        except (NotAffineError, UnprovableError, LoopProofError) as error:
            yield str(error)
            return
        for solution in cone_candidates(form, parts, self.stop) if parts else ():
            yield Proposal(choice, form, solution, parts=tuple(parts))

    def _looser(self, share: Fraction, along: bool) -> Iterator[Proposal | str]:
        """Yield proposals with limits reached, if the region ends at them."""
        if self.maker.fixed:
            return
        form = self._form(Assumptions(share, self.grips[0], {}, along))
        if isinstance(form, str) or not any("limit" in b.words for b in form.bounds):
            return
        for grip in GRIPS:
            if not self.stop.now:
                yield from self._tried(Assumptions(share, grip, {}, along))

    # --- nonlinear plants ---

    def boxes(self) -> Iterator[Proposal | str]:
        """Yield proposals for a nonlinear plant: larger boxes first, until one holds.

        A smaller share of the universes makes rule bases more linear and allows a larger box, until
        the universes themselves end the region.
        """
        best = -math.inf
        for share in SHARES:
            if share == SHARES[3] and best == -math.inf:
                hopeless = self._hopeless(_tiny_box(self.maker, 1024))
                if hopeless:
                    yield hopeless
                    return
            here = -math.inf
            for along in (True, False):
                for proposal in self._boxes_of(share, along):
                    if isinstance(proposal, Proposal):
                        here = max(here, proposal.size)
                    yield proposal
                    if _is_outside(proposal):
                        return
                if here > -math.inf:
                    break
            if here < best or self.stop.now:
                return
            best = max(best, here)

    def _boxes_of(self, share: Fraction, along: bool) -> Iterator[Proposal | str]:
        """Yield proposals for one share: first without reaching limits, then more and more."""
        best = -math.inf
        last: Form | None = None
        for grip in (*self.grips, *(() if self.maker.fixed else GRIPS[1:])):
            if self.stop.now:  # slopes of rules without pieces take long
                return
            form = self._form(Assumptions(share, grip, _tiny_box(self.maker, 1024), along))
            if isinstance(form, str):
                yield form
                return
            if last is not None and form.is_same_loop(last):  # limits pass more than this share
                return
            last = form
            shape = self._shape(form)
            if isinstance(shape, str):
                yield shape
                return
            before = best
            for proposal in self._largest(share, along, grip, shape):
                if isinstance(proposal, Proposal):
                    best = max(best, proposal.size)
                yield proposal
            if best <= before or self.stop.now:  # reaching limits helps no more
                return

    def _shape(self, form: Form) -> dict[str, float] | str:
        """Return the half-axes of the region for a nearly linear plant."""
        free = replace(
            form,
            bounds=tuple(b for b in form.bounds if not b.words.startswith("the box of")),
        )
        solution = candidate(free, stop=self.stop)
        if solution is None:
            return "no quadratic function was found that falls next to rest"
        return _half_axes(solution.p, form)

    def _box(self, shape: dict[str, float], scale: float) -> dict[str, Fraction]:
        return {
            name: Fraction(scale * shape[name]).limit_denominator(10**9)
            for name in self.maker.problem.states
        }

    def _around_start(
        self, share: Fraction, along: bool, grip: Fraction, shape: dict[str, float]
    ) -> Iterator[Proposal | str]:
        """Yield attempts with growing boxes of one shape that contain the start."""
        maker = self.maker
        scale = 1e-6
        for name, span in maker.problem.start.items():
            far = max(abs(float(Fraction(end) - maker.rest[name])) for end in span)
            scale = max(scale, far / max(shape[name], 1e-300))
        for factor in (1.05, 1.3, 1.7, 2.3):
            if not self.stop.now:
                yield from self._tried(
                    Assumptions(share, grip, self._box(shape, factor * scale), along)
                )

    def _largest(
        self, share: Fraction, along: bool, grip: Fraction, shape: dict[str, float]
    ) -> Iterator[Proposal | str]:
        """Yield attempts with boxes of one shape, and last the largest proposal."""
        if self._starts:
            yield from self._around_start(share, along, grip, shape)
            return
        best: Proposal | None = None
        scale, low, high = 1.0, 0.0, math.inf
        for _ in range(14):
            if self.stop.now:
                break
            box = self._box(shape, scale)
            candidate_proposal: Proposal | None = None
            for proposal in self._tried(Assumptions(share, grip, box, along)):
                if isinstance(proposal, Proposal):
                    candidate_proposal = proposal
                else:
                    yield proposal
            if candidate_proposal is None:
                high = scale
            elif best is None or candidate_proposal.size > best.size:
                best, low = candidate_proposal, scale
                # The region may have another shape than the box, which shrinks to its reach.
                axes = _half_axes(candidate_proposal.candidate.p, candidate_proposal.form)
                shape = {n: min(x, 1.05 * axes[n] / scale) for n, x in shape.items()}
            else:
                break
            scale = _next_scale(scale, low, high)
            if not scale:
                break
        if best is not None:
            yield best


def form_at_rest(maker: FormMaker) -> Form:
    """Return the loop next to rest, with no limit reached."""
    box = {} if maker.plant.is_affine else _tiny_box(maker, 1024)
    return maker.form(Assumptions(SHARES[-1], Fraction(1), box, True))


def _tiny_box(maker: FormMaker, parts: int) -> dict[str, Fraction]:
    """Return a box of states next to rest, from the sensors' ranges."""
    typical = dict.fromkeys(maker.problem.states, 1.0)
    for (_, name), port in maker.problem.site.interface.outputs.items():
        if name in typical and math.isfinite(port.high - port.low):
            typical[name] = 0.5 * (port.high - port.low)
    return {name: Fraction(half / parts) for name, half in typical.items()}


def _start_vertices(maker: FormMaker, form: Form) -> list[tuple[Fraction, ...]]:
    """Return the corners of the start as deviations from rest, with the initial memory."""
    start, begin = maker.problem.start, maker.begin
    ends = [dict.fromkeys(map(Fraction, start[name])) for name in maker.problem.states]
    if 2 ** sum(len(end) > 1 for end in ends) > 4096:
        raise LoopProofError("a start of more than 12 intervals")
    vertices = []
    for corner in product(*ends):
        states = dict(zip(maker.problem.states, corner, strict=True))
        off = {name: x - form.rest[name] for name, x in states.items()}
        z = list(off.values())
        for name in form.names[len(states) :]:
            seed = form.seeds.get(name)
            if seed is None:
                value = Fraction(begin[name])
            else:
                value = seed.constant + sum(
                    (w * off[n] for n, w in seed.parts.items()), Fraction(0)
                )
            z.append(value - form.rest[name])
        vertices.append(tuple(z))
    return vertices


BEYOND = "the start goes beyond "


def _is_outside(proposal: Proposal | str) -> bool:
    """Return whether the reason is a start outside the universe of a rule base."""
    return isinstance(proposal, str) and proposal.startswith(f"{BEYOND}'")


def _beyond(form: Form, points: Sequence[Sequence[Fraction]]) -> str:
    """Return a bound of a form violated at some point; empty if all hold."""
    for row, limit, words in form.rows_within():
        for z in points:
            if abs(sum((g * x for g, x in zip(row, z, strict=True)), Fraction(0))) >= limit:
                return f"{BEYOND}{words}"
    return ""


def _next_scale(scale: float, low: float, high: float) -> float:
    """Return the next trial between the largest success and the least failure; 0: none."""
    if math.isinf(high):
        return 1.3 * scale
    if not low:
        return 0.6 * scale
    return 0.0 if high / low < 1.07 else math.sqrt(low * high)


def _half_axes(p: Matrix, form: Form) -> dict[str, float]:
    inverse = np.linalg.inv(np.array([[float(x) for x in row] for row in p]))
    halves = np.sqrt(np.maximum(np.diag(inverse), 0.0))
    return dict(zip(form.names, halves.tolist(), strict=True))


def rate_of(form: System, p: Matrix, multipliers: tuple[Fraction, ...]) -> Fraction:
    """Return a proved relative fall of V per period."""
    return greatest_rate(lambda rate: falls(form, p, multipliers, rate))


def greatest_rate(does_fall: Callable[[Fraction], bool]) -> Fraction:
    """Return a proved relative fall: a power of 2, then somewhat more; 0: none."""
    low, high = 0, 48  # exponents: 1 and practically 0
    while high - low > 1:
        middle = (low + high) // 2
        if does_fall(Fraction(1, 2**middle)):
            high = middle
        else:
            low = middle
    rate = Fraction(1, 2**high)
    if not does_fall(rate):
        return Fraction(0)
    for eighths in (15, 13, 12, 11, 10, 9):
        if does_fall(rate * eighths / 8):
            return rate * eighths / 8
    return rate
