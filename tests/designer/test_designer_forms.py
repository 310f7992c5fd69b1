"""The forms of a page follow from requests: fields, words, and what is wrong with a value."""

from pathlib import Path

import pytest
from jsonschema import Draft202012Validator
from offenders import check_all

from fuzzyarm.apps.cli.main import main
from fuzzyarm.apps.designer.exports import forms_of
from fuzzyarm.apps.designer.forms import FORMS, judged
from fuzzyarm.apps.designer.records import MessageError
from fuzzyarm.apps.designer.stage import Plants
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.requests.fields import fields_of
from fuzzyarm.requests.schema import form_fields

PLANTS = Plants()


def session(name):
    return Session(str(shipped(name)), shipped(name).read_text())


def every_form():
    """Yield what each form is of, and its fields."""
    for name, form in FORMS.items():
        yield name, form.fields()
    for name in ("pd7.frb", "servo.frb", "thesis-6.1.lut"):
        for suffix, fields in forms_of(session(name)).items():
            yield f"{name} as {suffix}", fields


def test_each_field_says_what_a_page_needs_of_it():
    def check(named):
        for field in named[1]:
            schema = {key: field[key] for key in ("type", "enum", "items") if key in field}
            Draft202012Validator.check_schema(schema)
            assert field["title"], field
            assert field["description"], field
            if "default" in field:
                assert Draft202012Validator(schema).is_valid(field["default"]), field

    check_all(every_form(), check, name=lambda named: named[0])


def test_what_is_shown_by_default_is_the_request_by_default():
    for name, form in FORMS.items():
        needed = {form.open: "x.frb"} if form.open else {}
        chosen = {"data": "x.csv"} if name == "fit" else {}
        shown = {field["name"]: field.get("default") for field in form.fields()}
        request = form.request(shown | chosen, Path(), **needed)
        assert request == form.kind(**needed, **chosen)


def test_a_title_is_the_word_of_the_option():
    for form in FORMS.values():
        spelled = {field.json_name: field.spelling for field in fields_of(form.kind)}
        for field in form_fields(form.kind, *spelled):
            assert field["option"] in ("", spelled[field["name"]])
            assert field["title"].lower() == spelled[field["name"]].strip("-").replace(
                "-", " "
            ).replace("_", " ")


@pytest.mark.parametrize(
    ("form", "field", "value", "option"),
    [
        ("tune", "evals", "many", "--evals"),
        ("tune", "digits", "99", "--digits"),
        ("learn", "rate", "11", "--rate"),
        ("run", "seed", "-1", "--seed"),
    ],
)
def test_a_field_says_what_the_command_says(form, field, value, option, capsys):
    wrong = judged(form, {field: value}, Path(), PLANTS)
    assert wrong["field"] == field
    command = {"run": "simulate"}.get(form, form)
    main([command, "servo", f"{option}={value}"])
    printed = " ".join(capsys.readouterr().err.split())
    assert f"{option} {wrong['message'].removeprefix(f'{field} ')}" in printed


@pytest.mark.parametrize(
    ("form", "field", "value", "option"),
    [
        ("run", "duration", "abc", "--for"),
        ("run", "reference", "position=wave:1", "--reference"),
        ("run", "noise", "speed=1", "--noise"),
        ("tune", "vary", "J=x", "--vary"),
        ("sweep", "sweep", "G_e=abc", "--sweep"),
    ],
)
def test_a_word_of_an_experiment_is_judged_on_its_plant(form, field, value, option, capsys):
    wrong = judged(form, {"plant": "motor", field: value}, Path(), PLANTS)
    command = {"run": "simulate"}.get(form, form)
    main([command, str(shipped("servo.frb")), "--plant", "motor", option, value])
    printed = " ".join(capsys.readouterr().err.split()).replace("--for takes", "the duration takes")
    assert wrong["field"] == field
    assert wrong["message"] in printed


def test_what_a_form_does_not_offer_is_not_asked_for():
    """A page may not name files to be written, nor where work is done."""
    assert judged("tune", {"out": "/x.frb", "dask": "tcp://x", "evals": "9"}, Path(), PLANTS) == {}
    asked = FORMS["tune"].request({"out": "/x.frb", "dask": "tcp://x"}, Path(), file="y.frb")
    assert (asked.file, asked.out, asked.dask) == ("y.frb", None, None)
    with pytest.raises(MessageError, match="is not a form"):
        judged("dance", {}, Path(), PLANTS)


def test_a_file_of_a_signal_stands_in_the_folder(tmp_path):
    for value in ("position=/etc/x.csv", ["position=../x.csv"]):
        wrong = judged("run", {"reference": value}, tmp_path, PLANTS)
        assert (wrong["field"], "is not a file of this folder" in wrong["message"]) == (
            "reference",
            True,
        )
    assert judged("run", {"reference": "position=x.csv"}, tmp_path, PLANTS) == {}
