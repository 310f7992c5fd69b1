"""The command line: words in, calls out. The only package that prints."""

from fuzzyarm.cli.main import main

__all__ = ["main"]
