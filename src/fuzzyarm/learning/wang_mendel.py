"""Rules over words from samples (L.-X. Wang, J. M. Mendel, 1992).

Every variable is divided into the same words, evenly. Each sample proposes the rule of its words of
highest membership; among proposals with the same antecedent the one with the largest degree, the
product of all its memberships, stays. One pass, no optimisation: such rules read well and are right
to about half a word.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.diagnostic import MAX_RULES
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.language.declarations import even_shapes
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Expression,
    Input,
    Is,
    Rule,
    RuleBase,
    RuleBlock,
    Term,
)
from fuzzyarm.learning.data import Samples
from fuzzyarm.learning.model_text import (
    WritingStyle,
    middle_of,
    outer_range,
    term_names,
    weighted_output,
)
from fuzzyarm.learning.sugeno import Array

FEWEST_WORDS, MOST_WORDS = 2, 99


class WordsError(FuzzyarmError, ValueError):
    """Words that cannot be made, or too many rules of them."""


class Proposals(NamedTuple):
    """The rules that samples propose.

    Attributes
    ----------
    antecedents : ndarray of int, shape (rules, inputs)
        Index of the word of each input, in the order of a grid.
    conclusions : ndarray of int, shape (rules,)
        Index of the word of the output.
    support : ndarray of int, shape (rules,)
        Samples with that antecedent.
    """

    antecedents: NDArray[np.intp]
    conclusions: NDArray[np.intp]
    support: NDArray[np.intp]


def proposals(
    inputs: Array, outputs: Array, ranges: list[tuple[float, float]], words: int
) -> Proposals:
    """Return the rules of samples.

    Parameters
    ----------
    inputs : ndarray, shape (samples, inputs)
        Inputs of the samples.
    outputs : ndarray, shape (samples,)
        Output of the samples.
    ranges : list of (float, float)
        Ranges of the inputs, then of the output.
    words : int
        Words of each variable.
    """
    low, high = np.array(ranges).T
    position = (np.column_stack([inputs, outputs]) - low) / (high - low) * (words - 1)
    nearest = np.clip(np.rint(position), 0, words - 1).astype(np.intp)
    # Positions are in units of the spacing of terms, where a triangle of half overlap is
    # 1 - |position - peak|: the nearest peak is the term of largest membership. The degree of a
    # rule is the product over its inputs and its output.
    degree = np.prod(1.0 - np.abs(position - nearest), axis=1)
    # Rows are ordered by antecedent, then degree: the last of each antecedent stays. (`lexsort`
    # takes its primary key last; it is stable, so of equal degrees the later sample wins.)
    order = np.lexsort((degree, *nearest[:, :-1].T[::-1]))
    ordered = nearest[order]
    last = np.append(np.any(np.diff(ordered[:, :-1], axis=0), axis=1), True)
    ends = np.flatnonzero(last)
    support = np.diff(np.append(-1, ends))
    return Proposals(ordered[ends, :-1], ordered[ends, -1], support)


def wang_mendel(
    samples: Samples, words: int, layout: WritingStyle
) -> tuple[RuleBase, NDArray[np.intp]]:
    """Return the rule base of Wang and Mendel, and the support of each rule.

    Parameters
    ----------
    samples : Samples
        With a target of numbers.
    words : int
        Words of each variable.
    layout : WritingStyle
        Names.

    Raises
    ------
    WordsError
        If there are too few or too many words, or too many rules.
    """
    if not FEWEST_WORDS <= words <= MOST_WORDS:
        raise WordsError(f"number of words must be {FEWEST_WORDS} to {MOST_WORDS}, not {words}")
    if samples.classes:
        message = (
            f"Wang and Mendel's rules need a target of numbers, and '{samples.target}' has words"
        )
        raise WordsError(message)
    columns = [*samples.inputs.T, samples.values]
    ranges = [outer_range(float(column.min()), float(column.max()), 4) for column in columns]
    proposal = proposals(samples.inputs, samples.values, ranges, words)
    if len(proposal.support) > MAX_RULES:
        message = f"{len(proposal.support):,} rules are too many"
        raise WordsError(message, hint=f"at most {MAX_RULES:,}: use fewer words")
    names = term_names(words)

    def terms(low: float, high: float) -> tuple[Term, ...]:
        shapes = even_shapes("triangles", words, low, high)
        return tuple(Term(name, shape) for name, shape in zip(names, shapes, strict=True))

    inputs = tuple(
        Input(name, low, high, terms(low, high), outside="clamp")
        for name, (low, high) in zip(samples.names, ranges[:-1], strict=True)
    )
    low, high = ranges[-1]
    no_rule = middle_of(samples.values)
    output = weighted_output(samples.target, low, high, terms(low, high), no_rule, "clamp")
    rules = tuple(
        Rule(_antecedent(samples.names, names, row), (Consequent(output.name, names[word]),))
        for row, word in zip(
            proposal.antecedents.tolist(), proposal.conclusions.tolist(), strict=True
        )
    )
    block = RuleBlock(rules, conjunction="product")
    rulebase = RuleBase(layout.name, inputs, (output,), (block,), layout.description)
    return rulebase, proposal.support


def _antecedent(inputs: tuple[str, ...], names: tuple[str, ...], row: list[int]) -> Expression:
    parts = tuple(Is(variable, names[k]) for variable, k in zip(inputs, row, strict=True))
    parts = (*parts[-2:], *parts[:-2])  # the last two, row and column of a grid, come first
    return parts[0] if len(parts) == 1 else And(parts)
