"""Find mistakes and doubts in rule bases and tables.

Prints each finding with its place, the source line, a caret and, where there is one, what
was probably meant. Exit status 1 if any file has an error (with --strict: or a warning).
A comment `# allow NAME` on a line silences the finding of that name there; docs/checks.md
explains every name.
"""

from __future__ import annotations

import argparse
import os
import sys

from fuzzyarm.api import Review, check_file
from fuzzyarm.rulebase import Diagnostic, Severity
from fuzzyarm.rulebase.rendering import render_all


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm check``."""
    parser.add_argument("files", nargs="+", metavar="FILE", help=".frb, .lut, .fll, .fcl or .fis")
    parser.add_argument("--strict", action="store_true", help="let warnings fail too")
    parser.add_argument("--quiet", "-q", action="store_true", help="print findings only")
    parser.add_argument("--json", action="store_true", help="print the findings as JSON")


def run(arguments: argparse.Namespace) -> int:
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
