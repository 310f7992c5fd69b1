"""The views of ``fuzzyarm watch``: a file under edit, drawn anew at each save.

A :class:`WatchedFile` has the findings of its text and the last good :class:`WatchScene`, whose
crisp inputs are moved by keys.
"""

from typing import TYPE_CHECKING

from fuzzyarm.apps.watch.document import WatchedFile
from fuzzyarm.apps.watch.scenes import RulebaseScene, TableScene, WatchScene
from fuzzyarm.base.lazy import lazily

__all__ = ["RulebaseScene", "TableScene", "WatchScene", "WatchedFile"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
