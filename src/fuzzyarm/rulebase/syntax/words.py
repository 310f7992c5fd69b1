"""The reserved words of the language."""

from __future__ import annotations

STATEMENTS: dict[str, str] = {
    "rulebase": "the name of the rule base and what it is for",
    "input": "an input variable and its range",
    "output": "an output variable and its range",
    "terms": "evenly spaced terms of one or more variables",
    "term": "one term with its shape",
    "inference": "how rules are evaluated",
    "block": "start of a further block of rules",
    "rules": "a grid of rules",
    "rule": "one rule: if … then …",
    "lookup": "how the lookup table is sampled",
    "expect": "what must come out, checked by `fuzzyarm check`",
}
"""Words that start a statement, with one line for help."""

LOOKUP_ITEMS = ("levels", "bins", "round")
CONNECTIVES = ("if", "then", "is", "and", "or", "with", "when")
SETTINGS = (
    "and",
    "or",
    "implication",
    "aggregation",
    "defuzzifier",
    "outside",
    "no-rule",
    "threshold",
)

HEDGE_WORDS: dict[str, str] = {
    "not": "not",
    "very": "very",
    "somewhat": "somewhat",
    "more-or-less": "somewhat",
    "extremely": "extremely",
    "intensify": "intensify",
    "seldom": "seldom",
    "any": "any",
    "power": "power",
}
"""Hedges as written → the hedge they mean."""

RESERVED = frozenset({*CONNECTIVES, *HEDGE_WORDS, "inf", "nan"} - {"power"})
"""Words that a name must not be written as without quotes.

As few as possible: all others are told apart by their place. (`power` is a hedge only
before a parenthesis.)
"""

QUOTED = frozenset({*RESERVED, *STATEMENTS})
"""Words that are printed in quotes as names: at the start of a line they would mean more."""
