"""The designer at any width, its borders moved by hand and by keys, and its help."""

import json
import subprocess

import pytest
from budget import part
from needs import requires
from test_designer_page import Served, becomes, box_of, further, put, until

from fuzzyarm.apps.designer.assets import asset
from fuzzyarm.base.shipped_files import shipped

SPLITS = """
import { shareAt, shareBy, sizesOf } from "./split.js";
console.log(JSON.stringify([
  shareAt(404, 0, 200, 8, 600), shareAt(-50, 0, 200, 8, 600), shareAt(9000, 0, 200, 8, 600),
  shareBy("ArrowRight", 0.5, 0.35, true), shareBy("ArrowDown", 0.5, 0.35, true),
  shareBy("ArrowUp", 0.5, 0.35, false), shareBy("ArrowLeft", 0.5, 0.35, false),
  shareBy("Home", 0.5, 0.35, true), shareBy("Enter", 0.5, 0.35, true),
  shareBy("a", 0.5, 0.35, true),
  sizesOf("120px 8px 300.5px"),
]));
"""


@requires("node")
def test_a_border_shares_its_room_and_leaves_some_to_both(tmp_path):
    (tmp_path / "geometry").mkdir()
    for name in ("split.js", "draw.js", "strings.js", "geometry/chart.js"):
        (tmp_path / name).write_bytes(asset(name)[0])
    (tmp_path / "package.json").write_text('{"type": "module"}')
    (tmp_path / "run.js").write_text(SPLITS)
    done = subprocess.run(
        ["node", str(tmp_path / "run.js")], capture_output=True, text=True, check=True, timeout=60
    )
    assert json.loads(done.stdout) == [
        0.5, 0.08, 0.92, 0.52, None, 0.48, None, 0.08, 0.35, None, [120, 8, 300.5],
    ]  # fmt: skip


VIEWS = ("Design", "Run", "Table", "Learn", "Tune", "Compare", "Files")
FILES = {"Run": "servo.frb", "Learn": "servo.frb", "Tune": "servo.frb"}

# What is cut off: words in a box that hides what does not fit, and controls beyond the window.
CUT = """() => [...document.querySelectorAll(
  "button, select, input, label, summary, h1, h2, th, p")]
  .filter((e) => e.offsetParent && !e.closest(".cm-editor") && !e.classList.contains("unseen"))
  .filter((e) => {
    const { left, right } = e.getBoundingClientRect();
    const hides = getComputedStyle(e).overflowX !== "visible" && e.scrollWidth > e.clientWidth + 1;
    const pane = e.closest(".pane")?.getBoundingClientRect();
    const beyond = e.matches("input, select, button") && pane && right > pane.right + 1
      && e.closest("table") === null;
    return hides || beyond || right > innerWidth + 1 || left < -1;
  }).map((e) => `${e.tagName} ${e.className} ${e.textContent || e.value}`.slice(0, 60))"""


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    server = Served(tmp_path_factory.mktemp("sizes"))
    for name in ("pd7", "servo", "tipper", "tipper2"):
        put(server, f"{name}.frb", shipped(f"{name}.frb").read_text())
    yield server
    server.stop()


def opened(context, served, file):
    page = context.new_page()
    page.goto(f"{served.address}#file={file}")
    page.get_by_text("no findings").first.wait_for()
    return page


@requires("chromium")
@pytest.mark.slow
@pytest.mark.parametrize("width", part([390, 1024, 1440, 3840], 3))
def test_no_view_is_wider_than_the_window_and_no_field_is_cut(served, browser, width):
    context = browser.new_context(viewport={"width": width, "height": max(768, width * 9 // 16)})
    pages = {file: opened(context, served, file) for file in ("pd7.frb", "servo.frb")}
    for view in VIEWS:
        page = pages[FILES.get(view, "pd7.frb")]
        page.bring_to_front()
        further(page, view)
        page.wait_for_timeout(500)
        wide = "document.documentElement.scrollWidth"
        until(lambda page=page, wide=wide: page.evaluate(wide) <= width, f"{view} in the window")
        becomes(lambda page=page, view=view: (view, page.evaluate(CUT)), (view, []))
    page = pages["pd7.frb"]
    page.bring_to_front()
    page.get_by_role("button", name="Help and keys").click()
    box = box_of(page.locator("dialog.help"))
    assert box["x"] >= 0
    assert box["x"] + box["width"] <= width
    context.close()


@pytest.fixture
def narrow(browser):
    context = browser.new_context(viewport={"width": 400, "height": 800})
    yield context
    context.close()


@requires("chromium")
@pytest.mark.slow
def test_both_ends_of_a_strength_are_shown(served, narrow):
    page = opened(narrow, served, "tipper2.frb")
    page.evaluate("[0, 1].forEach((i) => designer.store.setPoint(i, 6))")
    strengths = page.locator(".rules-fired .degree")
    until(lambda: "0.00348 … 0.0" in "".join(strengths.all_text_contents()), "the rules")
    wide = "all => all.map((each) => each.scrollWidth - each.clientWidth)"
    becomes(lambda: set(strengths.evaluate_all(wide)), {0})


@requires("chromium")
@pytest.mark.slow
@pytest.mark.parametrize("view", ["Sweep", "Prove", "Fit"])
def test_a_form_in_a_narrow_window_is_as_high_as_its_fields(served, narrow, view):
    page = opened(narrow, served, "pd7.frb" if view == "Fit" else "servo.frb")
    further(page, view)
    said = page.locator(f"#view-{view.lower()} .asked > .body")
    said.get_by_role("button", name="Start" if view == "Sweep" else view).wait_for()
    until(lambda: said.evaluate("each => each.scrollHeight <= each.clientHeight"), "all of it")


# Whether the first option in a text stays on one line at any width.
UNBROKEN = """(pre) => {
  const walk = document.createTreeWalker(pre, NodeFilter.SHOW_TEXT), range = document.createRange();
  let node = walk.nextNode();
  while (!node.data.includes("--levels")) node = walk.nextNode();
  const at = node.data.indexOf("--levels");
  range.setStart(node, at);
  range.setEnd(node, at + 8);
  for (let width = 100; width < 400; width++) {
    pre.style.width = `${width}px`;
    if (new Set([...range.getClientRects()].map((box) => box.top)).size > 1) return width;
  }
  return "unbroken";
}"""


@requires("chromium")
@pytest.mark.slow
def test_the_name_of_an_option_is_not_broken(served, narrow):
    page = opened(narrow, served, "pd7.frb")
    further(page, "Table")
    report = page.locator(".accuracy pre.printed")
    until(lambda: "--levels" in report.text_content(), "the report")
    assert report.evaluate(UNBROKEN) == "unbroken"


# What does not stand on the line that it belongs to, or touches the border of its pane.
BROKEN = """() => {
  const wrong = [], box = (e) => e.getBoundingClientRect();
  for (const bar of document.querySelectorAll(".terms > .bar, .rules li")) {
    const [first, ...others] = [...bar.children].filter((e) => box(e).width > 0);
    for (const each of others) if (box(each).top >= box(first).bottom) wrong.push(each.textContent);
  }
  for (const head of document.querySelectorAll(".terms .head")) {
    const [name, role] = head.children;
    if (box(role).left - box(name).right < 4) wrong.push(head.textContent);
  }
  const left = box(document.querySelector(".pane.rules")).left;
  for (const words of document.querySelectorAll(".rules caption")) {
    if (box(words).left - left < 5) wrong.push(words.textContent);
  }
  return wrong;
}"""


IN_ONE_LINE = """() => [...document.querySelectorAll(".terms .head")].every((head) => {
  const boxes = [...head.children].map((e) => e.getBoundingClientRect());
  const seen = boxes.filter((box) => box.width && box.height);
  const [top, bottom] = [seen.map((box) => box.top), seen.map((box) => box.bottom)];
  const right = Math.max(...seen.map((box) => box.right));
  return Math.max(...top) < Math.min(...bottom) && right <= head.getBoundingClientRect().right;
})"""


@requires("chromium")
@pytest.mark.slow
@pytest.mark.parametrize("file", ["pd7.frb", "tipper.frb"])
def test_three_plots_fit_into_a_laptops_window_and_lines_are_not_broken(served, browser, file):
    context = browser.new_context()
    page = opened(context, served, file)
    plots = page.locator(".terms .plots")
    becomes(plots.locator("svg").count, 3)
    until(lambda: plots.evaluate("e => e.scrollHeight <= e.clientHeight"), "three plots")
    plots.locator("text[data-term]").first.focus()  # the line of numbers takes room of its own
    page.locator(".terms .details strong").wait_for()
    until(lambda: plots.evaluate("e => e.scrollHeight <= e.clientHeight"), "and the line")
    becomes(lambda: page.evaluate(BROKEN), [])
    for width in (1024, 390):
        page.set_viewport_size({"width": width, "height": 768})
        until(lambda: page.evaluate(IN_ONE_LINE), f"names and tools of variables at {width}")
    context.close()


@requires("chromium")
@pytest.mark.slow
def test_borders_are_dragged_moved_by_keys_and_remembered(served, browser):
    context = browser.new_context()
    page = opened(context, served, "pd7.frb")

    def size(name, side):
        return box_of(page.locator(f".{name}").first)[side]

    def is_wide(width):
        becomes(lambda: size("text", "width"), pytest.approx(width, abs=2))

    border = page.locator("main > .split")
    before, box = size("text", "width"), box_of(border)
    page.mouse.move(box["x"] + 4, box["y"] + 200)
    page.mouse.down()
    page.mouse.move(box["x"] + 124, box["y"] + 200, steps=4)
    page.mouse.up()
    is_wide(before + 120)
    page.reload()
    page.get_by_text("no findings").first.wait_for()
    is_wide(before + 120)

    rows = page.locator(".view-design > .split.rows")
    height = size("terms", "height")
    rows.focus()
    page.keyboard.press("ArrowUp")
    page.keyboard.press("PageUp")
    until(lambda: size("terms", "height") < 0.8 * height, "the border has moved")
    assert int(rows.get_attribute("aria-valuenow")) == 38
    page.locator("header select").select_option("tipper.frb")  # other files have the same borders
    until(lambda: page.title().startswith("tipper.frb"), "turned")
    until(lambda: size("terms", "height") < 0.8 * height, "its panes")
    rows = page.locator(".view-design > .split.rows")
    rows.focus()
    page.keyboard.press("Enter")
    becomes(lambda: size("terms", "height"), pytest.approx(height, abs=2))
    page.locator("main > .split").dblclick()
    is_wide(before)
    page.reload()
    page.get_by_text("no findings").first.wait_for()
    is_wide(before)
    context.close()


@requires("chromium")
@pytest.mark.slow
def test_help_opens_by_its_button_and_its_keys_but_is_typed_in_the_text(served, browser, tmp_path):
    context = browser.new_context()
    page = opened(context, served, "pd7.frb")
    dialog = page.locator("dialog.help")
    for key in ("?", "F1"):
        page.locator("header [role=tab]").first.focus()
        page.keyboard.press(key)
        dialog.get_by_text("Design: terms").wait_for()
        page.keyboard.press("Escape")
        until(lambda: dialog.count() == 0, "the help closes")
    for name in ("tipper.frb", "pd7.frb"):  # a page has one help, not one a file
        page.locator("header select").select_option(name)
        until(lambda name=name: page.title().startswith(name), f"turned to {name}")
    page.locator("header [role=tab]").first.focus()
    page.keyboard.press("?")
    dialog.first.wait_for()
    assert dialog.count() == 1
    page.keyboard.press("Escape")
    becomes(dialog.count, 0)
    page.evaluate("designer.text.goTo([0, 0])")
    page.keyboard.press("?")
    assert page.evaluate("designer.text.view.state.doc.toString()").startswith("?")
    assert dialog.count() == 0
    page.keyboard.press("Control+z")
    context.close()
