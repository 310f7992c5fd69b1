"""What a hand has typed or reached stays: unsaved texts, drafts, the focus."""

import pytest
from needs import requires
from test_designer_page import Served, becomes, text_of, until

from fuzzyarm.base.files import write_atomically
from fuzzyarm.base.shipped_files import shipped

pytestmark = [
    requires("chromium"),
    pytest.mark.slow,
]

PD7 = shipped("pd7.frb").read_text()
TIPPER = shipped("tipper.frb").read_text()

TWO = """\
controller two "a rule base of the folder, and another"
period 1 ms
gain G_e = 16 "1/rad"
gain G_ce = 0.7 "s/rad"
gain G_u = 4.5 "V"

use one from "one.frb"
use other from "other.frb"

axis shaft
  e = error of position * G_e
  ce = error of velocity * G_ce
  a = rules one(e, ce) * G_u
  b = rules other(e, ce) * G_u
  drive voltage = a + b, within -24 .. 24
"""

ENDLESS = """\
rulebase endless
input x -inf .. 1
output y 0 .. 1
term x LOW:  triangle -1 0 1
term x HIGH: triangle 0 1 2
term y A: triangle 0 0.3 0.5
term y B: triangle 0.5 0.7 1
rule if x is LOW then y is A
rule if x is HIGH then y is B
"""

LEAVING = """() => {
  const leaving = new Event("beforeunload", { cancelable: true });
  window.dispatchEvent(leaving);
  return leaving.defaultPrevented;
}"""


@pytest.fixture
def folder(tmp_path):
    found = tmp_path / "class"
    found.mkdir()
    (found / "one.frb").write_text(PD7)
    (found / "other.frb").write_text(PD7)
    (found / "two.frb").write_text(TWO)
    (found / "tipper.frb").write_text(TIPPER)
    (found / "endless.frb").write_text(ENDLESS)
    return found


@pytest.fixture
def server(folder):
    found = Served(folder)
    yield found
    found.stop()


BLANK = """() => [...document.querySelectorAll(".sheet canvas")].some((canvas) => {
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  return data.every((byte) => byte === 0);
})"""


def still(page, pictures):
    """Wait until two pictures are drawn, in the place that the other panes leave them."""
    seen = [[]]

    def stays():
        seen.append(page.evaluate(pictures))
        page.wait_for_timeout(300)
        return not page.evaluate(BLANK) and len(seen[-1]) == 2 and seen[-1] == seen[-2]

    until(stays, "pictures that stay")
    return seen[-1]


def turn(page, name):
    page.evaluate("name => { location.hash = '#' + new URLSearchParams({ file: name }); }", name)
    until(lambda: page.title().removeprefix("● ").startswith(f"{name} – "), f"turned to {name}")
    until(lambda: page.evaluate("designer.text.settled() && designer.store.sound"), "checked")


def write(page, old, new):
    page.evaluate(
        "([old, now]) => designer.text.replace(designer.text.state().text.replaceAll(old, now))",
        [old, new],
    )
    until(lambda: page.evaluate("designer.text.settled()"), "sent")


def said(page):
    return "".join(page.locator("p.around:visible").all_inner_texts())


HELD = "element => element === document.activeElement"


def test_an_unsaved_text_is_not_closed_however_many_files_are_looked_at(page, server, folder):
    names = [f"f{number}.frb" for number in range(10)]
    for name in names:
        (folder / name).write_text(TIPPER)
    page.goto(server.address)
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    turn(page, names[0])
    write(page, "rulebase", "# the work of an hour\nrulebase")
    for name in names[1:]:
        turn(page, name)
    assert page.evaluate(LEAVING)
    assert page.evaluate("designer.desks.get('f0.frb').dirty")


def test_a_run_says_which_of_its_files_are_not_saved_until_they_are(page, server, folder):
    page.goto(f"{server.address}#file=two.frb")
    until(lambda: page.evaluate("!!window.designer?.store.diagram"), "a diagram")
    page.get_by_role("tab", name="Run").click()
    until(lambda: page.locator(".run-form select").nth(1).input_value(), "the plants")
    assert said(page) == ""
    for name in ("one.frb", "other.frb"):
        turn(page, name)
        write(page, "NB      NB  NB  NB  NM", "NB      NB  NB  NM  NM")
    turn(page, "two.frb")
    both = "one.frb, other.frb have unsaved changes; the run uses the saved versions."
    until(lambda: said(page).startswith(both), "what is not saved")
    page.get_by_role("button", name="Save one.frb").click()
    until(lambda: said(page).startswith("other.frb has unsaved changes"), "one is saved")
    assert "NB  NB  NM  NM" in (folder / "one.frb").read_text()
    theirs = PD7.replace("NB      NB  NB  NB  NM", "NB      ZE  NB  NB  NM")
    write_atomically(folder / "other.frb", theirs)
    page.get_by_role("button", name="Save other.frb").click()
    until(lambda: "other.frb is not saved: the file has changed on disk" in said(page), "why")
    assert page.get_by_role("button", name="Save other.frb").is_visible()
    assert (folder / "other.frb").read_text() == theirs


def test_a_restart_that_cannot_be_marks_its_field_and_the_note_stays(page, server):
    page.goto(f"{server.address}#file=two.frb")
    until(lambda: page.evaluate("!!window.designer?.store.diagram"), "a diagram")
    page.get_by_role("tab", name="Run").click()
    form = page.locator(".run-form")
    until(lambda: form.locator("select").nth(1).input_value(), "the plants")
    field = form.get_by_label("Duration", exact=True).element_handle()  # its label will say more
    field.fill("200ms")
    form.get_by_label("Speed").select_option("")
    form.get_by_role("button", name="Start").click()
    form.get_by_text("0.2 s, the time asked for").wait_for()
    field.fill("nonsense")
    form.get_by_role("button", name="Restart").click()
    form.locator(".wrong").wait_for()
    form.locator("p.said").get_by_text("not 'nonsense'").wait_for()
    assert form.locator("output.clock").inner_text().startswith("0.2 s")
    field.fill("300ms")
    form.get_by_role("button", name="Restart").click()
    form.get_by_text("0.3 s, the time asked for").wait_for()
    becomes(form.locator(".wrong").count, 0)


def test_the_picture_of_a_used_file_is_that_of_its_saved_text(page, server):
    page.goto(f"{server.address}#file=two.frb")
    pictures = "[...document.querySelectorAll('.sheet canvas')].map((each) => each.toDataURL())"
    before = still(page, pictures)
    assert len(before) == 2
    turn(page, "other.frb")
    write(page, "NB      NB  NB  NB  NM  NS  NS  ZE", "NB      PB  PB  PB  PB  PB  PB  PB")
    page.keyboard.press("Control+s")
    until(lambda: not page.evaluate("designer.desks.get('other.frb').dirty"), "saved")
    turn(page, "two.frb")
    until(lambda: page.evaluate(pictures)[1:] not in ([], before[1:]), "another picture")
    after = still(page, pictures)
    assert after[0] == before[0]
    assert after[1] != before[1]


def test_what_is_typed_in_a_rule_outlives_a_new_scene(page, server, folder):
    page.goto(f"{server.address}#file=tipper.frb")
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    rules = page.locator(".rules")
    rules.get_by_role("button", name="Edit").first.click()
    old = rules.locator("li input.write").input_value()
    rules.locator("li input.write").fill(f"{old} # and more")
    rules.get_by_label("A new rule").fill("if nothing")
    page.evaluate("window.scenes = 0; designer.store.on('scene', () => { window.scenes++; })")
    write_atomically(folder / "tipper.frb", "# another program\n" + TIPPER)
    until(lambda: text_of(page).startswith("# another program\n"), "merged")
    until(lambda: page.evaluate("window.scenes"), "drawn anew")
    assert rules.locator("li input.write").input_value() == f"{old} # and more"
    assert rules.get_by_label("A new rule").input_value() == "if nothing"
    assert page.evaluate("document.activeElement.value") == "if nothing"
    rules.locator("li input.write").fill(old.replace(" is ", " is not ", 1))
    rules.locator("li input.write").press("Enter")
    until(lambda: old.replace(" is ", " is not ", 1) in text_of(page), "written")
    until(lambda: rules.locator("li input.write").count() == 0, "closed")
    rules.get_by_role("button", name="Edit").nth(1).click()
    page.keyboard.press("Escape")
    becomes(lambda: page.evaluate("document.activeElement.textContent"), "Edit")


def test_a_grid_is_edited_by_the_keyboard_alone(page, server):
    page.goto(f"{server.address}#file=one.frb")
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    page.evaluate("window.scenes = 0; designer.store.on('scene', () => { window.scenes++; })")
    held = "document.activeElement.dataset.key"

    def drawn_after(count):
        until(lambda: page.evaluate("window.scenes") >= count, "a new scene")

    cell = page.get_by_label("rule for ZE, ZE")
    cell.focus()
    before = page.evaluate(held)
    for count, term in ((1, "PS"), (2, "PM")):
        page.keyboard.press("ArrowDown")
        drawn_after(count)
        assert page.evaluate(held) == before
        assert cell.input_value() == term
    add = page.locator(".composer button")
    page.locator(".composer select").first.select_option(index=1)
    add.press("Enter")
    drawn_after(3)
    assert add.evaluate(HELD)
    methods = page.locator("details.methods summary")
    methods.press("Enter")
    norm = page.locator("details.methods select").first
    norm.press("ArrowDown")
    drawn_after(4)
    assert norm.evaluate(HELD)

    # A dialog has a name, and gives the focus back to what stands in its place.
    head = page.locator(".rules th button").first
    head.press("Enter")
    name = head.get_attribute("title")
    page.get_by_role("dialog", name=name).wait_for()
    page.keyboard.press("Escape")
    until(lambda: head.evaluate(HELD), "the head has the focus again")
    page.get_by_role("tab", name="Files").click()
    duplicate = page.get_by_role("button", name="Duplicate endless.frb")
    duplicate.press("Enter")
    dialog = page.get_by_role("dialog", name="Duplicate endless.frb")
    dialog.wait_for()
    page.keyboard.press("Escape")
    dialog.wait_for(state="hidden")
    until(lambda: duplicate.evaluate(HELD), "the button has the focus again")


def test_an_endless_range_is_kept_and_a_folder_that_is_dropped_is_refused(page, server):
    page.goto(f"{server.address}#file=endless.frb")
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    page.locator("button[aria-label^='x: Its range']").click()
    dialog = page.get_by_role("dialog")
    assert dialog.locator("input[name=low]").input_value() == "-inf"
    dialog.locator("input[name=high]").fill("20")
    dialog.get_by_role("button", name="OK").click()
    until(lambda: "input x -inf .. 20" in text_of(page), "the range")
    page.get_by_role("tab", name="Files").click()
    page.evaluate("""() => { designer.desks.get("endless.frb").bring([
      { name: "a-folder", size: 9, arrayBuffer: () => Promise.reject(new DOMException("gone")) },
    ]); }""")
    page.get_by_role("dialog", name="a-folder is not imported").wait_for()
    page.keyboard.press("Escape")
    assert "is converted" not in page.locator(".folder .note").inner_text()


def test_a_shipped_file_that_is_there_by_now_is_opened_and_not_copied_again(page, server, folder):
    (folder / "servo.frb").write_text(shipped("servo.frb").read_text())
    page.goto(f"{server.address}#file=servo.frb")
    copy = page.get_by_role("button", name="Copy pd7.frb here")
    copy.wait_for()
    (folder / "pd7.frb").mkdir()  # in the way
    copy.click()
    page.locator(".sheet .error").wait_for()
    page.locator(".sheet .error").get_by_text("already exists").wait_for()
    (folder / "pd7.frb").rmdir()
    copy.click()
    until(lambda: page.title().startswith("pd7.frb"), "the copy")
    page.go_back()
    page.get_by_role("button", name="Open pd7.frb").wait_for()
    becomes(copy.count, 0)


def test_files_that_came_while_the_server_was_away_are_offered(page, server, folder):
    page.goto(f"{server.address}#file=one.frb")
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    server.stop()
    (folder / "came.frb").write_text(TIPPER)
    server.start()
    offered = "[...document.querySelectorAll('header select option')].map((each) => each.value)"
    until(lambda: "came.frb" in page.evaluate(offered), "offered")


def test_a_file_that_goes_takes_its_run_along(page, server):
    page.add_init_script("""const send = WebSocket.prototype.send;
      window.sent = [];
      WebSocket.prototype.send = function(words) { window.sent.push(words); send.call(this, words);
      };
    """)
    page.goto(f"{server.address}#file=two.frb")
    until(lambda: page.evaluate("!!window.designer?.store.diagram"), "a diagram")
    page.get_by_role("tab", name="Run").click()
    page.locator(".run-form").get_by_role("button", name="Start").click()
    page.evaluate("window.ended = 0; designer.store.on('closed', () => { window.ended++; })")
    until(lambda: page.locator("output.clock").inner_text(), "it runs")
    page.get_by_role("tab", name="Files").click()
    page.get_by_label("Delete two.frb").click()
    page.get_by_role("dialog").get_by_role("button", name="Delete").click()
    until(lambda: not page.title().startswith("two.frb"), "gone")
    until(lambda: page.evaluate("window.ended") == 1, "closed")
    stops = """window.sent.some((each) => JSON.parse(each).do === "stop")"""
    until(lambda: page.evaluate(stops), "the run is stopped")


def test_a_border_moves_without_a_store(browser, server):
    context = browser.new_context()
    page = context.new_page()
    page.add_init_script(
        "Object.defineProperty(window, 'localStorage', { get() { throw new Error('no'); } })"
    )
    page.goto(f"{server.address}#file=one.frb")
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    border = page.locator(".split.columns").first
    border.focus()
    places = []
    for _ in range(3):
        page.keyboard.press("ArrowRight")
        places.append(int(border.get_attribute("aria-valuenow")))
    turn(page, "other.frb")
    assert places[2] - places[1] == places[1] - places[0] == 2
    assert int(page.locator(".split.columns").first.get_attribute("aria-valuenow")) == places[2]
    context.close()
