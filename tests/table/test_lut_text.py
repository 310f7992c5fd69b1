from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fuzzyarm.base.diagnostic import Span
from fuzzyarm.table import LookupTable, parse_lut
from fuzzyarm.table.files import parse_table

RULEBASES = Path(__file__).parents[2] / "rulebases"

TEXT = """\
# A table without any symmetry.
fuzzyarm-table 1

input   e   -1 .. 2   "error, mm"     # a comment behind
input   ce   0 .. 40
output  u   -9 .. 9   "control, V"

index   row e, column ce
levels  e: -1 0 2
levels  ce: 0 10 20 40
bins    e: 0.5 mirrored
round   0.5
mode    bins
origin  source  "my.frb"
origin  note    "kept: # and \\"quotes\\""

grid
  e \\ ce   0  10    20    40
     -1    1   2   3.5     4
      0    5   6  -7e-1    8     # the middle
      2    9  10    11    12
"""

PAGES = """\
fuzzyarm-table 1
output u
index page load, row e, column ce
levels load: 0 1
levels e: -1 1
levels ce: 0 5 9
grid when load = 1
  e \\ ce  0 5 9
  -1 7 8 9
  1 10 11 12
grid when load = 0
  e \\ ce  0 5 9
  -1 1 2 3
  1 4 5 6
"""


def test_a_table_written_by_hand():
    parsed = parse_lut(TEXT, "hand.lut")
    assert parsed.diagnostics == ()
    table = LookupTable.from_plain(parsed.table)
    assert table.names == ("e", "ce")
    assert table.values.tolist() == [[1, 2, 3.5, 4], [5, 6, -0.7, 8], [9, 10, 11, 12]]
    assert table.axis("e").bins == (-0.5, 0.5)
    assert table.axis("ce").bins is None
    assert (table.axis("e").low, table.axis("e").high) == (-1.0, 2.0)
    assert table.axis("e").description == "error, mm"
    assert (table.low, table.high, table.description) == (-9.0, 9.0, "control, V")
    assert (table.rounding, table.mode) == (0.5, "bins")
    assert dict(table.provenance) == {"source": "my.frb", "note": 'kept: # and "quotes"'}


def test_pages_are_found_by_their_label_not_by_their_order():
    table = LookupTable.from_plain(parse_lut(PAGES).table)
    np.testing.assert_array_equal(table.values.ravel(), np.arange(1, 13))
    assert table.lookup(1, -1, 5) == 8.0


def found(text: str) -> list[tuple[str, int, int]]:
    parsed = parse_lut(text, "x.lut")
    assert parsed.table is None
    assert all(d.path == "x.lut" and d.message for d in parsed.diagnostics)
    return [(d.name, d.line, d.column) for d in parsed.diagnostics]


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("index   row e, column ce\n", "\n", ("missing-index-order", 2, 1)),
        ("index   row e, column ce", "index   column e, row ce", ("wrong-index-order", 8, 1)),
        ("index   row e, column ce", "index   row e, column e", ("duplicate-statement", 8, 23)),
        ("fuzzyarm-table 1", "fuzzyarm-table 2", ("unknown-version", 2, 16)),
        ("fuzzyarm-table 1\n", "\n", ("missing-format", 1, 1)),
        ('output  u   -9 .. 9   "control, V"', "", ("missing-output", 2, 1)),
        ("output  u   -9 .. 9", "output  u   9 .. -9", ("bad-range", 6, 13)),
        ("round   0.5", "rounded 0.5", ("unknown-keyword", 12, 1)),
        ("round   0.5", "round   0", ("bad-step", 12, 9)),
        ("round   0.5", "round   0.5 0.6", ("trailing-text", 12, 13)),
        ("mode    bins", "mode    bin", ("unknown-choice", 13, 9)),
        ("mode    bins", "round   1", ("duplicate-statement", 13, 1)),
        ("levels  e: -1 0 2\n", "\n", ("missing-levels", 8, 1)),
        ("levels  e: -1 0 2", "levels  e: -1 0 0", ("not-increasing", 9, 12)),
        ("levels  e: -1 0 2", "levels  e: -1 .. 2 step 2", ("bad-levels", 9, 12)),
        ("levels  e: -1 0 2", "levels  e: 0 .. 9 step 1e-9", ("too-many-levels", 9, 12)),
        ("levels  e: -1 0 2", "levels  e: 0 .. 9 count 2.5", ("bad-levels", 9, 12)),
        ("levels  e: -1 0 2", "levels  e: 0 .. 9 by 3", ("unexpected-token", 9, 19)),
        ("levels  e: -1 0 2", "levels  ee: -1 0 2", ("unknown-variable", 9, 9)),
        ("bins    e: 0.5 mirrored", "bins    e: 0.5", ("wrong-bin-count", 11, 12)),
        ("bins    e: 0.5 mirrored", "bins    e: 2 1 mirrored", ("not-increasing", 11, 12)),
        ("bins    e: 0.5 mirrored", "bins    e: -0.5 mirrored", ("not-increasing", 11, 12)),
        ("input   ce   0 .. 40", "input   cx   0 .. 40", ("unknown-variable", 5, 9)),
        ('"my.frb"', "my.frb", ("unexpected-token", 14, 17)),
        ('"my.frb"', '"my.frb', ("unterminated-string", 14, 17)),
        ("e \\ ce ", "ce \\ e ", ("transposed-labels", 18, 3)),
        ("e \\ ce ", "e \\ cx ", ("wrong-corner", 18, 3)),
        ("e \\ ce ", "  ", ("missing-corner", 18, 1)),
        ("0  10    20    40", "0  10    20", ("wrong-cell-count", 18, 12)),
        ("0  10    20    40", "0  10    30    40", ("wrong-label", 18, 21)),
        ("0  10    20    40", "-1 0 2", ("transposed-labels", 18, 12)),
        ("     -1    1", "     -2    1", ("wrong-label", 19, 6)),
        ("3.5     4", "3.5", ("wrong-cell-count", 19, 23)),
        ("3.5     4", "3.5  4  5 6", ("wrong-cell-count", 19, 28)),
        ("3.5", "three", ("not-a-number", 19, 20)),
        ("3.5", "3,5", ("not-a-number", 19, 20)),
        ("3.5", "1e999", ("not-a-number", 19, 20)),
        ("3.5", "nan", ("not-a-number", 19, 20)),
        ("3.5", "1_0", ("not-a-number", 19, 20)),
        ("      2    9  10    11    12\n", "", ("missing-row", 17, 1)),
        ("      2    9  10    11    12\n", "2 9 10 11 12\n3 1 1 1 1\n", ("extra-row", 22, 1)),
        ("grid\n", "grid when e = 3\n", ("unknown-variable", 17, 11)),
        ("grid\n", "grid\n\ngrid\n", ("missing-rows", 17, 1)),
    ],
)
def test_each_mistake_has_a_name_and_a_place(old, new, expected):
    assert old in TEXT
    assert expected in found(TEXT.replace(old, new, 1))


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("grid when load = 1", "grid when load = 3", ("wrong-label", 7, 18)),
        ("grid when load = 1", "grid when laod = 1", ("unknown-variable", 7, 11)),
        ("grid when load = 1", "grid", ("incomplete-page", 7, 1)),
        ("grid when load = 1", "grid when load = 0", ("duplicate-grid", 11, 1)),
        ("grid when load = 1", "grid when load = 0", ("missing-grid", 11, 1)),
    ],
)
def test_mistakes_in_pages(old, new, expected):
    assert expected in found(PAGES.replace(old, new, 1))


def test_swapped_rows_and_columns_are_named_for_what_they_are():
    text = TEXT.replace("e \\ ce   0  10    20    40", "e \\ ce  -1 0 2")
    text = text.split("     -1    1")[0] + "0 1 5 9\n10 2 6 10\n20 3 7 11\n40 4 8 12\n"
    names = [name for name, _, _ in found(text)]
    assert names.count("transposed-labels") == 2


def test_all_mistakes_are_reported_in_one_run_in_order():
    text = TEXT.replace("round   0.5", "ruond 0.5").replace("3.5", "x").replace("11 ", "y  ")
    parsed = parse_lut(text)
    assert [(d.name, d.line) for d in parsed.diagnostics] == [
        ("unknown-keyword", 12),
        ("not-a-number", 19),
        ("not-a-number", 21),
    ]
    assert parsed.diagnostics[0].hint == "did you mean 'round'?"
    assert parsed.diagnostics[0].replacement == "round"


def test_signs_and_decimal_commas_from_other_programs_are_explained():
    hints = [
        d.hint
        for d in parse_lut(TEXT.replace("3.5", "3,5").replace("-7e-1", "\u22120.7")).diagnostics
    ]
    assert hints == ["did you mean '3.5'?", "did you mean '-0.7'?"]


def test_one_input_has_one_row():
    text = "fuzzyarm-table 1\noutput u\nindex column t\nlevels 0 1\ngrid\n t 0 1\n u 5 6\n"
    assert LookupTable.from_plain(parse_lut(text).table).lookup(1) == 6.0
    assert found(text + " u 7 8\n") == [("extra-row", 8, 1)]
    assert found(text.replace(" u 5", " v 5")) == [("wrong-label", 7, 2)]
    assert found(text.replace("5 6", "5")) == [("wrong-cell-count", 7, 5)]


def test_bytes_that_are_no_text():
    parsed = parse_table(b"fuzzyarm-table 1\nab\xff", "x.lut")
    (found,) = parsed.diagnostics
    assert (found.name, found.span) == ("not-text", Span(2, 3, 2, 4))


def test_a_text_that_is_no_table_is_marked_at_its_beginning():
    (found,) = parse_lut("").diagnostics
    assert (found.name, found.span) == ("missing-format", Span(1, 1, 1, 2))


DAMAGE = "\x00\"'#\\,:.-+ \t\n\r\u2212\u0117\U0001f600019eEgxz"


def damaged(text: str, random: np.random.Generator) -> str:
    """Return `text` with one to three small wounds."""
    for _ in range(int(random.integers(1, 4))):
        at, kind = int(random.integers(len(text) + 1)), int(random.integers(6))
        end = at + int(random.integers(1, 12))
        patch = DAMAGE[int(random.integers(len(DAMAGE)))]
        if kind == 0:
            text = text[:at] + text[end:]
        elif kind == 1:
            text = text[:at] + patch + text[at:]
        elif kind == 2:
            text = text[:at] + patch + text[at + 1 :]
        elif kind == 3:
            text = text[:at] + text[at:end] * 2 + text[end:]
        else:
            lines = text.split("\n")
            i, j = (int(k) for k in random.integers(len(lines), size=2))
            if kind == 4:
                lines[i], lines[j] = lines[j], lines[i]
            else:
                lines.insert(i, lines[j])
            text = "\n".join(lines)
    return text


@pytest.mark.parametrize(
    "name", ["thesis-6.1", "performance-yamazaki", "performance-procyk-mamdani", "", "pages"]
)
def test_damaged_text_gives_a_located_diagnostic_or_a_table(name):
    shipped = RULEBASES / f"{name}.lut"
    text = {"": TEXT, "pages": PAGES}.get(name) or shipped.read_text("utf-8")
    random = np.random.default_rng(7)
    refused = 0
    for _ in range(250):
        wounded = damaged(text, random)
        parsed = parse_lut(wounded, "wounded.lut")
        lines = wounded.replace("\r\n", "\n").replace("\r", "\n").split("\n")
        if parsed.table is None:
            refused += 1
            assert any(d.is_error for d in parsed.diagnostics)
        else:
            assert LookupTable.from_plain(parsed.table).values.size > 0
        for finding in parsed.diagnostics:
            assert 1 <= finding.line <= len(lines)
            assert 1 <= finding.column <= len(lines[finding.line - 1]) + 1
    assert refused > 100


@pytest.mark.parametrize("noise", [b"", b"\x00" * 99, bytes(range(256)) * 4, b"\xef\xbb\xbf", b"#"])
def test_noise(noise):
    parsed = parse_table(noise, "noise.lut")
    assert parsed.table is None
    assert parsed.diagnostics
