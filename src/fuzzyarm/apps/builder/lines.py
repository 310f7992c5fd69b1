"""The language lines of one builder call, with the argument behind each part."""

from __future__ import annotations

import math
import numbers
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from fuzzyarm.base.diagnostic import Span, split_lines
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.names import quote, shortened
from fuzzyarm.base.numbers import number_text
from fuzzyarm.language.model.rulebase import Defuzzifier, Shape
from fuzzyarm.language.phrases import ShapeNode
from fuzzyarm.language.tokens import name_text
from fuzzyarm.language.writer import shape_node

Corners = float | Sequence[float] | Sequence[tuple[float, float]] | Shape | str
"""Accepted forms of a term; see :meth:`fuzzyarm.RuleBaseBuilder.input`."""

Terms = str | Sequence[str] | Mapping[str, Corners]

Levels = str | Sequence[float]


class BuilderArgumentError(FuzzyarmError, TypeError):
    """An argument of a type that the builder does not accept.

    Attributes
    ----------
    argument : str
        The call and the argument.
    """

    def __init__(self, argument: str, message: str) -> None:
        super().__init__(f"{argument}: {message}")
        self.argument = argument


# --- The lines of a call, and the argument behind each part ---


class LanguageLines:
    """The language lines of one call.

    Every part is linked to its argument, so that a finding can name it.
    """

    def __init__(self, call: str) -> None:
        self.call = call
        self._lines = [""]
        self._stretches: list[tuple[Span, str]] = []

    @property
    def text(self) -> str:
        """The lines, without a final line end."""
        return "\n".join(self._lines)

    @property
    def count(self) -> int:
        """The number of lines."""
        return len(self._lines)

    def write(self, text: str, argument: str = "") -> LanguageLines:
        """Continue the last line."""
        line, column = self.count, len(self._lines[-1]) + 1
        self._lines[-1] += text
        if argument:
            self._stretches.append((Span(line, column, line, column + len(text)), argument))
        return self

    def next(self) -> LanguageLines:
        """Begin another line."""
        self._lines.append("")
        return self

    def name(self, value: object, argument: str) -> LanguageLines:
        """Write a name, quoted if necessary."""
        return self.write(name_text(self.words(value, argument)), argument)

    def string(self, value: object, argument: str) -> LanguageLines:
        """Write a string in double quotes."""
        return self.write(quote(self.words(value, argument), '"'), argument)

    def number(self, value: object, argument: str) -> LanguageLines:
        """Write a number without loss."""
        # NumPy's numbers are registered as numbers, text is not.
        if isinstance(value, numbers.Real):
            try:
                return self.write(number_text(float(value)), argument)
            except OverflowError:  # of an integer
                pass
        text = shortened(repr(value))
        raise BuilderArgumentError(self.named(argument), f"expected a number, found {text}")

    def raw(self, value: object, argument: str) -> LanguageLines:
        """Write language text unchanged, except for line ends, which become spaces."""
        words = self.words(value, argument)
        return self.write(" ".join(split_lines(words)), argument)

    def words(self, value: object, argument: str) -> str:
        """Return an argument that must be a string."""
        if not isinstance(value, str):
            text = shortened(repr(value))
            raise BuilderArgumentError(self.named(argument), f"expected text, found {text}")
        return value

    def several(self, value: object, argument: str, expected: str) -> list[Any]:
        """Return an argument that must be a list."""
        if not isinstance(value, Iterable):
            text = shortened(repr(value))
            raise BuilderArgumentError(self.named(argument), f"expected {expected}, found {text}")
        return list(value)

    def named(self, argument: str) -> str:
        """Return the call with its argument, as ``input('temp', low, high)``."""
        if not argument:
            return f"{self.call})"
        return f"{self.call}{'' if self.call.endswith('(') else ', '}{argument})"

    def argument_of(self, span: Span) -> str:
        """Return the call with the arguments behind a part of the lines."""
        candidates = [
            argument
            for stretch, argument in self._stretches
            if stretch.line <= span.end_line
            and stretch.end_line >= span.line
            and (stretch.line != span.line or stretch.end_column > span.column)
            and (stretch.line != span.end_line or stretch.column < span.end_column)
        ]
        if not candidates:  # an omission after the last argument
            before = [
                argument
                for stretch, argument in self._stretches
                if stretch.line == span.line and stretch.end_column <= span.column
            ]
            candidates = before[-1:]
        return self.named(", ".join(dict.fromkeys(candidates)))


def write_shape(lines: LanguageLines, shape: Corners, argument: str, inputs: Sequence[str]) -> None:
    """Write a shape in any accepted form."""
    if isinstance(shape, Shape):
        node: ShapeNode = shape_node(shape, inputs)
        lines.write(str(node), argument)
    elif isinstance(shape, str):
        lines.raw(shape, argument)
    elif isinstance(shape, float | int) or not isinstance(shape, Iterable):
        lines.write("singleton ").number(shape, argument)
    else:
        _write_corners(lines, list(shape), argument)


_CORNERS = {1: "singleton", 2: "rectangle", 3: "triangle", 4: "trapezoid"}
"""Kind of a term by its number of corners."""


def _write_corners(lines: LanguageLines, corners: list[Any], argument: str) -> None:
    if corners and all(isinstance(point, Sequence) and len(point) == 2 for point in corners):
        lines.write("points")
        for i, (x, y) in enumerate(corners):
            lines.write(" (").number(x, f"{argument}[{i}][0]")
            lines.write(", ").number(y, f"{argument}[{i}][1]").write(")")
        return
    kind = _CORNERS.get(len(corners))
    if kind is None:
        message = f"a term has 1 to 4 corners (or pairs x, y), found {len(corners)}"
        raise BuilderArgumentError(lines.named(argument), message)
    lines.write(kind)
    for i, corner in enumerate(corners):
        lines.write(" ").number(corner, f"{argument}[{i}]")


def write_terms(lines: LanguageLines, name: str, terms: Terms, inputs: Sequence[str]) -> None:
    """Write the terms of a variable, in any form of :meth:`fuzzyarm.RuleBaseBuilder.input`."""
    if isinstance(terms, str):
        lines.next().write("terms ").name(name, "name").write(": ").raw(terms, "terms")
    elif isinstance(terms, Mapping):
        for term, shape in terms.items():
            argument = f"terms[{term!r}]"
            lines.next().write("term ").name(name, "name").write(" ").name(term, argument)
            write_shape(lines.write(": "), shape, argument, inputs)
    elif names := lines.several(terms, "terms", "names of terms"):
        lines.next().write("terms ").name(name, "name").write(": triangles")
        for i, term in enumerate(names):
            lines.write(" ").name(term, f"terms[{i}]")


_SETTINGS = {
    "conjunction": "and",
    "disjunction": "or",
    "implication": "implication",
    "threshold": "threshold",
    "aggregation": "aggregation",
    "defuzzifier": "defuzzifier",
    "no_rule": "no-rule",
    "outside": "outside",
}
"""Names of settings as arguments and in the language."""


def write_settings(lines: LanguageLines, settings: Mapping[str, object]) -> None:
    """Write some settings, separated by commas."""
    present = {key: value for key, value in settings.items() if value is not None}
    for i, (key, value) in enumerate(present.items()):
        lines.write(f"{', ' if i else ' '}{_SETTINGS[key]} ", key)
        if isinstance(value, Defuzzifier):
            lines.write(str(value), key)
        elif isinstance(value, str):
            lines.raw(value, key)
        else:
            lines.number(value, key)


# --- Grids ---


class GridLines:
    """The cells of a grid with their labels, from lists, a mapping of rows or a DataFrame."""

    def __init__(self, lines: LanguageLines, cells: Any) -> None:
        self.lines = lines
        self.rows: list[Any] | None = None
        self.columns: list[Any] | None = None
        self.names: tuple[Any, Any] = (None, None)
        if hasattr(cells, "columns") and hasattr(cells, "index"):
            self.rows, self.columns = list(cells.index), list(cells.columns)
            self.names = cells.index.name, cells.columns.name
            self.cells = [list(row) for row in cells.to_numpy().tolist()]
        elif isinstance(cells, Mapping):
            self.rows = list(cells)
            self.cells = [self._listed(row, f"cells[{key!r}]") for key, row in cells.items()]
        else:
            flat = self._listed(cells, "cells")
            if flat and not any(_is_list(dimension) for dimension in flat):
                flat = [flat]  # a grid over one input
            self.cells = [self._listed(row, f"cells[{i}]") for i, row in enumerate(flat)]

    def _listed(self, value: Any, argument: str) -> list[Any]:
        if not _is_list(value):
            message = f"expected a list of term names, found {shortened(repr(value))}"
            raise BuilderArgumentError(self.lines.named(argument), message)
        return list(value)

    def write_row(self, i: int, label: str, argument: str) -> None:
        """Write a row with its label."""
        self.lines.next().write("  ").name(label, argument)
        for j, cell in enumerate(self.cells[i]):
            self._write_cell(cell, f"cells[{i}][{j}]")

    def _write_cell(self, cell: Any, argument: str) -> None:
        self.lines.write("  ")
        if cell is None or cell in ("", ".") or (isinstance(cell, float) and math.isnan(cell)):
            self.lines.write(".", argument)
        elif isinstance(cell, tuple) and len(cell) == 2:
            self.lines.name(cell[0], argument).write("*").number(cell[1], argument)
        else:
            self.lines.name(cell, argument)


def _is_list(value: Any) -> bool:
    """Whether a value is a list of cells; a tuple is one cell with its weight."""
    return not isinstance(value, str | tuple | Mapping) and isinstance(value, Iterable)
