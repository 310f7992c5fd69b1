"""Make the pictures of docs/howto/designer.md: `python tools/make_designer_pictures.py`.

They are what a browser shows of the running designer, driven by hand movements.
"""

from __future__ import annotations

import contextlib
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

ROOT = Path(__file__).parents[1]
HERE = ROOT / "docs" / "pictures"
SIZE: Any = {"width": 1280, "height": 720}
PATIENCE = 60
"""What is awaited comes within this time, s."""
HAS_PLANT = "document.querySelectorAll('.run-form select')[1]?.value"
HAS_RUN = """document.querySelector('.metrics td')
  && parseFloat(document.querySelector('output.clock').textContent) > 2.2"""


def wait_for(page: Any, expression: str) -> None:
    """Wait until something is so; the policy of the page forbids that it asks itself."""
    last = time.monotonic() + PATIENCE
    while not page.evaluate(expression):
        if time.monotonic() > last:
            raise TimeoutError(f"{page.url}: {expression} is not so after {PATIENCE} s")
        page.wait_for_timeout(50)


def open_page(browser: Any, address: str, name: str, scheme: str = "light") -> Any:
    """Open a file and wait for its picture."""
    page = browser.new_page(viewport=SIZE, color_scheme=scheme)
    page.goto(f"{address}#file={name}.frb")
    wait_for(page, "!!window.designer?.store.scene")
    page.wait_for_timeout(400)
    return page


def drag(page: Any, selector: str, dx: int) -> None:
    """Move a handle to the side; the hand stays on it."""
    box = page.locator(selector).first.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.wait_for_timeout(300)
    page.mouse.move(x + dx, y, steps=5)
    page.wait_for_timeout(300)


def turn(page: Any, view: str) -> None:
    """Turn to a view; those that take their time are behind a word."""
    tab = page.get_by_role("tab", name=view, exact=True)
    if not tab.count():  # hidden
        page.locator("header .more summary").click()
    tab.click()


def open_run(browser: Any, address: str, name: str, scheme: str = "light") -> Any:
    """Open a controller in the view Run, and start it."""
    page = browser.new_page(viewport=SIZE, color_scheme=scheme)
    page.goto(f"{address}#file={name}.frb")
    turn(page, "Run")
    wait_for(page, HAS_PLANT)
    page.locator(".run").get_by_label("Duration", exact=True).fill("4s")
    page.locator(".run").get_by_role("button", name="Start").click()
    wait_for(page, HAS_RUN)
    return page


def run(browser: Any, address: str) -> None:
    """Draw the view Run: the motor turned by hand, the cart on its way."""
    page = open_run(browser, address, "servo")
    box = page.locator(".run-picture canvas").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x + 60, y - 90)
    page.mouse.down()
    page.mouse.move(x + 105, y - 40, steps=4)
    keep(page, "designer_run.png", after=700)

    page = open_run(browser, address, "cartpole", "dark")
    page.locator(".run-picture canvas").focus()
    page.keyboard.down("ArrowLeft")
    page.wait_for_timeout(600)
    page.keyboard.up("ArrowLeft")
    keep(page, "designer_run_dark.png", after=500)


def draw_beginning(browser: Any) -> None:
    """Draw the folder that has nothing in it."""
    with tempfile.TemporaryDirectory() as folder, serving(Path(folder) / "class") as address:
        page = browser.new_page(viewport=SIZE)
        page.goto(address)
        page.get_by_text("This folder has no rule base yet").wait_for()
        keep(page, "designer_empty.png", after=300)


def draw_controller(browser: Any, address: str) -> None:
    """Draw a controller as a block diagram with its rule base."""
    page = browser.new_page(viewport=SIZE)
    page.goto(f"{address}#file=servo.frb")
    page.locator(".diagram .sheet canvas").wait_for()
    keep(page, "designer_controller.png", after=600)


def draw(browser: Any, address: str) -> None:
    """Draw every picture."""
    draw_controller(browser, address)
    page = open_page(browser, address, "pd7")
    page.screenshot(path=HERE / "designer.png")
    page.get_by_label("Partition").check()
    drag(page, 'circle[data-variable="e"][data-term="ZE"]', 46)
    page.mouse.up()
    keep(page, "designer_terms.png", after=600)

    page = open_page(browser, address, "thermostat", "dark")
    page.locator(".surface .bar label", has_text="view").locator("select").select_option("contour")
    keep(page, "designer_dark.png")

    page = open_page(browser, address, "tipper2")
    page.locator('text[data-variable="food"][data-term="delicious"]').focus()
    page.locator(".surface .bar select").last.select_option("x")
    keep(page, "designer_type2.png")

    page = open_page(browser, address, "tipper")
    page.evaluate("designer.text.goTo([17, 0])")
    page.keyboard.type("rule if service is GOOT then tip is AVERAGE\n")
    keep(page, "designer_mistake.png", after=900)
    draw_learning(browser, address)
    draw_tuning(browser, address)
    draw_sweep(browser, address)
    draw_fit(browser, address)


def keep(page: Any, name: str, after: int = 400) -> None:
    """Keep a page as a picture, so many milliseconds later, and close it."""
    page.wait_for_timeout(after)
    page.screenshot(path=HERE / name)
    page.close()


def open_view(browser: Any, address: str, name: str, view: str, scheme: str = "light") -> Any:
    """Open a controller, which has no picture of its own, and turn to a view of it."""
    page = browser.new_page(viewport=SIZE, color_scheme=scheme)
    page.goto(f"{address}#file={name}.frb")
    page.get_by_text("no findings").wait_for()
    turn(page, view)
    return page, page.locator(f"#view-{view.lower()}")


def draw_learning(browser: Any, address: str) -> None:
    """Draw a table that has learned four passes, and waits."""
    page, learn = open_view(browser, address, "servo-soc", "Learn")
    learn.get_by_text("has a table that learns").wait_for()
    learn.get_by_label("Reference").fill("position=sine:0.5,1")
    learn.get_by_label("Passes").fill("4")
    learn.get_by_label("Speed").select_option("fast")
    learn.get_by_role("button", name="Start").click()
    learn.get_by_text("pass 4 of 4, waiting").wait_for()
    keep(page, "designer_learn.png")


def draw_tuning(browser: Any, address: str) -> None:
    """Draw a search that is over, with its report."""
    page, tune = open_view(browser, address, "heater", "Tune", "dark")
    tune.get_by_text("What may move, as the text says").wait_for()
    for name, value in {
        "Reference": "temperature=step:20",
        "Duration": "1h",
        "Cost": "rms + overshoot",
        "Trials at most": "60",
        "Unseen scenarios": "6",
    }.items():
        tune.get_by_label(name, exact=True).fill(value)
    tune.get_by_role("button", name="Start").click()
    tune.get_by_text("better than the file").wait_for()
    keep(page, "designer_tune.png")


def draw_sweep(browser: Any, address: str) -> None:
    """Draw the map of a sweep."""
    page, sweep = open_view(browser, address, "servo", "Sweep")
    sweep.get_by_text("takes N values").wait_for()
    sweep.get_by_role("combobox", name="Ranges").fill("G_e=2..60:12 log J=0.005..0.05:9")
    sweep.get_by_role("button", name="Start").click()
    sweep.get_by_text("Done.").wait_for()
    keep(page, "designer_sweep.png")


def draw_fit(browser: Any, address: str) -> None:
    """Draw a rule base that was learned from samples."""
    page, fit = open_view(browser, address, "servo", "Fit", "dark")
    fit.get_by_text("learned from samples").wait_for()
    fit.get_by_label("Rules at most", exact=True).fill("9")
    fit.get_by_role("button", name="Fit").click()
    fit.get_by_text("It can be saved").wait_for()
    keep(page, "designer_fit.png")


def draw_files(browser: Any, address: str) -> None:
    """Draw the views of files, tables and comparison."""
    page = open_page(browser, address, "pd7")
    turn(page, "Table")
    page.get_by_text("Every cell is proved").wait_for()
    page.locator(".accuracy .bar select").last.select_option("proved")
    page.wait_for_timeout(300)
    page.screenshot(path=HERE / "designer_table.png")
    turn(page, "Compare")
    page.locator(".compare .bar select").first.select_option("pd7-soft.frb")
    page.get_by_text("Over all inputs").wait_for()
    page.screenshot(path=HERE / "designer_compare.png")
    turn(page, "Files")
    keep(page, "designer_files.png", after=3000)

    page = browser.new_page(viewport=SIZE, color_scheme="dark")
    page.goto(f"{address}#file=thermostat.lut")
    page.get_by_text("not proved one by one").wait_for()
    page.locator(".cells .bar select").select_option("6")
    keep(page, "designer_lut.png")


def prepare(folder: str) -> None:
    """Put copies of shipped files into a folder, a table, and a rule base with softer rules."""
    for name in (
        "pd7", "thermostat", "tipper", "tipper2", "servo", "cartpole", "heater", "roompi"
    ):  # fmt: skip
        shutil.copy(ROOT / "rulebases" / f"{name}.frb", folder)
    lesson = (ROOT / "docs" / "tutorial" / "6-a-table-that-learns.md").read_text("utf-8")
    (Path(folder) / "servo-soc.frb").write_text(
        lesson.split("```frb\n# servo-soc.frb\n")[1].split("```")[0], "utf-8"
    )
    draw = random.Random(3)
    pairs = [(draw.uniform(-2.0, 2.0), draw.uniform(0.0, 5.0)) for _ in range(300)]
    rows = [f"{a:.4f},{b:.4f},{a * a - a * b + 0.3 * draw.gauss(0.0, 1.0):.4f}" for a, b in pairs]
    (Path(folder) / "measured.csv").write_text("\n".join(["a,b,y", *rows]), "utf-8")
    compiling = [sys.executable, "-m", "fuzzyarm", "compile", "thermostat.frb"]
    subprocess.run([*compiling, "-o", "thermostat.lut"], cwd=folder, check=True)
    text = (Path(folder) / "pd7.frb").read_text(encoding="utf-8")
    row = "  ZE      NB  NM  NS  ZE  PS  PM  PB"
    soft = text.replace(row, "  ZE      NM  NS  ZE  ZE  ZE  PS  PM")
    soft = soft.replace("rulebase pd7", "rulebase pd7-soft")
    (Path(folder) / "pd7-soft.frb").write_text(soft, encoding="utf-8")


@contextlib.contextmanager
def serving(folder: Path) -> Iterator[str]:
    """Serve a folder; yield the address."""
    words = [sys.executable, "-m", "fuzzyarm", "designer", str(folder), "--no-browser"]
    state = {**os.environ, "XDG_STATE_HOME": f"{folder}.state"}
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True, env=state) as server:
        assert server.stdout is not None
        try:
            yield server.stdout.readline().strip()
        finally:
            server.terminate()


def main() -> None:
    """Serve copies of shipped files, and look at them."""
    with tempfile.TemporaryDirectory() as parent, sync_playwright() as playwright:
        folder = Path(parent) / "rules"
        folder.mkdir()
        prepare(str(folder))
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox"]
        )
        with serving(folder) as address:
            draw_files(browser, address)  # before a hand has changed the files
            run(browser, address)
            draw(browser, address)
        draw_beginning(browser)
        browser.close()


if __name__ == "__main__":
    main()
