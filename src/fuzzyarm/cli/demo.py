"""The whole story on a shipped rule base: read it, break it, draw it, evaluate it, compile it.

Works in a temporary folder and leaves nothing behind, unless --keep names a folder for the
files it makes.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from fuzzyarm.shipped_files import shipped

_POINT = ("e=1.3", "ce=-2.2")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm demo``."""
    parser.add_argument("--keep", metavar="DIR", help="work in DIR and leave the files there")


def run(arguments: argparse.Namespace) -> int:
    """Tell the story; return 0 if every step ended as it should."""
    with _workplace(arguments.keep):
        return _tell()


@contextlib.contextmanager
def _workplace(keep: str | None) -> Iterator[None]:
    with contextlib.ExitStack() as stack:
        if keep is None:
            folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="fuzzyarm-demo-"))
        else:
            folder = keep
            Path(folder).mkdir(parents=True, exist_ok=True)
        before = Path.cwd()
        stack.callback(os.chdir, before)
        os.chdir(folder)
        yield


def _tell() -> int:
    text = shipped("pd7.frb").read_text(encoding="utf-8")
    Path("pd7.frb").write_text(text, encoding="utf-8")
    _say("A fuzzy controller is a text file: ranges, terms and a grid of 49 rules.")
    print(text)
    _say("It is checked: for mistakes, and for what is allowed but probably not meant.")
    statuses = [_step("check", "pd7.frb") == 0]
    _say("Every mistake of a file is found in one run, with its place and a hint.")
    Path("broken.frb").write_text(_broken(text), encoding="utf-8")
    statuses.append(_step("check", "broken.frb") == 1)
    _say("It is drawn: terms as small plots, rules as a grid.")
    statuses.append(_step("show", "pd7.frb") == 0)
    _say("It is evaluated, and tells why: which rules fire, how strongly, on which lines.")
    statuses.append(_step("eval", "pd7.frb", *_POINT, "--explain") == 0)
    _say("It is compiled to the table that a controller runs on, with the error this makes.")
    statuses.append(_step("compile", "pd7.frb", "-o", "pd7.lut") == 0)
    statuses.append(_step("show", "pd7.lut") == 0)
    statuses.append(_step("eval", "pd7.lut", *_POINT) == 0)
    _say("Next: edit a copy of rulebases/pd7.frb and run the same commands on it.")
    return 0 if all(statuses) else 1


def _broken(text: str) -> str:
    """Return `text` with three slips of the kind that editing makes."""
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
    from fuzzyarm.cli.main import main

    print(f"$ fuzzyarm {' '.join(words)}")
    sys.stdout.flush()
    # What goes wrong is part of the story, so it is told in its place.
    with contextlib.redirect_stderr(sys.stdout):
        return main(words)
