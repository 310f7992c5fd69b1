"""Draw the pictures of the README and the documentation again.

    python docs/make_pictures.py

Every picture comes from the commands that a reader would use.
"""

from __future__ import annotations

import io
from pathlib import Path

from rich.console import Console

from fuzzyarm import shipped
from fuzzyarm.cli import main
from fuzzyarm.language import load_rulebase
from fuzzyarm.show.table import table_view
from fuzzyarm.table import compile_table

PICTURES = Path(__file__).parent / "pictures"


def draw_table() -> None:
    """Draw the table of pd7.frb as a colour terminal shows it."""
    table = compile_table(load_rulebase(shipped("pd7.frb")))
    console = Console(record=True, width=78, file=io.StringIO(), force_terminal=True,
                      color_system="truecolor", highlight=False)  # fmt: skip
    console.print(table_view(table))
    console.save_svg(str(PICTURES / "pd7-table.svg"), title="fuzzyarm show pd7.lut")


def draw_surface() -> None:
    """Draw the terms and the control surface of pd7.frb."""
    main(["plot", str(shipped("pd7.frb")), "-o", str(PICTURES / "pd7.png")])


def draw_map() -> None:
    """Draw the robustness map of pid over payload and integral gain."""
    ranges = ["--sweep", "payload=0..2:21", "--sweep", "K_I=0.1..10:24 log"]
    main(["sweep", "pid", *ranges, "--plot", str(PICTURES / "sweep-map.png")])


def draw_phase() -> None:
    """Draw the phase portrait of the shipped servo."""
    out = str(PICTURES / "servo-phase.png")
    main(["plot", str(shipped("servo.frb")), "-o", out, "--what", "phase", "--plant", "motor"])


if __name__ == "__main__":
    PICTURES.mkdir(exist_ok=True)
    draw_table()
    draw_surface()
    draw_map()
    draw_phase()
