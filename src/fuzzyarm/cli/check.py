"""Find mistakes in files, and format them: ``fuzzyarm check`` and ``fuzzyarm fmt``."""

from __future__ import annotations

import argparse
import os
import sys

from fuzzyarm.api import Review, UnknownKindError, check_file
from fuzzyarm.language import format_text, read_text
from fuzzyarm.text.diagnostic import Diagnostic, RuleBaseError, Severity, render_all

DESCRIPTION_CHECK = """Find mistakes and doubts in rule bases and tables.

Prints each finding with its place, the source line, a caret and, where there is one, what
was probably meant. Exit status 1 if any file has an error (with --strict: or a warning).
A comment `# allow NAME` on a line silences the finding of that name there; docs/checks.md
explains every name.
"""


def configure_check(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm check``."""
    parser.add_argument("files", nargs="+", metavar="FILE", help=".frb, .lut, .fll, .fcl or .fis")
    parser.add_argument("--strict", action="store_true", help="let warnings fail too")
    parser.add_argument("--quiet", "-q", action="store_true", help="print findings only")
    parser.add_argument("--json", action="store_true", help="print the findings as JSON")


def run_check(arguments: argparse.Namespace) -> int:
    """Check every file; return 1 if any failed."""
    failed = False
    found: list[Diagnostic] = []
    for path in arguments.files:
        try:
            review = check_file(path)
        except OSError as error:
            print(f"fuzzyarm: {path}: {error.strerror or error}", file=sys.stderr)
            failed = True
            continue
        failed |= review.failed or (arguments.strict and _has_warning(review))
        found += review.diagnostics
        if not arguments.json:
            _print_review(path, review, quiet=arguments.quiet)
    if arguments.json:
        import json

        print(json.dumps([as_dict(diagnostic) for diagnostic in found], indent=2))
    return int(failed)


def _has_warning(review: Review) -> bool:
    return any(diagnostic.severity is Severity.WARNING for diagnostic in review.diagnostics)


def _print_review(path: str, review: Review, *, quiet: bool) -> None:
    if review.diagnostics:
        # Errors are what a caller's log must show even when the output goes elsewhere.
        stream = sys.stderr if review.failed else sys.stdout
        colour = stream.isatty() and "NO_COLOR" not in os.environ
        print(render_all(review.diagnostics, review.text, colour=colour), file=stream)
    if not quiet:
        print(f"{path}: {_summary(review)}", file=sys.stderr if review.failed else sys.stdout)


def _summary(review: Review) -> str:
    counts = [
        (sum(d.severity is severity for d in review.diagnostics), severity)
        for severity in (Severity.ERROR, Severity.WARNING, Severity.INFO)
    ]
    said = [f"{count} {severity}{_plural(count, severity)}" for count, severity in counts if count]
    return ", ".join(said) if said else "no findings"


def _plural(count: int, severity: Severity) -> str:
    return "s" if count != 1 and severity is not Severity.INFO else ""


def as_dict(diagnostic: Diagnostic) -> dict[str, object]:
    """Return a diagnostic as JSON data."""
    return {
        "name": diagnostic.name,
        "severity": str(diagnostic.severity),
        "message": diagnostic.message,
        "hint": diagnostic.hint,
        "path": diagnostic.path,
        "line": diagnostic.line,
        "column": diagnostic.column,
        "end_line": diagnostic.span.end_line,
        "end_column": diagnostic.span.end_column,
        "related": [
            {"message": r.message, "line": r.span.line, "column": r.span.column}
            for r in diagnostic.related
        ],
    }


DESCRIPTION_FMT = """Rewrite rule bases in canonical form: grids aligned, comments kept.

A file with mistakes is left as it is. `--check` changes nothing and returns 1 if a file
is not in canonical form; `-` formats standard input to standard output.
"""


def configure_fmt(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm fmt``."""
    parser.add_argument("files", nargs="+", metavar="FILE", help="a .frb file, or - for stdin")
    mode = parser.add_mutually_exclusive_group()
    mode.add_argument("--check", action="store_true", help="only say which files would change")
    mode.add_argument("--diff", action="store_true", help="only print what would change")


def run_fmt(arguments: argparse.Namespace) -> int:
    """Format every file; return 1 if one has mistakes, or would change under ``--check``."""
    status = 0
    for path in arguments.files:
        text = ""
        try:
            text = _read(path)
            status |= _format_one(path, text, arguments)
        except RuleBaseError as error:
            errors = [d for d in error.diagnostics if d.is_error]
            print(render_all(errors, text), file=sys.stderr)
            print(f"fuzzyarm: {path}: left as it is", file=sys.stderr)
            status = 1
        except OSError as error:
            print(f"fuzzyarm: {path}: {error.strerror or error}", file=sys.stderr)
            status = 1
    return status


def _read(path: str) -> str:
    if path == "-":
        return sys.stdin.buffer.read().decode("utf-8", "replace")
    if not path.endswith(".frb"):
        raise UnknownKindError(path)
    return read_text(path)


def _format_one(path: str, text: str, arguments: argparse.Namespace) -> int:
    formatted = format_text(text, path)
    if arguments.diff:
        import difflib

        before, after = text.splitlines(keepends=True), formatted.splitlines(keepends=True)
        sys.stdout.writelines(difflib.unified_diff(before, after, path, path))
        return 0
    if path == "-":
        sys.stdout.write(formatted)
        return 0
    if formatted == text:
        return 0
    if arguments.check:
        print(f"{path}: not in canonical form")
        return 1
    from fuzzyarm.text.files import write_atomically

    write_atomically(path, formatted)
    print(f"{path}: formatted")
    return 0
