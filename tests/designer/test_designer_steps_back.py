"""Steps back in the designer: what a hand has done is undone, and nothing else."""

import pytest
from needs import requires
from test_designer_page import put, text_of, until

from fuzzyarm.base.files import write_atomically

pytestmark = [
    requires("chromium"),
    pytest.mark.slow,
]


def opened(page, address):
    page.goto(address)
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    page.evaluate("designer.text.goTo([0, 0])")


def back(page, times=1):
    for _ in range(times):
        page.keyboard.press("Control+z")


def forth(page, times=1):
    for _ in range(times):
        page.keyboard.press("Control+Shift+Z")


def test_opening_is_no_step_and_steps_of_a_hand_end_where_it_began(page, served):
    path, address = put(served, "opened.frb")
    opened(page, address)
    steps = [page.get_by_role("button", name=name, exact=True) for name in ("Undo", "Redo")]
    back(page, 3)
    assert text_of(page) == path.read_text()
    assert [each.is_enabled() for each in steps] == [False, False]
    page.keyboard.type("# one\n")
    assert [each.is_enabled() for each in steps] == [True, False]
    page.wait_for_timeout(700)  # another step begins
    page.keyboard.type("# two\n")
    back(page, 30)
    assert text_of(page) == path.read_text()
    assert [each.is_enabled() for each in steps] == [False, True]
    forth(page, 30)
    assert text_of(page) == "# one\n# two\n" + path.read_text()


def test_what_others_write_is_no_step_of_this_hand(page, served):
    path, address = put(served, "others.frb")
    opened(page, address)
    page.keyboard.type("# mine\n")
    until(lambda: page.evaluate("designer.text.settled()"), "sent")
    theirs = path.read_text() + "# theirs\n"
    write_atomically(path, theirs)
    page.get_by_role("button", name="Keep both").click()
    until(lambda: "# theirs" in text_of(page), "merged")
    page.locator(".cm-content").focus()
    back(page, 30)
    assert text_of(page) == theirs


def test_steps_outlive_the_server_and_what_has_changed_meanwhile_is_none(page, served):
    path, address = put(served, "outlived.frb")
    before = path.read_text()
    opened(page, address)
    page.keyboard.type("# mine\n")
    until(lambda: page.evaluate("designer.text.settled()"), "sent")
    served.stop()
    page.get_by_text("does not answer").wait_for()
    page.keyboard.type("# alone\n")
    cursor = page.evaluate("designer.text.view.state.selection.main.head")
    path.write_text(before + "# theirs\n")
    served.start()
    page.get_by_role("button", name="Keep both").click()
    until(lambda: "# theirs" in text_of(page), "merged with the file")
    page.locator(".cm-content").focus()
    assert page.evaluate("designer.text.view.state.selection.main.head") == cursor
    back(page, 30)
    until(lambda: text_of(page) == before + "# theirs\n", "the steps of this hand")
    forth(page, 30)
    assert text_of(page) == "# mine\n# alone\n" + before + "# theirs\n"


def test_a_file_that_was_closed_and_is_opened_again_begins_without_steps(page, served):
    for name in ("first.frb", "second.frb"):
        put(served, name)
    opened(page, f"{served.address}#file=first.frb")
    for name in ("second.frb", "first.frb", "second.frb"):
        page.locator("header select").select_option(name)
        until(lambda name=name: page.title().startswith(name), "turned")
        until(lambda: page.evaluate("!!designer.store.scene"), "a picture")
        page.evaluate("designer.text.goTo([0, 0])")
        back(page, 3)
        assert text_of(page) == (served.folder / name).read_text()


def test_back_to_the_file_is_one_step_that_can_be_undone(page, served):
    path, address = put(served, "reverted.frb")
    opened(page, address)
    button = page.get_by_role("button", name="Back to the file")
    assert button.is_disabled()
    page.keyboard.type("# one\n")
    page.wait_for_timeout(700)
    page.keyboard.type("# two\n")
    typed = text_of(page)
    button.click()
    until(lambda: text_of(page) == path.read_text(), "the text of the file")
    until(button.is_disabled, "nothing to go back from")
    page.locator(".cm-content").focus()
    back(page)
    assert text_of(page) == typed
