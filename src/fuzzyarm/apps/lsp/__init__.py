"""The language server: the answers of :mod:`fuzzyarm.language.edit`, over the protocol.

Needs the extra ``lsp``: :func:`fuzzyarm.apps.lsp.features.make_server`. The open files here are
independent of the protocol's library.
"""

from typing import TYPE_CHECKING

from fuzzyarm.apps.lsp.session import FileKind, Session
from fuzzyarm.apps.lsp.tables import TableText
from fuzzyarm.base.lazy import lazily

__all__ = ["FileKind", "Session", "TableText"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
