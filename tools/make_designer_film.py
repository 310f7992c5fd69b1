"""Make the film of docs/howto/designer.md: `python tools/make_designer_film.py`.

A person designs a controller for the motor from two empty files: rules, the controller, a run,
gains by slider, a push by hand. What is recorded is the running designer, shown in two minutes.
"""

from __future__ import annotations

import base64
import io
import os
import shutil
import subprocess
import sys
import tempfile
import time
from itertools import pairwise
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import sync_playwright

HERE = Path(__file__).parents[1] / "docs" / "pictures"
SIZE: Any = {"width": 1280, "height": 720}
SHOWN = (720, 405)
SHORTEST = 0.16
LONGEST = 1.6
"""Of a picture of the film, s: pauses are shortened to it."""

SECONDS = 118.0
"""Of the film: what took longer is shown faster."""

RULES = [
    ('rulebase rules "voltage from error and its rate"\n\n', 0.05),
    ("input  e   -1 .. 1\ninput  ce  -1 .. 1\noutput u   -1 .. 1\n\n", 0.04),
    ("terms e, ce: triangles N Z P\n", 0.05),
    ("terms u: triangles NB NS Z PS PB\n\n", 0.05),
    ("rules u\n  e \\ ce  N   Z   P\n  N       NB  NB  Z\n  Z       NS  Z   PS\n", 0.03),
    ("  P       Z   PB  PB\n", 0.03),
]
CONTROLLER = [
    ('controller motor "fuzzy PD control of a motor"\n\nuse rules from "rules.frb"\n\n', 0.04),
    ("period 1 ms\n\n", 0.05),
    ('gain G_e  = 1 "1/rad", tune 0.2 .. 20 log\n', 0.035),
    ('gain G_ce = 0.02 "s/rad", tune 0.002 .. 0.5 log\n', 0.03),
    ('gain G_u  = 12 "V", tune 1 .. 24\n\n', 0.035),
    ("axis shaft\n  e  = error of position * G_e\n  ce = error of velocity * G_ce\n", 0.03),
    ("  u  = rules rules(e, ce) * G_u\n  drive voltage = u, within -24 .. 24\n", 0.03),
]

HELPERS = """
const hand = document.createElement("div");
hand.style.cssText = "position:fixed;z-index:99;width:18px;height:18px;margin:-9px;"
  + "border-radius:9px;background:#d55e0088;border:2px solid #d55e00;"
  + "pointer-events:none;left:-50px";
const words = document.createElement("div");
words.style.cssText = "position:fixed;z-index:98;left:50%;bottom:14px;transform:translateX(-50%);"
  + "font:600 19px system-ui;background:#1b2330;color:#fff;padding:7px 18px;border-radius:8px;"
  + "pointer-events:none";
document.body.append(words, hand);
addEventListener("pointermove", (event) => {
  hand.style.left = `${event.clientX}px`;
  hand.style.top = `${event.clientY}px`;
}, true);
window.caption = (text) => { words.textContent = text; words.hidden = !text; };
"""


class Film:
    """The pictures of a page, with when they were taken."""

    def __init__(self) -> None:
        self.pictures: list[tuple[float, bytes]] = []
        self.gone = 0.0

    def record(self, page: Any) -> Any:
        """Take every picture of a page from now on."""
        session = page.context.new_cdp_session(page)

        def take(event: Any) -> None:
            now = time.monotonic()
            if not self.pictures or now - self.pictures[-1][0] >= SHORTEST:
                self.pictures.append((now, base64.b64decode(event["data"])))
            else:  # the last of several in a short time is the one that stays
                self.pictures[-1] = (self.pictures[-1][0], base64.b64decode(event["data"]))
            session.send("Page.screencastFrameAck", {"sessionId": event["sessionId"]})

        session.on("Page.screencastFrame", take)
        session.send("Page.startScreencast", {"format": "png", "everyNthFrame": 12})
        return session

    def write(self, path: Path) -> None:
        """Write them as an animated WebP."""
        times = [when for when, _ in self.pictures]
        waits = [min(LONGEST, b - a) for a, b in pairwise(times)]
        faster = min(1.0, SECONDS / sum(waits))
        spans = [int(1000 * faster * wait) for wait in waits] + [3000]
        images = [
            Image.open(io.BytesIO(content)).convert("RGB").resize(SHOWN, Image.Resampling.LANCZOS)
            for _, content in self.pictures
        ]
        images[0].save(
            path, save_all=True, append_images=images[1:], duration=spans, loop=0, quality=20,
            method=4,
        )  # fmt: skip


def say(page: Any, words: str, wait: float = 0.0) -> None:
    """Show what is being done."""
    page.evaluate("words => window.caption(words)", words)
    page.wait_for_timeout(1000 * wait)


def write(page: Any, text: str, pause: float) -> None:
    """Type a text line by line; the editor's own indenting is taken away."""
    for line in text.splitlines(keepends=True):
        body = line.rstrip("\n")
        page.keyboard.type(body, delay=1000 * pause)
        page.keyboard.press("Escape")  # a list of completions
        if line.endswith("\n"):
            page.keyboard.press("Enter")
            page.keyboard.press("Shift+Home")
            page.keyboard.press("Delete") if _indented(page) else page.keyboard.press("ArrowRight")


def _indented(page: Any) -> bool:
    return bool(page.evaluate("!designer.text.view.state.selection.main.empty"))


def glide(page: Any, x: float, y: float, steps: int = 18) -> None:
    """Move the hand slowly."""
    page.mouse.move(x, y, steps=steps)
    page.wait_for_timeout(250)


def at(page: Any, locator: Any) -> tuple[float, float]:
    """Return the middle of something."""
    box = locator.bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def click(page: Any, locator: Any) -> None:
    """Move to something, and click."""
    glide(page, *at(page, locator))
    page.mouse.down()
    page.mouse.up()
    page.wait_for_timeout(300)


def slide(page: Any, name: str, share: float) -> None:
    """Drag a slider to a share of its way."""
    slider = page.get_by_label(name, exact=True)
    box = slider.bounding_box()
    now = float(slider.input_value()) / 1000
    reach = box["width"] - 16
    y = box["y"] + box["height"] / 2
    glide(page, box["x"] + 8 + now * reach, y)
    page.mouse.down()
    page.mouse.move(box["x"] + 8 + share * reach, y, steps=25)
    page.wait_for_timeout(500)
    page.mouse.up()
    page.wait_for_timeout(400)


def push(page: Any, dx: float, dy: float, wait: float) -> None:
    """Pull the plant with the mouse, and let go."""
    canvas = page.locator(".run-picture canvas")
    x, y = at(page, canvas)
    glide(page, x + 60, y - 90)
    page.mouse.down()
    page.mouse.move(x + 60 + dx, y - 90 + dy, steps=10)
    page.wait_for_timeout(1000 * wait)
    page.mouse.up()
    page.wait_for_timeout(1600)


def rules(page: Any) -> None:
    """Write the rule base, and change it by hand."""
    say(page, "Two empty files. First the rules: what is typed is drawn.", 1.5)
    click(page, page.locator(".cm-content"))
    for text, pause in RULES:
        write(page, text, pause)
        page.wait_for_timeout(600)
    say(page, "Nine rules. A corner is dragged: an edit of the text.", 1.5)
    page.get_by_label("Partition").check()
    page.get_by_label("Snap").check()
    handle = page.locator('circle[data-variable="u"][data-term="PS"]').first
    x, y = at(page, handle)
    glide(page, x, y)
    page.mouse.down()
    page.mouse.move(x - 22, y, steps=20)
    page.wait_for_timeout(500)
    page.mouse.up()
    page.wait_for_timeout(1200)
    handle = page.locator('circle[data-variable="u"][data-term="NS"]').first
    x, y = at(page, handle)
    glide(page, x, y)
    page.mouse.down()
    page.mouse.move(x + 22, y, steps=20)
    page.mouse.up()
    page.wait_for_timeout(1200)
    say(page, "A rule is chosen in its cell.", 1.0)
    cell = page.get_by_label("rule for N, Z")
    glide(page, *at(page, cell))
    cell.select_option("NS")
    page.wait_for_timeout(700)
    cell = page.get_by_label("rule for P, Z")
    glide(page, *at(page, cell))
    cell.select_option("PS")
    page.wait_for_timeout(1200)
    page.keyboard.press("Control+s")
    page.wait_for_timeout(600)


def controller(page: Any) -> None:
    """Write the controller, and run it."""
    say(page, "Now the controller: the rules on a DC motor.", 1.2)
    click(page, page.locator(".cm-content"))
    for text, pause in CONTROLLER:
        write(page, text, pause)
        page.wait_for_timeout(300)
    page.wait_for_timeout(800)
    say(page, "Run: a step of the shaft by 1 rad.", 0.8)
    click(page, page.get_by_role("tab", name="Run"))
    while not page.locator(".run-form select").nth(1).input_value():
        page.wait_for_timeout(50)
    page.wait_for_timeout(700)
    click(page, page.get_by_role("button", name="Start"))
    page.wait_for_timeout(4500)
    say(page, "Soft. Pushed by hand, it gives way.", 0.8)
    push(page, 28, 40, 1.2)
    say(page, "Gains by slider, while it runs. More error gain: stiff, but it swings.", 1.0)
    slide(page, "G_e", 0.86)
    push(page, 28, 40, 1.0)
    say(page, "More rate gain calms it.", 0.8)
    slide(page, "G_ce", 0.87)
    push(page, 28, 40, 1.0)
    slide(page, "G_u", 0.95)
    say(page, "What was slid is in the text. Once more from the start.", 1.0)
    click(page, page.get_by_role("button", name="Restart"))
    page.wait_for_timeout(3500)
    push(page, 28, 40, 1.0)
    page.keyboard.press("Control+s")
    say(page, "Saved: two text files, 30 lines.", 3.0)


def main() -> None:
    """Serve two empty files, and record a person."""
    film = Film()
    with tempfile.TemporaryDirectory() as folder:
        for name in ("rules", "motor"):
            (Path(folder) / f"{name}.frb").write_text("")
        words = [sys.executable, "-m", "fuzzyarm", "designer", folder, "--no-browser"]
        state = {**os.environ, "XDG_STATE_HOME": folder}
        with subprocess.Popen(words, stdout=subprocess.PIPE, text=True, env=state) as server:
            assert server.stdout is not None
            address = server.stdout.readline().strip()
            with sync_playwright() as playwright:
                browser = playwright.chromium.launch(
                    executable_path=shutil.which("chromium"), args=["--no-sandbox"]
                )
                context = browser.new_context(viewport=SIZE, bypass_csp=True)
                for name, play in (("rules", rules), ("motor", controller)):
                    page = context.new_page()
                    page.goto(f"{address}#file={name}.frb")
                    page.locator(".cm-content").wait_for()
                    page.wait_for_timeout(500)
                    page.evaluate(HELPERS)
                    session = film.record(page)
                    play(page)
                    session.send("Page.stopScreencast")
                    page.close()
                browser.close()
            server.terminate()
    film.write(HERE / "designer_motor.webp")


if __name__ == "__main__":
    main()
