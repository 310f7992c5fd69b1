"""Rule bases as modules of JavaScript and Rust, made and run for tests."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from pathlib import Path

from needs import need

from fuzzyarm.exchange.export import routines_of
from fuzzyarm.exchange.export.languages import MODULES
from fuzzyarm.exchange.export.write import routines_module
from fuzzyarm.language.model.rulebase import RuleBase


def javascript_of(rulebase: RuleBase) -> str:
    """Return the rules of all outputs as a module."""
    routines = routines_of(rulebase, precision="float64")
    return routines_module(routines, MODULES[".mjs"], "rules")[0]


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
