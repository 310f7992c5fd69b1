"""The map of starts: from where every run comes to rest, from where runs are lost, what is open.

A window of starts is cut into boxes. A box is **proved** where a tube from all of it leads into the
region that no run leaves and in which all come to rest (:class:`~fuzzyarm.proof.loop.timed.Haven`),
**refuted** where all of its runs leave the bound of a port for certain, or have no value; at the
smallest size, where the run from its middle does. Everything else is **open**, with the reason.
The region is found once, rule bases are cut once; boxes are followed side by side
(:mod:`fuzzyarm.proof.loop.pool`), large ones first.
"""

from __future__ import annotations

import heapq
import math
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.numbers import number_text
from fuzzyarm.base.shown import Shown, one_line
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.control.loop.blocks import Workers, packed, unpacked, workers_watched
from fuzzyarm.control.loop.course import Sensor
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.plant.plant import Plant
from fuzzyarm.proof.check.certificate import Certificate, Pair, fingerprints_of
from fuzzyarm.proof.check.region import verified
from fuzzyarm.proof.claim.identity import loop_digests
from fuzzyarm.proof.claim.problem import ClaimError, LoopProblem, LoopProofError
from fuzzyarm.proof.claim.text import loop_sentence, problem_of
from fuzzyarm.proof.loop.algebra import Number
from fuzzyarm.proof.loop.boxes import certify_map
from fuzzyarm.proof.loop.cover import Cover
from fuzzyarm.proof.loop.enclosure import EnclosureError
from fuzzyarm.proof.loop.follower import Box, Nearness
from fuzzyarm.proof.loop.form_maker import FormMaker
from fuzzyarm.proof.loop.pool import ARRIVED, LOST, Fate, Pool
from fuzzyarm.proof.loop.runs import run_of
from fuzzyarm.proof.loop.symmetry import is_odd
from fuzzyarm.proof.loop.timed import Haven, claim_of_stability
from fuzzyarm.proof.loop.verdicts import prove_loop
from fuzzyarm.proof.loop.zonotope import Forms
from fuzzyarm.proof.stop import Stop, TimeOverError
from fuzzyarm.requests.journal import WorkJournal, question_of
from fuzzyarm.symbolic.operations import Interval

__all__ = ["MAP_BUDGET", "MapSearch", "MappedBox", "StartMap", "map_starts"]

PROVED, REFUTED, OPEN = "proved", "refuted", "open"

MAP_BUDGET = 300.0
"""Seconds that each worker may take where nothing is said."""

TILES = 64
"""Parts of the window to begin with, at least."""

HALVINGS = 8
"""How often a side of the window is halved at most, on average over the sides."""

RUNS = 400
"""Drawn starts, by which the share of those that come to rest is estimated."""

SHARE_OF_CHECK = 0.5
"""Of the budget, what the checker may take to follow the boxes of a certificate, at least."""

AT_ONCE = 4
"""Pieces of work for each worker."""


@json_properties("*")
class MappedBox(NamedTuple):
    """A part of the window.

    Attributes
    ----------
    low, high : tuple of float
        Its ends, in the order of the window.
    verdict : str
        ``proved``, ``refuted`` or ``open``.
    periods : int
        Control periods until all of its runs are in the region, or lost.
    reason : str
        Why it is refuted or open.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]
    verdict: str
    periods: int
    reason: str = ""

    @property
    def opposite(self) -> MappedBox:
        """What an odd loop has on the other side of its rest."""
        low, high = (tuple(0.0 - x for x in ends) for ends in (self.high, self.low))
        return self._replace(low=low, high=high)


@json_properties(
    "property=statement window others proved refuted open starts settled settled_proved"
    " within=longest region rest boxes seconds reason"
)
@dataclass(frozen=True, repr=False, kw_only=True)
class StartMap(Shown):
    """What is known of the starts of a loop, all over a window.

    Attributes
    ----------
    statement : str
        Which loop.
    window : dict of str to Interval
        The starts; states that are not in it begin where the plant does.
    others : dict of str to float
        Where those begin.
    boxes : tuple of MappedBox
        Parts of the window, which fill it.
    region : dict of str to (float, float)
        How far the region around rest reaches, in which all tubes end.
    rest : dict of str to float
        Where the loop rests.
    certificate : Certificate or None
        Of that region, or of the whole map.
    starts, settled, settled_proved : int
        How many starts were drawn, how many of their runs came to rest, and how many of those
        begin in boxes that are proved.
    seconds, work : float
        How long it took by the clock, and of the processors.
    period : float
        Of control, s.
    units : dict of str to str
        Of the states.
    reason : str
        Why nothing was proved; empty where there is a region.
    """

    statement: str
    window: Mapping[str, Interval]
    others: Mapping[str, float]
    boxes: tuple[MappedBox, ...] = field(repr=False)
    region: Mapping[str, tuple[float, float]]
    rest: Mapping[str, float]
    certificate: Certificate | None
    starts: int
    settled: int
    settled_proved: int
    seconds: float
    work: float
    period: float
    units: Mapping[str, str] = field(default_factory=dict, repr=False)
    reason: str = ""

    def share(self, verdict: str) -> float:
        """Return the share of the window's volume that has a verdict."""
        sides = [span.high - span.low for span in self.window.values()]
        return sum(
            math.prod((b - a) / s for a, b, s in zip(box.low, box.high, sides, strict=True))
            for box in self.boxes
            if box.verdict == verdict
        )

    @property
    def proved(self) -> float:
        """The share of the window from which every run comes to rest."""
        return self.share(PROVED)

    @property
    def refuted(self) -> float:
        """The share from which runs are lost."""
        return self.share(REFUTED)

    @property
    def open(self) -> float:
        """The share of which nothing is known, what is not looked at yet included."""
        rest = 1.0 - self.decided
        return max(self.share(OPEN), rest if rest > 1e-9 else 0.0)

    @property
    def decided(self) -> float:
        """The share of the volume that is proved or refuted."""
        return self.proved + self.refuted

    @property
    def verdict(self) -> str:
        """``refuted`` if runs of a box are lost, ``undecided`` if one is open, else ``proved``."""
        found = {box.verdict for box in self.boxes}
        return REFUTED if REFUTED in found else "undecided" if OPEN in found else PROVED

    @property
    def covered(self) -> float:
        """The share of drawn starts at rest in the end that begin in proved boxes; NaN: of none."""
        return self.settled_proved / self.settled if self.settled else math.nan

    @property
    def longest(self) -> float:
        """After which time all runs from proved boxes are in the region, s."""
        return self.period * max((b.periods for b in self.boxes if b.verdict == PROVED), default=0)

    def verdict_at(self, **start: float) -> str:
        """Return the verdict on a start, by state; `open` where it is not in the window."""
        unknown = [name for name in start if name not in self.window]
        if unknown or len(start) < len(self.window):
            raise ClaimError(f"a start of the map has {', '.join(self.window)}")
        at = [start[name] for name in self.window]
        for box in self.boxes:
            if all(a <= x <= b for a, x, b in zip(box.low, at, box.high, strict=True)):
                return box.verdict
        return OPEN

    def reasons(self) -> list[tuple[str, float]]:
        """Return why boxes are open, and the share of the volume of each reason, largest first."""
        totals: Counter[str] = Counter()
        for box in self.boxes:
            if box.verdict == OPEN:
                totals[box.reason] += self._share_of(box)  # type: ignore[assignment]
        return [(reason, float(share)) for reason, share in totals.most_common()]

    def _share_of(self, box: MappedBox) -> float:
        sides = [span.high - span.low for span in self.window.values()]
        return math.prod((b - a) / s for a, b, s in zip(box.low, box.high, sides, strict=True))

    def sentence(self) -> str:
        """Return the coverage in a sentence."""
        window = ", ".join(
            f"{name} in {number_text(span.low)} .. {number_text(span.high)}"
            for name, span in self.window.items()
        )
        return (
            f"from {_percent(self.proved)} of {window} every run comes to rest, from"
            f" {_percent(self.refuted)} runs are lost, {_percent(self.open)} is open"
        )

    def __repr__(self) -> str:
        return one_line(self, f"map of {self.statement}: {_percent(self.proved)} proved")

    def __str__(self) -> str:
        lines = [f"map: {self.statement}", f"  {self.sentence()}"]
        if self.others:
            begun = ", ".join(f"{name} = {x:g}" for name, x in self.others.items())
            lines.append(f"  the other states begin at {begun}")
        if self.longest:
            lines.append(
                f"  within {self.longest:g} s all proved runs are in the region around rest"
            )
        if self.starts:
            lines.append(
                f"  of {self.starts} drawn starts {self.settled} came to rest, and of those"
                f" {_percent(self.covered)} are proved"
            )
        lines += [f"  open, {_percent(share)}: {reason}" for reason, share in self.reasons()[:3]]
        return "\n".join([*lines, *([f"  {self.reason}"] if self.reason else [])])


def _percent(share: float) -> str:
    """Return a share in per cent, never rounded up to all."""
    if math.isnan(share):
        return "none"
    tenths = math.floor(1000.0 * share + 1e-9) / 10.0
    return f"{tenths:g} %"


# ── the case ─────────────────────────────────────────────────────────────────────────


@dataclass(frozen=True)
class _Case:
    """What a worker has to know."""

    text: ControllerText
    claim: LoopClaim  # that is stable, from the window
    plant: Plant
    connect: Mapping[str, str] | None
    sensors: Mapping[str, Sensor] | None
    certificate: Certificate
    odd: bool

    def problem(self) -> LoopProblem:
        """Return the loop."""
        return problem_of(
            self.text, self.claim, plant=self.plant, connect=self.connect, sensors=self.sensors
        )


class _Worker:
    """Maps boxes of a case, one piece of work after the other."""

    def __init__(self, case: _Case) -> None:
        problem = case.problem()
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
        self.known: set[MappedBox] = set()
        self.odd = case.odd
        self.cover = self._cover(problem)

    def _cover(self, problem: LoopProblem) -> Cover | None:
        """Return what is proved so far, where a run that comes into it is as one that starts."""
        names = self.haven.loop.names
        whole = tuple(self.pool.follower.names) == tuple(problem.states) == tuple(names)
        remembers = self.pool.control[1].memory or problem.text.model.every > 1
        if not whole or remembers or not Cover.fits(len(names)):
            return None
        cover = Cover(self.first)
        # A cell is in the region where its corners are: V is convex.
        grids = np.meshgrid(*cover.edges, indexing="ij")
        corners = np.stack([grid.ravel() for grid in grids])
        values = self.haven.values(Forms.at(corners), {}).reshape(grids[0].shape) <= 1.0
        for axis in range(values.ndim):
            start = (slice(None),) * axis
            values = values[(*start, slice(None, -1))] & values[(*start, slice(1, None))]
        cover.add_cells(values)
        return cover

    def _rest(self) -> NDArray[np.float64]:
        """Return the place of rest in the window."""
        names, rests = self.haven.loop.names, self.haven.rests
        values = [
            float(rests[names.index(name)].middle) if name in names else 0.0
            for name in self.pool.follower.names
        ]
        return np.array(values)

    def nearness(self, states: Forms, memory: Mapping[str, Number], count: int) -> Nearness:
        """Return how near to the region boxes are."""
        near = self.haven.nearness(states, memory, count)
        fixed = self.haven.fixed(memory, states.shape[1])
        if self.cover is not None:
            held = self.cover.holds(states.bounds)
            return near._replace(value=np.where(held, 0.0, np.where(fixed, near.value, np.inf)))
        return near._replace(value=np.where(fixed, near.value, np.inf))

    def learn(self, boxes: Sequence[MappedBox]) -> None:
        """Take in what is proved already."""
        for box in boxes:
            if self.cover is not None and box.verdict == PROVED and box not in self.known:
                self.known.add(box)
                for each in (box, box.opposite) if self.odd else (box,):
                    self.cover.add(each.low, each.high)

    def tiles(self) -> list[Box]:
        """Return the parts of the window to begin with."""
        boxes, ways = [self.first], len(self.first.low)
        while len(boxes) < TILES:
            way = int(np.argmin(boxes[0].halvings)) if ways else 0
            boxes = [half for box in boxes for half in box.halves(way)]
        if self.odd:  # the others are opposite to these
            boxes = [box for box in boxes if box.high > tuple(0.0 - x for x in box.low)]
        return sorted(boxes, key=self.distance)

    def distance(self, box: Box) -> float:
        """Return how far a box is from rest, in shares of the window."""
        low, high = np.array(box.low), np.array(box.high)
        width = np.array(self.first.high) - np.array(self.first.low)
        return float((np.abs(0.5 * low + 0.5 * high - self.middle) / width).max(initial=0.0))

    def mapped(
        self, boxes: Sequence[Box], seconds: float, heard: Callable[[Sequence[MappedBox]], None]
    ) -> None:
        """Map boxes; what is decided, and in the end what is left open, is heard."""
        _Mapping(self, boxes, heard).run(seconds)


class _Mapping:
    """One piece of work."""

    def __init__(
        self, worker: _Worker, boxes: Sequence[Box], heard: Callable[[Sequence[MappedBox]], None]
    ) -> None:
        self.worker, self.heard = worker, heard
        self.queue: list[tuple[int, float, int, Box, str]] = []
        self.count = 0
        self.under_way: dict[Box, None] = {}
        self.probes: dict[Box, tuple[Box, str]] = {}
        for box in boxes:
            self._push(box, "")

    def _push(self, box: Box, reason: str) -> None:
        self.count += 1
        # Large ones first; but backward from rest where what is proved is a goal.
        size = sum(box.halvings) if self.worker.cover is None else 0
        key = size, self.worker.distance(box), self.count
        heapq.heappush(self.queue, (*key, box, reason))

    def run(self, seconds: float) -> None:
        """Work until all is decided, or time is over."""
        pool = self.worker.pool
        pool.restart(Stop(seconds))
        rest = pool.follow(self._next, self._done)
        waiting = [(box, reason) for *_, box, reason in self.queue]
        waiting += [self.probes.get(box, (box, "")) for box in rest]
        late = "time ran out"
        self.heard([_mapped(box, OPEN, 0, reason or late) for box, reason in waiting])

    def _next(self, most: int) -> list[Box]:
        boxes: list[Box] = []
        while self.queue and len(boxes) < most:
            *_, box, _ = heapq.heappop(self.queue)
            boxes.append(box)
        return boxes

    def _done(self, fates: Sequence[Fate]) -> None:
        decided = []
        for fate in fates:
            box = fate.box
            if box in self.probes:
                box, reason = self.probes.pop(box)
                if fate.end == LOST:
                    decided.append(_mapped(box, REFUTED, fate.periods, f"a run is {fate.reason}"))
                else:
                    decided.append(_mapped(box, OPEN, 0, reason))
            elif fate.end == ARRIVED:
                decided.append(_mapped(box, PROVED, fate.periods, ""))
            elif fate.end == LOST:
                decided.append(_mapped(box, REFUTED, fate.periods, f"all runs are {fate.reason}"))
            elif fate.was_cut:  # anew: what had added up until it was halved is less from now on
                self._push(box, fate.reason)
            elif sum(box.halvings) < self.worker.pool.most:
                way = self.worker.pool.dimension(box, fate.weight)
                for half in box.halves(way):
                    self._push(half, fate.reason)
            else:
                self._probe(box, fate.reason)
        if decided:
            self.worker.learn(decided)
            self.heard(decided)

    def _probe(self, box: Box, reason: str) -> None:
        """Follow the run from the middle of a box that is too small to be halved."""
        at = tuple(0.5 * a + 0.5 * b for a, b in zip(box.low, box.high, strict=True))
        probe = Box(at, at, box.halvings)
        self.probes[probe] = (box, reason)
        self._push(probe, reason)


def _mapped(box: Box, verdict: str, periods: int, reason: str) -> MappedBox:
    return MappedBox(box.low, box.high, verdict, periods, reason)


_ONE_AT_A_TIME = threading.Lock()
"""A worker remembers where it is: threads of an executor take turns, processes need not."""


@lru_cache(maxsize=2)
def _worker_of(content: bytes) -> _Worker:
    return _Worker(unpacked(content))


def _piece(
    content: bytes, boxes: Sequence[Box], known: Sequence[MappedBox], seconds: float
) -> tuple[list[MappedBox], float]:
    """Map boxes in another process; return them, and the seconds of work."""
    found: list[MappedBox] = []
    with _ONE_AT_A_TIME:
        begun = time.process_time()
        worker = _worker_of(content)
        worker.learn(known)
        worker.mapped(boxes, seconds - (time.process_time() - begun), found.extend)
        return found, time.process_time() - begun


# ── the map ──────────────────────────────────────────────────────────────────────────


Watch = Callable[[StartMap], None]


@dataclass(frozen=True)
class MapSearch:
    """How a map is searched.

    Attributes
    ----------
    budget : float
        Seconds of the processor that each worker may take.
    workers : int
        Processes at a time.
    journal : str, optional
        A file that gets a line for each box; of the same question, it is gone on with.
    runs : int
        Drawn starts, whose runs are simulated.
    certify : bool
        Whether only those boxes count as proved that the checker follows, for a certificate.
    executor : Executor, optional
        Any of :mod:`concurrent.futures`, instead of processes of this machine.
    """

    budget: float = MAP_BUDGET
    workers: int = 1
    journal: str | None = None
    runs: int = RUNS
    certify: bool = False
    executor: Executor | None = None


DEFAULT_SEARCH = MapSearch()


def map_starts(
    text: ControllerText,
    claim: LoopClaim,
    search: MapSearch = DEFAULT_SEARCH,
    *,
    plant: Plant,
    connect: Mapping[str, str] | None = None,
    sensors: Mapping[str, Sensor] | None = None,
    watch: Watch | None = None,
) -> StartMap:
    """Map the starts of a loop: proved, refuted or open.

    Parameters
    ----------
    text : ControllerText
        The controller.
    claim : LoopClaim
        That it is stable, with set points and parameters; its starts are the window, by default
        the ranges of the outputs that are states.
    search : MapSearch
        How long, with how many workers.
    plant : Plant
        What it runs.
    connect, sensors
        As for :func:`fuzzyarm.proof.loop.prove_loop`.
    watch : callable, optional
        Given the map as far as it is, now and then.

    Raises
    ------
    ClaimError
        If the window names what is no state, or an output has no range to be the window.
    LoopProofError
        If nothing is proved about the loop, by name.
    """
    return _Map(text, claim, search, plant, connect, sensors, watch).made()


class _Map:
    """A map in the making."""

    def __init__(
        self, text: ControllerText, claim: LoopClaim, search: MapSearch, plant: Plant,
        connect: Mapping[str, str] | None, sensors: Mapping[str, Sensor] | None,
        watch: Watch | None,
    ) -> None:  # fmt: skip
        self.begun, self.stop = time.monotonic(), Stop(search.budget)
        self.text, self.plant, self.connect, self.sensors = text, plant, connect, sensors
        count = None if search.executor is not None and search.workers == 1 else search.workers
        self.crew = Workers(count, search.executor)
        self.search, self.workers, self.watch = search, self.crew.count, watch
        start = claim.start or tuple(self._ranges(claim))
        self.claim = replace(claim_of_stability(claim), start=start)
        self.problem = problem_of(text, self.claim, plant=plant, connect=connect, sensors=sensors)
        self.window = {name: Interval(low, high) for name, low, high in start}
        for name, span in self.window.items():
            if not span.low < span.high:
                raise ClaimError(f"{name} in {span.low:g} .. {span.high:g} is no window")
        self.boxes: list[MappedBox] = []
        self.work = 0.0
        self.journal: WorkJournal | None = None
        self.drawn: list[tuple[tuple[float, ...], bool]] = []
        self.told = -math.inf
        self.certificate: Certificate | None = None

    def _ranges(self, claim: LoopClaim) -> Iterator[tuple[str, float, float]]:
        """Yield the ranges of the outputs that are states."""
        problem = problem_of(
            self.text, claim_of_stability(claim), plant=self.plant, connect=self.connect,
            sensors=self.sensors,
        )  # fmt: skip
        ports = problem.site.interface.outputs.items()
        shown = {name: port for (_, name), port in ports if name in problem.states}
        _ = problem.equations  # raises where nothing of the plant can be proved
        if not shown:
            hint = f"--over '{problem.states[0]} in -1 .. 1'" if problem.states else ""
            raise ClaimError("no output of the plant is a state of it", hint=hint)
        for name, port in shown.items():
            if not math.isfinite(port.high - port.low):
                raise ClaimError(f"'{name}' has no range", hint=f"--over '{name} in -1 .. 1'")
            yield name, port.low, port.high

    def made(self) -> StartMap:
        """Return the whole map."""
        verdict = prove_loop(
            self.text, claim_of_stability(self.claim), plant=self.plant, connect=self.connect,
            sensors=self.sensors, budget=0.5 * self.search.budget,
        )  # fmt: skip
        self.work += verdict.work
        self.region, self.certificate = verdict, verdict.certificate
        if verdict.certificate is None:
            why = verdict.reason or "; ".join(verdict.evidence)  # of a refuted loop
            return self._without_region(why)
        self.odd = is_odd(self.problem)
        case = _Case(
            self.text, self.claim, self.plant, self.connect, self.sensors, verdict.certificate,
            self.odd,
        )  # fmt: skip
        try:
            if self.search.journal is not None:
                self._open(self.search.journal)
            self._searched(case)
        except TimeOverError as error:
            if not self.boxes:
                return self._without_region(str(error))
        except EnclosureError as error:
            raise LoopProofError(str(error)) from error
        finally:
            if self.journal is not None:
                self.journal.close()
        reason = ""
        if self.search.certify:
            try:
                self._certify(verdict.certificate)
            except (LoopProofError, TimeOverError) as error:
                self.certificate = None
                reason = f"no certificate of the map was found: {error}"
        if self.search.runs:
            self._draw()
        return self._map(reason)

    def _without_region(self, why: str) -> StartMap:
        """Return the map of which all is open."""
        low, high = zip(*self.window.values(), strict=True)
        self.boxes = [MappedBox(low, high, OPEN, 0, why)]
        return self._map(f"no region around rest is proved: {why}")

    def _certify(self, region: Certificate) -> None:
        """Leave as proved what the checker follows, and keep that as the certificate."""
        problem = problem_of(
            self.text, region.claim, plant=self.plant, connect=self.connect, sensors=self.sensors
        )
        begun = {name: (span.low, span.high) for name, span in problem.start.items()}
        found: list[tuple[tuple[Pair, ...], int]] = []
        for box in self.boxes:
            if box.verdict == PROVED:
                ends_by_name = zip(self.window, zip(box.low, box.high, strict=True), strict=True)
                sides = begun | dict(ends_by_name)
                ends = tuple((Fraction(a), Fraction(b)) for a, b in sides.values())
                found.append((ends, box.periods))
        window = tuple((name, span.low, span.high) for name, span in self.window.items())
        stop = Stop(max(self.stop.left, 0.0) + SHARE_OF_CHECK * self.search.budget)
        self.certificate, lost = certify_map(problem, replace(region, window=window), found, stop)
        self.work += stop.spent
        order = [problem.states.index(name) for name in self.window]

        def mapped(box: Sequence[Pair], verdict: str, periods: int, reason: str) -> MappedBox:
            low, high = zip(*((float(box[k][0]), float(box[k][1])) for k in order), strict=True)
            return MappedBox(low, high, verdict, periods, reason)

        self.boxes = [box for box in self.boxes if box.verdict != PROVED]
        latest: list[int] = []  # of each box and those before it: into the region, by way of boxes
        for tube in self.certificate.tubes:
            kind, before = tube.into
            on = latest[before - 1] if kind == "tubes" and before else 0
            self.boxes.append(mapped(tube.box, PROVED, tube.periods + on, ""))
            latest.append(max(tube.periods + on, latest[-1] if latest else 0))
        self.boxes += [
            mapped(box, OPEN, 0, f"the checker does not follow it: {reason}")
            for box, reason in lost.items()
        ]

    def _map(self, reason: str = "") -> StartMap:
        verdict = self.region
        settled = [at for at, came in self.drawn if came]
        proved = [box for box in self.boxes if box.verdict == PROVED]
        lows = np.array([box.low for box in proved]).reshape(-1, len(self.window))
        highs = np.array([box.high for box in proved]).reshape(-1, len(self.window))
        within = sum(bool(((lows <= at) & (highs >= at)).all(axis=1).any()) for at in settled)
        begins = self.problem.begins_alone
        return StartMap(
            statement=loop_sentence(
                claim_of_stability(self.claim), self.sensors, self.connect, plant=self.plant,
                text=self.text,
            ),
            window=self.window,
            others={name: self.problem.start[name].low for name in begins},
            boxes=tuple(self.boxes),
            region=verdict.region,
            rest=verdict.rest,
            certificate=self.certificate,
            starts=len(self.drawn),
            settled=len(settled),
            settled_proved=within,
            seconds=time.monotonic() - self.begun,
            work=self.work,
            period=self.problem.period,
            units=self.plant.states,
            reason=reason,
        )  # fmt: skip

    # ── boxes ────────────────────────────────────────────────────────────────────────

    def _searched(self, case: _Case) -> None:
        worker = _Worker(case)
        todo = _without(worker.tiles(), self.boxes)
        worker.learn(self.boxes)
        if (self.workers == 1 and self.search.executor is None) or len(todo) < 2:
            worker.mapped(todo, self.stop.left, self._heard)
            self.work = self.stop.spent
            return
        with self.crew:
            self._shared(packed(case), todo)

    def _shared(self, content: bytes, todo: Sequence[Box]) -> None:
        """Let workers map boxes; each has the whole budget, less what was taken here."""
        count = min(len(todo), self.workers * AT_ONCE)
        parts = [todo[k::count] for k in range(count)]
        left = dict.fromkeys(range(self.workers), self.stop.left)
        under_way: dict[Future[tuple[list[MappedBox], float]], int] = {}
        seconds = self.stop.spent
        while parts or under_way:
            for slot in [k for k in left if k not in under_way.values()]:
                if not parts:
                    break
                share = left[slot] / math.ceil(len(parts) / self.workers)
                known = [box for box in self.boxes if box.verdict == PROVED]
                task = self.crew.submit(_piece, content, parts.pop(0), known, max(share, 0.0))
                under_way[task] = slot
            for task in wait(under_way, return_when=FIRST_COMPLETED).done:
                slot = under_way.pop(task)
                with workers_watched():
                    boxes, taken = task.result()
                left[slot] -= taken
                seconds += taken
                self.work = seconds
                self._heard(boxes)

    def _with_opposites(self, boxes: Sequence[MappedBox]) -> list[MappedBox]:
        if not self.odd:
            return list(boxes)
        return list(dict.fromkeys(each for box in boxes for each in (box, box.opposite)))

    def _heard(self, boxes: Sequence[MappedBox]) -> None:
        boxes = self._with_opposites(boxes)
        self.boxes += boxes
        if self.journal is not None:
            self.journal.append(map(_row, (box for box in boxes if box.verdict != OPEN)))
        now = time.monotonic()
        if self.watch is not None and now > self.told + 0.25:
            self.told = now
            self.watch(self._map())

    # ── the journal ──────────────────────────────────────────────────────────────────

    def _open(self, path: str) -> None:
        """Begin a journal, or go on with it."""
        ends = [f"{name} {end}" for name in self.window for end in ("from", "to")]
        question = question_of(
            {"map": self._map().statement, "window": {n: list(s) for n, s in self.window.items()},
             "odd": self.odd},
            {},
        )  # fmt: skip
        question["files"] = {
            **fingerprints_of(self.text), **loop_digests(self.text, self.plant)
        }  # fmt: skip
        self.journal = journal = WorkJournal(
            path, "map", question, [*ends, "verdict", "periods", "reason"], piece="box",
            option="--resume",
        )  # fmt: skip
        if journal.path.is_file() and journal.path.stat().st_size:
            self.boxes = self._with_opposites(journal.read(lambda _, row: _read_row(row)))
        else:
            journal.begin()

    # ── drawn starts ─────────────────────────────────────────────────────────────────

    def _draw(self) -> None:
        """Simulate runs from drawn starts: the share that comes to rest, and a last doubt."""
        generator = np.random.default_rng(0)
        problem, rest = self.problem, self.region.rest
        values = {name: span.low for name, span in problem.parameters.items()}
        duration = max(problem.plant.duration or 0.0, 1000 * problem.period)
        lost = []
        for _ in range(self.search.runs):
            start = {n: float(generator.uniform(s.low, s.high)) for n, s in problem.start.items()}
            try:
                run = run_of(problem, start, values, duration=duration)
            except FuzzyarmError:
                continue
            if run is None:
                continue
            at = tuple(start[name] for name in self.window)
            if run.diverged is not None:
                lost.append(at)
            self.drawn.append((at, run.diverged is None and self._rests(run, rest)))
        self._demand_none_lost(lost)

    def _rests(self, run: Any, rest: Mapping[str, float]) -> bool:
        """Tell whether a run ends next to rest: a hundredth of the range of each output."""
        problem = self.problem
        for address, port in problem.site.interface.outputs.items():
            name = address[1]
            if name in problem.states:
                last = float(np.asarray(run.outputs[problem.site.interface.label(address)])[-1])
                wide = port.high - port.low if math.isfinite(port.high - port.low) else 1.0
                if not abs(last - rest[name]) <= 0.01 * wide:
                    return False
        return True

    def _demand_none_lost(self, lost: Sequence[tuple[float, ...]]) -> None:
        """Take back boxes that a run contradicts: this has never been seen, and proves a fault."""
        for number, box in enumerate(self.boxes):
            if box.verdict == PROVED and any(
                all(a <= x <= b for a, x, b in zip(box.low, at, box.high, strict=True))
                for at in lost
            ):
                self.boxes[number] = box._replace(
                    verdict=OPEN, reason="a simulated run contradicts its proof"
                )


def _row(box: MappedBox) -> list[str]:
    ends = [repr(x) for pair in zip(box.low, box.high, strict=True) for x in pair]
    return [*ends, box.verdict, str(box.periods), box.reason]


def _read_row(row: Sequence[str]) -> MappedBox:
    *ends, verdict, periods, reason = row
    numbers = [float(x) for x in ends]
    if verdict not in (PROVED, REFUTED) or not all(map(math.isfinite, numbers)):
        raise ValueError
    return MappedBox(tuple(numbers[::2]), tuple(numbers[1::2]), verdict, int(periods), reason)


def _without(boxes: Sequence[Box], done: Sequence[MappedBox]) -> list[Box]:
    """Return boxes without the parts that are done."""
    rest: list[Box] = []
    for box in boxes:
        inside = [d for d in done if _is_within(d, box)]
        rest += _remaining(box, inside)
    return rest


def _is_within(part: MappedBox, box: Box) -> bool:
    ends = zip(part.low, part.high, box.low, box.high, strict=True)
    return all(low >= a and high <= b for low, high, a, b in ends)


def _remaining(box: Box, done: Sequence[MappedBox]) -> list[Box]:
    if not done:
        return [box]
    if any(part.low == box.low and part.high == box.high for part in done):
        return []
    for way in range(len(box.low)):
        halves = box.halves(way)
        parts = [[part for part in done if _is_within(part, half)] for half in halves]
        if sum(map(len, parts)) == len(done):  # no part on both sides of the cut
            found = [_remaining(half, some) for half, some in zip(halves, parts, strict=True)]
            return found[0] + found[1]
    return [box]
