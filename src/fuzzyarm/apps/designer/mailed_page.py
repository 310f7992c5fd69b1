"""One page that needs neither a server nor a network: text, pictures and inference together.

The modules of the page are one script, which `editors/designer/build.js` puts together; its digest
is all that the content policy lets run; what comes from the file is data in JSON, or text.
"""

from __future__ import annotations

import base64
import hashlib
import html
from pathlib import Path
from typing import Any

from fuzzyarm.apps.designer.assets import PAGE
from fuzzyarm.apps.designer.engine import engine_source
from fuzzyarm.apps.designer.scene import Positions, held_numbers, scene_of
from fuzzyarm.base.diagnostic import RuleBaseError, Span
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import script_json
from fuzzyarm.base.names import printable
from fuzzyarm.language import read_text
from fuzzyarm.language.edit import (
    Reading,
    Reshaped,
    ReshapeError,
    coloured,
    read,
    set_shapes,
)
from fuzzyarm.language.model.rulebase import Input, Output, RuleBase, Term
from fuzzyarm.version import __version__

BUNDLE = PAGE / "built/mailed.js"
"""The modules of the page without a server, which `make designer` puts together."""


class NotWrittenError(FuzzyarmError, ValueError):
    """A file of which no page is made."""


def page_of(path: Path) -> str:
    """Return a page for a rule base.

    Parameters
    ----------
    path : Path
        A sound rule base in the language.

    Raises
    ------
    NotWrittenError
        If the file is not a rule base.
    RuleBaseError
        If it has mistakes.
    OSError
        If it cannot be read.
    """
    if path.suffix.lower() != ".frb":
        raise NotWrittenError(f"{path} is not a .frb file: a page is made of a rule base")
    return page_of_text(read_text(path), path)


def page_of_text(text: str, path: Path) -> str:
    """Return a page for the text of a rule base; as :func:`page_of`."""
    reading = read(text.replace("\r\n", "\n").replace("\r", "\n"), str(path))
    rulebase = reading.parsed.rulebase
    if rulebase is None:
        mistakes = [diagnostic for diagnostic in reading.parsed.diagnostics if diagnostic.is_error]
        if mistakes:
            raise RuleBaseError(mistakes)
        raise NotWrittenError(f"{path} is a controller: a page is made of a rule base")
    data = {
        "file": path.name,
        "text": reading.text,
        "colours": _colours(reading),
        "scene": scene_of(rulebase, reading),
        "held": {
            variable.name: held_numbers(rulebase, variable.name)
            for variable in (*rulebase.inputs, *rulebase.outputs)
        },
        "places": _places(reading, rulebase),
        "version": __version__,
    }
    script, style = script_source(), (PAGE / "style.css").read_text(encoding="utf-8")
    policy = (
        f"default-src 'none'; script-src '{_digest(script)}'; style-src '{_digest(style)}';"
        " img-src data:; base-uri 'none'; form-action 'none'"
    )
    title = html.escape(printable(f"{rulebase.name}: {rulebase.description}".strip(": ")))
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<link rel="icon" href="data:,">
<style>{style}</style>
<script type="application/json" id="start">{script_json(data)}</script>
</head>
<body>
<noscript>This page shows a fuzzy rule base; it needs JavaScript.</noscript>
<script type="module">{script}</script>
</body>
</html>
"""


def script_source() -> str:
    """Return the engine, and behind it the modules of the page, which find it as a global."""
    bundle = BUNDLE.read_text(encoding="utf-8")
    return f"{engine_source()}\nglobalThis.fuzzyarm = {{ Engine }};\n{bundle}"


def _digest(text: str) -> str:
    """Return what a content policy names an inline element by."""
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"


def _colours(reading: Reading) -> list[list[Any]]:
    positions = Positions(reading.raw_lines)
    spans = []
    for word in coloured(reading):
        (line, start), (_, end) = positions.of(Span(word.line, word.column, word.line, word.end))
        spans.append([line, start, end, word.colour])
    return spans


def _places(reading: Reading, rulebase: RuleBase) -> list[dict[str, Any]]:
    """Return where the shape of each term goes in the text: a stretch, and words in front of it."""
    variables: tuple[Input | Output, ...] = (*rulebase.inputs, *rulebase.outputs)
    spans = []
    for variable in variables:
        for term in variable.terms:
            place = _place(reading, variable, term)
            if place is not None:
                spans.append({"variable": variable.name, "term": term.name, **place})
    return spans


def _place(reading: Reading, variable: Input | Output, term: Term) -> dict[str, Any] | None:
    if not term.shape.parameters:
        return None
    try:
        (edit,) = set_shapes(reading, [Reshaped(variable.name, term.name, term.shape, term.lower)])
    except ReshapeError:
        return None
    # The words in front of the shape are those of an edit that ends with it.
    at = edit.text.index(f"{term.shape.kind} ")
    start, end = (_offset(reading, *place) for place in (edit.span[:2], edit.span[2:]))
    return {"from": start, "to": end, "before": edit.text[:at]}


def _offset(reading: Reading, line: int, column: int) -> int:
    """Return a position in UTF-16 units."""
    before = "\n".join([*reading.raw_lines[: line - 1], reading.raw_line(line)[: column - 1]])
    return len(before.encode("utf-16-le", "surrogatepass")) // 2
