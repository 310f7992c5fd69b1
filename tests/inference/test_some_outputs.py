"""`infer` for some outputs: only what they depend on is needed and evaluated."""

from __future__ import annotations

import numpy as np
import pytest
from budget import cases
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.inference import MissingInputError, UnknownNameError, infer
from fuzzyarm.inference.plan import part_for
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import RuleBase
from tests.strategies import input_points, rulebases


def model() -> RuleBase:
    text = """rulebase some
input a 0 .. 1
input b 0 .. 1
input c 0 .. 1
output u 0 .. 10
output v 0 .. 10
output w -20 .. 20
terms a, b, c, u: triangles LO HI
term v LO: singleton 1
term v HI: singleton 3
term w flat: linear 4*c + 1
term w steep: linear 8*c + 2
inference v: defuzzifier weighted-average
inference w: defuzzifier weighted-average
block first
  rule if a is LO then u is HI and v is LO
  rule if a is HI then u is LO
  rule if b is HI then v is HI
block second
  rule if u is HI then w is flat
  rule if u is LO then w is steep
"""
    parsed = parse(text)
    assert parsed.rulebase is not None, [str(each) for each in parsed.diagnostics]
    return parsed.rulebase


def test_only_the_inputs_that_an_output_depends_on_are_needed() -> None:
    rulebase = model()
    whole = infer(rulebase, a=0.3, b=0.6, c=0.5)
    assert infer(rulebase, a=0.3, outputs=["u"]) == {"u": whole["u"]}
    assert infer(rulebase, a=0.3, b=0.6, outputs=["v", "u"]) == {"v": whole["v"], "u": whole["u"]}
    # w reads u, and c by a coefficient; b is given and not needed.
    assert infer(rulebase, a=0.3, b=0.6, c=0.5, outputs=["w"]) == {"w": whole["w"]}
    assert infer(rulebase, a=0.3, c=0.5, outputs=["w"]) == {"w": whole["w"]}
    many = infer(rulebase, a=np.array([0.3, 0.7]), outputs=["u"])["u"]
    assert many[0] == pytest.approx(whole["u"], abs=1e-12)
    assert {each.name for each in part_for(rulebase, ["u"]).inputs} == {"a"}
    assert part_for(rulebase, ["u", "v", "w"]) is rulebase


def test_what_is_missing_or_unknown_is_named() -> None:
    rulebase = model()
    with pytest.raises(MissingInputError, match="input b"):
        infer(rulebase, a=0.3, outputs=["v"])
    with pytest.raises(UnknownNameError, match="output 'y'"):
        infer(rulebase, a=0.3, outputs=["y"])
    with pytest.raises(UnknownNameError, match="input 'd'"):
        infer(rulebase, a=0.3, d=0.1, outputs=["u"])


@pytest.mark.slow
@settings(deadline=None, max_examples=cases(15, 80), suppress_health_check=list(HealthCheck))
@given(st.data())
def test_any_part_gives_the_numbers_of_the_whole(data: st.DataObject) -> None:
    rulebase = data.draw(rulebases())
    points = data.draw(input_points(rulebase, 2))
    held = {each.name: 0.5 * (each.low + each.high) for each in rulebase.outputs}
    point = {name: values[0] for name, values in points.items()}
    for output in rulebase.outputs:
        try:
            whole = infer(rulebase, point, held=held)
        except FuzzyarmError:
            continue
        part = part_for(rulebase, [output.name])
        needed = {each.name: point[each.name] for each in part.inputs}
        found = infer(rulebase, needed, held=held, outputs=[output.name])
        assert found[output.name] == whole[output.name]
