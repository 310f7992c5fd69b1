"""The page of a playground in a browser, without any network but its own folder.

One visitor does most of it in one page, from the first letter to a compiled file: a Python is not
started anew for each of them.
"""

import functools
import http.server
import json
import os
import re
import subprocess
import threading
import time
from pathlib import Path

import pytest
from budget import cases, crossed
from needs import program, requires

from fuzzyarm.apps.native import build
from fuzzyarm.apps.playground.folder import wasm_kernels, write_playground
from fuzzyarm.apps.playground.memory import python_memory

sync_api = pytest.importorskip("playwright.sync_api")

CHROMIUM = program("chromium")
ROOT = Path(__file__).parents[2]
PYODIDE = ROOT / "editors/designer/node_modules/pyodide"
AXE = ROOT / "editors/designer/node_modules/axe-core/axe.min.js"
PATIENCE = 100.0  # s: other tests run beside

pytestmark = [
    pytest.mark.slow(seconds=15),  # all of them: another worker would write the folder again
    requires("chromium"),
    requires("pyodide"),
]


class Quiet(http.server.SimpleHTTPRequestHandler):
    """Serves a folder as any web server does."""

    def log_message(self, *_words):
        pass


class Site:
    """A folder that is served."""

    def __init__(self, folder):
        handler = functools.partial(Quiet, directory=str(folder))
        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        self.address = f"http://127.0.0.1:{self.server.server_port}/"

    def stop(self):
        self.server.shutdown()
        self.server.server_close()


def kernels():
    """Compile the kernels, in the suite without optimisation: 1 s in place of 8."""
    with pytest.MonkeyPatch.context() as patch:
        if not cases(0, 1):
            flags = [each for each in build.FLAGS if each != "-O3"]
            patch.setattr(build, "FLAGS", (*flags, "-O0", "-fno-sanitize=undefined"))
        return wasm_kernels()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """What the command has made (FUZZYARM_PLAYGROUND=FOLDER), or a folder that is made now."""
    if made := os.environ.get("FUZZYARM_PLAYGROUND"):
        return ROOT / made
    folder = tmp_path_factory.mktemp("playground")
    write_playground(folder, pyodide=PYODIDE, kernels=kernels, memory=python_memory)
    return folder


@pytest.fixture(scope="module")
def site(folder):
    site = Site(folder)
    yield site
    site.stop()


@pytest.fixture(scope="module")
def chromium():
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def visitor(chromium):
    """The browser of somebody who was never here."""
    context = chromium.new_context()
    context.set_default_timeout(PATIENCE * 1000)
    yield context
    context.close()


@pytest.fixture(scope="module")
def page(chromium, site):
    """A page that is ready; what it loads from elsewhere, and what fails in it, fails the tests."""
    context = chromium.new_context(viewport={"width": 1400, "height": 900})
    context.set_default_timeout(PATIENCE * 1000)
    page = context.new_page()
    elsewhere, wrong = [], []
    page.on("request", lambda request: elsewhere.append(request.url))
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("console", lambda said: said.type == "warning" and wrong.append(said.text))
    page.goto(site.address)
    ready(page)
    yield page
    own = (site.address, "blob:", "data:")
    assert [each for each in elsewhere if not each.startswith(own)] == []
    assert wrong == []
    context.close()


def until(page, what):
    """Wait for what an expression of JavaScript says."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        try:
            found = page.evaluate(what)
        except sync_api.Error as error:  # the page is being loaded anew
            if "context was destroyed" not in str(error):
                raise
            found = None
        if found:
            return found
        page.wait_for_timeout(50)
    raise AssertionError(f"not so after {PATIENCE} s: {what}")


def ready(page):
    until(page, "performance.getEntriesByName('ready').length && !!window.designer.store.scene")


def typed(page, text):
    """Put a text into the editor, as a hand does."""
    page.click(".cm-content")
    page.keyboard.press("Control+a")
    page.keyboard.insert_text(text)


def turned_to(page, file):
    page.evaluate("file => { location.hash = `#${new URLSearchParams({ file })}`; }", file)
    until(page, f"document.title.startsWith('{file}') && window.designer.text.settled()")


RULES = """rulebase cooler "how fast"

input  heat  0 .. 40
output speed 0 .. 10

terms heat: triangles cold mild hot
terms speed: triangles slow middle fast

rule if heat is cold then speed is slow
rule if heat is mild then speed is middle
rule if heat is hot then speed is fast
"""

SCENE = "() => JSON.stringify(window.designer.store.scene)"

NUMBERS = """() => {
  const engine = window.designer.store.engine, found = [];
  for (let k = 0; k < 1000; k++) found.push(engine.at([k * 40 / 999])[0]);
  return found;
}"""

PROGRAM = """#include <stdio.h>
#include "fan.h"
int main(void) {{
  for (int k = 0; k < 1000; k++) printf("%.17g\\n", (double){call}(k * 40.0 / 999));
  return 0;
}}
"""


def test_a_rule_base_from_nothing_to_c(page, tmp_path):
    page.get_by_role("tab", name="Files").click()
    page.get_by_role("button", name="New file").click()
    page.locator("dialog input[name=name]").fill("fan")
    page.get_by_role("button", name="Create").click()
    until(page, "document.title.startsWith('fan.frb') && !!window.designer.text.state().epoch")
    page.get_by_role("tab", name="Design").click()
    typed(page, RULES)
    until(page, "window.designer.store.sound && window.designer.store.scene?.name === 'cooler'")

    # It is broken, which is said where it stands; then it is mended.
    typed(page, RULES.replace("speed is fast", "speed is fsat"))
    until(page, "!window.designer.store.sound")
    page.locator(".findings").get_by_text("fsat").first.wait_for()
    typed(page, RULES)
    until(page, "window.designer.store.sound")

    # A term is moved by hand, and the text follows.
    before = page.evaluate(SCENE)
    handle = page.locator(".view-design svg circle").nth(1)
    box = handle.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 25, y, steps=5)
    page.mouse.up()
    until(page, f"window.designer.text.state().text !== {RULES!r}")
    until(page, f"window.designer.text.settled() && ({SCENE})() !== {json.dumps(before)}")
    assert "term heat mild" in page.evaluate("window.designer.text.state().text")

    # The C of the page, compiled, has the numbers of the page.
    page.get_by_role("tab", name="Files").click()
    page.get_by_role("button", name="C header").click()
    assert page.locator("dialog").get_by_label("Computed from").input_value() == "rules"
    page.locator("dialog").get_by_label("Precision").select_option("float64")
    with page.expect_download() as loading:
        page.get_by_role("button", name="Export", exact=True).click()
    loading.value.save_as(tmp_path / "fan.h")
    page.get_by_role("button", name="Close").click()
    assert printed(tmp_path, "fan_speed") == page.evaluate(NUMBERS)


def printed(folder, call):
    """Return what a program prints that calls a function of ``fan.h`` for 1,000 inputs."""
    (folder / "main.c").write_text(PROGRAM.format(call=call), encoding="utf-8")
    words = ["gcc", "-O1", "-ffp-contract=off", "main.c", "-o", "main", "-lm"]
    subprocess.run(words, cwd=folder, check=True)
    done = subprocess.run([folder / "main"], capture_output=True, text=True, check=True)
    return list(map(float, done.stdout.split()))


@requires("ziglang")  # in plain Python the kernels take minutes in a browser
def test_the_motor_runs(page):
    turned_to(page, "servo.frb")
    page.get_by_role("tab", name="Run").click()
    until(page, "document.querySelectorAll('.run-form select')[1]?.value === 'motor'")
    page.locator(".run").get_by_role("button", name="Start").click()
    page.get_by_text("the time asked for").wait_for()
    final = page.locator(".metrics tr", has=page.get_by_role("rowheader", name="final"))
    assert abs(float(final.locator("td").text_content().split()[0])) < 1e-3
    assert re.match(r"2 ", page.locator("output.clock").text_content())


DROP = """([name, text]) => {
  const data = new DataTransfer();
  const bytes = Uint8Array.from(text, (each) => each.charCodeAt(0));
  data.items.add(new File([bytes], name));
  const drop = { dataTransfer: data, bubbles: true, cancelable: true };
  document.body.dispatchEvent(new DragEvent("drop", drop));
}"""


def test_a_dropped_file_is_converted_or_refused(page):
    fis = (ROOT / "tests/formats/data/tipper_matlab.fis").read_text(encoding="utf-8")
    page.evaluate(DROP, ["t.fis", fis])
    page.get_by_role("dialog", name="t.fis is now t.frb").wait_for()
    page.get_by_role("button", name="Close").click()
    until(page, "document.title.startsWith('t.frb') && !!window.designer.store.scene")
    page.evaluate(DROP, ["picture.frb", "\xff\xd8" * 90])
    refused = page.get_by_role("dialog", name="picture.frb is not imported")
    refused.get_by_text("not UTF-8: byte 0xff").wait_for()
    page.get_by_role("button", name="Close").click()
    assert page.title().startswith("t.frb")


def text_of(page):
    return page.evaluate("window.designer?.text.state().text")


def test_a_link_carries_the_files_and_a_damaged_one_is_told_until_it_is_read(page, visitor, site):
    turned_to(page, "pd7.frb")
    until(page, "window.designer.store.sound")
    typed(page, page.evaluate("window.designer.text.state().text") + "# mine\n")
    until(page, "window.designer.text.settled()")
    turned_to(page, "servo.frb")
    page.get_by_role("button", name="Link").click()
    address = page.input_value("dialog input[name=address]")
    page.get_by_role("button", name="Cancel").click()
    # Somebody else has a rule base of that name already, which stays; the controller uses its own.
    guest = visitor.new_page()
    guest.goto(address)
    dialog = guest.get_by_role("dialog", name="Link")
    dialog.get_by_text("that of the link is now pd7-2.frb").wait_for()
    dialog.get_by_role("button", name="Close").click()
    assert guest.evaluate("location.hash") == "#file=servo-2.frb"
    assert 'from "pd7-2.frb"' in text_of(guest)
    before = guest.evaluate("({ ...localStorage })")
    assert before["fuzzyarm playground: pd7-2.frb"].endswith("# mine\n")
    assert not before["fuzzyarm playground: pd7.frb"].endswith("# mine\n")
    guest.goto("about:blank")
    guest.goto(f"{address[:-9]}AAAA{address[-5:]}")
    ready(guest)
    guest.get_by_role("dialog", name="Link").get_by_text("The link is damaged").wait_for()
    assert guest.evaluate("({ ...localStorage })") == before


def stored(page, name):
    return page.evaluate(f"localStorage.getItem('fuzzyarm playground: {name}')")


def test_files_keep_their_texts_when_they_are_turned_to_and_renamed_in_the_list(visitor, site):
    page = visitor.new_page()
    page.goto(site.address)
    ready(page)
    names = ("pd7.frb", "servo.frb", "tipper.frb")
    texts = {name: stored(page, name) for name in names}
    for name in (*names, *names):  # the second time each has a desk, which was left in this view
        page.get_by_role("tab", name="Files").click()
        page.locator(".files").get_by_role("button", name=name, exact=True).click()
        until(page, f"document.title.startsWith('{name}') && window.designer.text.settled()")
        assert text_of(page) == texts[name]
    page.get_by_role("tab", name="Files").click()
    page.get_by_role("button", name="Rename tipper.frb").click()
    page.locator("dialog input[name=name]").fill("tip.frb")
    page.locator("dialog").get_by_role("button", name="Rename").click()
    until(page, "document.title.startsWith('tip.frb')")
    turned_to(page, "pd7.frb")
    page.wait_for_timeout(400)  # until a text is kept that has been changed
    assert [stored(page, name) for name in ("pd7.frb", "servo.frb", "tip.frb")] == [*texts.values()]
    assert stored(page, "tipper.frb") is None


def test_of_two_tabs_on_a_file_one_writes_and_no_text_is_lost(visitor, site):
    one, two = visitor.new_page(), visitor.new_page()
    one.goto(f"{site.address}#file=tipper.frb")
    two.goto(f"{site.address}#file=pd7.frb")
    for page in (one, two):
        ready(page)
    # On different files both write.
    typed(two, "# two\n" + text_of(two))
    until(two, "localStorage.getItem('fuzzyarm playground: pd7.frb').startsWith('# two')")
    turned_to(two, "tipper.frb")
    two.get_by_text("this one follows").wait_for()
    text = "# the work of an hour\n" + text_of(one)
    typed(one, text)
    until(two, f"window.designer.text.state().text === {text!r}")
    two.click(".cm-content")
    two.keyboard.type("x")
    assert text_of(two) == text
    until(two, f"localStorage.getItem('fuzzyarm playground: tipper.frb') === {text!r}")
    two.get_by_role("tab", name="Files").click()
    two.get_by_role("button", name="Delete tipper.frb").click()
    two.get_by_role("dialog").get_by_role("button", name="Delete").click()
    two.get_by_role("dialog").get_by_text("Another window writes").wait_for()
    two.get_by_role("button", name="Cancel").click()

    # The other one writes: what was typed in the moment before goes along.
    typed(one, "# and a minute\n" + text)
    two.get_by_role("button", name="Write here").click()
    until(two, f"window.designer.text.state().text === {'# and a minute' + chr(10) + text!r}")
    one.get_by_text("this one follows").wait_for()
    two.get_by_text("this one follows").wait_for(state="hidden")
    typed(two, "# two\n" + text)
    until(one, f"window.designer.text.state().text === {'# two' + chr(10) + text!r}")
    two.close()
    one.get_by_text("this one follows").wait_for(state="hidden")
    typed(one, "# one again\n")
    until(one, "localStorage.getItem('fuzzyarm playground: tipper.frb') === '# one again\\n'")


def test_without_webassembly_the_texts_are_shown(visitor, site):
    visitor.add_init_script("delete window.WebAssembly")
    page = visitor.new_page()
    page.goto(site.address)
    assert "no WebAssembly" in page.inner_text("[role=alert]")
    assert "rulebase pd7" in page.inner_text("main")


def test_without_python_nothing_speaks_of_a_server_and_it_is_said_who_writes(visitor, site):
    visitor.route("**/fuzzyarm.zip", lambda route: route.abort())
    one, two = visitor.new_page(), visitor.new_page()
    for page in (one, two):
        page.goto(f"{site.address}#file=tipper.frb")
        page.locator(".banner").get_by_text("Python does not run here").wait_for()
    two.locator(".banner").get_by_text("Another window writes this file").wait_for()
    two.get_by_role("button", name="Write here").wait_for()
    assert one.locator(".banner").get_by_text("Another window").count() == 0
    one.get_by_role("button", name="Link").click()
    dialog = one.get_by_role("dialog", name="Link")
    dialog.get_by_text("Python does not run here").wait_for()
    for page in (one, two):
        assert page.get_by_text("server").count() == 0


def test_a_browser_that_cannot_wait_checks_and_says_what_a_run_needs(visitor, site):
    def without_waiting(route):
        script = "delete WebAssembly.Suspending; delete WebAssembly.promising;\n"
        route.fulfill(body=script + route.fetch().text(), content_type="text/javascript")

    visitor.route("**/python.js", without_waiting)
    page = visitor.new_page()
    page.goto(f"{site.address}#file=servo.frb")
    until(page, "performance.getEntriesByName('ready').length && window.designer.text.settled()")
    page.get_by_role("tab", name="Run").click()
    until(page, "document.querySelectorAll('.run-form select')[1]?.value === 'motor'")
    page.locator(".run").get_by_role("button", name="Start").click()
    page.get_by_text("a run needs a browser that lets WebAssembly wait").wait_for()


def test_it_is_there_without_a_network(visitor, folder):
    site = Site(folder)
    page = visitor.new_page()
    page.goto(site.address)
    typed(page, RULES)
    until(page, "performance.getEntriesByName('ready').length && window.designer.text.settled()")
    until(page, "navigator.serviceWorker.controller !== null")
    site.stop()
    page.reload()
    ready(page)
    assert page.evaluate("window.designer.text.state().text") == RULES
    assert page.evaluate("window.designer.store.scene.name") == "cooler"


SIZES = [(1280, 720), (420, 800)]


@requires("axe-core")
def test_everybody_can_use_it(page):
    """No serious fault in any view of a controller: light and dark, wide and narrow.

    In the suite each size has one theme; with ``--thorough`` both. The page starts light.
    """
    turned_to(page, "servo.frb")
    page.evaluate(AXE.read_text(encoding="utf-8"))
    tabs, found = page.locator("header [role=tab]"), []
    theme = "light"
    for wanted, (width, height) in crossed(["light", "dark"], SIZES):
        if theme != wanted:
            page.locator("header").get_by_role("button", name="Dark").click()
            theme = wanted
        page.set_viewport_size({"width": width, "height": height})
        for i in range(tabs.count()):
            tabs.nth(i).evaluate("tab => tab.click()")
            page.wait_for_timeout(150)  # what has been asked for is drawn
            found += [(theme, width, i, *each) for each in violations(page)]
    assert found == []


def violations(page):
    """Return what axe-core calls serious or critical, with the element."""
    found = page.evaluate("axe.run(document, { resultTypes: ['violations'] })")["violations"]
    return [
        (each["id"], node["html"][:200])
        for each in found
        if each["impact"] in {"serious", "critical"}
        for node in each["nodes"]
    ]
