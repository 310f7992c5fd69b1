"""A certificate checked, without a search: which files, loop and theorem, and what follows."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.shown import Shown, one_line
from fuzzyarm.control.controllers.text import ControllerText, read_controller
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.plant.own import trusted_plant
from fuzzyarm.plant.plant import Plant
from fuzzyarm.proof.check.certificate import (
    Certificate,
    CertificateError,
    TubeProof,
    fingerprints_of,
    read_certificate,
)
from fuzzyarm.proof.check.numbers import Number, exact, float_above, float_below
from fuzzyarm.proof.check.region import accepted, outside, region_facts, verified
from fuzzyarm.proof.check.rules import RuleSurfaces
from fuzzyarm.proof.check.tube import Arrival, Follower, Haven, covered
from fuzzyarm.proof.claim.identity import loop_digests
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.claim.text import claimed_in, loop_sentence, problem_of
from fuzzyarm.proof.stop import Stop

__all__ = ["Checked", "check_certificate", "follow_box"]

PROVED, UNDECIDED = "proved", "undecided"

OF_REGIONS = (
    "V = z'Pz falls in each control period for all gains between the proved ones (Lyapunov,"
    " S-procedure), so that no run leaves V <= 1 and all go to rest"
)
OF_TUBES = "sets hold all runs from one sample to the next (mean value theorem)"
OF_MAPS = "each box leads into a region or into boxes before it (induction)"


@dataclass(frozen=True, repr=False, kw_only=True)
class Checked(Shown):
    """What a certificate proves.

    Attributes
    ----------
    statement : str
        The sentence that follows.
    certificate : Certificate
        Which.
    against : str
        Why it does not; empty where it does.
    files : dict of str to str
        SHA-256 of the files that were read, by name.
    loop : tuple of str
        The loop that was derived, in words.
    theorems : tuple of str
        What was used.
    facts : dict
        The region, as a verdict has it.
    boxes : int
        How many boxes of starts were followed.
    """

    statement: str
    certificate: Certificate
    against: str = ""
    files: Mapping[str, str] = field(default_factory=dict)
    loop: tuple[str, ...] = ()
    theorems: tuple[str, ...] = ()
    facts: Mapping[str, Any] = field(default_factory=dict)
    boxes: int = 0

    @property
    def proved(self) -> bool:
        """Whether the statement holds."""
        return not self.against

    @property
    def words(self) -> tuple[str, ...]:
        """What was read, derived and used, a line each."""
        files = [f"read {name}, SHA-256 {digest}" for name, digest in self.files.items()]
        return (*files, *self.loop, *(f"theorem: {words}" for words in self.theorems))

    def __repr__(self) -> str:
        return one_line(self, f"{PROVED if self.proved else UNDECIDED}: {self.statement}")

    def __str__(self) -> str:
        head = f"{PROVED if self.proved else UNDECIDED}: {self.statement}"
        return "\n  ".join([head, *([self.against] * bool(self.against)), *self.words])


def check_certificate(
    certificate: Certificate | str,
    text: ControllerText | None = None,
    plant: Plant | None = None,
    *,
    named: str | None = None,
    trust: bool = False,
    budget: float = math.inf,
) -> Checked:
    """Check a certificate, without any search.

    Parameters
    ----------
    certificate : Certificate or str
        Or its file.
    text : ControllerText, optional
        The controller; by default its file is read, from the folder at hand or from that of the
        certificate.
    plant : Plant, optional
        In place of the one that the claim names.
    named : str, optional
        A plant whose code may run, where the claim names the same one.
    trust : bool, optional
        Whether the plant of the claim may be code, which is run.
    budget : float
        Seconds after which it stays undecided.

    Raises
    ------
    CertificateError
        If it is not a certificate, or one of other files.
    PlantError
        If its plant is code that may not run.
    """
    stop, folder = Stop(budget), Path(".")
    if isinstance(certificate, str):
        folder = Path(certificate).parent
        certificate = read_certificate(certificate)
    text = _controller(certificate, folder) if text is None else text
    _require_files(certificate, text)
    claim = certificate.claim
    statement = loop_sentence(
        claim, certificate.sensors, certificate.connect, plant=plant, text=text,
        continuous=certificate.continuous,
    )  # fmt: skip
    plant = trusted_plant(claim.plant, named, trust=trust) if plant is None else plant
    _require_loop(certificate, text, plant)
    facts: dict[str, Any] = {}
    try:
        with stop:
            problem = problem_of(
                text, claim,
                plant=plant, sensors=certificate.sensors, connect=certificate.connect,
            )  # fmt: skip
            proof = _Proof(problem, certificate)
            facts = proof.facts
    except FuzzyarmError as error:
        against = f"the certificate does not prove it: {error}"
        return Checked(statement=statement, certificate=certificate, against=against)
    if proof.is_map:
        statement += f"; from all starts in {_boxes_words(problem, certificate.tubes)}"
    return Checked(
        statement=statement, certificate=certificate, files=certificate.fingerprints,
        loop=proof.loop, theorems=proof.theorems, facts=facts, boxes=len(certificate.tubes),
    )  # fmt: skip


class _Proof:
    """A proof of a certificate's claim; LoopProofError where it is none."""

    def __init__(self, problem: LoopProblem, certificate: Certificate) -> None:
        self.problem, self.claim = problem, certificate.claim
        self.surfaces = RuleSurfaces()
        regions, tubes = certificate.regions, certificate.tubes
        self.is_map = bool(tubes) and not (self.claim.start or self.claim.output)
        if not tubes:
            if len(regions) != 1:
                raise LoopProofError("it has no region, or several and no tube")
            against, self.facts, loop = verified(problem, self.claim, regions[0], self.surfaces)
            if against or loop is None:
                raise LoopProofError(against)
            havens = [Haven(loop, regions[0])]
        else:
            if certificate.continuous:
                raise LoopProofError("tubes are of the loop as sampled")
            havens = [Haven(accepted(problem, r, self.surfaces), r) for r in regions]
            self.facts = region_facts(problem, *havens[0]) if havens else {}
            self._follow(havens, tubes)
        self.loop = tuple(_loop_words(haven) for haven in havens)
        self.theorems = (
            *((OF_REGIONS,) if regions else ()),
            *((OF_TUBES,) if tubes else ()),
            *((OF_MAPS,) if self.is_map else ()),
        )

    def _follow(self, havens: Sequence[Haven], tubes: Sequence[TubeProof]) -> None:
        """Follow all boxes; a claim of starts needs all of them in the boxes."""
        problem, claim = self.problem, self.claim
        follower = Follower(problem, havens, self.surfaces)
        for number in range(len(tubes)):
            try:
                follow_box(follower, claim, tubes, number)
            except (LoopProofError, IndexError, ValueError, ZeroDivisionError) as error:
                raise LoopProofError(f"box {number + 1}: {error}") from error
        if claim.start or claim.output:
            start = [(exact(span.low), exact(span.high)) for span in problem.start.values()]
            boxes = [[(exact(a), exact(b)) for a, b in tube.box] for tube in tubes]
            if not covered(start, boxes):
                raise LoopProofError("its boxes are not all of the starts")


def follow_box(
    follower: Follower, claim: LoopClaim, tubes: Sequence[TubeProof], number: int
) -> Arrival:
    """Follow the box of a tube to where it arrives; LoopProofError where that is not shown."""
    box, periods, (kind, indices) = tubes[number]
    if kind == "tubes":
        if claim.output or any(index >= number for index in indices):
            raise LoopProofError("it leads into boxes that are not known to arrive")
        return follower.arrival(box, periods, into=(), boxes=[tubes[k].box for k in indices])
    if kind == "regions":
        if len(indices) != 1:
            raise LoopProofError("it does not lead into one region")
        haven = follower.havens[indices[0]]

        def holds_from(period: int, level: Number) -> bool:
            return not claim.output or not outside(
                follower.problem, haven.loop, claim, haven.proof, level, period
            )

        return follower.arrival(box, periods, claim=claim, into=indices, arrived=holds_from)
    last = claimed_in(follower.problem, claim).last if claim.output else None
    if last is None or claim.stable:
        raise LoopProofError("it ends before the claim does")
    return follower.arrival(box, last + 1, claim=claim, into=())


def _loop_words(haven: Haven) -> str:
    loop = haven.loop
    rest = ", ".join(f"{name} = {float(x):.6g}" for name, x in loop.rest.items())
    gains = f", unknown gains: {'; '.join(loop.words)}" if loop.words else ""
    return f"derived a loop of {loop.size} states at rest where {rest}{gains}"


def _boxes_words(problem: LoopProblem, tubes: Sequence[TubeProof]) -> str:
    spans = []
    for k, name in enumerate(problem.states):
        low = min(tube.box[k][0] for tube in tubes)
        high = max(tube.box[k][1] for tube in tubes)
        spans.append(f"{name} in {float_above(exact(low)):g} .. {float_below(exact(high)):g}")
    return f"{len(tubes)} box{'es' * (len(tubes) != 1)} within {', '.join(spans)}"


def _controller(certificate: Certificate, folder: Path) -> ControllerText:
    """Return the controller of a certificate, from the folder at hand or that of its file."""
    given = Path(certificate.controller)
    for path in (given, folder / given, folder / given.name):
        if path.is_file():
            return read_controller(str(path))
    raise CertificateError(f"the controller {certificate.controller} is not there")


def _require_files(certificate: Certificate, text: ControllerText) -> None:
    """Refuse a certificate of other files than those of a controller, or of more or fewer."""
    now = fingerprints_of(text)
    if set(now) != set(certificate.fingerprints):
        expected_name = Path(certificate.controller).name
        raise CertificateError(
            f"this certificate is of {expected_name}, not of {Path(text.path).name}"
        )
    for name, fingerprint in certificate.fingerprints.items():
        if now[name] != fingerprint:
            raise CertificateError(f"{name} is not the file that was proved")


def _require_loop(certificate: Certificate, text: ControllerText, plant: Plant) -> None:
    """Refuse a certificate of another controller or plant than those at hand."""
    named = {"controller": Path(certificate.controller).name, "plant": certificate.claim.plant}
    for part, digest in loop_digests(text, plant).items():
        if certificate.digests.get(part) != digest:
            raise CertificateError(
                f"{named[part]} is not the {part} that was proved", hint="prove it anew"
            )
