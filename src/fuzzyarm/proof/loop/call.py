"""The call of a proof: a statement on a rule base, a claim about a loop, a whole file."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from dataclasses import replace
from typing import Any, Literal, TypedDict, Unpack, overload

from fuzzyarm.base import above
from fuzzyarm.base.keywords import ArgumentError, demand_alone, demand_arguments, wrong_argument
from fuzzyarm.base.names import nearest
from fuzzyarm.base.value_kinds import CONTROLLER, MODEL, RULE_BASE, wrong_kind
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.control.loop.course import Sensor
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.language.model.rulebase import AnyRuleBase, Property
from fuzzyarm.plant.own import find_plant
from fuzzyarm.plant.plant import Plant
from fuzzyarm.proof.claim.text import claimed_plant, read_claim
from fuzzyarm.proof.loop.map_search import MapSearch, map_starts
from fuzzyarm.proof.loop.orders import Proof, proofs_of
from fuzzyarm.proof.loop.parts import prove_loop
from fuzzyarm.proof.loop.start_map import StartMap
from fuzzyarm.proof.loop.verdicts import LoopVerdict
from fuzzyarm.proof.map import verdicts
from fuzzyarm.proof.map.verdicts import Verdict
from fuzzyarm.proof.stop import LOOP_BUDGET, default_budget
from fuzzyarm.requests.fields import read_fields
from fuzzyarm.requests.prove import ProveRequest

Tell = Callable[[str, int, float], None]

_LOOP_WORDS = re.compile(r"\s*(?:prove\s+)?(stable|on)\b")
"""First words of a statement on a loop."""


class _MapKeywords(TypedDict, total=False):
    """Keywords of `prove` for a map of starts, besides the plant."""

    connect: Mapping[str, str] | None
    sensors: Mapping[str, Sensor] | None
    budget: float
    tell: Tell | None
    over: str | Mapping[str, tuple[float, float]]
    workers: int
    executor: Executor | None
    resume: str | os.PathLike[str] | None


class ProveKeywords(_MapKeywords, total=False):
    """Keywords of `prove`.

    Attributes
    ----------
    plant : str or Plant
        Of a controller: a shipped plant, a file, or a plant of your own; the statement may then
        leave ``on PLANT`` out.
    connect : mapping of str to str
        Of a controller: port of the plant for each of its names that differs.
    sensors : mapping of str to Sensor
        Of a controller: by port; exact ones by default.
    budget : float
        Processor seconds until the verdict is undecided; infinite: no limit for a rule base; a
        minute for a tube, two for a claim over a time, five for other claims about a loop.
    tolerance : float
        Of a rule base: largest gap between bounds and attained values, in their units; 1e-8 of the
        range of the output by default.
    exact : bool
        Of a rule base: compute in rationals only, without widening.
    continuous : bool
        Of a controller: in continuous time, without a period.
    tell : callable
        Called with the statement, the number of pieces or attempts and the gap between the bounds;
        NaN if there is none.
    trust : bool
        Of a file: whether code of its plants may run.
    map : bool
        Of a controller on `plant`: a map of the starts proved to come to rest, in place of a
        statement; a :class:`StartMap`.
    over : str or mapping of str to (float, float)
        Of a map: the window of starts, as in ``"position in -1 .. 1"``; by default the ranges of
        the outputs.
    workers : int
        Of a map: processes at a time; each has the whole budget.
    executor : Executor
        Of a map: any of :mod:`concurrent.futures` instead of processes of this machine.
    resume : path-like
        Of a map: a journal file, begun or continued.
    """

    plant: str | Plant | None
    tolerance: float | None
    exact: bool
    continuous: bool
    trust: bool
    map: bool


OF_RULES = ("tolerance", "budget", "exact", "tell")
OF_MAPS = ("over", "workers", "executor", "resume")
OF_LOOPS = ("connect", "sensors", "budget", "continuous", "tell")
"""Keywords about a rule base, and about a controller in its loop."""


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
    thing: ControllerText | str | os.PathLike[str],
    statement: None = None,
    *,
    plant: str | Plant,
    map: Literal[True],
    **keywords: Unpack[_MapKeywords],
) -> StartMap: ...


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


@overload
def prove(
    thing: str | os.PathLike[str], statement: str | LoopClaim | Property, **keywords: Any
) -> LoopVerdict | Verdict: ...


@overload
def prove(
    thing: ProveRequest | str | os.PathLike[str], *, tell: Tell | None = None, **keywords: Any
) -> tuple[Proof, ...]: ...


def prove(
    thing: ControllerText | AnyRuleBase | ProveRequest | str | os.PathLike[str],
    statement: str | LoopClaim | Property | None = None,
    **keywords: Any,
) -> LoopVerdict | Verdict | StartMap | tuple[Proof, ...]:
    """Prove or refute properties of a rule base, or of a controller in its loop.

    Parameters
    ----------
    thing : RuleBase, ControllerText, str, path-like or ProveRequest
        The subject; of a file its path. A request alone is a whole ``fuzzyarm prove`` command.
    statement : str, Property or LoopClaim, optional
        As after ``prove`` in a file: ``"u rises with e"`` of a rule base, ``"stable on motor"``
        of a controller. A path without one: all statements of its file.
    **keywords
        ``budget`` and ``tell``; of a rule base ``tolerance`` and ``exact``; of a controller
        ``plant``, ``connect``, ``sensors``, ``continuous`` and ``trust``; with ``map=True`` also
        ``over``, ``workers`` and ``resume``. See
        :class:`~fuzzyarm.proof.loop.call.ProveKeywords`.

    Returns
    -------
    Verdict, LoopVerdict, StartMap or tuple
        A verdict on the statement, with its evidence; with ``map=True`` a map of starts. Of a
        request, or a path alone, a tuple of all results: verdicts, properties of drives,
        bounds, sectors, a tube or a map.

    Raises
    ------
    RuleBaseError
        If the statement cannot be read.
    WrongKindError
        If the statement is about a loop and `thing` is a rule base, or the other way round.
    PlantError
        If there is no such plant.
    FuzzyarmError
        If fields of a request conflict.

    Examples
    --------
    >>> import fuzzyarm
    >>> pd7 = fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))
    >>> fuzzyarm.prove(pd7, "u odd").verdict
    'proved'
    >>> fuzzyarm.prove(fuzzyarm.shipped("servo.frb"), "stable", plant="motor").verdict
    'proved'
    """
    demand_arguments("prove", keywords, ProveKeywords, ("thing", "statement"))
    read_fields(ProveRequest, keywords, ("budget", "tolerance"))
    if isinstance(thing, ProveRequest):
        demand_alone("prove", statement, {name for name in keywords if name != "tell"} or None)
        return _all_of(thing, keywords.get("tell"))
    is_path = isinstance(thing, str | os.PathLike)
    if not isinstance(thing, AnyRuleBase | ControllerText) and not is_path:
        raise wrong_kind(thing, MODEL)
    if _wants_map(keywords):
        return _map_of(thing, statement, keywords)
    if statement is None:
        if isinstance(thing, str | os.PathLike):
            return _of_file(os.fspath(thing), keywords)
        raise ArgumentError(
            "prove() needs a statement", argument="statement", hint="as in prove(pd7, 'u odd')"
        )
    if not isinstance(statement, str | Property | LoopClaim):
        raise wrong_argument("prove", "statement", "one statement", statement)
    model = above.function("load")(thing) if isinstance(thing, str | os.PathLike) else thing
    if isinstance(model, ControllerText):
        return _of_controller(model, statement, keywords)
    if not isinstance(model, AnyRuleBase):
        raise wrong_kind(model, MODEL)
    if isinstance(statement, LoopClaim) or _is_of_a_loop(statement, model):
        raise wrong_kind(model, CONTROLLER)
    own_words = {name: keywords[name] for name in OF_RULES if name in keywords}
    return verdicts.prove(model, statement, **own_words)


def _wants_map(keywords: dict[str, Any]) -> bool:
    """Return whether a map is requested; refuse its keywords otherwise."""
    if keywords.pop("map", False):
        return True
    for name in OF_MAPS:
        if name in keywords:
            raise ArgumentError(f"prove() takes '{name}' with map=True", argument=name)
    return False


def _map_of(
    thing: ControllerText | AnyRuleBase | str | os.PathLike[str],
    statement: str | LoopClaim | Property | None,
    keywords: dict[str, Any],
) -> StartMap:
    """Map the starts of a controller's loop; a statement may give its set point."""
    model = above.function("load")(thing) if isinstance(thing, str | os.PathLike) else thing
    if not isinstance(model, ControllerText):
        raise wrong_kind(model, CONTROLLER)
    plant = keywords.get("plant")
    if plant is None:
        raise ArgumentError(
            "prove() needs a plant for a map", argument="plant", hint="as in plant='motor'"
        )
    loop_plant = find_plant(plant)
    name = plant if isinstance(plant, str) else loop_plant.name
    if isinstance(statement, LoopClaim):
        claim = statement
    elif isinstance(statement, str | None):
        claim = read_claim(statement or "stable", name, f"prove('{statement}')")
    else:
        raise wrong_kind(model, RULE_BASE)
    over = keywords.get("over") or {}
    if isinstance(over, str):
        claim = replace(claim, start=read_claim(f"stable from {over}", name, over).start)
    elif over:
        claim = replace(claim, start=tuple((n, float(a), float(b)) for n, (a, b) in over.items()))
    tell = keywords.get("tell")
    watch = None
    if tell is not None:
        watch = lambda found: tell(found.statement, len(found.boxes), 1.0 - found.decided)  # noqa: E731
    budget, resume = keywords.get("budget", math.inf), keywords.get("resume")
    search = MapSearch(
        budget=default_budget(budget, LOOP_BUDGET),
        workers=keywords.get("workers", 1),
        executor=keywords.get("executor"),
        journal=None if resume is None else os.fspath(resume),
    )
    return map_starts(
        model, claim, search, plant=loop_plant, connect=keywords.get("connect"),
        sensors=keywords.get("sensors"), watch=watch,
    )  # fmt: skip


def _of_file(path: str, keywords: dict[str, Any]) -> tuple[Proof, ...]:
    """Prove all statements of a file."""
    words = {name: value for name, value in keywords.items() if name != "tell"}
    for name in ("plant", "connect", "sensors"):
        if name in words:
            raise ArgumentError(
                f"prove() takes '{name}' with a statement", argument=name,
                hint="a ProveRequest has it for all of a file",
            )  # fmt: skip
    budget = words.pop("budget", math.inf)
    # A request is JSON, which has no infinity.
    limit = None if math.isinf(budget) else budget
    return _all_of(ProveRequest(files=(path,), budget=limit, **words), keywords.get("tell"))


def _all_of(request: ProveRequest, tell: Tell | None) -> tuple[Proof, ...]:
    return proofs_of(request) if tell is None else proofs_of(request, tell)


def _of_controller(
    thing: ControllerText, statement: str | LoopClaim | Property, keywords: dict[str, Any]
) -> LoopVerdict:
    """Judge a claim about the loop of a controller."""
    plant = keywords.get("plant")
    loop_plant = find_plant(plant) if plant is not None else None
    name = "" if loop_plant is None else plant if isinstance(plant, str) else loop_plant.name
    if isinstance(statement, LoopClaim):
        claim = statement
    # With a plant the statement can only be a claim. Without one a misspelt claim is still read as
    # one, so that the message is about its words.
    elif isinstance(statement, str) and (name or _may_be_a_claim(statement)):
        claim = read_claim(statement, str(name), f"prove('{statement}')")
    else:
        raise wrong_kind(thing, RULE_BASE)
    if name and isinstance(plant, str):
        claim = replace(claim, plant=name)
    if loop_plant is None:
        loop_plant = claimed_plant(claim, trust=keywords.get("trust", False))
    own_words = {name: keywords[name] for name in OF_LOOPS if name in keywords}
    return prove_loop(thing, claim, plant=loop_plant, **own_words)


def _may_be_a_claim(statement: str) -> bool:
    """Return whether a statement begins like a claim about a loop, or nearly so."""
    words = statement.strip().removeprefix("prove ").split(maxsplit=1)
    return bool(words) and nearest(words[0], ("stable", "on")) is not None


def _is_of_a_loop(statement: str | Property, rulebase: AnyRuleBase) -> bool:
    """Return whether a text is about a loop; an output may be called ``stable`` or ``on``."""
    words = _LOOP_WORDS.match(statement) if isinstance(statement, str) else None
    return words is not None and all(words[1] != output.name for output in rulebase.model.outputs)
