"""The studio: a rule base on the left, what it means on the right, redrawn while it is typed.

The scenes named here need rich alone, and ``fuzzyarm watch`` shows them too;
:mod:`fuzzyarm.studio.app` needs the extra ``studio``.
"""

from typing import TYPE_CHECKING

from fuzzyarm.lazy import lazily
from fuzzyarm.studio.document import StudioDocument
from fuzzyarm.studio.scene import RulebaseScene, Scene, TableScene

__all__ = ["RulebaseScene", "Scene", "StudioDocument", "TableScene"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
