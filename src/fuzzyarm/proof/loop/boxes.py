"""Certificates of tubes, found: boxes of starts, halved until the checker can follow them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction

from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.control.loop.course import Sensor
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.plant.plant import Plant
from fuzzyarm.proof.check.certificate import (
    Certificate,
    RegionProof,
    TubeProof,
    fingerprints_of,
    sensors_by_name,
)
from fuzzyarm.proof.check.checking import follow_box
from fuzzyarm.proof.check.region import accepted
from fuzzyarm.proof.check.tube import Follower, Haven
from fuzzyarm.proof.claim.identity import loop_digests
from fuzzyarm.proof.claim.problem import LoopProofError
from fuzzyarm.proof.claim.text import claimed_in, problem_of
from fuzzyarm.proof.loop.timed import TUBE_BUDGET
from fuzzyarm.proof.stop import Stop, TimeOverError

__all__ = ["certify_tube"]

MOST_HALVINGS = 12


def certify_tube(
    text: ControllerText,
    claim: LoopClaim,
    *,
    plant: Plant | None = None,
    connect: Mapping[str, str] | None = None,
    sensors: Mapping[str, Sensor] | None = None,
    budget: float = TUBE_BUDGET,
    tell: Callable[[int, float], None] | None = None,
    regions: Sequence[RegionProof] = (),
) -> Certificate:
    """Make a certificate of a claim for a bounded time, or until a proved region.

    Parameters
    ----------
    text, claim, plant, connect, sensors
        As for :func:`fuzzyarm.proof.loop.prove_loop`.
    budget : float
        s.
    tell : callable, optional
        Called with the number of boxes so far, and NaN.
    regions : sequence of RegionProof, optional
        Where runs may arrive.

    Raises
    ------
    LoopProofError
        If none was found: a tube may prove what the simpler sets of a certificate do not.
    """
    if not regions and (not claim.output or math.isinf(claim.end)):
        raise LoopProofError("a tube is certified of a claim with an end", hint="during 0 .. 1 s")
    if claim.stable and not regions:
        raise LoopProofError("a tube does not show that a loop is stable")
    problem = problem_of(text, claim, plant=plant, sensors=sensors, connect=connect)
    stop = Stop(budget, tell)
    start = tuple((Fraction(x.low), Fraction(x.high)) for x in problem.start.values())
    wide = [k for k, (low, high) in enumerate(start) if low < high]
    tubes: list[TubeProof] = []
    waiting = [(start, 0)]
    try:
        with stop:
            follower = Follower(problem, [Haven(accepted(problem, r), r) for r in regions])
            if regions:
                most = max(problem.plant.duration or 0.0, claim.begin, 1000 * problem.period)
                whole = TubeProof(start, math.ceil(most / problem.period), ("regions", (0,)))
            else:
                last = claimed_in(problem, claim).last
                whole = TubeProof(start, 0 if last is None else last + 1)
            while waiting:
                box, halvings = waiting.pop(0)
                stop.check(len(tubes) + 1)
                try:
                    tube = whole._replace(box=box)
                    arrival = follow_box(follower, claim, [tube], 0)
                except LoopProofError:
                    if not wide or halvings >= MOST_HALVINGS:
                        raise
                    # Along each of the states in turn, as the whole box was wide.
                    waiting += _halves(box, wide[halvings % len(wide)], halvings)
                else:
                    tubes.append(tube._replace(periods=arrival.periods))
    except (LoopProofError, TimeOverError) as error:
        raise LoopProofError(f"no certificate was found: {error}") from error
    return Certificate(
        claim, text.path, fingerprints_of(text), tuple(regions), tuple(tubes),
        sensors_by_name(problem), dict(connect or {}), loop_digests(text, problem.plant),
    )  # fmt: skip


def _halves(
    box: tuple[tuple[Fraction, Fraction], ...], axis: int, halvings: int
) -> list[tuple[tuple[tuple[Fraction, Fraction], ...], int]]:
    low, high = box[axis]
    middle = (low + high) / 2
    return [
        ((*box[:axis], ends, *box[axis + 1 :]), halvings + 1)
        for ends in ((low, middle), (middle, high))
    ]
