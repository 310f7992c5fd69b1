"""Services for editors: hover, references, completion, edits.

Pure functions over a :class:`Reading`, without numerics and without any protocol: the
language server, the designer and the tests share them. Lines and columns count from 1.
"""

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily
from fuzzyarm.language.edit.building import (
    add_rule,
    add_variable,
    remove_variable,
    rename_variable,
    set_setting,
)
from fuzzyarm.language.edit.completion import Completion, complete
from fuzzyarm.language.edit.fixes import Edit, Fix, apply_edits, fixes
from fuzzyarm.language.edit.grids import (
    FILLS,
    add_column,
    add_grid,
    add_row,
    graded,
    remove_column,
    remove_grid,
    remove_row,
)
from fuzzyarm.language.edit.hover import Hover, hover, plain
from fuzzyarm.language.edit.lines import INCOMPLETE, ReshapeError
from fuzzyarm.language.edit.outline import (
    COLOURS,
    Coloured,
    Fold,
    OutlineSymbol,
    coloured,
    folds,
    symbols,
)
from fuzzyarm.language.edit.reading import Facts, Reading, read
from fuzzyarm.language.edit.references import (
    RenameError,
    occurrence_at,
    references,
    rename,
)
from fuzzyarm.language.edit.reshape import (
    Reshaped,
    add_term,
    add_tuning,
    remove_term,
    rename_term,
    set_cell,
    set_gain,
    set_kind,
    set_ranges,
    set_rule,
    set_shapes,
    set_variable_range,
)
from fuzzyarm.language.phrases import NameKind, Occurrence

__all__ = [
    "COLOURS",
    "FILLS",
    "INCOMPLETE",
    "Coloured",
    "Completion",
    "Edit",
    "Facts",
    "Fix",
    "Fold",
    "Hover",
    "NameKind",
    "Occurrence",
    "OutlineSymbol",
    "Reading",
    "RenameError",
    "ReshapeError",
    "Reshaped",
    "add_column",
    "add_grid",
    "add_row",
    "add_rule",
    "add_term",
    "add_tuning",
    "add_variable",
    "apply_edits",
    "coloured",
    "complete",
    "fixes",
    "folds",
    "graded",
    "hover",
    "occurrence_at",
    "plain",
    "read",
    "references",
    "remove_column",
    "remove_grid",
    "remove_row",
    "remove_term",
    "remove_variable",
    "rename",
    "rename_term",
    "rename_variable",
    "set_cell",
    "set_gain",
    "set_kind",
    "set_ranges",
    "set_rule",
    "set_setting",
    "set_shapes",
    "set_variable_range",
    "symbols",
]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
