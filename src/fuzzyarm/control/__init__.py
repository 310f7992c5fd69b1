"""The closed loop: control laws, and runs of them on a plant.

Read :mod:`.controllers.program` first (a controller as text, as a program over cells), then
:mod:`.controllers.period` (one control period over any kind of number) and :mod:`.loop.loop`
(the kernel that steps controller and plant).

controllers
    Controllers as text, the catalogue of the arm, controllers in Python.
loop
    A run, many runs, sweeps, metrics, references, analysis.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

if TYPE_CHECKING:
    from fuzzyarm.control import controllers as controllers
    from fuzzyarm.control import loop as loop

__all__ = ["controllers", "loop"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, (), __all__)
