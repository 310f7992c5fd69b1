"""Report how a folder of .fll, .fcl and .fis files comes in.

For every file: whether it imports, what was found in it, and, where a reference with the
outputs of another program is at hand, whether its rule base gives the same to 1e-6. A
reference is NAME.json in the folder given by --reference (by default `reference` beside
the files); docs/reference/formats.md tells what is in it.

    python tools/corpus.py DIR [--reference DIR] [--verbose] [--json]
"""

from __future__ import annotations

import argparse
import json
import math
import re
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from fuzzyarm.exchange.formats import FOREIGN, MEANINGS, Imported, read
from fuzzyarm.inference import InferenceError, compiled
from fuzzyarm.language.model.rulebase import RuleBase

# --- Reference outputs of other programs, and whether a rule base gives the same ---
#
# A reference is a JSON file `NAME.json` for the rule file `NAME`: one object with
# `inputs` (rows of numbers) and `outputs` (rows of numbers, null for no value), maybe
# `input_names` and `output_names` (else both are in the order of the file). Other keys
# that begin with `outputs_` name their program: `outputs_octave_toolkit_1001pts` is
# Octave's at 1001 points. `blocks` lists several such objects, one for each function block,
# with a `name`.

TOLERANCE = 1e-6
"""Largest relative difference that counts as equal."""

FLOOR = 1e-9
"""Absolute difference below which two values are equal, for outputs around zero."""

_FILES = (*FOREIGN, ".t2fis", ".fml")
_PROGRAMS = ("octave", "fuzzylite", "matlab", "jfuzzylogic")
_IGNORED = re.compile(r"outputs_resolution_\d+\Z")


@dataclass(frozen=True, slots=True)
class Reference:
    """One program's outputs for one file, row by row; NaN where there is no value."""

    program: str  # octave, fuzzylite and so on; empty where the file does not say
    block: str | None  # the function block of an FCL file
    resolution: int | None  # samples, where it was not the program's usual number
    input_names: tuple[str, ...] | None  # None: in the order of the file
    output_names: tuple[str, ...] | None
    inputs: tuple[tuple[float, ...], ...]
    outputs: tuple[tuple[float, ...], ...]


def read_references(path: Path) -> list[Reference]:
    """Return the references in a JSON file.

    Raises
    ------
    OSError
        If it cannot be read.
    ValueError
        If it is not such a file.
    """
    data = json.loads(path.read_text(encoding="utf-8"))
    if not isinstance(data, dict):
        raise ValueError(f"{path}: a reference is a JSON object")
    found: list[Reference] = []
    for part in data.get("blocks", [data]):
        columns = [k for k in part if k.startswith("outputs") and not _IGNORED.match(k)]
        found += [_reference(part, key, named="blocks" in data) for key in columns]
    return found


def _reference(part: Mapping[str, Any], key: str, *, named: bool) -> Reference:
    program = next((name for name in _PROGRAMS if name in key), "")
    points = re.search(r"_(\d+)pts", key)
    names = part.get("input_names")
    results = part.get("output_names") if key == "outputs" else None
    return Reference(
        program,
        part.get("name") if named else None,
        int(points.group(1)) if points else None,
        None if names is None else tuple(names),
        None if results is None else tuple(results),
        tuple(tuple(map(float, row)) for row in part["inputs"]),
        tuple(tuple(map(_number, row)) for row in part[key]),
    )


def _number(value: float | str | None) -> float:
    return math.nan if value is None else float(value)


def _sampled(rulebase: RuleBase, resolution: int | None) -> RuleBase:
    if resolution is None:
        return rulebase
    outputs = tuple(
        output
        if output.defuzzifier.resolution is None
        else replace(output, defuzzifier=replace(output.defuzzifier, resolution=resolution))
        for output in rulebase.outputs
    )
    return replace(rulebase, outputs=outputs)


def worst_difference(rulebase: RuleBase, reference: Reference) -> float:
    """Return the greatest relative difference to a reference, over all points and outputs.

    An output that holds has no value before; a value where there should be none, or none
    where there should be one, is an infinite difference.

    Raises
    ------
    InferenceError
        If the rule base cannot be evaluated.
    """
    prepared = compiled(_sampled(rulebase, reference.resolution))
    inputs = reference.input_names or tuple(v.name for v in rulebase.inputs)
    outputs = reference.output_names or tuple(o.name for o in rulebase.outputs)
    held = {output.name: math.nan for output in rulebase.outputs}
    worst = 0.0
    for row, expected in zip(reference.inputs, reference.outputs, strict=True):
        try:
            found = prepared.evaluate(dict(zip(inputs, row, strict=True)), held)
        except (KeyError, ValueError) as error:
            raise InferenceError(str(error)) from error
        values = [found[name] for name in outputs]
        worst = max([worst, *map(difference, values, expected)])
    return worst


def difference(found: float, expected: float) -> float:
    """Return the relative difference of two values; infinite where one has none."""
    if math.isnan(found) or math.isnan(expected):
        return 0.0 if math.isnan(found) and math.isnan(expected) else math.inf
    if found == expected or abs(found - expected) < FLOOR:
        return 0.0
    if math.isinf(found) or math.isinf(expected):
        return math.inf
    return abs(found - expected) / max(abs(found), abs(expected))


@dataclass(slots=True)
class Row:
    """What became of one file."""

    file: str  # its path within the folder
    format: str  # its suffix
    imported: bool  # whether there was no error
    producer: str  # the program whose defaults were taken
    findings: dict[str, int]  # name of a diagnostic → how often
    first: str = ""  # the first error
    references: int = 0  # reference columns at hand
    matched: int = 0  # how many of them the rule base equals at all points
    differences: dict[str, str] = field(default_factory=dict)
    """Program of each reference that is missed → greatest relative difference, or why."""

    @property
    def equal(self) -> bool:
        """Whether every reference is met at all points."""
        return self.references > 0 and self.matched == self.references


def survey(folder: Path, reference: Path | None = None) -> list[Row]:
    """Read every file in `folder` and compare it with its reference.

    Parameters
    ----------
    folder : Path
        Searched with its subfolders.
    reference : Path, optional
        Where the references are; by default ``reference`` in `folder` or beside it.
    """
    if not folder.is_dir():
        raise NotADirectoryError(20, "not a folder", str(folder))
    candidates = (folder / "reference", folder.parent / "reference")
    where = reference or next((c for c in candidates if c.is_dir()), None)
    files = sorted(p for p in folder.rglob("*") if p.suffix.lower() in _FILES and p.is_file())
    return [_row(path, folder, where) for path in files]


def _row(path: Path, folder: Path, where: Path | None) -> Row:
    imported = read(path)
    row = Row(
        str(path.relative_to(folder)),
        path.suffix.lower(),
        imported.rulebase is not None,
        imported.producer,
        dict(Counter(d.name for d in imported.diagnostics)),
        str(imported.errors[0]) if imported.errors else "",
    )
    file = where / f"{path.name}.json" if where is not None else None
    if imported.rulebase is not None and file is not None and file.is_file():
        for reference in read_references(file):
            _compare(row, path, reference)
    return row


def _compare(row: Row, path: Path, reference: Reference) -> None:
    row.references += 1
    imported = _as_read_by(path, reference)
    name = reference.program or imported.producer
    if imported.rulebase is None:
        row.differences[name] = "not imported"
        return
    try:
        worst = worst_difference(imported.rulebase, reference)
    except InferenceError as error:
        row.differences[name] = str(error)
        return
    if worst <= TOLERANCE:
        row.matched += 1
    else:
        row.differences[name] = f"{worst:.2g}"


def _as_read_by(path: Path, reference: Reference) -> Imported:
    """Read a file with the defaults of the program that made the reference."""
    known = MEANINGS.get(path.suffix.lower(), ())
    producer = reference.program if reference.program in known else None
    return read(path, producer=producer, block=reference.block)


def summary(rows: list[Row]) -> dict[str, dict[str, int]]:
    """Return the counts of each format and of all."""
    totals: dict[str, dict[str, int]] = {}
    for kind in [*dict.fromkeys(row.format for row in rows), "all"]:
        of_kind = [row for row in rows if kind in (row.format, "all")]
        compared = [row for row in of_kind if row.references]
        totals[kind] = {
            "files": len(of_kind),
            "imported": sum(row.imported for row in of_kind),
            "diagnosed": sum(not row.imported for row in of_kind),
            "compared": len(compared),
            "matched": sum(row.equal for row in compared),
        }
    return totals


def _print(rows: list[Row], *, verbose: bool) -> None:
    for row in rows:
        if not row.imported:
            print(f"{row.file}: not imported: {row.first}")
        elif row.differences:
            said = ", ".join(f"{program}: {why}" for program, why in row.differences.items())
            print(f"{row.file}: differs from {said}")
        elif verbose:
            state = "equal" if row.equal else "imported"
            print(f"{row.file}: {state} ({row.producer})")
    columns = ("files", "imported", "diagnosed", "compared", "matched")
    print(f"{'':>6}" + "".join(f"{column:>11}" for column in columns))
    for kind, counts in summary(rows).items():
        print(f"{kind:>6}" + "".join(f"{counts[column]:>11}" for column in columns))


def main(words: Sequence[str] | None = None) -> int:
    """Run the script; 0 = fine, 1 = no such folder or nothing in it."""
    parser = argparse.ArgumentParser(description="how a folder of other programs' files comes in")
    parser.add_argument("folder", metavar="DIR", type=Path, help="where the files are")
    parser.add_argument("--reference", metavar="DIR", type=Path, help="where the references are")
    parser.add_argument("-v", "--verbose", action="store_true", help="a line for every file")
    parser.add_argument("--json", action="store_true", help="print the report as JSON")
    arguments = parser.parse_args(words)
    try:
        rows = survey(arguments.folder, arguments.reference)
    except OSError as error:
        print(f"{error.filename}: {error.strerror}", file=sys.stderr)
        return 1
    if not rows:
        print(f"{arguments.folder}: no {', '.join(_FILES)} files in there", file=sys.stderr)
        return 1
    if arguments.json:
        report = {"summary": summary(rows), "files": [asdict(row) for row in rows]}
        print(json.dumps(report, indent=2))
    else:
        _print(rows, verbose=arguments.verbose)
    return 0


if __name__ == "__main__":
    sys.exit(main())
