"""Live objects of other fuzzy libraries: import as rule bases, comparison of the numbers.

A module for each library reads its objects by their attributes and evaluates them.
:mod:`fuzzyarm.exchange.live.objects` lists the libraries; :mod:`fuzzyarm.exchange.live.gather` runs
a script in its own process. No library is imported here, and nothing but the top-level names
imports this package.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

if TYPE_CHECKING:
    from fuzzyarm.exchange.live.skfuzzy import from_skfuzzy, to_skfuzzy
    from fuzzyarm.exchange.live.systems import ScriptError, System, from_live, read_script

__all__ = [
    "ScriptError", "System", "from_live", "from_skfuzzy", "read_script", "to_skfuzzy",
]  # fmt: skip

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(
        __name__,
        {
            "skfuzzy": ("from_skfuzzy", "to_skfuzzy"),
            "systems": ("ScriptError", "System", "from_live", "read_script"),
        },
        __all__,
    )
