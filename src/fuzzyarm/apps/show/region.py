"""The proved region of attraction of a loop, with runs inside and outside."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.picture import COLOURS, Area, Axis, Chart, ChartPart, Dots, Line, Panel

if TYPE_CHECKING:
    from fuzzyarm.control.controllers.text import ControllerText
    from fuzzyarm.plant.plant import Plant
    from fuzzyarm.proof.loop.pictures import RegionPlane
    from fuzzyarm.proof.loop.verdicts import LoopVerdict


def region_chart(text: ControllerText, verdict: LoopVerdict, plant: Plant | None = None) -> Chart:
    """Return the sections of a proved region; of several parts of its parameters, of the first."""
    from fuzzyarm.proof.loop.pictures import region_planes

    verdict = verdict.parts[0] if verdict.parts else verdict
    panels = [_panel(plane) for plane in region_planes(text, verdict, plant)]
    title = f"{text.model.name}: proved {verdict.statement}"
    return Chart([panels], (4.4 * max(1, len(panels)), 4.2), title, key=True, heading=True)


def _panel(plane: RegionPlane) -> Panel:
    shadow, start = (plane.shadow[:, 0], plane.shadow[:, 1]), plane.start
    settled, divergent = plane.settled, plane.lost
    parts: list[ChartPart] = [
        Dots(settled[:, 0], settled[:, 1], ".", "#bbbbbb", 3.0, "a run came to rest")
    ]
    if len(divergent):
        parts.append(
            Dots(divergent[:, 0], divergent[:, 1], "x", COLOURS[3], 3.5, "a run did not", edge=0.8)
        )
    parts.append(Area(*shadow, COLOURS[0], 0.12))
    parts.append(Line(*shadow, COLOURS[0], 0.9, label="never left, once inside"))
    if len(start):
        label = "proved start, the others at rest"
        parts.append(Area(start[:, 0], start[:, 1], COLOURS[2], 0.22))
        parts.append(Line(start[:, 0], start[:, 1], COLOURS[2], 1.5, label=label))
    for k, run in enumerate(plane.runs):
        label = "" if k else "runs"
        parts.append(Line(run[:, 0], run[:, 1], "ink", 0.7, label=label, opacity=0.8))
    across, up = map(Axis, plane.names, plane.units)
    covered = "says nothing of starts: memory has a start of its own"
    if plane.covered is not None:
        covered = f"{100.0 * plane.covered:.0f} % of the settled starts shown are proved"
    return Panel(parts, across, up, covered)
