"""How long a point takes, in round numbers: how many of them a picture or a comparison is worth.

The same numbers on every machine, so that what is drawn and stated is the same there: no clock.
The microseconds are those of one processor of 2024; of 240 random rule bases nine of ten take
between a tenth and twice as long as this says.
"""

from __future__ import annotations

from fuzzyarm.inference.layout import what_is_not_covered
from fuzzyarm.inference.plan import OutputPlan, plan
from fuzzyarm.language.model.rulebase import RuleBase

PER_RULE = 0.05
PER_RULE_OF_NUMPY = 0.1
"""For what fires, for each rule: by the kernel, and by NumPy."""

PER_SAMPLE = 0.002
PER_SAMPLE_OF_NUMPY = 0.05
"""For each sample of each set of an output."""

JOINED = 15.0
JOINED_OF_NUMPY = 5.0
"""Joined samples take so many times as long: lines between them are cut and crossed."""

HALVED = 2.0
"""A bisector goes through its samples twice."""

PER_PANEL = 1.0
PER_PANEL_OF_NUMPY = 8.0
"""Of a quadrature, for each stretch between bends and each set: 40 heights."""

PER_CUT = 0.02
PER_CUT_OF_NUMPY = 0.5
"""Of exact maxima under `max`, for each stretch and set."""

PER_SEARCH = 10.0
"""Of exact maxima under another aggregation, for each stretch and rule."""

ENDS_OF_INTERVAL = 4.0
"""How many quadratures the two ends of a centroid of interval type 2 take."""


def microseconds(rulebase: RuleBase) -> float:
    """Return how long one point of a rule base takes among many, roughly."""
    steps = plan(rulebase)
    covered = not what_is_not_covered(rulebase)
    per_rule = PER_RULE if covered else PER_RULE_OF_NUMPY
    rules = per_rule * len(steps.rules)
    return rules + sum(_of_output(output, covered=covered) for output in steps.outputs.values())


def points_within(rulebase: RuleBase, seconds: float, *, least: int, most: int) -> int:
    """Return how many points of a rule base take so many seconds, roughly."""
    return max(least, min(most, int(1e6 * seconds / microseconds(rulebase))))


def _of_output(output: OutputPlan, *, covered: bool) -> float:
    way, record = output.output.defuzzifier, output.record
    sets = len(output.members if output.output.aggregation == "max" else output.contributions)
    if output.discrete:
        return (PER_RULE if covered else PER_RULE_OF_NUMPY) * sets
    if way.resolution is not None:
        per_sample = PER_SAMPLE if covered else PER_SAMPLE_OF_NUMPY
        joined_factor = (JOINED if covered else JOINED_OF_NUMPY) if way.joined else 1.0
        halved = HALVED if record.of == "area" else 1.0
        return per_sample * way.resolution * sets * joined_factor * halved
    pieces = {piece.x0 for member in output.members for piece in member.pieces}
    stretches = len(pieces) * sets
    if record.of == "top":
        per_cut = PER_CUT if covered else PER_CUT_OF_NUMPY
        return (per_cut if output.output.aggregation == "max" else PER_SEARCH) * stretches
    if record.of != "area" and (output.closed is not None or output.enveloped):
        return PER_RULE * stretches
    ends = ENDS_OF_INTERVAL if record.of == "ends" else 1.0
    return ends * (PER_PANEL if covered else PER_PANEL_OF_NUMPY) * stretches
