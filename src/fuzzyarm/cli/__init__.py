"""The command line: words in, calls out. The only package that prints."""

from fuzzyarm.cli.main import main
from fuzzyarm.lazy import lazily

__all__ = ["main"]

__getattr__, __dir__ = lazily(__name__, {}, __all__)
