"""The designer's page while the server is slow: what a view shows and offers before it is told."""

import json
import shutil

import pytest
from test_designer_page import further, put, pytestmark, until  # noqa: F401

from fuzzyarm.base.shipped_files import shipped

FORMS = {"Sweep": "Start", "Learn": "Start", "Fit": "Fit", "Tune": "Start", "Prove": "Prove"}
"""Views with a form, and what their button says."""


class SlowServer:
    """What a page hears while `holds` is true waits until `release`."""

    def __init__(self, page, folder):
        self.page, self.folder = page, folder
        self.held, self.holds, self.socket = [], False, None
        page.route_web_socket("**/socket", self.connect)

    def connect(self, socket):
        self.socket = socket
        socket.connect_to_server().on_message(self.hear)

    def hear(self, text):
        if self.holds:
            self.held.append(text)
        else:
            self.socket.send(text)

    def release(self):
        self.holds = False
        for text in self.held:
            self.socket.send(text)
        self.held.clear()

    def wait(self, words):
        """Wait until something with these words is held back."""
        until(lambda: self.page.wait_for_timeout(20) or self.has(words), words)

    def has(self, words):
        return any(words in text for text in self.held)


@pytest.fixture
def slow(served, page):
    for name in ("servo.frb", "pd7.frb"):
        shutil.copy(shipped(name), served.folder)
    server = SlowServer(page, served.folder)
    _, address = put(served, "late.frb", shipped("servo.frb").read_text())
    page.goto(address)
    page.locator(".findings").get_by_text("no findings").wait_for()
    return server


def button(page, view):
    return page.locator(f"#view-{view.lower()}").get_by_role("button", name=FORMS[view], exact=True)


def test_nothing_is_begun_before_it_is_known_what_may_be_asked(page, slow):
    slow.holds = True
    for view in FORMS:
        further(page, view)
        assert button(page, view).is_disabled(), view
        assert page.locator(f"#view-{view.lower()}").get_by_text("working …").is_visible(), view
        for name in ("One pass", "Stop"):
            others = page.locator(f"#view-{view.lower()}").get_by_role("button", name=name)
            assert all(other.is_disabled() for other in others.all()), (view, name)
    assert page.get_by_label("Certificate").is_hidden()
    for facts in ('"gains"', '"texts"', '"says"', '"outputs"'):
        slow.wait(facts)
    assert button(page, "Prove").is_disabled()
    slow.release()
    for view in ("Sweep", "Learn", "Tune", "Prove"):
        further(page, view)
        until(button(page, view).is_enabled, view)
    assert page.get_by_label("Certificate").is_visible()


def test_what_was_asked_for_when_the_line_went_is_asked_again(page, slow):
    slow.holds = True
    further(page, "Sweep")
    slow.wait('"gains"')
    page.evaluate("designer.drop()")
    sweep = page.locator("#view-sweep")
    sweep.get_by_text("The server does not answer").wait_for()
    slow.held.clear()
    slow.holds = False
    until(button(page, "Sweep").is_enabled, "it is asked again")
    further(page, "Compare")
    compare = page.locator("#view-compare")
    compare.get_by_text("Choose the file").wait_for()


def test_a_new_file_is_made_when_the_folder_is_known(page, slow):
    slow.holds = True
    page.get_by_role("tab", name="Files").click()
    make = page.get_by_role("button", name="New file")
    slow.wait('"starts"')
    assert make.is_disabled()
    slow.release()
    make.click()
    kinds = page.locator("dialog select[name=kind] option")
    assert kinds.evaluate_all("all => all.map(each => each.value)")[:2] == ["blank", "pd"]


def test_of_two_comparisons_the_last_is_shown(page, slow):
    shutil.copy(shipped("roompi.frb"), slow.folder)
    shutil.copy(slow.folder / "pd7.frb", slow.folder / "same.frb")
    page.locator("header select").select_option("pd7.frb")
    further(page, "Compare")
    compare = page.locator("#view-compare")
    other = compare.get_by_label("with")
    until(lambda: other.locator("option[value='same.frb']").count(), "the files")
    slow.holds = True
    other.select_option("roompi.frb")
    slow.wait('"job"')
    other.select_option("same.frb")
    slow.wait('"largest"')
    slow.wait('"end"')
    slow.held.sort(key=lambda text: -json.loads(text).get("id", 0))  # the first speaks last
    slow.release()
    compare.get_by_text("Both mean the same.").wait_for()
    # What was held may have been all of the first and half of the second: the rest comes now.
    status = compare.get_by_role("status")
    until(lambda: status.inner_text().startswith("Largest difference here: 0 at"), "the second")


def test_an_import_that_comes_late_turns_nobody_away(page, slow, tmp_path):
    page.get_by_role("tab", name="Files").click()
    files = page.locator("#view-files")
    files.get_by_role("button", name="pd7.frb", exact=True).wait_for()
    dropped = tmp_path / "brought.frb"
    shutil.copy(shipped("roompi.frb"), dropped)
    slow.holds = True
    files.locator("input[type=file]").set_input_files(dropped)
    slow.wait('"brought.frb"')
    page.locator("header select").select_option("pd7.frb")
    slow.release()
    until(lambda: page.locator("header select option[value='brought.frb']").count(), "it is there")
    page.locator(".findings").get_by_text("no findings").wait_for()
    assert page.locator("header select").input_value() == "pd7.frb"


def test_others_are_swept_beside_the_open_controller(page, slow):
    further(page, "Sweep")
    until(button(page, "Sweep").is_enabled, "what may be swept is known")
    sweep = page.locator("#view-sweep")
    sweep.get_by_label("Against", exact=True).fill("servo.frb")
    sweep.get_by_role("combobox", name="Ranges").fill("J=0.01..0.05:3")
    sweep.get_by_label("Duration", exact=True).fill("0.2s")
    button(page, "Sweep").click()
    sweep.get_by_text("Done.").wait_for()
    sweep.get_by_text("servo (late.frb) against servo (servo.frb): better in 0").wait_for()
