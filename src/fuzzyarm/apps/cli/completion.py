"""Completion for shells: ``fuzzyarm --print-completion bash``, from the records of all commands."""

from __future__ import annotations

import argparse
from collections.abc import Iterable

from fuzzyarm.apps.cli.command import Command

SHELLS = ("bash", "zsh", "tcsh")

_FILES = {"FILE", "OUT", "FIG", "DATA", "MODEL", "IN", "A", "B", "PLANT", "CONTROLLER"}
"""Names of file values on the help pages, up to a dot as in ``FILE.frb``."""


def completion_script(shell: str, commands: Iterable[tuple[Command, str]]) -> str:
    """Return the completion script of a shell."""
    import shtab

    script: str = shtab.complete(_whole_parser(commands), shell=shell)
    return script


def _whole_parser(records: Iterable[tuple[Command, str]]) -> argparse.ArgumentParser:
    """Return one parser of all commands (a run builds its own command's only)."""
    import shtab

    parser = argparse.ArgumentParser(prog="fuzzyarm", description="Fuzzy controllers as text.")
    parser.add_argument("--version", "-V", action="store_true", help="print the version")
    parser.add_argument("--print-completion", choices=SHELLS, help="print a script for a shell")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND")
    for command, summary in records:
        subparser = commands.add_parser(command.name, help=summary)
        for action in command.add_to(subparser):
            _offer_names(action)
            values = str(action.metavar).partition(".")[0]
            if values == "DIR":
                action.complete = shtab.DIRECTORY  # type: ignore[attr-defined]
            elif values in _FILES:
                action.complete = shtab.FILE  # type: ignore[attr-defined]
    return parser


def _offer_names(action: argparse.Action) -> None:
    """Offer shipped plants and their trajectories, not exclusively."""
    from fuzzyarm.plant import PLANTS

    if "--plant" in action.option_strings:
        action.choices = list(PLANTS)
    elif "--trajectory" in action.option_strings:
        ways = [name for kind in PLANTS.values() for name in kind.trajectories]
        action.choices = list(dict.fromkeys(ways))
