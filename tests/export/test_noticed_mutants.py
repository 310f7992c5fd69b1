"""Self-tests notice a constant that is off by a tenth, where it changes the output at all."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np
import pytest
from constant_mutants import mutants, noticed_by_test

from fuzzyarm import load, load_controller, shipped
from fuzzyarm.apps.cli import main
from fuzzyarm.exchange.export import ControllerProgram, export_controller

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


CONTROLLERS = (
    "servo", "heater", "pid-smooth", "cartpole", "tanks", "hfie", "stfc", "ball-and-beam",
)  # fmt: skip


def driven(text: str, rows: np.ndarray) -> np.ndarray | None:
    """Return what the controller of a module drives; None where it fails."""
    module: dict[str, object] = {}
    exec(compile(text, "mutant", "exec"), module)
    controller = module["Controller"]()
    try:
        return np.array([controller.step(*row) for row in rows.tolist()], np.float64)
    except (ArithmeticError, ValueError, IndexError):
        return None


@pytest.mark.slow(seconds=20)
def test_most_constants_of_controllers_that_are_off_by_a_tenth_are_noticed(tmp_path):
    found = {}
    for name in CONTROLLERS:
        program = ControllerProgram(load_controller(shipped(f"{name}.frb")), "float64")
        ((_, text),) = export_controller(program, tmp_path / "made.py").files
        given = np.array(program.tried.vectors.inputs)
        low, high = np.nanmin(given, 0), np.nanmax(given, 0)
        draw = np.random.default_rng(5)
        rows = draw.uniform(1.3 * low - 0.3 * high, 1.3 * high - 0.3 * low, (200, low.size))
        slow = np.sin(np.arange(200)[:, None] * draw.uniform(0.05, 0.5, low.size))
        rows = np.concatenate([rows, 0.5 * (low + high) + 0.6 * (high - low) * slow])
        right, changed, missed = driven(text, rows), 0, 0
        within = 1e-9 * np.abs(right).max()
        for mutant in mutants(text):
            if noticed_by_test(mutant):
                changed += 1
            else:
                drives = driven(mutant, rows)
                same = drives is not None and np.allclose(drives, right, rtol=0.0, atol=within)
                missed += not same
        found[name] = changed, missed
    for name, (changed, missed) in found.items():
        assert changed >= 0.9 * (changed + missed), (name, changed, missed)
    changed, missed = (sum(each) for each in zip(*found.values(), strict=True))
    assert changed >= 0.95 * (changed + missed), found
