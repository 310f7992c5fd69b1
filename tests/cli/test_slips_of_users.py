"""Slips of users: a word of another program, a number that nothing has, a missing file."""

import shutil

import pytest

from fuzzyarm import shipped
from fuzzyarm.apps.cli import convert
from fuzzyarm.apps.cli.main import COMMANDS, MEANT, main
from fuzzyarm.base.diagnostic import Diagnostic, Severity
from fuzzyarm.base.numbers import percent
from fuzzyarm.control.controllers.catalogue import CATALOGUE, Choice, Entry
from fuzzyarm.control.loop.experiments import controllers_of
from fuzzyarm.exchange.export.table import fewer_levels
from fuzzyarm.requests import SimulateRequest

SERVO = str(shipped("servo.frb"))
SHORT = ["--for", "10ms"]


def said(capsys, *words, status):
    assert main(list(words)) == status
    return capsys.readouterr()


def test_words_of_other_programs_are_understood(capsys):
    assert "did you mean 'compile'?" in said(capsys, "export", "pd7.frb", status=2).err
    assert set(MEANT.values()) <= set(COMMANDS)
    assert not set(MEANT) & set(COMMANDS)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--quantise", "position=99bit"], "--quantise takes 1 to 32 bits, not 99bit"),
        (["--quantise", "position=0bit"], "--quantise takes 1 to 32 bits, not 0bit"),
        (["--sweep", "J=0.01..0.02:9999999999"], "a range of 'J' has 1 to 1,000,000 values, not"),
        (["--sweep", "J=0.01..0.02:0"], "a range of 'J' has 1 to 1,000,000 values, not 0"),
        (["--start", "cold"], "--start cold is for adaptive controllers (they are acdid, "),
        (["--variant", "as-described"], "for controllers of which the study has two (they are ct"),
    ],
)
def test_what_nothing_has_is_refused(words, sentence, capsys):
    assert sentence in said(capsys, "simulate", SERVO, *SHORT, *words, status=2).err


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--set", "J=x"], "--set J=x: 'x' is not a number"),
        (["--set", "J=nan"], "--set J=nan: 'nan' is not a number"),
        (["--set", "J"], "--set takes NAME=NUMBER, not 'J'"),
        (["--set", "J=1..3"], "--sweep NAME=LOW..HIGH:COUNT"),
        (["--for", "-5s"], "--for is not negative, as '-5s' is"),
        (["--noise", "position=-1"], "--noise position=-1 is out of range"),
        (["--noise", "position=nan"], "--noise takes a number, not 'nan'"),
        (["--noise", "position=1", "--noise", "position=2"], "--noise names 'position' twice"),
        (["--quantise", "position=-1"], "--quantise position=-1 is out of range"),
    ],
)
def test_a_wrong_value_is_named_as_it_is_typed(words, sentence, capsys):
    assert sentence in said(capsys, "simulate", SERVO, "--plant", "motor", *words, status=2).err


def test_a_time_that_is_not_one_of_set_points_is_said(capsys):
    err = said(capsys, "simulate", str(shipped("heater.frb")), "--for", "1s", status=0).err
    assert "1 s are not a whole number of set points of 10 s: 10 s are run" in err
    assert "whole number" not in said(capsys, "simulate", SERVO, *SHORT, status=0).err


def test_a_port_that_the_plant_has_needs_no_joining(capsys):
    words = ["--for", "60s", "--connect", "temperature=air"]
    err = said(capsys, "simulate", str(shipped("heater.frb")), *words, status=1).err
    assert "no reference value 'air' (it has temperature)" in err


def test_a_choice_that_a_controller_has_is_taken():
    for entry in CATALOGUE.values():
        if isinstance(entry, Entry):
            printed, described = (
                entry.make(Choice(variant=variant)) for variant in ("as-printed", "as-described")
            )
            gains = [
                {name: str(gain) for name, gain in law.gains.items()}
                for law in (printed, described)
            ]
            assert (gains[0] != gains[1]) == entry.described, entry.name
    for name, choice in (
        ("acdid", {"start": "cold"}),
        (str(shipped("mrac+fuzzy.frb")), {"start": "cold"}),
        ("ct", {"variant": "as-described"}),
    ):
        assert controllers_of(SimulateRequest(controller=(name,), **choice), [name])


def test_a_rate_of_what_is_not_an_output_is_said_with_its_line(tmp_path, capsys):
    plant = tmp_path / "mass.py"
    plant.write_text(
        "from fuzzyarm.plant import Plant, Port\n"
        "class Mass(Plant):\n"
        "    name = 'mass'\n"
        "    inputs = {'force': Port('N')}\n"
        "    outputs = {'way': Port('m'), 'v': Port('m/s', rate_of='wya')}\n"
        "    states = {'x': 'm', 'v': 'm/s'}\n"
        "    def derivative(self, t, x, u, p):\n"
        "        return [x[1], u[0]]\n"
    )
    err = said(capsys, "simulate", SERVO, "--plant", str(plant), status=1).err
    assert "mass.py:5: plant mass: output 'v' is the rate of 'wya'" in err
    assert "did you mean 'way'?" in err


def test_mistakes_do_not_hide_a_file_that_is_not_there(tmp_path, capsys):
    file = tmp_path / "crane.frb"
    file.write_text(
        'controller crane\nuse rules from "nofile.frb"\nperiod 10 ms\n'
        "axis m\n  e = eror of x\n  f = rules rules(e, e)\n  drive force = f\n"
    )
    out = said(capsys, "check", str(file), status=1).err
    assert "2:1: error[missing-file]: cannot read 'nofile.frb'" in out
    assert "error[unknown-source]" in out
    assert "did you mean 'error'?" in out


def test_tables_in_a_text_end_without_blanks(capsys):
    out = said(capsys, "show", str(shipped("pd7.frb")), status=0).out
    assert "\n" in out
    assert not [line for line in out.splitlines() if line != line.rstrip()]


@pytest.mark.parametrize(
    ("share", "digits", "text"),
    [(1.0, 2, "100 %"), (0.0123, 2, "1.2 %"), (-33.28, 4, "-3328 %"), (0.12345, 3, "12.3 %"),
     (-123456.0, 3, "-12345600 %"), (0.0, 3, "0 %")],
)  # fmt: skip
def test_a_share_in_percent_has_no_exponent(share, digits, text):
    assert percent(share, digits) == text


def test_a_constant_target_has_no_variance_to_explain(tmp_path, capsys):
    rows = "".join(f"{k / 10},0,5.1\n" for k in range(41))
    (tmp_path / "data.csv").write_text("e,ce,u\n" + rows)
    # Of a controller it is the rule base that it uses, here in a file of its own.
    for name in ("pd7.frb", "servo.frb"):
        shutil.copy(shipped(name), tmp_path)
        words = ["validate", str(tmp_path / name), str(tmp_path / "data.csv")]
        out = said(capsys, *words, status=0).out
        assert "'u' is constant, with no variance to explain" in out
        assert "e+" not in out
        assert "no line of observed over predicted: the target is constant" in out


@pytest.mark.parametrize(
    ("targets", "why"), [((0, 0), "the target is constant"), ((0, 1), "all predictions are equal")]
)
def test_equal_predictions_have_no_line(tmp_path, capsys, targets, why):
    (tmp_path / "data.csv").write_text("e,ce,u\n" + "".join(f"0,0,{u}\n" for u in targets))
    words = ["validate", str(shipped("pd7.frb")), str(tmp_path / "data.csv")]
    out = said(capsys, *words, status=0).out
    assert f"predicted: {why}" in out
    assert "nan" not in out


def test_a_controller_with_several_rule_bases_is_asked_which(tmp_path, capsys):
    (tmp_path / "data.csv").write_text("e,ce,u\n0,0,0\n1,1,1\n")
    words = ["validate", str(shipped("stfc.frb")), str(tmp_path / "data.csv")]
    err = said(capsys, *words, status=1).err
    assert "uses 2 rule bases (it uses " in err


def test_what_is_left_out_is_not_nothing():
    left_out = Diagnostic("dropped-expectations", "left out", severity=Severity.INFO)
    choice = Diagnostic("assumed-producer", "read as of MATLAB", severity=Severity.INFO)
    assert convert._summary([choice]) == "nothing lost"
    assert convert._summary([left_out, choice]) == "numbers unchanged"


def test_a_name_that_nothing_has_shows_the_gains_and_the_parameters(capsys):
    err = said(capsys, "simulate", SERVO, "--plant", "motor", "--set", "mass=3", status=1).err
    assert "neither servo nor motor has 'mass' (there are G_e, G_ce, G_u, J, b, " in err


def test_compare_sets_a_gain_where_it_is_and_a_parameter_for_all(capsys, tmp_path):
    second = tmp_path / "second.frb"
    text = shipped("servo.frb").read_text("utf-8").replace("G_u", "H_u")
    second.write_text(text.replace("controller servo", "controller second"), "utf-8")
    shutil.copy(shipped("pd7.frb"), tmp_path)
    words = ["--plant", "motor", "--step", "1", *SHORT, "--set", "J=0.02", "--set", "H_u=4.5"]
    same = said(capsys, "compare", SERVO, str(second), *words, status=0).out.splitlines()
    assert same[0] == "motor, position step:1, set J=0.02 and H_u=4.5"
    assert same[2].removeprefix("servo").split() == same[3].removeprefix("second").split()
    words[-1] = "H_u=9"
    other = said(capsys, "compare", SERVO, str(second), *words, status=0).out.splitlines()
    assert other[2] == same[2]
    assert other[3] != same[3]


def test_tune_says_that_it_wrote_no_file(capsys):
    words = ["--plant", "motor", "--evals", "2", "--no-linear"]
    assert "no file was written; -o FILE" in said(capsys, "tune", SERVO, *words, status=0).err


@pytest.mark.parametrize(("axes", "levels"), [(1, 1_000_000), (2, 1000), (3, 100), (4, 31)])
def test_the_hint_about_a_large_table_fits(axes, levels):
    assert fewer_levels(axes, 1_000_000).endswith(f"--levels {levels}")
