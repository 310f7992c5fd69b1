"""Exported C, compiled and run over arrays: the other side of every comparison here."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from pathlib import Path

import needs
import numpy as np

from fuzzyarm.exchange.export import export_files
from fuzzyarm.exchange.export.numbers import C_TYPES

STRICT = [
    "-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Wpedantic", "-Werror",
    "-Wfloat-conversion", "-Wdouble-promotion", "-Wshadow",
]  # fmt: skip
SANITIZED = ["-fsanitize=undefined,address", "-fno-sanitize-recover=all"]

HOST, ARM = needs.program("C compiler") or "cc", "arm-linux-gnueabihf-gcc"


def need(target: str) -> None:
    """Skip where a compiler (and, for another machine, its emulator) is missing."""
    names = {HOST: ("C compiler",), "gcc": ("C compiler",), ARM: (ARM, "qemu-arm")}
    needs.need(*names.get(target, (target,)))


def compile_c(
    sources: Sequence[str | Path], program: Path, target: str = HOST, *flags: str
) -> None:
    """Compile without any warning; fail with what the compiler says."""
    need(target)
    extra = ["-static"] if target == ARM else SANITIZED
    words = [target, *STRICT, "-O1", *extra, *flags, *map(str, sources), "-o", str(program), "-lm"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def execute(program: Path, target: str = HOST, *words: str) -> int:
    """Run a program, by the emulator where it is for another machine."""
    command = ["qemu-arm", str(program)] if target == ARM else [str(program)]
    done = subprocess.run([*command, *words], capture_output=True, text=True, check=False)
    assert done.stderr == ""
    return done.returncode


def _loop(name: str, kind: str, arguments: int, count: int) -> str:
    listed = ", ".join(f"row[{i}]" for i in range(arguments))
    return f"""
    for (long k = 0; k < {count}L; k++) {{
        {kind} row[{arguments}], result;
        if (fread(row, sizeof row, 1, points) != 1) {{
            return 1;
        }}
        result = {name}({listed});
        if (fwrite(&result, sizeof result, 1, results) != 1) {{
            return 1;
        }}
    }}
"""


def run_c(routines, columns, folder: Path, target: str = HOST, suffix: str = ".h"):
    """Return what the exported functions give, one array for each routine.

    `columns` has, for each routine, one array of points for each argument.
    """
    exported = export_files(routines, folder / f"made{suffix}")
    for path, text in exported.files:
        path.write_text(text, "utf-8")
    names = function_names(exported.files[-1][1])
    data, loops = b"", ""
    for routine, name, arrays in zip(routines, names, columns, strict=True):
        rows = np.stack([np.asarray(x).astype(routine.kind) for x in arrays], axis=1)
        data += rows.tobytes()
        loops += _loop(name, C_TYPES[routine.kind], rows.shape[1], rows.shape[0])
    (folder / "points.bin").write_bytes(data)
    driver = folder / "driver.c"
    driver.write_text(
        '#include "made.h"\n#include <stdio.h>\n'
        "int main(int argc, char **argv)\n{\n"
        "    FILE *points, *results;\n"
        "    if (argc != 3) {\n        return 2;\n    }\n"
        '    points = fopen(argv[1], "rb");\n    results = fopen(argv[2], "wb");\n'
        "    if (points == NULL || results == NULL) {\n        return 3;\n    }\n"
        f"{loops}    fclose(points);\n    return fclose(results);\n}}\n"
    )
    sources = [driver, *([folder / "made.c"] if suffix == ".c" else [])]
    compile_c(sources, folder / "program", target)
    files = (str(folder / "points.bin"), str(folder / "results.bin"))
    assert execute(folder / "program", target, *files) == 0
    found, data = [], (folder / "results.bin").read_bytes()
    for routine, arrays in zip(routines, columns, strict=True):
        dtype, count = np.dtype(routine.kind), len(arrays[0])
        found.append(np.frombuffer(data[: count * dtype.itemsize], dtype))
        data = data[count * dtype.itemsize :]
    return found


def function_names(header: str) -> list[str]:
    """Return the names of the functions as the comment at the head states them."""
    kinds = tuple(f" * {kind} " for kind in ("float", "double", "int16_t", "int8_t"))
    lines = [line for line in header.splitlines() if line.startswith(kinds) and "(" in line]
    return [line.split("(")[0].split()[-1] for line in lines]


def ulps(a, b):
    """Return how many single-precision numbers lie between two arrays of them."""
    whole = [np.asarray(x, np.float32).view(np.int32).astype(np.int64) for x in (a, b)]
    ordered = [np.where(x < 0, -(x & 0x7FFFFFFF), x) for x in whole]
    return np.abs(ordered[0] - ordered[1])


def spread(axis_points, count: int, seed: int = 1):
    """Return columns of `count` points: every combination that fits, then random ones."""
    random = np.random.default_rng(seed)
    mesh = np.meshgrid(*axis_points, indexing="ij")
    grid = [x.ravel() for x in mesh]
    if grid[0].size > count // 2:
        chosen = random.choice(grid[0].size, count // 2, replace=False)
        grid = [x[chosen] for x in grid]
    rest = count - grid[0].size
    columns = []
    for x, points in zip(grid, map(np.asarray, axis_points), strict=True):
        near = points[np.abs(points) < 1e20]
        between = random.uniform(near.min(), near.max(), rest).astype(points.dtype)
        columns.append(np.concatenate([x, between]))
    return columns
