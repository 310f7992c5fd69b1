"""Paths of the shipped rule bases and tables."""

from __future__ import annotations

import contextlib
import os
import re
from pathlib import Path

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.keywords import demand_text
from fuzzyarm.base.names import did_you_mean, near_hint, nearest


class NotShippedError(FuzzyarmError, FileNotFoundError):
    """No shipped file has that name.

    Attributes
    ----------
    name : str
        The requested name.
    """

    def __init__(self, name: str, names: list[str]) -> None:
        hint, _ = near_hint(name, names)
        alike = [each for each in names if name and name in each]
        if not hint:
            hint = f"there are {', '.join(alike)}" if alike else "fuzzyarm shipped  lists them"
        super().__init__(f"no shipped rule base or table is called '{name}'", hint=hint)
        self.name = name


def shipped_folder() -> Path:
    """Return the folder of the shipped files, in an installed package or a checkout."""
    here = Path(__file__).resolve().parents[1]
    inside = here / "shipped"
    return inside if inside.is_dir() else here.parents[1] / "rulebases"


OF_THE_STUDY = "as-described"
"""Folder of the variants that follow the study's text where it contradicts its figures."""

EXAMPLES = ("fan.frb", "tipper.frb", "heater.frb", "servo.frb", "pd7.frb", "pd-motor.frb")
"""Shipped files for beginners, the simplest first."""


def _shipped_files() -> dict[str, Path]:
    folder = shipped_folder()
    # In the browser the files of the study are absent.
    paths = [*folder.iterdir(), *(folder / OF_THE_STUDY).glob("*")]
    return {path.name: path for path in paths if path.suffix in (".frb", ".lut")}


def shipped_names() -> list[str]:
    """Return the names of the shipped files, sorted."""
    return sorted(_shipped_files())


def shipped(name: str) -> Path:
    """Return the path of the shipped file `name`, for instance ``pd7.frb``.

    Parameters
    ----------
    name : str
        File name with suffix.

    Raises
    ------
    NotShippedError
        If there is no such file; the error has the nearest name.
    """
    path = _shipped_files().get(demand_text("shipped", name, "name"))
    if path is None:
        raise NotShippedError(name, shipped_names())
    return path


def missing_file_hint(path: str | os.PathLike[str]) -> str:
    """Return a hint for the path of a missing file: a similar name; empty for none.

    A shipped file of that name comes first, then a similar name in the same folder.
    """
    folder, name = os.path.split(os.fspath(path))
    stem, suffix = os.path.splitext(name)
    if not folder and (found := {name, f"{name}.frb"} & set(_shipped_files())):
        return f"fuzzyarm shipped {found.pop()} -o .  copies the shipped one"
    with contextlib.suppress(OSError):
        files = sorted(os.listdir(folder or "."), key=lambda each: not each.endswith(suffix))
        stems: dict[str, str] = {}
        for each in files:
            if each != name:  # a link that leads nowhere
                stems.setdefault(os.path.splitext(each)[0], each)
        if found_stem := nearest(stem, stems):
            return did_you_mean(os.path.join(folder, stems[found_stem]))
    return ""


_HEAD = re.compile(r'^(rulebase|controller|output)\s[^"\n]*"([^"]*)"', re.MULTILINE)
"""The head line of a file; of a table that of its output."""

_KINDS = {"rulebase": "rule base", "controller": "controller", "output": "table"}


def what_it_is(text: str) -> tuple[str, str]:
    """Return kind and description of a file."""
    match = _HEAD.search(text)
    return (_KINDS[match[1]], match[2]) if match else ("", "")
