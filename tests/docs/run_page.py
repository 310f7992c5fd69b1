"""Run what pages show: `python run_page.py`, with a line of JSON for each page on stdin.

A line has the steps, the folder and the file for the results; a line of status answers it. Each
page has a process of its own, forked from this one, which has imported what takes long: every
page, and every command of it, would otherwise import NumPy, numba and matplotlib anew.
"""

from __future__ import annotations

import contextlib
import doctest
import gc
import io
import json
import os
import shlex
import subprocess
import sys
import time
import traceback
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from pkgutil import walk_packages
from typing import Any


def run_command(words: list[str]) -> tuple[int, str, str]:
    """Return status, output and errors of ``fuzzyarm WORDS``."""
    from fuzzyarm.apps.cli import main

    streams = [io.TextIOWrapper(io.BytesIO(), "utf-8", write_through=True) for _ in range(2)]
    with contextlib.redirect_stdout(streams[0]), contextlib.redirect_stderr(streams[1]):
        status = main(words)
    out, err = (stream.buffer.getvalue().decode() for stream in streams)
    return status, out, err


def run_python(text: str) -> tuple[int, str, str]:
    """Run a block as a script of its own."""
    if any(find_spec(name) is None for name in imported(text)):
        return 0, "", ""  # an extra that is not installed
    out = io.StringIO()
    try:
        with contextlib.redirect_stdout(out):
            exec(compile(text, "<block>", "exec"), {"__name__": "__main__"})
    except SystemExit as stop:
        return int(stop.code or 0), out.getvalue(), ""
    except Exception:
        return 1, out.getvalue(), traceback.format_exc()
    return 0, out.getvalue(), ""


def imported(text: str) -> list[str]:
    """Return the packages that a block imports on lines of their own."""
    lines = [line.split() for line in text.splitlines() if line.startswith("import ")]
    return [words[1].partition(".")[0] for words in lines]


def run_session(text: str, names: dict[str, Any]) -> tuple[int, str, str]:
    """Run a session with prompts; what it shows is compared as doctest does."""
    parser, out = doctest.DocTestParser(), io.StringIO()
    runner = doctest.DocTestRunner(verbose=False, optionflags=doctest.ELLIPSIS)
    test = parser.get_doctest(text, names, "block", None, 0)
    failed = runner.run(test, out=out.write, clear_globs=False).failed
    names.update(test.globs)
    return int(failed > 0), "", out.getvalue()


HEAVY = ("numba", "scipy.optimize", "matplotlib.figure", "rich.console", "fuzzyarm.apps.cli.main")

NOT_LOADED = ("fuzzyarm.__main__", "fuzzyarm.apps.playground.arrays", "fuzzyarm.apps.estimators")
"""The command, what stands in for NumPy in a browser, and what an extra is needed for."""


def main() -> None:
    """Run each page that the standard input names."""
    if hasattr(os, "fork"):
        for name in (*HEAVY, *modules_of_fuzzyarm()):
            import_module(name)
        gc.collect()
        gc.freeze()  # what all pages share is not written to by a search for cycles
    for line in sys.stdin:
        steps, folder, target = json.loads(line)
        sys.stdout.write(f"{run_apart(steps, folder, target)}\n")
        sys.stdout.flush()


def modules_of_fuzzyarm() -> list[str]:
    """Return the names of all modules that a page may load."""
    import fuzzyarm

    found = (each.name for each in walk_packages(fuzzyarm.__path__, "fuzzyarm."))
    return [name for name in found if not name.startswith(NOT_LOADED)]


def run_apart(steps: list[list[str]], folder: str, target: str) -> int:
    """Run a page in a process of its own; return its exit status."""
    if not hasattr(os, "fork"):
        code = f"import run_page; run_page.run_page({steps!r}, {folder!r}, {target!r})"
        path = os.pathsep.join([os.path.dirname(__file__), os.environ.get("PYTHONPATH", "")])
        environment = {**os.environ, "PYTHONPATH": path}
        return subprocess.run([sys.executable, "-c", code], env=environment, check=False).returncode
    child = os.fork()
    if child:
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    status = 1
    try:
        os.dup2(2, 1)  # whatever writes past the streams of Python is no answer
        run_page(steps, folder, target)
        status = 0
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stderr.flush()
        os._exit(status)


def run_page(steps: list[list[str]], folder: str, target: str) -> None:
    """Run the steps of a page in a folder; write what came of each to a file."""
    os.chdir(folder)
    sys.path.insert(0, folder)
    session: dict[str, Any] = {"__name__": "__main__"}
    results = []
    for kind, text, path in steps:
        began = time.perf_counter()
        if kind == "file":
            Path(path).parent.mkdir(parents=True, exist_ok=True)
            Path(path).write_text(text, "utf-8")
            result = 0, "", ""
        elif kind == "command":
            result = run_command(shlex.split(text)[1:])
        elif kind == "session":
            result = run_session(text, session)
        else:
            result = run_python(text)
        results.append([*result, time.perf_counter() - began])
    Path(target).write_text(json.dumps(results), "utf-8")


if __name__ == "__main__":
    main()
