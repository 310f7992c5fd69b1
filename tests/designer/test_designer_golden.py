"""Pictures of every pane of the designer, beside those that are kept.

``pytest tests/designer/test_designer_golden.py --update-golden`` makes them anew; look at them.
All text is set in the DejaVu fonts that come with matplotlib, through a font configuration of the
browser's own, so that the machine's fonts play no part. What is left is how a browser draws edges:
pictures are compared as means of 4 × 4 pixels, and browsers of another major version not at all.
"""

import os
from pathlib import Path

import numpy as np
import pytest
from needs import requires
from test_designer_page import CHROMIUM, Served, put, until

from fuzzyarm.base.shipped_files import shipped

pytestmark = [
    requires("chromium"),
    pytest.mark.slow,
]
sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
image_of = pytest.importorskip("PIL.Image", reason="pillow is not installed")

GOLDEN = Path(__file__).with_name("golden")
VERSION = GOLDEN / "chromium.txt"
COARSE = 4
MEAN, FAR, MOST_FAR = 1.5, 32.0, 0.01
"""Allowed: a mean difference of so many of 255 steps, and this share of spots further off."""

FONTS = """<?xml version="1.0"?>
<!DOCTYPE fontconfig SYSTEM "fonts.dtd">
<fontconfig><dir>{fonts}</dir><cachedir>{cache}</cachedir></fontconfig>
"""

CONTOUR = """() => {
  [["contour", 0], ["y", 1]].forEach(([to, i]) => {
    const select = [...document.querySelectorAll(".surface .bar select")].slice(-2)[i];
    select.value = to;
    select.dispatchEvent(new Event("change"));
  });
}"""
CHOSEN = "() => document.querySelector('.plots text[data-term]').focus()"
AS_WRITTEN = """() => {
  const select = document.querySelector(".inference select");
  select.value = "text";
  select.dispatchEvent(new Event("change"));
}"""

PICTURES = [
    ("pd7", "light", "", ("text", "terms", "rules", "surface", "inference")),
    ("pd7", "dark", AS_WRITTEN, ("rules", "inference")),
    ("tipper2", "light", CHOSEN, ("terms", "rules", "surface", "inference")),
    ("thermostat", "light", CONTOUR, ("terms", "surface", "inference")),
]


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    mpl = pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    place = tmp_path_factory.mktemp("fonts")
    fonts = Path(mpl.get_data_path()) / "fonts" / "ttf"
    (place / "fonts.conf").write_text(FONTS.format(fonts=fonts, cache=place / "cache"))
    env = {**os.environ, "FONTCONFIG_FILE": str(place / "fonts.conf")}
    words = ["--no-sandbox", "--font-render-hinting=none", "--disable-lcd-text"]
    with sync_api.sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=CHROMIUM, args=words, env=env)
        yield found
        found.close()


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    server = Served(tmp_path_factory.mktemp("golden"))
    yield server
    server.stop()


def opened(path):
    return image_of.open(path).convert("RGB")


def coarse(image):
    """Return the means of squares of pixels."""
    pixels = np.asarray(image, dtype=float)
    rows, columns = (size - size % COARSE for size in pixels.shape[:2])
    parts = pixels[:rows, :columns].reshape(rows // COARSE, COARSE, columns // COARSE, COARSE, 3)
    return parts.mean(axis=(1, 3))


def difference(one, other):
    """Return what is wrong with a picture; empty where it is as the other one."""
    if one.size != other.size:
        return f"{one.size} rather than {other.size} pixels"
    apart = np.abs(coarse(one) - coarse(other)).max(axis=2)
    if apart.mean() > MEAN or (apart > FAR).mean() > MOST_FAR:
        return (
            f"mean {apart.mean():.2f}, {100 * (apart > FAR).mean():.2f} % of the spots are far off"
        )
    return ""


@pytest.mark.parametrize(
    ("name", "scheme", "script", "panes"), PICTURES, ids=[f"{p[0]}-{p[1]}" for p in PICTURES]
)
def test_panes_look_as_they_did(
    name, scheme, script, panes, served, browser, tmp_path, update_golden
):
    major = browser.version.split(".")[0]
    if not update_golden and VERSION.read_text().strip() != major:
        pytest.skip(f"the pictures are of Chromium {VERSION.read_text().strip()}, this is {major}")
    address = put(served, f"{name}.frb", shipped(f"{name}.frb").read_text())[1]
    context = browser.new_context(
        viewport={"width": 1280, "height": 720}, color_scheme=scheme, device_scale_factor=1
    )
    page = context.new_page()
    page.goto(address)
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    until(lambda: page.locator(".colour-keyword").count() > 0, "colours")
    if script:
        page.evaluate(script)
    page.wait_for_timeout(400)  # panes are drawn a frame later, one after the other
    wrong = {}
    for pane in panes:
        label = f"{name}-{scheme}-{pane}"
        seen, kept = tmp_path / f"{label}.png", GOLDEN / f"{label}.png"
        page.locator(f".pane.{pane}").screenshot(path=seen)
        if update_golden:
            GOLDEN.mkdir(exist_ok=True)
            opened(seen).save(kept, optimize=True)
            VERSION.write_text(f"{major}\n")
        elif said := difference(opened(seen), opened(kept)):
            wrong[str(seen)] = said
    context.close()
    assert wrong == {}


def test_a_difference_is_seen():
    kept = opened(GOLDEN / "pd7-light-terms.png")
    assert difference(kept, kept) == ""
    moved = image_of.new("RGB", kept.size)
    moved.paste(kept, (6, 0))
    assert difference(moved, kept) != ""
    assert difference(kept.resize((40, 30)), kept) != ""


def test_the_pictures_are_small():
    assert sum(path.stat().st_size for path in GOLDEN.glob("*.png")) < 600_000
