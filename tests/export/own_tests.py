"""The self-tests of exported files, run: many of one language in one process."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator, Sequence
from functools import cached_property
from pathlib import Path

import c_programs
import numpy as np
import pytest
from c_programs import HOST
from needs import need
from scl_reader import Reader
from st_programs import Program

from fuzzyarm.exchange.export import controllers
from fuzzyarm.exchange.export.controllers import ControllerProgram, Tried


def failing_in_python(paths: Sequence[Path], folder: Path) -> list[str]:
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
    c_programs.need(HOST)
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


def failing_in_javascript(paths: Sequence[Path], folder: Path) -> list[str]:
    """Return modules whose test does not return 0; all in one process."""
    need("node")
    lines = []
    for number, path in enumerate(paths):
        lines.append(f'import {{ selfTest as test{number} }} from "{path}";')
    for number, path in enumerate(paths):
        lines.append(f'if (test{number}() !== 0) console.log("{path.stem}");')
    script = folder / "all_tests.mjs"
    script.write_text("\n".join(lines))
    done = subprocess.run(["node", str(script)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout.split()


def failing_in_rust(paths: Sequence[Path], folder: Path, *, core_alone: bool = False) -> list[str]:
    """Return crates whose test does not return 0; all in one program, as modules of it.

    With `core_alone` they are modules of a crate without `std`, which is only compiled.
    """
    need("rustc")
    lines = ["#![allow(warnings)]"]
    if core_alone:
        lines.insert(0, "#![no_std]")
    lines += [f'#[path = "{path}"] mod m{number};' for number, path in enumerate(paths)]
    tests = [
        f'    if m{number}::self_test() != 0 {{ println!("{path.stem}"); }}'
        for number, path in enumerate(paths)
    ]
    lines += [] if core_alone else ["fn main() {", *tests, "}"]
    source = folder / "all_tests.rs"
    source.write_text("\n".join(lines))
    kind = ["--crate-type", "lib"] if core_alone else []
    words = ["rustc", *kind, str(source), "-o", str(folder / "all_tests_rs")]
    built = subprocess.run(words, capture_output=True, text=True, check=False, cwd=folder)
    assert built.returncode == 0, built.stderr[:3000]
    if core_alone:
        return []
    run = subprocess.run([folder / "all_tests_rs"], capture_output=True, text=True, check=True)
    return run.stdout.split()


def failing_in_scl(paths: Sequence[Path], folder: Path) -> list[str]:
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


LANGUAGES = {
    ".py": failing_in_python, ".h": failing_in_c, ".scl": failing_in_scl,
    ".mjs": failing_in_javascript, ".rs": failing_in_rust,
}  # fmt: skip
"""How the self-tests of files are run, by their suffix: what every language goes through.

Last those that need tools: where there are none, the others have been looked at.
"""


@pytest.fixture(scope="module")
def tried_once() -> Iterator[None]:
    """Try a controller once for all languages: its sequence depends on none."""
    known: dict[tuple[object, ...], Tried] = {}
    tried = ControllerProgram.tried.func

    def once(program: ControllerProgram) -> Tried:
        wide = program.widened and program.precision != "float64"
        key = program.text.path, program.precision, program.q, wide, controllers.PERIODS
        if key not in known:
            known[key] = tried(program)
        return known[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ControllerProgram, "tried", cached_property(once))
        ControllerProgram.tried.__set_name__(ControllerProgram, "tried")
        yield


def failing(paths: Sequence[Path], folder: Path) -> list[str]:
    """Return the files whose own test does not pass; a folder for what that takes."""
    (suffix,) = {path.suffix for path in paths}
    return LANGUAGES[suffix](paths, folder)
