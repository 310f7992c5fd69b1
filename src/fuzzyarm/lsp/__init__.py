"""The language server: what :mod:`fuzzyarm.language.queries` answers, over the protocol.

Needs the extra ``lsp``: :func:`fuzzyarm.lsp.features.make_server`. The open files
named here know nothing of the protocol's library.
"""

from typing import TYPE_CHECKING

from fuzzyarm.lazy import lazily
from fuzzyarm.lsp.session import FileKind, Session
from fuzzyarm.lsp.tables import TableText

__all__ = ["FileKind", "Session", "TableText"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
