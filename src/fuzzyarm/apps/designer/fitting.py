"""A rule base from samples of the folder: the report of ``fuzzyarm fit``, with residuals.

Words of a page: ``enough``, which keeps the best so far, and ``save`` with the name of a file.
"""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from fuzzyarm.apps.designer.forms import FIT
from fuzzyarm.apps.designer.grounds import FieldError, at_field
from fuzzyarm.apps.designer.jobs import WindowJob, save_beside, tell_result
from fuzzyarm.apps.designer.requests import BareMessage, FitWord, FormWork
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.files import write_atomically
from fuzzyarm.requests.learn import FitRequest

if TYPE_CHECKING:
    from fuzzyarm.base.picture import Chart
    from fuzzyarm.learning.data import Samples
    from fuzzyarm.learning.fit import Fit

SAMPLES = (".csv", ".parquet")
MODELS = (".lut", ".frb")
"""Models to approximate by a rule base."""


def fittable(session: Session, request: BareMessage, job: WindowJob) -> None:
    """Send the form, and the files to learn from."""
    models = [name for name in job.folder.listed(*MODELS) if _is_sampled(job, name)]
    here = Path(session.path).name  # without samples, the open file first
    job.tell({
        "samples": sorted(job.folder.listed(*SAMPLES), key=lambda name: -_size(job, name)),
        "models": sorted(models, key=lambda name: name != here),
        "form": FIT.fields(),
    })  # fmt: skip


def fit(session: Session, record: FormWork, job: WindowJob) -> None:
    """Learn, report, and save until the page stops."""
    if not record.form.get("data"):
        raise FieldError("choose the samples to learn from", field="data")
    request = FIT.request(record.form, Path(session.path).parent)
    named = request.name or Path(request.data).stem
    request = request.replaced(
        name=named,
        data=_file_of(job, "data", request.data, (*SAMPLES, *MODELS)),
        test=_file_of(job, "test", request.test, SAMPLES) if request.test else None,
    )
    model = _learned(request, job)
    job.tell({"name": f"{named}.frb"})
    while True:
        word = job.word(FitWord)
        if word.save is not None:
            save_beside(
                job, word.save, ".frb", lambda path: write_atomically(path, model.text),
                replace=word.replace,
            )  # fmt: skip


def _size(job: WindowJob, name: str) -> int:
    """Return the bytes of a file: one learns from the largest, and judges by a smaller one."""
    with suppress(OSError):
        return job.folder.beside(name, Path(name).suffix.lower()).stat().st_size
    return 0


def _is_sampled(job: WindowJob, name: str) -> bool:
    """Whether a file of the folder has one output over inputs, and is not a controller."""
    with suppress(FuzzyarmError, OSError):
        parsed = job.folder.session(name).reading.parsed
        return getattr(parsed, "rulebase", None) is not None or name.lower().endswith(".lut")
    return False


def _file_of(job: WindowJob, field: str, name: str, suffixes: tuple[str, ...]) -> str:
    if name not in job.folder.listed(*suffixes):
        raise FieldError(f"'{name}' is not a file of samples in this folder", field=field)
    return str(job.folder.beside(name, Path(name).suffix.lower()))


def _learned(request: FitRequest, job: WindowJob) -> Fit:
    """Learn, and send the result."""
    from fuzzyarm.learning.fit import fidelity
    from fuzzyarm.learning.fit import fit as fit_it
    from fuzzyarm.learning.orders import fit_options_of, is_model, samples_of, test_samples_of
    from fuzzyarm.learning.report import FitReport, broken_off, report_lines, tested

    with at_field("time" if request.time else "words" if request.words else "terms"):
        options = fit_options_of(request)
    with at_field("inputs" if request.inputs else "target" if request.target else "data"):
        samples = samples_of(request)
    with at_field("test"):
        test = test_samples_of(request, samples)
    with at_field("terms" if request.terms and len(samples) > 1 else "data"):
        model = fit_it(samples, options, _Teller(job))
    report = FitReport(
        samples,
        model,
        f"{request.name}.frb",
        fidelity(model.rulebase, samples) if is_model(request.data) else None,
        None if test is None else tested(samples, model, test),
    )
    lines = [*samples.notes, *report_lines(report, options)]
    if model.limits:
        lines.append(broken_off(model.limits))
    # Their paths are those of this machine.
    lines = [line.replace(f"{Path(request.data).parent}{os.sep}", "") for line in lines]
    tell_result(job, lines, [_chart(model, test or samples, on_test=test is not None)])
    return model


class _Teller:
    """Progress of learning; the user may end it, which keeps the best."""

    def __init__(self, job: WindowJob) -> None:
        self.job = job

    def __call__(self, words: str) -> None:
        if any(word.enough for word in self.job.heard(FitWord)):
            raise KeyboardInterrupt
        self.job.paced_progress(words)
        self.job.check()


def _chart(model: Fit, samples: Samples, *, on_test: bool) -> Chart:
    from fuzzyarm.apps.show.validation import validation_chart
    from fuzzyarm.learning.validation import validate

    title = "on the samples of Test" if on_test else "on what it was learned from"
    return validation_chart(validate(model.rulebase, samples), samples.target, title)
