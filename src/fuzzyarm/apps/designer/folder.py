"""The files in the folder of the designer: new, renamed and imported ones, too.

Nothing outside the folder is read or written. A name from a page is checked before it becomes a
path: it must be valid on every system, and never leads out of the folder.
"""

from __future__ import annotations

import contextlib
import os
import re
import tempfile
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.builder.starting import (
    CONTROLLER,
    PURPOSES,
    controller_text,
    starting_text,
    valve_samples,
)
from fuzzyarm.apps.designer import requests
from fuzzyarm.apps.designer.faults import error_of
from fuzzyarm.apps.designer.names import (
    OutsideError,
    clean_name,
    demand_name,
    finding_words,
    in_words,
    is_inside,
    with_suffix,
)
from fuzzyarm.apps.designer.records import MessageError, read_record
from fuzzyarm.apps.designer.shared import SharedText
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.base.diagnostic import RuleBaseError
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.files import real_path, stamp_of, write_atomically
from fuzzyarm.base.folders import READABLE
from fuzzyarm.base.names import printable
from fuzzyarm.base.shipped_files import EXAMPLES, shipped, what_it_is
from fuzzyarm.exchange.formats import read as read_foreign
from fuzzyarm.exchange.formats.conversion import converted, findings_of
from fuzzyarm.language import load_rulebase, read_text
from fuzzyarm.table import SUFFIXES as TABLES
from fuzzyarm.table import read_table
from fuzzyarm.table.files import table_as

if TYPE_CHECKING:
    from fuzzyarm.plant.plant import Plant

SUFFIXES = (".frb", ".lut")
"""Suffixes of files that can be opened."""

SAMPLES = ".csv"
"""Suffix of samples; a table has this suffix too, and a first line of its kind."""

IMPORTS = (*READABLE, *TABLES)
"""Suffixes of files accepted by drag and drop."""

FOREIGN = tuple(suffix for suffix in READABLE if suffix not in SUFFIXES)
"""Rule bases of other programs."""

RULE_BASE, TABLE = "rule base", "table"
"""Kinds of files beside `CONTROLLER`, in words of the page."""

FIRST = "pd7.frb"
"""The initial rule base, if present: that of the pages and the tutorial."""

MOST_TRIED = 8
"""Rule bases read in the search for an initial one without mistakes."""

LARGEST_IMPORT = 8_000_000
"""Bytes of a dropped file."""


class Workspace:
    """A folder, or one file of it.

    Parameters
    ----------
    path : Path
        The folder, or the file; nothing else is read or written. A missing folder is made with its
        first file.
    plants : sequence of Plant
        Plants of the user, for the findings of controllers.
    """

    def __init__(self, path: Path, plants: Sequence[Plant] = ()) -> None:
        self._plants = plants
        path = real_path(path)
        self.only = path.name if path.is_file() else None
        self.folder = path.parent if path.is_file() else path
        self._open: dict[str, SharedText] = {}
        self._checked: dict[str, tuple[Any, dict[str, Any]]] = {}

    # --- Listing ---

    def listed(self, *suffixes: str) -> list[str]:
        """Return the names of the folder's files of some kinds; with one file open, none."""
        if self.only is not None:
            return []
        try:
            paths = [path for path in self.folder.iterdir() if path.suffix.lower() in suffixes]
        except OSError:  # missing, or unreadable: see `trouble`
            return []
        return sorted(path.name for path in paths if self._is_own(path))

    def _is_own(self, path: Path) -> bool:
        """Whether a path is a readable file of the folder."""
        try:
            return path.is_file() and is_inside(path, self.folder)
        except (OSError, RuntimeError):  # a link into a closed folder, or in a circle
            return False

    def files(self) -> list[str]:
        """Return the names of the files that can be opened."""
        return self.listed(*SUFFIXES) if self.only is None else [self.only]

    def stamp(self) -> int:
        """Return the time of the last change of the folder."""
        try:
            return self.folder.stat().st_mtime_ns
        except OSError:
            return 0

    def first(self) -> str:
        """Return the initial file: a rule base without mistakes, else the nearest to one.

        Empty if there is none.
        """
        names = self.files()
        kinds: dict[str, list[str]] = {}
        for name in names:
            kinds.setdefault(self._row(name)["kind"], []).append(name)
        tried = sorted(kinds.get(RULE_BASE, []), key=lambda name: name != FIRST)
        for name in tried[:MOST_TRIED]:
            with contextlib.suppress(OSError, FuzzyarmError):
                if self.session(name).reading.parsed.rulebase is not None:
                    return name
        ranked = [name for kind in (CONTROLLER, RULE_BASE, TABLE) for name in kinds.get(kind, [])]
        return next(iter([*ranked, *names]), "")

    @property
    def trouble(self) -> str:
        """Why the folder cannot be read or written, in a sentence; else empty."""
        if not self.folder.exists():
            return ""
        try:
            next(self.folder.iterdir(), None)
            os.stat(f"{self.folder}{os.sep}.")  # its names alone are not enough
        except OSError as error:
            return f"The folder {printable(self.folder.name)} cannot be read: {in_words(error)}."
        if not os.access(self.folder, os.W_OK):
            name = printable(self.folder.name)
            return f"The folder {name} cannot be written: nothing new can be made or saved here."
        return ""

    def foreign(self) -> list[str]:
        """Return the names of the folder's rule bases of other programs."""
        return [name for name in self.listed(*FOREIGN) if _is_rule_base(self.folder / name)]

    def foreign_data(self, name: str) -> bytes:
        """Return the content of one of those; OutsideError if it is not one of them."""
        if name not in self.foreign():
            raise OutsideError(f"'{printable(name)}' is not a rule base of another program here")
        return (self.folder / name).read_bytes()

    def beside(self, name: str, suffix: str) -> Path:
        """Return the path of a writable file of the folder."""
        self._demand_folder()
        path = self.folder / demand_name(name)
        if not is_inside(path, self.folder):
            raise OutsideError(f"'{printable(name)}' is not a file of this folder")
        if path.suffix.lower() != suffix:
            raise OutsideError(f"the name must end with {suffix}, as in {path.stem}{suffix}")
        return path

    def text(self, name: str) -> SharedText:
        """Return the open file of a name."""
        if name not in self._open:
            try:
                self._open[name] = SharedText(self._path(name), plants=self._plants)
            except RuleBaseError as error:
                raise OutsideError(
                    f"'{printable(name)}' is not opened: {in_words(error)}"
                ) from None
        return self._open[name]

    def revived(self, name: str, text: str) -> SharedText:
        """Return the text of a window whose file has gone while the server was not there."""
        path = self.folder / demand_name(name)
        is_allowed = name == self.only if self.only is not None else path.suffix.lower() in SUFFIXES
        if not is_allowed or path.is_symlink() or path.exists():
            raise OutsideError(f"'{printable(name)}' is not a file of this folder")
        self._open[name] = SharedText(path, text, self._plants)
        return self._open[name]

    def is_changed(self, name: str) -> bool:
        """Whether a file has unsaved changes in a window."""
        shared = self._open.get(name)
        return shared is not None and shared.text != shared.saved

    def unsaved(self) -> list[str]:
        """Return the names of the files with unsaved text in some window, past or present."""
        return sorted(name for name in self._open if self.is_changed(name))

    def opened(self, name: str) -> SharedText | None:
        """Return the text of a file in a window; None for any other."""
        return self._open.get(name)

    def session(self, name: str) -> Session:
        """Return the present text of a file of the folder, in its window or else on disk."""
        path, shared = self._path(name), self._open.get(name)
        text = read_text(path) if shared is None else shared.text
        return Session(str(path), text, plants=self._plants)

    def _path(self, name: str) -> Path:
        path = self.folder / name
        if name not in self.files() or not is_inside(path, self.folder):
            raise OutsideError(f"'{printable(name)}' is not a file of this folder")
        return path

    # --- Questions of a page ---

    def answer(self, request: Mapping[str, Any]) -> dict[str, Any]:
        """Answer a question about the folder, or act on it; an error becomes a sentence."""
        what = str(request.get("what"))
        if what not in _ACTS:
            return {"error": "unknown question"}
        try:
            answer = _ACTS[what](self, read_record(requests.FOLDER_QUESTIONS[what], request))
        except Exception as error:  # the page waits for an answer
            answer = error_of(error, f"the question {what!r} about the folder")
        return {**answer, **self.listing()}

    def listing(self) -> dict[str, Any]:
        """Return the files with kind and description."""
        return {
            "only": self.only is not None,
            "starts": PURPOSES,
            "examples": _examples(),
            "foreign": self.foreign(),
            "trouble": self.trouble,
            "files": [self._row(name) for name in self.files()],
        }

    def _row(self, name: str) -> dict[str, Any]:
        shared, kind, words = self._open.get(name), "", ""
        with contextlib.suppress(OSError, RuleBaseError):
            text = shared.text if shared else _beginning(self.folder / name)
            kind, words = what_it_is(text)
        if name.lower().endswith(".lut"):
            kind = TABLE
        elif kind != CONTROLLER:
            kind = RULE_BASE
        stamp = stamp_of(self.folder / name)
        row = {"name": name, "kind": kind, "description": words, "stamp": str(stamp)}
        return {**row, "changed": self.is_changed(name)}

    def findings(self, name: str) -> dict[str, Any]:
        """Return the number of findings of a file; cached until it changes."""
        shared = self._open.get(name)
        stamp = shared.text if shared else stamp_of(self._path(name))
        if name in self._checked and self._checked[name][0] == stamp:
            return self._checked[name][1]
        try:
            review = self.session(name).review()
            verdict = {"summary": review.summary, "sound": not review.failed}
        except (FuzzyarmError, OSError) as error:
            verdict = {"summary": in_words(error), "sound": False}
        self._checked[name] = stamp, verdict
        return verdict

    # --- Actions of the user ---

    def _list(self, _request: requests.BareMessage) -> dict[str, Any]:
        return {}

    def _new(self, request: requests.NewFile) -> dict[str, Any]:
        name, kind = with_suffix(request.name, ".frb"), request.kind
        if kind in EXAMPLES:
            return self._copied(kind, name)
        if kind not in PURPOSES:
            raise MessageError(f"must be one of {', '.join((*PURPOSES, *EXAMPLES))}", "kind")
        if kind != CONTROLLER:
            sugeno = request.method == "sugeno"
            return self._written(name, starting_text(Path(name).stem, kind, sugeno=sugeno))
        return self._written(name, self._around(name, request.around))

    def _around(self, name: str, file: str) -> str:
        """Return the text of a controller around a rule base of the folder, or a shipped one."""
        if file in self.files():
            rulebase = self.session(file).reading.parsed.rulebase
        else:
            file = file or "pd7.frb"
            rulebase = load_rulebase(shipped(file))
        if rulebase is None:
            raise OutsideError(f"'{printable(file)}' has mistakes, or is not a rule base")
        return controller_text(Path(name).stem, file, rulebase)

    def _adopt(self, request: requests.OfFile) -> dict[str, Any]:
        """Copy a shipped file into the folder, for editing."""
        return self._copied(demand_name(request.file), request.file)

    def _samples(self, _request: requests.BareMessage) -> dict[str, Any]:
        """Write samples to learn from, unless such files exist."""
        for name, text in valve_samples().items():
            if name.casefold() not in self._taken():
                self._written(name, text)
        return {}

    def _copied(self, file: str, name: str) -> dict[str, Any]:
        """Write a shipped file under a name, and the files that it uses, unless they exist."""
        text = shipped(file).read_text(encoding="utf-8")
        made = self._written(name, text)
        for used in _used(text):
            if used.casefold() not in self._taken():
                self._written(used, shipped(used).read_text(encoding="utf-8"))
        return made

    def _duplicate(self, request: requests.Naming) -> dict[str, Any]:
        name = with_suffix(request.name, Path(request.file).suffix)
        return self._written(name, self.session(request.file).text)

    def _rename(self, request: requests.Naming) -> dict[str, Any]:
        old = request.file
        path = self._path(old)
        name = with_suffix(request.name, path.suffix)
        target = self._reserved(name)
        try:
            path.replace(target)
        except OSError:
            target.unlink()
            raise
        shared = self._open.pop(old, None)
        if shared is not None:
            shared.move(target)
            self._open[name] = shared
        return {"renamed": [old, name], "open": name}

    def _delete(self, request: requests.OfFile) -> dict[str, Any]:
        name = request.file
        self._demand_folder()
        self._path(name).unlink()
        self._open.pop(name, None)
        return {"deleted": name}

    def _users(self, request: requests.OfFile) -> dict[str, Any]:
        """Name the controllers that use a file: they would miss it."""
        users = []
        for name in self.files():
            with contextlib.suppress(OSError, FuzzyarmError):
                if request.file in _used(self.session(name).text):
                    users.append(name)
        return {"users": users}

    def _carried(self, request: requests.OfFile) -> dict[str, Any]:
        """Return the present texts of the files that a file uses, shipped ones included."""
        names = self.files()
        texts = {
            name: self.session(name).text
            if name in names
            else shipped(name).read_text(encoding="utf-8")
            for name in _used(self.session(request.file).text)
        }
        return {"texts": texts}

    def put(self, name: str, text: str) -> dict[str, Any]:
        """Write a dropped file under a free name near to `name`."""
        self._demand_folder()
        names = self._taken()
        path, number = Path(name), 1
        while name.casefold() in names:
            number += 1
            name = f"{path.stem}-{number}{path.suffix}"
        return self._written(name, text)

    def _written(self, name: str, text: str) -> dict[str, Any]:
        target = self._reserved(name)
        try:
            write_atomically(target, text)
        except OSError:
            target.unlink()
            raise
        return {"open": name}

    def _reserved(self, name: str) -> Path:
        """Create an empty file, to reserve the name."""
        self._demand_free(name)
        self.folder.mkdir(parents=True, exist_ok=True)
        target = self.folder / name
        with target.open("x"):
            return target

    def _demand_free(self, name: str) -> None:
        path = self.beside(name, Path(name).suffix.lower())
        if path.name != name or path.suffix.lower() not in (*SUFFIXES, SAMPLES):
            raise OutsideError(f"'{printable(name)}' is not the name of a file that is opened")
        if name.casefold() in self._taken():
            raise OutsideError(f"'{name}' already exists")

    def _taken(self) -> set[str]:
        """Return the names in the folder; some systems ignore case."""
        if not self.folder.exists():
            return set()
        return {path.name.casefold() for path in self.folder.iterdir()}

    def _demand_folder(self) -> None:
        if self.only is not None:
            raise OutsideError("the designer has one file open; open its folder to write others")


_ACTS: Mapping[str, Callable[[Workspace, Any], dict[str, Any]]] = {
    "list": Workspace._list,
    "new": Workspace._new,
    "adopt": Workspace._adopt,
    "samples": Workspace._samples,
    "duplicate": Workspace._duplicate,
    "rename": Workspace._rename,
    "delete": Workspace._delete,
    "users": Workspace._users,
    "carried": Workspace._carried,
}
"""Question about the folder → its handler."""


@cache
def _examples() -> dict[str, str]:
    """Return the descriptions of the examples, by file name."""
    return {name: what_it_is(shipped(name).read_text(encoding="utf-8"))[1] for name in EXAMPLES}


def _used(text: str) -> list[str]:
    """Return the files named in a controller, even with mistakes in its text."""
    lines = re.findall(r"^use\s[^#\n]*", text, re.MULTILINE)
    return sorted({name for line in lines for name in re.findall(r'"([^"]+)"', line)})


def converted_file(name: str, data: bytes) -> dict[str, Any]:
    """Return a dropped file as a text of the language or a table, as `fuzzyarm convert` does.

    Parameters
    ----------
    name : str
        Of the file, by anybody.
    data : bytes
        Its content.

    Returns
    -------
    dict
        ``name`` and ``text`` to write, and ``findings`` in words.

    Raises
    ------
    FuzzyarmError
        If it is not converted, with every reason.
    """
    suffix = Path(re.split(r"[/\\]", name)[-1]).suffix.lower()
    if suffix == ".py":
        raise OutsideError(
            "a script is not run from a page",
            hint="fuzzyarm convert SCRIPT.py -o FOLDER runs it, and the page shows what it makes",
        )
    if suffix not in IMPORTS:
        raise OutsideError(f"'{printable(suffix)}' is not converted", hint=", ".join(IMPORTS))
    if len(data) > LARGEST_IMPORT:
        raise OutsideError(
            f"the file has {len(data):,} bytes; at most {LARGEST_IMPORT:,} are taken here",
            hint="fuzzyarm convert has no such limit",
        )
    with tempfile.TemporaryDirectory(prefix="fuzzyarm-") as folder:
        path = Path(folder) / clean_name(name, suffix)
        path.write_bytes(data)
        if suffix in SUFFIXES or (suffix == SAMPLES and b"fuzzyarm-table" not in data[:200]):
            return {"name": path.name, "text": read_text(path), "findings": []}
        if suffix in TABLES:
            text = table_as(read_table(path), ".lut")
            return {"name": clean_name(name, ".lut"), "text": text, "findings": []}
        return {"name": clean_name(name, ".frb"), **_converted(path)}


def _converted(path: Path) -> dict[str, Any]:
    """Return a rule base of another program as a text of the language, and the findings."""
    imported = read_foreign(path)
    exported = None
    if imported.rulebase is not None:
        exported = converted(imported.rulebase, str(path), ".frb")
    diagnostics = findings_of(imported, exported, str(path))
    if exported is None or exported.text is None:
        raise OutsideError(
            "; ".join(
                finding_words(diagnostic) for diagnostic in diagnostics if diagnostic.is_error
            )
        )
    return {
        "text": exported.text,
        "findings": [finding_words(diagnostic) for diagnostic in diagnostics],
    }


def _is_rule_base(path: Path) -> bool:
    """Whether a file of another program has fuzzy rules; an .xml may be anything."""
    if path.suffix.lower() != ".xml":
        return True
    try:
        return "<fuzzy" in _beginning(path).lower()
    except OSError:
        return False


def _beginning(path: Path) -> str:
    """Return the beginning of a file, which shows its kind."""
    with path.open("rb") as file:
        return file.read(20_000).decode("utf-8", "replace")
