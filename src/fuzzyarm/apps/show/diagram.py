"""The block diagram of a controller or a rule base as data: blocks, wires between pins, positions.

Drawn as a figure in :mod:`fuzzyarm.apps.show.figures.diagram`; a page or another program draws the
same record. Order and meaning of the lines come from the model.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

from fuzzyarm.apps.show.drawing import number_words
from fuzzyarm.apps.show.layers import Corner, LayeredGraph, Link, Pins, lay_out
from fuzzyarm.base.diagnostic import NOWHERE, Span
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.numbers import TIMES, counted, number_text
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.language.model.controller import (
    Amount,
    Axes,
    AxisSignal,
    ControllerModel,
    Drive,
    Factor,
    GainModel,
    Learn,
    Product,
    SignalLine,
    Source,
    Zoom,
)
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.language.signals import chosen_text, condition_text, number_or_name
from fuzzyarm.symbolic.sources import CHOICE, SOURCES, Chosen

BLOCK_KINDS = {
    "port": "a reference or a measured value of the plant",
    "difference": "reference minus measured value",
    "gain": "a gain, a number, or several in a row",
    "plus": "a sum, with signs at its pins",
    "times": "a product, with / at the pin of a divisor",
    "constant": "a constant",
    **{word: kind.doc for word, kind in SOURCES.items() if kind.function is not None},
    CHOICE.name: CHOICE.doc,
    "rules": "a rule base",
    "table": "a lookup table",
    "zoom": "signals magnified while all are small",
    "learn": "the learning rule of a table",
    "partner": "a law of the catalogue",
    "limit": "limits",
    "slew": "the largest change per second",
    "drive": "an input of the plant",
    "input": "an input of a rule base",
    "output": "an output of a rule base",
}
"""Kinds of blocks."""


@json_properties("* line=span.line")
@dataclass(frozen=True, slots=True)
class DiagramBlock:
    """A block.

    Attributes
    ----------
    kind : str
        Its function, a key of :data:`BLOCK_KINDS`.
    label : str
        The text in it: the name of the gain, of the rule base, of the port.
    details : tuple of str
        Lines below: the value of a gain, the file of a rule base, the limits.
    axes : tuple of str
        Axes of the plant with a block like this, each its own.
    inputs, outputs : tuple of str
        Label of each pin from top to bottom: the sign of a sum, the input of a rule base; empty if
        obvious.
    span : Span
        Its line in the text.
    layer : int
        Its column, from the left.
    row : float
        Its middle, downwards, in halves; the first row is 0.
    """

    kind: str
    label: str
    details: tuple[str, ...]
    axes: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    layer: int = 0
    row: float = 0.0

    @property
    def height(self) -> int:
        """Number of rows."""
        return max(1, len(self.inputs), len(self.outputs))

    def input_row(self, index: int) -> float:
        """Return the row of an input."""
        return self.row + index - 0.5 * (len(self.inputs) - 1)

    def output_row(self, index: int) -> float:
        """Return the row of an output."""
        return self.row + index - 0.5 * (len(self.outputs) - 1)


@dataclass(frozen=True, slots=True)
class DiagramWire:
    """A wire.

    Attributes
    ----------
    source : int
        Index of the first block.
    output : int
        Index of its output.
    target : int
        Index of the last block.
    input : int
        Index of its input.
    signal : str
        Name in the text; empty between blocks of one line.
    path : tuple of Corner
        Changes of row: gap, track and new row of each.
    """

    source: int
    output: int
    target: int
    input: int
    signal: str
    path: tuple[Corner, ...] = ()


@dataclass(frozen=True, slots=True)
class Diagram:
    """The block diagram of a controller or a rule base.

    Attributes
    ----------
    name, description : str
        Of the controller or the rule base.
    period : str
        Period, or number of rules, in words.
    blocks : tuple of DiagramBlock
        Those of all axes.
    wires : tuple of DiagramWire
        Between the blocks.
    groups : tuple of (tuple of str, float, float)
        Axes with common lines, with the first and last row of their part.
    tracks : tuple of int
        Number of tracks in the gap behind each layer.
    height : float
        Number of rows.
    """

    name: str
    description: str
    period: str
    blocks: tuple[DiagramBlock, ...]
    wires: tuple[DiagramWire, ...]
    groups: tuple[tuple[tuple[str, ...], float, float], ...]
    tracks: tuple[int, ...]
    height: float


def block_diagram(controller: ControllerText | ControllerModel) -> Diagram:
    """Return the block diagram of a controller.

    Parameters
    ----------
    controller : ControllerText or ControllerModel
        With its files, if blocks are to show the number of rules.

    Returns
    -------
    Diagram
        Ports of the plant on the left, drives on the right; a part for each ``axis`` line, one
        below the other.
    """
    if isinstance(controller, ControllerText):
        model, sheets = controller.model, controller.sheets
    else:
        model, sheets = (
            controller,
            {rulebase.name: (rulebase,) for rulebase in controller.rulebases},
        )
    counts = {
        name: len(sheet_list[0].rules)
        for name, sheet_list in sheets.items()
        if sheet_list and isinstance(sheet_list[0], RuleBase)
    }
    blocks: list[DiagramBlock] = []
    wires: list[DiagramWire] = []
    groups: list[tuple[tuple[str, ...], float, float]] = []
    tracks: list[int] = []
    top = 0.0
    for axes in model.axes:
        part = _DiagramPart(model, axes, counts)
        # Parts are laid out independently: each appends its blocks, and its rows below the others.
        laid, layout = laid_out(part.blocks, part.wires, len(blocks), top)
        blocks += laid[0]
        wires += laid[1]
        tracks += [0] * (len(layout.tracks) - len(tracks))
        tracks = [max(*pair) for pair in zip(tracks, _padded(layout.tracks, tracks), strict=True)]
        groups.append((axes.names, top, top + layout.height))
        top += layout.height
    return Diagram(
        model.name,
        model.description,
        f"every {time_text(model.period)}",
        tuple(blocks),
        tuple(wires),
        tuple(groups),
        tuple(tracks),
        top,
    )


def laid_out(
    blocks: Sequence[DiagramBlock], wires: Sequence[DiagramWire], first: int = 0, top: float = 0.0
) -> tuple[tuple[list[DiagramBlock], list[DiagramWire]], LayeredGraph]:
    """Return blocks and wires with positions; `first` blocks and rows to `top` precede them."""
    pins = [Pins(len(b.inputs), len(b.outputs), _place(b)) for b in blocks]
    layout = lay_out(pins, [Link(w.source, w.output, w.target, w.input) for w in wires])
    placed = [
        replace(block, layer=layer, row=row + top)
        for block, layer, row in zip(blocks, layout.layers, layout.rows, strict=True)
    ]
    routed = [
        replace(
            wire,
            source=wire.source + first,
            target=wire.target + first,
            path=tuple(corner._replace(row=corner.row + top) for corner in path),
        )
        for wire, path in zip(wires, layout.paths, strict=True)
    ]
    return (placed, routed), layout


def _padded(numbers: Sequence[int], like: Sequence[int]) -> list[int]:
    return [*numbers, *[0] * (len(like) - len(numbers))]


def _place(block: DiagramBlock) -> str:
    if block.kind in ("drive", "output"):
        return "last"
    return "late" if block.kind in ("partner", "constant") else ""


FROM = {"h": 7200.0, "min": 600.0, "s": 0.1, "ms": 1e-4, "us": 0.0}
"""Shortest time in seconds for each unit."""


def time_text(seconds: float) -> str:
    """Return a time in a suitable unit: ``0.6 ms``, ``60 s``."""
    unit = next(unit for unit, least in FROM.items() if not seconds < least)
    many, of = TIMES[unit]
    return f"{number_words(seconds * of / many, 12)} {unit}"


# --- The lines of an axis as blocks and wires ---

Pin = tuple[int, int, str]
"""A block, the index of an output, and the name of its signal, perhaps empty."""


class _DiagramPart:
    """The blocks and wires of axes with common lines, without positions."""

    def __init__(self, model: ControllerModel, axes: Axes, counts: dict[str, int]) -> None:
        self.axes = axes.names
        self.gains = {gain.name: gain for gain in model.gains}
        self.partners = {partner.name: partner for partner in model.partners}
        self.files = {use.name: use.files for use in model.uses}
        self.counts = counts
        self.blocks: list[DiagramBlock] = []
        self.wires: list[DiagramWire] = []
        self.signals: dict[str, Pin] = {}
        self.shared: dict[tuple[object, ...], Pin] = {}  # ports and their differences
        self.driving: dict[str, list[tuple[Pin, Span]]] = {}
        self.teachers: dict[str, list[Pin]] = {}
        for line in axes.lines:
            if isinstance(line, SignalLine):
                self._signal(line)
            elif isinstance(line, Zoom):
                self._zoom(line)
            elif isinstance(line, Learn):
                self._learn(line)
            else:
                self._drive(line)
        self._ports_of_drives()
        for axis in axes.names:
            for name in model.seen_elsewhere(axis):
                self._block("drive", f"{axis}.{name}", sources=[(self.signals[name], "")],
                            outputs=())  # fmt: skip

    # Blocks

    def _block(
        self,
        kind: str,
        label: str,
        details: Iterable[str] = (),
        sources: Sequence[tuple[Pin, str]] = (),
        outputs: Sequence[str] = ("",),
        span: Span = NOWHERE,
    ) -> int:
        """Add a block with its input wires; return its index."""
        index = len(self.blocks)
        words = tuple(word for _, word in sources)
        self.blocks.append(
            DiagramBlock(kind, label, tuple(details), self.axes, words, tuple(outputs), span)
        )
        for at, ((source, output, name), _) in enumerate(sources):
            self.wires.append(DiagramWire(source, output, index, at, name))
        return index

    def _port(self, kind: str, port: str, span: Span) -> Pin:
        if (kind, port) not in self.shared:
            label = f"{kind} {port}".lstrip()
            self.shared[kind, port] = (self._block("port", label, span=span), 0, "")
        return self.shared[kind, port]

    def _error(self, port: str, weight: object, span: Span) -> Pin:
        """Return the difference at a port, shared by its lines."""
        key = ("error", port, weight)
        if key not in self.shared:
            reference = self._port("reference", port, span)
            if isinstance(weight, str | float):
                reference = self._gain([Factor(weight)], reference, span)
            sources = ((reference, "+"), (self._port("measured", port, span), "-"))
            self.shared[key] = (self._block("difference", "", sources=sources, span=span), 0, "")
        return self.shared[key]

    def _gain(self, factors: Sequence[Factor], source: Pin, span: Span) -> Pin:
        """Return the output of a gain; consecutive numbers are merged."""
        label, details = "", []
        for factor in factors:
            word = factor.value if isinstance(factor.value, str) else number_text(factor.value)
            if label:
                label += f" / {word}" if factor.divides else f" * {word}"
            else:
                label = f"1 / {word}" if factor.divides else word
            gain = self.gains.get(factor.value) if isinstance(factor.value, str) else None
            if gain is not None:
                value = gain_words(gain)
                details.append(value if len(factors) == 1 else f"{gain.name} = {value}")
        return self._block("gain", label, details, [(source, "")], span=span), 0, ""

    # Lines

    def _signal(self, line: SignalLine) -> None:
        if line.source is None:
            pins = [self._sum(line.products, line.span)]
        else:
            (product,) = line.products
            pins = [
                self._product(product.factors, pin, line.span)
                for pin in self._source(line.source, line)
            ]
        for name, (block, output, _) in zip(line.names, pins, strict=False):
            self.signals[name] = (block, output, name)

    def _source(self, source: Source, line: SignalLine) -> list[Pin]:
        record, kind, name = source.record, source.kind, source.name
        if record.of != "call":
            if len(record.ports) > 1:
                pin = self._error(name, source.option("weight"), line.span)
            else:
                pin = self._port(kind, name, line.span) if record.ports else self._read(name)
            if record.function is None:
                return [pin]
            details = option_words(source)
            signals = [name for name in source.chosen_names() if name in self.signals]
            pins = [(pin, ""), *((self._read(name), "") for name in dict.fromkeys(signals))]
            return [(self._block(kind, kind, details, pins, span=line.span), 0, "")]
        sources = [(self._read(variable), "") for variable in source.inputs]
        sources += [(pin, "learn") for pin in self.teachers.get(name, ())]
        outputs = line.names if len(line.names) > 1 else ("",)
        index = self._block(kind, name, self._sheet(name), sources, outputs, line.span)
        return [(index, output, "") for output in range(len(outputs))]

    def _sheet(self, name: str) -> list[str]:
        """Return the description of a rule base or a table: its files and its size."""
        words = []
        if name in self.counts:
            count = self.counts[name]
            words.append(counted(count, "rule"))
        files = self.files.get(name, ())
        if files == ("zero",):
            return [*words, "begins at zero"]
        return [*words, *files]

    def _read(self, name: str) -> Pin:
        """Return a signal; in a text with mistakes, perhaps one without a source."""
        if name in self.signals:
            return self.signals[name]
        if isinstance(name, AxisSignal):
            return self._port("", name, name.span)
        if name in self.partners:
            partner = self.partners[name]
            index = self._block("partner", partner.law, [f"partner {name}"], span=partner.span)
            return index, 0, ""
        return self._block("constant", name), 0, ""

    def _sum(self, products: Sequence[Product], span: Span) -> Pin:
        pins = [self._product(product.factors, None, span) for product in products]
        signs = ["-" if product.negative else "+" for product in products]
        if len(pins) == 1:
            return pins[0] if signs[0] == "+" else self._gain([Factor(-1.0)], pins[0], span)
        sources = list(zip(pins, signs, strict=True))
        return self._block("plus", "", sources=sources, span=span), 0, ""

    def _product(self, factors: Sequence[Factor], first: Pin | None, span: Span) -> Pin:
        """Return a product: first of the signals, then by the gains."""
        signals = [] if first is None else [(first, "*")]
        numbers = []
        for factor in factors:
            if isinstance(factor.value, float) or factor.value in self.gains:
                numbers.append(factor)
            else:
                signals.append((self._read(factor.value), "/" if factor.divides else "*"))
        if not signals:
            label, details = _constant(numbers, self.gains)
            return self._block("constant", label, details, span=span), 0, ""
        pin = signals[0][0]
        if len(signals) > 1 or signals[0][1] == "/":
            pin = (self._block("times", "", sources=signals, span=span), 0, "")
        return self._gain(numbers, pin, span) if numbers else pin

    def _zoom(self, line: Zoom) -> None:
        by, inside = (self._number(value) for value in (line.by, line.inside))
        details = [f"by {by}", f"inside {inside}", *(["edge wait"] if line.wait else [])]
        sources = [(self._read(name), "") for name in line.signals]
        index = self._block("zoom", "zoom", details, sources, [""] * len(sources), line.span)
        for output, name in enumerate(line.signals):
            self.signals[name] = (index, output, name)

    def _learn(self, line: Learn) -> None:
        sources = [(self._read(name), "") for name in line.inputs]
        details = [
            f"by {line.judge}",
            f"delay {line.delay}",
            f"rate {self._number(line.rate)}",
            f"bound {self._number(line.bound)}",
        ]
        index = self._block("learn", f"learn {line.table}", details, sources, [""], line.span)
        self.teachers.setdefault(line.table, []).append((index, 0, ""))

    def _number(self, value: str | float) -> str:
        """Return a number, or the name of a gain with its value."""
        if isinstance(value, float | int):
            return number_text(value)
        return f"{value} = {gain_words(self.gains[value])}" if value in self.gains else value

    def _drive(self, line: Drive) -> None:
        pin = self._sum(line.products, line.span)
        if line.within is not None:
            low, high = (number_text(end) for end in line.within)
            limit = self._block("limit", "limit", [f"{low} .. {high}"], [(pin, "")], span=line.span)
            pin = (limit, 0, "")
        if line.slew is not None:
            details = [f"{number_text(line.slew)} per s"]
            pin = (self._block("slew", "slew", details, [(pin, "")], span=line.span), 0, "")
        self.driving.setdefault(line.port, []).append((pin, line.span))

    def _ports_of_drives(self) -> None:
        for port, pins in self.driving.items():
            (pin, span), *others = pins
            if others:
                sources = [(source, "+") for source, _ in pins]
                pin = (self._block("plus", "", sources=sources, span=span), 0, "")
            self._block("drive", f"drive {port}", sources=[(pin, "")], outputs=(), span=span)


# --- Words ---


def gain_words(gain: GainModel) -> str:
    """Return the value of a gain, one or one for each axis, with its unit."""
    values = ", ".join(_amount_text(value) for value in gain.values)
    return f"{values} {gain.unit}" if gain.unit else values


def _amount_text(amount: Amount) -> str:
    text = ""
    for number, divides in amount.factors:
        text += ("/" if divides else "*") if text else ""
        text += "π" if number is None else number_text(number)
    return text


def _constant(factors: Sequence[Factor], gains: dict[str, GainModel]) -> tuple[str, list[str]]:
    """Return the label and details of a constant block."""
    label, details = "", []
    for factor in factors:
        word = factor.value if isinstance(factor.value, str) else number_text(factor.value)
        if label:
            label += " / " if factor.divides else " * "
        label += word
        if isinstance(factor.value, str) and factor.value in gains:
            details.append(gain_words(gains[factor.value]))
    return label, details


def option_words(source: Source) -> list[str]:
    """Return the options of a source in language syntax."""
    words = []
    kinds = source.record.options
    for word, value in source.options:
        if isinstance(value, Chosen) and source.kind == CHOICE.name:
            words += [condition_text(value.condition), f"else {number_or_name(value.value)}"]
        elif isinstance(value, Chosen):
            words.append(f"{word} {chosen_text(value)}")
        elif isinstance(value, tuple):
            words.append(f"{word} {number_text(value[0])} .. {number_text(value[1])}")
        elif value is True:
            words.append(" ".join((word, *kinds[word].rest)))
        elif kinds[word].accepts == "windup" and isinstance(value, float):
            words.append(f"{word} back {time_text(value)}")
        elif kinds[word].accepts == "time" and isinstance(value, float):
            words.append(f"{word} {time_text(value)}")
        else:
            words.append(f"{word} {value if isinstance(value, str) else number_text(value)}")
    return words
