"""A request is read alike from words, Python, JSON and forms, and says one sentence."""

from __future__ import annotations

import importlib.util
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

import fuzzyarm
from fuzzyarm.apps.cli.main import find_command, main
from fuzzyarm.apps.designer.grounds import FieldError, form_of
from fuzzyarm.base.files import FileInUseError
from fuzzyarm.learning.fit import STARTS
from fuzzyarm.learning.tuning.optimisers import OPTIMISERS
from fuzzyarm.requests import (
    CompareRequest,
    CompileRequest,
    ExportRequest,
    FitRequest,
    LearnRequest,
    ProveRequest,
    Request,
    RequestError,
    SimulateRequest,
    SweepRequest,
    TuneRequest,
)
from fuzzyarm.requests.fields import RequestField, fields_of
from fuzzyarm.requests.journal import JournalError, WorkJournal
from fuzzyarm.requests.schema import schema_of

ROOT = Path(__file__).parents[2]

JOBS: dict[str, type[Request]] = {
    "simulate": SimulateRequest,
    "sweep": SweepRequest,
    "compare": CompareRequest,
    "learn": LearnRequest,
    "tune": TuneRequest,
    "fit": FitRequest,
    "compile": ExportRequest,
    "prove": ProveRequest,
}
"""Each job by its command."""

NEEDED = {"file": "x.frb", "controller": "x.frb", "data": "x.csv"}
"""Fields without a default."""

EVERY = [(kind, known) for kind in JOBS.values() for known in fields_of(kind)]


def made(kind: type[Request], **values: Any) -> Request:
    """Return a request with the fields that it needs."""
    needed = {known.name: NEEDED[known.name] for known in fields_of(kind) if known.is_required}
    return kind(**{**needed, **values})


def one(known: RequestField) -> st.SearchStrategy[Any]:
    """Return values that a field takes, or each of several."""
    if known.choices:
        return st.sampled_from(known.choices)
    low, high, is_open = known.spec.limits
    if known.kind == "whole":
        least, most = (None if math.isinf(end) else int(end) for end in (low, high))
        return st.integers(-(2**40) if least is None else least, 2**40 if most is None else most)
    if known.kind == "number":
        ends = (None if math.isinf(end) else end for end in (low, high))
        return st.floats(*ends, exclude_min=is_open, allow_nan=False, allow_infinity=False)
    return st.booleans() if known.kind == "truth" else st.text(min_size=1)


def values(known: RequestField) -> st.SearchStrategy[Any]:
    """Return values of a field, as Python and JSON have them."""
    if known.count is None:
        return one(known)
    return st.lists(one(known), min_size=known.count, max_size=known.count or 3)


def is_taken(kind: type[Request], known: RequestField, value: Any) -> bool:
    """Whether a field takes a value; what it says is of that field."""
    try:
        made(kind, **{known.name: value})
    except RequestError as error:
        return error.field != known.json_name
    return True


@given(st.data())
def test_what_a_field_takes_is_what_its_schema_says(data):
    kind, known = data.draw(st.sampled_from(EVERY))
    others = st.one_of(st.integers(-3, 3), st.booleans(), st.none())
    value = data.draw(st.one_of(values(known), others))
    needed = {name: NEEDED[name] for name in schema_of(kind)["required"]}
    schema = Draft202012Validator(schema_of(kind))
    taken, sound = is_taken(kind, known, value), schema.is_valid({**needed, known.json_name: value})
    # Python takes one value for a list of one.
    alone = known.count is not None and not isinstance(value, list)
    assert taken == sound or (taken and alone)


@given(st.data())
def test_what_was_read_is_read_again(data):
    kind, known = data.draw(st.sampled_from(EVERY))
    read = getattr(made(kind, **{known.name: data.draw(values(known))}), known.name)
    assert getattr(made(kind, **{known.name: read}), known.name) == read


@given(st.data())
def test_words_of_a_command_are_the_request_of_python(data):
    name = data.draw(st.sampled_from(sorted(JOBS)))
    known = data.draw(st.sampled_from([f for f in fields_of(JOBS[name]) if f.kind != "truth"]))
    value = data.draw(values(known))
    if known.kind == "text" and not known.choices:
        value = [f"x{k}" for k in range(3)][: known.count or 2] if known.count is not None else "x1"
    if not known.spec.words.startswith("-") or value == []:
        return
    items = list(value) if known.count is not None else [value]
    spoken = [item if isinstance(item, str) else repr(item) for item in items]
    if len(spoken) > 1 and known.spec.is_repeated:
        words = [part for word in spoken for part in (known.spelling, word)]
    else:
        words = [known.spelling, *spoken]
    parser = find_command(name).parser()
    if any(word.startswith("-") for word in spoken) or "e" in "".join(spoken):
        return  # a sign, or an exponent, is for an equals sign
    needed = [part for f in fields_of(JOBS[name]) if f.is_required for part in ("x.csv",)]
    out = ["-o", "x.frb"] if name in ("fit", "compile") else []
    parsed = vars(parser.parse_intermixed_args([*needed, *out, *words]))
    expected = getattr(made(JOBS[name], **{known.name: value}), known.name)
    found = made(JOBS[name], **{known.name: parsed[known.name]})
    assert getattr(found, known.name) == expected


@pytest.mark.parametrize(
    ("name", "option", "value", "why"),
    [
        ("tune", "evals", 0, "must be 1 to 10000000, not 0"),
        ("tune", "evals", "many", "must be a whole number, not 'many'"),
        ("tune", "method", "cma-s", "must be nelder-mead, cma-es or evolution, not 'cma-s'"),
        ("learn", "rate", 11, "must be 0 to 10, not 11"),
        ("learn", "delay", -1, "must be 0 to 1000 periods, not -1 periods"),
        ("fit", "merge", 2, "must be 0 to 1, not 2"),
        ("simulate", "seed", -1, "must be at least 0, not -1"),
        ("compile", "mode", "cubic", "must be bins, nearest or linear, not 'cubic'"),
    ],
)
def test_one_sentence_from_python_command_and_designer(name, option, value, why, capsys):
    with pytest.raises(RequestError) as error:
        made(JOBS[name], **{option: value})
    assert error.value.message == f"{option} {why}"
    with pytest.raises(FieldError) as form:
        form_of(JOBS[name], **NEEDED, **{option: value})
    assert (form.value.message, form.value.field) == (error.value.message, option)
    out = ["-o", "x.frb"] if name in ("fit", "compile") else []
    assert main([name, "x.csv", *out, f"--{option}={value}"]) == 2
    assert f"--{option} {why}" in capsys.readouterr().err


def test_choices_are_those_of_the_engines():
    def choices(kind, name):
        return next(known.choices for known in fields_of(kind) if known.name == name)

    assert choices(TuneRequest, "method") == tuple(OPTIMISERS)
    assert choices(FitRequest, "start") == STARTS


def test_what_a_request_withholds_is_refused():
    with pytest.raises(RequestError, match="hold is not a field of CompareRequest"):
        CompareRequest(hold=1.0)
    with pytest.raises(RequestError, match="hold is not a field of CompareRequest"):
        CompareRequest(controllers="pd").replaced(hold=5.0)
    assert "hold" not in schema_of(CompareRequest)["properties"]


def test_calls_take_a_request_as_well():
    servo = str(fuzzyarm.shipped("servo.frb"))
    asked = SimulateRequest(controller=servo, reference="position=step:1", duration="50ms")
    named = fuzzyarm.simulate(servo, reference={"position": "step:1"}, duration="50ms")
    assert (fuzzyarm.simulate(asked).error_matrix == named.error_matrix).all()
    swept = SweepRequest(controller=servo, sweep="J=0.01..0.02:2", duration="50ms", workers=1)
    runs = [{"J": 0.01}, {"J": 0.02}]
    many = fuzzyarm.simulate_many(servo, "motor", runs, duration="50ms", workers=1)
    assert (fuzzyarm.simulate_many(swept).rms == many.rms).all()
    with pytest.raises(TypeError, match="alone"):
        fuzzyarm.simulate(asked, "motor")
    stepped = fuzzyarm.simulate(servo, "motor", step=1.0, duration="50ms")
    assert (stepped.error_matrix == named.error_matrix).all()
    many = fuzzyarm.simulate_many(servo, "motor", [{}], step=1.0, duration="50ms", workers=1)
    assert many.rms[0, 0] == named.rms[0]
    with pytest.raises(fuzzyarm.FuzzyarmError, match="a step and references exclude each other"):
        fuzzyarm.simulate(servo, "motor", step=1.0, reference={"position": 1.0})
    table = fuzzyarm.compile_table(
        CompileRequest(file=str(fuzzyarm.shipped("pd7.frb")), levels="5")
    )
    assert table.shape == (5, 5)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: TuneRequest("x.frb"), "(write, for instance, TuneRequest(file='x.frb'))"),
        (TuneRequest, "file of TuneRequest is missing"),
        (lambda: TuneRequest(file="x.frb", evls=3), "(did you mean 'evals'?)"),
        (lambda: TuneRequest(file="x.frb", evals="many"), "evals must be a whole number"),
        (lambda: SimulateRequest(**{"for": "2s"}), "(the field of --for is 'duration')"),
        (lambda: fuzzyarm.simulate("pd", on="arm"), "no argument 'on' (it is now 'plant')"),
        (lambda: fuzzyarm.simulate("pd", along="reach"), "(it is now 'trajectory')"),
        (lambda: fuzzyarm.simulate("pd", references={}), "(it is now 'reference')"),
        (lambda: fuzzyarm.simulate("pd", refernce={}), "(did you mean 'reference'?)"),
        (lambda: fuzzyarm.tune("pd", tuning=["peaks e"]), "(it is now 'tune')"),
        (lambda: fuzzyarm.tune("pd", seconds=3.0), "(it is now 'time')"),
        (lambda: fuzzyarm.tune(TuneRequest(file="x.frb"), evals=3), "takes a request alone"),
    ],
)
def test_a_slip_in_a_call_is_an_error_of_fuzzyarm_that_says_what_was_meant(make, message):
    with pytest.raises(fuzzyarm.FuzzyarmError) as error:
        make()
    assert message in str(error.value)


def test_the_schemas_are_published():
    place = ROOT / "tools" / "make_schemas.py"
    spec = importlib.util.spec_from_file_location("make_schemas", place)
    assert spec is not None and spec.loader is not None  # noqa: PT018
    maker = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(maker)
    for kind in maker.requests():
        Draft202012Validator.check_schema(schema_of(kind))
        file = ROOT / "docs" / "schemas" / f"{maker.request_name(kind)}.json"
        assert file.read_text("utf-8") == maker.request_text(kind), "python tools/make_schemas.py"
    assert {kind.__name__ for kind in JOBS.values()} <= {k.__name__ for k in maker.requests()}


# --- The journal ---


def lines(path: Path, count: int) -> WorkJournal:
    """Return a journal with some lines."""
    journal = WorkJournal(path, "sweep", {"asked": 1}, ["run", "x"])
    journal.begin()
    journal.append([[str(at), f"{at / 3!r}"] for at in range(count)])
    return journal


@given(st.integers(0, 5), st.integers(0, 200))
def test_a_journal_cut_anywhere_is_the_front_of_the_whole(tmp_path_factory, count, cut):
    path = tmp_path_factory.mktemp("journal") / "x.csv"
    journal = lines(path, count)
    whole = path.read_bytes()
    path.write_bytes(whole[: max(len(journal.head.encode()), len(whole) - cut)])
    rows = journal.resume()
    journal.append([[str(at), f"{at / 3!r}"] for at in range(len(rows), count)])
    assert path.read_bytes() == whole


def test_a_journal_refuses_what_it_is_not(tmp_path):
    path = tmp_path / "x.csv"
    journal = lines(path, 2)
    with pytest.raises(JournalError, match="has 2 of the 3 runs"):
        journal.begin(3)
    other = WorkJournal(path, "sweep", {"asked": 2}, ["run", "x"])
    with pytest.raises(JournalError, match="belongs to another sweep: asked was 1, not 2"):
        other.resume()
    with pytest.raises(JournalError, match="is not of this sweep"):
        other.begin(may_replace=False)
    path.write_text("a,b\n1,2\n")
    with pytest.raises(JournalError, match="is not a sweep file"):
        journal.resume()


@pytest.mark.parametrize("name", ["simulate", "sweep", "compare", "learn", "tune", "fit"])
def test_what_is_on_by_default_can_be_switched_off(name: str) -> None:
    parser = find_command(name).parser()
    on = [action for action in parser._actions if action.default is True]
    assert on or name == "fit"
    for action in on:
        off = [word for word in action.option_strings if word.startswith("--no-")]
        assert off, action.dest


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_a_full_disk_is_said_of_the_journal():
    journal = WorkJournal("/dev/full", "sweep", {"asked": 1}, ["run", "x"])
    for work in (journal.begin, lambda: journal.append([["0", "1"]]), journal.close):
        with pytest.raises(OSError, match="/dev/full"):
            work()


HOLDER = """\
import sys
from fuzzyarm.requests.journal import WorkJournal
journal = WorkJournal(sys.argv[1], "sweep", {"asked": 1}, ["run", "x"])
journal.begin()
journal.append([["0", "0.0"]])
print("begun", flush=True)
sys.stdin.read()
"""


def test_one_process_writes_a_journal(tmp_path):
    path = tmp_path / "x.csv"
    command = [sys.executable, "-c", HOLDER, str(path)]
    with subprocess.Popen(command, stdin=-1, stdout=-1, text=True) as first:
        assert first.stdout.readline() == "begun\n"
        before = path.read_bytes()
        other = WorkJournal(path, "sweep", {"asked": 1}, ["run", "x"])
        with pytest.raises(FileInUseError, match="is being written by other work"):
            other.resume()
        with pytest.raises(FileInUseError):
            other.begin(total=1)
        assert path.read_bytes() == before
        first.kill()  # a lock does not outlive who holds it
    assert other.resume() == [["0", "0.0"]]
    other.append([["1", "0.5"]])
    other.close()
    again = WorkJournal(path, "sweep", {"asked": 1}, ["run", "x"])
    assert again.resume() == [["0", "0.0"], ["1", "0.5"]]
