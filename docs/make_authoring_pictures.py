"""Make the pictures of docs/authoring.md: `python docs/make_authoring_pictures.py`.

Everything shown is what the program itself prints, draws or answers.
"""

from __future__ import annotations

import asyncio
import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from rich.console import Console, Group
from rich.padding import Padding
from rich.panel import Panel
from rich.text import Text

from fuzzyarm.api import check_text
from fuzzyarm.language.queries import coloured, complete, fixes, hover, read
from fuzzyarm.studio.app import Studio
from fuzzyarm.studio.document import StudioDocument

ROOT = Path(__file__).parents[1]
HERE = ROOT / "docs" / "pictures"
RULEBASES = ROOT / "rulebases"
_FONT_FACE = re.compile(r"@font-face\s*\{.*?\}", re.DOTALL)
_FONTS = "ui-monospace, Menlo, Consolas, DejaVu Sans Mono, monospace"


def save(svg: str, name: str) -> None:
    """Write a picture without the fonts that it would fetch from elsewhere."""
    svg = _FONT_FACE.sub("", svg)
    svg = re.sub(r"font-family:\s*Fira Code[^;]*;", f"font-family: {_FONTS};", svg)
    (HERE / f"{name}.svg").write_text(svg, "utf-8")


def recorded(title: str, *drawings: object, width: int = 92, name: str) -> None:
    """Draw into a picture of a terminal."""
    console = Console(
        record=True, width=width, file=io.StringIO(),
        force_terminal=True, color_system="truecolor", highlight=False,
    )  # fmt: skip
    console.print(*drawings, sep="\n")
    save(console.export_svg(title=title), name)


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
    return shown + Text.from_ansi(done.stdout + done.stderr)


async def studio(file: Path, keys: list[str], name: str, size: tuple[int, int] = (80, 24)) -> None:
    """Press keys in the studio and keep the screen."""
    app = Studio(StudioDocument(file))
    async with app.run_test(size=size) as pilot:
        await pilot.pause()
        await pilot.press(*keys)
        app.read_text()
        await pilot.pause(0.2)
        save(app.export_screenshot(title=f"fuzzyarm studio {file.name}"), name)


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


def main() -> None:
    """Make every picture."""
    editor_pictures()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file in ("pd7.frb", "thermostat.frb", "fan.frb"):
            shutil.copy(RULEBASES / file, folder / file)
        recorded("new", command("new", "joint", "--kind", "pi", folder=folder),
                 Text(), command("check", "--strict", "joint.frb", folder=folder),
                 Text(), coloured_text((folder / "joint.frb").read_text("utf-8"), range(1, 29)),
                 width=116, name="new")  # fmt: skip
        recorded("watch", command("watch", "thermostat.frb", "--once", folder=folder), name="watch")
        recorded(
            "eval --explain",
            command("eval", "pd7.frb", "e=1.3", "ce=-2", "--explain", folder=folder),
            name="explain",
        )
        figure = folder / "explained.svg"
        point = ("eval", "pd7.frb", "e=1.3", "ce=-2")
        command(*point, "--explain", "--plot", figure.name, folder=folder)
        shutil.copy(figure, HERE / "explained.svg")
        asyncio.run(studio(folder / "pd7.frb", ["tab", "shift+right", "shift+down"],
                           "studio-surface"))  # fmt: skip
        asyncio.run(
            studio(folder / "thermostat.frb", ["f3", "tab", "right", "down"], "studio-rules")
        )
        asyncio.run(studio(folder / "pd7.frb", ["f5", "tab", *["right"] * 2, *["down"] * 3],
                           "studio-firing"))  # fmt: skip
        asyncio.run(studio(folder / "fan.frb", ["f4", *["down"] * 4, "right", "x"],
                           "studio-broken", (100, 28)))  # fmt: skip


if __name__ == "__main__":
    main()
