"""Parts of a picture in axes of matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.picture import Area, Drawing, Line, Part, Words, colour_of
from fuzzyarm.show.figures.style import safe

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_thing(axes: Axes, drawing: Drawing) -> None:
    """Draw a thing to scale, without axes."""
    left, right, bottom, top = drawing.stage
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
    axes.set_aspect("equal")
    axes.axis("off")
    for part in drawing.parts:
        draw_part(axes, part)


def draw_part(axes: Axes, part: Part) -> None:
    """Draw one part in the coordinates of axes."""
    from matplotlib.patches import Polygon

    if isinstance(part, Words):
        axes.text(part.x, part.y, safe(part.text), fontsize=part.size)
        return
    colour = colour_of(part.tone)
    if isinstance(part, Line):
        axes.plot(part.x, part.y, color=colour, linewidth=part.width, solid_capstyle="round")
    elif isinstance(part, Area):
        corners = list(zip(part.x, part.y, strict=True))
        axes.add_patch(Polygon(corners, color=colour, linewidth=0))
    else:
        axes.plot(part.x, part.y, part.sign, color=colour, markersize=part.size)
