"""The cost of a period of a controller: arithmetic operations, counted from its instructions.

Two programs are counted. The kernel of the closed loop evaluates only the rules that can fire in
the cell of the inputs: least and most over all cells. The exported program has every rule in a row;
its count is an upper bound of a call.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from typing import NamedTuple

from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.exchange.export.listing import operations_of
from fuzzyarm.exchange.export.rulebase import DirectRoutine
from fuzzyarm.exchange.export.steps import Ask, Find, Set, Step, Steps, Teach
from fuzzyarm.exchange.export.walk_of_steps import steps_of
from fuzzyarm.inference import block as at
from fuzzyarm.inference.block import Layout
from fuzzyarm.inference.layout import lay_out
from fuzzyarm.inference.plan import plan
from fuzzyarm.inference.programs import CLOSED, SAMPLES, WEIGHTED
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.symbolic.kernels import address_of

SUMS, PRODUCTS, QUOTIENTS = "additions and subtractions", "multiplications", "divisions"
COMPARISONS = "comparisons"

Operations = Counter[str]


class StepCost(NamedTuple):
    """Arithmetic operations of one period, by their sort.

    Attributes
    ----------
    least, most : Counter of str
        Of the kernel: where fewest and where most rules can fire. A curved term, a norm other
        than min, max, product and sum, and an integration of sets count as one operation of
        that name.
    exported : Counter of str or None
        Of the exported program, at most; None for loops of a defuzzifier without a known bound.
    """

    least: Operations
    most: Operations
    exported: Operations | None


def step_cost(text: ControllerText) -> StepCost:
    """Count the operations of a controller's period.

    Parameters
    ----------
    text : ControllerText
        Without partners.

    Returns
    -------
    StepCost
        Minimum, maximum and absolute value count as comparisons; indices of tables do not
        count.

    Raises
    ------
    ExportError
        If the controller cannot be exported.

    Examples
    --------
    >>> from fuzzyarm import load, shipped
    >>> cost = step_cost(load(shipped("stfc.frb")))
    >>> cost.least["divisions"], cost.most["divisions"]
    (6, 6)
    """
    steps = steps_of(text)
    least, most, exported = Operations(), Operations(), Operations()
    counted: set[tuple[str, tuple[str, ...]]] = set()
    bounded = True
    for step in steps.steps:
        if isinstance(step, Ask) and isinstance(steps.routines[step.routine], DirectRoutine):
            routine = steps.routines[step.routine]
            assert isinstance(routine, DirectRoutine)
            exported += routine.listing.operations()
            bounded = bounded and not routine.cost().unbounded
            # The kernel finds all outputs of a rule base at once.
            key = (routine.rulebase.name, step.inputs)
            if key not in counted:
                counted.add(key)
                low, high = rule_cost(routine.rulebase)
                least, most = least + low, most + high
            continue
        low, high = _cost(step, steps)
        least, most, exported = least + low, most + high, exported + high
    return StepCost(least, most, exported if bounded else None)


def _cost(step: Step, steps: Steps) -> tuple[Operations, Operations]:
    """Return the least and greatest cost of a step."""
    if isinstance(step, Set):
        return operations_of(step.value, least=True), operations_of(step.value)
    if isinstance(step, Ask):
        operations = Operations(dict(steps.routines[step.routine].cost().operations))
        del operations["index multiplications"]
        return operations, operations
    if isinstance(step, Find):
        sizes = [len(thresholds) for _, thresholds in steps.grids[step.grid]]
        operations = Operations({COMPARISONS: sum(math.ceil(math.log2(n + 1)) for n in sizes)})
        return operations, operations
    if isinstance(step, Teach):
        operations = Operations({SUMS: 1, PRODUCTS: 1, COMPARISONS: 4})
        return Operations({COMPARISONS: 2}), operations
    return Operations(), Operations()


# --- The kernel of inference ---

_NORMS = {at.MIN: COMPARISONS, at.MAX: COMPARISONS, at.PRODUCT: PRODUCTS, at.SUM: SUMS}

_LOCATE = Operations({COMPARISONS: 8, SUMS: 1, PRODUCTS: 1})
"""To find the cell of an input: clamped, checked, by its bucket, and two edges."""

_LINE = Operations({SUMS: 2, PRODUCTS: 1, COMPARISONS: 1})
_LAYER = Operations({SUMS: 6, PRODUCTS: 5, COMPARISONS: 3})
_SAMPLE = Operations({SUMS: 2, PRODUCTS: 2})
_MEAN = Operations({SUMS: 1, QUOTIENTS: 1})
_SETTLE = Operations({COMPARISONS: 4})


def rule_cost(rulebase: RuleBase) -> tuple[Operations, Operations]:
    """Return the least and greatest cost of the kernel at a point."""
    layout = lay_out(plan(rulebase), compiled=False)
    costs = list(_Programs(layout).costs())
    return min(costs, key=lambda cost: cost.total()), max(costs, key=lambda cost: cost.total())


class _Programs:
    """The programs of a block; see :mod:`fuzzyarm.inference.block` for how they lie."""

    def __init__(self, layout: Layout) -> None:
        self.k, self.f, self.count = layout.whole, layout.floats, layout.programs
        self.kinds = {
            address_of(program.block, 1, compiled=False): program
            for program in (CLOSED, SAMPLES["gravity"], WEIGHTED)
        }

    def costs(self) -> Iterator[Operations]:
        """Yield the operations of each program."""
        for program in range(self.count):
            yield self._cost(self.k[self.k[at.PROGRAMS_AT] + program])

    def _cost(self, here: int) -> Operations:
        k, total = self.k, Operations()
        # In the order in which a program lies in memory; `here` goes along it.
        for i in range(k[at.INPUTS]):
            head = at.HEAD + at.INPUT_HEAD * i
            total += _times(_LOCATE, 1) + _times(_LINE, k[here + 1])
            total += Operations({"curved terms": k[head + at.CURVES]})
            here += 2
        expressions, here = k[here], here + 1
        for _ in range(expressions):
            norm, hedges, operands = k[here + 1 : here + at.TRUTH_HEAD]
            total += _norm(norm, operands - 1) + Operations({"hedges": int(hedges != 0)})
            here += at.TRUTH_HEAD + operands
        head = k[at.OUTPUTS_AT]
        for _ in range(k[at.OUTPUTS]):
            output_cost, here = self._output(here, head)
            total += output_cost
            head += at.OUTPUT_HEAD
        return +total

    def _output(self, here: int, head: int) -> tuple[Operations, int]:
        k, total, fold = self.k, Operations(), self.k[head + at.AGGREGATION]
        groups, here = k[here], here + 1
        consequents = []
        for _ in range(groups):
            rules = k[here]
            consequents.append(k[here + 1])
            here += at.GROUP_HEAD
            total += _norm(fold, rules - 1)
            for _ in range(rules):
                weight, threshold = self.f[k[here + 1]], self.f[k[here + 1] + 1]
                total += _norm(k[here], max(1, k[at.OPERANDS] - 1))
                if weight != 1.0 or threshold > 0.0:
                    total += Operations({PRODUCTS: 1, COMPARISONS: 1})
                here += at.RULE_HEAD + k[at.OPERANDS]
        kind = self.kinds.get(k[head + at.DEFUZZIFIER])
        if kind is CLOSED:
            closed_cost, here = self._closed(here)
            total += closed_cost
        elif kind is SAMPLES["gravity"]:
            total += self._sampled(consequents, fold)
        elif kind is WEIGHTED:
            linear = k[head + at.DETAIL]
            counts = Operations({COMPARISONS: 1, SUMS: 2 + linear, PRODUCTS: 1 + linear})
            total += _times(counts, groups)
        else:
            total += Operations({"integrations": 1})
        return total + _SETTLE + _times(_MEAN, int(k[head + at.IS_MEAN] != 0)), here

    def _closed(self, here: int) -> tuple[Operations, int]:
        # As `closed_centroid` reads them: unions, each a count and its rows; then terms.
        unions, here = self.k[here], here + 1
        others = 0
        for _ in range(unions):
            others += self.k[here]
            here += 1 + self.k[here]
        terms = self.k[here]
        return Operations({COMPARISONS: others}) + _times(_LAYER, terms), here + 1 + 3 * terms

    def _sampled(self, consequents: list[int], fold: int) -> Operations:
        """Cut and fold each set over its stretch of samples, and add up from first to last."""
        total = Operations({COMPARISONS: len(consequents)})
        ends = [(self.k[consequent], self.k[consequent + 1]) for consequent in consequents]
        for consequent, (begin, end) in zip(consequents, ends, strict=True):
            total += _norm(self.k[consequent + 3], end - begin) + _norm(fold, end - begin)
        if ends:
            first, last = min(begin for begin, _ in ends), max(end for _, end in ends)
            total += _times(_SAMPLE, last - first)
        return total


def _norm(norm: int, times: int) -> Operations:
    return Operations({_NORMS.get(norm, "norms"): times})


def _times(operations: Operations, times: int) -> Operations:
    return Operations({sort: count * times for sort, count in operations.items()})
