"""Files and objects of other programs, and programs for other machines.

Read :mod:`.files` first: it loads and checks any file, whatever its kind.

files
    Load, check and write rule bases, controllers and tables by suffix.
formats
    FLL, FCL, FIS and FML, read and written.
live
    Objects of other fuzzy libraries.
export
    C, Structured Text, MicroPython, JavaScript, Rust; boards, PLC projects, FMUs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

if TYPE_CHECKING:
    from fuzzyarm.exchange import export as export
    from fuzzyarm.exchange import files as files
    from fuzzyarm.exchange import formats as formats
    from fuzzyarm.exchange import live as live

__all__ = ["export", "files", "formats", "live"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, (), __all__)
