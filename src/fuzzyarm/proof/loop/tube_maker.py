"""Certificates of tubes, made: sets that turn with the motion, and starts that are halved.

Which sets are chosen is nothing that has to be believed: :mod:`fuzzyarm.proof.loop.tube_checker`
asks of each whether it leads into the next one.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.proof.claim.problem import LoopProofError
from fuzzyarm.proof.claim.text import claimed_in
from fuzzyarm.proof.loop.spans import RationalInterval
from fuzzyarm.proof.loop.tube_checker import POINT, BoxProof, Period, TubeLoop, TubeSet, start_of
from fuzzyarm.proof.stop import Stop, TimeOverError

__all__ = ["proof_boxes"]

ROOM = 1.0 + 1e-6
"""How much larger sets are than what comes of the last one."""

SHORT = 1 << 60


def proof_boxes(
    loop: TubeLoop, claim: LoopClaim, port: str, stop: Stop
) -> tuple[BoxProof, ...] | str:
    """Return the boxes of a certificate, or why there are none.

    Parameters
    ----------
    loop : TubeLoop
        The loop.
    claim : LoopClaim
        For a bounded time.
    port : str
        What is claimed of, as the loop calls it.
    stop : Stop
        When to give up; it hears how many sets there are.
    """
    waiting: list[tuple[tuple[int, bool], ...]] = [()]
    proofs: list[BoxProof] = []
    wide = [k for k, x in enumerate(loop.problem.start.values()) if x.low < x.high]
    while waiting:
        path = waiting.pop(0)
        proof = _followed(loop, claim, port, path, stop)
        if isinstance(proof, BoxProof):
            proofs.append(proof)
            continue
        if stop.now or not wide or len(path) > 12:
            return proof
        # Along each of the states in turn, as the whole box was wide.
        dimension = wide[len(path) % len(wide)]
        waiting += [(*path, (dimension, False)), (*path, (dimension, True))]
    return tuple(proofs)


def _followed(
    loop: TubeLoop, claim: LoopClaim, port: str, path: tuple[tuple[int, bool], ...], stop: Stop
) -> BoxProof | str:
    spans = start_of(loop, path)
    tube_set = TubeSet(
        tuple(x.middle for x in spans),
        tuple(
            tuple(Fraction(int(i == j)) / max(x.radius, POINT) for j in range(len(spans)))
            for i, x in enumerate(spans)
        ),
    )
    sets = []
    first, last = claimed_in(loop.problem, claim)
    assert last is not None
    try:
        for k in range(last + 1):
            sets.append(tube_set)
            stop.check(len(sets))
            step = loop.period(tube_set, first=k == 0)
            where: RationalInterval = step.outputs[port]
            if k >= first and not (claim.low <= where.low and where.high <= claim.high):
                return f"in period {k + 1} the claim is not shown"
            tube_set = _next(step)
    except (LoopProofError, TimeOverError) as error:
        return str(error)
    return BoxProof(path, tuple(sets))


def _next(step: Period) -> TubeSet:
    """Return a set that holds what comes of one: along the directions in which that is long."""
    spread = np.array([[float(x.middle) for x in row] for row in step.spread])
    order = np.argsort(-np.linalg.norm(spread, axis=0))
    turned, _ = np.linalg.qr(spread[:, order])
    centre = [_short(float(x.middle)) for x in step.centre]
    away = [float(x.radius) + 1e-15 for x in step.centre]
    sizes = np.array([[float(x.size) for x in row] for row in step.spread])
    radii = np.array([[float(x.radius) for x in row] for row in step.spread])
    rows = []
    for way in turned.T:
        reach = float(np.abs(way) @ away) + float(np.abs(way @ spread).sum())
        reach += float((np.abs(way) @ radii).sum()) + 1e-13 * float(sizes.sum())
        reach = max(reach * ROOM, float(POINT))
        rows.append(tuple(_short(x / reach) for x in way))
    return TubeSet(tuple(centre), tuple(rows))


def _short(x: float) -> Fraction:
    return Fraction(round(Fraction(x) * SHORT), SHORT)
