"""Numerical comparison of a rule base with another program, at representative points.

:func:`compare` works on the results of another library; :func:`measure` reads a written text back,
with the meaning of its target program.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import islice, product

from fuzzyarm.base.diagnostic import Diagnostic, Severity
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.exchange.formats.dialects import FCL, FIS, FLL, FML
from fuzzyarm.exchange.formats.findings import Exported, Findings
from fuzzyarm.exchange.formats.registry import parse
from fuzzyarm.language.model.rulebase import Input, Output, RuleBase

SAME = 1e-9
"""Equality tolerance, as a share of the output's range."""

SLIGHT = 1e-2
"""Limit between warning and error, as a share of the output's range."""

Measured = Sequence[tuple[Mapping[str, float], Mapping[str, float] | None]]
"""Points with the library's outputs there; None after an exception."""

# --- Points ---

POINTS = 100
"""Number of points of a comparison."""

_BEYOND = 0.1
"""Distance beyond the range of an input at some points, as a share of its width."""


def comparison_points(rulebase: RuleBase, beyond: float = _BEYOND) -> list[dict[str, float]]:
    """Return points of the inputs: corners, the centre, then spread over the ranges and beyond.

    A low-discrepancy sequence, so that any first part of it is evenly spread too: the additive
    recurrence of the generalised golden ratio (M. Roberts, *The Unreasonable Effectiveness of
    Quasirandom Sequences*, 2018).
    """
    inputs = rulebase.inputs
    count = len(inputs)
    shares = [tuple(map(float, corner)) for corner in islice(product((0, 1), repeat=count), 16)]
    shares.append((0.5,) * count)
    ratio = 2.0
    for _ in range(50):
        ratio = (1.0 + ratio) ** (1.0 / (count + 1))
    while len(shares) < POINTS:
        number = len(shares)
        past = 2 * beyond * (number % 8 == 0)
        row = ((0.5 + number * ratio ** -(k + 1)) % 1.0 for k in range(count))
        shares.append(tuple(share * (1.0 + past) - 0.5 * past for share in row))
    return [
        {v.name: _between(v, share) for v, share in zip(inputs, row, strict=True)}
        for row in shares
    ]  # fmt: skip


def _between(variable: Input, share: float) -> float:
    if variable.outside == "error":
        share = min(1.0, max(0.0, share))
    if share in (0.0, 1.0):
        return variable.high if share else variable.low
    return variable.low + share * (variable.high - variable.low)


# --- Outputs of a library beside ours ---


def compare(
    rulebase: RuleBase,
    results: Measured,
    library: str,
    *,
    lossy: bool = False,
    strict: bool = False,
) -> tuple[Diagnostic, ...]:
    """Return a finding for each output: the same numbers, or the greatest difference.

    Parameters
    ----------
    rulebase : RuleBase
        Our rule base.
    results : sequence of (mapping, mapping or None)
        Points, and the outputs of the library's object there; None after an exception.
    library : str
        Name of the library, for messages.
    lossy, strict : bool
        Allow a difference beyond 1 % of the range; refuse a smaller one.
    """
    findings = Findings(lossy=lossy, strict=strict)
    answered = [(point, numbers) for point, numbers in results if numbers is not None]
    if len(answered) < len(results):
        message = (
            f"{library} raises an error at {len(results) - len(answered)} of {len(results)} points"
        )
        findings.info("not-compared", message)
    if not answered:
        findings.warn("not-compared", f"the numbers were not compared with those of {library}")
        return findings.all()
    try:
        ours = _our_numbers(rulebase, [point for point, _ in answered])
    except FuzzyarmError as error:
        findings.warn("not-compared", f"the numbers were not compared: {error}")
        return findings.all()
    for output in rulebase.outputs:
        theirs = [numbers.get(output.name, math.nan) for _, numbers in answered]
        _compare_output(
            output, [p for p, _ in answered], theirs, ours[output.name], library, findings
        )
    return findings.all()


def _our_numbers(
    rulebase: RuleBase, points: Sequence[Mapping[str, float]]
) -> dict[str, list[float]]:
    """Return our outputs at points, NaN without a value."""
    import numpy as np

    from fuzzyarm.inference import infer

    # An error or a held value would end the comparison; NaN matches an output that the
    # library leaves out.
    outputs = tuple(
        replace(output, no_rule=math.nan) if isinstance(output.no_rule, str) else output
        for output in rulebase.outputs
    )
    part = replace(rulebase, outputs=outputs, expectations=(), properties=())
    columns = {
        variable.name: np.array([p[variable.name] for p in points]) for variable in rulebase.inputs
    }
    results = infer(part, columns)
    return {name: np.broadcast_to(values, len(points)).tolist() for name, values in results.items()}


def _compare_output(
    output: Output,
    points: Sequence[Mapping[str, float]],
    theirs: Sequence[float],
    ours: Sequence[float],
    library: str,
    findings: Findings,
) -> None:
    gaps = [abs(a - b) for a, b in zip(theirs, ours, strict=True)]
    alone = [i for i, (a, b) in enumerate(zip(theirs, ours, strict=True))
             if math.isnan(a) != math.isnan(b)]  # fmt: skip
    where = max(range(len(gaps)), key=lambda i: -1.0 if math.isnan(gaps[i]) else gaps[i])
    width = output.high - output.low
    width = width if math.isfinite(width) else max(1.0, abs(theirs[where]))
    share = 0.0 if math.isnan(gaps[where]) else gaps[where] / width
    if alone:
        at = _at(points[alone[0]])
        mine = "here" if math.isnan(theirs[alone[0]]) else f"in {library}"
        message = (
            f"'{output.name}' has a value only {mine} at {len(alone)} of {len(points)} points, "
            f"as at {at}"
        )
        findings.loss("numbers-differ", message, slight=len(alone) <= SLIGHT * len(points))
    if share <= SAME:
        message = f"'{output.name}' is that of {library} at {len(points)} points"
        findings.info("same-numbers", f"{message}, within {SAME:g} of its range")
        return
    message = (
        f"'{output.name}' differs by up to {share:.2g} of its range at {len(points)} points: "
        f"{theirs[where]:.6g} in {library}, {ours[where]:.6g} here, at {_at(points[where])}"
    )
    findings.loss("numbers-differ", message, slight=share <= SLIGHT)


def _at(point: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value:.4g}" for name, value in point.items())


# --- A written text beside its rule base ---

_PROGRAMS = {
    **{dialect.producer: dialect.program for dialect in (FLL, FML, *FCL.values(), *FIS.values())},
    "fuzzyarm": "the written file",
}


def measure(
    rulebase: RuleBase,
    exported: Exported,
    suffix: str,
    *,
    producer: str | None = None,
    lossy: bool = False,
    strict: bool = False,
) -> Exported:
    """Return a written text with its numerical differences, if its writer warns of anything."""
    if exported.text is None or all(
        d.severity is not Severity.WARNING for d in exported.diagnostics
    ):
        return exported
    found = [
        finding
        for finding in _measured(
            rulebase, exported.text, suffix, producer, lossy=lossy, strict=strict
        )
        if finding.severity is not Severity.INFO
    ]
    text = None if any(finding.is_error for finding in found) else exported.text
    return Exported(text, (*exported.diagnostics, *found))


def figures_of(
    rulebase: RuleBase, text: str, suffix: str, producer: str | None
) -> list[Diagnostic]:
    """Return the differences of a lossy text as remarks, for the decision to write it."""
    return [
        replace(found, message=f"with --lossy {found.message}", severity=Severity.INFO, hint="")
        for found in _measured(rulebase, text, suffix, producer, lossy=True, strict=False)
    ]


def _measured(
    rulebase: RuleBase, text: str, suffix: str, producer: str | None, *, lossy: bool, strict: bool
) -> tuple[Diagnostic, ...]:
    findings = Findings(lossy=lossy, strict=strict)
    imported = parse(text, suffix, producer=producer, lossy=True)
    written = imported.rulebase
    if written is None or not _is_like(rulebase, written):
        findings.warn("not-compared", "the numbers of the written text were not compared")
        return findings.all()
    points = comparison_points(rulebase, beyond=0.0)
    names = [variable.name for variable in written.inputs]
    renamed = [dict(zip(names, point.values(), strict=True)) for point in points]
    try:
        ours, theirs = _our_numbers(rulebase, points), _our_numbers(written, renamed)
    except FuzzyarmError as error:
        findings.warn("not-compared", f"the numbers were not compared: {error}")
        return findings.all()
    # An error or a held value cannot be compared.
    columns = {
        output.name: [
            math.nan if math.isnan(a) else b
            for a, b in zip(ours[output.name], theirs[other.name], strict=True)
        ]
        for output, other in zip(rulebase.outputs, written.outputs, strict=True)
    }
    results = [
        (point, {name: values[i] for name, values in columns.items()})
        for i, point in enumerate(points)
    ]
    return compare(rulebase, results, _PROGRAMS[imported.producer], lossy=lossy, strict=strict)


def _is_like(one: RuleBase, other: RuleBase) -> bool:
    """Whether a rule base and its written text have equally many variables, of finite ranges."""
    counts = [(len(each.inputs), len(each.outputs)) for each in (one, other)]
    return counts[0] == counts[1] and all(
        math.isfinite(v.low) and math.isfinite(v.high) for v in one.inputs
    )
