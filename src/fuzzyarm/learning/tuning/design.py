"""The free numbers of a file as shares from 0 to 1, and the file at given shares.

The ``tune`` blocks of rule bases and ``tune`` after the gains of a controller define the movable
numbers. Without any, all possible numbers move, and even spacing is kept.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.names import near_hint
from fuzzyarm.control.controllers.law import unknown_gain
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.language.model.arrangement import mirror_faults, partition_faults
from fuzzyarm.language.model.controller import ControllerModel, GainModel
from fuzzyarm.language.model.rulebase import (
    GainTuning,
    Input,
    Output,
    PeakTuning,
    RuleBase,
    Term,
    Tuning,
    Variable,
)
from fuzzyarm.learning.tuning.movement import (
    NARROWEST,
    Movement,
    TuneError,
    is_movable,
    significant,
)

Vector = NDArray[np.float64]

Scale = Literal["linear", "log", "logit"]
"""Scales on which a number moves: linear, logarithmic, or logit of its share."""

MOST_PARAMETERS = 500


@json_properties("name low high start")
@dataclass(frozen=True)
class MovingNumber:
    """A number that moves.

    Attributes
    ----------
    name : str
        ``G_e``, ``G_e[2]`` of the second axis, ``pd7.e PS`` of a peak.
    low, high, start : float
        Of the number; for a peak, fractions of its interval.
    scale : str
        The scale on which it moves.
    """

    name: str
    low: float
    high: float
    start: float
    scale: Scale

    def value(self, share: float) -> float:
        """Return the number at a share of its range; exact at both ends and at the start."""
        # Exact at three shares, where log and exp would lose the last bit.
        inside = self.low <= self.start <= self.high
        ends = {**({self.share: self.start} if inside else {}), 0.0: self.low, 1.0: self.high}
        if share in ends:
            return ends[share]
        first, last = self._steps(self.low), self._steps(self.high)
        # exp(log(x)) may round beyond x, the end of the range.
        return min(max(self._number(first + (last - first) * share), self.low), self.high)

    @property
    def share(self) -> float:
        """Share of the value in the file, 0 to 1, clamped to the range."""
        first, last = self._steps(self.low), self._steps(self.high)
        within = min(max(self.start, self.low), self.high)
        return (self._steps(within) - first) / (last - first)

    def rounded(self, value: float, digits: int) -> float:
        """Return a nearby number of so many digits, within the range."""
        near = significant(value, digits)
        if self.low <= near <= self.high:
            return near
        # The other neighbour with these digits; a narrow range may contain none.
        unit = 10.0 ** (math.floor(math.log10(abs(near))) - digits + 1) if near else 0.0
        other = significant(near + math.copysign(unit, value - near), digits)
        return other if self.low <= other <= self.high else value

    def _steps(self, value: float) -> float:
        if self.scale == "log":
            return math.log(value)
        return math.log(value / (1.0 - value)) if self.scale == "logit" else value

    def _number(self, steps: float) -> float:
        if self.scale == "log":
            return math.exp(steps)
        return 1.0 / (1.0 + math.exp(-steps)) if self.scale == "logit" else steps


@dataclass(frozen=True)
class Candidate:
    """The numbers at a point: gains by name, and the rule bases that differ from those of the file.

    Attributes
    ----------
    gains : mapping of str to tuple of float
        One value, or one for each axis.
    rulebases : mapping of str to RuleBase
        By their names in the controller; a rule base tuned alone by its own name.
    """

    gains: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    rulebases: Mapping[str, RuleBase] = field(default_factory=dict)


@dataclass(frozen=True)
class _ParameterGroup:
    """Numbers of one gain, or of one variable of a rule base."""

    sheet: str
    movement: Movement | None
    gain: str
    parameters: tuple[MovingNumber, ...]


class Design:
    """The movable numbers of a controller, or of a rule base alone.

    Parameters
    ----------
    subject : ControllerText or RuleBase
        As in the file.
    tuning : Tuning, optional
        Replaces the ``tune`` lines of the file.

    Attributes
    ----------
    parameters : tuple of MovingNumber
        The numbers that move.
    start : ndarray
        Their shares at the values in the file.

    Raises
    ------
    TuneError
        If nothing may move, or a line is impossible.
    """

    def __init__(self, subject: ControllerText | RuleBase, tuning: Tuning | None = None) -> None:
        self.subject = subject
        self.sheets = rulebases_of(subject)
        model = subject.model if isinstance(subject, ControllerText) else None
        blocks = blocks_of(subject, tuning)
        is_default = tuning is None  # replaced together with the blocks
        parts = [*_gains(model, blocks, with_file_ranges=is_default)] if model is not None else []
        for sheet, block in blocks.items():
            parts += _peaks(sheet, self.sheets[sheet], block) if block.peaks else []
        self._parts = tuple(parts)
        self.parameters = tuple(parameter for part in parts for parameter in part.parameters)
        if not self.parameters:
            hint = "a tune block in a rule base, or tune LOW .. HIGH after a gain"
            raise TuneError("nothing may move", hint=hint)
        if len(self.parameters) > MOST_PARAMETERS:
            message = f"{len(self.parameters)} numbers may move, more than {MOST_PARAMETERS}"
            raise TuneError(message)
        self.start = np.array([parameter.share for parameter in self.parameters])

    def at(self, point: Sequence[float] | Vector, digits: int | None = None) -> Candidate:
        """Return the file at a point, its numbers rounded to some significant digits.

        At the start this is the file itself, even if it breaks its own ranges.
        """
        if digits is None and np.array_equal(point, self.start):
            return self.as_it_is()
        waiting = [float(share) for share in point]
        gains: dict[str, tuple[float, ...]] = {}
        changed: dict[str, dict[str, Variable]] = {}
        for part in self._parts:
            shares_here, waiting = waiting[: len(part.parameters)], waiting[len(part.parameters) :]
            values = [
                parameter.value(share)
                for parameter, share in zip(part.parameters, shares_here, strict=True)
            ]
            if part.movement is not None:
                variable = part.movement.at(values, digits)
                changed.setdefault(part.sheet, {})[variable.name] = variable
            else:
                gains[part.gain] = tuple(
                    value if digits is None else parameter.rounded(value, digits)
                    for parameter, value in zip(part.parameters, values, strict=True)
                )
        sheets = {
            name: with_variables(self.sheets[name], shares_here)
            for name, shares_here in changed.items()
        }
        return Candidate(gains, sheets)

    def rulebase_at(self, candidate: Candidate) -> RuleBase:
        """Return the rule base of a candidate, if a rule base is tuned alone."""
        if isinstance(self.subject, ControllerText):
            raise TuneError("a controller is not a rule base alone")
        return candidate.rulebases.get(self.subject.name, self.subject)

    def as_it_is(self) -> Candidate:
        """Return the file itself as a candidate."""
        gains = {part.gain: tuple(p.start for p in part.parameters) for part in self._parts}
        gains.pop("", None)
        touched = {part.sheet for part in self._parts if part.movement is not None}
        return Candidate(gains, {name: self.sheets[name] for name in touched})

    def on_a_bound(self, point: Vector) -> list[str]:
        """Return the numbers that ended on a bound of their range."""
        return [
            parameter.name
            for parameter, share in zip(self.parameters, point, strict=True)
            if min(share, 1.0 - share) < 1e-3
        ]


def rulebases_of(subject: ControllerText | RuleBase) -> dict[str, RuleBase]:
    """Return the rule bases of a file by their names, one for all axes each."""
    if isinstance(subject, RuleBase):
        return {subject.name: subject}
    return {
        name: sheets[0]
        for name, sheets in subject.sheets.items()
        if len(sheets) == 1 and isinstance(sheets[0], RuleBase)
    }


def blocks_of(subject: ControllerText | RuleBase, tuning: Tuning | None) -> dict[str, Tuning]:
    """Return the ``tune`` lines of each rule base: those passed in, its own, or all movable."""
    sheets = rulebases_of(subject)
    if tuning is not None:
        return dict(_divided(tuning, sheets))
    if has_movable_numbers(subject):
        return {name: sheet.tuning for name, sheet in sheets.items() if sheet.tuning is not None}
    return {name: everything(sheet) for name, sheet in sheets.items()}


def has_movable_numbers(subject: ControllerText | RuleBase) -> bool:
    """Whether a file defines movable numbers: a ``tune`` block, or ``tune`` after a gain."""
    if any(rulebase.tuning is not None for rulebase in rulebases_of(subject).values()):
        return True
    gains = subject.model.gains if isinstance(subject, ControllerText) else ()
    return any(gain.tune is not None for gain in gains)


def with_variables(rulebase: RuleBase, variables: Mapping[str, Variable]) -> RuleBase:
    """Return a rule base with the terms of other variables."""

    def of(of_variable: Variable) -> tuple[Term, ...]:
        return (
            variables[of_variable.name].terms
            if of_variable.name in variables
            else of_variable.terms
        )

    inputs: Iterable[Input] = (
        replace(variable, terms=of(variable)) for variable in rulebase.inputs
    )
    outputs: Iterable[Output] = (replace(output, terms=of(output)) for output in rulebase.outputs)
    return replace(rulebase, inputs=tuple(inputs), outputs=tuple(outputs))


def everything(rulebase: RuleBase) -> Tuning:
    """Return a block that moves all peaks and keeps their order, mirror images and partitions."""
    peaks = []
    for variable in (*rulebase.inputs, *rulebase.outputs):
        finite = math.isfinite(variable.low) and math.isfinite(variable.high)
        kinds = {term.shape.kind for term in variable.terms}
        if not finite or not kinds or not all(map(is_movable, kinds)):
            continue
        even = not any(mirror_faults(variable))
        whole = PeakTuning((variable.name,), even, True, partition_faults(variable) == [])
        # With N Z P mirrored nothing could move, since Z stays in the middle: then release it.
        stuck = even and not Movement(variable, whole, ()).names
        peaks.append(replace(whole, mirrored=False) if stuck else whole)
    alike = groupby(peaks, lambda peak: replace(peak, variables=()))
    return Tuning(
        tuple(
            replace(flags, variables=tuple(name for tuning in group for name in tuning.variables))
            for flags, group in alike
        )
    )


WIDE = 5.0
"""Factor of the ranges written after gains."""


def default_ranges(model: ControllerModel) -> dict[str, tuple[float, float]]:
    """Return initial ranges for the positive gains without one."""
    ranges = {}
    for gain in model.gains:
        values = [value.value(math.pi) for value in gain.values]
        if gain.tune is None and min(values) > 0.0:
            ends = min(values) / WIDE, max(values) * WIDE
            ranges[gain.name] = significant(ends[0], 2), significant(ends[1], 2)
    return ranges


def _divided(tuning: Tuning, sheets: Mapping[str, RuleBase]) -> Iterator[tuple[str, Tuning]]:
    """Yield, for each rule base, the lines passed in that fit it."""
    names = {key: {v.name for v in (*r.inputs, *r.outputs)} for key, r in sheets.items()}
    for name in (*(v for peaks in tuning.peaks for v in peaks.variables), *dict(tuning.kept)):
        if not any(name in names_of_sheet for names_of_sheet in names.values()):
            names_there = sorted(set().union(*names.values()))
            hint = (
                near_hint(name, names_there)[0] or f"there are {', '.join(names_there) or 'none'}"
            )
            raise TuneError(f"no rule base has a variable '{name}'", name=name, hint=hint)
    # Gains belong to the controller, so only the first block has them.
    yield "", Tuning((), tuning.gains)
    for sheet, names_of_sheet in names.items():
        peaks = tuple(
            replace(peak, variables=tuple(v for v in peak.variables if v in names_of_sheet))
            for peak in tuning.peaks
        )
        kept_terms = tuple((v, term) for v, term in tuning.kept if v in names_of_sheet)
        yield sheet, Tuning(peaks, (), kept_terms)


# --- Gains ---


def _gains(
    model: ControllerModel, blocks: Mapping[str, Tuning], *, with_file_ranges: bool
) -> Iterator[_ParameterGroup]:
    """Yield the movable gains."""
    ranges = gain_ranges(model, blocks.values(), with_file_ranges=with_file_ranges)
    for gain in model.gains:
        if gain.name in ranges:
            yield _ParameterGroup("", None, gain.name, tuple(_said(gain, ranges[gain.name], model)))


def gain_ranges(
    model: ControllerModel, blocks: Iterable[Tuning], *, with_file_ranges: bool
) -> dict[str, GainTuning]:
    """Return the range of each gain; lines of a rule base override the range after the gain."""
    tunings: dict[str, GainTuning] = {}
    for block in blocks:
        for tuning in block.gains:
            for name in tuning.names:
                if name in tunings and tunings[name] != tuning:
                    message = f"two lines tune the gain '{name}' differently"
                    raise TuneError(message, name=name)
                tunings[name] = tuning
    models = {gain_model.name: gain_model for gain_model in model.gains}
    for name in tunings:
        if name not in models:
            raise unknown_gain(model.name, models, name)
    for gain in model.gains:
        if with_file_ranges and gain.tune is not None:
            ends = gain.tune.low, gain.tune.high
            tunings.setdefault(gain.name, GainTuning((gain.name,), *ends, log=gain.tune.log))
    return tunings


def _said(gain: GainModel, tuning: GainTuning, model: ControllerModel) -> Iterator[MovingNumber]:
    values = [amount.value(math.pi) for amount in gain.values]
    if tuning.per_axis and len(values) == 1:
        values *= len(model.axis_names)
    for name, value in _named(gain.name, values):
        if not tuning.times:
            scale: Scale = "log" if tuning.log else "linear"
            yield MovingNumber(name, tuning.low, tuning.high, value, scale)
            continue
        if value == 0.0:
            raise TuneError(f"multiples of {gain.name} = 0 are 0", name=gain.name)
        low, high = sorted((tuning.low * value, tuning.high * value))
        if value < 0.0:  # a logarithm has no sign
            yield MovingNumber(name, low, high, value, "linear")
        else:
            yield MovingNumber(name, low, high, value, "log")


def _named(name: str, values: Sequence[float]) -> Iterator[tuple[str, float]]:
    for at, value in enumerate(values):
        yield name if len(values) == 1 else f"{name}[{at + 1}]", value


# --- Peaks ---


def _peaks(sheet: str, rulebase: RuleBase, tuning: Tuning) -> Iterator[_ParameterGroup]:
    for peaks in tuning.peaks:
        for name in peaks.variables:
            kept_terms = [term for variable, term in tuning.kept if variable == name]
            movement = Movement(rulebase.variable(name), peaks, kept_terms)
            ends = (NARROWEST, 1.0 - NARROWEST) if movement.sliding else (0.0, 1.0)
            scale: Scale = "logit" if movement.sliding else "linear"
            counts: dict[str, int] = {}
            parameters = []
            for term, share in zip(movement.names, movement.start, strict=True):
                counts[term] = counts.get(term, 0) + 1
                again = f" ({counts[term]})" if counts[term] > 1 else ""
                label = f"{sheet}.{name} {term}{again}"
                parameters.append(MovingNumber(label, *ends, share, scale))
            yield _ParameterGroup(sheet, movement, "", tuple(parameters))


# --- A controller at a candidate ---


def controller_at(text: ControllerText, candidate: Candidate) -> ControllerText:
    """Return a controller with the gains and rule bases of a candidate."""
    text = text.with_gains(candidate.gains)
    inside = tuple(
        candidate.rulebases.get(rulebase.name, rulebase) for rulebase in text.model.rulebases
    )
    model = replace(text.model, rulebases=inside)
    sheets = {
        **text.sheets,
        **{name: (rulebase,) for name, rulebase in candidate.rulebases.items()},
    }
    return replace(text, model=model, sheets=sheets)
