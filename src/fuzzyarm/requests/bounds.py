"""Limits of requests shared with the modules that do the work. Numbers only."""

LARGEST_RATE = 10.0
"""Largest learning rate: above it one judgement fills the table."""

MOST_PASSES = 10_000
"""Passes of a training."""

MOST_RUNS = 10_000_000
"""Runs of a sweep."""

MOST_WORKERS = 10_000

MOST_EVALS = 10_000_000
"""Candidates of a search."""

MOST_SCENARIOS = 10_000
"""Scenarios of a tuning or of a judgement."""

MOST_TUNED_DIGITS = 8
"""Digits of numbers written by tuning."""

MOST_FITTED_DIGITS = 12
"""Digits of numbers written by fitting."""

MOST_RULES = 1000
"""Rules of a fitted model: more are illegible."""
