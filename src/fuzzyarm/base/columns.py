"""Rows of texts under each other, in columns as wide as their widest text."""

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
    """Return a line for each row; blanks at the end of a line go.

    Parameters
    ----------
    rows : sequence of sequence of str
        Their texts; a row may be shorter than others.
    sides : str
        ``<`` or ``>`` for each column: where its texts stand. The last one holds for all further
        columns; ``.`` is ``<`` for a column that makes no other wider, as the last one often is.
    gap : str
        Between two columns.
    indent : str
        In front of each line.
    least : sequence of int
        Letters that each column has at least; the last one holds for all further columns.

    Examples
    --------
    >>> in_columns([("gain", "value"), ("G_e", "17.25")], "<>")
    ['gain  value', 'G_e   17.25']
    """
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
