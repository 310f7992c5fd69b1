"""The published figures as data, and finding rows."""

import pytest

from fuzzyarm.apps.study import UnknownRowError, find_rows, published_rows


def test_every_row_of_every_table_is_there():
    rows = published_rows()
    assert len(rows) == 41
    assert len({row.identifier for row in rows}) == 41
    tables = [row.table for row in rows]
    assert tables.count("7.1.1") == 26
    assert tables.count("4.2.5.1") == 5


def test_a_row_is_read_as_printed():
    (row,) = find_rows(["7.1.1/ct"])
    assert row.figures == (6.1340, 8.5617, 4.6260, -4.7008, 4.9007, 12.2731, 4.4288, 5.0733)
    assert row.trajectories == ("reach-return", "pick-and-place")
    assert row.payload
    assert row.condition == "payload"
    (row,) = find_rows(["4.2.5.2/ffid"])
    assert row.model_mass == 1.8
    assert row.condition == "no payload, model masses 1.8 kg"


@pytest.mark.parametrize(
    ("names", "count"),
    [
        ([], 41),
        (["7.1.1"], 26),
        (["cdid"], 3),
        (["CDID"], 3),
        (["Pure Fuzzy x10"], 1),
        (["mrac+ie", "5.5.1"], 3),
        (["7.1.1/cdid+fuzzy"], 1),
    ],
)
def test_rows_are_found_by_table_controller_label_or_both(names, count):
    assert len(find_rows(names)) == count


def test_unknown_row_suggests_a_near_one():
    with pytest.raises(UnknownRowError, match="'cdid") as caught:
        find_rows(["cdidd"])
    assert caught.value.name == "cdidd"
