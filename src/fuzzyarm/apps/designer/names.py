"""Names of files from a page, and errors in words without a path."""

from __future__ import annotations

import re
import unicodedata
from pathlib import Path

from fuzzyarm.base.diagnostic import NOWHERE, Diagnostic, RuleBaseError, Severity
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.files import real_path
from fuzzyarm.base.names import printable

LONGEST_NAME = 120
"""Bytes of a file name, which leaves room for the names of temporary files."""

_RESERVED = re.compile(r"(con|prn|aux|nul|com[0-9¹²³]|lpt[0-9¹²³])(\.|\Z)", re.IGNORECASE)
"""Names of devices on some systems, with any suffix."""

_MARKS = re.compile(r'[<>:"/\\|?*]')
"""Marks forbidden in names on some system."""


class OutsideError(FuzzyarmError, ValueError):
    """A file that is not in the folder, or an invalid name."""


def demand_name(name: str) -> str:
    """Return the name of a file that is valid on every system."""
    name = unicodedata.normalize("NFC", name.strip())
    shown = printable(name[:80])
    if not Path(name).stem or name.startswith("."):
        raise OutsideError(f"'{shown}' is not the name of a file in this folder")
    if not name.isprintable() or _MARKS.search(name):
        raise OutsideError(
            f"'{shown}' cannot be the name of a file: one of its characters is not portable"
        )
    if _RESERVED.match(name) or Path(name).stem.endswith((" ", ".")):
        raise OutsideError(f"'{shown}' cannot be the name of a file on every system")
    if len(name.encode("utf-8", "replace")) > LONGEST_NAME:
        raise OutsideError(f"the name has more than {LONGEST_NAME} bytes")
    return name


def is_inside(path: Path, folder: Path) -> bool:
    """Whether a path leads to a file of a folder; a link may lead out of it."""
    return real_path(path).parent == real_path(folder)


def clean_name(name: str, suffix: str) -> str:
    """Return the sound name nearest to a user's `name`, with a suffix."""
    name = unicodedata.normalize("NFC", re.split(r"[/\\]", name)[-1])
    stem = "".join(c if c.isprintable() else "_" for c in Path(name).stem)
    stem = _MARKS.sub("_", stem).strip(" .")
    while len(stem.encode("utf-8", "replace")) > LONGEST_NAME - len(suffix) - 8:
        stem = stem[:-1]
    stem = stem.strip(" .").encode("utf-8", "replace").decode() or "imported"
    return f"_{stem}{suffix}" if _RESERVED.match(f"{stem}.") else f"{stem}{suffix}"


def with_suffix(name: str, suffix: str) -> str:
    """Return a sound name that ends with a suffix."""
    name = demand_name(name)
    return name if Path(name).suffix.lower() == suffix.lower() else demand_name(f"{name}{suffix}")


def finding_words(finding: Diagnostic) -> str:
    """Return a finding with its line; only warnings are marked as such."""
    place = f"line {finding.span.line}: " if finding.span != NOWHERE else ""
    label = "" if finding.severity is Severity.ERROR else f"{finding.severity}: "
    return f"{label}{place}{finding.message}"


def in_words(error: Exception) -> str:
    """Return an error without its path."""
    if isinstance(error, RuleBaseError):
        return "; ".join(finding_words(diagnostic) for diagnostic in error.diagnostics)
    if isinstance(error, OSError) and error.strerror:
        name = Path(str(error.filename)).name if error.filename else ""
        return f"{name}: {error.strerror}" if name else error.strerror
    return str(error)
