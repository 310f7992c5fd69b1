"""The static part of a controller: ranges, limits, gains and sectors of its drives.

From its measurements and its memory to its drives a controller is a static map: sums and products,
rule bases, tables. Its *sources* (errors, rates, integrals …) count as independent. The lines are
walked in order (:mod:`fuzzyarm.proof.map.walk`), once for each question; an unproved property has a
reason.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product as combinations
from typing import Any

import numpy as np

from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.units import Unit, product, read_unit, unit_text
from fuzzyarm.control.controllers.code import SourceError
from fuzzyarm.control.controllers.findings import site_by_axes
from fuzzyarm.control.controllers.on_plant import Site, site_of
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.language.model.controller import Drive
from fuzzyarm.plant.plant import Plant
from fuzzyarm.proof.map.bounds import LIKE_EXPECT
from fuzzyarm.proof.map.laws import (
    NOTHING,
    ONE,
    Gains,
    SignalLaw,
    clipped,
    combined,
    constant,
    inside,
    plus,
)
from fuzzyarm.proof.map.walk import AxisLines, LineWalk, WalkQuestion, source_name
from fuzzyarm.proof.stop import Stop
from fuzzyarm.symbolic.intervals import combine, largest, overlap, symmetric
from fuzzyarm.symbolic.operations import EVERYTHING, Interval

# ── results ──────────────────────────────────────────────────────────────────────────


@dataclass(frozen=True)
class DriveGain:
    """The gain of a drive by one source at the origin.

    Attributes
    ----------
    source : str
        Such as ``error of position``, ``rate of error of position``, ``integral of …``.
    low, high : float
        Slopes to both sides, other sources at 0: the gain of a linear law.
    least, most : float
        Bounds of the slopes of all pieces around the origin.
    unit : str
        Unit of the drive by that of the source; empty if uncertain.
    """

    source: str
    low: float
    high: float
    least: float
    most: float
    unit: str = ""


@dataclass(frozen=True)
class DriveSector:
    """The sector of a drive over σ, with sources outside σ at 0.

    Attributes
    ----------
    weights : dict of str to float
        Of the sources in σ: 1 for one source; for several the gains of the linear law, so that σ is
        its drive.
    low : float
        The gain k₁: the drive is at least k₁ σ (for σ > 0).
    high : float
        The gain k₂: and at most k₂ σ.
    within : dict of str to (float, float)
        Intervals of the sources on which the sector holds.
    slack : float
        Allowed excess of the drive over the sector, in its own units.
    """

    weights: Mapping[str, float]
    low: float
    high: float
    within: Mapping[str, tuple[float, float]]
    slack: float = 0.0


@json_properties("drive=name * -axis -port")
@dataclass(frozen=True, kw_only=True)
class DriveProof:
    """Proved properties of one drive.

    Attributes
    ----------
    axis, port : str
        The drive.
    unit : str
        Of the drive.
    low, high : float
        Range of the drive after limits.
    free : (float, float)
        Range of the drive before limits.
    limits : (float, float) or None
        Limits of the text or of the plant's actuator; None without any.
    reached : str
        ``never``, ``yes``, or ``open`` if the range exceeds the limits and no point was found;
        empty without limits.
    at : dict of str to float
        Sources at which a limit is reached.
    gains : tuple of DriveGain
        Gains of the linear law at the origin, by ports.
    sectors : tuple of DriveSector
        Along each source, then along the linear law.
    open : tuple of str
        Unproved properties, with reasons.
    hole : str
        Where the drive is not a number, or why that is open: then its range is not proved. Else
        empty.
    """

    axis: str
    port: str
    unit: str
    low: float
    high: float
    free: tuple[float, float]
    limits: tuple[float, float] | None
    reached: str
    at: Mapping[str, float]
    gains: tuple[DriveGain, ...]
    sectors: tuple[DriveSector, ...]
    open: tuple[str, ...]
    hole: str = ""

    @property
    def name(self) -> str:
        """Axis and port."""
        return f"{self.axis}.{self.port}"


# ── one axis ───────────────────────────────────────────────────────────────────────────


class _AxisCase:
    """The proof of one axis."""

    def __init__(self, lines: AxisLines, site: Site | None) -> None:
        self.lines = lines
        self.site = site
        self.name = lines.name
        self.sources = lines.sources

    def proofs(self) -> Iterator[DriveProof]:
        whole = {name: reach.at for name, reach in self.sources.items()}
        first = LineWalk(self.lines, WalkQuestion(whole, {})).run()
        zones = {
            name: overlap(at, first.notes.zones.get(name, EVERYTHING)) for name, at in whole.items()
        }
        for port, drives in first.drives.items():
            yield self._proof(port, drives, first, zones)

    def _proof(
        self,
        port: str,
        drives: list[tuple[Drive, SignalLaw]],
        first: LineWalk,
        zones: Mapping[str, Interval],
    ) -> DriveProof:
        actuator, unit = self._actuator(port)
        law = self._limited(drives, 1.0)
        free = drives[0][1].at
        for _, more in drives[1:]:
            free = combined("add", free, more.at)
        limits = drives[0][0].within if len(drives) == 1 else None
        bound = Interval(*limits) if limits else actuator
        gaps: list[str] = []
        gains: tuple[DriveGain, ...] = ()
        if isinstance(law.gains, str) or isinstance(law.around, str):
            gaps.append(f"gains: {law.gains if isinstance(law.gains, str) else law.around}")
        else:
            gains = self._by_ports(law, unit)
            gaps += (f"gains: {name} has the slope 0 around 0" for name in first.notes.flat)
        sectors = tuple(self._sectors(port, law, first, zones, gaps))
        at = clipped(law.at, actuator) if actuator is not None else law.at
        reached, where = self._reached(port, free, bound, first, zones)
        return DriveProof(
            axis=self.name,
            port=port,
            unit=unit_text(unit) if unit else "",
            low=at.low,
            high=at.high,
            free=(free.low, free.high),
            limits=None if bound is None else (bound.low, bound.high),
            reached=reached,
            at=where,
            gains=gains,
            sectors=sectors,
            open=tuple(dict.fromkeys(gaps)),
            hole=law.hole,
        )

    def _actuator(self, port: str) -> tuple[Interval | None, Unit | None]:
        if self.site is None:
            return None, None
        try:
            address = self.site.find(self.lines.text.model, "drive", (self.name, port))
        except SourceError:
            return None, None
        input_port = self.site.interface.inputs[address]
        limits = Interval(input_port.low, input_port.high)
        finite = limits.low > -math.inf or limits.high < math.inf
        return (limits if finite else None), read_unit(input_port.unit)

    @staticmethod
    def _limited(drives: Sequence[tuple[Drive, SignalLaw]], farthest: float) -> SignalLaw:
        """Return the drive: limits applied, lines of a port added; σ goes to ± `farthest`."""
        total = constant(0.0)
        for line, law in drives:
            limits = None if line.within is None else Interval(*line.within)
            total = plus(total, law if limits is None else _cut_off(law, limits, farthest))
        return total

    def _by_ports(self, law: SignalLaw, unit: Unit | None) -> tuple[DriveGain, ...]:
        """Return gains by ports: rates and integrals through their signals."""
        by_port: dict[str, list[Any]] = {}
        assert isinstance(law.gains, dict)
        assert isinstance(law.around, dict)
        for source, gain in _notable(law.gains).items():
            for name, share, its_unit in self._expanded(source):
                both = [
                    combine("multiply", interval, share) for interval in (gain, law.around[source])
                ]
                earlier = by_port.get(name)
                if earlier is not None:
                    both = [combine("add", a, b) for a, b in zip(earlier[0], both, strict=True)]
                by_port[name] = [both, product(unit, its_unit, -1)]
        intervals = _notable({name: gain for name, ((gain, _), _) in by_port.items()})
        return tuple(
            DriveGain(
                name, gain.low, gain.high, around.low, around.high,
                unit_text(unit_of_port) if unit_of_port is not None else "",
            )
            for name, ((gain, around), unit_of_port) in by_port.items()
            if name in intervals or largest(around) > 0.0
        )  # fmt: skip

    def _expanded(self, source: str) -> Iterator[tuple[str, Interval, Unit | None]]:
        """Yield the parts of a source: name by ports, gain, unit."""
        of, inner = self.lines.definitions[source]
        kind, reach = of.record, self.sources.get(source)
        # A nonlinear source does not pass the slopes of its signal on.
        if not kind.linear or kind.ports or inner is None or isinstance(inner.gains, str):
            yield source, ONE, None if reach is None else reach.unit
            return
        apart = source.removeprefix(source_name(of))  # options, if another source has others
        for below, gain in inner.gains.items():
            for name, share, unit in self._expanded(below):
                both = combine("multiply", gain, share)
                undone = f"{kind.inverse_of} of "
                if kind.inverse_of and name.startswith(undone):
                    yield name.removeprefix(undone), both, product(unit, {"s": kind.seconds})
                else:
                    yield f"{of.kind} of {name}{apart}", both, product(unit, {"s": kind.seconds})

    # --- sectors ---

    def _sectors(
        self,
        port: str,
        law: SignalLaw,
        first: LineWalk,
        zones: Mapping[str, Interval],
        gaps: list[str],
    ) -> Iterator[DriveSector]:
        if isinstance(law.gains, str):
            return
        if law.rest != NOTHING and not inside(law.rest, symmetric(LIKE_EXPECT * largest(law.at))):
            gaps.append(f"sectors: the drive is {_short(law.rest)} where every source is 0")
            return
        gains = _notable(law.gains)
        level = [name for name, gain in law.gains.items() if gain == NOTHING]  # flat: a step
        for source in (*gains, *level):
            stretches = dict.fromkeys((zones[source], self.sources[source].at))
            for stretch in stretches:
                yield from self._sector(port, {source: 1.0}, {source: stretch}, gaps)
        for group in dict.fromkeys(first.notes.groups):
            weights = {
                name: 0.5 * gains[name].low + 0.5 * gains[name].high
                for name in group
                if name in gains
            }
            if len(weights) > 1 and all(weights.values()):
                yield from self._sector(port, weights, {s: zones[s] for s in weights}, gaps)

    def _sector(
        self,
        port: str,
        weights: Mapping[str, float],
        where: Mapping[str, Interval],
        gaps: list[str],
    ) -> Iterator[DriveSector]:
        farthest = sum(abs(weights[name]) * largest(at) for name, at in where.items())
        law = self._limited(
            LineWalk(self.lines, WalkQuestion(where, weights)).run().drives[port], farthest
        )
        if isinstance(law.along, str):
            what = " and ".join(weights)
            gaps.append(f"sector along {what}: {law.along}")
            return
        if 0.0 < largest(law.along) < math.inf:
            within = {name: (at.low, at.high) for name, at in where.items()}
            yield DriveSector(dict(weights), *law.along, within, law.slack)

    # --- limits ---

    def _reached(
        self,
        port: str,
        free: Interval,
        limits: Interval | None,
        first: LineWalk,
        zones: Mapping[str, Interval],
    ) -> tuple[str, dict[str, float]]:
        """Return whether a limit can be reached, and where."""
        if limits is None:
            return "", {}
        if limits.low < free.low and free.high < limits.high:
            return "never", {}
        ends = {name: [x for x in at if math.isfinite(x)] or [0.0] for name, at in zones.items()}
        points = [*first.notes.points]
        if len(ends) <= 6:
            points += [
                dict(zip(ends, combination, strict=True))
                for combination in combinations(*ends.values())
            ]
        near = LIKE_EXPECT * max(abs(limits.low), abs(limits.high))  # a touched limit is reached
        for point in points:
            value = self._drive_at(port, point)
            if value.low >= limits.high - near or value.high <= limits.low + near:
                return "yes", point
        return "open", {}

    def value_at(self, port: str, point: Mapping[str, float], *, limited: bool = False) -> float:
        """Return a drive at a point of its sources, by inference."""
        value = self._drive_at(port, point, limited=limited)
        return 0.5 * value.low + 0.5 * value.high

    def _drive_at(
        self, port: str, point: Mapping[str, float], *, limited: bool = False
    ) -> Interval:
        """Return bounds of a drive at such a point: signals of other axes have their ranges."""
        self.lines.only_values = True
        try:
            at = {name: Interval(x, x) for name, x in point.items()}
            low = high = 0.0
            for line, law in LineWalk(self.lines, WalkQuestion(at, {})).run().drives[port]:
                interval = law.at
                if limited and line.within is not None:
                    interval = clipped(interval, Interval(*line.within))
                low, high = low + interval.low, high + interval.high
            return Interval(low, high)
        finally:
            self.lines.only_values = False


def _cut_off(law: SignalLaw, limits: Interval, farthest: float) -> SignalLaw:
    """Return a law after limits; σ goes to ± `farthest`."""
    gains, around, along = law.gains, law.around, law.along
    is_known = isinstance(gains, dict)
    if is_known and not (limits.low < law.rest.low and law.rest.high < limits.high):
        gains = around = "the drive is at a limit at rest"
    if isinstance(along, Interval) and not inside(law.at, limits):
        if limits.low < 0.0 < limits.high:
            # At the farthest σ a limited signal is still as large as the nearer limit.
            least = min(-limits.low, limits.high) / farthest if farthest else 0.0
            along = Interval(
                min(along.low, least) if along.low > 0.0 else along.low,
                max(along.high, -least) if along.high < 0.0 else along.high,
            )
        else:
            along = "its limits leave no room on one side of 0"
    at = clipped(law.at, limits)
    return replace(law, at=at, gains=gains, around=around, along=along, linear=None)


def _notable(gains: Gains) -> Gains:
    """Return gains without those that are rounding errors of a cancellation."""
    most = max((largest(gain) for gain in gains.values()), default=0.0)
    return {name: gain for name, gain in gains.items() if largest(gain) > 1e-15 * most}


def _short(at: Interval) -> str:
    if at.low == at.high:
        return f"{at.low:.6g}"
    return f"{at.low:.6g} .. {at.high:.6g}"


def sampled_drive(
    text: ControllerText, proof: DriveProof, along: DriveSector, plant: Plant | None = None,
    connect: Mapping[str, str] | None = None, points: int = 2000,
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Return σ and the drive at points of a sector; along one source a tenth of `points`."""
    site = site_of(plant, connect) if plant is not None else site_by_axes(text.model)
    case = _AxisCase(AxisLines(text, site, proof.axis, Stop(), {}), site)
    ends = list(along.within.values())
    count = max(3, round((points / 10 if len(ends) == 1 else points) ** (1.0 / len(ends))) | 1)
    if count ** len(ends) > 4 * points:  # three along each of many sources are too many
        low, high = np.array(ends).T
        where = np.random.default_rng(0).uniform(low, high, (points, len(ends)))
    else:
        grid = [np.linspace(low, high, count) for low, high in ends]
        where = np.stack([axis.ravel() for axis in np.meshgrid(*grid, indexing="ij")], axis=1)
    values = [
        case.value_at(proof.port, dict(zip(along.within, point, strict=True)), limited=True)
        for point in where.tolist()
    ]
    return where @ np.array([along.weights[name] for name in along.within]), np.array(values)


def prove_drives(
    text: ControllerText,
    plant: Plant | None = None,
    connect: Mapping[str, str] | None = None,
    *,
    budget: float = math.inf,
    tell: Callable[[str, int, float], None] | None = None,
) -> list[DriveProof]:
    """Prove ranges, limits, gains and sectors of a controller's static part.

    Parameters
    ----------
    text : ControllerText
        With its rule bases and tables.
    plant : Plant, optional
        Its ports have the ranges of errors and measured values; by default the shipped plant with
        the controller's axes, if there is one. Other signals are unbounded.
    connect : mapping of str to str, optional
        Port of the plant for each name of the controller that differs.
    budget : float
        Seconds for each axis; properties not proved by then stay open.
    tell : callable, optional
        Called with the axis, the number of open pieces and the gap between the bounds.

    Returns
    -------
    list of DriveProof
        One for each drive of each axis, in the order of the text.

    Examples
    --------
    >>> import fuzzyarm
    >>> from fuzzyarm.proof.map import prove_drives
    >>> (drive,) = prove_drives(fuzzyarm.load(fuzzyarm.shipped("servo.frb")))
    >>> [(gain.source, round(gain.low, 3), gain.unit) for gain in drive.gains]
    [('error of position', 108.0, 'V/rad'), ('error of velocity', 4.725, 'V s/rad')]
    """
    site = site_of(plant, connect) if plant is not None else site_by_axes(text.model)
    shared: dict[Any, Any] = {}
    proofs: list[DriveProof] = []
    for name in text.model.axis_names:
        watch = None if tell is None else (lambda count, gap, name=name: tell(name, count, gap))
        proofs += _AxisCase(AxisLines(text, site, name, Stop(budget, watch), shared), site).proofs()
    return proofs
