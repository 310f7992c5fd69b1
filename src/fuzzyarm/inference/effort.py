"""Rough evaluation time of a point, which limits the points of a picture or a comparison.

No clock: the same numbers on every machine, hence the same pictures and statements. The
microseconds are those of one processor of 2024; nine of ten random rule bases (of 240) take 0.1 to
2 times the estimate.
"""

from __future__ import annotations

from fuzzyarm.inference.layout import uncovered_feature
from fuzzyarm.inference.plan import OutputPlan, plan
from fuzzyarm.inference.programs import SEARCHED, program_of
from fuzzyarm.language.model.rulebase import RuleBase

PER_RULE = 0.05
"""For the strength of each rule."""

PER_SAMPLE = 0.002
"""For each sample of each set of an output."""

JOINED = 5.0
"""Factor of joined samples: lines between them are cut and crossed."""

HALVED = 2.0
"""A bisector goes through its samples twice."""

PER_PANEL = 1.0
"""Of a quadrature, for each stretch between bends and each set: 40 heights."""

PER_CUT = 0.02
"""Of exact maxima under `max`, for each stretch and set."""

PER_SEARCH = 10.0
"""Of exact maxima under another aggregation, for each stretch and rule; by the interpreted kernel
alone."""

ENDS_OF_INTERVAL = 4.0
"""Number of quadratures for the two ends of a centroid of interval type 2."""

INTERPRETED = 100.0
"""Factor of an output that machine code does not cover."""


def microseconds(rulebase: RuleBase) -> float:
    """Return the estimated time of one point among many."""
    steps = plan(rulebase)
    slower = INTERPRETED if uncovered_feature(rulebase) else 1.0
    time = slower * PER_RULE * len(steps.rules)
    for output in steps.outputs.values():
        is_searched = program_of(output) is SEARCHED
        time += _of_output(output) * (1.0 if is_searched else slower)
    return time


def points_within(rulebase: RuleBase, seconds: float, *, least: int, most: int) -> int:
    """Return the number of points within some seconds, by this estimate."""
    return max(least, min(most, int(1e6 * seconds / microseconds(rulebase))))


def _of_output(output: OutputPlan) -> float:
    way, record = output.output.defuzzifier, output.record
    united = output.output.aggregation == "max"
    sets = len(output.members if united else output.contributions)
    if output.discrete:
        return PER_RULE * sets
    if way.resolution is not None:
        factor = (JOINED if way.joined else 1.0) * (HALVED if record.of == "area" else 1.0)
        return PER_SAMPLE * way.resolution * sets * factor
    stretches = len({piece.x0 for member in output.members for piece in member.pieces}) * sets
    if record.of == "top":
        return (PER_CUT if united else PER_SEARCH) * stretches
    if record.of != "area" and (output.closed is not None or output.enveloped):
        return PER_RULE * stretches
    return PER_PANEL * (ENDS_OF_INTERVAL if record.of == "ends" else 1.0) * stretches
