"""STFC, CFAF and HFIE beside the direct fuzzy controller that they improve upon."""

from fuzzyarm.controller import controller
from fuzzyarm.loop import simulate
from fuzzyarm.plant import pick_and_place, reach_return

CONTROLLERS = {
    "fuzzy-direct": "the rules alone",
    "stfc": "a second rule base scales the output",
    "cfaf": "and small errors are magnified",
    "cfaf, smooth": "without a jump at the edge of the window",
    "hfie": "the rules and an integral over each set point",
}

for path in (reach_return(), pick_and_place(angles=(60.0, -45.0), segment=1.0)):
    print(f"\n{path.name} with payload: RMS error and largest error of both links, degrees")
    for name, meaning in CONTROLLERS.items():
        made = controller(name.partition(",")[0])
        if name.endswith("smooth"):
            made = made.with_gains({"smooth": [1.0]})
        run = simulate(made, path, payload=True)
        figures = "".join(f"{value:9.4f}" for value in (*run.rms, *run.maximum))
        print(f"{name:<14}{figures}   {meaning}")
