"""A hybrid: critically damped inverse dynamics plus fuzzy control by a table, with figures.

usage: python examples/hybrid_run.py [FOLDER]   (figures go there; without it none are drawn)
"""

import sys
from pathlib import Path

from fuzzyarm.apps.study import draw_profiles, save_figure
from fuzzyarm.control.controllers import controller
from fuzzyarm.control.loop import simulate
from fuzzyarm.plant import pick_and_place

path = pick_and_place()
runs = {}
for name in ("cdid", "fuzzy-lut", "cdid+fuzzy-lut", "cdid+fuzzy-lut+ie"):
    # A plus sign makes the ordinary sum of controllers: any with any.
    made = controller(name)
    if name.endswith("+ie"):
        # The sum of the errors over the whole run, with a small gain.
        made = made.with_gains({"K_I": [50.0], "whole_run": [1.0]})
    runs[name] = simulate(made, path, payload=True)
    rms = runs[name].rms
    print(f"{name:<18} RMS error {rms[0]:.4f}° and {rms[1]:.4f}°")

if len(sys.argv) > 1:
    for name, run in runs.items():
        file = Path(sys.argv[1]) / f"{name}.png"
        save_figure(draw_profiles([run], name), file)
        print(f"{file} written")
