"""What one exported C file is put together from: names, shared constants, small helpers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from fuzzyarm.export.names import Names

WIDTH = 96
"""Longest line of a list of numbers."""

SIZES = {"float": 4, "double": 8, "int16_t": 2, "int8_t": 1}
"""Bytes of the types that constants have."""


@dataclass
class CWriter:
    """Collects the parts of a file; equal constants and helpers are written once.

    Attributes
    ----------
    prefix : str
        Begins every name that the file defines.
    storage : str
        ``static inline`` for a header on its own, empty for a ``.c`` file.
    """

    prefix: str
    storage: str = ""
    names: Names = field(default_factory=Names)
    constants: list[str] = field(default_factory=list)
    helpers: list[str] = field(default_factory=list)
    functions: list[str] = field(default_factory=list)
    flash: int = 0
    _known: dict[object, str] = field(default_factory=dict)

    def constant(self, kind: str, literals: Sequence[str], wanted: str, columns: int = 0) -> str:
        """Return the name of a constant array with these literals; equal ones are shared."""
        key = ("constant", kind, tuple(literals))
        if key not in self._known:
            name = self.names.new(f"{self.prefix}_{wanted}")
            self._known[key] = name
            self.flash += SIZES[kind] * len(literals)
            body = "\n".join(number_lines(literals, columns))
            self.constants.append(
                f"static const {kind} {name}[{len(literals)}] = {{\n{body}\n}};\n"
            )
        return self._known[key]

    def helper(self, wanted: str, template: str, **words: str) -> str:
        """Return the name of a small function made of `template`, where NAME is its name."""
        key = ("helper", template, tuple(sorted(words.items())))
        if key not in self._known:
            name = self.names.new(f"{self.prefix}_{wanted}")
            self._known[key] = name
            text = template.replace("NAME", name)
            for word, replacement in words.items():
                text = text.replace(word, replacement)
            keyword = "static inline" if self.storage else "static"
            self.helpers.append(f"{keyword} {text}")
        return self._known[key]


def number_lines(literals: Sequence[str], columns: int = 0, indent: str = "    ") -> list[str]:
    """Return literals as lines, `columns` to a line if they fit, right-aligned."""
    width = max(map(len, literals))
    fitting = max(1, (WIDTH - len(indent)) // (width + 2))
    per_line = columns if 0 < columns <= fitting else fitting
    if 0 < fitting < columns:  # equal parts of a row, so that rows stay visible
        parts = -(-columns // fitting)
        per_line = -(-columns // parts)
    rows = (
        [literals[i : i + columns] for i in range(0, len(literals), columns)]
        if columns
        else [literals]
    )
    parts_of_rows = [row[i : i + per_line] for row in rows for i in range(0, len(row), per_line)]
    lines = [indent + ", ".join(x.rjust(width) for x in part) + "," for part in parts_of_rows]
    lines[-1] = lines[-1].removesuffix(",")
    return lines


COUNT_BELOW = """INDEX NAME(const TYPE *edges, INDEX count, TYPE x)
{
    INDEX low = 0u, high = count;
    while (low < high) {
        const INDEX middle = low + (high - low) / 2u;
        if (edges[middle] < x) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low; /* the number of edges smaller than x; none for NaN */
}
"""

COUNT_UP_TO = """INDEX NAME(const TYPE *levels, INDEX count, TYPE x)
{
    INDEX low = 0u, high = count;
    while (low < high) {
        const INDEX middle = low + (high - low) / 2u;
        if (levels[middle] <= x) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low; /* the number of levels that x has reached */
}
"""

CLAMP = """TYPE NAME(TYPE x, TYPE low, TYPE high)
{
    return x > low ? (x < high ? x : high) : low; /* low for NaN */
}
"""

BLEND_FLOAT = """TYPE NAME(TYPE near, TYPE far, TYPE share)
{
    return (ONE - share) * near + share * far;
}
"""

BLEND_FIXED = """int32_t NAME(int32_t near, int32_t far, int32_t share)
{
    const int32_t product = (far - near) * share;
    return near + (product >= 0 ? (product + 16384) / 32768 : -((16384 - product) / 32768));
}
"""
