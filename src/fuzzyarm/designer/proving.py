"""Proving from a page: what ``fuzzyarm prove`` says of the text that is open, with pictures.

Without a choice the `prove` lines of the text are judged; of a rule base one may have the range of
an output or its slopes bounded, of a controller a claim about its loop, as a line would say it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.designer.exports import model_of
from fuzzyarm.designer.faults import TextRefusedError
from fuzzyarm.designer.forms import PROVE, PROVE_LOOP, RequestForm
from fuzzyarm.designer.grounds import FieldError, at_field
from fuzzyarm.designer.jobs import WindowJob
from fuzzyarm.designer.requests import BareMessage, ProveWork
from fuzzyarm.language.queries import Reading
from fuzzyarm.lsp.session import Session
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.picture import Chart, chart_data
from fuzzyarm.requests.prove import ProveRequest

if TYPE_CHECKING:
    from fuzzyarm.closed_loop import LoopVerdict
    from fuzzyarm.controller.text import ControllerText
    from fuzzyarm.proof import Bounds, Verdict

BUDGET = 60.0
"""Seconds for each statement, where the form says none: a page is not left to itself for hours."""


def provable(session: Session, asked: BareMessage, job: WindowJob) -> None:
    """Tell what the form is, and which lines and outputs the text has."""
    _refuse_table(session)
    controller, rulebase = session.reading.parsed.controller, session.reading.parsed.rulebase
    outputs: list[str] = []
    if controller is not None:
        lines = len(controller.claims)
    elif rulebase is not None:
        lines, outputs = len(rulebase.properties), [output.name for output in rulebase.outputs]
    else:
        raise TextRefusedError("the text has mistakes: first mend what stands below it")
    is_loop = controller is not None
    job.tell({
        "loop": is_loop,
        "lines": lines,
        "outputs": outputs,
        "plants": list(job.plants.known) if is_loop else [],
        "form": _form(is_loop=is_loop).fields(budget=BUDGET),
    })  # fmt: skip


def _refuse_table(session: Session) -> None:
    if not isinstance(session.reading, Reading):
        raise TextRefusedError("a table proves nothing by itself; its error is in the view Table")


def _form(*, is_loop: bool) -> RequestForm[ProveRequest]:
    return PROVE_LOOP if is_loop else PROVE


def prove(session: Session, asked: ProveWork, job: WindowJob) -> None:
    """Judge what is asked for; each verdict is told when it is there."""
    _refuse_table(session)
    model = model_of(session)
    form = _form(is_loop=not isinstance(model, RuleBase))
    request = form.request({"budget": BUDGET, **asked.form}, Path(session.path).parent)
    if isinstance(model, RuleBase):
        _prove_rules(model, request, job)
    else:
        _prove_loop(model, request, job)


def _tell_line(
    job: WindowJob, verdict: str, lines: list[str], charts: list[Chart] | None = None
) -> None:
    """Tell a verdict, in words and as pictures."""
    panels = [panel for chart in charts or [] for panel in chart_data(chart)]
    job.tell({"verdict": verdict, "lines": lines, "panels": panels})


def _told(job: WindowJob) -> Any:
    """Return what a proof calls now and then: the page hears of it, and may stop it."""

    def tell(statement: str, count: int, gap: float) -> None:
        words = "" if math.isnan(gap) else f", {gap:.3g} to go"
        job.progress(f"{statement}: {count:,} pieces{words}")

    return tell


# --- Rule bases ---


def _prove_rules(rulebase: RuleBase, asked: ProveRequest, job: WindowJob) -> None:
    from fuzzyarm.closed_loop.orders import bounds_one, rules_of

    if bounds_one(asked):
        for what, bounds in _bounded(rulebase, asked, job):
            verdict = "proved" if bounds.complete else "undecided"
            _tell_line(job, verdict, [_bound_line(what, bounds)])
        return
    if not rulebase.properties:
        raise TextRefusedError(
            "the text has no `prove` lines", hint="write one, or have a range or slopes bounded"
        )
    for judged in rules_of(asked, (rulebase,), _told(job)):
        _tell_line(job, judged.verdict, _verdict_lines(judged))


def _bounded(
    rulebase: RuleBase, asked: ProveRequest, job: WindowJob
) -> Iterator[tuple[str, Bounds]]:
    """Yield what is bounded of an output: its range, or its slope along each input."""
    from fuzzyarm.closed_loop.orders import only_output, prover_of

    with at_field("output"):
        name = only_output(rulebase, asked.output or rulebase.outputs[0].name)
    prover = prover_of(asked, rulebase, name, _told(job))
    if asked.range:
        yield name, prover.value({})
    if asked.slope:
        for each in prover.names:
            yield f"slope of {name} along {each}", prover.slope({}, each)


def _bound_line(what: str, bounds: Bounds) -> str:
    from fuzzyarm.proof.verdicts import bound_text

    return f"{what} in {bound_text((bounds.low, bounds.high))}"


def _verdict_lines(verdict: Verdict | LoopVerdict) -> list[str]:
    where = f"line {verdict.line}: " if verdict.line else ""
    head, *rest = str(verdict).splitlines()
    return [f"{where}{head}", *rest, f"  {verdict.seconds:.2f} s"]


# --- Controllers in their loops ---


def _prove_loop(text: ControllerText, asked: ProveRequest, job: WindowJob) -> None:
    from fuzzyarm.closed_loop import prove_loop
    from fuzzyarm.closed_loop.orders import budget_of, claim_of

    claims = list(text.model.claims)
    if asked.claim is not None or asked.stable:
        with at_field("claim"):
            claims = [claim_of(asked, dashes="")]
    if not claims:
        raise TextRefusedError(
            "the text has no `prove` lines", hint="write one, or a claim such as stable"
        )
    for claim in claims:
        if claim.plant not in job.plants.known:
            raise FieldError(f"there is no plant '{claim.plant}' here", field="plant")
        plant = job.plants.new(claim.plant)
        verdict = prove_loop(
            text, claim, plant=plant, budget=budget_of(asked),
            continuous=asked.continuous, tell=_told(job),
        )  # fmt: skip
        _tell_line(job, verdict.verdict, _verdict_lines(verdict), _charts(text, verdict, plant))


def _charts(text: ControllerText, verdict: LoopVerdict, plant: Any) -> list[Chart]:
    """Return the pictures of a verdict: its tube, or the region that is never left."""
    from fuzzyarm.show.region import region_chart
    from fuzzyarm.show.tube import tube_chart

    if verdict.tube is not None:
        return [tube_chart(verdict.tube, str(verdict).splitlines()[0], verdict.claim)]
    return [region_chart(text, verdict, plant)] if verdict.proved else []
