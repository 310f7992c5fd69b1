"""A term gets another kind of shape: its place and its width stay as far as the kinds allow."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.language.edit import ReshapeError, apply_edits, read, set_kind
from fuzzyarm.language.model.alike import KINDS, UnlikeError, alike
from fuzzyarm.language.model.rulebase import Shape
from fuzzyarm.language.model.shapes import membership_function

LOW, HIGH = -6.0, 6.0
BOUNDED = ("triangle", "trapezoid", "rectangle", "pi", "gaussian", "two-sided-gaussian", "bell",
           "cosine")  # fmt: skip

steps = st.tuples(st.floats(-5, 3), st.floats(0.2, 2), st.floats(0.0, 2), st.floats(0.2, 2))


@pytest.mark.slow
@given(steps, st.sampled_from([1.0, 0.4]), st.sampled_from(BOUNDED))
def test_one_half_and_the_top_stay_where_both_kinds_have_flanks(numbers, height, kind):
    a, rise, flat, fall = numbers
    shape = Shape("trapezoid", (a, a + rise, a + rise + flat, a + rise + flat + fall), height)
    made = alike(shape, kind, LOW, HIGH, 1.0)
    degree = membership_function(made)
    assert (made.kind, made.height) == (kind, height)
    left, right = a + 0.5 * rise, a + rise + flat + 0.5 * fall
    middle = a + rise + 0.5 * flat
    if kind != "rectangle":
        assert degree(middle) == pytest.approx(height, rel=0.02)
    if kind in {"trapezoid", "pi", "two-sided-gaussian", "triangle"}:
        assert [degree(left), degree(right)] == pytest.approx([0.5 * height] * 2, rel=0.02)
    else:  # both sides alike: the width is that of both
        # Not at the ends themselves: there a rectangle jumps.
        width = right - left
        inside = max(left + 0.01 * width, min(right - 0.01 * width, middle - 0.49 * width))
        assert degree(inside) > 0.3 * height
        # A bell made of gentle flanks has long tails.
        assert degree(left - (right - left)) < (0.25 if kind == "bell" else 0.2) * height


@given(steps, st.sampled_from(["ramp", "s", "z", "sigmoid"]))
def test_a_flank_stays(numbers, kind):
    a, rise, flat, fall = numbers
    shape = Shape("trapezoid", (a, a + rise, a + rise + flat, a + rise + flat + fall))
    degree = membership_function(alike(shape, kind, LOW, HIGH, 1.0))
    left, right = a + 0.5 * rise, a + rise + flat + 0.5 * fall
    near = {"s": [left], "z": [right]}.get(kind, [left, right])
    assert min(abs(degree(x) - 0.5) for x in near) < 0.02


@given(steps, st.sampled_from(["trapezoid", "pi"]), st.sampled_from(["trapezoid", "pi"]))
def test_back_again_it_is_what_it_was(numbers, kind, other):
    a, rise, flat, fall = numbers
    shape = Shape(kind, (a, a + rise, a + rise + flat, a + rise + flat + fall))
    back = alike(alike(shape, other, LOW, HIGH, 1.0), kind, LOW, HIGH, 1.0)
    assert back.parameters == pytest.approx(shape.parameters, abs=0.35 * max(rise, fall))


def test_shoulders_stay_open_where_they_can():
    shoulder = Shape("trapezoid", (-math.inf, -math.inf, -3.0, -1.0))
    assert alike(shoulder, "ramp", LOW, HIGH, 1.0).parameters == (-1.0, -3.0)
    assert alike(shoulder, "z", LOW, HIGH, 1.0).parameters == (-3.0, -1.0)
    sigmoid = alike(shoulder, "sigmoid", LOW, HIGH, 1.0)
    assert sigmoid.parameters == (-2.0, -2.0)
    back = alike(sigmoid, "trapezoid", LOW, HIGH, 1.0).parameters
    assert back[:2] == (-math.inf, -math.inf)
    assert alike(shoulder, "triangle", LOW, HIGH, 1.0).parameters == (-14.0, -6.0, 2.0)
    with pytest.raises(UnlikeError, match="does not rise"):
        alike(shoulder, "s", LOW, HIGH, 1.0)
    with pytest.raises(UnlikeError, match="same height everywhere"):
        alike(
            Shape("trapezoid", (-math.inf, -math.inf, math.inf, math.inf)),
            "triangle",
            LOW,
            HIGH,
            1.0,
        )


@pytest.mark.parametrize("kind", [each for each in KINDS if each != "singleton"])
def test_a_term_of_a_family_gets_its_kind_in_a_line_of_its_own(kind):
    text = shipped("pd7.frb").read_text()
    changed = apply_edits(text, set_kind(read(text), "e", "PS", kind))
    reading = read(changed)
    assert [each.message for each in reading.parsed.diagnostics if each.is_error] == []
    assert reading.model.variable("e").term("PS").shape.kind == kind
    line = next(each for each in changed.splitlines() if each.startswith(f"term e PS: {kind} "))
    assert changed.replace(line + "\n", "") == text


def test_both_functions_of_type_2_change_or_none():
    text = shipped("tipper2.frb").read_text()
    for kind in ("triangle", "gaussian", "pi", "s"):
        changed = apply_edits(text, set_kind(read(text), "food", "rancid", kind))
        term = read(changed).model.variable("food").term("rancid")
        assert (term.shape.kind, term.lower.kind) == (kind, kind)
        assert not [each for each in read(changed).parsed.diagnostics if each.is_error]
    with pytest.raises(ReshapeError, match="singleton over a singleton"):
        set_kind(read(text), "food", "rancid", "singleton")


def test_what_has_no_place_is_refused():
    text = shipped("pd7.frb").read_text()
    for variable, term, kind, words in (
        ("e", "XX", "triangle", "declares no term"),
        ("x", "ZE", "triangle", "declares no variable"),
        ("e", "ZE", "banana", "no term is made a 'banana'"),
    ):
        with pytest.raises(ReshapeError, match=words):
            set_kind(read(text), variable, term, kind)
