"""Learning and tuning in a browser: begun, watched, stopped, kept, taken back."""

import shutil

import pytest

from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.table import read_table
from tests.designer.test_designer_learning import SINE, SOC
from tests.designer.test_designer_page import further, pytestmark, text_of, until  # noqa: F401


@pytest.fixture
def view(browser, served):
    """Open a file and turn to a view of it; a fault in a page fails the test."""
    faults = []
    context = browser.new_context()

    def turn(name, text, to):
        (served.folder / name).write_text(text)
        page = context.new_page()
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("console", lambda said: faults.append(said.text) if said.type == "error" else None)
        page.goto(f"{served.address}#file={name}")
        until(lambda: "no findings" in page.locator(".findings").text_content(), "findings")
        further(page, to)
        return page, page.locator(f"#view-{to.lower()}")

    yield turn
    context.close()
    assert faults == []


def test_a_search_is_watched_stopped_taken_and_undone(served, view):
    shutil.copy(shipped("roompi.frb"), served.folder)
    before = shipped("heater.frb").read_text()
    page, tune = view("heater.frb", before, "Tune")
    tune.get_by_text("G_e, G_ce, G_du").wait_for()
    for name, value in (("Reference", "temperature=step:20"), ("Duration", "900s"),
                        ("Trials at most", "90000"), ("Unseen scenarios", "2")):  # fmt: skip
        tune.get_by_label(name, exact=True).fill(value)
    tune.get_by_role("button", name="Start").click()
    curve = tune.get_by_role("img", name="the best so far costs")
    curve.wait_for()
    numbers = tune.get_by_role("img", name="G_du: ")
    assert "between 0.01 and 5; 0.4 in the file" in numbers.get_attribute("aria-label")
    until(lambda: "G_du: 0.4," not in numbers.get_attribute("aria-label"), "something better")
    # Key strokes are answered meanwhile.
    page.evaluate("designer.text.goTo([0, 0])")
    page.keyboard.type("# typed meanwhile\n")
    until(lambda: page.evaluate("designer.text.settled()"), "taken by the server")
    typed = text_of(page)
    tune.get_by_role("button", name="Stop, keep the best").click()
    take = tune.get_by_role("button", name="Take it")
    until(take.is_enabled, "the report")
    tune.locator(".report").get_by_text("better than the file").first.wait_for()
    take.click()
    until(lambda: "# tuned: nelder-mead" in text_of(page), "the change")
    assert text_of(page).startswith("# typed meanwhile\n")
    assert "G_du = 0.4 " not in text_of(page)
    said = tune.locator("p.said").first
    until(lambda: "The text has the new numbers" in said.inner_text(), "taken")
    page.locator(".cm-content").focus()
    page.keyboard.press("Control+z")
    until(lambda: text_of(page) == typed, "one step back")
    until(lambda: "the best is kept" in said.inner_text(), "it is said")
    page.keyboard.press("Control+y")
    until(lambda: "The text has the new numbers" in said.inner_text(), "taken again")


def test_a_table_grows_and_is_saved(served, view):
    page, learn = view("servo-soc.frb", SOC, "Learn")
    learn.get_by_label("Reference").fill(SINE)
    learn.get_by_role("button", name="One pass").click()
    learn.get_by_text("pass 1 of 6, waiting; RMS error 0.9002°").wait_for()
    label = learn.get_by_role("img", name="Table of shaft").get_attribute("aria-label")
    assert "of 169 cells visited" in label
    learn.get_by_role("img", name="Table of shaft").focus()
    for _ in range(6):
        page.keyboard.press("ArrowDown")
        page.keyboard.press("ArrowRight")
    assert learn.get_by_text("e = 0, ce = 0: ").text_content().endswith(" times")
    learn.get_by_role("button", name="Save the table").click()
    learn.get_by_text("learned.lut is written").wait_for()
    assert read_table(served.folder / "learned.lut").names == ("e", "ce")
    learn.get_by_role("button", name="Save the table").click()
    page.get_by_role("button", name="Cancel").click()
    learn.get_by_role("button", name="Stop", exact=True).click()
    learn.get_by_text("stopped; RMS error").wait_for()
