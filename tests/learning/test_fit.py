"""Rule bases from samples: how good, how readable, and the commands around them."""

from __future__ import annotations

import json
import math
import re
import sys
from dataclasses import replace

import numpy as np
import pytest
from needs import DATA, requires

from fuzzyarm.apps.cli import main
from fuzzyarm.exchange.files import check_text
from fuzzyarm.inference import infer
from fuzzyarm.language import format_text, parse
from fuzzyarm.learning.data import Samples, as_samples, read_samples
from fuzzyarm.learning.fit import FitError, Options, fit, linear_outputs, outputs_of, rms, score
from fuzzyarm.learning.starts import _overlap
from fuzzyarm.learning.structure import CrossValidation
from fuzzyarm.learning.validation import validate
from tests.learning.mackey_glass import mackey_glass

fitting = sys.modules["fuzzyarm.learning.fit"]  # of the name of a function
needs_data = requires("data")


def test_error(made, inputs, values):
    samples = as_samples(inputs, values)
    return rms(samples.outputs - outputs_of(made.rulebase, samples))


test_error.__test__ = False


def is_sound(made):
    """The text is canonical, without doubts, and the rule base is read from it."""
    review = check_text(made.text)
    assert not [each for each in review.diagnostics if each.severity != "info"], review.diagnostics
    assert format_text(made.text) == made.text
    assert parse(made.text).rulebase == made.rulebase


@pytest.mark.slow
def test_mackey_glass():
    x, y, later_x, later_y = mackey_glass()
    made = fit(as_samples(x, y), Options(series=True, nested=False))
    assert test_error(made, later_x, later_y) < 0.003
    assert len(made.rulebase.rules) <= 16
    assert all(len(each.terms) == 2 for each in made.rulebase.inputs)
    assert "LOW" in made.text
    assert made.error <= 1.02 * made.error_of_numbers
    is_sound(made)
    words = fit(as_samples(x, y), Options(method="wang-mendel", words=(15, 15)))
    assert test_error(words, later_x, later_y) < 0.022
    is_sound(words)


def shared(name, count):
    samples = read_samples(DATA / name)
    rows = np.arange(len(samples))
    return samples.part(rows[:count]), samples.part(rows[count:])


@needs_data
@pytest.mark.slow
def test_the_series_of_frbs():
    train, later = shared("mackey_glass_frbs.csv", 500)
    made = fit(train, Options(series=True, nested=False))
    assert rms(later.outputs - outputs_of(made.rulebase, later)) < 0.0015
    few = fit(train, Options(terms=(2, 2, 1, 1), series=True, nested=False))
    assert rms(later.outputs - outputs_of(few.rulebase, later)) < 0.005
    assert len(few.rulebase.rules) == 4


@pytest.mark.slow
@needs_data
def test_the_gas_furnace_and_what_cross_validation_says_of_it():
    train, later = shared("gas_furnace.csv", 204)
    made = fit(train, Options(terms=(2, 2), shrinkage=0.0, series=True))
    assert rms(later.outputs - outputs_of(made.rulebase, later)) < 0.64
    assert made.cross_validation > made.linear_cross_validation  # the later error is luck
    assert fit(train, Options(series=True)).structure == "linear"


@pytest.mark.slow
def test_friedman_and_diabetes():
    datasets = pytest.importorskip("sklearn.datasets")
    x, y = datasets.make_friedman1(500, noise=1.0, random_state=0)
    order = np.random.default_rng(0).permutation(len(y))
    train, later = order[100:], order[:100]
    made = fit(as_samples(x[train], y[train]), Options(rules=8, parts=3, move=False, nested=False))
    assert test_error(made, x[later], y[later]) < 1.4
    is_sound(made)
    x, y = datasets.load_diabetes(return_X_y=True)
    order = np.random.default_rng(1).permutation(len(y))
    train, later = order[90:], order[:90]
    made = fit(as_samples(x[train], y[train]), Options(rules=3, parts=3, move=False, nested=False))
    asked = as_samples(x[later], y[later])
    linear = rms(asked.outputs - linear_outputs(as_samples(x[train], y[train]), asked))
    assert test_error(made, x[later], y[later]) < 1.05 * linear


def bumps(count=60, seed=0):
    draw = np.random.default_rng(seed)
    x = draw.uniform(0.0, 10.0, (count, 2))
    return as_samples(x, np.where(x[:, 0] > 5.0, x[:, 1], 10.0 - x[:, 1]), ("a", "b"))


@pytest.mark.slow
def test_samples_of_a_line_give_a_line():
    x = np.random.default_rng(0).uniform(-3.0, 3.0, (40, 2))
    made = fit(as_samples(x, 2.0 * x[:, 0] - x[:, 1] + 0.5))
    assert made.structure == "linear"
    found = infer(made.rulebase, x1=np.array([-9.0, 1.0]), x2=np.array([4.0, 1.0]))["y"]
    assert np.allclose(found, [-21.5, 1.5], atol=1e-2)
    is_sound(made)


@pytest.mark.slow
@pytest.mark.parametrize(
    "options",
    [
        Options(rules=4),
        Options(start="fcm", rules=4, merge=0.5, nested=False),
        Options(start="subtractive", rules=5, nested=False),
        Options(method="wang-mendel", words=(3, 5)),
        Options(terms=(3, 2), move=True, outside="clamp", nested=False),
        Options(rules=1),
    ],
    ids=["grid", "fcm", "subtractive", "words", "terms", "one rule"],
)
def test_every_method_writes_a_sound_text(options):
    made = fit(bumps(), options)
    is_sound(made)
    assert made == fit(bumps(), options)
    assert made.error <= 1.02 * max(made.error_of_numbers, 1e-4 * 5.0)


@pytest.mark.slow
def test_comments_say_what_the_rules_rest_on():
    made = fit(bumps(), Options(terms=(2, 1)))
    assert "% of the samples, error" in made.text
    assert f"Training RMS error {made.error:.4g}" in made.text
    assert sum(made.support) == pytest.approx(60.0)


def test_shares_of_rules_are_percent_of_all_samples():
    made = fit(bumps(), Options(terms=(2, 1), nested=False))
    shares = [float(part) for part in re.findall(r"([\d.e+-]+) % of the samples", made.text)]
    assert len(shares) == len(made.support)
    expected = 100.0 * np.array(made.support) / len(bumps())
    assert shares == pytest.approx(expected, rel=0.006)  # of two figures, 99.5 is 1e+02


def test_rules_of_words_say_how_many_rest_on_one_sample():
    made = fit(bumps(), Options(method="wang-mendel", words=(7, 7)))
    ones = sum(count == 1 for count in made.support)
    assert 0 < ones < len(made.support)
    assert f"{ones} rules rest on one." in " ".join(made.text.replace("#", " ").split())


def test_a_request_to_fit_has_the_defaults_of_the_options():
    from fuzzyarm.requests.learn import FitRequest

    request, options = FitRequest(data="x.csv"), Options()
    for name in ("rules", "start", "seed"):
        assert getattr(request, name) == getattr(options, name), name


@pytest.mark.parametrize("distance", [0.0, 0.5, 2.0, 4.0])
def test_how_alike_two_gaussians_are(distance):
    # Equal ones meet in the middle: what is below both are two tails of d/2 deviations.
    below_both = math.erfc(distance / 2 / math.sqrt(2))
    share = below_both / (2 - below_both)
    for a, b in (((1.0, 0.5), (1.0 + 0.5 * distance, 0.5)), ((0.0, 2.0), (-2.0 * distance, 2.0))):
        assert _overlap(a, b) == pytest.approx(share, abs=2e-3)


@pytest.mark.slow
def test_inputs_that_do_not_vary_or_depend_on_each_other():
    samples = bumps()
    inputs = np.column_stack([samples.inputs, samples.inputs[:, 0] * 2.0, np.full(60, 7.0)])
    made = fit(as_samples(inputs, samples.values), Options(rules=4, nested=False))
    assert made.error < 2.5
    doubts = check_text(made.text).diagnostics
    assert [(each.name, each.message) for each in doubts] == [
        ("unused-variable", "no rule uses 'x4'")  # it does not vary
    ]
    same = fit(as_samples(inputs, np.full(60, 3.0)), Options(nested=False))
    assert np.allclose(outputs_of(same.rulebase, as_samples(inputs, np.zeros(60))), 3.0, atol=1e-3)


@pytest.mark.slow
def test_large_and_small_units_change_nothing():
    samples = bumps()
    options = Options(terms=(2, 2), nested=False)
    here = fit(samples, options)
    scaled = as_samples(samples.inputs * 1e6, samples.values * 1e-6, samples.names)
    there = fit(scaled, options)
    assert there.error == pytest.approx(1e-6 * here.error, rel=0.05)


def test_an_interrupt_keeps_the_best(monkeypatch):
    count = 0

    def interrupt(_words):
        nonlocal count
        count += 1
        if count == 3:
            raise KeyboardInterrupt

    made = fit(bumps(), Options(), interrupt)
    assert made.interrupted
    assert "interrupted" in made.text
    is_sound(made)


def test_judging_in_one_go_is_judging_by_refitting():
    """The error for each shrinkage is that of consequents fitted without the test part."""
    from fuzzyarm.learning.data import folds
    from fuzzyarm.learning.starts import grid_premises
    from fuzzyarm.learning.sugeno import consequents, predicted

    samples = bumps()
    premises = grid_premises(samples.inputs, (2, 2))
    parts = list(folds(60, 3))
    found = CrossValidation(samples.inputs, samples.outputs, parts, (1e-3,)).judged(
        "grid", premises
    )
    for train, test in parts:
        weights, scaling = consequents(
            premises, samples.inputs[train], samples.outputs[train], 1e-3
        )
        at = samples.inputs[test]
        values = scaling.middle + scaling.range * predicted(
            premises, weights, scaling.regressors(at), at
        )
        squares = ((samples.outputs[test] - values) ** 2)[:, 0]
        assert np.allclose(found.squares[test], squares, rtol=1e-5, atol=1e-8)


# --- Judged by samples that have decided nothing ---


@pytest.mark.slow
@pytest.mark.parametrize("series", [False, True])
@pytest.mark.parametrize(
    "given", [{"rules": 4}, {"method": "wang-mendel", "words": (2, 4)}], ids=["grid", "words"]
)
def test_the_nested_error_is_that_of_going_the_whole_way_without_each_part(given, series):
    from fuzzyarm.learning.data import folds

    samples = bumps(45)
    options = Options(**given, series=series, parts=3, digits=12, seed=4)
    made = fit(samples, options)
    assert made.judged == "nested"
    assert f"nested 3-fold cross-validation{' in blocks' if series else ''} " in made.text
    off = []
    for train, test in folds(45, 3, series=series, seed=4):
        part = fit(samples.part(train), replace(options, nested=False))
        assert part.judged == "by the choice"
        assert "Its structure was chosen on the same parts" in part.text
        asked = samples.part(test)
        off.append(asked.outputs - outputs_of(part.rulebase, asked))
    assert made.cross_validation == pytest.approx(rms(np.concatenate(off)), rel=1e-3)
    plain = fit(samples, replace(options, nested=False))
    assert plain.cross_validation == plain.choice == made.choice
    assert plain.rulebase == made.rulebase


def test_where_nothing_is_chosen_nothing_is_nested():
    made = fit(bumps(), Options(terms=(2, 1), shrinkage=0.01, move=False))
    assert (made.judged, made.cross_validation) == ("fixed", made.choice)
    assert "nested" not in made.text
    assert "chosen" not in made.text
    many = bumps(1200)
    assert fit(many, Options(terms=(2, 1), move=False)).judged == "by the choice"
    assert fit(many, Options(terms=(2, 1), move=False, nested=True)).judged == "nested"


@pytest.mark.slow
def test_ctrl_c_in_the_judgement_leaves_the_model_as_it_is():
    def interrupt(words):
        if words.startswith("nested cross-validation: without part 2"):
            raise KeyboardInterrupt

    made = fit(bumps(), Options(rules=2), interrupt)
    assert (made.interrupted, made.limits, made.judged) == (False, ("judgement",), "by the choice")
    assert made.rulebase == fit(bumps(), Options(rules=2)).rulebase
    assert "interrupted" not in made.text
    is_sound(made)


@pytest.mark.parametrize(
    ("method", "seconds"),
    [(method, seconds) for method, some in (("sugeno", 7.0), ("wang-mendel", 1.0))
     for seconds in (1e-6, some, 1e9)],
)  # fmt: skip
def test_time_ends_a_search_with_the_best_until_then(method, seconds, monkeypatch):
    from itertools import count

    from fuzzyarm.learning import fit_options

    ticks = count(0.0, 0.1)  # each look at the clock takes a tenth of a second
    monkeypatch.setattr(fit_options.time, "monotonic", lambda: next(ticks))
    made = fit(bumps(), Options(method=method, words=(2, 5), rules=4, seconds=seconds, parts=3))
    monkeypatch.undo()
    assert ("time" in made.limits) == (seconds < 1e9)
    assert made.interrupted == ("ran out of time" in made.text)
    assert made.interrupted or seconds > 1e-6
    assert made.candidates
    is_sound(made)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (Options(seed=-1), "a seed of -1 is out of range"),
        (Options(merge=1.5), "a likeness of 1.5 is out of range"),
        (Options(seconds=0.0), "a time of 0 s is out of range"),
        (Options(terms=(40, 40)), "a grid of 1,600 rules is too large"),
        (Options(terms=(30, 30)), "900 rules on 2 inputs has 2,700 numbers"),
        (Options(method="magic"), "unknown method"),
        (Options(start="middle"), "unknown start"),
        (Options(rules=0), "number of rules must be 1 to"),
        (Options(parts=1), "number of parts of the cross-validation must be 2 to 100, not 1"),
        (Options(shrinkage=-1.0), "shrinkage must be 0 or more"),
        (Options(terms=(2,)), "one number of terms is needed for each of 2 inputs, not 1"),
        (Options(method="wang-mendel", words=(1, 1)), "number of words must be"),
        (Options(method="wang-mendel", words=(5, 3)), "words from 5 to 3"),
    ],
)
def test_options_without_sense_are_refused(options, message):
    with pytest.raises(ValueError, match=message):
        fit(bumps(), options)


def test_more_classes_than_outputs_are_refused_at_once(monkeypatch):
    words = tuple(f"class {k}" for k in range(33))
    samples = Samples(("a",), np.arange(66.0)[:, None], "kind", np.arange(66.0) % 33, words)
    with pytest.raises(FitError, match="'kind' has 33 classes, and a model at most 32"):
        fit(samples)


def test_too_few_samples():
    with pytest.raises(FitError, match="one sample"):
        fit(as_samples([1.0], [1.0]))
    made = fit(as_samples([1.0, 2.0], [1.0, 3.0]))
    assert infer(made.rulebase, x1=2.0)["y"] == pytest.approx(3.0, abs=0.01)


def test_few_samples_do_not_determine_the_conclusions(tmp_path, capsys):
    path = tmp_path / "few.csv"
    path.write_text("a,b,y\n1,2,3\n2,3,4\n3,3,9\n")
    report = ["fit", str(path), "-o", str(tmp_path / "few.frb"), "--terms", "3,2"]
    assert main(report) == 0
    printed = capsys.readouterr().out
    assert "cross-validation, 3 parts" in printed  # as many as there are samples
    assert "3 samples cannot determine the 18 coefficients" in printed


@pytest.mark.slow
def test_classes_have_an_output_each():
    draw = np.random.default_rng(2)
    inputs = np.concatenate([draw.normal(m, 0.3, (30, 2)) for m in (0.0, 2.0, 4.0)])
    samples = Samples(("a", "b"), inputs, "kind", np.repeat([0.0, 1.0, 2.0], 30), ("a", "m", "z"))
    made = fit(samples, Options(terms=(3, 1), nested=False))
    assert [each.name for each in made.rulebase.outputs] == ["kind a", "m", "z"]
    assert made.error < 0.05
    assert score(samples, outputs_of(made.rulebase, samples)) == made.error
    judged = validate(made.rulebase, samples)
    assert judged.error == pytest.approx(made.error)
    assert np.sum(judged.confusion) == 90
    assert np.trace(judged.confusion) == round(90 * (1.0 - made.error))


# --- Commands ---


@pytest.fixture
def table(tmp_path):
    samples = bumps(80)
    rows = np.column_stack([samples.inputs, samples.values])
    path = tmp_path / "data.csv"
    path.write_text("a,b,y\n" + "\n".join(",".join(map(str, row)) for row in rows.tolist()))
    return path


@pytest.mark.slow
def test_fit_and_validate(table, tmp_path, capsys):
    model = tmp_path / "m.frb"
    words = ["fit", str(table), "-o", str(model), "--terms", "2,1", "--test", str(table), "--json"]
    assert main([*words, "--nested", "no"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["test"]["error"] == pytest.approx(report["training"]["error"])
    assert report["rules"] == 2
    assert main(["check", "--strict", str(model)]) == 0
    figure = tmp_path / "v.png"
    capsys.readouterr()
    assert main(["validate", str(model), str(table), "--plot", str(figure), "--json"]) == 0
    judged = json.loads(capsys.readouterr().out)
    assert judged["error"] == pytest.approx(report["training"]["error"])
    assert judged["never_fired"] == []
    assert figure.read_bytes().startswith(b"\x89PNG")
    assert main(["validate", str(model), str(table)]) == 0
    assert "error by region" in capsys.readouterr().out


def test_a_surrogate_has_its_fidelity(tmp_path, capsys):
    from fuzzyarm import load, shipped

    source, model = shipped("thesis-6.1.lut"), tmp_path / "s.frb"
    assert (
        main(["fit", str(source), "-o", str(model), "--terms", "3,3", "--json", "--move", "no"])
        == 0
    )
    told = json.loads(capsys.readouterr().out)["fidelity"]
    table, rulebase = load(source), load(model)
    mesh = np.meshgrid(*(axis.levels for axis in table.axes), indexing="ij")
    off = table.values - infer(rulebase, dict(zip(table.names, mesh, strict=True)))["u"]
    assert told["worst"] == pytest.approx(np.abs(off).max())
    assert told["rms"] == pytest.approx(np.sqrt(np.mean(off**2)))


@pytest.mark.parametrize(
    ("words", "status", "message"),
    [
        (["--target", "z"], 1, "there is no column 'z'"),
        (["--words", "many"], 2, "--words takes a number"),
        (["--terms", "2"], 1, "one number of terms is needed for each of 2 inputs, not 1"),
        (["--folds", "0"], 2, "--folds must be 2 to 100, not 0"),
        (["--rules", "x"], 2, "must be a whole number, not 'x'"),
    ],
)
def test_what_is_wrong_is_one_line(table, tmp_path, capsys, words, status, message):
    assert main(["fit", str(table), "-o", str(tmp_path / "m.frb"), *words]) == status
    assert message in capsys.readouterr().err
    assert not (tmp_path / "m.frb").exists()


def test_damaged_data_are_shown_with_their_line(tmp_path, capsys):
    path = tmp_path / "d.csv"
    path.write_text("a,y\n1,2\nx,3\n")
    assert main(["fit", str(path), "-o", str(tmp_path / "m.frb")]) == 1
    said = capsys.readouterr().err
    assert "d.csv:3:1: error[not-a-number]" in said
    assert "x,3" in said


def test_the_report_says_how_was_judged_and_what_ctrl_c_has_left_out(
    table, tmp_path, monkeypatch, capsys
):
    words = ["fit", str(table), "-o", str(tmp_path / "m.frb"), "--rules", "2", "--move", "no"]
    assert main([*words, "--json"]) == 0
    judged = json.loads(capsys.readouterr().out)["cross_validation"]
    assert judged["judged"] == "nested"
    assert judged["error"] != judged["of_the_choice"]
    assert main(words) == 0
    assert "nested cross-validation, 5 parts (RMS)" in capsys.readouterr().out
    assert main([*words, "--nested", "no"]) == 0
    said = capsys.readouterr().out
    assert "nested" not in said
    assert "its structure was chosen on the same parts" in said
    monkeypatch.setattr(fitting, "_of_part", raising(KeyboardInterrupt()))
    assert main(words) == 130
    assert "the model is written" in capsys.readouterr().err
    monkeypatch.undo()
    assert main([*words, "--time", "1us"]) == 0
    assert "time ran out: the best so far is written" in capsys.readouterr().err


def raising(error):
    def fails(*_words, **_given):
        raise error

    return fails


def test_ctrl_c_writes_the_best(table, tmp_path, monkeypatch, capsys):
    whole = CrossValidation.judged

    def interrupted(self, words, premises):
        if premises.terms:
            raise KeyboardInterrupt
        return whole(self, words, premises)

    monkeypatch.setattr(CrossValidation, "judged", interrupted)
    model = tmp_path / "m.frb"
    assert main(["fit", str(table), "-o", str(model)]) == 130
    assert "interrupted" in capsys.readouterr().err
    assert "interrupted" in model.read_text()
