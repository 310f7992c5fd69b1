"""Find the command, run it, turn errors into one line and an exit status."""

from __future__ import annotations

import argparse
import gc
import importlib
import os
import sys
from collections.abc import Sequence

from fuzzyarm.cli.commands import COMMANDS
from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.rulebase.diagnostic import RuleBaseError

EXIT_INPUT = 1
EXIT_USAGE = 2
EXIT_INTERRUPTED = 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command.

    Parameters
    ----------
    arguments : sequence of str, optional
        Words after ``fuzzyarm``; those of the process by default.

    Returns
    -------
    int
        0 = fine, 1 = the input is at fault, 2 = wrong usage, 130 = interrupted.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    # A command makes many small objects and ends soon: looking for cycles among them takes
    # longer than reading the file that they come from.
    gc.set_threshold(200_000)
    try:
        return _dispatch(words)
    except SystemExit as stop:  # argparse leaves this way after --help or a usage error
        return stop.code if isinstance(stop.code, int) else EXIT_USAGE
    except RuleBaseError as error:
        print(_all_mistakes(error), file=sys.stderr)
        return EXIT_INPUT
    except FuzzyarmError as error:
        print(f"fuzzyarm: {error}", file=sys.stderr)
        return EXIT_INPUT
    except OSError as error:
        return _input_output_error(error)
    except KeyboardInterrupt:
        print("fuzzyarm: interrupted", file=sys.stderr)
        return EXIT_INTERRUPTED


def _dispatch(words: list[str]) -> int:
    command = next((word for word in words if not word.startswith("-")), None)
    if command not in COMMANDS or words[0] != command:
        return _overview(words, command)
    module_name, summary = COMMANDS[command]
    module = importlib.import_module(module_name)
    parser = argparse.ArgumentParser(
        prog=f"fuzzyarm {command}",
        description=module.__doc__ or summary,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    module.configure(parser)
    # Options may stand anywhere among the names, as in `eval FILE --json e=1 ce=2`.
    status = module.run(parser.parse_intermixed_args(words[1:]))
    sys.stdout.flush()
    return int(status)


def _all_mistakes(error: RuleBaseError) -> str:
    from fuzzyarm.rulebase.parsing import text_to_show
    from fuzzyarm.rulebase.rendering import render_all

    errors = [diagnostic for diagnostic in error.diagnostics if diagnostic.is_error]
    try:
        text = text_to_show(errors[0].path)
    except (OSError, ValueError, IndexError):
        text = ""
    return render_all(errors, text)


def _overview(words: list[str], command: str | None) -> int:
    if words and words[0] in {"--version", "-V"}:
        from fuzzyarm import __version__

        print(f"fuzzyarm {__version__}")
        return 0
    if not words or words[0] in {"-h", "--help", "help"}:
        print(_help_page())
        return 0 if words else EXIT_USAGE
    import difflib

    near = difflib.get_close_matches(command or words[0], COMMANDS, n=1)
    hint = f"; did you mean '{near[0]}'?" if near else "; see fuzzyarm --help"
    print(f"fuzzyarm: no command '{command or words[0]}'{hint}", file=sys.stderr)
    return EXIT_USAGE


def _help_page() -> str:
    width = max(map(len, COMMANDS))
    lines = [f"  {name:<{width}}  {summary}" for name, (_, summary) in COMMANDS.items()]
    return "\n".join(
        [
            "usage: fuzzyarm COMMAND [...]",
            "",
            "Write a fuzzy controller as a text file, see it, check it, compile it to a",
            "lookup table, and run it on a robot arm.",
            "",
            *lines,
            "",
            "fuzzyarm COMMAND --help tells the options of one command.",
        ]
    )


def _input_output_error(error: OSError) -> int:
    if isinstance(error, BrokenPipeError):
        # The reader (head, less) has gone: not a fault, but nothing more may be written.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    place = f"{error.filename}: " if error.filename else ""
    print(f"fuzzyarm: {place}{error.strerror or error}", file=sys.stderr)
    return EXIT_INPUT
