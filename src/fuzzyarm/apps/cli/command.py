"""Common parts of all commands: the record, arguments, words like ``e=1.3``, and output."""

from __future__ import annotations

import argparse
import math
import os
import re
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext, suppress
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn, TextIO

from fuzzyarm.base import errors
from fuzzyarm.base.diagnostic import Diagnostic, render_all, split_lines
from fuzzyarm.base.jsonable import jsonable
from fuzzyarm.base.names import printable
from fuzzyarm.base.protected import ForeignFileError, SourceFileError
from fuzzyarm.language.model.lookup_modes import LOOKUP_MODES

if TYPE_CHECKING:
    from rich.progress import Progress


EXIT_USAGE = 2
"""Exit status after wrong usage."""

DIVERGED = 3
"""Exit status after a diverged run, whose figures end there."""

EXIT_INTERRUPTED = 130
"""Exit status after Ctrl-C."""

# --- The record of a command ---


class Argument(NamedTuple):
    """An argument: names and options for `add_argument`, and its place on the help page.

    `group` is a title on the help page; arguments of a group with the same word in `either` exclude
    each other.
    """

    names: tuple[str, ...]
    options: dict[str, Any]
    group: str = ""
    either: str = ""


class Command(NamedTuple):
    """A command: name, help page, function, arguments.

    `run` takes the parsed arguments and returns the exit status. Its line on the page of all
    commands is in `main.COMMANDS`, which needs no module of a command. `rewrites` decides from the
    arguments whether the command replaces its input.
    """

    name: str
    description: str | None
    run: Callable[[argparse.Namespace], int]
    arguments: Sequence[Argument]
    rewrites: Callable[[argparse.Namespace], bool] = lambda _arguments: False

    def parser(self) -> argparse.ArgumentParser:
        """Return the argument parser."""
        parser = _Parser(
            prog=f"fuzzyarm {self.name}",
            description=self.description,
            # argparse makes a formatter for each added argument: a fixed width saves it the query
            # of the terminal's, and the imports for that.
            formatter_class=partial(argparse.RawDescriptionHelpFormatter, width=80),
        )
        self.add_to(parser)
        parser.formatter_class = argparse.RawDescriptionHelpFormatter
        return parser

    def add_to(self, parser: argparse.ArgumentParser) -> list[argparse.Action]:
        """Add the arguments to a parser, each in its group; return the actions."""
        # No option begins with a digit: -30,45 is a way point, and -5s a wrong time.
        parser._negative_number_matcher = re.compile(r"-\.?\d")
        groups: dict[tuple[str, str], Any] = {("", ""): parser}
        actions: list[argparse.Action] = []
        for argument in self.arguments:
            if (argument.group, "") not in groups:
                groups[argument.group, ""] = parser.add_argument_group(argument.group)
            home = groups[argument.group, ""]
            if argument.either:
                if (argument.group, argument.either) not in groups:
                    groups[argument.group, argument.either] = home.add_mutually_exclusive_group()
                home = groups[argument.group, argument.either]
            actions.append(home.add_argument(*argument.names, **argument.options))
        return actions


class _Parser(argparse.ArgumentParser):
    """A parser with usage errors of one sentence, without the list of all options."""

    def error(self, message: str) -> NoReturn:
        """Print a usage error and a pointer to the options; exit with status 2."""
        head, _, words = message.partition("unrecognized arguments: ")
        if words and not head:
            message = self._unknown(words.split())
        message = _in_own_words(message)
        more = f"`{self.prog} --help` names all arguments and options"
        self.exit(EXIT_USAGE, f"{self.prog}: error: {message}\n{more}\n")

    def _unknown(self, words: Sequence[str]) -> str:
        """Return the message about unused words, with the likely option."""
        option = next((word for word in words if word.startswith("-")), None)
        if option is None:
            return f"too many arguments: {' '.join(words)}"
        from fuzzyarm.base.names import nearest

        name = option.partition("=")[0]
        options = {
            each.lstrip("-"): each for each in self._option_string_actions if each[:2] == "--"
        }
        word = _OPTIONS_MEANT.get(name.lstrip("-"), name.lstrip("-"))
        near = len(name) > 2 and nearest(word, options)
        return f"no option {name}" + (f" (did you mean {options[near]}?)" if near else "")


_OPTIONS_MEANT = {
    "duration": "for", "time": "for", "output": "out", "gain": "set", "gains": "set",
    "param": "set", "parameter": "set", "seconds": "for",
}  # fmt: skip
"""Common misnomers of an option, by its word here."""


_OWN_WORDS = (
    (r"invalid int value: ('.*')", r"must be a whole number, not \1"),
    (r"invalid float value: ('.*')", r"must be a number, not \1"),
)
"""argparse's message about a value → that of a request (`fuzzyarm.requests.fields`)."""


def _in_own_words(message: str) -> str:
    """Return argparse's message about an argument in the words of a request about a field."""
    match = re.match(r"(?s)argument (\S+): (.*)", message)
    if match is None:
        return message
    name, why = match[1].rpartition("/")[2], match[2]
    if why.startswith(name):  # already in a request's words
        return why
    for pattern, words in _OWN_WORDS:
        if re.fullmatch(pattern, why, re.DOTALL):
            return f"{name} {re.sub(pattern, words, why, flags=re.DOTALL)}"
    if choice := re.fullmatch(r"invalid choice: (.*) \(choose from (.*)\)", why, re.DOTALL):
        from fuzzyarm.requests.fields import unknown_choice

        choices = [word.strip(_QUOTES) for word in choice[2].split(", ")]
        from ast import literal_eval

        return str(unknown_choice(name, literal_eval(choice[1]), choices))
    return message


_QUOTES = "'\""


def command(
    name: str,
    description: str | None,
    run: Callable[[argparse.Namespace], int],
    *arguments: Argument,
    rewrites: Callable[[argparse.Namespace], bool] | None = None,
) -> Command:
    """Return the record of a command."""
    made = Command(name, description, run, arguments)
    return made if rewrites is None else made._replace(rewrites=rewrites)


def always(_arguments: argparse.Namespace) -> bool:
    """Whether a command replaces its input: always."""
    return True


def argument(words: str, text: str | None = None, *, either: str = "", **options: Any) -> Argument:
    """Return an argument; `words` are its spellings on the help page, `text` its line there.

    The spellings of an option or the name of a positional argument come first, then the names of
    its values: ``-o --out FILE``, ``--angles A1 A2``, ``file FILE``.
    """
    first, *others = words.split()
    names = [first, *(word for word in others if word.startswith("-"))]
    values = others[len(names) - 1 :]
    if len(values) > 1:
        options |= {"nargs": len(values), "metavar": tuple(values)}
    elif values:
        options["metavar"] = values[0]
    return Argument(tuple(names), {**options, "help": text}, either=either)


def flag(words: str, text: str | None = None, *, either: str = "") -> Argument:
    """Return an option without a value."""
    return argument(words, text, either=either, action="store_true")


def group(title: str, *arguments: Argument) -> tuple[Argument, ...]:
    """Return the arguments under a title of the help page."""
    return tuple(argument._replace(group=title) for argument in arguments)


# --- Arguments of several commands ---

MODEL = argument("file FILE", "a rule base or a table")
MODE = argument("--mode", "how to look a table up", choices=LOOKUP_MODES)
JSON = flag("--json", "print the result as JSON")
FORCE = flag("--force", "replace files that fuzzyarm did not write")


def json_of(content: str) -> Argument:
    """Return ``--json``, which prints `content`."""
    return flag("--json", f"print {content} as JSON")


def out(metavar: str, text: str, *, required: bool = True) -> Argument:
    """Return ``-o``."""
    return argument(f"-o --out {metavar}", text, required=required)


def at(text: str) -> Argument:
    """Return ``--at``, a point in the syntax of `read_assignments`."""
    return argument("--at NAME=VALUE,...", text)


WordError = errors.WordError
UsageError = errors.UsageError

# --- Files ---


def require_suffix(path: str, suffixes: Iterable[str]) -> str:
    """Return the suffix of `path` in lower case; WordError if it is unknown."""
    name = os.path.basename(path)
    suffix = os.path.splitext(name)[1].lower()
    if suffix not in suffixes:
        raise UsageError(
            f"cannot tell the format of '{name}'", hint=f"known: {', '.join(suffixes)}"
        )
    return suffix


class Saved(NamedTuple):
    """The file with the result of long work, empty for none, and the failure on the way."""

    path: str
    fault: str = ""


def saved(path: str, write: Callable[[str], object]) -> Saved:
    """Write the result of long work; on failure, into a temporary folder."""
    try:
        write(path)
    except (OSError, SourceFileError, ForeignFileError) as error:
        from tempfile import mkdtemp

        failure = errors.sentence_of(error)
        try:
            other = os.path.join(mkdtemp(prefix="fuzzyarm-"), os.path.basename(path))
            write(other)
        except OSError:
            return Saved("", f"{failure}; the report has the result")
        return Saved(other, f"{failure}; {other} has the result")
    return Saved(path)


def attempted(work: Callable[[], object]) -> list[str]:
    """Do optional work, such as a figure; return its failure instead of raising."""
    try:
        work()
    except Exception as error:
        return [errors.sentence_of(error)]
    return []


def demand_places(*paths: str | None) -> None:
    """Check before long work that its results can be written."""
    from fuzzyarm.base.files import demand_writable

    for path in filter(None, paths):
        demand_folder_of(path)
        demand_writable(path)


def demand_figure(path: str | None) -> None:
    """Check before long work that a figure can be written."""
    if path is not None:
        from fuzzyarm.base.figure_files import require_figure_suffix

        require_figure_suffix(path)
        demand_places(path)


def demand_folder_of(path: str) -> None:
    """Refuse a path into a missing folder."""
    folder = os.path.dirname(path)
    if folder and not os.path.isdir(folder):
        raise WordError(f"no such folder: '{folder}'")


# --- Output ---


def say(*lines: str, to_errors: bool = False) -> None:
    """Print lines with any characters."""
    text = "\n".join(map(printable, lines))
    if not to_errors:
        print(text)
        return
    with suppress(OSError):  # there is no reader left
        print(text, file=sys.stderr)


def write_text(text: str) -> None:
    """Write the text of a file to the standard output: UTF-8, but clean on a terminal."""
    if sys.stdout.isatty():
        say(*split_lines(text))
        return
    sys.stdout.flush()
    sys.stdout.buffer.write(text.encode())


def print_json(
    data: Any,
    indent: int | None = None,
    *,
    ascii_only: bool = True,
    infinite: Callable[[float], Any] = lambda _: None,
) -> None:
    """Print records and data as JSON to the standard output: see :mod:`fuzzyarm.base.jsonable`."""
    import json

    ascii_only |= "utf" not in (sys.stdout.encoding or "utf-8").lower()
    plain = jsonable(data, infinite=infinite)
    text = json.dumps(plain, indent=indent, ensure_ascii=ascii_only, allow_nan=False)
    lines = text.split("\n")
    # JSON escapes control characters, but not those that turn the direction of writing.
    print("\n".join(x if x.isprintable() else _UNPRINTABLE.sub(_escaped, x) for x in lines))


_UNPRINTABLE = re.compile(r"[^\x20-\x7e]")


def _escaped(character: re.Match[str]) -> str:
    import json

    letter = character.group()
    return letter if letter.isprintable() else json.dumps(letter)[1:-1]


def print_error(message: object) -> None:
    """Print an error in one line."""
    say(f"fuzzyarm: {message}", to_errors=True)


def print_os_error(error: OSError, path: str | None = None) -> None:
    """Print the reason why a file could not be read or written."""
    path = path or error.filename
    folder = os.path.dirname(path) if isinstance(path, str) else ""
    if isinstance(error, FileNotFoundError) and folder and not os.path.isdir(folder):
        print_error(f"no such folder: '{folder}'")
        return
    hint = ""
    if isinstance(error, FileNotFoundError) and path:
        from fuzzyarm.base.shipped_files import missing_file_hint

        hint = missing_file_hint(str(path))
    message = f"{f'{path}: ' if path else ''}{error.strerror or error}"
    print_error(f"{message} ({hint})" if hint else message)


def print_findings(findings: Sequence[Diagnostic], text: str, stream: TextIO) -> None:
    """Print diagnostics with their source lines, in colours on a terminal."""
    colour = stream.isatty() and "NO_COLOR" not in os.environ
    with suppress(OSError) if stream is sys.stderr else nullcontext():
        print(render_all(findings, text, colour=colour), file=stream)


# --- Long work: on a terminal, a line on the standard error that goes away again ---


def _display() -> Progress:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(24),
        TimeElapsedColumn(),
    )
    return Progress(*columns, console=Console(stderr=True), transient=True)


@contextmanager
def _long_work() -> Iterator[Progress]:
    """Provide a display; its content needs no announcement."""
    _shown.set()
    with _display() as display:
        yield display


_QUIET = os.environ.get("FUZZYARM_PROGRESS") == "0"

SOON = math.inf if _QUIET else 1.5
"""Seconds until a command without a progress bar names its work."""

TOLD_EVERY = math.inf if _QUIET else 10.0
"""Seconds between two lines of progress without a progress bar."""

_doing: list[str] = []
"""Announced activities, the innermost last."""

_shown, _hushed = threading.Event(), threading.Event()
"""Whether the activity was announced or has a bar; whether announcements are off."""


def hush() -> None:
    """Turn announcements off: the command has its own screen or server."""
    _hushed.set()


@contextmanager
def announced(words: str, *, shown: bool = True) -> Iterator[None]:
    """Announce an activity in one line on the standard error, if it takes a while.

    An inner activity replaces the announcement of an outer one, or is printed at once after a
    printed one.
    """
    if not shown or math.isinf(SOON):
        yield
        return
    _doing.append(words)
    timer = None
    if len(_doing) == 1:
        _hushed.clear()
    if len(_doing) == 1 or (_shown.is_set() and not sys.stderr.isatty()):
        _shown.clear()
        timer = threading.Timer(SOON, _say_what_is_done)
        timer.daemon = True
        timer.start()
    try:
        yield
    finally:
        _doing.pop()
        if timer is not None:
            timer.cancel()


def _say_what_is_done() -> None:
    if _doing and not (_shown.is_set() or _hushed.is_set()):
        _shown.set()
        print_progress(_doing[-1])


def print_progress(words: str) -> None:
    """Print the current activity in one line."""
    stream = sys.stderr
    with suppress(OSError):
        print(printable(f"fuzzyarm: {words}"), file=getattr(stream, "stream", stream), flush=True)


@contextmanager
def busy(message: str) -> Iterator[Callable[[str], None]]:
    """Show `message` during an activity; yield a function to update it, rarely off a terminal."""
    if not sys.stderr.isatty():
        with announced(message):
            yield _told_now_and_then()
        return
    with _long_work() as display:
        task = display.add_task(message, total=None)
        yield lambda words: display.update(task, description=words)


@contextmanager
def progress_bar(title: str, total: int, *, shown: bool = True) -> Iterator[Callable[[int], None]]:
    """Show a bar, off a terminal a line now and then; yield a function that advances it."""
    if not shown:
        yield lambda _count: None
        return
    if not sys.stderr.isatty():
        tell, done = _told_now_and_then(), 0

        def advance(count: int) -> None:
            nonlocal done
            done += count
            tell(f"{title}, {100 * done // max(total, 1)} %")

        with announced(title):
            yield advance
        return
    with _long_work() as display:
        task = display.add_task(title, total=total)
        yield lambda count: display.advance(task, count)


@contextmanager
def steps_bar(title: str, total: int, done: int = 0) -> Iterator[Callable[[int], None]]:
    """Show progress, rate and remaining time of equal steps; yield a function to report steps."""
    pace = Pace(total)

    def state(now: int) -> str:
        counted_steps = f"{now} of {total} {title}"
        rate = pace.rate(now)
        if rate is None:
            return counted_steps
        return f"{counted_steps}, {rate:.3g} {title}/s, {duration_words(pace.left(now))} left"

    if not sys.stderr.isatty():
        tell = _told_now_and_then()
        yield lambda now: tell(state(now)) if now < total else None
        return
    with _long_work() as display:
        task = display.add_task(state(done), total=total, completed=done)
        yield lambda now: display.update(task, completed=now, description=state(now))


class Pace:
    """Rate and remaining time of equal steps.

    Parameters
    ----------
    total : int
        Number of steps.
    seconds : float, optional
        Time limit.
    """

    def __init__(self, total: int, seconds: float = math.inf) -> None:
        self.total, self.until = total, time.monotonic() + seconds
        self.first: tuple[int, float] | None = None

    def rate(self, done: int) -> float | None:
        """Return steps per second; None at first, which includes loading."""
        now = time.monotonic()
        if self.first is None:
            self.first = done, now
        count, begin = self.first
        return (done - count) / max(now - begin, 1e-9) if done > count else None

    def left(self, done: int) -> float:
        """Return the seconds for the remaining steps; infinite if unknown."""
        rate = self.rate(done)
        left = math.inf if rate is None else (self.total - done) / rate
        return max(0.0, min(left, self.until - time.monotonic()))


def duration_words(seconds: float) -> str:
    """Return a duration in words."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes} min"
    return f"{minutes} min {rest} s" if minutes else f"{rest} s"


def _told_now_and_then() -> Callable[[str], None]:
    """Return a function that prints on the standard error, at most once in `TOLD_EVERY` seconds."""
    last = time.monotonic()

    def tell(words: str) -> None:
        nonlocal last
        if time.monotonic() - last >= TOLD_EVERY:
            last = time.monotonic()
            print_progress(words)

    return tell
