"""The search for certificates of tubes: boxes of starts, halved for the checker to follow."""

from __future__ import annotations

import contextlib
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
    new_certificate,
)
from fuzzyarm.proof.check.region import accepted
from fuzzyarm.proof.check.rules import RuleSurfaces
from fuzzyarm.proof.check.theorem import demand_proved, ends_of_boxes, follow_tubes
from fuzzyarm.proof.check.tube import Followed, Follower, Haven, Task
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.claim.text import claimed_in, problem_of
from fuzzyarm.proof.loop.timed import horizon
from fuzzyarm.proof.loop.waypoints import joined, waypoints
from fuzzyarm.proof.stop import TUBE_BUDGET, Stop, TimeOverError

MOST_HALVINGS = 12

MANY = 20_000
"""Total periods of all boxes from which on waypoints are searched."""

HALVED_AGAIN = 2
"""Most halvings of a map's box that the checker cannot follow as a whole."""

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
    """Search a certificate of a claim for a bounded time, or until a proved region.

    Parameters
    ----------
    text, claim, plant, connect, sensors
        As for :func:`fuzzyarm.proof.loop.prove_loop`.
    budget : float
        s.
    tell : callable, optional
        Called with the number of boxes so far, and NaN.
    regions : sequence of RegionProof, optional
        Destination regions.

    Raises
    ------
    LoopProofError
        If none was found: a certificate has simpler sets than a tube, and may prove less.
    """
    if not regions and (not claim.output or math.isinf(claim.end)):
        raise LoopProofError("a tube is certified of a claim with an end", hint="during 0 .. 1 s")
    if claim.stable and not regions:
        raise LoopProofError("a tube does not show that a loop is stable")
    problem = problem_of(text, claim, plant=plant, sensors=sensors, connect=connect)
    stop = Stop(budget, tell)
    start = tuple((Fraction(x.low), Fraction(x.high)) for x in problem.start.values())
    if regions:
        whole = TubeProof(
            start, math.ceil(horizon(problem, claim) / problem.period), ("regions", 0)
        )
    else:
        last = claimed_in(problem, claim).last
        whole = TubeProof(start, 0 if last is None else last + 1)
    certificate = new_certificate(problem, claim, regions)
    try:
        found = _Halving(problem, certificate, [whole], problem.states, MOST_HALVINGS, stop)
        if found.lost:
            raise LoopProofError(next(iter(found.lost.values())))
        return found.certificate()
    except (LoopProofError, TimeOverError) as error:
        raise LoopProofError(f"no certificate was found: {error}") from error


def certify_map(
    problem: LoopProblem,
    whole: Certificate,
    boxes: Sequence[tuple[Box, int]],
    stop: Stop,
) -> tuple[Certificate, int, dict[Box, str]]:
    """Return the certificate of a map: the boxes that the checker follows.

    `whole` is the certificate of its region, with the window. Boxes have all states of the plant
    and their arrival periods, in the order of arrival. Also returned are the number of boxes, the
    first ones, that are waypoints instead of starts, and the boxes left out with their reasons.
    """
    tubes = [TubeProof(box, 2 * periods + 20, ("regions", 0)) for box, periods in boxes]
    names = [name for name, *_ in whole.window]
    found = _Halving(problem, whole, tubes, names, HALVED_AGAIN, stop)
    lost = {tube.box: reason for tube, reason in found.lost.items()}
    return found.certificate(), found.ways, lost


class _Halving:
    """Boxes for the checker to follow, halved where it cannot.

    Attributes
    ----------
    found : list of TubeProof
        Followed boxes.
    lost : dict of TubeProof to str
        Boxes not followed, and why.
    ways : int
        Number of waypoints, first in `found`.
    """

    def __init__(
        self, problem: LoopProblem, whole: Certificate, tubes: Sequence[TubeProof],
        names: Sequence[str], halvings: int, stop: Stop,
    ) -> None:  # fmt: skip
        self.problem, self.whole = problem, whole
        self.found: list[TubeProof] = []
        self.ways = 0
        self.lost = dict.fromkeys(tubes, "time ran out before the checker had followed it")
        self.surfaces = RuleSurfaces()
        wide = [
            k for k, name in enumerate(problem.states)
            if name in names and any(low < high for low, high in (tube.box[k] for tube in tubes))
        ]  # fmt: skip
        with contextlib.suppress(TimeOverError), stop:
            havens = [Haven(accepted(problem.at_rest, r, self.surfaces), r) for r in whole.regions]
            self.follower = Follower(problem, havens, self.surfaces)
            remembers = self.follower.memory or problem.text.model.every > 1
            if whole.window and not remembers and sum(t.periods for t in tubes) > MANY:
                with contextlib.suppress(TimeOverError), stop.half():
                    self._by_waypoints(wide)
            for depth in range(halvings + 1):
                self._follow(list(self.lost))
                if not self.lost or not wide or depth == halvings:
                    break
                axis = wide[depth % len(wide)]
                self.lost = {
                    half: why for tube, why in self.lost.items() for half in _halves(tube, axis)
                }
                stop.check(len(self.found) + len(self.lost))

    def _by_waypoints(self, axes: Sequence[int]) -> None:
        """Accept boxes that lead into waypoints of many, joined into larger boxes if possible."""
        ways, caught = waypoints(self.follower, list(self.lost))
        for tube in caught:
            del self.lost[tube]
        self.found += ways
        self.ways = len(ways)
        for tube, periods in joined(self.follower, ways, caught, axes).items():
            self.found.append(TubeProof(tube.box, periods, ("tubes", len(ways))))

    def _follow(self, tubes: Sequence[TubeProof]) -> None:
        """Accept the boxes that are followed to their end."""
        results = follow_tubes(self.follower, self.whole.claim, tubes)
        for tube, followed in zip(tubes, results, strict=True):
            self._accept(tube, followed)
        while self.whole.window and self.lost and self.found and not self.follower.memory:
            # In the map of a loop without memory, also boxes that lead into earlier ones.
            ends = ends_of_boxes([tube.box for tube in self.found])
            count, waiting = len(self.found), list(self.lost)
            results = self.follower.follow(
                [tube.box for tube in waiting], [tube.periods for tube in waiting],
                Task(boxes=ends, any_period=True),
            )  # fmt: skip
            for tube, followed in zip(waiting, results, strict=True):
                self._accept(tube, followed, joined=count)
            if len(self.found) == count:
                break

    def _accept(self, tube: TubeProof, followed: Followed, *, joined: int = 0) -> None:
        if not followed.against:
            del self.lost[tube]
            way = tube._replace(into=("tubes", joined)) if joined else tube
            self.found.append(way._replace(periods=followed.periods))
        elif not joined:
            self.lost[tube] = followed.against

    def certificate(self) -> Certificate:
        """Return the resulting certificate, accepted by the checker."""
        certificate = replace(self.whole, tubes=tuple(self.found))
        if self.found:
            demand_proved(self.problem, certificate, self.surfaces)
        return certificate


def _halves(tube: TubeProof, axis: int) -> list[TubeProof]:
    low, high = tube.box[axis]
    middle = Fraction(0.5 * float(low) + 0.5 * float(high))
    return [
        tube._replace(box=(*tube.box[:axis], ends, *tube.box[axis + 1 :]))
        for ends in ((low, middle), (middle, high))
    ]
