"""Prove or refute every `prove` line of rule bases, or bound one number.

A verdict is *proved* (for every point, real numbers included), *refuted*
(with a counterexample of one or two points, ready to paste as `expect`) or *undecided*
(with the bounds reached and the reason). Exit status 0 if all is proved, 1 if
anything is refuted, 4 if anything stays undecided.

--range, --slope and --table bound one number of an output instead: its value, its slope
along each input, or the error of a lookup table against the rules (linear, nearest or bins
of the table by `compile`, or a file).

--sector bounds an output by multiples of its inputs, for the circle criterion: along each input,
and along a linear law of them. For a controller it proves the same of each drive, with
its range, limits and linear gains; --plot draws it.

--claim proves a controller in its loop, in the words of a `prove` line; --stable with --plant is
short for `stable on PLANT`. --certificate writes the proof; --check verifies such a file without
searching. --for bounds all ports of the plant for a time, from all starts of --from; with --claim
it is the end time of the claim. --plot draws the region or the tube, with runs in it.

--map sorts a whole window of starts (--over) into proved to come to rest, refuted and open;
--resume keeps a journal, --workers shares the work. With --certificate only boxes that the checker
follows count as proved, and --check follows them again.

  fuzzyarm prove rulebases/pd7.frb --table linear
  fuzzyarm prove rulebases/servo.frb --sector --plot sector.png
  fuzzyarm prove rulebases/servo.frb --plant motor --stable --certificate servo.json
  fuzzyarm prove --check servo.json
  fuzzyarm prove rulebases/servo.frb --plant motor --at position=1 --for 0.5s --plot tube.png
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.cli.arguments import request_command
from fuzzyarm.apps.cli.command import (
    FORCE,
    UsageError,
    WordError,
    demand_figure,
    demand_places,
    print_json,
    say,
)
from fuzzyarm.apps.cli.prove_sectors import (
    EXIT_REFUTED,
    EXIT_UNDECIDED,
    ProveWords,
    exit_status,
    print_drives,
    print_sectors,
    progress,
    status_of_drives,
)
from fuzzyarm.base.jsonable import jsonable
from fuzzyarm.exchange.files import controller_if_any

if TYPE_CHECKING:
    from fuzzyarm.control.controllers.text import ControllerText
    from fuzzyarm.language.model.claims import LoopClaim
    from fuzzyarm.proof.loop import LoopVerdict, StartMap, Tube
    from fuzzyarm.proof.map import Bounds, Verdict


def prove_loops(request: ProveWords) -> int:
    """Carry out ``--stable``, ``--map``, ``--claim`` or ``--for``."""
    from fuzzyarm.proof.loop.orders import claim_of, loop_of

    path = request.files[0]
    controller = loop_of(request, controller_if_any(path))
    if request.map:
        return _map(request, path, controller)
    if not request.stable and request.claim is None:
        return _bound(request, path, controller)
    ((verdict, status),) = print_loops(request, path, controller, [claim_of(request)])
    if request.json:
        print_json(verdict, 2)
    return status


# ── a map ────────────────────────────────────────────────────────────────────────────


def _map(request: ProveWords, path: str, controller: ControllerText) -> int:
    """Map the starts of a loop, with a drawing that fills."""
    from fuzzyarm.proof.loop.orders import map_of

    out = request.certificate
    with _filling(request) as watch:
        found = map_of(request, controller, watch, certify=out is not None)
    if request.json:
        print_json(found, 2)
    else:
        count = f"{len(found.boxes):,} box{'es' * (len(found.boxes) != 1)}"
        say(*f"{path}: {found}\n  {count}, {found.seconds:.1f} s".splitlines())
    if out is not None:
        from fuzzyarm.proof.check.certificate import write_certificate

        if why := found.uncertified:
            say(f"{out}: not written: {why}", to_errors=True)
        else:
            assert found.certificate is not None
            seal = write_certificate(found.certificate, out)
            if not request.json:
                say(f"{out}: the certificate, {seal[:16]}")
    if request.plot is not None:
        from fuzzyarm.apps.show.figures.panels import chart_figure
        from fuzzyarm.apps.show.start_map import map_chart
        from fuzzyarm.base.figure_files import save_figure

        save_figure(chart_figure(map_chart(found)), request.plot)
        if not request.json:
            say(f"{request.plot}: drawn from {path}")
    missing = EXIT_UNDECIDED if out is not None and found.certificate is None else 0
    return exit_status(found.verdict) or missing


@contextmanager
def _filling(request: ProveWords) -> Iterator[Callable[[StartMap], None]]:
    """Draw a map in the terminal as it fills; wipe it at the end, before the result is printed."""
    if not sys.stderr.isatty() or request.json:
        yield lambda _: None
        return
    from rich.console import Console, Group
    from rich.live import Live
    from rich.text import Text

    from fuzzyarm.apps.show.panels import panel_view
    from fuzzyarm.apps.show.start_map import map_panel

    console = Console(stderr=True)
    with Live(console=console, transient=True, auto_refresh=False) as live:

        def watch(found: StartMap) -> None:
            wide, high = min(console.width - 14, 72), max(6, min(console.height - 8, 20))
            view = panel_view(map_panel(found, wide, 2 * high), wide, high)
            live.update(Group(Text(found.sentence()), view), refresh=True)

        yield watch


# ── a tube ───────────────────────────────────────────────────────────────────────────


def _bound(request: ProveWords, path: str, controller: ControllerText) -> int:
    """Bound all ports of the plant for a time; report the open ones."""
    from fuzzyarm.proof.loop.orders import tube_of

    if request.certificate is not None:
        raise UsageError("--certificate goes with a claim about a loop", hint="--claim, --stable")
    with progress() as tell:
        way, left_open, statement = tube_of(request, controller, tell)
        tell("", 0, 0.0)
    if request.json:
        data = {"property": statement, "complete": way.complete, "open": list(left_open)}
        tube = way if way.complete else None
        print_json({**data, "tube": tube, "seconds": way.seconds}, 2)
    else:
        lines = [*(way.lines() if way.complete else ()), *left_open]
        lines.append(f"{way.boxes} box{'es' * (way.boxes != 1)}, {way.seconds:.2f} s")
        say(f"{path}: {statement}", *(f"  {line}" for line in lines))
    if request.plot is not None and way.complete:
        _draw_tube(way, statement, request.plot)
        if not request.json:
            say(f"{request.plot}: drawn from {path}")
    return 0 if way.complete and not way.open else EXIT_UNDECIDED


# ── claims ───────────────────────────────────────────────────────────────────────────


def print_loops(
    request: ProveWords, path: str, controller: ControllerText, claims: Sequence[LoopClaim]
) -> Iterator[tuple[LoopVerdict, int]]:
    """Judge claims about a controller's loop and print the verdicts; yield them with a status."""
    if not claims:
        return
    for option, out in (("--certificate", request.certificate), ("--plot", request.plot)):
        if out is not None and len(claims) > 1:
            from fuzzyarm.proof.claim.text import claim_text

            raise UsageError(
                f"{option} takes one claim, and {path} has {len(claims)}",
                hint=f'--claim "{claim_text(claims[0])}"',
            )
    from fuzzyarm.proof.loop.orders import loops_of

    with progress() as tell:
        for verdict in loops_of(request, controller, tuple(claims), tell):
            # Wipe the line of progress before printing.
            tell("", 0, 0.0)
            if not request.json:
                say(*_loop_lines(path, verdict))
            status = exit_status(verdict.verdict)
            if request.certificate is not None and verdict.proved:
                status = _certify(controller, verdict, request, tell)
            if request.plot is not None and (verdict.proved or verdict.tube is not None):
                _draw(controller, verdict, request.plot)
                if not request.json:
                    say(f"{request.plot}: drawn from {path}")
            yield verdict, status


def _certify(
    controller: ControllerText,
    verdict: LoopVerdict,
    request: ProveWords,
    tell: Callable[[str, int, float], None],
) -> int:
    """Write the certificate of a proof; return the exit status."""
    from fuzzyarm.proof.check.certificate import write_certificate
    from fuzzyarm.proof.loop import LoopProofError
    from fuzzyarm.proof.loop.orders import certificate_of

    out = request.certificate or ""
    try:
        found = certificate_of(request, controller, verdict, tell)
    except LoopProofError as error:
        tell("", 0, 0.0)
        say(f"{out}: not written: {error}", to_errors=True)
        return EXIT_UNDECIDED
    tell("", 0, 0.0)
    seal = write_certificate(found, out)
    if not request.json:
        say(f"{out}: the certificate, {seal[:16]}")
    return 0


def _draw_tube(way: Tube, statement: str, path: str, claim: LoopClaim | None = None) -> None:
    from fuzzyarm.apps.show.figures.panels import chart_figure
    from fuzzyarm.apps.show.tube import tube_chart
    from fuzzyarm.base.figure_files import save_figure

    save_figure(chart_figure(tube_chart(way, statement, claim)), path)


def _draw(controller: ControllerText, verdict: LoopVerdict, path: str) -> None:
    if verdict.tube is not None:
        _draw_tube(verdict.tube, str(verdict).splitlines()[0], path, verdict.claim)
        return
    from fuzzyarm.apps.show.figures.panels import chart_figure
    from fuzzyarm.apps.show.region import region_chart
    from fuzzyarm.base.figure_files import save_figure

    save_figure(chart_figure(region_chart(controller, verdict)), path)


def check(request: ProveWords) -> int:
    """Carry out ``--check``."""
    path = request.check or ""
    from fuzzyarm.proof.check import CertificateError
    from fuzzyarm.proof.check.checking import check_of

    controller = None
    if request.files:
        controller = controller_if_any(request.files[0])
        if controller is None:
            raise WordError(f"{request.files[0]} is not a controller")
    try:
        checked = check_of(request, controller)
    except CertificateError as error:
        raise WordError(str(error)) from error
    if request.json:
        print_json(jsonable(checked) | {"tube": None, "pieces": 0, "line": 0}, 2)
    else:
        say(*f"{path}: {checked}\n  {checked.seconds:.2f} s".splitlines())
    return exit_status(checked.verdict)


def _loop_lines(path: str, verdict: LoopVerdict) -> list[str]:
    count = verdict.pieces
    return _lines(path, verdict, f"{count} attempt{'s' * (count != 1)}, " if count else "")


def _lines(path: str, verdict: Verdict | LoopVerdict, work: str, way: str = "") -> list[str]:
    head, *rest = str(verdict).splitlines()
    where = f"{path}:{verdict.line}" if verdict.line else path
    return [f"{where}: {head}", *rest, f"  {work}{verdict.seconds:.2f} s{way}"]


def _run(request: ProveWords) -> int:
    if request.check is not None:  # the search is not even loaded
        return check(request)
    from fuzzyarm.proof.loop.orders import bounds_one, require_sensible, wants_loop

    require_sensible(request)
    demand_figure(request.plot)
    demand_places(request.certificate)
    if request.sector:
        if request.certificate is not None:
            raise UsageError("--certificate goes with a claim about a loop")
        return print_sectors(request)
    if wants_loop(request):
        return prove_loops(request)
    if bounds_one(request):
        _require_use(request, of=False)
        return _single(request)
    return _files(request)


def _require_use(request: ProveWords, *, of: bool) -> None:
    """Refuse options about loops if no loop is judged (`of`)."""
    if request.plot is not None and not of:
        raise UsageError("--plot goes with --sector, or with a claim about a loop")
    if request.certificate is not None and not of:
        raise UsageError("--certificate goes with a claim about a loop")


# ── the lines of files ───────────────────────────────────────────────────────────────


def _files(request: ProveWords) -> int:
    from fuzzyarm.exchange.files import load_rules
    from fuzzyarm.proof.loop.orders import rules_of

    statuses: set[int] = set()
    data: list[dict[str, Any]] = []
    for path in request.files:
        controller = controller_if_any(path)
        claims = controller.claims if controller else ()
        _require_use(request, of=bool(claims))
        rulebases = controller.model.rulebases if controller else (load_rules(path, "prove"),)
        if controller is None and not rulebases[0].properties and not request.json:
            say(f"{path}: no `prove` lines", to_errors=True)
        file = {"file": path} if len(request.files) > 1 else {}
        with progress() as tell:
            for verdict in rules_of(request, rulebases, tell):
                statuses.add(exit_status(verdict.verdict))
                data.append(file | jsonable(verdict))
                if not request.json:
                    tell("", 0, 0.0)
                    say(*_rule_lines(path, verdict))
        if controller is not None:
            for loop, status in print_loops(request, path, controller, claims):
                statuses.add(status)
                data.append(file | jsonable(loop))
            drives = print_drives(request, path, controller)
            statuses.add(status_of_drives(drives))
            data += [file | jsonable(drive) for drive in drives]
    if request.json:
        print_json(data, 2)
    return next((status for status in (EXIT_REFUTED, EXIT_UNDECIDED) if status in statuses), 0)


def _rule_lines(path: str, verdict: Verdict) -> list[str]:
    from fuzzyarm.apps.show.proofs import WAYS

    work = f"{verdict.pieces:,} pieces, " if verdict.pieces else ""
    return _lines(path, verdict, work, f", {WAYS[verdict.way]}" if verdict.way else "")


# ── one number ───────────────────────────────────────────────────────────────────────


def _single(request: ProveWords) -> int:
    from fuzzyarm.apps.show.proofs import bound_lines
    from fuzzyarm.exchange.files import load_rules
    from fuzzyarm.proof.loop.orders import bounds_of, only_output

    rulebase = load_rules(request.files[0], "prove")
    name = only_output(rulebase, request.output)
    with progress() as tell:
        results = bounds_of(request, rulebase, tell)
    if request.json:
        _print_single(results)
    else:
        for key, bounds in results.items():
            say(*bound_lines(name, key, bounds))
    proved = all(bounds.complete and not bounds.hole for bounds in results.values())
    return 0 if proved else EXIT_UNDECIDED


def _print_single(bounds_by_key: dict[str, Bounds]) -> None:
    from fuzzyarm.proof.map.bounds import TABLE_ERROR

    data: dict[str, Any] = {**bounds_by_key}
    if worst := data.pop("worst", None):
        print_json(jsonable(worst, TABLE_ERROR), 2)
    elif "range" in data:
        print_json(data["range"], 2)
    else:
        low = min(bounds.low for bounds in data.values())
        high = max(bounds.high for bounds in data.values())
        print_json({"low": low, "high": high, "inputs": data}, 2)


COMMANDS = (request_command("prove", __doc__, _run, ProveWords, FORCE),)
