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

from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.cli.arguments import request_command
from fuzzyarm.apps.cli.command import (
    FORCE,
    UsageError,
    demand_figure,
    demand_places,
    print_json,
    say,
)
from fuzzyarm.apps.cli.prove_loops import check, print_loops, prove_loops
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
    from fuzzyarm.proof.map import Bounds, Verdict


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
                    say(*_lines(path, verdict))
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


def _lines(path: str, verdict: Verdict) -> list[str]:
    from fuzzyarm.apps.show.proofs import WAYS

    head, *rest = str(verdict).splitlines()
    where = f"{path}:{verdict.line}" if verdict.line else path
    work = f"{verdict.pieces:,} pieces, " if verdict.pieces else ""
    way = f", {WAYS[verdict.way]}" if verdict.way else ""
    return [f"{where}: {head}", *rest, f"  {work}{verdict.seconds:.2f} s{way}"]


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
