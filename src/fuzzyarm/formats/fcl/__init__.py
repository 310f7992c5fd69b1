"""FCL, the language of IEC 61131-7, in the dialects of jFuzzyLogic and fuzzylite."""

from fuzzyarm.formats.fcl.reader import parse_fcl
from fuzzyarm.formats.fcl.writer import write_fcl

__all__ = ["parse_fcl", "write_fcl"]
