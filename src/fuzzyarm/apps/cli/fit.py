"""Learn a rule base from samples, as readable text.

DATA is a .csv or .parquet file with a row for each sample; its last column is the target
unless --target names another. A target of words is learned as classes. A table (.lut) or a
rule base is learned as well: the result is its surrogate, with its fidelity.

The model is Takagi and Sugeno's: LOW and HIGH of the relevant inputs, a linear conclusion
for each combination. Cross-validation chooses the number of terms, the shrinkage of the conclusions
towards linear regression, and whether to move the terms; with --series its folds are blocks of
time. Up to 1000 samples an outer cross-validation estimates the error of the whole procedure.
--words N gives the rules of Wang and Mendel instead. The score is that of the written file.
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
from typing import Any

from fuzzyarm.apps.cli.arguments import request_command, with_choice
from fuzzyarm.apps.cli.command import (
    EXIT_INTERRUPTED,
    FORCE,
    attempted,
    busy,
    demand_places,
    print_error,
    print_json,
    require_suffix,
    saved,
    say,
)
from fuzzyarm.requests.fields import Request, option
from fuzzyarm.requests.learn import FitRequest


@dataclass(frozen=True, kw_only=True)
class _Output(Request):
    """Output of a fit."""

    out: str = option("-o --out FILE.frb", "the rule base to write")
    json: bool = option("--json", "print the report as JSON", False)


@dataclass(frozen=True, kw_only=True)
class FitWords(FitRequest, _Output):
    """All arguments of ``fuzzyarm fit``."""


def _run(request: FitWords) -> int:
    require_suffix(request.out, (".frb",))
    demand_places(request.out)
    from fuzzyarm.base.files import write_atomically
    from fuzzyarm.learning.fit import fidelity, fit
    from fuzzyarm.learning.orders import fit_options_of, is_model, samples_of, test_samples_of
    from fuzzyarm.learning.report import FitReport, broken_off, report_lines, tested

    request = request.replaced(name=request.name or Path(request.out).stem)
    options = fit_options_of(request)
    samples = samples_of(request)
    test = test_samples_of(request, samples)
    for note in samples.notes:
        say(f"note: {note}", to_errors=True)
    with busy(f"fitting {request.data}") as tell:
        model = fit(samples, options, tell)
    file, fault = saved(request.out, lambda path: write_atomically(path, model.text))
    faults = [fault] if fault else []
    parts: dict[str, Any] = {}
    if test is not None:
        faults += attempted(lambda: parts.update(test=tested(samples, model, test)))
    if is_model(request.data):
        faults += attempted(lambda: parts.update(fidelity=fidelity(model.rulebase, samples)))
    report = FitReport(samples, model, file, **parts)
    if request.json:
        print_json(report)
    else:
        say(*report_lines(report, options))
    for sentence in faults:
        print_error(sentence)
    if model.limits:
        print_error(broken_off(model.limits))
        # The end of --time is not an interruption: the status is that of a full run.
        if "time" not in model.limits:
            return EXIT_INTERRUPTED
    return 1 if faults else 0


COMMANDS = (request_command("fit", with_choice(__doc__), _run, FitWords, FORCE),)
