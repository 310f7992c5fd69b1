"""Builds of the package within tests: with the machine code that is there, not compiled again."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

from budget import cases


def compiler_at_hand(folder: Path) -> dict[str, str]:
    """Return variables by which a build of this checkout takes the module that runs here.

    It is made of the same sources (tests/conftest.py), and takes some 20 s of a processor. What
    stands in for the compiler gives empty objects, and that module where they are linked. With
    ``--thorough``, or where there is none, there are no variables: the compiler is the real one.
    """
    spec = importlib.util.find_spec("fuzzyarm._kernels")
    if cases(0, 1) or spec is None or spec.origin is None:
        return {}
    program = folder / "compiler-at-hand"
    program.write_text(
        f"#!{sys.executable}\nimport shutil, sys\nresult = sys.argv[sys.argv.index('-o') + 1]\n"
        f"source = {spec.origin!r} if '-shared' in sys.argv else {__file__!r}\n"
        "shutil.copy(source, result)\n"
    )
    program.chmod(0o755)
    return {"CC": str(program)}
