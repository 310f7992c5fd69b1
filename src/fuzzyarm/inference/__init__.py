"""Inference: memberships, norms, defuzzifiers, the engines and the trace of one inference.

Importing it imports no array library; evaluating scalars does not either.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fuzzyarm.inference.errors import (
    CyclicRulesError,
    InferenceError,
    MissingInputError,
    NoRuleFiredError,
    NotANumberError,
    NothingHeldError,
    OutsideRangeError,
    UnknownNameError,
)
from fuzzyarm.inference.infer import check_expectations, infer, infer_interval
from fuzzyarm.inference.point import prepare

if TYPE_CHECKING:
    from fuzzyarm.inference.engine import Compiled, compiled
    from fuzzyarm.inference.trace import Trace, explain


__all__ = [
    "Compiled",
    "CyclicRulesError",
    "InferenceError",
    "MissingInputError",
    "NoRuleFiredError",
    "NotANumberError",
    "NothingHeldError",
    "OutsideRangeError",
    "Trace",
    "UnknownNameError",
    "check_expectations",
    "compiled",
    "explain",
    "infer",
    "infer_interval",
    "prepare",
]


def __getattr__(name: str) -> Any:
    """Import what a check does not need when it is asked for."""
    if name in {"Compiled", "compiled"}:
        from fuzzyarm.inference import engine

        return getattr(engine, name)
    if name in {"Trace", "explain"}:
        from fuzzyarm.inference import trace

        return getattr(trace, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
