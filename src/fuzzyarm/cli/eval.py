"""Evaluate a rule base or a table at one point.

Prints every output by name; with --json exactly one object such as {"u": 1.25}. With
--explain the way from the inputs to the outputs: memberships, the rules that fire with
their places in the file, the clipped sets and the value. --plot FIG draws the same as a
figure.

  fuzzyarm eval rulebases/pd7.frb e=1.3 ce=-2.2 --explain
"""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.arguments import WordError, read_assignments, require_all
from fuzzyarm.language.tokens import name_text
from fuzzyarm.model.rulebase import Defuzzifier, RuleBase
from fuzzyarm.text.numbers import number_text

if TYPE_CHECKING:
    from fuzzyarm.table import LookupTable


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm eval``."""
    parser.add_argument("file", metavar="FILE", help="a rule base or a table")
    parser.add_argument("inputs", nargs="*", metavar="NAME=VALUE", help="a value for each input")
    parser.add_argument("--explain", action="store_true", help="show the way to the result")
    parser.add_argument("--plot", metavar="FIG", help="draw the inference: .png, .svg or .pdf")
    parser.add_argument("--json", action="store_true", help="print the outputs as JSON")
    parser.add_argument(
        "--defuzzifier", metavar="HOW", help="instead of the file's, such as 'centroid(101)'"
    )
    parser.add_argument(
        "--held", action="append", default=[], metavar="NAME=VALUE", help="last value of an output"
    )
    parser.add_argument(
        "--mode", choices=("bins", "nearest", "linear"), help="how to look a table up"
    )


def run(arguments: argparse.Namespace) -> int:
    """Evaluate and print."""
    from fuzzyarm.api import load

    model = load(arguments.file)
    if isinstance(model, RuleBase):
        return _run_rulebase(model, arguments)
    return _run_table(model, arguments)


def _run_rulebase(rulebase: RuleBase, arguments: argparse.Namespace) -> int:
    from fuzzyarm.inference.point import prepare

    if arguments.mode is not None:
        raise WordError("--mode is for tables; a rule base is evaluated, not looked up")
    if arguments.defuzzifier is not None:
        rulebase = with_defuzzifier(rulebase, arguments.defuzzifier)
    names = [variable.name for variable in rulebase.inputs]
    values = read_assignments(arguments.inputs, names)
    require_all(values, names)
    results = [output.name for output in rulebase.outputs]
    held = read_assignments(arguments.held, results, what="output")
    outputs = prepare(rulebase).evaluate(values, held)
    if arguments.plot is not None or arguments.explain:
        _explain(rulebase, values, held, arguments, outputs)
    elif arguments.json:
        print(json.dumps(outputs, ensure_ascii=False))
    else:
        print(in_words(outputs))
    return 0


def _explain(
    rulebase: RuleBase,
    values: dict[str, float],
    held: dict[str, float],
    arguments: argparse.Namespace,
    outputs: dict[str, float],
) -> None:
    from fuzzyarm.inference.trace import explain

    trace = explain(rulebase, values, held=held)
    if arguments.plot is not None:
        from fuzzyarm.show.figures import inference_figure, save_figure

        save_figure(inference_figure(rulebase, trace), arguments.plot)
    if arguments.json:
        data: dict[str, Any] = trace.to_dict() if arguments.explain else outputs
        print(json.dumps(data, ensure_ascii=False))
    elif arguments.explain:
        from fuzzyarm.show.drawing import make_console
        from fuzzyarm.show.trace import trace_view

        make_console().print(trace_view(trace))
    else:
        print(in_words(outputs))


def _run_table(table: LookupTable, arguments: argparse.Namespace) -> int:
    if arguments.defuzzifier is not None or arguments.held:
        raise WordError("--defuzzifier and --held are for rule bases, not for tables")
    values = read_assignments(arguments.inputs, table.names)
    require_all(values, table.names)
    result = {table.output: table.lookup(**_in_order(table, values), mode=arguments.mode)}
    if arguments.plot is not None:
        from fuzzyarm.show.figures import save_figure, table_figure

        save_figure(table_figure(table, at=values), arguments.plot)
    if arguments.json:
        print(json.dumps(result, ensure_ascii=False))
        return 0
    if arguments.explain:
        print("\n".join(table_steps(table, values, arguments.mode)))
    print(in_words(result))
    return 0


def _in_order(table: LookupTable, values: dict[str, float]) -> dict[str, float]:
    return {name: values[name] for name in table.names}


def table_steps(table: LookupTable, values: dict[str, float], mode: str | None) -> list[str]:
    """Return in words which cell each input falls into."""
    chosen = mode or table.default_mode
    lines = [f"looked up by {chosen}"]
    for axis in table.axes:
        x = values[axis.name]
        index = axis.cell(x, chosen)
        low, high = axis.cell_range(index, chosen)
        cell = f"level {number_text(axis.levels[index])} (index {index})"
        if chosen == "linear":
            lines.append(f"{name_text(axis.name)} = {number_text(x)}: nearest {cell}")
            continue
        span = f"{number_text(low)} < {name_text(axis.name)} <= {number_text(high)}"
        lines.append(f"{name_text(axis.name)} = {number_text(x)}: {cell}, {span}")
    return lines


def in_words(outputs: dict[str, float]) -> str:
    """Return the outputs one to a line."""
    return "\n".join(f"{name_text(name)} = {number_text(x)}" for name, x in outputs.items())


def with_defuzzifier(rulebase: RuleBase, text: str) -> RuleBase:
    """Return `rulebase` with the defuzzifier that `text` names for every output."""
    defuzzifier = read_defuzzifier(text)
    outputs = tuple(replace(output, defuzzifier=defuzzifier) for output in rulebase.outputs)
    return replace(rulebase, outputs=outputs)


def read_defuzzifier(text: str) -> Defuzzifier:
    """Return the defuzzifier in the words of the language, such as ``centroid(101, midpoints)``.

    Raises
    ------
    WordError
        If the language has no such defuzzifier.
    """
    from fuzzyarm.language import parse

    # The language itself reads it, inside the smallest rule base there is.
    prefix = "inference  defuzzifier "
    around = "rulebase r\ninput x 0 .. 1\noutput y 0 .. 1\nterms x, y: triangles A B\n"
    parsed = parse(f"{around}{prefix}{' '.join(text.split())}\nrule if x is A then y is A\n")
    for finding in parsed.diagnostics:
        if finding.is_error:
            hint = finding.hint or "for instance centroid, centroid(101) or bisector"
            raise WordError(f"--defuzzifier '{text}': {finding.message}", hint=hint)
    return parsed.partial.outputs[0].defuzzifier
