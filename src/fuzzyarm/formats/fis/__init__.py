"""FIS, the file of MATLAB's Fuzzy Logic Toolbox, Octave's toolkit and fuzzylite."""

from fuzzyarm.formats.fis.reader import parse_fis
from fuzzyarm.formats.fis.writer import write_fis

__all__ = ["parse_fis", "write_fis"]
