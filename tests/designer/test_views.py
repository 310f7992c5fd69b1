"""Each view of the designer opens, by mouse: the one test in a browser of ``make quick``."""

from needs import requires
from test_designer_page import CHROMIUM, Served, further, sync_api, until

from fuzzyarm.base.shipped_files import shipped

pytestmark = requires("chromium")

SIGNS = {
    "servo.frb": {
        "Design": ".diagram svg [role=button], .diagram svg a, .diagram svg rect",
        "Run": ".run-form button.main:enabled",
        "Sweep": "#view-sweep button.main:enabled",
        "Tune": "#view-tune button.main:enabled",
        "Learn": "#view-learn p.said:has-text('table that learns')",
        "Prove": "#view-prove button.main:enabled",
        "Margins": "#view-margins button.main:enabled",
        "Compare": ".compare .bar select option[value='pd7.frb']",
        "Files": ".folder .files tr.here",
    },
    "pd7.frb": {
        "Design": ".terms svg",
        "Table": ".accuracy .worst:has-text('Proved')",
        "Fit": "#view-fit button.main:enabled",
    },
}
"""File → view → an element that is there once the view has its answer."""


def test_each_view_opens_and_says_what_may_be_done(tmp_path):
    for name in SIGNS:
        (tmp_path / name).write_text(shipped(name).read_text())
    served, faults = Served(tmp_path), []
    try:
        with sync_api.sync_playwright() as playwright:
            chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
            page = chromium.new_page(viewport={"width": 1280, "height": 720})
            page.on("pageerror", lambda error: faults.append(str(error)))
            for name, views in SIGNS.items():
                page.goto(f"{served.address}#file={name}")
                until(lambda name=name: page.title().startswith(name), name)
                for view, sign in views.items():
                    further(page, view)
                    page.locator(sign).first.wait_for(state="attached", timeout=60_000)
            chromium.close()
    finally:
        served.stop()
    assert faults == []
