"""The map of starts: boxes from which every run converges, boxes of lost runs, open boxes.

A window of starts is cut into boxes. A box is **proved** if the tube from all of it leads into the
invariant region of attraction (:class:`~fuzzyarm.proof.loop.timed.Haven`), **refuted** if all of
its runs certainly leave the bound of a port, or have no value; at the smallest size, if the run
from its midpoint does. Everything else is **open**, with the reason. The region is found once, rule
bases are cut once; boxes are followed side by side (:mod:`fuzzyarm.proof.loop.pool`), large ones
first.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.control.loop.blocks import Workers, packed, workers_watched
from fuzzyarm.control.loop.course import Sensor
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.plant.own import for_runs
from fuzzyarm.plant.plant import Plant, with_parameters
from fuzzyarm.proof.check.certificate import Certificate, Pair, fingerprints_of
from fuzzyarm.proof.claim.identity import loop_digests
from fuzzyarm.proof.claim.problem import ClaimError, LoopProofError
from fuzzyarm.proof.claim.text import GivenLoop
from fuzzyarm.proof.loop.boxes import certify_map
from fuzzyarm.proof.loop.enclosure import EnclosureError
from fuzzyarm.proof.loop.follower import Box
from fuzzyarm.proof.loop.map_worker import MapCase, MapWorker, mapped_box, mapped_piece
from fuzzyarm.proof.loop.runs import run_of
from fuzzyarm.proof.loop.start_map import OPEN, PROVED, REFUTED, MappedBox, StartMap
from fuzzyarm.proof.loop.symmetry import is_odd
from fuzzyarm.proof.loop.timed import claim_of_stability
from fuzzyarm.proof.loop.verdicts import judged
from fuzzyarm.proof.stop import LOOP_BUDGET, Stop, TimeOverError
from fuzzyarm.requests.journal import WorkJournal, question_of
from fuzzyarm.symbolic.operations import Interval

RUNS = 400
"""Random starts, to estimate the share of runs that come to rest."""

SHARE_OF_CHECK = 0.5
"""Least share of the budget for the checker to follow the boxes of a certificate."""

ROUNDS = 6
"""Rounds after which workers exchange proved boxes; each round is longer than the last."""


Watch = Callable[[StartMap], None]


@dataclass(frozen=True)
class MapSearch:
    """Settings of a map's search.

    Attributes
    ----------
    budget : float
        Processor seconds of each worker.
    workers : int
        Processes at a time.
    journal : str, optional
        A file with a line for each box; a journal of the same question is continued.
    runs : int
        Random starts to simulate.
    certify : bool
        Whether a box must be followed by the checker to count as proved, for a certificate.
    executor : Executor, optional
        Any of :mod:`concurrent.futures`, instead of processes of this machine.
    """

    budget: float = LOOP_BUDGET
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
        Stability, with set points and parameters; its starts are the window, by default the ranges
        of the outputs that are states.
    search : MapSearch
        Budget and workers.
    plant : Plant
        The plant.
    connect, sensors
        As for :func:`fuzzyarm.proof.loop.prove_loop`.
    watch : callable, optional
        Called now and then with the map so far.

    Raises
    ------
    ClaimError
        If the window has an unknown state, or an output has no range for the window.
    LoopProofError
        If the loop has a part that no proof covers, by name.
    """
    return _Map(GivenLoop(text, plant, connect, sensors), plant, claim, search, watch).made()


class _Drawn(NamedTuple):
    """A random start, and the result of its run."""

    start: tuple[float, ...]
    rests: bool
    is_lost: bool


class _Map:
    """The search of one map."""

    def __init__(
        self, given: GivenLoop, plant: Plant, claim: LoopClaim, search: MapSearch,
        watch: Watch | None,
    ) -> None:  # fmt: skip
        self.begun, self.stop = time.monotonic(), Stop(search.budget)
        self.given, self.plant = given, plant
        count = None if search.executor is not None and search.workers == 1 else search.workers
        self.crew = Workers(count, search.executor)
        self.search, self.workers, self.watch = search, self.crew.count, watch
        start = claim.start or tuple(self._ranges(claim))
        self.claim = replace(claim_of_stability(claim), start=start)
        self.problem = given.problem(self.claim)
        self.window = {name: Interval(low, high) for name, low, high in start}
        for name, span in self.problem.parameters.items():
            if span.low < span.high:
                hint = f"one value at a time, as in --with '{name} in {span.low:g} .. {span.low:g}'"
                raise ClaimError(f"a map takes no interval of a parameter, as of {name}", hint=hint)
        for name, span in self.window.items():
            if not span.low < span.high:
                raise ClaimError(f"not a window: {name} in {span.low:g} .. {span.high:g}")
        self.boxes: list[MappedBox] = []
        self.work = 0.0
        self.journal: WorkJournal | None = None
        self.drawn: list[_Drawn] = []
        self.next_look = -math.inf
        self.certificate: Certificate | None = None
        self.chained = False

    def _ranges(self, claim: LoopClaim) -> Iterator[tuple[str, float, float]]:
        """Yield the ranges of the outputs that are states."""
        problem = self.given.problem(claim_of_stability(claim))
        ports = problem.site.interface.outputs.items()
        shown = {name: port for (_, name), port in ports if name in problem.states}
        _ = problem.equations  # raises if the plant's equations cannot be traced
        if not shown:
            hint = f"--over '{problem.states[0]} in -1 .. 1'" if problem.states else ""
            raise ClaimError("no output of the plant is a state of it", hint=hint)
        for name, port in shown.items():
            if not math.isfinite(port.high - port.low):
                raise ClaimError(f"'{name}' has no range", hint=f"--over '{name} in -1 .. 1'")
            yield name, port.low, port.high

    def made(self) -> StartMap:
        """Return the whole map."""
        claim = claim_of_stability(self.claim)
        verdict = judged(self.given, claim, budget=0.5 * self.search.budget)
        self.work += verdict.work
        self.region, self.certificate = verdict, verdict.certificate
        if verdict.certificate is None:
            why = verdict.reason or "; ".join(verdict.evidence)  # for a refuted loop
            return self._without_region(why)
        self.odd = is_odd(self.problem)
        case = MapCase(self.given, self.claim, verdict.certificate, self.odd)
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
            self.drawn = self._draw()
        return self._map(reason)

    def _without_region(self, why: str) -> StartMap:
        """Return the map with everything open."""
        low, high = zip(*self.window.values(), strict=True)
        self.boxes = [MappedBox(low, high, OPEN, 0, why)]
        return self._map(f"no region around rest is proved: {why}")

    def _certify(self, region: Certificate) -> None:
        """Keep as proved the boxes that the checker follows, with their certificate."""
        problem = self.given.problem(region.claim)
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
        self.certificate, ways, lost = certify_map(
            problem, replace(region, window=window), found, stop
        )
        self.work += stop.spent
        order = [problem.states.index(name) for name in self.window]

        def mapped(box: Sequence[Pair], verdict: str, periods: int, reason: str) -> MappedBox:
            low, high = zip(*((float(box[k][0]), float(box[k][1])) for k in order), strict=True)
            return MappedBox(low, high, verdict, periods, reason)

        self.boxes = [box for box in self.boxes if box.verdict != PROVED]
        self.chained = False
        latest: list[int] = []  # by box, periods into the region through boxes
        for number, tube in enumerate(self.certificate.tubes):
            kind, before = tube.into
            on = latest[before - 1] if kind == "tubes" and before else 0
            if number >= ways:
                self.boxes.append(mapped(tube.box, PROVED, tube.periods + on, ""))
            latest.append(max(tube.periods + on, latest[-1] if latest else 0))
        self.boxes += [
            mapped(box, OPEN, 0, f"the checker does not follow it: {reason}")
            for box, reason in lost.items()
        ]

    def _map(self, reason: str = "") -> StartMap:
        verdict = self.region
        holding = self._proved_boxes_at([run.start for run in self.drawn])
        for run, numbers in zip(self.drawn, holding, strict=True):
            if run.is_lost:  # never seen; would prove a fault of fuzzyarm
                for number in numbers.tolist():
                    self.boxes[number] = self.boxes[number]._replace(
                        verdict=OPEN, reason="a simulated run contradicts its proof"
                    )
        begins = self.problem.begins_alone
        return StartMap(
            statement=self.given.sentence(claim_of_stability(self.claim)),
            window=self.window,
            others={name: self.problem.start[name].low for name in begins},
            boxes=tuple(self.boxes),
            region=verdict.region,
            rest=verdict.rest,
            certificate=self.certificate,
            starts=len(self.drawn),
            settled=sum(run.rests for run in self.drawn),
            settled_proved=sum(
                run.rests and any(self.boxes[k].verdict == PROVED for k in numbers.tolist())
                for run, numbers in zip(self.drawn, holding, strict=True)
            ),
            seconds=time.monotonic() - self.begun,
            work=self.work,
            period=self.problem.period,
            units=dict(self.plant.states),
            reason=reason,
            chained=self.chained,
        )  # fmt: skip

    # ── boxes ────────────────────────────────────────────────────────────────────────

    def _searched(self, case: MapCase) -> None:
        worker = MapWorker(case)
        self.chained = worker.cover is not None
        todo = worker.tiles(_remaining(worker.first, self.boxes))
        worker.learn(self.boxes)
        if (self.workers == 1 and self.search.executor is None) or len(todo) < 2:
            rest = worker.mapped(dict.fromkeys(todo, ""), self.stop.left, self._report)
            self.work = self.stop.spent
        else:
            with self.crew:
                rest = self._shared(packed(case), todo)
        late = "time ran out"
        self._report([mapped_box(box, OPEN, 0, reason or late) for box, reason in rest.items()])

    def _shared(self, content: bytes, boxes: Sequence[Box]) -> dict[Box, str]:
        """Let workers map boxes; each has the whole budget, minus the time used here."""
        todo = dict.fromkeys(boxes, "")
        budget, begun, spent = self.stop.left, time.process_time(), [0.0] * self.workers
        self.work = self.stop.spent
        for rounds in range(ROUNDS, 0, -1):
            # Neighbours along the first state: the boxes that a worker proves are goals for its
            # others.
            row = sorted(todo)
            ends = [len(row) * k // self.workers for k in range(self.workers + 1)]
            parts = [{box: todo[box] for box in row[a:b]} for a, b in pairwise(ends)]
            known = [box for box in self.boxes if box.verdict == PROVED]
            rest = budget - (time.process_time() - begun)  # includes the work between rounds
            left = [max(rest - seconds, 0.0) / 2 ** (rounds - 1) for seconds in spent]
            tasks = [
                self.crew.submit(mapped_piece, content, part, known, seconds)
                for part, seconds in zip(parts, left, strict=True)
            ]
            todo = {}
            for slot, task in enumerate(tasks):
                with workers_watched():
                    decided, undone, taken = task.result()
                spent[slot] += taken
                todo |= undone
                self._report(decided)
            if not todo:
                break
        self.work += time.process_time() - begun + sum(spent)
        return todo

    def _with_opposites(self, boxes: Sequence[MappedBox]) -> list[MappedBox]:
        if not self.odd:
            return list(boxes)
        return list(dict.fromkeys(each for box in boxes for each in (box, box.opposite)))

    def _report(self, boxes: Sequence[MappedBox]) -> None:
        boxes = self._with_opposites(boxes)
        self.boxes += boxes
        if self.journal is not None:
            self.journal.append(map(_row, (box for box in boxes if box.verdict != OPEN)))
        now = time.monotonic()
        if self.watch is not None and now > self.next_look:
            self.watch(self._map())
            after = time.monotonic()
            self.next_look = after + max(0.25, 9.0 * (after - now))  # a tenth of the time

    # ── the journal ──────────────────────────────────────────────────────────────────

    def _open(self, path: str) -> None:
        """Begin a journal, or continue it."""
        ends = [f"{name} {end}" for name in self.window for end in ("from", "to")]
        question = question_of(
            {"map": self._map().statement, "window": {n: list(s) for n, s in self.window.items()},
             "odd": self.odd},
            {},
        )  # fmt: skip
        question["files"] = {
            **fingerprints_of(self.given.text), **loop_digests(self.given.text, self.plant)
        }  # fmt: skip
        self.journal = journal = WorkJournal(
            path, "map", question, [*ends, "verdict", "periods", "reason"], piece="box",
            option="--resume", sealed=True,
        )  # fmt: skip
        if journal.path.is_file() and journal.path.stat().st_size:
            self.boxes = self._with_opposites(journal.read(lambda _, row: _read_row(row)))
        else:
            journal.begin()

    # ── random starts ────────────────────────────────────────────────────────────────

    def _draw(self) -> list[_Drawn]:
        """Simulate runs from random starts: the share that comes to rest, and a last test."""
        generator = np.random.default_rng(0)
        problem, rest = self.problem, self.region.rest
        values = {name: span.low for name, span in problem.parameters.items()}
        # The equations are traced once for all runs.
        problem = replace(problem, plant=for_runs(with_parameters(problem.plant, values)))
        duration = max(problem.plant.duration or 0.0, 1000 * problem.period)
        drawn = []
        for _ in range(self.search.runs):
            start = {n: float(generator.uniform(s.low, s.high)) for n, s in problem.start.items()}
            try:
                run = run_of(problem, start, {}, duration=duration)
            except FuzzyarmError:
                continue
            if run is not None:
                is_lost = run.diverged is not None
                at = tuple(start[name] for name in self.window)
                drawn.append(_Drawn(at, not is_lost and self._rests(run, rest), is_lost))
        return drawn

    def _proved_boxes_at(self, starts: Sequence[tuple[float, ...]]) -> list[NDArray[np.int64]]:
        """Return the indices of the proved boxes that contain each start."""
        if not starts:
            return []
        numbers = np.array([k for k, b in enumerate(self.boxes) if b.verdict == PROVED], dtype=int)
        proved = [self.boxes[k] for k in numbers.tolist()]
        low = np.array([box.low for box in proved]).reshape(-1, len(self.window))
        high = np.array([box.high for box in proved]).reshape(-1, len(self.window))
        return [numbers[((low <= at) & (high >= at)).all(axis=1)] for at in starts]

    def _rests(self, run: Any, rest: Mapping[str, float]) -> bool:
        """Return whether a run ends near rest: within a hundredth of each output's range."""
        problem = self.problem
        for address, port in problem.site.interface.outputs.items():
            name = address[1]
            if name in problem.states:
                last = float(np.asarray(run.outputs[problem.site.interface.label(address)])[-1])
                wide = port.high - port.low if math.isfinite(port.high - port.low) else 1.0
                if not abs(last - rest[name]) <= 0.01 * wide:
                    return False
        return True


def _row(box: MappedBox) -> list[str]:
    ends = [repr(x) for pair in zip(box.low, box.high, strict=True) for x in pair]
    return [*ends, box.verdict, str(box.periods), box.reason]


def _read_row(row: Sequence[str]) -> MappedBox:
    *ends, verdict, periods, reason = row
    numbers = [float(x) for x in ends]
    are_sides = all(a < b for a, b in zip(numbers[::2], numbers[1::2], strict=True))
    is_count = periods.isascii() and periods.isdigit() and len(periods) < 10
    are_sides = are_sides and all(map(math.isfinite, numbers))
    if verdict not in (PROVED, REFUTED) or not (is_count and are_sides):
        raise ValueError
    return MappedBox(tuple(numbers[::2]), tuple(numbers[1::2]), verdict, int(periods), reason)


def _is_within(part: MappedBox, box: Box) -> bool:
    ends = zip(part.low, part.high, box.low, box.high, strict=True)
    return all(low >= a and high <= b for low, high, a, b in ends)


def _remaining(box: Box, done: Sequence[MappedBox]) -> list[Box]:
    """Return a box without its finished parts; LoopProofError if those overlap."""
    if not done:
        return [box]
    if len(done) == 1 and (done[0].low, done[0].high) == (box.low, box.high):
        return []
    for way in range(len(box.low)):
        halves = box.halves(way)
        parts = [[part for part in done if _is_within(part, half)] for half in halves]
        if sum(map(len, parts)) == len(done):  # no part on both sides of the cut
            found = [_remaining(half, some) for half, some in zip(halves, parts, strict=True)]
            return found[0] + found[1]
    raise LoopProofError(
        "the boxes of the journal overlap, or are not repeated halves of the window",
        hint="begin anew, with another file",
    )
