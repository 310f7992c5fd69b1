"""The scene of a file: a model, its crisp inputs, and a drawing of them in a few views."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from fuzzyarm.apps.show.cells import table_panel
from fuzzyarm.apps.show.drawing import number_words
from fuzzyarm.apps.show.panels import panel_view
from fuzzyarm.apps.show.response import Response
from fuzzyarm.apps.show.rulebase import RuleGrid, find_grids, rules_view
from fuzzyarm.apps.show.terms import TermPlots, is_set, visible_range
from fuzzyarm.apps.show.trace import firing_view
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.inference import explain
from fuzzyarm.inference.plan import part_for
from fuzzyarm.inference.trace import Trace
from fuzzyarm.language.model.rulebase import RuleBase, Variable
from fuzzyarm.language.model.shapes import membership
from fuzzyarm.language.tokens import name_text
from fuzzyarm.table import LookupTable

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.text import Text

    from fuzzyarm.base.picture import Panel
    from fuzzyarm.proof.map import Verdict

FINE, COARSE = 60, 12
"""Steps from one end of a range to the other, with an arrow key and with shift."""


class WatchScene:
    """A model with movable crisp inputs.

    Attributes
    ----------
    ranges : dict of str to (float, float)
        The inputs, each with its visible stretch.
    point : dict of str to float
        The crisp inputs.
    across, down : str
        The inputs moved by the arrow keys; `down` is empty for a single input.
    """

    VIEWS: tuple[str, ...] = ()

    def __init__(
        self, ranges: dict[str, tuple[float, float]], axes: Sequence[str], before: WatchScene | None
    ) -> None:
        self.ranges = ranges
        self.across: str
        self.down: str
        self.point: dict[str, float] = {
            name: min(high, max(low, before.point[name]))
            if before is not None and name in before.point
            else 0.5 * (low + high)
            for name, (low, high) in ranges.items()
        }
        if before is not None:
            axes = (before.across, before.down, *axes)
        names = [name for name in dict.fromkeys((*axes, *ranges)) if name in ranges]
        self.across, self.down = (*names, "")[:2]

    def draw(self, view: str, width: int, height: int) -> RenderableType:
        """Return the drawing of a view in a given size."""
        raise NotImplementedError

    def result(self) -> str:
        """Return the outputs at the crisp inputs, in words."""
        raise NotImplementedError

    def next_output(self) -> None:
        """Show the next output, if there are several."""

    def move(self, name: str, steps: int, *, coarse: bool = False) -> None:
        """Move a crisp input by some steps, to its ends at most."""
        low, high = self.ranges[name]
        width = (high - low) / (COARSE if coarse else FINE)
        # Steps lie on a grid from the lower end, so that round numbers recur.
        step = round((self.point[name] - low) / width) + steps
        # Twelve digits are more than anybody reads, and hide the noise of the last ones.
        self.point[name] = min(high, max(low, float(f"{low + step * width:.12g}")))

    def step(self, *, across: bool, steps: int, coarse: bool = False) -> None:
        """Move the input across or that down by some steps, rightward or upward as drawn."""
        name = self.across if across else self.down
        if name:
            self.move(name, steps, coarse=coarse)

    def centre(self) -> None:
        """Put every crisp input in the middle of its range."""
        self.point = {name: 0.5 * (low + high) for name, (low, high) in self.ranges.items()}

    def turn(self, *, across: bool) -> None:
        """Let the arrow keys move the next input, across or down."""
        current, other = (self.across, self.down) if across else (self.down, self.across)
        choices = [name for name in self.ranges if name not in (current, other)]
        if not self.down:
            return
        if not choices:
            self.across, self.down = self.down, self.across
            return
        names = list(self.ranges)
        later = [name for name in choices if names.index(name) > names.index(current)]
        new_input = (later or choices)[0]
        self.across, self.down = (new_input, other) if across else (other, new_input)

    def caption(self, *, keys: bool = True) -> Text:
        """Return the crisp inputs, with `keys` also the keys that move them, and the outputs."""
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


class RulebaseScene(WatchScene):
    """A sound rule base.

    Parameters
    ----------
    rulebase : RuleBase
        The model.
    before : WatchScene or None
        The scene before the last change of the text, whose crisp inputs stay.
    verdicts : sequence of Verdict
        On its ``prove`` lines: failures are marked on the surface.
    """

    VIEWS = ("surface", "rules", "terms", "firing")

    def __init__(
        self,
        rulebase: RuleBase,
        before: WatchScene | None = None,
        verdicts: Sequence[Verdict] = (),
    ) -> None:
        grids = (grid for block in rulebase.blocks for grid in find_grids(block)[0] if grid.row)
        first = next(grids, None)
        names = [variable.name for variable in rulebase.inputs]
        axes = (first.column, first.row) if first is not None else names[1::-1]
        super().__init__({v.name: visible_range(v) for v in rulebase.inputs}, axes, before)
        self.rulebase, self.verdicts = rulebase, verdicts
        outputs = [output.name for output in rulebase.outputs]
        last_output = before.output if isinstance(before, RulebaseScene) else ""
        self.output: str = last_output if last_output in outputs else outputs[0]
        self._take_needed()

    def next_output(self) -> None:
        """Show the surface of the next output."""
        names = [output.name for output in self.rulebase.outputs]
        self.output = names[(names.index(self.output) + 1) % len(names)]
        self._take_needed()

    def _take_needed(self) -> None:
        """Restrict the axes of the surface, and the keys, to the inputs of the output."""
        try:
            part = part_for(self.rulebase, [self.output])
        except FuzzyarmError:  # the drawing has the reason
            return
        names = [variable.name for variable in part.inputs]
        axes = [name for name in (self.across, self.down) if name in names]
        if names:
            self.across, self.down = (*axes, *(x for x in names if x not in axes), "")[:2]

    def trace(self) -> Trace | str:
        """Return the inference at the crisp inputs, or the reason of a failure."""
        last_values = {
            output.name: 0.5 * (output.low + output.high) for output in self.rulebase.outputs
        }
        try:
            return explain(self.rulebase, self.point, held=last_values)
        except FuzzyarmError as error:
            return str(error)

    def result(self) -> str:
        """Return the outputs at the crisp inputs."""
        trace = self.trace()
        if isinstance(trace, str):
            return "no value"
        return ", ".join(f"{name_text(o.name)} = {number_words(o.value, 4)}" for o in trace.outputs)

    def draw(self, view: str, width: int, height: int) -> RenderableType:
        """Return the drawing of a view in a given size."""
        from rich.text import Text

        try:
            if view == "surface":
                return self._surface(width, height)
            if view == "terms":
                return self._terms(width)
            trace = self.trace()
            if view == "rules":
                return self._rules(trace)
            return Text(trace, "yellow") if isinstance(trace, str) else firing_view(trace)
        except FuzzyarmError as error:
            return Text(str(error), "yellow")

    def _surface(self, width: int, height: int) -> RenderableType:
        import numpy as np

        output = self.rulebase.output(self.output)
        free = [name for name in (self.down, self.across) if name]
        response = Response(self.rulebase, output, self.point, self.verdicts, free)
        columns = max(8, width - 9)
        # A value for each dot of a line, for each half of a character of a map.
        counts = [2 * max(3, height - 3), columns] if self.down else [2 * columns]
        points = [np.linspace(*self.ranges[x], n) for x, n in zip(free, counts, strict=True)]
        return titled(output.name, output.description, response.panel(points), width, height)

    def _rules(self, trace: Trace | str) -> RenderableType:
        rules, fired = self.rulebase.rules, () if isinstance(trace, str) else trace.fired
        strengths = {rules[rule.number - 1].span: rule.strength for rule in fired}
        return rules_view(self.rulebase, strengths, self._chosen)

    def _terms(self, width: int) -> RenderableType:
        from rich.console import Group

        inputs = [TermPlots(v, at=self.point[v.name], width=width) for v in self.rulebase.inputs]
        return Group(*inputs, *(TermPlots(v, width=width) for v in self.rulebase.outputs))

    def _strongest(self, variable: Variable) -> str:
        terms = [term for term in variable.terms if is_set(term.shape)]
        x = self.point.get(variable.name, 0.5 * (variable.low + variable.high))
        return max(terms, key=lambda term: membership(term.shape, x)).name if terms else ""

    def _chosen(self, grid: RuleGrid) -> tuple[str, str]:
        row = self._strongest(self.rulebase.variable(grid.row)) if grid.row else ""
        return row, self._strongest(self.rulebase.variable(grid.column))


def titled(name: str, about: str, panel: Panel, width: int, height: int) -> RenderableType:
    """Return a panel below its title."""
    from rich.console import Group
    from rich.text import Text

    title = Text(f"{name_text(name)}  {about}", "bold", no_wrap=True)
    return Group(title, panel_view(panel, width, height))


# --- A lookup table: a map of its cells, and its numbers ---


class TableScene(WatchScene):
    """A sound table.

    Parameters
    ----------
    table : LookupTable
        The table.
    before : WatchScene or None
        The scene before the last change of the text.
    """

    VIEWS = ("surface", "numbers")

    def __init__(self, table: LookupTable, before: WatchScene | None = None) -> None:
        ranges = {axis.name: (axis.levels[0], axis.levels[-1]) for axis in table.axes}
        super().__init__(ranges, table.names[::-1], before)
        self.table = table

    def step(self, *, across: bool, steps: int, coarse: bool = False) -> None:
        """Move an input; the rows of a table are listed downward."""
        super().step(across=across, steps=steps if across else -steps, coarse=coarse)

    def move(self, name: str, steps: int, *, coarse: bool = False) -> None:
        """Move a crisp input into the next cell; with `coarse` by three."""
        axis, inputs = self.table.axis(name), [self.point[x] for x in self.table.names]
        index = self.table.cell(*inputs)[self.table.names.index(name)]
        index = min(len(axis.levels) - 1, max(0, index + (3 * steps if coarse else steps)))
        inner = bool(axis.bins) and 0 < index < len(axis.levels) - 1
        # Between its thresholds, if a cell has them, so that the point falls into it.
        middle = 0.5 * (axis.bins[index - 1] + axis.bins[index]) if inner and axis.bins else 0.0
        self.point[name] = float(f"{middle:.12g}") if inner else axis.levels[index]

    def result(self) -> str:
        """Return the value of the table."""
        value = float(self.table.lookup(*(self.point[name] for name in self.table.names)))
        return f"{name_text(self.table.output)} = {number_words(value, 6)}"

    def draw(self, view: str, width: int, height: int) -> RenderableType:
        """Return the drawing of a view in a given size."""
        table = self.table
        if view == "numbers":
            from fuzzyarm.apps.show.table import table_view

            return table_view(table, at=[self.point[name] for name in table.names])
        panel = table_panel(table, self.point, (self.down, self.across))
        return titled(table.output, table.description, panel, width, height)
