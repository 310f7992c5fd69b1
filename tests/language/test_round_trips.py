"""Text and meaning: each gives the other back, for every model that can be made."""

import contextlib
from dataclasses import MISSING, fields, is_dataclass, replace
from pathlib import Path

import pytest
from budget import cases
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from strategies import plain_mamdani, rulebases

from fuzzyarm.apps.cli import main
from fuzzyarm.base.diagnostic import MAX_LINE, RuleBaseError
from fuzzyarm.base.names import is_plain_name
from fuzzyarm.base.numbers import number_text
from fuzzyarm.exchange.files import load
from fuzzyarm.exchange.formats import same_model
from fuzzyarm.language import format_text, parse, write
from fuzzyarm.language.check import check
from fuzzyarm.language.model import rulebase as model
from fuzzyarm.language.model.rulebase import And, RuleBase
from fuzzyarm.language.tokens import name_text


def parts_of(value):
    """Yield every record in a model."""
    if is_dataclass(value):
        yield value
        value = [getattr(value, each.name) for each in fields(value)]
    if isinstance(value, list | tuple):
        for each in value:
            yield from parts_of(each)


def options_of(record):
    """Yield the fields that count and may be left out, each with its default."""
    for each in fields(record):
        if each.compare and each.default is not MISSING:
            yield each.name, each.default


RECORDS = {
    kind
    for kind in vars(model).values()
    if is_dataclass(kind) and kind.__module__ == model.__name__ and kind is not model.Variable
}


class AllSeenError(Exception):
    """Every field has been seen."""


@pytest.mark.slow
def test_every_field_of_a_model_is_drawn():
    left = {(kind, name) for kind in RECORDS for name, _ in options_of(kind)}
    left.discard((model.Term, "lower"))  # tests/inference/test_type2.py has those of type 2

    @settings(max_examples=300, deadline=None, phases=[Phase.generate])
    @given(rulebases(decorated=True))  # odd names take as long again
    def look(rulebase):
        for part in parts_of(rulebase):
            for name, default in options_of(part):
                if getattr(part, name) != default:
                    left.discard((type(part), name))
        if not left:
            raise AllSeenError

    with contextlib.suppress(AllSeenError):
        look()
    assert left == set()


@pytest.mark.slow
@settings(max_examples=cases(12, 50), deadline=None)
@given(rulebases(odd_names=True, decorated=True))
def test_what_is_written_or_formatted_reads_back_to_the_same_model(rulebase):
    text = write(rulebase)
    parsed = parse(text)
    assert [d for d in parsed.diagnostics if d.is_error] == []
    assert parsed.rulebase == rulebase
    formatted = format_text(text)
    assert format_text(formatted) == formatted
    assert parse(formatted).rulebase == rulebase


@pytest.mark.slow
@settings(max_examples=cases(20, 100), deadline=None)
@given(plain_mamdani(), st.randoms(use_true_random=False))
def test_spacing_means_nothing(rulebase, random):
    text = write(rulebase)
    loose = "\n".join(
        line[: len(line) - len(line.lstrip())]
        + "".join(c + " " * random.randint(0, 3) if c == " " else c for c in line.lstrip())
        for line in text.splitlines()
    )
    assert format_text(loose) == text


@pytest.mark.slow
@settings(max_examples=cases(15, 60), deadline=None)
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


@pytest.mark.slow
@settings(max_examples=cases(10, 40), deadline=None)
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


# --- Long lines ---

MANY = [f"T{i:06}" for i in range(4000)]


def long_texts():
    """Texts whose statements are longer than a line may be."""
    heads = "rulebase long\ninput e -1 .. 1\noutput u -1 .. 1\nterms u: triangles N P\n"
    terms = "\n  ".join(" ".join(MANY[i : i + 500]) for i in range(0, len(MANY), 500))
    either = "\n  or ".join(f"e is {name}" for name in MANY[:3000])
    rule = f"rule if {either}  # a comment\n  then u is P\n"
    yield f"{heads}terms e: triangles {terms}\n{rule}"
    name = "'" + "n o" * 4000 + "'"
    grid = f"rules u\n  e  {name}  Q\n  u  N  P\nrules u\n  e Q\n  u P\n"
    yield f"{heads}terms e: triangles {name} Q\n{grid}"


@pytest.mark.slow
@pytest.mark.parametrize("text", list(long_texts()), ids=["statements", "names"])
def test_what_is_written_of_long_statements_is_read(text):
    before = parse(text)
    assert before.rulebase is not None, before.diagnostics[:3]
    formatted = format_text(text)
    assert same_model(parse(formatted).rulebase, before.rulebase)
    assert max(map(len, formatted.split("\n"))) <= MAX_LINE
    assert format_text(formatted) == formatted
    assert same_model(parse(write(before.rulebase)).rulebase, before.rulebase)


def test_a_text_that_would_be_too_large_is_not_formatted():
    names = [f"T{i:04}" for i in range(2300)]
    heads = "rulebase x\ninput e 0 .. 1\noutput u 0 .. 1\nterms u: triangles N P\n"
    terms = "\n  ".join(" ".join(names[i : i + 500]) for i in range(0, len(names), 500))
    grid = f"rules u\n  e {' '.join(names)}\n  u {' '.join(['P*.0001'] * len(names))}\n"
    text = f"{heads}terms e: triangles {terms}\n{grid}"
    assert parse(text).rulebase is not None
    with pytest.raises(RuleBaseError, match="in canonical form the line has"):
        format_text(text)


# --- Odd names ---

WORDS = (
    "if", "then", "is", "and", "or", "with", "when", "inf", "nan", "not", "very", "power",
    "input", "rules", "rule", "terms", "lookup", "levels", "over", "height", "x", "pi", "e",
    "'", '"', "\\", "#", "a#b", "a b", " a", "\n", "\t", "\r", "\x00", "\x85", "\u2028",
    "\ufeff", "\u202e", "²", "1", "1a", "-", "a-b", "-a", "e\\ce", "'q'", "é", "e\u0301", "💧",
    ".", "a.b", "*", "(", ",", ":", "=", "..", "N*0.5", "∞", "%", "a" * 900,
)  # fmt: skip
odd_words = st.one_of(st.sampled_from(WORDS), st.text(min_size=1, max_size=6))


@st.composite
def renamed(draw):
    """A rule base in which everything that has a name has an odd one."""
    rulebase = draw(plain_mamdani())
    variables = (*rulebase.inputs, *rulebase.outputs)
    terms = {term.name for variable in variables for term in variable.terms}
    count = len(variables) + len(terms) + 1
    words = draw(st.lists(odd_words, min_size=count, max_size=count, unique=True))
    own = dict(zip((variable.name for variable in variables), words, strict=False))
    other = dict(zip(sorted(terms), words[len(variables) :], strict=False))

    def named(variable):
        changed = tuple(replace(term, name=other[term.name]) for term in variable.terms)
        return replace(
            variable, name=own[variable.name], terms=changed, description=draw(odd_words)
        )

    def part(each):
        if isinstance(each, And):
            return And(tuple(map(part, each.operands)))
        return replace(each, variable=own[each.variable], term=other[each.term])

    rules = tuple(
        replace(
            rule, antecedent=part(rule.antecedent), consequents=tuple(map(part, rule.consequents))
        )
        for rule in rulebase.rules
    )
    return replace(
        rulebase,
        name=words[-1],
        description=draw(odd_words),
        inputs=tuple(map(named, rulebase.inputs)),
        outputs=tuple(map(named, rulebase.outputs)),
        blocks=(replace(rulebase.blocks[0], rules=rules),),
    )


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".frb", ".fis", ".fll", ".fcl"])
def test_what_is_converted_of_odd_names_is_read(suffix, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)

    @settings(max_examples=cases(6, 100), suppress_health_check=list(HealthCheck))
    @given(renamed())
    def holds(rulebase):
        Path("a.frb").write_bytes(write(rulebase).encode())
        assert same_model(load("a.frb"), rulebase)
        assert main(["convert", "a.frb", f"b{suffix}", "--lossy"]) == 0, capsys.readouterr()
        assert main(["convert", f"b{suffix}", "c.frb", "--lossy"]) == 0, capsys.readouterr()
        assert suffix != ".frb" or same_model(load("c.frb"), rulebase)
        assert isinstance(load("c.frb"), RuleBase)
        assert main(["fmt", "c.frb"]) == 0, capsys.readouterr()
        assert isinstance(load("c.frb"), RuleBase)

    holds()


def test_the_numbers_of_a_partner_keep_odd_names():
    text = "controller c\nperiod 1 ms\npartner base = mrac, 'a b'.gravity = 0, 'x..' = 1, m_1 = 2\n"
    formatted = format_text(text + "axis joint1\n  drive torque = partner base\n")
    assert "mrac, 'a b.gravity' = 0, 'x..' = 1, m_1 = 2" in formatted
    assert format_text(formatted) == formatted


@pytest.mark.parametrize(
    ("bins", "words"),
    [
        ((-3.0, -1.0, 1.0, 3.0), "bins 1 3 mirrored"),
        ((-1.0, 0.0, 1.0), "bins -1 0 1"),
        ((-3.0, -1.0, 1.0, 2.0), "bins -3 -1 1 2"),
    ],
)
def test_bins_that_mirror_each_other_are_written_once(bins, words):
    levels = " ".join(str(i) for i in range(-len(bins), len(bins) + 1, 2))
    text = (
        "rulebase t\ninput x -6 .. 6\noutput u 0 .. 1\nterms x: triangles L H\n"
        "terms u: singletons A B\nrule if x is L then u is A\n"
        f"lookup\n  levels {levels}\n  bins {' '.join(map(str, bins))}\n"
    )
    rulebase = parse(text).rulebase
    written = write(rulebase)
    assert words in " ".join(written.split()).replace("bins x:", "bins").replace(".0", "")
    assert parse(written).rulebase == rulebase
