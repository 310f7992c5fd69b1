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
from fuzzyarm.inference.infer import infer
from fuzzyarm.inference.scalar import prepare

__all__ = [
    "CyclicRulesError",
    "InferenceError",
    "MissingInputError",
    "NoRuleFiredError",
    "NotANumberError",
    "NothingHeldError",
    "OutsideRangeError",
    "UnknownNameError",
    "infer",
    "prepare",
]
