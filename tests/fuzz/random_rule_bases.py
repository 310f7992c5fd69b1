"""Make rule bases at random; every engine, exporter and round trip gives the same numbers.

    python tests/fuzz/random_rule_bases.py --seed 1 --count 20000

Points, flat arrays, an open mesh, compiled points and arrays, the trace: to the bit, and at
corners of terms, next to them, and where a strength is next to a threshold. Tables, the C of
direct inference as it is interpreted here and, where there is a compiler, as it runs (in double
precision to the bit); the module of JavaScript where there is node.
"""

from __future__ import annotations

import dataclasses
import json
import math
import random
import shutil
import subprocess
import sys
from functools import cache, partial
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests"), str(ROOT / "tests" / "fuzz")]

import numpy as np  # noqa: E402
from fuzzing import Told, folder, run  # noqa: E402
from hypothesis import HealthCheck, Phase, given, settings  # noqa: E402
from hypothesis import seed as seeded  # noqa: E402
from hypothesis import strategies as st  # noqa: E402

from fuzzyarm import compile_table, compiled, infer  # noqa: E402
from fuzzyarm.base.errors import FuzzyarmError  # noqa: E402
from fuzzyarm.exchange.export import ExportError, routines_of  # noqa: E402
from fuzzyarm.exchange.export.languages import MODULES  # noqa: E402
from fuzzyarm.exchange.export.routine import Accuracy  # noqa: E402
from fuzzyarm.exchange.export.write import routines_module  # noqa: E402
from fuzzyarm.exchange.formats import PRODUCERS, parse, same_model, write  # noqa: E402
from fuzzyarm.inference import explain  # noqa: E402
from fuzzyarm.inference.plan import plan  # noqa: E402
from fuzzyarm.language.model.rulebase import (  # noqa: E402
    Defuzzifier,
    Input,
    RuleBase,
    RuleBlock,
    Shape,
)
from fuzzyarm.language.model.shapes import corner_points, straight_lines  # noqa: E402
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS  # noqa: E402
from tests.export.c_programs import run_c  # noqa: E402
from tests.interpreted import interpreted  # noqa: E402
from tests.strategies import (  # noqa: E402
    SMOOTH,
    STRAIGHT,
    defuzzifiers,
    input_points,
    places,
    plain_mamdani,
    rulebases,
)

POINTS = 8
Values = dict[str, list[float]]
JUMPS = ("drastic", "nilpotent", "bounded")
"""Norms that jump where a degree is 1, or a sum of two, or lose the last bits of a sum."""

MAXIMA = (
    *(name for name, record in DEFUZZIFIERS.items() if record.of == "top"), "bisector", "centroid",
)  # fmt: skip


def models() -> st.SearchStrategy[RuleBase]:
    """Rule bases of every sort."""
    return st.one_of(
        rulebases(),
        rulebases(odd_names=True, decorated=True),
        plain_mamdani(kinds=STRAIGHT + SMOOTH, implications=("min", "product")),
        plain_mamdani(aggregations=("max", "sum", "probor", "bounded")),
        jumping(),
        jumping(),
        choosing(),
        between(),
    )


@st.composite
def jumping(draw: Any) -> RuleBase:
    """A rule base in which the last bit of a degree may decide: norms, thresholds, maxima."""
    rulebase = draw(
        st.one_of(
            plain_mamdani(kinds=STRAIGHT, implications=("min", "product", *JUMPS)),
            plain_mamdani(kinds=(*STRAIGHT, "s", "z", "pi"), aggregations=("max", "sum")),
        )
    )
    norms = st.sampled_from(["min", "product", "einstein", "hamacher", *JUMPS])
    threshold = st.sampled_from([0.0, 0.25, 0.5, 1 / 3, 0.1, 1.0 - 2.0**-53])
    blocks = tuple(
        dataclasses.replace(
            block, conjunction=draw(norms), disjunction=draw(st.sampled_from(["max", *JUMPS])),
            threshold=draw(threshold),
        )
        for block in rulebase.blocks
    )  # fmt: skip
    (output,) = rulebase.outputs
    way = draw(defuzzifiers(MAXIMA))
    if way.resolution is None and draw(st.booleans()):
        way = Defuzzifier(way.method)
    output = dataclasses.replace(output, defuzzifier=way, no_rule=draw(st.sampled_from(
        [output.low, output.high + 1.0, "hold"])), outside="extend")  # fmt: skip
    return dataclasses.replace(rulebase, blocks=blocks, outputs=(output,))


@st.composite
def choosing(draw: Any) -> RuleBase:
    """A rule base that chooses among values, some of which may be one number."""
    rulebase = draw(plain_mamdani(kinds=STRAIGHT, aggregations=("max", "sum", "probor")))
    (output,) = rulebase.outputs
    even = [output.low + (output.high - output.low) * i / 4 for i in range(5)]
    slopes = st.floats(-2.0, 2.0, allow_nan=False).map(lambda x: round(x, 3))
    terms = []
    for term in output.terms:
        shape = Shape("singleton", (draw(st.sampled_from(even)),))
        if draw(st.integers(0, 3)) == 0:
            shape = Shape("linear", tuple(draw(slopes) for _ in range(len(rulebase.inputs) + 1)))
        terms.append(dataclasses.replace(term, shape=shape))
    way = Defuzzifier(draw(st.sampled_from(MAXIMA[:-1])))
    output = dataclasses.replace(output, terms=tuple(terms), defuzzifier=way, outside="extend")
    return dataclasses.replace(rulebase, outputs=(output,), blocks=_without_hedges(rulebase))


@st.composite
def between(draw: Any) -> RuleBase:
    """A rule base of interval type 2: lower sets are a share of the upper ones."""
    kinds = draw(st.sampled_from([STRAIGHT, (*STRAIGHT, "gaussian")]))
    rulebase = draw(plain_mamdani(kinds=kinds, implications=("min", "product")))
    (output,) = rulebase.outputs
    share = st.sampled_from([0.25, 0.5, 1.0])
    terms = tuple(
        dataclasses.replace(term, lower=dataclasses.replace(
            term.shape, height=draw(share) * term.shape.height)) for term in output.terms
    )  # fmt: skip
    way = draw(defuzzifiers(("karnik-mendel", "karnik-mendel-left", "nie-tan")))
    if way.joined:
        way = Defuzzifier(way.method, way.resolution, "trapezoid")
    output = dataclasses.replace(output, terms=terms, defuzzifier=way)
    return dataclasses.replace(rulebase, outputs=(output,), blocks=_without_hedges(rulebase))


def _without_hedges(rulebase: RuleBase) -> tuple[RuleBlock, ...]:
    """Return the blocks with plain conclusions."""
    return tuple(
        dataclasses.replace(block, rules=tuple(
            dataclasses.replace(rule, consequents=tuple(
                dataclasses.replace(each, hedges=()) for each in rule.consequents))
            for rule in block.rules))
        for block in rulebase.blocks
    )  # fmt: skip


MODELS = models()
"""Made once: a strategy is checked when it is first drawn from."""

OTHER_THAN_THE_SIMPLEST = st.integers(0, 2**32)


@st.composite
def points_at_edges(draw: Any, rulebase: RuleBase, count: int) -> Values:
    """Values for every input: at corners and thresholds, next to them, and anywhere."""
    return {
        each.name: draw(st.lists(_values(each, rulebase), min_size=count, max_size=count))
        for each in rulebase.inputs
    }


def _values(variable: Input, rulebase: RuleBase) -> st.SearchStrategy[float]:
    thresholds = {block.threshold for block in rulebase.blocks} | {0.5}
    edges = {variable.low, variable.high}
    for term in variable.terms:
        edges |= {x for x in corner_points(term.shape) if abs(x) < 1e6}
        lines = straight_lines(term.shape)
        for height, x_0, slope in lines.between if lines else ():
            if slope:
                edges |= {x_0 + (level - height) / slope for level in thresholds}
    near = [x for edge in edges for x in (edge, *_beside(edge))]
    inside = [x for x in near if variable.low <= x <= variable.high]
    return st.one_of(st.sampled_from(sorted(inside)), places(variable.low, variable.high))


def _beside(x: float) -> tuple[float, float]:
    return math.nextafter(x, -math.inf), math.nextafter(x, math.inf)


def held_of(rulebase: RuleBase) -> dict[str, float]:
    """Return last values of the outputs."""
    return {each.name: 0.5 * (each.low + each.high) for each in rulebase.outputs}


def outcome(engine: Any, values: dict[str, Any], held: dict[str, float]) -> Any:
    """Return what an engine gives, or which error."""
    try:
        return engine(values, held=held)
    except FuzzyarmError as error:
        return type(error).__name__


def demand_equal(rulebase: RuleBase, one: Any, other: Any, what: str, share: float = 0.0) -> None:
    """Two outcomes are one error, or numbers with the same bits; or as near as `share` says."""
    if isinstance(one, str) or isinstance(other, str):
        assert type(one) is type(other), (what, one, other)
        assert one == other, what
        return
    for name, value in one.items():
        there, here = np.asarray(value, float), np.asarray(other[name], float)
        assert np.array_equal(np.isnan(there), np.isnan(here)), (what, name, there, here)
        output = rulebase.output(name)
        width = output.high - output.low if math.isfinite(output.high - output.low) else 1.0
        scale = share * max(1.0, width) * np.maximum(1.0, np.abs(there))
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
        return interpreted(rulebase).evaluate(given, held)

    for what, engine in (("arrays", numpy), ("compiled arrays", fast), ("plain arrays", plain)):
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
        rest = [i for i in range(len(levels)) if i not in order]  # which nothing depends on
        cells = np.transpose(wanted[output.name].reshape([2] * len(levels)), [*order, *rest])
        cells = cells[(..., *[0] * len(rest))]
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
                share = 0.0 if same_arithmetic(rulebase) else 1e-9
                demand_equal(
                    rulebase, {output.name: truth}, {output.name: here}, "routine", share
                )  # fmt: skip
            found.append((routine, columns))
    return found


def same_arithmetic(rulebase: RuleBase) -> bool:
    """Whether C goes the way of the engines: scaled sets it unites by formulas of its own."""
    return not any(output.enveloped for output in plan(rulebase).outputs.values()) and not any(
        member.implication == "product" and output.integrated
        for output in plan(rulebase).outputs.values()
        for member in output.members
    )


@cache
def program(name: str) -> str | None:
    return shutil.which(name)


def in_c(pairs: list[tuple[Any, list[Any]]]) -> None:
    """Run routines as C and compare with what is interpreted here, to the bit."""
    if not pairs or not program("gcc"):
        return
    for (
        routine,
        _,
    ) in pairs:  # what the comment at its head says would take longer than all the rest
        vars(routine)["accuracy"] = Accuracy(0.0, 0, "nothing: not measured here")
    with folder() as home:
        results = run_c([routine for routine, _ in pairs], [points for _, points in pairs], home)
    for (routine, points), found in zip(pairs, results, strict=True):
        with np.errstate(all="ignore"):
            wanted = routine.evaluate(*points)
        assert np.array_equal(found, wanted, equal_nan=True), (
            routine.rulebase, found.tolist(), wanted.tolist(),
        )  # fmt: skip


NODE = """
import { inferMany } from "./rules.mjs";
import { readFileSync } from "fs";
const given = JSON.parse(readFileSync(0));
for (const name in given) given[name] = Float64Array.from(given[name]);
const found = inferMany(given);
for (const name in found) found[name] = Array.from(found[name]);
console.log(JSON.stringify(found));
"""


def in_javascript(rulebase: RuleBase, values: Values) -> None:
    """Run the module of a rule base; where it has a value, it is that of the kernel."""
    node, fast = program("node"), compiled(rulebase)
    if node is None or fast.reason:
        return
    silent = dataclasses.replace(rulebase, outputs=tuple(
        dataclasses.replace(each, no_rule=math.nan if isinstance(each.no_rule, str)
                            else each.no_rule) for each in rulebase.outputs))  # fmt: skip
    try:
        routines = routines_of(silent, precision="float64")
        module = routines_module(routines, MODULES[".mjs"], "rules")[0]
    except ExportError:
        return
    wanted = outcome(compiled(silent), {k: np.array(v) for k, v in values.items()}, {})
    if isinstance(wanted, str):
        return
    with folder() as home:
        (home / "rules.mjs").write_text(module)
        (home / "run.mjs").write_text(NODE)
        done = subprocess.run(
            [node, str(home / "run.mjs")], input=json.dumps(values), capture_output=True,
            text=True, check=False, timeout=60,
        )  # fmt: skip
    assert done.returncode == 0, done.stderr
    found = {
        k: [math.nan if x is None else x for x in v] for k, v in json.loads(done.stdout).items()
    }
    # V8 has an exponential and a power of its own.
    share = 0.0 if _has_no_library(rulebase) else 1e-9
    demand_equal(silent, wanted, found, "JavaScript", share)


def _has_no_library(rulebase: RuleBase) -> bool:
    shapes = {term.shape.kind for v in (*rulebase.inputs, *rulebase.outputs) for term in v.terms}
    return shapes <= {*STRAIGHT, "singleton", "linear", "s", "z", "pi", "concave"} and (
        "power" not in repr(rulebase.blocks)
    )


def case(r: random.Random, told: Told) -> None:
    """Draw one rule base by hypothesis (which makes it smaller where it fails)."""
    chance = r.random()
    with_c, with_node = chance < 0.04, chance > 0.97

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
        if data.draw(OTHER_THAN_THE_SIMPLEST) == 0:
            return  # hypothesis begins with the simplest of all, every time
        rulebase = data.draw(MODELS)
        some = (input_points, points_at_edges, points_at_edges)
        values = data.draw(st.sampled_from(some).flatmap(lambda draw: draw(rulebase, POINTS)))
        for column in values.values():
            column[0] = column[0] if math.isfinite(column[0]) else 0.0
        told.append(f"{rulebase!r}\n{write(rulebase, '.frb', lossy=True).text}\n{values}")
        engines(rulebase, values)
        tables(rulebase)
        round_trips(rulebase, values, told)
        pairs = exports(rulebase, values)
        if with_c:
            in_c(pairs)
        if with_node:
            in_javascript(rulebase, values)

    one()


if __name__ == "__main__":
    sys.exit(run(__doc__, case))
