"""Diagram layout in lengths: boxes, polylines and fitting words.

The caller provides text sizes and margins in its own unit (:class:`Pen`); the result has no cut-off
or overlapping parts.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

from fuzzyarm.apps.show.diagram import Diagram, DiagramBlock, DiagramWire

Point = tuple[float, float]

ROUND = ("difference", "plus", "times")
"""Blocks without text but that at their pins."""


@dataclass(frozen=True)
class Pen:
    """Sizes for drawing, all in one unit.

    Attributes
    ----------
    width_of : callable
        Width of a text by style (``label``, ``detail``, ``signal``, ``head``).
    line : float
        Height of a line of text.
    pad : float
        Margin between a text and the edge of its block.
    room : float
        Greatest width of text in a block, before it is wrapped.
    track : float
        Distance of parallel wires.
    arrow : float
        Length for the end of a wire.
    """

    width_of: Callable[[str, str], float]
    line: float
    pad: float
    room: float
    track: float
    arrow: float


class PlacedBlock(NamedTuple):
    """A block: its upper left corner, its size, its lines of text with styles."""

    block: DiagramBlock
    x: float
    y: float
    width: float
    height: float
    lines: tuple[tuple[str, str], ...]

    def pins(self, pitch: float) -> Iterator[tuple[str, float, float]]:
        """Yield label, x and y of each input; `pitch` is the distance of rows."""
        middle = self.y + 0.5 * self.height
        count = len(self.block.inputs)
        for index, word in enumerate(self.block.inputs):
            yield word, self.x, middle + pitch * (index - 0.5 * (count - 1))


class PlacedWord(NamedTuple):
    """A text: its left end, its baseline or middle, its style."""

    text: str
    x: float
    y: float
    style: str


@dataclass(frozen=True)
class Picture:
    """A diagram in lengths; x to the right, y downwards.

    Attributes
    ----------
    width, height : float
        Total size.
    pitch : float
        Distance of rows.
    blocks : list of PlacedBlock
        In the order of the diagram.
    wires : list of (DiagramWire, list of (float, float))
        Polylines; the last point touches the block.
    strokes : list of ((float, float), (float, float))
        The straight pieces of all wires, common ones only once.
    dots : list of (float, float)
        Branches of wires.
    words : list of PlacedWord
        Names of signals, with `y` at the baseline, and headings of axes.
    """

    width: float
    height: float
    pitch: float
    blocks: list[PlacedBlock]
    wires: list[tuple[DiagramWire, list[Point]]]
    strokes: list[tuple[Point, Point]]
    dots: list[Point]
    words: list[PlacedWord]


def place(diagram: Diagram, pen: Pen) -> Picture:
    """Assign lengths to a diagram."""
    return _Placing(diagram, pen).picture()


class _Placing:
    """Columns and rows of one diagram."""

    def __init__(self, diagram: Diagram, pen: Pen) -> None:
        self.diagram, self.pen = diagram, pen
        self.lines = [tuple(self._lines(block)) for block in diagram.blocks]
        self.pitch = 3.0 * pen.line
        for block, lines in zip(diagram.blocks, self.lines, strict=True):
            least_height = len(lines) * pen.line + 2.0 * pen.pad + 0.8 * pen.line
            # The block with most text for its rows determines the height of all rows.
            self.pitch = max(self.pitch, least_height / block.height)
        self.names = _names_of_nets(diagram)
        self.left: list[float] = []
        self.width: list[float] = []
        self.first_track: list[float] = []
        x = 0.0
        for layer, tracks in enumerate(diagram.tracks):
            widths = [
                self._block_width(k)
                for k, block in enumerate(diagram.blocks)
                if block.layer == layer
            ]
            names = [
                pen.width_of(name, "signal") + pen.pad
                for (source, _), name in self.names.items()
                if diagram.blocks[source].layer == layer
            ]
            self.left.append(x)
            self.width.append(max(widths, default=0.0))
            x += self.width[-1] + max(names, default=0.0) + pen.pad
            self.first_track.append(x)
            x += max(0, tracks - 1) * pen.track + pen.arrow
        self.total = x - pen.arrow - pen.pad if diagram.tracks else 0.0
        heads = [pen.width_of(_head(names), "head") for names, _, _ in diagram.groups]
        self.total = max([self.total, *heads])

    def _lines(self, block: DiagramBlock) -> Iterator[tuple[str, str]]:
        if block.kind in ROUND:
            return
        for style, texts in (("label", (block.label,)), ("detail", block.details)):
            for text in texts:
                yield from ((line, style) for line in self._broken(text, style))

    def _broken(self, text: str, style: str) -> list[str]:
        """Wrap a text at its blanks to about the available width; words are never cut."""
        lines: list[str] = []
        # A number stays beside its name.
        for word in text.replace(" = ", "\0=\0").split(" "):
            longer = f"{lines[-1]} {word}" if lines else word
            if lines and self.pen.width_of(_whole(longer), style) <= self.pen.room:
                lines[-1] = longer
            else:
                lines.append(word)
        return [_whole(line) for line in lines]

    def _block_width(self, index: int) -> float:
        block, lines = self.diagram.blocks[index], self.lines[index]
        if block.kind in ROUND:
            return 1.7 * self.pen.line
        inner = max(self.pen.width_of(text, style) for text, style in lines)
        # The tip of a gain has no room for text.
        return inner + 2.0 * self.pen.pad + (self.pen.pad * 2.0 if block.kind == "gain" else 0.0)

    def y(self, row: float) -> float:
        """Return the y of a row, below the heading of its part."""
        heads = sum(1 for _, top, _ in self.diagram.groups if row >= top)
        return heads * 1.6 * self.pen.line + (row + 0.5) * self.pitch

    def picture(self) -> Picture:
        blocks = list(self._blocks())
        wires = [(wire, self._points(wire, blocks)) for wire in self.diagram.wires]
        words = [
            PlacedWord(
                _head(names), 0.0, self.y(top) - 0.5 * self.pitch - 0.4 * self.pen.line, "head"
            )
            for names, top, _ in self.diagram.groups
        ]
        for (source, output), name in self.names.items():
            box = blocks[source]
            y = self.y(self.diagram.blocks[source].output_row(output))
            x = box.x + box.width + 0.6 * self.pen.pad
            words.append(PlacedWord(name, x, y - 0.25 * self.pen.line, "signal"))
        height = self.y(self.diagram.height - 0.5)
        strokes, dots = _drawn_once(wires)
        return Picture(self.total, height, self.pitch, blocks, wires, strokes, dots, words)

    def _blocks(self) -> Iterator[PlacedBlock]:
        for index, block in enumerate(self.diagram.blocks):
            lines, width = self.lines[index], self._block_width(index)
            pins = max(len(block.inputs), len(block.outputs), 1)
            height = (pins - 1) * self.pitch + 1.7 * self.pen.line
            height = max(height, len(lines) * self.pen.line + 2.0 * self.pen.pad)
            if block.kind in ("port", "drive", "input", "output"):
                width = self.width[block.layer]
            x = self.left[block.layer] + 0.5 * (self.width[block.layer] - width)
            yield PlacedBlock(block, x, self.y(block.row) - 0.5 * height, width, height, lines)

    def _points(self, wire: DiagramWire, blocks: Sequence[PlacedBlock]) -> list[Point]:
        source, target = blocks[wire.source], blocks[wire.target]
        y = self.y(source.block.output_row(wire.output))
        points = [(source.x + source.width, y)]
        for corner in wire.path:
            x = self.first_track[corner.gap] + corner.track * self.pen.track
            points.append((x, y))
            y = self.y(corner.row)
            points.append((x, y))
        points.append((target.x, y))
        return points


def _head(axes: Sequence[str]) -> str:
    return f"axis {', '.join(axes)}"


def _names_of_nets(diagram: Diagram) -> dict[tuple[int, int], str]:
    """Return the name of each block output, if named in the text."""
    names: dict[tuple[int, int], dict[str, None]] = defaultdict(dict)
    for wire in diagram.wires:
        if wire.signal:
            names[wire.source, wire.output][wire.signal] = None
    return {net: " = ".join(names_of_net) for net, names_of_net in names.items()}


def _whole(text: str) -> str:
    return text.replace("\0", " ")


def _drawn_once(
    wires: Sequence[tuple[DiagramWire, list[Point]]],
) -> tuple[list[tuple[Point, Point]], list[Point]]:
    """Return the pieces of wires, merged for each output, and their branches."""
    nets: dict[tuple[int, int], list[list[Point]]] = defaultdict(list)
    for wire, points in wires:
        nets[wire.source, wire.output].append(points)
    strokes: list[tuple[Point, Point]] = []
    dots: list[Point] = []
    for lines in nets.values():
        pieces = [pair for points in lines for pair in pairwise(points)]
        strokes += _joined(pieces)
        corners = dict.fromkeys(point for points in lines for point in points[1:-1])
        dots += (
            point
            for point in corners
            # A dot where three or four directions meet; a corner has two.
            if len({way for piece in pieces for way in _ways(point, piece)}) > 2
        )
    return strokes, dots


def _joined(pieces: Sequence[tuple[Point, Point]]) -> list[tuple[Point, Point]]:
    """Return pieces without overlapping ones."""
    along: dict[tuple[bool, float], list[tuple[float, float]]] = defaultdict(list)
    for (a, b), (c, d) in pieces:
        if b == d:
            along[True, b].append((min(a, c), max(a, c)))
        else:
            along[False, a].append((min(b, d), max(b, d)))
    segments: list[tuple[Point, Point]] = []
    for (level, at), parts in along.items():
        whole: list[tuple[float, float]] = []
        for low, high in sorted(parts):
            if whole and low <= whole[-1][1]:
                whole[-1] = (whole[-1][0], max(high, whole[-1][1]))
            else:
                whole.append((low, high))
        segments += [((a, at), (b, at)) if level else ((at, a), (at, b)) for a, b in whole]
    return segments


def _ways(point: Point, piece: tuple[Point, Point]) -> Iterator[str]:
    """Yield the directions in which a piece of wire leaves a point."""
    (x, y), ((a, b), (c, d)) = point, piece
    if b == d == y and min(a, c) <= x <= max(a, c):
        if min(a, c) < x:
            yield "left"
        if max(a, c) > x:
            yield "right"
    if a == c == x and min(b, d) <= y <= max(b, d):
        if min(b, d) < y:
            yield "up"
        if max(b, d) > y:
            yield "down"
