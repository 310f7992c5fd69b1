"""Draw a rule base or a table in the terminal.

A rule base: its variables with their terms as small plots, the rules as grids, how they are
evaluated. A table: its axes, its origin and its values as a heat grid. With --at the
inference (or the cell) at one point is shown as well.

  fuzzyarm show rulebases/pd7.frb --at e=1.3,ce=-2
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.assignments import read_assignments, require_all
from fuzzyarm.rulebase.model import RuleBase

if TYPE_CHECKING:
    from rich.console import RenderableType

    from fuzzyarm.lut import LookupTable


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm show``."""
    parser.add_argument("files", nargs="+", metavar="FILE", help="rule bases and tables")
    parser.add_argument("--at", metavar="NAME=VALUE,...", help="also the inference at one point")
    parser.add_argument("--all", action="store_true", help="every level of a large table")
    parser.add_argument("--json", action="store_true", help="print the model as JSON")


def run(arguments: argparse.Namespace) -> int:
    """Draw every file."""
    from fuzzyarm.api import load

    models = [load(path) for path in arguments.files]
    if arguments.json:
        data = [as_data(model) for model in models]
        print(json.dumps(data[0] if len(data) == 1 else data, ensure_ascii=False, indent=2))
        return 0
    from fuzzyarm.show.console import make_console

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
    from fuzzyarm.lut.json_text import header_data

    return {"kind": "table", **header_data(model), "values": model.values.tolist()}


def _without_spans(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _without_spans(value) for key, value in data.items() if key != "span"}
    if isinstance(data, (list, tuple)):
        return [_without_spans(value) for value in data]
    if isinstance(data, float) and not -1e308 < data < 1e308:
        return str(data)  # JSON has no infinity
    return data
