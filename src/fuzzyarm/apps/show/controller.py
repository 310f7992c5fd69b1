"""A controller in the terminal: its lines with the signal flow, and its files."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fuzzyarm.apps.show.diagram import gain_words, option_words, time_text
from fuzzyarm.base.columns import in_columns
from fuzzyarm.base.numbers import number_text
from fuzzyarm.control.controllers.code import Sheet
from fuzzyarm.control.controllers.findings import site_by_axes
from fuzzyarm.control.controllers.text import ZERO, ControllerText
from fuzzyarm.language.model.controller import (
    Axes,
    ControllerModel,
    Drive,
    Factor,
    GainModel,
    Learn,
    Line,
    Product,
    SignalLine,
    Zoom,
)
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.language.signals import (
    choice_text,
    inputs_text,
    number_or_name,
    operand_text,
    signal_text,
)
from fuzzyarm.language.tokens import name_text
from fuzzyarm.symbolic.sources import CHOICE

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult


def controller_view(controller: ControllerText) -> Group:
    """Return everything about a controller: gains, lines with their signals, rule bases, tables.

    Parameters
    ----------
    controller : ControllerText
        With its files.
    """
    from rich.console import Group
    from rich.text import Text

    model = controller.model
    parts: list[RenderableType] = [_heading(model), Text()]
    if model.gains:
        parts += [Text("gains", "bold"), Text("\n".join(gain_lines(model.gains))), Text()]
    partners = [partner.name for partner in model.partners]
    for axes in model.axes:
        parts += [Text(_axis_words(axes), "bold"), SignalFlow(axes, partners), Text()]
    for title, sheet in _sheets(controller):
        parts.append(Text(title, "bold"))
        if isinstance(sheet, RuleBase):
            from fuzzyarm.apps.show.rulebase import rulebase_view

            parts.append(rulebase_view(sheet))
        else:
            from fuzzyarm.apps.show.table import table_view

            parts.append(table_view(sheet))
        parts.append(Text())
    return Group(*parts[:-1])


def _heading(model: ControllerModel) -> RenderableType:
    from rich.text import Text

    text = Text(model.name, "bold")
    if model.description:
        text.append(f"  {model.description}", "not bold")
    words = [f"every {time_text(model.period)}"]
    if model.every > 1:
        words.append(f"a set point every {model.every} periods")
    site = site_by_axes(model)
    if site is not None:
        words.append(f"for the plant {site.name}")
    text.append(f"\n{', '.join(words)}", "dim")
    return text


def _axis_words(axes: Axes) -> str:
    every = f" every {axes.every}" if axes.every > 1 else ""
    return f"axis {', '.join(map(name_text, axes.names))}{every}"


def _sheets(controller: ControllerText) -> Iterator[tuple[str, Sheet]]:
    """Yield the rule bases and tables of a controller, with their names and files."""
    files = {use.name: use.files for use in controller.model.uses}
    for name, sheets in controller.sheets.items():
        # A table that starts at zero has no file, and nothing to draw.
        if files.get(name) == (ZERO,):
            continue
        for index, sheet in enumerate(sheets):
            kind = "rules" if isinstance(sheet, RuleBase) else "table"
            from_file = f" from {files[name][index]}" if index < len(files.get(name, ())) else ""
            yield f"{kind} {name_text(name)}{from_file}", sheet


def gain_lines(gains: Sequence[GainModel]) -> list[str]:
    """Return a line for each gain: name, value, range of tune."""
    rows = [(name_text(gain.name), gain_words(gain), tune_words(gain)) for gain in gains]
    return in_columns(rows, indent="  ")


def tune_words(gain: GainModel) -> str:
    """Return the tuning range of a gain, empty if it has none."""
    if gain.tune is None:
        return ""
    low, high, log = gain.tune
    return f"tune {number_text(low)} .. {number_text(high)}{' log' if log else ''}"


# --- A line as the language writes it ---


def line_words(line: Line, partners: Collection[str] = ()) -> str:
    """Return a line of an axis in language syntax."""
    if isinstance(line, SignalLine):
        names = ", ".join(map(name_text, line.names))
        return f"{names} = {definition_words(line, partners)}"
    if isinstance(line, Zoom):
        signals = ", ".join(map(signal_text, line.signals))
        wait = ", edge wait" if line.wait else ""
        factor, window = number_or_name(line.by), number_or_name(line.inside)
        return f"zoom {signals} by {factor} inside {window}{wait}"
    if isinstance(line, Learn):
        rate, bound = number_or_name(line.rate), number_or_name(line.bound)
        lesson = f"learn {name_text(line.table)} by {name_text(line.judge)}"
        options = f"delay {line.delay}, rate {rate}, bound {bound}"
        return f"{lesson}{inputs_text(line.inputs)}, {options}"
    return f"drive {name_text(line.port)} = {definition_words(line, partners)}"


def definition_words(line: SignalLine | Drive, partners: Collection[str] = ()) -> str:
    """Return the right-hand side of a signal or a drive."""

    def word(value: str | float) -> str:
        return f"partner {number_or_name(value)}" if value in partners else number_or_name(value)

    if isinstance(line, Drive):
        limits = ""
        if line.within is not None:
            low, high = map(number_text, line.within)
            limits = f", within {low} .. {high}"
        slew = "" if line.slew is None else f", slew {number_text(line.slew)}"
        events = "".join(f", on {event} {number_or_name(value)}" for event, value in line.events)
        return f"{_sum_words(line.products, word)}{limits}{slew}{events}"
    if line.source is None:
        return _sum_words(line.products, word)
    if line.source.kind == CHOICE.name:
        return choice_text(line.source)
    factors = "".join(_factor(factor, word) for factor in line.products[0].factors)
    options = "".join(f", {option}" for option in option_words(line.source))
    return f"{operand_text(line.source)}{factors}{options}"


def _sum_words(products: Sequence[Product], word: Callable[[str | float], str]) -> str:
    text = ""
    for product in products:
        sign = " - " if product.negative else " + "
        if not text:
            sign = "-" if product.negative else ""
        first, *others = product.factors
        text += sign + word(first.value) + "".join(_factor(factor, word) for factor in others)
    return text


def _factor(factor: Factor, word: Callable[[str | float], str]) -> str:
    return f" {'/' if factor.divides else '*'} {word(factor.value)}"


# --- Signal flow ---

UP, DOWN, LEFT, RIGHT = 1, 2, 4, 8

STROKES = {
    UP: "│",
    UP | DOWN: "│",
    UP | RIGHT: "└",
    UP | LEFT: "┘",
    UP | LEFT | RIGHT: "┴",
    UP | DOWN | RIGHT: "├",
    UP | DOWN | LEFT: "┤",
    UP | DOWN | LEFT | RIGHT: "┼",
}
"""Line-drawing characters of lanes, by their continuations and joints."""


@dataclass(frozen=True, slots=True)
class FlowRow:
    """A line of an axis with its lanes.

    Attributes
    ----------
    strokes : str
        Lanes of the signals at this line. A circle is a new signal, a diamond a magnified one; an
        arrow leads to the plant or into a table.
    below : str
        Lanes that continue.
    words : str
        The line.
    """

    strokes: str
    below: str
    words: str


class SignalFlow:
    """The lines of an axis, with a lane for each signal from its definition to its last use.

    Parameters
    ----------
    axes : Axes
        Axes with common lines.
    partners : collection of str
        Names of partners.
    """

    def __init__(self, axes: Axes, partners: Collection[str] = ()) -> None:
        self.rows = flow_rows(axes, partners)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        from rich.text import Text

        for row in self.rows:
            room = max(20, options.max_width - len(row.strokes) - 4)
            first, *others = Text(row.words).wrap(console, room) or [Text()]
            yield Text.assemble("  ", (row.strokes, "cyan"), "  ", first)
            for other in others:
                yield Text.assemble("  ", (row.below, "cyan"), "    ", other)


def flow_rows(axes: Axes, partners: Collection[str] = ()) -> list[FlowRow]:
    """Return the lines of an axis, each with the lanes of its signals."""
    last = {name: index for index, line in enumerate(axes.lines) for name in _reads(line)}
    lanes: list[str] = []  # the signal of each lane, empty for a free one
    rows: list[tuple[list[str], list[bool], bool]] = []
    for index, line in enumerate(axes.lines):
        read_lanes = {lanes.index(name) for name in _reads(line) if name in lanes}
        going = [bool(name) and last.get(name, -1) > index for name in lanes]
        passing = [bool(name) and k not in read_lanes for k, name in enumerate(lanes)]
        lanes = [name if goes else "" for name, goes in zip(lanes, going, strict=True)]
        places = []
        for name in line.names if isinstance(line, SignalLine) else ():
            free = [k for k, name_in_lane in enumerate(lanes) if not name_in_lane]
            ended = [k for k in free if k in read_lanes]  # the lane is reused for a result
            places.append((ended or free or [len(lanes)])[0])
            lanes[places[-1] : places[-1] + 1] = [name]
        out = isinstance(line, Drive | Learn)
        signs = _signs(len(lanes), passing, going, read_lanes, places, out=out)
        if isinstance(line, Zoom):
            signs = ["◆" if k in read_lanes else sign for k, sign in enumerate(signs)]
        lanes = [name if last.get(name, -1) > index else "" for name in lanes]
        rows.append((signs, [bool(name) for name in lanes], out))
    width = max((len(signs) for signs, _, _ in rows), default=0)
    return [
        FlowRow(
            _joined(signs, width, out=out),
            "".join("│ " if lane else "  " for lane in below).ljust(2 * width),
            line_words(line, partners),
        )
        for (signs, below, out), line in zip(rows, axes.lines, strict=True)
    ]


def _signs(
    count: int,
    passing: Sequence[bool],
    going: Sequence[bool],
    reads: set[int],
    defines: Sequence[int],
    *,
    out: bool,
) -> list[str]:
    """Return the character of each lane: defined here, read here, or passed by a joint."""
    touched = {*reads, *defines}
    first, last = min(touched, default=count), max(touched, default=-1)
    signs = []
    for k in range(count):
        is_crossed = first < k < last or (out and k > first)
        if k in defines:
            signs.append("●")
        elif k in reads:
            ways = UP | (DOWN if going[k] else 0) | (LEFT if k > first else 0)
            signs.append(STROKES[ways | (RIGHT if k < last or out else 0)])
        elif k < len(passing) and passing[k]:
            signs.append("│")
        else:
            signs.append("─" if is_crossed else " ")
    return signs


def _joined(signs: Sequence[str], width: int, *, out: bool) -> str:
    """Return the lanes of a line, with strokes between joined ones."""
    ends = [k for k, sign in enumerate(signs) if sign not in " │"]
    first, last = (ends[0], width if out else ends[-1]) if ends else (width, 0)
    text = ""
    for k, sign in enumerate([*signs, *["─" if out else " "] * (width - len(signs))]):
        text += sign + ("─" if first <= k < last else " ")
    return f"{text[:-1]}▶" if out else text


def _reads(line: Line) -> Iterator[str]:
    yield from line.reads()
