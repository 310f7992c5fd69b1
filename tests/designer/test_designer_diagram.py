"""The block diagram of a controller in the designer: blocks lead to lines, rules to their file."""

import json
import shutil

import pytest
from needs import requires
from test_designer_page import put, text_of, until

from fuzzyarm.apps.designer.diagram import PEN, diagram_of, sheets
from fuzzyarm.apps.designer.folder import Workspace
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.base.shipped_files import shipped, shipped_folder, shipped_names
from fuzzyarm.control.controllers.text import with_files
from fuzzyarm.language.edit import read

BOTH = """\
controller both "rules and a controller in one file"
period 1 ms
gain G = 2
axis shaft
  e = error of position * G
  u = rules own(e)
  drive voltage = u, within -24 .. 24

rulebase own "proportional"
input e -1 .. 1
output u -24 .. 24
terms e, u: triangles N Z P
rules u
  e  N  Z  P
  u  N  Z  P
"""


def controllers():
    for name in shipped_names():
        if name.endswith(".frb") and read(shipped(name).read_text()).parsed.controller is not None:
            yield name


@pytest.mark.parametrize("name", list(controllers()))
def test_every_shipped_controller_is_drawn_within_its_picture(name):
    text = shipped(name).read_text()
    reading = read(text, str(shipped(name)))
    controller, faults = with_files(reading.parsed.controller, shipped_folder(), name)
    assert faults == []
    found = json.loads(json.dumps(diagram_of(controller, reading)))
    lines = text.splitlines()
    for block in found["blocks"]:
        assert 0 <= block["x"] <= block["x"] + block["width"] <= found["width"] + 1
        assert 0 <= block["y"] <= block["y"] + block["height"] <= found["height"] + 1
        widths = [PEN.width_of(*line) for line in block["lines"]]
        assert max(widths, default=0) <= block["width"]
        if block["kind"] in ("rules", "table") and block["at"]:
            assert block["kind"] in lines[block["at"][0]]
    drives = [each for each in found["blocks"] if each["kind"] == "drive"]
    assert len(drives) == len({line.split("=")[0] for line in lines if line.startswith("  drive")})


class Heard:
    """What hears long work."""

    def __init__(self):
        self.told = []

    def tell(self, news):
        self.told.append(news)

    def check(self):
        pass


def test_what_is_looked_up_is_told_with_its_values(tmp_path):
    for name in ("stfc.frb", "pd7-study.frb", "alpha7-study.frb"):
        shutil.copy(shipped(name), tmp_path)
    job = Heard()
    path = tmp_path / "stfc.frb"
    sheets(Session(str(path), path.read_text()), {}, job)
    (news,) = job.told
    assert [(each["name"], each["file"]) for each in news["sheets"]] == [
        ("pd7", "pd7-study.frb"), ("alpha7", "alpha7-study.frb"),
    ]  # fmt: skip
    first = news["sheets"][0]
    assert (first["kind"], first["count"], first["x"], first["y"]) == ("rules", 49, "ce", "e")
    cells = first["panel"]["parts"][0]
    assert len(cells["values"]) == len(cells["x"]) * len(cells["y"])
    assert cells["values"][0] == pytest.approx(-cells["values"][-1])


def test_a_shipped_rule_base_can_be_copied_beside_its_controller(tmp_path):
    path = tmp_path / "servo.frb"
    path.write_text(shipped("servo.frb").read_text())
    job = Heard()
    sheets(Session(str(path), path.read_text()), {}, job)
    assert job.told[0]["sheets"][0]["shipped"]
    answer = Workspace(tmp_path).answer({"what": "adopt", "file": "pd7.frb"})
    assert answer["open"] == "pd7.frb"
    assert (tmp_path / "pd7.frb").read_bytes() == shipped("pd7.frb").read_bytes()
    sheets(Session(str(path), path.read_text()), {}, job)
    assert not job.told[1]["sheets"][0]["shipped"]
    for name in ("../pd7.frb", "none.frb", "pd7.frb"):
        assert "error" in Workspace(tmp_path).answer({"what": "adopt", "file": name})


slow = pytest.mark.slow
needs_browser = requires("chromium")


@slow
@needs_browser
def test_a_controller_is_drawn_and_its_blocks_lead_to_their_lines(served, page):
    put(served, "pd7.frb")
    text = shipped("servo.frb").read_text()
    page.goto(put(served, "servo.frb", text)[1])
    block = page.locator(".diagram .block.gain", has_text="G_ce")
    block.click()
    line = page.evaluate(
        "designer.text.view.state.doc.lineAt(designer.text.view.state.selection.main.head).text"
    )
    assert line == "  ce = error of velocity * G_ce"
    block.focus()
    page.keyboard.press("Enter")
    until(lambda: page.locator(".diagram .sheet").count() == 1, "what it looks up")
    page.evaluate("designer.text.goTo([8, 12])")  # another number of a gain is in the picture
    page.keyboard.press("Delete")
    page.keyboard.press("Delete")
    page.keyboard.type("99")
    until(lambda: page.locator(".diagram .block", has_text="99 1/rad").count() == 1, "drawn")
    page.evaluate("designer.text.goTo([15, 0])")
    page.keyboard.insert_text("nonsense ")  # one step
    until(lambda: page.locator(".area.stale").count() == 1, "the last sound one, pale")
    assert page.locator(".diagram .block", has_text="99 1/rad").is_visible()
    page.keyboard.press("Control+z")
    until(lambda: page.locator(".area.stale").count() == 0, "sound again")
    page.get_by_role("button", name="Open pd7.frb").click()
    until(lambda: page.title().startswith("pd7.frb"), "its rule base")
    page.locator(".terms").wait_for()  # when the server has read it


@slow
@needs_browser
def test_a_file_with_both_has_both_pictures(served, page):
    page.goto(put(served, "both.frb", BOTH)[1])
    page.locator(".diagram .block.rules").wait_for()
    assert not page.locator(".terms").is_visible()
    page.get_by_role("button", name="Rule base", exact=True).click()
    page.locator(".terms").wait_for()
    until(lambda: page.locator(".rules td select").count() == 3, "the grid")
    page.get_by_role("button", name="Block diagram").click()
    page.locator(".diagram .block.rules").wait_for()
    assert text_of(page) == BOTH
