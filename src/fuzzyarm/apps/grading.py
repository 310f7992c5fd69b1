"""Assignments: hidden lines judged on the rule bases that students hand in.

An assignment is a folder: ``task.md`` for students, ``hidden.frb`` with ``expect`` and ``prove``
lines, ``model.frb`` with an answer that passes them, and ``submissions`` with a ``.frb`` of each
student. Nothing of a submission is executed: a rule base is a text, formulas are parsed. What is
broken, too large or hostile is a row like any other.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from fuzzyarm.base.diagnostic import RuleBaseError
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.names import printable
from fuzzyarm.inference import check_expectations
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.language.reading import decoded

__all__ = [
    "Assignment", "Grade", "GradingError", "HiddenLine", "Result", "grade", "read_assignment",
]  # fmt: skip

LARGEST = 200_000
"""Bytes of a submission: a rule base of an exercise has some thousand."""

MOST_RULES = 2_000
SECONDS = 5.0
"""For each `prove` line, after which it stays undecided."""

_LINE = re.compile(r"(?P<text>(?:expect|prove)\b[^#]*?)\s*(?:#\s*(?P<note>.*))?$")
_POINTS = re.compile(r"(?P<points>\d+)\s+points?\b:?\s*(?P<about>.*)$")


class GradingError(FuzzyarmError, ValueError):
    """An assignment is incomplete, or its own answer fails it."""


@dataclass(frozen=True)
class HiddenLine:
    """One demand.

    Attributes
    ----------
    text : str
        An ``expect`` or ``prove`` line.
    points : int
        Its worth.
    about : str
        The text that a student sees; the line itself by default.
    """

    text: str
    points: int = 1
    about: str = ""


@dataclass(frozen=True)
class Assignment:
    """One assignment.

    Attributes
    ----------
    folder : Path
        Where it lies.
    lines : tuple of HiddenLine
        Demands, in order.
    submissions : tuple of Path
        Files, in the order of their names.
    """

    folder: Path
    lines: tuple[HiddenLine, ...]
    submissions: tuple[Path, ...]

    @property
    def points(self) -> int:
        """All points together."""
        return sum(line.points for line in self.lines)


@dataclass(frozen=True)
class Result:
    """Result of one demand.

    Attributes
    ----------
    verdict : str
        ``passed``, ``failed`` or ``undecided``.
    says : str
        The reason; empty for a pass.
    """

    verdict: str
    says: str = ""


@json_properties("name points fault results")
@dataclass(frozen=True)
class Grade:
    """One row.

    Attributes
    ----------
    name : str
        The submission, without its suffix.
    results : tuple of Result
        One for each demand; empty for an unreadable submission.
    points : int
        The sum over the passed demands.
    fault : str
        The reason why it is unreadable; empty for a readable one.
    """

    name: str
    results: tuple[Result, ...]
    points: int
    fault: str = ""


def read_assignment(folder: str | os.PathLike[str]) -> Assignment:
    """Return the assignment in a folder."""
    path = Path(folder)
    if not path.is_dir():
        raise GradingError(f"{folder} is not a folder")
    hidden, handed = path / "hidden.frb", path / "submissions"
    if not hidden.is_file():
        raise GradingError(f"{folder}: hidden.frb with expect and prove lines is missing")
    if not handed.is_dir():
        raise GradingError(f"{folder}: the folder submissions is missing")
    lines = _hidden_lines(hidden)
    files = sorted(file for file in handed.iterdir() if not file.name.startswith("."))
    assignment = Assignment(path, lines, tuple(files))
    model = path / "model.frb"
    if model.is_file():
        # Mistakes of the assignment show before anybody is graded by it.
        _demand_passing(model, assignment)
    return assignment


def _hidden_lines(path: Path) -> tuple[HiddenLine, ...]:
    try:
        text = decoded(path.read_bytes(), str(path))
    except (OSError, RuleBaseError) as error:
        raise GradingError(f"{path}: cannot be read: {error}") from error
    lines = []
    for number, line in enumerate(text.splitlines(), 1):
        plain = line.strip()
        if not plain or plain.startswith("#"):
            continue
        match = _LINE.match(plain)
        if match is None:
            message = f"a line is expect … or prove …, not '{plain[:40]}'"
            raise GradingError(f"{path}:{number}: {message}")
        note = (match["note"] or "").strip()
        worth = _POINTS.match(note)
        points, about = (int(worth["points"]), worth["about"]) if worth else (1, note)
        lines.append(HiddenLine(match["text"], points, about or match["text"]))
    if not lines:
        raise GradingError(f"{path}: there is neither an expect line nor a prove line")
    return tuple(lines)


def _demand_passing(model: Path, assignment: Assignment) -> None:
    answer = _graded(model, assignment.lines)
    if answer.fault:
        raise GradingError(f"{model}: the answer cannot be read: {answer.fault}")
    for line, result in zip(assignment.lines, answer.results, strict=True):
        if result.verdict != "passed":
            raise GradingError(
                f"{model}: the answer itself does not pass '{line.text}': {result.says}"
            )


def grade(assignment: Assignment, tell: Callable[[str], object] = lambda name: None) -> list[Grade]:
    """Return a row for each submission."""
    grades = []
    for path in assignment.submissions:
        tell(path.name)
        grades.append(_graded(path, assignment.lines))
    return grades


def _graded(path: Path, lines: Sequence[HiddenLine]) -> Grade:
    """Return the row of one file; no file can end the run."""
    name = printable(path.stem)
    try:
        text, rulebase = _read(path)
        results = tuple(_result(text, rulebase, line) for line in lines)
    except (OSError, FuzzyarmError) as error:
        return Grade(name, (), 0, _one_sentence(error))
    # A submission must not end the run of the whole class.
    except (RecursionError, MemoryError, ArithmeticError, ValueError) as error:
        return Grade(name, (), 0, f"{type(error).__name__} while it was graded")
    passed = [r.verdict == "passed" for r in results]
    points = sum(line.points for line, ok in zip(lines, passed, strict=True) if ok)
    return Grade(name, results, points)


def _read(path: Path) -> tuple[str, RuleBase]:
    """Return a submission: a text, a regular file of moderate size, a rule base."""
    # A link could lead to the hidden lines, or to the work of another student.
    if path.is_symlink() or not path.is_file():
        raise GradingError("not a file of its own: a link, a folder or a device")
    if path.suffix.lower() != ".frb":
        raise GradingError(f"not a .frb file: '{path.name}'")
    if path.stat().st_size > LARGEST:
        raise GradingError(f"larger than {LARGEST:,} bytes")
    text = decoded(path.read_bytes(), path.name)
    parsed = parse(text, path.name)
    if parsed.rulebase is None:
        if parsed.controller is not None:
            raise GradingError("a controller without rules, not a rule base")
        raise RuleBaseError(parsed.diagnostics)
    rules = sum(len(block.rules) for block in parsed.rulebase.blocks)
    if rules > MOST_RULES:
        raise GradingError(f"{rules:,} rules; at most {MOST_RULES:,} are graded")
    return text, parsed.rulebase


def _result(text: str, rulebase: RuleBase, line: HiddenLine) -> Result:
    """Return the result of one demand, which is read as a line of the submission."""
    parsed = parse(f"{text}\n{line.text}\n", "submission")
    if parsed.rulebase is None:
        return Result("failed", next(d.message for d in parsed.diagnostics if d.is_error))
    if line.text.startswith("prove"):
        return _proved(rulebase, line.text.removeprefix("prove").strip())
    # A submission may have expect lines, which do not count: the last one is ours.
    narrowed = replace(parsed.rulebase, expectations=parsed.rulebase.expectations[-1:])
    failures = check_expectations(narrowed)
    return Result("failed", failures[0].message) if failures else Result("passed")


def _proved(rulebase: RuleBase, statement: str) -> Result:
    from fuzzyarm.proof.map import prove

    verdict = prove(rulebase, statement, budget=SECONDS)
    if verdict.verdict == "proved":
        return Result("passed")
    reason = verdict.evidence[0] if verdict.evidence else verdict.reason
    return Result("failed" if verdict.verdict == "refuted" else "undecided", reason)


def _one_sentence(error: Exception) -> str:
    """Return the mistake in one sentence, with its line if it has one."""
    if isinstance(error, RuleBaseError):
        first = next((d for d in error.diagnostics if d.is_error), None)
        if first is not None:
            return f"line {first.line}: {first.message}"
    return printable(" ".join(str(error).split()))
