"""An argument of another kind, or out of range, is one sentence that says what is wanted."""

import math

import pytest

import fuzzyarm
from fuzzyarm import FuzzyarmError, RuleBaseBuilder, Shape, learning
from fuzzyarm.apps import study
from fuzzyarm.base.keywords import ArgumentError, _annotations
from fuzzyarm.base.value_kinds import MistakenKindError
from fuzzyarm.control import loop
from fuzzyarm.control.loop.simulation import ManyKeywords, RunKeywords
from fuzzyarm.learning.training import TrainKeywords
from fuzzyarm.learning.tuning.tune import TuneKeywords
from fuzzyarm.plant import PlantError
from fuzzyarm.proof.loop.call import ProveKeywords
from fuzzyarm.table.fidelity import ReportKeywords

PD7 = fuzzyarm.load_rulebase(fuzzyarm.shipped("pd7.frb"))
SERVO = str(fuzzyarm.shipped("servo.frb"))
HEATER = str(fuzzyarm.shipped("heater.frb"))


def run(**keywords):
    return fuzzyarm.simulate(SERVO, "motor", **{"duration": 0.01} | keywords)


def many(runs, **keywords):
    return fuzzyarm.simulate_many(SERVO, "motor", runs, duration=0.01, **keywords)


OF_RULE_BASES = (
    fuzzyarm.infer,
    fuzzyarm.infer_interval,
    fuzzyarm.explain,
    fuzzyarm.compiled,
    fuzzyarm.write,
    fuzzyarm.compile_table,
    fuzzyarm.compile_with_report,
    RuleBaseBuilder.of,
)


@pytest.mark.parametrize("call", OF_RULE_BASES, ids=lambda call: call.__qualname__)
@pytest.mark.parametrize("thing", ["pd7.frb", 3, None, PD7.table(levels=3)], ids=type)
def test_what_is_not_a_rule_base_is_said(call, thing):
    with pytest.raises(MistakenKindError, match="not a rule base") as caught:
        call(thing)
    if isinstance(thing, str):
        assert caught.value.hint == "fuzzyarm.load reads a file"


WRONG = {
    "takes a mapping as 'reference', not 20 .as in": lambda: run(reference=20),
    "takes a mapping as 'connect'": lambda: run(connect="a=b"),
    "takes a number as 'step'": lambda: run(step="x"),
    "takes a number or text as 'duration'": lambda: run(duration=[1]),
    r"takes Options as 'options', not \{\}": lambda: run(options={}),
    "takes Conventions as 'conventions'": lambda: run(conventions="study"),
    "position takes a signal or a number, not None": lambda: run(reference={"position": None}),
    "no port '3'": lambda: run(reference={3: 1.0}),
    "'J' is not a number in a run: 'x'": lambda: many({"J": "x"}),
    "a list of mappings or a mapping of lists as 'runs'": lambda: many([3]),
    "workers must be 1 to": lambda: many({"J": [0.01]}, workers=-1),
    "takes Samples or text or a path as 'data'": lambda: fuzzyarm.tune(PD7, data=3),
    "takes Tuning or a list as 'tune'": lambda: fuzzyarm.tune(HEATER, tune=3),
    "takes samples, their file or a FitRequest": lambda: learning.fit(3),
    "takes fuzzyarm.learning.Options as 'options'": lambda: learning.fit("no.csv", options={}),
    "takes a whole number as 'seed'": lambda: learning.Options(seed="x"),
    "takes one statement as 'statement', not": lambda: fuzzyarm.prove(PD7, ["u odd"]),
    "3 is an int, not a rule base or a controller": lambda: fuzzyarm.prove(3),
    "budget must be above 0 seconds, not -3": lambda: fuzzyarm.prove(PD7, "u odd", budget=-3),
    "budget must be finite": lambda: fuzzyarm.prove(PD7, "u odd", budget=math.nan),
    "tolerance must be above 0": lambda: fuzzyarm.prove(PD7, "u odd", tolerance=-1),
    "takes a truth value as 'exact'": lambda: fuzzyarm.prove(PD7, "u odd", exact="x"),
    "takes a list or CompareRequest as 'controllers'": lambda: next(study.compare("pd")),
    "takes Plant as 'plant'": lambda: next(study.compare(["pd"], plant="motor")),
    "a seed of -1 is out of range": lambda: loop.Options(seed=-1),
    "noise takes a number, not 'x'": lambda: loop.Sensor(noise="x"),
    "takes a whole number or a list as 'levels'": lambda: fuzzyarm.compile_table(PD7, levels="a"),
    "is a rule base, not a lookup table": lambda: fuzzyarm.write_table(PD7, "a.lut"),
    "load.. takes a path as 'path', not 3": lambda: fuzzyarm.load(3),
    "takes a path as 'path', not None": lambda: fuzzyarm.read_table(None),
    "check_file.. takes a path": lambda: fuzzyarm.check_file(b"pd7.frb"),
    "shipped.. takes text as 'name'": lambda: fuzzyarm.shipped(3),
    "parse.. takes text as 'text'": lambda: fuzzyarm.parse(b"rulebase x"),
    "is not a system of": lambda: fuzzyarm.from_live(3),
    "expected the numbers of a shape, found 'abc'": lambda: Shape("triangle", "abc"),
    "expected the numbers of a shape": lambda: Shape("triangle", (0, 1, "x")),
    "expected the shape of the term, found '3'": lambda: Shape(3),
    "expected names of terms, found 3": lambda: RuleBaseBuilder("x").input("a", 0, 1, terms=3),
    "expected a list of numbers, found 3": lambda: RuleBaseBuilder("x").lookup(3),
    "to_file.. takes a path": lambda: PD7.to_file(3),
    "export_file.. takes a path as 'file'": lambda: fuzzyarm.export_file(3, "x.h"),
}


@pytest.mark.parametrize("message", WRONG)
def test_an_argument_of_another_kind_says_what_is_wanted(message):
    with pytest.raises(FuzzyarmError, match=message):
        WRONG[message]()


def test_a_seed_is_not_a_matter_of_the_arm():
    with pytest.raises(PlantError, match="a seed of -1"):
        loop.Options(seed=-1)


def test_numbers_of_numpy_are_numbers():
    import numpy as np

    options = loop.Options(seed=np.int64(3), interpolate=np.bool_(True))
    assert run(step=np.float64(1.0), options=options).samples == 10
    table = fuzzyarm.compile_with_report(PD7, levels=np.linspace(-6.0, 6.0, 5)).table
    assert table.values.shape == (5, 5)


@pytest.mark.parametrize(
    "kind",
    [ManyKeywords, ProveKeywords, ReportKeywords, RunKeywords, TrainKeywords, TuneKeywords,
     learning.Options, loop.Options, study.compare],
)  # fmt: skip
def test_what_a_keyword_may_be_can_be_read(kind):
    assert _annotations(kind)  # a name that a module only imports for type checkers has no value


def test_samples_may_be_a_file(tmp_path):
    path = tmp_path / "line.csv"
    path.write_text("x,y\n" + "".join(f"{k},{2 * k}\n" for k in range(20)), encoding="utf-8")
    assert learning.fit(path).rulebase.inputs[0].name == "x"
    with pytest.raises(FileNotFoundError):
        fuzzyarm.tune(PD7, data=tmp_path / "no.csv")
    with pytest.raises(FuzzyarmError, match="no column 'e'"):
        fuzzyarm.tune(PD7, data=path)


def test_an_argument_error_names_the_argument():
    with pytest.raises(ArgumentError) as caught:
        run(reference=20)
    assert caught.value.argument == "reference"
