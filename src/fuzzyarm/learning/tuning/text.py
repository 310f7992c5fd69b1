"""New numbers in the files of the user; the rest of the text is unchanged."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from fuzzyarm.base.diagnostic import Figure, Span, Word, span_of, split_lines
from fuzzyarm.base.files import same_file
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.names import quote
from fuzzyarm.base.numbers import number_text
from fuzzyarm.base.protected import SourceFileError
from fuzzyarm.control.controllers.text import ControllerText, files_of, home_of, sheet_path
from fuzzyarm.language.document import Document
from fuzzyarm.language.edit.fixes import Edit, apply_edits
from fuzzyarm.language.model.controller import ControllerModel, GainModel, Use
from fuzzyarm.language.model.rulebase import RuleBase, Shape, Term
from fuzzyarm.language.phrases import ShapeNode, aligned
from fuzzyarm.language.reading import format_text, parse, read_text
from fuzzyarm.language.rows import columns_of, text_of
from fuzzyarm.language.statements import ControllerHeading, EvenTermsNode, Heading, TermNode
from fuzzyarm.language.writer import write
from fuzzyarm.learning.tuning.design import Candidate

MARK = "# tuned: "
"""Prefix of every comment about the origin of numbers."""


@dataclass(frozen=True)
class Rewritten:
    """A file before and after.

    Attributes
    ----------
    name : str
        Its name in the controller; empty for the tuned file itself.
    path : str
        Path of the file; empty if there is none.
    old, new : str
        Its text.
    """

    name: str
    path: str
    old: str
    new: str

    @property
    def changed(self) -> bool:
        """Whether any number differs."""
        return self.old != self.new

    def diff(self) -> str:
        """Return the lines that differ, as ``diff -u`` shows them, without context."""
        title = Path(self.path).name if self.path else self.name or "text"
        lines = difflib.unified_diff(
            self.old.splitlines(),
            self.new.splitlines(),
            f"{title} (before)",
            f"{title} (tuned)",
            n=0,
            lineterm="",
        )
        return "\n".join(line for line in lines if not line.startswith("@@"))


@json_properties("*")
class TextChange(NamedTuple):
    """One number or shape, before and after, in the words of the file.

    Attributes
    ----------
    what : str
        Its name.
    old, new : str
        In the file, and as written.
    """

    what: str
    old: str
    new: str


# --- Changes ---


def changes_of(
    subject: ControllerText | RuleBase, sheets: Mapping[str, RuleBase], candidate: Candidate
) -> list[TextChange]:
    """Return the changes from a file to a candidate, in the order of the text."""
    changes = []
    if isinstance(subject, ControllerText):
        for gain in subject.model.gains:
            old = [amount.value(math.pi) for amount in gain.values]
            new = list(candidate.gains.get(gain.name, old))
            if new != old:
                # A quotient such as 1080/pi has no shorter digits.
                old_text = ", ".join(f"{value:.6g}" for value in old)
                changes.append(TextChange(gain.name, old_text, _numbers(new)))
    for name, rulebase in candidate.rulebases.items():
        for variable, term, old_shape in _moved(sheets[name], rulebase):
            prefix = f"{name}." if isinstance(subject, ControllerText) else ""
            label = f"{prefix}{variable} {term.name}"
            changes.append(
                TextChange(label, str(_shape_node(old_shape)), str(_shape_node(term.shape)))
            )
    return changes


def _numbers(values: Sequence[float]) -> str:
    return ", ".join(map(number_text, values))


def _moved(old: RuleBase, new: RuleBase) -> Iterator[tuple[str, Term, Shape]]:
    """Yield the terms with different shapes, with the old shape."""
    for variable in (*new.inputs, *new.outputs):
        before = old.variable(variable.name)
        for term in variable.terms:
            shape = before.term(term.name).shape
            if shape != term.shape:
                yield variable.name, term, shape


def _shape_node(shape: Shape) -> ShapeNode:
    height = None if shape.height == 1.0 else Figure(shape.height)
    return ShapeNode(Word(shape.kind), tuple(map(Figure, shape.parameters)), height=height)


# --- The texts ---


class Originals(NamedTuple):
    """The texts of a subject before a search; its files may change or vanish meanwhile.

    Attributes
    ----------
    path, text : str
        Of the tuned file; a rule base without a file is written from its model.
    used : dict of str to pair of str
        Path and text of its rule bases, by their names in it.
    """

    path: str
    text: str
    used: dict[str, tuple[str, str]]


def originals_of(subject: ControllerText | RuleBase, path: str = "", text: str = "") -> Originals:
    """Read the texts of a subject."""
    if isinstance(subject, RuleBase):
        return Originals(path, text or (read_text(path) if path else write(subject)), {})
    path = path or subject.path
    originals = {}
    for use in subject.model.uses:
        before = subject.sheets[use.name][0] if use.name in subject.sheets else None
        if isinstance(before, RuleBase):
            place = _place(use.files[0], path)
            original = read_text(place) if place and _contains(place, before) else write(before)
            originals[use.name] = place, original
    return Originals(path, text or (read_text(path) if path else ""), originals)


def rewritten(
    subject: ControllerText | RuleBase,
    candidate: Candidate,
    originals: Originals,
    notes: Sequence[str] = (),
) -> list[Rewritten]:
    """Return the files of a subject with the numbers of a candidate, the subject's own first."""
    path, old = originals.path, originals.text
    if isinstance(subject, RuleBase):
        new = candidate.rulebases.get(subject.name, subject)
        return [Rewritten("", path, old, _edited(old, None, {}, (subject, new), notes))]
    model = subject.model
    inside = {rulebase.name: rulebase for rulebase in model.rulebases}
    inside_model = next(iter(inside.values()), None)
    replacement = None
    if inside_model is not None and inside_model.name in candidate.rulebases:
        replacement = inside_model, candidate.rulebases[inside_model.name]
    files = []
    if old:
        files.append(
            Rewritten("", path, old, _edited(old, model, candidate.gains, replacement, notes))
        )
    for use in model.uses:
        changed = candidate.rulebases.get(use.name)
        before = subject.sheets[use.name][0] if use.name in subject.sheets else None
        if changed is None or not isinstance(before, RuleBase):
            continue
        place, sheet_text = originals.used[use.name]
        own_text = _edited(sheet_text, None, {}, (before, changed), notes)
        files.append(Rewritten(use.name, place, sheet_text, own_text))
    return files


def _place(file: str, path: str) -> str:
    """Return the path of a used file; empty if it is not a text of the language."""
    if not file.endswith(".frb"):
        return ""
    place = sheet_path(file, home_of(path))
    return str(place) if place.exists() else ""


def _contains(place: str, rulebase: RuleBase) -> bool:
    """Whether a file contains the tuned subject; false for a model passed in its place."""
    parsed = parse(read_text(place), place)
    return parsed.rulebase == rulebase


def _edited(
    text: str,
    model: ControllerModel | None,
    gains: Mapping[str, Sequence[float]],
    moved: tuple[RuleBase, RuleBase] | None,
    notes: Sequence[str],
) -> str:
    """Return a text with other numbers, and notes before its heading."""
    parsed = parse(text)
    edits: list[Edit] = []
    if model is not None:
        edits += _gain_edits(parsed.document, model, gains)
    if moved is not None:
        edits += _term_edits(parsed.document, *moved)
    if not edits:
        return text
    canonical = _is_canonical(text)
    changed = apply_edits(text, [*edits, *_note_edits(parsed.document, text, notes)])
    # A text in canonical form stays canonical.
    return format_text(changed) if canonical else changed


def _is_canonical(text: str) -> bool:
    try:
        return format_text(text) == text
    except ValueError:
        return False


def _gain_edits(
    document: Document, model: ControllerModel, gains: Mapping[str, Sequence[float]]
) -> Iterator[Edit]:
    values_by_name = {gain.name: [v.value(math.pi) for v in gain.values] for gain in model.gains}
    for statement in document.statements:
        node = statement.node
        if not isinstance(node, GainModel) or node.name not in gains:
            continue
        values = list(gains[node.name])
        if values != values_by_name[node.name]:
            yield Edit(span_of(node.values[0]).to(span_of(node.values[-1])), _numbers(values))


def _term_edits(document: Document, old: RuleBase, new: RuleBase) -> Iterator[Edit]:
    changed = {(variable, term.name): term for variable, term, _ in _moved(old, new)}
    explicit: set[tuple[str, str]] = set()
    for statement in document.statements:
        node = statement.node
        if isinstance(node, TermNode) and node.shape is not None:
            key = str(node.variable), str(node.name)
            explicit.add(key)
            if key in changed:
                yield from _figure_edits(node.shape, changed[key].shape)
    for statement in document.statements:
        node = statement.node
        if isinstance(node, EvenTermsNode):
            yield from _spread_edits(node, new, changed, explicit)


def _figure_edits(node: ShapeNode, shape: Shape) -> Iterator[Edit]:
    for figure, value in zip(node.figures, shape.parameters, strict=True):
        if figure != value:
            yield Edit(figure.span, number_text(value))


def _spread_edits(
    node: EvenTermsNode,
    new: RuleBase,
    moved: Mapping[tuple[str, str], Term],
    stated: set[tuple[str, str]],
) -> Iterator[Edit]:
    """Yield edits that write out each term of variables no longer evenly spaced."""
    names = list(node.names)
    uneven = [
        word
        for word in node.variables
        if any((word, name) in moved and (word, name) not in stated for name in names)
    ]
    if not uneven:
        return
    rest = tuple(word for word in node.variables if word not in uneven)
    rows = [
        columns_of(TermNode(word, name, _shape_node(new.variable(word).term(name).shape)))
        for word in uneven
        for name in node.names
        if (word, name) not in stated
    ]
    lines = [line.strip() for line in aligned(rows)]
    if rest:
        lines.insert(0, text_of(node._replace(variables=rest)))
    yield Edit(node.span, "\n".join(lines))


def _note_edits(document: Document, text: str, notes: Sequence[str]) -> Iterator[Edit]:
    """Put notes before the heading, in place of earlier ones."""
    for number, words in enumerate(split_lines(text), 1):
        if words.startswith(MARK):
            yield Edit(Span(number, 1, number + 1, 1), "")
    headings = (Heading, ControllerHeading)
    for statement in document.statements:
        if isinstance(statement.node, headings):
            line = statement.node.span.line
            yield Edit(Span(line, 1, line, 1), "".join(f"{MARK}{note}\n" for note in notes))
            return


# --- Replaced files ---


def demand_not_used(out: str | Path, subject: ControllerText | RuleBase, path: str) -> None:
    """Raise SourceFileError if a controller would overwrite a file that it uses.

    Its own file is among those of `path`, and may be written.
    """
    if not isinstance(subject, ControllerText):
        return
    others = (file for file in files_of(subject.model, path).values() if not same_file(file, path))
    if any(same_file(out, file) for file in others):
        raise SourceFileError(str(out))


def with_files(text: str, files: Mapping[str, str]) -> str:
    """Return a controller whose ``use`` lines name other files, by their names."""
    edits = []
    for statement in parse(text).document.statements:
        node = statement.node
        if isinstance(node, Use) and node.name in files:
            span = span_of(node.files[0]).to(span_of(node.files[-1]))
            edits.append(Edit(span, quote(files[node.name], '"')))
    return apply_edits(text, edits)
