"""Ask tools the cases and write down what they answer.

    python -m conformance.run                          all tools that are known
    python -m conformance.run simpful octave           these
    python -m conformance.run --runner NAME=COMMAND    one of your own
    python -m conformance.run --cases FOLDER           other cases
    python -m conformance.run --only "gap-*" octave    these cases again, the other answers stay

Each tool's answers become `results/NAME.json`, of which `python -m conformance.report` makes the
page.
"""

from __future__ import annotations

import argparse
import json
import shlex
import subprocess
import sys
from collections.abc import Mapping, Sequence
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

from conformance.suite import CASES, FOLDER, Case, SuiteError, read_all

RUNNERS = FOLDER / "runners"
RESULTS = FOLDER / "results"
TOLERANCE = 1e-9  # of the range of the output
PYTHON = sys.executable
TOOLS = {
    **{
        f"fuzzyarm-{engine}": [PYTHON, str(RUNNERS / "fuzzyarm_runner.py"), engine]
        for engine in ("point", "arrays", "compiled", "c", "st", "javascript")
    },
    "scikit-fuzzy": [PYTHON, str(RUNNERS / "scikit_fuzzy.py")],
    "simpful": [PYTHON, str(RUNNERS / "simpful_runner.py")],
    "pyfuzzylite": [PYTHON, str(RUNNERS / "fuzzylite_env.py")],
    "pyit2fls": [PYTHON, str(RUNNERS / "pyit2fls_runner.py")],
    "octave": [PYTHON, str(RUNNERS / "octave.py")],
}


class RunnerError(RuntimeError):
    """A runner does not keep to the protocol, or does not start."""


def ask(
    name: str, command: Sequence[str], cases: Sequence[Case]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return what a runner says of its tool, and its answers by the names of the cases.

    Raises
    ------
    RunnerError
        In one sentence.
    """
    lines = "".join(json.dumps(dict(case.data)) + "\n" for case in cases)
    try:
        done = subprocess.run(
            list(command), input=lines, stdout=subprocess.PIPE, text=True, check=False, timeout=3600
        )
    except OSError as error:
        raise RunnerError(f"{name}: {command[0]} does not start: {error.strerror}") from error
    except subprocess.TimeoutExpired as error:
        raise RunnerError(f"{name}: no end within an hour") from error
    try:
        first, *said = [json.loads(line) for line in done.stdout.splitlines()]
        about = {"tool": str(first["tool"]), "version": str(first["version"])}
        return about, {entry["name"]: entry for entry in said}
    except (ValueError, KeyError, TypeError) as error:
        raise RunnerError(
            f"{name}: not the lines of a runner (exit {done.returncode}): see conformance/README.md"
        ) from error


def judged(case: Case, answer: Mapping[str, Any] | None) -> dict[str, Any]:
    """Return the verdict on an answer: pass, differs, cannot or error, and what belongs to it."""
    if answer is None:
        return {"verdict": "error", "says": "no answer"}
    if "cannot" in answer:
        return {"verdict": "cannot", "says": str(answer["cannot"])[:200]}
    points = answer.get("points")
    if not isinstance(points, list) or len(points) != len(case.data["points"]):
        return {"verdict": "error", "says": str(answer.get("error", "not an answer"))[:200]}
    worst: dict[str, Any] = {"verdict": "pass", "off": 0.0}
    for point, numbers in zip(case.data["points"], points, strict=True):
        for output, expected in point["expected"].items():
            got = numbers.get(output)
            wanted = expected.get("value")
            if (got is None) != (wanted is None):
                word = "no number" if got is None else "a number where there is none"
                return {
                    "verdict": "differs",
                    "says": word,
                    "inputs": point["inputs"],
                    "got": got,
                    "expected": wanted,
                }
            off = 0.0 if got is None else abs(got - wanted) / case.span[output]
            if off > worst["off"] or "got" not in worst:
                verdict = "pass" if off <= TOLERANCE else "differs"
                worst = {
                    "verdict": verdict,
                    "off": off,
                    "inputs": point["inputs"],
                    "got": got,
                    "expected": wanted,
                }
    return {"verdict": "pass", "off": worst["off"]} if worst["verdict"] == "pass" else worst


def run(
    name: str, command: Sequence[str], cases: Sequence[Case], folder: Path, only: str = "*"
) -> dict[str, int]:
    """Ask one tool and write down its verdicts; return how many of each there are.

    Of cases whose name does not match `only` the verdicts of before stay.
    """
    path = folder / f"{name}.json"
    before = json.loads(path.read_text(encoding="utf-8"))["verdicts"] if path.exists() else {}
    about, answers = ask(name, command, [case for case in cases if fnmatch(case.name, only)])
    verdicts = {}
    for case in cases:
        if fnmatch(case.name, only):
            verdicts[case.name] = {"topic": case.topic, **judged(case, answers.get(case.name))}
        elif case.name in before:
            verdicts[case.name] = before[case.name]
    data = json.dumps({**about, "verdicts": verdicts}, indent=1) + "\n"
    draft = folder / f".{name}.json"
    draft.write_text(data, encoding="utf-8")
    draft.replace(path)
    counts = dict.fromkeys(("pass", "differs", "cannot", "error"), 0)
    for verdict in verdicts.values():
        counts[verdict["verdict"]] += 1
    return counts


def main(words: Sequence[str] | None = None) -> int:
    """Ask tools; the exit code is 1 where one could not be asked."""
    parser = argparse.ArgumentParser(
        prog="python -m conformance.run", description=__doc__.splitlines()[0]
    )
    parser.add_argument("tools", nargs="*", metavar="TOOL", help=f"of {', '.join(TOOLS)}")
    parser.add_argument("--runner", metavar="NAME=COMMAND", action="append", default=[])
    parser.add_argument("--cases", type=Path, default=CASES, metavar="FOLDER")
    parser.add_argument("--only", default="*", metavar="PATTERN", help="of the names of cases")
    parser.add_argument("--results", type=Path, default=RESULTS, metavar="FOLDER")
    chosen = parser.parse_args(words)
    commands: dict[str, Sequence[str]] = {}
    for name in chosen.tools or ([] if chosen.runner else list(TOOLS)):
        if name not in TOOLS:
            parser.error(f"unknown tool {name!r}: one of {', '.join(TOOLS)}")
        commands[name] = TOOLS[name]
    for text in chosen.runner:
        name, equals, line = text.partition("=")
        if not equals or not name.replace("-", "").replace("_", "").isalnum():
            parser.error(f"--runner wants NAME=COMMAND, not {text!r}")
        commands[name] = shlex.split(line)
    try:
        cases = read_all(chosen.cases)
    except SuiteError as error:
        print(error, file=sys.stderr)
        return 1
    chosen.results.mkdir(parents=True, exist_ok=True)
    failed = False
    for name, command in commands.items():
        try:
            counts = run(name, command, cases, chosen.results, chosen.only)
        except RunnerError as error:
            print(error, file=sys.stderr)
            failed = True
            continue
        print(f"{name}: " + ", ".join(f"{count} {word}" for word, count in counts.items()))
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
