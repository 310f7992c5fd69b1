"""Controllers in their loops: what ``fuzzyarm prove`` says of claims and of certificates."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.command import WordError, load_controller, print_json, say
from fuzzyarm.cli.prove_sectors import EXIT_UNDECIDED, progress

if TYPE_CHECKING:
    from fuzzyarm.closed_loop import LoopVerdict
    from fuzzyarm.controller.text import ControllerText
    from fuzzyarm.model.claims import LoopClaim

EXIT_REFUTED = 1

_WITH_STABLE = ("from", "at")


def wants_loop(arguments: argparse.Namespace) -> bool:
    """Tell whether a claim about a loop stands in the command."""
    wanted = arguments.stable or arguments.claim is not None
    for word in _WITH_STABLE:
        if getattr(arguments, word) is not None and not arguments.stable:
            raise WordError(f"--{word} goes with --stable")
    return bool(wanted)


def prove_loops(arguments: argparse.Namespace, budget: float) -> int:
    """Do what ``--stable`` or ``--claim`` says."""
    if len(arguments.files) > 1:
        raise WordError("--stable and --claim take one file")
    path = arguments.files[0]
    controller = load_controller(path)
    if controller is None:
        raise WordError(f"{path} is not a controller: --stable and --claim are about loops")
    (verdict,) = _judged(path, controller, [_claim_of(arguments)], arguments, budget)
    if arguments.json:
        print_json(loop_data(verdict), 2)
    return _exit_status(verdict)


def _claim_of(arguments: argparse.Namespace) -> LoopClaim:
    from fuzzyarm.closed_loop import read_claim

    plant = arguments.plant or ""
    if arguments.claim is not None:
        return read_claim(arguments.claim, plant)
    if not plant:
        raise WordError("--stable needs a plant", hint="--plant motor")
    text = "stable"
    if arguments.at is not None:
        text += " at " + arguments.at.replace("=", " = ").replace(",", ", ")
    if vars(arguments)["from"] is not None:
        text += f" from {vars(arguments)['from']}"
    return read_claim(text, plant)


def loops_of(
    path: str, controller: ControllerText, arguments: argparse.Namespace, budget: float
) -> Iterator[LoopVerdict]:
    """Judge the claims in the file of a controller, and print the verdicts."""
    yield from _judged(path, controller, list(controller.model.claims), arguments, budget)


def _judged(
    path: str,
    controller: ControllerText,
    claims: list[LoopClaim],
    arguments: argparse.Namespace,
    budget: float,
) -> Iterator[LoopVerdict]:
    if not claims:
        return
    from fuzzyarm.closed_loop import prove_loop, write_certificate

    if arguments.plot is not None:
        from fuzzyarm.show.figures.style import require_figure_suffix

        require_figure_suffix(arguments.plot)
    with progress() as tell:
        for claim in claims:
            verdict = prove_loop(
                controller, claim, budget=budget, continuous=arguments.continuous, tell=tell
            )
            tell("", 0, 0.0)
            if not arguments.json:
                say(*_lines(path, verdict))
            if arguments.certificate is not None and verdict.certificate is not None:
                write_certificate(verdict.certificate, arguments.certificate)
                if not arguments.json:
                    say(
                        f"{arguments.certificate}: the certificate, {verdict.certificate.seal[:16]}"
                    )
            if arguments.plot is not None and verdict.proved:
                _draw(controller, verdict, arguments.plot)
                if not arguments.json:
                    say(f"{arguments.plot}: drawn from {path}")
            yield verdict


def _draw(controller: ControllerText, verdict: LoopVerdict, path: str) -> None:
    from fuzzyarm.show.figures.loop_region import region_figure
    from fuzzyarm.show.figures.style import save_figure

    save_figure(region_figure(controller, verdict), path)


def check(arguments: argparse.Namespace) -> int:
    """Do what ``--check`` says."""
    from fuzzyarm.closed_loop import CertificateError, check_certificate

    controller = None
    if arguments.files:
        controller = load_controller(arguments.files[0])
        if controller is None:
            raise WordError(f"{arguments.files[0]} is not a controller")
    try:
        verdict = check_certificate(arguments.check, controller)
    except CertificateError as error:
        raise WordError(str(error)) from error
    if arguments.json:
        print_json(loop_data(verdict), 2)
    else:
        say(*_lines(arguments.check, verdict))
    return _exit_status(verdict)


def _exit_status(verdict: LoopVerdict) -> int:
    if verdict.verdict == "refuted":
        return EXIT_REFUTED
    return 0 if verdict.proved else EXIT_UNDECIDED


def _lines(path: str, verdict: LoopVerdict) -> list[str]:
    head, *rest = str(verdict).splitlines()
    where = f"{path}:{verdict.line}" if verdict.line else path
    tries = f"{verdict.pieces} attempts, " if verdict.pieces else ""
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
        "evidence": list(verdict.evidence),
        "pieces": verdict.pieces,
        "seconds": round(verdict.seconds, 6),
        "reason": verdict.reason,
        "line": verdict.line,
    }
