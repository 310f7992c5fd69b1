"""Draw the pictures of the README and the documentation again.

    python docs/make_pictures.py            # all of them
    python docs/make_pictures.py plants     # runs on the shipped plants alone
    python docs/make_pictures.py structures # runs of each structure alone
    python docs/make_pictures.py type2      # interval type-2 alone
    python docs/make_pictures.py motor      # one of them

Every picture comes from what a reader would use: commands, or the functions behind them.
"""

from __future__ import annotations

import io
import sys
from pathlib import Path

from PIL import Image
from rich.console import Console

from fuzzyarm import explain, load, shipped
from fuzzyarm.cli import main
from fuzzyarm.language import load_rulebase
from fuzzyarm.loop import Options, Sensor, Signal, simulate
from fuzzyarm.plant import find_plant, pick_and_place
from fuzzyarm.show.figures import inference_figure, rulebase_figure
from fuzzyarm.show.figures.animation import animate
from fuzzyarm.show.figures.run import draw_runs
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


SERVO = "rulebases/servo.frb"
OWN = "examples/controllers"
STRUCTURES = {
    "pd": f"{SERVO} --plant motor --step 1 --for 400ms",
    "incremental-pi": f"{OWN}/incremental-pi.frb --plant motor --reference velocity=step:20",
    "pd-plus-i": f"{SERVO} {OWN}/pd-plus-i.frb --plant motor --step 1 --disturb voltage=step:-2,1",
    "scheduled-pid": f"rulebases/tanks.frb {OWN}/scheduled-pid.frb --plant tanks --step 0.1",
    "supervisor": f"{OWN}/supervisor.frb --plant tanks --step 0.2",
    "stfc": "fuzzy-direct stfc --payload",
    "cfaf": "fuzzy-direct cfaf --payload",
    "soc": "soc-zero --payload",
    "hfie": "fuzzy-direct hfie --payload",
    "hybrid": "cdid cdid+fuzzy --payload",
    "feed-forward": f"{SERVO} {OWN}/feed-forward.frb --plant motor --reference position=sine:1,1",
    "model-reference": f"{SERVO} {OWN}/model-reference.frb --plant motor --step 1 --set J=0.03",
}
"""What ``fuzzyarm simulate`` is asked for the figure of each structure."""


def draw_structures(wanted: list[str]) -> None:
    """Draw a run of each structure of ``docs/structures.md``, or of those that are wanted."""
    for name, words in STRUCTURES.items():
        if wanted and name not in wanted:
            continue
        path = PICTURES / f"structure-{name}.png"
        main(["simulate", *words.split(), "--plot", str(path)])
        picture = Image.open(path).convert("RGB")
        picture.thumbnail((900, 900))
        picture.quantize(64).save(path, optimize=True)


def draw_map() -> None:
    """Draw the robustness map of pid over payload and integral gain."""
    ranges = ["--sweep", "payload=0..2:21", "--sweep", "K_I=0.1..10:24 log"]
    main(["sweep", "pid", *ranges, "--plot", str(PICTURES / "sweep-map.png")])


FRAMES = 40
"""Of an animation; more make the files large."""

RUNS = {
    "arm": ("stfc.frb", {}, None, Options()),
    "motor": (
        "servo.frb",
        {"position": Signal("step", (1.0, 0.1))},
        0.6,
        Options(sensors={"position": Sensor(resolution=0.001)}),
    ),
    "cartpole": ("cartpole.frb", {"x": Signal("step", (1.0, 1.0))}, None, Options()),
    "tanks": ("tanks.frb", {"level2": Signal("step", (0.15, 20.0, 0.05))}, 200.0, Options()),
    "ball-and-beam": (
        "ball-and-beam.frb",
        {"position": Signal("sine", (0.2, 0.1))},
        None,
        Options(),
    ),
    "room": ("heater.frb", {"temperature": Signal("step", (21.0, 3600.0, 18.0))}, None, Options()),
}
"""The run that stands for each shipped plant: controller, references, duration, options."""


def draw_plants(wanted: list[str]) -> None:
    """Draw and animate a run on each shipped plant, or on those that are wanted."""
    for name, (controller, references, duration, options) in RUNS.items():
        if wanted and name not in wanted:
            continue
        plant = find_plant(name)
        chosen = load(shipped(controller))
        if name == "arm":
            run = simulate(chosen, pick_and_place(), payload=True, options=options)
        else:
            run = simulate(chosen, plant, references=references, duration=duration, options=options)
        draw_runs([run]).savefig(PICTURES / f"plant-{name}.png", dpi=80)
        animate(run, plant, PICTURES / f"plant-{name}.gif", frames=FRAMES)


def draw_type_2() -> None:
    """Draw the footprint of uncertainty, and one inference between two."""
    rulebase = load_rulebase(shipped("tipper2.frb"))
    trace = explain(rulebase, service=2, food=3)
    figures = {"terms": rulebase_figure(rulebase), "inference": inference_figure(rulebase, trace)}
    for name, figure in figures.items():
        figure.savefig(PICTURES / f"type2-{name}.png", dpi=80)


def draw_phase() -> None:
    """Draw the phase portrait of the shipped servo."""
    out = str(PICTURES / "servo-phase.png")
    main(["plot", str(shipped("servo.frb")), "-o", out, "--what", "phase", "--plant", "motor"])


if __name__ == "__main__":
    PICTURES.mkdir(exist_ok=True)
    words = sys.argv[1:]
    if not words:
        draw_table()
        draw_surface()
        draw_map()
        draw_phase()
    if not words or words == ["type2"]:
        draw_type_2()
    if not words or words == ["structures"] or set(words) & set(STRUCTURES):
        draw_structures([word for word in words if word != "structures"])
    if not words or words == ["plants"] or set(words) & set(RUNS):
        draw_plants([word for word in words if word != "plants"])
