"""Self-tests notice a constant that is off by a tenth, where it changes the output at all."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from budget import part
from constant_mutants import mutants, noticed_by_test

from fuzzyarm import load, load_controller, shipped
from fuzzyarm.exchange.export import (
    ControllerProgram,
    export_controller,
    export_files,
    routines_of,
)
from fuzzyarm.exchange.files import controller_if_any

SHIPPED = Path(shipped("pd7.frb")).parent
EXAMPLES = SHIPPED.parent / "examples"
FILES = [
    path
    for folder in (SHIPPED, EXAMPLES)
    for path in sorted(folder.rglob("*.frb"))
    if "\npartner " not in path.read_text() and path.name not in ("carl.frb", "hidden.frb")
]
"""All but those with a partner, which are not exported, a submission with a mistake, and lines for
the grader alone."""

Run = Callable[[str], Iterator[list[float]]]
"""From the text of a module to its answers, one row at a time; it may fail at any."""

ONE_LIMIT = {"manual-heater": (4, 2), "cascade-servo": (13, 2)}
"""Controllers whose integral comes to its lower limit alone in 200 periods: known misses, with the
mutants that are noticed and missed."""

_FAULTS = (ArithmeticError, ValueError, IndexError)


def controller_module(path: Path, folder: Path) -> tuple[str, Run]:
    """Return a controller as a module, and how it is driven: by jumps, then slowly."""
    program = ControllerProgram(load_controller(path), "float64")
    ((_, text),) = export_controller(program, folder / "made.py").files
    given = np.array(program.tried.vectors.inputs)
    low, high = np.nanmin(given, 0), np.nanmax(given, 0)
    draw = np.random.default_rng(5)
    rows = draw.uniform(1.3 * low - 0.3 * high, 1.3 * high - 0.3 * low, (200, low.size))
    slow = np.sin(np.arange(200)[:, None] * draw.uniform(0.05, 0.5, low.size))
    rows = np.concatenate([rows, 0.5 * (low + high) + 0.6 * (high - low) * slow])

    def driven(text: str) -> Iterator[list[float]]:
        module: dict[str, object] = {}
        exec(compile(text, "mutant", "exec"), module)
        controller = module["Controller"]()
        for row in rows.tolist():
            yield np.atleast_1d(controller.step(*row)).tolist()

    return text, driven


def rules_module(path: Path, folder: Path) -> tuple[str, Run]:
    """Return a rule base as a module, and its answers at points within its ranges."""
    rulebase = load(path)
    made = export_files(routines_of(rulebase, precision="float64"), folder / "made.py")
    ((_, text),) = made.files
    low, high = (np.clip([getattr(v, end) for v in rulebase.inputs], -100.0, 100.0)
                 for end in ("low", "high"))  # fmt: skip
    points = np.random.default_rng(5).uniform(low, high, (600, low.size)).tolist()

    def answers(text: str) -> Iterator[list[float]]:
        module: dict[str, object] = {}
        exec(compile(text, "mutant", "exec"), module)
        functions = [module[call.partition("(")[0]] for call in made.calls]
        for point in points:
            yield [function(*point) for function in functions]

    return text, answers


def differs(run: Run, text: str, right: list[list[float]]) -> bool:
    """Whether a module fails, or has an answer other than the right one."""
    within = 1e-9 * np.nanmax(np.abs(right))
    try:
        return any(
            not (a == b or abs(a - b) <= within or (np.isnan(a) and np.isnan(b)))
            for row, others in zip(run(text), right, strict=True)
            for a, b in zip(row, others, strict=True)
        )
    except _FAULTS:
        return True


MUTANTS = 20
"""At least so many of a module are tried, if it has them; all with ``--thorough``."""


@pytest.mark.slow(seconds=10)
@pytest.mark.parametrize("path", part(FILES, 4), ids=lambda path: path.stem)
def test_a_constant_that_is_off_by_a_tenth_is_noticed(tmp_path, path):
    make = rules_module if controller_if_any(str(path)) is None else controller_module
    text, run = make(path, tmp_path)
    right = list(run(text))
    every = list(mutants(text))
    tried = part(every, max(1, len(every) // MUTANTS))
    unnoticed = [mutant for mutant in tried if not noticed_by_test(mutant)]
    noticed = len(tried) - len(unnoticed)
    missed = sum(differs(run, mutant, right) for mutant in unnoticed)
    if path.stem in ONE_LIMIT:
        assert (noticed, missed) == ONE_LIMIT[path.stem]
        pytest.xfail("the upper limit of its integral is not reached")
    assert noticed >= 0.95 * (noticed + missed), (noticed, missed)
