"""The designer in a browser: what a hand does is an edit of the text, what is typed is drawn."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

import fuzzyarm
from fuzzyarm.designer.exports import files_of
from fuzzyarm.designer.folder import converted_file
from fuzzyarm.designer.written import page_of
from fuzzyarm.lsp.session import Session
from fuzzyarm.shipped_files import shipped

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = [
    pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed"),
    pytest.mark.slow,
]
sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

HOSTILE = """\
rulebase '<img src=x onerror="window.caught=1">' "</script><script>window.caught=1</script>"
input '<b>x</b>' 0 .. 10 "<svg onload='window.caught=1'>"
output 'y</script>' 0 .. 10
terms '<b>x</b>', 'y</script>': triangles '"><i>' 'H\\u202e'
rules 'y</script>'
  '<b>x</b>'    '"><i>'  'H\\u202e'
  'y</script>'  '"><i>'  'H\\u202e'
# <script>window.caught = 1</script>
"""


class Served:
    """A server in a process of its own."""

    def __init__(self, folder, port=0):
        self.folder, self.port = folder, port
        self.start()

    def start(self):
        words = [sys.executable, "-m", "fuzzyarm", "designer", str(self.folder), "--no-browser"]
        state = {"XDG_STATE_HOME": str(self.folder / ".state")}
        self.process = subprocess.Popen(
            [*words, "--port", str(self.port)],
            stdout=subprocess.PIPE, text=True, env={**os.environ, **state},
        )  # fmt: skip
        self.address = self.process.stdout.readline().strip()
        assert self.address.startswith("http://127.0.0.1:"), self.address
        self.port = int(self.address.split(":")[2].split("/")[0])

    def stop(self):
        self.process.terminate()
        self.process.wait(10)
        self.process.stdout.close()


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    folder = tmp_path_factory.mktemp("designer")
    server = Served(folder)
    yield server
    server.stop()


@pytest.fixture(scope="module")
def browser():
    with sync_api.sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield found
        found.close()


@pytest.fixture
def window(browser, request):
    """Make pages; a fault in one of them fails the test."""
    context = browser.new_context(viewport={"width": 1280, "height": 720})
    context.set_default_timeout(10_000)
    faults = []

    def open_page(address):
        page = context.new_page()
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("console", lambda said: faults.append(said.text) if said.type == "error" else None)
        page.goto(address)
        until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
        return page

    yield open_page
    context.close()
    allowed = request.node.get_closest_marker("slow")  # a lost connection is said by the browser
    assert [fault for fault in faults if "WebSocket connection" not in fault] == [], allowed


def put(served, name, text=None):
    """Put a file into the folder; its address in the designer."""
    path = served.folder / name
    path.write_text(shipped("pd7.frb").read_text() if text is None else text)
    return path, f"{served.address}#file={name}"


def text_of(page):
    return page.evaluate("designer.text.view.state.doc.toString()")


def until(condition, what=""):
    for _ in range(400):
        if condition():
            return
        time.sleep(0.025)
    raise AssertionError(f"did not happen: {what or condition}")


def drag(page, selector, dx):
    box = page.locator(selector).bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + dx / 2, y, steps=3)
    page.mouse.move(x + dx, y, steps=3)
    page.mouse.up()


def value_at(page, *point):
    return page.evaluate("point => designer.store.running.at(point)[0]", list(point))


def test_what_a_hand_changes_is_an_edit_of_the_text(served, window):
    path, address = put(served, "pd7.frb")
    page = window(address)
    before = text_of(page)
    drag(page, 'circle[data-variable="e"][data-term="ZE"]', 40)
    until(lambda: "term e ZE: triangle -2 " in text_of(page), "the term has a line")
    after = text_of(page)
    assert after.startswith(before[: before.index("\n\ninference")])  # behind its family
    assert "# evenly spaced" in after

    # The same surface as that of the text, by Python.
    until(lambda: page.evaluate("!designer.store.held"), "!designer.store.held")
    page.keyboard.press("Control+s")
    until(lambda: path.read_text() == after, "saved")
    model = fuzzyarm.load(path)
    for point in ((0.3, 0.7), (1.9, -4.0), (-5.0, 5.5)):
        assert value_at(page, *point) == fuzzyarm.infer(model, e=point[0], ce=point[1])["u"]

    # A cell is chosen: the columns stay aligned.
    page.get_by_label("rule for ZE, ZE").select_option("PM")
    until(lambda: "  ZE      NB  NM  NS  PM  PS  PM  PB\n" in text_of(page), "the cell")
    page.keyboard.press("Control+z")  # wherever the focus is
    page.locator(".cm-content").focus()
    page.keyboard.press("Control+z")
    assert text_of(page) == before


def test_corners_move_by_keyboard_with_their_neighbours(served, window):
    page = window(put(served, "keys.frb")[1])
    page.get_by_label("Partition").check()
    page.get_by_label("u PM: corner 2").focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    until(lambda: "term u PM" in text_of(page), "the term")
    lines = [line for line in text_of(page).splitlines() if line.startswith("term u")]
    assert lines == [
        "term u PS: triangle 0 2 4.2",
        "term u PM: triangle 2 4.2 6",
        "term u PB: triangle 4.2 6 8",
    ]


def test_while_a_corner_is_held_the_surface_is_that_of_the_new_term(served, window):
    page = window(put(served, "held.frb")[1])
    for variable, term in (("e", "PS"), ("u", "PS")):
        selector = f'circle[data-variable="{variable}"][data-term="{term}"]'
        box = page.locator(selector).first.bounding_box()
        page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        page.mouse.down()
        until(lambda: page.evaluate("!!designer.store.held"), "designer.store.held")
        page.mouse.move(box["x"] + 30, box["y"], steps=2)
        held = [value_at(page, *point) for point in ((0.9, 0.4), (2.5, -1.0))]
        page.mouse.up()
        until(
            lambda: page.evaluate("!designer.store.held && !designer.store.reshaped.size"),
            "!designer.store.held && !designer.store.reshaped.size",
        )
        settled = [value_at(page, *point) for point in ((0.9, 0.4), (2.5, -1.0))]
        assert held == pytest.approx(settled, abs=1e-12)


def test_mistakes_are_found_and_the_last_sound_picture_stays(served, window):
    page = window(put(served, "broken.frb")[1])
    page.evaluate("designer.text.goTo([7, 0])")
    page.keyboard.type("tern e XX: triangle 0 1 2\n")
    page.get_by_text("no statement starts with").first.wait_for()
    assert page.evaluate("designer.store.stale")
    page.get_by_role("button", name="Fix …").first.click()
    page.get_by_role("button", name="change 'tern' to 'term'").click()
    until(lambda: "\nterm e XX" in text_of(page), "the fix")
    until(lambda: page.evaluate("!designer.store.stale"), "!designer.store.stale")
    assert page.locator('text[data-variable="e"]').count() == 8


def test_two_windows_share_a_text(served, window):
    address = put(served, "shared.frb")[1]
    one, other = window(address), window(address)
    one.evaluate("designer.text.goTo([0, 0])")
    other.evaluate("designer.text.goTo([27, 0])")
    one.keyboard.type("# first\n")
    other.keyboard.type("# last\n")
    until(lambda: text_of(one) == text_of(other) and "# first" in text_of(other), "the same")
    assert "# last" in text_of(one)


def test_other_writers_are_merged_or_shown(served, window):
    path, address = put(served, "disk.frb")
    page = window(address)
    page.evaluate("designer.text.goTo([0, 0])")
    page.keyboard.type("# mine\n")
    path.write_text(path.read_text() + "# theirs\n")
    until(lambda: "# theirs" in text_of(page) and "# mine" in text_of(page), "merged")
    assert "# mine" not in path.read_text()
    path.write_text("# another first line\n" + path.read_text())
    page.get_by_text("changed on disk").wait_for()
    assert "# mine" in text_of(page)
    page.get_by_role("button", name="Keep mine").click()
    page.get_by_text("changed on disk").wait_for(state="hidden")
    page.keyboard.press("Control+s")
    until(lambda: path.read_text().startswith("# mine\n"), "saved")


def test_nothing_is_lost_with_the_connection(served, window):
    address = put(served, "dropped.frb")[1]
    one, other = window(address), window(address)
    one.evaluate("designer.text.goTo([0, 0])")
    one.evaluate("designer.drop()")
    one.get_by_text("does not answer").wait_for()
    one.keyboard.type("# typed alone\n")
    other.evaluate("designer.text.goTo([27, 0])")
    other.keyboard.type("# meanwhile\n")
    until(lambda: "# typed alone" in text_of(other), "sent")
    until(lambda: text_of(one) == text_of(other), "the same")
    assert "# meanwhile" in text_of(one)


def test_the_page_outlives_the_server(served, window):
    path, address = put(served, "restart.frb")
    page = window(address)
    served.stop()
    page.get_by_text("does not answer").wait_for()
    page.evaluate("designer.text.goTo([0, 0])")
    page.keyboard.type("# typed meanwhile\n")
    served.start()
    assert address.startswith(served.address)
    page.get_by_text("does not answer").wait_for(state="hidden")
    page.keyboard.press("Control+s")
    until(lambda: path.read_text().startswith("# typed meanwhile\n"), "saved")


def test_a_hostile_file_is_text(served, window, tmp_path):
    path, address = put(served, "hostile.frb", HOSTILE)
    page = window(address)
    page.wait_for_selector(".rules select")
    (tmp_path / "page.html").write_text(page_of(path))
    written = window((tmp_path / "page.html").as_uri())
    for each in (page, written):
        assert each.evaluate("window.caught") is None
        assert each.locator("b, i, img, script:not([type])").count() == 0
        assert each.evaluate("designer.store.scene.inputs[0].name") == "<b>x</b>"


DROP = """([name, text]) => {
  const carried = new DataTransfer();
  carried.items.add(new File([text], name));
  for (const kind of ["dragenter", "drop"]) {
    const event = new DragEvent(kind, { dataTransfer: carried, bubbles: true, cancelable: true });
    document.querySelector(".cm-content").dispatchEvent(event);
  }
}"""


def opened(page, name):
    """Wait until another file is shown: the page is loaded anew for it."""
    shown = "name => document.title.includes(name) && !!window.designer?.store.scene"
    page.wait_for_function(shown, arg=name, timeout=30_000)


def test_files_are_dropped_exported_made_and_compared(served, window):
    path, address = put(served, "base.frb")
    (served.folder / "<img src=x onerror='window.caught=1'>.frb").write_text(path.read_text())
    page = window(address)
    page.get_by_role("tab", name="Files").click()
    page.get_by_role(
        "button", name="<img src=x onerror='window.caught=1'>.frb", exact=True
    ).wait_for()
    assert page.locator("img").count() == 0

    # What is typed and not saved is exported, and is there again after another file.
    page.evaluate("designer.text.goTo([0, 0])")
    page.keyboard.type("# mine\n")
    page.get_by_role("button", name="C header").click()
    page.locator("dialog select[name=way]").select_option("direct")
    with page.expect_download() as loading:
        page.get_by_role("button", name="Export", exact=True).click()
    assert loading.value.suggested_filename == "base.h"
    made = Path(loading.value.path()).read_text()
    assert (
        made.encode()
        == files_of(Session(str(path), text_of(page)), ".h", {"way": "direct"}, print)[0][0].content
    )
    page.get_by_role("button", name="Close").click()

    exported = files_of(Session(str(path), path.read_text()), ".fis", {}, lambda _: None)[0][0]
    text = exported.content.decode().replace("[-2 0 2]", "[-3 0 2]")
    page.evaluate(DROP, ["dropped.fis", text])
    page.get_by_text("read with the defaults of fuzzylite").wait_for()
    page.get_by_role("button", name="Close").click()
    opened(page, "dropped.frb")
    dropped = served.folder / "dropped.frb"
    assert dropped.read_text() == converted_file("dropped.fis", text.encode())["text"]
    assert value_at(page, 1.0, 0.0) == fuzzyarm.infer(fuzzyarm.load(dropped), e=1.0, ce=0.0)["u"]
    assert "# mine" not in path.read_text()

    page.get_by_role("tab", name="Compare").click()
    page.locator(".compare .bar select").first.select_option("base.frb")
    page.get_by_text("Largest difference here").wait_for(timeout=30_000)
    assert page.locator(".changes li.changed").count() >= 1

    page.get_by_role("tab", name="Files").click()
    page.get_by_role("button", name="New file").click()
    page.locator("dialog input[name=name]").fill("a/../b")
    page.get_by_role("button", name="Create").click()
    page.get_by_text("not every system takes").wait_for()
    page.locator("dialog input[name=name]").fill("made")
    page.get_by_role("button", name="Create").click()
    opened(page, "made.frb")
    page.locator("header select").select_option("base.frb")
    opened(page, "base.frb")
    until(lambda: text_of(page).startswith("# mine\n"), "what was not saved")


AXE = Path(__file__).parents[2] / "editors/designer/node_modules/axe-core/axe.min.js"


@pytest.mark.skipif(not AXE.exists(), reason="axe-core is not installed (make designer)")
def test_no_serious_fault_of_accessibility(served, browser):
    for name, scheme in (("pd7", "light"), ("tipper", "dark")):
        address = put(served, f"axe-{name}.frb", shipped(f"{name}.frb").read_text())[1]
        context = browser.new_context(bypass_csp=True, color_scheme=scheme)
        page = context.new_page()
        page.goto(address)
        until(lambda page=page: page.evaluate("!!window.designer?.store.scene"), "a picture")
        page.evaluate(AXE.read_text())
        found = []
        for view in page.get_by_role("tab").all():
            view.click()
            page.wait_for_timeout(300)
            run = "axe.run(document, { resultTypes: ['violations'] })"
            found += page.evaluate(run)["violations"]
        context.close()
        serious = [each for each in found if each["impact"] in {"serious", "critical"}]
        assert [(each["id"], each["nodes"][0]["html"]) for each in serious] == []


def test_a_written_page_needs_nothing(window, tmp_path):
    (tmp_path / "pd7.html").write_text(page_of(shipped("pd7.frb")))
    page = window((tmp_path / "pd7.html").as_uri())
    requests = []
    page.on("request", lambda request: requests.append(request.url))
    model = fuzzyarm.load(shipped("pd7.frb"))
    assert value_at(page, 1.3, -2.2) == fuzzyarm.infer(model, e=1.3, ce=-2.2)["u"]
    drag(page, 'circle[data-variable="e"][data-term="ZE"]', 40)
    listing = page.locator("pre.listing")
    until(lambda: "term e ZE: triangle -2 " in listing.text_content(), "the text follows")
    Path(tmp_path / "again.frb").write_text(listing.text_content())
    changed = fuzzyarm.load(tmp_path / "again.frb")
    expected = fuzzyarm.infer(changed, e=1.3, ce=-2.2)["u"]
    assert value_at(page, 1.3, -2.2) == pytest.approx(expected, abs=1e-12)
    assert requests == []
