"""Convert a rule base between .frb, .fll, .fcl and .fis, by suffix.

    fuzzyarm convert tipper.fis tipper.frb
    fuzzyarm convert robot.fcl robot.fll --from jfuzzylogic

Everything that does not come across is said, with its position in the file. Where numbers
change a little (another sampling of the defuzzifier, another manner outside a range, fuzzylite's
threshold of 1e-6), the file is written with a warning, and refused with --strict; what would
change numbers beyond that is an error, and nothing is written, unless --lossy. From .frb to .frb
the text is formatted and its comments stay; other files have no place for them.

    fuzzyarm convert learned.lut learned.frb

A table becomes the rules whose terms come nearest; what they cannot express is said.
"""

from __future__ import annotations

import argparse
import os
import sys
from dataclasses import replace
from pathlib import Path

from fuzzyarm.cli.command import (
    argument,
    command,
    counted,
    finding_data,
    flag,
    json_of,
    print_error,
    print_findings,
    print_json,
    say,
)
from fuzzyarm.formats import PRODUCERS, Exported, Imported, read, suffix_of, write
from fuzzyarm.formats.tables import in_tables
from fuzzyarm.language.reading import format_text, read_text, text_to_show
from fuzzyarm.language.tokens import tokenize
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.table import SUFFIXES
from fuzzyarm.text.diagnostic import NOWHERE, Diagnostic, Severity
from fuzzyarm.text.files import write_atomically

_FIELDS = ("name", "severity", "message", "hint", "line", "column")
"""What --json tells of a finding."""

_PROGRAMS = sorted({program for programs in PRODUCERS.values() for program in programs})


def _run(arguments: argparse.Namespace) -> int:
    target = suffix_of(arguments.target)
    if _same_file(arguments.source, arguments.target):
        print_error(f"{arguments.target}: the file to read and the file to write are the same")
        return 1
    if Path(arguments.source).suffix.lower() in SUFFIXES:
        return _convert_table(arguments, target)
    imported = read(
        arguments.source,
        producer=arguments.producer,
        block=arguments.block,
        lossy=arguments.lossy,
        strict=arguments.strict,
    )
    found = list(imported.diagnostics)
    text = None
    if imported.rulebase is not None:
        exported = _exported(arguments, imported.rulebase, target)
        text = exported.text
        # A rule knows where it stood in the file that was read.
        found += [replace(d, path=arguments.source) for d in exported.diagnostics]
    if text is not None:
        write_atomically(arguments.target, text)
    _report(arguments, imported, found, written=text is not None)
    return 0 if text is not None else 1


def _same_file(source: str, target: str) -> bool:
    return os.path.exists(source) and os.path.exists(target) and os.path.samefile(source, target)


def _exported(arguments: argparse.Namespace, rulebase: RuleBase, target: str) -> Exported:
    """Write a rule base; a text of the language keeps its comments, or they are counted."""
    is_own = Path(arguments.source).suffix.lower() == ".frb"
    source = read_text(arguments.source) if is_own else ""
    if is_own and target == ".frb":
        return Exported(format_text(source, arguments.source))
    named = _named(rulebase, arguments.source)
    exported = write(
        in_tables(named) if target == ".frb" else named,
        target,
        producer=arguments.consumer,
        lossy=arguments.lossy,
        strict=arguments.strict,
    )
    comments = sum(bool(line.comment) for line in tokenize(source, []))
    if not comments:
        return exported
    message = f"{counted(comments, 'comment')} left out"
    lost = Diagnostic("dropped-comments", message, severity=Severity.INFO)
    return replace(exported, diagnostics=(lost, *exported.diagnostics))


def _convert_table(arguments: argparse.Namespace, target: str) -> int:
    """Write the nearest rules to a table and say what they leave out."""
    from fuzzyarm.table import read_table
    from fuzzyarm.table.rules import TERMS, rules_of_table

    table = read_table(arguments.source)
    name = Path(arguments.target).stem
    found = rules_of_table(table, name, terms=arguments.terms or TERMS)
    exported = write(
        found.rulebase,
        target,
        producer=arguments.consumer,
        lossy=arguments.lossy,
        strict=arguments.strict,
    )
    # A table has no order of conditions or descriptions to lose: only what changes numbers counts.
    diagnostics = [
        replace(d, path=arguments.source)
        for d in exported.diagnostics
        if d.is_error or d.severity == "warning"
    ]
    written = exported.text is not None
    if exported.text is not None:
        write_atomically(arguments.target, exported.text)
    imported = Imported(found.rulebase, (), "table")
    rules = len(found.rulebase.rules)
    if arguments.json:
        data = _as_json(arguments, imported, diagnostics, written=written)
        residual = {"worst": found.worst, "rms": found.rms}
        print_json({**data, "rules": rules, "residual": residual})
        return int(not written)
    _report(arguments, imported, diagnostics, written=written)
    if written and not arguments.quiet:
        say(
            f"what {rules} rules cannot express of {table.output}: {found.worst:.3g} at worst, "
            f"{found.rms:.3g} rms over {table.values.size} cells"
        )
    return int(not written)


def _named(rulebase: RuleBase, path: str) -> RuleBase:
    """Give a rule base without a name that of its file."""
    return rulebase if rulebase.name.strip() else replace(rulebase, name=Path(path).stem)


def _report(
    arguments: argparse.Namespace, imported: Imported, found: list[Diagnostic], *, written: bool
) -> None:
    if arguments.json:
        print_json(_as_json(arguments, imported, found, written=written), 2)
        return
    stream = sys.stdout if written else sys.stderr
    text = text_to_show(arguments.source) if found else ""
    for diagnostic in found:
        if arguments.quiet and not diagnostic.is_error:
            continue
        if diagnostic.span != NOWHERE:
            print_findings([diagnostic], text, stream)
            continue
        hint = [f"       = hint: {diagnostic.hint}"] if diagnostic.hint else []
        label = f"{diagnostic.severity}[{diagnostic.name}]"
        say(f"{diagnostic.path}: {label}: {diagnostic.message}", *hint, to_errors=not written)
    if not written:
        print_error(f"{arguments.target}: not written")
    elif not arguments.quiet:
        # Of a table the residual tells what was lost.
        summary = "" if imported.producer == "table" and not found else f", {_summary(found)}"
        say(f"{arguments.target}: written{summary}")


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
        "diagnostics": [{key: finding_data(d)[key] for key in _FIELDS} for d in found],
    }


COMMANDS = (
    command(
        "convert",
        __doc__,
        _run,
        argument("source IN", ".frb, .fll, .fcl or .fis; or a table"),
        argument("target OUT", ".frb, .fll, .fcl or .fis"),
        flag("--lossy", "go on where numbers will differ", either="mode"),
        flag("--strict", "refuse small differences too", either="mode"),
        argument("--from", "the program IN was written for", dest="producer", choices=_PROGRAMS),
        argument("--for", "the program OUT is written for", dest="consumer", choices=_PROGRAMS),
        argument("--block NAME", "which function block of an .fcl to take"),
        argument("--terms N", "number of terms of the output, where IN is a table", type=int),
        flag("--quiet -q", "print errors only"),
        json_of("what was found"),
    ),
)
