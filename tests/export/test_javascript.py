"""Rule bases in JavaScript, run by node, against Python."""

import json
import math
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st
from module_programs import javascript_of
from needs import requires
from strategies import SMOOTH, STRAIGHT, plain_mamdani

import fuzzyarm
from fuzzyarm.apps.designer.engine import engine_source, numbers_of
from fuzzyarm.base.jsonable import script_json
from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.exchange.export import ExportError, routines_of
from fuzzyarm.inference.block import NotCoveredError
from fuzzyarm.inference.engine import Compiled
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import Defuzzifier
from fuzzyarm.symbolic.kinds import SHAPES
from fuzzyarm.symbolic.op import inf
from fuzzyarm.symbolic.operations import OPERATIONS

pytestmark = requires("node")

SHIPPED = (
    "alpha7", "balance", "fan", "fine7", "pd7", "pd7-study", "roompi", "slide7", "thermostat",
    "tipper",
)  # fmt: skip


def run(folder, script, data=None):
    """Run a module of node that prints JSON; return it, with null as NaN."""
    (folder / "run.mjs").write_text(script)
    words = ["node", str(folder / "run.mjs")]
    done = subprocess.run(
        words, input=json.dumps(data), capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


MANY = """
import { inferMany } from "./rules.mjs";
import { readFileSync } from "fs";
const given = JSON.parse(readFileSync(0));
for (const name in given) given[name] = Float64Array.from(given[name]);
const found = inferMany(given);
for (const name in found) found[name] = Array.from(found[name]);
console.log(JSON.stringify(found));
"""


def in_node(folder, rulebase, points):
    (folder / "rules.mjs").write_text(javascript_of(rulebase))
    found = run(folder, MANY, {name: list(column) for name, column in points.items()})
    return {
        name: np.array([np.nan if x is None else x for x in row]) for name, row in found.items()
    }


def points_of(rulebase, count):
    """Points in and beyond the ranges."""
    random = np.random.default_rng(len(rulebase.name))
    wide = {v.name: (v.low - 0.1 * (v.high - v.low), v.high + 0.1 * (v.high - v.low))
            for v in rulebase.inputs}  # fmt: skip
    return {name: random.uniform(*ends, count) for name, ends in wide.items()}


def is_plain(rulebase):
    """Whether only + - × ÷ min max occur: no function of a library."""
    named = json.dumps(numbers_of(rulebase)["functions"])
    curved = [kind.name for kind in SHAPES.values() if kind.fuzzy and not kind.straight]
    return not any(f'"{word}"' in named for word in (*curved, "power", "formula"))


# --- Twenty rule bases, ten thousand points of each, in one process ---

POINTS = 10_000

SUGENO = """
rulebase sugeno
input a 0 .. 10
input b 0 .. 10
output y 0 .. 30
term a few:  trapezoid 0 0 1 6 over trapezoid 0 0 1 4 height 0.8
term a many: trapezoid 2 8 10 10 over trapezoid 4 9 10 10 height 0.9
term b few:  gaussian 0 3 over gaussian 0 2.5 height 0.7
term b many: gaussian 10 4 over gaussian 10 3 height 0.9
term y low:  linear 5 + 0.5*a over linear 4 + 0.25*a
term y mid:  singleton 15 over singleton 13
term y high: linear 28 - 1*b
inference and product, or probor
inference y: defuzzifier karnik-mendel, aggregation sum
rule if a is few or b is not many then y is low with 0.5
rule if a is many and b is few then y is mid
rule if a is many or b is many then y is high
"""


def random_text(seed, kinds, inference, count, rules=14):
    """Return a rule base whose sentences have weights, hedges and parentheses."""
    random = np.random.default_rng(seed)
    inputs = "abcd"[:count]
    lines = [f"rulebase random{seed}", *(f"input {name} -1 .. 1" for name in inputs)]
    lines += ["output y -5 .. 5", f"inference {inference}, no-rule 0"]
    for name, low, high in [*((each, -1, 1) for each in inputs), ("y", -5, 5)]:
        for i in range(4):
            kind = str(random.choice(kinds))
            numbers = np.sort(
                random.uniform(low, high, {"triangle": 3, "trapezoid": 4}.get(kind, 2))
            )
            if kind in {"gaussian", "cosine"}:
                numbers = [numbers[0], 0.2 * (high - low)]
            said = " ".join(f"{x:.3f}" for x in numbers)
            height = " height 0.75" if i == 2 else ""
            lines.append(f"term {name} T{i}: {kind} {said}{height}")
    for _ in range(rules):
        terms = [f"{name} is {random.choice(['', 'not '])}T{random.integers(4)}" for name in inputs]
        first = f" {random.choice(['and', 'or'])} ".join(terms[:2])
        said = " and ".join([f"({first})", *terms[2:]])
        weight = random.choice(["", " with 0.5"])
        lines.append(f"rule if {said} then y is T{random.integers(4)}{weight}")
    return "\n".join(lines)


def by(text, method):
    return text.replace("karnik-mendel exact", method)


def twenty():
    """Yield rule bases, each with its name."""
    for name in SHIPPED:
        yield name, fuzzyarm.load(shipped(f"{name}.frb"))
    tipper = shipped("tipper2.frb").read_text()
    straight = ("triangle", "trapezoid", "ramp")
    texts = {
        "tipper2": tipper,
        "tipper2, samples": by(tipper, "karnik-mendel(101)"),
        "tipper2, Nie and Tan": by(tipper, "nie-tan"),
        "tipper2, samples of Nie and Tan": by(tipper, "nie-tan(101)"),
        "sugeno": SUGENO,
        "sugeno, Nie and Tan": SUGENO.replace("karnik-mendel", "nie-tan"),
        "straight": random_text(1, straight, "aggregation sum, defuzzifier centroid exact", 2),
        "envelope": random_text(2, straight, "implication min, defuzzifier centroid exact", 3, 5),
        "bisector": random_text(3, ("triangle", "trapezoid"), "defuzzifier bisector", 1, 2),
        "curved": random_text(
            4, ("gaussian", "cosine"), "and product, defuzzifier centroid(101)", 4
        ),
    }
    for name, text in texts.items():
        yield name, parse(text).rulebase


BULK = """
import { readFileSync, writeFileSync } from "fs";
for (const { name, numbers, inputs, points } of JSON.parse(readFileSync(0))) {
  const bytes = readFileSync(`${name}.in`);
  const all = new Float64Array(bytes.buffer, bytes.byteOffset, inputs * points);
  const columns = Array.from({ length: inputs }, (_, i) =>
    all.subarray(i * points, (i + 1) * points));
  const rows = new Engine(numbers).many(columns);
  const joined = new Float64Array(rows.length * points);
  rows.forEach((row, o) => joined.set(row, o * points));
  writeFileSync(`${name}.out`, new Uint8Array(joined.buffer));
}
console.log("null");
"""


@pytest.mark.slow
def test_twenty_rule_bases_have_the_values_of_python_at_ten_thousand_points(tmp_path):
    cases, given, expected = list(twenty()), [], []
    assert len(cases) == 20
    for number, (_, rulebase) in enumerate(cases):
        points = points_of(rulebase, POINTS)
        made = fuzzyarm.compiled(rulebase)
        assert made.kernel == "machine code", made.reason
        expected.append(made(dict(points)))
        np.concatenate(list(points.values())).tofile(tmp_path / f"{number}.in")
        given.append({"name": str(tmp_path / str(number)), "numbers": numbers_of(rulebase),
                      "inputs": len(points), "points": POINTS})  # fmt: skip
    run(tmp_path, engine_source() + BULK, given)
    for number, (name, rulebase) in enumerate(cases):
        rows = np.fromfile(tmp_path / f"{number}.out").reshape(-1, POINTS)
        for row, values in zip(rows, expected[number].values(), strict=True):
            ordinary = ~np.isnan(row)  # elsewhere a rule base states what holds, or another engine
            assert ordinary.mean() > 0.9, name
            if is_plain(rulebase):
                np.testing.assert_array_equal(row[ordinary], values[ordinary], err_msg=name)
            else:
                np.testing.assert_allclose(
                    row[ordinary], values[ordinary], rtol=0, atol=1e-12, err_msg=name
                )


CURVED = "gaussian 15 3 over gaussian 15 2"

ENDS = """
import { readFileSync } from "fs";
const { numbers, points } = JSON.parse(readFileSync(0));
const engine = new Engine(numbers);
console.log(JSON.stringify(points.map((point) => [engine.ends(point)[0], engine.at(point)[0]])));
"""


@pytest.mark.parametrize("shape", ["triangle 10 15 20 over triangle 11 15 19", CURVED])
def test_an_engine_has_both_ends_of_an_interval(shape, tmp_path):
    text = shipped("tipper2.frb").read_text()
    rulebase = parse(text.replace("triangle 10 15 20 over triangle 11 15 19", shape)).rulebase
    points = [[2.0, 3.0], [8.0, 3.0], [5.0, 9.5]]
    found = run(
        tmp_path, engine_source() + ENDS, {"numbers": numbers_of(rulebase), "points": points}
    )
    for point, (ends, value) in zip(points, found, strict=True):
        given = dict(zip(("service", "food"), point, strict=True))
        assert ends == pytest.approx(fuzzyarm.infer_interval(rulebase, given)["tip"], abs=1e-12)
        assert value == pytest.approx(sum(ends) / 2, abs=1e-12)


KERNEL = st.one_of(
    plain_mamdani(aggregations=("max", "sum"), implications=("min", "product")),
    plain_mamdani(kinds=STRAIGHT + SMOOTH, defuzzifier=Defuzzifier("centroid", 51)),
    plain_mamdani(kinds=STRAIGHT + SMOOTH, aggregations=("max", "probor")),
)


@pytest.mark.slow
@settings(max_examples=cases(8, 15))
@given(KERNEL)
def test_any_rule_base_has_the_values_of_the_kernel(tmp_path_factory, rulebase):
    folder = tmp_path_factory.mktemp("node")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FUZZYARM_NATIVE", "0")
        made = Compiled(rulebase)
    assert made.kernel == "python", made.reason
    points = points_of(rulebase, 12)
    expected = np.array([
        list((made.named_point(dict(zip(points, map(float, each), strict=True)))
              or dict.fromkeys(rulebase.outputs, np.nan)).values())
        for each in zip(*points.values(), strict=True)
    ]).T  # fmt: skip
    found = in_node(folder, rulebase, points).values()
    routines = routines_of(rulebase, precision="float64")
    for values, row, routine in zip(expected, found, routines, strict=True):
        ordinary = ~np.isnan(values)
        np.testing.assert_allclose(row[ordinary], values[ordinary], rtol=1e-12, atol=1e-12)
        if is_plain(rulebase):  # the bits are those of the C
            printed = routine.evaluate(*points.values())
            np.testing.assert_array_equal(row[ordinary], printed[ordinary])


def test_what_the_kernel_does_not_cover_is_refused_by_name(tmp_path):
    text = shipped("pd7.frb").read_text().replace("centroid exact", "mean-of-maximum")
    text = text.replace("aggregation max", "aggregation sum")
    assert "aggregation sum" in text
    (tmp_path / "maxima.frb").write_text(text)
    with pytest.raises(ExportError, match="mean-of-maximum of 'u'"):
        javascript_of(fuzzyarm.load(tmp_path / "maxima.frb"))


ALL = """
import { readFileSync } from "fs";
const { names, numbers } = JSON.parse(readFileSync(0));
const found = {};
const as = (x) => (typeof x === "boolean" ? Number(x) : Number.isFinite(x) ? x : String(x));
for (const [name, arity, logic] of names) {
  const values = numbers.map((text) => (logic ? Number(text) < 0 : Number(text)));
  found[name] = values.flatMap((a) => arity === 1 ? as(OPERATIONS[name](a)) :
    values.map((b) => as(arity === 2 ? OPERATIONS[name](a, b) : OPERATIONS[name](a < 0, a, b))));
}
console.log(JSON.stringify(found));
"""


def test_every_operation_is_that_of_the_table(tmp_path):
    numbers = [0.0, -0.5, 0.5, 1.0, -1.0, 1.5, 2.5, -2.5, 3.7, 1e300, -7.25]
    texts = [*map(repr, numbers), "Infinity", "-Infinity", "NaN"]
    names = [(name, each.arity, each.sort == "logic") for name, each in OPERATIONS.items()]
    found = run(tmp_path, engine_source() + ALL, {"names": names, "numbers": texts})
    for name, operation in OPERATIONS.items():
        values = [*numbers, inf, -inf, math.nan]
        values = [x < 0 for x in values] if operation.sort == "logic" else values
        if operation.arity == 1:
            expected = [operation.scalar(a) for a in values]
        elif operation.arity == 2:
            expected = [operation.scalar(a, b) for a in values for b in values]
        else:
            expected = [operation.scalar(a < 0, a, b) for a in values for b in values]
        same = [float(x) for x in found[name]]
        np.testing.assert_allclose(
            same, [float(x) for x in expected], rtol=1e-14, atol=0, err_msg=name
        )


LOOSE = """
import { readFileSync } from "fs";
const { numbers: [first, second], columns, count } = JSON.parse(readFileSync(0));
const [one, other] = [new Engine(first), new Engine(second)];
const given = columns.map((each) => Float64Array.from(each));
one.many(given);
one.patch(AT, NUMBERS);
if (count) one.patchWhole(count, 2);
const strengths = count ? [] : Array.from(one.fired([0.4, -1.3]).strengths);
const rows = [one, other].map((engine) => Array.from(engine.many(given)[0]));
console.log(JSON.stringify([...rows, strengths]));
"""


@pytest.mark.parametrize(
    ("loose", "line", "term", "numbers"),
    [
        ("e", "e NB: triangle -7 -5.5 -4", ("e", "NB"), "[-7, 0, -5.5, 1, -4, 0]"),
        ("u", "u PB: triangle 3 5 9", ("u", "PB"), "[3, 0, 5, 1, 5, 1, 6, 0.75]"),
    ],
)
def test_a_loose_layout_takes_other_numbers_in_place(loose, line, term, numbers, tmp_path):
    text = shipped("pd7.frb").read_text()
    (tmp_path / "before.frb").write_text(text)
    (tmp_path / "after.frb").write_text(text.replace("\ninference", f"term {line}\n\ninference"))
    before, after = (fuzzyarm.load(tmp_path / f"{name}.frb") for name in ("before", "after"))
    made = numbers_of(before, editable=loose)
    mark = {(mark["variable"], mark["term"]): mark for mark in made["marks"]}[term]
    script = LOOSE.replace("AT", str(mark["floats"])).replace("NUMBERS", numbers)
    columns = [np.clip(column, -6, 6).tolist() for column in points_of(before, 200).values()]
    data = {"numbers": [made, numbers_of(after)], "columns": columns}
    data["count"] = mark["row"] if loose == "u" else 0
    changed, expected, strengths = run(tmp_path, engine_source() + script, data)
    np.testing.assert_allclose(changed, expected, rtol=0, atol=1e-12 if loose == "u" else 0)
    if strengths:
        traced = fuzzyarm.explain(after, e=0.4, ce=-1.3)
        np.testing.assert_allclose(strengths, [rule.strength for rule in traced.rules], atol=1e-15)


def test_data_cannot_end_the_element_that_holds_it():
    text = script_json({"</script><!--": "&\u2028"})
    assert not set(text) & set("<>&\u2028")
    assert json.loads(text) == {"</script><!--": "&\u2028"}


def test_an_engine_is_one_text_for_all_rule_bases():
    with pytest.raises(NotCoveredError):
        numbers_of(replace(fuzzyarm.load(shipped("pd7.frb")), outputs=(), blocks=()))
    assert "eval(" not in engine_source()
    assert "new Function" not in engine_source()
