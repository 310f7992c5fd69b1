"""What is shown of a file: a model, the crisp inputs, and a drawing of them in a few views."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.inference import explain, infer
from fuzzyarm.inference.plan import part_for
from fuzzyarm.inference.trace import Trace
from fuzzyarm.language.tokens import name_text
from fuzzyarm.model.rulebase import Output, RuleBase, Variable
from fuzzyarm.model.shapes import membership
from fuzzyarm.show.drawing import Scale, ScaleBar, number_words, scale_of
from fuzzyarm.show.rulebase import RuleGrid, find_grids, rules_view
from fuzzyarm.show.surface import LinePlot, SurfaceMap
from fuzzyarm.show.terms import TermPlots, is_set, visible_range
from fuzzyarm.show.trace import firing_view
from fuzzyarm.table import Axis, LookupTable
from fuzzyarm.text.diagnostic import Span

if TYPE_CHECKING:
    from rich.console import Group, RenderableType
    from rich.text import Text

    from fuzzyarm.proof import Verdict

FINE, COARSE = 60, 12
"""Steps from one end of a range to the other, with an arrow key and with shift."""


class Scene(ABC):
    """A model with crisp inputs that can be moved.

    Attributes
    ----------
    ranges : dict of str to (float, float)
        The inputs and the stretch that is shown of each.
    point : dict of str to float
        The crisp inputs.
    across, down : str
        The inputs that the arrow keys move; `down` is empty where there is one input.
    """

    VIEWS: tuple[str, ...] = ()

    def __init__(self, ranges: dict[str, tuple[float, float]]) -> None:
        self.ranges = ranges
        self.point: dict[str, float] = {}
        self.across = ""
        self.down = ""

    @abstractmethod
    def draw(self, view: str, width: int, height: int) -> RenderableType:
        """Return the drawing of a view in a given room."""

    @abstractmethod
    def result(self) -> str:
        """Return what comes out at the crisp inputs, in words."""

    def set_inputs(self, before: Mapping[str, float], across: str, down: str) -> None:
        """Take over the crisp inputs of an earlier model as far as they fit this one."""
        names = list(self.ranges)
        for name, (low, high) in self.ranges.items():
            middle = 0.5 * (low + high)
            self.point[name] = min(high, max(low, before.get(name, middle)))
        self.across = across if across in names else ""
        self.down = down if down in names and down != self.across else ""
        free = [name for name in names if name not in (self.across, self.down)]
        if not self.across and free:
            self.across = free.pop() if len(names) > 1 and not self.down else free.pop(0)
        if not self.down and free:
            self.down = free.pop(0)
        if len(names) > 2 and not across:
            self.down, self.across = names[0], names[1]

    def move(self, name: str, steps: int, *, coarse: bool = False) -> None:
        """Move a crisp input by some steps, to its ends at most."""
        if name not in self.point:
            return
        low, high = self.ranges[name]
        width = (high - low) / (COARSE if coarse else FINE)
        # Steps lie on a lattice from the lower end, so that round numbers are met again.
        step = round((self.point[name] - low) / width) + steps
        # Twelve digits are more than anybody reads, and hide the noise of the last ones.
        self.point[name] = min(high, max(low, float(f"{low + step * width:.12g}")))

    def step(self, *, across: bool, steps: int, coarse: bool = False) -> None:
        """Move the input across or that down by some steps, rightward or upward as it is drawn."""
        self.move(self.across if across else self.down, steps, coarse=coarse)

    def next_output(self) -> None:
        """Show the next output, where there are several."""
        return

    def centre(self) -> None:
        """Put every crisp input in the middle of its range."""
        for name, (low, high) in self.ranges.items():
            self.point[name] = 0.5 * (low + high)

    def turn(self, *, across: bool) -> None:
        """Let the arrow keys move the next input, across or down."""
        names = list(self.ranges)
        other = self.down if across else self.across
        mine = self.across if across else self.down
        if len(names) < 2 or not mine:
            return
        choices = [name for name in names if name != other]
        chosen = choices[(choices.index(mine) + 1) % len(choices)]
        if len(names) == 2:
            self.across, self.down = self.down, self.across
        elif across:
            self.across = chosen
        else:
            self.down = chosen

    def _line(
        self, title: Text, values: list[float], height: int, up: tuple[str, float, float], mark: int
    ) -> Group:
        from rich.console import Group

        across = (self.across, *self.ranges[self.across])
        low, high = self.ranges[self.across]
        fails = frozenset(
            _index(point[self.across], (low, high), len(values)) for point in self._failing()
        )
        return Group(title, LinePlot(values, max(3, height - 2), across, up, mark, fails))

    def _map(
        self,
        title: Text,
        values: list[list[float]],
        scale: Scale,
        mark: tuple[int, int],
        *,
        upward: bool = False,
    ) -> Group:
        """Return a map with its scale; `upward`: the first row is the upper end."""
        from rich.console import Group

        down, across = ((name, *self.ranges[name]) for name in (self.down, self.across))
        if upward:
            down = (down[0], down[2], down[1])
        sizes = len(values), len(values[0])
        fails = frozenset(
            (
                _index(point[self.down], down[1:], sizes[0]),
                _index(point[self.across], across[1:], sizes[1]),
            )
            for point in self._failing()
        )
        surface_map = SurfaceMap(values, scale, down, across, mark, fails)
        return Group(title, surface_map, ScaleBar(scale, len(values[0]) + 9))

    def _failing(self) -> list[Mapping[str, float]]:
        """Return points on what is drawn at which a property fails."""
        return []

    def caption(self, *, keys: bool = True) -> Text:
        """Return the crisp inputs, with `keys` those that move them, and what comes out."""
        from rich.text import Text

        text = Text(no_wrap=False)
        for name, value in self.point.items():
            moves = "←→" if name == self.across else "↑↓" if name == self.down else ""
            text.append(f"{name_text(name)} ", "bold")
            text.append(f"{number_words(value, 4)}", "cyan")
            text.append(f" {moves}  " if moves and keys else "  ", "dim")
        text.append("→ ", "dim")
        text.append(self.result(), "bold")
        return text


# --- A rule base: its surface, its rules, its terms and one inference ---

SURFACE, RULES, TERMS, FIRING = "surface", "rules", "terms", "firing"


class RulebaseScene(Scene):
    """A sound rule base.

    Parameters
    ----------
    rulebase : RuleBase
        Without errors.
    before : Scene or None
        The scene before the last change of the text, whose crisp inputs stay.
    verdicts : sequence of Verdict
        On its ``prove`` lines: where one fails is marked on the surface.
    """

    VIEWS = (SURFACE, RULES, TERMS, FIRING)

    def __init__(
        self,
        rulebase: RuleBase,
        before: Scene | None = None,
        verdicts: Sequence[Verdict] = (),
    ) -> None:
        super().__init__({v.name: visible_range(v) for v in rulebase.inputs})
        self.rulebase = rulebase
        self.output = rulebase.outputs[0].name
        self.verdicts = verdicts
        if before is None:
            first = next((g for b in rulebase.blocks for g in find_grids(b)[0] if g.row), None)
            across, down = (first.column, first.row) if first else ("", "")
            self.set_inputs({}, across, down)
        else:
            self.set_inputs(before.point, before.across, before.down)
            outputs = {o.name for o in rulebase.outputs}
            if isinstance(before, RulebaseScene) and before.output in outputs:
                self.output = before.output
        self._take_needed()

    def next_output(self) -> None:
        """Show the surface of the next output."""
        names = [o.name for o in self.rulebase.outputs]
        self.output = names[(names.index(self.output) + 1) % len(names)]
        self._take_needed()

    def _take_needed(self) -> None:
        """Give the axes of the surface, and the keys, inputs that the output depends on."""
        try:
            part = part_for(self.rulebase, [self.output])
        except FuzzyarmError:  # drawing it will say why
            return
        needed = [variable.name for variable in part.inputs]
        if not needed:
            return
        if self.across not in needed:
            self.across = next((name for name in reversed(needed) if name != self.down), needed[0])
        if self.down not in needed or self.down == self.across:
            self.down = next((name for name in needed if name != self.across), "")

    def _failing(self) -> list[Mapping[str, float]]:
        free = {self.across, self.down}
        return [
            point
            for verdict in self.verdicts
            if verdict.output == self.output
            for point in verdict.points
            if all(x == self.point[name] for name, x in point.items() if name not in free)
        ]

    # ── values ───────────────────────────────────────────────────────────────────────

    def trace(self) -> Trace | str:
        """Return the inference at the crisp inputs, or in a sentence why there is none."""
        try:
            return explain(self.rulebase, self.point, held=self._held())
        except FuzzyarmError as error:
            return str(error)

    def _held(self) -> dict[str, float]:
        return {o.name: 0.5 * (o.low + o.high) for o in self.rulebase.outputs}

    def result(self) -> str:
        """Return the outputs at the crisp inputs."""
        trace = self.trace()
        if isinstance(trace, str):
            return "no value"
        return ", ".join(f"{name_text(o.name)} = {number_words(o.value, 4)}" for o in trace.outputs)

    def _values(self, inputs: Mapping[str, Any], output: Output) -> Any:
        """Return the output over arrays, NaN where no rule fires and nothing is said of that."""
        outputs = tuple(
            replace(o, no_rule=math.nan) if o.no_rule == "error" else o
            for o in self.rulebase.outputs
        )
        model = replace(self.rulebase, outputs=outputs)
        return infer(model, inputs, held=self._held(), outputs=[output.name])[output.name]

    # ── drawing ──────────────────────────────────────────────────────────────────────

    def draw(self, view: str, width: int, height: int) -> RenderableType:
        """Return the drawing of a view in a given room."""
        from rich.text import Text

        draws = {SURFACE: self._surface, RULES: self._rules, TERMS: self._terms}
        try:
            if view in draws:
                return draws[view](width, height)
            return self._firing()
        except FuzzyarmError as error:
            return Text(str(error), "yellow")

    def _surface(self, width: int, height: int) -> RenderableType:
        import numpy as np
        from rich.text import Text

        output = self.rulebase.output(self.output)
        low, high = visible_range(output)
        title = Text(f"{name_text(output.name)}  {output.description}", "bold", no_wrap=True)
        across = self.ranges[self.across]
        if not self.down:
            count = 2 * max(8, width - 9)
            xs = np.linspace(*across, count)
            values = np.broadcast_to(self._values({self.across: xs}, output), xs.shape)
            mark = _index(self.point[self.across], across, count)
            return self._line(title, values.tolist(), height, (output.name, low, high), mark)
        down = self.ranges[self.down]
        columns, rows = max(8, width - 9), 2 * max(3, height - 3)
        # As in figures: what goes down here rises upward there.
        xs, ys = np.linspace(*across, columns), np.linspace(down[1], down[0], rows)
        inputs: dict[str, Any] = dict(self.point)
        inputs |= {self.across: xs[None, :], self.down: ys[:, None]}
        values = np.broadcast_to(self._values(inputs, output), (rows, columns))
        mark_at = (
            rows - 1 - _index(self.point[self.down], down, rows),
            _index(self.point[self.across], across, columns),
        )
        scale = scale_of(values.ravel().tolist(), low, high)
        return self._map(title, values.tolist(), scale, mark_at, upward=True)

    def _rules(self, width: int, height: int) -> RenderableType:
        trace = self.trace()
        strengths: dict[Span, float] = {}
        if not isinstance(trace, str):
            rules = self.rulebase.rules
            strengths = {rules[r.number - 1].span: r.strength for r in trace.fired}
        return rules_view(self.rulebase, strengths, self._chosen)

    def _terms(self, width: int, height: int) -> RenderableType:
        from rich.console import Group

        inputs = [TermPlots(v, at=self.point[v.name], width=width) for v in self.rulebase.inputs]
        return Group(*inputs, *(TermPlots(v, width=width) for v in self.rulebase.outputs))

    def _firing(self) -> RenderableType:
        from rich.text import Text

        trace = self.trace()
        return Text(trace, "yellow") if isinstance(trace, str) else firing_view(trace)

    def _strongest(self, variable: Variable) -> str:
        terms = _fuzzy_terms(variable)
        x = self.point.get(variable.name, 0.5 * (variable.low + variable.high))
        return max(terms, key=lambda t: membership(t.shape, x)).name if terms else ""

    def _chosen(self, grid: RuleGrid) -> tuple[str, str]:
        row = self._strongest(self.rulebase.variable(grid.row)) if grid.row else ""
        return row, self._strongest(self.rulebase.variable(grid.column))


def _fuzzy_terms(variable: Variable) -> list[Any]:
    return [term for term in variable.terms if is_set(term.shape)]


def _index(value: float, ends: tuple[float, float], count: int) -> int:
    return round((value - ends[0]) / (ends[1] - ends[0]) * (count - 1))


# --- A lookup table: a map of its cells, and its numbers ---

MAP, NUMBERS = "surface", "numbers"


class TableScene(Scene):
    """A sound table.

    Parameters
    ----------
    table : LookupTable
        The table.
    before : Scene or None
        The scene before the last change of the text.
    """

    VIEWS = (MAP, NUMBERS)

    def __init__(self, table: LookupTable, before: Scene | None = None) -> None:
        super().__init__({axis.name: (axis.levels[0], axis.levels[-1]) for axis in table.axes})
        self.table = table
        names = table.names
        if before is None:
            self.set_inputs({}, names[-1], names[-2] if len(names) > 1 else "")
        else:
            self.set_inputs(before.point, before.across, before.down)

    @property
    def cell(self) -> tuple[int, ...]:
        """The index of the cell that the crisp inputs fall into."""
        return tuple(self.table.cell(*(self.point[name] for name in self.table.names)))

    def step(self, *, across: bool, steps: int, coarse: bool = False) -> None:
        """Move an input; the rows of a table are listed downward."""
        super().step(across=across, steps=steps if across else -steps, coarse=coarse)

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
        high_rows = 2 * max(3, height - 3)
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


def _inside(axis: Axis, index: int) -> float:
    """Return a number that falls into a cell: the middle between its thresholds."""
    if not axis.bins or index in (0, len(axis.levels) - 1):
        return axis.levels[index]
    return float(f"{0.5 * (axis.bins[index - 1] + axis.bins[index]):.12g}")
