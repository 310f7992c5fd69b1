"""A value of one kind where one of another is wanted: one sentence, not "has no attribute"."""

import copy
import pickle

import pytest

import fuzzyarm
from fuzzyarm.apps import show
from fuzzyarm.apps.show import figures
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.value_kinds import MistakenKindError, wrong_kind
from fuzzyarm.control import loop
from fuzzyarm.control.controllers import Controller, Sources, controller, find_controller
from fuzzyarm.exchange import export, formats
from fuzzyarm.language import load_rulebase
from fuzzyarm.plant import reach
from fuzzyarm.proof import map as proof
from fuzzyarm.proof.claim.text import read_claim
from fuzzyarm.proof.map.verdicts import read_property

RULES = fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))
TABLE = fuzzyarm.load(fuzzyarm.shipped("thesis-6.1.lut"))
SERVO = fuzzyarm.load(fuzzyarm.shipped("servo.frb"))

POINT = {"e": 1.0, "ce": 1.0}

WANT_RULES = {
    "infer": lambda x: fuzzyarm.infer(x, POINT),
    "infer_interval": lambda x: fuzzyarm.infer_interval(x, POINT),
    "explain": lambda x: fuzzyarm.explain(x, POINT),
    "compiled": fuzzyarm.compiled,
    "compile_table": fuzzyarm.compile_table,
    "compile_with_report": fuzzyarm.compile_with_report,
    "prove": lambda x: fuzzyarm.prove(x, "u <= 6"),
    "prove_all": lambda x: list(proof.prove_all(x)),
    "write": fuzzyarm.write,
    "write as": lambda x: formats.write(x, ".fis"),
    "memberships_figure": figures.memberships_figure,
    "surface_figure": figures.surface_figure,
    "rulebase_figure": figures.rulebase_figure,
    "rulebase_view": show.rulebase_view,
    "compare_rulebases": lambda x: show.compare_rulebases(x, x),
}

WANT_CONTROLLER = {
    "simulate": lambda x: fuzzyarm.simulate(x, "motor"),
    "simulate_many": lambda x: fuzzyarm.simulate_many(x, "motor", [{}]),
    "phase_portrait": lambda x: loop.phase_portrait(x, "motor"),
    "find_controller": find_controller,
    "block_diagram": show.block_diagram,
    "controller_view": show.controller_view,
    "compare_controllers": lambda x: show.compare_controllers(x, x),
    "controller_figure": figures.controller_figure,
    "step_cost": export.step_cost,
}


@pytest.mark.parametrize("call", WANT_RULES.values(), ids=WANT_RULES)
@pytest.mark.parametrize(
    ("value", "said"),
    [(SERVO, "'servo' is a controller, not a rule base"), (TABLE, "'u' is a lookup table, not a")],
    ids=["controller", "table"],
)
def test_where_a_rule_base_is_wanted(call, value, said):
    with pytest.raises(FuzzyarmError, match=said) as error:
        call(value)
    assert error.value.hint


@pytest.mark.parametrize("call", WANT_CONTROLLER.values(), ids=WANT_CONTROLLER)
@pytest.mark.parametrize(
    ("value", "said"),
    [(RULES, "'pd7' is a rule base, "), (TABLE, "'u' is a lookup table, not a")],
    ids=["rule base", "table"],
)
def test_where_a_controller_is_wanted(call, value, said):
    with pytest.raises(FuzzyarmError, match=said):
        call(value)


def test_a_statement_on_a_loop_wants_a_controller():
    claim = read_claim("stable on motor")
    for statement in ("stable", "stable on motor", "on motor from e = 0 : always e <= 1", claim):
        with pytest.raises(MistakenKindError, match="'pd7' is a rule base, not a controller"):
            fuzzyarm.prove(RULES, statement)
    with pytest.raises(MistakenKindError, match="3 is an int, not a rule base or a controller"):
        fuzzyarm.prove(3, "u <= 6")
    with pytest.raises(MistakenKindError, match="'servo' is a controller, not a rule base"):
        fuzzyarm.prove(SERVO, read_property(RULES, "u odd"))


@pytest.mark.parametrize("value", [3, None, Controller, [SERVO]])
def test_anything_else_is_called_by_its_class(value):
    with pytest.raises(MistakenKindError, match="not a controller"):
        fuzzyarm.simulate(value, "motor")


def test_a_model_without_its_files_says_so():
    with pytest.raises(MistakenKindError, match="without its files"):
        fuzzyarm.simulate(SERVO.model, "motor")


def test_tune_takes_either_and_a_table_neither():
    with pytest.raises(
        MistakenKindError, match="'u' is a lookup table, not a rule base or a contr"
    ):
        fuzzyarm.tune(TABLE)
    with pytest.raises(FuzzyarmError, match="nothing says what is good"):
        fuzzyarm.tune(fuzzyarm.RuleBase.of(RULES))


def test_the_hint_works():
    law = controller("fuzzy-direct", sources=Sources(RULES))
    assert fuzzyarm.simulate(law, reach(segment=0.1)).samples


def test_a_path_serves_as_a_name():
    path = fuzzyarm.shipped("servo.frb")
    assert fuzzyarm.simulate(path, "motor", duration=0.01).samples == 10


@pytest.mark.parametrize("value", [RULES, TABLE, SERVO, SERVO.model], ids=repr)
def test_values_are_values_as_before(value):
    assert not hasattr(value, "nothing_of_that_name")
    assert hasattr(value, "sheets") == (value is SERVO)
    assert not hasattr(TABLE, "inputs")
    assert copy.deepcopy(value) == value
    assert pickle.loads(pickle.dumps(value)) == value
    with pytest.raises(AttributeError, match=f"'{type(value).__name__}' object has no attribute"):
        _ = value.nothing_of_that_name


def test_a_file_with_doubts_only_is_refused_by_name(tmp_path):
    path = tmp_path / "doubtful.frb"
    text = fuzzyarm.shipped("servo.frb").read_text(encoding="utf-8")
    path.write_text(text.replace("axis shaft", "gain idle = 1\n\naxis shaft"), "utf-8")
    with pytest.raises(fuzzyarm.RuleBaseError, match="this is a controller, not a rule base"):
        load_rulebase(path)


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (3, "3 is an int, not a rule"),
        (None, "None is not a rule"),
        ([1], "[1] is a list, not a rule"),
    ],
)
def test_a_plain_value_is_called_what_it_is(value, said):
    assert str(wrong_kind(value, "rule base")).startswith(said)
