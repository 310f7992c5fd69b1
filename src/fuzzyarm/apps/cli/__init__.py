"""The command line: words in, calls out. The only package that prints."""

from typing import TYPE_CHECKING

from fuzzyarm.apps.cli.main import main
from fuzzyarm.base.lazy import lazily

__all__ = ["main"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
