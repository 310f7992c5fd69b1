"""Inference: memberships, norms, defuzzifiers, the engines and the trace of one inference.

Importing it imports no array library; evaluating scalars does not either.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily
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
]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(
        __name__, {"engine": ("Compiled", "compiled"), "trace": ("Trace", "explain")}, __all__
    )
