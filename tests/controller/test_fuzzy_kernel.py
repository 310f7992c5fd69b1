"""The inference of the control loop against the engine that reads like the definition."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rule_bases import rule_bases

from fuzzyarm.controller.fuzzy_kernel import inferred, rule_numbers
from fuzzyarm.controller.sources import SourceError, shipped_rulebase
from fuzzyarm.inference import InferenceError, infer
from fuzzyarm.kernels import build
from fuzzyarm.language import parse

PLACES = st.one_of(
    st.integers(-28, 28).map(lambda k: k / 4),
    st.floats(-7, 7, allow_nan=False),
)
PLAIN = build(inferred, compiled=False)


def evaluated(rulebase, point, kernel=PLAIN):
    made = rule_numbers(rulebase)
    scratch = [*point, *([math.nan] * (made.room - len(point)))]
    if kernel is not PLAIN:
        return kernel(np.array(made.numbers), 0, np.array(scratch), 0)
    return kernel(list(made.numbers), 0, scratch, 0)


@given(rule_bases(), st.data())
def test_random_rule_bases_agree_with_the_engine(rulebase, data):
    point = [data.draw(PLACES) for _ in rulebase.inputs]
    names = [variable.name for variable in rulebase.inputs]
    try:
        wanted = infer(rulebase, dict(zip(names, point, strict=True)))["u"]
    except InferenceError:
        return  # a rule fired, but there is no area: the kernel gives the value for no rule
    assert evaluated(rulebase, point) == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize("name", ["pd7", "pd7-study", "alpha7", "alpha7-study", "fine7"])
def test_shipped_rule_bases_agree_with_the_engine_and_compiled_to_the_last_bit(name):
    rulebase = shipped_rulebase(f"{name}.frb")
    fast = build(inferred, compiled=True)
    output = rulebase.outputs[0].name
    random = np.random.default_rng(7)
    points = [*random.uniform(-7, 7, (60, 2)), *random.uniform(-0.2, 0.2, (60, 2))]
    points += [np.array([a, b]) for a in (-6, -1.5, 0, 0.03, 3) for b in (-6, -0.25, 0, 6)]
    for e, ce in points:
        wanted = infer(rulebase, e=float(e), ce=float(ce))[output]
        got = evaluated(rulebase, [float(e), float(ce)])
        assert got == pytest.approx(wanted, abs=1e-12)
        assert evaluated(rulebase, [float(e), float(ce)], fast) == got


HEAD = "rulebase x\ninput e -1 .. 1\ninput ce -1 .. 1\noutput u -1 .. 1\n"
TERMS = "terms e, ce, u: triangles N Z P\n"


@pytest.mark.parametrize(
    ("text", "word"),
    [
        (HEAD + TERMS + "rule if e is N or ce is P then u is P", "conjunction"),
        (HEAD + TERMS.replace("e, ce, u", "e, u") + "terms ce: gaussians N Z P\n"
         "rule if e is N and ce is P then u is P", "piecewise linear"),
        (HEAD + TERMS + "inference e: outside extend\nrule if e is N and ce is P then u is P",
         "clamped"),
        (HEAD + TERMS + "inference aggregation sum\nrule if e is N and ce is P then u is P",
         "aggregation max"),
        (HEAD + TERMS + "output v 0 .. 1\nterms v: triangles A B\n"
         "rule if e is N and ce is P then u is P, v is A", "2 outputs"),
    ],
)  # fmt: skip
def test_what_the_kernel_cannot_evaluate_is_refused_with_a_reason(text, word):
    parsed = parse(text)
    assert parsed.rulebase is not None, parsed.diagnostics
    with pytest.raises(SourceError, match=word):
        rule_numbers(parsed.rulebase)
