from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import tracemalloc
import zipfile
from dataclasses import MISSING, fields

import numpy as np
import pytest
from budget import cases
from hypothesis import HealthCheck, Phase, find, given, settings
from table_strategies import tables

from fuzzyarm.exchange.files import check_file
from fuzzyarm.table import (
    Axis,
    LookupTable,
    TableError,
    TableFileError,
    files,
    read_table,
    write_table,
)
from fuzzyarm.table.files import parse_table, table_as

ASYMMETRIC = LookupTable(
    (Axis("e", (-1, 0, 2)), Axis("ce", (0, 10, 20, 40))),
    "u",
    [[1, 2, 3, 4], [5, 6, 7, 8], [9, 10, 11, 12]],
)


@pytest.mark.parametrize("suffix", [".lut", ".csv", ".json", ".npz"])
@given(table=tables())
@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
    deadline=None,
    max_examples=cases(20, 120),
)
def test_every_format_reads_back_an_identical_table(tmp_path_factory, suffix, table):
    path = tmp_path_factory.mktemp("t") / f"table{suffix}"
    write_table(table, path)
    back = read_table(path)
    assert back == table
    assert np.array_equal(np.signbit(back.values), np.signbit(table.values))
    assert back.axes == table.axes
    assert back.provenance == table.provenance


@pytest.mark.parametrize(
    ("name", "default"),
    [(each.name, each.default) for each in fields(LookupTable) if each.default is not MISSING],
)
def test_every_setting_of_a_table_is_drawn(name, default):
    drawn = settings(database=None, deadline=None, phases=[Phase.generate])
    find(tables(), lambda table: getattr(table, name) != default, settings=drawn)


@pytest.mark.parametrize("suffix", [".lut", ".csv", ".json", ".npz"])
def test_writing_twice_gives_the_same_bytes(tmp_path, suffix):
    for name in ("a", "b"):
        write_table(ASYMMETRIC, tmp_path / f"{name}{suffix}")
    assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()


def test_the_row_in_the_text_formats_is_the_first_input():
    assert table_as(ASYMMETRIC, ".lut").splitlines()[-1].split() == ["2", "9", "10", "11", "12"]
    assert table_as(ASYMMETRIC, ".csv").splitlines()[-1] == "2,9,10,11,12"
    data = json.loads(table_as(ASYMMETRIC, ".json"))
    assert data["index"] == ["e", "ce"]
    assert data["values"][2] == [9, 10, 11, 12]


def test_other_programs_read_the_csv(tmp_path):
    path = tmp_path / "table.csv"
    write_table(ASYMMETRIC, path)
    grid = np.genfromtxt(path, delimiter=",", comments="#", skip_header=0)[1:]
    np.testing.assert_array_equal(grid[:, 0], [-1, 0, 2])
    np.testing.assert_array_equal(grid[:, 1:], ASYMMETRIC.values)


def test_other_programs_read_the_npz(tmp_path):
    path = tmp_path / "table.npz"
    write_table(ASYMMETRIC, path)
    with np.load(path) as archive:
        np.testing.assert_array_equal(archive["values"], ASYMMETRIC.values)
        np.testing.assert_array_equal(archive["levels_1"], [0, 10, 20, 40])


@pytest.mark.parametrize("character", [0x110000, 0xFFFFFFFF, 0xD800])
def test_an_npz_whose_text_is_not_text_is_refused(tmp_path, character):
    path = tmp_path / "table.npz"
    write_table(ASYMMETRIC, path)
    with np.load(path) as archive:
        arrays = dict(archive)
    code_points = np.frombuffer(arrays["header"].tobytes(), np.uint32).copy()
    code_points[len(code_points) // 2] = character
    header = np.frombuffer(code_points.tobytes(), arrays["header"].dtype)[0:1].reshape(())
    np.savez(path, **{**arrays, "header": header})
    with pytest.raises(TableFileError, match="UnicodeDecodeError"):
        read_table(path)


def test_an_archive_that_unpacks_to_too_much_is_refused_unread(tmp_path, monkeypatch):
    monkeypatch.setattr(files, "MOST_BYTES", 1 << 20)
    path = tmp_path / "table.npz"
    write_table(ASYMMETRIC, path)
    assert read_table(path) == ASYMMETRIC
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("more.npy", bytes(1 << 24))
    assert path.stat().st_size < 1 << 16
    tracemalloc.start()
    try:
        with pytest.raises(TableFileError, match=r"unpacked, the archive has 16,7.* 1,048,576"):
            read_table(path)
        assert tracemalloc.get_traced_memory()[1] < 1 << 20
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("suffix", [".csv", ".json", ".lut"])
def test_a_text_that_is_too_long_is_not_read(suffix, monkeypatch):
    monkeypatch.setattr(files, "MAX_CHARACTERS", 100)
    parsed = parse_table(table_as(ASYMMETRIC, suffix).encode(), f"t{suffix}")
    assert [d.name for d in parsed.diagnostics] == ["too-large"]


def test_pages_that_are_promised_and_missing_are_not_gone_through():
    text = (
        "# fuzzyarm-table 1\n# output u\n# index page a, page b, page c, row d, column e\n"
        "# levels a, b, c: 0 .. 99999 count 100000\n# levels d, e: 0 1\n"
        "a,b,c,d \\ e,0,1\n3,2,1,0,5,6\n3,2,1,1,7,8\n3,nan,1,0,5,6\n3,0.5,1,0,5,6\n"
    )
    parsed = parse_table(text.encode(), "t.csv")
    found = {(d.name, d.span.line) for d in parsed.diagnostics}
    assert {("wrong-label", 9), ("wrong-label", 10)} < found
    (missing,) = (d for d in parsed.diagnostics if d.name == "missing-grid")
    assert missing.message == "there is no 'grid when a = 0, b = 0, c = 0' and 999999999999998 more"


def test_an_unknown_suffix_is_refused_before_anything_is_written(tmp_path):
    for act in (lambda p: write_table(ASYMMETRIC, p), read_table):
        with pytest.raises(TableError, match=r"no suffix of a table .*\.lut"):
            act(tmp_path / "table.xls")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("old", "new", "name"),
    [
        ('"index": [\n  "e",\n  "ce"\n ]', '"index": ["ce", "e"]', "bad-table"),
        ('"fuzzyarm-table"', '"something"', "bad-table"),
        ('"version": 1', '"version": 7', "bad-table"),
        ('"values"', '"valeus"', "missing-key"),
        ("9.0", "NaN", "bad-json"),
        ("9.0", '"9"', "bad-table"),
        ("9.0,", "", "bad-table"),
        ("9.0,", "9.0,,", "bad-json"),
    ],
)
def test_a_damaged_json_is_diagnosed(old, new, name):
    text = table_as(ASYMMETRIC, ".json")
    assert old in text
    parsed = parse_table(text.replace(old, new, 1).encode(), "t.json")
    assert parsed.table is None
    assert [d.name for d in parsed.diagnostics] == [name]


@pytest.mark.parametrize(
    ("old", "new", "name"),
    [
        ("2,9,10,11,12\n", "", "missing-row"),
        ("2,9,10,11,12", "2,9,10,11", "wrong-cell-count"),
        ("2,9,10,11,12", "3,9,10,11,12", "wrong-label"),
        ("2,9,10,11,12", "2,9,ten,11,12", "not-a-number"),
        ("2,9,10,11,12", "2,9,10,11,12#3", "not-a-number"),
        ("2,9,10,11,12", '" #2",9,10,11,12', "not-a-number"),
        ("2,9,10,11,12", "2,9,,11,12", "not-a-number"),
        ("e \\ ce,0", "ce \\ e,0", "transposed-labels"),
        ("index   row e, column ce", "", "missing-index-order"),
        ("# fuzzyarm-table 1", "", "missing-format"),
    ],
)
def test_a_damaged_csv_is_diagnosed_at_its_line(old, new, name):
    text = table_as(ASYMMETRIC, ".csv")
    assert old in text
    parsed = parse_table(text.replace(old, new, 1).encode(), "t.csv")
    assert parsed.table is None
    assert name in [d.name for d in parsed.diagnostics]


def test_a_row_of_a_csv_that_begins_like_a_comment_is_diagnosed():
    table = LookupTable((Axis("t", (0, 1)),), "u", [5, 6])
    text = table_as(table, ".csv").replace("u,5,6", '" #u",5,6')
    parsed = parse_table(text.encode(), "t.csv")
    assert parsed.table is None
    assert {d.name for d in parsed.diagnostics} == {"not-a-number", "wrong-label"}


@pytest.mark.parametrize("suffix", [".csv", ".json", ".npz", ".lut"])
def test_damage_never_raises_anything_but_a_file_error(tmp_path, suffix):
    path = tmp_path / f"table{suffix}"
    write_table(ASYMMETRIC, path)
    sound = path.read_bytes()
    random = np.random.default_rng(3)
    outcomes = set()
    for _ in range(150):
        data = bytearray(sound)
        for _ in range(random.integers(1, 4)):
            data[random.integers(len(data))] = random.integers(256)
        if random.random() < 0.2:
            data = data[: random.integers(len(data))]
        path.write_bytes(bytes(data))
        if suffix == ".npz" or parse_table(bytes(data), str(path)).table is None:
            with contextlib.suppress(TableFileError):
                read_table(path)
            outcomes.add("refused")
    assert "refused" in outcomes


def test_reading_the_text_needs_no_array_library():
    code = (
        "import sys; from fuzzyarm.table import parse_lut; parse_lut('fuzzyarm-table 1');"
        "sys.exit('numpy' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], env=os.environ, check=False).returncode == 0


@pytest.mark.slow
def test_an_archive_that_unpacks_to_more_than_any_table_is_refused_before_it_is(tmp_path):
    """Zeros deflate to a thousandth: the archive says how large they are before they are read."""
    import tracemalloc
    import zipfile

    path = tmp_path / "bomb.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("header.npy", b"\x93NUMPY")
        with archive.open("values.npy", "w", force_zip64=True) as member:
            for _ in range(400):
                member.write(bytes(1_000_000))
    tracemalloc.start()
    with pytest.raises(TableFileError, match="400,000,006 bytes; at most"):
        read_table(str(path))
    assert tracemalloc.get_traced_memory()[1] < 20_000_000
    tracemalloc.stop()


def square(count):
    levels = tuple(range(count))
    axes = Axis("x", levels), Axis("y", levels)
    return LookupTable(axes, "z", np.full((count, count), -0.123456789012))


@pytest.mark.parametrize("suffix", [".lut", ".csv", ".json", ".tex"])
def test_a_table_of_more_cells_than_are_read_is_not_written_as_text(tmp_path, suffix):
    path = tmp_path / f"t{suffix}"
    with pytest.raises(TableError, match=r"1,002,001 cells are not written as .*1,000,000") as told:
        write_table(square(1001), path)
    assert told.value.hint == "an .npz takes any table"
    assert not path.exists()


@pytest.mark.slow
def test_the_largest_table_that_is_written_as_text_is_checked_and_read(tmp_path):
    path = tmp_path / "t.lut"
    write_table(square(1000), path)
    assert path.stat().st_size > 16_000_000
    assert check_file(path).diagnostics == ()
    assert np.array_equal(read_table(path).values, square(1000).values)
