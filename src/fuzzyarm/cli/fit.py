"""Learn a rule base from samples, and get a text that a person can read.

DATA is a .csv or .parquet file with a row for each sample; its last column is the target
unless --target names another. A target of words is learned as classes. A table (.lut) or a
rule base is learned as well: the result is its surrogate, with its fidelity.

The model is Takagi and Sugeno's: LOW and HIGH of the inputs that matter, a linear conclusion
for each combination. Cross-validation decides how many terms there are, how far conclusions
are shrunk towards linear regression, and whether moving the terms pays; with --series its
parts are blocks of time. Up to 1000 samples a second one around all of it judges what came of
it. --words N gives the rules of Wang and Mendel instead. What is written is scored as written.
Ctrl-C keeps the best so far (exit status 130), and so does the end of --time.

Examples
--------
  fuzzyarm fit data.csv -o model.frb
  fuzzyarm fit series.csv --series --rules 8 --test later.csv -o model.frb
  fuzzyarm fit data.csv --words 3..9 -o words.frb
  fuzzyarm fit rulebases/thesis-6.1.lut -o surrogate.frb
"""

from __future__ import annotations

import argparse
import math
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.api import load_sheet
from fuzzyarm.cli.command import (
    EXIT_INTERRUPTED,
    WordError,
    argument,
    attempted,
    busy,
    command,
    counted,
    demand_places,
    flag,
    group,
    json_of,
    out,
    print_error,
    print_json,
    require_suffix,
    saved,
    say,
)
from fuzzyarm.text.columns import in_columns
from fuzzyarm.text.folders import READABLE

if TYPE_CHECKING:
    from fuzzyarm.learning.data import Samples
    from fuzzyarm.learning.fit import Fit, Options

_OF_MODELS = (*READABLE, ".lut", ".json", ".npz")
"""Suffixes of what is sampled rather than read as samples."""


def _run(arguments: argparse.Namespace) -> int:
    require_suffix(arguments.out, (".frb",))
    demand_places(arguments.out)
    options = _options(arguments)
    samples = _samples(arguments)
    test = _test(arguments, samples)
    for note in samples.notes:
        say(f"note: {note}", to_errors=True)
    from fuzzyarm.learning.fit import fit
    from fuzzyarm.text.files import write_atomically

    with busy(f"fitting {arguments.data}") as tell:
        made = fit(samples, options, tell)
    file, fault = saved(arguments.out, lambda path: write_atomically(path, made.text))
    arguments.out = file
    faults = [fault] if fault else []
    report = _report(arguments, samples, made)
    if test is not None:
        faults += attempted(lambda: report.update(test=_tested(samples, made, test)))
    if _is_model(arguments.data):
        faults += attempted(lambda: report.update(fidelity=_fidelity(samples, made)))
    if arguments.json:
        print_json(report)
    else:
        say(*_lines(samples, made, report, options))
    for each in faults:
        print_error(each)
    if made.limits:
        print_error(_broken_off(made.limits))
        if "time" not in made.limits:
            return EXIT_INTERRUPTED
    return 1 if faults else 0


# --- Words ---


def _options(arguments: argparse.Namespace) -> Options:
    from fuzzyarm.learning.fit import Options
    from fuzzyarm.loop.reference import read_time

    words = _words(arguments.words) if arguments.words else Options.words
    name = arguments.name or Path(arguments.out).stem
    if arguments.words and (arguments.terms or arguments.start != "grid"):
        raise WordError("--words is for Wang and Mendel's rules, --terms and --start are not")
    return Options(
        method="wang-mendel" if arguments.words else "sugeno",
        start=arguments.start,
        rules=arguments.rules,
        terms=_numbers(arguments.terms, "--terms") if arguments.terms else None,
        words=words,
        shrinkage=arguments.shrink,
        move={"yes": True, "no": False, "auto": None}[arguments.move],
        merge=arguments.merge,
        series=arguments.series,
        parts=arguments.folds,
        digits=arguments.digits,
        outside=arguments.outside or ("clamp" if _is_model(arguments.data) else "extend"),
        seed=arguments.seed,
        nested={"yes": True, "no": False, "auto": None}[arguments.nested],
        seconds=read_time(arguments.time, "--time") if arguments.time else math.inf,
        name=name,
    )


def _words(text: str) -> tuple[int, int]:
    """Return the range in ``7`` or ``3..15``."""
    low, dots, high = text.partition("..")
    try:
        return int(low), int(high if dots else low)
    except ValueError:
        raise WordError(f"--words takes a number or a range such as 3..15, not '{text}'") from None


def _numbers(text: str, option: str) -> tuple[int, ...]:
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise WordError(f"{option} takes numbers such as 2,2,1, not '{text}'") from None


# --- Samples ---


def _samples(arguments: argparse.Namespace) -> Samples:
    path: str = arguments.data
    if _is_model(path):
        return _samples_of_model(path, arguments)
    from fuzzyarm.learning.data import Columns, read_samples

    inputs = tuple(arguments.inputs.split(",")) if arguments.inputs else None
    return read_samples(path, Columns(arguments.target, inputs))


def _is_model(path: str) -> bool:
    return os.path.splitext(path)[1].lower() in _OF_MODELS


def _samples_of_model(path: str, arguments: argparse.Namespace) -> Samples:
    from fuzzyarm.learning.data import rulebase_samples, table_samples
    from fuzzyarm.model.rulebase import RuleBase

    if arguments.inputs:
        raise WordError("--inputs is for samples: a surrogate has the inputs of what it stands for")
    model = load_sheet(path)
    if isinstance(model, RuleBase):
        return rulebase_samples(model, arguments.target, seed=arguments.seed, source=path)
    return table_samples(model, path)


def _test(arguments: argparse.Namespace, samples: Samples) -> Samples | None:
    if not arguments.test:
        return None
    from fuzzyarm.learning.data import Columns, read_samples

    test = read_samples(arguments.test, Columns(samples.target, samples.names))
    return test.in_classes(samples.classes)


# --- What is printed ---


def _report(arguments: argparse.Namespace, samples: Samples, made: Fit) -> dict[str, Any]:
    """Return what was learned as JSON data."""
    return {
        "file": arguments.out,
        "samples": len(samples),
        "inputs": list(samples.names),
        "target": samples.target,
        "classes": list(samples.classes),
        "rules": len(made.rulebase.rules),
        "structure": made.structure,
        "shrinkage": made.shrinkage,
        "digits": made.digits,
        "training": {
            "error": made.error,
            "error_of_numbers": made.error_of_numbers,
            "linear": made.linear_error,
        },
        "cross_validation": {
            "error": made.cross_validation,
            "judged": made.judged,
            "of_the_choice": made.choice,
            "linear": made.linear_cross_validation,
            "candidates": [
                {"structure": words, "rules": rules, "error": error}
                for words, rules, error in made.candidates
            ],
        },
        "support": list(made.support),
        "interrupted": made.interrupted,
    }


def _tested(samples: Samples, made: Fit, test: Samples) -> dict[str, Any]:
    """Return how it does on the samples of --test, beside linear regression."""
    from fuzzyarm.learning.fit import linear_outputs, outputs_of, score

    return {
        "samples": len(test),
        "error": score(test, outputs_of(made.rulebase, test)),
        "linear": score(test, linear_outputs(samples, test)),
    }


def _fidelity(samples: Samples, made: Fit) -> dict[str, float]:
    from fuzzyarm.learning.fit import fidelity

    return fidelity(made.rulebase, samples)._asdict()


def _lines(samples: Samples, made: Fit, report: dict[str, Any], options: Options) -> list[str]:
    from fuzzyarm.learning.fit import OUTER

    kind = "wrong answers" if samples.classes else "RMS error"
    blocks = " in blocks" if options.series else ""
    nested, parts = "", options.parts
    if made.judged == "nested":
        nested, parts = "nested ", min(parts, OUTER)
    cross = f"{nested}cross-validation, {parts} parts{blocks} (RMS)"
    rows = [("", "model", "linear regression")]
    rows.append((f"training ({kind})", *_pair(made.error, made.linear_error)))
    rows.append((cross, *_pair(made.cross_validation, made.linear_cross_validation)))
    if "test" in report:
        tested = report["test"]
        rows.append(
            (
                f"test, {counted(tested['samples'], 'sample')} ({kind})",
                *_pair(tested["error"], tested["linear"]),
            )
        )
    lines = [
        f"{report['file']}: {counted(report['rules'], 'rule')}, {made.structure}",
        *in_columns(rows, "<>", indent="  ", least=(0, 10, 17)),
    ]
    if made.judged == "by the choice":
        lines.append("  its structure was chosen on the same parts: on others it may be more")
    if "fidelity" in report:
        told = report["fidelity"]
        worst, mean = (f"{100.0 * told[key]:.2g} %" for key in ("worst_share", "rms_share"))
        lines.append(
            f"  fidelity: off by at most {told['worst']:.4g}, {told['rms']:.4g} RMS,"
            f" {worst} and {mean} of the range"
        )
    if made.structure == "linear":
        lines.append("  no terms earned their rules: the model is linear regression")
    elif made.cross_validation > made.linear_cross_validation:
        lines.append("  linear regression is better on samples not seen")
    return lines


def _broken_off(limits: tuple[str, ...]) -> str:
    """Say what Ctrl-C, or the end of the time, has left out."""
    why = "the time is over" if "time" in limits else "interrupted"
    if "search" in limits:
        return f"{why}: the best so far is written"
    return f"{why}: the model is written, and its error is that by which it was chosen"


def _pair(model: float, linear: float) -> tuple[str, str]:
    return f"{model:.4g}", f"{linear:.4g}"


COMMANDS = (
    command(
        "fit",
        __doc__,
        _run,
        argument("data DATA", "samples (.csv, .parquet), or a table or rule base to stand for"),
        out("FILE.frb", "where to write the rule base"),
        argument("--target NAME", "the column to learn; the last one by default"),
        argument("--inputs A,B,...", "the columns to learn from; all others by default"),
        argument("--test FILE", "samples to be judged by, beside linear regression"),
        flag("--series", "the samples are in the order of time: cross-validate in blocks"),
        argument("--name NAME", "name of the rule base; by default that of the file"),
        json_of("the report"),
        *group(
            "the model",
            argument("--rules N", "largest number of rules", type=int, default=16),
            argument(
                "--start",
                "where the partition starts from",
                choices=("grid", "fcm", "subtractive"),
                default="grid",
            ),
            argument("--terms N,N,...", "number of terms of each input, instead of a search"),
            argument(
                "--shrink L", "shrinkage of conclusions, instead of a search; 0 is none", type=float
            ),
            argument(
                "--move",
                "move the terms (by variable projection); auto: where it pays",
                choices=("auto", "yes", "no"),
                default="auto",
            ),
            argument(
                "--merge S",
                "likeness of clusters' terms that become one, 0 to 1",
                type=float,
                default=0.7,
            ),
            argument("--words N[..N]", "Wang and Mendel's rules over so many words"),
            argument(
                "--digits N", "significant digits of the numbers of terms", type=int, default=4
            ),
            argument(
                "--outside",
                "what happens beyond the ranges: extend, of a surrogate clamp",
                choices=("extend", "clamp", "error"),
            ),
        ),
        *group(
            "the search",
            argument("--folds N", "parts of the cross-validation", type=int, default=5),
            argument(
                "--nested",
                "go the whole way again without each part, to judge it; auto: up to 1000 samples",
                choices=("auto", "yes", "no"),
                default="auto",
            ),
            argument("--time TIME", "at most so long, as in 90s or 10min; the best until then"),
            argument("--seed N", "seed of everything that is drawn", type=int, default=0),
        ),
    ),
)
