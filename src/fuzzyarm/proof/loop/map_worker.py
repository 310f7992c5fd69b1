"""The worker of a map: boxes on their way into a region, in pieces of work."""

from __future__ import annotations

import heapq
import math
import threading
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.control.loop.blocks import unpacked
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.proof.check.certificate import Certificate
from fuzzyarm.proof.check.region import verified
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.claim.text import GivenLoop
from fuzzyarm.proof.loop.algebra import Number
from fuzzyarm.proof.loop.cover import Cover
from fuzzyarm.proof.loop.follower import Box, Nearness
from fuzzyarm.proof.loop.form_maker import FormMaker
from fuzzyarm.proof.loop.pool import ARRIVED, GIVEN_UP, LOST, Fate, Pool
from fuzzyarm.proof.loop.start_map import OPEN, PROVED, REFUTED, MappedBox
from fuzzyarm.proof.loop.timed import Haven, claim_of_stability
from fuzzyarm.proof.loop.zonotope import Forms
from fuzzyarm.proof.stop import Stop

LEAST, MOST = 6, 14
"""Initial halvings of the window."""

NARROW = 0.7
"""Largest initial boxes, in units of the region, if proved boxes are goals."""

SELDOM, ENOUGH, AGAIN = 0.25, 256, 16
"""Least share of decided boxes of a size, below which boxes of this size are halved at once; boxes
before that counts; and every how many-th box is followed nevertheless."""

HALVINGS = 8
"""Most halvings of a side of the window, on average over the sides."""

Open = Mapping[Box, str]
"""Open boxes, each with the reason so far."""


@dataclass(frozen=True)
class MapCase:
    """The task of a worker."""

    given: GivenLoop
    claim: LoopClaim  # of stability, from the window
    certificate: Certificate
    odd: bool


class MapWorker:
    """Maps boxes of a case, in pieces of work."""

    def __init__(self, case: MapCase) -> None:
        problem = case.given.problem(case.claim)
        stop = Stop()
        against, _, loop = verified(problem, case.certificate.claim, case.certificate.region)
        if against or loop is None:
            raise LoopProofError(f"the region is not proved: {against}")
        self.haven = Haven(
            FormMaker(problem, stop), case.certificate.region, loop, claim_of_stability(case.claim)
        )
        horizon = math.ceil(self.haven.horizon / problem.period)
        self.pool = Pool(problem, self.nearness, horizon, stop)
        self.pool.most = HALVINGS * len(self.pool.follower.names)
        self.first = self.pool.follower.first
        self.middle = self._rest()
        self.followed: Counter[int] = Counter()  # by number of halvings
        self.decided: Counter[int] = Counter()
        self.known: set[tuple[tuple[float, ...], tuple[float, ...]]] = set()
        self.odd = case.odd
        self.cover = self._cover(problem)
        if self.cover is not None:  # ways are short: halves are followed from the start
            self.pool.cuts = 0
        low, high = np.array(self.first.low), np.array(self.first.high)
        # Coordinates of a deviation in units of the region, or of the window.
        self.units = np.diag(1.0 / (high - low)) if self.cover is None else self.haven.factor.T
        self.sides = 0.5 * (high - low) * np.linalg.norm(self.units, axis=0)

    def _cover(self, problem: LoopProblem) -> Cover | None:
        """Return the proved region so far, if arrival in it equals a start there."""
        names = self.haven.loop.names
        whole = tuple(self.pool.follower.names) == tuple(problem.states) == tuple(names)
        remembers = self.pool.control[1].memory or problem.text.model.every > 1
        if not whole or remembers or not Cover.fits(len(names)):
            return None
        cover = Cover(self.first)
        # A cell is in the region if its corners are: V is convex.
        grids = np.meshgrid(*cover.edges, indexing="ij")
        corners = np.stack([grid.ravel() for grid in grids])
        values = self.haven.values(Forms.at(corners), {}).reshape(grids[0].shape) <= 1.0
        for axis in range(values.ndim):
            start = (slice(None),) * axis
            values = values[(*start, slice(None, -1))] & values[(*start, slice(1, None))]
        cover.add_cells(values)
        return cover

    def _rest(self) -> NDArray[np.float64]:
        """Return the position of rest in the window."""
        names, rests = self.haven.loop.names, self.haven.rests
        values = [
            float(rests[names.index(name)].middle) if name in names else 0.0
            for name in self.pool.follower.names
        ]
        return np.array(values)

    def nearness(self, states: Forms, memory: Mapping[str, Number], count: int) -> Nearness:
        """Return the distance of boxes from the region."""
        near = self.haven.nearness(states, memory, count)
        fixed = self.haven.fixed(memory, states.shape[1])
        if self.cover is not None:
            held = self.cover.holds(states.bounds)
            return near._replace(value=np.where(held, 0.0, np.where(fixed, near.value, np.inf)))
        return near._replace(value=np.where(fixed, near.value, np.inf))

    def learn(self, boxes: Sequence[MappedBox]) -> None:
        """Add boxes proved elsewhere."""
        for box in boxes:
            if self.cover is None or box.verdict != PROVED:
                continue
            for each in (box, box.opposite) if self.odd else (box,):
                # Each box once: twice half a cell would count as a whole one.
                if (each.low, each.high) not in self.known:
                    self.known.add((each.low, each.high))
                    self.cover.add(each.low, each.high)

    def tiles(self, boxes: Sequence[Box]) -> list[Box]:
        """Return initial parts of boxes, with their widest sides halved."""
        tiles, large = list[Box](), list(boxes)
        while large:
            box = large.pop()
            widths = self.widths(box)
            # Boxes wider than the region seldom lead into it, or into its neighbours.
            is_wide = self.cover is not None and math.hypot(*widths) > NARROW
            if sum(box.halvings) < (MOST if is_wide else LEAST):
                large += box.halves(int(np.argmax(widths)))
            elif not self.odd or box.high > tuple(0.0 - x for x in box.low):  # or its opposite is
                tiles.append(box)
        return sorted(tiles, key=self.distance)

    def widths(self, box: Box) -> NDArray[np.float64]:
        """Return the half-widths of a box, in units of the region or of the window."""
        return np.asarray(self.sides * 0.5 ** np.array(box.halvings))

    def note(self, fates: Sequence[Fate]) -> None:
        """Count decided boxes by size."""
        for fate in fates:
            size = sum(fate.box.halvings)
            self.followed[size] += 1
            self.decided[size] += fate.end != GIVEN_UP
            if self.followed[size] > 2 * ENOUGH:  # recent ones count most
                self.followed[size] //= 2
                self.decided[size] //= 2

    def is_seldom_decided(self, box: Box) -> bool:
        """Return whether boxes of this size are seldom decided, while smaller ones may be."""
        size = sum(box.halvings)
        followed = self.followed[size]
        is_known = self.cover is not None and followed >= ENOUGH
        return is_known and self.decided[size] < SELDOM * followed

    def distance(self, box: Box) -> float:
        """Return the distance of a box from rest, in units of the region or of the window."""
        middle = 0.5 * np.array(box.low) + 0.5 * np.array(box.high)
        return float(np.linalg.norm(self.units @ (middle - self.middle)))

    def mapped(
        self, boxes: Open, seconds: float, report: Callable[[Sequence[MappedBox]], None]
    ) -> dict[Box, str]:
        """Map boxes; report decided ones to `heard`, return those left when time is over."""
        return _Mapping(self, boxes, report).run(seconds)


class _Mapping:
    """One piece of work."""

    def __init__(
        self, worker: MapWorker, boxes: Open, report: Callable[[Sequence[MappedBox]], None]
    ) -> None:
        self.worker, self.report = worker, report
        self.queue: list[tuple[int, float, int, Box, str]] = []
        self.count = self.taken = 0
        self.probes: dict[Box, tuple[Box, str]] = {}
        for box, reason in boxes.items():
            self._push(box, reason)

    def _push(self, box: Box, reason: str) -> None:
        self.count += 1
        # Large boxes first, outward from rest: most of the volume is decided soon.
        key = sum(box.halvings), self.worker.distance(box), self.count
        heapq.heappush(self.queue, (*key, box, reason))

    def run(self, seconds: float) -> dict[Box, str]:
        """Work until all is decided or time is over; return the open boxes."""
        pool = self.worker.pool
        pool.restart(Stop(seconds))
        rest = pool.follow(self._next, self._done)
        waiting = [(box, reason) for *_, box, reason in self.queue] + [(box, "") for box in rest]
        return dict(self.probes.get(box, (box, reason)) for box, reason in waiting)

    def _next(self, most: int) -> list[Box]:
        boxes: list[Box] = []
        while self.queue and len(boxes) < most:
            *_, box, reason = heapq.heappop(self.queue)
            self.taken += 1
            worker = self.worker
            is_half = bool(reason) and sum(box.halvings) < worker.pool.most
            if is_half and self.taken % AGAIN and worker.is_seldom_decided(box):
                for half in box.halves(int(np.argmax(worker.widths(box)))):
                    self._push(half, reason)
            else:
                boxes.append(box)
        return boxes

    def _done(self, fates: Sequence[Fate]) -> None:
        decided = []
        self.worker.note(fates)
        for fate in fates:
            box = fate.box
            if box in self.probes:
                box, reason = self.probes.pop(box)
                if fate.end == LOST:
                    decided.append(
                        mapped_box(box, REFUTED, fate.periods, f"a run is {fate.reason}")
                    )
                else:
                    decided.append(mapped_box(box, OPEN, 0, reason))
            elif fate.end == ARRIVED:
                decided.append(mapped_box(box, PROVED, fate.periods, ""))
            elif fate.end == LOST:
                decided.append(
                    mapped_box(box, REFUTED, fate.periods, f"all runs are {fate.reason}")
                )
            elif fate.was_cut:  # anew: the halved box accumulates less width
                self._push(box, fate.reason)
            elif sum(box.halvings) < self.worker.pool.most:
                way = self.worker.pool.dimension(box, fate.weight)
                for half in box.halves(way):
                    self._push(half, fate.reason)
            else:
                self._probe(box, fate.reason)
        if decided:
            self.worker.learn(decided)
            self.report(decided)

    def _probe(self, box: Box, reason: str) -> None:
        """Follow the run from the midpoint of a box too small to be halved."""
        at = tuple(0.5 * a + 0.5 * b for a, b in zip(box.low, box.high, strict=True))
        probe = Box(at, at, box.halvings)
        self.probes[probe] = (box, reason)
        self._push(probe, reason)


def mapped_box(box: Box, verdict: str, periods: int, reason: str) -> MappedBox:
    """Return a box with its verdict."""
    return MappedBox(box.low, box.high, verdict, periods, reason)


_ONE_AT_A_TIME = threading.Lock()
"""Workers are cached by case: threads of an executor take turns, processes need not."""


@lru_cache(maxsize=2)
def _worker_of(content: bytes) -> MapWorker:
    return MapWorker(unpacked(content))


def mapped_piece(
    content: bytes, boxes: Open, known: Sequence[MappedBox], seconds: float
) -> tuple[list[MappedBox], dict[Box, str], float]:
    """Map boxes in another process; return them, the open ones, and the seconds of work."""
    found: list[MappedBox] = []
    with _ONE_AT_A_TIME:
        begun = time.process_time()
        worker = _worker_of(content)
        worker.learn(known)
        rest = worker.mapped(boxes, seconds - (time.process_time() - begun), found.extend)
        return found, rest, time.process_time() - begun
