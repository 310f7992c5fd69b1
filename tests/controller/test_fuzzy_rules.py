"""The rules of a control law, evaluated at every step, against plain inference."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rule_bases import rule_bases

from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.control.controllers import Sources, controller
from fuzzyarm.control.controllers.code import SourceError
from fuzzyarm.control.controllers.program import evaluate_view, rule_block
from fuzzyarm.control.loop import Options, simulate
from fuzzyarm.inference import InferenceError, infer
from fuzzyarm.inference import kernel as inference_kernel
from fuzzyarm.language import load_rulebase, parse
from fuzzyarm.plant import reach
from fuzzyarm.symbolic.kernels import routine

POINTS = st.one_of(
    st.integers(-28, 28).map(lambda k: k / 4),
    st.floats(-7, 7, allow_nan=False),
)


def evaluated(rulebase, points, *, compiled=False, bindings=None):
    numbers, first, result, _ = rule_block(rulebase, compiled=compiled)
    function = inference_kernel.evaluate if compiled or bindings else evaluate_view
    conclude = routine(function, 1, bindings, compiled=compiled)
    values = []
    for point in points:
        block = numbers.copy()
        block[first : first + len(point)] = point
        with np.errstate(all="ignore"):  # as in a run
            conclude(block)
        values.append(float(block[result]))
    return values


@pytest.mark.parametrize("compiled", [False, True])
def test_what_is_made_for_grids_has_the_bits_of_what_is_made_for_all(compiled):
    rulebase = load_rulebase(shipped("pd7.frb"))
    assert inference_kernel.bindings_for(rule_block(rulebase, compiled=compiled).numbers)
    points = np.random.default_rng(3).uniform(-7, 7, (40, 2))
    other = evaluated(rulebase, points, compiled=compiled, bindings=inference_kernel.GRID)
    assert evaluated(rulebase, points, compiled=compiled) == other


@pytest.mark.parametrize("name", ["pd7-study", "tipper"])
def test_what_is_not_such_a_grid_is_not_taken_for_one(name):
    assert not inference_kernel.bindings_for(
        rule_block(load_rulebase(shipped(f"{name}.frb")), compiled=False).numbers
    )


@pytest.mark.slow
@given(rule_bases(), st.data())
def test_random_rule_bases_agree_with_the_engine(rulebase, data):
    point = [data.draw(POINTS) for _ in rulebase.inputs]
    names = [variable.name for variable in rulebase.inputs]
    try:
        wanted = infer(rulebase, dict(zip(names, point, strict=True)))["u"]
    except InferenceError:
        return  # a rule fired, but there is no area: the kernel gives the value for no rule
    assert evaluated(rulebase, [point]) == [pytest.approx(wanted, abs=1e-9)]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["pd7", "pd7-study", "alpha7", "alpha7-study", "fine7"])
def test_shipped_rule_bases_agree_with_the_engine_and_compiled_to_the_last_bit(name):
    rulebase = load_rulebase(shipped(f"{name}.frb"))
    output = rulebase.outputs[0].name
    random = np.random.default_rng(7)
    points = [*random.uniform(-7, 7, (60, 2)), *random.uniform(-0.2, 0.2, (60, 2))]
    points += [np.array([a, b]) for a in (-6, -1.5, 0, 0.03, 3) for b in (-6, -0.25, 0, 6)]
    wanted = [infer(rulebase, e=float(e), ce=float(ce))[output] for e, ce in points]
    got = evaluated(rulebase, points)
    assert got == pytest.approx(wanted, abs=1e-12)
    assert evaluated(rulebase, points, compiled=True) == got


HEAD = "rulebase x\ninput e -6 .. 6\ninput ce -6 .. 6\noutput u -6 .. 6\n"
TERMS = "terms e, ce, u: triangles N Z P\n"
RULES = (
    "rule if e is N and ce is P then u is P\n"
    "rule if e is P or ce is N then u is N\n"
    "rule if e is Z then u is Z\n"
)


@pytest.mark.slow
@pytest.mark.parametrize(
    "text",
    [
        HEAD + TERMS + RULES,
        HEAD + "terms e, ce, u: gaussians N Z P\noutput defuzzifier centroid(101)\n" + RULES,
        HEAD + TERMS + "inference e: outside extend\n" + RULES,
        HEAD + TERMS + "inference aggregation sum\ninference and hamacher\n" + RULES,
        HEAD + TERMS + RULES + "rule if (e is N or ce is P) and ce is Z then u is P\n",
        HEAD + TERMS + "inference defuzzifier bisector\n" + RULES,
    ],
)
def test_a_controller_takes_any_shape_and_norm(text):
    text = text.replace("output defuzzifier", "inference defuzzifier")
    parsed = parse(text)
    assert parsed.rulebase is not None, parsed.diagnostics
    points = np.random.default_rng(3).uniform(-6, 6, (40, 2))
    wanted = [infer(parsed.rulebase, e=float(e), ce=float(ce))["u"] for e, ce in points]
    assert evaluated(parsed.rulebase, points) == pytest.approx(wanted, abs=1e-9)
    made = controller("fuzzy-direct", sources=Sources(rulebase=parsed.rulebase))
    run = simulate(made, reach(segment=0.1, hold=0.1), options=Options(compiled=False))
    # Where inputs are not clamped, no rule fires far outside and there is no torque.
    assert run.diverged is None or "extend" in text


@pytest.mark.parametrize(
    ("text", "word"),
    [
        (HEAD + TERMS + "inference aggregation sum, defuzzifier mean-of-maximum\n"
         "rule if e is N then u is P", "maximum"),
    ],
)  # fmt: skip
def test_what_the_kernel_cannot_evaluate_is_refused_with_a_reason(text, word):
    parsed = parse(text)
    assert parsed.rulebase is not None, parsed.diagnostics
    with pytest.raises(SourceError, match=word):
        rule_block(parsed.rulebase, compiled=False)
