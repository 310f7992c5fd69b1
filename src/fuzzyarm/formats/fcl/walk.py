"""Where jFuzzyLogic takes its samples, to the last bit.

It walks along the range by adding up steps; the model multiplies them. The two differ by
some 1e-16, which matters only to a vertical edge that stands exactly on a sample: there
the one may see 1 and the other 0.
"""

from __future__ import annotations

import math
from dataclasses import replace

from fuzzyarm.formats.draft import Draft
from fuzzyarm.formats.imported import Findings
from fuzzyarm.rulebase.model import Shape, Term


def settle_edges(draft: Draft, findings: Findings) -> None:
    """Move vertical edges by one step of the machine where that makes the samples agree.

    Parameters
    ----------
    draft : Draft
        A sampled output; its terms are changed in place.
    findings : Findings
        Where each change is told.
    """
    count = draft.defuzzifier.resolution
    if count is None:
        return
    places: list[tuple[float, float]] = []
    for index, term in enumerate(draft.terms):
        if not any(_edges(term.shape)):
            continue
        places = places or _places(draft.low, draft.high, count)
        moved = _moved(term.shape, places, draft.low, draft.high)
        if moved != term.shape:
            message = (
                f"an edge of '{term.name}' stands on a sample that jFuzzyLogic takes right "
                "beside it; it is moved by the smallest step there is"
            )
            findings.info("edge-on-sample", message, term.span)
            draft.put(index, Term(term.name, moved, term.span))


def _places(low: float, high: float, count: int) -> list[tuple[float, float]]:
    """Return the samples of the model and of jFuzzyLogic, pairwise."""
    step = (high - low) / count
    pairs = []
    x = low
    for index in range(count):
        pairs.append((low + index * step, x))
        x += step
    return pairs


def _edges(shape: Shape) -> tuple[bool, bool]:
    """Return whether the left and the right flank are vertical."""
    p = shape.parameters
    match shape.kind:
        case "triangle":
            return p[0] == p[1], p[1] == p[2]
        case "trapezoid":
            return p[0] == p[1], p[2] == p[3]
        case "rectangle" | "singleton":
            return True, True
    return False, False


def _moved(shape: Shape, places: list[tuple[float, float]], low: float, high: float) -> Shape:
    left, right = _edges(shape)
    p = list(shape.parameters)
    if left and _seen_from(p[0], places) < 0:
        up = math.nextafter(p[0], high)
        p = [up if value == shape.parameters[0] else value for value in p]
    if right and _seen_from(p[-1], places) > 0:
        down = math.nextafter(p[-1], low)
        p = [down if value == p[-1] else value for value in p]
    return replace(shape, parameters=tuple(p))


def _seen_from(edge: float, places: list[tuple[float, float]]) -> int:
    """Return -1 or 1 where a sample on the edge is taken before or behind it, else 0."""
    for model, walked in places:
        if model == edge:
            return (walked > edge) - (walked < edge)
    return 0
