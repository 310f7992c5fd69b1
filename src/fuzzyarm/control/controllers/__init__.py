"""Controllers of the arm: the study's, and yours.

:func:`controller` makes one by name, :func:`fuzzyarm.control.loop.simulate` closes the loop::

    from fuzzyarm.control.controllers import controller
    from fuzzyarm.control.loop import simulate
    from fuzzyarm.plant import reach_return

    run = simulate(controller("cdid+ie"), reach_return(), payload=True)
    print(run.rms)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily
from fuzzyarm.control.controllers.catalogue import (
    CATALOGUE,
    Sources,
    UnknownControllerError,
    controller,
)
from fuzzyarm.control.controllers.code import SourceError
from fuzzyarm.control.controllers.controller import CompiledController, Controller, Sum
from fuzzyarm.control.controllers.law import Gain, GainError
from fuzzyarm.control.controllers.own import OwnControllerError, find_controller
from fuzzyarm.control.controllers.text import ControllerText

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
