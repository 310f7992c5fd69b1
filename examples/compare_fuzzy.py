"""STFC, CFAF and HFIE beside the direct fuzzy controller that they improve upon."""

import tempfile
from pathlib import Path

from fuzzyarm import shipped
from fuzzyarm.control.controllers import controller, find_controller
from fuzzyarm.control.loop import simulate
from fuzzyarm.plant import pick_and_place, reach_return

CONTROLLERS = {
    "fuzzy-direct": "the rules alone",
    "stfc": "a second rule base scales the output",
    "cfaf": "and small errors are magnified",
    "cfaf, smooth": "without a jump at the edge of the window",
    "hfie": "the rules and an integral over each set point",
}


def smooth():
    """Return cfaf with one word more in its text."""
    text = shipped("cfaf.frb").read_text().replace("inside window", "inside window, edge wait")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "cfaf-smooth.frb"
        file.write_text(text)
        return find_controller(str(file))


for path in (reach_return(), pick_and_place(angles=(60.0, -45.0), segment=1.0)):
    print(f"\n{path.name} with payload: RMS error and largest error of both links, degrees")
    for name, meaning in CONTROLLERS.items():
        made = smooth() if name.endswith("smooth") else controller(name)
        run = simulate(made, path, payload=True)
        figures = "".join(f"{value:9.4f}" for value in (*run.rms, *run.maximum))
        print(f"{name:<14}{figures}   {meaning}")
