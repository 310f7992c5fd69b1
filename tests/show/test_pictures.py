"""The pictures of the pages are what the program shows today; `tools/make_pictures.py` makes them.

Those that take a run of a plant are made by the same command and looked at; here are the others.
"""

from __future__ import annotations

import html
import importlib.util
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

STORED = Path(__file__).parents[2] / "docs" / "pictures"
MAKE = STORED.parents[1] / "tools" / "make_pictures.py"


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """Draw the pictures anew, into a folder of their own."""
    spec = importlib.util.spec_from_file_location("make_pictures", MAKE)
    pictures = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(pictures)
    pictures.PICTURES = tmp_path_factory.mktemp("pictures")
    pictures.draw_table()
    pictures.draw_surface()
    pictures.draw_controllers()
    pictures.draw_authoring()
    return pictures.PICTURES


def words(path):
    """Return the text of an SVG; a cursor that blinks may part it elsewhere."""
    found = re.findall(r"<text[^>]*?>([^<]*)</text>", path.read_text("utf-8"))
    return "".join(html.unescape("".join(found)).replace("\xa0", " ").split())


@pytest.mark.slow
def test_pictures_say_what_the_program_says_today(drawn):
    names = sorted(path.name for path in drawn.glob("*.svg"))
    assert {"pd7-table.svg", "explained.svg", "watch.svg", "new.svg"} <= set(names)
    stale = [name for name in names if words(drawn / name) != words(STORED / name)]
    assert stale == [], "run python tools/make_pictures.py, and look at them"
    assert all(words(drawn / name) for name in names)


@pytest.mark.slow
def test_figures_look_as_they_do_today(drawn):
    for path in drawn.glob("*.png"):
        now, then = (Image.open(each).convert("RGB") for each in (path, STORED / path.name))
        assert now.size == then.size, f"{path.name}: run python tools/make_pictures.py"
        difference = np.abs(np.asarray(now, float) - np.asarray(then, float)).mean()
        assert difference < 1.0, f"{path.name}: run python tools/make_pictures.py"


def test_every_picture_of_a_page_is_there_and_every_picture_has_its_page():
    root = STORED.parents[1]
    pages = [root / "README.md", *sorted((root / "docs").rglob("*.md"))]
    used = {
        name
        for page in pages
        for name in re.findall(r"pictures/([\w.+-]+\.(?:png|svg|gif))", page.read_text("utf-8"))
    }
    there = {path.name for path in STORED.iterdir() if path.suffix in (".png", ".svg", ".gif")}
    assert used - there == set()
    assert there - used == set()
