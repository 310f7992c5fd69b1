"""Controllers of the arm: the study's, and yours.

:func:`controller` makes one by name, :func:`fuzzyarm.loop.simulate` closes the loop::

    from fuzzyarm.controller import controller
    from fuzzyarm.loop import simulate
    from fuzzyarm.plant import reach_return

    run = simulate(controller("cdid+ie"), reach_return(), payload=True)
    print(run.rms)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.controller.catalogue import CATALOGUE, Sources, UnknownControllerError, controller
from fuzzyarm.controller.controller import CompiledController, Controller, Sum
from fuzzyarm.controller.law import Gain, GainError
from fuzzyarm.controller.own import OwnControllerError, find_controller
from fuzzyarm.controller.program import SourceError
from fuzzyarm.controller.text import ControllerText
from fuzzyarm.lazy import lazily

__all__ = [
    "CATALOGUE",
    "CompiledController",
    "Controller",
    "ControllerText",
    "Gain",
    "GainError",
    "OwnControllerError",
    "SourceError",
    "Sources",
    "Sum",
    "UnknownControllerError",
    "controller",
    "find_controller",
]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
