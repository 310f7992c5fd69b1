"""Show a diagnostic to a person: place, source line, caret, hint. Plain text."""

from __future__ import annotations

from collections.abc import Sequence

from fuzzyarm.rulebase.diagnostic import Diagnostic, Severity, Span
from fuzzyarm.rulebase.printing.grids import display_width
from fuzzyarm.rulebase.syntax.tokens import split_lines

_COLOURS = {Severity.ERROR: "31", Severity.WARNING: "33", Severity.INFO: "36"}
_WIDEST = 160


def render(diagnostic: Diagnostic, text: str, *, colour: bool = False) -> str:
    """Return a diagnostic as several lines: headline, source line, caret, hint, related places.

    Parameters
    ----------
    diagnostic : Diagnostic
        What to show.
    text : str
        The text it is about.
    colour : bool
        Whether to use terminal colours.
    """
    return render_all([diagnostic], text, colour=colour)


def render_all(diagnostics: Sequence[Diagnostic], text: str, *, colour: bool = False) -> str:
    """Return several diagnostics of one text, each as :func:`render` does."""
    lines = split_lines(text)
    return "\n".join("\n".join(_parts(d, lines, colour=colour)) for d in diagnostics)


def _parts(diagnostic: Diagnostic, lines: list[str], *, colour: bool) -> list[str]:
    place = f"{diagnostic.path or '<text>'}:{diagnostic.line}:{diagnostic.column}"
    label = f"{diagnostic.severity}[{diagnostic.name}]"
    if colour:
        label = f"\x1b[1;{_COLOURS[diagnostic.severity]}m{label}\x1b[0m"
    parts = [f"{place}: {label}: {diagnostic.message}"]
    parts += _excerpt(diagnostic.span, lines)
    if diagnostic.hint:
        parts.append(f"       = hint: {diagnostic.hint}")
    for related in diagnostic.related:
        parts.append(f"       = {related.message}: {related.span.line}:{related.span.column}")
        parts += _excerpt(related.span, lines)
    return parts


def _excerpt(span: Span, lines: list[str]) -> list[str]:
    if not 1 <= span.line <= len(lines):
        return []
    line = lines[span.line - 1]
    start = min(span.column - 1, len(line))
    end = span.end_column - 1 if span.end_line == span.line else len(line)
    end = max(min(end, len(line)), start)
    offset = 0
    if len(line) > _WIDEST:
        # Long lines are shown from a little before the fault.
        offset = max(0, min(start - 20, len(line) - _WIDEST))
        end = min(end, offset + _WIDEST)
    before = _printable(line[offset:start])
    marked = _printable(line[start:end])
    shown = _printable(line[offset : offset + _WIDEST])
    caret = " " * display_width(before) + "^" * max(1, display_width(marked))
    number = f"{span.line:>6}"
    return [f"{number} | {shown}", f"{'':>6} | {caret}"]


def _printable(text: str) -> str:
    expanded = text.replace("\t", "    ")
    return "".join(c if c.isprintable() else "\ufffd" for c in expanded)
