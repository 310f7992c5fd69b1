"""Margins of the loop that is open: what ``fuzzyarm margins`` says, with its diagrams."""

from __future__ import annotations

from pathlib import Path

from fuzzyarm.apps.designer.exports import model_of
from fuzzyarm.apps.designer.faults import TextRefusedError
from fuzzyarm.apps.designer.forms import MARGINS
from fuzzyarm.apps.designer.grounds import at_field, plants_for
from fuzzyarm.apps.designer.jobs import WindowJob
from fuzzyarm.apps.designer.requests import BareMessage, FormWork
from fuzzyarm.apps.designer.results import tell_result
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.control.controllers.text import ControllerText


def opened(session: Session, request: BareMessage, job: WindowJob) -> None:
    """Tell what the form is, and which plants there are."""
    plants = plants_for(_text(session).model, job.plants)
    job.tell({"plants": plants, "form": MARGINS.fields()})


def _text(session: Session) -> ControllerText:
    text = model_of(session)
    if not isinstance(text, ControllerText):
        raise TextRefusedError("only the loop of a controller has margins")
    return text


def margins(session: Session, record: FormWork, job: WindowJob) -> None:
    """Linearise the loop, and tell its margins at each drive."""
    from fuzzyarm.apps.show.margins import margin_lines, margins_chart
    from fuzzyarm.proof.loop.orders import margins_of_text

    text, path = _text(session), Path(session.path)
    request = MARGINS.request(record.form, path.parent, file=path.name)
    with at_field("plant"):
        found = margins_of_text(text, request)
    job.check()
    for each in found:
        verdict = "stable" if each.nominal.stable else "unstable"
        tell_result(job, margin_lines(each), [margins_chart([each], path.name)], verdict=verdict)
