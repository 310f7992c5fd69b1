"""Judge a rule base by samples: its error, in which regions, and which rules were tested.

DATA is a .csv or .parquet file with a column for each input of MODEL and, for errors, one
named like its output (or --target). A controller is judged by its rule base. Without a
target, as in the record of a run, only the rules are judged.

Prints the error beside that of a constant mean, the error by region (where a term of an
input holds most), calibration, and how often and how strongly each rule fires: "often" is the
share of samples with a firing strength of at least 0.01. Rules that never fire are listed.
--plot FIG draws residuals, calibration and the rules.

  fuzzyarm validate model.frb later.csv --plot residuals.png

With --columns a controller is judged by a recorded run, period by period: what it would have
driven beside what was driven, and the period from which they part. PORT is a drive, a measured
value, or reference.PORT; COLUMN is a column of the log, with or without its unit in brackets, or a
number for what did not move. An empty cell is a lost sample. The controller begins anew with the
first line; times in a column "time" or "t" must be control periods apart, else the first gap is
told. --tolerance N is how far both may be apart, in the unit of the drive. The exit status is 0
whether they part or not: "parts_at" of --json tells.

  fuzzyarm validate servo.frb log.csv --columns position=enc velocity=tacho voltage=u \
    reference.position=wanted reference.velocity=0
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

from fuzzyarm.apps.cli.command import (
    FORCE,
    WordError,
    argument,
    command,
    demand_figure,
    flag,
    json_of,
    print_json,
    say,
)
from fuzzyarm.base.columns import in_columns
from fuzzyarm.base.numbers import TIMES, counted, number_text, percent
from fuzzyarm.exchange.files import load, load_used_rules

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fuzzyarm.control.loop.recorded import Replay
    from fuzzyarm.language.model.rulebase import RuleBase
    from fuzzyarm.learning.data import Samples
    from fuzzyarm.learning.validation import Region, RuleUse, Validation

_FEW = 20
"""Rules in the list without --all."""


def _run(arguments: argparse.Namespace) -> int:
    demand_figure(arguments.plot)
    if arguments.columns:
        return _replayed(arguments)
    if arguments.tolerance is not None:
        raise WordError("--tolerance is of a recorded run, which --columns names")
    rulebase = load_used_rules(arguments.model, "validate")
    samples = _samples(rulebase, arguments)
    for note in samples.notes:
        say(f"note: {note}", to_errors=True)
    from fuzzyarm.learning.validation import validate

    validation = validate(rulebase, samples)
    if arguments.plot:
        from fuzzyarm.apps.show.figures import save_figure, validation_figure

        title = f"{rulebase.name}: {counted(validation.samples, 'sample')}"
        save_figure(validation_figure(validation, samples.target, title), arguments.plot)
    if arguments.json:
        print_json(validation.to_dict(), ascii_only=False)
    else:
        say(*_lines(validation, samples, every=arguments.all))
    return 0


def _replayed(arguments: argparse.Namespace) -> int:
    """Judge a controller by a recorded run."""
    from fuzzyarm.control.controllers.text import read_controller
    from fuzzyarm.control.loop.recorded import replay

    for name in ("plot", "all", "target"):
        if getattr(arguments, name):
            raise WordError(f"--{name} is of samples, not of a recorded run, as --columns names")
    text = read_controller(arguments.model)
    log = _Log(arguments.data, [word for words in arguments.columns for word in words])
    run = text.run()
    measured = {name: log.column(f"measured.{name}", name) for name in run.inputs}
    references = {name: log.column(f"reference.{name}") for name in run.references}
    named = {f"drive.{name}": name for name in run.drives}
    driven = {name: log.column(key, name) for key, name in named.items() if log.has(key, name)}
    if not driven:
        drives = " or ".join(f"{name}=COLUMN" for name in run.drives)
        raise WordError("no drive is named", hint=f"add  --columns {drives}")
    log.demand_all_used()
    found = replay(
        text, measured, references, driven, times=log.times(), tolerance=arguments.tolerance
    )
    if arguments.json:
        print_json(found, 2)
    else:
        say(*_replay_lines(found, text.model.period))
    return 0


class _Log:
    """Columns of a recorded run by the ports of a controller."""

    def __init__(self, path: str, words: Sequence[str]) -> None:
        from fuzzyarm.learning.data import column_names, read_columns

        self.path, self.names = path, column_names(path)
        pairs = list(map(_assigned, words))
        ports = [port for port, _ in pairs]
        for port in ports:
            if ports.count(port) > 1:
                raise WordError(f"'{port}' has two columns")
        self.given = {port: self._found(column) for port, column in pairs}
        self.used: set[str] = set()
        alone = [full for full in map(self._like, ("time", "t")) if len(full) == 1]
        self.time = alone[0][0] if alone else ""
        chosen = {column for column in self.given.values() if isinstance(column, str)}
        self.columns = read_columns(path, [*filter(None, {*chosen, self.time})])
        self.count = max(map(len, self.columns.values()), default=0)

    def _like(self, short: str) -> list[str]:
        """Return the columns of a name without its unit in brackets."""
        return [name for name in self.names if name.partition("[")[0].strip() == short]

    def _found(self, column: str) -> str | float:
        """Return the name of a column as in the file, or a number."""
        like = [column] if column in self.names else self._like(column)
        if len(like) == 1:
            return like[0]
        if not like:
            with suppress(ValueError):
                return float(column)
        what = f"{len(like)} columns" if like else "no column"
        hint = f"there are: {', '.join(like or self.names)}"
        raise WordError(f"{self.path} has {what} '{column}'", hint=hint)

    def has(self, *keys: str) -> bool:
        """Whether the log has a port, under one of its names."""
        return any(key in self.given for key in keys)

    def column(self, *keys: str) -> NDArray[np.float64]:
        """Return the values of a port, by one of its names."""
        import numpy as np

        key = next((key for key in keys if key in self.given), None)
        if key is None:
            raise WordError(f"no column is named for {keys[-1]}",
                            hint=f"add  --columns {keys[-1]}=COLUMN , or a number")  # fmt: skip
        self.used.add(key)
        column = self.given[key]
        return self.columns[column] if isinstance(column, str) else np.full(self.count, column)

    def times(self) -> NDArray[np.float64] | None:
        """Return the times of the periods, s, if the log has them in a known unit."""
        if not self.time:
            return None
        unit = self.time.partition("[")[2].rstrip("] ") or "s"
        if unit not in TIMES:
            return None
        times, per = TIMES[unit]
        return self.columns[self.time] * times / per

    def demand_all_used(self) -> None:
        """Refuse a name that is not a port."""
        if unknown := [key for key in self.given if key not in self.used]:
            raise WordError(f"the controller has no port '{unknown[0]}'")


def _assigned(word: str) -> tuple[str, str]:
    port, equals, column = word.partition("=")
    if not (port and equals and column):
        raise WordError(f"'{word}' is not PORT=COLUMN")
    return port.strip(), column.strip()


def _replay_lines(found: Replay, period: float) -> Iterator[str]:
    yield counted(found.periods, "period")
    if found.gap is not None:
        yield f"from period {found.gap} on the times are not {number_text(period)} s apart"
    for axis, count in found.skipped.items():
        if count:
            yield (
                f"axis {axis} skipped {counted(count, 'period')}: a value is not a number, or"
                " infinite where it is remembered"
            )
    for drive in found.drives:
        lost = found.periods - drive.compared
        if lost:
            yield f"{drive.drive}: not recorded in {counted(lost, 'period')}"
        if drive.parts_at is None:
            if drive.compared:
                yield f"{drive.drive}: as driven, at most {drive.worst:.3g} apart"
            continue
        yield (
            f"{drive.drive}: parts at period {drive.parts_at}"
            f" ({number_text(drive.parts_at * period)} s): would be {drive.would:.6g},"
            f" was {drive.was:.6g}; at most {drive.worst:.4g} apart, at period {drive.worst_at},"
            f" RMS {drive.rms:.4g}"
        )


def _samples(rulebase: RuleBase, arguments: argparse.Namespace) -> Samples:
    """Return the samples with the columns of the rule base."""
    from fuzzyarm.control.controllers.text import ControllerText
    from fuzzyarm.learning.data import Columns, column_names, read_samples

    inputs = tuple(variable.name for variable in rulebase.inputs)
    outputs = [output.name for output in rulebase.outputs]
    names = column_names(arguments.data)
    missing = next((name for name in inputs if name not in names), "")
    if missing and isinstance(load(arguments.model), ControllerText):
        raise WordError(
            f"{arguments.data} has no column '{missing}', an input of {rulebase.name}",
            hint="of a recorded run of a controller  --columns PORT=COLUMN  names its columns",
        )
    target = arguments.target
    if target is not None and target not in names:
        raise WordError(f"{arguments.data} has no column '{target}'")
    if target is None:
        target = next((name for name in outputs if name in names), None)
    # The last column other than an input, as in `fit`.
    if target is None and len(outputs) > 1:  # outputs are classes, their column has words
        target = next((name for name in reversed(names) if name not in inputs), None)
    if target is None:
        say(
            f"note: no column is called {' or '.join(outputs)}: rules are judged without errors",
            to_errors=True,
        )
    columns = Columns(target or outputs[0], inputs, target_needed=target is not None)
    samples = read_samples(arguments.data, columns)
    if samples.classes:
        return samples.in_classes(tuple(outputs))
    if target is not None and target not in outputs:
        if len(outputs) > 1:
            listed = ", ".join(outputs)
            raise WordError(f"'{target}' is not an output", hint=f"there are: {listed}")
        return samples.renamed(outputs[0])
    return samples


# --- Output ---


def _lines(validation: Validation, samples: Samples, *, every: bool) -> list[str]:
    lines = [*_summary(validation, samples), ""]
    if validation.calibration:
        lines += ["calibration: means of samples with predictions next to each other"]
        heads = ("samples", "predicted", "observed")
        means = [
            (str(bin_.samples), f"{bin_.predicted:.4g}", f"{bin_.observed:.4g}")
            for bin_ in validation.calibration
        ]
        lines += in_columns([heads, *means], ">", indent="  ")
        lines.append("")
    if validation.confusion:
        lines.append("answers: a row for each true class, a column for each predicted one")
        rows = zip(validation.classes, validation.confusion, strict=True)
        counts = [(name, *map(str, row)) for name, row in rows]
        lines += in_columns([("", *validation.classes), *counts], ">", indent="  ")
        lines.append("")
    lines += [*_regions(validation.regions), "", *_rules(validation, every=every)]
    return lines


def _summary(validation: Validation, samples: Samples) -> list[str]:
    lines = [counted(validation.samples, "sample")]
    if validation.silent:
        lines[0] += f", no rule fires at {validation.silent} of them: they count in no error"
    if validation.outside:
        lines.append(f"{counted(validation.outside, 'sample')} beyond the range of an input")
    if validation.classes and not math.isnan(validation.error):
        lines.append(f"wrong answers {percent(validation.error)}")
    elif validation.calibration:
        share = f"{percent(validation.explained, 4)} of the variance explained"
        if math.isnan(validation.explained):
            share = f"'{samples.target}' is constant, with no variance to explain"
        spread = float(samples.values.std())
        lines.append(
            f"RMS error {validation.error:.4g}; always giving the mean {spread:.4g}; {share}"
        )
        lines.append(
            f"bias {validation.bias:.3g}, "
            f"worst {validation.worst:.4g} at sample {validation.worst_sample}"
        )
        lines.append(_calibration_line(validation))
    return lines


def _calibration_line(validation: Validation) -> str:
    if math.isnan(validation.explained):
        return "no line of observed over predicted: the target is constant"
    if math.isnan(validation.slope):
        return "no line of observed over predicted: all predictions are equal"
    sign, size = "+-"[validation.intercept < 0.0], abs(validation.intercept)
    return f"observed = {validation.slope:.4g} × predicted {sign} {size:.4g}"


def _regions(regions: tuple[Region, ...]) -> list[str]:
    rows = [
        (
            region.input,
            region.term,
            str(region.samples),
            _figure(region.error),
            _figure(region.bias),
        )
        for region in regions
    ]
    header = ("input", "region", "samples", "error", "bias")
    table = in_columns([header, *rows], "<<>", indent="  ")
    return ["error by region: where a term holds most", *table]


def _rules(validation: Validation, *, every: bool) -> list[str]:
    firing = [rule for rule in validation.rules if not rule.never_fires]
    rules = sorted(firing, key=lambda rule: (-rule.mean, rule.number))
    uses = rules if every else rules[:_FEW]
    table = in_columns([_RULE, *map(_row, uses)], ">>>>>>.", indent="  ")
    lines = ["rules by how much they fire", *table]
    if len(uses) < len(rules):
        lines.append(f"  and {len(rules) - len(uses)} more: --all lists them")
    never = validation.never_fired
    if not never:
        return [*lines, "every rule fires at some sample"]
    lines.append(f"{counted(len(never), 'rule')} never {'fires' if len(never) == 1 else 'fire'}:")
    listed = never if every else never[:_FEW]
    lines += [f"  {rule.place}: {rule.text}" for rule in listed]
    if len(listed) < len(never):
        lines.append(f"  and {len(never) - len(listed)} more")
    return lines


_RULE = ("line", "often", "mean", "strongest", "leads", "error", "rule")


def _row(rule: RuleUse) -> tuple[str, ...]:
    return (
        rule.place.removeprefix("line "),
        percent(rule.often),
        f"{rule.mean:.3f}",
        f"{rule.strongest:.3f}",
        str(rule.leads),
        _figure(rule.error),
        rule.text,
    )


def _figure(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.3g}"


COMMANDS = (
    command(
        "validate",
        __doc__,
        _run,
        argument("model MODEL", "a rule base, or a controller that uses one"),
        argument("data DATA", "samples: .csv or .parquet"),
        argument("--target NAME", "the column with the true output"),
        argument(
            "--columns PORT=COLUMN",
            "the columns of a recorded run of a controller, or numbers",
            nargs="+",
            action="append",
        ),
        argument("--tolerance N", "how far what would be driven may be from what was", type=float),
        argument("--plot FIG", "draw residuals, calibration and rules: .png, .svg or .pdf"),
        FORCE,
        flag("--all", "list every rule"),
        json_of("the judgement"),
    ),
)
