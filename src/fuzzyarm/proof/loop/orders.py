"""The execution of a proof request: verdicts, bounds, sectors, tubes."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

from fuzzyarm.base import above
from fuzzyarm.base.assignments import read_assignments
from fuzzyarm.base.errors import FuzzyarmError, UsageError, WordError
from fuzzyarm.base.numbers import read_time
from fuzzyarm.control.controllers.findings import site_by_axes
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.control.loop.words import connections, driven, sensors_of
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.language.statements import TABLE_MODES
from fuzzyarm.language.tokens import name_text
from fuzzyarm.plant.own import PLANTS, find_plant
from fuzzyarm.plant.plant import Plant
from fuzzyarm.proof.check.certificate import Certificate
from fuzzyarm.proof.check.checking import Checked, check_of
from fuzzyarm.proof.claim.text import claimed_plant, loop_sentence, problem_of, read_claim
from fuzzyarm.proof.loop.boxes import certify_tube
from fuzzyarm.proof.loop.enclosure import EnclosureError
from fuzzyarm.proof.loop.map_search import MapSearch, map_starts
from fuzzyarm.proof.loop.margins import DriveMargins, margins_of_problem
from fuzzyarm.proof.loop.parts import joined, prove_loop
from fuzzyarm.proof.loop.start_map import StartMap
from fuzzyarm.proof.loop.timed import loop_tube
from fuzzyarm.proof.loop.tube import Tube
from fuzzyarm.proof.loop.verdicts import LoopVerdict
from fuzzyarm.proof.map import Bounds, Prover, Verdict, prove_all, sector, slopes_at
from fuzzyarm.proof.map.controllers import DriveProof, prove_drives
from fuzzyarm.proof.map.sector import Sector, form_text
from fuzzyarm.proof.stop import LOOP_BUDGET, TUBE_BUDGET, Stop
from fuzzyarm.requests.experiment import ExperimentRequest
from fuzzyarm.requests.margins import MarginsRequest
from fuzzyarm.requests.prove import ProveRequest
from fuzzyarm.table import compile_table

Proof = Verdict | LoopVerdict | Checked | DriveProof | Bounds | Sector | Tube | StartMap
"""Results of a proof, by question."""

Tell = Callable[[str, int, float], None]
"""Called with the statement, the number of pieces or attempts, and the gap between the bounds."""

_PARTS = {"from": "from_", "with": "with_", "at": "at"}
"""Parts of a claim with options, and their fields."""


def _ignore_progress(_statement: str, _count: int, _gap: float) -> None:
    """Ignore progress."""


def proofs_of(request: ProveRequest, tell: Tell = _ignore_progress) -> tuple[Proof, ...]:
    """Return the results of a request."""
    require_sensible(request)
    if request.check is not None or request.sector or wants_loop(request) or bounds_one(request):
        return tuple(_single(request, request.files[0] if request.files else "", tell))
    return tuple(
        proof
        for path in request.files
        for proof in lines_of(request, path, above.function("controller_if_any")(path), tell)
    )


def _single(request: ProveRequest, path: str, tell: Tell) -> Iterable[Proof]:
    """Return the results for statements of a request, besides the lines of files."""
    controller = above.function("controller_if_any")(path)
    if request.check is not None:
        return [check_of(request, controller)]
    if bounds_one(request):
        return bounds_of(request, above.function("load_rules")(path, "prove"), tell).values()
    if not request.sector:
        return _of_loop(request, loop_of(request, controller), tell)
    if controller is not None:
        return drives_of(request, controller, tell)
    sectors, failed = sectors_of(request, above.function("load_rules")(path, "prove"), tell)
    if not sectors:
        raise WordError(f"no sector {failed[0]}")
    return sectors


def _of_loop(request: ProveRequest, loop: ControllerText, tell: Tell) -> Iterable[Proof]:
    """Return the result about a loop: its map, its tube, or a claim."""
    if request.map:
        return [map_of(request, loop, lambda found: _report(found, tell))]
    if not request.stable and request.claim is None:
        return [tube_of(request, loop, tell)[0]]
    return loops_of(request, loop, (claim_of(request),), tell)


# --- Combinations of fields ---


def require_sensible(request: ProveRequest) -> None:
    """Report mistakes before anything is read."""
    if request.check is not None:
        return
    if not request.files:
        raise UsageError("no file is given", hint="a rule base or a controller, or --check")
    for word in request.files:
        if re.search(r"[<>=]| in ", word) and not os.path.exists(word):
            raise UsageError(f"'{word}' is a statement: it stands in the file, as  prove {word}")
    single = request.sector or wants_loop(request) or bounds_one(request)
    if single and len(request.files) > 1:
        raise UsageError(f"{_mode(request)} takes one file")
    if request.along is not None and not request.sector:
        raise UsageError("--along goes with --sector")
    if request.output is not None and not (request.sector or bounds_one(request)):
        raise UsageError("--output goes with --range, --slope, --table or --sector")


def _mode(request: ProveRequest) -> str:
    modes = ("sector", "stable", "map", "claim", "duration", "range", "slope", "table")
    field = request.given(modes)
    assert field is not None
    return field.spelling


def bounds_one(request: ProveRequest) -> bool:
    """Return whether a request bounds a single quantity of an output."""
    return request.range or request.slope or request.table is not None


def wants_loop(request: ProveRequest) -> bool:
    """Return whether a request has a claim about a loop, or a tube, besides the lines of a file."""
    _require_map(request)
    required = (
        request.stable or request.map or request.claim is not None or request.duration is not None
    )
    for word, field in _PARTS.items():
        if getattr(request, field) is not None:
            if request.claim is not None:
                raise UsageError(f"--{word} is part of --claim", hint=f"write {word} in the claim")
            if not required:
                modes = "--stable or --for" if word == "from" else "--stable, --map or --for"
                raise UsageError(f"--{word} goes with {modes}")
    if request.stable and request.duration is not None:
        raise UsageError("--stable is for all time: --for goes with --claim, or alone")
    return bool(required)


def _require_map(request: ProveRequest) -> None:
    """Refuse fields that conflict with a map of starts."""
    for name in ("over", "workers", "resume"):
        if getattr(request, name) is not None and not request.map:
            raise UsageError(f"--{name} goes with --map")
    if not request.map:
        return
    if request.from_ is not None:
        raise UsageError("--from goes with --stable or --for", hint="the window of --map is --over")
    if request.duration is not None or request.continuous:
        raise UsageError("--map is of the sampled loop, for all time")


# --- The lines of files ---


def lines_of(
    request: ProveRequest, path: str, controller: ControllerText | None, tell: Tell
) -> Iterator[Verdict | LoopVerdict | DriveProof]:
    """Judge the ``prove`` lines of a file; of a controller also the properties of its drives."""
    rulebases = (
        controller.model.rulebases if controller else (above.function("load_rules")(path, "prove"),)
    )
    yield from rules_of(request, rulebases, tell)
    if controller is not None:
        yield from loops_of(request, controller, controller.claims, tell)
        yield from drives_of(request, controller, tell)


def rules_of(
    request: ProveRequest, rulebases: Iterable[RuleBase], tell: Tell = _ignore_progress
) -> Iterator[Verdict]:
    """Judge the ``prove`` lines of rule bases."""
    for rulebase in rulebases:
        yield from prove_all(
            rulebase, tolerance=request.tolerance, budget=budget_of(request), exact=request.exact,
            tell=tell,
        )  # fmt: skip


def budget_of(request: ProveRequest) -> float:
    """Return the time for each statement, s."""
    return request.budget or math.inf


# --- One quantity ---


def bounds_of(
    request: ProveRequest, rulebase: RuleBase, tell: Tell = _ignore_progress
) -> dict[str, Bounds]:
    """Return bounds of values, slopes or a table's error, by name."""
    prover = prover_of(request, rulebase, only_output(rulebase, request.output), tell)
    if request.table is not None:
        return {"worst": _error_of_table(prover, request.table)}
    if request.range:
        return {"range": prover.value({})._replace(hole=prover.hole({}))}
    return {name: prover.slope({}, name) for name in prover.names}


def prover_of(request: ProveRequest, rulebase: RuleBase, output: str, tell: Tell) -> Prover:
    """Return the bounds of an output, or of all outputs of the file."""
    what = request.files[0] if request.files else output
    stop = Stop(budget_of(request), lambda count, gap: tell(what, count, gap))
    stop.say(0)
    return Prover(rulebase, output, tolerance=request.tolerance, stop=stop, exact=request.exact)


def only_output(rulebase: RuleBase, name: str | None) -> str:
    """Return the named output, or the only one."""
    names = [output.name for output in rulebase.outputs]
    if name is None and len(names) != 1:
        raise WordError("the file has several outputs", hint=f"--output {' or '.join(names)}")
    if name is not None and name not in names:
        raise WordError(f"no output is called '{name}'", hint=f"there are {', '.join(names)}")
    return name or names[0]


def _error_of_table(prover: Prover, which: str) -> Bounds:
    if which in TABLE_MODES:
        return prover.table(compile_table(prover.rulebase, prover.output.name), which)
    if not which.lower().endswith((".lut", ".csv", ".npz", ".json")):
        raise UsageError(f"--table takes {', '.join(TABLE_MODES)} or a table, not '{which}'")
    table = above.function("load_sampled")(which)
    return prover.table(table, table.default_mode)


# --- Sectors ---


def sectors_of(
    request: ProveRequest, rulebase: RuleBase, tell: Tell = _ignore_progress
) -> tuple[list[Sector], list[str]]:
    """Return the sectors of an output, and in words the sums without one."""
    if request.plant is not None:
        raise UsageError("--plant is for controllers, not for rule bases")
    prover = prover_of(request, rulebase, only_output(rulebase, request.output), tell)
    sectors, failed = list[Sector](), list[str]()
    for weights in _forms(prover, request.along, failed):
        try:
            sectors.append(sector(prover, weights))
        except FuzzyarmError as error:
            failed.append(f"along {form_text(weights)}: {error}")
    return sectors, failed


def _forms(prover: Prover, along: str | None, failed: list[str]) -> list[dict[str, Any]]:
    """Return the sums of inputs: each alone, and the linear law."""
    if along is not None:
        return [dict(read_assignments([along], prover.names))]
    forms: list[dict[str, Any]] = [{name: 1} for name in prover.names]
    if len(prover.names) > 1:
        try:
            slopes = slopes_at(prover, {})
        except FuzzyarmError as error:
            failed.append(f"along a linear law: {error}")
            return forms
        gains = {name: slopes.along({name: Fraction(1)}) for name in prover.names}
        joint = {name: gain for name, gain in gains.items() if gain}
        if len(joint) > 1:
            forms.append(joint)
    return forms


def plant_of_drives(request: ProveRequest, controller: ControllerText) -> Plant | None:
    """Return the plant with the ranges for drives: that of the request, else of all claims."""
    if request.plant is not None:
        return find_plant(request.plant)
    named = {claim.plant for claim in controller.claims}
    if len(named) == 1 and (request.trust or named <= set(PLANTS)):
        return find_plant(*named)
    return None


def drives_of(
    request: ProveRequest, controller: ControllerText, tell: Tell = _ignore_progress
) -> list[DriveProof]:
    """Prove the static part of a controller."""
    if request.along is not None or request.output is not None:
        raise UsageError("--along and --output are for rule bases, not for controllers")
    plant = plant_of_drives(request, controller)
    return prove_drives(controller, plant, budget=budget_of(request), tell=tell)


# --- Loops ---


def loop_of(request: ProveRequest, controller: ControllerText | None) -> ControllerText:
    """Return the controller of the loop in question."""
    if controller is None:
        raise WordError(
            f"{request.files[0]} is not a controller:"
            " --stable, --map, --claim and --for are about loops",
            hint="a claim about a rule base is a line of it, as in  prove y rises with x",
        )
    return controller


def loops_of(
    request: ProveRequest,
    controller: ControllerText,
    claims: tuple[LoopClaim, ...],
    tell: Tell = _ignore_progress,
) -> Iterator[LoopVerdict]:
    """Judge claims about the loop of a controller."""
    for claim in claims:
        yield prove_loop(
            controller, claim, budget=budget_of(request), continuous=request.continuous, tell=tell,
            **setup_of(request, claim),
        )  # fmt: skip


LEAST_SHARE = 0.25
"""Share of the budget for a certificate if the proof took nearly all of it."""


def certificate_of(
    request: ProveRequest,
    controller: ControllerText,
    verdict: LoopVerdict,
    tell: Tell = _ignore_progress,
) -> Certificate:
    """Return the certificate of a verdict; for a tube it is searched first.

    The search may take the rest of the budget. LoopProofError if there is none.
    """
    if verdict.certificate is not None:
        return verdict.certificate
    claim = verdict.claim
    assert claim is not None
    if verdict.parts:
        found = [certificate_of(request, controller, part, tell) for part in verdict.parts]
        return joined(claim, found)
    budget = request.budget or TUBE_BUDGET
    return certify_tube(
        controller, claim, regions=() if verdict.haven is None else (verdict.haven,),
        budget=max(budget - verdict.work, LEAST_SHARE * budget),
        tell=lambda count, gap: tell(f"certificate of {verdict.statement}", count, gap),
        **setup_of(request, claim),
    )  # fmt: skip


def setup_of(request: ProveRequest, claim: LoopClaim) -> dict[str, Any]:
    """Return the plant, connections and sensors of a loop, as keywords of `prove_loop`."""
    loop = ExperimentRequest(
        connect=request.connect, quantise=request.quantise, sensor_delay=request.sensor_delay,
        actuator_delay=request.actuator_delay,
    )  # fmt: skip
    plant = driven(loop, claimed_plant(claim, request.plant, trust=request.trust))
    setup: dict[str, Any] = {"connect": connections(loop), "plant": plant}
    if loop.quantise or loop.sensor_delay:
        setup["sensors"] = sensors_of(loop, plant)
    return setup


def claim_of(request: ProveRequest, dashes: str = "--") -> LoopClaim:
    """Return the claim of the fields: ``claim``, or ``stable`` with its parts.

    `dashes`: prefix of a field's name in messages; empty on a page.
    """
    plant = request.plant or ""
    if request.claim is not None:
        return _ended(read_claim(request.claim, plant, f"{dashes}claim '{request.claim}'"), request)
    if not plant:
        word = "stable" if request.stable else "map" if request.map else "for"
        hint = f"{dashes}plant motor" if dashes else "choose one"
        raise UsageError(f"{dashes}{word} needs a plant", hint=hint)
    parts = {}
    if request.at is not None:
        pairs = (pair.partition("=") for pair in request.at.split(","))
        parts["at"] = ", ".join(f"{_name(port)} = {value}" for port, _, value in pairs)
    for word in ("with", "from"):
        value = getattr(request, _PARTS[word])
        if value is not None:
            parts[word] = value
    for word, value in parts.items():  # each alone first, so that a mistake names its option
        source = f"{dashes}{word} '{getattr(request, _PARTS[word])}'"
        read_claim(f"stable {word} {value}", plant, source)
    return read_claim(" ".join(["stable", *(f"{word} {parts[word]}" for word in parts)]), plant)


def margins_of_request(request: MarginsRequest) -> list[DriveMargins]:
    """Return the margins of a loop, opened at each drive."""
    text = above.function("controller_if_any")(request.file)
    if text is None:
        raise WordError(f"{request.file} is not a controller, and only a loop has margins")
    return margins_of_text(text, request)


def margins_of_text(text: ControllerText, request: MarginsRequest) -> list[DriveMargins]:
    """Return the margins of a loaded controller's loop."""
    plant = request.plant
    if plant is None:
        site = site_by_axes(text.model, connections(ExperimentRequest(connect=request.connect)))
        if site is None:
            raise UsageError("margins are of a loop: which plant?", hint="--plant motor")
        plant = site.name
    proof_request = ProveRequest(
        files=(request.file,), stable=True, plant=plant, at=request.at, with_=request.with_,
        connect=request.connect, sensor_delay=request.sensor_delay,
        actuator_delay=request.actuator_delay,
    )  # fmt: skip
    claim = claim_of(proof_request)
    problem = problem_of(text, claim, inside=True, **setup_of(proof_request, claim))
    return margins_of_problem(problem, request.share, request.budget)


def map_of(
    request: ProveRequest,
    controller: ControllerText,
    watch: Callable[[StartMap], None],
    *,
    certify: bool = False,
) -> StartMap:
    """Map the starts of a loop: proved, refuted or open."""
    claim = claim_of(request)
    if request.over is not None:
        source = f"--over '{request.over}'"
        start = read_claim(f"stable from {request.over}", request.plant or "", source).start
        claim = replace(claim, start=start)
    setup = setup_of(request, claim)
    search = MapSearch(
        request.budget or LOOP_BUDGET, request.workers or 1, request.resume, certify=certify
    )
    return map_starts(controller, claim, search, watch=watch, **setup)


def _report(found: StartMap, tell: Tell) -> None:
    tell(found.statement, len(found.boxes), 1.0 - found.decided)


def _name(word: str) -> str:
    return name_text(word.strip().strip("'"))


def _ended(claim: LoopClaim, request: ProveRequest) -> LoopClaim:
    """Return a claim with the end given by ``duration``."""
    if request.duration is None:
        return claim
    if claim.stable or claim.when == "during":
        raise UsageError(
            "--for gives a claim with `after` or `always` an end; this has none to give"
        )
    end = read_time(request.duration, "--for")
    if not end > claim.begin:
        raise WordError(f"--for ends at {end:g} s, before the claim begins at {claim.begin:g} s")
    return replace(claim, when="during", end=end)


def tube_of(
    request: ProveRequest, controller: ControllerText, tell: Tell = _ignore_progress
) -> tuple[Tube, tuple[str, ...], str]:
    """Bound all ports of the plant for a time: the tube, its open parts, and its statement."""
    claim = claim_of(request)
    duration = read_time(request.duration or "", "--for")
    setup = setup_of(request, claim)
    statement = loop_sentence(
        claim, setup.get("sensors"), setup["connect"], plant=setup["plant"], text=controller,
        duration=duration,
    )  # fmt: skip
    try:
        way, left_open = loop_tube(
            controller, claim, duration, budget=budget_of(request), **setup,
            tell=lambda share, boxes: tell(statement, boxes, 1.0 - share),
        )  # fmt: skip
    except EnclosureError as error:
        raise WordError(f"{request.files[0]}: {error}") from error
    return way, left_open, statement
