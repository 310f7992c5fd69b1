"""The control periods in which a claim counts: one rule for tubes, regions and their checker.

Times are the decimals that they are printed as, and the k-th sample is at k periods. A claim
includes both of its ends. An output is continuous: at a sample it is where the period before ends
and the next one begins. A drive jumps there: what it was and what it becomes count, at both ends.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from fuzzyarm.base.numbers import decimal
from fuzzyarm.language.model.claims import LoopClaim


class ClaimedPeriods(NamedTuple):
    """The first and the last control period, counted from 0; no last one: for ever."""

    first: int
    last: int | None


def claimed_periods(claim: LoopClaim, period: float, *, jumps: bool) -> ClaimedPeriods:
    """Return the control periods that a claim counts in.

    Parameters
    ----------
    claim : LoopClaim
        With 0 ≤ begin ≤ end and end > 0.
    period : float
        s.
    jumps : bool
        Whether it is of a drive.
    """
    begin = decimal(claim.begin) / decimal(period)
    first = max(0, math.ceil(begin) - 1) if jumps else math.floor(begin)
    if math.isinf(claim.end):
        return ClaimedPeriods(first, None)
    end = decimal(claim.end) / decimal(period)
    last = math.floor(end) if jumps else math.ceil(end) - 1
    return ClaimedPeriods(min(first, last), last)
