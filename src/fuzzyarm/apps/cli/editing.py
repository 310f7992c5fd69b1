"""While a file is written: ``fuzzyarm watch`` and ``fuzzyarm lsp``."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, cast

from fuzzyarm.apps.cli.command import (
    FORCE,
    WordError,
    always,
    argument,
    at,
    command,
    demand_figure,
    flag,
    hush,
    print_error,
)
from fuzzyarm.base.assignments import read_assignments
from fuzzyarm.base.diagnostic import render_all
from fuzzyarm.base.errors import FuzzyarmError, demand_extra, sentence_of
from fuzzyarm.base.files import same_file, stamp_of
from fuzzyarm.language.model.rulebase import RuleBase

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

    from fuzzyarm.apps.watch.document import WatchedFile
    from fuzzyarm.apps.watch.keys import ReadKey


_WATCH = """Draw a file again whenever it is saved, for people who keep their own editor.

Shows the control surface, the rules and the findings of a rule base, or a lookup table.
Mistakes in the text are shown above the last good drawing. --table writes the compiled table
at each save, --figure a figure (.png, .svg or .pdf). In a terminal the arrow keys move the crisp
inputs (with shift further), c centres them, x and y assign other inputs to the arrows, o shows
the next output; q or Ctrl-C ends it.
"""

_VIEWS = ("surface", "rules", "terms", "firing", "numbers")
_USUAL = ("surface", "rules", "numbers")
_PAUSE = 0.2
_WIDEST, _SURFACE_HEIGHT = 76, 16


def _watch(arguments: argparse.Namespace) -> int:
    from fuzzyarm.apps.show.drawing import make_console
    from fuzzyarm.apps.watch.document import WatchedFile

    _demand_sense(arguments)
    # Before the file is read: a save in between then counts as a change.
    stamp = stamp_of(arguments.file)
    document = WatchedFile(arguments.file)
    console = make_console()
    if arguments.once:
        written = _redraw(console, document, arguments)
        if document.broken:
            print_error(f"{arguments.file}: {document.summary}")
        return int(document.broken or not written)
    hush()
    from fuzzyarm.apps.watch.keys import keys_of_terminal

    try:
        # Before the first drawing, so that an early key is not lost.
        with keys_of_terminal() as read_key:
            _redraw(console, document, arguments)
            _follow(console, document, arguments, stamp, read_key)
    except KeyboardInterrupt:
        if console.is_terminal:
            console.print()
    return 0


def _demand_sense(arguments: argparse.Namespace) -> None:
    if arguments.figure:
        demand_figure(arguments.figure)
    if arguments.table and Path(arguments.file).suffix.lower() == ".lut":
        raise WordError(f"{arguments.file} is a table already", hint="leave out --table")
    for target in (arguments.table, arguments.figure):
        if target and same_file(target, arguments.file):
            raise WordError(f"{target} is the file that is watched")


def _follow(
    console: Console,
    document: WatchedFile,
    arguments: argparse.Namespace,
    last_stamp: tuple[int, int, int] | None,
    read_key: ReadKey,
) -> None:
    from fuzzyarm.apps.watch.keys import apply_key

    while (key := read_key(_PAUSE)) != "q":
        if key and document.scene is not None and apply_key(document.scene, key):
            _draw(console, document, arguments, [])
        stamp = stamp_of(document.path)
        # An editor that replaces the file removes it for a moment.
        if stamp is None or stamp == last_stamp:
            continue
        last_stamp = stamp
        try:
            from fuzzyarm.language import read_text

            text = read_text(document.path)
        except FileNotFoundError:
            last_stamp = None
            continue
        except (OSError, FuzzyarmError) as error:
            console.print(f"fuzzyarm: {error}", style="red")
            continue
        document.update(text)
        _redraw(console, document, arguments)


def _redraw(console: Console, document: WatchedFile, arguments: argparse.Namespace) -> bool:
    """Draw the file and write its products; return whether all were written."""
    if arguments.at and document.scene is not None:
        document.scene.point |= read_assignments([arguments.at], list(document.scene.ranges))
    notes, faults = ([], []) if document.broken else _write_products(document, arguments)
    _draw(console, document, arguments, [*notes, *faults])
    return not faults


def _draw(
    console: Console, document: WatchedFile, arguments: argparse.Namespace, notes: list[str]
) -> None:
    if console.is_terminal:
        console.clear()
    width, views = min(console.width, _WIDEST), arguments.view or _USUAL
    # Keys are explained only if they work.
    keys = console.is_terminal and not arguments.once
    console.print(_picture(document, width, views, keys=keys))
    for note in notes:
        console.print(note)
    sys.stdout.flush()


def _write_products(
    document: WatchedFile, arguments: argparse.Namespace
) -> tuple[list[str], list[str]]:
    """Write the table and the figure; return written files and failures, and continue watching."""
    notes, faults = [], []
    rulebase = document.session.review().rulebase
    for target, write in ((arguments.table, _write_table), (arguments.figure, _write_figure)):
        if not target:
            continue
        try:
            write(document, rulebase, target)
            notes.append(f"{target}: written")
        except (FuzzyarmError, OSError) as error:
            why = (isinstance(error, OSError) and error.strerror) or sentence_of(error)
            faults.append(f"{target}: not written: {why}")
    return notes, faults


def _write_table(document: WatchedFile, rulebase: RuleBase | None, target: str) -> None:
    from fuzzyarm.table import compile_table, write_table

    if rulebase is None:
        raise WordError(f"{document.path} is a controller: a table is made of a rule base")
    write_table(compile_table(rulebase), target)


def _write_figure(document: WatchedFile, rulebase: RuleBase | None, target: str) -> None:
    from fuzzyarm.apps.show.figures import rulebase_figure, save_figure, table_figure

    if rulebase is not None:
        save_figure(rulebase_figure(rulebase), target)
        return
    if Path(document.path).suffix.lower() == ".frb":
        raise WordError(f"{document.path} is a controller: a figure is drawn of a rule base")
    from fuzzyarm.table import read_table

    save_figure(table_figure(read_table(document.path)), target)


def _picture(
    document: WatchedFile, width: int, views: Sequence[str], *, keys: bool
) -> RenderableType:
    """Return the findings and the available `views` of the file."""
    from rich.console import Group
    from rich.text import Text

    head = Text(document.path, "bold")
    head.append(f"   {document.summary}   {time.strftime('%H:%M:%S')}", "not bold")
    parts: list[RenderableType] = [head, Text()]
    if document.findings:
        text = render_all(document.findings, document.text)
        parts += [Text(text, "red" if document.broken else "yellow"), Text()]
    scene = document.scene
    if scene is None:
        return Group(*parts)
    if not document.is_current:
        parts += [Text("the drawing shows the last sound text", "yellow"), Text()]
    for view in (name for name in scene.VIEWS if name in views):
        parts += [scene.draw(view, width, _SURFACE_HEIGHT), Text()]
    parts.append(scene.caption(keys=keys))
    return Group(*parts)


_LSP = """The language server for editors: diagnostics, completion, hover, rename and more.

Editors start it themselves and talk to it over its standard input and output; with
`--tcp PORT` (or HOST:PORT) it waits for one connection instead. docs/howto/authoring.md says how
to set up VS Code, Neovim and Helix. Needs the extra `lsp`, see docs/howto/install.md.
"""

_HOST = "127.0.0.1"


def _address(text: str) -> tuple[str, int]:
    host, _, port = text.rpartition(":")
    if not port.isdigit() or not 0 < int(port) < 65536:
        raise argparse.ArgumentTypeError(f"'{text}' is neither a port nor a host with a port")
    return host.strip("[]") or _HOST, int(port)


def _serve(arguments: argparse.Namespace) -> int:
    demand_extra("pygls", "lsp", "the language server")
    from fuzzyarm.apps.lsp.features import make_server
    from fuzzyarm.apps.lsp.server import MessageStream

    server = make_server()
    hush()
    if arguments.tcp is None:
        # The server closes its output at its end; a copy of ours stays open for the last line.
        stdin = cast("BinaryIO", MessageStream(sys.stdin.buffer))
        server.start_io(stdin, os.fdopen(os.dup(sys.stdout.fileno()), "wb"))
        return 0
    host, port = arguments.tcp
    print_error(f"waiting for an editor on {host}:{port}")
    server.start_tcp(host, port)
    return 0


_TEXT = argument("file FILE", "a .frb or .lut file")

COMMANDS = (
    command(
        "watch",
        _WATCH,
        _watch,
        _TEXT,
        argument("--table OUT", "write the compiled table at each save"),
        argument("--figure FIG", "write a figure at each save"),
        FORCE,
        at("the crisp inputs (the middle)"),
        argument(
            "--view",
            "a part to draw, repeatable (surface and rules; of a table its numbers)",
            action="append",
            choices=_VIEWS,
        ),
        flag("--once", "draw once and end, for scripts"),
    ),
    command(
        "lsp",
        _LSP,
        _serve,
        flag("--stdio", "talk over stdin and stdout (usual)"),
        argument("--tcp [HOST:]PORT", "wait for a connection instead", type=_address),
        rewrites=always,
    ),
)
