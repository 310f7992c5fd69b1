"""A map of the starts of a loop: proved, refuted and open boxes of a window."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.numbers import decimal, number_text, outward_text
from fuzzyarm.base.shown import Shown, one_line
from fuzzyarm.language.loop_claims import stretch_text
from fuzzyarm.language.tokens import name_text
from fuzzyarm.proof.check.certificate import Certificate
from fuzzyarm.proof.claim.problem import ClaimError
from fuzzyarm.symbolic.operations import Interval

PROVED, REFUTED, OPEN = "proved", "refuted", "open"


@json_properties("*")
class MappedBox(NamedTuple):
    """A part of the window.

    Attributes
    ----------
    low, high : tuple of float
        Its ends, in the order of the window.
    verdict : str
        ``proved``, ``refuted`` or ``open``.
    periods : int
        Control periods until all of its runs are in the region, or lost; in a `chained` map, until
        they are in the region or in another proved box.
    reason : str
        Why the box is refuted or open.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]
    verdict: str
    periods: int
    reason: str = ""

    @property
    def opposite(self) -> MappedBox:
        """The box of an odd loop mirrored at the origin."""
        low, high = (tuple(0.0 - x for x in ends) for ends in (self.high, self.low))
        return self._replace(low=low, high=high)


@json_properties(
    "property=statement window others proved refuted open starts settled settled_proved"
    " within=longest region rest boxes seconds reason"
)
@dataclass(frozen=True, repr=False, kw_only=True)
class StartMap(Shown):
    """The starts of a loop in a window, with the results so far.

    Attributes
    ----------
    statement : str
        The loop, in words.
    window : dict of str to Interval
        The starts; other states begin at the plant's own start.
    others : dict of str to float
        Starts of the other states.
    boxes : tuple of MappedBox
        A partition of the window.
    region : dict of str to (float, float)
        Reach of the region around rest, in which all tubes end.
    rest : dict of str to float
        The equilibrium.
    certificate : Certificate or None
        Certificate of that region, or of the whole map.
    starts, settled, settled_proved : int
        Numbers of random starts, of those with runs that come to rest, and of these in proved
        boxes.
    seconds, work : float
        Time by the clock, and of the processors.
    period : float
        Control period, s.
    units : dict of str to str
        Of the states.
    reason : str
        Why nothing was proved; empty with a region.
    chained : bool
        Whether boxes may end in other proved boxes.
    """

    statement: str
    window: Mapping[str, Interval]
    others: Mapping[str, float]
    boxes: tuple[MappedBox, ...] = field(repr=False)
    region: Mapping[str, tuple[float, float]]
    rest: Mapping[str, float]
    certificate: Certificate | None
    starts: int
    settled: int
    settled_proved: int
    seconds: float
    work: float
    period: float
    units: Mapping[str, str] = field(default_factory=dict, repr=False)
    reason: str = ""
    chained: bool = False

    def share(self, verdict: str) -> float:
        """Return the share of the window's volume with a verdict."""
        return math.fsum(share for (kind, _), share in self._shares.items() if kind == verdict)

    @cached_property
    def _shares(self) -> Mapping[tuple[str, str], float]:
        """The shares of the window's volume by verdict and reason."""
        sides = [span.high - span.low for span in self.window.values()]
        totals: dict[tuple[str, str], float] = defaultdict(float)
        for box in self.boxes:
            share = 1.0
            for low, high, side in zip(box.low, box.high, sides, strict=True):
                share *= (high - low) / side
            totals[box.verdict, box.reason] += share
        return totals

    @property
    def proved(self) -> float:
        """The share of the window from which every run comes to rest."""
        return self.share(PROVED)

    @property
    def refuted(self) -> float:
        """The share from which runs are lost."""
        return self.share(REFUTED)

    @property
    def open(self) -> float:
        """The undecided share, unexamined parts included."""
        rest = 1.0 - self.decided
        return max(self.share(OPEN), rest if rest > 1e-9 else 0.0)

    @property
    def decided(self) -> float:
        """The share of the volume proved or refuted."""
        return self.proved + self.refuted

    @property
    def verdict(self) -> str:
        """``refuted`` if runs of a box are lost, ``undecided`` if one is open, else ``proved``."""
        found = {box.verdict for box in self.boxes}
        return REFUTED if REFUTED in found else "undecided" if OPEN in found else PROVED

    @property
    def uncertified(self) -> str:
        """Why no certificate of boxes can be written; empty if one can."""
        if self.certificate is not None and self.certificate.tubes:
            return ""
        return self.reason or "nothing of the window is proved"

    @property
    def covered(self) -> float:
        """The share in proved boxes of random starts whose runs come to rest; NaN without any."""
        return self.settled_proved / self.settled if self.settled else math.nan

    @property
    def longest(self) -> float:
        """Time until all runs from proved boxes are in the region, s; NaN: unknown.

        In a `chained` map only a certificate knows it, which has the whole way.
        """
        return math.nan if self.chained else self._longest

    @property
    def _longest(self) -> float:
        most = max((b.periods for b in self.boxes if b.verdict == PROVED), default=0)
        return float(most * decimal(self.period))

    def verdict_at(self, **start: float) -> str:
        """Return the verdict on a start, by state; `open` outside the window."""
        unknown = [name for name in start if name not in self.window]
        if unknown or len(start) < len(self.window):
            raise ClaimError(f"a start of the map has {', '.join(self.window)}")
        at = [start[name] for name in self.window]
        for box in self.boxes:
            if all(a <= x <= b for a, x, b in zip(box.low, at, box.high, strict=True)):
                return box.verdict
        return OPEN

    def reasons(self) -> list[tuple[str, float]]:
        """Return the reasons of open boxes with their shares of the volume, largest first."""
        found = [(reason, share) for (kind, reason), share in self._shares.items() if kind == OPEN]
        return sorted(found, key=lambda pair: -pair[1])

    def sentence(self) -> str:
        """Return the coverage in a sentence."""
        window = ", ".join(
            stretch_text((name, span.low, span.high)) for name, span in self.window.items()
        )
        return (
            f"from {_percent(self.proved)} of {window} every run comes to rest, from"
            f" {_percent(self.refuted)} runs are lost, {_percent(self.open)} is open"
        )

    def __repr__(self) -> str:
        return one_line(self, f"map of {self.statement}: {_percent(self.proved)} proved")

    def __str__(self) -> str:
        lines = [f"map: {self.statement}", f"  {self.sentence()}"]
        if self.others:
            begun = ", ".join(
                f"{name_text(name)} = {number_text(x)}" for name, x in self.others.items()
            )
            lines.append(f"  the other states begin at {begun}")
        if self._longest:
            longest = outward_text(self._longest, up=True)
            goal = "the region around rest" + " or a box proved before" * self.chained
            lines.append(f"  within {longest} s all proved runs are in {goal}")
        if self.starts:
            lines.append(
                f"  of {self.starts} drawn starts {self.settled} came to rest, and of those"
                f" {_percent(self.covered)} are proved"
            )
        lines += [f"  open, {_percent(share)}: {reason}" for reason, share in self.reasons()[:3]]
        return "\n".join([*lines, *([f"  {self.reason}"] if self.reason else [])])


def _percent(share: float) -> str:
    """Return a share in per cent, never rounded up to all."""
    if math.isnan(share):
        return "none"
    tenths = math.floor(1000.0 * share + 1e-9) / 10.0
    return f"{tenths:g} %"
