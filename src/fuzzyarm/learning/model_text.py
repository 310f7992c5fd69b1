"""A learned model as a rule base and as text: words for terms, numbers as short as possible.

The written numbers count: the numbers of the terms are rounded first and the consequents are
recomputed for them; a coefficient then keeps as many decimals as the error of the model needs.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fuzzyarm.base.numbers import percent
from fuzzyarm.language.check import check
from fuzzyarm.language.document import Statement, parse_document, print_document
from fuzzyarm.language.model.arrangement import cores
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Defuzzifier,
    Expression,
    Input,
    Is,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
)
from fuzzyarm.language.reading import format_text, parse
from fuzzyarm.language.rules import GridNode, RuleNode
from fuzzyarm.language.statements import TermNode
from fuzzyarm.language.tokens import Trivia
from fuzzyarm.language.writer import write
from fuzzyarm.learning.data import Samples
from fuzzyarm.learning.sugeno import Array, Premises, consequents

WORDS: dict[int, tuple[str, ...]] = {
    1: ("ANY",),
    2: ("LOW", "HIGH"),
    3: ("LOW", "MEDIUM", "HIGH"),
    4: ("VERY-LOW", "LOW", "HIGH", "VERY-HIGH"),
    5: ("VERY-LOW", "LOW", "MEDIUM", "HIGH", "VERY-HIGH"),
    6: ("VERY-LOW", "LOW", "BELOW-MEDIUM", "ABOVE-MEDIUM", "HIGH", "VERY-HIGH"),
    7: ("VERY-LOW", "LOW", "BELOW-MEDIUM", "MEDIUM", "ABOVE-MEDIUM", "HIGH", "VERY-HIGH"),
}
"""Names of terms by their number; for more see :func:`term_names`."""

SHARE_OF_ERROR = 0.1
"""Tolerance of a rounded consequent, in training errors."""


def term_names(count: int) -> tuple[str, ...]:
    """Return names for `count` terms from low to high: LOW MEDIUM HIGH, LOW4 … HIGH4."""
    if count in WORDS:
        return WORDS[count]
    half = count // 2
    low = tuple(f"LOW{k}" for k in range(half, 0, -1))
    high = tuple(f"HIGH{k}" for k in range(1, half + 1))
    return (*low, *(("MEDIUM",) if count % 2 else ()), *high)


# --- Numbers ---


def resolution(scale: float, digits: int) -> int:
    """Return the decimals that leave `digits` digits of a number of the size of `scale`."""
    if not scale > 0.0:
        return digits
    return digits - 1 - math.floor(math.log10(scale))


def round_to(value: float, decimals: int) -> float:
    """Return the nearest number with so many decimals (maybe negative); never -0."""
    return round(value, min(decimals, 300)) + 0.0


def outer_range(low: float, high: float, digits: int = 2) -> tuple[float, float]:
    """Return a range with short numbers that holds another one."""
    if not high > low:
        half = max(1.0, 0.1 * abs(low))
        low, high = low - half, high + half
    decimals = resolution(high - low, digits)
    step = 10.0**-decimals
    ends = math.floor(low / step + 1e-9) * step, math.ceil(high / step - 1e-9) * step
    return round_to(ends[0], decimals), round_to(ends[1], decimals)


def rounded_premises(premises: Premises, digits: int) -> Premises:
    """Return premises with rounded numbers, relative to their scale of change."""
    pairs = zip(premises.numbers.tolist(), premises.scale.tolist(), strict=True)
    numbers = [round_to(number, resolution(scale, digits)) for number, scale in pairs]
    return premises.with_numbers(np.array(numbers))


def rounded_consequents(weights: Array, samples: Samples, tolerance: Array) -> Array:
    """Return consequents with as many decimals as a tolerance requires.

    Parameters
    ----------
    weights : ndarray, shape (rules, outputs, inputs + 1)
        Slopes and the constant, in the units of the samples.
    samples : Samples
        Their spread determines the effect of a slope.
    tolerance : ndarray, shape (outputs,)
        Allowed change of a value.

    Returns
    -------
    ndarray
        Slopes are rounded first; each constant then makes up for them at the middle of the
        samples, and is rounded itself.
    """
    centre = samples.inputs.mean(axis=0)
    reach = np.maximum(np.abs(samples.inputs - centre).max(axis=0), 1e-300)
    values = weights.copy()
    # The roundings are independent: n of them, each within 1/√n of the tolerance.
    parts = math.sqrt(weights.shape[2])
    for k, width in enumerate(tolerance.tolist()):
        for j, far in enumerate(reach.tolist()):
            decimals = resolution(width / parts / far, 1)
            values[:, k, j] = [round_to(value, decimals) for value in weights[:, k, j].tolist()]
        constants = weights[:, k, -1] + (weights[:, k, :-1] - values[:, k, :-1]) @ centre
        decimals = resolution(width / parts, 1)
        values[:, k, -1] = [round_to(value, decimals) for value in constants.tolist()]
    return values


# --- The rule base ---


@dataclass(frozen=True)
class WritingStyle:
    """The form of a written model, apart from its numbers.

    Attributes
    ----------
    name, description : str
        Name and description of the rule base.
    outside : str
        Treatment of values outside the ranges, of inputs and outputs.
    digits : int
        Digits of the numbers of terms.
    """

    name: str = "model"
    description: str = ""
    outside: str = "extend"
    digits: int = 4


def sugeno_rulebase(
    premises: Premises, samples: Samples, shrinkage: float, error: Array, layout: WritingStyle
) -> RuleBase:
    """Return a Takagi–Sugeno model as a rule base with rounded numbers.

    Parameters
    ----------
    premises : Premises
        Terms and rules.
    samples : Samples
        For which the consequents are found.
    shrinkage : float
        Shrinkage of the consequents.
    error : ndarray, shape (outputs,)
        The error of each output, which limits the rounding of consequents.
    layout : WritingStyle
        Names and digits.
    """
    rounded = rounded_premises(premises, layout.digits)
    names = _names(rounded, samples)
    weights, scaling = consequents(rounded, samples.inputs, samples.outputs, shrinkage)
    floor = 1e-4 * scaling.range
    # Terms with more than the usual four digits need correspondingly finer consequents.
    tolerance = SHARE_OF_ERROR * np.maximum(error, floor) * 10.0 ** (4 - layout.digits)
    values = rounded_consequents(scaling.in_units(weights), samples, tolerance)
    inputs = tuple(
        _input(k, name, rounded, names, samples, layout) for k, name in enumerate(samples.names)
    )
    if not rounded.terms:  # one rule that always holds
        inputs = (replace(inputs[0], terms=(_always(),)), *inputs[1:])
    labels = [f"R{k + 1}" for k in range(len(rounded.rules))]
    outputs = tuple(
        _output(name, k, values[:, k], labels, samples, layout)
        for k, name in enumerate(output_names(samples))
    )
    terms = {
        index: Is(samples.names[term.input], name)
        for (index, term), name in zip(enumerate(rounded.terms), names, strict=True)
    }
    rules = tuple(
        Rule(
            _antecedent([terms[index] for index in rule], inputs),
            tuple(Consequent(output.name, label) for output in outputs),
        )
        for rule, label in zip(rounded.rules, labels, strict=True)
    )
    block = RuleBlock(rules, conjunction="product")
    return RuleBase(layout.name, inputs, outputs, (block,), layout.description)


def output_names(samples: Samples) -> tuple[str, ...]:
    """Return the names of the outputs of a model: the target, or its classes.

    A class named like an input gets the name of the target, too.
    """
    if not samples.classes:
        return (samples.target,)
    names = set(samples.names)
    return tuple(f"{samples.target} {name}" if name in names else name for name in samples.classes)


def _names(premises: Premises, samples: Samples) -> list[str]:
    """Return the name of each term: of one input from low to high, wherever they have moved."""
    names = [""] * len(premises.terms)
    for k in {term.input for term in premises.terms}:
        terms = {
            str(index): Term(str(index), Shape(term.kind, premises.parameters(term)))
            for index, term in enumerate(premises.terms)
            if term.input == k
        }
        variable = Input(samples.names[k], *_range(samples, k), tuple(terms.values()))
        order = cores(variable) or terms
        for index, name in zip(order, term_names(len(terms)), strict=True):
            names[int(index)] = name
    return names


def _range(samples: Samples, k: int) -> tuple[float, float]:
    column = samples.inputs[:, k]
    return outer_range(float(column.min()), float(column.max()))


def _always() -> Term:
    return Term("ANY", Shape("rectangle", (-math.inf, math.inf)))


def _input(
    k: int, name: str, premises: Premises, names: list[str], samples: Samples, layout: WritingStyle
) -> Input:
    low, high = _range(samples, k)
    terms = [
        Term(word, Shape(term.kind, premises.parameters(term)))
        for term, word in zip(premises.terms, names, strict=True)
        if term.input == k
    ]
    order = term_names(len(terms))
    terms.sort(key=lambda term: order.index(term.name))
    return Input(name, low, high, tuple(terms), outside=layout.outside)


def _output(
    name: str, k: int, values: Array, labels: Sequence[str], samples: Samples, layout: WritingStyle
) -> Output:
    targets = samples.outputs[:, k]
    low, high = outer_range(float(targets.min()), float(targets.max()))
    terms = tuple(
        Term(label, Shape("linear", tuple(row)))
        for label, row in zip(labels, values.tolist(), strict=True)
    )
    return weighted_output(name, low, high, terms, middle_of(targets), layout.outside)


def weighted_output(
    name: str, low: float, high: float, terms: tuple[Term, ...], no_rule: float, outside: str
) -> Output:
    """Return an output that averages its terms, with its value for no rule."""
    return Output(
        name,
        low,
        high,
        terms,
        outside=outside,
        aggregation="sum",
        defuzzifier=Defuzzifier("weighted-average"),
        no_rule=no_rule,
    )


def middle_of(outputs: Array) -> float:
    """Return the mean of values, with three digits of their width."""
    width = float(np.ptp(outputs)) or 1.0
    return round_to(float(outputs.mean()), resolution(width, 3))


def _antecedent(parts: list[Is], inputs: Sequence[Input]) -> Expression:
    if not parts:
        return Is(inputs[0].name, inputs[0].terms[0].name)
    # Row and column are the last two inputs, the others come before the grid.
    ordered = (*parts[-2:], *parts[:-2])
    return ordered[0] if len(ordered) == 1 else And(ordered)


# --- The text ---


def commented(
    rulebase: RuleBase,
    head: Sequence[str],
    by_term: Mapping[tuple[str, str], str],
    by_rule: Sequence[str] = (),
) -> str:
    """Return canonical text with comments.

    Rules from samples need not cover every combination of terms, for instance; an ``allow`` marks
    this as intended.
    """
    document = parse_document(write(rulebase))
    first, *others = document.statements
    lines = (*(f"# {line}".rstrip() for line in head), *first.trivia.before)
    statements = [Statement(first.node, Trivia(lines, first.trivia.behind))]
    number = 0  # of the next rule
    for statement in others:
        node = statement.node
        text = ""
        if isinstance(node, TermNode):
            text = by_term.get((node.variable, node.name), "")
        elif isinstance(node, RuleNode):
            text = by_rule[number] if number < len(by_rule) else ""
            number += 1
        elif isinstance(node, GridNode):
            number += sum(cell.term is not None for row in node.rows for cell in row.cells)
        behind = f"# {text}" if text else statement.trivia.behind
        statements.append(Statement(node, Trivia(statement.trivia.before, behind)))
    return _allowing(print_document(document._replace(statements=tuple(statements))))


MEANT = frozenset({"coverage-gap", "jump", "missing-rule"})
"""Checks that do not apply to a text derived from samples."""


def _allowing(text: str) -> str:
    """Return a text with ``allow`` comments for intended features."""
    parsed = parse(text)
    assert parsed.rulebase is not None, parsed.diagnostics
    names: dict[int, set[str]] = {}
    for diagnostic in check(parsed.rulebase, parsed.document):
        if diagnostic.name in MEANT:
            names.setdefault(diagnostic.line, set()).add(diagnostic.name)
    lines = text.split("\n")
    for number, some in names.items():
        line = lines[number - 1].partition("  #")[0]
        lines[number - 1] = f"{line}  # allow {', '.join(sorted(some))}"
    return format_text("\n".join(lines))


def rule_comments(
    rulebase: RuleBase, samples: Samples, strengths: Array, errors: Array
) -> dict[tuple[str, str], str]:
    """Return a comment for each rule with its own conclusion: support and error.

    Parameters
    ----------
    rulebase : RuleBase
        With rules that conclude R1, R2 …
    samples : Samples
        That it was learned from.
    strengths : ndarray, shape (samples, rules)
        How far each rule fires there, as a share of all.
    errors : ndarray, shape (samples, outputs)
        Errors of the rule base.
    """
    support = strengths.sum(axis=0)
    squares = strengths.T @ errors**2
    output = rulebase.outputs[0]
    return {
        (output.name, term.name): (
            f"{percent(share / len(samples), 2)} of the samples, error "
            f"{math.sqrt(float(row.mean()) / max(share, 1e-12)):.2g}"
        )
        for term, share, row in zip(output.terms, support.tolist(), squares, strict=True)
    }


def short_source(source: str) -> str:
    """Return the origin of samples without the folder."""
    return os.path.basename(source) or "arrays"
