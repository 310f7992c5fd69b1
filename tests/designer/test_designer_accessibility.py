"""axe-core in every view of every kind of file: light and dark, wide and narrow.

In the suite each size has one scheme and each scheme one size; with ``--thorough`` all four.
"""

from pathlib import Path

import pytest
from budget import crossed
from test_designer_learning import SOC
from test_designer_page import CHROMIUM, put, until

from fuzzyarm.shipped_files import shipped

AXE = Path(__file__).parents[2] / "editors/designer/node_modules/axe-core/axe.min.js"

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(CHROMIUM is None, reason="no chromium"),
    pytest.mark.skipif(not AXE.exists(), reason="axe-core is not installed (make page-tools)"),
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


@pytest.fixture(params=crossed(SIZES, ["light", "dark"]), ids="-".join)
def opened(request, browser):
    """Open an address in a page that axe-core has been put into."""
    size, scheme = request.param
    width, height = SIZES[size]
    context = browser.new_context(
        bypass_csp=True, color_scheme=scheme, viewport={"width": width, "height": height}
    )

    def opened(address):
        page = context.new_page()
        page.goto(address)
        until(lambda: page.evaluate("!!window.designer?.desks?.size"), "a page")
        page.evaluate(AXE.read_text())
        return page

    yield opened
    context.close()


def look(page, what):
    """Return the violations, each with what is looked at."""
    page.wait_for_timeout(150)  # what has been asked for is drawn
    return [(what, *each) for each in violations(page)]


def look_at_all(page):
    """Return the violations of every view, by its tab."""
    tabs, found = page.locator("header [role=tab]"), []
    for i in range(tabs.count()):
        tabs.nth(i).click()
        found += look(page, tabs.nth(i).inner_text())
    return found


def test_no_serious_fault_in_any_view_of_a_rule_base(served, opened):
    """As it opens, with everything in use, and every view."""
    page = opened(put(served, "axe.frb", EVERYTHING)[1])
    until(lambda: page.evaluate("!!designer.store.scene"), "a picture")
    first = look(page, "as it opens")
    assert page.locator(".rules .sign").count() >= 1
    page.evaluate(BUSY)
    assert [*first, *look(page, "everything in use"), *look_at_all(page)] == []


@pytest.mark.parametrize("kind", ["controller", "table"])
def test_no_serious_fault_in_any_view_of_other_files(served, opened, kind):
    name, text = {
        "controller": ("axe-soc.frb", SOC),
        "table": ("axe.lut", shipped("thesis-6.1.lut").read_text()),
    }[kind]
    page = opened(put(served, name, text)[1])
    until(lambda: page.evaluate("designer.text.settled()"), "open")
    assert look_at_all(page) == []
