"""Write a rule base and see what it means, as you type.

The text is on the left; on the right stands what it means: the control surface, the rules,
the terms, and which rules fire at the crisp inputs, which the arrow keys move. Findings
stand below. Works in a terminal of 80 × 24, over ssh, with the mouse or without; F1 shows
the keys. Needs: pip install "fuzzyarm[studio]"
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from fuzzyarm.cli.main import demand_extra
from fuzzyarm.errors import FuzzyarmError


class StudioError(FuzzyarmError, OSError):
    """The studio cannot be opened."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm studio``."""
    parser.add_argument("file", metavar="FILE", help="a .frb or .lut file")


def run(arguments: argparse.Namespace) -> int:
    """Open the studio; return when it is left."""
    demand_extra("textual", "studio", "the studio")
    if not Path(arguments.file).exists():
        name = Path(arguments.file).with_suffix("")
        raise StudioError(
            f"there is no file {arguments.file}", hint=f"fuzzyarm new {name} writes one"
        )
    from fuzzyarm.studio.document import StudioDocument

    document = StudioDocument(arguments.file)
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise StudioError("the studio needs a terminal", hint="fuzzyarm show prints a drawing")
    from fuzzyarm.studio.app import Studio

    return Studio(document).run() or 0
