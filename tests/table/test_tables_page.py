"""docs/reference/tables.md speaks of the format as it is."""

from __future__ import annotations

import re
from pathlib import Path

from fuzzyarm.table import LookupTable, parse_lut
from fuzzyarm.table.files import table_as

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "reference" / "tables.md").read_text("utf-8")


def test_the_example_is_a_table_in_canonical_form():
    (example,) = re.findall(r"```lut\n(.*?)```", PAGE, re.DOTALL)
    parsed = parse_lut(example)
    assert parsed.diagnostics == ()
    assert table_as(LookupTable.from_plain(parsed.table), ".lut") == example


def test_every_mistake_is_explained():
    names = set()
    for path in (ROOT / "src" / "fuzzyarm" / "table").glob("*.py"):
        calls = r"(?:Diagnostic|_report|_fault)\(\s*\"([a-z]+(?:-[a-z]+)+)\""
        names |= set(re.findall(calls, path.read_text("utf-8")))
    assert len(names) > 20
    pages = PAGE + (ROOT / "docs" / "reference" / "checks.md").read_text("utf-8")
    assert {name for name in names if f"`{name}`" not in pages} == set()
