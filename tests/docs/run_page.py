"""Run what a page shows, in one process for each page: `python run_page.py` with steps on stdin.

A page of ten commands would otherwise start Python, NumPy and numba ten times.
"""

from __future__ import annotations

import contextlib
import doctest
import io
import json
import os
import shlex
import sys
import time
import traceback
from importlib.util import find_spec
from pathlib import Path
from typing import Any


def run_command(words: list[str]) -> tuple[int, str, str]:
    """Return status, output and errors of ``fuzzyarm WORDS``."""
    from fuzzyarm.cli import main

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


def main() -> None:
    """Run the steps on the standard input; write what came of each to the standard output."""
    sys.path.insert(0, os.getcwd())
    session: dict[str, Any] = {"__name__": "__main__"}
    results = []
    for kind, text, path in json.load(sys.stdin):
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
    json.dump(results, sys.stdout)


if __name__ == "__main__":
    main()
