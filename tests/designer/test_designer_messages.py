"""What a page may say: which messages are refused, and that no other fault is called one."""

import dataclasses
import json
import math
from collections.abc import Mapping
from typing import Literal, get_args, get_origin, get_type_hints

import pytest
from budget import cases
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from test_designer_server import PD7, hear, socket_of

from fuzzyarm.apps.designer import requests
from fuzzyarm.apps.designer.records import json_name
from fuzzyarm.apps.designer.shared import SharedText
from fuzzyarm.base.shipped_files import shipped

# What a page may send is read before any handler sees it; what a handler fails at is its fault.

TEXTS = st.text(max_size=4) | st.sampled_from(["e", "u", "ZE", "PB", "triangle", "input", "and"])
WHOLE = st.integers(-2, 12)
REAL = st.floats(-9, 9) | st.sampled_from(["inf", "-inf"])
PLAIN = {str: TEXTS, int: WHOLE, float: REAL, bool: st.booleans(), type(None): st.none()}


def values_of(annotation):
    """Return JSON that reads as an annotation of a record."""
    if dataclasses.is_dataclass(annotation):
        hints = get_type_hints(annotation)
        return st.fixed_dictionaries({json_name(name): values_of(of) for name, of in hints.items()})
    kinds, origin = get_args(annotation), get_origin(annotation)
    if origin is Literal:
        return st.sampled_from(kinds)
    if origin is tuple:
        several = kinds[1:] == (...,)
        fixed = st.tuples(*map(values_of, [] if several else kinds)).map(list)
        return st.lists(values_of(kinds[0]), max_size=4) if several else fixed
    if origin is Mapping:
        return st.dictionaries(TEXTS, values_of(kinds[1]), max_size=2)
    return st.one_of([values_of(kind) for kind in kinds]) if kinds else PLAIN[annotation]


def questions():
    return st.sampled_from(sorted(requests.TEXT_QUESTIONS)).flatmap(
        lambda what: values_of(requests.TEXT_QUESTIONS[what]).map(lambda q: {"what": what, **q})
    )


DAMAGE = st.sampled_from([None, True, -1, 1e300, 10**400, math.nan, "", "x" * 99, [], [[]], {}])


@pytest.mark.slow
@settings(max_examples=cases(150, 3000), suppress_health_check=list(HealthCheck))
@given(st.data())
def test_no_question_of_any_form_is_a_fault_of_the_program(tmp_path_factory, data):
    folder = tmp_path_factory.getbasetemp() / "questions"
    folder.mkdir(exist_ok=True)
    name, text = data.draw(st.sampled_from(QUESTIONED))
    (folder / name).write_text(text)
    asked = data.draw(questions())
    field = data.draw(st.none() | st.sampled_from(sorted(asked)))
    if field not in (None, "what"):
        asked[field] = data.draw(DAMAGE)
    answer = SharedText(folder / name).answer(asked)
    assert "internal" not in answer, asked
    assert "error" not in answer or answer["error"]


QUESTIONED = [
    ("pd7.frb", PD7),
    ("pd7-begun.frb", "rulebase x\ninput e -1 .. 1\n"),
    ("servo.frb", shipped("servo.frb").read_text()),
    ("table.lut", shipped("thesis-6.1.lut").read_text()),
    ("other.frb", "\ud7ff\n\x00 nothing at all"),
]


def test_repairs_are_those_of_the_line_that_is_asked_about(tmp_path):
    (tmp_path / "x.frb").write_text(
        "rulebase x\ninput e -1 .. 1\noutput u -1 .. 1\nterms e: triangels N P\n"
        "terms u: singeltons A B\nrule if e is N then u is A\nrule if e is P then u is B\n"
    )
    shared = SharedText(tmp_path / "x.frb")
    assert len(shared.session.review().diagnostics) == 2

    def texts(line, **more):
        fixes = shared.answer({"what": "fixes", "at": [line, 0], **more})["fixes"]
        return [edit["text"] for fix in fixes for edit in fix["edits"]]

    assert [texts(line) for line in range(6)] == [[], [], [], ["triangles"], ["singletons"], []]
    assert texts(3, name="unknown-shape") == ["triangles"]
    assert texts(3, name="unknown-name") == []


def test_each_question_and_each_work_has_its_record_and_its_handler():
    from fuzzyarm.apps.designer import folder, open_files, shared

    assert set(shared._QUESTIONS) == set(requests.TEXT_QUESTIONS)
    apart = {"findings", "import", "convert", "judge"}  # the server does these beside the answering
    assert set(folder._ACTS) == set(requests.FOLDER_QUESTIONS) - apart
    assert set(open_files._COMMANDS) == set(requests.COMMANDS)
    of_plants = {"run", "plants"}
    assert set(open_files.WORKS) == set(requests.WORKS) - of_plants


@pytest.mark.faults
def test_a_fault_of_a_handler_is_an_internal_error_with_its_trace(client, monkeypatch, caplog):
    from fuzzyarm.apps.designer import shared

    def fail(_shared, _asked):
        return {}["nothing"]  # a KeyError, as a careless message was answered once

    monkeypatch.setitem(shared._QUESTIONS, "format", fail)
    with socket_of(client) as socket:
        for message in (
            {"do": "open", "file": "pd7.frb"},
            {"do": "ask", "file": "pd7.frb", "what": "format", "id": 1},
            {"do": "ask", "file": "pd7.frb", "what": "hover", "id": 2, "at": "here"},
        ):
            socket.send_text(json.dumps(message))
        first, second = (hear(socket, "answer") for _ in range(2))
    assert first["internal"]
    assert "internal error: KeyError('nothing')" in first["error"]
    assert "internal" not in second
    assert second["error"] == "a message is not understood: at must be a list"
    (entry,) = caplog.records
    assert entry.name == "fuzzyarm.apps.designer"
    assert entry.exc_info[2].tb_next is not None  # down to the handler


@pytest.mark.parametrize(
    ("message", "words"),
    [
        ("", "it is not JSON"),
        ("[" * 99_999, "it is not JSON"),
        ("[1]", "it must be an object"),
        ('{"do": "dance"}', "do must be one of hello, open"),
        ('{"do": "open"}', "file is missing"),
        ('{"do": "open", "file": 7}', "file must be text, not 7"),
        ('{"do": "push", "file": "pd7.frb", "version": true, "updates": []}', "version must be a"),
        ('{"do": "start", "file": "pd7.frb", "id": 1, "what": "none"}', "what is not a kind of"),
        ('{"do": "say", "id": 1e999}', "id must be a whole number, not inf"),
    ],
)
def test_a_message_without_form_is_refused_with_its_field(client, message, words):
    with socket_of(client) as socket:
        socket.send_text(message)
        assert words in hear(socket, "failed")["message"]
