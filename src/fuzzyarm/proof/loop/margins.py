"""Stability margins of a loop: gain, phase and delay margin, peak sensitivity.

With L the sampled transfer function of the loop opened at one drive (q = exp(jωh)), the closed loop
has the return difference 1 + L and the sensitivity S = 1 / (1 + L).

Frequencies with |L| = 1 or real L are roots: with ``L(1/q) = bᵀ q (I - q Aᵀ)⁻¹ cᵀ`` they are
generalised eigenvalues on the unit circle, so that no grid can miss one. Each is then refined by a
bracketing root search of the function itself.

Sources: K. J. Åström and R. M. Murray, *Feedback Systems*, Princeton University Press 2008,
sections 9.3 and 11.3 (margins, sensitivity); K. J. Åström and B. Wittenmark, *Computer-Controlled
Systems*, 3rd edition, Prentice Hall 1997, section 2.3 (a dead time that is not a whole number of
periods).
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, partial
from itertools import groupby, product

import numpy as np

from fuzzyarm.base import above
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.control.loop.course import Sensor
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.plant.own import find_plant
from fuzzyarm.plant.plant import Address, Plant
from fuzzyarm.proof.claim.problem import ClaimError, LoopProblem, LoopProofError, loop_problem
from fuzzyarm.proof.loop.enclosure import Vector
from fuzzyarm.proof.loop.linearised import LinearisedLoop, OpenLoop, RuleSlope, linearised
from fuzzyarm.proof.map.bounds import UnprovableError
from fuzzyarm.proof.map.prover import Prover
from fuzzyarm.proof.map.sector import NoSectorError, form_text, sector
from fuzzyarm.proof.stop import Stop, TimeOverError

LONGEST_DELAY = 400
"""Largest dead time in the search for a delay margin, in control periods."""

INFINITE = 1e12
"""A larger |L| counts as infinite, as near frequency 0 of a loop with an integrator."""

POINTS = 2000
"""Frequencies of the first scan of the sensitivity."""


@json_properties("*")
@dataclass(frozen=True)
class Margins:
    """Margins of a loop opened at one drive.

    Attributes
    ----------
    stable : bool
        Whether the closed loop is stable; if not, all margins are None.
    gain : float or None
        The loop is stable up to this factor on its gain; infinity without a limit.
    gain_down : float or None
        And down to this factor; 0 without a limit.
    phase : float or None
        Further lag at the crossover that makes it unstable, degrees; infinity without a crossover.
    delay : float or None
        Further dead time of the actuator that makes it unstable, s.
    sensitivity : float or None
        The peak of the sensitivity.
    gain_at, phase_at, sensitivity_at : float or None
        Frequencies of these margins, rad/s; of `phase` the crossover. None without one.
    """

    stable: bool
    gain: float | None = None
    gain_down: float | None = None
    phase: float | None = None
    delay: float | None = None
    sensitivity: float | None = None
    gain_at: float | None = None
    phase_at: float | None = None
    sensitivity_at: float | None = None


@json_properties("of=words low high")
@dataclass(frozen=True)
class RuleGain:
    """A gain of a rule base, uncertain away from rest.

    Attributes
    ----------
    words : str
        The gain in words.
    slopes : tuple of (int, float)
        Indices of the loop's slopes, and their factors.
    low, high : float
        Proved bounds of the gain.
    """

    words: str
    slopes: tuple[tuple[int, float], ...]
    low: float
    high: float


@dataclass(frozen=True)
class WorstMargins:
    """The least margins found over the gains of the rules, each with its gains.

    Attributes
    ----------
    gains : tuple of RuleGain
        Bounded over the given share of the ranges.
    margins : Margins
        The least of each; not stable if any choice of gains is unstable.
    where : dict of str to tuple of float
        By the name of a margin, the gains of the least value, in the order of `gains`.
    """

    gains: tuple[RuleGain, ...]
    margins: Margins
    where: Mapping[str, tuple[float, ...]]


@json_properties("drive=name nominal worst=worst.margins gains=worst_gains where held")
@dataclass(frozen=True)
class DriveMargins:
    """The margins at one drive.

    Attributes
    ----------
    drive : (str, str)
        Axis and port.
    loop : OpenLoop
        At rest.
    nominal : Margins
        At rest.
    worst : WorstMargins or None
        Over the slopes of the rules; None without proved bounds.
    held : tuple of str
        Inputs of the rules without a gain, since the loop rests at or beyond an end of their range.
    """

    drive: Address
    loop: OpenLoop
    nominal: Margins
    worst: WorstMargins | None
    held: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Axis and port."""
        return ".".join(self.drive)

    @property
    def worst_gains(self) -> tuple[RuleGain, ...]:
        """Uncertain gains."""
        return self.worst.gains if self.worst else ()

    @property
    def where(self) -> Mapping[str, tuple[float, ...]]:
        """By margin, the gains of the least value."""
        return self.worst.where if self.worst else {}


def margins(
    controller: ControllerText | str | os.PathLike[str],
    plant: str | Plant,
    *,
    set_point: Mapping[str, float] | None = None,
    parameters: Mapping[str, tuple[float, float]] | None = None,
    sensors: Mapping[str, Sensor] | None = None,
    connect: Mapping[str, str] | None = None,
    share: float = 1.0,
    budget: float = 60.0,
) -> dict[str, DriveMargins]:
    """Return the margins of a loop, opened at each drive in turn.

    Parameters
    ----------
    controller : ControllerText, str or path-like
        The controller, or its file.
    plant : str or Plant
        Its plant.
    set_point : mapping of str to float, optional
        Constant, by port; 0 for others.
    parameters : mapping of str to (float, float), optional
        Of the plant, by name; one value each.
    sensors : mapping of str to Sensor, optional
        By port; exact ones by default.
    connect : mapping of str to str, optional
        Port of the plant for each name of the controller that differs.
    share : float
        Share of the ranges of the rule bases' inputs, around rest, over which gains are bounded.
    budget : float
        Processor seconds for those bounds; without them margins are at rest only.

    Returns
    -------
    dict of str to DriveMargins
        By ``axis.port``.

    Raises
    ------
    LoopProofError
        If no rest is found, or the loop does not respond there.

    Examples
    --------
    >>> import fuzzyarm
    >>> from fuzzyarm.proof.loop import margins
    >>> found = margins(fuzzyarm.shipped("servo.frb"), "motor")["shaft.voltage"]
    >>> f"{found.nominal.phase:.1f}, {found.worst.margins.phase:.1f} degrees"
    '68.3, 63.3 degrees'
    """
    text: ControllerText = (
        controller if isinstance(controller, ControllerText) else above.function("load")(controller)
    )
    problem = loop_problem(
        text, find_plant(plant), set_point=set_point, parameters=parameters, sensors=sensors,
        connect=connect, inside=True,
    )  # fmt: skip
    return {".".join(each.drive): each for each in margins_of_problem(problem, share, budget)}


def margins_of_problem(problem: LoopProblem, share: float, budget: float) -> list[DriveMargins]:
    """Return the margins of a loop at each drive; see :func:`margins`."""
    for name, span in problem.parameters.items():
        if span.low < span.high:
            hint = f"as in --with '{name} in {span.low:g} .. {span.low:g}'"
            raise ClaimError(f"margins are of one value of {name}, not of an interval", hint=hint)
    linear = linearised(problem)
    gains = rule_gains(linear, share, Stop(budget))
    return [drive_margins(linear, drive, gains) for drive in linear.drives]


# --- one loop ---


def margins_of(loop: OpenLoop) -> Margins:
    """Return the margins of a loop opened at one drive."""
    if loop.radius >= 1.0:
        return Margins(stable=False)
    return _Response(loop).margins()


class _Response:
    """The frequency response of one open loop, with margins."""

    def __init__(self, loop: OpenLoop) -> None:
        self.loop = loop
        self.fastest = math.pi / loop.period

    def at(self, omega: float) -> complex:
        return complex(self.loop.at(np.array([omega]))[0])

    def margins(self) -> Margins:
        up: tuple[float, float | None] = (math.inf, None)
        down: tuple[float, float | None] = (0.0, None)
        for omega, factor in self._gains():
            if factor > 1.0:
                up = min(up, (factor, omega), key=lambda pair: pair[0])
            else:
                down = max(down, (factor, omega), key=lambda pair: pair[0])
        phases = [(self._lag(omega), omega) for omega in self.crossovers]
        phase, phase_at = min(phases, default=(math.inf, None))
        peak, peak_at = self._peak()
        return Margins(
            True, up[0], down[0], math.degrees(phase), self._delay(), peak, up[1], phase_at, peak_at
        )

    # --- frequencies ---

    @cached_property
    def crossovers(self) -> list[float]:
        """Frequencies with |L| = 1, rad/s."""
        a, b, c = self.loop.a, self.loop.b[:, None], self.loop.c[None, :]
        n = len(a)
        zero, unit = np.zeros((n, n)), np.eye(n)
        left = np.block([[a, zero], [-c.T @ c, unit]])
        right = np.block([[unit, -b @ b.T], [zero, a.T]])
        return self._polished(left, right, lambda w: abs(self.at(w)) - 1.0)

    def _gains(self) -> Iterator[tuple[float, float]]:
        """Yield frequencies with real L < 0, and the factor that takes L to -1."""
        a, b, c = self.loop.a, self.loop.b[:, None], self.loop.c[None, :]
        n = len(a)
        left = np.block(
            [[a, np.zeros((n, n)), b],
             [np.zeros((n, n)), np.eye(n), -c.T],
             [c, np.zeros((1, n + 1))]]
        )  # fmt: skip
        right = np.zeros_like(left)
        right[:n, :n], right[n : 2 * n, n : 2 * n] = np.eye(n), a.T
        right[2 * n, n : 2 * n] = b.T
        real = self._polished(left, right, lambda w: self.at(w).imag)
        for omega in [0.0, *real, self.fastest]:
            with np.errstate(all="ignore"):
                try:
                    value = self.at(omega)
                except np.linalg.LinAlgError:  # a pole at q = 1, as of an integrator
                    continue
            size = abs(value)
            if size < INFINITE and value.real < 0.0 and abs(value.imag) <= 1e-6 * size:
                yield float(omega), 1.0 / size

    def _polished(self, left: Vector, right: Vector, miss: Callable[[float], float]) -> list[float]:
        """Return the frequencies of generalised eigenvalues on the unit circle, in order."""
        from scipy.linalg import eigvals
        from scipy.optimize import brentq

        roots = eigvals(left, right)
        roots = roots[np.isfinite(roots)]
        angles = np.angle(roots[np.abs(np.abs(roots) - 1.0) < 1e-4])
        found: list[float] = []
        for near in sorted(angle / self.loop.period for angle in angles if angle > 1e-12):
            omega, low, high = near, near * (1.0 - 1e-3), min(near * (1.0 + 1e-3), self.fastest)
            if near < self.fastest and miss(low) * miss(high) < 0.0:
                omega = float(brentq(miss, low, high, xtol=1e-15 * near, rtol=1e-15))
            elif abs(miss(near)) > 1e-7:
                continue
            if not found or omega - found[-1] > 1e-9 * omega:
                found.append(omega)
        return found

    def _lag(self, omega: float) -> float:
        """Return the lag that takes L to -1 at a crossover, rad, above 0."""
        return float((np.angle(self.at(omega)) + math.pi) % (2.0 * math.pi))

    def _peak(self) -> tuple[float, float]:
        """Return the largest sensitivity and its frequency."""
        from scipy.optimize import minimize_scalar

        grid = np.geomspace(1e-6 * self.fastest, self.fastest, POINTS)
        near = [w for w in self.crossovers if w]
        grid = np.unique(np.concatenate([grid, near]))
        sizes = 1.0 / np.abs(1.0 + self.loop.at(grid))
        best = (float(sizes.max()), float(grid[sizes.argmax()]))
        for k in np.argsort(sizes)[-3:]:
            ends = grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)]
            found = minimize_scalar(
                lambda w: abs(1.0 + self.at(w)), bounds=ends, method="bounded",
                options={"xatol": 1e-12 * ends[1]},
            )  # fmt: skip
            best = max(best, (1.0 / float(found.fun), float(found.x)))
        return best

    # --- dead time ---

    def _delay(self) -> float:
        """Return the least destabilising dead time of the actuator."""
        from scipy.optimize import brentq

        h = self.loop.period
        guesses = sorted(self._lag(w) / w for w in self.crossovers)
        if not guesses or guesses[0] > LONGEST_DELAY * h:
            return math.inf
        # A dead time within a period hardly changes |L|, so the margin is near the least guess;
        # steps of half a period up to the first unstable one, then its limit in between.
        low, step = 0.0, min(0.5 * h, 0.25 * guesses[0])
        high = low + step
        while self._left(high) > 0.0:
            low, high = high, max(high + step, 0.9 * guesses[0])
            if high > LONGEST_DELAY * h:
                return math.inf
        return float(brentq(self._left, low, high, xtol=1e-12 * h))

    def _left(self, delay: float) -> float:
        """Return the further dead time to the limit of a loop with this one, s.

        Negative beyond the limit. Whole periods only rotate L; the rest of the dead time changes
        |L|.
        """
        whole, part = divmod(self.loop.part + delay, self.loop.period)
        late = _Response(late_loop(self.loop, part))
        if not whole and late.loop.radius >= 1.0:  # then the lag to the limit is a full turn less
            passed = ((late._lag(omega) - 2.0 * math.pi) / omega for omega in late.crossovers)
            return max(passed, default=-math.inf)
        lags = (late._lag(omega) / omega for omega in late.crossovers)
        return min(lags, default=math.inf) - whole * self.loop.period


def late_loop(loop: OpenLoop, part: float) -> OpenLoop:
    """Return a loop with a dead time of a part of a period, s, as the actuator's only one."""
    from scipy.linalg import expm

    h, m, n = loop.period, len(loop.ahead), len(loop.a)
    both = np.zeros((m + 1, m + 1))
    both[:m] = loop.ahead
    late = expm(both * (h - part))[:m, m]
    a, b = np.zeros((n + 1, n + 1)), np.zeros(n + 1)
    a[:n, :n] = loop.a
    if loop.part:
        a[:m, loop.before] = 0.0  # its former part of a period is replaced
    a[:m, n] = expm(both * h)[:m, m] - late  # the previous drive acts first
    b[:m], b[n] = late, 1.0
    return OpenLoop(a, b, np.append(loop.c, 0.0), loop.ahead, h)


# --- all gains of the rules ---


def drive_margins(
    linear: LinearisedLoop, drive: Address, gains: tuple[RuleGain, ...] = ()
) -> DriveMargins:
    """Return the margins at a drive: at rest, and the worst over gains of the rules.

    LoopProofError: there is no feedback to the drive.
    """
    loop = linear.opened(drive)
    if not np.abs(loop.at(np.geomspace(1e-4, 1.0, 8) * math.pi / loop.period)).any():
        raise LoopProofError(
            f"at rest '{drive[1]}' does not answer to what it moves: a limit holds, or the rules"
            " are flat there",
            hint="other set points, as in --at temperature=21",
        )
    worst = _worst(linear, drive, gains) if gains else None
    return DriveMargins(drive, loop, margins_of(loop), worst, linear.held)


def rule_gains(
    linear: LinearisedLoop, share: float = 1.0, stop: Stop | None = None
) -> tuple[RuleGain, ...]:
    """Return the bounded gains of all rule bases; empty if one of them has no bounds.

    A rule base with a sector along its linear law at rest is one gain times that sum; otherwise one
    gain for each input, within the bounds of its slopes. See :mod:`fuzzyarm.proof.map.sector`.
    """
    try:
        with stop or Stop():
            return tuple(_gains(linear, share, stop))
    except (UnprovableError, TimeOverError):
        return ()


def _gains(linear: LinearisedLoop, share: float, stop: Stop | None) -> Iterator[RuleGain]:
    for (_, output), group in groupby(
        enumerate(linear.slopes), key=lambda pair: (id(pair[1].sheet), pair[1].output)
    ):
        slopes = list(group)
        sheet, at = slopes[0][1].sheet, slopes[0][1].at
        if not isinstance(sheet, RuleBase):
            raise UnprovableError("a table")
        prover = Prover(sheet, output, stop=stop)
        region = {
            v.name: (at[v.name] - share * (at[v.name] - v.low),
                     at[v.name] + share * (v.high - at[v.name]))
            for v in sheet.inputs
        }  # fmt: skip
        yield from _sector_gain(prover, region, slopes) or _slope_gains(prover, region, slopes)


_Slopes = Sequence[tuple[int, RuleSlope]]


def _sector_gain(
    prover: Prover, region: Mapping[str, tuple[float, float]], slopes: _Slopes
) -> list[RuleGain]:
    """Return the gain along the linear law; none if the rules do not vanish with it."""
    weights = {slope.input: Fraction(slope.value) for _, slope in slopes}
    if not all(weights.values()) or any(slopes[0][1].at.values()):
        return []
    try:
        of = sector(prover, weights, region)
    except NoSectorError:
        return []
    if of.slack or not of.complete:
        return []
    words = f"{prover.rulebase.name}, along {form_text(weights, 4)}"
    return [RuleGain(words, tuple((k, s.value) for k, s in slopes), of.low, of.high)]


def _slope_gains(
    prover: Prover, region: Mapping[str, tuple[float, float]], slopes: _Slopes
) -> list[RuleGain]:
    """Return the slope along each input."""
    found = []
    for index, slope in slopes:
        bounds = prover.slope(region, slope.input)
        if not math.isfinite(bounds.high - bounds.low):
            raise UnprovableError(f"time ran out before '{slope.output}' was bounded")
        words = f"{prover.rulebase.name}, slope along {slope.input}"
        found.append(RuleGain(words, ((index, 1.0),), bounds.low, bounds.high))
    return found


_LEAST = {"gain": 1, "gain_down": -1, "phase": 1, "delay": 1, "sensitivity": -1}
"""Margins, and whether the least or the greatest is the worst."""


def _worst(linear: LinearisedLoop, drive: Address, gains: tuple[RuleGain, ...]) -> WorstMargins:
    """Return the worst margins over a box of gains: descent from its corners."""
    known: dict[tuple[float, ...], Margins] = {}

    def at(values: tuple[float, ...]) -> Margins:
        if values not in known:
            known[values] = margins_of(linear.opened(drive, changed(gains, values)))
        return known[values]

    def cost(name: str, values: tuple[float, ...]) -> float:
        margins = at(values)
        return _LEAST[name] * getattr(margins, name) if margins.stable else -math.inf

    corners = list(dict.fromkeys(product(*((gain.low, gain.high) for gain in gains))))
    worst: dict[str, float] = {}
    where: dict[str, tuple[float, ...]] = {}
    for name in _LEAST:
        start = min(corners, key=partial(cost, name))
        best = _descended(partial(cost, name), start, [(g.low, g.high) for g in gains])
        if not at(best).stable:
            return WorstMargins(gains, Margins(stable=False), {"stable": best})
        worst[name], where[name] = getattr(at(best), name), best
    frequencies = {
        f"{name}_at": getattr(at(where[name]), f"{name}_at")
        for name in ("gain", "phase", "sensitivity")
    }
    return WorstMargins(gains, Margins(True, **worst, **frequencies), where)


def changed(gains: Sequence[RuleGain], values: Sequence[float]) -> dict[int, float]:
    """Return slopes of a loop, by index, for values of its gains."""
    return {
        index: value * times
        for gain, value in zip(gains, values, strict=True)
        for index, times in gain.slopes
    }


def _descended(
    cost: Callable[[tuple[float, ...]], float],
    start: tuple[float, ...],
    bounds: list[tuple[float, float]],
) -> tuple[float, ...]:
    """Return a point of locally least cost: compass search with halved steps."""
    best, share = start, 0.5
    while share > 0.05:
        near = [
            tuple(
                min(max(x + sign * share * (high - low), low), high) if j == k else x
                for j, (x, (low, high)) in enumerate(zip(best, bounds, strict=True))
            )
            for k in range(len(best))
            for sign in (-1, 1)
        ]
        better = min(near, key=cost)
        if cost(better) < cost(best):
            best = better
        else:
            share *= 0.5
    return best
