"""Draw a rule base or a table as a figure: .png, .svg or .pdf.

A rule base gives the memberships of every variable and the control surface of every output:
a line over one input, a surface and its map over two, a slice over two of more with the
others at the middle of their ranges or where --at says. A table gives its cells.

  fuzzyarm plot rulebases/thermostat.frb -o thermostat.svg --at presence=1
"""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from fuzzyarm.cli.assignments import WordError, read_assignments
from fuzzyarm.rulebase.model import RuleBase

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fuzzyarm.lut import LookupTable

WHAT = ("all", "terms", "surface")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm plot``."""
    parser.add_argument("file", metavar="FILE", help="a rule base or a table")
    parser.add_argument("-o", "--out", required=True, metavar="FIG", help="the figure to write")
    parser.add_argument("--what", choices=WHAT, default="all", help="part of a rule base to draw")
    parser.add_argument("--output", metavar="NAME", help="the surface of this output only")
    parser.add_argument("--at", metavar="NAME=VALUE,...", help="inputs to hold fixed or to mark")


def run(arguments: argparse.Namespace) -> int:
    """Draw and write."""
    from fuzzyarm.api import load
    from fuzzyarm.show.figures.save import require_figure_suffix, save_figure

    require_figure_suffix(arguments.out)
    model = load(arguments.file)
    save_figure(figure_of(model, arguments), arguments.out)
    print(f"{arguments.out}: drawn from {arguments.file}")
    return 0


def figure_of(model: RuleBase | LookupTable, arguments: argparse.Namespace) -> Figure:
    """Return the figure that the arguments ask for."""
    from fuzzyarm.show import figures

    words = [] if arguments.at is None else [arguments.at]
    if not isinstance(model, RuleBase):
        if arguments.what != "all" or arguments.output is not None:
            raise WordError("--what and --output are for rule bases, not for tables")
        return figures.table_figure(model, at=read_assignments(words, model.names))
    at = read_assignments(words, [variable.name for variable in model.inputs])
    if arguments.what == "terms":
        return figures.memberships_figure(model)
    output = None
    if arguments.output is not None:
        from fuzzyarm.lut.compiler import choose_output

        output = choose_output(model, arguments.output).name
    draw = figures.surface_figure if arguments.what == "surface" else figures.rulebase_figure
    return draw(model, output, at)
