"""The version of fuzzyarm; at the bottom, since files of every kind name their origin."""

__version__ = "0.1.0"
