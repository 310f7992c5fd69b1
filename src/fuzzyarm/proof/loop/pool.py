"""A pool of boxes of starts, followed side by side, each from its own first period on.

The pool admits boxes as others leave, to keep arrays at an efficient size. A box leaves when it has
**arrived** at the goal, when all of its runs are **lost** (beyond the bound of a port, or without a
value), or when it is given up: it stalls, has no enclosure, or exceeds the horizon.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError, LostRunError
from fuzzyarm.proof.loop.algebra import Number, Zonotopes
from fuzzyarm.proof.loop.enclosure import EnclosureError, Intervals, Vector
from fuzzyarm.proof.loop.flow import Flow
from fuzzyarm.proof.loop.follower import ORDER, Box, Follower, Nearness
from fuzzyarm.proof.loop.mean_flow import MeanFlow
from fuzzyarm.proof.loop.period import LoopPeriod
from fuzzyarm.proof.loop.zonotope import ENLARGED, ROUNDING, Forms, joined, stacked
from fuzzyarm.proof.stop import Stop
from fuzzyarm.symbolic.nodes import symbols

Flags = NDArray[np.bool_]

ARRIVED, LOST, GIVEN_UP = "arrived", "lost", "given up"

SYMBOLS = 12
"""Symbols per state, besides those of the starts."""

SIDE_BY_SIDE = 1024
"""Boxes followed at once."""

AT_LEAST = 256
"""Boxes admitted at once, if there are as many."""

SPLIT, HARMLESS, MOST_HALVINGS = 0.5, 0.7, 14
"""A box is halved on its way if the width not due to its starts exceeds the first of these times
its initial width, and the second times the goal; the third is the most halvings in all."""

MOST_CUTS = 3
"""Most halvings of a box on its way, by when width not due to its starts has accumulated."""

UNCUT = 1.2
"""The same share of the goal for boxes given up instead of halved."""

OVERLAP = 2.0**-49
"""Overlap of both halves, for the rounding of the ends of a box and of its set: 8 units in the last
place, times 8 for each halving before, since the middle of a set that overlaps is off by more."""

HOPELESS = 2.0
"""Largest ratio of other width to width due to the starts, in a box halved on its way."""

Goal = Callable[[Forms, Mapping[str, Number], int], Nearness]
"""From states, memory and the number of dimensions to the distance from the goal."""


class Fate(NamedTuple):
    """The fate of a box: its periods, the reason, the cause of its width, whether it was cut."""

    box: Box
    end: str
    periods: int
    reason: str
    weight: Vector
    was_cut: bool


@dataclass
class _Swarm:
    """Boxes on their way."""

    states: Forms
    constants: dict[str, Forms]
    memory: dict[str, Number]
    boxes: list[Box]
    ages: NDArray[np.int64]
    doubtful: NDArray[np.int64]  # since when a run may be beyond a bound; 0: never
    weight: Vector  # (dimensions, boxes)
    cuts: NDArray[np.int64]  # halvings of a box on its way
    width: Vector  # in its first period, in units of the goal

    def part(self, which: NDArray[np.int64]) -> _Swarm:
        """Return selected boxes."""
        return _Swarm(
            self.states[:, which],
            {name: forms[which] for name, forms in self.constants.items()},
            {n: x[which] if isinstance(x, Forms) else x for n, x in self.memory.items()},
            [self.boxes[k] for k in which.tolist()],
            self.ages[which],
            self.doubtful[which],
            self.weight[:, which],
            self.cuts[which],
            self.width[which],
        )

    def joined(self, other: _Swarm) -> _Swarm:
        """Return the union."""
        if not self.boxes or not other.boxes:
            return self if self.boxes else other
        sizes = len(self.boxes), len(other.boxes)
        memory: dict[str, Number] = {}
        for name, x in self.memory.items():
            y = other.memory[name]
            if isinstance(x, Forms) or isinstance(y, Forms) or x != y:
                memory[name] = joined(_as_forms(x, sizes[0]), _as_forms(y, sizes[1]), -1)
            else:
                memory[name] = x
        return _Swarm(
            joined(self.states, other.states, -1),
            {n: joined(x, other.constants[n], -1) for n, x in self.constants.items()},
            memory,
            self.boxes + other.boxes,
            np.concatenate([self.ages, other.ages]),
            np.concatenate([self.doubtful, other.doubtful]),
            np.concatenate([self.weight, other.weight], axis=1),
            np.concatenate([self.cuts, other.cuts]),
            np.concatenate([self.width, other.width]),
        )


def _as_forms(x: Number, count: int) -> Forms:
    return x if isinstance(x, Forms) else Forms.at(np.full(count, x))


class Pool:
    """Follows boxes.

    Parameters
    ----------
    problem : LoopProblem
        The loop; its start is the window.
    goal : callable
        Distance of boxes from the destination.
    horizon : int
        Periods after which a box is given up.
    stop : Stop
        The time budget.
    """

    def __init__(self, problem: LoopProblem, goal: Goal, horizon: int, stop: Stop) -> None:
        equations = problem.equations
        if any("t" in symbols(root) for root in (*equations.rates, *equations.outputs)):
            raise LoopProofError("the plant's equations depend on the time")
        self.follower = Follower(problem, horizon * problem.period, stop=stop)
        self.follower.order = ORDER
        self.goal, self.horizon, self.stop = goal, horizon, stop
        self.count = len(self.follower.first.low)
        self.most, self.cuts = MOST_HALVINGS, MOST_CUTS
        self.control = self._control(0)
        self.flow = self.follower.flow
        self.mean = MeanFlow(problem) if isinstance(self.flow, Flow) else None
        self.parts = 1
        self.steps = 0

    def _control(self, batch: int) -> tuple[Zonotopes, LoopPeriod[Number]]:
        algebra = Zonotopes(batch, self.follower.planes, by_cells=True)
        return algebra, LoopPeriod[Number](self.follower.problem, algebra)

    def follow(
        self, boxes: Callable[[int], Sequence[Box]], done: Callable[[Sequence[Fate]], None]
    ) -> list[Box]:
        """Follow boxes until none is left or time is over; return those on their way.

        `boxes(n)` gives at most n. `done` receives the fates of those that leave, and may add
        boxes.
        """
        swarm: _Swarm | None = None
        with np.errstate(all="ignore"):  # non-finite boxes are rejected in each period
            while not self.stop.now:
                here = 0 if swarm is None else len(swarm.boxes)
                if here <= SIDE_BY_SIDE - AT_LEAST:
                    new = list(boxes(SIDE_BY_SIDE - here))
                    if new:
                        begun, fates = self._begun(new)
                        if fates:
                            done(fates)
                        swarm = begun if swarm is None else swarm.joined(begun)
                        continue
                if swarm is None or not swarm.boxes:
                    return []
                swarm, fates = self._advanced(swarm, first=False)
                if fates:
                    done(fates)
        return [] if swarm is None else swarm.boxes

    def restart(self, stop: Stop) -> None:
        """Continue with another time budget."""
        self.stop = self.follower.stop = stop

    def _begun(self, boxes: Sequence[Box]) -> tuple[_Swarm, list[Fate]]:
        """Return boxes after their first period."""
        follower, batch = self.follower, len(boxes)
        states, constants = follower.start_forms(boxes)
        control = self.control[1]
        memory: dict[str, Number] = {
            name: 0.0 if math.isnan(value) else value for name, value in control.memory.items()
        }
        follower.sizes = states.bounds.size.max(axis=1)
        swarm = _Swarm(
            states, constants, memory, list(boxes), np.zeros(batch, dtype=np.int64),
            np.zeros(batch, dtype=np.int64), np.ones((self.count, batch)),
            np.zeros(batch, dtype=np.int64), np.ones(batch),
        )  # fmt: skip
        return self._advanced(swarm, first=True)

    def _advanced(self, swarm: _Swarm, *, first: bool) -> tuple[_Swarm, list[Fate]]:
        """Return boxes one period later, and the fates of those that leave."""
        follower = self.follower
        batch = len(swarm.boxes)
        algebra, control = self._control(batch)
        try:
            follower.sizes = swarm.states.bounds.size.max(axis=1)
            states, drives, memory = follower.controlled(
                control, swarm.states, swarm.constants, swarm.memory, 0 if first else 1
            )
            states = self._moved(states, swarm.constants, drives)
            later = replace(swarm, states=states, memory=memory, ages=swarm.ages + 1)
            known = np.isfinite(states.radius).all(axis=0)
            fates = [
                self._fate(swarm.part(k), GIVEN_UP, EnclosureError("its tube has no bound"))
                for k in np.flatnonzero(~known)[:, None]
            ]
            if fates:
                later = later.part(np.flatnonzero(known))
                algebra, _ = self._control(len(later.boxes))
            if not later.boxes:
                return later, fates
            at = follower.outputs_at(later.states, later.constants, 0.0)
            near = self.goal(later.states, later.memory, self.count)
            later.states, later.memory = self._fewer(later.states, later.memory, algebra)
        except LostRunError as error:
            if batch == 1:
                return swarm.part(np.zeros(0, dtype=np.int64)), [self._fate(swarm, LOST, error)]
            return self._apart(swarm, first=first)
        except EnclosureError as error:
            if batch == 1 or self.stop.now:
                nothing = swarm.part(np.zeros(0, dtype=np.int64))
                fate = self._fate(swarm, GIVEN_UP, error)
                return nothing, [fate._replace(box=box) for box in swarm.boxes]
            return self._apart(swarm, first=first)
        self.steps += 1
        later.weight = near.starts
        stays, others = self._left(later, near, at)
        return stays, fates + others

    def _moved(
        self, states: Forms, constants: Mapping[str, Forms], drives: Mapping[str, Forms]
    ) -> Forms:
        """Return the states one period later; unbounded for sets without an enclosure."""
        inputs = stacked([drives[name] for name in self.follower.inputs])
        if self.mean is not None:
            try:
                ends = self.mean.ends(states, inputs)
            except LoopProofError:  # the checker has no slopes of the equations
                self.mean = None
        if self.mean is None:
            everything = {**constants, **drives}
            ends, _, self.parts = self.follower.moved(states, everything, 0.0, self.parts)
            return ends
        known = np.isfinite(ends.rest).all(axis=0)
        if known.all() or not isinstance(self.flow, Flow):
            return ends
        which = np.flatnonzero(~known)
        some = {name: forms[which] for name, forms in {**constants, **drives}.items()}
        try:
            step = self.flow.step_of_first_order(states[:, which], some, 0.0, self.follower.period)
        except EnclosureError:
            return ends
        order = np.argsort(np.concatenate([np.flatnonzero(known), which]))
        return joined(ends[:, known], step.end, -1)[:, order]

    def _apart(self, swarm: _Swarm, *, first: bool) -> tuple[_Swarm, list[Fate]]:
        """Return two halves of the swarm, each one period later: one of the boxes fails."""
        middle = len(swarm.boxes) // 2
        every = np.arange(len(swarm.boxes))
        one, fates = self._advanced(swarm.part(every[:middle]), first=first)
        two, others = self._advanced(swarm.part(every[middle:]), first=first)
        return one.joined(two), fates + others

    def _fewer(
        self, states: Forms, memory: Mapping[str, Number], algebra: Zonotopes
    ) -> tuple[Forms, dict[str, Number]]:
        return self.follower._fewer(states, memory, self.count, algebra, SYMBOLS)

    def _fate(self, swarm: _Swarm, end: str, error: Exception) -> Fate:
        at_end = isinstance(error, LostRunError)
        words = error.where if isinstance(error, LostRunError) else str(error)
        return Fate(
            swarm.boxes[0],
            end,
            int(swarm.ages[0]) + at_end,
            words,
            swarm.weight[:, 0],
            bool(swarm.cuts[0]),
        )

    def _left(self, swarm: _Swarm, near: Nearness, at: Intervals) -> tuple[_Swarm, list[Fate]]:
        """Return the boxes that stay, and the fates of the others."""
        follower = self.follower
        low, high = at.low, at.high
        limits = follower.limits[:, None]
        ports = len(limits)
        out = follower.is_lost(at)
        lost = np.asarray(out.any(axis=0))
        over = ~(np.maximum(-low[:ports], high[:ports]) <= limits).all(axis=0)
        swarm.doubtful = np.where((swarm.doubtful == 0) & over, swarm.ages, swarm.doubtful)
        doubtful = swarm.doubtful > 0
        arrived = np.asarray((near.value <= 1.0) & ~doubtful & ~lost)
        # Boxes that may have left a bound, and are not wholly beyond it soon after, are halved.
        old = (swarm.ages >= self.horizon) | (
            doubtful & (swarm.ages > swarm.doubtful + swarm.doubtful // 4 + 16)
        )
        due = near.starts.sum(axis=0)
        width = due + near.rest
        swarm.width = np.where(swarm.ages > 1, swarm.width, width)
        allowed = np.maximum(HARMLESS if self.cuts else UNCUT, SPLIT * swarm.width)
        cut = ~(near.rest <= allowed) & ~(lost | arrived | old)
        halvings = np.array([sum(box.halvings) for box in swarm.boxes])
        hopeless = np.asarray(cut & (~(near.rest <= HOPELESS * due) | (halvings >= self.most)))
        hopeless = hopeless | (cut & (swarm.cuts >= self.cuts))
        cut &= ~hopeless
        gone = lost | arrived | old | hopeless
        if not (gone | cut).any():
            return swarm, []
        fates = []
        for k in np.flatnonzero(gone).tolist():
            if lost[k]:
                name = follower.labels[int(out[:, k].argmax())]
                end, words = LOST, f"beyond the bound of '{name}'"
            elif arrived[k]:
                end, words = ARRIVED, ""
            else:
                end = GIVEN_UP
                words = (
                    "some runs may leave a bound" if doubtful[k]
                    else "its tube grows" if hopeless[k]
                    else "it takes too long"
                )  # fmt: skip
            fates.append(
                Fate(
                    swarm.boxes[k],
                    end,
                    int(swarm.ages[k]),
                    words,
                    swarm.weight[:, k],
                    bool(swarm.cuts[k]),
                )
            )
        stays = swarm.part(np.flatnonzero(~(gone | cut)))
        if cut.any():
            stays = stays.joined(self._halved(swarm.part(np.flatnonzero(cut))))
        return stays, fates

    def _halved(self, swarm: _Swarm) -> _Swarm:
        """Return both halves of each box, at their present states."""
        ways = np.array(
            [self.dimension(box, w) for box, w in zip(swarm.boxes, swarm.weight.T, strict=True)]
        )
        sides = [(box.low[way], box.high[way]) for box, way in zip(swarm.boxes, ways, strict=True)]
        low, high = np.array(sides).T
        over = OVERLAP * 8.0**swarm.cuts * np.maximum(-low, high) / (high - low)
        halves = []
        for upper in (False, True):
            half = swarm.part(np.arange(len(swarm.boxes)))
            half.width = 0.5 * half.width
            cut = functools.partial(_narrowed, symbols_of=ways, over=over, upper=upper)
            half.cuts = half.cuts + 1
            half.states = cut(half.states)
            half.constants = {n: cut(x) for n, x in half.constants.items()}
            half.memory = {n: cut(x) if isinstance(x, Forms) else x for n, x in half.memory.items()}
            half.boxes = [
                box.halves(way)[upper] for box, way in zip(half.boxes, ways.tolist(), strict=True)
            ]
            halves.append(half)
        return halves[0].joined(halves[1])

    def dimension(self, box: Box, weight: Vector) -> int:
        """Return the dimension to halve: the one that contributes most to the width."""
        return int(np.argmax(weight + 1e-3 * weight.sum() * 0.5 ** np.array(box.halvings)))


def _narrowed(x: Forms, symbols_of: NDArray[np.int64], over: Vector, *, upper: bool) -> Forms:
    """Return forms on one half of a symbol of each box, and a bit more: ε = ± ½ + (½ + over) ε'."""
    every = np.arange(len(symbols_of))
    index = (symbols_of, ..., every)
    if len(x.parts) <= int(symbols_of.max()):
        return x  # over none of them
    halves = x.parts[index] * (0.5 if upper else -0.5)  # exact
    halves = np.moveaxis(halves, 0, -1)
    parts = x.parts.copy()
    parts[index] = (parts[index].T * (0.5 + over)).T
    centre = x.centre + halves
    rest = x.rest + ROUNDING * (np.abs(centre) + np.abs(halves) * (1.0 + 2.0 * over))
    return Forms(centre, parts, rest * ENLARGED)
