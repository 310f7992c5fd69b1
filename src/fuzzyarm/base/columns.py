"""Rows of text in aligned columns."""

from __future__ import annotations

from collections.abc import Sequence


def in_columns(
    rows: Sequence[Sequence[str]],
    sides: str = "<",
    *,
    gap: str = "  ",
    indent: str = "",
    least: Sequence[int] = (),
) -> list[str]:
    """Return one line for each row, without trailing blanks."""
    count = max(map(len, rows), default=0)
    sides += sides[-1] * (count - len(sides))
    floors = [*least, *[least[-1] if least else 0] * (count - len(least))]
    widths = [
        max([floors[k], *(len(row[k]) for row in rows if k < len(row) and sides[k] != ".")])
        for k in range(count)
    ]
    lines = []
    for row in rows:
        cells = (
            cell.rjust(width) if side == ">" else cell.ljust(width)
            for cell, width, side in zip(row, widths, sides, strict=False)
        )
        lines.append((indent + gap.join(cells)).rstrip())
    return lines
