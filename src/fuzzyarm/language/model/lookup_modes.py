"""The ways to look a table up, for all that read, offer or check their names.

Nothing is imported here: commands list the modes before they load anything.
"""

from __future__ import annotations

from typing import Literal, get_args

LookupMode = Literal["bins", "nearest", "linear"]
"""By uneven thresholds, by the nearest level, by linear interpolation."""

LOOKUP_MODES: tuple[str, ...] = get_args(LookupMode)
"""Their names."""
