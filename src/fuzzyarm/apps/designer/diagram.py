"""Block diagrams in pixels, of controllers and rule bases, and the surfaces of their rules."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.designer.faults import TextRefusedError
from fuzzyarm.apps.designer.messages import SceneBlock, SceneDiagram
from fuzzyarm.apps.designer.requests import BareMessage
from fuzzyarm.apps.lsp.session import UTF16, Session, to_position
from fuzzyarm.apps.show.diagram import block_diagram
from fuzzyarm.apps.show.drawing import number_words
from fuzzyarm.apps.show.placement import ROUND, Pen, PlacedBlock, place
from fuzzyarm.apps.show.plane import plane_panel
from fuzzyarm.apps.show.system import system_diagram
from fuzzyarm.base.diagnostic import NOWHERE
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.names import printable
from fuzzyarm.base.picture import Axis, panel_data
from fuzzyarm.control.controllers.text import ControllerText, home_of, with_files
from fuzzyarm.language.edit import Reading
from fuzzyarm.language.model.rulebase import RuleBase

if TYPE_CHECKING:
    from fuzzyarm.apps.designer.comparison import ComparedSurface
    from fuzzyarm.apps.designer.jobs import WindowJob
    from fuzzyarm.table import LookupTable

SIZES = {"label": 13.0, "detail": 11.0, "signal": 12.0, "head": 13.0}
"""Of letters, px."""

NARROW, WIDE = frozenset("iljtfrI.,:;|!'()[]/- "), frozenset("mwMW@%")

ACROSS = 41
"""Points of a small surface along each input."""

MOST_SHEETS = 12

MOST_VARIABLES = 60
"""Of a rule base whose diagram is drawn; beyond, it is a wall of names."""


def _width(text: str, style: str) -> float:
    """Return the approximate width of a text in a page, rather too large than too small."""
    bold = 1.08 if style in ("label", "head") else 1.0
    units = sum(0.42 if c in NARROW else 0.95 if c in WIDE else 0.64 for c in text)
    return units * SIZES[style] * bold


PEN = Pen(width_of=_width, line=16.0, pad=8.0, room=120.0, track=10.0, arrow=20.0)


def diagram_of(model: ControllerText | RuleBase, reading: Reading) -> SceneDiagram:
    """Return the block diagram of a controller or a rule base as JSON data; lengths are pixels."""
    diagram = system_diagram(model) if isinstance(model, RuleBase) else block_diagram(model)
    uses = () if isinstance(model, RuleBase) else model.model.uses
    picture = place(diagram, PEN)
    return {
        "name": diagram.name,
        "description": diagram.description,
        "period": diagram.period,
        "width": _short(picture.width),
        "height": _short(picture.height),
        "blocks": [_block(block, picture.pitch, reading) for block in picture.blocks],
        "strokes": [[*map(_short, (*start, *end))] for start, end in picture.strokes],
        "tips": [[*map(_short, points[-1])] for _, points in picture.wires],
        "dots": [[_short(x), _short(y)] for x, y in picture.dots],
        "words": [
            {"text": word.text, "x": _short(word.x), "y": _short(word.y), "style": word.style}
            for word in picture.words
        ],
        "uses": [[use.name, *use.files] for use in uses],
        "isSystem": isinstance(model, RuleBase),
    }


def is_drawable(rulebase: RuleBase) -> bool:
    """Whether the diagram of a rule base has as many variables as a page can show."""
    return 0 < len(rulebase.inputs) + len(rulebase.outputs) <= MOST_VARIABLES


def _block(placed: PlacedBlock, pitch: float, reading: Reading) -> SceneBlock:
    block, span = placed.block, placed.block.span
    at = None
    if span != NOWHERE:
        at = list(to_position(reading.raw_lines, span.line, span.column, UTF16))
    round_ = block.kind in ROUND
    pins = [[word, _short(x), _short(y)] for word, x, y in placed.pins(pitch)] if round_ else []
    return {
        "kind": block.kind,
        "round": round_,
        "x": _short(placed.x),
        "y": _short(placed.y),
        "width": _short(placed.width),
        "height": _short(placed.height),
        "lines": [list(line) for line in placed.lines],
        "label": " ".join([block.label, *block.details]).strip(),
        "pins": pins,
        "at": at,
    }


def _short(value: float) -> float:
    return round(value, 1)


# --- Its rule bases and tables ---


def sheets(session: Session, request: BareMessage, job: WindowJob) -> None:
    """Report the surfaces of a controller's rule bases and tables, over their first two inputs."""
    from fuzzyarm.apps.designer.comparison import outputs_of, surface_of

    model = session.reading.parsed.controller if isinstance(session.reading, Reading) else None
    if model is None:
        raise TextRefusedError("the text is not a controller without mistakes")
    controller, _ = with_files(model, home_of(session.path), session.path)
    files = {use.name: use.files for use in model.uses}
    pictures: list[dict[str, Any]] = []
    for name, parts in controller.sheets.items():
        for number, sheet in enumerate(parts):
            file = files.get(name, ())[number : number + 1]
            for output in outputs_of(sheet):
                if len(pictures) < MOST_SHEETS:
                    job.check()
                    facts = {"name": name, "output": output, **_file(file, session)}
                    pictures.append({**facts, **_facts(sheet), **_plane(sheet, output, surface_of)})
    job.tell({"sheets": pictures})


def _file(files: tuple[str, ...], session: Session) -> dict[str, Any]:
    """Return the file of a sheet, and whether it is a shipped one."""
    if not files:
        return {"file": "", "shipped": False}
    file = Path(files[0])
    named = file.suffix in (".frb", ".lut") and file.name == files[0]
    return {"file": files[0], "shipped": named and not (Path(session.path).parent / file).exists()}


def _facts(sheet: RuleBase | LookupTable) -> dict[str, Any]:
    if isinstance(sheet, RuleBase):
        return {"kind": "rules", "count": len(sheet.rules)}
    return {"kind": "table", "count": int(sheet.values.size)}


def _plane(sheet: RuleBase | LookupTable, output: str, surface_of: Any) -> dict[str, Any]:
    """Return the values over two inputs, or one; the others are in the middle of their ranges."""
    import numpy as np

    try:
        surface: ComparedSurface = surface_of(sheet, output)
    except FuzzyarmError as error:
        return {"why": printable(str(error))}
    names = list(surface.ranges)
    x, y = names[-1], names[-2] if len(names) > 1 else ""
    at = {name: np.array(0.5 * (low + high)) for name, (low, high) in surface.ranges.items()}
    xs = np.linspace(*surface.ranges[x], ACROSS)
    ys = np.linspace(*surface.ranges[y], ACROSS) if y else np.zeros(1)
    at[x] = xs[None, :]
    if y:
        at[y] = ys[:, None]
    values = np.broadcast_to(surface.at(at), (ys.size, xs.size))
    finite = [value for value in values.ravel().tolist() if math.isfinite(value)]
    low, high = min(finite, default=0.0), max(finite, default=0.0)
    title = f"{output}: {number_words(low, 4)} … {number_words(high, 4)}"
    points = {x: xs, **({y: ys} if y else {})}
    panel = plane_panel(points, {"": values}, Axis(output), title=title)
    return {"x": x, "y": y, "panel": panel_data(panel)}
