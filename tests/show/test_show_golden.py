"""What the terminal shows, at 80 columns, word for word."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
from rich.console import Console
from rich.style import Style

from fuzzyarm.apps.show.diff import compare_rulebases, rulebase_diff_view, table_diff_view
from fuzzyarm.apps.show.drawing import make_console, plain_text
from fuzzyarm.apps.show.rulebase import rulebase_view
from fuzzyarm.apps.show.table import table_grids, table_view
from fuzzyarm.apps.show.trace import trace_view
from fuzzyarm.inference import explain
from fuzzyarm.language import parse
from fuzzyarm.table import compare_tables, compile_table, read_table

RULEBASES = Path(__file__).parents[2] / "rulebases"


def test_rule_base(golden, lopsided):
    golden("rulebase.txt", plain_text(rulebase_view(lopsided)))


def test_trace(golden, lopsided):
    golden("trace.txt", plain_text(trace_view(explain(lopsided, a=3.5, b=0.25), "lopsided.frb")))


def test_published_table(golden):
    table = read_table(RULEBASES / "thesis-6.1.lut")
    text = plain_text(table_view(table, at=(1.3, -2.2)))
    golden("thesis-6.1.txt", text)
    assert max(map(len, text.splitlines())) <= 80


def test_published_table_in_colour(golden):
    # A style keeps the codes of the first terminal that it was drawn for.
    Style.parse.cache_clear()
    Style._add.cache_clear()
    out = io.StringIO()
    console = make_console(
        out, width=80, force_terminal=True, color_system="truecolor", _environ={}
    )
    console.print(table_view(read_table(RULEBASES / "performance-yamazaki.lut")))
    golden("performance-yamazaki-colour.txt", out.getvalue())


def test_three_inputs_give_one_grid_for_each_page(golden):
    text = (RULEBASES / "thermostat.frb").read_text("utf-8")
    rulebase = parse(text).rulebase
    levels = {"error": (-5, 5), "rate": (-2, 0, 2), "presence": (0, 0.5, 1)}
    table = compile_table(rulebase, levels=levels, rounding=0.1)
    drawings = table_grids(table)
    console = Console(width=80, file=io.StringIO(), highlight=False)
    for drawing in drawings:
        console.print(drawing)
    golden("pages.txt", console.file.getvalue())


def test_difference_of_tables(golden, lopsided):
    before = compile_table(lopsided, levels={"a": 3, "b": 4}, rounding=0.01)
    values = before.values.copy()
    values[0, 3] += 1.5
    values[2, 1] = 0.0
    diff = compare_tables(before, before.with_values(values))
    golden("table-diff.txt", plain_text(table_diff_view(diff)))


def test_difference_of_rule_bases(golden, lopsided, lopsided_text):
    changed = lopsided_text.replace("S  M*0.5 ", "S  L     ").replace("LO     S  S", "LO     .  S")
    changed = changed.replace("triangle 3 5 7", "triangle 3 5 8").replace("with 0.1", "with 0.2")
    after = parse(changed).rulebase
    golden("rule-diff.txt", plain_text(rulebase_diff_view(compare_rulebases(lopsided, after))))


@pytest.mark.parametrize("width", [40, 80, 120])
@pytest.mark.parametrize("name", ["pd7.frb", "tipper.frb", "thermostat.frb", "fan.frb"])
def test_nothing_is_cut_off(name, width):
    rulebase = parse((RULEBASES / name).read_text("utf-8")).rulebase
    text = plain_text(rulebase_view(rulebase), width)
    assert "…" not in text
    for variable in (*rulebase.inputs, *rulebase.outputs):
        for term in variable.terms:
            assert term.name in text
    assert max(map(len, text.splitlines())) <= width
