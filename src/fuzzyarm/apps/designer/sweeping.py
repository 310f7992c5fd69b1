"""Many runs of the open text: the report of ``fuzzyarm sweep``, with its map."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.designer.faults import TextRefusedError
from fuzzyarm.apps.designer.forms import SWEEP
from fuzzyarm.apps.designer.grounds import FieldError, at_field, plant_named, plants_for, request_on
from fuzzyarm.apps.designer.jobs import StoppedError, WindowJob, tell_result
from fuzzyarm.apps.designer.requests import BareMessage, FormWork, SweepWord
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.base.names import printable
from fuzzyarm.requests.runs import SweepRequest

if TYPE_CHECKING:
    from fuzzyarm.base.picture import Chart
    from fuzzyarm.control.controllers.controller import CompiledController, Controller
    from fuzzyarm.control.loop.many import Many
    from fuzzyarm.control.loop.sweeps import Sweep
    from fuzzyarm.language.model.controller import ControllerModel

MOST_RUNS = 20_000
"""A page is not left to itself for hours."""


def sweepable(session: Session, request: BareMessage, job: WindowJob) -> None:
    """Send the form, the suitable plants, and the names of the gains."""
    controller, model = _controller(session)
    job.tell({
        "plants": plants_for(model, job.plants),
        "gains": list(controller.gains),
        "form": SWEEP.fields(),
    })  # fmt: skip


def _controller(session: Session) -> tuple[CompiledController, ControllerModel]:
    """Return the controller of a text; of a rule base the one that evaluates it directly."""
    from fuzzyarm.apps.designer.run import controller_of, is_rule_base, source_of
    from fuzzyarm.control.controllers.code import SourceError

    if session.path.lower().endswith(".lut"):
        raise TextRefusedError("a table does not run by itself; open a controller")
    try:
        controller = controller_of(session.text, session.path)
    except SourceError:
        if not is_rule_base(session.text, session.path):
            raise
        name = printable(Path(session.path).name)
        raise TextRefusedError(
            f"{name} is a rule base, not a controller", hint="the view Run makes one around it"
        ) from None
    return controller, source_of(controller).model


def sweep(session: Session, record: FormWork, job: WindowJob) -> None:
    """Run, and send the result."""
    from fuzzyarm.apps.show.sweep import sweep_lines
    from fuzzyarm.control.loop.sweeps import answered

    request, plan = _plan(session, record, job)

    def moved(done: int) -> None:
        if any(word.enough for word in job.heard(SweepWord)):
            raise KeyboardInterrupt  # as a hand ends the command, with the runs before
        job.paced_progress(f"{done:,} of {plan.count:,} runs")

    with tempfile.TemporaryDirectory() as folder:
        file = plan.file(str(Path(folder) / f"{Path(session.path).stem}-sweep.csv"))
        answer = answered(plan, file, request, None, moved)
        job.check()  # stopping it is not a fault of a run
        if not len(answer.rows):
            raise StoppedError("stopped")
        results = plan.results(answer.rows)
        charts = _charts(plan, request, results) if results else []
        lines = [*(sweep_lines(results, request.metric) if results else []), *answer.faults]
        if answer.interrupted:
            lines.append(f"stopped after {len(answer.rows):,} of {plan.count:,} runs")
        tell_result(job, lines, charts, files={file.path.name: file.path.read_bytes()})
        if answer.interrupted:
            raise StoppedError("stopped")


def _plan(session: Session, record: FormWork, job: WindowJob) -> tuple[SweepRequest, Sweep]:
    """Return the request and its runs; a mistake is said at its field."""
    from fuzzyarm.control.controllers.own import name_apart
    from fuzzyarm.control.loop.sweeps import sweep_of

    controller, model = _controller(session)
    path = Path(session.path)
    request = SWEEP.request(record.form, path.parent, controller=path.name)
    with at_field("against"):
        others = [_other(name, job) for name in request.against]
        name_apart([request.controller, *request.against], [controller, *others])
    with at_field("plant"):
        plant = plant_named(request.plant or "", model, job.plants)
        request = request.replaced(plant=request.plant or plants_for(model, job.plants)[0]["name"])
    request = request_on(plant, request)
    with at_field("sweep"):
        plan = sweep_of(request, [controller, *others])
    if plan.count > MOST_RUNS:
        words = f"{plan.count:,} runs are out of range here: up to {MOST_RUNS:,}"
        raise FieldError(words, field="sweep", hint="fuzzyarm sweep takes more")
    if request.map:
        _axes(plan, request)
    return request, plan


def _other(name: str, job: WindowJob) -> Controller:
    """Return a controller of the catalogue or of a file of the folder; no Python is executed."""
    from fuzzyarm.control.controllers.catalogue import CATALOGUE
    from fuzzyarm.control.controllers.own import find_controller

    if name in CATALOGUE:
        return find_controller(name)
    return _controller(job.folder.session(name))[0]


def _axes(plan: Sweep, request: SweepRequest) -> Any:
    """Return the ranges over which a map is drawn; of more than two the first, if none are said."""
    from fuzzyarm.control.loop.sweeps import map_axes

    if len(plan.ranges) > 2 and not request.map:
        request = request.replaced(map=",".join(axis.name for axis in plan.ranges[:2]))
    with at_field("map"):
        return map_axes(request, plan)


def _charts(plan: Sweep, request: SweepRequest, results: list[Many]) -> list[Chart]:
    """Return the picture of runs on a grid; None for runs with random values."""
    from fuzzyarm.apps.show.sweep import sweep_chart

    if request.random is not None:
        return []
    return [sweep_chart(results, _axes(plan, request), request.metric)]
