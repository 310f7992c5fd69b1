"""Samples from files, frames and arrays, and what is said of damaged ones."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm.learning.data import (
    ColumnError,
    Columns,
    DataError,
    as_samples,
    folds,
    frame_samples,
    function_samples,
    parse_csv,
    read_samples,
    rulebase_samples,
    table_samples,
)


def findings(text, columns=None):
    with pytest.raises(DataError) as caught:
        parse_csv(text, "d.csv", columns or Columns())
    return [(each.name, each.line, each.column) for each in caught.value.diagnostics]


def test_a_line_of_names_and_the_last_column_is_the_target():
    samples = parse_csv("a,b,y\n1,2,3\n4,5,6\n")
    assert (samples.names, samples.target) == (("a", "b"), "y")
    assert samples.inputs.tolist() == [[1.0, 2.0], [4.0, 5.0]]
    assert samples.values.tolist() == [3.0, 6.0]


def test_columns_may_be_chosen():
    samples = parse_csv("time,a,y,b\nnoon,1,2,3\n", columns=Columns("a", ("b",)))
    assert (samples.names, samples.values.tolist()) == (("b",), [1.0])


def test_without_names_the_columns_are_called_x1_to_y():
    samples = parse_csv("1,2,3\n4,5,6\n")
    assert samples.names == ("x1", "x2")
    assert "no line of names" in samples.notes[0]


@pytest.mark.parametrize(
    "text",
    ["a;y\n1,5;2,25\n", "a\ty\n1.5\t2.25\n", "a y\n 1.5   2.25\n", "# c\n\na,y\n1.5,2.25\n"],
)
def test_other_marks_between_cells(text):
    samples = parse_csv(text)
    assert (samples.inputs[0, 0], samples.values[0]) == (1.5, 2.25)


def test_a_target_of_words_has_classes():
    samples = parse_csv("a,kind\n1,red\n2,blue\n3,red\n")
    assert samples.classes == ("blue", "red")
    assert samples.outputs.tolist() == [[0.0, 1.0], [1.0, 0.0], [0.0, 1.0]]


def test_every_fault_is_found_where_it_is():
    assert findings("a,b,y\n1,2,3\n4,x,6\n7,8,\n9,inf,1\n") == [
        ("not-a-number", 3, 3),
        ("missing-value", 4, 5),
        ("not-a-number", 5, 3),
    ]
    assert findings("a,b,y\n1,2,3\n4,5\n") == [("wrong-cell-count", 3, 1)]
    assert findings("a,b,y\n,2,3\nx,5\n4,5,6,7\n1,y,2\n") == [
        ("missing-value", 2, 1),
        ("wrong-cell-count", 3, 1),
        ("wrong-cell-count", 4, 1),
        ("not-a-number", 5, 3),
    ]
    assert findings("a,a,y\n1,2,3\n")[0][0] == "duplicate-column"
    assert findings("y\n1\n")[0][0] == "no-inputs"
    assert findings("a,y\n")[0][0] == "no-samples"
    assert findings("")[0][0] == "no-samples"
    assert findings("a,y\n1,1e60\n")[0][0] == "too-large"
    wide = ",".join(f"a{k}" for k in range(40))
    assert findings(f"{wide}\n{','.join('1' * 40)}\n")[0][0] == "too-many-inputs"
    with pytest.raises(ColumnError, match="there is no column 'z'"):
        parse_csv("a,y\n1,2\n", columns=Columns("z"))


def test_a_file_of_bytes_is_refused_with_its_line(tmp_path):
    path = tmp_path / "d.csv"
    path.write_bytes(b"a,y\n1,2\n\xff,3\n")
    with pytest.raises(ValueError, match="not UTF-8: byte 0xff"):
        read_samples(path)


@given(
    st.lists(st.tuples(*[st.floats(-1e6, 1e6, allow_nan=False)] * 3), min_size=1, max_size=20),
    st.sampled_from([",", "\t"]),
)
def test_what_csv_writes_is_read(rows, mark):
    out = io.StringIO()
    writer = csv.writer(out, delimiter=mark)
    writer.writerow(["first one", "b", 'the "y"'])
    writer.writerows(rows)
    samples = parse_csv(out.getvalue())
    assert samples.names == ("first one", "b")
    assert np.column_stack([samples.inputs, samples.values]).tolist() == [list(r) for r in rows]


@given(st.text(alphabet='a1,;\t "\n.x-', max_size=60))
def test_no_text_breaks_the_reader(text):
    try:
        samples = parse_csv(text)
    except (DataError, ColumnError):
        return
    assert np.isfinite(samples.inputs).all()


def test_frames_and_parquet(tmp_path):
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"a": [1, 2], "b": [True, False], "y": [0.1, 0.2]})
    samples = frame_samples(frame)
    assert samples.inputs.tolist() == [[1.0, 1.0], [2.0, 0.0]]
    pytest.importorskip("pyarrow")
    path = tmp_path / "d.parquet"
    frame.to_parquet(path)
    assert read_samples(path, Columns("a")).values.tolist() == [1.0, 2.0]
    path.write_bytes(b"nothing")
    with pytest.raises(DataError, match="not a Parquet file"):
        read_samples(path)
    with pytest.raises(DataError, match="no value of 'a' in sample 2"):
        frame_samples(pandas.DataFrame({"a": [1.0, None], "y": [1.0, 2.0]}))


def test_arrays_are_checked():
    assert as_samples([1, 2], [3, 4]).names == ("x1",)
    with pytest.raises(DataError, match="'x1' is not a finite number in sample 2"):
        as_samples([[1.0], [np.nan]], [1.0, 2.0])
    with pytest.raises(DataError, match="one row of inputs for each value"):
        as_samples([[1.0]], [1.0, 2.0])


def test_tables_rule_bases_and_functions_are_sampled():
    from fuzzyarm import load, shipped

    table = load(shipped("thesis-6.1.lut"))
    samples = table_samples(table)
    assert len(samples) == table.values.size
    k = 17
    where = dict(zip(samples.names, samples.inputs[k], strict=True))
    assert table.lookup(**where, mode="nearest") == samples.values[k]
    few = rulebase_samples(load(shipped("pd7.frb")), count=64)
    assert (few.names, few.target, len(few)) == (("e", "ce"), "u", 64)
    plane = function_samples(lambda a, b: a + 2 * b, {"a": (0, 1), "b": (-1, 1)}, 32)
    assert np.allclose(plane.values, plane.inputs @ [1.0, 2.0])


@given(st.integers(2, 60), st.integers(2, 8), st.booleans())
def test_folds_cover_everything_once(count, parts, series):
    tests = []
    for train, test in folds(count, parts, series=series, seed=1):
        assert not set(train) & set(test)
        assert len(train) + len(test) == count
        if series and len(test):
            assert (np.diff(test) == 1).all()
        tests += test.tolist()
    assert sorted(tests) == list(range(count))
