"""Waypoints of many tubes, for certificates of maps of loops without memory.

Runs from far apart join one course: a drive at its limit, then a cruise, then the approach to rest.
A box of all states on this course that leads into the region is a destination for all of them; so
the course is followed once, not once for each box of starts. Short remaining tubes are joined:
neighbouring boxes that arrive as one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from fuzzyarm.proof.check.certificate import Pair, TubeProof
from fuzzyarm.proof.check.numbers import precisely
from fuzzyarm.proof.check.theorem import ends_of_boxes
from fuzzyarm.proof.check.tube import MOST_SYMBOLS, Followed, Follower, Task
from fuzzyarm.proof.claim.problem import LoopProofError
from fuzzyarm.proof.stop import check_time

LONG = 96
"""Least periods of a tube that is worth a waypoint."""

APART = 24
"""Periods from one waypoint to the next."""

LONGEST = 160
"""Most periods of a box to the next waypoint."""

WIDER = 1.3
"""Ratio of a waypoint's width to that of its set."""

LEAST = 0.1
"""Least widening, as a share of the largest width on the way."""

MOST_ROUNDS = 8

Box = tuple[Pair, ...]


def waypoints(
    follower: Follower, tubes: Sequence[TubeProof]
) -> tuple[list[TubeProof], dict[TubeProof, int]]:
    """Return waypoints into the region, each into earlier ones, and the tubes that lead into them.

    Each such tube has its number of periods.
    """
    ways: list[TubeProof] = []
    caught: dict[TubeProof, int] = {}
    waiting = sorted((t for t in tubes if t.periods > LONG), key=lambda tube: tube.periods)
    for _ in range(MOST_ROUNDS):
        if not waiting:
            break
        found = _on_the_way(follower, waiting[-1], ways)
        if not found:
            waiting.pop()
            continue
        ways += found
        results = _into(follower, waiting, [LONGEST] * len(waiting), ways)
        here = {t: r.periods for t, r in zip(waiting, results, strict=True) if not r.against}
        caught |= here
        waiting = [tube for tube in waiting[:-1] if tube not in here]
    return ways, caught


def _into(
    follower: Follower, tubes: Sequence[TubeProof], periods: Sequence[int],
    ways: Sequence[TubeProof], numbers: Any = None,
) -> list[Followed]:  # fmt: skip
    """Follow boxes until they are in waypoints."""
    task = Task(boxes=ends_of_boxes([way.box for way in ways]), any_period=True)
    return follower.follow([tube.box for tube in tubes], periods, task, numbers)


def _on_the_way(
    follower: Follower, tube: TubeProof, before: Sequence[TubeProof]
) -> list[TubeProof]:
    """Return waypoints of a tube, each of which leads into the region or into earlier ones."""
    course = np.array(_course(follower, tube))
    width = course[..., 1] - course[..., 0]
    least = LEAST * width.max(axis=0)
    boxes = []
    for k in range(len(course) - APART, 0, -APART):
        more = 0.5 * np.maximum((WIDER - 1.0) * width[k], least)
        ends = zip(
            (course[k, :, 0] - more).tolist(), (course[k, :, 1] + more).tolist(), strict=True
        )
        boxes.append(tuple((Fraction(low), Fraction(high)) for low, high in ends))
    last = [TubeProof(box, LONGEST, ("regions", 0)) for box in boxes[: LONGEST // APART]]
    results = follower.follow([w.box for w in last], [LONGEST] * len(last), Task(into=(0,)))
    found = [
        way._replace(periods=result.periods)
        for way, result in zip(last, results, strict=True)
        if not result.against
    ]
    rest = [TubeProof(box, LONGEST) for box in boxes[len(last) :]]
    while found and rest:  # each into all before it, up to the first failure
        known = [*before, *found]
        numbers = len(known) + np.arange(len(rest))
        results = _into(follower, rest, [LONGEST] * len(rest), [*known, *rest], numbers)
        bad = next((k for k, result in enumerate(results) if result.against), len(rest))
        found += [
            way._replace(periods=result.periods, into=("tubes", int(number)))
            for way, result, number in zip(rest[:bad], results, numbers, strict=False)
        ]
        rest = rest[bad + 1 :]
    return found


@precisely
def _course(follower: Follower, tube: TubeProof) -> list[list[tuple[float, float]]]:
    """Return bounds of the states from one box of starts, sample by sample, until arrival."""
    follower.numbers.sets = 1
    now, found = follower.start_forms([tube.box]), list[list[tuple[float, float]]]()
    for k in range(tube.periods):
        check_time()
        spans = [form.span for form in now]
        found.append([(float(x.low[0]), float(x.high[0])) for x in spans])
        try:
            after, _ = follower._period(now, k)
        except (LoopProofError, ZeroDivisionError):
            break
        if not all(np.isfinite(x.size).all() for x in after) or follower._level(0, after)[0] <= 1.0:
            break
        now = follower.numbers.fewer(after, MOST_SYMBOLS)
    return found


def joined(
    follower: Follower, ways: Sequence[TubeProof], caught: Mapping[TubeProof, int],
    axes: Sequence[int],
) -> dict[TubeProof, int]:  # fmt: skip
    """Return boxes with neighbours joined that arrive as one."""
    periods, refused = dict(caught), set[Box]()
    while True:
        before = len(periods)
        for axis in axes:
            pairs = [
                (a, b) for a, b in _pairs(list(periods), axis)
                if _whole(a, b, axis).box not in refused
            ]  # fmt: skip
            wholes = [_whole(a, b, axis) for a, b in pairs]
            most = [max(periods[a], periods[b]) for a, b in pairs]
            results = _into(follower, wholes, [k + k // 4 + 8 for k in most], ways)
            for (a, b), whole, result in zip(pairs, wholes, results, strict=True):
                if not result.against:
                    del periods[a], periods[b]
                    periods[whole] = result.periods
                else:
                    refused.add(whole.box)
        if len(periods) == before:
            return periods


def _pairs(tubes: Sequence[TubeProof], axis: int) -> Iterator[tuple[TubeProof, TubeProof]]:
    """Yield neighbours along an axis, each in one pair."""

    def key(tube: TubeProof) -> tuple[Box, Pair]:
        return (*tube.box[:axis], *tube.box[axis + 1 :]), tube.box[axis]

    waiting = sorted(tubes, key=key)
    while len(waiting) > 1:
        b, a = waiting.pop(), waiting[-1]
        if key(a)[0] == key(b)[0] and a.box[axis][1] == b.box[axis][0]:
            yield waiting.pop(), b


def _whole(a: TubeProof, b: TubeProof, axis: int) -> TubeProof:
    side = a.box[axis][0], b.box[axis][1]
    return a._replace(box=(*a.box[:axis], side, *a.box[axis + 1 :]))
