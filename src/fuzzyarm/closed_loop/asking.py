"""What is asked of a rule base, or of a controller in its loop, in one call."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, TypedDict, overload

from fuzzyarm.closed_loop.claims import read_claim
from fuzzyarm.closed_loop.verdicts import LoopVerdict, prove_loop
from fuzzyarm.controller.text import ControllerText
from fuzzyarm.loop.course import Sensor
from fuzzyarm.model.claims import LoopClaim
from fuzzyarm.model.rulebase import AnyRuleBase, Property
from fuzzyarm.plant.own import find_plant
from fuzzyarm.plant.plant import Plant
from fuzzyarm.proof import verdicts
from fuzzyarm.proof.verdicts import Verdict
from fuzzyarm.text.keywords import demand_keywords
from fuzzyarm.text.mistaken import CONTROLLER, MODEL, RULE_BASE, OfKind, wrong_kind

__all__ = ["prove"]

Tell = Callable[[str, int, float], None]

_LOOP_WORDS = re.compile(r"\s*(?:prove\s+)?(stable|on)\b")
"""How a statement on a loop begins."""


class ProveKeywords(TypedDict, total=False):
    """Keywords of `prove`.

    Attributes
    ----------
    plant : str or Plant
        Of a controller: a shipped plant, a file, or one of your own; then the statement need not
        say ``on PLANT``.
    connect : mapping of str to str
        Of a controller: from its names to ports of the plant, where they differ.
    sensors : mapping of str to Sensor
        Of a controller: by port; exact ones by default.
    budget : float
        Seconds after which it stays undecided.
    tolerance : float
        Of a rule base: how far a bound may be from what is attained, in units of what is bounded;
        1e-8 of the range of the output by default.
    exact : bool
        Of a rule base: compute in rationals throughout, so that bounds are not widened.
    continuous : bool
        Of a controller: as if it ran without a period.
    tell : callable
        Called with the statement, the number of pieces or attempts and the gap between the bounds;
        NaN where there is none.
    """

    plant: str | Plant | None
    connect: Mapping[str, str] | None
    sensors: Mapping[str, Sensor] | None
    budget: float
    tolerance: float | None
    exact: bool
    continuous: bool
    tell: Tell | None


OF_RULES = ("tolerance", "budget", "exact", "tell")
OF_LOOPS = ("connect", "sensors", "budget", "continuous", "tell")
"""Keywords that count where a rule base is asked, and a controller in its loop."""


@overload
def prove(
    thing: ControllerText,
    statement: str | LoopClaim,
    *,
    plant: str | Plant | None = None,
    connect: Mapping[str, str] | None = None,
    sensors: Mapping[str, Sensor] | None = None,
    budget: float = math.inf,
    continuous: bool = False,
    tell: Tell | None = None,
) -> LoopVerdict: ...


@overload
def prove(
    thing: AnyRuleBase,
    statement: str | Property,
    *,
    budget: float = math.inf,
    tolerance: float | None = None,
    exact: bool = False,
    tell: Tell | None = None,
) -> Verdict: ...


def prove(
    thing: ControllerText | AnyRuleBase,
    statement: str | LoopClaim | Property,
    **keywords: Any,
) -> LoopVerdict | Verdict:
    """Prove or refute what is said of a rule base, or of a controller in its loop.

    Parameters
    ----------
    thing : RuleBase or ControllerText
        Which.
    statement : str, Property or LoopClaim
        As behind ``prove`` in a file: ``"u rises with e"`` of a rule base, ``"stable on motor"``
        of a controller.
    **keywords
        ``budget`` and ``tell``; of a rule base ``tolerance`` and ``exact``; of a controller
        ``plant``, ``connect``, ``sensors`` and ``continuous``. See
        :class:`~fuzzyarm.closed_loop.asking.ProveKeywords`.

    Returns
    -------
    Verdict or LoopVerdict
        With its evidence.

    Raises
    ------
    RuleBaseError
        If the statement cannot be read.
    WrongKindError
        If it is one on a loop and `thing` is a rule base, or the other way round.
    PlantError
        If there is no such plant.

    Examples
    --------
    >>> import fuzzyarm
    >>> pd7 = fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))
    >>> fuzzyarm.prove(pd7, "u odd").verdict
    'proved'
    >>> servo = fuzzyarm.load(fuzzyarm.shipped("servo.frb"))
    >>> fuzzyarm.prove(servo, "stable", plant="motor").verdict
    'proved'
    """
    demand_keywords("prove", keywords, ProveKeywords)
    if not isinstance(thing, ControllerText):
        if not isinstance(thing, OfKind):
            raise wrong_kind(thing, MODEL)
        if isinstance(statement, LoopClaim) or _is_of_a_loop(statement, thing):
            raise wrong_kind(thing, CONTROLLER)
        own_words = {name: keywords[name] for name in OF_RULES if name in keywords}
        return verdicts.prove(thing, statement, **own_words)
    plant = keywords.get("plant")
    own = find_plant(plant) if plant is not None else None
    name = "" if own is None else plant if isinstance(plant, str) else own.name
    if isinstance(statement, LoopClaim):
        claim = statement
    elif isinstance(statement, str) and (name or _LOOP_WORDS.match(statement)):
        claim = read_claim(statement, str(name))
    else:
        raise wrong_kind(thing, RULE_BASE)
    if name and isinstance(plant, str):
        claim = replace(claim, plant=name)
    own_words = {name: keywords[name] for name in OF_LOOPS if name in keywords}
    return prove_loop(thing, claim, plant=own, **own_words)


def _is_of_a_loop(statement: str | Property, rulebase: AnyRuleBase) -> bool:
    """Whether a text speaks of a loop; an output may be called ``stable`` or ``on``."""
    words = _LOOP_WORDS.match(statement) if isinstance(statement, str) else None
    return words is not None and all(words[1] != output.name for output in rulebase.model.outputs)
