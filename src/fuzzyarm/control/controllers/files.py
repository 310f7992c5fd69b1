"""Files with a controller, by suffix, and the errors for other files."""

from __future__ import annotations

import os
from pathlib import Path

from fuzzyarm.base.diagnostic import RuleBaseError
from fuzzyarm.base.folders import READABLE
from fuzzyarm.base.names import quote, typed
from fuzzyarm.base.value_kinds import CONTROLLER, RULE_BASE, TABLE, MistakenKindError
from fuzzyarm.language.reading import Parsed
from fuzzyarm.table import SUFFIXES

TEXT = ".frb"


def kind_by_suffix(path: str | os.PathLike[str]) -> str:
    """Return the kind of a file by its suffix: a table, a foreign rule base, or ""."""
    suffix = Path(path).suffix.lower()
    if suffix in ("", TEXT):
        return ""
    if suffix in SUFFIXES:
        return TABLE
    return RULE_BASE if suffix in READABLE else ""


def demand_text_file(path: str | os.PathLike[str]) -> None:
    """Raise MistakenKindError for a table or a rule base of another program."""
    kind = kind_by_suffix(path)
    if kind and Path(path).exists():  # a missing file is reported on reading
        raise not_a_controller(path, kind)


def without_controller(parsed: Parsed, path: str | os.PathLike[str]) -> Exception:
    """Return the error of a text without a controller: its mistakes, or its kind."""
    if parsed.rulebase is None:
        return RuleBaseError(parsed.diagnostics)
    return not_a_controller(path, RULE_BASE)


def not_a_controller(path: str | os.PathLike[str], kind: str) -> MistakenKindError:
    """Return the error for a file that is not a controller, with a command for it."""
    name, file = typed(os.fspath(path)), quote(Path(path).name, '"')
    is_table = kind == TABLE
    option, law = ("--table", "fuzzy-lut") if is_table else ("--rulebase", "fuzzy-direct")
    if is_table:
        other = f"another plant takes a controller with  use F from {file}  and  u = table F(e, ce)"
    elif kind_by_suffix(path):
        other = f"another plant takes a controller with  use F from {file}  and  u = rules F(e, ce)"
    else:
        other = f"fuzzyarm new NAME --kind controller --around {name} writes a controller with it"
    what = "a table" if is_table else "rules"
    hint = f"fuzzyarm simulate {law} {option} {name} runs {what} of e and ce on the arm; {other}"
    return MistakenKindError(os.fspath(path), kind, CONTROLLER, hint=hint)
