"""The three published tables: spot values and known properties of the print."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fuzzyarm.table import read_table
from fuzzyarm.table.files import table_as

RULEBASES = Path(__file__).parents[2] / "rulebases"
EDGES = (0.1, 0.6, 1.2, 2.4, 3.6, 4.8)
NAMES = ["thesis-6.1", "performance-yamazaki", "performance-procyk-mamdani"]


@pytest.mark.parametrize("name", NAMES)
def test_axes_and_canonical_text(name):
    path = RULEBASES / f"{name}.lut"
    table = read_table(path)
    assert table.names == ("e", "ce")
    for axis in table.axes:
        assert axis.levels == tuple(range(-6, 7))
        assert axis.bins == tuple(sorted((*EDGES, *(-x for x in EDGES))))
    assert np.abs(table.values).max() <= 6
    assert table.provenance
    assert table_as(table, ".lut") == path.read_text("utf-8")


@pytest.mark.parametrize(
    ("name", "e", "ce", "value"),
    [
        ("thesis-6.1", -6, -6, -5.6),
        ("thesis-6.1", -6, 6, -4.2),
        ("thesis-6.1", 6, -6, 4.4),
        ("thesis-6.1", -2, 0, -2.3),
        ("thesis-6.1", 0, -2, 0.6),
        ("thesis-6.1", 1, 3, 0.0),
        ("performance-yamazaki", 1, -6, -3),
        ("performance-yamazaki", -6, 1, -5),
        ("performance-procyk-mamdani", 3, -2, 2),
        ("performance-procyk-mamdani", -2, 3, 0),
        ("performance-procyk-mamdani", 5, -1, 3),
    ],
)
def test_cells_as_printed(name, e, ce, value):
    table = read_table(RULEBASES / f"{name}.lut")
    assert table.lookup(e, ce, mode="nearest") == value


def test_bins_as_the_controller_uses_them():
    table = read_table(RULEBASES / "thesis-6.1.lut")
    assert table.lookup(0.05, -0.1) == table.values[6, 5]  # an edge belongs to the lower cell
    assert table.lookup(0.1, 0.11) == table.values[6, 7]
    assert table.lookup(99, -99) == 4.4
