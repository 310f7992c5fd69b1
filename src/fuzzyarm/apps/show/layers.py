"""Layout of block diagrams: layers, rows and tracks.

A layer is a column of blocks; the sources of a block are in layers to its left. Rows are counted
from 0 downwards; blocks and the wires passing between them are at least one row apart. A wire may
change its row between two layers, on a track of the gap, and no two wires overlap. The layout knows
nothing of the meaning of blocks.

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
"""Passes over the layers, to and fro; the best result is kept."""

LARGE = 400
"""Number of items from which on fewer passes are made, to keep any diagram fast."""


Cost = tuple[int, float]
"""Number of crossings, and length and number of row changes."""


class Pins(NamedTuple):
    """A block in the layout.

    Attributes
    ----------
    inputs, outputs : int
        Number of wires at its inputs and outputs.
    place : str
        ``first`` or ``last`` for a block at the edge, ``late`` for one as near as possible to its
        reader, else empty.
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
    """A change of row.

    Attributes
    ----------
    gap : int
        Gap behind this layer.
    track : int
        Track in the gap, from the left.
    row : float
        The row from there on.
    """

    gap: int
    track: int
    row: float


class LayeredGraph(NamedTuple):
    """The result of :func:`lay_out`.

    Attributes
    ----------
    layers : list of int
        Layer of each block.
    rows : list of float
        Middle of each block, in halves.
    paths : list of tuple of Corner
        Corners of each link.
    tracks : list of int
        Number of tracks in the gap behind each layer.
    height : float
        Number of rows.
    """

    layers: list[int]
    rows: list[float]
    paths: list[tuple[Corner, ...]]
    tracks: list[int]
    height: float


def pin(index: int, count: int) -> float:
    """Return the distance of a pin below the middle of its block, in rows."""
    return index - 0.5 * (count - 1)


def lay_out(blocks: Sequence[Pins], links: Sequence[Link]) -> LayeredGraph:
    """Find layers and rows of blocks, and the paths of the wires."""
    layers = _layers(blocks, links)
    net = _Net(blocks, links, layers)
    rows = net.arranged()
    tracks, paths = _tracks(net, rows)
    values = [rows[index] for index in range(len(blocks))]
    height = max((rows[i] + 0.5 * net.heights[i] + 0.5 for i in range(len(rows))), default=0.0)
    return LayeredGraph(layers, values, paths, tracks, height)


# --- Layers ---


def _layers(blocks: Sequence[Pins], links: Sequence[Link]) -> list[int]:
    """Return the layer of each block: after all its sources."""
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
    """From one layer to the next: items, and the distance of their pins from their middles."""

    source: int
    output: float
    target: int
    input: float


class _Net:
    """Blocks, and an item for each layer that a wire passes."""

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
        """Return the rows at which the wires of an item would be straight."""
        if forward:
            return [rows[e.source] + e.output - e.input for e in self.into[item]]
        return [rows[e.target] + e.input - e.output for e in self.out_of[item]]

    def _settle(self, column: list[int], rows: list[float], *, forward: bool, sort: bool) -> None:
        """Move the items of a layer towards their neighbours in the layer before or after."""
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
        """Assign rows to the items of a layer in order, as near as possible to their aims."""
        offset, offsets = 0.0, []
        for before, item in pairwise((None, *column)):
            if before is not None and item is not None:
                offset += 0.5 * (self.heights[before] + self.heights[item])
            offsets.append(offset)
        # Pool adjacent violators: overlapping items share the mean of their aims.
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
        """Return the number of crossings, and length and number of row changes."""
        gaps: dict[int, list[tuple[float, float]]] = defaultdict(list)
        length = 0.0
        for edge in self.edges:
            a, b = rows[edge.source] + edge.output, rows[edge.target] + edge.input
            gaps[self.layer_of[edge.source]].append((a, b))
            length += abs(a - b) + (a != b)
        return sum(map(_crossings, gaps.values())), length

    def _straightened(self, rows: list[float]) -> list[float]:
        """Move items, runs in one row, and pairs of neighbours while that improves the cost."""
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
        """Straighten a wire of the items by moving them, if that improves the cost."""
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
        """Swap two neighbours of a layer, if that improves the cost."""
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
        """Yield every item alone, and with those along its straight wires to the right or left."""
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
        """Return whether items keep their order and distance from neighbours."""
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
    """Return the number of crossings between two layers; edges of one pin never cross."""
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
    """A wire in a gap: its row on the left, and its rows on the right."""

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
        """Yield the corners of a wire on its way to a row."""
        if self.behind is None:
            yield Corner(gap, self.track, row)
        else:
            yield Corner(gap, self.track, self.behind.source)
            yield from self.behind.corners(gap, row)


def _tracks(net: _Net, rows: Sequence[float]) -> tuple[list[int], list[tuple[Corner, ...]]]:
    """Return the number of tracks of each gap, and the corners of each link."""
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
    """Assign tracks to the trunks of a gap without overlaps; return the number of tracks."""

    # Fewest crossings: among those going down the lower is on the left, among those going up the
    # upper.
    def rank(trunk: _Trunk) -> tuple[float, float]:
        down = sum(trunk.targets) / len(trunk.targets) > trunk.source
        return (-trunk.source if down else trunk.source), trunk.span[0]

    rows = {row for trunk in trunks for row in (trunk.source, *trunk.targets)}
    waiting = sorted((trunk for trunk in trunks if trunk.bent), key=rank)
    settled: list[_Trunk] = []
    while waiting:
        # A trunk that ends in the row where another begins is on the right of it.
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
    """Return whether one must be to the left of another."""
    if first.behind is second:
        return True
    return first is not second and second.behind is not first and first.source in second.targets


def _free_row(trunk: _Trunk, rows: set[float]) -> float:
    """Reserve a free row near the beginning of a wire, towards its end."""
    way = 1.0 if max(trunk.targets) > trunk.source else -1.0
    step = 0.5
    while trunk.source + way * step in rows:
        step *= 0.5
    rows.add(trunk.source + way * step)
    return trunk.source + way * step


def _overlap(first: tuple[float, float], second: tuple[float, float]) -> bool:
    return first[0] <= second[1] and second[0] <= first[1]
