"""Draw a file again whenever it is saved, for people who keep their own editor.

Shows the control surface, the rules and the findings of a rule base, or a lookup table.
While the text has mistakes they are shown above the last good drawing. With --table the
compiled table is written at each save, with --figure a figure (.png, .svg or .pdf).
Ctrl-C ends it.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.text.diagnostic import render_all

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

    from fuzzyarm.studio.document import StudioDocument


VIEWS = ("surface", "rules", "terms", "firing", "numbers")
_USUAL = ("surface", "rules", "numbers")
_PAUSE = 0.2
_WIDEST, _SURFACE_HEIGHT = 76, 16


class WatchError(FuzzyarmError, ValueError):
    """What was asked for makes no sense for this file."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm watch``."""
    parser.add_argument("file", metavar="FILE", help="a .frb or .lut file")
    parser.add_argument("--table", metavar="OUT", help="write the compiled table at each save")
    parser.add_argument("--figure", metavar="FIG", help="write a figure at each save")
    parser.add_argument("--at", metavar="NAME=VALUE,...", help="the crisp inputs (the middle)")
    parser.add_argument(
        "--view",
        action="append",
        choices=VIEWS,
        help="what to draw, once or several times (surface and rules; of a table its numbers)",
    )
    parser.add_argument("--once", action="store_true", help="draw once and end, for scripts")


def run(arguments: argparse.Namespace) -> int:
    """Draw until Ctrl-C; with ``--once`` return 1 if the file has errors."""
    from fuzzyarm.show.drawing import make_console
    from fuzzyarm.studio.document import StudioDocument

    _demand_sense(arguments)
    # Taken before the file is read: a save in between is then seen as one.
    seen = _stamp(arguments.file)
    document = StudioDocument(arguments.file)
    console = make_console()
    _redraw(console, document, arguments)
    if arguments.once:
        return int(document.broken)
    try:
        _follow(console, document, arguments, seen)
    except KeyboardInterrupt:
        if console.is_terminal:
            console.print()
    return 0


def _demand_sense(arguments: argparse.Namespace) -> None:
    if arguments.figure:
        from fuzzyarm.show.figures.style import require_figure_suffix

        require_figure_suffix(arguments.figure)
    if arguments.table and Path(arguments.file).suffix.lower() == ".lut":
        raise WatchError(f"{arguments.file} is a table already", hint="leave out --table")
    for target in (arguments.table, arguments.figure):
        if target and Path(target).resolve() == Path(arguments.file).resolve():
            raise WatchError(f"{target} is the file that is watched")


def _follow(
    console: Console,
    document: StudioDocument,
    arguments: argparse.Namespace,
    seen: tuple[int, int, int] | None,
) -> None:
    while True:
        time.sleep(_PAUSE)
        stamp = _stamp(document.path)
        # An editor that replaces the file takes it away for a moment.
        if stamp is None or stamp == seen:
            continue
        seen = stamp
        try:
            from fuzzyarm.language import read_text

            text = read_text(document.path)
        except FileNotFoundError:
            seen = None
            continue
        except (OSError, FuzzyarmError) as error:
            console.print(f"fuzzyarm: {error}", style="red")
            continue
        document.update(text)
        _redraw(console, document, arguments)


def _stamp(path: str) -> tuple[int, int, int] | None:
    try:
        status = Path(path).stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size, status.st_ino


def _redraw(console: Console, document: StudioDocument, arguments: argparse.Namespace) -> None:
    if arguments.at and document.scene is not None:
        from fuzzyarm.cli.arguments import read_assignments

        document.scene.point |= read_assignments([arguments.at], list(document.scene.ranges))
    notes = [] if document.broken else _write_products(document, arguments)
    if console.is_terminal:
        console.clear()
    console.print(picture(document, min(console.width, _WIDEST), arguments.view or _USUAL))
    for note in notes:
        console.print(note)
    sys.stdout.flush()


def _write_products(document: StudioDocument, arguments: argparse.Namespace) -> list[str]:
    """Write the table and the figure; say so, or why not: watching goes on."""
    notes = []
    rulebase = document.session.review().rulebase
    for target, write in ((arguments.table, _write_table), (arguments.figure, _write_figure)):
        if not target:
            continue
        try:
            write(document, rulebase, target)
            notes.append(f"{target}: written")
        except (FuzzyarmError, OSError) as error:
            notes.append(f"{target}: not written: {error}")
    return notes


def _write_table(document: StudioDocument, rulebase: RuleBase | None, target: str) -> None:
    from fuzzyarm.table import compile_table, write_table

    assert rulebase is not None, "a sound rule base comes with its model"
    write_table(compile_table(rulebase), target)


def _write_figure(document: StudioDocument, rulebase: RuleBase | None, target: str) -> None:
    from fuzzyarm.show.figures.rulebase import rulebase_figure
    from fuzzyarm.show.figures.style import save_figure
    from fuzzyarm.show.figures.surface import table_figure

    if rulebase is not None:
        save_figure(rulebase_figure(rulebase), target)
        return
    from fuzzyarm.table import read_table

    save_figure(table_figure(read_table(document.path)), target)


def picture(document: StudioDocument, width: int, views: Sequence[str] = _USUAL) -> RenderableType:
    """Return the findings and the drawings of a file.

    Parameters
    ----------
    document : StudioDocument
        The file.
    width : int
        Columns to draw in.
    views : sequence of str
        Which drawings; those that the file does not have are left out.
    """
    from rich.console import Group
    from rich.text import Text

    from fuzzyarm.studio.scene import findings_text

    head = Text(document.path, "bold")
    head.append(f"   {findings_text(document.findings)}   {time.strftime('%H:%M:%S')}", "not bold")
    parts: list[RenderableType] = [head, Text()]
    if document.findings:
        said = render_all(document.findings, document.text)
        parts += [Text(said, "red" if document.broken else "yellow"), Text()]
    scene = document.scene
    if scene is None:
        return Group(*parts)
    if not document.is_current:
        parts += [Text("the drawing shows the last sound text", "yellow"), Text()]
    for view in (name for name in scene.VIEWS if name in views):
        parts += [scene.draw(view, width, _SURFACE_HEIGHT), Text()]
    parts.append(scene.caption(keys=False))
    return Group(*parts)
