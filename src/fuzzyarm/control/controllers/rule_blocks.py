"""Rule bases as controllers find them: numbers for the inference kernel, written once."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.control.controllers.code import SourceError
from fuzzyarm.inference import kernel as inference_kernel
from fuzzyarm.inference.block import NotCoveredError, make_block
from fuzzyarm.inference.layout import lay_out
from fuzzyarm.inference.plan import plan
from fuzzyarm.inference.prepared import remembered
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.symbolic.kernels import address_of


class KernelRuleBlock(NamedTuple):
    """A rule base for the kernel at a point: numbers, indices of inputs and results, the kernel."""

    numbers: NDArray[np.float64]
    first_input: int
    first_result: int
    address: int


def rule_block(rulebase: RuleBase, *, compiled: bool) -> KernelRuleBlock:
    """Lay out a rule base for :func:`inference_address`; its numbers stay unchanged."""
    return _compiled_block(rulebase) if compiled else _interpreted_block(rulebase)


@remembered
def _compiled_block(rulebase: RuleBase) -> KernelRuleBlock:
    return _rule_block(rulebase, compiled=True)


@remembered
def _interpreted_block(rulebase: RuleBase) -> KernelRuleBlock:
    return _rule_block(rulebase, compiled=False)


def _rule_block(rulebase: RuleBase, *, compiled: bool) -> KernelRuleBlock:
    try:
        layout = lay_out(plan(rulebase), compiled=compiled, point_only=True)
    except NotCoveredError as error:
        raise SourceError(
            f"a controller cannot evaluate '{rulebase.name}' at every step: {error}",
            hint="compile it to a table and look it up in that",
        ) from None
    block = make_block(layout, 1)
    numbers = np.asarray(block.numbers)
    address = inference_address(numbers, compiled=compiled)
    return KernelRuleBlock(numbers, block.columns, block.results, address)


def evaluate_view(block: Any) -> None:
    """Evaluate a rule base as plain Python, over the memory view of an interpreted loop."""
    inference_kernel.evaluate(np.asanyarray(block))


def inference_address(numbers: NDArray[np.float64], *, compiled: bool) -> int:
    """Return the address of the inference kernel for a rule base."""
    if not compiled:
        return address_of(evaluate_view, 1, compiled=False)
    bindings = inference_kernel.bindings_for(numbers)
    return address_of(inference_kernel.evaluate, 1, bindings, compiled=True)
