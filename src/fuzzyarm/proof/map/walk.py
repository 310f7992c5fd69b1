"""The static part of one axis of a controller, line by line, with a law for each signal.

A control period (:mod:`fuzzyarm.control.controllers.period`) over laws, with the slopes and sectors
of rule bases from :mod:`fuzzyarm.proof.map.sector`. The ranges of the sources are those of
:mod:`fuzzyarm.control.controllers.reach`.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any, NamedTuple

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.control.controllers.code import SourceError
from fuzzyarm.control.controllers.on_plant import Site
from fuzzyarm.control.controllers.period import Algebra, Call, ControlPeriod, Lesson, Update
from fuzzyarm.control.controllers.reach import Reach, reaches_of
from fuzzyarm.control.controllers.text import ControllerText, input_names
from fuzzyarm.inference.infer import infer, with_nan_for_no_rule
from fuzzyarm.language.model.controller import AxisSignal, Drive, SignalLine, Source, Zoom
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.language.signals import choice_text, chosen_text
from fuzzyarm.proof.map.bounds import LIKE_EXPECT
from fuzzyarm.proof.map.laws import (
    NOTHING,
    ONE,
    Gains,
    SignalLaw,
    combined,
    constant,
    curved,
    inside,
    only_value,
    over,
    plus,
    scaled,
    snapped,
    table_law,
    times,
    unknown,
)
from fuzzyarm.proof.map.prover import Prover
from fuzzyarm.proof.map.sector import Sector, Slopes, sector, slopes_at
from fuzzyarm.proof.stop import Stop
from fuzzyarm.symbolic.evaluation import specialise
from fuzzyarm.symbolic.intervals import combine, hull, largest, overlap, symmetric
from fuzzyarm.symbolic.nodes import Node, symbols
from fuzzyarm.symbolic.operations import EVERYTHING, Interval
from fuzzyarm.symbolic.sources import CHOICE, Chosen, Setting
from fuzzyarm.table import LookupTable

BOXES_SECONDS = 2.0
"""Time budget for the range of a rule base by boxes: more time only tightens it."""


# ── one axis ──────────────────────────────────────────────────────────────────────────


class AxisLines:
    """One axis of a controller: its lines, its sources, and the results so far.

    Attributes
    ----------
    definitions : dict
        By the name of a source: its definition and the law of its signal.
    only_values : bool
        Evaluate rule bases at a point only.
    """

    def __init__(
        self, text: ControllerText, site: Site | None, name: str, stop: Stop, cache: dict[Any, Any]
    ) -> None:
        self.text, self.site, self.name, self.stop = text, site, name, stop
        reaches = reaches_of(text, site)
        self.signals = reaches.signals
        own_reaches = {of: reach for (axis, of), reach in reaches.sources.items() if axis == name}
        self._names = _names_of(own_reaches)
        self.sources: dict[str, Reach] = {
            self._names[of]: reach for of, reach in own_reaches.items()
        }
        self.definitions: dict[str, tuple[Source, SignalLaw | None]] = {}
        self.only_values = False
        self._cache = cache

    def reach_of(self, seen: AxisSignal) -> Interval:
        """Return the range of a signal of another axis."""
        return self.signals[seen.axis, seen.signal].at

    def name_of(self, of: Source) -> str:
        """Return the name of a source, unique for different ones."""
        return self._names[of]

    def remember(self, name: str, of: Source, inner: SignalLaw | None) -> None:
        """Record the definition of a source, known to the first walk only."""
        self.definitions.setdefault(name, (of, inner))

    # --- queries of rule bases; axes share the answers ---

    def prover(self, rulebase: RuleBase, output: str) -> Prover:
        """Return the prover of an output."""
        key = id(rulebase), output
        if key not in self._cache:
            self._cache[key] = Prover(rulebase, output)
        prover: Prover = self._cache[key]
        prover.stop = self.stop
        return prover

    def value(self, prover: Prover, region: Mapping[str, Any]) -> Any:
        """Return bounds of an output; None without any."""
        key = "value", id(prover), tuple(sorted(region.items()))
        if key not in self._cache:
            if prover.model is None:
                prover.stop = Stop(min(BOXES_SECONDS, self.stop.left))
            try:
                self._cache[key] = prover.value(region)
            except FuzzyarmError:
                self._cache[key] = None
            prover.stop = self.stop
        return self._cache[key]

    def hole(self, prover: Prover, region: Mapping[str, Any]) -> str:
        """Return where an output has no value, or why that is open; else nothing."""
        key = "hole", id(prover), tuple(sorted(region.items()))
        if key not in self._cache:
            if prover.model is None:
                prover.stop = Stop(min(BOXES_SECONDS, self.stop.left))
            self._cache[key] = prover.hole(region)
            prover.stop = self.stop
        hole: str = self._cache[key]
        return hole

    def sector(
        self,
        prover: Prover,
        weights: Mapping[str, Fraction],
        region: Mapping[str, tuple[float, float]],
    ) -> Sector:
        """Return a sector of an output."""
        key = "sector", id(prover), tuple(weights.items()), tuple(sorted(region.items()))
        if key not in self._cache:
            self._cache[key] = sector(prover, weights, region)
        sector_: Sector = self._cache[key]
        return sector_


# ── the walk over one axis ───────────────────────────────────────────────────────────


class WalkQuestion(NamedTuple):
    """The question of a walk: ranges of the sources, and the weights of σ (none: no sector)."""

    at: Mapping[str, Interval]
    form: Mapping[str, float]


@dataclass
class _Notes:
    """Records of a walk.

    `zones`: ranges of sources that keep inputs within their universes; `points`: sources at the
    extremes of rule bases; `groups`: the sources of each rule base; `flat`: signals with slope 0
    around rest.
    """

    zones: dict[str, Interval] = field(default_factory=dict)
    points: list[dict[str, float]] = field(default_factory=list)
    groups: list[tuple[str, ...]] = field(default_factory=list)
    flat: list[str] = field(default_factory=list)


class LineWalk(Algebra[SignalLaw]):
    """The algebra of laws for a control period of one axis, with sources where needed."""

    def __init__(self, case: AxisLines, question: WalkQuestion) -> None:
        self.case = case
        self.question = question
        self.notes = _Notes()
        self.drives: dict[str, list[tuple[Drive, SignalLaw]]] = {}

    def run(self) -> LineWalk:
        """Walk all lines."""
        ControlPeriod(self.case.text, self).run({}, {}, only={self.case.name})
        return self

    def drive(self, axis: str, line: Drive, value: SignalLaw) -> SignalLaw:
        """Record a drive, before its limits."""
        self.drives.setdefault(line.port, []).append((line, value))
        return value

    # --- numbers ---

    def number(self, value: float) -> SignalLaw:
        """Return the law of a number."""
        return constant(value)

    def unknown(self, name: str) -> SignalLaw:
        """Return the law of a partner, or of a signal of another axis."""
        if isinstance(name, AxisSignal):
            return unknown(self.case.reach_of(name), f"'{name}' is a signal of another axis")
        return unknown(EVERYTHING, f"'{name}' is a law of its own")

    def add(self, a: SignalLaw, b: SignalLaw) -> SignalLaw:
        """Return the law of a sum."""
        return plus(a, b)

    def negated(self, x: SignalLaw) -> SignalLaw:
        """Return a law times -1."""
        return scaled(x, -1.0)

    def subtract(self, a: SignalLaw, b: SignalLaw) -> SignalLaw:
        """Return the law of a difference."""
        return plus(a, scaled(b, -1.0))

    def multiply(self, a: SignalLaw, b: SignalLaw) -> SignalLaw:
        """Return the law of a product."""
        return times(a, b)

    def divide(self, a: SignalLaw, b: SignalLaw) -> SignalLaw:
        """Return the law of a quotient."""
        return over(a, b)

    def limit(self, x: SignalLaw, low: float, high: float) -> SignalLaw:
        """Return it unchanged: limits of drives are judged from the records."""
        return x

    def rate_limited(self, x: SignalLaw, before: SignalLaw, most: float) -> SignalLaw:
        """Return it unchanged."""
        return x

    # --- sources ---

    def source(self, update: Update[SignalLaw]) -> SignalLaw:
        """Return a curve of its signal, or else a new source."""
        of = update.source
        curve = self._curve(update)
        if curve is not None:
            law = curved(curve, update.x, exact=bool(self.question.form))
            if law.gains and law.gains == dict.fromkeys(law.gains, NOTHING):
                self.notes.flat.append(source_name(of))
            return law
        name = self.case.name_of(of)
        self.case.remember(name, of, None if update.kind.ports else update.x)
        at = self.question.at.get(name, NOTHING)
        along: Interval | str
        if not self.question.form or at == NOTHING:
            along = NOTHING
        elif set(self.question.form) == {name}:
            along = Interval(1.0 / self.question.form[name], 1.0 / self.question.form[name])
        else:
            along = f"'{name}' is one part of the sum only"
        hole = "" if update.kind.ports else update.x.hole
        return SignalLaw(at, NOTHING, {name: ONE}, {name: ONE}, {name: 1.0}, along, hole=hole)

    def _curve(self, update: Update[SignalLaw]) -> Node | None:
        """Return a source as an expression over ``x``, if it has no memory."""
        kind = update.kind
        if kind.of != "signal" or kind.states or kind.function is None:
            return None
        numbers = {"period": update.period.every}
        for name, law in update.settings.items():
            if law.constant is not None:
                numbers[name] = law.constant
        root = specialise(kind.expression, numbers)
        return root if set(symbols(root)) <= {"x"} else None

    def zoom(
        self, line: Zoom, signals: Mapping[str, SignalLaw], by: SignalLaw, inside: SignalLaw
    ) -> dict[str, SignalLaw]:
        """Return magnified signals, with their slopes inside the window only."""
        return {name: self._zoomed(law, by, inside) for name, law in signals.items()}

    def _zoomed(self, law: SignalLaw, by: SignalLaw, inside: SignalLaw) -> SignalLaw:
        factor, window = by.constant, inside.constant
        if factor is None or window is None or law.rest != NOTHING:
            return unknown(EVERYTHING, "signals are magnified where they are not 0 at rest")
        inner = overlap(law.at, symmetric(window))
        large = scaled(law, factor)
        along = law.along
        if isinstance(along, Interval) and isinstance(large.along, Interval):
            along = hull(along, large.along)
        at = hull(law.at, combine("multiply", inner, Interval(factor, factor)))
        return replace(large, at=at, linear=None, along=along)

    # --- rule bases ---

    def called(self, call: Call[SignalLaw]) -> list[SignalLaw]:
        """Return the laws of a rule base or a table."""
        assert isinstance(call.line, SignalLine)
        assert call.line.source is not None
        if call.line.source.kind != "rules":
            return [self._table(call)]
        sheet = call.sheet
        if not isinstance(sheet, RuleBase):
            return [unknown(EVERYTHING, f"'{call.name}' could not be read")] * len(call.line.names)
        laws = call.inputs(input_names(sheet))
        self._note_group(laws)
        return [self._conclusion(sheet, output.name, laws) for output in sheet.outputs]

    def learn(self, lesson: Lesson[SignalLaw]) -> None:
        """Ignore it: a learning table is unknown at its look-up."""

    def _note_group(self, laws: Mapping[str, SignalLaw]) -> None:
        sources: dict[str, None] = {}
        for law in laws.values():
            sources.update(dict.fromkeys(law.linear or {}))
        if len(sources) > 1:
            self.notes.groups.append(tuple(sources))

    def _conclusion(
        self, rulebase: RuleBase, output: str, laws: Mapping[str, SignalLaw]
    ) -> SignalLaw:
        prover = self.case.prover(rulebase, output)
        if self.case.only_values:
            inputs = {name: 0.5 * law.at.low + 0.5 * law.at.high for name, law in laws.items()}
            value = float(infer(with_nan_for_no_rule(rulebase), inputs)[output])
            return unknown(Interval(value, value), "")
        region = {}
        for variable in prover.inputs:
            at = laws[variable.name].at
            universe = Interval(variable.low, variable.high)
            self._note_zone(laws[variable.name], universe)
            if variable.outside != "extend":
                at = snapped(at, universe)
            region[variable.name] = (at.low, at.high)
        at = self._range(prover, region, laws)
        try:
            slopes = slopes_at(prover, {name: only_value(law.rest) for name, law in laws.items()})
        except FuzzyarmError as error:
            rest = {name: tuple(law.rest) for name, law in laws.items()}
            law = SignalLaw(at, self._range(prover, rest, {}), str(error), str(error), None, "")
        else:
            value = float(slopes.value)
            gains, around = _chained(slopes, laws)
            law = SignalLaw(at, Interval(value, value), gains, around, None, "")
        along, slack = self._along_rules(prover, region, laws, law.rest)
        hole = self._hole(prover, region, laws)
        return replace(law, along=along, slack=slack, hole=hole)

    def _hole(
        self, prover: Prover, region: Mapping[str, Any], laws: Mapping[str, SignalLaw]
    ) -> str:
        """Return where a conclusion is not a number, or why that is open."""
        for variable in prover.inputs:
            law = laws[variable.name]
            if law.hole:
                return law.hole
            universe = Interval(variable.low, variable.high)
            if variable.outside == "error" and not inside(law.at, universe):
                return f"'{variable.name}' may leave its universe, where there is no value"
        return self.case.hole(prover, region)

    def _note_zone(self, law: SignalLaw, universe: Interval) -> None:
        """Record the range of a source that keeps its input in the universe."""
        if law.linear is None or len(law.linear) != 1 or not math.isfinite(largest(universe)):
            return
        ((name, weight),) = law.linear.items()
        if weight:
            # An input weight · source stays in its universe while the source stays in this range.
            zone = combine("divide", universe, Interval(weight, weight))
            interval = self.notes.zones.get(name)
            self.notes.zones[name] = zone if interval is None else overlap(interval, zone)

    def _range(
        self, prover: Prover, region: Mapping[str, Any], laws: Mapping[str, SignalLaw]
    ) -> Interval:
        """Return the range of a conclusion; that of the whole output without a tighter bound."""
        output = prover.output
        whole = Interval(output.low, output.high) if prover.stays_inside else EVERYTHING
        if prover.no_rule is not None:
            whole = hull(whole, Interval(prover.no_rule, prover.no_rule))
        bounds = self.case.value(prover, region)
        if bounds is None:
            return whole
        if output.outside != "extend":
            bounds = bounds._replace(
                low=max(bounds.low, whole.low), high=min(bounds.high, whole.high)
            )
        for extreme in (bounds.at_low, bounds.at_high):
            self._note_point(extreme, laws)
        return Interval(bounds.low, bounds.high)

    def _note_point(self, point: Mapping[str, float], laws: Mapping[str, SignalLaw]) -> None:
        """Record the sources at an extreme of a rule base."""
        values: dict[str, float] = {}
        for name, law in laws.items():
            if law.linear is None or len(law.linear) != 1 or name not in point:
                return
            ((source, weight),) = law.linear.items()
            if not weight:
                return
            values.setdefault(source, point[name] / weight)
        self.notes.points.append(values)

    def _along_rules(
        self,
        prover: Prover,
        region: Mapping[str, tuple[float, float]],
        laws: Mapping[str, SignalLaw],
        rest: Interval,
    ) -> tuple[Interval | str, float]:
        if not self.question.form:
            return "", 0.0
        moving = [name for name, law in laws.items() if law.at.low < law.at.high]
        if not moving:
            size = largest(rest)
            small = size <= LIKE_EXPECT * prover.range
            return (NOTHING, size) if small else ("it is not 0 at rest", 0.0)
        result = self._weights(moving, laws)
        if isinstance(result, str):
            return result, 0.0
        weights, by = result
        try:
            sector = self.case.sector(prover, weights, region)
        except FuzzyarmError as error:
            return str(error), 0.0
        gains = Interval(sector.low, sector.high)
        universe = {
            variable.name: Interval(variable.low, variable.high) for variable in prover.inputs
        }
        beyond = [name for name in moving if not inside(laws[name].at, universe[name])]
        has_value = all(prover.rulebase.variable(n).outside != "error" for n in beyond)
        if beyond and (len(moving) > 1 or not has_value):
            then = "" if has_value else ", where there is no value"
            return f"an input leaves its universe{then}", 0.0
        if beyond:
            gains = hull(gains, NOTHING)  # a clamped input has the slope 0
        return combined("multiply", gains, by), sector.slack

    def _weights(
        self, moving: Sequence[str], laws: Mapping[str, SignalLaw]
    ) -> tuple[dict[str, Fraction], Interval] | str:
        """Return a sum of a rule base's inputs, and its sector over σ.

        A single input has the sector of its law; of several each is a multiple of one source of σ.
        """
        if len(moving) == 1:
            along = laws[moving[0]].along
            return along if isinstance(along, str) else ({moving[0]: Fraction(1)}, along)
        weights: dict[str, Fraction] = {}
        remaining = dict(self.question.form)
        for name in moving:
            linear = {s: w for s, w in (laws[name].linear or {}).items() if s in self.question.form}
            if len(linear) != 1 or next(iter(linear)) not in remaining:
                return f"'{name}' is not a multiple of one source"
            ((source, weight),) = linear.items()
            weights[name] = Fraction(remaining.pop(source)) / Fraction(weight)
        if remaining:
            return "it depends on a part of the sum only"
        # Normalised: the first input has weight 1, its own weight goes into the gain.
        base = weights[moving[0]]
        by = combined("divide", ONE, Interval(float(base), float(base)))
        return {name: _simple(weight / base) for name, weight in weights.items()}, by

    # --- tables ---

    def _table(self, call: Call[SignalLaw]) -> SignalLaw:
        if not isinstance(call.sheet, LookupTable):
            return unknown(EVERYTHING, f"'{call.name}' could not be read")
        try:
            table = call.lattice()
        except SourceError as error:
            return unknown(EVERYTHING, str(error))
        at = Interval(float(table.values.min()), float(table.values.max()))
        if call.learner is not None:
            bound = largest(call.period.operand(call.learner.bound).at)
            return unknown(hull(at, symmetric(bound)), f"'{call.name}' learns")
        laws = call.inputs(table.names)
        self._note_group(laws)
        for axis in table.axes:
            self._note_zone(laws[axis.name], Interval(axis.low, axis.high))
        if all(law.at.low == law.at.high for law in laws.values()):
            value = float(table.lookup(*(law.at.low for law in laws.values())))
            at = Interval(value, value)
        return table_law(table, laws, at, exact=bool(self.question.form))


def _chained(slopes: Slopes, laws: Mapping[str, SignalLaw]) -> tuple[Gains | str, Gains | str]:
    """Return slopes by sources from slopes by inputs."""
    sources: dict[str, None] = {}
    for law in laws.values():
        for part in (law.gains, law.around):
            if isinstance(part, str):
                return part, part
            sources.update(dict.fromkeys(part))
    gains: Gains = {}
    around: Gains = {}
    for source in sources:
        total = NOTHING
        for name, law in laws.items():
            assert isinstance(law.around, dict)
            gain = Interval(*map(float, slopes.around(name)))
            # Chain rule, over all pieces around rest.
            slope = combine("multiply", gain, law.around.get(source, NOTHING))
            total = combine("add", total, slope)
        around[source] = gains[source] = total
        inner = {name: dict(law.gains).get(source, NOTHING) for name, law in laws.items()}  # type: ignore[arg-type]
        # If each input has one slope by the source, the source moves along a line: two pieces, one
        # ahead and one back.
        if all(interval.low == interval.high for interval in inner.values()):
            ways = {name: Fraction(interval.low) for name, interval in inner.items()}
            ahead = slopes.along(ways)
            back = slopes.along({name: -way for name, way in ways.items()})
            values = [float(x) for x in (ahead, None if back is None else -back) if x is not None]
            if values:
                gains[source] = Interval(min(values), max(values))
    return gains, around


def _simple(ratio: Fraction) -> Fraction:
    """Return a ratio of floats as the nearest small fraction, if there is one."""
    near = ratio.limit_denominator(10**6)
    return near if abs(near - ratio) <= abs(ratio) / 10**12 else ratio


def source_name(of: Source, *, whole: bool = False) -> str:
    """Return a source's name in verdicts, with all its options or its weight."""
    if of.kind == CHOICE.name:
        return choice_text(of)
    settings = [(word, value) for word, value in of.options if whole or word == "weight"]
    words = "".join(f", {word} {_setting_words(of, word, value)}" for word, value in settings)
    return f"{of.kind}{of.record.joined} {of.name}{words}"


def _setting_words(of: Source, word: str, value: Setting) -> str:
    if isinstance(value, Chosen):
        return chosen_text(value)
    if isinstance(value, tuple):
        return " .. ".join(f"{end:g}" for end in value)
    seconds = isinstance(value, float) and of.record.options[word].accepts in ("time", "windup")
    return f"{value:g} s" if seconds else str(value)


def _names_of(sources: Iterable[Source]) -> dict[Source, str]:
    """Return a unique name for each source, options included."""
    short = Counter(map(source_name, dict.fromkeys(sources)))
    return {of: source_name(of, whole=short[source_name(of)] > 1) for of in sources}
