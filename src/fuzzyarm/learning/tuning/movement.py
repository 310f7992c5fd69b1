"""The joint movement of a variable's terms: in order, mirrored, as a partition, by construction.

A variable is stretched like a rubber ruler. Its knots are the ends of cores; some are fixed (the
ends of the range, kept terms, with ``mirrored`` the middle), the others slide between them. Points
at a knot or between two move along, so that a foot under the neighbour's peak stays there, and a
foot half-way stays half-way. The order of knots is preserved, because each is a fraction of the way
from the fixed knot to the next knot outside. Without ``keep order`` and ``partition`` each term
moves independently, and may pass its neighbours.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.language.model.arrangement import (
    Core,
    cores,
    mirror_faults,
    mirror_pairs,
    partition_faults,
)
from fuzzyarm.language.model.rulebase import PeakTuning, Shape, Term, Variable
from fuzzyarm.symbolic.kinds import SHAPES

NARROWEST = 5e-4
"""Least distance of a knot from either end, as a share of its way."""


class TuneError(FuzzyarmError, ValueError):
    """A subject that cannot be tuned, or not in this way; `name` is the offending part."""

    def __init__(self, message: str, *, name: str = "", hint: str = "") -> None:
        super().__init__(message, hint=hint)
        self.name = name


# --- Parameters of shapes: positions, and widths that stretch with their surroundings ---

WIDTHS = {"deviation", "left-deviation", "right-deviation", "width"}
"""Parameters that are lengths."""

RATES = {"slope", "slope1", "slope2"}
"""Parameters that are reciprocal lengths; the slope of a bell is dimensionless."""

CENTRES = {
    "deviation": "mean",
    "left-deviation": "left-mean",
    "right-deviation": "right-mean",
    "width": "centre",
    "slope": "inflection",
    "slope1": "inflection1",
    "slope2": "inflection2",
}
"""Where a length is taken from."""

POSITIONS = {
    "left", "peak", "right", "top-left", "top-right", "start", "end", "zero", "one", "value",
    "mean", "left-mean", "right-mean", "centre", "inflection", "inflection1", "inflection2",
    "direction",
}  # fmt: skip
"""Parameters that are positions, or fixed."""

Map = Callable[[float], float]


def is_movable(kind: str) -> bool:
    """Whether every parameter of a shape has a rule for a stretched axis."""
    names = set(SHAPES[kind].parameters)
    return kind == "points" or (bool(names) and names <= POSITIONS | WIDTHS | RATES)


def moved(shape: Shape, to: Map) -> Shape:
    """Return a shape after a map of its axis."""
    if shape.kind == "points":
        numbers = list(shape.parameters)
        numbers[0::2] = map(to, numbers[0::2])
        return replace(shape, parameters=tuple(numbers))
    if not is_movable(shape.kind):
        message = f"it is not known which numbers of a {shape.kind} are positions"
        raise TuneError(message, name=shape.kind)
    names = SHAPES[shape.kind].parameters
    numbers_by_name = dict(zip(names, shape.parameters, strict=True))
    return replace(
        shape,
        parameters=tuple(
            _number(shape.kind, name, numbers_by_name, to) for name in numbers_by_name
        ),
    )


def _number(kind: str, name: str, values: Mapping[str, float], to: Map) -> float:
    value = values[name]
    rate = name in RATES and kind != "bell"
    if name not in WIDTHS and not rate:
        return value if name == "direction" or name in RATES else to(value)
    middle = values[CENTRES[name]]
    length = 1.0 / value if rate else value
    # A length has two ends, which may go different ways: half of the distance between them.
    stretched = 0.5 * (to(middle + length) - to(middle - length))
    return 1.0 / stretched if rate else stretched


# --- Movable knots ---


@dataclass(frozen=True)
class Knot:
    """A knot that slides.

    Attributes
    ----------
    name : str
        The term whose core begins or ends there.
    at : float
        Where it is in the file.
    """

    name: str
    at: float


@dataclass(frozen=True)
class KnotStretch:
    """Knots between two nails; each is a share of the way from `nail` to the one outside it.

    Attributes
    ----------
    nail, end : float
        Nailed positions: where shares are counted from, and the other end.
    knots : tuple of Knot
        From the nail outwards.
    """

    nail: float
    end: float
    knots: tuple[Knot, ...]

    def shares(self, gap: float) -> list[float]:
        """Return the shares of the knots as they are in the file."""
        ends = [*(knot.at for knot in self.knots[1:]), self.end]
        values = []
        for at, (knot, outside) in enumerate(zip(self.knots, ends, strict=True)):
            low, high = self._way(at, outside, gap)
            values.append(abs(knot.at - low) / abs(high - low) if high != low else 0.5)
        return [min(max(share, NARROWEST), 1.0 - NARROWEST) for share in values]

    def positions(self, shares: Sequence[float], gap: float) -> list[float]:
        """Return the positions of the knots at some shares."""
        outside, values = self.end, []
        for at in reversed(range(len(self.knots))):
            low, high = self._way(at, outside, gap)
            outside = low + (high - low) * shares[at]
            values.append(outside)
        return values[::-1]

    def _way(self, at: int, outside: float, gap: float) -> tuple[float, float]:
        """Return the interval in which a knot slides, less the gaps of the knots inside it."""
        sign = math.copysign(1.0, self.end - self.nail)
        return self.nail + sign * gap * (at + 1), outside - sign * gap


class Movement:
    """The terms of a variable as numbers between 0 and 1, and back.

    Parameters
    ----------
    variable : Variable
        As in the file.
    peaks : PeakTuning
        How it may move.
    kept : collection of str
        Fixed terms; an empty name means all of them.

    Attributes
    ----------
    names : list of str
        Names of the numbers: each by the first term that it moves.
    start : list of float
        The numbers of the file.

    Raises
    ------
    TuneError
        If its terms cannot be moved so.
    """

    def __init__(self, variable: Variable, peaks: PeakTuning, fixed: Sequence[str]) -> None:
        self.variable = variable
        self.peaks = peaks
        self.fixed_terms = {term.name for term in variable.terms} if "" in fixed else set(fixed)
        if not (math.isfinite(variable.low) and math.isfinite(variable.high)):
            raise TuneError(f"'{variable.name}' has no finite range", name=variable.name)
        self.width = variable.high - variable.low
        # x and turn - x are mirror images about the middle of the range.
        self.turn = variable.low + variable.high
        self.begun = self._mended()
        cores_found = cores(self.begun)
        if cores_found is None:
            message = f"the terms of '{variable.name}' are not sets or values with a peak"
            raise TuneError(message, name=variable.name)
        self.cores: dict[str, Core] = cores_found
        self.gap = peaks.gap * self.width
        self.sliding = peaks.ordered or peaks.partition
        if self.sliding:
            count = len(self.stretches)
            self._demand_room()
            self.names = [knot.name for part in self.stretches for knot in part.knots]
            self.start = [share for part in self.stretches for share in part.shares(self.gap)]
            assert count or not self.names
        else:
            self.names = [name for name, _ in self._free]
            self.start = [self._share(self.cores[name].middle) for name in self.names]

    # --- The terms as they are promised: mirrored, a partition ---

    def _mended(self) -> Variable:
        """Return the variable with the symmetry and the feet that its line promises."""
        variable = self.variable
        if self.peaks.mirrored and any(mirror_faults(variable)):
            variable = self._reflected(variable)
        if self.peaks.partition and partition_faults(variable) != []:
            variable = self._with_feet(variable)
        return variable

    def _reflected(self, variable: Variable) -> Variable:
        """Return it with the terms below the middle as images of those above."""
        pairs = dict(mirror_pairs(variable) or ())
        terms = {term.name: term for term in variable.terms}
        for below, above in pairs.items():
            if below == above:
                continue
            image = self._image(terms[above].shape)
            terms[below] = replace(terms[below], shape=image)
        return replace(variable, terms=tuple(terms.values()))

    def _image(self, shape: Shape) -> Shape:
        if shape.kind not in ("triangle", "trapezoid", "singleton", "gaussian"):
            name = self.variable.name
            message = f"the terms of '{name}' are not mirror images, and a {shape.kind} is not made"
            raise TuneError(f"{message} one", name=name)
        first, *rest = shape.parameters
        if shape.kind == "gaussian":
            return replace(shape, parameters=(self.turn - first, *rest))
        return replace(shape, parameters=tuple(self.turn - x for x in shape.parameters[::-1]))

    def _with_feet(self, variable: Variable) -> Variable:
        """Return it with each foot under the core of the neighbour."""
        cores_found = cores(variable) or {}
        names = list(cores_found)
        terms = {term.name: term for term in variable.terms}
        for at, name in enumerate(names):
            shape = terms[name].shape
            if shape.kind not in ("triangle", "trapezoid"):
                message = f"a {shape.kind} of '{variable.name}' is not part of a partition"
                raise TuneError(message, name=variable.name, hint="triangles and trapezoids are")
            numbers = list(shape.parameters)
            if at:
                numbers[0] = cores_found[names[at - 1]].right
            if at + 1 < len(names):
                numbers[-1] = cores_found[names[at + 1]].left
            terms[name] = replace(terms[name], shape=replace(shape, parameters=tuple(numbers)))
        return replace(variable, terms=tuple(terms.values()))

    # --- Sliding knots ---

    @cached_property
    def nails(self) -> frozenset[float]:
        """Fixed positions: the ends of the range, kept terms, and their mirror images."""
        low, high = self.variable.low, self.variable.high
        values = {low, high}
        values |= {edge for name in self.fixed_terms for edge in self.cores[name]}
        if self.peaks.mirrored:
            # A position fixed by a term is fixed by its mirror image.
            values |= {0.5 * self.turn, *(self.turn - nail for nail in values)}
        return frozenset(values)

    @cached_property
    def stretches(self) -> list[KnotStretch]:
        """The stretches between nails; with ``mirrored`` those above the middle."""
        low, high = self.variable.low, self.variable.high
        knots: dict[float, str] = {}
        for name, core in self.cores.items():
            for edge in core:
                if low < edge < high and edge not in self.nails:
                    knots.setdefault(edge, name)
        begin = 0.5 * self.turn if self.peaks.mirrored else low
        nails = sorted(nail for nail in self.nails if nail >= begin)
        knot_stretches = []
        for first, last in pairwise(nails):
            inside = [Knot(knots[edge], edge) for edge in sorted(knots) if first < edge < last]
            # Shares are counted from the inner nail outwards.
            if inside and first == low and last < high:
                knot_stretches.append(KnotStretch(last, first, tuple(reversed(inside))))
            elif inside:
                knot_stretches.append(KnotStretch(first, last, tuple(inside)))
        return knot_stretches

    def _demand_room(self) -> None:
        for part in self.stretches:
            if self.gap * (len(part.knots) + 1) >= abs(part.end - part.nail):
                name = self.variable.name
                message = f"{len(part.knots) + 1} gaps of {self.gap:.4g} do not fit in '{name}'"
                raise TuneError(message, name=name, hint="a smaller gap")

    def _slid(self, shares: Sequence[float], rounded: Map) -> Variable:
        pairs = {nail: nail for nail in self.nails}
        waiting = list(shares)
        for part in self.stretches:
            shares_here, waiting = waiting[: len(part.knots)], waiting[len(part.knots) :]
            for knot, at in zip(part.knots, part.positions(shares_here, self.gap), strict=True):
                pairs[knot.at] = rounded(at)
                if self.peaks.mirrored:
                    # Rounded once: the image is exact if the middle of the range is 0.
                    pairs[self.turn - knot.at] = rounded(self.turn - rounded(at))
        to = _between(pairs)
        return self._with(lambda name: _rounding(to, rounded, pairs))

    # --- Free terms ---

    @cached_property
    def _free(self) -> list[tuple[str, str]]:
        """Terms that move by themselves, each with its image or an empty name."""
        stay = self.fixed_terms | {name for name in self.cores if self._reaches_an_end(name)}
        if not self.peaks.mirrored:
            return [(name, "") for name in self.cores if name not in stay]
        return [
            (above, below)
            for below, above in mirror_pairs(self.begun) or ()
            if below != above and not stay & {above, below}
        ]

    def _reaches_an_end(self, name: str) -> bool:
        """Whether a set is full at an end of the range, which it would uncover."""
        low, high = self.variable.low, self.variable.high
        value = self.begun.term(name).shape.kind == "singleton"
        return not value and (self.cores[name].left <= low or self.cores[name].right >= high)

    def _share(self, at: float) -> float:
        share = (at - self.variable.low) / self.width
        return min(max(share, 0.0), 1.0)

    def _shifted(self, shares: Sequence[float], rounded: Map) -> Variable:
        by: dict[str, float] = {}
        for (name, image), share in zip(self._free, shares, strict=True):
            to = self.variable.low + self.width * share
            by[name] = to - self.cores[name].middle
            if image:
                by[image] = -by[name]

        def shift(name: str) -> Map:
            return lambda x: rounded(x + by.get(name, 0.0)) if name in by else x

        return self._with(shift)

    # --- Both ---

    def _with(self, to: Callable[[str], Map]) -> Variable:
        # In a partition the feet of kept terms follow the neighbours.
        stay = set() if self.peaks.partition else self.fixed_terms
        terms = tuple(
            term if term.name in stay else self._term(term, to(term.name))
            for term in self.begun.terms
        )
        return replace(self.begun, terms=terms)

    @staticmethod
    def _term(term: Term, to: Map) -> Term:
        return replace(term, shape=moved(term.shape, to))

    def at(self, shares: Sequence[float], digits: int | None = None) -> Variable:
        """Return the variable at some shares, with numbers of at most `digits` digits."""
        rounded = rounding(digits, self.variable)
        return self._slid(shares, rounded) if self.sliding else self._shifted(shares, rounded)


def _between(pairs: Mapping[float, float]) -> Map:
    """Return the piecewise linear map of the knots, from old to new positions."""
    places = sorted(pairs.items())

    def to(x: float) -> float:
        if x in pairs:
            return pairs[x]
        for (a, to_a), (b, to_b) in pairwise(places):
            if a < x < b:
                return to_a + (to_b - to_a) * (x - a) / (b - a)
        return x  # nothing moves outside the range

    return to


def _rounding(to: Map, rounded: Map, pairs: Mapping[float, float]) -> Map:
    def mapped(x: float) -> float:
        return pairs[x] if x in pairs else rounded(to(x)) if to(x) != x else x

    return mapped


def rounding(digits: int | None, variable: Variable) -> Map:
    """Return a rounding of positions on a variable.

    Significant digits, where the middle of the range is 0; elsewhere as many decimals as the
    range has digits, so that images stay images.
    """
    if digits is None:
        return lambda x: x
    if variable.low == -variable.high:
        return lambda x: significant(x, digits)
    decimals = digits - 1 - math.floor(math.log10(variable.high - variable.low))
    return lambda x: round(x, decimals) + 0.0


def significant(value: float, digits: int) -> float:
    """Round to significant digits."""
    return float(f"{value:.{digits}g}") + 0.0
