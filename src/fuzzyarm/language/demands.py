"""Demands of a file on its rule base: ``expect``, ``prove``, ``lookup`` and ``tune``."""

from __future__ import annotations

import itertools
import math

from fuzzyarm.base.diagnostic import (
    MAX_LEVELS,
    Severity,
    Span,
)
from fuzzyarm.base.numbers import even_levels, number_text
from fuzzyarm.language.declarations import (
    Draft,
    Scope,
    range_of,
)
from fuzzyarm.language.model.rulebase import (
    Expectation,
    GainTuning,
    Lookup,
    LookupAxis,
    Outcome,
    PeakTuning,
    Property,
    Tuning,
)
from fuzzyarm.language.statements import ExpectNode, LookupItem, LookupNode, OutcomeNode, ProveNode
from fuzzyarm.language.tokens import name_text
from fuzzyarm.language.tune import TuneItem, TuneNode

# --- `expect` lines ---


def elaborate_expectation(node: ExpectNode, scope: Scope) -> Expectation | None:
    """Return the expectation of `node`, or None after a report."""
    before = len(scope.diagnostics)
    values: dict[str, float] = {}
    for word, figure in node.inputs:
        if scope.variable(word, "input") is None:
            continue
        if word in values:
            scope.report("duplicate-setting", f"'{word}' is given twice", word.span)
        values[str(word)] = float(figure)
    missing = [name for name in scope.names("input") if name not in values]
    if missing and len(scope.diagnostics) == before and not scope.broken_variables:
        scope.report(
            "incomplete-expectation",
            f"an expectation must name every input; missing: {', '.join(missing)}",
            node.span,
            hint=f"add  {', '.join(f'{name_text(name)} = 0' for name in missing)}",
        )
    outcomes = tuple(_outcome(outcome, scope) for outcome in node.outcomes)
    if len(scope.diagnostics) > before:
        return None
    # The model has inputs in the order of their declaration, not of the line.
    order = {name: i for i, name in enumerate(scope.names("input"))}
    inputs = tuple(sorted(values.items(), key=lambda item: order[item[0]]))
    return Expectation(inputs, outcomes, node.span)


def _outcome(node: OutcomeNode, scope: Scope) -> Outcome:
    scope.variable(node.variable, "output")
    other = node.other
    if node.relation == "=" and other is not None and other < 0.0:
        scope.report("bad-tolerance", "a tolerance must not be negative", other.span)
    if node.relation == "in" and other is not None and other < node.value:
        scope.report(
            "bad-range", "the interval must go from a lower to a higher number", other.span
        )
    tolerance = None if other is None else float(other)
    return Outcome(str(node.variable), node.relation, float(node.value), tolerance)


# --- `prove` lines ---


def elaborate_property(node: ProveNode, scope: Scope) -> Property | None:
    """Return the property of `node`, or None after a report."""
    before = len(scope.diagnostics)
    region: dict[str, tuple[float, float]] = {}
    for stretch in node.region:
        word = stretch.variable
        draft = scope.variable(word, "input")
        if draft is None:
            continue
        if word in region:
            scope.report("duplicate-setting", f"'{word}' is given twice", word.span)
        low, high = stretch.low, stretch.high
        _demand_stretch(stretch.high.span, low, high, scope)
        first, last = range_of(draft.node)
        # The wrong order of the ends has been reported; one slip is one finding.
        if not first <= low <= high <= last and low <= high:
            scope.report(
                "bad-range",
                f"{low:g} .. {high:g} leaves the range of '{word}', {first:g} .. {last:g}",
                stretch.low.span.to(stretch.high.span),
            )
        region[str(word)] = float(low), float(high)
    output = _claimed_output(node, scope)
    outcome = None if node.outcome is None else _outcome(node.outcome, scope)
    if node.input is not None:
        scope.variable(node.input, "input")
    if node.verb == "slope" and node.low is not None and node.high is not None:
        _demand_stretch(node.high.span, node.low, node.high, scope)
    if node.verb == "table" and node.high is not None and not node.high > 0.0:
        scope.report("bad-tolerance", "the worst error of a table must be above 0", node.high.span)
    if node.verb == "odd":
        _demand_symmetry(node, region, scope)
    if len(scope.diagnostics) > before or output is None:
        return None
    return Property(
        node.verb,
        output,
        tuple((name, *ends) for name, ends in region.items()),
        outcome,
        "" if node.input is None else str(node.input),
        0.0 if node.low is None else float(node.low),
        0.0 if node.high is None else float(node.high),
        "" if node.mode is None else str(node.mode),
        node.span,
    )


def _demand_stretch(span: Span, low: float, high: float, scope: Scope) -> None:
    if high < low:
        scope.report("bad-range", "the interval must go from a lower to a higher number", span)


def _claimed_output(node: ProveNode, scope: Scope) -> str | None:
    if node.output is not None:
        draft = scope.variable(node.output, "output")
        return None if draft is None else draft.name
    outputs = scope.names("output")
    if len(outputs) == 1:
        return outputs[0]
    if outputs:
        error = "" if node.high is None else number_text(node.high)
        scope.report(
            "ambiguous-output",
            "the file has several outputs: name that of the table",
            node.span,
            hint=f"write  table of {name_text(outputs[0])} {node.mode} within {error}",
        )
    return None


def _demand_symmetry(node: ProveNode, region: dict[str, tuple[float, float]], scope: Scope) -> None:
    for name in scope.names("input"):
        low, high = region.get(name, range_of(scope.drafts[name].node))
        if low != -high and node.output is not None:
            scope.report(
                "not-symmetric",
                f"only over ranges that are symmetric about 0 an output can be {node.verb};"
                f" '{name}' goes {low:g} .. {high:g}",
                node.output.span,
            )


# --- The `lookup` block ---


def elaborate_lookup(node: LookupNode, scope: Scope) -> Lookup:
    """Return the settings of the ``lookup`` block."""
    items: dict[tuple[str, str | None], LookupItem] = {}  # by key and input; None: every input
    for item in node.items:
        if item.variable is not None and scope.variable(item.variable, "input") is None:
            continue
        which = item.key, item.variable
        if which in items:
            message = f"'{item.key}' is set twice"
            scope.report("duplicate-setting", message, item.key.span)
        items[which] = item
    axes = []
    for name in scope.names("input"):
        levels = items.get(("levels", name), items.get(("levels", None)))
        bins = items.get(("bins", name), items.get(("bins", None)))
        axis = _axis(scope.drafts[name], levels, bins, scope)
        if axis is not None:
            axes.append(axis)
    if not node.unread and not any(key == "levels" for key, _ in items):
        scope.report("missing-levels", "the lookup block names no levels", node.span)
    return Lookup(tuple(axes), _rounding(items.get(("round", None)), scope))


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
    figures = list(map(float, item.figures))
    span = item.figures[0].span.to(item.figures[-1].span)
    if item.form == "list":
        if len(figures) < 2 or any(b <= a for a, b in itertools.pairwise(figures)):
            scope.report("bad-levels", "levels must be two or more increasing numbers", span)
            return None
        return tuple(figures)
    low, high, third = figures
    if not low < high:
        scope.report("bad-levels", "levels must go from a lower to a higher number", span)
        return None
    if item.form == "count":
        intervals = third - 1.0
        fits = math.isfinite(third) and float(third).is_integer() and third >= 2
    else:
        intervals = (high - low) / third if third > 0.0 else 0.0
        finite = math.isfinite(intervals)
        # A decimal step such as 0.1 has no exact binary value.
        fits = finite and intervals >= 1 and abs(intervals - round(intervals)) < 1e-6
    if not fits:
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
    values = list(map(float, item.figures))
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
    if not figure > 0.0:
        scope.report("bad-round", "the rounding step must be above 0", figure.span)
        return None
    return float(figure)


# --- The `tune` block ---

MOST_GAP = 50.0
"""Largest gap of neighbouring peaks, percent of the range."""


def elaborate_tuning(node: TuneNode, scope: Scope) -> Tuning:
    """Return the valid part of a ``tune`` block."""
    peaks: list[PeakTuning] = []
    gains: list[GainTuning] = []
    kept_names: list[tuple[str, str]] = []
    seen_names: set[str] = set()
    for item in node.items:
        if item.key == "peaks":
            _report_twice(item, seen_names, scope)
            tuning = _peaks(item, scope)
            peaks += [tuning] if tuning.variables else []
        elif item.key == "gain":
            _report_twice(item, seen_names, scope)
            gains += [_tuned_gain(item)] if _sound_range(item, scope) else []
        else:
            draft = scope.variable(item.names[0])
            terms = [scope.term(draft, word) for word in item.terms]
            names = [term.name for term in terms if term is not None]
            if draft is not None and len(names) == len(item.terms):
                # The empty name means all terms of the variable.
                kept_names += [(draft.name, name) for name in names or [""]]
    return Tuning(tuple(peaks), tuple(gains), tuple(kept_names))


def _report_twice(item: TuneItem, moved: set[str], scope: Scope) -> None:
    for word in item.names:
        name = f"{item.key} {word}"
        if name in moved:
            scope.report("duplicate-setting", f"'{word}' is tuned twice", word.span)
        moved.add(name)


def _peaks(item: TuneItem, scope: Scope) -> PeakTuning:
    drafts = [scope.variable(word) for word in item.names]
    for draft, word in zip(drafts, item.names, strict=True):
        if draft is not None and not all(map(math.isfinite, range_of(draft.node))):
            message = f"'{draft.name}' has no finite range for its peaks to move in"
            scope.report("bad-range", message, word.span)
    gap = {}
    if item.gap is not None:
        if not 0.0 <= item.gap <= MOST_GAP:
            message = f"a gap is 0 to {MOST_GAP:g} percent of the range"
            scope.report("bad-range", message, item.gap.span)
        gap["gap"] = item.gap / 100.0
    return PeakTuning(
        tuple(draft.name for draft in drafts if draft is not None),
        "mirrored" in item.words,
        "keep order" in item.words,
        "partition" in item.words,
        **gap,
    )


def _sound_range(item: TuneItem, scope: Scope) -> bool:
    assert item.low is not None
    assert item.high is not None
    span, before = item.low.span.to(item.high.span), len(scope.diagnostics)
    if not item.low < item.high:
        message = "the range of a gain must go from a lower to a higher number"
        scope.report("bad-range", message, span)
    elif {"times", "log"} & set(item.words) and not item.low > 0.0:
        scope.report("bad-range", "multiples and logarithms of a gain begin above 0", span)
    return len(scope.diagnostics) == before


def _tuned_gain(item: TuneItem) -> GainTuning:
    assert item.low is not None
    assert item.high is not None
    flags = ("times" in item.words, "log" in item.words, "per axis" in item.words)
    names = tuple(map(str, item.names))
    return GainTuning(names, float(item.low), float(item.high), *flags, item.span)
