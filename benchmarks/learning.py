"""Rule bases from samples beside linear regression, gradient boosting and peers.

    python benchmarks/learning.py [--data FOLDER]

Needs scikit-learn for boosting, diabetes and friedman1; anfis-toolbox and ex-fuzzy are
measured where they can be imported. FOLDER has gas_furnace.csv and mackey_glass_frbs.csv
(../shared/data by default; without it those rows are left out). All seeds are 0.

Each row: root mean square error on samples not seen, of the text as it is written, and the
seconds of processor time that learning took. "As text" is by how much rounding makes it worse.
"""

from __future__ import annotations

import importlib.util
import os
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from fuzzyarm.learning.data import Samples, as_samples, read_samples
from fuzzyarm.learning.fit import Options, fit, linear_outputs, outputs_of, rms
from tests.learning.mackey_glass import mackey_glass

warnings.simplefilter("ignore")

ROOT = Path(__file__).parents[1]


class Split(NamedTuple):
    """Samples to learn from and samples to be judged by."""

    train: Samples
    later: Samples


def has(module: str) -> bool:
    """Return whether a peer can be imported."""
    return importlib.util.find_spec(module) is not None


# --- Data ---


def own_series() -> list[Split]:
    """Return the series of Mackey and Glass, 500 and 500."""
    x, y, later_x, later_y = mackey_glass()
    return [Split(as_samples(x, y), as_samples(later_x, later_y))]


def from_file(name: str, count: int) -> list[Split]:
    """Return a file of the folder of data, split in time; nothing without the folder."""
    given = sys.argv[sys.argv.index("--data") + 1] if "--data" in sys.argv else None
    folder = Path(given or os.environ.get("FUZZYARM_DATA", ROOT.parent / "shared" / "data"))
    if not (folder / name).exists():
        print(f"{name} is not in {folder}: left out", file=sys.stderr)
        return []
    samples = read_samples(folder / name)
    rows = np.arange(len(samples))
    return [Split(samples.part(rows[:count]), samples.part(rows[count:]))]


def five_parts(inputs: Any, values: Any) -> list[Split]:
    """Return five splits of shuffled samples."""
    order = np.random.RandomState(0).permutation(len(values))
    samples = as_samples(inputs, values)
    return [
        Split(samples.part(np.setdiff1d(order, part)), samples.part(part))
        for part in np.array_split(order, 5)
    ]


def diabetes() -> list[Split]:
    """Return 442 patients in five parts."""
    from sklearn.datasets import load_diabetes  # noqa: PLC0415 - may be absent

    return five_parts(*load_diabetes(return_X_y=True))


def friedman() -> list[Split]:
    """Return 500 samples of friedman1 with noise 1 in five parts."""
    from sklearn.datasets import make_friedman1  # noqa: PLC0415 - may be absent

    return five_parts(*make_friedman1(500, noise=1.0, random_state=0))


# --- Methods ---

Method = Callable[[Split], tuple[float, str]]
"""From a split to the error on what was not seen, and a remark."""


def ours(**options: Any) -> Method:
    """Return fuzzyarm with some options."""

    def measure(split: Split) -> tuple[float, str]:
        made = fit(split.train, Options(**options))
        error = rms(split.later.outputs - outputs_of(made.rulebase, split.later))
        words = f"{len(made.rulebase.rules)} rules, cross-validation {made.cross_validation:.4g}"
        return error, f"{words} (linear {made.linear_cross_validation:.4g})"

    measure.options = options  # type: ignore[attr-defined]
    return measure


def worse_as_text(method: Method, splits: list[Split]) -> str:
    """Return by how much rounding changes the error on unseen samples, in words."""
    options = getattr(method, "options", {})
    if options.get("method") == "wang-mendel":
        return ""
    with_all_digits = ours(**options, digits=12)
    shares = [method(split)[0] / with_all_digits(split)[0] - 1.0 for split in splits]
    return f", {100.0 * max(shares):+.2g} % as text"


def linear(split: Split) -> tuple[float, str]:
    """Return linear regression."""
    return rms(split.later.outputs - linear_outputs(split.train, split.later)), ""


def boosting(split: Split) -> tuple[float, str]:
    """Return the gradient boosting of scikit-learn with its defaults."""
    from sklearn.ensemble import GradientBoostingRegressor  # noqa: PLC0415 - may be absent

    model = GradientBoostingRegressor(random_state=0)
    model.fit(split.train.inputs, split.train.values)
    return rms(split.later.values - model.predict(split.later.inputs)), "100 trees"


def anfis(split: Split) -> tuple[float, str]:
    """Return anfis-toolbox with two terms an input (four inputs at most) and its defaults."""
    from anfis_toolbox import ANFISRegressor  # noqa: PLC0415 - may be absent

    if split.train.inputs.shape[1] > 4:
        model = ANFISRegressor(n_mfs=8, init="fcm", random_state=0)
    else:
        model = ANFISRegressor(n_mfs=2, random_state=0)
    model.fit(split.train.inputs, split.train.values, verbose=False)
    found = np.asarray(model.predict(split.later.inputs)).ravel()
    return rms(split.later.values - found), "grid of 2 or 8 clusters"


def ex_fuzzy(split: Split) -> tuple[float, str]:
    """Return ex-fuzzy with 16 rules of at most four conditions."""
    from ex_fuzzy.evolutionary_fit_regression import BaseFuzzyRulesRegressor  # noqa: PLC0415 - may be absent

    model = BaseFuzzyRulesRegressor(nRules=16, nAnts=4, n_linguistic_variables=3, verbose=False)
    model.fit(split.train.inputs, split.train.values, n_gen=50, pop_size=50, random_state=0)
    found = np.asarray(model.predict(split.later.inputs)).ravel()
    return rms(split.later.values - found), "16 rules"


ROWS: tuple[
    tuple[str, Callable[[], list[Split]], tuple[tuple[str, Method, float | None], ...]], ...
] = (
    (
        "Mackey–Glass, own series 500/500",
        own_series,
        (
            ("Sugeno, structure found", ours(series=True), 0.003),
            ("Sugeno, 4 rules", ours(series=True, terms=(2, 2, 1, 1)), None),
            ("Sugeno, 4 clusters", ours(series=True, start="fcm", rules=4), None),
            ("Wang–Mendel, 7 words", ours(method="wang-mendel", words=(7, 7)), None),
            ("Wang–Mendel, 15 words", ours(method="wang-mendel", words=(15, 15)), 0.022),
        ),
    ),
    (
        "Mackey–Glass, the series of frbs 500/500",
        lambda: from_file("mackey_glass_frbs.csv", 500),
        (
            ("Sugeno, structure found", ours(series=True), 0.0015),
            ("Sugeno, 4 rules", ours(series=True, terms=(2, 2, 1, 1)), 0.005),
            ("Wang–Mendel, 15 words", ours(method="wang-mendel", words=(15, 15)), None),
        ),
    ),
    (
        "gas furnace 204/88",
        lambda: from_file("gas_furnace.csv", 204),
        (
            ("Sugeno, structure found", ours(series=True), None),
            (
                "Sugeno, 2 × 2 terms, no shrinkage",
                ours(series=True, terms=(2, 2), shrinkage=0.0),
                0.64,
            ),
            ("Wang–Mendel, 7 words", ours(method="wang-mendel"), None),
        ),
    ),
    ("diabetes, five parts", diabetes, (("Sugeno, structure found", ours(), -1.02),)),
    ("friedman1 (500, noise 1), five parts", friedman, (("Sugeno, structure found", ours(), 1.4),)),
)
"""Data → methods with what is asked of them; a negative number is times linear regression."""

OTHERS: tuple[tuple[str, Method, str], ...] = (
    ("linear regression", linear, "numpy"),
    ("gradient boosting", boosting, "sklearn"),
    ("anfis-toolbox", anfis, "anfis_toolbox"),
    ("ex-fuzzy", ex_fuzzy, "ex_fuzzy"),
)


def measured(method: Method, splits: list[Split]) -> tuple[float, float, str]:
    """Return the mean error over splits, seconds of processor time for each, a remark."""
    start = time.process_time()
    found = [method(split) for split in splits]
    seconds = (time.process_time() - start) / len(splits)
    return float(np.mean([error for error, _ in found])), seconds, found[-1][1]


def main() -> None:
    """Measure and print."""
    fit(as_samples(np.arange(20.0), np.arange(20.0) % 7))  # what is imported once
    for title, data, methods in ROWS:
        if data in {diabetes, friedman} and not has("sklearn"):
            print(f"{title}: left out, scikit-learn is not installed", file=sys.stderr)
            continue
        splits = data()
        if not splits:
            continue
        print(f"\n{title}\n")
        print("| method | test RMSE | asked | CPU s | |\n|---|---|---|---|---|")
        plain = measured(linear, splits)[0]
        for name, method, asked in methods:
            error, seconds, words = measured(method, splits)
            limit = "" if asked is None else f"≤ {asked if asked > 0 else -asked * plain:.4g}"
            words += worse_as_text(method, splits)
            row = f"| fuzzyarm: {name} | {error:.4g} | {limit} | {seconds:.2f} | {words} |"
            print(row, flush=True)
        for name, method, module in OTHERS:
            if not has(module):
                print(f"{name}: not installed", file=sys.stderr)
                continue
            try:
                error, seconds, words = measured(method, splits)
            except Exception as error_of_peer:  # whatever a peer raises is its result
                print(f"| {name} | failed: {type(error_of_peer).__name__} | | | |")
                continue
            print(f"| {name} | {error:.4g} | | {seconds:.2f} | {words} |", flush=True)


if __name__ == "__main__":
    main()
