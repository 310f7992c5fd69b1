"""Every ordinary setting in every engine and export: the numbers of the point engine.

What an engine does not take stands in `OUT`, with the reason; what is not named there must work.
"""

from __future__ import annotations

import json
import subprocess
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from budget import cases, part
from needs import requires

from fuzzyarm.control.controllers.program import rule_block
from fuzzyarm.exchange.export import export_files, routines_of
from fuzzyarm.exchange.formats import PRODUCERS, write
from fuzzyarm.inference import compiled
from fuzzyarm.inference import kernel as inference_kernel
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.symbolic.kernels import has_machine_code, routine
from tests.export.c_programs import run_c
from tests.export.module_programs import javascript_of
from tests.export.st_programs import Program
from tests.interpreted import interpreted

BASE = """rulebase matrix
input v -1 .. 1
input w 0 .. 2
output u -2 .. 3
terms v, w: {family} L H
{terms}
inference and {conjunction}, implication {implication}
inference u: aggregation {union}, defuzzifier {way}, no-rule 0.125
rules u
  v \\ w  L  H
  L      A  B
  H      B  A
"""

SETS = "terms u: triangles A B"
BELLS = "terms u: gaussians A B"
VALUES = "terms u: singletons A B"
LINEAR = "term u A: linear 1*v - 0.3\nterm u B: linear 0.5*w + 0.25"
FORMULAS = 'term u A: formula "v * w - 0.2"\nterm u B: formula "sqrt(w) + v"'
RAMPS = "term u A: ramp 2 -1\nterm u B: ramp -2 3"
INTERVALS = """term u A: triangle -2 -2 2 over triangle -2 -2 0.6
term u B: triangle -1 3 3 over triangle 0.5 3 3"""


class Case(NamedTuple):
    """A setting: the defuzzifier, the terms of the output, and what differs from min and max."""

    way: str
    terms: str = SETS
    more: tuple[tuple[str, str], ...] = ()

    def __str__(self) -> str:
        terms = self.terms.replace("term u ", "").replace("\n", ", ").removeprefix("terms u: ")
        return "; ".join([self.way, terms, *(f"{key} {word}" for key, word in self.more)])

    def rulebase(self) -> RuleBase:
        """Return the rule base."""
        words = {
            "family": "triangles", "conjunction": "min", "implication": "min", "union": "max",
            **dict(self.more),
        }  # fmt: skip
        parsed = parse(BASE.format(terms=self.terms, way=self.way, **words))
        assert parsed.rulebase is not None, [each.message for each in parsed.diagnostics]
        return parsed.rulebase


EXACT = "centroid exact"

CASES = [
    Case(EXACT),
    Case("centroid(51)"),
    Case("centroid(51, joined)"),
    Case("bisector exact"),
    Case("bisector(51)"),
    Case("bisector(51, joined)"),
    Case("mean-of-maximum exact"),
    Case("mean-of-maximum(51)"),
    Case("smallest-of-maximum exact"),
    Case("largest-of-maximum(51)"),
    Case("middle-of-maximum exact"),
    Case("middle-of-maximum(51)"),
    Case("middle-of-maximum exact", VALUES),
    Case(EXACT, BELLS),
    Case("bisector exact", BELLS),
    Case(EXACT, more=(("union", "sum"),)),
    Case(EXACT, more=(("implication", "product"),)),
    Case(EXACT, more=(("union", "probor"),)),
    Case(EXACT, more=(("implication", "bounded"),)),
    Case(EXACT, "term u A: trapezoid -2 -2 0 2\nterm u B: trapezoid 0 2 3 3",
         (("implication", "drastic"),)),
    Case("centroid(51)", more=(("union", "probor"), ("implication", "einstein"))),
    Case(EXACT, more=(("conjunction", "product"),)),
    Case(EXACT, more=(("family", "gaussians"),)),
    Case("weighted-average", VALUES),
    Case("weighted-average", LINEAR),
    Case("weighted-average", FORMULAS),
    Case("weighted-sum", VALUES),
    Case("tsukamoto", RAMPS),
    Case("mean-of-maximum exact", VALUES),
    Case("bisector exact", VALUES),
    Case("karnik-mendel exact", INTERVALS),
    Case("karnik-mendel(51)", INTERVALS),
    Case("nie-tan exact", INTERVALS),
    Case("nie-tan(51)", INTERVALS),
    # Siblings of these, where another way is taken.
    Case("bisector(50, midpoints)", BELLS),
    Case("mean-of-maximum exact", BELLS),
    Case("largest-of-maximum exact", more=(("implication", "nilpotent"),)),
    Case("smallest-of-maximum(33)", FORMULAS),
    Case("nearest-of-maximum exact"),
    Case("nearest-of-maximum(50, midpoints)"),
    Case("nearest-of-maximum exact", BELLS),
    Case("nearest-of-maximum exact", FORMULAS),
    Case("farthest-of-maximum(51)"),
    Case("farthest-of-maximum exact", VALUES),
    Case("farthest-of-maximum exact", more=(("implication", "product"),)),
    Case("bisector exact", LINEAR),
    Case("tsukamoto", "term u A: s -2 3\nterm u B: sigmoid 0.5 -3"),
    Case("tsukamoto", "term u A: arc -2 3\nterm u B: concave 0.5 3"),
    Case("karnik-mendel-left", INTERVALS.replace("triangle -2 -2 2", "gaussian -2 2")
         .replace("triangle -2 -2 0.6", "gaussian -2 1")),
]  # fmt: skip

OUT: dict[tuple[str, str], str] = {}
"""What stays out: column and case, and why. Nothing does."""

ROUNDED = str(CASES[-1])
"""Of curved interval sets the point engine adds up finished panels, the kernel integrates anew."""

APART = {str(Case(EXACT, more=(("implication", "product"),)))}
"""Scaled sets have a formula of their own in C and Structured
Text: it rounds otherwise."""

CURVED = {
    str(case) for case in CASES
    if case.terms == BELLS or "sigmoid" in case.terms or "gaussian" in case.terms
    or dict(case.more).get("family")
}  # fmt: skip
"""Exponentials of another library differ in their last bits."""


MANY = cases(24, 200)
"""Points where an engine or a program takes many at once."""


def points(count: int) -> dict[str, np.ndarray]:
    """Return the first points of a row of them: corners, then at random."""
    rng = np.random.default_rng(25)
    v, w = rng.uniform([-1.0, 0.0], [1.0, 2.0], (count, 2)).T
    v[:6], w[:6] = (
        [-1.0, -1.0, 1.0, 0.0, 0.5, -0.25][:count],
        [0.0, 2.0, 0.0, 1.0, 1.5, 0.75][:count],
    )
    return {"v": v, "w": w}


@cache
def truth(case: Case, count: int = MANY) -> np.ndarray:
    """Return what the point engine gives at the first points."""
    if count < MANY:
        return truth(case)[:count]
    engine, columns = interpreted(case.rulebase()), points(count)
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    return np.array([engine.evaluate(dict(zip(columns, row, strict=True)))["u"] for row in rows])


def demand_same(case: Case, found: np.ndarray, wanted: np.ndarray, close: float = 0.0) -> None:
    """Demand the same bits; or the same numbers but for so much."""
    assert np.isfinite(wanted).all()
    assert len({*wanted.tolist()}) > 1, "points that tell nothing"
    if close:
        np.testing.assert_allclose(found, wanted, rtol=0.0, atol=close, err_msg=str(case))
    else:
        np.testing.assert_array_equal(found, wanted, err_msg=str(case))


@pytest.mark.parametrize("case", CASES, ids=str)
def test_arrays_kernel_and_loop_have_the_bits_of_a_point(case: Case) -> None:
    rulebase, columns = case.rulebase(), points(MANY)
    wanted = truth(case)
    demand_same(case, interpreted(rulebase).evaluate(columns)["u"], wanted)
    close = 1e-12 if str(case) == ROUNDED else 0.0
    fast = compiled(rulebase)
    assert not fast.reason
    demand_same(case, fast(columns)["u"], wanted, close)
    block = rule_block(rulebase, compiled=has_machine_code())
    evaluate = routine(inference_kernel.evaluate, 1, compiled=has_machine_code())
    found = []
    for v, w in zip(columns["v"], columns["w"], strict=True):
        block.numbers[block.first_input : block.first_input + 2] = v, w
        evaluate(block.numbers)
        found.append(block.numbers[block.first_result])
    demand_same(case, np.array(found), wanted, close)


@pytest.mark.slow
def test_c_has_the_bits_of_a_point(tmp_path: Path) -> None:
    """All settings in one file: nothing in it gets in the way of another."""
    columns = points(MANY)
    routines = [routines_of(case.rulebase(), precision="float64")[0] for case in CASES]
    results = run_c(routines, [list(columns.values())] * len(routines), tmp_path, suffix=".c")
    for case, made, found in zip(CASES, routines, results, strict=True):
        demand_same(case, made.evaluate(*columns.values()), found)
        demand_same(case, found, truth(case), 1e-12 if str(case) in {*APART, ROUNDED} else 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("case", part(CASES, 2), ids=str)
def test_structured_text_has_the_bits_of_a_point(case: Case) -> None:
    rulebase = case.rulebase()
    columns = points(cases(4, 7))
    exported = export_files(routines_of(rulebase, precision="float64"), "made.st")
    block = Program(exported.files[0][1]).instance(exported.calls[0])
    found = []
    for v, w in zip(columns["v"], columns["w"], strict=True):
        block.run(v=v, w=w)
        found.append(float(block.outputs()["u"]))
    close = 1e-12 if str(case) in APART else 1e-7 if str(case) in CURVED else 0.0
    demand_same(case, np.array(found), truth(case, len(found)), close)


NODE = """
import { readFileSync } from "fs";
const found = {};
for (const [name, columns] of Object.entries(JSON.parse(readFileSync(0)))) {
  const { inferMany } = await import(`./${name}.mjs`);
  found[name] = Array.from(inferMany(columns).u);
}
console.log(JSON.stringify(found));
"""


@pytest.mark.slow
@requires("node")
def test_javascript_has_the_bits_of_a_point(tmp_path: Path) -> None:
    columns = {name: column.tolist() for name, column in points(MANY).items()}
    for index, case in enumerate(CASES):
        (tmp_path / f"case{index}.mjs").write_text(javascript_of(case.rulebase()))
    (tmp_path / "run.mjs").write_text(NODE)
    asked = {f"case{index}": columns for index in range(len(CASES))}
    done = subprocess.run(
        ["node", str(tmp_path / "run.mjs")], input=json.dumps(asked), capture_output=True,
        text=True, timeout=100, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    results = json.loads(done.stdout)
    for index, case in enumerate(CASES):
        found = np.array(results[f"case{index}"])
        close = 1e-12 if str(case) in APART else 1e-7 if str(case) in CURVED else 0.0
        demand_same(case, found, truth(case), close)


@pytest.mark.slow
def test_other_programs_get_a_file_or_findings() -> None:
    """No writer dies: what a program does not have is an error that says so."""
    for case in CASES:
        for suffix, producers in PRODUCERS.items():
            for producer in (None, *producers):
                for lossy in (False, True):
                    written = write(case.rulebase(), suffix, producer=producer, lossy=lossy)
                    assert (written.text is None) == bool(written.errors), (case, suffix)
                    assert all(each.message for each in written.errors)


def test_what_stays_out_is_one_of_these() -> None:
    names = {str(case) for case in CASES}
    assert len(names) == len(CASES)
    assert {case for _, case in OUT} <= names
    assert names >= APART
