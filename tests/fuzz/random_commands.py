"""Random commands on damaged files: whatever is asked of whatever, a command answers.

    python tests/fuzz/random_commands.py --seed 1 --count 12000

A finding is a traceback, a command that takes longer than ``--limit`` seconds, an exit status that
is not of those promised, one that is not 0 without a sentence on the standard error, or output
that is not what was asked for: JSON that is not JSON, a rule base that cannot be read, files
left behind.
"""

from __future__ import annotations

import argparse
import json
import random
import re
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests"), str(ROOT / "tests" / "fuzz")]

from drawn_commands import OFTEN, Drawing, originals  # noqa: E402
from workers import HUNG, Outcome, Worker  # noqa: E402

from fuzzyarm.language import parse  # noqa: E402

DIVERGES = {"simulate", "margins", "sweep", "compare", "learn", "tune", "reproduce", "demo"}
"""Commands with a loop, which may end with 3."""

UNDECIDED = {"prove", "check", "demo"}
"""Commands that may end with 4."""

Told = Callable[[int, Outcome], None]


class Fault(NamedTuple):
    """A command that did something wrong: its number, of what class, and what came out."""

    number: int
    sort: str
    outcome: Outcome


# --- What is wrong with what came out ---


def faults(outcome: Outcome, folder: Path, before: set[str]) -> Iterator[str]:
    """Yield what is wrong, by class; `before` has the files that were there."""
    name = outcome.words[0] if outcome.words else ""
    if outcome.status == HUNG:
        stack = re.findall(r'File "[^"]*?src/fuzzyarm/[^"]+", line \d+ in (\w+)', outcome.trace)
        yield f"longer than the limit: {name} in {' < '.join(stack[:4])}"
    elif outcome.trace or isinstance(outcome.status, str):
        last = outcome.trace.rstrip().splitlines()[-1:] or [str(outcome.status)]
        place = re.findall(r'File "[^"]*?(fuzzyarm/[^"]+)", line (\d+)', outcome.trace)
        yield f"{last[0].split(':')[0]} at {':'.join(place[-1]) if place else '?'}"
    else:
        yield from _faults_of_words(name, outcome)
        for path in sorted(folder.iterdir()):
            if path.name not in before and not path.name.startswith(".std"):
                yield from _faults_of_file(name, path)


def _faults_of_words(name: str, outcome: Outcome) -> Iterator[str]:
    status = outcome.status
    allowed = (
        {0, 1, 2} | ({3} if name in DIVERGES else set()) | ({4} if name in UNDECIDED else set())
    )
    if status not in allowed:
        yield f"status {status} of {name}"
    if status != 0 and not outcome.err.strip():
        yield f"status {status} of {name} without a word"
    if status == 0 and re.search(r"^fuzzyarm: error|: error\[", outcome.err, re.MULTILINE):
        yield f"status 0 of {name} with an error"
    for text in (outcome.out, outcome.err):
        if "Traceback (most recent call last)" in text or "a fault of the program" in text:
            yield f"{name} prints a traceback"
    warning = re.search(r"\w+Warning: .{0,80}", outcome.err)
    if warning and "File" not in warning[0]:
        yield f"{name} warns of itself: {warning[0]}"
    if "--json" in outcome.words and status in (0, 3) and (fault := _not_json(outcome.out)):
        yield f"{name} --json prints what is none: {fault}"


def _faults_of_file(name: str, path: Path) -> Iterator[str]:
    if path.name.startswith(".") or path.suffix == ".tmp":
        yield f"{name} leaves {path.suffix or path.name} behind"
    elif path.suffix == ".frb" and path.is_file() and name != "shipped":
        errors = [each for each in parse(path.read_text("utf-8")).diagnostics if each.is_error]
        if errors:
            yield f"{name} writes what cannot be read: {errors[0].message}"
    elif (
        path.suffix == ".json" and path.is_file() and (fault := _not_json(path.read_text("utf-8")))
    ):
        yield f"{name} writes JSON that is none: {fault}"


def _not_json(text: str) -> str:
    """Return why a text is not JSON, which has neither NaN nor Infinity; empty where it is."""

    def refuse(word: str) -> None:
        raise ValueError(f"the word {word}")

    try:
        json.loads(text, parse_constant=refuse)
    except ValueError as error:
        return str(error)
    return ""


# --- The search ---


def search(
    seed: int,
    count: int,
    first: int = 0,
    limit: float = 20.0,
    told: Told = lambda _number, _outcome: None,
    often: dict[str, float] = OFTEN,
) -> Iterator[Fault]:
    """Yield the faults of commands `first` to `first + count`, each by its number and the seed."""
    with Worker(limit, {"FUZZYARM_PROGRESS": "0"}) as worker:
        for number in range(first, first + count):
            r = random.Random(f"{seed} {number}")
            folder = Path(tempfile.mkdtemp(prefix="commands"))
            try:
                words = Drawing(r, folder, often).words()
                before = {path.name for path in folder.iterdir()}
                stdin = r.choice((b"", b"y\n", originals()["pd7.frb"], b"\xff\x00"))
                outcome = worker.run(words, folder, stdin)
                told(number, outcome)
                for sort in faults(outcome, folder, before):
                    yield Fault(number, sort, outcome)
            finally:
                shutil.rmtree(folder, ignore_errors=True)


def main() -> int:
    """Be a script; print a finding of each sort."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="number of the first command")
    parser.add_argument("--limit", type=float, default=20.0, help="seconds for a command")
    parser.add_argument("--every", type=int, default=0, help="say where it is after so many")
    chosen = parser.parse_args()
    start, sorts = time.monotonic(), dict[str, list[Fault]]()
    ends: dict[str, int] = {}

    def told(number: int, outcome: Outcome) -> None:
        key = f"{outcome.words[0] if outcome.words else ''} {outcome.status}"
        ends[key] = ends.get(key, 0) + 1
        if chosen.every and (number + 1 - chosen.first) % chosen.every == 0:
            print(f"... {number + 1}, {time.monotonic() - start:.0f} s", flush=True)

    for fault in search(chosen.seed, chosen.count, chosen.first, chosen.limit, told):
        if fault.sort not in sorts:
            report(fault)
        sorts.setdefault(fault.sort, []).append(fault)
    print("\n".join(f"{len(alike):5} {sort}" for sort, alike in sorted(sorts.items())))
    print("; ".join(f"{key}: {count}" for key, count in sorted(ends.items())))
    total, seconds = sum(map(len, sorts.values())), time.monotonic() - start
    print(f"{chosen.count} commands, {total} findings of {len(sorts)} sorts, {seconds:.0f} s")
    return int(bool(sorts))


def report(fault: Fault) -> None:
    """Print a finding: the first of its sort."""
    print(f"=== {fault.sort}\n--- command {fault.number}: {list(fault.outcome.words)}")
    print(f"{fault.outcome.seconds:.1f} s, status {fault.outcome.status}")
    lines = fault.outcome.trace.rstrip().splitlines()
    # The innermost call stands first where it hung, and last where it was raised.
    print("\n".join(lines[:12] if fault.outcome.status == HUNG else lines[-6:]), flush=True)


if __name__ == "__main__":
    sys.exit(main())
