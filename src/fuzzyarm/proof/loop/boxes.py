"""Certificates of tubes, found: boxes of starts, halved until the checker can follow them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.control.loop.course import Sensor
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.plant.plant import Plant
from fuzzyarm.proof.check.certificate import (
    Certificate,
    Pair,
    RegionProof,
    TubeProof,
    delays_by_name,
    fingerprints_of,
    sensors_by_name,
)
from fuzzyarm.proof.check.checking import ends_of_boxes, follow_tubes, refused_box
from fuzzyarm.proof.check.region import accepted
from fuzzyarm.proof.check.tube import Follower, Haven, Task
from fuzzyarm.proof.claim.identity import loop_digests
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.claim.text import claimed_in, problem_of
from fuzzyarm.proof.loop.timed import TUBE_BUDGET
from fuzzyarm.proof.stop import Stop, TimeOverError

__all__ = ["certify_map", "certify_tube"]

MOST_HALVINGS = 12

HALVED_AGAIN = 2
"""How often a box of a map is halved that the checker does not follow as a whole."""

Box = tuple[Pair, ...]


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
    try:
        with stop:
            follower = Follower(problem, [Haven(accepted(problem, r), r) for r in regions])
            if regions:
                most = max(problem.plant.duration or 0.0, claim.begin, 1000 * problem.period)
                whole = TubeProof(start, math.ceil(most / problem.period), ("regions", 0))
            else:
                last = claimed_in(problem, claim).last
                whole = TubeProof(start, 0 if last is None else last + 1)
            tubes, lost = _followed(follower, claim, [whole], MOST_HALVINGS, stop)
            if lost:
                raise LoopProofError(next(iter(lost.values())))
    except (LoopProofError, TimeOverError) as error:
        raise LoopProofError(f"no certificate was found: {error}") from error
    return Certificate(
        claim, text.path, fingerprints_of(text), tuple(regions), tuple(tubes),
        sensors_by_name(problem), dict(connect or {}), loop_digests(text, problem.plant),
        delays=delays_by_name(problem.plant),
    )  # fmt: skip


def _followed(
    follower: Follower, claim: LoopClaim, tubes: Sequence[TubeProof], halvings: int, stop: Stop
) -> tuple[list[TubeProof], dict[TubeProof, str]]:
    """Return tubes that the checker follows, halved so often at most; and others, with reasons."""
    wide = [
        k for k, ends in enumerate(zip(*(tube.box for tube in tubes), strict=True))
        if any(low < high for low, high in ends)
    ]  # fmt: skip
    found: list[TubeProof] = []
    lost: dict[TubeProof, str] = {}
    for depth in range(halvings + 1):
        waiting: list[TubeProof] = []
        for tube, followed in zip(tubes, follow_tubes(follower, claim, tubes), strict=True):
            if not followed.against:
                found.append(tube._replace(periods=followed.periods))
            elif not wide or depth == halvings:
                lost[tube] = followed.against
            else:  # along each of the states in turn
                waiting += _halves(tube, wide[depth % len(wide)])
        tubes = waiting
        if not tubes:
            break
        stop.check(len(found) + len(tubes))
    return found, lost


def _halves(tube: TubeProof, axis: int) -> list[TubeProof]:
    low, high = tube.box[axis]
    middle = Fraction(0.5 * float(low) + 0.5 * float(high))
    return [
        tube._replace(box=(*tube.box[:axis], ends, *tube.box[axis + 1 :]))
        for ends in ((low, middle), (middle, high))
    ]


# ── maps ─────────────────────────────────────────────────────────────────────────────


def certify_map(
    problem: LoopProblem,
    whole: Certificate,
    boxes: Sequence[tuple[Box, int]],
    stop: Stop,
    halvings: int = HALVED_AGAIN,
) -> tuple[Certificate, dict[Box, str]]:
    """Make the certificate of a map: what of its boxes the checker follows.

    Parameters
    ----------
    problem : LoopProblem
        The loop, as the plant begins.
    whole : Certificate
        Of its region, with the window.
    boxes : sequence of (box, int)
        All states of the plant, and in how many periods they arrived, those that did first first.
    stop : Stop
        When to give up.
    halvings : int
        How often a box is halved of which the checker does not say so.

    Returns
    -------
    (Certificate, dict of box to str)
        And the boxes that are not in it, with the reason.
    """
    claim, found = whole.claim, list[TubeProof]()
    waiting = [TubeProof(box, 2 * periods + 20, ("regions", 0)) for box, periods in boxes]
    wide = [k for k, name in enumerate(problem.states) if name in {n for n, *_ in whole.window}]
    reasons: dict[Box, str] = {}
    try:
        with stop:
            haven = Haven(accepted(problem, whole.region), whole.region)
            follower = Follower(problem, [haven])
            for depth in range(halvings + 1):
                waiting = _arriving(follower, claim, waiting, found, reasons)
                while waiting and not follower.memory:
                    before = len(found)
                    waiting = _joining(follower, waiting, found)
                    if len(found) == before:
                        break
                if depth < halvings:
                    axis = wide[depth % len(wide)]
                    waiting = [half for tube in waiting for half in _halves(tube, axis)]
    except TimeOverError:
        reasons = {tube.box: "time ran out before the checker had followed it" for tube in waiting}
    refused = refused_box(follower, claim, found) if found else None
    if refused is not None:
        raise LoopProofError("followed anew, box {} is refused: {}".format(*refused))
    return replace(whole, tubes=tuple(found)), {
        tube.box: reasons.get(tube.box, "the checker does not follow it") for tube in waiting
    }


def _arriving(
    follower: Follower, claim: LoopClaim, tubes: Sequence[TubeProof], found: list[TubeProof],
    reasons: dict[Box, str],
) -> list[TubeProof]:  # fmt: skip
    """Take in the boxes that lead into the region; return the others."""
    waiting = []
    for tube, followed in zip(tubes, follow_tubes(follower, claim, tubes), strict=True):
        if followed.against:
            waiting.append(tube)
            reasons[tube.box] = followed.against
        else:
            # Beside other boxes its symbols may be taken together otherwise, and arrive later.
            found.append(tube._replace(periods=followed.periods + 5 + followed.periods // 8))
    return waiting


def _joining(
    follower: Follower, tubes: Sequence[TubeProof], found: list[TubeProof]
) -> list[TubeProof]:
    """Take in the boxes that lead into those before them; return the others."""
    task = Task(boxes=ends_of_boxes([tube.box for tube in found]), any_period=True)
    boxes, periods = [tube.box for tube in tubes], [tube.periods for tube in tubes]
    count, waiting = len(found), []
    for tube, followed in zip(tubes, follower.follow(boxes, periods, task), strict=True):
        if followed.against:
            waiting.append(tube)
        else:
            found.append(TubeProof(tube.box, followed.periods, ("tubes", count)))
    return waiting
