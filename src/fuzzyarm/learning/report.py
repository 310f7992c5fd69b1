"""The report on a rule base learned from samples: for JSON, and in lines."""

from __future__ import annotations

from dataclasses import dataclass

from fuzzyarm.base.columns import in_columns
from fuzzyarm.base.jsonable import entry, json_properties
from fuzzyarm.base.numbers import counted, percent
from fuzzyarm.learning.data import Samples
from fuzzyarm.learning.fit import OUTER, Fit, SurrogateFidelity, linear_outputs, outputs_of, score
from fuzzyarm.learning.fit_options import Options


@json_properties(
    "error=fit.cross_validation judged=fit.judged of_the_choice=fit.choice"
    " linear=fit.linear_cross_validation candidates=fit.candidates"
)
@dataclass(frozen=True)
class CrossValidation:
    """Errors on held-out samples."""

    fit: Fit


@dataclass(frozen=True)
class TestErrors:
    """Errors on the file of --test."""

    samples: int = entry("how many")
    error: float = entry("root mean square, or the share of wrong answers")
    linear: float = entry("of linear regression")


@json_properties(
    "file samples=of.__len__ inputs=of.names target=of.target classes=of.classes"
    " rules=fit.rulebase.rules.__len__ structure=fit.structure shrinkage=fit.shrinkage"
    " digits=fit.digits training=fit.training cross_validation support=fit.support"
    " interrupted=fit.interrupted test? fidelity?"
)
@dataclass(frozen=True)
class FitReport:
    """Report on a rule base learned from samples."""

    of: Samples
    fit: Fit
    file: str = entry("the written file")
    fidelity: SurrogateFidelity | None = entry(
        "where the samples are a model: how far the rules are from it", default=None
    )
    test: TestErrors | None = entry("errors on the file of --test", default=None)

    @property
    def cross_validation(self) -> CrossValidation:
        """Errors on held-out samples."""
        return CrossValidation(self.fit)


def tested(samples: Samples, fit: Fit, test: Samples) -> TestErrors:
    """Return the errors on the samples of --test, beside linear regression."""
    linear = score(test, linear_outputs(samples, test))
    return TestErrors(len(test), score(test, outputs_of(fit.rulebase, test)), linear)


def report_lines(report: FitReport, options: Options) -> list[str]:
    """Return a report in lines: errors beside those of linear regression."""
    samples, fit = report.of, report.fit
    kind = "wrong answers" if samples.classes else "RMS error"
    blocks = " in blocks" if options.series else ""
    nested, parts = "", options.parts
    if fit.judged == "nested":
        nested, parts = "nested ", min(parts, OUTER)
    parts = min(parts, len(samples))
    cross = f"{nested}cross-validation, {parts} parts{blocks} (RMS)"
    rows = [("", "model", "linear regression")]
    rows.append((f"training ({kind})", *_pair(fit.error, fit.linear_error)))
    rows.append((cross, *_pair(fit.cross_validation, fit.linear_cross_validation)))
    if test := report.test:
        label = f"test, {counted(test.samples, 'sample')} ({kind})"
        rows.append((label, *_pair(test.error, test.linear)))
    lines = [
        f"{report.file}: {counted(len(fit.rulebase.rules), 'rule')}, {fit.structure}",
        *in_columns(rows, "<>", indent="  ", least=(0, 10, 17)),
    ]
    coefficients = len(fit.rulebase.rules) * (len(samples.names) + 1)
    if options.method != "wang-mendel" and coefficients > len(samples):
        lines.append(
            f"  {counted(len(samples), 'sample')} cannot determine the {coefficients} coefficients"
            " of its conclusions"
        )
    if fit.judged == "by the choice":
        lines.append("  its structure was chosen on the same parts: on others it may be more")
    if of := report.fidelity:
        lines.append(
            f"  fidelity: off by at most {of.worst:.4g}, {of.rms:.4g} RMS,"
            f" {percent(of.worst_share, 2)} and {percent(of.rms_share, 2)} of the range"
        )
    if fit.structure == "linear":
        lines.append("  no terms earned their rules: the model is linear regression")
    elif fit.cross_validation > fit.linear_cross_validation:
        lines.append("  linear regression is better on samples not seen")
    return lines


def broken_off(limits: tuple[str, ...]) -> str:
    """Describe the parts left out because of Ctrl-C or the deadline."""
    why = "time ran out" if "time" in limits else "interrupted"
    if "search" in limits:
        return f"{why}: the best so far is written"
    return f"{why}: the model is written, and its error is that by which it was chosen"


def _pair(model: float, linear: float) -> tuple[str, str]:
    return f"{model:.4g}", f"{linear:.4g}"
