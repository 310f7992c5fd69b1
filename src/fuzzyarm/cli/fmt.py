"""Rewrite rule bases in canonical form: grids aligned, comments kept.

A file with mistakes is left as it is. `--check` changes nothing and returns 1 if a file
is not in canonical form; `-` formats standard input to standard output.
"""

from __future__ import annotations

import argparse
import difflib
import sys

from fuzzyarm.api import UnknownKindError
from fuzzyarm.files import write_atomically
from fuzzyarm.rulebase import RuleBaseError, format_text, read_text
from fuzzyarm.rulebase.rendering import render_all


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm fmt``."""
    parser.add_argument("files", nargs="+", metavar="FILE", help="a .frb file, or - for stdin")
    mode = parser.add_mutually_exclusive_group()
    mode.add_argument("--check", action="store_true", help="only say which files would change")
    mode.add_argument("--diff", action="store_true", help="only print what would change")


def run(arguments: argparse.Namespace) -> int:
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
    write_atomically(path, formatted)
    print(f"{path}: formatted")
    return 0
