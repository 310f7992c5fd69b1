"""Inference: memberships, norms, defuzzifiers, the engines and the trace of one inference.

Importing it imports no array library; evaluating scalars does not either.
"""

from __future__ import annotations

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
from fuzzyarm.inference.expectations import check_expectations
from fuzzyarm.inference.infer import infer
from fuzzyarm.inference.scalar import prepare
from fuzzyarm.inference.trace import Trace, explain

__all__ = [
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
    "explain",
    "infer",
    "prepare",
]
