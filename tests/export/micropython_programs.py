"""MicroPython: the port of a shell where there is one, else that for WebAssembly in node.

``MICROPYTHON_MODULE`` names the module ``micropython.mjs`` of npm's
``@micropython/micropython-webassembly-pyscript``; else that of
`npm install --global` is taken.
Both have floats of 64 bits.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from functools import cache
from pathlib import Path

import pytest
from needs import lacking

_PACKAGE = "@micropython/micropython-webassembly-pyscript/micropython.mjs"

_RUN = """import { readFileSync } from "node:fs";
const { loadMicroPython } = await import(process.argv[2]);
const machine = await loadMicroPython({ stdout: (line) => console.log(line), heapsize: 8 << 20 });
machine.FS.mkdir("/modules");
machine.FS.writeFile("/modules/made.py", readFileSync(process.argv[3]));
const beside = "import sys\\nsys.path.append('/modules')\\n";
machine.runPython(beside + readFileSync(process.argv[4], "utf8"));
"""


@cache
def _module() -> str | None:
    named = os.environ.get("MICROPYTHON_MODULE")
    if named:
        return named if Path(named).is_file() else None
    if shutil.which("npm") is None or shutil.which("node") is None:
        return None
    words = ["npm", "root", "--global"]
    root = subprocess.run(words, capture_output=True, text=True, check=False).stdout.strip()
    path = Path(root) / _PACKAGE
    return str(path) if path.is_file() else None


def run_micropython(module: Path, script: str, folder: Path) -> str:
    """Return what a script prints beside a module that it imports as ``made``."""
    (folder / "script.py").write_text(script)
    if shutil.which("micropython") is not None:
        (folder / "made.py").write_bytes(module.read_bytes())
        words = ["micropython", "script.py"]
    elif _module() is not None:
        (folder / "run.mjs").write_text(_RUN)
        words = ["node", "run.mjs", _module(), str(module), "script.py"]
    else:
        pytest.skip(lacking("micropython"))
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-600:]
    return done.stdout
