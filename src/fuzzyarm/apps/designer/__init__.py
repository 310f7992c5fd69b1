"""The designer: a rule base as text and as a picture, in a browser.

The text stays the one source of truth: whatever the user changes in the page is an edit of the
text. `server` holds the open files, `scene` says what a page draws, `written` writes a page that
needs no server; the page itself is in ``page/``.
"""

from typing import TYPE_CHECKING

from fuzzyarm.apps.designer.mailed_page import page_of
from fuzzyarm.base.lazy import lazily

__all__ = ["page_of"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
