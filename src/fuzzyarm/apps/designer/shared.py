"""An open file shared by windows: its text, its versions, and the file on disk.

The text here is authoritative. A window sends its changes with their base version; a late change is
refused, and the window rebases it on those it missed. The file on disk is read again after another
program has written it. Without unsaved changes its text is adopted; otherwise, or if it is
unreadable, there is a conflict, shown until a person decides. A missing file is reported. Nothing
is overwritten silently.
"""

from __future__ import annotations

import math
import secrets
from codecs import BOM_UTF8
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.designer import requests
from fuzzyarm.apps.designer.changes import ChangeError, applied, difference, merged
from fuzzyarm.apps.designer.faults import error_of
from fuzzyarm.apps.designer.messages import Findings, Scene, SceneDiagram, SceneMessage
from fuzzyarm.apps.designer.names import OutsideError, in_words, is_inside
from fuzzyarm.apps.designer.records import MessageError, read_record
from fuzzyarm.apps.designer.scene import Positions, held_numbers, scene_of
from fuzzyarm.apps.lsp.session import UTF16, Session, to_place
from fuzzyarm.base.diagnostic import Diagnostic, Span
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.files import Stamp, stamp_of, write_atomically
from fuzzyarm.language import read_text
from fuzzyarm.language.edit import (
    INCOMPLETE,
    Coloured,
    Edit,
    Reading,
    Reshaped,
    ReshapeError,
    add_column,
    add_grid,
    add_row,
    add_rule,
    add_term,
    add_tuning,
    add_variable,
    remove_column,
    remove_grid,
    remove_row,
    remove_term,
    remove_variable,
    rename_term,
    rename_variable,
    set_cell,
    set_gain,
    set_kind,
    set_ranges,
    set_rule,
    set_setting,
    set_shapes,
    set_variable_range,
)
from fuzzyarm.language.model.rulebase import RuleBase, Shape
from fuzzyarm.symbolic.kinds import SHAPES

if TYPE_CHECKING:
    from fuzzyarm.plant.plant import Plant

LONGEST_HISTORY = 2_000
"""Changes stored for windows that fell behind; an older window gets the whole text."""

MOST_FINDINGS = 200
"""Findings that a page shows; repairs are looked for of each."""

DISK = "disk"
"""Who made a change that came from the file."""

RESUMED = "resumed"
"""Who made one that came from a window which outlived the server."""


class ConflictError(FuzzyarmError, ValueError):
    """The file has changed on disk while something was unsaved, or is not a text any more."""


@dataclass(frozen=True)
class Conflict:
    """A text in conflict with the one here until a person decides.

    Attributes
    ----------
    text : str or None
        The other text; None for an unreadable file.
    why : str
        Why it cannot.
    on_disk : bool
        Whether it is the text on disk, and not that of another window since a restart.
    both : str or None
        The text with the changes of both; None if they touch the same lines.
    """

    text: str | None
    why: str = ""
    on_disk: bool = True
    both: str | None = None


class SharedText:
    r"""The text of a file, shared by windows.

    Parameters
    ----------
    path : Path
        The file.
    text : str, optional
        A window's text of a missing file; by default the file is read.
    plants : sequence of Plant
        Plants of the user, for the findings of a controller.

    Attributes
    ----------
    session : Session
        The text as the language server has it; lines end with ``\n``.
    version : int
        How many changes there have been since it was opened.
    epoch : str
        Which opening this is: versions of another one mean nothing.
    saved : str
        The text on disk, as far as known.
    is_there : bool
        Whether there is a file.
    is_typed : bool
        Whether a window has changed the text since it was opened.
    conflict : Conflict or None
        A text written by another program over unsaved changes here.
    """

    def __init__(self, path: Path, text: str | None = None, plants: Sequence[Plant] = ()) -> None:
        self.path = path
        self.epoch = secrets.token_hex(8)
        self.version = 0
        self.updates: list[dict[str, Any]] = []
        self.stamp: Stamp | None = stamp_of(path)
        self.mark = b""
        self.is_there = text is None
        self.is_typed = False
        if text is None:
            text = read_text(path)
            with path.open("rb") as file:
                self.mark = BOM_UTF8 if file.read(3) == BOM_UTF8 else b""
        self.newline = "\r\n" if "\r\n" in text else "\n"
        self.saved = _unix(text)
        self.conflict: Conflict | None = None
        self.session = Session(str(path), self.saved, 0, plants)

    @property
    def text(self) -> str:
        """The present text."""
        return self.session.text

    @property
    def status(self) -> dict[str, Any]:
        """Whether it is saved, and whether the file has changed, or is gone."""
        return {
            "dirty": not self.is_there or self.conflict is not None or self.text != self.saved,
            "gone": not self.is_there,
            "conflict": self.conflict is not None,
            "unreadable": self.conflict.why if self.conflict else "",
            "elsewhere": self.conflict is not None and not self.conflict.on_disk,
            "mergeable": self.conflict is not None and self.conflict.both is not None,
            "version": self.version,
        }

    # --- Changes ---

    def push(self, version: int, updates: Sequence[Mapping[str, Any]]) -> bool:
        """Apply changes of a window; False if made for another version."""
        if version != self.version:
            return False
        text = self.text
        # All are applied before any is stored: an invalid change leaves nothing half done.
        for update in updates:
            text = applied(text, update.get("changes"))
        for update in updates:
            entry = {"clientID": str(update.get("clientID", "")), "changes": update["changes"]}
            self.updates.append(entry)
        self.version += len(updates)
        self.session.replace(text, self.version)
        return True

    def since(self, version: int) -> list[dict[str, Any]] | None:
        """Return the changes from a version on; None if they are no longer stored."""
        oldest = self.version - len(self.updates)
        if not oldest <= version <= self.version:
            return None
        return self.updates[version - oldest :]

    def forget(self) -> None:
        """Drop the oldest changes."""
        del self.updates[:-LONGEST_HISTORY]

    def replace(self, text: str, who: str) -> None:
        """Replace the text, as a change."""
        if text != self.text:
            self.push(self.version, [{"clientID": who, "changes": difference(self.text, text)}])

    def resume(self, text: str, known: Sequence[str]) -> None:
        """Restore the text of the window that wrote here before a restart of the server."""
        if text == known[0]:  # it has no changes
            text = self.text if self.is_typed else self.saved
        elif self.is_typed and text != self.text:
            self.conflict = Conflict(self.text, on_disk=False)
        elif self.is_there and self.saved not in (text, *known):
            self.conflict = Conflict(self.saved, both=merged(known[0], text, self.saved))
        self.replace(text, RESUMED)

    def remember(self, text: str, saved: str) -> None:
        """Adopt the text of a reading window if it is newer than all others."""
        if self.version == 0 and saved == self.saved:
            self.replace(text, RESUMED)

    # --- The file ---

    def look(self) -> bool:
        """Read the file again if it has changed; return whether there is news."""
        stamp = stamp_of(self.path)
        if stamp == self.stamp:
            return False
        before = self.is_there, self.conflict, self.saved, self.version
        self.is_there = stamp is not None
        if not self.is_there:
            self.stamp = None
            self._agree()
        else:
            try:
                disk = self._on_disk()
            except (OSError, FuzzyarmError) as error:  # and is looked at again
                self.conflict = Conflict(None, in_words(error))
            else:
                self.stamp = stamp
                self._adopt(disk)
        return before != (self.is_there, self.conflict, self.saved, self.version)

    def _on_disk(self) -> str:
        """Read the file, unless it has become a link out of its folder."""
        self._demand_inside()
        return _unix(read_text(self.path))

    def _demand_inside(self) -> None:
        if not is_inside(self.path, self.path.parent):
            raise OutsideError(f"'{self.path.name}' now links to a file outside the folder")

    def _adopt(self, disk: str) -> None:
        """Adopt the text on disk, or note its conflict with unsaved changes here."""
        if disk not in (self.saved, self.text) and self.text != self.saved:
            self.conflict = Conflict(disk, both=merged(self.saved, self.text, disk))
            return
        text = self.text if disk == self.saved else disk
        self.saved = disk
        self._agree()
        self.replace(text, DISK)

    def _agree(self) -> None:
        """Drop a conflict with the file, which has none any more."""
        if self.conflict is not None and self.conflict.on_disk:
            self.conflict = None

    def save(self) -> None:
        """Write the file; a missing one anew."""
        self.look()
        if self.conflict is not None:
            why = f": {self.conflict.why}" if self.conflict.why else ""
            raise ConflictError(f"the file has changed on disk{why}")
        self._write()

    def _write(self) -> None:
        self._demand_inside()
        content = self.text.replace("\n", self.newline)
        try:
            data = self.mark + content.encode("utf-8")
        except UnicodeEncodeError as error:
            line = content.count("\n", 0, error.start) + 1
            raise ChangeError(f"line {line} has half of a character, which no file can") from None
        self.stamp = write_atomically(self.path, data)
        self.saved, self.is_there = self.text, True

    def move(self, path: Path) -> None:
        """Belong to another file from now on, to which this one has been renamed."""
        self.path = path
        self.session = Session(str(path), self.text, self.version, self.session.plants)

    def settle(self, keep: str) -> None:
        """End a conflict; the next save writes the differences to the file.

        An unreadable file has no text to adopt: it is overwritten at once.
        """
        conflict = self.conflict
        if conflict is None:
            return
        text = {"mine": self.text, "theirs": conflict.text, "both": conflict.both}[keep]
        if text is None:
            return
        if conflict.text is None:
            self._write()
        elif conflict.on_disk:
            self.saved = conflict.text
        self.conflict = None
        self.replace(text, DISK)

    # --- Messages to the page ---

    def findings(self, session: Session) -> Findings:
        """Return the findings and the colours of a session's text."""
        review = session.review()
        positions = Positions(session.lines)
        shown = _most_telling(review.diagnostics)
        return {
            "is": "findings",
            "version": session.version,
            "summary": review.summary,
            "findings": [
                {
                    "name": diagnostic.name,
                    "severity": str(diagnostic.severity),
                    "message": diagnostic.message,
                    "hint": diagnostic.hint,
                    "range": positions.of(diagnostic.span),
                    "fixes": [
                        fix.preferred for fix in session.kind.fixes(session.reading, diagnostic)
                    ],
                }
                for diagnostic in shown
            ],
            "more": len(review.diagnostics) - len(shown),
            "colours": [
                [*positions.of(_span(word))[0], positions.of(_span(word))[1][1], word.colour]
                for word in session.kind.coloured(session.reading)
            ],
            "verdicts": [
                [verdict.line - 1, verdict.verdict] for verdict in session.verdicts if verdict.line
            ],
        }

    def scene(self, session: Session) -> SceneMessage:
        """Return the picture of a session's text; None with mistakes."""
        reading = session.reading
        scene: Scene | None = None
        rulebase: RuleBase | None = None
        if isinstance(reading, Reading):
            rulebase = session.review().rulebase
            if rulebase is None and _is_begun(reading):
                rulebase = reading.model  # it is unfinished: its parts are drawn
            if rulebase is not None:
                scene = scene_of(rulebase, reading)
        return {
            "is": "scene",
            "version": session.version,
            "scene": scene,
            "why": "mistakes" if session.review().failed else "other",
            "diagram": self._diagram(reading, rulebase),
        }

    def _diagram(self, reading: Any, rulebase: RuleBase | None) -> SceneDiagram | None:
        """Return the block diagram of a controller without own mistakes, or of the rules."""
        controller = reading.parsed.controller if isinstance(reading, Reading) else None
        if controller is None and rulebase is None:
            return None
        from fuzzyarm.apps.designer.diagram import diagram_of, is_drawable

        if controller is None:
            assert rulebase is not None
            return diagram_of(rulebase, reading) if is_drawable(rulebase) else None
        from fuzzyarm.control.controllers.text import home_of, with_files

        return diagram_of(with_files(controller, home_of(self.path), str(self.path))[0], reading)

    # --- Questions of a page ---

    def answer(self, request: dict[str, Any]) -> dict[str, Any]:
        """Answer a question about the text; an error is said in words."""
        what = str(request.get("what"))
        if what not in _QUESTIONS:
            return {"error": "unknown question"}
        try:
            return _QUESTIONS[what](self, read_record(requests.TEXT_QUESTIONS[what], request))
        except Exception as error:  # the page waits for an answer
            return error_of(error, f"the question {what!r} about {self.path.name}")

    def _place(self, at: tuple[int, int]) -> tuple[int, int]:
        """Return line and column of a position of a page."""
        return to_place(self.session.lines, *at, UTF16)

    @property
    def _rules(self) -> Reading:
        """The text of a rule base or a controller, which the user may edit."""
        if not isinstance(self.session.reading, Reading):
            raise ReshapeError("a table is not edited in a picture")
        return self.session.reading

    def _edits(self, edits: Sequence[Edit]) -> dict[str, Any]:
        positions = Positions(self.session.lines)
        changes = [{"range": positions.of(edit.span), "text": edit.text} for edit in edits]
        return {"version": self.version, "edits": changes}

    def _complete(self, request: requests.At) -> dict[str, Any]:
        kind, positions = self.session.kind, Positions(self.session.lines)
        candidates = kind.complete(self.session.quick_reading, *self._place(request.at))
        return {
            "options": [
                {
                    "label": candidate.label,
                    "detail": candidate.detail,
                    "kind": candidate.kind,
                    "insert": candidate.insert,
                    "range": positions.of(candidate.span) if candidate.span else None,
                }
                for candidate in candidates
            ]
        }

    def _hover(self, request: requests.At) -> dict[str, Any]:
        hover = self.session.hover(*self._place(request.at))
        if hover is None:
            return {"markdown": ""}
        return {
            "markdown": hover.markdown,
            "range": Positions(self.session.lines).of(hover.span),
        }

    def _rename(self, request: requests.Rename) -> dict[str, Any]:
        reading, place = self.session.reading, self._place(request.at)
        if request.name is None:
            name = self.session.kind.name_at(reading, *place)
            return {"name": None if name is None else name[0]}
        return self._edits(self.session.kind.rename(reading, *place, request.name))

    def _fixes(self, request: requests.Fixes) -> dict[str, Any]:
        """Return the repairs of a finding, or of all in a line."""
        line, name = self._place(request.at)[0], request.name
        diagnostics = self.session.review().diagnostics if self.session.reviewed else ()
        return {
            "fixes": [
                {"title": fix.title, "of": diagnostic.name, **self._edits(fix.edits)}
                for diagnostic in diagnostics
                if diagnostic.span.line <= line <= diagnostic.span.end_line
                and name in (None, diagnostic.name)
                for fix in self.session.kind.fixes(self.session.reading, diagnostic)
            ]
        }

    def _format(self, _request: requests.BareMessage) -> dict[str, Any]:
        text = self.session.kind.formatted(self.session.reading)
        if text is None:
            return {"error": "a text with mistakes is not formatted"}
        return {"version": self.version, "changes": difference(self.text, text)}

    def _shapes(self, request: requests.Shapes) -> dict[str, Any]:
        shapes = [
            Reshaped(
                shape.variable,
                shape.term,
                _shape(shape),
                _shape(shape.lower) if shape.lower else None,
            )
            for shape in request.shapes
        ]
        return self._edits(set_shapes(self._rules, shapes))

    def _term(self, request: requests.TermEdit) -> dict[str, Any]:
        """Add, remove, rename or convert a term."""
        place = self._rules, request.variable, request.term
        if request.kind is not None:
            return self._edits(set_kind(*place, request.kind))
        if request.shape is not None:
            return self._edits(add_term(*place, _shape(request.shape)))
        if request.name is not None:
            return self._edits(rename_term(*place, request.name))
        return self._edits(remove_term(*place))

    def _variable(self, request: requests.VariableEdit) -> dict[str, Any]:
        """Add, remove or rename a variable."""
        reading, variable = self._rules, request.variable
        if request.role is not None:
            ends = request.low, request.high
            return self._edits(add_variable(reading, request.role, variable, ends, request.terms))
        if request.name is not None:
            return self._edits(rename_variable(reading, variable, request.name))
        return self._edits(remove_variable(reading, variable))

    def _setting(self, request: requests.SettingEdit) -> dict[str, Any]:
        return self._edits(set_setting(self._rules, request.key, request.value, request.target))

    def _grid(self, request: requests.GridEdit) -> dict[str, Any]:
        """Add a grid, or remove one."""
        reading = self._rules
        if request.line is not None:
            return self._edits(remove_grid(reading, request.line))
        row = request.row or None
        return self._edits(add_grid(reading, request.output, request.column, row, request.fill))

    def _head(self, request: requests.HeadEdit) -> dict[str, Any]:
        """Add a row or a column to a grid, maybe of a new term, or remove one."""
        place = self._rules, request.line, request.term
        if request.remove:
            return self._edits((remove_row if request.row else remove_column)(*place))
        shape = None if request.shape is None else _shape(request.shape)
        return self._edits((add_row if request.row else add_column)(*place, shape))

    def _compose(self, request: requests.Compose) -> dict[str, Any]:
        return self._edits(add_rule(self._rules, request.if_, request.then, request.join))

    def _range(self, request: requests.RangeEdit) -> dict[str, Any]:
        return self._edits(
            set_variable_range(self._rules, request.variable, request.low, request.high)
        )

    def _rule(self, request: requests.RuleEdit) -> dict[str, Any]:
        return self._edits(set_rule(self._rules, request.line, request.sentence))

    def _cell(self, request: requests.CellEdit) -> dict[str, Any]:
        return self._edits(set_cell(self._rules, *request.cell, request.term))

    def _table(self, request: requests.TablePage) -> dict[str, Any]:
        from fuzzyarm.apps.designer.tables import table_page

        return {"table": table_page(self.session, request.page)}

    def _table_cell(self, request: requests.TableCell) -> dict[str, Any]:
        from fuzzyarm.apps.designer.tables import cell_place

        span = cell_place(self.session, request.cell)
        return {"range": None if span is None else Positions(self.session.lines).of(span)}

    def _exports(self, _request: requests.BareMessage) -> dict[str, Any]:
        from fuzzyarm.apps.designer.exports import forms_of

        return {"forms": forms_of(self.session)}

    def _movable(self, _request: requests.BareMessage) -> dict[str, Any]:
        """Write the default movable numbers of tuning, and ranges of gains, into the text."""
        from fuzzyarm.learning.tuning.design import default_ranges, everything

        reading = self.session.reading
        parsed = reading.parsed if isinstance(reading, Reading) else None
        if parsed is None or (parsed.rulebase is None and parsed.controller is None):
            return {"error": "a text with mistakes, or a table, does not say what may move"}
        edits = []
        if parsed.rulebase is not None and parsed.rulebase.tuning is None:
            edits += add_tuning(reading, everything(parsed.rulebase))
        if parsed.controller is not None:
            edits += set_ranges(reading, default_ranges(parsed.controller))
        if not edits:
            return {"error": "there is nothing in this text that may move"}
        return self._edits(edits)

    def _merge(self, request: requests.Merge) -> dict[str, Any]:
        """Apply the change from one text to another to the present text."""
        both = merged(request.old, self.text, request.new)
        if both is None:
            return {"error": "the same lines of the text have changed meanwhile"}
        return {"version": self.version, "changes": difference(self.text, both)}

    def _gain(self, request: requests.GainEdit) -> dict[str, Any]:
        if not all(map(math.isfinite, request.values)):
            raise MessageError("must be finite", "values")
        return self._edits(set_gain(self._rules, request.name, request.values))

    def _numbers(self, request: requests.OfVariable) -> dict[str, Any]:
        rulebase = getattr(self.session.reading.parsed, "rulebase", None)  # a table has none
        if rulebase is None:
            return {"numbers": None}
        numbers = held_numbers(rulebase, request.variable)
        return {"version": self.version, "numbers": numbers}


_QUESTIONS: Mapping[str, Callable[[SharedText, Any], dict[str, Any]]] = {
    "complete": SharedText._complete,
    "hover": SharedText._hover,
    "rename": SharedText._rename,
    "fixes": SharedText._fixes,
    "format": SharedText._format,
    "merge": SharedText._merge,
    "movable": SharedText._movable,
    "shapes": SharedText._shapes,
    "term": SharedText._term,
    "variable": SharedText._variable,
    "setting": SharedText._setting,
    "grid": SharedText._grid,
    "head": SharedText._head,
    "compose": SharedText._compose,
    "range": SharedText._range,
    "cell": SharedText._cell,
    "gain": SharedText._gain,
    "rule": SharedText._rule,
    "numbers": SharedText._numbers,
    "table": SharedText._table,
    "table-cell": SharedText._table_cell,
    "exports": SharedText._exports,
}
"""Question → its handler."""


def _most_telling(diagnostics: Sequence[Diagnostic]) -> list[Diagnostic]:
    """Return as many findings as a page shows, errors before others, in the order of the text."""
    errors_first = sorted(range(len(diagnostics)), key=lambda k: not diagnostics[k].is_error)
    return [diagnostics[k] for k in sorted(errors_first[:MOST_FINDINGS])]


def _is_begun(reading: Reading) -> bool:
    """Whether the only mistake of a text is that something is not there yet."""
    wrong = {diagnostic.name for diagnostic in reading.parsed.diagnostics if diagnostic.is_error}
    return bool(wrong) and wrong <= INCOMPLETE


def _shape(request: requests.ShapeOf) -> Shape:
    """Return a shape as a page describes it."""
    if request.kind not in SHAPES:
        raise MessageError("is not a shape", "kind")
    return Shape(request.kind, request.parameters, request.height)


def _unix(text: str) -> str:
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _span(word: Coloured) -> Span:
    return Span(word.line, word.column, word.line, word.end)
