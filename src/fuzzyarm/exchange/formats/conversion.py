"""Conversion from format to format, as ``fuzzyarm convert`` does it."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from fuzzyarm.base.diagnostic import Diagnostic, RuleBaseError, Severity
from fuzzyarm.base.numbers import counted
from fuzzyarm.base.protected import MARK
from fuzzyarm.exchange.formats.comparison import figures_of, measure
from fuzzyarm.exchange.formats.findings import Exported, Imported
from fuzzyarm.exchange.formats.registry import suffix_of, write
from fuzzyarm.exchange.formats.tables import in_tables
from fuzzyarm.language.model.rulebase import AnyRuleBase, RuleBase, model_of
from fuzzyarm.language.reading import format_text
from fuzzyarm.language.tokens import tokenize


def written(
    rulebase: AnyRuleBase,
    suffix: str,
    *,
    producer: str | None = None,
    lossy: bool = False,
    strict: bool = False,
) -> Exported:
    """Return a rule base in the format of `suffix`, with the numerical effect of each loss.

    A refusal comes with the differences that `lossy` would accept.
    """
    model = model_of(rulebase)
    exported = write(model, suffix, producer=producer, lossy=lossy, strict=strict)
    if exported.text is not None or lossy:
        return measure(model, exported, suffix, producer=producer, lossy=lossy, strict=strict)
    anyway = write(model, suffix, producer=producer, lossy=True)
    if anyway.text is None:
        return exported
    figures = figures_of(model, anyway.text, suffix, producer)
    return replace(exported, diagnostics=(*exported.diagnostics, *figures))


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
    """Return an imported rule base as the text of another format."""
    is_own = Path(source).suffix.lower() == ".frb"
    if is_own and target == ".frb":
        return Exported(format_text(own_text, source))
    titled = rulebase if rulebase.name.strip() else replace(rulebase, name=Path(source).stem)
    exported = written(
        in_tables(titled) if target == ".frb" else titled,
        target,
        producer=producer,
        lossy=lossy,
        strict=strict,
    )
    lines = tokenize(own_text, [])
    comments = sum(bool(line.comment) and MARK not in line.comment for line in lines)
    if not comments:
        return exported
    message = f"{counted(comments, 'comment')} left out"
    loss = Diagnostic("dropped-comments", message, severity=Severity.INFO)
    return replace(exported, diagnostics=(loss, *exported.diagnostics))


def findings_of(imported: Imported, exported: Exported | None, source: str) -> list[Diagnostic]:
    """Return the findings of import and export; those of a rule point to its line in `source`."""
    diagnostics = () if exported is None else exported.diagnostics
    return [
        *imported.diagnostics,
        *(replace(diagnostic, path=source) for diagnostic in diagnostics),
    ]


def text_in(rulebase: AnyRuleBase, path: str | os.PathLike[str], *, lossy: bool = False) -> str:
    """Return `rulebase` in the format that the suffix of `path` names."""
    exported = written(rulebase, suffix_of(path), lossy=lossy)
    if exported.text is None:
        raise RuleBaseError(exported.diagnostics)
    return exported.text
