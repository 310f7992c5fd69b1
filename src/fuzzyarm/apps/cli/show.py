"""Draw a model, ``fuzzyarm show`` and ``fuzzyarm plot``, or compare two, ``fuzzyarm diff``."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.cli.command import (
    FORCE,
    UsageError,
    WordError,
    argument,
    at,
    command,
    demand_figure,
    flag,
    json_of,
    out,
    print_json,
    say,
)
from fuzzyarm.base.assignments import read_assignments, read_point
from fuzzyarm.base.jsonable import jsonable
from fuzzyarm.base.names import typed
from fuzzyarm.base.numbers import number_text
from fuzzyarm.exchange.files import load_sheet
from fuzzyarm.language.model.rulebase import RuleBase

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import RenderableType

    from fuzzyarm.control.controllers.text import ControllerText
    from fuzzyarm.table import LookupTable

    Model = RuleBase | LookupTable | ControllerText


_SHOW = """Draw a rule base, a table or a controller in the terminal.

A rule base: its variables with their terms as small plots, the rules as grids, and the
inference methods. A table: its axes, provenance and values as a heat grid. --at adds the
inference (or the cell) at one point. A controller: its gains, its lines with the signal flow
between them, and its rule bases and tables.

  fuzzyarm show rulebases/pd7.frb --at e=1.3,ce=-2
  fuzzyarm show rulebases/servo.frb
"""


def _load(path: str, *, sheet: bool = False) -> Model:
    """Return the model in a file; with `sheet`, the rule base beside a controller in it."""
    from fuzzyarm.exchange.files import load

    return load_sheet(path) if sheet else load(path)


def _show(arguments: argparse.Namespace) -> int:
    models = [_load(path, sheet=arguments.at is not None) for path in arguments.files]
    if arguments.json:
        data = [_model_data(model) for model in models]
        # One file: an object, several: an array.
        print_json(data[0] if len(data) == 1 else data, 2, ascii_only=False)
        return 0
    from fuzzyarm.apps.show.drawing import make_console

    console = make_console()
    drawings = [_drawing(model, arguments) for model in models]
    for k, drawing in enumerate(drawings):
        if k:
            console.print()
        console.print(drawing)
    return 0


def _drawing(model: Model, arguments: argparse.Namespace) -> RenderableType:
    from fuzzyarm.table import LookupTable

    words = None if arguments.at is None else [arguments.at]
    if arguments.diagram:
        return _diagram_drawing(model)
    if isinstance(model, LookupTable):
        from fuzzyarm.apps.show.table import table_view

        point = None
        if words is not None:
            values = read_point(words, model.names)
            point = [values[name] for name in model.names]
        return table_view(model, all_levels=arguments.all, at=point)
    if not isinstance(model, RuleBase):
        from fuzzyarm.apps.show.controller import controller_view

        return controller_view(model)
    from fuzzyarm.apps.show.rulebase import rulebase_view

    if words is None:
        return rulebase_view(model)
    from rich.console import Group
    from rich.text import Text

    from fuzzyarm.apps.show.trace import trace_view
    from fuzzyarm.inference.trace import explain

    values = read_point(words, [variable.name for variable in model.inputs])
    return Group(rulebase_view(model), Text(), trace_view(explain(model, values)))


def _diagram_drawing(model: Model) -> RenderableType:
    from fuzzyarm.apps.show.block_view import DiagramView
    from fuzzyarm.apps.show.diagram import block_diagram
    from fuzzyarm.apps.show.system import system_diagram
    from fuzzyarm.table import LookupTable

    if isinstance(model, LookupTable):
        raise WordError("--diagram is for rule bases and controllers, not for tables")
    return DiagramView(
        system_diagram(model) if isinstance(model, RuleBase) else block_diagram(model)
    )


def _model_data(model: Model) -> dict[str, Any]:
    from fuzzyarm.table import LookupTable

    if isinstance(model, RuleBase):
        return {"kind": "rulebase", **jsonable(model, infinite=number_text)}
    if isinstance(model, LookupTable):
        from fuzzyarm.table.files import header_data

        return {"kind": "table", **header_data(model), "values": model.values}
    from fuzzyarm.apps.show.diagram import block_diagram

    # An infinite number is text: null would lose its sign.
    data, diagram = jsonable((model.model, block_diagram(model)), infinite=number_text)
    return {"kind": "controller", **data, "diagram": diagram}


_PLOT = """Draw a rule base, a table or a controller as a figure: .png, .svg or .pdf.

A rule base: the memberships of every variable and the control surface of every output,
a line over one input, a surface and its map over two, a slice over two of more with the
others at the middle of their ranges or at the point of --at. Points that violate `prove` lines
of the file are marked. A table: its cells. A controller: its block diagram above the
surfaces of its rule bases and tables. --what diagram draws the block diagram alone, also
that of a rule base: inputs, rules and outputs.

A rule base or a controller without memory has a describing function (its gain under a
sinusoidal error); a rule base of error and rate, or a controller on a plant, a phase portrait.

  fuzzyarm plot rulebases/thermostat.frb -o thermostat.svg --at presence=1
  fuzzyarm plot rulebases/tanks.frb -o tanks.png
  fuzzyarm plot rulebases/servo.frb -o servo.png --what phase --plant motor
"""


def _plot(arguments: argparse.Namespace) -> int:
    from fuzzyarm.base.figure_files import save_figure

    demand_figure(arguments.out)
    if arguments.what in LOOP_FIGURES:
        figure = _loop_figure(arguments)
    elif arguments.plant is not None:
        raise UsageError("--plant goes with --what phase")
    else:
        rules = arguments.what in ("terms", "surface")
        needs_sheet = arguments.at is not None or arguments.output is not None
        figure = _figure(_load(arguments.file, sheet=rules or needs_sheet), arguments)
    save_figure(figure, arguments.out)
    say(f"{arguments.out}: drawn from {arguments.file}")
    return 0


LOOP_FIGURES = ("describing-function", "phase")
"""Parts of a rule base or a controller in a loop."""


def _loop_figure(arguments: argparse.Namespace) -> Figure:
    from fuzzyarm.apps.show.figures.analysis import describing_figure, portrait_figure
    from fuzzyarm.control.loop import phase_portrait
    from fuzzyarm.exchange.files import load
    from fuzzyarm.table import LookupTable

    model = load(arguments.file)
    if isinstance(model, LookupTable) or arguments.at is not None or arguments.output is not None:
        raise WordError(
            f"--what {arguments.what} takes a rule base or a controller, without --at and --output"
        )
    if arguments.what == "describing-function":
        if arguments.plant is not None:
            raise UsageError("--plant goes with --what phase")
        return describing_figure(model)
    from fuzzyarm.plant import find_plant

    plant = find_plant(arguments.plant) if arguments.plant is not None else None
    return portrait_figure(phase_portrait(model, plant))


def _figure(model: Model, arguments: argparse.Namespace) -> Figure:
    from fuzzyarm.apps.cli.command import busy
    from fuzzyarm.apps.show.figures.whole import model_figure
    from fuzzyarm.control.controllers.text import ControllerText

    words = [] if arguments.at is None else [arguments.at]
    names: Sequence[str] = ()
    if isinstance(model, RuleBase):
        names = [variable.name for variable in model.inputs]
    elif not isinstance(model, ControllerText):
        if arguments.what not in ("all", "diagram") or arguments.output is not None:
            raise WordError("--what and --output are for rule bases, not for tables")
        names = model.names
    if arguments.what == "diagram" and not isinstance(model, RuleBase | ControllerText):
        raise WordError(f"--what diagram is for rule bases and controllers, not {arguments.file}")
    point = read_assignments(words, names)
    with busy("drawing"):
        return model_figure(model, arguments.what, arguments.output, point)


_DIFF = """Compare two tables cell by cell, two rule bases rule by rule, or two controllers.

Tables are compared by the names of their inputs: swapped rows and columns are turned round
first, with a note. Rule bases, foreign files among them, are compared by meaning: the order of
rules, comments, layout and shared rules do not count; `same` of --json is about that. And by
numbers: how far each output is apart, where it is farthest, and the root of the mean square over
the ranges of the inputs. The worst point is found by search, at the corners of terms, between them
and from there on. Where both are made of straight pieces, what the difference nowhere exceeds is
proved, too, within ten seconds for each output. Controllers are compared gain by gain and line by
line, with their rule bases and tables. The exit status is 0 whether or not they differ.
"""


def _diff(arguments: argparse.Namespace) -> int:
    from fuzzyarm.apps.show.controller_diff import compare_controllers, controller_diff_view
    from fuzzyarm.apps.show.diff import compare_rulebases, rulebase_diff_view, table_diff_view
    from fuzzyarm.apps.show.drawing import make_console
    from fuzzyarm.control.controllers.text import ControllerText
    from fuzzyarm.inference.apart import UnlikeRuleBasesError, apart
    from fuzzyarm.proof.map.difference import with_proofs
    from fuzzyarm.table import LookupTable
    from fuzzyarm.table.diff import compare_tables

    before, after = _load(arguments.before), _load(arguments.after)
    data: Any
    if isinstance(before, RuleBase) and isinstance(after, RuleBase):
        rules = compare_rulebases(before, after)
        try:
            rules = replace(rules, outputs=with_proofs(before, after, apart(before, after)))
        except UnlikeRuleBasesError as error:
            say(f"note: numbers are not compared: {error}", to_errors=True)
        data, view = rules, rulebase_diff_view(rules)
    elif isinstance(before, LookupTable) and isinstance(after, LookupTable):
        cells = compare_tables(before, after)
        data, view = cells, table_diff_view(cells)
    elif isinstance(before, ControllerText) and isinstance(after, ControllerText):
        diff = compare_controllers(before, after)
        data, view = diff, controller_diff_view(diff)
    else:
        raise _unlike(arguments, before, after)
    if arguments.json:
        print_json(data, 2)
    else:
        make_console().print(view)
    return 0


def _unlike(arguments: argparse.Namespace, before: Model, after: Model) -> WordError:
    """Return the refusal to compare two files, with a comparable one as a hint."""
    from fuzzyarm.control.controllers.text import ControllerText, sheet_files

    hint = "give two rule bases, two tables or two controllers; compile makes a table of rules"
    for path, model in ((arguments.before, before), (arguments.after, after)):
        if isinstance(model, ControllerText):
            files = " or ".join(typed(str(file)) for file in sheet_files(model))
            hint = f"{path} looks up {files}" if files else hint
    message = f"a {_kind_of(before)} and a {_kind_of(after)} cannot be compared"
    return WordError(message, hint=hint)


def _kind_of(model: Model) -> str:
    from fuzzyarm.table import LookupTable

    if isinstance(model, RuleBase):
        return "rule base"
    return "table" if isinstance(model, LookupTable) else "controller"


COMMANDS = (
    command(
        "show",
        _SHOW,
        _show,
        argument("files FILE", "rule bases, tables and controllers", nargs="+"),
        at("also the inference at one point"),
        flag("--all", "every level of a large table"),
        flag("--diagram", "the block diagram of a rule base or a controller instead"),
        json_of("the model"),
    ),
    command(
        "plot",
        _PLOT,
        _plot,
        argument("file FILE", "a rule base, a table or a controller"),
        out("FIG", "the figure to write"),
        FORCE,
        argument(
            "--what",
            "the part to draw, or its behaviour in a loop",
            choices=("all", "diagram", "terms", "surface", *LOOP_FIGURES),
            default="all",
        ),
        argument("--output NAME", "the surface of this output only"),
        argument("--plant PLANT", "plant for the phase portrait of a controller"),
        at("inputs to hold fixed or to mark"),
    ),
    command(
        "diff",
        _DIFF,
        _diff,
        argument("before A", "a table, a rule base or a controller"),
        argument("after B", "another of the same kind"),
        json_of("the differences"),
    ),
)
