"""The linear opponent of every tuned rule base: planes in place of rules, tuned on the same cost.

It is the controller with each rule base replaced by the nearest plane, clipped to the range of its
output; without rules, the linear controller named by the plant. For samples it is linear
regression.

It has every freedom of the file. Each slope moves, as peaks do; gains movable in the file are
movable here in their range, unless equivalent to a slope; so are the limits of an output and its
middle value, where peaks may change these.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.control.controllers.code import Sheet
from fuzzyarm.control.controllers.text import ControllerText, read_controller
from fuzzyarm.inference import infer
from fuzzyarm.inference.errors import InferenceError
from fuzzyarm.language.model.controller import (
    Amount,
    Axes,
    ControllerModel,
    Factor,
    GainModel,
    Learn,
    Line,
    Product,
    SignalLine,
    Source,
    Zoom,
)
from fuzzyarm.language.model.rulebase import (
    Consequent,
    Defuzzifier,
    GainTuning,
    Input,
    Is,
    Output,
    PeakTuning,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
    Tuning,
)
from fuzzyarm.learning.tuning.design import blocks_of, gain_ranges
from fuzzyarm.learning.tuning.movement import TuneError
from fuzzyarm.plant.plant import Plant

NAME = "linear PD"
"""Its name in reports."""

SPAN = 50.0
"""Gains of the opponent move between 1/50 and 50 times their first values."""


def opponent(
    text: ControllerText, plant: Plant, tuning: Tuning | None = None
) -> tuple[ControllerText, Tuning]:
    """Return the linear controller to beat, and its ``tune`` lines."""
    try:
        return straightened(text, tuning)
    except TuneError:
        if not plant.particulars.opponent:
            raise
    file, *names = plant.particulars.opponent
    slopes = GainTuning(tuple(names), 1.0 / SPAN, SPAN, times=True, per_axis=True)
    return read_controller(shipped(file)), Tuning((), (slopes,))


def straightened(
    text: ControllerText, tuning: Tuning | None = None
) -> tuple[ControllerText, Tuning]:
    """Return a controller with a plane in place of each rule base, and its movable numbers."""
    model, planes = text.model, _Planes(text, tuning)
    axes = []
    for part in model.axes:
        lines: list[Line] = []
        for line in part.lines:
            lines += planes.lines_for(line, part) if _is_rules(line) else [line]
        axes.append(replace(part, lines=tuple(lines)))
    if not planes.moving:
        hint = "leave the linear controller out (--no-linear)"
        rules = any(_is_rules(line) for part in model.axes for line in part.lines)
        message = (
            "no rule base of the controller has a plane near it"
            if rules
            else "the controller has no rules to be replaced by a plane"
        )
        raise TuneError(message, name=model.name, hint=hint)
    controller: ControllerModel = replace(
        model,
        axes=tuple(axes),
        gains=(*model.gains, *planes.gains.values()),
        name=f"linear {model.name}",
    )
    moving = (*planes.moving, *planes.others())
    return replace(text, model=controller, sheets=planes.sheets, path=""), Tuning((), moving)


def _is_rules(line: Line) -> bool:
    return isinstance(line, SignalLine) and line.source is not None and line.source.kind == "rules"


class _Planes:
    """The lines that replace rules, their gains, and the movable ones.

    Parameters
    ----------
    text : ControllerText
        With rules.
    tuning : Tuning, optional
        Replaces the ``tune`` lines of the file.
    """

    def __init__(self, text: ControllerText, tuning: Tuning | None) -> None:
        self.model = text.model
        self.sheets: dict[str, tuple[Sheet, ...]] = dict(text.sheets)
        self.blocks = blocks_of(text, tuning)
        self.ranges = gain_ranges(text.model, self.blocks.values(), with_file_ranges=tuning is None)
        self.scaling = _scaling_gains(text.model)
        self.gains: dict[str, GainModel] = {}
        self.moving: list[GainTuning] = []
        self._spoken_for: set[str] = set()
        self.part = text.model.axes[0]

    def lines_for(self, line: Line, part: Axes) -> Iterator[Line]:
        """Yield lines for the signals of a rule base: sums, and their limits."""
        self.part = part
        assert isinstance(line, SignalLine)
        assert line.source is not None
        sheet, inputs = line.source.name, line.source.inputs
        rulebase = self.sheets[sheet][0]
        if not isinstance(rulebase, RuleBase) or len(inputs) != len(rulebase.inputs):
            raise TuneError(f"'{sheet}' is not the same for all axes", name=line.names[0])
        for name, output in zip(line.names, rulebase.outputs, strict=True):
            slopes, constant = nearest_plane(rulebase, output.name)
            products = [
                Product((Factor(self._slope(name, signal, slope)), Factor(signal)))
                for signal, slope in zip(inputs, slopes, strict=True)
                if slope != 0.0
            ]
            # An odd rule base has no offset; one whose peaks may become asymmetric gets one that
            # moves.
            lopsided = not all(peaks.mirrored for peaks in self._peaks(sheet))
            if constant != 0.0 or not products or lopsided:
                offset = self._offset(name, output, constant, moves=bool(products))
                products.append(Product((Factor(offset),)))
            plane, cut = f"plane of {name}", self._named(f"cut of {name}")
            yield SignalLine((plane,), None, tuple(products), line.span)
            self.sheets[cut] = (cut_off(output),)
            # Where output peaks may scale the output and no gain does, the limit of the plane moves
            # instead.
            factors = line.products
            movable = {variable for peaks in self._peaks(sheet) for variable in peaks.variables}
            if output.name in movable and not set(line.reads()) & set(self.ranges):
                limit = Factor(self._limit(name))
                factors = tuple(
                    factor._replace(factors=(*factor.factors, limit)) for factor in factors
                )
            yield SignalLine((name,), Source("rules", cut, (plane,)), factors, line.span)

    def _peaks(self, sheet: str) -> tuple[PeakTuning, ...]:
        return self.blocks[sheet].peaks if sheet in self.blocks else ()

    # --- Its own gains ---

    def _named(self, name: str) -> str:
        """Return a name; distinct for axes with separate lines."""
        return name if len(self.model.axes) == 1 else f"{name} on {', '.join(self.part.names)}"

    def _own(self, name: str, value: float, unit: str) -> str:
        """Add a gain."""
        name = self._named(name)
        self.gains[name] = GainModel(name, (Amount.of(value),), unit)
        return name

    def _move(self, gain: str, low: float, high: float, *, times: bool = False) -> None:
        # Numbers for axes of other lines would be dead ones.
        several = len(self.part.names) > 1
        self.moving.append(GainTuning((gain,), low, high, times=times, per_axis=several))

    def _slope(self, name: str, signal: str, slope: float) -> str:
        """Return the gain of a slope; its range follows from the scaling gain in the file."""
        gain = self._own(f"slope of {name} along {signal}", slope, "slope")
        low, high = 1.0 / SPAN, SPAN
        for other in self.scaling.get(signal, ()):
            if other in self.ranges and self._is_positive(other):
                least, most = self._multiples(other)
                low, high = min(low, least), max(high, most)
                self._spoken_for.add(other)
        self._move(gain, low, high, times=True)
        return gain

    def _offset(self, name: str, output: Output, constant: float, *, moves: bool) -> str:
        """Return the gain of an output's value in the middle of its inputs."""
        gain = self._own(f"offset of {name}", constant, "offset")
        if moves:
            self._move(gain, output.low, output.high)
        return gain

    def _limit(self, name: str) -> str:
        """Return the gain of an output's limit, if peaks determine it and no gain does."""
        gain = self._own(f"limit of {name}", 1.0, "limit")
        self._move(gain, 1.0 / SPAN, 1.0, times=True)
        return gain

    # --- Gains of the file ---

    def _values(self, name: str) -> list[float]:
        gain = next(model for model in self.model.gains if model.name == name)
        return [value.value(math.pi) for value in gain.values]

    def _is_positive(self, name: str) -> bool:
        return self.ranges[name].low > 0.0 and min(self._values(name)) > 0.0

    def _multiples(self, name: str) -> tuple[float, float]:
        """Return between which multiples of itself a gain moves."""
        tuning, values = self.ranges[name], self._values(name)
        if tuning.times:
            return tuning.low, tuning.high
        return tuning.low / max(values), tuning.high / min(values)

    def others(self) -> Iterator[GainTuning]:
        """Yield the ranges of the gains that act beyond a slope."""
        for name, interval in self.ranges.items():
            if name not in self._spoken_for:
                yield replace(interval, names=(name,))


def _scaling_gains(model: ControllerModel) -> dict[str, set[str]]:
    """Return the gains that only scale signals read by rules alone, by signal."""
    common_gains: dict[str, set[str]] = {}
    scaled: list[str] = []
    for part in model.axes:
        for line in part.lines:
            if (
                isinstance(line, SignalLine)
                and len(line.names) == 1
                and _only_rules_read(line, part)
            ):
                common = set.intersection(*map(_multipliers, line.products))
                common_gains[line.names[0]] = common_gains.get(line.names[0], common) & common
                scaled += common
    return {
        # It occurs only in the lines that it scales.
        signal: {name for name in names if _mentions(model, name) == scaled.count(name)}
        for signal, names in common_gains.items()
    }


def _only_rules_read(signal: SignalLine, part: Axes) -> bool:
    reading = [line for line in part.lines if signal.names[0] in _read_by(line)]
    return bool(reading) and all(map(_is_rules, reading))


def _multipliers(product: Product) -> set[str]:
    names = [factor.value for factor in product.factors if isinstance(factor.value, str)]
    divide = {factor.value for factor in product.factors if factor.divides}
    return {name for name in names if names.count(name) == 1 and name not in divide}


def _read_by(line: Line) -> Iterator[str]:
    """Yield every name in a line."""
    if isinstance(line, Zoom):
        yield from (*line.signals, str(line.by), str(line.inside))
        return
    if isinstance(line, Learn):
        yield from (*line.inputs, str(line.rate), str(line.bound))
        return
    for product in line.products:
        yield from (str(factor.value) for factor in product.factors)
    if isinstance(line, SignalLine) and line.source is not None:
        yield from (line.source.name, *line.source.inputs)
        yield from (str(value) for _, value in line.source.options)
        yield from line.source.chosen_names()


def _mentions(model: ControllerModel, name: str) -> int:
    """Return the number of lines with a name, counting axes of one kind once."""
    return sum(name in _read_by(line) for part in model.axes for line in part.lines)


GRID, MOST_POINTS = 9, 60_000
"""Positions along each input for the fit of the nearest plane, and their greatest number: for more
than five inputs so many are drawn."""


def nearest_plane(rulebase: RuleBase, output: str) -> tuple[list[float], float]:
    """Return the slopes and the constant of the plane nearest to an output, by least squares."""
    ranges = [(variable.low, variable.high) for variable in rulebase.inputs]
    if not all(math.isfinite(end) for ends in ranges for end in ends):
        raise TuneError(f"'{rulebase.name}' has an input without end", name=rulebase.name)
    if GRID ** len(ranges) > MOST_POINTS:
        low, high = np.array(ranges).T
        mesh = np.random.default_rng(0).uniform(low, high, (MOST_POINTS, len(ranges)))
    else:
        lines = [np.linspace(low, high, GRID) for low, high in ranges]
        mesh = np.stack([axis.ravel() for axis in np.meshgrid(*lines, indexing="ij")], axis=1)
    names = [variable.name for variable in rulebase.inputs]
    try:
        values = infer(rulebase, dict(zip(names, mesh.T, strict=True)), outputs=(output,))[output]
    except InferenceError as error:
        raise TuneError(f"'{rulebase.name}': {error.message}", name=rulebase.name) from None
    columns = np.hstack([mesh, np.ones((len(mesh), 1))])
    *slopes, constant = np.linalg.lstsq(columns, np.asarray(values), rcond=None)[0].tolist()
    widths = [high - low for low, high in ranges]
    height = float(np.ptp(values)) or 1.0
    # A slope within rounding errors is 0.
    slopes = [0.0 if abs(s) * w < 1e-9 * height else s for s, w in zip(slopes, widths, strict=True)]
    return slopes, 0.0 if abs(constant) < 1e-9 * height else constant


def cut_off(output: Output) -> RuleBase:
    """Return a rule base whose output is its input, clipped to a range."""
    low, high = output.low, output.high
    whole = Term("ALL", Shape("rectangle", (low, high)))
    line = Term("LINE", Shape("linear", (1.0, 0.0)))
    rule = Rule(Is("s", "ALL"), (Consequent("v", "LINE"),))
    return RuleBase(
        "cut",
        (Input("s", low, high, (whole,)),),
        (Output("v", low, high, (line,), defuzzifier=Defuzzifier("weighted-average")),),
        (RuleBlock((rule,)),),
    )
