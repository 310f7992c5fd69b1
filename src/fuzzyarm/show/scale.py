"""From a number to a colour: one scale for terminals and, by its name, for figures.

Both scales are safe for colour-blind eyes: blue to red through near-white for values with
a sign, dark blue to yellow for those without.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

_DIVERGING = ((33, 102, 172), (146, 197, 222), (247, 247, 247), (244, 165, 130), (178, 24, 43))
_SEQUENTIAL = ((68, 1, 84), (59, 82, 139), (33, 145, 140), (94, 201, 98), (253, 231, 37))


@dataclass(frozen=True, slots=True)
class Scale:
    """A stretch of numbers spread over colours.

    Attributes
    ----------
    low, high : float
        The ends; numbers beyond take the colour of the end.
    diverging : bool
        Whether zero is the neutral middle.
    """

    low: float
    high: float
    diverging: bool

    def share(self, value: float) -> float:
        """Return where `value` lies, 0 at `low` and 1 at `high`."""
        if self.high <= self.low:
            return 0.5
        return min(1.0, max(0.0, (value - self.low) / (self.high - self.low)))

    def colour(self, value: float) -> tuple[int, int, int]:
        """Return red, green and blue, 0 to 255."""
        stops = self.stops
        place = self.share(value) * (len(stops) - 1)
        i = min(int(place), len(stops) - 2)
        part = place - i
        red, green, blue = (
            round(a + part * (b - a)) for a, b in zip(stops[i], stops[i + 1], strict=True)
        )
        return red, green, blue

    def ink(self, value: float) -> str:
        """Return ``black`` or ``white``, whichever is readable on the colour of `value`."""
        red, green, blue = self.colour(value)
        return "black" if 0.299 * red + 0.587 * green + 0.114 * blue > 140 else "white"

    def style(self, value: float) -> str:
        """Return the terminal style of a cell with `value`."""
        red, green, blue = self.colour(value)
        return f"{self.ink(value)} on #{red:02x}{green:02x}{blue:02x}"

    @property
    def stops(self) -> tuple[tuple[int, int, int], ...]:
        """The colours at even distances from `low` to `high`."""
        return _DIVERGING if self.diverging else _SEQUENTIAL


def scale_of(values: Iterable[float], low: float | None = None, high: float | None = None) -> Scale:
    """Return the scale for `values`: diverging and symmetric if they have both signs.

    Parameters
    ----------
    values : iterable of float
        What will be coloured; numbers that are not finite are passed over.
    low, high : float, optional
        The range of the variable, which widens the scale where it is finite.
    """
    ends = [x for x in (*values, low, high) if x is not None and math.isfinite(x)]
    if not ends:
        return Scale(0.0, 1.0, diverging=False)
    least, most = min(ends), max(ends)
    if least < 0.0 < most:
        reach = max(-least, most)
        return Scale(-reach, reach, diverging=True)
    return Scale(least, most, diverging=False)
