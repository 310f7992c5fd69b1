"""Actuators between controller and plant: range, slew, dead time; a period in parts.

A dead time is a number of whole control periods and a fraction of one; the value changes at that
fraction of the period. The kernels are those of the loop and of a plant as a python-control system.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from fuzzyarm.base.numbers import is_whole, whole_periods
from fuzzyarm.plant.plant import ADVANCE, PARTS, STEP, TASK, TIME, Port
from fuzzyarm.plant.setting import stored
from fuzzyarm.symbolic.kernels import call, kernel


def dead_time(delay: float, period: float) -> tuple[int, float]:
    """Return a dead time in whole control periods, and the rest, s."""
    if is_whole(delay, period):
        return whole_periods(delay, period), 0.0
    count = math.floor(delay / period)
    return count, delay - count * period


def dead_time_rows(ports: Sequence[Port], period: float, most: int) -> list[float]:
    """Return the dead times of inputs, as :data:`ACTUATOR` has them; empty without any.

    Parameters
    ----------
    ports : sequence of Port
        Inputs of the plant.
    period : float
        Of control, s.
    most : int
        Control periods of the run: a longer dead time changes nothing in it.
    """
    if not any(port.dead_time for port in ports):
        return []
    parts = [dead_time(port.dead_time, period) for port in ports]
    turns = sorted(range(len(ports)), key=lambda k: parts[k][1])
    rows: list[float] = []
    values: list[float] = []
    for port, (count, rest), turn in zip(ports, parts, turns, strict=True):
        rows += [min(count, most), rest, ACTUATOR * len(ports) + len(values), port.idle, turn]
        values += [port.idle] * min(count, most)
    return rows + values


# --- Kernels ---


@kernel
def ask_plant(
    task: int,
    links: list[int],
    x: list[float],
    y: list[float],
    u: list[float],
    p: list[float],
    clock: list[float],
) -> None:
    """Call the plant with a task, see :mod:`fuzzyarm.plant.plant`."""
    clock[TASK] = task
    call(links[0], x, y, u, p, clock)


@kernel
def limit(drives: list[float], limits: list[float], single: bool) -> None:
    """Limit all drives."""
    for i in range(len(drives)):
        drives[i] = limited(drives[i], limits, 4 * i, single)


@kernel
def limited(command: float, limits: list[float], at: int, single: bool) -> float:
    """Limit a drive in range and slew; NaN passes."""
    value = stored(command, single)
    # Range before slew: a drive leaves its limit at the full slew rate.
    value = max(value, limits[at])
    value = min(value, limits[at + 1])
    value = max(value, limits[at + 3] - limits[at + 2])
    value = min(value, limits[at + 3] + limits[at + 2])
    limits[at + 3] = value
    return value


# Dead times.
#
# Five numbers for each drive, followed by the rings of delayed values. A dead time is so many
# periods and a part of one: at that part of the period the plant gets the next value.

WHOLE_PERIODS, PART, DEAD_TIME_RING, ARRIVING, TURN = range(5)
ACTUATOR = 5
"""Of an actuator: its dead time in whole periods, the rest, s, the index of its ring, the value
that arrives in this period; and, for the row, the drive whose value arrives next."""


@kernel
def postpone(drives: list[float], dead_times: list[float], tick: int) -> None:
    """Replace the drives by those in effect at the start of the period, if any are delayed."""
    if len(dead_times) == 0:
        return
    for i in range(len(drives)):
        at = ACTUATOR * i
        arriving = handed_on(
            dead_times,
            int(dead_times[at + DEAD_TIME_RING]),
            int(dead_times[at + WHOLE_PERIODS]),
            drives[i],
            tick,
        )
        drives[i] = dead_times[at + ARRIVING] if dead_times[at + PART] > 0.0 else arriving
        dead_times[at + ARRIVING] = arriving


@kernel
def advance(
    links: list[int],
    x: list[float],
    y: list[float],
    u: list[float],
    p: list[float],
    clock: list[float],
    dead_times: list[float],
    pushes: list[float],
    tick: int,
) -> None:
    """Advance the plant by a period; drives change inside it where their dead times end."""
    if len(dead_times) == 0:
        ask_plant(ADVANCE, links, x, y, u, p, clock)
        return
    # The period is cut at the rests of the dead times in increasing order (TURN is sorted by them);
    # in each part the drives are constant, as the plant's integrator assumes.
    whole, parts, begin = clock[STEP], clock[PARTS], clock[TIME]
    done = 0.0
    for turn in range(len(u) + 1):
        end = whole
        i = 0
        if turn < len(u):
            i = int(dead_times[ACTUATOR * turn + TURN])
            end = dead_times[ACTUATOR * i + PART]
        if end > done:  # of equal rests the first has advanced already
            clock[TIME], clock[STEP] = begin + done, end - done
            # Integration steps as long as in a whole period at most; 1e-9 absorbs the rounding.
            clock[PARTS] = max(math.ceil(parts * (end - done) / whole - 1e-9), 1.0)
            ask_plant(ADVANCE, links, x, y, u, p, clock)
            done = end
        if turn < len(u) and end > 0.0:
            u[i] = dead_times[ACTUATOR * i + ARRIVING]
            if len(pushes) > 0:
                u[i] += pushes[tick * len(u) + i]
    clock[TIME], clock[STEP], clock[PARTS] = begin, whole, parts


@kernel
def handed_on(line: list[float], ring: int, count: int, value: float, tick: int) -> float:
    """Delay a value by `count` periods with a ring buffer of that length."""
    if count == 0:
        return value
    cell = ring + tick % count
    before = line[cell]
    line[cell] = value
    return before
