"""Controllers in their loops: what ``fuzzyarm prove`` says of claims and of certificates."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from fuzzyarm.api import controller_if_any
from fuzzyarm.cli.command import WordError, print_json, say
from fuzzyarm.cli.prove_sectors import EXIT_UNDECIDED, ProveWords, progress

if TYPE_CHECKING:
    from fuzzyarm.closed_loop import LoopVerdict, Tube
    from fuzzyarm.controller.text import ControllerText
    from fuzzyarm.model.claims import LoopClaim

EXIT_REFUTED = 1

_PARTS = {"from": "from_", "with": "with_", "at": "at"}
"""Parts of a claim that are options, and the fields that have them."""


def wants_loop(asked: ProveWords) -> bool:
    """Tell whether a claim about a loop, or a tube of it, is asked for in the command."""
    wanted = asked.stable or asked.claim is not None or asked.duration is not None
    for word, field in _PARTS.items():
        if getattr(asked, field) is not None:
            if asked.claim is not None:
                raise WordError(f"--{word} is part of --claim", hint=f"write {word} in the claim")
            if not wanted:
                raise WordError(f"--{word} goes with --stable or --for")
    if asked.stable and asked.duration is not None:
        raise WordError("--stable is for all time: --for goes with --claim, or alone")
    return bool(wanted)


def prove_loops(asked: ProveWords, budget: float) -> int:
    """Do what ``--stable``, ``--claim`` or ``--for`` says."""
    if len(asked.files) > 1:
        raise WordError("--stable, --claim and --for take one file")
    path = asked.files[0]
    controller = controller_if_any(path)
    if controller is None:
        raise WordError(f"{path} is not a controller: --stable, --claim and --for are about loops")
    if not asked.stable and asked.claim is None:
        return _bound(path, controller, asked, budget)
    (verdict,) = _judged(path, controller, [_claim_of(asked)], asked, budget)
    if asked.json:
        print_json(loop_data(verdict), 2)
    return _exit_status(verdict)


def _claim_of(asked: ProveWords) -> LoopClaim:
    from fuzzyarm.closed_loop import read_claim

    plant = asked.plant or ""
    if asked.claim is not None:
        return _ended(read_claim(asked.claim, plant), asked)
    if not plant:
        word = "--stable" if asked.stable else "--for"
        raise WordError(f"{word} needs a plant", hint="--plant motor")
    text = "stable"
    if asked.at is not None:
        pairs = (pair.partition("=") for pair in asked.at.split(","))
        text += " at " + ", ".join(f"{_name(port)} = {value}" for port, _, value in pairs)
    for word in ("with", "from"):
        value = getattr(asked, _PARTS[word])
        if value is not None:
            text += f" {word} {value}"
    return read_claim(text, plant)


def _name(word: str) -> str:
    from fuzzyarm.language.tokens import name_text

    return name_text(word.strip().strip("'"))


def _ended(claim: LoopClaim, asked: ProveWords) -> LoopClaim:
    """Return a claim with the end that ``--for`` says."""
    if asked.duration is None:
        return claim
    if claim.stable or claim.when == "during":
        raise WordError(
            "--for gives a claim with `after` or `always` an end; this has none to give"
        )
    from fuzzyarm.loop.reference import read_time

    end = read_time(asked.duration or "", "--for")
    if not end > claim.begin:
        raise WordError(f"--for ends at {end:g} s, before the claim begins at {claim.begin:g} s")
    return replace(claim, when="during", end=end)


# ── a tube ───────────────────────────────────────────────────────────────────────────


def _bound(path: str, controller: ControllerText, asked: ProveWords, budget: float) -> int:
    """Bound all ports of the plant for a time; what is left open is said."""
    from fuzzyarm.closed_loop import EnclosureError, claim_text, loop_tube
    from fuzzyarm.loop.reference import read_time

    if asked.certificate is not None:
        raise WordError("--certificate goes with a claim about a loop", hint="--claim, --stable")
    _require_figure(asked)
    claim = _claim_of(asked)
    duration = read_time(asked.duration or "", "--for")
    statement = claim_text(claim).removeprefix("stable ") + f" for {duration:g} s"
    with progress() as tell:
        try:
            way, open_ = loop_tube(
                controller, claim, duration, budget=budget, **_setup(claim, asked),
                tell=lambda share, boxes: tell(statement, boxes, 1.0 - share),
            )  # fmt: skip
        except EnclosureError as error:
            raise WordError(f"{path}: {error}") from error
        tell("", 0, 0.0)
    if asked.json:
        data = {"property": statement, "complete": way.complete, "open": list(open_)}
        print_json({**data, "tube": tube_data(way), "seconds": round(way.seconds, 6)}, 2)
    else:
        found = [*(way.lines() if way.complete else ()), *open_]
        found.append(f"{way.boxes} box{'es' * (way.boxes != 1)}, {way.seconds:.2f} s")
        say(f"{path}: {statement}", *(f"  {line}" for line in found))
    if asked.plot is not None and way.complete:
        _draw_tube(way, statement, asked.plot)
        if not asked.json:
            say(f"{asked.plot}: drawn from {path}")
    return 0 if way.complete and not way.open else EXIT_UNDECIDED


def tube_data(way: Tube | None) -> dict[str, Any] | None:
    """Return a tube as JSON has it: of each port the bounds in all periods."""
    if way is None or not way.complete:
        return None
    return {
        "duration": way.duration,
        "boxes": way.boxes,
        "arrival": way.arrival,
        "ends": way.ends.tolist(),
        "ports": {
            port: {"low": way.low[:, k].tolist(), "high": way.high[:, k].tolist()}
            for k, port in enumerate(way.ports)
        },
    }


def _setup(claim: LoopClaim, asked: ProveWords) -> dict[str, Any]:
    """Return connections and sensors as the command says them."""
    from fuzzyarm.loop.words import connections, sensors_of
    from fuzzyarm.plant.own import find_plant
    from fuzzyarm.requests.experiment import ExperimentRequest

    words = {name: getattr(asked, name) for name in ("connect", "quantise", "sensor_delay")}
    loop = ExperimentRequest(**words)
    setup: dict[str, Any] = {"connect": connections(loop)}
    if loop.quantise or loop.sensor_delay:
        setup["sensors"] = sensors_of(loop, find_plant(claim.plant))
    return setup


# ── claims ───────────────────────────────────────────────────────────────────────────


def loops_of(
    path: str, controller: ControllerText, asked: ProveWords, budget: float
) -> Iterator[LoopVerdict]:
    """Judge the claims in the file of a controller, and print the verdicts."""
    yield from _judged(path, controller, list(controller.model.claims), asked, budget)


def _judged(
    path: str,
    controller: ControllerText,
    claims: list[LoopClaim],
    asked: ProveWords,
    budget: float,
) -> Iterator[LoopVerdict]:
    if not claims:
        return
    from fuzzyarm.closed_loop import prove_loop

    _require_figure(asked)
    with progress() as tell:
        for claim in claims:
            verdict = prove_loop(
                controller, claim, budget=budget, continuous=asked.continuous, tell=tell,
                **_setup(claim, asked),
            )  # fmt: skip
            tell("", 0, 0.0)
            if not asked.json:
                say(*_lines(path, verdict))
            if asked.certificate is not None and verdict.proved:
                _certify(controller, verdict, asked, budget)
            if asked.plot is not None and (verdict.proved or verdict.tube is not None):
                _draw(controller, verdict, asked.plot)
                if not asked.json:
                    say(f"{asked.plot}: drawn from {path}")
            yield verdict


def _certify(
    controller: ControllerText, verdict: LoopVerdict, asked: ProveWords, budget: float
) -> None:
    """Write the certificate of what is proved; of a tube it is made first."""
    from fuzzyarm.closed_loop import (
        Certificate,
        LoopProofError,
        certify_tube,
        write_certificate,
        write_tube_certificate,
    )

    out, claim = asked.certificate or "", verdict.claim
    assert claim is not None
    if isinstance(verdict.certificate, Certificate):
        write_certificate(verdict.certificate, out)
        seal = verdict.certificate.seal
    elif verdict.tube is not None and verdict.tube.arrival:
        say(
            f"{out}: not written: a tube as far as a region has none, it is followed anew",
            to_errors=True,
        )
        return
    else:
        try:
            tube = certify_tube(
                controller, claim, budget=min(budget, 600.0), **_setup(claim, asked)
            )
        except LoopProofError as error:
            say(f"{out}: not written: {error}", to_errors=True)
            return
        write_tube_certificate(tube, out)
        seal = tube.seal
    if not asked.json:
        say(f"{out}: the certificate, {seal[:16]}")


def _require_figure(asked: ProveWords) -> None:
    if asked.plot is not None:
        from fuzzyarm.figure_files import require_figure_suffix

        require_figure_suffix(asked.plot)


def _draw_tube(way: Tube, statement: str, path: str, claim: LoopClaim | None = None) -> None:
    from fuzzyarm.figure_files import save_figure
    from fuzzyarm.show.figures.panels import chart_figure
    from fuzzyarm.show.tube import tube_chart

    save_figure(chart_figure(tube_chart(way, statement, claim)), path)


def _draw(controller: ControllerText, verdict: LoopVerdict, path: str) -> None:
    if verdict.tube is not None:
        _draw_tube(verdict.tube, str(verdict).splitlines()[0], path, verdict.claim)
        return
    from fuzzyarm.figure_files import save_figure
    from fuzzyarm.show.figures.panels import chart_figure
    from fuzzyarm.show.region import region_chart

    save_figure(chart_figure(region_chart(controller, verdict)), path)


def check(asked: ProveWords) -> int:
    """Do what ``--check`` says."""
    path = asked.check or ""
    from fuzzyarm.closed_loop import CertificateError, check_certificate

    controller = None
    if asked.files:
        controller = controller_if_any(asked.files[0])
        if controller is None:
            raise WordError(f"{asked.files[0]} is not a controller")
    try:
        verdict = check_certificate(path, controller)
    except CertificateError as error:
        raise WordError(str(error)) from error
    if asked.json:
        print_json(loop_data(verdict), 2)
    else:
        say(*_lines(path, verdict))
    return _exit_status(verdict)


def _exit_status(verdict: LoopVerdict) -> int:
    if verdict.verdict == "refuted":
        return EXIT_REFUTED
    return 0 if verdict.proved else EXIT_UNDECIDED


def _lines(path: str, verdict: LoopVerdict) -> list[str]:
    head, *rest = str(verdict).splitlines()
    where = f"{path}:{verdict.line}" if verdict.line else path
    count = verdict.pieces
    tries = f"{count} attempt{'s' * (count != 1)}, " if count else ""
    return [f"{where}: {head}", *rest, f"  {tries}{verdict.seconds:.2f} s"]


def loop_data(verdict: LoopVerdict) -> dict[str, Any]:
    """Return a verdict on a loop as JSON has it."""
    certificate = verdict.certificate
    return {
        "property": verdict.statement,
        "verdict": verdict.verdict,
        "region": {name: list(ends) for name, ends in verdict.region.items()},
        "start_region": dict(verdict.start_region),
        "rest": dict(verdict.rest),
        "fall": verdict.fall,
        "continuous": verdict.continuous,
        "uncertain": list(verdict.uncertain),
        "certificate": None if certificate is None else certificate.seal,
        "tube": tube_data(verdict.tube),
        "evidence": list(verdict.evidence),
        "pieces": verdict.pieces,
        "seconds": round(verdict.seconds, 6),
        "reason": verdict.reason,
        "line": verdict.line,
    }
