"""Systems of other fuzzy libraries, live: rule bases of them, their numbers compared.

A module for each library reads its objects by their attributes and asks them for their numbers;
:mod:`fuzzyarm.exchange.live.objects` knows all of them, :mod:`fuzzyarm.exchange.live.gather` runs
a script in a its own process. Nothing of a library is imported here, and nothing but the top names
this package.
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
