"""Where jFuzzyLogic takes its samples, to the last bit.

It walks along the range by adding up steps; the model multiplies them. The two differ by
some 1e-16, which matters only to a vertical edge that stands on a sample: there the one may
see 1 and the other 0.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import replace

from fuzzyarm.formats.drafts import Draft
from fuzzyarm.formats.findings import Findings
from fuzzyarm.model.rulebase import Shape, Term

__all__ = ["settle_edges"]


def settle_edges(draft: Draft, findings: Findings) -> None:
    """Move vertical edges by one step of the machine where that makes the samples agree."""
    count = draft.defuzzifier.resolution
    if count is None:
        return
    samples: list[tuple[float, float]] = []
    for index, term in enumerate(draft.terms):
        if not any(_edges(term.shape)):
            continue
        samples = samples or _samples(draft.low, draft.high, count)
        moved = _moved(term.shape, samples, draft.low, draft.high)
        if moved != term.shape:
            message = (
                f"an edge of '{term.name}' stands on a sample that jFuzzyLogic takes right "
                "beside it; it is moved by the smallest step there is"
            )
            findings.info("edge-on-sample", message, term.span)
            draft.put(index, Term(term.name, moved, term.span))


def _samples(low: float, high: float, count: int) -> list[tuple[float, float]]:
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


def _moved(shape: Shape, samples: list[tuple[float, float]], low: float, high: float) -> Shape:
    left, right = _edges(shape)
    first, last = shape.parameters[0], shape.parameters[-1]
    model, walked = _nearest(first, samples)
    if shape.kind == "singleton" and model != first:
        return shape  # on no sample, whichever side it is seen from
    p = list(shape.parameters)
    if left and (model < first <= walked or walked < first <= model):
        edge = model if walked >= first else math.nextafter(model, high)
        p = [edge if value == first else value for value in p]
    model, walked = _nearest(last, samples)
    if right and (model <= last < walked or walked <= last < model):
        edge = model if walked <= last else math.nextafter(model, low)
        p = [edge if value == last else value for value in p]
    return replace(shape, parameters=tuple(p))


def _nearest(edge: float, samples: list[tuple[float, float]]) -> tuple[float, float]:
    """Return the sample of the model that is nearest to an edge, and jFuzzyLogic's."""
    index = bisect_left(samples, (edge, -math.inf))
    return min(samples[max(index - 1, 0) : index + 1], key=lambda pair: abs(pair[0] - edge))
