"""Questions that an editor asks of a text: what stands here, where else, what could stand here.

Pure functions over a :class:`Reading`, without numerics and without any protocol: the
language server, the studio and the tests share them. Lines and columns count from 1.
"""

from fuzzyarm.rulebase.queries.candidates import Candidate
from fuzzyarm.rulebase.queries.colours import COLOURS, Coloured, coloured
from fuzzyarm.rulebase.queries.completion import complete
from fuzzyarm.rulebase.queries.fixes import Edit, Fix, apply_edits, fixes
from fuzzyarm.rulebase.queries.folding import Fold, folds
from fuzzyarm.rulebase.queries.hover import Hover, hover
from fuzzyarm.rulebase.queries.occurrences import Kind, Occurrence
from fuzzyarm.rulebase.queries.places import definitions, occurrence_at, references
from fuzzyarm.rulebase.queries.reading import Reading, read
from fuzzyarm.rulebase.queries.rename import RenameError, rename
from fuzzyarm.rulebase.queries.symbols import Symbol, symbols

__all__ = [
    "COLOURS",
    "Candidate",
    "Coloured",
    "Edit",
    "Fix",
    "Fold",
    "Hover",
    "Kind",
    "Occurrence",
    "Reading",
    "RenameError",
    "Symbol",
    "apply_edits",
    "coloured",
    "complete",
    "definitions",
    "fixes",
    "folds",
    "hover",
    "occurrence_at",
    "read",
    "references",
    "rename",
    "symbols",
]
