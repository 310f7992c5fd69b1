"""Text and meaning: each gives the other back, for every model that can be made."""

from dataclasses import replace

from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import plain_mamdani, rulebases

from fuzzyarm.language import format_text, parse, write
from fuzzyarm.language.check import check
from fuzzyarm.language.tokens import name_text
from fuzzyarm.text.names import is_plain_name
from fuzzyarm.text.numbers import number_text


@settings(max_examples=cases(20, 50), deadline=None)
@given(rulebases(odd_names=True, decorated=True))
def test_what_is_written_reads_back_to_the_same_model(rulebase):
    text = write(rulebase)
    parsed = parse(text)
    assert [d for d in parsed.diagnostics if d.is_error] == []
    assert parsed.rulebase == rulebase


@settings(max_examples=cases(20, 40), deadline=None)
@given(rulebases(odd_names=True, decorated=True))
def test_formatting_changes_no_meaning_and_settles_at_once(rulebase):
    text = write(rulebase)
    formatted = format_text(text)
    assert format_text(formatted) == formatted
    assert parse(formatted).rulebase == rulebase


@settings(max_examples=cases(40, 100), deadline=None)
@given(plain_mamdani(), st.randoms(use_true_random=False))
def test_spacing_means_nothing(rulebase, random):
    text = write(rulebase)
    loose = "\n".join(
        line[: len(line) - len(line.lstrip())]
        + "".join(c + " " * random.randint(0, 3) if c == " " else c for c in line.lstrip())
        for line in text.splitlines()
    )
    assert format_text(loose) == text


@settings(max_examples=cases(30, 60), deadline=None)
@given(plain_mamdani())
def test_checks_never_fail_on_a_sound_model(rulebase):
    parsed = parse(write(rulebase))
    with_text = check(parsed.rulebase, parsed.document)
    without = check(rulebase)
    assert {d.name for d in without} - {"missing-rule"} <= {d.name for d in with_text}


@given(st.floats(allow_nan=False))
def test_every_number_is_written_without_loss(value):
    text = number_text(value)
    assert float(text) == value
    assert str(float(text)) == str(value)


@given(st.text(min_size=1, max_size=12))
def test_every_name_reads_back(name):
    text = f"rulebase {name_text(name)}"
    assert parse(text).partial.name == name
    if name_text(name) == name:
        assert is_plain_name(name)


@settings(max_examples=cases(20, 40), deadline=None)
@given(rulebases(), st.sampled_from(["clamp", "extend", "error"]))
def test_settings_that_all_variables_share_are_one_line(rulebase, outside):
    first = rulebase.outputs[0]
    outputs = tuple(
        replace(
            each, outside=outside, aggregation=first.aggregation, no_rule=first.no_rule,
            defuzzifier=first.defuzzifier,
        )
        for each in rulebase.outputs
    )  # fmt: skip
    inputs = tuple(replace(each, outside=outside) for each in rulebase.inputs)
    alike = replace(rulebase, inputs=inputs, outputs=outputs)
    text = write(alike)
    assert text.count("\ninference ") == 2
    assert parse(text).partial == alike
    # One that differs has a line of its own.
    other = {"clamp": "extend", "extend": "error", "error": "clamp"}[outside]
    odd = replace(alike, inputs=(replace(inputs[0], outside=other), *inputs[1:]))
    if len(inputs) + len(outputs) > 2:
        assert f"\ninference {name_text(inputs[0].name)}: outside {other}\n" in write(odd)
    assert parse(write(odd)).partial == odd


def test_a_comment_within_an_axis_stays_as_far_in_as_its_line():
    text = (
        "controller c\nperiod 10 ms\n\naxis a\n  # the error\n  e = error of x  # behind\n\n"
        "  # and out\n  drive u = e\n"
    )
    assert format_text(text) == text
