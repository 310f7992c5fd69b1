"""Every built-in kind × every writer: read back with its numbers, or refused by name."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from budget import crossed, part
from strategies import MONOTONIC, numbers_of

import fuzzyarm
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.exchange.export import ExportError, routines_of
from fuzzyarm.exchange.formats import PRODUCERS, parse, write
from fuzzyarm.exchange.live.skfuzzy import from_skfuzzy, to_skfuzzy
from fuzzyarm.language.model.rulebase import SAMPLINGS, Defuzzifier, RuleBase
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, HEDGES, SHAPES, SNORMS, TNORMS
from fuzzyarm.table.files import SUFFIXES
from tests.export.c_programs import run_c

pytestmark = pytest.mark.filterwarnings("ignore:Passing more than 2 positional")

WRITTEN = {
    "points": "(-3, 0) (-1, 0.4) (0.5, 1) (3, 0.1)",
    "linear": "0.5*a - 0.25*b + 1",
    "formula": '"0.5 * a + b ^ 2 / 8"',
}
"""Kinds whose numbers are more than a row."""


def written(name: str) -> str:
    """Return the numbers of a shape as its line has them."""
    return WRITTEN.get(name) or " ".join(f"{x:g}" for x in numbers_of(name, -4.0, 4.0))


Case = tuple[tuple[str, str], dict[str, str]]
SETS = [name for name, shape in SHAPES.items() if shape.fuzzy]

TEXT = """rulebase made
input  a  -4 .. 4
input  b  -4 .. 4
output u  -4 .. 4
terms a, b, u: triangles N Z P
{more}
inference and {conjunction}, or {disjunction}, implication {implication}
inference aggregation {aggregation}, defuzzifier {defuzzifier}, no-rule {no_rule}
inference outside {outside}
rule if a is {hedge} {term} and b is N then u is {consequent} N
rule if a is P or b is Z then u is {consequent} {value}
rule if b is P and a is not N then u is {consequent} P with 0.5
"""
USUAL = {
    "conjunction": "min", "disjunction": "max", "implication": "min", "aggregation": "max",
    "defuzzifier": "centroid exact", "no_rule": "0", "outside": "clamp", "hedge": "",
    "consequent": "", "term": "Z", "value": "Z", "more": "",
}  # fmt: skip


def hedge_words(name: str) -> str:
    return f"{name}(1.7)" if HEDGES[name].parameters else name


def shape_cases() -> Iterator[Case]:
    """Yield a term of each shape: of an input, of an output, and of Tsukamoto's."""
    for name in SHAPES:
        line = f"term u S: {name} {written(name)}"
        if name in SETS:
            more = f"term a S: {name} {written(name)}"
            yield ("input", name), {"term": "S", "more": more}
        if name in ("singleton", "linear", "formula"):
            values = "term u N: singleton -3\nterm u Z: singleton 0\nterm u P: singleton 2.5\n"
            changed = {"more": values + line, "defuzzifier": "weighted-average"}
        else:
            changed = {"more": line}
        yield ("output", name), {"value": "S", **changed}
        if name in MONOTONIC:
            ramps = "term u N: ramp 4 -4\nterm u Z: ramp -4 0\nterm u P: ramp -4 4\n"
            changed = {"more": ramps + line, "defuzzifier": "tsukamoto"}
            yield ("tsukamoto", name), {"value": "S", **changed}


def norm_cases() -> Iterator[Case]:
    """Yield each norm in each of its roles, and each hedge."""
    for name in TNORMS:
        yield ("and", name), {"conjunction": name}
        yield ("implication", name), {"implication": name}
    for name, norm in SNORMS.items():
        if not norm.aggregates:
            yield ("or", name), {"disjunction": name}
        yield ("aggregation", name), {"aggregation": name}
    for name in HEDGES:
        yield ("hedge", name), {"hedge": hedge_words(name)}
        yield ("consequent", name), {"consequent": hedge_words(name)}


def setting_cases() -> Iterator[Case]:
    """Yield each defuzzifier, sampling, value for the case that no rule fires, way outside."""
    for name in DEFUZZIFIERS:
        if DEFUZZIFIERS[name].inverts:
            continue
        yield ("defuzzifier", name), {"defuzzifier": name}
        if not DEFUZZIFIERS[name].weighs:
            for sampling in SAMPLINGS:
                if sampling == "joined" and not DEFUZZIFIERS[name].joins:
                    continue  # an error of the language
                yield (sampling, name), {"defuzzifier": f"{name}(60, {sampling})"}
    for word in ("error", "nan", "hold", "1.25"):
        yield ("no-rule", word), {"no_rule": word}
    for word in ("clamp", "extend", "error"):
        yield ("outside", word), {"outside": word}


CASES = dict([*shape_cases(), *norm_cases(), *setting_cases()])
"""Settings by what they are about: the role, and the word that a refusal has to have."""
IDS = [" ".join(case) for case in CASES]
POINTS = [
    *itertools.product((-4.0, -1.03, -0.3, 0.5, 1.4, 4.0), (-4.0, -2.2, 0.1, 3.1)),
    (-5.5, 0.3),
    (0.3, 7.0),
]


def model(case: tuple[str, str]) -> RuleBase:
    parsed = fuzzyarm.parse(TEXT.format(**{**USUAL, **CASES[case]}))
    assert parsed.rulebase is not None, [str(each) for each in parsed.diagnostics]
    return parsed.rulebase


def sampled_for(rulebase: RuleBase, producer: str | None, case: tuple[str, str]) -> RuleBase:
    """Sample an exact output as the program does, so that its own words are what is tested."""
    samples = {
        "fuzzylite": (1000, "midpoints"), "jfuzzylogic": (1000, "left"),
        "matlab": (101, "endpoints"), "octave": (101, "endpoints"),
    }  # fmt: skip
    output = rulebase.outputs[0]
    if producer not in samples or case[0] in SAMPLINGS:
        return rulebase
    if output.defuzzifier.method in ("weighted-average", "weighted-sum", "tsukamoto"):
        return rulebase
    method = Defuzzifier(output.defuzzifier.method, *samples[producer])
    return replace(rulebase, outputs=(replace(output, defuzzifier=method),))


@cache
def truths(rulebase: RuleBase) -> list[float | str]:
    """Return what a rule base gives at the points; equal ones, read back, are asked once."""
    return [outcome(rulebase, a, b) for a, b in POINTS]


def outcome(rulebase: RuleBase, a: float, b: float) -> float | str:
    """Return the value at a point, or the name of the error."""
    try:
        return float(fuzzyarm.infer(rulebase, {"a": a, "b": b}, held={"u": 0.75})["u"])
    except FuzzyarmError as error:
        return type(error).__name__


def agree(one: float | str, other: float | str) -> bool:
    if isinstance(one, str) or isinstance(other, str):
        return one == other
    return abs(one - other) <= 1e-9 or (math.isnan(one) and math.isnan(other))


def names_it(case: tuple[str, str], messages: str) -> bool:
    """Whether a refusal says what it is about."""
    role, word = case
    if role in SAMPLINGS:
        return role in messages or word in messages or "samples" in messages
    if role == "tsukamoto":
        return role in messages or word in messages
    also = {"no-rule": ("no rule",), "outside": ("range", "clamp")}.get(role, ())
    return word in messages or any(each in messages for each in also)


WRITERS = [
    (".frb", None),
    *((suffix, producer) for suffix, programs in PRODUCERS.items() for producer in programs),
]


def named(side: tuple[str, str | None]) -> str:
    return " ".join(map(str, side))


@pytest.mark.parametrize(("case", "writer"), crossed(CASES, WRITERS), ids=named)
def test_other_formats(case, writer):
    suffix, producer = writer
    rulebase = sampled_for(model(case), producer, case)
    for lossy in (False, True):
        exported = write(rulebase, suffix, producer=producer, lossy=lossy)
        if exported.text is None:
            assert exported.errors
            messages = " ".join(each.message for each in exported.errors)
            # What the format lacks of everything (a value for the case that no rule fires,
            # say) is no fault of this kind: with --lossy that is left.
            if lossy:
                assert names_it(case, messages), messages
            continue
        again = parse(exported.text, suffix, producer=producer, lossy=lossy)
        lost = any(each.severity == "warning" for each in exported.diagnostics)
        if again.rulebase is None:
            assert lost, [str(each) for each in again.errors]
            continue
        lost |= any(each.severity == "warning" for each in again.diagnostics)
        if lost:
            continue
        both = zip(truths(rulebase), truths(again.rulebase), strict=True)
        for (a, b), (one, other) in zip(POINTS, both, strict=True):
            assert agree(one, other), (a, b, one, other, exported.text)


@pytest.mark.parametrize("case", CASES, ids=IDS)
def test_scikit_fuzzy(case):
    rulebase = model(case)
    for lossy in (False, True):
        made, found = to_skfuzzy(rulebase, samples=161, lossy=lossy)
        messages = " ".join(each.message for each in found if each.is_error)
        if made is None:
            assert messages
            if lossy:
                assert names_it(case, messages) or "'S'" in messages
            continue
        again = from_skfuzzy(made, lossy=lossy)
        if not found:
            assert again.rulebase is not None, again.errors


@pytest.mark.parametrize("case", CASES, ids=IDS)
def test_tables(case, tmp_path):
    rulebase = model(case)
    refused = ""
    try:
        table = fuzzyarm.compile_table(rulebase, levels=5, rounding=0)
    except FuzzyarmError as error:
        refused = str(error)
    if refused:
        assert case[0] == "no-rule"
        assert "no rule fires" in refused or "hold" in refused
        return
    for k, a in enumerate(table.axes[0].levels):
        for j, b in enumerate(table.axes[1].levels):
            assert agree(outcome(rulebase, a, b), float(table.values[k, j]))
    for suffix in SUFFIXES:
        path = tmp_path / f"made{suffix}"
        fuzzyarm.write_table(table, path)
        again = fuzzyarm.read_table(path)
        np.testing.assert_array_equal(again.values, table.values)
        assert [axis.levels for axis in again.axes] == [axis.levels for axis in table.axes]


@pytest.mark.slow
def test_direct_inference_in_c(tmp_path):
    """All that is written goes through one compiler run; the rest is refused by name.

    In the suite every fifth of it goes through the compiler, a part of each role; the programs
    themselves are evaluated for all.
    """
    routines, columns, wanted, refused = [], [], [], {}
    points = np.array(POINTS).T
    for case in CASES:
        rulebase = model(case)
        try:
            (routine,) = routines_of(rulebase, precision="float64")
        except ExportError as error:
            refused[case] = str(error)
            continue
        held = [np.full(len(POINTS), 0.75)] if routine.program.holds else []
        found = routine.evaluate(*points, *held)
        truth = [math.nan if isinstance(each, str) else each for each in truths(rulebase)]
        if case == ("outside", "error"):  # a PLC has no exceptions: values are clamped there
            truth = truths(model(("outside", "clamp")))
        np.testing.assert_allclose(found, truth, rtol=0, atol=1e-9, err_msg=str(case))
        routines.append(routine)
        columns.append([*points, *held])
        wanted.append(truth)
    assert not {k: v for k, v in refused.items() if not names_it(k, v) and "'S'" not in v}
    assert len(routines) > len(CASES) // 4
    routines, columns, wanted = (part(each, 5) for each in (routines, columns, wanted))
    results = run_c(routines, columns, tmp_path)
    for routine, found, truth in zip(routines, results, wanted, strict=True):
        np.testing.assert_allclose(found, truth, rtol=0, atol=1e-9, err_msg=str(routine.rulebase))


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES, ids=IDS)
def test_engines(case):
    rulebase = model(case)
    truth = truths(rulebase)
    fast = fuzzyarm.compiled(rulebase)
    for engine in (lambda **given: fuzzyarm.infer(rulebase, **given), fast):
        for wanted, (a, b) in zip(truth, POINTS, strict=True):
            try:
                found = engine(a=np.array([a, a]), b=np.array([b, b]), held={"u": 0.75})["u"][1]
            except FuzzyarmError as error:
                assert type(error).__name__ == wanted  # noqa: PT017
                continue
            assert isinstance(wanted, float)
            assert found == pytest.approx(wanted, abs=1e-11 * 8, nan_ok=True)


def test_every_kind_is_a_case():
    for name in SHAPES:
        assert any(name == word for role, word in CASES if role in ("input", "output"))
    assert {word for role, word in CASES if role == "hedge"} == set(HEDGES)
