"""How much may be asked for, where the module that does it has to know it, too. Only numbers."""

LARGEST_RATE = 10.0
"""Of learning: with more, one judgement fills the table."""

MOST_PASSES = 10_000
"""Of a training."""

MOST_RUNS = 10_000_000
"""Of a sweep."""

MOST_WORKERS = 10_000

MOST_EVALS = 10_000_000
"""Candidates of a search."""

MOST_SCENARIOS = 10_000
"""On which is tuned, or by which is judged."""

MOST_TUNED_DIGITS = 8
"""Of the numbers that tuning writes."""

MOST_FITTED_DIGITS = 12
"""Of the numbers that fitting writes."""

MOST_RULES = 1000
"""Of a model that is fitted: more of them nobody reads."""
