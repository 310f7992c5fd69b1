"""Inference: the values of a rule base, exactly as its text defines them.

Reading order: :mod:`.plan` (a model in order of evaluation), :mod:`.block` (the picture of the one
array that a kernel reads), :mod:`.layout` and :mod:`.output_layout` (which fill it),
:mod:`.firing_strengths` and :mod:`.kernel` (a point or a row of points), then a kernel for each
family of defuzzifiers: :mod:`.closed_form` and :mod:`.centroid_kernel`, :mod:`.positions`,
:mod:`.quadrature_kernel`, :mod:`.type_reduction_kernel`. :mod:`.stages` chains
rule bases whose outputs are read by later rules, :mod:`.engine` and :mod:`.infer` are the calls,
:mod:`.trace` explains one of them.

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
