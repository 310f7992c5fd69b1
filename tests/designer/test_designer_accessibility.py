"""axe-core in every view of every kind of file: light and dark, wide and narrow.

In the suite each kind of file has one size and one scheme, and each of these is there; with
``--thorough`` each kind has all four.
"""

from pathlib import Path

import pytest
from budget import crossed
from needs import requires
from test_designer_learning import SOC
from test_designer_page import put, until

from fuzzyarm.base.shipped_files import shipped

AXE = Path(__file__).parents[2] / "editors/designer/node_modules/axe-core/axe.min.js"

pytestmark = [
    pytest.mark.slow,
    requires("chromium"),
    requires("axe-core"),
]

SIZES = {"wide": (1280, 720), "narrow": (420, 800)}

EVERYTHING = """\
rulebase everything "a grid, sentences, findings, and terms between two functions"
input a 0 .. 10
input b 0 .. 10
output y 0 .. 10
terms a, b: triangles LOW HIGH
term y LOW: gaussian 2 2 over gaussian 2 1
term y HIGH: gaussian 8 2 over gaussian 8 1
inference y: defuzzifier karnik-mendel(51)
rules y
  a \\ b  LOW   HIGH
  LOW    HIGH  LOW
rule if a is HIGH and b is LOW then y is LOW
rule if a is HIGH and b is LOW then y is LOW
"""

BUSY = """() => {
  document.querySelector("text[data-variable=y]").focus();
  const selects = [...document.querySelectorAll(".surface .bar select")].slice(-2);
  const order = document.querySelector(".inference select");
  for (const [select, to] of [[selects[0], "contour"], [selects[1], "x"], [order, "text"]]) {
    select.value = to;
    select.dispatchEvent(new Event("change"));
  }
  document.querySelector(".rules li button.small").click();
}"""


def violations(page):
    """Return what axe-core calls serious or critical, with the element."""
    found = page.evaluate("axe.run(document, { resultTypes: ['violations'] })")["violations"]
    return [
        (each["id"], node["html"][:200])
        for each in found
        if each["impact"] in {"serious", "critical"}
        for node in each["nodes"]
    ]


FILES = {
    "rules": ("axe.frb", EVERYTHING),
    "controller": ("axe-soc.frb", SOC),
    "table": ("axe.lut", shipped("thesis-6.1.lut").read_text()),
}


@pytest.fixture
def opened(served, browser):
    """Open a file in a page that axe-core has been put into."""
    contexts = []

    def opened(kind, size, scheme):
        width, height = SIZES[size]
        context = browser.new_context(
            bypass_csp=True, color_scheme=scheme, viewport={"width": width, "height": height}
        )
        contexts.append(context)
        page = context.new_page()
        page.goto(put(served, *FILES[kind])[1])
        until(lambda: page.evaluate("!!window.designer?.desks?.size"), "a page")
        page.evaluate(AXE.read_text())
        return page

    yield opened
    for context in contexts:
        context.close()


def look(page, what):
    """Return the violations, each with what is looked at."""
    page.wait_for_timeout(150)  # what has been asked for is drawn
    return [(what, *each) for each in violations(page)]


def look_at_all(page):
    """Return the violations of every view, by its tab."""
    tabs, found = page.locator("header [role=tab]"), []
    for i in range(tabs.count()):
        tabs.nth(i).evaluate("tab => tab.click()")
        found += look(page, tabs.nth(i).inner_text())
    return found


@pytest.mark.parametrize(("kind", "size", "scheme"), crossed(FILES, SIZES, ["light", "dark"]))
def test_no_serious_fault_in_any_view(opened, kind, size, scheme):
    """Of a rule base as it opens, with everything in use, and every view; of others every view."""
    page, found = opened(kind, size, scheme), []
    if kind == "rules":
        until(lambda: page.evaluate("!!designer.store.scene"), "a picture")
        found += look(page, "as it opens")
        assert page.locator(".rules .sign").count() >= 1
        page.evaluate(BUSY)
        found += look(page, "everything in use")
    else:
        until(lambda: page.evaluate("designer.text.settled()"), "open")
    assert [*found, *look_at_all(page)] == []
