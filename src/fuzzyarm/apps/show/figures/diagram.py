"""Block diagrams of controllers and rule bases, and figures of a controller with its files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.show.diagram import Diagram, block_diagram
from fuzzyarm.apps.show.figures.labels import text_width
from fuzzyarm.apps.show.figures.style import head, new_figure, safe
from fuzzyarm.apps.show.figures.surface import ResponseFigure, TablePicture
from fuzzyarm.apps.show.placement import ROUND, Pen, Picture, PlacedBlock, place
from fuzzyarm.apps.show.response import Response
from fuzzyarm.apps.show.system import system_diagram
from fuzzyarm.base.picture import COLOURS
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.language.model.controller import ControllerModel
from fuzzyarm.language.model.rulebase import RuleBase

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fuzzyarm.table import LookupTable

SIZES = {"label": 8.0, "detail": 6.5, "signal": 7.5, "head": 8.5}
"""Font sizes in points."""

BOLD = ("label", "head")

INK = "#333333"

FILLS = {
    "port": "#eeeeee",
    "drive": "#eeeeee",
    "input": "#eeeeee",
    "output": "#eeeeee",
    "rules": "#cfe5f3",
    "table": "#cfe5f3",
    "learn": "#d6efe3",
    "partner": "#f8e6c4",
    "limit": "#fbe0d2",
    "slew": "#fbe0d2",
}
"""Fill colours by kind of block, white by default."""

PEN = Pen(
    width_of=lambda text, style: text_width(text, SIZES[style]) * (1.12 if style in BOLD else 1.0),
    line=0.14,
    pad=0.07,
    room=1.0,
    track=0.1,
    arrow=0.2,
)
"""In inches."""

TIP = 0.07
"""Length of the end of a wire in inches."""

SIGNS = {"+": "+", "-": "−", "*": "×", "/": "÷"}


def diagram_figure(model: ControllerText | ControllerModel | RuleBase) -> Figure:
    """Return the block diagram of a controller or a rule base.

    Parameters
    ----------
    model : ControllerText or ControllerModel or RuleBase
        As for :func:`fuzzyarm.apps.show.block_diagram`, or a rule base.
    """
    diagram = system_diagram(model) if isinstance(model, RuleBase) else block_diagram(model)
    picture = place(diagram, PEN)
    figure = new_figure(_width(picture), picture.height + 0.55)
    _draw(figure.subplots(), picture)
    head(figure, _title(diagram))
    return figure


def controller_figure(controller: ControllerText) -> Figure:
    """Return the block diagram of a controller above the surfaces of its rule bases and tables.

    Parameters
    ----------
    controller : ControllerText
        With its files.
    """
    diagram = block_diagram(controller)
    picture = place(diagram, PEN)
    parts: list[tuple[str, Any]] = []
    for name, sheet in _sheets(controller):
        if isinstance(sheet, RuleBase):
            parts += [
                (f"rules {name}: {output.name}", ResponseFigure(Response(sheet, output, {})))
                for output in sheet.outputs
            ]
        else:
            parts.append((f"table {name}", TablePicture(sheet, {})))
    heights = [picture.height + 0.15, *(part.height + 0.25 for _, part in parts)]
    width = max(_width(picture), *(part.width for _, part in parts), 0.0)
    figure = new_figure(width, sum(heights) + 0.4)
    subfigures = figure.subfigures(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
    _draw(subfigures[0].subplots(), picture)
    for subfigure, (title, part) in zip(subfigures[1:], parts, strict=True):
        subfigure.suptitle(safe(title), fontsize=9.5, fontweight="bold")
        part.draw(subfigure)
    head(figure, _title(diagram))
    return figure


def _sheets(controller: ControllerText) -> list[tuple[str, RuleBase | LookupTable]]:
    """Return a controller's rule bases and tables, each once, except tables that start at zero."""
    sheets_found: list[tuple[str, RuleBase | LookupTable]] = []
    for name, sheets in controller.sheets.items():
        for index, sheet in enumerate(sheets):
            if any(sheet == other for _, other in sheets_found):
                continue
            if not isinstance(sheet, RuleBase) and not sheet.values.any():
                continue
            axis = controller.model.axis_names[index] if len(sheets) > 1 else ""
            sheets_found.append((f"{name} of {axis}" if axis else name, sheet))
    return sheets_found


def _title(diagram: Diagram) -> str:
    words = f"{diagram.name}: {diagram.description}" if diagram.description else diagram.name
    return f"{words}, {diagram.period}"


def _width(picture: Picture) -> float:
    return max(picture.width + 0.4, 4.5)


def _draw(axes: Axes, picture: Picture) -> None:
    """Draw a picture one to one: an inch is an inch."""
    from matplotlib.patches import Polygon

    axes.set_axis_off()
    axes.set_aspect("equal", adjustable="box")
    axes.set_xlim(-0.05, picture.width + 0.05)
    axes.set_ylim(picture.height, 0.0)
    for start, end in picture.strokes:
        axes.plot(*zip(start, end, strict=True), color=INK, linewidth=0.9, solid_capstyle="round")
    for _, points in picture.wires:
        x, y = points[-1]
        axes.add_patch(
            Polygon(((x, y), (x - TIP, y - 0.5 * TIP), (x - TIP, y + 0.5 * TIP)), facecolor=INK)
        )
    for x, y in picture.dots:
        axes.plot(x, y, "o", markersize=3, color=INK)
    for block in picture.blocks:
        _draw_block(axes, block, picture.pitch)
    for text, x, y, style in picture.words:
        weight = "bold" if style in BOLD else "normal"
        slant = "italic" if style == "signal" else "normal"
        colour = INK if style == "head" else COLOURS[0]
        axes.text(
            x, y, safe(text), fontsize=SIZES[style], fontweight=weight, fontstyle=slant,
            color=colour, ha="left", va="baseline",
        )  # fmt: skip


def _draw_block(axes: Axes, placed: PlacedBlock, pitch: float) -> None:
    from matplotlib.patches import FancyBboxPatch, Polygon, Rectangle

    block, x, y, width, height, lines = placed
    look: dict[str, Any] = {
        "facecolor": FILLS.get(block.kind, "white"), "edgecolor": INK, "linewidth": 0.9,
    }  # fmt: skip
    tip = 2.0 * PEN.pad
    if block.kind in ROUND:
        round_look = f"round,pad=0,rounding_size={0.5 * width}"
        axes.add_patch(FancyBboxPatch((x, y), width, height, boxstyle=round_look, **look))
        for word, _, at in placed.pins(pitch):
            axes.text(
                x + 0.5 * width, at, SIGNS.get(word, word), fontsize=9, ha="center", va="center"
            )
        return
    if block.kind == "gain":
        corners = [
            (x, y), (x + width - tip, y), (x + width, y + 0.5 * height),
            (x + width - tip, y + height), (x, y + height),
        ]  # fmt: skip
        axes.add_patch(Polygon(corners, closed=True, **look))
    elif block.kind in ("port", "drive", "input", "output"):
        round_look = f"round,pad=0,rounding_size={PEN.pad}"
        axes.add_patch(FancyBboxPatch((x, y), width, height, boxstyle=round_look, **look))
    else:
        axes.add_patch(Rectangle((x, y), width, height, **look))
    middle = x + 0.5 * (width - (tip if block.kind == "gain" else 0.0))
    top = y + 0.5 * (height - len(lines) * PEN.line)
    for index, (text, style) in enumerate(lines):
        weight = "bold" if style in BOLD else "normal"
        axes.text(
            middle, top + (index + 0.5) * PEN.line, safe(text), fontsize=SIZES[style],
            fontweight=weight, ha="center", va="center_baseline", color=INK,
        )  # fmt: skip
