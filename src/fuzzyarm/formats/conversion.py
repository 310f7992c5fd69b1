"""From the file of one program to that of another: what ``fuzzyarm convert`` writes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from fuzzyarm.formats.findings import Exported, Imported
from fuzzyarm.formats.registry import write
from fuzzyarm.formats.tables import in_tables
from fuzzyarm.language.reading import format_text
from fuzzyarm.language.tokens import tokenize
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.text.diagnostic import Diagnostic, Severity

__all__ = ["converted", "findings_of"]


def converted(
    rulebase: RuleBase,
    source: str,
    target: str,
    own_text: str = "",
    *,
    producer: str | None = None,
    lossy: bool = False,
    strict: bool = False,
) -> Exported:
    """Return a rule base that was read as the text of another file.

    Parameters
    ----------
    rulebase : RuleBase
        What was read.
    source : str
        The file it was read from; its name is that of a rule base without one.
    target : str
        The suffix of the format to write.
    own_text : str
        The text that was read, where it is of the language: from ``.frb`` to ``.frb`` it is
        formatted and keeps its comments; elsewhere they are counted.
    producer, lossy, strict
        As for :func:`fuzzyarm.formats.write`.
    """
    is_own = Path(source).suffix.lower() == ".frb"
    if is_own and target == ".frb":
        return Exported(format_text(own_text, source))
    titled = rulebase if rulebase.name.strip() else replace(rulebase, name=Path(source).stem)
    exported = write(
        in_tables(titled) if target == ".frb" else titled,
        target,
        producer=producer,
        lossy=lossy,
        strict=strict,
    )
    comments = sum(bool(line.comment) for line in tokenize(own_text, []))
    if not comments:
        return exported
    message = f"{comments} comment{'' if comments == 1 else 's'} left out"
    loss = Diagnostic("dropped-comments", message, severity=Severity.INFO)
    return replace(exported, diagnostics=(loss, *exported.diagnostics))


def findings_of(imported: Imported, exported: Exported | None, source: str) -> list[Diagnostic]:
    """Return what was found in reading and in writing; a rule knows where it stood in `source`."""
    diagnostics = () if exported is None else exported.diagnostics
    return [
        *imported.diagnostics,
        *(replace(diagnostic, path=source) for diagnostic in diagnostics),
    ]
