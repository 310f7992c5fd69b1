"""Find mistakes in files, and format them: ``fuzzyarm check`` and ``fuzzyarm fmt``."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterable, Iterator

from fuzzyarm.apps.cli.command import (
    UsageError,
    WordError,
    always,
    announced,
    argument,
    command,
    flag,
    print_error,
    print_findings,
    print_json,
    print_os_error,
    say,
    write_text,
)
from fuzzyarm.base.diagnostic import Diagnostic, RuleBaseError, Severity
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.folders import READABLE, own_files
from fuzzyarm.base.numbers import counted
from fuzzyarm.exchange.files import (
    PlantOf,
    Review,
    check_file,
    check_text,
)
from fuzzyarm.language import format_text, read_text
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.language.reading import decoded

_IN_FOLDERS = (*READABLE, ".lut")
"""Files of a folder to check: other tables may belong to any program."""


class EmptyFolderError(FuzzyarmError, ValueError):
    """A folder without a file to check."""

    def __init__(self, path: str) -> None:
        super().__init__(f"{path}: no files to check in this folder", hint=", ".join(_IN_FOLDERS))


_CHECK = """Find mistakes and doubts in rule bases and tables.

Prints each finding with its position, the source line, a caret and, if there is one, a
suggestion. Exit status 1 if any file has an error (with --strict: or a warning).
A comment `# allow NAME` on a line silences the finding of that name there; docs/reference/checks.md
explains every name. --format github adds an annotation to each finding, which GitHub shows beside
the code. A controller is checked on the shipped plant with its axes, or on that of --plant,
where a missing port is an error. In a folder every rule base and .lut file is checked,
subfolders included, except hidden ones, Python environments, paths in a .gitignore and .xml files
other than FML; `-` checks the text of a .frb file from standard input.
"""


def _check(arguments: argparse.Namespace) -> int:
    failed = False
    diagnostics: list[Diagnostic] = []
    on = _plant_of(arguments)
    for path in _files(arguments.files):
        try:
            with announced(f"checking {path}"):
                review = _review_stdin(on) if path == "-" else check_file(path, on)
        except OSError as error:
            print_os_error(error, path)
            failed = True
            continue
        doubtful = any(d.severity is Severity.WARNING for d in review.diagnostics)
        failed |= review.failed or (arguments.strict and doubtful)
        diagnostics += review.diagnostics
        if not arguments.json:
            _print_review(path, review, quiet=arguments.quiet)
            if arguments.format == "github":
                write_text("".join(map(_annotation, review.diagnostics)))
            if arguments.verbose and review.rulebase is not None and not review.failed:
                print(f"{path}: {_engine_of(review.rulebase)}")
    if arguments.json:
        print_json(diagnostics, 2)
    wrong = any(finding.is_error for finding in diagnostics)
    # Printed errors speak for themselves; JSON, and warnings under --strict, do not.
    if failed and diagnostics and (arguments.json or not wrong):
        summary = Review("", tuple(diagnostics)).summary
        print_error(summary if wrong else f"{summary}; --strict lets no warning pass")
    return int(failed)


def _files(paths: Iterable[str]) -> Iterator[str]:
    """Yield the files among `paths`, and the files to check in the folders among them."""
    for path in paths:
        if not os.path.isdir(path):
            yield path
            continue
        rule_files = [file for file in own_files(path) if _is_ours(file)]
        if not rule_files:
            raise EmptyFolderError(path)
        yield from sorted(rule_files)


def _is_ours(path: str) -> bool:
    """Whether to check a file of a folder: .xml has many other uses."""
    name = path.lower()
    if not name.endswith(".xml"):
        return name.endswith(_IN_FOLDERS)
    from fuzzyarm.exchange.formats.fml import is_fml

    try:
        with open(path, "rb") as file:
            return is_fml(file.read(10_000).decode("utf-8", "replace"))
    except OSError:
        return False


def _plant_of(arguments: argparse.Namespace) -> PlantOf | None:
    """Return the plant of ``--plant``; ``--connect`` alone is an error."""
    if arguments.plant is None:
        if arguments.connect:
            raise UsageError("--connect joins the ports of a plant", hint="add, say, --plant motor")
        return None
    from fuzzyarm.control.loop.words import read_pairs
    from fuzzyarm.plant.own import find_plant

    connect = read_pairs(arguments.connect, "--connect", str)
    return PlantOf(find_plant(arguments.plant), connect)


def _review_stdin(on: PlantOf | None) -> Review:
    try:
        return check_text(decoded(sys.stdin.buffer.read(), "<stdin>"), "<stdin>", on)
    except RuleBaseError as error:
        return Review("", error.diagnostics)


def _annotation(finding: Diagnostic) -> str:
    """Return a finding as a GitHub annotation command."""
    level = {"error": "error", "warning": "warning"}.get(finding.severity.value, "notice")
    place = {"file": finding.path, "line": finding.line, "col": finding.column}
    place["title"] = finding.name
    properties = ",".join(f"{key}={_escaped(str(value), ':,')}" for key, value in place.items())
    return f"::{level} {properties}::{_escaped(finding.message)}\n"


def _escaped(text: str, more: str = "") -> str:
    """Return text with GitHub's escapes for the ends of commands and properties."""
    # % first: the other escapes begin with it.
    for character in "%\r\n" + more:
        text = text.replace(character, f"%{ord(character):02X}")
    return text


def _print_review(path: str, review: Review, *, quiet: bool) -> None:
    # Errors go to the error stream, for the log of the caller.
    stream = sys.stderr if review.failed else sys.stdout
    if review.diagnostics:
        print_findings(review.diagnostics, review.text, stream)
    if not quiet:
        say(f"{'<stdin>' if path == '-' else path}: {review.summary}", to_errors=review.failed)


def _engine_of(rulebase: RuleBase) -> str:
    """Return whether the kernel covers a rule base, and why not."""
    from fuzzyarm.inference.layout import uncovered_feature

    reason = uncovered_feature(rulebase)
    return f"not covered by the kernel: {reason}" if reason else "covered by the kernel"


_FMT = """Rewrite rule bases in canonical form: grids aligned, comments kept.

A file with mistakes is left as it is. `--check` changes nothing and returns 1 if a file
is not in canonical form; `-` formats standard input to standard output.
"""


def _fmt(arguments: argparse.Namespace) -> int:
    status, changed = 0, 0
    for path in arguments.files:
        text = ""
        try:
            text = _read(path)
            changed += _format_one(path, text, arguments)
        except RuleBaseError as error:
            print_findings([d for d in error.diagnostics if d.is_error], text, sys.stderr)
            print_error(f"{path}: left as it is")
            status = 1
        except OSError as error:
            print_os_error(error, path)
            status = 1
    if arguments.check and changed:
        print_error(f"{counted(changed, 'file')} would be reformatted")
        return 1
    return status


def _read(path: str) -> str:
    if path == "-":
        return decoded(sys.stdin.buffer.read(), "<stdin>")
    if not path.lower().endswith(".frb"):
        hint = "fuzzyarm convert makes a .frb file of a rule base or a table"
        raise WordError(f"fmt formats .frb files, which {path} is not", hint=hint)
    return read_text(path)


def _format_one(path: str, text: str, arguments: argparse.Namespace) -> bool:
    """Format a text; return whether that changes its file, or would."""
    formatted = format_text(text, path)
    if arguments.diff:
        import difflib

        before, after = text.splitlines(keepends=True), formatted.splitlines(keepends=True)
        write_text("".join(difflib.unified_diff(before, after, path, path)))
        return False
    if path == "-":
        write_text(formatted)
        return False
    if formatted == text:
        return False
    if arguments.check:
        say(f"{path}: would be reformatted")
        return True
    from fuzzyarm.base.files import write_atomically

    write_atomically(path, formatted)
    say(f"{path}: formatted")
    return True


COMMANDS = (
    command(
        "check",
        _CHECK,
        _check,
        argument("files FILE", ".frb, .lut, .fll, .fcl or .fis, a folder or -", nargs="+"),
        argument("--plant PLANT", "check controllers on it: motor, FILE.py or FILE.py:CLASS …"),
        argument(
            "--connect NAME=PORT",
            "join a name of the controller to a port of the plant",
            action="append",
            default=[],
        ),
        flag("--strict", "let warnings fail too"),
        flag("--quiet -q", "print findings only"),
        flag("--verbose -v", "also print whether the kernel covers a rule base"),
        argument(
            "--format FORMAT",
            "text, or github: also as annotations",
            choices=("text", "github"),
            default="text",
            either="as",
        ),
        flag("--json", "print the findings as JSON", either="as"),
    ),
    command(
        "fmt",
        _FMT,
        _fmt,
        argument("files FILE", "a .frb file, or - for stdin", nargs="+"),
        flag("--check", "only list the files that would change", either="mode"),
        flag("--diff", "only print the changes", either="mode"),
        rewrites=always,
    ),
)
