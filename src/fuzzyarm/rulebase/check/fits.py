"""Outputs whose defuzzifier cannot work on their terms."""

from __future__ import annotations

from collections.abc import Iterator

from fuzzyarm.rulebase.check.subject import Subject
from fuzzyarm.rulebase.diagnostic import Diagnostic
from fuzzyarm.rulebase.model import Output
from fuzzyarm.rulebase.shapes import SHAPES

_WEIGHTED = ("weighted-average", "weighted-sum")
_MONOTONIC = ("ramp", "sigmoid", "s", "z", "concave", "arc")


def find(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``defuzzifier-does-not-fit`` and ``mixed-output-terms``."""
    for output in subject.rulebase.outputs:
        yield from _values(output)
        yield from _mixture(output)
        if output.defuzzifier.method == "tsukamoto":
            yield from _monotonic(output)


def _values(output: Output) -> Iterator[Diagnostic]:
    values = [term for term in output.terms if not SHAPES[term.shape.kind].fuzzy]
    method = output.defuzzifier.method
    if values and method not in (*_WEIGHTED, "tsukamoto"):
        yield Diagnostic(
            "defuzzifier-does-not-fit",
            f"'{values[0].name}' of '{output.name}' is a value, not a set; {method} needs sets",
            values[0].span,
            hint="use weighted-average or weighted-sum",
        )


def _mixture(output: Output) -> Iterator[Diagnostic]:
    if output.defuzzifier.method in (*_WEIGHTED, "tsukamoto"):
        return
    spikes = [term for term in output.terms if term.shape.kind == "singleton"]
    if spikes and len(spikes) < len(output.terms):
        yield Diagnostic(
            "mixed-output-terms",
            f"'{output.name}' mixes singletons with sets that have an area;"
            f" '{spikes[0].name}' would carry no weight in the {output.defuzzifier.method}",
            spikes[0].span,
        )


def _monotonic(output: Output) -> Iterator[Diagnostic]:
    for term in output.terms:
        if SHAPES[term.shape.kind].fuzzy and term.shape.kind not in (*_MONOTONIC, "singleton"):
            yield Diagnostic(
                "defuzzifier-does-not-fit",
                f"tsukamoto needs monotonic terms; '{term.name}' of '{output.name}' is a"
                f" {term.shape.kind}",
                term.span,
            )
            return
