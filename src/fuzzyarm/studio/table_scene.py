"""A lookup table in the studio: a map of its cells, and its numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.language.tokens import name_text
from fuzzyarm.lsp.tables import TableText
from fuzzyarm.show.drawing import number_words, scale_of
from fuzzyarm.studio.scene import Scene
from fuzzyarm.table import Axis, LookupTable
from fuzzyarm.text.diagnostic import Span

if TYPE_CHECKING:
    from rich.console import RenderableType


MAP, NUMBERS = "surface", "numbers"


class TableScene(Scene):
    """A sound table.

    Parameters
    ----------
    table : LookupTable
        The table.
    text : TableText
        Its text, to jump into.
    before : Scene or None
        The scene before the last change of the text.
    """

    VIEWS = (MAP, NUMBERS)

    def __init__(self, table: LookupTable, text: TableText, before: Scene | None = None) -> None:
        super().__init__({axis.name: (axis.levels[0], axis.levels[-1]) for axis in table.axes})
        self.table = table
        self.text = text
        names = table.names
        if before is None:
            self.set_inputs({}, names[-1], names[-2] if len(names) > 1 else "")
        else:
            self.set_inputs(before.point, before.across, before.down)

    @property
    def cell(self) -> tuple[int, ...]:
        """The index of the cell that the crisp inputs fall into."""
        return tuple(self.table.cell(*(self.point[name] for name in self.table.names)))

    def move(self, name: str, steps: int, *, coarse: bool = False) -> None:
        """Move a crisp input into the next cell; with `coarse` by three."""
        if name not in self.point:
            return
        axis = self.table.axis(name)
        now = self.cell[self.table.names.index(name)]
        by = 3 * steps if coarse else steps
        self.point[name] = _inside(axis, min(len(axis.levels) - 1, max(0, now + by)))

    def result(self) -> str:
        """Return the value that the table gives."""
        value = float(self.table.lookup(*(self.point[name] for name in self.table.names)))
        return f"{name_text(self.table.output)} = {number_words(value, 6)}"

    def draw(self, view: str, width: int, height: int) -> RenderableType:
        """Return the drawing of a view in a given room."""
        if view == NUMBERS:
            from fuzzyarm.show.table import table_view

            return table_view(self.table, at=[self.point[name] for name in self.table.names])
        return self._cells(width, height)

    def _cells(self, width: int, height: int) -> RenderableType:
        from rich.text import Text

        title = Text(f"{name_text(self.table.output)}  {self.table.description}", "bold")
        names, cell = self.table.names, list(self.cell)
        i = names.index(self.across)
        columns = len(self.table.axes[i].levels)
        scale = scale_of(self.table.values.ravel().tolist(), self.table.low, self.table.high)

        def value(row: int, column: int) -> float:
            index = list(cell)
            index[i] = column
            if self.down:
                index[names.index(self.down)] = row
            return float(self.table.values[tuple(index)])

        room = max(8, width - 9)
        if not self.down:
            values = [value(0, k * columns // (2 * room)) for k in range(2 * room)]
            low = min(values) if self.table.low is None else self.table.low
            high = max(values) if self.table.high is None else self.table.high
            mark = round((cell[i] + 0.5) * 2 * room / columns)
            return self._line(title, values, height, (self.table.output, low, high), mark)
        j = names.index(self.down)
        rows = len(self.table.axes[j].levels)
        # Whole cells where they fit, so that all have the same size.
        wide = max(1, room // columns) * columns if columns <= room else room
        high_rows = 2 * max(3, height - 2)
        tall = max(1, high_rows // rows) * rows if rows <= high_rows else high_rows
        tall += tall % 2
        grid = [
            [value(min(rows - 1, y * rows // tall), x * columns // wide) for x in range(wide)]
            for y in range(tall)
        ]
        mark_at = (
            min(tall - 1, int((cell[j] + 0.5) * tall / rows)),
            min(wide - 1, int((cell[i] + 0.5) * wide / columns)),
        )
        return self._map(title, grid, scale, mark_at)

    def position(self) -> Span | None:
        """Return where the number of the chosen cell stands in the text."""
        return self.text.cell_span(self.cell)

    def position_at(self, view: str, x: int, y: int, line: str) -> Span | None:
        """Return nothing: a map is too coarse to be pointed at."""
        return None


def _inside(axis: Axis, index: int) -> float:
    """Return a number that falls into a cell: the middle between its thresholds."""
    if not axis.bins or index in (0, len(axis.levels) - 1):
        return axis.levels[index]
    return float(f"{0.5 * (axis.bins[index - 1] + axis.bins[index]):.12g}")
