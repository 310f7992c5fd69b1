"""One input of a lookup table: its levels, its bins, and the cell that a number falls into."""

from __future__ import annotations

import itertools
import math
from bisect import bisect_left
from collections.abc import Iterable
from dataclasses import dataclass

from fuzzyarm.errors import FuzzyarmError

MODES = ("bins", "nearest", "linear")
"""Ways to look up: by uneven thresholds, by the nearest level, by linear interpolation."""

_ALIASES = {"bilinear": "linear", "multilinear": "linear"}


class TableError(FuzzyarmError, ValueError):
    """A table, or a question to a table, that makes no sense."""


def mode_named(name: str) -> str:
    """Return the mode called `name`; ``bilinear`` and ``multilinear`` are ``linear``."""
    mode = _ALIASES.get(name, name)
    if mode not in MODES:
        raise TableError(f"no lookup mode '{name}'", hint=f"there are {', '.join(MODES)}")
    return mode


@dataclass(frozen=True, slots=True)
class Axis:
    """How one input of a table is divided.

    Attributes
    ----------
    name : str
        The input.
    levels : tuple of float
        The sample points, strictly increasing; one at least.
    bins : tuple of float or None
        Thresholds between neighbouring cells, strictly increasing, one fewer than levels.
        None: the cell of the nearest level.
    low, high : float
        The range of the input, for drawings and reports; the outer levels by default.
        Infinite where the input is unbounded.
    description : str
        Free text, with the unit.

    Raises
    ------
    TableError
        If the numbers are not finite, do not increase or do not match in number.
    """

    name: str
    levels: tuple[float, ...]
    bins: tuple[float, ...] | None = None
    low: float = math.nan
    high: float = math.nan
    description: str = ""

    def __post_init__(self) -> None:
        levels = _clean(self.levels)
        if not levels:
            raise TableError(f"axis '{self.name}' has no levels")
        _require_increasing(levels, f"the levels of '{self.name}'")
        if not math.isfinite(levels[-1] - levels[0]):
            raise TableError(f"the levels of '{self.name}' are too far apart")
        object.__setattr__(self, "levels", levels)
        if self.bins is not None:
            bins = _clean(self.bins)
            _require_increasing(bins, f"the bins of '{self.name}'")
            if len(bins) != len(levels) - 1:
                raise TableError(
                    f"axis '{self.name}' has {len(levels)} levels and so needs "
                    f"{len(levels) - 1} bins, not {len(bins)}"
                )
            object.__setattr__(self, "bins", bins)
        low, high = float(self.low) + 0.0, float(self.high) + 0.0
        low = levels[0] if math.isnan(low) else low
        high = levels[-1] if math.isnan(high) else high
        if low > high:
            raise TableError(f"the range of '{self.name}' runs from {low:g} down to {high:g}")
        object.__setattr__(self, "low", low)
        object.__setattr__(self, "high", high)

    def thresholds(self, mode: str) -> tuple[float, ...]:
        """Return the thresholds between the cells for ``bins`` or ``nearest``.

        The cell of x is the number of thresholds smaller than x, so an x equal to a
        threshold belongs to the lower cell. The thresholds of ``nearest`` are the
        midpoints between the levels: a tie goes to the lower level.
        """
        if mode == "bins" and self.bins is not None:
            return self.bins
        levels = self.levels
        return tuple(0.5 * a + 0.5 * b for a, b in itertools.pairwise(levels))

    def cell(self, x: float, mode: str = "bins") -> int:
        """Return the index of the cell of `x` by ``bins`` or by ``nearest``."""
        return bisect_left(self.thresholds(mode), x)

    def cell_range(self, index: int, mode: str = "bins") -> tuple[float, float]:
        """Return the stretch (from, to] of inputs that cell `index` stands for."""
        edges = (-math.inf, *self.thresholds(mode), math.inf)
        return edges[index], edges[index + 1]


def _clean(numbers: Iterable[float]) -> tuple[float, ...]:
    # Adding zero turns -0.0 into 0.0: two spellings of one level would never compare equal as text.
    return tuple(float(x) + 0.0 for x in numbers)


def _require_increasing(numbers: tuple[float, ...], what: str) -> None:
    for x in numbers:
        if not math.isfinite(x):
            raise TableError(f"{what} must be finite, not {x}")
    for a, b in itertools.pairwise(numbers):
        if a >= b:
            raise TableError(f"{what} must increase, but {b:g} follows {a:g}")
