"""Draw a model: ``fuzzyarm show`` in the terminal, ``fuzzyarm plot`` as a figure."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.arguments import WordError, read_assignments, require_all
from fuzzyarm.model.rulebase import RuleBase

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import RenderableType

    from fuzzyarm.table import LookupTable


DESCRIPTION_SHOW = """Draw a rule base or a table in the terminal.

A rule base: its variables with their terms as small plots, the rules as grids, how they are
evaluated. A table: its axes, its origin and its values as a heat grid. With --at the
inference (or the cell) at one point is shown as well.

  fuzzyarm show rulebases/pd7.frb --at e=1.3,ce=-2
"""


def configure_show(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm show``."""
    parser.add_argument("files", nargs="+", metavar="FILE", help="rule bases and tables")
    parser.add_argument("--at", metavar="NAME=VALUE,...", help="also the inference at one point")
    parser.add_argument("--all", action="store_true", help="every level of a large table")
    parser.add_argument("--json", action="store_true", help="print the model as JSON")


def run_show(arguments: argparse.Namespace) -> int:
    """Draw every file."""
    from fuzzyarm.api import load

    models = [load(path) for path in arguments.files]
    if arguments.json:
        data = [as_data(model) for model in models]
        print(json.dumps(data[0] if len(data) == 1 else data, ensure_ascii=False, indent=2))
        return 0
    from fuzzyarm.show.drawing import make_console

    console = make_console()
    drawings = [drawing(model, at=arguments.at, all_levels=arguments.all) for model in models]
    for k, picture in enumerate(drawings):
        if k:
            console.print()
        console.print(picture)
    return 0


def drawing(model: RuleBase | LookupTable, *, at: str | None, all_levels: bool) -> RenderableType:
    """Return the drawing of a model, with the inference at the point `at` if one is given."""
    if not isinstance(model, RuleBase):
        from fuzzyarm.show.table import table_view

        point = None
        if at is not None:
            values = read_assignments([at], model.names)
            require_all(values, model.names)
            point = [values[name] for name in model.names]
        return table_view(model, all_levels=all_levels, at=point)
    from rich.console import Group
    from rich.text import Text

    from fuzzyarm.show.rulebase import rulebase_view

    if at is None:
        return rulebase_view(model)
    from fuzzyarm.inference.trace import explain
    from fuzzyarm.show.trace import trace_view

    names = [variable.name for variable in model.inputs]
    values = read_assignments([at], names)
    require_all(values, names)
    return Group(rulebase_view(model), Text(), trace_view(explain(model, values)))


def as_data(model: RuleBase | LookupTable) -> dict[str, Any]:
    """Return a model as JSON data."""
    if isinstance(model, RuleBase):
        return {"kind": "rulebase", **_without_spans(asdict(model))}
    from fuzzyarm.table.files import header_data

    return {"kind": "table", **header_data(model), "values": model.values.tolist()}


def _without_spans(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _without_spans(value) for key, value in data.items() if key != "span"}
    if isinstance(data, (list, tuple)):
        return [_without_spans(value) for value in data]
    if isinstance(data, float) and not -1e308 < data < 1e308:
        return str(data)  # JSON has no infinity
    return data


DESCRIPTION_PLOT = """Draw a rule base or a table as a figure: .png, .svg or .pdf.

A rule base gives the memberships of every variable and the control surface of every output:
a line over one input, a surface and its map over two, a slice over two of more with the
others at the middle of their ranges or where --at says. A table gives its cells.

  fuzzyarm plot rulebases/thermostat.frb -o thermostat.svg --at presence=1
"""

WHAT = ("all", "terms", "surface")


def configure_plot(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm plot``."""
    parser.add_argument("file", metavar="FILE", help="a rule base or a table")
    parser.add_argument("-o", "--out", required=True, metavar="FIG", help="the figure to write")
    parser.add_argument("--what", choices=WHAT, default="all", help="part of a rule base to draw")
    parser.add_argument("--output", metavar="NAME", help="the surface of this output only")
    parser.add_argument("--at", metavar="NAME=VALUE,...", help="inputs to hold fixed or to mark")


def run_plot(arguments: argparse.Namespace) -> int:
    """Draw and write."""
    from fuzzyarm.api import load
    from fuzzyarm.show.figures.style import require_figure_suffix, save_figure

    require_figure_suffix(arguments.out)
    model = load(arguments.file)
    save_figure(figure_of(model, arguments), arguments.out)
    print(f"{arguments.out}: drawn from {arguments.file}")
    return 0


def figure_of(model: RuleBase | LookupTable, arguments: argparse.Namespace) -> Figure:
    """Return the figure that the arguments ask for."""
    from fuzzyarm.show.figures.rulebase import memberships_figure, rulebase_figure
    from fuzzyarm.show.figures.surface import surface_figure, table_figure

    words = [] if arguments.at is None else [arguments.at]
    if not isinstance(model, RuleBase):
        if arguments.what != "all" or arguments.output is not None:
            raise WordError("--what and --output are for rule bases, not for tables")
        return table_figure(model, at=read_assignments(words, model.names))
    at = read_assignments(words, [variable.name for variable in model.inputs])
    if arguments.what == "terms":
        return memberships_figure(model)
    output = None
    if arguments.output is not None:
        from fuzzyarm.table.compiler import choose_output

        output = choose_output(model, arguments.output).name
    draw = surface_figure if arguments.what == "surface" else rulebase_figure
    return draw(model, output, at)
