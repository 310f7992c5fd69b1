"""Completion for shells: ``fuzzyarm --print-completion bash``, from the records of all commands."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from fuzzyarm.cli.command import print_error
from fuzzyarm.cli.main import COMMANDS, EXIT_USAGE, find_command

SHELLS = ("bash", "zsh", "tcsh")

_FILES = {"FILE", "OUT", "FIG", "DATA", "MODEL", "IN", "A", "B", "PLANT", "CONTROLLER"}
"""What values are called on the help pages that are files, up to a dot, as in ``FILE.frb``."""


def whole_parser() -> argparse.ArgumentParser:
    """Return one parser of all commands; to run one takes only its own."""
    import shtab

    parser = argparse.ArgumentParser(prog="fuzzyarm", description="Fuzzy controllers as text.")
    parser.add_argument("--version", "-V", action="store_true", help="print the version")
    parser.add_argument("--print-completion", choices=SHELLS, help="print a script for a shell")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND")
    for name, (_, summary) in COMMANDS.items():
        own = commands.add_parser(name, help=summary)
        for action in find_command(name).add_to(own):
            values = str(action.metavar).partition(".")[0]
            if values == "DIR":
                action.complete = shtab.DIRECTORY  # type: ignore[attr-defined]
            elif values in _FILES:
                action.complete = shtab.FILE  # type: ignore[attr-defined]
    return parser


def print_completion(words: Sequence[str]) -> int:
    """Print the script that a shell completes with; return the exit status."""
    if len(words) != 1 or words[0] not in SHELLS:
        print_error(f"--print-completion takes a shell: {', '.join(SHELLS)}")
        return EXIT_USAGE
    import shtab

    print(shtab.complete(whole_parser(), shell=words[0]))
    return 0
