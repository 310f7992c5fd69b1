"""Read a rule base from text (never fails) or from a file (may fail); format a text."""

from __future__ import annotations

import os
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from fuzzyarm.base.diagnostic import (
    MAX_CHARACTERS,
    MAX_DIAGNOSTICS,
    Diagnostic,
    RuleBaseError,
    Span,
)
from fuzzyarm.base.keywords import demand_text
from fuzzyarm.base.numbers import counted
from fuzzyarm.base.protected import note_source
from fuzzyarm.base.shown import one_line
from fuzzyarm.language.document import (
    Document,
    ParseMemory,
    parse_document,
    print_document,
    size_fault,
)
from fuzzyarm.language.meaning import UNNAMED, elaborate
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.language.statements import Broken, ControllerHeading, Heading
from fuzzyarm.symbolic.records import emptied_with_kinds, failures

if TYPE_CHECKING:
    from fuzzyarm.language.model.controller import ControllerModel

# --- Reading ---

MANY = 2
"""Mistakes from which on a text may be one of another program."""


class Parsed(NamedTuple):
    """The result of reading a text.

    Attributes
    ----------
    document : Document
        The syntax tree.
    partial : RuleBase
        Model of the valid statements of a rule base, whatever the faults of others.
    diagnostics : tuple of Diagnostic
        Every mistake, in the order of the text.
    whole : ControllerModel or None
        Model of the valid statements of a controller, in a file that has one.
    """

    document: Document
    partial: RuleBase
    diagnostics: tuple[Diagnostic, ...]
    whole: ControllerModel | None = None

    def __repr__(self) -> str:
        what = repr(self.partial if self.whole is None else self.whole)
        count = len(self.diagnostics)
        return one_line(self, f"{what}, {counted(count, 'finding')}")

    @property
    def rulebase(self) -> RuleBase | None:
        """The rule base, or None if there is an error or no rule base."""
        sound = not any(d.is_error for d in self.diagnostics)
        return self.partial if sound and (self.whole is None or self.whole.rulebases) else None

    @property
    def controller(self) -> ControllerModel | None:
        """The controller, or None if there is an error or no controller."""
        return None if any(d.is_error for d in self.diagnostics) else self.whole


def parse(text: str, path: str = "<text>", memory: ParseMemory | None = None) -> Parsed:
    """Read `text` as a rule base; never raises.

    Parameters
    ----------
    text : str
        Any text at all.
    path : str
        Name of the file, for the diagnostics.
    memory : ParseMemory, optional
        Memory of an earlier version of the text; speeds up reading.

    Returns
    -------
    Parsed
        The rule base if there is no error, and every mistake in order.
    """
    document = parse_document(demand_text("parse", text), memory)
    too_large = any(d.name in ("file-too-large", "line-too-long") for d in document.diagnostics)
    repaired, mended = document, frozenset[int]()
    heads = {type(statement.node) for statement in document.statements}
    if document.diagnostics and not too_large:
        from fuzzyarm.language.foreign_syntax import corrected_document, foreign_text

        # One finding that names the other language instead of hundreds about its syntax.
        foreign = foreign_text(text) if len(document.diagnostics) >= MANY else None
        if foreign is not None:
            document = document._replace(diagnostics=(foreign,))
            diagnostics = [replace(foreign, path=path)]
            return Parsed(document, RuleBase(UNNAMED, (), (), ()), tuple(diagnostics))
        repaired, mended = corrected_document(text, document)
        document = document._replace(diagnostics=repaired.diagnostics)
        heads = {type(statement.node) for statement in repaired.statements}
    whole: ControllerModel | None = None
    partial, findings = RuleBase(UNNAMED, (), (), ()), list[Diagnostic]()
    # A controller with an unreadable heading is not a rule base without rules.
    headless = any(
        isinstance(item.node, Broken) and item.node.keyword == "controller"
        for item in repaired.statements
    )
    if (ControllerHeading not in heads and not headless) or Heading in heads:
        partial, findings = elaborate(repaired, memory)
        findings = [finding for finding in findings if finding.line not in mended]
    if ControllerHeading in heads:
        from fuzzyarm.language.controller_meaning import elaborate_controller

        sheet = partial if Heading in heads else None
        whole, more = elaborate_controller(repaired.statements, sheet)
        findings += [finding for finding in more if finding.line not in mended]
    # A truncated text has no meaning to judge.
    diagnostics = list(document.diagnostics) if too_large else [*document.diagnostics, *findings]
    if failures:
        diagnostics = list(map(_with_failure, diagnostics))
    # One slip in a line shared by several variables is one finding; so are the quotes of a name.
    once = {
        (d.name, d.replacement if d.name == "double-quoted-name" else d.span): d
        for d in reversed(diagnostics)
    }
    diagnostics = sorted(once.values(), key=lambda diagnostic: diagnostic.span)
    return Parsed(document, partial, tuple(_limited(diagnostics, path)), whole)


KEPT = 16
"""Number of cached texts."""

LONG = 200_000
"""Characters above which a text is not cached."""


def parse_once(text: str, path: str = "<text>") -> Parsed:
    """Return the result of :func:`parse`, cached for recent texts.

    So equal texts share rule base objects, and everything cached for these.
    """
    return parse(text, path) if len(text) > LONG else _parsed(text, path)


@lru_cache(maxsize=KEPT)
def _parsed(text: str, path: str) -> Parsed:
    return parse(text, path)


emptied_with_kinds(_parsed.cache_clear)


def _with_failure(diagnostic: Diagnostic) -> Diagnostic:
    """Add to a finding on an unknown kind that a package with kinds failed to load."""
    unknown = diagnostic.name in ("unknown-shape", "unknown-choice", "unknown-hedge")
    if not unknown or diagnostic.replacement is not None:
        return diagnostic
    return replace(diagnostic, hint="; ".join(failures))


def _limited(findings: list[Diagnostic], path: str) -> list[Diagnostic]:
    diagnostics = [replace(diagnostic, path=path) for diagnostic in findings[:MAX_DIAGNOSTICS]]
    if len(findings) > MAX_DIAGNOSTICS:
        diagnostics.append(
            Diagnostic(
                "too-many-mistakes",
                f"there are more than {MAX_DIAGNOSTICS:,} findings; the others are not shown",
                findings[MAX_DIAGNOSTICS].span,
                path=path,
            )
        )
    return diagnostics


def read_text(path: str | os.PathLike[str]) -> str:
    """Return the text of a UTF-8 file, without a byte order mark.

    Raises
    ------
    OSError
        If the file cannot be read.
    RuleBaseError
        If it is too large or not UTF-8; the diagnostic points at the first bad byte.
    """
    note_source(path)
    with open(path, "rb") as file:
        # UTF-8 has at most four bytes for a character; one byte more shows a file that is too
        # large.
        return decoded(file.read(4 * MAX_CHARACTERS + 1), os.fspath(path))


def decoded(data: bytes, name: str) -> str:
    """Return the text of a file called `name`; raises as :func:`read_text`."""
    if len(data) > 4 * MAX_CHARACTERS:
        message = f"the file is larger than {4 * MAX_CHARACTERS:,} bytes"
        raise RuleBaseError([Diagnostic("file-too-large", message, path=name)])
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = data[: error.start]
        line = before.count(b"\n") + 1
        column = len(before[before.rfind(b"\n") + 1 :].decode("utf-8-sig", "replace")) + 1
        raise RuleBaseError(
            [
                Diagnostic(
                    "not-utf-8",
                    f"not UTF-8: byte 0x{data[error.start]:02x}",
                    Span(line, column, line, column + 1),
                    hint="save the file as UTF-8",
                    path=name,
                )
            ]
        ) from None


def text_to_show(path: str | os.PathLike[str]) -> str:
    """Return the text of a file for display with findings; empty if unreadable."""
    # Line ends unchanged, so that lines are counted as in the findings.
    with open(path, "rb") as file:
        data = file.read()
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")  # as files of other programs are read
    return "" if "\0" in text else text


def load_rulebase(path: str | os.PathLike[str]) -> RuleBase:
    """Return the rule base in the ``.frb`` file at `path`.

    Raises
    ------
    OSError
        If the file cannot be read.
    RuleBaseError
        If it has mistakes; `diagnostics` has all of them.
    """
    parsed = parse_once(read_text(path), os.fspath(path))
    if parsed.rulebase is None:
        raise RuleBaseError(without_rulebase(parsed, os.fspath(path)))
    return parsed.rulebase


def without_rulebase(parsed: Parsed, path: str) -> list[Diagnostic]:
    """Return the findings of a text without a rule base; for a controller, its kind."""
    diagnostics = list(parsed.diagnostics)
    if parsed.controller is not None:
        span = parsed.document.statements[0].node.span
        hint = (
            "`fuzzyarm simulate` runs it, fuzzyarm.load_controller reads it; "
            "its rule bases are in its use lines"
        )
        message = "this is a controller, not a rule base"
        diagnostics.append(Diagnostic("not-a-rule-base", message, span, hint=hint, path=path))
    return diagnostics


# --- Formatting ---


def format_text(text: str, path: str = "<text>") -> str:
    """Return `text` in canonical form; idempotent.

    Parameters
    ----------
    text : str
        A rule base without errors.
    path : str
        Name of the file, for the diagnostics.

    Raises
    ------
    RuleBaseError
        If `text` has mistakes: unintelligible text is not rewritten. Or if its canonical form
        exceeds the size limit.
    """
    parsed = parse(text, path)
    if any(diagnostic.is_error for diagnostic in parsed.diagnostics):
        raise RuleBaseError(parsed.diagnostics)
    formatted = print_document(parsed.document)
    fault = size_fault(formatted)
    if fault is not None:
        message = f"in canonical form {fault.message}"
        raise RuleBaseError([replace(fault, message=message, span=Span(1, 1, 1, 2), path=path)])
    return formatted
