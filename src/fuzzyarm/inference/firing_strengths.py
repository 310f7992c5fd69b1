"""Firing strengths in the kernel: of expressions in parentheses, rules and sets.

Each twice, over the rows of a program and at one point, by the same functions in the same order, so
the bits are the same. A **group** is a set with the rules that assert it in a cell; its height is
folded from their strengths.

A rule is a stretch of whole numbers: its norm, the positions of its weight and threshold in the
floats, and the row of each operand (see :mod:`fuzzyarm.inference.block`).
"""

from __future__ import annotations

from typing import Any

from fuzzyarm.inference.block import (
    GROUP_HEAD,
    HEIGHTS,
    MAX,
    MIN,
    ONES,
    OPERANDS,
    PRODUCT,
    RULE_HEAD,
    STRENGTH,
    SUM,
    TRUTH_HEAD,
    WIDTH,
    WORK,
)
from fuzzyarm.symbolic.kernels import call, kernel


@kernel
def join_expressions(k: Any, f: Any, scratch: Any, at: int, count: int) -> int:
    """Evaluate the expressions in parentheses; return the next index."""
    width = k[WIDTH]
    expressions = k[at]
    at += 1
    for _ in range(expressions):
        begin = k[at] * width
        truth = scratch[begin : begin + count]
        norm, hedges, operands = k[at + 1], k[at + 2], k[at + 3]
        at += TRUTH_HEAD
        begin = k[at] * width
        degrees = scratch[begin : begin + count]
        # The first join reads the row of an operand, later ones the truth so far.
        for operand in range(at + 1, at + operands):
            begin = k[operand] * width
            join(norm, degrees, scratch[begin : begin + count], truth)
            degrees = truth
        if hedges != 0:
            call(hedges, degrees, f[0:0], truth)
        at += operands
    return at


@kernel
def fold_heights(k: Any, f: Any, scratch: Any, at: int, fold: int, count: int) -> int:
    """Fold the strengths of the rules of each group, one row each; return the next index."""
    width = k[WIDTH]
    groups = k[at]
    at += 1
    begin = (k[WORK] + STRENGTH) * width
    strength = scratch[begin : begin + count]
    # The first strength goes into the row of the height at once; the norm is the output's, nearly
    # always max.
    for group in range(k[HEIGHTS], k[HEIGHTS] + groups):
        begin = group * width
        folded = scratch[begin : begin + count]
        rules = k[at]
        at += GROUP_HEAD
        for i in range(rules):
            fire(k, f, scratch, at, strength if i else folded)
            at += RULE_HEAD + k[OPERANDS]
            if i:
                join(fold, folded, strength, folded)
    return at


@kernel
def unite_rules(k: Any, scratch: Any, at: int, count: int) -> int:
    """As :func:`fold_heights`, for the usual grid of rules of two operands."""
    width = k[WIDTH]
    groups = k[at]
    at += 1
    for group in range(k[HEIGHTS], k[HEIGHTS] + groups):
        begin = group * width
        folded = scratch[begin : begin + count]
        rules = k[at]
        at += GROUP_HEAD
        for i in range(rules):
            begin = k[at + RULE_HEAD] * width
            one = scratch[begin : begin + count]
            begin = k[at + RULE_HEAD + 1] * width
            other = scratch[begin : begin + count]
            at += RULE_HEAD + 2
            # The first rule fills the row: no pass to clear it.
            if i:
                for point in range(count):
                    folded[point] = max(folded[point], min(one[point], other[point]))
            else:
                for point in range(count):
                    folded[point] = min(one[point], other[point])
    return at


@kernel
def fold_heights_of_point(
    k: Any, f: Any, scratch: Any, at: int, fold: int, heights: int, operands: int
) -> int:
    """Fold the strengths of the rules of each group at a point; return the next index."""
    groups = k[at]
    at += 1
    for group in range(heights, heights + groups):
        rules = k[at]
        at += GROUP_HEAD
        folded = _fired(k, f, scratch, at, operands)
        at += RULE_HEAD + operands
        for _ in range(rules - 1):
            strength = _fired(k, f, scratch, at, operands)
            folded = joined(k, scratch, fold, folded, strength)
            at += RULE_HEAD + operands
        scratch[group] = folded
    return at


@kernel
def unite_rules_of_point(k: Any, scratch: Any, at: int, heights: int, operands: int) -> int:
    """As :func:`fold_heights_of_point`, for the usual grid of rules."""
    # Reads neither norms nor weights, half of the work of a rule.
    groups = k[at]
    at += 1
    for group in range(heights, heights + groups):
        rules = k[at]
        at += GROUP_HEAD + RULE_HEAD
        folded = 0.0  # no strength is below 0
        if operands == 2:
            for _ in range(rules):
                folded = max(folded, min(scratch[k[at]], scratch[k[at + 1]]))
                at += RULE_HEAD + 2
        else:
            for _ in range(rules):
                strength = min(scratch[k[at]], scratch[k[at + 1]])
                for operand in range(at + 2, at + operands):
                    strength = min(strength, scratch[k[operand]])
                folded = max(folded, strength)
                at += RULE_HEAD + operands
        at -= RULE_HEAD
        scratch[group] = folded
    return at


@kernel
def _fired(k: Any, f: Any, scratch: Any, rule: int, operands: int) -> float:
    """Return the firing strength of a rule at a point; see :func:`fire`."""
    norm = k[rule]
    weight, threshold = f[k[rule + 1]], f[k[rule + 1] + 1]
    first = rule + RULE_HEAD
    strength: float = scratch[k[first]]
    for operand in range(min(first + 1, first + operands - 1), first + operands):
        if is_joined(norm, k[operand]):
            strength = joined(k, scratch, norm, strength, scratch[k[operand]])
    if weight != 1.0 or threshold > 0.0:
        strength = weighed(strength, weight, threshold)
    return strength


@kernel
def is_joined(norm: int, row: int) -> bool:
    """Whether an operand is real, not the filler of a rule shorter than the longest.

    The kernel's own norms keep the bits of an operand joined with a neutral one.
    """
    return row != ONES or MIN <= norm <= SUM


@kernel
def weighed(strength: float, weight: float, threshold: float) -> float:
    """Return a strength times the weight of its rule; 0 up to the threshold."""
    part = strength * weight
    return part if part > threshold else 0.0


@kernel
def joined(k: Any, scratch: Any, norm: int, a: float, b: float) -> float:
    """Return the norm of two numbers; see :func:`join`."""
    value = a
    if norm == MIN:
        value = min(a, b)
    elif norm == MAX:
        value = max(a, b)
    elif norm == PRODUCT:
        value = a * b
    elif norm == SUM:
        value = a + b
    else:  # in work rows, free until the defuzzifier
        at = k[WORK]
        scratch[at] = a
        scratch[at + 1] = b
        one, other = scratch[at : at + 1], scratch[at + 1 : at + 2]
        call(norm, one, other, scratch[0:0], one)
        value = scratch[at]
    return value


@kernel
def fire(k: Any, f: Any, scratch: Any, rule: int, strength: Any) -> None:
    """Compute the firing strength of a rule: its operands under its norm, times its weight."""
    count = strength.shape[0]
    width = k[WIDTH]
    norm = k[rule]
    weight, threshold = f[k[rule + 1]], f[k[rule + 1] + 1]
    first = rule + RULE_HEAD
    begin = k[first] * width
    degrees = scratch[begin : begin + count]
    # A rule of one operand has a neutral second one under min: the strength is always written.
    for operand in range(min(first + 1, first + k[OPERANDS] - 1), first + k[OPERANDS]):
        if is_joined(norm, k[operand]):
            begin = k[operand] * width
            join(norm, degrees, scratch[begin : begin + count], strength)
            degrees = strength
    # At weight 1 and threshold 0 this changes nothing, and most rules are so.
    if weight != 1.0 or threshold > 0.0:
        for point in range(count):
            strength[point] = weighed(strength[point], weight, threshold)


@kernel
def join(norm: int, a: Any, b: Any, into: Any) -> None:
    """Take the norm of two rows; `into` may be one of them."""
    # The choice is outside the loops: inside it would prevent their vectorisation.
    if norm == MIN:
        for point in range(into.shape[0]):
            into[point] = min(a[point], b[point])
    elif norm == PRODUCT:
        for point in range(into.shape[0]):
            into[point] = a[point] * b[point]
    elif norm == MAX:
        for point in range(into.shape[0]):
            into[point] = max(a[point], b[point])
    elif norm == SUM:
        for point in range(into.shape[0]):
            into[point] = a[point] + b[point]
    else:
        call(norm, a, b, a[0:0], into)
