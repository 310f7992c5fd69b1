"""Proofs in the page: the verdicts of ``fuzzyarm prove`` on the open text, with pictures.

Without a choice the `prove` lines of the text are judged. Choices for a rule base: bounds of an
output, its slopes, its sectors, or the error of a table; for a controller: a claim about its loop,
as in a line, all runs for a time, or the sectors of its drives.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.designer.exports import model_of
from fuzzyarm.apps.designer.faults import TextRefusedError
from fuzzyarm.apps.designer.forms import MARGINS, PROVE, PROVE_LOOP, RequestForm
from fuzzyarm.apps.designer.grounds import FieldError, at_field, plants_for
from fuzzyarm.apps.designer.jobs import WindowJob, tell_result
from fuzzyarm.apps.designer.requests import BareMessage, FormWork, ProveWork
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.numbers import percent
from fuzzyarm.base.picture import Chart
from fuzzyarm.language.edit import Reading
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.language.statements import TABLE_MODES
from fuzzyarm.requests.prove import ProveRequest

if TYPE_CHECKING:
    from fuzzyarm.control.controllers.text import ControllerText
    from fuzzyarm.language.model.claims import LoopClaim
    from fuzzyarm.proof.check.certificate import Certificate
    from fuzzyarm.proof.loop import LoopVerdict, StartMap
    from fuzzyarm.proof.map import Verdict

BUDGET = 60.0
"""Default seconds for each statement: a page is not left to itself for hours."""


def provable(session: Session, request: BareMessage, job: WindowJob) -> None:
    """Send the form, and the claims and outputs of the text."""
    _refuse_table(session)
    controller, rulebase = session.reading.parsed.controller, session.reading.parsed.rulebase
    outputs: list[str] = []
    if controller is not None:
        lines = len(controller.claim_lines)
    elif rulebase is not None:
        lines, outputs = len(rulebase.properties), [output.name for output in rulebase.outputs]
    else:
        raise TextRefusedError("the text has mistakes: first mend the findings below it")
    is_loop = controller is not None
    job.tell({
        "loop": is_loop,
        "lines": lines,
        "outputs": outputs,
        "plants": list(job.plants.by_name) if is_loop else [],
        "tables": [] if is_loop else [*TABLE_MODES, *job.folder.listed(".lut")],
        "form": _form(is_loop=is_loop).fields(budget=BUDGET),
    })  # fmt: skip


def _refuse_table(session: Session) -> None:
    if not isinstance(session.reading, Reading):
        raise TextRefusedError("a table proves nothing by itself; its error is in the view Table")


def _form(*, is_loop: bool) -> RequestForm[ProveRequest]:
    return PROVE_LOOP if is_loop else PROVE


def prove(session: Session, record: ProveWork, job: WindowJob) -> None:
    """Judge the claims; each verdict is sent as soon as known."""
    from fuzzyarm.proof.loop.orders import require_sensible

    _refuse_table(session)
    model = model_of(session)
    path = Path(session.path)
    form = _form(is_loop=not isinstance(model, RuleBase))
    request = form.request({"budget": BUDGET, **record.form}, path.parent, files=(path.name,))
    require_sensible(request)
    if isinstance(model, RuleBase):
        _prove_rules(model, request, job)
    else:
        _LoopProof(model, request, job, wants_certificate=record.certificate).run()


def _progress(job: WindowJob) -> Any:
    """Return the progress callback of a proof, by which the page may stop it."""

    def tell(statement: str, count: int, gap: float) -> None:
        words = "" if math.isnan(gap) else f", {gap:.3g} to go"
        job.progress(f"{statement}: {count:,} pieces{words}")

    return tell


# --- Rule bases ---


def _prove_rules(rulebase: RuleBase, request: ProveRequest, job: WindowJob) -> None:
    from fuzzyarm.apps.show.proofs import bound_lines
    from fuzzyarm.proof.loop.orders import bounds_of, bounds_one, only_output, rules_of

    if not (request.sector or bounds_one(request)):
        if not rulebase.properties:
            raise TextRefusedError(
                "the text has no `prove` lines", hint="write one, or have a range or slopes bounded"
            )
        for judged in rules_of(request, (rulebase,), _progress(job)):
            tell_result(job, _verdict_lines(judged), verdict=judged.verdict)
        return
    with at_field("output"):
        name = only_output(rulebase, request.output or rulebase.outputs[0].name)
    request = request.replaced(output=name, table=_table(request.table, job))
    if request.sector:
        with at_field("along"):
            _prove_sectors(rulebase, request, job)
        return
    for key, bounds in bounds_of(request, rulebase, _progress(job)).items():
        verdict = "proved" if bounds.complete and not bounds.hole else "undecided"
        tell_result(job, bound_lines(name, key, bounds), verdict=verdict)


def _table(word: str | None, job: WindowJob) -> str | None:
    """Return the table whose error is bounded: a way of looking up, or a file of the folder."""
    if not word or word in TABLE_MODES:
        return word
    if word not in job.folder.listed(".lut"):
        raise FieldError(f"'{word}' is not a table of this folder", field="table")
    return str(job.folder.beside(word, ".lut"))


def _prove_sectors(rulebase: RuleBase, request: ProveRequest, job: WindowJob) -> None:
    """Report the sector of an output: the multiples of its inputs that bound it."""
    from fuzzyarm.apps.show.proofs import sector_lines
    from fuzzyarm.apps.show.sector import rulebase_sectors, sector_chart
    from fuzzyarm.proof.loop.orders import sectors_of

    name = request.output or ""
    sectors, failed = sectors_of(request, rulebase, _progress(job))
    for sector in sectors:
        chart = sector_chart(rulebase_sectors(rulebase, name, [sector]))
        verdict = "proved" if sector.complete else "undecided"
        tell_result(job, sector_lines(name, sector), [chart], verdict=verdict)
    if failed:
        tell_result(job, [f"no sector {words}" for words in failed], verdict="undecided")


def _verdict_lines(verdict: Verdict | LoopVerdict) -> list[str]:
    where = f"line {verdict.line}: " if verdict.line else ""
    head, *rest = str(verdict).splitlines()
    return [f"{where}{head}", *rest, f"  {verdict.seconds:.2f} s"]


# --- Controllers in their loops ---


class _LoopProof:
    """Claims about a controller in its loop."""

    def __init__(
        self,
        text: ControllerText,
        request: ProveRequest,
        job: WindowJob,
        *,
        wants_certificate: bool,
    ) -> None:
        self.text, self.job = text, job
        # Only plants named on the command line run here.
        self.request = request.replaced(trust=True)
        self.wants_certificate = wants_certificate

    def run(self) -> None:
        """Judge, and report."""
        request = self.request
        if request.sector:
            self._sectors()
        elif request.map:
            self._map()
        elif request.duration is not None and request.claim is None:
            self._tube()
        else:
            claims = self._claims()
            for number, claim in enumerate(claims, start=1):
                self._require_plant(claim.plant)
                suffix = f"-{number}" if len(claims) > 1 else ""
                self._judge(claim, f"{Path(self.text.path).stem}{suffix}.json")

    def _claims(self) -> list[LoopClaim]:
        """Return the claims: of the form, or of the lines of the text."""
        from fuzzyarm.proof.loop.orders import claim_of, wants_loop

        request = self.request
        with at_field("claim" if request.claim is not None else "stable"):
            if wants_loop(request):
                return [claim_of(self._with_plant(), dashes="")]
        if not self.text.claims:
            raise TextRefusedError(
                "the text has no `prove` lines",
                hint="write one, or a claim such as `stable on motor`",
            )
        return [replace(claim, plant=self._named(claim.plant)) for claim in self.text.claims]

    def _with_plant(self) -> ProveRequest:
        """Return the request on its named plant, or on that with the controller's axes."""
        if self.request.plant:
            return self.request
        return self.request.replaced(plant=plants_for(self.text.model, self.job.plants)[0]["name"])

    def _named(self, plant: str) -> str:
        """Return the plant of a line of the text, by its name in this designer."""
        from fuzzyarm.plant.own import same_file

        names = self.job.plants.by_name
        return next((name for name in names if same_file(name, plant)), Path(plant).name)

    def _require_plant(self, name: str) -> None:
        if name not in self.job.plants.by_name:
            raise FieldError(f"there is no plant '{name}' here", field="plant")

    # --- Verdicts ---

    def _judge(self, claim: LoopClaim, name: str) -> None:
        from fuzzyarm.proof.loop.orders import loops_of

        (verdict,) = loops_of(self.request, self.text, (claim,), _progress(self.job))
        lines, files = _verdict_lines(verdict), {}
        if self.wants_certificate and verdict.proved:
            try:
                files = {name: self._certificate(verdict)}
            except FuzzyarmError as error:
                lines.append(f"  no certificate: {error}")
        charts = _charts(self.text, verdict, self.job.plants.new(claim.plant))
        tell_result(self.job, lines, charts, verdict=verdict.verdict, files=files)

    def _certificate(self, verdict: LoopVerdict) -> bytes:
        """Return the file that proves a verdict again."""
        from fuzzyarm.proof.loop.orders import certificate_of

        found = certificate_of(self.request, self.text, verdict, _progress(self.job))
        return self._written(found)

    def _written(self, certificate: Certificate) -> bytes:
        """Return the file of a certificate, beside the controller."""
        from fuzzyarm.proof.check.certificate import certificate_bytes

        return certificate_bytes(replace(certificate, controller=Path(self.text.path).name), "")

    # --- Bounds ---

    def _tube(self) -> None:
        """Bound all ports for a time."""
        from fuzzyarm.apps.show.tube import tube_chart
        from fuzzyarm.proof.loop.orders import tube_of

        request = self._with_plant()
        self._require_plant(request.plant or "")
        with at_field("duration"):
            way, left_open, statement = tube_of(request, self.text, _progress(self.job))
        lines = [statement, *(way.lines() if way.complete else ()), *left_open]
        charts = [tube_chart(way, statement, None)] if way.complete else []
        verdict = "proved" if way.complete and not way.open else "undecided"
        tell_result(self.job, lines, charts, verdict=verdict)

    def _map(self) -> None:
        """Map the starts, and draw the map as it fills."""
        from fuzzyarm.apps.show.start_map import map_chart
        from fuzzyarm.proof.loop.orders import map_of

        def watch(found: StartMap) -> None:
            self.job.progress(f"{percent(found.decided)} decided so far")
            tell_result(self.job, [], [map_chart(found)], so_far=True)

        request = self._with_plant()
        self._require_plant(request.plant or "")
        with at_field("over"):
            found = map_of(request, self.text, watch, certify=self.wants_certificate)
        lines, files = [str(found), f"  {found.seconds:.1f} s"], {}
        if self.wants_certificate:
            if why := found.uncertified:
                lines.append(f"  no certificate: {why}")
            else:
                assert found.certificate is not None
                files = {f"{Path(self.text.path).stem}.json": self._written(found.certificate)}
        tell_result(self.job, lines, [map_chart(found)], verdict=found.verdict, files=files)

    def _sectors(self) -> None:
        """Prove the static part: ranges, limits, gains and sectors of the drives."""
        from fuzzyarm.apps.show.proofs import drive_lines, grouped_drives
        from fuzzyarm.apps.show.sector import controller_sectors, sector_chart
        from fuzzyarm.proof.loop.orders import drives_of

        name, plant = self.request.plant, None
        if name:
            self._require_plant(name)
            plant = self.job.plants.new(name)
        proofs = drives_of(
            self.request.replaced(plant=name or None), self.text, _progress(self.job)
        )
        for proof, drives in grouped_drives(proofs):
            lines = drive_lines(self.text.model.name, proof, drives, sectors_only=False)
            pictures = controller_sectors(self.text, [proof], plant)
            charts = [sector_chart(pictures)] if pictures else []
            verdict = "undecided" if proof.open else "proved"
            tell_result(self.job, lines, charts, verdict=verdict)


def _charts(text: ControllerText, verdict: LoopVerdict, plant: Any) -> list[Chart]:
    """Return the pictures of a verdict: its tube, or its invariant region."""
    from fuzzyarm.apps.show.region import region_chart
    from fuzzyarm.apps.show.tube import tube_chart

    if verdict.tube is not None:
        return [tube_chart(verdict.tube, str(verdict).splitlines()[0], verdict.claim)]
    return [region_chart(text, verdict, plant)] if verdict.proved else []


# --- Margins of the open loop, with their diagrams ---


def opened_loop(session: Session, request: BareMessage, job: WindowJob) -> None:
    """Send the form and the plants."""
    plants = plants_for(_loop_of(session).model, job.plants)
    job.tell({"plants": plants, "form": MARGINS.fields()})


def _loop_of(session: Session) -> ControllerText:
    from fuzzyarm.control.controllers.text import ControllerText

    text = model_of(session)
    if not isinstance(text, ControllerText):
        raise TextRefusedError("only the loop of a controller has margins")
    return text


def margins(session: Session, record: FormWork, job: WindowJob) -> None:
    """Linearise the loop, and send its margins at each drive."""
    from fuzzyarm.apps.show.margins import margin_lines, margins_chart
    from fuzzyarm.proof.loop.orders import margins_of_text

    text, path = _loop_of(session), Path(session.path)
    request = MARGINS.request(record.form, path.parent, file=path.name)
    with at_field("plant"):
        found = margins_of_text(text, request)
    job.check()
    for each in found:
        verdict = "stable" if each.nominal.stable else "unstable"
        tell_result(job, margin_lines(each), [margins_chart([each], path.name)], verdict=verdict)
