"""A rule base as text and as a picture, in a browser.

The text is the model: a dragged corner or a chosen cell is an edit of the text, and typed text
is drawn at once. A folder offers its files; nothing outside it is read or written. The page is
served to this machine only, under an address with a token, the first line of the output. Ctrl-C
ends it.

The view Run runs a controller on a shipped plant or that of --plant; the page executes no other
Python.

  fuzzyarm designer rulebases/pd7.frb
  fuzzyarm designer servo.frb --plant mine.py:Crane
"""

from __future__ import annotations

import argparse
import contextlib
from pathlib import Path

from fuzzyarm.apps.cli.command import always, argument, command, flag, hush, say
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.shipped_files import missing_file_hint


class DesignerError(FuzzyarmError, OSError):
    """The designer cannot be opened."""


def _run(arguments: argparse.Namespace) -> int:
    path = Path(arguments.file)
    if not path.exists() and path.suffix:
        raise DesignerError(
            f"there is no file {arguments.file}",
            hint=missing_file_hint(path)
            or "`fuzzyarm designer FOLDER` makes new files, in a new folder too",
        )
    from fuzzyarm.apps.designer.folder import SUFFIXES
    from fuzzyarm.apps.designer.server import serve

    if path.exists() and not path.is_dir() and path.suffix.lower() not in SUFFIXES:
        raise DesignerError(f"{arguments.file} is neither a .frb nor a .lut file")

    hush()

    def announce(address: str) -> None:
        print(address, flush=True)
        if not arguments.no_browser:
            import webbrowser

            webbrowser.open(address)

    def farewell(names: list[str]) -> None:
        say(
            f"not saved: {', '.join(names)}. A page that is still open keeps its text, and sends it"
            " when the designer runs again.",
            to_errors=True,
        )

    with contextlib.suppress(KeyboardInterrupt):
        serve(path, arguments.port, announce, arguments.plant, farewell)
    return 0


def _port(text: str) -> int:
    if not text.isdigit() or int(text) > 65535:
        raise argparse.ArgumentTypeError(f"'{text}' is not a port, 0 to 65535")
    return int(text)


COMMANDS = (
    command(
        "designer",
        __doc__,
        _run,
        argument("file FILE", "a .frb or .lut file, or a folder of them; it may be empty, or new"),
        argument(
            "--port N",
            "the port; 0: any free one (default: always the same for a folder, if free)",
            type=_port,
        ),
        flag("--no-browser", "only print the address"),
        argument(
            "--plant PLANT",
            "let the page run this plant: FILE.py or FILE.py:CLASS; as often as needed",
            action="append",
            default=[],
        ),
        rewrites=always,
    ),
)
