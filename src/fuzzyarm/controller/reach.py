"""Where each signal of a controller can be: intervals from the ports on, line by line.

The walk is that of :mod:`fuzzyarm.controller.program`, with intervals in place of cells. It is
safe, not tight: signals count as independent. What nothing bounds reaches everywhere.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce

from fuzzyarm.controller.on_plant import Site
from fuzzyarm.controller.program import AXIS, Sheet, SourceError, of_axis
from fuzzyarm.controller.text import ControllerText, input_names
from fuzzyarm.controller.updates import range_of_source
from fuzzyarm.expression.operations import EVERYTHING, OPERATIONS, Interval
from fuzzyarm.expression.sources import Surroundings
from fuzzyarm.model.controller import (
    Axes,
    Drive,
    Factor,
    Learn,
    Line,
    Product,
    SignalLine,
    Source,
    Zoom,
)
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.model.units import Unit, described_unit, of_difference, product, read_unit
from fuzzyarm.plant.plant import Address
from fuzzyarm.text.diagnostic import Span

FED_BACK, PORT, MADE = 3, 2, 1
"""What keeps a signal within its universe: the loop itself (errors and rates, which a loop that
works keeps small), its plant (measured and reference values), or the text alone."""


@dataclass(frozen=True)
class Reach:
    """Where a signal can be.

    Attributes
    ----------
    at : Interval
        All its values.
    pace : float
        Largest change per second, as far as the plant says how fast a port moves. The jumps of a
        reference are left out.
    kept : int
        What keeps it small: `FED_BACK`, `PORT` or `MADE`.
    unit : dict or None
        None where it is not certain.
    origins : frozenset of str
        The values that it is made of.
    tight : bool
        Whether it can go to the ends: false for a sum of which two parts have an origin in common,
        as ``r - lag``, which may cancel.
    scaled : bool
        Whether a gain with a unit is among its factors.
    """

    at: Interval = EVERYTHING
    pace: float = math.inf
    kept: int = MADE
    unit: Unit | None = None
    origins: frozenset[str] = frozenset()
    tight: bool = True
    scaled: bool = False


@dataclass(frozen=True)
class LookUp:
    """A signal that goes into a rule base or a table.

    Attributes
    ----------
    sheet, signal : str
        Their names.
    universe : Interval
        What the rule base or the table tells apart.
    sheet_unit : dict or None
        The unit that the input has by its description; None where that says none.
    line : SignalLine or Learn
        Where.
    """

    axes: Axes
    sheet: str
    signal: str
    reach: Reach
    universe: Interval
    sheet_unit: Unit | None
    line: SignalLine | Learn


@dataclass(frozen=True)
class Meeting:
    """A product in which a unit meets one of its kind: `name` is the factor that brings it.

    `option` says what it is where it is not a factor: then all of the unit has to cancel.
    """

    name: str
    reach: Unit
    brought: Unit
    span: Span
    option: str = ""


@dataclass
class Reaches:
    """What the walk found.

    Attributes
    ----------
    signals : dict
        By axis and name.
    sources : dict
        By axis and source, what comes from ports and memory, before factors.
    look_ups : list of LookUp
        In the order of the text.
    drives : dict
        By axis and port, its lines and where each can be, limits included.
    meetings : list of Meeting
        Products of units, by which gains are judged.
    """

    signals: dict[tuple[str, str], Reach] = field(default_factory=dict)
    sources: dict[tuple[str, Source], Reach] = field(default_factory=dict)
    look_ups: list[LookUp] = field(default_factory=list)
    drives: dict[Address, list[tuple[Drive, Reach]]] = field(default_factory=dict)
    meetings: list[Meeting] = field(default_factory=list)


def reaches_of(text: ControllerText, site: Site | None) -> Reaches:
    """Walk over the lines of a controller.

    Parameters
    ----------
    text : ControllerText
        With the rule bases and tables that could be read.
    site : Site or None
        The plant, where it is known.
    """
    walk = _LineWalk(text, site)
    for axes in text.model.axes:
        for name in axes.names:
            walk.axis = name
            for line in axes.lines:
                walk.line(axes, line)
            walk.index += 1
    return walk.reaches


def combine(operation: str, a: Interval, b: Interval) -> Interval:
    """Return the bounds of an operation."""
    return OPERATIONS[operation].bounds(a, b)


def hull(*intervals: Interval) -> Interval:
    """Return the smallest interval around some."""
    return Interval(
        min(interval.low for interval in intervals), max(interval.high for interval in intervals)
    )


def overlap(a: Interval, b: Interval) -> Interval:
    """Return what two intervals share; its ends cross where that is nothing."""
    return Interval(max(a.low, b.low), min(a.high, b.high))


def width(interval: Interval) -> float:
    """Return how wide an interval is, 0 where its ends cross."""
    return max(0.0, interval.high - interval.low)


def largest(interval: Interval) -> float:
    """Return the largest magnitude in an interval."""
    return max(abs(interval.low), abs(interval.high))


def symmetric(size: float) -> Interval:
    """Return the interval of all magnitudes up to a size."""
    return Interval(-size, size)


class _LineWalk:
    """What is known on the way; `axis` is the current one, `index` its number."""

    def __init__(self, text: ControllerText, site: Site | None) -> None:
        self.text = text
        self.site = site
        self.reaches = Reaches()
        self.gains = {gain.name: gain for gain in text.model.gains}
        self.axis = ""
        self.index = 0

    def line(self, axes: Axes, line: Line) -> None:
        """Go on by one line."""
        if isinstance(line, SignalLine):
            self._signal(axes, line)
        elif isinstance(line, Zoom):
            for name in line.signals:
                reach = self._named(name)
                window = symmetric(largest(self._number(line.inside)))
                # Within the window it is magnified; the others may be beyond theirs.
                inside = overlap(reach.at, window)
                large = combine("multiply", inside, self._number(line.by))
                whole = hull(reach.at, large) if inside.low <= inside.high else reach.at
                self.reaches.signals[self.axis, name] = replace(reach, at=whole)
        elif isinstance(line, Learn):
            self._look_up(axes, line, line.judge, line.inputs)
        else:
            reach = self._sum(line.products, line.span)
            if line.within is not None:
                reach = replace(reach, at=_clipped(reach.at, Interval(*line.within)))
            self.reaches.drives.setdefault((self.axis, line.port), []).append((line, reach))

    def _signal(self, axes: Axes, line: SignalLine) -> None:
        if line.source is None:
            reaches = [self._sum(line.products, line.span)]
        else:
            of = line.source
            values = self._results(axes, of, line)
            if of.record.of == "call":
                self._look_up(axes, line, of.name, of.inputs)
            else:
                self.reaches.sources[self.axis, of] = values[0]
            factors = line.products[0].factors if line.products else ()
            reaches = [self._times(value, factors, line.span) for value in values]
        for name, reach in zip(line.names, reaches, strict=False):
            self.reaches.signals[self.axis, name] = reach

    # --- Numbers, products, sums ---

    def _number(self, value: str | float) -> Interval:
        if not isinstance(value, str):
            return Interval(value, value)
        gain = self.gains.get(value)
        if gain is None:
            return EVERYTHING
        amount = gain.values[self.index if len(gain.values) > 1 else 0].value(math.pi)
        return Interval(amount, amount)

    def _named(self, name: str) -> Reach:
        """Return where a signal, a gain or a partner is."""
        reach = self.reaches.signals.get((self.axis, name))
        if reach is not None:
            return reach
        gain = self.gains.get(name)
        if gain is None:
            return Reach()
        unit = read_unit(gain.unit) if gain.unit else None
        return Reach(self._number(name), 0.0, MADE, unit, scaled=unit is not None)

    def _times(self, reach: Reach, factors: Sequence[Factor], span: Span) -> Reach:
        for factor in factors:
            if isinstance(factor.value, str):
                other = self._named(factor.value)
            else:
                other = Reach(self._number(factor.value), 0.0, MADE, {})
            word = "divide" if factor.divides else "multiply"
            power = -1 if factor.divides else 1
            at = combine(word, reach.at, other.at)
            pace = math.inf
            # A product moves with its only factor that does; of two that move nothing is known.
            if other.pace == 0.0:
                pace = largest(combine(word, symmetric(reach.pace), other.at))
            elif reach.pace == 0.0 and not factor.divides:
                pace = largest(combine(word, symmetric(other.pace), reach.at))
            if isinstance(factor.value, str) and reach.unit is not None and other.unit is not None:
                brought = product({}, other.unit, power) or {}
                self.reaches.meetings.append(Meeting(factor.value, reach.unit, brought, span))
            unit = product(reach.unit, other.unit, power)
            origins = reach.origins | other.origins
            tight = reach.tight and other.tight
            scaled = reach.scaled or other.scaled
            reach = Reach(at, pace, max(reach.kept, other.kept), unit, origins, tight, scaled)
        return reach

    def _sum(self, products: Sequence[Product], span: Span) -> Reach:
        parts = [self._product(product, span) for product in products]
        units = [part.unit for part in parts]
        origins = frozenset[str]().union(*(part.origins for part in parts))
        # Two parts with an origin in common may cancel.
        alone = len(origins) == sum(len(part.origins) for part in parts)
        return Reach(
            reduce(lambda a, b: combine("add", a, b), [part.at for part in parts]),
            sum(part.pace for part in parts),
            max(part.kept for part in parts),
            units[0] if all(unit == units[0] for unit in units) else None,
            origins,
            alone and all(part.tight for part in parts),
            any(part.scaled for part in parts),
        )

    def _product(self, part: Product, span: Span) -> Reach:
        first, *others = part.factors
        if isinstance(first.value, str):
            begin = self._named(first.value)
        else:
            begin = Reach(self._number(first.value), 0.0, MADE, {})
        reach = self._times(begin, others, span)
        if part.negative:
            reach = replace(reach, at=Interval(-reach.at.high, -reach.at.low))
        return reach

    # --- Sources ---

    def _results(self, axes: Axes, of: Source, line: SignalLine) -> list[Reach]:
        kind = of.record
        if kind.of != "call":
            reach = self._port(of) if kind.ports else self._named(of.name)
            self._meet_options(of, reach, line.span)
            return [self._updated(of, reach)]
        if of.kind == "rules":
            reaches = self._conclusions(of.name) or [Reach()] * len(line.names)
        else:
            reaches = [self._values(axes, of.name)]
        return [replace(result, origins=_own(of)) for result in reaches]

    def _meet_options(self, of: Source, reach: Reach, span: Span) -> None:
        """Note gains that have to be in the unit of what a source is taken of."""
        for word, value in of.options:
            if not isinstance(value, str) or not of.record.options[word].alike:
                continue
            unit = self._named(value).unit
            if unit is not None and reach.unit is not None:
                before, brought = of_difference(reach.unit), product({}, of_difference(unit), -1)
                words = f"the {word} of {of.kind}"
                self.reaches.meetings.append(
                    Meeting(value, before or {}, brought or {}, span, words)
                )

    def _updated(self, of: Source, reach: Reach) -> Reach:
        """Return where a source is that is taken of something."""
        kind = of.record
        if kind.function is None:
            return reach
        options = dict(of.options)
        near = Surroundings(
            reach.at, reach.pace, self.text.model.period, self.text.model.every, options
        )
        settings = {name: self._number(value) for name, value in kind.settings(options).items()}
        unit = of_difference(reach.unit) if kind.difference else reach.unit
        bounds = Reach(
            range_of_source(kind, near, settings, kind.starts(options)),
            math.inf if kind.pace is None else kind.pace(near),
            unit=product(unit, {"s": kind.seconds}),
            scaled=reach.scaled,
        )
        if kind.kept == "signal":
            return replace(bounds, kept=reach.kept, origins=reach.origins, tight=reach.tight)
        kept_by = FED_BACK if kind.kept == "loop" else MADE
        # What the text alone keeps small goes wherever it can.
        return replace(bounds, kept=kept_by, origins=_own(of), tight=kept_by == MADE or reach.tight)

    def _port(self, of: Source) -> Reach:
        """Return where a value of a port is, or its error."""
        ports = of.record.ports
        if len(ports) == 1:
            return self._of_port(ports[0], of.name)
        measured, reach = self._of_port("measured", of.name), self._of_port("reference", of.name)
        weight = of.option("weight")
        share = self._number(weight) if isinstance(weight, str | float) else Interval(1.0, 1.0)
        interval = combine("multiply", reach.at, share)
        unit = of_difference(measured.unit)
        both = reach.origins | measured.origins
        return Reach(
            combine("subtract", interval, measured.at), measured.pace, FED_BACK, unit, both
        )

    def _of_port(self, kind: str, name: str) -> Reach:
        """Return where a measured or reference value of the plant is."""
        origins = frozenset({f"{kind} {name}"})
        if self.site is None:
            return Reach(kept=PORT, origins=origins)
        outputs = self.site.interface.outputs
        try:
            address = self.site.find(self.text.model, kind, (self.axis, name))
        except SourceError:
            return Reach(kept=PORT, origins=origins)
        port = outputs.get(address)
        if port is None:  # a reference of an acceleration
            return Reach(kept=FED_BACK, origins=origins)
        # How fast a port moves is the range of the port that is its rate, where there is one.
        rates = [
            largest(Interval(other.low, other.high))
            for (axis, _), other in outputs.items()
            if axis == address[0] and other.rate_of == address[1]
        ]
        kept_by = FED_BACK if port.rate_of else PORT
        at, pace = Interval(port.low, port.high), min(rates, default=math.inf)
        return Reach(at, pace, kept_by, read_unit(port.unit), origins)

    # --- Rule bases and tables ---

    def _sheet(self, name: str) -> Sheet | None:
        sheets = self.text.sheets.get(name)
        return sheets[self.index if len(sheets) > 1 else 0] if sheets else None

    def _conclusions(self, name: str) -> list[Reach]:
        sheet = self._sheet(name)
        if not isinstance(sheet, RuleBase):
            return []
        reaches = []
        for output in sheet.outputs:
            at = Interval(output.low, output.high)
            if isinstance(output.no_rule, float):
                at = hull(at, Interval(output.no_rule, output.no_rule))
            reaches.append(Reach(at, unit=described_unit(output.description)))
        return reaches

    def _values(self, axes: Axes, name: str) -> Reach:
        table = self._sheet(name)
        if table is None or isinstance(table, RuleBase):
            return Reach()
        try:
            _, values = of_axis(table, self.index)
        except SourceError:
            return Reach()
        at = Interval(float(values.min()), float(values.max()))
        for line in axes.lines:
            if isinstance(line, Learn) and line.table == name:
                at = hull(at, symmetric(largest(self._number(line.bound))))
        return Reach(at)

    def _look_up(
        self, axes: Axes, line: SignalLine | Learn, name: str, inputs: Sequence[str]
    ) -> None:
        sheet = self._sheet(name)
        if sheet is None:
            return
        names = [
            input_name
            for input_name in input_names(sheet)
            if input_name != AXIS or input_name in inputs
        ]
        if len(names) != len(inputs):
            return
        for signal, input_name, universe in zip(
            inputs, names, _universes(sheet, names), strict=True
        ):
            if math.isfinite(width(universe)) and width(universe) > 0.0:
                reach = self._named(signal)
                sheet_unit = None
                if isinstance(sheet, RuleBase):
                    sheet_unit = described_unit(sheet.variable(input_name).description)
                self.reaches.look_ups.append(
                    LookUp(axes, name, signal, reach, universe, sheet_unit, line)
                )


def _own(of: Source) -> frozenset[str]:
    """Return the origin of a source that is not made of others."""
    return frozenset({f"{of.kind} {of.name} {of.inputs}"})


def _universes(sheet: Sheet, names: Sequence[str]) -> Iterator[Interval]:
    """Yield what a rule base or a table tells apart, of each input."""
    for name in names:
        if isinstance(sheet, RuleBase):
            variable = sheet.variable(name)
            beyond = variable.outside == "extend"
            yield EVERYTHING if beyond else Interval(variable.low, variable.high)
        else:
            levels = sheet.axis(name).levels
            yield Interval(levels[0], levels[-1])


def _clipped(at: Interval, limits: Interval) -> Interval:
    low = min(max(at.low, limits.low), limits.high)
    return Interval(low, max(low, min(at.high, limits.high)))
