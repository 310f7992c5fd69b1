"""Evaluate a rule base or a table at one point.

Prints every output by name; with --json exactly one object such as {"u": 1.25}. --explain
prints the steps from the inputs to the outputs: memberships, the fired rules with
their positions in the file, the clipped sets and the value. --plot FIG draws the same as a
figure.

  fuzzyarm eval rulebases/pd7.frb e=1.3 ce=-2.2 --explain
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.cli.command import (
    FORCE,
    MODE,
    MODEL,
    WordError,
    argument,
    command,
    flag,
    json_of,
    print_json,
    say,
)
from fuzzyarm.base.assignments import read_assignments, read_point
from fuzzyarm.base.errors import UsageError
from fuzzyarm.base.numbers import number_text
from fuzzyarm.exchange.files import load_sheet
from fuzzyarm.language.model.rulebase import Defuzzifier, RuleBase
from fuzzyarm.language.tokens import name_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import RenderableType

    from fuzzyarm.table import LookupTable


def _run(arguments: argparse.Namespace) -> int:

    model = load_sheet(arguments.file)
    if isinstance(model, RuleBase):
        _infer(model, arguments)
    else:
        _look_up(model, arguments)
    return 0


def _infer(rulebase: RuleBase, arguments: argparse.Namespace) -> None:
    if arguments.mode is not None:
        raise WordError("--mode is for tables; a rule base is evaluated, not looked up")
    if arguments.defuzzifier is not None:
        rulebase = _with_defuzzifier(rulebase, arguments.defuzzifier)
    values = read_point(arguments.inputs, [variable.name for variable in rulebase.inputs])
    results = [output.name for output in rulebase.outputs]
    last_values = read_assignments(arguments.held, results, what="output")
    from fuzzyarm.inference import infer
    from fuzzyarm.inference.errors import NoRuleFiredError, NothingHeldError

    try:
        outputs = infer(rulebase, values, held=last_values)
    except (NoRuleFiredError, NothingHeldError) as error:
        if arguments.explain and not arguments.json:
            from fuzzyarm.apps.show.trace import silence_view
            from fuzzyarm.inference.trace import explain_silence

            _print_drawing(silence_view(explain_silence(rulebase, values, error.output)))
        raise
    if not arguments.explain and arguments.plot is None:
        _print(outputs, arguments)
        return
    from fuzzyarm.inference.trace import explain

    trace = explain(rulebase, values, held=last_values)
    if arguments.plot is not None:
        from fuzzyarm.apps.show.figures import inference_figure

        _save(inference_figure(rulebase, trace), arguments)
    if not arguments.explain:
        _print(outputs, arguments)
    elif arguments.json:
        print_json(trace.to_dict(), ascii_only=False)
    else:
        from fuzzyarm.apps.show.trace import trace_view

        _print_drawing(trace_view(trace))


def _print_drawing(drawing: RenderableType) -> None:
    from fuzzyarm.apps.show.drawing import make_console

    make_console().print(drawing)


def _look_up(table: LookupTable, arguments: argparse.Namespace) -> None:
    if arguments.defuzzifier is not None or arguments.held:
        raise WordError("--defuzzifier and --held are for rule bases, not for tables")
    values = read_point(arguments.inputs, table.names)
    point = {name: values[name] for name in table.names}
    result = {table.output: table.lookup(**point, mode=arguments.mode)}
    if arguments.plot is not None:
        from fuzzyarm.apps.show.figures import table_figure

        _save(table_figure(table, at=values), arguments)
    if arguments.explain and not arguments.json:
        say(*_steps(table, values, arguments.mode))
    _print(result, arguments)


def _print(outputs: dict[str, Any], arguments: argparse.Namespace) -> None:
    if arguments.json:
        print_json(outputs, ascii_only=False)
        return
    say(*(f"{name_text(name)} = {number_text(x)}" for name, x in outputs.items()))


def _save(figure: Figure, arguments: argparse.Namespace) -> None:
    from fuzzyarm.apps.show.figures import save_figure

    save_figure(figure, arguments.plot)


def _steps(table: LookupTable, values: dict[str, float], mode: str | None) -> list[str]:
    """Return the cell of each input in words."""
    lookup_mode = mode or table.default_mode
    lines = [f"looked up by {lookup_mode}"]
    for axis in table.axes:
        x = values[axis.name]
        index = axis.cell(x, lookup_mode)
        low, high = axis.cell_range(index, lookup_mode)
        cell = f"level {number_text(axis.levels[index])} (index {index})"
        if lookup_mode == "linear":
            lines.append(f"{name_text(axis.name)} = {number_text(x)}: nearest {cell}")
            continue
        span = f"{number_text(low)} < {name_text(axis.name)} <= {number_text(high)}"
        lines.append(f"{name_text(axis.name)} = {number_text(x)}: {cell}, {span}")
    return lines


def _with_defuzzifier(rulebase: RuleBase, text: str) -> RuleBase:
    defuzzifier = _read_defuzzifier(text)
    outputs = tuple(replace(output, defuzzifier=defuzzifier) for output in rulebase.outputs)
    return replace(rulebase, outputs=outputs)


def _read_defuzzifier(text: str) -> Defuzzifier:
    """Return the defuzzifier in language syntax, such as ``centroid(101, midpoints)``."""
    from fuzzyarm.language import parse

    # Parsed by the language itself, in the smallest possible rule base.
    prefix = "inference  defuzzifier "
    around = "rulebase r\ninput x 0 .. 1\noutput y 0 .. 1\nterms x, y: triangles A B\n"
    parsed = parse(f"{around}{prefix}{' '.join(text.split())}\nrule if x is A then y is A\n")
    for finding in parsed.diagnostics:
        if finding.is_error:
            hint = finding.hint or "for instance centroid, centroid(101) or bisector"
            raise UsageError(f"--defuzzifier '{text}': {finding.message}", hint=hint)
    return parsed.partial.outputs[0].defuzzifier


COMMANDS = (
    command(
        "eval",
        __doc__,
        _run,
        MODEL,
        argument("inputs NAME=VALUE", "a value for each input", nargs="*"),
        flag("--explain", "show the way to the result"),
        argument("--plot FIG", "draw the inference: .png, .svg or .pdf"),
        FORCE,
        json_of("the outputs"),
        argument("--defuzzifier HOW", "instead of the file's, such as 'centroid(101)'"),
        argument("--held NAME=VALUE", "last value of an output", action="append", default=[]),
        MODE,
    ),
)
