"""Convert a rule base between .frb, .fll, .fcl and .fis, by suffix; or the systems of a script.

    fuzzyarm convert tipper.fis tipper.frb
    fuzzyarm convert robot.fcl robot.fll --from jfuzzylogic

Every loss is reported with its position in the file. Where numbers change a little (another
sampling of the defuzzifier, another treatment of values outside a range, fuzzylite's threshold of
1e-6), the file is written with a warning, and refused with --strict. A greater change is an error,
and nothing is written, unless with --lossy. After a warning the written file is read back and
compared at 100 points: the warning has the greatest difference, and beyond 1 % of the range of an
output it is an error. From .frb to .frb the text is formatted and keeps its comments; other
formats have no place for them.

    fuzzyarm convert light.fis move.fis tree.frb --connect "light/out -> move/level"

Several files become one rule base, like a `fistree` of MATLAB: --connect feeds an output of one to
an input of another, or joins two inputs. The name of a file in it is that without the suffix.

    fuzzyarm convert project.py -o rules/

A script of scikit-fuzzy, pyfuzzylite, simpful, fuzzylogic or pyit2fls is run as python does it,
with all your permissions, in its own process. Each of its fuzzy systems becomes a .frb, named after
its variable; after a timeout the systems made so far are converted. The numbers are compared with
the library's own at 100 points: they agree to 1e-9 of the range, or the greatest difference is
printed.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

from fuzzyarm.apps.cli.command import (
    FORCE,
    WordError,
    argument,
    busy,
    command,
    flag,
    group,
    json_of,
    print_error,
    print_findings,
    print_json,
    say,
)
from fuzzyarm.base.diagnostic import NOWHERE, SHORT_PROPERTIES, Diagnostic
from fuzzyarm.base.files import same_file, write_atomically
from fuzzyarm.base.jsonable import entry, json_properties
from fuzzyarm.base.numbers import counted
from fuzzyarm.base.protected import ForeignFileError
from fuzzyarm.exchange.formats import MEANINGS, PRODUCERS, Exported, Imported, read, suffix_of
from fuzzyarm.exchange.formats.conversion import converted, findings_of, written
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.language.reading import read_text, text_to_show
from fuzzyarm.table import SUFFIXES

if TYPE_CHECKING:
    from fuzzyarm.exchange.live import System

SCRIPT = ".py"
"""Suffix of scripts."""

SECONDS = 60.0
"""Default time limit of a script."""


@json_properties("source target producer written diagnostics sources?")
@dataclass(frozen=True)
class Conversion:
    """Report on a conversion."""

    source: str = entry("IN")
    target: str = entry("OUT")
    producer: str | None = entry("the program IN was read as one of")
    written: bool = entry("whether OUT was")
    diagnostics: Sequence[Diagnostic] = entry("differences", SHORT_PROPERTIES)
    sources: tuple[str, ...] = entry("of several that are connected: all of them", default=())


@dataclass(frozen=True)
class ConvertedSystem:
    """A system of a script."""

    name: str = entry("its name")
    producer: str = entry("the library")
    target: str = entry("the file")
    written: bool = entry("whether it was")
    diagnostics: Sequence[Diagnostic] = entry("differences", SHORT_PROPERTIES)


@dataclass(frozen=True)
class ScriptConversion:
    """Report on a script."""

    source: str = entry("the script")
    diagnostics: Sequence[Diagnostic] = entry("of the script as a whole", SHORT_PROPERTIES)
    systems: list[ConvertedSystem] = entry("in the order in which they were made")


_READ_AS = sorted({program for programs in MEANINGS.values() for program in programs})
_WRITTEN_FOR = sorted({program for programs in PRODUCERS.values() for program in programs})


def _run(arguments: argparse.Namespace) -> int:
    # The last name is the file to write, which argparse cannot know.
    names = [*arguments.source, *filter(None, [arguments.target])]
    *sources, last = names if len(names) > 1 else [*names, None]
    arguments.source, arguments.target = sources[0], last
    if Path(arguments.source).suffix.lower() == SCRIPT and len(sources) < 2:
        return _convert_script(arguments)
    if arguments.target is None:
        missing = "the file to write, OUT, is missing"
        if arguments.out:
            missing += f"; -o is for scripts: fuzzyarm convert {sources[0]} {arguments.out}"
        COMMANDS[0].parser().error(missing)
    target = suffix_of(arguments.target)
    if any(same_file(source, arguments.target) for source in sources):
        print_error(f"{arguments.target}: the file to read and the file to write are the same")
        return 1
    if arguments.connect or len(sources) > 1:
        return _convert_tree(arguments, sources, target)
    return _convert_one(arguments, target)


def _convert_one(arguments: argparse.Namespace, target: str) -> int:
    """Convert one file."""
    if Path(arguments.source).suffix.lower() in SUFFIXES:
        hint = f"fuzzyarm fit {arguments.source} -o {arguments.target} makes rules of it"
        raise WordError(f"{arguments.source} is a table, not a rule base", hint=hint)
    imported = read(
        arguments.source,
        producer=arguments.producer,
        block=arguments.block,
        lossy=arguments.lossy,
        strict=arguments.strict,
    )
    exported = None
    if imported.rulebase is not None:
        exported = _exported(arguments, imported.rulebase, target)
    diagnostics = findings_of(imported, exported, arguments.source)
    text = None if exported is None else exported.text
    if text is not None:
        write_atomically(arguments.target, text)
    _report(arguments, imported, diagnostics, written=text is not None)
    return 0 if text is not None else 1


def _exported(arguments: argparse.Namespace, rulebase: RuleBase, target: str) -> Exported:
    """Write a rule base; .frb preserves its comments, other formats count them as lost."""
    is_own = Path(arguments.source).suffix.lower() == ".frb"
    return converted(
        rulebase,
        arguments.source,
        target,
        read_text(arguments.source) if is_own else "",
        producer=arguments.consumer,
        lossy=arguments.lossy,
        strict=arguments.strict,
    )


def _convert_tree(arguments: argparse.Namespace, sources: Sequence[str], target: str) -> int:
    """Chain several rule bases into one and write it."""
    from fuzzyarm.exchange.formats.trees import tree

    usage = COMMANDS[0].parser().error
    if len(sources) < 2:
        usage("--connect takes two files or more, and the file to write")
    if not arguments.connect:
        usage('several files become one by connections: --connect "A/OUT -> B/IN"')
    stems = [Path(source).stem for source in sources]
    for stem in stems:
        if stems.count(stem) > 1:
            usage(f"two files are called '{stem}', and connections could mean either")
    rulebases: dict[str, RuleBase] = {}
    diagnostics: list[Diagnostic] = []
    for source, stem in zip(sources, stems, strict=True):
        imported = read(
            source,
            producer=arguments.producer,
            lossy=arguments.lossy,
            strict=arguments.strict,
        )
        diagnostics += imported.diagnostics
        if imported.rulebase is None:
            _report_of_tree(arguments, sources, diagnostics, written=False)
            return 1
        rulebases[stem] = imported.rulebase
    name = Path(arguments.target).stem
    joint = tree(rulebases, arguments.connect, name, lossy=arguments.lossy, strict=arguments.strict)
    exported = None
    if joint.rulebase is not None:
        exported = written(
            joint.rulebase,
            target,
            producer=arguments.consumer,
            lossy=arguments.lossy,
            strict=arguments.strict,
        )
    diagnostics += findings_of(joint, exported, arguments.target)
    text = None if exported is None else exported.text
    if text is not None:
        write_atomically(arguments.target, text)
    _report_of_tree(arguments, sources, diagnostics, written=text is not None)
    return int(text is None)


def _report_of_tree(
    arguments: argparse.Namespace,
    sources: Sequence[str],
    diagnostics: Sequence[Diagnostic],
    *,
    written: bool,
) -> None:
    """Print the findings of each file, then those of the connections."""
    # Rules of the tree have no position in the files: a finding about several is printed once.
    diagnostics = list(
        dict.fromkeys(replace(d, path=d.path or arguments.target) for d in diagnostics)
    )
    if arguments.json:
        words = (arguments.source, arguments.target, "tree")
        print_json(Conversion(*words, written, diagnostics, tuple(sources)), 2)
    else:
        for source in (*sources, arguments.target):
            findings = [finding for finding in diagnostics if finding.path == source]
            reported = [finding for finding in findings if finding.is_error or not arguments.quiet]
            _say_findings(reported, source, to_errors=not written)
    if not written:
        print_error(f"{arguments.target}: not written")
    elif not (arguments.quiet or arguments.json):
        say(f"{arguments.target}: written, {_summary(diagnostics)}")


# --- Scripts ---


def _convert_script(arguments: argparse.Namespace) -> int:
    """Run a script and write a rule base for each of its fuzzy systems."""
    from fuzzyarm.exchange.live import ScriptError, read_script

    source = arguments.source
    if arguments.target is not None and suffix_of(arguments.target) != ".frb":
        hint = "then convert the .frb"
        raise WordError("the systems of a script are written as .frb only", hint=hint)
    try:
        with busy(f"running {source}"):
            systems, diagnostics = read_script(
                source,
                seconds=arguments.seconds,
                python=arguments.python,
                points=arguments.points,
                lossy=arguments.lossy,
                strict=arguments.strict,
            )
    except ScriptError as error:
        if arguments.json:
            print_json(ScriptConversion(source, error.diagnostics, []), 2)
        else:
            _say_findings(error.diagnostics, source, to_errors=True)
        raise
    targets = _targets(arguments, systems)
    successes = [
        _write_system(arguments, source_system, to)
        for source_system, to in zip(systems, targets, strict=True)
    ]
    if arguments.json:
        _print_systems(arguments, systems, targets, successes, diagnostics)
        for target, is_written in zip(targets, successes, strict=True):
            if not is_written:
                print_error(f"{target}: not written")
        return int(not all(successes))
    _say_findings(diagnostics, source)
    for system, target, is_written in zip(systems, targets, successes, strict=True):
        _say_system(arguments, system, target, written=is_written)
    return int(not all(successes))


def _targets(arguments: argparse.Namespace, systems: Sequence[System]) -> list[Path]:
    """Return the file of each system: by its name in the folder of -o, or OUT for a single one."""
    if arguments.target is not None:
        if len(systems) > 1:
            names = ", ".join(system.name for system in systems)
            hint = "-o DIR writes a file for each"
            raise WordError(f"{arguments.source} makes {len(systems)}: {names}", hint=hint)
        return [Path(arguments.target)]
    folder = Path(arguments.out or ".")
    folder.mkdir(parents=True, exist_ok=True)
    return [folder / f"{system.name}.frb" for system in systems]


def _write_system(arguments: argparse.Namespace, system: System, target: Path) -> bool:
    """Write a system; replace another text only if its file was named or with --force."""
    if system.rulebase is None:
        return False
    try:
        write_atomically(target, system.text)
    except ForeignFileError as error:  # the other systems have their own files
        print_error(error)
        return False
    return True


def _say_findings(findings: Sequence[Diagnostic], source: str, *, to_errors: bool = False) -> None:
    stream = sys.stderr if to_errors else sys.stdout
    # Neighbours together: each call splits the text into lines.
    for has_position, neighbours in groupby(findings, lambda finding: finding.span != NOWHERE):
        if has_position:
            print_findings(list(neighbours), text_to_show(source), stream)
            continue
        for finding in neighbours:
            hint = [f"       = hint: {finding.hint}"] if finding.hint else []
            label = f"{finding.severity}[{finding.name}]"
            say(f"{finding.path or source}: {label}: {finding.message}", *hint, to_errors=to_errors)


def _say_system(
    arguments: argparse.Namespace, system: System, target: Path, *, written: bool
) -> None:
    diagnostics = [d for d in system.diagnostics if d.is_error or not arguments.quiet]
    origin = f"{arguments.source}: {system.name}"
    for diagnostic in diagnostics:
        hint = [f"       = hint: {diagnostic.hint}"] if diagnostic.hint else []
        line = f"{origin}: {diagnostic.severity}[{diagnostic.name}]: {diagnostic.message}"
        say(line, *hint, to_errors=not written)
    if not written:
        print_error(f"{target}: not written")
    elif not arguments.quiet:
        assert system.rulebase is not None
        rules = counted(len(system.rulebase.rules), "rule")
        lines = system.text.count("\n")
        say(f"{target}: written, {rules} of {system.library} in {lines} lines")


def _print_systems(
    arguments: argparse.Namespace,
    systems: Sequence[System],
    targets: Sequence[Path],
    written: Sequence[bool],
    diagnostics: Sequence[Diagnostic],
) -> None:
    converted = [
        ConvertedSystem(system.name, system.library, str(target), is_written, system.diagnostics)
        for system, target, is_written in zip(systems, targets, written, strict=True)
    ]
    print_json(ScriptConversion(arguments.source, diagnostics, converted), 2)


def _report(
    arguments: argparse.Namespace, imported: Imported, findings: list[Diagnostic], *, written: bool
) -> None:
    if arguments.json:
        words = (arguments.source, arguments.target, imported.producer)
        print_json(Conversion(*words, written, findings), 2)
        if not written:
            print_error(f"{arguments.target}: not written")
        return
    shown = [finding for finding in findings if finding.is_error or not arguments.quiet]
    _say_findings(shown, arguments.source, to_errors=not written)
    if not written:
        print_error(f"{arguments.target}: not written")
    elif not arguments.quiet:
        say(f"{arguments.target}: written, {_summary(findings)}")


def _summary(findings: Sequence[Diagnostic]) -> str:
    warnings = sum(d.severity == "warning" for d in findings)
    if warnings:
        return counted(warnings, "warning")
    left_out = any(d.name.startswith("dropped-") for d in findings)
    return "numbers unchanged" if left_out else "nothing lost"


COMMANDS = (
    command(
        "convert",
        __doc__,
        _run,
        argument(
            "source IN",
            ".frb, .fll, .fcl, .fis or .fml; or a script, .py; several to connect",
            nargs="+",
        ),
        argument("target OUT", ".frb, .fll, .fcl, .fis or .fml", nargs="?"),
        argument(
            "--connect CONNECTION",
            "from an output to an input, as in 'a/out -> b/in'; as often as needed",
            action="append",
        ),
        flag("--lossy", "go on where numbers will differ", either="mode"),
        flag("--strict", "refuse small differences too", either="mode"),
        argument("--from", "the program IN was written for", dest="producer", choices=_READ_AS),
        argument("--for", "the program OUT is written for", dest="consumer", choices=_WRITTEN_FOR),
        argument("--block NAME", "the function block of an .fcl"),
        flag("--quiet -q", "print errors only"),
        FORCE,
        json_of("the findings"),
        *group(
            "scripts",
            argument("-o --out DIR", "folder of the rule bases; the current one by default"),
            argument(
                "--seconds S",
                f"time for the script (default: {SECONDS:g})",
                type=float,
                default=SECONDS,
            ),
            argument("--python PATH", "run it by another Python, 3.11 or newer"),
            flag("--points", "keep scikit-fuzzy's straight lines between points"),
        ),
    ),
)
