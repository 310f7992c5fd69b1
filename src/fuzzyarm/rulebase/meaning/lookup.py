"""Give the ``lookup`` block its meaning."""

from __future__ import annotations

import itertools
import math

from fuzzyarm.rulebase.diagnostic import Severity
from fuzzyarm.rulebase.limits import MAX_LEVELS
from fuzzyarm.rulebase.meaning.scope import Draft, Scope
from fuzzyarm.rulebase.meaning.variables import range_of
from fuzzyarm.rulebase.model import Lookup, LookupAxis
from fuzzyarm.rulebase.syntax.nodes import LookupItem, LookupNode


def even_levels(low: float, high: float, intervals: int) -> tuple[float, ...]:
    """Return `intervals` + 1 levels from `low` to `high`, each the nearest float to its decimal.

    ``-6 .. 6 step 0.1`` has the level -0.3 and not -0.2999999999999998; levels are mirrored
    where the ends are.
    """
    low, high = float(low), float(high)
    step = (high - low) / intervals
    if abs(low) + abs(high) < 1e15 and low.is_integer() and step.is_integer():
        return tuple(low + step * i for i in range(intervals + 1))
    from fractions import Fraction

    first, last = Fraction(repr(low)), Fraction(repr(high))
    return tuple(float(first + (last - first) * i / intervals) for i in range(intervals + 1))


def elaborate_lookup(node: LookupNode, scope: Scope) -> Lookup:
    """Return the settings of the ``lookup`` block."""
    common: dict[str, LookupItem] = {}
    own: dict[tuple[str, str], LookupItem] = {}
    for item in node.items:
        key = item.key.text
        if item.variable is None:
            known, place = common.get(key), common.__setitem__
            place(key, item)
        else:
            if scope.variable(item.variable, "input") is None:
                continue
            known = own.get((key, item.variable.text))
            own[key, item.variable.text] = item
        if known is not None:
            scope.report("duplicate-setting", f"'{key}' is set twice", item.key.span)
    axes = []
    for name in scope.names("input"):
        levels = own.get(("levels", name), common.get("levels"))
        bins = own.get(("bins", name), common.get("bins"))
        axis = _axis(scope.drafts[name], levels, bins, scope)
        if axis is not None:
            axes.append(axis)
    if "levels" not in common and not any(key == "levels" for key, _ in own):
        scope.report("missing-levels", "the lookup block names no levels", node.span)
    return Lookup(tuple(axes), _rounding(common.get("round"), scope))


def _axis(
    draft: Draft, levels: LookupItem | None, bins: LookupItem | None, scope: Scope
) -> LookupAxis | None:
    if levels is None:
        return None
    values = _levels(levels, scope)
    if values is None:
        return None
    low, high = range_of(draft.node)
    if not low <= values[0] <= values[-1] <= high:
        scope.report(
            "levels-outside-range",
            f"levels of '{draft.name}' lie outside its range {low:g} .. {high:g}",
            levels.span,
            severity=Severity.WARNING,
        )
    return LookupAxis(draft.name, values, _bins(bins, values, scope) if bins else None)


def _levels(item: LookupItem, scope: Scope) -> tuple[float, ...] | None:
    figures = [figure.value for figure in item.figures]
    span = item.figures[0].span.to(item.figures[-1].span)
    if item.form == "list":
        if len(figures) < 2 or any(b <= a for a, b in itertools.pairwise(figures)):
            scope.report("bad-levels", "levels are two or more increasing numbers", span)
            return None
        return tuple(figures)
    low, high, third = figures
    if not low < high:
        scope.report("bad-levels", "levels must go from a lower to a higher number", span)
        return None
    if item.form == "count":
        intervals = third - 1.0
        fits = third == int(third) and third >= 2
    else:
        intervals = (high - low) / third if third > 0.0 else 0.0
        fits = intervals >= 1 and abs(intervals - round(intervals)) < 1e-6
    if not fits or not math.isfinite(intervals):
        scope.report(
            "bad-levels",
            f"the {item.form} {third:g} does not divide the levels {low:g} .. {high:g}",
            item.figures[2].span,
        )
        return None
    if intervals >= MAX_LEVELS:
        scope.report("too-many-levels", f"more than {MAX_LEVELS:,} levels", span)
        return None
    return even_levels(low, high, round(intervals))


def _bins(item: LookupItem, levels: tuple[float, ...], scope: Scope) -> tuple[float, ...] | None:
    values = [figure.value for figure in item.figures]
    span = item.figures[0].span.to(item.figures[-1].span)
    if item.form == "mirrored":
        values = [-value for value in reversed(values)] + values
    if any(b <= a for a, b in itertools.pairwise(values)):
        what = "positive and increasing" if item.form == "mirrored" else "increasing"
        scope.report("bad-bins", f"bins must be {what}", span)
        return None
    if len(values) != len(levels) - 1:
        scope.report(
            "bad-bins",
            f"{len(levels)} levels need {len(levels) - 1} thresholds, found {len(values)}",
            span,
        )
        return None
    return tuple(values)


def _rounding(item: LookupItem | None, scope: Scope) -> float | None:
    if item is None:
        return None
    figure = item.figures[0]
    if not figure.value > 0.0:
        scope.report("bad-round", "the rounding step must be above 0", figure.span)
        return None
    return figure.value
