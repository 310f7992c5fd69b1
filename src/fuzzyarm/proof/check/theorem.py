"""The proof of a certificate's claim: by a region, tubes, the boxes of a map, or parts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np

from fuzzyarm.base.numbers import outward_text
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.proof.check.certificate import (
    Certificate,
    Pair,
    TubeProof,
)
from fuzzyarm.proof.check.numbers import exact, float_above, float_below
from fuzzyarm.proof.check.region import (
    ROUNDED,
    accepted,
    outside,
    region_facts,
    rests_of,
    verified,
)
from fuzzyarm.proof.check.rules import RuleSurfaces
from fuzzyarm.proof.check.tube import Followed, Follower, Haven, Task, covered
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.claim.text import claimed_in, problem_of

MOST_CELLS = 1 << 26
"""Most cells of a window cut at the sides of all boxes of its map."""

MOST_EXACT_CELLS = 1 << 16
"""Most cells that are added up as rationals; the share of more is rounded down by floats."""

OF_REGIONS = (
    "V = z'Pz falls in each control period for all gains between the proved ones (Lyapunov,"
    " S-procedure), so that no run leaves V <= 1 and all go to rest"
)

OF_CONES = (
    "in each cone of states, by the sides of the inputs of rule bases, V = z'Pz is another, and in"
    " each control period it falls from one to the next (S-procedure), so that all runs go to rest"
)

OF_TUBES = "sets hold all runs from one sample to the next (mean value theorem)"

OF_MAPS = "each box leads into a region or into boxes before it (induction)"

OF_PARTS = "its parts are all of the parameters, and each is proved by itself"


@dataclass(frozen=True)
class CheckedProof:
    """A proof of a certificate's claim.

    Attributes
    ----------
    problem : LoopProblem
        The loop.
    havens : tuple of Haven
        Its proved regions.
    facts : dict of str to object
        Facts of the first region, or of the regions of all parts, as fields of a verdict.
    loop, theorems : tuple of str
        In words.
    coverage : Fraction
        Of a map: proved share of its window, rounded down.
    """

    problem: LoopProblem
    havens: tuple[Haven, ...]
    facts: Mapping[str, Any]
    loop: tuple[str, ...]
    theorems: tuple[str, ...]
    coverage: Fraction = Fraction(0)


def demand_proved(
    problem: LoopProblem, certificate: Certificate, surfaces: RuleSurfaces | None = None
) -> CheckedProof:
    """Return the proof of a certificate's claim; LoopProofError if it fails."""
    surfaces = surfaces or RuleSurfaces()
    if certificate.parts:
        return _proof_by_parts(problem, certificate, surfaces)
    return _proof_of(problem, certificate, surfaces)


def _proof_of(
    problem: LoopProblem, certificate: Certificate, surfaces: RuleSurfaces
) -> CheckedProof:
    """Return the proof of a certificate without parts."""
    claim, regions, tubes = certificate.claim, certificate.regions, certificate.tubes
    facts: Mapping[str, Any] = {}
    coverage = _coverage(problem, certificate) if certificate.window else Fraction(0)
    if tubes and not (claim.start or claim.output or certificate.window):
        raise LoopProofError("it has tubes, and claims nothing of starts")
    if not tubes:
        if len(regions) != 1:
            raise LoopProofError("it has no region, or several and no tube")
        against, facts, loop = verified(problem, claim, regions[0], surfaces)
        if against or loop is None:
            raise LoopProofError(against)
        havens = [Haven(loop, regions[0])]
    else:
        if certificate.continuous:
            raise LoopProofError("tubes are of the loop as sampled")
        havens = [Haven(accepted(problem.at_rest, r, surfaces), r) for r in regions]
        facts = region_facts(problem, *havens[0]) if havens else {}
        _follow(Follower(problem, havens, surfaces), claim, tubes)
    if certificate.window and not coverage:
        raise LoopProofError("none of its boxes is in its window")
    theorems = (
        *((OF_REGIONS,) if any(not region.cones for region in regions) else ()),
        *((OF_CONES,) if any(region.cones for region in regions) else ()),
        *((OF_TUBES,) if tubes else ()),
        *((OF_MAPS,) if certificate.window else ()),
    )
    words = tuple(map(_loop_words, havens))
    return CheckedProof(problem, tuple(havens), facts, words, theorems, coverage)


def _proof_by_parts(
    problem: LoopProblem, certificate: Certificate, surfaces: RuleSurfaces
) -> CheckedProof:
    """Return the proof of a claim from proofs for parts of its parameters."""
    if certificate.window or certificate.regions or certificate.tubes:
        raise LoopProofError("beside its parts it has a map, regions or tubes")
    parts = certificate.by_part
    if len({part.continuous for part in parts}) > 1:
        raise LoopProofError("its parts are of the loop as sampled and in continuous time")
    _require_all_parameters(certificate)
    proofs = [
        _proof_of(
            problem_of(
                problem.text, part.claim, plant=problem.given or problem.plant,
                sensors=certificate.sensors, connect=certificate.connect,
            ),
            part, surfaces,
        )
        for part in parts
    ]  # fmt: skip
    return CheckedProof(
        problem,
        tuple(haven for proof in proofs for haven in proof.havens),
        {} if any(part.tubes for part in parts) else _facts_of_parts(proofs),
        tuple(words for proof in proofs for words in proof.loop),
        tuple(dict.fromkeys(
            (*(theorem for proof in proofs for theorem in proof.theorems), OF_PARTS)
        )),
    )  # fmt: skip


def _require_all_parameters(certificate: Certificate) -> None:
    """Refuse parts that do not cover the claim's parameters."""
    names = [name for name, _, _ in certificate.claim.parameters]
    boxes = [{name: (a, b) for name, a, b in part.parameters} for part in certificate.parts]
    if any(len(part.parameters) != len(names) or set(box) != set(names)
           for part, box in zip(certificate.parts, boxes, strict=True)):  # fmt: skip
        raise LoopProofError("its parts are of other parameters than its claim")
    ends = np.array([[box[name] for name in names] for box in boxes])
    whole = [(low, high) for _, low, high in certificate.claim.parameters]
    if not (names and np.isfinite(ends).all() and covered(whole, ends[..., 0], ends[..., 1])):
        raise LoopProofError("its parts are not all of the parameters")


def _facts_of_parts(proofs: Sequence[CheckedProof]) -> dict[str, Any]:
    """Return the facts common to the regions of all parts: the least reach around a rest."""
    facts, loops = [proof.facts for proof in proofs], [proof.havens[0].loop for proof in proofs]
    region, rests = dict[str, tuple[float, float]](), dict[str, tuple[float, float]]()
    for name in facts[0]["region"]:
        if not all(name in each["region"] for each in facts):
            continue
        spans = [(float_below(loop.rest[name]), float_above(loop.rest[name])) for loop in loops]
        ends = [each["region"][name] for each in facts]
        low, high = min(a for a, _ in spans), max(b for _, b in spans)
        if high - low <= ROUNDED * max(abs(low), abs(high), 1.0):
            region[name] = max(a for a, _ in ends), min(b for _, b in ends)
            continue
        rests[name] = low, high
        around = min(
            min(exact(a) - exact(x), exact(y) - exact(b))
            for (a, b), (x, y) in zip(spans, ends, strict=True)
        )
        region[name] = float_above(exact(low) - around), float_below(exact(high) + around)
    alone = {
        name: min(each["start_region"][name] for each in facts)
        for name in facts[0]["start_region"]
        if all(name in each["start_region"] for each in facts)
    }
    rest = {name: 0.5 * a + 0.5 * b for name, (a, b) in rests.items()}
    return {
        "region": region, "start_region": alone, "rest": {**facts[0]["rest"], **rest},
        "rests": rests, "fall": min(each["fall"] for each in facts),
        "continuous": any(each["continuous"] for each in facts),
        "uncertain": tuple(dict.fromkeys(word for each in facts for word in each["uncertain"])),
    }  # fmt: skip


def _loop_words(haven: Haven) -> str:
    loop = haven.loop
    wide = rests_of(loop)
    rest = ", ".join(
        f"{name} = {rest_words(wide[name], 6) if name in wide else f'{float(x):.6g}'}"
        for name, x in loop.rest.items()
    )
    gains = f", unknown gains: {'; '.join(loop.words)}" if loop.words else ""
    return f"derived a loop of {loop.size} states at rest where {rest}{gains}"


def rest_words(rests: tuple[float, float], digits: int) -> str:
    """Return the bounds of an equilibrium in words."""
    ends = (
        outward_text(end, up=up, digits=digits)
        for end, up in zip(rests, (False, True), strict=True)
    )
    return f"{' .. '.join(ends)} by its parameters"


def _follow(follower: Follower, claim: LoopClaim, tubes: Sequence[TubeProof]) -> None:
    """Follow all boxes; a claim with starts needs all starts inside the boxes."""
    for number, followed in enumerate(follow_tubes(follower, claim, tubes), 1):
        if followed.against:
            raise LoopProofError(f"box {number}: {followed.against}")
    if claim.start or claim.output:
        start = [(Fraction(x.low), Fraction(x.high)) for x in follower.problem.start.values()]
        boxes = np.array([tube.box for tube in tubes], dtype=object)
        if not covered(start, boxes[..., 0], boxes[..., 1]):
            raise LoopProofError("its boxes are not all of the starts")


def follow_tubes(
    follower: Follower, claim: LoopClaim, tubes: Sequence[TubeProof]
) -> list[Followed]:
    """Follow the boxes of tubes to their destinations; LoopProofError if one fails."""
    numbers_by_goal: dict[tuple[str, int], list[int]] = {}
    for number, tube in enumerate(tubes):
        kind, index = tube.into
        if kind == "tubes" and (claim.output or index > number):
            raise LoopProofError(
                f"box {number + 1}: it leads into boxes that are not known to arrive"
            )
        # Boxes that lead into others may lead into a region instead: all are followed together.
        goal = ("regions", 0) if kind == "tubes" else (kind, index)
        if goal[0] == "regions" and goal[1] >= len(follower.havens):
            raise LoopProofError(f"box {number + 1}: there is no region {goal[1]}")
        numbers_by_goal.setdefault(goal, []).append(number)
    results = [Followed(0)] * len(tubes)
    for (destination, index), numbers in numbers_by_goal.items():
        boxes, periods = [tubes[k].box for k in numbers], [tubes[k].periods for k in numbers]
        counts = np.array([_before(tubes[k]) for k in numbers])
        if destination == "regions":
            task = _into_region(follower, claim, index)
            if counts.any():
                task = task._replace(boxes=ends_of_boxes([tube.box for tube in tubes]))
        else:
            last = claimed_in(follower.problem, claim).last if claim.output else None
            if last is None or claim.stable:
                raise LoopProofError("it ends before the claim does")
            task, periods = Task(claim), [last + 1] * len(numbers)
        for number, followed in zip(
            numbers, follower.follow(boxes, periods, task, counts), strict=True
        ):
            results[number] = followed
    return results


def _before(tube: TubeProof) -> int:
    """Return how many of the boxes before it a box may lead into."""
    kind, count = tube.into
    return count if kind == "tubes" else 0


def _into_region(follower: Follower, claim: LoopClaim, index: int) -> Task:
    """Return the task of arrival in a region, deep enough for the claim to hold from then on."""
    haven = follower.havens[index]

    def holds_from(period: int, level: float) -> bool:
        return not outside(follower.problem, haven.loop, claim, haven.proof, exact(level), period)

    return Task(claim, (index,), arrived=holds_from if claim.output else None)


def ends_of_boxes(boxes: Sequence[Sequence[Pair]]) -> tuple[Any, Any]:
    """Return the lower and upper ends of boxes, as floats rounded inward."""
    lows = [[float_above(exact(low)) for low, _ in box] for box in boxes]
    highs = [[float_below(exact(high)) for _, high in box] for box in boxes]
    return np.array(lows), np.array(highs)


def _coverage(problem: LoopProblem, certificate: Certificate) -> Fraction:
    """Return the share of the window covered by the boxes of a map, rounded down."""
    claim, window = certificate.claim, {name: (a, b) for name, a, b in certificate.window}
    if claim.start or claim.output or len(window) < len(certificate.window):
        raise LoopProofError("a map claims that a loop is stable, of one window")
    for name, (low, high) in window.items():
        if name not in problem.states or not (math.isfinite(high - low) and low < high):
            raise LoopProofError(f"not a window: {name} in {low:g} .. {high:g}")
    problem.require_known_start()
    lows, highs = [], []
    for tube in certificate.tubes:
        if len(tube.box) != len(problem.states):
            raise LoopProofError("it is not a box of the plant's states")
        box = dict(zip(problem.states, tube.box, strict=True))
        others = [(box[n], problem.start[n].low) for n in problem.states if n not in window]
        if all(a <= x <= b for (a, b), x in others):
            lows.append([box[name][0] for name in window])
            highs.append([box[name][1] for name in window])
    if not lows:
        return Fraction(0)
    return _share_of(np.array(lows, dtype=object), np.array(highs, dtype=object), window)


def _share_of(lows: Any, highs: Any, window: Mapping[str, tuple[float, float]]) -> Fraction:
    """Return the share of a window covered by the union of boxes, rounded down, cell by cell."""
    ranges, lengths = [], []
    for axis, (low, high) in enumerate(window.values()):
        first, last = Fraction(low), Fraction(high)
        ends = {first, last, *lows[:, axis], *highs[:, axis]}
        cuts = sorted(x for x in ends if first <= x <= last)
        cell_of = {x: k for k, x in enumerate(cuts)}
        ranges.append([
            [cell_of[min(max(x, first), last)] for x in side[:, axis]] for side in (lows, highs)
        ])  # fmt: skip
        lengths.append([(b - a) / (last - first) for a, b in pairwise(cuts)])
    if math.prod(map(len, lengths)) > MOST_CELLS:
        raise LoopProofError("its boxes make too fine a grid")
    inside = np.zeros(tuple(map(len, lengths)), dtype=bool)
    for row in range(len(lows)):
        inside[tuple(slice(begin[row], end[row]) for begin, end in ranges)] = True
    if inside.all():
        return Fraction(1)
    if inside.size <= MOST_EXACT_CELLS:
        return Fraction(_weighed(inside.astype(object), lengths))
    share = float(_weighed(inside.astype(float), [list(map(float, axis)) for axis in lengths]))
    # Nothing is negative: n numbers of an axis are added with a relative error below n 2⁻⁵³, plus
    # two roundings for each length and product.
    error = 2.0**-52 * sum(len(axis) + 2 for axis in lengths)
    return Fraction(max(0.0, share * (1.0 - max(1e-9, error))))


def _weighed(cells: Any, lengths: Sequence[Sequence[Any]]) -> Any:
    """Return the volume of the counted cells: their sum, weighted with lengths axis by axis."""
    for length in reversed(lengths):
        cells = cells @ np.array(length)
    return cells
