"""Exact decimal text of numbers, even levels, short forms of lists of numbers, times, periods."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from fuzzyarm.base.errors import UsageError

if TYPE_CHECKING:
    from fractions import Fraction

_MOST_DECIMALS = 6
_SMALLEST_PLAIN = -5
"""Smallest exponent of ten of a bound in plain notation."""

_SHORT = 8


def number_text(value: float) -> str:
    """Return the shortest text that reads back exactly."""
    if not math.isfinite(value):
        return "nan" if math.isnan(value) else ("inf" if value > 0 else "-inf")
    if value == int(value) and abs(value) < 1e15 and not _is_negative_zero(value):
        return str(int(value))
    return repr(float(value))


def _is_negative_zero(value: float) -> bool:
    return value == 0.0 and math.copysign(1.0, value) < 0.0


def percent(share: float, digits: int = 3) -> str:
    """Return a share in percent, to some significant digits, without an exponent."""
    value = 100.0 * share
    if abs(value) >= 10.0 ** (digits - 1):
        return f"{value:.0f} %"
    return f"{value:.{digits}g} %"


def counted(number: int, word: str) -> str:
    """Return ``1 rule`` or ``2 rules``."""
    return f"{number} {word}{'' if number == 1 else 's'}"


def even_levels(low: float, high: float, intervals: int) -> tuple[float, ...]:
    """Return `intervals` + 1 levels from `low` to `high`, each the float nearest its decimal.

    ``-6 .. 6 step 0.1`` has the level -0.3, not -0.2999999999999998; symmetric ends give symmetric
    levels.
    """
    low, high = float(low), float(high)
    step = (high - low) / intervals
    if abs(low) + abs(high) < 1e15 and low.is_integer() and step.is_integer():
        return tuple(low + step * i for i in range(intervals + 1))
    first, last = decimal(low), decimal(high)
    return tuple(float(first + (last - first) * i / intervals) for i in range(intervals + 1))


def decimal(x: float) -> Fraction:
    """Return the decimal value of a float as printed."""
    from fractions import Fraction

    return Fraction(repr(float(x)))


def column_of_numbers(values: Sequence[float]) -> list[str]:
    """Return texts with equally many decimals if few suffice, else the shortest ones."""
    texts = [number_text(x) for x in values]
    if any("e" in text for text in texts):
        return texts
    decimals = max((len(text.partition(".")[2]) for text in texts), default=0)
    if decimals > _MOST_DECIMALS:
        return texts
    return [f"{x:.{decimals}f}" for x in values]


def evenly(low: float, high: float, count: int) -> tuple[float, ...]:
    """Return `count` even levels from `low` to `high`, as defined by the language."""
    if count == 1:
        return (0.5 * low + 0.5 * high,)
    return even_levels(low, high, count - 1)


def mirror(numbers: Iterable[float]) -> tuple[float, ...]:
    """Return the numbers and their negatives, sorted, zero once."""
    positive = [abs(x) for x in numbers]
    return tuple(sorted({*positive, *(-x + 0.0 for x in positive)}))


def short_levels(levels: Sequence[float]) -> str:
    """Return the short form with ``step`` or ``count`` if it gives exactly `levels`."""
    count = len(levels)
    if count > 2 and evenly(levels[0], levels[-1], count) == tuple(levels):
        ends = f"{number_text(levels[0])} .. {number_text(levels[-1])}"
        step = number_text((levels[-1] - levels[0]) / (count - 1))
        return f"{ends} step {step}" if len(step) <= _SHORT else f"{ends} count {count}"
    return " ".join(number_text(x) for x in levels)


def short_bins(bins: Sequence[float]) -> str:
    """Return the positive half and ``mirrored`` if `bins` are symmetric, else all of them."""
    half = [x for x in bins if x >= 0]
    if len(bins) > 1 and mirror(half) == tuple(bins):
        return " ".join(number_text(x) for x in half) + " mirrored"
    return " ".join(number_text(x) for x in bins)


def outward_text(value: float, *, up: bool, digits: int = 7) -> str:
    """Return a number to some digits, rounded outward so that a bound stays valid.

    A number that Python writes with as few digits is written so: read back, it is the same.
    """
    if not math.isfinite(value) or value == 0.0:
        return f"{value:g}"
    from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal

    exact = Decimal(repr(value))
    step = Decimal(1).scaleb(exact.adjusted() - digits + 1)
    rounded = exact.quantize(step, ROUND_CEILING if up else ROUND_FLOOR).normalize()
    if rounded.adjusted() >= _SMALLEST_PLAIN:
        return f"{rounded:f}"
    digits_, _, exponent = f"{rounded:e}".partition("e")
    return f"{digits_}e{int(exponent):03d}"  # as Python writes a float: 2.5e-08


def inward_interval(low: float, high: float, digits: int) -> str:
    """Return a proved interval as text, rounded inward."""
    ends = outward_text(low, up=True, digits=digits), outward_text(high, up=False, digits=digits)
    return " .. ".join(ends)


# --- Times ---

TIMES = {
    "us": (1.0, 1e6),
    "ms": (1.0, 1e3),
    "s": (1.0, 1.0),
    "min": (60.0, 1.0),
    "h": (3600.0, 1.0),
}
"""Units of time as a multiplier and a divisor of seconds, so that 0.6 ms is the nearest float."""


def read_time(text: str, option: str) -> float:
    """Read a time with its unit, s."""
    match = re.fullmatch(r"([0-9.eE+-]+)\s*([a-z]+)", text.strip())
    try:
        if match is None or match[2] not in TIMES:
            raise ValueError
        times, divisor = TIMES[match[2]]
        value = float(match[1]) * times / divisor
        if not math.isfinite(value):
            raise ValueError
    except ValueError:
        units = ", ".join(TIMES)
        raise UsageError(f"{option} takes a time with a unit ({units}), not '{text}'") from None
    if value < 0.0:
        raise UsageError(f"{option} is not negative, as '{text}' is")
    return value


def whole_periods(time: float, period: float) -> int:
    """Return a time in whole control periods, halves rounded up."""
    return math.floor(time / period + 0.5 + 1e-9)


def is_whole(time: float, period: float) -> bool:
    """Whether a time is a whole number of control periods, as decimals or as floats."""
    count = whole_periods(time, period)
    return time == count * period or decimal(time) == count * decimal(period)


def fraction_of_periods(time: float, period: float) -> str:
    """Return the predicate for a time between two multiples of the control period."""
    text = f"{time / period:.12g}"
    # One float beside a whole number, the quotient is rounded to that number.
    beside = f"{number_text(time)} s, not " if text == str(whole_periods(time, period)) else ""
    return f"is {beside}{text} control periods"
