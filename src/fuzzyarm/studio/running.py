"""The run of a file in the studio: a controller on its plant, a rule base on the arm."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.errors import FuzzyarmError

if TYPE_CHECKING:
    from fuzzyarm.loop import Run
    from fuzzyarm.plant import Plant


class NotRunError(FuzzyarmError, ValueError):
    """A text that does not control anything that is shipped."""


def run_text(text: str, path: str) -> tuple[Run, Plant]:
    """Run what a text says as ``fuzzyarm simulate`` would: a step of 1, or pick and place.

    Parameters
    ----------
    text : str
        Of a controller; or of a rule base, which takes the place of that of ``fuzzy-direct``.
    path : str
        Its file; the files that a controller uses stand beside it.

    Returns
    -------
    Run
        With samples.
    Plant
        On which it ran.

    Raises
    ------
    FuzzyarmError
        If the text has mistakes, no shipped plant fits, or the rule base is not one of error and
        rate.
    """
    from fuzzyarm.controller.catalogue import controller_in
    from fuzzyarm.controller.findings import site_by_axes
    from fuzzyarm.controller.on_plant import TextLaw
    from fuzzyarm.loop import simulate
    from fuzzyarm.plant import Arm, find_plant

    controller = controller_in(text, path)
    assert isinstance(controller.law, TextLaw)
    site = site_by_axes(controller.law.text.model)
    if site is None:
        raise NotRunError("no shipped plant has the axes and ports of this controller")
    plant = find_plant(site.name)
    if isinstance(plant, Arm):
        return _on_arm(controller)
    return simulate(controller, plant), plant


def _on_arm(controller: object) -> tuple[Run, Plant]:
    from fuzzyarm.loop import simulate
    from fuzzyarm.plant import find_plant, pick_and_place

    run = simulate(controller, pick_and_place(), payload=True)  # type: ignore[arg-type]
    return run, find_plant("arm")
