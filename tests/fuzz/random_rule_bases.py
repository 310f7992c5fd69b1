"""Make rule bases at random; every engine, exporter and round trip gives the same numbers.

    python tests/fuzz/random_rule_bases.py --seed 1 --count 20000

Points, flat arrays, an open mesh, compiled points and arrays, the trace, tables, the C of
direct inference as it is interpreted here and, where there is a compiler, as it runs.
"""

from __future__ import annotations

import itertools
import math
import random
import shutil
import sys
from functools import cache, partial
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "fuzz")]

import numpy as np  # noqa: E402
from fuzzing import Told, folder, run  # noqa: E402
from hypothesis import HealthCheck, Phase, given, settings  # noqa: E402
from hypothesis import seed as seeded  # noqa: E402
from hypothesis import strategies as st  # noqa: E402

from fuzzyarm import compile_table, compiled, infer  # noqa: E402
from fuzzyarm.errors import FuzzyarmError  # noqa: E402
from fuzzyarm.export import ExportError, routines_of  # noqa: E402
from fuzzyarm.formats import PRODUCERS, parse, same_model, write  # noqa: E402
from fuzzyarm.inference import explain  # noqa: E402
from fuzzyarm.inference.arrays import infer_arrays  # noqa: E402
from fuzzyarm.model.rulebase import RuleBase  # noqa: E402
from tests.export.c_programs import run_c  # noqa: E402
from tests.strategies import SMOOTH, STRAIGHT, input_points, plain_mamdani, rulebases  # noqa: E402

POINTS = 6
Values = dict[str, list[float]]


def models() -> st.SearchStrategy[RuleBase]:
    """Rule bases of every sort."""
    return st.one_of(
        rulebases(),
        rulebases(odd_names=True, decorated=True),
        plain_mamdani(kinds=STRAIGHT + SMOOTH, implications=("min", "product")),
        plain_mamdani(aggregations=("max", "sum", "probor", "bounded")),
    )


def slack(rulebase: RuleBase, name: str, share: float = 1e-12) -> float:
    """How far two engines may be apart at an output.

    The inverse of a set has an infinite slope at its ends (Tsukamoto): the last bit of a
    strength moves it by the root of that bit. The tail of a difference of sigmoids is what is
    left of two numbers near 1: cut at a strength of 1e-9, it is known to 1e-7 of that.
    """
    output = rulebase.output(name)
    share = max(share, 3e-8) if output.defuzzifier.method == "tsukamoto" else share
    if any(term.shape.kind == "sigmoid-difference" for term in output.terms):
        share = max(share, 1e-9)
    return share * max(1.0, output.high - output.low)


def held_of(rulebase: RuleBase) -> dict[str, float]:
    """Return last values of the outputs."""
    return {each.name: 0.5 * (each.low + each.high) for each in rulebase.outputs}


def outcome(engine: Any, values: dict[str, Any], held: dict[str, float]) -> Any:
    """Return what an engine gives, or which error."""
    try:
        return engine(values, held=held)
    except FuzzyarmError as error:
        return type(error).__name__


def demand_equal(rulebase: RuleBase, one: Any, other: Any, what: str, share: float = 1e-12) -> None:
    """Two outcomes are one error, or numbers that differ by rounding only."""
    if isinstance(one, str) or isinstance(other, str):
        assert type(one) is type(other), (what, one, other)
        assert one == other, what
        return
    for name, value in one.items():
        there, here = np.asarray(value, float), np.asarray(other[name], float)
        assert np.array_equal(np.isnan(there), np.isnan(here)), (what, name, there, here)
        scale = slack(rulebase, name, share) * np.maximum(1.0, np.abs(there))
        close = (np.abs(there - here) <= scale) | (there == here) | np.isnan(there)
        assert close.all(), (what, name, there.tolist(), here.tolist())


def engines(rulebase: RuleBase, values: Values) -> None:
    """Compare all ways of inference."""
    held = held_of(rulebase)
    fast = compiled(rulebase)
    rows = [dict(zip(values, row, strict=True)) for row in zip(*values.values(), strict=True)]

    def plain(given: Any, held: Any) -> Any:
        return infer(rulebase, given, held=held)

    alone = [outcome(plain, row, held) for row in rows]
    for row, found in zip(rows, alone, strict=True):
        demand_equal(rulebase, found, outcome(fast, row, held), f"compiled at {row}")
        traced(rulebase, row, held, found)
    columns = {name: np.array(column) for name, column in values.items()}
    errors = [found for found in alone if isinstance(found, str)]

    def numpy(given: Any, held: Any) -> Any:  # `infer` may take the kernel
        return infer_arrays(rulebase, given, held)

    for what, engine in (("arrays", numpy), ("compiled arrays", fast)):
        found = outcome(engine, columns, held)
        if errors:
            assert found in errors, (what, found, errors)
        else:
            wanted = {k: [each[k] for each in alone] for k in alone[0]}
            demand_equal(rulebase, wanted, found, what)
    mesh = dict(zip(columns, np.ix_(*(x[:3] for x in columns.values())), strict=True))
    full = dict(zip(columns, np.broadcast_arrays(*mesh.values()), strict=True))
    wanted = outcome(plain, {k: np.ascontiguousarray(v) for k, v in full.items()}, held)
    for what, engine in (("mesh", numpy), ("plain mesh", plain), ("compiled mesh", fast)):
        found = outcome(engine, mesh, held)
        if isinstance(wanted, str) or isinstance(found, str):
            assert isinstance(wanted, str) == isinstance(found, str), (what, wanted, found)
        else:
            demand_equal(rulebase, wanted, found, what)


def traced(rulebase: RuleBase, row: dict[str, float], held: dict[str, float], found: Any) -> None:
    """The trace ends with the value of inference."""
    try:
        trace = explain(rulebase, row, held=held)
    except FuzzyarmError:
        assert isinstance(found, str)
        return
    if not isinstance(found, str):
        values = {each.name: each.value for each in trace.outputs}
        demand_equal(rulebase, found, values, f"trace at {row}")


def tables(rulebase: RuleBase) -> None:
    """Cells hold what inference gives at their levels."""
    levels = {each.name: [each.low, 0.3 * each.low + 0.7 * each.high] for each in rulebase.inputs}
    output = rulebase.outputs[-1]
    axes = np.meshgrid(*levels.values(), indexing="ij")
    given = {name: axis.ravel() for name, axis in zip(levels, axes, strict=True)}
    wanted = outcome(lambda x, held: infer(rulebase, x, held=held), given, {})
    try:
        table = compile_table(rulebase, output.name, levels=levels, rounding=0)
    except FuzzyarmError as error:
        assert isinstance(wanted, str), error  # noqa: PT017
        return
    if not isinstance(wanted, str):
        order = [list(levels).index(name) for name in table.names]
        cells = np.transpose(wanted[output.name].reshape([2] * len(levels)), order)
        demand_equal(rulebase, {output.name: cells}, {output.name: table.values}, "table")


def round_trips(rulebase: RuleBase, values: Values, told: Told) -> None:
    """What a format takes without a word comes back with its numbers."""
    held = held_of(rulebase)
    first = {name: column[0] for name, column in values.items()}
    wanted = outcome(lambda x, held: infer(rulebase, x, held=held), first, held)
    writers = [(".frb", None), *((s, p) for s, programs in PRODUCERS.items() for p in programs)]
    for suffix, producer in writers:
        for lossy in (False, True):
            exported = write(rulebase, suffix, producer=producer, lossy=lossy)
            assert (exported.text is None) == bool(exported.errors)
            if exported.text is None:
                continue
            imported = parse(exported.text, suffix, producer=producer, lossy=lossy)
            lost = bool(exported.diagnostics) or any(
                d.severity == "warning" for d in imported.diagnostics
            )
            if lost and imported.rulebase is None:
                continue
            told.append(f"--- written as {suffix} for {producer}, lossy {lossy}\n{exported.text}")
            assert imported.rulebase is not None, [str(each) for each in imported.errors]
            again = imported.rulebase
            if not lost:
                if suffix == ".frb":
                    assert same_model(again, rulebase)
                found = outcome(lambda x, held, m=again: infer(m, x, held=held), first, held)
                demand_equal(rulebase, wanted, found, f"{suffix} {producer}", 1e-9)
            told.pop()


def exports(rulebase: RuleBase, values: Values) -> list[tuple[Any, list[Any]]]:
    """Compare direct inference as it is interpreted here; return what is to be compiled."""
    points = [np.array(column) for column in values.values()]
    found = []
    for output in rulebase.outputs:
        try:
            routines = [
                routine
                for precision in ("float64", "mixed")
                for routine in routines_of(rulebase, output=output.name, precision=precision)
            ]
        except ExportError:
            continue
        for routine in routines:
            columns = [*points, *routine._held(points[0])]  # what its model holds
            if routine is routines[0]:
                # Where an output that is asked for by rules has no value, neither has this one.
                rows = [dict(zip(values, row, strict=True)) for row in zip(*points, strict=True)]
                given = {**held_of(rulebase), output.name: float(routine._last())}
                sound = [
                    not isinstance(outcome(partial(infer, rulebase), row, given), str)
                    for row in rows
                ]
                truth = np.where(sound, routine.model(*points), 0.0)
                here = np.where(sound, routine.evaluate(*columns), 0.0)
                demand_equal(
                    rulebase, {output.name: truth}, {output.name: here}, "routine", 1e-9
                )  # fmt: skip
            found.append((routine, columns))
    return found


@cache
def compiler() -> bool:
    return shutil.which("gcc") is not None


def in_c(pairs: list[tuple[Any, list[Any]]]) -> None:
    """Run routines as C and compare with what is interpreted here."""
    if not pairs or not compiler():
        return
    with folder() as home:
        results = run_c([routine for routine, _ in pairs], [points for _, points in pairs], home)
    for (routine, points), found in zip(pairs, results, strict=True):
        with np.errstate(all="ignore"):
            wanted = routine.evaluate(*points)
        here, there = found.astype(float), wanted.astype(float)
        assert np.array_equal(np.isnan(here), np.isnan(there)), (routine.rulebase, here, there)
        output = routine.rulebase.output(routine.name)
        # Exponentials and powers of C and NumPy differ in the last bit.
        share = 1e-9 if found.dtype == np.float64 else 1e-5
        scale = share * max(output.high - output.low, float(np.nanmax(np.abs(there), initial=1.0)))
        assert np.nanmax(np.abs(here - there), initial=0.0) <= scale, (
            routine.rulebase, here.tolist(), there.tolist(),
        )  # fmt: skip


def case(r: random.Random, told: Told) -> None:
    """Draw one rule base by hypothesis (which makes it smaller where it fails)."""
    with_c = r.random() < 0.04
    calls = itertools.count()

    @seeded(r.getrandbits(64))
    @settings(
        max_examples=2,
        database=None,
        deadline=None,
        derandomize=False,
        phases=(Phase.generate, Phase.shrink),
        suppress_health_check=list(HealthCheck),
        print_blob=False,
    )
    @given(st.data())
    def one(data: st.DataObject) -> None:
        told.clear()
        rulebase = data.draw(models())
        if next(calls) == 0:
            return  # hypothesis begins with the simplest of all rule bases, every time
        values = data.draw(input_points(rulebase, POINTS))
        for column in values.values():
            column[0] = column[0] if math.isfinite(column[0]) else 0.0
        told.append(f"{rulebase!r}\n{write(rulebase, '.frb', lossy=True).text}\n{values}")
        engines(rulebase, values)
        tables(rulebase)
        round_trips(rulebase, values, told)
        pairs = exports(rulebase, values)
        if with_c:
            in_c(pairs)

    one()


if __name__ == "__main__":
    sys.exit(run(__doc__, case))
