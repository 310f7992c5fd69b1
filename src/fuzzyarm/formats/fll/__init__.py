"""FLL, the language of fuzzylite 5 to 8: reading and writing."""

from fuzzyarm.formats.fll.reader import parse_fll
from fuzzyarm.formats.fll.writer import write_fll

__all__ = ["parse_fll", "write_fll"]
