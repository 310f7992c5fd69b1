"""The report on a rule base learned from samples: as data, and in lines."""

from __future__ import annotations

from typing import Any

from fuzzyarm.base.columns import in_columns
from fuzzyarm.base.numbers import counted, percent
from fuzzyarm.learning.data import Samples
from fuzzyarm.learning.fit import OUTER, Fit, fidelity, linear_outputs, outputs_of, score
from fuzzyarm.learning.fit_options import Options

__all__ = ["broken_off", "faithful", "report_lines", "report_of", "tested"]


def report_of(file: str, samples: Samples, fit: Fit) -> dict[str, Any]:
    """Return the result of learning as JSON data."""
    return {
        "file": file,
        "samples": len(samples),
        "inputs": list(samples.names),
        "target": samples.target,
        "classes": list(samples.classes),
        "rules": len(fit.rulebase.rules),
        "structure": fit.structure,
        "shrinkage": fit.shrinkage,
        "digits": fit.digits,
        "training": {
            "error": fit.error,
            "error_of_numbers": fit.error_of_numbers,
            "linear": fit.linear_error,
        },
        "cross_validation": {
            "error": fit.cross_validation,
            "judged": fit.judged,
            "of_the_choice": fit.choice,
            "linear": fit.linear_cross_validation,
            "candidates": [
                {"structure": words, "rules": rules, "error": error}
                for words, rules, error in fit.candidates
            ],
        },
        "support": list(fit.support),
        "interrupted": fit.interrupted,
    }


def tested(samples: Samples, fit: Fit, test: Samples) -> dict[str, Any]:
    """Return the errors on the samples of --test, beside linear regression."""
    return {
        "samples": len(test),
        "error": score(test, outputs_of(fit.rulebase, test)),
        "linear": score(test, linear_outputs(samples, test)),
    }


def faithful(samples: Samples, fit: Fit) -> dict[str, float]:
    """Return the errors against the sampled original."""
    return fidelity(fit.rulebase, samples)._asdict()


def report_lines(samples: Samples, fit: Fit, report: dict[str, Any], options: Options) -> list[str]:
    """Return a report in lines: errors beside those of linear regression."""
    kind = "wrong answers" if samples.classes else "RMS error"
    blocks = " in blocks" if options.series else ""
    nested, parts = "", options.parts
    if fit.judged == "nested":
        nested, parts = "nested ", min(parts, OUTER)
    cross = f"{nested}cross-validation, {parts} parts{blocks} (RMS)"
    rows = [("", "model", "linear regression")]
    rows.append((f"training ({kind})", *_pair(fit.error, fit.linear_error)))
    rows.append((cross, *_pair(fit.cross_validation, fit.linear_cross_validation)))
    if "test" in report:
        tested = report["test"]
        rows.append(
            (
                f"test, {counted(tested['samples'], 'sample')} ({kind})",
                *_pair(tested["error"], tested["linear"]),
            )
        )
    lines = [
        f"{report['file']}: {counted(report['rules'], 'rule')}, {fit.structure}",
        *in_columns(rows, "<>", indent="  ", least=(0, 10, 17)),
    ]
    if fit.judged == "by the choice":
        lines.append("  its structure was chosen on the same parts: on others it may be more")
    if "fidelity" in report:
        fidelity = report["fidelity"]
        worst, mean = (percent(fidelity[key], 2) for key in ("worst_share", "rms_share"))
        lines.append(
            f"  fidelity: off by at most {fidelity['worst']:.4g}, {fidelity['rms']:.4g} RMS,"
            f" {worst} and {mean} of the range"
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
