"""Draw the pictures of the README and the documentation again.

    python tools/make_pictures.py            # all of them
    python tools/make_pictures.py plants     # runs on the shipped plants alone
    python tools/make_pictures.py structures # runs of each structure alone
    python tools/make_pictures.py type2      # interval type-2 alone
    python tools/make_pictures.py motor      # one of them
    python tools/make_pictures.py controllers # block diagrams alone
    python tools/make_pictures.py authoring  # editor and commands alone
    python tools/make_pictures.py small      # no picture again: all that there are, in 255 colours

Every picture comes from what a reader would use: commands, or the functions behind them.
`oxipng --zopfli` takes a tenth off them, without loss, before they are committed.
`tests/show/test_pictures.py` draws those that take no run of a plant again and compares them.
"""

from __future__ import annotations

import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image
from rich.color import Color
from rich.console import Console, Group
from rich.padding import Padding
from rich.panel import Panel
from rich.segment import Segment
from rich.style import Style
from rich.terminal_theme import TerminalTheme
from rich.text import Text

from fuzzyarm import explain, load, shipped
from fuzzyarm.apps.cli import main
from fuzzyarm.apps.show.figures import draw_runs, inference_figure, rulebase_figure
from fuzzyarm.apps.show.figures.animation import animate
from fuzzyarm.base.files import write_atomically
from fuzzyarm.control.controllers.own import find_controller
from fuzzyarm.control.loop import Options, Sensor, Signal, simulate
from fuzzyarm.exchange.files import check_text
from fuzzyarm.language import load_rulebase
from fuzzyarm.language.edit import coloured, complete, fixes, hover, read
from fuzzyarm.plant import find_plant, pick_and_place
from fuzzyarm.plant.following import trajectory_of

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "pictures"
RULEBASES = ROOT / "rulebases"


def do(words: list[str]) -> None:
    """Run a command; a picture that it refuses to draw stops the making."""
    status = main([*words, "--force"])  # a picture with fewer colours has no mark
    assert status == 0, words


def draw_table() -> None:
    """Draw the table of pd7.frb as a colour terminal shows it."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copy(RULEBASES / "pd7.frb", folder / "pd7.frb")
        command("compile", "pd7.frb", "-o", "pd7.lut", folder=folder)
        recorded("a table", command("show", "pd7.lut", folder=folder), name="pd7-table")


def draw_surface() -> None:
    """Draw the terms and the control surface of pd7.frb."""
    path = PICTURES / "pd7.png"
    do(["plot", str(shipped("pd7.frb")), "-o", str(path)])
    shrink(path, 100 / 150)


SERVO = "rulebases/servo.frb"
OWN = "examples/controllers"
STRUCTURES = {
    "pd": f"{SERVO} --plant motor --step 1 --for 400ms",
    "incremental-pi": f"{OWN}/incremental-pi.frb --plant motor --reference velocity=step:20",
    "pd-plus-i": f"{SERVO} {OWN}/pd-plus-i.frb --plant motor --step 1 --disturb voltage=step:-2,1",
    "scheduled-pid": (
        f"rulebases/tanks.frb {OWN}/scheduled-pid.frb --plant tanks --step 0.1 --for 150s"
    ),
    "fuzzy-pid": (
        f"{SERVO} {OWN}/pd-plus-i.frb {OWN}/scheduled-servo.frb {OWN}/linear-servo.frb"
        " --plant motor --step 1 --for 1s --disturb voltage=step:-4,0.5"
    ),
    "supervisor": f"{OWN}/supervisor.frb --plant tanks --step 0.2 --for 150s",
    "stfc": "fuzzy-direct stfc --payload",
    "cfaf": "fuzzy-direct cfaf --payload",
    "soc": "soc-zero --payload",
    "hfie": "fuzzy-direct hfie --payload",
    "hybrid": "cdid cdid+fuzzy --payload",
    "feed-forward": f"{SERVO} {OWN}/feed-forward.frb --plant motor --reference position=sine:1,1",
    "model-reference": f"{SERVO} {OWN}/model-reference.frb --plant motor --step 1 --set J=0.03",
    "smith": f"{OWN}/linear-heater.frb {OWN}/smith-heater.frb --plant room --step 21"
    " --actuator-delay power=10min",
    "cascade": f"{OWN}/cascade-servo.frb --plant motor --step 1 --disturb voltage=step:-2,1",
}
"""What ``fuzzyarm simulate`` is asked for the figure of each structure."""


def draw_structures(wanted: list[str]) -> None:
    """Draw a run of each structure of the pages, or of those that are wanted."""
    for name, words in STRUCTURES.items():
        if wanted and name not in wanted:
            continue
        path = PICTURES / f"structure-{name}.png"
        do(["simulate", *words.split(), "--plot", str(path)])
        shrink(path, 92 / 130)  # 92 dots per inch


def shrink(path: Path, factor: float = 1.0, colours: int = 64) -> None:
    """Write a picture smaller by a factor and with a palette, unless it grows by that."""
    picture = Image.open(path).convert("RGB")
    width, height = (round(factor * side) for side in picture.size)
    if factor < 1.0:
        picture = picture.resize((width, height), Image.Resampling.LANCZOS)
    buffer = io.BytesIO()
    # Half of the palette has what there is most of, half what differs most: lines stay apart.
    half = colours // 2
    palette = Image.new("P", (1, 1))
    palette.putpalette(
        [
            *(picture.quantize(half, dither=Image.Dither.NONE).getpalette() or ())[: 3 * half],
            *(picture.quantize(half, Image.Quantize.MAXCOVERAGE).getpalette() or ())[: 3 * half],
        ]
    )
    few = picture.quantize(palette=palette, dither=Image.Dither.NONE)
    few.save(buffer, "PNG", optimize=True)
    if factor < 1.0 or buffer.tell() < 0.9 * path.stat().st_size:
        write_atomically(path, buffer.getvalue())


def draw_map() -> None:
    """Draw the robustness map of pid over payload and integral gain."""
    ranges = ["--sweep", "payload=0..2:21", "--sweep", "K_I=0.1..10:24 log"]
    do(["sweep", "pid", *ranges, "--plot", str(PICTURES / "sweep-map.png")])


FRAMES = 20
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
            run = simulate(chosen, plant, reference=references, duration=duration, options=options)
        draw_runs([run]).savefig(PICTURES / f"plant-{name}.png", dpi=92)
        animate(run, plant, PICTURES / f"plant-{name}.gif", frames=FRAMES)


def draw_robot() -> None:
    """Animate PUMA 560 by MuJoCo's renderer."""
    robots = ROOT / "examples" / "robots"
    plant = find_plant(str(robots / "puma560.xml"))
    law = find_controller(f"ct+{robots / 'puma-fuzzy.frb'}")
    move = trajectory_of(plant, "pick-and-place", segment=1.0)
    run = simulate(law, plant, trajectory=move, payload=True)
    animate(run, plant, PICTURES / "puma560.gif", frames=FRAMES)


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
    do(["plot", str(shipped("servo.frb")), "-o", out, "--what", "phase", "--plant", "motor"])


def draw_sector() -> None:
    """Draw the sectors of the shipped servo, for the page of proofs."""
    out = str(PICTURES / "servo-sector.png")
    do(["prove", str(shipped("servo.frb")), "--sector", "--plot", out])


def draw_region() -> None:
    """Draw the proved region of the shipped servo, for the page of closed loops."""
    out = str(PICTURES / "servo-region.png")
    do(["prove", str(shipped("servo.frb")), "--plant", "motor", "--stable", "--plot", out])


# --- Of docs/howto/authoring.md: what the editor and the commands show ---

_FONT_FACE = re.compile(r"@font-face\s*\{.*?\}", re.DOTALL)
_FONTS = "ui-monospace, Menlo, Consolas, DejaVu Sans Mono, monospace"


def save(svg: str, name: str) -> None:
    """Write a picture without the fonts that it would fetch from elsewhere."""
    svg = _FONT_FACE.sub("", svg)
    svg = re.sub(r"font-family:\s*Fira Code[^;]*;", f"font-family: {_FONTS};", svg)
    (PICTURES / f"{name}.svg").write_text(svg, "utf-8")


TERMINAL = TerminalTheme(
    (30, 30, 30), (217, 217, 217),
    [(0, 0, 0), (204, 85, 90), (152, 168, 75), (208, 179, 68),
     (96, 138, 177), (152, 114, 159), (104, 160, 179), (245, 245, 245)],
    [(154, 155, 153), (255, 38, 39), (0, 130, 61), (208, 132, 66),
     (25, 132, 233), (255, 44, 122), (57, 130, 128), (253, 253, 197)],
)  # fmt: skip
"""The colours of rich's terminal, but black is black: numbers stand on coloured cells."""


def coarse(segment: Segment) -> Segment:
    """Round the colours of a segment: neighbours that look alike are then one element."""

    def rounded(colour: Color | None) -> Color | None:
        if colour is None or colour.triplet is None:
            return colour
        return Color.from_rgb(*(min(255, 12 * round(part / 12)) for part in colour.triplet))

    style = segment.style
    if style is None:
        return segment
    ends = Style(color=rounded(style.color), bgcolor=rounded(style.bgcolor))
    return Segment(segment.text, style + ends, segment.control)


def recorded(title: str, *drawings: object, width: int = 92, name: str) -> None:
    """Draw into a picture of a terminal."""
    console = Console(
        record=True, width=width, file=io.StringIO(),
        force_terminal=True, color_system="truecolor", highlight=False,
    )  # fmt: skip
    console.print(*drawings, sep="\n")
    console._record_buffer[:] = Segment.simplify(map(coarse, console._record_buffer))
    save(console.export_svg(title=title, theme=TERMINAL), name)


def command(*words: str, folder: Path = ROOT, status: int = 0) -> Text:
    """Return what a command prints, after a prompt."""
    environment = {**os.environ, "FORCE_COLOR": "1", "COLUMNS": "90", "COLORTERM": "truecolor",
                   "TERM": "xterm-256color"}  # fmt: skip
    done = subprocess.run(
        [sys.executable, "-m", "fuzzyarm", *words], cwd=folder, env=environment,
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == status, done.stderr
    shown = Text.assemble(("$ fuzzyarm " + " ".join(words) + "\n", "bold green"))
    clock = re.compile(r"\b\d\d:\d\d:\d\d\b")  # of `watch`
    return shown + Text.from_ansi(clock.sub("12:00:00", done.stdout + done.stderr))


def coloured_text(text: str, lines: range, mark: tuple[int, int] | None = None) -> Text:
    """Return some lines of a text in the colours of the server's semantic tokens."""
    styles = {
        "keyword": "bold blue", "namespace": "magenta", "variable": "cyan",
        "enumMember": "green", "modifier": "italic magenta", "type": "yellow",
        "property": "blue", "number": "bright_yellow", "string": "green",
        "comment": "italic bright_black", "operator": "white",
    }  # fmt: skip
    raw = text.splitlines()
    shown = Text()
    for number in lines:
        line = Text(f"{number:>3}  {raw[number - 1]}\n")
        for word in coloured(read(text)):
            if word.line == number:
                line.stylize(styles[word.colour], word.column + 4, word.end + 4)
        if mark is not None and mark[0] == number:
            line.stylize("reverse", mark[1] + 4, mark[1] + 5)
        shown.append_text(line)
    return shown


def editor_pictures() -> None:
    """Show what the language server answers, as an editor would show it."""
    text = (RULEBASES / "pd7.frb").read_text("utf-8")
    row = next(i for i, line in enumerate(text.splitlines(), 1) if line.startswith("  NS "))
    reading = read(text)
    cell = hover(reading, row, 15)
    assert cell is not None
    panel = Panel(Text(re.sub(r"\*\*|```(?:text)?\n?|`", "", cell.markdown).strip()), width=62)
    recorded(
        "hover: a grid cell is its rule in words",
        coloured_text(text, range(12, row + 1), (row, 15)),
        Padding(panel, (0, 0, 0, 14)),
        name="editor-hover",
    )
    line = "rule if ce is very "
    longer = f"{text}{line}\n"
    number = longer.count("\n")
    offered = complete(read(longer), number, len(line) + 1)
    items = Text()
    for candidate in offered[:9]:
        items.append(f"{candidate.label:<10}", "bold")
        items.append(f"{candidate.detail:<24}{candidate.kind}\n", "dim")
    recorded(
        "completion: exactly the terms of ce, then the hedges",
        coloured_text(longer, range(number - 2, number + 1), (number, len(line) + 1)),
        Padding(Panel(items, width=52), (0, 0, 0, 23)),
        name="editor-completion",
    )
    damaged = text.replace("PM  PB  PB  PB", "PM  PX  PB  PB").replace("input  ce", "inptu  ce")
    body = coloured_text(damaged, range(3, 8)) + coloured_text(damaged, range(18, 22))
    findings: list[Text] = []
    for found in check_text(damaged).diagnostics[:4]:
        shown = Text.assemble(
            (f"{found.line}:{found.column} ", "dim"), (found.message, "red"),
            (f"  {found.hint}" if found.hint else "", "italic"),
        )  # fmt: skip
        for fix in fixes(found, damaged)[:1]:
            shown.append(f"\n      quick fix: {fix.title}", "green")
        findings.append(shown)
    recorded(
        "findings while you type, with quick fixes", body, Group(*findings), name="editor-findings"
    )


def draw_authoring() -> None:
    """Draw what stands in docs/howto/authoring.md."""
    editor_pictures()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file in ("pd7.frb", "thermostat.frb", "fan.frb"):
            shutil.copy(RULEBASES / file, folder / file)
        recorded("new", command("new", "joint", "--kind", "pi", folder=folder),
                 Text(), command("check", "--strict", "joint.frb", folder=folder),
                 Text(), coloured_text((folder / "joint.frb").read_text("utf-8"), range(1, 29)),
                 width=123, name="new")  # fmt: skip
        recorded("watch", command("watch", "thermostat.frb", "--once", folder=folder), name="watch")
        recorded(
            "eval --explain",
            command("eval", "pd7.frb", "e=1.3", "ce=-2", "--explain", folder=folder),
            name="explain",
        )
        figure = folder / "explained.svg"
        point = ("eval", "pd7.frb", "e=1.3", "ce=-2")
        command(*point, "--explain", "--plot", figure.name, folder=folder)
        shutil.copy(figure, PICTURES / "explained.svg")


CONTROLLERS = {"tanks": [], "cfaf": ["--what", "diagram"]}
"""Of which controllers there are block diagrams, and what `plot` is told."""


def draw_controllers() -> None:
    """Draw the block diagrams of controllers."""
    for name, words in CONTROLLERS.items():
        path = PICTURES / f"controller-{name}.png"
        do(["plot", str(shipped(f"{name}.frb")), *words, "-o", str(path)])
        shrink(path, 100 / 150, 128)  # 100 dots per inch


if __name__ == "__main__":
    PICTURES.mkdir(exist_ok=True)
    words = sys.argv[1:]
    if not words:
        draw_table()
        draw_surface()
        draw_controllers()
        draw_map()
        draw_phase()
        draw_sector()
        draw_region()
    if words == ["small"]:
        for picture in sorted(PICTURES.glob("*.png")):
            shrink(picture)
    if words == ["controllers"]:
        draw_controllers()
    if not words or words == ["authoring"]:
        draw_authoring()
    if not words or words == ["type2"]:
        draw_type_2()
        draw_robot()
    if not words or words == ["structures"] or set(words) & set(STRUCTURES):
        draw_structures([word for word in words if word != "structures"])
    if not words or words == ["plants"] or set(words) & set(RUNS):
        draw_plants([word for word in words if word != "plants"])
