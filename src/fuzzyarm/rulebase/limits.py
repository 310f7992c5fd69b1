"""What the language refuses as absurd, so that no file can exhaust time or memory."""

from __future__ import annotations

MAX_CHARACTERS = 4_000_000
"""Longest text that is read at all."""

MAX_LINES = 150_000
"""Most lines of a text."""

MAX_LINE = 20_000
"""Longest single line, in characters."""

MAX_INPUTS = 32
MAX_OUTPUTS = 32
MAX_TERMS = 1_000
"""Most terms of one variable."""

MAX_RULES = 100_000
MAX_NESTING = 50
"""Deepest nesting of parentheses in an antecedent."""

MAX_LEVELS = 100_000
"""Most levels of one lookup axis."""

MAX_MAGNITUDE = 1e100
"""Largest number of a range or a shape, infinity apart: areas and moments are its powers."""

MIN_WIDTH = 1e-100
"""Smallest width of a range, and smallest spread of a shape."""

MAX_DIAGNOSTICS = 1_000
"""Most findings that one run reports; behind them reading stops."""
