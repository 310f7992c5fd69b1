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

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.arguments import request_command, with_choice
from fuzzyarm.cli.command import (
    EXIT_INTERRUPTED,
    attempted,
    busy,
    counted,
    demand_places,
    print_error,
    print_json,
    require_suffix,
    saved,
    say,
)
from fuzzyarm.requests.fields import Request, option
from fuzzyarm.requests.learn import FitRequest
from fuzzyarm.text.columns import in_columns
from fuzzyarm.text.numbers import percent

if TYPE_CHECKING:
    from fuzzyarm.learning.data import Samples
    from fuzzyarm.learning.fit import Fit
    from fuzzyarm.learning.fit_options import Options


@dataclass(frozen=True, kw_only=True)
class _Output(Request):
    """What a command prints and writes of a model."""

    out: str = option("-o --out FILE.frb", "where to write the rule base")
    json: bool = option("--json", "print the report as JSON", False)


@dataclass(frozen=True, kw_only=True)
class FitWords(FitRequest, _Output):
    """All that ``fuzzyarm fit`` takes."""


def _run(asked: FitWords) -> int:
    require_suffix(asked.out, (".frb",))
    demand_places(asked.out)
    from fuzzyarm.learning.asked import is_model, options_asked, samples_asked, test_asked
    from fuzzyarm.learning.fit import fit
    from fuzzyarm.text.files import write_atomically

    asked = asked.replaced(name=asked.name or Path(asked.out).stem)
    options = options_asked(asked)
    samples = samples_asked(asked)
    test = test_asked(asked, samples)
    for note in samples.notes:
        say(f"note: {note}", to_errors=True)
    with busy(f"fitting {asked.data}") as tell:
        model = fit(samples, options, tell)
    file, fault = saved(asked.out, lambda path: write_atomically(path, model.text))
    faults = [fault] if fault else []
    report = _report(file, samples, model)
    if test is not None:
        faults += attempted(lambda: report.update(test=_tested(samples, model, test)))
    if is_model(asked.data):
        faults += attempted(lambda: report.update(fidelity=_fidelity(samples, model)))
    if asked.json:
        print_json(report)
    else:
        say(*_lines(samples, model, report, options))
    for sentence in faults:
        print_error(sentence)
    if model.limits:
        print_error(_broken_off(model.limits))
        # The end of --time was asked for: the status is that of a whole run.
        if "time" not in model.limits:
            return EXIT_INTERRUPTED
    return 1 if faults else 0


# --- What is printed ---


def _report(file: str, samples: Samples, made: Fit) -> dict[str, Any]:
    """Return what was learned as JSON data."""
    return {
        "file": file,
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
        worst, mean = (percent(told[key], 2) for key in ("worst_share", "rms_share"))
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


COMMANDS = (request_command("fit", with_choice(__doc__), _run, FitWords),)
