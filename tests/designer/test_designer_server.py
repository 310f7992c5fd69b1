"""Who is let in, what a window may ask, and how texts are merged; without a browser."""

import json
import math
import os
import re
import shutil
import socket
import subprocess
import threading
from dataclasses import dataclass
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from needs import requires

from fuzzyarm.apps.designer import open_files, requests
from fuzzyarm.apps.designer.assets import PAGE, asset, index_page, modules
from fuzzyarm.apps.designer.changes import ChangeError, applied, difference, merged
from fuzzyarm.apps.designer.shared import ConflictError, SharedText
from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.inference import infer
from fuzzyarm.inference.sets import straight_pieces
from fuzzyarm.language.edit import ReshapeError, apply_edits, read, set_cell, set_shapes
from fuzzyarm.language.model.rulebase import Shape
from fuzzyarm.language.model.shapes import membership_function, polyline
from fuzzyarm.symbolic import kinds

TOKEN = "a" * 32
PD7 = shipped("pd7.frb").read_text()

# --- changes ---

texts = st.text(st.sampled_from("ab\n\U0001f600é"), max_size=12)


@given(texts, texts)
def test_a_difference_leads_from_one_text_to_the_other(old, new):
    assert applied(old, difference(old, new)) == new


@pytest.mark.parametrize("changes", [None, [3], [-1], [[1, 2]], [[]], ["x"], [True, [0, "a"], 9]])
def test_changes_of_another_text_are_refused(changes):
    with pytest.raises(ChangeError):
        applied("ab", changes)


lines = st.lists(st.sampled_from(["a\n", "b\n", "c\n"]), max_size=5).map("".join)


@given(lines, lines)
def test_one_writer_is_no_conflict(base, other):
    assert merged(base, base, other) == other
    assert merged(base, other, base) == other
    assert merged(base, other, other) == other


def test_other_lines_are_merged_and_the_same_are_not():
    base = "one\ntwo\nthree\nfour\n"
    mine = base.replace("one", "ONE")
    assert merged(base, mine, base.replace("four", "FOUR")) == "ONE\ntwo\nthree\nFOUR\n"
    assert merged(base, mine, base.replace("one", "eins")) is None


# --- edits of the text ---


def test_a_term_of_a_family_gets_a_line_of_its_own_and_keeps_it():
    text = PD7
    for right in (3.0, 2.5):
        shape = Shape("triangle", (-2.0, 0.0, right))
        text = apply_edits(text, set_shapes(read(text), [("e", "ZE", shape)]))
        assert read(text).model.variable("e").term("ZE").shape == shape
    assert text.count("term e ZE: triangle -2 0 2.5\n") == 1
    assert text.replace("term e ZE: triangle -2 0 2.5\n", "") == PD7


def test_comments_stay_where_a_term_changes():
    text = 'rulebase r "r"\ninput x 0 .. 1\nterm x A: triangle 0 0.5 1 height 0.5  # half\n'
    edits = set_shapes(read(text), [("x", "A", Shape("triangle", (0.0, 0.25, 1.0), 0.5))])
    assert apply_edits(text, edits) == text.replace("0 0.5 1", "0 0.25 1")


def test_a_cell_is_replaced_and_columns_stay():
    rows = [rule.span for rule in read(PD7).model.rules]
    text = apply_edits(PD7, set_cell(read(PD7), rows[0].line, rows[0].column, None))
    assert "  NB      .   NB  NB  NM  NS  NS  ZE\n" in text
    again = apply_edits(text, set_cell(read(text), rows[0].line, rows[0].column, "NB"))
    assert again == PD7
    with pytest.raises(ReshapeError):
        set_cell(read(PD7), 1, 1, "NB")


# --- what the page knows of shapes while a hand holds one ---

SHAPES = [
    ("triangle", (-1.0, 0.5, 2.0)), ("triangle", (0.0, 0.0, 1.0)), ("ramp", (2.0, -1.0)),
    ("trapezoid", (-math.inf, -math.inf, 0.0, 0.5)), ("trapezoid", (-3.0, -1.0, 0.2, 5.0)),
    ("trapezoid", (-math.inf,) * 2 + (math.inf,) * 2), ("rectangle", (-0.25, 0.75)),
    ("ramp", (-1.0, 0.5)), ("points", (-2.0, 0.25, 0.0, 1.0, 0.0, 0.5, 4.0, 0.0)),
    ("binary", (0.5, math.inf)), ("binary", (0.5, -math.inf)), ("singleton", (0.25,)),
]  # fmt: skip

CORNERS = """
import { cornersOf, piecesOf } from "./geometry/shapes.js";
import { readFileSync } from "fs";
console.log(JSON.stringify(JSON.parse(readFileSync(0)).map(([kind, numbers]) => {
  const corners = cornersOf({ kind, height: 0.5 }, numbers.map(Number));
  return [corners, piecesOf(corners, -1, 1)];
})));
"""


@requires("node")
def test_corners_and_pieces_in_the_page_are_those_of_python(tmp_path):
    shutil.copytree(PAGE / "geometry", tmp_path / "geometry")
    (tmp_path / "package.json").write_text('{"type": "module"}')
    (tmp_path / "run.js").write_text(CORNERS)
    given_shapes = [(kind, [str(x).replace("inf", "Infinity") for x in p]) for kind, p in SHAPES]
    done = subprocess.run(
        ["node", str(tmp_path / "run.js")], input=json.dumps(given_shapes), capture_output=True,
        text=True, check=True, timeout=60,
    )  # fmt: skip
    for (kind, numbers), (corners, pieces) in zip(SHAPES, json.loads(done.stdout), strict=True):
        expected = polyline(Shape(kind, numbers, 0.5))
        assert corners == [number for corner in expected for number in corner], kind
        cut = [tuple(piece[:4]) for piece in straight_pieces(expected, -1.0, 1.0)]
        assert list(zip(*[iter(pieces)] * 4, strict=True)) == cut, kind


CURVES = [
    ("gaussian", (2.0, 0.5)), ("two-sided-gaussian", (1.0, 0.25, 3.0, 0.75)),
    ("bell", (2.0, 1.0, 3.0)), ("sigmoid", (2.0, -4.0)), ("cosine", (2.0, 1.0)),
    ("sigmoid-difference", (1.0, 4.0, 3.0, 2.0)), ("sigmoid-product", (1.0, 4.0, 3.0, -2.0)),
    ("spike", (2.0, 5.0)), ("s", (1.0, 2.0)), ("z", (1.0, 2.0)), ("pi", (0.0, 1.0, 2.0, 4.0)),
    ("ramp", (1.0, 3.0)), ("concave", (1.0, 3.0)), ("arc", (3.0, 1.0)),
    ("semi-ellipse", (1.0, 2.0)), ("triangle", (0.0, 1.0, 3.0)),
]  # fmt: skip


def test_the_page_is_asked_for_every_shape():
    fuzzy = {name for name, kind in kinds.SHAPES.items() if kind.fuzzy and not kind.own}
    assert fuzzy == {kind for kind, _ in SHAPES + CURVES}


WIDTHS_AND_MIRRORS = """
import { WIDTHS, mirrorOf } from "./geometry/shapes.js";
import { readFileSync } from "fs";
console.log(JSON.stringify(JSON.parse(readFileSync(0)).map(([kind, p]) => [
  mirrorOf(kind, p, 10),
  Object.entries(WIDTHS[kind] ?? {}).map(([i, { at, to }]) => [p[i], to(p, at(p)), at(p)]),
])));
"""


@requires("node")
def test_widths_lead_to_handles_and_back_and_mirrors_are_mirrors(tmp_path):
    shutil.copytree(PAGE / "geometry", tmp_path / "geometry")
    (tmp_path / "package.json").write_text('{"type": "module"}')
    (tmp_path / "run.js").write_text(WIDTHS_AND_MIRRORS)
    done = subprocess.run(
        ["node", str(tmp_path / "run.js")], input=json.dumps(CURVES), capture_output=True,
        text=True, check=True, timeout=60,
    )  # fmt: skip
    for (kind, numbers), (mirrored, widths) in zip(CURVES, json.loads(done.stdout), strict=True):
        other = {"s": "z", "z": "s"}.get(kind, kind)
        one = membership_function(Shape(kind, numbers))
        image = membership_function(Shape(other, tuple(mirrored)))
        for x in (-1.0, 0.3, 1.25, 1.8, 2.6, 3.9):
            assert one(x) == pytest.approx(image(10.0 - x), abs=1e-12), kind
        for number, back, position in widths:
            assert back == pytest.approx(number), kind
            assert -1.0 < position < 5.0


# --- the file on disk ---


@pytest.fixture
def shared(tmp_path):
    (tmp_path / "pd7.frb").write_bytes(PD7.replace("\n", "\r\n").encode())
    return SharedText(tmp_path / "pd7.frb")


def test_what_is_late_is_not_taken(shared):
    first = difference(shared.text, "# a\n" + shared.text)
    assert shared.push(0, [{"clientID": "one", "changes": first}])
    assert not shared.push(0, [{"clientID": "other", "changes": first}])
    assert [each["clientID"] for each in shared.since(0)] == ["one"]
    assert shared.since(2) is None


def test_saving_keeps_line_ends_and_heeds_other_writers(shared):
    shared.replace("# mine\n" + shared.text, "me")
    shared.save()
    assert shared.path.read_bytes().startswith(b"# mine\r\n# Joint")
    shared.replace(shared.text.replace("# mine", "# changed"), "me")
    shared.path.write_text("# theirs\n")
    with pytest.raises(ConflictError):
        shared.save()
    assert shared.path.read_text() == "# theirs\n"
    shared.settle("mine")
    shared.save()
    assert shared.path.read_bytes().startswith(b"# changed\r\n")


def test_who_writes_right_after_a_save_is_seen(shared, monkeypatch):
    replace = os.replace

    def overtaken(name, target):
        replace(name, target)
        target.write_bytes(b"# theirs\n")

    shared.replace("# mine\n" + shared.text, "me")
    with monkeypatch.context() as patched:
        patched.setattr(os, "replace", overtaken)
        shared.save()
    assert shared.look()
    assert shared.text == "# theirs\n"


def test_a_file_that_is_no_text_any_more_is_not_written_over(shared):
    shared.replace("# mine\n" + shared.text, "me")
    theirs = b"# caf\xe9\n"
    shared.path.write_bytes(theirs)
    assert shared.look()
    assert not shared.look()  # said once
    assert shared.status["unreadable"] == "line 1: not UTF-8: byte 0xe9"
    with pytest.raises(ConflictError, match="0xe9"):
        shared.save()
    shared.settle("theirs")  # nothing can be taken
    assert shared.path.read_bytes() == theirs
    shared.settle("mine")
    assert shared.path.read_bytes().startswith(b"# mine\r\n")
    assert not shared.status["dirty"]
    assert not shared.status["conflict"]


def test_a_file_that_is_gone_is_said_and_written_anew(shared):
    text = shared.text
    shared.path.unlink()
    assert shared.look()
    assert not shared.look()
    assert shared.status["gone"]
    assert shared.status["dirty"]
    shared.path.write_text(text + "# theirs\n")  # somebody saves by removing and writing
    assert shared.look()
    assert not shared.status["dirty"]
    assert shared.text == text + "# theirs\n"
    shared.path.unlink()
    shared.save()
    assert shared.path.read_text() == shared.text
    assert not shared.status["gone"]


def test_a_link_out_of_the_folder_is_neither_read_nor_written(shared, tmp_path_factory):
    outside = tmp_path_factory.mktemp("elsewhere") / "outside.frb"
    outside.write_text("# secret\n")
    shared.path.unlink()
    shared.path.symlink_to(outside)
    assert shared.look()
    assert "secret" not in shared.text
    for act in (shared.save, lambda: shared.settle("mine")):
        with pytest.raises(ValueError, match="links to a file outside the folder"):
            act()
    assert outside.read_text() == "# secret\n"


def test_a_byte_order_mark_stays_and_half_a_character_is_not_saved(tmp_path):
    path = tmp_path / "x.frb"
    path.write_bytes(b"\xef\xbb\xbf# a\n")
    shared = SharedText(path)
    assert shared.text == "# a\n"
    shared.replace("# b\n", "me")
    shared.save()
    assert path.read_bytes() == b"\xef\xbb\xbf# b\n"
    shared.push(shared.version, [{"clientID": "me", "changes": [4, [0, "\ud800"]]}])
    with pytest.raises(ChangeError, match="line 2 has half of a character"):
        shared.save()


def test_after_a_restart_the_window_that_wrote_wins(shared):
    disk = shared.text
    shared.remember("# earlier\n" + disk, disk)  # of a window that only read
    assert shared.text == "# earlier\n" + disk
    shared.resume("# later\n" + disk, [disk])
    assert shared.text == "# later\n" + disk
    assert not shared.status["conflict"]
    shared.remember("# earlier\n" + disk, disk)
    assert shared.text == "# later\n" + disk


def test_after_a_restart_a_window_with_nothing_of_its_own_takes_the_file(shared):
    disk = shared.text
    shared.remember("# earlier\n" + disk, disk)  # which the other one has undone
    shared.resume(disk, [disk])
    assert shared.text == disk
    shared.resume("# of before\n", ["# of before\n"])
    assert shared.text == disk


def test_a_save_that_was_not_answered_is_its_own_and_that_of_another_program_is_not(shared):
    disk = shared.text
    shared.resume("# typed on\n" + disk, ["# of before\n", disk])
    assert not shared.status["conflict"]
    assert shared.text == "# typed on\n" + disk
    other = SharedText(shared.path)
    other.resume("# typed on\n" + disk, ["# of before\n", "# asked\n"])
    assert other.status["conflict"]
    assert other.text == "# typed on\n" + disk
    other.settle("theirs")
    assert other.text == disk


def test_after_a_restart_windows_that_have_both_typed_are_asked_and_the_file_stays(shared):
    disk = shared.text
    shared.push(0, [{"clientID": "b", "changes": [[0, "# one", ""], len(disk)]}])
    shared.is_typed = True
    one = shared.text
    shared.resume("# two\n" + disk, [disk])
    assert shared.status["elsewhere"]
    shared.settle("theirs")
    assert shared.text == one
    assert shared.saved == disk  # and not what the other window has had
    assert shared.status["dirty"]


def told(client_socket, kind):
    while (found := json.loads(client_socket.receive_text()))["is"] != kind:
        pass
    return found


def test_the_window_that_wrote_writes_again_in_whatever_order_they_come_back(client):
    again = {"do": "open", "file": "pd7.frb", "epoch": "before", "version": 9, "saved": PD7}
    reader = {**again, "text": "# half\n" + PD7}
    writer = {**again, "text": "# half\n# typed\n" + PD7, "wrote": True}
    for order in ((reader, writer), (writer, reader)):
        with socket_of(client) as one, socket_of(client) as two:
            for socket, message in zip((one, two), order, strict=True):
                socket.send_text(json.dumps(message))
                opened = told(socket, "opened")
                assert opened["writes"] == (message is writer or message is order[0])
            if order[0] is reader:
                assert not told(one, "writer")["writes"]


def test_a_long_text_is_merged_at_once():
    base = "".join(f"row {k % 7}\n" for k in range(20_000))  # comparing all with all takes minutes
    mine, theirs = f"# mine\n{base}", f"{base}# theirs\n"
    assert merged(base, mine, theirs) == f"# mine\n{base}# theirs\n"


def test_of_many_findings_the_first_are_told_with_their_number(tmp_path):
    path = tmp_path / "many.frb"
    begin = "rulebase many\ninput x 0 .. 1\noutput y 0 .. 1\nterms x, y: triangles A B\n"
    path.write_text(begin + "rule if x is A then y is Z\n" * 403)
    shared = SharedText(path)
    told = shared.findings(shared.session)
    assert len(told["findings"]) == 200
    assert told["findings"][0]["range"][0][0] == 4
    assert told["more"] == 203


def test_a_question_that_is_not_understood_is_answered(shared):
    for asked in ({}, {"what": "hover"}, {"what": "shapes", "shapes": [{}]}, {"what": "cell"},
                  {"what": "cell", "cell": [1, 1], "term": "<b>"}, {"what": "complete", "at": "x"},
                  {"what": "hover", "at": [math.inf, 0]},
                  {"what": "shapes", "shapes": [{"kind": "none", "parameters": []}]}):  # fmt: skip
        assert "error" in shared.answer(asked), asked


# --- the server ---


def socket_of(client, path=f"/{TOKEN}/socket", origin="http://127.0.0.1:8000"):
    return client.websocket_connect(
        f"ws://127.0.0.1:8000{path}", headers={"origin": origin} if origin else {}
    )


def test_only_who_knows_the_token_is_let_in(client):
    from starlette.websockets import WebSocketDisconnect

    page = client.get(f"/{TOKEN}/")
    assert page.status_code == 200
    assert "default-src 'none'" in page.headers["content-security-policy"]
    assert "unsafe" not in page.headers["content-security-policy"]
    for path in ("/", "/page/app.js", f"/{TOKEN[:-1]}/", f"/{TOKEN}x/", "//", f"/x/{TOKEN}/"):
        assert client.get(path).status_code == 403, path
    for headers in ({"host": "evil.example"}, {"origin": "http://evil.example"},
                    {"host": "127.0.0.1.evil.example"}, {"host": ""},
                    {"host": "[::1"}):  # fmt: skip
        assert client.get(f"/{TOKEN}/", headers=headers).status_code == 403, headers
    assert client.post(f"/{TOKEN}/").status_code == 403
    for path, origin in (("/socket", "http://127.0.0.1:8000"), (f"/{TOKEN}/socket", None),
                         (f"/{TOKEN}/socket", "http://evil.example"),
                         (f"/{TOKEN}/socket", "null")):  # fmt: skip
        with pytest.raises(WebSocketDisconnect), socket_of(client, path, origin):
            pass


def test_only_files_of_the_page_are_served(client):
    for name in ("index.html", "../server.py", "..%2fserver.py", "%2e%2e/assets.py", "vendor", ""):
        assert client.get(f"/{TOKEN}/page/{name}").status_code in {403, 404}, name
    for name in ("app.js", "engine.js", "vendor/codemirror.js", "style.css"):
        assert client.get(f"/{TOKEN}/page/{name}").status_code == 200, name


def test_only_files_of_the_folder_are_opened(client, tmp_path):
    with socket_of(client) as socket:
        for name in ("../outside.frb", str(tmp_path / "outside.frb"), "link.frb", "x\0.frb", ""):
            socket.send_text(json.dumps({"do": "open", "file": name}))
            assert json.loads(socket.receive_text())["is"] == "failed", name
        socket.send_bytes(b"x")
        assert json.loads(socket.receive_text())["is"] == "failed"
        for message in ("", "[]", "{}", '{"do": "push"}', '{"do": 3, "file": 1}', "[" * 9999,
                        '{"do": "stop", "id": Infinity}'):  # fmt: skip
            socket.send_text(message)
            assert json.loads(socket.receive_text())["is"] == "failed", message[:40]
        socket.send_text(json.dumps({"do": "open", "file": "pd7.frb"}))
        assert json.loads(socket.receive_text())["text"] == PD7


def test_what_the_system_says_has_no_path(client, tmp_path):
    (tmp_path / "inside" / "latin.frb").write_bytes(b"# caf\xe9\n")
    with socket_of(client) as socket:
        socket.send_text(json.dumps({"do": "open", "file": "latin.frb"}))
        said = json.loads(socket.receive_text())["message"]
        assert said == "'latin.frb' is not opened: line 1: not UTF-8: byte 0xe9"
        socket.send_text(json.dumps({"do": "open", "file": "pd7.frb"}))
        assert json.loads(socket.receive_text())["is"] == "opened"
        shutil.rmtree(tmp_path / "inside")
        socket.send_text(json.dumps({"do": "save", "file": "pd7.frb"}))
        while (told := json.loads(socket.receive_text()))["is"] != "failed":
            pass
        assert told["message"] == "not saved: pd7.frb: No such file or directory"


def test_a_window_whose_file_has_gone_with_the_server_keeps_its_text(client, tmp_path):
    known = {
        "do": "open",
        "epoch": "another",
        "version": 3,
        "saved": PD7,
        "text": "# typed\n" + PD7,
    }
    with socket_of(client) as socket:
        for name in ("link.frb", "../outside.frb", "x.txt", "pd7.frb/x.frb"):
            socket.send_text(json.dumps({**known, "file": name}))
            assert json.loads(socket.receive_text())["is"] == "failed", name
        socket.send_text(json.dumps({**known, "file": "gone.frb"}))
        opened, status = (json.loads(socket.receive_text()) for _ in range(2))
        assert opened["text"] == known["text"]
        assert status["gone"]
        socket.send_text(json.dumps({"do": "save", "file": "gone.frb"}))
        while not (told := json.loads(socket.receive_text())).get("saved"):
            pass
    assert (tmp_path / "inside" / "gone.frb").read_text() == known["text"]
    assert not told["gone"]


def test_a_text_is_checked_and_drawn(client):
    with socket_of(client) as socket:
        socket.send_text(json.dumps({"do": "open", "file": "pd7.frb"}))
        heard = [json.loads(socket.receive_text()) for _ in range(4)]
        assert [each["is"] for each in heard] == ["opened", "status", "findings", "scene"]
        assert len(heard[3]["scene"]["rules"]) == 49
        change = difference(PD7, PD7.replace("terms", "tern"))
        push = {"do": "push", "file": "pd7.frb", "version": 0}
        push["updates"] = [{"clientID": "x", "changes": change}]
        socket.send_text(json.dumps(push))
        heard = [json.loads(socket.receive_text()) for _ in range(4)]
        assert heard[0]["updates"][0]["changes"] == change
        assert heard[2]["findings"][0]["severity"] == "error"
        assert heard[3]["scene"] is None


@dataclass(frozen=True)
class Count:
    from_: int
    bad: bool = False


def count(session, asked, job):
    """Work that tells numbers until it hears enough."""
    if asked.bad:
        raise ConflictError("a sentence")
    for number in range(asked.from_, 10**6):
        job.tell({"n": number, "length": len(session.text)})
        if any(said.enough for said in job.heard(requests.TuneWord)):
            return


@pytest.fixture
def work(monkeypatch):
    """Put work beside that of the server."""

    def put(name, record, act):
        monkeypatch.setitem(open_files.WORKS, name, act)
        monkeypatch.setitem(requests.WORKS, name, record)

    return put


def test_long_work_tells_hears_and_is_stopped(client, work):
    work("count", Count, count)

    def end(socket, number):
        while "end" not in (news := json.loads(socket.receive_text())) or news["id"] != number:
            pass
        return news

    with socket_of(client) as socket:
        for message in (
            {"do": "open", "file": "pd7.frb"},
            {"do": "say", "id": 99, "enough": True},  # of work that does not run
            {"do": "start", "file": "pd7.frb", "what": "count", "id": 1, "from": 3},
            {"do": "start", "file": "pd7.frb", "what": "count", "id": 2, "from": 5},
        ):
            socket.send_text(json.dumps(message))
        heard = []
        while len({each["id"] for each in heard}) < 2:
            news = json.loads(socket.receive_text())
            heard += [news] if news["is"] == "job" else []
        assert {each["n"] - 3 for each in heard if each["id"] == 1} >= {0}
        assert heard[0]["length"] == len(PD7)
        socket.send_text(json.dumps({"do": "say", "id": 1, "enough": True}))
        assert end(socket, 1)["end"] == "done"
        socket.send_text(json.dumps({"do": "stop", "id": 2}))
        assert end(socket, 2)["end"] == "stopped"
        start = {"do": "start", "file": "pd7.frb", "what": "count"}
        socket.send_text(json.dumps({**start, "id": 3, "from": 1, "bad": True}))
        assert end(socket, 3)["message"] == "a sentence"
        socket.send_text(json.dumps({**start, "id": 4}))
        assert end(socket, 4)["message"] == "a message is not understood: from is missing"
        socket.send_text(json.dumps({"do": "start", "file": "pd7.frb", "what": "none", "id": 5}))
        kinds = iter(lambda: json.loads(socket.receive_text())["is"], "failed")
        assert set(kinds) <= {"findings", "scene", "unsaved"}  # and then it is said


@pytest.mark.slow
def test_a_window_has_a_bounded_number_of_works_and_is_answered_meanwhile(client, work):
    def wait(session, asked, job):
        job.tell({"begun": True})
        job.word(requests.TuneWord)

    work("wait", requests.BareMessage, wait)
    start = {"do": "start", "file": "pd7.frb", "what": "wait"}
    with socket_of(client) as socket:
        socket.send_text(json.dumps({"do": "open", "file": "pd7.frb"}))
        for number in range(400):
            socket.send_text(json.dumps({**start, "id": number + 1}))
        socket.send_text(json.dumps({"do": "ask", "what": "exports", "file": "pd7.frb", "id": 999}))
        refused, news = {}, {}
        while (news := json.loads(socket.receive_text())).get("id") != 999:
            if news.get("end"):
                refused[news["id"]] = news["message"]
        assert len(refused) == 400 - open_files.MOST_JOBS
        assert "32 works of this window are going on" in refused[400]
        socket.send_text(json.dumps({"do": "stop", "id": 1}))
        while json.loads(socket.receive_text()).get("end") != "stopped":
            pass
        socket.send_text(json.dumps({**start, "id": 500}))
        while (news := json.loads(socket.receive_text())).get("id") != 500:
            pass
        assert news["begun"]


@pytest.mark.faults
def test_work_that_leaves_python_ends_for_the_page_too(client, work, caplog):
    def leave(session, asked, job):
        raise SystemExit(3)

    work("leave", requests.BareMessage, leave)
    with socket_of(client) as socket:
        socket.send_text(json.dumps({"do": "open", "file": "pd7.frb"}))
        start = {"do": "start", "file": "pd7.frb", "what": "leave", "id": 1}
        socket.send_text(json.dumps(start))
        while "end" not in (news := json.loads(socket.receive_text())):
            pass
        assert (news["end"], news["internal"]) == ("failed", True)
        assert "internal error: SystemExit(3)" in news["message"]
    (entry,) = caplog.records
    assert (entry.getMessage(), entry.exc_info[0]) == (
        "internal error: the work 'leave'",
        SystemExit,
    )


def hear(socket, kind):
    while (news := json.loads(socket.receive_text()))["is"] != kind:
        pass
    return news


def typed(version, words, length):
    update = {"clientID": "x", "changes": [[0, *words.split("\n")], length]}
    return json.dumps({"do": "push", "file": "pd7.frb", "version": version, "updates": [update]})


def test_windows_hear_what_is_unsaved_and_a_save_is_answered(client, tmp_path):
    path = tmp_path / "inside" / "pd7.frb"
    with socket_of(client) as socket, socket_of(client) as other:
        for each in (socket, other):
            each.send_text(json.dumps({"do": "hello"}))
            assert hear(each, "names")["names"] == ["pd7.frb"]
            assert hear(each, "unsaved")["names"] == []
        socket.send_text(json.dumps({"do": "open", "file": "pd7.frb"}))
        socket.send_text(typed(0, "# mine\n", len(PD7)))
        assert hear(other, "unsaved")["names"] == ["pd7.frb"]
        other.send_text(json.dumps({"do": "save", "file": "pd7.frb", "id": 7}))
        assert "error" not in hear(other, "answer")
        assert hear(socket, "unsaved")["names"] == ["pd7.frb"]
        assert hear(socket, "unsaved")["names"] == []
        assert path.read_text() == "# mine\n" + PD7
        socket.send_text(typed(1, "# typed ", 7 + len(PD7)))
        hear(socket, "unsaved")
        path.write_text("# theirs\n" + PD7)
        other.send_text(json.dumps({"do": "save", "file": "pd7.frb", "id": 8}))
        reason = "pd7.frb is not saved: the file has changed on disk"
        assert hear(other, "answer")["error"] == reason
        other.send_text(json.dumps({"do": "save", "file": "none.frb", "id": 9}))
        assert "not a file of this folder" in hear(other, "answer")["error"]
    assert path.read_text() == "# theirs\n" + PD7


def test_what_is_not_saved_is_named_at_the_end(tmp_path):
    from starlette.testclient import TestClient

    from fuzzyarm.apps.designer.server import Designer, Workspace

    (tmp_path / "pd7.frb").write_text(PD7)
    told = []
    app = Designer(Workspace(tmp_path), TOKEN, farewell=told.append).app()
    with TestClient(app, base_url="http://127.0.0.1:8000") as found, socket_of(found) as socket:
        socket.send_text(json.dumps({"do": "open", "file": "pd7.frb"}))
        socket.send_text(typed(0, "# mine\n", len(PD7)))
        hear(socket, "updates")
        socket.send_text(json.dumps({"do": "close", "file": "pd7.frb"}))
    assert told == [["pd7.frb"]]


def test_a_rename_during_a_check_loses_no_findings(client, monkeypatch):
    begun, may_end, look = threading.Event(), threading.Event(), SharedText.findings

    def slowly(self, session):
        begun.set()
        assert may_end.wait(60)
        return look(self, session)

    with socket_of(client) as socket:
        socket.send_text(json.dumps({"do": "open", "file": "pd7.frb"}))
        hear(socket, "scene")
        monkeypatch.setattr(SharedText, "findings", slowly)
        socket.send_text(typed(0, "# mine\n", len(PD7)))
        assert begun.wait(60)
        rename = {"do": "folder", "id": 1, "what": "rename", "file": "pd7.frb", "name": "b.frb"}
        socket.send_text(json.dumps(rename))
        assert hear(socket, "moved")["to"] == "b.frb"
        hear(socket, "answer")
        may_end.set()
        socket.send_text(json.dumps({"do": "hello"}))
        for kind in ("findings", "scene"):
            news = hear(socket, kind)
            assert (news["file"], news["version"]) == ("b.frb", 1)


@pytest.mark.slow
@pytest.mark.faults
def test_what_may_not_be_looked_at_is_left_out_and_the_watch_goes_on(client, tmp_path, monkeypatch):
    from fuzzyarm.apps.designer.folder import Workspace

    is_file, files = Path.is_file, Workspace.files
    (tmp_path / "inside" / "closed.frb").write_text(PD7)

    def guarded(self):
        if self.name == "closed.frb":
            raise PermissionError(13, "Permission denied", str(self))
        return is_file(self)

    monkeypatch.setattr(Path, "is_file", guarded)
    page = client.get(f"/{TOKEN}/")
    assert (page.status_code, "closed.frb" in page.text) == (200, False)
    failures = []

    def failing(self):
        if len(failures) < 2:
            failures.append(1)
            raise RuntimeError
        return files(self)

    monkeypatch.setattr(Workspace, "files", failing)
    with socket_of(client) as socket:
        (tmp_path / "inside" / "new.frb").write_text(PD7)  # the first looks at it fail
        assert "new.frb" in hear(socket, "names")["names"]


def test_a_surface_is_computed_beside_and_its_question_is_not_trusted(client, tmp_path):
    text = PD7.replace("centroid exact", "mean-of-maximum")
    corner = read(text).model.rules[-1].span
    text = apply_edits(text, set_cell(read(text), corner.line, corner.column, None))
    (tmp_path / "inside" / "maxima.frb").write_text(text)
    asked = {"x": 0, "y": 1, "output": 0, "point": [1.5, -2.0], "across": 3, "fired": True,
             "ends": [[-6, 6], [-6, 6]]}  # fmt: skip
    with socket_of(client) as socket:
        socket.send_text(json.dumps({"do": "open", "file": "maxima.frb"}))

        def news(**changed):
            start = {"do": "start", "file": "maxima.frb", "what": "surface", "id": 7}
            start |= {**asked, **changed}
            socket.send_text(json.dumps(start))
            heard = []
            while not heard or "end" not in heard[-1]:
                message = json.loads(socket.receive_text())
                heard += [message] if message["is"] == "job" else []
            return heard

        model = read(text).model
        fired, surface, end = news()
        assert len(fired["strengths"]) == len(model.rules)
        assert fired["outputs"] == [infer(model, e=1.5, ce=-2.0)["u"]]
        assert end["end"] == "done"
        assert surface["z"][0] == infer(model, e=-6, ce=-6)["u"]
        assert surface["z"][8] is None  # no rule fires there
        for wrong in ({"x": 9}, {"point": [1]}, {"point": None}, {"ends": [[0, 0], [1, 0]]},
                      {"across": "x"}, {"output": 4}, {"ends": [[0, "inf"], [0, 1]]}):  # fmt: skip
            assert news(**wrong)[-1]["end"] == "failed", wrong


# --- the page ---


def test_no_word_of_the_page_stands_twice():
    text = asset("strings.js")[0].decode()
    names = [line.split(":")[0] for line in text.splitlines() if line.startswith("  ")]
    names = [name.strip() for name in names if name[2:3].isalpha()]
    assert len(names) == len(set(names)), sorted(n for n in names if names.count(n) > 1)
    assert len(names) > 60


def test_every_word_that_the_page_says_is_there_and_said():
    names = set(re.findall(r"^  (\w+):", asset("strings.js")[0].decode(), re.MULTILINE))
    own = (*PAGE.glob("*.js"), *PAGE.glob("playground/*.js"))
    modules = [path.read_text("utf-8") for path in own]
    said = {name for text in modules for name in re.findall(r"\bS\.(\w+)", text)}
    assert said == names


def test_a_folder_has_a_port_of_its_own_where_that_is_free(monkeypatch):
    from fuzzyarm.apps.designer import server

    # No rights are needed for them, and Linux gives none of them to a connection.
    assert server.OWN_PORTS.start > 1023
    assert server.OWN_PORTS.stop <= 32768
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        own = found.getsockname()[1]
    monkeypatch.setattr(server, "OWN_PORTS", range(own, own + 1))
    with socket.socket() as one, socket.socket() as two, socket.socket() as three:
        server._bound(one, None, TOKEN)
        server._bound(two, None, TOKEN)
        assert one.getsockname()[1] == own != two.getsockname()[1]
        with pytest.raises(server.ServerPortError, match=f"port {own} cannot be used"):
            server._bound(three, own, TOKEN)


def test_the_page_asks_at_once_for_every_module_that_it_imports():
    page = index_page({"files": []}, "nonce")
    assert "PRELOADS" not in page
    wanted = {path.name for path in (PAGE / "geometry").glob("*.js")} | {"app.js", "task.js"}
    assert wanted <= {name.rpartition("/")[2] for name in modules()}
    assert all(f'href="page/{name}"' in page for name in modules())
    assert all(asset(name) for name in modules())
