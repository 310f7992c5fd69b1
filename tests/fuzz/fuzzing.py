"""What the three fuzzers share: cases by number, findings with their input, the command line."""

from __future__ import annotations

import argparse
import contextlib
import io
import os
import random
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

Case = Callable[[random.Random, "Told"], None]
"""Make one input, tell it, and raise where something is wrong."""


class Told(list[str]):
    """What a case says of its input before it uses it."""


class Finding(NamedTuple):
    """A case that raised: its number, its input and the traceback."""

    number: int
    told: str
    trace: str

    @property
    def sort(self) -> str:
        """The last line of the traceback and where it was raised: findings of one cause."""
        lines = self.trace.rstrip().split("\n")
        places = [line.strip() for line in lines if line.lstrip().startswith("File ")]
        error = next((x for x in reversed(lines) if x and not x[0].isspace()), "")
        return f"{error.split(':')[0]} {places[-1] if places else ''}"


def tried(case: Case, seed: int, number: int) -> Finding | None:
    """Run one case, which depends on the seed and its number alone."""
    told = Told()
    try:
        case(random.Random(f"{seed} {number}"), told)
    except Exception:
        return Finding(number, "\n".join(told), traceback.format_exc())
    return None


def search(case: Case, seed: int, count: int, first: int = 0) -> list[Finding]:
    """Run cases `first` to `first + count`, and return what is wrong."""
    outcomes = (tried(case, seed, number) for number in range(first, first + count))
    return [finding for finding in outcomes if finding is not None]


def run(description: str | None, case: Case, words: Sequence[str] | None = None) -> int:
    """Be a script: ``--seed 1 --count 20000``; print one finding of each sort.

    Findings are named at once. Ctrl-C ends the search early, with what there is by then; in the
    background, where shells ignore it, ``kill -INT`` does.
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    chosen = parser.parse_args(words)
    start = time.monotonic()
    found: list[Finding] = []
    count = 0
    with contextlib.suppress(KeyboardInterrupt):
        for count in range(chosen.count):
            finding = tried(case, chosen.seed, chosen.first + count)
            if finding is not None:
                print(f"case {finding.number}: {finding.sort}", file=sys.stderr, flush=True)
                found.append(finding)
        count = chosen.count
    report(found, count, time.monotonic() - start)
    return int(bool(found))


def report(found: list[Finding], count: int, seconds: float) -> None:
    """Print one finding of each sort, and how many there are."""
    sorts: dict[str, list[Finding]] = {}
    for finding in found:
        sorts.setdefault(finding.sort, []).append(finding)
    for sort, alike in sorts.items():
        shortest = min(alike, key=lambda each: len(each.told))
        print(f"=== {len(alike)} times {sort}\n--- case {shortest.number}\n{shortest.told}")
        print(shortest.trace)
    print(f"{count} cases, {len(found)} findings of {len(sorts)} sorts, {seconds:.0f} s")


def command(words: list[str]) -> tuple[int, str]:
    """Run the command line in this process; return its status and what it printed."""
    from fuzzyarm.apps.cli import main

    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        status = main(words)
    assert status in (0, 1, 2), status
    assert "Traceback" not in said.getvalue()
    return status, said.getvalue()


def demand_whole_files(words: list[str], target: Path, *, full: bool) -> None:
    """Run a command that writes `target`: wholly, or not at all, and nothing beside it.

    With `full` the disk takes no file.
    """
    old = "what was there before"
    target.write_text(old)
    before = {path.name for path in target.parent.iterdir()}
    replace = os.replace

    def fails(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    os.replace = fails if full else replace  # type: ignore[assignment]
    try:
        status, said = command(words)
    finally:
        os.replace = replace
    assert not (full and status == 0), said
    if status != 0:
        assert said, words
        assert target.read_text() == old, said
        assert {path.name for path in target.parent.iterdir()} == before
    else:
        assert target.stat().st_size


@contextlib.contextmanager
def folder() -> contextlib.AbstractContextManager[Path]:
    """Give a folder for some files."""
    with tempfile.TemporaryDirectory() as name:
        yield Path(name)
