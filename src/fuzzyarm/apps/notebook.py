"""Notebooks: the drawings of :mod:`fuzzyarm.apps.show` as HTML, with figures as pictures.

A value finds its drawing here by the name of its class (:class:`fuzzyarm.base.shown.Shown`), so
that nothing is loaded before its display. All text of users is escaped.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Iterator
from functools import cache
from html import escape
from typing import TYPE_CHECKING, Any, TypeVar

from fuzzyarm.apps.show.drawing import HeatGrid, make_console, plain_text
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.names import printable

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import RenderableType
    from rich.terminal_theme import TerminalTheme

    from fuzzyarm.language.model.rulebase import AnyRuleBase
    from fuzzyarm.table import LookupTable

__all__ = ["figure_of", "html_of", "html_of_drawing", "text_of"]

WIDTH = 100
"""Columns of terminal output."""

MOST_RULES = 500
"""Beyond this number a page shows the number of rules instead of the rules."""

# --- Drawings of the terminal as HTML ---

_PRE = (
    "font-family:Menlo,'DejaVu Sans Mono',Consolas,monospace;line-height:1.25;"
    "white-space:pre;overflow-x:auto;margin:0.4em 0"
)
_CELL = "padding:0.15em 0.5em;text-align:right"


def html_of_drawing(drawing: RenderableType) -> str:
    """Return a drawing as HTML: heat grids as tables, everything else as in the terminal."""
    return "".join(_parts(drawing))


def _parts(drawing: RenderableType) -> Iterator[str]:
    from rich.console import Group

    # Lines between two tables are drawn together, in one <pre>.
    waiting: list[RenderableType] = []
    for part in drawing.renderables if isinstance(drawing, Group) else [drawing]:
        if isinstance(part, HeatGrid | Group):
            yield _as_in_terminal(waiting)
            waiting = []
            yield _table(part) if isinstance(part, HeatGrid) else html_of_drawing(part)
        else:
            waiting.append(part)
    yield _as_in_terminal(waiting)


def _as_in_terminal(drawings: list[RenderableType]) -> str:
    """Return drawings as preformatted text with the colours of the terminal."""
    import io

    from rich.console import Group

    if not drawings:
        return ""
    console = make_console(io.StringIO(), width=WIDTH, record=True, force_terminal=True)
    console.print(Group(*drawings))
    code = console.export_html(theme=_theme(), inline_styles=True, code_format="{code}")
    lines = "\n".join(line.rstrip() for line in code.strip("\n").split("\n"))
    return f'<pre style="{_PRE}">{lines}</pre>' if lines else ""


@cache
def _theme() -> TerminalTheme:
    """Return the colours of the terminal as they are on paper, where white is white."""
    from rich.terminal_theme import TerminalTheme

    dark = [(0, 0, 0), (178, 24, 43), (0, 118, 0), (118, 98, 0), (33, 102, 172), (128, 0, 128)]
    colours = [*dark, (0, 118, 128), (255, 255, 255)]
    return TerminalTheme((255, 255, 255), (0, 0, 0), colours)


def _table(grid: HeatGrid) -> str:
    from rich.style import Style

    def cell(tag: str, text: str, style: str = "") -> str:
        css = f"{_CELL};{Style.parse(style).get_html_style(_theme())}" if style else _CELL
        return f'<{tag} style="{css}">{_words(text)}</{tag}>'

    head = "".join(cell("th", label) for label in (grid.corner, *grid.columns))
    rows = "".join(
        f"<tr>{cell('th', label)}{''.join(cell('td', *cell_words) for cell_words in row)}</tr>"
        for label, row in zip(grid.rows, grid.cells, strict=True)
    )
    return f'<table style="margin:0.4em 0"><tr>{head}</tr>{rows}</table>'


def _words(text: str) -> str:
    return escape("\n".join(map(printable, text.split("\n"))))


def _pre(text: str) -> str:
    return f'<pre style="{_PRE}">{_words(text)}</pre>'


# --- Figures ---


def _picture(figure: Figure, alt: str) -> str:
    from fuzzyarm.apps.show.figures.style import png_of

    data = b64encode(png_of(figure)).decode("ascii")
    style = "max-width:100%;height:auto"
    return f'<img alt="{_words(alt)}" style="{style}" src="data:image/png;base64,{data}">'


def _variable_figure(variable: Any) -> Figure:
    from fuzzyarm.apps.show.figures.rulebase import variable_figure

    return variable_figure(getattr(variable, "model", variable))


def _run_figure(run: Any) -> Figure:
    from fuzzyarm.apps.show.figures.panels import draw_runs

    return draw_runs([run])


def _portrait_figure(portrait: Any) -> Figure:
    from fuzzyarm.apps.show.figures.analysis import portrait_figure

    return portrait_figure(portrait)


def _table_figure(table: Any) -> Figure:
    from fuzzyarm.apps.show.figures.surface import table_figure

    return table_figure(_as_table(table))


def _diagram_figure(controller: Any) -> Figure:
    from fuzzyarm.apps.show.figures import diagram_figure

    return diagram_figure(controller)


def _validation_figure(validation: Any) -> Figure:
    from fuzzyarm.apps.show.figures import validation_figure

    return validation_figure(validation, "observed", repr(validation))


_FIGURES: dict[str, Callable[[Any], Figure]] = {
    "fuzzyarm.apps.builder.rulebase.VariableBuilder": _variable_figure,
    "fuzzyarm.control.controllers.text.ControllerText": _diagram_figure,
    "fuzzyarm.learning.validation.Validation": _validation_figure,
    "fuzzyarm.control.loop.analysis.Portrait": _portrait_figure,
    "fuzzyarm.control.loop.run.Run": _run_figure,
    "fuzzyarm.language.model.rulebase.Variable": _variable_figure,
    "fuzzyarm.table.axis.TableHeader": _table_figure,
}
"""From the name of a class to its figure."""


def figure_of(value: object) -> Figure:
    """Return the figure of a value."""
    figure = _by_class(value, _FIGURES)
    assert figure is not None, f"{type(value).__name__} has no figure"
    return figure(value)


_Answer = TypeVar("_Answer")


def _by_class(
    value: object, answers: dict[str, Callable[[Any], _Answer]]
) -> Callable[[Any], _Answer] | None:
    """Return the drawing function for the class of a value, or its nearest base class."""
    for kind in type(value).__mro__:
        answer = answers.get(f"{kind.__module__}.{kind.__qualname__}")
        if answer is not None:
            return answer
    return None


# --- Views of values ---


def _rulebase(rulebase: AnyRuleBase) -> str:
    """Return name, terms and surfaces, rules and settings."""
    from rich.console import Group

    from fuzzyarm.apps.show.figures import memberships_figure, rulebase_figure
    from fuzzyarm.apps.show.rulebase import heading_view, inference_view, rules_view

    try:
        model = rulebase.model
    except FuzzyarmError as error:  # it is being written
        return _pre(str(rulebase)) + _pre(str(error))
    try:
        figure, note = rulebase_figure(model), ""
    except FuzzyarmError as error:  # it cannot be evaluated
        figure, note = memberships_figure(model), _pre(str(error))
    parts = Group(inference_view(model))
    if len(model.rules) <= MOST_RULES:
        parts = Group(rules_view(model), *parts.renderables)
    else:
        note += _pre(f"{len(model.rules):,} rules, which print writes")
    picture = _picture(figure, f"terms and surface of {model.name}")
    return html_of_drawing(heading_view(model)) + picture + note + html_of_drawing(parts)


def _plotted(value: Any) -> str:
    return _picture(figure_of(value), repr(value))


def _controller(controller: Any) -> str:
    """Return the block diagram above the text."""
    return _picture(figure_of(controller), f"block diagram of {controller.model.name}") + _text(
        controller
    )


def _run(run: Any) -> str:
    return _plotted(run) + _pre(repr(run))


def _drawn(value: Any) -> str:
    return html_of_drawing(_view(value))


def _text(value: Any) -> str:
    return _pre(str(value))


_DRAWINGS: dict[str, Callable[[Any], str]] = {
    "fuzzyarm.exchange.files.Review": _text,
    "fuzzyarm.apps.builder.rulebase.VariableBuilder": _plotted,
    "fuzzyarm.control.controllers.text.ControllerText": _controller,
    "fuzzyarm.inference.trace.Trace": _drawn,
    "fuzzyarm.learning.validation.Validation": _plotted,
    "fuzzyarm.control.loop.analysis.Portrait": _plotted,
    "fuzzyarm.control.loop.run.Run": _run,
    "fuzzyarm.language.model.rulebase.AnyRuleBase": _rulebase,
    "fuzzyarm.language.model.rulebase.Variable": _plotted,
    "fuzzyarm.proof.map.verdicts.Verdict": _text,
    "fuzzyarm.table.axis.TableHeader": _drawn,
}
"""From the name of a class to its drawing."""


def html_of(value: object) -> str:
    """Return a notebook's representation of a value."""
    drawing = _by_class(value, _DRAWINGS)
    return _pre(repr(value)) if drawing is None else drawing(value)


def text_of(value: object) -> str:
    """Return a value as drawn in the terminal, without colours."""
    return plain_text(_view(value), WIDTH).rstrip("\n")


def _view(value: Any) -> RenderableType:
    """Return the drawing of a trace or a table."""
    from fuzzyarm.inference.trace import Trace

    if isinstance(value, Trace):
        from fuzzyarm.apps.show.trace import trace_view

        return trace_view(value)
    from fuzzyarm.apps.show.table import table_view

    return table_view(_as_table(value))


def _as_table(value: Any) -> LookupTable:
    from fuzzyarm.table import LookupTable, PlainTable

    return LookupTable.from_plain(value) if isinstance(value, PlainTable) else value
