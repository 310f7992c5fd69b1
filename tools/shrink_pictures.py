"""Reduce the PNG pictures of the pages to 255 colours: `python tools/shrink_pictures.py`.

Run it after ``make_pictures.py``, ``make_gallery.py`` and ``make_designer_pictures.py``: a
screenshot takes a third of its bytes, and nothing in it looks different.
"""

from __future__ import annotations

import io
from pathlib import Path

from PIL import Image

from fuzzyarm.base.files import write_atomically

PICTURES = Path(__file__).parents[1] / "docs" / "pictures"


def shrink(path: Path) -> None:
    """Write a picture with a palette, unless it is smaller as it is."""
    palette = Image.open(path).convert("RGB").quantize(255, dither=Image.Dither.NONE)
    buffer = io.BytesIO()
    palette.save(buffer, "PNG", optimize=True)
    if buffer.tell() < 0.9 * path.stat().st_size:
        write_atomically(path, buffer.getvalue())


if __name__ == "__main__":
    for picture in sorted(PICTURES.glob("*.png")):
        shrink(picture)
