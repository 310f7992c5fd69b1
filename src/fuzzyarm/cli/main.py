"""Find the command, run it, turn errors into one line and an exit status.

The module of a command is imported when the command is called.
"""

from __future__ import annotations

import argparse
import gc
import importlib
import os
import sys
from collections.abc import Sequence

from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.text.diagnostic import RuleBaseError

# --- The commands ---
#
# A command is two functions of its module: `configure(parser)`, which adds its arguments, and
# `run(arguments) -> int`, which does the work and returns the exit status; the docstring of the
# module is its help. In a module of several commands the functions carry the command's name
# (`configure_fmt`, `run_fmt`) and the help is a constant (`DESCRIPTION_FMT`).

COMMANDS: dict[str, tuple[str, str]] = {
    "check": ("fuzzyarm.cli.check:check", "find mistakes and doubts in rule bases and tables"),
    "fmt": ("fuzzyarm.cli.check:fmt", "rewrite rule bases in canonical form"),
    "eval": ("fuzzyarm.cli.eval", "the outputs at one point, and why"),
    "show": ("fuzzyarm.cli.show:show", "rules, terms and tables in the terminal"),
    "plot": ("fuzzyarm.cli.show:plot", "terms and control surfaces as a figure"),
    "compile": ("fuzzyarm.cli.compile", "sample a rule base to a lookup table"),
    "diff": ("fuzzyarm.cli.diff", "what differs between two tables or rule bases"),
    "convert": ("fuzzyarm.cli.convert", "rule bases of other programs, in and out"),
    "corpus": ("fuzzyarm.cli.corpus", "how a folder of other programs' files comes in"),
    "simulate": ("fuzzyarm.cli.simulate", "run a controller on the robot arm"),
    "learn": ("fuzzyarm.cli.learn", "train a table on the robot arm and see it grow"),
    "reproduce": ("fuzzyarm.cli.study:reproduce", "run the study's published experiments again"),
    "identify": ("fuzzyarm.cli.study:identify", "fit unprinted gains to published figures"),
    "new": ("fuzzyarm.cli.new", "a commented rule base to start from"),
    "studio": ("fuzzyarm.cli.studio", "write a rule base and see what it means, as you type"),
    "watch": ("fuzzyarm.cli.watch", "draw a file again whenever it is saved"),
    "lsp": ("fuzzyarm.cli.lsp", "the language server for editors"),
    "demo": ("fuzzyarm.cli.demo", "the whole story on a shipped rule base"),
}
"""Name → (module, one-line summary), in the order of the help page.

Behind a colon stands the name that the functions of a command carry in a shared module.
"""


# --- Finding and running a command ---

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
    if sys.stderr.isatty():
        from fuzzyarm.kernels import watch_compiling

        watch_compiling(_show_compiling)
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
    home, summary = COMMANDS[command]
    module_name, _, part = home.partition(":")
    module = importlib.import_module(module_name)
    suffix = f"_{part}" if part else ""
    description = getattr(module, f"DESCRIPTION_{part.upper()}") if part else module.__doc__
    parser = argparse.ArgumentParser(
        prog=f"fuzzyarm {command}",
        description=description or summary,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    getattr(module, f"configure{suffix}")(parser)
    # Options may stand anywhere among the names, as in `eval FILE --json e=1 ce=2`.
    run = getattr(module, f"run{suffix}")
    status = run(parser.parse_intermixed_args(words[1:]))
    sys.stdout.flush()
    return int(status)


def _show_compiling(name: str | None) -> None:
    """Say in one line of the terminal what is being compiled; wipe the line afterwards."""
    untouched = sys.stderr is sys.__stderr__
    if not untouched:  # a live display has taken over and shows that something happens
        return
    told = f"compiling machine code, once: {name}" if name else ""
    sys.stderr.write(f"\r\x1b[2K{told}")
    sys.stderr.flush()


def _all_mistakes(error: RuleBaseError) -> str:
    from fuzzyarm.language.reading import text_to_show
    from fuzzyarm.text.diagnostic import render_all

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


# --- What is installed only on request ---


class MissingExtraError(FuzzyarmError, ImportError):
    """A command needs an extra that is not installed.

    Attributes
    ----------
    extra : str
        Its name in ``fuzzyarm[...]``.
    """

    def __init__(self, extra: str, what: str) -> None:
        super().__init__(f'{what} needs an extra: pip install "fuzzyarm[{extra}]"')
        self.extra = extra


def demand_extra(module: str, extra: str, what: str) -> None:
    """Raise `MissingExtraError` unless `module` can be imported.

    Parameters
    ----------
    module : str
        The library that the extra brings.
    extra : str
        The name of the extra.
    what : str
        What needs it, for the message.
    """
    from importlib.util import find_spec

    if find_spec(module) is None:
        raise MissingExtraError(extra, what)
