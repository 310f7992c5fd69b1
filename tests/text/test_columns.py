"""Columns of texts."""

from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm.base.columns import in_columns

words = st.text("ab.1", max_size=6)
tables = st.integers(1, 5).flatmap(
    lambda count: st.lists(st.tuples(*[words] * count), min_size=1, max_size=6)
)


@given(tables, st.sampled_from(["<", ">", "<>", "><"]))
def test_texts_of_a_column_stand_under_each_other(rows, sides):
    lines = in_columns(rows, sides, gap=" | ")
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for line, row in zip(lines, rows, strict=True):
        assert line == line.rstrip()
        cells = line.ljust(sum(widths) + 3 * len(widths) - 3)
        start = 0
        for k, (text, width) in enumerate(zip(row, widths, strict=True)):
            cell = cells[start : start + width]
            side = sides[min(k, len(sides) - 1)]
            assert cell == (text.rjust(width) if side == ">" else text.ljust(width))
            start += width + 3


def test_a_row_may_be_short_and_a_last_column_takes_no_room():
    assert in_columns([("a", "1", "rule"), ("b",), ("c", "22", "a long one")], "<>.") == [
        "a   1  rule",
        "b",
        "c  22  a long one",
    ]
    assert in_columns([], ">") == []
    assert in_columns([("x", "1")], "<>", least=(4, 3), indent="  ") == ["  x       1"]
