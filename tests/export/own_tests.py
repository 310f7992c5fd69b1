"""The self-tests of exported files, run: many of one language in one process."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from c_programs import HOST, need
from scl_reader import Reader
from st_programs import Program


def failing_in_python(paths: Sequence[Path]) -> list[str]:
    """Return modules whose test does not return 0, and why."""
    script = (
        "import sys, importlib, traceback\n"
        "sys.dont_write_bytecode = True\n"
        "for path in sys.argv[1:]:\n"
        "    folder, _, name = path.rpartition('/')\n"
        "    sys.path.insert(0, folder)\n"
        "    try:\n        found = importlib.import_module(name).self_test()\n"
        "    except Exception:\n        found = traceback.format_exc(limit=1)\n"
        "    if found != 0:\n        print(name, found)\n"
        "    sys.path.pop(0)\n"
    )
    words = [sys.executable, "-c", script, *(str(path.with_suffix("")) for path in paths)]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


def failing_in_c(paths: Sequence[Path], folder: Path) -> list[str]:
    """Return sources (headers alone) whose test does not return 0; all in one program."""
    need(HOST)
    lines = ["#include <stdio.h>", "#define FUZZYARM_SELF_TEST"]
    for number, path in enumerate(paths):
        lines += [f"#define main test_{number}", f'#include "{path}"', "#undef main"]
    lines += ["int main(void)", "{"]
    for number, path in enumerate(paths):
        lines += [f"    if (test_{number}() != 0) {{", f'        puts("{path.stem}");', "    }"]
    source = folder / "all_tests.c"
    source.write_text("\n".join([*lines, "    return 0;", "}", ""]))
    program = str(folder / "all_tests")
    words = [
        HOST,
        "-std=c99",
        "-O0",
        "-ffp-contract=off",
        "-Wall",
        "-Wextra",
        "-Wshadow",
        "-Werror",
    ]
    built = subprocess.run(
        [*words, str(source), "-o", program, "-lm"], capture_output=True, text=True, check=False
    )
    assert built.returncode == 0, built.stderr[:2000]
    return subprocess.run([program], capture_output=True, text=True, check=True).stdout.split()


def failing_in_scl(paths: Sequence[Path]) -> list[str]:
    """Return files of SCL whose test does not pass in the interpreter of the tests."""
    failing = []
    for path in paths:
        program = Program(Reader(path.read_text("utf-8")).text())
        test = program.instance(f"{path.stem}_test")
        with np.errstate(over="ignore", invalid="ignore"):  # a NaN is made by them
            test.run()
        if not test.values["passed"]:
            failing.append(path.stem)
    return failing
