"""Where to begin: ``fuzzyarm new``, the files that are ``shipped``, and the ``demo``."""

from __future__ import annotations

import argparse
import contextlib
import os
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from fuzzyarm.apps.builder.starting import (
    CONTROLLER,
    PURPOSES,
    NewFileError,
    Wish,
    controller_text,
    read_wish,
    starting_text,
)
from fuzzyarm.apps.cli.command import (
    always,
    argument,
    command,
    flag,
    json_of,
    out,
    print_json,
    say,
    write_text,
)
from fuzzyarm.base.columns import in_columns
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.files import write_atomically
from fuzzyarm.base.jsonable import entry
from fuzzyarm.base.names import typed
from fuzzyarm.base.numbers import counted
from fuzzyarm.base.shipped_files import NotShippedError, shipped, shipped_names, what_it_is
from fuzzyarm.language import load_rulebase

_NEW = r"""A commented rule base to start from, or a controller around one; both pass `check`.

    fuzzyarm new joint                       error and error rate, 7 × 7 rules (PD)
    fuzzyarm new joint --kind pi             the same for the increment of the control (PI)
    fuzzyarm new fan --kind single           one input
    fuzzyarm new motor --kind controller --around joint.frb
                                             runs the rules of joint.frb on a motor
    fuzzyarm new mine --kind blank           a heading; the rest is yours, and `check` waits for it
    fuzzyarm new hand --input "e -6..6 NB NM ZE PM PB" --input "ce -3..3 N Z P" \
                      --output "u -10..10 NB NM ZE PM PB"

Writes NAME.frb in the current folder; an existing file is only replaced with --force.
"""


def _wish(text: str) -> Wish:
    try:
        return read_wish(text)
    except NewFileError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _new(arguments: argparse.Namespace) -> int:
    path = Path(arguments.name if arguments.name.endswith(".frb") else f"{arguments.name}.frb")
    if not path.name.removesuffix(".frb").strip("."):
        message = f"'{arguments.name}' is not a name for a rule base"
        raise NewFileError(message, hint="take one such as joint")
    text = (
        _controller(path, arguments)
        if arguments.kind == CONTROLLER
        else _rule_base(path, arguments)
    )
    if path.exists() and not arguments.force:
        raise NewFileError(f"{path} already exists", hint="--force replaces it")
    write_atomically(path, text)
    say(f"{path}: written; see it with  fuzzyarm watch {typed(path)}")
    return 0


def _rule_base(path: Path, arguments: argparse.Namespace) -> str:
    if arguments.around is not None:
        raise NewFileError("--around names the rules of a controller", hint="--kind controller")
    return starting_text(
        path.stem, arguments.kind, arguments.input, arguments.output, sugeno=arguments.sugeno
    )


def _controller(path: Path, arguments: argparse.Namespace) -> str:
    """Return a controller around a rule base; without such a file, around a shipped one."""
    if arguments.input or arguments.output or arguments.sugeno:
        raise NewFileError(
            "a controller has the inputs and outputs of its rule base", hint="--around names it"
        )
    around = Path(arguments.around or "pd7.frb")
    rules = around
    if not around.exists():
        try:
            rules = shipped(str(around))
        except NotShippedError:
            message = f"there is no file {around}, and no shipped one of that name"
            raise NewFileError(message, hint="`fuzzyarm new` writes a rule base as well") from None
    file = os.path.relpath(around, path.parent).replace(os.sep, "/")
    return controller_text(path.stem, file, load_rulebase(rules))


# --- The shipped files ---

_SHIPPED = """List the rule bases, controllers and tables that come with fuzzyarm, or copy some.

A file that a controller names is looked for beside it, then among the shipped ones. To change
a shipped file, copy it first.

  fuzzyarm shipped                   all of them
  fuzzyarm shipped pd7.frb           the text of one
  fuzzyarm shipped pd7.frb -o .      a copy in this folder
"""


@dataclass(frozen=True)
class ShippedFile:
    """A shipped file."""

    name: str = entry("its name")
    kind: str = entry("its kind")
    description: str = entry("its own words")


def _list_shipped(arguments: argparse.Namespace) -> int:
    if not arguments.names:
        if arguments.out:
            raise ShippedCopyError("name the files to copy", hint="fuzzyarm shipped lists them")
        rows = [(name, *_what_is(name)) for name in shipped_names()]
        if arguments.json:
            print_json([ShippedFile(*row) for row in rows])
            return 0
        say(*in_columns(rows))
        return 0
    paths = [shipped(name) for name in arguments.names]
    if arguments.out:
        _copy(paths, Path(arguments.out), force=arguments.force)
        return 0
    for path in paths:
        write_text(path.read_text(encoding="utf-8"))
    return 0


class ShippedCopyError(FuzzyarmError, ValueError):
    """Shipped files cannot be copied as requested."""


def _copy(paths: list[Path], out: Path, *, force: bool) -> None:
    if len(paths) > 1 and not out.is_dir():
        raise ShippedCopyError(f"{out} is not a folder, for {counted(len(paths), 'file')}")
    targets = [out / path.name if out.is_dir() else out for path in paths]
    there = [target for target in targets if target.exists() and not force]
    if there:
        exist, them = ("exists", "it") if len(there) == 1 else ("exist", "them")
        listed = ", ".join(map(str, there))
        raise ShippedCopyError(f"{listed} already {exist}", hint=f"--force replaces {them}")
    for path, target in zip(paths, targets, strict=True):
        write_atomically(target, path.read_text(encoding="utf-8"))
        say(f"{target}: a copy of the shipped {path.name}")


def _what_is(name: str) -> tuple[str, str]:
    """Return the kind of a shipped file and its own description."""
    return what_it_is(shipped(name).read_text(encoding="utf-8"))


# --- The whole story ---

_DEMO = """\
The whole story on a shipped rule base: read, break, draw, evaluate, prove, compile and run it.

Works in a temporary folder and leaves nothing behind, unless --keep names a folder for the
files it makes.
"""

_POINT = ("e=1.3", "ce=-2.2")


def _demo(arguments: argparse.Namespace) -> int:
    if arguments.keep is not None:
        Path(arguments.keep).mkdir(parents=True, exist_ok=True)
        with contextlib.chdir(arguments.keep):
            return _tell()
    with tempfile.TemporaryDirectory(prefix="fuzzyarm-demo-") as folder, contextlib.chdir(folder):
        return _tell()


def _tell() -> int:
    text, servo = (shipped(name).read_text(encoding="utf-8") for name in ("pd7.frb", "servo.frb"))
    files = {"pd7.frb": text, "broken.frb": _broken(text), "servo.frb": servo}
    for name, content in files.items():
        if os.path.lexists(name) and Path(name).read_bytes() != content.encode():
            raise NewFileError(f"{name} already exists", hint="--keep names a new folder")
    for name, content in files.items():
        Path(name).write_text(content, encoding="utf-8")
    _say("A fuzzy controller is a text file: ranges, terms and a grid of 49 rules.")
    print(text)
    _say("It is checked: for mistakes, and for doubtful statements.")
    statuses = [_step("check", "pd7.frb") == 0]
    _say("Every mistake of a file is found in one run, with its position and a hint.")
    statuses.append(_step("check", "broken.frb") == 1)
    _say("It is drawn: terms as small plots, rules as a grid.")
    statuses.append(_step("show", "pd7.frb") == 0)
    _say("It is evaluated, with the reason: which rules fire, how strongly, where.")
    statuses.append(_step("eval", "pd7.frb", *_POINT, "--explain") == 0)
    _say("It is proved: no input gives an output beyond these bounds.")
    statuses.append(_step("prove", "pd7.frb", "--range") == 0)
    _say("It is compiled to a lookup table, with the error that this makes.")
    statuses.append(_step("compile", "pd7.frb", "-o", "pd7.lut") == 0)
    statuses.append(_step("show", "pd7.lut") == 0)
    statuses.append(_step("eval", "pd7.lut", *_POINT) == 0)
    _say("A controller puts gains around it: here one that turns a shaft by 1 rad.")
    print(servo)
    run = ("simulate", "servo.frb", "--plant", "motor", "--step", "1", "--for", "500ms")
    statuses.append(_step(*run) == 0)
    _say("And it becomes C, as one header without a library.")
    statuses.append(_step("compile", "servo.frb", "-o", "servo.h") == 0)
    _say("Next: copy it with `fuzzyarm shipped pd7.frb -o .`, edit it, run it again.")
    return 0 if all(statuses) else 1


def _broken(text: str) -> str:
    """Return `text` with three typical slips of editing."""
    slips = (
        ("NM      NB  NM  NM", "NM      NB  NX  NM"),
        ("triangles", "triangels"),
        ("  PB      ZE  PS  PS  PM  PB  PB  PB", "  PB      ZE  PS  PS  PM  PB  PB"),
    )
    for right, wrong in slips:
        text = text.replace(right, wrong, 1)
    return text


def _say(sentence: str) -> None:
    print(f"\n── {sentence}\n")


def _step(*words: str) -> int:
    from fuzzyarm.apps.cli.main import main

    print(f"$ fuzzyarm {' '.join(words)}")
    sys.stdout.flush()
    # Errors are part of the story: print them in order.
    with contextlib.redirect_stderr(sys.stdout):
        return main(words)


_FORM = 'NAME LOW..HIGH TERM…, for instance "e -6..6 NB NM ZE PM PB"'

COMMANDS = (
    command(
        "new",
        _NEW,
        _new,
        argument("name NAME", "name of the rule base; writes NAME.frb"),
        argument("--kind", "its purpose; pd by default", choices=tuple(PURPOSES), default="pd"),
        argument("--input SPEC", f"an input: {_FORM}", action="append", type=_wish),
        argument("--output SPEC", "the output, likewise", type=_wish),
        flag("--sugeno", "rules conclude values with a weighted average, not sets (Mamdani)"),
        argument("--around FILE", "the rule base of a controller; pd7.frb by default"),
        flag("--force", "replace an existing file"),
        rewrites=always,
    ),
    command(
        "shipped",
        _SHIPPED,
        _list_shipped,
        argument("names NAME", "files to print, or with -o to copy", nargs="*"),
        out("DIR", "the folder, or the file, to copy to", required=False),
        flag("--force", "replace existing files"),
        json_of("the list"),
        rewrites=always,
    ),
    command("demo", _DEMO, _demo, argument("--keep DIR", "work in DIR and leave the files there")),
)
