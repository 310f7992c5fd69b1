r"""Tables as LaTeX, to be read and printed: a ``tabular`` for each page, without packages."""

from __future__ import annotations

import re
from itertools import product
from typing import TYPE_CHECKING

from fuzzyarm.base.names import printable
from fuzzyarm.base.numbers import column_of_numbers, number_text

if TYPE_CHECKING:
    from fuzzyarm.table.axis import PlainTable

__all__ = ["write_latex"]

_SPECIAL = {
    "\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", '"': "''",
    **{mark: f"${mark}$" for mark in "<>|"}, **{mark: f"\\{mark}" for mark in "#$%&_{}"},
}  # fmt: skip
"""Special characters of LaTeX → their escapes."""


def write_latex(table: PlainTable) -> str:
    """Return a table in LaTeX: rows go down, columns across, further inputs are pages."""
    across = [_number(x) for x in table.axes[-1].levels]
    rows = table.axes[-2].levels if len(table.axes) > 1 else ()
    cells = column_of_numbers(table.values)
    pages = list(product(*(axis.levels for axis in table.axes[:-2])))
    size = len(cells) // max(1, len(pages))
    parts = ["".join(f"% {printable(line)}\n" for line in _heading(table))]
    for number, page in enumerate(pages):
        part = cells[number * size : (number + 1) * size]
        parts.append(_tabular(table, page, across, rows, part))
    return "\n".join(parts)


def _heading(table: PlainTable) -> list[str]:
    words = f"{table.output} over {', '.join(table.names)}"
    return [words, *(f"{key}: {value}" for key, value in table.provenance)]


def _tabular(
    table: PlainTable,
    page: tuple[float, ...],
    across: list[str],
    rows: tuple[float, ...],
    cells: list[str],
) -> str:
    names = [_text(name) for name in table.names]
    output = _text(table.output)
    lines = []
    if page:
        where = ", ".join(
            f"{name} = {_number(x)}" for name, x in zip(names[:-2], page, strict=True)
        )
        lines.append(f"\\noindent {output}, {where}\\\\[1ex]")
    corner = f"{names[-2]} $\\backslash$ {names[-1]}" if rows else names[-1]
    lines += [
        f"\\begin{{tabular}}{{r|{'r' * len(across)}}}",
        f"{corner} & {' & '.join(across)} \\\\",
        "\\hline",
    ]
    width = len(across)
    for number, label in enumerate([_number(x) for x in rows] or [output]):
        row = cells[number * width : (number + 1) * width]
        lines.append(f"{label} & {' & '.join(map(_math, row))} \\\\")
    return "\n".join([*lines, "\\end{tabular}", ""])


def _number(x: float) -> str:
    return _math(number_text(x))


def _math(written: str) -> str:
    """Return a number with the minus sign and the power of mathematics."""
    base, _, power = written.strip().partition("e")
    return f"${base} \\cdot 10^{{{int(power)}}}$" if power else f"${base}$"


def _text(name: str) -> str:
    """Return anybody's name as LaTeX prints it."""
    return re.sub(r"[\\~^<>|\"#$%&_{}]", lambda match: _SPECIAL[match[0]], printable(name))
