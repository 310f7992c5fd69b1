"""What a call from Python takes and returns: files by kind, words of the commands, figures."""

import pickle
import warnings
from copy import copy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import fuzzyarm
from fuzzyarm.base.errors import FuzzyarmError, WordError
from fuzzyarm.control.loop import Options, Sensor, Signal, phase_portrait, simulate_many
from fuzzyarm.exchange.files import UnknownKindError, WrongKindError
from fuzzyarm.inference import InferenceError
from fuzzyarm.plant import PlantError

PD7, SERVO = fuzzyarm.shipped("pd7.frb"), fuzzyarm.shipped("servo.frb")
TABLE = fuzzyarm.shipped("thesis-6.1.lut")


# --- One class for rule bases, a function for each kind of file ---


def test_what_is_loaded_is_a_rule_base():
    loaded = fuzzyarm.load(PD7)
    assert type(loaded) is fuzzyarm.RuleBase
    assert fuzzyarm.RuleBase is fuzzyarm.language.model.RuleBase is fuzzyarm.language.RuleBase
    assert isinstance(fuzzyarm.load(SERVO), fuzzyarm.ControllerText)
    assert isinstance(fuzzyarm.load(TABLE), fuzzyarm.LookupTable)
    builder = fuzzyarm.RuleBaseBuilder.of(loaded)
    assert not isinstance(builder, fuzzyarm.RuleBase)
    assert isinstance(builder.model, fuzzyarm.RuleBase)
    assert all(isinstance(each, fuzzyarm.AnyRuleBase) for each in (loaded, builder))


def test_the_old_name_of_the_builder_goes_on_working():
    with pytest.warns(DeprecationWarning, match="fuzzyarm.RuleBaseBuilder") as told:
        fan = fuzzyarm.RuleBase("fan", "of a greenhouse")
    assert told[0].filename == __file__
    assert type(fan) is fuzzyarm.RuleBaseBuilder
    assert str(fan).startswith('rulebase fan "of a greenhouse"')
    for call in (
        lambda: fuzzyarm.RuleBase(name="fan", description="x"),
        lambda: fuzzyarm.RuleBase.from_text("rulebase fan\n"),
        lambda: fuzzyarm.RuleBase.of(fuzzyarm.load(PD7)),
    ):
        with pytest.warns(DeprecationWarning, match="fuzzyarm.RuleBaseBuilder"):
            assert type(call()) is fuzzyarm.RuleBaseBuilder


def test_a_value_is_made_copied_and_sent_without_a_warning():
    pd7 = fuzzyarm.load_rulebase(PD7)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        parts = (pd7.name, pd7.inputs, pd7.outputs, pd7.blocks)
        made = fuzzyarm.RuleBase(*parts, lookup=pd7.lookup, description=pd7.description)
        assert replace(made, expectations=pd7.expectations, properties=pd7.properties) == pd7
        assert pickle.loads(pickle.dumps(pd7)) == copy(pd7) == pd7
        assert fuzzyarm.RuleBase("empty", ()).outputs == ()


def test_each_kind_has_its_function(tmp_path):
    pd7 = fuzzyarm.load_rulebase(PD7)
    assert pd7 == fuzzyarm.load(PD7)
    assert str(fuzzyarm.load_controller(SERVO)) == str(fuzzyarm.load(SERVO))
    pd7.to_file(tmp_path / "pd7.fll")
    assert fuzzyarm.load_rulebase(tmp_path / "pd7.fll") == fuzzyarm.load(tmp_path / "pd7.fll")


def test_the_rule_base_beside_a_controller_is_reached(tmp_path):
    both = tmp_path / "both.frb"
    lines = [line for line in SERVO.read_text().splitlines() if not line.startswith("use ")]
    both.write_text("\n".join(lines) + "\n" + PD7.read_text())
    assert isinstance(fuzzyarm.load(both), fuzzyarm.ControllerText)
    assert fuzzyarm.load_rulebase(both) == fuzzyarm.load(PD7)


@pytest.mark.parametrize(
    ("load", "path", "error", "words"),
    [
        (fuzzyarm.load_rulebase, TABLE, WrongKindError, "lookup table, not a rule base"),
        (fuzzyarm.load_rulebase, SERVO, fuzzyarm.RuleBaseError, "fuzzyarm.load_controller reads"),
        (fuzzyarm.load_controller, TABLE, WrongKindError, "(fuzzyarm.read_table reads it)"),
        (fuzzyarm.load_controller, PD7, WrongKindError, "(fuzzyarm.load_rulebase reads it)"),
        (fuzzyarm.read_table, PD7, ValueError, "no suffix of a table"),
        (fuzzyarm.load_rulebase, "x.txt", UnknownKindError, "cannot tell what kind of file"),
        (fuzzyarm.load_controller, "x.txt", UnknownKindError, "cannot tell what kind of file"),
        (fuzzyarm.load_rulebase, "missing.frb", FileNotFoundError, "missing.frb"),
        (fuzzyarm.load_controller, "missing.frb", FileNotFoundError, "missing.frb"),
    ],
)  # fmt: skip
def test_a_file_of_another_kind_is_one_sentence_that_names_the_function(load, path, error, words):
    with pytest.raises(error) as caught:
        load(path)
    assert words in str(caught.value)


@pytest.mark.parametrize("load", [fuzzyarm.load, fuzzyarm.load_rulebase])
def test_a_warning_of_a_foreign_file_points_at_the_call(load):
    with pytest.warns(fuzzyarm.FileWarning, match="empty-rule") as told:
        load(Path(__file__).parents[1] / "formats" / "data" / "lamp_fuzzylite.fis")
    assert {each.filename for each in told} == {__file__}


# --- Words as a command takes them ---


def series(run):
    return run.time, run.error_matrix


def same(one, other):
    return all(np.array_equal(*pair) for pair in zip(series(one), series(other), strict=True))


@pytest.fixture(scope="module")
def plain():
    references = {"position": Signal("step", (1.0,))}
    return fuzzyarm.simulate(fuzzyarm.load(SERVO), "motor", reference=references, duration=0.02)


@pytest.mark.parametrize("signal", ["step:1", "1", 1, 1.0, np.float64(1.0)])
@pytest.mark.parametrize("duration", ["20ms", "0.02 s", 0.02, "20000us"])
def test_words_say_what_numbers_and_signals_say(signal, duration, plain):
    run = fuzzyarm.simulate(SERVO, "motor", reference={"position": signal}, duration=duration)
    assert same(run, plain)
    assert run.trajectory == "position step:1"


def test_many_runs_a_portrait_and_a_search_take_the_same_words():
    words = {"reference": {"position": "step:1"}, "duration": "20ms"}
    many = simulate_many(SERVO, "motor", [{"G_e": 1.0}], workers=1, **words)
    numbers = {"reference": {"position": Signal("step", (1.0,))}, "duration": 0.02}
    assert np.array_equal(many.values, simulate_many(
        SERVO, "motor", [{"G_e": 1.0}], workers=1, **numbers).values, equal_nan=True)  # fmt: skip
    portrait = phase_portrait(SERVO, "motor", starts=[(0.5, 0.0)], **words)
    assert repr(portrait) == repr(phase_portrait(SERVO, "motor", starts=[(0.5, 0.0)], **numbers))
    assert phase_portrait(fuzzyarm.load(PD7), duration="50ms", starts=[(1.0, 0.0)])
    tuned = [
        fuzzyarm.tune(
            fuzzyarm.shipped("heater.frb"), "room", reference={"temperature": reference},
            duration=duration, time=seconds, evals=3, unseen=2, linear=False, workers=1,
        ).found.best.score.cost
        for reference, duration, seconds in [("step:20", "10min", "5min"),
                                             (Signal("step", (20.0,)), 600.0, 300.0)]
    ]  # fmt: skip
    assert tuned[0] == tuned[1]


def test_loads_and_sensors_take_words_too():
    words = Options(loads={"voltage": "step:1,0.01"}, sensors={"position": Sensor(delay="2ms")})
    numbers = Options(
        loads={"voltage": Signal("step", (1.0, 0.01))}, sensors={"position": Sensor(delay=0.002)}
    )
    runs = [
        fuzzyarm.simulate(SERVO, "motor", duration=0.02, options=options)
        for options in (words, numbers, Options())
    ]
    assert same(runs[0], runs[1])
    assert not same(runs[0], runs[2])
    assert Sensor(difference="5ms") == Sensor(difference=0.005) == replace(
        Sensor(), difference="5ms"
    )  # fmt: skip
    with pytest.raises(PlantError, match=r"delay = -1\.0 is out of range"):
        Sensor(delay=-1.0)


@pytest.mark.parametrize(
    ("words", "error", "message"),
    [
        ({"duration": "300"}, WordError, "duration takes a time with a unit (us, ms, s, min, h)"),
        ({"duration": "soon"}, WordError, "not 'soon'"),
        ({"reference": {"position": "stp:1"}}, PlantError, "did you mean 'step'?"),
        ({"reference": {"position": "step:x"}}, PlantError, "'step:x' is not a signal"),
        ({"reference": {"postion": "step:1"}}, PlantError, "no port 'postion'"),
    ],
)
def test_words_that_say_nothing_are_one_sentence(words, error, message):
    with pytest.raises(error) as caught:
        fuzzyarm.simulate(SERVO, "motor", **words)
    assert message in str(caught.value)


def test_a_rule_base_that_is_being_written_is_tuned_as_its_value_is():
    from fuzzyarm.learning import as_samples

    fan = fuzzyarm.RuleBaseBuilder("fan")
    fan.input("x", 0, 1, terms=["low", "high"])
    fan.output("y", 0, 1, terms={"a": 0, "b": 0.5}, defuzzifier="weighted-average", no_rule=0)
    fan.grid("y", ["a", "b"])
    samples = as_samples(
        [[i / 20] for i in range(21)], [i / 20 for i in range(21)], names=("x",), target="y"
    )
    options = {"data": samples, "evals": 5, "tune": ["peaks y"], "workers": 1}
    assert fuzzyarm.tune(fan, **options).text == fuzzyarm.tune(fan.model, **options).text


# --- Figures ---


@pytest.mark.slow
def test_whatever_has_a_picture_has_plot(plain, tmp_path):
    from matplotlib.figure import Figure

    pd7 = fuzzyarm.load_rulebase(PD7)
    builder = fuzzyarm.RuleBaseBuilder("fan")
    portrait = phase_portrait(pd7, duration="50ms", starts=[(1.0, 0.0)])
    shown = {
        "run": plain,
        "portrait": portrait,
        "variable": pd7.inputs[0],
        "variable of a builder": builder.input("x", 0, 1, terms=["low", "high"]),
        "table": fuzzyarm.read_table(TABLE),
        "compiled table": pd7.table(levels=5),
        "rule base": pd7,
    }
    for name, value in shown.items():
        figure = value.plot()
        assert isinstance(figure, Figure), name
        assert figure.axes or figure.subfigs, name
    plain.plot().savefig(tmp_path / "run.png")
    assert (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")


def test_gains_are_given_to_a_run_to_a_file_and_to_a_text():
    servo = SERVO
    keywords = {"reference": {"position": "step:1"}, "duration": "60ms"}
    one = fuzzyarm.simulate(servo, "motor", gains={"G_u": 9}, **keywords)
    other = fuzzyarm.simulate(fuzzyarm.load_controller(servo, gains={"G_u": [9]}), **keywords)
    assert same(one, other)
    assert not same(one, fuzzyarm.simulate(servo, "motor", **keywords))
    with pytest.raises(FuzzyarmError, match="servo has no gain 'G_v'"):
        fuzzyarm.load_controller(servo, gains={"G_v": 1.0})
    with pytest.raises(FuzzyarmError, match="servo has no gain 'G_v'"):
        fuzzyarm.simulate(servo, "motor", gains={"G_v": 1.0})


def test_errors_and_drives_of_a_run_go_by_name():
    run = fuzzyarm.simulate(SERVO, "motor", duration="30ms")
    assert list(run.errors) == ["position"]
    assert list(run.drives) == ["voltage"]
    np.testing.assert_array_equal(run.errors["position"], run.error_matrix[:, 0])


def test_inputs_by_position_are_refused_with_the_call_by_name():
    pd7 = fuzzyarm.load(PD7)
    with pytest.raises(InferenceError, match=r"not as tuple \(write e=0\.3, ce=0\.1\)"):
        fuzzyarm.infer(pd7, 0.3, 0.1)
    with pytest.raises(InferenceError, match=r"not as float \(write e=0\.3, ce=…\)"):
        fuzzyarm.infer(pd7, 0.3)
