"""Find the command, run it, turn errors into one line and an exit status.

To add a command: its record in a module of this package and its line in ``COMMANDS``, under a
heading. Print a sentence (``print_error``) with any status but 0, use ``busy`` or
``progress_bar`` for long work, ``print_json`` for JSON. Help, completion and
``docs/reference/commands.md`` follow.
"""

from __future__ import annotations

import argparse
import atexit
import contextlib
import errno
import gc
import importlib
import os
import sys
import warnings
from collections.abc import Iterator, Sequence
from typing import TextIO, cast

from fuzzyarm import interrupts
from fuzzyarm.apps.cli.command import (
    EXIT_INTERRUPTED,
    EXIT_USAGE,
    Command,
    UsageError,
    announced,
    print_error,
    print_findings,
    print_os_error,
)
from fuzzyarm.base.columns import in_columns
from fuzzyarm.base.diagnostic import RuleBaseError
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.protected import sources_kept

COMMANDS: dict[str, tuple[str, str]] = {
    "new": ("start", "a commented rule base to start from"),
    "demo": ("start", "the whole story on a shipped rule base"),
    "shipped": ("start", "the files that come with fuzzyarm: list and copy them"),
    "check": ("check", "find mistakes and doubts in rule bases and tables"),
    "fmt": ("check", "rewrite rule bases in canonical form"),
    "designer": ("designer", "a rule base as text and picture, in a browser"),
    "playground": ("playground", "the designer as files for any web server, with its own Python"),
    "watch": ("editing", "draw a file again whenever it is saved"),
    "lsp": ("editing", "the language server for editors"),
    "eval": ("eval", "the outputs at one point, and why"),
    "show": ("show", "rules, terms and tables in the terminal"),
    "plot": ("show", "terms and control surfaces as a figure"),
    "diff": ("show", "the differences of two tables or rule bases"),
    "prove": ("prove", "statements about every point, with a bound or a counterexample"),
    "margins": ("margins", "gain, phase and delay margins of a loop, Bode and Nyquist"),
    "grade": ("grade", "students' rule bases, by hidden expect and prove lines"),
    "cite": ("cite", "whom to cite for the methods of a file, as BibTeX"),
    "compile": ("compile", "a lookup table, C, Structured Text or an FMU"),
    "convert": ("convert", "rule bases of other programs, in and out"),
    "simulate": ("simulate", "run controllers on the robot arm or any plant"),
    "sweep": ("sweep", "many runs over ranges of gains, plants and loads"),
    "compare": ("compare", "compare controllers: errors, chatter and cost"),
    "learn": ("learn", "train a table on the arm or any plant, see it grow"),
    "tune": ("tune", "move gains and terms until a cost is small, in the file itself"),
    "fit": ("fit", "learn a rule base from samples, as text"),
    "validate": ("validate", "judge a rule base by samples, region by region, rule by rule"),
    "reproduce": ("study", "run the study's published experiments again"),
    "identify": ("study", "fit unprinted gains to published figures"),
}
"""Name → module of this package and one-line summary, in the order of the help page.

A module is imported when one of its commands is called; its `COMMANDS` are the records.
"""

HEADINGS = {
    "new": "Start",
    "check": "Write and check",
    "eval": "See, ask and prove",
    "compile": "Into a device, and from other programs",
    "simulate": "In a closed loop",
    "fit": "From data",
    "reproduce": "The published study",
}
"""First command of a group on the help page → heading."""

GONE = {
    "studio": "fuzzyarm designer FILE edits in a browser, fuzzyarm watch FILE draws it",
    "corpus": "python tools/corpus.py DIR does it in a clone",
}
"""Commands of earlier versions → replacement."""

MEANT = {
    "export": "compile",
    "generate": "compile",
    "build": "compile",
    "lint": "check",
    "test": "check",
    "format": "fmt",
    "run": "simulate",
    "draw": "plot",
    "edit": "designer",
    "serve": "designer",
    "train": "learn",
    "optimize": "tune",
    "optimise": "tune",
    "verify": "prove",
    "infer": "eval",
    "evaluate": "eval",
    "import": "convert",
    "init": "new",
}
"""Other programs' words for a command, too far for a spelling correction."""

EXIT_INPUT = 1

ENDINGS = {
    EXIT_INPUT: "not accepted: the output above says why",
    3: "a run diverged, or a loop is not stable: the output above says which",
    4: "not everything is decided: see the open statements above",
}
"""Message for an exit status without one of the command's own."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command.

    Parameters
    ----------
    arguments : sequence of str, optional
        Words after ``fuzzyarm``; those of the process by default.

    Returns
    -------
    int
        0 = fine, 1 = the input is at fault, 2 = wrong usage, 3 = a run diverged,
        4 = a proof stayed undecided, 130 = interrupted.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    # A command makes many small objects and ends soon: garbage collection would take longer than
    # reading their file.
    gc.set_threshold(2_000_000)
    if arguments is None:  # the process ends too: no last collection either
        atexit.register(gc.freeze)
    _prepare_output()
    warnings.formatwarning = _warning_text
    with _heard() as errors:
        status = _status(words)
        if status in ENDINGS and not errors.heard:
            print_error(ENDINGS[status])
    return status


def _status(words: list[str]) -> int:
    """Run one command; turn exceptions into a sentence and an exit status."""
    try:
        status = _run(words)
        sys.stdout.flush()
    except BaseException as error:
        # An import may turn Ctrl-C into another exception than KeyboardInterrupt.
        if isinstance(error, KeyboardInterrupt) or interrupts.heard:
            print_error("interrupted")
            return EXIT_INTERRUPTED
        return _failure(error)
    return status


def _failure(error: BaseException) -> int:
    """Print an expected exception as a sentence and return the exit status; raise others."""
    if isinstance(error, RuleBaseError):
        _print_mistakes(error)
        return EXIT_INPUT
    if isinstance(error, FuzzyarmError):
        print_error(error)
        return EXIT_USAGE if isinstance(error, UsageError) else EXIT_INPUT
    if isinstance(error, BrokenPipeError):  # the reader (head, less) has closed the pipe
        _discard_output()
        return 0
    if isinstance(error, OSError):
        unnamed = error.filename is None and error.errno in _DISK_ERRORS
        print_os_error(error, "standard output" if unnamed else None)
        _discard_output()
        return EXIT_INPUT
    if isinstance(error, UnicodeEncodeError):  # a file name in a text
        print_error(f"'{error.object}' cannot be a name in the locale of this process")
        return EXIT_INPUT
    raise error


class _ErrorStream:
    """The standard error, with a flag for whether anything was written."""

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream
        self.heard = False

    def write(self, text: str) -> int:
        self.heard = self.heard or bool(text.strip())
        return self.stream.write(text)

    def __getattr__(self, name: str) -> object:
        return getattr(self.stream, name)


@contextlib.contextmanager
def _heard() -> Iterator[_ErrorStream]:
    """Record the use of the standard error."""
    before = sys.stderr
    errors = _ErrorStream(before)
    sys.stderr = cast("TextIO", errors)
    try:
        yield errors
    finally:
        sys.stderr = before


_DISK_ERRORS = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)


def _prepare_output() -> None:
    """Make the standard streams accept any text, with replacements for their encoding."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by the parent process
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
        stream = getattr(sys, name)
        # In the locale C the narrow encoding comes with the handler `surrogateescape`.
        if hasattr(stream, "reconfigure") and stream.errors in {"strict", "surrogateescape"}:
            stream.reconfigure(errors="replace")
    # Figures are drawn without a backend, and an unknown one keeps matplotlib from loading.
    os.environ.pop("MPLBACKEND", None)


def _discard_output() -> None:
    """Discard all further output, even that at the end of the process."""
    with contextlib.suppress(OSError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _warning_text(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    line: str | None = None,
) -> str:
    """Return a warning about a file as its finding."""
    if hasattr(message, "diagnostic"):
        return f"{message}\n"
    return f"{filename}:{lineno}: {category.__name__}: {message}\n"


def _run(words: list[str]) -> int:
    if len(words) == 2 and words[0] == "help" and words[1] in COMMANDS:
        words = [words[1], "--help"]
    name = next((word for word in words if not word.startswith("-")), None)
    if name not in COMMANDS or words[0] != name:
        return _overview(words, name)
    try:
        with announced(f"at work on: {_shortened(words)}"):
            command = find_command(name)
            arguments = _parse(command.parser(), words[1:])
            interrupts.listen()
            if command.rewrites(arguments):
                return command.run(arguments)
            with _finished(arguments), sources_kept(force=getattr(arguments, "force", False)):
                return command.run(arguments)
    except SystemExit as stop:  # argparse ends with it after --help or a usage error
        return stop.code if isinstance(stop.code, int) else EXIT_USAGE


RESULTS = [
    "out",
    "plot",
    "certificate",
    "animate",
    "csv",
    "overview",
    "report",
    "resume",
    "journal",
]
"""Arguments of commands with the name of a file to write."""


class _PatientStream:
    """The standard output of a command with results: it continues after the reader is gone."""

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream

    def write(self, text: str) -> int:
        try:
            return self.stream.write(text)
        except BrokenPipeError:
            _discard_output()
            return len(text)

    def flush(self) -> None:
        try:
            self.stream.flush()
        except BrokenPipeError:
            _discard_output()

    def __getattr__(self, name: str) -> object:
        return getattr(self.stream, name)


@contextlib.contextmanager
def _finished(arguments: argparse.Namespace) -> Iterator[None]:
    """Write the files of a command, and return its exit status, if its output is closed early."""
    if not any(getattr(arguments, name, None) for name in RESULTS):
        yield
        return
    before = sys.stdout
    sys.stdout = cast("TextIO", _PatientStream(before))
    try:
        yield
        sys.stdout.flush()
    finally:
        sys.stdout = before


def _shortened(words: list[str], most: int = 72) -> str:
    text = " ".join(words)
    return text if len(text) <= most else f"{text[: most - 1]}…"


def _parse(parser: argparse.ArgumentParser, words: list[str]) -> argparse.Namespace:
    """Parse the words after a command's name; options may be anywhere among them."""
    if words and not any(word.startswith("-") for word in words):
        return parser.parse_args(words)  # nothing to intermix: saves the usage text
    for word in words:
        # argparse removes the two dashes and passes an empty list.
        option, equals, value = word.partition("=")
        if option.startswith("--") and equals and value == "--":
            parser.error(f"argument {option}: expected a value, not '--'")
    return parser.parse_intermixed_args(words)  # as in `eval FILE --json e=1 ce=2`


def find_command(name: str) -> Command:
    """Return the record of a command, from its module."""
    module = importlib.import_module(f"fuzzyarm.apps.cli.{COMMANDS[name][0]}")
    commands: Sequence[Command] = module.COMMANDS
    return next(command for command in commands if command.name == name)


def _print_mistakes(error: RuleBaseError) -> None:
    from fuzzyarm.language.reading import text_to_show

    errors = [diagnostic for diagnostic in error.diagnostics if diagnostic.is_error] or list(
        error.diagnostics
    )
    try:
        text = text_to_show(errors[0].path)
    except (OSError, ValueError, IndexError):
        text = ""
    print_findings(errors, text, sys.stderr)


def _overview(words: list[str], name: str | None) -> int:
    if words and words[0] in {"--version", "-V"}:
        from fuzzyarm.version import __version__

        print(f"fuzzyarm {__version__}")
        return 0
    if not words or words[0] in {"-h", "--help", "help"}:
        print(_help_page())
        return 0 if words else EXIT_USAGE
    if words[0] == "--print-completion":
        return _print_completion(words[1:])
    if name in GONE:
        print_error(f"the command '{name}' has gone; {GONE[name]}")
        return EXIT_USAGE
    from fuzzyarm.base.names import did_you_mean, several_nearest

    word = name or words[0]
    choices = ("--version", "--help", "--print-completion") if word[0] == "-" else COMMANDS
    near = [MEANT[word]] if word in MEANT else several_nearest(word, choices, 1)
    hint = did_you_mean(*near) if near else "see fuzzyarm --help"
    print_error(f"no command '{word}'; {hint}")
    return EXIT_USAGE


def _print_completion(shells: list[str]) -> int:
    from fuzzyarm.apps.cli.completion import SHELLS, completion_script

    if len(shells) != 1 or shells[0] not in SHELLS:
        print_error(f"--print-completion takes a shell: {', '.join(SHELLS)}")
        return EXIT_USAGE
    records = [(find_command(name), summary) for name, (_, summary) in COMMANDS.items()]
    print(completion_script(shells[0], records))
    return 0


def _help_page() -> str:
    table = in_columns([(name, summary) for name, (_, summary) in COMMANDS.items()], indent="  ")
    lines = []
    for name, line in zip(COMMANDS, table, strict=True):
        if name in HEADINGS:
            lines += ["", HEADINGS[name]]
        lines.append(line)
    return "\n".join(
        [
            "usage: fuzzyarm COMMAND [...]",
            "       fuzzyarm --version | --help | --print-completion {bash,zsh,tcsh}",
            "",
            "Write a fuzzy controller as a text file, see it, check it, prove it, compile it,",
            "and run it on any plant.",
            *lines,
            "",
            "fuzzyarm COMMAND --help lists the options of one command. Exit status: 0 fine,",
            "1 the input is at fault, 2 wrong usage; 3 a run diverged, 4 a proof stayed",
            "undecided, 130 interrupted.",
        ]
    )
