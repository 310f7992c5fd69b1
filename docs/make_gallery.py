"""Make docs/gallery.md and its pictures: `python docs/make_gallery.py`.

Terms and surfaces of the shipped rule bases, tables, and what they do in a loop; the runs are those
of ``make_pictures.py``. ``python docs/make_gallery.py --page`` writes the page alone.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from PIL import Image

from fuzzyarm import load, shipped
from fuzzyarm.cli import main
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.text.files import write_atomically

HERE = Path(__file__).parent
PICTURES = HERE / "pictures"

RUNS = {
    "arm": ("The two-link arm", "stfc --payload"),
    "motor": ("A shaft turns", "rulebases/servo.frb --plant motor --step 1"),
    "cartpole": ("A pole on its cart", "rulebases/cartpole.frb --plant cartpole --step 1"),
    "tanks": ("Two tanks", "rulebases/tanks.frb --plant tanks --step 0.15"),
    "ball-and-beam": ("A ball on a beam", "rulebases/ball-and-beam.frb --plant ball-and-beam"),
    "room": ("A room is heated", "rulebases/heater.frb --plant room --step 21"),
}
"""Plant → caption, and what ``simulate`` is asked for such a run."""

OTHERS = {
    "pd7-table.svg": ("A table in the terminal", "show pd7.lut"),
    "explain.svg": ("Why a number came out", "eval rulebases/pd7.frb e=1.3 ce=-2 --explain"),
    "studio-surface.svg": ("The studio", "studio rulebases/pd7.frb"),
    "sweep-map.png": (
        "Where a controller keeps its error small",
        'sweep pid --sweep payload=0..2:21 --sweep "K_I=0.1..10:24 log" --plot map.png',
    ),
    "servo-phase.png": (
        "A phase portrait",
        "plot rulebases/servo.frb -o phase.png --what phase --plant motor",
    ),
    "study-overview.png": ("A published study, reproduced", "reproduce --overview overview.png"),
}
"""Picture → caption and command."""


_HEAD = """\
Each picture stands above the command that makes one like it, in a clone of the repository. This
page is written by `docs/make_gallery.py`.
"""


def shipped_rulebases() -> list[Path]:
    """Return the shipped rule bases; not controllers, nor the study's variants of sets."""
    paths = sorted(shipped("pd7.frb").parent.glob("*.frb"))
    own = [path for path in paths if not path.stem.endswith("-study")]
    return [path for path in own if isinstance(load(path), RuleBase)]


def gallery_page() -> str:
    """Return the page as Markdown."""
    return "\n".join(_parts())


def _parts() -> Iterator[str]:
    yield "# Gallery\n"
    yield _HEAD
    yield "## Runs\n"
    for plant, (caption, command) in RUNS.items():
        yield _entry(caption, f"plant-{plant}.gif", f"simulate {command} --animate {plant}.gif")
    yield "## Rule bases that are shipped\n"
    for path in shipped_rulebases():
        model = load(path)
        assert isinstance(model, RuleBase)
        command = f"plot rulebases/{path.name} -o {path.stem}.png"
        yield _entry(f"{path.stem}: {model.description}", f"gallery-{path.stem}.png", command)
    yield "## And besides\n"
    for picture, (caption, command) in OTHERS.items():
        yield _entry(caption, picture, command)


def _entry(caption: str, picture: str, command: str) -> str:
    return f"![{caption}](pictures/{picture})\n\n*{caption}.* `fuzzyarm {command}`\n"


def draw() -> None:
    """Draw the shipped rule bases."""
    for path in shipped_rulebases():
        out = PICTURES / f"gallery-{path.stem}.png"
        assert main(["plot", str(path), "-o", str(out)]) == 0
        picture = Image.open(out).convert("RGB")
        picture.thumbnail((900, 900))
        # Covering all colours, not the most frequent: thin lines keep those of their terms.
        cover = Image.Quantize.MAXCOVERAGE
        picture.quantize(256, method=cover, kmeans=5).save(out, optimize=True)


if __name__ == "__main__":
    if "--page" not in sys.argv:
        draw()
    write_atomically(HERE / "gallery.md", gallery_page())
