"""Make docs/tutorial/gallery.md and its pictures: `python tools/make_gallery.py`.

Terms and surfaces of the shipped rule bases, tables, and what they do in a loop; the runs are those
of ``make_pictures.py``. ``python tools/make_gallery.py --page`` writes the page alone.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from PIL import Image

from fuzzyarm import load, shipped
from fuzzyarm.apps.cli import main
from fuzzyarm.base.files import write_atomically
from fuzzyarm.language.model.rulebase import RuleBase

DOCS = Path(__file__).parents[1] / "docs"
PICTURES = DOCS / "pictures"

RUNS = {
    "arm": (
        "The two-link arm under a self-tuning fuzzy controller",
        "the arm swings up, takes a load and swings back; errors stay below 0.25 degrees",
        "stfc --payload",
    ),
    "motor": (
        "A shaft turns",
        "a hand on a dial follows a step of 1 rad in 0.2 s; error and voltage beside it",
        "rulebases/servo.frb --plant motor --step 1",
    ),
    "cartpole": (
        "A pole on its cart",
        "the cart first leans the pole, then drives 1 m to the mark; error and force beside it",
        "rulebases/cartpole.frb --plant cartpole --step 1",
    ),
    "tanks": (
        "Two tanks",
        "water runs from the upper tank to the lower one, which rises to the mark at 0.15 m",
        "rulebases/tanks.frb --plant tanks --step 0.15",
    ),
    "ball-and-beam": (
        "A ball on a beam",
        "the beam tilts a little, and the ball follows a mark to and fro within 4 mm",
        "rulebases/ball-and-beam.frb --plant ball-and-beam --reference position=sine:0.2,0.1",
    ),
    "room": (
        "A room is heated",
        "a thermometer rises from 15 to 18 and 21 °C; power goes up to 87 % and settles at 51 %",
        "rulebases/heater.frb --plant room --step 21",
    ),
}
"""Plant → caption, what is seen, and what ``simulate`` is asked for such a run."""

OTHERS = {
    "pd7-table.svg": (
        "A table in the terminal",
        "13 rows of 13 numbers, blue where negative and red where positive",
        "show pd7.lut",
    ),
    "explain.svg": (
        "Why a number came out",
        "degrees of both inputs as bars, the rules that fire with their lines, the cut sets",
        "eval rulebases/pd7.frb e=1.3 ce=-2 --explain",
    ),
    "watch.svg": (
        "A file drawn at each save",
        "the control surface of a thermostat in colours, its rules as two grids",
        "watch rulebases/thermostat.frb",
    ),
    "sweep-map.png": (
        "Where a controller keeps its error small",
        "two maps of the error over payload and integral gain; beyond a falling line runs diverge",
        'sweep pid --sweep payload=0..2:21 --sweep "K_I=0.1..10:24 log" --plot map.png',
    ),
    "servo-phase.png": (
        "A phase portrait",
        "twelve paths of position and velocity run into the origin, most along one curve",
        "plot rulebases/servo.frb -o phase.png --what phase --plant motor",
    ),
    "study-overview.png": (
        "A published study, reproduced",
        "a row for each controller: dots, the errors reproduced, lie in rings, the published ones",
        "reproduce 7.1.1 --overview overview.png",
    ),
}
"""Picture → caption, what is seen, and command."""


_HEAD = """\
Each picture stands above the command that makes one like it, in a clone of the repository. This
page is written by `tools/make_gallery.py`.
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
    for plant, (caption, seen, command) in RUNS.items():
        made = f"simulate {command} --animate {plant}.gif"
        yield _entry(caption, seen, f"plant-{plant}.gif", made)
    yield "## Rule bases that are shipped\n"
    for path in shipped_rulebases():
        model = load(path)
        assert isinstance(model, RuleBase)
        command = f"plot rulebases/{path.name} -o {path.stem}.png"
        names = ", ".join(each.name for each in (*model.inputs, *model.outputs))
        seen = f"the terms of {names}, and below them the output over the inputs"
        caption = f"{path.stem}: {model.description}"
        yield _entry(caption, seen, f"gallery-{path.stem}.png", command)
    yield "## And besides\n"
    for picture, (caption, seen, command) in OTHERS.items():
        yield _entry(caption, seen, picture, command)


def _entry(caption: str, seen: str, picture: str, command: str) -> str:
    words = f"{seen[0].upper()}{seen[1:]}"
    return f"![{words}](../pictures/{picture})\n\n*{caption}.* `fuzzyarm {command}`\n"


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
    write_atomically(DOCS / "tutorial" / "gallery.md", gallery_page())
