"""Damage tables of every format; whatever the bytes, they are read or refused with a place.

    python tests/fuzz/damaged_tables.py --seed 1 --count 20000

What is still a table is looked up in every way at points and over arrays, written in every
format and read again.
"""

from __future__ import annotations

import io
import random
import sys
import zipfile
from functools import cache
from itertools import pairwise
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests"), str(ROOT / "tests" / "fuzz")]

import numpy as np  # noqa: E402
from fuzzing import Told, demand_whole_files, folder, run  # noqa: E402

from fuzzyarm.base.diagnostic import Diagnostic  # noqa: E402
from fuzzyarm.table import LookupTable, read_table, write_table  # noqa: E402
from fuzzyarm.table.files import SUFFIXES, TableFileError, table_as  # noqa: E402
from tests.formats.mutation import mutated  # noqa: E402

MADE = """fuzzyarm-table 1
input load 0 .. 5
output u -9 .. 9 "control, V"
index page load, row e, column ce
levels load: 0 1
levels e: -1 0.5 1
levels ce: 0 5 9 20
bins e: -0.25 0.75
round 0.1
mode bins
origin source "my.frb"
grid when load = 1
  e \\ ce  0 5 9 20
  -1 7 8 9 1
  0.5 4 5 6 2
  1 10 11 12 3
grid when load = 0
  e \\ ce  0 5 9 20
  -1 1 2 3 4
  0.5 -0.1 -2e-1 3 4
  1 4 5 6 7
"""


@cache
def originals() -> dict[str, list[bytes]]:
    """Return files by suffix."""
    paths = sorted((ROOT / "rulebases").glob("*.lut"))
    tables, texts = [], [MADE, *(path.read_text(encoding="utf-8") for path in paths)]
    with folder() as home:
        for text in texts:
            (home / "x.lut").write_text(text)
            tables.append(read_table(home / "x.lut"))
    found = {".lut": [text.encode() for text in texts]}
    for suffix in (".lut", ".csv", ".json", ".npz"):
        written = [table_as(table, suffix) for table in tables]
        found.setdefault(suffix, []).extend(
            each.encode() if isinstance(each, str) else each for each in written
        )
    return found


def damaged(data: bytes, suffix: str, r: random.Random) -> bytes:
    """Damage a text by words, an archive by bytes, or a member of an archive."""
    if suffix != ".npz":
        others = [each.decode() for each in originals()[suffix]]
        text = mutated(data.decode(), others, r)
        whole = text.encode("utf-8", "surrogatepass")
        return bytes_changed(whole, r) if r.random() < 0.1 else whole
    if r.random() < 0.5:
        return bytes_changed(data, r)
    made = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(made, "w") as new:
        names = old.namelist()
        chosen = r.choice(names)
        for name in names:
            content = old.read(name)
            if name == chosen:
                if r.random() < 0.2:
                    continue
                content = bytes_changed(content, r)
            new.writestr(name, content)
    return made.getvalue()


def bytes_changed(data: bytes, r: random.Random) -> bytes:
    """Cut, repeat or change some bytes."""
    changed = bytearray(data)
    for _ in range(r.choice((1, 1, 2, 5, 20))):
        if not changed:
            break
        at = r.randrange(len(changed))
        match r.randrange(4):
            case 0:
                del changed[at : at + r.choice((1, 3, 50))]
            case 1:
                changed[at:at] = bytes(r.randrange(256) for _ in range(r.choice((1, 4))))
            case 2:
                changed[at] ^= 1 << r.randrange(8)
            case _:
                changed[at] = r.randrange(256)
    return bytes(changed)


def look_up(table: LookupTable, r: random.Random) -> None:
    """Compare every way of looking up at points with arrays and with the open mesh."""
    candidates = []
    for axis in table.axes:
        edges = [*axis.levels, *(axis.bins or ())]
        middles = [0.5 * (a + b) for a, b in pairwise(edges)]
        beside = [float(np.nextafter(x, r.choice((-1e300, 1e300)))) for x in edges]
        pool = [*edges, *middles, *beside, min(edges) - 1.0, max(edges) + 1.0]
        candidates.append([r.choice(pool) for _ in range(5)])
    for mode in ("bins", "nearest", "linear"):
        arrays = [np.array(column) for column in candidates]
        together = table.lookup(*arrays, mode=mode)
        for k in range(5):
            alone = table.lookup(*(column[k] for column in candidates), mode=mode)
            assert same_bits(alone, together[k]), (mode, [c[k] for c in candidates])
        if len(arrays) <= 3:
            mesh = table.lookup(*np.ix_(*arrays), mode=mode)
            at = tuple(r.randrange(5) for _ in arrays)
            alone = table.lookup(*(c[k] for c, k in zip(candidates, at, strict=True)), mode=mode)
            assert same_bits(alone, mesh[at]), (mode, at)


def same_bits(one: float, other: float) -> bool:
    """Whether two numbers are equal, or both are NaN."""
    return one == other or (np.isnan(one) and np.isnan(other))


def read(path: Path) -> LookupTable | None:
    """Return the table in a file; None where it is refused, as it has to be."""
    refused: tuple[Diagnostic, ...] = ()
    try:
        return read_table(path)
    except TableFileError as error:
        refused = error.diagnostics
    assert refused
    assert all(each.message and each.path == str(path) for each in refused)
    return None


def case(r: random.Random, told: Told) -> None:
    """Damage one table and go through everything that reads it."""
    suffix = r.choice((".lut", ".lut", ".csv", ".json", ".npz"))
    data = damaged(r.choice(originals()[suffix]), suffix, r)
    told.append(f"--- read as {suffix}\n{data!r}")
    with folder() as home:
        path = home / f"damaged{suffix}"
        path.write_bytes(data)
        if r.random() < 0.02:
            out = r.choice((*SUFFIXES, ".h", ".st", ".frb"))
            verb = ["convert"] if out == ".frb" else ["compile"]
            target = home / f"out{out}"
            where = [str(target)] if out == ".frb" else ["-o", str(target)]
            demand_whole_files([*verb, str(path), *where], target, full=r.random() < 0.3)
        table = read(path)
        if table is None:
            return
        look_up(table, r)
        other = r.choice(SUFFIXES)
        copy = home / f"copy{other}"
        write_table(table, copy)
        again = read_table(copy)
        assert again == table, (again, table)


if __name__ == "__main__":
    sys.exit(run(__doc__, case))
