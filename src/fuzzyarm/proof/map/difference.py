"""Proved differences of two rule bases, beside the sampled ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.inference.apart import Apart, paired
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.proof.map.prover import Prover
from fuzzyarm.proof.stop import Stop

SECONDS = 10.0
"""Time budget for one output."""


def with_proofs(
    before: RuleBase, after: RuleBase, found: Sequence[Apart], *, seconds: float = SECONDS
) -> tuple[Apart, ...]:
    """Return differences with proved upper bounds, if the time suffices."""
    outputs = paired(before.outputs, after.outputs, "output")
    inputs = [one for one, _ in paired(before.inputs, after.inputs, "input")]
    if inputs != list(before.inputs):  # pieces need the inputs of both in one order
        return tuple(found)
    return tuple(
        replace(each, proved=_proved(before, after, (one.name, two.name), seconds))
        for each, (one, two) in zip(found, outputs, strict=True)
    )


def _proved(
    before: RuleBase, after: RuleBase, names: tuple[str, str], seconds: float
) -> float | None:
    stop = Stop(seconds)
    try:
        one, two = (
            Prover(model, name, stop=stop)
            for model, name in zip((before, after), names, strict=True)
        )
        bounds = two.apart(one)
    except FuzzyarmError:
        return None
    if not bounds.complete:
        return None
    return 0.0 if one.model == two.model else max(bounds.high, -bounds.low)
