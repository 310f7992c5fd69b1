"""What the whole screen says, in a terminal of 80 × 24, held against stored screens.

`pytest --update-golden` writes them anew; look at the difference before you keep it.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from fuzzyarm.studio.app import Studio
from fuzzyarm.studio.document import StudioDocument

ROOT = Path(__file__).parents[2]
GOLDEN = Path(__file__).parent / "golden"

SCREENS = {
    "rules": ("pd7.frb", ["f3", "tab", "right", "down"]),
    "terms": ("fan.frb", ["f4", "tab", "right", "right", "right"]),
    "firing": ("pd7.frb", ["f5", "tab", "right", "right", "down", "down", "down"]),
    "sentences": ("tipper.frb", ["f3", "tab"]),
    "broken": ("thermostat.frb", ["f3", "down", "down", "down", "right", "x"]),
    "table": ("thesis-6.1.lut", ["f3", "tab", "right", "down"]),
    "line": ("fan.frb", ["tab", "shift+right", "shift+right"]),
}


@pytest.mark.parametrize("name", sorted(SCREENS))
async def test_the_screen_is_as_stored(name: str, tmp_path: Path, update_golden: bool) -> None:
    file, keys = SCREENS[name]
    path = Path(shutil.copy(ROOT / "rulebases" / file, tmp_path / file))
    app = Studio(StudioDocument(path))
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.pause()
        await pilot.press(*keys)
        app.read_text()
        await pilot.pause()
        strips = app.screen._compositor.render_strips()
    screen = "".join(f"{strip.text.rstrip()}\n" for strip in strips)
    stored = GOLDEN / f"{name}.txt"
    if update_golden:
        GOLDEN.mkdir(exist_ok=True)
        stored.write_text(screen, "utf-8")
    assert screen == stored.read_text("utf-8")
    assert max(len(line) for line in screen.splitlines()) <= 80


async def test_the_surface_is_coloured_by_its_values(tmp_path: Path) -> None:
    app = Studio(StudioDocument(ROOT / "rulebases" / "pd7.frb"))
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.pause()
        strips = app.screen._compositor.render_strips()
        rows = [
            [
                segment.style.color.triplet
                for segment in strip
                if segment.text.startswith("▀") and segment.style and segment.style.color
            ]
            for strip in strips
        ]
    rows = [row for row in rows if row]
    assert len({cell for row in rows for cell in row}) > 50
    # Blue for the lowest values, red for the highest: as in figures, both inputs rise to the
    # upper right.
    assert rows[-1][0].blue > rows[-1][0].red
    assert rows[0][-1].red > rows[0][-1].blue
