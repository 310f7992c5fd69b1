"""The range of each signal of a controller: a control period over intervals, from the ports on.

Safe, not tight: signals count as independent. A signal without bounds has an infinite range.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce

from fuzzyarm.base.diagnostic import Span
from fuzzyarm.base.units import Unit, described_unit, of_difference, product, read_unit
from fuzzyarm.control.controllers.code import AXIS, Sheet, SourceError
from fuzzyarm.control.controllers.on_plant import Site
from fuzzyarm.control.controllers.period import (
    Algebra,
    Call,
    ControlPeriod,
    Lesson,
    PortValue,
    Remembered,
    Update,
)
from fuzzyarm.control.controllers.text import ControllerText, input_names, ports_of
from fuzzyarm.control.controllers.updates import range_of_source
from fuzzyarm.language.model.controller import (
    Axes,
    Drive,
    GainModel,
    Learn,
    SignalLine,
    Source,
    Zoom,
)
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.plant.plant import Address
from fuzzyarm.symbolic.intervals import combine, hull, largest, overlap, symmetric, width
from fuzzyarm.symbolic.operations import EVERYTHING, Interval
from fuzzyarm.symbolic.sources import Chosen, Surroundings

FED_BACK, PORT, MADE = 3, 2, 1
"""What confines a signal to its universe: the loop (errors and rates, small in a working loop), the
plant (measured and reference values), or the text alone."""


@dataclass(frozen=True)
class Reach:
    """The range of a signal.

    Attributes
    ----------
    at : Interval
        All its values.
    pace : float
        Largest rate, per second, as far as the plant's rates are known. Jumps of a reference are
        excluded.
    confined_by : int
        `FED_BACK`, `PORT` or `MADE`.
    unit : dict or None
        None if uncertain.
    origins : frozenset of str
        The port values and sources on which it depends.
    tight : bool
        Whether it can reach its ends: false for a sum of terms with a common origin, which may
        cancel, as ``r - lag``.
    scaled : bool
        Whether a gain with a unit is among its factors.
    name : str
        Name of a signal or a gain in the current line.
    plain : bool
        Whether it adopts the unit of its summands: a number of the text. For an output of rules
        without a unit, whether it adopts that of a gain such as 6 V.
    """

    at: Interval = EVERYTHING
    pace: float = math.inf
    confined_by: int = MADE
    unit: Unit | None = None
    origins: frozenset[str] = frozenset()
    tight: bool = True
    scaled: bool = False
    name: str = ""
    plain: bool = False


@dataclass(frozen=True)
class LookUp:
    """A signal used as an input of a rule base or a table.

    Attributes
    ----------
    sheet, signal : str
        Their names.
    universe : Interval
        Universe of the input.
    sheet_unit : dict or None
        Unit of the input by its description; None if unknown.
    line : SignalLine or Learn
        The line of the look-up.
    """

    axes: Axes
    sheet: str
    signal: str
    reach: Reach
    universe: Interval
    sheet_unit: Unit | None
    line: SignalLine | Learn


@dataclass(frozen=True)
class UnitProduct:
    """A product of two units of one kind: `name` is the factor with the second one.

    `option` names an option instead of a factor: then the whole unit has to cancel. Without a name
    it is a sum: its terms need one unit.
    """

    name: str
    reach: Unit
    brought: Unit
    span: Span
    option: str = ""


@dataclass
class Reaches:
    """The results of the walk.

    Attributes
    ----------
    signals : dict
        By axis and name.
    sources : dict
        By axis and source, the value from ports and memory, before factors.
    look_ups : list of LookUp
        In the order of the text.
    drives : dict
        By axis and port: its lines and their ranges, limits included.
    unit_products : list of UnitProduct
        Products of units, to judge gains.
    """

    signals: dict[tuple[str, str], Reach] = field(default_factory=dict)
    sources: dict[tuple[str, Source], Reach] = field(default_factory=dict)
    look_ups: list[LookUp] = field(default_factory=list)
    drives: dict[Address, list[tuple[Drive, Reach]]] = field(default_factory=dict)
    unit_products: list[UnitProduct] = field(default_factory=list)


def reaches_of(text: ControllerText, site: Site | None) -> Reaches:
    """Walk over the lines of a controller.

    Parameters
    ----------
    text : ControllerText
        With its readable rule bases and tables.
    site : Site or None
        The plant, if known.
    """
    return Ranges(text, site).walk()


class Ranges(Algebra[Reach]):
    """Ranges as the numbers of a control period, with notes on the way.

    Parameters
    ----------
    text : ControllerText
        The controller.
    site : Site or None
        The plant, if known.
    """

    def __init__(self, text: ControllerText, site: Site | None) -> None:
        self.text = text
        self.site = site
        self.reaches = Reaches()
        self.sent: dict[Address, list[tuple[Drive, Reach]]] = {}

    # --- numbers, products, sums ---

    def number(self, value: float) -> Reach:
        """Return the range of a number."""
        return Reach(Interval(value, value), 0.0, MADE, {}, plain=True)

    def gain(self, gain: GainModel, index: int) -> Reach:
        """Return the range of a gain."""
        amount = gain.values[index].value(math.pi)
        unit = read_unit(gain.unit) if gain.unit else None
        at = Interval(amount, amount)
        return Reach(at, 0.0, MADE, unit, scaled=unit is not None, name=gain.name)

    def unknown(self, name: str) -> Reach:
        """Return the infinite range."""
        return Reach()

    def add(self, a: Reach, b: Reach) -> Reach:
        """Return the range of a sum, and note its units."""
        known = [x.unit for x in (a, b) if x.unit is not None and not (x.plain and not x.unit)]
        if len(known) == 2 and known[0] != known[1] and (a.scaled or b.scaled):
            one, other = (of_difference(unit) or {} for unit in known)
            self.reaches.unit_products.append(
                UnitProduct("", one, product({}, other, -1) or {}, self._span)
            )
            known = []
        return Reach(
            combine("add", a.at, b.at),
            a.pace + b.pace,
            max(a.confined_by, b.confined_by),
            known[0] if known else a.unit if a.unit == b.unit else None,
            a.origins | b.origins,
            # Two parts with an origin in common may cancel.
            a.tight and b.tight and not a.origins & b.origins,
            a.scaled or b.scaled,
            plain=a.plain and b.plain,
        )

    def negated(self, x: Reach) -> Reach:
        """Return the mirrored range."""
        return replace(x, at=Interval(-x.at.high, -x.at.low))

    def subtract(self, a: Reach, b: Reach) -> Reach:
        """Return the range of a difference."""
        return self.add(a, self.negated(b))

    def multiply(self, a: Reach, b: Reach) -> Reach:
        """Return the range of a product."""
        return self._times(a, b, "multiply")

    def divide(self, a: Reach, b: Reach) -> Reach:
        """Return the range of a quotient."""
        return self._times(a, b, "divide")

    def _times(self, a: Reach, b: Reach, word: str) -> Reach:
        power = -1 if word == "divide" else 1
        a, b = _of_gain(a, b), b if power < 0 else _of_gain(b, a)
        pace = math.inf
        # A product with one varying factor varies with it; with two, its rate is unknown.
        if b.pace == 0.0:
            pace = largest(combine(word, symmetric(a.pace), b.at))
        elif a.pace == 0.0 and word == "multiply":
            pace = largest(combine(word, symmetric(b.pace), a.at))
        if b.name and a.unit is not None and b.unit is not None:
            brought = product({}, b.unit, power) or {}
            self.reaches.unit_products.append(UnitProduct(b.name, a.unit, brought, self._span))
        return Reach(
            combine(word, a.at, b.at),
            pace,
            max(a.confined_by, b.confined_by),
            product(a.unit, b.unit, power),
            a.origins | b.origins,
            a.tight and b.tight,
            a.scaled or b.scaled,
            plain=a.plain and b.plain,
        )

    @property
    def _span(self) -> Span:
        return self.period.line.span

    def limit(self, x: Reach, low: float, high: float) -> Reach:
        """Return a range between limits."""
        return replace(x, at=_clipped(x.at, Interval(low, high)))

    def rate_limited(self, x: Reach, before: Reach, most: float) -> Reach:
        """Return x unchanged: a slew limit reaches every value in time."""
        return x

    # --- notes ---

    def walk(self) -> Reaches:
        """Walk over all lines."""
        self.period = ControlPeriod(self.text, self)
        ports = (
            PortValue(kind, *address)
            for kind in ("reference", "measured")
            for address in ports_of(self.text.model, kind)
        )
        given = {value: self._of_port(value) for value in ports}
        self.period.run(given, {})
        if any(ports_of(self.text.model, "driven")):  # infinite at first
            self.sent, self.reaches = self.reaches.drives, Reaches()
            self.period.run(given, {})
        return self.reaches

    def begins(self, cell: Remembered) -> Reach:
        """Return the range of a memory; of a sent value, that of the drive and its start."""
        if cell.what != "last":
            return super().begins(cell)
        drives = [reach for _, reach in self.sent.get((cell.axis, cell.of), [])]
        if not drives:
            return Reach()
        sent = reduce(self.add, drives)
        return replace(sent, at=hull(sent.at, Interval(cell.start, cell.start)))

    def signal(self, axis: str, name: str, value: Reach, *, rounded: bool = True) -> Reach:
        """Note a signal."""
        self.reaches.signals[axis, name] = replace(value, name="")
        return replace(value, name=name)

    def drive(self, axis: str, line: Drive, value: Reach) -> Reach:
        """Note a drive."""
        if isinstance(line.on_nan, float):  # the value in a skipped period
            sent = hull(value.at, Interval(line.on_nan, line.on_nan))
        else:
            sent = value.at
        drives = self.reaches.drives.setdefault((axis, line.port), [])
        drives.append((line, replace(value, at=sent)))
        return value

    # --- sources ---

    def port_error(self, reference: Reach, measured: Reach, weight: Reach | None) -> Reach:
        """Return the range of an error; its pace excludes jumps of a reference."""
        share = Interval(1.0, 1.0) if weight is None else weight.at
        at = combine("subtract", combine("multiply", reference.at, share), measured.at)
        origins = reference.origins | measured.origins
        return Reach(at, measured.pace, FED_BACK, of_difference(measured.unit), origins)

    def source(self, update: Update[Reach]) -> Reach:
        """Return the range of a source, by its record."""
        self._note_option_units(update)
        reach = self._updated(update)
        self.reaches.sources[self.period.axis, update.source] = reach
        return reach

    def _note_option_units(self, update: Update[Reach]) -> None:
        """Note gains that need the unit of a source's operand."""
        unit = update.x.unit
        for word, option in update.source.options:
            value = option.value if isinstance(option, Chosen) else option
            if not isinstance(value, str) or not update.kind.options[word].alike:
                continue
            own = self.period.operand(value).unit
            if own is not None and unit is not None:
                before, brought = of_difference(unit), product({}, of_difference(own), -1)
                words = f"the {word} of {update.source.kind}"
                self.reaches.unit_products.append(
                    UnitProduct(value, before or {}, brought or {}, self._span, words)
                )

    def _updated(self, update: Update[Reach]) -> Reach:
        kind, reach, options = update.kind, update.x, dict(update.source.options)
        if kind.function is None:
            return reach
        model = self.text.model
        period = self.period.every
        near = Surroundings(reach.at, reach.pace, period, model.every, options)
        settings = {name: value.at for name, value in update.settings.items()}
        unit = of_difference(reach.unit) if kind.difference else reach.unit
        if kind.dimensionless:
            unit = {}  # levels are plain numbers
        bounds = Reach(
            range_of_source(kind, near, settings, kind.starts(options)),
            math.inf if kind.pace is None else kind.pace(near),
            unit=product(unit, {"s": kind.seconds}),
            scaled=reach.scaled,
            plain=kind.dimensionless,
        )
        if kind.bounded_by == "signal":
            return replace(
                bounds, confined_by=reach.confined_by, origins=reach.origins, tight=reach.tight
            )
        confined_by = FED_BACK if kind.bounded_by == "loop" else MADE
        # A signal bounded by the text alone is assumed to use its whole range.
        tight = confined_by == MADE or reach.tight
        return replace(bounds, confined_by=confined_by, origins=_own(update.source), tight=tight)

    def _of_port(self, value: PortValue) -> Reach:
        """Return the range of a measured or reference value of the plant."""
        address = value.axis, value.port
        origins = frozenset({f"{value.kind} {value.port}"})
        if self.site is None:
            return Reach(confined_by=PORT, origins=origins)
        outputs = self.site.interface.outputs
        try:
            address = self.site.find(self.text.model, value.kind, address)
        except SourceError:
            return Reach(confined_by=PORT, origins=origins)
        port = outputs.get(address)
        if port is None:  # a reference of an acceleration
            return Reach(confined_by=FED_BACK, origins=origins)
        # The rate of a port is bounded by the range of its rate port, if any.
        rates = [
            largest(Interval(other.low, other.high))
            for (axis, _), other in outputs.items()
            if axis == address[0] and other.rate_of == address[1]
        ]
        confined_by = FED_BACK if port.rate_of else PORT
        at, pace = Interval(port.low, port.high), min(rates, default=math.inf)
        return Reach(at, pace, confined_by, read_unit(port.unit), origins)

    # --- signals that are magnified together ---

    def zoom(
        self, line: Zoom, signals: Mapping[str, Reach], by: Reach, inside: Reach
    ) -> dict[str, Reach]:
        """Return the ranges of magnified signals."""
        window = symmetric(largest(inside.at))
        magnified = {}
        for name, reach in signals.items():
            # Inside the window it is magnified, unless another signal is outside.
            near = overlap(reach.at, window)
            large = combine("multiply", near, by.at)
            whole = hull(reach.at, large) if near.low <= near.high else reach.at
            magnified[name] = replace(reach, at=whole)
        return magnified

    # --- rule bases and tables ---

    def called(self, call: Call[Reach]) -> list[Reach]:
        """Return the ranges of a rule base or a table."""
        self._look_up(call)
        assert isinstance(call.line, SignalLine)
        source = call.line.source
        assert source is not None
        if source.kind == "rules":
            reaches = _conclusions(call.sheet) or [Reach()] * len(call.line.names)
        else:
            reaches = [self._values(call)]
        return [replace(result, origins=_own(source)) for result in reaches]

    def learn(self, lesson: Lesson[Reach]) -> None:
        """Note the look-up in the performance table."""
        self._look_up(lesson.judge)

    def _values(self, call: Call[Reach]) -> Reach:
        try:
            values = call.lattice().values
        except SourceError:
            return Reach()
        at = Interval(float(values.min()), float(values.max()))
        if call.learner is not None:
            at = hull(at, symmetric(largest(self.period.operand(call.learner.bound).at)))
        return Reach(at)

    def _look_up(self, call: Call[Reach]) -> None:
        sheet = call.sheet
        if sheet is None:
            return
        names = [name for name in input_names(sheet) if name != AXIS or name in call.signals]
        if len(names) != len(call.signals):
            return
        for signal, reach, name, universe in zip(
            call.signals, call.arguments, names, _universes(sheet, names), strict=True
        ):
            if math.isfinite(width(universe)) and width(universe) > 0.0:
                sheet_unit = None
                if isinstance(sheet, RuleBase):
                    sheet_unit = described_unit(sheet.variable(name).description)
                axes = self.period.axes
                self.reaches.look_ups.append(
                    LookUp(axes, call.name, signal, reach, universe, sheet_unit, call.line)
                )


def _conclusions(sheet: Sheet | None) -> list[Reach]:
    """Return the ranges of the outputs of a rule base."""
    reaches = []
    for output in sheet.outputs if isinstance(sheet, RuleBase) else ():
        at = Interval(output.low, output.high)
        if isinstance(output.no_rule, float):
            at = hull(at, Interval(output.no_rule, output.no_rule))
        unit = described_unit(output.description)
        reaches.append(Reach(at, unit=unit, plain=unit is None))
    return reaches


def _of_gain(x: Reach, gain: Reach) -> Reach:
    """Return an output of rules as a dimensionless number, if a gain such as 6 V has its unit."""
    gives = x.plain and x.unit is None and gain.scaled and min((gain.unit or {"": 0}).values()) > 0
    return replace(x, unit={}) if gives else x


def _own(of: Source) -> frozenset[str]:
    """Return the origin of a source that depends on no other."""
    return frozenset({f"{of.kind} {of.name} {of.inputs}"})


def _universes(sheet: Sheet, names: Sequence[str]) -> Iterator[Interval]:
    """Yield the universe of each input of a rule base or a table."""
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
