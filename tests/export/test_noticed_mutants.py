"""Self-tests notice a constant that is off by a tenth, where it changes the output at all."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np
import pytest
from constant_mutants import mutants, noticed_by_test

from fuzzyarm import load, shipped
from fuzzyarm.cli import main

CASES = {"pd7": "u", "tipper": "tip", "fan": "speed"}
"""Rule bases with the function of their only output."""


def answers(text: str, function: str, points: list[tuple[float, ...]]) -> Iterator[float]:
    """Return what a function of a module returns at some points."""
    module: dict[str, object] = {}
    exec(compile(text, "mutant", "exec"), module)
    return (module[function](*point) for point in points)


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_a_constant_that_is_off_by_a_tenth_is_noticed(tmp_path, name):
    source, out = shipped(f"{name}.frb"), tmp_path / "made.py"
    words = ["compile", str(source), "--direct", "--precision", "float64", "-o", str(out)]
    assert main(words) == 0
    text = out.read_text()
    axes = [np.linspace(v.low, v.high, 27)[1:-1] for v in load(source).inputs]
    points = list(product(*(axis.tolist() for axis in axes)))
    right = list(answers(text, CASES[name], points))
    changed = missed = 0
    for mutant in mutants(text):
        if noticed_by_test(mutant):
            changed += 1
        elif any(
            abs(a - b) > 1e-9
            for a, b in zip(right, answers(mutant, CASES[name], points), strict=True)
        ):
            missed += 1
    assert changed > 10
    assert changed >= 0.95 * (changed + missed)
