"""Import and export of other programs' rule bases: FLL, FCL, FIS and FML.

Reading never raises: an :class:`Imported` holds the rule base, if there is no error, and all
findings with their positions. Writing returns an :class:`Exported` of the same form.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.folders import FOREIGN, READABLE, SUFFIXES
from fuzzyarm.base.lazy import lazily
from fuzzyarm.exchange.formats.dialects import MEANINGS, PRODUCERS
from fuzzyarm.exchange.formats.fcl_reader import parse_fcl
from fuzzyarm.exchange.formats.fcl_writer import write_fcl
from fuzzyarm.exchange.formats.findings import Exported, FormatError, Imported
from fuzzyarm.exchange.formats.fis_reader import parse_fis
from fuzzyarm.exchange.formats.fis_writer import write_fis
from fuzzyarm.exchange.formats.fll import parse_fll, write_fll
from fuzzyarm.exchange.formats.fml import parse_fml
from fuzzyarm.exchange.formats.fml_writer import write_fml
from fuzzyarm.exchange.formats.registry import (
    parse,
    read,
    same_model,
    suffix_of,
    write,
)
from fuzzyarm.exchange.formats.trees import tree

__all__ = [
    "FOREIGN", "MEANINGS", "PRODUCERS", "READABLE", "SUFFIXES", "Exported", "FormatError",
    "Imported", "parse", "parse_fcl", "parse_fis", "parse_fll", "parse_fml", "read", "same_model",
    "suffix_of", "tree", "write", "write_fcl", "write_fis", "write_fll", "write_fml",
]  # fmt: skip

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
