"""Convert a rule base between .frb, .fll, .fcl and .fis, by suffix.

    fuzzyarm convert tipper.fis tipper.frb
    fuzzyarm convert robot.fcl robot.fll --from jfuzzylogic

Everything that does not come across is said, with its place in the file. Where the other
program samples a defuzzifier differently, or treats values outside a range differently, the
file is written with a warning (not so with --strict); what would change numbers beyond that is
an error, and nothing is written, unless --lossy.

    fuzzyarm convert learned.lut learned.frb

A table becomes the rules whose terms come nearest; what they cannot express is said.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from dataclasses import replace
from pathlib import Path

from fuzzyarm.api import TABLE_SUFFIXES
from fuzzyarm.formats import PRODUCERS, Exported, Imported, read, suffix_of, write
from fuzzyarm.language.reading import text_to_show
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.text.diagnostic import NOWHERE, Diagnostic, render
from fuzzyarm.text.files import write_atomically

_SLIGHT = frozenset({"sampling", "outside-range"})
"""Losses that change numbers a little, or only outside the range of a variable."""

_PROGRAMS = sorted({program for programs in PRODUCERS.values() for program in programs})


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm convert``."""
    parser.add_argument("source", metavar="IN", help=".frb, .fll, .fcl or .fis; or a table")
    parser.add_argument("target", metavar="OUT", help=".frb, .fll, .fcl or .fis")
    mode = parser.add_mutually_exclusive_group()
    mode.add_argument("--lossy", action="store_true", help="go on where numbers will differ")
    mode.add_argument("--strict", action="store_true", help="refuse small differences too")
    parser.add_argument(
        "--from", dest="producer", choices=_PROGRAMS, help="the program IN was written for"
    )
    parser.add_argument(
        "--for", dest="consumer", choices=_PROGRAMS, help="the program OUT is written for"
    )
    parser.add_argument("--block", metavar="NAME", help="which function block of an .fcl to take")
    parser.add_argument("--terms", type=int, metavar="N", help="of a table: terms of the output")
    parser.add_argument("--quiet", "-q", action="store_true", help="print errors only")
    parser.add_argument("--json", action="store_true", help="print what was found as JSON")


def run(arguments: argparse.Namespace) -> int:
    """Convert one file; return 1 if it cannot be read or written faithfully."""
    target = suffix_of(arguments.target)
    if Path(arguments.source).suffix.lower() in TABLE_SUFFIXES:
        return _convert_table(arguments, target)
    imported = read(
        arguments.source,
        producer=arguments.producer,
        block=arguments.block,
        lossy=arguments.lossy,
    )
    found = list(imported.diagnostics)
    text = None
    if imported.rulebase is not None:
        named = _named(imported.rulebase, arguments.source)
        exported = write(named, target, producer=arguments.consumer, lossy=arguments.lossy)
        if exported.text is None and not arguments.strict and _differs_slightly(exported):
            exported = write(named, target, producer=arguments.consumer, lossy=True)
        text = exported.text
        # A rule knows where it stood in the file that was read.
        found += [replace(d, path=arguments.source) for d in exported.diagnostics]
    if text is not None:
        write_atomically(arguments.target, text)
    _report(arguments, imported, found, written=text is not None)
    return 0 if text is not None else 1


def _convert_table(arguments: argparse.Namespace, target: str) -> int:
    """Write the nearest rules to a table and say what they leave out."""
    from fuzzyarm.table import read_table
    from fuzzyarm.table.rules import TERMS, rules_of_table

    table = read_table(arguments.source)
    name = Path(arguments.target).stem
    found = rules_of_table(table, name, terms=arguments.terms or TERMS)
    exported = write(found.rulebase, target, producer=arguments.consumer, lossy=arguments.lossy)
    # A table has no order of conditions or descriptions to lose: only what changes numbers counts.
    diagnostics = [
        replace(d, path=arguments.source)
        for d in exported.diagnostics
        if d.is_error or d.severity == "warning"
    ]
    if exported.text is not None:
        write_atomically(arguments.target, exported.text)
    imported = Imported(found.rulebase, (), "table")
    if not arguments.json:
        _report(arguments, imported, diagnostics, written=exported.text is not None)
        if exported.text is not None and not arguments.quiet:
            print(
                f"what {len(found.rulebase.rules)} rules cannot express of {table.output}: "
                f"{found.worst:.3g} at worst, {found.rms:.3g} rms over "
                f"{table.values.size} cells"
            )
    else:
        data = _as_json(arguments, imported, diagnostics, written=exported.text is not None)
        residual = {"worst": found.worst, "rms": found.rms}
        print(json.dumps({**data, "rules": len(found.rulebase.rules), "residual": residual}))
    return 0 if exported.text is not None else 1


def _differs_slightly(exported: Exported) -> bool:
    return all(d.name in _SLIGHT for d in exported.diagnostics if d.is_error)


def _named(rulebase: RuleBase, path: str) -> RuleBase:
    """Give a rule base without a name that of its file."""
    return rulebase if rulebase.name.strip() else replace(rulebase, name=Path(path).stem)


def _report(
    arguments: argparse.Namespace, imported: Imported, found: list[Diagnostic], *, written: bool
) -> None:
    if arguments.json:
        print(json.dumps(_as_json(arguments, imported, found, written=written), indent=2))
        return
    shown = [d for d in found if d.is_error or not arguments.quiet]
    if shown:
        stream = sys.stderr if not written else sys.stdout
        colour = stream.isatty() and "NO_COLOR" not in os.environ
        text = text_to_show(arguments.source)
        for diagnostic in shown:
            print(_shown(diagnostic, text, colour=colour), file=stream)
    if not written:
        print(f"fuzzyarm: {arguments.target}: not written", file=sys.stderr)
    elif not arguments.quiet:
        # Of a table the residual tells what was lost.
        summary = "" if imported.producer == "table" and not found else f", {_summary(found)}"
        print(f"{arguments.target}: written{summary}")


def _shown(diagnostic: Diagnostic, text: str, *, colour: bool) -> str:
    if diagnostic.span != NOWHERE:
        return render(diagnostic, text, colour=colour)
    hint = f"\n       = hint: {diagnostic.hint}" if diagnostic.hint else ""
    label = f"{diagnostic.severity}[{diagnostic.name}]"
    return f"{diagnostic.path}: {label}: {diagnostic.message}{hint}"


def _summary(found: list[Diagnostic]) -> str:
    warnings = sum(d.severity == "warning" for d in found)
    return "nothing lost" if not warnings else f"{warnings} warning(s)"


def _as_json(
    arguments: argparse.Namespace, imported: Imported, found: list[Diagnostic], *, written: bool
) -> dict[str, object]:
    return {
        "source": arguments.source,
        "target": arguments.target,
        "producer": imported.producer,
        "written": written,
        "diagnostics": [
            {
                "name": d.name,
                "severity": str(d.severity),
                "message": d.message,
                "hint": d.hint,
                "line": d.line,
                "column": d.column,
            }
            for d in found
        ],
    }
