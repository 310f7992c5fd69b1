"""Where the blocks of a diagram stand and how its wires go: layers, rows and tracks.

A layer is a column of blocks; what a block reads stands in a layer to its left. Rows count from 0
downwards; blocks and the wires that pass between them keep at least one row from each other.
Between two layers a wire may change its row; it does so on a track of the gap, and no two wires lie
on one another. Nothing here knows what a block is.

The method is that of Sugiyama, Tagawa and Toda, "Methods for visual understanding of hierarchical
system structures" (IEEE Trans. SMC 11, 1981), with the tracks of a channel router.
"""

from __future__ import annotations

from bisect import bisect_right, insort
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

SWEEPS = 24
"""Passes over the layers, to and fro; of all that they find the best is taken."""

LARGE = 400
"""Items from which on a few passes have to do, so that any diagram is there at once."""


Cost = tuple[int, float]
"""How many wires cross, and how far and how often they change their row."""


class Pins(NamedTuple):
    """A block as the layout sees it.

    Attributes
    ----------
    inputs, outputs : int
        How many wires begin and end at it.
    place : str
        ``first`` or ``last`` for a block at the edge, ``late`` for one that stands as near as
        possible to what reads it, else empty.
    """

    inputs: int
    outputs: int
    place: str = ""


class Link(NamedTuple):
    """A wire from an output of a block to an input of another."""

    source: int
    output: int
    target: int
    input: int


class Corner(NamedTuple):
    """Where a wire changes its row.

    Attributes
    ----------
    gap : int
        Between this layer and the next one.
    track : int
        In the gap, from the left.
    row : float
        The row from there on.
    """

    gap: int
    track: int
    row: float


class LayeredGraph(NamedTuple):
    """What :func:`lay_out` finds.

    Attributes
    ----------
    layers : list of int
        Of each block.
    rows : list of float
        The middle of each block; multiples of a half.
    paths : list of tuple of Corner
        Of each link.
    tracks : list of int
        How many there are in the gap behind each layer.
    height : float
        How many rows there are.
    """

    layers: list[int]
    rows: list[float]
    paths: list[tuple[Corner, ...]]
    tracks: list[int]
    height: float


def pin(index: int, count: int) -> float:
    """Return how far below the middle of a block one of its pins is, in rows."""
    return index - 0.5 * (count - 1)


def lay_out(blocks: Sequence[Pins], links: Sequence[Link]) -> LayeredGraph:
    """Find layers and rows of blocks, and the ways of the wires between them."""
    layers = _layers(blocks, links)
    net = _Net(blocks, links, layers)
    rows = net.arranged()
    tracks, paths = _tracks(net, rows)
    values = [rows[index] for index in range(len(blocks))]
    height = max((rows[i] + 0.5 * net.heights[i] + 0.5 for i in range(len(rows))), default=0.0)
    return LayeredGraph(layers, values, paths, tracks, height)


# --- Layers ---


def _layers(blocks: Sequence[Pins], links: Sequence[Link]) -> list[int]:
    """Return the layer of each block: behind all that it reads."""
    readers, count = defaultdict(list), [0] * len(blocks)
    for link in links:
        readers[link.source].append(link.target)
        count[link.target] += 1
    layers = [0] * len(blocks)
    waiting = [index for index in range(len(blocks)) if not count[index]]
    while waiting:
        index = waiting.pop()
        for reader in readers[index]:
            layers[reader] = max(layers[reader], layers[index] + 1)
            count[reader] -= 1
            if not count[reader]:
                waiting.append(reader)
    last = max(layers, default=0)
    for index, block in enumerate(blocks):
        if block.place == "last":
            layers[index] = last
        elif block.place == "late" and readers[index]:
            layers[index] = max(0, min(layers[reader] for reader in readers[index]) - 1)
    return layers


# --- Rows ---


@dataclass
class _Edge:
    """From one layer to the next: items, and how far their pins are from their middles."""

    source: int
    output: float
    target: int
    input: float


class _Net:
    """Blocks, and an item for each layer that an output passes on its way."""

    def __init__(
        self, blocks: Sequence[Pins], links: Sequence[Link], layers: Sequence[int]
    ) -> None:
        self.blocks, self.links = blocks, links
        self.layer_of = list(layers)
        self.heights = [max(1, block.inputs, block.outputs) for block in blocks]
        self.edges: list[_Edge] = []
        self.passing: dict[tuple[int, int, int], int] = {}
        for link in links:
            output = pin(link.output, blocks[link.source].outputs)
            before = link.source
            for layer in range(layers[link.source] + 1, layers[link.target]):
                key = (link.source, link.output, layer)
                if key not in self.passing:
                    self.passing[key] = len(self.heights)
                    self.heights.append(1)
                    self.layer_of.append(layer)
                    self.edges.append(_Edge(before, output, self.passing[key], 0.0))
                before, output = self.passing[key], 0.0
            entry = pin(link.input, blocks[link.target].inputs)
            self.edges.append(_Edge(before, output, link.target, entry))
        count = max(self.layer_of, default=-1) + 1
        self.columns: list[list[int]] = [[] for _ in range(count)]
        for item, layer in enumerate(self.layer_of):
            self.columns[layer].append(item)
        self.into: dict[int, list[_Edge]] = defaultdict(list)
        self.out_of: dict[int, list[_Edge]] = defaultdict(list)
        for edge in self.edges:
            self.into[edge.target].append(edge)
            self.out_of[edge.source].append(edge)

    def arranged(self) -> list[float]:
        """Return the row of each item."""
        rows = [0.0] * len(self.heights)
        for column in self.columns:
            self._stack(column, rows, [0.0] * len(column))
        best, least = list(rows), self._cost(rows)
        for sweep in range(SWEEPS if len(rows) < LARGE else 4):
            forward = sweep % 2 == 0
            for column in self.columns if forward else reversed(self.columns):
                # The last passes keep the order and only straighten wires.
                self._settle(column, rows, forward=forward, sort=sweep < SWEEPS - 8)
            cost = self._cost(rows)
            if cost < least:
                best, least = list(rows), cost
        for column in self.columns:
            column.sort(key=best.__getitem__)
        rows = self._straightened(best) if len(rows) < LARGE else best
        top = min((rows[i] - 0.5 * self.heights[i] + 0.5 for i in range(len(rows))), default=0.0)
        return [row - top for row in rows]

    def _wishes(self, item: int, rows: Sequence[float], *, forward: bool) -> list[float]:
        """Return the rows at which an item would have straight wires."""
        if forward:
            return [rows[e.source] + e.output - e.input for e in self.into[item]]
        return [rows[e.target] + e.input - e.output for e in self.out_of[item]]

    def _settle(self, column: list[int], rows: list[float], *, forward: bool, sort: bool) -> None:
        """Move the items of a layer towards what stands in the one before, or behind."""
        aims = []
        for item in column:
            wishes = self._wishes(item, rows, forward=forward)
            aims.append(sum(wishes) / len(wishes) if wishes else rows[item])
        if sort:
            order = sorted(range(len(column)), key=lambda k: (aims[k], rows[column[k]]))
            column[:] = [column[k] for k in order]
            aims = [aims[k] for k in order]
        self._stack(column, rows, aims)

    def _stack(self, column: Sequence[int], rows: list[float], aims: Sequence[float]) -> None:
        """Give the items of a layer rows in their order, as near as possible to their aims."""
        offset, offsets = 0.0, []
        for before, item in pairwise((None, *column)):
            if before is not None and item is not None:
                offset += 0.5 * (self.heights[before] + self.heights[item])
            offsets.append(offset)
        # Pool adjacent violators: items that would overlap share the mean of their aims.
        pools: list[tuple[float, int]] = []
        for aim, offset in zip(aims, offsets, strict=True):
            mean, count = aim - offset, 1
            while pools and pools[-1][0] > mean:
                other, size = pools.pop()
                mean, count = (mean * count + other * size) / (count + size), count + size
            pools.append((mean, count))
        means = [round(2.0 * mean) / 2.0 for mean, count in pools for _ in range(count)]
        for item, mean, offset in zip(column, means, offsets, strict=True):
            rows[item] = mean + offset

    def _cost(self, rows: Sequence[float]) -> Cost:
        """Return how many wires cross, and how far and how often they change their row."""
        gaps: dict[int, list[tuple[float, float]]] = defaultdict(list)
        length = 0.0
        for edge in self.edges:
            a, b = rows[edge.source] + edge.output, rows[edge.target] + edge.input
            gaps[self.layer_of[edge.source]].append((a, b))
            length += abs(a - b) + (a != b)
        return sum(map(_crossings, gaps.values())), length

    def _straightened(self, rows: list[float]) -> list[float]:
        """Move items, runs of items on one row and pairs of neighbours, as long as that helps."""
        least = self._cost(rows)
        for _ in range(6):
            before = least
            for column in self.columns:
                for upper in range(len(column) - 1):
                    rows, least = self._swapped(column, upper, rows, least)
            for run in self._runs(rows):
                rows, least = self._moved(run, rows, least)
            if least == before:
                break
        return rows

    def _moved(
        self, run: Sequence[int], rows: list[float], least: Cost
    ) -> tuple[list[float], Cost]:
        """Move items to where one of them has a straight wire, if that is better."""
        steps = {
            wish - rows[item]
            for item in run
            for forward in (True, False)
            for wish in self._wishes(item, rows, forward=forward)
        }
        for step in sorted(steps - {0.0}):
            new_rows = list(rows)
            for item in run:
                new_rows[item] += step
            if self._free(run, new_rows):
                cost = self._cost(new_rows)
                if cost < least:
                    return new_rows, cost
        return rows, least

    def _swapped(
        self, column: list[int], upper: int, rows: list[float], least: Cost
    ) -> tuple[list[float], Cost]:
        """Let two neighbours of a layer change places, if that is better."""
        first, second = column[upper], column[upper + 1]
        new_rows = list(rows)
        new_rows[second] = rows[first] + 0.5 * (self.heights[second] - self.heights[first])
        new_rows[first] = rows[second] + 0.5 * (self.heights[second] - self.heights[first])
        cost = self._cost(new_rows)
        if cost >= least:
            return rows, least
        column[upper : upper + 2] = [second, first]
        return new_rows, cost

    def _runs(self, rows: Sequence[float]) -> Iterator[list[int]]:
        """Yield every item alone, and with what its straight wires reach to the right or left."""
        for start in range(len(self.heights)):
            yield [start]
            for edges, forward in ((self.out_of, True), (self.into, False)):
                run, item = [start], start
                while True:
                    straight = [
                        e.target if forward else e.source
                        for e in edges[item]
                        if rows[e.source] + e.output == rows[e.target] + e.input
                    ]
                    if not straight:
                        break
                    item = straight[0]
                    run.append(item)
                    yield list(run)

    def _free(self, run: Iterable[int], rows: Sequence[float]) -> bool:
        """Return whether items keep their order, and their distance from neighbours."""
        for item in run:
            column = self.columns[self.layer_of[item]]
            index = column.index(item)
            for near in (index - 1, index + 1):
                if 0 <= near < len(column):
                    other = column[near]
                    distance = (
                        rows[other] - rows[item] if near > index else rows[item] - rows[other]
                    )
                    if distance < 0.5 * (self.heights[other] + self.heights[item]):
                        return False
        return True


def _crossings(edges: Iterable[tuple[float, float]]) -> int:
    """Return how many edges from one layer to the next cross; those of one pin do not."""
    count = 0
    ends: list[float] = []
    waiting: list[float] = []
    start: float | None = None
    for a, b in sorted(edges):
        if a != start:
            for end in waiting:
                insort(ends, end)
            waiting, start = [], a
        count += len(ends) - bisect_right(ends, b)
        waiting.append(b)
    return count


# --- Tracks ---


@dataclass(eq=False)
class _Trunk:
    """A wire in a gap: the row in which it comes, and those in which it goes on.

    Where two wires change places, one of them goes by a row of its own between two trunks.
    """

    source: float
    targets: list[float]
    track: int = 0
    behind: _Trunk | None = None

    @property
    def span(self) -> tuple[float, float]:
        return min(self.source, *self.targets), max(self.source, *self.targets)

    @property
    def bent(self) -> bool:
        return any(target != self.source for target in self.targets)

    def corners(self, gap: int, row: float) -> Iterator[Corner]:
        """Yield where a wire that goes on in a row changes it."""
        if self.behind is None:
            yield Corner(gap, self.track, row)
        else:
            yield Corner(gap, self.track, self.behind.source)
            yield from self.behind.corners(gap, row)


def _tracks(net: _Net, rows: Sequence[float]) -> tuple[list[int], list[tuple[Corner, ...]]]:
    """Return how many tracks each gap has, and the corners of each link."""
    trunks: dict[tuple[int, int, int], _Trunk] = {}  # by source, output and gap
    ways: list[list[tuple[int, float, float]]] = []
    for link in net.links:
        source, target = link.source, link.target
        row = rows[source] + pin(link.output, net.blocks[source].outputs)
        way = []
        for gap in range(net.layer_of[source], net.layer_of[target]):
            if gap + 1 == net.layer_of[target]:
                following = rows[target] + pin(link.input, net.blocks[target].inputs)
            else:
                following = rows[net.passing[source, link.output, gap + 1]]
            way.append((gap, row, following))
            trunk = trunks.setdefault((source, link.output, gap), _Trunk(row, []))
            trunk.targets.append(following)
            row = following
        ways.append(way)
    counts = [0] * len(net.columns)
    for gap in range(len(counts)):
        trunks_here = [trunk for (_, _, at), trunk in trunks.items() if at == gap]
        counts[gap] = _assign(trunks_here)
    paths = []
    for link, way in zip(net.links, ways, strict=True):
        corners: list[Corner] = []
        for gap, row, following in way:
            if row != following:
                corners += trunks[link.source, link.output, gap].corners(gap, following)
        paths.append(tuple(corners))
    return counts, paths


def _assign(trunks: Sequence[_Trunk]) -> int:
    """Give the trunks of a gap tracks, so that none lies on another; return how many tracks."""

    # Of those that go down the lower stand to the left, of those that go up the upper: so the
    # fewest cross.
    def rank(trunk: _Trunk) -> tuple[float, float]:
        down = sum(trunk.targets) / len(trunk.targets) > trunk.source
        return (-trunk.source if down else trunk.source), trunk.span[0]

    rows = {row for trunk in trunks for row in (trunk.source, *trunk.targets)}
    waiting = sorted((trunk for trunk in trunks if trunk.bent), key=rank)
    settled: list[_Trunk] = []
    while waiting:
        # One that ends in the row in which another comes stands to the right of that one.
        free = [t for t in waiting if not any(_left_of(other, t) for other in waiting)]
        if not free:
            trunk = waiting[0]
            trunk.behind = _Trunk(_free_row(trunk, rows), trunk.targets)
            trunk.targets = [trunk.behind.source]
            waiting.append(trunk.behind)
            continue
        trunk = free[0]
        waiting.remove(trunk)
        first = max((o.track + 1 for o in settled if _left_of(o, trunk)), default=0)
        tracks = {o.track for o in settled if _overlap(o.span, trunk.span)}
        trunk.track = next(t for t in range(first, len(rows) ** 2 + 2) if t not in tracks)
        settled.append(trunk)
    return max((trunk.track + 1 for trunk in settled), default=0)


def _left_of(first: _Trunk, second: _Trunk) -> bool:
    """Return whether one has to stand to the left of another."""
    if first.behind is second:
        return True
    return first is not second and second.behind is not first and first.source in second.targets


def _free_row(trunk: _Trunk, rows: set[float]) -> float:
    """Take a row near that in which a wire comes, towards where it goes, that no other has."""
    way = 1.0 if max(trunk.targets) > trunk.source else -1.0
    step = 0.5
    while trunk.source + way * step in rows:
        step *= 0.5
    rows.add(trunk.source + way * step)
    return trunk.source + way * step


def _overlap(first: tuple[float, float], second: tuple[float, float]) -> bool:
    return first[0] <= second[1] and second[0] <= first[1]
