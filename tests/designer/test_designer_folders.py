"""Any folder in the designer: an empty one invites, and the list says which file is shown."""

import os

import pytest
from needs import requires
from test_designer_page import Served, put, text_of, until

from fuzzyarm.apps.builder.starting import starting_text
from fuzzyarm.base.shipped_files import shipped

pytestmark = [
    requires("chromium"),
    pytest.mark.slow,
]


@pytest.fixture
def serve(tmp_path):
    """Serve a folder; by default an empty one."""
    running = []

    def start(folder=None):
        server = Served(folder or tmp_path / "class")
        running.append(server)
        return server

    (tmp_path / "class").mkdir()
    yield start
    for server in running:
        server.stop()


IN_ADDRESS = "new URLSearchParams(location.hash.slice(1)).get('file')"


def shown(page):
    """Say which file is shown, when all that says it agrees."""
    found = []

    def agree():
        name = page.locator("header select").input_value()
        title = page.title().removeprefix("● ").removesuffix(" – fuzzyarm designer")
        text = text_of(page).split("\n")[0].removeprefix("# ")
        found[:] = name, title, page.evaluate(IN_ADDRESS) or name, text
        return len(set(found)) == 1

    until(agree, found)
    return found[0]


def named(server, *names):
    for name in names:
        put(server, name, f"# {name}\n{shipped('thermostat.frb').read_text()}")


def turn(page, name):
    page.locator("header select").select_option(name)
    until(lambda: page.evaluate("!!designer.store.scene"), "a picture")
    until(lambda: page.title().startswith(f"{name} – "), f"turned to {name}")


def test_the_list_says_which_file_is_shown_however_often_one_turns(page, serve):
    server = serve()
    named(server, "a.frb", "b.frb", "c.frb")
    page.goto(server.address)
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    for name in ("b.frb", "a.frb", "b.frb", "c.frb", "a.frb"):
        turn(page, name)
        assert shown(page) == name
    for step, name in [("go_back", "c.frb"), ("go_back", "b.frb"), ("go_forward", "c.frb")]:
        getattr(page, step)()
        until(lambda name=name: page.title().startswith(name), step)
        assert shown(page) == name


def test_quick_clicks_while_files_load_end_at_the_last_one(page, serve):
    server = serve()
    named(server, "a.frb", "b.frb", "c.frb")
    page.goto(server.address)
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    page.evaluate(
        """() => {
          for (const name of ["b.frb", "c.frb", "b.frb", "a.frb", "c.frb"]) {
            const select = document.querySelector("header select");
            select.value = name;
            select.dispatchEvent(new Event("change"));
          }
          history.back();
          history.back();
          history.forward();
        }"""
    )
    page.wait_for_timeout(500)
    shown(page)


def test_a_slow_answer_does_not_turn_the_page_back(page, serve):
    """A step back to a file that the page does not know asks the folder; meanwhile one turns."""
    server = serve()
    named(server, "a.frb", "b.frb")
    page.goto(f"{server.address}#file=a.frb")
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    page.evaluate(
        """() => {
          location.hash = "#file=gone.frb";
          window.dispatchEvent(new PopStateEvent("popstate"));
          const select = document.querySelector("header select");
          select.value = "b.frb";
          select.dispatchEvent(new Event("change"));
        }"""
    )
    page.wait_for_timeout(400)
    until(lambda: shown(page) == "b.frb", "the file that was chosen")


def test_two_windows_each_say_their_own_file_when_one_goes(page, serve):
    server = serve()
    named(server, "a.frb", "b.frb", "c.frb")
    page.goto(f"{server.address}#file=b.frb")
    other = page.context.new_page()
    other.goto(f"{server.address}#file=a.frb")
    for each in (page, other):
        until(lambda each=each: each.evaluate("!!window.designer?.store.scene"), "a picture")
    turn(other, "b.frb")
    turn(other, "a.frb")
    page.get_by_role("tab", name="Files").click()
    page.get_by_role("button", name="Delete b.frb").click()
    page.locator("dialog").get_by_role("button", name="Delete").click()
    until(lambda: page.title().startswith("a.frb"), "another file")
    assert shown(page) == "a.frb"
    until(lambda: "b.frb" not in other.locator("header select").inner_text(), "it is told")
    assert shown(other) == "a.frb"
    page.get_by_role("button", name="Rename a.frb").click()
    page.locator("dialog input").fill("renamed.frb")
    page.keyboard.press("Enter")
    for each in (page, other):
        until(lambda each=each: "renamed.frb" in each.title(), "its other name")
        assert each.locator("header select").input_value() == "renamed.frb"


def test_files_that_come_and_go_by_themselves_are_offered(page, serve):
    server = serve()
    named(server, "a.frb")
    page.goto(server.address)
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    choices = page.locator("header select option")
    named(server, "b.frb")
    until(lambda: choices.all_inner_texts() == ["a.frb", "b.frb"], "the new one")
    (server.folder / "b.frb").unlink()
    until(lambda: choices.all_inner_texts() == ["a.frb"], "and not any more")


# --- an empty folder ---


def test_an_empty_folder_invites_and_has_nothing_that_goes_nowhere(page, serve):
    server = serve()
    page.goto(server.address)
    page.get_by_text("This folder has no rule base yet").wait_for()
    page.wait_for_timeout(300)
    assert page.get_by_text("does not answer").count() == 0
    assert page.locator(".cm-content").count() == 0
    assert page.locator("#status").inner_text() == ""
    assert page.get_by_role("button", name="Save").count() == 0
    starts = page.locator(".starts").first.locator("button").all_inner_texts()
    assert [each.splitlines()[0] for each in starts] == [
        "Blank", "Two inputs, PD", "Two inputs, PI", "One input", "Controller",
    ]  # fmt: skip


@pytest.mark.parametrize(("title", "kind"), [("Two inputs, PI", "pi"), ("One input", "single")])
def test_a_start_is_the_text_that_the_command_writes(page, serve, title, kind):
    server = serve()
    page.goto(server.address)
    page.locator(".starts button", has_text=title).click()
    page.locator("dialog input[name=name]").fill("ünïcode of 'me'")
    page.keyboard.press("Enter")
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    path = server.folder / "ünïcode of 'me'.frb"
    assert text_of(page) == path.read_text() == starting_text(path.stem, kind)
    assert page.evaluate("designer.store.view") == "design"
    assert page.locator("header select").input_value() == path.name


def test_a_folder_that_does_not_exist_is_made_with_the_first_file(page, serve, tmp_path):
    folder = tmp_path / "not" / "there"
    server = serve(folder)
    page.goto(server.address)
    page.get_by_text("This folder has no rule base yet").wait_for()
    assert not folder.exists()
    page.locator(".starts button", has_text="One input").click()
    page.locator("dialog input[name=name]").fill("one")
    page.keyboard.press("Enter")
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    assert (folder / "one.frb").exists()


def test_a_folder_of_broken_and_foreign_files_can_be_begun_in(page, serve):
    server = serve()
    (server.folder / "broken.frb").write_bytes(b"\xff\xfe not a text")
    (server.folder / "notes.txt").write_text("nothing")
    (server.folder / "mine.py").write_text("import os")
    page.goto(server.address)
    page.get_by_text("not UTF-8").first.wait_for()
    page.get_by_role("tab", name="Files").click()
    assert page.locator(".cm-content").get_attribute("contenteditable") == "false"
    page.get_by_role("button", name="New file").click()
    name, kind = page.locator("dialog input[name=name]"), page.locator("dialog select[name=kind]")
    kind.select_option("fan.frb")
    assert name.input_value() == "fan.frb"  # an example brings its name
    kind.select_option("single")
    assert name.input_value() == "unnamed.frb"
    name.fill("fine")
    kind.select_option("pd")
    assert name.input_value() == "fine"
    page.get_by_role("button", name="Create").click()
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    assert page.locator("header select").input_value() == "fine.frb"
    assert page.locator(".cm-content").get_attribute("contenteditable") == "true"
    page.reload()
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "the sound one, not the first")


def test_foreign_files_of_the_folder_are_offered_to_be_converted(page, serve):
    server = serve()
    from fuzzyarm.apps.designer.exports import files_of
    from fuzzyarm.apps.lsp.session import Session

    tipper = Session("tipper.frb", shipped("tipper.frb").read_text())
    content = files_of(tipper, ".fis", {}, lambda _: None)[0][0].content
    (server.folder / "a tipper.fis").write_bytes(content)
    page.goto(server.address)
    page.get_by_role("button", name="a tipper.fis").click()
    until(lambda: page.locator("dialog[open]").count() or text_of(page), "converted")
    if page.locator("dialog[open]").count():
        page.get_by_role("button", name="Close").click()
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    assert (server.folder / "a tipper.frb").exists()


def test_a_file_appears_in_the_empty_folder_by_itself(page, serve):
    server = serve()
    page.goto(server.address)
    page.get_by_text("This folder has no rule base yet").wait_for()
    named(server, "dropped in.frb")
    until(lambda: "dropped in.frb" in page.title(), "it is shown")
    until(lambda: text_of(page).startswith("# dropped in.frb"), "its text")


ODD_NAMES = [
    'it\'s "x" <y>.frb',
    "a\nb.frb",
    "#a?b=c&d%20+e.frb",
    "öäü 日本.frb",
    "-rf.frb",
    ".h.frb",
]


@pytest.mark.skipif(os.name == "nt", reason="names that this system does not have")
def test_a_name_that_is_there_is_opened_saved_and_left(page, serve):
    server = serve()
    named(server, "other.frb")
    text = shipped("thermostat.frb").read_text()
    for name in ODD_NAMES:
        (server.folder / name).write_text(text)
    page.goto(f"{server.address}#file=other.frb")
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    values = page.locator("header select option").evaluate_all("all => all.map(o => o.value)")
    assert sorted(values) == sorted([*ODD_NAMES, "other.frb"])
    for number, name in enumerate(ODD_NAMES):
        mine = f"# mine, {number}\n"
        page.locator("header select").select_option(value=name)
        until(lambda name=name: page.evaluate(IN_ADDRESS) == name, f"turned to {name!r}")
        until(lambda: text_of(page) == text, f"the text of {name!r}")
        page.evaluate("designer.text.goTo([0, 0])")
        page.keyboard.type(mine)
        page.keyboard.press("Control+s")
        path = server.folder / name
        until(lambda p=path, mine=mine: p.read_text().startswith(mine), f"{name!r} is saved")
        page.reload()
        until(
            lambda mine=mine: (
                page.evaluate("!!window.designer?.store.scene") and text_of(page).startswith(mine)
            ),
            f"{name!r} by its address",
        )


@pytest.mark.skipif(os.name == "nt", reason="names that this system does not have")
def test_a_name_that_is_not_text_leaves_the_others_alone(page, serve):
    server = serve()
    named(server, "other.frb")
    raw = os.path.join(os.fsencode(server.folder), b"\xff.frb")
    with open(raw, "wb") as file:
        file.write(b"rulebase x\n")
    page.goto(server.address)
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    assert shown(page) == "other.frb"


def test_hundreds_of_files_open_at_once(page, serve):
    server = serve()
    named(server, *[f"file{i:03}.frb" for i in range(400)])
    page.goto(server.address)
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    assert shown(page) == "file000.frb"
    page.get_by_role("tab", name="Files").click()
    until(lambda: page.locator("table.files tbody tr").count() == 400, "all of them")
    page.locator("table.files").get_by_role("button", name="file399.frb", exact=True).click()
    until(lambda: page.title().startswith("file399.frb"), "turned")
    until(lambda: text_of(page), "its text")
    assert shown(page) == "file399.frb"


def test_what_cannot_be_written_is_said_in_a_sentence(page, serve):
    server = serve()
    page.goto(server.address)
    page.locator(".starts button", has_text="One input").click()
    server.folder.rmdir()
    server.folder.write_text("a file stands there now")
    page.locator("dialog input[name=name]").fill("one")
    page.keyboard.press("Enter")
    until(lambda: page.locator("dialog .error").inner_text() != "", "why not")
    assert "not understood" not in page.locator("dialog .error").inner_text()


def test_it_opens_a_rule_base_and_not_the_first_file_by_name(page, serve):
    server = serve()
    put(server, "a-controller.frb", shipped("servo.frb").read_text())
    put(server, "b-table.lut", shipped("thesis-6.1.lut").read_text())
    put(server, "c-broken.frb", "rulebase c\ninput\n")
    put(server, "d-rules.frb", f"# d-rules.frb\n{shipped('pd7.frb').read_text()}")
    page.goto(server.address)
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    assert shown(page) == "d-rules.frb"
